/* SPDX-License-Identifier: Zlib */
#ifndef HL_VEC_H
#define HL_VEC_H
/* The few vector and matrix functions that core needs on the host. Matrices
 * are column-major, m[column * 4 + row], column vectors. */
#include "shaders/shared/lang.h"

static inline hl_vec3 hl_load3(const float *p)
{ return hl_v3(p[0], p[1], p[2]); }
static inline hl_vec3 hl_sub3(hl_vec3 a, hl_vec3 b)
{ return hl_v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline hl_vec3 hl_cross3(hl_vec3 a, hl_vec3 b)
{
    return hl_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                 a.x * b.y - a.y * b.x);
}
static inline float hl_length3(hl_vec3 a) { return sqrtf(hl_dot3(a, a)); }
/* Zero stays zero. */
static inline hl_vec3 hl_normalize3(hl_vec3 a)
{
    float l = hl_length3(a);
    return l > 0.0f ? hl_scale3(a, 1.0f / l) : a;
}
static inline hl_vec3 hl_transform_point(const float m[16], hl_vec3 p)
{
    return hl_v3(m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
                 m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
                 m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]);
}
static inline hl_vec3 hl_transform_dir(const float m[16], hl_vec3 v)
{
    return hl_v3(m[0] * v.x + m[4] * v.y + m[8] * v.z,
                 m[1] * v.x + m[5] * v.y + m[9] * v.z,
                 m[2] * v.x + m[6] * v.y + m[10] * v.z);
}
/* out = a b; out may be neither. Summed in double: the product of a camera
 * and a world matrix far from the origin loses digits in float. */
static inline void hl_mul4(float out[16], const float a[16], const float b[16])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++) {
            double s = 0;
            for (int k = 0; k < 4; k++)
                s += (double)a[k * 4 + r] * (double)b[c * 4 + k];
            out[c * 4 + r] = (float)s;
        }
}
static inline float hl_det3(const float m[16])
{
    return hl_dot3(hl_load3(m), hl_cross3(hl_load3(m + 4), hl_load3(m + 8)));
}
/* Cofactor matrix of the upper 3 x 3, which carries normals: the inverse
 * transpose times the determinant, so defined for singular matrices too. */
static inline void hl_cofactor3(float out[16], const float m[16])
{
    hl_vec3 a = hl_load3(m), b = hl_load3(m + 4), c = hl_load3(m + 8);
    float s = hl_det3(m) < 0.0f ? -1.0f : 1.0f;
    hl_vec3 col[3];
    col[0] = hl_scale3(hl_cross3(b, c), s);
    col[1] = hl_scale3(hl_cross3(c, a), s);
    col[2] = hl_scale3(hl_cross3(a, b), s);
    for (int i = 0; i < 3; i++) {
        out[i * 4] = col[i].x;
        out[i * 4 + 1] = col[i].y;
        out[i * 4 + 2] = col[i].z;
        out[i * 4 + 3] = 0.0f;
        out[12 + i] = 0.0f;
    }
    out[15] = 1.0f;
}
/* How far c lies outside low..high. */
static inline float hl_outside(float c, float low, float high)
{
    return c < low ? low - c : c > high ? c - high : 0.0f;
}
#endif
