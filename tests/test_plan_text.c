/* SPDX-License-Identifier: Zlib */
/* Plans in words: nothing without a name, every reason a sentence with its
 * own numbers, and the same page for the same plan. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include <cjson/cJSON.h>
#include "platforms/cli/plan_text.h"
#include "tests/check.h"

static struct hl_plan planned(enum hl_pipeline pipeline, uint32_t samples)
{
    struct hl_needs n;
    struct hl_caps caps;
    struct hl_plan p;
    memset(&n, 0, sizeof n);
    ck_lavapipe(&caps);
    n.width = 1280;
    n.height = 720;
    n.samples = samples;
    n.n_objects = 101;
    n.n_triangles = 56700;
    n.n_lights = 81;
    n.lights_per_pixel = 12.5f;
    n.lights_per_object = 12;
    n.specular = HL_NEED_EXPONENTS;
    n.far = 32;
    n.peak = 28;
    n.blended = true;
    assert_int_equal(hl_plan_make(&p, pipeline, &n, &caps, NULL), HL_OK);
    return p;
}

static void check_name(const char *name)
{
    assert_true(name[0] >= 'a' && name[0] <= 'z');
}

static void everything_has_a_name(void **state)
{
    (void)state;
    for (int i = 0; i < HL_PIPELINE_COUNT; i++)
        check_name(hlc_pipeline_name((enum hl_pipeline)i));
    for (int i = 0; i < HL_ROLE_COUNT; i++)
        check_name(hlc_role_name((enum hl_role)i));
    for (int i = 0; i < HL_PASS_ROLE_COUNT; i++)
        check_name(hlc_pass_name((enum hl_pass_role)i));
    for (int i = 0; i <= HL_TRANSLUCENCY_4X4; i++)
        assert_string_not_equal(
            hlc_translucency_name((enum hl_translucency)i), "?");
    for (int i = 0; i <= HL_STIPPLE_BY_DEPTH_FREE; i++)
        check_name(hlc_stipple_name((enum hl_stipple_mode)i));
    for (int i = 0; i <= HL_SHADOWS_MAPS; i++)
        check_name(hlc_shadows_name((enum hl_shadows)i));
    for (int i = 0; i <= HL_LIGHT_PATH_VOLUMES; i++)
        check_name(hlc_light_path_name((enum hl_light_path)i));
    for (int i = 0; i <= HL_BLEND_SHIFT; i++)
        check_name(hlc_blend_name((enum hl_blend)i));
    for (int i = 0; i <= HL_COMPARE_ALWAYS; i++)
        check_name(hlc_compare_name((enum hl_compare)i));
    for (int i = 0; i <= HL_PER_SHADOW_LIGHT; i++)
        check_name(hlc_repeat_name((enum hl_repeat)i));
    for (uint32_t i = 0; i <= HL_DSF_DARK; i++)
        check_name(hlc_dsf_name(i));
    for (uint32_t i = 0; i <= HL_SPECULAR_CHANNEL; i++)
        check_name(hlc_specular_name(i));
    for (uint32_t i = 0; i <= HL_TWO16_BYTES_ARGB; i++)
        check_name(hlc_two16_name(i));
    for (uint32_t i = 0; i <= HL_DEPTH_READ_BARG; i++)
        check_name(hlc_depth_read_name(i));
    for (int i = 0; i <= HL_HALF_PIXEL_VERTEX; i++)
        check_name(hlc_half_pixel_name((enum hl_half_pixel)i));
    for (int i = 0; i <= HL_DECALS_ALPHA_OBJECTS; i++)
        check_name(hlc_decals_name((enum hl_decals)i));
    for (uint32_t i = 0; i <= HL_NUMBER_SIGNED; i++)
        check_name(hlc_number_name(i));
    for (uint32_t i = 0; i <= HL_ENDIAN_16IN32; i++)
        assert_string_not_equal(hlc_endian_name(i), "?");
    for (int i = 1; i < HL_REFUSED_COUNT; i++)
        assert_true(strlen(hlc_refusal_text((enum hl_refusal)i)) > 10);
    assert_string_equal(hlc_refusal_text(HL_REFUSED_NOTHING), "");
    /* What no enum holds is shown, not followed. */
    assert_string_equal(hlc_role_name(HL_ROLE_COUNT), "?");
    assert_string_equal(hlc_refusal_text(HL_REFUSED_COUNT), "");
}

/* A plan of one reason, its arguments as long in print as they come. */
static struct hl_plan with(enum hl_reason why)
{
    struct hl_plan p;
    memset(&p, 0, sizeof p);
    p.pipeline = HL_PIPELINE_INFERRED;
    p.n_reasons = 1;
    p.reason[0].why = why;
    for (int i = 0; i < 4; i++)
        p.reason[0].arg[i] = -1.23456e-33f;
    return p;
}

static void every_reason_is_a_sentence_that_fits(void **state)
{
    (void)state;
    char text[512];
    for (int i = 1; i < HL_WHY_COUNT; i++) {
        struct hl_plan p = with((enum hl_reason)i);
        check_name(hlc_reason_name((enum hl_reason)i));
        for (int k = 1; k < i; k++)
            assert_string_not_equal(hlc_reason_name((enum hl_reason)i),
                                    hlc_reason_name((enum hl_reason)k));
        hlc_reason_text(&p, 0, text, sizeof text);
        assert_true(strlen(text) > 15 && strlen(text) < 256);
        assert_null(strpbrk(text, "#$=@&~^*!?"));
        /* Of those that say something else where argument 0 is 0. */
        p.reason[0].arg[0] = 1;
        hlc_reason_text(&p, 0, text, sizeof text);
        assert_true(strlen(text) > 15 && strlen(text) < 256);
    }
}

static void a_sentence_is_cut_to_its_room(void **state)
{
    (void)state;
    char whole[512], cut[512];
    struct hl_plan p = with(HL_WHY_DSF_SLOPE);
    hlc_reason_text(&p, 0, whole, sizeof whole);
    for (size_t room = 1; room <= strlen(whole) + 1; room++) {
        memset(cut, 'x', sizeof cut);
        hlc_reason_text(&p, 0, cut, room);
        assert_int_equal(strlen(cut), room - 1);
        assert_memory_equal(cut, whole, room - 1);
        assert_int_equal(cut[room], 'x');
    }
}

static void arguments_are_shown_as_what_they_are(void **state)
{
    (void)state;
    static const struct {
        enum hl_reason why;
        float arg[4];
        const char *want;
    } rows[] = {
        { HL_WHY_PIPELINE_CHEAPEST, { HL_PIPELINE_FORWARD, 1.25f, 0 },
          "forward is the cheapest pipeline: predicted 1.25 ms, the next one "
          "- ms" },
        { HL_WHY_PATH_ASKED, { HL_LIGHT_PATH_TILES, 0, 3.5f, 0 },
          "light path tiles was asked for; predicted ms: rects -, tiles 3.5, "
          "lists -" },
        { HL_WHY_COLOR_FORMAT, { HL_FORMAT_RGBA16_FLOAT, 7, 0.0039f, 1 },
          "the frame is in RGBA16_FLOAT: after 7 blends at most 0.39 % off, "
          "where the need is 1 codes of 255" },
        { HL_WHY_STIPPLED, { 2, 40.5f, 12.25f, 0 },
          "translucent surfaces are stippled into the G-buffer by blocks of 2 "
          "x 2 texels and lit with all else: predicted 12.2 ns a translucent "
          "pixel, 40.5 drawn forward" },
        { HL_WHY_FETCH, { 1, 3, 2, 0 },
          "light is fetched filtered where no tap is rejected, else by four "
          "taps: predicted 2 ns a pixel, four always 3" },
        { HL_WHY_FETCH, { 0, 3, 4, 0 },
          "light is fetched by four taps: predicted 3 ns a pixel, filtered "
          "where none is rejected 4" },
        { HL_WHY_LIGHT_SIZE_ASKED, { 1600, 900, 12800, 7200 },
          "a light buffer of 1600 x 900 under 12800 x 7200 was asked for" },
        { HL_WHY_NORMAL_FORMAT, { HL_FORMAT_RG8_UNORM, 0.9f, 1, 0 },
          "RG8_UNORM was asked for normals: two components, at most 0.9 "
          "degrees off where they face the viewer" },
        { HL_WHY_LIGHT_FORMAT_DARK, { HL_FORMAT_RGBA16_UNORM, 2.4f, 1, 97 },
          "half a step of RGBA16_UNORM, where 1 stands for 97, would be 2.4 "
          "codes of 255 in the dark, past 1: it is not taken" },
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct hl_plan p = with(rows[i].why);
        char text[256];
        memcpy(p.reason[0].arg, rows[i].arg, sizeof rows[i].arg);
        hlc_reason_text(&p, 0, text, sizeof text);
        assert_string_equal(text, rows[i].want);
    }
}

/* Forward shading has no one exponent; with BRDFs its channel is there. */
static void an_exponent_says_where_it_is(void **state)
{
    (void)state;
    struct hl_plan p = with(HL_WHY_EXPONENT_CONSTANT);
    char text[256];
    p.reason[0].arg[0] = 32;
    hlc_reason_text(&p, 0, text, sizeof text);
    assert_string_equal(text, "the specular exponent is 32 for all materials "
                              "and takes no channel");
    p.n_targets = 1;
    p.target[0].role = HL_ROLE_EXPONENT;
    hlc_reason_text(&p, 0, text, sizeof text);
    assert_string_equal(text, "the specular exponent is 32 for all materials: "
                              "the light pass reads none");
    p.pipeline = HL_PIPELINE_FORWARD;
    hlc_reason_text(&p, 0, text, sizeof text);
    assert_string_equal(text, "each material's own specular exponent is shaded "
                              "with");
}

/* ---- pages -------------------------------------------------------------- */

static char *page(const struct hl_plan *p)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    hl_plan_text(out, p);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void check_has(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("no '%s' in:\n%s", part, text);
}

static void a_page_shows_targets_passes_and_reasons(void **state)
{
    (void)state;
    struct hl_plan p = planned(HL_PIPELINE_INFERRED, 4);
    char *text = page(&p), *again = page(&p);
    assert_string_equal(text, again);
    check_has(text, "pipeline inferred: 1280x720, light 800x450, 4 samples");
    check_has(text, "  dsf          RG16_UNORM     800x450     x1     1440000 "
                    "bytes, read by material as R32_UINT, error 0.000244 "
                    "metres");
    check_has(text, "  blended   once               to color, depth depth "
                    "greater, blend over");
    for (uint32_t i = 0; i < p.n_reasons; i++) {
        char reason[256];
        hlc_reason_text(&p, i, reason, sizeof reason);
        check_has(text, reason);
    }
    check_has(text, "[K 6, fig. 9]");
    free(text);
    free(again);
}

static void forward_pages_have_no_light_buffer(void **state)
{
    (void)state;
    for (int i = HL_PIPELINE_FORWARD; i <= HL_PIPELINE_FORWARD_MULTIPASS;
         i++) {
        struct hl_plan p = planned((enum hl_pipeline)i, 1);
        char *text = page(&p);
        assert_null(strstr(text, "1280x720, light"));
        assert_null(strstr(text, "dsf"));
        check_has(text, "each material's own specular exponent");
        free(text);
    }
}

static void json_holds_the_whole_plan(void **state)
{
    (void)state;
    for (int i = HL_PIPELINE_FORWARD; i < HL_PIPELINE_COUNT; i++) {
        struct hl_plan p = planned((enum hl_pipeline)i, 1);
        cJSON *j = hlc_plan_json(&p);
        static const char *const counted[] = { "targets", "passes",
                                               "reasons" };
        const uint32_t n[] = { p.n_targets, p.n_passes, p.n_reasons };
        assert_non_null(j);
        for (int k = 0; k < 3; k++)
            assert_int_equal(cJSON_GetArraySize(
                cJSON_GetObjectItem(j, counted[k])), n[k]);
        bool inferred = i == HL_PIPELINE_INFERRED;
        assert_int_equal(cJSON_IsNull(cJSON_GetObjectItem(j, "light")),
                         !inferred);
        assert_int_equal(cJSON_IsNull(cJSON_GetObjectItem(j, "light_size")),
                         !inferred);
        char *text = cJSON_PrintUnformatted(j);
        check_has(text, inferred ? "\"error\":0.000244144,\"error_unit\":"
                                   "\"metres\"" : "\"dsf\":null");
        cJSON_free(text);
        cJSON_Delete(j);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_has_a_name),
        cmocka_unit_test(every_reason_is_a_sentence_that_fits),
        cmocka_unit_test(a_sentence_is_cut_to_its_room),
        cmocka_unit_test(arguments_are_shown_as_what_they_are),
        cmocka_unit_test(an_exponent_says_where_it_is),
        cmocka_unit_test(a_page_shows_targets_passes_and_reasons),
        cmocka_unit_test(forward_pages_have_no_light_buffer),
        cmocka_unit_test(json_holds_the_whole_plan),
    };
    return cmocka_run_group_tests_name("plan text", tests, NULL, NULL);
}
