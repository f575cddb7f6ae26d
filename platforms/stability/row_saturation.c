/* SPDX-License-Identifier: Zlib */
/* Light above what an L-buffer of fixed range holds is cut, and light below
 * half a step of it is nothing. The planner's range is a bound of the summed
 * light, so that nothing is cut; what that costs is dim lights. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 64, MOST = 16, TRUNCATES = 2 };

/* What is asked of the texels. */
enum asked {
    CUT,                     /* per cent that hold less than was put in      */
    UNTOLD,                  /* the same, where the frame's counters say
                              * nothing (light_may_clip)                     */
    VANISHED                 /* per cent that hold nothing                   */
};

struct own {
    struct hls_drawn drawn;      /* first, for hls_rig_close                 */
    struct hlc_options o;
    struct hl_light light[MOST];
};

#define TAN_HALF 0.5         /* of the camera, 1 m before the wall           */

/* One light half its radius before the middle of the wall, which gets
 * (1 - 1/4)^2 = 9/16 of its colour, and further ones beside it; or, where dim
 * light is asked for, one that gives every texel its colour. */
static bool stage(struct hls_lab *lab, const struct hls_case *c,
                  const struct hlc_options *o)
{
    struct hls_rig rig;
    hls_rig_begin(&rig, 1, 53.130102354155978);
    hls_rig_wall(&rig, 0, 2, 0);
    if (c->arg[2] == (double)VANISHED)
        hlh_build_directional(&rig.b, hlh_v3(0, 0, -1), hlh_v3(1, 1, 1));
    else
        for (int i = 0; i < (int)c->arg[3]; i++)
            hlh_build_light(&rig.b, hlh_v3(0.06 * (i % 4), 0.05 * (i / 4),
                                           0.5), 1, hlh_v3(1, 1, 1));
    return hls_rig_end(&rig, lab, o);
}

/* What a texel gets of lights of colour 1 (design 4: smooth falloff). */
static double truth(const struct own *w, uint32_t n, uint32_t i)
{
    double x = ((i % SIDE + 0.5) / SIDE * 2 - 1) * TAN_HALF, sum = 0;
    double y = (1 - (i / SIDE + 0.5) / SIDE * 2) * TAN_HALF;
    for (uint32_t k = 0; k < n; k++) {
        double dx = (double)w->light[k].position[0] - x;
        double dy = (double)w->light[k].position[1] - y;
        double dz = (double)w->light[k].position[2];
        double d2 = dx * dx + dy * dy + dz * dz;
        double a = d2 < 1 ? (1 - d2) * (1 - d2) : 0;
        sum += a * dz / sqrt(d2);
    }
    return sum;
}

/* A plan for lights of colour p; arg[1] > 0: its L-buffer holds 0..arg[1],
 * whatever the lights are. */
static int make(struct own *w, struct hls_lab *lab, const struct hls_case *c)
{
    struct hlc_shot *shot = &w->drawn.shot;
    float range = (float)c->arg[1];
    if (w->drawn.made)
        hlc_shot_close(shot);
    w->drawn.made = false;
    memset(shot, 0, sizeof *shot);
    shot->stage = &lab->stage;
    int code = hlc_plan_try(&shot->frame, &shot->needs, &shot->plan,
                            &lab->stage.world, &lab->stage.machine.caps, &w->o,
                            NULL, NULL);
    if (code != HLC_DONE)
        return code;
    const struct hl_plan_target *t = hl_plan_target(&shot->plan,
                                                    HL_ROLE_LIGHT);
    if (range > 0 && hl_format_info(t->format)->kind == HL_KIND_UNORM) {
        shot->plan.light_scale = range;
        shot->plan.light_out = 1 / range;
    }
    code = hlc_shot_make(shot, NULL);
    w->drawn.made = code == HLC_DONE;
    return code;
}

static bool measure(double *, double, const struct hls_case *,
                    struct hls_lab *);

/* Three quarters of a step of 10 bits: is it nothing? OSMesa and lavapipe blend
 * them in 16 bits, of which the lower 6 are cut off. */
static bool right_rounding(const struct hls_case *c, struct hls_lab *lab,
                           const char **skip)
{
    double empty = 0;
    if (!measure(&empty, 0.75 / 1023, c, lab))
        return false;
    bool truncates = empty > 50;
    if (truncates != (c->arg[3] == (double)TRUNCATES))
        *skip = truncates ? "this machine truncates sums of 10 bits"
                          : "this machine rounds sums to nearest";
    return true;
}

/* arg: format, fixed range or 0, enum asked, lights; of VANISHED TRUNCATES
 * instead of 1. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct own *w = lab->data = calloc(1, sizeof *w);
    if (!w)
        return hls_rig_fail("saturation", HL_ERR_MEMORY);
    hls_rig_options(&w->o, lab, SIDE, SIDE);
    w->o.light_format = (enum hl_format)c->arg[0];
    if (!stage(lab, c, &w->o))
        return false;
    if (make(w, lab, c) != HLC_DONE)
        *skip = "the L-buffer format cannot be had on this machine";
    else if (w->o.light_format == HL_FORMAT_RGB10A2_UNORM)
        return right_rounding(c, lab, skip);
    return true;
}

/* A hundredth more than there is room for is cut; less may be a step. */
static double count(const struct own *w, const struct hlc_texels *t,
                    const struct hls_case *c, double p)
{
    double most = (double)w->drawn.shot.plan.light_scale;
    uint32_t n = 0;
    float v[4];
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        hlc_texel(v, t, i);
        if (c->arg[2] == (double)VANISHED)
            n += v[0] == 0;
        else
            n += v[0] >= 1 &&
                 p * truth(w, w->drawn.shot.frame.n_lights, i) > 1.01 * most;
    }
    bool told = w->drawn.shot.stats.light_may_clip;
    if (told && c->arg[2] == (double)UNTOLD)
        return 0;
    /* An alarm where the plan was made for these very lights is false. */
    return told && !(c->arg[1] > 0) ? 100 : 100.0 * n / (SIDE * SIDE);
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    struct hl_light *light = lab->stage.world.lights;
    struct hlc_texels t;
    for (uint32_t i = 0; i < lab->stage.world.n_lights; i++) {
        for (int k = 0; k < 3; k++)
            light[i].color[k] = (float)p;
        w->light[i] = light[i];
    }
    int code = c->arg[1] > 0 ? HLC_DONE : make(w, lab, c);
    if (code != HLC_DONE)
        return hls_rig_fail("saturation: plan", HL_ERR_UNSUPPORTED);
    if (!hls_rig_texels(&t, &w->drawn.shot, HL_ROLE_LIGHT))
        return false;
    *m = count(w, &t, c, p);
    hlc_texels_free(&t);
    return true;
}

#define CUT_STEP (63.5 / 65535)
#define LOW (1.0 / 1024)
#define HALF_STEP(steps) 0.985 * 0.5 / (steps), 1.005 * 0.5 / (steps)

static const struct hls_case cases[] = {
    { "fixed", "RGBA8 that holds 0..1, one light", LOW, 64, 0.1, false,
      1.77, 1.84, "16/9 = 1.78: the wall gets 9/16; and 1 % of grace",
      { HL_FORMAT_RGBA8_UNORM, 1, CUT, 1 } },
    { "fixed-untold", "the same, cut without a word", LOW, 64, 0.1, false, NAN,
      NAN, "none: light_may_clip is a bound",
      { HL_FORMAT_RGBA8_UNORM, 1, UNTOLD, 1 } },
    { "planned", "RGBA8 of the planner's range, 16 lights", LOW, 64, 0.1,
      false, NAN, NAN, "none: the range is a bound of the sum; nor any alarm",
      { HL_FORMAT_RGBA8_UNORM, 0, CUT, MOST } },
    { "dim-8", "a light alone in RGBA8 that holds 0..1", 1.0 / 64, 1.0 / 4096,
      50, false, HALF_STEP(255), "1/510: half a step",
      { HL_FORMAT_RGBA8_UNORM, 1, VANISHED, 1 } },
    { "dim-10", "a light alone in RGB10A2 that holds 0..1, to nearest",
      1.0 / 64, 1.0 / 16384, 50, false, HALF_STEP(1023),
      "1/2046: half a step", { HL_FORMAT_RGB10A2_UNORM, 1, VANISHED, 1 } },
    { "dim-10-truncating", "the same, truncating", 1.0 / 64, 1.0 / 16384, 50,
      false, HALF_STEP(0.5 / CUT_STEP), "63.5/65535: 64 steps of 16 bits",
      { HL_FORMAT_RGB10A2_UNORM, 1, VANISHED, TRUNCATES } },
    { "dim-16", "a light alone in RGBA16 that holds 0..1", 1.0 / 4096,
      1.0 / 1048576, 50, false, HALF_STEP(65535), "1/131070: half a step",
      { HL_FORMAT_RGBA16_UNORM, 1, VANISHED, 1 } },
    { "dim-half", "a light alone in RGBA16F", 1.0 / 64, 1.0 / 16384, 50,
      false, NAN, NAN, "none above 2^-14, the least normal half",
      { HL_FORMAT_RGBA16_FLOAT, 1, VANISHED, 1 } },
    { "dim-float", "a light alone in RGBA32F", 1.0 / 64, 1.0 / 1073741824, 50,
      false, NAN, NAN, "none above 2^-126",
      { HL_FORMAT_RGBA32_FLOAT, 1, VANISHED, 1 } },
};

const struct hls_row hls_row_saturation = {
    "saturation", "Light is cut at an L-buffer's range or lost below its step",
    "conformance b3; 25 (Engel 2009, section 8.5)", "light's colour", "",
    "texels cut, or empty, %", HLS_LOG, cases, sizeof cases / sizeof *cases,
    begin, hls_rig_close, measure
};
