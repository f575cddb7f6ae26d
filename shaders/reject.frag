#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* How many of the four DSF taps a pixel rejects, plus one, in 255ths: zero
 * is a pixel that no surface covers. */
#include "shaders/inferred.glsl"
#include "shaders/surface.glsl"

layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_rejects;

void main()
{
#ifdef HL_FULL
    if (hl_spec_mask != 0u)
        hl_alpha_test(hl_base_color().a);
#endif
    vec4 a = hl_accept_taps(hl_find_taps(), v_ids);
    float n = 5.0 - (a.x + a.y + a.z + a.w);
    out_rejects = vec4(n / 255.0, 0.0, 0.0, 1.0);
}
