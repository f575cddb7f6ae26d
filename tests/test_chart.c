/* SPDX-License-Identifier: Zlib */
/* The sweep behind `halflight chart`: its table, its ways, going on after an
 * interruption, and the command line. */
#include "tests/check.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/chart.h"
#include "platforms/chart/count.h"
#include "platforms/chart/sweep.h"
#include "platforms/cli/commands.h"
#include "platforms/host/image.h"
#include "tests/cli_kit.h"

enum { W = 64, H = 36 };

/* ---- the table ---------------------------------------------------------- */

static struct hlt_row row_of(const char *scene, const char *way, double x)
{
    struct hlt_row r;
    memset(&r, 0, sizeof r);
    snprintf(r.scene, sizeof r.scene, "%s", scene);
    snprintf(r.machine, sizeof r.machine, "packemu:ps3");
    snprintf(r.way, sizeof r.way, "%s", way);
    snprintf(r.group, sizeof r.group, "size x format");
    snprintf(r.pipeline, sizeof r.pipeline, "inferred");
    r.light_width = 40;
    r.samples = 4;
    r.budget = 0.5;
    for (int i = 0; i < HLT_COLUMNS; i++)
        r.value[i] = x * (i + 1);
    r.value[HLT_PSNR] = (double)INFINITY;
    r.value[HLT_FLICKER] = (double)NAN;
    return r;
}

static struct hlt_table begin(const char *settings)
{
    struct hlt_table t;
    memset(&t, 0, sizeof t);
    t.width = W;
    t.height = H;
    snprintf(t.settings, sizeof t.settings, "%s", settings);
    return t;
}

static char *text_of(const char *path)
{
    char *text;
    size_t size;
    struct hlh_error error;
    assert_true(hlh_file_read(&text, &size, path, &error));
    return text;
}

static void assert_same_row(const struct hlt_row *a, const struct hlt_row *b)
{
    assert_string_equal(a->way, b->way);
    assert_string_equal(a->light_format, b->light_format);
    assert_int_equal(a->light_width, b->light_width);
    assert_true(a->budget == b->budget);
    for (int i = 0; i < HLT_COLUMNS; i++)
        assert_true(a->value[i] == b->value[i] ||
                    (isnan(a->value[i]) && isnan(b->value[i])));
}

/* What is appended row by row and written at the end is the same file, and
 * what is read is what was in memory: also where nine digits cut a number. */
static void a_table_comes_back(void **state)
{
    char one[SK_PATH], all[SK_PATH];
    struct hlh_error error;
    struct hlt_table t = begin("9 rounds"), back;
    const char *const ways[] = { "a", "b 1%", "c" };
    sk_path(one, state, "one.csv");
    sk_path(all, state, "all.csv");
    t.unfinished = true;
    for (int i = 0; i < 3; i++) {
        struct hlt_row r = row_of("fig8", ways[i], 1.0 / 3 + i);
        assert_true(hlt_table_append(&t, &r, one, &error));
    }
    assert_true(hlt_table_write(&t, all, &error));
    char *a = text_of(one), *b = text_of(all);
    assert_string_equal(a, b);
    assert_true(hlt_table_read(&back, one, &error));
    assert_int_equal(back.n, 3);
    assert_int_equal(back.width, W);
    assert_int_equal(back.height, H);
    assert_true(back.unfinished);
    assert_string_equal(back.settings, "9 rounds");
    for (uint32_t i = 0; i < 3; i++)
        assert_same_row(&back.rows[i], &t.rows[i]);
    assert_non_null(hlt_table_find(&back, "fig8", "packemu:ps3", "b 1%"));
    assert_null(hlt_table_find(&back, "fig8", "packemu", "b 1%"));
    free(a);
    free(b);
    hlt_table_free(&back);
    hlt_table_free(&t);
}

static void rows_are_sorted(void **state)
{
    char path[SK_PATH];
    struct hlh_error error;
    struct hlt_table t = begin(""), back;
    static const char *const key[][2] = { { "b", "x" }, { "a", "y" },
                                          { "a", "x" } };
    sk_path(path, state, "sorted.csv");
    for (int i = 0; i < 3; i++) {
        struct hlt_row r = row_of(key[i][0], key[i][1], 1);
        assert_true(hlt_table_append(&t, &r, path, &error));
    }
    assert_true(hlt_table_write(&t, path, &error));
    assert_true(hlt_table_read(&back, path, &error));
    assert_false(back.unfinished);
    assert_string_equal(back.rows[0].scene, "a");
    assert_string_equal(back.rows[0].way, "x");
    assert_string_equal(back.rows[1].way, "y");
    assert_string_equal(back.rows[2].scene, "b");
    hlt_table_free(&back);
    hlt_table_free(&t);
}

/* A file that is not there has no rows; one that ends within a row, as when a
 * sweep was killed, has the rows before it. */
static void a_cut_row_is_not_there(void **state)
{
    char path[SK_PATH];
    struct hlh_error error;
    struct hlt_table t = begin(""), back;
    sk_path(path, state, "nothing.csv");
    assert_true(hlt_table_read(&back, path, &error));
    assert_int_equal(back.n, 0);
    assert_int_equal(back.width, 0);
    for (int i = 0; i < 2; i++) {
        struct hlt_row r = row_of("s", i ? "b" : "a", 1);
        assert_true(hlt_table_append(&t, &r, path, &error));
    }
    char *text = text_of(path);
    size_t n = strlen(text);
    for (size_t cut = 1; cut < 40; cut += 13) {
        sk_write(state, "cut.csv", text, n - cut);
        sk_path(path, state, "cut.csv");
        assert_true(hlt_table_read(&back, path, &error));
        assert_int_equal(back.n, 1);
        hlt_table_free(&back);
    }
    free(text);
    hlt_table_free(&t);
}

/* One line that names file and line, and no rows. */
static void refused(void **state, const char *text, const char *part)
{
    char path[SK_PATH];
    struct hlh_error error;
    struct hlt_table t;
    sk_write_text(state, "bad.csv", text);
    sk_path(path, state, "bad.csv");
    if (hlt_table_read(&t, path, &error))
        fail_msg("was read, and should say: %s", part);
    sk_assert_contains(error.text, "bad.csv");
    sk_assert_contains(error.text, part);
    assert_null(strchr(error.text, '\n'));
    assert_int_equal(t.n, 0);
}

static void bad_files_are_one_line(void **state)
{
    static const struct { const char *find, *by, *part; } rows[] = {
        { "# half", "# calf", "line 1: not a table" },
        { "chart 1,", "chart 2,", "line 1: another version" },
        { "64x36", "64x", "line 1: not a size" },
        { "64x36", "0x36", "line 1: not a size" },
        { "64x36", "64x36;", "line 1: not a size" },
        { "scene,", "", "line 2: column 1" },
        { "time_high", "time_top", "line 2: column" },
        { "time_high", "time_high,x", "line 2: more columns" },
        { "s,packemu", ",packemu", "line 3: a name is missing" },
        { "inferred", "an inferred pipeline of the future",
          "line 3: too long" },
        { ",40,", ",-40,", "line 3: not a whole number" },
        { ",40,", ",", "line 3: not a whole number" },
        { ",0.5,", ",0x1,", "line 3: not a number" },
        { ",0.5,", ",-1,", "line 3: not a budget" },
        { ",inf,", ",nan,", "line 3: not a number" },
        { ",inf,", ",1e999,", "line 3: not a number" },
        { ",inf,", ",1;0,", "line 3: not a number" },
        { ",inf,", ",\x01,", "line 3: holds byte 1" },
        { ",4,", ",4,4,", "line 3: more columns" },
        { "s,packemu:ps3,b", "s,packemu:ps3,a", "two rows of \"a\"" },
    };
    char path[SK_PATH], *text, bad[SK_JSON];
    struct hlh_error error;
    struct hlt_table t = begin("");
    sk_path(path, state, "sound.csv");
    for (int i = 0; i < 2; i++) {
        struct hlt_row r = row_of("s", i ? "b" : "a", 1);
        assert_true(hlt_table_append(&t, &r, path, &error));
    }
    text = text_of(path);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        sk_replace(bad, text, rows[i].find, rows[i].by);
        refused(state, bad, rows[i].part);
    }
    refused(state, "", "line 1: not a table");
    free(text);
    hlt_table_free(&t);
}

/* Any byte may be any other: the file is read, or refused in one line. */
static void any_byte_may_be_wrong(void **state)
{
    static const char bytes[] = { 0, ',', '\n', '-', 'e', '9', (char)200 };
    char path[SK_PATH];
    struct hlh_error error;
    struct hlt_table t = begin("9 rounds"), back;
    struct hlt_row r = row_of("s", "a", 1.0 / 3);
    uint32_t read = 0, not_read = 0;
    sk_path(path, state, "bytes.csv");
    assert_true(hlt_table_append(&t, &r, path, &error));
    char *text = text_of(path);
    size_t n = strlen(text);
    for (size_t i = 0; i < n; i++) {
        char was = text[i];
        text[i] = bytes[i % sizeof bytes];
        sk_write(state, "bytes.csv", text, n);
        text[i] = was;
        bool ok = hlt_table_read(&back, path, &error);
        read += ok;
        not_read += !ok;
        if (!ok)
            assert_true(back.n == 0 && !strchr(error.text, '\n'));
        hlt_table_free(&back);
    }
    assert_true(read > 0 && not_read > read);
    free(text);
    hlt_table_free(&t);
}

/* ---- ways --------------------------------------------------------------- */

static void check_ways(const char *profile, bool fast, uint32_t least,
                       uint32_t most)
{
    struct hlc_options o;
    struct hlc_machine m;
    uint32_t n, baselines = 0;
    memset(&o, 0, sizeof o);
    o.backend = "packemu";
    o.profile = profile;
    assert_int_equal(hlc_machine_open(&m, &o), HLC_DONE);
    struct hlt_way *w = hlt_ways(&n, &m.caps, fast);
    assert_non_null(w);
    assert_in_range(n, least, most);
    assert_true(w[0].baseline);
    for (uint32_t i = 0; i < n; i++) {
        baselines += w[i].baseline;
        assert_null(strchr(w[i].name, ','));
        assert_true(w[i].name[0] && w[i].group[0]);
        assert_true(m.caps.samples & w[i].samples);
        for (uint32_t k = 0; k < i; k++) {
            struct hlt_way a = w[i], b = w[k];
            assert_string_not_equal(a.name, b.name);
            memset(a.name, 0, sizeof a.name);
            memset(b.name, 0, sizeof b.name);
            memset(a.group, 0, sizeof a.group);
            memset(b.group, 0, sizeof b.group);
            a.baseline = b.baseline = false;
            assert_memory_not_equal(&a, &b, sizeof a);
        }
    }
    assert_int_equal(baselines, 1);
    free(w);
    hlc_machine_close(&m);
}

/* About eighty ways, about twenty of them fast. */
static void no_way_is_twice(void **state)
{
    static const char *const profiles[] = { NULL, "dx10", "xbox360", "ps3" };
    (void)state;
    for (int i = 0; i < 4; i++) {
        check_ways(profiles[i], false, 65, 110);
        check_ways(profiles[i], true, 15, 30);
    }
}

/* ---- counting ----------------------------------------------------------- */

/* Counted cost of one way to draw fig8, in ns by packemu's own unit costs;
 * of its counts as if the frame had more samples too. */
static double counted_as(const char *more, struct hlt_counts *c,
                         uint32_t samples, double *other)
{
    char line[256], *argv[24];
    int argc = 0;
    struct hlc_options o;
    struct hlh_scene scene;
    struct hlh_error error;
    struct hlc_stage stage;
    struct hlc_shot shot;
    snprintf(line, sizeof line, "halflight render fig8 --backend packemu "
             "--pipeline inferred --size 64x36 %s", more);
    for (char *w = strtok(line, " "); w; w = strtok(NULL, " "))
        argv[argc++] = w;
    argv[argc] = NULL;
    assert_int_equal(hlc_options_parse(&o, argc, argv), HLC_DONE);
    assert_true(hlc_scene_open(&scene, &o, &error));
    assert_int_equal(hlc_stage_open(&stage, &scene, &o), HLC_DONE);
    assert_int_equal(hlc_shot_open(&shot, &stage, &o, NULL, NULL, NULL),
                     HLC_DONE);
    assert_int_equal(hlt_count(c, &shot), HL_OK);
    double ns = hlt_weigh(c, &shot.plan, &stage.machine.caps);
    shot.plan.samples = samples;
    *other = hlt_weigh(c, &shot.plan, &stage.machine.caps);
    hlc_shot_close(&shot);
    hlc_stage_close(&stage);
    return ns;
}

static double counted(const char *more, struct hlt_counts *c)
{
    double unread;
    return counted_as(more, c, 1, &unread);
}

/* Formats, samples, lights a blend and size of the L-buffer all count. */
static void what_is_dearer_counts_more(void **state)
{
    struct hlt_counts byte, half, whole, one, four, single, small, other;
    const char *rects = "--light-path rects --light-batch 8";
    char line[128];
    (void)state;
    snprintf(line, sizeof line, "%s --light-format RGBA8_UNORM", rects);
    double eight = counted(line, &byte);
    snprintf(line, sizeof line, "%s --light-format RGBA16_FLOAT", rects);
    double sixteen = counted(line, &half);
    snprintf(line, sizeof line, "%s --light-format RGBA32_FLOAT", rects);
    assert_true(eight < sixteen);
    assert_true(sixteen < counted(line, &whole));
    assert_int_equal(byte.light, whole.light);
    assert_true(byte.light > 0 && byte.light == byte.light_blends);
    assert_true(counted("", &one) < counted("--samples 4", &four));
    assert_int_equal(one.light, four.light);
    assert_true(one.material < four.material);
    counted("--light-path rects --light-batch 1", &single);
    assert_true(single.light_blends > half.light_blends);
    assert_true(single.lights < half.lights);
    assert_true(counted("--light-size 32x18", &small) < counted("", &one));
    assert_true(small.light < one.light);
    /* Written and resolved, whatever is shaded. */
    double two, eight_fold, ns = counted_as("", &one, 2, &two);
    counted_as("", &one, 8, &eight_fold);
    assert_true(ns < two && two < eight_fold);
    counted("--dsf off", &other);
    assert_int_equal(other.rejecting, 0);
    assert_true(one.rejecting > one.lost);
}

/* ---- sweeps ------------------------------------------------------------- */

static int sweep(struct hlt_table *t, const char *path)
{
    struct hlc_options o;
    char *argv[] = { "halflight", "chart", "shadows", "--fast", "--size",
                     "64x36", "--machines", "packemu", "--rounds", "0",
                     NULL };
    assert_int_equal(hlc_options_parse(&o, 10, argv), HLC_DONE);
    return hlt_sweep(t, path, &o);
}

/* L-buffers of k / 8, to the nearest texel. */
static void check_sizes(const struct hlt_table *t)
{
    uint32_t seen = 0, k;
    for (uint32_t i = 0; i < t->n; i++)
        if (sscanf(t->rows[i].way, "inferred %u/8", &k) == 1) {
            assert_int_equal(t->rows[i].light_width, (W * k + 4) / 8);
            assert_int_equal(t->rows[i].light_height, (H * k + 4) / 8);
            seen |= 1u << k;
        }
    assert_true(seen & 1u << 3 && seen & 1u << 5 && seen & 1u << 8);
}

static void a_sweep_repeats_and_goes_on(void **state)
{
    char path[SK_PATH], half[SK_PATH];
    struct hlh_error error;
    struct hlt_table first = begin("0 rounds"), t = begin("0 rounds"), back;
    sk_path(path, state, "first.csv");
    assert_int_equal(sweep(&first, path), HLC_DONE);
    char *whole = text_of(path);
    assert_in_range(first.n, 15, 30);
    check_sizes(&first);
    sk_path(path, state, "second.csv");
    assert_int_equal(sweep(&t, path), HLC_DONE);
    char *again = text_of(path);
    assert_string_equal(whole, again);
    free(again);
    hlt_table_free(&t);

    /* As if killed in its sixth row; one of the rows bears a mark. */
    t = begin("0 rounds");
    t.unfinished = true;
    sk_path(half, state, "half.csv");
    for (uint32_t i = 0; i < 6; i++) {
        struct hlt_row r = first.rows[i];
        r.value[HLT_MAX] = i == 2 ? 1234 : r.value[HLT_MAX];
        assert_true(hlt_table_append(&t, &r, half, &error));
    }
    hlt_table_free(&t);
    char *text = text_of(half);
    sk_write(state, "half.csv", text, strlen(text) - 30);
    free(text);
    assert_true(hlt_table_read(&back, half, &error));
    assert_int_equal(back.n, 5);
    assert_int_equal(sweep(&back, half), HLC_DONE);
    assert_int_equal(back.n, first.n);
    for (uint32_t i = 0; i < first.n; i++) {
        struct hlt_row r = back.rows[i];
        if (i == 2) {
            assert_true(r.value[HLT_MAX] == 1234);
            r.value[HLT_MAX] = first.rows[i].value[HLT_MAX];
        }
        assert_same_row(&r, &first.rows[i]);
    }
    free(whole);
    hlt_table_free(&back);
    hlt_table_free(&first);
}

/* ---- the command -------------------------------------------------------- */

static void bad_lines_are_refused(void **state)
{
    static const struct tool_line rows[] = {
        { "chart", "needs SCENE" },
        { "chart fig8 --machines foo", "no backend \"foo\"" },
        { "chart fig8 --machines null", "no backend \"null\"" },
        { "chart fig8 --machines packemu:snes", "no such profile" },
        { "chart fig8 --machines packemu,packemu", "packemu twice" },
        { "chart fig8 --machines ,", "is not backend:profile" },
        { "chart fig8 a/fig8.glb --machines packemu", "would both be" },
        { "chart fig8 --out ''", "needs a value" },
        { "chart fig8 --out no/such", "folder does not exist" },
        { "chart fig8 --calibration none.txt", "none.txt" },
        { "chart shadows fig88 --machines packemu", "fig88" },
    };
    TOOL_REFUSE(rows, HLC_BAD);
}

static void scene_names_are_file_names(void **state)
{
    static const char *const rows[][2] = {
        { "fig8", "fig8" }, { "a/b/c.glb", "c" }, { "./x y,z.gltf", "x_y_z" },
        { "a.b.obj", "a_b" }, { ".hidden", "_hidden" }
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char key[HLT_NAME];
        hlt_scene_key(key, rows[i][0]);
        assert_string_equal(key, rows[i][1]);
    }
}

static void the_command_tells(void **state)
{
    struct tool_run run;
    const char *line = "chart shadows brdfs --fast --size 64x36 --rounds 0 "
                       "--machines packemu --json -";
    (void)state;
    tool_run(&run, state, line);
    assert_int_equal(run.code, 0);
    cJSON *j = tool_json(run.out);
    assert_string_equal(tool_text(j, "command"), "chart");
    assert_true(tool_number(j, "rows") >= 30);
    assert_true(sk_exists(state, "chart/chart.csv"));
    assert_true(sk_exists(state, "chart/regret.csv"));
    const cJSON *fronts = tool_at(j, "fronts");
    /* Five measures of two scenes and their mean. */
    assert_int_equal(cJSON_GetArraySize(fronts), 15);
    const cJSON *f = cJSON_GetArrayItem(fronts, 0);
    assert_string_equal(tool_text(f, "scene"), "brdfs");
    assert_true(tool_number(f, "area") > 0);
    assert_true(cJSON_GetArraySize(tool_at(f, "front")) > 0);
    assert_true(tool_is_null(cJSON_GetArrayItem(fronts, 10), "scene"));
    cJSON_Delete(j);
    tool_refused(state, "chart shadows --size 32x18 --machines packemu",
                 HLC_BAD, "pictures of 64x36, not 32x18");
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_table_comes_back),
        cmocka_unit_test(rows_are_sorted),
        cmocka_unit_test(a_cut_row_is_not_there),
        cmocka_unit_test(bad_files_are_one_line),
        cmocka_unit_test(any_byte_may_be_wrong),
        cmocka_unit_test(no_way_is_twice),
        cmocka_unit_test(what_is_dearer_counts_more),
        cmocka_unit_test(a_sweep_repeats_and_goes_on),
        cmocka_unit_test(scene_names_are_file_names),
        cmocka_unit_test(bad_lines_are_refused),
        cmocka_unit_test(the_command_tells),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("chart", tests, sk_setup, sk_teardown);
}
