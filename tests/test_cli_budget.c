/* SPDX-License-Identifier: Zlib */
/* --max-error and --max-cost from outside: what plan says is what render
 * keeps. */
#include <string.h>
#include "tests/cli_kit.h"

#define SMALL "fig8 --backend packemu --size 160x90 "

static bool says(const cJSON *j, const char *id)
{
    const cJSON *r;
    cJSON_ArrayForEach(r, tool_at(j, "plan.reasons"))
        if (!strcmp(tool_text(r, "id"), id))
            return true;
    return false;
}

static void plan_tells_budget_and_probe(void **state)
{
    struct tool_run r;
    tool_done(&r, state, "plan " SMALL "--max-error 4 --json -");
    cJSON *j = tool_json(r.out);
    double told = tool_number(j, "plan.error_codes");
    assert_true(told > 0 && told <= 4);
    assert_true(tool_number(j, "needs.budget_codes") == 4);
    assert_true(tool_is_null(j, "needs.budget_ms"));
    assert_true(tool_number(j, "needs.probe.full") > 0);
    assert_true(tool_number(j, "needs.probe.forward") > 0);
    assert_true(tool_number(j, "needs.probe.quarter") >
                tool_number(j, "needs.probe.half"));
    assert_true(says(j, "budget_error"));
    cJSON_Delete(j);
    tool_done(&r, state, "plan " SMALL "--json -");
    j = tool_json(r.out);
    assert_true(tool_is_null(j, "needs.budget_codes"));
    assert_true(tool_is_null(j, "needs.probe.full"));
    assert_false(says(j, "budget_error"));
    cJSON_Delete(j);
}

static void render_keeps_the_budget_that_it_took(void **state)
{
    static const char *const lines[] = {
        "render " SMALL "--max-error 6 --hdr a.pfm --json a.json",
        "render " SMALL "--pipeline inferred --max-error 6 --max-cost 1000 "
        "--hdr a.pfm --json a.json",
    };
    struct tool_run r;
    tool_done(&r, state, "render " SMALL "--pipeline reference --hdr r.pfm");
    for (int i = 0; i < 2; i++) {
        tool_done(&r, state, lines[i]);
        tool_done(&r, state, "compare a.pfm r.pfm --json -");
        cJSON *j = tool_json(r.out);
        double codes = tool_number(j, "rms_codes");
        assert_true(codes > 0 && codes <= 6);
        cJSON_Delete(j);
    }
}

static void what_cannot_be_kept_is_refused_with_numbers(void **state)
{
    static const struct tool_line rows[] = {
        { "plan " SMALL "--pipeline inferred --max-error 0.01",
          "no plan keeps to the budget: the best plans come to" },
        { "render " SMALL "--max-cost 0.000001",
          "no plan keeps to the budget: the best plans come to" },
    };
    TOOL_REFUSE(rows, 2);
}

static void cost_bounds_are_kept(void **state)
{
    struct tool_run r;
    double error = 1e9;
    static const char *const lines[] = {
        "plan " SMALL "--max-cost 3.5 --json -",
        "plan " SMALL "--max-cost 4 --json -",
        "plan " SMALL "--max-cost 30 --json -",
    };
    static const double bound[] = { 3.5, 4, 30 };
    for (int i = 0; i < 3; i++) {
        tool_done(&r, state, lines[i]);
        cJSON *j = tool_json(r.out);
        assert_true(tool_number(j, "plan.cost_ms") <= bound[i]);
        assert_true(tool_number(j, "plan.error_codes") <= error);
        assert_true(says(j, "budget_cost"));
        error = tool_number(j, "plan.error_codes");
        cJSON_Delete(j);
    }
}

#define IN_DIRECTORY(test) \
    cmocka_unit_test_setup_teardown(test, sk_setup, sk_teardown)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(plan_tells_budget_and_probe),
        IN_DIRECTORY(render_keeps_the_budget_that_it_took),
        IN_DIRECTORY(what_cannot_be_kept_is_refused_with_numbers),
        IN_DIRECTORY(cost_bounds_are_kept),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("tool budgets", tests, NULL, NULL);
}
