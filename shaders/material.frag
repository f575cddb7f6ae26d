#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Material pass (K 2.3): out = e + rho (A + D) + ks S, lights inferred. */
#include "shaders/inferred.glsl"
#include "shaders/surface.glsl"

layout(location = 0) flat in float v_id;
layout(location = 0) out vec4 out_color;

void main()
{
    hl_surface s = hl_read_surface();
    hl_lit l = hl_read_lights(v_id);
    out_color = vec4(s.emission + s.albedo * (hl_frame.ambient.rgb + l.diffuse)
                     + s.specular * l.specular, s.alpha);
}
