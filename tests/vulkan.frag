#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* A stage of the Vulkan tests' own: one quantity a draw, by constant 0. */
#define HL_OWN_MATERIAL_BLOCK
#include "shaders/shared/block.h"

layout(constant_id = 0) const uint what = 0u;
layout(constant_id = 1) const float lod = 0.0;
layout(set = 0, binding = HL_SLOT_MATERIAL) uniform own_block {
    vec4 color;
} own;
layout(set = 1, binding = 0) uniform sampler2D image;
layout(set = 1, binding = 1) uniform sampler2D unbound;
layout(location = HL_VARY_UV) in vec2 v_uv;
layout(location = HL_VARY_COLOR) in vec4 v_color;
layout(location = 0) out vec4 color;

void main()
{
    switch (what) {
    case 0u: color = own.color; break;
    case 1u: color = v_color; break;
    case 2u: color = vec4(gl_FragCoord.xyz, gl_FrontFacing ? 1.0 : 0.0); break;
    case 3u: color = texelFetch(image, ivec2(gl_FragCoord.xy), 0); break;
    case 4u: color = textureLod(image, v_uv, lod); break;
    default: color = texelFetch(unbound, ivec2(0), 0); break;
    }
}
