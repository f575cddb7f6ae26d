/* SPDX-License-Identifier: Zlib */
/* EDRAM: tiles of 80 x 16 samples of 32 bits, addressed modulo their number.
 * Nothing keeps surfaces apart: two that lie on the same tiles destroy each
 * other, as on the machine. 64-bit samples take two tiles' width, 40 samples
 * a tile; how the machine lays them inside a tile is not known. */
#include "hal/text.h"
#include "platforms/packemu/pe_memory.h"

static uint32_t across(uint32_t samples) { return samples >= 4 ? 2 : 1; }
static uint32_t down(uint32_t samples) { return samples >= 2 ? 2 : 1; }

static uint32_t ceil_div(uint32_t n, uint32_t by)
{
    return n / by + (n % by != 0);
}

static bool wide(const struct hl_tex_desc *t)
{
    return hl_format_info(t->format)->bytes == 8;
}

void pe_edram_size(const struct pe_state *s, const struct hl_tex_desc *t,
                   uint32_t *pitch, uint32_t *count)
{
    const struct hl_profile *p = &s->profile;
    *pitch = ceil_div(t->width * across(t->samples), p->edram_tile_width)
             << wide(t);
    *count = (uint32_t)hl_edram_tiles(p, t->format, t->width, t->height,
                                      t->samples);
}

/* The formats that Xenos draws to. Others are drawn to memory: they are
 * there for the tools around a frame, not for the frame. */
bool pe_edram_holds(const struct pe_state *s, const struct hl_tex_desc *t)
{
    if (s->profile.edram_tiles == 0 || !(t->usage & HL_TEX_TARGET))
        return false;
    switch (t->format) {
    case HL_FORMAT_RGBA8_UNORM:
    case HL_FORMAT_RGBA8_SRGB:
    case HL_FORMAT_RGB10A2_UNORM:
    case HL_FORMAT_RGB10A2_FLOAT:
    case HL_FORMAT_RG16_FIXED32:
    case HL_FORMAT_RGBA16_FIXED32:
    case HL_FORMAT_RG16_FLOAT:
    case HL_FORMAT_RGBA16_FLOAT:
    case HL_FORMAT_R32_FLOAT:
    case HL_FORMAT_D24_UNORM_S8:
    case HL_FORMAT_D24_FLOAT_S8:
        return true;
    default:
        return false;
    }
}

/* ---- placement ----------------------------------------------------------- */

/* Do tiles [a, a + n) and [b, b + m) meet on a ring of `ring` tiles? */
static bool meet(uint32_t a, uint32_t n, uint32_t b, uint32_t m, uint32_t ring)
{
    return (b + ring - a) % ring < n || (a + ring - b) % ring < m;
}

/* The live surface that [first, first + count) meets, or NULL. */
static const struct pe_texture *in_the_way(const struct pe_state *s,
                                           uint32_t first, uint32_t count)
{
    for (uint32_t i = 0; i < s->max_tex; i++) {
        const struct pe_texture *t = &s->tex[i];
        if (t->tile_count && meet(first, count, t->tile, t->tile_count,
                                  s->profile.edram_tiles))
            return t;
    }
    return NULL;
}

/* First fit: after a surface in the way, none lower can fit before its end.
 * Places of the device's choice do not wrap. */
static bool first_fit(const struct pe_state *s, uint32_t count, uint32_t *at)
{
    uint32_t ring = s->profile.edram_tiles, first = 0;
    while (first < ring && count <= ring - first) {
        const struct pe_texture *t = in_the_way(s, first, count);
        if (!t) {
            *at = first;
            return true;
        }
        uint32_t end = (t->tile + t->tile_count) % ring;
        if (end <= first)
            return false;
        first = end;
    }
    return false;
}

static uint32_t free_tiles(const struct pe_state *s)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->profile.edram_tiles; i++)
        n += !in_the_way(s, i, 1);
    return n;
}

static enum hl_result too_large(struct pe_state *s, const struct pe_texture *t)
{
    char line[160];
    struct hl_text text = hl_text_begin(line, sizeof line);
    hl_text_uint(&text, t->tile_count);
    hl_text_str(&text, " EDRAM tiles are needed in one piece; of ");
    hl_text_uint(&text, s->profile.edram_tiles);
    hl_text_str(&text, " there are free ");
    hl_text_uint(&text, free_tiles(s));
    hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_MEMORY,
              t->desc.label ? t->desc.label
                            : hl_format_info(t->desc.format)->name,
              ": ", line);
    return HL_ERR_MEMORY;
}

enum hl_result pe_edram_place(struct pe_state *s, struct pe_texture *t)
{
    struct pe_texture placed = *t;
    uint32_t ring = s->profile.edram_tiles, asked = t->desc.console.edram_tile;
    pe_edram_size(s, &t->desc, &placed.tile_pitch, &placed.tile_count);
    if (asked)
        placed.tile = (asked - 1u) % ring;
    if (placed.tile_count > ring ||
        (!asked && !first_fit(s, placed.tile_count, &placed.tile)))
        return too_large(s, &placed);
    *t = placed;
    return HL_OK;
}

/* ---- addresses ----------------------------------------------------------- */

/* A row of one sample a pixel, walked by halves of tiles: those of depth
 * surfaces are swapped. */
struct walk {
    uint32_t column;             /* half tiles from the surface's left       */
    uint32_t in;                 /* pixels into the half                     */
    uint32_t pixels;             /* in a half tile                           */
    uint32_t row, line, sample;  /* of tiles; in the tile; word of the pixel */
    uint32_t step;               /* words from a pixel to the next           */
};

/* Samples of a pixel: 4x at (k >> 1, k & 1), 2x at (0, k). */
static struct walk walk_begin(const struct pe_state *s,
                              const struct pe_texture *t, uint32_t x,
                              uint32_t y, uint32_t sample)
{
    const struct hl_profile *p = &s->profile;
    uint32_t samples = t->desc.samples;
    struct walk w;
    uint32_t sy = y * down(samples) + (samples >= 2 ? sample & 1 : 0);
    w.step = across(samples) * t->words;
    w.pixels = p->edram_tile_width / 2 / w.step;
    w.column = x / w.pixels;
    w.in = x % w.pixels;
    w.row = sy / p->edram_tile_height;
    w.line = sy % p->edram_tile_height;
    w.sample = samples >= 4 ? (sample >> 1) * t->words : 0;
    return w;
}

static uint32_t *walk_words(const struct pe_state *s,
                            const struct pe_texture *t, const struct walk *w)
{
    const struct hl_profile *p = &s->profile;
    bool depth = hl_format_info(t->desc.format)->kind == HL_KIND_DEPTH;
    uint32_t half = depth ? w->column ^ 1 : w->column;
    uint32_t tile = (t->tile + w->row * t->tile_pitch + w->column / 2) %
                    p->edram_tiles;
    uint32_t size = p->edram_tile_width * p->edram_tile_height;
    return s->edram + (size_t)tile * size + w->line * p->edram_tile_width +
           (half & 1) * (p->edram_tile_width / 2) + w->in * w->step +
           w->sample;
}

/* Pixels of `words` words each, `in` and `out` words apart. */
static inline void spread(uint32_t *restrict to, uint32_t out,
                          const uint32_t *restrict from, uint32_t in,
                          uint32_t words, uint32_t n)
{
    if (in == words && out == words)
        memcpy(to, from, (size_t)n * words * sizeof *to);
    else if (words == 1)
        for (uint32_t i = 0; i < n; i++)
            to[i * out] = from[i * in];
    else
        for (uint32_t i = 0; i < n; i++)
            memcpy(to + i * out, from + i * in, 2 * sizeof *to);
}

void pe_edram_load(const struct pe_state *s, const struct pe_texture *t,
                   uint32_t x, uint32_t y, uint32_t sample, uint32_t n,
                   uint32_t stride, uint32_t *words)
{
    struct walk w = walk_begin(s, t, x, y, sample);
    for (uint32_t m; n > 0; n -= m, w.column++, w.in = 0) {
        m = n < w.pixels - w.in ? n : w.pixels - w.in;
        spread(words, stride, walk_words(s, t, &w), w.step, t->words, m);
        words += m * stride;
    }
}

void pe_edram_store(struct pe_state *s, const struct pe_texture *t, uint32_t x,
                    uint32_t y, uint32_t sample, uint32_t n, uint32_t stride,
                    const uint32_t *words)
{
    struct walk w = walk_begin(s, t, x, y, sample);
    for (uint32_t m; n > 0; n -= m, w.column++, w.in = 0) {
        m = n < w.pixels - w.in ? n : w.pixels - w.in;
        spread(walk_words(s, t, &w), w.step, words, stride, t->words, m);
        words += m * stride;
    }
}
