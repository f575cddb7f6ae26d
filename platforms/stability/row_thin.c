/* SPDX-License-Identifier: Zlib */
/* Lit strips before a wall that has a tenth of their light: how many of a
 * strip's pixels have not its light. */
#include <math.h>
#include <stdlib.h>
#include "platforms/stability/flat.h"

enum { WIDTH = 2048, FAST_WIDTH = 1024, HEIGHT = 16, BORDER = 16 };

/* Of strips, pixels: 4 texels at half size between them; no small number of
 * pitches is nearly a whole number of texels. */
#define PITCH 10.605
#define CONTRAST 0.9
#define WALL 0.25                /* frame heights behind                     */

/* A strip's light of 1 that is a tenth off. */
#define LOST 0.1

static void add_strips(struct hls_flat *f, double width, double alpha)
{
    double middle[2] = { f->width / 2.0, f->height / 2.0 };
    double a[2] = { f->width, 0 }, b[2] = { 0, f->height };
    hls_flat_piece(f, middle, a, b, WALL, 1 - CONTRAST);
    hls_flat_object(f, 1, 1);
    a[0] = width / 2;
    for (middle[0] = PITCH; middle[0] < f->width - PITCH; middle[0] += PITCH)
        hls_flat_piece(f, middle, a, b, 0, 1);
    hls_flat_object(f, 1, alpha);
}

/* Is the middle of pixel x on a strip? Corners are rounded to 1/256 of a
 * pixel: what is nearer to a side than that does not count. */
static bool on_strip(uint32_t x, double width)
{
    double t = (x + 0.5) / PITCH;
    return fabs(t - floor(t + 0.5)) * PITCH < width / 2 - 1.0 / 256;
}

static double share(const struct hlh_picture *p, double width, double alpha)
{
    uint32_t all = 0, lost = 0, y = p->height / 2;
    double wall = 1 - CONTRAST, want = alpha + (1 - alpha) * wall;
    for (uint32_t x = BORDER; x < p->width - BORDER; x++) {
        if (!on_strip(x, width))
            continue;
        all++;
        lost += !(fabs((double)p->rgb[3 * (y * p->width + x)] - want) <=
                  LOST * alpha) ? 1u : 0u;
    }
    return all ? (double)lost / all : NAN;
}

/* p: width in pixels. */
static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    uint32_t width = lab->o->fast ? FAST_WIDTH : WIDTH;
    struct hlc_options o = hls_flat_options(lab, width, HEIGHT,
                                            (uint32_t)c->arg[0]);
    struct hls_flat f;
    struct hlh_picture picture;
    if (c->arg[1] < 1)
        o.translucency = HL_TRANSLUCENCY_2X2;
    hls_flat_begin(&f, width, HEIGHT);
    add_strips(&f, p, c->arg[1]);
    if (!hls_flat_end(&f, lab, &o) || !hls_flat_draw(&picture, lab, &o))
        return false;
    *m = share(&picture, p, c->arg[1]);
    hlh_picture_free(&picture);
    return true;
}

/* A strip as wide as a texel has one of its own beside every point: 1 / ratio
 * pixels. Of stippled strips every other texel counts: 2 / ratio. What is 2 %
 * below loses the light of one pixel in 50, of which 180 strips (--fast: 90)
 * have enough; the bisection adds 1 %. At 1:1 light is fetched at the pixel
 * itself, and no width loses it. */
static const struct hls_case cases[] = {
    { "half", "L-buffer 1/2", 0.25, 4, 0.01, true, 1.92, 2.04,
      "1 / ratio = 2", { 4, 1 } },
    { "five_eighths", "L-buffer 5/8", 0.25, 4, 0.01, true, 1.53, 1.64,
      "1 / ratio = 1.6", { 5, 1 } },
    { "three_quarters", "L-buffer 3/4", 0.25, 4, 0.01, true, 1.28, 1.36,
      "1 / ratio = 1.333", { 6, 1 } },
    { "whole", "L-buffer 1:1", 0.25, 4, 0.01, false, NAN, NAN,
      "each pixel is its own texel: never", { 8, 1 } },
    { "stippled", "stippled, L-buffer 5/8", 0.25, 6, 0.01, true, 3.07, 3.28,
      "2 / ratio = 3.2", { 5, 0.5 } },
};

const struct hls_row hls_row_thin = {
    "thin", "What is thinner than an L texel has its surroundings' light",
    "2, K 3", "width", "pixels", "share of pixels more than 10 % off",
    HLS_LOG, cases, sizeof cases / sizeof *cases, NULL, NULL, measure
};
