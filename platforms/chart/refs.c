/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/refs.h"
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/flicker.h"
#include "platforms/reference/reference.h"

/* Shadows are not charted: no way draws them. */
static bool draw(struct hlh_picture *out, uint32_t *ids, struct hlt_refs *r,
                 uint32_t samples, const float jitter[2], const char **why)
{
    struct hlr_options o;
    struct hlr_stats stats;
    size_t n = (size_t)r->width * r->height;
    *why = "out of memory";
    if (!r->prepared)
        r->prepared = hlr_prepare(r->scene, why);
    if (!r->prepared)
        return false;
    memset(&o, 0, sizeof o);
    o.width = r->width;
    o.height = r->height;
    o.samples = samples;
    o.normal_maps = true;
    o.jitter[0] = (double)jitter[0];
    o.jitter[1] = (double)jitter[1];
    *out = (struct hlh_picture){ r->width, r->height,
                                 malloc(n * 3 * sizeof(float)), true };
    *why = "the reference renderer refused the camera, or memory is out";
    if (out->rgb && hlr_draw(out->rgb, ids, r->prepared, &o, &stats))
        return true;
    hlh_picture_free(out);
    return false;
}

const struct hlh_picture *hlt_ref(struct hlt_refs *r, uint32_t samples,
                                  const char **why)
{
    static const float still[2] = { 0, 0 };
    int i = samples >= 8 ? 3 : samples >= 4 ? 2 : samples >= 2 ? 1 : 0;
    size_t n = (size_t)r->width * r->height;
    if (r->still[i].rgb)
        return &r->still[i];
    if (!r->ids)
        r->ids = malloc(n * sizeof *r->ids);
    return r->ids && draw(&r->still[i], r->ids, r, 1u << i, still, why)
           ? &r->still[i] : NULL;
}

const struct hlh_picture *hlt_ref_drift(struct hlt_refs *r, uint32_t t,
                                        const char **why)
{
    float jitter[2];
    if (r->drift[t].rgb)
        return &r->drift[t];
    hlc_flicker_jitter(jitter, t, HLT_DRIFT_STEPS);
    return draw(&r->drift[t], NULL, r, 1, jitter, why) ? &r->drift[t] : NULL;
}

void hlt_refs_free(struct hlt_refs *r)
{
    for (int i = 0; i < 4; i++)
        hlh_picture_free(&r->still[i]);
    for (int i = 0; i < HLT_DRIFT; i++)
        hlh_picture_free(&r->drift[i]);
    if (r->prepared)
        hlr_prepared_free(r->prepared);
    free(r->ids);
    memset(r, 0, sizeof *r);
}
