/* SPDX-License-Identifier: Zlib */
/* shaders/shadow.glsl: how much of a light passes its shadow map. */
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "platforms/packemu/pe_lights.h"
#include "shaders/shared/shadow.h"

/* A run's filters: corner texel, what is left of it, depth to compare. */
struct filters {
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    float fx[HL_PE_BATCH], fy[HL_PE_BATCH], at[HL_PE_BATCH];
};

static hl_vec3 turned(const hl_mat4 *m, hl_vec3 v, float w)
{
    const hl_vec4 *c = m->column;
    return hl_v3(c[0].x * v.x + c[1].x * v.y + c[2].x * v.z + c[3].x * w,
                 c[0].y * v.x + c[1].y * v.y + c[2].y * v.z + c[3].y * w,
                 c[0].z * v.x + c[1].z * v.y + c[2].z * v.z + c[3].z * w);
}

/* pe_int: a number that is none must not reach a conversion. */
static void place(const struct hl_shadow_block *b, uint32_t kind, float side,
                  const struct pe_lit_run *r, uint32_t n, struct filters *f)
{
    for (uint32_t i = 0; i < n; i++) {
        hl_vec3 p = hl_v3(r->px[i], r->py[i], r->pz[i]), m;
        float z = -p.z, error = (b->error.x * z + b->error.y) * z;
        m = turned(&b->light, hl_v3(r->nx[i], r->ny[i], r->nz[i]), 0.0f);
        hl_vec3 s = hl_shadow_place(kind & 3u, turned(&b->light, p, 1.0f), m,
                                    b->map, b->depth, error, side);
        float x = pe_floor(s.x - 0.5f), y = pe_floor(s.y - 0.5f);
        f->fx[i] = s.x - 0.5f - x;
        f->fy[i] = s.y - 0.5f - y;
        f->x[i] = pe_int(x);
        f->y[i] = pe_int(y);
        f->at[i] = s.z;
    }
}

/* Adds the lit ones of 2 x 2 taps, dx and dy texels from the corner. */
static void quad(const struct pe_view *v, bool barg, float sign,
                 const struct filters *f, int32_t dx, int32_t dy, uint32_t n,
                 float *lit)
{
    int32_t x[HL_PE_BATCH], y[HL_PE_BATCH];
    float d[4][4][HL_PE_BATCH];
    for (uint32_t i = 0; i < n; i++) {
        x[i] = f->x[i] + dx;
        y[i] = f->y[i] + dy;
    }
    pe_gather(v, x, y, n, d);
    for (uint32_t i = 0; i < n; i++) {
        hl_vec4 wx = hl_shadow_weights(f->fx[i]);
        hl_vec4 wy = hl_shadow_weights(f->fy[i]);
        float x0 = dx < 0 ? wx.x : wx.z, x1 = dx < 0 ? wx.y : wx.w;
        float y0 = dy < 0 ? wy.x : wy.z, y1 = dy < 0 ? wy.y : wy.w;
        float w[4] = { x0 * y0, x1 * y0, x0 * y1, x1 * y1 };
        for (int k = 0; k < 4; k++) {
            float at = barg ? hl_depth_barg(hl_v3(d[k][0][i], d[k][1][i],
                                                  d[k][2][i])) : d[k][0][i];
            lit[i] += (at - f->at[i]) * sign >= 0.0f ? w[k] : 0.0f;
        }
    }
}

static void dim(struct pe_lit_run *r, uint32_t n, const float *lit)
{
    for (uint32_t i = 0; i < n; i++) {
        for (int c = 0; c < 3; c++)
            r->diffuse[c][i] *= lit[i];
        r->specular[0][i] *= lit[i];
    }
}

static bool all_dark(const struct pe_lit_run *r, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        if (r->diffuse[0][i] != 0.0f || r->diffuse[1][i] != 0.0f ||
            r->diffuse[2][i] != 0.0f)
            return false;
    return true;
}

void pe_shadow(const struct pe_draw *d, struct pe_lit_run *r, uint32_t n)
{
    const struct hl_shadow_block *b = pe_block(d, HL_SLOT_SHADOW, sizeof *b);
    uint32_t kind = pe_spec_uint(d, HL_SPEC_MAP_KIND);
    const struct pe_view *v = &d->view[HL_TEX_SHADOW];
    struct filters f;
    float lit[HL_PE_BATCH];
    if (all_dark(r, n))
        return;
    memset(lit, 0, sizeof lit);
    place(b, kind, pe_spec_float(d, HL_SPEC_MAP_SIZE), r, n, &f);
    for (int k = 0; k < 4; k++)
        quad(v, (kind & HL_MAP_BARG) != 0, b->map.z, &f, k & 1 ? 1 : -1,
             k & 2 ? 1 : -1, n, lit);
    dim(r, n, lit);
}
