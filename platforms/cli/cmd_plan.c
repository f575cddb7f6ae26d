/* SPDX-License-Identifier: Zlib */
/* plan SCENE: what `render` would draw with, and why; nothing is drawn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/probe.h"

struct planned {
    struct hlc_stage stage;
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
};

static int open_all(struct planned *p, const struct hlc_options *o)
{
    struct hlh_error error;
    struct hlh_scene scene;
    if (!hlc_scene_open(&scene, o, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    struct hl_probe probe = { 0 };
    char line[HLC_PLAN_LINE] = "the device was lost while the scene was probed";
    int code = hlc_stage_open(&p->stage, &scene, o);
    if (code != HLC_DONE)
        return code;
    if (hlc_probe_wanted(o))
        code = hlc_probe_measure(&probe, &p->stage, o);
    if (code == HLC_DONE)
        code = hlc_plan_try(&p->frame, &p->needs, &p->plan, &p->stage.world,
                            &p->stage.machine.caps, o, &probe, line);
    return code == HLC_DONE ? code : hlc_fail(code, "%s", line);
}

/* ---- telling ------------------------------------------------------------ */

static const char *specular_need(enum hl_specular_need s)
{
    return s == HL_NEED_NO_SPECULAR ? "none"
           : s == HL_NEED_ONE_EXPONENT ? "one_exponent" : "exponents";
}

/* null: no such bound, or not known. */
static void bound(cJSON *j, const char *key, float x)
{
    if (x > 0)
        hlc_json_real(j, key, (double)x, 6);
    else
        cJSON_AddNullToObject(j, key);
}

static void add_budget(cJSON *j, const struct hl_needs *n)
{
    bound(j, "budget_codes", n->budget_codes);
    bound(j, "budget_ms", n->budget_ms);
    cJSON *p = cJSON_AddObjectToObject(j, "probe");
    bound(p, "full", n->probe.full);
    bound(p, "three_quarters", n->probe.three_quarters);
    bound(p, "half", n->probe.half);
    bound(p, "quarter", n->probe.quarter);
    bound(p, "forward", n->probe.forward);
    bound(p, "eight", n->probe.eight);
    bound(p, "eight_blends", n->probe.eight_blends);
}

static void add_needs(cJSON *tree, const struct hl_needs *n)
{
    cJSON *j = cJSON_AddObjectToObject(tree, "needs");
    hlc_json_uint(j, "objects", n->n_objects);
    hlc_json_uint(j, "triangles", n->n_triangles);
    hlc_json_uint(j, "lights", n->n_lights);
    hlc_json_real(j, "lights_per_pixel", (double)n->lights_per_pixel, 6);
    hlc_json_real(j, "lights_per_object", (double)n->lights_per_object, 6);
    hlc_json_real(j, "cover", (double)n->cover, 6);
    hlc_json_uint(j, "regions", n->n_regions);
    cJSON_AddStringToObject(j, "falloff", hlc_falloff_name(n->lights & 3u));
    cJSON_AddBoolToObject(j, "cones", (n->lights & HL_LIGHTS_CONES) != 0);
    cJSON_AddStringToObject(j, "specular", specular_need(n->specular));
    cJSON_AddBoolToObject(j, "blended", n->blended);
    hlc_json_uint(j, "blended_layers", n->blended_layers);
    cJSON_AddBoolToObject(j, "decals", n->decals);
    cJSON_AddBoolToObject(j, "brdfs", n->brdfs);
    hlc_json_uint(j, "shadow_lights", n->n_shadow_lights);
    cJSON_AddBoolToObject(j, "shadow_points", n->shadow_points);
    hlc_json_real(j, "far", (double)n->far, 9);
    hlc_json_real(j, "peak", (double)n->peak, 6);
    hlc_json_real(j, "max_error",
                  n->max_error > 0 ? (double)n->max_error : 1.0, 6);
    add_budget(j, n);
}

static cJSON *to_json(const struct planned *p)
{
    const struct hl_caps *caps = &p->stage.machine.caps;
    const struct hl_camera *camera = &p->frame.camera;
    uint32_t width = p->plan.light_width, height = p->plan.light_height;
    cJSON *j = hlc_json_begin("plan");
    hlc_json_scene(j, &p->stage.scene, (double)camera->near,
                   (double)camera->far);
    hlc_json_size(j, "size", p->plan.width, p->plan.height);
    hlc_json_size(j, "light_size", width ? width : p->plan.width,
                  height ? height : p->plan.height);
    hlc_json_uint(j, "samples", p->plan.samples);
    cJSON_AddStringToObject(j, "backend", caps->backend);
    cJSON_AddStringToObject(j, "device", caps->device);
    cJSON_AddStringToObject(j, "driver", caps->driver);
    cJSON_AddStringToObject(j, "profile", p->plan.profile);
    cJSON_AddStringToObject(j, "pipeline",
                            hlc_pipeline_name(p->plan.pipeline));
    add_needs(j, &p->needs);
    cJSON *plan = hlc_plan_json(&p->plan);
    if (!cJSON_AddItemToObject(j, "plan", plan))
        cJSON_Delete(plan);
    return j;
}

static void print_text(const struct planned *p)
{
    const struct hl_needs *n = &p->needs;
    const struct hl_caps *caps = &p->stage.machine.caps;
    printf("scene %s: %u objects, %u triangles, %u lights; a pixel sees %.3g "
           "lights, an object %.3g\n", p->stage.scene.name,
           (unsigned)n->n_objects, (unsigned)n->n_triangles,
           (unsigned)n->n_lights, (double)n->lights_per_pixel,
           (double)n->lights_per_object);
    printf("device %s on %s\n", caps->device, caps->backend);
    hl_plan_text(stdout, &p->plan);
}

static int tell(const struct planned *p, const struct hlc_options *o)
{
    struct hlh_error error;
    bool ok = true;
    if (o->json) {
        cJSON *j = to_json(p);
        ok = hlc_json_emit(j, o->json, &error);
        cJSON_Delete(j);
    }
    if (!ok)
        return hlc_fail(HLC_BAD, "%s", error.text);
    if (!o->json || strcmp(o->json, "-"))
        print_text(p);
    return HLC_DONE;
}

int hlc_cmd_plan(const struct hlc_options *o)
{
    if (o->reference)
        return hlc_fail(HLC_BAD, "plan: the reference renderer needs no plan");
    struct planned *p = calloc(1, sizeof *p);
    if (!p)
        return hlc_fail(HLC_BAD, "plan: out of memory");
    int code = open_all(p, o);
    if (code == HLC_DONE)
        code = tell(p, o);
    hlc_stage_close(&p->stage);
    free(p);
    return code;
}
