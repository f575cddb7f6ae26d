/* SPDX-License-Identifier: Zlib */
#ifndef HLH_IMAGE_PNG_H
#define HLH_IMAGE_PNG_H
/* libpng behind one struct that outlives its longjmp; for platforms/host. */
#include <setjmp.h>
#include <png.h>
#include "platforms/host/image.h"
#include "platforms/host/util.h"

#define HLH_IMAGE_SIDE 16384u
#define HLH_IMAGE_PIXELS ((uint64_t)1 << 28)

/* Zero it, set the first group, call hlh_png_read, free pixels. */
struct hlh_png_job {
    bool wide;                        /* 16 bits a channel, else 8           */
    bool as_file;                     /* no conversion to RGBA at all        */
    uint64_t pixel_limit;

    uint32_t width, height;
    int depth, channels;
    bool gray16;                      /* the file is 16-bit grey             */
    size_t row_bytes;
    uint8_t *pixels;                  /* 16-bit samples are big-endian       */
    char reason[128];

    png_structp png;
    png_infop info;
    png_bytep *rows;
    const uint8_t *at;
    size_t left;
    jmp_buf leave;
};

/* A warning handler that says nothing. */
void hlh_png_quiet(png_structp png, png_const_charp message);

/* False: reason says why, pixels is NULL. */
bool hlh_png_read(struct hlh_png_job *job, const void *bytes, size_t size);

/* Append a PNG file to *out. type is a PNG_COLOR_TYPE_*; pixels are rows of
 * width * channels samples, 16-bit ones big-endian. False: memory. */
bool hlh_png_encode(struct hlh_buffer *out, const uint8_t *pixels,
                    uint32_t width, uint32_t height, int type, int depth);

/* hlh_image_decode with a limit on width * height. */
bool hlh_image_decode_limited(struct hlh_image *out, const void *bytes,
                              size_t size, uint64_t pixel_limit,
                              const char *name, struct hlh_error *error);
#endif
