/* SPDX-License-Identifier: Zlib */
/* How much of a light passes its shadow map. */
#include "shaders/shared/shadow.h"

layout(constant_id = HL_SPEC_MAP_SIZE) const float hl_spec_map_size = 1.0;
layout(constant_id = HL_SPEC_MAP_KIND) const uint hl_spec_map = HL_MAP_CONE;
layout(set = 1, binding = HL_TEX_SHADOW) uniform sampler2D hl_tex_shadow;
layout(set = 0, binding = HL_SLOT_SHADOW, std140) uniform hl_shadow_block {
    mat4 light;
    vec4 map;
    vec4 depth;
    vec4 error;
} hl_shadow;

/* The four texels about a corner, as textureGather orders them. */
vec4 hl_shadow_depths(vec2 uv)
{
    vec4 r = textureGather(hl_tex_shadow, uv, 0);
    if ((hl_spec_map & HL_MAP_BARG) == 0u)
        return r;
    vec4 g = textureGather(hl_tex_shadow, uv, 1);
    vec4 b = textureGather(hl_tex_shadow, uv, 2);
    return vec4(hl_depth_barg(vec3(r.x, g.x, b.x)),
                hl_depth_barg(vec3(r.y, g.y, b.y)),
                hl_depth_barg(vec3(r.z, g.z, b.z)),
                hl_depth_barg(vec3(r.w, g.w, b.w)));
}

/* Weight of the lit ones of 2 x 2 taps; x, y: their columns' and rows'. */
float hl_shadow_quad(vec2 uv, float at, vec2 x, vec2 y)
{
    vec4 d = (hl_shadow_depths(uv) - at) * hl_shadow.map.z;
    vec4 lit = vec4(greaterThanEqual(d, vec4(0.0)));
    return dot(lit, vec4(x.x * y.y, x.y * y.y, x.y * y.x, x.x * y.x));
}

/* Of the point p with normal n in view space: 0 dark to 1 lit. The light's
 * kind is compiled in. */
float hl_shadow_lit(vec3 p, vec3 n)
{
    vec3 q = (hl_shadow.light * vec4(p, 1.0)).xyz;
    vec3 m = mat3(hl_shadow.light) * n;
    float z = -p.z;
    float error = (hl_shadow.error.x * z + hl_shadow.error.y) * z;
    vec3 s = hl_shadow_place(hl_spec_map & 3u, q, m, hl_shadow.map,
                             hl_shadow.depth, error, hl_spec_map_size);
    vec2 low = floor(s.xy - 0.5);
    vec2 f = s.xy - 0.5 - low;
    vec4 x = hl_shadow_weights(f.x);
    vec4 y = hl_shadow_weights(f.y);
    bool six = (hl_spec_map & HL_MAP_SIX) != 0u;
    /* Gathered at corners of texels, where no rounding takes other ones. */
    vec2 texel = vec2(six ? 1.0 / 3.0 : 1.0, six ? 0.5 : 1.0) /
                 hl_spec_map_size;
    vec2 a = low * texel;
    vec2 b = (low + 2.0) * texel;
    return hl_shadow_quad(a, s.z, x.xy, y.xy) +
           hl_shadow_quad(vec2(b.x, a.y), s.z, x.zw, y.xy) +
           hl_shadow_quad(vec2(a.x, b.y), s.z, x.xy, y.zw) +
           hl_shadow_quad(b, s.z, x.zw, y.zw);
}
