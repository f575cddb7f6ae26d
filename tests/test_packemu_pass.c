/* SPDX-License-Identifier: Zlib */
/* What packemu's passes do with fragments: depth, stencil, discards, blends,
 * samples, scissors; the same bytes for any number of threads; no leak when
 * memory ends. */
#include <stdlib.h>
#include <string.h>
#include "hal/device.h"
#include "tests/raster_kit.h"

enum { W = 128, H = 64 };

/* Both halves of a rectangle of pixels at depth z. */
static void rectangle(struct rk_vertex v[6], float x0, float y0, float x1,
                      float y1, float z)
{
    v[0] = rk_at(x0, y0, z);
    v[1] = v[3] = rk_at(x0, y1, z);
    v[2] = v[5] = rk_at(x1, y0, z);
    v[4] = rk_at(x1, y1, z);
}

static void whole(struct rk_vertex v[6], float z)
{
    rectangle(v, 0, 0, W, H, z);
}

/* A scene of small and large triangles at all depths and colours. */
static uint32_t random_scene(struct rk_vertex *v, uint32_t n, uint64_t *seed)
{
    for (uint32_t i = 0; i < n; i++) {
        float size = i % 10 ? 12.0f : 150.0f, color[4];
        float x = mk_unit(seed) * W, y = mk_unit(seed) * H;
        for (int c = 0; c < 4; c++)
            color[c] = mk_unit(seed);
        for (int k = 0; k < 3; k++) {
            v[3 * i + (uint32_t)k] =
                rk_at(x + (mk_unit(seed) - 0.5f) * size,
                      y + (mk_unit(seed) - 0.5f) * size, mk_unit(seed));
            memcpy(v[3 * i + (uint32_t)k].color, color, sizeof color);
        }
    }
    return 3 * n;
}

/* ---- depth -------------------------------------------------------------- */

static void depth_is_compared_as_stated(void **state)
{
    static const float z[3] = { 0.25f, 0.5f, 0.75f };   /* 0.5 is there      */
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    for (int c = HL_COMPARE_NEVER; c <= HL_COMPARE_ALWAYS; c++)
        for (int i = 0; i < 3; i++) {
            struct rk_vertex v[6];
            bool less = i == 0, equal = i == 1;
            bool want[] = { true, false, less, less || equal, equal,
                            !less, !less && !equal, true };
            for (int k = 0; k < 3; k++) {
                /* Put 0.5 there; draw; see whether the depth is written. */
                whole(v, k == 1 ? z[i] : 0.5f);
                r.desc.depth_test = k == 0 ? HL_COMPARE_ALWAYS
                                    : k == 1 ? (enum hl_compare)c
                                             : HL_COMPARE_EQUAL;
                r.desc.depth_write = k < 2;
                r.desc.no_color_write = k == 0;
                rk_add(&r, k ? &rk_ones : NULL, v, 6, NULL, 0);
            }
            rk_run(&r);
            bool kept = !want[c] || equal;
            ck_near(rk_px(&r, 70, 40, 0), want[c] + kept, 0);
        }
    rk_close(&r);
}

/* The same geometry by other vertex and fragment stages, with other varyings,
 * other neighbours in a batch and other scissors, has the same depth codes. */
static void equal_depths_meet_in_every_program(void **state)
{
    enum { N = 400 };
    static struct rk_vertex v[3 * N];
    static const enum hl_shader stages[] = {
        HL_SHADER_MESH_ID_VERT, HL_SHADER_MESH_UV_ID_VERT,
        HL_SHADER_MESH_GBUFFER_VERT, HL_SHADER_MESH_FORWARD_FULL_VERT,
        HL_SHADER_MESH_OWN_VERT
    };
    uint64_t seed = mk_seed();
    static uint32_t turned[3 * N];
    (void)state;
    struct rk r;
    rk_open(&r, 1, W, H, 1);
    random_scene(v, N, &seed);
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t k = 0; k < 3; k++)
            turned[3 * i + k] = 3 * (N - 1 - i) + k;
    r.desc.depth_test = HL_COMPARE_LESS;
    r.desc.depth_write = true;
    rk_add(&r, NULL, v, 3 * N, NULL, 0);
    r.desc.depth_write = false;
    r.desc.depth_test = HL_COMPARE_GREATER;
    rk_add(&r, &rk_ones, v, 3 * N, NULL, 0);
    rk_run(&r);
    static float hidden[W * H * 4];
    memcpy(hidden, r.out, sizeof hidden);
    for (size_t k = 0; k < sizeof stages / sizeof stages[0]; k++) {
        r.desc.vertex.builtin = HL_SHADER_MESH_OWN_VERT;
        r.desc.depth_write = true;
        r.desc.depth_test = HL_COMPARE_LESS;
        rk_add(&r, NULL, v, 3 * N, NULL, 0);
        r.desc.vertex.builtin = stages[k];
        r.desc.depth_write = false;
        r.desc.depth_test = HL_COMPARE_LESS;
        rk_add(&r, &rk_ones, v, 3 * N, turned, 3 * N);
        rk_run(&r);
        for (uint32_t i = 0; i < W * H; i++)
            assert_true(r.out[4 * i] == 0);
        r.desc.depth_write = true;
        rk_add(&r, NULL, v, 3 * N, NULL, 0);
        r.desc.depth_write = false;
        r.desc.depth_test = HL_COMPARE_EQUAL;
        for (int i = 0; i < 4; i++) {         /* by parts                    */
            int32_t x = i & 1 ? 43 : 0, y = i & 2 ? 21 : 0;
            rk_add(&r, &rk_ones, v, 3 * N, turned, 3 * N)->scissor =
                (struct hl_rect){ x, y, x ? W - 43 : 43, y ? H - 21 : 21 };
        }
        r.desc.depth_test = HL_COMPARE_GREATER;
        rk_add(&r, &rk_ones, v, 3 * N, turned, 3 * N);
        rk_run(&r);
        /* Each fragment is hidden, or equal; and the first of each pixel is
         * equal. `all` has them without a test. */
        static float found[W * H * 4];
        memcpy(found, r.out, sizeof found);
        r.desc.depth_test = HL_COMPARE_OFF;
        rk_add(&r, &rk_ones, v, 3 * N, NULL, 0);
        rk_run(&r);
        for (uint32_t i = 0; i < W * H; i++) {
            assert_true(found[4 * i] == r.out[4 * i]);
            assert_true(r.out[4 * i] == 0 || found[4 * i] > hidden[4 * i]);
        }
    }
    rk_close(&r);
}

/* ---- stencil ------------------------------------------------------------ */

/* What one sample holds after the draws so far, by trying all values. */
static int stencil_value(struct rk *r, struct rk_vertex v[6])
{
    struct hl_prog_desc kept = r->desc;
    int found = -1;
    memset(&r->desc.stencil, 0, sizeof r->desc.stencil);
    r->desc.depth_test = HL_COMPARE_OFF;
    r->desc.depth_write = false;
    r->desc.cull = HL_CULL_NONE;
    r->pass.depth.load = HL_LOAD_KEEP;
    for (int i = 0; i < 256 && found < 0; i += 64) {
        for (int k = i; k < i + 64; k++) {
            r->desc.stencil.front.test = HL_COMPARE_EQUAL;
            r->desc.stencil.back.test = HL_COMPARE_EQUAL;
            r->desc.stencil.reference = (uint8_t)k;
            /* A reference of 0 with mask 0 = 255. */
            struct hl_draw *d = rk_add(r, &rk_ones, v, 6, NULL, 0);
            /* One pixel each, so that the answer is a position. */
            d->scissor = (struct hl_rect){ k % 64, 5, 1, 1 };
        }
        rk_run(r);
        for (int k = 0; k < 64; k++)
            if (rk_px(r, (uint32_t)k, 5, 0) != 0) {
                assert_int_equal(found, -1);
                found = i + k;
            }
    }
    r->pass.depth.load = HL_LOAD_CLEAR;
    r->desc = kept;
    return found;
}

static int model(enum hl_stencil_op op, int old, int reference)
{
    switch (op) {
    case HL_STENCIL_KEEP: return old;
    case HL_STENCIL_ZERO: return 0;
    case HL_STENCIL_REPLACE: return reference;
    case HL_STENCIL_INCREMENT: return old == 255 ? 255 : old + 1;
    case HL_STENCIL_DECREMENT: return old == 0 ? 0 : old - 1;
    case HL_STENCIL_INCREMENT_WRAP: return (old + 1) & 255;
    case HL_STENCIL_DECREMENT_WRAP: return (old - 1) & 255;
    case HL_STENCIL_INVERT: return 255 - old;
    }
    return -1;
}

/* Each operation, in each of its three places, on the ends and between. */
static void stencils_do_their_operations(void **state)
{
    static const int olds[] = { 0, 255, 100 };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    struct rk_vertex v[6];
    whole(v, 0.5f);
    for (int op = 0; op <= HL_STENCIL_INVERT; op++)
        for (int i = 0; i < 9; i++) {
            int old = olds[i % 3], place = i / 3;
            struct hl_stencil *s = &r.desc.stencil;
            memset(s, 0, sizeof *s);
            s->reference = 77;
            s->front.test = place ? HL_COMPARE_ALWAYS : HL_COMPARE_NEVER;
            *(place == 0 ? &s->front.fail : place == 1 ? &s->front.depth_fail
                                                       : &s->front.pass) =
                (enum hl_stencil_op)op;
            s->back.test = HL_COMPARE_NEVER;
            r.desc.depth_test = place == 1 ? HL_COMPARE_GREATER
                                           : HL_COMPARE_LESS;
            r.pass.depth.clear[1] = (float)old;
            rk_add(&r, &rk_ones, v, 6, NULL, 0);
            rk_run(&r);
            ck_near(rk_px(&r, 3, 5, 0), place == 2 ? 1 : 0, 0);
            r.desc.depth_test = HL_COMPARE_OFF;
            assert_int_equal(stencil_value(&r, v),
                             model((enum hl_stencil_op)op, old, 77));
        }
    rk_close(&r);
}

static void stencil_masks_and_faces_count(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    struct rk_vertex v[6], turned[6];
    whole(v, 0.5f);
    for (int i = 0; i < 6; i++)
        turned[i] = v[i / 3 * 3 + (3 - i % 3) % 3];
    struct hl_stencil *s = &r.desc.stencil;
    /* Reference and stored agree in the low half; the high half is written. */
    s->front.test = HL_COMPARE_EQUAL;
    s->front.pass = HL_STENCIL_INVERT;
    s->back.test = HL_COMPARE_ALWAYS;
    s->back.pass = HL_STENCIL_DECREMENT;
    s->reference = 0xa5;
    s->read_mask = 0x0f;
    s->write_mask = 0xf0;
    r.pass.depth.clear[1] = 0x35;
    rk_add(&r, &rk_ones, v, 6, NULL, 0);
    rk_run(&r);
    ck_near(rk_px(&r, 3, 5, 0), 1, 0);
    assert_int_equal(stencil_value(&r, v), 0xc5);
    s->reference = 0xa4;
    rk_add(&r, &rk_ones, v, 6, NULL, 0);
    rk_run(&r);
    ck_near(rk_px(&r, 3, 5, 0), 0, 0);
    assert_int_equal(stencil_value(&r, v), 0x35);
    s->write_mask = 0;                        /* all                         */
    rk_add(&r, &rk_ones, turned, 6, NULL, 0);
    rk_run(&r);
    ck_near(rk_px(&r, 3, 5, 0), 1, 0);
    assert_int_equal(stencil_value(&r, v), 0x34);
    rk_close(&r);
}

/* ---- discards ----------------------------------------------------------- */

static void shade_odd(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++) {
        f->discard[i] = (f->x[i] + f->y[i]) & 1;
        for (int c = 0; c < 4; c++)
            f->color[0][c][i] = 1.0f;
    }
}

/* What is discarded writes no depth, whatever lies in the batch beside it. */
static void discards_leave_no_depth(void **state)
{
    static const struct hl_pe_stage stage = { .shade = shade_odd,
                                              .discards = true };
    static const struct hl_code odd = {
        .kernel = (void (*)(void))(uintptr_t)&stage
    };
    static const uint32_t counts[2] = { 1, 4 };
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct rk r;
        struct rk_vertex v[6];
        rk_open(&r, 1, W, H, counts[i]);
        r.desc.depth_test = HL_COMPARE_LESS;
        r.desc.depth_write = true;
        whole(v, 0.25f);
        rk_add(&r, &odd, v, 6, NULL, 0);
        rk_add(&r, &odd, v, 6, NULL, 0);      /* not less any more           */
        whole(v, 0.5f);
        rk_add(&r, &rk_ones, v, 6, NULL, 0);
        rk_run(&r);
        for (uint32_t p = 0; p < W * H; p++)
            assert_true(r.out[4 * p] == 1.0f);
        rk_close(&r);
    }
}

/* ---- blending ----------------------------------------------------------- */

static float mix(enum hl_blend blend, float s, float a, float d, bool alpha)
{
    switch (blend) {
    case HL_BLEND_OFF: return s;
    case HL_BLEND_ADD: return s + d;
    case HL_BLEND_OVER: return alpha ? a + d * (1.0f - a)
                                     : s * a + d * (1.0f - a);
    case HL_BLEND_ADD_ALPHA: return alpha ? d : s * a + d;
    case HL_BLEND_MAX: return s > d ? s : d;
    case HL_BLEND_SHIFT: return s + d * 0.25f;
    }
    return 0;
}

/* Overlapping rectangles in one draw, so that a pixel comes up several times
 * in a batch: to the bit what blending them one by one gives. */
static void blends_follow_the_order_of_primitives(void **state)
{
    enum { N = 200 };
    static struct rk_vertex v[6 * N];
    static float want[H][W][4];
    uint64_t seed = mk_seed();
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    r.desc.blend_constant = 0.25f;
    for (int b = 0; b <= HL_BLEND_SHIFT; b++) {
        memset(want, 0, sizeof want);
        for (int i = 0; i < N; i++) {
            int x = (int)mk_below(&seed, W - 1);
            int y = (int)mk_below(&seed, H - 1);
            int w = 1 + (int)mk_below(&seed, 9);
            int h = 1 + (int)mk_below(&seed, 9);
            float c[4];
            for (int k = 0; k < 4; k++)
                c[k] = mk_unit(&seed);
            rectangle(v + 6 * i, (float)x, (float)y, (float)(x + w),
                      (float)(y + h), 0.5f);
            for (int k = 0; k < 6; k++)
                memcpy(v[6 * i + k].color, c, sizeof c);
            for (int py = y; py < y + h && py < H; py++)
                for (int px = x; px < x + w && px < W; px++)
                    for (int k = 0; k < 4; k++)
                        want[py][px][k] = mix((enum hl_blend)b, c[k], c[3],
                                              want[py][px][k], k == 3);
        }
        r.desc.blend = (enum hl_blend)b;
        rk_add(&r, &rk_color, v, 6 * N, NULL, 0);
        rk_run(&r);
        assert_memory_equal(r.out, want, sizeof want);
    }
    rk_close(&r);
}

/* pe_blend by format: the range clamps the source, the bias scales it. */
static void blends_keep_to_the_range_of_a_format(void **state)
{
    static const struct {
        enum hl_format format;
        enum hl_blend blend;
        int bias;
        float there, source, alpha, want;
    } row[] = {
        /* 2 is clamped to 1 before it is halved. */
        { HL_FORMAT_RGBA8_UNORM, HL_BLEND_OVER, 0, 0, 2, 0.6f, 0.6f },
        { HL_FORMAT_RGBA16_UNORM, HL_BLEND_OVER, 0, 0, 2, 0.6f, 0.6f },
        { HL_FORMAT_RGBA16_FLOAT, HL_BLEND_OVER, 0, 0, 2, 0.5f, 1.0f },
        { HL_FORMAT_RGBA16_FLOAT, HL_BLEND_ADD, 0, 0.5f, 0.25f, 1, 0.75f },
        { HL_FORMAT_RGBA16_FLOAT, HL_BLEND_ADD, 0, 65504, 65504, 1, 65504 },
        { HL_FORMAT_RGBA16_UNORM, HL_BLEND_ADD, 0, 0.6f, 0.6f, 1, 1 },
        { HL_FORMAT_RGBA16_UNORM, HL_BLEND_ADD, 0, 0.6f, -1, 1, 0.6f },
        { HL_FORMAT_RGBA16_SNORM, HL_BLEND_ADD, 0, 1, -3, 1, 0 },
        { HL_FORMAT_RGBA16_FIXED32, HL_BLEND_ADD, 5, 0, 0.5f, 1,
          16.00048828125f },
        { HL_FORMAT_RGBA16_FIXED32, HL_BLEND_ADD, 5, 32, -40, 1, 0 },
        { HL_FORMAT_RGBA16_FLOAT, HL_BLEND_OFF, -5, 0, 32, 1, 1 },
        { HL_FORMAT_RGBA8_UNORM, HL_BLEND_SHIFT, 0, 0.8f, 0.2f, 1, 0.4f },
        { HL_FORMAT_RGBA8_UNORM, HL_BLEND_MAX, 0, 0.8f, 0.2f, 1, 0.8f },
        { HL_FORMAT_RG11B10_FLOAT, HL_BLEND_ADD, 0, 1, 2, 1, 3 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        const enum hl_format f = row[i].format;
        float a = row[i].there, got[4], b = row[i].source, c = row[i].alpha;
        const float *const there[4] = { &a, &a, &a, &a };
        const float *const source[4] = { &b, &b, &b, &c };
        float *const out[4] = { got, got + 1, got + 2, got + 3 };
        const uint8_t off = 0;
        uint32_t words[4] = { 0 }, before[4];
        pe_encode(f, there, 1, words);
        memcpy(before, words, sizeof words);
        pe_blend(f, row[i].blend, 0.25f, row[i].bias, source, &off, 1, words);
        assert_memory_equal(words, before, sizeof words);
        pe_blend(f, row[i].blend, 0.25f, row[i].bias, source, NULL, 1, words);
        pe_decode(f, words, 1, out);
        /* Half a step of 8 bits each for what was there and the result. */
        ck_near(got[0], (double)row[i].want,
                f == HL_FORMAT_RGBA8_UNORM ? 1 / 255.0 : 2e-5);
        ck_near(got[2], (double)row[i].want,
                f == HL_FORMAT_RGBA8_UNORM ? 1 / 255.0 : 2e-5);
    }
}

/* Paths that are made for one format, against decoding and encoding. */
static void fast_blends_are_the_slow_ones(void **state)
{
    static const enum hl_format formats[] = {
        HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGBA16_UNORM
    };
    enum { N = 300 };
    static float p[4][N], t[4][N], q[4][N];
    static uint32_t words[2 * N], want[2 * N];
    uint64_t seed = mk_seed();
    const float *const s[4] = { p[0], p[1], p[2], p[3] };
    float *const d[4] = { t[0], t[1], t[2], t[3] };
    const float *const m[4] = { q[0], q[1], q[2], q[3] };
    (void)state;
    for (int k = 0; k < 3 * 6 * 4; k++) {
        enum hl_format f = formats[k % 3];
        enum hl_blend blend = (enum hl_blend)(k / 3 % 6);
        bool unorm = f != HL_FORMAT_RGBA16_FLOAT;
        uint32_t n = N - mk_below(&seed, 9), stride = pe_words(f);
        for (uint32_t i = 0; i < n * stride; i++)
            /* No infinities: encoders make none. */
            words[i] = mk_random(&seed) & (unorm ? 0xffffffffu : 0xbbffbbffu);
        for (int c = 0; c < 4; c++)
            for (uint32_t i = 0; i < n; i++)
                p[c][i] = (mk_unit(&seed) - 0.2f) * (k % 2 ? 2.0f : 1e-4f);
        pe_decode(f, words, n, d);
        for (int c = 0; c < 4; c++)
            for (uint32_t i = 0; i < n; i++) {
                float x = p[c][i], a = p[3][i];
                if (unorm) {
                    x = x < 0 ? 0 : x > 1 ? 1 : x;
                    a = a < 0 ? 0 : a > 1 ? 1 : a;
                }
                q[c][i] = mix(blend, x, a, t[c][i], c == 3);
            }
        pe_encode(f, m, n, want);
        pe_blend(f, blend, 0.25f, 0, s, NULL, n, words);
        assert_memory_equal(words, want, n * stride * sizeof *words);
    }
}

/* ---- samples, scissors, screens ----------------------------------------- */

/* A rectangle that ends at quarter pixels: each pixel's average is the share
 * of samples inside, and what lies under it shows through the rest. */
static void samples_are_blended_apart(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 4);
    struct rk_vertex v[6];
    r.desc.blend = HL_BLEND_OFF;
    whole(v, 0.75f);
    for (int i = 0; i < 6; i++)
        v[i].color[1] = 1;
    r.desc.depth_test = HL_COMPARE_LESS;
    r.desc.depth_write = true;
    rk_add(&r, &rk_color, v, 6, NULL, 0);
    rectangle(v, 10, 10, 20.5f, 20, 0.25f);
    for (int i = 0; i < 6; i++)
        v[i].color[0] = 1;
    rk_add(&r, &rk_color, v, 6, NULL, 0);
    /* Behind the first and before the second: fills what is left of it. */
    rectangle(v, 10, 10, 30, 20, 0.5f);
    for (int i = 0; i < 6; i++)
        v[i].color[2] = 1;
    rk_add(&r, &rk_color, v, 6, NULL, 0);
    rk_run(&r);
    /* Samples at x 2/16 and 6/16 are left of a half, two of four. */
    static const struct { uint32_t x; float want[3]; } at[] = {
        { 5, { 0, 1, 0 } }, { 19, { 1, 0, 0 } }, { 20, { 0.5f, 0, 0.5f } },
        { 21, { 0, 0, 1 } }, { 30, { 0, 1, 0 } }
    };
    for (int i = 0; i < 5; i++)
        for (uint32_t c = 0; c < 3; c++)
            ck_near(rk_px(&r, at[i].x, 15, c), (double)at[i].want[c], 0);
    rk_close(&r);
}

/* A slanted plane through a level one: each sample is tested at its own
 * depth. Planes z = 0.5 + (x gx + y gy + d) with x, y from the middle. */
static void samples_have_depths_of_their_own(void **state)
{
    static const int at[3][8][2] = {         /* 1/16 pixel from the centre   */
        { { 4, 4 }, { -4, -4 } },
        { { -2, -6 }, { 6, -2 }, { -6, 2 }, { 2, 6 } },
        { { 1, -3 }, { -1, 3 }, { 5, 1 }, { -3, -5 },
          { -5, 5 }, { -7, -1 }, { 3, 7 }, { 7, -7 } }
    };
    uint64_t seed = mk_seed();
    (void)state;
    for (uint32_t k = 0; k < 30; k++) {
        uint32_t level = k % 3, samples = 2u << level;
        struct rk r;
        struct rk_vertex v[6];
        rk_open(&r, 1, W, H, samples);
        r.desc.depth_test = HL_COMPARE_LESS;
        r.desc.depth_write = true;
        whole(v, 0.5f);
        rk_add(&r, NULL, v, 6, NULL, 0);
        float gx = (mk_unit(&seed) - 0.5f) / W;
        float gy = (mk_unit(&seed) - 0.5f) / H;
        for (int i = 0; i < 6; i++)
            v[i].p[2] = 0.5f + (v[i].p[0] - W / 2) * gx +
                        (v[i].p[1] - H / 2) * gy;
        rk_add(&r, &rk_ones, v, 6, NULL, 0);
        rk_run(&r);
        for (uint32_t y = 0; y < H; y++)
            for (uint32_t x = 0; x < W; x++) {
                uint32_t n = 0, unsure = 0;
                for (uint32_t s = 0; s < samples; s++) {
                    double dx = x + 0.5 + at[level][s][0] / 16.0 - W / 2;
                    double dy = y + 0.5 + at[level][s][1] / 16.0 - H / 2;
                    double z = dx * (double)gx + dy * (double)gy;
                    /* A step of 24 bits is 6e-8; floats of the vertices and
                     * of the plane round by as much, four times. */
                    unsure += z < 5e-7 && z > -5e-7;
                    n += z < 0;
                }
                if (!unsure)
                    ck_near(rk_px(&r, x, y, 0), (double)n / samples, 0);
            }
        rk_close(&r);
    }
}

static void scissors_cut_meshes_and_screens(void **state)
{
    static const struct hl_rect cuts[] = {
        { 0, 0, 1, 1 }, { 63, 10, 2, 50 }, { 64, 0, 64, 64 },
        { 5, 7, 120, 55 }, { 127, 63, 1, 1 }
    };
    struct rk r;
    struct rk_vertex v[6];
    (void)state;
    rk_open(&r, 1, W, H, 1);
    whole(v, 0.5f);
    for (int i = 0; i < 20; i++) {
        const struct hl_rect *c = &cuts[i % 5];
        r.desc.depth_test = i / 10 ? HL_COMPARE_LESS : HL_COMPARE_OFF;
        struct hl_draw *d = i / 5 % 2 ? rk_screen(&r, &rk_ones)
                                      : rk_add(&r, &rk_ones, v, 6, NULL, 0);
        d->scissor = *c;
        rk_run(&r);
        for (int y = 0; y < H; y++)
            for (int x = 0; x < W; x++) {
                bool in = x >= c->x && x < c->x + c->width && y >= c->y &&
                          y < c->y + c->height;
                assert_true(rk_px(&r, (uint32_t)x, (uint32_t)y, 0) ==
                            (in ? 1.0f : 0.0f));
            }
    }
    rk_close(&r);
}

/* Direct3D 9: what is drawn lies half a pixel further right and down, until
 * the state that puts centres at halves. */
static void integer_centres_shift_by_half_a_pixel(void **state)
{
    struct hl_profile profile;
    struct rk r;
    struct rk_vertex v[6];
    (void)state;
    memset(&profile, 0, sizeof profile);
    strcpy(profile.name, "d3d9");
    profile.integer_centers = true;
    rk_open_profile(&r, &profile, W, H);
    rectangle(v, 10.25f, 10.25f, 20.25f, 20.25f, 0.5f);
    for (uint32_t i = 0; i < 2; i++) {
        r.pass.half_pixel_offset = i == 1;
        rk_add(&r, &rk_ones, v, 6, NULL, 0);
        rk_run(&r);
        /* From 10.75 on no centre of pixel 10 is inside. */
        ck_near(rk_px(&r, 10, 15, 0), i, 0);
        ck_near(rk_px(&r, 15, 10, 0), i, 0);
        ck_near(rk_px(&r, 20, 15, 0), 1 - (double)i, 0);
        ck_near(rk_px(&r, 15, 20, 0), 1 - (double)i, 0);
    }
    rk_close(&r);
}

/* Loads: what is kept stays where nothing is drawn and where it is. */
static void targets_are_loaded_as_stated(void **state)
{
    struct rk r;
    struct rk_vertex v[6];
    (void)state;
    rk_open(&r, 1, W, H, 1);
    rectangle(v, 10, 10, 20, 20, 0.5f);
    for (int i = 0; i < 3; i++) {
        r.pass.color[0].load = i == 2 ? HL_LOAD_CLEAR : HL_LOAD_KEEP;
        r.pass.color[0].clear[0] = 5;
        if (i == 0) {
            r.pass.color[0].load = HL_LOAD_CLEAR;
            r.pass.color[0].clear[0] = 3;
        }
        rk_add(&r, &rk_ones, v, 6, NULL, 0);
        rk_run(&r);
        ck_near(rk_px(&r, 15, 15, 0), i == 0 ? 4 : i == 1 ? 5 : 6, 0);
        ck_near(rk_px(&r, 100, 50, 0), i == 2 ? 5 : 3, 0);
    }
    rk_close(&r);
}

/* ---- threads, memory ---------------------------------------------------- */

/* Many draws of different kinds over many chunks and bins. */
static void draw_all(struct rk *r, const struct rk_vertex *v, uint32_t n)
{
    for (int i = 0; i < 20; i++) {
        r->desc.blend = i % 3 ? HL_BLEND_OFF : HL_BLEND_OVER;
        r->desc.depth_test = i % 4 ? HL_COMPARE_LESS_EQUAL : HL_COMPARE_OFF;
        r->desc.depth_write = i % 4 != 0 && i % 2;
        if (i == 7)
            rk_screen(r, &rk_ones)->scissor = (struct hl_rect){ 9, 9, 90, 3 };
        rk_add(r, i % 5 ? &rk_color : &rk_depths, v + i * 30,
               n - 30 * (uint32_t)i, NULL, 0);
    }
    rk_run(r);
}

static void threads_do_not_change_a_byte(void **state)
{
    enum { N = 3000 };
    static struct rk_vertex v[3 * N];
    static float first[W * H * 4];
    static const uint32_t threads[] = { 1, 2, 5 };
    uint64_t seed = mk_seed();
    (void)state;
    random_scene(v, N, &seed);
    for (int i = 0; i < 6; i++) {
        struct rk r;
        rk_open(&r, threads[i % 3], W, H, i / 3 ? 4 : 1);
        draw_all(&r, v, 3 * N);
        if (i % 3 == 0)
            memcpy(first, r.out, sizeof first);
        assert_memory_equal(first, r.out, sizeof first);
        draw_all(&r, v, 3 * N);               /* grown arrays, kept          */
        assert_memory_equal(first, r.out, sizeof first);
        rk_close(&r);
    }
}

/* Every allocation of a first pass fails once; the next try draws. */
static void passes_survive_the_end_of_memory(void **state)
{
    struct rk r;
    uint32_t failed = 0;
    enum { N = 700 };
    static struct rk_vertex v[3 * N];
    static float first[W * H * 4];
    uint64_t seed = mk_seed();
    (void)state;
    random_scene(v, N, &seed);
    for (uint32_t i = 1;; i++) {
        rk_open(&r, 2, W, H, 1);
        rk_add(&r, &rk_color, v, 3 * N, NULL, 0);
        r.pass.draws = r.draw;
        r.pass.n_draws = r.n;
        r.m.memory.fail_at = r.m.memory.n_allocs + i;
        enum hl_result got = hl_pass_run(r.d, &r.pass);
        bool reached = r.m.memory.n_allocs >= r.m.memory.fail_at;
        r.m.memory.fail_at = 0;
        assert_int_equal(got, reached ? HL_ERR_MEMORY : HL_OK);
        failed += reached;
        rk_run(&r);
        if (i == 1)
            memcpy(first, r.out, sizeof first);
        assert_memory_equal(first, r.out, sizeof first);
        rk_close(&r);
        if (!reached)
            break;
    }
    assert_true(failed > 8);
}

static void missing_kernels_are_refused(void **state)
{
    static const struct hl_pe_stage idle = { .slope = true };
    static const struct hl_code empty, shadeless = {
        .kernel = (void (*)(void))(uintptr_t)&idle
    };
    struct rk r;
    hl_prog p;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    struct hl_prog_desc d = r.desc;
    d.fragment.code = &empty;
    CK_REFUSED(&r.m, hl_prog_create(r.d, &p, &d), HL_ERR_UNSUPPORTED,
               HL_MSG_BACKEND, "fragment stage");
    d.fragment.code = &shadeless;
    CK_REFUSED(&r.m, hl_prog_create(r.d, &p, &d), HL_ERR_UNSUPPORTED,
               HL_MSG_BACKEND, "fragment stage");
    d.fragment.code = &rk_ones;
    d.vertex.builtin = HL_SHADER_NONE;
    d.vertex.code = &rk_ones;
    CK_REFUSED(&r.m, hl_prog_create(r.d, &p, &d), HL_ERR_UNSUPPORTED,
               HL_MSG_BACKEND, "vertex stage");
    rk_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(depth_is_compared_as_stated),
        cmocka_unit_test(equal_depths_meet_in_every_program),
        cmocka_unit_test(stencils_do_their_operations),
        cmocka_unit_test(stencil_masks_and_faces_count),
        cmocka_unit_test(discards_leave_no_depth),
        cmocka_unit_test(blends_follow_the_order_of_primitives),
        cmocka_unit_test(blends_keep_to_the_range_of_a_format),
        cmocka_unit_test(fast_blends_are_the_slow_ones),
        cmocka_unit_test(samples_are_blended_apart),
        cmocka_unit_test(samples_have_depths_of_their_own),
        cmocka_unit_test(scissors_cut_meshes_and_screens),
        cmocka_unit_test(integer_centres_shift_by_half_a_pixel),
        cmocka_unit_test(targets_are_loaded_as_stated),
        cmocka_unit_test(threads_do_not_change_a_byte),
        cmocka_unit_test(passes_survive_the_end_of_memory),
        cmocka_unit_test(missing_kernels_are_refused),
    };
    return cmocka_run_group_tests_name("packemu passes", tests, NULL, NULL);
}
