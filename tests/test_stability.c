/* SPDX-License-Identifier: Zlib */
/* The sweep on measures whose boundary is known, what is written, and all rows
 * on the software device. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/cli_kit.h"
#include "platforms/cli/flicker.h"
#include "platforms/host/image.h"
#include "platforms/stability/stability.h"

/* ---- measures ------------------------------------------------------------ */

enum { STEP, FALL, NOTHING, NOT_A_NUMBER, NO_MEASURE };
static uint32_t measured;

/* Steps at arg[1]. */
static bool model(double *m, double p, const struct hls_case *c,
                  struct hls_lab *lab)
{
    (void)lab;
    measured++;
    bool past = c->from < c->to ? p >= c->arg[1] : p <= c->arg[1];
    *m = c->arg[0] == STEP ? past : c->arg[0] == FALL ? !past
         : c->arg[0] == NOT_A_NUMBER && past ? (double)NAN : 0;
    return c->arg[0] != NO_MEASURE || p < c->arg[1];
}

static bool not_here(struct hls_lab *lab, const struct hls_case *c,
                     const char **skip)
{
    (void)lab;
    (void)c;
    *skip = "not here";
    return true;
}

static bool no_stage(struct hls_lab *lab, const struct hls_case *c,
                     const char **skip)
{
    (void)lab;
    (void)c;
    (void)skip;
    return false;
}

static struct hls_row row(enum hls_grid grid, const struct hls_case *c)
{
    struct hls_row r = { "model", "fails \"here\"", "none", "p, a length", "m",
                         "measure", grid, c, 1, NULL, NULL, model };
    return r;
}

static struct hls_case curve(double kind, double from, double to, double at)
{
    struct hls_case c = { "one", "a step", from, to, 0.5, kind == FALL, NAN,
                          NAN, "known, \"exactly\"", { kind, at } };
    return c;
}

static void run_fast(struct hls_result *out, enum hls_grid grid,
                     const struct hls_case *c, bool fast)
{
    static struct hls_row r;
    static struct hls_case kept;
    static struct hlc_options o;
    static struct hls_lab lab;
    o.fast = fast;
    lab.o = &o;
    kept = *c;
    r = row(grid, &kept);
    measured = 0;
    hls_run(out, &r, &kept, &lab);
    /* What could not be measured has no point. */
    assert_int_equal(out->n + (out->verdict == HLS_BROKEN), measured);
    for (uint32_t i = 1; i < out->n; i++)
        assert_true(out->p[i - 1] < out->p[i]);
}

static void run(struct hls_result *out, enum hls_grid grid,
                const struct hls_case *c)
{
    run_fast(out, grid, c, false);
}

/* ---- the sweep ----------------------------------------------------------- */

/* p* is the end of the last interval that is past: at most 1 % beyond. */
static void boundaries_are_found(void **state)
{
    static const struct { double kind, from, to, at; } t[] = {
        { STEP, 0.1, 100, 3.3 }, { FALL, 0.1, 100, 3.3 },
        { NOT_A_NUMBER, 0.1, 100, 3.3 }, { STEP, 100, 0.1, 3.3 },
        { FALL, 100, 0.1, 3.3 }, { STEP, 0.1, 100, 99.99 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        struct hls_case c = curve(t[i].kind, t[i].from, t[i].to, t[i].at);
        double up = t[i].from < t[i].to ? 1 : -1;
        struct hls_result r;
        for (int fast = 0; fast < 2; fast++) {
            run_fast(&r, HLS_LOG, &c, fast);
            assert_true(r.found && r.verdict == HLS_MOVED);
            double beyond = up * log(r.boundary / c.arg[1]);
            assert_true(beyond >= 0 && beyond <= log(1.0101));
            run_fast(&r, HLS_LINEAR, &c, fast);
            beyond = up * (r.boundary - c.arg[1]);
            assert_true(r.found && beyond >= 0 && beyond <= 0.0101 * 99.9);
        }
    }
}

static void whole_numbers_are_exact(void **state)
{
    (void)state;
    for (int at = 1; at <= 65536; at = at * 3 + 1) {
        struct hls_case c = curve(STEP, 1, 65536, at);
        struct hls_result r;
        run(&r, HLS_WHOLE, &c);
        assert_true(r.found && r.boundary == at);
        c = curve(FALL, 70000, 0, at);
        run(&r, HLS_WHOLE, &c);
        assert_true(r.found && r.boundary == at);
    }
}

static void few_numbers_are_taken_once(void **state)
{
    struct hls_case c = curve(STEP, 1, 16, 5);
    struct hls_result r;
    (void)state;
    run(&r, HLS_WHOLE, &c);
    assert_int_equal(r.n, 16);
    assert_true(r.found && r.boundary == 5 && r.at == 1);
    /* 24 ratios from 1 to 40 round to fewer numbers. */
    c = curve(STEP, 1, 40, 5);
    run(&r, HLS_WHOLE, &c);
    assert_true(r.found && r.boundary == 5);
}

static void a_sweep_has_its_steps(void **state)
{
    struct hls_case c = curve(NOTHING, 1, 100, 0);
    struct hls_result r;
    (void)state;
    run(&r, HLS_LOG, &c);
    assert_int_equal(r.n, HLS_STEPS);
    assert_true(r.p[0] == 1 && r.p[r.n - 1] == 100);
    run_fast(&r, HLS_LOG, &c, true);
    assert_int_equal(r.n, HLS_FAST_STEPS);
}

/* What is broken from the first is broken at the first. */
static void both_ends_count(void **state)
{
    struct hls_case c = curve(STEP, 2, 10, 0);
    struct hls_result r;
    (void)state;
    run(&r, HLS_LINEAR, &c);
    assert_true(r.found && r.boundary == 2 && r.n == HLS_STEPS);
    c = curve(STEP, 2, 10, 10);
    run(&r, HLS_LINEAR, &c);
    assert_true(r.found && r.boundary == 10);
}

static void verdicts(void **state)
{
    struct hls_case c = curve(NOTHING, 1, 10, 0);
    struct hls_result r;
    (void)state;
    run(&r, HLS_LINEAR, &c);
    assert_true(!r.found && isnan(r.boundary) && r.verdict == HLS_HELD);
    c.low = 4;
    c.high = 5;
    run(&r, HLS_LINEAR, &c);
    assert_int_equal(r.verdict, HLS_MOVED);
    c = curve(STEP, 1, 10, 4.5);
    c.low = 4;
    c.high = 5;
    run(&r, HLS_LINEAR, &c);
    assert_int_equal(r.verdict, HLS_HELD);
    c.high = 4.4;                      /* better than it must be             */
    run(&r, HLS_LINEAR, &c);
    assert_int_equal(r.verdict, HLS_MOVED);
    c = curve(NO_MEASURE, 1, 10, 4.5);
    run(&r, HLS_LINEAR, &c);
    assert_int_equal(r.verdict, HLS_BROKEN);
}

static void what_cannot_open_is_not_swept(void **state)
{
    static struct hlc_options o;
    struct hls_case c = curve(STEP, 1, 10, 4.5);
    struct hls_row none = row(HLS_LINEAR, &c);
    struct hls_lab lab;
    struct hls_result r;
    (void)state;
    memset(&lab, 0, sizeof lab);
    lab.o = &o;
    none.open = not_here;
    hls_run(&r, &none, &c, &lab);
    assert_true(r.verdict == HLS_SKIPPED && r.n == 0);
    assert_string_equal(r.skip, "not here");
    none.open = no_stage;
    hls_run(&r, &none, &c, &lab);
    assert_true(r.verdict == HLS_BROKEN && r.n == 0);
}

/* ---- files --------------------------------------------------------------- */

/* The result keeps a pointer to the case. */
static void at_boundary(struct hls_result *r, struct hls_case *c,
                        const struct hls_row *row_of, double p)
{
    memset(r, 0, sizeof *r);
    r->row = row_of;
    r->curve = c;
    r->found = !isnan(p);
    r->boundary = p;
    r->at = 1;
    r->verdict = HLS_MOVED;
    r->n = 2;
    r->p[1] = 10;
    r->m[0] = INFINITY;
}

static void worse_boundaries_are_noticed(void **state)
{
    static const struct { double kind, before, now; int worse; } t[] = {
        { STEP, 4, 4.05, 0 }, { STEP, 4, 3.95, 0 }, { STEP, 4, 3.8, 1 },
        { STEP, 4, NAN, 0 }, { STEP, NAN, 9, 1 }, { STEP, NAN, NAN, 0 },
        { FALL, 4, 3.8, 0 }, { FALL, 4, 4.2, 1 }, { FALL, 4, NAN, 1 },
        { FALL, NAN, 9, 0 },
    };
    char path[SK_PATH];
    struct hlh_error error;
    sk_path(path, state, "boundaries.txt");
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        struct hls_case c = curve(t[i].kind, 1, 10, 0);
        struct hls_row of = row(HLS_LINEAR, &c);
        struct hls_result r;
        at_boundary(&r, &c, &of, t[i].before);
        assert_true(hls_save(path, &r, 1, "packemu:native", false, &error));
        at_boundary(&r, &c, &of, t[i].now);
        assert_int_equal(hls_check(path, &r, 1, "packemu:native", false,
                                   &error), t[i].worse);
        assert_int_equal(hls_check(path, &r, 1, "packemu:ps3", false, &error),
                         -1);
        assert_int_equal(hls_check(path, &r, 1, "packemu:native", true,
                                   &error), -1);
    }
}

static void files_are_written(void **state)
{
    char folder[SK_PATH], path[SK_PATH + 32], note[120], *text;
    struct hls_case c = curve(STEP, 1, 10, 0);
    struct hls_row of = row(HLS_LINEAR, &c);
    struct hls_result r;
    struct hlh_error error;
    size_t size;
    at_boundary(&r, &c, &of, 4);
    sk_path(folder, state, "out");
    assert_true(hls_write(folder, &r, 1, "packemu:ps3", note, &error));
    snprintf(path, sizeof path, "%s/boundaries.csv", folder);
    assert_true(hlh_file_read(&text, &size, path, &error));
    sk_assert_contains(text, "model,one,packemu,ps3,\"p, a length\",m,4,1,,,"
                             "MOVED,\"known, \"\"exactly\"\"\"\n");
    free(text);
    remove(path);
    snprintf(path, sizeof path, "%s/curves.csv", folder);
    assert_true(hlh_file_read(&text, &size, path, &error));
    sk_assert_contains(text, "model,one,packemu,ps3,10,0,0.5\n");
    free(text);
    remove(path);
    snprintf(path, sizeof path, "%s/model.svg", folder);
    if (!note[0]) {                    /* gnuplot is here                    */
        assert_true(hlh_file_read(&text, &size, path, &error));
        sk_assert_contains(text, "one: p* = 4 (moved)");
        free(text);
        remove(path);
    }
    remove(folder);
}

/* ---- flicker ------------------------------------------------------------- */

enum { W = 24, H = 16 };

static void shade(float *out, double shift, double (*f)(double))
{
    for (int i = 0; i < W * H; i++)
        for (int k = 0; k < 3; k++)
            out[3 * i + k] = (float)f(i % W - shift);
}

static double straight(double x) { return 0.25 + x / 64; }

/* A constant error, and one that moves as the picture does, are none: a
 * straight line is what bilinear taps make of it, to 2^-24 of 1. One that comes
 * and goes by 1/4 changes by that each frame. */
static void flicker_is_what_comes_and_goes(void **state)
{
    static float picture[3 * W * H], want[3 * W * H];
    struct hlc_flicker fixed, moving, blinking;
    (void)state;
    assert_true(hlc_flicker_begin(&fixed, W, H));
    assert_true(hlc_flicker_begin(&moving, W, H));
    assert_true(hlc_flicker_begin(&blinking, W, H));
    for (uint32_t t = 0; t < 8; t++) {
        float jitter[2];
        hlc_flicker_jitter(jitter, t, 4);
        for (int i = 0; i < 3 * W * H; i++) {
            want[i] = 0.5f;
            picture[i] = 0.75f;
        }
        hlc_flicker_add(&fixed, picture, want, jitter);
        hlc_flicker_add(&blinking, t & 1 ? picture : want, want, jitter);
        shade(picture, (double)jitter[0], straight);
        hlc_flicker_add(&moving, picture, want, jitter);
    }
    assert_true(hlc_flicker_f(&fixed) == 0 && fixed.worst == 0);
    assert_true(fabs(hlc_flicker_rms(&fixed) - 0.25) < 1e-9);
    assert_true(hlc_flicker_f(&moving) < 1e-6);
    assert_true(hlc_flicker_rms(&moving) > 0.1);
    assert_true(fabs(hlc_flicker_f(&blinking) - 0.25) < 1e-9);
    hlc_flicker_end(&fixed);
    hlc_flicker_end(&moving);
    hlc_flicker_end(&blinking);
}

/* ---- rows ---------------------------------------------------------------- */

static struct hlc_options on_packemu(void)
{
    struct hlc_options o;
    memset(&o, 0, sizeof o);
    o.backend = "packemu";
    o.width = 1280;
    o.height = 720;
    o.samples = 1;
    o.ids_seed = 4;
    o.seed = 1;
    o.fast = true;
    return o;
}

/* Where theory puts them, and no worse than when stability.txt was saved:
 *   halflight stability --fast --save tests/stability.txt */
static void all_boundaries_hold(void **state)
{
    enum { MOST = 400 };
    struct hlc_options o = on_packemu();
    struct hls_lab lab;
    struct hlh_error error;
    const struct hls_row *r;
    struct hls_result *out = calloc(MOST, sizeof *out);
    uint32_t bad = 0, n = 0;
    (void)state;
    assert_non_null(out);
    memset(&lab, 0, sizeof lab);
    lab.o = &o;
    for (uint32_t i = 0; (r = hls_row(i)); i++)
        for (uint32_t k = 0; k < r->n_cases; k++, n++) {
            assert_true(n < MOST);
            hls_run(&out[n], r, &r->cases[k], &lab);
            if (out[n].verdict != HLS_MOVED && out[n].verdict != HLS_BROKEN)
                continue;
            hls_print(&out[n]);
            bad++;
        }
    assert_int_equal(bad, 0);
    assert_int_equal(hls_check("tests/stability.txt", out, n,
                               "packemu:native", true, &error), 0);
    free(out);
}

static const struct hls_case *find(const struct hls_row **r, const char *name,
                                   const char *of)
{
    for (uint32_t i = 0; (*r = hls_row(i)); i++)
        for (uint32_t k = 0; k < (*r)->n_cases; k++)
            if (!strcmp((*r)->name, name) &&
                !strcmp((*r)->cases[k].name, of))
                return &(*r)->cases[k];
    fail_msg("no row %s.%s", name, of);
    return NULL;
}

/* A build or an option that is worse is told by the boundary that theory ties
 * it to, and by the figures of a run before it. */
static void what_is_worse_moves_a_boundary(void **state)
{
    static const struct { const char *row, *of; int what; } t[] = {
        { "thin", "five_eighths", 0 },   /* no filter                        */
        { "motion", "centroids", 1 },    /* light at pixel centres, as
                                          * published                        */
        { "tilt", "slope_225", 2 },      /* slope factor of a half           */
        { "half_pixel", "across", 3 },   /* integer centres left alone       */
    };
    struct hls_lab lab;
    char path[SK_PATH];
    struct hlh_error error;
    memset(&lab, 0, sizeof lab);
    sk_path(path, state, "boundaries.txt");
    for (size_t i = 0; i < sizeof t / sizeof *t; i++) {
        struct hlc_options good = on_packemu(), bad;
        const struct hls_row *r;
        const struct hls_case *c = find(&r, t[i].row, t[i].of);
        struct hls_result out;
        if (t[i].what == 3)
            good.profile = "xbox360";
        lab.o = &good;
        hls_run(&out, r, c, &lab);
        assert_int_equal(out.verdict, HLS_HELD);
        assert_true(hls_save(path, &out, 1, "m", true, &error));
        bad = good;
        bad.dsf = t[i].what == 0 ? HL_DSF_NONE : HL_DSF_AUTO;
        bad.no_centroid = t[i].what == 1;
        bad.fill = t[i].what == 1 ? HL_FILL_BILINEAR : HL_FILL_AUTO;
        bad.dsf_k = t[i].what == 2 ? 0.5 : 0;
        bad.half_pixel = t[i].what == 3 ? HL_HALF_PIXEL_NONE
                                        : HL_HALF_PIXEL_AUTO;
        lab.o = &bad;
        hls_run(&out, r, c, &lab);
        assert_int_equal(out.verdict, HLS_MOVED);
        assert_int_equal(hls_check(path, &out, 1, "m", true, &error), 1);
    }
}

/* ---- the command --------------------------------------------------------- */

static void the_tool_refuses_in_a_line(void **state)
{
    static const struct tool_line bad[] = {
        { "stability --only nothing", "no row begins with it" },
        { "stability thin", "takes no further argument" },
        { "stability --out here/there/out --only self", "here/there" },
        { "stability --fast --check missing.txt", "missing.txt" },
    };
    static const struct tool_line none[] = {
        { "stability --backend null", "draws nothing" },
    };
    TOOL_REFUSE(bad, 2);
    TOOL_REFUSE(none, 3);
}

static void the_tool_says_what_moved(void **state)
{
    static struct tool_run t;
    tool_done(&t, state, "stability --fast --only gap.slope --save was.txt");
    sk_assert_contains(t.out, "1 held, 0 moved, 0 broken, 0 skipped");
    tool_done(&t, state, "stability --fast --only gap.slope --check was.txt "
                         "--json -");
    cJSON *j = tool_json(t.out);
    assert_true(tool_number(j, "held") == 1 && tool_number(j, "moved") == 0);
    const cJSON *c = cJSON_GetArrayItem(tool_at(j, "cases"), 0);
    assert_string_equal(tool_text(c, "verdict"), "held");
    assert_true(tool_number(c, "boundary") >= tool_number(c, "low") &&
                tool_number(c, "boundary") <= tool_number(c, "high"));
    cJSON_Delete(j);
    tool_run(&t, state, "stability --fast --only gap.slope --check was.txt "
                        "--dsf-c 0.02");
    assert_int_equal(t.code, 1);
    sk_assert_contains(t.err, "gap.slope: boundary was 0.001003, now 0.0");
    tool_done(&t, state, "stability --list --only gap");
    sk_assert_contains(t.out, "slope");
}

int main(int argc, char **argv)
{
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boundaries_are_found),
        cmocka_unit_test(whole_numbers_are_exact),
        cmocka_unit_test(few_numbers_are_taken_once),
        cmocka_unit_test(a_sweep_has_its_steps),
        cmocka_unit_test(both_ends_count),
        cmocka_unit_test(verdicts),
        cmocka_unit_test(what_cannot_open_is_not_swept),
        cmocka_unit_test(worse_boundaries_are_noticed),
        cmocka_unit_test(files_are_written),
        cmocka_unit_test(flicker_is_what_comes_and_goes),
        cmocka_unit_test(the_tool_refuses_in_a_line),
        cmocka_unit_test(the_tool_says_what_moved),
        cmocka_unit_test(what_is_worse_moves_a_boundary),
        cmocka_unit_test(all_boundaries_hold),
    };
    return cmocka_run_group_tests(tests, sk_setup, sk_teardown);
}
