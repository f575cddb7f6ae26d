/* SPDX-License-Identifier: Zlib */
#ifndef PE_MEMORY_H
#define PE_MEMORY_H
/* Texture memory as a console's bytes. Seen as 32-bit words, low byte first,
 * it is the GPU's words with their bytes in one of five orders; texels of 8
 * and 16 bits are parts of such words. Levels begin at whole words. */
#include <string.h>
#include "platforms/packemu/pe.h"
#include "platforms/packemu/pe_math.h"

/* The first four are those of enum hl_endian. PE_ORDER_ARGB: big-endian
 * A8R8G8B8, so alpha first, where our words begin with red. */
enum pe_order {
    PE_ORDER_NONE, PE_ORDER_8IN16, PE_ORDER_8IN32, PE_ORDER_16IN32,
    PE_ORDER_ARGB
};

static inline bool pe_host_big(void)
{
    const uint32_t one = 1;
    uint8_t low;
    memcpy(&low, &one, 1);
    return low == 0;
}

/* In place, of words that lie in memory. */
void pe_words_from_memory(enum pe_order, uint32_t *words, size_t n);
void pe_words_to_memory(enum pe_order, uint32_t *words, size_t n);

/* n texels from `texel` on, samples counted, of a level's memory. */
void pe_texels_load(const uint8_t *level, enum pe_order, uint32_t bytes,
                    size_t texel, uint32_t n, uint32_t *words);
void pe_texels_store(uint8_t *level, enum pe_order, uint32_t bytes,
                     size_t texel, uint32_t n, const uint32_t *words);

static inline uint32_t pe_level_width(const struct pe_texture *t, uint32_t k)
{
    return t->desc.width >> k ? t->desc.width >> k : 1;
}

static inline uint32_t pe_level_height(const struct pe_texture *t, uint32_t k)
{
    return t->desc.height >> k ? t->desc.height >> k : 1;
}

/* ---- pe_edram.c ---------------------------------------------------------- */

/* Tiles of a surface: of a row, and in all. */
void pe_edram_size(const struct pe_state *, const struct hl_tex_desc *,
                   uint32_t *pitch, uint32_t *count);
/* Is this texture kept in EDRAM while it is drawn on? */
bool pe_edram_holds(const struct pe_state *, const struct hl_tex_desc *);
enum hl_result pe_edram_place(struct pe_state *, struct pe_texture *);
/* A row of `n` pixels from (x, y), one sample: words 32 bits each of pixels
 * `stride` words apart. */
void pe_edram_load(const struct pe_state *, const struct pe_texture *,
                   uint32_t x, uint32_t y, uint32_t sample, uint32_t n,
                   uint32_t stride, uint32_t *words);
void pe_edram_store(struct pe_state *, const struct pe_texture *, uint32_t x,
                    uint32_t y, uint32_t sample, uint32_t n, uint32_t stride,
                    const uint32_t *words);

/* ---- pe_memory.c --------------------------------------------------------- */

/* A row of pixels with their samples, words of texels in work. */
void pe_row_load(const struct pe_state *, const struct pe_texture *,
                 uint32_t x, uint32_t y, uint32_t n, uint32_t *words);
void pe_row_store(struct pe_state *, const struct pe_texture *, uint32_t x,
                  uint32_t y, uint32_t n, const uint32_t *words);

/* ---- pe_view.c ----------------------------------------------------------- */

/* Fill order, stored, view and remap from the desc and the profile. */
enum hl_result pe_view_make(struct pe_state *, struct pe_texture *);

/* ---- pe_fetch.c ---------------------------------------------------------- */

enum { PE_DECODE = 256 };
/* Words of n <= PE_DECODE texels as stages see them; NULL planes are not
 * made. */
void pe_view_decode(const struct pe_texture *, const uint32_t *words,
                    uint32_t n, float *const rgba[4]);
void pe_white(float *const rgba[4], uint32_t n);
#endif
