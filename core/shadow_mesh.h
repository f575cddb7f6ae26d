/* SPDX-License-Identifier: Zlib */
#ifndef HL_SHADOW_MESH_H
#define HL_SHADOW_MESH_H
/* Preparation of a mesh for shadow volumes (core/shadow_volume.h), once, when
 * it is loaded: welded vertices, faces with their planes, edges with the
 * faces on them.
 *
 * Any triangles will do. Positions are one vertex where they are equal by
 * value (-0 equals +0), whatever their indices, so that seams of normals and
 * texture coordinates do not open the mesh. An edge may have one face, two,
 * or many, going either way along it; T-junctions stay open edges, which is
 * right too, at the price of sides that cancel. Triangles that cannot cast a
 * shadow (no area, not finite) are dropped; an edge-on face, which they
 * equal, casts none either.
 *
 * Time and memory grow linearly with the mesh (hashing; expected time). The
 * result depends on the input alone where the compiler rounds every operation
 * once (-ffp-contract=off, no x87). */
#include "hal/hal.h"

/* More indices are HL_ERR_LIMIT: what a volume of so many may need, 8 indices
 * an index of the mesh, still fits 32 bits. */
#define HL_SHADOW_MAX_INDICES (3u << 26)

/* The caller's arrays, borrowed for the call; no alignment is asked of the
 * positions. */
struct hl_shadow_mesh_desc {
    const void *positions;   /* 3 floats a vertex; required if n_vertices    */
    size_t position_stride;  /* bytes, 0 = tightly packed                    */
    const uint32_t *indices; /* triangle list, counter-clockwise from
                                outside; NULL: 0, 1, 2, ...                  */
    uint32_t n_indices;      /* 0 with indices NULL: n_vertices              */
    uint32_t n_vertices;
};

struct hl_shadow_mesh_stats {
    /* Triangles dropped, by the first reason that held. */
    uint32_t n_out_of_range; /* an index not below n_vertices                */
    uint32_t n_non_finite;   /* NaN or Inf in a position                     */
    uint32_t n_degenerate;   /* exactly no area                              */
    uint32_t n_partial;      /* 1 when n_indices is no multiple of 3         */
    /* Edges that a closed surface with all faces outward has none of. */
    uint32_t n_open;         /* of one face                                  */
    uint32_t n_turned;       /* of two faces that go the same way            */
    uint32_t n_wide;         /* of more than two                             */
    uint64_t n_steps;        /* hash probes: equal on every machine          */
};

/* (b - a) x (c - a), and the largest sum over its components of the
 * magnitudes that were subtracted, which bounds how wrong it is. */
struct hl_shadow_face { double normal[3], spread; };

/* Up to two faces on the edge from vertex a to vertex b, a < b, as 2 * face,
 * + 1 where the face goes from b to a; 2 * n_faces where there is none. Of a
 * wide edge: its first entry of refs, and how many. */
struct hl_shadow_edge { uint32_t a, b, first, second; };

/* Arrays owned by this struct, NULL where empty. */
struct hl_shadow_mesh {
    uint32_t n_vertices, n_faces, n_edges;
    /* 8 floats a vertex, for a vertex buffer of 2 n_vertices: vertex v is
     * element 2 v = x y z 1, its twin 2 v + 1 = x y z 0. */
    float *vertices;
    uint32_t *corners;       /* 3 a face                                     */
    struct hl_shadow_face *faces;
    struct hl_shadow_edge *edges;  /* the wide ones from n_narrow on         */
    uint32_t n_narrow;
    uint32_t *refs;          /* of the wide edges                            */
    uint32_t max_sides;      /* quads that any light can need, faces lit by
                                their front alone                            */
    float min[3], max[3];    /* of the vertices; zero when there are none    */
    struct hl_shadow_mesh_stats stats;
};

/* Prepare a mesh. On failure *out is zeroed and nothing stays allocated:
 * HL_ERR_INVALID  a hook or a needed pointer is missing, or indices are NULL
 *                 with n_indices neither 0 nor n_vertices;
 * HL_ERR_LIMIT    n_vertices or n_indices above HL_SHADOW_MAX_INDICES, or a
 *                 stride times its count or a table overflows a size_t;
 * HL_ERR_MEMORY   the alloc hook returned NULL.
 * A mesh with no usable triangle is HL_OK with empty arrays. */
enum hl_result hl_shadow_mesh_prepare(struct hl_shadow_mesh *out,
                                      const struct hl_hooks *hooks,
                                      const struct hl_shadow_mesh_desc *desc);
/* Release through the hooks that prepared it; zeroes *mesh. NULL or a zeroed
 * struct is allowed. */
void hl_shadow_mesh_free(struct hl_shadow_mesh *mesh,
                         const struct hl_hooks *hooks);
#endif
