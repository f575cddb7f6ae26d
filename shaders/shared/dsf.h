/* SPDX-License-Identifier: Zlib */
#ifndef HL_DSF_H
#define HL_DSF_H
/* Discontinuity sensitive filter (K 3). The paper's threshold is one
 * adjustable number, which rejects tilted surfaces from 75 degrees on
 * (tau 1 %, 450 lines); scaling it by the surface's slope does not. */
#include "shaders/shared/lang.h"

/* Depth threshold in metres. q: one step of the stored depth; slope:
 * |dz/dx| + |dz/dy| in metres a texel of the L-buffer; distance: of the
 * taps, in texels; c: share of the depth z. k = 1.1
 * is what perspective asks for at 88 degrees (z p tan a / (1 - p tan a) with
 * 450 lines) with nothing to spare: 4 of 200,000 random planes were rejected
 * falsely; with the planner's 1.5 none. */
HL_FN float hl_dsf_threshold(float q, float k, float c, float z, float slope,
                             float distance_texels)
{
    return q + k * distance_texels * slope + c * z;
}

/* 1 where a tap belongs to the surface, else 0. Depths in metres, ids as
 * codes or as stored; half_step: half of one id in that unit. */
HL_FN float hl_dsf_accept(float tap_z, float tap_id, float z, float id,
                          float threshold, float half_step)
{
    return hl_abs(tap_z - z) <= threshold && hl_abs(tap_id - id) < half_step
           ? 1.0f : 0.0f;
}

/* Half of one id, in codes, for hl_dsf_accept: region 0 takes taps of any
 * region, since decals lie on surfaces of others. */
HL_FN float hl_dsf_half_step(float id)
{
    return id == 0.0f ? 65536.0f : 0.5f;
}

/* Bilinear weights of taps 00, 10, 01, 11 at fraction f. */
HL_FN hl_vec4 hl_bilinear(hl_vec2 f)
{
    float gx = 1.0f - f.x;
    float gy = 1.0f - f.y;
    return hl_v4(gx * gy, f.x * gy, gx * f.y, f.x * f.y);
}

/* Below this sum the accepted taps' weights "sum to nothing": it is under
 * half a step of 8-bit output for any L-buffer contrast below 1000 : 1. */
#define HL_DSF_NOTHING 1e-6f

/* Filter weights from bilinear weights b and acceptance a (each 0 or 1):
 * accepted weights renormalised; the nearest accepted tap when they sum to
 * nothing; plain bilinear when none is accepted (K 3). Sums to 1. */
HL_FN hl_vec4 hl_dsf_weights(hl_vec4 b, hl_vec4 a)
{
    hl_vec4 w = hl_v4(b.x * a.x, b.y * a.y, b.z * a.z, b.w * a.w);
    float sum = w.x + w.y + w.z + w.w;
    if (sum > HL_DSF_NOTHING) {
        float inv = 1.0f / sum;
        return hl_v4(w.x * inv, w.y * inv, w.z * inv, w.w * inv);
    }
    if (a.x + a.y + a.z + a.w == 0.0f)
        return b;
    /* The order of bilinear weights is the order of nearness. */
    float best = hl_max(hl_max((b.x + 1.0f) * a.x, (b.y + 1.0f) * a.y),
                        hl_max((b.z + 1.0f) * a.z, (b.w + 1.0f) * a.w));
    if ((b.x + 1.0f) * a.x == best)
        return hl_v4(1.0f, 0.0f, 0.0f, 0.0f);
    if ((b.y + 1.0f) * a.y == best)
        return hl_v4(0.0f, 1.0f, 0.0f, 0.0f);
    if ((b.z + 1.0f) * a.z == best)
        return hl_v4(0.0f, 0.0f, 1.0f, 0.0f);
    return hl_v4(0.0f, 0.0f, 0.0f, 1.0f);
}

/* ---- samples of a stipple pattern (K 4) ---------------------------------- */

/* Radius of the cone, in distances between samples of a pattern. Above 1 taps
 * enter and leave with a jump; below 0.71 the middle of a cell has no tap at
 * all. Of radii from 0.75 to 1.6 those of 1 and 1.1 give the least errors
 * against ray traced frames (blades and glass, both patterns, 0.02 dB between
 * the two; 0.75 and 1.6 are 0.2 to 0.4 dB worse). */
#define HL_CONE_RADIUS 1.0f

HL_FN float hl_cone(float x, float y)
{
    return hl_max(1.0f - hl_sqrt(x * x + y * y) * (1.0f / HL_CONE_RADIUS),
                  0.0f);
}

/* Cone weights of taps 00, 10, 01, 11 at fraction f; their sum is no 1. */
HL_FN hl_vec4 hl_cones(hl_vec2 f)
{
    float gx = 1.0f - f.x;
    float gy = 1.0f - f.y;
    return hl_v4(hl_cone(f.x, f.y), hl_cone(gx, f.y), hl_cone(f.x, gy),
                 hl_cone(gx, gy));
}

/* As hl_dsf_weights. Outside of all accepted cones, and where none is
 * accepted, bilinear weights serve. */
HL_FN hl_vec4 hl_stipple_weights(hl_vec2 f, hl_vec4 a, bool cone)
{
    hl_vec4 c = hl_cones(f);
    float sum = c.x * a.x + c.y * a.y + c.z * a.z + c.w * a.w;
    if (cone && sum > HL_DSF_NOTHING)
        return hl_dsf_weights(c, a);
    return hl_dsf_weights(hl_bilinear(f), a);
}

/* ---- where all four are rejected ----------------------------------------- */

/* A surface narrower than a texel may have no sample among the four, but one
 * a little farther: the twelve around them are looked at, and the nearest
 * that is accepted is taken. They lie within two texels of the pixel on
 * either axis. Without one the four count by their nearness in depth too:
 * light of a surface at another depth is light of another place. */

/* A fragment all of whose taps lie before it is most often one that is drawn
 * over later: nothing is looked for there (a third of the fragments of fig8;
 * what shows through gaps narrower than a texel is bilinear). */
HL_FN bool hl_fill_hidden(hl_vec4 tap_z, float z, float threshold)
{
    return hl_max(hl_max(tap_z.x, tap_z.y), hl_max(tap_z.z, tap_z.w)) <
           z - threshold;
}

/* What no texel has. */
#define HL_FILL_NONE 1e9f

/* Squared distance, in texels, of the texel (x, y), each -1, 0, 1 or 2 from
 * tap 00, to the pixel at fraction f; NONE for the four themselves. */
HL_FN float hl_fill_distance(float x, float y, hl_vec2 f)
{
    float dx = x - f.x;
    float dy = y - f.y;
    bool inner = x >= 0.0f && x <= 1.0f && y >= 0.0f && y <= 1.0f;
    return inner ? HL_FILL_NONE : dx * dx + dy * dy;
}

/* Share of the pixel's depth by which a tap may miss it and count a half.
 * Where 0.02 made more error and 0.3 less difference to bilinear light, on
 * the scenes thin and fig9 (tests/bench_flicker.c). */
#define HL_FILL_MISS 0.1f

/* Weights of four taps that are all rejected: bilinear weights b over the
 * distances in depth, gap, from the pixel at z. None jumps in or out as the
 * pixel moves. Sums to 1. */
HL_FN hl_vec4 hl_fill_weights(hl_vec4 b, hl_vec4 gap, float z)
{
    float m = HL_FILL_MISS * z;
    float x = (b.x + 0.001f) / (gap.x + m);
    float y = (b.y + 0.001f) / (gap.y + m);
    float u = (b.z + 0.001f) / (gap.z + m);
    float v = (b.w + 0.001f) / (gap.w + m);
    float inv = 1.0f / (x + y + u + v);
    return hl_v4(x * inv, y * inv, u * inv, v * inv);
}
#endif
