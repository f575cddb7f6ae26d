/* SPDX-License-Identifier: Zlib */
#ifndef HLC_SETUP_H
#define HLC_SETUP_H
/* What several commands begin with: the scene as the command line changed it,
 * an open device, a plan. */
#include "platforms/cli/bridge.h"

/* Load o->arg[0], add or replace lights, override camera, ambient and
 * background. False with one line in *error; *out is then zeroed. */
bool hlc_scene_open(struct hlh_scene *out, const struct hlc_options *o,
                    struct hlh_error *error);

/* A device and what it last complained of. Not to be moved while open. */
struct hlc_machine {
    struct hl_device *device;
    const struct hl_backend *backend;
    struct hl_caps caps;         /* the device's, with o->calibration in     */
    char complaint[256];         /* "" or the last error that was logged     */
};
/* o->backend, or the first backend that can open a device; `null`, which
 * draws nothing, only when it is named. An exit code, after one line on
 * stderr when it is not HLC_DONE. */
int hlc_machine_open(struct hlc_machine *out, const struct hlc_options *o);
void hlc_machine_close(struct hlc_machine *machine);

/* The scene's world on the machine, by the options. An exit code, after one
 * line on stderr when it is not HLC_DONE. */
int hlc_world_open(struct hlc_world *out, const struct hlc_machine *machine,
                   const struct hlh_scene *scene,
                   const struct hlc_options *o);

/* The frame of the world seen by its scene's camera, with near and far as
 * the plan's depth format wants them; its needs; and hl_plan_make with the
 * options' pipeline. An exit code, after one line on stderr: HLC_BAD for what
 * no change of machine would help, or what was asked for by an option;
 * HLC_NO_DEVICE for a machine without the formats. */
int hlc_plan_open(struct hl_frame *frame, struct hl_needs *needs,
                  struct hl_plan *plan, const struct hlc_world *world,
                  const struct hl_caps *caps, const struct hlc_options *o);

enum { HLC_PLAN_LINE = 1024 };
/* The same without a word: what is wrong goes to `line` (may be NULL). With
 * `probe` not NULL it is what the needs say of the method's errors. */
int hlc_plan_try(struct hl_frame *frame, struct hl_needs *needs,
                 struct hl_plan *plan, const struct hlc_world *world,
                 const struct hl_caps *caps, const struct hlc_options *o,
                 const struct hl_probe *probe, char line[HLC_PLAN_LINE]);
#endif
