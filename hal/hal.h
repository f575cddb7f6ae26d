/* SPDX-License-Identifier: Zlib */
#ifndef HL_HAL_H
#define HL_HAL_H
/* What halflight asks of a machine. Order of use: open a device on a backend,
 * create buffers, textures and programs, run whole passes, submit, read back.
 *
 * Rules stated once:
 * - A desc is borrowed for the call only. Zero in a field is its default.
 * - Every call checks its arguments once, here; on failure nothing changed,
 *   *out is {0}, and the log callback has named the field.
 * - Handles are slot + generation: a stale handle is refused, not followed.
 * - destroy takes the handle's address and clears it; {0} is allowed. The
 *   object is released once submitted work no longer uses it.
 * - One thread at a time may use one device; devices are independent.
 * - Nothing is printed, no global state, memory only through the hooks. */
#include "hal/caps.h"

#define HL_VERSION 3u        /* raised whenever a public struct changes      */

struct hl_device;
struct hl_backend;           /* hal/backend.h                                */

typedef struct { uint32_t id; } hl_buf;
typedef struct { uint32_t id; } hl_tex;
typedef struct { uint32_t id; } hl_prog;

/* ---- device ---------------------------------------------------------- */

struct hl_hooks {
    /* Both required. alloc returns memory aligned for any type, or NULL. */
    void *(*alloc)(void *user, size_t bytes);
    void (*free)(void *user, void *memory);
    void *user;
};

enum hl_log_level { HL_LOG_ERROR, HL_LOG_WARNING, HL_LOG_INFO };

/* What a message is about; tests compare ids, people read text. */
enum hl_log_id {
    HL_MSG_NONE, HL_MSG_ARGUMENT, HL_MSG_HANDLE, HL_MSG_LIMIT, HL_MSG_FORMAT,
    HL_MSG_MEMORY, HL_MSG_BACKEND, HL_MSG_VALIDATION, HL_MSG_DEVICE
};

typedef void (*hl_log_fn)(void *user, enum hl_log_level level,
                          enum hl_log_id id, const char *text);

struct hl_device_desc {
    uint32_t version;        /* HL_VERSION; required                         */
    struct hl_hooks hooks;
    hl_log_fn log;           /* NULL: silent                                 */
    void *log_user;
    const char *device;      /* index ("0") or part of a name; NULL: best    */
    bool validation;         /* driver validation layers, counted            */
    const void *native;      /* backend's own: an embedder's device, or NULL */
    const struct hl_profile *profile; /* console to keep the rules of
                              * (hal/profile.h), copied; NULL: the machine's
                              * own                                          */
    uint32_t max_buffers, max_textures, max_programs; /* 0: 4096 each        */
};

/* A machine a backend can open. */
struct hl_device_info {
    char name[HL_CAPS_NAME];
    char driver[HL_CAPS_NAME];
    enum hl_device_kind kind;
};

/* Fill up to max infos of what `backend` could open, best first; *n is how
 * many there are. HL_ERR_NO_DEVICE when the backend has no driver at all. */
enum hl_result hl_devices_list(const struct hl_backend *backend,
                               const struct hl_hooks *hooks,
                               struct hl_device_info *out, uint32_t max,
                               uint32_t *n);

enum hl_result hl_device_open(struct hl_device **out,
                              const struct hl_backend *backend,
                              const struct hl_device_desc *desc);
/* Waits for submitted work; destroys what is left; NULL is allowed. */
void hl_device_close(struct hl_device **device);
const struct hl_caps *hl_device_caps(const struct hl_device *device);
/* Errors that the driver's validation layers reported so far. */
uint32_t hl_device_validation_errors(const struct hl_device *device);
/* Static English name of a result. */
const char *hl_result_name(enum hl_result result);

/* ---- buffers --------------------------------------------------------- */

enum {                       /* hl_buf_desc.usage                            */
    HL_BUF_VERTEX = 1, HL_BUF_INDEX = 2, HL_BUF_UNIFORM = 4, HL_BUF_STORAGE = 8
};

struct hl_buf_desc {
    const char *label;       /* NULL allowed                                 */
    size_t bytes;            /* > 0                                          */
    uint32_t usage;          /* HL_BUF_* bits; 0 = VERTEX | INDEX            */
    bool dynamic;            /* rewritten often by the host                  */
    const void *data;        /* initial contents, `bytes` of them, or NULL   */
};

enum hl_result hl_buf_create(struct hl_device *, hl_buf *out,
                             const struct hl_buf_desc *);
void hl_buf_destroy(struct hl_device *, hl_buf *);
/* Takes effect at once: the caller does not write what submitted and
 * unfinished work reads (use one buffer a frame in flight). */
enum hl_result hl_buf_write(struct hl_device *, hl_buf, size_t offset,
                            const void *data, size_t bytes);

/* ---- textures -------------------------------------------------------- */

enum {                       /* hl_tex_desc.usage                            */
    HL_TEX_SAMPLED = 1, HL_TEX_TARGET = 2, HL_TEX_READBACK = 4
};

struct hl_tex_desc {
    const char *label;
    enum hl_format format;   /* 0 = HL_FORMAT_RGBA8_UNORM                    */
    uint32_t width, height;  /* texels, 1..caps.max_tex_dim; no default      */
    uint32_t samples;        /* 1, 2, 4, 8; 0 = 1                            */
    uint32_t mips;           /* levels; 0 = 1                                */
    uint32_t usage;          /* HL_TEX_* bits; 0 = SAMPLED                   */
    /* Format as which shaders sample it: the same bytes reinterpreted, as a
     * texture view or a console's remap does. Equal texel size; depth only
     * as a pair of the profile's depth list, where caps.console_memory;
     * 0 = format. */
    enum hl_format sample_as;
    /* How a console keeps it (hal/profile.h); all zero where not
     * caps.console_memory. */
    struct hl_console console;
};

/* Contents are undefined until written or cleared by a pass. */
enum hl_result hl_tex_create(struct hl_device *, hl_tex *out,
                             const struct hl_tex_desc *);
void hl_tex_destroy(struct hl_device *, hl_tex *);
/* Whole level, rows tight, top row first; `bytes` must be exact. */
enum hl_result hl_tex_write(struct hl_device *, hl_tex, uint32_t mip,
                            const void *data, size_t bytes);
/* Level 0, single-sampled, rows tight. Submits and waits for all passes run
 * so far. Depth formats give their depth as float (4 bytes a texel). */
enum hl_result hl_tex_read(struct hl_device *, hl_tex, void *out,
                           size_t bytes);

/* ---- programs -------------------------------------------------------- */

enum hl_shader {             /* built-in stages, shaders/variants.def        */
    HL_SHADER_NONE = 0,
#define HL_SHADER(name, stage, file, defines) HL_SHADER_##name,
#include "shaders/variants.def"
#undef HL_SHADER
    HL_SHADER_COUNT
};

/* A stage that the embedder brings, in each language it has; a backend
 * takes the one it understands. Bindings: shaders/shared/block.h. */
struct hl_code {
    const uint32_t *spirv;   /* entry "main"                                 */
    size_t spirv_bytes;
    const char *glsl;        /* GLSL 4.50 for OpenGL, flattened              */
    void (*kernel)(void);    /* software backend: its own signature          */
};

struct hl_stage {
    enum hl_shader builtin;  /* or HL_SHADER_NONE and:                       */
    const struct hl_code *code;
};

/* Specialisation constant: id of layout(constant_id), 32 bits. */
struct hl_spec { uint32_t id, value; };

enum hl_attr_format {
    HL_ATTR_NONE = 0, HL_ATTR_F32X1, HL_ATTR_F32X2, HL_ATTR_F32X3,
    HL_ATTR_F32X4, HL_ATTR_U8X4_UNORM, HL_ATTR_S8X4_SNORM,
    HL_ATTR_S16X4_SNORM, HL_ATTR_U16X2_UNORM, HL_ATTR_F16X2, HL_ATTR_F16X4
};

enum { HL_MAX_ATTRS = 8, HL_MAX_STREAMS = 4, HL_MAX_COLORS = 8,
       HL_MAX_UNIFORMS = 4, HL_MAX_STORAGE = 2, HL_MAX_TEXTURES = 12,
       HL_MAX_SPECS = 32 };

/* Attribute `location` is its index in the array. An absent attribute that a
 * built-in stage reads gives 0,0,0,1 at every vertex. */
struct hl_attr {
    enum hl_attr_format format;
    uint8_t stream;          /* vertex buffer 0..HL_MAX_STREAMS-1            */
    uint16_t offset;         /* bytes into the vertex                        */
};
struct hl_vertex_layout {
    struct hl_attr attr[HL_MAX_ATTRS];
    uint16_t stride[HL_MAX_STREAMS]; /* bytes                                */
};

enum hl_compare {            /* 0: the test is off                           */
    HL_COMPARE_OFF = 0, HL_COMPARE_NEVER, HL_COMPARE_LESS,
    HL_COMPARE_LESS_EQUAL, HL_COMPARE_EQUAL, HL_COMPARE_GREATER_EQUAL,
    HL_COMPARE_GREATER, HL_COMPARE_ALWAYS
};
enum hl_blend {
    HL_BLEND_OFF = 0,
    HL_BLEND_ADD,            /* src + dst                                    */
    HL_BLEND_OVER,           /* src a + dst (1 - a); alpha: a + dst (1 - a)  */
    HL_BLEND_ADD_ALPHA,      /* src a + dst; alpha kept                      */
    HL_BLEND_MAX,
    HL_BLEND_SHIFT           /* src + dst blend_constant                     */
};

/* What a fragment does to the 8 stencil bits under it. */
enum hl_stencil_op {
    HL_STENCIL_KEEP = 0, HL_STENCIL_ZERO, HL_STENCIL_REPLACE,
    HL_STENCIL_INCREMENT, HL_STENCIL_DECREMENT,            /* clamped        */
    HL_STENCIL_INCREMENT_WRAP, HL_STENCIL_DECREMENT_WRAP, HL_STENCIL_INVERT
};
struct hl_stencil_face {
    enum hl_compare test;    /* reference against stored, both masked; OFF:
                              * passes, and all must be KEEP; OFF on both
                              * faces: no stencil                            */
    enum hl_stencil_op fail, depth_fail, pass;
};
struct hl_stencil {
    struct hl_stencil_face front, back;
    uint8_t reference, read_mask, write_mask; /* masks: 0 = 255              */
};
enum hl_cull { HL_CULL_NONE = 0, HL_CULL_BACK, HL_CULL_FRONT };
enum hl_topology { HL_TOPOLOGY_TRIANGLES = 0, HL_TOPOLOGY_LINES };

/* Front faces are counter-clockwise seen with y up, on every backend. */
struct hl_prog_desc {
    const char *label;
    /* fragment may be empty where no colour is written: depth and stencil   */
    struct hl_stage vertex, fragment;
    struct hl_spec spec[HL_MAX_SPECS];  /* for both stages                   */
    uint32_t n_specs;
    struct hl_vertex_layout layout;
    enum hl_topology topology;
    uint32_t n_colors;
    enum hl_format color[HL_MAX_COLORS];
    enum hl_format depth;               /* NONE: pass without depth          */
    uint32_t samples;                   /* 0 = 1                             */
    enum hl_blend blend;                /* of every colour target            */
    float blend_constant;               /* of HL_BLEND_SHIFT                 */
    struct hl_stencil stencil;          /* needs a depth format with stencil */
    bool no_color_write;                /* mask all colour writes            */
    enum hl_compare depth_test;         /* OFF: neither test nor write       */
    bool depth_write;
    enum hl_cull cull;
    bool mirrored;                      /* clockwise is front                */
};

/* Creating a program does all compiling that the driver lets it do. */
enum hl_result hl_prog_create(struct hl_device *, hl_prog *out,
                              const struct hl_prog_desc *);
void hl_prog_destroy(struct hl_device *, hl_prog *);

/* ---- passes ---------------------------------------------------------- */

enum hl_filter { HL_FILTER_NEAREST = 0, HL_FILTER_LINEAR, HL_FILTER_TRILINEAR };
enum hl_wrap { HL_WRAP_CLAMP = 0, HL_WRAP_REPEAT, HL_WRAP_MIRROR };

struct hl_texture_binding {
    hl_tex tex;              /* {0}: a 1 x 1 white texture                   */
    uint8_t filter;          /* enum hl_filter                               */
    uint8_t wrap_u, wrap_v;  /* enum hl_wrap                                 */
};
struct hl_range {
    hl_buf buf;              /* {0}: slot unused                             */
    uint32_t offset, bytes;  /* aligned as caps say                          */
};
struct hl_rect { int32_t x, y, width, height; }; /* pixels, y down           */

struct hl_draw {
    hl_prog prog;
    hl_buf vertex[HL_MAX_STREAMS];
    hl_buf index;            /* {0}: not indexed                             */
    bool index16;            /* uint16 indices, else uint32                  */
    uint32_t first, count;   /* indices (or vertices); 0 draws nothing       */
    int32_t base_vertex;
    uint32_t instances;      /* 0 = 1                                        */
    struct hl_range uniform[HL_MAX_UNIFORMS];   /* set 0                     */
    struct hl_range storage[HL_MAX_STORAGE];    /* set 2                     */
    const struct hl_texture_binding *textures;  /* set 1                     */
    uint32_t n_textures;
    struct hl_rect scissor;  /* width 0 = the whole target                   */
};

enum hl_load { HL_LOAD_KEEP = 0, HL_LOAD_CLEAR, HL_LOAD_DISCARD };

struct hl_target {
    hl_tex tex;
    enum hl_load load;
    bool discard;            /* contents not needed after the pass           */
    float clear[4];          /* colour; depth in [0], stencil (0..255) in [1] */
    hl_tex resolve;          /* single-sampled, same format: average; or {0} */
};

/* All targets have one size and one sample count, the programs' formats.
 * Textures that draws sample are not targets of the same pass, but for a
 * depth target that is read only; or any where caps.console_memory and
 * profile.resolve_to_read: what is sampled is what passes before have left. */
struct hl_pass {
    const char *label;       /* static string: kept for the timings          */
    struct hl_target color[HL_MAX_COLORS];
    uint32_t n_colors;
    struct hl_target depth;
    bool depth_read_only;
    /* Direct3D 9 machines (profile.integer_centers) only: the state that
     * puts pixel centres at halves, D3DRS_HALFPIXELOFFSET. */
    bool half_pixel_offset;
    const struct hl_draw *draws;
    uint32_t n_draws;
};

/* Record a whole pass. Order of passes is order of effect. */
enum hl_result hl_pass_run(struct hl_device *, const struct hl_pass *);
/* Hand all passes since the last submit to the machine; with wait, return
 * when they are done. */
enum hl_result hl_submit(struct hl_device *, bool wait);

struct hl_timing {
    const char *label;
    double ms;
    /* Fragments that a stage shaded, samples of one counted once; those of
     * them that were blended. 0 where the machine does not count. */
    uint64_t fragments, blended;
};
/* Passes of the last waited submit, in order. Returns how many there are;
 * 0 where the machine has no timestamps. */
uint32_t hl_timings(struct hl_device *, struct hl_timing *out, uint32_t max);

struct hl_counts { uint64_t passes, draws, triangles, bytes_written; };
/* Since the device was opened. */
struct hl_counts hl_device_counts(const struct hl_device *);
/* True while the handle is live. */
bool hl_tex_live(const struct hl_device *, hl_tex);
bool hl_tex_info(const struct hl_device *, hl_tex, struct hl_tex_desc *out);
#endif
