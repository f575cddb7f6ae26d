/* SPDX-License-Identifier: Zlib */
#ifndef HLH_GLTF_H
#define HLH_GLTF_H
/* A glTF document while it is loaded. Nothing of it is trusted: each part is
 * checked once, in the order of the gltf_*.c files below, and what later
 * parts use has then been checked. Every function returns false with one line
 * "file: place: reason" in the load's struct hlh_error.
 *
 * Geometry is read here rather than by assimp: its glTF importer trusts
 * indices and ranges, merges materials' defaults with its own, and changes
 * texture coordinates and light units, where design section 4 wants the
 * file's numbers. OBJ goes through assimp (scene_obj.c). */
#include <cjson/cJSON.h>
#include "platforms/host/scene.h"
#include "platforms/host/util.h"

#define HLH_NONE UINT32_MAX

/* Top-level arrays of objects; lights are KHR_lights_punctual's. */
enum gltf_list {
    GLTF_BUFFERS, GLTF_VIEWS, GLTF_ACCESSORS, GLTF_MESHES, GLTF_MATERIALS,
    GLTF_TEXTURES, GLTF_IMAGES, GLTF_SAMPLERS, GLTF_NODES, GLTF_SCENES,
    GLTF_CAMERAS, GLTF_LIGHTS, GLTF_N_LISTS
};

/* cJSON's arrays are linked lists: indexed once, or lookups go quadratic. */
struct gltf_items {
    const cJSON **item;
    uint32_t n;
};

struct gltf_bytes {
    const uint8_t *at;
    uint64_t size;
    uint32_t stride;                  /* 0: elements are packed              */
};

/* at NULL: all elements are zero. dense: owned copy with sparse applied. */
struct gltf_accessor {
    const uint8_t *at;
    uint8_t *dense;
    uint32_t count, stride, type, components;
    bool normalized;
};

enum gltf_component {
    GLTF_I8 = 5120, GLTF_U8 = 5121, GLTF_I16 = 5122, GLTF_U16 = 5123,
    GLTF_U32 = 5125, GLTF_F32 = 5126
};

/* How a material reads its texture coordinates; see gltf_material.c. */
struct gltf_uv {
    uint32_t set;
    double scale[2], offset[2], sine, cosine;
};

/* One primitive of one mesh that has triangles: its index in the scene. */
struct gltf_mesh_range {
    uint32_t first, count;
};

struct gltf {
    const char *file;
    struct hlh_error *error;
    struct hlh_scene *scene;
    char *text;                       /* the whole file                      */
    size_t size;
    const char *json;
    size_t json_size;
    const uint8_t *bin;               /* GLB's binary chunk or NULL          */
    size_t bin_size;
    cJSON *root;
    struct gltf_items list[GLTF_N_LISTS];
    char **owned;                     /* buffers read or decoded             */
    struct gltf_bytes *buffer, *view;
    struct gltf_accessor *accessor;
    struct gltf_uv *uv;               /* per material, + 1 for the default   */
    uint32_t *image;                  /* scene image per glTF image          */
    struct gltf_mesh_range *range;    /* scene meshes per glTF mesh          */
    uint32_t default_material;        /* in the scene, HLH_NONE until needed */
    uint64_t bytes_left;              /* of what files outside may bring     */
    uint64_t pixels_left;
    uint64_t elements_left;           /* of vertices and indices             */
};

/* gltf_json.c: typed access. where names the object ("nodes[3]"). A key that
 * is absent leaves *out alone (unless required); one of a wrong type, or a
 * number that is not finite, fails. */
bool gltf_number(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, double *out);
/* Exactly n numbers. */
bool gltf_numbers(struct gltf *g, const cJSON *object, const char *where,
                  const char *key, double *out, int n);
bool gltf_integer(struct gltf *g, const cJSON *object, const char *where,
                  const char *key, uint64_t low, uint64_t high, uint64_t *out);
/* An index into a list; *out is HLH_NONE where the key is absent. */
bool gltf_index(struct gltf *g, const cJSON *object, const char *where,
                const char *key, enum gltf_list list, uint32_t *out);
bool gltf_index_value(struct gltf *g, const cJSON *value, const char *where,
                      const char *key, enum gltf_list list, uint32_t *out);
bool gltf_bool(struct gltf *g, const cJSON *object, const char *where,
               const char *key, bool *out);
bool gltf_string(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, const char **out);
bool gltf_object(struct gltf *g, const cJSON *object, const char *where,
                 const char *key, const cJSON **out);
bool gltf_array(struct gltf *g, const cJSON *object, const char *where,
                const char *key, const cJSON **out);
/* object.extensions[name], NULL where absent. */
bool gltf_extension(struct gltf *g, const cJSON *object, const char *where,
                    const char *name, const cJSON **out);
/* object.extras.halflight[key]; NULL where anything on the way is absent or
 * no object: extras are anybody's, and never fail a load. */
const cJSON *gltf_extra(const cJSON *object, const char *key);
/* The name of a list as the file spells it: "bufferViews". */
const char *gltf_list_name(enum gltf_list list);
bool gltf_memory(struct gltf *g);     /* fails with "out of memory"          */
/* A copy of the object's name, or "kind N". NULL: memory. */
char *gltf_name(const cJSON *object, const char *kind, uint32_t i);

/* gltf_file.c: container, JSON, extensions, lists; fills text .. list. */
bool gltf_open(struct gltf *g);
/* gltf_uri.c: malloc'd bytes of a data: URI or of a file beside the glTF.
 * Absolute names, schemes and .. are refused: a scene must not reach for
 * files that its folder does not hold. */
bool gltf_fetch(struct gltf *g, const char *uri, const char *where,
                char **bytes, size_t *size);
/* gltf_access.c: buffers, views, accessors. */
bool gltf_check_access(struct gltf *g);
/* Element i as floats, normalised integers as glTF says; all accessors. */
void gltf_read(const struct gltf_accessor *a, uint32_t i, float *out);
/* Element i of an unsigned scalar accessor. */
uint32_t gltf_read_index(const struct gltf_accessor *a, uint32_t i);
/* gltf_material.c, gltf_mesh.c, gltf_node.c: into the scene. */
bool gltf_load_materials(struct gltf *g);
bool gltf_load_meshes(struct gltf *g);
bool gltf_load_nodes(struct gltf *g);
/* gltf_light.c: the node's KHR_lights_punctual light and camera. world is a
 * column-major double matrix. */
bool gltf_check_lights(struct gltf *g);
bool gltf_add_light(struct gltf *g, uint32_t light, const double world[16],
                    const char *where);
bool gltf_check_cameras(struct gltf *g);
bool gltf_add_camera(struct gltf *g, uint32_t camera, const double world[16],
                     const char *where);
#endif
