#version 450
#extension GL_GOOGLE_include_directive : require
/* SPDX-License-Identifier: Zlib */
/* A table of shaders/shared functions: constant 0 says which one, texel x, y
 * of slot 0 holds its arguments, the result goes to the same texel. Slot 1
 * is a picture of two 16-bit channels that function 20 reads as words, slot
 * 2 one that function 24 reads as numbers. */
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"

layout(constant_id = 0) const uint what = 0u;
layout(set = 1, binding = 0) uniform sampler2D arguments;
layout(set = 1, binding = 1) uniform usampler2D stored;
layout(set = 1, binding = 2) uniform sampler2D numbers;
layout(location = 0) out vec4 result;

vec4 pack_functions(vec4 a)
{
    if (what == 0u)
        return vec4(hl_normal_encode(a.xyz), 0.0, 0.0);
    if (what == 1u)
        return vec4(hl_normal_decode(a.xy), 0.0);
    if (what == 2u)
        return vec4(hl_snorm_to_unorm(a.x), hl_unorm_to_snorm(a.y),
                    hl_tangent_w_group(a.z), hl_tangent_w_sign(a.z));
    if (what == 3u)
        return vec4(hl_split16(a.x), hl_join16(hl_split16(a.x)), 0.0);
    if (what == 4u)
        return vec4(hl_depth_encode(a.x, a.y), hl_id_encode(a.z, a.w), 0.0,
                    0.0);
    return vec4(hl_exponent_encode(a.x), hl_exponent_decode(a.y), 0.0, 0.0);
}

vec4 shade_functions(vec4 a)
{
    if (what == 6u)
        return vec4(hl_falloff_smooth(a.x, a.y),
                    hl_falloff_inverse_square(a.x, a.y),
                    hl_spot(a.z, a.w, 0.25), hl_clamp01(a.z));
    if (what == 7u)
        return vec4(hl_specular(a.x, a.y), hl_luminance(a.xyz),
                    hl_specular_scale(a.xyz, a.w), 0.0);
    if (what == 8u)
        return vec4(hl_material_specular(a.xyz, a.w, 20.0),
                    hl_roughness_exponent(a.w));
    return vec4(hl_material_albedo(a.xyz, a.w), 0.0);
}

vec4 filter_functions(vec4 a)
{
    if (what == 10u)
        return hl_bilinear(a.xy);
    if (what == 11u) {
        uint m = uint(a.z);
        return hl_dsf_weights(hl_bilinear(a.xy),
                              vec4(m & 1u, m >> 1 & 1u, m >> 2 & 1u,
                                   m >> 3 & 1u));
    }
    return vec4(hl_dsf_threshold(0.01, 1.5, 0.001, a.x, a.y, a.z),
                hl_dsf_accept(a.x, a.w, a.y, a.w, a.z, 0.5), 0.0, 0.0);
}

/* Is the stored id the one that was written, and not its neighbours'? */
vec4 read_id(vec4 a)
{
    float id = float(texelFetch(stored, ivec2(gl_FragCoord.xy), 0).x >> 16);
    return vec4(hl_dsf_accept(0.0, id, 0.0, a.z, 1.0, 0.5),
                hl_dsf_accept(0.0, id, 0.0, a.z + 1.0, 1.0, 0.5),
                hl_dsf_accept(0.0, id, 0.0, a.z - 1.0, 1.0, 0.5), id);
}

/* The two numbers kept as mode a.w says, in steps of a.z and 65535; so that
 * rounding of the arithmetic does not count, to the nearest step. */
vec4 read_two16(vec4 a)
{
    vec2 s = texelFetch(numbers, ivec2(gl_FragCoord.xy), 0).xy;
    vec2 v = hl_two16_decode(uint(a.w), s);
    return vec4(v, floor(v.y * a.z + 0.5), abs(v.y * a.z - a.y));
}

vec4 console_functions(vec4 a)
{
    if (what == 22u)
        return hl_two16_encode(uint(a.w), a.x, hl_id_encode(a.y, 1.0 / a.z));
    if (what == 23u)
        return vec4(hl_two16_decode(uint(a.w), a.xy), hl_depth_barg(a.xyz),
                    0.0);
    return read_two16(a);
}

void main()
{
    vec4 a = texelFetch(arguments, ivec2(gl_FragCoord.xy), 0);
    if (what == 20u)
        result = read_id(a);
    else if (what == 21u)
        result = vec4(hl_snorm_to_unorm(a.x), hl_snorm_to_unorm(a.y), 0.0,
                      1.0);
    else if (what >= 22u)
        result = console_functions(a);
    else
        result = what < 6u ? pack_functions(a)
                 : what < 10u ? shade_functions(a) : filter_functions(a);
}
