#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Geometry pass (K 2.1): normal x, y; linear depth and region id; and, only
 * where a scene needs them, the specular exponent, alone or in a pair with
 * the BRDF, and motion. */
#define HL_NORMALS
#include "shaders/surface.glsl"
#include "shaders/stipple.glsl"

layout(constant_id = HL_SPEC_TWO16) const uint hl_spec_two16 = 0u;
layout(constant_id = HL_SPEC_ID_STEPS) const float hl_spec_id_steps = 65535.0;
layout(constant_id = HL_SPEC_DECAL) const uint hl_spec_decal = 0u;
layout(location = HL_VARY_IDS) flat in vec4 v_ids;
layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_dsf;
#ifdef HL_EXPONENT
layout(constant_id = HL_SPEC_BRDFS) const uint hl_spec_brdfs = 0u;
layout(location = 2) out vec4 out_exponent;
#endif
#ifdef HL_MOTION
layout(location = HL_VARY_MOTION) in vec3 v_motion[2];
#ifdef HL_EXPONENT
layout(location = 3) out vec4 out_motion;
#else
layout(location = 2) out vec4 out_motion;
#endif

/* Clip x, y over w now, less the last frame's; none where that was behind
 * the camera. Divided here, as these are no planes on the screen. */
vec2 hl_read_motion()
{
    vec3 now = v_motion[0], before = v_motion[1];
    return now.z > 0.0 && before.z > 0.0 ? now.xy / now.z - before.xy / before.z
                                         : vec2(0.0);
}
#endif

void main()
{
    hl_stipple_test();
#ifdef HL_FULL
    if (hl_spec_mask != 0u)
        hl_alpha_test(hl_surface_alpha());
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
    if (hl_spec_brdfs != 0u)
        out_exponent = hl_two16_encode(hl_spec_two16, code,
                                       hl_brdf_encode(hl_object.flat_ids.w));
#endif
#ifdef HL_MOTION
    vec2 m = hl_read_motion();
    out_motion = hl_two16_encode(hl_spec_two16, hl_motion_encode(m.x),
                                 hl_motion_encode(m.y));
#endif
    /* Blended over what is there: the rest stays the surface's below. */
    if (hl_spec_decal != 0u) {
        out_normal.a = hl_surface_alpha();
        out_dsf.a = 0.0;
#ifdef HL_EXPONENT
        out_exponent.a = 0.0;
#endif
#ifdef HL_MOTION
        out_motion.a = 0.0;
#endif
    }
}
