/* SPDX-License-Identifier: Zlib */
/* Pictures of charts: words stay apart, whatever the points; marks of axes;
 * and gnuplot, which a name or a missing program must not lead astray. */
#include "tests/check.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/plot_parts.h"
#include "platforms/cli/gnuplot.h"
#include "platforms/host/image.h"
#include "tests/scene_kit.h"

enum { ROWS = 200 };

static const char *const groups[] = { "size x format", "pipeline", "normals",
                                      "samples x size", "filter x size" };
static const char *const formats[] = { "RGBA8_UNORM", "RGB10A2_UNORM",
                                       "RGBA16_FLOAT", "RGBA32_FLOAT" };

/* ---- tables ------------------------------------------------------------- */

/* About a line down, `octaves` long: near to it most are on the front. */
static struct hlt_table scattered(uint64_t *seed, uint32_t n, double octaves,
                                  double away)
{
    struct hlt_table t;
    memset(&t, 0, sizeof t);
    t.rows = calloc(ROWS, sizeof *t.rows);
    assert_non_null(t.rows);
    for (t.n = 0; t.n < n; t.n++) {
        struct hlt_row *r = &t.rows[t.n];
        double u = ck_between(seed, 0, octaves);
        double v = ck_between(seed, 0, away);
        uint32_t k = mk_below(seed, 5);
        snprintf(r->scene, sizeof r->scene, "s");
        snprintf(r->machine, sizeof r->machine, "m");
        snprintf(r->group, sizeof r->group, "%s", groups[k]);
        snprintf(r->way, sizeof r->way, "inferred %u/8 %s%s",
                 (unsigned)mk_below(seed, 9), formats[mk_below(seed, 4)],
                 k > 2 ? " fill nearest" : "");
        r->value[HLT_COST] = exp2(u);
        r->value[HLT_RATIO] = exp2(u);
        r->value[HLT_RATIO_LOW] = exp2(u) * 0.96;
        r->value[HLT_RATIO_HIGH] = exp2(u) * 1.02;
        r->value[HLT_FLIP] = mk_below(seed, 50) ? exp2(v - u) : 0;
        r->value[HLT_PSNR] = 6.02 * (u - v);
    }
    return t;
}

static struct hlt_point *points(uint32_t *n, const struct hlt_table *t,
                                enum hlt_column cost, enum hlt_column error)
{
    struct hlt_point *p = hlt_points(n, t, "s", "m", cost, error);
    assert_non_null(p);
    return p;
}

/* ---- words -------------------------------------------------------------- */

static bool overlap(const struct hlt_box *a, const struct hlt_box *b)
{
    return fmin(a->x1, b->x1) > fmax(a->x0, b->x0) &&
           fmin(a->y1, b->y1) > fmax(a->y0, b->y0);
}

static void assert_apart(const struct hlt_chart *c, uint32_t i)
{
    const struct hlt_label *l = &c->label[i];
    assert_true(l->box.x0 > HLT_LEFT && l->box.x1 < c->right);
    assert_true(l->box.y0 > HLT_BOTTOM && l->box.y1 <= HLT_HEIGHT - HLT_TOP);
    ck_near(l->box.x1 - l->box.x0, hlt_text_width(c->word[i].text,
                                                  HLT_WORD_SIZE), 1e-9);
    for (uint32_t k = 0; k < i; k++)
        assert_false(c->label[k].placed && overlap(&l->box, &c->label[k].box));
    for (uint32_t k = 0; k < c->n; k++) {
        double x = hlt_point_x(c, &c->point[k]);
        double y = hlt_point_y(c, &c->point[k]);
        struct hlt_box mark = { x - HLT_MARK, y - HLT_MARK, x + HLT_MARK,
                                y + HLT_MARK };
        assert_false(overlap(&l->box, &mark));
    }
    /* Away from its point it has a line to it. */
    assert_true(l->leader ||
                hypot(l->near_x - l->x, l->near_y - l->y) < 20);
}

/* How many words found no room. */
static uint32_t lay_out(uint64_t *seed, uint32_t n, double octaves,
                        double away, enum hlt_column cost,
                        enum hlt_column error)
{
    struct hlt_table t = scattered(seed, n, octaves, away);
    struct hlt_chart c;
    uint32_t m, lost = 0;
    struct hlt_point *p = points(&m, &t, cost, error);
    assert_true(hlt_layout(&c, p, m, cost, error));
    for (uint32_t i = 0; i < c.n_words; i++) {
        if (c.label[i].placed)
            assert_apart(&c, i);
        lost += !c.label[i].placed;
    }
    hlt_layout_free(&c);
    free(p);
    free(t.rows);
    return lost;
}

static void words_stay_apart(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int round = 0; round < 40; round++) {
        uint32_t n = 1 + mk_below(&seed, ROWS);
        double octaves = ck_between(&seed, 0.001, 9);
        double away = round % 4 ? ck_between(&seed, 0, 6) : 0;
        lay_out(&seed, n, octaves, away, round % 2 ? HLT_RATIO : HLT_COST,
                round % 3 ? HLT_PSNR : HLT_FLIP);
    }
}

/* On the front are a, b, c and d; c is 0.5 % nearer than b, for the double; e
 * costs more than half of the axis leaves to what nobody would choose. */
static void what_is_hardly_nearer_has_no_word(void **state)
{
    (void)state;
    static const double cost[] = { 1, 2, 4, 8, 65, 63 };
    static const double error[] = { 1, 0.5, 0.4975, 0.1, 0.2, 0.2 };
    uint64_t seed = 1;
    struct hlt_table t = scattered(&seed, 6, 1, 1);
    struct hlt_chart c;
    uint32_t n;
    for (int i = 0; i < 6; i++) {
        t.rows[i].value[HLT_COST] = cost[i];
        t.rows[i].value[HLT_FLIP] = error[i];
    }
    struct hlt_point *p = points(&n, &t, HLT_COST, HLT_FLIP);
    assert_true(hlt_layout(&c, p, n, HLT_COST, HLT_FLIP));
    assert_int_equal(c.n_words, 3);
    assert_true(c.word[1].point->cost == 2 && c.word[2].point->cost == 8);
    assert_true(p[4].cost == 63 && !hlt_is_beyond(&c, &p[4]));
    assert_true(p[5].cost == 65 && hlt_is_beyond(&c, &p[5]));
    assert_true(c.x.high > 63 && c.x.high < 200);
    hlt_layout_free(&c);
    free(p);
    free(t.rows);
}

/* As many as a sweep has, and a front as they have: none is left out. */
static void usual_fronts_are_named_whole(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int round = 0; round < 20; round++)
        assert_int_equal(lay_out(&seed, 70, 4, 5, HLT_RATIO, HLT_FLIP), 0);
}

/* A diagonal of 100 points a pixel or two apart: not all can be named, and
 * what is said must still be legible. */
static void what_has_no_room_is_left_out(void **state)
{
    (void)state;
    struct hlt_label label[100];
    struct hlt_box mark[100];
    struct hlt_field field = { { 0, 0, 400, 300 }, mark, 100, NULL, 0 };
    for (int i = 0; i < 100; i++) {
        label[i] = (struct hlt_label){ .x = 150 + i, .y = 200 - i,
                                       .width = 90, .height = 14 };
        mark[i] = (struct hlt_box){ 145 + i, 195 - i, 155 + i, 205 - i };
    }
    uint32_t placed = hlt_labels_place(label, 100, &field), counted = 0;
    assert_in_range(placed, 10, 60);
    for (int i = 0; i < 100; i++)
        for (int k = 0; k < i; k++)
            assert_false(label[i].placed && label[k].placed &&
                         overlap(&label[i].box, &label[k].box));
    for (int i = 0; i < 100; i++)
        counted += label[i].placed;
    assert_int_equal(counted, placed);
}

/* Advances of DejaVu Sans 2.37, 2048 units an em. */
static void widths_are_not_less_than_the_font(void **state)
{
    (void)state;
    static const struct { const char *text; int units; } rows[] = {
        { "inferred 5/8 RGBA16_FLOAT", 28719 }, { "forward", 7888 },
        { "WWWW", 8100 }, { "illiji", 3414 }, { "mmmm", 7980 },
        { "0123456789", 13030 }, { "", 0 }
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        double width = hlt_text_width(rows[i].text, 2048);
        assert_true(width >= rows[i].units && width <= 1.4 * rows[i].units);
    }
    /* A letter of two bytes is one letter. */
    ck_near(hlt_text_width("\xc3\xa9", 10), 10, 0);
}

static void names_are_short(void **state)
{
    (void)state;
    char out[HLT_NAME], way[HLT_NAME];
    hlt_short_name(out, "inferred 5/8 RGBA16_FLOAT normals RG8_UNORM");
    assert_string_equal(out, "5/8 RGBA16F normals RG8");
    hlt_short_name(out, "forward-multipass x4");
    assert_string_equal(out, "multi-pass x4");
    memset(way, 'x', sizeof way);
    way[HLT_NAME - 1] = 0;
    hlt_short_name(out, way);
    assert_in_range(strlen(out), 80, HLT_NAME - 1);
}

/* ---- axes --------------------------------------------------------------- */

static void axes_have_marks_to_read_by(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int round = 0; round < 2000; round++) {
        struct hlt_axis a;
        double low = exp2(ck_between(&seed, -20, 10));
        double high = low * exp2(ck_between(&seed, 0, round % 2 ? 1 : 12));
        bool decibels = round % 3 == 0, zero = round % 5 == 0;
        hlt_axis_make(&a, low, high, 100, 500, decibels, zero);
        assert_in_range(a.n, 3, HLT_TICKS);
        assert_true(a.low < low && high < a.high);
        for (uint32_t i = 0; i < a.n; i++) {
            double at = hlt_axis_pixel(&a, a.tick[i]);
            assert_true(at >= 100 - 1e-6 && at <= 500 + 1e-6);
            assert_true(i == 0 || a.tick[i - 1] < a.tick[i]);
            if (zero && i == 0)
                continue;
            double said = atof(a.text[i]);
            /* Six digits are written. */
            ck_near(decibels ? pow(10, -said / 20) : said, a.tick[i],
                    1e-5 * a.tick[i]);
        }
    }
}

static void marks_are_round_numbers(void **state)
{
    (void)state;
    static const struct {
        double low, high; bool decibels; const char *text[6];
    } rows[] = {
        { 1, 1000, false, { "1", "10", "100", "1000" } },
        { 1, 4, false, { "1", "2", "3", "4" } },
        { 1, 9, false, { "1", "2", "5", "10" } },
        { 2, 45, false, { "2", "5", "10", "20", "50" } },
        { 1, 1.25, false, { "1", "1.1", "1.2" } },
        { 1e-3, 1e-1, true, { "60", "50", "40", "30", "20" } },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hlt_axis a;
        hlt_axis_make(&a, rows[i].low, rows[i].high, 0, 1, rows[i].decibels,
                      false);
        for (int k = 0; k < 6 && rows[i].text[k]; k++) {
            bool found = false;
            for (uint32_t j = 0; j < a.n; j++)
                found = found || !strcmp(a.text[j], rows[i].text[k]);
            if (!found)
                fail_msg("%g to %g: no mark at %s", rows[i].low, rows[i].high,
                         rows[i].text[k]);
        }
    }
}

/* ---- gnuplot ------------------------------------------------------------ */

static char *file(void **state, const char *name)
{
    char path[SK_PATH], *text;
    size_t size;
    struct hlh_error error;
    sk_path(path, state, name);
    if (!hlh_file_read(&text, &size, path, &error))
        fail_msg("%s", error.text);
    return text;
}

static void a_chart_is_an_svg_with_its_words(void **state)
{
    char path[SK_PATH];
    struct hlh_error error;
    uint64_t seed = mk_seed();
    struct hlt_table t = scattered(&seed, 20, 3, 2);
    uint32_t n;
    struct hlt_point *p = points(&n, &t, HLT_COST, HLT_PSNR);
    sk_path(path, state, "chart.svg");
    if (!hlt_plot(path, "a \"title\" & 'more' <b> \\ $x `date` \n{/", p, n,
                  HLT_COST, HLT_PSNR, &error))
        fail_msg("%s", error.text);
    char *svg = file(state, "chart.svg");
    sk_assert_contains(svg, "&amp; 'more' &lt;b> / $x `date` ?{/");
    sk_assert_contains(svg, "size x format");
    sk_assert_contains(svg, "cost by counted work, ns a pixel");
    sk_assert_contains(svg, "</svg>");
    free(svg);
    free(p);
    free(t.rows);
}

static void charts_of_nothing_are_refused(void **state)
{
    char path[SK_PATH];
    struct hlh_error error;
    sk_path(path, state, "nothing.svg");
    assert_false(hlt_plot(path, "t", NULL, 0, HLT_COST, HLT_PSNR, &error));
    sk_assert_contains(error.text, "no way was measured");
    assert_false(sk_exists(state, "nothing.svg"));
}

static void gnuplot_says_what_is_wrong(void **state)
{
    char path[SK_PATH];
    struct hlh_error error;
    sk_write_text(state, "kept.svg", "before");
    sk_path(path, state, "kept.svg");
    assert_false(hlc_gnuplot(path, 100, 100, "plot no_such_thing\n", &error));
    sk_assert_contains(error.text, "undefined variable: no_such_thing");
    assert_null(strchr(error.text, '\n'));
    assert_false(hlc_gnuplot(path, 100, 100, "# draws nothing\n", &error));
    char *text = file(state, "kept.svg");
    assert_string_equal(text, "before");
    free(text);
    /* More than a pipe holds, to a program that has long ended. */
    size_t size = 1 << 20;
    char *script = malloc(size + 1);
    assert_non_null(script);
    memset(script, '\n', size);
    script[size] = 0;
    memcpy(script, "exit status 3\n", 14);
    assert_false(hlc_gnuplot(path, 100, 100, script, &error));
    free(script);
    sk_path(path, state, "no folder/a.svg");
    assert_false(hlc_gnuplot(path, 100, 100, "plot x\n", &error));
}

static void no_gnuplot_is_one_line(void **state)
{
    char path[SK_PATH], before[4096];
    struct hlh_error error;
    snprintf(before, sizeof before, "%s", getenv("PATH"));
    sk_path(path, state, "none.svg");
    setenv("PATH", "/nowhere", 1);
    bool ok = hlc_gnuplot(path, 100, 100, "plot x\n", &error);
    setenv("PATH", before, 1);
    assert_false(ok);
    sk_assert_contains(error.text, "gnuplot is not installed: no chart");
    assert_false(sk_exists(state, "none.svg"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_stay_apart),
        cmocka_unit_test(what_is_hardly_nearer_has_no_word),
        cmocka_unit_test(usual_fronts_are_named_whole),
        cmocka_unit_test(what_has_no_room_is_left_out),
        cmocka_unit_test(widths_are_not_less_than_the_font),
        cmocka_unit_test(names_are_short),
        cmocka_unit_test(axes_have_marks_to_read_by),
        cmocka_unit_test(marks_are_round_numbers),
        cmocka_unit_test(a_chart_is_an_svg_with_its_words),
        cmocka_unit_test(charts_of_nothing_are_refused),
        cmocka_unit_test(gnuplot_says_what_is_wrong),
        cmocka_unit_test(no_gnuplot_is_one_line),
    };
    return cmocka_run_group_tests_name("plot", tests, sk_setup, sk_teardown);
}
