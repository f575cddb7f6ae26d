/* SPDX-License-Identifier: Zlib */
/* What stages wrote, into the bin's texels. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* ---- texels of a batch --------------------------------------------------- */

static inline void copy_texel(uint32_t *to, const uint32_t *from,
                              uint32_t words)
{
    for (uint32_t k = 0; k < words; k++)
        to[k] = from[k];
}

static void gather(uint32_t *to, const uint32_t *from, const uint16_t *at,
                   uint32_t n, uint32_t words, uint32_t samples, uint32_t s)
{
    for (uint32_t i = 0; i < n; i++)
        copy_texel(to + i * words, from + (at[i] * samples + s) * words,
                   words);
}

/* In order: without blending, the last of a pixel's fragments stays. */
static void scatter(uint32_t *to, const uint32_t *from, const uint16_t *at,
                    const uint8_t *cover, uint32_t n, uint32_t words,
                    uint32_t samples, uint32_t s)
{
    for (uint32_t i = 0; i < n; i++)
        if (cover[i] >> s & 1)
            copy_texel(to + (at[i] * samples + s) * words, from + i * words,
                       words);
}

/* One sample, all covered: loops for each size, which is constant. */
static inline void scatter_all(uint32_t *restrict to,
                               const uint32_t *restrict from,
                               const uint16_t *restrict at, uint32_t n,
                               uint32_t words)
{
    for (uint32_t i = 0; i < n; i++)
        copy_texel(to + at[i] * words, from + i * words, words);
}

/* One texel for all of a pixel's samples that are covered. */
static inline void spread(uint32_t *restrict to, const uint32_t *restrict from,
                          const uint16_t *restrict at,
                          const uint8_t *restrict cover, uint32_t n,
                          uint32_t words, uint32_t samples)
{
    const uint8_t whole = (uint8_t)((1u << samples) - 1);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *texel = to + at[i] * samples * words;
        if (cover[i] == whole)
            for (uint32_t s = 0; s < samples; s++)
                copy_texel(texel + s * words, from + i * words, words);
        else
            for (uint32_t s = 0; s < samples; s++)
                if (cover[i] >> s & 1)
                    copy_texel(texel + s * words, from + i * words, words);
    }
}

static void put(struct pe_bin *b, uint32_t target, uint32_t words)
{
    struct pe_batch *g = &b->batch;
    uint32_t *to = b->color[target], n = g->f.n, samples = b->samples;
    switch (b->covered ? words : words + 4) {
    case 1: scatter_all(to, g->words, g->at, n, 1); break;
    case 2: scatter_all(to, g->words, g->at, n, 2); break;
    case 4: scatter_all(to, g->words, g->at, n, 4); break;
    case 5: spread(to, g->words, g->at, g->cover, n, 1, samples); break;
    case 6: spread(to, g->words, g->at, g->cover, n, 2, samples); break;
    default: spread(to, g->words, g->at, g->cover, n, words, samples); break;
    }
}

static int bias_of(const struct pe_bin *b, uint32_t target)
{
    uint32_t slot = b->pass->in->color[target].slot;
    return b->state->tex[slot].desc.console.color_exp_bias;
}

static void replace(struct pe_bin *b, uint32_t target, uint32_t words,
                    const float *const rgba[4])
{
    const struct hl_prog_desc *d = &b->draw->program->desc;
    struct pe_batch *g = &b->batch;
    pe_blend(d->color[target], HL_BLEND_OFF, 0.0f, bias_of(b, target), rgba,
             NULL, g->f.n, g->words);
    put(b, target, words);
}

/* What is not covered is blended too, and left out afterwards. */
static void blend(struct pe_bin *b, uint32_t target, uint32_t words,
                  const float *const rgba[4])
{
    const struct hl_prog_desc *d = &b->draw->program->desc;
    struct pe_batch *g = &b->batch;
    for (uint32_t s = 0; s < b->samples; s++) {
        gather(g->words, b->color[target], g->at, g->f.n, words, b->samples,
               s);
        pe_blend(d->color[target], d->blend, d->blend_constant,
                 bias_of(b, target), rgba, NULL, g->f.n, g->words);
        if (b->covered)
            put(b, target, words);
        else
            scatter(b->color[target], g->words, g->at, g->cover, g->f.n,
                    words, b->samples, s);
    }
}

void pe_batch_write(struct pe_bin *b)
{
    const struct hl_prog_desc *d = &b->draw->program->desc;
    struct hl_pe_fragments *f = &b->batch.f;
    for (uint32_t t = 0; t < d->n_colors && !d->no_color_write; t++) {
        const float *const rgba[4] = { f->color[t][0], f->color[t][1],
                                       f->color[t][2], f->color[t][3] };
        uint32_t words = pe_words(d->color[t]);
        if (d->blend == HL_BLEND_OFF)
            replace(b, t, words, rgba);
        else
            blend(b, t, words, rgba);
    }
}

/* ---- whole rectangles ---------------------------------------------------- */

/* Where the bin's rows are as long as the planes', many rows at a time. */
static void rect_target(struct pe_bin *b, uint32_t target,
                        const struct hl_rect *r)
{
    const struct hl_prog_desc *d = &b->draw->program->desc;
    uint32_t words = pe_words(d->color[target]);
    uint32_t n = (uint32_t)r->width, rows = 1, h = (uint32_t)r->height;
    if (r->width == PE_BIN)
        rows = h;
    for (uint32_t y = 0; y < h; y += rows) {
        uint32_t at = (uint32_t)(r->y - b->rect.y + (int32_t)y) *
                      PE_BIN +
                      (uint32_t)(r->x - b->rect.x);
        uint32_t k = rows < h - y ? rows : h - y;
        const float *rgba[4];
        for (uint32_t c = 0; c < 4; c++)
            rgba[c] = b->planes[target * 4 + c] + y * PE_BIN;
        pe_blend(d->color[target], d->blend, d->blend_constant,
                 bias_of(b, target), rgba, NULL, n * k,
                 b->color[target] + at * words);
    }
}

void pe_rect_run(struct pe_bin *b, const struct hl_rect *r)
{
    const struct pe_program *p = b->draw->program;
    if (!b->stage)
        return;
    p->fragment.rect(b->draw, r, b->planes);
    uint64_t n = (uint64_t)r->width * (uint64_t)r->height;
    b->shaded += n;
    b->blended += b->ordered ? n : 0;
    /* They write one target; others get zeros, on any thread. */
    if (p->desc.n_colors > 1)
        memset(b->planes[4], 0, (p->desc.n_colors - 1) * 4 *
                                sizeof b->planes[0]);
    for (uint32_t t = 0; t < p->desc.n_colors; t++)
        rect_target(b, t, r);
}
