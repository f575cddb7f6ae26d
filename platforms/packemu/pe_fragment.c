/* SPDX-License-Identifier: Zlib */
/* Fragments: raw ones are tested many at a time, those that pass get their
 * attributes and are gathered, over all primitives of a draw, into batches
 * that are shaded. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* Behind this no 1 / w is told from another; it keeps w finite where a plane
 * is followed past its triangle's horizon. */
#define IW_MIN 1e-20f

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

/* ---- attributes ---------------------------------------------------------- */

static struct pe_plane plane_of(const struct pe_tri *t, float a0, float a1,
                                float a2)
{
    double d1 = (double)a1 - (double)a0, d2 = (double)a2 - (double)a0;
    double x = d1 * t->c1x + d2 * t->c2x, y = d1 * t->c1y + d2 * t->c2y;
    struct pe_plane p = { (float)((double)a0 + x * t->x + y * t->y),
                          (float)x, (float)y };
    return p;
}

/* 1 / w in [0], then the varyings over w in the program's order. */
static void set_planes(struct pe_plane *p, const struct pe_tri *t,
                       uint32_t n_vary)
{
    const union pe_word *a = t->v[0], *b = t->v[1], *c = t->v[2];
    float ia = a[PE_V_IW].f, ib = b[PE_V_IW].f, ic = c[PE_V_IW].f;
    p[0] = plane_of(t, ia, ib, ic);
    for (uint32_t k = 0; k < n_vary; k++) {
        uint32_t w = PE_V_VARY + k;
        p[1 + k] = plane_of(t, a[w].f * ia, b[w].f * ib, c[w].f * ic);
    }
}

static void eval(const struct pe_plane *p, const float *restrict dx,
                 const float *restrict dy, uint32_t n, float *restrict out)
{
    for (uint32_t i = 0; i < n; i++)
        out[i] = p->at + p->y * dy[i] + p->x * dx[i];
}

static void eval_times(const struct pe_plane *p, const float *restrict dx,
                       const float *restrict dy, const float *restrict w,
                       uint32_t n, float *restrict out)
{
    for (uint32_t i = 0; i < n; i++)
        out[i] = (p->at + p->y * dy[i] + p->x * dx[i]) * w[i];
}

static void invert(const float *restrict iw, uint32_t n, float *restrict w)
{
    for (uint32_t i = 0; i < n; i++)
        w[i] = 1.0f / (iw[i] > IW_MIN ? iw[i] : IW_MIN);
}

static uint32_t sample_level(const struct pe_bin *b)
{
    return b->samples == 8 ? 3 : b->samples / 2;
}

/* The mean of the samples that the primitive covers, inside of it as they are;
 * of all samples that is the centre. What hides some of them is no matter, or
 * an earlier draw would change the light of a later one. */
static void centroids(struct pe_bin *b, const uint16_t *pass, uint32_t at,
                      uint32_t n)
{
    const int8_t (*s)[2] = pe_sample_at[sample_level(b)];
    const uint32_t whole = (1u << b->samples) - 1;
    struct pe_batch *g = &b->batch;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t hull = b->raw.hull[pass[i]];
        int32_t x = 0, y = 0, k = 0;
        for (uint32_t j = 0; hull != whole && j < b->samples; j++) {
            int32_t in = (int32_t)(hull >> j & 1);
            x += in * s[j][0];
            y += in * s[j][1];
            k += in;
        }
        float scale = k ? 0.0625f / (float)k : 0.0f;
        g->f.off_x[at + i] = (float)x * scale;
        g->f.off_y[at + i] = (float)y * scale;
        g->at_x[at + i] = g->dx[at + i] + g->f.off_x[at + i];
        g->at_y[at + i] = g->dy[at + i] + g->f.off_y[at + i];
    }
}

/* w at the other pixel of the quad, in x (axis 0) or y; step is +1 at even
 * and -1 at odd pixels. */
static void neighbours(struct pe_batch *g, const struct pe_plane *p, int axis,
                       uint32_t at, uint32_t n)
{
    const int32_t *pixel = axis ? g->f.y + at : g->f.x + at;
    const float *dx = g->dx + at, *dy = g->dy + at;
    float *step = g->step[axis] + at, *iw = g->iw + at;
    for (uint32_t i = 0; i < n; i++) {
        step[i] = (float)(1 - 2 * (pixel[i] & 1));
        iw[i] = p->at + p->y * (dy[i] + (axis ? step[i] : 0.0f)) +
                p->x * (dx[i] + (axis ? 0.0f : step[i]));
    }
    invert(iw, n, g->w_step[axis] + at);
}

/* Odd minus even pixel of the quad's row or column. */
static void slope(const struct pe_batch *g, const struct pe_plane *p,
                  int axis, const float *here, uint32_t at, uint32_t n,
                  float *out)
{
    const float *step = g->step[axis] + at, *w = g->w_step[axis] + at;
    for (uint32_t i = 0; i < n; i++) {
        float dx = g->dx[at + i] + (axis ? 0.0f : step[i]);
        float dy = g->dy[at + i] + (axis ? step[i] : 0.0f);
        float there = (p->at + p->y * dy + p->x * dx) * w[i];
        out[at + i] = step[i] * (there - here[at + i]);
    }
}

static void set_slopes(struct pe_bin *b, const struct pe_plane *p,
                       uint32_t at, uint32_t n)
{
    const struct pe_program *prog = b->draw->program;
    struct pe_batch *g = &b->batch;
    const float *w = g->f.z;
    if (b->centroid) {
        eval(&p[0], g->dx + at, g->dy + at, n, g->iw + at);
        invert(g->iw + at, n, g->w_mid + at);
        w = g->w_mid;
    }
    neighbours(g, &p[0], 0, at, n);
    neighbours(g, &p[0], 1, at, n);
    if (b->stage->slope)
        for (uint32_t i = at; i < at + n; i++) {
            g->f.dzdx[i] = g->step[0][i] * (g->w_step[0][i] - w[i]);
            g->f.dzdy[i] = g->step[1][i] * (g->w_step[1][i] - w[i]);
        }
    for (uint32_t k = 0; k < prog->n_vary && b->stage->uv_slope; k++) {
        uint32_t v = prog->vary[k];
        if (v != HL_PE_U && v != HL_PE_V)
            continue;
        const float *here = g->f.vary[v];
        if (b->centroid) {
            eval_times(&p[1 + k], g->dx + at, g->dy + at, w + at, n,
                       g->mid + at);
            here = g->mid;
        }
        for (int axis = 0; axis < 2; axis++)
            slope(g, &p[1 + k], axis, here, at, n,
                  g->f.duv[axis * 2 + (v == HL_PE_V)]);
    }
}

static void place(struct pe_bin *b, const struct pe_tri *t,
                  const uint16_t *pass, uint32_t at, uint32_t n)
{
    const struct pe_raw *r = &b->raw;
    struct pe_batch *g = &b->batch;
    uint16_t *restrict pixel = g->at + at;
    int32_t *restrict x = g->f.x + at, *restrict y = g->f.y + at;
    float *restrict dx = g->dx + at, *restrict dy = g->dy + at;
    int32_t x0 = b->rect.x, y0 = b->rect.y, ax = t->ax, ay = t->ay;
    for (uint32_t i = 0; i < n; i++)
        pixel[i] = r->at[pass[i]];
    for (uint32_t i = 0; i < n; i++) {
        int32_t px = pixel[i] % PE_BIN, py = pixel[i] / PE_BIN;
        x[i] = x0 + px;
        y[i] = y0 + py;
        dx[i] = (float)(px - ax) + 0.5f;
        dy[i] = (float)(py - ay) + 0.5f;
    }
    memset(g->f.back + at, t->back, n);
    for (uint32_t i = 0; i < n && b->samples > 1; i++)
        g->cover[at + i] = r->cover[pass[i]];
    for (uint32_t s = 0; s < b->samples && b->stage->discards; s++)
        for (uint32_t i = 0; i < n; i++)
            g->code[s][at + i] = r->code[s][pass[i]];
}

/* n fragments of one primitive, by their numbers among the raw ones. */
static void join(struct pe_bin *b, const struct pe_tri *t,
                 const struct pe_plane *p, const uint16_t *pass, uint32_t n)
{
    const struct pe_program *prog = b->draw->program;
    struct pe_batch *g = &b->batch;
    uint32_t at = g->f.n;
    const float *dx = g->dx + at, *dy = g->dy + at;
    float *z = g->f.z + at;
    place(b, t, pass, at, n);
    if (b->centroid) {
        centroids(b, pass, at, n);
        dx = g->at_x + at;
        dy = g->at_y + at;
    }
    eval(&p[0], dx, dy, n, g->iw + at);
    invert(g->iw + at, n, z);
    for (uint32_t k = 0; k < prog->n_vary; k++) {
        float *out = g->f.vary[prog->vary[k]] + at;
        if (prog->vary[k] != HL_PE_ID)
            eval_times(&p[1 + k], dx, dy, z, n, out);
        else
            for (uint32_t i = 0; i < n; i++)
                out[i] = t->v[0][PE_V_VARY + k].f;
    }
    if (b->stage->slope || b->stage->uv_slope)
        set_slopes(b, p, at, n);
    g->f.n += n;
}

PE_WIDE
static void shade_run(struct pe_bin *b, const struct pe_tri *t,
                      const uint16_t *pass, uint32_t n)
{
    struct pe_plane p[1 + HL_PE_VARY_COUNT];
    b->shaded += n;
    b->blended += b->ordered ? n : 0;
    set_planes(p, t, b->draw->program->n_vary);
    while (n > 0) {
        uint32_t k = joinable(b, pass, n);
        join(b, t, p, pass, k);
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
    uint32_t level = sample_level(b);
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
