/* SPDX-License-Identifier: Zlib */
#ifndef HLH_SCENE_H
#define HLH_SCENE_H
/* A scene as plain arrays: what a file or a built-in generator gives, before
 * anything of halflight's core has touched it. The tool turns it into core's
 * draws and lights; the reference renderer reads it directly. This header
 * knows no type of core or hal. All arrays are owned by the scene and freed
 * by hlh_scene_free. Metres, right-handed, y up; linear RGB; matrices are
 * column-major (m[column * 4 + row]), column vectors. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum hlh_alpha { HLH_ALPHA_OPAQUE, HLH_ALPHA_MASK, HLH_ALPHA_BLEND };
enum hlh_light_kind { HLH_LIGHT_POINT, HLH_LIGHT_SPOT, HLH_LIGHT_DIRECTIONAL };
enum hlh_falloff { HLH_FALLOFF_SMOOTH, HLH_FALLOFF_INVERSE_SQUARE };
enum hlh_brdf { HLH_BRDF_BLINN_PHONG, HLH_BRDF_SKIN };
enum hlh_wrap { HLH_WRAP_REPEAT, HLH_WRAP_CLAMP, HLH_WRAP_MIRROR };

/* 8-bit RGBA exactly as the file stores it (sRGB or linear is decided by the
 * use), rows top to bottom, width * height * 4 bytes. */
struct hlh_image {
    char *name;
    uint32_t width, height;
    uint8_t *rgba;
};

/* image < 0: no texture. Filtering is always trilinear. */
struct hlh_texture {
    int32_t image;
    enum hlh_wrap wrap_u, wrap_v;
};

struct hlh_material {
    char *name;
    float base_color[4];              /* linear factor, w = alpha            */
    float metallic, roughness;        /* factors                             */
    float emission[3];                /* linear factor                       */
    float normal_scale;               /* glTF normalTexture.scale            */
    float alpha_cutoff;
    enum hlh_alpha alpha;
    bool double_sided;                /* false: back faces are culled        */
    /* Of HLH_ALPHA_MASK: the alpha test decides what the G-buffer holds, and
     * all of the surface is blended by its alpha. */
    bool fence;
    /* Lies just in front of other surfaces, changes their normals and is
     * blended over them; alpha mode and fence then do not count. */
    bool decal;
    enum hlh_brdf brdf;
    struct hlh_texture base_texture;      /* sRGB, a = linear alpha          */
    struct hlh_texture metal_rough_texture; /* linear, g rough, b metal      */
    struct hlh_texture normal_texture;    /* linear, tangent space           */
    struct hlh_texture emission_texture;  /* sRGB                            */
};

/* Normals are unit and finite (repaired on load, see scene_clean.h); tangent w
 * is the handedness +1 or -1, tangent 0,0,0,0 where the file has none; uv has
 * v downwards as in glTF (v = 0 is the image's top row), finite, within +-1e6;
 * colour 1,1,1,1 where the file has none, else 0..1. */
struct hlh_vertex {
    float position[3];
    float normal[3];
    float tangent[4];
    float uv[2];
    float color[4];
};

/* Triangle list; every index < n_vertices; no triangle has zero area or a
 * non-finite vertex. */
struct hlh_mesh {
    char *name;
    struct hlh_vertex *vertices;
    uint32_t n_vertices;
    uint32_t *indices;
    uint32_t n_indices;
    uint32_t material;                /* index into materials, always valid  */
    bool has_uv, has_color, has_tangent;
};

/* One drawn instance of one mesh (a glTF primitive under a node). */
struct hlh_object {
    uint32_t mesh;
    float world[16];
    bool no_shadow;                   /* casts none                          */
};

struct hlh_light {
    enum hlh_light_kind kind;
    enum hlh_falloff falloff;
    float position[3];
    float direction[3];               /* unit, the way the light travels     */
    float color[3];                   /* c of design section 4               */
    float radius;                     /* metres, > 0; 0 gives nothing        */
    float inner_angle, outer_angle;   /* radians, half angles, spot only     */
    bool range_derived;               /* glTF light without a range          */
    bool shadow;                      /* casts shadows, where asked for      */
};

/* Looks from eye to target. Up is y, or -z when looking straight up or down,
 * unless the file's node says otherwise (has_up). */
struct hlh_camera {
    float eye[3], target[3], up[3];
    float vfov;                       /* degrees                             */
    float aspect;                     /* 0 = the image's                     */
};

struct hlh_scene {
    char *name;
    struct hlh_image *images;       uint32_t n_images;
    struct hlh_material *materials; uint32_t n_materials;
    struct hlh_mesh *meshes;        uint32_t n_meshes;
    struct hlh_object *objects;     uint32_t n_objects;
    struct hlh_light *lights;       uint32_t n_lights;
    struct hlh_camera camera;
    float ambient[3];               /* default black                         */
    float background[3];            /* default black                         */
    bool camera_is_default, lights_are_default;
    uint32_t lights_range_derived;  /* glTF lights whose range was derived   */
    uint32_t normals_repaired, triangles_dropped;
    uint64_t n_triangles;           /* drawn: instances multiplied           */
    float bounds_min[3], bounds_max[3]; /* of all objects, world space       */
};

/* One line that says what is wrong: "file: place: reason". */
struct hlh_error { char text[512]; };

/* Load a built-in name (see hlh_scene_builtin_name) or a .gltf, .glb or .obj
 * file. Returns false and fills *error on any failure; *out is then zeroed.
 *
 * Default camera, where the file has no perspective camera: looks at the
 * centre of the bounds from direction normalise(1, 0.75, 1.5), vfov 50
 * degrees, from 1.05 / sin(25 degrees) half diagonals of the bounds away: the
 * sphere around the bounds fits any picture that is at least as wide as high.
 * Default lights, where the file has none: nine point lights of smooth
 * falloff placed by the bounds: four coloured ones inside (a room is lit
 * too), four outside around them, one white key high in front; the table is
 * in scene_finish.c.
 *
 * glTF extras: { "halflight": { ... } } of a material with fence and decal
 * (true) and brdf (1: HLH_BRDF_SKIN), of a KHR_lights_punctual light with
 * shadow (true) and falloff ("smooth"), of a node with no_shadow (true). What
 * is of another type or unknown is not read.
 *
 * glTF: the default scene (or the first, or all root nodes); the first
 * perspective camera met; morph targets, skins, animations, occlusion and
 * material extensions are ignored; points and lines are left out; one
 * material has one set of texture coordinates and one KHR_texture_transform,
 * its base texture's, baked into uv. Buffers and images lie beside the file
 * or below; names that are absolute or hold .. are refused. A file that draws
 * no triangle at all is refused. */
bool hlh_scene_load(struct hlh_scene *out, const char *name_or_path,
                    struct hlh_error *error);

/* Load only a built-in scene; false when there is no such name. */
bool hlh_scene_builtin(struct hlh_scene *out, const char *name,
                       struct hlh_error *error);
/* Name and one-line description of built-in i, NULL past the last. */
const char *hlh_scene_builtin_name(uint32_t i, const char **description);

/* Add (or with replace, put in place of all) the lights of a CSV file:
 * x,y,z,radius,r,g,b a line, smooth falloff; '#' starts a comment line. Added
 * lights too take the place of default ones. On failure the scene is
 * unchanged. */
bool hlh_scene_lights_csv(struct hlh_scene *scene, const char *path,
                          bool replace, struct hlh_error *error);

/* Write DIR-or-prefix: PREFIX.glb, PREFIX.lights.csv, PREFIX.camera. Nothing
 * half-written stays behind on failure.
 * The CSV holds the point lights of smooth falloff without shadow; all others
 * go into the GLB as KHR_lights_punctual. Loading the GLB gives back meshes,
 * materials, images, objects and the latter lights bit for bit, in the same
 * order, and adding the CSV (not replacing by it, if the GLB has lights) the
 * rest; the camera's direction to a float's rounding. The .camera file is one
 * line, "ex,ey,ez,tx,ty,tz,vfov 1280x720 ambient r,g,b", exact. Ambient and
 * background are not part of a GLB. */
bool hlh_scene_write(const struct hlh_scene *scene, const char *prefix,
                     struct hlh_error *error);

void hlh_scene_free(struct hlh_scene *scene);
#endif
