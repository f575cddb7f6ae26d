/* SPDX-License-Identifier: Zlib */
#ifndef HL_SHADOW_MAP_H
#define HL_SHADOW_MAP_H
/* Shadow maps on the host: where a light's maps look, how they are told to
 * stages, and what falls on them. No device, no memory of its own. The words
 * of light space and of the filter: shaders/shared/shadow.h.
 *
 * Stability. Maps of points and spots are fixed to the light. The map of a
 * directional light covers a sphere, whose size does not change as the camera
 * turns or moves, has axes of the light's direction alone, and moves by whole
 * texels: what stands still falls on the same place of a texel in every
 * frame.
 *
 * What casts: opaque items, seen or not, front faces as the camera would see
 * them (both of two-sided surfaces); masked ones by their alpha test, blended
 * ones only where they are masked too. Nothing nearer to a point or spot than
 * 1/1024 of its radius does (1/64 with 16 bits of depth).
 *
 * What is off, by texels of the map (a metre from a point light, of 1024: 2
 * mm): edges are soft over 3; within 3.33 of its caster a shadow is lost (the
 * lift); at hollow edges, where taps of one plane see the other, light is lost
 * in part within 2. One map serves a whole directional light: its texel is the
 * smaller sphere's, of view or scene, over 506 of 1024. */
#include "core/light.h"
#include "shaders/shared/shadow.h"

/* Half angle from which on a spot has six maps, radians: a slope of 3. Where
 * the target has one it is drawn without shadow. */
#define HL_SHADOW_WIDE 1.25f

/* A target of maps, from a plan. */
struct hl_shadow_target {
    uint32_t side;           /* of a map, texels, 64 or more                 */
    uint32_t faces;          /* 1, or 6 in 3 columns and 2 rows              */
    bool reversed;           /* near is 1, far is 0                          */
    uint32_t bits;           /* of fixed point depth; 0: floating point      */
};

struct hl_shadow_sphere { double center[3], radius; };

/* What a directional light's map must hold. */
struct hl_shadow_scene {
    struct hl_shadow_sphere seen;    /* all that can be lit and seen         */
    struct hl_box casters;           /* world; min > max: none               */
};

struct hl_shadow_map {
    struct hl_shadow_target target;
    uint32_t kind;           /* HL_MAP_NONE .. HL_MAP_PARALLEL               */
    double axis[3][3];       /* a, b, c in the world, unit, right-handed     */
    double origin[3];        /* of light space, along those axes             */
    double near, far;        /* of c, metres                                 */
    double scale;            /* texels a unit of slope, or a metre           */
};

/* Sphere about all that the camera can see: its size depends on near, far and
 * angles alone. aspect = width / height. */
void hl_shadow_frustum(struct hl_shadow_sphere *out, const struct hl_camera *,
                       double aspect);
/* Sphere about a box, its radius rounded up to one of 16 steps an octave, so
 * that it seldom changes as things move. */
void hl_shadow_around(struct hl_shadow_sphere *out, const struct hl_box *);

/* Maps of a light that hl_light_check finds good. kind HL_MAP_NONE: it can
 * have none here, and lights all. `scene` is read for directional lights. */
void hl_shadow_fit(struct hl_shadow_map *out, const struct hl_light *,
                   const struct hl_shadow_target *,
                   const struct hl_shadow_scene *scene);
/* How many maps: 0, 1 or 6. */
uint32_t hl_shadow_faces(const struct hl_shadow_map *);
/* Can anything in the world box be on the map? */
bool hl_shadow_touches(const struct hl_shadow_map *, uint32_t face,
                       const struct hl_box *);
/* Model to clip space of the whole target; draws are cut to hl_shadow_rect. */
void hl_shadow_clip(float out[16], const struct hl_shadow_map *,
                    uint32_t face, const float world[16]);
struct hl_rect hl_shadow_rect(const struct hl_shadow_map *, uint32_t face);

/* Depth of the L-buffer is within x z^2 + y z of view depth z, metres. */
struct hl_shadow_error { float x, y; };
/* Of depth with `bits` of fixed point (0: floating), z = a / (d + b). */
struct hl_shadow_error hl_shadow_depth_error(uint32_t bits, float a);
void hl_shadow_block_write(struct hl_shadow_block *out,
                           const struct hl_shadow_map *,
                           const struct hl_camera *, struct hl_shadow_error);
#endif
