/* SPDX-License-Identifier: Zlib */
/* Patterns of a frame's translucent items (core/stipple.h). */
#include "core/renderer.h"

void hl_stippling_carve(struct hl_carve *c, struct hl_renderer *r,
                        const struct hl_renderer_desc *d)
{
    (void)c;
    (void)r;
    (void)d;
}

enum hl_result hl_stippling_assign(struct hl_renderer *r,
                                   const struct hl_frame *f)
{
    (void)r;
    (void)f;
    return HL_OK;
}
