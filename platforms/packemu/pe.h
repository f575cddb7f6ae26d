/* SPDX-License-Identifier: Zlib */
#ifndef PE_H
#define PE_H
/* Private to packemu: what its files share.
 *
 * Memory. A texel in work is `words` 32-bit words, the first channel in the
 * low bits of the first; formats of 8 and 16 bits have one word. Words are
 * numbers, not bytes: only pe_memory.h's files know the order of bytes, of
 * EDRAM tiles and of samples.
 *
 * A pass is cut into bins of PE_BIN x PE_BIN pixels. A bin's targets are
 * loaded into words of its own, drawn on, and stored, each bin by one thread,
 * its draws in order: so a frame depends on no thread's speed. */
#include "hal/backend.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/packemu/pe_thread.h"

enum { PE_BIN = 64 };

/* Hot loops, built for AVX2 as well and chosen when the program starts, where
 * compiler and C library can do so. Same operations in the same order: same
 * bytes. Sanitizers are not ready yet when the choice is made. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && \
    defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__AVX2__)
#define PE_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define PE_WIDE
#endif

/* ---- textures: pe_texture.c --------------------------------------------- */

struct pe_texture {
    struct hl_tex_desc desc;     /* defaults filled                          */
    uint32_t words;              /* of a texel in work, 1..4                 */
    uint8_t *memory;             /* all levels, in the machine's byte order;
                                  * targets without EDRAM: samples innermost */
    size_t level[16];            /* byte offset of each level, of 4 each     */
    size_t bytes;
    uint8_t samples;             /* a texel in memory                        */
    uint8_t order, view_order;   /* enum pe_order, of `stored` and of `view` */
    enum hl_format stored;       /* of words in memory: format, but FIXED32
                                  * as the number that a resolve makes       */
    enum hl_format view;         /* of words as shaders see them             */
    bool remapped;
    uint8_t remap[4];            /* plane of each channel; 4: zero, 5: one   */
    /* First EDRAM tile and tiles of a row and in all; count 0: not there.   */
    uint32_t tile, tile_pitch, tile_count;
};

/* A texture as a draw samples it. */
struct pe_view {
    const struct pe_texture *texture;  /* NULL: white                        */
    const struct pe_state *state;
    uint8_t filter, wrap_u, wrap_v;    /* hl_filter, hl_wrap                 */
};

/* ---- programs: pe_program.c --------------------------------------------- */

/* A run of vertices: attributes in, clip position and varyings out, one
 * array a component. Arrays are readable to PE_RUN. */
enum { PE_RUN = 64 };
struct pe_vertices {
    uint32_t n;
    float attr[HL_MAX_ATTRS][4][PE_RUN];
    float clip[4][PE_RUN];
    float vary[HL_PE_VARY_COUNT][PE_RUN];
};
typedef void (*pe_vertex_fn)(const struct pe_draw *, struct pe_vertices *);
typedef void (*pe_fragment_fn)(const struct pe_draw *,
                               struct hl_pe_fragments *);
/* A whole rectangle of one bin for stages that cover the screen: planes of
 * stride PE_BIN, [channel][y * PE_BIN + x], x and y from the rectangle's
 * corner. */
typedef void (*pe_rect_fn)(const struct pe_draw *, const struct hl_rect *,
                           float (*out)[PE_BIN * PE_BIN]);

/* Rows by enum hl_shader: pe_kernels.c. */
struct pe_vertex_kernel {
    pe_vertex_fn run;            /* NULL: a triangle that covers the screen  */
    uint32_t attrs;              /* bits by location                         */
    uint32_t vary;               /* bits by hl_pe_vary that it writes        */
};
struct pe_fragment_kernel {
    struct hl_pe_stage stage;
    pe_rect_fn rect;             /* may be NULL; used with screen triangles  */
    uint32_t vary;               /* bits by hl_pe_vary that it reads         */
    bool stipples;               /* discards by HL_SPEC_STIPPLE              */
};
extern const struct pe_vertex_kernel pe_vertex_kernels[HL_SHADER_COUNT];
extern const struct pe_fragment_kernel pe_fragment_kernels[HL_SHADER_COUNT];

/* Specialisation constants by id, resolved when the program is made:
 * shaders/shared/block.h's defaults where the program gives none. */
union pe_spec { uint32_t u; float f; };

struct pe_program {
    struct hl_prog_desc desc;
    const struct pe_vertex_kernel *vertex;
    struct pe_fragment_kernel fragment;  /* .stage.shade NULL: depth only    */
    union pe_spec spec[HL_MAX_SPECS];    /* by id                            */
    bool centroid;               /* of more samples than one, HL_CENTROID    */
    /* Varyings that the one stage writes and the other reads.               */
    uint8_t n_vary, vary[HL_PE_VARY_COUNT];
};

/* ---- draws --------------------------------------------------------------- */

struct pe_draw {
    const struct hl_bk_draw *in;
    const struct pe_program *program;
    const struct hl_bk_pass *pass;
    const void *uniform[HL_MAX_UNIFORMS];     /* NULL: unbound               */
    uint32_t uniform_bytes[HL_MAX_UNIFORMS];
    const void *storage[HL_MAX_STORAGE];
    uint32_t storage_bytes[HL_MAX_STORAGE];
    struct pe_view view[HL_MAX_TEXTURES];     /* all set; unbound: white     */
};

/* ---- the device: pe_device.c --------------------------------------------- */

struct pe_buffer { uint8_t *memory; size_t bytes; };

struct pe_state {
    struct hl_device *device;
    struct hl_profile profile;
    bool console;                /* a profile other than native was given    */
    struct pe_buffer *buf;       /* by slot                                  */
    struct pe_texture *tex;
    struct pe_program *prog;
    uint32_t max_tex;
    uint32_t *edram;             /* edram_tiles * tile words; NULL: none     */
    struct pe_pool *threads;
    struct pe_pass *pass;        /* pe_pass.c's scratch, kept between passes */
    struct hl_timing *timing;    /* of the passes since the last submit      */
    uint32_t n_timings, max_timings, n_submitted;
    struct hl_timing *done;      /* n_submitted of the last waited submit    */
    uint32_t max_done;
};

/* ---- formats: pe_format.c ------------------------------------------------ */

uint32_t pe_words(enum hl_format);
/* n texels (n <= HL_PE_BATCH * 8) to and from planes of floats; channels that
 * a format lacks decode as 0, 0, 0, 1. Integer formats: planes hold bits.
 * Rounding: UNORM, SNORM and fixed point to nearest, halves away from zero;
 * floats to nearest even, at most their largest finite number; NaN becomes 0.
 * pe_decode makes no planes that are NULL. */
void pe_encode(enum hl_format, const float *const rgba[4], uint32_t n,
               uint32_t *words);
void pe_decode(enum hl_format, const uint32_t *words, uint32_t n,
               float *const rgba[4]);
/* Depth 0..1 (20e4: 0..2) as codes that order as depths do: float bits, or
 * 24 or 16 bits of unorm or 20e4. */
void pe_depth_encode(enum hl_format, const float *depth, uint32_t n,
                     uint32_t *codes);
float pe_depth_decode(enum hl_format, uint32_t code);
/* Blend of n texels already there with what a stage wrote (pe_blend.c); BLEND
 * OFF encodes. `bias`: hl_console.color_exp_bias. mask[i] 0: untouched; mask
 * NULL: all are written. Any n. */
void pe_blend(enum hl_format, enum hl_blend, float constant, int bias,
              const float *const rgba[4], const uint8_t *mask, uint32_t n,
              uint32_t *words);

/* ---- memory: pe_memory.c ------------------------------------------------- */

/* A bin's part of a target, pixel rows of `rect` with samples innermost, to
 * or from words: colour texels of pe_words each; depth targets one code each
 * and stencil (may be NULL where the format has none) one byte each. From
 * EDRAM where the texture is placed there, else from its memory. */
void pe_load_color(const struct pe_state *, uint32_t slot,
                   const struct hl_rect *, uint32_t *words);
void pe_store_color(struct pe_state *, uint32_t slot, const struct hl_rect *,
                    const uint32_t *words);
void pe_load_depth(const struct pe_state *, uint32_t slot,
                   const struct hl_rect *, uint32_t *codes, uint8_t *stencil);
void pe_store_depth(struct pe_state *, uint32_t slot, const struct hl_rect *,
                    const uint32_t *codes, const uint8_t *stencil);
/* After a pass, a bin's part: EDRAM to the texture's memory, for targets that
 * are sampled or read back (exponent bias, number format, endian swap), and
 * the average of samples into pass targets' resolves, from what has been
 * stored: a target that resolves is stored even if it is discarded. Called
 * by any thread for disjoint rectangles. */
void pe_resolve(struct pe_state *, const struct hl_bk_pass *,
                const struct hl_rect *);

/* Sampling. x and y outside the level are clamped. What a stage sees:
 * number format, remap, sRGB and sample_as applied; depth as depth in all
 * three; UINT views: bits. */
void pe_fetch(const struct pe_view *, uint32_t level, int32_t x, int32_t y,
              float out[4]);
/* n <= HL_PE_BATCH texels of level 0. */
void pe_fetch_texels(const struct pe_view *, const int32_t *x,
                     const int32_t *y, uint32_t n, float (*out)[HL_PE_BATCH]);
/* n texels of a row of level 0, planes [channel]; NULL planes are not made. */
void pe_fetch_row(const struct pe_view *, int32_t x, int32_t y, uint32_t n,
                  float *const rgba[4]);
/* The 2 x 2 texels with corner (x, y)[i] of level 0, each clamped: raw words
 * of UINT views, order 00 10 01 11. `word`: 0..3 of the texel. */
void pe_gather_words(const struct pe_view *, uint32_t word, const int32_t *x,
                     const int32_t *y, uint32_t n,
                     uint32_t (*out)[HL_PE_BATCH]);
/* The same, decoded: out[tap][channel]. */
void pe_gather(const struct pe_view *, const int32_t *x, const int32_t *y,
               uint32_t n, float (*out)[4][HL_PE_BATCH]);
/* Filtered at normalised (u, v); duv NULL: level 0. */
void pe_sample(const struct pe_view *, const float *u, const float *v,
               const float (*duv)[HL_PE_BATCH], uint32_t n,
               float (*out)[HL_PE_BATCH]);

/* ---- entries that files give the backend's table ------------------------- */

enum hl_result pe_tex_create(void *state, uint32_t slot,
                             const struct hl_tex_desc *);
enum hl_result pe_tex_write(void *state, uint32_t slot, uint32_t mip,
                            const void *data, size_t bytes);
enum hl_result pe_tex_read(void *state, uint32_t slot, void *out,
                           size_t bytes);
enum hl_result pe_submit(void *state, bool wait);
void pe_tex_destroy(struct pe_state *, uint32_t slot);
enum hl_result pe_prog_create(void *state, uint32_t slot,
                              const struct hl_prog_desc *);
enum hl_result pe_pass_run(void *state, const struct hl_bk_pass *,
                           const struct hl_bk_draw *, uint32_t n_draws);
void pe_pass_free(struct pe_state *);
#endif
