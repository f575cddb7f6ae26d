/* SPDX-License-Identifier: Zlib */
/* Normals that turn away from the view axis: the mapping of Kircher and
 * Lawrance 2009, eq. 1, spreads a stored step without bound as they near
 * (0, 0, -1), where it has no value. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"
#include "shaders/shared/pack.h"

enum { SIDE = 32, CELLS = 4, FACES = CELLS * CELLS };

#define DEGREES 57.295779513082320877

struct own {
    struct hls_drawn drawn;      /* first, for hls_rig_close                 */
    struct hlc_options o;
};

/* ---- the scene ---------------------------------------------------------- */

/* Direction of face i, theta from the view axis, at a turn of its own: of
 * numbers that a float keeps, so that its angle is known. */
static struct hlh_v3 direction(int i, double theta)
{
    double s, c, st, ct;
    hlh_sincos((i + 0.37) / FACES, &s, &c);
    hlh_sincos(theta / 360, &st, &ct);
    return hlh_v3((double)(float)(st * c), (double)(float)(st * s),
                  (double)(float)ct);
}

static void tilt(struct hls_rig *rig, struct hlh_v3 n)
{
    for (uint32_t i = 0; !rig->b.failed && i < rig->b.n_vertices; i++) {
        rig->b.vertices[i].normal[0] = (float)n.x;
        rig->b.vertices[i].normal[1] = (float)n.y;
        rig->b.vertices[i].normal[2] = (float)n.z;
    }
}

/* A wall of CELLS x CELLS faces that fills the view. */
static void build(struct hls_rig *rig, double theta)
{
    double side = 2.0 / CELLS;
    hls_rig_begin(rig, 1, 90);
    for (int i = 0; i < FACES; i++) {
        hlh_add_patch(&rig->b, hlh_v3(-1 + side * (i % CELLS),
                                      -1 + side * (i / CELLS), 0),
                      hlh_v3(side, 0, 0), hlh_v3(0, side, 0), 1, 1);
        tilt(rig, direction(i, theta));
        hls_rig_object(rig, 0);
    }
    hlh_build_light(&rig->b, hlh_v3(0, 0, 1), 4, hlh_v3(1, 1, 1));
}

/* ---- the bound ---------------------------------------------------------- */

/* Worst error of a component of -1..1: half a step (conformance b1); half
 * floats hold it as 0..1, whose upper half has steps of 2^-11, and whole ones
 * where stores truncate. */
static double component(const struct hl_plan *p)
{
    const struct hl_plan_target *t = hl_plan_target(p, HL_ROLE_NORMAL);
    const struct hl_format_info *f = hl_format_info(t->format);
    if (f->kind == HL_KIND_FLOAT)
        return f->bits[0] == 16 ? 1.0 / 1024 : 1.0 / 8388608;
    if (p->two16 == HL_TWO16_UNORM && f->kind == HL_KIND_UNORM &&
        f->bits[0] == 8)
        return 1.0 / 255;
    return p->two16 == HL_TWO16_SIGNED || p->two16 == HL_TWO16_FIXED32
           ? 1.0 / 65534 : 1.0 / 65535;
}

/* Degrees: a displacement of sqrt 2 h beside r = sin(theta / 2), in and out;
 * eq. 1 in 32-bit floats adds 0.07 within a degree of the pole, where 1 + n.z
 * keeps few digits (conformance b1), and 1e-3 elsewhere, as 2^-24 in n.z is
 * 2^-24 / (1 + n.z) of it, 4e-4 of the 0.5 degrees that are left at 179. */
static double bound(double h, double theta)
{
    double s, c, d = sqrt(2.0) * h;
    hlh_sincos(theta / 720, &s, &c);
    double out = 2 * (asin(fmin(1, s + d)) - asin(s));
    double in = 2 * (asin(s) - asin(s - d));
    return fmax(out, in) * DEGREES + (theta > 179 ? 0.07 : 1e-3);
}

static double angle(struct hlh_v3 a, hl_vec3 b)
{
    double x = a.y * (double)b.z - a.z * (double)b.y;
    double y = a.z * (double)b.x - a.x * (double)b.z;
    double z = a.x * (double)b.y - a.y * (double)b.x;
    return DEGREES * atan2(sqrt(x * x + y * y + z * z),
                           a.x * (double)b.x + a.y * (double)b.y +
                           a.z * (double)b.z);
}

/* Largest error, degrees; NAN where a number is none. */
static double worst(const struct hlc_texels *t, uint32_t two16, double theta)
{
    double most = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        uint32_t x = i % SIDE * CELLS / SIDE;
        uint32_t y = CELLS - 1 - i / SIDE * CELLS / SIDE;
        float v[4], pair[2];
        hlc_texel(v, t, i);
        hlc_two16(pair, two16, v);
        hl_vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(pair[0]),
                                           hl_unorm_to_snorm(pair[1])));
        double e = angle(direction((int)(y * CELLS + x), theta), n);
        if (isnan(e))
            return NAN;
        most = fmax(most, e);
    }
    return most;
}

/* ---- the row ------------------------------------------------------------ */

/* arg: format of the normals. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct own *w = lab->data = calloc(1, sizeof *w);
    if (!w)
        return hls_rig_fail("normals", HL_ERR_MEMORY);
    hls_rig_options(&w->o, lab, SIDE, SIDE);
    w->o.normal_format = (enum hl_format)c->arg[0];
    build(&rig, c->from);
    if (!hls_rig_end(&rig, lab, &w->o))
        return false;
    w->drawn.made = hlc_shot_open(&w->drawn.shot, &lab->stage, &w->o, NULL,
                                  NULL, NULL) == HLC_DONE;
    if (!w->drawn.made)
        *skip = "the normals' format cannot be had on this machine";
    return true;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    struct hls_rig rig;
    struct hlc_texels t;
    (void)c;
    build(&rig, p);
    if (!hls_rig_swap(&w->drawn.shot, &rig, &w->o) ||
        !hls_rig_texels(&t, &w->drawn.shot, HL_ROLE_NORMAL))
        return false;
    *m = worst(&t, w->drawn.shot.plan.two16, p) /
         bound(component(&w->drawn.shot.plan), p);
    hlc_texels_free(&t);
    return true;
}

#define NEVER 1, false, NAN, NAN, "none: the bound of b1"

/* pack.h: within 1e-6 radians of the pole, 5.73e-5 degrees, what is stored is
 * (0, 0, 1), 180 degrees off. */
static const struct hls_case cases[] = {
    { "planned", "the planner's format", 170, 179.999, NEVER, { 0 } },
    { "half", "RG16F", 170, 179.999, NEVER, { HL_FORMAT_RG16_FLOAT } },
    { "eight", "RG8", 170, 179.999, NEVER, { HL_FORMAT_RG8_UNORM } },
    { "front", "the planner's format, front half", 1, 170, NEVER, { 0 } },
    { "pole", "the planner's format, at the pole", 179.999, 180, 1, false,
      180 - 7.5e-5, 180, "180 - 5.7e-5: |n + z| = 1e-6 (pack.h)", { 0 } },
};

const struct hls_row hls_row_normals = {
    "normals", "A normal that turns away from the view axis is stored coarsely",
    "conformance b1; 60 (Kircher, Lawrance 2009, eq. 1)",
    "angle from the view axis", "degrees", "error of its bound", HLS_LINEAR,
    cases, sizeof cases / sizeof *cases, begin, hls_rig_close, measure
};
