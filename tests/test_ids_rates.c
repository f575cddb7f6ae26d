/* SPDX-License-Identifier: Zlib */
/* How often region ids collide: the paper's, by theory and by measurement,
 * against unique and coloured ones on the same scenes and meshes; and the
 * boxes from which a scene's meetings are found. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "core/ids.h"
#include "tests/mesh_kit.h"

/* Largest number that a sum of n events of probability p, each two of them
 * independent (or excluding each other more than that), reaches: the variance
 * is then n p (1 - p) at most, whatever hangs together in threes, and 5
 * deviations are passed with a probability below 1 / 25 by Chebyshev, below
 * 1e-6 where the sum is near normal. Seeds are fixed, so a test that passed
 * goes on passing. */
static double most(double n, double p)
{
    return n * p + 5 * sqrt(n * p * (1 - p));
}

static double least(double n, double p)
{
    return n * p - 5 * sqrt(n * p * (1 - p));
}

/* ---- boxes ----------------------------------------------------------- */

enum { MAX_BOXES = 1000, MAX_PAIRS = 500000 };

static bool near(const struct hl_ids_box *a, const struct hl_ids_box *b,
                 double margin)
{
    for (int i = 0; i < 3; i++)
        if (a->min[i] > a->max[i] || b->min[i] > b->max[i] ||
            (double)a->min[i] - (double)b->max[i] > margin ||
            (double)b->min[i] - (double)a->max[i] > margin)
            return false;
    return true;
}

static struct hl_ids_box random_box(uint64_t *random, const float size[3])
{
    struct hl_ids_box box;
    for (int i = 0; i < 3; i++) {
        float at = mk_unit(random) - 0.5f;
        box.min[i] = at * size[i];
        box.max[i] = box.min[i] + 0.5f * mk_unit(random);
        if (mk_below(random, 40) == 0)
            box.max[i] = box.min[i] - 0.01f; /* empty */
        if (mk_below(random, 40) == 0)
            box.max[i] = box.min[i] = -0.0f;
    }
    return box;
}

static void overlaps_match_every_pair(void **state)
{
    static const float size[3][3] = {{3, 1, 1}, {1, 3, 1}, {0, 1, 3}};
    static const float margins[3] = {0, 0.1f, 0.3f};
    static struct hl_ids_box box[200];
    static uint32_t pairs[2 * 200 * 199];
    static bool want[200][200];
    struct mk_fixture *f = *state;
    uint64_t random = mk_seed();
    for (int i = 0; i < 9; i++) {
        uint64_t n = 0, n_want = 0;
        for (int k = 0; k < 200; k++)
            box[k] = random_box(&random, size[i / 3]);
        for (int a = 0; a < 200; a++)
            for (int b = a + 1; b < 200; b++) {
                want[a][b] = near(&box[a], &box[b], (double)margins[i % 3]);
                n_want += want[a][b];
            }
        assert_int_equal(hl_ids_overlaps(&f->hooks, box, 200, margins[i % 3],
                                         200 * 199, pairs, &n), HL_OK);
        assert_int_equal(n, n_want);
        assert_true(n > 100);
        for (uint64_t k = 0; k < n; k++) {
            bool *w = &want[pairs[2 * k]][pairs[2 * k + 1]];
            assert_true(pairs[2 * k] < pairs[2 * k + 1] && *w);
            *w = false; /* each once */
        }
        assert_int_equal(hl_ids_overlaps(&f->hooks, box, 200, margins[i % 3],
                                         (uint32_t)n_want - 1, pairs, &n),
                         HL_ERR_LIMIT);
        assert_int_equal(n, n_want);
    }
}

static void overlaps_check_their_arguments(void **state)
{
    static const uint32_t nan_bits = 0x7FC00000u, inf_bits = 0x7F800000u;
    struct mk_fixture *f = *state;
    struct hl_hooks none = {NULL, NULL, NULL};
    struct hl_ids_box box[3] = {{{0, 0, 0}, {1, 1, 1}},
                                {{2, 2, 2}, {3, 3, 3}},
                                {{0, 0, 0}, {1, 1, 1}}};
    uint32_t pairs[6];
    uint64_t n = 99;
    float nan, inf;
    memcpy(&nan, &nan_bits, sizeof nan);
    memcpy(&inf, &inf_bits, sizeof inf);
    assert_int_equal(hl_ids_overlaps(&none, box, 3, 0, 3, pairs, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_overlaps(&f->hooks, NULL, 3, 0, 3, pairs, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, NULL, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, pairs, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, -1, 3, pairs, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, nan, 3, pairs, &n),
                     HL_ERR_INVALID);
    box[1].max[2] = nan;
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, pairs, &n),
                     HL_ERR_INVALID);
    box[1].max[2] = inf;
    box[1].min[0] = nan;
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, pairs, &n),
                     HL_ERR_INVALID);
    for (int i = 0; i < 3; i++) /* all of space meets all */
        box[1].min[i] = -inf, box[1].max[i] = inf;
    f->memory.fail_at = 1;
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, pairs, &n),
                     HL_ERR_MEMORY);
    f->memory.fail_at = 0;
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 3, pairs, &n),
                     HL_OK);
    assert_int_equal(n, 3);
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, 3, 0, 0, NULL, &n),
                     HL_ERR_LIMIT); /* just counts */
    assert_int_equal(n, 3);
    assert_int_equal(hl_ids_overlaps(&f->hooks, NULL, 0, 0, 0, NULL, &n),
                     HL_OK);
    assert_int_equal(n, 0);
}

/* Rows along each axis, of a size that quadratic work would not finish. */
static void long_rows_finish(void **state)
{
    enum { N = 200000 };
    struct mk_fixture *f = *state;
    struct hl_ids_box *box = calloc(N, sizeof *box);
    uint64_t n = 0;
    assert_non_null(box);
    for (int axis = 0; axis < 3; axis++) {
        memset(box, 0, N * sizeof *box);
        for (uint32_t i = 0; i < N; i++) {
            box[i].min[axis] = (float)(N - i);
            box[i].max[axis] = (float)(N - i) + 0.5f;
        }
        assert_int_equal(hl_ids_overlaps(&f->hooks, box, N, 0.5f, 0, NULL, &n),
                         HL_ERR_LIMIT);
        assert_int_equal(n, N - 1); /* each with the next */
    }
    free(box);
}

/* ---- the paper's ids ------------------------------------------------- */

/* Chi-squared of 256 bins has mean 255 and variance 510. */
static void random_bytes_are_even(void **state)
{
    uint64_t seed = mk_seed();
    uint32_t count[256] = {0}, same = 0;
    double chi = 0;
    (void)state;
    for (uint32_t i = 0; i < 65536; i++) {
        count[hl_ids_random8(seed, i)]++;
        same += hl_ids_random8(seed, i) == hl_ids_random8(seed, i + 1);
    }
    for (int i = 0; i < 256; i++)
        chi += (count[i] - 256.0) * (count[i] - 256.0) / 256;
    assert_true(fabs(chi - 255) < 5 * sqrt(510));
    assert_true(same < most(65536, 1 / 256.0));
    assert_true(same > least(65536, 1 / 256.0));
    same = 0;
    for (uint32_t i = 0; i < 65536; i++)
        same += hl_ids_random8(seed, i) == hl_ids_random8(seed + 1, i);
    assert_true(same < most(65536, 1 / 256.0));
    assert_int_equal(hl_ids_random8(0, 0), 0x02); /* the same everywhere */
    assert_int_equal(hl_ids_random8(1, 2009), 0x54);
    assert_int_equal(hl_ids_random8(UINT64_MAX, UINT32_MAX), 0x7B);
}

/* Two regions share an id only when object and group are both the same, but
 * for the two codes that are not used. */
static void paper_regions_differ_by_either_half(void **state)
{
    static uint8_t seen[65536];
    (void)state;
    for (uint32_t o = 0; o < 256; o++)
        for (uint32_t g = 0; g < 256; g++) {
            uint32_t id = hl_ids_paper_region((uint8_t)o, (uint8_t)g);
            assert_in_range(id, 1, 65534);
            seen[id]++;
        }
    for (uint32_t id = 2; id < 65534; id++)
        assert_int_equal(seen[id], 1);
    assert_int_equal(seen[1], 2);
    assert_int_equal(seen[65534], 2);
}

/* Exactly: all pairs of n numbers, by index & 255. */
static void sequence_shares_as_computed(void **state)
{
    static const struct { uint32_t n, pairs; double percent; } row[] = {
        {101, 0, 0}, {256, 0, 0}, {287, 31, 0.0755}, {1000, 1464, 0.293}};
    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        uint32_t same = 0, n = row[i].n;
        for (uint32_t a = 0; a < n; a++)
            for (uint32_t b = 0; b < a; b++)
                same += (a & 255) == (b & 255);
        assert_int_equal(same, row[i].pairs);
        assert_true(fabs(200.0 * same / n / (n - 1) - row[i].percent) < 5e-4);
    }
}

/* n discs at random on an 800 x 450 screen; discs nearer than the filter's
 * reach of 2 texels are neighbours. Discs shrink as there are more. */
static uint32_t make_discs(struct mk_fixture *f, uint32_t n, uint32_t *pairs,
                           uint64_t *random)
{
    static struct hl_ids_box box[MAX_BOXES];
    uint64_t n_pairs = 0;
    float radius = 400 / sqrtf((float)n);
    for (uint32_t i = 0; i < n; i++) {
        float at[3] = {800 * mk_unit(random), 0, 0};
        at[1] = 450 * mk_unit(random);
        for (int k = 0; k < 3; k++) {
            box[i].min[k] = at[k] - (k < 2 ? radius : 0);
            box[i].max[k] = at[k] + (k < 2 ? radius : 0);
        }
    }
    assert_int_equal(hl_ids_overlaps(&f->hooks, box, n, 2, MAX_PAIRS, pairs,
                                     &n_pairs), HL_OK);
    return (uint32_t)n_pairs;
}

struct rates { uint32_t pairs, random, sequence, coloured, most_colors; };

static struct rates measure(struct mk_fixture *f, uint32_t n,
                            uint64_t *random, uint32_t *pairs)
{
    uint32_t ids[MAX_BOXES];
    struct rates r = {0, 0, 0, 0, 0};
    for (uint64_t scene = 0; scene < 40; scene++) {
        struct hl_ids_coloring c;
        uint64_t seed = (uint64_t)mk_random(random) << 32 | scene;
        uint32_t m = make_discs(f, n, pairs, random);
        r.pairs += m;
        for (uint32_t i = 0; i < n; i++)
            ids[i] = hl_ids_random8(seed, i);
        r.random += hl_ids_count_shared(pairs, m, ids);
        for (uint32_t i = 0; i < n; i++)
            ids[i] = i & 255;
        r.sequence += hl_ids_count_shared(pairs, m, ids);
        assert_int_equal(hl_ids_color(&f->hooks, n, pairs, m, 254,
                                      ids, &c), HL_OK);
        assert_int_equal(c.n_conflicts, 0);
        r.coloured += hl_ids_count_shared(pairs, m, ids);
        r.most_colors =
            c.n_colors > r.most_colors ? c.n_colors : r.most_colors;
    }
    return r;
}

/* Random: any two different pairs of a graph collide independently, also when
 * they have a node in common, so that the variance is exact. Sequence: discs'
 * places do not depend on their numbers, so that a pair is any two numbers;
 * two pairs that collide leave fewer of the residue for each other. */
static void scenes_collide_as_computed(void **state)
{
    static const uint32_t count[4] = {20, 101, 287, 1000};
    static const double share[4] = {0, 0, 31 / 41041.0, 1464 / 499500.0};
    struct mk_fixture *f = *state;
    uint64_t random = mk_seed() + 9;
    uint32_t *pairs = malloc(2 * MAX_PAIRS * sizeof *pairs);
    assert_non_null(pairs);
    for (int i = 0; i < 4; i++) {
        struct rates r = measure(f, count[i], &random, pairs);
        printf("%4u objects, %6u pairs: random %.3f %%, sequence %.3f %% "
               "(expected %.3f), coloured %u with %u ids\n", count[i], r.pairs,
               100.0 * r.random / r.pairs, 100.0 * r.sequence / r.pairs,
               100 * share[i], r.coloured, r.most_colors);
        assert_true(r.random <= most(r.pairs, 1 / 256.0));
        assert_true(r.random >= least(r.pairs, 1 / 256.0));
        assert_true(r.sequence <= most(r.pairs, share[i]));
        assert_true(r.sequence >= least(r.pairs, share[i]));
        assert_int_equal(r.coloured, 0);
    }
    free(pairs);
}

/* ---- groups of meshes ------------------------------------------------ */

static struct hl_ids_coloring color_groups(struct mk_fixture *f,
                                           uint32_t n_pairs, uint32_t *colors)
{
    struct hl_ids_coloring c;
    assert_int_equal(hl_ids_color(&f->hooks, f->prep.n_groups, f->prep.pairs,
                                  n_pairs, 0, colors, &c), HL_OK);
    assert_int_equal(c.n_conflicts, 0);
    return c;
}

/* The share of cubes with a bad edge lies between the first two Bonferroni
 * sums over the 12 edges: 12 / 256 - 66 / 65536 and 12 / 256. */
static void cube_groups_collide_as_computed(void **state)
{
    enum { CUBES = 20000 };
    struct mk_fixture *f = *state;
    uint32_t colors[6], ids[6], n_bad = 0, n_edges = 0;
    uint64_t seed = mk_seed();
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    assert_int_equal(hl_mesh_prepare(&f->prep, &f->hooks, &f->desc), HL_OK);
    assert_int_equal(color_groups(f, f->prep.n_pairs, colors).n_colors, 3);
    for (uint32_t cube = 0; cube < CUBES; cube++) {
        for (uint32_t g = 0; g < 6; g++)
            ids[g] = hl_ids_random8(seed, 6 * cube + g);
        uint32_t shared = hl_ids_count_shared(f->prep.pairs, 12, ids);
        n_edges += shared;
        n_bad += shared > 0;
    }
    printf("cubes with a bad edge: %.2f %%, edges: %.3f %%\n",
           100.0 * n_bad / CUBES, 100.0 * n_edges / CUBES / 12);
    assert_true(n_edges <= most(12.0 * CUBES, 1 / 256.0));
    assert_true(n_edges >= least(12.0 * CUBES, 1 / 256.0));
    assert_true(n_bad <= most(CUBES, 12 / 256.0));
    assert_true(n_bad >= least(CUBES, 12 / 256.0 - 66 / 65536.0));
}

/* A faceted sphere: its dual is planar, so its edges need 6 colours at most;
 * with the groups that share just a position there are more. */
static void faceted_sphere_needs_few_colours(void **state)
{
    struct mk_fixture *f = *state;
    uint32_t *colors;
    mk_sphere(&f->mesh, 32, 16);
    f->desc = mk_desc(&f->mesh);
    f->desc.normals = NULL;
    assert_int_equal(hl_mesh_prepare(&f->prep, &f->hooks, &f->desc), HL_OK);
    colors = malloc(f->prep.n_groups * sizeof *colors);
    assert_non_null(colors);
    uint32_t edges = color_groups(f, f->prep.n_edge_pairs, colors).n_colors;
    uint32_t all = color_groups(f, f->prep.n_pairs, colors).n_colors;
    printf("faceted sphere: %u groups, %u colours by edge, %u by position\n",
           f->prep.n_groups, edges, all);
    assert_int_equal(f->prep.n_groups, 32 * 14 + 2 * 32);
    assert_true(edges >= 2 && edges <= 6);
    assert_true(all >= 4 && all <= 20);
    free(colors);
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, mk_setup, mk_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(overlaps_match_every_pair),
        TEST(long_rows_finish),
        TEST(overlaps_check_their_arguments),
        TEST(random_bytes_are_even),
        TEST(paper_regions_differ_by_either_half),
        TEST(sequence_shares_as_computed),
        TEST(scenes_collide_as_computed),
        TEST(cube_groups_collide_as_computed),
        TEST(faceted_sphere_needs_few_colours),
    };
    return cmocka_run_group_tests_name("region id rates", tests, NULL, NULL);
}
