/* SPDX-License-Identifier: Zlib */
/* Which pixels and samples packemu covers, and what it interpolates: against
 * the rules by brute force, in integers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "shaders/shared/block.h"
#include "tests/raster_kit.h"

enum { W = 128, H = 64 };

static const int positions[4][8][2] = {      /* 1/16 pixel from the centre   */
    { { 0, 0 } },
    { { 4, 4 }, { -4, -4 } },
    { { -2, -6 }, { 6, -2 }, { -6, 2 }, { 2, 6 } },
    { { 1, -3 }, { -1, 3 }, { 5, 1 }, { -3, -5 },
      { -5, 5 }, { -7, -1 }, { 3, 7 }, { 7, -7 } }
};

/* ---- the rule, by brute force ------------------------------------------- */

static int64_t sub(float pixels) { return (int64_t)(pixels * 256.0f); }

/* Is the point (1/256 pixel) inside the triangle, top and left edges in? */
static bool inside(const struct rk_vertex *v, int64_t x, int64_t y)
{
    int64_t px[3], py[3];
    for (int i = 0; i < 3; i++) {
        px[i] = sub(v[i].p[0]);
        py[i] = sub(v[i].p[1]);
    }
    int64_t area = (px[1] - px[0]) * (py[2] - py[0]) -
                   (py[1] - py[0]) * (px[2] - px[0]);
    for (int i = 0; i < 3 && area != 0; i++) {
        int a = i, b = (i + 1) % 3;
        if (area < 0) {
            a = b;
            b = i;
        }
        int64_t dx = px[b] - px[a], dy = py[b] - py[a];
        int64_t e = dx * (y - py[a]) - dy * (x - px[a]);
        bool top_left = dy < 0 || (dy == 0 && dx > 0);
        if (e < 0 || (e == 0 && !top_left))
            return false;
    }
    return area != 0;
}

static int covered(const struct rk_vertex *v, uint32_t x, uint32_t y,
                   uint32_t samples)
{
    int n = 0, level = samples == 8 ? 3 : (int)samples / 2;
    for (uint32_t s = 0; s < samples; s++)
        n += inside(v, (int64_t)x * 256 + 128 + positions[level][s][0] * 16,
                    (int64_t)y * 256 + 128 + positions[level][s][1] * 16);
    return n;
}

/* ---- meshes ------------------------------------------------------------- */

/* A coordinate from low to high, a multiple of 1 / parts. */
static float coordinate(uint64_t *seed, int low, int high, uint32_t parts)
{
    uint32_t n = (uint32_t)(high - low) * parts + 1;
    return (float)low + (float)mk_below(seed, n) / (float)parts;
}

static void random_triangle(struct rk_vertex *v, uint64_t *seed, int margin,
                            uint32_t parts)
{
    for (int i = 0; i < 3; i++)
        v[i] = rk_at(coordinate(seed, -margin, W + margin, parts),
                     coordinate(seed, -margin, H + margin, parts), 0.5f);
}

static void every_pixel_once(const struct rk *r)
{
    for (uint32_t y = 0; y < r->h; y++)
        for (uint32_t x = 0; x < r->w; x++)
            if (rk_px(r, x, y, 0) != 1.0f)
                fail_msg("pixel %u, %u is hit %g times", x, y,
                         (double)rk_px(r, x, y, 0));
}

/* ---- coverage ----------------------------------------------------------- */

static void triangles_cover_by_the_rule(void **state)
{
    static const uint32_t counts[] = { 1, 2, 4, 8 };
    uint64_t seed = mk_seed();
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct rk r;
        rk_open(&r, 1, W, H, counts[k]);
        for (int i = 0; i < 60; i++) {
            struct rk_vertex v[3];
            /* Coarse grids have many centres on edges, fine ones slivers. */
            random_triangle(v, &seed, i % 3 ? 40 : 2000,
                            i % 2 ? 2 : 256);
            rk_add(&r, &rk_ones, v, 3, NULL, 0);
            rk_run(&r);
            for (uint32_t y = 0; y < H; y++)
                for (uint32_t x = 0; x < W; x++) {
                    /* n / samples is exact for powers of two. */
                    float want = (float)covered(v, x, y, counts[k]) /
                                 (float)counts[k];
                    if (rk_px(&r, x, y, 0) != want)
                        fail_msg("%u samples, pixel %u, %u: %g, not %g",
                                 counts[k], x, y,
                                 (double)rk_px(&r, x, y, 0), (double)want);
                }
        }
        rk_close(&r);
    }
}

enum { GX = 12, GY = 8 };

static void a_grid_covers_every_pixel_once(void **state)
{
    static struct rk_vertex v[(GX + 1) * (GY + 1)];
    uint32_t indices[GX * GY * 6], n;
    uint64_t seed = mk_seed();
    (void)state;
    struct rk r;
    rk_open(&r, 1, W, H, 1);
    for (int k = 0; k < 40; k++) {
        /* Cells of 16 x 16 from -32, -32; vertices move by up to 3, which
         * folds no cell: to halves (centres and corners), or anywhere. */
        for (int y = 0; y <= GY; y++)
            for (int x = 0; x <= GX; x++) {
                uint32_t parts = k % 2 ? 2 : 256;
                float dx = coordinate(&seed, -3, 3, parts);
                float dy = coordinate(&seed, -3, 3, parts);
                v[y * (GX + 1) + x] = rk_at((float)(x * 16 - 32) + dx,
                                            (float)(y * 16 - 32) + dy, 0.5f);
            }
        n = 0;
        for (uint32_t y = 0; y < GY; y++)
            for (uint32_t x = 0; x < GX; x++) {
                uint32_t a = y * (GX + 1) + x, b = a + 1, c = a + GX + 1;
                uint32_t d = c + 1;
                bool flip = mk_below(&seed, 2);
                uint32_t q[2][6] = { { a, b, c, b, d, c },
                                     { a, b, d, d, c, a } };
                memcpy(indices + n, q[flip], sizeof q[0]);
                n += 6;
            }
        rk_add(&r, &rk_ones, v, (GX + 1) * (GY + 1), indices, n);
        rk_run(&r);
        every_pixel_once(&r);
    }
    rk_close(&r);
}

/* Far vertices lie outside the guard band: x/y are clipped, shared edges
 * alike. */
static void fans_cover_every_pixel_once(void **state)
{
    uint64_t seed = mk_seed();
    (void)state;
    struct rk r;
    rk_open(&r, 1, W, H, 1);
    for (int k = 0; k < 60; k++) {
        float far = k % 3 == 0 ? 100.0f : k % 3 == 1 ? 7000.0f : 1e6f;
        struct rk_vertex rim[16], v[48];
        struct rk_vertex centre =
            rk_at(coordinate(&seed, 0, W, k % 2 ? 2 : 256),
                  coordinate(&seed, 0, H, k % 2 ? 2 : 256), 0.5f);
        /* The rim turns once around the target, more than a right angle
         * never between two of its vertices. */
        for (int i = 0; i < 16; i++) {
            float s = (float)(i % 4) / 4.0f + mk_unit(&seed) * 0.2f;
            float along = (s * 2.0f - 1.0f) * far;
            float x[4] = { along, far, -along, -far };
            float y[4] = { -far, along, far, -along };
            rim[i] = rk_at(W / 2 + x[i / 4] * 2.0f, H / 2 + y[i / 4] * 2.0f,
                           0.5f);
        }
        for (int i = 0; i < 16; i++) {
            v[3 * i] = centre;
            v[3 * i + 1] = rim[i];
            v[3 * i + 2] = rim[(i + 1) % 16];
        }
        rk_add(&r, &rk_ones, v, 48, NULL, 0);
        rk_run(&r);
        every_pixel_once(&r);
    }
    rk_close(&r);
}

static void large_targets_are_covered_to_their_ends(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, 16384, 2, 1);
    /* The edge goes from the first pixel's top to the last one's bottom. */
    struct rk_vertex v[6] = { rk_at(0, 0, 0), rk_at(16384, 0, 0),
                              rk_at(16384, 2, 0), rk_at(0, 0, 0),
                              rk_at(16384, 2, 0), rk_at(0, 2, 0) };
    rk_add(&r, &rk_ones, v, 6, NULL, 0);
    rk_run(&r);
    every_pixel_once(&r);
    rk_add(&r, &rk_ones, v, 3, NULL, 0);
    rk_run(&r);
    for (uint32_t y = 0; y < 2; y++)
        for (uint32_t x = 0; x < 16384; x++)
            assert_true(rk_px(&r, x, y, 0) ==
                        (inside(v, x * 256 + 128, y * 256 + 128) ? 1.0f
                                                                 : 0.0f));
    rk_close(&r);
}

static void bad_positions_draw_nothing(void **state)
{
    const float bad[] = { NAN, INFINITY, -INFINITY };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 9; k++) {
            /* Whichever end a coordinate fell to, it would be seen. */
            struct rk_vertex v[3] = { rk_at(W / 2, -H, 0.5f),
                                      rk_at(W, H / 2, 0.5f),
                                      rk_at(W / 2, 2 * H, 0.5f) };
            v[k / 3].p[k % 3] = bad[i];
            rk_add(&r, &rk_ones, v, 3, NULL, 0);
            rk_run(&r);
            for (uint32_t p = 0; p < W * H; p++)
                assert_true(r.out[p * 4] == 0.0f);
        }
    rk_close(&r);
}

/* ---- faces -------------------------------------------------------------- */

static void faces_are_culled_by_their_winding(void **state)
{
    /* Counter-clockwise as one sees it, y up: front. */
    struct rk_vertex v[3] = { rk_at(0, 0, 0.5f), rk_at(0, H, 0.5f),
                              rk_at(W, 0, 0.5f) };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    for (int i = 0; i < 12; i++) {
        bool turned = i & 1, mirrored = i >> 1 & 1;
        enum hl_cull cull = (enum hl_cull)(i / 4);
        bool back = turned != mirrored;
        struct rk_vertex t[3] = { v[0], v[turned ? 2 : 1], v[turned ? 1 : 2] };
        r.desc.cull = cull;
        r.desc.mirrored = mirrored;
        rk_add(&r, &rk_uv, t, 3, NULL, 0);
        rk_run(&r);
        bool drawn = cull == HL_CULL_NONE || (cull == HL_CULL_BACK) != back;
        assert_true(rk_px(&r, 10, 10, 3) == (drawn ? 1.0f : 0.0f));
        assert_true(rk_px(&r, 10, 10, 2) == (drawn && back ? 1.0f : 0.0f));
    }
    rk_close(&r);
}

/* ---- clipping and interpolation ----------------------------------------- */

/* A view with w = view depth: x right, y down, looking along z, near 1. */
static hl_buf perspective(struct rk *r, float far)
{
    struct hl_object_block o;
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = (float)H / (float)W;
    o.clip.column[1].y = 1.0f;
    o.clip.column[2].z = far / (far - 1.0f);
    o.clip.column[2].w = 1.0f;
    o.clip.column[3].z = -far / (far - 1.0f);
    o.ids.x = 7;
    return rk_buffer(r, &o, sizeof o, HL_BUF_UNIFORM);
}

/* A floor half a metre down that reaches behind the viewer: from the horizon
 * to the near plane, which lies at 3/4 of the height, all of it is seen, at
 * the depth that geometry says, and u, v are its x and z. */
static void a_floor_is_cut_at_near_and_far(void **state)
{
    struct rk_vertex v[4];
    const uint32_t indices[6] = { 0, 1, 2, 0, 2, 3 };
    const float far = 50.0f;
    const struct hl_code *stage[2] = { &rk_depths, &rk_uv };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    hl_buf view = perspective(&r, far);
    for (int i = 0; i < 4; i++) {
        v[i] = rk_at(i == 0 || i == 3 ? -1000.0f : 1000.0f, 0.5f,
                     i < 2 ? -1000.0f : 1000.0f);
        v[i].uv[0] = v[i].p[0];
        v[i].uv[1] = v[i].p[2];
    }
    for (int k = 0; k < 2; k++) {
        rk_add(&r, stage[k], v, 4, indices, 6)->uniform[HL_SLOT_OBJECT].buf =
            view;
        rk_run(&r);
        for (uint32_t y = 0; y < H; y++)
            for (uint32_t x = 0; x < W; x++) {
                /* y / w = (pixel + 0.5) 2 / H - 1 = t and y = 0.5 give w.
                 * Far, at t = 0.01, lies between the centres of rows 31
                 * and 32, at t = -+0.0156. */
                double t = ((double)y + 0.5) * 2 / H - 1;
                double w = 0.5 / t;
                double wx = (((double)x + 0.5) * 2 / W - 1) * w * W / H;
                bool seen = t > 0 && w >= 1 && w <= (double)far;
                /* Vertices cut at near and far are snapped, 1/512 pixel off
                 * at most, and t spans 1/32 a pixel: t moves by 6.1e-5, the
                 * depth w = 0.5 / t by 2 w^2 6.1e-5, and x by the same times
                 * |x / w| <= 2, plus w 3.1e-5 W / H. */
                double off = w * w * 1.3e-4;
                if (k == 1) {
                    ck_near(rk_px(&r, x, y, 3), seen ? 1 : 0, 0);
                    ck_near(rk_px(&r, x, y, 0), seen ? wx : 0,
                            2 * off + w * 6.2e-5 + 1e-4);
                    ck_near(rk_px(&r, x, y, 1), seen ? w : 0, off + 1e-4);
                } else {
                    ck_near(rk_px(&r, x, y, 0), seen ? w : 0, off + 1e-4);
                    ck_near(rk_px(&r, x, y, 3), seen ? 7 : 0, 0);
                }
            }
    }
    rk_close(&r);
}

static void what_is_behind_is_not_drawn(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    hl_buf view = perspective(&r, 50.0f);
    static const float z[4] = { -10.0f, 0.0f, 0.99f, 50.1f };
    for (int i = 0; i < 4; i++) {
        struct rk_vertex v[3] = { rk_at(-100, -100, z[i]),
                                  rk_at(100, -100, z[i]),
                                  rk_at(0, 100, z[i]) };
        rk_add(&r, &rk_ones, v, 3, NULL, 0)->uniform[HL_SLOT_OBJECT].buf =
            view;
        rk_run(&r);
        for (uint32_t p = 0; p < W * H; p++)
            assert_true(r.out[p * 4] == 0.0f);
    }
    rk_close(&r);
}

/* Slopes are what the pixels of a quad differ by. */
static void slopes_are_quad_differences(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    hl_buf view = perspective(&r, 50.0f);
    struct rk_vertex v[3] = { rk_at(-30, -20, 3), rk_at(40, -20, 9),
                              rk_at(0, 60, 20) };
    rk_add(&r, &rk_depths, v, 3, NULL, 0)->uniform[HL_SLOT_OBJECT].buf = view;
    rk_run(&r);
    uint32_t n = 0;
    for (uint32_t y = 0; y < H; y += 2)
        for (uint32_t x = 0; x < W; x += 2) {
            if (rk_px(&r, x, y, 0) == 0 || rk_px(&r, x + 1, y, 0) == 0 ||
                rk_px(&r, x, y + 1, 0) == 0)
                continue;
            float z = rk_px(&r, x, y, 0);
            /* Three roundings of 1 / w below 1 and an inversion: 4 ulp of z
             * each side. */
            double off = 8 * (double)z * 1.2e-7;
            float dx = rk_px(&r, x + 1, y, 0) - z;
            float dy = rk_px(&r, x, y + 1, 0) - z;
            ck_near(rk_px(&r, x, y, 1), (double)dx, off);
            ck_near(rk_px(&r, x + 1, y, 1), (double)dx, off);
            ck_near(rk_px(&r, x, y, 2), (double)dy, off);
            ck_near(rk_px(&r, x, y + 1, 2), (double)dy, off);
            n++;
        }
    assert_true(n > 500);
    rk_close(&r);
}

static void shade_duv(const struct pe_draw *d, struct hl_pe_fragments *f)
{
    (void)d;
    for (uint32_t i = 0; i < f->n; i++)
        for (int c = 0; c < 4; c++)
            f->color[0][c][i] = f->duv[c][i];
}

static void uv_slopes_are_quad_differences(void **state)
{
    static const struct hl_pe_stage stage = { .shade = shade_duv,
                                              .uv_slope = true };
    static const struct hl_code duv = {
        .kernel = (void (*)(void))(uintptr_t)&stage
    };
    static float uv[W * H * 4];
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    hl_buf view = perspective(&r, 50.0f);
    struct rk_vertex v[3] = { rk_at(-60, -40, 3), rk_at(80, -40, 9),
                              rk_at(0, 120, 20) };
    v[0].uv[0] = v[1].uv[1] = 1;
    v[2].uv[0] = v[2].uv[1] = 3;
    for (int k = 0; k < 2; k++) {
        rk_add(&r, k ? &duv : &rk_uv, v, 3, NULL, 0)
            ->uniform[HL_SLOT_OBJECT].buf = view;
        rk_run(&r);
        if (k == 0)
            memcpy(uv, r.out, sizeof uv);
    }
    uint32_t n = 0;
    for (uint32_t y = 0; y < H; y++)
        for (uint32_t x = 0; x < W; x++) {
            const float *here = &uv[(y / 2 * 2 * W + x / 2 * 2) * 4];
            const float *right = here + 4, *down = here + W * 4;
            const float *at = &uv[(y * W + x) * 4];
            if (here[3] == 0 || right[3] == 0 || down[3] == 0 ||
                here[3 + 4 * W + 4] == 0)
                continue;
            /* The row's and the column's own neighbours. */
            uint32_t ox = x ^ 1, oy = y ^ 1;
            const float *nx = &uv[(y * W + ox) * 4];
            const float *ny = &uv[(oy * W + x) * 4];
            for (uint32_t c = 0; c < 2; c++) {
                float dx = x & 1 ? at[c] - nx[c] : nx[c] - at[c];
                float dy = y & 1 ? at[c] - ny[c] : ny[c] - at[c];
                /* Four roundings each of values below 4. */
                ck_near(rk_px(&r, x, y, c), (double)dx, 8 * 4 * 6e-8);
                ck_near(rk_px(&r, x, y, 2 + c), (double)dy, 8 * 4 * 6e-8);
            }
            n++;
        }
    assert_true(n > 500);
    rk_close(&r);
}

static void the_first_vertex_gives_the_id(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    for (int i = 0; i < 6; i++) {
        struct rk_vertex v[3] = { rk_at(0, 0, 0.5f), rk_at(W, 0, 0.5f),
                                  rk_at(0, H, i < 3 ? 0.5f : 3.0f) };
        struct rk_vertex t[3];
        for (int k = 0; k < 3; k++) {
            v[k].tangent[3] = (float)(1 + 10 * (k + 1));    /* the group     */
            t[k] = v[0];
        }
        for (int k = 0; k < 3; k++)
            t[k] = v[(k + i) % 3];
        rk_add(&r, &rk_depths, t, 3, NULL, 0);
        rk_run(&r);
        float want = (float)(10 * (i % 3 + 1));
        ck_near(rk_px(&r, 5, 5, 3), (double)want, 0);
    }
    rk_close(&r);
}

/* ---- lines -------------------------------------------------------------- */

/* A closed polygon of lines hits no pixel of a joint twice, and each line as
 * many pixels as its longer axis has centres. */
static void lines_hit_one_pixel_a_column(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    r.desc.topology = HL_TOPOLOGY_LINES;
    static const float at[5][2] = { { 10, 10 }, { 100.25f, 20 }, { 90, 50.5f },
                                    { 30, 60 }, { 10, 10 } };
    for (int i = 0; i < 4; i++) {
        struct rk_vertex v[2] = { rk_at(at[i][0], at[i][1], 0.5f),
                                  rk_at(at[i + 1][0], at[i + 1][1], 0.5f) };
        rk_add(&r, &rk_ones, v, 2, NULL, 0);
        rk_run(&r);
        double dx = (double)(at[i + 1][0] - at[i][0]);
        double dy = (double)(at[i + 1][1] - at[i][1]), hits = 0;
        bool steep = fabs(dy) > fabs(dx);
        for (uint32_t y = 0; y < H; y++)
            for (uint32_t x = 0; x < W; x++) {
                double n = (double)rk_px(&r, x, y, 0);
                hits += n;
                if (n == 0)
                    continue;
                /* Within half a pixel of the line along the other axis. */
                double px = x + 0.5 - (double)at[i][0];
                double py = y + 0.5 - (double)at[i][1];
                ck_near(steep ? px : py, steep ? py * dx / dy : px * dy / dx,
                        0.5);
            }
        double low = steep ? fmin((double)at[i][1], (double)at[i + 1][1])
                           : fmin((double)at[i][0], (double)at[i + 1][0]);
        double high = low + fmax(fabs(dx), fabs(dy));
        /* Centres from the start on, the end excluded. */
        bool forward = steep ? dy > 0 : dx > 0;
        ck_near(hits, forward ? ceil(high - 0.5) - ceil(low - 0.5)
                              : floor(high + 0.5) - floor(low + 0.5), 0);
    }
    rk_close(&r);
}

static void lines_are_cut(void **state)
{
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    r.desc.topology = HL_TOPOLOGY_LINES;
    /* Depth leaves 0..1 half way; x leaves the guard band. */
    struct rk_vertex v[4] = { rk_at(0, 10.5f, 0), rk_at(W, 10.5f, 2),
                              rk_at(-1e6f, 20.5f, 0.5f),
                              rk_at(1e6f, 20.5f, 0.5f) };
    rk_add(&r, &rk_ones, v, 4, NULL, 0);
    rk_run(&r);
    for (uint32_t x = 0; x < W; x++) {
        ck_near(rk_px(&r, x, 10, 0), x < W / 2 ? 1 : 0, 0);
        ck_near(rk_px(&r, x, 20, 0), 1, 0);
    }
    rk_close(&r);
}

/* ---- vertices ----------------------------------------------------------- */

/* One format as the colour of all vertices; what is absent is 0 0 0 1. */
static void attributes_are_decoded(void **state)
{
    static const uint8_t u8[4] = { 0, 51, 255, 128 };
    static const int8_t s8[4] = { -128, -127, 127, 64 };
    static const int16_t s16[4] = { -32768, 32767, 16384, -1 };
    static const uint16_t u16[2] = { 65535, 256 };
    static const uint16_t f16[4] = { 0x3c00, 0xc500, 0x0001, 0x7bff };
    static const float f32[4] = { 0.1f, -2, 3e5f, 1e-30f };
    static const struct {
        enum hl_attr_format format;
        const void *data;
        float want[4];
    } row[] = {
        { HL_ATTR_NONE, f32, { 0, 0, 0, 1 } },
        { HL_ATTR_F32X1, f32, { 0.1f, 0, 0, 1 } },
        { HL_ATTR_F32X2, f32, { 0.1f, -2, 0, 1 } },
        { HL_ATTR_F32X3, f32, { 0.1f, -2, 3e5f, 1 } },
        { HL_ATTR_F32X4, f32, { 0.1f, -2, 3e5f, 1e-30f } },
        { HL_ATTR_U8X4_UNORM, u8, { 0, 0.2f, 1, 128 / 255.0f } },
        { HL_ATTR_S8X4_SNORM, s8, { -1, -1, 1, 64 / 127.0f } },
        { HL_ATTR_S16X4_SNORM, s16, { -1, 1, 16384 / 32767.0f,
                                      -1 / 32767.0f } },
        { HL_ATTR_U16X2_UNORM, u16, { 1, 256 / 65535.0f, 0, 1 } },
        { HL_ATTR_F16X2, f16, { 1, -5, 0, 1 } },
        { HL_ATTR_F16X4, f16, { 1, -5, 0x1p-24f, 65504 } },
    };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    r.desc.blend = HL_BLEND_OFF;
    struct rk_vertex v[3] = { rk_at(0, 0, 0.5f), rk_at(W, 0, 0.5f),
                              rk_at(0, H, 0.5f) };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        /* The same 16 bytes at the end of each 17. */
        uint8_t data[3 * 17] = { 0 };
        size_t size = row[i].data == f32 ? 16 : row[i].data == u8 ||
                      row[i].data == s8 || row[i].data == u16 ? 4 : 8;
        for (int k = 0; k < 3; k++)
            memcpy(data + 17 * k + 1, row[i].data, size);
        r.desc.layout.attr[HL_ATTR_COLOR] =
            (struct hl_attr){ row[i].format, 1, 1 };
        r.desc.layout.stride[1] = 17;
        rk_add(&r, &rk_color, v, 3, NULL, 0)->vertex[1] =
            rk_buffer(&r, data, sizeof data, HL_BUF_VERTEX);
        rk_run(&r);
        for (uint32_t c = 0; c < 4; c++)
            ck_near(rk_px(&r, 3, 3, c), (double)row[i].want[c], 0);
    }
    rk_close(&r);
}

/* 300 small squares, by 32 and by 16 bits, and with a base. */
static void indices_of_all_kinds_draw_the_same(void **state)
{
    enum { N = 300 };
    static struct rk_vertex v[4 * N + 8];
    static uint32_t wide[6 * N];
    static uint16_t narrow[6 * N];
    static float first[W * H * 4];
    uint64_t seed = mk_seed();
    struct rk r;
    (void)state;
    for (uint32_t i = 0; i < N; i++) {
        /* Neighbours in the buffer are not neighbours in use. */
        uint32_t at = (i * 77 % N) * 4, q[6] = { 0, 1, 2, 2, 1, 3 };
        float x = coordinate(&seed, 0, W, 4), y = coordinate(&seed, 0, H, 4);
        for (uint32_t k = 0; k < 4; k++)
            v[8 + at + k] = rk_at(x + (k & 1 ? 3 : 0), y + (k & 2 ? 3 : 0),
                                  0.5f);
        for (uint32_t k = 0; k < 6; k++) {
            wide[6 * i + k] = 8 + at + q[k];
            narrow[6 * i + k] = (uint16_t)(at + q[k]);
        }
    }
    rk_open(&r, 1, W, H, 1);
    rk_add(&r, &rk_ones, v, 4 * N + 8, wide, 6 * N);
    rk_run(&r);
    memcpy(first, r.out, sizeof first);
    struct hl_draw *d = rk_add(&r, &rk_ones, v, 4 * N + 8, wide, 6 * N);
    d->index = rk_buffer(&r, narrow, sizeof narrow, HL_BUF_INDEX);
    d->index16 = true;
    d->base_vertex = 8;
    rk_run(&r);
    assert_memory_equal(first, r.out, sizeof first);
    d = rk_add(&r, &rk_ones, v, 4 * N + 8, wide, 6 * N);
    d->instances = 3;
    rk_run(&r);
    for (uint32_t i = 0; i < W * H * 4; i++)
        assert_true(r.out[i] == 3 * first[i]);
    rk_close(&r);
}

/* Indices past all buffers: nothing is read outside (a sanitizer sees to
 * it), and draws after it are right. */
static void wild_indices_are_harmless(void **state)
{
    static const int32_t bases[] = { 0, -5, 0x7fffffff, -0x7fffffff - 1 };
    struct rk_vertex v[3] = { rk_at(0, 0, 0.5f), rk_at(2 * W, 0, 0.5f),
                              rk_at(0, 2 * H, 0.5f) };
    const uint32_t indices[9] = { 0, 1, 2, 3, 0xffffffffu, 1, 70000, 0, 2 };
    struct rk r;
    (void)state;
    rk_open(&r, 1, W, H, 1);
    for (int i = 0; i < 4; i++) {
        rk_add(&r, &rk_ones, v, 3, indices, 9)->base_vertex = bases[i];
        rk_run(&r);
    }
    struct hl_draw *d = rk_add(&r, &rk_ones, v, 3, NULL, 0);
    d->first = 0xfffffff0u;
    rk_run(&r);
    /* A buffer too short for one vertex: zeros, which is no area. */
    d = rk_add(&r, &rk_ones, v, 3, NULL, 0);
    d->vertex[0] = rk_buffer(&r, v, 8, HL_BUF_VERTEX);
    rk_run(&r);
    rk_add(&r, &rk_ones, v, 3, NULL, 0);
    rk_run(&r);
    every_pixel_once(&r);
    rk_close(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_cover_by_the_rule),
        cmocka_unit_test(a_grid_covers_every_pixel_once),
        cmocka_unit_test(fans_cover_every_pixel_once),
        cmocka_unit_test(large_targets_are_covered_to_their_ends),
        cmocka_unit_test(bad_positions_draw_nothing),
        cmocka_unit_test(faces_are_culled_by_their_winding),
        cmocka_unit_test(a_floor_is_cut_at_near_and_far),
        cmocka_unit_test(what_is_behind_is_not_drawn),
        cmocka_unit_test(slopes_are_quad_differences),
        cmocka_unit_test(uv_slopes_are_quad_differences),
        cmocka_unit_test(the_first_vertex_gives_the_id),
        cmocka_unit_test(lines_hit_one_pixel_a_column),
        cmocka_unit_test(lines_are_cut),
        cmocka_unit_test(attributes_are_decoded),
        cmocka_unit_test(indices_of_all_kinds_draw_the_same),
        cmocka_unit_test(wild_indices_are_harmless),
    };
    return cmocka_run_group_tests_name("packemu rasteriser", tests, NULL,
                                       NULL);
}
