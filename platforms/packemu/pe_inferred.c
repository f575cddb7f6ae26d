/* SPDX-License-Identifier: Zlib */
/* shaders/inferred.glsl: the light of a pixel by its taps (pe_taps.c). */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_inferred.h"

typedef float planes[4][HL_PE_BATCH];
typedef uint32_t words[4][HL_PE_BATCH];

/* ---- weights ------------------------------------------------------------- */

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

static void bilinear(const struct pe_taps *t, uint32_t n, planes b)
{
    for (uint32_t i = 0; i < n; i++) {
        hl_vec4 v = hl_bilinear(hl_v2(t->fx[i], t->fy[i]));
        b[0][i] = v.x;
        b[1][i] = v.y;
        b[2][i] = v.z;
        b[3][i] = v.w;
    }
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

static void unpack_unorm10(const uint32_t *w, uint32_t n, planes out)
{
    for (int c = 0; c < 3; c++)
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = (float)(int32_t)(w[i] >> 10 * c & 1023u) / 1023.0f;
    for (uint32_t i = 0; i < n; i++)
        out[3][i] = (float)(int32_t)(w[i] >> 30) / 3.0f;
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
    } else if (bits == HL_BITS_UNORM10) {
        unpack_unorm10(w[0], n, out);
    } else if (bits == HL_BITS_UNORM16) {
        unpack_unorm16(w[0], n, out[0], out[1]);
        unpack_unorm16(w[1], n, out[2], out[3]);
    } else {
        unpack_halves(w[0], n, out[0], out[1]);
        unpack_halves(w[1], n, out[2], out[3]);
    }
}

static uint32_t light_words(uint32_t bits)
{
    return bits == HL_BITS_FLOAT ? 4
           : bits == HL_BITS_UNORM8 || bits == HL_BITS_UNORM10 ? 1 : 2;
}

/* What a filter makes of infinities is no number, and goes too. */
static void cut_halves(uint32_t bits, uint32_t n, planes light)
{
    for (int c = 0; c < 4 && bits == HL_BITS_HALF; c++)
        for (uint32_t i = 0; i < n; i++)
            light[c][i] = light[c][i] <= HL_HALF_MAX ? light[c][i]
                                                     : HL_HALF_MAX;
}

/* Light of the four taps: [tap][channel]. Words that a format does not have
 * are not read. */
static void read_light(const struct pe_draw *d, const int32_t *x,
                       const int32_t *y, uint32_t n, planes taps[4])
{
    const struct pe_view *v = &d->view[HL_TEX_LIGHT];
    uint32_t bits = pe_spec_uint(d, HL_SPEC_LIGHT_BITS);
    words w[4];
    if (!pe_has_words(v)) {
        pe_gather(v, x, y, n, taps);
        for (int k = 0; k < 4; k++)
            cut_halves(bits, n, taps[k]);
        return;
    }
    for (uint32_t j = 0; j < light_words(bits); j++)
        pe_gather_words(v, j, x, y, n, w[j]);
    for (int k = 0; k < 4; k++) {
        const uint32_t *const tap[4] = { w[0][k], w[1][k], w[2][k], w[3][k] };
        unpack(bits, tap, n, taps[k]);
    }
}

void pe_fetch_light(const struct pe_draw *d, const int32_t *x,
                    const int32_t *y, uint32_t n, float out[4][HL_PE_BATCH])
{
    const struct pe_view *v = &d->view[HL_TEX_LIGHT];
    uint32_t bits = pe_spec_uint(d, HL_SPEC_LIGHT_BITS);
    planes texel;
    words w;
    if (!pe_has_words(v)) {
        pe_fetch_texels(v, x, y, n, out);
        cut_halves(bits, n, out);
        return;
    }
    pe_fetch_texels(v, x, y, n, texel);
    for (uint32_t j = 0; j < light_words(bits); j++)
        memcpy(w[j], texel[j], n * sizeof w[j][0]);
    const uint32_t *const tap[4] = { w[0], w[1], w[2], w[3] };
    unpack(bits, tap, n, out);
}

/* All four by bilinear weights where all are accepted, a NULL: everywhere. */
static void filter_light(const struct pe_draw *d, const struct pe_taps *t,
                         planes a, uint32_t n, planes out)
{
    float u[HL_PE_BATCH], v[HL_PE_BATCH];
    float tx = 1.0f / pe_spec_float(d, HL_SPEC_LIGHT_WIDTH);
    float ty = 1.0f / pe_spec_float(d, HL_SPEC_LIGHT_HEIGHT);
    planes l;
    u[0] = v[0] = 0.0f;          /* n may be 0                               */
    for (uint32_t i = 0; i < n; i++) {
        u[i] = ((float)t->x[i] + 1.0f) * tx + (t->fx[i] - 0.5f) * tx;
        v[i] = ((float)t->y[i] + 1.0f) * ty + (t->fy[i] - 0.5f) * ty;
    }
    pe_sample(&d->view[HL_TEX_LIGHT], u, v, NULL, n, l);
    cut_halves(pe_spec_uint(d, HL_SPEC_LIGHT_BITS), n, l);
    for (uint32_t i = 0; i < n; i++) {
        bool all = !a || a[0][i] + a[1][i] + a[2][i] + a[3][i] == 4.0f;
        for (int c = 0; c < 4; c++)
            out[c][i] = all ? l[c][i] : out[c][i];
    }
}

static void weigh(planes taps[4], planes w, uint32_t n, planes out)
{
    for (int c = 0; c < 4; c++)
        for (uint32_t i = 0; i < n; i++)
            out[c][i] = taps[0][c][i] * w[0][i] + taps[1][c][i] * w[1][i] +
                        taps[2][c][i] * w[2][i] + taps[3][c][i] * w[3][i];
}

/* Plain bilinear. */
PE_WIDE
static void unchecked_light(const struct pe_draw *d,
                            const struct hl_pe_fragments *f, planes out)
{
    struct pe_taps t;
    planes taps[4], b;
    pe_find_taps(d, f, &t);
    if (pe_spec_uint(d, HL_SPEC_BILINEAR)) {
        filter_light(d, &t, NULL, f->n, out);
        return;
    }
    bilinear(&t, PE_LANES(f->n), b);
    read_light(d, t.x, t.y, f->n, taps);
    weigh(taps, b, PE_LANES(f->n), out);
}

static bool all_accepted(planes a, uint32_t n)
{
    float least = 4.0f;
    for (uint32_t i = 0; i < n; i++)
        least = hl_min(least, a[0][i] + a[1][i] + a[2][i] + a[3][i]);
    return least == 4.0f;
}

/* The L-buffer under the fragments of opaque surfaces, by the DSF. */
PE_WIDE
static void dsf_light(const struct pe_draw *d, const struct hl_pe_fragments *f,
                      planes out)
{
    uint32_t lanes = PE_LANES(f->n);
    bool filter = pe_spec_uint(d, HL_SPEC_BILINEAR) != 0;
    struct pe_taps t;
    struct pe_dsf dsf;
    planes taps[4], a, b, w;
    pe_find_taps(d, f, &t);
    pe_read_dsf(d, &t, f->n, &dsf);
    pe_accept(d, f, &dsf, 1.0f, a);
    if (!filter || !all_accepted(a, f->n)) {
        bilinear(&t, lanes, b);
        dsf_weights(b, a, lanes, f->n, w);
        read_light(d, t.x, t.y, f->n, taps);
        weigh(taps, w, lanes, out);
    }
    if (filter)
        filter_light(d, &t, a, f->n, out);
    if (pe_spec_uint(d, HL_SPEC_FILL))
        pe_fill_light(d, f, &dsf, a, out);
}

static void light(const struct pe_draw *d, const struct hl_pe_fragments *f,
                  planes out)
{
    planes taps[4];
    uint32_t dsf = pe_spec_uint(d, HL_SPEC_DSF);
    if (pe_spec_uint(d, HL_SPEC_STIPPLE)) {
        pe_stippled_light(d, f, out);
    } else if (dsf == HL_DSF_EXACT) {
        read_light(d, f->x, f->y, f->n, taps);
        memcpy(out, taps[0], sizeof taps[0]);
    } else if (dsf == HL_DSF_OFF) {
        unchecked_light(d, f, out);
    } else {
        dsf_light(d, f, out);
    }
}

void hl_pe_read_lights(const struct pe_draw *d,
                       const struct hl_pe_fragments *f,
                       float out[6][HL_PE_BATCH])
{
    float scale = pe_spec_float(d, HL_SPEC_LIGHT_SCALE);
    planes l;
    if (pe_spec_uint(d, HL_SPEC_DSF) == HL_DSF_DARK) {
        memset(out, 0, 6 * sizeof out[0]);
        return;
    }
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
