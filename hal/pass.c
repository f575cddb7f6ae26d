/* SPDX-License-Identifier: Zlib */
/* Passes: every draw and target is checked, handles become slots. */
#include <string.h>
#include "hal/device.h"

static enum hl_result refuse_draw(struct hl_device *d, uint32_t i,
                                  const char *why)
{
    return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                            "hl_pass.draws", i, why);
}

/* ---- targets ------------------------------------------------------------ */

static enum hl_result take_target(struct hl_device *d, struct hl_bk_pass *p,
                                  struct hl_bk_target *out,
                                  const struct hl_target *t, bool depth)
{
    const struct hl_pool *pool = &d->pool[HL_POOL_TEX];
    out->slot = hl_pool_find(pool, t->tex.id);
    out->resolve = HL_NO_SLOT;
    out->load = t->load;
    out->discard = t->discard;
    memcpy(out->clear, t->clear, sizeof out->clear);
    if ((unsigned)t->load > HL_LOAD_DISCARD)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_target.load",
                         "not one of its enum");
    if (out->slot == HL_NO_SLOT)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_HANDLE, "hl_pass target",
                         "not a live texture");
    const struct hl_tex_desc *x = &d->texs[out->slot];
    if (!(x->usage & HL_TEX_TARGET) ||
        (hl_format_info(x->format)->kind == HL_KIND_DEPTH) != depth)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_pass target",
                         "its texture is not made for this use");
    if (depth && t->load == HL_LOAD_CLEAR &&
        !(t->clear[1] >= 0.0f && t->clear[1] <= 255.0f))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_target.clear[1]", "not a stencil of 0..255");
    if (p->width == 0) {
        p->width = x->width;
        p->height = x->height;
        p->samples = x->samples;
    }
    if (x->width != p->width || x->height != p->height ||
        x->samples != p->samples)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_pass target",
                         "size or sample count differs from the first");
    if (t->resolve.id == 0)
        return HL_OK;
    out->resolve = hl_pool_find(pool, t->resolve.id);
    if (out->resolve == HL_NO_SLOT || x->samples == 1 || depth)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_HANDLE, "hl_target.resolve",
                         "needs a live texture and a multisampled colour");
    const struct hl_tex_desc *y = &d->texs[out->resolve];
    if (y->width != x->width || y->height != x->height || y->samples != 1 ||
        y->format != x->format || !(y->usage & HL_TEX_TARGET))
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_target.resolve", "size, format or usage differs");
    return HL_OK;
}

/* Is colour i, or what it resolves to, written by an earlier one? */
static bool twice(const struct hl_bk_pass *p, uint32_t i)
{
    const struct hl_bk_target *t = &p->color[i];
    for (uint32_t k = 0; k < i; k++) {
        const struct hl_bk_target *u = &p->color[k];
        if (t->slot == u->slot || t->slot == u->resolve ||
            (t->resolve != HL_NO_SLOT &&
             (t->resolve == u->slot || t->resolve == u->resolve)))
            return true;
    }
    return false;
}

/* EDRAM tiles first..first+n of a target whose place the caller chose. */
static bool placed(const struct hl_device *d, uint32_t slot, uint64_t *first,
                   uint64_t *n)
{
    if (slot == HL_NO_SLOT || d->texs[slot].console.edram_tile == 0)
        return false;
    const struct hl_tex_desc *t = &d->texs[slot];
    *first = t->console.edram_tile - 1u;
    *n = hl_edram_tiles(&d->caps.profile, t->format, t->width, t->height,
                        t->samples);
    return true;
}

/* Two targets of one pass would draw over each other, in an order that
 * nobody has fixed. Addresses wrap at the EDRAM's end. */
static bool overlap(const struct hl_device *d, uint32_t a, uint32_t b)
{
    uint64_t a0, an, b0, bn, all = d->caps.profile.edram_tiles;
    if (!placed(d, a, &a0, &an) || !placed(d, b, &b0, &bn))
        return false;
    return (b0 + all - a0) % all < an || (a0 + all - b0) % all < bn;
}

static bool overlapping(const struct hl_device *d, const struct hl_bk_pass *p)
{
    for (uint32_t i = 0; i < p->n_colors; i++) {
        if (overlap(d, p->color[i].slot, p->depth.slot))
            return true;
        for (uint32_t k = 0; k < i; k++)
            if (overlap(d, p->color[i].slot, p->color[k].slot))
                return true;
    }
    return false;
}

static enum hl_result take_targets(struct hl_device *d, struct hl_bk_pass *o,
                                   const struct hl_pass *p)
{
    memset(o, 0, sizeof *o);
    o->label = p->label ? p->label : "";
    o->n_colors = p->n_colors;
    o->depth_read_only = p->depth_read_only;
    o->half_pixel_offset = p->half_pixel_offset;
    o->depth.slot = HL_NO_SLOT;
    o->depth.resolve = HL_NO_SLOT;
    if (p->half_pixel_offset && !d->caps.profile.integer_centers)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                         "hl_pass.half_pixel_offset",
                         "this machine's pixel centres are at halves");
    if (p->n_colors > HL_MAX_COLORS || p->n_colors > d->caps.max_colors)
        return hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                "hl_pass.n_colors", p->n_colors,
                                " is more than the device has");
    for (uint32_t i = 0; i < p->n_colors; i++) {
        enum hl_result r = take_target(d, o, &o->color[i], &p->color[i],
                                       false);
        if (r == HL_OK && twice(o, i))
            r = hl_refuse_number(d, HL_ERR_INVALID, HL_MSG_ARGUMENT,
                                 "hl_pass.color", i,
                                 " is a target of this pass already");
        if (r != HL_OK)
            return r;
    }
    if (p->depth.tex.id != 0 && p->depth_read_only &&
        p->depth.load != HL_LOAD_KEEP)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_pass.depth",
                         "read only, but not kept");
    if (p->depth.tex.id != 0)
        return take_target(d, o, &o->depth, &p->depth, true);
    if (p->n_colors == 0)
        return hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_pass",
                         "no target");
    return HL_OK;
}

/* ---- draws -------------------------------------------------------------- */

/* Targets that no draw of the pass may sample. */
static bool is_target(const struct hl_device *d, const struct hl_bk_pass *p,
                      uint32_t slot)
{
    bool apart = d->caps.console_memory && d->caps.profile.resolve_to_read;
    bool readable = apart || (p->depth_read_only &&
                              !d->caps.profile.depth_copy_if_bound);
    for (uint32_t i = 0; i < p->n_colors; i++)
        if (p->color[i].slot == slot || p->color[i].resolve == slot)
            return true;
    return p->depth.slot == slot && !readable;
}

static bool prog_fits(const struct hl_device *d, const struct hl_bk_pass *p,
                      const struct hl_prog_state *s)
{
    enum hl_format depth = p->depth.slot == HL_NO_SLOT
                           ? HL_FORMAT_NONE : d->texs[p->depth.slot].format;
    if (s->n_colors != p->n_colors || s->samples != p->samples ||
        s->depth != depth || (p->depth_read_only && s->depth_write))
        return false;
    for (uint32_t i = 0; i < p->n_colors; i++)
        if (d->texs[p->color[i].slot].format != s->color[i])
            return false;
    return true;
}

static bool take_range(struct hl_device *d, struct hl_bk_range *out,
                       const struct hl_range *in, uint32_t usage,
                       uint32_t align, uint32_t max)
{
    out->slot = HL_NO_SLOT;
    if (in->buf.id == 0)
        return true;
    uint32_t slot = hl_pool_find(&d->pool[HL_POOL_BUF], in->buf.id);
    if (slot == HL_NO_SLOT)
        return false;
    const struct hl_buf_state *b = &d->bufs[slot];
    if (!(b->usage & usage) || in->bytes == 0 || in->bytes > max ||
        in->offset % align || in->offset > b->bytes ||
        in->bytes > b->bytes - in->offset)
        return false;
    out->slot = slot;
    out->offset = in->offset;
    out->bytes = in->bytes;
    return true;
}

static const char *take_ranges(struct hl_device *d, struct hl_bk_draw *o,
                               const struct hl_draw *w)
{
    for (int i = 0; i < HL_MAX_UNIFORMS; i++)
        if (!take_range(d, &o->uniform[i], &w->uniform[i], HL_BUF_UNIFORM,
                        d->caps.uniform_align, d->caps.max_uniform_bytes))
            return ": a uniform range is stale, misaligned or past its buffer";
    for (int i = 0; i < HL_MAX_STORAGE; i++)
        if (!take_range(d, &o->storage[i], &w->storage[i], HL_BUF_STORAGE,
                        d->caps.storage_align, d->caps.max_storage_bytes))
            return ": a storage range is stale, misaligned or past its buffer";
    return NULL;
}

static const char *take_textures(struct hl_device *d, struct hl_bk_draw *o,
                                 const struct hl_bk_pass *p,
                                 const struct hl_draw *w)
{
    if (w->n_textures > HL_MAX_TEXTURES || (w->n_textures && !w->textures))
        return ": n_textures is too large or has no array";
    o->n_textures = w->n_textures;
    for (uint32_t i = 0; i < w->n_textures; i++) {
        const struct hl_texture_binding *b = &w->textures[i];
        struct hl_bk_texture *t = &o->texture[i];
        t->slot = HL_NO_SLOT;
        t->filter = b->filter;
        t->wrap_u = b->wrap_u;
        t->wrap_v = b->wrap_v;
        if (b->filter > HL_FILTER_TRILINEAR || b->wrap_u > HL_WRAP_MIRROR ||
            b->wrap_v > HL_WRAP_MIRROR)
            return ": unknown filter or wrap";
        if (b->tex.id == 0)
            continue;
        t->slot = hl_pool_find(&d->pool[HL_POOL_TEX], b->tex.id);
        if (t->slot == HL_NO_SLOT ||
            !(d->texs[t->slot].usage & HL_TEX_SAMPLED))
            return ": a texture is stale or not made to be sampled";
        if (b->filter != HL_FILTER_NEAREST &&
            !(d->caps.format[d->texs[t->slot].sample_as].use & HL_USE_LINEAR))
            return ": filters a format that this device only fetches";
        if (is_target(d, p, t->slot))
            return ": samples a target of its own pass";
    }
    return NULL;
}

static const char *take_geometry(struct hl_device *d, struct hl_bk_draw *o,
                                 const struct hl_draw *w)
{
    const struct hl_pool *pool = &d->pool[HL_POOL_BUF];
    for (int i = 0; i < HL_MAX_STREAMS; i++) {
        o->vertex[i] = hl_pool_find(pool, w->vertex[i].id);
        if (w->vertex[i].id != 0 &&
            (o->vertex[i] == HL_NO_SLOT ||
             !(d->bufs[o->vertex[i]].usage & HL_BUF_VERTEX)))
            return ": a vertex buffer is stale or not one";
        if (w->vertex[i].id == 0 && (d->progs[o->prog].streams >> i & 1))
            return ": the program's layout reads a stream that is not bound";
    }
    o->index = hl_pool_find(pool, w->index.id);
    o->index16 = w->index16;
    o->first = w->first;
    o->count = w->count;
    o->base_vertex = w->base_vertex;
    o->instances = w->instances ? w->instances : 1;
    if (w->index.id == 0)
        return NULL;
    if (o->index == HL_NO_SLOT || !(d->bufs[o->index].usage & HL_BUF_INDEX))
        return ": the index buffer is stale or not one";
    size_t n = d->bufs[o->index].bytes / (w->index16 ? 2 : 4);
    if (w->first > n || w->count > n - w->first)
        return ": indices end past their buffer";
    return NULL;
}

/* False: nothing of the scissor is inside the target. */
static bool take_scissor(struct hl_rect *out, const struct hl_rect *in,
                         const struct hl_bk_pass *p)
{
    int64_t w = (int64_t)p->width, h = (int64_t)p->height;
    int64_t x0 = 0, y0 = 0, x1 = w, y1 = h;
    if (in->width != 0) {
        x0 = in->x;
        y0 = in->y;
        x1 = x0 + in->width;
        y1 = y0 + in->height;
    }
    x0 = x0 < 0 ? 0 : x0;
    y0 = y0 < 0 ? 0 : y0;
    x1 = x1 > w ? w : x1;
    y1 = y1 > h ? h : y1;
    if (x1 <= x0 || y1 <= y0)
        return false;
    out->x = (int32_t)x0;
    out->y = (int32_t)y0;
    out->width = (int32_t)(x1 - x0);
    out->height = (int32_t)(y1 - y0);
    return true;
}

/* 1 taken, 0 draws nothing, -1 refused and logged. */
static int take_draw(struct hl_device *d, struct hl_bk_draw *o,
                     const struct hl_bk_pass *p, const struct hl_pass *pass,
                     uint32_t i)
{
    const struct hl_draw *w = &pass->draws[i];
    const char *why = NULL;
    o->prog = hl_pool_find(&d->pool[HL_POOL_PROG], w->prog.id);
    if (o->prog == HL_NO_SLOT)
        why = ": not a live program";
    else if (!prog_fits(d, p, &d->progs[o->prog]))
        why = ": the program was made for other targets";
    if (!why)
        why = take_geometry(d, o, w);
    if (!why)
        why = take_ranges(d, o, w);
    if (!why)
        why = take_textures(d, o, p, w);
    if (why) {
        refuse_draw(d, i, why);
        return -1;
    }
    return w->count > 0 && take_scissor(&o->scissor, &w->scissor, p);
}

static bool reserve_draws(struct hl_device *d, uint32_t n)
{
    if (n <= d->max_draws)
        return true;
    if (n > 0x1000000)
        return false;
    uint32_t max = n < 1024 ? 1024 : n + n / 2;
    struct hl_bk_draw *draws = hl_bk_alloc(d, max * sizeof *draws);
    if (!draws)
        return false;
    hl_bk_free(d, d->draws);
    d->draws = draws;
    d->max_draws = max;
    return true;
}

enum hl_result hl_pass_run(struct hl_device *d, const struct hl_pass *pass)
{
    if (!d || !pass || (pass->n_draws && !pass->draws))
        return HL_ERR_INVALID;
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    struct hl_bk_pass p;
    enum hl_result r = take_targets(d, &p, pass);
    if (r == HL_OK && overlapping(d, &p))
        r = hl_refuse(d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_pass",
                      "two of its targets lie on the same EDRAM tiles");
    if (r != HL_OK)
        return r;
    if (!reserve_draws(d, pass->n_draws))
        return hl_refuse_number(d, HL_ERR_MEMORY, HL_MSG_MEMORY,
                                "hl_pass.n_draws", pass->n_draws,
                                " draws find no memory");
    uint32_t n = 0;
    uint64_t triangles = 0;
    for (uint32_t i = 0; i < pass->n_draws; i++) {
        int taken = take_draw(d, &d->draws[n], &p, pass, i);
        if (taken < 0)
            return HL_ERR_INVALID;
        if (taken) {
            triangles += (uint64_t)(d->draws[n].count / 3) *
                         d->draws[n].instances;
            n++;
        }
    }
    r = d->backend->pass_run(d->state, &p, d->draws, n);
    if (r == HL_ERR_DEVICE_LOST)
        d->lost = true;
    if (r == HL_OK) {
        d->counts.passes++;
        d->counts.draws += n;
        d->counts.triangles += triangles;
    }
    return r;
}

enum hl_result hl_submit(struct hl_device *d, bool wait)
{
    if (!d)
        return HL_ERR_INVALID;
    if (d->lost)
        return HL_ERR_DEVICE_LOST;
    enum hl_result r = d->backend->submit(d->state, wait);
    if (r == HL_ERR_DEVICE_LOST)
        d->lost = true;
    return r;
}

uint32_t hl_timings(struct hl_device *d, struct hl_timing *out, uint32_t max)
{
    if (!d || (max && !out))
        return 0;
    return d->backend->timings(d->state, out, max);
}
