/* SPDX-License-Identifier: Zlib */
/* `halflight conform` from outside: TAP, JSON and exit codes, on the software
 * device. */
#include <stdio.h>
#include <string.h>
#include "platforms/conform/conform.h"
#include "tests/cli_kit.h"

#define RUN "conform --backend packemu --quick "

static void bad_usage_is_refused(void **state)
{
    static const struct tool_line rows[] = {
        { RUN "--mutant bogus", "--mutant bogus: no such defect" },
        { RUN "--only bogus", "--only bogus: no check begins with it" },
        { RUN "more", "more: conform takes no further argument" },
        { RUN "--seed 0", "--seed 0: must be a whole number from 1" },
        { "render thin --mutant base255", "--mutant: not an option of" },
    };
    TOOL_REFUSE(rows, 2);
}

static void no_machine_is_three(void **state)
{
    static const struct tool_line rows[] = {
        { "conform --backend null", "draws nothing" },
        { "conform --backend metal", "no such backend" },
    };
    TOOL_REFUSE(rows, 3);
}

/* Lines that begin with `start`. */
static uint32_t lines(const char *text, const char *start)
{
    uint32_t n = 0;
    for (const char *p = text; p; p = strchr(p, '\n')) {
        p += *p == '\n';
        n += !strncmp(p, start, strlen(start));
    }
    return n;
}

static void tap_has_a_line_a_check(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, RUN "--profile ps3 --only weights.");
    assert_int_equal(lines(r.out, "TAP version 13"), 1);
    assert_int_equal(lines(r.out, "1..5\n"), 1);
    assert_int_equal(lines(r.out, "ok "), 5);
    assert_int_equal(lines(r.out, "not ok "), 0);
    assert_non_null(strstr(r.out, "ok 1 - weights.sum # worst "));
    assert_non_null(strstr(r.out, "profile ps3; seed 1"));
    tool_done(&r, state, RUN "--profile xbox360 --only normal.rg8 --seed 9");
    assert_non_null(strstr(r.out, " degrees of "));
    assert_non_null(strstr(r.out, "seed 9"));
}

static void skips_say_why(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, RUN "--profile ps3 --only normal.rg16_unorm.");
    assert_int_equal(lines(r.out, "ok "), 10);
    assert_non_null(strstr(r.out, "ok 10 - normal.rg16_unorm.special # SKIP "
                                  "this device has no such target"));
}

static void a_failure_is_exit_one(void **state)
{
    static struct tool_run r;
    tool_run(&r, state, RUN "--only index. --mutant blend_63_255");
    assert_int_equal(r.code, 1);
    assert_int_equal(lines(r.out, "not ok "), 2);
    assert_non_null(strstr(r.out, "not ok 1 - index.shift_4 # worst "));
    assert_non_null(strstr(r.err, "conform: 2 checks failed"));
}

static void the_list_names_all(void **state)
{
    static struct tool_run r;
    const struct hl_conform_mutant *m;
    tool_done(&r, state, "conform --list --backend packemu --profile ps3");
    for (uint32_t i = 0; hl_conform_name(i); i++) {
        char line[128];
        snprintf(line, sizeof line, "  %s ", hl_conform_name(i));
        bool asked = hl_conform_required(i, "packemu", "ps3") != '.';
        if ((strstr(r.out, line) != NULL) != asked)
            fail_msg("%s", hl_conform_name(i));
    }
    for (uint32_t i = 0; (m = hl_conform_mutant(i)); i++)
        assert_non_null(strstr(r.out, m->name));
}

static void json_has_every_number(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, RUN "--only weights. --json -");
    cJSON *j = tool_json(r.out);
    assert_string_equal(tool_text(j, "command"), "conform");
    assert_string_equal(tool_text(j, "backend"), "packemu");
    assert_string_equal(tool_text(j, "profile"), "native");
    assert_true(tool_number(j, "passed") == 5);
    assert_true(tool_number(j, "failed") == 0);
    assert_true(tool_number(j, "seed") == 1);
    assert_true(tool_is_null(j, "mutant"));
    const cJSON *check, *checks = tool_at(j, "checks");
    assert_int_equal(cJSON_GetArraySize(checks), 5);
    cJSON_ArrayForEach(check, checks) {
        assert_string_equal(tool_text(check, "status"), "pass");
        assert_true(tool_number(check, "worst") <=
                    tool_number(check, "limit"));
        assert_true(tool_number(check, "cases") > 0);
        assert_true(tool_text(check, "why")[0] != 0);
        assert_true(tool_is_null(check, "table"));
    }
    assert_string_equal(tool_text(cJSON_GetArrayItem(checks, 0), "level"),
                        "tolerance");
    cJSON_Delete(j);
}

/* A run into a file prints its lines too, and the file is whole. */
static void json_files_are_written(void **state)
{
    static struct tool_run r;
    tool_run(&r, state, RUN "--only index. --mutant blend_63_255 "
                            "--json conform.json");
    assert_int_equal(r.code, 1);
    assert_int_equal(lines(r.out, "1..3\n"), 1);
    tool_done(&r, state, RUN "--only index. --json conform.json");
    assert_int_equal(lines(r.out, "ok "), 3);
    tool_run(&r, state, RUN "--only index. --json no/such/folder.json");
    assert_int_equal(r.code, 2);
    assert_non_null(strstr(r.err, "no/such/folder.json"));
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, sk_setup, sk_teardown)

int main(int argc, char **argv)
{
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    const struct CMUnitTest tests[] = {
        TEST(bad_usage_is_refused),
        TEST(no_machine_is_three),
        TEST(tap_has_a_line_a_check),
        TEST(skips_say_why),
        TEST(a_failure_is_exit_one),
        TEST(the_list_names_all),
        TEST(json_has_every_number),
        TEST(json_files_are_written),
    };
    return cmocka_run_group_tests_name("conform command", tests, NULL, NULL);
}
