/* SPDX-License-Identifier: Zlib */
/* What a fragment has of its primitive: planes through the vertices, taken at
 * pixel centres or at centroids, and their slopes by quads. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* Behind this no 1 / w is told from another; it keeps w finite where a plane
 * is followed past its triangle's horizon. */
#define IW_MIN 1e-20f

static struct pe_plane plane_of(const struct pe_tri *t, float a0, float a1,
                                float a2)
{
    double d1 = (double)a1 - (double)a0, d2 = (double)a2 - (double)a0;
    double x = d1 * t->c1x + d2 * t->c2x, y = d1 * t->c1y + d2 * t->c2y;
    struct pe_plane p = { (float)((double)a0 + x * t->x + y * t->y),
                          (float)x, (float)y };
    return p;
}

void pe_planes_set(struct pe_plane *p, const struct pe_tri *t,
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

/* The mean of the samples that the primitive covers, inside of it as they are;
 * of all samples that is the centre. What hides some of them is no matter, or
 * an earlier draw would change the light of a later one. */
static void centroids(struct pe_bin *b, const uint16_t *pass, uint32_t at,
                      uint32_t n)
{
    const int8_t (*s)[2] = pe_sample_at[pe_sample_level(b->samples)];
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

PE_WIDE
void pe_batch_join(struct pe_bin *b, const struct pe_tri *t,
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
