/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/setup.h"
#include <stdio.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/plan_text.h"
#include "platforms/gl/hl_gl.h"
#include "platforms/platforms.h"

/* ---- scene ------------------------------------------------------------- */

static void set3(float out[3], const double in[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (float)in[k];
}

static void override(struct hlh_scene *s, const struct hlc_options *o)
{
    if (o->has_camera) {
        memset(&s->camera, 0, sizeof s->camera);
        set3(s->camera.eye, o->eye);
        set3(s->camera.target, o->target);
        s->camera.vfov = (float)o->vfov;
        s->camera_is_default = false;
    }
    if (o->has_ambient)
        set3(s->ambient, o->ambient);
    if (o->has_background)
        set3(s->background, o->background);
}

bool hlc_scene_open(struct hlh_scene *out, const struct hlc_options *o,
                    struct hlh_error *error)
{
    if (!hlh_scene_load(out, o->arg[0], error))
        return false;
    if (o->lights && !hlh_scene_lights_csv(out, o->lights, o->lights_replace,
                                           error)) {
        hlh_scene_free(out);
        return false;
    }
    override(out, o);
    return true;
}

/* ---- machine ----------------------------------------------------------- */

static void listen(void *user, enum hl_log_level level, enum hl_log_id id,
                   const char *text)
{
    struct hlc_machine *m = user;
    if (level != HL_LOG_ERROR)
        return;
    if (id == HL_MSG_VALIDATION)
        hlc_fail(0, "validation: %s", text);
    snprintf(m->complaint, sizeof m->complaint, "%s", text);
}

static enum hl_result open_on(struct hlc_machine *m,
                              const struct hl_backend *backend,
                              const struct hlc_options *o)
{
    const struct hl_gl_native gl = { o->gl_context, NULL };
    struct hl_device_desc d;
    memset(&d, 0, sizeof d);
    d.version = HL_VERSION;
    d.hooks = hlc_hooks();
    d.native = backend == &hl_backend_gl ? &gl : NULL;
    d.log = listen;
    d.log_user = m;
    d.device = o->device;
    d.validation = o->validation;
    m->backend = backend;
    return hl_device_open(&m->device, backend, &d);
}

int hlc_machine_open(struct hlc_machine *m, const struct hlc_options *o)
{
    enum hl_result r = HL_ERR_NO_DEVICE;
    const struct hl_backend *b;
    memset(m, 0, sizeof *m);
    if (o->backend) {
        b = hl_platform_find(o->backend);
        r = b ? open_on(m, b, o) : HL_ERR_NO_DEVICE;
    }
    for (uint32_t i = 0; !o->backend && r != HL_OK; i++) {
        b = hl_platform(i);
        if (!b)
            break;
        if (strcmp(b->name, "null"))
            r = open_on(m, b, o);
    }
    if (r == HL_OK)
        return HLC_DONE;
    const char *why = m->complaint[0] ? m->complaint : hl_result_name(r);
    if (o->device)
        return hlc_fail(HLC_NO_DEVICE, "--device %s: %s", o->device, why);
    if (o->backend)
        return hlc_fail(HLC_NO_DEVICE, "--backend %s: %s", o->backend, why);
    return hlc_fail(HLC_NO_DEVICE, "no backend has a device: %s", why);
}

void hlc_machine_close(struct hlc_machine *m)
{
    hl_device_close(&m->device);
}

/* ---- world ------------------------------------------------------------- */

int hlc_world_open(struct hlc_world *out, const struct hlc_machine *machine,
                   const struct hlh_scene *scene, const struct hlc_options *o)
{
    struct hlc_world_options w = { o->no_normal_maps, o->no_specular,
                                   o->ids_scheme, o->ids_seed };
    struct hlh_error error;
    const char *more = machine->complaint;
    if (hlc_world_create(out, machine->device, scene, &w, &error))
        return HLC_DONE;
    return hlc_fail(HLC_BAD, "%s%s%s%s", error.text, more[0] ? " (" : "",
                    more, more[0] ? ")" : "");
}

/* ---- plan -------------------------------------------------------------- */

static int make_plan(struct hl_plan *out, const struct hl_needs *needs,
                     const struct hl_caps *caps, const struct hlc_options *o)
{
    enum hl_refusal why;
    enum hl_result r = hl_plan_make(out, o->pipeline, needs, caps, &why);
    if (r == HL_OK)
        return HLC_DONE;
    bool machine = why == HL_REFUSED_NORMAL_FORMAT ||
                   why == HL_REFUSED_COLOR_FORMAT ||
                   why == HL_REFUSED_DEPTH_FORMAT;
    const char *text = hlc_refusal_text(why);
    return hlc_fail(machine ? HLC_NO_DEVICE : HLC_BAD, "%s on %s: %s",
                    hlc_pipeline_name(o->pipeline), caps->device,
                    text[0] ? text : hl_result_name(r));
}

/* The plan needs far and the lights in sight, near needs the plan's depth
 * format: so the view is made twice. */
int hlc_plan_open(struct hl_frame *frame, struct hl_needs *needs,
                  struct hl_plan *plan, const struct hlc_world *world,
                  const struct hl_caps *caps, const struct hlc_options *o)
{
    struct hl_camera camera;
    const struct hlh_scene *scene = world->scene;
    if (!hlc_view(&camera, scene, o->near, o->far, true))
        return hlc_fail(HLC_BAD, "%s: camera: eye, target, field of view or "
                        "near and far are not usable", scene->name);
    hlc_frame(frame, world, &camera);
    hlc_needs(needs, world, frame, o);
    int code = make_plan(plan, needs, caps, o);
    if (code == HLC_DONE)
        hlc_view(&frame->camera, scene, o->near, o->far,
                 plan->reversed_depth);
    return code;
}
