/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"
#include "core/shadow_volume.h"

/* The facing of a face is the sign of a sum of three products of a normal, a
 * difference of two, with a difference of floats. By the rules of double
 * rounding (unit 2^-53) it is off by less than 8 units of
 * spread * (|dx| + |dy| + |dz|) (compare the first filter of Shewchuk's
 * orient3d); twice that leaves room for the bound's own rounding. Within it a
 * face counts as edge-on, unlit, so that a volume is never inside out. No
 * float is so large or small that these products leave a double's range. */
#define FACING_ERROR (16.0 / 9007199254740992.0)

/* ---- light ------------------------------------------------------------ */

static bool light_valid(const float light[4])
{
    if (!light || !hl_mesh_finite(light, 4))
        return false;
    return light[3] == 1 || (light[3] == 0 && (light[0] != 0 ||
                                               light[1] != 0 ||
                                               light[2] != 0));
}

/* Rows of the inverse of the upper 3 x 3 times the determinant, which is
 * returned. */
static double adjugate(double out[3][3], const float m[16])
{
    double column[3][3];
    for (int c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++)
            column[c][r] = (double)m[4 * c + r];
    for (int i = 0; i < 3; i++)
        hl_mesh_cross(out[i], column[(i + 1) % 3], column[(i + 2) % 3]);
    return hl_mesh_dot(column[0], out[0]);
}

bool hl_shadow_light(float out[4], const float world[16],
                     const struct hl_light *l)
{
    double rows[3][3], v[3], model[3];
    float found[4];
    bool parallel = l->kind == HL_DIRECTIONAL;
    double det = adjugate(rows, world);
    for (int i = 0; i < 3; i++)
        v[i] = parallel ? -(double)l->direction[i]
                        : (double)l->position[i] - (double)world[12 + i];
    for (int i = 0; i < 3; i++)
        model[i] = hl_mesh_dot(rows[i], v) / det;
    /* Lengths that a shader's floats hold, whatever the scale of world. */
    if (parallel && !hl_mesh_normalise(model))
        return false;
    for (int i = 0; i < 3; i++)
        found[i] = (float)model[i];
    found[3] = parallel ? 0.0f : 1.0f;
    if (!light_valid(found))
        return false;
    memcpy(out, found, sizeof found);
    return true;
}

/* ---- faces ------------------------------------------------------------ */

/* 1 lit, -1 the light is behind, 0 edge-on. */
static int facing(const struct hl_shadow_mesh *mesh, uint32_t f,
                  const float light[4])
{
    const struct hl_shadow_face *face = &mesh->faces[f];
    const float *p = &mesh->vertices[8 * (size_t)mesh->corners[3 * (size_t)f]];
    double w = (double)light[3];
    double x = (double)light[0] - w * (double)p[0];
    double y = (double)light[1] - w * (double)p[1];
    double z = (double)light[2] - w * (double)p[2];
    double side = face->normal[0] * x + face->normal[1] * y +
                  face->normal[2] * z;
    double error = FACING_ERROR * face->spread *
                   (fabs(x) + fabs(y) + fabs(z));
    return (side > error) - (side < -error);
}

/* signs[2 f] is how often face f's frustum is in the sum, -1 when turned
 * over, signs[2 f + 1] the same for its edges gone the other way. The last
 * entry is what an edge's missing face adds. */
static uint32_t find_facing(int8_t *signs, const struct hl_shadow_mesh *mesh,
                            const float light[4], unsigned parts)
{
    uint32_t n_lit = 0;
    int least = parts & HL_SHADOW_TWO_SIDED ? -1 : 0;
    for (uint32_t f = 0; f < mesh->n_faces; f++) {
        int sign = facing(mesh, f, light);
        sign = sign < least ? 0 : sign;
        signs[2 * (size_t)f] = (int8_t)sign;
        signs[2 * (size_t)f + 1] = (int8_t)-sign;
        n_lit += sign != 0;
    }
    signs[2 * (size_t)mesh->n_faces] = 0;
    return n_lit;
}

/* twin: 0 as they are; 1 at infinity, turned over. */
static uint32_t *write_caps(uint32_t *out, const struct hl_shadow_mesh *mesh,
                            const int8_t *signs, uint32_t twin)
{
    for (size_t f = 0; f < mesh->n_faces; f++) {
        const uint32_t *corner = &mesh->corners[3 * f];
        bool turned = (signs[2 * f] < 0) != (twin != 0);
        if (signs[2 * f] == 0)
            continue;
        *out++ = 2 * corner[0] + twin;
        *out++ = 2 * corner[turned ? 2 : 1] + twin;
        *out++ = 2 * corner[turned ? 1 : 2] + twin;
    }
    return out;
}

/* ---- edges ------------------------------------------------------------ */

/* How many more lit faces go from the edge's a to its b than back. */
static int32_t edge_sum(const struct hl_shadow_mesh *mesh,
                        const int8_t *signs, uint32_t e)
{
    const struct hl_shadow_edge *edge = &mesh->edges[e];
    int32_t sum = 0;
    if (e < mesh->n_narrow)
        return signs[edge->first] + signs[edge->second];
    for (uint32_t i = 0; i < edge->second; i++)
        sum += signs[mesh->refs[edge->first + i]];
    return sum;
}

static uint32_t count_sides(const struct hl_shadow_mesh *mesh,
                            const int8_t *signs)
{
    uint32_t n = 0;
    for (uint32_t e = 0; e < mesh->n_edges; e++) {
        int32_t sum = edge_sum(mesh, signs, e);
        n += (uint32_t)(sum < 0 ? -sum : sum);
    }
    return n;
}

/* The side below an edge that lit faces go from `a` to `b`: it goes from b to
 * a, then out. */
static uint32_t *write_side(uint32_t *out, uint32_t a, uint32_t b,
                            bool parallel)
{
    *out++ = 2 * b;
    *out++ = 2 * a;
    *out++ = 2 * a + 1;
    if (parallel)
        return out;
    *out++ = 2 * b;
    *out++ = 2 * a + 1;
    *out++ = 2 * b + 1;
    return out;
}

static uint32_t *write_sides(uint32_t *out, const struct hl_shadow_mesh *mesh,
                             const int8_t *signs, bool parallel)
{
    for (uint32_t e = 0; e < mesh->n_edges; e++) {
        int32_t sum = edge_sum(mesh, signs, e);
        uint32_t a = mesh->edges[e].a, b = mesh->edges[e].b;
        for (; sum > 0; sum--)
            out = write_side(out, a, b, parallel);
        for (; sum < 0; sum++)
            out = write_side(out, b, a, parallel);
    }
    return out;
}

/* ---- whole ------------------------------------------------------------ */

uint32_t hl_shadow_max_indices(const struct hl_shadow_mesh *mesh,
                               unsigned parts)
{
    uint32_t sides = parts & HL_SHADOW_TWO_SIDED ? 3 * mesh->n_faces
                                                 : mesh->max_sides;
    return (parts & HL_SHADOW_FRONT ? 3 * mesh->n_faces : 0) +
           (parts & HL_SHADOW_SIDES ? 6 * sides : 0) +
           (parts & HL_SHADOW_BACK ? 3 * mesh->n_faces : 0);
}

size_t hl_shadow_scratch(const struct hl_shadow_mesh *mesh)
{
    return 2 * (size_t)mesh->n_faces + 1;
}

static enum hl_result write_parts(struct hl_shadow_counts *counts,
                                  uint32_t *indices, size_t max_indices,
                                  const struct hl_shadow_mesh *mesh,
                                  const int8_t *signs, bool parallel,
                                  unsigned parts)
{
    bool sides = (parts & HL_SHADOW_SIDES) != 0;
    uint32_t *end = indices;
    if (parts & HL_SHADOW_FRONT)
        counts->n_front = 3 * counts->n_lit;
    if (parts & HL_SHADOW_BACK && !parallel)
        counts->n_back = 3 * counts->n_lit;
    if (max_indices < hl_shadow_max_indices(mesh, parts)) {
        if (sides)
            counts->n_sides = (parallel ? 3 : 6) * count_sides(mesh, signs);
        if (max_indices < (size_t)counts->n_front + counts->n_sides +
                          counts->n_back)
            return HL_ERR_LIMIT;
    }
    if (counts->n_front)
        end = write_caps(end, mesh, signs, 0);
    if (sides)
        end = write_sides(end, mesh, signs, parallel);
    counts->n_sides = (uint32_t)(end - indices) - counts->n_front;
    if (counts->n_back)
        write_caps(end, mesh, signs, 1);
    return HL_OK;
}

enum hl_result hl_shadow_volume_write(struct hl_shadow_counts *counts,
                                      uint32_t *indices, size_t max_indices,
                                      void *scratch, size_t scratch_bytes,
                                      const struct hl_shadow_mesh *mesh,
                                      const float light[4], unsigned parts)
{
    if (!counts)
        return HL_ERR_INVALID;
    memset(counts, 0, sizeof *counts);
    if (!mesh || !light_valid(light) || (!indices && max_indices > 0) ||
        (!scratch && scratch_bytes > 0))
        return HL_ERR_INVALID;
    if (scratch_bytes < hl_shadow_scratch(mesh))
        return HL_ERR_LIMIT;
    counts->n_lit = find_facing(scratch, mesh, light, parts);
    return write_parts(counts, indices, max_indices, mesh, scratch,
                       light[3] == 0, parts);
}
