#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* One triangle that covers the target; the scissor cuts it to size. Depth
 * 0.5 keeps it inside both depth conventions. HL_FLAT: the draw's lights go
 * down as flat varyings. */
#include "shaders/shared/block.h"
#include "shaders/half_pixel.glsl"
#ifdef HL_FLAT
layout(location = 0) flat out vec4 v_ray;
layout(location = 1) flat out vec4 v_terms;
layout(location = 2) flat out vec4 v_light[HL_FLAT_VEC4S];
layout(constant_id = HL_SPEC_KINDS) const uint hl_spec_kinds = 0u;
layout(constant_id = HL_SPEC_BATCH) const uint hl_spec_batch = 8u;
#endif

void main()
{
    vec2 p = vec2((gl_VertexIndex & 1) * 4 - 1, (gl_VertexIndex & 2) * 2 - 1);
    gl_Position = hl_half_pixel(vec4(p, 0.5, 1.0));
#ifdef HL_FLAT
    v_ray = hl_frame.ray_light;
    v_terms = vec4(hl_frame.depth.xy, hl_frame.misc.x, 0.0);
    uint n = hl_spec_batch * (hl_spec_kinds != 0u ? HL_LIGHT_VEC4S
                                                  : HL_POINT_VEC4S);
    for (uint i = 0u; i < HL_FLAT_VEC4S; i++)
        if (i < n)
            v_light[i] = hl_lights.data[i];
#endif
}
