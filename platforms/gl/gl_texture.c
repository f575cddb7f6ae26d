/* SPDX-License-Identifier: Zlib */
/* Textures and their views, samplers, framebuffers. */
#include <string.h>
#include "platforms/gl/gl.h"

/* ---- create and destroy ------------------------------------------------ */

/* Storage is immutable, as a view demands; the view is the same memory. */
static void storage_make(struct hlgl *g, const struct hl_tex_desc *desc,
                         struct hlgl_tex *t)
{
    GLenum internal = hlgl_format(desc->format)->internal;
    GLsizei w = (GLsizei)desc->width, h = (GLsizei)desc->height;
    bool many = desc->samples > 1;
    GLenum target = many ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
    g->gl.CreateTextures(target, 1, &t->tex);
    if (many)
        g->gl.TextureStorage2DMultisample(t->tex, (GLsizei)desc->samples,
                                          internal, w, h, GL_TRUE);
    else
        g->gl.TextureStorage2D(t->tex, (GLsizei)desc->mips, internal, w, h);
    t->view = t->tex;
    if (desc->sample_as == desc->format)
        return;
    /* TextureView wants a name that was never bound nor created. */
    g->gl.GenTextures(1, &t->view);
    g->gl.TextureView(t->view, target, t->tex,
                      hlgl_format(desc->sample_as)->internal, 0, desc->mips,
                      0, 1);
}

enum hl_result hlgl_tex_make(struct hlgl *g, const struct hl_tex_desc *desc,
                             struct hlgl_tex *t)
{
    memset(t, 0, sizeof *t);
    t->format = desc->format;
    t->width = desc->width;
    t->height = desc->height;
    storage_make(g, desc, t);
    enum hl_result r = hlgl_check(g, "a texture of this format and size");
    if (r) {
        hlgl_tex_release(g, t);
        return r;
    }
    t->serial = ++g->serials;
    hlgl_label(g, GL_TEXTURE, t->tex, desc->label);
    return HL_OK;
}

static void fbos_forget(struct hlgl *g, uint32_t serial)
{
    for (uint32_t i = g->n_fbos; serial && i-- > 0;) {
        bool has = false;
        for (int k = 0; k < HLGL_FBO_KEYS; k++)
            has |= g->fbos[i].key[k] == serial;
        if (!has)
            continue;
        g->gl.DeleteFramebuffers(1, &g->fbos[i].fbo);
        g->fbos[i] = g->fbos[--g->n_fbos];
    }
}

void hlgl_tex_release(struct hlgl *g, struct hlgl_tex *t)
{
    fbos_forget(g, t->serial);
    if (t->view != t->tex)
        g->gl.DeleteTextures(1, &t->view);
    g->gl.DeleteTextures(1, &t->tex);
    memset(t, 0, sizeof *t);
}

enum hl_result hlgl_tex_create(void *state, uint32_t slot,
                               const struct hl_tex_desc *desc)
{
    struct hlgl *g = state;
    enum hl_result r = hlgl_enter(g);
    return r ? r : hlgl_tex_make(g, desc, &g->texs[slot]);
}

/* ---- contents ---------------------------------------------------------- */

static enum hl_result upload(struct hlgl *g, const struct hlgl_tex *t,
                             uint32_t mip, const void *data)
{
    const struct hlgl_format *f = hlgl_format(t->format);
    uint32_t w = t->width >> mip, h = t->height >> mip;
    g->gl.TextureSubImage2D(t->tex, (GLint)mip, 0, 0, (GLsizei)(w ? w : 1),
                            (GLsizei)(h ? h : 1), f->format, f->type, data);
    return hlgl_check(g, "writing a texture");
}

enum hl_result hlgl_tex_write(void *state, uint32_t slot, uint32_t mip,
                              const void *data, size_t bytes)
{
    struct hlgl *g = state;
    enum hl_result r = hlgl_enter(g);
    (void)bytes;
    return r ? r : upload(g, &g->texs[slot], mip, data);
}

enum hl_result hlgl_tex_read(void *state, uint32_t slot, void *out,
                             size_t bytes)
{
    struct hlgl *g = state;
    const struct hlgl_tex *t = &g->texs[slot];
    const struct hlgl_format *f = hlgl_format(t->format);
    bool depth = hl_format_info(t->format)->kind == HL_KIND_DEPTH;
    enum hl_result r = hlgl_enter(g);
    if (r)
        return r;
    if (bytes > (size_t)INT32_MAX)
        return HL_ERR_MEMORY;
    g->gl.GetTextureImage(t->tex, 0, depth ? GL_DEPTH_COMPONENT : f->format,
                          depth ? GL_FLOAT : f->type, (GLsizei)bytes, out);
    r = hlgl_check(g, "reading a texture");
    return r ? r : hlgl_flush(g, true);   /* all is done: no wait            */
}

/* ---- samplers ---------------------------------------------------------- */

static void sampler_set(const struct hlgl *g, GLuint sampler, int filter,
                        int wrap_u, int wrap_v)
{
    static const GLint wraps[] = {
        [HL_WRAP_CLAMP] = GL_CLAMP_TO_EDGE, [HL_WRAP_REPEAT] = GL_REPEAT,
        [HL_WRAP_MIRROR] = GL_MIRRORED_REPEAT
    };
    /* But for trilinear, level 0 alone. */
    static const GLint small[] = {
        [HL_FILTER_NEAREST] = GL_NEAREST, [HL_FILTER_LINEAR] = GL_LINEAR,
        [HL_FILTER_TRILINEAR] = GL_LINEAR_MIPMAP_LINEAR
    };
    g->gl.SamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, small[filter]);
    g->gl.SamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER,
                            filter == HL_FILTER_NEAREST ? GL_NEAREST
                                                        : GL_LINEAR);
    g->gl.SamplerParameteri(sampler, GL_TEXTURE_WRAP_S, wraps[wrap_u]);
    g->gl.SamplerParameteri(sampler, GL_TEXTURE_WRAP_T, wraps[wrap_v]);
}

enum hl_result hlgl_samplers_open(struct hlgl *g)
{
    static const unsigned char texel[4] = { 255, 255, 255, 255 };
    const struct hl_tex_desc white = {
        .format = HL_FORMAT_RGBA8_UNORM, .width = 1, .height = 1,
        .samples = 1, .mips = 1, .sample_as = HL_FORMAT_RGBA8_UNORM
    };
    g->gl.CreateSamplers(HLGL_SAMPLERS, g->samplers);
    for (int i = 0; i < HLGL_SAMPLERS; i++)
        sampler_set(g, g->samplers[i], i / 9, i / 3 % 3, i % 3);
    enum hl_result r = hlgl_tex_make(g, &white, &g->white);
    return r ? r : upload(g, &g->white, 0, texel);
}

/* ---- framebuffers ------------------------------------------------------ */

static enum hl_result fbo_make(struct hlgl *g,
                               const struct hlgl_tex *const *color,
                               uint32_t n, const struct hlgl_tex *depth,
                               GLuint *out)
{
    GLenum buffers[HL_MAX_COLORS] = { GL_NONE };
    g->gl.CreateFramebuffers(1, out);
    for (uint32_t i = 0; i < n; i++) {
        buffers[i] = GL_COLOR_ATTACHMENT0 + i;
        g->gl.NamedFramebufferTexture(*out, buffers[i], color[i]->tex, 0);
    }
    if (depth)
        g->gl.NamedFramebufferTexture(*out, hlgl_attachment(depth->format, 0),
                                      depth->tex, 0);
    g->gl.NamedFramebufferDrawBuffers(*out, n ? (GLsizei)n : 1, buffers);
    GLenum status = g->gl.CheckNamedFramebufferStatus(*out,
                                                      GL_DRAW_FRAMEBUFFER);
    enum hl_result r = hlgl_check(g, "a framebuffer");
    if (!r && status != GL_FRAMEBUFFER_COMPLETE) {
        hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_FORMAT,
                  "hl_pass: this driver does not take these targets together",
                  NULL, NULL);
        r = HL_ERR_UNSUPPORTED;
    }
    if (r)
        g->gl.DeleteFramebuffers(1, out);
    return r;
}

enum hl_result hlgl_fbo_find(struct hlgl *g,
                             const struct hlgl_tex *const *color, uint32_t n,
                             const struct hlgl_tex *depth, GLuint *out)
{
    struct hlgl_fbo f = { 0, { 0 } };
    for (uint32_t i = 0; i < n; i++)
        f.key[i] = color[i]->serial;
    f.key[HL_MAX_COLORS] = depth ? depth->serial : 0;
    for (uint32_t i = 0; i < g->n_fbos; i++)
        if (!memcmp(g->fbos[i].key, f.key, sizeof f.key)) {
            *out = g->fbos[i].fbo;
            return HL_OK;
        }
    if (!hl_bk_grow(g->device, &g->fbos, &g->max_fbos, g->n_fbos + 1,
                   sizeof *g->fbos))
        return HL_ERR_MEMORY;
    enum hl_result r = fbo_make(g, color, n, depth, &f.fbo);
    if (r)
        return r;
    g->fbos[g->n_fbos++] = f;
    *out = f.fbo;
    return HL_OK;
}

void hlgl_textures_close(struct hlgl *g)
{
    for (uint32_t i = 0; i < g->n_fbos; i++)
        g->gl.DeleteFramebuffers(1, &g->fbos[i].fbo);
    hl_bk_free(g->device, g->fbos);
    g->n_fbos = 0;
    hlgl_tex_release(g, &g->white);
    g->gl.DeleteSamplers(HLGL_SAMPLERS, g->samplers);
}
