/* SPDX-License-Identifier: Zlib */
/* Scenes made to break a filter: `thin` has features below a pixel and planes
 * seen edge-on; `many` has 1,000 objects that touch, coplanar, so that depth
 * and normal agree across every seam and only ids tell them apart. */
#include "platforms/host/builder.h"

/* A wire that sags: a parabola in straight pieces. */
static void wire(struct hlh_builder *b, struct hlh_v3 p, struct hlh_v3 q,
                 double sag, double radius)
{
    enum { PIECES = 12 };
    struct hlh_v3 last = p;
    for (int i = 1; i <= PIECES; i++) {
        double t = (double)i / PIECES;
        struct hlh_v3 at = hlh_mad(p, hlh_mad(q, p, -1), t);
        at.y -= 4 * sag * t * (1 - t);
        hlh_add_tube(b, last, at, radius, radius, 6, 1, false);
        last = at;
    }
}

/* Overhead lines between two rows of masts, radii 4 to 20 mm. */
static void lines(struct hlh_builder *b, uint32_t material)
{
    for (int i = 0; i < 6; i++) {
        double z = 4 - 6.0 * i;
        hlh_add_tube(b, hlh_v3(-7, 0, z), hlh_v3(-7, 5.5, z), 0.06, 0.04, 8, 3,
                     true);
        hlh_add_tube(b, hlh_v3(7, 0, z), hlh_v3(7, 5.5, z), 0.06, 0.04, 8, 3,
                     true);
        hlh_build_object_at_origin(b, hlh_build_mesh(b, "masts", material));
        for (int k = 0; k < 5; k++)
            wire(b, hlh_v3(-7, 5.4 - 0.3 * k, z), hlh_v3(7, 5.4 - 0.3 * k, z),
                 0.5 + 0.1 * k, 0.004 * (k + 1));
        hlh_build_object_at_origin(b, hlh_build_mesh(b, "wires", material));
    }
}

static void fence(struct hlh_builder *b, uint32_t material, double z)
{
    for (int i = 0; i <= 60; i++) {
        double x = -6 + 0.2 * i;
        hlh_add_tube(b, hlh_v3(x, 0, z), hlh_v3(x, 1.4, z), 0.008, 0.008, 6, 1,
                     true);
    }
    for (int i = 0; i < 8; i++)
        hlh_add_tube(b, hlh_v3(-6, 0.1 + 0.18 * i, z),
                     hlh_v3(6, 0.1 + 0.18 * i, z), 0.005, 0.005, 6, 8, true);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "fence", material));
}

/* Plates 4 mm thick whose faces the camera sees from 0 to 8 degrees. */
static void plates(struct hlh_builder *b, uint32_t material)
{
    uint32_t mesh;
    hlh_add_box(b, hlh_v3(0, 1, 0), hlh_v3(0.002, 1, 1.2), 1, false);
    mesh = hlh_build_mesh(b, "plate", material);
    for (int i = 0; i < 24; i++)
        hlh_build_object(b, mesh, hlh_v3(-4.6 + 0.4 * i, 0, -1.5 - 0.4 * i),
                         hlh_v3(1, 0.5 + 0.05 * (i % 7), 1),
                         0.022 * (i % 5 - 2) / 2);
}

static void grass(struct hlh_builder *b, uint32_t material)
{
    for (int i = 0; i < 700; i++) {
        double s, c, tall = hlh_random(b, 0.15, 0.5);
        double x = hlh_random(b, -6, 6);
        double z = hlh_random(b, -10, 5);
        hlh_sincos(hlh_random(b, 0, 1), &s, &c);
        hlh_add_tube(b, hlh_v3(x, 0, z),
                     hlh_v3(x + 0.3 * tall * c, tall, z + 0.3 * tall * s),
                     0.008, 0, 3, 2, false);
    }
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "grass", material));
}

void hlh_build_thin(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {1.5, 2.35, 1}, {4, 7}, {0.5, 0.9}, {0.4, 0.8}};
    uint32_t ground = hlh_build_material(b, "ground", hlh_v3(0.5, 0.5, 0.48),
                                         1, 0);
    uint32_t metal = hlh_build_material(b, "wire", hlh_v3(0.75, 0.74, 0.7), 1,
                                        0);
    uint32_t plate = hlh_build_material(b, "plate", hlh_v3(0.7, 0.4, 0.25), 1,
                                        0);
    uint32_t blade = hlh_build_material(b, "grass", hlh_v3(0.3, 0.55, 0.2), 1,
                                        0);
    hlh_add_patch(b, hlh_v3(-30, 0, 10), hlh_v3(60, 0, 0), hlh_v3(0, 0, -90),
                  30, 45);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "ground", ground));
    lines(b, metal);
    fence(b, metal, 1.5);
    fence(b, metal, -8);
    fence(b, metal, -20);
    plates(b, plate);
    grass(b, blade);
    for (int i = 0; i < 64; i++)
        hlh_build_random_light(b, hlh_v3(-8 + 16.0 * (i % 4) / 3, 2.85,
                                         6 - 2.4 * (i / 4)), &lamps);
    hlh_build_camera(b, hlh_v3(0.6, 1.25, 8.5), hlh_v3(0, 1.5, -10), 55);
}

void hlh_build_many(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0.5, 0.3, 0.4}, {2.2, 3.6}, {0.5, 0.9}, {0.5, 0.9}};
    enum { COLUMNS = 40, COURSES = 25, PAINTS = 10 };
    const double wide = 0.5, tall = 0.25;
    uint32_t mesh[PAINTS];
    for (int i = 0; i < PAINTS; i++) {
        uint32_t m = hlh_build_material(b, "brick",
                                        hlh_hue(0.1 * i, 0.4, 0.75),
                                        0.3 + 0.05 * i, 0);
        hlh_add_box(b, hlh_v3(0, 0, 0),
                    hlh_v3(wide / 2, tall / 2, 0.25), 1, false);
        mesh[i] = hlh_build_mesh(b, "brick", m);
    }
    /* Multiples of 1/8: neighbours share their corners bit for bit. */
    for (int y = 0; y < COURSES; y++)
        for (int x = 0; x < COLUMNS; x++)
            hlh_build_object(b, mesh[hlh_random_below(b, PAINTS)],
                             hlh_v3((x - COLUMNS / 2) * wide +
                                        (y & 1) * wide / 2,
                                    y * tall + tall / 2, 0),
                             hlh_v3(1, 1, 1), 0);
    for (int i = 0; i < 50; i++)
        hlh_build_random_light(b, hlh_v3(-9.5 + 2.1 * (i % 10),
                                         0.4 + 1.3 * (i / 10), 0.9), &lamps);
    hlh_build_camera(b, hlh_v3(-4.5, 3.6, 7.5), hlh_v3(-0.8, 2.9, 0), 50);
}
