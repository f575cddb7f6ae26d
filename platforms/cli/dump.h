/* SPDX-License-Identifier: Zlib */
#ifndef HLC_DUMP_H
#define HLC_DUMP_H
/* What the files of --dump share: dump.c has the targets of a plan,
 * dump_inside.c what the frame counts and the shadow map. */
#include "platforms/cli/readback.h"
#include "platforms/cli/render.h"
#include "platforms/host/util.h"

struct hlc_dump {
    struct hlc_render *r;
    struct hlc_outputs *files;
    struct hlh_error *error;
    struct hlh_buffer index;
};

/* Write as name says, .png or .pfm, and a line of the index. */
bool hlc_dump_picture(struct hlc_dump *, const char *name, const char *what,
                      const struct hlh_picture *, double exposure);
bool hlc_dump_inside(struct hlc_dump *);
bool hlc_dump_shadow_map(struct hlc_dump *, const struct hlc_texels *);

/* Colours to be seen as these sRGB values, 0..1. */
void hlc_show3(float rgb[3], float r, float g, float b);
/* A colour of its own for each number; 0 is black. */
void hlc_show_id(float rgb[3], uint32_t id);
/* 0 black, then blue, cyan, green, yellow, red, 1 white. */
void hlc_show_heat(float rgb[3], float x);
#endif
