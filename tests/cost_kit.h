/* SPDX-License-Identifier: Zlib */
#ifndef COST_KIT_H
#define COST_KIT_H
/* Counted cost: what a frame really had (draws, triangles, fragments by pass,
 * blends, light evaluations), weighed with a machine's cost model. The frame
 * is drawn by packemu, which counts fragments, whatever machine it is
 * counted for; so the figure is the same on every run and has no time in it.
 */
#include "platforms/cli/setup.h"

struct ct_scene {
    struct hlc_options options;
    struct hlc_machine machine;      /* packemu                              */
    struct hlh_scene scene;
    struct hlc_world world;
    uint32_t all_lights;             /* the scene's                          */
};

struct ct_cost {
    struct hl_plan plan;
    uint32_t draws;
    uint64_t triangles;
    uint64_t geometry, light, blended, material, forward;  /* fragments;
                                      * blended: of light and forward        */
    uint64_t lights;                 /* evaluations, batches' fillers too    */
    double ns;                       /* counted                              */
    double predicted_ns;             /* plan.cost_ms                         */
};

/* A built-in scene at width x height; counting needs backend "packemu". */
bool ct_open(struct ct_scene *, const char *name, const char *backend,
             uint32_t width, uint32_t height);
void ct_close(struct ct_scene *);
/* The first n of the scene's lights; again with more if wanted. */
void ct_lights(struct ct_scene *, uint32_t n);
/* Plan by `caps` and draw once. False: no such plan. */
bool ct_count(struct ct_cost *, struct ct_scene *, enum hl_pipeline,
              const struct hl_caps *caps);

/* Wall time of frames of every pipeline, [0] not used, in turn: rounds of one
 * frame each after a first one that is not counted. */
enum { CT_ROUNDS = 31 };
struct ct_times { double median, low, high; };   /* ms; quartiles            */
bool ct_time(struct ct_times out[HL_PIPELINE_COUNT], struct ct_scene *,
             uint32_t rounds);
#endif
