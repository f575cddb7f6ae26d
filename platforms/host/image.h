/* SPDX-License-Identifier: Zlib */
#ifndef HLH_IMAGE_H
#define HLH_IMAGE_H
/* Pictures on disk. Float images are linear RGB, 3 floats a pixel, rows top
 * to bottom, owned by the caller through hlh_picture_free. */
#include <stdbool.h>
#include <stdint.h>
#include "platforms/host/scene.h"

struct hlh_picture {
    uint32_t width, height;
    float *rgb;                       /* width * height * 3                  */
    bool linear;                      /* PFM: true; PNG: sRGB was decoded    */
};

/* Decode a PNG or JPEG held in memory to 8-bit RGBA. */
bool hlh_image_decode(struct hlh_image *out, const void *bytes, size_t size,
                      const char *name, struct hlh_error *error);
/* PNG, 8 bit: sRGB(clamp(linear * 2^exposure)). Written to a temporary file
 * and renamed, so that a failure leaves nothing behind. */
bool hlh_picture_write_png(const struct hlh_picture *picture, double exposure,
                           const char *path, struct hlh_error *error);
/* PFM, little endian, linear, bottom row first as the format says. */
bool hlh_picture_write_pfm(const struct hlh_picture *picture,
                           const char *path, struct hlh_error *error);
/* 16-bit grey PNG of ids (uint16) or, ids > 65535, 8-bit RGBA of uint32, r
 * its lowest byte, a its highest. */
bool hlh_ids_write_png(const uint32_t *ids, uint32_t width, uint32_t height,
                       const char *path, struct hlh_error *error);
bool hlh_ids_read_png(uint32_t **ids, uint32_t *width, uint32_t *height,
                      const char *path, struct hlh_error *error);
/* By extension: .pfm linear, .png decoded from sRGB to linear. */
bool hlh_picture_read(struct hlh_picture *out, const char *path,
                      struct hlh_error *error);
void hlh_picture_free(struct hlh_picture *picture);
/* Write any bytes by temporary file and rename. */
bool hlh_file_write(const char *path, const void *bytes, size_t size,
                    struct hlh_error *error);
/* Whole file, NUL-terminated past its end, malloc'd. */
bool hlh_file_read(char **bytes, size_t *size, const char *path,
                   struct hlh_error *error);
#endif
