/* SPDX-License-Identifier: Zlib */
#ifndef HL_PLAN_H
#define HL_PLAN_H
/* A frame as data: what to allocate, what to run, in order, and why. Holds
 * no handle and no pointer, so plans can be compared, printed and replayed;
 * passes that repeat carry a word for it, so a plan does not grow with
 * lights or tiles. K = Kircher, Lawrance 2009. */
#include "core/needs.h"
#include "shaders/shared/block.h"
#include "hal/hal.h"

enum hl_role {                     /* of a target                            */
    HL_ROLE_NONE = 0,
    HL_ROLE_NORMAL,                /* G-buffer: normal x, y (K eq. 1)        */
    HL_ROLE_DSF,                   /* G-buffer: linear depth, region id      */
    HL_ROLE_EXPONENT,              /* G-buffer: specular exponent; with
                                    * brdfs a pair, BRDF the second          */
    HL_ROLE_LIGHT_DEPTH,           /* depth at L-buffer size                 */
    HL_ROLE_LIGHT,                 /* L-buffer                               */
    HL_ROLE_COLOR,                 /* the frame, linear                      */
    HL_ROLE_DEPTH,                 /* depth of the frame                     */
    HL_ROLE_RESOLVED,              /* the frame, one sample a pixel          */
    HL_ROLE_DEPTH_COPY,            /* LIGHT_DEPTH, where a bound depth target
                                    * cannot be read: one float channel      */
    /* G-buffer: motion since the last frame, x right and y down, a pair of
     * pack.h hl_motion_decode: 2 is the whole target, cut to -1..1, 0 where
     * nothing is or was seen. Without jitter. What is blended over by forward
     * draws leaves it, and so do decals. */
    HL_ROLE_MOTION,
    HL_ROLE_SHADOW_MAP,            /* depth from a light: 1 map, or 3 x 2    */
    HL_ROLE_COUNT
};

enum hl_pass_role {
    HL_PASS_NONE = 0,
    HL_PASS_GEOMETRY,
    HL_PASS_LIGHT,
    HL_PASS_MATERIAL,
    HL_PASS_FORWARD,               /* base draws, then further lights        */
    HL_PASS_BLENDED,
    HL_PASS_DEPTH_COPY,            /* after the geometry pass                */
    HL_PASS_SHADOW_MAP,            /* before the light pass of its light     */
    HL_PASS_SHADOWED,              /* light of one light with shadow         */
    HL_PASS_ROLE_COUNT
};

enum hl_repeat {
    HL_ONCE = 0, HL_PER_TILE, HL_PER_LIGHTS, HL_PER_OBJECT_LIGHTS,
    HL_PER_SHADOW_LIGHT
};

/* Why something was decided; text and the paper's section are made outside
 * core from the id and up to four numbers. */
enum hl_reason {
    HL_WHY_NONE = 0,
    HL_WHY_PIPELINE_ASKED, HL_WHY_PIPELINE_CHEAPEST,
    HL_WHY_LIGHT_SIZE_ASKED, HL_WHY_LIGHT_SIZE_DEFAULT,
    HL_WHY_NORMAL_FORMAT, HL_WHY_DSF_FORMAT,
    HL_WHY_EXPONENT_NONE, HL_WHY_EXPONENT_CONSTANT, HL_WHY_EXPONENT_CHANNEL,
    HL_WHY_PATH_ASKED, HL_WHY_PATH_CHEAPEST, HL_WHY_TILE_DEPTH,
    HL_WHY_LIGHT_FORMAT_ASKED, HL_WHY_LIGHT_FORMAT_ERROR,
    HL_WHY_COLOR_FORMAT,
    HL_WHY_DSF_OFF, HL_WHY_DSF_SLOPE, HL_WHY_DSF_CONSTANT, HL_WHY_DSF_EXACT,
    HL_WHY_DEPTH_REVERSED, HL_WHY_SAMPLES, HL_WHY_BLENDED_FORWARD,
    HL_WHY_SCISSOR, HL_WHY_NO_SCISSOR, HL_WHY_NO_LIGHTS,
    /* What a profile rules (hal/profile.h). */
    HL_WHY_STAND_IN, HL_WHY_TWO16_FIXED32, HL_WHY_TWO16_SIGNED,
    HL_WHY_TWO16_BYTES_ARGB, HL_WHY_TWO16_BYTES, HL_WHY_ID_STEPS,
    HL_WHY_MRT_FORMAT, HL_WHY_FLOAT_TAPS,
    HL_WHY_LIGHT_FORMAT_PROFILE, HL_WHY_NO_BLEND, HL_WHY_LIGHT_RANGE,
    HL_WHY_LIGHT_PEAK_CUT, HL_WHY_LIGHT_PEAK_DEFAULT, HL_WHY_COLOR_STEP,
    HL_WHY_DEPTH_BARG, HL_WHY_DEPTH_PLAIN, HL_WHY_DEPTH_IN_PLACE,
    HL_WHY_DEPTH_READ_ONLY, HL_WHY_DEPTH_COPY,
    HL_WHY_HALF_PIXEL_STATE, HL_WHY_HALF_PIXEL_VERTEX,
    HL_WHY_HALF_PIXEL_NONE, HL_WHY_HALF_PIXEL_HERE,
    HL_WHY_DECALS_BLEND, HL_WHY_DECALS_PACKED, HL_WHY_DECALS_NO_BLEND,
    HL_WHY_DECALS_FORWARD, HL_WHY_RESOLVE,
    HL_WHY_EDRAM_RESIDENT, HL_WHY_EDRAM_SHARED, HL_WHY_EDRAM_FRAME,
    HL_WHY_LIGHT_SIZE_EDRAM,
    /* Of a refusal (EDRAM_SET of a plan too): what does not fit and what
     * would. */
    HL_WHY_EDRAM_SET, HL_WHY_EDRAM_SURFACE, HL_WHY_EDRAM_SUM, HL_WHY_EDRAM_FITS,
    HL_WHY_EDRAM_FITS_RESIDENT, HL_WHY_EDRAM_TILING,
    HL_WHY_NOT_BLENDABLE,
    HL_WHY_STIPPLED, HL_WHY_STIPPLE_LAYERS, HL_WHY_STIPPLE_FILTER,
    HL_WHY_SHADOW_VOLUMES, HL_WHY_SHADOW_MAPS, HL_WHY_SHADOW_SIZE,
    HL_WHY_INFINITE_FAR, HL_WHY_VOLUME_TEXELS, HL_WHY_FILL, HL_WHY_FETCH,
    HL_WHY_CENTROID, HL_WHY_MOTION, HL_WHY_BRDFS, HL_WHY_NO_LIGHT_PASS,
    HL_WHY_BUDGET_ERROR, HL_WHY_BUDGET_COST, HL_WHY_BUDGET_MISSED,
    HL_WHY_LIGHT_FORMAT_DARK, HL_WHY_LIGHT_ALPHA,
    HL_WHY_PIPELINE_BUDGET, HL_WHY_LIGHT_SIZE_BUDGET,
    HL_WHY_LIGHT_FORMAT_BUDGET,
    HL_WHY_COUNT
};

/* Arguments of those whose name does not tell: STIPPLED side, forward and
 * stippled nanoseconds a translucent pixel; STIPPLE_LAYERS asked for, there
 * are; STIPPLE_FILTER 1 for cone; SHADOW_VOLUMES, _MAPS lights, maps a light;
 * SHADOW_SIZE texels; VOLUME_TEXELS texels; FILL enum hl_fill, nanoseconds
 * that NEAREST adds to every pixel, DEPTH's whole pixel; FETCH 1 for
 * bilinear, nanoseconds a pixel gathered, filtered; CENTROID 1 for on;
 * MOTION, BRDFS format; BUDGET_ERROR budget, predicted error, predicted ms,
 * plans compared; BUDGET_COST budget, predicted ms, predicted error, plans
 * compared; BUDGET_MISSED (of a refusal) budget of error or 0, of cost or 0,
 * the least predicted error, the least predicted cost; LIGHT_FORMAT_DARK
 * format not taken, codes of half its step, max_error, peak; LIGHT_ALPHA
 * format, bits, step, peak. */

/* Which need could not be met. */
enum hl_refusal {
    HL_REFUSED_NOTHING = 0, HL_REFUSED_SIZE, HL_REFUSED_LIGHT_SIZE,
    HL_REFUSED_SAMPLES, HL_REFUSED_NORMAL_FORMAT, HL_REFUSED_COLOR_FORMAT,
    HL_REFUSED_LIGHT_FORMAT, HL_REFUSED_DEPTH_FORMAT, HL_REFUSED_STORAGE,
    HL_REFUSED_VALUE, HL_REFUSED_PIPELINE, HL_REFUSED_EDRAM,
    HL_REFUSED_HALF_PIXEL, HL_REFUSED_SHADOWS, HL_REFUSED_MOTION,
    HL_REFUSED_BUDGET,
    HL_REFUSED_COUNT
};

struct hl_plan_reason { enum hl_reason why; float arg[4]; };

struct hl_plan_target {
    enum hl_role role;
    enum hl_format format;
    enum hl_format sample_as;      /* as hl_tex_desc's; NONE = format        */
    struct hl_console console;     /* as hl_tex_desc's                       */
    uint32_t edram_tiles;          /* taken from console.edram_tile on       */
    uint32_t width, height, samples;
    uint32_t read_by;              /* bits 1 << enum hl_pass_role            */
    uint64_t bytes;
    float error;                   /* worst encoding error; unit by role:
                                    * NORMAL degrees up to 90 from the view
                                    * axis, DSF metres, EXPONENT and LIGHT
                                    * and COLOR relative, MOTION as decoded  */
};

enum { HL_PLAN_COLORS = 4 };       /* of a pass                              */

struct hl_plan_pass {
    enum hl_pass_role role;
    enum hl_repeat repeat;
    enum hl_role color[HL_PLAN_COLORS]; /* NONE where unused                 */
    enum hl_role depth;
    bool depth_read_only, depth_write;
    enum hl_compare depth_test;
    enum hl_blend blend;
    uint32_t lights_a_draw;        /* 0: none                                */
};

enum { HL_PLAN_TARGETS = 12, HL_PLAN_PASSES = 10, HL_PLAN_REASONS = 64 };

enum hl_decals {                   /* how decals change normals              */
    HL_DECALS_NONE = 0,
    HL_DECALS_BLEND_NORMALS,       /* blended into the normal target         */
    HL_DECALS_ALPHA_OBJECTS        /* drawn as translucent surfaces (K 5.2)  */
};

struct hl_plan {
    enum hl_pipeline pipeline;
    uint32_t width, height, light_width, light_height, samples;
    uint32_t n_targets, n_passes, n_reasons;
    struct hl_plan_target target[HL_PLAN_TARGETS];
    struct hl_plan_pass pass[HL_PLAN_PASSES];
    struct hl_plan_reason reason[HL_PLAN_REASONS];

    uint32_t specular;             /* HL_SPECULAR_* of block.h               */
    float exponent;
    uint32_t falloff, kinds;       /* values of HL_SPEC_FALLOFF, _KINDS      */
    enum hl_light_path light_path;
    uint32_t batch, tile;
    bool light_flat;               /* lights go down as flat varyings        */
    bool tile_depth;               /* lists bounded by depth read back       */
    bool scissor;
    bool reversed_depth;           /* near is 1, far is 0                    */
    uint32_t dsf;                  /* HL_DSF_* of block.h                    */
    float dsf_k, dsf_c, dsf_tau;
    uint32_t light_bits;           /* HL_BITS_* of block.h                   */
    float light_scale;             /* light = sampled * light_scale          */
    float light_out;               /* written = light * light_out            */
    char profile[16];              /* of the caps                            */
    uint32_t two16;                /* HL_TWO16_* of block.h: normals and DSF */
    uint32_t depth_read;           /* HL_DEPTH_READ_* of block.h             */
    float id_steps;                /* an id is stored as id / id_steps       */
    bool float_taps;               /* DSF and L-buffer sampled as numbers    */
    enum hl_half_pixel half_pixel; /* AUTO: the machine has centres at halves */
    enum hl_decals decals;
    enum hl_translucency translucency; /* AUTO: nothing is translucent       */
    uint32_t stipple;              /* texels a side of a pattern's block: 0, 2
                                    * or 4                                   */
    bool stipple_cone;             /* its filter, else bilinear              */
    enum hl_stipple_mode stipple_mode;
    enum hl_shadows shadows;
    uint32_t shadow_size;          /* of a map, texels a side                */
    bool infinite_far;             /* projections end at no far plane, so that
                                    * no volume is cut; camera.far still bounds
                                    * culling and the DSF's depth            */
    uint32_t volume_texels;        /* as needs', chosen                      */
    enum hl_fill fill;             /* AUTO: no tap is ever rejected          */
    bool dsf_bilinear;             /* hl_fetch                               */
    bool centroid;                 /* of the multisampled material pass      */
    bool motion, brdfs;            /* further G-buffer channels              */
    uint32_t edram_tiles;          /* most tiles in use at once; 0: no EDRAM */
    float far;                     /* the depth that DSF stores as 1         */

    float bytes_per_pixel;         /* all targets, a frame pixel             */
    float moved_per_pixel;         /* bytes read and written a frame pixel   */
    float light_error;             /* predicted relative error of the light  */
    float cost_ms;                 /* predicted by caps.cost                 */
    /* Predicted error of the picture by caps.error and needs.probe, RMS of
     * 8-bit sRGB codes, at most 255; forward pipelines: the probe's, and of
     * their encodings. The inferred pipeline's with the filter and features
     * that the probe was drawn with: with others it is a guess. */
    float error_codes;
};

/* The cheapest plan of `pipeline` (AUTO: of all) that meets `needs` within
 * `caps`. Pure: equal inputs give equal plans; allocates nothing, touches no
 * device. HL_ERR_UNSUPPORTED or HL_ERR_INVALID when a need cannot be met:
 * *why (may be NULL) then says which, and *out is zeroed but for its reasons,
 * which give the numbers and what would fit. */
enum hl_result hl_plan_make(struct hl_plan *out, enum hl_pipeline pipeline,
                            const struct hl_needs *needs,
                            const struct hl_caps *caps, enum hl_refusal *why);

/* Nanoseconds by caps.cost of blending one texel of a format, and of fetching
 * one: the format's own where it is known, else by its bytes as hl_cost_model
 * says. HL_FORMAT_NONE or out of range: 0. */
double hl_blend_ns(const struct hl_caps *, enum hl_format);
double hl_fetch_ns(const struct hl_caps *, enum hl_format);

/* Target of a role, NULL where the plan has none. */
const struct hl_plan_target *hl_plan_target(const struct hl_plan *,
                                            enum hl_role role);
#endif
