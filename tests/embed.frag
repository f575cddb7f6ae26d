#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* An engine's own material: two-colour squares by pixel, rim of its own, lit
 * by what halflight inferred. */
#define HL_OWN_MATERIAL_BLOCK
#include "shaders/inferred.glsl"

layout(set = 0, binding = HL_SLOT_MATERIAL, std140) uniform own_block {
    vec4 light_color, dark_color;
} own;
layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_color;

void main()
{
    hl_lit lit = hl_read_lights(v_ids);
    ivec2 cell = ivec2(gl_FragCoord.xy) / 8;
    vec3 paint = ((cell.x + cell.y) & 1) == 0 ? own.light_color.rgb
                                              : own.dark_color.rgb;
    out_color = vec4(paint * (hl_frame.ambient.rgb + lit.diffuse), 1.0);
}
