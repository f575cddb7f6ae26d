/* SPDX-License-Identifier: Zlib */
/* The material pass's filter in whole frames, on all machines and profiles:
 * what fills pixels without taps (K 3), filtered fetches (K 7.1), the picture
 * of who wrote which texel (K 4), and when the planner takes which. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/console_kit.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H };

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };
static struct fk_scene scene;

static const char *backend_of(void **state)
{
    return ck_machine(state)->backend->name;
}

/* As consoles keep it. */
static float *draw(struct fk_run *run)
{
    struct hlc_texels t;
    float *out = malloc((size_t)N * 4 * sizeof *out);
    assert_non_null(out);
    assert_int_equal(hl_frame_draw(run->r, &scene.frame, &run->stats), HL_OK);
    assert_int_equal(hlc_texels_read(&t, scene.m->device,
                                     hl_renderer_output(run->r)), HL_OK);
    for (size_t i = 0; i < N; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    return out;
}

/* ---- fetches ------------------------------------------------------------ */

static double peak_of(const float *picture)
{
    double peak = 0;
    for (size_t i = 0; i < (size_t)N * 4; i++)
        if (i % 4 != 3 && (double)picture[i] > peak)
            peak = (double)picture[i];
    return peak;
}

/* Filters of at least 8 bits of fraction: each axis is off by 2^-8 of the
 * contrast of its taps, which is below the light; materials reflect at most 1
 * of it. Both pictures are rounded: 2^-10 of half floats, 2^-7 of 7e3. */
static double fetch_bound(const struct hl_plan *p, double peak)
{
    enum hl_format f = hl_plan_target(p, HL_ROLE_COLOR)->format;
    double step = f == HL_FORMAT_RGB10A2_FLOAT ? 1.0 / 128 : 1.0 / 1024;
    return peak * (2 / 256.0 + 2 * step);
}

static float *draw_by(enum hl_fetch fetch, struct hl_plan *plan)
{
    struct fk_run run;
    scene.needs.fetch = fetch;
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.dsf_bilinear, fetch == HL_FETCH_BILINEAR);
    *plan = run.plan;
    assert_int_equal(fk_create(&run), HL_OK);
    float *out = draw(&run);
    fk_destroy(&run);
    return out;
}

static void filtered_fetches_give_what_four_give(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 4; i++) {
        struct ck_machine m;
        struct hl_plan plan;
        uint64_t seed = 5;
        ck_open_as(&m, backend, profiles[i]);
        fk_begin(&scene, &m);
        fk_room(&scene, 24, &seed);
        float *four = draw_by(HL_FETCH_GATHER, &plan);
        float *one = draw_by(HL_FETCH_BILINEAR, &plan);
        double e = fk_difference(one, four, N), peak = peak_of(four);
        double bound = fetch_bound(&plan, peak);
        print_message("%s: %.2g of %.2g\n", profiles[i], e, bound);
        assert_true(peak > 0.2 && e <= bound);
        free(one);
        free(four);
        fk_end(&scene);
        ck_close(&m);
    }
}

/* ---- fills -------------------------------------------------------------- */

/* Dark wires of six tenths of a pixel, that move 0.22 to 0.38 texels a row of
 * texels, far before a wall that is lit. */
static void wire(struct ck_machine *m)
{
    fk_begin(&scene, m);
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, -20, 30);
    for (int i = 0; i < 5; i++) {
        struct hl_item *it = fk_add(&scene, FK_QUAD, FK_PLAIN,
                                    0.5f * (float)i - 1, 0, 0, 1.6f);
        it->world[0] = 0.04f;
        it->world[4] = 1.6f * (0.22f + 0.04f * (float)i);
    }
    fk_light(&scene, 0, 0, -17, 12);
}

/* Pixels of wires without taps; how many of them are bright. */
static uint32_t bright_pixels(enum hl_fill fill, uint32_t *lost)
{
    static uint8_t rejects[N];
    static uint32_t ids[N];
    struct fk_run run;
    uint32_t bright = 0;
    scene.needs.fill = fill;
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(run.plan.fill, fill);
    float *p = draw(&run);
    assert_int_equal(hl_frame_inspect(run.r, &scene.frame, HL_INSPECT_IDS,
                                      ids, sizeof ids), HL_OK);
    assert_int_equal(hl_frame_inspect(run.r, &scene.frame, HL_INSPECT_REJECTS,
                                      rejects, sizeof rejects), HL_OK);
    *lost = 0;
    for (int i = 0; i < N; i++) {
        if (ids[i] >> 16 < 2 || rejects[i] != 5)
            continue;
        ++*lost;
        bright += p[i * 4] > 0.1f;
    }
    free(p);
    fk_destroy(&run);
    return bright;
}

/* Published: all of them show the wall's light. Filled: none, but at the
 * wires' ten ends: 0.08 m are 0.39 of a texel, so that what moves less a row
 * passes no column without a sample, and over four rows, of which the pixel is
 * in the middle two, it moves by 0.66 at least and so meets one. */
static void wires_keep_their_light(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 4; i++) {
        struct ck_machine m;
        uint32_t lost, again;
        ck_open_as(&m, backend, profiles[i]);
        wire(&m);
        uint32_t all = bright_pixels(HL_FILL_BILINEAR, &lost);
        uint32_t few = bright_pixels(HL_FILL_NEAREST, &again);
        print_message("%s: %u without taps, %u bright, filled %u\n",
                      profiles[i], lost, all, few);
        assert_true(lost >= 20 && lost == again);
        assert_int_equal(all, lost);
        assert_true(few <= 10);
        fk_end(&scene);
        ck_close(&m);
    }
}

/* ---- who wrote a texel -------------------------------------------------- */

/* Region ids of the G-buffer. */
static uint32_t *ids_of(struct fk_run *run)
{
    struct hlc_texels t;
    assert_int_equal(hl_frame_draw(run->r, &scene.frame, &run->stats), HL_OK);
    assert_int_equal(hlc_texels_read(&t, scene.m->device,
                                     hl_renderer_target(run->r, HL_ROLE_DSF)),
                     HL_OK);
    size_t n = (size_t)t.width * t.height;
    uint32_t *id = malloc(n * sizeof *id);
    assert_non_null(id);
    for (size_t i = 0; i < n; i++) {
        float texel[4], pair[2];
        hlc_texel(texel, &t, i);
        hlc_two16(pair, run->plan.two16, texel);
        id[i] = (uint32_t)(pair[1] * run->plan.id_steps + 0.5f);
    }
    hlc_texels_free(&t);
    return id;
}

/* 0, 1 and 1 + pattern where the geometry pass wrote nothing, the box, and a
 * translucent item, one of them textured; one of pattern 0 is in neither. */
static void stipple_picture(const char *profile, uint32_t side)
{
    static const uint8_t wanted[] = { 0, 3, 1, 0, 2 };
    struct fk_run run;
    uint32_t w, h, seen = 0;
    scene.surface[FK_FULL].blended = true;
    scene.needs.stipple_mode = HL_STIPPLE_USER;
    scene.needs.translucency = side == 2 ? HL_TRANSLUCENCY_2X2
                                         : HL_TRANSLUCENCY_4X4;
    fk_add(&scene, FK_BOX, FK_PLAIN, 0, 0, 0, 1.5f);
    for (int i = 1; i < 5; i++) {
        fk_add(&scene, FK_QUAD, i == 2 ? FK_FULL : FK_BLENDED,
               (float)i * 0.6f - 1, 0.3f * (float)i, 2.0f + 0.2f * (float)i,
               1)->stipple = wanted[i];
    }
    /* Without a light nothing would be drawn at all. */
    fk_light(&scene, 0, 0, 5, 20);
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    uint32_t *id = ids_of(&run);
    hl_inspect_size(run.r, HL_INSPECT_STIPPLE, &w, &h);
    assert_true(w == run.plan.light_width && h == run.plan.light_height);
    uint8_t *code = malloc((size_t)w * h);
    assert_non_null(code);
    assert_int_equal(hl_frame_inspect(run.r, &scene.frame, HL_INSPECT_STIPPLE,
                                      code, (size_t)w * h), HL_OK);
    for (uint32_t i = 0; i < w * h; i++) {
        uint32_t want = id[i] ? 1 : 0;
        for (int k = 1; k < 5; k++)
            if (id[i] == scene.item[k].id_base)
                want = 1u + wanted[k];
        if (code[i] != want)
            fail_msg("%s %u: texel %u is %u, not %u", profile, side, i,
                     code[i], want);
        seen |= 1u << code[i];
    }
    assert_int_equal(seen, 31);
    free(code);
    free(id);
    fk_destroy(&run);
}

static void the_picture_of_patterns_is_the_gbuffers(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 8; i++) {
        struct ck_machine m;
        ck_open_as(&m, backend, profiles[i / 2]);
        fk_begin(&scene, &m);
        stipple_picture(profiles[i / 2], i % 2 ? 4 : 2);
        fk_end(&scene);
        ck_close(&m);
    }
}

static void without_patterns_there_is_no_picture(void **state)
{
    struct fk_run run;
    uint8_t code[100 * 56];
    fk_begin(&scene, ck_machine(state));
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, 0, 1);
    fk_light(&scene, 0, 0, 5, 20);
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_inspect(run.r, &scene.frame, HL_INSPECT_STIPPLE,
                                      code, sizeof code), HL_ERR_UNSUPPORTED);
    fk_destroy(&run);
    fk_end(&scene);
}

/* ---- plans -------------------------------------------------------------- */

static struct hl_plan plan_of(const struct hl_profile *profile,
                              struct hl_needs n, enum hl_device_kind kind)
{
    struct hl_caps caps;
    con_caps(&caps, profile, false);
    caps.kind = kind;
    return con_plan(HL_PIPELINE_INFERRED, &n, &caps);
}

/* AUTO: where taps are numbers and one filtered fetch is one fetch. */
static void the_cheaper_fetch_is_planned(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_plan p = plan_of(&hl_profile_dx10, n, HL_DEVICE_DISCRETE);
    const struct hl_plan_reason *why = con_reason(&p, HL_WHY_FETCH);
    assert_non_null(why);
    assert_true(p.dsf_bilinear && why->arg[0] == 1);
    assert_true(why->arg[2] < why->arg[1]);
    p = plan_of(&hl_profile_dx10, n, HL_DEVICE_CPU);
    why = con_reason(&p, HL_WHY_FETCH);
    assert_true(!p.dsf_bilinear && why->arg[0] == 0);
    assert_true(why->arg[2] >= why->arg[1]);
    p = plan_of(&hl_profile_native, n, HL_DEVICE_DISCRETE);
    assert_false(p.dsf_bilinear);
}

/* Words make way for numbers; what cannot be filtered is gathered. */
static void asked_for_filters(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps caps;
    n.fetch = HL_FETCH_BILINEAR;
    con_caps(&caps, &hl_profile_native, false);
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &caps);
    const struct hl_plan_target *light = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_true(p.dsf_bilinear);
    assert_int_equal(light->sample_as, HL_FORMAT_NONE);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_DSF)->sample_as,
                     HL_FORMAT_R32_UINT);
    caps.format[light->format].use &= (uint8_t)~HL_USE_LINEAR;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &caps);
    assert_false(p.dsf_bilinear);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->sample_as,
                     HL_FORMAT_RG32_UINT);
}

/* Nothing to fill or to fetch in four where there is one sample; but under
 * stippled surfaces that one may be another surface's. */
static void one_sample_a_pixel(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.fetch = HL_FETCH_BILINEAR;
    n.light_width = n.width;
    n.light_height = n.height;
    struct hl_plan p = plan_of(&hl_profile_native, n, HL_DEVICE_CPU);
    assert_int_equal(p.dsf, HL_DSF_EXACT);
    assert_true(!p.dsf_bilinear && p.fill == HL_FILL_AUTO);
    assert_null(con_reason(&p, HL_WHY_FILL));
    n.blended = true;
    n.translucency = HL_TRANSLUCENCY_2X2;
    p = plan_of(&hl_profile_native, n, HL_DEVICE_CPU);
    assert_int_equal(p.dsf, HL_DSF_SLOPE);
    assert_true(p.dsf_bilinear && p.fill == HL_FILL_DEPTH);
    assert_true(con_reason(&p, HL_WHY_FILL)->arg[0] == HL_FILL_DEPTH);
    n.fill = HL_FILL_BILINEAR;
    p = plan_of(&hl_profile_native, n, HL_DEVICE_CPU);
    assert_int_equal(p.fill, HL_FILL_BILINEAR);
    assert_true(con_reason(&p, HL_WHY_FILL)->arg[0] == HL_FILL_BILINEAR);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(filtered_fetches_give_what_four_give),
        DRAWN(wires_keep_their_light),
        DRAWN(the_picture_of_patterns_is_the_gbuffers),
        DRAWN(without_patterns_there_is_no_picture),
        cmocka_unit_test(the_cheaper_fetch_is_planned),
        cmocka_unit_test(asked_for_filters),
        cmocka_unit_test(one_sample_a_pixel),
    };
    return cmocka_run_group_tests_name("filter in frames", tests, NULL, NULL);
}
