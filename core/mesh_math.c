/* SPDX-License-Identifier: Zlib */
/* Reading the caller's floats, their bits as keys, and vectors in double. */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"

#define EXPONENT 0x7F800000u
#define QUIET_NAN 0x7FC00000u
/* Lengths outside have squares that a float cannot hold as normal numbers,
 * so that a shader's normalize would give zero or NaN. */
#define MIN_LENGTH2 1.17549435e-38
#define MAX_LENGTH2 3.40282347e38

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* By bits: holds under -ffast-math of an embedder's build too. */
bool hl_mesh_finite(const float *values, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        if ((bits_of(values[i]) & EXPONENT) == EXPONENT)
            return false;
    return true;
}

void hl_mesh_float_key(uint32_t *key, const float *values, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        uint32_t bits = bits_of(values[i]), magnitude = bits & 0x7FFFFFFFu;
        if (magnitude == 0)
            bits = 0;
        else if (magnitude > EXPONENT)
            bits = QUIET_NAN;
        key[i] = bits;
    }
}

void hl_mesh_key_floats(float *out, const uint32_t *key, uint32_t n)
{
    memcpy(out, key, n * sizeof *out);
}

void hl_mesh_read(float *out, const void *base, size_t stride, uint32_t i,
                  uint32_t n_floats)
{
    memcpy(out, (const unsigned char *)base + stride * i,
           n_floats * sizeof *out);
}

void hl_mesh_edge(double out[3], const float from[3], const float to[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = (double)to[i] - (double)from[i];
}

void hl_mesh_cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

double hl_mesh_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

bool hl_mesh_normalise(double v[3])
{
    double length = sqrt(hl_mesh_dot(v, v));
    if (length == 0)
        return false;
    for (int i = 0; i < 3; i++)
        v[i] /= length;
    return true;
}

void hl_mesh_triangle(const struct hl_mesh_work *work, uint32_t triangle,
                      float out[3][3])
{
    const uint32_t *corner = &work->corner[3 * (size_t)triangle];
    for (int i = 0; i < 3; i++)
        hl_mesh_read(out[i], work->desc.positions, work->desc.position_stride,
                     corner[i], 3);
}

bool hl_mesh_direction(const float v[3])
{
    double length2 = 0;
    if (!hl_mesh_finite(v, 3))
        return false;
    for (int i = 0; i < 3; i++)
        length2 += (double)v[i] * (double)v[i];
    return length2 >= MIN_LENGTH2 && length2 <= MAX_LENGTH2;
}

void hl_mesh_unit_normal(const struct hl_mesh_work *work, uint32_t id,
                         double out[3])
{
    float n[3];
    hl_mesh_key_floats(n, &work->normals.keys[4 * (size_t)id], 3);
    for (int i = 0; i < 3; i++)
        out[i] = (double)n[i];
    (void)hl_mesh_normalise(out);
}
