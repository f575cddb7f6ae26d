/* SPDX-License-Identifier: Zlib */
/* Textures: creation, and the host's way in and out. */
#include "hal/text.h"
#include "platforms/packemu/pe_code.h"
#include "platforms/packemu/pe_memory.h"

static bool levels_make(struct pe_texture *t)
{
    const struct hl_tex_desc *d = &t->desc;
    uint64_t at = 0, texel = (uint64_t)hl_format_info(d->format)->bytes *
                             t->samples;
    for (uint32_t k = 0; k < d->mips; k++) {
        t->level[k] = (size_t)at;
        at += ((uint64_t)pe_level_width(t, k) * pe_level_height(t, k) * texel +
               3) & ~(uint64_t)3;
    }
    t->bytes = (size_t)at;
    return t->bytes == at;
}

static enum hl_result no_memory(struct pe_state *s, const struct pe_texture *t)
{
    char line[64];
    struct hl_text text = hl_text_begin(line, sizeof line);
    hl_text_uint(&text, t->bytes);
    hl_text_str(&text, " bytes of a texture find no memory");
    hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_MEMORY,
              t->desc.label ? t->desc.label : "hl_tex_create", ": ", line);
    return HL_ERR_MEMORY;
}

enum hl_result pe_tex_create(void *state, uint32_t slot,
                             const struct hl_tex_desc *desc)
{
    struct pe_state *s = state;
    struct pe_texture t = { .desc = *desc };
    bool edram = pe_edram_holds(s, desc);
    t.words = pe_words(desc->format);
    t.samples = edram ? 1 : (uint8_t)desc->samples;
    enum hl_result r = pe_view_make(s, &t);
    if (r == HL_OK && edram)
        r = pe_edram_place(s, &t);
    if (r != HL_OK)
        return r;
    bool fits = levels_make(&t);
    if (!edram || (desc->usage & (HL_TEX_SAMPLED | HL_TEX_READBACK))) {
        t.memory = fits ? hl_bk_alloc(s->device, t.bytes) : NULL;
        if (!t.memory)
            return no_memory(s, &t);
    }
    t.desc.label = NULL;
    s->tex[slot] = t;
    return HL_OK;
}

void pe_tex_destroy(struct pe_state *s, uint32_t slot)
{
    hl_bk_free(s->device, s->tex[slot].memory);
    memset(&s->tex[slot], 0, sizeof s->tex[slot]);
}

/* ---- host arrays --------------------------------------------------------- */

/* A host's texels as words of memory, low byte first: one value a channel,
 * or one 32-bit word of packed formats. So only big-endian hosts differ, by
 * the size of that value. */
static void host_order(enum hl_format format, uint32_t *words, size_t n)
{
    const struct hl_format_info *f = hl_format_info(format);
    bool packed = f->bits[0] != 8 && f->bits[0] != 16 && f->bits[0] != 32;
    if (!pe_host_big())
        return;
    for (size_t i = 0; i < n && !packed && f->bits[0] < 32; i++) {
        uint32_t w = words[i] << 16 | words[i] >> 16;
        words[i] = f->bits[0] == 16 ? w : (w & 0xff00ffu) << 8 |
                                          (w >> 8 & 0xff00ffu);
    }
}

enum { PART = 256 };

static void to_memory(const struct pe_texture *t, uint8_t *to,
                      const uint8_t *from, size_t bytes)
{
    uint32_t words[PART];
    for (size_t m; bytes > 0; bytes -= m, from += m, to += m) {
        m = bytes < sizeof words ? bytes : sizeof words;
        size_t n = (m + 3) / 4;
        words[n - 1] = 0;
        memcpy(words, from, m);
        host_order(t->desc.format, words, n);
        pe_words_to_memory((enum pe_order)t->order, words, n);
        /* Levels end at whole words, so that the last one has its room. */
        memcpy(to, words, 4 * n);
    }
}

static void from_memory(const struct pe_texture *t, uint8_t *to,
                        const uint8_t *from, size_t bytes)
{
    uint32_t words[PART];
    for (size_t m; bytes > 0; bytes -= m, from += m, to += m) {
        m = bytes < sizeof words ? bytes : sizeof words;
        size_t n = (m + 3) / 4;
        memcpy(words, from, 4 * n);
        pe_words_from_memory((enum pe_order)t->order, words, n);
        host_order(t->desc.format, words, n);
        memcpy(to, words, m);
    }
}

/* A host's write is for drawing on, too: bring it back to EDRAM, bits as they
 * are. */
static void restore(struct pe_state *s, const struct pe_texture *t)
{
    const struct hl_tex_desc *d = &t->desc;
    uint32_t words[PART], part = PART / t->words;
    for (uint32_t y = 0; y < d->height; y++)
        for (uint32_t x = 0, n; x < d->width; x += n) {
            n = d->width - x < part ? d->width - x : part;
            pe_texels_load(t->memory, (enum pe_order)t->order,
                           hl_format_info(d->format)->bytes,
                           (size_t)y * d->width + x, n, words);
            pe_row_store(s, t, x, y, n, words);
        }
}

enum hl_result pe_tex_write(void *state, uint32_t slot, uint32_t mip,
                            const void *data, size_t bytes)
{
    struct pe_state *s = state;
    const struct pe_texture *t = &s->tex[slot];
    if (t->memory)
        to_memory(t, t->memory + t->level[mip], data, bytes);
    if (t->memory && t->tile_count && mip == 0)
        restore(s, t);
    return HL_OK;
}

static void read_depth(const struct pe_texture *t, uint8_t *out)
{
    const struct hl_tex_desc *d = &t->desc;
    size_t n = (size_t)d->width * d->height;
    uint32_t words[PART];
    float depth[PART / 2];
    for (size_t at = 0, m; at < n; at += m) {
        m = n - at < PART / 2 ? n - at : PART / 2;
        pe_texels_load(t->memory, (enum pe_order)t->order,
                       hl_format_info(d->format)->bytes, at, (uint32_t)m,
                       words);
        pe_depth_plane(d->format, words, (uint32_t)m, depth);
        memcpy(out + at * sizeof *depth, depth, m * sizeof *depth);
    }
}

enum hl_result pe_tex_read(void *state, uint32_t slot, void *out,
                           size_t bytes)
{
    struct pe_state *s = state;
    const struct pe_texture *t = &s->tex[slot];
    if (hl_format_info(t->desc.format)->kind == HL_KIND_DEPTH)
        read_depth(t, out);
    else
        from_memory(t, out, t->memory, bytes);
    return pe_submit(s, true);
}
