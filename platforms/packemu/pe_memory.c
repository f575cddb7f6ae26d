/* SPDX-License-Identifier: Zlib */
/* Words to and from texture memory, and bins to and from wherever their
 * targets are. */
#include "platforms/packemu/pe_code.h"
#include "platforms/packemu/pe_memory.h"

/* ---- orders of bytes ----------------------------------------------------- */

static inline uint32_t swap8in16(uint32_t w)
{
    return (w & 0x00ff00ffu) << 8 | (w >> 8 & 0x00ff00ffu);
}

static inline uint32_t swap16in32(uint32_t w)
{
    return w << 16 | w >> 16;
}

static void swap_bytes(uint32_t *w, size_t n)
{
    for (size_t i = 0; i < n; i++)
        w[i] = swap16in32(swap8in16(w[i]));
}

static void rotate(uint32_t *w, size_t n, uint32_t left)
{
    for (size_t i = 0; i < n; i++)
        w[i] = w[i] << left | w[i] >> (32 - left);
}

/* Orders that undo themselves. */
static void reorder(enum pe_order order, uint32_t *w, size_t n)
{
    if (order == PE_ORDER_8IN16)
        for (size_t i = 0; i < n; i++)
            w[i] = swap8in16(w[i]);
    else if (order == PE_ORDER_16IN32)
        for (size_t i = 0; i < n; i++)
            w[i] = swap16in32(w[i]);
    else if (order == PE_ORDER_8IN32)
        swap_bytes(w, n);
}

void pe_words_from_memory(enum pe_order order, uint32_t *words, size_t n)
{
    if (pe_host_big())
        swap_bytes(words, n);
    if (order == PE_ORDER_ARGB)
        rotate(words, n, 24);
    else
        reorder(order, words, n);
}

void pe_words_to_memory(enum pe_order order, uint32_t *words, size_t n)
{
    if (order == PE_ORDER_ARGB)
        rotate(words, n, 8);
    else
        reorder(order, words, n);
    if (pe_host_big())
        swap_bytes(words, n);
}

/* What an order does to the address of a byte. */
static size_t flip_of(enum pe_order order)
{
    return order == PE_ORDER_8IN16 ? 1 : order == PE_ORDER_8IN32 ? 3
           : order == PE_ORDER_16IN32 ? 2 : 0;
}

void pe_texels_load(const uint8_t *level, enum pe_order order, uint32_t bytes,
                    size_t texel, uint32_t n, uint32_t *words)
{
    const size_t flip = flip_of(order);
    if (bytes >= 4) {
        memcpy(words, level + texel * bytes, (size_t)n * bytes);
        pe_words_from_memory(order, words, (size_t)n * bytes / 4);
    } else if (bytes == 2)
        for (uint32_t i = 0; i < n; i++) {
            size_t at = 2 * (texel + i);
            words[i] = level[at ^ flip] |
                       (uint32_t)level[(at + 1) ^ flip] << 8;
        }
    else
        for (uint32_t i = 0; i < n; i++)
            words[i] = level[(texel + i) ^ flip];
}

/* Narrow texels are stored byte by byte: their neighbours in the same word
 * may be another thread's. */
void pe_texels_store(uint8_t *level, enum pe_order order, uint32_t bytes,
                     size_t texel, uint32_t n, const uint32_t *words)
{
    const size_t flip = flip_of(order);
    uint32_t part[256];
    size_t left = bytes >= 4 ? (size_t)n * bytes / 4 : 0;
    uint8_t *to = level + texel * bytes;
    if (order == PE_ORDER_NONE && !pe_host_big()) {
        memcpy(to, words, 4 * left);
        left = 0;
    }
    for (size_t m; left > 0; left -= m, words += m, to += 4 * m) {
        m = left < 256 ? left : 256;
        memcpy(part, words, m * 4);
        pe_words_to_memory(order, part, m);
        memcpy(to, part, m * 4);
    }
    for (uint32_t i = 0; bytes < 4 && i < n; i++) {
        size_t at = bytes * (texel + i);
        level[at ^ flip] = (uint8_t)words[i];
        if (bytes == 2)
            level[(at + 1) ^ flip] = (uint8_t)(words[i] >> 8);
    }
}

/* ---- rows of targets ----------------------------------------------------- */

void pe_row_load(const struct pe_state *s, const struct pe_texture *t,
                 uint32_t x, uint32_t y, uint32_t n, uint32_t *words)
{
    uint32_t samples = t->desc.samples;
    if (!t->tile_count) {
        size_t texel = ((size_t)y * t->desc.width + x) * samples;
        pe_texels_load(t->memory, (enum pe_order)t->order,
                       hl_format_info(t->desc.format)->bytes, texel,
                       n * samples, words);
        return;
    }
    for (uint32_t k = 0; k < samples; k++)
        pe_edram_load(s, t, x, y, k, n, samples * t->words,
                      words + k * t->words);
}

void pe_row_store(struct pe_state *s, const struct pe_texture *t, uint32_t x,
                  uint32_t y, uint32_t n, const uint32_t *words)
{
    uint32_t samples = t->desc.samples;
    if (!t->tile_count) {
        size_t texel = ((size_t)y * t->desc.width + x) * samples;
        pe_texels_store(t->memory, (enum pe_order)t->order,
                        hl_format_info(t->desc.format)->bytes, texel,
                        n * samples, words);
        return;
    }
    for (uint32_t k = 0; k < samples; k++)
        pe_edram_store(s, t, x, y, k, n, samples * t->words,
                       words + k * t->words);
}

/* ---- bins ---------------------------------------------------------------- */

void pe_load_color(const struct pe_state *s, uint32_t slot,
                   const struct hl_rect *rect, uint32_t *words)
{
    const struct pe_texture *t = &s->tex[slot];
    uint32_t w = (uint32_t)rect->width, h = (uint32_t)rect->height;
    for (uint32_t y = 0; y < h; y++, words += w * t->desc.samples * t->words)
        pe_row_load(s, t, (uint32_t)rect->x, (uint32_t)rect->y + y, w, words);
}

void pe_store_color(struct pe_state *s, uint32_t slot,
                    const struct hl_rect *rect, const uint32_t *words)
{
    const struct pe_texture *t = &s->tex[slot];
    uint32_t w = (uint32_t)rect->width, h = (uint32_t)rect->height;
    for (uint32_t y = 0; y < h; y++, words += w * t->desc.samples * t->words)
        pe_row_store(s, t, (uint32_t)rect->x, (uint32_t)rect->y + y, w,
                     words);
}

/* Words of depth: 24-bit codes above 8 of stencil; the code alone; or the
 * code and a word of stencil. */
enum depth_words { DEPTH_ALONE, DEPTH_PACKED, DEPTH_TWO };

static enum depth_words depth_words(const struct pe_texture *t)
{
    return t->desc.format == HL_FORMAT_D24_UNORM_S8 ||
           t->desc.format == HL_FORMAT_D24_FLOAT_S8 ? DEPTH_PACKED
           : t->words > 1 ? DEPTH_TWO : DEPTH_ALONE;
}

static void split(enum depth_words kind, const uint32_t *restrict words,
                  uint32_t n, uint32_t *restrict codes,
                  uint8_t *restrict stencil)
{
    uint32_t shift = kind == DEPTH_PACKED ? 8 : 0;
    if (kind == DEPTH_TWO)
        for (uint32_t i = 0; i < n; i++)
            codes[i] = words[2 * i];
    else
        for (uint32_t i = 0; i < n; i++)
            codes[i] = words[i] >> shift;
    if (stencil && kind == DEPTH_TWO)
        for (uint32_t i = 0; i < n; i++)
            stencil[i] = (uint8_t)words[2 * i + 1];
    else if (stencil)
        for (uint32_t i = 0; i < n; i++)
            stencil[i] = (uint8_t)(shift ? words[i] : 0);
}

static void join(enum depth_words kind, const uint32_t *restrict codes,
                 const uint8_t *restrict stencil, uint32_t n,
                 uint32_t *restrict words)
{
    if (kind == DEPTH_ALONE)
        memcpy(words, codes, n * sizeof *words);
    else if (kind == DEPTH_TWO)
        for (uint32_t i = 0; i < n; i++) {
            words[2 * i] = codes[i];
            words[2 * i + 1] = stencil ? stencil[i] : 0;
        }
    else if (stencil)
        for (uint32_t i = 0; i < n; i++)
            words[i] = codes[i] << 8 | stencil[i];
    else
        for (uint32_t i = 0; i < n; i++)
            words[i] = codes[i] << 8;
}

enum { ROW = PE_BIN * 8 * 2 };   /* words of a bin's row: 8 samples of two   */

void pe_load_depth(const struct pe_state *s, uint32_t slot,
                   const struct hl_rect *rect, uint32_t *codes,
                   uint8_t *stencil)
{
    const struct pe_texture *t = &s->tex[slot];
    const enum depth_words kind = depth_words(t);
    uint32_t words[ROW], n = (uint32_t)rect->width * t->desc.samples;
    for (int32_t y = rect->y; y < rect->y + rect->height; y++, codes += n) {
        pe_row_load(s, t, (uint32_t)rect->x, (uint32_t)y,
                    (uint32_t)rect->width, words);
        split(kind, words, n, codes, stencil);
        stencil = stencil ? stencil + n : NULL;
    }
}

void pe_store_depth(struct pe_state *s, uint32_t slot,
                    const struct hl_rect *rect, const uint32_t *codes,
                    const uint8_t *stencil)
{
    const struct pe_texture *t = &s->tex[slot];
    const enum depth_words kind = depth_words(t);
    uint32_t words[ROW], n = (uint32_t)rect->width * t->desc.samples;
    for (int32_t y = rect->y; y < rect->y + rect->height; y++, codes += n) {
        join(kind, codes, stencil, n, words);
        pe_row_store(s, t, (uint32_t)rect->x, (uint32_t)y,
                     (uint32_t)rect->width, words);
        stencil = stencil ? stencil + n : NULL;
    }
}
