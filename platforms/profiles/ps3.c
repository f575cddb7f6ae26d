/* SPDX-License-Identifier: Zlib */
/* PlayStation 3 (RSX). Sources: K = Kircher, Lawrance 2009, section 5.2;
 * C = spec/consoles.md, section 2. */
#include "shaders/shared/block.h"
#include "platforms/profiles/hl_profiles.h"

/* Remap words (C 2.4, 2.5): the default gives Y16_X16 as .r = Y, .g = X. */
#define REMAP_XY 0xAA4E
#define REMAP_BARG 0xAA93

const struct hl_profile hl_profile_ps3 = {
    .name = "ps3",
    /* No target of two 16-bit channels: A8R8G8B8 written as bytes, read as
     * Y16_X16 (K 5.2, C 2.4). Stand-ins have the bytes in the order of a
     * little-endian view. */
    .two16 = {
        { .format = HL_FORMAT_RGBA8_UNORM, .sample_as = HL_FORMAT_RG16_UNORM,
          .on = HL_ON_CONSOLE, .two16 = HL_TWO16_BYTES_ARGB,
          .console = { .remap = REMAP_XY } },
        { .format = HL_FORMAT_RGBA8_UNORM, .sample_as = HL_FORMAT_RG16_UNORM,
          .on = HL_ON_STAND_IN, .two16 = HL_TWO16_BYTES },
    },
    /* The one format that all colour targets of a pass have (C 2.2). */
    .scalar = {
        { .format = HL_FORMAT_RGBA8_UNORM },
    },
    /* F_W16Z16Y16X16. That it blends is common knowledge of this family of
     * chips; no document was found that says so (C 2.2: medium). */
    .light = {
        { .format = HL_FORMAT_RGBA16_FLOAT },
        { .format = HL_FORMAT_RGBA8_UNORM, .range = 1, .sampled = 1 },
    },
    .color = {
        { .format = HL_FORMAT_RGBA16_FLOAT },
    },
    /* Z24S8 read as four bytes, by the BARG remap and the precise fetch
     * (K 5.2, C 2.5). Elsewhere depth is sampled as depth. */
    .depth = {
        { .format = HL_FORMAT_D24_UNORM_S8,
          .sample_as = HL_FORMAT_RGBA8_UNORM, .on = HL_ON_CONSOLE,
          .depth_read = HL_DEPTH_READ_BARG,
          .console = { .remap = REMAP_BARG } },
        { .format = HL_FORMAT_D24_UNORM_S8, .on = HL_ON_STAND_IN },
        { .format = HL_FORMAT_D32_FLOAT, .on = HL_ON_STAND_IN },
        { .format = HL_FORMAT_D32_FLOAT_S8, .on = HL_ON_STAND_IN },
    },
    /* F_W32Z32Y32X32 and F_X32 (C 2.2: medium). */
    .no_blend = { HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_R32_FLOAT },
    .id_steps = 65535.0f,
    .samples = 1 | 2 | 4,
    /* Textures give numbers; shaders have no integers. */
    .float_taps = true,
    .one_mrt_format = true,          /* C 2.2; K 5.2 says equal bits         */
    .packed_normals = true,          /* K 5.2                                */
    .big_endian = true,
};
