/* SPDX-License-Identifier: Zlib */
/* render on a device: plan, frames, what is read back. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/render.h"

static int refused(const struct hlc_render *r, const char *what,
                   enum hl_result result)
{
    const char *why = r->stage.machine.complaint;
    bool device = result == HL_ERR_DEVICE_LOST || result == HL_ERR_NO_DEVICE ||
                  result == HL_ERR_UNSUPPORTED;
    return hlc_fail(device ? HLC_NO_DEVICE : HLC_BAD, "%s at %u x %u: %s",
                    what, r->o->width, r->o->height,
                    why[0] ? why : hl_result_name(result));
}

/* ---- making ------------------------------------------------------------ */

static int open_all(struct hlc_render *r)
{
    char line[HLC_PLAN_LINE];
    struct hlh_scene scene = r->stage.scene;
    int code = hlc_stage_open(&r->stage, &scene, r->o);
    if (code != HLC_DONE)
        return code;
    struct hl_probe probe = { 0 };
    if (r->probe)
        code = r->probe(&probe, &r->stage, r->o);
    if (code != HLC_DONE)
        return refused(r, "probe", HL_ERR_DEVICE_LOST);
    code = hlc_shot_open(&r->shot, &r->stage, r->o, NULL, &probe, line);
    if (code != HLC_DONE)
        return hlc_fail(code, "%s", line);
    struct hl_frame *f = &r->shot.frame;
    r->near = (double)f->camera.near;
    r->far = (double)f->camera.far;
    if (r->o->motion) {
        r->before = f->camera;
        r->before.view[12] += r->before.far * 0.01f;
        f->before = &r->before;
    }
    return HLC_DONE;
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
    struct hl_device *device = r->stage.machine.device;
    double start = hlc_now_ms();
    enum hl_result e = hl_frame_draw(r->shot.renderer, frame, &r->shot.stats);
    double recorded = hlc_now_ms();
    if (t && e == HL_OK && r->shot.plan.tile_depth)
        note_passes(t, device);  /* waited for within the frame              */
    double resumed = hlc_now_ms();
    if (e == HL_OK)
        e = hl_submit(device, true);
    *ms = hlc_now_ms() - start - (resumed - recorded);
    if (t && e == HL_OK) {
        note_passes(t, device);
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
        struct hl_frame frame = r->shot.frame;
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
        e = draw(r, &r->shot.frame, NULL, &ms);
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
    return r->o->part_width ? r->o->part_width : r->shot.plan.width;
}

static uint32_t part_height(const struct hlc_render *r)
{
    return r->o->part_height ? r->o->part_height : r->shot.plan.height;
}

/* A picture of the frame's size down to the part that was drawn, in place:
 * rows only move forward. */
static void crop(const struct hlc_render *r, void *data, size_t texel)
{
    uint32_t w = part_width(r), h = part_height(r);
    for (size_t y = 1; data && y < h; y++)
        memmove((char *)data + y * w * texel,
                (char *)data + y * r->shot.plan.width * texel, w * texel);
}

static int read_picture(struct hlc_render *r)
{
    enum hl_result e = hlc_shot_read(&r->shot, &r->picture);
    return e == HL_OK ? HLC_DONE : refused(r, "picture", e);
}

/* *out: any pointer to texels. */
static enum hl_result inspect(struct hlc_render *r, enum hl_inspect what,
                              void *out)
{
    uint32_t w, h;
    void *data;
    enum hl_result e = hlc_shot_inspect(&r->shot, what, &data, &w, &h);
    memcpy(out, &data, sizeof data);
    return e;
}

/* From items to the scene's objects. */
static void name_objects(struct hlc_render *r)
{
    const struct hlc_world *w = &r->stage.world;
    size_t n = (size_t)part_width(r) * part_height(r);
    for (size_t i = 0; i < n; i++) {
        uint32_t id = r->inside.ids[i], item = id >> 16;
        if (item > 0 && item <= w->n_items)
            r->inside.ids[i] = (w->item_object[item - 1] + 1) << 16 |
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
        e = inspect(r, HL_INSPECT_IDS, &in->ids);
    crop(r, in->ids, sizeof *in->ids);
    if (e == HL_OK && in->ids)
        name_objects(r);
    if (e == HL_OK && hlc_render_inspects(r->o)) {
        e = inspect(r, HL_INSPECT_LIGHTS, &in->lights);
        hl_inspect_size(r->shot.renderer, HL_INSPECT_LIGHTS, &in->lights_width,
                        &in->lights_height);
    }
    if (e == HL_OK && hlc_render_inspects(r->o) && filters(&r->shot.plan))
        e = inspect(r, HL_INSPECT_REJECTS, &in->rejects);
    crop(r, in->rejects, 1);
    if (e == HL_OK && r->o->dump && r->shot.plan.stipple)
        e = inspect(r, HL_INSPECT_STIPPLE, &in->stipple);
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
    r->validation_errors = hl_device_validation_errors(r->stage.machine.device);
    if (r->o->validation && r->validation_errors)
        return hlc_fail(HLC_FAILED, "%u validation errors",
                        r->validation_errors);
    return HLC_DONE;
}

void hlc_render_device_free(struct hlc_render *r)
{
    hlc_shot_close(&r->shot);
    hlc_stage_close(&r->stage);
}
