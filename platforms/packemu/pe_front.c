/* SPDX-License-Identifier: Zlib */
/* The front end: vertices of one segment (consecutive primitives of one draw)
 * are transformed, each once where its indices lie close together, and its
 * primitives assembled. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

struct segment {
    const struct pe_draw *draw;
    uint32_t number;         /* of the draw                                  */
    uint32_t first, count;   /* primitives of one instance                   */
    uint32_t corners;        /* of a primitive                               */
};

static uint32_t corners_of(const struct pe_draw *d)
{
    return d->program->desc.topology == HL_TOPOLOGY_LINES ? 2 : 3;
}

static uint32_t instance_primitives(const struct pe_draw *d)
{
    return d->program->vertex->run ? d->in->count / corners_of(d) : 1;
}

uint64_t pe_primitives(const struct pe_draw *d)
{
    return (uint64_t)instance_primitives(d) * d->in->instances;
}

union pe_word *pe_chunk_words(struct pe_chunk *c, uint64_t n)
{
    if (c->n_words + n > c->max_words) {
        c->need_words = c->n_words + n;
        return NULL;
    }
    union pe_word *w = c->words + c->n_words;
    c->n_words += (uint32_t)n;
    return w;
}

/* ---- indices ------------------------------------------------------------- */

/* Index k of the segment's corners. */
static uint32_t index_at(const struct pe_state *s, const struct segment *g,
                         uint32_t k)
{
    const struct hl_bk_draw *d = g->draw->in;
    size_t at = (size_t)d->first + (size_t)g->first * g->corners + k;
    if (d->index == HL_NO_SLOT)
        return (uint32_t)at;
    const uint8_t *memory = s->buf[d->index].memory;
    uint16_t narrow;
    uint32_t wide;
    if (d->index16) {
        memcpy(&narrow, memory + at * sizeof narrow, sizeof narrow);
        return narrow;
    }
    memcpy(&wide, memory + at * sizeof wide, sizeof wide);
    return wide;
}

/* Vertex of an index. What base_vertex takes out of range ends at the range's
 * ends, and pe_vertex_fetch.c keeps it inside the buffers. */
static uint32_t id_of(const struct hl_bk_draw *d, uint32_t index)
{
    if (d->index == HL_NO_SLOT)
        return index;
    int64_t id = (int64_t)index + d->base_vertex;
    return id < 0 ? 0 : id > 0xffffffff ? 0xffffffffu : (uint32_t)id;
}

/* Lowest index and how many from there on, where transforming all of those
 * is worth it; else 0. */
static uint32_t index_range(const struct pe_state *s, const struct segment *g,
                            uint32_t *low)
{
    uint32_t a = 0xffffffffu, b = 0, n = g->count * g->corners;
    if (g->draw->in->index == HL_NO_SLOT) {
        *low = index_at(s, g, 0);
        return n <= PE_CACHE ? n : 0;
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = index_at(s, g, i);
        a = k < a ? k : a;
        b = k > b ? k : b;
    }
    *low = a;
    return b - a < PE_CACHE && b - a < n ? b - a + 1 : 0;
}

/* ---- vertices ------------------------------------------------------------ */

static void keep_run(struct pe_front *f, const struct pe_program *p,
                     union pe_word *w, uint32_t at, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        union pe_word *o = w + i * f->stride;
        o[PE_V_X].i = f->p.x[i];
        o[PE_V_Y].i = f->p.y[i];
        o[PE_V_Z].f = f->p.z[i];
        o[PE_V_IW].f = f->p.iw[i];
        o[PE_V_RX].f = f->p.rx[i];
        o[PE_V_RY].f = f->p.ry[i];
        for (uint32_t k = 0; k < p->n_vary; k++)
            o[PE_V_VARY + k].f = f->v.vary[p->vary[k]][i];
        f->out[at + i] = (uint8_t)f->p.out[i];
        for (int k = 0; k < 4; k++)
            f->clip[at + i][k] = f->v.clip[k][i];
    }
}

/* Transform f->ids[0..n-1] as local vertices from `at` on. */
static void transform_run(const struct pe_pass *pass, struct pe_front *f,
                          const struct pe_draw *d, union pe_word *w,
                          uint32_t at, uint32_t n)
{
    f->v.n = n;
    pe_fetch_vertices(pass->state, d, f->ids, &f->v);
    d->program->vertex->run(d, &f->v);
    pe_project(&pass->view, (const float (*)[PE_RUN])f->v.clip, &f->p);
    keep_run(f, d->program, w + at * f->stride, at, n);
}

/* ---- assembly ------------------------------------------------------------ */

static bool triangle(const struct pe_pass *pass, struct pe_front *f,
                     struct pe_chunk *c, uint32_t draw, const uint16_t *l)
{
    uint32_t any = f->out[l[0]] | f->out[l[1]] | f->out[l[2]];
    if (any & PE_OUT_BAD || f->out[l[0]] & f->out[l[1]] & f->out[l[2]])
        return true;
    if (any)
        return pe_clip(pass, f, c, draw, l, 3);
    return pe_setup_triangle(pass, c, draw, f->base + l[0] * f->stride,
                             f->base + l[1] * f->stride,
                             f->base + l[2] * f->stride);
}

static bool line(const struct pe_pass *pass, struct pe_front *f,
                 struct pe_chunk *c, uint32_t draw, const uint16_t *l)
{
    uint32_t any = f->out[l[0]] | f->out[l[1]];
    if (any & PE_OUT_BAD || f->out[l[0]] & f->out[l[1]])
        return true;
    if (any)
        return pe_clip(pass, f, c, draw, l, 2);
    return pe_setup_line(pass, c, draw, f->base + l[0] * f->stride,
                         f->base + l[1] * f->stride);
}

static bool assemble(const struct pe_pass *pass, struct pe_front *f,
                     struct pe_chunk *c, const struct segment *g,
                     const uint16_t *local, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++, local += g->corners)
        if (!(g->corners == 3 ? triangle(pass, f, c, g->number, local)
                              : line(pass, f, c, g->number, local)))
            return false;
    return true;
}

/* All vertices from index `low` on, then all primitives. */
static bool run_dense(const struct pe_pass *pass, struct pe_front *f,
                      struct pe_chunk *c, const struct segment *g,
                      uint32_t low, uint32_t range)
{
    union pe_word *w = pe_chunk_words(c, (uint64_t)range * f->stride);
    if (!w)
        return false;
    f->base = (uint32_t)(w - c->words);
    for (uint32_t at = 0; at < range; at += PE_RUN) {
        uint32_t n = range - at < PE_RUN ? range - at : PE_RUN;
        for (uint32_t i = 0; i < n; i++)
            f->ids[i] = id_of(g->draw->in, low + at + i);
        transform_run(pass, f, g->draw, w, at, n);
    }
    uint32_t n = g->count * g->corners;
    for (uint32_t i = 0; i < n; i++)
        f->local[i] = (uint16_t)(index_at(pass->state, g, i) - low);
    return assemble(pass, f, c, g, f->local, g->count);
}

/* Indices far apart: as many primitives at a time as a run has vertices. */
static bool run_sparse(const struct pe_pass *pass, struct pe_front *f,
                       struct pe_chunk *c, const struct segment *g)
{
    uint32_t most = PE_RUN / g->corners;
    for (uint32_t i = 0; i < PE_RUN; i++)
        f->local[i] = (uint16_t)i;
    for (uint32_t done = 0; done < g->count; done += most) {
        uint32_t n = g->count - done < most ? g->count - done : most;
        uint32_t vertices = n * g->corners;
        union pe_word *w = pe_chunk_words(c, (uint64_t)vertices * f->stride);
        if (!w)
            return false;
        f->base = (uint32_t)(w - c->words);
        for (uint32_t i = 0; i < vertices; i++)
            f->ids[i] = id_of(g->draw->in,
                              index_at(pass->state, g, done * g->corners + i));
        transform_run(pass, f, g->draw, w, 0, vertices);
        if (!assemble(pass, f, c, g, f->local, n))
            return false;
    }
    return true;
}

static bool run_segment(const struct pe_pass *pass, struct pe_front *f,
                        struct pe_chunk *c, const struct segment *g)
{
    uint32_t low = 0;
    if (!g->draw->program->vertex->run)
        return pe_setup_screen(pass, c, g->number);
    f->stride = PE_V_VARY + (uint32_t)g->draw->program->n_vary;
    uint32_t range = index_range(pass->state, g, &low);
    return range ? run_dense(pass, f, c, g, low, range)
                 : run_sparse(pass, f, c, g);
}

/* ---- chunks -------------------------------------------------------------- */

/* Primitives `at` and on of a draw, at most `left`, of one instance. */
static struct segment segment_at(const struct pe_pass *pass, uint32_t draw,
                                 uint64_t at, uint64_t left)
{
    const struct pe_draw *d = &pass->draws[draw];
    uint32_t each = instance_primitives(d);
    struct segment g = { d, draw, (uint32_t)(at % each), 0, corners_of(d) };
    uint64_t n = each - g.first;
    n = n < left ? n : left;
    g.count = n < PE_SEGMENT ? (uint32_t)n : PE_SEGMENT;
    return g;
}

static bool run_chunk(const struct pe_pass *pass, struct pe_front *f,
                      struct pe_chunk *c)
{
    uint32_t draw = c->first_draw;
    uint64_t at = c->first, left = c->count, n;
    const struct pe_draw *begun = NULL;
    for (; left > 0; draw++, at = 0) {
        n = pe_primitives(&pass->draws[draw]);
        while (at < n && left > 0) {
            struct segment g = segment_at(pass, draw, at, left);
            if (g.draw != begun)
                pe_fetch_begin(pass->state, g.draw, &f->v);
            begun = g.draw;
            if (!run_segment(pass, f, c, &g))
                return false;
            at += g.count;
            left -= g.count;
        }
    }
    return true;
}

void pe_front_run(void *user, uint32_t item, uint32_t thread)
{
    const struct pe_pass *pass = user;
    struct pe_chunk *c = &pass->chunks[pass->pending[item]];
    c->n_words = c->n_records = c->n_pairs = 0;
    c->need_words = c->need_records = c->need_pairs = 0;
    if (!run_chunk(pass, pass->front[thread], c))
        return;
    if (c->n_pairs > c->max_sorted)
        c->need_pairs = c->n_pairs;
    else
        pe_chunk_sort(c, pass->nx * pass->ny);
}
