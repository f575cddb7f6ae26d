/* SPDX-License-Identifier: Zlib */
/* shaders/inferred.glsl: which texels lie about a pixel, and which of them
 * the DSF accepts. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_inferred.h"

typedef float planes[4][HL_PE_BATCH];
typedef uint32_t words[4][HL_PE_BATCH];

/* ---- taps ---------------------------------------------------------------- */

/* Where pixels lie among the centres of the L-buffer's texels. */
void pe_light_pixels(const struct pe_draw *d, const struct hl_pe_fragments *f,
                     float *x, float *y)
{
    float rx = pe_spec_float(d, HL_SPEC_RATIO_X);
    float ry = pe_spec_float(d, HL_SPEC_RATIO_Y);
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        x[i] = ((float)f->x[i] + 0.5f) * rx - 0.5f;
        y[i] = ((float)f->y[i] + 0.5f) * ry - 0.5f;
    }
    if (!d->program->centroid)
        return;
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        x[i] += f->off_x[i] * rx;
        y[i] += f->off_y[i] * ry;
    }
}

/* View depths there, metres; as stored ones they end at far. */
PE_WIDE
void pe_pixel_depths(const struct pe_draw *d, const struct hl_pe_fragments *f,
                     float *z)
{
    float far = pe_frame(d)->depth.w;
    for (uint32_t i = 0; i < PE_LANES(f->n); i++)
        z[i] = hl_min(f->z[i], far);
}

static void taps_along(const float *pixel, uint32_t n, int32_t *corner,
                       float *fraction)
{
    for (uint32_t i = 0; i < n; i++) {
        float b = hl_floor(pixel[i]);
        corner[i] = pe_texel(b);
        fraction[i] = pixel[i] - b;
    }
}

PE_WIDE
void pe_find_taps(const struct pe_draw *d, const struct hl_pe_fragments *f,
                  struct pe_taps *t)
{
    uint32_t n = PE_LANES(f->n);
    float x[HL_PE_BATCH], y[HL_PE_BATCH];
    pe_light_pixels(d, f, x, y);
    taps_along(x, n, t->x, t->fx);
    taps_along(y, n, t->y, t->fy);
}

/* ---- acceptance ---------------------------------------------------------- */

void pe_thresholds(const struct pe_draw *d, const struct hl_pe_fragments *f,
                   float distance_texels, float *out)
{
    uint32_t n = PE_LANES(f->n);
    float z[HL_PE_BATCH];
    pe_pixel_depths(d, f, z);
    bool by_slope = pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_SLOPE;
    float step = pe_frame(d)->depth.w / 65535.0f;
    float k = pe_spec_float(d, HL_SPEC_DSF_K);
    float c = pe_spec_float(d, HL_SPEC_DSF_C);
    float tau = pe_spec_float(d, HL_SPEC_DSF_TAU);
    float sx = 1.0f / pe_spec_float(d, HL_SPEC_RATIO_X);
    float sy = 1.0f / pe_spec_float(d, HL_SPEC_RATIO_Y);
    if (!by_slope) {
        for (uint32_t i = 0; i < n; i++)
            out[i] = tau * z[i];
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        float slope = hl_abs(f->dzdx[i]) * sx + hl_abs(f->dzdy[i]) * sy;
        out[i] = hl_dsf_threshold(step, k, c, z[i], slope,
                                  distance_texels);
    }
}

/* Depths, in steps of far / 65535, and ids of one tap. */
static void split_words(const uint32_t *w, uint32_t n, float *depth,
                        float *id)
{
    for (uint32_t i = 0; i < n; i++) {
        depth[i] = (float)(int32_t)(w[i] & 0xffffu);
        id[i] = (float)(int32_t)(w[i] >> 16);
    }
}

static void split_numbers(const struct pe_draw *d, float (*v)[HL_PE_BATCH],
                          uint32_t n, float *depth, float *id)
{
    uint32_t mode = pe_spec_uint(d, HL_SPEC_TWO16);
    float steps = pe_spec_float(d, HL_SPEC_ID_STEPS);
    for (uint32_t i = 0; i < n; i++) {
        hl_vec2 a = hl_two16_decode(mode, hl_v2(v[0][i], v[1][i]));
        depth[i] = a.x * 65535.0f;
        id[i] = a.y * steps;
    }
}

PE_WIDE
void pe_read_dsf(const struct pe_draw *d, const struct pe_taps *t, uint32_t n,
                 struct pe_dsf *out)
{
    const struct pe_view *v = &d->view[HL_TEX_DSF];
    uint32_t lanes = PE_LANES(n);
    if (pe_has_words(v)) {
        words w;
        pe_gather_words(v, 0, t->x, t->y, n, w);
        for (int k = 0; k < 4; k++)
            split_words(w[k], lanes, out->depth[k], out->id[k]);
    } else {
        float taps[4][4][HL_PE_BATCH];
        pe_gather(v, t->x, t->y, n, taps);
        for (int k = 0; k < 4; k++)
            split_numbers(d, taps[k], lanes, out->depth[k], out->id[k]);
    }
}

void pe_fetch_dsf(const struct pe_draw *d, const int32_t *x, const int32_t *y,
                  uint32_t n, float *depth, float *id)
{
    const struct pe_view *v = &d->view[HL_TEX_DSF];
    planes texel;
    uint32_t w[HL_PE_BATCH];
    pe_fetch_texels(v, x, y, n, texel);
    if (pe_has_words(v)) {
        memcpy(w, texel[0], n * sizeof *w);
        split_words(w, n, depth, id);
    } else {
        split_numbers(d, texel, n, depth, id);
    }
}

PE_WIDE
void pe_accept(const struct pe_draw *d, const struct hl_pe_fragments *f,
               const struct pe_dsf *dsf, float distance_texels,
               float out[4][HL_PE_BATCH])
{
    uint32_t n = PE_LANES(f->n);
    float step = pe_frame(d)->depth.w / 65535.0f;
    float threshold[HL_PE_BATCH], z[HL_PE_BATCH];
    const float *id = f->vary[HL_PE_ID];
    pe_pixel_depths(d, f, z);
    pe_thresholds(d, f, distance_texels, threshold);
    for (int k = 0; k < 4; k++)
        for (uint32_t i = 0; i < n; i++)
            out[k][i] = hl_dsf_accept(dsf->depth[k][i] * step, dsf->id[k][i],
                                      z[i], id[i], threshold[i],
                                      hl_dsf_half_step(id[i]));
}

void pe_accept_taps(const struct pe_draw *d, const struct hl_pe_fragments *f,
                    const struct pe_taps *t, float out[4][HL_PE_BATCH])
{
    struct pe_dsf dsf;
    pe_read_dsf(d, t, f->n, &dsf);
    pe_accept(d, f, &dsf, 1.0f, out);
}
