/* SPDX-License-Identifier: Zlib */
/* What a plan knows of formats: which L-buffers and normals it takes and
 * why, what their bytes and their nanoseconds come to, and what a plan for no
 * lights says of neither. */
#include <math.h>
#include <string.h>
#include "core/pipe.h"
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

static struct hl_needs usual(void)
{
    struct hl_needs n = { .width = 1280, .height = 720, .n_objects = 100,
                          .n_triangles = 50000, .n_lights = 200,
                          .lights_per_pixel = 12, .lights_per_object = 30,
                          .lights = HL_LIGHTS_SMOOTH, .far = 100, .peak = 20,
                          .light_path = HL_LIGHT_PATH_TILES };
    return n;
}

static struct hl_plan planned(const struct hl_needs *n,
                              const struct hl_caps *c)
{
    struct hl_plan p;
    enum hl_refusal why;
    if (hl_plan_make(&p, HL_PIPELINE_INFERRED, n, c, &why) != HL_OK)
        fail_msg("refused: %d", (int)why);
    return p;
}

static void check_refused(const struct hl_needs *n, const struct hl_caps *c,
                          enum hl_refusal want)
{
    struct hl_plan p;
    enum hl_refusal why;
    assert_true(hl_plan_make(&p, HL_PIPELINE_INFERRED, n, c, &why) != HL_OK);
    assert_int_equal(why, want);
}

/* Its argument; fails where there is no such reason. */
static float argument(const struct hl_plan *p, enum hl_reason why, int i)
{
    for (uint32_t k = 0; k < p->n_reasons; k++)
        if (p->reason[k].why == why)
            return p->reason[k].arg[i];
    fail_msg("no reason %d", (int)why);
    return 0;
}

static bool has_reason(const struct hl_plan *p, enum hl_reason why)
{
    for (uint32_t k = 0; k < p->n_reasons; k++)
        if (p->reason[k].why == why)
            return true;
    return false;
}

static enum hl_format format_of(const struct hl_plan *p, enum hl_role role)
{
    return hl_plan_target(p, role)->format;
}

/* ---- light -------------------------------------------------------------- */

static const struct { enum hl_format f, words; uint32_t bits; double bytes; }
lights[] = {
    { HL_FORMAT_RGBA8_UNORM, HL_FORMAT_R32_UINT, HL_BITS_UNORM8, 4 },
    { HL_FORMAT_RGB10A2_UNORM, HL_FORMAT_R32_UINT, HL_BITS_UNORM10, 4 },
    { HL_FORMAT_RGBA16_UNORM, HL_FORMAT_RG32_UINT, HL_BITS_UNORM16, 8 },
    { HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_RG32_UINT, HL_BITS_HALF, 8 },
    { HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_RGBA32_UINT, HL_BITS_FLOAT, 16 },
};

enum { LIGHTS = sizeof lights / sizeof *lights };

/* Written once an L texel, 25 / 64 of a pixel, and read by four taps. */
static void every_light_format_is_planned(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.light_format = HL_FORMAT_RGBA16_FLOAT;
    double base = (double)planned(&n, &c).moved_per_pixel;
    for (int i = 0; i < LIGHTS; i++) {
        n.light_format = lights[i].f;
        struct hl_plan p = planned(&n, &c);
        const struct hl_plan_target *t = hl_plan_target(&p, HL_ROLE_LIGHT);
        bool fixed = hl_format_info(t->format)->kind == HL_KIND_UNORM;
        assert_int_equal(t->format, lights[i].f);
        assert_int_equal(t->sample_as, lights[i].words);
        assert_int_equal(p.light_bits, lights[i].bits);
        assert_true(p.light_scale == (fixed ? 20 : 1));
        ck_near((double)(p.light_scale * p.light_out), 1, 1e-6);
        ck_near((double)p.moved_per_pixel - base,
                (lights[i].bytes - 8) * (25 / 64.0 + 4), 1e-4);
        assert_true(p.light_error == hl_accumulation_error(t->format, 2));
    }
}

/* Values of 1/8 of the peak: half a step, of ten bits a whole one. */
static void ten_bits_lie_between_eight_and_sixteen(void **state)
{
    (void)state;
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGB10A2_UNORM, 1),
            8.0 / 1023, 1e-6);
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGB10A2_UNORM, 30),
            240.0 / 1023, 1e-5);
    /* 12.92 * 255 codes a unit of light. */
    ck_near((double)hl_dark_codes(HL_FORMAT_RGBA16_UNORM, 97), 2.438, 1e-3);
    ck_near((double)hl_dark_codes(HL_FORMAT_RGBA8_UNORM, 1), 6.46, 1e-3);
    ck_near((double)hl_dark_codes(HL_FORMAT_RGB10A2_UNORM, 1), 3.2205, 1e-3);
    assert_true(hl_dark_codes(HL_FORMAT_RGBA16_FLOAT, 97) == 0);
}

/* Two bits of alpha make specular light a third at a time: taken when asked
 * for, and said. */
static void coarse_alpha_is_said(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.light_format = HL_FORMAT_RGB10A2_UNORM;
    struct hl_plan p = planned(&n, &c);
    assert_false(has_reason(&p, HL_WHY_LIGHT_ALPHA));
    n.specular = HL_NEED_ONE_EXPONENT;
    p = planned(&n, &c);
    ck_near((double)argument(&p, HL_WHY_LIGHT_ALPHA, 2), 20 / 3.0, 1e-5);
    n.light_format = HL_FORMAT_RGBA8_UNORM;
    p = planned(&n, &c);
    assert_false(has_reason(&p, HL_WHY_LIGHT_ALPHA));
}

/* Unasked: none that is unknown, unusable, without a range, or whose alpha is
 * too coarse for the scene. */
static void candidates_are_fit_to_be_compared(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_ask a = { .n = usual(), .caps = &c };
    ck_lavapipe(&c);
    for (int f = 0; f < HL_FORMAT_COUNT; f++) {
        bool known = false;
        for (int i = 0; i < LIGHTS; i++)
            known = known || (int)lights[i].f == f;
        assert_true(hl_plan_light_candidate(&a, (enum hl_format)f) == known);
    }
    a.n.specular = HL_NEED_ONE_EXPONENT;
    assert_false(hl_plan_light_candidate(&a, HL_FORMAT_RGB10A2_UNORM));
    assert_true(hl_plan_light_candidate(&a, HL_FORMAT_RGBA8_UNORM));
    a.n.peak = 0;
    assert_false(hl_plan_light_candidate(&a, HL_FORMAT_RGBA8_UNORM));
    assert_true(hl_plan_light_candidate(&a, HL_FORMAT_RGBA16_FLOAT));
    c.format[HL_FORMAT_RGBA16_FLOAT].use &= (uint8_t)~HL_USE_BLEND;
    assert_false(hl_plan_light_candidate(&a, HL_FORMAT_RGBA16_FLOAT));
    c.profile = hl_profile_ps3;
    assert_false(hl_plan_light_candidate(&a, HL_FORMAT_RGB10A2_UNORM));
}

/* 31 blends of one light each ask for 16 bits of fixed point, whose half step
 * is a code of 255 at a peak of 39.8. */
static void steps_that_show_in_the_dark_are_not_taken(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.batch = 1;
    n.lights_per_pixel = 30;
    n.peak = 39.7f;
    struct hl_plan p = planned(&n, &c);
    assert_int_equal(format_of(&p, HL_ROLE_LIGHT), HL_FORMAT_RGBA16_UNORM);
    assert_false(has_reason(&p, HL_WHY_LIGHT_FORMAT_DARK));
    n.peak = 40;
    p = planned(&n, &c);
    assert_int_equal(format_of(&p, HL_ROLE_LIGHT), HL_FORMAT_RGBA32_FLOAT);
    assert_true(p.light_scale == 1 && p.light_out == 1);
    assert_true(argument(&p, HL_WHY_LIGHT_FORMAT_DARK, 0) ==
                HL_FORMAT_RGBA16_UNORM);
    ck_near((double)argument(&p, HL_WHY_LIGHT_FORMAT_DARK, 1), 1.0055, 1e-3);
    n.max_error = 1.1f;
    p = planned(&n, &c);
    assert_int_equal(format_of(&p, HL_ROLE_LIGHT), HL_FORMAT_RGBA16_UNORM);
    /* Asked for, and where there is nothing else, it is taken. */
    n.max_error = 0;
    n.light_format = HL_FORMAT_RGBA16_UNORM;
    p = planned(&n, &c);
    assert_false(has_reason(&p, HL_WHY_LIGHT_FORMAT_DARK));
    n.light_format = HL_FORMAT_NONE;
    c.format[HL_FORMAT_RGBA16_FLOAT].use &= (uint8_t)~HL_USE_BLEND;
    c.format[HL_FORMAT_RGBA32_FLOAT].use &= (uint8_t)~HL_USE_BLEND;
    p = planned(&n, &c);
    assert_int_equal(format_of(&p, HL_ROLE_LIGHT), HL_FORMAT_RGBA16_UNORM);
}

/* ---- normals ------------------------------------------------------------ */

/* The normals' own target alone: the DSF and the pairs keep 16 bits. Written
 * and read once an L texel. */
static void normals_have_a_format_of_their_own(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.brdfs = n.motion = n.decals = true;
    double base = (double)planned(&n, &c).moved_per_pixel;
    for (int f = 1; f < HL_FORMAT_COUNT; f++) {
        bool known = f == HL_FORMAT_RG16_UNORM || f == HL_FORMAT_RG8_UNORM ||
                     f == HL_FORMAT_RG16_FLOAT;
        n.normal_format = (enum hl_format)f;
        if (!known) {
            check_refused(&n, &c, HL_REFUSED_NORMAL_FORMAT);
            continue;
        }
        struct hl_plan p = planned(&n, &c);
        assert_int_equal(format_of(&p, HL_ROLE_NORMAL), f);
        assert_int_equal(format_of(&p, HL_ROLE_DSF), HL_FORMAT_RG16_UNORM);
        assert_int_equal(format_of(&p, HL_ROLE_EXPONENT),
                         HL_FORMAT_RG16_UNORM);
        assert_int_equal(format_of(&p, HL_ROLE_MOTION), HL_FORMAT_RG16_UNORM);
        assert_int_equal(p.decals, HL_DECALS_BLEND_NORMALS);
        assert_true(hl_plan_target(&p, HL_ROLE_NORMAL)->error ==
                    hl_normal_error((enum hl_format)f));
        assert_true(argument(&p, HL_WHY_NORMAL_FORMAT, 2) == 1);
        ck_near((double)p.moved_per_pixel - base,
                f == HL_FORMAT_RG8_UNORM ? -4 * 25 / 64.0 : 0, 1e-4);
    }
}

/* What cannot be drawn to is refused; what cannot be blended makes decals a
 * layer; what a console rules stays. */
static void machines_rule_their_normals(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.decals = true;
    n.normal_format = HL_FORMAT_RG8_UNORM;
    c.format[HL_FORMAT_RG8_UNORM].use &= (uint8_t)~HL_USE_BLEND;
    assert_int_equal(planned(&n, &c).decals, HL_DECALS_ALPHA_OBJECTS);
    c.format[HL_FORMAT_RG8_UNORM].use &= (uint8_t)~HL_USE_TARGET;
    check_refused(&n, &c, HL_REFUSED_NORMAL_FORMAT);
    ck_lavapipe(&c);
    c.profile = hl_profile_xbox360;
    n.normal_format = HL_FORMAT_NONE;
    struct hl_plan p = planned(&n, &c);
    n.normal_format = format_of(&p, HL_ROLE_NORMAL);
    p = planned(&n, &c);
    assert_int_equal(format_of(&p, HL_ROLE_NORMAL), n.normal_format);
    for (int f = 1; f < HL_FORMAT_COUNT; f++) {
        if (f == (int)format_of(&p, HL_ROLE_NORMAL))
            continue;
        n.normal_format = (enum hl_format)f;
        check_refused(&n, &c, HL_REFUSED_NORMAL_FORMAT);
    }
}

/* ---- costs -------------------------------------------------------------- */

static void formats_cost_by_bytes_or_as_measured(void **state)
{
    (void)state;
    struct hl_caps c;
    ck_lavapipe(&c);
    c.cost.blend_ns = 4;
    c.cost.fetch_ns = 3;
    assert_true(hl_blend_ns(&c, HL_FORMAT_RGBA16_FLOAT) == 4);
    assert_true(hl_blend_ns(&c, HL_FORMAT_RGBA8_UNORM) == 2);
    assert_true(hl_blend_ns(&c, HL_FORMAT_RGBA32_FLOAT) == 8);
    assert_true(hl_fetch_ns(&c, HL_FORMAT_RG8_UNORM) == 3);
    assert_true(hl_fetch_ns(&c, HL_FORMAT_RGBA16_FLOAT) == 3);
    assert_true(hl_fetch_ns(&c, HL_FORMAT_RGBA32_FLOAT) == 6);
    c.cost.format_blend_ns[HL_FORMAT_RGBA32_FLOAT] = 5;
    c.cost.format_fetch_ns[HL_FORMAT_RGBA8_UNORM] = 1;
    assert_true(hl_blend_ns(&c, HL_FORMAT_RGBA32_FLOAT) == 5);
    assert_true(hl_fetch_ns(&c, HL_FORMAT_RGBA8_UNORM) == 1);
    assert_true(hl_fetch_ns(&c, HL_FORMAT_NONE) == 0);
    assert_true(hl_blend_ns(&c, HL_FORMAT_COUNT) == 0);
}

/* Milliseconds that one number of the cost model adds to the plan, when it
 * goes up by one. */
static double added(const struct hl_needs *n, const struct hl_caps *caps,
                    const float *number)
{
    struct hl_caps c = *caps;
    size_t at = (size_t)((const char *)number - (const char *)caps);
    float more = *number + 1;
    memcpy((char *)&c + at, &more, sizeof more);
    return (double)planned(n, &c).cost_ms - (double)planned(n, caps).cost_ms;
}

/* A frame of a million pixels, each taking four taps, 1.05 times, with an
 * L-buffer of a quarter of it; single precision of the sum. */
static void plans_count_their_formats(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.width = n.height = 1000;
    n.light_width = n.light_height = 500;
    n.light_format = HL_FORMAT_RGBA8_UNORM;
    n.normal_format = HL_FORMAT_RG8_UNORM;
    for (int i = 0; i < HL_FORMAT_COUNT; i++)
        c.cost.format_blend_ns[i] = c.cost.format_fetch_ns[i] = 2;
    float *fetch = c.cost.format_fetch_ns, *blend = c.cost.format_blend_ns;
    ck_near(added(&n, &c, &fetch[HL_FORMAT_RGBA8_UNORM]), 4.2, 1e-3);
    ck_near(added(&n, &c, &fetch[HL_FORMAT_RG8_UNORM]), 0.25, 1e-3);
    /* 12 lights a texel, one a draw; tiles: one draw each. */
    ck_near(added(&n, &c, &blend[HL_FORMAT_RGBA8_UNORM]), 0.25, 1e-3);
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.batch = 1;
    ck_near(added(&n, &c, &blend[HL_FORMAT_RGBA8_UNORM]), 3, 1e-3);
    ck_near(added(&n, &c, &fetch[HL_FORMAT_RG8_UNORM]), 3, 1e-3);
    n.light_path = HL_LIGHT_PATH_VOLUMES;
    ck_near(added(&n, &c, &blend[HL_FORMAT_RGBA8_UNORM]), 3, 1e-3);
    assert_true(added(&n, &c, &blend[HL_FORMAT_RGBA16_UNORM]) == 0);
    assert_true(added(&n, &c, &fetch[HL_FORMAT_RGBA16_UNORM]) == 0);
}

/* Two lights by volumes of shadow cover the whole L-buffer, by maps 0.06 of
 * it each; a stippled pixel takes four taps. */
static void features_count_their_formats(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    ck_lavapipe(&c);
    n.width = n.height = 1000;
    n.light_width = n.light_height = 500;
    n.light_format = HL_FORMAT_RGBA8_UNORM;
    n.normal_format = HL_FORMAT_RG8_UNORM;
    n.shadows = HL_SHADOWS_VOLUMES;
    n.n_shadow_lights = 2;
    for (int i = 0; i < HL_FORMAT_COUNT; i++)
        c.cost.format_blend_ns[i] = c.cost.format_fetch_ns[i] = 2;
    float *fetch = c.cost.format_fetch_ns, *blend = c.cost.format_blend_ns;
    ck_near(added(&n, &c, &blend[HL_FORMAT_RGBA8_UNORM]), 0.25 + 0.5, 1e-3);
    n.shadows = HL_SHADOWS_MAPS;
    ck_near(added(&n, &c, &blend[HL_FORMAT_RGBA8_UNORM]), 0.25 + 0.03, 1e-3);
    ck_near(added(&n, &c, &fetch[HL_FORMAT_RG8_UNORM]), 0.25 + 0.03, 1e-3);
    n.blended = true;
    n.translucency = HL_TRANSLUCENCY_2X2;
    struct hl_plan p = planned(&n, &c);
    float before = argument(&p, HL_WHY_STIPPLED, 2);
    fetch[HL_FORMAT_RGBA8_UNORM] = 3;
    p = planned(&n, &c);
    ck_near((double)(argument(&p, HL_WHY_STIPPLED, 2) - before), 4, 1e-4);
}

/* ---- no lights ---------------------------------------------------------- */

static void dark_plans_give_no_reasons_for_light(void **state)
{
    static const enum hl_reason light[] = {
        HL_WHY_LIGHT_SIZE_ASKED, HL_WHY_LIGHT_SIZE_DEFAULT,
        HL_WHY_NORMAL_FORMAT, HL_WHY_DSF_FORMAT, HL_WHY_PATH_ASKED,
        HL_WHY_PATH_CHEAPEST, HL_WHY_TILE_DEPTH, HL_WHY_LIGHT_FORMAT_ASKED,
        HL_WHY_LIGHT_FORMAT_ERROR, HL_WHY_LIGHT_FORMAT_PROFILE,
        HL_WHY_LIGHT_RANGE, HL_WHY_LIGHT_PEAK_DEFAULT, HL_WHY_FLOAT_TAPS,
        HL_WHY_TWO16_FIXED32, HL_WHY_TWO16_SIGNED, HL_WHY_TWO16_BYTES_ARGB,
        HL_WHY_DEPTH_BARG, HL_WHY_NO_BLEND };
    (void)state;
    for (uint32_t i = 0; i < 5; i++) {
        struct hl_needs n = usual();
        struct hl_caps c;
        ck_lavapipe(&c);
        if (i > 0 && !hl_profile_at(i - 1))
            break;
        if (i > 0)
            c.profile = *hl_profile_at(i - 1);
        n.n_lights = 0;
        n.lights_per_pixel = n.lights_per_object = 0;
        struct hl_plan p = planned(&n, &c);
        assert_int_equal(p.dsf, HL_DSF_DARK);
        assert_true(p.light_error == 0);
        assert_true(has_reason(&p, HL_WHY_NO_LIGHT_PASS));
        assert_true(has_reason(&p, HL_WHY_COLOR_FORMAT));
        for (size_t k = 0; k < sizeof light / sizeof *light; k++)
            if (has_reason(&p, light[k]))
                fail_msg("profile %u has reason %d", i, (int)light[k]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_light_format_is_planned),
        cmocka_unit_test(ten_bits_lie_between_eight_and_sixteen),
        cmocka_unit_test(coarse_alpha_is_said),
        cmocka_unit_test(candidates_are_fit_to_be_compared),
        cmocka_unit_test(steps_that_show_in_the_dark_are_not_taken),
        cmocka_unit_test(normals_have_a_format_of_their_own),
        cmocka_unit_test(machines_rule_their_normals),
        cmocka_unit_test(formats_cost_by_bytes_or_as_measured),
        cmocka_unit_test(plans_count_their_formats),
        cmocka_unit_test(features_count_their_formats),
        cmocka_unit_test(dark_plans_give_no_reasons_for_light),
    };
    return cmocka_run_group_tests_name("formats of plans", tests, NULL, NULL);
}
