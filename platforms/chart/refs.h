/* SPDX-License-Identifier: Zlib */
#ifndef HLT_REFS_H
#define HLT_REFS_H
/* Pictures of the reference renderer, each drawn when it is first asked for:
 * they are the same for every machine and way. */
#include "platforms/host/image.h"
#include "platforms/host/scene.h"

enum { HLT_DRIFT = 8, HLT_DRIFT_STEPS = 16 };  /* frames; a pixel            */

struct hlt_refs {
    const struct hlh_scene *scene;   /* borrowed                             */
    uint32_t width, height;
    struct hlr_prepared *prepared;
    struct hlh_picture still[4];     /* of 1, 2, 4, 8 samples                */
    struct hlh_picture drift[HLT_DRIFT]; /* one sample, jittered             */
    uint32_t *ids;               /* a pixel, as hlr_draw's                   */
};

/* NULL where the scene or memory is not: *why, a static string. */
const struct hlh_picture *hlt_ref(struct hlt_refs *, uint32_t samples,
                                  const char **why);
/* Frame t < HLT_DRIFT of hlc_flicker_jitter. */
const struct hlh_picture *hlt_ref_drift(struct hlt_refs *, uint32_t t,
                                        const char **why);
void hlt_refs_free(struct hlt_refs *);
#endif
