#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Forward shading: emission and ambient (first draw) and a batch of lights,
 * or (HL_LIST) all of an object's lights in one draw. */
#define HL_NORMALS
#ifdef HL_LIST
#define HL_LISTS
#endif
#include "shaders/lights.glsl"
#include "shaders/surface.glsl"

layout(constant_id = HL_SPEC_BASE) const uint hl_spec_base = 1u;
layout(location = HL_VARY_POSITION) in vec3 v_position;
layout(location = 0) out vec4 out_color;

void main()
{
    hl_surface s = hl_read_surface();
    vec3 c = hl_spec_base != 0u ? s.base : vec3(0.0);
    vec3 p = v_position;
    vec3 n = hl_read_normal();
    vec3 v = -p * inversesqrt(dot(p, p));
    if (hl_spec_brdfs != 0u)
        hl_lit_skin = hl_object.flat_ids.w == float(HL_BRDF_SKIN_INDEX);
#ifdef HL_LIST
    hl_sum l = hl_sum_list(p, n, v, s.exponent, uint(hl_object.ids.z),
                           uint(hl_object.ids.w));
    c += s.albedo * l.diffuse + s.specular * l.specular;
#else
    if (hl_spec_batch != 0u) {
        hl_sum l = hl_sum_batch(p, n, v, s.exponent);
        c += s.albedo * l.diffuse + s.specular * l.specular;
    }
#endif
    out_color = vec4(min(c, vec3(HL_HALF_MAX)), s.alpha);
}
