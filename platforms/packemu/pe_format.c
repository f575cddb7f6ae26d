/* SPDX-License-Identifier: Zlib */
/* Texels to and from planes of floats: words to codes, codes to numbers. */
#include <string.h>
#include "platforms/packemu/pe.h"
#include "platforms/packemu/pe_code.h"

enum { CHUNK = 256 };

/* ---- layout ------------------------------------------------------------- */

uint32_t pe_words(enum hl_format format)
{
    uint32_t bytes = hl_format_info(format)->bytes;
    return bytes > 4 ? bytes / 4 : 1;
}

static enum pe_code float_code(enum hl_format format, uint32_t bits)
{
    if (format == HL_FORMAT_RGB10A2_FLOAT)
        return bits == 10 ? PE_CODE_7E3 : PE_CODE_UNORM;
    return bits == 32 ? PE_CODE_F32 : bits == 16 ? PE_CODE_F16
           : bits == 11 ? PE_CODE_F11 : PE_CODE_F10;
}

struct pe_channel pe_channel(enum hl_format format, uint32_t c)
{
    const struct hl_format_info *f = hl_format_info(format);
    uint32_t at = 0;
    for (uint32_t i = 0; i < c; i++)
        at += f->bits[i];
    enum pe_code code = PE_CODE_BITS;
    switch (f->kind) {
    case HL_KIND_UNORM: code = PE_CODE_UNORM; break;
    case HL_KIND_SNORM: code = PE_CODE_SNORM; break;
    case HL_KIND_SRGB: code = c < 3 ? PE_CODE_SRGB : PE_CODE_UNORM; break;
    case HL_KIND_FLOAT: code = float_code(format, f->bits[c]); break;
    case HL_KIND_FIXED32: code = PE_CODE_FIXED32; break;
    case HL_KIND_UINT:
    case HL_KIND_DEPTH: break;
    }
    return (struct pe_channel){ (uint8_t)code, f->bits[c], (uint8_t)(at / 32),
                                (uint8_t)(at % 32) };
}

/* ---- numbers to codes ---------------------------------------------------- */

PE_WIDE
static void unorm_encode(const float *restrict x, uint32_t n, float max,
                         uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        float t = pe_clamp(x[i], 0.0f, 1.0f) * max + 0.5f;
        code[i] = (uint32_t)(int32_t)t;
    }
}

PE_WIDE
static void snorm_encode(const float *restrict x, uint32_t n, uint32_t mask,
                         uint32_t *restrict code)
{
    float max = (float)(int32_t)(mask >> 1);
    for (uint32_t i = 0; i < n; i++) {
        float v = x[i] == x[i] ? x[i] : 0.0f;
        float t = pe_clamp(v, -1.0f, 1.0f) * max;
        int32_t k = (int32_t)(t + (t < 0.0f ? -0.5f : 0.5f));
        code[i] = (uint32_t)k & mask;
    }
}

PE_WIDE
static void srgb_encode(const float *restrict x, uint32_t n,
                        uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = 0;
        for (uint32_t step = 128; step > 0; step /= 2)
            k += x[i] >= pe_srgb_step[k + step - 1] ? step : 0;
        code[i] = k;
    }
}

/* The largest finite number stands for all above it, infinity too. */
PE_WIDE
static void f16_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t sign = pe_bits(x[i]) >> 16 & 0x8000u;
        float a = pe_float(pe_bits(x[i]) & 0x7fffffffu);
        uint32_t k = pe_small_encode(pe_clamp(a, 0.0f, 65504.0f), 10, 15);
        code[i] = x[i] == x[i] ? k | sign : 0;
    }
}

PE_WIDE
static void f11_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++)
        code[i] = pe_small_encode(pe_clamp(x[i], 0.0f, 65024.0f), 6, 15);
}

PE_WIDE
static void f10_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++)
        code[i] = pe_small_encode(pe_clamp(x[i], 0.0f, 64512.0f), 5, 15);
}

/* Which NaN an operation gives differs between machines: none is kept. */
PE_WIDE
static void f32_encode(const float *restrict x, uint32_t n,
                       uint32_t *restrict code)
{
    for (uint32_t i = 0; i < n; i++)
        code[i] = x[i] == x[i] ? pe_bits(x[i]) : 0;
}

void pe_code_encode(enum pe_code code, uint32_t bits, const float *restrict x,
                    uint32_t n, uint32_t *restrict out)
{
    uint32_t mask = 0xffffffffu >> (32 - bits);
    switch (code) {
    case PE_CODE_BITS: memcpy(out, x, n * sizeof *out); break;
    case PE_CODE_UNORM: unorm_encode(x, n, (float)mask, out); break;
    case PE_CODE_SNORM: snorm_encode(x, n, mask, out); break;
    case PE_CODE_SRGB: srgb_encode(x, n, out); break;
    case PE_CODE_F32: f32_encode(x, n, out); break;
    case PE_CODE_F16: f16_encode(x, n, out); break;
    case PE_CODE_F11: f11_encode(x, n, out); break;
    case PE_CODE_F10: f10_encode(x, n, out); break;
    case PE_CODE_FIXED32: pe_fixed32_encode(x, n, out); break;
    case PE_CODE_7E3: pe_7e3_encode(x, n, out); break;
    }
}

/* ---- codes to numbers ---------------------------------------------------- */

/* A division is correctly rounded; a product with 1 / max is not. */
PE_WIDE
static void unorm_decode(const uint32_t *restrict code, uint32_t n, float max,
                         float *restrict x)
{
    for (uint32_t i = 0; i < n; i++)
        x[i] = (float)(int32_t)code[i] / max;
}

PE_WIDE
static void snorm_decode(const uint32_t *restrict code, uint32_t n,
                         uint32_t mask, float *restrict x)
{
    uint32_t sign = (mask >> 1) + 1;
    float max = (float)(int32_t)(mask >> 1);
    for (uint32_t i = 0; i < n; i++) {
        int32_t k = (int32_t)(code[i] ^ sign) - (int32_t)sign;
        float v = (float)k / max;
        x[i] = v > -1.0f ? v : -1.0f;
    }
}

PE_WIDE
static void f16_decode(const uint32_t *restrict code, uint32_t n,
                       float *restrict x)
{
    for (uint32_t i = 0; i < n; i++) {
        float a = pe_small_decode_ieee(code[i] & 0x7fffu, 10);
        x[i] = pe_float(pe_bits(a) | (code[i] & 0x8000u) << 16);
    }
}

PE_WIDE
static void small_decode(const uint32_t *restrict code, uint32_t n,
                         int mantissa, float *restrict x)
{
    for (uint32_t i = 0; i < n; i++)
        x[i] = pe_small_decode_ieee(code[i], mantissa);
}

PE_WIDE
static void srgb_decode(const uint32_t *restrict code, uint32_t n,
                        float *restrict x)
{
    for (uint32_t i = 0; i < n; i++)
        x[i] = pe_srgb_linear[code[i] & 255];
}

void pe_code_decode(enum pe_code code, uint32_t bits,
                    const uint32_t *restrict in, uint32_t n, float *restrict x)
{
    uint32_t mask = 0xffffffffu >> (32 - bits);
    switch (code) {
    case PE_CODE_BITS:
    case PE_CODE_F32: memcpy(x, in, n * sizeof *x); break;
    case PE_CODE_UNORM: unorm_decode(in, n, (float)mask, x); break;
    case PE_CODE_SNORM: snorm_decode(in, n, mask, x); break;
    case PE_CODE_SRGB: srgb_decode(in, n, x); break;
    case PE_CODE_F16: f16_decode(in, n, x); break;
    case PE_CODE_F11: small_decode(in, n, 6, x); break;
    case PE_CODE_F10: small_decode(in, n, 5, x); break;
    case PE_CODE_FIXED32: pe_fixed32_decode(in, n, x); break;
    case PE_CODE_7E3: pe_7e3_decode(in, n, x); break;
    }
}

/* ---- codes in words ------------------------------------------------------ */

/* code[c] holds zeros for channels that the format lacks. */
static void pack_one(const uint32_t code[4][CHUNK], const uint8_t shift[4],
                     uint32_t n, uint32_t *restrict words)
{
    for (uint32_t i = 0; i < n; i++)
        words[i] = code[0][i] | code[1][i] << shift[1] |
                   code[2][i] << shift[2] | code[3][i] << shift[3];
}

static void pack(enum hl_format format, const uint32_t code[4][CHUNK],
                 const uint8_t shift[4], uint32_t n, uint32_t *restrict words)
{
    const struct hl_format_info *f = hl_format_info(format);
    if (f->bytes <= 4)
        pack_one(code, shift, n, words);
    else if (f->bytes == 16)
        for (uint32_t i = 0; i < n; i++) {
            words[4 * i] = code[0][i];
            words[4 * i + 1] = code[1][i];
            words[4 * i + 2] = code[2][i];
            words[4 * i + 3] = code[3][i];
        }
    else if (f->channels == 4)
        for (uint32_t i = 0; i < n; i++) {
            words[2 * i] = code[0][i] | code[1][i] << 16;
            words[2 * i + 1] = code[2][i] | code[3][i] << 16;
        }
    else
        for (uint32_t i = 0; i < n; i++) {
            words[2 * i] = code[0][i];
            words[2 * i + 1] = code[1][i];
        }
}

void pe_encode(enum hl_format format, const float *const rgba[4], uint32_t n,
               uint32_t *words)
{
    const struct hl_format_info *f = hl_format_info(format);
    uint32_t code[4][CHUNK], stride = pe_words(format);
    uint8_t shift[4] = { 0 };
    if (f->channels < 4)
        memset(code[f->channels], 0,
               (4u - f->channels) * sizeof code[0]);
    for (uint32_t at = 0; at < n; at += CHUNK) {
        uint32_t m = n - at < CHUNK ? n - at : CHUNK;
        for (uint32_t c = 0; c < f->channels; c++) {
            struct pe_channel h = pe_channel(format, c);
            shift[c] = h.shift;
            pe_code_encode((enum pe_code)h.code, h.bits, rgba[c] + at, m,
                           code[c]);
        }
        pack(format, (const uint32_t (*)[CHUNK])code, shift, m,
             words + (size_t)at * stride);
    }
}

static void unpack(const uint32_t *restrict words, uint32_t stride,
                   struct pe_channel h, uint32_t n, uint32_t *restrict code)
{
    uint32_t mask = 0xffffffffu >> (32 - h.bits), shift = h.shift;
    words += h.word;
    if (stride == 1)
        for (uint32_t i = 0; i < n; i++)
            code[i] = words[i] >> shift & mask;
    else if (stride == 2)
        for (uint32_t i = 0; i < n; i++)
            code[i] = words[2 * i] >> shift & mask;
    else
        for (uint32_t i = 0; i < n; i++)
            code[i] = words[stride * i] >> shift & mask;
}

static void fill(float *x, uint32_t n, float value)
{
    for (uint32_t i = 0; i < n; i++)
        x[i] = value;
}

/* Depth in red, green and blue. */
static void depth_rgb(enum hl_format format, const uint32_t *words,
                      uint32_t n, float *const rgba[4])
{
    const float *made = NULL;
    for (int c = 0; c < 3; c++) {
        if (!rgba[c])
            continue;
        if (made)
            memcpy(rgba[c], made, n * sizeof *made);
        else
            pe_depth_plane(format, words, n, rgba[c]);
        made = rgba[c];
    }
    if (rgba[3])
        fill(rgba[3], n, 1.0f);
}

void pe_decode(enum hl_format format, const uint32_t *words, uint32_t n,
               float *const rgba[4])
{
    const struct hl_format_info *f = hl_format_info(format);
    uint32_t code[CHUNK], stride = pe_words(format);
    if (f->kind == HL_KIND_DEPTH) {
        depth_rgb(format, words, n, rgba);
        return;
    }
    float one = f->kind == HL_KIND_UINT ? pe_float(1) : 1.0f;
    for (uint32_t c = 0; c < 4; c++) {
        if (rgba[c] && c >= f->channels)
            fill(rgba[c], n, c == 3 ? one : 0.0f);
        if (!rgba[c] || c >= f->channels)
            continue;
        struct pe_channel h = pe_channel(format, c);
        for (uint32_t at = 0; at < n; at += CHUNK) {
            uint32_t m = n - at < CHUNK ? n - at : CHUNK;
            unpack(words + (size_t)at * stride, stride, h, m, code);
            pe_code_decode((enum pe_code)h.code, h.bits, code, m,
                           rgba[c] + at);
        }
    }
}
