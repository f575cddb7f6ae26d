#version 450
/* SPDX-License-Identifier: Zlib */
/* A stage of the Vulkan tests' own that shares slot 1 with the vertex stage
 * and reads both storage slots. */
layout(set = 0, binding = 1) uniform object_block {
    mat4 clip, normal, tangent;
    vec4 ids;
} object;
layout(set = 0, binding = 2) uniform own_block { vec4 color; } own;
layout(set = 2, binding = 0, std430) readonly buffer first_block {
    float first[];
};
layout(set = 2, binding = 1, std430) readonly buffer second_block {
    float second[];
};
layout(location = 0) out vec4 color;

void main()
{
    color = vec4(object.ids.x, own.color.y, first[1], second[0]);
}
