/* SPDX-License-Identifier: Zlib */
/* Texels as stages see them. Every coordinate is clamped to its level, so
 * that no number a stage computes reads past a texture. */
#include "platforms/packemu/pe_memory.h"

static int32_t clamped(int32_t i, uint32_t size)
{
    int32_t last = (int32_t)size - 1;
    return i < 0 ? 0 : i < last ? i : last;
}

/* ---- numbers ------------------------------------------------------------- */

void pe_white(float *const rgba[4], uint32_t n)
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; rgba[c] && i < n; i++)
            rgba[c][i] = 1.0f;
}

static void remapped(const struct pe_texture *t, const uint32_t *words,
                     uint32_t n, float *const rgba[4])
{
    float plane[6][PE_DECODE];
    float *const made[4] = { plane[0], plane[1], plane[2], plane[3] };
    pe_decode(t->view, words, n, made);
    for (uint32_t i = 0; i < n; i++) {
        plane[4][i] = 0.0f;
        plane[5][i] = 1.0f;
    }
    for (int c = 0; c < 4; c++)
        if (rgba[c])
            memcpy(rgba[c], plane[t->remap[c]], n * sizeof(float));
}

void pe_view_decode(const struct pe_texture *t, const uint32_t *words,
                    uint32_t n, float *const rgba[4])
{
    if (t->remapped)
        remapped(t, words, n, rgba);
    else
        pe_decode(t->view, words, n, rgba);
}

/* ---- rows ---------------------------------------------------------------- */

static void row_words(const struct pe_texture *t, uint32_t level, int32_t x,
                      int32_t y, uint32_t n, uint32_t *words)
{
    uint32_t w = pe_level_width(t, level);
    uint32_t bytes = hl_format_info(t->view)->bytes;
    const uint8_t *from = t->memory + t->level[level];
    size_t row = (size_t)clamped(y, pe_level_height(t, level)) * w;
    enum pe_order order = (enum pe_order)t->view_order;
    if (x >= 0 && n <= w && (uint32_t)x <= w - n && t->samples == 1) {
        pe_texels_load(from, order, bytes, row + (uint32_t)x, n, words);
        return;
    }
    for (uint32_t i = 0; i < n; i++, words += t->words) {
        int64_t at = (int64_t)x + i;
        int32_t in = at < 0 ? 0 : at < w ? (int32_t)at : (int32_t)w - 1;
        pe_texels_load(from, order, bytes, (row + (uint32_t)in) * t->samples,
                       1, words);
    }
}

void pe_fetch(const struct pe_view *v, uint32_t level, int32_t x, int32_t y,
              float out[4])
{
    const struct pe_texture *t = v->texture;
    float *const rgba[4] = { out, out + 1, out + 2, out + 3 };
    uint32_t words[4];
    if (!t || !t->memory) {
        pe_white(rgba, 1);
        return;
    }
    row_words(t, level < t->desc.mips ? level : t->desc.mips - 1, x, y, 1,
              words);
    pe_view_decode(t, words, 1, rgba);
}

void pe_fetch_texels(const struct pe_view *v, const int32_t *x,
                     const int32_t *y, uint32_t n, float (*out)[HL_PE_BATCH])
{
    const struct pe_texture *t = v->texture;
    float *const rgba[4] = { out[0], out[1], out[2], out[3] };
    uint32_t words[HL_PE_BATCH * 4];
    words[0] = 0;                /* n may be 0                               */
    if (!t || !t->memory) {
        pe_white(rgba, n);
        return;
    }
    for (uint32_t i = 0; i < n; i++)
        row_words(t, 0, x[i], y[i], 1, words + i * t->words);
    pe_view_decode(t, words, n, rgba);
}

void pe_fetch_row(const struct pe_view *v, int32_t x, int32_t y, uint32_t n,
                  float *const rgba[4])
{
    const struct pe_texture *t = v->texture;
    uint32_t words[PE_DECODE * 4];
    if (!t || !t->memory) {
        pe_white(rgba, n);
        return;
    }
    for (uint32_t at = 0, m; at < n; at += m) {
        float *part[4];
        m = n - at < PE_DECODE ? n - at : PE_DECODE;
        for (int c = 0; c < 4; c++)
            part[c] = rgba[c] ? rgba[c] + at : NULL;
        row_words(t, 0, x, y, m, words);
        pe_view_decode(t, words, m, part);
        x = x < INT32_MAX - PE_DECODE ? x + (int32_t)m : x;
    }
}

/* ---- gathers ------------------------------------------------------------- */

/* `size` bytes of every corner, `offset` bytes into the texel. */
static inline void corners(const struct pe_texture *t, size_t offset,
                           size_t size, const int32_t *x, const int32_t *y,
                           uint32_t n, uint32_t *const out[4])
{
    const int32_t w = (int32_t)t->desc.width, h = (int32_t)t->desc.height;
    const size_t step = (size_t)hl_format_info(t->view)->bytes * t->samples;
    const size_t row = step * t->desc.width, words = size / 4;
    const uint8_t *from = t->memory + offset;
    for (uint32_t i = 0; i < n; i++) {
        int32_t x0 = x[i] > 0 ? x[i] : 0, y0 = y[i] > 0 ? y[i] : 0;
        x0 = x0 < w ? x0 : w - 1;
        y0 = y0 < h ? y0 : h - 1;
        size_t right = ((x[i] >= 0) & (x0 < w - 1)) ? step : 0;
        size_t down = ((y[i] >= 0) & (y0 < h - 1)) ? row : 0;
        const uint8_t *p = from + (size_t)y0 * row + (size_t)x0 * step;
        memcpy(out[0] + i * words, p, size);
        memcpy(out[1] + i * words, p + right, size);
        memcpy(out[2] + i * words, p + down, size);
        memcpy(out[3] + i * words, p + down + right, size);
    }
}

static int32_t next(int32_t i, int more)
{
    return more && i < INT32_MAX ? i + 1 : i;
}

static void narrow_corners(const struct pe_texture *t, const int32_t *x,
                           const int32_t *y, uint32_t n,
                           uint32_t *const out[4])
{
    for (int k = 0; k < 4; k++)
        for (uint32_t i = 0; i < n; i++)
            row_words(t, 0, next(x[i], k & 1), next(y[i], k >> 1), 1,
                      out[k] + i);
}

/* Whole texels of 2 x 2, all their words. */
PE_WIDE
static void gather_texels(const struct pe_texture *t, const int32_t *x,
                          const int32_t *y, uint32_t n,
                          uint32_t *const out[4])
{
    uint32_t bytes = hl_format_info(t->view)->bytes;
    if (bytes < 4) {
        narrow_corners(t, x, y, n, out);
        return;
    }
    if (bytes == 4)
        corners(t, 0, 4, x, y, n, out);
    else if (bytes == 8)
        corners(t, 0, 8, x, y, n, out);
    else
        corners(t, 0, 16, x, y, n, out);
    for (int k = 0; k < 4; k++)
        pe_words_from_memory((enum pe_order)t->view_order, out[k],
                             (size_t)n * t->words);
}

PE_WIDE
void pe_gather_words(const struct pe_view *v, uint32_t word, const int32_t *x,
                     const int32_t *y, uint32_t n,
                     uint32_t (*out)[HL_PE_BATCH])
{
    const struct pe_texture *t = v->texture;
    uint32_t *const taps[4] = { out[0], out[1], out[2], out[3] };
    if (!t || !t->memory || word >= t->words) {
        memset(out, 255, 4 * sizeof *out);
        return;
    }
    if (t->words == 1) {
        gather_texels(t, x, y, n, taps);
        return;
    }
    corners(t, 4 * (size_t)word, 4, x, y, n, taps);
    for (int k = 0; k < 4; k++)
        pe_words_from_memory((enum pe_order)t->view_order, out[k], n);
}

void pe_gather(const struct pe_view *v, const int32_t *x, const int32_t *y,
               uint32_t n, float (*out)[4][HL_PE_BATCH])
{
    const struct pe_texture *t = v->texture;
    const bool real = t && t->memory;
    uint32_t words[4][HL_PE_BATCH * 4];
    uint32_t *const taps[4] = { words[0], words[1], words[2], words[3] };
    if (real)
        gather_texels(t, x, y, n, taps);
    for (int k = 0; k < 4; k++) {
        float *const rgba[4] = { out[k][0], out[k][1], out[k][2], out[k][3] };
        if (real)
            pe_view_decode(t, words[k], n, rgba);
        else
            pe_white(rgba, n);
    }
}
