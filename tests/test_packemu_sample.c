/* SPDX-License-Identifier: Zlib */
/* packemu's fetches and filters: rows and gathers are the single fetch many
 * times over, filters are the formula in doubles, and no coordinate whatever
 * reads past a texture (the sanitizers watch). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/packemu_kit.h"

enum { W = 37, H = 11 };

/* A texture of random bytes; depth by way of a target. */
static hl_tex noise(struct ck_machine *m, enum hl_format f, uint32_t samples)
{
    static uint8_t data[W * H * 16];
    static float depth[W * H];
    bool is_depth = hl_format_info(f)->kind == HL_KIND_DEPTH;
    struct hl_tex_desc d = pk_desc(f, W, H, is_depth ? 1 : samples);
    uint64_t seed = 5;
    hl_tex t = pk_make(m, &d);
    for (uint32_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)mk_random(&seed);
    for (uint32_t i = 0; i < W * H; i++)
        depth[i] = mk_unit(&seed);
    if (is_depth)
        pk_draw_depth(m, t, depth, data);
    else
        assert_int_equal(hl_tex_write(m->device, t, 0, data,
                                      W * H * (size_t)
                                      hl_format_info(f)->bytes), HL_OK);
    return t;
}

static int32_t coordinate(uint64_t *seed, int32_t size)
{
    uint32_t k = mk_below(seed, 20);
    if (k == 0)
        return INT32_MAX;
    if (k == 1)
        return INT32_MIN;
    return (int32_t)mk_below(seed, (uint32_t)size + 6) - 3;
}

static void same(float a, float b)
{
    assert_int_equal(pe_bits(a), pe_bits(b));
}

/* ---- rows and gathers ------------------------------------------------- */

static void row_is_fetches(const struct pe_view *v, int32_t x, int32_t y,
                           uint32_t n, uint32_t planes)
{
    static float row[4][600];
    float *rgba[4], one[4];
    for (int c = 0; c < 4; c++)
        rgba[c] = planes >> c & 1 ? row[c] : NULL;
    pe_fetch_row(v, x, y, n, rgba);
    for (uint32_t i = 0; i < n; i++) {
        int64_t at = (int64_t)x + i;
        pe_fetch(v, 0, at > INT32_MAX ? INT32_MAX : (int32_t)at, y, one);
        for (int c = 0; c < 4; c++)
            if (rgba[c])
                same(row[c][i], one[c]);
    }
}

static void gather_is_fetches(const struct pe_view *v, uint64_t *seed)
{
    static float out[4][4][HL_PE_BATCH];
    static uint32_t words[4][HL_PE_BATCH];
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    const uint32_t n = HL_PE_BATCH - 1;
    for (uint32_t i = 0; i < n; i++) {
        x[i] = coordinate(seed, W);
        y[i] = coordinate(seed, H);
    }
    pe_gather(v, x, y, n, out);
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t i = 0; i < n; i++) {
            int32_t right = k & 1 && x[i] < INT32_MAX;
            int32_t down = k >> 1 && y[i] < INT32_MAX;
            float one[4];
            pe_fetch(v, 0, x[i] + right, y[i] + down, one);
            for (int c = 0; c < 4; c++)
                same(out[k][c][i], one[c]);
        }
    if (hl_format_info(v->texture->view)->kind != HL_KIND_UINT)
        return;
    for (uint32_t w = 0; w < v->texture->words; w++) {
        pe_gather_words(v, w, x, y, n, words);
        for (int k = 0; k < 4; k++)
            for (uint32_t i = 0; i < n; i++)
                assert_int_equal(words[k][i], pe_bits(out[k][w][i]));
    }
}

static void rows_and_gathers_are_fetches(void **state)
{
    (void)state;
    for (uint32_t p = 0; hl_profile_at(p); p++) {
        struct ck_machine m;
        uint64_t seed = mk_seed();
        pk_open(&m, hl_profile_at(p));
        for (int f = 1; f < HL_FORMAT_COUNT; f++) {
            const struct hl_format_caps *c =
                &hl_device_caps(m.device)->format[f];
            if (!(c->use & HL_USE_SAMPLED) ||
                (hl_format_info((enum hl_format)f)->kind == HL_KIND_DEPTH &&
                 !(c->use & HL_USE_TARGET)))
                continue;
            hl_tex t = noise(&m, (enum hl_format)f, 0);
            struct pe_view v = pk_view(&m, t);
            row_is_fetches(&v, 3, 4, 30, 15);
            row_is_fetches(&v, -5, -1, 50, 5);
            row_is_fetches(&v, INT32_MAX - 3, INT32_MAX, 9, 15);
            row_is_fetches(&v, INT32_MIN, INT32_MIN, 300, 15);
            row_is_fetches(&v, -300, 2, 600, 8);
            gather_is_fetches(&v, &seed);
            hl_tex_destroy(m.device, &t);
        }
        ck_close(&m);
    }
}

/* Words of 16-bit pairs as one number: the first channel is the low half. */
static void words_are_numbers(void **state)
{
    const uint16_t data[4] = { 0x1234, 0xabcd, 0x5678, 0x9abc };
    const int32_t zero = 0;
    static uint32_t words[4][HL_PE_BATCH];
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RG16_UNORM, 2, 1, 0);
    d.sample_as = HL_FORMAT_R32_UINT;
    hl_tex t = pk_make(&m, &d);
    assert_int_equal(hl_tex_write(m.device, t, 0, data, 8), HL_OK);
    struct pe_view v = pk_view(&m, t);
    pe_gather_words(&v, 0, &zero, &zero, 1, words);
    assert_int_equal(words[0][0], 0xabcd1234u);
    assert_int_equal(words[1][0], 0x9abc5678u);
    assert_int_equal(words[2][0], 0xabcd1234u);
    assert_int_equal(words[3][0], 0x9abc5678u);
    ck_close(&m);
}

static void a_multisampled_texture_shows_its_first_sample(void **state)
{
    const uint32_t words[8] = { 10, 20, 30, 40, 50, 60, 70, 80 };
    const hl_tex none = { 0 };
    static float taps[4][4][HL_PE_BATCH], out[4][HL_PE_BATCH];
    const int32_t zero = 0;
    const float half = 0.5f;
    struct ck_machine m;
    float row[2][4];
    float *const rgba[4] = { row[0], NULL, NULL, NULL };
    (void)state;
    pk_open(&m, NULL);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 2, 1, 4);
    hl_tex t = pk_make(&m, &d);
    pk_draw(&m, t, none, words);
    struct pe_view v = pk_view(&m, t);
    pe_fetch_row(&v, 0, 0, 2, rgba);
    assert_true(row[0][0] == (float)(10 / 255.0));
    assert_true(row[0][1] == (float)(50 / 255.0));
    pe_gather(&v, &zero, &zero, 1, taps);
    assert_true(taps[0][0][0] == row[0][0] && taps[1][0][0] == row[0][1]);
    assert_true(taps[2][0][0] == row[0][0] && taps[3][0][0] == row[0][1]);
    v.filter = HL_FILTER_LINEAR;
    pe_sample(&v, &half, &half, NULL, 1, out);
    /* 30 of 255, by floats of half an ulp and one lerp. */
    ck_near(out[0][0], 30 / 255.0, 0x1p-25);
    ck_close(&m);
}

static void no_texture_is_white(void **state)
{
    static float out[4][HL_PE_BATCH];
    const struct pe_view v = { NULL, NULL, HL_FILTER_LINEAR, 0, 0 };
    const float u = 0.5f;
    float one[4];
    (void)state;
    pe_fetch(&v, 3, -9, 9, one);
    pe_sample(&v, &u, &u, NULL, 1, out);
    for (int c = 0; c < 4; c++)
        assert_true(one[c] == 1 && out[c][0] == 1);
}

/* ---- filters ---------------------------------------------------------- */

static double wrap_index(double i, double n, uint32_t wrap)
{
    if (wrap == HL_WRAP_REPEAT)
        i -= floor(i / n) * n;
    if (wrap == HL_WRAP_MIRROR) {
        i -= floor(i / (2 * n)) * (2 * n);
        i = i < n ? i : 2 * n - 1 - i;
    }
    return i < 0 ? 0 : i < n ? i : n - 1;
}

static double bilinear(const struct pe_view *v, uint32_t level, double u,
                       double w, int c)
{
    double nx = pe_level_width(v->texture, level);
    double ny = pe_level_height(v->texture, level), sum = 0;
    double x = u * nx - 0.5, y = w * ny - 0.5;
    double fx = x - floor(x), fy = y - floor(y);
    for (int k = 0; k < 4; k++) {
        float one[4];
        pe_fetch(v, level,
                 (int32_t)wrap_index(floor(x) + (k & 1), nx, v->wrap_u),
                 (int32_t)wrap_index(floor(y) + (k >> 1), ny, v->wrap_v), one);
        sum += (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy) *
               (double)one[c];
    }
    return sum;
}

/* Texels are below 1. u has 24 bits before it is times W: the product is off
 * by half an ulp of 4 W, which a texel's step of at most 1 turns into as much
 * in value; two more roundings each of three lerps are below. */
static const double near_enough = 4 * 4 * W * 0x1p-24;

static void filters_are_the_formula(void **state)
{
    static float out[4][HL_PE_BATCH];
    float u[HL_PE_BATCH], w[HL_PE_BATCH];
    uint64_t seed = mk_seed();
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    hl_tex t = noise(&m, HL_FORMAT_RGBA8_SRGB, 0);
    struct pe_view v = pk_view(&m, t);
    v.filter = HL_FILTER_LINEAR;
    for (int wrap = 0; wrap < 9; wrap++) {
        v.wrap_u = (uint8_t)(wrap % 3);
        v.wrap_v = (uint8_t)(wrap / 3);
        for (int i = 0; i < HL_PE_BATCH; i++) {
            u[i] = 8 * mk_unit(&seed) - 4;
            w[i] = 8 * mk_unit(&seed) - 4;
        }
        pe_sample(&v, u, w, NULL, HL_PE_BATCH, out);
        for (int i = 0; i < HL_PE_BATCH; i++)
            for (int c = 0; c < 4; c++)
                ck_near(out[c][i], bilinear(&v, 0, (double)u[i], (double)w[i],
                                            c), near_enough);
    }
    ck_close(&m);
}

static void texel_centres_give_texels(void **state)
{
    static float out[4][HL_PE_BATCH];
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 64, 2, 0);
    uint8_t data[64 * 2 * 4];
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)(i * 37);
    hl_tex t = pk_make(&m, &d);
    assert_int_equal(hl_tex_write(m.device, t, 0, data, sizeof data), HL_OK);
    struct pe_view v = pk_view(&m, t);
    for (int wrap = 0; wrap < 3; wrap++)
        for (int filter = 0; filter < 3; filter++)
            for (int x = 0; x < 64; x++) {
                float u = ((float)x + 0.5f) / 64, w = 0.75f, one[4];
                v.filter = (uint8_t)filter;
                v.wrap_u = v.wrap_v = (uint8_t)wrap;
                pe_fetch(&v, 0, x, 1, one);
                pe_sample(&v, &u, &w, NULL, 1, out);
                for (int c = 0; c < 4; c++)
                    same(out[c][0], one[c]);
            }
    ck_close(&m);
}

/* Levels are constant, k / 255 at level k: what is sampled is the level. */
static hl_tex ladder(struct ck_machine *m, uint32_t w, uint32_t h,
                     uint32_t mips)
{
    static uint8_t data[64 * 64 * 4];
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, w, h, 0);
    d.mips = mips;
    hl_tex t = pk_make(m, &d);
    for (uint32_t k = 0; k < mips; k++) {
        size_t n = (size_t)4 * pe_level_width(pk_texture(m, t), k) *
                   pe_level_height(pk_texture(m, t), k);
        memset(data, (int)k, n);
        assert_int_equal(hl_tex_write(m->device, t, k, data, n), HL_OK);
    }
    return t;
}

static void levels_follow_the_longer_derivative(void **state)
{
    static const struct { float duv[4]; double level; } rows[] = {
        { { 1.0f / 64, 0, 0, 1.0f / 16 }, 0 },
        { { 0, 0, 0, 0 }, 0 },
        { { 2.0f / 64, 0, 0, 1.0f / 16 }, 1 },
        { { 0, 1.0f / 16, 4.0f / 64, 0 }, 2 },
        { { 3.0f / 64, 4.0f / 16, 0, 0 }, 2.321928094887362 },
        { { -6.0f / 64, 0, 0, 0 }, 2.584962500721156 },
        { { 1e30f, 0, 0, 0 }, 6 }, { { 0, 0, 0, 1e-30f }, 0 },
    };
    static float out[4][HL_PE_BATCH], duv[4][HL_PE_BATCH];
    const float u = 0.3f, w = 0.7f;
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    hl_tex t = ladder(&m, 64, 16, 7);
    struct pe_view v = pk_view(&m, t);
    v.filter = HL_FILTER_TRILINEAR;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        for (int c = 0; c < 4; c++)
            duv[c][0] = rows[i].duv[c];
        pe_sample(&v, &u, &w, (const float (*)[HL_PE_BATCH])duv, 1, out);
        /* pe_log2 is within 3 ulp of a number below 4; then a lerp of
         * neighbours that are 1 apart. */
        ck_near(out[0][0] * 255, rows[i].level, 1e-5);
    }
    /* Filters without levels stay on the first. */
    v.filter = HL_FILTER_LINEAR;
    duv[0][0] = 1;
    pe_sample(&v, &u, &w, (const float (*)[HL_PE_BATCH])duv, 1, out);
    assert_true(out[0][0] == 0);
    ck_close(&m);
}

/* A filter of equal texels is exact, whatever the weights. */
static void equal_texels_come_back(void **state)
{
    static float out[4][HL_PE_BATCH], duv[4][HL_PE_BATCH];
    static float data[16 * 16 * 4];
    float u[HL_PE_BATCH], w[HL_PE_BATCH];
    uint64_t seed = mk_seed();
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA32_FLOAT, 16, 16, 0);
    d.mips = 5;
    hl_tex t = pk_make(&m, &d);
    for (int i = 0; i < 16 * 16 * 4; i++)
        data[i] = 0.1f;
    for (uint32_t k = 0; k < 5; k++)
        assert_int_equal(hl_tex_write(m.device, t, k, data,
                                      (256u >> 2 * k) * 16), HL_OK);
    struct pe_view v = pk_view(&m, t);
    v.filter = HL_FILTER_TRILINEAR;
    for (int i = 0; i < HL_PE_BATCH; i++) {
        u[i] = mk_unit(&seed);
        w[i] = mk_unit(&seed);
        duv[0][i] = mk_unit(&seed);
    }
    pe_sample(&v, u, w, (const float (*)[HL_PE_BATCH])duv, HL_PE_BATCH, out);
    for (int i = 0; i < HL_PE_BATCH; i++)
        assert_true(out[0][i] == 0.1f && out[3][i] == 0.1f);
    ck_close(&m);
}

/* ---- hostile numbers -------------------------------------------------- */

static void fetches_stay_in_their_level(void **state)
{
    static const int32_t at[] = { INT32_MIN, -1, 0, 1, 3, 4, 63, INT32_MAX };
    struct ck_machine m;
    float out[4];
    (void)state;
    pk_open(&m, NULL);
    hl_tex t = ladder(&m, 64, 16, 7);
    struct pe_view v = pk_view(&m, t);
    for (uint32_t level = 0; level < 9; level++)
        for (int i = 0; i < 64; i++) {
            pe_fetch(&v, level, at[i % 8], at[i / 8], out);
            assert_true(out[0] == (float)((level < 6 ? level : 6) / 255.0));
        }
    ck_close(&m);
}

static void no_number_reads_past_a_texture(void **state)
{
    static const uint32_t bits[] = {
        0, 0x80000000u, 1, 0x80000001u, 0x3f800000u, 0xbf800000u, 0x3f7fffffu,
        0x3f800001u, 0x4b000000u, 0xcb000000u, 0x4f000000u, 0xcf000000u,
        0x7f7fffffu, 0xff7fffffu, 0x7f800000u, 0xff800000u, 0x7fc00000u,
        0xb3800000u, 0x33800000u,
    };
    enum { N = sizeof bits / sizeof *bits };
    static float out[4][HL_PE_BATCH], duv[4][HL_PE_BATCH];
    float u[HL_PE_BATCH], w[HL_PE_BATCH];
    struct ck_machine m;
    (void)state;
    pk_open(&m, NULL);
    hl_tex t = ladder(&m, 5, 3, 3);
    struct pe_view v = pk_view(&m, t);
    for (int k = 0; k < 27 * N; k++) {
        v.filter = (uint8_t)(k % 3);
        v.wrap_u = (uint8_t)(k / 3 % 3);
        v.wrap_v = (uint8_t)(k / 9 % 3);
        for (int i = 0; i < N; i++) {
            u[i] = pe_float(bits[i]);
            w[i] = pe_float(bits[k / 27]);
            for (int c = 0; c < 4; c++)
                duv[c][i] = pe_float(bits[(i * 7 + c * k) % N]);
        }
        pe_sample(&v, u, w, (const float (*)[HL_PE_BATCH])duv, N, out);
        for (int i = 0; i < N; i++)
            for (int c = 0; c < 4; c++)
                assert_true(out[c][i] >= 0 && out[c][i] <= 2 / 255.0f);
    }
    ck_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_and_gathers_are_fetches),
        cmocka_unit_test(words_are_numbers),
        cmocka_unit_test(a_multisampled_texture_shows_its_first_sample),
        cmocka_unit_test(no_texture_is_white),
        cmocka_unit_test(filters_are_the_formula),
        cmocka_unit_test(texel_centres_give_texels),
        cmocka_unit_test(levels_follow_the_longer_derivative),
        cmocka_unit_test(equal_texels_come_back),
        cmocka_unit_test(fetches_stay_in_their_level),
        cmocka_unit_test(no_number_reads_past_a_texture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
