/* SPDX-License-Identifier: Zlib */
#ifndef HL_LIGHT_VOLUME_H
#define HL_LIGHT_VOLUME_H
/* Closed meshes around the reach of lights, for the stencil (K 2.2). Points
 * and wide spots have a sphere, other spots a cone. Faces are
 * counter-clockwise seen from outside and lie outside of what they enclose,
 * so that no point a light reaches is cut off, however few they are. */
#include "core/light.h"

enum {
    HL_LIGHT_RING = 16,          /* sides of the cone                        */
    HL_LIGHT_FACES = 80,         /* of the sphere: an icosahedron, each face
                                  * cut into four                            */
    HL_LIGHT_SPHERE = 0,         /* first index and number of them           */
    HL_LIGHT_SPHERE_N = 3 * HL_LIGHT_FACES,
    HL_LIGHT_CONE = HL_LIGHT_SPHERE_N,
    HL_LIGHT_CONE_N = 3 * (2 * HL_LIGHT_RING - 2),
    HL_LIGHT_INDICES = HL_LIGHT_CONE + HL_LIGHT_CONE_N,
    HL_LIGHT_VERTICES = 42 + 1 + HL_LIGHT_RING
};

struct hl_light_meshes {
    float vertex[HL_LIGHT_VERTICES][4];  /* w = 1                            */
    uint16_t index[HL_LIGHT_INDICES];
};

/* The sphere around radius 1; the cone from the origin to z = 1 around the
 * cone of slope 1. */
void hl_light_meshes_make(struct hl_light_meshes *out);

/* The mesh of a point or spot light (first index and number), and the matrix
 * that takes it to the world. Directional lights have none: false. */
bool hl_light_volume(const struct hl_light *, uint32_t *first,
                     uint32_t *count, float world[16]);
#endif
