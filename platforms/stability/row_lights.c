/* SPDX-License-Identifier: Zlib */
/* Lights that are none: no radius or hardly any, no colour, negative ones,
 * numbers that are none. What is documented (core/scene.h): a radius of 0 and
 * black give no light, what is negative or not finite is refused. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 32 };

struct own {
    struct hls_drawn drawn;      /* first, for hls_rig_close                 */
    struct hlc_options o;
};

/* A wall under a light that every path draws, and one to be changed. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct own *w = lab->data = calloc(1, sizeof *w);
    char line[HLC_PLAN_LINE];
    if (!w)
        return hls_rig_fail("lights", HL_ERR_MEMORY);
    hls_rig_options(&w->o, lab, SIDE, SIDE);
    w->o.light_path = (enum hl_light_path)c->arg[0];
    w->o.volume_texels = 1;
    if (c->arg[1] > 0)
        w->o.pipeline = (enum hl_pipeline)c->arg[1];
    hls_rig_begin(&rig, 1, 60);
    hls_rig_wall(&rig, 0, 2, 0);
    for (int i = 0; i < 2; i++) {
        hlh_build_spot(&rig.b, hlh_v3(0.013, 0.017, 1), hlh_v3(0, 0, 0), 3,
                       0.5, 0.7, hlh_v3(0.5, 0.5, 0.5));
        rig.scene.lights[i].falloff = i ? HLH_FALLOFF_INVERSE_SQUARE
                                        : HLH_FALLOFF_SMOOTH;
    }
    if (!hls_rig_end(&rig, lab, &w->o))
        return false;
    w->drawn.made = hlc_shot_open(&w->drawn.shot, &lab->stage, &w->o, NULL,
                                  NULL, line) == HLC_DONE;
    if (!w->drawn.made)
        *skip = "the light path cannot be had on this machine";
    return true;
}

/* ---- outcomes ----------------------------------------------------------- */

enum outcome { DARK, LIT, REFUSED, WRONG };

/* Alone in the frame. Lit: some pixel gets light, and every lit one's centre
 * lies within `reach` of the wall's point before the light. */
static enum outcome outcome_of(struct own *w, const struct hl_light *light,
                               double reach)
{
    struct hlh_picture picture;
    enum outcome out = DARK;
    w->drawn.shot.frame.lights = light;
    w->drawn.shot.frame.n_lights = 1;
    enum hl_result r = hlc_shot_draw(&w->drawn.shot, NULL);
    if (r != HL_OK)
        return r == HL_ERR_INVALID ? REFUSED : WRONG;
    if (hlc_shot_read(&w->drawn.shot, &picture) != HL_OK)
        return WRONG;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        double scale = 2 * 0.57735026918962576 / SIDE;
        double x = (i % SIDE + 0.5 - SIDE / 2) * scale;
        double y = (SIDE / 2 - 0.5 - i / SIDE) * scale;
        const float *p = picture.rgb + 3 * i;
        bool far = hypot(x - (double)light->position[0],
                         y - (double)light->position[1]) > reach;
        for (int k = 0; k < 3; k++) {
            if (!(p[k] >= 0 && p[k] <= 1e5f) || (far && p[k] > 0))
                out = WRONG;
            else if (p[k] > 0 && out == DARK)
                out = LIT;
        }
    }
    free(picture.rgb);
    return out;
}

static int wrong(struct own *w, const struct hl_light *light, double reach,
                 enum outcome want)
{
    return outcome_of(w, light, reach) != want;
}

/* A light of radius p in `light`: right before the wall by a third of that, on
 * it, where N.L has no direction, and farther than its radius. */
static int good_ones(struct own *w, struct hl_light light, double p)
{
    int n = 0;
    double pixel = 2 * 0.57735026918962576 / SIDE;
    light.radius = (float)p;
    light.position[2] = (float)(p / 3);
    enum outcome o = outcome_of(w, &light, p);
    /* Smaller than a pixel it may fall between centres. */
    n += p > pixel ? o != LIT : o == REFUSED || o == WRONG;
    light.position[2] = 0;
    o = outcome_of(w, &light, p);
    n += o == REFUSED || o == WRONG;
    light.position[2] = (float)(p * 1.01);
    n += wrong(w, &light, p, DARK);
    light.position[2] = (float)(p / 3);
    light.color[0] = light.color[1] = light.color[2] = 0;
    n += wrong(w, &light, p, DARK);
    light.color[0] = -0.0f;
    n += wrong(w, &light, p, DARK);
    return n;
}

static int bad_ones(struct own *w, struct hl_light light, double p)
{
    int n = 0;
    light.position[2] = 0.3f;
    struct hl_light l = light;
    l.radius = 0;
    n += wrong(w, &l, 0, DARK);
    l.radius = (float)-p;
    n += wrong(w, &l, 0, REFUSED);
    l.radius = NAN;
    n += wrong(w, &l, 0, REFUSED);
    l.radius = INFINITY;
    n += wrong(w, &l, 0, REFUSED);
    for (int k = 0; k < 3; k++) {
        l = light;
        l.color[k] = (float)-p;
        n += wrong(w, &l, 0, REFUSED);
        l.color[k] = NAN;
        n += wrong(w, &l, 0, REFUSED);
        l = light;
        l.position[k] = NAN;
        n += wrong(w, &l, 0, REFUSED);
    }
    return n;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    int n = 0;
    (void)c;
    for (int i = 0; i < 4; i++) {
        struct hl_light light = lab->stage.world.lights[i / 2];
        light.kind = i & 1 ? HL_SPOT : HL_POINT;
        n += good_ones(w, light, p) + bad_ones(w, light, p);
    }
    *m = n;
    return true;
}

/* Down to the least denormal number; its negative and reciprocal too. */
#define SWEEP 1, 1.4e-45, 0, false, NAN, NAN, \
              "none: no light or HL_ERR_INVALID (core/scene.h)"

static const struct hls_case cases[] = {
    { "rects", "a batch a rectangle", SWEEP, { HL_LIGHT_PATH_RECTS, 0 } },
    { "tiles", "a draw a tile", SWEEP, { HL_LIGHT_PATH_TILES, 0 } },
    { "lists", "lists of tiles", SWEEP, { HL_LIGHT_PATH_LISTS, 0 } },
    { "volumes", "stencil volumes", SWEEP, { HL_LIGHT_PATH_VOLUMES, 0 } },
    { "forward", "forward", SWEEP, { 0, HL_PIPELINE_FORWARD } },
    { "multipass", "a draw a light and object", SWEEP,
      { 0, HL_PIPELINE_FORWARD_MULTIPASS } },
};

const struct hls_row hls_row_lights = {
    "lights", "A light without radius or colour, or that is no number, shows",
    "(Kircher, Lawrance 2009, section 2.2; 38)", "radius", "m",
    "wrong outcomes", HLS_LOG, cases, sizeof cases / sizeof *cases, begin,
    hls_rig_close, measure
};
