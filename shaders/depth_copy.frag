#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Depth as a number in a colour target, for machines that cannot read a
 * depth target while it is bound (Direct3D 10.0), or while its stencil is
 * written. Texel for texel. */
#include "shaders/shared/block.h"
#include "shaders/shared/pack.h"

layout(constant_id = HL_SPEC_DEPTH_READ) const uint hl_spec_depth_read = 0u;
layout(set = 1, binding = HL_TEX_DEPTH) uniform sampler2D hl_tex_depth;
layout(location = 0) out vec4 out_depth;

void main()
{
    vec4 c = texelFetch(hl_tex_depth, ivec2(gl_FragCoord.xy), 0);
    float d = hl_spec_depth_read == uint(HL_DEPTH_READ_BARG)
              ? hl_depth_barg(c.xyz) : c.x;
    out_depth = vec4(d, 0.0, 0.0, 1.0);
}
