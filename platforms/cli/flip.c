/* SPDX-License-Identifier: Zlib */
/* FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild,
 * "FLIP: A Difference Evaluator for Alternating Images", 2020; written from
 * its formulas, for standard dynamic range: the pictures are clamped to 0..1.
 * Names in comments are the paper's. */
#include <math.h>
#include <stdlib.h>
#include "platforms/cli/filter.h"
#include "platforms/cli/metrics.h"

#define PI 3.14159265358979323846
/* Pixels a degree of view: 3840 px on 0.7 m, seen from 0.7 m. */
#define PPD (0.7 * (3840 / 0.7) * PI / 180.0)
#define QC 0.7               /* exponent of the colour difference            */
#define PC 0.4               /* share of the largest one that maps to PT     */
#define PT 0.95
#define QF 0.5               /* exponent of the feature difference           */
#define FEATURE_DEGREES 0.082 /* width of the edge and point detectors      */

enum { BAND = 32 };          /* output rows made at a time                   */

/* ---- colour spaces ------------------------------------------------------ */

struct spaces {
    double to_xyz[9], from_xyz[9]; /* of linear RGB, row by row              */
    double white[3];
    double cmax;             /* Hunt-adjusted HyAB of green to blue, ^QC     */
};

static void apply(double out[3], const double m[9], const double v[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
}

static void invert(double out[9], const double m[9])
{
    double det = 0;
    for (int i = 0; i < 9; i++) {
        int r = (i % 3 + 1) % 3, s = (i % 3 + 2) % 3;
        int c = (i / 3 + 1) % 3, d = (i / 3 + 2) % 3;
        out[i] = m[3 * r + c] * m[3 * s + d] - m[3 * r + d] * m[3 * s + c];
    }
    for (int i = 0; i < 3; i++)
        det += m[i] * out[3 * i];
    for (int i = 0; i < 9; i++)
        out[i] /= det;
}

static double lab_curve(double t)
{
    const double d = 6.0 / 29.0;
    return t > d * d * d ? cbrt(t) : t / (3 * d * d) + 4.0 / 29.0;
}

/* Linear RGB to L*a*b*, a and b scaled by 0.01 L (the Hunt effect). */
static void rgb_to_hunt(double lab[3], const struct spaces *s,
                        const double rgb[3])
{
    double xyz[3];
    apply(xyz, s->to_xyz, rgb);
    double x = lab_curve(xyz[0] / s->white[0]);
    double y = lab_curve(xyz[1] / s->white[1]);
    double z = lab_curve(xyz[2] / s->white[2]);
    lab[0] = 116.0 * y - 16.0;
    lab[1] = 0.01 * lab[0] * 500.0 * (x - y);
    lab[2] = 0.01 * lab[0] * 200.0 * (y - z);
}

static double color_distance(const double a[3], const double b[3])
{
    double da = a[1] - b[1], db = a[2] - b[2];
    return pow(fabs(a[0] - b[0]) + sqrt(da * da + db * db), QC);
}

static void make_spaces(struct spaces *s)
{
    /* BT.709 primaries (x, y) scaled so that they sum to D65, (0.3127,
     * 0.3290) at Y = 1. */
    static const double at[4][2] = { { 0.64, 0.33 }, { 0.30, 0.60 },
                                     { 0.15, 0.06 }, { 0.3127, 0.3290 } };
    double column[9], inverse[9], scale[3];
    for (int i = 0; i < 3; i++) {
        double x = at[3][0], y = at[3][1];
        column[i] = at[i][0] / at[i][1];
        column[3 + i] = 1.0;
        column[6 + i] = (1.0 - at[i][0] - at[i][1]) / at[i][1];
        s->white[i] = i == 0 ? x / y : i == 1 ? 1.0 : (1.0 - x - y) / y;
    }
    invert(inverse, column);
    apply(scale, inverse, s->white);
    for (int i = 0; i < 9; i++)
        s->to_xyz[i] = column[i] * scale[i % 3];
    invert(s->from_xyz, s->to_xyz);
    const double green[3] = { 0, 1, 0 }, blue[3] = { 0, 0, 1 };
    double g[3], b[3];
    rgb_to_hunt(g, s, green);
    rgb_to_hunt(b, s, blue);
    s->cmax = color_distance(g, b);
}

/* YCxCz is L*a*b* without its curve, so that filtering it is physical. */
static void rgb_to_ycc(double ycc[3], const struct spaces *s,
                       const double rgb[3])
{
    double xyz[3];
    apply(xyz, s->to_xyz, rgb);
    double x = xyz[0] / s->white[0], y = xyz[1] / s->white[1];
    ycc[0] = 116.0 * y - 16.0;
    ycc[1] = 500.0 * (x - y);
    ycc[2] = 200.0 * (y - xyz[2] / s->white[2]);
}

static double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

static void ycc_to_hunt(double lab[3], const struct spaces *s,
                        const double ycc[3])
{
    double y = (ycc[0] + 16.0) / 116.0, rgb[3];
    double xyz[3] = { (ycc[1] / 500.0 + y) * s->white[0], y * s->white[1],
                      (y - ycc[2] / 200.0) * s->white[2] };
    apply(rgb, s->from_xyz, xyz);
    for (int c = 0; c < 3; c++)
        rgb[c] = clamp01(rgb[c]);
    rgb_to_hunt(lab, s, rgb);
}

/* ---- filters ------------------------------------------------------------ */

struct filters {
    int radius;              /* of the colour filters, the largest           */
    struct hlc_taps csf[4];  /* Y, Cx, and Cz's two                          */
    double mix[2];           /* of Cz's two, sum 1                           */
    struct hlc_taps smooth, edge, point;
};

/* Weights above zero sum to 1 and those below to -1, as the paper scales
 * its detectors. The sign depends on x alone, so this is the 2-D scaling. */
static void balance(struct hlc_taps *t)
{
    double up = 0, down = 0;
    for (int i = 0; i <= 2 * t->radius; i++) {
        up += t->tap[i] > 0 ? t->tap[i] : 0;
        down -= t->tap[i] < 0 ? t->tap[i] : 0;
    }
    for (int i = 0; i <= 2 * t->radius; i++)
        t->tap[i] /= t->tap[i] > 0 ? up : down;
}

/* First and second derivatives of a Gaussian. */
static void make_detectors(struct filters *f)
{
    double sd = 0.5 * FEATURE_DEGREES * PPD, rate = 1.0 / (2.0 * sd * sd);
    int r = (int)ceil(3.0 * sd);
    f->smooth = f->edge = f->point = hlc_taps_gauss(r, rate);
    for (int i = -r; i <= r; i++) {
        f->edge.tap[r + i] *= -(double)i;
        f->point.tap[r + i] *= (double)i * i / (sd * sd) - 1.0;
    }
    balance(&f->edge);
    balance(&f->point);
}

/* Contrast sensitivity, g(x) = sum a sqrt(pi / b) exp(-pi^2 x^2 / b), x in
 * degrees; table 1 of the paper. A 2-D Gaussian is a product of two. */
static void make_filters(struct filters *f)
{
    static const double a[4] = { 1.0, 1.0, 34.1, 13.5 };
    static const double b[4] = { 0.0047, 0.0053, 0.04, 0.025 };
    double weight[2];
    f->radius = (int)ceil(3.0 * sqrt(b[2] / (2.0 * PI * PI)) * PPD);
    for (int i = 0; i < 4; i++) {
        double rate = PI * PI / (b[i] * PPD * PPD), sum = 0;
        f->csf[i] = hlc_taps_gauss(f->radius, rate);
        for (int x = -f->radius; x <= f->radius; x++)
            sum += exp(-rate * x * x);
        if (i >= 2)
            weight[i - 2] = a[i] * sqrt(PI / b[i]) * sum * sum;
    }
    f->mix[0] = weight[0] / (weight[0] + weight[1]);
    f->mix[1] = 1.0 - f->mix[0];
    make_detectors(f);
}

/* ---- bands -------------------------------------------------------------- */

struct seen {                /* of one picture, BAND rows                    */
    double *lab[3];
    double *edge, *point;    /* lengths of the detectors' gradients          */
};

struct work {
    struct spaces spaces;
    struct filters filters;
    size_t width, height;
    struct seen test, reference;
    double *ycc[3], *across; /* BAND + 2 radius rows                         */
    double *spare;           /* BAND rows                                    */
    double *line;            /* width + 2 radius                             */
    double *memory;
};

static bool make_work(struct work *w, size_t width, size_t height)
{
    make_spaces(&w->spaces);
    make_filters(&w->filters);
    w->width = width;
    w->height = height;
    size_t r = (size_t)w->filters.radius;
    size_t rows = BAND * width, tall = (BAND + 2 * r) * width;
    w->memory = malloc((11 * rows + 4 * tall + width + 2 * r) *
                       sizeof *w->memory);
    if (!w->memory)
        return false;
    double *p = w->memory;
    double **plane[11] = {
        &w->test.lab[0], &w->test.lab[1], &w->test.lab[2], &w->test.edge,
        &w->test.point, &w->reference.lab[0], &w->reference.lab[1],
        &w->reference.lab[2], &w->reference.edge, &w->reference.point,
        &w->spare };
    for (int i = 0; i < 11; i++, p += rows)
        *plane[i] = p;
    for (int i = 0; i < 3; i++, p += tall)
        w->ycc[i] = p;
    w->across = p;
    w->line = p + tall;
    return true;
}

/* Rows first - radius to first + rows + radius; those beyond the picture
 * repeat its first or last. */
static void load_band(struct work *w, const struct hlh_picture *picture,
                      size_t first, size_t rows)
{
    size_t r = (size_t)w->filters.radius;
    for (size_t i = 0; i < rows + 2 * r; i++) {
        size_t y = first + i < r ? 0 : first + i - r;
        const float *from;
        y = y < w->height ? y : w->height - 1;
        from = picture->rgb + y * w->width * 3;
        for (size_t x = 0; x < w->width; x++) {
            double rgb[3], ycc[3];
            for (size_t c = 0; c < 3; c++)
                rgb[c] = clamp01((double)from[3 * x + c]);
            rgb_to_ycc(ycc, &w->spaces, rgb);
            for (size_t c = 0; c < 3; c++)
                w->ycc[c][i * w->width + x] = ycc[c];
        }
    }
}

/* Filter plane src of the band along rows by one, then down columns by the
 * other; both reach no farther than the band's margin. */
static void filter(double *dst, struct work *w, const double *src, size_t rows,
                   const struct hlc_taps *along, const struct hlc_taps *down)
{
    size_t margin = (size_t)(w->filters.radius - down->radius);
    size_t tall = rows + 2 * (size_t)down->radius;
    hlc_filter_rows(w->across, src + margin * w->width, w->width, tall, along,
                    w->line);
    hlc_filter_columns(dst, w->across, w->width, rows, down);
}

static void see_color(struct work *w, struct seen *s, size_t rows)
{
    const struct filters *f = &w->filters;
    size_t n = rows * w->width;
    for (int c = 0; c < 3; c++)
        filter(s->lab[c], w, w->ycc[c], rows, &f->csf[c], &f->csf[c]);
    filter(w->spare, w, w->ycc[2], rows, &f->csf[3], &f->csf[3]);
    for (size_t i = 0; i < n; i++) {
        double lab[3], ycc[3] = { s->lab[0][i], s->lab[1][i],
            f->mix[0] * s->lab[2][i] + f->mix[1] * w->spare[i] };
        ycc_to_hunt(lab, &w->spaces, ycc);
        for (int c = 0; c < 3; c++)
            s->lab[c][i] = lab[c];
    }
}

/* Length of the detector's answers along x and y, on Y scaled to 0..1; its
 * offset of 16 falls out, as the taps sum to nothing. */
static void see_feature(struct work *w, double *out, size_t rows,
                        const struct hlc_taps *detector)
{
    const struct hlc_taps *smooth = &w->filters.smooth;
    size_t n = rows * w->width;
    filter(out, w, w->ycc[0], rows, detector, smooth);
    filter(w->spare, w, w->ycc[0], rows, smooth, detector);
    for (size_t i = 0; i < n; i++)
        out[i] = sqrt(out[i] * out[i] + w->spare[i] * w->spare[i]) / 116.0;
}

static void see(struct work *w, struct seen *s,
                const struct hlh_picture *picture, size_t first, size_t rows)
{
    load_band(w, picture, first, rows);
    see_color(w, s, rows);
    see_feature(w, s->edge, rows, &w->filters.edge);
    see_feature(w, s->point, rows, &w->filters.point);
}

/* Small differences up to PC cmax take the range up to PT. */
static double remap(double d, double cmax)
{
    double knee = PC * cmax;
    return d < knee ? d * PT / knee
                    : PT + (d - knee) / (cmax - knee) * (1.0 - PT);
}

static double differ(const struct work *w, size_t i)
{
    const struct seen *t = &w->test, *r = &w->reference;
    double a[3] = { t->lab[0][i], t->lab[1][i], t->lab[2][i] };
    double b[3] = { r->lab[0][i], r->lab[1][i], r->lab[2][i] };
    double color = remap(color_distance(a, b), w->spaces.cmax);
    double edge = fabs(t->edge[i] - r->edge[i]);
    double point = fabs(t->point[i] - r->point[i]);
    double feature = pow((edge > point ? edge : point) / sqrt(2.0), QF);
    return pow(color, 1.0 - feature);
}

bool hlc_flip_map(float *map, const struct hlh_picture *test,
                  const struct hlh_picture *reference)
{
    struct work w;
    if (!make_work(&w, reference->width, reference->height))
        return false;
    for (size_t y = 0; y < w.height; y += BAND) {
        size_t rows = w.height - y < BAND ? w.height - y : BAND;
        see(&w, &w.test, test, y, rows);
        see(&w, &w.reference, reference, y, rows);
        for (size_t i = 0; i < rows * w.width; i++)
            map[y * w.width + i] = (float)differ(&w, i);
    }
    free(w.memory);
    return true;
}
