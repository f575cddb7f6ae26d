/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_inferred.h"

typedef float planes[4][HL_PE_BATCH];
typedef uint32_t words[4][HL_PE_BATCH];

static bool has_words(const struct pe_view *v)
{
    return v->texture &&
           hl_format_info(v->texture->view)->kind == HL_KIND_UINT;
}

/* ---- taps ---------------------------------------------------------------- */

/* Far outside of any texture; lanes beyond n hold anything at all. */
static inline int32_t texel(float x)
{
    x = x > -65536.0f ? x : -65536.0f;
    return (int32_t)(x < 65536.0f ? x : 65536.0f);
}

static void taps_along(const int32_t *pixel, float ratio, uint32_t n,
                       int32_t *corner, float *fraction)
{
    for (uint32_t i = 0; i < n; i++) {
        float p = ((float)pixel[i] + 0.5f) * ratio - 0.5f;
        float b = hl_floor(p);
        corner[i] = texel(b);
        fraction[i] = p - b;
    }
}

PE_WIDE
void pe_find_taps(const struct pe_draw *d, const struct hl_pe_fragments *f,
                  struct pe_taps *t)
{
    uint32_t n = PE_LANES(f->n);
    taps_along(f->x, pe_spec_float(d, HL_SPEC_RATIO_X), n, t->x, t->fx);
    taps_along(f->y, pe_spec_float(d, HL_SPEC_RATIO_Y), n, t->y, t->fy);
}

/* ---- acceptance ---------------------------------------------------------- */

static void thresholds(const struct pe_draw *d,
                       const struct hl_pe_fragments *f, float *out)
{
    uint32_t n = PE_LANES(f->n);
    bool by_slope = pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_SLOPE;
    float step = pe_frame(d)->depth.w / 65535.0f;
    float k = pe_spec_float(d, HL_SPEC_DSF_K);
    float c = pe_spec_float(d, HL_SPEC_DSF_C);
    float tau = pe_spec_float(d, HL_SPEC_DSF_TAU);
    float sx = 1.0f / pe_spec_float(d, HL_SPEC_RATIO_X);
    float sy = 1.0f / pe_spec_float(d, HL_SPEC_RATIO_Y);
    if (!by_slope) {
        for (uint32_t i = 0; i < n; i++)
            out[i] = tau * f->z[i];
        return;
    }
    for (uint32_t i = 0; i < n; i++) {
        float slope = hl_abs(f->dzdx[i]) * sx + hl_abs(f->dzdy[i]) * sy;
        out[i] = hl_dsf_threshold(step, k, c, f->z[i], slope, 1.0f);
    }
}

/* Depths, in steps of far / 65535, and ids of one tap. */
static void split_words(const uint32_t *w, uint32_t n, float *depth,
                        float *id)
{
    for (uint32_t i = 0; i < n; i++) {
        depth[i] = (float)(int32_t)(w[i] & 0xffffu);
        id[i] = (float)(int32_t)(w[i] >> 16);
    }
}

static void split_numbers(const struct pe_draw *d, float (*v)[HL_PE_BATCH],
                          uint32_t n, float *depth, float *id)
{
    uint32_t mode = pe_spec_uint(d, HL_SPEC_TWO16);
    float steps = pe_spec_float(d, HL_SPEC_ID_STEPS);
    for (uint32_t i = 0; i < n; i++) {
        hl_vec2 a = hl_two16_decode(mode, hl_v2(v[0][i], v[1][i]));
        depth[i] = a.x * 65535.0f;
        id[i] = a.y * steps;
    }
}

PE_WIDE
static void read_dsf(const struct pe_draw *d, const struct pe_taps *t,
                     uint32_t n, planes depth, planes id)
{
    const struct pe_view *v = &d->view[HL_TEX_DSF];
    uint32_t lanes = PE_LANES(n);
    if (has_words(v)) {
        words w;
        pe_gather_words(v, 0, t->x, t->y, n, w);
        for (int k = 0; k < 4; k++)
            split_words(w[k], lanes, depth[k], id[k]);
    } else {
        float taps[4][4][HL_PE_BATCH];
        pe_gather(v, t->x, t->y, n, taps);
        for (int k = 0; k < 4; k++)
            split_numbers(d, taps[k], lanes, depth[k], id[k]);
    }
}

PE_WIDE
void pe_accept_taps(const struct pe_draw *d, const struct hl_pe_fragments *f,
                    const struct pe_taps *t, float out[4][HL_PE_BATCH])
{
    uint32_t n = PE_LANES(f->n);
    float step = pe_frame(d)->depth.w / 65535.0f;
    float threshold[HL_PE_BATCH];
    planes depth, id;
    thresholds(d, f, threshold);
    read_dsf(d, t, f->n, depth, id);
    for (int k = 0; k < 4; k++)
        for (uint32_t i = 0; i < n; i++)
            out[k][i] = hl_dsf_accept(depth[k][i] * step, id[k][i], f->z[i],
                                      f->vary[HL_PE_ID][i], threshold[i],
                                      0.5f);
}

/* hl_dsf_weights of all lanes: accepted weights renormalised in a loop without
 * branches, and after it the few lanes where they sum to nothing. */
static void dsf_weights(planes b, planes a, uint32_t lanes, uint32_t n,
                        planes w)
{
    float sum[HL_PE_BATCH];
    for (uint32_t i = 0; i < lanes; i++) {
        float x = b[0][i] * a[0][i], y = b[1][i] * a[1][i];
        float z = b[2][i] * a[2][i], u = b[3][i] * a[3][i];
        sum[i] = x + y + z + u;
        float inv = 1.0f / sum[i];
        w[0][i] = x * inv;
        w[1][i] = y * inv;
        w[2][i] = z * inv;
        w[3][i] = u * inv;
    }
    for (uint32_t i = 0; i < n; i++) {
        if (sum[i] > HL_DSF_NOTHING)
            continue;
        hl_vec4 v = hl_dsf_weights(hl_v4(b[0][i], b[1][i], b[2][i], b[3][i]),
                                   hl_v4(a[0][i], a[1][i], a[2][i], a[3][i]));
        w[0][i] = v.x;
        w[1][i] = v.y;
        w[2][i] = v.z;
        w[3][i] = v.w;
    }
}

static void weights(const struct pe_draw *d, const struct hl_pe_fragments *f,
                    const struct pe_taps *t, planes w)
{
    uint32_t n = PE_LANES(f->n);
    bool off = pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_OFF;
    planes a, bilinear;
    float (*b)[HL_PE_BATCH] = off ? w : bilinear;
    for (uint32_t i = 0; i < n; i++) {
        hl_vec4 v = hl_bilinear(hl_v2(t->fx[i], t->fy[i]));
        b[0][i] = v.x;
        b[1][i] = v.y;
        b[2][i] = v.z;
        b[3][i] = v.w;
    }
    if (off)
        return;
    pe_accept_taps(d, f, t, a);
    dsf_weights(b, a, n, f->n, w);
}

/* ---- light --------------------------------------------------------------- */

/* A 16-bit float: the exponent is moved up by a product, which also makes
 * normal numbers of denormal ones. Infinity becomes 65536, which the caller
 * cuts to HL_HALF_MAX. */
static inline float half(uint32_t h)
{
    float x = pe_float((h & 0x7fffu) << 13) * 0x1p112f;
    return pe_float(pe_bits(x) | (h & 0x8000u) << 16);
}

static void unpack_halves(const uint32_t *w, uint32_t n, float *lo, float *hi)
{
    for (uint32_t i = 0; i < n; i++) {
        lo[i] = hl_min(half(w[i] & 0xffffu), HL_HALF_MAX);
        hi[i] = hl_min(half(w[i] >> 16), HL_HALF_MAX);
    }
}

static void unpack_unorm16(const uint32_t *w, uint32_t n, float *lo,
                           float *hi)
{
    for (uint32_t i = 0; i < n; i++) {
        lo[i] = (float)(int32_t)(w[i] & 0xffffu) / 65535.0f;
        hi[i] = (float)(int32_t)(w[i] >> 16) / 65535.0f;
    }
}

static void unpack_unorm8(const uint32_t *w, uint32_t n, planes out)
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = (float)(int32_t)(w[i] >> 8 * c & 0xffu) / 255.0f;
}

/* The words of a tap to its four channels. */
PE_WIDE
static void unpack(uint32_t bits, const uint32_t *const w[4], uint32_t n,
                   planes out)
{
    if (bits == HL_BITS_FLOAT) {
        for (int c = 0; c < 4; c++)
            memcpy(out[c], w[c], n * sizeof(float));
    } else if (bits == HL_BITS_UNORM8) {
        unpack_unorm8(w[0], n, out);
    } else if (bits == HL_BITS_UNORM16) {
        unpack_unorm16(w[0], n, out[0], out[1]);
        unpack_unorm16(w[1], n, out[2], out[3]);
    } else {
        unpack_halves(w[0], n, out[0], out[1]);
        unpack_halves(w[1], n, out[2], out[3]);
    }
}

/* Light of the four taps: [tap][channel]. Words that a format does not have
 * are not read. */
static void read_light(const struct pe_draw *d, const int32_t *x,
                       const int32_t *y, uint32_t n, planes taps[4])
{
    const struct pe_view *v = &d->view[HL_TEX_LIGHT];
    uint32_t bits = pe_spec_uint(d, HL_SPEC_LIGHT_BITS);
    uint32_t n_words = bits == HL_BITS_FLOAT ? 4
                       : bits == HL_BITS_UNORM8 ? 1 : 2;
    words w[4];
    if (!has_words(v)) {
        pe_gather(v, x, y, n, taps);
        for (int k = 0; k < 16 && bits == HL_BITS_HALF; k++)
            for (uint32_t i = 0; i < n; i++)
                taps[k / 4][k % 4][i] = hl_min(taps[k / 4][k % 4][i],
                                               HL_HALF_MAX);
        return;
    }
    for (uint32_t j = 0; j < n_words; j++)
        pe_gather_words(v, j, x, y, n, w[j]);
    for (int k = 0; k < 4; k++) {
        const uint32_t *const tap[4] = { w[0][k], w[1][k], w[2][k], w[3][k] };
        unpack(bits, tap, n, taps[k]);
    }
}

static void weigh(planes taps[4], planes w, uint32_t n, planes out)
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = taps[0][c][i] * w[0][i] + taps[1][c][i] * w[1][i] +
                        taps[2][c][i] * w[2][i] + taps[3][c][i] * w[3][i];
}

/* The L-buffer under the fragments, filtered. */
PE_WIDE
static void light(const struct pe_draw *d, const struct hl_pe_fragments *f,
                  planes out)
{
    planes taps[4], w;
    if (pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_EXACT) {
        read_light(d, f->x, f->y, f->n, taps);
        memcpy(out, taps[0], sizeof taps[0]);
        return;
    }
    struct pe_taps t;
    pe_find_taps(d, f, &t);
    weights(d, f, &t, w);
    read_light(d, t.x, t.y, f->n, taps);
    weigh(taps, w, PE_LANES(f->n), out);
}

void hl_pe_read_lights(const struct pe_draw *d,
                       const struct hl_pe_fragments *f,
                       float out[6][HL_PE_BATCH])
{
    float scale = pe_spec_float(d, HL_SPEC_LIGHT_SCALE);
    planes l;
    light(d, f, l);
    for (uint32_t i = 0; i < PE_LANES(f->n); i++) {
        hl_vec3 c = hl_v3(l[0][i] * scale, l[1][i] * scale, l[2][i] * scale);
        float s = hl_specular_scale(c, l[3][i] * scale);
        out[0][i] = c.x;
        out[1][i] = c.y;
        out[2][i] = c.z;
        out[3][i] = c.x * s;
        out[4][i] = c.y * s;
        out[5][i] = c.z * s;
    }
}
