/* SPDX-License-Identifier: Zlib */
/* The rows of shaders/variants.def as kernels, and what kernels and stages
 * of an embedder's own read through. */
#include "platforms/packemu/pe_kernel.h"

const void *hl_pe_uniform(const struct pe_draw *d, uint32_t slot,
                          size_t bytes)
{
    if (slot >= HL_MAX_UNIFORMS || d->uniform_bytes[slot] < bytes)
        return NULL;
    return d->uniform[slot];
}

const void *pe_block(const struct pe_draw *d, uint32_t slot, size_t bytes)
{
    static const hl_vec4 zeros[sizeof(struct hl_object_block) / 16];
    const void *p = hl_pe_uniform(d, slot, bytes);
    return p ? p : zeros;
}

void hl_pe_sample(const struct pe_draw *d, uint32_t slot,
                  const struct hl_pe_fragments *f, const float *u,
                  const float *v, float out[4][HL_PE_BATCH])
{
    static const struct pe_view white;
    const struct pe_view *view = slot < HL_MAX_TEXTURES ? &d->view[slot]
                                                        : &white;
    pe_sample(view, u, v, f->duv, f->n, out);
}

/* ---- vertex stages ------------------------------------------------------- */

#define A(name) (1u << HL_ATTR_##name)
#define V(name) (1u << HL_PE_##name)
#define V_NORMAL (V(NX) | V(NY) | V(NZ))
#define V_UV (V(U) | V(V) | V(R) | V(G) | V(B) | V(A))
#define V_TANGENT (V(TX) | V(TY) | V(TZ) | V(TW))
#define V_POSITION (V(PX) | V(PY) | V(PZ))
#define V_MOTION (V(MX) | V(MY) | V(MW) | V(LX) | V(LY) | V(LW))
#define A_UV (A(UV) | A(COLOR))
#define MESH(attrs, vary) { pe_vertex_mesh, A(POSITION) | (attrs), vary }

const struct pe_vertex_kernel pe_vertex_kernels[HL_SHADER_COUNT] = {
    [HL_SHADER_MESH_ID_VERT] = MESH(A(TANGENT), V(ID)),
    [HL_SHADER_MESH_UV_ID_VERT] = MESH(A(TANGENT) | A_UV, V(ID) | V_UV),
    [HL_SHADER_MESH_GBUFFER_VERT] = MESH(A(TANGENT) | A(NORMAL),
                                         V(ID) | V_NORMAL),
    [HL_SHADER_MESH_GBUFFER_FULL_VERT] = MESH(
        A(TANGENT) | A(NORMAL) | A_UV, V(ID) | V_NORMAL | V_UV | V_TANGENT),
    [HL_SHADER_MESH_GBUFFER_MOTION_VERT] = MESH(
        A(TANGENT) | A(NORMAL), V(ID) | V_NORMAL | V_MOTION),
    [HL_SHADER_MESH_GBUFFER_FULL_MOTION_VERT] = MESH(
        A(TANGENT) | A(NORMAL) | A_UV,
        V(ID) | V_NORMAL | V_UV | V_TANGENT | V_MOTION),
    [HL_SHADER_MESH_MATERIAL_VERT] = MESH(A(TANGENT), V(ID)),
    [HL_SHADER_MESH_UV_ID_CENTROID_VERT] = MESH(A(TANGENT) | A_UV,
                                                V(ID) | V_UV),
    [HL_SHADER_MESH_MATERIAL_CENTROID_VERT] = MESH(A(TANGENT), V(ID)),
    [HL_SHADER_MESH_OWN_VERT] = MESH(
        A(TANGENT) | A(NORMAL) | A_UV,
        V(ID) | V_NORMAL | V_UV | V_TANGENT | V_POSITION),
    [HL_SHADER_MESH_DEPTH_VERT] = MESH(0, 0),
    [HL_SHADER_VOLUME_VERT] = { pe_vertex_volume, A(POSITION), 0 },
    [HL_SHADER_MESH_FORWARD_VERT] = MESH(A(NORMAL), V_NORMAL | V_POSITION),
    [HL_SHADER_MESH_FORWARD_FULL_VERT] = MESH(
        A(TANGENT) | A(NORMAL) | A_UV,
        V_NORMAL | V_UV | V_TANGENT | V_POSITION),
};

/* ---- fragment stages ----------------------------------------------------- */

/* slope; uv_slope and discards of FULL stages, which are textured. */
#define PLAIN(shade, slope, vary) \
    { { shade, slope, false, false }, NULL, vary, false }
#define FULL(shade, slope, vary) \
    { { shade, slope, true, true }, NULL, vary, false }
/* Passes at L-buffer size: masks and patterns. */
#define SMALL(shade, full, vary) \
    { { shade, false, full, true }, NULL, vary, true }
#define RECT(shade, rect) \
    { { shade, false, false, false }, rect, 0, false }
#define V_FULL (V_NORMAL | V_UV | V_TANGENT)

const struct pe_fragment_kernel pe_fragment_kernels[HL_SHADER_COUNT] = {
    [HL_SHADER_GBUFFER_PLAIN_FRAG] =
        SMALL(pe_gbuffer_plain, false, V(ID) | V_NORMAL),
    [HL_SHADER_GBUFFER_PLAIN_EXP_FRAG] =
        SMALL(pe_gbuffer_plain_exp, false, V(ID) | V_NORMAL),
    [HL_SHADER_GBUFFER_FULL_FRAG] =
        SMALL(pe_gbuffer_full, true, V(ID) | V_FULL),
    [HL_SHADER_GBUFFER_FULL_EXP_FRAG] =
        SMALL(pe_gbuffer_full_exp, true, V(ID) | V_FULL),
    [HL_SHADER_GBUFFER_PLAIN_MOTION_FRAG] =
        SMALL(pe_gbuffer_plain_motion, false, V(ID) | V_NORMAL | V_MOTION),
    [HL_SHADER_GBUFFER_PLAIN_EXP_MOTION_FRAG] = SMALL(
        pe_gbuffer_plain_exp_motion, false, V(ID) | V_NORMAL | V_MOTION),
    [HL_SHADER_GBUFFER_FULL_MOTION_FRAG] =
        SMALL(pe_gbuffer_full_motion, true, V(ID) | V_FULL | V_MOTION),
    [HL_SHADER_GBUFFER_FULL_EXP_MOTION_FRAG] =
        SMALL(pe_gbuffer_full_exp_motion, true, V(ID) | V_FULL | V_MOTION),
    [HL_SHADER_LIGHT_BATCH_FRAG] =
        RECT(pe_light_batch, pe_light_batch_rect),
    [HL_SHADER_LIGHT_FLAT_FRAG] =
        RECT(pe_light_batch, pe_light_batch_rect),
    [HL_SHADER_LIGHT_TILES_FRAG] =
        RECT(pe_light_tiles, pe_light_tiles_rect),
    [HL_SHADER_LIGHT_MAP_FRAG] = RECT(pe_light_map, pe_light_map_rect),
    [HL_SHADER_MATERIAL_PLAIN_FRAG] = PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_MATERIAL_PLAIN_TAPS_FRAG] =
        PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_TAPS_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_MATERIAL_PLAIN_FILTER_FRAG] =
        PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_FILTER_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_MATERIAL_PLAIN_FILTER_CENTROID_FRAG] =
        PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_FILTER_CENTROID_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_MATERIAL_PLAIN_CENTROID_FRAG] =
        PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_CENTROID_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_MATERIAL_PLAIN_TAPS_CENTROID_FRAG] =
        PLAIN(pe_material_plain, true, V(ID)),
    [HL_SHADER_MATERIAL_FULL_TAPS_CENTROID_FRAG] =
        FULL(pe_material_full, true, V(ID) | V_UV),
    [HL_SHADER_FORWARD_PLAIN_FRAG] =
        PLAIN(pe_forward_plain, false, V_NORMAL | V_POSITION),
    [HL_SHADER_FORWARD_FULL_FRAG] =
        FULL(pe_forward_full, false, V_FULL | V_POSITION),
    [HL_SHADER_FORWARD_LIST_PLAIN_FRAG] =
        PLAIN(pe_forward_list_plain, false, V_NORMAL | V_POSITION),
    [HL_SHADER_FORWARD_LIST_FULL_FRAG] =
        FULL(pe_forward_list_full, false, V_FULL | V_POSITION),
    [HL_SHADER_COUNT_FRAG] = PLAIN(pe_count, false, 0),
    [HL_SHADER_COUNT_TILES_FRAG] = PLAIN(pe_count_tiles, false, 0),
    [HL_SHADER_REJECT_PLAIN_FRAG] = PLAIN(pe_reject_plain, true, V(ID)),
    [HL_SHADER_REJECT_FULL_FRAG] = FULL(pe_reject_full, true, V(ID) | V_UV),
    [HL_SHADER_REJECT_PLAIN_TAPS_FRAG] = PLAIN(pe_reject_plain, true, V(ID)),
    [HL_SHADER_REJECT_FULL_TAPS_FRAG] =
        FULL(pe_reject_full, true, V(ID) | V_UV),
    [HL_SHADER_DEPTH_COPY_FRAG] = PLAIN(pe_depth_copy, false, 0),
    [HL_SHADER_CONFORM_FRAG] = PLAIN(pe_conform, false, 0),
    [HL_SHADER_ID_PLAIN_FRAG] = PLAIN(pe_id_plain, false, V(ID)),
    [HL_SHADER_ID_FULL_FRAG] = FULL(pe_id_full, false, V(ID) | V_UV),
    [HL_SHADER_MASK_FRAG] = FULL(pe_mask, false, V_UV),
    [HL_SHADER_STIPPLE_PLAIN_FRAG] = SMALL(pe_stipple_plain, false, 0),
    [HL_SHADER_STIPPLE_FULL_FRAG] = SMALL(pe_stipple_full, true, V_UV),
};
