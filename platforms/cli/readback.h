/* SPDX-License-Identifier: Zlib */
#ifndef HLC_READBACK_H
#define HLC_READBACK_H
/* Texels of a target on the host. */
#include "hal/hal.h"

struct hlc_texels {
    enum hl_format format;
    uint32_t width, height;
    uint8_t *bytes;              /* as hl_tex_read gives them                */
    uint8_t number;              /* enum hl_number of console fixed point    */
};

/* The texture was made readable and has one sample. On failure *out is
 * zeroed. */
enum hl_result hlc_texels_read(struct hlc_texels *out, struct hl_device *,
                               hl_tex);
void hlc_texels_free(struct hlc_texels *);
/* Texel i, counted in rows from the top, as a shader reads it; what the
 * format lacks is 0, alpha 1. Depth is in out[0]. */
void hlc_texel(float out[4], const struct hlc_texels *, size_t i);
/* The two numbers of 0..1 that a texel keeps as two16 (HL_TWO16_*) says. */
void hlc_two16(float out[2], uint32_t two16, const float texel[4]);
float hlc_half_to_float(uint16_t half);
#endif
