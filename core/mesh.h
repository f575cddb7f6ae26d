/* SPDX-License-Identifier: Zlib */
#ifndef HL_MESH_H
#define HL_MESH_H
/* Mesh preparation for inferred lighting: normal groups, their neighbours,
 * and tangents. Done once a mesh, when it is loaded; the result is what
 * vertex and index buffers are filled from.
 *
 * A normal group is a connected component of the mesh's dual graph (one node
 * a triangle) after the edges with discontinuous normals are cut; an edge is
 * continuous if and only if the two triangles have the same normals at both
 * of its vertices (Kircher and Lawrance 2009, section 3.1). Triangles are
 * neighbours where both end positions of an edge are equal by value (-0
 * equals +0), whatever their indices; more than two triangles on one edge are
 * each compared with each. T-junctions do not join.
 *
 * Nothing in the caller's arrays is trusted: see struct hl_mesh_stats for
 * what is dropped or replaced. Time and memory grow linearly with the mesh
 * (hashing; expected time). The result depends on the input alone, not on the
 * machine, its byte order or its mathematics library, where the compiler
 * rounds every operation once (-ffp-contract=off, no x87). */
#include "hal/hal.h"

/* Indices and vertices a mesh may have; more is HL_ERR_LIMIT. */
#define HL_MESH_MAX_COUNT 0x3FFFFFFFu
/* Groups that a float tangent.w can carry exactly with a sign: 2^24. */
#define HL_MESH_MAX_GROUPS 0x1000000u
/* Largest difference of a component (about 0.014 degrees) within which a
 * normal that was computed from its triangle equals another: a flat polygon's
 * triangles give normals that differ by the rounding of its corners. */
#define HL_MESH_FACE_TOLERANCE (1.0f / 4096.0f)
/* More groups than this at one position are not all neighbours of each other
 * (a faceted cone's tip would need an id a facet): edges still count. */
#define HL_MESH_MAX_FAN 8u
/* On one edge, normals that differ are compared pairwise with the latest 16
 * before them, and only their groups are neighbours; beyond that groups may
 * stay apart, never join wrongly. Equal normals always join. */
#define HL_MESH_MAX_WINGS 16u

/* The caller's arrays, borrowed for the call; no alignment is asked. Every
 * stride is in bytes, 0 = tightly packed. */
struct hl_mesh_desc {
    const void *positions;   /* 3 floats a vertex; required if n_vertices    */
    size_t position_stride;
    const void *normals;     /* 3 floats; NULL: every triangle flat          */
    size_t normal_stride;
    const void *uvs;         /* 2 floats; NULL: no tangents from uvs         */
    size_t uv_stride;
    const void *tangents;    /* 4 floats, kept as given; NULL: from uvs      */
    size_t tangent_stride;
    const uint32_t *indices; /* triangle list; NULL: 0, 1, 2, ...            */
    uint32_t n_indices;      /* 0 with indices NULL: n_vertices              */
    uint32_t n_vertices;
    /* Two normals are the same when no component of their unit vectors
     * differs by more; 0: equal by value. 0..2. */
    float normal_tolerance;
    uint32_t max_groups;     /* more is HL_ERR_LIMIT; 0: HL_MESH_MAX_GROUPS  */
    /* uvs have v running down the image (glTF, Direct3D, Vulkan) while its
     * normal maps have y up: the bitangent is then -dP/dv. */
    bool v_down;
};

struct hl_mesh_stats {
    /* Triangles dropped, by the first reason that held. */
    uint32_t n_out_of_range; /* an index not below n_vertices                */
    uint32_t n_non_finite;   /* NaN or Inf in a position                     */
    uint32_t n_degenerate;   /* repeated index or exactly no area            */
    uint32_t n_partial;      /* 1 when n_indices is no multiple of 3         */
    /* Corners whose normal was NaN, Inf, too short or long for a float's
     * square (below about 1e-19 or above 1e19) or absent: the face's normal
     * by its winding is used instead, and the vertex split where faces
     * differ. */
    uint32_t n_face_normals;
    /* Output vertices with a tangent that is just any unit vector
     * perpendicular to the normal, w = +1: uvs that are degenerate or not
     * finite or cancel, or a given tangent that is zero or not finite. */
    uint32_t n_free_tangents;
    uint32_t n_positions;    /* distinct ones                                */
    uint32_t n_wide;         /* places where MAX_FAN or MAX_WINGS cut short  */
    /* Hash probes, union-find steps and comparisons: the work done, equal on
     * every machine. */
    uint64_t n_steps;
};

/* Output arrays, owned by this struct, NULL where empty. A vertex belongs to
 * exactly one group, so that the group is flat over every triangle: an input
 * vertex on a boundary of groups appears once a group (and once a handedness
 * of its tangent). Vertices stand in the order of their first use, triangles
 * in the order of the input, groups in the order of their first triangle. */
struct hl_mesh_prep {
    uint32_t n_vertices, n_indices, n_triangles, n_groups;
    uint32_t *source_vertex;   /* the input vertex that each one copies      */
    uint32_t *group;           /* a vertex                                   */
    float *normal;             /* 3 a vertex: the input's, or the face's     */
    float *tangent;            /* 4 a vertex: unit x y z, handedness +1 or -1
                                  with bitangent = cross(normal, tangent) w;
                                  NULL without both uvs and tangents         */
    uint32_t *indices;         /* 3 a triangle, into the output vertices     */
    uint32_t *triangle_group;  /* a triangle                                 */
    uint32_t *source_triangle; /* a triangle: its number in the input        */
    /* Neighbouring groups, each pair once, smaller number first: n_edge_pairs
     * that share an edge, then those that share just a position. */
    uint32_t *pairs;           /* 2 a pair                                   */
    uint32_t n_pairs, n_edge_pairs;
    struct hl_mesh_stats stats;
};

/* Prepare a mesh. On failure *out is zeroed and nothing stays allocated:
 * HL_ERR_INVALID  a hook or a needed pointer is missing, the tolerance is
 *                 outside 0..2 or NaN, or indices are NULL with n_indices
 *                 neither 0 nor n_vertices;
 * HL_ERR_LIMIT    n_vertices or n_indices above HL_MESH_MAX_COUNT, a stride
 *                 times its count overflows, more than max_groups groups, or
 *                 a table would overflow a size_t (nothing was read yet in
 *                 the first two cases);
 * HL_ERR_MEMORY   the alloc hook returned NULL.
 * A mesh with no usable triangle is HL_OK with empty arrays. */
enum hl_result hl_mesh_prepare(struct hl_mesh_prep *out,
                               const struct hl_hooks *hooks,
                               const struct hl_mesh_desc *desc);
/* Release through the hooks that prepared it; zeroes *prep. NULL or a zeroed
 * struct is allowed. */
void hl_mesh_prep_free(struct hl_mesh_prep *prep,
                       const struct hl_hooks *hooks);

/* Handedness and a group (or a group's colour) in one float, the paper's
 * "fourth component of the mesh tangent vectors": +-(1 + group). Exact for
 * group < HL_MESH_MAX_GROUPS; a larger one is packed as the largest. Negative
 * handedness gives a negative value, all else a positive one. */
float hl_mesh_pack_tangent_w(float handedness, uint32_t group);
/* The inverse; rounds, so that an interpolated w off by less than 0.5 gives
 * the same. NaN and magnitudes below 1 give group 0. */
void hl_mesh_unpack_tangent_w(float w, float *handedness, uint32_t *group);
#endif
