/* SPDX-License-Identifier: Zlib */
/* packemu's resolves against spec/consoles.md 1.5 and 1.6: the -1..1 format,
 * exponent bias, endian swaps, raw copies. */
#include <string.h>
#include "tests/packemu_kit.h"

/* ---- resolves: spec/consoles.md 1.5, 1.6 ------------------------------- */

static hl_tex fixed_target(struct ck_machine *m, enum hl_format f, uint32_t w,
                           uint32_t h, bool trick, enum hl_endian endian)
{
    struct hl_tex_desc d = pk_desc(f, w, h, 1);
    d.console.endian = (uint8_t)endian;
    d.console.resolve_number = trick;
    d.console.resolve_exp_bias = trick ? -5 : 0;
    return pk_make(m, &d);
}

static void draw_two(struct ck_machine *m, hl_tex t, float r, float g)
{
    const hl_tex none = { 0 };
    const float *const rgba[4] = { &r, &g, &r, &g };
    uint32_t words[4];
    pe_encode(pk_texture(m, t)->desc.format, rgba, 1, words);
    pk_draw(m, t, none, words);
}

static void the_trick_keeps_the_bits_of_the_table(void **state)
{
    static const struct { float v, out; uint8_t be[2]; double back; } rows[] = {
        { 0, -32, { 0x80, 0x01 }, 0 },
        { 0.1f, -25.6f, { 0x99, 0x9a }, 0.09999388456 },
        { 0.25f, -16, { 0xc0, 0x00 }, 0.24999237061 },
        { 0.5f, 0, { 0, 0 }, 0.5 },
        { 0.75f, 16, { 0x40, 0x00 }, 0.75000762939 },
        { 1, 32, { 0x7f, 0xff }, 1 },
    };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    hl_tex t = fixed_target(&m, HL_FORMAT_RG16_FIXED32, 1, 1, true,
                            HL_ENDIAN_8IN16);
    struct pe_view v = pk_view(&m, t);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        uint8_t bytes[4];
        float out[4];
        draw_two(&m, t, 64 * rows[i].v - 32, rows[i].out);
        memcpy(bytes, rows[i].be, 2);
        memcpy(bytes + 2, rows[i].be, 2);
        pk_assert_bytes(&m, t, bytes, 4);
        pe_fetch(&v, 0, 0, 0, out);
        /* Eleven digits of the table, and halves of a float below 1. */
        ck_near(0.5f * out[0] + 0.5f, rows[i].back, 6e-8);
        ck_near(0.5f * out[1] + 0.5f, rows[i].back, 6e-8);
        assert_true(out[2] == 0 && out[3] == 1);
    }
    t = fixed_target(&m, HL_FORMAT_RG16_FIXED32, 1, 1, false, HL_ENDIAN_8IN16);
    draw_two(&m, t, 1, 0.5f);
    pk_assert_bytes(&m, t, (const uint8_t[]){ 0xff, 0xff, 0x80, 0x01 }, 4);
    ck_close(&m);
}

/* How many of 65,536 inputs k / 65535 can be told apart afterwards. */
static uint32_t codes_of(struct ck_machine *m, float scale, float offset,
                         int bias, bool is_signed)
{
    enum { W = 256 };
    static uint32_t words[W * W], codes[W * W];
    static float plane[W * W];
    const float *const rgba[4] = { plane, plane, plane, plane };
    const hl_tex none = { 0 };
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RG16_FIXED32, W, W, 1);
    d.console.resolve_number = is_signed;
    d.console.resolve_exp_bias = (int8_t)bias;
    hl_tex t = pk_make(m, &d);
    for (uint32_t i = 0; i < W * W; i++)
        plane[i] = (float)i / 65535.0f * scale + offset;
    pe_encode(d.format, rgba, W * W, words);
    pk_draw(m, t, none, words);
    assert_int_equal(hl_tex_read(m->device, t, codes, sizeof codes), HL_OK);
    hl_tex_destroy(m->device, &t);
    uint32_t n = 1;
    for (uint32_t i = 1; i < W * W; i++)
        n += codes[i] != codes[i - 1];
    return n;
}

static void the_trick_is_worth_what_is_said(void **state)
{
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    assert_int_equal(codes_of(&m, 1, 0, 0, false), 1025);
    assert_int_equal(codes_of(&m, 32, 0, -5, false), 32768);
    assert_int_equal(codes_of(&m, 64, -32, -5, true), 65535);
    ck_close(&m);
}

/* With the trick a resolve keeps all bits but 0x8000; without, it saturates
 * and negative numbers are 0. */
static void the_trick_is_the_identity_on_bits(void **state)
{
    enum { W = 256 };
    static uint32_t words[W * W], back[W * W];
    const hl_tex none = { 0 };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (uint32_t i = 0; i < W * W; i++)
        words[i] = i | (65535 - i) << 16;
    hl_tex t = fixed_target(&m, HL_FORMAT_RG16_FIXED32, W, W, true,
                            HL_ENDIAN_8IN32);
    pk_draw(&m, t, none, words);
    words[0x8000]++;
    words[0x7fff] += 0x10000;
    assert_int_equal(hl_tex_read(m.device, t, back, sizeof back), HL_OK);
    /* A host's array: two uint16_t a texel. */
    for (uint32_t i = 0; i < W * W; i++) {
        uint16_t two[2];
        memcpy(two, back + i, sizeof two);
        assert_int_equal(two[0] | (uint32_t)two[1] << 16, words[i]);
    }
    ck_close(&m);
}

/* Word 0xABCD1234: R = 0x1234, G = 0xABCD. */
static void swaps_are_those_of_the_table(void **state)
{
    static const uint8_t rows[4][4] = {
        { 0x34, 0x12, 0xcd, 0xab }, { 0x12, 0x34, 0xab, 0xcd },
        { 0xab, 0xcd, 0x12, 0x34 }, { 0xcd, 0xab, 0x34, 0x12 },
    };
    const hl_tex none = { 0 };
    const uint32_t word = 0xabcd1234u;
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (int i = 0; i < 4; i++) {
        hl_tex t = fixed_target(&m, HL_FORMAT_RG16_FIXED32, 1, 1, true,
                                (enum hl_endian)i);
        struct pe_view v = pk_view(&m, t);
        float out[4];
        pk_draw(&m, t, none, &word);
        pk_assert_bytes(&m, t, rows[i], 4);
        pe_fetch(&v, 0, 0, 0, out);
        assert_true(out[0] == (float)(0x1234 / 32767.0));
        assert_true(out[1] == (float)((0xabcd - 65536) / 32767.0));
    }
    ck_close(&m);
}

static void depth_resolves_raw(void **state)
{
    static const enum hl_format formats[] = { HL_FORMAT_D24_UNORM_S8,
                                              HL_FORMAT_D24_FLOAT_S8 };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (int i = 0; i < 2; i++) {
        struct hl_tex_desc d = pk_desc(formats[i], 1, 1, 2);
        const float z[2] = { 0.1f, 1 };
        const uint8_t stencil[2] = { 0x77, 1 };
        uint32_t code;
        float out[4];
        d.console.endian = HL_ENDIAN_8IN32;
        hl_tex t = pk_make(&m, &d);
        pk_draw_depth(&m, t, z, stencil);
        pe_depth_encode(formats[i], z, 1, &code);
        pk_assert_bytes(&m, t, (const uint8_t[]){ (uint8_t)(code >> 16),
                     (uint8_t)(code >> 8), (uint8_t)code, 0x77 }, 4);
        struct pe_view v = pk_view(&m, t);
        pe_fetch(&v, 0, 0, 0, out);
        assert_true(out[0] == pe_depth_decode(formats[i], code));
        assert_true(out[1] == out[0] && out[2] == out[0] && out[3] == 1);
    }
    ck_close(&m);
}

/* What is discarded stays in EDRAM, and depth that is only read is not copied
 * again: memory keeps what it had. */
static void only_what_is_kept_is_resolved(void **state)
{
    const struct hl_rect rect = { 0, 0, 1, 1 };
    const uint32_t word = 0x01020304u, one = 0x11223344u;
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 1, 1, 1);
    hl_tex c = pk_make(&m, &d);
    d.format = HL_FORMAT_D24_UNORM_S8;
    hl_tex z = pk_make(&m, &d);
    for (int kept = 0; kept < 3; kept++) {
        struct hl_bk_pass p;
        memset(&p, 0, sizeof p);
        p.n_colors = 1;
        p.color[0].slot = pk_slot(c);
        p.color[0].resolve = HL_NO_SLOT;
        p.depth.slot = pk_slot(z);
        p.color[0].discard = kept != 2;
        p.depth.discard = kept == 0;
        p.depth_read_only = kept == 1;
        pe_store_color(pk_state(&m), pk_slot(c), &rect, &word);
        pe_store_color(pk_state(&m), pk_slot(z), &rect, &one);
        pe_resolve(pk_state(&m), &p, &rect);
        assert_int_equal(pk_texture(&m, c)->memory[0], kept == 2 ? 4 : 0);
        assert_int_equal(pk_texture(&m, z)->memory[0], kept == 2 ? 0x44 : 0);
    }
    ck_close(&m);
}

/* Narrow texels are parts of the words that are swapped; bytes past the last
 * texel fill its word. */
static void narrow_texels_are_swapped_in_their_words(void **state)
{
    static const uint8_t rows[4][2][8] = {
        { { 1, 2, 3, 4, 5 }, { 1, 2, 3, 4, 5, 6 } },
        { { 2, 1, 4, 3, 0, 5 }, { 2, 1, 4, 3, 6, 5 } },
        { { 4, 3, 2, 1, 0, 0, 0, 5 }, { 4, 3, 2, 1, 0, 0, 6, 5 } },
        { { 3, 4, 1, 2, 0, 0, 5 }, { 3, 4, 1, 2, 0, 0, 5, 6 } },
    };
    static const uint8_t data[6] = { 1, 2, 3, 4, 5, 6 };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (int i = 0; i < 8; i++) {
        struct hl_tex_desc d = pk_desc(i & 1 ? HL_FORMAT_RG8_UNORM
                                             : HL_FORMAT_R8_UNORM,
                                       i & 1 ? 3 : 5, 1, 1);
        const struct hl_rect rect = { 0, 0, (int32_t)d.width, 1 };
        uint32_t words[5], back[5];
        d.console.endian = (uint8_t)(i / 2);
        hl_tex t = pk_make(&m, &d);
        assert_int_equal(hl_tex_write(m.device, t, 0, data, i & 1 ? 6 : 5),
                         HL_OK);
        assert_memory_equal(pk_texture(&m, t)->memory, rows[i / 2][i & 1], 8);
        pe_load_color(pk_state(&m), pk_slot(t), &rect, words);
        for (uint32_t k = 0; k < d.width; k++)
            assert_int_equal(words[k], i & 1 ? 0x201 + 0x202 * k : k + 1);
        memset(pk_texture(&m, t)->memory, 0, 8);
        pe_store_color(pk_state(&m), pk_slot(t), &rect, words);
        assert_memory_equal(pk_texture(&m, t)->memory, rows[i / 2][i & 1], 8);
        pe_load_color(pk_state(&m), pk_slot(t), &rect, back);
        assert_memory_equal(words, back, d.width * sizeof *words);
    }
    ck_close(&m);
}

static void a_bias_scales_what_is_resolved(void **state)
{
    const hl_tex none = { 0 };
    const uint32_t word = 0xff804020u;
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 1, 1, 1);
    d.console.resolve_exp_bias = -1;
    hl_tex t = pk_make(&m, &d);
    pk_draw(&m, t, none, &word);
    pk_assert_bytes(&m, t, (const uint8_t[]){ 0x10, 0x20, 0x40, 0x80 }, 4);
    d.console.resolve_exp_bias = 1;
    t = pk_make(&m, &d);
    pk_draw(&m, t, none, &word);
    pk_assert_bytes(&m, t, (const uint8_t[]){ 0x40, 0x80, 0xff, 0xff }, 4);
    ck_close(&m);
}

/* Bits that no encoder makes: a half float's NaN. */
static void equal_encodings_resolve_raw(void **state)
{
    const hl_tex none = { 0 };
    const uint32_t words[2] = { 0x7c01fc00u, 0x80007fffu };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA16_FLOAT, 1, 1, 1);
    d.console.endian = HL_ENDIAN_8IN16;
    hl_tex t = pk_make(&m, &d);
    pk_draw(&m, t, none, words);
    pk_assert_bytes(&m, t, (const uint8_t[]){ 0xfc, 0, 0x7c, 1, 0x7f, 0xff,
                 0x80, 0 }, 8);
    ck_close(&m);
}

/* Same encodings go as bits: 7e3 is not read through 2_10_10_10. */
static void floats_of_ten_bits_resolve_raw(void **state)
{
    const hl_tex none = { 0 };
    const uint32_t word = 3u << 30 | 0x180u << 20 | 0x07fu << 10 | 0x3ff;
    struct ck_machine m;
    float out[4];
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGB10A2_FLOAT, 1, 1, 1);
    hl_tex t = pk_make(&m, &d);
    struct pe_view v = pk_view(&m, t);
    pk_draw(&m, t, none, &word);
    pe_fetch(&v, 0, 0, 0, out);
    assert_true(out[0] == 31.875f && out[1] == 0.248046875f && out[2] == 1 &&
                out[3] == 1);
    ck_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_trick_keeps_the_bits_of_the_table),
        cmocka_unit_test(the_trick_is_worth_what_is_said),
        cmocka_unit_test(the_trick_is_the_identity_on_bits),
        cmocka_unit_test(swaps_are_those_of_the_table),
        cmocka_unit_test(depth_resolves_raw),
        cmocka_unit_test(only_what_is_kept_is_resolved),
        cmocka_unit_test(narrow_texels_are_swapped_in_their_words),
        cmocka_unit_test(a_bias_scales_what_is_resolved),
        cmocka_unit_test(equal_encodings_resolve_raw),
        cmocka_unit_test(floats_of_ten_bits_resolve_raw),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
