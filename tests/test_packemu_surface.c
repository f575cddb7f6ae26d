/* SPDX-License-Identifier: Zlib */
/* packemu's kernels of a surface (shaders/surface.glsl, gbuffer.frag, id.frag)
 * against the GLSL written out a second time for one fragment, with the C
 * library. Where no pow, exp2 or log2 is called both make the same operations
 * in the same order, and the bits must be equal. */
#include <math.h>
#include <string.h>
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/kernel_kit.h"

/* Textures of one texel, whatever the filter: what is sampled is known. */
static const float mr_texel[4] = { 0.9f, 0.7f, 0.6f, 1.0f };
static const float base_texel[4] = { 0.5f, 0.25f, 0.75f, 0.5f };
static const float glow_texel[4] = { 0.5f, 1.0f, 0.25f, 1.0f };
/* z below the surface: a scale of z alone would not show. */
static const float map_texel[4] = { 0.7f, 0.4f, 0.3f, 1.0f };

static void one_texel(struct kk *k, uint32_t slot, const float *rgba)
{
    kk_texture(k, slot, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, 1, 1, rgba);
}

static void open_surfaces(struct kk *k)
{
    kk_open(k);
    k->material.base = hl_v4(0.9f, 0.8f, 0.7f, 0.9f);
    k->material.params = hl_v4(0.6f, 0.5f, 0.8f, 0.25f);
    k->material.emission = hl_v4(0.1f, 0.0f, 0.2f, 0.5f);
    k->material.albedo = hl_v4(0.5f, 0.6f, 0.7f, 0.8f);
    k->material.specular = hl_v4(0.3f, 0.4f, 0.2f, 25.0f);
    k->frame.ambient = hl_v4(0.05f, 0.1f, 0.2f, 1.0f);
    k->frame.depth = hl_v4(1, 0, 0.1f, 10);
    k->object.ids = hl_v4(300, 7, 0, 0);
    k->object.flat_ids = hl_v4(0.375f, 1, 0, 0);
    one_texel(k, HL_TEX_BASE, base_texel);
    one_texel(k, HL_TEX_METAL_ROUGH, mr_texel);
    one_texel(k, HL_TEX_EMISSION, glow_texel);
    one_texel(k, HL_TEX_NORMAL_MAP, map_texel);
}

static bool has(const struct kk *k, uint32_t bit)
{
    return (k->program.spec[HL_SPEC_TEXTURES].u & bit) != 0;
}

static float base_of(const struct kk *k, uint32_t i, int c)
{
    const hl_vec4 *b = &k->material.base;
    const float factor[4] = { b->x, b->y, b->z, b->w };
    float x = factor[c] * k->in.vary[HL_PE_R + c][i];
    return has(k, HL_TEXTURED_BASE) ? x * base_texel[c] : x;
}

static bool masked(const struct kk *k, uint32_t i)
{
    return k->program.spec[HL_SPEC_MASK].u &&
           base_of(k, i, 3) < k->material.params.w;
}

/* Forward without lights: e + rho A. Alpha, mask and emission alone show, and
 * through the ambient the albedo. */
static void check_base(const struct kk *k, uint32_t i)
{
    const struct hl_material_block *m = &k->material;
    float metallic = m->params.x;
    if (has(k, HL_TEXTURED_METAL_ROUGH))
        metallic *= mr_texel[2];
    const float e[3] = { m->emission.x, m->emission.y, m->emission.z };
    const float a[3] = { k->frame.ambient.x, k->frame.ambient.y,
                         k->frame.ambient.z };
    hl_vec3 rho = hl_material_albedo(
        hl_v3(base_of(k, i, 0), base_of(k, i, 1), base_of(k, i, 2)),
        metallic);
    const float albedo[3] = { rho.x, rho.y, rho.z };
    for (int c = 0; c < 3; c++) {
        float glow = has(k, HL_TEXTURED_EMISSION) ? e[c] * glow_texel[c]
                                                  : e[c];
        assert_true(k->in.color[0][c][i] == glow + albedo[c] * a[c]);
    }
    assert_true(k->in.color[0][3][i] == base_of(k, i, 3));
    assert_int_equal(k->in.discard[i], masked(k, i));
}

static void full_surface(void **state)
{
    static struct kk k;
    (void)state;
    open_surfaces(&k);
    k.program.spec[HL_SPEC_BATCH].u = 0;
    for (uint32_t i = 0; i < 16; i++) {
        k.program.spec[HL_SPEC_TEXTURES].u = i;
        k.program.spec[HL_SPEC_MASK].u = i & 1;
        kk_fragments(&k, 8 * i + 1, 640, 480);
        kk_shade(&k, HL_SHADER_FORWARD_FULL_FRAG);
        for (uint32_t j = 0; j < k.in.n; j++)
            check_base(&k, j);
    }
    kk_close(&k);
}

/* The specular colour, by a light that alone is specular: one parallel with
 * the normal, seen along it, so that D = c, N.H = 1 and S = ks c. Roundings
 * of unit vectors: N.H is 3 ulp off, its power (n = 8.1 at most here) 8 times
 * that, the sums 4 ulp more. */
static void specular_color(void **state)
{
    static struct kk k;
    (void)state;
    open_surfaces(&k);
    k.program.spec[HL_SPEC_KINDS].u = 1;
    k.program.spec[HL_SPEC_BATCH].u = 1;
    k.program.spec[HL_SPEC_SPECULAR].u = HL_SPECULAR_CHANNEL;
    k.program.spec[HL_SPEC_BASE].u = 0;
    k.lights[1] = hl_v4(1, 1, 1, 0);
    k.lights[2] = hl_v4(0, 0, -1, 0);
    k.lights[3] = hl_v4(1, 1, 0, 0);
    for (uint32_t t = 0; t < 4; t++) {
        k.program.spec[HL_SPEC_TEXTURES].u = t;
        kk_fragments(&k, HL_PE_BATCH, 640, 480);
        for (uint32_t i = 0; i < HL_PE_BATCH; i++) {
            k.in.vary[HL_PE_NX][i] = k.in.vary[HL_PE_NY][i] = 0;
            k.in.vary[HL_PE_NZ][i] = 1;
            k.in.vary[HL_PE_PX][i] = k.in.vary[HL_PE_PY][i] = 0;
        }
        kk_shade(&k, HL_SHADER_FORWARD_FULL_FRAG);
        float metallic = k.material.params.x, rough = k.material.params.y;
        if (has(&k, HL_TEXTURED_METAL_ROUGH)) {
            metallic *= mr_texel[2];
            rough *= mr_texel[1];
        }
        float n = hl_roughness_exponent(rough);
        for (uint32_t i = 0; i < HL_PE_BATCH; i++) {
            hl_vec3 b = hl_v3(base_of(&k, i, 0), base_of(&k, i, 1),
                              base_of(&k, i, 2));
            hl_vec3 rho = hl_material_albedo(b, metallic);
            hl_vec3 ks = hl_material_specular(b, metallic, n);
            float half = k.material.emission.w;
            ck_near(k.in.color[0][0][i], rho.x + ks.x * half, 2e-5);
            ck_near(k.in.color[0][2][i], rho.z + ks.z * half, 2e-5);
        }
    }
    kk_close(&k);
}

/* ---- geometry pass ------------------------------------------------------- */

static hl_vec3 cross(hl_vec3 a, hl_vec3 b)
{
    return hl_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                 a.x * b.y - a.y * b.x);
}

static hl_vec3 normal_of(const struct kk *k, uint32_t i, bool full)
{
    const float (*v)[HL_PE_BATCH] = (const float (*)[HL_PE_BATCH])k->in.vary;
    hl_vec3 n = hl_v3(v[HL_PE_NX][i], v[HL_PE_NY][i], v[HL_PE_NZ][i]);
    hl_vec3 t = hl_v3(v[HL_PE_TX][i], v[HL_PE_TY][i], v[HL_PE_TZ][i]);
    float t2 = hl_dot3(t, t);
    if (full && has(k, HL_TEXTURED_NORMAL)) {
        n = hl_scale3(n, 1 / sqrtf(hl_dot3(n, n)));
        if (t2 > 0) {
            t = hl_scale3(t, 1 / sqrtf(t2));
            float x = (map_texel[0] * 2 - 1) * k->material.params.z;
            float y = (map_texel[1] * 2 - 1) * k->material.params.z *
                      v[HL_PE_TW][i];
            hl_vec3 b = cross(n, t);
            n = hl_add3(hl_add3(hl_scale3(t, x), hl_scale3(b, y)),
                        hl_scale3(n, map_texel[2] * 2 - 1));
        }
    }
    if (k->program.spec[HL_SPEC_TWO_SIDED].u && k->in.back[i])
        n = hl_scale3(n, -1);
    float len2 = hl_dot3(n, n);
    return len2 > 0 ? hl_scale3(n, 1 / sqrtf(len2)) : hl_v3(0, 0, 1);
}

/* hl_exponent_encode's log2 is 3 ulp of at most 8 off, an eighth of which is
 * 2^-21 / 8 * 3. */
static void check_gbuffer(const struct kk *k, bool full)
{
    uint32_t mode = k->program.spec[HL_SPEC_TWO16].u;
    float steps = k->program.spec[HL_SPEC_ID_STEPS].f;
    for (uint32_t i = 0; i < k->in.n; i++) {
        hl_vec2 e = hl_normal_encode(normal_of(k, i, full));
        kk_texel(k, 0, i, hl_two16_encode(mode, hl_snorm_to_unorm(e.x),
                                             hl_snorm_to_unorm(e.y)));
        kk_texel(k, 1, i, hl_two16_encode(
            mode, hl_depth_encode(k->in.z[i], k->frame.depth.z),
            hl_id_encode(k->in.vary[HL_PE_ID][i], 1 / steps)));
        float code = k->object.flat_ids.x;
        if (full && has(k, HL_TEXTURED_METAL_ROUGH))
            code = hl_exponent_encode(hl_roughness_exponent(
                k->material.params.y * mr_texel[1]));
        ck_near(k->in.color[2][0][i], code, ldexp(3, -24));
        if (full)
            assert_int_equal(k->in.discard[i], masked(k, i));
    }
}

/* Every storage, side and map; normals and tangents of zero among them. */
static void geometry_pass(void **state)
{
    static struct kk k;
    (void)state;
    open_surfaces(&k);
    for (uint32_t i = 0; i < 40; i++) {
        bool full = i & 1;
        k.program.spec[HL_SPEC_TWO16].u = i / 2 % 5;
        k.program.spec[HL_SPEC_ID_STEPS].f = i & 2 ? 65534.0f : 65535.0f;
        k.program.spec[HL_SPEC_TWO_SIDED].u = i / 4 & 1;
        k.program.spec[HL_SPEC_TEXTURES].u = i / 3;
        k.program.spec[HL_SPEC_MASK].u = i / 8 & 1;
        kk_fragments(&k, 1 + 3 * i, 640, 480);
        for (int c = 0; c < 3 && i > 4; c++) {
            k.in.vary[HL_PE_NX + c][0] = 0;
            k.in.vary[HL_PE_TX + c][1] = 0;
        }
        kk_shade(&k, full ? HL_SHADER_GBUFFER_FULL_EXP_FRAG
                          : HL_SHADER_GBUFFER_PLAIN_EXP_FRAG);
        check_gbuffer(&k, full);
    }
    kk_close(&k);
}

/* ---- region ids ---------------------------------------------------------- */

/* Bits of an integer in a float's place; the mask cuts the same holes. */
static void region_ids(void **state)
{
    static struct kk k;
    (void)state;
    open_surfaces(&k);
    k.program.spec[HL_SPEC_MASK].u = 1;
    kk_fragments(&k, 100, 640, 480);
    for (uint32_t i = 0; i < 100; i++)
        k.in.vary[HL_PE_ID][i] = k.object.ids.x + (float)(i * 600);
    kk_shade(&k, HL_SHADER_ID_FULL_FRAG);
    for (uint32_t i = 0; i < 100; i++) {
        uint32_t id;
        memcpy(&id, &k.in.color[0][0][i], 4);
        assert_int_equal(id, 8u << 16 | i * 600);
        assert_int_equal(k.in.discard[i], masked(&k, i));
    }
    kk_close(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(full_surface),
        cmocka_unit_test(specular_color),
        cmocka_unit_test(geometry_pass),
        cmocka_unit_test(region_ids),
    };
    return cmocka_run_group_tests_name("packemu surface", tests, NULL, NULL);
}
