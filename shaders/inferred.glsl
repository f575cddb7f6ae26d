/* SPDX-License-Identifier: Zlib */
/* How a material pass reads its lighting: include this in a fragment stage
 * (also one of an embedder's own) and call hl_read_lights(id). Uses texture
 * slots 0 and 1 and uniform slots 0 and 1; define HL_OWN_MATERIAL_BLOCK
 * first to lay out uniform slot 2 yourself, and HL_FLOAT_TAPS for plans with
 * float_taps, whose machines sample numbers and not words. */
#include "shaders/shared/block.h"
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"

layout(constant_id = HL_SPEC_DSF) const uint hl_spec_dsf = 1u;
layout(constant_id = HL_SPEC_LIGHT_BITS) const uint hl_spec_light_bits = 0u;
layout(constant_id = HL_SPEC_LIGHT_WIDTH) const float hl_spec_light_w = 1.0;
layout(constant_id = HL_SPEC_LIGHT_HEIGHT) const float hl_spec_light_h = 1.0;
layout(constant_id = HL_SPEC_RATIO_X) const float hl_spec_ratio_x = 1.0;
layout(constant_id = HL_SPEC_RATIO_Y) const float hl_spec_ratio_y = 1.0;
layout(constant_id = HL_SPEC_DSF_K) const float hl_spec_dsf_k = 1.5;
layout(constant_id = HL_SPEC_DSF_C) const float hl_spec_dsf_c = 0.001;
layout(constant_id = HL_SPEC_DSF_TAU) const float hl_spec_dsf_tau = 0.01;
layout(constant_id = HL_SPEC_LIGHT_SCALE) const float hl_spec_scale = 1.0;
#ifdef HL_FLOAT_TAPS
layout(constant_id = HL_SPEC_TWO16) const uint hl_spec_two16 = 0u;
layout(constant_id = HL_SPEC_ID_STEPS) const float hl_spec_id_steps = 65535.0;
layout(set = 1, binding = HL_TEX_LIGHT) uniform sampler2D hl_tex_light;
layout(set = 1, binding = HL_TEX_DSF) uniform sampler2D hl_tex_dsf;
#define hl_texels vec4
#else
layout(set = 1, binding = HL_TEX_LIGHT) uniform usampler2D hl_tex_light;
layout(set = 1, binding = HL_TEX_DSF) uniform usampler2D hl_tex_dsf;
#define hl_texels uvec4
#endif

/* D of the light model (without ambient), and the factor that turns a
 * surface's ks into its specular light: S ks = specular * ks. */
struct hl_lit { vec3 diffuse; vec3 specular; };

/* The four texels around a pixel: the point between them, where a gather
 * takes exactly these whatever the machine's rounding, and the fraction. */
struct hl_taps { vec2 middle, f; };

hl_taps hl_find_taps()
{
    vec2 p = gl_FragCoord.xy * vec2(hl_spec_ratio_x, hl_spec_ratio_y) - 0.5;
    vec2 b = floor(p);
    vec2 texel = vec2(1.0 / hl_spec_light_w, 1.0 / hl_spec_light_h);
    return hl_taps((b + 1.0) * texel, p - b);
}

/* A gather gives texels 01, 11, 10, 00; everything here is 00, 10, 01, 11. */
hl_texels hl_in_order(hl_texels g) { return g.wzxy; }

/* Depths, in steps of far / 65535, and ids of the four taps. */
struct hl_dsf_taps { vec4 depth, id; };

#ifdef HL_FLOAT_TAPS
hl_dsf_taps hl_read_dsf(vec2 middle)
{
    vec4 x = hl_in_order(textureGather(hl_tex_dsf, middle, 0));
    vec4 y = hl_in_order(textureGather(hl_tex_dsf, middle, 1));
    hl_dsf_taps t;
    for (int i = 0; i < 4; i++) {
        vec2 v = hl_two16_decode(hl_spec_two16, vec2(x[i], y[i]));
        t.depth[i] = v.x * 65535.0;
        t.id[i] = v.y * hl_spec_id_steps;
    }
    return t;
}
#else
/* Depth in the low half of the word, id in the high half, both codes. */
hl_dsf_taps hl_read_dsf(vec2 middle)
{
    uvec4 w = hl_in_order(textureGather(hl_tex_dsf, middle, 0));
    return hl_dsf_taps(vec4(w & 0xffffu), vec4(w >> 16u));
}
#endif

/* Acceptance, 0 or 1, of taps 00, 10, 01, 11 for a surface's ids. */
vec4 hl_accept_taps(hl_taps t, vec4 ids)
{
    float z = 1.0 / gl_FragCoord.w;
    float step = ids.w / 65535.0;
    float threshold = hl_spec_dsf_tau * z;
    if (hl_spec_dsf == uint(HL_DSF_SLOPE)) {
        /* Pixels to L texels: an L texel spans 1 / ratio pixels. The taps
         * lie within one texel of the pixel on either axis. */
        float slope = abs(dFdx(z)) * (1.0 / hl_spec_ratio_x) +
                      abs(dFdy(z)) * (1.0 / hl_spec_ratio_y);
        threshold = hl_dsf_threshold(step, hl_spec_dsf_k, hl_spec_dsf_c, z,
                                     slope, 1.0);
    }
    hl_dsf_taps taps = hl_read_dsf(t.middle);
    vec4 d = taps.depth * step;
    vec4 i = taps.id;
    return vec4(hl_dsf_accept(d.x, i.x, z, ids.x, threshold, 0.5),
                hl_dsf_accept(d.y, i.y, z, ids.x, threshold, 0.5),
                hl_dsf_accept(d.z, i.z, z, ids.x, threshold, 0.5),
                hl_dsf_accept(d.w, i.w, z, ids.x, threshold, 0.5));
}

#ifdef HL_FLOAT_TAPS
vec4 hl_unpack_light(vec4 l)
{
    return hl_spec_light_bits == uint(HL_BITS_HALF)
           ? min(l, vec4(HL_HALF_MAX)) : l;
}

vec4 hl_weigh_light(vec2 middle, vec4 k)
{
    vec4 r = hl_unpack_light(textureGather(hl_tex_light, middle, 0));
    vec4 g = hl_unpack_light(textureGather(hl_tex_light, middle, 1));
    vec4 b = hl_unpack_light(textureGather(hl_tex_light, middle, 2));
    vec4 a = hl_unpack_light(textureGather(hl_tex_light, middle, 3));
    return vec4(dot(hl_in_order(r), k), dot(hl_in_order(g), k),
                dot(hl_in_order(b), k), dot(hl_in_order(a), k));
}
#else
vec4 hl_unpack_light(uvec4 w)
{
    if (hl_spec_light_bits == uint(HL_BITS_HALF))
        return min(vec4(unpackHalf2x16(w.x), unpackHalf2x16(w.y)),
                   vec4(HL_HALF_MAX));
    if (hl_spec_light_bits == uint(HL_BITS_UNORM16))
        return vec4(unpackUnorm2x16(w.x), unpackUnorm2x16(w.y));
    if (hl_spec_light_bits == uint(HL_BITS_FLOAT))
        return uintBitsToFloat(w);
    return unpackUnorm4x8(w.x);
}

/* The four texels weighted. Words that a format does not have are not read. */
vec4 hl_weigh_light(vec2 middle, vec4 k)
{
    bool wide = hl_spec_light_bits == uint(HL_BITS_FLOAT);
    uvec4 zero = uvec4(0u);
    uvec4 r = hl_in_order(textureGather(hl_tex_light, middle, 0));
    uvec4 g = hl_spec_light_bits == uint(HL_BITS_UNORM8)
              ? zero : hl_in_order(textureGather(hl_tex_light, middle, 1));
    uvec4 b = wide ? hl_in_order(textureGather(hl_tex_light, middle, 2)) : zero;
    uvec4 a = wide ? hl_in_order(textureGather(hl_tex_light, middle, 3)) : zero;
    return hl_unpack_light(uvec4(r.x, g.x, b.x, a.x)) * k.x +
           hl_unpack_light(uvec4(r.y, g.y, b.y, a.y)) * k.y +
           hl_unpack_light(uvec4(r.z, g.z, b.z, a.z)) * k.z +
           hl_unpack_light(uvec4(r.w, g.w, b.w, a.w)) * k.w;
}
#endif

/* ids: the varying HL_VARY_IDS as it comes. */
hl_lit hl_read_lights(vec4 ids)
{
    vec4 l;
    if (hl_spec_dsf == uint(HL_DSF_EXACT)) {
        l = hl_unpack_light(texelFetch(hl_tex_light, ivec2(gl_FragCoord.xy),
                                       0));
    } else {
        hl_taps t = hl_find_taps();
        vec4 w = hl_bilinear(t.f);
        if (hl_spec_dsf != uint(HL_DSF_OFF))
            w = hl_dsf_weights(w, hl_accept_taps(t, ids));
        l = hl_weigh_light(t.middle, w);
    }
    l *= hl_spec_scale;
    return hl_lit(l.rgb, l.rgb * hl_specular_scale(l.rgb, l.a));
}
