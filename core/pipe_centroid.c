/* SPDX-License-Identifier: Zlib */
/* Where a multisampled material pass reads its light. */
#include "core/pipe.h"

/* At the pixel's centre, unless told otherwise, which at an edge may lie
 * outside of the triangle: the DSF then compares a depth that no surface has,
 * about a place that the surface does not cover (K 3: the filter runs once a
 * pixel). Without the DSF nothing is compared, and with one sample the centre
 * is always covered. */
void hl_plan_centroid(struct hl_plan *p, const struct hl_ask *ask)
{
    p->centroid = p->samples > 1 && !ask->n.no_centroid &&
                  p->dsf != HL_DSF_OFF;
    if (p->samples > 1)
        hl_plan_why(p, HL_WHY_CENTROID, p->centroid ? 1 : 0, 0, 0, 0);
}
