/* SPDX-License-Identifier: Zlib */
#ifndef HLC_BRIDGE_H
#define HLC_BRIDGE_H
/* From a scene (platforms/host) to what a frame is given: buffers, textures,
 * surfaces, items, lights, a camera. An embedder like any other: nothing but
 * public headers is used. Reading order: bridge_mesh.c, bridge_texture.c,
 * bridge_ids.c, bridge_shadow.c, bridge.c, view.c. */
#include "core/halflight.h"
#include "core/shadow_mesh.h"
#include "platforms/cli/options.h"
#include "platforms/host/scene.h"

/* malloc and free. */
struct hl_hooks hlc_hooks(void);

struct hlc_world_options {
    bool no_normal_maps;
    bool no_specular;            /* every material drops ks S                */
    enum hlc_ids_scheme ids;
    uint32_t ids_seed;           /* of HLC_IDS_PAPER; any number             */
    bool shadow_volumes;         /* prepare what casts shadows for them      */
};

/* How regions were numbered. Collisions: neighbouring regions that share an
 * id, pairs within a mesh (counted once an object) and pairs of objects whose
 * boxes come near each other. */
struct hlc_ids_report {
    const char *scheme;          /* "unique", "groups-colored", "colored",
                                  * "paper": the one in effect               */
    uint64_t regions;            /* normal groups, summed over objects       */
    uint32_t highest;            /* id                                       */
    uint64_t collisions;
};

/* Of a scene mesh that casts shadow volumes. */
struct hlc_shadow {
    struct hl_shadow_mesh mesh;
    hl_buf vertices;
    bool made;
};

enum { HLC_WORLD_BUFFERS = 16 };

struct hlc_world {
    struct hl_device *device;          /* borrowed                           */
    const struct hlh_scene *scene;     /* borrowed                           */
    struct hl_item *items;
    uint32_t n_items;
    uint32_t *item_object;             /* the scene object of an item        */
    struct hl_surface *surfaces;       /* at most two a mesh                 */
    uint32_t n_surfaces;
    struct hl_material *materials;     /* one a scene material               */
    struct hl_light *lights;
    uint32_t n_lights;
    hl_tex *textures;                  /* [2 i] image i as sRGB, [2 i + 1]
                                        * as linear; {0}: not used           */
    hl_buf buffers[HLC_WORLD_BUFFERS];
    struct hlc_shadow *shadows;        /* one a mesh; NULL: no volumes       */
    struct hlc_ids_report ids;
    uint64_t bytes;                    /* of buffers and textures            */
};

/* Upload a scene. The scene must outlive the world. False with one line in
 * *error; nothing is then left behind. */
bool hlc_world_create(struct hlc_world *out, struct hl_device *device,
                      const struct hlh_scene *scene,
                      const struct hlc_world_options *options,
                      struct hlh_error *error);
/* While the device is still open; a zeroed world is allowed. */
void hlc_world_free(struct hlc_world *world);

/* ---- view.c -------------------------------------------------------- */

/* The scene's camera. near and far in metres, taken as they are; 0 = by the
 * scene's bounds:
 *
 * far   depth of the farthest corner of the bounds, + 0.1 %: the DSF stores
 *       depth as a share of it, so it is kept tight; 1 if all lies behind;
 * near  depth of the nearest corner, - 0.1 %, and at least 1 / 100,000
 *       (fine_depth) or 1 / 1,000 of that far, or of the given one where that
 *       is nearer. With reversed floating point depth the rounding error is
 *       the same share of z for any near; integer depth loses bits to a
 *       small one.
 *
 * By the bounds, nothing in sight is cut off unless it is nearer than that.
 * False when the camera or the pair is not usable. */
bool hlc_view(struct hl_camera *out, const struct hlh_scene *scene,
              double near, double far, bool fine_depth);

/* A frame of the whole world. */
void hlc_frame(struct hl_frame *out, const struct hlc_world *world,
               const struct hl_camera *camera);

/* What the frame needs, and the choices that the command line made. */
void hlc_needs(struct hl_needs *out, const struct hlc_world *world,
               const struct hl_frame *frame, const struct hlc_options *o);
#endif
