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
#endif
