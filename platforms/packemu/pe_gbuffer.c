/* SPDX-License-Identifier: Zlib */
/* shaders/gbuffer.frag: the geometry pass. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_surface.h"

PE_INLINE void two16(uint32_t mode, const float *x, const float *y,
                     uint32_t n, float (*out)[HL_PE_BATCH])
{
    for (uint32_t i = 0; i < n; i++) {
        hl_vec4 v = hl_two16_encode(mode, x[i], y[i]);
        out[0][i] = v.x;
        out[1][i] = v.y;
        out[2][i] = v.z;
        out[3][i] = v.w;
    }
}

/* One loop a mode, none of which has branches. */
static void encode(const struct pe_draw *d, const float *x, const float *y,
                   uint32_t n, float (*out)[HL_PE_BATCH])
{
    switch (pe_spec_uint(d, HL_SPEC_TWO16)) {
    case HL_TWO16_SIGNED: two16(HL_TWO16_SIGNED, x, y, n, out); break;
    case HL_TWO16_FIXED32: two16(HL_TWO16_FIXED32, x, y, n, out); break;
    case HL_TWO16_BYTES: two16(HL_TWO16_BYTES, x, y, n, out); break;
    case HL_TWO16_BYTES_ARGB: two16(HL_TWO16_BYTES_ARGB, x, y, n, out); break;
    default: two16(HL_TWO16_UNORM, x, y, n, out);
    }
}

static void normals(const struct pe_draw *d, struct hl_pe_fragments *f,
                    bool full)
{
    uint32_t lanes = PE_LANES(f->n);
    float n[3][HL_PE_BATCH];
    pe_read_normal(d, f, full, n);
    for (uint32_t i = 0; i < lanes; i++) {
        hl_vec2 e = hl_normal_encode(hl_v3(n[0][i], n[1][i], n[2][i]));
        n[0][i] = hl_snorm_to_unorm(e.x);
        n[1][i] = hl_snorm_to_unorm(e.y);
    }
    encode(d, n[0], n[1], lanes, f->color[0]);
}

static void depths(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    uint32_t lanes = PE_LANES(f->n);
    float inv_far = pe_frame(d)->depth.z;
    float inv_steps = 1.0f / pe_spec_float(d, HL_SPEC_ID_STEPS);
    float z[HL_PE_BATCH], id[HL_PE_BATCH];
    for (uint32_t i = 0; i < lanes; i++) {
        z[i] = hl_depth_encode(f->z[i], inv_far);
        id[i] = hl_id_encode(f->vary[HL_PE_ID][i], inv_steps);
    }
    encode(d, z, id, lanes, f->color[1]);
}

static void exponents(const struct pe_draw *d, struct hl_pe_fragments *f,
                      bool full)
{
    float (*out)[HL_PE_BATCH] = f->color[2];
    uint32_t lanes = PE_LANES(f->n);
    pe_exponent_code(d, f, full, out[0]);
    if (pe_spec_uint(d, HL_SPEC_BRDFS) != 0) {
        float x[HL_PE_BATCH], y[HL_PE_BATCH];
        float brdf = hl_brdf_encode(pe_object(d)->flat_ids.w);
        memcpy(x, out[0], sizeof x);
        for (uint32_t i = 0; i < lanes; i++)
            y[i] = brdf;
        encode(d, x, y, lanes, out);
        return;
    }
    for (uint32_t i = 0; i < lanes; i++) {
        out[1][i] = 0.0f;
        out[2][i] = 0.0f;
        out[3][i] = 1.0f;
    }
}

static void motion(const struct pe_draw *d, struct hl_pe_fragments *f,
                   float (*out)[HL_PE_BATCH])
{
    uint32_t lanes = PE_LANES(f->n);
    float (*v)[HL_PE_BATCH] = f->vary;
    float x[HL_PE_BATCH], y[HL_PE_BATCH];
    for (uint32_t i = 0; i < lanes; i++) {
        bool seen = v[HL_PE_MW][i] > 0.0f && v[HL_PE_LW][i] > 0.0f;
        float mx = v[HL_PE_MX][i] / v[HL_PE_MW][i] -
                   v[HL_PE_LX][i] / v[HL_PE_LW][i];
        float my = v[HL_PE_MY][i] / v[HL_PE_MW][i] -
                   v[HL_PE_LY][i] / v[HL_PE_LW][i];
        x[i] = hl_motion_encode(seen ? mx : 0.0f);
        y[i] = hl_motion_encode(seen ? my : 0.0f);
    }
    encode(d, x, y, lanes, out);
}

/* Decals: blended over what is there, the rest stays the surface's below. */
static void decal(const struct pe_draw *d, struct hl_pe_fragments *f,
                  bool full)
{
    if (pe_spec_uint(d, HL_SPEC_DECAL) == 0)
        return;
    pe_surface_alpha(d, f, full, f->color[0][3]);
    for (uint32_t k = 1; k < d->program->desc.n_colors; k++)
        memset(f->color[k][3], 0, sizeof f->color[k][3]);
}

static void gbuffer(const struct pe_draw *d, struct hl_pe_fragments *f,
                    bool full, bool exponent, bool moving)
{
    if (d->program->fragment.stage.discards) {
        pe_alpha_test(d, f, full);
        pe_stipple_test(d, f);
    }
    normals(d, f, full);
    depths(d, f);
    if (exponent)
        exponents(d, f, full);
    if (moving)
        motion(d, f, f->color[exponent ? 3 : 2]);
    decal(d, f, full);
}

void pe_gbuffer_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    gbuffer(d, f, false, false, false);
}

void pe_gbuffer_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    gbuffer(d, f, true, false, false);
}

void pe_gbuffer_plain_exp(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    gbuffer(d, f, false, true, false);
}

void pe_gbuffer_full_exp(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    gbuffer(d, f, true, true, false);
}

void pe_gbuffer_plain_motion(const struct pe_draw *d,
                             struct hl_pe_fragments *f)
{
    gbuffer(d, f, false, false, true);
}

void pe_gbuffer_full_motion(const struct pe_draw *d,
                            struct hl_pe_fragments *f)
{
    gbuffer(d, f, true, false, true);
}

void pe_gbuffer_plain_exp_motion(const struct pe_draw *d,
                                 struct hl_pe_fragments *f)
{
    gbuffer(d, f, false, true, true);
}

void pe_gbuffer_full_exp_motion(const struct pe_draw *d,
                                struct hl_pe_fragments *f)
{
    gbuffer(d, f, true, true, true);
}
