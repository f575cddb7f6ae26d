/* SPDX-License-Identifier: Zlib */
/* hl_plan.error_codes: the model's parts one by one. */
#include <string.h>
#include "core/pipe.h"
#include "tests/console_kit.h"

static struct hl_needs lit(void)
{
    struct hl_needs n = con_needs();
    n.probe = (struct hl_probe){ 0.5f, 4, 6, 1, 3, 7, 0 };
    return n;
}

/* lavapipe as it is now, with a target of ten bits. */
static void lavapipe(struct hl_caps *c)
{
    ck_lavapipe(c);
    c->format[HL_FORMAT_RGB10A2_UNORM] = c->format[HL_FORMAT_RGBA8_UNORM];
}

static float codes(const struct hl_needs *n, const struct hl_caps *c,
                   uint32_t width, uint32_t height, enum hl_format f)
{
    struct hl_needs one = *n;
    one.light_width = width;
    one.light_height = height;
    one.light_format = f;
    return con_plan(HL_PIPELINE_INFERRED, &one, c).error_codes;
}

/* Of sizes 1 % more, lest like errors break a budget.
 * 16-bit floats of the frame's colour add 106 x 0.5 x 0.36 / 1024 codes,
 * squared 3.5e-4: less than 1e-3 of sums from 1 on. */
static void errors_add_by_squares(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    lavapipe(&c);
    c.error.margin = 1;
    n.probe = (struct hl_probe){ 3, 4 / 1.01f, 12, 0, 0, 0, 0 };
    n.light_path = HL_LIGHT_PATH_LISTS;   /* one blend                       */
    enum hl_format f = HL_FORMAT_RGBA32_FLOAT;
    ck_near((double)codes(&n, &c, 1280, 720, f), 3, 1e-3);
    ck_near((double)codes(&n, &c, 640, 360, f), 5, 1e-3);
    ck_near((double)codes(&n, &c, 640, 360, HL_FORMAT_RGBA8_UNORM), 13, 1e-3);
    /* The geometric mean of the sides counts; more than the frame has adds
     * nothing. */
    ck_near((double)codes(&n, &c, 1280, 180, f), 5, 1e-3);
    ck_near((double)codes(&n, &c, 2560, 1440, f), 3, 1e-3);
    c.error.margin = 2;
    ck_near((double)codes(&n, &c, 640, 360, f), 10, 2e-3);
}

static void sizes_between_lie_on_lines(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    lavapipe(&c);
    enum hl_format f = HL_FORMAT_RGBA32_FLOAT;
    c.error = (struct hl_error_model){
        .eighths = { 0, 0, 4, 2, 1, 0.8f, 0.6f, 0.5f, 0 }, .margin = 1 };
    n.probe = (struct hl_probe){ 1e-7f, 10 / 1.01f, 1, 0, 0, 0, 0 };
    ck_near((double)codes(&n, &c, 1120, 630, f), 5, 1e-3);
    ck_near((double)codes(&n, &c, 1200, 675, f), 2.5, 1e-3);
    ck_near((double)codes(&n, &c, 480, 270, f), 20, 1e-3);
    ck_near((double)codes(&n, &c, 160, 90, f), 80, 1e-2);
    /* What the probe drew goes before the calibration's. */
    n.probe.three_quarters = 9 / 1.01f;
    n.probe.quarter = 15 / 1.01f;
    ck_near((double)codes(&n, &c, 960, 540, f), 9, 1e-3);
    ck_near((double)codes(&n, &c, 320, 180, f), 15, 1e-3);
    float five = codes(&n, &c, 800, 450, f), three = codes(&n, &c, 480, 270, f);
    assert_true(five > 9 && five < 10 && three > 10 && three < 15);
    /* 255 is all there is. */
    assert_true(codes(&n, &c, 1, 1, f) == 255);
}

/* Unknown, then calibrated, then probed; less than 1e-6 is none. */
static void what_is_known_goes_before_what_is_not(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    lavapipe(&c);
    enum hl_format f = HL_FORMAT_RGBA32_FLOAT;
    float unknown = codes(&n, &c, 1280, 720, f);
    assert_true(unknown > 0.1f);
    c.error.full = 7;
    c.error.margin = 1;
    ck_near((double)codes(&n, &c, 1280, 720, f), 7, 1e-3);
    n.probe.full = 2;
    ck_near((double)codes(&n, &c, 1280, 720, f), 2, 1e-3);
    n.probe.full = 1e-7f;
    assert_true(codes(&n, &c, 1280, 720, f) < 0.05f);
}

static void more_blends_round_more(void **state)
{
    (void)state;
    struct hl_needs n = lit();
    struct hl_caps c;
    lavapipe(&c);
    n.probe.full = n.probe.half = 1e-7f;
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.lights_per_pixel = 63;
    n.batch = 1;
    float one = codes(&n, &c, 640, 360, HL_FORMAT_RGBA8_UNORM);
    /* 64 blends where the probe had one: eight times its 6 codes. */
    ck_near((double)one, 48, 0.02);
    n.probe.eight_blends = 64;
    ck_near((double)codes(&n, &c, 640, 360, HL_FORMAT_RGBA8_UNORM),
            6, 0.01);
    /* RTZ halves of 64 terms: 0.36 x 2^-10 x 65 / 2 of 53 codes. */
    ck_near((double)codes(&n, &c, 640, 360, HL_FORMAT_RGBA16_FLOAT), 0.61,
            0.02);
    assert_true(codes(&n, &c, 640, 360, HL_FORMAT_RGBA16_UNORM) <
                codes(&n, &c, 640, 360, HL_FORMAT_RGB10A2_UNORM));
}

static void the_dark_errs_by_its_frame_alone(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    struct hl_plan p;
    lavapipe(&c);
    n.n_lights = 0;
    n.lights_per_pixel = n.lights_per_object = 0;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    assert_true(p.error_codes > 0 && p.error_codes < 0.05f);
    n.budget_codes = 0.05f;
    con_plan(HL_PIPELINE_AUTO, &n, &c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(errors_add_by_squares),
        cmocka_unit_test(sizes_between_lie_on_lines),
        cmocka_unit_test(what_is_known_goes_before_what_is_not),
        cmocka_unit_test(more_blends_round_more),
        cmocka_unit_test(the_dark_errs_by_its_frame_alone),
    };
    return cmocka_run_group_tests_name("plan error", tests, NULL, NULL);
}
