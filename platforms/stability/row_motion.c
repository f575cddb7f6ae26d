/* SPDX-License-Identifier: Zlib */
/* White strips of light 1 that drift before a wall by parts of a pixel a frame.
 * The wall has a tenth of their light and reflects none: what is seen are the
 * strips. A strip's error e is the mean over what it covers, against forward
 * rendering of the same frame; where it covers nothing it has the last. F is
 * the mean over strips and frames of |e - e before|: a strip is its own way
 * back.
 *
 * A strip thinner than an L texel has a sample and then has none, twice a
 * texel of way: F = 2 C v r, C the contrast, v pixels a frame, r L texels a
 * pixel, whatever its width. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/flat.h"

enum { WIDTH = 1024, FAST_WIDTH = 512, HEIGHT = 16, FRAMES = 32,
       FAST_FRAMES = 16, STRIPS = 96 };

#define PITCH 10.605             /* of strips, pixels: as row_thin.c's       */
#define CONTRAST 0.9
#define WALL 0.25                /* frame heights behind                     */
#define SPEED (1.0 / 16)         /* pixels a frame                           */

struct drift {
    struct hlc_shot light, sharp;
    double e[STRIPS];
    double sum;
    uint32_t n;
};

enum { RATIO, SAMPLES, WAY };    /* hls_case.arg                             */
enum { AS_ASKED, PIXEL_CENTRES, NO_FILTER };       /* of WAY                 */

static double place(int i) { return PITCH * (1 + i); }

static void add_strips(struct hls_flat *f, double width)
{
    double middle[2] = { f->width / 2.0, f->height / 2.0 };
    double a[2] = { f->width, 0 }, b[2] = { 0, f->height };
    hls_flat_piece(f, middle, a, b, WALL, 1 - CONTRAST);
    hls_flat_object(f, 0, 1);
    a[0] = width / 2;
    for (int i = 0; place(i) < f->width - PITCH; i++) {
        middle[0] = place(i);
        hls_flat_piece(f, middle, a, b, 0, 1);
    }
    hls_flat_object(f, 1, 1);
}

static struct hlc_options options(const struct hls_lab *lab,
                                  const struct hls_case *c)
{
    uint32_t width = lab->o->fast ? FAST_WIDTH : WIDTH;
    struct hlc_options o = hls_flat_options(lab, width, HEIGHT,
                                            (uint32_t)c->arg[RATIO]);
    o.samples = (uint32_t)c->arg[SAMPLES];
    if (c->arg[WAY] == PIXEL_CENTRES) {
        o.no_centroid = true;
        o.fill = HL_FILL_BILINEAR;
    }
    if (c->arg[WAY] == NO_FILTER)
        o.dsf = HL_DSF_NONE;
    return o;
}

static bool open_both(struct drift *d, struct hls_lab *lab,
                      const struct hlc_options *o)
{
    char line[HLC_PLAN_LINE];
    struct hlc_options sharp = *o;
    sharp.pipeline = HL_PIPELINE_FORWARD;
    sharp.light_width = sharp.light_height = 0;
    if (hlc_shot_open(&d->light, &lab->stage, o, NULL, NULL, line) !=
        HLC_DONE)
        return hls_broken(lab, line);
    if (hlc_shot_open(&d->sharp, &lab->stage, &sharp, NULL, NULL, line) ==
        HLC_DONE)
        return true;
    hlc_shot_close(&d->light);
    return hls_broken(lab, line);
}

/* Mean error of the strip around x, or `last` where it covers nothing. */
static double error_of(const struct hlh_picture *p, const struct hlh_picture *q,
                       double x, double width, double last)
{
    double sum = 0, cover = 0;
    uint32_t row = p->height / 2 * p->width;
    uint32_t from = (uint32_t)(x - width / 2 - 1);
    uint32_t to = (uint32_t)(x + width / 2 + 2);
    for (uint32_t i = from; i < to; i++) {
        double want = (double)q->rgb[3 * (row + i)];
        sum += (double)p->rgb[3 * (row + i)] - want;
        cover += want;
    }
    return cover > 0.01 ? sum / cover : last;
}

static void add_frame(struct drift *d, const struct hlh_picture *p,
                      const struct hlh_picture *q, double shift, double width,
                      bool first)
{
    for (int i = 0; i < STRIPS && place(i) < p->width - PITCH; i++) {
        double e = error_of(p, q, place(i) + shift, width, d->e[i]);
        if (!first) {
            d->sum += fabs(e - d->e[i]);
            d->n++;
        }
        d->e[i] = e;
    }
}

/* From -1 to 1 pixel at most: what jitter is allowed. */
static bool run(struct drift *d, struct hls_lab *lab, double width,
                double speed)
{
    uint32_t frames = lab->o->fast ? FAST_FRAMES : FRAMES;
    for (uint32_t t = 0; t < frames && t * speed < 2; t++) {
        struct hlh_picture p, q = { 0, 0, NULL, true };
        float shift = (float)(t * speed - 1);
        d->light.frame.camera.jitter[0] = shift;
        d->sharp.frame.camera.jitter[0] = shift;
        enum hl_result r = hlc_shot_draw(&d->light, NULL);
        r = r == HL_OK ? hlc_shot_read(&d->light, &p) : r;
        if (r != HL_OK)
            return hls_broken(lab, hl_result_name(r));
        r = hlc_shot_draw(&d->sharp, NULL);
        r = r == HL_OK ? hlc_shot_read(&d->sharp, &q) : r;
        if (r == HL_OK)
            add_frame(d, &p, &q, (double)shift, width, t == 0);
        hlh_picture_free(&p);
        hlh_picture_free(&q);
        if (r != HL_OK)
            return hls_broken(lab, hl_result_name(r));
    }
    return true;
}

static bool flicker(double *m, double width, double speed,
                    const struct hls_case *c, struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c);
    struct hls_flat f;
    struct drift d;
    memset(&d, 0, sizeof d);
    hls_flat_begin(&f, o.width, o.height);
    add_strips(&f, width);
    if (!hls_flat_end(&f, lab, &o) || !open_both(&d, lab, &o))
        return false;
    bool ok = run(&d, lab, width, speed);
    hlc_shot_close(&d.light);
    hlc_shot_close(&d.sharp);
    *m = d.n ? d.sum / d.n : NAN;
    return ok;
}


static bool at_width(double *m, double p, const struct hls_case *c,
                     struct hls_lab *lab)
{
    return flicker(m, p, SPEED, c, lab);
}

static bool at_speed(double *m, double p, const struct hls_case *c,
                     struct hls_lab *lab)
{
    return flicker(m, 1.25, p, c, lab);
}

static const struct hls_case widths[] = {
    { "half", "L-buffer 1/2", 0.75, 4, 0.002, true, 1.9, 2.04,
      "1 / ratio = 2", { 4, 1, AS_ASKED } },
    { "five_eighths", "L-buffer 5/8", 0.75, 4, 0.002, true, 1.52, 1.64,
      "1 / ratio = 1.6", { 5, 1, AS_ASKED } },
    { "centroids", "L-buffer 5/8, 4 samples", 0.75, 4, 0.002, true, 1.5, 1.64,
      "1 / ratio = 1.6", { 5, 4, AS_ASKED } },
    { "pixel_centres", "the same at pixel centres, published fill", 0.75, 4,
      0.002, true, NAN, NAN, "light from beside the strip at any width",
      { 5, 4, PIXEL_CENTRES } },
    { "no_filter", "L-buffer 5/8, bilinear", 0.75, 4, 0.002, true, NAN, NAN,
      "edges are mixed at any width", { 5, 1, NO_FILTER } },
};

const struct hls_row hls_row_motion = {
    "motion", "What is thinner than an L-buffer texel flickers as it moves",
    "2, K 3", "width", "pixels", "flicker F at 1/16 pixel a frame",
    HLS_LOG, widths, sizeof widths / sizeof *widths, NULL, NULL, at_width
};

static const struct hls_case speeds[] = {
    { "five_eighths", "L-buffer 5/8, a strip of 1.25 pixels", 1.0 / 64, 0.25,
      0.0703125, false, 0.0562, 0.0688, "F = 2 C v r = 0.0703 at 1/16",
      { 5, 1, AS_ASKED } },
    { "half", "L-buffer 1/2, a strip of 1.25 pixels", 1.0 / 64, 0.25,
      0.05625, false, 0.0562, 0.0688, "F = 2 C v r = 0.0563 at 1/16",
      { 4, 1, AS_ASKED } },
};

const struct hls_row hls_row_speed = {
    "speed", "Flicker grows with speed, not with thinness", "2, K 3", "speed",
    "pixels a frame", "flicker F", HLS_LOG, speeds,
    sizeof speeds / sizeof *speeds, NULL, NULL, at_speed
};
