/* SPDX-License-Identifier: Zlib */
#ifndef HL_SHADOW_VOLUME_H
#define HL_SHADOW_VOLUME_H
/* The shadow volume of a prepared mesh and a light, as triangles: once a
 * frame for each pair that changed. No memory of its own, linear time.
 *
 * A face is lit when the light lies strictly before it. The shadow of one lit
 * face is a closed surface: the face itself (front cap), one quad an edge
 * away from the light to infinity (sides), and the face at infinity, turned
 * over (back cap). Seen from outside all of them are counter-clockwise, so
 * the surface winds once about each point behind the face and never about
 * another. The mesh's volume is the sum of those: its winding number at a
 * point is how many lit faces hide the light from it, whatever the mesh. What
 * depth-fail counts is that number. In the sum, sides meet in pairs of
 * opposite quads that cancel on every edge whose lit faces go along it both
 * ways. What stays are the edges of the boundary of the lit faces' chain: of
 * an edge that k more lit faces go one way than the other, k quads. On a
 * closed mesh that is the silhouette; sheets, fins, doubled and intersecting
 * faces need no other rule.
 *
 * Only indices are made here. The vertex buffer is the mesh's own, two
 * elements a vertex (hl_shadow_mesh.vertices), and the vertex stage moves
 * the twins away from the light:
 *
 *   attribute v = x y z w; uniform light, model space, the very floats that
 *   hl_shadow_volume_write was given
 *   vec4 p = v.w > 0.5 ? vec4(v.xyz, 1.0)
 *                      : vec4(v.xyz * light.w - light.xyz, 0.0);
 *   gl_Position = clip * p;
 *
 * All twins of a directional light are one point: sides are triangles, the
 * back cap is nothing.
 *
 * What a renderer keeps for the count to be right:
 * - Nothing of the volume is lost behind the far plane: an infinite far plane
 *   in the matrix of every pass that shares the depth, or depth clamping.
 *   Depth-pass (below) does without, since it counts what is before the
 *   visible surface.
 * - The depth test is strict (less; greater where depth is reversed), so that
 *   a lit face does not lie in its own shadow, and a cap's depths are the
 *   mesh's own to the bit: the same positions, matrix and expression, which
 *   is invariant in both stages, and the same triangles from the same first
 *   corner on, which rasterizers may interpolate from (the mesh is prepared
 *   from the indices it is drawn with).
 * - Stencil wraps: fragments come in any order. Depths of more than 255
 *   shadows on one another count wrong.
 * - The model-to-world matrix's determinant is not zero; where it is
 *   negative, front and back change places, as for the mesh. */
#include "core/light.h"
#include "core/shadow_mesh.h"

enum {                       /* parts                                        */
    HL_SHADOW_FRONT = 1,
    HL_SHADOW_SIDES = 2,
    HL_SHADOW_BACK = 4,
    HL_SHADOW_CLOSED = 7,    /* depth-fail                                   */
    /* Depth-pass; the sides alone where all faces that cast are in the depth
     * buffer, whichever side the camera is on. */
    HL_SHADOW_OPEN = 3,
    /* Faces cast shadows whichever side the light is on: for surfaces drawn
     * with both sides. Of a closed mesh it doubles the counts. */
    HL_SHADOW_TWO_SIDED = 8
};

/* Indices of each part, which follow each other in this order. */
struct hl_shadow_counts {
    uint32_t n_lit;          /* faces                                        */
    uint32_t n_front, n_sides, n_back;
};

/* The light in model space, xyz and 1, or for a directional light xyz toward
 * it and 0. False, and out untouched, when world has no inverse in floats. */
bool hl_shadow_light(float out[4], const float world[16],
                     const struct hl_light *);

/* Indices that are enough for any light. */
uint32_t hl_shadow_max_indices(const struct hl_shadow_mesh *, unsigned parts);
/* Bytes of scratch that a call needs. */
size_t hl_shadow_scratch(const struct hl_shadow_mesh *);

/* Write the parts to indices, once each and in order (so they may lie in
 * memory that is slow to read), triangles into the 2 n_vertices elements.
 * On failure nothing is written to indices:
 * HL_ERR_INVALID  a pointer is missing, the light is not finite, its w is
 *                 neither 0 nor 1, or it is the direction 0 0 0;
 * HL_ERR_LIMIT    max_indices or scratch_bytes is too small; counts then has
 *                 what is needed, all 0 when it was the scratch.
 * hl_shadow_max_indices of room saves counting first. */
enum hl_result hl_shadow_volume_write(struct hl_shadow_counts *counts,
                                      uint32_t *indices, size_t max_indices,
                                      void *scratch, size_t scratch_bytes,
                                      const struct hl_shadow_mesh *mesh,
                                      const float light[4], unsigned parts);

/* False: no point that the camera sees and the light reaches can lie in the
 * shadow of anything in the world box. Conservative; a box or light that is
 * not finite gives true. aspect = width / height. */
bool hl_shadow_reaches(const struct hl_box *, const struct hl_light *,
                       const struct hl_camera *, float aspect);

/* False: no point of the camera's near rectangle is hidden from the light by
 * anything in the world box, so that counting from the near plane
 * (depth-pass: front faces + 1, back faces - 1 where the depth test passes)
 * starts at 0, and needs neither back cap nor infinite far plane.
 * Conservative, as above. */
bool hl_shadow_near_clipped(const struct hl_box *, const struct hl_light *,
                            const struct hl_camera *, float aspect);
#endif
