/* SPDX-License-Identifier: Zlib */
/* plan SCENE: what `render` would draw with, and why; nothing is drawn. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/setup.h"

struct planned {
    struct hlh_scene scene;
    struct hlc_machine machine;
    struct hlc_world world;
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
};

static int open_all(struct planned *p, const struct hlc_options *o)
{
    struct hlh_error error;
    if (!hlc_scene_open(&p->scene, o, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    int code = hlc_machine_open(&p->machine, o);
    if (code == HLC_DONE)
        code = hlc_world_open(&p->world, &p->machine, &p->scene, o);
    if (code == HLC_DONE)
        code = hlc_plan_open(&p->frame, &p->needs, &p->plan, &p->world,
                             &p->machine.caps, o);
    return code;
}

static void close_all(struct planned *p)
{
    hlc_world_free(&p->world);
    hlc_machine_close(&p->machine);
    hlh_scene_free(&p->scene);
}

/* ---- telling ------------------------------------------------------------ */

static const char *specular_need(enum hl_specular_need s)
{
    return s == HL_NEED_NO_SPECULAR ? "none"
           : s == HL_NEED_ONE_EXPONENT ? "one_exponent" : "exponents";
}

static void add_needs(cJSON *tree, const struct hl_needs *n)
{
    cJSON *j = cJSON_AddObjectToObject(tree, "needs");
    hlc_json_uint(j, "objects", n->n_objects);
    hlc_json_uint(j, "triangles", n->n_triangles);
    hlc_json_uint(j, "lights", n->n_lights);
    hlc_json_real(j, "lights_per_pixel", (double)n->lights_per_pixel, 6);
    hlc_json_real(j, "lights_per_object", (double)n->lights_per_object, 6);
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
}

static cJSON *to_json(const struct planned *p)
{
    const struct hl_caps *caps = hl_device_caps(p->machine.device);
    const struct hl_camera *camera = &p->frame.camera;
    uint32_t width = p->plan.light_width, height = p->plan.light_height;
    cJSON *j = hlc_json_begin("plan");
    hlc_json_scene(j, &p->scene, (double)camera->near, (double)camera->far);
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
    printf("scene %s: %u objects, %u triangles, %u lights; a pixel sees %.3g "
           "lights, an object %.3g\n", p->scene.name, (unsigned)n->n_objects,
           (unsigned)n->n_triangles, (unsigned)n->n_lights,
           (double)n->lights_per_pixel, (double)n->lights_per_object);
    printf("device %s on %s\n", hl_device_caps(p->machine.device)->device,
           hl_device_caps(p->machine.device)->backend);
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
    close_all(p);
    free(p);
    return code;
}
