/* SPDX-License-Identifier: Zlib */
/* What textures cut out or lay on: `fence` after figure 10 of Kircher and
 * Lawrance 2009, and `decals` that change the normals below them. Textures
 * are made of integers alone. */
#include "platforms/host/builder.h"

enum { TEXELS = 256 };

static int at_most(int x, int most) { return x < most ? x : most; }

/* Distance of x from the middle of its period. */
static int off_middle(uint32_t x, uint32_t period)
{
    int d = (int)(x % period) - (int)period / 2;
    return d < 0 ? -d : d;
}

/* Two families of diagonal wires, 64 texels apart: half width 4 along a row,
 * and a rim of two texels over which alpha falls. Colour is the same where
 * nothing is seen, for the mip levels' sake. */
static void link_texel(uint8_t *out, uint32_t x, uint32_t y)
{
    int one = off_middle(x + y, 64);
    int two = off_middle(x + TEXELS - y, 64);
    int d = one < two ? one : two;
    out[0] = out[1] = (uint8_t)(one < two ? 176 : 160);
    out[2] = 170;
    out[3] = (uint8_t)(d <= 4 ? 255 : d >= 7 ? 0 : 85 * (7 - d));
}

static uint32_t link_material(struct hlh_builder *b)
{
    uint32_t m = hlh_build_material(b, "chain link", hlh_v3(1, 1, 1), 0.45, 0);
    int32_t texture = hlh_build_image(b, "chain link", TEXELS, link_texel);
    struct hlh_material *material = hlh_build_last_material(b);
    material->alpha = HLH_ALPHA_MASK;
    material->fence = true;
    material->double_sided = true;
    material->base_texture.image = texture;
    return m;
}

/* A wire every 7 cm: the texture's 4 periods cover 28 cm. */
static void fences(struct hlh_builder *b)
{
    uint32_t link = link_material(b);
    uint32_t steel = hlh_build_material(b, "post", hlh_v3(0.5, 0.5, 0.52),
                                        0.45, 0), panel, post;
    hlh_add_patch(b, hlh_v3(0, 0.05, 0), hlh_v3(2.5, 0, 0), hlh_v3(0, 2, 0),
                  1, 1);
    for (uint32_t i = 0; i < b->n_vertices; i++)
        for (int k = 0; k < 2; k++)
            b->vertices[i].uv[k] *= 1 / 0.28f;
    panel = hlh_build_mesh(b, "fence", link);
    hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 2.1, 0), 0.04, 0.04, 12, 1,
                 true);
    hlh_add_tube(b, hlh_v3(0, 2.05, 0), hlh_v3(2.5, 2.05, 0), 0.025, 0.025,
                 10, 1, false);
    post = hlh_build_mesh(b, "post", steel);
    for (int i = 0; i < 12; i++) {
        struct hlh_v3 at = {-7.5 + 2.5 * (i % 6), 0, i < 6 ? 2 : -3};
        hlh_build_object(b, panel, at, hlh_v3(1, 1, 1), 0);
        hlh_build_object(b, post, at, hlh_v3(1, 1, 1), 0);
    }
    /* Two that are seen along. */
    for (int i = 0; i < 2; i++)
        hlh_build_object(b, panel, hlh_v3(3 * i, 0, -0.2), hlh_v3(1, 1, 1),
                         0.2);
}

static void goods(struct hlh_builder *b, int n)
{
    static const struct hlh_v3 color[] = {
        {0.7, 0.35, 0.2}, {0.25, 0.45, 0.7}, {0.6, 0.6, 0.3}};
    uint32_t mesh[3];
    for (int i = 0; i < 3; i++) {
        uint32_t m = hlh_build_material(b, "goods", color[i], 0.4 + 0.15 * i,
                                        0);
        if (i == 0)
            hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 1.1, 0), 0.4, 0.4, 28,
                         3, true);
        else if (i == 1)
            hlh_add_box(b, hlh_v3(0, 0.45, 0), hlh_v3(0.5, 0.45, 0.5), 3,
                        false);
        else
            hlh_add_sphere(b, hlh_v3(0, 0.5, 0), 0.5, 28, 14);
        mesh[i] = hlh_build_mesh(b, "goods", m);
    }
    for (int i = 0; i < n; i++) {
        double x = hlh_random(b, -6, 6);
        double z = hlh_random(b, -5.5, 1.2);
        hlh_build_object(b, mesh[i % 3], hlh_v3(x, 0, z), hlh_v3(1, 1, 1),
                         hlh_random(b, 0, 1));
    }
}

static void yard(struct hlh_builder *b)
{
    uint32_t floor = hlh_build_material(b, "floor", hlh_v3(0.5, 0.5, 0.47),
                                        0.8, 0);
    uint32_t wall = hlh_build_material(b, "wall", hlh_v3(0.58, 0.55, 0.52),
                                       0.8, 0);
    hlh_add_box(b, hlh_v3(0, -0.1, 0), hlh_v3(9, 0.1, 8), 12, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", floor));
    hlh_add_box(b, hlh_v3(0, 2, -6.2), hlh_v3(9, 2, 0.2), 10, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "wall", wall));
}

static void lamps(struct hlh_builder *b, int n, int across)
{
    static const struct hlh_light_range range = {
        {0.5, 0.5, 0.4}, {2.4, 3.6}, {0.5, 0.9}, {0.5, 0.8}};
    for (int i = 0; i < n; i++)
        hlh_build_random_light(
            b, hlh_v3(-7 + 14.0 * (i % across) / (across - 1), 1.3,
                      3.4 - 9.0 * (i / across) / ((n - 1) / across)), &range);
}

void hlh_build_fence(struct hlh_builder *b)
{
    yard(b);
    goods(b, 18);
    fences(b);
    lamps(b, 40, 8);
    hlh_build_camera(b, hlh_v3(-1.2, 1.5, 5.4), hlh_v3(0.4, 0.95, -1), 52);
}

/* ---- decals ------------------------------------------------------------- */

/* A round dent: from the middle out it falls, is flat, and rises at its rim.
 * Squares only, so that no root is needed. */
static void dent_normal(uint8_t *out, uint32_t x, uint32_t y)
{
    int dx = 2 * (int)x - TEXELS + 1, dy = 2 * (int)y - TEXELS + 1;
    int r2 = (dx * dx + dy * dy) >> 6;           /* 0 .. 1024 within        */
    int slope = r2 > 900 ? 0 : r2 > 500 ? 1 : r2 > 60 ? 0 : -1;
    /* Outward slope at the rim, inward at the bump: 45 degrees at most. */
    out[0] = (uint8_t)(128 - slope * dx * 90 / TEXELS);
    out[1] = (uint8_t)(128 + slope * dy * 90 / TEXELS);
    out[2] = (uint8_t)(slope ? 235 : 255);
    out[3] = 255;
}

static void dent_color(uint8_t *out, uint32_t x, uint32_t y)
{
    int dx = 2 * (int)x - TEXELS + 1, dy = 2 * (int)y - TEXELS + 1;
    int r2 = (dx * dx + dy * dy) >> 6, fade = (1000 - r2) * 2;
    out[0] = 150;
    out[1] = out[2] = 140;
    out[3] = (uint8_t)(fade < 0 ? 0 : at_most(fade, 255));
}

/* 4 x 4 tiles with rounded rims. */
static void tile_normal(uint8_t *out, uint32_t x, uint32_t y)
{
    int dx = (int)(x % 64) - 32, dy = (int)(y % 64) - 32;
    int sx = dx > 24 ? 1 : dx < -24 ? -1 : 0;
    int sy = dy > 24 ? 1 : dy < -24 ? -1 : 0;
    out[0] = (uint8_t)(128 + 80 * sx);
    out[1] = (uint8_t)(128 - 80 * sy);
    out[2] = (uint8_t)(sx || sy ? 220 : 255);
    out[3] = 255;
}

static void tile_color(uint8_t *out, uint32_t x, uint32_t y)
{
    bool joint = off_middle(x + 32, 64) < 3 || off_middle(y + 32, 64) < 3;
    bool odd = ((x / 64) ^ (y / 64)) & 1;
    out[0] = (uint8_t)(joint ? 90 : odd ? 120 : 190);
    out[1] = (uint8_t)(joint ? 90 : odd ? 140 : 185);
    out[2] = (uint8_t)(joint ? 90 : odd ? 160 : 170);
    out[3] = 255;
}

static uint32_t decal_material(struct hlh_builder *b, const char *name,
                               void (*color)(uint8_t *, uint32_t, uint32_t),
                               void (*normal)(uint8_t *, uint32_t, uint32_t))
{
    /* As rough as what it lies on, whose exponent the light has. */
    uint32_t m = hlh_build_material(b, name, hlh_v3(1, 1, 1), 0.8, 0);
    int32_t base = hlh_build_image(b, name, TEXELS, color);
    int32_t bump = hlh_build_image(b, name, TEXELS, normal);
    struct hlh_material *material = hlh_build_last_material(b);
    material->alpha = HLH_ALPHA_BLEND;
    material->decal = true;
    material->base_texture.image = base;
    material->normal_texture.image = bump;
    return m;
}

/* Metre squares 2 mm above the floor, and before the wall. */
static void lay_decals(struct hlh_builder *b, uint32_t material, int first)
{
    uint32_t mesh;
    hlh_add_patch(b, hlh_v3(-0.5, 0.002, 0.5), hlh_v3(1, 0, 0),
                  hlh_v3(0, 0, -1), 1, 1);
    mesh = hlh_build_mesh(b, "floor decal", material);
    for (int i = first; i < 16; i += 2)
        hlh_build_object(b, mesh, hlh_v3(-5 + 3.2 * (i % 4), 0,
                                         3.4 - 2.4 * (i / 4)),
                         hlh_v3(1.8, 1, 1.8), 0.07 * i);
    hlh_add_patch(b, hlh_v3(-0.5, -0.5, 0.002), hlh_v3(1, 0, 0),
                  hlh_v3(0, 1, 0), 1, 1);
    mesh = hlh_build_mesh(b, "wall decal", material);
    for (int i = first; i < 6; i += 2)
        hlh_build_object(b, mesh, hlh_v3(-5 + 2.1 * i, 1.6, -6),
                         hlh_v3(1.6, 1.6, 1), 0);
}

void hlh_build_decals(struct hlh_builder *b)
{
    yard(b);
    goods(b, 6);
    lay_decals(b, decal_material(b, "dent", dent_color, dent_normal), 0);
    lay_decals(b, decal_material(b, "tiles", tile_color, tile_normal), 1);
    lamps(b, 30, 6);
    hlh_build_camera(b, hlh_v3(0.6, 4.2, 7.4), hlh_v3(-0.2, 0.4, -0.8), 50);
}
