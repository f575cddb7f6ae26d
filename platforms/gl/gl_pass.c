/* SPDX-License-Identifier: Zlib */
/* A pass: its framebuffer, loads, draws, resolves; submit and timings. What
 * may fail is done before the first command. */
#include <string.h>
#include "platforms/gl/gl.h"

/* ---- targets ----------------------------------------------------------- */

struct targets {
    const struct hlgl_tex *color[HL_MAX_COLORS], *depth;
    GLuint fbo, resolve[HL_MAX_COLORS];   /* framebuffers; 0: none           */
};

static enum hl_result find_targets(struct hlgl *g, const struct hl_bk_pass *p,
                                   struct targets *t)
{
    memset(t, 0, sizeof *t);
    for (uint32_t i = 0; i < p->n_colors; i++)
        t->color[i] = &g->texs[p->color[i].slot];
    if (p->depth.slot != HL_NO_SLOT)
        t->depth = &g->texs[p->depth.slot];
    enum hl_result r = hlgl_fbo_find(g, t->color, p->n_colors, t->depth,
                                     &t->fbo);
    for (uint32_t i = 0; i < p->n_colors && !r; i++) {
        if (p->color[i].resolve == HL_NO_SLOT)
            continue;
        const struct hlgl_tex *to = &g->texs[p->color[i].resolve];
        r = hlgl_fbo_find(g, &to, 1, NULL, &t->resolve[i]);
    }
    return r;
}

static void clear_color(const struct hlgl *g, const struct targets *t,
                        GLint i, const float clear[4])
{
    GLuint whole[4];
    if (hl_format_info(t->color[i]->format)->kind != HL_KIND_UINT) {
        g->gl.ClearNamedFramebufferfv(t->fbo, GL_COLOR, i, clear);
        return;
    }
    /* 4294967040 is the largest float below 2^32. */
    for (int k = 0; k < 4; k++)
        whole[k] = !(clear[k] > 0.0f) ? 0
                 : clear[k] > 4294967040.0f ? UINT32_MAX : (GLuint)clear[k];
    g->gl.ClearNamedFramebufferuiv(t->fbo, GL_COLOR, i, whole);
}

static void clear_depth(const struct hlgl *g, const struct targets *t,
                        const float clear[4])
{
    if (hl_format_info(t->depth->format)->bits[1])
        g->gl.ClearNamedFramebufferfi(t->fbo, GL_DEPTH_STENCIL, 0, clear[0],
                                      (GLint)clear[1]);
    else
        g->gl.ClearNamedFramebufferfv(t->fbo, GL_DEPTH, 0, clear);
}

static void invalidate(const struct hlgl *g, const struct targets *t,
                       const struct hl_bk_pass *p, bool before)
{
    GLenum list[HL_MAX_COLORS + 1];
    GLsizei n = 0;
    for (uint32_t i = 0; i < p->n_colors; i++)
        if (before ? p->color[i].load == HL_LOAD_DISCARD
                   : p->color[i].discard)
            list[n++] = GL_COLOR_ATTACHMENT0 + i;
    if (t->depth && (before ? p->depth.load == HL_LOAD_DISCARD
                            : p->depth.discard))
        list[n++] = hlgl_attachment(t->depth->format, 0);
    if (n)
        g->gl.InvalidateNamedFramebufferData(t->fbo, n, list);
}

/* Masks and scissor act on clears: off, until the draws. */
static void load(const struct hlgl *g, const struct targets *t,
                 const struct hl_bk_pass *p)
{
    g->gl.Disable(GL_SCISSOR_TEST);
    g->gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    g->gl.DepthMask(GL_TRUE);
    g->gl.StencilMask(255);
    invalidate(g, t, p, true);
    for (uint32_t i = 0; i < p->n_colors; i++)
        if (p->color[i].load == HL_LOAD_CLEAR)
            clear_color(g, t, (GLint)i, p->color[i].clear);
    if (t->depth && p->depth.load == HL_LOAD_CLEAR)
        clear_depth(g, t, p->depth.clear);
}

static void resolve(const struct hlgl *g, const struct targets *t,
                    const struct hl_bk_pass *p)
{
    GLint w = (GLint)p->width, h = (GLint)p->height;
    g->gl.Disable(GL_SCISSOR_TEST);
    for (uint32_t i = 0; i < p->n_colors; i++) {
        if (!t->resolve[i])
            continue;
        g->gl.NamedFramebufferReadBuffer(t->fbo, GL_COLOR_ATTACHMENT0 + i);
        g->gl.BlitNamedFramebuffer(t->fbo, t->resolve[i], 0, 0, w, h, 0, 0, w,
                                   h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
}

/* ---- draws ------------------------------------------------------------- */

struct range { uint32_t serial, offset, bytes; };

/* What is bound in a pass; nothing is bound twice. */
struct bound {
    const struct hlgl_prog *prog;
    struct hlgl_layout *layout;
    struct range uniform[HL_MAX_UNIFORMS], storage[HL_MAX_STORAGE];
    uint32_t texture[HL_MAX_TEXTURES];    /* serials                         */
    GLuint sampler[HL_MAX_TEXTURES];
    struct hl_rect scissor;
};

static void switch_on(const struct hlgl *g, GLenum what, bool on)
{
    if (on)
        g->gl.Enable(what);
    else
        g->gl.Disable(what);
}

/* Factors: source and destination of colour, then of alpha. */
static const struct { GLenum color[2], alpha[2], op; } blends[] = {
    [HL_BLEND_ADD] = { { GL_ONE, GL_ONE }, { GL_ONE, GL_ONE }, GL_FUNC_ADD },
    [HL_BLEND_OVER] = { { GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA },
                        { GL_ONE, GL_ONE_MINUS_SRC_ALPHA }, GL_FUNC_ADD },
    [HL_BLEND_ADD_ALPHA] = { { GL_SRC_ALPHA, GL_ONE }, { GL_ZERO, GL_ONE },
                             GL_FUNC_ADD },
    [HL_BLEND_MAX] = { { GL_ONE, GL_ONE }, { GL_ONE, GL_ONE }, GL_MAX },
    [HL_BLEND_SHIFT] = { { GL_ONE, GL_CONSTANT_COLOR },
                         { GL_ONE, GL_CONSTANT_ALPHA }, GL_FUNC_ADD }
};

static void set_blend(const struct hlgl *g, const struct hlgl_prog *p)
{
    GLboolean write = !p->no_color_write;
    g->gl.ColorMask(write, write, write, write);
    switch_on(g, GL_BLEND, p->blend != HL_BLEND_OFF);
    if (p->blend == HL_BLEND_OFF)
        return;
    g->gl.BlendFuncSeparate(blends[p->blend].color[0],
                            blends[p->blend].color[1],
                            blends[p->blend].alpha[0],
                            blends[p->blend].alpha[1]);
    g->gl.BlendEquation(blends[p->blend].op);
    g->gl.BlendColor(p->blend_constant, p->blend_constant, p->blend_constant,
                     p->blend_constant);
}

static const GLenum compares[] = {
    [HL_COMPARE_OFF] = GL_ALWAYS, [HL_COMPARE_NEVER] = GL_NEVER,
    [HL_COMPARE_LESS] = GL_LESS, [HL_COMPARE_LESS_EQUAL] = GL_LEQUAL,
    [HL_COMPARE_EQUAL] = GL_EQUAL, [HL_COMPARE_GREATER_EQUAL] = GL_GEQUAL,
    [HL_COMPARE_GREATER] = GL_GREATER, [HL_COMPARE_ALWAYS] = GL_ALWAYS
};

static void set_stencil_face(const struct hlgl *g, const struct hl_stencil *s,
                             const struct hl_stencil_face *face, GLenum which)
{
    static const GLenum ops[] = {
        [HL_STENCIL_KEEP] = GL_KEEP, [HL_STENCIL_ZERO] = GL_ZERO,
        [HL_STENCIL_REPLACE] = GL_REPLACE, [HL_STENCIL_INCREMENT] = GL_INCR,
        [HL_STENCIL_DECREMENT] = GL_DECR,
        [HL_STENCIL_INCREMENT_WRAP] = GL_INCR_WRAP,
        [HL_STENCIL_DECREMENT_WRAP] = GL_DECR_WRAP,
        [HL_STENCIL_INVERT] = GL_INVERT
    };
    g->gl.StencilFuncSeparate(which, compares[face->test], s->reference,
                              s->read_mask);
    g->gl.StencilOpSeparate(which, ops[face->fail], ops[face->depth_fail],
                            ops[face->pass]);
}

/* set_raster says which winding is GL's front face, of stencil too. */
static void set_stencil(const struct hlgl *g, const struct hl_stencil *s)
{
    bool on = s->front.test != HL_COMPARE_OFF;
    switch_on(g, GL_STENCIL_TEST, on);
    if (!on)
        return;
    set_stencil_face(g, s, &s->front, GL_FRONT);
    set_stencil_face(g, s, &s->back, GL_BACK);
    g->gl.StencilMask(s->write_mask);
}

static void set_raster(const struct hlgl *g, const struct hlgl_prog *p)
{
    switch_on(g, GL_DEPTH_TEST, p->depth_test != HL_COMPARE_OFF);
    g->gl.DepthFunc(compares[p->depth_test]);
    g->gl.DepthMask(p->depth_write);
    switch_on(g, GL_CULL_FACE, p->cull != HL_CULL_NONE);
    g->gl.CullFace(p->cull == HL_CULL_FRONT ? GL_FRONT : GL_BACK);
    /* GL looks from the other side: its y goes up from row 0. */
    g->gl.FrontFace(p->mirrored ? GL_CCW : GL_CW);
}

static void bind_prog(struct hlgl *g, struct bound *b,
                      const struct hlgl_prog *p)
{
    if (p == b->prog)
        return;
    g->gl.UseProgram(p->program);
    set_blend(g, p);
    set_raster(g, p);
    set_stencil(g, &p->stencil);
    if (&g->layouts[p->layout] != b->layout) {
        b->layout = &g->layouts[p->layout];
        g->gl.BindVertexArray(b->layout->vao);
    }
    b->prog = p;
}

static void bind_geometry(const struct hlgl *g, struct hlgl_layout *l,
                          const struct hlgl_prog *p,
                          const struct hl_bk_draw *d)
{
    for (GLuint i = 0; p->streams >> i; i++) {
        if (!(p->streams >> i & 1))
            continue;
        const struct hlgl_buf *b = &g->bufs[d->vertex[i]];
        if (b->serial == l->stream[i])
            continue;
        g->gl.VertexArrayVertexBuffer(l->vao, i, b->buffer, 0,
                                      l->key.stride[i]);
        l->stream[i] = b->serial;
    }
    if (d->index == HL_NO_SLOT || g->bufs[d->index].serial == l->index)
        return;
    g->gl.VertexArrayElementBuffer(l->vao, g->bufs[d->index].buffer);
    l->index = g->bufs[d->index].serial;
}

/* Serial 0 is what a pass begins with: the dummy. */
static void bind_ranges(const struct hlgl *g, GLenum target,
                        struct range *bound, const struct hl_bk_range *r,
                        GLuint n)
{
    for (GLuint i = 0; i < n; i++) {
        const struct hlgl_buf *b =
            r[i].slot == HL_NO_SLOT ? NULL : &g->bufs[r[i].slot];
        uint32_t serial = b ? b->serial : 0;
        if (serial == bound[i].serial &&
            (!b || (r[i].offset == bound[i].offset &&
                    r[i].bytes == bound[i].bytes)))
            continue;
        bound[i].serial = serial;
        bound[i].offset = r[i].offset;
        bound[i].bytes = r[i].bytes;
        if (b)
            g->gl.BindBufferRange(target, i, b->buffer,
                                  (GLintptr)r[i].offset,
                                  (GLsizeiptr)r[i].bytes);
        else
            g->gl.BindBufferBase(target, i, g->dummy);
    }
}

static void bind_texture(const struct hlgl *g, struct bound *b, GLuint i,
                         const struct hlgl_tex *t, GLuint sampler)
{
    if (t->serial != b->texture[i])
        g->gl.BindTextureUnit(i, t->view);
    if (sampler != b->sampler[i])
        g->gl.BindSampler(i, sampler);
    b->texture[i] = t->serial;
    b->sampler[i] = sampler;
}

static void bind_textures(const struct hlgl *g, struct bound *b,
                          const struct hl_bk_draw *d)
{
    for (uint32_t i = 0; i < HL_MAX_TEXTURES; i++) {
        const struct hl_bk_texture *t = &d->texture[i];
        if (i >= d->n_textures || t->slot == HL_NO_SLOT)
            bind_texture(g, b, i, &g->white, g->samplers[0]);
        else
            bind_texture(g, b, i, &g->texs[t->slot],
                         g->samplers[(t->filter * 3 + t->wrap_u) * 3 +
                                     t->wrap_v]);
    }
}

static void run_draw(struct hlgl *g, struct bound *b,
                     const struct hl_bk_draw *d)
{
    const struct hlgl_prog *p = &g->progs[d->prog];
    GLenum mode = p->topology == HL_TOPOLOGY_LINES ? GL_LINES : GL_TRIANGLES;
    bind_prog(g, b, p);
    bind_geometry(g, b->layout, p, d);
    bind_ranges(g, GL_UNIFORM_BUFFER, b->uniform, d->uniform,
                HL_MAX_UNIFORMS);
    bind_ranges(g, GL_SHADER_STORAGE_BUFFER, b->storage, d->storage,
                HL_MAX_STORAGE);
    bind_textures(g, b, d);
    if (memcmp(&d->scissor, &b->scissor, sizeof b->scissor)) {
        g->gl.Scissor(d->scissor.x, d->scissor.y, d->scissor.width,
                      d->scissor.height);
        b->scissor = d->scissor;
    }
    if (d->index == HL_NO_SLOT) {
        g->gl.DrawArraysInstanced(mode, (GLint)d->first, (GLsizei)d->count,
                                  (GLsizei)d->instances);
        return;
    }
    uintptr_t at = (uintptr_t)d->first * (d->index16 ? 2 : 4);
    g->gl.DrawElementsInstancedBaseVertex(
        mode, (GLsizei)d->count,
        d->index16 ? GL_UNSIGNED_SHORT : GL_UNSIGNED_INT, (const void *)at,
        (GLsizei)d->instances, d->base_vertex);
}

static void run_draws(struct hlgl *g, const struct hl_bk_draw *draws,
                      uint32_t n)
{
    struct bound b;
    memset(&b, 0, sizeof b);
    if (!n)
        return;
    for (GLuint i = 0; i < HL_MAX_UNIFORMS; i++)
        g->gl.BindBufferBase(GL_UNIFORM_BUFFER, i, g->dummy);
    for (GLuint i = 0; i < HL_MAX_STORAGE; i++)
        g->gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, i, g->dummy);
    g->gl.Enable(GL_SCISSOR_TEST);
    for (uint32_t i = 0; i < n; i++)
        run_draw(g, &b, &draws[i]);
}

/* ---- passes ------------------------------------------------------------ */

/* One stamp, at the end: a pass lasts from the end of the one before. llvmpipe
 * takes a stamp anew in every bin of the target and keeps the last, which is
 * right at the end of a pass only; elapsed-time queries suffer the same. */
static enum hl_result reserve_query(struct hlgl *g, struct hlgl_frame *f)
{
    uint32_t need = f->n_passes + 1;
    if (!g->timestamps)
        return HL_OK;
    if (!hl_bk_grow(g->device, &f->queries, &f->max_queries, need,
                    sizeof *f->queries) ||
        !hl_bk_grow(g->device, &f->labels, &f->max_labels, need,
                    sizeof *f->labels))
        return HL_ERR_MEMORY;
    if (need > f->n_queries) {
        g->gl.CreateQueries(GL_TIMESTAMP, 1, &f->queries[f->n_queries]);
        f->n_queries++;
    }
    return HL_OK;
}

enum hl_result hlgl_pass_run(void *state, const struct hl_bk_pass *pass,
                             const struct hl_bk_draw *draws, uint32_t n)
{
    struct hlgl *g = state;
    struct hlgl_frame *f = &g->frames[g->frame];
    struct targets t;
    enum hl_result r = hlgl_enter(g);
    if (!r)
        r = reserve_query(g, f);
    if (!r)
        r = find_targets(g, pass, &t);
    if (r)
        return r;
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, t.fbo);
    g->gl.Viewport(0, 0, (GLsizei)pass->width, (GLsizei)pass->height);
    if (g->timestamps && f->n_passes == 0)
        g->gl.GetInteger64v(GL_TIMESTAMP, &f->began);
    load(g, &t, pass);
    run_draws(g, draws, n);
    resolve(g, &t, pass);
    invalidate(g, &t, pass, false);
    if (g->timestamps) {
        g->gl.QueryCounter(f->queries[f->n_passes], GL_TIMESTAMP);
        f->labels[f->n_passes++] = pass->label;
    }
    return HL_OK;
}

/* ---- submit ------------------------------------------------------------ */

static enum hl_result retire(struct hlgl *g, struct hlgl_frame *f)
{
    enum { SECOND_NS = 1000000000 };
    GLenum done = GL_TIMEOUT_EXPIRED;
    while (f->fence && done == GL_TIMEOUT_EXPIRED)
        done = g->gl.ClientWaitSync(f->fence, GL_SYNC_FLUSH_COMMANDS_BIT,
                                    SECOND_NS);
    g->gl.DeleteSync(f->fence);
    f->fence = NULL;
    if (done != GL_WAIT_FAILED)
        return HL_OK;
    hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_DEVICE, "waiting for GL failed",
              NULL, NULL);
    return HL_ERR_DEVICE_LOST;
}

/* When pass i was done. */
static GLuint64 end_of(const struct hlgl *g, const struct hlgl_frame *f,
                       uint32_t i)
{
    GLuint64 ns = 0;
    g->gl.GetQueryObjectui64v(f->queries[i], GL_QUERY_RESULT, &ns);
    return ns;
}

/* Of f, which was begun while `before` may still have been under way. */
static void read_timings(struct hlgl *g, const struct hlgl_frame *f,
                         const struct hlgl_frame *before)
{
    GLuint64 from = (GLuint64)f->began;
    g->n_timings = 0;
    if (!hl_bk_grow(g->device, &g->timings, &g->max_timings, f->n_passes,
                   sizeof *g->timings))
        return;
    if (before->n_passes && end_of(g, before, before->n_passes - 1) > from)
        from = end_of(g, before, before->n_passes - 1);
    for (uint32_t i = 0; i < f->n_passes; i++) {
        GLuint64 to = end_of(g, f, i);
        g->timings[i].label = f->labels[i];
        g->timings[i].ms = to > from ? (double)(to - from) * 1e-6 : 0.0;
        from = to > from ? to : from;
    }
    g->n_timings = f->n_passes;
}

enum hl_result hlgl_flush(struct hlgl *g, bool wait)
{
    struct hlgl_frame *f = &g->frames[g->frame];
    f->fence = g->gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    g->gl.Flush();
    g->frame = (g->frame + 1) % HLGL_FRAMES;
    enum hl_result r = retire(g, &g->frames[g->frame]);
    if (!r && wait) {
        r = retire(g, f);
        if (!r && f->n_passes)
            read_timings(g, f, &g->frames[g->frame]);
        if (!r)
            r = hlgl_check(g, "work submitted");
    }
    g->frames[g->frame].n_passes = 0;
    return r;
}

enum hl_result hlgl_submit(void *state, bool wait)
{
    struct hlgl *g = state;
    enum hl_result r = hlgl_enter(g);
    if (wait)
        g->n_timings = 0;
    return r ? r : hlgl_flush(g, wait);
}

uint32_t hlgl_timings(void *state, struct hl_timing *out, uint32_t max)
{
    const struct hlgl *g = state;
    uint32_t n = g->n_timings < max ? g->n_timings : max;
    if (n)
        memcpy(out, g->timings, n * sizeof *out);
    return g->n_timings;
}

void hlgl_frames_close(struct hlgl *g)
{
    for (int i = 0; i < HLGL_FRAMES; i++) {
        struct hlgl_frame *f = &g->frames[i];
        g->gl.DeleteSync(f->fence);
        g->gl.DeleteQueries((GLsizei)f->n_queries, f->queries);
        hl_bk_free(g->device, f->queries);
        hl_bk_free(g->device, f->labels);
        memset(f, 0, sizeof *f);
    }
    hl_bk_free(g->device, g->timings);
    g->timings = NULL;
}
