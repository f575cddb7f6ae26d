/* SPDX-License-Identifier: Zlib */
#ifndef CF_H
#define CF_H
/* Private to conform: what its files share.
 *
 * A group of checks is one function that reports each of its names once. It
 * returns why it cannot run here, or NULL; the names that it then has not
 * reported are skipped for that reason, or fail where the machine did. */
#include "hal/hal.h"
#include "platforms/conform/conform.h"
#include "shaders/shared/block.h"
#include "shaders/shared/conform.h"

enum cf_mutant {
    CF_MUTANT_NONE = 0, CF_MUTANT_BASE255, CF_MUTANT_SWAPPED_BYTES,
    CF_MUTANT_MISSING_X32, CF_MUTANT_HALF_PIXEL, CF_MUTANT_WRONG_EXP_BIAS,
    CF_MUTANT_BLEND_63_255, CF_MUTANT_ID_65535_ON_XBOX
};

enum { CF_SIDE = 512, CF_PIXELS = CF_SIDE * CF_SIDE, CF_PROGS = 48,
       CF_LAYERS = 4096, CF_STAIRS = 3072 };

struct cf_prog {
    enum hl_format format;
    enum hl_blend blend;
    float constant;
    bool layers;
    hl_prog prog;
};

struct cf {
    const struct hl_conform_desc *desc;
    struct hl_device *device;
    const struct hl_caps *caps;
    const struct hl_profile *profile;
    const char *profile_name;
    enum cf_mutant mutant;
    uint64_t seed;
    bool listed;                 /* required.def has a column for it         */
    bool broken;                 /* a call of the current group failed       */
    enum hl_result result;       /* of the last call that did                */
    char complaint[256];         /* what the device said of it               */
    uint8_t *seen;               /* by name of required.def                  */
    struct hl_conform_counts counts;
    /* Pictures in host memory, CF_PIXELS texels each. */
    float (*in)[4], (*out)[4];
    uint8_t *raw;                /* CF_PIXELS * 16 bytes                     */
    hl_buf block;                /* of the stage                             */
    hl_buf object;               /* of mesh stages                           */
    hl_buf full, stairs;         /* CF_LAYERS triangles over the whole
                                  * target; CF_STAIRS, layer k from column k
                                  * on of a target of CF_STAIRS columns      */
    struct cf_prog prog[CF_PROGS];
    uint32_t n_progs;
};

struct cf_group {
    const char *prefix;          /* of its names, without the last point     */
    const char *(*run)(struct cf *, const struct cf_group *);
    int what;                    /* the function's own                       */
};
extern const struct cf_group cf_groups[];    /* prefix NULL ends             */

/* ---- results: cf_run.c --------------------------------------------------- */

/* A result to be filled in; cf_report gives it its status, worst against
 * limit, unless it is a skip. */
struct hl_conform_result cf_result(enum hl_conform_level,
                                   const char *unit, double limit,
                                   const char *why);
/* A case: kept when it is worse than those before, or NaN. */
void cf_case(struct hl_conform_result *, double error);
void cf_case_at(struct hl_conform_result *, double error, double x, double y);
/* Named "prefix.last". */
void cf_report(struct cf *, const struct cf_group *, const char *last,
               struct hl_conform_result *);
/* Join up to four texts into a buffer. */
void cf_join(char *out, size_t bytes, const char *a, const char *b,
             const char *c, const char *d);

/* ---- drawing: cf_draw.c -------------------------------------------------- */

bool cf_open(struct cf *);
void cf_close(struct cf *);
bool cf_ok(struct cf *, enum hl_result);

/* Sampled, drawn to and read back. */
bool cf_tex(struct cf *, hl_tex *out, enum hl_format format,
            enum hl_format sample_as, const struct hl_console *,
            uint32_t width, uint32_t height);
bool cf_usable(const struct cf *, enum hl_format, uint8_t use);

/* One operation over a target. */
struct cf_op {
    uint32_t op, two16;
    hl_vec4 a, b, c;
    hl_tex in, stored, target;
    bool linear;                 /* sample `stored` filtered                 */
    bool keep;                   /* what the target holds                    */
    enum hl_blend blend;
    float constant;
    /* Layers, 0: one over the screen. Layer k takes the input from
     * k (step_x, step_y) texels on, round the edges of CF_SIDE. */
    uint32_t layers, step_x, step_y;
    bool stairs, backwards;      /* backwards: k falls from layers - 1       */
    struct hl_rect scissor;      /* width 0: all                             */
};
bool cf_draw(struct cf *, const struct cf_op *);
/* Fill the input texture of `width` x `height` from cf->in. */
bool cf_input(struct cf *, hl_tex *tex, uint32_t width, uint32_t height);
bool cf_write(struct cf *, hl_tex tex, const void *data);
/* Whole texture into cf->raw, or cf->out for RGBA32_FLOAT. */
bool cf_read(struct cf *, hl_tex tex);
void cf_drop(struct cf *, hl_tex *tex);

/* ---- models of formats: cf_model.c --------------------------------------- */

enum cf_round { CF_TRUNCATE, CF_NEAREST_EVEN, CF_NEAREST_UP };
struct cf_float { int bits, min_exp; double max; }; /* significand bits      */
extern const struct cf_float cf_half, cf_float11, cf_float10, cf_7e3;
/* The stored number next to x >= 0. */
double cf_float_store(const struct cf_float *, double x, enum cf_round);
/* To a whole number. */
double cf_whole(double x, enum cf_round);
double cf_half_value(uint16_t code);
uint64_t cf_random(struct cf *);
double cf_unit(struct cf *);             /* 0 <= x < 1                       */
/* Xenos 16_16 fixed (spec/consoles 1.3), in single precision as stated. */
int32_t cf_fixed32_encode(float v);
float cf_fixed32_decode(int32_t code);
/* Depth codes: 24 bits of unorm, rounded to even; 20e4 (1.7). */
uint32_t cf_d24(float z);
uint32_t cf_20e4(float z, bool nearest);
float cf_20e4_value(uint32_t code);
float cf_7e3_value(uint32_t code);

/* ---- storage of two numbers: cf_store.c ---------------------------------- */

enum cf_store_id {
    CF_RG16_UNORM, CF_RG16_SNORM, CF_RG16_FLOAT, CF_RG16_FLOAT_BIASED,
    CF_RGBA8_BYTES, CF_RGBA8_ARGB, CF_RG16_FIXED32, CF_RG8_UNORM,
    CF_UNSCALED, CF_BASE255, CF_STORES
};
struct cf_store {
    enum hl_format format, sample_as;
    uint32_t two16;
    float scale;                 /* written times this, read over it         */
    float pack;                  /* HL_OP_NORMAL_ENCODE's c.y                */
    struct hl_console console;
    bool floats;                 /* rounding of the store counts             */
    double steps;                /* codes a number of 0..1 spans             */
};
/* Storage as the profile asks for it. NULL or why it is not to be had. */
const char *cf_store(struct cf *, enum cf_store_id, struct cf_store *out);
/* What the mutant makes of it: checks of storage only. */
void cf_spoil(const struct cf *, struct cf_store *);
/* The storage that the profile gives two numbers on this machine. */
enum cf_store_id cf_profile_store(const struct cf *);
/* Does the device truncate when it stores a half float? Asked by drawing. */
bool cf_truncates(struct cf *, enum hl_format);
/* Draw op (an encoding one) into the store's texture. */
bool cf_encode(struct cf *, const struct cf_store *, uint32_t op, hl_vec4 a,
               hl_tex in, hl_tex target);
/* Draw op (a decoding one) into an RGBA32_FLOAT target. */
bool cf_decode(struct cf *, const struct cf_store *, uint32_t op, hl_tex in,
               hl_tex stored, hl_tex target);

/* Depth as the table of spec/conformance b2 has it. */
enum cf_depth_id {
    CF_DEPTH_UNORM16, CF_DEPTH_BYTES, CF_DEPTH_ARGB, CF_DEPTH_SIGNED,
    CF_DEPTH_FIXED32, CF_DEPTH_SNORM, CF_DEPTH_UNSCALED, CF_DEPTH_HALF,
    CF_DEPTH_HALF_METRES, CF_DEPTH_UNORM8, CF_DEPTHS
};

/* What most groups draw with, `side` texels square: the input, a texture of
 * the store, and an RGBA32_FLOAT output. Handles are {0} or live before;
 * cf_drop_all also after a failure. */
bool cf_make_all(struct cf *, const struct cf_store *, uint32_t side,
                 hl_tex *in, hl_tex *stored, hl_tex *out);
void cf_drop_all(struct cf *, hl_tex *in, hl_tex *stored, hl_tex *out);

/* ---- groups -------------------------------------------------------------- */

const char *cf_normal(struct cf *, const struct cf_group *);
const char *cf_code(struct cf *, const struct cf_group *);
const char *cf_ids(struct cf *, const struct cf_group *);
const char *cf_ladder(struct cf *, const struct cf_group *);
const char *cf_depth(struct cf *, const struct cf_group *);
const char *cf_dsf(struct cf *, const struct cf_group *);
const char *cf_weights(struct cf *, const struct cf_group *);
const char *cf_blend(struct cf *, const struct cf_group *);
const char *cf_index(struct cf *, const struct cf_group *);
const char *cf_centre(struct cf *, const struct cf_group *);
const char *cf_plan(struct cf *, const struct cf_group *);
const char *cf_xbox(struct cf *, const struct cf_group *);
const char *cf_ps3(struct cf *, const struct cf_group *);
#endif
