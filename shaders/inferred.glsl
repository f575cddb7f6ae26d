/* SPDX-License-Identifier: Zlib */
/* How a material pass reads its lighting: include this in a fragment stage
 * (also one of an embedder's own) and call hl_read_lights(id). Uses texture
 * slots 0 and 1 and uniform slots 0 and 1; define HL_OWN_MATERIAL_BLOCK
 * first to lay out uniform slot 2 yourself, HL_FLOAT_TAPS for plans with
 * float_taps, whose machines sample numbers and not words, and HL_FLOAT_LIGHT
 * for others with dsf_bilinear, which filter the L-buffer. */
#include "shaders/shared/block.h"
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "shaders/shared/stipple.h"

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
layout(constant_id = HL_SPEC_STIPPLE) const uint hl_spec_stipple = 0u;
layout(constant_id = HL_SPEC_STIPPLE_CONE) const uint hl_spec_cone = 0u;
layout(constant_id = HL_SPEC_FILL) const uint hl_spec_fill = 0u;
#ifdef HL_FLOAT_TAPS
#define HL_FLOAT_LIGHT
layout(constant_id = HL_SPEC_TWO16) const uint hl_spec_two16 = 0u;
layout(constant_id = HL_SPEC_ID_STEPS) const float hl_spec_id_steps = 65535.0;
layout(set = 1, binding = HL_TEX_DSF) uniform sampler2D hl_tex_dsf;
#else
layout(set = 1, binding = HL_TEX_DSF) uniform usampler2D hl_tex_dsf;
#endif
#ifdef HL_FLOAT_LIGHT
layout(constant_id = HL_SPEC_BILINEAR) const uint hl_spec_bilinear = 0u;
layout(set = 1, binding = HL_TEX_LIGHT) uniform sampler2D hl_tex_light;
#else
layout(set = 1, binding = HL_TEX_LIGHT) uniform usampler2D hl_tex_light;
#endif

/* D of the light model (without ambient), and the factor that turns a
 * surface's ks into its specular light: S ks = specular * ks. */
struct hl_lit { vec3 diffuse; vec3 specular; };

/* The four texels around a pixel: the point between them, where a gather
 * takes exactly these whatever the machine's rounding, and the fraction. */
struct hl_taps { vec2 middle, f; };

/* View depth at the pixel's centre, metres; its slope is the plane's also
 * where the centre lies outside of the triangle. */
float hl_center_depth() { return 1.0 / gl_FragCoord.w; }

#ifdef HL_CENTROID
layout(location = HL_VARY_CLIP) centroid in vec3 v_clip;

/* Pixels from the pixel's centre to the place that is lit. What interpolation
 * makes of the centre itself is the centre: pixels without an edge are as
 * they are without HL_CENTROID. */
vec2 hl_off_center()
{
    vec2 size = vec2(hl_spec_light_w / hl_spec_ratio_x,
                     hl_spec_light_h / hl_spec_ratio_y);
    vec2 d = (v_clip.xy / v_clip.z * 0.5 + 0.5) * size - gl_FragCoord.xy;
    return any(greaterThan(abs(d), vec2(1.0 / 32.0))) ? d : vec2(0.0);
}
#endif

/* Where the pixel lies among the centres of the L-buffer's texels. */
vec2 hl_light_pixel()
{
    vec2 p = gl_FragCoord.xy;
#ifdef HL_CENTROID
    p += hl_off_center();
#endif
    return p * vec2(hl_spec_ratio_x, hl_spec_ratio_y) - 0.5;
}

/* View depth there, metres. */
float hl_pixel_depth()
{
#ifdef HL_CENTROID
    if (hl_off_center() != vec2(0.0))
        return v_clip.z;
#endif
    return hl_center_depth();
}

hl_taps hl_find_taps()
{
    vec2 p = hl_light_pixel();
    vec2 b = floor(p);
    vec2 texel = vec2(1.0 / hl_spec_light_w, 1.0 / hl_spec_light_h);
    return hl_taps((b + 1.0) * texel, p - b);
}

/* A gather gives texels 01, 11, 10, 00; everything here is 00, 10, 01, 11. */
vec4 hl_in_order(vec4 g) { return g.wzxy; }
uvec4 hl_in_order(uvec4 g) { return g.wzxy; }

/* ---- depths and ids ------------------------------------------------------ */

/* Depths, in steps of far / 65535, and ids of the four taps. */
struct hl_dsf_taps { vec4 depth, id; };

#ifdef HL_FLOAT_TAPS
vec2 hl_split_dsf(vec2 pair)
{
    vec2 v = hl_two16_decode(hl_spec_two16, pair);
    return vec2(v.x * 65535.0, v.y * hl_spec_id_steps);
}

vec2 hl_fetch_dsf(ivec2 texel)
{
    return hl_split_dsf(texelFetch(hl_tex_dsf, texel, 0).xy);
}

hl_dsf_taps hl_read_dsf(vec2 middle)
{
    vec4 x = hl_in_order(textureGather(hl_tex_dsf, middle, 0));
    vec4 y = hl_in_order(textureGather(hl_tex_dsf, middle, 1));
    hl_dsf_taps t;
    for (int i = 0; i < 4; i++) {
        vec2 v = hl_split_dsf(vec2(x[i], y[i]));
        t.depth[i] = v.x;
        t.id[i] = v.y;
    }
    return t;
}
#else
/* Depth in the low half of the word, id in the high half, both codes. */
vec2 hl_fetch_dsf(ivec2 texel)
{
    uint w = texelFetch(hl_tex_dsf, texel, 0).x;
    return vec2(float(w & 0xffffu), float(w >> 16u));
}

hl_dsf_taps hl_read_dsf(vec2 middle)
{
    uvec4 w = hl_in_order(textureGather(hl_tex_dsf, middle, 0));
    return hl_dsf_taps(vec4(w & 0xffffu), vec4(w >> 16u));
}
#endif

/* A pixel of a surface as taps are compared with it: depth, metres; change of
 * depth in metres an L texel, both axes; one step of stored depth; region id
 * and half of one. */
struct hl_pixel { float z, slope, step, id, half_step; };

hl_pixel hl_look(vec4 ids)
{
    float slope = 0.0;
    if (hl_spec_dsf == uint(HL_DSF_SLOPE)) {
        /* Pixels to L texels: an L texel spans 1 / ratio pixels. */
        float middle = hl_center_depth();
        slope = abs(dFdx(middle)) * (1.0 / hl_spec_ratio_x) +
                abs(dFdy(middle)) * (1.0 / hl_spec_ratio_y);
    }
    /* Stored depths end at far, which a picture without a far plane does
     * not. */
    return hl_pixel(min(hl_pixel_depth(), ids.w), slope, ids.w / 65535.0,
                    ids.x, hl_dsf_half_step(ids.x));
}

/* For taps within so many texels of the pixel on either axis. */
float hl_threshold(hl_pixel p, float distance_texels)
{
    if (hl_spec_dsf == uint(HL_DSF_SLOPE))
        return hl_dsf_threshold(p.step, hl_spec_dsf_k, hl_spec_dsf_c, p.z,
                                p.slope, distance_texels);
    return hl_spec_dsf_tau * p.z;
}

/* Acceptance, 0 or 1, of taps 00, 10, 01, 11. */
vec4 hl_accept(hl_dsf_taps t, hl_pixel p, float threshold)
{
    vec4 d = t.depth * p.step;
    vec4 i = t.id;
    float h = p.half_step;
    return vec4(hl_dsf_accept(d.x, i.x, p.z, p.id, threshold, h),
                hl_dsf_accept(d.y, i.y, p.z, p.id, threshold, h),
                hl_dsf_accept(d.z, i.z, p.z, p.id, threshold, h),
                hl_dsf_accept(d.w, i.w, p.z, p.id, threshold, h));
}

/* The same for a surface's ids. */
vec4 hl_accept_taps(hl_taps t, vec4 ids)
{
    hl_pixel p = hl_look(ids);
    return hl_accept(hl_read_dsf(t.middle), p, hl_threshold(p, 1.0));
}

/* ---- light --------------------------------------------------------------- */

#ifdef HL_FLOAT_LIGHT
/* Not min: what a filter makes of infinities is no number, and goes too. */
vec4 hl_unpack_light(vec4 l)
{
    return hl_spec_light_bits == uint(HL_BITS_HALF)
           ? mix(vec4(HL_HALF_MAX), l, lessThanEqual(l, vec4(HL_HALF_MAX)))
           : l;
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

/* All four by bilinear weights, as the machine's filter rounds them. */
vec4 hl_filter_light(hl_taps t)
{
    vec2 texel = vec2(1.0 / hl_spec_light_w, 1.0 / hl_spec_light_h);
    return hl_unpack_light(textureLod(hl_tex_light,
                                      t.middle + (t.f - 0.5) * texel, 0.0));
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
    if (hl_spec_light_bits == uint(HL_BITS_UNORM10))
        return vec4(w.x & 1023u, w.x >> 10u & 1023u, w.x >> 20u & 1023u,
                    w.x >> 30u) / vec4(1023.0, 1023.0, 1023.0, 3.0);
    return unpackUnorm4x8(w.x);
}

/* The four texels weighted. Words that a format does not have are not read. */
vec4 hl_weigh_light(vec2 middle, vec4 k)
{
    bool wide = hl_spec_light_bits == uint(HL_BITS_FLOAT);
    bool one = hl_spec_light_bits == uint(HL_BITS_UNORM8) ||
               hl_spec_light_bits == uint(HL_BITS_UNORM10);
    uvec4 zero = uvec4(0u);
    uvec4 r = hl_in_order(textureGather(hl_tex_light, middle, 0));
    uvec4 g = one ? zero : hl_in_order(textureGather(hl_tex_light, middle, 1));
    uvec4 b = wide ? hl_in_order(textureGather(hl_tex_light, middle, 2)) : zero;
    uvec4 a = wide ? hl_in_order(textureGather(hl_tex_light, middle, 3)) : zero;
    return hl_unpack_light(uvec4(r.x, g.x, b.x, a.x)) * k.x +
           hl_unpack_light(uvec4(r.y, g.y, b.y, a.y)) * k.y +
           hl_unpack_light(uvec4(r.z, g.z, b.z, a.z)) * k.z +
           hl_unpack_light(uvec4(r.w, g.w, b.w, a.w)) * k.w;
}
#endif

vec4 hl_fetch_light(ivec2 texel)
{
    return hl_unpack_light(texelFetch(hl_tex_light, texel, 0));
}

/* ---- samples one by one -------------------------------------------------- */

/* The samples that a surface may have: all texels, or those of its pattern,
 * every `side` texels from `cell` on. The pixel lies `f` samples from sample
 * `base`. */
struct hl_lattice { vec2 base, f, cell; float side; };

hl_lattice hl_find_lattice(vec2 cell, float side)
{
    vec2 q = (hl_light_pixel() - cell) / side;
    vec2 b = floor(q);
    return hl_lattice(b, q - b, cell, side);
}

/* Texel of sample base + i; past the borders the outermost sample. The last
 * clamp is for buffers that are smaller than a pattern's block. */
ivec2 hl_texel(hl_lattice g, vec2 i)
{
    vec2 last = vec2(hl_spec_light_w, hl_spec_light_h) - 1.0;
    vec2 most = floor((last - g.cell) / g.side);
    vec2 s = max(min(g.base + i, most), vec2(0.0));
    return ivec2(min(s * g.side + g.cell, last));
}

/* Samples 00, 10, 01, 11 from base + corner on. No index that is computed:
 * software drivers keep an array in memory for one. */
hl_dsf_taps hl_read_quad(hl_lattice g, vec2 corner)
{
    if (g.side == 1.0)
        return hl_read_dsf((g.base + corner + 1.0) /
                           vec2(hl_spec_light_w, hl_spec_light_h));
    vec2 a = hl_fetch_dsf(hl_texel(g, corner));
    vec2 b = hl_fetch_dsf(hl_texel(g, corner + vec2(1.0, 0.0)));
    vec2 c = hl_fetch_dsf(hl_texel(g, corner + vec2(0.0, 1.0)));
    vec2 d = hl_fetch_dsf(hl_texel(g, corner + vec2(1.0, 1.0)));
    return hl_dsf_taps(vec4(a.x, b.x, c.x, d.x), vec4(a.y, b.y, c.y, d.y));
}

/* What is nearer of the surface's own among four more samples. */
void hl_fill_from(inout float nearest, inout vec2 best, hl_lattice g,
                  hl_pixel p, float threshold, vec2 corner)
{
    vec4 a = hl_accept(hl_read_quad(g, corner), p, threshold);
    vec2 u = corner, v = corner + 1.0;
    vec4 d = vec4(hl_fill_distance(u.x, u.y, g.f),
                  hl_fill_distance(v.x, u.y, g.f),
                  hl_fill_distance(u.x, v.y, g.f),
                  hl_fill_distance(v.x, v.y, g.f));
    d = mix(vec4(HL_FILL_NONE), d, greaterThan(a, vec4(0.0)));
    float least = min(min(d.x, d.y), min(d.z, d.w));
    vec2 at = least == d.x ? u : least == d.y ? vec2(v.x, u.y)
              : least == d.z ? vec2(u.x, v.y) : v;
    bool nearer = least < nearest;
    nearest = nearer ? least : nearest;
    best = nearer ? at : best;
}

/* Light for a pixel, which has some already: of a nearer sample where its
 * taps are `lost` (dsf.h). */
vec4 hl_fill_light(hl_lattice g, hl_pixel p, vec4 light, bool lost)
{
    if (!lost)
        return light;
    float threshold = hl_threshold(p, 2.0 * g.side);
    float nearest = HL_FILL_NONE;
    vec2 best = vec2(0.0);
    hl_fill_from(nearest, best, g, p, threshold, vec2(-1.0, -1.0));
    hl_fill_from(nearest, best, g, p, threshold, vec2(1.0, -1.0));
    hl_fill_from(nearest, best, g, p, threshold, vec2(-1.0, 1.0));
    hl_fill_from(nearest, best, g, p, threshold, vec2(1.0, 1.0));
    return nearest < HL_FILL_NONE ? hl_fetch_light(hl_texel(g, best)) : light;
}

bool hl_hidden(hl_pixel p, hl_dsf_taps t, float threshold)
{
    return (hl_spec_fill & uint(HL_FILL_THROUGH)) == 0u &&
           hl_fill_hidden(t.depth * p.step, p.z, threshold);
}

/* Weights b of what is accepted, or of what misses least. */
vec4 hl_lost_weights(vec4 w, vec4 b, hl_pixel p, hl_dsf_taps t, bool lost)
{
    vec4 gap = abs(t.depth * p.step - p.z);
    return lost ? hl_fill_weights(b, gap, p.z) : w;
}

/* ---- surfaces ------------------------------------------------------------ */

vec4 hl_read_opaque(vec4 ids)
{
    hl_taps t = hl_find_taps();
    vec4 b = hl_bilinear(t.f);
    if (hl_spec_dsf == uint(HL_DSF_OFF)) {
#ifdef HL_FLOAT_LIGHT
        if (hl_spec_bilinear != 0u)
            return hl_filter_light(t);
#endif
        return hl_weigh_light(t.middle, b);
    }
    hl_pixel p = hl_look(ids);
    hl_dsf_taps taps = hl_read_dsf(t.middle);
    float threshold = hl_threshold(p, 1.0);
    vec4 a = hl_accept(taps, p, threshold);
#ifdef HL_FLOAT_LIGHT
    if (hl_spec_bilinear != 0u && a == vec4(1.0))
        return hl_filter_light(t);
#endif
    vec4 w = hl_dsf_weights(b, a);
    if (hl_spec_fill == 0u)
        return hl_weigh_light(t.middle, w);
    bool lost = a == vec4(0.0) && !hl_hidden(p, taps, threshold);
    w = hl_lost_weights(w, b, p, taps, lost);
    if ((hl_spec_fill & 1u) == 0u)
        return hl_weigh_light(t.middle, w);
    return hl_fill_light(hl_find_lattice(vec2(0.0), 1.0), p,
                         hl_weigh_light(t.middle, w), lost);
}

vec4 hl_weigh_samples(hl_lattice g, vec4 w)
{
    return hl_fetch_light(hl_texel(g, vec2(0.0, 0.0))) * w.x +
           hl_fetch_light(hl_texel(g, vec2(1.0, 0.0))) * w.y +
           hl_fetch_light(hl_texel(g, vec2(0.0, 1.0))) * w.z +
           hl_fetch_light(hl_texel(g, vec2(1.0, 1.0))) * w.w;
}

/* The four nearest samples of the object's own pattern (K 4). What lies in
 * front may have overwritten some. */
vec4 hl_read_stippled(vec4 ids)
{
    uint pattern = uint(hl_object.flat_ids.z);
    hl_lattice g = hl_find_lattice(hl_stipple_cell(pattern, hl_spec_stipple),
                                   float(hl_spec_stipple));
    bool cone = hl_spec_cone != 0u;
    if (hl_spec_dsf == uint(HL_DSF_OFF))
        return hl_weigh_samples(g, hl_stipple_weights(g.f, vec4(1.0), cone));
    hl_pixel p = hl_look(ids);
    hl_dsf_taps t = hl_read_quad(g, vec2(0.0));
    float threshold = hl_threshold(p, g.side);
    vec4 a = hl_accept(t, p, threshold);
    vec4 w = hl_stipple_weights(g.f, a, cone);
    if (hl_spec_fill == 0u)
        return hl_weigh_samples(g, w);
    bool lost = a == vec4(0.0) && !hl_hidden(p, t, threshold);
    w = hl_lost_weights(w, hl_bilinear(g.f), p, t, lost);
    if ((hl_spec_fill & 1u) == 0u)
        return hl_weigh_samples(g, w);
    return hl_fill_light(g, p, hl_weigh_samples(g, w), lost);
}

/* ids: the varying HL_VARY_IDS as it comes. */
hl_lit hl_read_lights(vec4 ids)
{
    vec4 l;
    if (hl_spec_dsf == uint(HL_DSF_DARK))
        return hl_lit(vec3(0.0), vec3(0.0));
    if (hl_spec_stipple != 0u)
        l = hl_read_stippled(ids);
    else if (hl_spec_dsf == uint(HL_DSF_EXACT))
        l = hl_fetch_light(ivec2(gl_FragCoord.xy));
    else
        l = hl_read_opaque(ids);
    l *= hl_spec_scale;
    return hl_lit(l.rgb, l.rgb * hl_specular_scale(l.rgb, l.a));
}
