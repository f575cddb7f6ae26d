/* SPDX-License-Identifier: Zlib */
#ifndef HLC_FLICKER_H
#define HLC_FLICKER_H
/* Flicker of a picture that drifts by jitter alone: to and fro within a pixel,
 * so that the way back W is exactly known: what is at p was at
 * p - (jitter now - jitter before). e is the linear difference of a frame to
 * the reference's, moved alike. F is the mean over frames, pixels and colours
 * of |e(p) - e before(W(p))|, e taken bilinearly: a constant error gives 0, one
 * that comes and goes does not. */
#include <stdbool.h>
#include <stdint.h>

struct hlc_flicker {
    uint32_t width, height;
    float *error, *before;       /* RGB a pixel, malloc'd                    */
    float jitter[2];             /* of `error`                               */
    uint32_t frames;
    double sum, square;          /* of changes; of e                         */
    double worst, worst_error;
};

bool hlc_flicker_begin(struct hlc_flicker *, uint32_t width, uint32_t height);
void hlc_flicker_end(struct hlc_flicker *);
/* One frame more: RGB linear, and the reference's. */
void hlc_flicker_add(struct hlc_flicker *, const float *rgb,
                     const float *reference, const float jitter[2]);
double hlc_flicker_f(const struct hlc_flicker *);
double hlc_flicker_rms(const struct hlc_flicker *);
/* Jitter of frame t, pixels: `steps` frames a pixel, y at 3/5 of x's pace. */
void hlc_flicker_jitter(float out[2], uint32_t t, uint32_t steps);
#endif
