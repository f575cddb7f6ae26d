/* SPDX-License-Identifier: Zlib */
/* Bins: a part of all targets in one thread's words, loaded, drawn on by the
 * draws in order, and stored. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* ---- what they are made of ----------------------------------------------- */

/* Words of a bin's targets, one after another; base NULL: only count. */
static uint32_t place_targets(const struct pe_pass *p, uint32_t *base,
                              uint32_t *color[HL_MAX_COLORS],
                              uint32_t **depth, uint8_t **stencil)
{
    const uint32_t texels = PE_BIN * PE_BIN * p->in->samples;
    const struct pe_texture *t = p->state->tex;
    uint32_t at = 0;
    for (uint32_t i = 0; i < p->in->n_colors; i++) {
        color[i] = base ? base + at : NULL;
        at += texels * pe_words(t[p->in->color[i].slot].desc.format);
    }
    *depth = NULL;
    *stencil = NULL;
    if (p->in->depth.slot == HL_NO_SLOT)
        return at;
    *depth = base ? base + at : NULL;
    at += texels;
    if (hl_format_info(t[p->in->depth.slot].desc.format)->bits[1] == 0)
        return at;
    *stencil = base ? (uint8_t *)(base + at) : NULL;
    return at + texels / 4;
}

static bool grow_bins(struct pe_pass *p)
{
    uint32_t n = pe_pool_threads(p->state->threads);
    struct hl_device *d = p->state->device;
    if (!hl_bk_grow(d, &p->bin, &p->max_bin, n, sizeof *p->bin))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        if (!p->bin[i] && !(p->bin[i] = hl_bk_alloc(d, sizeof **p->bin)))
            return false;
        struct pe_bin *b = p->bin[i];
        uint32_t targets = place_targets(p, NULL, b->color, &b->depth,
                                         &b->stencil);
        uint32_t planes = p->rects ? 4 * PE_BIN * PE_BIN * p->in->n_colors
                                   : 0;
        if (!hl_bk_grow(d, &b->words, &b->max_words, targets + planes,
                        sizeof *b->words))
            return false;
        place_targets(p, b->words, b->color, &b->depth, &b->stencil);
        b->planes = (float (*)[PE_BIN * PE_BIN])(void *)(b->words + targets);
        b->state = p->state;
        b->pass = p;
        b->samples = p->in->samples;
    }
    return true;
}

/* ---- clears -------------------------------------------------------------- */

static void fill(uint32_t *to, const uint32_t *texel, uint32_t words,
                 uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < words; k++)
            to[i * words + k] = texel[k];
}

/* Integer targets are cleared to the number, 0..2^32 - 1. */
static void clear_color(const struct pe_pass *p, uint32_t i, uint32_t *to)
{
    const struct hl_bk_target *t = &p->in->color[i];
    enum hl_format format = p->state->tex[t->slot].desc.format;
    union { float f; uint32_t u; } v[4];
    uint32_t texel[4];
    for (int c = 0; c < 4; c++) {
        float x = t->clear[c];
        v[c].f = x;
        if (hl_format_info(format)->kind == HL_KIND_UINT)
            v[c].u = !(x > 0.0f) ? 0 : x < 4294967296.0f ? (uint32_t)x
                                                         : 0xffffffffu;
    }
    const float *const rgba[4] = { &v[0].f, &v[1].f, &v[2].f, &v[3].f };
    pe_encode(format, rgba, 1, texel);
    fill(to, texel, pe_words(format),
         PE_BIN * PE_BIN * p->in->samples);
}

static uint8_t stencil_clear(float x)
{
    return (uint8_t)(!(x > 0.0f) ? 0 : x < 255.0f ? x : 255.0f);
}

/* A discarded target begins as zeros: its contents are undefined, but every
 * frame has the same bytes. */
static bool make_clears(struct pe_pass *p)
{
    uint32_t n = place_targets(p, NULL, p->clear_color, &p->clear_depth,
                               &p->clear_stencil);
    if (!hl_bk_grow(p->state->device, &p->clear, &p->max_clear, n,
                    sizeof *p->clear))
        return false;
    place_targets(p, p->clear, p->clear_color, &p->clear_depth,
                  &p->clear_stencil);
    memset(p->clear, 0, n * sizeof *p->clear);
    for (uint32_t i = 0; i < p->in->n_colors; i++)
        if (p->in->color[i].load == HL_LOAD_CLEAR)
            clear_color(p, i, p->clear_color[i]);
    const struct hl_bk_target *z = &p->in->depth;
    if (z->slot == HL_NO_SLOT || z->load != HL_LOAD_CLEAR)
        return true;
    uint32_t texels = PE_BIN * PE_BIN * p->in->samples, code;
    pe_depth_encode(p->state->tex[z->slot].desc.format, &z->clear[0], 1,
                    &code);
    fill(p->clear_depth, &code, 1, texels);
    if (p->clear_stencil)
        memset(p->clear_stencil, stencil_clear(z->clear[1]), texels);
    return true;
}

bool pe_bins_make(struct pe_pass *p)
{
    if (!grow_bins(p) || !make_clears(p))
        return false;
    for (uint32_t i = 0; i < p->max_bin; i++)
        if (p->bin[i])
            p->bin[i]->shaded = p->bin[i]->blended = 0;
    return true;
}

/* ---- load and store ------------------------------------------------------ */

/* The part of the bin that is loaded or stored in one go: rows, or all. */
static uint32_t rows_of(const struct pe_bin *b)
{
    return b->rect.width == PE_BIN ? (uint32_t)b->rect.height : 1;
}

static void load_colors(struct pe_bin *b, uint32_t target, uint32_t words)
{
    uint32_t rows = rows_of(b), h = (uint32_t)b->rect.height;
    struct hl_rect r = { b->rect.x, b->rect.y, b->rect.width,
                         (int32_t)rows };
    for (uint32_t y = 0; y < h; y += rows, r.y += (int32_t)rows)
        pe_load_color(b->state, b->pass->in->color[target].slot, &r,
                      b->color[target] + y * PE_BIN * b->samples * words);
}

static void load_depths(struct pe_bin *b)
{
    uint32_t rows = rows_of(b), h = (uint32_t)b->rect.height;
    struct hl_rect r = { b->rect.x, b->rect.y, b->rect.width,
                         (int32_t)rows };
    for (uint32_t y = 0; y < h; y += rows, r.y += (int32_t)rows) {
        uint32_t at = y * PE_BIN * b->samples;
        pe_load_depth(b->state, b->pass->in->depth.slot, &r, b->depth + at,
                      b->stencil ? b->stencil + at : NULL);
    }
}

static void load_bin(struct pe_bin *b)
{
    const struct pe_pass *p = b->pass;
    const struct hl_bk_pass *in = p->in;
    uint32_t texels = PE_BIN * (uint32_t)b->rect.height * b->samples;
    for (uint32_t i = 0; i < in->n_colors; i++) {
        const struct hl_bk_target *t = &in->color[i];
        uint32_t words = pe_words(b->state->tex[t->slot].desc.format);
        if (t->load == HL_LOAD_KEEP)
            load_colors(b, i, words);
        else
            memcpy(b->color[i], p->clear_color[i],
                   texels * words * sizeof *b->color[i]);
    }
    if (!b->depth)
        return;
    if (in->depth.load == HL_LOAD_KEEP) {
        load_depths(b);
        return;
    }
    memcpy(b->depth, p->clear_depth, texels * sizeof *b->depth);
    if (b->stencil)
        memcpy(b->stencil, p->clear_stencil, texels);
}

/* Of a target that no draw changed, only a clear is stored; of one that is
 * not needed, nothing, unless it is averaged into another. */
static bool stored(const struct hl_bk_target *t, bool dirty)
{
    return (dirty || t->load == HL_LOAD_CLEAR) &&
           (!t->discard || t->resolve != HL_NO_SLOT);
}

static void store_rows(struct pe_bin *b, const struct hl_rect *r,
                       uint32_t at, uint32_t *const color[HL_MAX_COLORS],
                       const uint32_t *depth, const uint8_t *stencil)
{
    const struct hl_bk_pass *in = b->pass->in;
    for (uint32_t i = 0; i < in->n_colors; i++) {
        uint32_t slot = in->color[i].slot;
        if (stored(&in->color[i], b->color_dirty))
            pe_store_color(b->state, slot, r, color[i] +
                           at * pe_words(b->state->tex[slot].desc.format));
    }
    if (depth && !in->depth_read_only && stored(&in->depth, b->depth_dirty))
        pe_store_depth(b->state, in->depth.slot, r, depth + at,
                       stencil ? stencil + at : NULL);
}

static void store(struct pe_bin *b, uint32_t *const color[HL_MAX_COLORS],
                  const uint32_t *depth, const uint8_t *stencil)
{
    uint32_t rows = rows_of(b), h = (uint32_t)b->rect.height;
    struct hl_rect r = { b->rect.x, b->rect.y, b->rect.width,
                         (int32_t)rows };
    for (uint32_t y = 0; y < h; y += rows, r.y += (int32_t)rows)
        store_rows(b, &r, y * PE_BIN * b->samples, color, depth, stencil);
    pe_resolve(b->state, b->pass->in, &b->rect);
}

/* ---- draws --------------------------------------------------------------- */

static bool bin_is_empty(const struct pe_pass *p, uint32_t bin)
{
    for (uint32_t i = 0; i < p->n_chunks; i++)
        if (p->chunks[i].start[bin] != p->chunks[i].start[bin + 1])
            return false;
    return true;
}

static void run_records(struct pe_bin *b, uint32_t bin)
{
    const struct pe_pass *p = b->pass;
    uint32_t draw = HL_NO_SLOT;
    for (uint32_t i = 0; i < p->n_chunks; i++) {
        const struct pe_chunk *c = &p->chunks[i];
        for (uint32_t k = c->start[bin]; k < c->start[bin + 1]; k++) {
            const struct pe_record *r = &c->records[c->sorted[k]];
            if ((r->draw & ~PE_BACK) != draw) {
                if (draw != HL_NO_SLOT)
                    pe_draw_end(b);
                draw = r->draw & ~PE_BACK;
                pe_draw_begin(b, draw);
            }
            pe_raster_record(b, c, r);
        }
    }
    if (draw != HL_NO_SLOT)
        pe_draw_end(b);
}

void pe_bin_run(void *user, uint32_t bin, uint32_t thread)
{
    const struct pe_pass *p = user;
    struct pe_bin *b = p->bin[thread];
    int32_t w = (int32_t)p->in->width, h = (int32_t)p->in->height;
    b->rect.x = (int32_t)(bin % p->nx) * PE_BIN;
    b->rect.y = (int32_t)(bin / p->nx) * PE_BIN;
    b->rect.width = w - b->rect.x < PE_BIN ? w - b->rect.x : PE_BIN;
    b->rect.height = h - b->rect.y < PE_BIN ? h - b->rect.y : PE_BIN;
    b->color_dirty = b->depth_dirty = false;
    if (bin_is_empty(p, bin)) {
        store(b, p->clear_color, p->clear_depth, p->clear_stencil);
        return;
    }
    load_bin(b);
    run_records(b, bin);
    store(b, b->color, b->depth, b->stencil);
}
