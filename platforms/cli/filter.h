/* SPDX-License-Identifier: Zlib */
#ifndef HLC_FILTER_H
#define HLC_FILTER_H
/* Separable filters over bands of rows, for the measures that look at
 * neighbourhoods: memory stays that of a band, whatever the picture. */
#include <stddef.h>

enum { HLC_RADIUS_MAX = 16 };

/* Taps -radius..radius; tap[radius] is the middle. */
struct hlc_taps {
    int radius;              /* 0..HLC_RADIUS_MAX                            */
    double tap[2 * HLC_RADIUS_MAX + 1];
};

/* exp(-rate x^2) at whole x, summing to 1. */
struct hlc_taps hlc_taps_gauss(int radius, double rate);

/* dst[y][x] = sum tap[k] src[y][x + k - radius] over `rows` rows, columns
 * beyond the sides repeating the last one. `scratch` holds width + 2 radius.
 * dst and src do not overlap. */
void hlc_filter_rows(double *dst, const double *src, size_t width,
                     size_t rows, const struct hlc_taps *taps,
                     double *scratch);

/* dst[y][x] = sum tap[k] src[y + k][x]: src has rows + 2 radius rows, the
 * caller's to repeat at top and bottom. */
void hlc_filter_columns(double *dst, const double *src, size_t width,
                        size_t rows, const struct hlc_taps *taps);
#endif
