/* SPDX-License-Identifier: Zlib */
/* Probes of scenes on packemu, and that what is drawn within a budget keeps
 * it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/probe.h"
#include "platforms/reference/reference.h"
#include "tests/check.h"

enum { WORDS = 16 };

struct open_scene {
    struct hlc_options o;
    struct hlc_stage stage;
    char words[256];             /* argv points into it                      */
};

static void open_scene(struct open_scene *s, const char *line)
{
    char *argv[WORDS];
    int n = 0;
    struct hlh_scene scene;
    struct hlh_error error;
    snprintf(s->words, sizeof s->words, "halflight render %s", line);
    for (char *w = strtok(s->words, " "); w && n < WORDS;
         w = strtok(NULL, " "))
        argv[n++] = w;
    assert_int_equal(hlc_options_parse(&s->o, n, argv), HLC_DONE);
    assert_true(hlc_scene_open(&scene, &s->o, &error));
    assert_int_equal(hlc_stage_open(&s->stage, &scene, &s->o), HLC_DONE);
}

static struct hl_probe probe(struct open_scene *s)
{
    struct hl_probe p;
    memset(&p, 0xC3, sizeof p);
    assert_int_equal(hlc_probe_measure(&p, &s->stage, &s->o), HLC_DONE);
    return p;
}

static struct hl_probe probe_of(const char *line)
{
    struct open_scene s;
    open_scene(&s, line);
    struct hl_probe p = probe(&s);
    hlc_stage_close(&s.stage);
    return p;
}

/* ---- what it finds ------------------------------------------------------ */

/* Less light buffer, more error; and the same every time. */
static void a_probe_orders_what_it_draws(void **state)
{
    (void)state;
    static const char line[] = "fig8 --size 160x90 --backend packemu";
    struct hl_probe p = probe_of(line), again = probe_of(line);
    assert_true(p.full > 1e-6f && p.full < p.three_quarters);
    assert_true(p.three_quarters < p.half && p.half < p.quarter);
    assert_true(p.quarter < 64);
    assert_true(p.eight > 1 && p.eight < 64);
    assert_true(p.eight_blends >= 1);
    assert_memory_equal(&p, &again, sizeof p);
}

/* Nothing to err about is not "unknown". */
static void a_scene_without_lights_errs_by_nothing(void **state)
{
    (void)state;
    struct hl_probe p = probe_of("fig8 --size 64x36 --backend packemu "
                                 "--lights /dev/null --lights-mode replace");
    const float x[] = { p.half, p.three_quarters, p.quarter };
    assert_true(p.full > 0 && p.full == p.forward);
    for (size_t i = 0; i < sizeof x / sizeof *x; i++)
        assert_true(x[i] > 0 && x[i] < 1e-6f);
}

/* Forward has no shadows, the truth has. */
static void shadows_are_compared_with_the_truth(void **state)
{
    (void)state;
    struct hl_probe plain = probe_of("lidr --size 96x54 --backend packemu");
    struct hl_probe maps = probe_of("lidr --size 96x54 --backend packemu "
                                    "--shadows maps --shadow-size 64 "
                                    "--shadow-lights all");
    struct hl_probe sharp = probe_of("lidr --size 96x54 --backend packemu "
                                     "--shadows volumes --shadow-lights all");
    assert_true(plain.forward > 0 && maps.forward == 0);
    assert_true(maps.full > sharp.full && sharp.full > 0);
}

/* 1280 x 720 texels of it do not fit: the rest counts against forward. */
static void edram_may_not_hold_the_whole(void **state)
{
    (void)state;
    struct hl_probe p = probe_of("many --size 1280x720 --backend packemu "
                                 "--profile xbox360");
    assert_true(p.full > 0 && p.full < 1e-6f);
    assert_true(p.half > 0.1f && p.quarter > p.half);
    assert_true(p.eight == 0 && p.eight_blends == 0);
}

static void a_machine_that_draws_nothing_knows_nothing(void **state)
{
    (void)state;
    struct hl_probe p = probe_of("fig8 --size 64x36 --backend null"), none;
    memset(&none, 0, sizeof none);
    assert_memory_equal(&p, &none, sizeof p);
}

static void the_options_stay_as_they_are(void **state)
{
    (void)state;
    struct open_scene s;
    open_scene(&s, "fig8 --size 64x36 --backend packemu --max-error 3 "
               "--light-size 32x18 --pipeline forward");
    struct hlc_options before = s.o;
    struct hl_probe p = probe(&s);
    assert_memory_equal(&s.o, &before, sizeof before);
    assert_true(p.half > 0 && hlc_probe_wanted(&s.o));
    s.o.has_max_error = false;
    assert_false(hlc_probe_wanted(&s.o));
    s.o.max_cost = 1;
    assert_true(hlc_probe_wanted(&s.o));
    hlc_stage_close(&s.stage);
}

/* ---- what it is for ----------------------------------------------------- */

static void truth(struct hlh_picture *out, const struct open_scene *s)
{
    struct hlr_stats stats;
    struct hlr_options r = { .width = s->o.width, .height = s->o.height,
                             .samples = s->o.samples, .normal_maps = true,
                             .no_specular = s->o.no_specular,
                             .shadows = s->o.shadows != HL_SHADOWS_NONE };
    size_t n = (size_t)r.width * r.height * 3;
    *out = (struct hlh_picture){ r.width, r.height, malloc(n * sizeof(float)),
                                 true };
    assert_true(hlr_render(out->rgb, NULL, &s->stage.scene, &r, &stats));
}

/* False: no plan keeps the budget. */
static bool draw(struct hlh_picture *out, struct hl_plan *plan,
                 struct open_scene *s, const struct hl_probe *p)
{
    struct hlc_shot shot;
    char line[HLC_PLAN_LINE];
    if (hlc_shot_open(&shot, &s->stage, &s->o, NULL, p, line) != HLC_DONE) {
        assert_non_null(strstr(line, "no plan keeps to the budget: the best "
                                     "plans come to"));
        return false;
    }
    assert_int_equal(hlc_shot_draw(&shot, NULL), HL_OK);
    assert_int_equal(hlc_shot_read(&shot, out), HL_OK);
    *plan = shot.plan;
    hlc_shot_close(&shot);
    return true;
}

/* Every budget that is accepted is kept by the picture, by whichever pipeline,
 * and the loosest by a plan that costs less than the strictest. */
static void keep_budgets(const char *line)
{
    struct open_scene s;
    struct hlh_picture right, p;
    struct hl_plan plan;
    float first = 0, last = 0;
    open_scene(&s, line);
    struct hl_probe found = probe(&s);
    truth(&right, &s);
    s.o.has_max_error = true;
    for (s.o.max_error = 0.5; s.o.max_error <= 32; s.o.max_error *= 2) {
        if (!draw(&p, &plan, &s, &found)) {
            assert_true(first == 0);
            continue;
        }
        assert_true(hlc_rms_codes(&p, &right) <= s.o.max_error);
        assert_true((double)plan.error_codes <= s.o.max_error);
        first = first > 0 ? first : plan.cost_ms;
        last = plan.cost_ms;
        hlh_picture_free(&p);
    }
    assert_true(last > 0 && last < first);
    hlh_picture_free(&right);
    hlc_stage_close(&s.stage);
}

static void budgets_are_kept_by_pictures(void **state)
{
    (void)state;
    keep_budgets("fig8 --size 160x90 --backend packemu");
    keep_budgets("thin --size 160x90 --backend packemu");
    keep_budgets("fig9 --size 160x90 --backend packemu --samples 4 "
                 "--pipeline inferred");
    keep_budgets("lidr --size 160x90 --backend packemu --no-specular");
    keep_budgets("fig7 --size 96x54 --backend packemu --shadows volumes "
                 "--shadow-lights all");
}

static void budgets_are_kept_by_the_rules_of_consoles(void **state)
{
    (void)state;
    keep_budgets("fig8 --size 160x90 --backend packemu --profile xbox360");
    keep_budgets("fig8 --size 160x90 --backend packemu --profile ps3");
    keep_budgets("fig8 --size 160x90 --backend packemu --profile dx10");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_probe_orders_what_it_draws),
        cmocka_unit_test(a_scene_without_lights_errs_by_nothing),
        cmocka_unit_test(shadows_are_compared_with_the_truth),
        cmocka_unit_test(edram_may_not_hold_the_whole),
        cmocka_unit_test(a_machine_that_draws_nothing_knows_nothing),
        cmocka_unit_test(the_options_stay_as_they_are),
        cmocka_unit_test(budgets_are_kept_by_pictures),
        cmocka_unit_test(budgets_are_kept_by_the_rules_of_consoles),
    };
    return cmocka_run_group_tests_name("probe", tests, NULL, NULL);
}
