/* SPDX-License-Identifier: Zlib */
/* Pictures and ids from PNG and PFM files. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image_png.h"

static float srgb_to_linear(double v)
{
    return (float)(v <= 0.04045 ? v / 12.92
                                : pow((v + 0.055) / 1.055, 2.4));
}

static bool to_linear(struct hlh_picture *out, const struct hlh_png_job *job)
{
    size_t n = (size_t)job->width * job->height;
    float *table = hlh_alloc(65536, sizeof *table);
    out->rgb = hlh_alloc(n * 3, sizeof *out->rgb);
    if (!table || !out->rgb) {
        free(table);
        return false;
    }
    for (int i = 0; i < 65536; i++)
        table[i] = srgb_to_linear(i / 65535.0);
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++) {
            const uint8_t *s = job->pixels + (i * 4 + c) * 2;
            out->rgb[i * 3 + c] = table[s[0] << 8 | s[1]];
        }
    free(table);
    out->width = job->width;
    out->height = job->height;
    return true;
}

static bool read_png(struct hlh_picture *out, const char *bytes, size_t size,
                     const char *path, struct hlh_error *error)
{
    struct hlh_png_job *job = hlh_alloc_zero(1, sizeof *job);
    bool ok;
    if (!job)
        return hlh_fail(error, path, "out of memory");
    job->wide = true;
    job->pixel_limit = HLH_IMAGE_PIXELS;
    ok = hlh_png_read(job, bytes, size);
    if (!ok)
        hlh_fail(error, path, "PNG: %s", job->reason);
    else if (!to_linear(out, job))
        ok = hlh_fail(error, path, "out of memory");
    free(job->pixels);
    free(job);
    return ok;
}

struct pfm {
    bool color, big_endian;
    uint32_t width, height;
    size_t start;
};

/* One word of the header; PFM allows any one white space behind it. */
static bool word(char *out, size_t room, const char *bytes, size_t size,
                 size_t *at)
{
    size_t n = 0;
    while (*at < size && strchr(" \t\r\n", bytes[*at]) && bytes[*at])
        ++*at;
    while (*at < size && n + 1 < room && bytes[*at] &&
           !strchr(" \t\r\n", bytes[*at]))
        out[n++] = bytes[(*at)++];
    out[n] = 0;
    return n > 0 && *at < size && strchr(" \t\r\n", bytes[*at]);
}

static bool side(uint32_t *out, const char *text)
{
    char *end;
    unsigned long v = strtoul(text, &end, 10);
    if (*end || text[0] < '0' || text[0] > '9' || !v || v > HLH_IMAGE_SIDE)
        return false;
    *out = (uint32_t)v;
    return true;
}

static bool pfm_header(struct pfm *pfm, const char *bytes, size_t size,
                       const char *path, struct hlh_error *error)
{
    char text[32], *end;
    size_t at = 0, need;
    double scale;
    if (!word(text, sizeof text, bytes, size, &at) ||
        (strcmp(text, "PF") && strcmp(text, "Pf")))
        return hlh_fail(error, path, "PFM: does not start with PF or Pf");
    pfm->color = text[1] == 'F';
    if (!word(text, sizeof text, bytes, size, &at) || !side(&pfm->width, text))
        return hlh_fail(error, path, "PFM: width is not 1 to 16384");
    if (!word(text, sizeof text, bytes, size, &at) ||
        !side(&pfm->height, text))
        return hlh_fail(error, path, "PFM: height is not 1 to 16384");
    if (!word(text, sizeof text, bytes, size, &at))
        return hlh_fail(error, path, "PFM: has no scale");
    scale = strtod(text, &end);
    if (*end || !isfinite(scale) || scale == 0)
        return hlh_fail(error, path, "PFM: scale is not a number but 0");
    pfm->big_endian = scale > 0;
    pfm->start = at + 1;
    need = (size_t)pfm->width * pfm->height * (pfm->color ? 12 : 4);
    if (size - pfm->start < need)
        return hlh_fail(error, path, "PFM: has %zu bytes of pixels where "
                        "%u x %u need %zu", size - pfm->start,
                        (unsigned)pfm->width, (unsigned)pfm->height, need);
    return true;
}

static float pfm_float(const char *bytes, bool big_endian)
{
    uint32_t u = 0;
    float f;
    for (int k = 0; k < 4; k++)
        u |= (uint32_t)(uint8_t)bytes[k] << 8 * (big_endian ? 3 - k : k);
    memcpy(&f, &u, sizeof f);
    return f;
}

static bool read_pfm(struct hlh_picture *out, const char *bytes, size_t size,
                     const char *path, struct hlh_error *error)
{
    struct pfm pfm = {0};
    if (!pfm_header(&pfm, bytes, size, path, error))
        return false;
    out->rgb = hlh_alloc((size_t)pfm.width * pfm.height * 3,
                         sizeof *out->rgb);
    if (!out->rgb)
        return hlh_fail(error, path, "out of memory");
    out->width = pfm.width;
    out->height = pfm.height;
    out->linear = true;
    for (size_t y = 0; y < pfm.height; y++)
        for (size_t x = 0; x < pfm.width; x++)
            for (size_t c = 0; c < 3; c++) {
                size_t row = pfm.height - 1 - y;
                size_t from = pfm.color ? (row * pfm.width + x) * 3 + c
                                        : row * pfm.width + x;
                out->rgb[(y * pfm.width + x) * 3 + c] =
                    pfm_float(bytes + pfm.start + from * 4, pfm.big_endian);
            }
    return true;
}

bool hlh_picture_read(struct hlh_picture *out, const char *path,
                      struct hlh_error *error)
{
    size_t size;
    char *bytes;
    bool ok;
    memset(out, 0, sizeof *out);
    if (!hlh_path_is(path, "png") && !hlh_path_is(path, "pfm"))
        return hlh_fail(error, path, "is neither a .png nor a .pfm file");
    if (!hlh_file_read(&bytes, &size, path, error))
        return false;
    if (hlh_path_is(path, "png"))
        ok = read_png(out, bytes, size, path, error);
    else
        ok = read_pfm(out, bytes, size, path, error);
    free(bytes);
    if (!ok)
        hlh_picture_free(out);
    return ok;
}

static bool take_ids(uint32_t *ids, const struct hlh_png_job *job)
{
    size_t n = (size_t)job->width * job->height;
    bool wide = job->channels == 4 && job->depth == 8;
    if (!wide && !job->gray16)
        return false;
    for (size_t i = 0; i < n; i++) {
        const uint8_t *p = job->pixels + i * (wide ? 4 : 2);
        ids[i] = wide ? p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
                            (uint32_t)p[3] << 24
                      : (uint32_t)p[0] << 8 | p[1];
    }
    return true;
}

static bool read_ids(uint32_t **ids, struct hlh_png_job *job,
                     const char *bytes, size_t size, const char *path,
                     struct hlh_error *error)
{
    job->as_file = true;
    job->pixel_limit = HLH_IMAGE_PIXELS;
    if (!hlh_png_read(job, bytes, size))
        return hlh_fail(error, path, "PNG: %s", job->reason);
    *ids = hlh_alloc((size_t)job->width * job->height, sizeof **ids);
    if (!*ids)
        return hlh_fail(error, path, "out of memory");
    if (take_ids(*ids, job))
        return true;
    free(*ids);
    *ids = NULL;
    return hlh_fail(error, path, "PNG: ids are 16-bit grey or 8-bit RGBA, "
                    "this has %d channels of %d bits", job->channels,
                    job->depth);
}

bool hlh_ids_read_png(uint32_t **ids, uint32_t *width, uint32_t *height,
                      const char *path, struct hlh_error *error)
{
    struct hlh_png_job *job;
    size_t size;
    char *bytes;
    bool ok;
    *ids = NULL;
    *width = *height = 0;
    if (!hlh_file_read(&bytes, &size, path, error))
        return false;
    job = hlh_alloc_zero(1, sizeof *job);
    if (job)
        ok = read_ids(ids, job, bytes, size, path, error);
    else
        ok = hlh_fail(error, path, "out of memory");
    if (ok) {
        *width = job->width;
        *height = job->height;
    }
    if (job)
        free(job->pixels);
    free(job);
    free(bytes);
    return ok;
}
