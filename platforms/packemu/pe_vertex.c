/* SPDX-License-Identifier: Zlib */
/* shaders/mesh.vert: every mesh pass; shaders/volume.vert. What the draw has
 * once (material, exponent code, far) stays in the uniform blocks. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"

/* Rows 0..rows-1 of m (x, y, z, w), in the order of the columns: equal
 * operands give equal bits whatever else a variant writes. */
static void transform(const hl_mat4 *mat, int rows, float w,
                      float (*p)[PE_RUN], uint32_t n,
                      float (*out)[PE_RUN])
{
    float m[4][4];
    memcpy(m, mat, sizeof m);
    for (int r = 0; r < rows; r++) {
        float a = m[0][r], b = m[1][r], c = m[2][r], d = m[3][r] * w;
        for (uint32_t i = 0; i < n; i++)
            out[r][i] = a * p[0][i] + b * p[1][i] + c * p[2][i] + d;
    }
}

/* shaders/half_pixel.glsl. */
static void shift(const struct pe_draw *d, uint32_t n, float (*clip)[PE_RUN])
{
    float x = pe_spec_float(d, HL_SPEC_SHIFT_X);
    float y = pe_spec_float(d, HL_SPEC_SHIFT_Y);
    if (x == 0.0f && y == 0.0f)
        return;
    for (uint32_t i = 0; i < n; i++) {
        clip[0][i] += clip[3][i] * x;
        clip[1][i] += clip[3][i] * y;
    }
}

/* Normalised at the vertex; a singular matrix leaves zero, not NaN. */
static void normals(const struct hl_object_block *o, struct pe_vertices *v,
                    uint32_t n)
{
    float (*out)[PE_RUN] = &v->vary[HL_PE_NX];
    transform(&o->normal, 3, 0.0f, v->attr[HL_ATTR_NORMAL], n, out);
    for (uint32_t i = 0; i < n; i++) {
        hl_vec3 a = hl_v3(out[0][i], out[1][i], out[2][i]);
        float n2 = hl_dot3(a, a);
        float s = n2 > 0.0f ? pe_rsqrt(n2) : 0.0f;
        out[0][i] = a.x * s;
        out[1][i] = a.y * s;
        out[2][i] = a.z * s;
    }
}

static void tangents(const struct hl_object_block *o, struct pe_vertices *v,
                     uint32_t n)
{
    const float *w = v->attr[HL_ATTR_TANGENT][3];
    float mirrored = o->flat_ids.y;
    transform(&o->model_view, 3, 0.0f, v->attr[HL_ATTR_TANGENT], n,
              &v->vary[HL_PE_TX]);
    for (uint32_t i = 0; i < n; i++)
        v->vary[HL_PE_TW][i] = hl_tangent_w_sign(w[i]) * mirrored;
}

/* x, y and w of both frames' clip positions. */
static void motion(const struct pe_draw *d, float (*position)[PE_RUN],
                   uint32_t n, struct pe_vertices *v)
{
    const struct hl_motion_block *m = pe_block(d, HL_SLOT_MOTION, sizeof *m);
    const hl_mat4 *mat[2] = { &m->now, &m->before };
    for (int k = 0; k < 2; k++) {
        float clip[4][PE_RUN];
        float (*out)[PE_RUN] = &v->vary[HL_PE_MX + 3 * k];
        transform(mat[k], 4, 1.0f, position, n, clip);
        memcpy(out[0], clip[0], sizeof clip[0]);
        memcpy(out[1], clip[1], sizeof clip[1]);
        memcpy(out[2], clip[3], sizeof clip[3]);
    }
}

void pe_vertex_mesh(const struct pe_draw *d, struct pe_vertices *v)
{
    const struct hl_object_block *o = pe_object(d);
    uint32_t vary = d->program->vertex->vary & d->program->fragment.vary;
    uint32_t n = PE_LANES(v->n);
    float (*position)[PE_RUN] = v->attr[HL_ATTR_POSITION];
    transform(&o->clip, 4, 1.0f, position, n, v->clip);
    shift(d, n, v->clip);
    if (vary & 1u << HL_PE_ID)
        for (uint32_t i = 0; i < n; i++)
            v->vary[HL_PE_ID][i] = o->ids.x +
                hl_tangent_w_group(v->attr[HL_ATTR_TANGENT][3][i]);
    if (vary & 1u << HL_PE_NX)
        normals(o, v, n);
    if (vary & 1u << HL_PE_TX)
        tangents(o, v, n);
    if (vary & 1u << HL_PE_U) {
        memcpy(v->vary[HL_PE_U], v->attr[HL_ATTR_UV],
               2 * sizeof v->vary[0]);
        memcpy(v->vary[HL_PE_R], v->attr[HL_ATTR_COLOR],
               4 * sizeof v->vary[0]);
    }
    if (vary & 1u << HL_PE_PX)
        transform(&o->model_view, 3, 1.0f, position, n,
                  &v->vary[HL_PE_PX]);
    if (vary & 1u << HL_PE_MX)
        motion(d, position, n, v);
}

/* shaders/volume.vert. The sum has mesh.vert's order, and w = 1 changes no
 * bit of it: caps get their mesh's depths. */
void pe_vertex_volume(const struct pe_draw *d, struct pe_vertices *v)
{
    const struct hl_volume_block *b = pe_block(d, HL_SLOT_VOLUME, sizeof *b);
    const float light[3] = { b->light.x, b->light.y, b->light.z };
    float (*p)[PE_RUN] = v->attr[HL_ATTR_POSITION], m[4][4];
    uint32_t n = PE_LANES(v->n);
    for (int k = 0; k < 3; k++)
        for (uint32_t i = 0; i < n; i++) {
            float away = p[k][i] * b->light.w - light[k];
            p[k][i] = p[3][i] > 0.5f ? p[k][i] : away;
        }
    memcpy(m, &b->clip, sizeof m);
    for (int r = 0; r < 4; r++)
        for (uint32_t i = 0; i < n; i++)
            v->clip[r][i] = m[0][r] * p[0][i] + m[1][r] * p[1][i] +
                            m[2][r] * p[2][i] +
                            m[3][r] * (p[3][i] > 0.5f ? 1.0f : 0.0f);
    shift(d, n, v->clip);
}
