/* SPDX-License-Identifier: Zlib */
/* Thousands of lights: what a frame does and what it takes for them must grow
 * as their number. Work is counted, so that it is the same on every machine:
 * light evaluations, draws and entries of light lists (those of 0 lights, one
 * draw a pass, taken off). Every light reaches every pixel, which is the most
 * there can be, and none is culled. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/stability/rig.h"

enum { SIDE = 8, MOST = 65536, CODES = 512 };
enum what { WORK, BYTES };

struct growth {
    struct hlc_shot shot;
    double none, one;            /* work of 0 lights, and what one adds      */
};

static bool stage(struct hls_lab *lab, const struct hlc_options *o)
{
    struct hls_rig rig;
    double c = 1.0 / MOST;       /* all of them together: within any format  */
    hls_rig_begin(&rig, 1, 60);
    hls_rig_wall(&rig, 0, 2, 0);
    for (int i = 0; i < MOST; i++)
        hlh_build_light(&rig.b, hlh_v3(0, 0, 1), 10, hlh_v3(c, c, c));
    return hls_rig_end(&rig, lab, o);
}

/* Pictures of counts end at 65,535, which is one light of the most missed, or
 * at 255, which will not do. */
static bool work(double *out, struct growth *g, uint32_t lights)
{
    uint32_t w, h;
    void *data;
    g->shot.frame.n_lights = lights;
    enum hl_result r = hlc_shot_draw(&g->shot, NULL);
    if (r == HL_OK)
        r = hlc_shot_inspect(&g->shot, HL_INSPECT_LIGHTS, &data, &w, &h);
    if (r != HL_OK)
        return hls_rig_fail("growth", r);
    const float *evaluations = data;
    *out = (double)g->shot.stats.draws + (double)g->shot.stats.light_refs;
    for (uint32_t i = 0; i < w * h; i++)
        *out += (double)evaluations[i];
    free(data);
    return true;
}

static size_t bytes_for(const struct growth *g, uint32_t lights)
{
    const struct hlc_world *w = &g->shot.stage->world;
    struct hl_renderer_desc d;
    memset(&d, 0, sizeof d);
    d.plan = &g->shot.plan;
    d.surfaces = w->surfaces;
    d.n_surfaces = w->n_surfaces;
    d.max_items = w->n_items;
    d.max_lights = lights;
    return hl_renderer_bytes(&d);
}

/* arg: enum hl_pipeline, enum hl_light_path, enum what. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hlc_options o;
    struct growth *g = calloc(1, sizeof *g);
    double one = 0;
    lab->data = g;
    hls_rig_options(&o, lab, SIDE, SIDE);
    o.pipeline = (enum hl_pipeline)c->arg[0];
    o.light_path = (enum hl_light_path)c->arg[1];
    if (!g || !stage(lab, &o) || !hls_rig_shot(&g->shot, lab, &o))
        return false;
    if (c->arg[2] != (double)WORK)
        return true;
    double many;
    if (!work(&g->none, g, 0) || !work(&one, g, 1) || !work(&many, g, CODES))
        return false;
    g->one = one - g->none;
    if (many < SIDE * SIDE * (CODES - 1.0))
        *skip = "pictures of counts have 8 bits on this machine";
    return true;
}

static void end(struct hls_lab *lab)
{
    struct growth *g = lab->data;
    if (g)
        hlc_shot_close(&g->shot);
    free(g);
    lab->data = NULL;
}

/* Of work(p) ~ p^e: |e - 1|, %. */
static bool exponent(double *m, double p, struct growth *g)
{
    double all;
    if (!work(&all, g, (uint32_t)p))
        return false;
    *m = p > 1 ? 100 * fabs(log((all - g->none) / g->one) / log(p) - 1) : 0;
    return true;
}

/* Of the line through 1 and MOST lights: bytes off it. */
static bool bytes_off(double *m, double p, struct hls_lab *lab)
{
    const struct growth *g = lab->data;
    double first = (double)bytes_for(g, 1), last = (double)bytes_for(g, MOST);
    double a = (last - first) / (MOST - 1);
    *m = fabs((double)bytes_for(g, (uint32_t)p) - first - a * (p - 1));
    snprintf(lab->note, sizeof lab->note, "%.0f bytes a light", a);
    return true;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    return c->arg[2] == (double)WORK ? exponent(m, p, lab->data)
                                     : bytes_off(m, p, lab);
}

#define LINEAR "none: O(l) for what is lit (Kircher, Lawrance 2009, section 6)"

static const struct hls_case cases[] = {
    { "rects", "inferred, rectangles: |e - 1|, %", 1, MOST, 20, false, NAN,
      NAN, LINEAR, { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_RECTS, WORK, 0 } },
    { "tiles", "inferred, a draw a tile: |e - 1|, %", 1, MOST, 20, false, NAN,
      NAN, LINEAR, { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_TILES, WORK, 0 } },
    { "lists", "inferred, light lists: |e - 1|, %", 1, MOST, 20, false, NAN,
      NAN, LINEAR, { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_LISTS, WORK, 0 } },
    { "forward", "8 lights a draw: |e - 1|, %", 1, MOST, 20, false, NAN, NAN,
      LINEAR, { HL_PIPELINE_FORWARD, 0, WORK, 0 } },
    { "multipass", "a draw a light: |e - 1|, %", 1, MOST, 20, false, NAN, NAN,
      LINEAR, { HL_PIPELINE_FORWARD_MULTIPASS, 0, WORK, 0 } },
    { "memory", "of a renderer, lists: bytes off a line", 1, MOST, 256,
      false, NAN, NAN, "none: 4 arrays of lights that end at 64 bytes",
      { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_LISTS, BYTES, 0 } },
};

const struct hls_row hls_row_growth = {
    "growth", "Thousands of lights cost more than their number",
    "conformance c; 52 (Kircher, Lawrance 2009, section 6)", "lights",
    "lights", "work ~ lights^e: error of e, %",
    HLS_WHOLE, cases, sizeof cases / sizeof *cases, begin, end, measure
};
