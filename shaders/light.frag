#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* Light pass (K 2.2): D in rgb, specular intensity in alpha, without the
 * ambient, which the material pass adds. */
#ifdef HL_TILES
#define HL_LISTS
#endif
#include "shaders/lights.glsl"
#include "shaders/shared/pack.h"

layout(set = 1, binding = HL_TEX_DEPTH) uniform sampler2D hl_tex_depth;
layout(set = 1, binding = HL_TEX_NORMAL) uniform sampler2D hl_tex_normal;
layout(set = 1, binding = HL_TEX_EXPONENT) uniform sampler2D hl_tex_exponent;
#ifdef HL_TILES
layout(set = 2, binding = HL_SLOT_TILES, std430) readonly buffer hl_tile_block {
    uvec2 tile[]; /* first element of the list, count */
} hl_tiles;
#endif
#ifdef HL_FLAT
layout(location = 0) flat in vec4 v_ray;
layout(location = 1) flat in vec4 v_terms;
#endif
layout(constant_id = HL_SPEC_LIGHT_OUT) const float hl_spec_light_out = 1.0;
layout(constant_id = HL_SPEC_TWO16) const uint hl_spec_two16 = 0u;
layout(constant_id = HL_SPEC_DEPTH_READ) const uint hl_spec_depth_read = 0u;
layout(constant_id = HL_SPEC_LIGHT_WIDTH) const float hl_spec_light_w = 1.0;
layout(constant_id = HL_SPEC_LIGHT_HEIGHT) const float hl_spec_light_h = 1.0;
layout(location = 0) out vec4 out_light;
#ifdef HL_SHADOW_MAP
#include "shaders/shadow.glsl"
#endif

float hl_read_depth(vec2 uv)
{
    vec4 c = texture(hl_tex_depth, uv);
    return hl_spec_depth_read == uint(HL_DEPTH_READ_BARG)
           ? hl_depth_barg(c.xyz) : c.x;
}

void main()
{
#ifdef HL_FLAT
    vec4 ray = v_ray;
    vec3 terms = v_terms.xyz;
#else
    vec4 ray = hl_frame.ray_light;
    vec3 terms = vec3(hl_frame.depth.xy, hl_frame.misc.x);
#endif
    /* The texel's own centre, nearest filter: what texelFetch would give, for
     * less work where the driver checks every fetch's level and bounds. */
    vec2 uv = gl_FragCoord.xy * vec2(1.0 / hl_spec_light_w,
                                     1.0 / hl_spec_light_h);
    float z = terms.x / (hl_read_depth(uv) + terms.y);
    vec3 p = vec3((gl_FragCoord.xy * ray.xy + ray.zw) * z, -z);
    vec2 e = hl_two16_decode(hl_spec_two16, texture(hl_tex_normal, uv).xy);
    vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(e.x),
                                    hl_unorm_to_snorm(e.y)));
    vec3 v = -p * inversesqrt(dot(p, p));
    float exponent = terms.z;
    if (hl_spec_brdfs != 0u) {
        vec2 pair = hl_two16_decode(hl_spec_two16,
                                    texture(hl_tex_exponent, uv).xy);
        hl_lit_skin = hl_brdf_decode(pair.y) == float(HL_BRDF_SKIN_INDEX);
        if (hl_spec_specular == uint(HL_SPECULAR_CHANNEL))
            exponent = hl_exponent_decode(pair.x);
    } else if (hl_spec_specular == uint(HL_SPECULAR_CHANNEL)) {
        exponent = hl_exponent_decode(texture(hl_tex_exponent, uv).x);
    }
#ifdef HL_TILES
    ivec2 t = ivec2(gl_FragCoord.xy) / int(hl_frame.misc.y);
    uvec2 list = hl_tiles.tile[t.y * int(hl_frame.misc.z) + t.x];
    hl_sum s = hl_sum_list(p, n, v, exponent, list.x, list.y);
#else
    hl_sum s = hl_sum_batch(p, n, v, exponent);
#endif
#ifdef HL_SHADOW_MAP
    /* No branch by what is lit at all: lavapipe 22.3 takes branches that hang
     * on a uniform apart, and loses its way. */
    float lit = hl_shadow_lit(p, n);
    s.diffuse *= lit;
    s.intensity *= lit;
#endif
    out_light = min(vec4(s.diffuse, s.intensity) * hl_spec_light_out,
                    vec4(HL_HALF_MAX));
}
