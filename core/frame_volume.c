/* SPDX-License-Identifier: Zlib */
/* Stencil volumes of lights and of their shadows. */
#include "core/renderer.h"

void hl_volumes_carve(struct hl_carve *c, struct hl_renderer *r,
                      const struct hl_renderer_desc *d)
{
    (void)c;
    (void)r;
    (void)d;
}

enum hl_result hl_volumes_make(struct hl_renderer *r)
{
    (void)r;
    return HL_OK;
}

void hl_volumes_destroy(struct hl_renderer *r) { (void)r; }

void hl_volumes_lights(struct hl_renderer *r, const struct hl_frame *f)
{
    (void)r;
    (void)f;
}

void hl_volumes_shadowed(struct hl_renderer *r, const struct hl_frame *f)
{
    (void)r;
    (void)f;
}
