/* SPDX-License-Identifier: Zlib */
/* What hal makes of a profile: caps, and every console field of textures,
 * programs and passes once refused and once taken; on a null device that
 * claims a console's memory, and on one that stands in for it. */
#include <math.h>
#include <string.h>
#include "platforms/null/hl_null.h"
#include "tests/check.h"

/* ---- machines ----------------------------------------------------------- */

static struct hl_profile box(void)
{
    struct hl_profile p = {
        .name = "box", .samples = 1 | 2,
        .no_blend = { HL_FORMAT_RGBA16_FLOAT }, .edram_tiles = 100,
        .edram_tile_width = 80, .edram_tile_height = 16,
        .resolve_to_read = true, .integer_centers = true, .big_endian = true
    };
    return p;
}

static struct hl_profile station(void)
{
    struct hl_profile p = {
        .name = "station", .one_mrt_format = true, .big_endian = true,
        .depth = { { .format = HL_FORMAT_D24_UNORM_S8,
                     .sample_as = HL_FORMAT_RGBA8_UNORM } }
    };
    return p;
}

static enum hl_result try_open(struct ck_machine *m,
                               const struct hl_profile *profile, bool memory)
{
    static struct hl_caps caps;
    static struct hl_null_native native;
    ck_lavapipe(&caps);
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        caps.format[i].use |= HL_USE_SAMPLED | HL_USE_TARGET;
        caps.format[i].samples = 1 | 2 | 4;
    }
    caps.samples = 1 | 2 | 4;
    caps.console_memory = memory;
    memset(&native, 0, sizeof native);
    native.caps = &caps;
    memset(m, 0, sizeof *m);
    struct hl_device_desc d = ck_desc(m);
    d.native = &native;
    d.profile = profile;
    return hl_device_open(&m->device, &hl_backend_null, &d);
}

static void open_on(struct ck_machine *m, const struct hl_profile *profile,
                    bool memory)
{
    assert_int_equal(try_open(m, profile, memory), HL_OK);
}

/* ---- profiles ----------------------------------------------------------- */

static void profiles_are_kept_and_laid_on_caps(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_profile p = box();
    open_on(&m, &p, false);
    p.name[0] = 'x';                 /* borrowed for the call only           */
    const struct hl_caps *c = hl_device_caps(m.device);
    assert_string_equal(c->profile.name, "box");
    assert_false(c->console_memory);
    assert_int_equal(c->samples, 1 | 2);
    assert_int_equal(c->format[HL_FORMAT_RGBA8_UNORM].samples, 1 | 2);
    /* A stand-in's half floats may stand for a console's blended format. */
    assert_true(c->format[HL_FORMAT_RGBA16_FLOAT].use & HL_USE_BLEND);
    ck_close(&m);
    p = box();
    open_on(&m, &p, true);
    c = hl_device_caps(m.device);
    assert_false(c->format[HL_FORMAT_RGBA16_FLOAT].use & HL_USE_BLEND);
    assert_true(c->format[HL_FORMAT_RGBA16_FLOAT].use & HL_USE_TARGET);
    assert_true(c->format[HL_FORMAT_RGBA16_UNORM].use & HL_USE_BLEND);
    ck_close(&m);
    open_on(&m, NULL, false);
    c = hl_device_caps(m.device);
    assert_string_equal(c->profile.name, "native");
    assert_int_equal(c->samples, 1 | 2 | 4);
    assert_true(c->format[HL_FORMAT_RGBA16_FLOAT].use & HL_USE_BLEND);
    ck_close(&m);
}

#define PROFILE_BAD(change, part)                                            \
    do {                                                                     \
        struct ck_machine m_;                                                \
        struct hl_profile p = box();                                         \
        change;                                                              \
        assert_int_equal(try_open(&m_, &p, true), HL_ERR_INVALID);           \
        ck_refused(&m_, 0, HL_MSG_ARGUMENT, part);                           \
        assert_null(m_.device);                                              \
        assert_int_equal(m_.memory.n_live, 0);                               \
    } while (0)

static void bad_profiles_are_refused(void **state)
{
    (void)state;
    PROFILE_BAD(p.name[0] = 0, "name");
    PROFILE_BAD(memset(p.name, 'n', sizeof p.name), "name");
    PROFILE_BAD(p.samples = 2, "samples");
    PROFILE_BAD(p.two16[0].console.edram_tile = 1, "EDRAM tile");
    PROFILE_BAD(p.light[0].range = NAN, "range");
    PROFILE_BAD(p.light[0].range = 1, "samples as");
    PROFILE_BAD(p.id_steps = -1, "id_steps");
    PROFILE_BAD(p.edram_tiles = 65536, "edram_tiles");
    PROFILE_BAD(p.edram_tile_width = 0, "edram_tiles");
    PROFILE_BAD(p.light[1].format = HL_FORMAT_COUNT, "format");
    PROFILE_BAD(p.depth[3].sample_as = HL_FORMAT_COUNT, "format");
    PROFILE_BAD(p.no_blend[7] = HL_FORMAT_COUNT, "no_blend");
}

/* ---- textures ----------------------------------------------------------- */

struct row {
    struct hl_console console;
    enum hl_format format, sample_as;
    uint32_t usage;
    const char *part;                /* NULL: taken                          */
};

static void try_rows(const struct hl_profile *p, bool memory,
                     const struct row *row, size_t n)
{
    struct ck_machine m;
    open_on(&m, p, memory);
    for (size_t i = 0; i < n; i++) {
        struct hl_tex_desc d = {
            .format = row[i].format, .sample_as = row[i].sample_as,
            .width = 160, .height = 32, .console = row[i].console,
            .usage = row[i].usage ? row[i].usage
                                  : HL_TEX_TARGET | HL_TEX_SAMPLED };
        hl_tex t;
        if (!row[i].part)
            CK_ALLOWED(&m, hl_tex_create(m.device, &t, &d));
        else
            CK_REFUSED(&m, hl_tex_create(m.device, &t, &d), HL_ERR_INVALID,
                       row[i].sample_as ? m.last_id : HL_MSG_ARGUMENT,
                       row[i].part);
    }
    ck_close(&m);
}

#define ROWS(p, memory, row) try_rows(p, memory, row, sizeof row / sizeof *row)

static void console_fields_of_edram_machines(void **state)
{
    (void)state;
    struct hl_profile p = box();
    const enum hl_format f = HL_FORMAT_RGBA8_UNORM;
    const struct row row[] = {
        { { .edram_tile = 0 }, f, 0, 0, NULL },
        { { .edram_tile = 1 }, f, 0, 0, NULL },
        { { .edram_tile = 100 }, f, 0, 0, NULL },
        { { .edram_tile = 101 }, f, 0, 0, "past the EDRAM" },
        { { .edram_tile = 1 }, f, 0, HL_TEX_SAMPLED, "for targets" },
        { { .color_exp_bias = 31, .resolve_exp_bias = -32 }, f, 0, 0, NULL },
        { { .color_exp_bias = 32 }, f, 0, 0, "-32..31" },
        { { .color_exp_bias = -33 }, f, 0, 0, "-32..31" },
        { { .resolve_exp_bias = 32 }, f, 0, 0, "-32..31" },
        { { .resolve_exp_bias = -33 }, f, 0, 0, "-32..31" },
        { { .resolve_number = HL_NUMBER_SIGNED, .endian = HL_ENDIAN_16IN32 },
          f, 0, 0, NULL },
        { { .resolve_number = HL_NUMBER_SIGNED + 1 }, f, 0, 0, "its enum" },
        { { .endian = HL_ENDIAN_16IN32 + 1 }, f, 0, 0, "its enum" },
        { { .remap = 0xAAE4 }, f, 0, 0, "does not remap" },
    };
    ROWS(&p, true, row);
    /* 160 x 32 is 2 x 2 tiles, twice that for 64 bits. */
    assert_int_equal(hl_edram_tiles(&p, f, 160, 32, 1), 4);
    assert_int_equal(hl_edram_tiles(&p, HL_FORMAT_RGBA16_UNORM, 160, 32, 1),
                     8);
    p.edram_tiles = 3;
    const struct row large[] = {
        { { .edram_tile = 1 }, f, 0, 0, "larger than the EDRAM" },
    };
    ROWS(&p, true, large);
}

/* The table of spec/consoles 1.1. */
static void edram_tiles_are_as_published(void **state)
{
    (void)state;
    static const struct { uint32_t w, h, samples, wide, tiles; } row[] = {
        { 1, 1, 1, 0, 1 }, { 80, 16, 4, 0, 4 }, { 256, 256, 1, 0, 64 },
        { 800, 450, 1, 0, 290 }, { 800, 450, 1, 1, 580 },
        { 960, 540, 1, 0, 408 }, { 960, 540, 1, 1, 816 },
        { 1280, 720, 1, 0, 720 }, { 1280, 720, 2, 0, 1440 },
        { 1280, 720, 4, 0, 2880 }, { 1280, 720, 1, 1, 1440 },
        { 640, 480, 4, 0, 960 }, { 1120, 720, 2, 0, 1260 }
    };
    struct hl_profile p = box();
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        assert_int_equal(hl_edram_tiles(&p, row[i].wide
                                            ? HL_FORMAT_RGBA16_FIXED32
                                            : HL_FORMAT_RG16_FIXED32,
                                        row[i].w, row[i].h, row[i].samples),
                         row[i].tiles);
    p.edram_tiles = 0;
    assert_int_equal(hl_edram_tiles(&p, HL_FORMAT_R32_FLOAT, 9, 9, 1), 0);
}

static void console_fields_of_remapping_machines(void **state)
{
    (void)state;
    struct hl_profile p = station();
    const enum hl_format f = HL_FORMAT_RGBA8_UNORM;
    const enum hl_format two = HL_FORMAT_RG16_UNORM;
    const struct row row[] = {
        { { .remap = 0xAAE4 }, f, 0, 0, NULL },
        { { .remap = 0xAA93 }, f, 0, 0, NULL },
        { { .remap = 0xEA93 }, f, 0, 0, "zero, one or remap" },
        { { .remap = 0xAA4E }, f, two, 0, NULL },
        { { .remap = 0xAA44 }, f, two, 0, NULL },
        { { .remap = 0xAAEE }, f, two, 0, NULL },
        { { .remap = 0xAA93 }, f, two, 0, "E4, 4E, EE or 44" },
        { { .remap = 0xAAE4 }, HL_FORMAT_RGBA16_FLOAT, 0, 0, NULL },
        { { .remap = 0xAA93 }, HL_FORMAT_RGBA16_FLOAT, 0, 0, "floating" },
        { { .edram_tile = 1 }, f, 0, 0, "past the EDRAM" },
        { { .endian = HL_ENDIAN_8IN32 }, f, 0, 0, "does not resolve" },
        { { .resolve_exp_bias = 1 }, f, 0, 0, "does not resolve" },
    };
    ROWS(&p, true, row);
}

static void stand_ins_have_no_console_memory(void **state)
{
    (void)state;
    struct hl_profile a = box(), b = station();
    const enum hl_format f = HL_FORMAT_RGBA8_UNORM;
    const struct row none[] = {
        { { .edram_tile = 0 }, f, 0, 0, NULL },
        { { .edram_tile = 1 }, f, 0, 0, "does not keep memory" },
        { { .color_exp_bias = 1 }, f, 0, 0, "does not keep memory" },
        { { .resolve_exp_bias = 1 }, f, 0, 0, "does not keep memory" },
        { { .resolve_number = 1 }, f, 0, 0, "does not keep memory" },
        { { .endian = 1 }, f, 0, 0, "does not keep memory" },
    };
    const struct row remap[] = {
        { { .remap = 0xAAE4 }, f, 0, 0, "does not keep memory" },
    };
    ROWS(&a, false, none);
    ROWS(&b, false, remap);
}

/* A surface of 80 x 32 takes 2 tiles. */
static void targets_of_one_pass_share_no_tile(void **state)
{
    (void)state;
    const struct { uint16_t a, b; bool good; } row[] = {
        { 1, 3, true }, { 1, 2, false }, { 2, 1, false }, { 1, 1, false },
        { 100, 2, true }, { 100, 1, false }, { 1, 100, false },
        { 99, 1, true }, { 0, 1, true },
    };
    struct hl_profile p = box();
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct ck_machine m;
        hl_tex t[2];
        open_on(&m, &p, true);
        struct hl_tex_desc d = { .width = 80, .height = 32,
                                 .usage = HL_TEX_TARGET };
        d.console.edram_tile = row[i].a;
        assert_int_equal(hl_tex_create(m.device, &t[0], &d), HL_OK);
        d.console.edram_tile = row[i].b;
        assert_int_equal(hl_tex_create(m.device, &t[1], &d), HL_OK);
        struct hl_pass pass = { .n_colors = 2 };
        pass.color[0].tex = t[0];
        pass.color[1].tex = t[1];
        enum hl_result r = hl_pass_run(m.device, &pass);
        assert_int_equal(r, row[i].good ? HL_OK : HL_ERR_INVALID);
        if (!row[i].good)
            ck_refused(&m, 0, HL_MSG_ARGUMENT, "same EDRAM tiles");
        hl_tex_destroy(m.device, &t[0]);
        hl_tex_destroy(m.device, &t[1]);
        ck_close(&m);
    }
}

static void depth_is_sampled_as_listed_pairs_only(void **state)
{
    (void)state;
    struct hl_profile p = station();
    const enum hl_format z = HL_FORMAT_D24_UNORM_S8;
    const struct row row[] = {
        { { .remap = 0xAA93 }, z, HL_FORMAT_RGBA8_UNORM, 0, NULL },
        { { 0 }, z, HL_FORMAT_RG16_UNORM, 0, "not a colour format" },
        { { 0 }, HL_FORMAT_D32_FLOAT, HL_FORMAT_RGBA8_UNORM, 0,
          "not a colour format" },
        { { 0 }, HL_FORMAT_RGBA8_UNORM, z, 0, "not a colour format" },
    };
    const struct row stand_in[] = {
        { { 0 }, z, HL_FORMAT_RGBA8_UNORM, 0, "not a colour format" },
    };
    ROWS(&p, true, row);
    ROWS(&p, false, stand_in);
}

/* ---- programs ----------------------------------------------------------- */

static struct hl_prog_desc program(void)
{
    struct hl_prog_desc p = {
        .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_COUNT_FRAG, NULL }, .n_colors = 2,
        .color = { HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGBA8_UNORM },
        .depth = HL_FORMAT_D24_UNORM_S8
    };
    return p;
}

#define PROG(m, change, result, id, part)                                    \
    do {                                                                     \
        struct hl_prog_desc p = program();                                   \
        hl_prog out_;                                                        \
        change;                                                              \
        if ((result) == HL_OK)                                               \
            CK_ALLOWED(m, hl_prog_create((m)->device, &out_, &p));           \
        else                                                                 \
            CK_REFUSED(m, hl_prog_create((m)->device, &out_, &p), result,    \
                       id, part);                                            \
    } while (0)

static void colour_formats_may_have_to_agree(void **state)
{
    (void)state;
    struct hl_profile s = station();
    struct ck_machine m;
    open_on(&m, &s, true);
    PROG(&m, (void)p, HL_OK, 0, "");
    PROG(&m, p.color[1] = HL_FORMAT_RG16_UNORM, HL_ERR_UNSUPPORTED,
         HL_MSG_FORMAT, "one for all");
    ck_close(&m);
    open_on(&m, &s, false);
    PROG(&m, p.color[1] = HL_FORMAT_RG16_UNORM, HL_OK, 0, "");
    ck_close(&m);
}

static void stencil_and_shift_are_checked(void **state)
{
    (void)state;
    const enum hl_stencil_op past = (enum hl_stencil_op)(HL_STENCIL_INVERT + 1);
    struct ck_machine m;
    open_on(&m, NULL, false);
#define BAD(change, part) \
    PROG(&m, change, HL_ERR_INVALID, HL_MSG_ARGUMENT, part)
#define FINE(change) PROG(&m, change, HL_OK, 0, "")
    struct hl_stencil s = { .front = { .test = HL_COMPARE_ALWAYS,
                                       .pass = HL_STENCIL_REPLACE } };
    FINE(p.stencil = s);
    BAD((p.stencil = s, p.stencil.back.fail = HL_STENCIL_ZERO), "a test");
    BAD((p.stencil = s, p.stencil.front.test = HL_COMPARE_OFF), "a test");
    BAD((p.stencil = s, p.depth = HL_FORMAT_D32_FLOAT), "with stencil");
    BAD((p.stencil = s, p.depth = HL_FORMAT_NONE), "with stencil");
    BAD(p.stencil.front.test = (enum hl_compare)(HL_COMPARE_ALWAYS + 1),
        "hl_prog_desc.stencil: not one");
    BAD(p.stencil.front.fail = past, "hl_prog_desc.stencil: not one");
    BAD(p.stencil.front.depth_fail = past, "hl_prog_desc.stencil: not one");
    BAD(p.stencil.back.pass = past, "hl_prog_desc.stencil: not one");
    FINE(p.blend = HL_BLEND_SHIFT);
    FINE((p.blend = HL_BLEND_SHIFT, p.blend_constant = -2));
    FINE((p.blend = HL_BLEND_ADD, p.blend_constant = NAN));
    BAD((p.blend = HL_BLEND_SHIFT, p.blend_constant = NAN), "finite");
    BAD((p.blend = HL_BLEND_SHIFT, p.blend_constant = INFINITY), "finite");
    BAD(p.blend = (enum hl_blend)(HL_BLEND_SHIFT + 1), "hl_prog_desc.blend");
    ck_close(&m);
}

/* ---- passes ------------------------------------------------------------- */

static hl_tex depth_target(struct ck_machine *m)
{
    struct hl_tex_desc d = { .format = HL_FORMAT_D24_UNORM_S8, .width = 4,
                             .height = 4,
                             .usage = HL_TEX_TARGET | HL_TEX_SAMPLED };
    hl_tex t;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    return t;
}

static void passes_keep_to_profiles(void **state)
{
    (void)state;
    struct hl_profile b = box();
    struct ck_machine m;
    for (int k = 0; k < 2; k++) {
        open_on(&m, k ? &b : NULL, true);
        struct hl_pass p = { .label = "p", .depth = {
            .tex = depth_target(&m), .load = HL_LOAD_CLEAR } };
        CK_ALLOWED(&m, hl_pass_run(m.device, &p));
        p.depth.clear[1] = 255;
        CK_ALLOWED(&m, hl_pass_run(m.device, &p));
        p.depth.clear[1] = 256;
        CK_REFUSED(&m, hl_pass_run(m.device, &p), HL_ERR_INVALID,
                   HL_MSG_ARGUMENT, "0..255");
        p.depth.clear[1] = NAN;
        CK_REFUSED(&m, hl_pass_run(m.device, &p), HL_ERR_INVALID,
                   HL_MSG_ARGUMENT, "0..255");
        p.depth.clear[1] = 0;
        p.half_pixel_offset = true;
        if (k)
            CK_ALLOWED(&m, hl_pass_run(m.device, &p));
        else
            CK_REFUSED(&m, hl_pass_run(m.device, &p), HL_ERR_INVALID,
                       HL_MSG_ARGUMENT, "half_pixel_offset");
        ck_close(&m);
    }
}

/* A draw in a pass whose depth target is bound read only. */
static struct hl_pass read_only(struct ck_machine *m, struct hl_draw *draw,
                                struct hl_texture_binding *binding,
                                struct hl_prog_desc *p)
{
    struct hl_pass pass = { .label = "p", .depth_read_only = true,
                            .draws = draw, .n_draws = 1 };
    pass.depth.tex = depth_target(m);
    p->n_colors = 0;
    memset(draw, 0, sizeof *draw);
    memset(binding, 0, sizeof *binding);
    assert_int_equal(hl_prog_create(m->device, &draw->prog, p), HL_OK);
    draw->count = 3;
    draw->textures = binding;
    draw->n_textures = 1;
    return pass;
}

static void bound_depth_may_be_unreadable(void **state)
{
    (void)state;
    struct hl_profile ten = { .name = "ten", .depth_copy_if_bound = true };
    struct hl_draw draw;
    struct hl_texture_binding binding;
    for (int k = 0; k < 2; k++) {
        struct ck_machine m;
        struct hl_prog_desc p = program();
        open_on(&m, k ? &ten : NULL, false);
        struct hl_pass pass = read_only(&m, &draw, &binding, &p);
        CK_ALLOWED(&m, hl_pass_run(m.device, &pass));
        binding.tex = pass.depth.tex;
        if (k)
            CK_REFUSED(&m, hl_pass_run(m.device, &pass), HL_ERR_INVALID,
                       HL_MSG_ARGUMENT, "its own pass");
        else
            CK_ALLOWED(&m, hl_pass_run(m.device, &pass));
        ck_close(&m);
    }
}

static void read_only_depth_keeps_its_stencil(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_draw draw;
    struct hl_texture_binding binding;
    struct hl_prog_desc p = program();
    open_on(&m, NULL, false);
    p.stencil.front.test = p.stencil.back.test = HL_COMPARE_EQUAL;
    struct hl_pass pass = read_only(&m, &draw, &binding, &p);
    CK_ALLOWED(&m, hl_pass_run(m.device, &pass));
    p.stencil.back.depth_fail = HL_STENCIL_INCREMENT;
    pass = read_only(&m, &draw, &binding, &p);
    CK_REFUSED(&m, hl_pass_run(m.device, &pass), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "other targets");
    ck_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(profiles_are_kept_and_laid_on_caps),
        cmocka_unit_test(bad_profiles_are_refused),
        cmocka_unit_test(console_fields_of_edram_machines),
        cmocka_unit_test(edram_tiles_are_as_published),
        cmocka_unit_test(console_fields_of_remapping_machines),
        cmocka_unit_test(stand_ins_have_no_console_memory),
        cmocka_unit_test(targets_of_one_pass_share_no_tile),
        cmocka_unit_test(depth_is_sampled_as_listed_pairs_only),
        cmocka_unit_test(colour_formats_may_have_to_agree),
        cmocka_unit_test(stencil_and_shift_are_checked),
        cmocka_unit_test(passes_keep_to_profiles),
        cmocka_unit_test(bound_depth_may_be_unreadable),
        cmocka_unit_test(read_only_depth_keeps_its_stencil),
    };
    return cmocka_run_group_tests_name("consoles", tests, NULL, NULL);
}
