/* SPDX-License-Identifier: Zlib */
/* Mip levels and trilinear sampling, after the Vulkan specification, chapter
 * "Image Operations" (scale factor, level selection, texel filtering). */
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/internal.h"

/* IEC 61966-2-1. */
static double srgb_to_linear(double s)
{
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

void hlr_tables_make(struct hlr_tables *out)
{
    for (int i = 0; i < 256; i++) {
        out->unorm[i] = i / 255.0;
        out->srgb[i] = srgb_to_linear(i / 255.0);
    }
    /* Rounding to the nearest code happens in the encoded value. */
    for (int i = 0; i < 255; i++)
        out->step[i] = srgb_to_linear((i + 0.5) / 255);
}

/* The number of steps at or below x, by bisection over 255 sorted ones. */
static uint8_t srgb_encode(const struct hlr_tables *tables, double x)
{
    uint32_t lo = 0, hi = 255;
    while (lo < hi) {
        uint32_t mid = (lo + hi) / 2;
        if (tables->step[mid] <= x)
            lo = mid + 1;
        else
            hi = mid;
    }
    return (uint8_t)lo;
}

static uint32_t next_size(uint32_t n)
{
    return n > 1 ? n / 2 : 1;
}

/* How much of source texel s lies in target texel t, where t covers the part
 * t/to .. (t + 1)/to of `from` texels: in units of 1/to texel, so exact. */
static uint64_t overlap(uint64_t s, uint64_t t, uint64_t from, uint64_t to)
{
    uint64_t lo = t * from > s * to ? t * from : s * to;
    uint64_t hi = (t + 1) * from < (s + 1) * to ? (t + 1) * from
                                                : (s + 1) * to;
    return hi > lo ? hi - lo : 0;
}

static void box_texel(uint8_t out[4], const struct hlr_level *from,
                      const struct hlr_level *to, uint32_t x, uint32_t y,
                      bool srgb, const struct hlr_tables *tables)
{
    const double *rgb = srgb ? tables->srgb : tables->unorm;
    uint64_t fw = from->width, fh = from->height;
    uint64_t x0 = x * fw / to->width, y0 = y * fh / to->height;
    double sum[4] = { 0 }, area = (double)(fw * fh);
    for (uint64_t j = y0; j < fh; j++) {
        uint64_t wy = overlap(j, y, fh, to->height);
        if (wy == 0)
            break;
        for (uint64_t i = x0; i < fw; i++) {
            uint64_t wx = overlap(i, x, fw, to->width);
            if (wx == 0)
                break;
            const uint8_t *t = from->rgba + 4 * (j * fw + i);
            double weight = (double)(wx * wy);
            for (int k = 0; k < 3; k++)
                sum[k] += weight * rgb[t[k]];
            sum[3] += weight * tables->unorm[t[3]];
        }
    }
    for (int k = 0; k < 4; k++) {
        double v = sum[k] / area;
        out[k] = srgb && k < 3 ? srgb_encode(tables, v)
                               : (uint8_t)floor(v * 255 + 0.5);
    }
}

static size_t levels_of(struct hlr_chain *chain, const struct hlh_image *image)
{
    size_t bytes = 0;
    uint32_t w = image->width, h = image->height;
    chain->level[0] = (struct hlr_level){ w, h, image->rgba };
    chain->n_levels = 1;
    while (w > 1 || h > 1) {
        w = next_size(w);
        h = next_size(h);
        chain->level[chain->n_levels++] = (struct hlr_level){ w, h, NULL };
        bytes += 4 * (size_t)w * h;
    }
    return bytes;
}

bool hlr_chain_build(struct hlr_chain *out, const struct hlh_image *image,
                     bool srgb, const struct hlr_tables *tables)
{
    memset(out, 0, sizeof *out);
    out->srgb = srgb;
    size_t bytes = levels_of(out, image);
    uint8_t *at = out->store = malloc(bytes ? bytes : 1);
    if (!at) {
        out->n_levels = 0;
        return false;
    }
    for (uint32_t i = 1; i < out->n_levels; i++) {
        struct hlr_level *to = &out->level[i];
        to->rgba = at;
        for (uint32_t y = 0; y < to->height; y++)
            for (uint32_t x = 0; x < to->width; x++, at += 4)
                box_texel(at, to - 1, to, x, y, srgb, tables);
    }
    return true;
}

void hlr_chain_free(struct hlr_chain *chain)
{
    free(chain->store);
    memset(chain, 0, sizeof *chain);
}

/* log2 of the scale factor, unclamped; -HUGE_VAL where nothing changes. */
double hlr_chain_lambda(const struct hlr_chain *chain,
                        const struct hlr_uv *uv)
{
    double w = chain->level[0].width, h = chain->level[0].height;
    double x = hypot(uv->dudx * w, uv->dvdx * h);
    double y = hypot(uv->dudy * w, uv->dvdy * h);
    double rho = x > y ? x : y;
    return rho > 0 ? log2(rho) : -HUGE_VAL;
}

static uint32_t wrapped(double i, uint32_t size, enum hlh_wrap wrap)
{
    double n = size;
    if (wrap == HLH_WRAP_REPEAT)
        i -= floor(i / n) * n;
    else if (wrap == HLH_WRAP_MIRROR) {
        i -= floor(i / (2 * n)) * (2 * n);
        i = i < n ? i : 2 * n - 1 - i;
    }
    return (uint32_t)clamp(i, 0, n - 1);
}

static void bilinear(double out[4], const struct hlr_chain *chain,
                     uint32_t level, const struct hlr_tables *tables,
                     const struct hlh_texture *wrap, const struct hlr_uv *uv)
{
    const struct hlr_level *l = &chain->level[level];
    const double *rgb = chain->srgb ? tables->srgb : tables->unorm;
    double x = uv->u * l->width - 0.5, y = uv->v * l->height - 0.5;
    double fx = x - floor(x), fy = y - floor(y);
    for (int k = 0; k < 4; k++)
        out[k] = 0;
    for (int c = 0; c < 4; c++) {
        double dx = c & 1, dy = c >> 1;
        double weight = (c & 1 ? fx : 1 - fx) * (c >> 1 ? fy : 1 - fy);
        uint32_t i = wrapped(floor(x) + dx, l->width, wrap->wrap_u);
        uint32_t j = wrapped(floor(y) + dy, l->height, wrap->wrap_v);
        const uint8_t *t = l->rgba + 4 * ((size_t)j * l->width + i);
        for (int k = 0; k < 3; k++)
            out[k] += weight * rgb[t[k]];
        out[3] += weight * tables->unorm[t[3]];
    }
}

void hlr_chain_sample(double out[4], const struct hlr_chain *chain,
                      const struct hlr_tables *tables,
                      const struct hlh_texture *wrap,
                      const struct hlr_uv *uv)
{
    struct hlr_uv at = *uv;
    double far[4];
    if (!isfinite(at.u) || !isfinite(at.v))
        at.u = at.v = 0;
    double lambda = clamp(hlr_chain_lambda(chain, uv), 0, chain->n_levels - 1);
    double level = floor(lambda);
    bilinear(out, chain, (uint32_t)level, tables, wrap, &at);
    if (lambda == level)
        return;
    bilinear(far, chain, (uint32_t)level + 1, tables, wrap, &at);
    for (int k = 0; k < 4; k++)
        out[k] += (lambda - level) * (far[k] - out[k]);
}
