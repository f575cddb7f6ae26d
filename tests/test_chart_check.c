/* SPDX-License-Identifier: Zlib */
/* The fronts of two scenes on the software device, whose figures are the same
 * on every machine, are as good as when chart.txt was saved:
 *   halflight chart --fast --rounds 0 --size 192x108 fig8 fig9
 *       --machines packemu,packemu:ps3 --out DIR --save tests/chart.txt
 * tests/worse.sh shows that faults are seen. */
#include "tests/cli_kit.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"

#define SWEEP "chart --fast --rounds 0 --size 192x108 fig8 fig9 --machines " \
              "packemu,packemu:ps3 --fresh --out ."

static void no_front_has_become_worse(void **state)
{
    static struct tool_run run;
    char *text;
    size_t size;
    struct hlh_error error;
    if (!hlh_file_read(&text, &size, "tests/chart.txt", &error))
        fail_msg("%s", error.text);
    sk_write_text(state, "saved.txt", text);
    free(text);
    tool_run(&run, state, SWEEP " --check saved.txt --save now.txt");
    if (run.code != 0 || strstr(run.err, ": worse"))
        fail_msg("exit %d: %s", run.code, run.err);
    assert_true(sk_exists(state, "chart.csv"));
    assert_true(sk_exists(state, "now.txt"));
}

/* --fresh: each is measured; the numbers are the same to the last digit. */
static void the_same_run_gives_the_same_numbers(void **state)
{
    static struct tool_run run;
    static const char *const name[2] = { "a.txt", "b.txt" };
    char *text[2], path[SK_PATH];
    for (int i = 0; i < 2; i++) {
        char line[256];
        size_t size;
        struct hlh_error error;
        snprintf(line, sizeof line, "chart --fast --rounds 0 --size 96x54 fig9 "
                 "--machines packemu:ps3 --fresh --out . --save %s",
                 name[i]);
        tool_done(&run, state, line);
        sk_path(path, state, name[i]);
        if (!hlh_file_read(&text[i], &size, path, &error))
            fail_msg("%s", error.text);
    }
    assert_string_equal(text[0], text[1]);
    free(text[0]);
    free(text[1]);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_front_has_become_worse),
        cmocka_unit_test(the_same_run_gives_the_same_numbers),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("chart_check", tests, sk_setup,
                                       sk_teardown);
}
