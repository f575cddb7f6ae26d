/* SPDX-License-Identifier: Zlib */
#ifndef HL_LANG_H
#define HL_LANG_H
/* The few words that C99 and GLSL 4.50 spell differently; nothing else in
 * shaders/shared may be conditional. Rules for text both languages read:
 * vectors only through hl_v2..hl_v4 and members, no operators on vectors,
 * no swizzles, no pointers, no out parameters; float literals end in f;
 * constants are #define; int/float conversion only by hl_float, hl_int,
 * hl_uint; rounding is floor(x + 0.5), never round; none of GLSL's reserved
 * words (input output sample filter half common active partition). */
#ifdef GL_core_profile
#define HL_GLSL 1
#define HL_FN
#define hl_vec2 vec2
#define hl_vec3 vec3
#define hl_vec4 vec4
#define hl_v2(x, y) vec2(x, y)
#define hl_v3(x, y, z) vec3(x, y, z)
#define hl_v4(x, y, z, w) vec4(x, y, z, w)
#define hl_float(x) float(x)
#define hl_int(x) int(x)
#define hl_uint(x) uint(x)
#define hl_sqrt(x) sqrt(x)
#define hl_floor(x) floor(x)
#define hl_abs(x) abs(x)
#define hl_min(a, b) min(a, b)
#define hl_max(a, b) max(a, b)
#define hl_pow(a, b) pow(a, b)
#define hl_exp2(x) exp2(x)
#define hl_log2(x) log2(x)
#else
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#define HL_FN static inline
typedef struct { float x, y; } hl_vec2;
typedef struct { float x, y, z; } hl_vec3;
typedef struct { float x, y, z, w; } hl_vec4;
typedef uint32_t uint;
static inline hl_vec2 hl_v2(float x, float y) { hl_vec2 v = {x, y}; return v; }
static inline hl_vec3 hl_v3(float x, float y, float z)
{ hl_vec3 v = {x, y, z}; return v; }
static inline hl_vec4 hl_v4(float x, float y, float z, float w)
{ hl_vec4 v = {x, y, z, w}; return v; }
#define hl_float(x) ((float)(x))
#define hl_int(x) ((int)(x))
#define hl_uint(x) ((uint)(x))
#define hl_min(a, b) ((a) < (b) ? (a) : (b))
#define hl_max(a, b) ((a) > (b) ? (a) : (b))
#ifdef HL_LANG_MATH    /* a header that defines the six words below          */
#include HL_LANG_MATH
#else
#define hl_sqrt(x) sqrtf(x)
#define hl_floor(x) floorf(x)
#define hl_abs(x) fabsf(x)
#define hl_pow(a, b) powf(a, b)
#define hl_exp2(x) exp2f(x)
#define hl_log2(x) log2f(x)
#endif
#endif
HL_FN float hl_clamp01(float x) { return hl_min(hl_max(x, 0.0f), 1.0f); }
HL_FN float hl_dot3(hl_vec3 a, hl_vec3 b)
{ return a.x * b.x + a.y * b.y + a.z * b.z; }
HL_FN hl_vec3 hl_add3(hl_vec3 a, hl_vec3 b)
{ return hl_v3(a.x + b.x, a.y + b.y, a.z + b.z); }
HL_FN hl_vec3 hl_scale3(hl_vec3 a, float s)
{ return hl_v3(a.x * s, a.y * s, a.z * s); }
#endif
