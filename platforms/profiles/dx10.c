/* SPDX-License-Identifier: Zlib */
/* Direct3D 10.0 class hardware. Sources: K = Kircher, Lawrance 2009,
 * section 5; C = spec/consoles.md, section 3; F = learn.microsoft.com,
 * "Format support for Direct3D Feature Level 10.0 hardware" and "Required
 * DXGI formats". */
#include "shaders/shared/block.h"
#include "platforms/profiles/hl_profiles.h"

const struct hl_profile hl_profile_dx10 = {
    .name = "dx10",
    /* R16G16_UNORM: a required target (F). */
    .two16 = {
        { .format = HL_FORMAT_RG16_UNORM, .two16 = HL_TWO16_UNORM },
    },
    .scalar = {
        { .format = HL_FORMAT_R16_UNORM },
        { .format = HL_FORMAT_R8_UNORM },
    },
    /* Half floats are required to blend. For R16G16B16A16_UNORM no source
     * says so (F lists it as a target, not as blendable): left out. */
    .light = {
        { .format = HL_FORMAT_RGBA16_FLOAT },
        { .format = HL_FORMAT_RGBA8_UNORM, .range = 1, .sampled = 1 },
    },
    /* Blending of R32G32B32A32_FLOAT is optional on 10.0. */
    .color = {
        { .format = HL_FORMAT_RGBA16_FLOAT },
    },
    /* R24G8_TYPELESS, tested as D24_UNORM_S8_UINT, read as
     * R24_UNORM_X8_TYPELESS (C). D32_FLOAT is required too, for machines
     * that lack the packed 24 bits, and with a stencil. */
    .depth = {
        { .format = HL_FORMAT_D24_UNORM_S8,
          .depth_read = HL_DEPTH_READ_FLOAT },
        { .format = HL_FORMAT_D32_FLOAT },
        { .format = HL_FORMAT_D32_FLOAT_S8 },
    },
    .no_blend = { HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_R32_FLOAT },
    .id_steps = 65535.0f,
    .samples = 1 | 2 | 4 | 8,
    /* R16G16 cannot be viewed as R32, nor R16G16B16A16 as R32G32: views stay
     * within one typeless family. */
    .float_taps = true,
    /* Read-only depth views came with 11.0; what stays bound for the test is
     * copied by a shader, since 10.0 copies no depth either (C). */
    .depth_copy_if_bound = true,
};
