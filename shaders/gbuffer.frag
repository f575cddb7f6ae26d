#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Geometry pass (K 2.1): normal x, y; linear depth and region id; and, only
 * where materials differ in it, the specular exponent. */
#define HL_NORMALS
#include "shaders/surface.glsl"
#include "shaders/stipple.glsl"

layout(constant_id = HL_SPEC_TWO16) const uint hl_spec_two16 = 0u;
layout(constant_id = HL_SPEC_ID_STEPS) const float hl_spec_id_steps = 65535.0;
layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_dsf;
#ifdef HL_EXPONENT
layout(location = 2) out vec4 out_exponent;
#endif

void main()
{
    hl_stipple_test();
#ifdef HL_FULL
    if (hl_spec_mask != 0u)
        hl_alpha_test(hl_base_color().a);
#endif
    vec2 e = hl_normal_encode(hl_read_normal());
    out_normal = hl_two16_encode(hl_spec_two16, hl_snorm_to_unorm(e.x),
                                 hl_snorm_to_unorm(e.y));
    out_dsf = hl_two16_encode(hl_spec_two16,
                              hl_depth_encode(1.0 / gl_FragCoord.w, v_ids.z),
                              hl_id_encode(v_ids.x, 1.0 / hl_spec_id_steps));
#ifdef HL_EXPONENT
    float code = v_ids.y;
#ifdef HL_FULL
    if ((hl_spec_textures & HL_TEXTURED_METAL_ROUGH) != 0u)
        code = hl_exponent_encode(hl_roughness_exponent(
            hl_material.params.y * texture(hl_tex_mr, v_uv).g));
#endif
    out_exponent = vec4(code, 0.0, 0.0, 1.0);
#endif
}
