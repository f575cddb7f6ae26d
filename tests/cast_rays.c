/* SPDX-License-Identifier: Zlib */
/* Rays from texels to lights. */
#include <math.h>
#include "tests/cast_kit.h"

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = inverse of the item's 3 x 3 times v. */
static void to_model(double out[3], const float m[16], const double v[3])
{
    double c[3][3], x[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c[i][k] = (double)m[4 * i + k];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
            x[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] -
                      a[(k + 2) % 3] * b[(k + 1) % 3];
        }
    for (int i = 0; i < 3; i++)
        out[i] = dot(x[i], v) / dot(c[0], x[0]);
}

/* Where the ray first meets the item, least < t; quads from the side of their
 * normal alone unless `both`. */
static bool hit(const struct hl_item *it, const double from[3],
                const double along[3], double least, bool both, double *t)
{
    double o[3], d[3], p[3], low = -1e30, high = 1e30;
    bool is_quad = it->bounds_max[2] == 0;
    for (int k = 0; k < 3; k++)
        p[k] = from[k] - (double)it->world[12 + k];
    to_model(o, it->world, p);
    to_model(d, it->world, along);
    for (int k = 0; k < (is_quad ? 2 : 3); k++) {
        double a = (-1 - o[k]) / d[k], b = (1 - o[k]) / d[k];
        low = fmax(low, fmin(a, b));
        high = fmin(high, fmax(a, b));
    }
    if (is_quad) {
        *t = -o[2] / d[2];
        return *t > least && *t >= low && *t <= high && (both || d[2] < 0);
    }
    *t = low > least ? low : high;
    return low <= high && *t > least;
}

/* A quad casts where the light is before it: rays go to the light, so they
 * leave through the normal's side. A box cannot hide itself from where it
 * faces the light, and is dark elsewhere. */
static bool hidden(const struct cs_rig *g, const struct hl_item *own,
                   const double p[3], const struct hl_light *l)
{
    double along[3], t;
    bool parallel = l->kind == HL_DIRECTIONAL;
    if (!l->shadow)
        return false;
    for (int k = 0; k < 3; k++)
        along[k] = parallel ? -(double)l->direction[k]
                            : (double)l->position[k] - p[k];
    for (uint32_t i = 0; i < g->s.frame.n_items; i++) {
        const struct hl_item *it = &g->s.item[i];
        bool both = it->surface == FK_TWO_SIDED;
        double back[3] = { -along[0], -along[1], -along[2] }, o[3];
        if (!it->shadow_mesh || it->no_shadow || it == own ||
            it->surface == FK_BLENDED)
            continue;
        to_model(o, it->world, back);
        if (it->bounds_max[2] == 0 && !both && o[2] >= 0)
            continue;
        if (hit(it, p, along, 0, true, &t) && (parallel || t < 1))
            return true;
    }
    return false;
}

/* The point of the item seen at texel x, y; false: it is not there. */
static bool point_at(double p[3], const struct cs_rig *g,
                     const struct hl_item *it, double x, double y)
{
    const struct hl_camera *c = &g->s.frame.camera;
    double ty = (double)c->tan_half_y, tx = ty * FK_W / FK_H, t;
    double v[3] = { tx * (2 * x / CS_W - 1), ty * (1 - 2 * y / CS_H), -1 };
    double from[3], along[3];
    for (int k = 0; k < 3; k++) {
        const float *m = c->view;
        double e[3] = { (double)m[4 * k], (double)m[4 * k + 1],
                        (double)m[4 * k + 2] };
        double back[3] = { -(double)m[12], -(double)m[13], -(double)m[14] };
        from[k] = dot(e, back);
        along[k] = dot(e, v);
    }
    if (!hit(it, from, along, (double)c->near, true, &t))
        return false;
    for (int k = 0; k < 3; k++)
        p[k] = from[k] + along[k] * t;
    return true;
}

/* 1 hidden, 0 not, -1 within a texel of the other. */
int cs_shade(const struct cs_rig *g, const struct hl_item *it, int i,
                    const struct hl_light *l)
{
    int n = 0, seen = 0;
    for (int k = 0; k < 9; k++) {
        double p[3];
        if (!point_at(p, g, it, i % CS_W + 0.5 + k % 3 - 1,
                      i / CS_W + 0.5 + k / 3 - 1))
            continue;
        seen++;
        n += hidden(g, it, p, l);
    }
    return n == 0 ? 0 : n == seen ? 1 : -1;
}
