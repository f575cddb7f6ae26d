/* SPDX-License-Identifier: Zlib */
/* Further channels of the G-buffer: each only where it is needed, in the
 * format that every machine has for pairs; what they store comes back. Frames
 * with them: test_frame_brdf.c, test_frame_motion.c. */
#include <string.h>
#include "platforms/packemu/pe.h"
#include "shaders/shared/pack.h"
#include "tests/console_kit.h"

/* ---- plans -------------------------------------------------------------- */

static const struct hl_profile *const rules[] = {
    &hl_profile_native, &hl_profile_dx10, &hl_profile_xbox360,
    &hl_profile_ps3 };

/* Small enough for EDRAM with four pairs. */
static struct hl_needs small_needs(void)
{
    struct hl_needs n = con_needs();
    n.width = 640;
    n.height = 360;
    return n;
}

static void check_pair(const struct hl_plan *p, enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    const struct hl_plan_target *n = hl_plan_target(p, HL_ROLE_NORMAL);
    assert_non_null(t);
    assert_int_equal(t->format, n->format);
    assert_int_equal(t->sample_as, n->sample_as);
    /* Kept alike, but for where in EDRAM. */
    struct hl_console a = t->console, b = n->console;
    a.edram_tile = b.edram_tile = 0;
    assert_memory_equal(&a, &b, sizeof a);
    assert_int_equal(t->width, n->width);
    assert_int_equal(t->height, n->height);
}

static void check_colors(const struct hl_plan *p, bool exponent, bool motion)
{
    const struct hl_plan_pass *g = &p->pass[0];
    uint32_t n = 2;
    assert_int_equal(g->role, HL_PASS_GEOMETRY);
    if (exponent)
        assert_int_equal(g->color[n++], HL_ROLE_EXPONENT);
    if (motion)
        assert_int_equal(g->color[n++], HL_ROLE_MOTION);
    while (n < HL_PLAN_COLORS)
        assert_int_equal(g->color[n++], HL_ROLE_NONE);
}

static void one_plan(const struct hl_caps *c, bool brdfs, bool motion,
                     enum hl_specular_need specular)
{
    struct hl_needs n = small_needs();
    n.specular = specular;
    struct hl_plan without = con_plan(HL_PIPELINE_INFERRED, &n, c);
    n.brdfs = brdfs;
    n.motion = motion;
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, c);
    bool exponent = hl_plan_target(&p, HL_ROLE_EXPONENT) != NULL;
    assert_true(p.brdfs == brdfs && p.motion == motion);
    assert_true((con_reason(&p, HL_WHY_BRDFS) != NULL) == brdfs);
    assert_true((con_reason(&p, HL_WHY_MOTION) != NULL) == motion);
    assert_true((hl_plan_target(&p, HL_ROLE_MOTION) != NULL) == motion);
    if (brdfs) {
        check_pair(&p, HL_ROLE_EXPONENT);
        assert_int_equal(p.specular, specular == HL_NEED_NO_SPECULAR
                         ? HL_SPECULAR_NONE
                         : specular == HL_NEED_ONE_EXPONENT
                         ? HL_SPECULAR_CONSTANT : HL_SPECULAR_CHANNEL);
    } else {
        assert_true(exponent == (p.specular == HL_SPECULAR_CHANNEL));
    }
    if (motion)
        check_pair(&p, HL_ROLE_MOTION);
    check_colors(&p, exponent, motion);
    assert_true((p.cost_ms > without.cost_ms) == (brdfs || motion));
    if (!brdfs && !motion)
        assert_memory_equal(&p, &without, sizeof p);
}

static void channels_are_there_when_they_are_needed(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 24; k++) {
            struct hl_caps c;
            con_caps(&c, rules[i], k & 1);
            if (i == 0 && (k & 1))
                continue;
            one_plan(&c, k & 2, k & 4, (enum hl_specular_need)(k / 8));
        }
}

/* Written and read: eight bytes an L texel; written alone: four. */
static void channels_are_counted(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_needs n = small_needs();
    con_caps(&c, &hl_profile_native, false);
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    double before = (double)p.moved_per_pixel, ratio = 25 / 64.0;
    n.brdfs = true;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    ck_near((double)p.moved_per_pixel - before, 8 * ratio, 1e-4);
    n.motion = true;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    ck_near((double)p.moved_per_pixel - before, 12 * ratio, 1e-4);
}

static enum hl_refusal refusal(enum hl_pipeline pipeline,
                               const struct hl_needs *n,
                               const struct hl_caps *c)
{
    struct hl_plan p;
    enum hl_refusal why;
    hl_plan_make(&p, pipeline, n, c, &why);
    return why;
}

static void motion_needs_a_geometry_pass(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_needs n = small_needs();
    con_caps(&c, &hl_profile_native, false);
    n.n_lights = 1;
    n.lights_per_pixel = n.lights_per_object = 0.1f;
    n.n_triangles = 10;
    assert_int_not_equal(con_plan(HL_PIPELINE_AUTO, &n, &c).pipeline,
                         HL_PIPELINE_INFERRED);
    n.motion = true;
    assert_int_equal(con_plan(HL_PIPELINE_AUTO, &n, &c).pipeline,
                     HL_PIPELINE_INFERRED);
    assert_int_equal(refusal(HL_PIPELINE_FORWARD, &n, &c),
                     HL_REFUSED_MOTION);
    assert_int_equal(refusal(HL_PIPELINE_FORWARD_MULTIPASS, &n, &c),
                     HL_REFUSED_MOTION);
}

static void targets_of_a_pass_are_the_machines(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_needs n = small_needs();
    con_caps(&c, &hl_profile_native, false);
    n.motion = true;
    c.max_colors = 3;
    con_plan(HL_PIPELINE_INFERRED, &n, &c);
    n.brdfs = true;
    assert_int_equal(refusal(HL_PIPELINE_INFERRED, &n, &c),
                     HL_REFUSED_MOTION);
    n.motion = false;
    con_plan(HL_PIPELINE_INFERRED, &n, &c);
    c.max_colors = 2;
    assert_int_equal(refusal(HL_PIPELINE_INFERRED, &n, &c),
                     HL_REFUSED_PIPELINE);
}

/* Bound together, they must not lie on each other. */
static void edram_has_a_place_for_each(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_needs n = small_needs();
    con_caps(&c, &hl_profile_xbox360, true);
    n.brdfs = n.motion = true;
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    static const enum hl_role bound[] = {
        HL_ROLE_NORMAL, HL_ROLE_DSF, HL_ROLE_EXPONENT, HL_ROLE_MOTION,
        HL_ROLE_LIGHT_DEPTH };
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < i; k++) {
            const struct hl_plan_target *a = hl_plan_target(&p, bound[i]);
            const struct hl_plan_target *b = hl_plan_target(&p, bound[k]);
            uint32_t at = a->console.edram_tile, bt = b->console.edram_tile;
            assert_true(at > 0 && bt > 0 && a->edram_tiles > 0);
            assert_true(at + a->edram_tiles <= bt ||
                        bt + b->edram_tiles <= at);
        }
}

/* ---- codes -------------------------------------------------------------- */

/* As a console's memory keeps a pair, and back. */
static hl_vec2 kept(uint32_t two16, enum hl_format format, float x, float y)
{
    enum hl_format view = format == HL_FORMAT_RGBA8_UNORM
                          ? HL_FORMAT_RG16_UNORM : format;
    hl_vec4 v = hl_two16_encode(two16, x, y);
    const float *in[4] = { &v.x, &v.y, &v.z, &v.w };
    float rgba[4];
    float *out[4] = { &rgba[0], &rgba[1], &rgba[2], &rgba[3] };
    uint32_t words[4];
    pe_encode(format, in, 1, words);
    pe_decode(view, words, 1, out);
    return hl_two16_decode(two16, hl_v2(rgba[0], rgba[1]));
}

static const struct { uint32_t two16; enum hl_format format; } modes[] = {
    { HL_TWO16_UNORM, HL_FORMAT_RG16_UNORM },
    { HL_TWO16_SIGNED, HL_FORMAT_RG16_SNORM },
    { HL_TWO16_BYTES, HL_FORMAT_RGBA8_UNORM },
};

/* Every index beside every hundredth exponent; an exponent's code within half
 * a step. */
static void indices_are_exact(void **state)
{
    (void)state;
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++)
        for (uint32_t i = 0; i < 256 * 101; i++) {
            float index = (float)(i / 101), code = (float)(i % 101) * 0.01f;
            hl_vec2 v = kept(modes[m].two16, modes[m].format, code,
                             hl_brdf_encode(index));
            assert_true(hl_brdf_decode(v.y) == index);
            ck_near((double)v.x, (double)code, 0.5 / 65534 + 1e-7);
        }
}

/* 0 is exact; else pack.h's error, and the rounding of 1 / 2 + m / 2 as a
 * float, 2^-25 of up to 1, doubled again, and of the code's product. */
static void no_motion_is_exact(void **state)
{
    (void)state;
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++) {
        double error = modes[m].two16 == HL_TWO16_SIGNED ? 1.0 / 65534
                                                         : 2.0 / 65535;
        for (int i = -70000; i <= 70000; i++) {
            float want = (float)i / 70000;
            float x = hl_motion_encode(want);
            hl_vec2 v = kept(modes[m].two16, modes[m].format, x, 1 - x);
            ck_near((double)hl_motion_decode(v.x), (double)want,
                    error + 3e-7);
            ck_near((double)hl_motion_decode(v.y), -(double)want,
                    error + 3e-7);
            if (i == 0)
                assert_true(hl_motion_decode(v.x) == 0 &&
                            hl_motion_decode(v.y) == 0);
        }
    }
    assert_true(hl_motion_encode(3) == 1 && hl_motion_encode(-3) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_are_there_when_they_are_needed),
        cmocka_unit_test(channels_are_counted),
        cmocka_unit_test(motion_needs_a_geometry_pass),
        cmocka_unit_test(targets_of_a_pass_are_the_machines),
        cmocka_unit_test(edram_has_a_place_for_each),
        cmocka_unit_test(indices_are_exact),
        cmocka_unit_test(no_motion_is_exact),
    };
    return cmocka_run_group_tests_name("further channels", tests, NULL, NULL);
}
