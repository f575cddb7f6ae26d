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
layout(location = 0) out vec4 out_light;

void main()
{
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float d = texelFetch(hl_tex_depth, texel, 0).x;
    float z = hl_frame.depth.x / (d + hl_frame.depth.y);
    vec3 p = vec3((gl_FragCoord.xy * hl_frame.ray_light.xy +
                   hl_frame.ray_light.zw) * z, -z);
    vec2 e = texelFetch(hl_tex_normal, texel, 0).xy;
    vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(e.x),
                                    hl_unorm_to_snorm(e.y)));
    vec3 v = -p * inversesqrt(dot(p, p));
    float exponent = hl_frame.misc.x;
    if (hl_spec_specular == uint(HL_SPECULAR_CHANNEL))
        exponent = hl_exponent_decode(texelFetch(hl_tex_exponent, texel, 0).x);
#ifdef HL_TILES
    ivec2 t = texel / int(hl_frame.misc.y);
    uvec2 list = hl_tiles.tile[t.y * int(hl_frame.misc.z) + t.x];
    hl_sum s = hl_sum_list(p, n, v, exponent, list.x, list.y);
#else
    hl_sum s = hl_sum_batch(p, n, v, exponent);
#endif
    out_light = vec4(s.diffuse, s.intensity) / hl_frame.ambient.w;
}
