/* SPDX-License-Identifier: Zlib */
/* The tests' own stages once more, as an engine would write them for the
 * software device. The shared functions are compiled with that device's
 * arithmetic, so that what test_pack_gpu compares is it and the C library. */
#include "platforms/packemu/pe_kernel.h"
#include "tests/stage_kernels.h"

typedef void (*shade_fn)(const struct pe_draw *, struct hl_pe_fragments *);
#define STAGE(name, shade, slope)                                     \
    void (*name(void))(void)                                          \
    {                                                                 \
        static const struct hl_pe_stage s = { shade, slope, false, false }; \
        return (void (*)(void))(uintptr_t)&s;                         \
    }

static hl_vec4 texel(const struct pe_draw *d, uint32_t slot,
                     const struct hl_pe_fragments *f, uint32_t i)
{
    float v[4] = { 1, 1, 1, 1 };
    if (d->view[slot].texture)
        pe_fetch(&d->view[slot], 0, f->x[i], f->y[i], v);
    return hl_v4(v[0], v[1], v[2], v[3]);
}

static void put(struct hl_pe_fragments *f, uint32_t i, hl_vec4 v)
{
    f->color[0][0][i] = v.x;
    f->color[0][1][i] = v.y;
    f->color[0][2][i] = v.z;
    f->color[0][3][i] = v.w;
}

/* ---- vulkan.frag -------------------------------------------------------- */

/* Derivatives along x that give every fragment the level that is asked. */
static void sample_at_level(const struct pe_draw *d,
                            struct hl_pe_fragments *f)
{
    float duv[4][HL_PE_BATCH];
    const struct pe_texture *t = d->view[0].texture;
    float texels = (float)exp2((double)pe_spec_float(d, 1));
    for (uint32_t i = 0; i < HL_PE_BATCH; i++) {
        duv[0][i] = t ? texels / (float)t->desc.width : 0.0f;
        duv[1][i] = duv[2][i] = duv[3][i] = 0.0f;
    }
    pe_sample(&d->view[0], f->vary[HL_PE_U], f->vary[HL_PE_V],
              (const float (*)[HL_PE_BATCH])duv, f->n, f->color[0]);
}

/* gl_FragCoord.z is the view position's here: model_view is the identity and
 * so are clip and depth range. */
static hl_vec4 quantity(const struct pe_draw *d, uint32_t what,
                        const struct hl_pe_fragments *f, uint32_t i)
{
    const hl_vec4 *own = hl_pe_uniform(d, HL_SLOT_MATERIAL, sizeof *own);
    if (what == 0)
        return own ? *own : hl_v4(0, 0, 0, 0);
    if (what == 1)
        return hl_v4(f->vary[HL_PE_R][i], f->vary[HL_PE_G][i],
                     f->vary[HL_PE_B][i], f->vary[HL_PE_A][i]);
    if (what == 2)
        return hl_v4((float)f->x[i] + 0.5f, (float)f->y[i] + 0.5f,
                     f->vary[HL_PE_PZ][i], f->back[i] ? 0.0f : 1.0f);
    return texel(d, what == 3 ? 0 : 1, f, i);
}

static void vulkan_shade(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    uint32_t what = pe_spec_uint(d, 0);
    if (what == 4) {
        sample_at_level(d, f);
        return;
    }
    for (uint32_t i = 0; i < f->n; i++)
        put(f, i, quantity(d, what, f, i));
}

STAGE(vulkan_kernel, vulkan_shade, false)

/* ---- pack.frag ---------------------------------------------------------- */

static hl_vec4 pack_functions(uint32_t what, hl_vec4 a)
{
    hl_vec2 v;
    if (what == 0) {
        v = hl_normal_encode(hl_v3(a.x, a.y, a.z));
        return hl_v4(v.x, v.y, 0, 0);
    }
    if (what == 1) {
        hl_vec3 n = hl_normal_decode(hl_v2(a.x, a.y));
        return hl_v4(n.x, n.y, n.z, 0);
    }
    if (what == 2)
        return hl_v4(hl_snorm_to_unorm(a.x), hl_unorm_to_snorm(a.y),
                     hl_tangent_w_group(a.z), hl_tangent_w_sign(a.z));
    if (what == 3) {
        v = hl_split16(a.x);
        return hl_v4(v.x, v.y, hl_join16(v), 0);
    }
    if (what == 4)
        return hl_v4(hl_depth_encode(a.x, a.y), hl_id_encode(a.z, a.w), 0, 0);
    return hl_v4(hl_exponent_encode(a.x), hl_exponent_decode(a.y), 0, 0);
}

static hl_vec4 shade_functions(uint32_t what, hl_vec4 a)
{
    hl_vec3 c = hl_v3(a.x, a.y, a.z);
    if (what == 6)
        return hl_v4(hl_falloff_smooth(a.x, a.y),
                     hl_falloff_inverse_square(a.x, a.y),
                     hl_spot(a.z, a.w, 0.25f), hl_clamp01(a.z));
    if (what == 7)
        return hl_v4(hl_specular(a.x, a.y), hl_luminance(c),
                     hl_specular_scale(c, a.w), 0);
    c = what == 8 ? hl_material_specular(c, a.w, 20.0f)
                  : hl_material_albedo(c, a.w);
    return hl_v4(c.x, c.y, c.z,
                 what == 8 ? hl_roughness_exponent(a.w) : 0.0f);
}

static hl_vec4 filter_functions(uint32_t what, hl_vec4 a)
{
    hl_vec4 b = hl_bilinear(hl_v2(a.x, a.y));
    if (what == 10)
        return b;
    if (what == 11) {
        uint32_t m = (uint32_t)a.z;
        return hl_dsf_weights(b, hl_v4((float)(m & 1), (float)(m >> 1 & 1),
                                       (float)(m >> 2 & 1),
                                       (float)(m >> 3 & 1)));
    }
    return hl_v4(hl_dsf_threshold(0.01f, 1.5f, 0.001f, a.x, a.y, a.z),
                 hl_dsf_accept(a.x, a.w, a.y, a.w, a.z, 0.5f), 0, 0);
}

static hl_vec4 read_id(const struct pe_draw *d,
                       const struct hl_pe_fragments *f, uint32_t i, hl_vec4 a)
{
    float id = (float)(pe_bits(texel(d, 1, f, i).x) >> 16);
    return hl_v4(hl_dsf_accept(0, id, 0, a.z, 1, 0.5f),
                 hl_dsf_accept(0, id, 0, a.z + 1, 1, 0.5f),
                 hl_dsf_accept(0, id, 0, a.z - 1, 1, 0.5f), id);
}

static hl_vec4 console_functions(const struct pe_draw *d, uint32_t what,
                                 const struct hl_pe_fragments *f, uint32_t i,
                                 hl_vec4 a)
{
    hl_vec2 v;
    if (what == 22)
        return hl_two16_encode((uint32_t)a.w, a.x,
                               hl_id_encode(a.y, 1.0f / a.z));
    if (what == 23) {
        v = hl_two16_decode((uint32_t)a.w, hl_v2(a.x, a.y));
        return hl_v4(v.x, v.y, hl_depth_barg(hl_v3(a.x, a.y, a.z)), 0);
    }
    hl_vec4 s = texel(d, 2, f, i);
    v = hl_two16_decode((uint32_t)a.w, hl_v2(s.x, s.y));
    return hl_v4(v.x, v.y, hl_floor(v.y * a.z + 0.5f),
                 hl_abs(v.y * a.z - a.y));
}

static void pack_shade(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    uint32_t what = pe_spec_uint(d, 0);
    for (uint32_t i = 0; i < f->n; i++) {
        hl_vec4 a = texel(d, 0, f, i);
        if (what == 20)
            put(f, i, read_id(d, f, i, a));
        else if (what == 21)
            put(f, i, hl_v4(hl_snorm_to_unorm(a.x), hl_snorm_to_unorm(a.y),
                            0, 1));
        else if (what >= 22)
            put(f, i, console_functions(d, what, f, i, a));
        else
            put(f, i, what < 6 ? pack_functions(what, a)
                      : what < 10 ? shade_functions(what, a)
                      : filter_functions(what, a));
    }
}

STAGE(pack_kernel, pack_shade, false)

/* ---- own_taps.frag ------------------------------------------------------ */

static void own_taps_shade(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    const hl_vec4 *tint = hl_pe_uniform(d, HL_SLOT_MATERIAL, sizeof *tint);
    const hl_vec4 ambient = pe_frame(d)->ambient;
    float light[6][HL_PE_BATCH];
    hl_pe_read_lights(d, f, light);
    for (uint32_t i = 0; i < f->n && tint; i++)
        put(f, i, hl_v4(tint->x * (ambient.x + light[0][i]),
                        tint->y * (ambient.y + light[1][i]),
                        tint->z * (ambient.z + light[2][i]), 1));
}

STAGE(own_taps_kernel, own_taps_shade, true)
