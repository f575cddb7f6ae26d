#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* An embedder's white material for plans with float_taps. */
#define HL_OWN_MATERIAL_BLOCK
#define HL_FLOAT_TAPS
#include "shaders/inferred.glsl"

layout(set = 0, binding = HL_SLOT_MATERIAL, std140) uniform own_block {
    vec4 tint;
} own;
layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_color;

void main()
{
    hl_lit lit = hl_read_lights(v_ids);
    out_color = vec4(own.tint.rgb * (hl_frame.ambient.rgb + lit.diffuse), 1.0);
}
