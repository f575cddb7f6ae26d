#version 450
/* SPDX-License-Identifier: Zlib */
/* The colour in uniform slot 0, times a texel of slot 0 of the textures, plus
 * element 0 of storage slot 0. */
layout(set = 0, binding = 0, std140) uniform solid_block { vec4 color; } solid;
layout(set = 1, binding = 0) uniform sampler2D stamp;
layout(set = 2, binding = 0, std430) readonly buffer add_block {
    vec4 add[];
} more;
layout(location = 0) out vec4 out_color;

void main()
{
    out_color = solid.color * texelFetch(stamp, ivec2(0), 0) + more.add[0];
}
