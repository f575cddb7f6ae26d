/* SPDX-License-Identifier: Zlib */
#ifndef PE_MATH_H
#define PE_MATH_H
/* Elementary functions of the kernels: branch-free, of + - *, compares and
 * integer operations alone, so that a compiler vectorises loops of them for
 * any machine and every machine gives the same bits. Build without
 * contraction and reassociation. Polynomials: minimax by Remez. */
#include <math.h>
#include <stdint.h>

#if defined(__i386__) && !defined(__SSE2_MATH__)
#error "x87 does not round to float: build with -msse2 -mfpmath=sse"
#endif

static inline uint32_t pe_bits(float x)
{
    union { float f; uint32_t u; } v;
    v.f = x;
    return v.u;
}

static inline float pe_float(uint32_t bits)
{
    union { uint32_t u; float f; } v;
    v.u = bits;
    return v.f;
}

/* Every float, also NaN and infinities. Adding 2^23 rounds to an integer,
 * since a float has no fraction bits there; no conversion to int, which
 * would be undefined for large numbers. */
static inline float pe_floor(float x)
{
    float a = fabsf(x);
    float r = (a + 8388608.0f) - 8388608.0f;
    r = pe_float(pe_bits(r) | (pe_bits(x) & 0x80000000u));
    r = r > x ? r - 1.0f : r;
    return a < 8388608.0f ? r : x;
}

/* Polynomials are summed in pairs (Estrin), which takes half the time of a
 * chain: loops of these functions wait for results, not for units. */

/* Integers that a host's blocks carry as floats, whatever these are: a
 * conversion out of range would be undefined, and differ by processor. Pixels
 * and tiles fit 15 bits, and their products an int32_t; counts and places of
 * lists are exact to 2^24. */
static inline int32_t pe_int(float x)
{
    x = x > -32768.0f ? x : -32768.0f;
    return (int32_t)(x < 32767.0f ? x : 32767.0f);
}
static inline uint32_t pe_uint(float x)
{
    x = x > 0.0f ? x : 0.0f;
    return (uint32_t)(x < 16777216.0f ? x : 16777216.0f);
}

/* 2^x for -126 <= x < 127.4 within 2 ulp; 0 from -126.5 down (and of NaN).
 * 1.5 * 2^23 leaves round(x) in the low bits of the sum; -127 there makes a
 * factor of zero. */
static inline float pe_exp2_below(float x)
{
    float y = x > -127.0f ? x : -127.0f;
    float sum = y + 12582912.0f;
    float f = y - (sum - 12582912.0f), f2 = f * f;
    float a = 0.6931471824645996f * f + 1.0f;
    float b = 0.055503323674201965f * f + 0.24022647738456726f;
    float c = 0.0013398873852565885f * f + 0.00961843691766262f;
    float d = 0.00015353367780335248f * f2 + c;
    return (a + f2 * (b + f2 * d)) *
           pe_float((pe_bits(sum) << 23) + 0x3f800000u);
}

/* About 2^127.4 above. */
static inline float pe_exp2(float x)
{
    return pe_exp2_below(x > 127.4f ? 127.4f : x);
}

/* log2 of a positive normal number, within 3 ulp, exact at powers of two.
 * -127 of 0; negative and denormal numbers give some finite number. The
 * mantissa is taken from sqrt(1/2) to sqrt(2), so that the result is
 * relatively exact about 1. */
static inline float pe_log2(float x)
{
    uint32_t u = pe_bits(x) + (0x3f800000u - 0x3f3504f3u);
    float e = (float)((int32_t)(u >> 23) - 127);
    float t = pe_float((u & 0x7fffffu) + 0x3f3504f3u) - 1.0f;
    float t2 = t * t, t4 = t2 * t2;
    float a = 0.48091062903404236f * t - 0.7213473320007324f;
    float b = 0.28791624307632446f * t - 0.3607036769390106f;
    float c = 0.21571555733680725f * t - 0.23894482851028442f;
    float d = 0.125837042927742f * t - 0.20726966857910156f;
    float r = (a + b * t2) + (c + d * t2) * t4;
    return e + (1.4426950216293335f * t + r * t2);
}

/* x^n for x from 0 to 1 and a little more (n log2 x < 127), n > 0; 0 for
 * denormal x and below. The product n log2 x is rounded, so that the relative
 * error is up to 2.5 (2 + |n log2 x|) ulp; but where that is much the result
 * is small: of x <= 1 none is 2^-23 off. */
static inline float pe_pow(float x, float n)
{
    float r = pe_exp2_below(n * pe_log2(x));
    return x >= 1.17549435e-38f ? r : 0.0f;
}

/* shaders/shared/lang.h's words, where it asks for them. */
#ifdef HL_LANG_MATH
#define hl_sqrt(x) sqrtf(x)
#define hl_floor(x) pe_floor(x)
#define hl_abs(x) fabsf(x)
#define hl_pow(a, b) pe_pow(a, b)
#define hl_exp2(x) pe_exp2(x)
#define hl_log2(x) pe_log2(x)
#endif
#endif
