/* SPDX-License-Identifier: Zlib */
#include "core/exact.h"
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#define PI 3.14159265358979323846
#define LN2 0.69314718055994530942

/* Taylor series of both for |x| <= pi / 4: the first terms left out are
 * x^19 / 19! < 1e-19 and x^18 / 18! < 3e-18. */
static void sin_cos(double x, double *sine, double *cosine)
{
    double x2 = x * x, s = 1, c = 1;
    for (int k = 17; k > 1; k -= 2)
        s = 1 - s * x2 / (k * (k - 1));
    for (int k = 16; k > 0; k -= 2)
        c = 1 - c * x2 / (k * (k - 1));
    *sine = s * x;
    *cosine = c;
}

double hl_exact_cos(double x)
{
    double s, c, quarters = floor(fabs(x) * (2 / PI) + 0.5);
    sin_cos(fabs(x) - quarters * (PI / 2), &s, &c);
    int q = quarters < 16 ? (int)quarters & 3 : 0;
    return q == 0 ? c : q == 1 ? -s : q == 2 ? -c : s;
}

/* Beyond pi / 4 by the other angle, with the digits of pi / 2 that a double
 * lacks: near the pole they are what is left. */
double hl_exact_tan(double x)
{
    double s, c;
    bool low = x < PI / 4;
    sin_cos(low ? x : PI / 2 - x + 6.123233995736766e-17, &s, &c);
    return low ? s / c : c / s;
}

/* Arc tangent of x / (1 + sqrt(1 - x^2)), doubled; three halvings bring the
 * angle to pi / 32 at most, where the series' first term left out is
 * 0.0985^17 / 17 < 5e-19. */
double hl_exact_asin(double x)
{
    double t = x / (1 + sqrt((1 - x) * (1 + x))), t2, sum = 0;
    for (int i = 0; i < 3; i++)
        t = t / (1 + sqrt(1 + t * t));
    t2 = t * t;
    for (int i = 15; i > 0; i -= 2)
        sum = (i % 4 == 1 ? 1.0 : -1.0) / i + t2 * sum;
    return 16 * t * sum;
}

static double two_to(int n)
{
    uint64_t bits = (uint64_t)(n + 1023) << 52;
    double out;
    memcpy(&out, &bits, sizeof out);
    return out;
}

/* 2^f = e^(f ln 2), f within a half: first term left out 0.347^16 / 16! <
 * 3e-21. */
double hl_exact_exp2(double x)
{
    double whole = floor(x + 0.5), t = (x - whole) * LN2, sum = 1;
    if (!(fabs(x) <= 1000))
        return 0;
    for (int k = 15; k > 0; k--)
        sum = 1 + sum * t / k;
    return sum * two_to((int)whole);
}

/* ln m = 2 atanh s, s = (m - 1) / (m + 1), |s| <= 0.1716 for m from sqrt 1/2
 * to sqrt 2: first term left out s^22 / 23 < 7e-19. */
double hl_exact_log2(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    int e = (int)(bits >> 52 & 2047) - 1023;
    bits = (bits & 0xfffffffffffffu) | (uint64_t)1023 << 52;
    double m;
    memcpy(&m, &bits, sizeof m);
    if (m > 1.41421356237309504880) {
        m *= 0.5;
        e++;
    }
    double s = (m - 1) / (m + 1), s2 = s * s, sum = 0;
    for (int k = 21; k > 0; k -= 2)
        sum = 1.0 / k + s2 * sum;
    return e + s * sum * (2 / LN2);
}
