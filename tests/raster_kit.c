/* SPDX-License-Identifier: Zlib */
#include <stdlib.h>
#include <string.h>
#include "shaders/shared/block.h"
#include "tests/raster_kit.h"

/* ---- stages ------------------------------------------------------------- */

static void shade_ones(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++)
        for (int c = 0; c < 4; c++)
            f->color[0][c][i] = 1.0f;
}

static void shade_color(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++)
        for (int c = 0; c < 4; c++)
            f->color[0][c][i] = f->vary[HL_PE_R + c][i];
}

static void shade_depths(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++) {
        f->color[0][0][i] = f->z[i];
        f->color[0][1][i] = f->dzdx[i];
        f->color[0][2][i] = f->dzdy[i];
        f->color[0][3][i] = f->vary[HL_PE_ID][i];
    }
}

static void shade_uv(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++) {
        f->color[0][0][i] = f->vary[HL_PE_U][i];
        f->color[0][1][i] = f->vary[HL_PE_V][i];
        f->color[0][2][i] = f->back[i];
        f->color[0][3][i] = 1.0f;
    }
}

static const struct hl_pe_stage stage_ones = { .shade = shade_ones };
static const struct hl_pe_stage stage_color = { .shade = shade_color };
static const struct hl_pe_stage stage_depths = { .shade = shade_depths,
                                                 .slope = true };
static const struct hl_pe_stage stage_uv = { .shade = shade_uv };

#define CODE(stage) { .kernel = (void (*)(void))(uintptr_t)&(stage) }
const struct hl_code rk_ones = CODE(stage_ones);
const struct hl_code rk_color = CODE(stage_color);
const struct hl_code rk_depths = CODE(stage_depths);
const struct hl_code rk_uv = CODE(stage_uv);

/* ---- machines ----------------------------------------------------------- */

static hl_tex make_tex(struct rk *r, enum hl_format format, uint32_t samples)
{
    struct hl_tex_desc t = { .label = "t", .format = format, .width = r->w,
                             .height = r->h, .samples = samples,
                             .usage = HL_TEX_TARGET };
    hl_tex tex;
    t.usage |= samples == 1 ? HL_TEX_READBACK : 0;
    assert_int_equal(hl_tex_create(r->d, &tex, &t), HL_OK);
    return tex;
}

/* Pixels to clip space, exact for sizes that are powers of two. */
static void set_pixels(struct rk *r)
{
    struct hl_object_block o;
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = 2.0f / (float)r->w;
    o.clip.column[1].y = 2.0f / (float)r->h;
    o.clip.column[2].z = 1.0f;
    o.clip.column[3].x = o.clip.column[3].y = -1.0f;
    o.clip.column[3].w = 1.0f;
    r->pixels = rk_buffer(r, &o, sizeof o, HL_BUF_UNIFORM);
}

static void set_desc(struct rk *r)
{
    struct hl_prog_desc *p = &r->desc;
    static const struct hl_vertex_layout layout = {
        .attr = { [HL_ATTR_POSITION] = { HL_ATTR_F32X3, 0, 0 },
                  [HL_ATTR_NORMAL] = { HL_ATTR_F32X3, 0, 12 },
                  [HL_ATTR_TANGENT] = { HL_ATTR_F32X4, 0, 24 },
                  [HL_ATTR_UV] = { HL_ATTR_F32X2, 0, 40 },
                  [HL_ATTR_COLOR] = { HL_ATTR_F32X4, 0, 48 } },
        .stride = { sizeof(struct rk_vertex) } };
    p->label = "raster";
    p->vertex.builtin = HL_SHADER_MESH_OWN_VERT;
    p->layout = layout;
    p->n_colors = 1;
    p->color[0] = HL_FORMAT_RGBA32_FLOAT;
    p->depth = HL_FORMAT_D24_UNORM_S8;
    p->samples = r->samples;
    p->blend = HL_BLEND_ADD;
}

static void open_with(struct rk *r, const struct hl_packemu_native *native,
                      const struct hl_profile *profile)
{
    r->m.backend = &hl_backend_packemu;
    struct hl_device_desc d = ck_desc(&r->m);
    d.native = native;
    d.profile = profile;
    assert_int_equal(hl_device_open(&r->d, &hl_backend_packemu, &d), HL_OK);
    r->m.device = r->d;
    r->color = make_tex(r, HL_FORMAT_RGBA32_FLOAT, r->samples);
    r->depth = make_tex(r, HL_FORMAT_D24_UNORM_S8, r->samples);
    if (r->samples > 1)
        r->resolved = make_tex(r, HL_FORMAT_RGBA32_FLOAT, 1);
    set_pixels(r);
    set_desc(r);
    r->pass.label = "raster";
    r->pass.n_colors = 1;
    r->pass.color[0].tex = r->color;
    r->pass.color[0].load = HL_LOAD_CLEAR;
    r->pass.color[0].resolve = r->resolved;
    r->pass.depth.tex = r->depth;
    r->pass.depth.load = HL_LOAD_CLEAR;
    r->pass.depth.clear[0] = 1.0f;
    r->out = malloc((size_t)r->w * r->h * 4 * sizeof *r->out);
    assert_non_null(r->out);
}

void rk_open(struct rk *r, uint32_t threads, uint32_t w, uint32_t h,
             uint32_t samples)
{
    struct hl_packemu_native native = { threads };
    memset(r, 0, sizeof *r);
    r->w = w;
    r->h = h;
    r->samples = samples;
    open_with(r, &native, NULL);
}

void rk_open_profile(struct rk *r, const struct hl_profile *profile,
                     uint32_t w, uint32_t h)
{
    memset(r, 0, sizeof *r);
    r->w = w;
    r->h = h;
    r->samples = 1;
    open_with(r, NULL, profile);
}

void rk_close(struct rk *r)
{
    free(r->out);
    ck_close(&r->m);
}

/* ---- draws -------------------------------------------------------------- */

struct rk_vertex rk_at(float x, float y, float z)
{
    struct rk_vertex v = { .p = { x, y, z }, .tangent = { 0, 0, 0, 1 } };
    return v;
}

hl_buf rk_buffer(struct rk *r, const void *data, size_t bytes, uint32_t usage)
{
    struct hl_buf_desc b = { "b", bytes, usage, false, data };
    hl_buf buf;
    assert_int_equal(hl_buf_create(r->d, &buf, &b), HL_OK);
    return buf;
}

static struct hl_draw *add(struct rk *r, const struct hl_prog_desc *p)
{
    assert_true(r->n < RK_DRAWS);
    struct hl_draw *d = &r->draw[r->n++];
    memset(d, 0, sizeof *d);
    assert_int_equal(hl_prog_create(r->d, &d->prog, p), HL_OK);
    d->uniform[HL_SLOT_OBJECT].buf = r->pixels;
    d->uniform[HL_SLOT_OBJECT].bytes = sizeof(struct hl_object_block);
    return d;
}

struct hl_draw *rk_add(struct rk *r, const struct hl_code *stage,
                       const struct rk_vertex *v, uint32_t n,
                       const uint32_t *indices, uint32_t n_indices)
{
    struct hl_prog_desc p = r->desc;
    p.fragment.code = stage ? stage : &rk_ones;
    p.no_color_write |= !stage;
    struct hl_draw *d = add(r, &p);
    d->vertex[0] = rk_buffer(r, v, n * sizeof *v, HL_BUF_VERTEX);
    d->count = indices ? n_indices : n;
    if (indices)
        d->index = rk_buffer(r, indices, n_indices * sizeof *indices,
                             HL_BUF_INDEX);
    return d;
}

struct hl_draw *rk_screen(struct rk *r, const struct hl_code *stage)
{
    struct hl_prog_desc p = r->desc;
    p.fragment.code = stage;
    p.vertex.builtin = HL_SHADER_SCREEN_VERT;
    memset(&p.layout, 0, sizeof p.layout);
    struct hl_draw *d = add(r, &p);
    d->count = 3;
    return d;
}

const float *rk_run(struct rk *r)
{
    r->pass.draws = r->draw;
    r->pass.n_draws = r->n;
    assert_int_equal(hl_pass_run(r->d, &r->pass), HL_OK);
    assert_int_equal(hl_tex_read(r->d, r->samples > 1 ? r->resolved
                                                      : r->color, r->out,
                                 (size_t)r->w * r->h * 16), HL_OK);
    for (uint32_t i = 0; i < r->n; i++) {
        hl_prog_destroy(r->d, &r->draw[i].prog);
        hl_buf_destroy(r->d, &r->draw[i].vertex[0]);
        hl_buf_destroy(r->d, &r->draw[i].index);
    }
    r->n = 0;
    return r->out;
}

float rk_px(const struct rk *r, uint32_t x, uint32_t y, uint32_t channel)
{
    return r->out[((size_t)y * r->w + x) * 4 + channel];
}
