/* SPDX-License-Identifier: Zlib */
/* Plans within a budget, against every plan there is, made one by one. */
#include <math.h>
#include <string.h>
#include "core/pipe.h"
#include "tests/console_kit.h"

/* ---- needs and machines ------------------------------------------------- */

static const struct hl_probe some_probe = { 0.5f, 4, 6, 1, 3, 7, 0 };

static struct hl_needs lit(void)
{
    struct hl_needs n = con_needs();
    n.probe = some_probe;
    return n;
}

enum { MACHINES = 7 };

/* lavapipe as it is now, with a target of ten bits. */
static void lavapipe(struct hl_caps *c)
{
    ck_lavapipe(c);
    c->format[HL_FORMAT_RGB10A2_UNORM] = c->format[HL_FORMAT_RGBA8_UNORM];
}

/* It, and each console with its own memory and without. */
static void machine(struct hl_caps *c, int i)
{
    static const char *const names[] = { "dx10", "xbox360", "ps3" };
    if (i == 0)
        lavapipe(c);
    else
        con_caps(c, hl_profile_find(names[(i - 1) / 2]), i % 2 == 0);
}

static bool plan(struct hl_plan *p, enum hl_pipeline pipeline,
                 const struct hl_needs *n, const struct hl_caps *c)
{
    enum hl_refusal why;
    enum hl_result r = hl_plan_make(p, pipeline, n, c, &why);
    if (r != HL_OK)
        assert_int_equal(why, HL_REFUSED_BUDGET);
    return r == HL_OK;
}

/* ---- the choice --------------------------------------------------------- */

static void a_looser_budget_never_costs_more(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    for (int i = 0; i < MACHINES; i++) {
        float cost = INFINITY, first = 0;
        machine(&c, i);
        for (float b = 0.01f; b < 100; b *= 1.5f) {
            n.budget_codes = b;
            if (!plan(&p, HL_PIPELINE_AUTO, &n, &c)) {
                assert_true(cost == INFINITY);
                continue;
            }
            assert_true(p.error_codes <= b);
            assert_true(p.cost_ms <= cost);
            cost = p.cost_ms;
            first = first > 0 ? first : cost;
        }
        assert_true(cost < first);
    }
}

static void a_larger_cost_never_errs_more(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    for (int i = 0; i < MACHINES; i++) {
        float error = INFINITY, first = 0;
        machine(&c, i);
        for (float b = 1; b < 2000; b *= 1.1f) {
            n.budget_ms = b;
            if (!plan(&p, HL_PIPELINE_AUTO, &n, &c)) {
                assert_true(error == INFINITY);
                continue;
            }
            assert_true(p.cost_ms <= b);
            assert_true(p.error_codes <= error);
            error = p.error_codes;
            first = first > 0 ? first : error;
        }
        assert_true(error < first);
    }
}

static const enum hl_format formats[] = {
    HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGB10A2_UNORM, HL_FORMAT_RGBA16_UNORM,
    HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_RGBA16_FIXED32
};

/* Cheapest of all plans within n->budget_codes, each asked for by itself;
 * INFINITY: there is none. */
static float cheapest(const struct hl_needs *n, const struct hl_caps *c)
{
    static const uint32_t sizes[] = { 8, 7, 6, 5, 4, 3, 2 };
    float best = INFINITY;
    struct hl_plan p;
    for (int i = 1; i < HL_PIPELINE_COUNT; i++)
        for (size_t k = 0; k < 7; k++)
            for (size_t f = 0; f < sizeof formats / sizeof *formats; f++) {
                struct hl_needs one = *n;
                one.budget_codes = 0;
                one.light_width = (n->width * sizes[k] + 4) / 8;
                one.light_height = (n->height * sizes[k] + 4) / 8;
                one.light_format = formats[f];
                if (hl_plan_make(&p, (enum hl_pipeline)i, &one, c, NULL) ==
                    HL_OK && p.error_codes <= n->budget_codes &&
                    p.cost_ms < best)
                    best = p.cost_ms;
            }
    return best;
}

/* No specular, so that every format may be taken unasked. Where EDRAM holds
 * less than five eighths the size that it holds is one more. */
static void the_choice_is_the_cheapest_of_all(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    n.specular = HL_NEED_NO_SPECULAR;
    for (int i = 0; i < MACHINES; i++) {
        machine(&c, i);
        for (float b = 0.25f; b <= 32; b *= 2) {
            n.budget_codes = b;
            float best = cheapest(&n, &c);
            if (plan(&p, HL_PIPELINE_AUTO, &n, &c))
                assert_true(p.cost_ms <= best &&
                            (p.cost_ms == best || c.profile.edram_tiles));
            else
                assert_true(best == INFINITY);
        }
    }
}

/* Ties go to the more accurate: nothing costs anything here. */
static void free_machines_get_the_most_accurate(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    lavapipe(&c);
    memset(&c.cost, 0, sizeof c.cost);
    n.budget_codes = 30;
    assert_true(plan(&p, HL_PIPELINE_INFERRED, &n, &c));
    assert_int_equal(p.light_width, n.width);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->format,
                     HL_FORMAT_RGBA32_FLOAT);
}

static void both_bounds_hold_together(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan cheap, p;
    lavapipe(&c);
    n.budget_codes = 3;
    assert_true(plan(&cheap, HL_PIPELINE_AUTO, &n, &c));
    n.budget_ms = cheap.cost_ms;
    assert_true(plan(&p, HL_PIPELINE_AUTO, &n, &c));
    assert_true(p.cost_ms == cheap.cost_ms);
    n.budget_ms = cheap.cost_ms * 0.99f;
    assert_false(plan(&p, HL_PIPELINE_AUTO, &n, &c));
}

/* ---- what is said ------------------------------------------------------- */

static void a_missed_budget_says_what_can_be_kept(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p, rest;
    lavapipe(&c);
    n.budget_codes = 0.01f;
    n.budget_ms = 0.001f;
    assert_false(plan(&p, HL_PIPELINE_INFERRED, &n, &c));
    assert_int_equal(p.n_reasons, 1);
    const struct hl_plan_reason *r = con_reason(&p, HL_WHY_BUDGET_MISSED);
    assert_non_null(r);
    assert_true(r->arg[0] == n.budget_codes && r->arg[1] == n.budget_ms);
    n.budget_codes = r->arg[2];
    n.budget_ms = 0;
    assert_true(plan(&rest, HL_PIPELINE_INFERRED, &n, &c));
    n.budget_codes = r->arg[2] * 0.999f;
    assert_false(plan(&rest, HL_PIPELINE_INFERRED, &n, &c));
    n.budget_codes = 0;
    n.budget_ms = r->arg[3];
    assert_true(plan(&rest, HL_PIPELINE_INFERRED, &n, &c));
    n.budget_ms = r->arg[3] * 0.999f;
    assert_false(plan(&rest, HL_PIPELINE_INFERRED, &n, &c));
}

static void reasons_tell_choice_from_order(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    lavapipe(&c);
    n.budget_codes = 4.5f;
    assert_true(plan(&p, HL_PIPELINE_AUTO, &n, &c));
    assert_int_equal(p.pipeline, HL_PIPELINE_INFERRED);
    const struct hl_plan_reason *r = con_reason(&p, HL_WHY_BUDGET_ERROR);
    assert_true(r && r->arg[0] == 4.5f && r->arg[1] == p.error_codes &&
                r->arg[2] == p.cost_ms && r->arg[3] > 25);
    assert_non_null(con_reason(&p, HL_WHY_PIPELINE_BUDGET));
    assert_non_null(con_reason(&p, HL_WHY_LIGHT_SIZE_BUDGET));
    assert_non_null(con_reason(&p, HL_WHY_LIGHT_FORMAT_BUDGET));
    n.light_width = 1024;
    n.light_height = 576;
    n.light_format = HL_FORMAT_RGBA32_FLOAT;
    assert_true(plan(&p, HL_PIPELINE_INFERRED, &n, &c));
    assert_non_null(con_reason(&p, HL_WHY_PIPELINE_ASKED));
    assert_non_null(con_reason(&p, HL_WHY_LIGHT_SIZE_ASKED));
    assert_non_null(con_reason(&p, HL_WHY_LIGHT_FORMAT_ASKED));
    assert_null(con_reason(&p, HL_WHY_PIPELINE_BUDGET));
    assert_null(con_reason(&p, HL_WHY_LIGHT_SIZE_BUDGET));
    assert_null(con_reason(&p, HL_WHY_LIGHT_FORMAT_BUDGET));
}

static void what_was_asked_for_stays(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_plan p;
    lavapipe(&c);
    for (float b = 0.6f; b < 20; b *= 1.3f) {
        struct hl_needs n = lit();
        n.budget_codes = b;
        for (int i = 1; i < HL_PIPELINE_COUNT; i++)
            if (plan(&p, (enum hl_pipeline)i, &n, &c))
                assert_int_equal(p.pipeline, i);
        n.light_format = HL_FORMAT_RGBA16_UNORM;
        if (plan(&p, HL_PIPELINE_INFERRED, &n, &c))
            assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->format,
                             HL_FORMAT_RGBA16_UNORM);
        n.light_format = HL_FORMAT_NONE;
        n.light_width = 900;
        n.light_height = 500;
        if (plan(&p, HL_PIPELINE_INFERRED, &n, &c))
            assert_true(p.light_width == 900 && p.light_height == 500);
    }
}

/* But for the figure itself. */
static void without_a_budget_a_probe_changes_nothing(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    struct hl_plan a, b;
    for (int i = 0; i < MACHINES; i++)
        for (int pipeline = 0; pipeline < HL_PIPELINE_COUNT; pipeline++) {
            machine(&c, i);
            a = con_plan((enum hl_pipeline)pipeline, &n, &c);
            struct hl_needs probed = lit();
            c.error.full = 3;
            c.error.margin = 2;
            b = con_plan((enum hl_pipeline)pipeline, &probed, &c);
            assert_true(a.error_codes > 0);
            b.error_codes = a.error_codes;
            assert_memory_equal(&a, &b, sizeof a);
        }
}

/* ---- formats ------------------------------------------------------------ */

static enum hl_format loosest(const struct hl_needs *n,
                              const struct hl_caps *c)
{
    struct hl_needs one = *n;
    struct hl_plan p;
    one.budget_codes = 200;
    one.light_width = one.width;
    one.light_height = one.height;
    assert_true(plan(&p, HL_PIPELINE_INFERRED, &one, c));
    return hl_plan_target(&p, HL_ROLE_LIGHT)->format;
}

static void fixed_ranges_need_a_peak_that_tells(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    lavapipe(&c);
    c.cost.blend_ns = 100;       /* so that fewer bytes are cheaper          */
    assert_int_equal(hl_format_info(loosest(&n, &c))->kind, HL_KIND_UNORM);
    n.lights = HL_LIGHTS_SMOOTH | HL_LIGHTS_INVERSE_SQUARE;
    assert_int_equal(hl_format_info(loosest(&n, &c))->kind, HL_KIND_FLOAT);
    n.lights = HL_LIGHTS_SMOOTH;
    n.peak = 0;
    assert_int_equal(hl_format_info(loosest(&n, &c))->kind, HL_KIND_FLOAT);
}

/* Two bits of alpha would hold specular light. */
static void ten_bits_are_for_scenes_without_specular(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    struct hl_plan p;
    lavapipe(&c);
    n.light_width = n.width;
    n.light_height = n.height;
    n.light_path = HL_LIGHT_PATH_LISTS;
    n.probe.eight = 10;          /* 4 with steps of a quarter                */
    n.budget_codes = 5;
    c.cost.format_fetch_ns[HL_FORMAT_RGB10A2_UNORM] = 1e-3f;
    assert_true(plan(&p, HL_PIPELINE_INFERRED, &n, &c));
    assert_int_not_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->format,
                         HL_FORMAT_RGB10A2_UNORM);
    n.specular = HL_NEED_NO_SPECULAR;
    assert_true(plan(&p, HL_PIPELINE_INFERRED, &n, &c));
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->format,
                     HL_FORMAT_RGB10A2_UNORM);
}

/* ---- refusals ----------------------------------------------------------- */

static void refuse(const struct hl_needs *n, const struct hl_caps *c)
{
    struct hl_plan p;
    enum hl_refusal why;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, n, c, &why),
                     HL_ERR_INVALID);
    assert_int_equal(why, HL_REFUSED_VALUE);
}

static void numbers_that_are_none_are_refused(void **state)
{
    (void)state;
    static const float bad[] = { -1, NAN, INFINITY, -INFINITY, -1e-30f };
    struct hl_needs n = lit();
    struct hl_caps c;
    lavapipe(&c);
    float *number[] = { &n.budget_codes, &n.budget_ms, &n.probe.full,
                        &n.probe.half, &n.probe.eight, &n.probe.eight_blends,
                        &n.probe.three_quarters, &n.probe.quarter,
                        &n.probe.forward,
                        &c.error.full, &c.error.half, &c.error.eight,
                        &c.error.margin, &c.error.eighths[0],
                        &c.error.eighths[8] };
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
            float kept = *number[i];
            *number[i] = bad[k];
            refuse(&n, &c);
            *number[i] = kept;
        }
    con_plan(HL_PIPELINE_AUTO, &n, &c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_looser_budget_never_costs_more),
        cmocka_unit_test(a_larger_cost_never_errs_more),
        cmocka_unit_test(the_choice_is_the_cheapest_of_all),
        cmocka_unit_test(free_machines_get_the_most_accurate),
        cmocka_unit_test(both_bounds_hold_together),
        cmocka_unit_test(a_missed_budget_says_what_can_be_kept),
        cmocka_unit_test(reasons_tell_choice_from_order),
        cmocka_unit_test(what_was_asked_for_stays),
        cmocka_unit_test(without_a_budget_a_probe_changes_nothing),
        cmocka_unit_test(fixed_ranges_need_a_peak_that_tells),
        cmocka_unit_test(ten_bits_are_for_scenes_without_specular),
        cmocka_unit_test(numbers_that_are_none_are_refused),
    };
    return cmocka_run_group_tests_name("budget", tests, NULL, NULL);
}
