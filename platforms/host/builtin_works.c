/* SPDX-License-Identifier: Zlib */
/* Figure 9 of Kircher and Lawrance 2009 shows walkways whose handrails alias
 * when lighting is not filtered. Built of modules four metres long; handrails
 * are square tubes of 50 mm, their posts of 60 mm, those of stairs round and
 * as thick; fence wires have a radius of 6 mm. All dielectrics of one
 * roughness: the specular exponent is a constant of the scene. */
#include "platforms/host/builder.h"

#define LONG 4.0
#define WIDE 1.8

struct works {
    uint32_t concrete, steel, yellow, red, blue, wire;
    uint32_t deck, rail, stair, column, fence, pipe, tank, crate, duct;
};

static void paints(struct hlh_builder *b, struct works *w)
{
    const double rough = 0.45;
    w->concrete = hlh_build_material(b, "concrete", hlh_v3(0.55, 0.54, 0.5),
                                     rough, 0);
    w->steel = hlh_build_material(b, "steel", hlh_v3(0.42, 0.45, 0.48), rough,
                                  0);
    w->yellow = hlh_build_material(b, "yellow", hlh_v3(0.80, 0.62, 0.12),
                                   rough, 0);
    w->red = hlh_build_material(b, "red", hlh_v3(0.62, 0.20, 0.14), rough, 0);
    w->blue = hlh_build_material(b, "blue", hlh_v3(0.22, 0.38, 0.62), rough,
                                 0);
    w->wire = hlh_build_material(b, "wire", hlh_v3(0.66, 0.68, 0.7), rough, 0);
}

/* Module along x from 0 to LONG, z from -WIDE/2 to WIDE/2, top at y = 0. */
static void make_deck(struct hlh_builder *b, struct works *w)
{
    for (int side = -1; side <= 1; side += 2)
        hlh_add_box(b, hlh_v3(LONG / 2, -0.1, side * (WIDE / 2 - 0.05)),
                    hlh_v3(LONG / 2, 0.1, 0.05), 1, false);
    for (int i = 0; i < 32; i++)
        hlh_add_box(b, hlh_v3((i + 0.5) * LONG / 32, -0.02, 0),
                    hlh_v3(0.035, 0.02, WIDE / 2 - 0.1), 1, false);
    w->deck = hlh_build_mesh(b, "walkway", w->steel);
}

/* One side, along x, at z = 0. */
static void make_rail(struct hlh_builder *b, struct works *w)
{
    for (int i = 0; i < 3; i++)
        hlh_add_box(b, hlh_v3(LONG / 2, 1.1 - 0.36 * i, 0),
                    hlh_v3(LONG / 2, 0.025, 0.025), 1, false);
    for (int i = 0; i < 4; i++)
        hlh_add_box(b, hlh_v3(0.5 + i, 0.5, 0), hlh_v3(0.03, 0.6, 0.03), 1,
                    false);
    hlh_add_box(b, hlh_v3(LONG / 2, 0.06, 0), hlh_v3(LONG / 2, 0.06, 0.006), 1,
                false);
    w->rail = hlh_build_mesh(b, "handrail", w->yellow);
}

/* Rises 3 m over 4.5 m along x. */
static void make_stair(struct hlh_builder *b, struct works *w)
{
    for (int i = 0; i < 15; i++)
        hlh_add_box(b, hlh_v3(0.15 + 0.3 * i, 0.18 + 0.2 * i, 0),
                    hlh_v3(0.14, 0.02, WIDE / 2 - 0.1), 1, false);
    for (int side = -1; side <= 1; side += 2) {
        double z = side * (WIDE / 2 - 0.06);
        hlh_add_tube(b, hlh_v3(0, 0.1, z), hlh_v3(4.5, 3.1, z), 0.07, 0.07, 4,
                     1, true);
        hlh_add_tube(b, hlh_v3(0, 1.1, z), hlh_v3(4.5, 4.1, z), 0.025, 0.025,
                     10, 1, true);
        hlh_add_tube(b, hlh_v3(0, 0.65, z), hlh_v3(4.5, 3.65, z), 0.02, 0.02,
                     10, 1, true);
        for (int i = 0; i < 6; i++) {
            double x = 0.15 + 0.84 * i, y = x / 1.5;
            hlh_add_tube(b, hlh_v3(x, y, z), hlh_v3(x, y + 1.1, z), 0.03, 0.03,
                         10, 1, true);
        }
    }
    w->stair = hlh_build_mesh(b, "stair", w->yellow);
}

/* Height 1, to be scaled along y. */
static void make_column(struct hlh_builder *b, struct works *w)
{
    hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 1, 0), 0.14, 0.14, 20, 6, true);
    hlh_add_box(b, hlh_v3(0, 0.015, 0), hlh_v3(0.3, 0.015, 0.3), 1, false);
    w->column = hlh_build_mesh(b, "column", w->red);
}

/* One diagonal wire, cut off at the frame of LONG x 2.2 metres. */
static void fence_wire(struct hlh_builder *b, double start, double slope)
{
    const double tall = 2.2;
    double x0 = start, y0 = 0, x1 = start + slope * tall, y1 = tall;
    if (x0 < 0) {
        y0 = -x0 / slope;
        x0 = 0;
    }
    if (x0 > LONG) {
        y0 = (LONG - x0) / slope;
        x0 = LONG;
    }
    if (x1 > LONG) {
        y1 -= (x1 - LONG) / slope;
        x1 = LONG;
    }
    if (x1 < 0) {
        y1 -= x1 / slope;
        x1 = 0;
    }
    if (y1 - y0 > 0.01)
        hlh_add_tube(b, hlh_v3(x0, y0, 0), hlh_v3(x1, y1, 0), 0.006, 0.006, 5,
                     1, false);
}

static void make_fence(struct hlh_builder *b, struct works *w)
{
    for (int i = 0; i < 2; i++) {
        hlh_add_tube(b, hlh_v3(i * LONG, 0, 0), hlh_v3(i * LONG, 2.3, 0), 0.04,
                     0.04, 10, 1, true);
        hlh_add_tube(b, hlh_v3(0, 0.02 + 2.18 * i, 0),
                     hlh_v3(LONG, 0.02 + 2.18 * i, 0), 0.02, 0.02, 8, 1, true);
    }
    for (int i = 0; i < 44; i++) {
        fence_wire(b, -2.2 + 0.14 * (i + 0.5), 1);
        fence_wire(b, 6.2 - 0.14 * (i + 0.5), -1);
    }
    w->fence = hlh_build_mesh(b, "mesh fence", w->wire);
}

static void make_goods(struct hlh_builder *b, struct works *w)
{
    hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(10, 0, 0), 0.16, 0.16, 20, 10,
                 true);
    for (int i = 0; i < 4; i++)
        hlh_add_tube(b, hlh_v3(0.4 + 3 * i, 0, 0), hlh_v3(0.5 + 3 * i, 0, 0),
                     0.24, 0.24, 20, 1, true);
    w->pipe = hlh_build_mesh(b, "pipe", w->blue);
    hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 3.2, 0), 1.4, 1.4, 40, 8,
                 false);
    hlh_add_tube(b, hlh_v3(0, 3.2, 0), hlh_v3(0, 3.7, 0), 1.4, 0.5, 40, 2,
                 true);
    for (int i = 0; i < 3; i++)
        hlh_add_torus(b, hlh_v3(0, 0.5 + 1.1 * i, 0), 1.42, 0.04, 40, 8);
    w->tank = hlh_build_mesh(b, "tank", w->concrete);
    hlh_add_rounded_box(b, hlh_v3(0.5, 0.5, 0.5), 0.06, 7);
    w->crate = hlh_build_mesh(b, "crate", w->red);
    hlh_add_box(b, hlh_v3(5, 0, 0), hlh_v3(5, 0.3, 0.4), 4, false);
    w->duct = hlh_build_mesh(b, "duct", w->steel);
}

static void put(struct hlh_builder *b, uint32_t mesh, double x, double y,
                double z, double yaw)
{
    hlh_build_object(b, mesh, hlh_v3(x, y, z), hlh_v3(1, 1, 1), yaw);
}

/* n modules along x at height y; a side is left open where a bit of gaps is
 * set: bit 2 i for module i's low z side, bit 2 i + 1 for its high one. */
static void run(struct hlh_builder *b, const struct works *w, double x,
                double y, double z, int n, uint64_t gaps)
{
    for (int i = 0; i < n; i++) {
        put(b, w->deck, x + i * LONG, y, z, 0);
        for (int side = 0; side < 2; side++)
            if (!(gaps >> (2 * i + side) & 1))
                put(b, w->rail, x + i * LONG, y,
                    z + (side ? 0.5 : -0.5) * (WIDE - 0.1), 0);
        for (int side = -1; side <= 1 && i % 2 == 0; side += 2)
            hlh_build_object(b, w->column,
                             hlh_v3(x + i * LONG + 0.3, 0, z + side * 0.7),
                             hlh_v3(1, y - 0.2, 1), 0);
    }
}

/* The same along z; yaw of a quarter turns x into -z. */
static void link_run(struct hlh_builder *b, const struct works *w, double x,
                     double y, double z, int n)
{
    for (int i = 0; i < n; i++) {
        double at = z + (i + 1) * LONG;
        put(b, w->deck, x, y, at, 0.25);
        for (int side = -1; side <= 1; side += 2)
            put(b, w->rail, x + side * 0.5 * (WIDE - 0.1), y, at, 0.25);
    }
}

static void lay_out(struct hlh_builder *b, const struct works *w)
{
    run(b, w, -20, 3, -3, 10, (uint64_t)1 << 5 | (uint64_t)1 << 15);
    run(b, w, -20, 3, 6.8, 10, (uint64_t)1 << 4 | (uint64_t)1 << 14);
    run(b, w, -20, 6, -9.5, 10, 0);
    link_run(b, w, -10, 3, -2.1, 2);
    link_run(b, w, 10, 3, -2.1, 2);
    put(b, w->stair, -4, 0, 1.5, 0);
    put(b, w->stair, 4.5, 0, -5.2, 0.5);
    put(b, w->stair, 12.5, 3, -6.6, 0.5);
    for (int i = 0; i < 10; i++) {
        put(b, w->fence, -20 + i * LONG, 0, 10.5, 0);
        if (i < 6)
            put(b, w->fence, -19, 0, 10.5 - i * LONG, 0.25);
    }
    for (int i = 0; i < 4; i++) {
        put(b, w->pipe, -20 + 10 * i, 2.2, -1.4, 0);
        put(b, w->pipe, -20 + 10 * i, 5.2, -11.2, 0);
        put(b, w->duct, -20 + 10 * i, 4.7, -8, 0);
        put(b, w->tank, -15 + 9 * i, 0, -13.5, 0);
    }
    for (int i = 0; i < 24; i++) {
        double size = hlh_random(b, 0.7, 1.4);
        double x = hlh_random(b, -17, 18);
        double z = hlh_random(b, -1, 5);
        hlh_build_object(b, w->crate, hlh_v3(x, 0.5 * size, z),
                         hlh_v3(size, size, size), hlh_random(b, 0, 1));
    }
}

static void lamp(struct hlh_builder *b, struct hlh_v3 at,
                 struct hlh_v3 spread, double radius)
{
    struct hlh_light_range range = {{0, 0, 0}, {0, 0}, {0.35, 0.9}, {0.6, 1}};
    range.spread = spread;
    range.radius[0] = range.radius[1] = radius;
    hlh_build_random_light(b, at, &range);
}

/* 3 x 20 along the walkways, 36 over the floor, 16 at the tanks, 10 at the
 * fence: 122. */
static void lamps(struct hlh_builder *b)
{
    const struct hlh_v3 still = {0, 0, 0};
    for (int i = 0; i < 20; i++) {
        double x = -19 + 2 * i;
        lamp(b, hlh_v3(x, 4.6, -3), still, 3.6);
        lamp(b, hlh_v3(x, 4.6, 6.8), still, 3.6);
        lamp(b, hlh_v3(x, 7.4, -9.5), still, 3.6);
    }
    for (int i = 0; i < 36; i++)
        lamp(b, hlh_v3(-17.5 + 7 * (i % 6), 1.4, -6 + 3 * (i / 6)),
             hlh_v3(1, 0.8, 1), 4.5);
    for (int i = 0; i < 16; i++)
        lamp(b, hlh_v3(-18 + 2.4 * i, 4.2, i & 1 ? -11.4 : -14.2),
             hlh_v3(0, 2.8, 0), 4.6);
    for (int i = 0; i < 10; i++)
        lamp(b, hlh_v3(-18 + 4 * i, 2.5, 9.6), still, 3.2);
}

static void build_works(struct hlh_builder *b)
{
    struct works w;
    paints(b, &w);
    hlh_add_box(b, hlh_v3(0, -0.1, -2), hlh_v3(23, 0.1, 15), 12, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "ground", w.concrete));
    hlh_add_box(b, hlh_v3(0, 4.5, -16), hlh_v3(23, 4.5, 0.2), 10, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "wall", w.concrete));
    make_deck(b, &w);
    make_rail(b, &w);
    make_stair(b, &w);
    make_column(b, &w);
    make_fence(b, &w);
    make_goods(b, &w);
    lay_out(b, &w);
    lamps(b);
}

/* 122 and 91 more, along the pipes and between the crates: 213. */
void hlh_build_fig1(struct hlh_builder *b)
{
    build_works(b);
    for (int i = 0; i < 40; i++)
        lamp(b, hlh_v3(-19 + i, i & 1 ? 5.7 : 2.9, i & 1 ? -10.6 : -0.6),
             hlh_v3(0, 0, 0), 2.4);
    for (int i = 0; i < 51; i++)
        lamp(b, hlh_v3(-17 + 2.1 * (i % 17), 0.9, 0.5 + 2 * (i / 17)),
             hlh_v3(0.8, 0.5, 0.8), 3);
    hlh_build_camera(b, hlh_v3(-17.5, 4.9, 3.6), hlh_v3(2, 2.2, -3.2), 58);
}

void hlh_build_fig9(struct hlh_builder *b)
{
    build_works(b);
    hlh_build_camera(b, hlh_v3(-15.5, 6.2, 9.6), hlh_v3(1.5, 2.6, -4), 50);
}
