/* SPDX-License-Identifier: Zlib */
/* Formats: which are usable, and the worst error that each encoding adds. */
#include "core/pipe.h"
#include "core/vec.h"

bool hl_format_usable(const struct hl_caps *caps, enum hl_format format,
                      int use, uint32_t samples)
{
    const struct hl_format_caps *f = &caps->format[format];
    return (f->use & use) == use && (f->samples & samples) == samples;
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

/* Half a step of the stored -1..1 component. FLOAT: truncating, 2^-bits of
 * the significand, the worse of the two roundings. */
static float component_error(enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    float steps = (float)((1u << f->bits[0]) - 1u);
    if (f->kind == HL_KIND_FLOAT)
        return f->bits[0] == 32 ? 6e-8f : 1.0f / 2048;
    if (f->kind == HL_KIND_SNORM)
        return 1.0f / (steps - 1.0f);
    return 1.0f / steps;
}

/* spec: e = 2 d / cos(theta / 2) with d = sqrt 2 h, theta = 90 degrees: the
 * closed bound max(2 [asin(r + d) - asin r], 2 [asin r - asin(r - d)]) at
 * r = sin 45. UNORM16: 0.0035 degrees. */
float hl_normal_error(enum hl_format format)
{
    double d = 1.41421356 * (double)component_error(format);
    double r = 0.70710678;
    double up = 2.0 * (asin(r + d < 1.0 ? r + d : 1.0) - asin(r));
    return (float)(up * 57.29577951);
}

/* FLOAT: |error| <= u * sum of partial sums, and for equal terms the partial
 * sums average half the total, so u (terms + 1) / 2 (conformance b3), with
 * u = 2^-10 for 11 bits of significand under either rounding. UNORM: half a
 * step a blend, against a value of 1/8 of the scale. */
float hl_accumulation_error(enum hl_format format, uint32_t terms)
{
    const struct hl_format_info *f = hl_format_info(format);
    float n = terms ? (float)terms : 1.0f;
    if (f->kind == HL_KIND_FLOAT) {
        float u = f->bits[0] == 32 ? 1.2e-7f
                  : f->bits[0] == 16 ? 1.0f / 1024 : 1.0f / 32;
        return u * (n + 1.0f) * 0.5f;
    }
    return n * 0.5f / (float)((1u << f->bits[0]) - 1u) * 8.0f;
}
