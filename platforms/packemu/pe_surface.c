/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_surface.h"
#include "shaders/shared/stipple.h"

typedef float planes[4][HL_PE_BATCH];

static bool textured(const struct pe_draw *d, uint32_t bit)
{
    return (pe_spec_uint(d, HL_SPEC_TEXTURES) & bit) != 0;
}

static void fill(float *out, uint32_t n, float x)
{
    for (uint32_t i = 0; i < n; i++)
        out[i] = x;
}

static void sample(const struct pe_draw *d, uint32_t slot,
                   const struct hl_pe_fragments *f, planes out)
{
    hl_pe_sample(d, slot, f, f->vary[HL_PE_U], f->vary[HL_PE_V], out);
}

static void base_color(const struct pe_draw *d,
                       const struct hl_pe_fragments *f, planes out)
{
    uint32_t n = PE_LANES(f->n);
    hl_vec4 base = pe_material(d)->base;
    float factor[4] = { base.x, base.y, base.z, base.w };
    planes t;
    bool texture = textured(d, HL_TEXTURED_BASE);
    if (texture)
        sample(d, HL_TEX_BASE, f, t);
    for (int c = 0; c < 4; c++) {
        const float *color = f->vary[HL_PE_R + c];
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = factor[c] * color[i];
        for (uint32_t i = 0; texture && i < n; i++)
            out[c][i] *= t[c][i];
    }
}

static void alpha_test(const struct pe_draw *d, struct hl_pe_fragments *f,
                       const float *alpha)
{
    uint32_t mask = pe_spec_uint(d, HL_SPEC_MASK);
    float least = mask == 2 ? HL_ALPHA_VISIBLE : pe_material(d)->params.w;
    for (uint32_t i = 0; i < f->n; i++)
        f->discard[i] = mask && alpha[i] < least;
}

void pe_surface_alpha(const struct pe_draw *d,
                      const struct hl_pe_fragments *f, bool full, float *out)
{
    planes base;
    if (!full) {
        fill(out, PE_LANES(f->n), pe_material(d)->base.w);
        return;
    }
    base_color(d, f, base);
    memcpy(out, base[3], sizeof base[3]);
}

void pe_alpha_test(const struct pe_draw *d, struct hl_pe_fragments *f,
                   bool full)
{
    float alpha[HL_PE_BATCH];
    if (!full || pe_spec_uint(d, HL_SPEC_MASK) == 0) {
        memset(f->discard, 0, sizeof f->discard);
        return;
    }
    pe_surface_alpha(d, f, true, alpha);
    alpha_test(d, f, alpha);
}

void pe_stipple_test(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    uint32_t side = pe_spec_uint(d, HL_SPEC_STIPPLE);
    if (side == 0)
        return;
    hl_vec2 cell = hl_stipple_cell(pe_uint(pe_object(d)->flat_ids.z), side);
    int32_t x = (int32_t)cell.x, y = (int32_t)cell.y, in = (int32_t)side - 1;
    for (uint32_t i = 0; i < f->n; i++)
        f->discard[i] |= (f->x[i] & in) != x || (f->y[i] & in) != y;
}

/* Metallic and roughness, by factor and texture. */
static void metal_rough(const struct pe_draw *d,
                        const struct hl_pe_fragments *f, float *metallic,
                        float *roughness)
{
    uint32_t n = PE_LANES(f->n);
    hl_vec4 p = pe_material(d)->params;
    planes t;
    for (uint32_t i = 0; i < n; i++) {
        metallic[i] = p.x;
        roughness[i] = p.y;
    }
    if (!textured(d, HL_TEXTURED_METAL_ROUGH))
        return;
    sample(d, HL_TEX_METAL_ROUGH, f, t);
    for (uint32_t i = 0; i < n; i++) {
        roughness[i] *= t[1][i];
        metallic[i] *= t[2][i];
    }
}

/* Emission and ambient; s->albedo is there. */
static void lit_base(const struct pe_draw *d, const struct hl_pe_fragments *f,
                     struct pe_surface *s)
{
    uint32_t n = PE_LANES(f->n);
    hl_vec4 e = pe_material(d)->emission, a = pe_frame(d)->ambient;
    float emission[3] = { e.x, e.y, e.z }, ambient[3] = { a.x, a.y, a.z };
    planes t;
    bool texture = textured(d, HL_TEXTURED_EMISSION);
    if (texture)
        sample(d, HL_TEX_EMISSION, f, t);
    for (int c = 0; c < 3; c++)
        for (uint32_t i = 0; i < n; i++) {
            float glow = texture ? emission[c] * t[c][i] : emission[c];
            s->base[c][i] = glow + s->albedo[c][i] * ambient[c];
        }
}

static void read_full(const struct pe_draw *d, struct hl_pe_fragments *f,
                      struct pe_surface *s)
{
    uint32_t n = PE_LANES(f->n);
    float weight = pe_material(d)->emission.w;
    float metallic[HL_PE_BATCH], roughness[HL_PE_BATCH];
    planes base;
    base_color(d, f, base);
    alpha_test(d, f, base[3]);
    metal_rough(d, f, metallic, roughness);
    for (uint32_t i = 0; i < n; i++) {
        hl_vec3 b = hl_v3(base[0][i], base[1][i], base[2][i]);
        float e = hl_roughness_exponent(roughness[i]);
        hl_vec3 rho = hl_material_albedo(b, metallic[i]);
        hl_vec3 ks = hl_material_specular(b, metallic[i], e);
        s->exponent[i] = e;
        s->alpha[i] = base[3][i];
        s->albedo[0][i] = rho.x;
        s->albedo[1][i] = rho.y;
        s->albedo[2][i] = rho.z;
        s->specular[0][i] = ks.x * weight;
        s->specular[1][i] = ks.y * weight;
        s->specular[2][i] = ks.z * weight;
    }
    lit_base(d, f, s);
}

static void fill3(float (*out)[HL_PE_BATCH], uint32_t n, float x, float y,
                  float z)
{
    fill(out[0], n, x);
    fill(out[1], n, y);
    fill(out[2], n, z);
}

static void read_plain(const struct pe_draw *d, uint32_t n,
                       struct pe_surface *s)
{
    const struct hl_material_block *m = pe_material(d);
    hl_vec4 rho = m->albedo, ks = m->specular, e = m->emission;
    hl_vec4 a = pe_frame(d)->ambient;
    fill3(s->albedo, n, rho.x, rho.y, rho.z);
    fill3(s->specular, n, ks.x, ks.y, ks.z);
    fill3(s->base, n, e.x + rho.x * a.x, e.y + rho.y * a.y,
          e.z + rho.z * a.z);
    fill(s->exponent, n, ks.w);
    fill(s->alpha, n, rho.w);
}

void pe_read_surface(const struct pe_draw *d, struct hl_pe_fragments *f,
                     bool full, struct pe_surface *s)
{
    if (full)
        read_full(d, f, s);
    else
        read_plain(d, PE_LANES(f->n), s);
}

/* n turned by the normal map; where there is no tangent, as it was: t and b
 * are zero then, and one times n is n. */
static void map_normal(const struct pe_draw *d,
                       const struct hl_pe_fragments *f,
                       float out[3][HL_PE_BATCH])
{
    float strength = pe_material(d)->params.z;
    const float (*v)[HL_PE_BATCH] = f->vary;
    planes map;
    sample(d, HL_TEX_NORMAL_MAP, f, map);
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        hl_vec3 n = hl_v3(out[0][i], out[1][i], out[2][i]);
        n = hl_scale3(n, pe_rsqrt(hl_dot3(n, n)));
        hl_vec3 t = hl_v3(v[HL_PE_TX][i], v[HL_PE_TY][i], v[HL_PE_TZ][i]);
        float t2 = hl_dot3(t, t);
        bool there = t2 > 0.0f;
        t = hl_scale3(t, there ? pe_rsqrt(t2) : 0.0f);
        hl_vec3 b = hl_v3(n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z,
                          n.x * t.y - n.y * t.x);
        float x = (map[0][i] * 2.0f - 1.0f) * strength;
        float y = (map[1][i] * 2.0f - 1.0f) * strength * v[HL_PE_TW][i];
        float z = map[2][i] * 2.0f - 1.0f;
        z = there ? z : 1.0f;
        out[0][i] = t.x * x + b.x * y + n.x * z;
        out[1][i] = t.y * x + b.y * y + n.y * z;
        out[2][i] = t.z * x + b.z * y + n.z * z;
    }
}

/* Interpolated normals can cancel to zero; then the viewer's direction
 * stands in, so that no NaN leaves the stage. */
static void unit_normals(const struct hl_pe_fragments *f, bool two_sided,
                         float out[3][HL_PE_BATCH])
{
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        float side = two_sided && f->back[i] ? -1.0f : 1.0f;
        hl_vec3 n = hl_v3(out[0][i] * side, out[1][i] * side,
                          out[2][i] * side);
        float len2 = hl_dot3(n, n);
        float s = pe_rsqrt(len2);
        out[0][i] = len2 > 0.0f ? n.x * s : 0.0f;
        out[1][i] = len2 > 0.0f ? n.y * s : 0.0f;
        out[2][i] = len2 > 0.0f ? n.z * s : 1.0f;
    }
}

void pe_read_normal(const struct pe_draw *d, const struct hl_pe_fragments *f,
                    bool full, float out[3][HL_PE_BATCH])
{
    memcpy(out, f->vary[HL_PE_NX], 3 * sizeof out[0]);
    if (full && textured(d, HL_TEXTURED_NORMAL))
        map_normal(d, f, out);
    unit_normals(f, pe_spec_uint(d, HL_SPEC_TWO_SIDED) != 0, out);
}

void pe_exponent_code(const struct pe_draw *d,
                      const struct hl_pe_fragments *f, bool full, float *out)
{
    uint32_t n = PE_LANES(f->n);
    planes t;
    fill(out, n, pe_object(d)->flat_ids.x);
    if (!full || !textured(d, HL_TEXTURED_METAL_ROUGH))
        return;
    float roughness = pe_material(d)->params.y;
    sample(d, HL_TEX_METAL_ROUGH, f, t);
    for (uint32_t i = 0; i < n; i++)
        out[i] = hl_exponent_encode(hl_roughness_exponent(roughness *
                                                          t[1][i]));
}
