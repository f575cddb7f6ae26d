/* SPDX-License-Identifier: Zlib */
/* Small stages: shaders/count.frag, depth_copy.frag, id.frag, mask.frag and
 * stipple.frag. */
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_surface.h"

static void put(struct hl_pe_fragments *f, uint32_t i, float x)
{
    f->color[0][0][i] = x;
    f->color[0][1][i] = 0.0f;
    f->color[0][2][i] = 0.0f;
    f->color[0][3][i] = 1.0f;
}

/* The number of lights stands in the first light's place. */
void pe_count(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    const hl_vec4 *data = pe_block(d, HL_SLOT_LIGHTS, sizeof *data);
    for (uint32_t i = 0; i < f->n; i++)
        put(f, i, data->x);
}

void pe_count_tiles(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    const uint32_t *tile = d->storage[HL_SLOT_TILES];
    uint32_t n = tile ? d->storage_bytes[HL_SLOT_TILES] / 8u : 0;
    int32_t size = pe_int(pe_frame(d)->misc.y);
    uint32_t row = pe_uint(pe_frame(d)->misc.z);
    size = size > 0 ? size : 1;
    for (uint32_t i = 0; i < f->n; i++) {
        uint32_t t = (uint32_t)(f->y[i] / size) * row +
                     (uint32_t)(f->x[i] / size);
        put(f, i, t < n ? (float)tile[2 * t + 1] : 0.0f);
    }
}

void pe_depth_copy(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    bool barg = pe_spec_uint(d, HL_SPEC_DEPTH_READ) == HL_DEPTH_READ_BARG;
    for (uint32_t i = 0; i < f->n; i++) {
        float c[4];
        pe_fetch(&d->view[HL_TEX_DEPTH], 0, f->x[i], f->y[i], c);
        put(f, i, barg ? hl_depth_barg(hl_v3(c[0], c[1], c[2])) : c[0]);
    }
}

/* The bits of a number in the target: object above, normal group below. */
void pe_id_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    hl_vec4 ids = pe_object(d)->ids;
    uint32_t object = ((uint32_t)ids.y + 1u) << 16;
    for (uint32_t i = 0; i < f->n; i++) {
        float group = f->vary[HL_PE_ID][i] - ids.x;
        put(f, i, pe_float(object | ((uint32_t)group & 0xffffu)));
    }
}

void pe_id_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    pe_alpha_test(d, f, true);
    pe_id_plain(d, f);
}

void pe_mask(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    pe_alpha_test(d, f, true);
}

static void stipple(const struct pe_draw *d, struct hl_pe_fragments *f,
                    bool full)
{
    float code = (pe_object(d)->flat_ids.z + 1.0f) / 255.0f;
    pe_alpha_test(d, f, full);
    pe_stipple_test(d, f);
    for (uint32_t i = 0; i < f->n; i++)
        put(f, i, code);
}

void pe_stipple_plain(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    stipple(d, f, false);
}

void pe_stipple_full(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    stipple(d, f, true);
}
