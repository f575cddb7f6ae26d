/* SPDX-License-Identifier: Zlib */
/* packemu's EDRAM against spec/consoles.md 1.1: sizes, places, addresses; and
 * the bytes of PlayStation 3 textures, 2.4 and 2.5. */
#include <string.h>
#include "tests/packemu_kit.h"

/* ---- EDRAM: spec/consoles.md 1.1 --------------------------------------- */

static void edram_surfaces_have_the_sizes_of_the_table(void **state)
{
    static const struct {
        uint32_t w, h, samples;
        enum hl_format format;
        uint32_t tiles, pitch;
    } rows[] = {
        { 1, 1, 1, HL_FORMAT_RGBA8_UNORM, 1, 1 },
        { 80, 16, 4, HL_FORMAT_RGBA8_UNORM, 4, 2 },
        { 256, 256, 1, HL_FORMAT_RGBA8_UNORM, 64, 4 },
        { 800, 450, 1, HL_FORMAT_RG16_FIXED32, 290, 10 },
        { 800, 450, 1, HL_FORMAT_RGBA16_FIXED32, 580, 20 },
        { 960, 540, 1, HL_FORMAT_D24_UNORM_S8, 408, 12 },
        { 960, 540, 1, HL_FORMAT_RGBA16_FLOAT, 816, 24 },
        { 1280, 720, 1, HL_FORMAT_RGBA8_UNORM, 720, 16 },
        { 1280, 720, 2, HL_FORMAT_RGBA8_UNORM, 1440, 16 },
        { 1280, 720, 4, HL_FORMAT_RGBA8_UNORM, 2880, 32 },
        { 1280, 720, 1, HL_FORMAT_RGBA16_FIXED32, 1440, 32 },
        { 640, 480, 4, HL_FORMAT_D24_FLOAT_S8, 960, 16 },
        { 1120, 720, 2, HL_FORMAT_RGB10A2_FLOAT, 1260, 14 },
    };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_tex_desc d = pk_desc(rows[i].format, rows[i].w, rows[i].h,
                                       rows[i].samples);
        uint32_t pitch, count;
        pe_edram_size(pk_state(&m), &d, &pitch, &count);
        assert_int_equal(count, rows[i].tiles);
        assert_int_equal(pitch, rows[i].pitch);
    }
    ck_close(&m);
}

/* 800x450 needs no sharing; 1280x720 does not fit, and the message says by
 * how much. */
static void edram_is_given_out_first_fit(void **state)
{
    struct ck_machine m;
    hl_tex t[4], more;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 800, 450, 1);
    for (int i = 0; i < 3; i++) {
        t[i] = pk_make(&m, &d);
        assert_int_equal(pk_texture(&m, t[i])->tile, 290 * i);
    }
    d.format = HL_FORMAT_RGBA16_FIXED32;
    t[3] = pk_make(&m, &d);
    assert_int_equal(pk_texture(&m, t[3])->tile, 870);
    d = pk_desc(HL_FORMAT_RGBA8_UNORM, 1280, 720, 1);
    CK_REFUSED(&m, hl_tex_create(m.device, &more, &d), HL_ERR_MEMORY,
               HL_MSG_MEMORY, "720 EDRAM tiles are needed in one piece; of "
               "2048 there are free 598");
    hl_tex_destroy(m.device, &t[1]);
    d = pk_desc(HL_FORMAT_RGBA8_UNORM, 80, 16, 1);
    more = pk_make(&m, &d);
    assert_int_equal(pk_texture(&m, more)->tile, 290);
    /* Asked for by number: on top of what is there. */
    d.console.edram_tile = 1 + 870;
    more = pk_make(&m, &d);
    assert_int_equal(pk_texture(&m, more)->tile, 870);
    /* Not a target: not there. */
    d = pk_desc(HL_FORMAT_RGBA8_UNORM, 80, 16, 0);
    more = pk_make(&m, &d);
    assert_int_equal(pk_texture(&m, more)->tile_count, 0);
    ck_close(&m);
}

/* Only read by tile tests: targets that nobody samples or reads back. */
static hl_tex edram_target(struct ck_machine *m, enum hl_format f, uint32_t w,
                           uint32_t h, uint32_t samples, uint32_t tile)
{
    struct hl_tex_desc d = pk_desc(f, w, h, samples);
    d.usage = HL_TEX_TARGET;
    d.console.edram_tile = (uint16_t)(tile + 1);
    hl_tex t = pk_make(m, &d);
    assert_null(pk_texture(m, t)->memory);
    return t;
}

/* Where spec/consoles.md says that a sample's word is, from its own terms. */
static uint32_t address(const struct pe_texture *t, uint32_t x, uint32_t y,
                        uint32_t sample, uint32_t word)
{
    uint32_t n = t->desc.samples, two = t->words == 2;
    uint32_t sx = n == 4 ? 2 * x + (sample >> 1) : x;
    uint32_t sy = n == 4 ? 2 * y + (sample & 1) : n == 2 ? 2 * y + sample : y;
    uint32_t per = 80 >> two, column = sx / per, in = (sx % per) << two;
    uint32_t pitch = (t->desc.width * (n == 4 ? 2 : 1) + 79) / 80 << two;
    if (hl_format_info(t->desc.format)->kind == HL_KIND_DEPTH)
        in = in < 40 ? in + 40 : in - 40;
    return (t->tile + sy / 16 * pitch + column) % 2048 * 1280 +
           sy % 16 * 80 + in + word;
}

static void edram_words_are_where_the_addresses_say(void **state)
{
    static const struct { enum hl_format f; uint32_t samples, tile; } rows[] = {
        { HL_FORMAT_RGBA8_UNORM, 1, 3 }, { HL_FORMAT_RGBA8_UNORM, 2, 2040 },
        { HL_FORMAT_RGBA8_UNORM, 4, 0 }, { HL_FORMAT_RGBA16_FIXED32, 1, 2047 },
        { HL_FORMAT_RGBA16_FIXED32, 2, 7 }, { HL_FORMAT_RGBA16_FIXED32, 4, 9 },
    };
    enum { W = 170, H = 37 };
    static uint32_t words[W * H * 8], back[W * H * 8];
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    for (uint32_t i = 0; i < W * H * 8; i++)
        words[i] = i * 2654435761u;
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        hl_tex t = edram_target(&m, rows[k].f, W, H, rows[k].samples,
                                rows[k].tile);
        const struct pe_texture *p = pk_texture(&m, t);
        const struct hl_rect rect = { 0, 0, W, H }, part = { 77, 11, 9, 8 };
        const uint32_t *e = pk_state(&m)->edram;
        uint32_t at = 0;
        pe_store_color(pk_state(&m), pk_slot(t), &rect, words);
        for (uint32_t i = 0; i < W * H; i++)
            for (uint32_t s = 0; s < rows[k].samples; s++)
                for (uint32_t w = 0; w < p->words; w++, at++)
                    assert_int_equal(e[address(p, i % W, i / W, s, w)],
                                     words[at]);
        pe_load_color(pk_state(&m), pk_slot(t), &part, back);
        uint32_t per = rows[k].samples * p->words;
        for (uint32_t y = 0; y < 8; y++)
            assert_memory_equal(back + y * 9 * per,
                                words + ((y + 11) * W + 77) * per,
                                9 * per * sizeof *back);
        hl_tex_destroy(m.device, &t);
    }
    ck_close(&m);
}

/* Depth and colour on the same tiles see each other's words, halves of tiles
 * swapped. */
static void edram_is_shared_by_what_lies_on_it(void **state)
{
    enum { W = 100, H = 20 };
    static uint32_t words[W * H], codes[W * H];
    static uint8_t stencil[W * H];
    const struct hl_rect rect = { 0, 0, W, H };
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    hl_tex color = edram_target(&m, HL_FORMAT_RGBA8_UNORM, W, H, 1, 2046);
    hl_tex depth = edram_target(&m, HL_FORMAT_D24_UNORM_S8, W, H, 1, 2046);
    hl_tex other = edram_target(&m, HL_FORMAT_RGBA8_UNORM, W, H, 1, 0);
    const struct pe_texture *p = pk_texture(&m, depth);
    for (uint32_t i = 0; i < W * H; i++) {
        codes[i] = i * 257;
        stencil[i] = (uint8_t)i;
    }
    pe_store_depth(pk_state(&m), pk_slot(depth), &rect, codes, stencil);
    for (uint32_t i = 0; i < W * H; i++)
        assert_int_equal(pk_state(&m)->edram[address(p, i % W, i / W, 0, 0)],
                         codes[i] << 8 | stencil[i]);
    pe_load_color(pk_state(&m), pk_slot(color), &rect, words);
    for (uint32_t x = 0; x < 40; x++)
        assert_int_equal(words[x], codes[x + 40] << 8 | stencil[x + 40]);
    /* Rows from 16 on have wrapped to tile 0. */
    pe_load_color(pk_state(&m), pk_slot(other), &rect, words);
    for (uint32_t x = 0; x < 40; x++)
        assert_int_equal(words[x + 40], codes[16 * W + x] << 8 |
                                        stencil[16 * W + x]);
    ck_close(&m);
}

/* ---- PlayStation 3: spec/consoles.md 2.4, 2.5 -------------------------- */

/* x and y as 16-bit numbers in four bytes of colour, as the shader's
 * unpack(pack(x, y)).zyxw writes them. */
static void ps3_pairs_are_bytes_of_colour(void **state)
{
    static const struct { float x, y; uint8_t bytes[4]; } rows[] = {
        { 0, 0, { 0, 0, 0, 0 } }, { 1, 0, { 0, 0, 0xff, 0xff } },
        { 0, 1, { 0xff, 0xff, 0, 0 } }, { 0.5f, 0.25f, { 0x40, 0, 0x80, 0 } },
        { 0x1234 / 65535.0f, 0xabcd / 65535.0f, { 0xab, 0xcd, 0x12, 0x34 } },
    };
    struct ck_machine m;
    const hl_tex none = { 0 };
    (void)state;
    pk_open(&m, &hl_profile_ps3);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        for (int swapped = 0; swapped < 2; swapped++) {
            struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 1, 1, 1);
            uint32_t x = (uint32_t)(rows[i].x * 65535.0f + 0.5f);
            uint32_t y = (uint32_t)(rows[i].y * 65535.0f + 0.5f);
            d.sample_as = HL_FORMAT_RG16_UNORM;
            d.console.remap = swapped ? 0xaa4e : 0;
            hl_tex t = pk_make(&m, &d);
            float out[4], r = (float)(y & 255) / 255, g = (float)(x >> 8) / 255,
                  b = (float)(x & 255) / 255, a = (float)(y >> 8) / 255;
            const float *const rgba[4] = { &r, &g, &b, &a };
            uint32_t word;
            pe_encode(HL_FORMAT_RGBA8_UNORM, rgba, 1, &word);
            pk_draw(&m, t, none, &word);
            pk_assert_bytes(&m, t, rows[i].bytes, 4);
            struct pe_view v = pk_view(&m, t);
            pe_fetch(&v, 0, 0, 0, out);
            assert_true(out[swapped] == (float)(y / 65535.0));
            assert_true(out[!swapped] == (float)(x / 65535.0));
            hl_tex_destroy(m.device, &t);
        }
    ck_close(&m);
}

/* Out A, R, G, B of the table, X = 1 and Y = 0. */
static void ps3_pairs_are_remapped_by_the_table(void **state)
{
    static const struct { uint16_t remap; float argb[4]; } rows[] = {
        { 0, { 1, 0, 1, 0 } }, { 0xaae4, { 1, 0, 1, 0 } },
        { 0xaa4e, { 0, 1, 0, 1 } }, { 0xaaee, { 1, 1, 1, 1 } },
        { 0xaa44, { 0, 0, 0, 0 } }, { 0xa9e4, { 1, 0, 1, 0 } },
        { 0x68e4, { 0, 0, 1, 1 } },
    };
    struct ck_machine m;
    const uint8_t data[4] = { 0, 0xff, 0xff, 0 };    /* R G B A              */
    (void)state;
    pk_open(&m, &hl_profile_ps3);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_tex_desc d = pk_desc(HL_FORMAT_RGBA8_UNORM, 1, 1, 0);
        d.sample_as = HL_FORMAT_RG16_UNORM;
        d.console.remap = rows[i].remap;
        hl_tex t = pk_make(&m, &d);
        float out[4];
        assert_int_equal(hl_tex_write(m.device, t, 0, data, 4), HL_OK);
        struct pe_view v = pk_view(&m, t);
        pe_fetch(&v, 0, 0, 0, out);
        /* 0xa9: A is one whatever its source; 0x68: B one, A zero.          */
        assert_true(out[0] == rows[i].argb[1]);
        assert_true(out[1] == rows[i].argb[2]);
        assert_true(out[2] == rows[i].argb[3]);
        assert_true(out[3] == rows[i].argb[0]);
        hl_tex_destroy(m.device, &t);
    }
    ck_close(&m);
}

static void ps3_refuses_other_remaps(void **state)
{
    struct ck_machine m;
    hl_tex t;
    (void)state;
    pk_open(&m, &hl_profile_ps3);
    struct hl_tex_desc d = pk_desc(HL_FORMAT_R8_UNORM, 1, 1, 0);
    d.console.remap = 0xaa1b;
    CK_REFUSED(&m, hl_tex_create(m.device, &t, &d), HL_ERR_UNSUPPORTED,
               HL_MSG_FORMAT, "console.remap");
    d.console.remap = 0xaae4;
    CK_ALLOWED(&m, hl_tex_create(m.device, &t, &d));
    ck_close(&m);
}

static void ps3_memory_is_big_endian(void **state)
{
    static const struct {
        enum hl_format format;
        uint32_t words[2];
        uint8_t bytes[8];
    } rows[] = {
        { HL_FORMAT_R8_UNORM, { 0x12 }, { 0x12 } },
        { HL_FORMAT_RG8_UNORM, { 0x3412 }, { 0x12, 0x34 } },
        { HL_FORMAT_RGBA8_UNORM, { 0x78563412u }, { 0x78, 0x12, 0x34, 0x56 } },
        { HL_FORMAT_RGBA8_SRGB, { 0x78563412u }, { 0x78, 0x12, 0x34, 0x56 } },
        { HL_FORMAT_RGBA16_FLOAT, { 0x56781234u, 0xdef09abcu },
          { 0x12, 0x34, 0x56, 0x78, 0x9a, 0xbc, 0xde, 0xf0 } },
        { HL_FORMAT_R32_FLOAT, { 0x12345678u }, { 0x12, 0x34, 0x56, 0x78 } },
    };
    struct ck_machine m;
    const hl_tex none = { 0 };
    (void)state;
    pk_open(&m, &hl_profile_ps3);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_tex_desc d = pk_desc(rows[i].format, 1, 1, 1);
        hl_tex t = pk_make(&m, &d);
        pk_draw(&m, t, none, rows[i].words);
        pk_assert_bytes(&m, t, rows[i].bytes,
                     hl_format_info(rows[i].format)->bytes);
        hl_tex_destroy(m.device, &t);
    }
    ck_close(&m);
}

/* Z24S8 as colour: BARG, and what the default remap gives by mistake. */
static void ps3_depth_is_read_as_bytes(void **state)
{
    static const struct { uint16_t remap; uint8_t rgba[4]; } rows[] = {
        { 0xaa93, { 0x12, 0x34, 0x56, 0x9b } },
        { 0, { 0x34, 0x56, 0x9b, 0x12 } },
    };
    static const uint8_t bytes[4] = { 0x12, 0x34, 0x56, 0x9b };
    const float z = (float)(0x123456 / 16777215.0);
    const uint8_t stencil = 0x9b;
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_ps3);
    for (size_t i = 0; i < 2; i++) {
        struct hl_tex_desc d = pk_desc(HL_FORMAT_D24_UNORM_S8, 1, 1, 1);
        d.sample_as = HL_FORMAT_RGBA8_UNORM;
        d.console.remap = rows[i].remap;
        hl_tex t = pk_make(&m, &d);
        float out[4];
        pk_draw_depth(&m, t, &z, &stencil);
        pk_assert_bytes(&m, t, bytes, 4);
        struct pe_view v = pk_view(&m, t);
        pe_fetch(&v, 0, 0, 0, out);
        for (int c = 0; c < 4; c++)
            assert_true(out[c] == (float)(rows[i].rgba[c] / 255.0));
        assert_int_equal(hl_tex_read(m.device, t, out, 4), HL_OK);
        assert_true(out[0] == z);
    }
    ck_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edram_surfaces_have_the_sizes_of_the_table),
        cmocka_unit_test(edram_is_given_out_first_fit),
        cmocka_unit_test(edram_words_are_where_the_addresses_say),
        cmocka_unit_test(edram_is_shared_by_what_lies_on_it),
        cmocka_unit_test(ps3_pairs_are_bytes_of_colour),
        cmocka_unit_test(ps3_pairs_are_remapped_by_the_table),
        cmocka_unit_test(ps3_refuses_other_remaps),
        cmocka_unit_test(ps3_memory_is_big_endian),
        cmocka_unit_test(ps3_depth_is_read_as_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
