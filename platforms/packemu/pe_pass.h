/* SPDX-License-Identifier: Zlib */
#ifndef PE_PASS_H
#define PE_PASS_H
/* Private to a pass: the front end makes records of primitives and lists of
 * them by bin; bins turn records into fragments and fragments into texels.
 *
 * Determinism. Draws are cut into chunks by their number alone. A chunk's
 * records keep the order of its primitives, a bin goes through the chunks in
 * order, and no float takes another way when the number of threads differs.
 *
 * Positions are integers of 1/256 pixel. With coordinates inside the guard
 * band, differences have 23 bits and a sign, so that edge functions have 47,
 * and within one bin, in whole pixels, 31. */
#include "platforms/packemu/pe.h"

enum {
    PE_SUB_BITS = 8, PE_SUB = 1 << PE_SUB_BITS,
    PE_GUARD_LOW = -8192, PE_GUARD_HIGH = 24575,   /* pixels                 */
    PE_CACHE = 4096,         /* vertices kept while a segment is assembled   */
    PE_SEGMENT = 2048,       /* primitives of it                             */
    PE_RAW = 256,            /* fragments before the tests                   */
    PE_LANES8 = 8,           /* loops that write past their end by less      */
    PE_MAX_SAMPLES = 8
};

/* ---- the front end's results --------------------------------------------- */

/* A vertex is words: position, then the program's varyings in its order. */
union pe_word { int32_t i; uint32_t u; float f; };
/* RX, RY: what snapping took away, pixels. */
enum { PE_V_X, PE_V_Y, PE_V_Z, PE_V_IW, PE_V_RX, PE_V_RY, PE_V_VARY };

/* A triangle wound so that its area is positive, y down; its first vertex is
 * the provoking one. Lines have two vertices, screens none. */
struct pe_record {
    uint32_t v[3];           /* into the chunk's words                       */
    uint32_t draw;           /* PE_BACK: a back face                         */
    int16_t x0, y0, x1, y1;  /* pixels that may be covered, ends included    */
};
#define PE_BACK 0x80000000u

struct pe_pair { uint32_t bin, record; };

/* Consecutive primitives of consecutive draws. An array that turns out too
 * small ends the work on a chunk; the caller's thread enlarges it, since
 * only that one may allocate, and the chunk is done again. */
struct pe_chunk {
    uint32_t first_draw;
    uint64_t first, count;   /* primitives, `first` inside first_draw        */
    union pe_word *words;
    struct pe_record *records;
    struct pe_pair *pairs;   /* in order of records                          */
    uint32_t *sorted;        /* records by bin                               */
    uint32_t *start;         /* of each bin in `sorted`, and the end         */
    uint32_t n_words, max_words, n_records, max_records, n_pairs, max_pairs;
    uint32_t max_sorted, max_start;
    uint64_t need_words, need_records, need_pairs;   /* 0: there was room    */
};

/* Pixels: x = clip x / w * sx + ox. */
struct pe_viewport { float sx, ox, sy, oy; };

enum {                       /* outside which plane                          */
    PE_OUT_NEAR = 1, PE_OUT_FAR = 2, PE_OUT_W = 4, PE_OUT_LEFT = 8,
    PE_OUT_RIGHT = 16, PE_OUT_TOP = 32, PE_OUT_BOTTOM = 64,
    PE_OUT_BAD = 128         /* not finite: the primitive is dropped         */
};
struct pe_projected {
    int32_t x[PE_RUN], y[PE_RUN];
    float z[PE_RUN], iw[PE_RUN], rx[PE_RUN], ry[PE_RUN];
    int32_t out[PE_RUN];     /* PE_OUT_*                                     */
};

/* A thread's scratch in the front end. */
struct pe_front {
    struct pe_vertices v;
    struct pe_projected p;
    uint32_t ids[PE_RUN];
    float clip[PE_CACHE][4]; /* of the segment's vertices                    */
    uint8_t out[PE_CACHE];
    uint16_t local[3 * PE_SEGMENT];  /* the segment's indices into those     */
    uint32_t base, stride;   /* words of local vertex 0, and between two     */
};

/* ---- bins ---------------------------------------------------------------- */

/* A primitive as bins need it. Its attributes are planes p + px dx + py dy
 * with (dx, dy) from an anchor: the corner of the bin, or of the primitive's
 * bounds where those begin inside it. So distances are short, whatever the
 * primitive's size, and the same in every pass, whatever its scissor. px and
 * py come from the differences of the vertices' values: px = d1 c1x + d2 c2x.
 */
struct pe_tri {
    const union pe_word *v[3];
    double c1x, c2x, c1y, c2y;
    double x, y;             /* the anchor from vertex 0, pixels             */
    int32_t ax, ay;          /* the anchor, pixels of the bin                */
    float z, zx, zy;         /* depth                                        */
    bool back, snapped;      /* snapped: planes through snapped vertices     */
};
struct pe_plane { float at, x, y; };

/* Fragments before the tests, in runs of one primitive. */
struct pe_raw {
    uint32_t n, n_runs;
    uint16_t at[PE_RAW + PE_LANES8];     /* pixel: y * PE_BIN + x            */
    float z[PE_RAW + PE_LANES8];
    uint8_t cover[PE_RAW], back[PE_RAW]; /* with more samples than one       */
    uint8_t hull[PE_RAW];    /* cover before the tests, for centroids        */
    uint32_t code[PE_MAX_SAMPLES][PE_RAW];
    uint16_t pass[PE_RAW];
    uint32_t start[PE_RAW + 1];
    struct pe_tri tri[PE_RAW];
};

/* Fragments that are shaded together. */
struct pe_batch {
    uint16_t at[HL_PE_BATCH];
    uint8_t cover[HL_PE_BATCH], mask[HL_PE_BATCH];
    uint32_t code[PE_MAX_SAMPLES][HL_PE_BATCH];
    float dx[HL_PE_BATCH], dy[HL_PE_BATCH], iw[HL_PE_BATCH];
    float step[2][HL_PE_BATCH], w_step[2][HL_PE_BATCH];
    /* Where attributes are taken, from the anchor; w and an attribute at the
     * centre. Of centroids. */
    float at_x[HL_PE_BATCH], at_y[HL_PE_BATCH];
    float w_mid[HL_PE_BATCH], mid[HL_PE_BATCH];
    uint32_t words[4 * HL_PE_BATCH];
    struct hl_pe_fragments f;
};

/* Depth and stencil of a draw on the bin's samples. */
struct pe_test {
    enum hl_compare compare;
    bool write, stencil_on;
    struct hl_stencil stencil;
    uint32_t samples;
    uint32_t *depth;
    uint8_t *stencils;
};

/* A thread's scratch in a bin. */
struct pe_bin {
    struct pe_state *state;
    const struct pe_pass *pass;
    struct hl_rect rect;     /* texels lie in rows of PE_BIN, also where the
                              * target ends before the bin does              */
    uint32_t samples;
    uint32_t *color[HL_MAX_COLORS];
    uint32_t *depth;
    uint8_t *stencil;        /* NULL: the format has none                    */
    float (*planes)[PE_BIN * PE_BIN];    /* of rect stages                   */
    bool color_dirty, depth_dirty;
    uint64_t shaded, blended;    /* of the pass, on this thread              */
    /* The draw at work. */
    const struct pe_draw *draw;
    const struct hl_pe_stage *stage;
    struct pe_test test;
    bool tests;
    bool ordered;            /* blends: no pixel twice in a batch            */
    bool covered;            /* every fragment of a batch is written         */
    bool centroid;           /* the program's                                */
    struct pe_raw raw;
    struct pe_batch batch;
    uint32_t stamp, stamps[PE_BIN * PE_BIN];
    uint32_t *words;         /* what the pointers above point into           */
    uint32_t max_words;
};

/* ---- a pass -------------------------------------------------------------- */

struct pe_pass {
    struct pe_state *state;
    const struct hl_bk_pass *in;
    struct pe_viewport view;
    uint32_t nx, ny;         /* bins                                         */
    struct pe_draw *draws;
    uint32_t n_draws, max_draws;
    struct pe_chunk *chunks; /* max_chunks of them hold arrays               */
    uint32_t n_chunks, max_chunks;
    uint32_t *pending;       /* chunks to do                                 */
    uint32_t max_pending;
    struct pe_front **front; /* by thread                                    */
    struct pe_bin **bin;
    uint32_t max_front, max_bin;
    /* A bin of cleared texels, shared: color[i], depth, stencil.            */
    uint32_t *clear;
    uint32_t max_clear;
    uint32_t *clear_color[HL_MAX_COLORS], *clear_depth;
    uint8_t *clear_stencil;
    bool rects;              /* a draw has a rect stage                      */
};

/* Sample positions, 1/16 pixel from the centre: [log2 samples]. */
extern const int8_t pe_sample_at[4][PE_MAX_SAMPLES][2];
static inline uint32_t pe_sample_level(uint32_t samples)
{
    return samples == 8 ? 3 : samples / 2;
}

/* pe_vertex_fetch.c: what is the same for all of a draw's vertices; and
 * v->n vertices by id. */
void pe_fetch_begin(const struct pe_state *, const struct pe_draw *,
                    struct pe_vertices *);
void pe_fetch_vertices(const struct pe_state *, const struct pe_draw *,
                       const uint32_t *ids, struct pe_vertices *);

/* pe_front.c: item i is chunk pass->pending[i]. */
void pe_front_run(void *pass, uint32_t item, uint32_t thread);
uint64_t pe_primitives(const struct pe_draw *);
/* Room for n more words; NULL: the chunk is to be done again. */
union pe_word *pe_chunk_words(struct pe_chunk *, uint64_t n);

/* pe_clip.c */
void pe_project(const struct pe_viewport *, const float (*clip)[PE_RUN],
                struct pe_projected *);
/* A triangle (n 3) or line (n 2) of local vertices that are outside some
 * plane, cut and set up. False: no room. */
bool pe_clip(const struct pe_pass *, struct pe_front *, struct pe_chunk *,
             uint32_t draw, const uint16_t *local, uint32_t n);

/* pe_setup.c: cull, bound, record, list by bin. False: no room. */
bool pe_setup_triangle(const struct pe_pass *, struct pe_chunk *,
                       uint32_t draw, uint32_t a, uint32_t b, uint32_t c);
bool pe_setup_line(const struct pe_pass *, struct pe_chunk *, uint32_t draw,
                   uint32_t a, uint32_t b);
bool pe_setup_screen(const struct pe_pass *, struct pe_chunk *,
                     uint32_t draw);
void pe_chunk_sort(struct pe_chunk *, uint32_t n_bins);

/* pe_bin.c: scratch and cleared texels for all threads (false: no memory);
 * item is a bin. */
bool pe_bins_make(struct pe_pass *);
void pe_bin_run(void *pass, uint32_t item, uint32_t thread);

/* pe_raster.c: a record's fragments inside the bin. */
void pe_raster_record(struct pe_bin *, const struct pe_chunk *,
                      const struct pe_record *);

/* pe_fragment.c */
void pe_draw_begin(struct pe_bin *, uint32_t draw);
void pe_draw_end(struct pe_bin *);
/* Start a run of fragments. */
void pe_raw_begin(struct pe_bin *, const struct pe_tri *);
void pe_raw_flush(struct pe_bin *);

/* pe_attribute.c: planes of 1 / w, then of the varyings over w in the
 * program's order; and n fragments of one primitive, by their numbers among
 * the raw ones, added to the batch. */
void pe_planes_set(struct pe_plane *, const struct pe_tri *, uint32_t n_vary);
void pe_batch_join(struct pe_bin *, const struct pe_tri *,
                   const struct pe_plane *, const uint16_t *pass, uint32_t n);

/* pe_write.c: blend and store what the stage wrote. */
void pe_batch_write(struct pe_bin *);
/* Whole rectangle by the stage's rect. */
void pe_rect_run(struct pe_bin *, const struct hl_rect *);

/* pe_depth.c: test n fragments of one sample each without stencil, in order;
 * indices of those that pass to `pass`, their number returned. */
uint32_t pe_depth_test(const struct pe_test *, bool write, const uint16_t *at,
                       const uint32_t *codes, uint32_t n, uint16_t *pass);
/* Test sample `s` of the fragments whose cover has its bit; the bit of those
 * that fail is taken away. */
void pe_sample_test(const struct pe_test *, uint32_t s, const uint16_t *at,
                    const uint32_t *codes, const uint8_t *back, uint32_t n,
                    uint8_t *cover);
#endif
