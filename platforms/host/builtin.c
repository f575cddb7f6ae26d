/* SPDX-License-Identifier: Zlib */
/* The table of built-in scenes. */
#include <stdlib.h>
#include <string.h>
#include "platforms/host/builder.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

static const struct {
    const char *name, *description;
    uint32_t seed;
    void (*build)(struct hlh_builder *);
} builtins[] = {
    {"fig1", "213 lights over the walkways of fig9 (figure 1)", 1,
     hlh_build_fig1},
    {"fig7", "287 objects and 287 lights, no textures (Kircher and Lawrance "
     "2009, figure 7)", 7, hlh_build_fig7},
    {"fig8", "101 objects and 81 lights, the paper's worst case for forward "
     "rendering (figure 8)", 8, hlh_build_fig8},
    {"fig9", "122 lights over walkways, stairs, pipes and thin handrails, one "
     "specular exponent (figure 9)", 9, hlh_build_fig9},
    {"lidr", "a hall of columns with 255 lights and about 40,000 triangles "
     "(Trebilco 2007)", 4, hlh_build_lidr},
    {"thin", "wires, fences and planes at grazing angles, matte", 5,
     hlh_build_thin},
    {"many", "a wall of 1,000 touching bricks under 50 lights", 6,
     hlh_build_many},
    {"blades", "rotor blades that cast a shadow on three translucent panes "
     "and the floor (figure 6)", 10, hlh_build_blades},
    {"blades-0", "blades where only what is opaque reflects light", 10,
     hlh_build_blades_0},
    {"blades-1", "blades where only the lowest pane reflects light", 10,
     hlh_build_blades_1},
    {"blades-2", "blades where only the middle pane reflects light", 10,
     hlh_build_blades_2},
    {"blades-3", "blades where only the highest pane reflects light", 10,
     hlh_build_blades_3},
    {"fence", "chain-link fences before drums and crates, 40 lights "
     "(figure 10)", 11, hlh_build_fence},
    {"decals", "a floor and a wall with dents and tiles that change their "
     "normals, 30 lights", 12, hlh_build_decals},
    {"shadows", "a spot, a directional and a point light that cast shadows "
     "over simple bodies", 13, hlh_build_shadows},
    {"glass", "60 translucent bodies, many of them in a row, one light that "
     "casts shadows", 14, hlh_build_glass},
    {"brdfs", "pairs of bodies of two BRDFs, lit from the side", 15,
     hlh_build_brdfs},
};
enum { N_BUILTINS = sizeof builtins / sizeof *builtins };

const char *hlh_scene_builtin_name(uint32_t i, const char **description)
{
    if (i >= N_BUILTINS)
        return NULL;
    if (description)
        *description = builtins[i].description;
    return builtins[i].name;
}

bool hlh_scene_builtin(struct hlh_scene *out, const char *name,
                       struct hlh_error *error)
{
    struct hlh_builder b;
    uint32_t i = 0;
    memset(out, 0, sizeof *out);
    while (i < N_BUILTINS && strcmp(builtins[i].name, name) != 0)
        i++;
    if (i == N_BUILTINS)
        return hlh_fail(error, name, "is not a built-in scene");
    hlh_build_begin(&b, out, builtins[i].seed);
    builtins[i].build(&b);
    free(b.vertices);
    free(b.indices);
    out->name = hlh_strdup(name);
    if (b.failed || !out->name)
        hlh_fail(error, name, "out of memory");
    else if (hlh_scene_finish(out, name, true, error))
        return true;
    hlh_scene_free(out);
    return false;
}
