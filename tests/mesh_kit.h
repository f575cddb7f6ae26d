/* SPDX-License-Identifier: Zlib */
#ifndef MESH_KIT_H
#define MESH_KIT_H
/* What the tests of meshes and ids share: hooks that count and fail, random
 * numbers, and shapes. Running out of real memory ends the test program. */
#include "core/mesh.h"

/* ---- hooks ----------------------------------------------------------- */

struct mk_memory {
    size_t n_live;           /* allocations not freed                        */
    size_t n_allocs;         /* calls so far                                 */
    size_t n_bytes;          /* handed out so far                            */
    size_t fail_at;          /* this call, 1 the first, gives NULL; 0: none  */
    bool fail_on;            /* and all later ones too                       */
    size_t max_bytes;        /* a larger request gives NULL; 0: no limit     */
};
struct hl_hooks mk_hooks(struct mk_memory *memory);

/* A 64-bit FNV-1a sum of numbers, lowest byte first on every machine; begin
 * with 0xCBF29CE484222325. */
uint64_t mk_hash(uint64_t hash, const void *words, size_t n_words);

/* ---- random numbers -------------------------------------------------- */

/* The seed of a run: $HL_TEST_SEED, else 1; printed. */
uint64_t mk_seed(void);
uint32_t mk_random(uint64_t *state);
/* 0..n-1, n >= 1; the bias is below n / 2^32. */
uint32_t mk_below(uint64_t *state, uint32_t n);
/* 0 <= x < 1, a multiple of 2^-24: no library function, no rounding. */
float mk_unit(uint64_t *state);

/* ---- meshes ---------------------------------------------------------- */

struct mk_mesh {
    float *position, *normal, *uv;   /* 3, 3 and 2 a vertex                  */
    uint32_t *indices;
    uint32_t n_vertices, n_indices;
    uint32_t vertex_room, index_room;
};
uint32_t mk_vertex(struct mk_mesh *mesh, const float position[3],
                    const float normal[3], float u, float v);
void mk_triangle(struct mk_mesh *mesh, uint32_t a, uint32_t b, uint32_t c);
/* A triangle of its own three vertices, all with one normal. */
void mk_flat(struct mk_mesh *mesh, const float a[3], const float b[3],
              const float c[3], const float normal[3]);
void mk_free(struct mk_mesh *mesh);
/* Everything given but tangents. */
struct hl_mesh_desc mk_desc(const struct mk_mesh *mesh);

/* Side 2 about the origin, normals of the faces: 24 vertices. */
void mk_cube(struct mk_mesh *mesh);
/* 8 vertices with normals from the centre. */
void mk_smooth_cube(struct mk_mesh *mesh);
/* Unit radius, u around y, v from pole to pole; seam and poles have vertices
 * with equal positions and normals; 2 * slices triangles have no area. */
void mk_sphere(struct mk_mesh *mesh, uint32_t slices, uint32_t stacks);
/* Radius 1, height 2, smooth side, flat caps of their own vertices. */
void mk_cylinder(struct mk_mesh *mesh, uint32_t slices);
/* Smooth side and flat base; the tip has one normal upwards, or with
 * sharp_tip one a slice. */
void mk_cone(struct mk_mesh *mesh, uint32_t slices, bool sharp_tip);
/* n by n squares in the plane z = 0, one normal. */
void mk_grid(struct mk_mesh *mesh, uint32_t n);
/* Triangles among n_places random positions, normals among n_normals. */
void mk_soup(struct mk_mesh *mesh, uint32_t n_triangles, uint32_t n_places,
              uint32_t n_normals, uint64_t *state);

/* ---- what a test starts with ----------------------------------------- */

struct mk_fixture {
    struct mk_memory memory;
    struct hl_hooks hooks;
    struct mk_mesh mesh;
    struct hl_mesh_desc desc;
    struct hl_mesh_prep prep;
};
/* cmocka's; teardown releases all and fails when the hooks miss something. */
int mk_setup(void **state);
int mk_teardown(void **state);
#endif
