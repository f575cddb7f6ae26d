/* SPDX-License-Identifier: Zlib */
/* shaders/material.frag: out = e + rho (A + D) + ks S, lights inferred (K
 * 2.3); and shaders/reject.frag, which counts the taps it rejects. */
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_inferred.h"
#include "platforms/packemu/pe_surface.h"

static void material(const struct pe_draw *d, struct hl_pe_fragments *f,
                     bool full)
{
    struct pe_surface s;
    float l[6][HL_PE_BATCH];
    uint32_t n = PE_LANES(f->n);
    float (*out)[HL_PE_BATCH] = f->color[0];
    pe_read_surface(d, f, full, &s);
    hl_pe_read_lights(d, f, l);
    for (int c = 0; c < 3; c++)
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = hl_min(s.base[c][i] + s.albedo[c][i] * l[c][i] +
                               s.specular[c][i] * l[3 + c][i], HL_HALF_MAX);
    for (uint32_t i = 0; i < n; i++)
        out[3][i] = s.alpha[i];
}

void pe_material_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    material(d, f, false);
}

void pe_material_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    material(d, f, true);
}

void pe_reject_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    struct pe_taps t;
    float a[4][HL_PE_BATCH];
    float (*out)[HL_PE_BATCH] = f->color[0];
    pe_find_taps(d, f, &t);
    pe_accept_taps(d, f, &t, a);
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        float n = 5.0f - (a[0][i] + a[1][i] + a[2][i] + a[3][i]);
        out[0][i] = n / 255.0f;
        out[1][i] = 0.0f;
        out[2][i] = 0.0f;
        out[3][i] = 1.0f;
    }
}

void pe_reject_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    pe_alpha_test(d, f, true);
    pe_reject_plain(d, f);
}
