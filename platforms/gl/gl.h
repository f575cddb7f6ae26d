/* SPDX-License-Identifier: Zlib */
#ifndef HL_GL_PRIVATE_H
#define HL_GL_PRIVATE_H
/* Inside of the GL backend. Reading order of the files:
 *   gl_device.c          choice of a context, open and close, buffers
 *   gl_context_osmesa.c  the only file that knows OSMesa
 *   gl_context_egl.c     the only file that knows EGL
 *   gl_caps.c            formats and caps, by trying them
 *   gl_texture.c         textures, samplers, framebuffers
 *   gl_program.c         stages, constants, vertex arrays
 *   gl_pass.c            a pass and its draws; submit, timings
 *
 * Row 0 of memory is the top: clip control LOWER_LEFT, ZERO_TO_ONE gives the
 * same image in memory, and the same gl_FragCoord, as Vulkan's viewport does,
 * so nothing is flipped but the winding, which GL judges with y up. */
#include <GL/glcorearb.h>
#include "platforms/gl/hl_gl.h"

enum {
    HLGL_FRAMES = 2,         /* one recorded while one executes              */
    HLGL_SAMPLERS = 27,      /* filter x wrap_u x wrap_v                     */
    HLGL_ENTRIES = 16        /* of a context's library                       */
};

/* ---- contexts -------------------------------------------------------- */

typedef void (*hlgl_function)(void);

struct hlgl_context {
    const char *kind;        /* "osmesa", "egl", "own"                       */
    void *library, *handle, *display;
    hlgl_function entry[HLGL_ENTRIES]; /* the context file's own numbering   */
    void *(*get_proc)(const char *);   /* of an embedder                     */
    float pixel[4];          /* OSMesa asks for a window's memory: 1 x 1     */
    bool (*use)(struct hlgl_context *);      /* make current                 */
    void (*close)(struct hlgl_context *);
    hlgl_function (*find)(const struct hlgl_context *, const char *name);
};

enum hlgl_found {
    HLGL_OPEN,               /* a 4.5 core context, not current yet          */
    HLGL_FAILED,             /* not this one                                 */
    HLGL_END                 /* nor any with a higher index                  */
};
/* Context `index` of a kind. */
enum hlgl_found hlgl_osmesa_open(struct hlgl_context *, uint32_t index,
                                 bool debug);
enum hlgl_found hlgl_egl_open(struct hlgl_context *, uint32_t index,
                              bool debug);
/* A symbol of the context's library, or NULL. */
hlgl_function hlgl_symbol(const struct hlgl_context *, const char *name);

struct hlgl_api {
#define HLGL_FUNCTION(name, NAME) PFNGL##NAME##PROC name;
#include "platforms/gl/gl_functions.def"
#undef HLGL_FUNCTION
};

/* ---- objects --------------------------------------------------------- */

/* Serials are never used twice, as GL's names are: 0 is no object. */
struct hlgl_buf {
    GLuint buffer;
    uint32_t serial;
    unsigned char *map;      /* persistent and coherent, or NULL             */
};

struct hlgl_tex {
    GLuint tex, view;        /* view: sampled, perhaps as another format     */
    uint32_t serial;
    enum hl_format format;
    uint32_t width, height;
};

/* Vertex array of one layout, with what it has bound. */
struct hlgl_layout {
    struct hl_vertex_layout key;
    GLuint vao;
    uint32_t stream[HL_MAX_STREAMS], index;   /* serials                     */
};

struct hlgl_prog {
    GLuint program;
    uint32_t layout;
    uint32_t streams;        /* mask of streams that the layout reads        */
    uint8_t topology, blend, depth_test, cull;  /* enums of hal.h            */
    bool depth_write, mirrored, no_color_write;
    float blend_constant;
    struct hl_stencil stencil;
};

enum { HLGL_FBO_KEYS = HL_MAX_COLORS + 1 };   /* depth is the last           */
struct hlgl_fbo {
    GLuint fbo;
    uint32_t key[HLGL_FBO_KEYS];     /* serials of the targets               */
};

struct hlgl_frame {
    GLsync fence;            /* of its submit, not waited for; or NULL       */
    GLuint *queries;         /* one a pass                                   */
    GLint64 began;           /* GL's clock when the first pass came          */
    const char **labels;
    uint32_t n_passes, n_queries, max_queries, max_labels;
};

/* ---- device ---------------------------------------------------------- */

struct hlgl {
    struct hl_device *device;
    struct hlgl_context context;
    struct hlgl_api gl;
    bool borrowed;           /* the context is an embedder's                 */
    bool timestamps;

    struct hlgl_buf *bufs;
    struct hlgl_tex *texs;
    struct hlgl_prog *progs;
    uint32_t serials;
    struct hlgl_layout *layouts;
    uint32_t n_layouts, max_layouts;
    struct hlgl_fbo *fbos;
    uint32_t n_fbos, max_fbos;
    GLuint samplers[HLGL_SAMPLERS];
    struct hlgl_tex white;
    GLuint dummy;            /* buffer of unused ranges, zeros               */

    struct hlgl_frame frames[HLGL_FRAMES];
    uint32_t frame;
    struct hl_timing *timings;
    uint32_t n_timings, max_timings;
};

/* gl_device.c. Make the context current; with an embedder's, set all state
 * that a pass or a copy relies on. */
enum hl_result hlgl_enter(struct hlgl *);
/* HL_OK, or GL's error since the last call, logged under `what`. */
enum hl_result hlgl_check(struct hlgl *, const char *what);
void hlgl_label(struct hlgl *, GLenum kind, GLuint name, const char *label);

/* gl_caps.c */
struct hlgl_format { GLenum internal, format, type; };
const struct hlgl_format *hlgl_format(enum hl_format);
GLenum hlgl_attachment(enum hl_format, uint32_t color);
/* Name, driver and kind of the current context. */
void hlgl_describe(const struct hlgl_api *, const char *context,
                   struct hl_device_info *);
void hlgl_caps(struct hlgl *, struct hl_caps *);

/* gl_texture.c */
enum hl_result hlgl_tex_make(struct hlgl *, const struct hl_tex_desc *,
                             struct hlgl_tex *out);
void hlgl_tex_release(struct hlgl *, struct hlgl_tex *);
enum hl_result hlgl_tex_create(void *, uint32_t, const struct hl_tex_desc *);
enum hl_result hlgl_tex_write(void *, uint32_t, uint32_t, const void *,
                              size_t);
enum hl_result hlgl_tex_read(void *, uint32_t, void *, size_t);
enum hl_result hlgl_samplers_open(struct hlgl *);
/* The framebuffer of these targets. */
enum hl_result hlgl_fbo_find(struct hlgl *, const struct hlgl_tex *const *color,
                             uint32_t n, const struct hlgl_tex *depth,
                             GLuint *out);
void hlgl_textures_close(struct hlgl *);

/* gl_program.c */
enum hl_result hlgl_prog_create(void *, uint32_t,
                                const struct hl_prog_desc *);
void hlgl_prog_release(struct hlgl *, struct hlgl_prog *);
/* No vertex array refers to that buffer any more. */
void hlgl_layouts_forget(struct hlgl *, uint32_t serial);
void hlgl_layouts_close(struct hlgl *);

/* gl_pass.c */
enum hl_result hlgl_pass_run(void *, const struct hl_bk_pass *,
                             const struct hl_bk_draw *, uint32_t);
enum hl_result hlgl_flush(struct hlgl *, bool wait);
enum hl_result hlgl_submit(void *, bool wait);
uint32_t hlgl_timings(void *, struct hl_timing *, uint32_t max);
void hlgl_frames_close(struct hlgl *);
#endif
