/* SPDX-License-Identifier: Zlib */
/* Strips before nothing: how many of their pixels find none of their own among
 * the four taps. Each is moved by another part of a texel, so that all places
 * between texels are met alike. */
#include <math.h>
#include <stdlib.h>
#include "platforms/stability/flat.h"

enum { EIGHTHS = 5, ALL_REJECTED = 5, SIDE = 640, FAST_SIDE = 320,
       BORDER = 4,               /* whose taps lie outside, pixels           */
       SQUARES = 12 };           /* pixels apart                             */

/* Of strips, pixels: no small number of pitches is nearly a whole number of
 * texels or of gaps between them, so that N strips meet all places but for a
 * few N-ths of a texel. */
#define PITCH 7.22

static double part(double x) { return x - floor(x); }

static void strips(struct hls_flat *f, double width, const double *arg)
{
    double c = arg[0], s = arg[1];
    double reach = f->width + f->height, half = width / 2;
    int n = (int)(reach / 2 / PITCH);
    for (int i = -n; i < n; i++) {
        double d = i * PITCH;
        double middle[2] = { f->width / 2.0 + d * c, f->height / 2.0 + d * s };
        double a[2] = { half * c, half * s };
        double b[2] = { -reach * s, reach * c };
        hls_flat_piece(f, middle, a, b, 0, 1);
    }
}

/* The golden section's kin for two dimensions spreads them over 8 pixels, which
 * are 5 texels. */
static void squares(struct hls_flat *f, double side)
{
    double a[2] = { side / 2, 0 }, b[2] = { 0, side / 2 };
    int n = (int)f->width / SQUARES - 2;
    for (int k = 0; k < n * n; k++) {
        double x = SQUARES * (1 + k % n) + 8 * part(k * 0.7548776662);
        double y = SQUARES * (1 + k / n) + 8 * part(k * 0.5698402910);
        double middle[2] = { x, y };
        hls_flat_piece(f, middle, a, b, 0, 1);
    }
}

static void count(uint32_t *all, uint32_t *lost, const uint8_t *taps,
                  uint32_t side)
{
    *all = *lost = 0;
    for (uint32_t y = BORDER; y < side - BORDER; y++)
        for (uint32_t x = BORDER; x < side - BORDER; x++) {
            *all += taps[y * side + x] != 0;
            *lost += taps[y * side + x] == ALL_REJECTED;
        }
}

/* p: width in L texels. */
static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    uint32_t side = lab->o->fast ? FAST_SIDE : SIDE;
    struct hlc_options o = hls_flat_options(lab, side, side, EIGHTHS);
    struct hls_flat f;
    void *taps;
    uint32_t all, lost;
    hls_flat_begin(&f, side, side);
    if (c->arg[2] > 0)
        squares(&f, p * 8 / EIGHTHS);
    else
        strips(&f, p * 8 / EIGHTHS, c->arg);
    hls_flat_object(&f, 1, 1);
    if (!hls_flat_end(&f, lab, &o) ||
        !hls_flat_inspect(&taps, HL_INSPECT_REJECTS, lab, &o))
        return false;
    count(&all, &lost, taps, side);
    free(taps);
    *m = all ? (double)lost / all : NAN;
    return true;
}

static bool open(struct hls_lab *lab, const struct hls_case *c,
                 const char **skip)
{
    (void)c;
    if (lab->o->dsf == HL_DSF_NONE)
        *skip = "no filter, nothing is rejected";
    return true;
}

/* A strip whose normal is turned by t misses all four taps where it lies
 * between two of their places along it, 0, sin t, cos t and their sum, in
 * texels: the widest of the three gaps is the boundary. The last of 80 strips
 * (--fast: 40) that fits into a gap may be missed: low is 4 % below; high is a
 * width of bisection above. */
static const struct hls_case cases[] = {
    { "axis", "along a side", 0.25, 1.25, 0.002, true, 0.96, 1.01,
      "share 1 - w: 0 from 1", { 1, 0 } },
    { "square", "isolated square", 0.25, 1.25, 0.002, true, 0.96, 1.01,
      "share 1 - w^2: 0 from 1", { 1, 0, 1 } },
    { "half", "atan(1/2)", 0.25, 1.25, 0.002, true, 0.429, 0.457,
      "three gaps of sin t = 0.447",
      { 0.894427191, 0.447213595 } },
    { "turned", "17.3 degrees", 0.25, 1.25, 0.002, true, 0.631, 0.667,
      "gap cos t - sin t = 0.657", { 0.954760744, 0.297375091 } },
    { "diagonal", "45 degrees", 0.25, 1.25, 0.002, true, 0.678, 0.717,
      "share 1 - w sqrt 2: 0 from 0.707",
      { 0.707106781, 0.707106781 } },
};

const struct hls_row hls_row_taps = {
    "taps", "All four taps rejected on what is thinner than an L-buffer texel",
    "2, K 3", "width", "texels", "share of pixels without a tap",
    HLS_LINEAR, cases, sizeof cases / sizeof *cases, open, NULL, measure
};
