/* SPDX-License-Identifier: Zlib */
/* The tool's command line and its scenes from outside: exit codes, one line
 * on stderr when something is wrong, and no file left by a run that failed.
 * No driver is loaded: `null` and the reference renderer only. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "tests/cli_kit.h"

/* ---- usage -------------------------------------------------------------- */

static void bad_usage_is_exit_two(void **state)
{
    static const struct tool_line rows[] = {
        { "bogus", "bogus: no such command" },
        { "bo\ngus", "bo gus: no such command" },
        { "paint thin", "paint: no such command" },
        { "--out x render", "--out: the command comes first" },
        { "help bogus", "help bogus: no such command" },
        { "render", "render: needs SCENE" },
        { "compare a.pfm", "compare: needs TEST REFERENCE" },
        { "render thin more", "more: render takes no further argument" },
        { "devices x", "x: devices takes no further argument" },
        { "render thin --bogus", "--bogus: unknown option" },
        { "render thin --siz=8x8", "--siz: unknown option" },
        { "render thin -q", "-q: unknown option" },
        { "compare a b --samples 4", "--samples: not an option of compare" },
        { "plan thin --out x", "--out: not an option of plan" },
        { "chart thin --machines amiga", "amiga" },
        { "stability thin", "thin: stability takes no further argument" },
        { "stability --only bogus", "bogus" },
        { "calibrate --rounds 3", "--rounds: not an option of calibrate" },
        { "render thin --validation=1", "--validation=1: takes no value" },
        { "render thin --size", "--size: needs a value: WxH" },
        { "render thin --out --hdr x", "--out: needs a value" },
        { "render thin --out=", "--out: needs a value" },
        { "render thin --out ''", "--out: needs a value" },
        { "scene thin", "scene thin: needs --out PREFIX" },
        { "scene --out x", "scene: needs a SCENE" },
        { "plan thin --pipeline reference", "needs no plan" },
        { "render thin --supersample 4", "--supersample 4: is an option of "
          "--pipeline reference" },
    };
    TOOL_REFUSE(rows, 2);
}

static void bad_values_are_exit_two(void **state)
{
    static const struct tool_line rows[] = {
        { "render thin --size 0x0", "--size 0x0: must be WxH" },
        { "render thin --size 20000x20000", "the limit is 16384 a side" },
        { "render thin --size 16x16385", "the limit is 16384 a side" },
        { "render thin --size -8x8", "--size -8x8: must be WxH" },
        { "render thin --size 8x-8", "--size 8x-8: must be WxH" },
        { "render thin --size 8x8x8", "must be WxH" },
        { "render thin --size 99999999999x8", "must be WxH" },
        { "render thin --light-size 0x8", "--light-size 0x8: must be WxH" },
        { "render thin --samples 3", "must be one of 1|2|4|8" },
        { "render thin --exposure nan", "must be a number from -64 to 64" },
        { "render thin --exposure inf", "must be a number" },
        { "render thin --exposure 0x1", "must be a number" },
        { "render thin --exposure 1e999", "must be a number" },
        { "render thin --exposure 1.5.2", "must be a number" },
        { "render thin --exposure 2x", "must be a number" },
        { "render thin --frames 0", "must be a whole number from 1 to" },
        { "render thin --frames 1.5", "must be a whole number" },
        { "render thin --frames -1", "must be a whole number" },
        { "render thin --frames 5000000000", "must be a whole number" },
        { "render thin --camera 1,2,3,4,5,6", "must be seven numbers" },
        { "render thin --camera 1,2,3,4,5,6,7,8", "must be seven numbers" },
        { "render thin --camera 1,2,3,4,5,6,", "must be seven numbers" },
        { "render thin --camera=-1,2,3,-1,2,3,60", "are one point" },
        { "render thin --camera 1,2,3,4,5,6,180", "vfov must be above 0" },
        { "render thin --camera 1,2,3,4,5,nan,60", "must be seven numbers" },
        { "render thin --camera 1,2,3,4,5,6e20,60", "within 1e9" },
        { "render thin --ambient 1,2", "must be three numbers" },
        { "render thin --background 1,-2,3", "must be from 0" },
        { "render thin --near 0", "must be a number from" },
        { "render thin --near 5 --far 2", "near must be below far" },
        { "render thin --half-pixel both", "must be one of auto|none|" },
        { "plan thin --backend null --half-pixel state",
          "pixel centres are at halves here" },
        { "plan thin --backend null --profile xbox360 --light-size 1280x720",
          "needs 2160 tiles of EDRAM at once, which has 2048; a light buffer "
          "of 1200 x 675 fits" },
        { "plan thin --backend null --profile xbox360 --samples 4",
          "would draw the pass 3 times, for rectangles of 1280 x 256" },
        { "render thin --profile amiga", "must be one of native|" },
        { "render thin --pipeline best", "must be one of auto|" },
        { "render thin --lights-mode mix", "must be one of add|replace" },
        { "render thin --light-format RGB", "no such format" },
        { "render thin --light-format NONE", "no such format" },
        { "render thin --normal-format RG9", "no such format" },
        { "render thin --max-error 0", "must be a number from 0.001" },
        { "render thin --max-cost 0", "must be a number from 1e-06" },
        { "chart thin --rounds 5000", "from 0 to 1000" },
        { "render thin --light-batch 17", "from 1 to 16" },
        { "render thin --tile 7", "from 8 to 256" },
        { "render thin --dsf on", "must be one of auto|off|" },
        { "render thin --shadows soft", "must be one of none|volumes|maps" },
        { "render thin --shadow-lights some", "must be one of all|scene" },
        { "render thin --shadow-size 8", "from 16 to 8192" },
        { "render thin --translucency 3x3", "must be one of auto|forward|" },
        { "render thin --stipple worst", "must be one of best|user|" },
        { "render thin --stipple-filter box", "must be one of auto|cone|" },
        { "render thin --fill zero", "must be one of auto|nearest|" },
        { "render thin --fetch scatter", "must be one of auto|gather|" },
        { "render thin --centroid maybe", "must be one of on|off" },
        { "render thin --mask none", "must be one of test|blend" },
        { "render thin --volume-texels 0", "from 1 to" },
        { "render thin --jitter 0.5", "must be two numbers x,y from -1" },
        { "render thin --jitter 0,1.5", "must be two numbers x,y from -1" },
        { "render thin --part 0x9", "must be WxH" },
        { "render thin --size 16x9 --part 17x9", "is larger than --size" },
        { "render thin --size 16x9 --part 16x10", "is larger than --size" },
        { "plan thin --part 8x8", "not an option of plan" },
        { "render thin --motion=1", "takes no value" },
        { "plan thin --backend null --pipeline forward --motion",
          "motion vectors need the inferred pipeline" },
        { "render thin --tile-depth yes", "must be one of on|off" },
        { "compare a.pfm b.pfm --min-psnr x", "must be a number" },
        { "compare a.pfm b.pfm --max-error=-1", "must be a number from 0" },
    };
    TOOL_REFUSE(rows, 2);
}

/* The Vulkan loader is sent where no driver is: a machine without one. */
static void no_backend_or_device_is_exit_three(void **state)
{
    static const struct tool_line rows[] = {
        { "render thin --backend bogus --out x.png", "no such backend" },
        { "plan thin --backend bogus", "no such backend" },
        { "devices --backend bogus", "no such backend" },
        { "render thin --device none --json x.json", "--device none: " },
        { "plan thin --device none --json x.json", "--device none: " },
        { "render thin --backend gl --gl-context egl --device none",
          "--device none: " },
        { "render thin --backend vulkan --out x.png", "vulkan: " },
        { "devices --backend vulkan --json x.json", "--backend vulkan: " },
    };
    setenv("VK_ICD_FILENAMES", "/nothing", 1);
    setenv("VK_DRIVER_FILES", "/nothing", 1);
    TOOL_REFUSE(rows, 3);
    unsetenv("VK_ICD_FILENAMES");
    unsetenv("VK_DRIVER_FILES");
}

static void asking_for_help_is_no_error(void **state)
{
    static struct tool_run r;
    static const char *const lines[] = { "", "help", "--help", "-h",
                                         "help render", "render --help",
                                         "render thin --size 8x8 --help" };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        tool_done(&r, state, lines[i]);
        sk_assert_contains(r.out, i < 4 ? "halflight compare TEST REFERENCE"
                                        : "--light-size WxH");
        assert_int_equal(strstr(r.out, "halflight conform") != NULL, i < 4);
    }
    tool_done(&r, state, "--version");
    sk_assert_contains(r.out, "halflight 3");
    assert_int_equal(sk_count(state), 0);
}

/* ---- scenes ------------------------------------------------------------- */

/* Every command that reads a scene refuses it alike. */
static void refused_scene(void **state, const char *args, const char *part)
{
    static const char *const forms[] = {
        "scene %s --out x",
        "plan %s --backend null --json x.json",
        "render %s --backend null --size 8x8 --out x.png --hdr x.pfm",
        "render %s --pipeline reference --size 8x8 --out x.png --ids i.png",
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        char line[256];
        snprintf(line, sizeof line, forms[i], args);
        tool_refused(state, line, 2, part);
    }
}

static void good_glb(void **state, const char *name, const char *find,
                     const char *by)
{
    uint8_t bin[SK_BIN];
    char json[SK_JSON];
    sk_bin(bin);
    sk_replace(json, sk_good, find, by);
    sk_write_glb(state, name, json, bin, SK_BIN);
}

static void bad_scenes_are_exit_two(void **state)
{
    good_glb(state, "index.glb", "'SCALAR','count':6}",
             "'SCALAR','count':600}");
    sk_write_text(state, "text.glb", "not a GLB at all");
    sk_write_text(state, "text.gltf", "{");
    sk_write_text(state, "empty.obj", "");
    refused_scene(state, "nothing.glb", "nothing.glb: ");
    refused_scene(state, "nothing", "nothing");
    refused_scene(state, "index.glb", "index.glb: ");
    refused_scene(state, "text.glb", "text.glb: ");
    refused_scene(state, "text.gltf", "text.gltf: ");
    refused_scene(state, "empty.obj", "empty.obj: ");
}

static void truncated_scenes_are_exit_two(void **state)
{
    char path[SK_PATH], *bytes;
    struct hlh_error error;
    size_t size;
    good_glb(state, "kit.glb", NULL, NULL);
    sk_path(path, state, "kit.glb");
    assert_true(hlh_file_read(&bytes, &size, path, &error));
    const size_t cuts[] = { 0, 3, 12, 19, 20, 100, size - SK_BIN,
                            size - SK_BIN / 2, size - 1 };
    for (size_t i = 0; i < sizeof cuts / sizeof *cuts; i++) {
        sk_write(state, "cut.glb", bytes, cuts[i]);
        tool_refused(state, "scene cut.glb --out x", 2, "cut.glb: ");
    }
    free(bytes);
}

static void bad_lights_are_exit_two(void **state)
{
    static const struct { const char *text, *part; } rows[] = {
        { "0,1,0,5,1,1,1\n0,1,0,-5,1,1,1\n", "line 2: " },
        { "nan,1,0,5,1,1,1\n", "line 1: " },
        { "0,1,0,5,1,inf,1\n", "line 1: " },
        { "x,y,z,radius,r,g,b\n0,1,0,5,1,1,1\n", "line 1: " },
        { "0,1,0,5,1,1\n", "line 1: " },
        { "0,1,0,5,1,1,1,1\n", "line 1: " },
        { "0,1,0,5,1,1,1 1\n", "line 1: " },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        sk_write_text(state, "bad.csv", rows[i].text);
        refused_scene(state, "thin --lights bad.csv", rows[i].part);
    }
    refused_scene(state, "thin --lights none.csv", "none.csv: ");
}

static void a_scene_is_listed_and_written(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, "scene");
    sk_assert_contains(r.out, "fig7 ");
    sk_write_text(state, "one.csv", "# a comment\n0,1,0,5,1,1,1\n");
    tool_done(&r, state, "scene thin --out a --lights one.csv "
                         "--lights-mode replace");
    assert_true(sk_exists(state, "a.glb"));
    assert_true(sk_exists(state, "a.lights.csv"));
    assert_true(sk_exists(state, "a.camera"));
    assert_int_equal(sk_count(state), 4);
    tool_done(&r, state, "plan a.glb --lights a.lights.csv --lights-mode "
                         "replace --backend null --json -");
    cJSON *j = tool_json(r.out);
    assert_true(tool_number(j, "scene.lights") == 1);
    cJSON_Delete(j);
    tool_refused(state, "scene thin --out no/where", 2, "no/where");
}

#define IN_DIRECTORY(name) \
    cmocka_unit_test_setup_teardown(name, sk_setup, sk_teardown)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(bad_usage_is_exit_two),
        IN_DIRECTORY(bad_values_are_exit_two),
        IN_DIRECTORY(no_backend_or_device_is_exit_three),
        IN_DIRECTORY(asking_for_help_is_no_error),
        IN_DIRECTORY(bad_scenes_are_exit_two),
        IN_DIRECTORY(truncated_scenes_are_exit_two),
        IN_DIRECTORY(bad_lights_are_exit_two),
        IN_DIRECTORY(a_scene_is_listed_and_written),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("cli", tests, NULL, NULL);
}
