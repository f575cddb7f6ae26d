/* SPDX-License-Identifier: Zlib */
/* packemu's kernels that light: each against the stage's GLSL (shaders/
 * lights.glsl, light.frag, forward.frag), written out a second time for one
 * point, with the C library. Both make
 * the same operations in the same order on the same inputs, but for
 *   - pow and exp2: 2^-23 of 1 (test_packemu_math), and what an exponent
 *     that is 2 ulp off makes of (N.H)^n: n x^n ln x is at most 1 / e, so
 *     2^-23 / e;
 *   - guards against 0 / 0: + 1e-20 for max(.., 1e-20), no bit of numbers
 *     above 1e-13.
 * So a light is 2^-22 of its colour times attenuation off, and 3e-7 of the
 * sum of those is allowed where all lights are summed. */
#include <math.h>
#include <string.h>
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/kernel_kit.h"

#define ALLOWED 3e-7

/* ---- one light, one point ------------------------------------------------ */

struct point { hl_vec3 p, n; float exponent; };
struct sum { float diffuse[3], specular[3], intensity, most; };

static hl_vec3 sub(hl_vec3 a, hl_vec3 b)
{
    return hl_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}

static void add_light(const struct kk *k, const hl_vec4 *light,
                      const struct point *at, struct sum *s)
{
    const union pe_spec *spec = k->program.spec;
    hl_vec4 a = light[0], b = light[1];
    float color[3] = { b.x, b.y, b.z };
    hl_vec3 to = sub(hl_v3(a.x, a.y, a.z), at->p);
    float d2 = hl_dot3(to, to);
    hl_vec3 l = hl_scale3(to, 1.0f / sqrtf(fmaxf(d2, 1e-20f)));
    hl_vec3 v = hl_scale3(at->p, -1.0f / sqrtf(hl_dot3(at->p, at->p)));
    bool inverse = spec[HL_SPEC_FALLOFF].u == 2 ||
                   (spec[HL_SPEC_FALLOFF].u == 3 && b.w > 0.5f);
    float att = inverse ? hl_falloff_inverse_square(d2, a.w)
                        : hl_falloff_smooth(d2, a.w);
    if (spec[HL_SPEC_KINDS].u) {
        hl_vec4 c = light[2], d = light[3];
        hl_vec3 axis = hl_v3(c.x, c.y, c.z);
        if (d.y > 0.5f)
            l = hl_scale3(axis, -1.0f);
        att = d.y > 0.5f ? 1.0f
                         : att * hl_spot(-hl_dot3(l, axis), c.w, d.x);
    }
    float ndl = fmaxf(hl_dot3(at->n, l), 0) * att;
    hl_vec3 h = hl_add3(l, v);
    float nh = fmaxf(hl_dot3(at->n, h), 0);
    float lobe = spec[HL_SPEC_SPECULAR].u == HL_SPECULAR_NONE ? 0 :
        ndl * hl_specular(nh * nh / fmaxf(hl_dot3(h, h), 1e-20f),
                          at->exponent * 0.5f);
    for (int c = 0; c < 3; c++) {
        s->diffuse[c] += color[c] * ndl;
        s->specular[c] += color[c] * lobe;
    }
    s->intensity += hl_luminance(hl_v3(b.x, b.y, b.z)) * lobe;
    s->most += att;
}

static struct sum add_lights(const struct kk *k, const hl_vec4 *light,
                             uint32_t n, const struct point *at)
{
    struct sum s;
    memset(&s, 0, sizeof s);
    uint32_t stride = k->program.spec[HL_SPEC_KINDS].u ? HL_LIGHT_VEC4S
                                                       : HL_POINT_VEC4S;
    for (uint32_t i = 0; i < n; i++)
        add_light(k, light + i * stride, at, &s);
    return s;
}

/* ---- light pass ---------------------------------------------------------- */

enum { GW = 150, GH = 70, TILE = 16, TILES_X = (GW + TILE - 1) / TILE,
       TILES_Y = (GH + TILE - 1) / TILE, LIST = 40 };

struct gbuffer {
    float depth[GH][GW];
    uint16_t normal[GH][GW][2], code[GH][GW];
    uint8_t barg[GH][GW][4];
    hl_vec4 list[LIST * HL_LIGHT_VEC4S];
    uint32_t tile[TILES_X * TILES_Y][2];
};

static void fill_gbuffer(struct kk *k, struct gbuffer *g)
{
    for (int y = 0; y < GH; y++)
        for (int x = 0; x < GW; x++) {
            hl_vec3 n = kk_direction(k);
            n.z = fabsf(n.z);
            hl_vec2 e = hl_normal_encode(n);
            g->normal[y][x][0] = (uint16_t)((e.x * 0.5f + 0.5f) * 65535);
            g->normal[y][x][1] = (uint16_t)((e.y * 0.5f + 0.5f) * 65535);
            g->depth[y][x] = kk_between(k, 0.3f, 0.9f);
            g->code[y][x] = (uint16_t)mk_below(&k->seed, 65536);
            uint32_t code = (uint32_t)(g->depth[y][x] * 16777215.0f);
            for (int c = 0; c < 3; c++)
                g->barg[y][x][c] = (uint8_t)(code >> (16 - 8 * c));
        }
    k->frame.ray_light = hl_v4(0.013f, -0.015f, -1.0f, 0.5f);
    k->frame.depth = hl_v4(2.0f, 0.1f, 0.01f, 100.0f);
    k->frame.misc = hl_v4(20.0f, TILE, TILES_X, 0);
    k->program.spec[HL_SPEC_LIGHT_OUT].f = 0.5f;
    kk_texture(k, HL_TEX_DEPTH, HL_FORMAT_R32_FLOAT, HL_FORMAT_NONE, GW, GH,
               g->depth);
    kk_texture(k, HL_TEX_NORMAL, HL_FORMAT_RG16_UNORM, HL_FORMAT_NONE, GW, GH,
               g->normal);
    kk_texture(k, HL_TEX_EXPONENT, HL_FORMAT_R16_UNORM, HL_FORMAT_NONE, GW,
               GH, g->code);
}

static void fill_lists(struct kk *k, struct gbuffer *g, uint32_t kinds)
{
    uint32_t stride = kinds ? HL_LIGHT_VEC4S : HL_POINT_VEC4S;
    kk_lights(k, g->list, LIST, kinds);
    for (int t = 0; t < TILES_X * TILES_Y; t++) {
        uint32_t first = mk_below(&k->seed, LIST);
        g->tile[t][0] = first * stride;
        g->tile[t][1] = mk_below(&k->seed, LIST - first + 1);
    }
    k->draw.storage[HL_SLOT_LIST] = g->list;
    k->draw.storage_bytes[HL_SLOT_LIST] = LIST * stride * 16;
    k->draw.storage[HL_SLOT_TILES] = g->tile;
    k->draw.storage_bytes[HL_SLOT_TILES] = sizeof g->tile;
}

static struct point point_of(const struct kk *k, const struct gbuffer *g,
                             int x, int y)
{
    const union pe_spec *spec = k->program.spec;
    hl_vec4 r = k->frame.ray_light;
    float d = g->depth[y][x];
    if (spec[HL_SPEC_DEPTH_READ].u == HL_DEPTH_READ_BARG)
        d = (float)(g->barg[y][x][0] * 65536 + g->barg[y][x][1] * 256 +
                    g->barg[y][x][2]) / 16777215.0f;
    float z = k->frame.depth.x / (d + k->frame.depth.y);
    hl_vec2 e = hl_v2((float)g->normal[y][x][0] / 65535.0f,
                      (float)g->normal[y][x][1] / 65535.0f);
    e = hl_two16_decode(spec[HL_SPEC_TWO16].u, e);
    struct point p = {
        hl_v3((((float)x + 0.5f) * r.x + r.z) * z,
              (((float)y + 0.5f) * r.y + r.w) * z, -z),
        hl_normal_decode(hl_v2(hl_unorm_to_snorm(e.x),
                               hl_unorm_to_snorm(e.y))),
        k->frame.misc.x };
    if (spec[HL_SPEC_SPECULAR].u == HL_SPECULAR_CHANNEL)
        p.exponent = hl_exponent_decode((float)g->code[y][x] / 65535.0f);
    return p;
}

static void same_light(const struct kk *k, const struct sum *s,
                       const float got[4])
{
    float out = k->program.spec[HL_SPEC_LIGHT_OUT].f;
    for (int c = 0; c < 4; c++) {
        float want = (c < 3 ? s->diffuse[c] : s->intensity) * out;
        ck_near(got[c], fminf(want, HL_HALF_MAX), ALLOWED * s->most);
    }
}

static float light_out[4][PE_BIN * PE_BIN];

/* All pixels of a rectangle that begins inside a tile and ends in another. */
static void check_rect(struct kk *k, const struct gbuffer *g, bool tiles)
{
    const struct hl_rect rects[] = { { 64, 0, 64, 64 }, { 128, 64, 22, 6 },
                                     { 3, 5, 37, 19 }, { 149, 69, 1, 1 } };
    enum hl_shader s = tiles ? HL_SHADER_LIGHT_TILES_FRAG
                             : HL_SHADER_LIGHT_BATCH_FRAG;
    uint32_t batch = k->program.spec[HL_SPEC_BATCH].u;
    for (size_t i = 0; i < sizeof rects / sizeof *rects; i++) {
        struct hl_rect r = rects[i];
        pe_fragment_kernels[s].rect(&k->draw, &r, light_out);
        for (int y = r.y; y < r.y + r.height; y++)
            for (int x = r.x; x < r.x + r.width; x++) {
                const uint32_t *t = g->tile[y / TILE * TILES_X + x / TILE];
                struct point p = point_of(k, g, x, y);
                struct sum want = add_lights(k, tiles ? g->list + t[0]
                                                      : k->lights,
                                             tiles ? t[1] : batch, &p);
                int at = (y - r.y) * PE_BIN + x - r.x;
                float got[4] = { light_out[0][at], light_out[1][at],
                                 light_out[2][at], light_out[3][at] };
                same_light(k, &want, got);
            }
    }
}

/* Fragments anywhere give the rectangle's bits. */
static void check_fragments(struct kk *k, bool tiles)
{
    const struct hl_rect r = { 0, 0, 64, 64 };
    enum hl_shader s = tiles ? HL_SHADER_LIGHT_TILES_FRAG
                             : HL_SHADER_LIGHT_BATCH_FRAG;
    pe_fragment_kernels[s].rect(&k->draw, &r, light_out);
    kk_fragments(k, 77, 64, 64);
    kk_shade(k, s);
    for (uint32_t i = 0; i < k->in.n; i++)
        for (int c = 0; c < 4; c++) {
            int at = k->in.y[i] * PE_BIN + k->in.x[i];
            assert_memory_equal(&k->in.color[0][c][i], &light_out[c][at], 4);
        }
}

/* Every falloff, kind and exponent, by batches and by tiles. */
static void light_pass(void **state)
{
    static struct kk k;
    static struct gbuffer g;
    (void)state;
    kk_open(&k);
    fill_gbuffer(&k, &g);
    union pe_spec *spec = k.program.spec;
    for (uint32_t i = 0; i < 3 * 3 * 2; i++) {
        spec[HL_SPEC_FALLOFF].u = 1 + i % 3;
        spec[HL_SPEC_SPECULAR].u = i / 3 % 3;
        spec[HL_SPEC_KINDS].u = i / 9;
        spec[HL_SPEC_BATCH].u = 1 + i % HL_BATCH_MAX;
        kk_lights(&k, k.lights, HL_BATCH_MAX, i / 9);
        fill_lists(&k, &g, i / 9);
        check_rect(&k, &g, false);
        check_rect(&k, &g, true);
        check_fragments(&k, false);
        check_fragments(&k, true);
    }
    kk_close(&k);
}

/* Normals of other machines; depth as bytes. */
static void light_pass_encodings(void **state)
{
    static struct kk k;
    static struct gbuffer g;
    (void)state;
    kk_open(&k);
    fill_gbuffer(&k, &g);
    kk_lights(&k, k.lights, HL_BATCH_MAX, 0);
    k.program.spec[HL_SPEC_SPECULAR].u = HL_SPECULAR_CONSTANT;
    for (uint32_t mode = 0; mode <= HL_TWO16_BYTES_ARGB; mode++) {
        k.program.spec[HL_SPEC_TWO16].u = mode;
        check_rect(&k, &g, false);
    }
    k.program.spec[HL_SPEC_DEPTH_READ].u = HL_DEPTH_READ_BARG;
    kk_texture(&k, HL_TEX_DEPTH, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_NONE, GW,
               GH, g.barg);
    check_rect(&k, &g, false);
    check_fragments(&k, false);
    kk_close(&k);
}

/* Lists that run past their buffer are cut; without buffers there is no
 * light; what is bright stays finite; a light in the surface, a black one
 * and a point at infinity add nothing. */
static void light_pass_edges(void **state)
{
    static struct kk k;
    static struct gbuffer g;
    const struct hl_rect r = { 0, 0, 1, 1 };
    pe_rect_fn batch = pe_fragment_kernels[HL_SHADER_LIGHT_BATCH_FRAG].rect;
    pe_rect_fn tiles = pe_fragment_kernels[HL_SHADER_LIGHT_TILES_FRAG].rect;
    (void)state;
    kk_open(&k);
    fill_gbuffer(&k, &g);
    fill_lists(&k, &g, 0);
    k.program.spec[HL_SPEC_SPECULAR].u = HL_SPECULAR_CONSTANT;
    g.tile[0][0] = (LIST - 1) * HL_POINT_VEC4S;
    g.tile[0][1] = 1;
    tiles(&k.draw, &r, light_out);
    float one = light_out[0][0];
    g.tile[0][1] = 0xffffffffu;
    tiles(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == one);
    g.tile[0][0] = 0xffffffffu;
    tiles(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0 && light_out[3][0] == 0);
    k.draw.storage[HL_SLOT_TILES] = NULL;
    tiles(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0);

    struct point p = point_of(&k, &g, 0, 0);
    k.program.spec[HL_SPEC_BATCH].u = 1;
    k.lights[0] = hl_v4(p.p.x, p.p.y, p.p.z, 1);
    k.lights[1] = hl_v4(1, 1, 1, 0);
    batch(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0 && light_out[3][0] == 0);
    k.lights[0] = hl_v4(p.p.x + p.n.x * 0.01f, p.p.y + p.n.y * 0.01f,
                        p.p.z + p.n.z * 0.01f, 1e-30f);
    k.lights[1] = hl_v4(1e30f, 1e30f, 1e30f, 0);
    batch(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == HL_HALF_MAX);
    k.lights[1] = hl_v4(0, 0, 0, 0);
    batch(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0);
    k.lights[1] = hl_v4(1, 1, 1, 0);
    k.frame.depth = hl_v4(1, -g.depth[0][0], 0, 0);
    batch(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0 && light_out[3][0] == 0);
    k.draw.uniform[HL_SLOT_LIGHTS] = NULL;
    batch(&k.draw, &r, light_out);
    assert_true(light_out[0][0] == 0);
    kk_close(&k);
}

/* ---- forward ------------------------------------------------------------- */

static void check_forward(struct kk *k, const hl_vec4 *light, uint32_t n)
{
    const struct hl_material_block *m = &k->material;
    const struct hl_pe_fragments *f = &k->in;
    float base = k->program.spec[HL_SPEC_BASE].u ? 1.0f : 0.0f;
    const float rho[3] = { m->albedo.x, m->albedo.y, m->albedo.z };
    const float ks[3] = { m->specular.x, m->specular.y, m->specular.z };
    const float e[3] = { m->emission.x, m->emission.y, m->emission.z };
    const float a[3] = { k->frame.ambient.x, k->frame.ambient.y,
                         k->frame.ambient.z };
    for (uint32_t i = 0; i < f->n; i++) {
        hl_vec3 nv = hl_v3(f->vary[HL_PE_NX][i], f->vary[HL_PE_NY][i],
                           f->vary[HL_PE_NZ][i]);
        float n2 = hl_dot3(nv, nv);
        struct point p = { hl_v3(f->vary[HL_PE_PX][i], f->vary[HL_PE_PY][i],
                                 f->vary[HL_PE_PZ][i]),
                           n2 > 0 ? hl_scale3(nv, 1.0f / sqrtf(n2))
                                  : hl_v3(0, 0, 1),
                           m->specular.w };
        struct sum s = add_lights(k, light, n, &p);
        for (int c = 0; c < 3; c++)
            ck_near(f->color[0][c][i],
                    (e[c] + rho[c] * a[c]) * base + rho[c] * s.diffuse[c] +
                    ks[c] * s.specular[c],
                    ALLOWED * (1 + s.most * (rho[c] + ks[c])));
        assert_true(f->color[0][3][i] == m->albedo.w);
    }
}

static void forward(void **state)
{
    static struct kk k;
    static struct gbuffer g;
    (void)state;
    kk_open(&k);
    k.material.albedo = hl_v4(0.5f, 0.6f, 0.7f, 0.8f);
    k.material.specular = hl_v4(0.3f, 0.4f, 0.2f, 25.0f);
    k.material.emission = hl_v4(0.1f, 0.0f, 0.2f, 1.0f);
    k.frame.ambient = hl_v4(0.05f, 0.1f, 0.2f, 1.0f);
    for (uint32_t i = 0; i < 12; i++) {
        union pe_spec *spec = k.program.spec;
        spec[HL_SPEC_FALLOFF].u = 1 + i % 3;
        spec[HL_SPEC_SPECULAR].u = i & 1;
        spec[HL_SPEC_KINDS].u = i >> 1 & 1;
        spec[HL_SPEC_BASE].u = i >> 2 & 1;
        kk_lights(&k, k.lights, HL_BATCH_MAX, spec[HL_SPEC_KINDS].u);
        kk_fragments(&k, 1 + 11 * i, 640, 480);
        /* Interpolated to nothing: faces the viewer. */
        for (int c = 0; c < 3; c++)
            k.in.vary[HL_PE_NX + c][0] = 0;
        kk_shade(&k, HL_SHADER_FORWARD_PLAIN_FRAG);
        check_forward(&k, k.lights, spec[HL_SPEC_BATCH].u);
        fill_lists(&k, &g, spec[HL_SPEC_KINDS].u);
        k.object.ids = hl_v4(0, 0, 8, 3);
        kk_shade(&k, HL_SHADER_FORWARD_LIST_PLAIN_FRAG);
        check_forward(&k, g.list + 8, 3);
    }
    kk_close(&k);
}

/* ---- bits ---------------------------------------------------------------- */

/* Sums of what both passes gave when they were written: no compiler, vector
 * width or byte order may change them. Inputs from a seed of its own, made
 * without the C library. */
static void same_bits_everywhere(void **state)
{
    static struct kk k;
    static struct gbuffer g;
    const struct hl_rect r = { 32, 6, 64, 64 };
    uint64_t hash = 0xCBF29CE484222325u;
    (void)state;
    kk_open(&k);
    k.seed = 1;
    fill_gbuffer(&k, &g);
    k.material.albedo = hl_v4(0.5f, 0.6f, 0.7f, 0.8f);
    k.material.specular = hl_v4(0.3f, 0.4f, 0.2f, 25.0f);
    for (uint32_t i = 0; i < 6; i++) {
        k.program.spec[HL_SPEC_FALLOFF].u = 1 + i % 3;
        k.program.spec[HL_SPEC_KINDS].u = i / 3;
        k.program.spec[HL_SPEC_SPECULAR].u = HL_SPECULAR_CHANNEL;
        fill_lists(&k, &g, i / 3);
        pe_fragment_kernels[HL_SHADER_LIGHT_TILES_FRAG].rect(&k.draw, &r,
                                                             light_out);
        for (int c = 0; c < 4; c++)
            hash = mk_hash(hash, light_out[c], PE_BIN * PE_BIN);
        kk_fragments(&k, HL_PE_BATCH, 640, 480);
        k.object.ids = hl_v4(0, 0, 0, LIST);
        kk_shade(&k, HL_SHADER_FORWARD_LIST_PLAIN_FRAG);
        for (int c = 0; c < 3; c++)
            hash = mk_hash(hash, k.in.color[0][c], HL_PE_BATCH);
    }
    kk_close(&k);
    if (hash != UINT64_C(0xc043c45b9f2d2a2f))
        fail_msg("0x%016llx", (unsigned long long)hash);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(light_pass),
        cmocka_unit_test(light_pass_encodings),
        cmocka_unit_test(light_pass_edges),
        cmocka_unit_test(forward),
        cmocka_unit_test(same_bits_everywhere),
    };
    return cmocka_run_group_tests_name("packemu lighting", tests, NULL, NULL);
}
