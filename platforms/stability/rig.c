/* SPDX-License-Identifier: Zlib */
#include "platforms/stability/rig.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

bool hls_rig_fail(const char *what, enum hl_result r)
{
    hlc_fail(HLC_FAILED, "stability: %s: %s", what, hl_result_name(r));
    return false;
}

/* ---- scenes ------------------------------------------------------------- */

void hls_rig_begin(struct hls_rig *r, double eye, double vfov)
{
    memset(r, 0, sizeof *r);
    hlh_build_begin(&r->b, &r->scene, 1);
    hlh_build_material(&r->b, "matte", hlh_v3(0.8, 0.8, 0.8), 1, 0);
    hlh_build_camera(&r->b, hlh_v3(0, 0, eye), hlh_v3(0, 0, 0), vfov);
}

void hls_rig_object(struct hls_rig *r, uint32_t material)
{
    uint32_t mesh = hlh_build_mesh(&r->b, "mesh", material);
    hlh_build_object_at_origin(&r->b, mesh);
}

void hls_rig_wall(struct hls_rig *r, uint32_t material, double half, double z)
{
    hlh_add_patch(&r->b, hlh_v3(-half, -half, z), hlh_v3(2 * half, 0, 0),
                  hlh_v3(0, 2 * half, 0), 1, 1);
    hls_rig_object(r, material);
}

void hls_rig_lean(struct hls_rig *r, uint32_t material, double half, double z,
                  double x, double y)
{
    double length = sqrt(x * x + y * y + 1);
    hlh_add_patch(&r->b, hlh_v3(-half, -half, z), hlh_v3(2 * half, 0, 0),
                  hlh_v3(0, 2 * half, 0), 1, 1);
    for (uint32_t i = 0; !r->b.failed && i < r->b.n_vertices; i++) {
        float *n = r->b.vertices[i].normal;
        n[0] = (float)(x / length);
        n[1] = (float)(y / length);
        n[2] = (float)(1 / length);
    }
    hls_rig_object(r, material);
}

bool hls_rig_take(struct hlh_scene *out, struct hls_rig *r)
{
    struct hlh_error error;
    free(r->b.vertices);
    free(r->b.indices);
    *out = r->scene;
    out->name = hlh_strdup("stability");
    if (r->b.failed || !out->name)
        hlh_fail(&error, "stability", "out of memory");
    else if (hlh_scene_finish(out, out->name, false, &error))
        return true;
    hlh_scene_free(out);
    memset(out, 0, sizeof *out);
    hlc_fail(HLC_FAILED, "%s", error.text);
    return false;
}

bool hls_rig_end(struct hls_rig *r, struct hls_lab *lab,
                 const struct hlc_options *o)
{
    struct hlh_scene scene;
    return hls_rig_take(&scene, r) && hls_lab_scene(lab, &scene, o);
}

/* ---- pictures ----------------------------------------------------------- */

void hls_rig_options(struct hlc_options *o, const struct hls_lab *lab,
                     uint32_t w, uint32_t h)
{
    *o = *lab->o;
    o->pipeline = HL_PIPELINE_INFERRED;
    o->reference = false;
    o->width = o->light_width = w;
    o->height = o->light_height = h;
    o->part_width = o->part_height = 0;
    o->samples = 1;
    o->light_path = HL_LIGHT_PATH_AUTO;
    o->near = o->far = 0;
    o->jitter[0] = o->jitter[1] = 0;
    o->shadows = HL_SHADOWS_NONE;
    o->has_max_error = false;
    o->max_cost = 0;
}

bool hls_rig_shot(struct hlc_shot *shot, struct hls_lab *lab,
                  const struct hlc_options *o)
{
    char line[HLC_PLAN_LINE];
    if (hlc_shot_open(shot, &lab->stage, o, NULL, NULL, line) == HLC_DONE)
        return true;
    hlc_fail(HLC_FAILED, "stability: %s", line);
    return false;
}

bool hls_rig_swap(struct hlc_shot *shot, struct hls_rig *rig,
                  const struct hlc_options *o)
{
    struct hlc_stage *s = shot->stage;
    struct hl_camera camera = shot->frame.camera;
    struct hlh_scene scene;
    if (!hls_rig_take(&scene, rig))
        return false;
    hl_submit(s->machine.device, true);
    hlc_world_free(&s->world);
    hlh_scene_free(&s->scene);
    s->scene = scene;
    if (hlc_world_open(&s->world, &s->machine, &s->scene, o) != HLC_DONE)
        return false;
    hlc_frame(&shot->frame, &s->world, &camera);
    return true;
}

bool hls_rig_texels(struct hlc_texels *out, struct hlc_shot *shot,
                    enum hl_role role)
{
    enum hl_result r = hlc_shot_draw(shot, NULL);
    if (r == HL_OK)
        r = hlc_texels_read(out, shot->stage->machine.device,
                            hl_renderer_target(shot->renderer, role));
    return r == HL_OK || hls_rig_fail("drawing", r);
}

bool hls_rig_picture(struct hlh_picture *out, struct hlc_shot *shot)
{
    enum hl_result r = hlc_shot_draw(shot, NULL);
    if (r == HL_OK)
        r = hlc_shot_read(shot, out);
    return r == HL_OK || hls_rig_fail("drawing", r);
}

void hls_rig_close(struct hls_lab *lab)
{
    struct hls_drawn *d = lab->data;
    if (d && d->made)
        hlc_shot_close(&d->shot);
    free(lab->data);
    lab->data = NULL;
}

uint32_t hls_rig_glass(struct hls_rig *r, int i, double alpha)
{
    uint32_t m = hlh_build_material(&r->b, "pane", hlh_hue(i / 7.0, 0.6, 0.9),
                                    1, 0);
    struct hlh_material *pane = hlh_build_last_material(&r->b);
    pane->base_color[3] = (float)alpha;
    pane->alpha = HLH_ALPHA_BLEND;
    return m;
}

void hls_rig_pane(struct hls_rig *r, uint32_t material, int i, double half,
                  double z)
{
    hls_rig_lean(r, material, half, z, 0.6 * (i % 3 - 1),
                 0.6 * (i / 3 % 3 - 1));
}

void hls_rig_lights(struct hls_rig *r)
{
    hlh_build_light(&r->b, hlh_v3(0.2, 0.3, 0.6), 1.8, hlh_v3(1, 0.9, 0.8));
    hlh_build_light(&r->b, hlh_v3(-0.4, -0.2, 0.8), 1.6,
                    hlh_v3(0.5, 0.7, 1));
}
