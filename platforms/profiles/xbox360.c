/* SPDX-License-Identifier: Zlib */
/* Xbox 360 (Xenos). Sources: K = Kircher, Lawrance 2009, section 5.1;
 * C = spec/consoles.md, section 1. Hardware rounding is nowhere published:
 * the model is the one stated in C. */
#include "shaders/shared/block.h"
#include "platforms/profiles/hl_profiles.h"

/* Resolved by 2^-5 to signed numbers: -32..32 becomes -1..1, and the copy
 * keeps every bit (C 1.5). Swapped by halfwords, so that the processor, which
 * is big-endian, reads the channels in order; which swap is the default is
 * not known, and it is neutral where the fetch has the same (C 1.6). */
#define RESOLVE_FIXED { .resolve_exp_bias = -5,               \
                        .resolve_number = HL_NUMBER_SIGNED,   \
                        .endian = HL_ENDIAN_8IN16 }
#define RESOLVE_WORDS { .endian = HL_ENDIAN_8IN32 }

/* Codes of 16-bit UNORM that are as far apart as those of 16_16_16_16 fixed:
 * 65535 x 32/32767 codes a unit of 32. */
#define STAND_IN_RANGE (32767.0f / 65535.0f)

const struct hl_profile hl_profile_xbox360 = {
    .name = "xbox360",
    /* 16_16 fixed, the only two 16-bit channels that blend (C 1.2). The
     * shader writes 64 v - 32; times 32 could be the target's exponent bias
     * of +5 instead, with 2 v - 1 written: the shader does it, so that what
     * it writes is what K 5.1 says. */
    .two16 = {
        { .format = HL_FORMAT_RG16_FIXED32, .on = HL_ON_CONSOLE,
          .two16 = HL_TWO16_FIXED32, .range = 32, .sampled = 1,
          .console = RESOLVE_FIXED },
        { .format = HL_FORMAT_RG16_SNORM, .on = HL_ON_STAND_IN,
          .two16 = HL_TWO16_SIGNED, .range = 1, .sampled = 1 },
    },
    /* 32_FLOAT takes the 32 bits that 8_8_8_8 takes, and targets of a pass
     * may have different formats (C 1.2). */
    .scalar = {
        { .format = HL_FORMAT_R32_FLOAT, .console = RESOLVE_WORDS },
        { .format = HL_FORMAT_RGBA8_UNORM, .console = RESOLVE_WORDS },
    },
    /* Half floats do not blend, 16_16_16_16 fixed does (C 1.2). */
    .light = {
        { .format = HL_FORMAT_RGBA16_FIXED32, .on = HL_ON_CONSOLE,
          .range = 32, .sampled = 1, .console = RESOLVE_FIXED },
        { .format = HL_FORMAT_RGBA16_UNORM, .on = HL_ON_STAND_IN,
          .range = STAND_IN_RANGE, .sampled = STAND_IN_RANGE },
        { .format = HL_FORMAT_RGBA8_UNORM, .range = 1, .sampled = 1,
          .console = RESOLVE_WORDS },
    },
    /* 2_10_10_10_FLOAT, 7e3: blends, 0 to 32 (C 1.2). Stand-ins: half floats
     * hold all of its values; where this profile takes their blending away,
     * 11- and 10-bit floats do. */
    .color = {
        { .format = HL_FORMAT_RGB10A2_FLOAT, .on = HL_ON_CONSOLE,
          .console = RESOLVE_WORDS },
        { .format = HL_FORMAT_RGBA16_FLOAT, .on = HL_ON_STAND_IN },
        { .format = HL_FORMAT_RG11B10_FLOAT, .on = HL_ON_STAND_IN },
    },
    /* 20e4 float (C 1.7): the stand-in is a float too, so that near is 1 in
     * both. Raw bits are resolved. */
    .depth = {
        { .format = HL_FORMAT_D24_FLOAT_S8, .on = HL_ON_CONSOLE,
          .console = RESOLVE_WORDS },
        { .format = HL_FORMAT_D32_FLOAT, .on = HL_ON_STAND_IN },
        { .format = HL_FORMAT_D32_FLOAT_S8, .on = HL_ON_STAND_IN },
        { .format = HL_FORMAT_D24_UNORM_S8, .on = HL_ON_STAND_IN },
    },
    /* No FP16 and FP32 format blends (C 1.2). */
    .no_blend = { HL_FORMAT_RG16_FLOAT, HL_FORMAT_RGBA16_FLOAT,
                  HL_FORMAT_R32_FLOAT, HL_FORMAT_RGBA32_FLOAT },
    /* 65,535 codes: id / 65535 would give 32767 and 32768 one (C 1.5). */
    .id_steps = 65534.0f,
    .samples = 1 | 2 | 4,
    .edram_tiles = 2048,             /* 10 MiB of 80 x 16 words (C 1.1)      */
    .edram_tile_width = 80,
    .edram_tile_height = 16,
    .resolve_to_read = true,         /* K 5.1                                */
    /* A fetch gives numbers; nothing reads 16_16 as one word (C 1.6). */
    .float_taps = true,
    .integer_centers = true,         /* K 5.1, C 1.8                         */
    .big_endian = true,
};
