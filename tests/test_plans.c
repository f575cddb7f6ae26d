/* SPDX-License-Identifier: Zlib */
/* Whole plans as text: what is decided for each scene and pipeline on two
 * fixed machines, and on the consoles and their stand-ins, is kept in
 * tests/plans.txt, and a difference is a design review. HL_UPDATE=1 writes
 * the file anew. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/plan_text.h"
#include "tests/console_kit.h"

static const char path[] = "tests/plans.txt";

/* ---- scenes ----------------------------------------------------------- */

/* The built-in scenes at 1280 x 720 as the tool measures them, rounded, and
 * what they leave out. Fixed here, so that a change of a scene is not one of
 * the planner. */
static const struct {
    const char *name;
    uint32_t objects, triangles, lights;
    float a_pixel, an_object;
    uint32_t kinds;
    enum hl_specular_need specular;
    float exponent;
    bool blended;
    float far, peak;
} scenes[] = {
    { "fig7", 287, 175152, 287, 15.07f, 16.16f, 1, HL_NEED_EXPONENTS, 19.86f,
      false, 55.47f, 53.45f },
    { "fig8", 101, 56700, 81, 12.5f, 12.24f, 1, HL_NEED_EXPONENTS, 19.86f,
      false, 36.69f, 27.62f },
    { "fig9", 189, 82804, 122, 18.97f, 9.11f, 1, HL_NEED_ONE_EXPONENT, 46.77f,
      false, 47.15f, 43.59f },
    { "lidr", 31, 43904, 255, 24.43f, 23.1f, 1, HL_NEED_EXPONENTS, 76.12f,
      false, 45.86f, 107.47f },
    { "thin", 41, 21360, 64, 15.25f, 14.07f, 1, HL_NEED_ONE_EXPONENT, 1,
      false, 89.58f, 28.46f },
    { "many", 1000, 12000, 50, 8.88f, 8.46f, 1, HL_NEED_EXPONENTS, 13.43f,
      false, 13.63f, 17.11f },
    { "three lights", 20, 5000, 3, 2, 1.5f, 1, HL_NEED_NO_SPECULAR, 1, false,
      30, 3 },
    { "glass and spots", 60, 30000, 40, 9, 7, 7, HL_NEED_ONE_EXPONENT, 32,
      true, 60, 0 },
    { "dark", 20, 5000, 0, 0, 0, 0, HL_NEED_NO_SPECULAR, 1, false, 30, 0 },
};

enum { SCENES = sizeof scenes / sizeof *scenes };

static struct hl_needs needs_of(int i)
{
    struct hl_needs n = {
        .width = 1280, .height = 720, .n_objects = scenes[i].objects,
        .n_triangles = scenes[i].triangles, .n_lights = scenes[i].lights,
        .lights_per_pixel = scenes[i].a_pixel,
        .lights_per_object = scenes[i].an_object, .lights = scenes[i].kinds,
        .specular = scenes[i].specular, .exponent = scenes[i].exponent,
        .blended = scenes[i].blended, .far = scenes[i].far,
        .peak = scenes[i].peak };
    return n;
}

/* ---- machines --------------------------------------------------------- */

/* A small console-like machine: no storage buffers, no floating point depth
 * or blending, little memory a texture. */
static void small_machine(struct hl_caps *c)
{
    ck_lavapipe(c);
    strcpy(c->backend, "small");
    strcpy(c->device, "small machine");
    c->max_storage_bytes = 0;
    c->max_tex_dim = 2048;
    c->samples = 1;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        const struct hl_format_info *f = hl_format_info((enum hl_format)i);
        if (f->kind == HL_KIND_FLOAT)
            c->format[i].use &= (uint8_t)~HL_USE_BLEND;
        if (f->kind == HL_KIND_DEPTH && f->bits[0] == 32)
            c->format[i].use = 0;
        c->format[i].samples = 1;
    }
}

/* ---- text ------------------------------------------------------------- */

static void print_refusal(FILE *out, const struct hl_plan *p,
                          enum hl_refusal why)
{
    char line[1024];
    hlc_refusal_line(p, why, line, sizeof line);
    fprintf(out, "refused: %s\n", line);
}

static void print_plan(FILE *out, const char *title, enum hl_pipeline want,
                       const struct hl_needs *n, const struct hl_caps *caps)
{
    struct hl_plan p;
    enum hl_refusal why;
    fprintf(out, "==== %s, %s on %s\n", title, hlc_pipeline_name(want),
            caps->device);
    if (hl_plan_make(&p, want, n, caps, &why) == HL_OK)
        hl_plan_text(out, &p);
    else
        print_refusal(out, &p, why);
    fputc('\n', out);
}

/* What figure 6 asks for, and all that a plan can have, by volumes and by
 * maps. */
static void print_features(FILE *out, const struct hl_caps *caps)
{
    struct hl_needs n = needs_of(2);
    n.light_depth_bound = false;
    n.blended = true;
    n.blended_layers = 3;
    n.translucency = HL_TRANSLUCENCY_2X2;
    n.shadows = HL_SHADOWS_VOLUMES;
    n.n_shadow_lights = 1;
    print_plan(out, "fig9, figure 6", HL_PIPELINE_INFERRED, &n, caps);
    n.blended_layers = 9;
    n.translucency = HL_TRANSLUCENCY_AUTO;
    n.light_path = HL_LIGHT_PATH_VOLUMES;
    n.decals = n.motion = n.brdfs = true;
    n.samples = caps->samples < 4 ? 1 : 4;
    print_plan(out, "fig9, all by volumes", HL_PIPELINE_INFERRED, &n, caps);
    n.shadows = HL_SHADOWS_MAPS;
    n.shadow_points = true;
    n.stipple_filter = HL_STIPPLE_BILINEAR;
    n.fill = HL_FILL_BILINEAR;
    n.fetch = HL_FETCH_BILINEAR;
    n.light_path = HL_LIGHT_PATH_AUTO;
    n.no_centroid = true;
    n.samples = 1;
    print_plan(out, "fig9, all by maps", HL_PIPELINE_INFERRED, &n, caps);
    n.motion = false;
    print_plan(out, "fig9, shadows", HL_PIPELINE_FORWARD, &n, caps);
    n.shadows = HL_SHADOWS_NONE;
    print_plan(out, "fig9, all by forward", HL_PIPELINE_FORWARD, &n, caps);
}

/* Three scenes of many lights: exponents that differ, one exponent, and
 * inverse square lights under glass. */
static void print_console(FILE *out, const struct hl_profile *profile,
                          bool memory)
{
    static const int some[] = { 1, 2, 7 };
    struct hl_caps c;
    con_caps(&c, profile, memory);
    snprintf(c.device, sizeof c.device, "%s, %s", profile->name,
             memory ? "its own memory" : "stand-ins");
    for (int i = 0; i < 3; i++) {
        struct hl_needs n = needs_of(some[i]);
        if (some[i] == 7)
            n.peak = 60000;
        for (int p = 1; p < HL_PIPELINE_COUNT; p++)
            print_plan(out, scenes[some[i]].name, (enum hl_pipeline)p, &n,
                       &c);
    }
    struct hl_needs n = needs_of(2);
    n.decals = n.light_depth_bound = true;
    n.light_width = 1200;
    n.light_height = 675;
    print_plan(out, "fig9, decals and light volumes", HL_PIPELINE_INFERRED,
               &n, &c);
    n.light_width = 1280;
    n.light_height = 720;
    print_plan(out, "fig9, 1:1", HL_PIPELINE_INFERRED, &n, &c);
    n.light_width = n.light_height = 0;
    n.samples = 4;
    print_plan(out, "fig9, 4 samples", HL_PIPELINE_INFERRED, &n, &c);
    print_features(out, &c);
}

static void print_consoles(FILE *out)
{
    /* Of no kind of its own: the same plans either way. */
    print_console(out, &hl_profile_dx10, false);
    for (int memory = 0; memory < 2; memory++) {
        print_console(out, &hl_profile_xbox360, memory);
        print_console(out, &hl_profile_ps3, memory);
    }
}

static void print_all(FILE *out)
{
    struct hl_caps lavapipe, small;
    ck_lavapipe(&lavapipe);
    small_machine(&small);
    for (int i = 0; i < SCENES; i++) {
        struct hl_needs n = needs_of(i);
        for (int p = 0; p < HL_PIPELINE_COUNT; p++)
            print_plan(out, scenes[i].name, (enum hl_pipeline)p, &n,
                       &lavapipe);
        print_plan(out, scenes[i].name, HL_PIPELINE_AUTO, &n, &small);
        print_plan(out, scenes[i].name, HL_PIPELINE_INFERRED, &n, &small);
    }
    struct hl_needs n = needs_of(1);
    n.samples = 4;
    print_plan(out, "fig8, 4 samples", HL_PIPELINE_INFERRED, &n, &lavapipe);
    n.samples = 1;
    n.light_width = n.width;
    n.light_height = n.height;
    print_plan(out, "fig8, 1:1", HL_PIPELINE_INFERRED, &n, &lavapipe);
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.dsf = HL_DSF_CONSTANT_TAU;
    n.light_format = HL_FORMAT_RGBA16_UNORM;
    print_plan(out, "fig8, as published", HL_PIPELINE_INFERRED, &n, &lavapipe);
    print_features(out, &lavapipe);
    print_features(out, &small);
    print_consoles(out);
}

/* The whole of a stream; malloc'd, NUL-terminated. */
static char *slurp(FILE *in)
{
    size_t room = 1 << 20, n;
    char *text = malloc(room);
    assert_non_null(text);
    n = fread(text, 1, room - 1, in);
    assert_true(n < room - 1);
    text[n] = 0;
    return text;
}

static char *text_of_all(void)
{
    FILE *f = tmpfile();
    assert_non_null(f);
    print_all(f);
    rewind(f);
    char *text = slurp(f);
    fclose(f);
    return text;
}

/* ---- difference ------------------------------------------------------- */

static const char *line_end(const char *s)
{
    const char *e = strchr(s, '\n');
    return e ? e + 1 : s + strlen(s);
}

static bool same_line(const char *a, const char *b)
{
    size_t n = (size_t)(line_end(a) - a);
    return n == (size_t)(line_end(b) - b) && memcmp(a, b, n) == 0;
}

/* Lines that differ, a plan at a time: plans are compared by their titles'
 * order, which is fixed. */
static uint32_t print_difference(const char *was, const char *is)
{
    const char *title = "";
    uint32_t n = 0;
    while (*was && *is) {
        if (strncmp(is, "====", 4) == 0)
            title = is;
        /* Realign at the next title after lines came or went. */
        bool a = strncmp(was, "====", 4) == 0, b = strncmp(is, "====", 4) == 0;
        if (same_line(was, is)) {
            was = line_end(was);
            is = line_end(is);
            continue;
        }
        if (n++ < 40) {
            print_error("%.*s", (int)(line_end(title) - title), title);
            if (!a)
                print_error("- %.*s", (int)(line_end(was) - was), was);
            if (!b)
                print_error("+ %.*s", (int)(line_end(is) - is), is);
        }
        was = a ? was : line_end(was);
        is = b ? is : line_end(is);
        if (a && b)
            break;
    }
    return n + (*was || *is);
}

static void plans_are_the_stored_ones(void **state)
{
    (void)state;
    char *is = text_of_all();
    if (getenv("HL_UPDATE")) {
        FILE *f = fopen(path, "w");
        assert_non_null(f);
        assert_true(fputs(is, f) >= 0);
        assert_int_equal(fclose(f), 0);
        print_message("%s: written\n", path);
    }
    FILE *f = fopen(path, "r");
    if (!f)
        fail_msg("%s is not there: run from the root, or HL_UPDATE=1", path);
    char *was = slurp(f);
    fclose(f);
    uint32_t n = strcmp(was, is) ? print_difference(was, is) : 0;
    if (n)
        fail_msg("%u lines differ from %s: see above; if the plans are "
                 "better, write it anew with HL_UPDATE=1", n, path);
    free(was);
    free(is);
}

/* The same twice: nothing in a plan's text comes from memory or time. */
static void text_is_a_function_of_the_needs(void **state)
{
    (void)state;
    char *a = text_of_all(), *b = text_of_all();
    assert_string_equal(a, b);
    assert_true(strlen(a) > 10000);
    free(a);
    free(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plans_are_the_stored_ones),
        cmocka_unit_test(text_is_a_function_of_the_needs),
    };
    return cmocka_run_group_tests_name("stored plans", tests, NULL, NULL);
}
