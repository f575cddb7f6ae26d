/* SPDX-License-Identifier: Zlib */
/* Numbers to codes and back in packemu: every code of every format, and the
 * tables of spec/consoles.md sections 1.2, 1.3 and 1.7. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/packemu/pe.h"
#include "platforms/packemu/pe_code.h"
#include "tests/check.h"

enum { LOT = 1024 };

static void encode_one(enum hl_format f, float r, float g, float b, float a,
                       uint32_t words[4])
{
    const float *const rgba[4] = { &r, &g, &b, &a };
    memset(words, 0, 4 * sizeof *words);
    pe_encode(f, rgba, 1, words);
}

static void decode_one(enum hl_format f, const uint32_t words[4], float out[4])
{
    float *const rgba[4] = { out, out + 1, out + 2, out + 3 };
    pe_decode(f, words, 1, rgba);
}

static uint32_t code_of(enum pe_code code, uint32_t bits, float x)
{
    uint32_t k;
    pe_code_encode(code, bits, &x, 1, &k);
    return k;
}

static float value_of(enum pe_code code, uint32_t bits, uint32_t k)
{
    float x;
    pe_code_decode(code, bits, &k, 1, &x);
    return x;
}

/* ---- every code ------------------------------------------------------- */

static bool not_finite(enum pe_code code, uint32_t bits, uint32_t k)
{
    uint32_t mantissa = code == PE_CODE_F16 ? 10 : bits - 5;
    return (code == PE_CODE_F16 || code == PE_CODE_F11 ||
            code == PE_CODE_F10) && (k >> mantissa & 31) == 31;
}

static void every_code_comes_back(void **state)
{
    static const struct { enum pe_code code; uint32_t bits; } kinds[] = {
        { PE_CODE_UNORM, 2 }, { PE_CODE_UNORM, 8 }, { PE_CODE_UNORM, 10 },
        { PE_CODE_UNORM, 16 }, { PE_CODE_SNORM, 16 }, { PE_CODE_SRGB, 8 },
        { PE_CODE_F16, 16 }, { PE_CODE_F11, 11 }, { PE_CODE_F10, 10 },
        { PE_CODE_FIXED32, 16 }, { PE_CODE_7E3, 10 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        enum pe_code code = kinds[i].code;
        uint32_t bits = kinds[i].bits, n_bad = 0;
        bool two = code == PE_CODE_SNORM || code == PE_CODE_FIXED32;
        for (uint32_t k = 0; k < 1u << bits; k++) {
            if (not_finite(code, bits, k))
                continue;
            /* The most negative code doubles its neighbour. */
            uint32_t want = two && k == 0x8000 ? 0x8001 : k;
            n_bad += code_of(code, bits, value_of(code, bits, k)) != want;
        }
        if (n_bad)
            fail_msg("code %d of %u bits: %u codes do not come back",
                     (int)code, bits, n_bad);
    }
}

/* A quotient of integers below 2^24 rounds once from double to float as it
 * would from the exact value: 53 bits are more than twice 24 and two. */
static void normalised_codes_are_correctly_rounded_quotients(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 65536; k++) {
        int32_t i = k < 0x8000 ? (int32_t)k : (int32_t)k - 0x10000;
        float s = (float)((double)i / 32767);
        assert_true(value_of(PE_CODE_UNORM, 16, k) == (float)(k / 65535.0));
        assert_true(value_of(PE_CODE_SNORM, 16, k) == (s > -1 ? s : -1));
        if (k < 256)
            assert_true(value_of(PE_CODE_UNORM, 8, k) == (float)(k / 255.0));
        if (k < 1024)
            assert_true(value_of(PE_CODE_UNORM, 10, k) ==
                        (float)(k / 1023.0));
    }
}

static void floats_have_the_values_of_their_fields(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 0x7c00; k++)
        assert_true(value_of(PE_CODE_F16, 16, k) == ck_half((uint16_t)k));
    for (uint32_t k = 0; k < 31 << 6; k++) {
        double m = k & 63, e = k >> 6;
        assert_true(value_of(PE_CODE_F11, 11, k) ==
                    (float)(e > 0 ? ldexp(1 + m / 64, (int)e - 15)
                                  : ldexp(m, -20)));
    }
    for (uint32_t k = 0; k < 31 << 5; k++) {
        double m = k & 31, e = k >> 5;
        assert_true(value_of(PE_CODE_F10, 10, k) ==
                    (float)(e > 0 ? ldexp(1 + m / 32, (int)e - 15)
                                  : ldexp(m, -19)));
    }
    assert_true(isinf(value_of(PE_CODE_F16, 16, 0xfc00)));
    assert_true(isnan(value_of(PE_CODE_F16, 16, 0x7c01)));
    assert_true(isinf(value_of(PE_CODE_F11, 11, 0x7c0)));
}

/* ---- rounding --------------------------------------------------------- */

static void bad_numbers_become_the_nearest_good_ones(void **state)
{
    static const struct {
        enum pe_code code;
        uint32_t bits, zero, low, high;  /* of NaN, -inf, +inf               */
    } rows[] = {
        { PE_CODE_UNORM, 8, 0, 0, 255 }, { PE_CODE_UNORM, 16, 0, 0, 65535 },
        { PE_CODE_SNORM, 16, 0, 0x8001, 0x7fff },
        { PE_CODE_SRGB, 8, 0, 0, 255 },
        { PE_CODE_F16, 16, 0, 0xfbff, 0x7bff },
        { PE_CODE_F11, 11, 0, 0, 0x7bf },
        { PE_CODE_F10, 10, 0, 0, 0x3df }, { PE_CODE_7E3, 10, 0, 0, 0x3ff },
        { PE_CODE_FIXED32, 16, 0, 0x8001, 0x7fff },
        { PE_CODE_F32, 32, 0, 0xff800000u, 0x7f800000u },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        enum pe_code c = rows[i].code;
        uint32_t bits = rows[i].bits;
        assert_int_equal(code_of(c, bits, pe_float(0x7fc00000u)), rows[i].zero);
        assert_int_equal(code_of(c, bits, pe_float(0xffc00001u)), rows[i].zero);
        assert_int_equal(code_of(c, bits, pe_float(0xff800000u)), rows[i].low);
        assert_int_equal(code_of(c, bits, pe_float(0x7f800000u)),
                         rows[i].high);
    }
    assert_int_equal(code_of(PE_CODE_F16, 16, 65520.0f), 0x7bff);
    assert_int_equal(code_of(PE_CODE_F16, 16, -1e9f), 0xfbff);
}

static void halves_round_to_nearest_even(void **state)
{
    uint64_t seed = mk_seed();
    (void)state;
    for (int i = 0; i < 200000; i++) {
        float x = pe_float(mk_random(&seed));
        if (x != x || x > 65504 || x < -65504)
            continue;
        assert_int_equal(code_of(PE_CODE_F16, 16, x), ck_half_nearest(x));
    }
    for (uint32_t k = 0; k < 0x7bff; k++) {
        float mid = (ck_half((uint16_t)k) + ck_half((uint16_t)(k + 1))) / 2;
        assert_int_equal(code_of(PE_CODE_F16, 16, mid), k + (k & 1));
    }
}

/* Halfway between two codes goes to the even one, a step beside it does not:
 * the midpoints of these formats are floats. */
static void small_floats_round_to_nearest_even(void **state)
{
    static const struct { enum pe_code code; uint32_t bits, last; } rows[] = {
        { PE_CODE_F11, 11, 0x7bf }, { PE_CODE_F10, 10, 0x3df },
        { PE_CODE_7E3, 10, 0x3ff },
    };
    (void)state;
    for (size_t i = 0; i < 3; i++)
        for (uint32_t k = 0; k < rows[i].last; k++) {
            enum pe_code c = rows[i].code;
            uint32_t bits = rows[i].bits;
            float mid = (value_of(c, bits, k) + value_of(c, bits, k + 1)) / 2;
            float below = pe_float(pe_bits(mid) - 1);
            float above = pe_float(pe_bits(mid) + 1);
            assert_int_equal(code_of(c, bits, mid), k + (k & 1));
            assert_int_equal(code_of(c, bits, below), k);
            assert_int_equal(code_of(c, bits, above), k + 1);
        }
}

/* The product with 65535 is rounded by half a unit of 2^-8 at most, so that
 * numbers a 256th of a step from the midpoint are decided rightly. */
static void unorm_rounds_to_nearest(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 65535; k++) {
        double mid = (k + 0.5) / 65535, step = 1.0 / 65535;
        assert_int_equal(code_of(PE_CODE_UNORM, 16,
                                 (float)(mid - step / 128)), k);
        assert_int_equal(code_of(PE_CODE_UNORM, 16,
                                 (float)(mid + step / 128)), k + 1);
    }
    assert_int_equal(code_of(PE_CODE_UNORM, 8, 0.5f), 128);
    assert_int_equal(code_of(PE_CODE_SNORM, 16, 0.5f / 32767), 1);
    assert_int_equal(code_of(PE_CODE_SNORM, 16, -0.5f / 32767), 0xffff);
}

static double srgb_to_linear(double c)
{
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

/* Float values: half an ulp, 2^-25 relative, and pow's own error. */
static void srgb_tables_are_the_curve(void **state)
{
    (void)state;
    for (uint32_t k = 0; k < 256; k++) {
        double want = srgb_to_linear(k / 255.0);
        ck_near(pe_srgb_linear[k], want, want * 0x1p-24);
        if (k == 255)
            continue;
        double step = srgb_to_linear((k + 0.5) / 255);
        ck_near(pe_srgb_step[k], step, step * 0x1p-22);
        float below = pe_float(pe_bits(pe_srgb_step[k]) - 1);
        assert_int_equal(code_of(PE_CODE_SRGB, 8, below), k);
        assert_int_equal(code_of(PE_CODE_SRGB, 8, pe_srgb_step[k]), k + 1);
    }
    uint32_t words[4];
    float out[4];
    encode_one(HL_FORMAT_RGBA8_SRGB, 0.5f, 0, 1, 0.5f, words);
    assert_int_equal(words[0], 0x80ff00bcu);
    decode_one(HL_FORMAT_RGBA8_SRGB, words, out);
    assert_true(out[3] == (float)(128 / 255.0));
}

/* ---- layout ----------------------------------------------------------- */

static void the_first_channel_is_in_the_low_bits(void **state)
{
    static const struct {
        enum hl_format format;
        uint32_t n, words[4];        /* of 1, 0, 0.5, 1 (2 where it fits)    */
    } rows[] = {
        { HL_FORMAT_R8_UNORM, 1, { 0xff } },
        { HL_FORMAT_RG8_UNORM, 1, { 0x00ff } },
        { HL_FORMAT_RGBA8_UNORM, 1, { 0xff8000ffu } },
        { HL_FORMAT_RGB10A2_UNORM, 1, { 0xe00003ffu } },
        { HL_FORMAT_R16_UNORM, 1, { 0xffff } },
        { HL_FORMAT_RG16_UNORM, 1, { 0xffff } },
        { HL_FORMAT_RGBA16_UNORM, 2, { 0xffff, 0xffff8000u } },
        { HL_FORMAT_RG16_SNORM, 1, { 0x7fff } },
        { HL_FORMAT_RGBA16_SNORM, 2, { 0x7fff, 0x7fff4000u } },
        { HL_FORMAT_RG16_FLOAT, 1, { 0x3c00 } },
        { HL_FORMAT_RGBA16_FLOAT, 2, { 0x3c00, 0x3c003800u } },
        { HL_FORMAT_R32_FLOAT, 1, { 0x3f800000u } },
        { HL_FORMAT_RGBA32_FLOAT, 4,
          { 0x3f800000u, 0, 0x3f000000u, 0x3f800000u } },
        { HL_FORMAT_RG11B10_FLOAT, 1, { 15u << 6 | 14u << 27 } },
        { HL_FORMAT_RG16_FIXED32, 1, { 0x0400 } },
        { HL_FORMAT_RGBA16_FIXED32, 2, { 0x0400, 0x04000200u } },
        { HL_FORMAT_RGB10A2_FLOAT, 1, { 0x180 | 0x100u << 20 | 3u << 30 } },
        { HL_FORMAT_RG32_UINT, 2, { 0x3f800000u, 0 } },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        enum hl_format f = rows[i].format;
        const uint32_t channels = hl_format_info(f)->channels;
        uint32_t words[4];
        float out[4];
        assert_int_equal(pe_words(f), rows[i].n);
        encode_one(f, 1, 0, 0.5f, 1, words);
        for (uint32_t k = 0; k < rows[i].n; k++)
            if (words[k] != rows[i].words[k])
                fail_msg("%s word %u is %08x, not %08x",
                         hl_format_info(f)->name, k, words[k],
                         rows[i].words[k]);
        decode_one(f, words, out);
        for (uint32_t c = channels; c < 4; c++)
            assert_int_equal(pe_bits(out[c]),
                             c < 3 ? 0 : f == HL_FORMAT_RG32_UINT
                                         ? 1 : 0x3f800000u);
    }
}

/* Batches are cut somewhere inside: no texel may notice. */
static void a_texel_is_the_same_in_any_batch(void **state)
{
    static float plane[4][LOT], back[4][LOT];
    static uint32_t words[LOT * 4];
    const float *const in[4] = { plane[0], plane[1], plane[2], plane[3] };
    float *const out[4] = { back[0], back[1], back[2], back[3] };
    uint64_t seed = mk_seed();
    (void)state;
    for (int i = 0; i < 4 * LOT; i++)
        plane[i / LOT][i % LOT] = mk_unit(&seed) * 3 - 1;
    for (int f = 1; f < HL_FORMAT_COUNT; f++) {
        if (hl_format_info((enum hl_format)f)->kind == HL_KIND_DEPTH)
            continue;
        uint32_t n = LOT - 1 - (uint32_t)f, per = pe_words((enum hl_format)f);
        pe_encode((enum hl_format)f, in, n, words);
        pe_decode((enum hl_format)f, words, n, out);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t one[4];
            float x[4];
            encode_one((enum hl_format)f, plane[0][i], plane[1][i],
                       plane[2][i], plane[3][i], one);
            decode_one((enum hl_format)f, one, x);
            assert_memory_equal(one, words + i * per, per * sizeof *one);
            for (int c = 0; c < 4; c++)
                assert_int_equal(pe_bits(x[c]), pe_bits(back[c][i]));
        }
    }
}

/* ---- Xenos: spec/consoles.md 1.2, 1.3 ---------------------------------- */

static void fixed_point_is_that_of_the_table(void **state)
{
    static const struct { float v; uint32_t code; double back; } rows[] = {
        { 0, 0, 0 }, { 1, 0x0400, 1.000030517578125 },
        { -1, 0xfc00, -1.000030517578125 },
        { 0.5f, 0x0200, 0.5000152587890625 },
        { 0x1p-10f, 1, 0.00097659230232 }, { 0x1p-11f, 0, 0 },
        { 16, 0x4000, 16.00048828125 }, { 32, 0x7fff, 32 }, { 40, 0x7fff, 32 },
        { -32, 0x8001, -32 }, { -40, 0x8001, -32 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint32_t k = code_of(PE_CODE_FIXED32, 16, rows[i].v);
        assert_int_equal(k, rows[i].code);
        assert_true(value_of(PE_CODE_FIXED32, 16, k) == (float)rows[i].back);
    }
    const float unit = (float)(32.0 / 32767);
    for (int i = -32767; i <= 32767; i++)
        assert_true(value_of(PE_CODE_FIXED32, 16, (uint32_t)i & 0xffff) ==
                    (float)i * unit);
    assert_true(value_of(PE_CODE_FIXED32, 16, 0x8000) == -32);
}

static void seven_e_three_is_that_of_the_table(void **state)
{
    (void)state;
    assert_true(value_of(PE_CODE_7E3, 10, 0x001) == 0x1p-9f);
    assert_true(value_of(PE_CODE_7E3, 10, 0x07f) == 0.248046875f);
    assert_true(value_of(PE_CODE_7E3, 10, 0x080) == 0.25f);
    assert_true(value_of(PE_CODE_7E3, 10, 0x180) == 1);
    assert_true(value_of(PE_CODE_7E3, 10, 0x200) == 2);
    assert_true(value_of(PE_CODE_7E3, 10, 0x280) == 4);
    assert_true(value_of(PE_CODE_7E3, 10, 0x3ff) == 31.875f);
}

/* ---- depth ------------------------------------------------------------ */

static uint32_t depth_code(enum hl_format f, float z)
{
    uint32_t code;
    pe_depth_encode(f, &z, 1, &code);
    return code;
}

/* spec/consoles.md 1.7; each row of a table. */
static void unorm_depth_is_that_of_the_table(void **state)
{
    static const struct { uint32_t code, bits; } back[] = {
        { 0x000001, 0x33800001u }, { 0x123456, 0x3d91a2b1u },
        { 0x400000, 0x3e800001u }, { 0x7fffff, 0x3effffffu },
        { 0x800000, 0x3f000001u }, { 0xc00000, 0x3f400001u },
        { 0xffffff, 0x3f800000u },
    };
    static const struct { float z; uint32_t code; } rows[] = {
        { 0.5f, 0x800000 }, { 0.25f, 0x400000 }, { 0.75f, 0xbfffff },
        { 0.1f, 0x19999a }, { 0.9999999f, 0xfffffd }, { 1, 0xffffff },
        { 2, 0xffffff }, { -1, 0 }, { 0, 0 }, { -0.0f, 0 },
    };
    const enum hl_format f = HL_FORMAT_D24_UNORM_S8;
    (void)state;
    for (size_t i = 0; i < sizeof back / sizeof *back; i++)
        assert_int_equal(pe_bits(pe_depth_decode(f, back[i].code)),
                         back[i].bits);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_int_equal(depth_code(f, rows[i].z), rows[i].code);
    assert_int_equal(depth_code(f, pe_float(0x7fc00000u)), 0);
}

static void float_depth_is_that_of_the_table(void **state)
{
    static const struct { float z; uint32_t code; double back; } rows[] = {
        { 1, 0xf00000, 1 }, { 0.5f, 0xe00000, 0.5 },
        { 0.1f, 0xb99999, 0.0999999642 }, { 1.99999f, 0xfffff5, 1.99998951 },
        { 2, 0xffffff, 1.9999990463 }, { 1e30f, 0xffffff, 1.9999990463 },
        { 0x1p-14f, 0x100000, 0x1p-14 }, { 0x1p-34f, 1, 0x1p-34 },
        { 0x1p-35f, 0, 0 }, { -1, 0, 0 }, { 0, 0, 0 },
    };
    const enum hl_format f = HL_FORMAT_D24_FLOAT_S8;
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(depth_code(f, rows[i].z), rows[i].code);
        /* The table has ten digits: half of the last. */
        ck_near(pe_depth_decode(f, rows[i].code), rows[i].back, 5e-9);
    }
    assert_int_equal(depth_code(f, pe_float(0x7fc00000u)), 0);
    assert_int_equal(depth_code(f, pe_float(0x7f800000u)), 0xffffff);
}

/* All 2^24 codes come back and order as their depths do; and a plane of
 * depths is what single codes decode to. */
static void all_depth_codes(enum hl_format f, uint32_t n, uint32_t shift)
{
    static uint32_t code[LOT], words[LOT], again[LOT];
    static float depth[LOT];
    float last = -1;
    uint32_t n_bad = 0;
    for (uint32_t at = 0; at < n; at += LOT) {
        for (uint32_t i = 0; i < LOT; i++) {
            code[i] = at + i;
            words[i] = (at + i) << shift | (shift ? 0xa5 : 0);
        }
        pe_depth_plane(f, words, LOT, depth);
        pe_depth_encode(f, depth, LOT, again);
        n_bad += memcmp(again, code, sizeof code) != 0;
        for (uint32_t i = 0; i < LOT; i++) {
            n_bad += depth[i] != pe_depth_decode(f, code[i]);
            n_bad += depth[i] > last ? 0u : 1u;
            last = depth[i];
        }
    }
    assert_int_equal(n_bad, 0);
}

static void depth_codes_come_back_and_order(void **state)
{
    (void)state;
    all_depth_codes(HL_FORMAT_D16_UNORM, 1u << 16, 0);
    all_depth_codes(HL_FORMAT_D24_UNORM_S8, 1u << 24, 8);
    all_depth_codes(HL_FORMAT_D24_FLOAT_S8, 1u << 24, 8);
    assert_int_equal(depth_code(HL_FORMAT_D32_FLOAT, 0.3f), pe_bits(0.3f));
    assert_int_equal(depth_code(HL_FORMAT_D32_FLOAT, -0.0f), 0);
    assert_int_equal(depth_code(HL_FORMAT_D32_FLOAT_S8, 3), pe_bits(1));
}

/* 24-bit codes are what the definition says: nearest even of the product as a
 * float; in doubles, whose product is exact, by nearbyint. */
static void unorm_depth_rounds_to_nearest_even(void **state)
{
    uint64_t seed = mk_seed();
    (void)state;
    for (int i = 0; i < 200000; i++) {
        float z = mk_unit(&seed);
        float product = z * 16777215.0f;
        assert_int_equal(depth_code(HL_FORMAT_D24_UNORM_S8, z),
                         (uint32_t)nearbyint((double)product));
        product = z * 65535.0f;
        assert_int_equal(depth_code(HL_FORMAT_D16_UNORM, z),
                         (uint32_t)nearbyint((double)product));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_comes_back),
        cmocka_unit_test(normalised_codes_are_correctly_rounded_quotients),
        cmocka_unit_test(floats_have_the_values_of_their_fields),
        cmocka_unit_test(bad_numbers_become_the_nearest_good_ones),
        cmocka_unit_test(halves_round_to_nearest_even),
        cmocka_unit_test(small_floats_round_to_nearest_even),
        cmocka_unit_test(unorm_rounds_to_nearest),
        cmocka_unit_test(srgb_tables_are_the_curve),
        cmocka_unit_test(the_first_channel_is_in_the_low_bits),
        cmocka_unit_test(a_texel_is_the_same_in_any_batch),
        cmocka_unit_test(fixed_point_is_that_of_the_table),
        cmocka_unit_test(seven_e_three_is_that_of_the_table),
        cmocka_unit_test(unorm_depth_is_that_of_the_table),
        cmocka_unit_test(float_depth_is_that_of_the_table),
        cmocka_unit_test(depth_codes_come_back_and_order),
        cmocka_unit_test(unorm_depth_rounds_to_nearest_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
