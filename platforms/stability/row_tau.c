/* SPDX-License-Identifier: Zlib */
/* The filter's threshold on depth, by what it rejects: of a tilted plane its
 * own taps (too small), of two planes under one id none of the other's (too
 * large), and of a plane whose depth is stored coarsely its own again. */
#include <math.h>
#include <stdlib.h>
#include "platforms/stability/flat.h"

#define PI 3.14159265358979323846
#define DEPTH 10.0               /* of what is looked at, metres             */

enum { TAU, HEIGHT };            /* hls_case.arg: constant threshold, 0 = as
                                  * asked; L texels of a view of 60 degrees  */

static struct hlh_v3 v3(double x, double y, double z)
{
    return hlh_v3(x, y, z);
}

/* A camera at the origin that looks along -z with `step` a texel of `texels`
 * a picture's height. */
static void begin(struct hls_flat *f, const struct hlc_options *o, double step)
{
    hls_flat_begin(f, o->width, o->height);
    f->scene.camera.eye[2] = 0;
    f->scene.camera.target[2] = -1;
    f->scene.camera.vfov =
        (float)(2 * atan(step * o->light_height / 2) * 180 / PI);
}

static struct hlc_options options(const struct hls_lab *lab,
                                  const struct hls_case *c, uint32_t width,
                                  uint32_t height)
{
    struct hlc_options o = hls_flat_options(lab, width, height, 5);
    if (c->arg[TAU] > 0) {
        o.dsf = HL_DSF_CONSTANT_TAU;
        o.dsf_tau = c->arg[TAU];
    }
    return o;
}

static bool rejects(uint8_t **out, struct hls_flat *f, struct hls_lab *lab,
                    const struct hlc_options *o)
{
    void *taps = NULL;
    hls_flat_object(f, 1, 1);
    bool ok = hls_flat_end(f, lab, o) &&
              hls_flat_inspect(&taps, HL_INSPECT_REJECTS, lab, o);
    *out = taps;
    return ok;
}

static bool open(struct hls_lab *lab, const struct hls_case *c,
                 const char **skip)
{
    (void)c;
    if (lab->o->dsf == HL_DSF_NONE)
        *skip = "no filter, nothing is rejected";
    return true;
}

/* ---- tilt ---------------------------------------------------------------- */

/* Rows and columns, and L texels: both odd, so that the middle pixel lies on a
 * texel's middle and its other tap a whole texel from it. */
enum { SIDE = 35, LIGHT = 21, REACH = 4 };

/* The plane through (0, 0, -DEPTH) that is farther by `way` upwards: REACH
 * texels of it, where it is DEPTH / (1 - y tan) deep. */
static void tilted(struct hls_flat *f, double step, double slope)
{
    double low = -REACH * step, high = REACH * step;
    double near = DEPTH / (1 - low * slope), far = DEPTH / (1 - high * slope);
    double wide = 2 * step * LIGHT * fmax(near, far);
    hlh_add_patch(&f->b, v3(-wide, low * near, -near), v3(2 * wide, 0, 0),
                  v3(0, high * far - low * near, near - far), 1, 1);
}

static bool tilt_share(double *m, double slope, const struct hls_case *c,
                       struct hls_lab *lab)
{
    double step = 2 * tan(PI / 6) / c->arg[HEIGHT];
    struct hlc_options o = options(lab, c, SIDE, SIDE);
    struct hls_flat f;
    uint8_t *taps;
    uint32_t n = 0, middle = SIDE / 2 * SIDE;
    o.light_width = o.light_height = LIGHT;
    begin(&f, &o, step);
    tilted(&f, step, slope);
    if (!rejects(&taps, &f, lab, &o))
        return false;
    for (uint32_t x = REACH; x < SIDE - REACH; x++)
        n += taps[middle + x] != 1;
    free(taps);
    *m = n / (double)(SIDE - 2 * REACH);
    return true;
}

/* Which of two rows the other tap is in, machines may round either way. */
static bool tilt(double *m, double p, const struct hls_case *c,
                 struct hls_lab *lab)
{
    double slope = tan(p * PI / 180), up, down;
    bool ok = tilt_share(&up, slope, c, lab) &&
              tilt_share(&down, -slope, c, lab);
    *m = ok ? fmax(up, down) : NAN;
    return ok;
}

/* alpha* = atan(tau / (p (1 + tau))), p the angle of a texel; half a degree
 * for the rounding of stored depths, and a width of bisection. */
#define TILT(name, tau, height, angle) \
    { name, "constant, H_L " #height, angle - 20, angle + 5, 0.01, false, \
      angle - 0.5, angle + 0.5 + 0.25, \
      "atan(tau / (p (1 + tau))) = " #angle " degrees", \
      { tau, height } }
#define LEVEL(name, height) \
    { name, "by slope, H_L " #height, 1, 88, 0.01, false, NAN, NAN, \
      "threshold grows with the slope: never to 88 degrees", \
      { 0, height } }

static const struct hls_case tilts[] = {
    TILT("tau_0.2_225", 0.002, 225, 21.3),
    TILT("tau_1_225", 0.01, 225, 62.6),
    TILT("tau_1_450", 0.01, 450, 75.5),
    TILT("tau_1_720", 0.01, 720, 80.8),
    TILT("tau_5_225", 0.05, 225, 83.9),
    LEVEL("slope_225", 225),
    LEVEL("slope_720", 720),
};

const struct hls_row hls_row_tilt = {
    "tilt", "A constant threshold rejects a tilted plane's own taps",
    "K 3", "tilt", "degrees", "share of pixels with a rejected tap",
    HLS_LINEAR, tilts, sizeof tilts / sizeof *tilts, open, NULL, tilt
};

/* ---- gap ----------------------------------------------------------------- */

enum { WIDE = 64, HIGH = 16 };

/* Left half at DEPTH, right half behind it, and between them a step that is
 * seen edge-on: one normal, one region. */
static void two_planes(struct hls_flat *f, double back)
{
    double s = DEPTH;
    hlh_add_patch(&f->b, v3(-3 * s, -s, -DEPTH), v3(3 * s, 0, 0),
                  v3(0, 2 * s, 0), 1, 1);
    hlh_add_patch(&f->b, v3(0, -s, -DEPTH - back), v3(3 * s, 0, 0),
                  v3(0, 2 * s, 0), 1, 1);
    hlh_add_patch(&f->b, v3(0, -s, -DEPTH), v3(0, 0, -back), v3(0, 2 * s, 0),
                  1, 1);
    for (uint32_t i = 0; i < f->b.n_vertices; i++) {
        f->b.vertices[i].normal[0] = f->b.vertices[i].normal[1] = 0;
        f->b.vertices[i].normal[2] = 1;
    }
}

/* The two columns beside the step have taps on both sides; p: a share of
 * DEPTH. */
static bool gap(double *m, double p, const struct hls_case *c,
                struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c, WIDE, HIGH);
    struct hls_flat f;
    uint8_t *taps;
    uint32_t n = 0;
    begin(&f, &o, 1.0 / HIGH);
    two_planes(&f, p * DEPTH);
    if (!rejects(&taps, &f, lab, &o))
        return false;
    for (uint32_t y = 4; y < HIGH - 4; y++)
        for (uint32_t x = WIDE / 2 - 1; x <= WIDE / 2; x++)
            n += taps[y * WIDE + x] == 1;
    free(taps);
    *m = n / (2.0 * (HIGH - 8));
    return true;
}

/* Pixels of the far plane are the first to take the near one's taps: at a gap
 * of tau of their depth, tau / (1 - tau) of the near one's. Depths of both are
 * rounded by up to q / 2, q = far / 65535 = 1.6e-5 of DEPTH; 1 % of bisection,
 * downwards. By slope: q more, of planes that are not tilted. */
static const struct hls_case gaps[] = {
    { "tau_1", "constant, 1 %", 0.1, 1e-4, 0.01, false, 0.00999, 0.01014,
      "tau / (1 - tau) = 0.0101", { 0.01 } },
    { "tau_0.1", "constant, 0.1 %", 0.1, 1e-4, 0.01, false, 0.000973, 0.00102,
      "tau / (1 - tau) = 0.001", { 0.001 } },
    { "slope", "by slope, c = 0.1 %", 0.1, 1e-4, 0.01, false, 0.000988,
      0.001034, "c + q = 0.00102", { 0 } },
};

/* ---- tau ----------------------------------------------------------------- */

#define TILT_OF 75.5             /* degrees                                  */
#define GAP_OF 0.01              /* of depth                                 */

/* p: the threshold, of the case's one surface. */
static bool tau(double *m, double p, const struct hls_case *c,
                struct hls_lab *lab)
{
    struct hls_case with = *c;
    with.arg[TAU] = p;
    return c->arg[HEIGHT] > 0 ? tilt(m, TILT_OF, &with, lab)
                              : gap(m, GAP_OF, &with, lab);
}

/* What a plane of 75.5 degrees needs at H_L 450 is what a gap of 1 % must not
 * have: no constant serves both, and by slope both hold (rows tilt and gap).
 * Half a degree is 3.6 % of the tangent. Far pixels leak first, at 1 / 1.01 of
 * the gap; both depths are rounded by q / 2, and bisection adds 1 %. */
static const struct hls_case taus[] = {
    { "kept", "rejects of a plane of 75.5 degrees, H_L 450", 1e-4, 0.1, 0.01,
      true, 0.0096, 0.0105, "p tan / (1 - p tan) = 0.01",
      { 0, 450 } },
    { "leak", "leaks over a gap of 1 %", 1e-4, 0.1, 0.01, false, 0.0098,
      0.0101, "gap / (1 + gap) = 0.0099", { 0 } },
};

const struct hls_row hls_row_tau = {
    "tau", "No constant threshold keeps tilted planes and tells near ones",
    "K 3", "threshold", "of depth", "share rejected, or leaked", HLS_LOG,
    taus, sizeof taus / sizeof *taus, open, NULL, tau
};

const struct hls_row hls_row_gap = {
    "gap", "Light leaks between surfaces of one id that are near in depth",
    "4, K 3.1", "gap", "of depth", "share of edge pixels that take both sides",
    HLS_LOG, gaps, sizeof gaps / sizeof *gaps, open, NULL, gap
};

/* ---- self ---------------------------------------------------------------- */

#define FAR 1000.0
#define STEP (FAR / 65535)       /* of stored depth                          */

/* A plane of all depths within two steps of p. */
static bool own(double *m, double p, const struct hls_case *c,
                struct hls_lab *lab)
{
    struct hlc_options o = options(lab, c, WIDE, HIGH);
    struct hls_flat f;
    uint8_t *taps;
    uint32_t n = 0, all = WIDE * HIGH;
    o.far = FAR;
    begin(&f, &o, 1.0 / HIGH);
    hlh_add_patch(&f.b, v3(-4 * p, -2 * p, -p + 2 * STEP), v3(8 * p, 0,
                  -4 * STEP), v3(0, 4 * p, 0), 1, 1);
    if (!rejects(&taps, &f, lab, &o))
        return false;
    for (uint32_t i = 0; i < all; i++)
        n += taps[i] != 1;
    free(taps);
    *m = (double)n / all;
    return true;
}

/* A stored depth is off by q / 2 = 7.6 mm at most: more than tau z nearer than
 * 7.63 m. The plane's own slope adds a sixteenth of a step a texel. */
static const struct hls_case selves[] = {
    { "tau_0.1", "constant, 0.1 %", 100, 1, 0.01, false, 7.4, 8.6,
      "q / 2 = tau z at 7.63 m", { 0.001 } },
    { "tau_1", "constant, 1 %", 100, 0.1, 0.01, false, 0.74, 0.86,
      "q / 2 = tau z at 0.763 m", { 0.01 } },
    { "slope", "by slope", 100, 0.1, 0.01, false, NAN, NAN,
      "the threshold begins at q: never", { 0 } },
};

const struct hls_row hls_row_self = {
    "self", "A threshold below the step of stored depth rejects all taps",
    "K 3", "distance", "m", "share of pixels with a rejected tap", HLS_LOG,
    selves, sizeof selves / sizeof *selves, open, NULL, own
};
