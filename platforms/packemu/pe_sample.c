/* SPDX-License-Identifier: Zlib */
/* Filtered sampling: rho = the longer of the two derivatives in texels, level
 * = log2 rho; texel centres at halves. A filter of equal texels gives them
 * back exactly. */
#include "platforms/packemu/pe_code.h"
#include "platforms/packemu/pe_memory.h"

enum { N = HL_PE_BATCH };

/* Footprints of a batch on one level each. */
struct taps {
    uint32_t level[N];
    float width[N], height[N];
    int32_t x[2][N], y[2][N];
    float fx[N], fy[N];
};

/* A coordinate in texels, 0..size; NaN goes to 0. */
static inline float texels(float u, float size, uint32_t wrap)
{
    if (wrap == HL_WRAP_REPEAT)
        u = u - pe_floor(u);
    else if (wrap == HL_WRAP_MIRROR) {
        float half = u * 0.5f, turn = 2.0f * (half - pe_floor(half));
        u = turn > 1.0f ? 2.0f - turn : turn;
    }
    return pe_clamp(u * size, 0.0f, size);
}

/* Texels a and b = a + 1 on one axis and how far towards b. a is -1..size
 * before it is wrapped, so that a conversion to int can round it. */
static inline void axis_of(const float *restrict u, const float *restrict size,
                           uint32_t n, uint32_t wrap, float shift,
                           int32_t *restrict a, int32_t *restrict b,
                           float *restrict f)
{
    for (uint32_t i = 0; i < n; i++) {
        float s = texels(u[i], size[i], wrap) - shift;
        float last = size[i] - 1.0f, low = (float)(int32_t)s;
        low = low > s ? low - 1.0f : low;
        float first = low < last ? low : last, next = low + 1.0f;
        f[i] = s - low;
        if (wrap == HL_WRAP_REPEAT) {
            first = first < 0.0f ? last : first;
            next = next > last ? 0.0f : next;
        } else {
            first = first > 0.0f ? first : 0.0f;
            next = next < last ? next : last;
        }
        a[i] = (int32_t)first;
        b[i] = (int32_t)next;
    }
}

static void axis(const float *u, const float *size, uint32_t n, uint32_t wrap,
                 float shift, int32_t (*at)[N], float *f)
{
    if (wrap == HL_WRAP_REPEAT)
        axis_of(u, size, n, HL_WRAP_REPEAT, shift, at[0], at[1], f);
    else if (wrap == HL_WRAP_MIRROR)
        axis_of(u, size, n, HL_WRAP_MIRROR, shift, at[0], at[1], f);
    else
        axis_of(u, size, n, HL_WRAP_CLAMP, shift, at[0], at[1], f);
}

static void footprints(const struct pe_view *v, const float *u, const float *w,
                       uint32_t n, struct taps *t)
{
    float shift = v->filter == HL_FILTER_NEAREST ? 0.0f : 0.5f;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = t->level[i];
        t->width[i] = (float)(int32_t)pe_level_width(v->texture, k);
        t->height[i] = (float)(int32_t)pe_level_height(v->texture, k);
    }
    axis(u, t->width, n, v->wrap_u, shift, t->x, t->fx);
    axis(w, t->height, n, v->wrap_v, shift, t->y, t->fy);
}

/* ---- texels -------------------------------------------------------------- */

/* `bytes` a constant: what is copied is then a load. */
static inline void load(const struct pe_texture *t, const struct taps *at,
                        size_t bytes, int n_taps, uint32_t n,
                        uint32_t (*words)[N * 4])
{
    const size_t step = bytes * t->samples, per = bytes / 4;
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t *level = t->memory + t->level[at->level[i]];
        size_t row = (size_t)(int32_t)at->width[i] * step;
        const uint8_t *top = level + (size_t)at->y[0][i] * row;
        const uint8_t *low = level + (size_t)at->y[1][i] * row;
        size_t x0 = (size_t)at->x[0][i] * step;
        size_t x1 = (size_t)at->x[1][i] * step;
        memcpy(words[0] + i * per, top + x0, bytes);
        if (n_taps == 1)
            continue;
        memcpy(words[1] + i * per, top + x1, bytes);
        memcpy(words[2] + i * per, low + x0, bytes);
        memcpy(words[3] + i * per, low + x1, bytes);
    }
}

static void load_narrow(const struct pe_texture *t, const struct taps *at,
                        uint32_t bytes, int n_taps, uint32_t n,
                        uint32_t (*words)[N * 4])
{
    for (int k = 0; k < n_taps; k++)
        for (uint32_t i = 0; i < n; i++) {
            size_t row = (size_t)at->y[k >> 1][i] * (size_t)at->width[i];
            pe_texels_load(t->memory + t->level[at->level[i]],
                           (enum pe_order)t->view_order, bytes,
                           (row + (size_t)at->x[k & 1][i]) * t->samples, 1,
                           words[k] + i);
        }
}

/* The texel at the corner, or all four: 00 10 01 11. */
static void load_taps(const struct pe_texture *t, const struct taps *at,
                      int n_taps, uint32_t n, uint32_t (*words)[N * 4])
{
    const uint32_t bytes = hl_format_info(t->view)->bytes;
    if (bytes < 4) {
        load_narrow(t, at, bytes, n_taps, n, words);
        return;
    }
    if (bytes == 4)
        load(t, at, 4, n_taps, n, words);
    else if (bytes == 8)
        load(t, at, 8, n_taps, n, words);
    else
        load(t, at, 16, n_taps, n, words);
    for (int k = 0; k < n_taps; k++)
        pe_words_from_memory((enum pe_order)t->view_order, words[k],
                             (size_t)n * t->words);
}

static void decode(const struct pe_texture *t, const uint32_t *words,
                   uint32_t n, float (*out)[N])
{
    float *const rgba[4] = { out[0], out[1], out[2], out[3] };
    pe_view_decode(t, words, n, rgba);
}

static void mix(float (*restrict a)[N], float (*restrict b)[N],
                const float *restrict f, uint32_t n)
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n; i++)
            a[c][i] = a[c][i] + f[i] * (b[c][i] - a[c][i]);
}

static void bilinear(const struct pe_texture *t, const struct taps *at,
                     uint32_t n, float (*out)[N])
{
    uint32_t words[4][N * 4];
    float right[4][N], low[4][N];
    load_taps(t, at, 4, n, words);
    decode(t, words[0], n, out);
    decode(t, words[1], n, right);
    mix(out, right, at->fx, n);
    decode(t, words[2], n, low);
    decode(t, words[3], n, right);
    mix(low, right, at->fx, n);
    mix(out, low, at->fy, n);
}

static void nearest(const struct pe_texture *t, const struct taps *at,
                    uint32_t n, float (*out)[N])
{
    uint32_t words[1][N * 4];
    load_taps(t, at, 1, n, words);
    decode(t, words[0], n, out);
}

/* ---- levels -------------------------------------------------------------- */

/* Level and what is left of it, 0 where the next adds nothing. False: all on
 * level 0 alone. */
static bool levels(const struct pe_texture *t, const float (*duv)[N],
                   uint32_t n, uint32_t *level, float *rest)
{
    float w = (float)(int32_t)t->desc.width, h = (float)(int32_t)t->desc.height;
    float top = (float)(int32_t)(t->desc.mips - 1);
    uint32_t any = 0;
    for (uint32_t i = 0; i < n; i++) {
        float ax = duv[0][i] * w, ay = duv[1][i] * h;
        float bx = duv[2][i] * w, by = duv[3][i] * h;
        float a = ax * ax + ay * ay, b = bx * bx + by * by;
        float m = a > b ? a : b;
        float lod = m > 1.0f ? 0.5f * pe_log2(m) : 0.0f;
        lod = lod < top ? lod : top;
        float low = pe_floor(lod);
        level[i] = (uint32_t)(int32_t)low;
        rest[i] = lod - low;
        any |= pe_bits(lod);
    }
    return any != 0;
}

static void trilinear(const struct pe_view *v, const float *u, const float *w,
                      uint32_t n, struct taps *t, const float *rest,
                      float (*out)[N])
{
    float next[4][N];
    footprints(v, u, w, n, t);
    bilinear(v->texture, t, n, out);
    for (uint32_t i = 0; i < n; i++)
        t->level[i] += t->level[i] < v->texture->desc.mips - 1;
    footprints(v, u, w, n, t);
    bilinear(v->texture, t, n, next);
    /* Where nothing is left, infinite texels beyond must not turn to NaN. */
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n; i++) {
            float x = out[c][i] + rest[i] * (next[c][i] - out[c][i]);
            out[c][i] = rest[i] > 0.0f ? x : out[c][i];
        }
}

void pe_sample(const struct pe_view *v, const float *u, const float *w,
               const float (*duv)[HL_PE_BATCH], uint32_t n,
               float (*out)[HL_PE_BATCH])
{
    float *const rgba[4] = { out[0], out[1], out[2], out[3] };
    struct taps t;
    float rest[N];
    if (!v->texture || !v->texture->memory) {
        pe_white(rgba, n);
        return;
    }
    if (v->filter == HL_FILTER_TRILINEAR && duv && v->texture->desc.mips > 1 &&
        levels(v->texture, duv, n, t.level, rest)) {
        trilinear(v, u, w, n, &t, rest, out);
        return;
    }
    memset(t.level, 0, sizeof t.level);
    footprints(v, u, w, n, &t);
    if (v->filter == HL_FILTER_NEAREST)
        nearest(v->texture, &t, n, out);
    else
        bilinear(v->texture, &t, n, out);
}
