/* SPDX-License-Identifier: Zlib */
/* Scenes whose counts are known without counting. */
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/host/builder.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

static bool finish(struct hlh_builder *b, const char *name,
                   struct hlh_error *error)
{
    free(b->vertices);
    free(b->indices);
    b->scene->name = hlh_strdup(name);
    bool ok = !b->failed && b->scene->name;
    if (!ok)
        hlh_fail(error, name, "out of memory");
    else
        ok = hlh_scene_finish(b->scene, name, false, error);
    if (!ok)
        hlh_scene_free(b->scene);
    return ok;
}

/* 4 m before a wall of 6 m by 6 aspect; at 50 degrees 3.73 m are in sight. All
 * lights reach every point of it: 10 m. */
bool hlk_plane(struct hlh_scene *out, double aspect, struct hlh_error *error)
{
    struct hlh_builder b;
    memset(out, 0, sizeof *out);
    hlh_build_begin(&b, out, 1);
    uint32_t paint = hlh_build_material(&b, "paint", hlh_v3(0.6, 0.5, 0.4),
                                        0.5, 0);
    hlh_add_patch(&b, hlh_v3(-3 * aspect, -3, 0), hlh_v3(6 * aspect, 0, 0),
                  hlh_v3(0, 6, 0), 4, 4);
    hlh_build_object_at_origin(&b, hlh_build_mesh(&b, "wall", paint));
    for (int i = 0; i < 64; i++)
        hlh_build_light(&b, hlh_v3(0.1 * (i % 8), 0.1 * (i / 8), 1), 10,
                        hlh_v3(0.02, 0.02, 0.02));
    hlh_build_camera(&b, hlh_v3(0, 0, 4), hlh_v3(0, 0, 0), 50);
    return finish(&b, "plane", error);
}

bool hlk_dust(struct hlh_scene *out, uint32_t cuts, struct hlh_error *error)
{
    struct hlh_builder b;
    memset(out, 0, sizeof *out);
    hlh_build_begin(&b, out, 1);
    uint32_t paint = hlh_build_material(&b, "paint", hlh_v3(0.6, 0.5, 0.4),
                                        0.5, 0);
    hlh_add_box(&b, hlh_v3(0, 0, 0), hlh_v3(0.01, 0.01, 0.01), cuts, false);
    uint32_t mesh = hlh_build_mesh(&b, "grain", paint);
    for (int i = 0; i < HLK_DUST; i++)
        hlh_build_object(&b, mesh, hlh_v3(0.2 * (i % 20) - 1.9,
                                          0.2 * (i / 20) - 1.9, 0),
                         hlh_v3(1, 1, 1), 0);
    hlh_build_camera(&b, hlh_v3(0, 0, 6), hlh_v3(0, 0, 0), 50);
    return finish(&b, "dust", error);
}
