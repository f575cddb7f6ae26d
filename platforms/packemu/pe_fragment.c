/* SPDX-License-Identifier: Zlib */
/* Fragments: raw ones are tested many at a time, those that pass get their
 * attributes (pe_attribute.c) and are gathered, over all primitives of a draw,
 * into batches that are shaded. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* ---- batches ------------------------------------------------------------- */

/* Stages that discard are tested here, after them. */
static void late_tests(struct pe_bin *b)
{
    struct pe_batch *g = &b->batch;
    if (b->samples == 1)
        memset(g->cover, 1, sizeof g->cover);
    for (uint32_t i = 0; i < g->f.n; i++)
        if (g->f.discard[i])
            g->cover[i] = 0;
    for (uint32_t s = 0; s < b->samples && b->tests; s++)
        pe_sample_test(&b->test, s, g->at, g->code[s], g->f.back, g->f.n,
                       g->cover);
}

static void batch_flush(struct pe_bin *b)
{
    struct pe_batch *g = &b->batch;
    if (g->f.n == 0)
        return;
    if (b->stage->discards)
        memset(g->f.discard, 0, sizeof g->f.discard);
    b->stage->shade(b->draw, &g->f);
    if (b->stage->discards)
        late_tests(b);
    pe_batch_write(b);
    g->f.n = 0;
    b->stamp++;
}

/* How many of n fragments may join the batch: blending reads what the one
 * before wrote, so that no pixel may be there twice. */
static uint32_t joinable(struct pe_bin *b, const uint16_t *pass, uint32_t n)
{
    uint32_t room = HL_PE_BATCH - b->batch.f.n;
    n = n < room ? n : room;
    if (!b->ordered)
        return n;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t *stamp = &b->stamps[b->raw.at[pass[i]]];
        if (*stamp == b->stamp)
            return i;
        *stamp = b->stamp;
    }
    return n;
}

/* ---- shading ------------------------------------------------------------- */

PE_WIDE
static void shade_run(struct pe_bin *b, const struct pe_tri *t,
                      const uint16_t *pass, uint32_t n)
{
    struct pe_plane p[1 + HL_PE_VARY_COUNT];
    b->shaded += n;
    b->blended += b->ordered ? n : 0;
    pe_planes_set(p, t, b->draw->program->n_vary);
    while (n > 0) {
        uint32_t k = joinable(b, pass, n);
        pe_batch_join(b, t, p, pass, k);
        pass += k;
        n -= k;
        if (n > 0 || b->batch.f.n == HL_PE_BATCH)
            batch_flush(b);
    }
}

/* ---- tests before shading ------------------------------------------------ */

static uint32_t all_covered(struct pe_raw *r, uint32_t samples)
{
    uint32_t n = 0;
    if (samples == 1) {
        for (uint32_t i = 0; i < r->n; i++)
            r->pass[i] = (uint16_t)i;
        return r->n;
    }
    for (uint32_t i = 0; i < r->n; i++) {
        r->pass[n] = (uint16_t)i;
        n += r->cover[i] != 0;
    }
    return n;
}

static void encode_sample(struct pe_bin *b, uint32_t s)
{
    struct pe_raw *r = &b->raw;
    enum hl_format format = b->draw->program->desc.depth;
    uint32_t level = pe_sample_level(b->samples);
    float z[PE_RAW];
    if (b->samples == 1) {
        pe_depth_encode(format, r->z, r->n, r->code[0]);
        return;
    }
    float sx = (float)pe_sample_at[level][s][0] * 0.0625f;
    float sy = (float)pe_sample_at[level][s][1] * 0.0625f;
    for (uint32_t k = 0; k < r->n_runs; k++) {
        float off = r->tri[k].zx * sx + r->tri[k].zy * sy;
        for (uint32_t i = r->start[k]; i < r->start[k + 1]; i++)
            z[i] = r->z[i] + off;
    }
    pe_depth_encode(format, z, r->n, r->code[s]);
}

static void set_faces(struct pe_raw *r)
{
    for (uint32_t k = 0; k < r->n_runs; k++)
        memset(r->back + r->start[k], r->tri[k].back,
               r->start[k + 1] - r->start[k]);
}

/* Which raw fragments are shaded. A stage that discards is tested after it;
 * but what fails the depth test now would fail then too, since the draw's own
 * writes only ever move depths further in the direction of its comparison. */
static uint32_t early_tests(struct pe_bin *b)
{
    struct pe_raw *r = &b->raw;
    bool late = b->stage && b->stage->discards;
    if (b->centroid)
        memcpy(r->hull, r->cover, r->n);
    if (!b->tests)
        return all_covered(r, b->samples);
    for (uint32_t s = 0; s < b->samples; s++)
        encode_sample(b, s);
    if (b->samples == 1 && !b->test.stencil_on)
        return pe_depth_test(&b->test, b->test.write && !late, r->at,
                             r->code[0], r->n, r->pass);
    if (late)
        return all_covered(r, b->samples);
    set_faces(r);
    if (b->samples == 1)
        memset(r->cover, 1, r->n);
    for (uint32_t s = 0; s < b->samples; s++)
        pe_sample_test(&b->test, s, r->at, r->code[s], r->back, r->n,
                       r->cover);
    return all_covered(r, PE_MAX_SAMPLES);
}

void pe_raw_flush(struct pe_bin *b)
{
    struct pe_raw *r = &b->raw;
    if (r->n > 0) {
        r->start[r->n_runs] = r->n;
        uint32_t n = early_tests(b), at = 0;
        for (uint32_t k = 0; k < r->n_runs && b->stage && at < n; k++) {
            uint32_t end = at;
            while (end < n && r->pass[end] < r->start[k + 1])
                end++;
            if (end > at)
                shade_run(b, &r->tri[k], r->pass + at, end - at);
            at = end;
        }
    }
    r->n = r->n_runs = 0;
}

void pe_raw_begin(struct pe_bin *b, const struct pe_tri *t)
{
    struct pe_raw *r = &b->raw;
    if (r->n_runs > 0 && r->start[r->n_runs - 1] == r->n)
        r->n_runs--;             /* nothing of the one before was inside     */
    if (r->n_runs == PE_RAW)
        pe_raw_flush(b);
    r->start[r->n_runs] = r->n;
    r->tri[r->n_runs++] = *t;
}

/* ---- draws --------------------------------------------------------------- */

/* Varyings that the vertex stage lacks are zero, and so are outputs that a
 * stage may leave out: what a batch before left would depend on threads. */
static void clear_batch(struct pe_bin *b)
{
    const struct pe_program *p = b->draw->program;
    struct hl_pe_fragments *f = &b->batch.f;
    uint32_t lacks = p->fragment.vary;
    for (uint32_t k = 0; k < p->n_vary; k++)
        lacks &= ~(1u << p->vary[k]);
    for (uint32_t v = 0; v < HL_PE_VARY_COUNT; v++)
        if (lacks >> v & 1)
            memset(f->vary[v], 0, sizeof f->vary[v]);
    if (p->fragment.vary == 0xffffffffu || p->desc.n_colors > 1)
        memset(f->color, 0, p->desc.n_colors * sizeof f->color[0]);
    if (b->stage->uv_slope && (lacks >> HL_PE_U & 1))
        memset(f->duv, 0, sizeof f->duv);
}

static void set_test(struct pe_bin *b, const struct hl_prog_desc *d)
{
    struct pe_test *t = &b->test;
    t->compare = d->depth_test;
    t->write = d->depth_write && d->depth_test != HL_COMPARE_OFF;
    t->stencil = d->stencil;
    t->stencil_on = b->stencil && (d->stencil.front.test != HL_COMPARE_OFF ||
                                   d->stencil.back.test != HL_COMPARE_OFF);
    t->samples = b->samples;
    t->depth = b->depth;
    t->stencils = b->stencil;
    b->tests = b->depth && (t->compare != HL_COMPARE_OFF || t->stencil_on);
    b->depth_dirty |= b->tests && (t->write || t->stencil_on);
}

void pe_draw_begin(struct pe_bin *b, uint32_t draw)
{
    b->draw = &b->pass->draws[draw];
    const struct pe_program *p = b->draw->program;
    bool colors = p->desc.n_colors > 0 && !p->desc.no_color_write;
    const struct hl_pe_stage *s = &p->fragment.stage;
    b->stage = s->shade && (colors || s->discards) ? s : NULL;
    b->centroid = p->centroid;
    b->ordered = colors && p->desc.blend != HL_BLEND_OFF;
    b->color_dirty |= colors;
    b->raw.n = b->raw.n_runs = 0;
    b->batch.f.n = 0;
    b->stamp++;
    set_test(b, &p->desc);
    /* Of one sample, all that comes to be shaded is covered, until a stage
     * discards it. */
    memset(b->batch.cover, 1, sizeof b->batch.cover);
    b->covered = b->samples == 1 && b->stage && !b->stage->discards;
    if (b->stage)
        clear_batch(b);
}

void pe_draw_end(struct pe_bin *b)
{
    pe_raw_flush(b);
    if (b->stage)
        batch_flush(b);
    b->draw = NULL;
}
