/* SPDX-License-Identifier: Zlib */
#ifndef IMAGE_KIT_H
#define IMAGE_KIT_H
/* A built-in scene on a device beside its reference picture, and what to do
 * when the two differ. */
#include "platforms/cli/bridge.h"
#include "platforms/cli/metrics.h"
#include "tests/check.h"

struct ik_stage {
    struct ck_machine *m;
    struct hlh_scene scene;
    struct hlc_world world;
    struct hl_frame frame;
    struct hlc_options options;  /* of the plan; set choices here            */
    struct hlh_picture reference;
    uint32_t *ids;               /* of the reference: 1 + object             */
    struct hl_plan plan;         /* of the last picture                      */
};

/* The scene at w x h, drawn by the reference too. Fails the test, or skips
 * it where there is no device. */
void ik_begin(struct ik_stage *s, struct ck_machine *m, const char *scene,
              uint32_t w, uint32_t h, const struct hlc_world_options *world);
void ik_end(struct ik_stage *s);
/* Draw the reference again, with 4 samples at the standard positions. */
void ik_smooth_reference(struct ik_stage *s);

/* Draw by a pipeline; `look`, if given, is called before the renderer goes. */
struct hlh_picture ik_draw(struct ik_stage *s, enum hl_pipeline pipeline,
                           void (*look)(struct ik_stage *,
                                        struct hl_renderer *, void *),
                           void *user);

/* Compare with the reference, print one line, free the picture. */
struct hlc_metrics ik_compare(struct ik_stage *s, struct hlh_picture *picture,
                              const char *name);
/* With `ok` false write NAME.png, NAME.reference.png, NAME.difference.png
 * (16 times the difference) into build/fail, and fail. Frees the picture. */
void ik_judge(struct ik_stage *s, struct hlh_picture *picture,
              const char *name, bool ok);
#endif
