/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/probe.h"
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/reference/reference.h"

/* Pictures of a probe. A plan that is refused leaves rgb NULL. */
struct shown {
    struct hlh_picture picture;
    float blends;                /* that the planner takes an L texel to have */
};

static float planned_blends(const struct hl_plan *p)
{
    for (uint32_t i = 0; i < p->n_reasons; i++) {
        enum hl_reason why = p->reason[i].why;
        if (why == HL_WHY_LIGHT_FORMAT_ASKED ||
            why == HL_WHY_LIGHT_FORMAT_ERROR ||
            why == HL_WHY_LIGHT_FORMAT_PROFILE)
            return p->reason[i].arg[1];
    }
    return 0;
}

static int code_of(enum hl_result r)
{
    return r == HL_OK ? HLC_DONE
           : r == HL_ERR_DEVICE_LOST ? HLC_NO_DEVICE : HLC_BAD;
}

static int draw(struct shown *out, struct hlc_stage *stage,
                const struct hlc_options *o)
{
    char line[HLC_PLAN_LINE];
    struct hlc_shot shot;
    memset(out, 0, sizeof *out);
    /* Not planned, or too large for the machine's memory: unknown. */
    if (hlc_shot_open(&shot, stage, o, NULL, NULL, line) != HLC_DONE)
        return HLC_DONE;
    out->blends = planned_blends(&shot.plan);
    enum hl_result r = hlc_shot_draw(&shot, NULL);
    if (r == HL_OK)
        r = hlc_shot_read(&shot, &out->picture);
    hlc_shot_close(&shot);
    return code_of(r);
}

/* The options' own scene, size, samples, filter and features; what a budget
 * decides is set for each picture. */
static struct hlc_options plain(const struct hlc_options *o)
{
    struct hlc_options p = *o;
    p.has_max_error = false;
    p.max_cost = 0;
    p.part_width = p.part_height = 0;
    p.motion = false;
    return p;
}

static int draw_forward(struct shown *out, struct hlc_stage *stage,
                        const struct hlc_options *o)
{
    struct hlc_options p = plain(o);
    p.pipeline = HL_PIPELINE_FORWARD;
    return draw(out, stage, &p);
}

static int draw_inferred(struct shown *out, struct hlc_stage *stage,
                         const struct hlc_options *o, uint32_t quarters,
                         enum hl_format format)
{
    struct hlc_options p = plain(o);
    p.pipeline = HL_PIPELINE_INFERRED;
    p.light_width = (o->width * quarters + 3) / 4;
    p.light_height = (o->height * quarters + 3) / 4;
    p.light_format = format;
    return draw(out, stage, &p);
}

/* In the best format that the machine's rules allow. */
static int draw_best(struct shown *out, struct hlc_stage *stage,
                     const struct hlc_options *o, uint32_t quarters)
{
    const enum hl_format list[] = { HL_FORMAT_RGBA32_FLOAT,
                                    HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_NONE };
    int code = HLC_DONE;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < 3 && code == HLC_DONE && !out->picture.rgb; i++)
        code = draw_inferred(out, stage, o, quarters, list[i]);
    return code;
}

/* 0 would be unknown. */
#define NONE 1e-7f

static float between(const struct shown *a, const struct shown *b)
{
    if (!a->picture.rgb || !b->picture.rgb)
        return 0;
    double rms = hlc_rms_codes(&a->picture, &b->picture);
    return rms > (double)NONE ? (float)rms : NONE;
}

enum { TRUTH, FORWARD, QUARTERS, FULL = QUARTERS + 4, EIGHT, PICTURES };

void hlc_probe_truth(struct hlh_picture *out, const struct hlc_stage *stage,
                     const struct hlc_options *o)
{
    struct hlr_stats stats;
    struct hlr_options r = {
        .width = o->width, .height = o->height,
        .jitter = { o->jitter[0], o->jitter[1] }, .samples = o->samples,
        .normal_maps = !o->no_normal_maps, .no_specular = o->no_specular,
        .near = o->near, .far = o->far,
        .shadows = o->shadows != HL_SHADOWS_NONE
    };
    size_t n = (size_t)o->width * o->height;
    *out = (struct hlh_picture){ o->width, o->height,
                                 malloc(n * 3 * sizeof(float)), true };
    if (out->rgb && !hlr_render(out->rgb, NULL, &stage->scene, &r, &stats))
        hlh_picture_free(out);
}

static int draw_all(struct shown s[PICTURES], struct hlc_stage *stage,
                    const struct hlc_options *o)
{
    hlc_probe_truth(&s[TRUTH].picture, stage, o);
    int code = draw_forward(&s[FORWARD], stage, o);
    for (uint32_t i = 1; i <= 4 && code == HLC_DONE; i++)
        code = draw_best(&s[QUARTERS + i], stage, o, i);
    if (code == HLC_DONE)
        code = draw_inferred(&s[EIGHT], stage, o, 4, HL_FORMAT_RGBA8_UNORM);
    return code;
}

static void compare(struct hl_probe *out, const struct shown s[PICTURES])
{
    bool whole = s[FULL].picture.rgb != NULL;
    const struct shown *truth = &s[s[TRUTH].picture.rgb ? TRUTH : FORWARD];
    const struct shown *right = whole ? &s[FULL] : truth;
    out->forward = truth == &s[TRUTH] ? between(&s[FORWARD], truth) : 0;
    out->full = between(&s[FULL], truth);
    out->quarter = between(&s[QUARTERS + 1], right);
    out->half = between(&s[QUARTERS + 2], right);
    out->three_quarters = between(&s[QUARTERS + 3], right);
    out->eight = between(&s[EIGHT], &s[FULL]);
    out->eight_blends = out->eight > 0 ? s[EIGHT].blends : 0;
    if (!whole && out->half > 0)
        out->full = NONE;
}

bool hlc_probe_wanted(const struct hlc_options *o)
{
    return o->has_max_error || o->max_cost > 0;
}

int hlc_probe_measure(struct hl_probe *out, struct hlc_stage *stage,
                      const struct hlc_options *o)
{
    struct shown s[PICTURES];
    memset(s, 0, sizeof s);
    memset(out, 0, sizeof *out);
    if (!strcmp(stage->machine.caps.backend, "null"))
        return HLC_DONE;
    int code = draw_all(s, stage, o);
    if (code == HLC_DONE)
        compare(out, s);
    for (int i = 0; i < PICTURES; i++)
        hlh_picture_free(&s[i].picture);
    return code;
}
