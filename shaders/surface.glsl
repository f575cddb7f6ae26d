/* SPDX-License-Identifier: Zlib */
/* The surface under a pixel of a mesh pass: normal, material, mask. */
#include "shaders/shared/block.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "shaders/centroid.glsl"

layout(constant_id = HL_SPEC_MASK) const uint hl_spec_mask = 0u;
layout(constant_id = HL_SPEC_TEXTURES) const uint hl_spec_textures = 0u;
layout(constant_id = HL_SPEC_TWO_SIDED) const uint hl_spec_two_sided = 0u;

struct hl_surface {
    vec3 albedo;
    vec3 specular;
    vec3 base;       /* e + rho A: emission and ambient                      */
    float exponent;
    float alpha;
};

#ifdef HL_FULL
layout(location = HL_VARY_UV) HL_AT in vec2 v_uv;
layout(location = HL_VARY_COLOR) HL_AT in vec4 v_color;
layout(set = 1, binding = HL_TEX_BASE) uniform sampler2D hl_tex_base;
layout(set = 1, binding = HL_TEX_METAL_ROUGH) uniform sampler2D hl_tex_mr;
layout(set = 1, binding = HL_TEX_EMISSION) uniform sampler2D hl_tex_emission;

vec4 hl_base_color()
{
    vec4 base = hl_material.base * v_color;
    if ((hl_spec_textures & HL_TEXTURED_BASE) != 0u)
        base *= texture(hl_tex_base, v_uv);
    return base;
}

void hl_alpha_test(float alpha)
{
    if (hl_spec_mask == 1u && alpha < hl_material.params.w)
        discard;
    if (hl_spec_mask == 2u && alpha < HL_ALPHA_VISIBLE)
        discard;
}

float hl_surface_alpha() { return hl_base_color().a; }

hl_surface hl_read_surface()
{
    vec4 base = hl_base_color();
    hl_alpha_test(base.a);
    float metallic = hl_material.params.x;
    float roughness = hl_material.params.y;
    vec3 emission = hl_material.emission.rgb;
    if ((hl_spec_textures & HL_TEXTURED_METAL_ROUGH) != 0u) {
        vec4 mr = texture(hl_tex_mr, v_uv);
        roughness *= mr.g;
        metallic *= mr.b;
    }
    if ((hl_spec_textures & HL_TEXTURED_EMISSION) != 0u)
        emission *= texture(hl_tex_emission, v_uv).rgb;
    hl_surface s;
    s.exponent = hl_roughness_exponent(roughness);
    s.albedo = hl_material_albedo(base.rgb, metallic);
    s.specular = hl_material_specular(base.rgb, metallic, s.exponent) *
                 hl_material.emission.w;
    s.base = emission + s.albedo * hl_frame.ambient.rgb;
    s.alpha = base.a;
    return s;
}
#endif

#ifndef HL_FULL
float hl_surface_alpha() { return hl_material.base.a; }
#endif

#ifdef HL_PLAIN
layout(location = HL_VARY_ALBEDO) flat in vec4 v_albedo;
layout(location = HL_VARY_SPECULAR) flat in vec4 v_specular;
layout(location = HL_VARY_BASE) flat in vec4 v_base;

hl_surface hl_read_surface()
{
    return hl_surface(v_albedo.rgb, v_specular.rgb, v_base.rgb, v_specular.w,
                      v_albedo.a);
}
#endif

#ifdef HL_NORMALS
layout(location = HL_VARY_NORMAL) in vec3 v_normal;
#ifdef HL_FULL
layout(location = HL_VARY_TANGENT) in vec4 v_tangent;
layout(set = 1, binding = HL_TEX_NORMAL_MAP) uniform sampler2D hl_tex_normal;
#endif

/* Unit view-space normal. Interpolated normals can cancel to zero; then the
 * viewer's direction stands in, so that no NaN leaves the stage. */
vec3 hl_read_normal()
{
    vec3 n = v_normal;
#ifdef HL_FULL
    if ((hl_spec_textures & HL_TEXTURED_NORMAL) != 0u) {
        n = normalize(n);
        vec3 t = v_tangent.xyz;
        float t2 = dot(t, t);
        if (t2 > 0.0) {
            t *= inversesqrt(t2);
            vec3 m = texture(hl_tex_normal, v_uv).xyz * 2.0 - 1.0;
            m.xy *= hl_material.params.z;
            n = t * m.x + cross(n, t) * (v_tangent.w * m.y) + n * m.z;
        }
    }
#endif
    if (hl_spec_two_sided != 0u && !gl_FrontFacing)
        n = -n;
    float len2 = dot(n, n);
    return len2 > 0.0 ? n * inversesqrt(len2) : vec3(0.0, 0.0, 1.0);
}
#endif
