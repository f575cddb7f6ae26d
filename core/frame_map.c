/* SPDX-License-Identifier: Zlib */
/* Shadow maps of lights, and their light. */
#include "core/renderer.h"

enum hl_result hl_maps_make(struct hl_renderer *r)
{
    (void)r;
    return HL_OK;
}

void hl_maps_destroy(struct hl_renderer *r) { (void)r; }

void hl_maps_shadowed(struct hl_renderer *r, const struct hl_frame *f)
{
    (void)r;
    (void)f;
}
