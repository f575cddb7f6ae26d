/* SPDX-License-Identifier: Zlib */
/* Structural similarity: Wang, Bovik, Sheikh, Simoncelli, "Image quality
 * assessment: from error visibility to structural similarity", 2004, with
 * its 11 x 11 Gaussian window of sigma 1.5. On luma as a screen shows it: the
 * picture clamped to 0..1, sRGB-encoded, BT.709 weights, range 1. Windows
 * that hang over the border are left out. */
#include <math.h>
#include <stdlib.h>
#include "platforms/cli/filter.h"
#include "platforms/cli/metrics.h"

enum { RADIUS = 5, BAND = 32, TALL = BAND + 2 * RADIUS };

static double encode(double v)
{
    if (v <= 0.0031308)
        return v > 0 ? 12.92 * v : 0;
    return v < 1 ? 1.055 * pow(v, 1 / 2.4) - 0.055 : 1.0;
}

static double luma(const float *rgb)
{
    return 0.2126 * encode((double)rgb[0]) + 0.7152 * encode((double)rgb[1]) +
           0.0722 * encode((double)rgb[2]);
}

struct work {
    size_t width;
    struct hlc_taps taps;
    double *source[5];       /* x, y, x^2, y^2, xy: TALL rows                */
    double *mean[5];         /* the same, weighted: BAND rows                */
    double *across, *line;
};

static double *make_work(struct work *w, size_t width)
{
    size_t tall = TALL * width, rows = BAND * width;
    double *memory = malloc((6 * tall + 5 * rows + width + 2 * RADIUS) *
                            sizeof *memory);
    double *p = memory;
    if (!memory)
        return NULL;
    w->width = width;
    w->taps = hlc_taps_gauss(RADIUS, 1 / (2 * 1.5 * 1.5));
    for (int i = 0; i < 5; i++, p += tall)
        w->source[i] = p;
    for (int i = 0; i < 5; i++, p += rows)
        w->mean[i] = p;
    w->across = p;
    w->line = p + tall;
    return memory;
}

static void load(struct work *w, const float *test, const float *reference,
                 size_t rows)
{
    for (size_t i = 0; i < rows * w->width; i++) {
        double x = luma(test + 3 * i), y = luma(reference + 3 * i);
        w->source[0][i] = x;
        w->source[1][i] = y;
        w->source[2][i] = x * x;
        w->source[3][i] = y * y;
        w->source[4][i] = x * y;
    }
}

static double similarity(const struct work *w, size_t i)
{
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double x = w->mean[0][i], y = w->mean[1][i];
    double xx = w->mean[2][i] - x * x, yy = w->mean[3][i] - y * y;
    double xy = w->mean[4][i] - x * y;
    return (2 * x * y + c1) * (2 * xy + c2) /
           ((x * x + y * y + c1) * (xx + yy + c2));
}

/* Sum over the windows whose middles are in `rows` rows. */
static double sum_band(struct work *w, size_t rows)
{
    double sum = 0;
    for (int k = 0; k < 5; k++) {
        hlc_filter_rows(w->across, w->source[k], w->width, rows + 2 * RADIUS,
                        &w->taps, w->line);
        hlc_filter_columns(w->mean[k], w->across, w->width, rows, &w->taps);
    }
    for (size_t y = 0; y < rows; y++)
        for (size_t x = RADIUS; x < w->width - RADIUS; x++)
            sum += similarity(w, y * w->width + x);
    return sum;
}

bool hlc_ssim(double *out, const struct hlh_picture *test,
              const struct hlh_picture *reference)
{
    size_t width = test->width, height = test->height, step = width * 3;
    struct work w;
    *out = (double)NAN;
    if (width <= 2 * RADIUS || height <= 2 * RADIUS)
        return true;
    double *memory = make_work(&w, width), sum = 0;
    if (!memory)
        return false;
    size_t middles = height - 2 * RADIUS;
    for (size_t y = 0; y < middles; y += BAND) {
        size_t rows = middles - y < BAND ? middles - y : BAND;
        load(&w, test->rgb + y * step, reference->rgb + y * step,
             rows + 2 * RADIUS);
        sum += sum_band(&w, rows);
    }
    *out = sum / ((double)middles * (double)(width - 2 * RADIUS));
    free(memory);
    return true;
}
