/* SPDX-License-Identifier: Zlib */
/* Vertex attributes, out of buffers into one array a component. No id reads
 * out of bounds: one past a stream's last vertex reads that last one, and a
 * stream too short for any vertex is as good as absent. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

struct source {
    const uint8_t *base;     /* of the attribute in vertex 0                 */
    size_t stride;
    uint32_t last;           /* vertex                                       */
};
typedef float (*pe_lanes)[PE_RUN];

static const uint8_t *vertex_at(const struct source *s, uint32_t id)
{
    return s->base + s->stride * (id < s->last ? id : s->last);
}

/* ---- formats ------------------------------------------------------------- */

static void fetch_floats(const struct source *s, const uint32_t *ids,
                         uint32_t n, uint32_t channels, pe_lanes out)
{
    float v[4];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), channels * sizeof *v);
        for (uint32_t c = 0; c < channels; c++)
            out[c][i] = v[c];
    }
}

/* The common one, with its size known to the compiler. */
static void fetch_float3(const struct source *s, const uint32_t *ids,
                         uint32_t n, pe_lanes out)
{
    float v[3];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), sizeof v);
        out[0][i] = v[0];
        out[1][i] = v[1];
        out[2][i] = v[2];
    }
}

static void fetch_u8(const struct source *s, const uint32_t *ids, uint32_t n,
                     pe_lanes out)
{
    for (uint32_t i = 0; i < n; i++) {
        const uint8_t *v = vertex_at(s, ids[i]);
        for (uint32_t c = 0; c < 4; c++)
            out[c][i] = (float)v[c] / 255.0f;
    }
}

/* The most negative code is -1 too. */
static float snorm(int32_t code, float top)
{
    float v = (float)code / top;
    return v < -1.0f ? -1.0f : v;
}

static void fetch_s8(const struct source *s, const uint32_t *ids, uint32_t n,
                     pe_lanes out)
{
    int8_t v[4];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), sizeof v);
        for (uint32_t c = 0; c < 4; c++)
            out[c][i] = snorm(v[c], 127.0f);
    }
}

static void fetch_s16(const struct source *s, const uint32_t *ids, uint32_t n,
                      pe_lanes out)
{
    int16_t v[4];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), sizeof v);
        for (uint32_t c = 0; c < 4; c++)
            out[c][i] = snorm(v[c], 32767.0f);
    }
}

static void fetch_u16(const struct source *s, const uint32_t *ids, uint32_t n,
                      pe_lanes out)
{
    uint16_t v[2];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), sizeof v);
        for (uint32_t c = 0; c < 2; c++)
            out[c][i] = (float)v[c] / 65535.0f;
    }
}

/* Exponents are rebiased by a multiplication, which is exact, subnormals
 * included; Inf and NaN keep all their exponent bits. */
static float half_value(uint16_t h)
{
    union { uint32_t u; float f; } v, scale;
    v.u = (uint32_t)(h & 0x7fff) << 13;
    scale.u = (254u - 15u) << 23;               /* 2^112                     */
    v.f *= scale.f;
    if ((h & 0x7c00) == 0x7c00)
        v.u |= 0x7f800000u;
    v.u |= (uint32_t)(h & 0x8000) << 16;
    return v.f;
}

static void fetch_f16(const struct source *s, const uint32_t *ids, uint32_t n,
                      uint32_t channels, pe_lanes out)
{
    uint16_t v[4];
    for (uint32_t i = 0; i < n; i++) {
        memcpy(v, vertex_at(s, ids[i]), channels * sizeof *v);
        for (uint32_t c = 0; c < channels; c++)
            out[c][i] = half_value(v[c]);
    }
}

/* ---- attributes ---------------------------------------------------------- */

static const struct { uint8_t bytes, channels; } sizes[] = {
    [HL_ATTR_NONE] = { 0, 0 }, [HL_ATTR_F32X1] = { 4, 1 },
    [HL_ATTR_F32X2] = { 8, 2 }, [HL_ATTR_F32X3] = { 12, 3 },
    [HL_ATTR_F32X4] = { 16, 4 }, [HL_ATTR_U8X4_UNORM] = { 4, 4 },
    [HL_ATTR_S8X4_SNORM] = { 4, 4 }, [HL_ATTR_S16X4_SNORM] = { 8, 4 },
    [HL_ATTR_U16X2_UNORM] = { 4, 2 }, [HL_ATTR_F16X2] = { 4, 2 },
    [HL_ATTR_F16X4] = { 8, 4 }
};

static bool find_source(const struct pe_state *s, const struct pe_draw *d,
                        uint32_t location, struct source *out)
{
    const struct hl_vertex_layout *l = &d->program->desc.layout;
    const struct hl_attr *a = &l->attr[location];
    if (a->format == HL_ATTR_NONE || d->in->vertex[a->stream] == HL_NO_SLOT)
        return false;
    const struct pe_buffer *b = &s->buf[d->in->vertex[a->stream]];
    size_t need = (size_t)a->offset + sizes[a->format].bytes;
    if (!b->memory || b->bytes < need)
        return false;
    out->base = b->memory + a->offset;
    out->stride = l->stride[a->stream];
    size_t last = out->stride ? (b->bytes - need) / out->stride : 0;
    out->last = last > 0xffffffffu ? 0xffffffffu : (uint32_t)last;
    return true;
}

static void fill(float *out, float value)
{
    for (uint32_t i = 0; i < PE_RUN; i++)
        out[i] = value;
}

static void fetch_one(const struct source *s, enum hl_attr_format format,
                      const uint32_t *ids, uint32_t n, pe_lanes out)
{
    switch (format) {
    case HL_ATTR_NONE: break;
    case HL_ATTR_F32X3: fetch_float3(s, ids, n, out); break;
    case HL_ATTR_F32X1: case HL_ATTR_F32X2: case HL_ATTR_F32X4:
        fetch_floats(s, ids, n, sizes[format].channels, out);
        break;
    case HL_ATTR_U8X4_UNORM: fetch_u8(s, ids, n, out); break;
    case HL_ATTR_S8X4_SNORM: fetch_s8(s, ids, n, out); break;
    case HL_ATTR_S16X4_SNORM: fetch_s16(s, ids, n, out); break;
    case HL_ATTR_U16X2_UNORM: fetch_u16(s, ids, n, out); break;
    case HL_ATTR_F16X2: case HL_ATTR_F16X4:
        fetch_f16(s, ids, n, sizes[format].channels, out);
        break;
    }
}

void pe_fetch_begin(const struct pe_state *s, const struct pe_draw *d,
                    struct pe_vertices *v)
{
    struct source source;
    for (uint32_t l = 0; l < HL_MAX_ATTRS; l++) {
        if (!(d->program->vertex->attrs >> l & 1))
            continue;
        uint32_t have = find_source(s, d, l, &source)
                        ? sizes[d->program->desc.layout.attr[l].format].channels
                        : 0;
        for (uint32_t c = have; c < 4; c++)
            fill(v->attr[l][c], c == 3 ? 1.0f : 0.0f);
    }
}

void pe_fetch_vertices(const struct pe_state *s, const struct pe_draw *d,
                       const uint32_t *ids, struct pe_vertices *v)
{
    struct source source;
    for (uint32_t l = 0; l < HL_MAX_ATTRS; l++)
        if (d->program->vertex->attrs >> l & 1 &&
            find_source(s, d, l, &source))
            fetch_one(&source, d->program->desc.layout.attr[l].format, ids,
                      v->n, v->attr[l]);
}
