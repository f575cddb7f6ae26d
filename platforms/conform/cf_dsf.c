/* SPDX-License-Identifier: Zlib */
/* The discontinuity-sensitive filter's thresholds (spec/conformance b2) on
 * depths that the profile's storage really keeps, and its weights (b6). */
#include <string.h>
#include "platforms/conform/cf.h"

#define PI 3.14159265358979323846

enum { SIDE = 256, N = SIDE * SIDE };

struct bench {
    struct cf *cf;
    const struct cf_group *group;
    struct cf_store store;
    hl_tex in, depth, stored, out;
    double far, q;               /* metres; q = a step of stored depth       */
};

static bool begin(struct bench *b)
{
    struct cf *cf = b->cf;
    memset(cf->in, 0, CF_PIXELS * sizeof *cf->in);
    b->far = 1000;
    b->q = b->far / b->store.steps;
    return cf_make_all(cf, &b->store, SIDE, &b->in, &b->stored, &b->out) &&
           cf_input(cf, &b->depth, SIDE, SIDE);
}

static void end(struct bench *b)
{
    cf_drop(b->cf, &b->depth);
    cf_drop_all(b->cf, &b->in, &b->stored, &b->out);
}

/* cf->in: z, id, slope, tap's z. Stores the taps, filters; tau 0: by slope. */
static bool filter(struct bench *b, float tau)
{
    struct cf *cf = b->cf;
    struct cf_op o;
    float (*tap)[4] = cf->out;
    for (uint32_t i = 0; i < N; i++) {
        tap[i][0] = cf->in[i][3];
        tap[i][1] = cf->in[i][1];
        tap[i][2] = tap[i][3] = 0;
        cf->in[i][3] = 1;        /* texels between pixel and tap             */
    }
    memset(&o, 0, sizeof o);
    o.op = HL_OP_DSF;
    o.two16 = b->store.two16;
    o.a = hl_v4((float)b->far, (float)b->store.steps, 0, 0);
    o.b = hl_v4(tau, (float)b->q, 1.5f, 0.001f);
    o.c = hl_v4(1.0f / b->store.scale, 0, 0, 0);
    o.in = b->in;
    o.stored = b->stored;
    o.target = b->out;
    return cf_write(cf, b->depth, tap) && cf_write(cf, b->in, cf->in) &&
           cf_encode(cf, &b->store, HL_OP_DEPTH_ENCODE,
                     hl_v4((float)(1 / b->far), (float)(1 / b->store.steps),
                           0, 0), b->depth, b->stored) &&
           cf_draw(cf, &o) && cf_read(cf, b->out);
}

static void texel(struct cf *cf, uint32_t i, double z, double slope,
                  double tap)
{
    cf->in[i][0] = (float)z;
    cf->in[i][1] = 7;
    cf->in[i][2] = (float)slope;
    cf->in[i][3] = (float)tap;
}

/* Size of an L-buffer texel at distance 1: vertical field of view 60. */
static double texel_size(int lines) { return 2 * tan(PI / 6) / lines; }

/* ---- the angle from which a constant threshold rejects ------------------ */

enum { TAUS = 8, ANGLES = 8192 };
static const int heights[3] = { 225, 450, 720 };
static const double taus[TAUS] = { .0005, .001, .002, .005, .01, .02, .05,
                                   .1 };
static const double table_angle[3][TAUS] = {
    { 5.6, 11.0, 21.3, 44.1, 62.6, 75.3, 83.9, 86.8 },
    { 11.0, 21.3, 37.9, 62.7, 75.5, 82.5, 86.9, 88.4 },
    { 17.3, 31.9, 51.2, 72.1, 80.8, 85.3, 88.1, 89.0 },
};

/* Depth one texel on: a plane tilted by `angle` at depth z. Past the horizon
 * there is nothing nearer than far. */
static double next_depth(double z, double p, double angle, double far)
{
    double t = p * tan(angle);
    double next = t < 1 ? z / (1 - t) : far;
    return next < far ? next : far;
}

/* Largest angle below which all are accepted, degrees. */
static double measure_angle(struct bench *b, double p, double tau)
{
    const double z = 500;
    for (uint32_t i = 0; i < N; i++)
        if (i < ANGLES)
            texel(b->cf, i, z, 0, next_depth(z, p, (double)i / ANGLES *
                                             PI / 2, b->far));
        else
            memcpy(b->cf->in[i], b->cf->in[i - ANGLES], sizeof b->cf->in[i]);
    if (!filter(b, (float)tau))
        return (double)NAN;
    for (uint32_t i = 0; i < ANGLES; i++)
        if (b->cf->out[i][0] != 1.0f)
            return (double)i / ANGLES * 90;
    return 90;
}

static void angles(struct bench *b, int k)
{
    static const char *const name[] = { "angle_225", "angle_450",
                                        "angle_720" };
    struct hl_conform_result r = cf_result(
        HL_CONFORM_TOLERANCE, "degrees", 0.5,
        "measured false-rejection angle of tau = 0.05 to 10 %, from "
        "atan(tau / (p (1 + tau))) and from the table; half a step of depth "
        "is worth up to 0.2");
    for (int t = 0; t < TAUS; t++) {
        double p = texel_size(heights[k]), tau = taus[t];
        double want = atan(tau / (p * (1 + tau))) / PI * 180;
        double got = measure_angle(b, p, tau);
        double a = fabs(got - want), c = fabs(got - table_angle[k][t]);
        cf_case_at(&r, a > c ? a : c, tau, got);
    }
    r.where = "tau, angle";
    r.n_at = 2;
    r.cases = TAUS * ANGLES;
    cf_report(b->cf, b->group, name[k], &r);
}

/* ---- slopes ------------------------------------------------------------- */

/* A plane through a pixel, depth z there: z / (1 - t (u cos + v sin)) at
 * (u, v) texels from it. */
struct plane { double z, t, cos, sin; };

static double plane_at(const struct plane *s, double u, double v)
{
    double d = 1 - s->t * (u * s->cos + v * s->sin);
    return s->z / d;
}

/* Differences over a pixel of a quad, either way, as the stage takes them:
 * 1 / ratio pixels are a texel. */
static double slope_of(struct cf *cf, const struct plane *s)
{
    const double ratio = 0.625;
    double x = cf_random(cf) & 1 ? ratio : -ratio;
    double y = cf_random(cf) & 1 ? ratio : -ratio;
    return (fabs(plane_at(s, x, 0) - s->z) +
            fabs(plane_at(s, 0, y) - s->z)) / ratio;
}

static void slopes(struct bench *b, int k)
{
    static const char *const name[] = { "slope_225", "slope_450",
                                        "slope_720" };
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "taps", 0,
        "q + 1.5 slope + 0.001 z rejects no tap of its own plane, tilted by "
        "up to 88 degrees, at most a texel away on either axis");
    uint32_t n = cf->desc->quick ? 1 : 4;
    for (uint32_t turn = 0; turn < n; turn++) {
        for (uint32_t i = 0; i < N; i++) {
            double phi = 2 * PI * cf_unit(cf);
            double angle = (1 - cf_unit(cf) * cf_unit(cf)) * 88 / 180 * PI;
            struct plane s = { 1 + 600 * cf_unit(cf),
                               texel_size(heights[k]) * tan(angle),
                               cos(phi), sin(phi) };
            double u = 2 * cf_unit(cf) - 1, v = 2 * cf_unit(cf) - 1;
            texel(cf, i, s.z, slope_of(cf, &s), plane_at(&s, u, v));
        }
        if (!filter(b, 0))
            break;
        for (uint32_t i = 0; i < N; i++) {
            r.cases++;
            r.worst += cf->out[i][0] == 1.0f ? 0 : 1;
        }
    }
    cf_report(cf, b->group, name[k], &r);
}

/* ---- leaks -------------------------------------------------------------- */

/* Two parallel planes under one id, the gap between them swept: the last
 * accepted gap against the threshold. */
static void leak(struct bench *b, const char *name, float tau)
{
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_TOLERANCE, "steps of depth", 1,
        "the largest gap that leaks is the threshold to one step of stored "
        "depth");
    const double depths[] = { 3, 10, 40, 150, 400, 800 };
    enum { DEPTHS = sizeof depths / sizeof depths[0], ROW = 8192 };
    double threshold[DEPTHS], last[DEPTHS];
    for (int d = 0; d < DEPTHS; d++) {
        threshold[d] = tau > 0 ? (double)tau * depths[d]
                               : b->q + 0.001 * depths[d];
        last[d] = 0;
    }
    for (uint32_t i = 0; i < N; i++) {
        int d = (int)(i / ROW % DEPTHS);
        double gap = 2 * threshold[d] * (i % ROW) / ROW;
        texel(cf, i, depths[d], 0, depths[d] + gap);
    }
    if (filter(b, tau))
        for (uint32_t i = 0; i < DEPTHS * ROW; i++) {
            int d = (int)(i / ROW);
            double gap = 2 * threshold[d] * (i % ROW) / ROW;
            if (cf->out[i][0] == 1.0f)
                last[d] = gap > last[d] ? gap : last[d];
        }
    for (int d = 0; d < DEPTHS && !cf->broken; d++)
        cf_case_at(&r, fabs(last[d] - threshold[d]) / b->q, depths[d],
                   last[d]);
    r.where = "z, gap";
    r.n_at = 2;
    r.cases *= ROW;
    cf_report(cf, b->group, name, &r);
}

const char *cf_dsf(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    memset(&b, 0, sizeof b);
    b.cf = cf;
    b.group = g;
    const char *why = cf_store(cf, cf_profile_store(cf), &b.store);
    if (why)
        return why;
    if (begin(&b)) {
        for (int k = 0; k < 3; k++)
            angles(&b, k);
        for (int k = 0; k < 3; k++)
            slopes(&b, k);
        leak(&b, "leak_constant", 0.01f);
        leak(&b, "leak_slope", 0);
    }
    end(&b);
    return NULL;
}

/* ---- weights ------------------------------------------------------------ */

static bool weigh(struct cf *cf)
{
    hl_tex in = { 0 }, out = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (uint32_t i = 0; i < N; i++) {
        bool edge = i % 4 == 0;
        cf->in[i][0] = edge ? (float)(i / 4 % 5) / 4 : (float)cf_unit(cf);
        cf->in[i][1] = edge ? (float)(i / 20 % 5) / 4 : (float)cf_unit(cf);
        cf->in[i][2] = (float)(i / 128 % 16);
        cf->in[i][3] = 0;
    }
    bool ok = cf_input(cf, &in, SIDE, SIDE) &&
              cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL,
                     SIDE, SIDE);
    o.op = HL_OP_WEIGHTS;
    o.in = in;
    o.target = out;
    ok = ok && cf_draw(cf, &o) && cf_read(cf, out);
    cf_drop(cf, &in);
    cf_drop(cf, &out);
    return ok;
}

/* Distance of the four weights from bilinear ones, in units of the last
 * place of 1. */
static double from_bilinear(const float in[4], const float w[4])
{
    double x = (double)in[0], y = (double)in[1], e = 0;
    double want[4] = { (1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y };
    for (int k = 0; k < 4; k++)
        e = fmax(e, fabs((double)w[k] - want[k]));
    return ldexp(e, 23);
}

const char *cf_weights(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result sum = cf_result(
        HL_CONFORM_TOLERANCE, "", ldexp(1, -22),
        "renormalised weights sum to 1: a quotient, four products, 2 units "
        "in the last place");
    struct hl_conform_result all = cf_result(
        HL_CONFORM_TOLERANCE, "ulp of 1", 2,
        "four accepted taps weigh as bilinear ones: one rounding of each, "
        "and one of the quotient by a sum near 1");
    struct hl_conform_result none = cf_result(
        HL_CONFORM_TOLERANCE, "ulp of 1", 1,
        "no accepted tap: bilinear weights");
    struct hl_conform_result nearest = cf_result(
        HL_CONFORM_EXACT, "", 0,
        "on a texel centre, its tap accepted: it alone, exactly");
    struct hl_conform_result rejected = cf_result(
        HL_CONFORM_EXACT, "", 0,
        "a rejected tap among accepted ones weighs nothing, exactly");
    bool ok = weigh(cf);
    for (uint32_t i = 0; ok && i < N; i++) {
        const float *in = cf->in[i], *w = cf->out[i];
        int bits = (int)in[2];
        double s = (double)w[0] + (double)w[1] + (double)w[2] +
                   (double)w[3];
        cf_case_at(&sum, fabs(s - 1), (double)in[0], (double)in[1]);
        if (bits == 15)
            cf_case(&all, from_bilinear(in, w));
        if (bits == 0)
            cf_case(&none, from_bilinear(in, w));
        if (in[0] == 0.0f && in[1] == 0.0f && bits & 1)
            cf_case(&nearest, fabs((double)w[0] - 1) +
                              fabs((double)w[1]) + fabs((double)w[2]));
        for (int k = 0; bits && k < 4; k++)
            if (!(bits >> k & 1))
                cf_case(&rejected, fabs((double)w[k]));
    }
    sum.where = "fraction";
    sum.n_at = 2;
    cf_report(cf, g, "sum", &sum);
    cf_report(cf, g, "bilinear", &all);
    cf_report(cf, g, "none_accepted", &none);
    cf_report(cf, g, "nearest", &nearest);
    cf_report(cf, g, "rejected", &rejected);
    return NULL;
}
