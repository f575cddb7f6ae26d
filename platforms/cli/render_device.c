/* SPDX-License-Identifier: Zlib */
/* render on a device: plan, frames, what is read back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/readback.h"
#include "platforms/cli/render.h"

static int refused(const struct hlc_render *r, const char *what,
                   enum hl_result result)
{
    const char *why = r->machine.complaint;
    bool device = result == HL_ERR_DEVICE_LOST || result == HL_ERR_NO_DEVICE ||
                  result == HL_ERR_UNSUPPORTED;
    return hlc_fail(device ? HLC_NO_DEVICE : HLC_BAD, "%s at %u x %u: %s",
                    what, r->o->width, r->o->height,
                    why[0] ? why : hl_result_name(result));
}

/* ---- making ------------------------------------------------------------ */

/* Room for the largest object's volume, where the default has not that. */
static uint32_t shadow_indices(const struct hlc_render *r)
{
    uint32_t most = 0;
    for (uint32_t i = 0; r->world.shadows && i < r->scene.n_meshes; i++) {
        const struct hl_shadow_mesh *m = &r->world.shadows[i].mesh;
        uint32_t n = 6 * (m->n_faces + m->max_sides);
        most = n > most ? n : most;
    }
    return most > 1u << 20 ? most : 0;
}

static int make_renderer(struct hlc_render *r)
{
    struct hl_renderer_desc d;
    memset(&d, 0, sizeof d);
    d.plan = &r->plan;
    d.surfaces = r->world.surfaces;
    d.n_surfaces = r->world.n_surfaces;
    d.max_items = r->world.n_items ? r->world.n_items : 1;
    d.max_lights = r->world.n_lights ? r->world.n_lights : 1;
    d.readback = true;
    d.shadow_indices = shadow_indices(r);
    size_t bytes = hl_renderer_bytes(&d);
    r->memory = bytes ? malloc(bytes) : NULL;
    if (!r->memory)
        return hlc_fail(HLC_BAD, "%s: %s", r->scene.name,
                        bytes ? "out of memory for the renderer"
                              : "too many objects or lights");
    enum hl_result e = hl_renderer_create(&r->renderer, r->machine.device, &d,
                                          r->memory);
    return e == HL_OK ? HLC_DONE : refused(r, "renderer", e);
}

static int open_all(struct hlc_render *r)
{
    int code = hlc_machine_open(&r->machine, r->o);
    if (code != HLC_DONE)
        return code;
    r->caps = r->machine.caps;
    /* Before the upload, so that a size no machine takes costs no time. */
    if (r->o->width > r->caps.max_tex_dim || r->o->height > r->caps.max_tex_dim)
        return hlc_fail(HLC_BAD, "--size: %s draws at most %u x %u",
                        r->caps.device, r->caps.max_tex_dim,
                        r->caps.max_tex_dim);
    code = hlc_world_open(&r->world, &r->machine, &r->scene, r->o);
    if (code == HLC_DONE)
        code = hlc_plan_open(&r->frame, &r->needs, &r->plan, &r->world,
                             &r->caps, r->o);
    if (code != HLC_DONE)
        return code;
    r->near = (double)r->frame.camera.near;
    r->far = (double)r->frame.camera.far;
    if (r->o->motion) {
        r->before = r->frame.camera;
        r->before.view[12] += r->before.far * 0.01f;
        r->frame.before = &r->before;
    }
    return make_renderer(r);
}

/* ---- frames ------------------------------------------------------------ */

struct timing {
    double *frame, *record;          /* o->frames of each                    */
    double *pass[HLC_RENDER_PASSES];
    const char *name[HLC_RENDER_PASSES];
    uint32_t n_passes, frames, n;
};

static double *pass_row(struct timing *t, const char *name)
{
    uint32_t i = 0;
    while (i < t->n_passes && strcmp(t->name[i], name))
        i++;
    if (i == HLC_RENDER_PASSES)
        return NULL;
    if (i == t->n_passes) {
        t->pass[i] = calloc(t->frames, sizeof(double));
        if (!t->pass[i])
            return NULL;
        t->name[i] = name;
        t->n_passes++;
    }
    return t->pass[i];
}

/* Passes of one name (a pass that was sent in parts) add up. */
static void note_passes(struct timing *t, struct hl_device *device)
{
    struct hl_timing passes[64];
    uint32_t n = hl_timings(device, passes, 64);
    for (uint32_t i = 0; i < n && i < 64; i++) {
        double *row = pass_row(t, passes[i].label);
        if (row)
            row[t->n] += passes[i].ms;
    }
}

/* Wall time from the start of culling to the fence. */
static enum hl_result draw(struct hlc_render *r, const struct hl_frame *frame,
                           struct timing *t, double *ms)
{
    double start = hlc_now_ms();
    enum hl_result e = hl_frame_draw(r->renderer, frame, &r->stats);
    double recorded = hlc_now_ms();
    if (t && e == HL_OK && r->plan.tile_depth)
        note_passes(t, r->machine.device);   /* waited for within the frame  */
    double resumed = hlc_now_ms();
    if (e == HL_OK)
        e = hl_submit(r->machine.device, true);
    *ms = hlc_now_ms() - start - (resumed - recorded);
    if (t && e == HL_OK) {
        note_passes(t, r->machine.device);
        t->frame[t->n] = *ms;
        t->record[t->n++] = recorded - start;
    }
    return e;
}

/* Timed frame i sees the scene from a circle about the eye, in the image
 * plane, of radius far / 10,000: a golden turn a frame, so that no two frames
 * are equal and nothing can be reused, and near and far hold. */
static void move_camera(struct hl_camera *c, uint32_t i)
{
    double turn = 6.283185307179586 * 0.6180339887498949 * i;
    double radius = (double)c->far * 1e-4;
    c->view[12] -= (float)(radius * cos(turn));
    c->view[13] -= (float)(radius * sin(turn));
}

static enum hl_result draw_moved(struct hlc_render *r, struct timing *t)
{
    enum hl_result e = HL_OK;
    uint32_t n = t->frames ? r->o->warmup + t->frames : 0;
    double ms = 0;
    for (uint32_t i = 0; i < n && e == HL_OK; i++) {
        struct hl_frame frame = r->frame;
        move_camera(&frame.camera, i);
        e = draw(r, &frame, i < r->o->warmup ? NULL : t, &ms);
        r->first_ms = i == 0 ? ms : r->first_ms;
    }
    return e;
}

static void sum_up(struct hlc_render *r, struct timing *t)
{
    r->frame_ms = hlc_spread_of(t->frame, t->n);
    r->record_ms = hlc_spread_of(t->record, t->n);
    for (uint32_t i = 0; i < t->n_passes; i++) {
        r->passes[i].name = t->name[i];
        r->passes[i].ms = hlc_spread_of(t->pass[i], t->n).median;
    }
    r->n_passes = t->n_passes;
}

/* The picture is always of the camera that was asked for, drawn last. */
static int draw_all(struct hlc_render *r)
{
    struct timing t;
    double ms = 0;
    memset(&t, 0, sizeof t);
    t.frames = r->o->frames;
    t.frame = calloc((size_t)t.frames + 1, sizeof *t.frame);
    t.record = calloc((size_t)t.frames + 1, sizeof *t.record);
    enum hl_result e = t.frame && t.record ? HL_OK : HL_ERR_MEMORY;
    if (e == HL_OK)
        e = draw_moved(r, &t);
    if (e == HL_OK)
        sum_up(r, &t);
    if (e == HL_OK)
        e = draw(r, &r->frame, NULL, &ms);
    if (t.n == 0)
        r->first_ms = ms;
    free(t.frame);
    free(t.record);
    for (uint32_t i = 0; i < t.n_passes; i++)
        free(t.pass[i]);
    return e == HL_OK ? HLC_DONE : refused(r, "frame", e);
}

/* ---- reading back ------------------------------------------------------ */

static uint32_t part_width(const struct hlc_render *r)
{
    return r->o->part_width ? r->o->part_width : r->plan.width;
}

static uint32_t part_height(const struct hlc_render *r)
{
    return r->o->part_height ? r->o->part_height : r->plan.height;
}

/* A picture of the frame's size down to the part that was drawn, in place:
 * rows only move forward. */
static void crop(const struct hlc_render *r, void *data, size_t texel)
{
    uint32_t w = part_width(r), h = part_height(r);
    for (size_t y = 1; data && y < h; y++)
        memmove((char *)data + y * w * texel,
                (char *)data + y * r->plan.width * texel, w * texel);
}

static int read_picture(struct hlc_render *r)
{
    struct hlc_texels t;
    enum hl_result e = hlc_texels_read(&t, r->machine.device,
                                       hl_renderer_output(r->renderer));
    if (e != HL_OK)
        return refused(r, "picture", e);
    uint32_t w = part_width(r), h = part_height(r);
    r->picture = (struct hlh_picture){
        w, h, malloc((size_t)w * h * 3 * sizeof(float)), true };
    for (size_t i = 0; i < (size_t)w * h && r->picture.rgb; i++) {
        float texel[4];
        hlc_texel(texel, &t, i / w * t.width + i % w);
        memcpy(r->picture.rgb + 3 * i, texel, 3 * sizeof(float));
    }
    hlc_texels_free(&t);
    return r->picture.rgb ? HLC_DONE : refused(r, "picture", HL_ERR_MEMORY);
}

static enum hl_result inspect(struct hlc_render *r, enum hl_inspect what,
                              void *out, size_t texel)
{
    uint32_t w, h;
    void *data;
    hl_inspect_size(r->renderer, what, &w, &h);
    size_t bytes = (size_t)w * h * texel;
    data = malloc(bytes);
    if (!data)
        return HL_ERR_MEMORY;
    enum hl_result e = hl_frame_inspect(r->renderer, &r->frame, what, data,
                                        bytes);
    if (e != HL_OK) {
        free(data);
        data = NULL;
    }
    memcpy(out, &data, sizeof data);
    return e;
}

/* From items to the scene's objects. */
static void name_objects(struct hlc_render *r)
{
    size_t n = (size_t)part_width(r) * part_height(r);
    for (size_t i = 0; i < n; i++) {
        uint32_t id = r->inside.ids[i], item = id >> 16;
        if (item > 0 && item <= r->world.n_items)
            r->inside.ids[i] = (r->world.item_object[item - 1] + 1) << 16 |
                               (id & 65535u);
    }
}

bool hlc_render_inspects(const struct hlc_options *o)
{
    return o->json || o->dump;
}

static bool filters(const struct hl_plan *p)
{
    return p->pipeline == HL_PIPELINE_INFERRED &&
           (p->dsf == HL_DSF_SLOPE || p->dsf == HL_DSF_CONSTANT);
}

static int look_inside(struct hlc_render *r)
{
    struct hlc_inside *in = &r->inside;
    enum hl_result e = HL_OK;
    if (r->o->ids || r->o->dump)
        e = inspect(r, HL_INSPECT_IDS, &in->ids, sizeof *in->ids);
    crop(r, in->ids, sizeof *in->ids);
    if (e == HL_OK && in->ids)
        name_objects(r);
    if (e == HL_OK && hlc_render_inspects(r->o)) {
        e = inspect(r, HL_INSPECT_LIGHTS, &in->lights, sizeof *in->lights);
        hl_inspect_size(r->renderer, HL_INSPECT_LIGHTS, &in->lights_width,
                        &in->lights_height);
    }
    if (e == HL_OK && hlc_render_inspects(r->o) && filters(&r->plan))
        e = inspect(r, HL_INSPECT_REJECTS, &in->rejects, 1);
    crop(r, in->rejects, 1);
    if (e == HL_OK && r->o->dump && r->plan.stipple)
        e = inspect(r, HL_INSPECT_STIPPLE, &in->stipple, 1);
    size_t n = in->lights ? (size_t)in->lights_width * in->lights_height : 0;
    for (size_t i = 0; i < n; i++)
        r->light_evaluations += (uint64_t)in->lights[i];
    return e == HL_OK ? HLC_DONE : refused(r, "statistics", e);
}

int hlc_render_device(struct hlc_render *r)
{
    int code = open_all(r);
    if (code == HLC_DONE)
        code = draw_all(r);
    if (code == HLC_DONE)
        code = read_picture(r);
    if (code == HLC_DONE)
        code = look_inside(r);
    if (code != HLC_DONE)
        return code;
    r->validation_errors = hl_device_validation_errors(r->machine.device);
    if (r->o->validation && r->validation_errors)
        return hlc_fail(HLC_FAILED, "%u validation errors",
                        r->validation_errors);
    return HLC_DONE;
}

void hlc_render_device_free(struct hlc_render *r)
{
    if (r->machine.device)
        hl_submit(r->machine.device, true);
    hl_renderer_destroy(&r->renderer);
    free(r->memory);
    r->memory = NULL;
    hlc_world_free(&r->world);
    hlc_machine_close(&r->machine);
}
