/* SPDX-License-Identifier: Zlib */
/* What formats store, in double precision or in the arithmetic that their
 * specification states (spec/consoles). */
#include <string.h>
#include "platforms/conform/cf.h"

const struct cf_float cf_half = { 11, -14, 65504.0 };
const struct cf_float cf_float11 = { 7, -14, 65024.0 };
const struct cf_float cf_float10 = { 6, -14, 64512.0 };
const struct cf_float cf_7e3 = { 8, -2, 31.875 };

double cf_whole(double x, enum cf_round round)
{
    double f = floor(x), r = x - f;
    if (round == CF_TRUNCATE)
        return f;
    if (r != 0.5)
        return r > 0.5 ? f + 1 : f;
    return round == CF_NEAREST_UP || fmod(f, 2.0) != 0 ? f + 1 : f;
}

double cf_float_store(const struct cf_float *f, double x, enum cf_round round)
{
    int e;
    if (!(x > 0))
        return 0;
    frexp(x, &e);            /* x = m 2^e, m in [1/2, 1)                     */
    if (e - 1 < f->min_exp)
        e = f->min_exp + 1;
    double y = ldexp(cf_whole(ldexp(x, f->bits - e), round), e - f->bits);
    return y > f->max ? f->max : y;
}

double cf_half_value(uint16_t h)
{
    int e = h >> 10 & 31;
    double m = (double)(h & 1023);
    double x = e == 31 ? (m > 0 ? (double)NAN : (double)INFINITY)
               : e ? ldexp(1024 + m, e - 25) : ldexp(m, -24);
    return h & 0x8000 ? -x : x;
}

/* splitmix64 (Steele, Lea, Flood 2014). */
uint64_t cf_random(struct cf *cf)
{
    uint64_t z = cf->seed += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

double cf_unit(struct cf *cf)
{
    return ldexp((double)(cf_random(cf) >> 11), -53);
}

int32_t cf_fixed32_encode(float v)
{
    if (v != v)
        return 0;
    v = v < -32.0f ? -32.0f : v > 32.0f ? 32.0f : v;
    float t = v * 1023.96875f;
    return (int32_t)(t + (t < 0 ? -0.5f : 0.5f));
}

float cf_fixed32_decode(int32_t code)
{
    return (float)code * (32.0f / 32767.0f);
}

uint32_t cf_d24(float z)
{
    z = z > 0.0f ? z < 1.0f ? z : 1.0f : 0.0f;
    return (uint32_t)cf_whole((double)(z * 16777215.0f), CF_NEAREST_EVEN);
}

uint32_t cf_20e4(float z, bool nearest)
{
    uint32_t u;
    memcpy(&u, &z, sizeof u);
    if (!(z > 0.0f))
        return 0;
    if (u >= 0x3ffffff8u)
        return 0xffffff;
    if (u < 0x38800000u) {
        uint32_t shift = 113 - (u >> 23);
        u = (0x800000u | (u & 0x7fffff)) >> (shift < 24 ? shift : 24);
    } else {
        u -= 0x38000000u;
    }
    if (nearest)
        u += 3 + (u >> 3 & 1);
    return u >> 3 & 0xffffff;
}

float cf_20e4_value(uint32_t code)
{
    uint32_t e = code >> 20 & 15, m = code & 0xfffff;
    return e ? ldexpf((float)(0x100000 | m), (int)e - 35)
             : ldexpf((float)m, -34);
}

float cf_7e3_value(uint32_t code)
{
    uint32_t e = code >> 7 & 7, m = code & 127;
    return e ? ldexpf((float)(128 | m), (int)e - 10) : ldexpf((float)m, -9);
}
