/* SPDX-License-Identifier: Zlib */
/* Tile lists against brute force: for every texel of a made-up depth buffer,
 * each light that reaches its surface is in the list of its tile. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/light.h"
#include "tests/check.h"

enum { W = 150, H = 83, LIGHTS = 120, MAX_TILES = 19 * 11 };

struct world {
    struct hl_camera cam;
    struct hl_light light[LIGHTS];
    struct hl_lit_sphere sphere[LIGHTS];
    uint32_t n_spheres;
    float z[W * H];              /* metres; 0: background                    */
    float d[W * H];              /* as a depth buffer holds it               */
    float z0[MAX_TILES], z1[MAX_TILES];
    struct hl_tile_grid grid;
    uint32_t first[MAX_TILES + 1];
    uint32_t refs[MAX_TILES * LIGHTS];
    float a, b, clear;           /* z = a / (d + b)                          */
};

/* Floors, walls and holes: depth is a few random planes, the nearest wins. */
static void make_depth(struct world *w, uint64_t *seed, bool reversed)
{
    double n = (double)w->cam.near, f = (double)w->cam.far;
    double plane[6][3];
    for (int i = 0; i < 6; i++) {
        plane[i][0] = ck_between(seed, 2, 40);
        plane[i][1] = ck_between(seed, -3, 3);
        plane[i][2] = ck_between(seed, -3, 3);
    }
    w->a = (float)(reversed ? n * f / (f - n) : -n * f / (f - n));
    w->b = (float)(reversed ? n / (f - n) : -f / (f - n));
    w->clear = reversed ? 0.0f : 1.0f;
    for (int i = 0; i < W * H; i++) {
        double s = (i % W + 0.5) / W * 2 - 1, t = 1 - (i / W + 0.5) / H * 2;
        double z = f;
        for (int k = 0; k < 6; k++) {
            double x = plane[k][0] / (1 + plane[k][1] * s + plane[k][2] * t);
            if (x > n && x < z)
                z = x;
        }
        bool hole = z >= f || (s * s + t * t < 0.05);
        w->z[i] = hole ? 0 : (float)z;
        /* Stored as a rasteriser would: rounded to float. */
        w->d[i] = hole ? w->clear : (float)((double)w->a / z - (double)w->b);
    }
}

static void make_world(struct world *w, uint64_t *seed, uint32_t tile,
                       bool reversed)
{
    memset(w, 0, sizeof *w);
    w->cam.tan_half_y = 0.6f;
    w->cam.near = 0.1f;
    w->cam.far = 60;
    for (int i = 0; i < 16; i += 5)
        w->cam.view[i] = 1;
    for (int i = 0; i < LIGHTS; i++) {
        struct hl_light *l = &w->light[i];
        float z = (float)ck_between(seed, -2, 50);
        l->position[0] = (float)ck_between(seed, -1, 1) * (z + 3);
        l->position[1] = (float)ck_between(seed, -1, 1) * (z + 3);
        l->position[2] = -z;
        l->radius = (float)exp(ck_between(seed, -1, 2));
        l->color[i % 3] = (float)ck_between(seed, 0.1, 2);
    }
    w->light[7].kind = HL_DIRECTIONAL;
    w->light[7].direction[1] = -1;
    /* Sees more than the picture, as jitter of 4 texels asks. */
    struct hl_camera wide = w->cam;
    wide.tan_half_y *= 1.0f + 8.0f / H;
    w->n_spheres = hl_lights_view(w->sphere, w->light, LIGHTS, &wide,
                                  (float)W / H);
    make_depth(w, seed, reversed);
    struct hl_tile_grid *g = &w->grid;
    g->span = hl_span_whole(W, H, &w->cam, (float)W / H);
    if (reversed) {              /* more than jitter does, to show           */
        g->span.jx = (float)ck_between(seed, -4, 4);
        g->span.jy = (float)ck_between(seed, -4, 4);
    }
    g->tile = tile;
    g->nx = (W + tile - 1) / tile;
    g->ny = (H + tile - 1) / tile;
    assert_true(g->nx * g->ny <= MAX_TILES);
    hl_tiles_depth(w->z0, w->z1, g, w->d, W, w->a, w->b, w->clear);
}

static uint32_t fill(struct world *w, bool with_depth)
{
    w->grid.z0 = with_depth ? w->z0 : NULL;
    w->grid.z1 = with_depth ? w->z1 : NULL;
    uint32_t n = hl_tiles_fill(&w->grid, w->sphere, w->n_spheres, w->first,
                               w->refs, MAX_TILES * LIGHTS);
    assert_true(n <= MAX_TILES * LIGHTS);
    assert_int_equal(w->first[0], 0);
    assert_int_equal(w->first[w->grid.nx * w->grid.ny], n);
    return n;
}

static bool listed(const struct world *w, uint32_t tile, uint32_t sphere)
{
    for (uint32_t i = w->first[tile]; i < w->first[tile + 1]; i++)
        if (w->refs[i] == sphere)
            return true;
    return false;
}

static uint32_t tile_of(const struct world *w, int texel)
{
    uint32_t x = (uint32_t)(texel % W), y = (uint32_t)(texel / W);
    return y / w->grid.tile * w->grid.nx + x / w->grid.tile;
}

/* Does light `l` reach the surface at `texel`? */
static bool reaches(const struct world *w, int texel, const struct hl_light *l)
{
    double ty = (double)w->cam.tan_half_y, tx = ty * W / H;
    double z = (double)w->z[texel];
    double u = texel % W + 0.5 - (double)w->grid.span.jx;
    double v = texel / W + 0.5 - (double)w->grid.span.jy;
    double p[3] = { (u / W * 2 - 1) * tx * z, (1 - v / H * 2) * ty * z, -z };
    double d2 = 0, r = (double)l->radius;
    for (int k = 0; k < 3; k++)
        d2 += (p[k] - (double)l->position[k]) * (p[k] - (double)l->position[k]);
    return l->kind == HL_DIRECTIONAL || d2 < r * r;
}

/* Returns how many (tile, light) pairs are needed. */
static uint32_t check_lists(const struct world *w)
{
    static uint8_t needed[MAX_TILES][LIGHTS];
    uint32_t n = 0;
    memset(needed, 0, sizeof needed);
    for (int i = 0; i < W * H; i++)
        for (uint32_t s = 0; s < w->n_spheres && w->z[i] > 0; s++) {
            uint32_t t = tile_of(w, i);
            if (needed[t][s] || !reaches(w, i, &w->light[w->sphere[s].light]))
                continue;
            needed[t][s] = 1;
            n++;
            if (!listed(w, t, s))
                fail_msg("light %u reaches texel %d, %d of tile %u and is not"
                         " in its list", w->sphere[s].light, i % W, i / W, t);
        }
    return n;
}

static void no_reaching_light_is_missing(void **state)
{
    (void)state;
    static const uint32_t tiles[] = { 8, 13, 32, 64, 256 };
    uint64_t seed = mk_seed();
    struct world *w = malloc(sizeof *w);
    assert_non_null(w);
    uint32_t sum_deep = 0, sum_needed = 0;
    for (uint32_t i = 0; i < 200; i++) {
        make_world(w, &seed, tiles[i % 5], i & 1);
        uint32_t deep = fill(w, true);
        uint32_t needed = check_lists(w);
        uint32_t flat = fill(w, false);
        /* Depth bounds may only shorten lists. */
        assert_int_equal(check_lists(w), needed);
        assert_true(deep <= flat);
        if (w->grid.tile > 32)
            continue;
        sum_deep += deep;
        sum_needed += needed;
    }
    /* A tile's box is larger than its surface, but not by much. */
    print_message("%u entries where %u are needed\n", sum_deep, sum_needed);
    assert_true(sum_deep < sum_needed + sum_needed / 2);
    free(w);
}

static void lists_are_in_order_without_doubles(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct world *w = malloc(sizeof *w);
    assert_non_null(w);
    make_world(w, &seed, 16, true);
    fill(w, true);
    for (uint32_t t = 0; t < w->grid.nx * w->grid.ny; t++)
        for (uint32_t i = w->first[t]; i < w->first[t + 1]; i++) {
            assert_true(w->refs[i] < w->n_spheres);
            if (i > w->first[t])
                assert_true(w->refs[i - 1] < w->refs[i]);
        }
    free(w);
}

static void lists_that_do_not_fit_are_counted_not_written(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct world *w = malloc(sizeof *w);
    assert_non_null(w);
    make_world(w, &seed, 16, true);
    uint32_t n = fill(w, true);
    memset(w->refs, 0xEE, sizeof w->refs);
    for (uint32_t room = 0; room < n; room += 1 + n / 13) {
        assert_int_equal(hl_tiles_fill(&w->grid, w->sphere, w->n_spheres,
                                       w->first, w->refs, room), n);
        for (uint32_t i = 0; i < n; i++)
            assert_int_equal(w->refs[i], 0xEEEEEEEE);
    }
    assert_int_equal(hl_tiles_fill(&w->grid, w->sphere, w->n_spheres,
                                   w->first, w->refs, n), n);
    assert_int_equal(w->refs[n], 0xEEEEEEEE);
    assert_int_equal(hl_tiles_fill(&w->grid, NULL, 0, w->first, NULL, 0), 0);
    free(w);
}

/* Depths are rounded to float (2^-24 of 1, near 1 in the usual convention:
 * an error of z^2 / near 2^-24) and widened by 1e-5. */
static void tile_depths_enclose_the_surface(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct world *w = malloc(sizeof *w);
    assert_non_null(w);
    for (uint32_t i = 0; i < 6; i++) {
        float lo[MAX_TILES], hi[MAX_TILES];
        bool empty[MAX_TILES];
        make_world(w, &seed, i < 3 ? 8 : 27, i & 1);
        uint32_t tiles = w->grid.nx * w->grid.ny;
        for (uint32_t t = 0; t < tiles; t++) {
            lo[t] = 1e9f;
            hi[t] = 0;
            empty[t] = true;
        }
        for (int k = 0; k < W * H; k++) {
            uint32_t t = tile_of(w, k);
            float z = w->z[k];
            if (z <= 0)
                continue;
            empty[t] = false;
            lo[t] = z < lo[t] ? z : lo[t];
            hi[t] = z > hi[t] ? z : hi[t];
        }
        uint32_t n_empty = 0;
        for (uint32_t t = 0; t < tiles; t++) {
            n_empty += empty[t];
            assert_true(empty[t] == (w->z0[t] > w->z1[t]));
            if (empty[t])
                continue;
            double e0 = 1.5e-5 * (double)lo[t], e1 = 1.5e-5 * (double)hi[t];
            if (!(i & 1)) {
                e0 += (double)lo[t] * (double)lo[t] * 10 * 6e-8;
                e1 += (double)hi[t] * (double)hi[t] * 10 * 6e-8;
            }
            ck_near((double)w->z0[t], (double)lo[t], e0);
            ck_near((double)w->z1[t], (double)hi[t], e1);
        }
        assert_true(n_empty > 0 || i >= 3);
    }
    free(w);
}

/* The bound holds at every texel: all colours at full strength there. */
static void the_peak_bounds_every_texel(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct world *w = malloc(sizeof *w);
    assert_non_null(w);
    make_world(w, &seed, 16, true);
    fill(w, true);
    float peak = hl_tiles_peak(&w->grid, w->first, w->refs, w->sphere,
                               w->light);
    double most = 0;
    for (int i = 0; i < W * H; i++) {
        double sum[3] = { 0, 0, 0 };
        for (int k = 0; k < LIGHTS && w->z[i] > 0; k++)
            for (int c = 0; c < 3 && reaches(w, i, &w->light[k]); c++)
                sum[c] += (double)w->light[k].color[c];
        for (int c = 0; c < 3; c++)
            most = sum[c] > most ? sum[c] : most;
    }
    assert_true((double)peak >= most * 0.999999);
    assert_true((double)peak < most * 10);
    /* Inverse square grows to 1e4 at a centimetre. */
    w->light[0] = w->light[7];
    struct hl_lit_sphere one = w->sphere[0];
    uint32_t first[2] = { 0, 1 }, ref = 0;
    struct hl_tile_grid g = { .nx = 1, .ny = 1 };
    one.light = 0;
    memset(w->light, 0, sizeof *w->light);
    w->light[0].color[1] = 2;
    ck_near((double)hl_tiles_peak(&g, first, &ref, &one, w->light), 2, 0);
    w->light[0].falloff = HL_INVERSE_SQUARE;
    ck_near((double)hl_tiles_peak(&g, first, &ref, &one, w->light), 2e4, 0);
    free(w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_reaching_light_is_missing),
        cmocka_unit_test(lists_are_in_order_without_doubles),
        cmocka_unit_test(lists_that_do_not_fit_are_counted_not_written),
        cmocka_unit_test(tile_depths_enclose_the_surface),
        cmocka_unit_test(the_peak_bounds_every_texel),
    };
    return cmocka_run_group_tests_name("tiles", tests, NULL, NULL);
}
