/* SPDX-License-Identifier: Zlib */
#ifndef HL_NEEDS_H
#define HL_NEEDS_H
/* What a scene asks of a frame: numbers an engine knows before it draws, and
 * choices it may fix. Zero is "unknown" for a number, "planner's choice" for
 * a choice. */
#include "core/stipple_mode.h"
#include "hal/caps.h"

enum hl_pipeline {
    HL_PIPELINE_AUTO = 0,
    HL_PIPELINE_FORWARD,           /* up to 8 lights a draw (FWD-2)          */
    HL_PIPELINE_FORWARD_MULTIPASS, /* one draw a light and object (FWD-1)    */
    HL_PIPELINE_INFERRED,          /* Kircher, Lawrance 2009                 */
    HL_PIPELINE_COUNT
};

enum hl_specular_need {
    HL_NEED_NO_SPECULAR = 0,       /* no material is specular                */
    HL_NEED_ONE_EXPONENT,          /* all share hl_needs.exponent            */
    HL_NEED_EXPONENTS              /* they differ                            */
};

enum {                             /* hl_needs.lights                        */
    HL_LIGHTS_SMOOTH = 1, HL_LIGHTS_INVERSE_SQUARE = 2, HL_LIGHTS_CONES = 4
};                                 /* CONES: spots or directional lights     */

/* How the light pass finds the lights of a pixel. */
enum hl_light_path {
    HL_LIGHT_PATH_AUTO = 0,
    HL_LIGHT_PATH_RECTS,           /* scissor rectangles, K lights a draw    */
    HL_LIGHT_PATH_TILES,           /* host-made tile lists, a draw a tile    */
    HL_LIGHT_PATH_LISTS,           /* the same lists looped in the shader    */
    /* One draw a light, cut to its scissor rectangle and, where that is
     * large, to a depth-fail stencil volume: the published way (K 2.2). */
    HL_LIGHT_PATH_VOLUMES
};

/* How translucent surfaces are lit. */
enum hl_translucency {
    HL_TRANSLUCENCY_AUTO = 0,      /* the cheaper; 2X2 where shadows are     */
    HL_TRANSLUCENCY_FORWARD,       /* all of an object's lights in its draw  */
    HL_TRANSLUCENCY_2X2,           /* stippled into the G-buffer (K 4): three
                                    * layers over opaque                     */
    HL_TRANSLUCENCY_4X4            /* fifteen                                */
};

/* How a translucent pixel weighs the four samples of its pattern. */
enum hl_stipple_filter {
    HL_STIPPLE_FILTER_AUTO = 0,    /* CONE                                   */
    HL_STIPPLE_CONE,               /* small radius cone (K 4)                */
    HL_STIPPLE_BILINEAR
};

/* Lights with hl_light.shadow. Forward pipelines have no shadows. */
enum hl_shadows {
    HL_SHADOWS_NONE = 0,           /* hl_light.shadow is not read            */
    HL_SHADOWS_VOLUMES,            /* stencil, depth-fail                    */
    HL_SHADOWS_MAPS
};

/* What a pixel reads whose DSF taps are all rejected. */
enum hl_fill {
    HL_FILL_AUTO = 0,              /* NEAREST; DEPTH on machines that run what
                                    * a condition leaves out as well, but for
                                    * 4 x 4 patterns                         */
    HL_FILL_NEAREST,               /* the nearest sample of its own surface
                                    * within two L texels, else DEPTH        */
    HL_FILL_BILINEAR,              /* all four, as published (K 3)           */
    HL_FILL_DEPTH                  /* all four, by nearness in depth too; what
                                    * is stippled as NEAREST                 */
};

/* How the DSF fetches light. */
enum hl_fetch {
    HL_FETCH_AUTO = 0,             /* the cheaper                            */
    HL_FETCH_GATHER,               /* four samples                           */
    HL_FETCH_BILINEAR              /* one filtered where no tap is rejected,
                                    * else four (K 7.1)                      */
};

/* Machines with Direct3D 9 pixel centres: who puts them at halves. Never
 * both, which would shift by half a pixel again. */
enum hl_half_pixel {
    HL_HALF_PIXEL_AUTO = 0,        /* STATE on such machines, else nothing   */
    HL_HALF_PIXEL_NONE,            /* nobody: pictures are half a pixel off  */
    HL_HALF_PIXEL_STATE,           /* D3DRS_HALFPIXELOFFSET                  */
    HL_HALF_PIXEL_VERTEX           /* the vertex stages, by target size      */
};

enum hl_dsf {
    HL_DSF_AUTO = 0,               /* SLOPE, or EXACT at 1:1                 */
    HL_DSF_NONE,                   /* plain bilinear                         */
    HL_DSF_SLOPE_SCALED,
    HL_DSF_CONSTANT_TAU            /* the paper's one threshold              */
};

/* What a scene's pictures show of the method's errors, measured once by
 * drawing them (an engine: once a level; the tool: platforms/cli/probe.h), as
 * RMS of 8-bit sRGB codes, 0..255, frames of this size and these samples. 0:
 * unknown, and hl_caps.error's value counts; less than 1e-6: none. */
struct hl_probe {
    float full;    /* inferred with an L-buffer of the frame's size, 32-bit
                    * floats, against the truth: a reference renderer's
                    * picture or, without one, forward's                     */
    float half;    /* the same with half of that a side, against that        */
    float eight;   /* with RGBA8_UNORM at the frame's size, against that     */
    float eight_blends;      /* mean blends an L texel had in it; 0 = 1      */
    /* As half, with three quarters and with one quarter of that a side:
     * scenes differ in how the error grows as the L-buffer gets smaller. */
    float three_quarters, quarter;
    /* Forward against the truth: edges that are a pixel apart. 0: it is the
     * truth. */
    float forward;
};

struct hl_needs {
    uint32_t width, height;        /* frame, pixels; required                */
    /* L-buffer texels; 0 = 5/8 (K Fig. 9), or the most that EDRAM holds. */
    uint32_t light_width, light_height;
    uint32_t samples;              /* of the frame; 0 = 1                    */
    uint32_t n_objects, n_triangles, n_lights;
    float lights_per_pixel;        /* mean over the screen, by light bounds  */
    float lights_per_object;       /* mean lights that touch an object       */
    /* Forward draws of eight lights beyond an object's first: how many, their
     * triangles, and their fragments a covered pixel; and the number, the
     * triangles and the fragments a frame pixel of one draw a light and
     * object. Of opaque objects alone; 0: estimated from the means above. */
    float further_draws, further_triangles, further_cover;
    float pair_draws, pair_triangles, pair_cover;
    float cover;                   /* share of the screen before which opaque
                                    * objects' boxes lie, 0..1; 0 = 1        */
    uint32_t n_regions;            /* object regions: sum of normal groups   */
    uint32_t lights;               /* HL_LIGHTS_*; 0 = SMOOTH                */
    enum hl_specular_need specular;
    float exponent;                /* HL_NEED_ONE_EXPONENT, 1..256           */
    bool blended;                  /* some surfaces are translucent          */
    float far;                     /* metres; 0 = 1000: depth quantisation   */
    float peak;                    /* bound of summed light at any point     */
    float max_error;               /* of encodings: 8-bit sRGB codes; 0 = 1  */
    /* Bounds of the whole, 0 = none: of the predicted error of the picture,
     * RMS of 8-bit sRGB codes, and of the predicted cost. The cheapest plan
     * within budget_codes; without that, the most accurate within budget_ms;
     * pipeline, L-buffer size and L-buffer format are chosen where they are
     * not given. */
    float budget_codes, budget_ms;
    struct hl_probe probe;
    bool decals;                   /* surfaces that change others' normals   */
    uint32_t blended_layers;       /* most translucent objects over a pixel;
                                    * 0 = unknown                            */
    enum hl_shadows shadows;       /* what lights with hl_light.shadow get   */
    uint32_t n_shadow_lights;
    bool shadow_points;            /* some of them are point lights, or spots
                                    * of HL_SHADOW_WIDE, 1.25 radians, or
                                    * more                                   */
    bool motion;                   /* a motion vector channel is wanted      */
    bool brdfs;                    /* some material has hl_material.brdf > 0 */
    bool light_depth_bound;        /* the light pass tests depth or stencil
                                    * while it reads depth (light volumes)   */

    /* Choices. */
    enum hl_light_path light_path;
    uint32_t batch;                /* lights a draw of RECTS, 1..16          */
    uint32_t tile;                 /* texels a side, 8..256                  */
    bool no_tile_depth;            /* lists without depth bounds             */
    bool no_scissor;               /* multi-pass: every affected object whole */
    enum hl_dsf dsf;
    float dsf_k, dsf_c;            /* 0 = 1.5 and 0.001                      */
    float dsf_tau;                 /* constant threshold, share of z; 0 = 1 % */
    /* RGBA8_UNORM, RGB10A2_UNORM, RGBA16_UNORM (these with a peak),
     * RGBA16_FLOAT or RGBA32_FLOAT, or a profile's; NONE = by its error. */
    enum hl_format light_format;
    /* RG16_UNORM, RG8_UNORM or RG16_FLOAT; NONE = the first, or what a
     * profile rules. */
    enum hl_format normal_format;
    enum hl_half_pixel half_pixel;
    enum hl_translucency translucency;
    enum hl_stipple_filter stipple_filter;
    enum hl_stipple_mode stipple_mode;
    enum hl_fill fill;
    enum hl_fetch fetch;
    uint32_t shadow_size;          /* texels a side of a shadow map, of each of
                                    * a point light's six; 0 = 1024, or less
                                    * where EDRAM holds less                 */
    uint32_t volume_texels;        /* VOLUMES: lights whose rectangle has fewer
                                    * L texels get no stencil volume; 0 = as
                                    * measured, 1 = every light gets one     */
    bool no_centroid;              /* multisampled: interpolate at centres   */
};
#endif
