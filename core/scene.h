/* SPDX-License-Identifier: Zlib */
#ifndef HL_SCENE_H
#define HL_SCENE_H
/* What a frame is given: camera, lights, items. Plain structs, all borrowed
 * for the call. Metres, right-handed, y up, linear RGB. */
#include "hal/hal.h"
#include "shaders/shared/block.h"

struct hl_shadow_mesh;       /* core/shadow_mesh.h                           */

struct hl_camera {
    float view[16];          /* world to view, rigid; camera looks down -z   */
    float tan_half_y;        /* tangent of half the vertical field of view   */
    float near, far;         /* metres, 0 < near < far                       */
    /* Frame pixels by which the picture is moved right and down, each within
     * -1..1, else the frame is refused: for temporal antialiasing. Meshes
     * alone are moved: tiles, scissors and stipple patterns stay with the
     * targets' texels, and light is as exact as without. */
    float jitter[2];
};

/* Camera at eye looking to target; up is y, or -z when looking straight up
 * or down. vfov in degrees, 0 < vfov < 180; eye and target differ. */
enum hl_result hl_camera_look_at(struct hl_camera *out, const float eye[3],
                                 const float target[3], float vfov,
                                 float near, float far);

enum hl_light_kind { HL_POINT = 0, HL_SPOT, HL_DIRECTIONAL };
enum hl_falloff { HL_SMOOTH = 0, HL_INVERSE_SQUARE };

/* Attenuation: shaders/shared/shade.h. Finite values, colour and radius not
 * negative; radius 0 or a black colour gives no light and costs nothing. */
struct hl_light {
    enum hl_light_kind kind;
    enum hl_falloff falloff;
    float position[3];       /* world                                        */
    float radius;            /* metres; directional: unused                  */
    float direction[3];      /* world, unit, as the light travels            */
    float inner, outer;      /* half angles, radians, spots                  */
    float color[3];
    bool shadow;             /* casts shadows, where the plan has any        */
};

enum hl_brdf {
    HL_BRDF_BLINN_PHONG = 0,
    /* Light that enters beside the terminator: shaders/shared/shade.h
     * hl_diffuse_skin; plans without brdfs draw it as BLINN_PHONG. */
    HL_BRDF_SKIN,
    HL_BRDF_COUNT
};

/* The model's surface (glTF metal-rough on Blinn-Phong). */
struct hl_material {
    float base[4];           /* linear factor, alpha                         */
    float metallic, roughness;
    float emission[3];
    float normal_scale;      /* of the normal map; 0 = flat                  */
    float alpha_cutoff;      /* masked surfaces                              */
    bool no_specular;        /* drop ks S                                    */
    enum hl_brdf brdf;
};

/* How a kind of mesh is drawn: everything that needs a program of its own. */
struct hl_surface {
    struct hl_vertex_layout layout; /* attributes: HL_ATTR_* of block.h      */
    uint32_t textures;       /* HL_TEXTURED_* bits that items bind           */
    bool vertex_color;       /* the layout has HL_ATTR_COLOR                 */
    bool masked;             /* alpha test                                   */
    /* Drawn last, sorted, over. With masked (K 6: fences and foliage): all of
     * the surface is blended, the geometry pass writes where it is not
     * invisible, and the alpha test decides what casts shadows. */
    bool blended;
    /* Lies on other surfaces, in front of them by a little: changes their
     * normals by its alpha, and is blended over their colour. Implies no depth
     * writes; blended and masked are 0. Where normals do not blend it is drawn
     * as a translucent surface (plan.decals). */
    bool decal;
    bool two_sided;
    bool mirrored;           /* model-to-world determinant is negative       */
    /* A material fragment stage of the embedder's own for the inferred
     * pipeline (include shaders/inferred.glsl), or NULL. It writes location
     * 0. Its items bring material_block for uniform slot 2; textures and
     * masked are 0. Forward plans refuse it (HL_ERR_UNSUPPORTED). Plans with
     * float_taps (consoles) need the stage compiled with HL_FLOAT_TAPS
     * defined before the include, others with dsf_bilinear (only where it is
     * asked for) HL_FLOAT_LIGHT, all others neither. */
    const struct hl_code *own_material;
};

enum { HL_ITEM_TEXTURES = 4 };

struct hl_item {
    uint32_t surface;        /* index into the renderer's surfaces           */
    hl_buf vertex[HL_MAX_STREAMS];
    hl_buf index;
    bool index16;
    uint32_t first, count;   /* indices                                      */
    int32_t base_vertex;
    float world[16];         /* model to world, affine                       */
    float bounds_min[3], bounds_max[3]; /* of the mesh, model space          */
    uint32_t id_base;        /* region id of normal group 0; 1.. (core/ids.h) */
    const struct hl_material *material;
    /* base, metal-rough, normal, emission; {0} where not textured */
    struct hl_texture_binding texture[HL_ITEM_TEXTURES];
    const void *material_block;   /* own_material surfaces                   */
    uint32_t material_bytes;
    /* Translucent: who it is from frame to frame, no two alike; 0: 1 + its
     * index in the frame's items. */
    uint32_t name;
    uint8_t stipple;         /* pattern wanted (HL_STIPPLE_USER), 0: none    */
    bool no_shadow;          /* casts none                                   */
    /* For shadow volumes, else it casts none: the prepared mesh, and its
     * vertices in a vertex buffer (core/shadow_volume.h). */
    const struct hl_shadow_mesh *shadow_mesh;
    hl_buf shadow_vertices;
    /* Model to world of the last frame, for motion; NULL: it did not move. */
    const float *world_before;
};

struct hl_frame {
    struct hl_camera camera;
    const struct hl_item *items;
    uint32_t n_items;
    const struct hl_light *lights;
    uint32_t n_lights;
    float ambient[3];
    float background[3];
    /* Camera of the last frame, for motion; NULL: it did not move. */
    const struct hl_camera *before;
    /* Part of the frame's targets that is drawn, from the top left on, pixels,
     * up to the plan's; 0: all (dynamic resolution). The camera's vertical
     * field of view fills the part's height, its aspect is the part's. The
     * L-buffer's part keeps the same ratio, so that filters and stipple
     * patterns do not notice; a few texels beyond its edges are drawn too,
     * for taps. The rest of the frame is background. */
    uint32_t width, height;
};
#endif
