/* SPDX-License-Identifier: Zlib */
/* Translucent layers. `blades` is after figure 6 of Kircher and Lawrance 2009:
 * a rotor's shadow on three panes, one over the other, and on what is opaque
 * below them. `glass` has more layers than any pattern. */
#include "platforms/host/builder.h"

/* Layers of blades: 0 what is opaque, 1 to 3 the panes from below. */
enum { LAYERS = 4, ALL = -1 };

/* A layer that must not show reflects nothing: black metal, of which neither
 * a diffuse nor a specular part is left. */
static uint32_t paint(struct hlh_builder *b, const char *name,
                      struct hlh_v3 color, double roughness, bool shows)
{
    struct hlh_v3 black = {0, 0, 0};
    return hlh_build_material(b, name, shows ? color : black, roughness,
                              shows ? 0 : 1);
}

static void ground(struct hlh_builder *b, bool shows)
{
    uint32_t floor = paint(b, "floor", hlh_v3(0.62, 0.60, 0.56), 0.7, shows);
    uint32_t wall = paint(b, "wall", hlh_v3(0.55, 0.58, 0.64), 0.8, shows);
    uint32_t goods = paint(b, "goods", hlh_v3(0.75, 0.42, 0.2), 0.5, shows);
    uint32_t ball;
    hlh_add_box(b, hlh_v3(0, -0.1, 0), hlh_v3(7, 0.1, 5), 12, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", floor));
    hlh_add_box(b, hlh_v3(0, 2.5, -4.1), hlh_v3(7, 2.5, 0.1), 10, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "wall", wall));
    hlh_add_rounded_box(b, hlh_v3(0.35, 0.35, 0.35), 0.06, 7);
    ball = hlh_build_mesh(b, "crate", goods);
    for (int i = 0; i < 5; i++)
        hlh_build_object(b, ball, hlh_v3(-3 + 1.5 * i, 0.35, i & 1 ? 1.4 : -1),
                         hlh_v3(1, 1, 1), 0.06 * i);
}

static void rotor(struct hlh_builder *b, bool shows)
{
    uint32_t steel = paint(b, "rotor", hlh_v3(0.3, 0.32, 0.35), 0.45, shows);
    uint32_t blade;
    hlh_add_tube(b, hlh_v3(0, 3.45, 0), hlh_v3(0, 3.75, 0), 0.2, 0.14, 20, 1,
                 true);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "hub", steel));
    hlh_add_box(b, hlh_v3(1.25, 0, 0), hlh_v3(1.1, 0.025, 0.16), 1, false);
    blade = hlh_build_mesh(b, "blade", steel);
    for (int i = 0; i < 4; i++)
        hlh_build_object(b, blade, hlh_v3(0, 3.6, 0), hlh_v3(1, 1, 1),
                         0.25 * i + 0.055);
}

static void pane(struct hlh_builder *b, int layer, bool shows)
{
    static const struct hlh_v3 color[] = {
        {0.85, 0.5, 0.35}, {0.4, 0.8, 0.5}, {0.4, 0.55, 0.9}};
    double y = 0.5 + 0.5 * layer;
    uint32_t m = paint(b, "pane", color[layer - 1], 0.35, shows);
    struct hlh_material *material = hlh_build_last_material(b);
    material->base_color[3] = 0.45f;
    material->alpha = HLH_ALPHA_BLEND;
    material->double_sided = true;
    /* Tilted this way and that: no two have one normal. */
    hlh_add_patch(b, hlh_v3(-2, -0.06 * layer, 1.6), hlh_v3(4, 0.12 * layer, 0),
                  hlh_v3(0, 0.15 * (layer - 2), -3.2), 6, 6);
    hlh_build_object(b, hlh_build_mesh(b, "pane", m),
                     hlh_v3(0.55 * (layer - 2), y, 0.3 * (2 - layer)),
                     hlh_v3(1, 1, 1), 0.02 * (layer - 2));
}

static void blades(struct hlh_builder *b, int only)
{
    static const struct hlh_light_range lamps = {
        {0.4, 0.3, 0.4}, {2.6, 3.4}, {0.5, 0.9}, {0.25, 0.45}};
    ground(b, only == ALL || only == 0);
    rotor(b, only == ALL || only == 0);
    for (int layer = 1; layer < LAYERS; layer++)
        pane(b, layer, only == ALL || only == layer);
    hlh_build_spot(b, hlh_v3(0.3, 6.6, 0.5), hlh_v3(0, 0, 0), 11, 0.45, 0.65,
                   hlh_v3(1.5, 1.4, 1.25));
    hlh_build_shadow(b);
    for (int i = 0; i < 10; i++)
        hlh_build_random_light(b, hlh_v3(-4.5 + 2.25 * (i % 5), 1.2,
                                         i < 5 ? -2.6 : 2.6), &lamps);
    for (int k = 0; k < 3; k++)
        b->scene->ambient[k] = 0.03f;
    hlh_build_camera(b, hlh_v3(0.4, 5.2, 7.6), hlh_v3(0, 1.35, -0.1), 45);
}

void hlh_build_blades(struct hlh_builder *b) { blades(b, ALL); }
void hlh_build_blades_0(struct hlh_builder *b) { blades(b, 0); }
void hlh_build_blades_1(struct hlh_builder *b) { blades(b, 1); }
void hlh_build_blades_2(struct hlh_builder *b) { blades(b, 2); }
void hlh_build_blades_3(struct hlh_builder *b) { blades(b, 3); }

/* ---- glass -------------------------------------------------------------- */

enum { KINDS = 4, TINTS = 5 };

static uint32_t glass_body(struct hlh_builder *b, int kind, int tint)
{
    uint32_t m = hlh_build_material(b, "glass",
                                    hlh_hue((double)tint / TINTS, 0.6, 0.8),
                                    0.3 + 0.08 * tint, 0);
    struct hlh_material *material = hlh_build_last_material(b);
    material->base_color[3] = 0.3f + 0.08f * (float)tint;
    material->alpha = HLH_ALPHA_BLEND;
    if (kind == 0)
        hlh_add_sphere(b, hlh_v3(0, 0.5, 0), 0.5, 24, 12);
    else if (kind == 1)
        hlh_add_box(b, hlh_v3(0, 0.6, 0), hlh_v3(0.4, 0.6, 0.4), 2, false);
    else if (kind == 2)
        hlh_add_tube(b, hlh_v3(0, 0, 0), hlh_v3(0, 1.3, 0), 0.42, 0.3, 24, 2,
                     true);
    else
        hlh_add_patch(b, hlh_v3(-0.7, 0, 0), hlh_v3(1.4, 0, 0),
                      hlh_v3(0, 1.5, 0), 2, 2);
    material->double_sided = kind == 3;
    return hlh_build_mesh(b, "glass", m);
}

static void glass_bodies(struct hlh_builder *b)
{
    uint32_t mesh[KINDS * TINTS];
    for (int i = 0; i < KINDS * TINTS; i++)
        mesh[i] = glass_body(b, i % KINDS, i / KINDS);
    for (int i = 0; i < 60; i++) {
        uint32_t m = mesh[hlh_random_below(b, KINDS * TINTS)];
        double x = -4.5 + i % 10 + hlh_random(b, -0.3, 0.3);
        double z = 2 - 1.1 * (i / 10) + hlh_random(b, -0.25, 0.25);
        double size = hlh_random(b, 0.7, 1.2);
        hlh_build_object(b, m, hlh_v3(x, 0.002, z), hlh_v3(size, size, size),
                         hlh_random(b, -0.12, 0.12));
    }
}

void hlh_build_glass(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0.5, 0.4, 0.5}, {2.6, 4}, {0.5, 0.9}, {0.4, 0.7}};
    uint32_t stone = hlh_build_material(b, "stone", hlh_v3(0.6, 0.6, 0.62),
                                        0.7, 0);
    hlh_add_box(b, hlh_v3(0, -0.1, 0), hlh_v3(8, 0.1, 7), 12, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", stone));
    hlh_add_box(b, hlh_v3(0, 1.5, -5.6), hlh_v3(8, 1.5, 0.2), 8, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "wall", stone));
    hlh_add_box(b, hlh_v3(0, 1.2, 0), hlh_v3(0.15, 1.2, 0.15), 2, false);
    uint32_t post = hlh_build_mesh(b, "post", stone);
    for (int i = 0; i < 5; i++)
        hlh_build_object(b, post, hlh_v3(-4 + 2 * i, 0, -1.1),
                         hlh_v3(1, 1, 1), 0);
    glass_bodies(b);
    hlh_build_light(b, hlh_v3(1.5, 4.2, 1), 11, hlh_v3(0.9, 0.85, 0.75));
    hlh_build_shadow(b);
    for (int i = 0; i < 24; i++)
        hlh_build_random_light(b, hlh_v3(-5 + 2 * (i % 6), 1.2,
                                         3 - 2.2 * (i / 6)), &lamps);
    for (int k = 0; k < 3; k++)
        b->scene->ambient[k] = 0.02f;
    hlh_build_camera(b, hlh_v3(1.2, 2.1, 7.2), hlh_v3(0, 0.7, -0.5), 50);
}
