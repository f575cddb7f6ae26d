#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* The conformance suite's stage: shaders/shared/conform.h. */
#define HL_OWN_MATERIAL_BLOCK
#include "shaders/shared/block.h"
#include "shaders/shared/conform.h"

layout(set = 0, binding = HL_SLOT_MATERIAL, std140) uniform hl_conform_block {
    vec4 op, a, b, c, first;
} hl_conform;
layout(set = 1, binding = HL_CONFORM_IN) uniform sampler2D hl_tex_in;
layout(set = 1, binding = HL_CONFORM_STORED) uniform sampler2D hl_tex_stored;
layout(location = 0) out vec4 out_value;

void main()
{
    uint op = uint(hl_conform.op.x);
    ivec2 p = ivec2(gl_FragCoord.xy);
    int layer = int(1.0 / gl_FragCoord.w + 0.5) - 1;
    ivec2 at = (p + ivec2(hl_conform.first.xy) +
                layer * ivec2(hl_conform.op.zw)) % textureSize(hl_tex_in, 0);
    vec4 i = texelFetch(hl_tex_in, at, 0);
    vec4 s;
    if (op == uint(HL_OP_SAMPLE))
        s = textureLod(hl_tex_stored, i.xy, 0.0);
    else
        s = texelFetch(hl_tex_stored,
                       min(p, textureSize(hl_tex_stored, 0) - 1), 0);
    out_value = hl_conform_op(op, uint(hl_conform.op.y), i, s, hl_conform.a,
                              hl_conform.b, hl_conform.c);
}
