/* SPDX-License-Identifier: Zlib */
#ifndef HL_PIPE_H
#define HL_PIPE_H
/* Private to core: how a pipeline offers its plan, and what planners share.
 * One file a pipeline, the same function shapes in each. */
#include "core/plan.h"

/* Needs with every default filled in. */
struct hl_ask {
    struct hl_needs n;
    const struct hl_caps *caps;
    float per_pixel, per_object;   /* lights; estimates where unknown        */
};

enum hl_refusal hl_plan_forward(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_multipass(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_inferred(struct hl_plan *, const struct hl_ask *);

/* Append; what is past the array's end is a defect that tests catch. */
void hl_plan_why(struct hl_plan *, enum hl_reason, float, float, float, float);
struct hl_plan_target *hl_plan_add_target(struct hl_plan *, enum hl_role,
                                          enum hl_format, uint32_t width,
                                          uint32_t height, uint32_t samples);
struct hl_plan_pass *hl_plan_add_pass(struct hl_plan *, enum hl_pass_role);
/* The frame's own targets: colour (able to blend when `blend`), depth, and
 * the resolved colour. */
enum hl_refusal hl_plan_frame_targets(struct hl_plan *, const struct hl_ask *,
                                      uint32_t blends);
void hl_plan_common(struct hl_plan *, const struct hl_ask *);
void hl_plan_finish(struct hl_plan *, const struct hl_ask *, double cost_ns);

/* layout.c: formats and what they cost in accuracy. */
bool hl_format_usable(const struct hl_caps *, enum hl_format, int use,
                      uint32_t samples);
/* First usable of a zero-terminated list, or NONE. */
enum hl_format hl_format_pick(const struct hl_caps *,
                              const enum hl_format *list, int use,
                              uint32_t samples);
/* Degrees, worst for normals up to 90 degrees from the view axis. */
float hl_normal_error(enum hl_format);
/* Relative error of a sum of `terms` blends, the last rounding included;
 * values of about 1/8 of `peak`, in a format scaled to it. */
float hl_accumulation_error(enum hl_format, uint32_t terms);
#endif
