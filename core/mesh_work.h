/* SPDX-License-Identifier: Zlib */
#ifndef HL_MESH_WORK_H
#define HL_MESH_WORK_H
/* Private to mesh preparation: a hash table, and the state that its stages
 * share. */
#include "core/mem.h"
#include "core/mesh.h"

#define HL_MESH_NONE UINT32_MAX

/* Numbers distinct keys 0, 1, 2, ... in the order they are first seen. */
struct hl_weld {
    const struct hl_hooks *hooks;
    uint64_t *n_steps;       /* probes are added here                        */
    uint32_t words;          /* uint32 a key, 1..HL_WELD_WORDS               */
    uint32_t n;              /* keys held                                    */
    uint32_t room;           /* keys that fit before growing; power of two   */
    uint32_t *keys;          /* words * room                                 */
    uint32_t *slots;         /* 2 * room; number + 1, 0 = empty              */
};
enum { HL_WELD_WORDS = 5 };

void hl_weld_open(struct hl_weld *weld, const struct hl_hooks *hooks,
                  uint32_t words, uint64_t *n_steps);
/* The key's number, HL_MESH_NONE when it is not held. */
uint32_t hl_weld_find(const struct hl_weld *weld, const uint32_t *key);
/* The key's number, added when it is new. HL_MESH_NONE with *result set when
 * there is no room to grow, or when *result was set before. */
uint32_t hl_weld_add(struct hl_weld *weld, const uint32_t *key,
                     enum hl_result *result);
void hl_weld_close(struct hl_weld *weld);

struct hl_mesh_work {
    struct hl_hooks hooks;
    struct hl_mesh_desc desc;    /* defaults filled in                       */
    struct hl_mesh_stats stats;
    uint32_t n_triangles;        /* kept; all arrays below have 3 or 1 each  */
    uint32_t *corner;            /* 3: input vertex                          */
    uint32_t *source_triangle;   /* 1                                        */
    uint32_t *corner_position;   /* 3: into positions                        */
    uint32_t *corner_normal;     /* 3: into normals                          */
    uint32_t *corner_frame;      /* 3: into frames; NULL: no tangents by uv  */
    uint32_t *group;             /* 1                                        */
    uint32_t n_groups, n_edge_pairs;
    struct hl_weld positions;    /* bits of x y z                            */
    struct hl_weld normals;      /* bits of x y z, 1 if the face's           */
    struct hl_weld frames;       /* position, normal, bits of u v, hand      */
    double *frame_sum;           /* 4 a frame: tangent sum, sum of weights   */
    struct hl_weld pairs;        /* group, group                             */
    struct hl_weld vertices;     /* input vertex, group, normal, frame       */
};

/* n_floats values of element i of a caller's array. */
void hl_mesh_read(float *out, const void *base, size_t stride, uint32_t i,
                  uint32_t n_floats);
/* Bits that are equal when the values are: -0 becomes +0, NaN one NaN. */
void hl_mesh_float_key(uint32_t *key, const float *values, uint32_t n);
/* The values that such a key stands for. */
void hl_mesh_key_floats(float *out, const uint32_t *key, uint32_t n);
bool hl_mesh_finite(const float *values, uint32_t n);

/* Vectors in double: differences and products of any finite floats, and their
 * squares, neither overflow nor underflow to nothing. */
void hl_mesh_edge(double out[3], const float from[3], const float to[3]);
void hl_mesh_cross(double out[3], const double a[3], const double b[3]);
double hl_mesh_dot(const double a[3], const double b[3]);
/* False, and v unchanged, when v is zero. */
bool hl_mesh_normalise(double v[3]);
/* Finite, with a length whose square a float holds. */
bool hl_mesh_direction(const float v[3]);
/* Of work->normals. */
void hl_mesh_unit_normal(const struct hl_mesh_work *work, uint32_t id,
                         double out[3]);
void hl_mesh_triangle(const struct hl_mesh_work *work, uint32_t triangle,
                      float out[3][3]);

/* Stages, in order. */
enum hl_result hl_mesh_find_groups(struct hl_mesh_work *work);
enum hl_result hl_mesh_find_frames(struct hl_mesh_work *work);
/* Unit tangent and handedness of an output vertex; false when it is free. */
bool hl_mesh_tangent(const struct hl_mesh_work *work, const uint32_t *vertex,
                     float out[4]);
#endif
