/* SPDX-License-Identifier: Zlib */
/* Shadows, and stencil volumes of lights. */
#include "core/pipe.h"

enum hl_refusal hl_plan_shadows(struct hl_plan *p, const struct hl_ask *ask)
{
    (void)p;
    (void)ask;
    return HL_REFUSED_NOTHING;
}
