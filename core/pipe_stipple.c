/* SPDX-License-Identifier: Zlib */
/* How translucent surfaces are lit (K 4). */
#include "core/pipe.h"

enum hl_refusal hl_plan_translucency(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    (void)p;
    (void)ask;
    return HL_REFUSED_NOTHING;
}
