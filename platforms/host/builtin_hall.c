/* SPDX-License-Identifier: Zlib */
/* After the demo room of Trebilco 2007: a closed hall of brick with columns
 * and vases, 255 lights (index 0 is the null light), about 40,000 triangles.
 * The two textures are made here: integers only. */
#include "platforms/host/builder.h"

enum { TEXELS = 256 };

static uint32_t speckle(uint32_t x, uint32_t y)
{
    uint32_t h = x * 0x8da6b343u ^ y * 0xd8163841u;
    h = (h ^ h >> 13) * 0x5bd1e995u;
    return (h ^ h >> 15) & 31;
}

/* Running bond, four bricks by eight courses on a square metre; 0 in the
 * joints, else brick number + 1. */
static uint32_t brick_at(uint32_t x, uint32_t y)
{
    uint32_t course = y / 32, along = (x + (course & 1) * 32) % TEXELS;
    if (y % 32 < 3 || along % 64 < 3)
        return 0;
    return course * 4 + along / 64 + 1;
}

static void brick_color(uint8_t *out, uint32_t x, uint32_t y)
{
    uint32_t id = brick_at(x, y), grain = speckle(x, y);
    uint32_t tone = speckle(id, 77) * 2;
    out[0] = (uint8_t)(id ? 150 + tone + grain / 2 : 150 + grain);
    out[1] = (uint8_t)(id ? 96 + tone + grain / 2 : 145 + grain);
    out[2] = (uint8_t)(id ? 78 + tone / 2 + grain / 2 : 136 + grain);
    out[3] = 255;
}

/* Slopes only at the rims of joints, 45 degrees at most. */
static void brick_normal(uint8_t *out, uint32_t x, uint32_t y)
{
    uint32_t left = brick_at((x + TEXELS - 2) % TEXELS, y);
    uint32_t right = brick_at((x + 2) % TEXELS, y);
    uint32_t above = brick_at(x, (y + TEXELS - 2) % TEXELS);
    uint32_t below = brick_at(x, (y + 2) % TEXELS);
    int dx = !left - !right, dy = !above - !below;
    out[0] = (uint8_t)(128 - 80 * dx);
    out[1] = (uint8_t)(128 + 80 * dy);
    out[2] = (uint8_t)(dx || dy ? 227 : 255);
    out[3] = 255;
}

static void plank_color(uint8_t *out, uint32_t x, uint32_t y)
{
    uint32_t plank = y / 32, grain = speckle(x / 24, y);
    uint32_t tone = speckle(plank, 9) + grain / 2;
    bool gap = y % 32 < 2 || (x + plank * 80) % TEXELS < 2;
    out[0] = (uint8_t)(gap ? 60 : 150 + tone);
    out[1] = (uint8_t)(gap ? 44 : 112 + tone);
    out[2] = (uint8_t)(gap ? 34 : 74 + tone);
    out[3] = 255;
}

static void room(struct hlh_builder *b)
{
    const double x = 15, y = 9, z = 23;
    uint32_t brick = hlh_build_material(b, "brick", hlh_v3(1, 1, 1), 0.75, 0);
    uint32_t planks = hlh_build_material(b, "planks", hlh_v3(1, 1, 1), 0.4, 0);
    uint32_t plaster = hlh_build_material(b, "plaster", hlh_v3(0.7, 0.68, 0.6),
                                          0.8, 0);
    int32_t color = hlh_build_image(b, "brick", TEXELS, brick_color);
    int32_t normal = hlh_build_image(b, "brick normal", TEXELS,
                                     brick_normal);
    int32_t wood = hlh_build_image(b, "planks", TEXELS, plank_color);
    if (b->failed)
        return;
    b->scene->materials[brick].base_texture.image = color;
    b->scene->materials[brick].normal_texture.image = normal;
    b->scene->materials[planks].base_texture.image = wood;
    hlh_add_patch(b, hlh_v3(-x, 0, z), hlh_v3(2 * x, 0, 0),
                  hlh_v3(0, 0, -2 * z), 20, 30);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", planks));
    hlh_add_patch(b, hlh_v3(-x, y, -z), hlh_v3(2 * x, 0, 0),
                  hlh_v3(0, 0, 2 * z), 20, 30);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "ceiling", plaster));
    hlh_add_patch(b, hlh_v3(-x, 0, -z), hlh_v3(2 * x, 0, 0), hlh_v3(0, y, 0),
                  16, 8);
    hlh_add_patch(b, hlh_v3(x, 0, z), hlh_v3(-2 * x, 0, 0), hlh_v3(0, y, 0),
                  16, 8);
    hlh_add_patch(b, hlh_v3(-x, 0, z), hlh_v3(0, 0, -2 * z), hlh_v3(0, y, 0),
                  24, 8);
    hlh_add_patch(b, hlh_v3(x, 0, -z), hlh_v3(0, 0, 2 * z), hlh_v3(0, y, 0),
                  24, 8);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "walls", brick));
}

static void columns(struct hlh_builder *b)
{
    uint32_t stone = hlh_build_material(b, "stone", hlh_v3(0.66, 0.62, 0.54),
                                        0.6, 0), mesh;
    hlh_add_tube(b, hlh_v3(0, 0.9, 0), hlh_v3(0, 8.1, 0), 0.75, 0.62, 32, 9,
                 false);
    hlh_add_torus(b, hlh_v3(0, 0.9, 0), 0.75, 0.14, 32, 8);
    hlh_add_torus(b, hlh_v3(0, 8.1, 0), 0.64, 0.12, 32, 8);
    hlh_add_box(b, hlh_v3(0, 0.4, 0), hlh_v3(1, 0.4, 1), 1, false);
    hlh_add_box(b, hlh_v3(0, 8.6, 0), hlh_v3(0.95, 0.4, 0.95), 1, false);
    mesh = hlh_build_mesh(b, "column", stone);
    for (int i = 0; i < 12; i++)
        hlh_build_object(b, mesh,
                         hlh_v3(i & 1 ? 8 : -8, 0, -17.5 + 7 * (i / 2)),
                         hlh_v3(1, 1, 1), 0);
}

/* A vase of a foot, a belly, a neck and a lip: 1,052 triangles. */
static uint32_t vase(struct hlh_builder *b, uint32_t material)
{
    hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 0.25, 0), 0.5, 0.3, 24, 2,
                 true);
    hlh_add_sphere(b, hlh_v3(0, 1.05, 0), 0.9, 24, 14);
    hlh_add_tube(b, hlh_v3(0, 1.8, 0), hlh_v3(0, 2.3, 0), 0.38, 0.3, 24, 3,
                 false);
    hlh_add_torus(b, hlh_v3(0, 2.3, 0), 0.34, 0.07, 24, 8);
    return hlh_build_mesh(b, "vase", material);
}

static void vases(struct hlh_builder *b)
{
    for (int i = 0; i < 16; i++) {
        struct hlh_v3 color = hlh_hue(i / 16.0, 0.35, 0.85);
        double size = hlh_random(b, 0.7, 1.15);
        double x = -4.5 + 3 * (i % 4) + hlh_random(b, -0.5, 0.5);
        double z = -15 + 8 * (i / 4) + hlh_random(b, -1, 1);
        uint32_t m = hlh_build_material(b, "glaze", color,
                                        hlh_random(b, 0.3, 0.5), 0);
        hlh_build_object(b, vase(b, m), hlh_v3(x, 0, z),
                         hlh_v3(size, size, size), hlh_random(b, 0, 1));
    }
}

void hlh_build_lidr(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {14.5, 3.55, 21.25}, {2.4, 4.4}, {0.6, 0.95}, {0.8, 1.3}};
    room(b);
    columns(b);
    vases(b);
    for (int i = 0; i < 255; i++)
        hlh_build_random_light(b, hlh_v3(0, 3.95, -1.25), &lamps);
    hlh_build_camera(b, hlh_v3(1.2, 4.6, 21.5), hlh_v3(-0.4, 2.4, 0), 58);
}
