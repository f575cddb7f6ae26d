/* SPDX-License-Identifier: Zlib */
#ifndef HL_CAPS_H
#define HL_CAPS_H
/* What a machine says of itself: pure data, filled by a backend when a device
 * is opened, copied freely, and all that the planner knows about a machine.
 * A planner can be given caps of a machine that is not there. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum hl_result {
    HL_OK = 0,
    HL_ERR_INVALID,      /* an argument breaks a documented rule             */
    HL_ERR_UNSUPPORTED,  /* this machine cannot do it                        */
    HL_ERR_MEMORY,       /* host or device memory exhausted; may pass later  */
    HL_ERR_LIMIT,        /* a capacity stated at creation is too small       */
    HL_ERR_NO_DEVICE,    /* no such backend or device                        */
    HL_ERR_DEVICE_LOST,  /* sticky: close the device                         */
    HL_ERR_VERSION       /* header and library or backend disagree           */
};

enum hl_format {
    HL_FORMAT_NONE = 0,
#define HL_FORMAT(name, ...) HL_FORMAT_##name,
#include "hal/formats.def"
#undef HL_FORMAT
    HL_FORMAT_COUNT
};

enum hl_format_kind {
    HL_KIND_UNORM, HL_KIND_SNORM, HL_KIND_SRGB, HL_KIND_FLOAT, HL_KIND_UINT,
    HL_KIND_DEPTH,
    HL_KIND_FIXED32          /* two's complement, range -32..32 (Xenos)      */
};

struct hl_format_info {
    const char *name;        /* "RG16_UNORM"                                 */
    uint8_t bytes;           /* a texel                                      */
    uint8_t channels;
    enum hl_format_kind kind;
    uint8_t bits[4];         /* r g b a; depth, stencil                      */
};

/* Never NULL; out of range gives the row of HL_FORMAT_NONE (0 bytes). */
const struct hl_format_info *hl_format_info(enum hl_format format);

enum {                       /* hl_format_caps.use                           */
    HL_USE_SAMPLED = 1, HL_USE_LINEAR = 2, HL_USE_TARGET = 4, HL_USE_BLEND = 8
};

struct hl_format_caps {
    uint8_t use;             /* HL_USE_* bits                                */
    uint8_t samples;         /* mask of sample counts as a target: 1|2|4|8   */
};

enum hl_device_kind {
    HL_DEVICE_OTHER, HL_DEVICE_DISCRETE, HL_DEVICE_INTEGRATED, HL_DEVICE_CPU
};

/* Unit costs, nanoseconds, measured on this kind of machine; the planner
 * compares sums of them and nothing else, so only ratios matter. */
struct hl_cost_model {
    float draw_ns;           /* one draw: state, binding, submission         */
    float vertex_ns;         /* a triangle through vertex and setup stages   */
    float pixel_ns;          /* shading floor of a covered pixel             */
    float fetch_ns;          /* one texel fetch of 4 to 8 bytes              */
    float blend_ns;          /* blending 8 bytes a pixel                     */
    float light_ns;          /* one light a pixel, data at a uniform address */
    float light_flat_ns;     /* the same, data in flat varyings              */
    float light_gather_ns;   /* one light a pixel, address differs by pixel  */
    float readback_ns;       /* reading one 4-byte texel back to the host    */
    float sync_ns;           /* submit and wait                              */
    /* Share of what a stage's condition leaves out that is paid all the same:
     * 1 where vectors run both sides under a mask, 0 where they branch. */
    float untaken;
    /* Of one format: blending a texel of it, fetching one. 0: blend_ns for
     * every 8 bytes; fetch_ns, and as much again for every 8 bytes past 8. */
    float format_blend_ns[HL_FORMAT_COUNT];
    float format_fetch_ns[HL_FORMAT_COUNT];
};

/* How far inferred pictures are off, as RMS of 8-bit sRGB codes (0..255), by
 * what `halflight calibrate` measured. A planner puts together full, what the
 * size of the L-buffer adds, and what its format adds, as independent errors
 * are: by the root of the sum of squares. Zeros: values of core's own. */
struct hl_error_model {
    /* Of an L-buffer of k / 8 of the frame a side: its error as a share of
     * that of one half; [4] is 1, [8] is 0. */
    float eighths[9];
    float full, half, eight; /* as hl_probe's, for scenes without a probe    */
    float margin;            /* factor on the whole; 0 = 1                   */
};

enum { HL_CAPS_NAME = 96 };

#include "hal/profile.h"

struct hl_caps {
    char backend[16];        /* "vulkan"                                     */
    char device[HL_CAPS_NAME];
    char driver[HL_CAPS_NAME];
    enum hl_device_kind kind;
    uint32_t max_tex_dim;    /* texels a side                                */
    uint32_t max_colors;     /* colour targets of a pass                     */
    uint32_t max_uniform_bytes;  /* one bound range                          */
    uint32_t max_storage_bytes;  /* one bound range; 0 = no storage buffers  */
    uint32_t uniform_align, storage_align; /* of a range's offset, bytes     */
    uint32_t samples;        /* mask: counts usable for colour and depth     */
    bool timestamps;
    bool clip_zero_to_one;   /* clip space z is 0..w, not -w..w              */
    struct hl_format_caps format[HL_FORMAT_COUNT];
    struct hl_cost_model cost;
    struct hl_error_model error;
    struct hl_profile profile;   /* rules to plan by                         */
    bool console_memory;     /* keeps memory as the profile's machine does;
                              * else packed formats stand in for it          */
};
#endif
