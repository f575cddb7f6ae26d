/* SPDX-License-Identifier: Zlib */
/* What the tool writes and prints: keys of docs/json.md, thresholds of
 * compare, and that all files of a run are there or none. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/host/image.h"
#include "tests/cli_kit.h"

/* ---- compare ------------------------------------------------------------ */

/* width x 2 pixels of `value`; pixel 1,1 has `odd` in green. */
static void write_picture(void **state, const char *name, uint32_t width,
                          float value, float odd)
{
    struct hlh_error error;
    char path[SK_PATH];
    float rgb[3 * 16];
    struct hlh_picture p = { width, 2, rgb, true };
    assert_true(width >= 2 && width <= 8);
    for (uint32_t i = 0; i < width * 6; i++)
        rgb[i] = value;
    rgb[(width + 1) * 3 + 1] = odd;
    sk_path(path, state, name);
    bool pfm = strstr(name, ".pfm") != NULL;
    if (pfm ? !hlh_picture_write_pfm(&p, path, &error)
            : !hlh_picture_write_png(&p, 0, path, &error))
        fail_msg("%s", error.text);
}

static void write_ids(void **state, const char *name, uint32_t width,
                      uint32_t odd)
{
    struct hlh_error error;
    char path[SK_PATH];
    uint32_t ids[16] = { 0 };
    ids[width + 1] = odd;
    sk_path(path, state, name);
    if (!hlh_ids_write_png(ids, width, 2, path, &error))
        fail_msg("%s", error.text);
}

/* e = 0.25 in one of 48 channels, the reference 0.5 everywhere. */
static void compare_prints_its_measures(void **state)
{
    static struct tool_run r;
    write_picture(state, "r.pfm", 8, 0.5f, 0.5f);
    write_picture(state, "t.pfm", 8, 0.5f, 0.75f);
    write_ids(state, "i.png", 8, 70000);
    tool_done(&r, state, "compare t.pfm r.pfm --ids i.png --json c.json");
    cJSON *j = tool_json(r.out);
    assert_string_equal(tool_text(j, "command"), "compare");
    assert_string_equal(tool_text(j, "test"), "t.pfm");
    /* Nine digits are printed. */
    assert_true(fabs(tool_number(j, "psnr") - 10 * log10(4 * 48)) < 1e-6);
    assert_true(fabs(tool_number(j, "mae") - 0.25 / 48) < 1e-9);
    assert_true(tool_number(j, "max") == 0.25);
    assert_true(tool_number(j, "p999") == 0.25);
    assert_true(fabs(tool_number(j, "relmse") - 0.0625 / 0.26 / 48) < 1e-9);
    assert_true(tool_number(j, "within_1_255") == 1 - 1 / 16.0);
    assert_true(tool_number(j, "flip") > 0 && tool_number(j, "flip") < 1);
    assert_true(tool_number(j, "peak") == 0.5);
    /* Edge pixels 0-2,1 and 1,0 reach columns 0 to 4 of both rows. */
    assert_true(tool_number(j, "edge_pixels") == 10);
    assert_true(fabs(tool_number(j, "edge_mae") - 0.25 / 30) < 1e-9);
    assert_true(tool_number(j, "rest_mae") == 0);
    assert_true(tool_is_null(j, "ssim"));
    cJSON_Delete(j);
    struct hlh_error error;
    char path[SK_PATH], *text;
    size_t size;
    sk_path(path, state, "c.json");
    assert_true(hlh_file_read(&text, &size, path, &error));
    assert_string_equal(text, r.out);
    free(text);
    assert_int_equal(sk_count(state), 4);
}

static void compare_without_ids_has_no_edges(void **state)
{
    static struct tool_run r;
    write_picture(state, "r.png", 8, 0.5f, 0.5f);
    tool_done(&r, state, "compare r.png r.png --min-psnr 900 --max-error 0 "
                         "--json -");
    cJSON *j = tool_json(r.out);
    assert_true(tool_is_null(j, "psnr"));
    assert_true(tool_is_null(j, "edge_mae"));
    assert_true(tool_is_null(j, "edge_pixels"));
    assert_true(tool_number(j, "max") == 0);
    assert_true(tool_number(j, "within_1_255") == 1);
    cJSON_Delete(j);
}

static void a_missed_threshold_is_exit_one(void **state)
{
    static struct tool_run r;
    write_picture(state, "r.pfm", 8, 0.5f, 0.5f);
    write_picture(state, "t.pfm", 8, 0.5f, 0.75f);
    /* PSNR is 22.8 dB, the largest difference 0.25. */
    tool_refused(state, "compare t.pfm r.pfm --min-psnr 23", 1,
                 "PSNR 22.833 dB is below 23");
    tool_refused(state, "compare t.pfm r.pfm --max-error 0.24", 1,
                 "largest difference 0.25 is above 0.24");
    tool_refused(state, "compare t.pfm r.pfm --max-error 0 --min-psnr 99", 1,
                 "below 99: largest difference 0.25 is above 0");
    tool_done(&r, state, "compare t.pfm r.pfm --min-psnr 22.8 "
                         "--max-error 0.25");
    tool_run(&r, state, "compare t.pfm r.pfm --min-psnr 23 --json -");
    assert_int_equal(r.code, 1);
    cJSON_Delete(tool_json(r.out));
}

static void bad_pictures_are_exit_two(void **state)
{
    static const struct tool_line rows[] = {
        { "compare none.png r.pfm", "none.png: cannot be opened" },
        { "compare r.pfm none.pfm", "none.pfm: cannot be opened" },
        { "compare r.jpg r.pfm", "r.jpg: is neither" },
        { "compare small.pfm r.pfm", "small.pfm: is 4 x 2, the reference "
          "8 x 2" },
        { "compare nan.pfm r.pfm", "nan.pfm: pixel 1,1: green is not a" },
        { "compare r.pfm inf.pfm", "inf.pfm: pixel 1,1: green is infinite" },
        { "compare r.pfm r.pfm --ids i4.png", "i4.png: is 4 x 2" },
        { "compare r.pfm r.pfm --ids color.png", "color.png: " },
        { "compare r.pfm r.pfm --ids none.png", "none.png: " },
        { "compare cut.pfm r.pfm", "cut.pfm: " },
        { "compare text.png r.pfm", "text.png: " },
        { "compare r.pfm r.pfm --json no/c.json", "no/c.json: " },
        { "compare r.pfm r.pfm --json .", ".: is a directory" },
    };
    write_picture(state, "r.pfm", 8, 0.5f, 0.5f);
    write_picture(state, "small.pfm", 4, 0.5f, 0.5f);
    write_picture(state, "nan.pfm", 8, 0.5f, (float)NAN);
    write_picture(state, "inf.pfm", 8, 0.5f, -(float)INFINITY);
    write_picture(state, "color.png", 8, 0.5f, 0.5f);
    write_ids(state, "i4.png", 4, 1);
    sk_write_text(state, "cut.pfm", "PF\n8 2\n-1.0\n0123");
    sk_write_text(state, "text.png", "not a PNG");
    TOOL_REFUSE(rows, 2);
}

/* ---- plan and devices --------------------------------------------------- */

static void a_plan_gives_its_reasons(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, "plan thin --backend null --pipeline inferred "
                         "--size 640x360");
    sk_assert_contains(r.out, "pipeline inferred: 640x360, light 400x225");
    sk_assert_contains(r.out, "inferred was asked for");
    sk_assert_contains(r.out, "five eighths a side [K 6, fig. 9]");
    tool_done(&r, state, "plan thin --backend null --pipeline inferred "
                         "--size 640x360 --json -");
    cJSON *j = tool_json(r.out);
    assert_string_equal(tool_text(j, "command"), "plan");
    assert_string_equal(tool_text(j, "backend"), "null");
    assert_string_equal(tool_text(j, "pipeline"), "inferred");
    assert_string_equal(tool_text(j, "scene.name"), "thin");
    assert_true(tool_number(j, "needs.lights") ==
                tool_number(j, "scene.lights"));
    const cJSON *size = tool_at(j, "plan.light_size"), *row;
    assert_true(cJSON_GetArrayItem(size, 0)->valuedouble == 400);
    assert_true(cJSON_GetArrayItem(size, 1)->valuedouble == 225);
    assert_true(cJSON_GetArraySize(tool_at(j, "plan.targets")) >= 6);
    assert_int_equal(cJSON_GetArraySize(tool_at(j, "plan.passes")), 3);
    cJSON_ArrayForEach(row, tool_at(j, "plan.reasons"))
        assert_true(tool_text(row, "id")[0] && tool_text(row, "text")[0]);
    cJSON_Delete(j);
    tool_refused(state, "plan thin --backend null --json no/p.json", 2,
                 "no/p.json: ");
}

static void options_reach_the_plan(void **state)
{
    static const struct { const char *option, *path, *want; } rows[] = {
        { "--pipeline forward", "pipeline", "forward" },
        { "--pipeline forward-multipass", "plan.pipeline",
          "forward-multipass" },
        { "--light-path rects", "plan.light.path", "rects" },
        { "--light-path lists", "plan.light.path", "lists" },
        { "--dsf off", "plan.dsf.mode", "off" },
        { "--dsf constant", "plan.dsf.mode", "constant" },
        { "--light-size 1280x720", "plan.dsf.mode", "exact" },
        { "--no-specular", "plan.specular", "none" },
    };
    static struct tool_run r;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char line[256];
        snprintf(line, sizeof line, "plan fig8 --backend null --json - %s %s",
                 strstr(rows[i].option, "pipeline") ? ""
                                                    : "--pipeline inferred",
                 rows[i].option);
        tool_done(&r, state, line);
        cJSON *j = tool_json(r.out);
        if (strcmp(tool_text(j, rows[i].path), rows[i].want))
            fail_msg("%s: %s is %s", line, rows[i].path,
                     tool_text(j, rows[i].path));
        cJSON_Delete(j);
    }
}

/* Words of an object, and numbers and flags as cJSON prints them. */
static void features_reach_the_plan(void **state)
{
    static const struct { const char *line, *path, *want; } rows[] = {
        { "blades --translucency 2x2", "plan.translucency", "\"2x2\"" },
        { "blades", "plan.shadows", "null" },
        { "blades", "needs.shadow_lights", "1" },
        { "blades", "needs.shadow_points", "false" },
        { "blades", "needs.blended_layers", "3" },
        { "blades --shadow-lights all", "needs.shadow_lights", "11" },
        { "blades --shadow-lights all", "needs.shadow_points", "true" },
        { "blades --translucency forward", "plan.translucency",
          "\"forward\"" },
        { "blades --translucency forward", "plan.stipple", "null" },
        { "blades --translucency 4x4", "plan.stipple.side", "4" },
        { "blades --translucency 2x2 --stipple depth-free", "plan.stipple.mode",
          "\"depth-free\"" },
        { "blades --translucency 2x2 --stipple-filter bilinear",
          "plan.stipple.filter",
          "\"bilinear\"" },
        { "blades --shadows volumes", "plan.shadows.kind", "\"volumes\"" },
        { "blades --shadows volumes", "plan.infinite_far", "true" },
        { "blades --shadows maps --shadow-size 512", "plan.shadows.size",
          "512" },
        { "fig8", "plan.translucency", "null" },
        { "fig8 --shadows maps", "plan.shadows", "null" },
        { "fig8 --light-path volumes --volume-texels 77",
          "plan.volume_texels", "77" },
        { "fig8 --fill bilinear", "plan.dsf.fill", "\"bilinear\"" },
        { "fig8 --fetch bilinear", "plan.dsf.fetch", "\"bilinear\"" },
        { "fig8 --samples 4", "plan.dsf.centroid", "true" },
        { "fig8 --samples 4 --centroid off", "plan.dsf.centroid", "false" },
        { "fig8", "plan.motion", "false" },
        { "fig8 --motion", "plan.motion", "true" },
        { "decals", "needs.decals", "true" },
        { "decals", "plan.decals", "\"blend_normals\"" },
        { "fence", "needs.blended", "true" },
        { "fence --mask test", "needs.blended", "false" },
    };
    static struct tool_run r;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char line[256];
        snprintf(line, sizeof line, "plan --backend null --pipeline inferred "
                 "--json - %s", rows[i].line);
        tool_done(&r, state, line);
        cJSON *j = tool_json(r.out);
        char *is = cJSON_PrintUnformatted(tool_at(j, rows[i].path));
        if (!is || strcmp(is, rows[i].want))
            fail_msg("%s: %s is %s", line, rows[i].path, is);
        cJSON_free(is);
        cJSON_Delete(j);
    }
}

static void devices_describe_null(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, "devices --backend null");
    sk_assert_contains(r.out, "RGBA16_FLOAT");
    tool_done(&r, state, "devices --backend null --json -");
    cJSON *j = tool_json(r.out);
    const cJSON *backends = tool_at(j, "backends");
    assert_int_equal(cJSON_GetArraySize(backends), 1);
    const cJSON *b = cJSON_GetArrayItem(backends, 0);
    assert_string_equal(tool_text(b, "name"), "null");
    const cJSON *d = cJSON_GetArrayItem(tool_at(b, "devices"), 0);
    assert_true(tool_number(d, "caps.max_tex_dim") == 16384);
    assert_true(cJSON_GetArraySize(tool_at(d, "caps.formats")) > 20);
    cJSON_Delete(j);
}

/* ---- render ------------------------------------------------------------- */

#define REFERENCE "render thin --pipeline reference --size 16x9 "

/* The keys that a JSON of render has at least. */
static void render_writes_what_is_asked(void **state)
{
    static const char *const keys[] = {
        "version", "command", "scene.name", "scene.objects",
        "scene.triangles", "scene.lights", "camera", "size", "light_size",
        "samples", "backend", "device", "profile", "pipeline", "plan",
        "frame_ms.median", "frame_ms.min", "frame_ms.max", "frame_ms.n",
        "passes", "counts.light_evaluations", "counts.lights_per_pixel_mean",
        "counts.overflow", "dsf",
    };
    static struct tool_run r;
    tool_done(&r, state, REFERENCE "--out o.png --hdr o.pfm --ids i.png "
                         "--json o.json");
    assert_int_equal(sk_count(state), 4);
    tool_done(&r, state, "compare o.png o.pfm --ids i.png");
    tool_done(&r, state, REFERENCE "--json -");
    cJSON *j = tool_json(r.out);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        tool_at(j, keys[i]);
    cJSON_Delete(j);
    assert_int_equal(sk_count(state), 4);
}

static void a_failed_render_leaves_nothing(void **state)
{
    static const struct tool_line rows[] = {
        { REFERENCE "--out no/o.png", "no/o.png: " },
        { REFERENCE "--out o.png --json no/o.json", "no/o.json: " },
        { REFERENCE "--out o.png --hdr o.pfm --ids no/i.png", "no/i.png: " },
        { REFERENCE "--out o.png --json .", ".: is a " },
        { REFERENCE "--out o.png --hdr o.png", "o.png: " },
        { REFERENCE "--out o.png --dump no/dump", "no/dump" },
    };
    TOOL_REFUSE(rows, 2);
    if (access("/dev/full", W_OK) == 0)
        tool_refused(state, REFERENCE "--out o.png --json /dev/full", 2,
                     "/dev/full: ");
}

static void a_failed_run_leaves_old_files_alone(void **state)
{
    static const char *const lines[] = {
        REFERENCE "--out old --json no/o.json",
        "render none.glb --backend null --out old",
        "plan none.glb --backend null --json old",
        "compare none.png none.png --json old",
    };
    struct hlh_error error;
    char path[SK_PATH], *text;
    size_t size;
    sk_write_text(state, "old", "what was here before");
    sk_path(path, state, "old");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        tool_refused(state, lines[i], 2, ": ");
        assert_true(hlh_file_read(&text, &size, path, &error));
        assert_string_equal(text, "what was here before");
        free(text);
    }
}

#define IN_DIRECTORY(name) \
    cmocka_unit_test_setup_teardown(name, sk_setup, sk_teardown)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(compare_prints_its_measures),
        IN_DIRECTORY(compare_without_ids_has_no_edges),
        IN_DIRECTORY(a_missed_threshold_is_exit_one),
        IN_DIRECTORY(bad_pictures_are_exit_two),
        IN_DIRECTORY(a_plan_gives_its_reasons),
        IN_DIRECTORY(options_reach_the_plan),
        IN_DIRECTORY(features_reach_the_plan),
        IN_DIRECTORY(devices_describe_null),
        IN_DIRECTORY(render_writes_what_is_asked),
        IN_DIRECTORY(a_failed_render_leaves_nothing),
        IN_DIRECTORY(a_failed_run_leaves_old_files_alone),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("cli output", tests, NULL, NULL);
}
