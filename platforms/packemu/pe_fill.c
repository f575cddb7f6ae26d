/* SPDX-License-Identifier: Zlib */
/* shaders/inferred.glsl where samples are looked at one by one: those of a
 * stipple pattern, and those around a pixel whose taps are all rejected. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_inferred.h"
#include "shaders/shared/stipple.h"

/* The samples that a surface may have: all texels, or those of its pattern,
 * every `side` texels from `cell` on. Fragments lie f samples from sample b. */
struct lattice {
    float bx[HL_PE_BATCH], by[HL_PE_BATCH], fx[HL_PE_BATCH], fy[HL_PE_BATCH];
    float cell[2], side;
    float last[2], most[2];                      /* texel, sample            */
};

/* Fragments without a tap, by their number, and what they are compared by. */
struct lost {
    uint32_t n, at[HL_PE_BATCH];
    float z[HL_PE_BATCH], id[HL_PE_BATCH], half_step[HL_PE_BATCH];
    float fx[HL_PE_BATCH], fy[HL_PE_BATCH], threshold[HL_PE_BATCH];
    float nearest[HL_PE_BATCH], weight[4][HL_PE_BATCH];
    float x[HL_PE_BATCH], y[HL_PE_BATCH];        /* from sample b            */
};

/* ---- samples ------------------------------------------------------------- */

static void along(const float *pixel, float cell, float side, uint32_t n,
                  float *base, float *fraction)
{
    for (uint32_t i = 0; i < n; i++) {
        float q = (pixel[i] - cell) / side;
        base[i] = hl_floor(q);
        fraction[i] = q - base[i];
    }
}

PE_WIDE
static void find_lattice(const struct pe_draw *d,
                         const struct hl_pe_fragments *f, hl_vec2 cell,
                         float side, struct lattice *g)
{
    float x[HL_PE_BATCH], y[HL_PE_BATCH];
    g->cell[0] = cell.x;
    g->cell[1] = cell.y;
    g->side = side;
    g->last[0] = pe_spec_float(d, HL_SPEC_LIGHT_WIDTH) - 1.0f;
    g->last[1] = pe_spec_float(d, HL_SPEC_LIGHT_HEIGHT) - 1.0f;
    for (int c = 0; c < 2; c++)
        g->most[c] = hl_floor((g->last[c] - g->cell[c]) / side);
    pe_light_pixels(d, f, x, y);
    along(x, cell.x, side, PE_LANES(f->n), g->bx, g->fx);
    along(y, cell.y, side, PE_LANES(f->n), g->by, g->fy);
}

/* Texel of a sample; past the borders the outermost one. The last clamp is
 * for buffers that are smaller than a pattern's block. */
static inline int32_t texel_of(const struct lattice *g, int axis, float s)
{
    float at = hl_max(hl_min(s, g->most[axis]), 0.0f) * g->side;
    return (int32_t)hl_min(at + g->cell[axis], g->last[axis]);
}

/* ---- where all four are rejected ----------------------------------------- */

/* Most batches have none: looked for in a loop without branches, which lanes
 * beyond n may at worst make look again. */
PE_WIDE
static bool any_lost(float (*a)[HL_PE_BATCH], uint32_t n)
{
    uint32_t lost = 0;
    for (uint32_t i = 0; i < PE_LANES(n); i++)
        lost |= a[0][i] + a[1][i] + a[2][i] + a[3][i] == 0.0f;
    return lost != 0;
}

static void find_lost(float (*a)[HL_PE_BATCH], uint32_t n, struct lost *l)
{
    l->n = 0;
    if (!any_lost(a, n))
        return;
    for (uint32_t i = 0; i < n; i++)
        if (a[0][i] + a[1][i] + a[2][i] + a[3][i] == 0.0f)
            l->at[l->n++] = i;
}

/* Less those that are hidden, most likely. */
static void drop_hidden(const struct pe_draw *d,
                        const struct hl_pe_fragments *f,
                        const struct pe_dsf *dsf, float side, struct lost *l)
{
    float step = pe_frame(d)->depth.w / 65535.0f;
    float threshold[HL_PE_BATCH], z[HL_PE_BATCH];
    uint32_t n = l->n;
    if (pe_spec_uint(d, HL_SPEC_FILL) & HL_FILL_THROUGH)
        return;
    l->n = 0;
    pe_pixel_depths(d, f, z);
    pe_thresholds(d, f, side, threshold);
    for (uint32_t k = 0; k < n; k++) {
        uint32_t i = l->at[k];
        hl_vec4 tap = hl_v4(dsf->depth[0][i] * step, dsf->depth[1][i] * step,
                            dsf->depth[2][i] * step, dsf->depth[3][i] * step);
        if (!hl_fill_hidden(tap, z[i], threshold[i]))
            l->at[l->n++] = i;
    }
}

static void gather_lost(const struct pe_draw *d,
                        const struct hl_pe_fragments *f,
                        const struct lattice *g, struct lost *l)
{
    const float *id = f->vary[HL_PE_ID];
    float threshold[HL_PE_BATCH], z[HL_PE_BATCH];
    pe_pixel_depths(d, f, z);
    pe_thresholds(d, f, 2.0f * g->side, threshold);
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i = l->at[k];
        l->z[k] = z[i];
        l->id[k] = id[i];
        l->half_step[k] = hl_dsf_half_step(id[i]);
        l->fx[k] = g->fx[i];
        l->fy[k] = g->fy[i];
        l->threshold[k] = threshold[i];
    }
}

/* How much the four count where nothing nearer is found. */
static void weigh_lost(const struct pe_draw *d, const struct pe_dsf *dsf,
                       struct lost *l)
{
    float step = pe_frame(d)->depth.w / 65535.0f;
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i = l->at[k];
        float gap[4];
        for (int t = 0; t < 4; t++)
            gap[t] = hl_abs(dsf->depth[t][i] * step - l->z[k]);
        hl_vec4 w = hl_fill_weights(hl_bilinear(hl_v2(l->fx[k], l->fy[k])),
                                    hl_v4(gap[0], gap[1], gap[2], gap[3]),
                                    l->z[k]);
        l->weight[0][k] = w.x;
        l->weight[1][k] = w.y;
        l->weight[2][k] = w.z;
        l->weight[3][k] = w.w;
        l->nearest[k] = HL_FILL_NONE;
        l->x[k] = l->y[k] = 0.0f;
    }
}

/* Samples 00, 10, 01, 11 from base + (dx, dy) on. */
static void read_quad(const struct pe_draw *d, const struct lattice *g,
                      const struct lost *l, float dx, float dy,
                      struct pe_dsf *out)
{
    struct pe_taps t;
    if (g->side == 1.0f) {
        for (uint32_t k = 0; k < l->n; k++) {
            t.x[k] = pe_texel(g->bx[l->at[k]] + dx);
            t.y[k] = pe_texel(g->by[l->at[k]] + dy);
        }
        pe_read_dsf(d, &t, l->n, out);
        return;
    }
    for (int s = 0; s < 4; s++) {
        for (uint32_t k = 0; k < l->n; k++) {
            uint32_t i = l->at[k];
            t.x[k] = texel_of(g, 0, g->bx[i] + dx + (float)(s & 1));
            t.y[k] = texel_of(g, 1, g->by[i] + dy + (float)(s >> 1));
        }
        pe_fetch_dsf(d, t.x, t.y, l->n, out->depth[s], out->id[s]);
    }
}

/* Sample (x, y) from the base, where it is nearer than what was found. */
PE_WIDE
static void try_sample(struct lost *l, float step, float x, float y,
                       const float *depth, const float *id)
{
    for (uint32_t k = 0; k < PE_LANES(l->n); k++) {
        float distance = hl_fill_distance(x, y, hl_v2(l->fx[k], l->fy[k]));
        float a = hl_dsf_accept(depth[k] * step, id[k], l->z[k], l->id[k],
                                l->threshold[k], l->half_step[k]);
        bool nearer = (a > 0.0f) & (distance < l->nearest[k]);
        l->nearest[k] = nearer ? distance : l->nearest[k];
        l->x[k] = nearer ? x : l->x[k];
        l->y[k] = nearer ? y : l->y[k];
    }
}

static void try_quad(const struct pe_draw *d, const struct lattice *g,
                     float dx, float dy, struct lost *l)
{
    float step = pe_frame(d)->depth.w / 65535.0f;
    struct pe_dsf dsf;
    read_quad(d, g, l, dx, dy, &dsf);
    for (int s = 0; s < 4; s++)
        try_sample(l, step, dx + (float)(s & 1), dy + (float)(s >> 1),
                   dsf.depth[s], dsf.id[s]);
}

/* Light of sample (x, y) from the base, of each its own. */
static void fetch_lost(const struct pe_draw *d, const struct lattice *g,
                       const struct lost *l, const float *x, const float *y,
                       float light[4][HL_PE_BATCH])
{
    int32_t tx[HL_PE_BATCH], ty[HL_PE_BATCH];
    for (uint32_t k = 0; k < l->n; k++) {
        tx[k] = texel_of(g, 0, g->bx[l->at[k]] + x[k]);
        ty[k] = texel_of(g, 1, g->by[l->at[k]] + y[k]);
    }
    pe_fetch_light(d, tx, ty, l->n, light);
}

/* Light of the four, weighed: taps 00, 10, 01, 11 in turn, as the stage's
 * sum is. */
static void weighed_lost(const struct pe_draw *d, const struct lattice *g,
                         const struct lost *l, float sum[4][HL_PE_BATCH])
{
    float light[4][HL_PE_BATCH], x[HL_PE_BATCH], y[HL_PE_BATCH];
    memset(sum, 0, 4 * sizeof sum[0]);
    for (int t = 0; t < 4; t++) {
        for (uint32_t k = 0; k < l->n; k++) {
            x[k] = (float)(t & 1);
            y[k] = (float)(t >> 1);
        }
        fetch_lost(d, g, l, x, y, light);
        for (int c = 0; c < 4; c++)
            for (uint32_t k = 0; k < l->n; k++)
                sum[c][k] += light[c][k] * l->weight[t][k];
    }
}

static void light_lost(const struct pe_draw *d, const struct lattice *g,
                       const struct lost *l, float (*out)[HL_PE_BATCH])
{
    float light[4][HL_PE_BATCH], sum[4][HL_PE_BATCH];
    weighed_lost(d, g, l, sum);
    fetch_lost(d, g, l, l->x, l->y, light);
    for (int c = 0; c < 4; c++)
        for (uint32_t k = 0; k < l->n; k++)
            out[c][l->at[k]] = l->nearest[k] < HL_FILL_NONE ? light[c][k]
                                                            : sum[c][k];
}

static void fill(const struct pe_draw *d, const struct hl_pe_fragments *f,
                 const struct lattice *g, const struct pe_dsf *dsf,
                 struct lost *l, float (*out)[HL_PE_BATCH])
{
    gather_lost(d, f, g, l);
    weigh_lost(d, dsf, l);
    for (int q = 0; q < 4 && (pe_spec_uint(d, HL_SPEC_FILL) & 1u); q++)
        try_quad(d, g, q & 1 ? 1.0f : -1.0f, q & 2 ? 1.0f : -1.0f, l);
    light_lost(d, g, l, out);
}

void pe_fill_light(const struct pe_draw *d, const struct hl_pe_fragments *f,
                   const struct pe_dsf *dsf, float a[4][HL_PE_BATCH],
                   float out[4][HL_PE_BATCH])
{
    struct lost l;
    struct lattice g;
    find_lost(a, f->n, &l);
    if (l.n > 0)
        drop_hidden(d, f, dsf, 1.0f, &l);
    if (l.n == 0)
        return;
    find_lattice(d, f, hl_v2(0.0f, 0.0f), 1.0f, &g);
    fill(d, f, &g, dsf, &l, out);
}

/* ---- a pattern's samples ------------------------------------------------- */

static void fetch_taps(const struct pe_draw *d, const struct lattice *g,
                       uint32_t n, struct pe_dsf *dsf,
                       float light[4][4][HL_PE_BATCH])
{
    for (int t = 0; t < 4; t++) {
        int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
        for (uint32_t i = 0; i < n; i++) {
            x[i] = texel_of(g, 0, g->bx[i] + (float)(t & 1));
            y[i] = texel_of(g, 1, g->by[i] + (float)(t >> 1));
        }
        pe_fetch_dsf(d, x, y, n, dsf->depth[t], dsf->id[t]);
        pe_fetch_light(d, x, y, n, light[t]);
    }
}

static void weigh(const struct lattice *g, float (*a)[HL_PE_BATCH], bool cone,
                  uint32_t n, float light[4][4][HL_PE_BATCH],
                  float (*out)[HL_PE_BATCH])
{
    for (uint32_t i = 0; i < n; i++) {
        hl_vec4 w = hl_stipple_weights(hl_v2(g->fx[i], g->fy[i]),
                                       hl_v4(a[0][i], a[1][i], a[2][i],
                                             a[3][i]), cone);
        for (int c = 0; c < 4; c++)
            out[c][i] = light[0][c][i] * w.x + light[1][c][i] * w.y +
                        light[2][c][i] * w.z + light[3][c][i] * w.w;
    }
}

void pe_stippled_light(const struct pe_draw *d,
                       const struct hl_pe_fragments *f,
                       float out[4][HL_PE_BATCH])
{
    uint32_t side = pe_spec_uint(d, HL_SPEC_STIPPLE);
    bool off = pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_OFF;
    bool cone = pe_spec_uint(d, HL_SPEC_STIPPLE_CONE) != 0;
    struct lattice g;
    struct pe_dsf dsf;
    struct lost l;
    float light[4][4][HL_PE_BATCH], a[4][HL_PE_BATCH];
    find_lattice(d, f, hl_stipple_cell(pe_uint(pe_object(d)->flat_ids.z),
                                       side), (float)(int32_t)side, &g);
    fetch_taps(d, &g, f->n, &dsf, light);
    if (off)
        for (int i = 0; i < 4 * HL_PE_BATCH; i++)
            a[i / HL_PE_BATCH][i % HL_PE_BATCH] = 1.0f;
    else
        pe_accept(d, f, &dsf, g.side, a);
    weigh(&g, a, cone, f->n, light, out);
    if (!pe_spec_uint(d, HL_SPEC_FILL))
        return;
    find_lost(a, f->n, &l);
    if (l.n > 0)
        drop_hidden(d, f, &dsf, g.side, &l);
    if (l.n > 0)
        fill(d, f, &g, &dsf, &l, out);
}
