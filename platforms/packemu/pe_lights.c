/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_lights.h"

/* Attenuation and direction of a light, once for the whole run. */
enum shape { SMOOTH, INVERSE, SPOT_SMOOTH, SPOT_INVERSE, PARALLEL, SHAPES };

void pe_lit_begin(struct pe_lit_run *r)
{
    memset(r->diffuse, 0, sizeof r->diffuse);
    memset(r->specular, 0, sizeof r->specular);
    r->brdfs = false;
    for (uint32_t i = 0; i < r->n; i++) {
        hl_vec3 p = hl_v3(r->px[i], r->py[i], r->pz[i]);
        float s = pe_rsqrt(hl_dot3(p, p));
        r->vx[i] = -p.x * s;
        r->vy[i] = -p.y * s;
        r->vz[i] = -p.z * s;
    }
}

/* One light on every point. `shape` and `what` are constants where this is
 * expanded, so that the loop has no branches. A product of zero and what a
 * degenerate point makes infinite is NaN, which every maximum below turns
 * into zero: the second operand of a compare that fails. The stages' guards
 * max(x, 1e-20) are sums here, and hl_specular is hl_pow of what cannot be
 * negative: compilers make selects of a maximum's uses, three for one. */
PE_INLINE void add(struct pe_lit_run *r, const hl_vec4 *light,
                   enum shape shape, enum pe_lit_specular what, bool brdfs)
{
    hl_vec4 a = light[0], b = light[1];
    bool cone = shape == SPOT_SMOOTH || shape == SPOT_INVERSE;
    bool smooth = shape == SMOOTH || shape == SPOT_SMOOTH;
    hl_vec3 axis = hl_v3(0.0f, 0.0f, 0.0f);
    float scale = 0.0f, offset = 0.0f;
    if (cone || shape == PARALLEL) {
        axis = hl_v3(light[2].x, light[2].y, light[2].z);
        scale = light[2].w;
        offset = light[3].x;
    }
    float lum = hl_luminance(hl_v3(b.x, b.y, b.z));
    for (uint32_t i = 0; i < r->n; i++) {
        hl_vec3 n = hl_v3(r->nx[i], r->ny[i], r->nz[i]);
        hl_vec3 l = hl_v3(-axis.x, -axis.y, -axis.z);
        float att = 1.0f;
        if (shape != PARALLEL) {
            hl_vec3 to = hl_v3(a.x - r->px[i], a.y - r->py[i],
                               a.z - r->pz[i]);
            float d2 = hl_dot3(to, to);
            l = hl_scale3(to, pe_rsqrt(d2 + 1e-20f));
            att = smooth ? hl_falloff_smooth(d2, a.w)
                         : hl_falloff_inverse_square(d2, a.w);
        }
        if (cone)
            att *= hl_spot(-hl_dot3(l, axis), scale, offset);
        float cosine = hl_dot3(n, l);
        float ndl = hl_max(cosine, 0.0f) * att, diffuse = ndl;
        if (brdfs) {
            float skin = hl_diffuse_skin(cosine) * att;
            diffuse = r->brdf[i] == (float)HL_BRDF_SKIN_INDEX ? skin : ndl;
        }
        r->diffuse[0][i] += b.x * diffuse;
        r->diffuse[1][i] += b.y * diffuse;
        r->diffuse[2][i] += b.z * diffuse;
        if (what == PE_LIT_NONE)
            continue;
        hl_vec3 h = hl_v3(l.x + r->vx[i], l.y + r->vy[i], l.z + r->vz[i]);
        float nh = hl_max(hl_dot3(n, h), 0.0f);
        float spec = ndl * hl_pow(nh * nh / (hl_dot3(h, h) + 1e-20f),
                                  r->half_n[i]);
        if (what == PE_LIT_LUMINANCE) {
            r->specular[0][i] += lum * spec;
        } else {
            r->specular[0][i] += b.x * spec;
            r->specular[1][i] += b.y * spec;
            r->specular[2][i] += b.z * spec;
        }
    }
}

typedef void (*add_fn)(struct pe_lit_run *, const hl_vec4 *);

#define PE_ADD(shape, what)                                                  \
    PE_WIDE                                                                  \
    static void add_##shape##_##what(struct pe_lit_run *r,                   \
                                     const hl_vec4 *light)                   \
    { add(r, light, shape, PE_LIT_##what, false); }                          \
    PE_WIDE                                                                  \
    static void add_##shape##_##what##_BRDFS(struct pe_lit_run *r,           \
                                             const hl_vec4 *light)           \
    { add(r, light, shape, PE_LIT_##what, true); }
#define PE_ADD_SHAPE(shape)                                                  \
    PE_ADD(shape, NONE) PE_ADD(shape, LUMINANCE) PE_ADD(shape, COLOR)
PE_ADD_SHAPE(SMOOTH)
PE_ADD_SHAPE(INVERSE)
PE_ADD_SHAPE(SPOT_SMOOTH)
PE_ADD_SHAPE(SPOT_INVERSE)
PE_ADD_SHAPE(PARALLEL)

/* [shape][what][brdfs] */
#define PE_PAIR(name) { name, name##_BRDFS }
#define PE_ROW(shape)                                                        \
    { PE_PAIR(add_##shape##_NONE), PE_PAIR(add_##shape##_LUMINANCE),         \
      PE_PAIR(add_##shape##_COLOR) }
static const add_fn adders[SHAPES][PE_LIT_COUNT][2] = {
    PE_ROW(SMOOTH), PE_ROW(INVERSE), PE_ROW(SPOT_SMOOTH),
    PE_ROW(SPOT_INVERSE), PE_ROW(PARALLEL)
};

/* A cone that is 1 everywhere (cos * 0 + 1) is a point. */
static enum shape shape_of(const hl_vec4 *light, uint32_t kinds,
                           uint32_t falloff)
{
    bool inverse = falloff == 2u || (falloff != 1u && light[1].w > 0.5f);
    if (kinds != 0u && light[3].y > 0.5f)
        return PARALLEL;
    if (kinds != 0u && (light[2].w != 0.0f || light[3].x != 1.0f))
        return inverse ? SPOT_INVERSE : SPOT_SMOOTH;
    return inverse ? INVERSE : SMOOTH;
}

/* Batches are padded with black lights, which add zeros. */
static bool black(const hl_vec4 *light)
{
    return light[1].x == 0.0f && light[1].y == 0.0f && light[1].z == 0.0f;
}

static uint32_t stride_of(uint32_t kinds)
{
    return kinds != 0u ? HL_LIGHT_VEC4S : HL_POINT_VEC4S;
}

void pe_lit_add(struct pe_lit_run *r, enum pe_lit_specular what,
                uint32_t kinds, uint32_t falloff, const hl_vec4 *light,
                uint32_t count)
{
    uint32_t stride = stride_of(kinds);
    for (uint32_t i = 0; i < count; i++, light += stride)
        if (!black(light))
            adders[shape_of(light, kinds, falloff)][what][r->brdfs](r, light);
}

struct pe_lit_list pe_lit_batch(const struct pe_draw *d)
{
    uint32_t kinds = pe_spec_uint(d, HL_SPEC_KINDS);
    uint32_t count = pe_spec_uint(d, HL_SPEC_BATCH);
    uint32_t room = d->uniform_bytes[HL_SLOT_LIGHTS] /
                    (16u * stride_of(kinds));
    struct pe_lit_list l = { d->uniform[HL_SLOT_LIGHTS], 0 };
    if (l.light)
        l.count = count < room ? count : room;
    return l;
}

struct pe_lit_list pe_lit_list(const struct pe_draw *d, uint32_t first,
                               uint32_t count)
{
    uint32_t stride = stride_of(pe_spec_uint(d, HL_SPEC_KINDS));
    uint32_t bytes = d->storage_bytes[HL_SLOT_LIST];
    struct pe_lit_list l = { d->storage[HL_SLOT_LIST], 0 };
    if (!l.light || first > bytes / 16u)
        return l;
    uint32_t room = (bytes / 16u - first) / stride;
    l.light += first;
    l.count = count < room ? count : room;
    return l;
}
