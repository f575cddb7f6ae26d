/* SPDX-License-Identifier: Zlib */
#ifndef HLC_SHOT_H
#define HLC_SHOT_H
/* One scene on one machine, and the ways to draw it: what render, sweeps,
 * probes and calibration share. But for hlc_stage_open nothing here prints. */
#include "platforms/cli/setup.h"
#include "platforms/host/image.h"

struct hlc_stage {
    struct hlc_machine machine;
    struct hlh_scene scene;      /* owned                                    */
    struct hlc_world world;
};

/* The machine of o->backend, o->profile and o->device, with *scene, which is
 * moved in (zeroed, whatever the result). An exit code, after one line on
 * stderr; *stage is closed when it is not HLC_DONE. Not to be moved while
 * open. */
int hlc_stage_open(struct hlc_stage *stage, struct hlh_scene *scene,
                   const struct hlc_options *o);
void hlc_stage_close(struct hlc_stage *stage);

/* One way: a plan, its frame, its renderer. */
struct hlc_shot {
    struct hlc_stage *stage;     /* borrowed                                 */
    struct hl_needs needs;
    struct hl_plan plan;
    struct hl_frame frame;       /* to be changed between draws              */
    struct hl_renderer *renderer;
    void *memory;
    struct hl_frame_stats stats; /* of the last draw                         */
};

/* Plan by the options and `caps` (NULL: the stage's machine.caps; others are
 * for planning alone, the machine draws), and make the renderer. An exit code;
 * `line` (may be NULL) says why it is not HLC_DONE, and *shot is closed. */
int hlc_shot_open(struct hlc_shot *shot, struct hlc_stage *stage,
                  const struct hlc_options *o, const struct hl_caps *caps,
                  const struct hl_probe *probe, char line[HLC_PLAN_LINE]);
/* The same with a plan that was made: shot->plan and shot->frame are set. */
int hlc_shot_make(struct hlc_shot *shot, char line[HLC_PLAN_LINE]);
void hlc_shot_close(struct hlc_shot *shot);

/* Draw and wait; *ms (may be NULL): wall time from culling to the fence. */
enum hl_result hlc_shot_draw(struct hlc_shot *shot, double *ms);
/* Linear picture of the last draw; out->rgb is the caller's to free. */
enum hl_result hlc_shot_read(const struct hlc_shot *shot,
                             struct hlh_picture *out);
/* A picture of the inside (hl_frame_inspect), *out malloc'd: a texel has 4
 * bytes, or 1 of REJECTS and STIPPLE. Draws the frame anew. */
enum hl_result hlc_shot_inspect(const struct hlc_shot *shot, enum hl_inspect,
                                void **out, uint32_t *width,
                                uint32_t *height);
#endif
