/* SPDX-License-Identifier: Zlib */
#ifndef PE_CODE_H
#define PE_CODE_H
/* Codes: what one channel of a format holds. Every conversion is of + - * /
 * and integer operations without branches, so that loops of them vectorise
 * and all machines agree to the bit. */
#include "hal/caps.h"
#include "platforms/packemu/pe_math.h"

enum pe_code {
    PE_CODE_BITS, PE_CODE_UNORM, PE_CODE_SNORM, PE_CODE_SRGB, PE_CODE_F32,
    PE_CODE_F16, PE_CODE_F11, PE_CODE_F10, PE_CODE_FIXED32, PE_CODE_7E3
};

/* Where a channel lies in a texel's words, and how it is coded. */
struct pe_channel { uint8_t code, bits, word, shift; };
struct pe_channel pe_channel(enum hl_format, uint32_t c);

void pe_code_encode(enum pe_code, uint32_t bits, const float *restrict x,
                    uint32_t n, uint32_t *restrict code);
void pe_code_decode(enum pe_code, uint32_t bits, const uint32_t *restrict code,
                    uint32_t n, float *restrict x);
/* Depth of texels in work, any depth format. */
void pe_depth_plane(enum hl_format, const uint32_t *restrict words, uint32_t n,
                    float *restrict depth);

/* pe_format_console.c: Xenos. */
void pe_fixed32_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code);
void pe_fixed32_decode(const uint32_t *restrict code, uint32_t n,
                       float *restrict x);
void pe_7e3_encode(const float *restrict x, uint32_t n,
                   uint32_t *restrict code);
void pe_7e3_decode(const uint32_t *restrict code, uint32_t n,
                   float *restrict x);
void pe_20e4_encode(const float *restrict z, uint32_t n,
                    uint32_t *restrict code);
float pe_20e4_decode(uint32_t code);

/* pe_srgb.c */
extern const float pe_srgb_linear[256];
extern const float pe_srgb_step[255];

/* Clamp with NaN to the lower end, so to 0 where that is 0. */
static inline float pe_clamp(float x, float low, float high)
{
    x = x > low ? x : low;
    return x < high ? x : high;
}

/* An unsigned float of `mantissa` bits and the exponent bias `bias`, nearest
 * even, from x >= 0 that is at most its largest. Denormal codes come from an
 * addition: the last bit of a float beside 2^(24 - bias - mantissa) is the
 * unit of denormals, so that the sum is rounded to it. */
static inline uint32_t pe_small_encode(float x, int mantissa, uint32_t bias)
{
    int shift = 23 - mantissa;
    uint32_t u = pe_bits(x), rebias = (127 - bias) << 23;
    uint32_t magic = (151 - bias - (uint32_t)mantissa) << 23;
    uint32_t half = (1u << (shift - 1)) - 1;
    uint32_t normal = (u - rebias + half + (u >> shift & 1)) >> shift;
    uint32_t denormal = pe_bits(x + pe_float(magic)) - magic;
    return x < pe_float((128 - bias) << 23) ? denormal : normal;
}

static inline float pe_small_decode(uint32_t code, int mantissa, uint32_t bias)
{
    uint32_t scale = (128 - bias - (uint32_t)mantissa) << 23;
    float denormal = (float)(int32_t)code * pe_float(scale);
    float normal = pe_float((code << (23 - mantissa)) + ((127 - bias) << 23));
    return code >> mantissa == 0 ? denormal : normal;
}

/* The same with infinities and NaNs, as IEEE half floats have. */
static inline float pe_small_decode_ieee(uint32_t code, int mantissa)
{
    uint32_t top = code >> mantissa == 31 ? 0x7f800000u : 0;
    return pe_float(pe_bits(pe_small_decode(code, mantissa, 15)) | top);
}
#endif
