/* SPDX-License-Identifier: Zlib */
/* "A lighting model no more complex than needed" (Kircher, Lawrance 2009,
 * section 7.1): with few lights inferred lighting costs more than drawing
 * forward, and the planner must see that. Costs are what frames really had,
 * drawn by packemu and weighed with the machine's unit costs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/count.h"
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { WIDTH = 320, HEIGHT = 180 };

static const char *const scenes[] = { "fig8", "many", "fig9" };

struct few {
    struct hl_caps caps;         /* planned and weighed for                  */
    uint32_t all;                /* lights of the scene                      */
};

static void options(struct hlc_options *o, const struct hls_lab *lab)
{
    hls_rig_options(o, lab, WIDTH, HEIGHT);
    o->light_width = o->light_height = 0;
    o->backend = "packemu";
}

static bool caps_of(struct hl_caps *out, const struct hls_lab *lab)
{
    struct hlc_machine m;
    if (hlc_machine_open(&m, lab->o) != HLC_DONE)
        return false;
    *out = m.caps;
    hlc_machine_close(&m);
    return true;
}

/* arg: scene. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hlh_scene scene;
    struct hlh_error error;
    struct hlc_options o;
    struct few *f = calloc(1, sizeof *f);
    (void)skip;
    lab->data = f;
    options(&o, lab);
    if (!f || !caps_of(&f->caps, lab))
        return false;
    if (!hlh_scene_builtin(&scene, scenes[(int)c->arg[0]], &error)) {
        hlc_fail(HLC_FAILED, "stability: %s", error.text);
        return false;
    }
    if (!hls_lab_scene(lab, &scene, &o))
        return false;
    f->all = lab->stage.world.n_lights;
    return true;
}

static void end(struct hls_lab *lab)
{
    free(lab->data);
    lab->data = NULL;
}

/* Of a pipeline with the first lights; *ns 0: it has no plan. */
static bool counted(double *ns, enum hl_pipeline pipeline, uint32_t lights,
                    struct hls_lab *lab)
{
    const struct few *f = lab->data;
    struct hlc_options o;
    struct hlc_shot shot;
    struct hlt_counts counts;
    options(&o, lab);
    o.pipeline = pipeline;
    *ns = 0;
    lab->stage.world.n_lights = lights;
    int code = hlc_shot_open(&shot, &lab->stage, &o, &f->caps, NULL, NULL);
    enum hl_result r = code ? HL_OK : hlt_count(&counts, &shot);
    if (!code && r == HL_OK)
        *ns = hlt_weigh(&counts, &shot.plan, &f->caps);
    if (!code)
        hlc_shot_close(&shot);
    lab->stage.world.n_lights = f->all;
    return r == HL_OK || hls_rig_fail("few_lights", r);
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    double chosen, least = 0;
    (void)c;
    if (!counted(&chosen, HL_PIPELINE_AUTO, (uint32_t)p, lab))
        return false;
    for (int k = 1; k < HL_PIPELINE_COUNT; k++) {
        double ns;
        if (!counted(&ns, (enum hl_pipeline)k, (uint32_t)p, lab))
            return false;
        least = ns > 0 && (least <= 0 || ns < least) ? ns : least;
    }
    *m = chosen > 0 && least > 0 ? chosen / least : INFINITY;
    return true;
}

#define CHEAPEST "none: the planner takes the cheapest (K 7.1)"

static const struct hls_case cases[] = {
    { "none", "fig8 with no light, and one", 0, 1, 1.25, false, NAN, NAN,
      CHEAPEST, { 0, 0, 0, 0 } },
    { "fig8", "fig8's first lights", 1, 64, 1.25, false, NAN, NAN, CHEAPEST,
      { 0, 0, 0, 0 } },
    { "many", "of many, 1,000 objects", 1, 50, 1.25, false, NAN, NAN,
      CHEAPEST, { 1, 0, 0, 0 } },
    { "fig9", "of fig9, local lights", 1, 64, 1.25, false, NAN, NAN,
      CHEAPEST, { 2, 0, 0, 0 } },
};

const struct hls_row hls_row_few_lights = {
    "few_lights", "Inferred lighting where forward is cheaper",
    "conformance c (Kircher, Lawrance 2009, section 7.1)", "lights",
    "lights", "cost of the choice over the cheapest",
    HLS_WHOLE, cases, sizeof cases / sizeof *cases, begin, end, measure
};
