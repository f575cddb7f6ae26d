/* SPDX-License-Identifier: Zlib */
#ifndef HL_CONFORM_H
#define HL_CONFORM_H
/* The conformance suite's stage, once for C and GLSL: one operation on one
 * texel of numbers and one of a texture under test, so that a picture is a
 * million cases. Whatever a check is about runs through the text that frames
 * are drawn with (pack.h, dsf.h). */
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"

/* Texture slots. */
#define HL_CONFORM_IN 0         /* numbers, RGBA32_FLOAT                     */
#define HL_CONFORM_STORED 1     /* the texture under test                    */

/* The block in the material slot: op = operation, HL_TWO16_*, step in texels
 * from one layer's input to the next; three vec4 of arguments, and the first
 * layer's offset. A layer is a triangle over the target at depth (w) 1, 2,
 * ...: blending adds up many in one draw. i: input, s: stored. */
#define HL_CONFORM_VEC4S 5
#define HL_OP_AFFINE 0          /* i a + b                                   */
#define HL_OP_STORED 1          /* s as it is sampled                        */
#define HL_OP_NORMAL_ENCODE 2   /* c.x: scale of what is written; c.y: 1
                                 * packs by 255 as many do, 2 swaps bytes    */
#define HL_OP_NORMAL_DECODE 3   /* c.x: scale of what is read                */
#define HL_OP_PACK 4            /* two numbers i.xy; c as above              */
#define HL_OP_UNPACK 5
#define HL_OP_DEPTH_ENCODE 6    /* i.x depth, i.y id; a = 1 / far, 1 / steps */
#define HL_OP_DSF 7             /* i: z, id, slope, texels; a = far, steps;
                                 * b = tau (0: slope), q, k, c               */
#define HL_OP_WEIGHTS 8         /* i.xy fraction, i.z bits of accepted taps  */
#define HL_OP_SAMPLE 9          /* the stored texture, linear, at i.xy       */
#define HL_OP_INDEX 10          /* 8-bit codes of s                          */
#define HL_OP_DIGIT 11          /* two bits of i's four numbers: a.x = 4^k   */
#define HL_OP_BARG 12           /* depth of s's three bytes                  */

/* What else finds its way into four bytes: fract(v 255) and the rest, and
 * the right bytes in the wrong order. */
HL_FN hl_vec4 hl_conform_bytes(float x, float y, float how)
{
    if (how > 1.5f) {
        hl_vec2 a = hl_bytes16_encode(x);
        hl_vec2 b = hl_bytes16_encode(y);
        return hl_v4(a.x, a.y, b.x, b.y);
    }
    float ax = x * 255.0f - hl_floor(x * 255.0f);
    float ay = y * 255.0f - hl_floor(y * 255.0f);
    return hl_v4(ax, x - ax * (1.0f / 255.0f), ay, y - ay * (1.0f / 255.0f));
}

HL_FN hl_vec4 hl_conform_write(uint two16, float x, float y, hl_vec4 c)
{
    hl_vec4 w = hl_two16_encode(two16, x, y);
    if (c.y > 0.5f) {
        w = hl_conform_bytes(x, y, c.y);
        if (two16 == hl_uint(HL_TWO16_BYTES_ARGB))
            w = hl_v4(w.z, w.y, w.x, w.w);
    }
    return hl_v4(w.x * c.x, w.y * c.x, w.z * c.x, w.w * c.x);
}

/* LIDR keeps an index in a byte and finds it by ceil(p 254.5), which no
 * rounding of the byte's value can miss (spec/conformance b4). */
HL_FN float hl_conform_code8(float p)
{
    float x = p * 254.5f;
    float f = hl_floor(x);
    return x > f ? f + 1.0f : f;
}

/* k-th pair of bits of a number below 4^5, as the top pair of a byte. */
HL_FN float hl_conform_digit(float x, float power)
{
    float q = hl_floor(x / power);
    return (q - 4.0f * hl_floor(q * 0.25f)) * (64.0f / 255.0f);
}

HL_FN hl_vec4 hl_conform_dsf(uint two16, hl_vec4 i, hl_vec4 s, hl_vec4 a,
                             hl_vec4 b, hl_vec4 c)
{
    hl_vec2 d = hl_two16_decode(two16, hl_v2(s.x * c.x, s.y * c.x));
    float z = d.x * a.x;
    float id = hl_floor(d.y * a.y + 0.5f);
    float limit = b.x * i.x;
    if (b.x == 0.0f)
        limit = hl_dsf_threshold(b.y, b.z, b.w, i.x, i.z, i.w);
    return hl_v4(hl_dsf_accept(z, id, i.x, i.y, limit, 0.5f), limit, z, id);
}

HL_FN hl_vec4 hl_conform_weights(hl_vec4 i)
{
    float b3 = hl_floor(i.z * 0.125f);
    float b2 = hl_floor(i.z * 0.25f) - 2.0f * b3;
    float b1 = hl_floor(i.z * 0.5f) - 2.0f * b2 - 4.0f * b3;
    float b0 = i.z - 2.0f * b1 - 4.0f * b2 - 8.0f * b3;
    return hl_dsf_weights(hl_bilinear(hl_v2(i.x, i.y)),
                          hl_v4(b0, b1, b2, b3));
}

HL_FN hl_vec4 hl_conform_codes(hl_vec4 s)
{
    return hl_v4(hl_conform_code8(s.x), hl_conform_code8(s.y),
                 hl_conform_code8(s.z), hl_conform_code8(s.w));
}

HL_FN hl_vec4 hl_conform_op(uint op, uint two16, hl_vec4 i, hl_vec4 s,
                            hl_vec4 a, hl_vec4 b, hl_vec4 c)
{
    if (op == hl_uint(HL_OP_AFFINE))
        return hl_v4(i.x * a.x + b.x, i.y * a.y + b.y, i.z * a.z + b.z,
                     i.w * a.w + b.w);
    if (op == hl_uint(HL_OP_NORMAL_ENCODE)) {
        hl_vec2 e = hl_normal_encode(hl_v3(i.x, i.y, i.z));
        return hl_conform_write(two16, hl_snorm_to_unorm(e.x),
                                hl_snorm_to_unorm(e.y), c);
    }
    if (op == hl_uint(HL_OP_NORMAL_DECODE)) {
        hl_vec2 v = hl_two16_decode(two16, hl_v2(s.x * c.x, s.y * c.x));
        hl_vec3 n = hl_normal_decode(hl_v2(hl_unorm_to_snorm(v.x),
                                           hl_unorm_to_snorm(v.y)));
        return hl_v4(n.x, n.y, n.z, 0.0f);
    }
    if (op == hl_uint(HL_OP_PACK))
        return hl_conform_write(two16, i.x, i.y, c);
    if (op == hl_uint(HL_OP_UNPACK)) {
        hl_vec2 v = hl_two16_decode(two16, hl_v2(s.x * c.x, s.y * c.x));
        return hl_v4(v.x, v.y, 0.0f, 1.0f);
    }
    if (op == hl_uint(HL_OP_DEPTH_ENCODE))
        return hl_conform_write(two16, hl_depth_encode(i.x, a.x),
                                hl_id_encode(i.y, a.y), c);
    if (op == hl_uint(HL_OP_DSF))
        return hl_conform_dsf(two16, i, s, a, b, c);
    if (op == hl_uint(HL_OP_WEIGHTS))
        return hl_conform_weights(i);
    if (op == hl_uint(HL_OP_INDEX))
        return hl_conform_codes(s);
    if (op == hl_uint(HL_OP_DIGIT))
        return hl_v4(hl_conform_digit(i.x, a.x), hl_conform_digit(i.y, a.x),
                     hl_conform_digit(i.z, a.x), hl_conform_digit(i.w, a.x));
    if (op == hl_uint(HL_OP_BARG))
        return hl_v4(hl_depth_barg(hl_v3(s.x, s.y, s.z)), s.w, 0.0f, 1.0f);
    return s;
}
#endif
