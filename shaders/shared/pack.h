/* SPDX-License-Identifier: Zlib */
#ifndef HL_PACK_H
#define HL_PACK_H
/* Packing formulas, once for C and GLSL. K = Kircher, Lawrance 2009. */
#include "shaders/shared/lang.h"

/* K eq. 1: unit view-space normal (x right, y up, z to the viewer) to the
 * half-sphere n' = (n + z) / |n + z|, of which x and y are stored. Singular
 * at (0,0,-1), where |n + z| = 0: within 1e-6 of it, and for input that is no
 * direction (zero, NaN, infinite), the result is (0,0), which decodes to
 * (0,0,1). */
HL_FN hl_vec2 hl_normal_encode(hl_vec3 n)
{
    float z = n.z + 1.0f;
    float len2 = n.x * n.x + n.y * n.y + z * z;
    if (len2 > 1e-12f && len2 < 1e12f) {
        float inv = 1.0f / hl_sqrt(len2);
        return hl_v2(n.x * inv, n.y * inv);
    }
    return hl_v2(0.0f, 0.0f);
}

/* K eq. 2 and 3. After quantisation x^2 + y^2 may exceed 1: the paper's
 * square root is then NaN, so it is clamped here; the scale of z keeps
 * |n| = 1 only within the half-sphere. Error of a stored displacement d:
 * at most 2 d / cos(theta / 2) radians (spec/conformance b1). */
HL_FN hl_vec3 hl_normal_decode(hl_vec2 e)
{
    float z = hl_sqrt(hl_max(0.0f, 1.0f - (e.x * e.x + e.y * e.y)));
    return hl_v3(2.0f * z * e.x, 2.0f * z * e.y, 2.0f * z * z - 1.0f);
}

/* A value of -1..1 in a 0..1 (UNORM) channel and back. Zero is not exact:
 * UNORM16 gives it back as 7.6e-6. */
HL_FN float hl_snorm_to_unorm(float x) { return x * 0.5f + 0.5f; }
HL_FN float hl_unorm_to_snorm(float x) { return x * 2.0f - 1.0f; }

/* Linear depth, metres, in a UNORM16 channel; step far / 65535. */
HL_FN float hl_depth_encode(float z, float inv_far)
{
    return hl_clamp01(z * inv_far);
}

/* A region id in a UNORM channel of `steps` = 2^bits - 1: exact, since
 * id / steps is within 2^-24 of a code that is 2^-16 wide. */
HL_FN float hl_id_encode(float id, float inv_steps) { return id * inv_steps; }

/* tangent.w = handedness * (1 + normal group); exact to 2^24 (K 3.1). */
HL_FN float hl_tangent_w_group(float w) { return hl_abs(w) - 1.0f; }
HL_FN float hl_tangent_w_sign(float w) { return w < 0.0f ? -1.0f : 1.0f; }

/* Specular exponent 1..256 in 0..1: log2(n) / 8, so that a step is the same
 * ratio everywhere: UNORM16 8.5e-5, UNORM8 2.2 %. */
HL_FN float hl_exponent_encode(float n) { return hl_log2(n) * 0.125f; }
HL_FN float hl_exponent_decode(float e) { return hl_exp2(e * 8.0f); }

/* 16 bits in two bytes and back, codes 0..65535 as floats; exact. */
HL_FN hl_vec2 hl_split16(float code)
{
    float hi = hl_floor(code * (1.0f / 256.0f));
    return hl_v2(hi, code - hi * 256.0f);
}
HL_FN float hl_join16(hl_vec2 hi_lo) { return hi_lo.x * 256.0f + hi_lo.y; }
#endif
