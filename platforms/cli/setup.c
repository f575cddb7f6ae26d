/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/setup.h"
#include <stdio.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/plan_text.h"

int hlc_world_open(struct hlc_world *out, const struct hlc_machine *machine,
                   const struct hlh_scene *scene, const struct hlc_options *o)
{
    struct hlc_world_options w = { o->no_normal_maps, o->no_specular,
                                   o->ids_scheme, o->ids_seed,
                                   o->shadows == HL_SHADOWS_VOLUMES };
    struct hlh_error error;
    const char *more = machine->complaint;
    if (hlc_world_create(out, machine->device, scene, &w, &error))
        return HLC_DONE;
    return hlc_fail(HLC_BAD, "%s%s%s%s", error.text, more[0] ? " (" : "",
                    more, more[0] ? ")" : "");
}

static int make_plan(struct hl_plan *out, const struct hl_needs *needs,
                     const struct hl_caps *caps, const struct hlc_options *o,
                     char line[HLC_PLAN_LINE])
{
    enum hl_refusal why;
    enum hl_result r = hl_plan_make(out, o->pipeline, needs, caps, &why);
    if (r == HL_OK)
        return HLC_DONE;
    bool machine = why == HL_REFUSED_NORMAL_FORMAT ||
                   why == HL_REFUSED_COLOR_FORMAT ||
                   why == HL_REFUSED_DEPTH_FORMAT;
    char text[896];
    hlc_refusal_line(out, why, text, sizeof text);
    snprintf(line, HLC_PLAN_LINE, "%s on %s: %s",
             hlc_pipeline_name(o->pipeline), caps->device,
             text[0] ? text : hl_result_name(r));
    return machine ? HLC_NO_DEVICE : HLC_BAD;
}

/* The plan needs far and the lights in sight, near needs the plan's depth
 * format: so the view is made twice. */
int hlc_plan_try(struct hl_frame *frame, struct hl_needs *needs,
                 struct hl_plan *plan, const struct hlc_world *world,
                 const struct hl_caps *caps, const struct hlc_options *o,
                 const struct hl_probe *probe, char line[HLC_PLAN_LINE])
{
    struct hl_camera camera;
    const struct hlh_scene *scene = world->scene;
    char unread[HLC_PLAN_LINE];
    line = line ? line : unread;
    if (!hlc_view(&camera, scene, o->near, o->far, true)) {
        snprintf(line, HLC_PLAN_LINE, "%s: camera: eye, target, field of view "
                 "or near and far are not usable", scene->name);
        return HLC_BAD;
    }
    hlc_frame(frame, world, &camera);
    hlc_needs(needs, world, frame, o);
    if (probe)
        needs->probe = *probe;
    int code = make_plan(plan, needs, caps, o, line);
    if (code == HLC_DONE)
        hlc_view(&frame->camera, scene, o->near, o->far,
                 plan->reversed_depth);
    for (int k = 0; k < 2; k++)
        frame->camera.jitter[k] = (float)o->jitter[k];
    frame->width = o->part_width;
    frame->height = o->part_height;
    return code;
}

int hlc_plan_open(struct hl_frame *frame, struct hl_needs *needs,
                  struct hl_plan *plan, const struct hlc_world *world,
                  const struct hl_caps *caps, const struct hlc_options *o)
{
    char line[HLC_PLAN_LINE];
    int code = hlc_plan_try(frame, needs, plan, world, caps, o, NULL, line);
    return code == HLC_DONE ? code : hlc_fail(code, "%s", line);
}
