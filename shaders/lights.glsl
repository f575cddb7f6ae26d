/* SPDX-License-Identifier: Zlib */
/* Sums over lights, for the light pass and for forward stages. */
#include "shaders/shared/block.h"
#include "shaders/shared/shade.h"

layout(constant_id = HL_SPEC_SPECULAR) const uint hl_spec_specular = 0u;
layout(constant_id = HL_SPEC_FALLOFF) const uint hl_spec_falloff = 1u;
layout(constant_id = HL_SPEC_KINDS) const uint hl_spec_kinds = 0u;
layout(constant_id = HL_SPEC_BATCH) const uint hl_spec_batch = 8u;
layout(constant_id = HL_SPEC_BRDFS) const uint hl_spec_brdfs = 0u;

struct hl_sum {
    vec3 diffuse;    /* D: sum of c a N.L                                    */
    vec3 specular;   /* S / ks in colour                                     */
    float intensity; /* the same with lum(c): the L-buffer's alpha           */
};

/* Of the surface that is lit: what to set before sums where hl_spec_brdfs. */
bool hl_lit_skin = false;

/* One light of hl_light_data layout a, b (and c, d where kinds are mixed)
 * on a surface at view position p with normal n, seen along v. */
void hl_add_light(inout hl_sum s, vec3 p, vec3 n, vec3 v, float exponent,
                  vec4 a, vec4 b, vec4 c, vec4 d)
{
    vec3 to = a.xyz - p;
    float d2 = dot(to, to);
    /* d = 0 gives l = 0, so N.L = 0: such a light adds nothing (to skin what
     * a grazing one adds). */
    vec3 l = to * inversesqrt(max(d2, 1e-20));
    float att;
    if (hl_spec_falloff == 1u)
        att = hl_falloff_smooth(d2, a.w);
    else if (hl_spec_falloff == 2u)
        att = hl_falloff_inverse_square(d2, a.w);
    else
        att = b.w > 0.5 ? hl_falloff_inverse_square(d2, a.w)
                        : hl_falloff_smooth(d2, a.w);
    if (hl_spec_kinds != 0u) {
        bool parallel = d.y > 0.5;
        l = parallel ? -c.xyz : l;
        att = parallel ? 1.0 : att * hl_spot(-dot(l, c.xyz), c.w, d.x);
    }
    float cosine = dot(n, l);
    float ndl = max(cosine, 0.0) * att;
    if (hl_spec_brdfs != 0u)
        s.diffuse += b.xyz * (hl_lit_skin ? hl_diffuse_skin(cosine) * att
                                          : ndl);
    else
        s.diffuse += b.xyz * ndl;
    if (hl_spec_specular != 0u) {
        /* (N.H)^n with H = h / |h|, as ((N.h)^2 / h^2)^(n/2): one division
         * in place of a root and a division. */
        vec3 h = l + v;
        float nh = max(dot(n, h), 0.0);
        float spec = ndl * hl_specular(nh * nh / max(dot(h, h), 1e-20),
                                       exponent * 0.5);
        s.specular += b.xyz * spec;
        s.intensity += hl_luminance(b.xyz) * spec;
    }
}

#ifdef HL_FLAT
/* Lights as flat varyings. Every index is a constant: an indexed varying
 * would be fetched lane by lane, which is what this form avoids. Drivers drop
 * the calls beyond the batch, whose size is compiled in. */
layout(location = 2) flat in vec4 v_light[HL_FLAT_VEC4S];

#define HL_POINT(i) \
    if (i < hl_spec_batch) \
        hl_add_light(s, p, n, v, exponent, v_light[2 * i], \
                     v_light[2 * i + 1], vec4(0.0), vec4(0.0));
#define HL_ANY(i) \
    if (i < hl_spec_batch) \
        hl_add_light(s, p, n, v, exponent, v_light[4 * i], \
                     v_light[4 * i + 1], v_light[4 * i + 2], \
                     v_light[4 * i + 3]);

hl_sum hl_sum_batch(vec3 p, vec3 n, vec3 v, float exponent)
{
    hl_sum s = hl_sum(vec3(0.0), vec3(0.0), 0.0);
    if (hl_spec_kinds != 0u) {
        HL_ANY(0) HL_ANY(1) HL_ANY(2) HL_ANY(3) HL_ANY(4) HL_ANY(5) HL_ANY(6)
    } else {
        HL_POINT(0) HL_POINT(1) HL_POINT(2) HL_POINT(3) HL_POINT(4)
        HL_POINT(5) HL_POINT(6) HL_POINT(7) HL_POINT(8) HL_POINT(9)
        HL_POINT(10) HL_POINT(11) HL_POINT(12) HL_POINT(13)
    }
    return s;
}
#else
/* The lights of uniform slot 3: a fixed number, those not needed are black,
 * so that the trip count is known when the program is made. */
hl_sum hl_sum_batch(vec3 p, vec3 n, vec3 v, float exponent)
{
    hl_sum s = hl_sum(vec3(0.0), vec3(0.0), 0.0);
    for (uint i = 0u; i < hl_spec_batch; i++) {
        if (hl_spec_kinds != 0u) {
            uint k = i * HL_LIGHT_VEC4S;
            hl_add_light(s, p, n, v, exponent, hl_lights.data[k],
                         hl_lights.data[k + 1u], hl_lights.data[k + 2u],
                         hl_lights.data[k + 3u]);
        } else {
            uint k = i * HL_POINT_VEC4S;
            hl_add_light(s, p, n, v, exponent, hl_lights.data[k],
                         hl_lights.data[k + 1u], vec4(0.0), vec4(0.0));
        }
    }
    return s;
}
#endif

#ifdef HL_LISTS
layout(set = 2, binding = HL_SLOT_LIST, std430) readonly buffer hl_list_block {
    vec4 data[];
} hl_list;

/* count lights from element `first` of the list in storage slot 0. */
hl_sum hl_sum_list(vec3 p, vec3 n, vec3 v, float exponent, uint first,
                   uint count)
{
    hl_sum s = hl_sum(vec3(0.0), vec3(0.0), 0.0);
    uint stride = hl_spec_kinds != 0u ? HL_LIGHT_VEC4S : HL_POINT_VEC4S;
    uint k = first;
    for (uint i = 0u; i < count; i++, k += stride) {
        vec4 c = vec4(0.0);
        vec4 d = vec4(0.0);
        if (hl_spec_kinds != 0u) {
            c = hl_list.data[k + 2u];
            d = hl_list.data[k + 3u];
        }
        hl_add_light(s, p, n, v, exponent, hl_list.data[k],
                     hl_list.data[k + 1u], c, d);
    }
    return s;
}
#endif
