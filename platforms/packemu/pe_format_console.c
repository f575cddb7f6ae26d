/* SPDX-License-Identifier: Zlib */
/* Number formats that Xenos alone has. Rounding is the model emulators agree
 * on; the hardware's own is not known. */
#include "platforms/packemu/pe_code.h"

/* 16_16 and 16_16_16_16 fixed: two's complement of range -32..32, rounded
 * away from zero. 1023.96875 = 32767 / 32 is exact. */
void pe_fixed32_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        float v = x[i] == x[i] ? x[i] : 0.0f;
        float t = pe_clamp(v, -32.0f, 32.0f) * 1023.96875f;
        int32_t k = (int32_t)(t + (t < 0.0f ? -0.5f : 0.5f));
        code[i] = (uint32_t)k & 0xffffu;
    }
}

/* -32768, which no encoder makes, is -32 like its neighbour. */
void pe_fixed32_decode(const uint32_t *restrict code, uint32_t n,
                       float *restrict x)
{
    for (uint32_t i = 0; i < n; i++) {
        int32_t k = (int32_t)(code[i] ^ 0x8000u) - 0x8000;
        float v = (float)k * 0.00097659230232f;
        x[i] = v > -32.0f ? v : -32.0f;
    }
}

/* 3 bits of exponent, 7 of mantissa, no sign: 0..31.875. */
void pe_7e3_encode(const float *restrict x, uint32_t n,
                   uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++)
        code[i] = pe_small_encode(pe_clamp(x[i], 0.0f, 31.875f), 7, 3);
}

void pe_7e3_decode(const uint32_t *restrict code, uint32_t n,
                   float *restrict x)
{
    for (uint32_t i = 0; i < n; i++)
        x[i] = pe_small_decode(code[i], 7, 3);
}

/* 20 bits of mantissa, 4 of exponent, no sign: 0..2, truncated. Truncating a
 * float below the least normal number is a conversion to fixed point. */
void pe_20e4_encode(const float *restrict z, uint32_t n,
                    uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        float v = pe_clamp(z[i], 0.0f, pe_float(0x3ffffff8u));
        uint32_t normal = (pe_bits(v) - 0x38000000u) >> 3;
        float low = v < 0x1p-14f ? v : 0.0f;
        uint32_t denormal = (uint32_t)(int32_t)(low * 0x1p34f);
        code[i] = v < 0x1p-14f ? denormal : normal;
    }
}

float pe_20e4_decode(uint32_t code)
{
    return pe_small_decode(code, 20, 15);
}
