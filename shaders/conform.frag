#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* The conformance suite's stage: one operation of the packing text on one
 * texel of input, chosen by the material block. */
#include "shaders/shared/block.h"
#include "shaders/shared/pack.h"

layout(set = 1, binding = 0) uniform sampler2D hl_tex_in;
layout(location = 0) out vec4 out_value;

void main()
{
    out_value = texelFetch(hl_tex_in, ivec2(gl_FragCoord.xy), 0);
}
