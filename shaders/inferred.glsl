/* SPDX-License-Identifier: Zlib */
/* How a material pass reads its lighting: include this in a fragment stage
 * (also one of an embedder's own) and call hl_read_lights(id). Uses texture
 * slots 0 and 1 and uniform slots 0 and 1; define HL_OWN_MATERIAL_BLOCK
 * first to lay out uniform slot 2 yourself. */
#include "shaders/shared/block.h"
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"

layout(constant_id = HL_SPEC_DSF) const uint hl_spec_dsf = 1u;
layout(set = 1, binding = HL_TEX_LIGHT) uniform sampler2D hl_tex_light;
layout(set = 1, binding = HL_TEX_DSF) uniform sampler2D hl_tex_dsf;

/* D of the light model (without ambient), and the factor that turns a
 * surface's ks into its specular light: S ks = specular * ks. */
struct hl_lit { vec3 diffuse; vec3 specular; };

struct hl_taps { ivec2 base, last; vec2 f; };

hl_taps hl_find_taps()
{
    vec2 p = gl_FragCoord.xy * hl_frame.light_size.zw - 0.5;
    vec2 b = floor(p);
    return hl_taps(ivec2(b), ivec2(hl_frame.light_size.xy) - 1, p - b);
}

ivec2 hl_tap(hl_taps t, int x, int y)
{
    return clamp(t.base + ivec2(x, y), ivec2(0), t.last);
}

/* Acceptance, 0 or 1, of taps 00, 10, 01, 11 for region id. */
vec4 hl_accept_taps(hl_taps t, float id)
{
    float z = 1.0 / gl_FragCoord.w;
    float threshold = hl_frame.dsf_id.z * z;
    if (hl_spec_dsf == uint(HL_DSF_SLOPE)) {
        /* Pixels to L texels: an L texel spans 1 / light_size.zw pixels. */
        float slope = abs(dFdx(z)) / hl_frame.light_size.z +
                      abs(dFdy(z)) / hl_frame.light_size.w;
        threshold = hl_dsf_threshold(hl_frame.dsf.x, hl_frame.dsf.y,
                                     hl_frame.dsf.z, z, slope, hl_frame.dsf.w);
    }
    vec2 a = texelFetch(hl_tex_dsf, hl_tap(t, 0, 0), 0).xy;
    vec2 b = texelFetch(hl_tex_dsf, hl_tap(t, 1, 0), 0).xy;
    vec2 c = texelFetch(hl_tex_dsf, hl_tap(t, 0, 1), 0).xy;
    vec2 d = texelFetch(hl_tex_dsf, hl_tap(t, 1, 1), 0).xy;
    float i = hl_id_encode(id, hl_frame.dsf_id.x);
    float h = hl_frame.dsf_id.y;
    float far = hl_frame.depth.w;
    return vec4(hl_dsf_accept(a.x * far, a.y, z, i, threshold, h),
                hl_dsf_accept(b.x * far, b.y, z, i, threshold, h),
                hl_dsf_accept(c.x * far, c.y, z, i, threshold, h),
                hl_dsf_accept(d.x * far, d.y, z, i, threshold, h));
}

/* id: the stored id of the surface's region, hl_object.ids.x + its group. */
hl_lit hl_read_lights(float id)
{
    vec4 l;
    if (hl_spec_dsf == uint(HL_DSF_EXACT)) {
        l = texelFetch(hl_tex_light, ivec2(gl_FragCoord.xy), 0);
    } else {
        hl_taps t = hl_find_taps();
        vec4 w = hl_bilinear(t.f);
        if (hl_spec_dsf != uint(HL_DSF_OFF))
            w = hl_dsf_weights(w, hl_accept_taps(t, id));
        l = texelFetch(hl_tex_light, hl_tap(t, 0, 0), 0) * w.x +
            texelFetch(hl_tex_light, hl_tap(t, 1, 0), 0) * w.y +
            texelFetch(hl_tex_light, hl_tap(t, 0, 1), 0) * w.z +
            texelFetch(hl_tex_light, hl_tap(t, 1, 1), 0) * w.w;
    }
    l *= hl_frame.ambient.w;
    return hl_lit(l.rgb, l.rgb * hl_specular_scale(l.rgb, l.a));
}
