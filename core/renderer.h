/* SPDX-License-Identifier: Zlib */
#ifndef HL_RENDERER_H
#define HL_RENDERER_H
/* Private to core: what frame*.c share. These files alone call a device. */
#include "core/frame.h"
#include "core/light.h"
#include "core/stipple.h"

/* A surface's programs. */
enum {
    PROG_GBUFFER, PROG_MATERIAL, PROG_BASE, PROG_MORE, PROG_BLENDED,
    PROG_ID, PROG_REJECT, PROG_COUNT_BASE, PROG_COUNT_MORE,
    PROG_STIPPLE_GBUFFER,    /* geometry pass of what is translucent         */
    PROG_STIPPLE_MATERIAL,   /* its blended material pass                    */
    PROG_DECAL_GBUFFER, PROG_DECAL_MATERIAL,
    PROG_SHADOW_DEPTH,       /* into a shadow map                            */
    PROG_STIPPLE_ID,         /* HL_INSPECT_STIPPLE                           */
    PROG_KINDS
};

/* Light draws come in four sizes, so that a tile of five lights does not
 * shade sixteen; index [size][adds to what is there]. */
enum { LIGHT_SIZES = 4 };

/* Uniform data of a frame is gathered on the host and written once a stage. */
struct hl_arena {
    uint8_t *bytes;
    uint32_t size, used, flushed, align;
    bool full;
};

/* Three: two frames may be submitted while the third is prepared. */
enum { FRAMES = 3 };

struct hl_visible {
    uint32_t item, surface;
    float z;                 /* nearest depth of its box                     */
    struct hl_box box;
    uint32_t object, material, material_bytes; /* offsets in the arena       */
    uint32_t list_first, list_count;           /* of a blended item          */
    uint32_t motion;                           /* offset of hl_motion_block  */
    uint8_t pattern;         /* 0 opaque, 1..15, or HL_STIPPLE_NONE          */
};

/* frame_stipple.c: patterns of a frame. Carved where plan.stipple. */
struct hl_stippling {
    struct hl_stipple *assigner;
    struct hl_stipple_object *objects;
    struct hl_stipple_outline *outlines;
    uint8_t *patterns;
    uint32_t max_objects, n; /* n: of the last frame                         */
    bool again;              /* the last frame once more: patterns stay      */
    struct hl_stipple_stats stats;
};

/* frame_volume.c: stencil volumes of lights and of shadows. */
struct hl_volumes {
    hl_buf vertex, index;    /* meshes of light volumes (light_volume.h)     */
    hl_buf shadow_index[3];  /* FRAMES; shadow volumes' indices              */
    uint32_t *indices;       /* of a frame, on the host                      */
    uint32_t max_indices, n_indices;
    void *scratch;
    size_t scratch_bytes;
    hl_prog mark;            /* light volume to stencil                      */
    hl_prog shadow[2];       /* shadow volume to stencil; [1]: mirrored      */
    hl_prog light;           /* where the light volume's stencil is          */
    hl_prog shadowed;        /* where no shadow's stencil is                 */
};

/* frame_map.c: shadow maps. */
struct hl_caster {
    struct hl_box box;
    uint32_t item;
    uint32_t material, material_bytes; /* offset in the arena; 0 bytes: not
                                        * there yet                          */
    uint8_t faces;           /* of the light at hand, a bit a map: is on it  */
};
struct hl_maps {
    hl_prog light[4];        /* one light through its maps, by HL_MAP_*      */
    struct hl_caster *casters;   /* n of this frame, whether seen or not     */
    uint32_t n;
    struct hl_texture_binding (*textures)[HL_TEX_MESH_COUNT]; /* of each     */
};

struct hl_renderer {
    struct hl_device *device;
    struct hl_plan plan;
    uint32_t n_surfaces, max_items, max_lights, max_draws, max_refs;
    struct hl_surface *surfaces;
    hl_prog (*prog)[PROG_KINDS];
    hl_tex target[HL_ROLE_COUNT];
    hl_tex inspect_color, inspect_depth;
    hl_prog light_prog[LIGHT_SIZES][2], list_prog, count_prog, count_tiles;
    hl_prog depth_copy;
    hl_buf uniform[FRAMES], list[FRAMES], tiles[FRAMES];
    uint32_t frame;          /* which of FRAMES                              */
    struct hl_arena arena, lists;
    uint32_t frame_offset;   /* of hl_frame_block in the arena               */

    /* Scratch of one frame. */
    /* Lights without shadows first: n_plain of them. */
    struct hl_lit_sphere *spheres;
    uint32_t n_plain, n_spheres;
    struct hl_visible *visible;    /* opaque, then decals, then blended      */
    uint32_t n_opaque, n_decals, n_visible;    /* opaque, decals, blended    */
    /* [0] for passes that make the light, [1] for those that read it. */
    struct hl_texture_binding (*textures)[2][HL_TEX_MESH_COUNT];
    struct hl_texture_binding light_textures[4];
    struct hl_stippling stippling;
    struct hl_volumes volumes;
    struct hl_maps maps;
    /* hl_view_set: where this frame's picture lies. Draws of meshes and
     * screens get the scissors by themselves (width 0: the whole target). */
    struct hl_span span;     /* of the L-buffer                              */
    struct hl_span frame_span;
    struct hl_rect light_scissor, frame_scissor;
    struct hl_camera wide;   /* sees all that is drawn: for culling          */
    float wide_aspect;
    struct hl_draw *draws;
    uint32_t n_draws;
    uint32_t *tile_first, *refs;
    float *tile_z0, *tile_z1, *depth_read;
    uint32_t *tile_heads;
    struct hl_tile_grid grid;
    struct hl_frame_stats stats;
    /* Pass under construction: draws beyond max_draws go out early. */
    struct hl_pass pass;
    bool counting;           /* draw light counts in place of light          */
    enum hl_format count_format;   /* blendable; a light counts as 1 /      */
    float count_steps;             /* count_steps of its range               */
    enum hl_result result;
};

/* frame_data.c: how an item of a surface is drawn by this plan. */
enum hl_class { HL_CLASS_OPAQUE, HL_CLASS_DECAL, HL_CLASS_BLENDED };
enum hl_class hl_surface_class(const struct hl_renderer *, uint32_t surface);

/* frame_program.c */
/* A plan's pass of a role; NULL where it has none. */
const struct hl_plan_pass *hl_plan_pass(const struct hl_plan *,
                                        enum hl_pass_role);
/* Lights of size class i. */
uint32_t hl_light_size(const struct hl_plan *, uint32_t i);
hl_prog hl_light_program(struct hl_renderer *, uint32_t lights, bool add,
                         uint32_t *size);
enum hl_result hl_surface_program(struct hl_renderer *, uint32_t surface,
                                  int kind, hl_prog *out);
enum hl_result hl_screen_program(struct hl_renderer *, enum hl_shader fragment,
                                 enum hl_format color, enum hl_blend blend,
                                 uint32_t batch, hl_prog *out);

/* One light a draw, added where `face`, which both faces get, lets it pass;
 * for the plan's pass of that role. */
enum hl_result hl_light_stencil_program(struct hl_renderer *,
                                        enum hl_pass_role,
                                        const struct hl_stencil_face *,
                                        hl_prog *out);
/* Half a texel of the L-buffer, where vertex stages shift by it. */
void hl_shift_specs(const struct hl_plan *, struct hl_prog_desc *);
/* One light through shadow maps of a kind, HL_MAP_*; the plan has maps. */
enum hl_result hl_map_program(struct hl_renderer *, uint32_t kind,
                              hl_prog *out);

/* All that frames draw with; those of hl_frame_inspect come on first use. */
enum hl_result hl_programs_make(struct hl_renderer *);

/* frame_inspect.c */
void hl_inspect_set_up(struct hl_renderer *);

/* frame_data.c: check, cull and gather; HL_OK or why not. */
enum hl_result hl_frame_gather(struct hl_renderer *, const struct hl_frame *);
uint32_t hl_arena_put(struct hl_arena *, const void *data, uint32_t bytes);
/* Write what was gathered since the last flush. */
enum hl_result hl_frame_flush(struct hl_renderer *);
/* Object block of a visible item. */
void hl_gather_object(struct hl_renderer *, const struct hl_frame *,
                      struct hl_visible *);
/* Material block of an item. */
void hl_gather_material(struct hl_renderer *, const struct hl_item *,
                        struct hl_visible *);

/* frame_view.c: spans, scissors and the wide camera of a frame; checked. */
void hl_view_set(struct hl_renderer *, const struct hl_frame *);
/* View to clip: y down, z in 0..w (hal.h's convention). Everything that meets
 * the frame's depth is jittered. */
void hl_view_to_clip(const struct hl_renderer *, const struct hl_camera *,
                     bool jittered, float out[16]);
/* Stored depth d is that of view z = x / (d + y), z > 0; finite for the clear
 * value too. */
void hl_depth_terms(const struct hl_renderer *, const struct hl_camera *,
                    float *x, float *y);

/* Every part: carve its memory, make and destroy what it has of a device. */
struct hl_carve;
void *hl_carve(struct hl_carve *, size_t count, size_t bytes);
void hl_stippling_carve(struct hl_carve *, struct hl_renderer *,
                        const struct hl_renderer_desc *);
void hl_volumes_carve(struct hl_carve *, struct hl_renderer *,
                      const struct hl_renderer_desc *);
enum hl_result hl_volumes_make(struct hl_renderer *);
void hl_volumes_destroy(struct hl_renderer *);
void hl_maps_carve(struct hl_carve *, struct hl_renderer *,
                   const struct hl_renderer_desc *);
enum hl_result hl_maps_make(struct hl_renderer *);
void hl_maps_destroy(struct hl_renderer *);

/* frame_stipple.c: a pattern for every visible blended item. */
enum hl_result hl_stippling_assign(struct hl_renderer *,
                                   const struct hl_frame *);
/* frame_volume.c: lights of HL_LIGHT_PATH_VOLUMES, in an open light pass;
 * and passes of their own for all lights with shadows, by stencil. */
void hl_volumes_lights(struct hl_renderer *, const struct hl_frame *);
void hl_volumes_shadowed(struct hl_renderer *, const struct hl_frame *);
/* frame_map.c: the same by shadow maps. */
void hl_maps_shadowed(struct hl_renderer *, const struct hl_frame *);

/* frame.c */
struct hl_draw *hl_draw_begin(struct hl_renderer *);
/* An item's buffers and its surface's program, nothing bound. */
struct hl_draw *hl_draw_item(struct hl_renderer *, const struct hl_item *,
                             int kind);
struct hl_draw *hl_draw_mesh(struct hl_renderer *, const struct hl_frame *,
                             uint32_t visible, int kind);
void hl_bind_uniform(struct hl_renderer *, struct hl_draw *, int slot,
                     uint32_t offset, uint32_t bytes);
void hl_bind_list(struct hl_renderer *, struct hl_draw *);
void hl_draw_lights(struct hl_renderer *, struct hl_draw *, uint32_t offset);
void hl_pass_begin(struct hl_renderer *, const char *label);
void hl_pass_color(struct hl_renderer *, hl_tex, enum hl_load,
                   const float clear[4]);
void hl_pass_depth(struct hl_renderer *, hl_tex, enum hl_load, bool read_only);
void hl_pass_end(struct hl_renderer *);
/* frame_light.c */
/* Lights `refs` (of spheres) as a block of `size`, at most HL_BATCH_MAX. */
uint32_t hl_put_batch(struct hl_renderer *, const struct hl_frame *,
                      const uint32_t *refs, uint32_t n, uint32_t size);
struct hl_draw *hl_draw_screen(struct hl_renderer *, hl_prog,
                               const struct hl_rect *);
/* Textures of passes that make light. */
void hl_light_pass_textures(struct hl_renderer *);
void hl_emit_light_pass(struct hl_renderer *, const struct hl_frame *);
void hl_emit_forward(struct hl_renderer *, const struct hl_frame *);
enum hl_result hl_build_tiles(struct hl_renderer *, const struct hl_frame *);
#endif
