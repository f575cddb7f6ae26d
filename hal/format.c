/* SPDX-License-Identifier: Zlib */
/* Lookups over formats.def. */
#include "hal/caps.h"

static const struct hl_format_info info[HL_FORMAT_COUNT] = {
    [HL_FORMAT_NONE] = { "NONE", 0, 0, HL_KIND_UNORM, { 0, 0, 0, 0 } },
#define HL_FORMAT(name, bytes, channels, kind, r, g, b, a, ...) \
    [HL_FORMAT_##name] = { #name, bytes, channels, HL_KIND_##kind, \
                           { r, g, b, a } },
#include "hal/formats.def"
#undef HL_FORMAT
};

const struct hl_format_info *hl_format_info(enum hl_format format)
{
    unsigned i = (unsigned)format;
    return &info[i < HL_FORMAT_COUNT ? i : 0];
}
