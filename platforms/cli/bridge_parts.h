/* SPDX-License-Identifier: Zlib */
#ifndef HLC_BRIDGE_PARTS_H
#define HLC_BRIDGE_PARTS_H
/* What the files of the bridge share while a world is made. */
#include "platforms/cli/bridge.h"

/* Positions and the tangent, whose w carries the group, are streams of their
 * own: passes that need no more fetch no more. Stream 2 is the normal, 3 the
 * uv and the colour. */
enum hlc_layout {
    HLC_LAYOUT_PLAIN,            /* no uv, no colour                         */
    HLC_LAYOUT_FULL,             /* colour: white, 4 bytes                   */
    HLC_LAYOUT_COLORED,          /* colour: the file's, 4 floats             */
    HLC_LAYOUTS
};

/* A scene mesh and its material, made ready. Zeroed where no object uses it. */
struct hlc_part {
    struct hl_mesh_prep prep;
    uint32_t *code;              /* of a group: what tangent.w carries       */
    uint32_t *color;             /* of a group; NULL: not coloured           */
    uint32_t n_colors;
    bool used, masked, blended, decal; /* of its surface                     */
    bool hidden;                 /* the mask drops every pixel of it         */
    enum hlc_layout layout;
    uint32_t textures;           /* HL_TEXTURED_* bits                       */
    int32_t base_vertex;
    uint32_t first;
    bool index16;
    float min[3], max[3];
};

struct hlc_bridge {
    struct hlc_world *world;
    const struct hlh_scene *scene;
    const struct hlc_world_options *options;
    struct hl_hooks hooks;
    struct hlc_part *parts;      /* one a scene mesh                         */
    struct hlh_error *error;
};

/* Fill *b->error with "scene: what: reason"; false. */
bool hlc_bridge_fail(struct hlc_bridge *b, const char *what,
                     enum hl_result reason);

/* bridge_mesh.c: parts (before ids), then buffers (after). */
bool hlc_parts_prepare(struct hlc_bridge *b);
bool hlc_parts_upload(struct hlc_bridge *b);
void hlc_parts_free(struct hlc_bridge *b);
void hlc_layout_describe(struct hl_vertex_layout *out, enum hlc_layout);

/* bridge_ids.c: id_base of every item, code of every group, world->ids. */
bool hlc_ids_number(struct hlc_bridge *b);

/* bridge_shadow.c: shadow meshes of the items that cast. */
bool hlc_shadows_make(struct hlc_bridge *b);
void hlc_shadows_free(struct hlc_world *world);

/* bridge_texture.c */
bool hlc_textures_upload(struct hlc_bridge *b);
#endif
