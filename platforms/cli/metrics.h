/* SPDX-License-Identifier: Zlib */
#ifndef HLC_METRICS_H
#define HLC_METRICS_H
/* How far a picture is from a reference. e = test - reference, linear, per
 * channel; a mean is over all pixels and channels. */
#include "platforms/host/image.h"

struct hlc_metrics {
    double peak;             /* largest channel of the reference; 1 where
                              * that is not above 0                          */
    double psnr;             /* dB, 10 log10(peak^2 / mean e^2); INFINITY:
                              * identical                                    */
    double relmse;           /* mean e^2 / (reference^2 + 0.01)              */
    double max, p999, mae;   /* of |e|; p999: the smallest value that 99.9 %
                              * of all do not exceed                         */
    double edge_mae, rest_mae; /* within 2 px of an id edge, and not; NAN:
                              * no ids, or no such pixel                     */
    uint64_t edge_pixels;
    double rms_codes;        /* hlc_rms_codes                                */
    double within_1_255;     /* share of pixels whose three 8-bit sRGB codes
                              * differ by 1 at most                          */
    double flip, flip_p99;   /* FLIP-LDR: mean, and 99 % as p999; 0..1       */
    double ssim;             /* -1..1; NAN: a side below 11 px               */
};

/* All measures. Both pictures finite and of one size, at least 1 x 1; ids of
 * the reference, a pixel each, or NULL. False when memory is out. */
bool hlc_metrics_measure(struct hlc_metrics *out,
                         const struct hlh_picture *test,
                         const struct hlh_picture *reference,
                         const uint32_t *ids);

/* The parts, for tests. Arguments as above. */

/* FLIP of each pixel into map, width * height. */
bool hlc_flip_map(float *map, const struct hlh_picture *test,
                  const struct hlh_picture *reference);
bool hlc_ssim(double *out, const struct hlh_picture *test,
              const struct hlh_picture *reference);
/* mask[i] = 1 within 2 px (larger of |dx| and |dy|) of a pixel that has one
 * of its four neighbours under another id, else 0. False: memory is out. */
bool hlc_edge_mask(uint8_t *mask, const uint32_t *ids, uint32_t width,
                   uint32_t height);
/* Root mean square, over pixels and channels, of the difference of 8-bit sRGB
 * codes (IEC 61966-2-1 of values clamped to 0..1, times 255, not rounded):
 * 0..255. Same sizes. */
double hlc_rms_codes(const struct hlh_picture *a, const struct hlh_picture *b);
/* The smallest of n > 0 values that `share` (0..1) of all do not exceed.
 * Reorders the values. */
float hlc_percentile(float *values, size_t n, double share);
#endif
