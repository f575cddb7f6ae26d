/* SPDX-License-Identifier: Zlib */
/* What the current context offers, in the words of hal/caps.h. Formats are
 * tried: Mesa's answers to glGetInternalformativ promise too much. */
#include <string.h>
#include "platforms/gl/gl.h"

static const struct hlgl_format formats[HL_FORMAT_COUNT] = {
    [HL_FORMAT_NONE] = { GL_NONE, GL_NONE, GL_NONE },
#define HL_FORMAT(name, bytes, channels, kind, r, g, b, a, vulkan, internal, \
                  format, type) \
    [HL_FORMAT_##name] = { internal, format, type },
#include "hal/formats.def"
#undef HL_FORMAT
};

const struct hlgl_format *hlgl_format(enum hl_format format)
{
    return &formats[format];
}

GLenum hlgl_attachment(enum hl_format format, uint32_t color)
{
    const struct hl_format_info *f = hl_format_info(format);
    return f->kind != HL_KIND_DEPTH ? GL_COLOR_ATTACHMENT0 + color
         : f->bits[1] ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT;
}

/* ---- names ------------------------------------------------------------- */

static void append(char *to, size_t room, const char *text)
{
    size_t at = strlen(to), n = strlen(text);
    if (n > room - 1 - at)
        n = room - 1 - at;
    memcpy(to + at, text, n);
    to[at + n] = '\0';
}

static enum hl_device_kind kind_of(const char *renderer)
{
    static const struct { const char *part; enum hl_device_kind kind; }
    known[] = {
        { "llvmpipe", HL_DEVICE_CPU }, { "softpipe", HL_DEVICE_CPU },
        { "SWR", HL_DEVICE_CPU }, { "NVIDIA", HL_DEVICE_DISCRETE },
        { "GeForce", HL_DEVICE_DISCRETE }, { "Quadro", HL_DEVICE_DISCRETE },
        { "Tesla", HL_DEVICE_DISCRETE }, { "Radeon RX", HL_DEVICE_DISCRETE },
        { "Arc", HL_DEVICE_DISCRETE }, { "Intel", HL_DEVICE_INTEGRATED }
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strstr(renderer, known[i].part))
            return known[i].kind;
    return HL_DEVICE_OTHER;
}

void hlgl_describe(const struct hlgl_api *gl, const char *context,
                   struct hl_device_info *out)
{
    const char *renderer = (const char *)gl->GetString(GL_RENDERER);
    const char *version = (const char *)gl->GetString(GL_VERSION);
    memset(out, 0, sizeof *out);
    append(out->name, sizeof out->name, renderer ? renderer : "unnamed");
    append(out->driver, sizeof out->driver, context);
    append(out->driver, sizeof out->driver, " ");
    append(out->driver, sizeof out->driver, version ? version : "");
    out->kind = kind_of(out->name);
}

/* ---- formats ----------------------------------------------------------- */

static void drain(const struct hlgl *g)
{
    for (int i = 0; i < 8 && g->gl.GetError() != GL_NO_ERROR; i++)
        continue;
}

static bool complete(const struct hlgl *g, enum hl_format format, GLuint tex)
{
    const GLenum color = GL_COLOR_ATTACHMENT0, none = GL_NONE;
    bool depth = hl_format_info(format)->kind == HL_KIND_DEPTH;
    GLuint fbo;
    g->gl.CreateFramebuffers(1, &fbo);
    g->gl.NamedFramebufferTexture(fbo, hlgl_attachment(format, 0), tex, 0);
    g->gl.NamedFramebufferDrawBuffers(fbo, 1, depth ? &none : &color);
    GLenum status = g->gl.CheckNamedFramebufferStatus(fbo,
                                                      GL_DRAW_FRAMEBUFFER);
    g->gl.DeleteFramebuffers(1, &fbo);
    return status == GL_FRAMEBUFFER_COMPLETE &&
           g->gl.GetError() == GL_NO_ERROR;
}

/* Is there a texture, and is it a target? A driver may take more samples
 * than it was asked for: that count does not exist. */
static void try_format(const struct hlgl *g, enum hl_format format,
                       GLint samples, bool *texture, bool *target)
{
    GLenum internal = formats[format].internal;
    GLint made = samples;
    GLuint tex;
    g->gl.CreateTextures(samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE
                                     : GL_TEXTURE_2D, 1, &tex);
    if (samples > 1) {
        g->gl.TextureStorage2DMultisample(tex, samples, internal, 4, 4,
                                          GL_TRUE);
        g->gl.GetTextureLevelParameteriv(tex, 0, GL_TEXTURE_SAMPLES, &made);
    } else {
        g->gl.TextureStorage2D(tex, 1, internal, 4, 4);
    }
    *texture = g->gl.GetError() == GL_NO_ERROR && made == samples;
    *target = *texture && complete(g, format, tex);
    g->gl.DeleteTextures(1, &tex);
    drain(g);
}

/* What no test of a framebuffer shows. Filtering and blending of snorm,
 * integer and depth formats exist on some machines only: none is promised. */
static int uses_of_kind(enum hl_format_kind kind)
{
    return kind == HL_KIND_UINT || kind == HL_KIND_DEPTH ? 0
         : kind == HL_KIND_SNORM ? HL_USE_LINEAR
                                 : HL_USE_LINEAR | HL_USE_BLEND;
}

static GLint most_samples(const struct hlgl *g, enum hl_format_kind kind)
{
    GLint n = 1;
    g->gl.GetIntegerv(kind == HL_KIND_DEPTH ? GL_MAX_DEPTH_TEXTURE_SAMPLES
                      : kind == HL_KIND_UINT ? GL_MAX_INTEGER_SAMPLES
                                             : GL_MAX_COLOR_TEXTURE_SAMPLES,
                      &n);
    return n;
}

static struct hl_format_caps format_caps(const struct hlgl *g,
                                         enum hl_format format)
{
    struct hl_format_caps c = { 0, 0 };
    enum hl_format_kind kind = hl_format_info(format)->kind;
    int use = uses_of_kind(kind);
    bool texture, target;
    /* Formats of consoles: not to be asked about. */
    if (formats[format].internal == GL_NONE)
        return c;
    try_format(g, format, 1, &texture, &target);
    if (!texture)
        return c;
    if (!target)
        use &= ~HL_USE_BLEND;
    c.use = (uint8_t)(use | HL_USE_SAMPLED | (target ? HL_USE_TARGET : 0));
    c.samples = target;
    for (GLint s = 2; target && s <= 8 && s <= most_samples(g, kind); s *= 2) {
        bool many;
        try_format(g, format, s, &texture, &many);
        c.samples = (uint8_t)(c.samples | (many ? s : 0));
    }
    return c;
}

/* ---- costs ------------------------------------------------------------- */

/* llvmpipe of Mesa 22.3.6 on two cores, as measured through Vulkan: the same
 * rasteriser. */
static const struct hl_cost_model cost_cpu = {
    .draw_ns = 1500.0f, .vertex_ns = 150.0f, .pixel_ns = 1.5f,
    .fetch_ns = 1.2f, .blend_ns = 1.9f, .light_ns = 2.4f,
    .light_flat_ns = 1.5f, .light_gather_ns = 8.0f, .readback_ns = 0.5f,
    .sync_ns = 15000.0f, .untaken = 1.0f
};
/* Not measured: guesses at the order of magnitude for a desktop GPU. */
static const struct hl_cost_model cost_gpu = {
    .draw_ns = 1000.0f, .vertex_ns = 0.3f, .pixel_ns = 0.005f,
    .fetch_ns = 0.003f, .blend_ns = 0.01f, .light_ns = 0.004f,
    .light_flat_ns = 0.004f, .light_gather_ns = 0.004f, .readback_ns = 1.0f,
    .sync_ns = 100000.0f
};

/* ---- all --------------------------------------------------------------- */

static uint32_t limit(const struct hlgl *g, GLenum name)
{
    GLint64 n = 0;
    g->gl.GetInteger64v(name, &n);
    return n < 0 ? 0 : n > 0x40000000 ? 0x40000000u : (uint32_t)n;
}

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void limits(const struct hlgl *g, struct hl_caps *caps)
{
    uint32_t viewport;
    GLint dims[2] = { 0, 0 };
    g->gl.GetIntegerv(GL_MAX_VIEWPORT_DIMS, dims);
    viewport = least((uint32_t)dims[0], (uint32_t)dims[1]);
    caps->max_tex_dim = least(least(limit(g, GL_MAX_TEXTURE_SIZE), viewport),
                              least(limit(g, GL_MAX_FRAMEBUFFER_WIDTH),
                                    limit(g, GL_MAX_FRAMEBUFFER_HEIGHT)));
    caps->max_colors = least(least(limit(g, GL_MAX_COLOR_ATTACHMENTS),
                                   limit(g, GL_MAX_DRAW_BUFFERS)),
                             HL_MAX_COLORS);
    caps->max_uniform_bytes = limit(g, GL_MAX_UNIFORM_BLOCK_SIZE);
    caps->max_storage_bytes = limit(g, GL_MAX_SHADER_STORAGE_BLOCK_SIZE);
    caps->uniform_align = limit(g, GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT);
    caps->storage_align = limit(g, GL_SHADER_STORAGE_BUFFER_OFFSET_ALIGNMENT);
    caps->clip_zero_to_one = true;
}

void hlgl_caps(struct hlgl *g, struct hl_caps *caps)
{
    struct hl_device_info info;
    GLint bits = 0;
    hlgl_describe(&g->gl, g->context.kind, &info);
    memset(caps, 0, sizeof *caps);
    append(caps->backend, sizeof caps->backend, hl_backend_gl.name);
    memcpy(caps->device, info.name, sizeof caps->device);
    memcpy(caps->driver, info.driver, sizeof caps->driver);
    caps->kind = info.kind;
    limits(g, caps);
    g->gl.GetQueryiv(GL_TIMESTAMP, GL_QUERY_COUNTER_BITS, &bits);
    caps->timestamps = g->timestamps = bits > 0;
    for (int i = 1; i < HL_FORMAT_COUNT; i++)
        caps->format[i] = format_caps(g, (enum hl_format)i);
    caps->samples = caps->format[HL_FORMAT_RGBA8_UNORM].samples &
                    caps->format[HL_FORMAT_D32_FLOAT].samples;
    caps->cost = info.kind == HL_DEVICE_CPU ? cost_cpu : cost_gpu;
}
