#version 450
/* SPDX-License-Identifier: Zlib */
/* The colour in uniform slot 0, times this pixel's texel of texture slot 0,
 * plus element 0 of storage slot 0. */
layout(set = 0, binding = 0, std140) uniform solid_block { vec4 color; } solid;
layout(set = 1, binding = 0) uniform sampler2D stamp;
layout(set = 2, binding = 0, std430) readonly buffer add_block {
    vec4 add[];
} more;
layout(location = 0) out vec4 out_color;

void main()
{
    ivec2 texel = min(ivec2(gl_FragCoord.xy), textureSize(stamp, 0) - 1);
    out_color = solid.color * texelFetch(stamp, texel, 0) + more.add[0];
}
