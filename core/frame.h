/* SPDX-License-Identifier: Zlib */
#ifndef HL_FRAME_H
#define HL_FRAME_H
/* Runs a plan on a device. A renderer owns the plan's targets and programs;
 * an engine's meshes and textures stay its own. Order of use: hl_plan_make,
 * hl_renderer_create, then for each frame hl_frame_draw and hl_submit. */
#include "core/plan.h"
#include "core/scene.h"

struct hl_renderer;

struct hl_renderer_desc {
    const struct hl_plan *plan;
    const struct hl_surface *surfaces;  /* copied, but for own_material code */
    uint32_t n_surfaces;
    uint32_t max_items;      /* required, > 0                                */
    uint32_t max_lights;     /* of a frame; 0 = 1024                         */
    size_t frame_bytes;      /* uniform data of a frame; 0: by the two above */
    size_t list_bytes;       /* light lists of a frame; 0: likewise          */
    bool readback;           /* targets can be read by hl_tex_read           */
    uint32_t shadow_indices; /* room for shadow volumes, 16 bytes an index,
                              * where plan.shadows is VOLUMES; 0 = 2^20. One
                              * object's volume must fit: as many as 6 a
                              * triangle and 6 an edge of its outline. With
                              * less than a frame's volumes take the frame
                              * waits for the device each time it is full    */
};

/* Host memory a renderer needs; 0 when the desc is invalid. */
size_t hl_renderer_bytes(const struct hl_renderer_desc *);

/* `memory`: hl_renderer_bytes(desc) bytes aligned for any type, the caller's,
 * in use until hl_renderer_destroy. Creates all targets and programs, so
 * that no frame compiles. On failure everything made is destroyed again. */
enum hl_result hl_renderer_create(struct hl_renderer **out,
                                  struct hl_device *device,
                                  const struct hl_renderer_desc *desc,
                                  void *memory);
void hl_renderer_destroy(struct hl_renderer **);

struct hl_frame_stats {
    uint32_t items, items_culled;      /* opaque and blended                 */
    uint32_t lights, lights_culled;    /* lights: those drawn                */
    uint32_t draws, blends;            /* blends: draws that blend           */
    uint32_t light_refs;               /* entries of all light lists         */
    uint32_t stippled;                 /* translucent items with a pattern   */
    uint32_t unstippled;               /* without: lit forward, all lights but
                                        * no shadows                         */
    uint32_t stipple_conflicts;        /* overlapping pairs of one pattern   */
    uint32_t stipple_changes;          /* items with another than last frame */
    uint32_t decals;
    uint32_t light_volumes;            /* lights drawn through a stencil     */
    uint32_t shadow_lights;            /* lights drawn with shadows          */
    uint32_t shadow_casters;           /* pairs of light and caster drawn    */
    uint32_t shadow_triangles;         /* of volumes and into maps           */
    float light_peak;                  /* bound of summed light, inferred    */
    bool light_may_clip;               /* the peak is above what the L-buffer
                                        * of the plan holds (plan.light_scale,
                                        * 65,504 for 16-bit floats): plan
                                        * again with a larger needs.peak     */
};

/* Record the frame's passes; the caller submits. Lights and camera are
 * checked: HL_ERR_INVALID names the first bad field in the log and draws
 * nothing. HL_ERR_LIMIT: a capacity of the desc is too small. Runs of up to
 * two submitted and unfinished frames are allowed. With plan.tile_depth the
 * call submits and waits for the geometry pass. stats may be NULL. */
enum hl_result hl_frame_draw(struct hl_renderer *, const struct hl_frame *,
                             struct hl_frame_stats *stats);

/* The finished frame: linear, one sample a pixel, of several the mean before
 * any tone mapping. The whole target, of the
 * plan's size: valid are hl_frame.width x height pixels from the top left,
 * the rest is background. */
hl_tex hl_renderer_output(const struct hl_renderer *);
/* {0} where the plan has no such target. */
hl_tex hl_renderer_target(const struct hl_renderer *, enum hl_role);

/* Pictures of the inside, drawn for the frame last drawn (which must be
 * given again unchanged) and read back. Programs are made on first use. */
enum hl_inspect {
    HL_INSPECT_IDS,          /* uint32 a frame pixel: (item + 1) << 16 |
                              * normal group; 0 = background                 */
    HL_INSPECT_LIGHTS,       /* float a pixel of the shading pass: light
                              * evaluations (frame pixels, or L-buffer
                              * texels for the inferred pipeline); not above
                              * 65,535, or 255, where nothing with more
                              * codes blends                                 */
    HL_INSPECT_REJECTS,      /* uint8 a frame pixel: rejected DSF taps + 1,
                              * 0 = background; inferred pipeline only       */
    HL_INSPECT_STIPPLE       /* uint8 an L-buffer texel: 0 background, 1 opaque,
                              * 1 + pattern of what is translucent; plans with
                              * stipple only                                 */
};
/* Size of the picture; bytes = width * height * (4, 4, 1, 1). */
void hl_inspect_size(const struct hl_renderer *, enum hl_inspect,
                     uint32_t *width, uint32_t *height);
enum hl_result hl_frame_inspect(struct hl_renderer *, const struct hl_frame *,
                                enum hl_inspect, void *out, size_t bytes);

/* Needs of a frame: counts, mean lights a pixel and an object, kinds of
 * light, exponents, BRDFs, the light's peak, translucent layers, decals. Sizes
 * and choices are the caller's and left as they are; of these, translucency
 * FORWARD takes the exponents of translucent surfaces out. */
void hl_needs_measure(struct hl_needs *needs, const struct hl_frame *frame,
                      const struct hl_surface *surfaces, float aspect);
#endif
