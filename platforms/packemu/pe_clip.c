/* SPDX-License-Identifier: Zlib */
/* Projection, and cutting by near, far, w > 0 and the guard band. An edge
 * that two triangles share is cut from its inner to its outer end in both,
 * so that both get the same new vertex, bit for bit. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* Below this 1 / w would leave floats' range in products with varyings. */
#define W_MIN 1e-20f

enum { PLANES = 7, POINTS = 3 + PLANES };

/* ---- projection ---------------------------------------------------------- */

static int32_t snap(float pixels)
{
    float t = pixels * (float)PE_SUB + 0.5f;
    int32_t i = (int32_t)t;
    return i - ((float)i > t);
}

/* NaN becomes the lower end, so that no conversion is undefined. */
static float bound(float x)
{
    float low = (float)PE_GUARD_LOW - 1.0f, high = (float)PE_GUARD_HIGH + 1.0f;
    x = x > low ? x : low;
    return x < high ? x : high;
}

static int32_t outside(float x, float y, float z, float w, float px, float py)
{
    float nan = (x - x) + (y - y) + (z - z) + (w - w);
    int32_t guard = (px < (float)PE_GUARD_LOW ? PE_OUT_LEFT : 0) |
                    (px > (float)PE_GUARD_HIGH ? PE_OUT_RIGHT : 0) |
                    (py < (float)PE_GUARD_LOW ? PE_OUT_TOP : 0) |
                    (py > (float)PE_GUARD_HIGH ? PE_OUT_BOTTOM : 0);
    return (z < 0.0f ? PE_OUT_NEAR : 0) | (z > w ? PE_OUT_FAR : 0) |
           (w < W_MIN ? PE_OUT_W : guard) | (nan == 0.0f ? 0 : PE_OUT_BAD);
}

void pe_project(const struct pe_viewport *v, const float (*clip)[PE_RUN],
                struct pe_projected *p)
{
    for (uint32_t i = 0; i < PE_RUN; i++) {
        float x = clip[0][i], y = clip[1][i], z = clip[2][i], w = clip[3][i];
        float iw = 1.0f / (w < W_MIN ? 1.0f : w);
        float px = x * iw * v->sx + v->ox, py = y * iw * v->sy + v->oy;
        p->out[i] = outside(x, y, z, w, px, py);
        px = bound(px);
        py = bound(py);
        p->x[i] = snap(px);
        p->y[i] = snap(py);
        p->rx[i] = px - (float)p->x[i] * (1.0f / PE_SUB);
        p->ry[i] = py - (float)p->y[i] * (1.0f / PE_SUB);
        p->z[i] = z / (w < W_MIN ? 1.0f : w);
        p->iw[i] = iw;
    }
}

/* ---- cutting ------------------------------------------------------------- */

struct point { float p[4], vary[HL_PE_VARY_COUNT]; };
struct polygon { uint32_t n; struct point at[POINTS]; };

/* Distance from a plane, positive inside; plane k is bit k of PE_OUT_*. */
static float distance(const struct pe_viewport *v, uint32_t k, const float *p)
{
    const float low = (float)PE_GUARD_LOW, high = (float)PE_GUARD_HIGH;
    switch (k) {
    case 0: return p[2];
    case 1: return p[3] - p[2];
    case 2: return p[3] - W_MIN;
    case 3: return p[0] * v->sx + (v->ox - low) * p[3];
    case 4: return (high - v->ox) * p[3] - p[0] * v->sx;
    case 5: return p[1] * v->sy + (v->oy - low) * p[3];
    default: return (high - v->oy) * p[3] - p[1] * v->sy;
    }
}

static void between(struct point *o, const struct point *in, float d_in,
                    const struct point *out, float d_out, uint32_t n_vary)
{
    float t = d_in / (d_in - d_out);
    for (int i = 0; i < 4; i++)
        o->p[i] = in->p[i] + t * (out->p[i] - in->p[i]);
    for (uint32_t i = 0; i < n_vary; i++)
        o->vary[i] = in->vary[i] + t * (out->vary[i] - in->vary[i]);
}

/* Sutherland and Hodgman 1974, one plane. A line goes through as a polygon of
 * no area; its first two points stay its ends. */
static void cut(struct polygon *o, const struct polygon *g, uint32_t k,
                const struct pe_viewport *v, uint32_t n_vary)
{
    o->n = 0;
    for (uint32_t i = 0; i < g->n; i++) {
        const struct point *a = &g->at[i];
        const struct point *b = &g->at[i + 1 < g->n ? i + 1 : 0];
        float da = distance(v, k, a->p), db = distance(v, k, b->p);
        if (da >= 0.0f && o->n < POINTS)
            o->at[o->n++] = *a;
        if ((da >= 0.0f) == (db >= 0.0f) || o->n == POINTS)
            continue;
        if (da >= 0.0f)
            between(&o->at[o->n++], a, da, b, db, n_vary);
        else
            between(&o->at[o->n++], b, db, a, da, n_vary);
    }
}

static void gather(struct polygon *g, const struct pe_front *f,
                   const struct pe_chunk *c, const uint16_t *local,
                   uint32_t n, uint32_t n_vary)
{
    g->n = n;
    for (uint32_t i = 0; i < n; i++) {
        const union pe_word *w = c->words + f->base + local[i] * f->stride;
        memcpy(g->at[i].p, f->clip[local[i]], sizeof g->at[i].p);
        for (uint32_t k = 0; k < n_vary; k++)
            g->at[i].vary[k] = w[PE_V_VARY + k].f;
    }
}

/* Append the polygon's vertices to the chunk. The region id, which is flat,
 * is the first of the primitive's for all. False: no room. */
static bool append(const struct pe_pass *pass, struct pe_chunk *c,
                   const struct polygon *g, const struct pe_program *prog,
                   float id, uint32_t *first)
{
    float clip[4][PE_RUN] = { { 0 } };
    struct pe_projected p;
    uint32_t stride = PE_V_VARY + prog->n_vary;
    union pe_word *w = pe_chunk_words(c, (uint64_t)g->n * stride);
    if (!w)
        return false;
    *first = (uint32_t)(w - c->words);
    for (uint32_t i = 0; i < g->n; i++)
        for (int k = 0; k < 4; k++)
            clip[k][i] = g->at[i].p[k];
    pe_project(&pass->view, (const float (*)[PE_RUN])clip, &p);
    for (uint32_t i = 0; i < g->n; i++, w += stride) {
        w[PE_V_X].i = p.x[i];
        w[PE_V_Y].i = p.y[i];
        w[PE_V_Z].f = p.z[i];
        w[PE_V_IW].f = p.iw[i];
        w[PE_V_RX].f = p.rx[i];
        w[PE_V_RY].f = p.ry[i];
        for (uint32_t k = 0; k < prog->n_vary; k++)
            w[PE_V_VARY + k].f = prog->vary[k] == HL_PE_ID
                                 ? id : g->at[i].vary[k];
    }
    return true;
}

bool pe_clip(const struct pe_pass *pass, struct pe_front *f,
             struct pe_chunk *c, uint32_t draw, const uint16_t *local,
             uint32_t n)
{
    const struct pe_program *prog = pass->draws[draw].program;
    uint32_t stride = PE_V_VARY + prog->n_vary, first = 0;
    struct polygon g[2];
    gather(&g[0], f, c, local, n, prog->n_vary);
    float id = prog->n_vary ? g[0].at[0].vary[0] : 0.0f;
    for (uint32_t k = 0; k < PLANES; k++)
        cut(&g[~k & 1], &g[k & 1], k, &pass->view, prog->n_vary);
    const struct polygon *last = &g[PLANES & 1];
    if (last->n < n)
        return true;
    if (!append(pass, c, last, prog, id, &first))
        return false;
    if (n == 2)
        return pe_setup_line(pass, c, draw, first, first + stride);
    for (uint32_t i = 1; i + 1 < last->n; i++)
        if (!pe_setup_triangle(pass, c, draw, first, first + i * stride,
                               first + (i + 1) * stride))
            return false;
    return true;
}
