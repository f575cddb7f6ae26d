/* SPDX-License-Identifier: Zlib */
/* Whole frames of a scene: measured, counted and predicted. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/chart/count.h"
#include "platforms/cli/commands.h"

enum { ROUNDS = 9 };

/* A scene on the machine that is measured, and on the one that counts. */
struct place {
    const struct hlc_options *o;
    const struct hl_caps *units;
    struct hlc_stage stage, counter;
    struct hlk_frame frame[HLK_WAYS];
};

static struct hlc_options options_of(const struct hlc_options *o, int way)
{
    struct hlc_options x = *o;
    x.pipeline = way == HLK_FORWARD ? HL_PIPELINE_FORWARD
                                    : HL_PIPELINE_INFERRED;
    x.samples = 1;
    x.no_tile_depth = true;
    if (way == HLK_INFERRED) {
        x.light_width = (o->width * 5 + 4) / 8;
        x.light_height = (o->height * 5 + 4) / 8;
    }
    return x;
}

/* The same plan at other costs: what they would have changed is asked for. */
static double plan_ms(const struct place *p, int way, const struct hl_plan *as,
                      const struct hl_caps *caps)
{
    struct hlc_options x = options_of(p->o, way);
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
    char line[HLC_PLAN_LINE];
    x.light_path = as->light_path;
    x.light_batch = as->light_path == HL_LIGHT_PATH_RECTS ? as->batch : 0;
    x.fill = as->fill;
    x.fetch = as->dsf_bilinear ? HL_FETCH_BILINEAR : HL_FETCH_GATHER;
    x.translucency = as->translucency;
    bool ok = hlc_plan_try(&frame, &needs, &plan, &p->stage.world, caps, &x,
                           NULL, line) == HLC_DONE;
    return ok ? (double)plan.cost_ms : NAN;
}

/* The plan drawn by packemu. */
static bool count(struct hlt_counts *counts, struct place *p,
                  const struct hlc_shot *drawn)
{
    struct hlc_shot shot = *drawn;
    char line[HLC_PLAN_LINE];
    shot.stage = &p->counter;
    shot.frame.items = p->counter.world.items;
    shot.frame.lights = p->counter.world.lights;
    if (hlc_shot_make(&shot, line) != HLC_DONE)
        return false;
    bool ok = hlt_count(counts, &shot) == HL_OK;
    hlc_shot_close(&shot);
    return ok;
}

static void predict(struct hlk_frames *out, struct place *p, int way)
{
    const struct hlc_shot *shot = &p->frame[way].shot;
    const struct hl_caps *caps[HLK_COSTS] = {
        hl_device_caps(p->stage.machine.device), p->units
    };
    struct hlt_counts counts;
    bool counted = shot->renderer && count(&counts, p, shot);
    for (int c = 0; c < HLK_COSTS; c++) {
        out->planned[way][c] = shot->renderer
                               ? plan_ms(p, way, &shot->plan, caps[c]) : NAN;
        out->counted[way][c] =
            counted ? hlt_weigh(&counts, &shot->plan, caps[c]) * 1e-6 : NAN;
    }
}

static int open_stage(struct hlc_stage *stage, const struct hlc_options *o)
{
    struct hlh_scene scene;
    struct hlh_error error;
    return hlc_scene_open(&scene, o, &error)
           ? hlc_stage_open(stage, &scene, o)
           : hlc_fail(HLC_BAD, "%s", error.text);
}

static int open_place(struct place *p)
{
    struct hlc_options counter = *p->o;
    char line[HLC_PLAN_LINE];
    int code = open_stage(&p->stage, p->o);
    /* A console's formats are packemu's alone. */
    if (strcmp(p->units->backend, "packemu"))
        counter.profile = counter.device = NULL;
    counter.backend = "packemu";
    if (code == HLC_DONE)
        code = open_stage(&p->counter, &counter);
    for (int way = 0; way < HLK_WAYS && code == HLC_DONE; way++) {
        struct hlc_options x = options_of(p->o, way);
        hlc_shot_open(&p->frame[way].shot, &p->stage, &x, p->units, NULL,
                      line);
    }
    return code;
}

static int measure(struct hlk_frames *out, struct place *p)
{
    int code = open_place(p);
    if (code != HLC_DONE)
        return code;
    snprintf(out->scene, sizeof out->scene, "%s", p->stage.scene.name);
    if (!hlk_time(p->frame, HLK_WAYS, ROUNDS,
                  p->units->kind == HL_DEVICE_CPU))
        return hlc_fail(HLC_NO_DEVICE, "calibrate: the device failed");
    for (int way = 0; way < HLK_WAYS; way++) {
        out->ms[way] = hlk_value_of(p->frame[way].ms, ROUNDS);
        predict(out, p, way);
    }
    double ratio[ROUNDS];
    for (int r = 0; r < ROUNDS; r++)
        ratio[r] = p->frame[HLK_INFERRED].ms[r] / p->frame[HLK_FORWARD].ms[r];
    out->ratio = hlk_value_of(ratio, ROUNDS);
    return code;
}

int hlk_frames_measure(struct hlk_frames *out, const struct hlc_options *o,
                       const struct hl_caps *units)
{
    struct place *p = calloc(1, sizeof *p);
    memset(out, 0, sizeof *out);
    if (!p)
        return hlc_fail(HLC_BAD, "calibrate: out of memory");
    p->o = o;
    p->units = units;
    int code = measure(out, p);
    for (int way = 0; way < HLK_WAYS; way++)
        if (p->frame[way].shot.renderer)
            hlc_shot_close(&p->frame[way].shot);
    hlc_stage_close(&p->counter);
    hlc_stage_close(&p->stage);
    free(p);
    return code;
}
