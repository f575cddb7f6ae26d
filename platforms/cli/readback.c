/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/readback.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    else
        for (int k = 0; k < f->channels; k++)
            out[k] = f->bits[k] == 8 ? channel8(k < 3 ? f->kind
                                                      : HL_KIND_UNORM, p[k])
                     : f->bits[k] == 16 ? channel16(f->kind, p + 2 * k)
                                        : channel32(f->kind, p + 4 * k);
}
