/* SPDX-License-Identifier: Zlib */
#ifndef HL_BLOCK_H
#define HL_BLOCK_H
/* What stages read: bindings, specialisation constants and uniform blocks,
 * the same text for C (to fill) and GLSL (to read). Blocks hold vec4 and
 * mat4 only, so that std140 and C agree without padding rules.
 *
 * An embedder's own stage includes this file (through inferred.glsl) and
 * may read every block; slot 2 is its own to lay out. */
#include "shaders/shared/lang.h"
#include "shaders/shared/pack.h" /* HL_TWO16_*                                */

/* Uniform slots (set 0). */
#define HL_SLOT_FRAME 0
#define HL_SLOT_OBJECT 1
#define HL_SLOT_MATERIAL 2
#define HL_SLOT_LIGHTS 3
#define HL_SLOT_VOLUME 2    /* of volume.vert: hl_volume_block               */
#define HL_SLOT_SHADOW 2    /* of the light pass: hl_shadow_block            */
#define HL_SLOT_MOTION 3    /* of the geometry pass: hl_motion_block         */
/* Storage slots (set 2). */
#define HL_SLOT_LIST 0
#define HL_SLOT_TILES 1
/* Texture slots (set 1) of the light pass ... */
#define HL_TEX_DEPTH 0
#define HL_TEX_NORMAL 1
#define HL_TEX_EXPONENT 2
#define HL_TEX_SHADOW 3
/* ... and of passes that draw meshes. */
#define HL_TEX_LIGHT 0
#define HL_TEX_DSF 1
#define HL_TEX_BASE 2
#define HL_TEX_METAL_ROUGH 3
#define HL_TEX_NORMAL_MAP 4
#define HL_TEX_EMISSION 5
#define HL_TEX_MESH_COUNT 6

/* Vertex attributes. */
#define HL_ATTR_POSITION 0
#define HL_ATTR_NORMAL 1
#define HL_ATTR_TANGENT 2   /* w = handedness * (1 + normal group)           */
#define HL_ATTR_UV 3
#define HL_ATTR_COLOR 4

/* Specialisation constants. */
#define HL_SPEC_SPECULAR 0  /* HL_SPECULAR_*                                 */
#define HL_SPEC_FALLOFF 1   /* 1 smooth, 2 inverse square, 3 by light        */
#define HL_SPEC_KINDS 2     /* 0 points only, 1 spots and directional too    */
#define HL_SPEC_BATCH 3     /* lights a draw, 1..HL_BATCH_MAX                */
#define HL_SPEC_DSF 4       /* HL_DSF_*                                      */
#define HL_SPEC_MASK 5      /* 1: discard where alpha < cutoff; 2: where
                             * < HL_ALPHA_VISIBLE                            */
#define HL_SPEC_TEXTURES 6  /* HL_TEXTURED_* bits                            */
#define HL_SPEC_BASE 7      /* forward: 1 adds emission and ambient          */
#define HL_SPEC_TWO_SIDED 8 /* 1: a visible back face turns its normal over  */

#define HL_SPEC_LIGHT_BITS 9 /* HL_BITS_*: how L-buffer texels are stored    */
/* What a plan fixes for good is compiled in: software drivers load uniforms
 * lane by lane, two dozen instructions each. Floats by their bits. */
#define HL_SPEC_LIGHT_WIDTH 10   /* L-buffer texels, float                   */
#define HL_SPEC_LIGHT_HEIGHT 11
#define HL_SPEC_RATIO_X 12       /* L texels a frame pixel                   */
#define HL_SPEC_RATIO_Y 13
#define HL_SPEC_DSF_K 14
#define HL_SPEC_DSF_C 15
#define HL_SPEC_DSF_TAU 16
#define HL_SPEC_LIGHT_SCALE 17   /* light = sampled * scale                  */
#define HL_SPEC_TWO16 18         /* HL_TWO16_* of pack.h                     */
#define HL_SPEC_ID_STEPS 19      /* an id is stored as id / steps, float     */
#define HL_SPEC_LIGHT_OUT 20     /* written = light * out, float             */
#define HL_SPEC_SHIFT_X 21       /* clip x += w * shift, float: half a pixel */
#define HL_SPEC_SHIFT_Y 22       /* the same for y (down)                    */
#define HL_SPEC_DEPTH_READ 23    /* HL_DEPTH_READ_*                          */
#define HL_SPEC_STIPPLE 24       /* of translucent surfaces: 0, or 2 or 4     */
#define HL_SPEC_STIPPLE_CONE 25  /* 1: cone filter, else bilinear            */
#define HL_SPEC_FILL 26          /* hl_fill: 1 NEAREST, 2 DEPTH, 0 BILINEAR;
                                  * + HL_FILL_THROUGH: what lies before may
                                  * be translucent                           */
#define HL_FILL_THROUGH 4
#define HL_SPEC_BILINEAR 27      /* 1: hl_fetch BILINEAR; light is sampled as
                                  * numbers and filtered                     */
#define HL_SPEC_BRDFS 28         /* 1: the exponent channel is a pair, and has
                                  * the BRDF as its second number            */
#define HL_SPEC_MAP_SIZE 29      /* shadow map: texels a side, float         */
#define HL_SPEC_MAP_KIND 30      /* shadow map: HL_MAP_*                     */
#define HL_SPEC_DECAL 31         /* geometry pass: 1 writes nothing but the
                                  * normal, with the surface's alpha         */

/* Half a step of 8-bit alpha: what blends to nothing that can be seen. */
#define HL_ALPHA_VISIBLE (0.5f / 255.0f)

/* How a depth target is sampled. */
#define HL_DEPTH_READ_FLOAT 0
#define HL_DEPTH_READ_BARG 1 /* three bytes of depth in rgb, high first      */
/* Of a light's shadow map; and bits. */
#define HL_MAP_NONE 0u      /* no map: all is lit                            */
#define HL_MAP_CONE 1u
#define HL_MAP_POINT 2u     /* six of them, by major axis                    */
#define HL_MAP_PARALLEL 3u
#define HL_MAP_SIX 4u       /* the target has 3 x 2 maps, not one            */
#define HL_MAP_BARG 8u      /* sampled as HL_DEPTH_READ_BARG                 */

/* L-buffers are sampled as raw bits (R32, RG32 or RGBA32 UINT), since one
 * gather of 32-bit words costs less than four fetches of texels. */
/* Largest 16-bit float. Brighter light is stored as this, not as infinity,
 * which a blender or a division would turn into NaN. */
#define HL_HALF_MAX 65504.0f
#define HL_BITS_HALF 0      /* 4 x 16 float                                  */
#define HL_BITS_UNORM16 1
#define HL_BITS_FLOAT 2     /* 4 x 32 float                                  */
#define HL_BITS_UNORM8 3
#define HL_BITS_UNORM10 4   /* 3 x 10, alpha of 2                            */
#define HL_SPECULAR_NONE 0
#define HL_SPECULAR_CONSTANT 1
#define HL_SPECULAR_CHANNEL 2
#define HL_DSF_OFF 0        /* plain bilinear                                */
#define HL_DSF_SLOPE 1
#define HL_DSF_CONSTANT 2   /* the paper's threshold, for comparison         */
#define HL_DSF_DARK 4       /* a plan for no lights: nothing is read         */
#define HL_DSF_EXACT 3      /* L-buffer as large as the frame: one fetch     */
#define HL_TEXTURED_BASE 1
#define HL_TEXTURED_METAL_ROUGH 2
#define HL_TEXTURED_NORMAL 4
#define HL_TEXTURED_EMISSION 8

/* Lights: two vec4 for smooth or inverse-square points, four for all kinds.
 * [0] view position, 1/r^2   [1] colour, 1 = inverse square else smooth
 * [2] view direction of travel, spot scale   [3] spot offset, directional,
 * and free. */
#define HL_BATCH_MAX 16
#define HL_LIGHT_VEC4S 4
#define HL_POINT_VEC4S 2
/* Lights as flat varyings (HL_FLAT stages): 28 vec4 of them and two more of
 * frame data, of the 31 that every Vulkan 1.3 desktop device passes on. */
#define HL_FLAT_VEC4S 28

/* Varyings of mesh stages, by location. */
#define HL_VARY_IDS 0       /* flat: region id, exponent code, 1/far, far   */
#define HL_VARY_NORMAL 1
#define HL_VARY_TANGENT 2
#define HL_VARY_UV 3
#define HL_VARY_COLOR 4
#define HL_VARY_ALBEDO 5    /* flat vec4: rho, alpha; of the factors         */
#define HL_VARY_SPECULAR 6  /* flat vec4: ks, exponent n                     */
#define HL_VARY_BASE 7      /* flat vec4: e + rho A, 0                       */
#define HL_VARY_POSITION 8  /* view position                                 */
#define HL_VARY_CLIP 9      /* clip x, y, w at the centroid (HL_CENTROID)    */
#define HL_VARY_MOTION 10   /* clip x, y, w now, and of the last frame       */

#ifdef HL_GLSL
layout(set = 0, binding = HL_SLOT_FRAME, std140) uniform hl_frame_block {
#else
struct hl_frame_block {
#endif
    /* View position of an L-buffer texel centre p at depth z > 0:
     * ((p.x * x + z) * z, (p.y * y + w) * z, -z). */
    hl_vec4 ray_light;
    hl_vec4 depth;      /* view z = x / (d + y); 1 / far; far                */
    hl_vec4 ambient;    /* rgb; w: scale of stored light (stored * w = light) */
    hl_vec4 misc;       /* exponent, tile size px, tiles a row, 0            */
#ifdef HL_GLSL
} hl_frame;
layout(set = 0, binding = HL_SLOT_OBJECT, std140) uniform hl_object_block {
#define hl_mat4 mat4
#else
};
typedef struct { hl_vec4 column[4]; } hl_mat4;
struct hl_object_block {
#endif
    hl_mat4 clip;       /* model to clip                                     */
    hl_mat4 normal;     /* model to view, cofactor 3 x 3: normals            */
    hl_mat4 model_view; /* positions and tangents                            */
    hl_vec4 ids;        /* id base, object index, list offset, list count    */
    /* Exponent code; -1 for mirrored objects, else 1; stipple pattern, 0 for
     * opaque; BRDF, an enum hl_brdf. */
    hl_vec4 flat_ids;
#ifdef HL_GLSL
} hl_object;
#else
};
#endif

#if !defined(HL_GLSL) || !defined(HL_OWN_MATERIAL_BLOCK)
#ifdef HL_GLSL
layout(set = 0, binding = HL_SLOT_MATERIAL, std140) uniform hl_material_block {
#else
struct hl_material_block {
#endif
    hl_vec4 base;       /* linear factor, alpha                              */
    hl_vec4 params;     /* metallic, roughness, normal scale, alpha cutoff   */
    hl_vec4 emission;   /* rgb, specular weight (1, or 0 for none)           */
    hl_vec4 albedo;     /* rho of the factors, alpha                         */
    hl_vec4 specular;   /* ks of the factors, exponent n                     */
#ifdef HL_GLSL
} hl_material;
#else
};
#endif
#endif

#ifdef HL_GLSL
layout(set = 0, binding = HL_SLOT_LIGHTS, std140) uniform hl_lights_block {
    vec4 data[HL_BATCH_MAX * HL_LIGHT_VEC4S];
} hl_lights;
#else
enum { HL_LIGHTS_BYTES = HL_BATCH_MAX * HL_LIGHT_VEC4S * 16 };

/* Of stages that draw volumes (volume.vert lays it out the same). */
struct hl_volume_block {
    hl_mat4 clip;       /* model to clip                                     */
    hl_vec4 light;      /* in model space, as hl_shadow_light gives it       */
};

/* Of the light pass with HL_SHADOW_MAP (shadow.glsl lays it out the same);
 * shaders/shared/shadow.h says what the numbers do. */
struct hl_shadow_block {
    hl_mat4 light;      /* view to light space, rigid, metres                */
    hl_vec4 map;        /* texels a unit of slope (parallel: a metre), 1 over
                         * that, 1 (-1 where near is 1), 0                   */
    hl_vec4 depth;      /* stored depth = x / c + y (parallel: x c + y); least
                         * c; 0                                              */
    hl_vec4 error;      /* of view depth z: x z^2 + y z, metres              */
};

/* Of the geometry pass with HL_MOTION. */
struct hl_motion_block {
    hl_mat4 before;     /* model to the last frame's clip, no jitter         */
    hl_mat4 now;        /* model to this frame's clip, no jitter             */
};
#endif
#endif
