/* SPDX-License-Identifier: Zlib */
/* Light that is lost where each blend rounds: N equal lights onto one texel.
 * A sum of 16-bit floats keeps 11 bits, so that late lights lose their lower
 * bits, towards zero on Mesa, to nearest on packemu (conformance b3); a sum
 * of K lights a blend is rounded N / K times. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 8, MOST = 2048 };
enum rounds { ANY, TRUNCATES, NEAREST };

/* A half-float, so that nothing is rounded but the sums. Of all of 11 bits this
 * is one whose error passes 1 % once and for good under either rounding: at the
 * 78th add truncating, at the 234th to nearest (both by adding on paper, each
 * sum rounded to 11 bits). */
#define LIGHT (1041.0 / 16384)

static bool stage(struct hls_lab *lab, struct hlc_options *o)
{
    struct hls_rig rig;
    hls_rig_begin(&rig, 1, 60);
    hls_rig_wall(&rig, 0, 2, 0);
    for (int i = 0; i < MOST; i++)
        hlh_build_directional(&rig.b, hlh_v3(0, 0, -1),
                              hlh_v3(LIGHT, LIGHT, LIGHT));
    return hls_rig_end(&rig, lab, o);
}

static bool stored(double *mean, double *spread, struct hlc_shot *shot)
{
    struct hlc_texels t;
    float v[4], low = 0, high = 0;
    double sum = 0;
    if (!hls_rig_texels(&t, shot, HL_ROLE_LIGHT))
        return false;
    uint32_t n = t.width * t.height;
    for (uint32_t i = 0; i < n; i++) {
        hlc_texel(v, &t, i);
        low = i == 0 || v[0] < low ? v[0] : low;
        high = i == 0 || v[0] > high ? v[0] : high;
        sum += (double)v[0];
    }
    hlc_texels_free(&t);
    *mean = sum / n * (double)shot->plan.light_scale;
    *spread = (double)high - (double)low;
    return true;
}

/* 1 and 3/4 of a half-float's step above it: 1 where sums are truncated. */
static bool probe(bool *truncates, struct hlc_shot *shot)
{
    static const float value[2] = { 1, 0.75f / 1024 };
    struct hl_light light[2];
    double sum, spread;
    for (int i = 0; i < 2; i++) {
        light[i] = shot->frame.lights[0];
        for (int k = 0; k < 3; k++)
            light[i].color[k] = value[i];
    }
    struct hl_frame whole = shot->frame;
    shot->frame.lights = light;
    shot->frame.n_lights = 2;
    bool ok = stored(&sum, &spread, shot);
    shot->frame = whole;
    *truncates = sum == 1;
    return ok;
}

/* arg: format, lights a blend (0: the planner's, or the command line's),
 * enum rounds. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hlc_options o;
    struct hlc_shot *shot = calloc(1, sizeof *shot);
    bool truncates = false;
    lab->data = shot;
    hls_rig_options(&o, lab, SIDE, SIDE);
    o.light_path = HL_LIGHT_PATH_RECTS;
    o.light_format = (enum hl_format)c->arg[0];
    if (c->arg[1] > 0)
        o.light_batch = (uint32_t)c->arg[1];
    if (!shot || !stage(lab, &o))
        return false;
    char line[HLC_PLAN_LINE];
    if (hlc_shot_open(shot, &lab->stage, &o, NULL, NULL, line) != HLC_DONE) {
        *skip = "the L-buffer format cannot be had on this machine";
        return true;
    }
    if (c->arg[2] == (double)ANY)
        return true;
    if (shot->plan.light_scale != 1) {
        *skip = "16-bit floats do not blend on this machine";
        return true;
    }
    if (!probe(&truncates, shot))
        return false;
    snprintf(lab->note, sizeof lab->note, "%u lights a blend",
             (unsigned)shot->plan.batch);
    if (truncates != (c->arg[2] == (double)TRUNCATES))
        *skip = truncates ? "this machine truncates sums"
                          : "this machine rounds sums to nearest";
    return true;
}

static void end(struct hls_lab *lab)
{
    struct hlc_shot *shot = lab->data;
    if (shot)
        hlc_shot_close(shot);
    free(shot);
    lab->data = NULL;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct hlc_shot *shot = lab->data;
    double sum, spread, truth = p * LIGHT;
    (void)c;
    shot->frame.n_lights = (uint32_t)p;
    if (!stored(&sum, &spread, shot))
        return false;
    /* Every texel gets the same. */
    *m = spread > 0 ? INFINITY : 100 * fabs(sum - truth) / truth;
    return true;
}

/* The planner takes 8 lights a blend, or as many as flat varyings hold: 3 of
 * any kind. A batch of its own: the first of its lights may do it. */
static const struct hls_case cases[] = {
    { "half-truncating-1", "RGBA16F, a light a blend, truncating", 1, MOST, 1,
      false, 78, 78, "78: sums cut to 11 bits, added one by one",
      { HL_FORMAT_RGBA16_FLOAT, 1, TRUNCATES, 0 } },
    { "half-truncating-2", "RGBA16F, 2 lights a blend, truncating", 1, MOST, 1,
      false, 155, 156, "2 x 78",
      { HL_FORMAT_RGBA16_FLOAT, 2, TRUNCATES, 0 } },
    { "half-truncating", "RGBA16F, as planned, truncating", 1, MOST, 1,
      false, 232, 624, "78 times the 3 to 8 lights that a blend sums",
      { HL_FORMAT_RGBA16_FLOAT, 0, TRUNCATES, 0 } },
    { "half-nearest-1", "RGBA16F, a light a blend, to nearest", 1, MOST, 1,
      false, 234, 234, "234: sums rounded to 11 bits, added one by one",
      { HL_FORMAT_RGBA16_FLOAT, 1, NEAREST, 0 } },
    { "half-nearest-2", "RGBA16F, 2 lights a blend, to nearest", 1, MOST, 1,
      false, 467, 468, "2 x 234",
      { HL_FORMAT_RGBA16_FLOAT, 2, NEAREST, 0 } },
    { "half-nearest", "RGBA16F, as planned, to nearest", 1, MOST, 1,
      false, 700, 1872, "234 times the 3 to 8 lights that a blend sums",
      { HL_FORMAT_RGBA16_FLOAT, 0, NEAREST, 0 } },
    { "unorm16", "RGBA16, known peak, a light a blend", 1, MOST, 1, false,
      NAN, NAN, "none: each light is 32.00 steps of its 65,535",
      { HL_FORMAT_RGBA16_UNORM, 1, ANY, 0 } },
    { "float32", "RGBA32F, a light a blend", 1, MOST, 1, false, NAN, NAN,
      "none: 24 bits, N 2^-24 = 0.01 % at most", { HL_FORMAT_RGBA32_FLOAT, 1,
      ANY, 0 } },
};

const struct hls_row hls_row_accumulation = {
    "accumulation", "Lights added one by one are lost in an L-buffer's steps",
    "conformance b3; 25 (Kircher, Lawrance 2009, section 2.2)",
    "lights over one texel", "lights", "error of their sum, %", HLS_WHOLE,
    cases, sizeof cases / sizeof *cases, begin, end, measure
};
