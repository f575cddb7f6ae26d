/* SPDX-License-Identifier: Zlib */
/* The file of `halflight calibrate`: written and read again, refused, made. */
#include <float.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/cli/commands.h"
#include "platforms/host/image.h"
#include "tests/check.h"
#include "tests/cli_kit.h"

/* ---- values ------------------------------------------------------------- */

static void any_caps(struct hl_caps *caps)
{
    memset(caps, 0, sizeof *caps);
    snprintf(caps->backend, sizeof caps->backend, "packemu");
    snprintf(caps->device, sizeof caps->device, "a device # of = its own");
    caps->kind = HL_DEVICE_CPU;
}

/* Any float that a cost can be, the smallest and the largest among them. */
static float any_cost(uint64_t *seed)
{
    double exponent = ck_between(seed, -140, 120);
    double pick = ck_between(seed, 0, 1), part = ck_between(seed, 1, 2);
    return pick < 0.02 ? FLT_MAX : pick < 0.04 ? (float)ldexp(1, -149)
           : (float)ldexp(part, (int)exponent);
}

static void fill(struct hl_caps *caps, uint64_t *seed)
{
    char key[HLC_CALIBRATION_KEY];
    float *v;
    for (uint32_t i = 0;
         (v = hlc_calibration_value(caps, i, key, NULL)) != NULL; i++)
        *v = any_cost(seed);
    caps->cost.untaken = (float)ck_between(seed, 0, 1);
}

static void same_values(const struct hl_caps *a, const struct hl_caps *b)
{
    assert_memory_equal(&a->cost, &b->cost, sizeof a->cost);
    assert_memory_equal(&a->error, &b->error, sizeof a->error);
}

static void values_come_back(void **state)
{
    char path[SK_PATH];
    uint64_t seed = 7;
    sk_path(path, state, "c.txt");
    for (int i = 0; i < 50; i++) {
        struct hl_caps out, in;
        struct hlh_error error;
        any_caps(&out);
        fill(&out, &seed);
        any_caps(&in);
        assert_true(hlc_calibration_write(&out, path, NULL, NULL, &error));
        if (!hlc_calibration_read(&in, path, &error))
            fail_msg("%s", error.text);
        same_values(&in, &out);
    }
}

/* Each key has a place of its own and a name that no other has. */
static void keys_are_apart(void **state)
{
    struct hl_caps caps;
    char key[HLC_CALIBRATION_KEY], other[HLC_CALIBRATION_KEY];
    uint32_t n = 0;
    (void)state;
    any_caps(&caps);
    while (hlc_calibration_value(&caps, n, key, NULL))
        n++;
    assert_true(n > 2 * (HL_FORMAT_COUNT - 1));
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < i; k++) {
            float *a = hlc_calibration_value(&caps, i, key, NULL);
            float *b = hlc_calibration_value(&caps, k, other, NULL);
            assert_ptr_not_equal(a, b);
            assert_string_not_equal(key, other);
        }
}

/* ---- reading ------------------------------------------------------------ */

#define HEAD "version = 1\nbackend = packemu\ndevice_kind = cpu\n"

static bool parse(struct hl_caps *caps, const char *text, char *line)
{
    struct hlh_error error;
    bool ok = hlc_calibration_parse(caps, text, strlen(text), "c.txt",
                                    &error);
    strcpy(line, ok ? "" : error.text);
    return ok;
}

static void what_is_not_said_stays(void **state)
{
    struct hl_caps caps;
    char line[sizeof(struct hlh_error)];
    (void)state;
    any_caps(&caps);
    caps.cost.draw_ns = 5;
    caps.cost.fetch_ns = 6;
    assert_true(parse(&caps, "# a comment\r\n\t" HEAD
                      "  cost.draw_ns\t=  2.5e1 \r\n\n#cost.draw_ns = 1\n"
                      "error.eighths.3=1.5", line));
    assert_true(caps.cost.draw_ns == 25 && caps.cost.fetch_ns == 6);
    assert_true(caps.error.eighths[3] == 1.5f);
    assert_true(parse(&caps, HEAD "cost.fetch_ns = 0\ndriver = = #\n", line));
    assert_true(caps.cost.fetch_ns == 0);
}

static const struct { const char *text, *part; } bad[] = {
    { "", "no version" },
    { "# version = 1\n", "no version" },
    { "version = 1\n", "no backend" },
    { "version = 1\nbackend = packemu\n", "no device_kind" },
    { "version = 2\n", "line 1: version is '2'" },
    { "backend = packemu\nversion = 1\nx = 1\n", "line 3: no key 'x'" },
    { "cost.draw_ns = 1\n" HEAD, "line 1: cost.draw_ns before version" },
    { "version = 1\nbackend = vulkan\n", "line 2: backend is 'vulkan'" },
    { "version = 1\nbackend = packemu\ndevice_kind = discrete\n",
      "line 3: device_kind is 'discrete'" },
    { HEAD "version = 1\n", "line 4: version is there twice" },
    { HEAD "cost.draw_ns = 1\n\ncost.draw_ns = 1\n",
      "line 6: cost.draw_ns is there twice" },
    { HEAD "cost.draw = 1\n", "line 4: no key 'cost.draw'" },
    { HEAD "cost.draw_nss = 1\n", "no key 'cost.draw_nss'" },
    { HEAD "error.eighths.8 = 1\n", "no key" },
    { HEAD "cost.format_blend_ns.NONE = 1\n", "no key" },
    { HEAD "cost.draw_ns\n", "line 4: no 'key = value'" },
    { HEAD "cost.draw_ns =\n", "line 4: cost.draw_ns has no value" },
    { HEAD "= 1\n", "no key ''" },
    { HEAD "cost.draw_ns = nan\n", "'nan' is no number" },
    { HEAD "cost.draw_ns = inf\n", "'inf' is no number" },
    { HEAD "cost.draw_ns = 0x10\n", "'0x10' is no number" },
    { HEAD "cost.draw_ns = 1 2\n", "'1 2' is no number" },
    { HEAD "cost.draw_ns = 1,5\n", "'1,5' is no number" },
    { HEAD "cost.draw_ns = 1.5.1\n", "'1.5.1' is no number" },
    { HEAD "cost.draw_ns = e5\n", "'e5' is no number" },
    { HEAD "cost.draw_ns = 1 # one\n", "'1 # one' is no number" },
    { HEAD "cost.draw_ns = -1\n", "'-1' is below 0" },
    { HEAD "cost.draw_ns = -0\n", "'-0' is below 0" },
    { HEAD "cost.draw_ns = 1e39\n", "'1e39' is too large" },
    { HEAD "cost.draw_ns = 1e999\n", "'1e999' is too large" },
    { HEAD "cost.untaken = 1.5\n", "'1.5' is above 1" },
    { HEAD "cost.draw_ns = 0000000000000000000000000000000000000000000000000"
      "00000000000000000000000000001\n", "is no number" },
};

static void bad_files_are_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct hl_caps caps, before;
        char line[sizeof(struct hlh_error)];
        any_caps(&caps);
        caps.cost.draw_ns = 3;
        before = caps;
        if (parse(&caps, bad[i].text, line))
            fail_msg("taken: %s", bad[i].text);
        if (strncmp(line, "c.txt: ", 7) || !strstr(line, bad[i].part) ||
            strchr(line, '\n'))
            fail_msg("'%s' has no '%s'", line, bad[i].part);
        same_values(&caps, &before);
    }
}

/* What comes after a byte of 0 would not be seen. */
static void zero_bytes_are_refused(void **state)
{
    static const char text[] = HEAD "cost.draw_ns = 1\0 no number\n";
    struct hl_caps caps;
    struct hlh_error error;
    (void)state;
    any_caps(&caps);
    assert_false(hlc_calibration_parse(&caps, text, sizeof text - 1, "z",
                                       &error));
    sk_assert_contains(error.text, "line 4: a byte of 0");
}

static void long_files_are_refused(void **state)
{
    struct hl_caps caps;
    struct hlh_error error;
    char path[SK_PATH];
    size_t most = HLC_CALIBRATION_BYTES;
    char *text = malloc(most + 1);
    assert_non_null(text);
    memset(text, ' ', most + 1);
    memcpy(text, HEAD, strlen(HEAD));
    sk_path(path, state, "long.txt");
    any_caps(&caps);
    sk_write(state, "long.txt", text, most);
    assert_true(hlc_calibration_read(&caps, path, &error));
    sk_write(state, "long.txt", text, most + 1);
    assert_false(hlc_calibration_read(&caps, path, &error));
    sk_assert_contains(error.text, "longer than 64 KiB");
    free(text);
    assert_false(hlc_calibration_read(&caps, "/dev/zero", &error));
    sk_assert_contains(error.text, "longer than 64 KiB");
    sk_path(path, state, "none.txt");
    assert_false(hlc_calibration_read(&caps, path, &error));
    sk_assert_contains(error.text, "cannot be opened");
    sk_path(path, state, "");
    assert_false(hlc_calibration_read(&caps, path, &error));
    sk_assert_contains(error.text, "cannot be read");
}

/* A sound text with random bytes in it: taken or refused with one line, and
 * then nothing has changed; what is taken are numbers. */
static void hurt(char *text, size_t size, uint64_t *seed)
{
    static const char likely[] = "=#.\n\r\t -+eE019aN\0\xff\x80";
    uint32_t n = (uint32_t)ck_between(seed, 1, 6);
    for (uint32_t i = 0; i < n; i++) {
        size_t at = (size_t)ck_between(seed, 0, (double)size);
        double pick = ck_between(seed, 0, 1);
        text[at] = pick < 0.7
                   ? likely[(size_t)ck_between(seed, 0, sizeof likely)]
                   : (char)(int)ck_between(seed, 0, 128);
    }
}

static void hostile_bytes(void **state)
{
    struct hl_caps out, caps;
    struct hlh_error error;
    char path[SK_PATH], key[HLC_CALIBRATION_KEY], *text;
    size_t size;
    uint64_t seed = 3;
    uint32_t taken = 0;
    sk_path(path, state, "h.txt");
    any_caps(&out);
    fill(&out, &seed);
    assert_true(hlc_calibration_write(&out, path, NULL, NULL, &error));
    assert_true(hlh_file_read(&text, &size, path, &error));
    for (int i = 0; i < 4000; i++) {
        size_t n = i % 3 ? size : (size_t)ck_between(&seed, 1, (double)size);
        char *copy = malloc(n);
        const float *v;
        assert_non_null(copy);
        memcpy(copy, text, n);
        hurt(copy, n, &seed);
        any_caps(&caps);
        struct hl_caps before = caps;
        bool ok = hlc_calibration_parse(&caps, copy, n, "h", &error);
        free(copy);
        taken += ok;
        if (!ok) {
            assert_null(strchr(error.text, '\n'));
            same_values(&caps, &before);
        }
        for (uint32_t k = 0;
             (v = hlc_calibration_value(&caps, k, key, NULL)) != NULL; k++)
            assert_true(isfinite(*v) && *v >= 0);
    }
    free(text);
    assert_true(taken > 100 && taken < 3900);
}

/* A locale whose decimal point is a comma changes nothing. */
static void locale_does_not_matter(void **state)
{
    static const char *const names[] = { "de_DE.UTF-8", "de_DE.utf8", "de_DE",
                                         "fr_FR.UTF-8", "ru_RU.UTF-8" };
    struct hl_caps out, in;
    struct hlh_error error;
    char path[SK_PATH], *text;
    size_t size;
    const char *set = NULL;
    sk_path(path, state, "l.txt");
    any_caps(&out);
    any_caps(&in);
    out.cost.draw_ns = 1.5f;
    for (size_t i = 0; i < sizeof names / sizeof *names && !set; i++)
        set = setlocale(LC_NUMERIC, names[i]);
    if (!set)
        print_message("no locale with a comma here\n");
    bool ok = hlc_calibration_write(&out, path, NULL, NULL, &error) &&
              hlc_calibration_read(&in, path, &error);
    setlocale(LC_NUMERIC, "C");
    assert_true(ok);
    assert_true(in.cost.draw_ns == 1.5f);
    assert_true(hlh_file_read(&text, &size, path, &error));
    sk_assert_contains(text, "cost.draw_ns = 1.5\n");
    free(text);
}

/* ---- the parts of measuring --------------------------------------------- */

static void medians(void **state)
{
    const double odd[] = { 5, NAN, 1, 3, INFINITY }, none[] = { NAN };
    double steady[9], noisy[9];
    struct hlk_value v = hlk_value_of(odd, 5);
    (void)state;
    assert_true(v.n == 3 && v.median == 3 && v.low == 1 && v.high == 5);
    v = hlk_value_of(none, 1);
    assert_true(v.n == 0 && isnan(v.median) && !hlk_is_sure(&v));
    for (int i = 0; i < 9; i++) {
        steady[i] = 2 + 0.1 * i;
        noisy[i] = 2 + 10 * (i - 4);
    }
    v = hlk_value_of(steady, 9);
    assert_true(hlk_is_sure(&v) && v.low < v.median && v.median < v.high);
    v = hlk_value_of(noisy, 9);
    assert_true(!hlk_is_sure(&v) && v.median == 2);
}

/* ---- the tool ----------------------------------------------------------- */

static double plan_ms(void **state, const char *line)
{
    static struct tool_run run;
    tool_done(&run, state, line);
    cJSON *j = tool_json(run.out);
    double ms = tool_number(j, "plan.cost_ms");
    cJSON_Delete(j);
    return ms;
}

static void plans_are_by_the_file(void **state)
{
    sk_write_text(state, "p.txt", HEAD "cost.draw_ns = 3000\n"
                  "cost.vertex_ns = 50\ncost.pixel_ns = 5.6\n"
                  "cost.fetch_ns = 1.9\ncost.blend_ns = 1\n"
                  "cost.light_ns = 2.6\ncost.light_flat_ns = 2.6\n"
                  "cost.light_gather_ns = 2.8\ncost.readback_ns = 2.8\n"
                  "cost.sync_ns = 40000\n");
    double own = plan_ms(state, "plan fig8 --backend packemu --json -");
    double twice = plan_ms(state, "plan fig8 --backend packemu --json - "
                           "--calibration p.txt");
    /* Packemu's own costs, doubled: both figures have 9 digits. */
    ck_near(twice, 2 * own, own * 1e-6);
}

static void files_of_others_are_refused(void **state)
{
    static const struct tool_line rows[] = {
        { "plan fig8 --backend null --calibration p.txt",
          "backend is 'packemu', this machine's is 'null'" },
        { "plan fig8 --backend packemu --calibration q.txt",
          "cannot be opened" },
        { "calibrate --backend null", "--backend null" },
        { "calibrate --backend packemu --out - --json -", "--json -" },
        { "calibrate --backend packemu --out no/where/f", "no/where" },
        { "calibrate nothing-such --backend packemu --size 64x36 --out c",
          "nothing-such" },
    };
    sk_write_text(state, "p.txt", HEAD);
    TOOL_REFUSE(rows, HLC_BAD);
}

/* Errors are counted, not timed: two runs give the same ones. */
static void error_lines(char *out, const char *text)
{
    *out = 0;
    for (const char *p = strstr(text, "\nerror."); p;
         p = strstr(p + 1, "\nerror."))
        strncat(out, p, strcspn(p + 1, "\n") + 1);
}

static cJSON *json_file(void **state, const char *name)
{
    char path[SK_PATH], *text;
    size_t size;
    struct hlh_error error;
    sk_path(path, state, name);
    assert_true(hlh_file_read(&text, &size, path, &error));
    cJSON *j = tool_json(text);
    free(text);
    return j;
}

/* No picture that a search may choose is further off than is predicted. */
static void check_points(const cJSON *j, double margin)
{
    const cJSON *p;
    uint32_t choices = 0, all = 0;
    cJSON_ArrayForEach(p, tool_at(j, "errors")) {
        bool few = !strcmp(tool_text(p, "light_format"), "RGB10A2_UNORM");
        double codes = tool_number(p, "rms_codes");
        all++;
        if (few || tool_number(p, "eighths") < 2)
            continue;
        choices++;
        assert_true(codes > 0 &&
                    codes <= tool_number(p, "predicted_codes") * margin);
    }
    /* Eight sizes in one format, four more formats in three sizes. */
    assert_int_equal(all, 8 + 4 * 3);
    assert_int_equal(choices, all - 1 - 3);
}

/* One light costs packemu the same however it gets to the stage; a figure of
 * its own is the difference of frames, in processor time. */
static void check_lights(const cJSON *j)
{
    const cJSON *v = tool_at(j, "values");
    double uniform = cJSON_GetObjectItem(v, "cost.light_ns")->valuedouble;
    double list = cJSON_GetObjectItem(v, "cost.light_gather_ns")->valuedouble;
    assert_true(list > uniform / 3 && list < uniform * 3);
}

static void calibrate_makes_a_file(void **state)
{
    static struct tool_run run;
    char path[SK_PATH], first[2048], again[2048];
    struct hl_caps caps;
    struct hlh_error error;
    any_caps(&caps);
    tool_done(&run, state, "calibrate many --backend packemu --size 96x54 "
              "--out c.txt --json c.json");
    assert_string_equal(run.out, "");
    sk_path(path, state, "c.txt");
    if (!hlc_calibration_read(&caps, path, &error))
        fail_msg("%s", error.text);
    assert_true(caps.error.eighths[4] == 1 && caps.error.margin >= 1);
    assert_true(caps.error.full > 0 && caps.error.half > 0 &&
                caps.error.eight > 0);
    /* Smaller is worse. */
    for (int k = 2; k < 7; k++)
        assert_true(caps.error.eighths[k] > caps.error.eighths[k + 1]);
    cJSON *j = json_file(state, "c.json");
    check_points(j, (double)caps.error.margin);
    check_lights(j);
    cJSON_Delete(j);
    char *text;
    size_t size;
    assert_true(hlh_file_read(&text, &size, path, &error));
    error_lines(first, text);
    free(text);
    tool_done(&run, state, "calibrate many --backend packemu --size 96x54");
    error_lines(again, run.out);
    assert_string_equal(first, again);
    assert_true(strlen(first) > 100);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_come_back),
        cmocka_unit_test(keys_are_apart),
        cmocka_unit_test(what_is_not_said_stays),
        cmocka_unit_test(bad_files_are_refused),
        cmocka_unit_test(zero_bytes_are_refused),
        cmocka_unit_test(long_files_are_refused),
        cmocka_unit_test(hostile_bytes),
        cmocka_unit_test(locale_does_not_matter),
        cmocka_unit_test(medians),
        cmocka_unit_test(plans_are_by_the_file),
        cmocka_unit_test(files_of_others_are_refused),
        cmocka_unit_test(calibrate_makes_a_file),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("calibration", tests, sk_setup,
                                       sk_teardown);
}
