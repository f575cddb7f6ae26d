/* SPDX-License-Identifier: Zlib */
/* shaders/forward.frag: emission and ambient, and a batch of lights or all
 * of an object's. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_lights.h"
#include "platforms/packemu/pe_surface.h"

static void surface_points(const struct pe_draw *d,
                           const struct hl_pe_fragments *f, bool full,
                           const struct pe_surface *s, struct pe_lit_run *r)
{
    float n[3][HL_PE_BATCH];
    r->n = PE_LANES(f->n);
    pe_read_normal(d, f, full, n);
    memcpy(r->nx, n[0], sizeof n[0]);
    memcpy(r->ny, n[1], sizeof n[1]);
    memcpy(r->nz, n[2], sizeof n[2]);
    memcpy(r->px, f->vary[HL_PE_PX], sizeof n[0]);
    memcpy(r->py, f->vary[HL_PE_PY], sizeof n[0]);
    memcpy(r->pz, f->vary[HL_PE_PZ], sizeof n[0]);
    for (uint32_t i = 0; i < r->n; i++)
        r->half_n[i] = s->exponent[i] * 0.5f;
    pe_lit_begin(r);
    r->brdfs = pe_spec_uint(d, HL_SPEC_BRDFS) != 0;
    float brdf = pe_object(d)->flat_ids.w;
    for (uint32_t i = 0; r->brdfs && i < r->n; i++)
        r->brdf[i] = brdf;
}

static void put(const struct pe_draw *d, struct hl_pe_fragments *f,
                const struct pe_surface *s, const struct pe_lit_run *r)
{
    float base = pe_spec_uint(d, HL_SPEC_BASE) != 0 ? 1.0f : 0.0f;
    float (*out)[HL_PE_BATCH] = f->color[0];
    for (int c = 0; c < 3; c++)
        for (uint32_t i = 0; i < r->n; i++) {
            float light = s->albedo[c][i] * r->diffuse[c][i] +
                          s->specular[c][i] * r->specular[c][i];
            out[c][i] = hl_min(s->base[c][i] * base + light, HL_HALF_MAX);
        }
    memcpy(out[3], s->alpha, sizeof s->alpha);
}

static void forward(const struct pe_draw *d, struct hl_pe_fragments *f,
                    bool full, struct pe_lit_list list)
{
    struct pe_surface s;
    struct pe_lit_run r;
    bool specular = pe_spec_uint(d, HL_SPEC_SPECULAR) != HL_SPECULAR_NONE;
    pe_read_surface(d, f, full, &s);
    surface_points(d, f, full, &s, &r);
    pe_lit_add(&r, specular ? PE_LIT_COLOR : PE_LIT_NONE,
               pe_spec_uint(d, HL_SPEC_KINDS),
               pe_spec_uint(d, HL_SPEC_FALLOFF), list.light, list.count);
    put(d, f, &s, &r);
}

static struct pe_lit_list object_list(const struct pe_draw *d)
{
    hl_vec4 ids = pe_object(d)->ids;
    return pe_lit_list(d, pe_uint(ids.z), pe_uint(ids.w));
}

void pe_forward_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    forward(d, f, false, pe_lit_batch(d));
}

void pe_forward_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    forward(d, f, true, pe_lit_batch(d));
}

void pe_forward_list_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    forward(d, f, false, object_list(d));
}

void pe_forward_list_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    forward(d, f, true, object_list(d));
}
