/* SPDX-License-Identifier: Zlib */
#ifndef HL_PIPE_H
#define HL_PIPE_H
/* Private to core: how a pipeline offers its plan, and what planners share.
 * One file a pipeline, the same function shapes in each. */
#include "core/plan.h"

/* Fragments a pixel that a pass shades whose draws are sorted front to back
 * and by surface: 0.90 to 1.05 in the built-in scenes, counted. */
#define HL_OVERDRAW 1.05

/* Needs with every default filled in. */
struct hl_ask {
    struct hl_needs n;
    const struct hl_caps *caps;
    float per_pixel, per_object;   /* lights; estimates where unknown        */
    uint32_t fit_width, fit_height; /* L-buffer that EDRAM holds; 0: not
                                    * known to be needed                     */
};

/* HL_OVERDRAW over all pixels, those of the background too. */
static inline double hl_plan_overdraw(const struct hl_ask *ask)
{
    return HL_OVERDRAW * (double)ask->n.cover;
}

enum hl_refusal hl_plan_forward(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_multipass(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_inferred(struct hl_plan *, const struct hl_ask *);

/* Append; what is past the array's end is a defect that tests catch. */
void hl_plan_why(struct hl_plan *, enum hl_reason, float, float, float, float);
struct hl_plan_target *hl_plan_add_target(struct hl_plan *, enum hl_role,
                                          enum hl_format, uint32_t width,
                                          uint32_t height, uint32_t samples);
struct hl_plan_pass *hl_plan_add_pass(struct hl_plan *, enum hl_pass_role);
/* Is the role one of the pass's colour targets? */
bool hl_pass_colors(const struct hl_plan_pass *, enum hl_role);
/* The frame's own targets: colour (able to blend when `blend`), depth, and
 * the resolved colour. */
enum hl_refusal hl_plan_frame_targets(struct hl_plan *, const struct hl_ask *,
                                      uint32_t blends);
/* First usable; *row is its row of the profile, or NULL. */
enum hl_format hl_plan_depth_format(const struct hl_caps *, int use,
                                    uint32_t samples,
                                    const struct hl_profile_format **row);
enum hl_refusal hl_plan_common(struct hl_plan *, const struct hl_ask *);
void hl_plan_finish(struct hl_plan *, const struct hl_ask *, double cost_ns);

/* Pixels that stages run for in a pass over all of the frame, samples of edges
 * included. */
double hl_plan_shaded_pixels(const struct hl_ask *);

/* pipe_channels.c, pipe_dsf.c, pipe_stipple.c, pipe_shadow.c: parts of the
 * inferred pipeline's plan. Channels go before the light path, DSF after all
 * targets are there. */
enum hl_refusal hl_plan_channels(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_translucency(struct hl_plan *, const struct hl_ask *);
enum hl_refusal hl_plan_shadows(struct hl_plan *, const struct hl_ask *);
/* Does the plan draw stencil volumes, of lights or of shadows? */
bool hl_plan_stencil(const struct hl_plan *, const struct hl_ask *);
/* Format of LIGHT_DEPTH, as hl_plan_depth_format; with a stencil where volumes
 * need one. */
enum hl_format hl_plan_light_depth(const struct hl_plan *,
                                   const struct hl_ask *, int use,
                                   const struct hl_profile_format **row);
/* The pass of lights with shadows, where there are shadows: after LIGHT. */
void hl_plan_shadowed_pass(struct hl_plan *);
/* pipe_map.c: by shadow maps; their passes go after LIGHT, when the L-buffer's
 * target is there. */
enum hl_refusal hl_plan_shadow_maps(struct hl_plan *, const struct hl_ask *);
void hl_plan_map_passes(struct hl_plan *, const struct hl_ask *);
double hl_plan_map_cost(const struct hl_plan *, const struct hl_ask *);
/* Nanoseconds of all that shadows add. */
double hl_plan_shadow_cost(const struct hl_plan *, const struct hl_ask *);
void hl_plan_dsf(struct hl_plan *, const struct hl_ask *);
/* pipe_centroid.c: after the DSF. */
void hl_plan_centroid(struct hl_plan *, const struct hl_ask *);

/* pipe_light.c: how the light pass finds its lights, giving nanoseconds. */
double hl_plan_light_path(struct hl_plan *, const struct hl_ask *);
enum { HL_TILE_DRAW_LIGHTS = 14 };  /* of TILES, about: lights a draw         */

/* pipe_light_format.c: the L-buffer. */
enum hl_refusal hl_plan_light_format(struct hl_plan *, const struct hl_ask *);
/* What it will be with the plan's light path: what is asked for, even if it
 * will be refused, or the best; NONE: there is none. */
enum hl_format hl_plan_light_pick(const struct hl_plan *,
                                  const struct hl_ask *);
/* May a planner that compares formats take this one unasked? */
bool hl_plan_light_candidate(const struct hl_ask *, enum hl_format);
/* Blends that one L texel sees, once the path is chosen. */
uint32_t hl_plan_light_blends(const struct hl_plan *, const struct hl_ask *);

/* plan.c: the plan of one pipeline; `automatic`: nobody asked for it. */
enum hl_refusal hl_plan_one(struct hl_plan *, enum hl_pipeline,
                            const struct hl_ask *, bool automatic);

/* plan_budget.c: given the plan that is made without a budget, the one that
 * keeps it best. */
enum hl_refusal hl_plan_budget(struct hl_plan *, enum hl_pipeline,
                               const struct hl_ask *);

/* plan_error.c: error_codes of a plan that is otherwise done. */
void hl_plan_error(struct hl_plan *, const struct hl_ask *);
/* A calibration's values, as they can be: finite, none below 0. */
bool hl_error_model_good(const struct hl_error_model *);

/* plan_console.c: what a profile rules. */

/* First row that holds here and is usable, of `asked` where that is not
 * NONE; NULL: none, or the profile has no rows. */
const struct hl_profile_format *
hl_plan_row(const struct hl_caps *, const struct hl_profile_format *list,
            enum hl_format asked, int use, uint32_t samples);
/* Format of the console that a target's stands for; its own elsewhere. */
enum hl_format hl_plan_console_format(const struct hl_caps *,
                                      const struct hl_plan_target *);
/* Lay the row on the target, and say what it stands in for. `read`: the
 * target is sampled. */
void hl_plan_keep(struct hl_plan *, struct hl_plan_target *,
                  const struct hl_caps *, const struct hl_profile_format *,
                  bool read);
/* Name, ids, taps and pixel centres. */
enum hl_refusal hl_plan_profile(struct hl_plan *, const struct hl_ask *);
/* How the normal and DSF targets keep two numbers. */
void hl_plan_two16(struct hl_plan *, const struct hl_ask *,
                   const struct hl_profile_format *);
/* Steps from 0 to 1 of a channel of a 16-bit pair. */
float hl_plan_pair_steps(uint32_t two16);
/* Scales of an L-buffer of fixed range, 0 < range; gives its error. */
float hl_plan_light_range(struct hl_plan *, const struct hl_ask *,
                          const struct hl_profile_format *, uint32_t blends);
/* Decals, by what the geometry pass has for targets; `normal` NONE: there is
 * no normal target. */
void hl_plan_decals(struct hl_plan *, const struct hl_ask *,
                    enum hl_format normal);
/* The light pass's depth: in place, bound as well, or copied. Adds the copy's
 * target and pass. */
enum hl_refusal hl_plan_depth_read(struct hl_plan *, const struct hl_ask *);
/* Bytes a frame that are copied so that targets can be read. */
double hl_plan_resolves(struct hl_plan *, const struct hl_ask *);

/* edram.c: place all targets, or refuse with reasons and, when the L-buffer's
 * size is the planner's, a size that fits in *fit_width, *fit_height (else 0).
 * Nothing on machines without EDRAM. */
enum hl_refusal hl_plan_edram(struct hl_plan *, const struct hl_ask *,
                              uint32_t *fit_width, uint32_t *fit_height);

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
/* The same where `range` of a fixed point format stands for the peak. */
float hl_range_error(enum hl_format, float range, uint32_t terms);
/* 8-bit sRGB codes that one rounding to a fixed point L-buffer, 1 in which
 * stands for `peak`, moves a white surface in the dark; 0 for floats. */
float hl_dark_codes(enum hl_format, float peak);
/* Between codes of the first channel of a fixed point format. */
float hl_fixed_step(enum hl_format);
#endif
