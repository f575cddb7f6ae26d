#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* A stage of the Vulkan tests' own that shares the object slot with the
 * vertex stage and reads both storage slots. */
#define HL_OWN_MATERIAL_BLOCK
#include "shaders/shared/block.h"

layout(set = 0, binding = HL_SLOT_MATERIAL) uniform own_block {
    vec4 color;
} own;
layout(set = 2, binding = HL_SLOT_LIST, std430) readonly buffer list_block {
    float list[];
};
layout(set = 2, binding = HL_SLOT_TILES, std430) readonly buffer tiles_block {
    float tiles[];
};
layout(location = 0) out vec4 color;

void main()
{
    color = vec4(hl_object.ids.x, own.color.y, list[1], tiles[0]);
}
