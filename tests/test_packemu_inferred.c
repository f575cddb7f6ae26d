/* SPDX-License-Identifier: Zlib */
/* packemu's kernels of the material pass against shaders/inferred.glsl,
 * material.frag and reject.frag, written out a second time for one fragment:
 * every storage of the L-buffer, every filter, as words and as numbers. */
#include <math.h>
#include <string.h>
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/kernel_kit.h"

/* Ids far from 0, where a wrong number of steps would show. */
enum { LW = 13, LH = 9, FW = 21, FH = 16, ID = 60000 };

struct lbuffer {
    uint16_t dsf[LH][LW][2];
    uint16_t half[LH][LW][4];
    float full[LH][LW][4];
    uint8_t byte[LH][LW][4];
    uint32_t ten[LH][LW];
};

enum { BITS = HL_BITS_UNORM10 + 1 };

/* Few ids and depths, so that every number of taps is accepted somewhere. */
static void fill_lbuffer(struct kk *k, struct lbuffer *l)
{
    for (int y = 0; y < LH; y++)
        for (int x = 0; x < LW; x++) {
            l->dsf[y][x][0] = (uint16_t)(2000 + mk_below(&k->seed, 4) * 60);
            l->dsf[y][x][1] = (uint16_t)(ID + mk_below(&k->seed, 3));
            l->ten[y][x] = mk_below(&k->seed, 65536) << 16 |
                           mk_below(&k->seed, 65536);
            for (int c = 0; c < 4; c++) {
                /* Some are infinite. */
                l->half[y][x][c] = mk_below(&k->seed, 8)
                    ? (uint16_t)mk_below(&k->seed, 0x7c00) : 0x7c00;
                l->full[y][x][c] = kk_between(k, 0, 40);
                l->byte[y][x][c] = (uint8_t)mk_below(&k->seed, 256);
            }
        }
    k->frame.depth = hl_v4(1, 0, 0.01f, 100.0f);
    k->program.spec[HL_SPEC_RATIO_X].f = (float)LW / FW;
    k->program.spec[HL_SPEC_RATIO_Y].f = (float)LH / FH;
    k->program.spec[HL_SPEC_LIGHT_SCALE].f = 2.0f;
    k->program.spec[HL_SPEC_DSF_TAU].f = 0.02f;
    k->material.albedo = hl_v4(0.5f, 0.6f, 0.7f, 0.8f);
    k->material.specular = hl_v4(0.3f, 0.4f, 0.2f, 25.0f);
    k->material.emission = hl_v4(0.1f, 0.0f, 0.2f, 1.0f);
    k->frame.ambient = hl_v4(0.05f, 0.1f, 0.2f, 1.0f);
}

static float light_of(const struct lbuffer *l, uint32_t bits, int y, int x,
                      int c)
{
    switch (bits) {
    case HL_BITS_HALF:
        return fminf(ck_half(l->half[y][x][c]), HL_HALF_MAX);
    case HL_BITS_UNORM16: return (float)l->half[y][x][c] / 65535.0f;
    case HL_BITS_FLOAT: return l->full[y][x][c];
    case HL_BITS_UNORM10:
        return (float)(l->ten[y][x] >> 10 * c & (c < 3 ? 1023u : 3u)) /
               (c < 3 ? 1023.0f : 3.0f);
    default: return (float)l->byte[y][x][c] / 255.0f;
    }
}

static void bind_light(struct kk *k, const struct lbuffer *l, uint32_t bits,
                       bool taps)
{
    static const enum hl_format formats[] = {
        HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_RGBA16_UNORM,
        HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_RGBA8_UNORM,
        HL_FORMAT_RGB10A2_UNORM };
    static const enum hl_format words[] = {
        HL_FORMAT_RG32_UINT, HL_FORMAT_RG32_UINT, HL_FORMAT_RGBA32_UINT,
        HL_FORMAT_R32_UINT, HL_FORMAT_R32_UINT };
    const void *data = bits == HL_BITS_FLOAT ? (const void *)l->full
                       : bits == HL_BITS_UNORM8 ? (const void *)l->byte
                       : bits == HL_BITS_UNORM10 ? (const void *)l->ten
                       : (const void *)l->half;
    k->program.spec[HL_SPEC_LIGHT_BITS].u = bits;
    kk_texture(k, HL_TEX_LIGHT, formats[bits],
               taps ? HL_FORMAT_NONE : words[bits], LW, LH, data);
    kk_texture(k, HL_TEX_DSF, HL_FORMAT_RG16_UNORM,
               taps ? HL_FORMAT_NONE : HL_FORMAT_R32_UINT, LW, LH, l->dsf);
}

struct filter { int x[4], y[4]; float accept[4], weight[4]; };

static int clamped(int i, int n) { return i < 0 ? 0 : i < n ? i : n - 1; }

/* inferred.glsl for fragment i. */
static struct filter filter_of(const struct kk *k, const struct lbuffer *l,
                               uint32_t i)
{
    const union pe_spec *spec = k->program.spec;
    const struct hl_pe_fragments *f = &k->in;
    float rx = spec[HL_SPEC_RATIO_X].f, ry = spec[HL_SPEC_RATIO_Y].f;
    float px = ((float)f->x[i] + 0.5f) * rx - 0.5f;
    float py = ((float)f->y[i] + 0.5f) * ry - 0.5f;
    float step = k->frame.depth.w / 65535.0f, z = f->z[i];
    float threshold = spec[HL_SPEC_DSF_TAU].f * z;
    if (spec[HL_SPEC_DSF].u == HL_DSF_SLOPE)
        threshold = hl_dsf_threshold(step, spec[HL_SPEC_DSF_K].f,
                                     spec[HL_SPEC_DSF_C].f, z,
                                     fabsf(f->dzdx[i]) * (1.0f / rx) +
                                     fabsf(f->dzdy[i]) * (1.0f / ry), 1.0f);
    struct filter t;
    for (int j = 0; j < 4; j++) {
        t.x[j] = clamped((int)floorf(px) + (j & 1), LW);
        t.y[j] = clamped((int)floorf(py) + (j >> 1), LH);
        const uint16_t *w = l->dsf[t.y[j]][t.x[j]];
        t.accept[j] = hl_dsf_accept((float)w[0] * step, (float)w[1], z,
                                    f->vary[HL_PE_ID][i], threshold, 0.5f);
    }
    hl_vec4 b = hl_bilinear(hl_v2(px - floorf(px), py - floorf(py)));
    if (spec[HL_SPEC_DSF].u != HL_DSF_OFF)
        b = hl_dsf_weights(b, hl_v4(t.accept[0], t.accept[1], t.accept[2],
                                    t.accept[3]));
    t.weight[0] = b.x;
    t.weight[1] = b.y;
    t.weight[2] = b.z;
    t.weight[3] = b.w;
    return t;
}

/* A depth near those stored and an id that exists. */
static void inferred_fragments(struct kk *k, uint32_t n)
{
    kk_fragments(k, n, FW, FH);
    for (uint32_t i = 0; i < n; i++) {
        k->in.z[i] = (2000 + (float)mk_below(&k->seed, 200)) * 100 / 65535;
        k->in.vary[HL_PE_ID][i] = (float)(ID + mk_below(&k->seed, 3));
    }
}

/* The same operations again, but for the sum of four products, which float
 * taps make in another format's order: 4 roundings of 2^-24, and as many of
 * D / lum(D) and of the sums, all relative to the largest tap. */
static void check_material(struct kk *k, const struct lbuffer *l,
                           uint32_t bits)
{
    const struct hl_pe_fragments *f = &k->in;
    const struct hl_material_block *m = &k->material;
    bool exact = k->program.spec[HL_SPEC_DSF].u == HL_DSF_EXACT;
    const float rho[3] = { m->albedo.x, m->albedo.y, m->albedo.z };
    const float ks[3] = { m->specular.x, m->specular.y, m->specular.z };
    for (uint32_t i = 0; i < f->n; i++) {
        struct filter t = filter_of(k, l, i);
        float s[4] = { 0, 0, 0, 0 }, out[6], most = 1;
        for (int c = 0; c < 4; c++) {
            for (int j = 0; j < 4 && !exact; j++)
                s[c] += light_of(l, bits, t.y[j], t.x[j], c) * t.weight[j];
            if (exact)
                s[c] = light_of(l, bits, clamped(f->y[i], LH),
                                clamped(f->x[i], LW), c);
            s[c] *= k->program.spec[HL_SPEC_LIGHT_SCALE].f;
            most = fmaxf(most, s[c]);
        }
        float k_s = hl_specular_scale(hl_v3(s[0], s[1], s[2]), s[3]);
        const float base[3] = { m->emission.x + rho[0] * k->frame.ambient.x,
                                m->emission.y + rho[1] * k->frame.ambient.y,
                                m->emission.z + rho[2] * k->frame.ambient.z };
        for (int c = 0; c < 3; c++) {
            out[c] = base[c] + rho[c] * s[c] + ks[c] * (s[c] * k_s);
            ck_near(f->color[0][c][i], fminf(out[c], HL_HALF_MAX),
                    2e-6 * (most + s[c] * k_s));
        }
        assert_true(f->color[0][3][i] == m->albedo.w);
    }
}

/* Every storage and filter, as words and as numbers. */
static void material_pass(void **state)
{
    static struct kk k;
    static struct lbuffer l;
    (void)state;
    kk_open(&k);
    fill_lbuffer(&k, &l);
    for (uint32_t i = 0; i < BITS * 4 * 2; i++) {
        bool taps = i >= BITS * 4;
        bind_light(&k, &l, i % BITS, taps);
        k.program.spec[HL_SPEC_DSF].u = i / BITS % 4;
        for (uint32_t n = 1; n <= HL_PE_BATCH; n = n * 3 + 1) {
            inferred_fragments(&k, n);
            kk_shade(&k, taps ? HL_SHADER_MATERIAL_PLAIN_TAPS_FRAG
                              : HL_SHADER_MATERIAL_PLAIN_FRAG);
            check_material(&k, &l, i % BITS);
        }
    }
    kk_close(&k);
}

/* Exactly as many rejected as the text says; all five numbers occur, and so
 * do taps beyond the borders. */
static void rejected_taps(void **state)
{
    static struct kk k;
    static struct lbuffer l;
    uint32_t seen = 0, border = 0;
    (void)state;
    kk_open(&k);
    fill_lbuffer(&k, &l);
    for (uint32_t i = 0; i < 80; i++) {
        bool taps = i & 1;
        bind_light(&k, &l, HL_BITS_HALF, taps);
        k.program.spec[HL_SPEC_DSF].u = i & 2 ? HL_DSF_SLOPE
                                              : HL_DSF_CONSTANT;
        inferred_fragments(&k, HL_PE_BATCH);
        kk_shade(&k, taps ? HL_SHADER_REJECT_PLAIN_TAPS_FRAG
                          : HL_SHADER_REJECT_PLAIN_FRAG);
        for (uint32_t j = 0; j < k.in.n; j++) {
            struct filter t = filter_of(&k, &l, j);
            int n = 5;
            for (int c = 0; c < 4; c++)
                n -= t.accept[c] != 0;
            assert_true(k.in.color[0][0][j] == (float)n / 255.0f);
            seen |= 1u << n;
            border += k.in.x[j] == 0 || k.in.y[j] == FH - 1;
        }
    }
    assert_int_equal(seen, 62);
    assert_true(border > 0);
    kk_close(&k);
}

/* Depth and id of signed fixed point, with the steps that such a machine
 * has: the same texels are accepted. */
static void signed_taps(void **state)
{
    static struct kk k;
    static struct lbuffer l;
    static int16_t s[LH][LW][2];
    float want[HL_PE_BATCH];
    (void)state;
    kk_open(&k);
    fill_lbuffer(&k, &l);
    bind_light(&k, &l, HL_BITS_HALF, true);
    inferred_fragments(&k, HL_PE_BATCH);
    kk_shade(&k, HL_SHADER_REJECT_PLAIN_TAPS_FRAG);
    memcpy(want, k.in.color[0][0], sizeof want);
    for (int y = 0; y < LH; y++)
        for (int x = 0; x < LW; x++) {
            float depth = (float)l.dsf[y][x][0] / 65535.0f;
            s[y][x][0] = (int16_t)lroundf((2 * depth - 1) * 32767);
            s[y][x][1] = (int16_t)(l.dsf[y][x][1] - 32767);
        }
    kk_texture(&k, HL_TEX_DSF, HL_FORMAT_RG16_SNORM, HL_FORMAT_NONE, LW, LH,
               s);
    k.program.spec[HL_SPEC_TWO16].u = HL_TWO16_SIGNED;
    k.program.spec[HL_SPEC_ID_STEPS].f = 65534.0f;
    kk_shade(&k, HL_SHADER_REJECT_PLAIN_TAPS_FRAG);
    assert_memory_equal(want, k.in.color[0][0], sizeof want);
    kk_close(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(material_pass),
        cmocka_unit_test(rejected_taps),
        cmocka_unit_test(signed_taps),
    };
    return cmocka_run_group_tests_name("packemu inferred", tests, NULL, NULL);
}
