/* SPDX-License-Identifier: Zlib */
#ifndef PE_KERNEL_H
#define PE_KERNEL_H
/* What the kernels share: loops over fragments around the inline functions
 * of shaders/shared, in the device's own arithmetic. Include it first. */
#ifdef HL_LANG_H
#error "pe_kernel.h goes before all that includes shaders/shared/lang.h"
#endif
#define HL_LANG_MATH "platforms/packemu/pe_math.h"
#include "shaders/shared/block.h"
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "platforms/packemu/pe.h"

/* Loops run over whole vectors, so that no slow tail is left; HL_PE_BATCH,
 * PE_RUN and PE_LIGHT_RUN are multiples of this. What the lanes beyond n hold
 * is arbitrary: no loop over them may convert it to an integer. */
#define PE_LANES(n) (((n) + 15u) & ~15u)

/* For loops that are made several times with other constants: a copy that is
 * not expanded in place would keep the branches. */
#ifdef __GNUC__
#define PE_INLINE static inline __attribute__((always_inline))
#else
#define PE_INLINE static inline
#endif

/* A uniform range, or zeros where the draw has none as long. */
const void *pe_block(const struct pe_draw *, uint32_t slot, size_t bytes);

static inline const struct hl_frame_block *pe_frame(const struct pe_draw *d)
{
    return pe_block(d, HL_SLOT_FRAME, sizeof(struct hl_frame_block));
}

static inline const struct hl_object_block *pe_object(const struct pe_draw *d)
{
    return pe_block(d, HL_SLOT_OBJECT, sizeof(struct hl_object_block));
}

static inline const struct hl_material_block *
pe_material(const struct pe_draw *d)
{
    return pe_block(d, HL_SLOT_MATERIAL, sizeof(struct hl_material_block));
}

static inline uint32_t pe_spec_uint(const struct pe_draw *d, uint32_t id)
{
    return d->program->spec[id].u;
}

static inline float pe_spec_float(const struct pe_draw *d, uint32_t id)
{
    return d->program->spec[id].f;
}

/* One over the root, as the stages' inversesqrt: two roundings. */
static inline float pe_rsqrt(float x) { return 1.0f / sqrtf(x); }

/* The rows of pe_kernels.c. */
void pe_vertex_mesh(const struct pe_draw *, struct pe_vertices *);
void pe_vertex_volume(const struct pe_draw *, struct pe_vertices *);
void pe_gbuffer_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_gbuffer_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_gbuffer_plain_exp(const struct pe_draw *, struct hl_pe_fragments *);
void pe_gbuffer_full_exp(const struct pe_draw *, struct hl_pe_fragments *);
void pe_gbuffer_plain_motion(const struct pe_draw *,
                             struct hl_pe_fragments *);
void pe_gbuffer_full_motion(const struct pe_draw *, struct hl_pe_fragments *);
void pe_gbuffer_plain_exp_motion(const struct pe_draw *,
                                 struct hl_pe_fragments *);
void pe_gbuffer_full_exp_motion(const struct pe_draw *,
                                struct hl_pe_fragments *);
void pe_light_batch(const struct pe_draw *, struct hl_pe_fragments *);
void pe_light_tiles(const struct pe_draw *, struct hl_pe_fragments *);
void pe_light_batch_rect(const struct pe_draw *, const struct hl_rect *,
                         float (*out)[PE_BIN * PE_BIN]);
void pe_light_tiles_rect(const struct pe_draw *, const struct hl_rect *,
                         float (*out)[PE_BIN * PE_BIN]);
void pe_light_map(const struct pe_draw *, struct hl_pe_fragments *);
void pe_light_map_rect(const struct pe_draw *, const struct hl_rect *,
                       float (*out)[PE_BIN * PE_BIN]);
void pe_material_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_material_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_reject_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_reject_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_forward_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_forward_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_forward_list_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_forward_list_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_count(const struct pe_draw *, struct hl_pe_fragments *);
void pe_count_tiles(const struct pe_draw *, struct hl_pe_fragments *);
void pe_conform(const struct pe_draw *, struct hl_pe_fragments *);
void pe_depth_copy(const struct pe_draw *, struct hl_pe_fragments *);
void pe_id_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_id_full(const struct pe_draw *, struct hl_pe_fragments *);
void pe_mask(const struct pe_draw *, struct hl_pe_fragments *);
void pe_stipple_plain(const struct pe_draw *, struct hl_pe_fragments *);
void pe_stipple_full(const struct pe_draw *, struct hl_pe_fragments *);
#endif
