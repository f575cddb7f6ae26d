/* SPDX-License-Identifier: Zlib */
/* shaders/conform.frag. */
#include "platforms/packemu/pe_kernel.h"
#include <string.h>
#include "shaders/shared/conform.h"

static bool reads_stored(uint32_t op)
{
    return op == HL_OP_STORED || op == HL_OP_NORMAL_DECODE ||
           op == HL_OP_UNPACK || op == HL_OP_DSF || op == HL_OP_INDEX ||
           op == HL_OP_BARG;
}

static bool reads_input(uint32_t op)
{
    return !reads_stored(op) || op == HL_OP_DSF;
}

/* Texel of the input at an offset, round the edges. */
static hl_vec4 read_in(const struct pe_draw *d, int32_t x, int32_t y)
{
    const struct pe_view *v = &d->view[HL_CONFORM_IN];
    float c[4];
    if (!v->texture)
        return hl_v4(1.0f, 1.0f, 1.0f, 1.0f);
    pe_fetch(v, 0, x % (int32_t)v->texture->desc.width,
             y % (int32_t)v->texture->desc.height, c);
    return hl_v4(c[0], c[1], c[2], c[3]);
}

static void sample(const struct pe_draw *d, const hl_vec4 *in, uint32_t n,
                   hl_vec4 *out)
{
    float u[HL_PE_BATCH], v[HL_PE_BATCH], s[4][HL_PE_BATCH];
    memset(u, 0, sizeof u);
    memset(v, 0, sizeof v);
    for (uint32_t i = 0; i < n; i++) {
        u[i] = in[i].x;
        v[i] = in[i].y;
    }
    pe_sample(&d->view[HL_CONFORM_STORED], u, v, NULL, n, s);
    for (uint32_t i = 0; i < n; i++)
        out[i] = hl_v4(s[0][i], s[1][i], s[2][i], s[3][i]);
}

void pe_conform(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    const hl_vec4 *b = pe_block(d, HL_SLOT_MATERIAL,
                                HL_CONFORM_VEC4S * sizeof *b);
    uint32_t op = pe_uint(b[0].x), two16 = pe_uint(b[0].y);
    int32_t dx = pe_int(b[0].z), dy = pe_int(b[0].w);
    int32_t x0 = pe_int(b[4].x), y0 = pe_int(b[4].y);
    hl_vec4 in[HL_PE_BATCH], stored[HL_PE_BATCH];
    for (uint32_t i = 0; i < f->n; i++) {
        float c[4] = { 0.0f, 0.0f, 0.0f, 1.0f };
        in[i] = stored[i] = hl_v4(0.0f, 0.0f, 0.0f, 1.0f);
        int32_t layer = pe_int(f->z[i] + 0.5f) - 1;
        if (reads_input(op))
            in[i] = read_in(d, f->x[i] + x0 + layer * dx,
                            f->y[i] + y0 + layer * dy);
        if (reads_stored(op)) {
            pe_fetch(&d->view[HL_CONFORM_STORED], 0, f->x[i], f->y[i], c);
            stored[i] = hl_v4(c[0], c[1], c[2], c[3]);
        }
    }
    if (op == HL_OP_SAMPLE)
        sample(d, in, f->n, stored);
    for (uint32_t i = 0; i < f->n; i++) {
        hl_vec4 o = hl_conform_op(op, two16, in[i], stored[i], b[1], b[2],
                                  b[3]);
        f->color[0][0][i] = o.x;
        f->color[0][1][i] = o.y;
        f->color[0][2][i] = o.z;
        f->color[0][3][i] = o.w;
    }
}
