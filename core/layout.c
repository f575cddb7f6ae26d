/* SPDX-License-Identifier: Zlib */
/* Formats: which are usable, and the worst error that each encoding adds. */
#include "core/exact.h"
#include "core/pipe.h"
#include "core/vec.h"

/* A console's own rule; stand-ins are judged by what their machine can do. */
static bool blend_forbidden(const struct hl_caps *caps, enum hl_format format)
{
    const enum hl_format *f = caps->profile.no_blend;
    for (int i = 0; caps->console_memory && i < HL_PROFILE_NO_BLEND && f[i];
         i++)
        if (f[i] == format)
            return true;
    return false;
}

bool hl_format_usable(const struct hl_caps *caps, enum hl_format format,
                      int use, uint32_t samples)
{
    const struct hl_format_caps *f = &caps->format[format];
    return (f->use & use) == use && (f->samples & samples) == samples &&
           !((use & HL_USE_BLEND) && blend_forbidden(caps, format));
}

enum hl_format hl_format_pick(const struct hl_caps *caps,
                              const enum hl_format *list, int use,
                              uint32_t samples)
{
    for (; *list != HL_FORMAT_NONE; list++)
        if (hl_format_usable(caps, *list, use, samples))
            return *list;
    return HL_FORMAT_NONE;
}

/* Half a step of the stored -1..1 component. FLOAT: 0..1 is stored, as in all
 * unsigned formats: below 1 a step is 2^-bits of the significand, truncating,
 * the worse of the two roundings, and twice that of -1..1. */
static float component_error(enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    float steps = (float)(((uint64_t)1 << f->bits[0]) - 1u);
    if (f->kind == HL_KIND_FLOAT)
        return f->bits[0] == 32 ? 1.2e-7f : 1.0f / 1024;
    /* Signed codes have 65,534 steps from -1 to 1, -32 to 32 as well. */
    if (f->kind == HL_KIND_SNORM || f->kind == HL_KIND_FIXED32)
        return 1.0f / (steps - 1.0f);
    return 1.0f / steps;
}

float hl_fixed_step(enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    if (f->bits[0] == 0)
        return 1.0f;
    uint32_t half = (1u << (f->bits[0] - 1)) - 1u;
    if (f->kind == HL_KIND_FIXED32)
        return 32.0f / (float)half;
    return 1.0f / (float)(f->kind == HL_KIND_SNORM ? half : 2u * half + 1u);
}

/* spec: e = 2 d / cos(theta / 2) with d = sqrt 2 h, theta = 90 degrees: the
 * closed bound max(2 [asin(r + d) - asin r], 2 [asin r - asin(r - d)]) at
 * r = sin 45. UNORM16: 0.0035 degrees. */
float hl_normal_error(enum hl_format format)
{
    double d = 1.41421356 * (double)component_error(format);
    double r = 0.70710678;
    double up = 2.0 * (hl_exact_asin(r + d < 1.0 ? r + d : 1.0) -
                     hl_exact_asin(r));
    return (float)(up * 57.29577951);
}

/* Steps of fixed point that a blend may be off. llvmpipe cuts channels of ten
 * bits off. */
static float rounding(enum hl_format format)
{
    return hl_format_info(format)->bits[0] == 10 ? 1.0f : 0.5f;
}

/* Fixed point: a rounding a blend, against a value of 1/8 of the range. */
float hl_range_error(enum hl_format format, float range, uint32_t terms)
{
    float n = terms ? (float)terms : 1.0f;
    return n * rounding(format) * hl_fixed_step(format) / range * 8.0f;
}

/* FLOAT: |error| <= u * sum of partial sums, and for equal terms the partial
 * sums average half the total, so u (terms + 1) / 2 (conformance b3), with
 * u = 2^-10 for 11 bits of significand under either rounding; 8 bits in 7e3,
 * which holds from 1/4 on, and 6 in the least of 11-bit floats. */
float hl_accumulation_error(enum hl_format format, uint32_t terms)
{
    const struct hl_format_info *f = hl_format_info(format);
    float n = terms ? (float)terms : 1.0f;
    if (f->kind == HL_KIND_FLOAT) {
        float u = f->bits[0] == 32 ? 1.2e-7f
                  : f->bits[0] == 16 ? 1.0f / 1024
                  : f->bits[0] == 10 ? 1.0f / 128 : 1.0f / 32;
        return u * (n + 1.0f) * 0.5f;
    }
    return hl_range_error(format, f->kind == HL_KIND_FIXED32 ? 32.0f : 1.0f,
                          terms);
}

/* sRGB is linear in the dark: 12.92 times the light. */
float hl_dark_codes(enum hl_format format, float peak)
{
    enum hl_format_kind kind = hl_format_info(format)->kind;
    bool fixed = kind == HL_KIND_UNORM || kind == HL_KIND_SNORM;
    return fixed ? rounding(format) * hl_fixed_step(format) * peak * 12.92f *
                   255.0f : 0;
}

/* ---- costs -------------------------------------------------------------- */

double hl_blend_ns(const struct hl_caps *caps, enum hl_format format)
{
    uint32_t bytes = hl_format_info(format)->bytes;
    if (bytes == 0)
        return 0;
    float own = caps->cost.format_blend_ns[format];
    return own > 0 ? (double)own : (double)caps->cost.blend_ns * bytes / 8;
}

double hl_fetch_ns(const struct hl_caps *caps, enum hl_format format)
{
    uint32_t bytes = hl_format_info(format)->bytes;
    if (bytes == 0)
        return 0;
    float own = caps->cost.format_fetch_ns[format];
    return own > 0 ? (double)own
                   : (double)caps->cost.fetch_ns * ((bytes + 7) / 8);
}
