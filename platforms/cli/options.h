/* SPDX-License-Identifier: Zlib */
#ifndef HLC_OPTIONS_H
#define HLC_OPTIONS_H
/* The command line, parsed and checked. Strings point into argv; nothing is
 * owned. A value that was not given has the default stated here. */
#include <stdbool.h>
#include <stdint.h>
#include "core/needs.h"
#include "hal/caps.h"

enum hlc_command {
    HLC_HELP = 0, HLC_VERSION, HLC_RENDER, HLC_PLAN, HLC_DEVICES, HLC_SCENE,
    HLC_COMPARE, HLC_CONFORM, HLC_CHART, HLC_STABILITY, HLC_CALIBRATE,
    HLC_COMMAND_COUNT
};

/* How --ids-scheme names regions in the DSF buffer (core/ids.h). */
enum hlc_ids_scheme {
    HLC_IDS_UNIQUE = 0,      /* coloured beyond 65,534 regions               */
    HLC_IDS_COLORED,
    HLC_IDS_PAPER            /* random 8-bit ids, as published               */
};

/* What becomes of alpha masked materials. */
enum hlc_mask { HLC_MASK_SCENE = 0, HLC_MASK_TEST, HLC_MASK_BLEND };

enum { HLC_SIZE_MAX = 16384, HLC_FRAMES_MAX = 100000, HLC_ARGS = 64 };

struct hlc_options {
    enum hlc_command command;
    const char *arg[HLC_ARGS];   /* SCENEs, or TEST and REF; NULL past n_args */
    uint32_t n_args;

    /* machine */
    const char *backend;     /* a name hl_platform_find knows; NULL: the
                              * first that has a device                      */
    const char *device;      /* as hl_device_desc.device; NULL: best         */
    const char *gl_context;  /* "osmesa", "egl"; NULL: whichever there is    */
    const char *profile;     /* console whose rules hold; NULL: the device's */
    uint32_t threads;        /* of packemu; 0 = one a processor              */
    bool validation;

    /* picture */
    uint32_t width, height;  /* pixels, 1..HLC_SIZE_MAX; 1280 x 720, of
                              * calibrate 640 x 360, of chart 0: its own     */
    uint32_t samples;        /* 1, 2, 4 or 8; 1                              */
    uint32_t supersample;    /* reference: N x N a pixel, 1..64; 0 = off     */
    double exposure;         /* EV, -64..64; 0                               */
    const char *out, *hdr;   /* PNG, PFM; NULL: not written                  */
    const char *json;        /* "-" = stdout; NULL: not written              */
    const char *dump;        /* folder; NULL: none                           */
    const char *ids;         /* render: PNG to write; compare: PNG to read   */
    uint32_t frames;         /* timed; 0 = not asked: one frame, untimed     */
    uint32_t warmup;         /* frames drawn before the timed ones; 3        */

    /* scene */
    bool has_camera;
    double eye[3], target[3], vfov;  /* vfov degrees, 0 < vfov < 180         */
    const char *lights;      /* CSV; NULL: none                              */
    bool lights_replace;     /* false: added to the scene's                  */
    bool has_ambient, has_background;
    double ambient[3], background[3]; /* >= 0                                */
    double near, far;        /* metres, > 0, near < far if both; 0 = by the
                              * scene's bounds                               */
    bool no_normal_maps, no_specular;

    /* pipeline and the planner's choices */
    enum hl_pipeline pipeline;       /* AUTO                                 */
    bool reference;                  /* --pipeline reference                 */
    uint32_t light_width, light_height; /* texels; 0 = planner's             */
    enum hl_light_path light_path;   /* AUTO                                 */
    uint32_t light_batch;            /* 1..16; 0 = planner's                 */
    uint32_t tile;                   /* 8..256 texels; 0 = planner's         */
    bool no_tile_depth, no_scissor;
    enum hl_dsf dsf;                 /* AUTO                                 */
    double dsf_k, dsf_c, dsf_tau;    /* 0 = planner's                        */
    enum hlc_ids_scheme ids_scheme;
    uint32_t ids_seed;       /* of HLC_IDS_PAPER's random numbers            */
    enum hl_format light_format, normal_format;  /* NONE = planner's         */
    enum hl_half_pixel half_pixel;   /* AUTO                                 */
    uint32_t volume_texels;  /* 0 = planner's                                */

    /* shadows, translucency, channels */
    bool has_shadows;        /* --shadows was given; not: none, and all of
                              * the scene's in the reference renderer        */
    enum hl_shadows shadows;
    uint32_t shadow_size;    /* texels a side; 0 = planner's                 */
    bool shadow_lights_all;  /* every light casts shadows                    */
    enum hl_translucency translucency;
    enum hl_stipple_mode stipple_mode;
    enum hl_stipple_filter stipple_filter;
    enum hlc_mask mask;
    enum hl_fill fill;
    enum hl_fetch fetch;
    bool no_centroid, motion;
    double jitter[2];        /* pixels                                       */
    uint32_t part_width, part_height; /* pixels; 0 = all                     */

    /* conform */
    const char *mutant;      /* a defect that must be caught; NULL: none     */
    const char *only;        /* checks whose names begin with it; NULL: all  */
    uint32_t seed;           /* of random cases; 1                           */
    bool list, quick;

    /* chart, stability, calibrate */
    const char *machines;    /* "vulkan,packemu:ps3"; NULL: the command's own */
    const char *check;       /* file of figures to compare with; NULL: none  */
    const char *save;        /* the same, to write; NULL: none               */
    uint32_t rounds;         /* timed A/B rounds; 0 = no times               */
    bool has_rounds;
    bool fast, afresh;

    /* --max-error: of a plan a bound of its predicted RMS error in 8-bit sRGB
     * codes, of compare the largest linear difference that passes. */
    bool has_max_error, has_min_psnr;
    double max_error, min_psnr;
    double max_cost;         /* ms by the planner's prediction; 0 = no bound */
    const char *calibration; /* file of `calibrate`; NULL: built-in values   */
};

/* Parse argv[1..]. 0, or an exit code after one line on stderr. */
int hlc_options_parse(struct hlc_options *out, int argc, char **argv);

/* Command of a name; false when there is none. */
bool hlc_command_find(enum hlc_command *out, const char *name);
/* Print the help of one command, or for HLC_HELP of the tool, to stdout. */
void hlc_options_help(enum hlc_command command);
#endif
