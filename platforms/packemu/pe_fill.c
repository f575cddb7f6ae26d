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
    float cell[2], side, last[2];
};

/* Fragments without a tap, by their number. */
struct lost {
    uint32_t n, at[HL_PE_BATCH];
    float nearest[HL_PE_BATCH];
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
    pe_light_pixels(d, f, x, y);
    along(x, cell.x, side, PE_LANES(f->n), g->bx, g->fx);
    along(y, cell.y, side, PE_LANES(f->n), g->by, g->fy);
}

/* Texel of a sample; past the borders the outermost one. The last clamp is
 * for buffers that are smaller than a pattern's block. */
static inline int32_t texel_of(const struct lattice *g, int axis, float s)
{
    float last = g->last[axis], cell = g->cell[axis];
    float most = hl_floor((last - cell) / g->side);
    float at = hl_max(hl_min(s, most), 0.0f) * g->side + cell;
    return (int32_t)hl_min(at, last);
}

/* ---- where all four are rejected ----------------------------------------- */

static void find_lost(float (*a)[HL_PE_BATCH], uint32_t n, struct lost *l)
{
    l->n = 0;
    for (uint32_t i = 0; i < n; i++)
        if (a[0][i] + a[1][i] + a[2][i] + a[3][i] == 0.0f)
            l->at[l->n++] = i;
}

/* The one of the four that is nearest in depth. */
static void nearest_in_depth(const struct pe_draw *d,
                             const struct hl_pe_fragments *f,
                             const struct pe_dsf *dsf, struct lost *l)
{
    float far = pe_frame(d)->depth.w, step = far / 65535.0f;
    const float *z = pe_pixel_depths(f), *id = f->vary[HL_PE_ID];
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i = l->at[k];
        float miss[4], half_step = hl_dsf_half_step(id[i]);
        for (int t = 0; t < 4; t++)
            miss[t] = hl_fill_miss(dsf->depth[t][i] * step, dsf->id[t][i],
                                   z[i], id[i], half_step, far);
        hl_vec2 tap = hl_fill_tap(hl_v4(miss[0], miss[1], miss[2], miss[3]));
        l->nearest[k] = HL_FILL_NONE;
        l->x[k] = tap.x;
        l->y[k] = tap.y;
    }
}

static void texels(const struct lattice *g, const struct lost *l, float dx,
                   float dy, int32_t *x, int32_t *y)
{
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i = l->at[k];
        x[k] = texel_of(g, 0, g->bx[i] + dx);
        y[k] = texel_of(g, 1, g->by[i] + dy);
    }
}

/* Sample (dx, dy) from the base, where it is nearer than what was found. */
static void try_sample(const struct pe_draw *d,
                       const struct hl_pe_fragments *f,
                       const struct lattice *g, const float *threshold,
                       float dx, float dy, struct lost *l)
{
    float step = pe_frame(d)->depth.w / 65535.0f;
    const float *z = pe_pixel_depths(f), *id = f->vary[HL_PE_ID];
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    float depth[HL_PE_BATCH], found[HL_PE_BATCH];
    texels(g, l, dx, dy, x, y);
    pe_fetch_dsf(d, x, y, l->n, depth, found);
    for (uint32_t k = 0; k < l->n; k++) {
        uint32_t i = l->at[k];
        float distance = hl_fill_distance(dx, dy, hl_v2(g->fx[i], g->fy[i]));
        if (distance >= l->nearest[k] ||
            hl_dsf_accept(depth[k] * step, found[k], z[i], id[i],
                          threshold[i], hl_dsf_half_step(id[i])) == 0.0f)
            continue;
        l->nearest[k] = distance;
        l->x[k] = dx;
        l->y[k] = dy;
    }
}

static void light_lost(const struct pe_draw *d, const struct lattice *g,
                       const struct lost *l, float (*out)[HL_PE_BATCH])
{
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    float light[4][HL_PE_BATCH];
    for (uint32_t k = 0; k < l->n; k++) {
        x[k] = texel_of(g, 0, g->bx[l->at[k]] + l->x[k]);
        y[k] = texel_of(g, 1, g->by[l->at[k]] + l->y[k]);
    }
    pe_fetch_light(d, x, y, l->n, light);
    for (int c = 0; c < 4; c++)
        for (uint32_t k = 0; k < l->n; k++)
            out[c][l->at[k]] = light[c][k];
}

static void fill(const struct pe_draw *d, const struct hl_pe_fragments *f,
                 const struct lattice *g, const struct pe_dsf *dsf,
                 struct lost *l, float (*out)[HL_PE_BATCH])
{
    float threshold[HL_PE_BATCH];
    nearest_in_depth(d, f, dsf, l);
    pe_thresholds(d, f, 2.0f * g->side, threshold);
    for (int i = 0; i < 16; i++) {
        int x = (i & 3) - 1, y = (i >> 2) - 1;
        bool inner = (x == 0 || x == 1) && (y == 0 || y == 1);
        if (!inner)
            try_sample(d, f, g, threshold, (float)x, (float)y, l);
    }
    light_lost(d, g, l, out);
}

void pe_fill_light(const struct pe_draw *d, const struct hl_pe_fragments *f,
                   const struct pe_dsf *dsf, float a[4][HL_PE_BATCH],
                   float out[4][HL_PE_BATCH])
{
    struct lost l;
    struct lattice g;
    find_lost(a, f->n, &l);
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
    find_lost(a, f->n, &l);
    if (l.n > 0 && pe_spec_uint(d, HL_SPEC_FILL))
        fill(d, f, &g, &dsf, &l, out);
}
