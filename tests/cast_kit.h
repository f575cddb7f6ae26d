/* SPDX-License-Identifier: Zlib */
#ifndef CAST_KIT_H
#define CAST_KIT_H
/* Frames with shadow volumes, and rays that say which texels are dark. */
#include "core/shadow_mesh.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { CS_W = 100, CS_H = 56, CS_TEXELS = CS_W * CS_H };   /* the L-buffer  */

struct cs_rig {
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    struct hl_shadow_mesh mesh[2];   /* of FK_QUAD and FK_BOX                */
    hl_buf vertices[2];
    uint32_t id[CS_TEXELS];          /* of what is seen; 0: nothing          */
};

/* A device by a profile's rules, and a renderer planned for what `fill` puts
 * into the empty scene, with shadow volumes and room for so many indices;
 * `volumes`: lights without shadows have stencil volumes, all of them. */
void cs_open(struct cs_rig *, const char *backend, const char *profile,
             bool volumes, void (*fill)(struct cs_rig *), uint32_t indices);
void cs_close(struct cs_rig *);
/* A floor at y = -3 and a wall at z = -8, which cast nothing; the camera 9 m
 * before the middle. */
void cs_clear(struct cs_rig *);

/* Scaled, turned about y by so many radians, moved. */
struct hl_item *cs_put(struct cs_rig *, enum fk_mesh, enum fk_surface,
                       const float scale[3], double turn, const float at[3]);
/* 2 x 1 x 1.4 m. */
struct hl_item *cs_box(struct cs_rig *, float x, float y, float z,
                       double turn);
/* A white point with shadows, 40 m. */
struct hl_light *cs_light(struct cs_rig *, float x, float y, float z);
void cs_look(struct cs_rig *, const float eye[3], const float at[3],
             float near, float far);

/* 1: the light does not reach what texel i shows of the item; 0: it does; -1:
 * within a texel it is otherwise. */
int cs_shade(const struct cs_rig *, const struct hl_item *, int i,
             const struct hl_light *);

/* Draw; the L-buffer, to be freed. */
void cs_draw(struct cs_rig *, struct hlc_texels *light);

/* Dark: that some light would reach but for casters. `of`: dark texels of an
 * item, and all others of it that are sure. */
struct cs_seen { uint32_t dark, lit, unsure, of[FK_ITEMS][2]; };

/* Each texel has the bits of the frame with just those lights that reach it,
 * drawn without shadows. At most two lights. */
struct cs_seen cs_check(struct cs_rig *, const char *name);
#endif
