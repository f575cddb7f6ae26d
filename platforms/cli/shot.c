/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/shot.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/readback.h"
#include "platforms/cli/render.h"

/* Before the upload, so that a size no machine takes costs no time. */
static int check_size(const struct hl_caps *caps, const struct hlc_options *o)
{
    if (o->width <= caps->max_tex_dim && o->height <= caps->max_tex_dim)
        return HLC_DONE;
    return hlc_fail(HLC_BAD, "--size: %s draws at most %u x %u", caps->device,
                    caps->max_tex_dim, caps->max_tex_dim);
}

int hlc_stage_open(struct hlc_stage *s, struct hlh_scene *scene,
                   const struct hlc_options *o)
{
    memset(s, 0, sizeof *s);
    s->scene = *scene;
    memset(scene, 0, sizeof *scene);
    int code = hlc_machine_open(&s->machine, o);
    if (code == HLC_DONE)
        code = check_size(&s->machine.caps, o);
    if (code == HLC_DONE)
        code = hlc_world_open(&s->world, &s->machine, &s->scene, o);
    if (code != HLC_DONE)
        hlc_stage_close(s);
    return code;
}

void hlc_stage_close(struct hlc_stage *s)
{
    hlc_world_free(&s->world);
    hlc_machine_close(&s->machine);
    hlh_scene_free(&s->scene);
    memset(s, 0, sizeof *s);
}

/* Room for the largest object's volume, where the default has not that. */
static uint32_t shadow_indices(const struct hlc_stage *s)
{
    uint32_t most = 0;
    for (uint32_t i = 0; s->world.shadows && i < s->scene.n_meshes; i++) {
        const struct hl_shadow_mesh *m = &s->world.shadows[i].mesh;
        uint32_t n = 6 * (m->n_faces + m->max_sides);
        most = n > most ? n : most;
    }
    return most > 1u << 20 ? most : 0;
}

static uint32_t at_least_one(uint32_t n) { return n ? n : 1; }

int hlc_shot_make(struct hlc_shot *shot, char line[HLC_PLAN_LINE])
{
    const struct hlc_world *w = &shot->stage->world;
    char unread[HLC_PLAN_LINE];
    struct hl_renderer_desc d;
    memset(&d, 0, sizeof d);
    d.plan = &shot->plan;
    d.surfaces = w->surfaces;
    d.n_surfaces = w->n_surfaces;
    d.max_items = at_least_one(w->n_items);
    d.max_lights = at_least_one(w->n_lights);
    d.readback = true;
    d.shadow_indices = shadow_indices(shot->stage);
    size_t bytes = hl_renderer_bytes(&d);
    shot->memory = bytes ? malloc(bytes) : NULL;
    enum hl_result r = !bytes ? HL_ERR_LIMIT : !shot->memory ? HL_ERR_MEMORY
        : hl_renderer_create(&shot->renderer, shot->stage->machine.device, &d,
                             shot->memory);
    if (r == HL_OK)
        return HLC_DONE;
    const char *why = shot->stage->machine.complaint;
    snprintf(line ? line : unread, HLC_PLAN_LINE, "%s: renderer at %u x %u: "
             "%s", shot->stage->scene.name, shot->plan.width,
             shot->plan.height, !bytes ? "too many objects or lights"
                                : why[0] ? why : hl_result_name(r));
    hlc_shot_close(shot);
    return r == HL_ERR_MEMORY || r == HL_ERR_LIMIT ? HLC_BAD : HLC_NO_DEVICE;
}

int hlc_shot_open(struct hlc_shot *shot, struct hlc_stage *stage,
                  const struct hlc_options *o, const struct hl_caps *caps,
                  const struct hl_probe *probe, char line[HLC_PLAN_LINE])
{
    memset(shot, 0, sizeof *shot);
    shot->stage = stage;
    int code = hlc_plan_try(&shot->frame, &shot->needs, &shot->plan,
                            &stage->world, caps ? caps : &stage->machine.caps,
                            o, probe, line);
    return code == HLC_DONE ? hlc_shot_make(shot, line) : code;
}

void hlc_shot_close(struct hlc_shot *shot)
{
    if (shot->renderer)
        hl_submit(shot->stage->machine.device, true);
    hl_renderer_destroy(&shot->renderer);
    free(shot->memory);
    shot->memory = NULL;
}

enum hl_result hlc_shot_draw(struct hlc_shot *shot, double *ms)
{
    double start = hlc_now_ms();
    enum hl_result r = hl_frame_draw(shot->renderer, &shot->frame,
                                     &shot->stats);
    if (r == HL_OK)
        r = hl_submit(shot->stage->machine.device, true);
    if (ms)
        *ms = hlc_now_ms() - start;
    return r;
}

enum hl_result hlc_shot_read(const struct hlc_shot *shot,
                             struct hlh_picture *out)
{
    struct hlc_texels t;
    uint32_t w = shot->frame.width ? shot->frame.width : shot->plan.width;
    uint32_t h = shot->frame.height ? shot->frame.height : shot->plan.height;
    size_t n = (size_t)w * h;
    memset(out, 0, sizeof *out);
    enum hl_result r = hlc_texels_read(&t, shot->stage->machine.device,
                                       hl_renderer_output(shot->renderer));
    if (r != HL_OK)
        return r;
    *out = (struct hlh_picture){ w, h, malloc(n * 3 * sizeof(float)), true };
    for (size_t i = 0; i < n && out->rgb; i++) {
        float texel[4];
        hlc_texel(texel, &t, i / w * t.width + i % w);
        memcpy(out->rgb + 3 * i, texel, 3 * sizeof(float));
    }
    hlc_texels_free(&t);
    return out->rgb ? HL_OK : HL_ERR_MEMORY;
}

enum hl_result hlc_shot_inspect(const struct hlc_shot *shot,
                                enum hl_inspect what, void **out,
                                uint32_t *width, uint32_t *height)
{
    bool byte = what == HL_INSPECT_REJECTS || what == HL_INSPECT_STIPPLE;
    hl_inspect_size(shot->renderer, what, width, height);
    size_t bytes = (size_t)*width * *height * (byte ? 1 : 4);
    *out = malloc(bytes);
    if (!*out)
        return HL_ERR_MEMORY;
    enum hl_result r = hl_frame_inspect(shot->renderer, &shot->frame, what,
                                        *out, bytes);
    if (r != HL_OK) {
        free(*out);
        *out = NULL;
    }
    return r;
}
