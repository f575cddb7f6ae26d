/* SPDX-License-Identifier: Zlib */
/* What a pass leaves: samples averaged, EDRAM copied to memory. A copy
 * decodes, averages, scales by 2^bias and encodes as the destination's
 * number; texels of one sample and the same encoding go as bits. */
#include "platforms/packemu/pe_memory.h"

struct copy {
    const struct pe_texture *from, *to;
    bool raw;                    /* bits of the first sample                 */
    float scale;                 /* of numbers: 2^bias / samples             */
};

static struct copy copy_of(const struct pe_texture *from,
                           const struct pe_texture *to)
{
    enum hl_format_kind kind = hl_format_info(from->desc.format)->kind;
    int bias = from->tile_count ? to->desc.console.resolve_exp_bias : 0;
    uint32_t n = from->desc.samples;
    struct copy c = { from, to, false, 1.0f };
    c.raw = kind == HL_KIND_DEPTH || kind == HL_KIND_UINT ||
            (n == 1 && bias == 0 && from->desc.format == to->stored);
    c.scale = pe_float((uint32_t)(127 + bias) << 23) / (float)(int32_t)n;
    return c;
}

/* Words of the first sample of each of n pixels. */
static void first_samples(const struct pe_texture *t, uint32_t n,
                          uint32_t *words)
{
    for (uint32_t i = 1; t->desc.samples > 1 && i < n; i++)
        memmove(words + i * t->words,
                words + (size_t)i * t->desc.samples * t->words,
                t->words * sizeof *words);
}

/* Sums by pairs, so that equal samples give their value again. */
static void average(float *x, uint32_t n, uint32_t samples, float scale)
{
    for (; samples > 1; samples /= 2)
        for (uint32_t i = 0; i < n * samples / 2; i++)
            x[i] = x[2 * i] + x[2 * i + 1];
    for (uint32_t i = 0; i < n; i++)
        x[i] *= scale;
}

enum { TEXELS = 256 };

static void copy_row(struct pe_state *s, const struct copy *c, uint32_t x,
                     uint32_t y, uint32_t n)
{
    const struct pe_texture *from = c->from, *to = c->to;
    uint32_t words[TEXELS * 4], samples = from->desc.samples;
    uint32_t channels = hl_format_info(from->desc.format)->channels;
    float plane[4][TEXELS], *rgba[4] = { NULL, NULL, NULL, NULL };
    for (uint32_t i = 0; i < channels; i++)
        rgba[i] = plane[i];
    pe_row_load(s, from, x, y, n, words);
    if (c->raw) {
        first_samples(from, n, words);
    } else {
        pe_decode(from->desc.format, words, n * samples, rgba);
        for (uint32_t i = 0; i < channels; i++)
            average(plane[i], n, samples, c->scale);
        pe_encode(to->stored, (const float *const *)rgba, n, words);
    }
    pe_texels_store(to->memory, (enum pe_order)to->order,
                    hl_format_info(to->stored)->bytes,
                    (size_t)y * to->desc.width + x, n, words);
}

static void copy_rect(struct pe_state *s, uint32_t from, uint32_t to,
                      const struct hl_rect *r)
{
    const struct copy c = copy_of(&s->tex[from], &s->tex[to]);
    if (!c.to->memory)
        return;
    const int32_t part = TEXELS / (int32_t)c.from->desc.samples;
    for (int32_t y = r->y; y < r->y + r->height; y++)
        for (int32_t x = r->x, end = r->x + r->width; x < end; x += part)
            copy_row(s, &c, (uint32_t)x, (uint32_t)y,
                     (uint32_t)(end - x < part ? end - x : part));
}

void pe_resolve(struct pe_state *s, const struct hl_bk_pass *p,
                const struct hl_rect *rect)
{
    for (uint32_t i = 0; i < p->n_colors; i++) {
        const struct hl_bk_target *t = &p->color[i];
        if (s->tex[t->slot].tile_count && !t->discard)
            copy_rect(s, t->slot, t->slot, rect);
        if (t->resolve != HL_NO_SLOT)
            copy_rect(s, t->slot, t->resolve, rect);
    }
    const struct hl_bk_target *d = &p->depth;
    if (d->slot != HL_NO_SLOT && s->tex[d->slot].tile_count && !d->discard &&
        !p->depth_read_only)
        copy_rect(s, d->slot, d->slot, rect);
}
