/* SPDX-License-Identifier: Zlib */
/* Regret: its figures from tables by hand, and what planning within a budget
 * really comes to, over scenes that were calibrated on and others. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/count.h"
#include "platforms/chart/regret.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/probe.h"
#include "platforms/host/image.h"
#include "tests/check.h"
#include "tests/scene_kit.h"

enum { ROWS = 160 };

/* ---- tables by hand ----------------------------------------------------- */

static struct hlt_row *add(struct hlt_table *t, const char *scene,
                           const char *way, double budget, double cost,
                           double codes)
{
    struct hlt_row *r = &t->rows[t->n++];
    memset(r, 0, sizeof *r);
    for (int i = 0; i < HLT_COLUMNS; i++)
        r->value[i] = NAN;
    snprintf(r->scene, sizeof r->scene, "%s", scene);
    snprintf(r->machine, sizeof r->machine, "packemu");
    snprintf(r->way, sizeof r->way, "%s", way);
    snprintf(r->pipeline, sizeof r->pipeline, "inferred");
    r->budget = budget;
    r->samples = 1;
    r->value[HLT_COST] = cost;
    r->value[HLT_CODES] = codes;
    return r;
}

static void timed(struct hlt_row *r, double low, double middle, double high)
{
    r->value[HLT_RATIO] = middle;
    r->value[HLT_RATIO_LOW] = low;
    r->value[HLT_RATIO_HIGH] = high;
}

static void refused(struct hlt_row *r)
{
    r->pipeline[0] = 0;
    r->value[HLT_COST] = r->value[HLT_CODES] = NAN;
}

static void by_hand(struct hlt_table *t)
{
    timed(add(t, "fig8", "a", 0, 100, 3), 0.9, 1.0, 1.1);
    add(t, "fig8", "b", 0, 200, 1);
    add(t, "fig8", "c", 0, 10, 0.1)->samples = 4;
    snprintf(add(t, "fig8", "d", 0, 10, 0.1)->machine, HLT_MACHINE, "vulkan");
    add(t, "many", "e", 0, 10, 0.1);
    timed(add(t, "fig8", "auto 4", 4, 120, 2), 1.8, 2.0, 2.2);
    add(t, "fig8", "auto 2", 2, 100, 3);
    add(t, "fig8", "auto 1", 1, 150, 0.5);
    refused(add(t, "fig8", "auto 0.5", 0.5, 0, 0));
    add(t, "new,scene", "f", 0, 50, 1);
    refused(add(t, "new,scene", "auto 1", 1, 0, 0));
    add(t, "new,scene", "auto 8", 8, 100, 2);
    add(t, "new,scene", "auto 0.1", 0.1, 100, 0.1);
}

static void verdicts_by_hand(void **state)
{
    struct hlt_row rows[ROWS];
    struct hlt_table t = { .rows = rows };
    uint32_t n;
    (void)state;
    by_hand(&t);
    struct hlt_case *c = hlt_cases(&n, &t);
    assert_int_equal(n, 7);
    assert_string_equal(c[0].best->way, "a");
    assert_true(c[0].verdict == HLT_MET && c[0].calibrated);
    ck_near(c[0].regret, 1.2, 1e-12);
    ck_near(c[0].time, 2, 1e-12);
    ck_near(c[0].time_low, 1.8 / 1.1, 1e-12);
    ck_near(c[0].time_high, 2.2 / 0.9, 1e-12);
    assert_true(c[1].verdict == HLT_BROKEN);
    assert_string_equal(c[1].best->way, "b");
    ck_near(c[1].regret, 0.5, 1e-12);
    assert_true(c[2].verdict == HLT_MET && isnan(c[2].time));
    ck_near(c[2].regret, 0.75, 1e-12);
    assert_true(c[3].verdict == HLT_REFUSED && !c[3].best);
    assert_true(isnan(c[3].regret));
    assert_true(c[4].verdict == HLT_REFUSED_WRONGLY && !c[4].calibrated);
    ck_near(c[5].regret, 2, 1e-12);
    assert_true(c[6].verdict == HLT_MET && !c[6].best);
    ck_near(c[6].regret, 1, 0);
    free(c);
}

static void sums_by_hand(void **state)
{
    struct hlt_row rows[ROWS];
    struct hlt_table t = { .rows = rows };
    struct hlt_regret s;
    (void)state;
    assert_true(hlt_regret_of(&s, &t));
    assert_true(s.n == 0 && s.worst == 0 && s.mean == 0);
    by_hand(&t);
    assert_true(hlt_regret_of(&s, &t));
    assert_true(s.n == 7 && s.n_new == 3);
    assert_true(s.broken == 1 && s.broken_new == 0);
    assert_true(s.refused == 1 && s.refused_wrongly == 1);
    ck_near(s.worst, 2, 1e-12);
    ck_near(s.worst_new, 2, 1e-12);
    /* (1.2 * 0.5 * 0.75 * 2 * 1) ^ (1 / 5) */
    ck_near(s.mean, pow(0.9, 0.2), 1e-12);
}

/* A figure that is missing is no budget that was kept. */
static void unknown_errors_break(void **state)
{
    struct hlt_row rows[ROWS];
    struct hlt_table t = { .rows = rows };
    struct hlt_regret s;
    (void)state;
    add(&t, "fig8", "auto 4", 4, 120, NAN);
    assert_true(hlt_regret_of(&s, &t));
    assert_int_equal(s.broken, 1);
}

static void csv_by_hand(void **state)
{
    struct hlt_row rows[ROWS];
    struct hlt_table t = { .rows = rows };
    struct hlh_error error;
    char path[SK_PATH], *text;
    size_t size;
    by_hand(&t);
    sk_path(path, state, "regret.csv");
    assert_true(hlt_regret_write(&t, path, &error));
    assert_true(hlh_file_read(&text, &size, path, &error));
    sk_assert_contains(text, "fig8,packemu,1,4,yes,met,inferred,120,2,a,100,3,"
                       "1.2,2,1.636,2.444\n");
    sk_assert_contains(text, "fig8,packemu,1,0.5,yes,refused,none,,,,,,,,,\n");
    sk_assert_contains(text, "\"new,scene\",packemu,1,1,no,refused wrongly,"
                       "none,,,f,50,1,,,,\n");
    free(text);
    sk_path(path, state, "no/regret.csv");
    assert_false(hlt_regret_write(&t, path, &error));
    sk_assert_contains(error.text, "no/regret.csv");
}

/* ---- what a budget comes to --------------------------------------------- */

static const char *const scenes[] = { "fig8", "many", "fig7", "thin" };
static const double budgets[] = { 1, 2, 4, 8 };
static const enum hl_format formats[] = {
    HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGBA16_UNORM, HL_FORMAT_RGBA16_FLOAT
};

struct sweep {
    struct hlt_table *t;
    struct hlc_options o;
    struct hlc_stage stage;
    struct hlh_picture truth;
    struct hl_probe probe;
};

static void measure(struct hlt_row *r, struct hlc_shot *shot,
                    const struct hlh_picture *truth)
{
    struct hlt_counts counts;
    struct hlh_picture p;
    assert_int_equal(hlt_count(&counts, shot), HL_OK);
    assert_int_equal(hlc_shot_draw(shot, NULL), HL_OK);
    assert_int_equal(hlc_shot_read(shot, &p), HL_OK);
    r->value[HLT_COST] = hlt_weigh(&counts, &shot->plan,
                                   &shot->stage->machine.caps);
    r->value[HLT_CODES] = hlc_rms_codes(&p, truth);
    hlh_picture_free(&p);
}

/* What is not planned is left out, but not where it is a budget's. */
static void add_shot(struct sweep *s, const struct hlc_options *o,
                     const char *way)
{
    struct hlc_shot shot;
    char line[HLC_PLAN_LINE];
    double budget = o->has_max_error ? o->max_error : 0;
    int code = hlc_shot_open(&shot, &s->stage, o, NULL,
                             budget > 0 ? &s->probe : NULL, line);
    if (code != HLC_DONE && !(budget > 0))
        return;
    assert_true(s->t->n < ROWS);
    struct hlt_row *r = add(s->t, s->stage.scene.name, way, budget, NAN, NAN);
    if (code != HLC_DONE) {
        refused(r);
        return;
    }
    snprintf(r->pipeline, sizeof r->pipeline, "%s",
             shot.plan.pipeline == HL_PIPELINE_INFERRED ? "inferred"
                                                        : "forward");
    r->light_width = shot.plan.light_width;
    r->light_height = shot.plan.light_height;
    snprintf(r->light_format, sizeof r->light_format, "%s",
             shot.plan.pipeline == HL_PIPELINE_INFERRED ? hl_format_info(
             hl_plan_target(&shot.plan, HL_ROLE_LIGHT)->format)->name : "");
    measure(r, &shot, &s->truth);
    hlc_shot_close(&shot);
}

static void add_inferred(struct sweep *s, uint32_t eighths, enum hl_format f)
{
    struct hlc_options o = s->o;
    char way[48];
    o.pipeline = HL_PIPELINE_INFERRED;
    o.light_width = (o.width * eighths + 4) / 8;
    o.light_height = (o.height * eighths + 4) / 8;
    o.light_format = f;
    snprintf(way, sizeof way, "%u/8 %s", (unsigned)eighths,
             hl_format_info(f)->name);
    add_shot(s, &o, way);
}

static void sweep_scene(struct sweep *s)
{
    struct hlc_options o = s->o;
    o.pipeline = HL_PIPELINE_FORWARD;
    add_shot(s, &o, "forward");
    o.pipeline = HL_PIPELINE_FORWARD_MULTIPASS;
    add_shot(s, &o, "multipass");
    for (uint32_t k = 2; k <= 8; k++)
        for (size_t f = 0; f < sizeof formats / sizeof *formats; f++)
            add_inferred(s, k, formats[f]);
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        o = s->o;
        o.has_max_error = true;
        o.max_error = budgets[i];
        add_shot(s, &o, "auto");
    }
}

static void open_scene(struct sweep *s, const char *name)
{
    char scene[16], backend[] = "--backend", packemu[] = "packemu",
         size[] = "--size", small[] = "256x144", tool[] = "halflight",
         plan[] = "plan";
    char *argv[] = { tool, plan, scene, backend, packemu, size, small, NULL };
    struct hlh_scene loaded;
    struct hlh_error error;
    snprintf(scene, sizeof scene, "%s", name);
    assert_int_equal(hlc_options_parse(&s->o, 7, argv), HLC_DONE);
    s->o.arg[0] = name;
    assert_true(hlc_scene_open(&loaded, &s->o, &error));
    assert_int_equal(hlc_stage_open(&s->stage, &loaded, &s->o), HLC_DONE);
    assert_int_equal(hlc_probe_measure(&s->probe, &s->stage, &s->o),
                     HLC_DONE);
    hlc_probe_truth(&s->truth, &s->stage, &s->o);
    assert_non_null(s->truth.rgb);
}

/* The demand: no budget broken, and never a quarter above the cheapest way
 * that is within it. */
static void budgets_are_kept_at_little_regret(void **state)
{
    static struct hlt_row rows[ROWS];
    struct hlt_table t = { .rows = rows };
    struct hlt_regret r;
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct sweep s;
        memset(&s, 0, sizeof s);
        s.t = &t;
        open_scene(&s, scenes[i]);
        sweep_scene(&s);
        hlh_picture_free(&s.truth);
        hlc_stage_close(&s.stage);
    }
    hlt_regret_print(&t);
    assert_true(hlt_regret_of(&r, &t));
    assert_int_equal(r.n, 16);
    assert_int_equal(r.n_new, 8);
    assert_int_equal(r.broken, 0);
    assert_int_equal(r.refused_wrongly, 0);
    assert_true(r.worst <= 1.25);
    /* Budgets that are met by anything, or by nothing, would show nothing. */
    uint32_t within[2] = { 0, 0 };
    for (uint32_t i = 0; i < t.n; i++)
        if (!(rows[i].budget > 0))
            within[rows[i].value[HLT_CODES] <= 4]++;
    assert_true(within[0] > 10 && within[1] > 10 && r.refused < r.n / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(verdicts_by_hand),
        cmocka_unit_test(sums_by_hand),
        cmocka_unit_test(unknown_errors_break),
        cmocka_unit_test(csv_by_hand),
        cmocka_unit_test(budgets_are_kept_at_little_regret),
    };
    return cmocka_run_group_tests_name("regret", tests, sk_setup,
                                       sk_teardown);
}
