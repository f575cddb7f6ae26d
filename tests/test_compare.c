/* SPDX-License-Identifier: Zlib */
/* The measures of `halflight compare` against closed forms and against
 * published programs. Pictures are made from 8-bit sRGB codes by integer
 * formulas, so that anyone can make them again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "platforms/cli/metrics.h"

static void near_at(int line, const char *what, double got, double want,
                    double tolerance)
{
    if (!(fabs(got - want) <= tolerance))
        fail_msg("line %d: %s is %.12g, not %.12g within %g", line, what, got,
                 want, tolerance);
}
#define near(got, want, tolerance) \
    near_at(__LINE__, #got, got, want, tolerance)

/* ---- pictures ----------------------------------------------------------- */

static struct hlh_picture blank(uint32_t width, uint32_t height, float value)
{
    struct hlh_picture p = { width, height, NULL, true };
    size_t n = (size_t)width * height * 3;
    p.rgb = malloc(n * sizeof *p.rgb);
    assert_non_null(p.rgb);
    for (size_t i = 0; i < n; i++)
        p.rgb[i] = value;
    return p;
}

static struct hlh_picture flat(uint32_t side, float r, float g, float b)
{
    struct hlh_picture p = blank(side, side, 0);
    for (size_t i = 0; i < (size_t)side * side; i++) {
        p.rgb[3 * i] = r;
        p.rgb[3 * i + 1] = g;
        p.rgb[3 * i + 2] = b;
    }
    return p;
}

static float *at(struct hlh_picture *p, uint32_t x, uint32_t y)
{
    return p->rgb + ((size_t)y * p->width + x) * 3;
}

static float linear(int code)
{
    double v = code / 255.0;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

enum { W = 96, H = 64 };

static int base_code(int x, int y, int c)
{
    if (c == 0)
        return (x * 7 + y * 13) % 256;
    if (c == 1)
        return (x * x / 8 + y * 5) % 256;
    return (x / 16 + y / 16) % 2 * 200 + 28;
}

static int noisy_code(int x, int y, int c)
{
    int v = base_code(x, y, c) + (x * 31 + y * 17 + c * 11) % 41 - 20;
    return v < 0 ? 0 : v > 255 ? 255 : v;
}

/* One pixel to the right. */
static int moved_code(int x, int y, int c)
{
    return base_code(x > 0 ? x - 1 : 0, y, c);
}

static struct hlh_picture drawn(int (*code)(int, int, int))
{
    struct hlh_picture p = blank(W, H, 0);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int c = 0; c < 3; c++)
                at(&p, (uint32_t)x, (uint32_t)y)[c] = linear(code(x, y, c));
    return p;
}

static struct hlc_metrics measured(const struct hlh_picture *test,
                                   const struct hlh_picture *reference,
                                   const uint32_t *ids)
{
    struct hlc_metrics m;
    assert_true(hlc_metrics_measure(&m, test, reference, ids));
    return m;
}

/* ---- closed forms ------------------------------------------------------- */

/* Sums of at most 18,432 doubles of one sign are 18,432 x 2^-53 = 2e-12 of
 * themselves off; what is summed here is below 1. */
#define SUMMED 2e-12

static void equal_pictures_have_no_error(void **state)
{
    (void)state;
    struct hlh_picture p = drawn(base_code);
    struct hlc_metrics m = measured(&p, &p, NULL);
    assert_true(isinf(m.psnr) && m.psnr > 0);
    near(m.relmse, 0, 0);
    near(m.max, 0, 0);
    near(m.p999, 0, 0);
    near(m.mae, 0, 0);
    near(m.rms_codes, 0, 0);
    near(m.within_1_255, 1, 0);
    near(m.flip, 0, 0);
    near(m.flip_p99, 0, 0);
    near(m.ssim, 1, SUMMED);
    assert_true(isnan(m.edge_mae) && isnan(m.rest_mae));
    hlh_picture_free(&p);
}

/* 0.5 and 0.25 are exact: e = -1/4 everywhere, peak 1/2. */
static void a_constant_error_is_the_closed_form(void **state)
{
    (void)state;
    struct hlh_picture r = blank(20, 10, 0.5f), t = blank(20, 10, 0.25f);
    struct hlc_metrics m = measured(&t, &r, NULL);
    near(m.peak, 0.5, 0);
    near(m.psnr, 10 * log10(4), SUMMED);
    near(m.relmse, 0.0625 / 0.26, SUMMED);
    near(m.max, 0.25, 0);
    near(m.p999, 0.25, 0);
    near(m.mae, 0.25, SUMMED);
    near(m.within_1_255, 0, 0);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

/* One channel of 300 is off by 2 where the reference is 3, high dynamic
 * range: nothing is clamped. */
static void one_bad_channel_is_the_closed_form(void **state)
{
    (void)state;
    struct hlh_picture r = blank(10, 10, 3), t = blank(10, 10, 3);
    at(&t, 4, 7)[1] = 1;
    struct hlc_metrics m = measured(&t, &r, NULL);
    near(m.peak, 3, 0);
    near(m.psnr, 10 * log10(9 * 300 / 4.0), SUMMED);
    near(m.relmse, 4 / 9.01 / 300, SUMMED);
    near(m.max, 2, 0);
    /* 299 of 300 values are 0 and fewer than 99.9 %: the last one counts. */
    near(m.p999, 2, 0);
    near(m.mae, 2.0 / 300, SUMMED);
    /* 1 and 3 both clamp to code 255. */
    near(m.within_1_255, 1, 0);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

static void a_black_reference_has_peak_one(void **state)
{
    (void)state;
    struct hlh_picture r = blank(4, 4, 0), t = blank(4, 4, 0.5f);
    struct hlc_metrics m = measured(&t, &r, NULL);
    near(m.peak, 1, 0);
    near(m.psnr, 10 * log10(4), SUMMED);
    assert_true(isnan(m.ssim)); /* no window of 11 x 11 fits */
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

static void percentiles_are_ranks(void **state)
{
    (void)state;
    /* i * 389 mod 1009 for i = 0..1008 is every whole number below the
     * prime 1009 once, in no order. */
    static const struct { double share; float want; } rows[] = {
        { 0, 0 }, { 0.5, 504 }, { 0.99, 998 }, { 0.999, 1007 }, { 1, 1008 } };
    for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
        float v[1009];
        for (int i = 0; i < 1009; i++)
            v[i] = (float)(i * 389 % 1009);
        near((double)hlc_percentile(v, 1009, rows[k].share),
             (double)rows[k].want, 0);
    }
    float same[5] = { 2, 2, 2, 2, 2 }, one[1] = { 7 };
    near((double)hlc_percentile(same, 5, 0.5), 2, 0);
    near((double)hlc_percentile(one, 1, 0.99), 7, 0);
}

/* Whether two codes are within one is decided on rounded codes. */
static void codes_are_rounded_before_they_are_compared(void **state)
{
    (void)state;
    struct hlh_picture r = blank(256, 1, 0), t = blank(256, 1, 0);
    for (int step = 0; step <= 3; step++) {
        int good = 0;
        for (int i = 0; i < 256; i++) {
            int to = i + step > 255 ? 255 : i + step;
            for (int c = 0; c < 3; c++) {
                at(&r, (uint32_t)i, 0)[c] = linear(i);
                at(&t, (uint32_t)i, 0)[c] = linear(c == 2 ? to : i);
            }
            good += to - i <= 1;
        }
        near(measured(&t, &r, NULL).within_1_255, good / 256.0, 0);
    }
    /* 100.4 and 101.6 are 1.2 apart but round to 100 and 102; 99.6 and
     * 101.4 are 1.8 apart and round to 100 and 101. */
    double far_apart[2] = { 100.4, 101.6 }, together[2] = { 99.6, 101.4 };
    for (int i = 0; i < 256; i++) {
        const double *pair = i < 64 ? far_apart : together;
        for (int c = 0; c < 3; c++) {
            at(&r, (uint32_t)i, 0)[c] =
                (float)pow((pair[0] / 255 + 0.055) / 1.055, 2.4);
            at(&t, (uint32_t)i, 0)[c] =
                (float)pow((pair[1] / 255 + 0.055) / 1.055, 2.4);
        }
    }
    near(measured(&t, &r, NULL).within_1_255, 0.75, 0);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

/* Pictures made of whole codes differ by whole codes, but for what 32-bit
 * floats keep of the linear values: 2^-24 of them is 2^-24 code / 2.4 of a
 * code, so at most 255 x 2^-24 / 2.4 = 6.4e-6 for each of the two. */
static void rms_of_codes_is_that_of_the_integers(void **state)
{
    (void)state;
    static int (*const codes[])(int, int, int) = { noisy_code, moved_code };
    struct hlh_picture r = drawn(base_code);
    for (int i = 0; i < 2; i++) {
        struct hlh_picture t = drawn(codes[i]);
        double squares = 0;
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++)
                for (int c = 0; c < 3; c++) {
                    int e = codes[i](x, y, c) - base_code(x, y, c);
                    squares += e * e;
                }
        near(measured(&t, &r, NULL).rms_codes, sqrt(squares / (W * H * 3)),
             1.3e-5);
        hlh_picture_free(&t);
    }
    /* Clamped: 255 to 0 in one channel of three, nothing beyond. */
    struct hlh_picture bright = flat(8, 9, 1, -3), dark = flat(8, 1, 0, 0);
    near(hlc_rms_codes(&bright, &dark), 255 / sqrt(3), 1e-12 * 255);
    near(hlc_rms_codes(&dark, &bright), 255 / sqrt(3), 1e-12 * 255);
    hlh_picture_free(&bright);
    hlh_picture_free(&dark);
    hlh_picture_free(&r);
}

/* ---- edges -------------------------------------------------------------- */

static uint64_t sum(const uint8_t *mask, size_t n)
{
    uint64_t s = 0;
    for (size_t i = 0; i < n; i++)
        s += mask[i];
    return s;
}

static void an_edge_reaches_two_pixels(void **state)
{
    (void)state;
    uint32_t ids[16 * 16] = { 0 };
    uint8_t mask[16 * 16];
    assert_true(hlc_edge_mask(mask, ids, 16, 16));
    assert_int_equal(sum(mask, 256), 0);
    /* A lone pixel makes edges of itself and its four neighbours; squares of
     * side 5 about them cover 5 x 7 + 7 x 5 - 5 x 5. */
    ids[7 * 16 + 8] = 3;
    assert_true(hlc_edge_mask(mask, ids, 16, 16));
    assert_int_equal(sum(mask, 256), 45);
    assert_int_equal(mask[4 * 16 + 8], 1);
    assert_int_equal(mask[4 * 16 + 10], 1);
    assert_int_equal(mask[4 * 16 + 11], 0);
    assert_int_equal(mask[3 * 16 + 8], 0);
    assert_int_equal(mask[7 * 16 + 11], 1);
    assert_int_equal(mask[7 * 16 + 12], 0);
    /* In the corner: of the 7 x 7 with cut corners a quarter is left. */
    ids[7 * 16 + 8] = 0;
    ids[0] = 9;
    assert_true(hlc_edge_mask(mask, ids, 16, 16));
    assert_int_equal(sum(mask, 256), 4 * 4 - 1);
}

/* Columns 0-4 and 5-11 have different ids: the edge is columns 2-7. */
static void edge_error_is_of_the_masked_pixels(void **state)
{
    (void)state;
    struct hlh_picture r = blank(12, 4, 1), t = blank(12, 4, 1);
    uint32_t ids[12 * 4];
    for (uint32_t y = 0; y < 4; y++)
        for (uint32_t x = 0; x < 12; x++) {
            ids[y * 12 + x] = x < 5 ? 65537 : 65538;
            at(&t, x, y)[0] += x == 2 || x == 7 ? 3 : 0;
            at(&t, x, y)[2] -= x == 1 || x == 8 ? 0.75f : 0;
        }
    struct hlc_metrics m = measured(&t, &r, ids);
    assert_int_equal(m.edge_pixels, 24);
    near(m.edge_mae, 8 * 3 / 72.0, SUMMED);
    near(m.rest_mae, 8 * 0.75 / 72.0, SUMMED);
    memset(ids, 0, sizeof ids);
    m = measured(&t, &r, ids);
    assert_int_equal(m.edge_pixels, 0);
    assert_true(isnan(m.edge_mae));
    near(m.rest_mae, (8 * 3 + 8 * 0.75) / 144, SUMMED);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

/* ---- FLIP --------------------------------------------------------------- */

/* Flat pictures have no features, so FLIP is the colour term alone. With the
 * L*a*b* of sRGB green (87.7355, -86.1816, 83.1866) and blue (32.3009,
 * 79.1953, -107.8555), a and b times L / 100, the largest distance ^0.7 is
 * 41.27657; black to white is 100^0.7 = 25.11886, above 0.4 of that, and
 * becomes 0.95 + 0.05 (25.11886 - 16.51063) / (41.27657 - 16.51063) =
 * 0.9673792. Seven digits, stored as float: 1e-7. */
static void flip_of_flat_pictures_is_the_closed_form(void **state)
{
    (void)state;
    struct hlh_picture black = flat(24, 0, 0, 0), white = flat(24, 1, 1, 1);
    struct hlh_picture green = flat(24, 0, 1, 0), blue = flat(24, 0, 0, 1);
    near(measured(&black, &white, NULL).flip, 0.9673792, 1e-7);
    /* The largest distance itself maps to 1, for every pixel. */
    near(measured(&green, &blue, NULL).flip, 1, 1e-6);
    near(measured(&blue, &green, NULL).flip_p99, 1, 1e-6);
    /* Beyond 0..1 the picture is clamped first: no edge is seen there. */
    struct hlh_picture bright = flat(24, 7, 9, 30);
    for (uint32_t y = 0; y < 24; y++)
        at(&bright, 12, y)[1] = 1;
    near(measured(&bright, &white, NULL).flip, 0, 0);
    hlh_picture_free(&black);
    hlh_picture_free(&white);
    hlh_picture_free(&green);
    hlh_picture_free(&blue);
    hlh_picture_free(&bright);
}

/* Values of the authors' package flip-evaluator 1.7 (PyPI), LDR, at 67.0206
 * pixels a degree, and of scikit-image 0.26.0 for SSIM (gaussian_weights,
 * sigma 1.5, use_sample_covariance off, data_range 1, on 0.2126 R + 0.7152 G
 * + 0.0722 B of the codes / 255). PSNR and the rest: numpy 2.4.6 in doubles.
 *
 * FLIP there is in 32-bit floats: filtered luminances of 19 taps each way are
 * 19 x 2^-24 = 1e-6 off, whose root is in the exponent: 1e-6 / (2 sqrt d) for
 * a feature difference d. Most pixels here have d > 1e-3, hence 2e-5 for the
 * mean; a single pixel may have d of 1e-5, hence 2e-4. The pictures are
 * floats here and doubles there: 2^-24 of a value up to 1, so 1e-7 for
 * absolute and relative measures, times 10 / ln 10 / mae for the PSNR. */
struct published {
    int (*code)(int, int, int);
    double flip, flip_p99, pixel[3];   /* pixels 10,20  95,63  0,0          */
    double ssim, psnr, relmse, max, p999, mae, within;
};

static const struct published published[] = {
    { noisy_code, 0.05647832155227661, 0.13078853,
      { 0.04830861, 0.16430263, 0.052165303 },
      0.9286972310973466, 24.847921579292485, 0.017608058183547232,
      0.16923012322534536, 0.16467541291665588, 0.039838885888126, 0.0 },
    { moved_code, 0.3608456552028656, 0.82301956,
      { 0.098083586, 0.45674556, 0.019248804 },
      0.6761130061026722, 14.783472511514633, 2.6731377054040717,
      1.0, 0.998178838098707, 0.05887306233856441, 0.010416666666666666 },
};

static void measures_are_those_of_published_programs(void **state)
{
    (void)state;
    struct hlh_picture r = drawn(base_code);
    float *map = malloc((size_t)W * H * sizeof *map);
    assert_non_null(map);
    for (size_t i = 0; i < sizeof published / sizeof published[0]; i++) {
        const struct published *p = &published[i];
        struct hlh_picture t = drawn(p->code);
        struct hlc_metrics m = measured(&t, &r, NULL);
        near(m.flip, p->flip, 2e-5);
        near(m.flip_p99, p->flip_p99, 2e-4);
        near(m.ssim, p->ssim, 1e-6);
        near(m.psnr, p->psnr, 1e-5);
        near(m.relmse, p->relmse, 1e-6);
        near(m.max, p->max, 1e-7);
        near(m.p999, p->p999, 1e-7);
        near(m.mae, p->mae, 1e-7);
        near(m.within_1_255, p->within, SUMMED);
        assert_true(hlc_flip_map(map, &t, &r));
        near((double)map[20 * W + 10], p->pixel[0], 2e-4);
        near((double)map[63 * W + 95], p->pixel[1], 2e-4);
        near((double)map[0], p->pixel[2], 2e-4);
        hlh_picture_free(&t);
    }
    free(map);
    hlh_picture_free(&r);
}

static int grey_code(int x, int y, int c)
{
    (void)x, (void)y, (void)c;
    return 128;
}

static int dotted_code(int x, int y, int c)
{
    return x % 24 == 12 && y % 24 == 12 ? 255 : grey_code(x, y, c);
}

/* White dots on grey: at a dot no edge answers, only the point detector. The
 * same package and tolerances. */
static void flip_sees_points(void **state)
{
    (void)state;
    struct hlh_picture r = drawn(grey_code), t = drawn(dotted_code);
    float map[W * H];
    assert_true(hlc_flip_map(map, &t, &r));
    near((double)map[12 * W + 12], 0.3786781, 2e-4);
    near((double)map[36 * W + 36], 0.3786781, 2e-4);
    near((double)map[12 * W + 16], 0.0038976788, 2e-4);
    struct hlc_metrics m = measured(&t, &r, NULL);
    near(m.flip, 0.008391558192670345, 2e-5);
    near(m.flip_p99, 0.22351174, 2e-4);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

/* Rows are worked on in bands: a picture that repeats down its columns gives
 * one answer away from top and bottom, wherever bands begin. */
static void bands_leave_no_seams(void **state)
{
    (void)state;
    enum { N = 100 };
    struct hlh_picture r = blank(40, N, 0), t = blank(40, N, 0);
    float map[40 * N];
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < 40; x++)
            for (int c = 0; c < 3; c++) {
                at(&r, x, y)[c] = linear(base_code((int)x, 0, c));
                at(&t, x, y)[c] = linear(noisy_code((int)x, 0, c));
            }
    assert_true(hlc_flip_map(map, &t, &r));
    for (size_t i = 40; i < 40 * N; i++)
        near((double)map[i], (double)map[i - 40], 0);
    hlh_picture_free(&r);
    hlh_picture_free(&t);
}

static void the_smallest_pictures_are_measured(void **state)
{
    (void)state;
    static const uint32_t size[][2] = { { 1, 1 }, { 1, 37 }, { 37, 1 },
                                        { 11, 11 }, { 10, 50 } };
    for (size_t i = 0; i < sizeof size / sizeof size[0]; i++) {
        struct hlh_picture r = blank(size[i][0], size[i][1], 0.25f);
        struct hlh_picture t = blank(size[i][0], size[i][1], 0.5f);
        struct hlc_metrics m = measured(&t, &r, NULL);
        near(m.mae, 0.25, SUMMED);
        assert_true(m.flip > 0.1 && m.flip < 1);
        assert_int_equal(isnan(m.ssim), i != 3);
        hlh_picture_free(&r);
        hlh_picture_free(&t);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures_have_no_error),
        cmocka_unit_test(a_constant_error_is_the_closed_form),
        cmocka_unit_test(one_bad_channel_is_the_closed_form),
        cmocka_unit_test(a_black_reference_has_peak_one),
        cmocka_unit_test(percentiles_are_ranks),
        cmocka_unit_test(codes_are_rounded_before_they_are_compared),
        cmocka_unit_test(rms_of_codes_is_that_of_the_integers),
        cmocka_unit_test(an_edge_reaches_two_pixels),
        cmocka_unit_test(edge_error_is_of_the_masked_pixels),
        cmocka_unit_test(flip_of_flat_pictures_is_the_closed_form),
        cmocka_unit_test(measures_are_those_of_published_programs),
        cmocka_unit_test(flip_sees_points),
        cmocka_unit_test(bands_leave_no_seams),
        cmocka_unit_test(the_smallest_pictures_are_measured),
    };
    return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
