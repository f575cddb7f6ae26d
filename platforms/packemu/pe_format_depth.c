/* SPDX-License-Identifier: Zlib */
/* Depth as codes that order as depths do. */
#include "platforms/packemu/pe.h"
#include "platforms/packemu/pe_code.h"

/* Nearest even of a product rounded to float, as emulators of Xenos do it.
 * Not floor(x + 0.5): in floats that carries 16777215 on to 2^24. */
static void unorm_codes(const float *restrict z, uint32_t n, float max,
                        uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        float t = pe_clamp(z[i], 0.0f, 1.0f) * max;
        int32_t k = (int32_t)t;
        float rest = t - (float)k;
        int32_t up = (rest > 0.5f) | ((rest == 0.5f) & (k & 1));
        code[i] = (uint32_t)(k + up);
    }
}

static void float_codes(const float *restrict z, uint32_t n,
                        uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++)
        code[i] = pe_bits(pe_clamp(z[i], 0.0f, 1.0f));
}

void pe_depth_encode(enum hl_format format, const float *depth, uint32_t n,
                     uint32_t *codes)
{
    switch (format) {
    case HL_FORMAT_D16_UNORM: unorm_codes(depth, n, 65535.0f, codes); break;
    case HL_FORMAT_D24_UNORM_S8:
        unorm_codes(depth, n, 16777215.0f, codes);
        break;
    case HL_FORMAT_D24_FLOAT_S8: pe_20e4_encode(depth, n, codes); break;
    default: float_codes(depth, n, codes); break;
    }
}

float pe_depth_decode(enum hl_format format, uint32_t code)
{
    switch (format) {
    case HL_FORMAT_D16_UNORM: return (float)(int32_t)code / 65535.0f;
    case HL_FORMAT_D24_UNORM_S8: return (float)(int32_t)code / 16777215.0f;
    case HL_FORMAT_D24_FLOAT_S8: return pe_20e4_decode(code);
    default: return pe_float(code);
    }
}

/* Stencil is the low byte of 24-bit words, or a word of its own. */
void pe_depth_plane(enum hl_format format, const uint32_t *restrict words,
                    uint32_t n, float *restrict depth)
{
    switch (format) {
    case HL_FORMAT_D16_UNORM:
        for (uint32_t i = 0; i < n; i++)
            depth[i] = (float)(int32_t)words[i] / 65535.0f;
        break;
    case HL_FORMAT_D24_UNORM_S8:
        for (uint32_t i = 0; i < n; i++)
            depth[i] = (float)(int32_t)(words[i] >> 8) / 16777215.0f;
        break;
    case HL_FORMAT_D24_FLOAT_S8:
        for (uint32_t i = 0; i < n; i++)
            depth[i] = pe_small_decode(words[i] >> 8, 20, 15);
        break;
    case HL_FORMAT_D32_FLOAT_S8:
        for (uint32_t i = 0; i < n; i++)
            depth[i] = pe_float(words[2 * i]);
        break;
    default:
        for (uint32_t i = 0; i < n; i++)
            depth[i] = pe_float(words[i]);
        break;
    }
}
