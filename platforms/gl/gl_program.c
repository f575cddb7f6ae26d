/* SPDX-License-Identifier: Zlib */
/* Programs: stages compiled with their constants, and vertex arrays, one a
 * layout, which programs share. */
#include <string.h>
#include "hal/text.h"
#include "platforms/gl/gl.h"
#include "platforms/gl/hl_glsl.h"

enum { DEFINES = 2560 };     /* HL_MAX_SPECS lines of at most 80             */

/* ---- constants --------------------------------------------------------- */

/* The type of constant `id`, from "const TYPE name = SPIRV_CROSS_..._id;". */
static const char *spec_type(const char *source, uint32_t id)
{
    char use[64];
    struct hl_text t = hl_text_begin(use, sizeof use);
    hl_text_str(&t, "= SPIRV_CROSS_CONSTANT_ID_");
    hl_text_uint(&t, id);
    hl_text_str(&t, ";");
    const char *at = strstr(source, use);
    if (!at)
        return NULL;
    while (at > source && at[-1] != '\n')
        at--;
    return strncmp(at, "const ", 6) ? NULL : at + 6;
}

/* Floats by their bits: no rounding, no locale. */
static void define(struct hl_text *t, const struct hl_spec *s,
                   const char *type)
{
    bool truth = !strncmp(type, "bool ", 5);
    const char *wrap = !strncmp(type, "float ", 6) ? "uintBitsToFloat("
                     : !strncmp(type, "int ", 4) ? "int(" : "(";
    hl_text_str(t, "#define SPIRV_CROSS_CONSTANT_ID_");
    hl_text_uint(t, s->id);
    hl_text_str(t, " ");
    if (truth) {
        hl_text_str(t, s->value ? "true\n" : "false\n");
        return;
    }
    hl_text_str(t, wrap);
    hl_text_uint(t, s->value);
    hl_text_str(t, "u)\n");
}

static void define_all(const struct hl_prog_desc *desc, const char *source,
                       char out[DEFINES])
{
    struct hl_text t = hl_text_begin(out, DEFINES);
    for (uint32_t i = 0; i < desc->n_specs; i++) {
        const char *type = spec_type(source, desc->spec[i].id);
        if (type)
            define(&t, &desc->spec[i], type);
    }
}

/* ---- stages ------------------------------------------------------------ */

static enum hl_result refuse(struct hlgl *g, const char *what, char *why)
{
    char *end = strchr(why, '\n');
    if (end)
        *end = '\0';         /* the first message is enough                  */
    hl_bk_log(g->device, HL_LOG_ERROR, HL_MSG_ARGUMENT, what, ": ", why);
    return HL_ERR_UNSUPPORTED;
}

static enum hl_result compile(struct hlgl *g, GLenum kind,
                              const struct hl_prog_desc *desc,
                              const char *source, GLuint *out)
{
    char defines[DEFINES], why[256] = "";
    const char *version = strstr(source, "#version");
    const char *body = version ? strchr(version, '\n') : NULL;
    GLint done = GL_FALSE;
    if (!body)
        return refuse(g, "hl_prog_desc", strcpy(why, "a stage without its "
                                                     "#version line"));
    define_all(desc, source, defines);
    /* Nothing but comments may stand before #version: ours come after. */
    const GLchar *const parts[] = { source, defines, body + 1 };
    const GLint lengths[] = { (GLint)(body + 1 - source), -1, -1 };
    *out = g->gl.CreateShader(kind);
    g->gl.ShaderSource(*out, 3, parts, lengths);
    g->gl.CompileShader(*out);
    g->gl.GetShaderiv(*out, GL_COMPILE_STATUS, &done);
    if (done)
        return HL_OK;
    g->gl.GetShaderInfoLog(*out, sizeof why, NULL, why);
    return refuse(g, kind == GL_VERTEX_SHADER ? "hl_prog_desc.vertex"
                                              : "hl_prog_desc.fragment", why);
}

static const char *source_of(const struct hl_stage *stage)
{
    return stage->builtin != HL_SHADER_NONE ? hl_glsl[stage->builtin]
         : stage->code ? stage->code->glsl : NULL;
}

static enum hl_result link(struct hlgl *g, GLuint program)
{
    char why[256] = "";
    GLint done = GL_FALSE;
    g->gl.LinkProgram(program);
    g->gl.GetProgramiv(program, GL_LINK_STATUS, &done);
    if (done)
        return HL_OK;
    g->gl.GetProgramInfoLog(program, sizeof why, NULL, why);
    return refuse(g, "hl_prog_desc: linking", why);
}

static enum hl_result build(struct hlgl *g, const struct hl_prog_desc *desc,
                            GLuint *program)
{
    const struct hl_stage *const stage[2] = { &desc->vertex, &desc->fragment };
    static const GLenum kind[2] = { GL_VERTEX_SHADER, GL_FRAGMENT_SHADER };
    char none[] = "a stage comes without GLSL";
    enum hl_result r = HL_OK;
    *program = g->gl.CreateProgram();
    for (int i = 0; i < 2 && !r; i++) {
        const char *source = source_of(stage[i]);
        GLuint shader = 0;
        if (i == 1 && !stage[i]->builtin && !stage[i]->code)
            break;           /* depth only                                   */
        r = source ? compile(g, kind[i], desc, source, &shader)
                   : refuse(g, "hl_prog_desc", none);
        if (!r)
            g->gl.AttachShader(*program, shader);
        g->gl.DeleteShader(shader);
    }
    if (!r)
        r = link(g, *program);
    if (!r)
        r = hlgl_check(g, "a program");
    if (r)
        g->gl.DeleteProgram(*program);
    return r;
}

/* ---- vertex arrays ----------------------------------------------------- */

static const struct { GLint n; GLenum type; GLboolean norm; } attrs[] = {
    [HL_ATTR_F32X1] = { 1, GL_FLOAT, GL_FALSE },
    [HL_ATTR_F32X2] = { 2, GL_FLOAT, GL_FALSE },
    [HL_ATTR_F32X3] = { 3, GL_FLOAT, GL_FALSE },
    [HL_ATTR_F32X4] = { 4, GL_FLOAT, GL_FALSE },
    [HL_ATTR_U8X4_UNORM] = { 4, GL_UNSIGNED_BYTE, GL_TRUE },
    [HL_ATTR_S8X4_SNORM] = { 4, GL_BYTE, GL_TRUE },
    [HL_ATTR_S16X4_SNORM] = { 4, GL_SHORT, GL_TRUE },
    [HL_ATTR_U16X2_UNORM] = { 2, GL_UNSIGNED_SHORT, GL_TRUE },
    [HL_ATTR_F16X2] = { 2, GL_HALF_FLOAT, GL_FALSE },
    [HL_ATTR_F16X4] = { 4, GL_HALF_FLOAT, GL_FALSE }
};

/* Of equal layouts equal bytes, padding and unused members included. */
static uint32_t layout_key(const struct hl_vertex_layout *in,
                           struct hl_vertex_layout *out)
{
    uint32_t streams = 0;
    memset(out, 0, sizeof *out);
    for (int i = 0; i < HL_MAX_ATTRS; i++) {
        if (in->attr[i].format == HL_ATTR_NONE)
            continue;
        out->attr[i].format = in->attr[i].format;
        out->attr[i].stream = in->attr[i].stream;
        out->attr[i].offset = in->attr[i].offset;
        streams |= 1u << in->attr[i].stream;
    }
    for (int i = 0; i < HL_MAX_STREAMS; i++)
        if (streams >> i & 1)
            out->stride[i] = in->stride[i];
    return streams;
}

/* An absent attribute stays off: it is the context's current value. */
static void vao_make(const struct hlgl *g, struct hlgl_layout *l)
{
    g->gl.CreateVertexArrays(1, &l->vao);
    for (GLuint i = 0; i < HL_MAX_ATTRS; i++) {
        const struct hl_attr *a = &l->key.attr[i];
        if (a->format == HL_ATTR_NONE)
            continue;
        g->gl.EnableVertexArrayAttrib(l->vao, i);
        g->gl.VertexArrayAttribFormat(l->vao, i, attrs[a->format].n,
                                      attrs[a->format].type,
                                      attrs[a->format].norm, a->offset);
        g->gl.VertexArrayAttribBinding(l->vao, i, a->stream);
    }
}

static enum hl_result layout_find(struct hlgl *g,
                                  const struct hl_vertex_layout *layout,
                                  struct hlgl_prog *p)
{
    struct hlgl_layout l;
    memset(&l, 0, sizeof l);
    p->streams = layout_key(layout, &l.key);
    for (p->layout = 0; p->layout < g->n_layouts; p->layout++)
        if (!memcmp(&g->layouts[p->layout].key, &l.key, sizeof l.key))
            return HL_OK;
    if (!hl_bk_grow(g->device, &g->layouts, &g->max_layouts, g->n_layouts + 1,
                   sizeof *g->layouts))
        return HL_ERR_MEMORY;
    vao_make(g, &l);
    /* GL guarantees strides and offsets to 2048 and 2047 bytes only. */
    enum hl_result r = hlgl_check(g, "hl_prog_desc.layout");
    if (r) {
        g->gl.DeleteVertexArrays(1, &l.vao);
        return r;
    }
    g->layouts[g->n_layouts++] = l;
    return HL_OK;
}

void hlgl_layouts_forget(struct hlgl *g, uint32_t serial)
{
    for (uint32_t i = 0; i < g->n_layouts; i++) {
        struct hlgl_layout *l = &g->layouts[i];
        for (GLuint k = 0; k < HL_MAX_STREAMS; k++)
            if (l->stream[k] == serial) {
                g->gl.VertexArrayVertexBuffer(l->vao, k, 0, 0, 0);
                l->stream[k] = 0;
            }
        if (l->index == serial) {
            g->gl.VertexArrayElementBuffer(l->vao, 0);
            l->index = 0;
        }
    }
}

void hlgl_layouts_close(struct hlgl *g)
{
    g->gl.BindVertexArray(0);
    for (uint32_t i = 0; i < g->n_layouts; i++)
        g->gl.DeleteVertexArrays(1, &g->layouts[i].vao);
    hl_bk_free(g->device, g->layouts);
    g->n_layouts = 0;
}

/* ---- programs ---------------------------------------------------------- */

enum hl_result hlgl_prog_create(void *state, uint32_t slot,
                                const struct hl_prog_desc *desc)
{
    struct hlgl *g = state;
    struct hlgl_prog p;
    enum hl_result r = hlgl_enter(g);
    memset(&p, 0, sizeof p);
    if (!r)
        r = layout_find(g, &desc->layout, &p);
    if (!r)
        r = build(g, desc, &p.program);
    if (r)
        return r;
    p.topology = (uint8_t)desc->topology;
    p.blend = (uint8_t)desc->blend;
    p.depth_test = (uint8_t)desc->depth_test;
    p.cull = (uint8_t)desc->cull;
    p.depth_write = desc->depth_write;
    p.mirrored = desc->mirrored;
    p.no_color_write = desc->no_color_write;
    p.blend_constant = desc->blend_constant;
    p.stencil = desc->stencil;
    hlgl_label(g, GL_PROGRAM, p.program, desc->label);
    g->progs[slot] = p;
    return HL_OK;
}

void hlgl_prog_release(struct hlgl *g, struct hlgl_prog *p)
{
    g->gl.DeleteProgram(p->program);
    memset(p, 0, sizeof *p);
}
