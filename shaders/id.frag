#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* True region ids, 32 bits: (object index + 1) << 16 | normal group, with no
 * regard to what the DSF can store; 0 is the background. */
#include "shaders/surface.glsl"

layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out uint out_id;

void main()
{
#ifdef HL_FULL
    if (hl_spec_mask != 0u)
        hl_alpha_test(hl_base_color().a);
#endif
    out_id = (uint(hl_object.ids.y) + 1u) << 16 |
             (uint(v_ids.x - hl_object.ids.x) & 0xffffu);
}
