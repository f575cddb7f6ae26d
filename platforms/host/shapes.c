/* SPDX-License-Identifier: Zlib */
/* Shapes of built-in scenes, appended to the builder's mesh in hand. */
#include <math.h>
#include <string.h>
#include "platforms/host/builder.h"
#include "platforms/host/util.h"

static uint32_t vertex(struct hlh_builder *b, struct hlh_v3 p, struct hlh_v3 n,
                       double u, double v)
{
    struct hlh_vertex *out = hlh_push(&b->vertices, &b->n_vertices,
                                      sizeof *out);
    if (!out) {
        b->failed = true;
        return 0;
    }
    out->position[0] = (float)p.x;
    out->position[1] = (float)p.y;
    out->position[2] = (float)p.z;
    out->normal[0] = (float)n.x;
    out->normal[1] = (float)n.y;
    out->normal[2] = (float)n.z;
    out->uv[0] = (float)u;
    out->uv[1] = (float)v;
    for (int k = 0; k < 4; k++)
        out->color[k] = 1;
    return b->n_vertices - 1;
}

static void triangle(struct hlh_builder *b, uint32_t i, uint32_t j, uint32_t k)
{
    uint32_t corner[3] = {i, j, k};
    for (int c = 0; c < 3; c++) {
        uint32_t *slot = hlh_push(&b->indices, &b->n_indices, sizeof *slot);
        if (slot)
            *slot = corner[c];
        else
            b->failed = true;
    }
}

/* Cells of a grid of (nu + 1) x (nv + 1) vertices that starts at first, u
 * fastest; flip turns the winding. A cell that closes to a triangle (pole,
 * cone) loses its empty half when the mesh is cleaned. */
static void grid(struct hlh_builder *b, uint32_t first, uint32_t nu,
                 uint32_t nv, bool flip)
{
    for (uint32_t j = 0; j < nv; j++)
        for (uint32_t i = 0; i < nu; i++) {
            uint32_t p = first + j * (nu + 1) + i, q = p + nu + 1;
            if (flip) {
                triangle(b, p, q + 1, p + 1);
                triangle(b, p, q, q + 1);
            } else {
                triangle(b, p, p + 1, q + 1);
                triangle(b, p, q + 1, q);
            }
        }
}

static struct hlh_v3 cross(struct hlh_v3 a, struct hlh_v3 b)
{
    return hlh_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                  a.x * b.y - a.y * b.x);
}

static double length(struct hlh_v3 a)
{
    return sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
}

static struct hlh_v3 unit(struct hlh_v3 a)
{
    double l = length(a);
    return hlh_v3(a.x / l, a.y / l, a.z / l);
}

void hlh_add_patch(struct hlh_builder *b, struct hlh_v3 a, struct hlh_v3 u,
                   struct hlh_v3 v, uint32_t cuts_u, uint32_t cuts_v)
{
    struct hlh_v3 n = unit(cross(u, v));
    double metres_u = length(u), metres_v = length(v);
    uint32_t first = b->n_vertices;
    for (uint32_t j = 0; j <= cuts_v; j++)
        for (uint32_t i = 0; i <= cuts_u; i++) {
            double s = (double)i / cuts_u, t = (double)j / cuts_v;
            vertex(b, hlh_mad(hlh_mad(a, u, s), v, t), n, s * metres_u,
                   (1 - t) * metres_v);
        }
    grid(b, first, cuts_u, cuts_v, false);
}

/* Axis k of face f (0 to 5: +x -x +y -y +z -z) of a cube of half extent 1:
 * origin, first and second edge; edge x edge points outward. */
static const signed char cube[6][3][3] = {
    {{1, -1, 1}, {0, 0, -2}, {0, 2, 0}}, {{-1, -1, -1}, {0, 0, 2}, {0, 2, 0}},
    {{-1, 1, 1}, {2, 0, 0}, {0, 0, -2}}, {{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}},
    {{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}}, {{1, -1, -1}, {-2, 0, 0}, {0, 2, 0}},
};

static struct hlh_v3 scaled(const signed char e[3], struct hlh_v3 half)
{
    return hlh_v3(e[0] * half.x, e[1] * half.y, e[2] * half.z);
}

void hlh_add_box(struct hlh_builder *b, struct hlh_v3 center,
                 struct hlh_v3 half, uint32_t cuts, bool inward)
{
    for (int f = 0; f < 6; f++) {
        struct hlh_v3 a = hlh_mad(center, scaled(cube[f][0], half), 1);
        struct hlh_v3 u = scaled(cube[f][1], half);
        struct hlh_v3 v = scaled(cube[f][2], half);
        if (inward)
            hlh_add_patch(b, hlh_mad(a, u, 1), hlh_v3(-u.x, -u.y, -u.z), v,
                          cuts, cuts);
        else
            hlh_add_patch(b, a, u, v, cuts, cuts);
    }
}

static double toward(double v, double limit)
{
    return v < -limit ? -limit : v > limit ? limit : v;
}

/* Cells are closer near the edges: the position along an edge runs through
 * the rounding, the flat part and the rounding in thirds. */
static double spread(uint32_t i, uint32_t cuts, double half, double round)
{
    uint32_t corner = cuts / 3;
    double flat = half - round;
    if (i <= corner)
        return -half + round * i / corner;
    if (i >= cuts - corner)
        return half - round * (cuts - i) / corner;
    return -flat + 2 * flat * (i - corner) / (cuts - 2 * corner);
}

static double pick(const signed char e[3], struct hlh_v3 v)
{
    return e[0] ? v.x : e[1] ? v.y : v.z;
}

void hlh_add_rounded_box(struct hlh_builder *b, struct hlh_v3 half,
                         double round, uint32_t cuts)
{
    for (int f = 0; f < 6; f++) {
        uint32_t first = b->n_vertices;
        const signed char *e = cube[f][1], *g = cube[f][2];
        double hu = pick(e, half), hv = pick(g, half);
        struct hlh_v3 mid = scaled(cube[f][0], half);
        mid = hlh_mad(hlh_mad(mid, scaled(e, half), 0.5), scaled(g, half),
                      0.5);
        for (uint32_t j = 0; j <= cuts; j++)
            for (uint32_t i = 0; i <= cuts; i++) {
                double su = spread(i, cuts, hu, round) / (2 * hu);
                double sv = spread(j, cuts, hv, round) / (2 * hv);
                struct hlh_v3 p = hlh_mad(hlh_mad(mid, scaled(e, half), su),
                                          scaled(g, half), sv);
                struct hlh_v3 core =
                    hlh_v3(toward(p.x, half.x - round),
                           toward(p.y, half.y - round),
                           toward(p.z, half.z - round));
                struct hlh_v3 n = unit(hlh_mad(p, core, -1));
                vertex(b, hlh_mad(core, n, round), n, su + 0.5, 0.5 - sv);
            }
        grid(b, first, cuts, cuts, false);
    }
}

void hlh_add_sphere(struct hlh_builder *b, struct hlh_v3 center, double radius,
                    uint32_t around, uint32_t along)
{
    uint32_t first = b->n_vertices;
    for (uint32_t j = 0; j <= along; j++)
        for (uint32_t i = 0; i <= around; i++) {
            double s, c, ring, y, u = (double)i / around;
            struct hlh_v3 n;
            hlh_sincos(0.5 * j / along, &ring, &y);
            /* The poles and the seam must close exactly. */
            if (j == along)
                ring = 0;
            hlh_sincos(i == around ? 0 : u, &s, &c);
            n = hlh_v3(c * ring, y, s * ring);
            vertex(b, hlh_mad(center, n, radius), n, u, (double)j / along);
        }
    grid(b, first, around, along, false);
}

/* Two unit vectors across axis, x cross z = axis. */
static void frame(struct hlh_v3 axis, struct hlh_v3 *x, struct hlh_v3 *z)
{
    struct hlh_v3 helper = fabs(axis.y) < 0.9 ? hlh_v3(0, 1, 0)
                                              : hlh_v3(1, 0, 0);
    *z = unit(cross(helper, axis));
    *x = cross(*z, axis);
}

static void cap(struct hlh_builder *b, struct hlh_v3 center, struct hlh_v3 n,
                double r, uint32_t around)
{
    struct hlh_v3 x, z;
    uint32_t middle = vertex(b, center, n, 0, 0);
    frame(n, &x, &z);
    for (uint32_t i = 0; i < around; i++) {
        double s, c;
        hlh_sincos((double)i / around, &s, &c);
        vertex(b, hlh_mad(hlh_mad(center, x, c * r), z, s * r), n, c, s);
    }
    for (uint32_t i = 0; i < around; i++)
        triangle(b, middle, middle + 1 + i, middle + 1 + (i + 1) % around);
}

void hlh_add_tube(struct hlh_builder *b, struct hlh_v3 p, struct hlh_v3 q,
                  double r, double s, uint32_t around, uint32_t along,
                  bool caps)
{
    struct hlh_v3 d = hlh_mad(q, p, -1), axis = unit(d), x, z;
    double tall = length(d), slope = (r - s) / tall;
    uint32_t first = b->n_vertices;
    frame(axis, &x, &z);
    for (uint32_t j = 0; j <= along; j++)
        for (uint32_t i = 0; i <= around; i++) {
            double sine, cosine, t = (double)j / along;
            double radius = r + (s - r) * t;
            struct hlh_v3 out;
            hlh_sincos(i == around ? 0 : (double)i / around, &sine, &cosine);
            out = hlh_v3(x.x * cosine + z.x * sine, x.y * cosine + z.y * sine,
                         x.z * cosine + z.z * sine);
            vertex(b, hlh_mad(hlh_mad(p, d, t), out, radius),
                   unit(hlh_mad(out, axis, slope)), (double)i / around,
                   (1 - t) * tall);
        }
    grid(b, first, around, along, false);
    if (caps && r > 0)
        cap(b, p, hlh_v3(-axis.x, -axis.y, -axis.z), r, around);
    if (caps && s > 0)
        cap(b, q, axis, s, around);
}

void hlh_add_torus(struct hlh_builder *b, struct hlh_v3 center, double radius,
                   double tube, uint32_t around, uint32_t along)
{
    uint32_t first = b->n_vertices;
    for (uint32_t j = 0; j <= along; j++)
        for (uint32_t i = 0; i <= around; i++) {
            double s, c, rise, out;
            struct hlh_v3 n, ring;
            hlh_sincos(i == around ? 0 : (double)i / around, &s, &c);
            hlh_sincos(j == along ? 0 : (double)j / along, &rise, &out);
            ring = hlh_mad(center, hlh_v3(c, 0, s), radius);
            n = hlh_v3(c * out, -rise, s * out);
            vertex(b, hlh_mad(ring, n, tube), n, (double)i / around,
                   (double)j / along);
        }
    grid(b, first, around, along, false);
}
