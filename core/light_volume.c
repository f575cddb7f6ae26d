/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "core/exact.h"
#include "core/light_volume.h"
#include "core/vec.h"

/* Room for the roundings of a matrix product and of a vertex stage, which
 * are some 2^-22 of coordinates as large as a light's distance: seen from up
 * to a hundred radii away. */
#define ROOM 1.0001f

/* Cones wider than this (56 degrees) are larger than the sphere: seen from the
 * side half of it, from the end twice. */
#define CONE_SLOPE 1.5

/* ---- sphere ------------------------------------------------------------- */

struct build { struct hl_light_meshes *m; uint32_t n_v, n_i; };

static hl_vec3 at(const struct build *b, uint16_t i)
{
    return hl_load3(b->m->vertex[i]);
}

static uint16_t vertex(struct build *b, hl_vec3 p)
{
    float *v = b->m->vertex[b->n_v];
    v[0] = p.x;
    v[1] = p.y;
    v[2] = p.z;
    v[3] = 1;
    return (uint16_t)b->n_v++;
}

static void face(struct build *b, uint16_t i, uint16_t j, uint16_t k)
{
    uint16_t *out = &b->m->index[b->n_i];
    out[0] = i;
    out[1] = j;
    out[2] = k;
    b->n_i += 3;
}

/* The vertex at the middle of an edge, made once. */
static uint16_t middle(struct build *b, uint16_t i, uint16_t j)
{
    hl_vec3 m = hl_normalize3(hl_add3(at(b, i), at(b, j)));
    for (uint32_t k = 12; k < b->n_v; k++) {
        hl_vec3 d = hl_sub3(at(b, (uint16_t)k), m);
        if (hl_dot3(d, d) < 1e-6f)
            return (uint16_t)k;
    }
    return vertex(b, m);
}

static void icosahedron(struct build *b)
{
    /* The golden ratio and 1, normalised. */
    const float s = 0.5257311f, t = 0.8506508f;
    const float v[12][3] = {
        { -s, t, 0 }, { s, t, 0 }, { -s, -t, 0 }, { s, -t, 0 },
        { 0, -s, t }, { 0, s, t }, { 0, -s, -t }, { 0, s, -t },
        { t, 0, -s }, { t, 0, s }, { -t, 0, -s }, { -t, 0, s } };
    for (int i = 0; i < 12; i++)
        vertex(b, hl_load3(v[i]));
}

static void sphere(struct build *b)
{
    static const uint8_t f[20][3] = {
        { 0, 11, 5 }, { 0, 5, 1 }, { 0, 1, 7 }, { 0, 7, 10 }, { 0, 10, 11 },
        { 1, 5, 9 }, { 5, 11, 4 }, { 11, 10, 2 }, { 10, 7, 6 }, { 7, 1, 8 },
        { 3, 9, 4 }, { 3, 4, 2 }, { 3, 2, 6 }, { 3, 6, 8 }, { 3, 8, 9 },
        { 4, 9, 5 }, { 2, 4, 11 }, { 6, 2, 10 }, { 8, 6, 7 }, { 9, 8, 1 } };
    icosahedron(b);
    for (int i = 0; i < 20; i++) {
        uint16_t x = f[i][0], y = f[i][1], z = f[i][2];
        uint16_t xy = middle(b, x, y), yz = middle(b, y, z);
        uint16_t zx = middle(b, z, x);
        face(b, x, xy, zx);
        face(b, y, yz, xy);
        face(b, z, zx, yz);
        face(b, xy, yz, zx);
    }
}

/* Out until the nearest face's plane is ROOM away from the centre. */
static void circumscribe(struct build *b)
{
    float least = 1;
    for (uint32_t i = 0; i < b->n_i; i += 3) {
        const uint16_t *f = &b->m->index[i];
        hl_vec3 a = at(b, f[0]);
        hl_vec3 n = hl_normalize3(hl_cross3(hl_sub3(at(b, f[1]), a),
                                            hl_sub3(at(b, f[2]), a)));
        float d = hl_dot3(n, a);
        least = d < least ? d : least;
    }
    for (uint32_t i = 0; i < b->n_v; i++)
        for (int k = 0; k < 3; k++)
            b->m->vertex[i][k] *= ROOM / least;
}

/* ---- cone --------------------------------------------------------------- */

/* The apex goes back a little, so that the cone's own apex is inside. */
static void cone(struct build *b)
{
    const double turn = 2 * 3.14159265358979323846 / HL_LIGHT_RING;
    float r = ROOM * ROOM / (float)hl_exact_cos(turn / 2);
    uint16_t apex = vertex(b, hl_v3(0, 0, 1 - ROOM));
    uint16_t ring = (uint16_t)b->n_v;
    for (int i = 0; i < HL_LIGHT_RING; i++)
        vertex(b, hl_v3(r * (float)hl_exact_cos(turn * i),
                        r * (float)hl_exact_cos(turn * (i - HL_LIGHT_RING / 4)),
                        ROOM));
    for (int i = 0; i < HL_LIGHT_RING; i++)
        face(b, apex, (uint16_t)(ring + (i + 1) % HL_LIGHT_RING),
             (uint16_t)(ring + i));
    for (int i = 1; i + 1 < HL_LIGHT_RING; i++)
        face(b, ring, (uint16_t)(ring + i), (uint16_t)(ring + i + 1));
}

void hl_light_meshes_make(struct hl_light_meshes *out)
{
    struct build b = { out, 0, 0 };
    memset(out, 0, sizeof *out);
    sphere(&b);
    circumscribe(&b);
    cone(&b);
}

/* ---- placing ------------------------------------------------------------ */

static void set_column(float m[16], int c, hl_vec3 v)
{
    m[4 * c] = v.x;
    m[4 * c + 1] = v.y;
    m[4 * c + 2] = v.z;
}

/* z along the axis; x across it and the world's axis that it is farthest
 * from, so that no direction is a pole. */
static void orient(float m[16], hl_vec3 z, float across, float along)
{
    float ax = fabsf(z.x), ay = fabsf(z.y), az = fabsf(z.z);
    hl_vec3 far_from = ax <= ay && ax <= az ? hl_v3(1, 0, 0)
                       : ay <= az ? hl_v3(0, 1, 0) : hl_v3(0, 0, 1);
    hl_vec3 x = hl_normalize3(hl_cross3(far_from, z));
    hl_vec3 y = hl_cross3(z, x);
    set_column(m, 0, hl_scale3(x, across));
    set_column(m, 1, hl_scale3(y, across));
    set_column(m, 2, hl_scale3(z, along));
}

bool hl_light_volume(const struct hl_light *l, uint32_t *first,
                     uint32_t *count, float world[16])
{
    double slope = CONE_SLOPE + 1;
    if (l->kind == HL_DIRECTIONAL)
        return false;
    if (l->kind == HL_SPOT && (double)l->outer < 1.5)
        slope = hl_exact_tan((double)l->outer);
    bool is_cone = slope <= CONE_SLOPE;
    *first = is_cone ? HL_LIGHT_CONE : HL_LIGHT_SPHERE;
    *count = is_cone ? HL_LIGHT_CONE_N : HL_LIGHT_SPHERE_N;
    memset(world, 0, 16 * sizeof *world);
    /* A cone of no angle is a line: it gets a slope of 2^-10. */
    float across = (float)(slope > 1.0 / 1024 ? slope : 1.0 / 1024);
    orient(world, is_cone ? hl_normalize3(hl_load3(l->direction))
                          : hl_v3(0, 0, 1),
           l->radius * (is_cone ? across : 1), l->radius);
    set_column(world, 3, hl_load3(l->position));
    world[15] = 1;
    return true;
}
