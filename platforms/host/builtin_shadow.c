/* SPDX-License-Identifier: Zlib */
/* One light of each kind that casts shadows, over bodies that are closed,
 * open, thin and nested, and a masked one with holes. */
#include "platforms/host/builder.h"

enum { TEXELS = 64 };

static void grate(uint8_t *out, uint32_t x, uint32_t y)
{
    bool hole = x % 16 >= 4 && y % 16 >= 4;
    out[0] = out[1] = out[2] = 180;
    out[3] = (uint8_t)(hole ? 0 : 255);
}

static void stage(struct hlh_builder *b)
{
    uint32_t floor = hlh_build_material(b, "floor", hlh_v3(0.64, 0.62, 0.6),
                                        0.8, 0);
    hlh_add_box(b, hlh_v3(0, -0.1, 0), hlh_v3(6, 0.1, 5), 12, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", floor));
    hlh_add_box(b, hlh_v3(0, 2, -4.2), hlh_v3(6, 2, 0.2), 8, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "wall", floor));
}

static void put(struct hlh_builder *b, uint32_t mesh, double x, double y,
                double z, double yaw)
{
    hlh_build_object(b, mesh, hlh_v3(x, y, z), hlh_v3(1, 1, 1), yaw);
}

static void bodies(struct hlh_builder *b)
{
    uint32_t red = hlh_build_material(b, "red", hlh_v3(0.7, 0.3, 0.25), 0.5,
                                      0), box;
    hlh_add_box(b, hlh_v3(0, 0.5, 0), hlh_v3(0.5, 0.5, 0.5), 2, false);
    box = hlh_build_mesh(b, "box", red);
    put(b, box, -2.4, 0, 0.6, 0.08);
    put(b, box, -2.2, 1, 0.5, 0.2);
    put(b, box, 2.6, 0, -1.6, 0.13);
    uint32_t blue = hlh_build_material(b, "blue", hlh_v3(0.3, 0.4, 0.7), 0.4,
                                       0);
    hlh_add_torus(b, hlh_v3(0, 0, 0), 0.7, 0.22, 32, 14);
    put(b, hlh_build_mesh(b, "torus", blue), 0.2, 1.1, 0.2, 0);
    hlh_add_sphere(b, hlh_v3(0, 0, 0), 0.55, 32, 16);
    put(b, hlh_build_mesh(b, "sphere", blue), 2.3, 0.55, 1.1, 0);
    uint32_t steel = hlh_build_material(b, "steel", hlh_v3(0.6, 0.6, 0.62),
                                        0.45, 0);
    for (int i = 0; i < 9; i++)
        hlh_add_tube(b, hlh_v3(0.25 * i, 0, 0), hlh_v3(0.25 * i, 1.4, 0),
                     0.025, 0.025, 10, 1, true);
    put(b, hlh_build_mesh(b, "bars", steel), -1.6, 0, -1.6, 0.03);
    /* A sheet with nothing behind it. */
    hlh_add_patch(b, hlh_v3(-0.6, 0, 0), hlh_v3(1.2, 0, 0), hlh_v3(0, 1.5, 0),
                  3, 3);
    hlh_build_material(b, "sheet", hlh_v3(0.7, 0.65, 0.3), 0.6, 0);
    hlh_build_last_material(b)->double_sided = true;
    put(b, hlh_build_mesh(b, "sheet", b->scene->n_materials - 1), -3.6, 0,
        -1.8, 0.09);
}

static void grating(struct hlh_builder *b)
{
    uint32_t m = hlh_build_material(b, "grate", hlh_v3(1, 1, 1), 0.6, 0);
    int32_t image = hlh_build_image(b, "grate", TEXELS, grate);
    struct hlh_material *material = hlh_build_last_material(b);
    material->alpha = HLH_ALPHA_MASK;
    material->double_sided = true;
    material->base_texture.image = image;
    hlh_add_patch(b, hlh_v3(-0.8, 0, 0), hlh_v3(1.6, 0, 0), hlh_v3(0, 1.2, 0),
                  2, 2);
    hlh_build_object(b, hlh_build_mesh(b, "grate", m), hlh_v3(3.6, 0.2, -0.4),
                     hlh_v3(1, 1, 1), -0.1);
}

void hlh_build_shadows(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0.3, 0.2, 0.3}, {2, 3}, {0.5, 0.9}, {0.15, 0.3}};
    stage(b);
    bodies(b);
    grating(b);
    hlh_build_spot(b, hlh_v3(-4.2, 4.4, 3.2), hlh_v3(-0.8, 0.3, -0.5), 12,
                   0.3, 0.5, hlh_v3(1.5, 1.2, 0.8));
    hlh_build_shadow(b);
    hlh_build_directional(b, hlh_v3(-0.5, -1, -0.45), hlh_v3(0.3, 0.33, 0.4));
    hlh_build_shadow(b);
    hlh_build_light(b, hlh_v3(1.2, 2.4, 1.5), 7, hlh_v3(0.5, 0.75, 0.9));
    hlh_build_shadow(b);
    for (int i = 0; i < 6; i++)
        hlh_build_random_light(b, hlh_v3(-4 + 1.6 * i, 0.6, i & 1 ? -2.8 : 2.6),
                               &lamps);
    for (int k = 0; k < 3; k++)
        b->scene->ambient[k] = 0.03f;
    hlh_build_camera(b, hlh_v3(0.8, 3.9, 7), hlh_v3(0, 0.6, -0.6), 48);
}
