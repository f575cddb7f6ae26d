/* SPDX-License-Identifier: Zlib */
/* Choice of a context, open and close, buffers. */
#include <dlfcn.h>
#include <string.h>
#include "platforms/gl/gl.h"

enum { MAX_CONTEXTS = 16 };  /* of a kind; more are not listed               */

/* ---- errors ------------------------------------------------------------ */

enum hl_result hlgl_check(struct hlgl *g, const char *what)
{
    GLenum first = g->gl.GetError();
    /* One flag an error: not many can be set. A lost context gives one for
     * ever. */
    for (int i = 0; i < 8 && first != GL_NO_ERROR; i++)
        if (g->gl.GetError() == GL_NO_ERROR)
            break;
    if (first == GL_NO_ERROR)
        return HL_OK;
    enum hl_result r = first == GL_OUT_OF_MEMORY ? HL_ERR_MEMORY
                     : first == GL_CONTEXT_LOST ? HL_ERR_DEVICE_LOST
                                                : HL_ERR_UNSUPPORTED;
    hl_bk_log(g->device, HL_LOG_ERROR,
              r == HL_ERR_DEVICE_LOST ? HL_MSG_DEVICE
              : r == HL_ERR_MEMORY ? HL_MSG_MEMORY : HL_MSG_BACKEND,
              what, ": ", hl_result_name(r));
    return r;
}

void hlgl_label(struct hlgl *g, GLenum kind, GLuint name, const char *label)
{
    enum { MOST = 64 };      /* GL takes 256 at least                        */
    if (!label || !*label)
        return;
    const char *end = memchr(label, '\0', MOST);
    g->gl.ObjectLabel(kind, name, end ? (GLsizei)(end - label) : MOST, label);
}

static void APIENTRY message(GLenum source, GLenum type, GLuint id,
                             GLenum severity, GLsizei length,
                             const GLchar *text, const void *user)
{
    struct hl_device *device = (struct hl_device *)(uintptr_t)user;
    (void)id;
    (void)length;
    /* Not misuse: a stage that does not compile, which is refused with the
     * compiler's log, and memory that is exhausted, which is a result. Only
     * the text tells the latter. */
    if (source == GL_DEBUG_SOURCE_SHADER_COMPILER ||
        strstr(text, "GL_OUT_OF_MEMORY"))
        return;
    if (type == GL_DEBUG_TYPE_ERROR || severity == GL_DEBUG_SEVERITY_HIGH)
        hl_bk_validation_error(device, text);
    else if (severity == GL_DEBUG_SEVERITY_MEDIUM &&
             type != GL_DEBUG_TYPE_PERFORMANCE)
        hl_bk_log(device, HL_LOG_WARNING, HL_MSG_VALIDATION, text, NULL,
                  NULL);
}

/* ---- state ------------------------------------------------------------- */

/* What halflight never changes, and relies on. */
static void set_state(const struct hlgl_api *gl)
{
    static const GLenum off[] = {
        GL_DITHER, GL_POLYGON_OFFSET_FILL, GL_DEPTH_CLAMP, GL_COLOR_LOGIC_OP,
        GL_RASTERIZER_DISCARD, GL_PRIMITIVE_RESTART,
        GL_PRIMITIVE_RESTART_FIXED_INDEX, GL_SAMPLE_ALPHA_TO_COVERAGE,
        GL_SAMPLE_ALPHA_TO_ONE, GL_SAMPLE_COVERAGE, GL_SAMPLE_MASK,
        GL_SAMPLE_SHADING, GL_LINE_SMOOTH, GL_POLYGON_SMOOTH
    };
    static const GLenum zero[] = {
        GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS,
        GL_UNPACK_SWAP_BYTES, GL_PACK_ROW_LENGTH, GL_PACK_SKIP_ROWS,
        GL_PACK_SKIP_PIXELS, GL_PACK_SWAP_BYTES
    };
    for (size_t i = 0; i < sizeof off / sizeof *off; i++)
        gl->Disable(off[i]);
    for (size_t i = 0; i < sizeof zero / sizeof *zero; i++)
        gl->PixelStorei(zero[i], 0);
    gl->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl->BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    gl->Enable(GL_MULTISAMPLE);
    /* Only sRGB targets are encoded, as on Vulkan. */
    gl->Enable(GL_FRAMEBUFFER_SRGB);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->DepthRange(0.0, 1.0);
    /* Flat varyings are the first vertex's, as on Vulkan; GL's own default
     * is the last. */
    gl->ProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    for (GLuint i = 0; i < HL_MAX_ATTRS; i++)
        gl->VertexAttrib4f(i, 0.0f, 0.0f, 0.0f, 1.0f);
}

enum hl_result hlgl_enter(struct hlgl *g)
{
    if (!g->context.use(&g->context)) {
        hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_DEVICE,
                  "the GL context cannot be made current on this thread",
                  NULL, NULL);
        return HL_ERR_DEVICE_LOST;
    }
    if (g->borrowed)
        set_state(&g->gl);
    return HL_OK;
}

/* ---- contexts ---------------------------------------------------------- */

hlgl_function hlgl_symbol(const struct hlgl_context *c, const char *name)
{
    /* ISO C has no cast from object to function pointer; POSIX makes their
     * representation the same. */
    void *symbol = dlsym(c->library, name);
    hlgl_function f;
    memcpy(&f, &symbol, sizeof f);
    return f;
}

/* OSMesa gives an address for any name, known or not: only the version, asked
 * below, says what there is. */
static bool load(const struct hlgl_context *c, struct hlgl_api *gl)
{
    bool whole = true;
#define HLGL_FUNCTION(name, NAME) \
    gl->name = (PFNGL##NAME##PROC)c->find(c, "gl" #name); \
    whole &= gl->name != NULL;
#include "platforms/gl/gl_functions.def"
#undef HLGL_FUNCTION
    GLint major = 0, minor = 0, profile = 0;
    if (!whole)
        return false;
    gl->GetIntegerv(GL_MAJOR_VERSION, &major);
    gl->GetIntegerv(GL_MINOR_VERSION, &minor);
    gl->GetIntegerv(GL_CONTEXT_PROFILE_MASK, &profile);
    return major * 10 + minor >= 45 && (profile & GL_CONTEXT_CORE_PROFILE_BIT);
}

/* Which contexts to try, in which order. */
struct search { const char *kind; uint32_t index; bool egl, debug; };

/* The next context that works, current; false when there are no more. */
static bool next(struct search *s, struct hlgl_context *c,
                 struct hlgl_api *gl)
{
    for (;;) {
        enum hlgl_found found = HLGL_END;
        memset(c, 0, sizeof *c);
        if (s->index < MAX_CONTEXTS &&
            (!s->kind || !strcmp(s->kind, s->egl ? "egl" : "osmesa")))
            found = s->egl ? hlgl_egl_open(c, s->index, s->debug)
                           : hlgl_osmesa_open(c, s->index, s->debug);
        s->index++;
        if (found == HLGL_OPEN) {
            if (c->use(c) && load(c, gl))
                return true;
            c->close(c);
        } else if (found == HLGL_END) {
            if (s->egl)
                return false;
            s->egl = true;
            s->index = 0;
        }
    }
}

static enum hl_result list(const struct hl_hooks *hooks,
                           struct hl_device_info *out, uint32_t max,
                           uint32_t *n)
{
    struct search s = { NULL, 0, false, false };
    struct hlgl_context c;
    struct hlgl_api gl;
    (void)hooks;
    for (*n = 0; next(&s, &c, &gl); (*n)++) {
        if (*n < max)
            hlgl_describe(&gl, c.kind, &out[*n]);
        c.close(&c);
    }
    return *n ? HL_OK : HL_ERR_NO_DEVICE;
}

/* Is the n-th context the one that is wanted? Digits that no index reaches
 * may be a name's. */
static bool wanted(const char *want, uint32_t n, const char *name,
                   bool by_name)
{
    uint32_t index = 0;
    if (!want || !*want)
        return true;
    if (by_name)
        return hl_bk_name_has(name, want);
    for (; *want >= '0' && *want <= '9' && index <= MAX_CONTEXTS; want++)
        index = index * 10 + (uint32_t)(*want - '0');
    return !*want && index == n;
}

static enum hl_result choose(struct hlgl *g, const char *kind,
                             const struct hl_device_desc *desc)
{
    struct hl_device_info info;
    uint32_t n = 0;
    for (int by_name = 0; by_name < 2; by_name++) {
        struct search s = { kind, 0, false, desc->validation };
        for (n = 0; next(&s, &g->context, &g->gl); n++) {
            hlgl_describe(&g->gl, g->context.kind, &info);
            if (wanted(desc->device, n, info.name, by_name == 1))
                return HL_OK;
            g->context.close(&g->context);
        }
    }
    memset(&g->context, 0, sizeof g->context);
    hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_DEVICE,
              n ? "no GL device is called "
                : "no OpenGL 4.5 core context from ",
              n ? desc->device : kind ? kind : "OSMesa or EGL", NULL);
    return HL_ERR_NO_DEVICE;
}

/* ---- an embedder's context --------------------------------------------- */

static bool borrowed_use(struct hlgl_context *c)
{
    (void)c;
    return true;
}

static void borrowed_close(struct hlgl_context *c)
{
    (void)c;
}

static hlgl_function borrowed_find(const struct hlgl_context *c,
                                   const char *name)
{
    void *symbol = c->get_proc(name);
    hlgl_function f;
    memcpy(&f, &symbol, sizeof f);
    return f;
}

static enum hl_result borrow(struct hlgl *g, void *(*get_proc)(const char *))
{
    g->borrowed = true;
    g->context.kind = "own";
    g->context.get_proc = get_proc;
    g->context.use = borrowed_use;
    g->context.close = borrowed_close;
    g->context.find = borrowed_find;
    if (load(&g->context, &g->gl))
        return HL_OK;
    memset(&g->context, 0, sizeof g->context);
    hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_DEVICE,
              "the embedder's context is not OpenGL 4.5 core", NULL, NULL);
    return HL_ERR_UNSUPPORTED;
}

/* ---- buffers ----------------------------------------------------------- */

static enum hl_result buf_create(void *state, uint32_t slot,
                                 const struct hl_buf_desc *desc)
{
    struct hlgl *g = state;
    struct hlgl_buf *b = &g->bufs[slot];
    const GLbitfield map = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT |
                           GL_MAP_COHERENT_BIT;
    enum hl_result r = hlgl_enter(g);
    if (r)
        return r;
    if (desc->bytes > (size_t)PTRDIFF_MAX)
        return HL_ERR_MEMORY;
    g->gl.CreateBuffers(1, &b->buffer);
    g->gl.NamedBufferStorage(b->buffer, (GLsizeiptr)desc->bytes, desc->data,
                             desc->dynamic ? map : GL_DYNAMIC_STORAGE_BIT);
    r = hlgl_check(g, "a buffer");
    if (!r && desc->dynamic) {
        b->map = g->gl.MapNamedBufferRange(b->buffer, 0,
                                           (GLsizeiptr)desc->bytes, map);
        r = hlgl_check(g, "mapping a buffer");
        if (!r && !b->map)
            r = HL_ERR_MEMORY;
    }
    if (r) {
        g->gl.DeleteBuffers(1, &b->buffer);
        memset(b, 0, sizeof *b);
        return r;
    }
    b->serial = ++g->serials;
    hlgl_label(g, GL_BUFFER, b->buffer, desc->label);
    return HL_OK;
}

static enum hl_result buf_write(void *state, uint32_t slot, size_t offset,
                                const void *data, size_t bytes)
{
    struct hlgl *g = state;
    struct hlgl_buf *b = &g->bufs[slot];
    if (b->map) {
        memcpy(b->map + offset, data, bytes);
        return HL_OK;
    }
    enum hl_result r = hlgl_enter(g);
    if (r)
        return r;
    g->gl.NamedBufferSubData(b->buffer, (GLintptr)offset, (GLsizeiptr)bytes,
                             data);
    return hlgl_check(g, "writing a buffer");
}

static void buf_release(struct hlgl *g, struct hlgl_buf *b)
{
    hlgl_layouts_forget(g, b->serial);
    g->gl.DeleteBuffers(1, &b->buffer);   /* and unmaps                      */
    memset(b, 0, sizeof *b);
}

/* GL itself keeps what submitted work still uses. */
static void destroy(void *state, char kind, uint32_t slot)
{
    struct hlgl *g = state;
    if (hlgl_enter(g))
        return;
    if (kind == 'b')
        buf_release(g, &g->bufs[slot]);
    else if (kind == 't')
        hlgl_tex_release(g, &g->texs[slot]);
    else
        hlgl_prog_release(g, &g->progs[slot]);
}

/* ---- open and close ---------------------------------------------------- */

/* Where a draw has no range bound. 64 KiB: the largest block that every GL
 * takes. */
static enum hl_result dummy_open(struct hlgl *g)
{
    enum { BYTES = 65536 };
    void *zeros = hl_bk_alloc(g->device, BYTES);
    if (!zeros)
        return HL_ERR_MEMORY;
    g->gl.CreateBuffers(1, &g->dummy);
    g->gl.NamedBufferStorage(g->dummy, BYTES, zeros, 0);
    hl_bk_free(g->device, zeros);
    return hlgl_check(g, "a buffer");
}

static void close_device(void *state)
{
    struct hlgl *g = state;
    if (g->context.use && g->context.use(&g->context)) {
        hlgl_frames_close(g);
        hlgl_textures_close(g);
        hlgl_layouts_close(g);
        g->gl.DeleteBuffers(1, &g->dummy);
        if (g->borrowed)
            g->gl.DebugMessageCallback(NULL, NULL);
    }
    if (g->context.close)
        g->context.close(&g->context);
    hl_bk_free(g->device, g->bufs);
    hl_bk_free(g->device, g->texs);
    hl_bk_free(g->device, g->progs);
    memset(g, 0, sizeof *g);
}

static enum hl_result context_open(struct hlgl *g,
                                   const struct hl_device_desc *desc)
{
    const struct hl_gl_native *native = desc->native;
    enum hl_result r;
    if (native && native->get_proc)
        r = borrow(g, native->get_proc);
    else
        r = choose(g, native ? native->context : NULL, desc);
    if (r)
        return r;
    for (int i = 0; i < 8 && g->gl.GetError() != GL_NO_ERROR; i++)
        continue;            /* an embedder's own errors                     */
    set_state(&g->gl);
    return hlgl_check(g, "GL state");
}

static void validate(struct hlgl *g)
{
    g->gl.Enable(GL_DEBUG_OUTPUT);
    g->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    g->gl.DebugMessageCallback(message, g->device);
}

static enum hl_result open_device(void *state, struct hl_device *device,
                                  const struct hl_device_desc *desc,
                                  struct hl_caps *caps)
{
    struct hlgl *g = state;
    g->device = device;
    g->bufs = hl_bk_alloc(device, desc->max_buffers * sizeof *g->bufs);
    g->texs = hl_bk_alloc(device, desc->max_textures * sizeof *g->texs);
    g->progs = hl_bk_alloc(device, desc->max_programs * sizeof *g->progs);
    enum hl_result r = g->bufs && g->texs && g->progs ? HL_OK
                                                      : HL_ERR_MEMORY;
    if (!r)
        r = context_open(g, desc);
    if (!r) {
        hlgl_caps(g, caps);  /* by trial and error                           */
        if (desc->validation)
            validate(g);
        r = hlgl_samplers_open(g);
    }
    if (!r)
        r = dummy_open(g);
    if (r)
        close_device(g);
    return r;
}

const struct hl_backend hl_backend_gl = {
    "gl", HL_VERSION, sizeof(struct hlgl), list, open_device, close_device,
    buf_create, buf_write, hlgl_tex_create, hlgl_tex_write, hlgl_tex_read,
    hlgl_prog_create, destroy, hlgl_pass_run, hlgl_submit, hlgl_timings
};
