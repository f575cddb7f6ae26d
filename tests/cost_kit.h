/* SPDX-License-Identifier: Zlib */
#ifndef COST_KIT_H
#define COST_KIT_H
/* Counted cost (platforms/chart/count.h) and times of the pipelines, for any
 * number of a scene's lights. */
#include "platforms/chart/count.h"

struct ct_scene {
    struct hlc_options options;
    struct hlc_stage stage;          /* packemu, for counting                */
    uint32_t all_lights;             /* the scene's                          */
};

struct ct_cost {
    struct hl_plan plan;
    struct hlt_counts of;
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
