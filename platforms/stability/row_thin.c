/* SPDX-License-Identifier: Zlib */
/* Lit strips before a wall that has a tenth of their light: how many of a
 * strip's pixels have not its light. */
#include <math.h>
#include <stdlib.h>
#include "platforms/stability/flat.h"

enum { WIDTH = 2048, FAST_WIDTH = 1024, HEIGHT = 16, /* upright strips       */
       SIDE = 320, FAST_SIDE = 224,                  /* tilted ones          */
       BORDER = 6 };

enum { EIGHTHS, ALPHA, SINE, PUBLISHED };            /* hls_case.arg         */

/* Of strips, pixels: 4 texels at half size between them; no small number of
 * pitches is nearly a whole number of texels. */
#define PITCH 10.605
#define CONTRAST 0.9
#define WALL 0.25                /* frame heights behind                     */

/* A strip's light of 1 that is a tenth off. */
#define LOST 0.1

struct strips { double width, alpha, c, s; };  /* c, s: across              */

static void add_strips(struct hls_flat *f, const struct strips *t)
{
    double reach = f->width + f->height;
    double middle[2] = { f->width / 2.0, f->height / 2.0 };
    double a[2] = { reach, 0 }, b[2] = { 0, reach };
    hls_flat_piece(f, middle, a, b, WALL, 1 - CONTRAST);
    hls_flat_object(f, 1, 1);
    int n = (int)(reach / 2 / PITCH);
    for (int i = -n; i <= n; i++) {
        double at[2] = { middle[0] + i * PITCH * t->c,
                         middle[1] + i * PITCH * t->s };
        double u[2] = { t->width / 2 * t->c, t->width / 2 * t->s };
        double v[2] = { -reach * t->s, reach * t->c };
        hls_flat_piece(f, at, u, v, 0, 1);
    }
    hls_flat_object(f, 1, t->alpha);
}

/* Is the middle of the pixel on a strip? Corners are rounded to 1/256 of a
 * pixel: what is nearer to a side than that does not count. */
static bool on_strip(const struct hlh_picture *p, uint32_t x, uint32_t y,
                     const struct strips *t)
{
    double d = (x + 0.5 - p->width / 2.0) * t->c +
               (y + 0.5 - p->height / 2.0) * t->s;
    d /= PITCH;
    return fabs(d - floor(d + 0.5)) * PITCH < t->width / 2 - 1.0 / 256;
}

static double share(const struct hlh_picture *p, const struct strips *t)
{
    uint32_t all = 0, lost = 0;
    double wall = 1 - CONTRAST, want = t->alpha + (1 - t->alpha) * wall;
    for (uint32_t y = BORDER; y < p->height - BORDER; y++)
        for (uint32_t x = BORDER; x < p->width - BORDER; x++) {
            if (!on_strip(p, x, y, t))
                continue;
            double is = (double)p->rgb[3 * (y * p->width + x)];
            all++;
            lost += fabs(is - want) <= LOST * t->alpha ? 0u : 1u;
        }
    return all ? (double)lost / all : NAN;
}

static struct hlc_options options(const struct hls_lab *lab,
                                  const struct hls_case *c)
{
    bool fast = lab->o->fast, tilted = c->arg[SINE] > 0;
    uint32_t width = tilted ? fast ? FAST_SIDE : SIDE
                            : fast ? FAST_WIDTH : WIDTH;
    struct hlc_options o = hls_flat_options(lab, width,
                                            tilted ? width : HEIGHT,
                                            (uint32_t)c->arg[EIGHTHS]);
    if (c->arg[ALPHA] < 1)
        o.translucency = HL_TRANSLUCENCY_2X2;
    if (c->arg[PUBLISHED] > 0)
        o.fill = HL_FILL_BILINEAR;
    else if (tilted && o.fill == HL_FILL_AUTO)
        o.fill = HL_FILL_NEAREST;
    return o;
}

/* p: width in pixels. */
static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c);
    double s = c->arg[SINE];
    struct strips t = { p, c->arg[ALPHA], sqrt(1 - s * s), s };
    struct hls_flat f;
    struct hlh_picture picture;
    hls_flat_begin(&f, o.width, o.height);
    add_strips(&f, &t);
    if (!hls_flat_end(&f, lab, &o) || !hls_flat_draw(&picture, lab, &o))
        return false;
    *m = share(&picture, &t);
    hlh_picture_free(&picture);
    return true;
}

/* A strip as wide as a texel has one of its own beside every point: 1 / ratio
 * pixels. Of stippled strips every other texel counts: 2 / ratio. What is 2 %
 * below loses the light of one pixel in 50, of which 180 strips (--fast: 90)
 * have enough; the bisection adds 1 %. At 1:1 light is fetched at the pixel
 * itself, and no width loses it.
 *
 * A strip turned by t, sin t = 0.297, has no tap below a gap of cos t - sin t =
 * 0.657 texels (row_taps.c), 1.05 pixels; but the nearest of sixteen samples is
 * its own down to the gaps of i cos t + j sin t, i and j from -1 to 2, of which
 * the widest is sin t. */
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
    { "tilted", "17.3 degrees, filled by the nearest sample", 0.25, 4, 0.01,
      true, 0.44, 0.5, "sin t / ratio = 0.476", { 5, 1, 0.297375091 } },
    { "published", "the same, published fill: bilinear", 0.25, 4, 0.01, true,
      1, 1.07, "(cos t - sin t) / ratio = 1.05", { 5, 1, 0.297375091, 1 } },
};

const struct hls_row hls_row_thin = {
    "thin", "What is thinner than an L texel has its surroundings' light",
    "2, K 3", "width", "pixels", "share of pixels more than 10 % off",
    HLS_LOG, cases, sizeof cases / sizeof *cases, NULL, NULL, measure
};
