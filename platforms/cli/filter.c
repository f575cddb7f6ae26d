/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/filter.h"
#include <math.h>
#include <string.h>

struct hlc_taps hlc_taps_gauss(int radius, double rate)
{
    struct hlc_taps t = { radius, { 0 } };
    double sum = 0;
    for (int i = -radius; i <= radius; i++)
        sum += t.tap[radius + i] = exp(-rate * i * i);
    for (int i = 0; i <= 2 * radius; i++)
        t.tap[i] /= sum;
    return t;
}

/* Taps outside, pixels inside: the inner loop is what compilers vectorise. */
static void accumulate(double *restrict dst, const double *restrict src,
                       size_t n, double tap)
{
    for (size_t i = 0; i < n; i++)
        dst[i] += tap * src[i];
}

void hlc_filter_rows(double *dst, const double *src, size_t width,
                     size_t rows, const struct hlc_taps *taps,
                     double *scratch)
{
    size_t r = (size_t)taps->radius;
    for (size_t y = 0; y < rows; y++) {
        const double *from = src + y * width;
        double *to = dst + y * width;
        for (size_t i = 0; i < r; i++) {
            scratch[i] = from[0];
            scratch[r + width + i] = from[width - 1];
        }
        memcpy(scratch + r, from, width * sizeof *from);
        memset(to, 0, width * sizeof *to);
        for (size_t k = 0; k <= 2 * r; k++)
            accumulate(to, scratch + k, width, taps->tap[k]);
    }
}

void hlc_filter_columns(double *dst, const double *src, size_t width,
                        size_t rows, const struct hlc_taps *taps)
{
    memset(dst, 0, rows * width * sizeof *dst);
    for (size_t y = 0; y < rows; y++)
        for (size_t k = 0; k <= 2 * (size_t)taps->radius; k++)
            accumulate(dst + y * width, src + (y + k) * width, width,
                       taps->tap[k]);
}
