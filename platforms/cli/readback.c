/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/readback.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "shaders/shared/pack.h"

enum hl_result hlc_texels_read(struct hlc_texels *out, struct hl_device *d,
                               hl_tex tex)
{
    struct hl_tex_desc desc;
    memset(out, 0, sizeof *out);
    if (!hl_tex_info(d, tex, &desc))
        return HL_ERR_INVALID;
    const struct hl_format_info *f = hl_format_info(desc.format);
    size_t texel = f->kind == HL_KIND_DEPTH ? sizeof(float) : f->bytes;
    size_t bytes = texel * desc.width * desc.height;
    out->bytes = malloc(bytes);
    if (!out->bytes)
        return HL_ERR_MEMORY;
    enum hl_result r = hl_tex_read(d, tex, out->bytes, bytes);
    if (r != HL_OK) {
        hlc_texels_free(out);
        return r;
    }
    out->format = desc.format;
    out->number = desc.console.resolve_number;
    out->width = desc.width;
    out->height = desc.height;
    return HL_OK;
}

void hlc_texels_free(struct hlc_texels *t)
{
    free(t->bytes);
    memset(t, 0, sizeof *t);
}

float hlc_half_to_float(uint16_t half)
{
    unsigned e = half >> 10 & 31, m = half & 1023u;
    double v = e ? ldexp(1.0 + m / 1024.0, (int)e - 15) : ldexp(m, -24);
    if (e == 31)
        v = m ? (double)NAN : (double)INFINITY;
    return (float)(half & 0x8000u ? -v : v);
}

/* Unsigned small floats of 5 exponent bits and 6 or 5 of mantissa: a half
 * without its sign and last bits. */
static void unpack_11_11_10(float out[4], const uint8_t *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof v);
    out[0] = hlc_half_to_float((uint16_t)((v & 2047u) << 4));
    out[1] = hlc_half_to_float((uint16_t)((v >> 11 & 2047u) << 4));
    out[2] = hlc_half_to_float((uint16_t)((v >> 22) << 5));
}

static void unpack_10_10_10_2(float out[4], const uint8_t *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof v);
    for (int k = 0; k < 3; k++)
        out[k] = (float)(v >> 10 * k & 1023u) / 1023.0f;
    out[3] = (float)(v >> 30) / 3.0f;
}

/* 7e3: 3 bits of exponent, 7 of mantissa (spec/consoles 1.2). */
static void unpack_7e3(float out[4], const uint8_t *p)
{
    uint32_t v;
    memcpy(&v, p, sizeof v);
    for (int k = 0; k < 3; k++) {
        int e = v >> (10 * k + 7) & 7, m = v >> 10 * k & 127;
        out[k] = (float)(e ? ldexp(128 + m, e - 10) : ldexp(m, -9));
    }
    out[3] = (float)(v >> 30) / 3.0f;
}

static float channel8(enum hl_format_kind kind, uint8_t c)
{
    double s = c / 255.0;
    if (kind != HL_KIND_SRGB)
        return (float)s;
    return (float)(s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4));
}

static float channel16(enum hl_format_kind kind, const uint8_t *p)
{
    uint16_t u;
    memcpy(&u, p, sizeof u);
    if (kind == HL_KIND_FLOAT)
        return hlc_half_to_float(u);
    if (kind == HL_KIND_UNORM)
        return (float)u / 65535.0f;
    int s = u < 32768 ? u : u - 65536;
    return s < -32767 ? -1.0f : (float)s / 32767.0f;
}

/* Fixed point is in memory what its resolve made of it. */
static enum hl_format_kind kind16(const struct hlc_texels *t)
{
    enum hl_format_kind kind = hl_format_info(t->format)->kind;
    return kind != HL_KIND_FIXED32 ? kind
           : t->number == HL_NUMBER_SIGNED ? HL_KIND_SNORM : HL_KIND_UNORM;
}

static float channel32(enum hl_format_kind kind, const uint8_t *p)
{
    float f;
    uint32_t u;
    memcpy(&f, p, sizeof f);
    memcpy(&u, p, sizeof u);
    return kind == HL_KIND_UINT ? (float)u : f;
}

void hlc_texel(float out[4], const struct hlc_texels *t, size_t i)
{
    const struct hl_format_info *f = hl_format_info(t->format);
    bool depth = f->kind == HL_KIND_DEPTH;
    const uint8_t *p = t->bytes + i * (depth ? sizeof(float) : f->bytes);
    out[0] = out[1] = out[2] = 0;
    out[3] = 1;
    if (depth)
        memcpy(out, p, sizeof *out);
    else if (t->format == HL_FORMAT_RG11B10_FLOAT)
        unpack_11_11_10(out, p);
    else if (t->format == HL_FORMAT_RGB10A2_UNORM)
        unpack_10_10_10_2(out, p);
    else if (t->format == HL_FORMAT_RGB10A2_FLOAT)
        unpack_7e3(out, p);
    else
        for (int k = 0; k < f->channels; k++)
            out[k] = f->bits[k] == 8 ? channel8(k < 3 ? f->kind
                                                      : HL_KIND_UNORM, p[k])
                     : f->bits[k] == 16 ? channel16(kind16(t), p + 2 * k)
                                        : channel32(f->kind, p + 4 * k);
}

static float join(float lo, float hi)
{
    hl_vec2 b = hl_v2(floorf(hi * 255.0f + 0.5f), floorf(lo * 255.0f + 0.5f));
    return hl_join16(b) / 65535.0f;
}

void hlc_two16(float out[2], uint32_t two16, const float t[4])
{
    hl_vec2 v = hl_two16_decode(two16, hl_v2(t[0], t[1]));
    if (two16 == HL_TWO16_BYTES)
        v = hl_v2(join(t[0], t[1]), join(t[2], t[3]));
    if (two16 == HL_TWO16_BYTES_ARGB)
        v = hl_v2(join(t[2], t[1]), join(t[0], t[3]));
    out[0] = v.x;
    out[1] = v.y;
}
