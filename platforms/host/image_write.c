/* SPDX-License-Identifier: Zlib */
/* Pictures and ids as PNG files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image_png.h"

struct write_job {
    jmp_buf leave;
    struct hlh_buffer *out;
    png_structp png;
    png_infop info;
};

static void stop(png_structp png, png_const_charp message)
{
    struct write_job *job = png_get_error_ptr(png);
    (void)message;
    longjmp(job->leave, 1);
}

static void put(png_structp png, png_bytep bytes, size_t size)
{
    struct write_job *job = png_get_io_ptr(png);
    hlh_buffer_add(job->out, bytes, size);
    if (job->out->failed)
        png_error(png, "out of memory");
}

static void flush(png_structp png)
{
    (void)png;
}

static bool run(struct write_job *job, const uint8_t *pixels, uint32_t width,
                uint32_t height, int type, int depth)
{
    size_t row_bytes;
    if (setjmp(job->leave))
        return false;
    png_set_write_fn(job->png, job, put, flush);
    png_set_IHDR(job->png, job->info, width, height, depth, type,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(job->png, job->info);
    row_bytes = png_get_rowbytes(job->png, job->info);
    for (uint32_t y = 0; y < height; y++)
        png_write_row(job->png, pixels + y * row_bytes);
    png_write_end(job->png, NULL);
    return true;
}

bool hlh_png_encode(struct hlh_buffer *out, const uint8_t *pixels,
                    uint32_t width, uint32_t height, int type, int depth)
{
    struct write_job *job = hlh_alloc_zero(1, sizeof *job);
    bool ok = false;
    if (!job)
        return false;
    job->out = out;
    job->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, stop,
                                       hlh_png_quiet);
    if (job->png)
        job->info = png_create_info_struct(job->png);
    if (job->info)
        ok = run(job, pixels, width, height, type, depth);
    png_destroy_write_struct(&job->png, &job->info);
    free(job);
    return ok;
}

static bool save_png(const uint8_t *pixels, uint32_t width, uint32_t height,
                     int type, int depth, const char *path,
                     struct hlh_error *error)
{
    struct hlh_buffer out = {0};
    bool ok = width && height &&
              hlh_png_encode(&out, pixels, width, height, type, depth);
    if (ok)
        ok = hlh_file_write(path, out.bytes, out.size, error);
    else
        hlh_fail(error, path, "PNG: %u x %u pixels cannot be encoded",
                 (unsigned)width, (unsigned)height);
    hlh_buffer_free(&out);
    return ok;
}

/* Written so that a NaN becomes 0. */
static uint8_t srgb(double linear)
{
    double v;
    if (!(linear > 0))
        return 0;
    if (linear >= 1)
        return 255;
    v = linear <= 0.0031308 ? 12.92 * linear
                            : 1.055 * pow(linear, 1 / 2.4) - 0.055;
    return (uint8_t)floor(v * 255 + 0.5);
}

bool hlh_picture_write_png(const struct hlh_picture *p, double exposure,
                           const char *path, struct hlh_error *error)
{
    size_t n = (size_t)p->width * p->height * 3;
    uint8_t *pixels = hlh_alloc(n, 1);
    double scale = exp2(exposure);
    bool ok;
    if (!pixels)
        return hlh_fail(error, path, "out of memory");
    for (size_t i = 0; i < n; i++)
        pixels[i] = srgb(p->rgb[i] * scale);
    ok = save_png(pixels, p->width, p->height, PNG_COLOR_TYPE_RGB, 8, path,
                  error);
    free(pixels);
    return ok;
}

bool hlh_ids_write_png(const uint32_t *ids, uint32_t width, uint32_t height,
                       const char *path, struct hlh_error *error)
{
    size_t n = (size_t)width * height;
    uint8_t *pixels = hlh_alloc(n, 4);
    bool wide = false, ok;
    if (!pixels)
        return hlh_fail(error, path, "out of memory");
    for (size_t i = 0; i < n; i++)
        wide |= ids[i] > 65535;
    for (size_t i = 0; i < n; i++)
        if (wide) {
            for (int k = 0; k < 4; k++)
                pixels[i * 4 + (size_t)k] = (uint8_t)(ids[i] >> (8 * k));
        } else {
            pixels[i * 2] = (uint8_t)(ids[i] >> 8);
            pixels[i * 2 + 1] = (uint8_t)ids[i];
        }
    ok = save_png(pixels, width, height,
                  wide ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_GRAY,
                  wide ? 8 : 16, path, error);
    free(pixels);
    return ok;
}
