/* SPDX-License-Identifier: Zlib */
/* tests/solid.frag for the software device. */
#include "platforms/packemu/pe.h"
#include "tests/solid_kernel.h"

static void shade(const struct pe_draw *draw, struct hl_pe_fragments *f)
{
    const float *color = hl_pe_uniform(draw, 0, 4 * sizeof *color);
    const float *add = draw->storage[0];
    const struct pe_texture *t = draw->view[0].texture;
    for (uint32_t i = 0; i < f->n; i++) {
        float texel[4] = { 1, 1, 1, 1 };
        if (t)
            pe_fetch(&draw->view[0], 0, f->x[i], f->y[i], texel);
        for (int c = 0; c < 4; c++)
            f->color[0][c][i] = (color ? color[c] : 0.0f) * texel[c] +
                                (add ? add[c] : 0.0f);
    }
}

static const struct hl_pe_stage stage = { shade, false, false, false };

void (*solid_kernel(void))(void)
{
    return (void (*)(void))(uintptr_t)&stage;
}
