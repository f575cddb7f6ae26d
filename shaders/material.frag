#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Material pass (K 2.3): out = e + rho (A + D) + ks S, lights inferred. */
#include "shaders/inferred.glsl"
#include "shaders/surface.glsl"

layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_color;

void main()
{
    hl_surface s = hl_read_surface();
    hl_lit l = hl_read_lights(v_ids);
    vec3 c = s.base + s.albedo * l.diffuse + s.specular * l.specular;
    out_color = vec4(min(c, vec3(HL_HALF_MAX)), s.alpha);
}
