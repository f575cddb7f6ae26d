/* SPDX-License-Identifier: Zlib */
/* Blending: decode what is there, combine, encode. Numbers of a fixed range
 * are clamped to it before they are combined, as Vulkan and Xenos do; the
 * result is clamped by the encoding. */
#include <string.h>
#include "platforms/packemu/pe.h"

enum { CHUNK = 128, WORDS = 4 };

struct blender {
    enum hl_format format;
    enum hl_blend blend;
    float constant, scale;
    bool prepare;                /* scale is not 1, or there is a range      */
    float low[4], high[4];       /* range; equal: none                       */
};

/* ---- ranges -------------------------------------------------------------- */

static void set_range(struct blender *b, uint32_t from, uint32_t to,
                      float low, float high)
{
    for (uint32_t c = from; c < to; c++) {
        b->low[c] = low;
        b->high[c] = high;
    }
}

static float clamp(float x, float low, float high)
{
    x = x == x ? x : 0.0f;
    x = x > low ? x : low;
    return x < high ? x : high;
}

static void find_range(struct blender *b)
{
    switch (hl_format_info(b->format)->kind) {
    case HL_KIND_UNORM:
    case HL_KIND_SRGB: set_range(b, 0, 4, 0.0f, 1.0f); break;
    case HL_KIND_SNORM: set_range(b, 0, 4, -1.0f, 1.0f); break;
    case HL_KIND_FIXED32: set_range(b, 0, 4, -32.0f, 32.0f); break;
    default: break;
    }
    if (b->format == HL_FORMAT_RGB10A2_FLOAT) {
        set_range(b, 0, 3, 0.0f, 31.875f);
        set_range(b, 3, 4, 0.0f, 1.0f);
    }
    b->prepare = b->scale != 1.0f || b->high[0] > b->low[0];
    if (b->high[0] > b->low[0])
        b->constant = clamp(b->constant, b->low[0], b->high[0]);
}

/* 2^bias, by products that are exact. */
static float power(int bias)
{
    float scale = 1.0f;
    for (; bias > 0; bias--)
        scale *= 2.0f;
    for (; bias < 0; bias++)
        scale *= 0.5f;
    return scale;
}

/* ---- combining ----------------------------------------------------------- */

static void prepare(const struct blender *b, uint32_t c,
                    const float *restrict x, uint32_t n, float *restrict out)
{
    float scale = b->scale, low = b->low[c], high = b->high[c];
    if (high > low)
        for (uint32_t i = 0; i < n; i++)
            out[i] = clamp(x[i] * scale, low, high);
    else
        for (uint32_t i = 0; i < n; i++)
            out[i] = x[i] * scale;
}

static void add(float k, const float *restrict s, uint32_t n,
                float *restrict d)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = s[i] + d[i] * k;
}

static void over(const float *restrict s, const float *restrict a, uint32_t n,
                 float *restrict d)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = s[i] * a[i] + d[i] * (1.0f - a[i]);
}

static void over_alpha(const float *restrict a, uint32_t n,
                       float *restrict d)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = a[i] + d[i] * (1.0f - a[i]);
}

static void add_alpha(const float *restrict s, const float *restrict a,
                      uint32_t n, float *restrict d)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = s[i] * a[i] + d[i];
}

static void greater(const float *restrict s, uint32_t n, float *restrict d)
{
    for (uint32_t i = 0; i < n; i++)
        d[i] = s[i] > d[i] ? s[i] : d[i];
}

/* Channel c of the source and what is there, into the latter. */
static void combine(const struct blender *b, uint32_t c, const float *s,
                    const float *a, uint32_t n, float *d)
{
    switch (b->blend) {
    case HL_BLEND_OFF: memcpy(d, s, n * sizeof *d); break;
    case HL_BLEND_ADD: add(1.0f, s, n, d); break;
    case HL_BLEND_SHIFT: add(b->constant, s, n, d); break;
    case HL_BLEND_MAX: greater(s, n, d); break;
    case HL_BLEND_OVER:
        if (c < 3)
            over(s, a, n, d);
        else
            over_alpha(a, n, d);
        break;
    case HL_BLEND_ADD_ALPHA:
        if (c < 3)
            add_alpha(s, a, n, d);
        break;
    }
}

/* ---- texels -------------------------------------------------------------- */

static void keep(const uint8_t *mask, uint32_t n, uint32_t words,
                 const uint32_t *made, uint32_t *out)
{
    for (uint32_t i = 0; i < n; i++)
        if (mask[i])
            memcpy(out + i * words, made + i * words, words * sizeof *out);
}

static void blend_chunk(const struct blender *b, const float *const rgba[4],
                        const uint8_t *mask, uint32_t n, uint32_t *words)
{
    float source[4][CHUNK], there[4][CHUNK];
    float *const d[4] = { there[0], there[1], there[2], there[3] };
    const float *s[4] = { rgba[0], rgba[1], rgba[2], rgba[3] };
    uint32_t made[CHUNK * WORDS], stride = pe_words(b->format);
    for (uint32_t c = 0; c < 4 && b->prepare; c++) {
        prepare(b, c, rgba[c], n, source[c]);
        s[c] = source[c];
    }
    if (b->blend != HL_BLEND_OFF) {
        pe_decode(b->format, words, n, d);
        for (uint32_t c = 0; c < 4; c++)
            combine(b, c, s[c], s[3], n, d[c]);
        for (uint32_t c = 0; c < 4; c++)
            s[c] = d[c];
    }
    pe_encode(b->format, s, n, mask ? made : words);
    if (mask)
        keep(mask, n, stride, made, words);
}

void pe_blend(enum hl_format format, enum hl_blend blend, float constant,
              int bias, const float *const rgba[4], const uint8_t *mask,
              uint32_t n, uint32_t *words)
{
    struct blender b = { .format = format, .blend = blend,
                         .constant = constant, .scale = power(bias) };
    uint32_t stride = pe_words(format);
    if (hl_format_info(format)->kind == HL_KIND_UINT)
        b.scale = 1.0f;          /* planes of bits                           */
    if (blend != HL_BLEND_OFF)
        find_range(&b);
    else
        b.prepare = b.scale != 1.0f;
    for (uint32_t at = 0; at < n; at += CHUNK) {
        const float *const s[4] = { rgba[0] + at, rgba[1] + at, rgba[2] + at,
                                    rgba[3] + at };
        blend_chunk(&b, s, mask ? mask + at : NULL,
                    n - at < CHUNK ? n - at : CHUNK, words + at * stride);
    }
}
