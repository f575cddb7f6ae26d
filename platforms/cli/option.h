/* SPDX-License-Identifier: Zlib */
#ifndef HLC_OPTION_H
#define HLC_OPTION_H
/* A row of the table of options (options.c), which the parser reads and the
 * help prints, and how its value is taken (option_take.c). */
#include <stddef.h>
#include "platforms/cli/options.h"

#define HLC_FLOAT_RANGE 1e9  /* well inside float, and metres enough         */

enum hlc_option_kind {       /* how a value is read and where it goes        */
    FLAG, TEXT, COUNT, REAL, SIZE,               /* straight into the member */
    BACKEND, PROFILE, PIPELINE, SAMPLES, CAMERA, AMBIENT, BACKGROUND,
    LIGHTS_MODE, DSF, LIGHT_PATH, TILE_DEPTH, SCISSOR, IDS_SCHEME,
    FORMAT, ROUNDS, MIN_PSNR, MAX_ERROR, GL_CONTEXT, HALF_PIXEL,
    SHADOWS, SHADOW_LIGHTS, TRANSLUCENCY, STIPPLE, STIPPLE_FILTER, FILL,
    FETCH, CENTROID, JITTER, MASK
};

struct hlc_option {
    const char *name, *value; /* words are "a|b", NULL for a flag            */
    enum hlc_option_kind kind;
    unsigned commands;        /* bits 1 << enum hlc_command                  */
    size_t at;                /* of the member                               */
    double low, high;
    const char *help;
};

/* Read `value`, NULL for a flag, into *o. 0, or an exit code after a line. */
int hlc_option_take(struct hlc_options *o, const struct hlc_option *r,
                    const char *value);
#endif
