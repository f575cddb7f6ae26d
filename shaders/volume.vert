#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Volumes that go to the stencil buffer alone: those of lights (w = 1
 * throughout) and of shadows, whose vertices with w = 0 move away from the
 * light to infinity (core/shadow_volume.h). The product is written as in
 * mesh.vert, so that caps have their mesh's depths. */
#include "shaders/shared/block.h"
#include "shaders/half_pixel.glsl"

layout(location = HL_ATTR_POSITION) in vec4 in_position;
invariant gl_Position;
layout(set = 0, binding = HL_SLOT_VOLUME, std140) uniform hl_volume_block {
    mat4 clip;
    vec4 light;
} hl_volume;

void main()
{
    vec4 p = in_position.w > 0.5
             ? vec4(in_position.xyz, 1.0)
             : vec4(in_position.xyz * hl_volume.light.w - hl_volume.light.xyz,
                    0.0);
    gl_Position = hl_half_pixel(hl_volume.clip * p);
}
