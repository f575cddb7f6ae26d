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

/* A region id in a channel of `steps` steps from 0 to 1: exact, since
 * id / steps is within 2^-24 of a code that is 2^-16 wide. A UNORM channel
 * has 2^bits - 1 steps. Signed ones have 65,534 from -1 to 1, so that with
 * 65,535 two ids would share the code of zero (spec/consoles 1.5). */
HL_FN float hl_id_encode(float id, float inv_steps) { return id * inv_steps; }

/* tangent.w = handedness * (1 + normal group); exact to 2^24 (K 3.1). */
HL_FN float hl_tangent_w_group(float w) { return hl_abs(w) - 1.0f; }
HL_FN float hl_tangent_w_sign(float w) { return w < 0.0f ? -1.0f : 1.0f; }

/* Specular exponent 1..256 in 0..1: log2(n) / 8, so that a step is the same
 * ratio everywhere: UNORM16 8.5e-5, UNORM8 2.2 %. */
HL_FN float hl_exponent_encode(float n) { return hl_log2(n) * 0.125f; }
HL_FN float hl_exponent_decode(float e) { return hl_exp2(e * 8.0f); }

/* A BRDF's index, 0..255, as the second number of a pair, and back: exact,
 * since pairs keep numbers within 2^-15. */
HL_FN float hl_brdf_encode(float brdf) { return brdf * (1.0f / 255.0f); }
HL_FN float hl_brdf_decode(float y) { return hl_floor(y * 255.0f + 0.5f); }

/* Screen motion along one axis, a difference of clip x / w or y / w (2 is
 * the whole screen), cut to -1..1, as one number of a pair, and back. No
 * motion comes back as exactly 0, whichever of UNORM16's two codes beside 1 / 2
 * was stored: so the error is up to 2 / 65535 there, else half of that. */
HL_FN float hl_motion_encode(float m)
{
    return 0.5f * hl_min(hl_max(m, -1.0f), 1.0f) + 0.5f;
}
HL_FN float hl_motion_decode(float x)
{
    float m = x * 2.0f - 1.0f;
    return hl_abs(m) < 2e-5f ? 0.0f : m;
}

/* 16 bits in two bytes and back, codes 0..65535 as floats; exact. */
HL_FN hl_vec2 hl_split16(float code)
{
    float hi = hl_floor(code * (1.0f / 256.0f));
    return hl_v2(hi, code - hi * 256.0f);
}
HL_FN float hl_join16(hl_vec2 hi_lo) { return hi_lo.x * 256.0f + hi_lo.y; }

/* How two 16-bit numbers of 0..1 lie in a colour target (K 5). Machines
 * without a target of two UNORM16 channels have one of these, each read back
 * as two numbers by hl_two16_decode. */
#define HL_TWO16_UNORM 0      /* RG16_UNORM as it is                         */
#define HL_TWO16_SIGNED 1     /* 2v - 1, read as s / 2 + 1 / 2               */
#define HL_TWO16_FIXED32 2    /* 64v - 32, resolved by 2^-5, read as above   */
#define HL_TWO16_BYTES 3      /* four bytes, low first: little-endian RG16   */
#define HL_TWO16_BYTES_ARGB 4 /* Y16_X16 in A8R8G8B8 words (PlayStation 3)   */

/* A number of 0..1 as the two bytes of its 16-bit code, high first, each as
 * the UNORM8 value that stores it. Clamped before it is split: bytes of a
 * number that is out of range would not saturate. */
HL_FN hl_vec2 hl_bytes16_encode(float v)
{
    hl_vec2 b = hl_split16(hl_floor(hl_clamp01(v) * 65535.0f + 0.5f));
    return hl_v2(b.x * (1.0f / 255.0f), b.y * (1.0f / 255.0f));
}

/* What the stage writes. FIXED32: the whole range of -32..32 is used, as the
 * machine's fixed point keeps 10 bits of fraction (K 5.1; spec/consoles 1.5).
 * BYTES_ARGB: a word's bytes lie in memory as A R G B, so that A R are y and
 * G B are x (K 5.2; spec/consoles 2.4). */
HL_FN hl_vec4 hl_two16_encode(uint mode, float x, float y)
{
    if (mode == hl_uint(HL_TWO16_SIGNED))
        return hl_v4(2.0f * x - 1.0f, 2.0f * y - 1.0f, 0.0f, 1.0f);
    if (mode == hl_uint(HL_TWO16_FIXED32))
        return hl_v4(64.0f * x - 32.0f, 64.0f * y - 32.0f, 0.0f, 1.0f);
    if (mode == hl_uint(HL_TWO16_BYTES) ||
        mode == hl_uint(HL_TWO16_BYTES_ARGB)) {
        hl_vec2 a = hl_bytes16_encode(x);
        hl_vec2 b = hl_bytes16_encode(y);
        if (mode == hl_uint(HL_TWO16_BYTES))
            return hl_v4(a.y, a.x, b.y, b.x);
        return hl_v4(b.y, a.x, a.y, b.x);
    }
    return hl_v4(x, y, 0.0f, 1.0f);
}

/* Both numbers from what is sampled: signed ones for SIGNED and FIXED32, in
 * which 1 / 2 is exact, UNORM16 for all others. */
HL_FN hl_vec2 hl_two16_decode(uint mode, hl_vec2 s)
{
    if (mode == hl_uint(HL_TWO16_SIGNED) || mode == hl_uint(HL_TWO16_FIXED32))
        return hl_v2(0.5f * s.x + 0.5f, 0.5f * s.y + 0.5f);
    return s;
}

/* Depth of a D24S8 word read as colour with the remap that gives its bytes
 * as rgb, high first (K 5.2). The bytes are rounded and joined as integers,
 * which are exact below 2^24: a dot product with the bytes' weights is up to
 * two steps off and exceeds 1 (spec/consoles 2.5). */
HL_FN float hl_depth_barg(hl_vec3 c)
{
    float hi = hl_floor(c.x * 255.0f + 0.5f);
    float mid = hl_floor(c.y * 255.0f + 0.5f);
    float lo = hl_floor(c.z * 255.0f + 0.5f);
    return (hi * 65536.0f + mid * 256.0f + lo) / 16777215.0f;
}
#endif
