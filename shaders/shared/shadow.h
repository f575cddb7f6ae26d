/* SPDX-License-Identifier: Zlib */
#ifndef HL_SHADOW_H
#define HL_SHADOW_H
/* Shadow maps: where on a map a surface point falls and what depth it is
 * compared with. Light space has the light at 0 (parallel light: the middle of
 * the map), c the axis that is looked along, a and b across it, all
 * right-handed. A map of `side` texels shows slopes a / c (parallel: a) about
 * its middle; six of them stand in 3 columns and 2 rows.
 *
 * The filter is 3 x 3 texels, weighted bilinearly: 4 x 4 taps at texel
 * centres, up to K = 2 texels off on each axis. Points are lifted along their
 * normal n first. A plane through a point at depth c, lifted by h, is in front
 * of itself at all taps when
 *     h >= c t K (|n.a| + |n.b|),  t = 1 texel as a slope,
 * in perspective and in parallel light, at any angle: with n.p = -d the tap of
 * direction r + e sees the plane at c' = d / -(n.(r + e)), and the lifted
 * point lies at (d - h) / -(n.r). Half a texel more is for what is not a
 * plane: normals up to atan(1/2 / (2 sqrt 2)) = 10 degrees off the surface,
 * and depth that is stored in steps. So no shadow begins nearer to its caster
 * than 2 sqrt 2 + 1/2 = 3.33 texels, nor is one lost farther than that. */
#include "shaders/shared/block.h"

#define HL_SHADOW_KERNEL 2.0f   /* K                                         */
#define HL_SHADOW_LIFT 0.5f     /* texels, always                            */
/* Texels at a map's edge: K, and up to 4 by which a lifted point leaves the
 * part of the map that is its own (the largest of (2 (|n.a| + |n.b|) + 1/2)
 * (n.a - n.c) is 3.7 at slope 1). So taps stay on their own map. */
#define HL_SHADOW_BORDER 6.0f

/* Face 0..5 of +x -x +y -y +z -z that sees q: each direction has one. */
HL_FN float hl_shadow_face(hl_vec3 q)
{
    float x = hl_abs(q.x);
    float y = hl_abs(q.y);
    float z = hl_abs(q.z);
    if (x >= y && x >= z)
        return q.x >= 0.0f ? 0.0f : 1.0f;
    if (y >= z)
        return q.y >= 0.0f ? 2.0f : 3.0f;
    return q.z >= 0.0f ? 4.0f : 5.0f;
}

/* a, b, c of a face. */
HL_FN hl_vec3 hl_shadow_turn(float face, hl_vec3 v)
{
    float s = 1.0f;
    hl_vec3 t = v;
    if (face < 1.5f)
        t = hl_v3(v.y, v.z, v.x);
    else if (face < 3.5f)
        t = hl_v3(v.z, v.x, v.y);
    if (face == 1.0f || face == 3.0f || face == 5.0f)
        s = -1.0f;
    return hl_v3(t.x * s, t.y, t.z * s);
}

/* Texels from the left and top of all maps to the middle of the filter, and
 * the depth to compare with. kind: HL_MAP_* of block.h; q, n: point and unit
 * normal in light space; map, depth: of hl_shadow_block; error: metres more to
 * lift. */
HL_FN hl_vec3 hl_shadow_place(uint kind, hl_vec3 q, hl_vec3 n, hl_vec4 map,
                              hl_vec4 depth, float error, float side)
{
    float face = 0.0f;
    bool parallel = kind == HL_MAP_PARALLEL;
    if (kind == HL_MAP_POINT) {
        face = hl_shadow_face(q);
        q = hl_shadow_turn(face, q);
        n = hl_shadow_turn(face, n);
    }
    float c = parallel ? 1.0f : hl_max(q.z, depth.z);
    float lift = (HL_SHADOW_KERNEL * (hl_abs(n.x) + hl_abs(n.y)) +
                  HL_SHADOW_LIFT) * c * map.y + error;
    q = hl_add3(q, hl_scale3(n, lift));
    c = parallel ? 1.0f : hl_max(q.z, depth.z);
    float scale = map.x / c;
    float least = HL_SHADOW_KERNEL;
    float most = side - HL_SHADOW_KERNEL;
    float x = hl_min(hl_max(q.x * scale + side * 0.5f, least), most);
    float y = hl_min(hl_max(q.y * scale + side * 0.5f, least), most);
    float row = face > 2.5f ? 1.0f : 0.0f;
    float d = parallel ? depth.x * q.z + depth.y : depth.x / c + depth.y;
    return hl_v3(x + (face - row * 3.0f) * side, y + row * side,
                 hl_clamp01(d));
}

/* Of the four taps of an axis from texel floor(x - 1/2) - 1 on, f being what
 * is left of x - 1/2. */
HL_FN hl_vec4 hl_shadow_weights(float f)
{
    float third = 1.0f / 3.0f;
    return hl_v4((1.0f - f) * third, third, third, f * third);
}
#endif
