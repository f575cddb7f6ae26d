/* SPDX-License-Identifier: Zlib */
/* Tangents for a mesh that has uv and no tangents of its own. */
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/internal.h"

struct sums { struct v3 plus, minus; };

struct face { struct v3 along; double w; bool valid; };

/* + 0 so that -0 and 0 weld. */
static void key_of(float key[8], const struct hlh_vertex *v)
{
    for (int k = 0; k < 3; k++) {
        key[k] = v->position[k] + 0.0f;
        key[3 + k] = v->normal[k] + 0.0f;
    }
    key[6] = v->uv[0] + 0.0f;
    key[7] = v->uv[1] + 0.0f;
}

/* FNV-1a. */
static uint32_t hash_of(const float key[8])
{
    unsigned char bytes[8 * sizeof(float)];
    uint32_t h = 2166136261u;
    memcpy(bytes, key, sizeof bytes);
    for (size_t i = 0; i < sizeof bytes; i++)
        h = (h ^ bytes[i]) * 16777619u;
    return h;
}

/* first[v] = the first vertex that equals v. `table` has `size` slots, a power
 * of two above twice the vertices, so that probing ends soon. */
static void weld(uint32_t *first, uint32_t *table, uint32_t size,
                 const struct hlh_mesh *mesh)
{
    float key[8], other[8];
    memset(table, 0, size * sizeof *table);
    for (uint32_t v = 0; v < mesh->n_vertices; v++) {
        key_of(key, &mesh->vertices[v]);
        uint32_t at = hash_of(key) & (size - 1);
        for (; table[at]; at = (at + 1) & (size - 1)) {
            key_of(other, &mesh->vertices[table[at] - 1]);
            if (memcmp(key, other, sizeof key) == 0)
                break;
        }
        if (!table[at])
            table[at] = v + 1;
        first[v] = table[at] - 1;
    }
}

static struct v3 position_of(const struct hlh_mesh *mesh, uint32_t corner)
{
    return v3_of(mesh->vertices[mesh->indices[corner]].position);
}

/* dP/du of a triangle. Valid unless its uv have no area. */
static struct face face_of(const struct hlh_mesh *mesh, uint32_t corner)
{
    const struct hlh_vertex *v = mesh->vertices;
    const uint32_t *i = mesh->indices + corner;
    double u0 = (double)v[i[0]].uv[0], v0 = (double)v[i[0]].uv[1];
    double u1 = (double)v[i[1]].uv[0] - u0, v1 = (double)v[i[1]].uv[1] - v0;
    double u2 = (double)v[i[2]].uv[0] - u0, v2 = (double)v[i[2]].uv[1] - v0;
    double det = u1 * v2 - u2 * v1;
    struct v3 e1 = sub3(v3_of(v[i[1]].position), v3_of(v[i[0]].position));
    struct v3 e2 = sub3(v3_of(v[i[2]].position), v3_of(v[i[0]].position));
    struct v3 along = sub3(mul3(e1, v2), mul3(e2, v1));
    if (!(fabs(det) > 0) || !isfinite(det))
        return (struct face){ v3(0, 0, 0), 1, false };
    /* v runs down and green up: the opposite of the uv winding's sign. */
    double sign = det > 0 ? 1 : -1;
    return (struct face){ mul3(along, sign), -sign, true };
}

static double corner_angle(const struct hlh_mesh *mesh, uint32_t corner)
{
    uint32_t base = corner - corner % 3;
    struct v3 p = position_of(mesh, corner);
    struct v3 a = sub3(position_of(mesh, base + (corner + 1) % 3), p);
    struct v3 b = sub3(position_of(mesh, base + (corner + 2) % 3), p);
    struct v3 c = cross3(a, b);
    return atan2(sqrt(dot3(c, c)), dot3(a, b));
}

static void accumulate(struct sums *sums, const uint32_t *first,
                       const struct hlh_mesh *mesh)
{
    for (uint32_t c = 0; c < mesh->n_indices; c++) {
        struct face f = face_of(mesh, c - c % 3);
        if (!f.valid)
            continue;
        uint32_t v = mesh->indices[c];
        struct v3 n = unit3(v3_of(mesh->vertices[v].normal));
        struct v3 t = unit3(sub3(f.along, mul3(n, dot3(n, f.along))));
        struct v3 *sum = f.w > 0 ? &sums[first[v]].plus
                                 : &sums[first[v]].minus;
        *sum = add3(*sum, mul3(t, corner_angle(mesh, c)));
    }
}

/* A corner whose own uv are degenerate borrows what its vertex has. */
static struct hlr_tangent corner_tangent(const struct sums *s, struct face f)
{
    if (!f.valid)
        f.w = dot3(s->plus, s->plus) > 0 ? 1 : -1;
    return (struct hlr_tangent){ unit3(f.w > 0 ? s->plus : s->minus), f.w };
}

bool hlr_tangents_make(struct hlr_tangent **out, const struct hlh_mesh *mesh)
{
    uint32_t size = 16;
    while (size / 2 <= mesh->n_vertices && size < UINT32_C(1) << 31)
        size *= 2;
    size_t n = (size_t)mesh->n_vertices + 1;
    struct hlr_tangent *made = calloc((size_t)mesh->n_indices + 1,
                                      sizeof *made);
    struct sums *sums = calloc(n, sizeof *sums);
    uint32_t *first = calloc(n, sizeof *first);
    uint32_t *table = calloc(size, sizeof *table);
    bool ok = made && sums && first && table;
    if (ok) {
        weld(first, table, size, mesh);
        accumulate(sums, first, mesh);
        for (uint32_t c = 0; c < mesh->n_indices; c++)
            made[c] = corner_tangent(&sums[first[mesh->indices[c]]],
                                     face_of(mesh, c - c % 3));
        *out = made;
    } else {
        free(made);
    }
    free(sums);
    free(first);
    free(table);
    return ok;
}
