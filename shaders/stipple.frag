#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Which pattern wrote a texel of the G-buffer, plus one, in 255ths; zero is
 * the background. */
#include "shaders/surface.glsl"
#include "shaders/stipple.glsl"

layout(location = 0) out vec4 out_pattern;

void main()
{
#ifdef HL_FULL
    if (hl_spec_mask != 0u)
        hl_alpha_test(hl_surface_alpha());
#endif
    hl_stipple_test();
    out_pattern = vec4((hl_object.flat_ids.z + 1.0) / 255.0, 0.0, 0.0, 1.0);
}
