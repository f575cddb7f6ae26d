/* SPDX-License-Identifier: Zlib */
/* Bars at an angle, multisampled: mean error of the pixels that an edge
 * crosses. Either of all, against 8 x 8 rays a pixel of the reference renderer;
 * or of light alone, against forward rendering of as many samples. Either the
 * bars reflect and the wall behind them is black, or the other way round; what
 * is black has a tenth of the other's light, which must not get over. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/reference.h"
#include "platforms/stability/flat.h"

enum { SIDE = 96, FAST_SIDE = 64, BORDER = 4, GRID = 8 };

#define PITCH 11.61              /* of bars, pixels                          */
#define WIDTH 5.3                /* of a bar: three texels                   */
#define CONTRAST 0.9
#define WALL 0.25                /* frame heights behind                     */

enum { AGAINST, WAY };                             /* hls_case.arg           */
enum { RAYS, FORWARD };                            /* of AGAINST             */
enum { BARS, CENTRES, BEHIND };                    /* of WAY                 */

static void add_bars(struct hls_flat *f, bool behind)
{
    /* atan(3/10): no edge meets two pixels alike for a long way. */
    double c = 0.957826285, s = 0.287347886, reach = f->width + f->height;
    double middle[2] = { f->width / 2.0, f->height / 2.0 };
    double a[2] = { reach, 0 }, b[2] = { 0, reach };
    hls_flat_piece(f, middle, a, b, WALL, behind ? 1 : 1 - CONTRAST);
    hls_flat_object(f, behind ? 1 : 0, 1);
    int n = (int)(reach / 2 / PITCH);
    for (int i = -n; i <= n; i++) {
        double at[2] = { middle[0] + i * PITCH * c, middle[1] + i * PITCH * s };
        double u[2] = { WIDTH / 2 * c, WIDTH / 2 * s };
        double v[2] = { -reach * s, reach * c };
        hls_flat_piece(f, at, u, v, 0, behind ? 1 - CONTRAST : 1);
    }
    hls_flat_object(f, behind ? 0 : 1, 1);
}

static struct hlc_options options(const struct hls_lab *lab,
                                  const struct hls_case *c)
{
    uint32_t side = lab->o->fast ? FAST_SIDE : SIDE;
    struct hlc_options o = hls_flat_options(lab, side, side, 5);
    if (c->arg[WAY] == CENTRES) {
        o.no_centroid = true;
        o.fill = HL_FILL_BILINEAR;
    }
    return o;
}

static struct hlc_options forward(const struct hlc_options *o)
{
    struct hlc_options f = *o;
    f.pipeline = HL_PIPELINE_FORWARD;
    f.light_width = f.light_height = 0;
    return f;
}

/* The most that is not above p and that the machine has. */
static uint32_t samples(const struct hls_lab *lab, double p)
{
    for (uint32_t n = 8; n > 1; n /= 2)
        if (n <= p && lab->stage.machine.caps.samples & n)
            return n;
    return 1;
}

/* Pixels that are partly covered by the reference's rays. */
static double edge_error(const struct hlh_picture *p, const float *want,
                         const float *rays)
{
    double sum = 0;
    uint32_t n = 0;
    for (uint32_t y = BORDER; y < p->height - BORDER; y++)
        for (uint32_t x = BORDER; x < p->width - BORDER; x++) {
            size_t i = 3 * ((size_t)y * p->width + x);
            if (rays[i] < 0.01f || rays[i] > 0.99f)
                continue;
            sum += fabs((double)p->rgb[i] - (double)want[i]);
            n++;
        }
    return n ? sum / n : NAN;
}

/* Of the whole case, in lab->data: rays are dear. */
static bool cast(struct hls_lab *lab, const struct hlc_options *o)
{
    struct hlr_options r = { .width = o->width, .height = o->height,
                             .grid = GRID, .no_specular = true,
                             .threads = 1 };
    float *q = malloc((size_t)o->width * o->height * 3 * sizeof *q);
    if (q && hlr_render(q, NULL, &lab->stage.scene, &r, NULL)) {
        lab->data = q;
        return true;
    }
    free(q);
    return hls_broken(lab, "no reference picture");
}

static bool open(struct hls_lab *lab, const struct hls_case *c,
                 const char **skip)
{
    struct hlc_options o = options(lab, c);
    struct hls_flat f;
    lab->data = NULL;
    if (c->arg[WAY] == BEHIND && strcmp(lab->o->backend, "packemu")) {
        *skip = "what hidden samples do to a centroid is the machine's choice";
        return true;
    }
    hls_flat_begin(&f, o.width, o.height);
    add_bars(&f, c->arg[WAY] == BEHIND);
    return hls_flat_end(&f, lab, &o) && cast(lab, &o);
}

static void close(struct hls_lab *lab)
{
    free(lab->data);
    lab->data = NULL;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c);
    struct hlh_picture whole, light;
    o.samples = samples(lab, p);
    struct hlc_options sharp = forward(&o);
    if (!hls_flat_draw(&whole, lab, &sharp))
        return false;
    *m = edge_error(&whole, lab->data, lab->data);
    bool ok = true;
    if (c->arg[AGAINST] == FORWARD) {
        ok = hls_flat_draw(&light, lab, &o);
        *m = ok ? edge_error(&light, whole.rgb, lab->data) : NAN;
        hlh_picture_free(&light);
    }
    hlh_picture_free(&whole);
    return ok;
}

/* n samples place an edge within 1 / n of a pixel: 1 / (4 n) off in the mean,
 * and more where it runs along a row of them. Light has no error while each
 * pixel is lit where its surface is seen. At pixel centres, and where what lies
 * in front covers the centre of what lies behind, it is the neighbour's: from
 * the first second sample on; some machines have 1 and 4 alone. */
static const struct hls_case cases[] = {
    { "whole", "forward, against rays", 1, 8, 0.09, true, 4, 4,
      "1 / (4 n) below 0.09: 4", { RAYS, BARS } },
    { "centroids", "light of inferred 5/8", 1, 8, 0.0002, false, NAN, NAN,
      "lit within what is covered: never", { FORWARD, BARS } },
    { "pixel_centres", "the same at pixel centres, published fill", 1, 8,
      0.0002, false, 2, 4, "lit beside what is covered: 2",
      { FORWARD, CENTRES } },
    { "behind", "light of the wall behind the bars", 1, 8, 0.0002, false, 2, 2,
      "lit where the bar covers it: 2", { FORWARD, BEHIND } },
};

const struct hls_row hls_row_msaa = {
    "msaa", "Edges keep errors that more samples do not mend",
    "3, K 3", "samples", "a pixel", "mean error of edge pixels", HLS_WHOLE,
    cases, sizeof cases / sizeof *cases, open, close, measure
};
