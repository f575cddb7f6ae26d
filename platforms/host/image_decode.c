/* SPDX-License-Identifier: Zlib */
/* PNG and JPEG from memory. Both libraries leave by longjmp: each decoder is
 * a function that sets the jump and touches only the job its caller owns, so
 * that no local variable is clobbered and the caller frees everything. */
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <jpeglib.h>
#include <jerror.h>
#include <png.h>
#include "platforms/host/image.h"
#include "platforms/host/image_png.h"
#include "platforms/host/util.h"

/* A progressive JPEG decodes the whole picture once a scan: a small file of
 * thousands of scans would run for hours. Real ones have about ten. */
enum { SCAN_LIMIT = 100 };

static void png_stop(png_structp png, png_const_charp message)
{
    struct hlh_png_job *job = png_get_error_ptr(png);
    snprintf(job->reason, sizeof job->reason, "%s", message);
    longjmp(job->leave, 1);
}

void hlh_png_quiet(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void png_take(png_structp png, png_bytep out, size_t size)
{
    struct hlh_png_job *job = png_get_io_ptr(png);
    if (size > job->left)
        png_error(png, "the file is truncated");
    memcpy(out, job->at, size);
    job->at += size;
    job->left -= size;
}

static void png_transforms(struct hlh_png_job *job)
{
    int type = png_get_color_type(job->png, job->info);
    int depth = png_get_bit_depth(job->png, job->info);
    job->gray16 = depth == 16 && type == PNG_COLOR_TYPE_GRAY;
    if (job->as_file)
        return;
    if (job->wide)
        png_set_expand_16(job->png);
    else
        png_set_scale_16(job->png);
    png_set_expand(job->png);
    png_set_gray_to_rgb(job->png);
    png_set_add_alpha(job->png, 0xffff, PNG_FILLER_AFTER);
}

static bool png_run(struct hlh_png_job *job)
{
    if (setjmp(job->leave))
        return false;
    png_set_read_fn(job->png, job, png_take);
    png_set_user_limits(job->png, HLH_IMAGE_SIDE, HLH_IMAGE_SIDE);
    png_read_info(job->png, job->info);
    job->width = png_get_image_width(job->png, job->info);
    job->height = png_get_image_height(job->png, job->info);
    if ((uint64_t)job->width * job->height > job->pixel_limit)
        png_error(job->png, "has more pixels than are allowed here");
    png_transforms(job);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
    job->depth = png_get_bit_depth(job->png, job->info);
    job->channels = png_get_channels(job->png, job->info);
    job->row_bytes = png_get_rowbytes(job->png, job->info);
    job->pixels = hlh_alloc(job->height, job->row_bytes);
    job->rows = hlh_alloc(job->height, sizeof *job->rows);
    if (!job->pixels || !job->rows)
        png_error(job->png, "out of memory");
    for (uint32_t y = 0; y < job->height; y++)
        job->rows[y] = job->pixels + y * job->row_bytes;
    png_read_image(job->png, job->rows);
    png_read_end(job->png, NULL);
    return true;
}

bool hlh_png_read(struct hlh_png_job *job, const void *bytes, size_t size)
{
    bool ok = false;
    job->at = bytes;
    job->left = size;
    job->pixels = NULL;
    job->rows = NULL;
    snprintf(job->reason, sizeof job->reason, "out of memory");
    job->png = png_create_read_struct(PNG_LIBPNG_VER_STRING, job, png_stop,
                                      hlh_png_quiet);
    if (!job->png)
        return false;
    job->info = png_create_info_struct(job->png);
    if (job->info)
        ok = png_run(job);
    png_destroy_read_struct(&job->png, &job->info, NULL);
    free(job->rows);
    job->rows = NULL;
    if (!ok) {
        free(job->pixels);
        job->pixels = NULL;
    }
    return ok;
}

struct jpeg_job {
    struct jpeg_error_mgr errors;                /* first: libjpeg's view    */
    struct jpeg_progress_mgr progress;
    struct jpeg_decompress_struct jpeg;
    jmp_buf leave;
    char reason[JMSG_LENGTH_MAX];
    uint8_t *rgba;
    uint8_t *row;
    uint64_t pixel_limit;
};

static void jpeg_stop(j_common_ptr jpeg)
{
    struct jpeg_job *job = (struct jpeg_job *)jpeg->err;
    jpeg->err->format_message(jpeg, job->reason);
    longjmp(job->leave, 1);
}

/* libjpeg paints what is missing grey and only warns. Bytes between markers
 * are harmless and common; every other warning means lost picture data. */
static void jpeg_warn(j_common_ptr jpeg, int level)
{
    if (level < 0 && jpeg->err->msg_code != JWRN_EXTRANEOUS_DATA &&
        jpeg->err->msg_code != JWRN_ADOBE_XFORM &&
        jpeg->err->msg_code != JWRN_JFIF_MAJOR)
        jpeg_stop(jpeg);
}

static void jpeg_silent(j_common_ptr jpeg)
{
    (void)jpeg;
}

static void refuse(struct jpeg_job *job, const char *reason)
{
    snprintf(job->reason, sizeof job->reason, "%s", reason);
    longjmp(job->leave, 1);
}

static void jpeg_watch(j_common_ptr jpeg)
{
    struct jpeg_job *job = (struct jpeg_job *)jpeg->err;
    if (job->jpeg.input_scan_number > SCAN_LIMIT)
        refuse(job, "has more than 100 scans");
}

static void jpeg_row(struct jpeg_job *job)
{
    JSAMPROW row = job->row;
    uint8_t *out = job->rgba +
                   (size_t)job->jpeg.output_scanline * job->jpeg.output_width *
                       4;
    jpeg_read_scanlines(&job->jpeg, &row, 1);
    for (uint32_t x = 0; x < job->jpeg.output_width; x++) {
        memcpy(out + x * 4, job->row + x * 3, 3);
        out[x * 4 + 3] = 255;
    }
}

static bool jpeg_run(struct jpeg_job *job, const void *bytes, size_t size)
{
    struct jpeg_decompress_struct *jpeg = &job->jpeg;
    if (setjmp(job->leave))
        return false;
    jpeg_create_decompress(jpeg);
    job->progress.progress_monitor = jpeg_watch;
    jpeg->progress = &job->progress;
    jpeg_mem_src(jpeg, bytes, (unsigned long)size);
    jpeg_read_header(jpeg, TRUE);
    if (jpeg->image_width > HLH_IMAGE_SIDE ||
        jpeg->image_height > HLH_IMAGE_SIDE)
        refuse(job, "is larger than 16384 pixels a side");
    if ((uint64_t)jpeg->image_width * jpeg->image_height > job->pixel_limit)
        refuse(job, "has more pixels than are allowed here");
    jpeg->out_color_space = JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW;
    jpeg_start_decompress(jpeg);
    job->rgba = hlh_alloc((size_t)jpeg->output_width * jpeg->output_height, 4);
    job->row = hlh_alloc(jpeg->output_width, 3);
    if (!job->rgba || !job->row)
        refuse(job, "out of memory");
    while (jpeg->output_scanline < jpeg->output_height)
        jpeg_row(job);
    jpeg_finish_decompress(jpeg);
    return true;
}

static bool decode_jpeg(struct hlh_image *out, const void *bytes, size_t size,
                        uint64_t pixel_limit, const char *name,
                        struct hlh_error *error)
{
    struct jpeg_job *job = hlh_alloc_zero(1, sizeof *job);
    bool ok;
    if (!job)
        return hlh_fail(error, name, "out of memory");
    job->pixel_limit = pixel_limit;
    job->jpeg.err = jpeg_std_error(&job->errors);
    job->errors.error_exit = jpeg_stop;
    job->errors.emit_message = jpeg_warn;
    job->errors.output_message = jpeg_silent;
    ok = jpeg_run(job, bytes, size);
    if (ok) {
        out->width = job->jpeg.output_width;
        out->height = job->jpeg.output_height;
        out->rgba = job->rgba;
    } else {
        free(job->rgba);
        hlh_fail(error, name, "JPEG: %s", job->reason);
    }
    free(job->row);
    jpeg_destroy_decompress(&job->jpeg);
    free(job);
    return ok;
}

static bool decode_png(struct hlh_image *out, const void *bytes, size_t size,
                       uint64_t pixel_limit, const char *name,
                       struct hlh_error *error)
{
    struct hlh_png_job *job = hlh_alloc_zero(1, sizeof *job);
    bool ok;
    if (!job)
        return hlh_fail(error, name, "out of memory");
    job->pixel_limit = pixel_limit;
    ok = hlh_png_read(job, bytes, size);
    if (ok) {
        out->width = job->width;
        out->height = job->height;
        out->rgba = job->pixels;
    } else {
        hlh_fail(error, name, "PNG: %s", job->reason);
    }
    free(job);
    return ok;
}

bool hlh_image_decode_limited(struct hlh_image *out, const void *bytes,
                              size_t size, uint64_t pixel_limit,
                              const char *name, struct hlh_error *error)
{
    static const unsigned char png[8] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    static const unsigned char jpeg[3] = {0xff, 0xd8, 0xff};
    char *copy;
    bool ok;
    memset(out, 0, sizeof *out);
    copy = hlh_strdup(name ? name : "");
    if (!copy)
        return hlh_fail(error, name, "out of memory");
    if (size >= sizeof png && memcmp(bytes, png, sizeof png) == 0)
        ok = decode_png(out, bytes, size, pixel_limit, name, error);
    else if (size >= sizeof jpeg && memcmp(bytes, jpeg, sizeof jpeg) == 0)
        ok = decode_jpeg(out, bytes, size, pixel_limit, name, error);
    else
        ok = hlh_fail(error, name, "is neither a PNG nor a JPEG image");
    if (ok)
        out->name = copy;
    else
        free(copy);
    return ok;
}

bool hlh_image_decode(struct hlh_image *out, const void *bytes, size_t size,
                      const char *name, struct hlh_error *error)
{
    return hlh_image_decode_limited(out, bytes, size, HLH_IMAGE_PIXELS, name,
                                    error);
}
