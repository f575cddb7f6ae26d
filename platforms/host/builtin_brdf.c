/* SPDX-License-Identifier: Zlib */
/* Pairs of bodies that differ in their BRDF alone, lit from the side, so that
 * the terminator is seen. */
#include "platforms/host/builder.h"

static uint32_t body(struct hlh_builder *b, int kind, bool skin)
{
    uint32_t m = hlh_build_material(b, skin ? "skin" : "plain",
                                    hlh_v3(0.8, 0.55, 0.45), 0.5 + 0.1 * kind,
                                    0);
    hlh_build_last_material(b)->brdf = skin ? HLH_BRDF_SKIN
                                            : HLH_BRDF_BLINN_PHONG;
    if (kind == 0)
        hlh_add_sphere(b, hlh_v3(0, 0.7, 0), 0.7, 40, 20);
    else if (kind == 1)
        hlh_add_torus(b, hlh_v3(0, 0.4, 0), 0.5, 0.28, 40, 16);
    else
        hlh_add_rounded_box(b, hlh_v3(0.5, 0.5, 0.5), 0.2, 9);
    return hlh_build_mesh(b, "body", m);
}

void hlh_build_brdfs(struct hlh_builder *b)
{
    static const struct hlh_light_range lamps = {
        {0.5, 0.3, 0.4}, {2, 3}, {0.4, 0.8}, {0.2, 0.4}};
    uint32_t floor = hlh_build_material(b, "floor", hlh_v3(0.4, 0.4, 0.42),
                                        0.8, 0);
    hlh_add_box(b, hlh_v3(0, -0.1, 0), hlh_v3(5, 0.1, 4), 8, false);
    hlh_build_object_at_origin(b, hlh_build_mesh(b, "floor", floor));
    for (int i = 0; i < 6; i++)
        hlh_build_object(b, body(b, i / 2, i & 1),
                         hlh_v3(-3.2 + 3.2 * (i / 2), i < 4 ? 0 : 0.5,
                                i & 1 ? 1.3 : -0.9), hlh_v3(1, 1, 1), 0.1);
    hlh_build_directional(b, hlh_v3(-1, -0.35, -0.1), hlh_v3(0.9, 0.85, 0.8));
    for (int i = 0; i < 5; i++)
        hlh_build_random_light(b, hlh_v3(-4 + 2 * i, 0.8, 0.2), &lamps);
    for (int k = 0; k < 3; k++)
        b->scene->ambient[k] = 0.02f;
    hlh_build_camera(b, hlh_v3(0.4, 3.1, 6.6), hlh_v3(0, 0.5, 0), 45);
}
