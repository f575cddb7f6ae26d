/* SPDX-License-Identifier: Zlib */
/* The profiles' rules in plans: formats, scales and how they are said, each
 * reason where it holds and not where it nearly does. */
#include <math.h>
#include <string.h>
#include "core/pipe.h"
#include "tests/console_kit.h"

static const struct hl_profile *const profiles[] = {
    &hl_profile_native, &hl_profile_dx10, &hl_profile_xbox360,
    &hl_profile_ps3 };

static struct hl_plan planned(const struct hl_profile *profile, bool memory,
                              const struct hl_needs *n)
{
    struct hl_caps c;
    con_caps(&c, profile, memory);
    return con_plan(HL_PIPELINE_INFERRED, n, &c);
}

static void check_target(const struct hl_plan *p, enum hl_role role,
                         enum hl_format format, enum hl_format sample_as)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    assert_non_null(t);
    assert_int_equal(t->format, format);
    assert_int_equal(t->sample_as, sample_as);
}

static enum hl_refusal refusal(const struct hl_profile *profile, bool memory,
                               enum hl_pipeline want,
                               const struct hl_needs *n)
{
    struct hl_caps c;
    struct hl_plan p;
    enum hl_refusal why;
    con_caps(&c, profile, memory);
    hl_plan_make(&p, want, n, &c, &why);
    return why;
}

/* ---- profiles ----------------------------------------------------------- */

static void profiles_are_found_by_name(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        assert_ptr_equal(hl_profile_at((uint32_t)i), profiles[i]);
        assert_ptr_equal(hl_profile_find(profiles[i]->name), profiles[i]);
    }
    assert_null(hl_profile_at(4));
    assert_null(hl_profile_find("ps"));
    assert_null(hl_profile_find(""));
}

/* No rules: the plan of a machine without a profile, in every byte. */
static void native_changes_nothing(void **state)
{
    (void)state;
    for (int i = 0; i < HL_PIPELINE_COUNT; i++) {
        struct hl_needs n = con_needs();
        struct hl_caps bare, native;
        ck_lavapipe(&bare);
        native = bare;
        native.profile = hl_profile_native;
        struct hl_plan a = con_plan((enum hl_pipeline)i, &n, &bare);
        struct hl_plan b = con_plan((enum hl_pipeline)i, &n, &native);
        assert_memory_equal(&a, &b, sizeof a);
        assert_string_equal(a.profile, "native");
        assert_true(a.id_steps == 65535);
    }
}

/* ---- Xbox 360 ----------------------------------------------------------- */

static void xbox_keeps_fixed_point_in_edram(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.specular = HL_NEED_EXPONENTS;
    struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
    check_target(&p, HL_ROLE_NORMAL, HL_FORMAT_RG16_FIXED32, HL_FORMAT_NONE);
    check_target(&p, HL_ROLE_DSF, HL_FORMAT_RG16_FIXED32, HL_FORMAT_NONE);
    check_target(&p, HL_ROLE_LIGHT, HL_FORMAT_RGBA16_FIXED32,
                 HL_FORMAT_NONE);
    check_target(&p, HL_ROLE_COLOR, HL_FORMAT_RGB10A2_FLOAT, HL_FORMAT_NONE);
    check_target(&p, HL_ROLE_LIGHT_DEPTH, HL_FORMAT_D24_FLOAT_S8,
                 HL_FORMAT_NONE);
    check_target(&p, HL_ROLE_EXPONENT, HL_FORMAT_R32_FLOAT, HL_FORMAT_NONE);
    assert_true(p.two16 == HL_TWO16_FIXED32 && p.id_steps == 65534);
    assert_true(p.reversed_depth && p.float_taps);
    static const enum hl_role fixed[] = { HL_ROLE_NORMAL, HL_ROLE_DSF,
                                          HL_ROLE_LIGHT };
    for (int i = 0; i < 3; i++) {
        const struct hl_console *c = &hl_plan_target(&p, fixed[i])->console;
        assert_int_equal(c->resolve_exp_bias, -5);
        assert_int_equal(c->resolve_number, HL_NUMBER_SIGNED);
        assert_int_equal(c->color_exp_bias, 0);
    }
    /* Half a step of 65,534; one of 65,535 would be 1.5e-5 less. */
    ck_near((double)hl_plan_target(&p, HL_ROLE_DSF)->error, 50.0 / 65534,
            50.0 / 65534 * 1e-6);
    const struct hl_plan_reason *r = con_reason(&p, HL_WHY_TWO16_FIXED32);
    assert_true(r->arg[1] == 65535 && r->arg[2] == 1025 && r->arg[3] == -5);
}

static void xbox_stand_ins_have_the_same_steps(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_plan a = planned(&hl_profile_xbox360, true, &n);
    struct hl_plan b = planned(&hl_profile_xbox360, false, &n);
    check_target(&b, HL_ROLE_NORMAL, HL_FORMAT_RG16_SNORM, HL_FORMAT_NONE);
    check_target(&b, HL_ROLE_LIGHT, HL_FORMAT_RGBA16_UNORM, HL_FORMAT_NONE);
    check_target(&b, HL_ROLE_COLOR, HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_NONE);
    assert_int_equal(b.two16, HL_TWO16_SIGNED);
    /* A step of what is written, as light: (32 / 32767) / out and
     * (1 / 65535) / out, equal but for rounding of a few ulps. */
    double step = 32.0 / 32767 / (double)a.light_out;
    ck_near(step, 20.0 / 32767, 1e-9);
    ck_near(1.0 / 65535 / (double)b.light_out, step, step * 1e-6);
    ck_near((double)a.light_error, (double)b.light_error, 1e-9);
    assert_true(a.light_scale == 20);
    /* What is written comes back: out x range / sampled x scale = 1. */
    ck_near((double)(a.light_out * a.light_scale), 32.0, 1e-5);
    ck_near((double)(b.light_out * b.light_scale), 1.0, 1e-6);
    ck_near((double)hl_plan_target(&a, HL_ROLE_NORMAL)->error,
            (double)hl_plan_target(&b, HL_ROLE_NORMAL)->error, 1e-9);
}

/* Half a step a blend, at an eighth of the peak: n / 2 x 8 / 32767. */
static void fixed_light_errs_by_half_steps(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.batch = 1;
    n.lights_per_pixel = 30;
    struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
    ck_near((double)p.light_error, 31 * 4.0 / 32767, 1e-7);
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGBA16_FIXED32, 31),
            31 * 4.0 / 32767, 1e-7);
    /* 8 bits of significand, either rounding: 2^-7 (n + 1) / 2. */
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGB10A2_FLOAT, 1),
            1.0 / 128, 1e-9);
    /* 65,534 steps from -1 to 1, as 16-bit SNORM. */
    assert_true(hl_normal_error(HL_FORMAT_RG16_FIXED32) ==
                hl_normal_error(HL_FORMAT_RG16_SNORM));
}

/* peak, lights, and what the range then ends at. */
static void a_fixed_range_is_bounded(void **state)
{
    static const struct {
        float peak;
        uint32_t lights;
        float ends;
        enum hl_reason why;
    } rows[] = {
        { 20, HL_LIGHTS_SMOOTH, 20, HL_WHY_NONE },
        { 5000, HL_LIGHTS_SMOOTH, 5000, HL_WHY_NONE },
        { 0, HL_LIGHTS_SMOOTH, 32, HL_WHY_LIGHT_PEAK_DEFAULT },
        { 0, HL_LIGHTS_INVERSE_SQUARE, 32, HL_WHY_LIGHT_PEAK_DEFAULT },
        { 20, HL_LIGHTS_INVERSE_SQUARE, 20, HL_WHY_NONE },
        { 32, HL_LIGHTS_INVERSE_SQUARE, 32, HL_WHY_NONE },
        { 33, HL_LIGHTS_INVERSE_SQUARE, 32, HL_WHY_LIGHT_PEAK_CUT },
        { 20000, HL_LIGHTS_INVERSE_SQUARE, 32, HL_WHY_LIGHT_PEAK_CUT },
        { 50000, 3, 80, HL_WHY_LIGHT_PEAK_CUT },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_needs n = con_needs();
        n.peak = rows[i].peak;
        n.lights = rows[i].lights;
        struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
        assert_true(p.light_scale == rows[i].ends);
        assert_true(con_reason(&p, HL_WHY_LIGHT_RANGE)->arg[0] ==
                    rows[i].ends);
        static const enum hl_reason both[] = { HL_WHY_LIGHT_PEAK_DEFAULT,
                                               HL_WHY_LIGHT_PEAK_CUT };
        for (int k = 0; k < 2; k++)
            assert_true((con_reason(&p, both[k]) != NULL) ==
                        (both[k] == rows[i].why));
    }
    struct hl_needs n = con_needs();
    n.peak = 50000;
    n.lights = HL_LIGHTS_INVERSE_SQUARE;
    struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
    /* 50000 = 5 / 0.01^2; 80 = 5 / 0.25^2. */
    ck_near((double)con_reason(&p, HL_WHY_LIGHT_PEAK_CUT)->arg[3], 0.25,
            1e-6);
}

static void what_does_not_blend_is_not_taken(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    for (int memory = 0; memory < 2; memory++) {
        static const struct {
            const struct hl_profile *profile;
            enum hl_format asked;
            bool on_console, elsewhere;
        } rows[] = {
            { &hl_profile_xbox360, HL_FORMAT_RGBA16_FLOAT, false, false },
            { &hl_profile_xbox360, HL_FORMAT_RGBA16_FIXED32, true, false },
            { &hl_profile_xbox360, HL_FORMAT_RGBA16_UNORM, false, true },
            { &hl_profile_xbox360, HL_FORMAT_RGBA8_UNORM, true, true },
            { &hl_profile_ps3, HL_FORMAT_RGBA16_FLOAT, true, true },
            { &hl_profile_ps3, HL_FORMAT_RGBA32_FLOAT, false, false },
            { &hl_profile_dx10, HL_FORMAT_RGBA16_UNORM, false, false },
        };
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            bool can = memory ? rows[i].on_console : rows[i].elsewhere;
            n.light_format = rows[i].asked;
            assert_int_equal(refusal(rows[i].profile, memory,
                                     HL_PIPELINE_INFERRED, &n),
                             can ? HL_REFUSED_NOTHING
                                 : HL_REFUSED_LIGHT_FORMAT);
        }
    }
    struct hl_caps c;
    struct hl_plan p;
    con_caps(&c, &hl_profile_xbox360, true);
    n.light_format = HL_FORMAT_RGBA16_FLOAT;
    hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, NULL);
    assert_true(con_reason(&p, HL_WHY_NOT_BLENDABLE)->arg[0] ==
                (float)HL_FORMAT_RGBA16_FLOAT);
    n.light_format = HL_FORMAT_RGBA16_UNORM;     /* blends, but is not there */
    hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, NULL);
    assert_null(con_reason(&p, HL_WHY_NOT_BLENDABLE));
    /* Forward pipelines add to 7e3, or to nothing. */
    p = con_plan(HL_PIPELINE_FORWARD, &n, &c);
    check_target(&p, HL_ROLE_COLOR, HL_FORMAT_RGB10A2_FLOAT, HL_FORMAT_NONE);
    assert_non_null(con_reason(&p, HL_WHY_COLOR_STEP));
    c.format[HL_FORMAT_RGB10A2_FLOAT].use &= (uint8_t)~HL_USE_BLEND;
    enum hl_refusal why;
    hl_plan_make(&p, HL_PIPELINE_FORWARD, &n, &c, &why);
    assert_int_equal(why, HL_REFUSED_COLOR_FORMAT);
}

/* Where the device takes blending of half floats away with the console's
 * name, the frame still blends. */
static void a_stand_in_frame_blends(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    con_caps(&c, &hl_profile_xbox360, false);
    struct hl_plan p = con_plan(HL_PIPELINE_FORWARD, &n, &c);
    check_target(&p, HL_ROLE_COLOR, HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_NONE);
    c.format[HL_FORMAT_RGBA16_FLOAT].use &= (uint8_t)~HL_USE_BLEND;
    p = con_plan(HL_PIPELINE_FORWARD, &n, &c);
    check_target(&p, HL_ROLE_COLOR, HL_FORMAT_RG11B10_FLOAT, HL_FORMAT_NONE);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_COLOR)->edram_tiles, 720);
}

/* ---- resolves ----------------------------------------------------------- */

static void what_is_read_is_resolved_first(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.specular = HL_NEED_EXPONENTS;
    n.light_depth_bound = true;
    struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
    struct hl_profile reads = hl_profile_xbox360;
    reads.resolve_to_read = false;
    reads.edram_tiles = 0;
    struct hl_plan q = planned(&reads, true, &n);
    assert_null(con_reason(&q, HL_WHY_RESOLVE));
    uint32_t readers = 0, said = 0;
    double bytes = 0;
    for (uint32_t i = 0; i < p.n_targets; i++) {
        readers += p.target[i].read_by != 0;
        bytes += p.target[i].read_by ? (double)p.target[i].bytes : 0;
    }
    for (uint32_t i = 0; i < p.n_reasons; i++) {
        const struct hl_plan_reason *r = &p.reason[i];
        if (r->why != HL_WHY_RESOLVE)
            continue;
        said++;
        bool light = r->arg[0] == (float)HL_ROLE_LIGHT;
        assert_true(r->arg[1] == (float)(light ? HL_PASS_LIGHT
                                               : HL_PASS_GEOMETRY));
        assert_true(r->arg[1] < r->arg[2]);
    }
    assert_true(readers == 5 && said == 5);
    /* Single precision of about 80 bytes. */
    ck_near((double)(p.moved_per_pixel - q.moved_per_pixel),
            bytes / (1280 * 720), 1e-4);
}

/* ---- pixel centres ------------------------------------------------------ */

static void either_state_or_vertices_shift(void **state)
{
    static const struct {
        enum hl_half_pixel asked, got;
        enum hl_reason why;
    } rows[] = {
        { HL_HALF_PIXEL_AUTO, HL_HALF_PIXEL_STATE, HL_WHY_HALF_PIXEL_STATE },
        { HL_HALF_PIXEL_STATE, HL_HALF_PIXEL_STATE, HL_WHY_HALF_PIXEL_STATE },
        { HL_HALF_PIXEL_VERTEX, HL_HALF_PIXEL_VERTEX,
          HL_WHY_HALF_PIXEL_VERTEX },
        { HL_HALF_PIXEL_NONE, HL_HALF_PIXEL_NONE, HL_WHY_HALF_PIXEL_NONE },
    };
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct hl_needs n = con_needs();
        bool shifts = rows[i].asked == HL_HALF_PIXEL_STATE ||
                      rows[i].asked == HL_HALF_PIXEL_VERTEX;
        n.half_pixel = rows[i].asked;
        struct hl_plan p = planned(&hl_profile_xbox360, true, &n);
        assert_int_equal(p.half_pixel, rows[i].got);
        assert_non_null(con_reason(&p, rows[i].why));
        for (int k = 0; k < 4; k++) {
            bool memory = profiles[k] != &hl_profile_xbox360;
            for (int w = 1; w < HL_PIPELINE_COUNT; w++)
                assert_int_equal(refusal(profiles[k], memory,
                                         (enum hl_pipeline)w, &n),
                                 shifts ? HL_REFUSED_HALF_PIXEL
                                        : HL_REFUSED_NOTHING);
        }
    }
    struct hl_needs n = con_needs();
    struct hl_plan p = planned(&hl_profile_xbox360, false, &n);
    assert_int_equal(p.half_pixel, HL_HALF_PIXEL_AUTO);
    assert_non_null(con_reason(&p, HL_WHY_HALF_PIXEL_HERE));
    p = planned(&hl_profile_ps3, true, &n);
    assert_null(con_reason(&p, HL_WHY_HALF_PIXEL_HERE));
    n.half_pixel = (enum hl_half_pixel)4;
    assert_int_equal(refusal(&hl_profile_xbox360, true, HL_PIPELINE_FORWARD,
                             &n), HL_REFUSED_VALUE);
}

/* ---- PlayStation 3 ------------------------------------------------------ */

static void ps3_packs_pairs_in_bytes(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.specular = HL_NEED_EXPONENTS;
    for (int memory = 0; memory < 2; memory++) {
        struct hl_plan p = planned(&hl_profile_ps3, memory, &n);
        check_target(&p, HL_ROLE_NORMAL, HL_FORMAT_RGBA8_UNORM,
                     HL_FORMAT_RG16_UNORM);
        check_target(&p, HL_ROLE_DSF, HL_FORMAT_RGBA8_UNORM,
                     HL_FORMAT_RG16_UNORM);
        check_target(&p, HL_ROLE_EXPONENT, HL_FORMAT_RGBA8_UNORM,
                     HL_FORMAT_NONE);
        assert_int_equal(p.two16, memory ? HL_TWO16_BYTES_ARGB
                                         : HL_TWO16_BYTES);
        assert_int_equal(hl_plan_target(&p, HL_ROLE_NORMAL)->console.remap,
                         memory ? 0xAA4E : 0);
        assert_int_equal(hl_plan_target(&p, HL_ROLE_EXPONENT)->console.remap,
                         0);
        ck_near((double)hl_plan_target(&p, HL_ROLE_NORMAL)->error, 0.0035,
                0.00002);
        assert_true(p.id_steps == 65535 && p.float_taps);
        assert_false(p.reversed_depth);
        assert_true((con_reason(&p, HL_WHY_TWO16_BYTES_ARGB) != NULL) ==
                    memory);
        assert_true((con_reason(&p, HL_WHY_TWO16_BYTES) != NULL) == !memory);
        assert_non_null(con_reason(&p, HL_WHY_MRT_FORMAT));
        for (int i = 0; i < 3; i++)
            assert_int_equal(hl_plan_target(&p, p.pass[0].color[i])->format,
                             HL_FORMAT_RGBA8_UNORM);
    }
}

static void ps3_reads_depth_through_barg(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_plan p = planned(&hl_profile_ps3, true, &n);
    check_target(&p, HL_ROLE_LIGHT_DEPTH, HL_FORMAT_D24_UNORM_S8,
                 HL_FORMAT_RGBA8_UNORM);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH)->console.remap,
                     0xAA93);
    assert_int_equal(p.depth_read, HL_DEPTH_READ_BARG);
    assert_non_null(con_reason(&p, HL_WHY_DEPTH_BARG));
    /* The frame's depth is tested, not read. */
    check_target(&p, HL_ROLE_DEPTH, HL_FORMAT_D24_UNORM_S8, HL_FORMAT_NONE);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_DEPTH)->console.remap, 0);
    p = planned(&hl_profile_ps3, false, &n);
    check_target(&p, HL_ROLE_LIGHT_DEPTH, HL_FORMAT_D24_UNORM_S8,
                 HL_FORMAT_NONE);
    assert_int_equal(p.depth_read, HL_DEPTH_READ_FLOAT);
    assert_non_null(con_reason(&p, HL_WHY_DEPTH_PLAIN));
    assert_null(con_reason(&p, HL_WHY_DEPTH_BARG));
}

/* One format for all targets: an exponent that has none is not stored. */
static void an_mrt_set_has_one_format(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_profile mixed = hl_profile_ps3;
    n.specular = HL_NEED_EXPONENTS;
    memset(mixed.scalar, 0, sizeof mixed.scalar);
    mixed.scalar[0].format = HL_FORMAT_R16_UNORM;
    struct hl_plan p = planned(&mixed, true, &n);
    assert_null(hl_plan_target(&p, HL_ROLE_EXPONENT));
    assert_int_equal(p.specular, HL_SPECULAR_CONSTANT);
    struct hl_profile empty = mixed;             /* the planner's choice     */
    empty.scalar[0].format = HL_FORMAT_NONE;
    p = planned(&empty, true, &n);
    assert_null(hl_plan_target(&p, HL_ROLE_EXPONENT));
    mixed.scalar[1].format = HL_FORMAT_RGBA8_UNORM;
    p = planned(&mixed, true, &n);
    check_target(&p, HL_ROLE_EXPONENT, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_NONE);
    mixed.one_mrt_format = false;
    p = planned(&mixed, true, &n);
    check_target(&p, HL_ROLE_EXPONENT, HL_FORMAT_R16_UNORM, HL_FORMAT_NONE);
    assert_null(con_reason(&p, HL_WHY_MRT_FORMAT));
}

/* ---- decals ------------------------------------------------------------- */

static void decals_follow_the_normals(void **state)
{
    static const struct {
        int profile;
        bool memory;
        enum hl_decals decals;
        enum hl_reason why;
    } rows[] = {
        { 0, false, HL_DECALS_BLEND_NORMALS, HL_WHY_DECALS_BLEND },
        { 1, false, HL_DECALS_BLEND_NORMALS, HL_WHY_DECALS_BLEND },
        { 2, true, HL_DECALS_BLEND_NORMALS, HL_WHY_DECALS_BLEND },
        { 2, false, HL_DECALS_ALPHA_OBJECTS, HL_WHY_DECALS_NO_BLEND },
        { 3, true, HL_DECALS_ALPHA_OBJECTS, HL_WHY_DECALS_PACKED },
        { 3, false, HL_DECALS_ALPHA_OBJECTS, HL_WHY_DECALS_PACKED },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_needs n = con_needs();
        const struct hl_profile *profile = profiles[rows[i].profile];
        struct hl_plan p = planned(profile, rows[i].memory, &n);
        assert_int_equal(p.decals, HL_DECALS_NONE);
        assert_null(con_reason(&p, rows[i].why));
        n.decals = true;
        p = planned(profile, rows[i].memory, &n);
        assert_int_equal(p.decals, rows[i].decals);
        assert_non_null(con_reason(&p, rows[i].why));
        struct hl_caps c;
        con_caps(&c, profile, rows[i].memory);
        p = con_plan(HL_PIPELINE_FORWARD, &n, &c);
        assert_int_equal(p.decals, HL_DECALS_ALPHA_OBJECTS);
        assert_non_null(con_reason(&p, HL_WHY_DECALS_FORWARD));
    }
}

/* ---- Direct3D 10 -------------------------------------------------------- */

static const struct hl_plan_pass *pass_of(const struct hl_plan *p,
                                          enum hl_pass_role role)
{
    for (uint32_t i = 0; i < p->n_passes; i++)
        if (p->pass[i].role == role)
            return &p->pass[i];
    return NULL;
}

static void depth_is_copied_only_while_it_is_tested(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_plan p = planned(&hl_profile_dx10, false, &n);
    check_target(&p, HL_ROLE_LIGHT_DEPTH, HL_FORMAT_D24_UNORM_S8,
                 HL_FORMAT_NONE);
    assert_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
    assert_null(pass_of(&p, HL_PASS_DEPTH_COPY));
    assert_non_null(con_reason(&p, HL_WHY_DEPTH_IN_PLACE));
    assert_int_equal(pass_of(&p, HL_PASS_LIGHT)->depth, HL_ROLE_NONE);
    float before = p.moved_per_pixel;

    n.light_depth_bound = true;
    p = planned(&hl_profile_dx10, false, &n);
    check_target(&p, HL_ROLE_DEPTH_COPY, HL_FORMAT_R32_FLOAT, HL_FORMAT_NONE);
    const struct hl_plan_target *copy = hl_plan_target(&p,
                                                       HL_ROLE_DEPTH_COPY);
    assert_int_equal(copy->read_by, 1 << HL_PASS_LIGHT);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH)->read_by,
                     1 << HL_PASS_DEPTH_COPY);
    assert_int_equal(p.pass[1].role, HL_PASS_DEPTH_COPY);
    assert_int_equal(p.pass[1].color[0], HL_ROLE_DEPTH_COPY);
    const struct hl_plan_pass *l = pass_of(&p, HL_PASS_LIGHT);
    assert_true(l->depth == HL_ROLE_LIGHT_DEPTH && l->depth_read_only);
    assert_non_null(con_reason(&p, HL_WHY_DEPTH_COPY));
    assert_null(con_reason(&p, HL_WHY_DEPTH_IN_PLACE));
    /* Written and read: 8 bytes of 25/64 of the pixels. */
    ck_near((double)(p.moved_per_pixel - before), 8 * 25 / 64.0, 1e-4);

    p = planned(&hl_profile_native, false, &n);
    assert_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
    l = pass_of(&p, HL_PASS_LIGHT);
    assert_true(l->depth == HL_ROLE_LIGHT_DEPTH && l->depth_read_only);
    assert_non_null(con_reason(&p, HL_WHY_DEPTH_READ_ONLY));
    /* EDRAM's depth is tested while its resolved copy is read. */
    p = planned(&hl_profile_xbox360, true, &n);
    assert_null(con_reason(&p, HL_WHY_DEPTH_READ_ONLY));
    assert_null(con_reason(&p, HL_WHY_DEPTH_COPY));

    struct hl_caps c;
    con_caps(&c, &hl_profile_dx10, false);
    c.format[HL_FORMAT_R32_FLOAT].use = HL_USE_SAMPLED;
    struct hl_plan q;
    enum hl_refusal why;
    hl_plan_make(&q, HL_PIPELINE_INFERRED, &n, &c, &why);
    assert_int_equal(why, HL_REFUSED_DEPTH_FORMAT);
    n.light_depth_bound = false;
    con_plan(HL_PIPELINE_INFERRED, &n, &c);
}

/* ---- lists -------------------------------------------------------------- */

static void the_first_usable_row_is_taken(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    con_caps(&c, &hl_profile_dx10, false);
    c.format[HL_FORMAT_D24_UNORM_S8].use = 0;
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    check_target(&p, HL_ROLE_LIGHT_DEPTH, HL_FORMAT_D32_FLOAT,
                 HL_FORMAT_NONE);
    assert_true(p.reversed_depth);
    c.format[HL_FORMAT_D32_FLOAT].use = 0;       /* D16 is not in the list   */
    c.format[HL_FORMAT_D32_FLOAT_S8].use = 0;
    enum hl_refusal why;
    hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, &why);
    assert_int_equal(why, HL_REFUSED_DEPTH_FORMAT);
    c.format[HL_FORMAT_D32_FLOAT_S8].use = HL_USE_SAMPLED | HL_USE_TARGET;
    assert_true(con_plan(HL_PIPELINE_FORWARD, &n, &c).reversed_depth);
    con_caps(&c, &hl_profile_xbox360, false);
    c.format[HL_FORMAT_RG16_SNORM].use = HL_USE_SAMPLED;
    hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, &why);
    assert_int_equal(why, HL_REFUSED_NORMAL_FORMAT);
    hl_plan_make(&p, HL_PIPELINE_FORWARD, &n, &c, &why);
    assert_int_equal(why, HL_REFUSED_NOTHING);
}

static void sample_counts_are_the_profiles(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++)
        for (uint32_t s = 1; s <= 8; s *= 2) {
            struct hl_needs n = con_needs();
            uint32_t mask = profiles[i]->samples;
            n.width = 320;
            n.height = 180;
            n.samples = s;
            assert_int_equal(refusal(profiles[i], i > 1, HL_PIPELINE_FORWARD,
                                     &n),
                             !mask || mask & s ? HL_REFUSED_NOTHING
                                               : HL_REFUSED_SAMPLES);
        }
}

static void stand_ins_are_named(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_plan p = planned(&hl_profile_xbox360, false, &n);
    uint32_t said = 0;
    for (uint32_t i = 0; i < p.n_reasons; i++)
        said += p.reason[i].why == HL_WHY_STAND_IN;
    assert_int_equal(said, 4);           /* pairs, light, colour, depth      */
    for (int i = 0; i < 4; i++) {
        p = planned(profiles[i], true, &n);
        assert_null(con_reason(&p, HL_WHY_STAND_IN));
    }
    p = planned(&hl_profile_native, false, &n);
    assert_null(con_reason(&p, HL_WHY_FLOAT_TAPS));
    assert_int_equal(hl_plan_target(&p, HL_ROLE_DSF)->sample_as,
                     HL_FORMAT_R32_UINT);
    p = planned(&hl_profile_dx10, false, &n);
    assert_non_null(con_reason(&p, HL_WHY_FLOAT_TAPS));
    assert_non_null(con_reason(&p, HL_WHY_LIGHT_FORMAT_PROFILE));
    assert_null(con_reason(&p, HL_WHY_NO_BLEND));
    assert_null(con_reason(&p, HL_WHY_ID_STEPS));
    n.light_path = HL_LIGHT_PATH_TILES;
    p = planned(&hl_profile_xbox360, true, &n);
    assert_non_null(con_reason(&p, HL_WHY_NO_BLEND));
    assert_non_null(con_reason(&p, HL_WHY_ID_STEPS));
    n.light_path = HL_LIGHT_PATH_LISTS;          /* adds in the shader       */
    p = planned(&hl_profile_xbox360, true, &n);
    assert_null(con_reason(&p, HL_WHY_NO_BLEND));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(profiles_are_found_by_name),
        cmocka_unit_test(native_changes_nothing),
        cmocka_unit_test(xbox_keeps_fixed_point_in_edram),
        cmocka_unit_test(xbox_stand_ins_have_the_same_steps),
        cmocka_unit_test(fixed_light_errs_by_half_steps),
        cmocka_unit_test(a_fixed_range_is_bounded),
        cmocka_unit_test(what_does_not_blend_is_not_taken),
        cmocka_unit_test(a_stand_in_frame_blends),
        cmocka_unit_test(what_is_read_is_resolved_first),
        cmocka_unit_test(either_state_or_vertices_shift),
        cmocka_unit_test(ps3_packs_pairs_in_bytes),
        cmocka_unit_test(ps3_reads_depth_through_barg),
        cmocka_unit_test(an_mrt_set_has_one_format),
        cmocka_unit_test(decals_follow_the_normals),
        cmocka_unit_test(depth_is_copied_only_while_it_is_tested),
        cmocka_unit_test(the_first_usable_row_is_taken),
        cmocka_unit_test(sample_counts_are_the_profiles),
        cmocka_unit_test(stand_ins_are_named),
    };
    return cmocka_run_group_tests_name("consoles", tests, NULL, NULL);
}
