/* SPDX-License-Identifier: Zlib */
/* A pass, from its draws to its stored targets. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* More chunks than threads, so that they end together; few enough that their
 * tables of bins stay small. */
enum { CHUNKS = 64, CHUNK_MIN = 512 };

/* ---- draws --------------------------------------------------------------- */

static void bind_ranges(const struct pe_state *s, struct pe_draw *d)
{
    for (int i = 0; i < HL_MAX_UNIFORMS; i++) {
        const struct hl_bk_range *r = &d->in->uniform[i];
        bool bound = r->slot != HL_NO_SLOT;
        d->uniform[i] = bound ? s->buf[r->slot].memory + r->offset : NULL;
        d->uniform_bytes[i] = bound ? r->bytes : 0;
    }
    for (int i = 0; i < HL_MAX_STORAGE; i++) {
        const struct hl_bk_range *r = &d->in->storage[i];
        bool bound = r->slot != HL_NO_SLOT;
        d->storage[i] = bound ? s->buf[r->slot].memory + r->offset : NULL;
        d->storage_bytes[i] = bound ? r->bytes : 0;
    }
}

static void bind_textures(const struct pe_state *s, struct pe_draw *d)
{
    for (uint32_t i = 0; i < HL_MAX_TEXTURES; i++) {
        const struct hl_bk_texture *t = &d->in->texture[i];
        bool bound = i < d->in->n_textures && t->slot != HL_NO_SLOT;
        d->view[i].texture = bound ? &s->tex[t->slot] : NULL;
        d->view[i].state = s;
        d->view[i].filter = bound ? t->filter : (uint8_t)HL_FILTER_NEAREST;
        d->view[i].wrap_u = bound ? t->wrap_u : (uint8_t)HL_WRAP_CLAMP;
        d->view[i].wrap_v = bound ? t->wrap_v : (uint8_t)HL_WRAP_CLAMP;
    }
}

static bool take_draws(struct pe_pass *p, const struct hl_bk_draw *draws,
                       uint32_t n)
{
    struct pe_state *s = p->state;
    p->rects = false;
    p->n_draws = n;
    if (!hl_bk_grow(s->device, &p->draws, &p->max_draws, n,
                    sizeof *p->draws))
        return false;
    for (uint32_t i = 0; i < n; i++) {
        struct pe_draw *d = &p->draws[i];
        d->in = &draws[i];
        d->program = &s->prog[draws[i].prog];
        d->pass = p->in;
        bind_ranges(s, d);
        bind_textures(s, d);
        p->rects |= d->program->fragment.rect != NULL;
    }
    return true;
}

/* ---- front end ----------------------------------------------------------- */

/* Cut all primitives into equal chunks, whatever draws they are of. */
static bool cut_chunks(struct pe_pass *p)
{
    uint64_t total = 0, at = 0, each;
    for (uint32_t i = 0; i < p->n_draws; i++)
        total += pe_primitives(&p->draws[i]);
    each = (total + CHUNKS - 1) / CHUNKS;
    each = each < CHUNK_MIN ? CHUNK_MIN : each;
    p->n_chunks = (uint32_t)((total + each - 1) / each);
    if (!hl_bk_grow(p->state->device, &p->chunks, &p->max_chunks, CHUNKS,
                    sizeof *p->chunks) ||
        !hl_bk_grow(p->state->device, &p->pending, &p->max_pending, CHUNKS,
                    sizeof *p->pending))
        return false;
    for (uint32_t i = 0, draw = 0; i < p->n_chunks; i++) {
        struct pe_chunk *c = &p->chunks[i];
        while (at >= pe_primitives(&p->draws[draw]))
            at -= pe_primitives(&p->draws[draw++]);
        c->first_draw = draw;
        c->first = at;
        c->count = total < each ? total : each;
        total -= c->count;
        at += c->count;
        p->pending[i] = i;
    }
    return true;
}

static bool grow(struct pe_pass *p, void *array, uint32_t *max,
                 uint64_t need, size_t item)
{
    return need <= 0x40000000 &&
           hl_bk_grow(p->state->device, array, max, (uint32_t)need, item);
}

/* Room for what a chunk is likely to need; large ones may find most of their
 * primitives out of sight, and ask for more. */
static bool grow_chunk(struct pe_pass *p, struct pe_chunk *c)
{
    uint64_t n = c->count < 0x4000 ? c->count : 0x4000;
    uint64_t words = c->need_words > n * 8 ? c->need_words : n * 8;
    uint64_t records = c->need_records > n ? c->need_records : n;
    uint64_t pairs = c->need_pairs > 2 * n ? c->need_pairs : 2 * n;
    return grow(p, &c->words, &c->max_words, words, sizeof *c->words) &&
           grow(p, &c->records, &c->max_records, records,
                sizeof *c->records) &&
           grow(p, &c->pairs, &c->max_pairs, pairs, sizeof *c->pairs) &&
           grow(p, &c->sorted, &c->max_sorted, c->max_pairs,
                sizeof *c->sorted) &&
           grow(p, &c->start, &c->max_start,
                (uint64_t)p->nx * p->ny + 2, sizeof *c->start);
}

static bool grow_fronts(struct pe_pass *p)
{
    uint32_t n = pe_pool_threads(p->state->threads);
    struct hl_device *d = p->state->device;
    if (!hl_bk_grow(d, &p->front, &p->max_front, n, sizeof *p->front))
        return false;
    for (uint32_t i = 0; i < n; i++)
        if (!p->front[i] &&
            !(p->front[i] = hl_bk_alloc(d, sizeof **p->front)))
            return false;
    return true;
}

static bool unfinished(const struct pe_chunk *c)
{
    return c->need_words || c->need_records || c->need_pairs;
}

static bool run_front(struct pe_pass *p)
{
    if (!grow_fronts(p) || !cut_chunks(p))
        return false;
    for (uint32_t i = 0; i < p->n_chunks; i++)
        p->chunks[i].need_words = p->chunks[i].need_records =
            p->chunks[i].need_pairs = 0;
    for (uint32_t n = p->n_chunks; n > 0;) {
        for (uint32_t i = 0; i < n; i++)
            if (!grow_chunk(p, &p->chunks[p->pending[i]]))
                return false;
        pe_pool_run(p->state->threads, n, pe_front_run, p);
        uint32_t left = 0;
        for (uint32_t i = 0; i < n; i++)
            if (unfinished(&p->chunks[p->pending[i]]))
                p->pending[left++] = p->pending[i];
        n = left;
    }
    return true;
}

/* ---- passes -------------------------------------------------------------- */

/* Direct3D 9 machines have pixel centres at integers, unless their state says
 * otherwise: seen from centres at halves, all lies half a pixel further. */
static void set_view(struct pe_pass *p)
{
    const struct hl_bk_pass *in = p->in;
    float shift = p->state->profile.integer_centers && !in->half_pixel_offset
                  ? 0.5f : 0.0f;
    p->view.sx = 0.5f * (float)in->width;
    p->view.sy = 0.5f * (float)in->height;
    p->view.ox = p->view.sx + shift;
    p->view.oy = p->view.sy + shift;
    p->nx = (in->width + PE_BIN - 1) / PE_BIN;
    p->ny = (in->height + PE_BIN - 1) / PE_BIN;
}

static bool run(struct pe_pass *p, const struct hl_bk_draw *draws, uint32_t n)
{
    set_view(p);
    if (!take_draws(p, draws, n) || !run_front(p) || !pe_bins_make(p))
        return false;
    pe_pool_run(p->state->threads, p->nx * p->ny, pe_bin_run, p);
    return true;
}

enum hl_result pe_pass_run(void *state, const struct hl_bk_pass *pass,
                           const struct hl_bk_draw *draws, uint32_t n_draws)
{
    struct pe_state *s = state;
    double begin = pe_clock_ms();
    bool ok = hl_bk_grow(s->device, &s->timing, &s->max_timings,
                         s->n_timings + 1, sizeof *s->timing);
    if (ok && !s->pass)
        ok = (s->pass = hl_bk_alloc(s->device, sizeof *s->pass)) != NULL;
    if (ok) {
        s->pass->state = s;
        s->pass->in = pass;
        ok = run(s->pass, draws, n_draws);
    }
    if (!ok) {
        hl_bk_log(s->device, HL_LOG_ERROR, HL_MSG_MEMORY,
                  pass->label[0] ? pass->label : "pass",
                  ": no memory to draw it in", NULL);
        return HL_ERR_MEMORY;
    }
    struct hl_timing *t = &s->timing[s->n_timings++];
    memset(t, 0, sizeof *t);
    t->label = pass->label;
    t->ms = pe_clock_ms() - begin;
    for (uint32_t i = 0; i < s->pass->max_bin; i++)
        if (s->pass->bin[i]) {
            t->fragments += s->pass->bin[i]->shaded;
            t->blended += s->pass->bin[i]->blended;
        }
    return HL_OK;
}

static void free_chunks(struct hl_device *d, struct pe_pass *p)
{
    for (uint32_t i = 0; i < p->max_chunks; i++) {
        struct pe_chunk *c = &p->chunks[i];
        hl_bk_free(d, c->words);
        hl_bk_free(d, c->records);
        hl_bk_free(d, c->pairs);
        hl_bk_free(d, c->sorted);
        hl_bk_free(d, c->start);
    }
    hl_bk_free(d, p->chunks);
    hl_bk_free(d, p->pending);
}

void pe_pass_free(struct pe_state *s)
{
    struct pe_pass *p = s->pass;
    struct hl_device *d = s->device;
    if (!p)
        return;
    free_chunks(d, p);
    for (uint32_t i = 0; i < p->max_front; i++)
        hl_bk_free(d, p->front[i]);
    for (uint32_t i = 0; i < p->max_bin; i++) {
        if (p->bin[i])
            hl_bk_free(d, p->bin[i]->words);
        hl_bk_free(d, p->bin[i]);
    }
    hl_bk_free(d, p->front);
    hl_bk_free(d, p->bin);
    hl_bk_free(d, p->draws);
    hl_bk_free(d, p->clear);
    hl_bk_free(d, p);
    s->pass = NULL;
}
