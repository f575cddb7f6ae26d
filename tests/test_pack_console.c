/* SPDX-License-Identifier: Zlib */
/* Packing formulas of consoles against spec/consoles 1.3, 1.5, 2.4 and 2.5:
 * its tables, and every code there is. */
#include <math.h>
#include "shaders/shared/pack.h"
#include "tests/check.h"

/* ---- Xbox 360 ----------------------------------------------------------- */

/* Fixed point of -32..32 as it lies in EDRAM, and, resolved by 2^-5 to signed
 * numbers, in the texture. */
static int fixed(float v)
{
    float c = v < -32 ? -32 : v > 32 ? 32 : v;
    float t = c * 1023.96875f;
    return (int)(t + (t < 0 ? -0.5f : 0.5f));
}

static float sampled(int code) { return (float)code / 32767.0f; }

static void fixed_point_is_as_published(void **state)
{
    (void)state;
    static const struct { float v, out; int code; double back; } row[] = {
        { 0, -32, -32767, 0 }, { 0.1f, -25.6f, -26214, 0.09999388456 },
        { 0.25f, -16, -16384, 0.24999237061 }, { 0.5f, 0, 0, 0.5 },
        { 0.75f, 16, 16384, 0.75000762939 }, { 1, 32, 32767, 1 }
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        hl_vec4 o = hl_two16_encode(HL_TWO16_FIXED32, row[i].v, row[i].v);
        /* One rounding of 64 v. */
        ck_near((double)o.x, (double)row[i].out, 4e-6);
        assert_true(o.x == o.y);
        assert_int_equal(fixed(o.x), row[i].code);
        float s = sampled(row[i].code);
        hl_vec2 d = hl_two16_decode(HL_TWO16_FIXED32, hl_v2(s, s));
        ck_near((double)d.x, row[i].back, 6e-8);
        assert_true(d.x == d.y);
    }
}

/* 65,535 codes, of which a number of 0..1 reaches every one; without the
 * scale 1,025 (K 5.1). */
static void fixed_point_keeps_sixteen_bits(void **state)
{
    (void)state;
    uint32_t scaled = 0, plain = 0;
    int last = -40000, last_plain = -1;
    for (uint32_t i = 0; i < 65536; i++) {
        float v = (float)i / 65535.0f;
        int code = fixed(hl_two16_encode(HL_TWO16_FIXED32, v, 0).x);
        assert_true(code >= last);
        scaled += code != last;
        plain += fixed(v) != last_plain;
        last = code;
        last_plain = fixed(v);
    }
    assert_int_equal(scaled, 65535);
    assert_int_equal(plain, 1025);
}

/* Steps 65,534: every id comes back. With 65,535 two ids would be one. */
static void ids_in_fixed_point(void **state)
{
    (void)state;
    uint32_t lost = 0;
    int last = -40000;
    for (uint32_t id = 0; id <= 65534; id++) {
        float v = hl_id_encode((float)id, 1.0f / 65534.0f);
        int fix = fixed(hl_two16_encode(HL_TWO16_FIXED32, 0, v).y);
        float twice = hl_two16_encode(HL_TWO16_SIGNED, 0, v).y * 32767.0f;
        int norm = (int)floorf(twice + 0.5f);
        assert_int_equal(fix, (int)id - 32767);
        assert_int_equal(norm, fix);
        hl_vec2 d = hl_two16_decode(HL_TWO16_SIGNED, hl_v2(0, sampled(fix)));
        ck_near((double)(d.y * 65534.0f), id, 0.008);
        v = hl_id_encode((float)id, 1.0f / 65535.0f);
        fix = fixed(hl_two16_encode(HL_TWO16_FIXED32, 0, v).y);
        lost += fix == last;
        last = fix;
    }
    assert_int_equal(lost, 1);
}

static void signed_numbers_have_an_exact_half(void **state)
{
    (void)state;
    hl_vec4 o = hl_two16_encode(HL_TWO16_SIGNED, 0.5f, 0.5f);
    assert_true(o.x == 0 && o.y == 0 && o.z == 0 && o.w == 1);
    assert_true(hl_two16_decode(HL_TWO16_SIGNED, hl_v2(0, 0)).x == 0.5f);
    o = hl_two16_encode(HL_TWO16_SIGNED, 0, 1);
    assert_true(o.x == -1 && o.y == 1);
}

/* ---- PlayStation 3 ------------------------------------------------------ */

/* As the output unit stores it, k / 255 exact for all k. */
static int byte(float c) { return (int)floorf(c * 255.0f + 0.5f); }

static void bytes_are_as_published(void **state)
{
    (void)state;
    /* Memory A R G B; 0xABCD of y, 0x1234 of x (spec/consoles 2.4). */
    hl_vec4 o = hl_two16_encode(HL_TWO16_BYTES_ARGB, 0x1234 / 65535.0f,
                                0xABCD / 65535.0f);
    assert_int_equal(byte(o.w), 0xAB);
    assert_int_equal(byte(o.x), 0xCD);
    assert_int_equal(byte(o.y), 0x12);
    assert_int_equal(byte(o.z), 0x34);
    o = hl_two16_encode(HL_TWO16_BYTES_ARGB, 0.5f, 0.25f);
    assert_int_equal(byte(o.w) << 8 | byte(o.x), 0x4000);
    assert_int_equal(byte(o.y) << 8 | byte(o.z), 0x8000);
    o = hl_two16_encode(HL_TWO16_BYTES, 0x1234 / 65535.0f, 0xABCD / 65535.0f);
    assert_int_equal(byte(o.x), 0x34);
    assert_int_equal(byte(o.y), 0x12);
    assert_int_equal(byte(o.z), 0xCD);
    assert_int_equal(byte(o.w), 0xAB);
}

static void bytes_keep_every_code_and_the_range(void **state)
{
    (void)state;
    static const float beyond[] = { -1, -1e30f, 2, 1e30f, NAN };
    for (int i = 0; i < 65536; i++) {
        hl_vec4 o = hl_two16_encode(HL_TWO16_BYTES, (float)i / 65535.0f,
                                    (float)(65535 - i) / 65535.0f);
        assert_int_equal(byte(o.y) << 8 | byte(o.x), i);
        assert_int_equal(byte(o.w) << 8 | byte(o.z), 65535 - i);
    }
    for (int i = 0; i < 5; i++) {
        hl_vec4 o = hl_two16_encode(HL_TWO16_BYTES, beyond[i], 0);
        assert_int_equal(byte(o.y) << 8 | byte(o.x),
                         i == 2 || i == 3 ? 65535 : 0);
    }
}

/* All 2^24 depths: the quotient as it is rounded once. */
static void depth_of_three_bytes_is_exact(void **state)
{
    (void)state;
    for (uint32_t z = 0; z < 1u << 24; z++) {
        hl_vec3 c = hl_v3((float)(z >> 16) / 255.0f,
                          (float)(z >> 8 & 255) / 255.0f,
                          (float)(z & 255) / 255.0f);
        if (hl_depth_barg(c) != (float)((double)z / 16777215.0))
            fail_msg("depth %u", z);
    }
    assert_true(hl_depth_barg(hl_v3(1, 1, 1)) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fixed_point_is_as_published),
        cmocka_unit_test(fixed_point_keeps_sixteen_bits),
        cmocka_unit_test(ids_in_fixed_point),
        cmocka_unit_test(signed_numbers_have_an_exact_half),
        cmocka_unit_test(bytes_are_as_published),
        cmocka_unit_test(bytes_keep_every_code_and_the_range),
        cmocka_unit_test(depth_of_three_bytes_is_exact),
    };
    return cmocka_run_group_tests_name("packing of consoles", tests, NULL,
                                       NULL);
}
