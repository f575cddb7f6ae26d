/* SPDX-License-Identifier: Zlib */
/* Fronts, areas and what became worse, over tables that are made up. */
#include "tests/check.h"
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/chart/chart.h"
#include "tests/scene_kit.h"

enum { ROWS = 40 };

/* Logarithms and powers of numbers of this size, twice: some ulps of 2^-52. */
#define ROUNDED 1e-12

static struct hlt_table empty(void)
{
    struct hlt_table t;
    memset(&t, 0, sizeof t);
    t.rows = calloc(ROWS, sizeof *t.rows);
    assert_non_null(t.rows);
    t.width = 32;
    t.height = 18;
    return t;
}

/* All columns of error that are asked for, from one amplitude. */
static struct hlt_row *add(struct hlt_table *t, const char *scene,
                           const char *way, double cost, double error)
{
    struct hlt_row *r = &t->rows[t->n++];
    assert_true(t->n <= ROWS);
    snprintf(r->scene, sizeof r->scene, "%s", scene);
    snprintf(r->machine, sizeof r->machine, "m");
    snprintf(r->way, sizeof r->way, "%s", way);
    for (int k = 0; k < HLT_COLUMNS; k++)
        r->value[k] = error;
    r->value[HLT_COST] = cost;
    r->value[HLT_PSNR] = -20 * log10(error);
    r->value[HLT_SSIM] = 1 - error;
    return r;
}

static struct hlt_point *points(uint32_t *n, const struct hlt_table *t,
                                const char *scene)
{
    struct hlt_point *p = hlt_points(n, t, scene, "m", HLT_COST, HLT_FLIP);
    assert_non_null(p);
    return p;
}

/* ---- fronts ------------------------------------------------------------- */

static bool beaten(const struct hlt_point *p, const struct hlt_point *by)
{
    return by->cost <= p->cost && by->error <= p->error &&
           (by->cost < p->cost || by->error < p->error);
}

/* Small whole numbers, so that many are equal in one or both. */
static struct hlt_table random_table(uint64_t *seed, uint32_t range)
{
    struct hlt_table t = empty();
    uint32_t n = 1 + mk_below(seed, ROWS);
    for (uint32_t i = 0; i < n; i++) {
        char way[16];
        snprintf(way, sizeof way, "w%u", (unsigned)(i * 7 % n));
        add(&t, "s", way, 1 + mk_below(seed, range), 1 + mk_below(seed, range));
    }
    return t;
}

static void no_point_of_a_front_is_beaten(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int round = 0; round < 300; round++) {
        uint32_t n;
        struct hlt_table t = random_table(&seed, round % 3 ? 12 : 1000);
        struct hlt_point *p = points(&n, &t, "s");
        assert_int_equal(n, t.n);
        for (uint32_t i = 0; i < n; i++) {
            bool kept = true;
            for (uint32_t k = 0; k < n; k++)
                kept = kept && !beaten(&p[i], &p[k]);
            assert_int_equal(p[i].front, kept);
            assert_true(i == 0 || p[i - 1].cost <= p[i].cost);
        }
        free(p);
        free(t.rows);
    }
}

static void the_order_of_rows_does_not_matter(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct hlt_table t = random_table(&seed, 6);
    uint32_t n, m;
    for (uint32_t i = 0; i < t.n; i++)
        snprintf(t.rows[i].way, sizeof t.rows[i].way, "w%u", (unsigned)i);
    struct hlt_point *p = points(&n, &t, "s");
    char *names = malloc((size_t)n * HLT_NAME);
    assert_non_null(names);
    for (uint32_t i = 0; i < n; i++)
        memcpy(names + i * HLT_NAME, p[i].row->way, HLT_NAME);
    for (uint32_t i = 0; i < t.n / 2; i++) {
        struct hlt_row row = t.rows[i];
        t.rows[i] = t.rows[t.n - 1 - i];
        t.rows[t.n - 1 - i] = row;
    }
    struct hlt_point *q = points(&m, &t, "s");
    assert_int_equal(m, n);
    for (uint32_t i = 0; i < n; i++)
        assert_string_equal(names + i * HLT_NAME, q[i].row->way);
    free(names);
    free(p);
    free(q);
    free(t.rows);
}

static void what_has_no_place_is_left_out(void **state)
{
    (void)state;
    struct hlt_table t = empty();
    uint32_t n;
    add(&t, "s", "kept", 2, 2);
    add(&t, "other scene", "kept", 1, 1);
    add(&t, "s", "budget", 1, 1)->budget = 4;
    add(&t, "s", "no cost", (double)NAN, 1);
    add(&t, "s", "not counted", 0, 1);
    add(&t, "s", "no error", 1, 1)->value[HLT_FLIP] = (double)NAN;
    strcpy(add(&t, "s", "elsewhere", 1, 1)->machine, "n");
    struct hlt_point *p = points(&n, &t, "s");
    assert_int_equal(n, 1);
    assert_string_equal(p[0].row->way, "kept");
    assert_string_equal(p[0].row->scene, "s");
    free(p);
    p = points(&n, &t, "no such scene");
    assert_int_equal(n, 0);
    free(p);
    free(t.rows);
}

static double error_of(const struct hlt_table *t, enum hlt_column column)
{
    uint32_t n;
    struct hlt_point *p = hlt_points(&n, t, "s", "m", HLT_COST, column);
    assert_non_null(p);
    assert_int_equal(n, 1);
    double error = p[0].error;
    free(p);
    return error;
}

static void goodness_becomes_error(void **state)
{
    (void)state;
    struct hlt_table t = empty();
    struct hlt_row *r = add(&t, "s", "w", 1, 0.01);
    r->value[HLT_PSNR] = 40;
    r->value[HLT_SSIM] = 0.75;
    ck_near(error_of(&t, HLT_PSNR), 0.01, ROUNDED);
    ck_near(error_of(&t, HLT_SSIM), 0.25, 0);
    ck_near(error_of(&t, HLT_FLIP), 0.01, 0);
    r->value[HLT_PSNR] = (double)INFINITY;
    r->value[HLT_SSIM] = 1;
    r->value[HLT_FLIP] = r->value[HLT_RELMSE] = 0;
    ck_near(error_of(&t, HLT_PSNR), 1e-8, 0);
    ck_near(error_of(&t, HLT_SSIM), 1e-8, 0);
    ck_near(error_of(&t, HLT_FLIP), 1e-8, 0);
    ck_near(error_of(&t, HLT_RELMSE), 1e-16, 0);
    free(t.rows);
}

static void times_have_quartiles(void **state)
{
    (void)state;
    struct hlt_table t = empty();
    uint32_t n;
    struct hlt_row *r = add(&t, "s", "w", 1, 0.01);
    r->value[HLT_RATIO] = 2;
    r->value[HLT_RATIO_LOW] = 1.5;
    r->value[HLT_RATIO_HIGH] = 3;
    struct hlt_point *p = hlt_points(&n, &t, "s", "m", HLT_RATIO, HLT_FLIP);
    assert_non_null(p);
    assert_true(p->cost == 2 && p->low == 1.5 && p->high == 3);
    free(p);
    p = points(&n, &t, "s");
    assert_true(p->cost == 1 && p->low == 1 && p->high == 1);
    free(p);
    free(t.rows);
}

static void means_are_of_ways_that_all_scenes_have(void **state)
{
    (void)state;
    struct hlt_table t = empty();
    uint32_t n;
    add(&t, "b", "w", 8, 0.09);
    add(&t, "a", "only a", 1, 1);
    add(&t, "a", "w", 2, 0.01);
    add(&t, "a", "no figure", 2, 0.01);
    add(&t, "b", "no figure", 2, (double)NAN);
    strcpy(add(&t, "c", "of another machine", 2, 1)->machine, "n");
    struct hlt_point *p = points(&n, &t, NULL);
    assert_int_equal(n, 1);
    ck_near(p->cost, 4, 4 * ROUNDED);
    ck_near(p->error, 0.03, 0.03 * ROUNDED);
    assert_string_equal(p->row->scene, "a");
    assert_string_equal(p->row->way, "w");
    assert_true(p->front);
    free(p);
    free(t.rows);
}

/* ---- areas -------------------------------------------------------------- */

/* The area by cells of a grid whose lines are all costs and errors: powers of
 * two of whole numbers, so that the sums are exact. */
static double area_by_cells(const struct hlt_point *p, uint32_t n, int corner)
{
    double area = 0;
    for (int x = -corner; x < corner; x++)
        for (int y = -corner; y < corner; y++) {
            bool taken = false;
            for (uint32_t i = 0; i < n; i++)
                taken = taken || (log2(p[i].cost) <= x &&
                                  log2(p[i].error) <= y);
            area += taken;
        }
    return area;
}

static void areas_are_those_of_the_cells(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int round = 0; round < 60; round++) {
        struct hlt_table t = empty();
        uint32_t n = mk_below(&seed, ROWS), m;
        for (uint32_t i = 0; i < n; i++)
            add(&t, "s", "w", exp2((int)mk_below(&seed, 24) - 8),
                exp2((int)mk_below(&seed, 24) - 8));
        struct hlt_point *p = points(&m, &t, "s");
        ck_near(hlt_hypervolume(p, m, 256, 256), area_by_cells(p, m, 8), 0);
        free(p);
        free(t.rows);
    }
}

/* ---- what became worse -------------------------------------------------- */

static struct hlt_table stairs(void)
{
    struct hlt_table t = empty();
    add(&t, "s", "cheap", 1, 0.8);
    add(&t, "s", "middle", 2, 0.4);
    add(&t, "s", "good", 4, 0.1);
    add(&t, "s", "poor", 8, 1);
    return t;
}

/* hlt_check with stderr kept in `said`. */
static int check(const struct hlt_table *t, const char *path, char said[2048],
                 struct hlh_error *error)
{
    FILE *f = tmpfile();
    assert_non_null(f);
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    dup2(fileno(f), STDERR_FILENO);
    int worse = hlt_check(t, path, error);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    rewind(f);
    said[fread(said, 1, 2047, f)] = 0;
    fclose(f);
    return worse;
}

/* Octaves below the corner (8, 1) of the stairs: 3 x log2(1 / 0.8) +
 * 2 x log2(0.8 / 0.4) + 1 x log2(0.4 / 0.1) = 4.9658. A tenth more error on
 * each step takes 3 x log2(1.1) = 0.4125 of it. */
static void what_becomes_worse_is_said(void **state)
{
    char path[SK_PATH], said[2048];
    struct hlh_error error;
    struct hlt_table t = stairs();
    sk_path(path, state, "saved.txt");
    assert_true(hlt_save(&t, path, &error));
    assert_int_equal(check(&t, path, said, &error), 0);
    assert_string_equal(said, "");
    for (int i = 0; i < 3; i++)
        t.rows[i].value[HLT_FLIP] *= 1.1;
    assert_int_equal(check(&t, path, said, &error), 1);
    assert_string_equal(said, "halflight: s on m, flip, all ways: the "
                        "front's area is 4.553, was 4.966 (-8.3 %): worse\n");
    /* 2 % of 4.9658 is 3 x log2(1.0232). */
    for (int i = 0; i < 3; i++)
        t.rows[i].value[HLT_FLIP] *= 1.0225 / 1.1;
    assert_int_equal(check(&t, path, said, &error), 0);
    assert_string_equal(said, "");
    for (int i = 0; i < 3; i++)
        t.rows[i].value[HLT_FLIP] *= 1.024 / 1.0225;
    assert_int_equal(check(&t, path, said, &error), 1);
    for (int i = 0; i < 3; i++)
        t.rows[i].value[HLT_FLIP] /= 1.1;
    assert_int_equal(check(&t, path, said, &error), 0);
    sk_assert_contains(said, "flip, all ways: the front's area is 5.2");
    sk_assert_contains(said, "better, to be saved anew");
    free(t.rows);
}

static void more_cost_is_worse_in_all_measures(void **state)
{
    char path[SK_PATH], said[2048];
    struct hlh_error error;
    struct hlt_table t = stairs();
    sk_path(path, state, "cost.txt");
    assert_true(hlt_save(&t, path, &error));
    for (int i = 0; i < 3; i++)
        t.rows[i].value[HLT_COST] *= 1.1;
    /* Five of all ways, two of the group without a name. */
    assert_int_equal(check(&t, path, said, &error), 7);
    free(t.rows);
}

/* The front is forward's, wherever the others go; one way alone has an area of
 * one octave by one. */
static void a_group_behind_the_front_is_watched(void **state)
{
    char path[SK_PATH], said[2048];
    struct hlh_error error;
    struct hlt_table t = stairs();
    for (uint32_t i = 0; i < t.n; i++)
        strcpy(t.rows[i].group, "size");
    strcpy(add(&t, "s", "forward", 0.5, 0.05)->group, "pipeline");
    sk_path(path, state, "behind.txt");
    assert_true(hlt_save(&t, path, &error));
    t.rows[1].value[HLT_PSNR] -= 3;
    assert_int_equal(check(&t, path, said, &error), 1);
    sk_assert_contains(said, "psnr, size ways: the front's area is");
    free(t.rows);
}

static void what_was_not_measured_is_worse(void **state)
{
    char path[SK_PATH], said[2048];
    struct hlh_error error;
    struct hlt_table t = stairs();
    add(&t, "gone", "w", 1, 1);
    sk_path(path, state, "gone.txt");
    assert_true(hlt_save(&t, path, &error));
    t.n--;
    assert_int_equal(check(&t, path, said, &error), 7);
    sk_assert_contains(said, "gone on m, psnr, all ways: in the file, but");
    free(t.rows);
}

static void files_of_others_are_refused(void **state)
{
    static const struct { const char *text, *part; } rows[] = {
        { "", "has no front" },
        { "# size 32x18\n", "has no front" },
        { "# size 64x36\ns,m,all,flip,1,1,1\n", "is of pictures of 64x36, "
          "these are 32x18" },
        { "s,m,all,flip,1,1\n", "line 1 is not" },
        { "s,m,all,flip,1,1,1,1\n", "line 1 is not" },
        { "# note\ns,m,all,draws,1,1,1\n", "line 2 is not" },
        { "s,m,all,flip,one,1,1\n", "line 1 is not" },
        { "s,m,all,flip,-1,1,1\n", "line 1 is not" },
        { "s,m,all,flip,1,0,1\n", "line 1 is not" },
        { "s,m,all,flip,1,1,nan\n", "line 1 is not" },
        { "\n", "line 1 is not" },
    };
    char path[SK_PATH], said[2048];
    struct hlh_error error;
    struct hlt_table t = stairs();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        sk_write_text(state, "bad.txt", rows[i].text);
        sk_path(path, state, "bad.txt");
        assert_int_equal(check(&t, path, said, &error), -1);
        sk_assert_contains(error.text, rows[i].part);
    }
    sk_path(path, state, "not there");
    assert_int_equal(check(&t, path, said, &error), -1);
    sk_path(path, state, "no folder/file");
    assert_false(hlt_save(&t, path, &error));
    free(t.rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_point_of_a_front_is_beaten),
        cmocka_unit_test(the_order_of_rows_does_not_matter),
        cmocka_unit_test(what_has_no_place_is_left_out),
        cmocka_unit_test(goodness_becomes_error),
        cmocka_unit_test(times_have_quartiles),
        cmocka_unit_test(means_are_of_ways_that_all_scenes_have),
        cmocka_unit_test(areas_are_those_of_the_cells),
        cmocka_unit_test(what_becomes_worse_is_said),
        cmocka_unit_test(more_cost_is_worse_in_all_measures),
        cmocka_unit_test(a_group_behind_the_front_is_watched),
        cmocka_unit_test(what_was_not_measured_is_worse),
        cmocka_unit_test(files_of_others_are_refused),
    };
    return cmocka_run_group_tests_name("front", tests, sk_setup, sk_teardown);
}
