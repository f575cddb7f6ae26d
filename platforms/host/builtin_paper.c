/* SPDX-License-Identifier: Zlib */
/* Figures 7 and 8 of Kircher and Lawrance 2009: many small objects on a
 * floor, about a light an object. The paper prints pictures and counts, not
 * data: counts are its own, the rest is ours. */
#include <math.h>
#include "platforms/host/builder.h"

enum { N_SHAPES = 6, N_PAINTS = 12 };

/* All shapes have half extent 1 and stand on y = 0. */
static uint32_t shape(struct hlh_builder *b, uint32_t kind, uint32_t paint)
{
    switch (kind) {
    case 0:
        hlh_add_sphere(b, hlh_v3(0, 1, 0), 1, 32, 16);
        return hlh_build_mesh(b, "sphere", paint);
    case 1:
        hlh_add_box(b, hlh_v3(0, 1, 0), hlh_v3(0.85, 1, 0.85), 4, false);
        return hlh_build_mesh(b, "box", paint);
    case 2:
        hlh_add_rounded_box(b, hlh_v3(0.9, 0.9, 0.9), 0.22, 7);
        return hlh_build_mesh(b, "rounded box", paint);
    case 3:
        hlh_add_torus(b, hlh_v3(0, 0.34, 0), 0.68, 0.34, 32, 14);
        return hlh_build_mesh(b, "torus", paint);
    case 4:
        hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 1.9, 0), 0.75, 0.75, 32, 4,
                     true);
        return hlh_build_mesh(b, "drum", paint);
    default:
        hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 0.2, 0), 0.95, 0.95, 32, 1,
                     true);
        hlh_add_tube(b, hlh_v3(0, 0.2, 0), hlh_v3(0, 2.1, 0), 0.75, 0, 32, 6,
                     false);
        return hlh_build_mesh(b, "cone", paint);
    }
}

/* Mostly dielectrics, every sixth a metal; roughness 0.3 to 0.8. */
static void paints(struct hlh_builder *b, uint32_t *paint)
{
    for (uint32_t i = 0; i < N_PAINTS; i++) {
        bool metal = i % 6 == 5;
        double v = hlh_random(b, 0.45, 0.85);
        double saturation = hlh_random(b, 0.1, 0.5);
        struct hlh_v3 color = hlh_hue((double)i / N_PAINTS, saturation, v);
        paint[i] = hlh_build_material(b, metal ? "metal" : "paint", color,
                                      0.3 + 0.5 * ((i * 5) % N_PAINTS) /
                                                (N_PAINTS - 1),
                                      metal ? 0.7 : 0);
    }
}

struct stock {
    uint32_t paint[N_PAINTS];
    uint32_t mesh[N_SHAPES][N_PAINTS];           /* index + 1, 0: not made */
};

static void drop_object(struct hlh_builder *b, struct stock *stock,
                        struct hlh_v3 at, double size)
{
    uint32_t kind = hlh_random_below(b, N_SHAPES);
    uint32_t paint = hlh_random_below(b, N_PAINTS);
    uint32_t *mesh = &stock->mesh[kind][paint];
    if (!*mesh)
        *mesh = shape(b, kind, stock->paint[paint]) + 1;
    if (kind == 2)
        at.y += 0.9 * size;
    hlh_build_object(b, *mesh - 1, at, hlh_v3(size, size, size),
                     hlh_random(b, 0, 1));
}

static void floor_slab(struct hlh_builder *b, double half)
{
    uint32_t m = hlh_build_material(b, "floor", hlh_v3(0.62, 0.60, 0.57), 0.55,
                                    0);
    hlh_add_box(b, hlh_v3(0, -0.25, 0), hlh_v3(half, 0.25, half), 16, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", m));
}

void hlh_build_fig8(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0.5, 0.75, 0.5}, {4.2, 5.4}, {0.6, 0.95}, {0.45, 0.8}};
    struct stock stock = {{0}, {{0}}};
    floor_slab(b, 14);
    paints(b, stock.paint);
    for (uint32_t i = 0; i < 100; i++) {
        double x = (i % 10 - 4.5) * 2.5 + hlh_random(b, -0.4, 0.4);
        double z = (i / 10 - 4.5) * 2.5 + hlh_random(b, -0.4, 0.4);
        drop_object(b, &stock, hlh_v3(x, 0, z), hlh_random(b, 0.55, 0.85));
    }
    for (uint32_t i = 0; i < 81; i++)
        hlh_build_random_light(b, hlh_v3((i % 9 - 4.0) * 2.7, 1.65,
                                         (i / 9 - 4.0) * 2.7), &lamps);
    hlh_build_camera(b, hlh_v3(7.2, 9.4, 16.4), hlh_v3(0.2, 0, 1.2), 50);
}

/* A sunflower's order (Vogel 1979): turn by the golden angle, radius by the
 * square root, so that the packing is even and never a grid. */
void hlh_build_fig7(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0, 0.7, 0}, {3.6, 4.8}, {0.6, 0.95}, {0.4, 0.75}};
    struct stock stock = {{0}, {{0}}};
    const double golden = 0.38196601125010515;   /* turns: (3 - sqrt 5)/2 */
    floor_slab(b, 22);
    paints(b, stock.paint);
    for (uint32_t i = 0; i < 287; i++) {
        double s, c, r = 1.22 * sqrt(i + 0.5);
        hlh_sincos(golden * i, &s, &c);
        /* 286 objects and the floor are 287. */
        if (i < 286)
            drop_object(b, &stock, hlh_v3(c * r, 0, s * r),
                        hlh_random(b, 0.45, 0.8));
        hlh_sincos(golden * i + 0.05, &s, &c);
        hlh_build_random_light(b, hlh_v3(c * r, 1.6, s * r), &lamps);
    }
    hlh_build_camera(b, hlh_v3(9.5, 14.5, 25), hlh_v3(0, 0, 2.6), 50);
}
