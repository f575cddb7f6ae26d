/* SPDX-License-Identifier: Zlib */
/* Measured times. */
#include <stdlib.h>
#include <time.h>
#include "platforms/cli/render.h"

double hlc_now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

struct hlc_quartiles hlc_quartiles_of(double *v, uint32_t n)
{
    qsort(v, n, sizeof *v, by_value);
    return (struct hlc_quartiles){ v[n / 2], v[n / 4], v[n * 3 / 4] };
}

struct hlc_spread hlc_spread_of(double *v, uint32_t n)
{
    struct hlc_spread s = { 0, 0, 0, n };
    if (n == 0)
        return s;
    qsort(v, n, sizeof *v, by_value);
    s.median = n % 2 ? v[n / 2] : (v[n / 2 - 1] + v[n / 2]) / 2;
    s.min = v[0];
    s.max = v[n - 1];
    return s;
}
