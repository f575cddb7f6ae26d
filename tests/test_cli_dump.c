/* SPDX-License-Identifier: Zlib */
/* --dump on the software device: every picture that the index names is there,
 * and what they show agrees with one another and with the scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/image.h"
#include "tests/cli_kit.h"

#define BLADES "render blades --backend packemu --pipeline inferred " \
    "--translucency 2x2 --size 160x90 "

static struct hlh_picture picture(void **state, const char *name)
{
    struct hlh_picture p;
    struct hlh_error e;
    char path[SK_PATH], file[64];
    snprintf(file, sizeof file, "d/%s", name);
    sk_path(path, state, file);
    if (!hlh_picture_read(&p, path, &e))
        fail_msg("%s", e.text);
    return p;
}

/* Names at the beginnings of the index' lines; each is a file of the folder.
 * Returns how many. */
static int indexed(void **state)
{
    struct hlh_error e;
    char path[SK_PATH], file[64], name[40], *text;
    size_t size;
    int n = 0;
    sk_path(path, state, "d/index.txt");
    assert_true(hlh_file_read(&text, &size, path, &e));
    for (char *line = text; line && *line; n++) {
        assert_int_equal(sscanf(line, "%39s", name), 1);
        snprintf(file, sizeof file, "d/%s", name);
        if (!sk_exists(state, file))
            fail_msg("%s is not there", name);
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    free(text);
    return n;
}

static bool in_index(void **state, const char *name)
{
    char file[64];
    snprintf(file, sizeof file, "d/%s", name);
    return sk_exists(state, file);
}

/* Depth of the DSF and of the depth buffer, both in metres. */
static void check_depths(void **state)
{
    struct hlh_picture a = picture(state, "depth.pfm");
    struct hlh_picture b = picture(state, "light_depth.pfm");
    size_t n = (size_t)a.width * a.height;
    assert_true(a.width == 100 && a.height == 56 && b.width == 100);
    /* 16 bits of far, under 20 m, and what the depth buffer loses. */
    for (size_t i = 0; i < n; i++)
        if (!(fabsf(a.rgb[3 * i] - b.rgb[3 * i]) <= 20.0f / 65535))
            fail_msg("texel %u: %g m and %g m", (unsigned)i,
                     (double)a.rgb[3 * i], (double)b.rgb[3 * i]);
    hlh_picture_free(&a);
    hlh_picture_free(&b);
}

static uint32_t code(const float *rgb)
{
    uint32_t c = 0;
    for (int k = 0; k < 3; k++) {
        double v = (double)rgb[k];
        v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
        c = c * 256 + (uint32_t)(v * 255 + 0.5);
    }
    return c;
}

static uint32_t colors_of(const struct hlh_picture *p)
{
    uint32_t seen[64], n = 0;
    for (size_t i = 0; i < (size_t)p->width * p->height && n < 64; i++) {
        uint32_t c = code(p->rgb + 3 * i), k = 0;
        while (k < n && seen[k] != c)
            k++;
        if (k == n)
            seen[n++] = c;
    }
    return n;
}

static void check_colors(void **state, const char *name, uint32_t low,
                         uint32_t high)
{
    struct hlh_picture p = picture(state, name);
    uint32_t n = colors_of(&p);
    if (n < low || n > high)
        fail_msg("%s has %u colours", name, (unsigned)n);
    hlh_picture_free(&p);
}

/* The camera was far / 100 to the left: what is z away moved left by that
 * over z t, where t = tan(22.5 degrees) is half the picture's height. */
static void check_motion(void **state, double far)
{
    struct hlh_picture m = picture(state, "motion.pfm");
    struct hlh_picture z = picture(state, "depth.pfm");
    for (size_t i = 0; i < (size_t)m.width * m.height; i++) {
        double depth = (double)z.rgb[3 * i];
        double want = -0.01 * far / (depth * 0.41421356) * 45;
        if (depth > 0.999 * far)     /* the background: whole scene behind    */
            continue;
        /* Motion has 16 bits of the screen's width, depth 16 of far, which
         * is twice what is nearest here. */
        if (!(fabs((double)m.rgb[3 * i] - want) < 160 * 2e-5 + 4e-5 &&
              fabsf(m.rgb[3 * i + 1]) < 90 * 2e-5f))
            fail_msg("texel %u moved by %g, %g, not by %g", (unsigned)i,
                     (double)m.rgb[3 * i], (double)m.rgb[3 * i + 1], want);
    }
    hlh_picture_free(&m);
    hlh_picture_free(&z);
}

static void dumps_hold_what_they_say(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, BLADES "--shadows maps --motion --dump d --json -");
    cJSON *j = tool_json(r.out);
    assert_int_equal(indexed(state), 26);
    check_depths(state);
    check_motion(state, tool_number(j, "camera.far"));
    /* Nothing, what is opaque, three patterns. */
    check_colors(state, "stipple.png", 5, 5);
    /* Background, and 0 to 4 taps at most. */
    check_colors(state, "rejects.png", 4, 6);
    check_colors(state, "shadow_map.png", 16, 64);
    check_colors(state, "ids.png", 10, 64);
    check_colors(state, "regions.png", 10, 64);
    check_colors(state, "normal.png", 10, 64);
    assert_true(tool_number(j, "counts.stippled") == 3);
    assert_true(tool_number(j, "counts.shadow_lights") == 1);
    assert_true(tool_number(j, "counts.shadow_casters") > 0);
    cJSON_Delete(j);
}

/* Without a far plane the depth buffer is laid out otherwise. */
static void depth_is_metres_without_a_far_plane(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, BLADES "--shadows volumes --dump d --json -");
    cJSON *j = tool_json(r.out);
    assert_true(cJSON_IsTrue(tool_at(j, "plan.infinite_far")));
    assert_true(tool_number(j, "counts.shadow_triangles") > 0);
    assert_false(in_index(state, "shadow_map.png"));
    assert_false(in_index(state, "motion.png"));
    check_depths(state);
    cJSON_Delete(j);
}

static uint32_t *ids_of(void **state, const char *name)
{
    struct hlh_error e;
    char path[SK_PATH];
    uint32_t *ids, w, h;
    sk_path(path, state, name);
    assert_true(hlh_ids_read_png(&ids, &w, &h, path, &e));
    return ids;
}

/* A part of half the size shows all of the picture: its pixel lies between
 * four of the whole, and where these agree it is the same object; it is
 * black where there is none. */
static void parts_are_whole_pictures(void **state)
{
    static struct tool_run r;
    uint32_t equal = 0, differ = 0;
    char path[SK_PATH];
    struct hlh_picture p;
    struct hlh_error e;
    tool_done(&r, state, BLADES "--ids a.png");
    tool_done(&r, state, BLADES "--part 80x45 --ids b.png --hdr b.pfm");
    uint32_t *a = ids_of(state, "a.png"), *b = ids_of(state, "b.png");
    sk_path(path, state, "b.pfm");
    assert_true(hlh_picture_read(&p, path, &e));
    for (uint32_t i = 0; i < 80 * 45; i++) {
        const uint32_t *q = a + i / 80 * 320 + i % 80 * 2;
        bool black = !(p.rgb[3 * i] > 0);
        if (q[0] != q[1] || q[0] != q[160] || q[0] != q[161])
            continue;
        equal += q[0] == b[i] && black == (b[i] == 0);
        differ += !(q[0] == b[i] && black == (b[i] == 0));
    }
    /* A blade is thinner than a pixel of the part. */
    assert_true(equal > 3000 && differ < 10);
    free(a);
    free(b);
    hlh_picture_free(&p);
}

/* What is not in the plan has no picture; a part has its own size. */
static void parts_and_plain_plans_are_dumped(void **state)
{
    static struct tool_run r;
    tool_done(&r, state, BLADES "--translucency forward --part 80x45 "
                         "--jitter 0.5,0 --dump d --json -");
    cJSON *j = tool_json(r.out);
    struct hlh_picture frame = picture(state, "frame.pfm");
    struct hlh_picture ids = picture(state, "ids.png");
    assert_true(frame.width == 80 && frame.height == 45);
    assert_true(ids.width == 80 && ids.height == 45);
    assert_false(in_index(state, "stipple.png"));
    assert_true(cJSON_GetArrayItem(tool_at(j, "part"), 0)->valuedouble == 80);
    assert_true(cJSON_GetArrayItem(tool_at(j, "size"), 0)->valuedouble == 160);
    assert_true(tool_number(j, "counts.unstippled") == 3);
    hlh_picture_free(&frame);
    hlh_picture_free(&ids);
    cJSON_Delete(j);
}

/* The folder of the dump goes first, as a directory of its own. */
static int tidy(void **state)
{
    char path[SK_PATH];
    sk_path(path, state, "d");
    void *folder = malloc(SK_PATH);
    if (folder) {
        memcpy(folder, path, sizeof path);
        sk_teardown(&folder);
    }
    return sk_teardown(state);
}

#define IN_DIRECTORY(name) \
    cmocka_unit_test_setup_teardown(name, sk_setup, tidy)

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(dumps_hold_what_they_say),
        IN_DIRECTORY(depth_is_metres_without_a_far_plane),
        IN_DIRECTORY(parts_are_whole_pictures),
        IN_DIRECTORY(parts_and_plain_plans_are_dumped),
    };
    (void)argc;
    if (!tool_find(argv[0]))
        return 1;
    return cmocka_run_group_tests_name("cli dump", tests, NULL, NULL);
}
