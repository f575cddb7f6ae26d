/* SPDX-License-Identifier: Zlib */
/* Region ids: the schemes that cannot collide, checked pair by pair, and how
 * often the paper's collide. */
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

enum { LIMIT16 = 65534, LIMIT8 = 254 };

static void *take(size_t count, size_t size)
{
    void *memory = calloc(count, size);
    assert_non_null(memory);
    return memory;
}

/* ---- unique ---------------------------------------------------------- */

static void limits_follow_the_storage(void **state)
{
    (void)state;
    assert_int_equal(hl_ids_limit(16), LIMIT16);
    assert_int_equal(hl_ids_limit(8), LIMIT8);
    assert_int_equal(hl_ids_limit(12), 4094);
    assert_int_equal(hl_ids_limit(7), 0);
    assert_int_equal(hl_ids_limit(17), 0);
}

static void unique_fits_to_the_last_id(void **state)
{
    uint32_t n_groups[4] = {1, 65000, 0, 533}, base[4] = {9, 9, 9, 9};
    uint64_t needed = 0;
    (void)state;
    assert_int_equal(hl_ids_unique(4, n_groups, LIMIT16, base, &needed),
                     HL_OK);
    assert_int_equal(needed, LIMIT16);
    assert_int_equal(base[0], 1);
    assert_int_equal(base[1], 2);
    assert_int_equal(base[2], 65002);
    assert_int_equal(base[3] + 532, LIMIT16);
    n_groups[2] = 1; /* 65,535: one too many */
    base[0] = 9;
    assert_int_equal(hl_ids_unique(4, n_groups, LIMIT16, base, &needed),
                     HL_ERR_LIMIT);
    assert_int_equal(needed, 65535);
    assert_int_equal(base[0], 9);
    n_groups[0] = n_groups[1] = UINT32_MAX; /* no sum wraps */
    assert_int_equal(hl_ids_unique(2, n_groups, LIMIT16, base, NULL),
                     HL_ERR_LIMIT);
}

static void unique_checks_its_arguments(void **state)
{
    uint32_t one = 1;
    (void)state;
    assert_int_equal(hl_ids_unique(0, NULL, 1, NULL, NULL), HL_OK);
    assert_int_equal(hl_ids_unique(1, NULL, 1, &one, NULL), HL_ERR_INVALID);
    assert_int_equal(hl_ids_unique(1, &one, 1, NULL, NULL), HL_ERR_INVALID);
}

/* ---- graphs ---------------------------------------------------------- */

enum { MAX_NODES = 400 };
struct graph {
    uint32_t n, n_pairs, pairs[2 * 8 * MAX_NODES];
    bool joined[MAX_NODES][MAX_NODES];
};

static void join(struct graph *g, uint32_t a, uint32_t b)
{
    if (a == b || g->joined[a][b])
        return;
    g->joined[a][b] = g->joined[b][a] = true;
    g->pairs[2 * g->n_pairs] = a;
    g->pairs[2 * g->n_pairs++ + 1] = b;
}

/* Largest over all removals of a node of least degree: the slow way. */
static uint32_t degeneracy(const struct graph *g)
{
    bool gone[MAX_NODES] = {false};
    uint32_t worst = 0;
    for (uint32_t i = 0; i < g->n; i++) {
        uint32_t best = UINT32_MAX, node = 0;
        for (uint32_t v = 0; v < g->n; v++) {
            uint32_t degree = 0;
            for (uint32_t u = 0; u < g->n && !gone[v]; u++)
                degree += g->joined[v][u] && !gone[u];
            if (!gone[v] && degree < best) {
                best = degree;
                node = v;
            }
        }
        gone[node] = true;
        worst = best > worst ? best : worst;
    }
    return worst;
}

static struct hl_ids_coloring color(const struct graph *g, uint32_t max,
                                    uint32_t *colors)
{
    struct mk_memory memory;
    struct hl_hooks hooks = mk_hooks(&memory);
    struct hl_ids_coloring out = {77, 77};
    uint32_t used = 0;
    memset(&memory, 0, sizeof memory);
    assert_int_equal(hl_ids_color(&hooks, g->n, g->pairs, g->n_pairs, max,
                                  colors, &out), HL_OK);
    assert_int_equal(memory.n_live, 0);
    for (uint32_t v = 0; v < g->n; v++)
        used = colors[v] + 1 > used ? colors[v] + 1 : used;
    assert_int_equal(out.n_colors, used);
    assert_int_equal(out.n_conflicts,
                     hl_ids_count_shared(g->pairs, g->n_pairs, colors));
    return out;
}

static void random_graphs_are_coloured_properly(void **state)
{
    struct graph *g = take(1, sizeof *g);
    uint32_t colors[MAX_NODES];
    uint64_t random = mk_seed();
    (void)state;
    for (int i = 0; i < 60; i++) {
        memset(g, 0, sizeof *g);
        g->n = 2 + mk_below(&random, 80);
        for (uint32_t k = mk_below(&random, 8 * g->n); k > 0; k--) {
            uint32_t a = mk_below(&random, g->n);
            join(g, a, mk_below(&random, g->n));
        }
        struct hl_ids_coloring c = color(g, 0, colors);
        assert_int_equal(c.n_conflicts, 0);
        assert_true(c.n_colors <= 1 + degeneracy(g));
    }
    free(g);
}

/* A random maximal planar graph, 3 n - 6 pairs: nodes are put into random
 * faces of a triangle, then random diagonals of two faces are flipped, which
 * leaves the graph planar; node numbers are shuffled. */
static void make_planar(struct graph *g, uint32_t n, uint64_t *random)
{
    static uint32_t face[2 * MAX_NODES][3];
    uint32_t n_faces = 2, name[MAX_NODES];
    memset(g, 0, sizeof *g);
    g->n = n;
    for (uint32_t k = 0; k < 3; k++)
        face[0][k] = face[1][2 - k] = k;
    for (uint32_t v = 3; v < n; v++) {
        uint32_t *f = face[mk_below(random, n_faces)];
        uint32_t a = f[0], b = f[1], c = f[2];
        uint32_t *s = face[n_faces++], *t = face[n_faces++];
        f[2] = v;
        s[0] = b, s[1] = c, s[2] = v;
        t[0] = c, t[1] = a, t[2] = v;
    }
    for (uint32_t f = 0; f < n_faces; f++)
        for (uint32_t k = 0; k < 3; k++)
            g->joined[face[f][k]][face[f][(k + 1) % 3]] = true;
    for (uint32_t i = 0; i < 20 * n; i++) {
        uint32_t *s = face[mk_below(random, n_faces)], k = mk_below(random, 3);
        uint32_t a = s[k], b = s[(k + 1) % 3], c = s[(k + 2) % 3];
        for (uint32_t f = 0; f < n_faces; f++)
            for (uint32_t m = 0; m < 3; m++) {
                uint32_t *t = face[f], d = t[(m + 2) % 3];
                if (t[m] != b || t[(m + 1) % 3] != a || g->joined[c][d])
                    continue;
                g->joined[a][b] = g->joined[b][a] = false;
                g->joined[c][d] = g->joined[d][c] = true;
                s[0] = c, s[1] = a, s[2] = d;
                t[0] = d, t[1] = b, t[2] = c;
                f = n_faces - 1;
                break;
            }
    }
    for (uint32_t v = 0; v < n; v++)
        name[v] = v;
    for (uint32_t v = n; v > 1; v--) {
        uint32_t k = mk_below(random, v), swap = name[k];
        name[k] = name[v - 1];
        name[v - 1] = swap;
    }
    for (uint32_t a = 0; a < n; a++)
        for (uint32_t b = 0; b < a; b++)
            if (g->joined[a][b]) {
                g->pairs[2 * g->n_pairs] = name[a];
                g->pairs[2 * g->n_pairs++ + 1] = name[b];
            }
}

/* Every planar graph has a node of degree 5 or less, and so has what is left
 * when one is taken away: smallest-last needs at most 6 colours, always. */
static void planar_graphs_need_six_colours_at_most(void **state)
{
    struct graph *g = take(1, sizeof *g);
    uint32_t colors[MAX_NODES], histogram[8] = {0};
    uint64_t random = mk_seed() + 1;
    (void)state;
    for (int i = 0; i < 60; i++) {
        uint32_t n = 12 + mk_below(&random, i < 55 ? 90 : 280);
        make_planar(g, n, &random);
        assert_int_equal(g->n_pairs, 3 * n - 6);
        struct hl_ids_coloring c = color(g, 0, colors);
        assert_int_equal(c.n_conflicts, 0);
        assert_true(c.n_colors >= 3 && c.n_colors <= 6);
        histogram[c.n_colors]++;
    }
    printf("planar graphs by colours: 3: %u, 4: %u, 5: %u, 6: %u\n",
           histogram[3], histogram[4], histogram[5], histogram[6]);
    free(g);
}

static void known_graphs_need_what_they_need(void **state)
{
    struct graph *g = take(1, sizeof *g);
    uint32_t colors[MAX_NODES];
    (void)state;
    color(g, 0, colors); /* no node at all */
    for (g->n = 1; g->n <= 12; g->n++) { /* complete graphs */
        for (uint32_t v = 0; v + 1 < g->n; v++)
            join(g, v, g->n - 1);
        assert_int_equal(color(g, 0, colors).n_colors, g->n);
    }
    memset(g, 0, sizeof *g);
    g->n = 300; /* a tree: two */
    for (uint32_t v = 1; v < g->n; v++)
        join(g, v, v * 7 % v);
    assert_int_equal(color(g, 0, colors).n_colors, 2);
    g->n_pairs = 0;
    assert_int_equal(color(g, 0, colors).n_colors, 1);
    free(g);
}

static void doubles_and_loops_count_as_nothing(void **state)
{
    struct graph *g = take(1, sizeof *g);
    uint32_t plain[MAX_NODES], noisy[MAX_NODES];
    uint64_t random = mk_seed() + 2;
    (void)state;
    make_planar(g, 60, &random);
    color(g, 0, plain);
    for (uint32_t i = 0; i < 2 * 60; i++) {
        uint32_t from = mk_below(&random, g->n_pairs), at = 2 * g->n_pairs++;
        g->pairs[at] = g->pairs[2 * from + 1];
        g->pairs[at + 1] = i % 3 ? g->pairs[2 * from] : g->pairs[at];
    }
    color(g, 0, noisy);
    assert_memory_equal(plain, noisy, 60 * sizeof *plain);
    free(g);
}

/* With m colours for a complete graph of n, conflicts are fewest when classes
 * are even, which taking the least used colour gives. */
static void conflicts_are_counted_and_few(void **state)
{
    struct graph *g = take(1, sizeof *g);
    uint32_t colors[MAX_NODES];
    (void)state;
    g->n = 23;
    for (uint32_t a = 0; a < g->n; a++)
        for (uint32_t b = 0; b < a; b++)
            join(g, a, b);
    for (uint32_t m = 1; m <= 23; m++) {
        struct hl_ids_coloring c = color(g, m, colors);
        uint32_t each = 23 / m, more = 23 % m;
        assert_int_equal(c.n_colors, m);
        assert_int_equal(c.n_conflicts, more * (each + 1) * each / 2 +
                                            (m - more) * each * (each - 1) / 2);
    }
    free(g);
}

/* Stars and paths of a size that quadratic work would not finish. */
static void large_graphs_finish(void **state)
{
    enum { N = 200000 };
    uint32_t *pairs = take(2 * N, sizeof *pairs);
    uint32_t *colors = take(N, sizeof *colors);
    struct mk_memory memory;
    struct hl_hooks hooks = mk_hooks(&memory);
    struct hl_ids_coloring out;
    (void)state;
    memset(&memory, 0, sizeof memory);
    for (uint32_t hub = 0; hub < 2; hub++) {
        for (uint32_t i = 0; i < N - 1; i++) {
            pairs[2 * i] = hub ? 0 : i;
            pairs[2 * i + 1] = i + 1;
        }
        assert_int_equal(hl_ids_color(&hooks, N, pairs, N - 1, 0, colors,
                                      &out), HL_OK);
        assert_int_equal(out.n_colors, 2);
        assert_int_equal(out.n_conflicts, 0);
    }
    free(pairs);
    free(colors);
}

static void coloring_checks_its_arguments(void **state)
{
    uint32_t pairs[4] = {0, 1, 1, 2}, colors[3] = {8, 8, 8};
    struct mk_memory memory;
    struct hl_hooks hooks = mk_hooks(&memory), none = {NULL, NULL, NULL};
    struct hl_ids_coloring out = {5, 5};
    (void)state;
    memset(&memory, 0, sizeof memory);
    assert_int_equal(hl_ids_color(NULL, 3, pairs, 2, 0, colors, &out),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_color(&none, 3, pairs, 2, 0, colors, &out),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_color(&hooks, 3, pairs, 2, 0, colors, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_color(&hooks, 3, pairs, 2, 0, NULL, &out),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_color(&hooks, 3, NULL, 2, 0, colors, &out),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_color(&hooks, 2, pairs, 2, 0, colors, &out),
                     HL_ERR_INVALID); /* pair 1 names node 2 */
    assert_int_equal(hl_ids_color(&hooks, 0x40000001u, pairs, 2, 0, colors,
                                  &out), HL_ERR_LIMIT);
    assert_int_equal(hl_ids_color(&hooks, 3, pairs, 0x40000001u, 0, colors,
                                  &out), HL_ERR_LIMIT);
    for (memory.fail_at = 1; memory.fail_at <= 9; memory.fail_at++) {
        memory.n_allocs = 0;
        assert_int_equal(hl_ids_color(&hooks, 3, pairs, 2, 0, colors, &out),
                         HL_ERR_MEMORY);
        assert_int_equal(memory.n_live, 0);
    }
    assert_int_equal(colors[0], 8); /* nothing was written */
    assert_int_equal(out.n_colors, 5);
    memory.n_allocs = 0; /* fail_at 10: there is no tenth */
    assert_int_equal(hl_ids_color(&hooks, 3, pairs, 2, 0, colors, &out),
                     HL_OK);
}

/* ---- scenes ---------------------------------------------------------- */

struct scene {
    struct mk_memory memory;
    struct hl_hooks hooks;
    struct hl_ids_object objects[MAX_NODES];
    uint32_t base[MAX_NODES];
    struct hl_ids_scene desc;
    struct hl_ids_plan plan;
};

static struct scene *scene_of(uint32_t n, uint32_t n_groups,
                              uint32_t n_colors, uint32_t limit)
{
    struct scene *s = take(1, sizeof *s);
    s->hooks = mk_hooks(&s->memory);
    for (uint32_t i = 0; i < n; i++) {
        s->objects[i].n_groups = n_groups;
        s->objects[i].n_colors = n_colors;
    }
    s->desc.objects = s->objects;
    s->desc.n_objects = n;
    s->desc.limit = limit;
    return s;
}

static enum hl_result assign(struct scene *s)
{
    enum hl_result result =
        hl_ids_assign(&s->hooks, &s->desc, s->base, &s->plan);
    assert_int_equal(s->memory.n_live, 0);
    return result;
}

/* Colours of groups as a mesh would have them: any, below n_colors. */
static uint32_t region(const struct scene *s, uint32_t object, uint32_t group)
{
    uint32_t n = s->objects[object].n_colors;
    return hl_ids_region(&s->plan, s->base[object], group,
                         n ? group % n : group);
}

/* No id of a is an id of b. */
static bool apart(const struct scene *s, uint32_t a, uint32_t b)
{
    for (uint32_t g = 0; g < s->objects[a].n_groups; g++)
        for (uint32_t h = 0; h < s->objects[b].n_groups; h++)
            if (region(s, a, g) == region(s, b, h))
                return false;
    return true;
}

static void check_ids(const struct scene *s)
{
    for (uint32_t i = 0; i < s->desc.n_objects; i++)
        for (uint32_t g = 0; g < s->objects[i].n_groups; g++) {
            assert_in_range(region(s, i, g), 1, s->desc.limit);
            assert_true(region(s, i, g) <= s->plan.n_ids);
        }
}

static void few_regions_are_unique(void **state)
{
    struct scene *s = scene_of(42, 6, 3, LIMIT8); /* 252 */
    (void)state;
    s->objects[3].n_groups = 8; /* 254 */
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.scheme, HL_IDS_UNIQUE);
    assert_int_equal(s->plan.n_ids, 254);
    assert_int_equal(s->plan.stride, 8);
    check_ids(s);
    for (uint32_t i = 0; i < 42; i++)
        for (uint32_t k = 0; k < i; k++)
            assert_true(apart(s, i, k));
    s->objects[3].n_groups = 9; /* 255: now by colours, 42 * 3 = 126 */
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.scheme, HL_IDS_GROUPS_COLORED);
    assert_int_equal(s->plan.n_ids, 126);
    assert_int_equal(s->plan.stride, 3);
    assert_int_equal(s->plan.n_conflicts, 0);
    check_ids(s);
    for (uint32_t i = 0; i < 42; i++)
        for (uint32_t k = 0; k < i; k++)
            assert_true(apart(s, i, k));
    free(s);
}

static void meeting_objects_are_apart(void **state)
{
    struct scene *s = scene_of(300, 12, 4, LIMIT8); /* 1,200 colours */
    struct graph *g = take(1, sizeof *g);
    uint64_t random = mk_seed() + 4;
    (void)state;
    make_planar(g, 300, &random);
    assert_int_equal(assign(s), HL_ERR_LIMIT); /* meetings are not known */
    s->desc.meetings = g->pairs;
    s->desc.n_meetings = g->n_pairs;
    s->objects[9].n_colors = 0; /* not coloured: 12 */
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.scheme, HL_IDS_COLORED);
    assert_int_equal(s->plan.stride, 12);
    assert_true(s->plan.n_object_colors <= 6);
    assert_int_equal(s->plan.n_ids, 12 * s->plan.n_object_colors);
    assert_int_equal(s->plan.n_conflicts, 0);
    assert_int_equal(s->plan.n_folded, 0);
    check_ids(s);
    for (uint32_t i = 0; i < g->n_pairs; i++)
        assert_true(apart(s, g->pairs[2 * i], g->pairs[2 * i + 1]));
    free(g);
    free(s);
}

static void what_cannot_be_apart_is_counted(void **state)
{
    struct scene *s = scene_of(20, 100, 60, LIMIT8);
    struct graph *g = take(1, sizeof *g);
    uint32_t n = 0;
    (void)state;
    g->n = 20;
    for (uint32_t a = 0; a < 20; a++)
        for (uint32_t b = 0; b < a; b++)
            join(g, a, b);
    s->desc.meetings = g->pairs;
    s->desc.n_meetings = g->n_pairs;
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.n_object_colors, 4); /* 254 / 60 */
    for (uint32_t i = 0; i < g->n_pairs; i++)
        n += !apart(s, g->pairs[2 * i], g->pairs[2 * i + 1]);
    assert_int_equal(n, 4 * 5 * 4 / 2); /* four classes of five */
    assert_int_equal(s->plan.n_conflicts, n);
    check_ids(s);
    /* More colours in one mesh than there are ids. */
    s->objects[7].n_groups = s->objects[7].n_colors = 255;
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.n_folded, 1);
    assert_int_equal(s->plan.stride, 254);
    assert_int_equal(s->plan.n_conflicts, g->n_pairs);
    check_ids(s);
    free(g);
    free(s);
}

static void assigning_checks_its_arguments(void **state)
{
    static const uint32_t bad[2] = {0, 300};
    struct scene *s = scene_of(300, 1, 1, LIMIT8);
    struct hl_hooks none = {NULL, NULL, NULL};
    (void)state;
    assert_int_equal(hl_ids_assign(&none, &s->desc, s->base, &s->plan),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_assign(&s->hooks, NULL, s->base, &s->plan),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_assign(&s->hooks, &s->desc, s->base, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_ids_assign(&s->hooks, &s->desc, NULL, &s->plan),
                     HL_ERR_INVALID);
    s->desc.limit = 0;
    assert_int_equal(assign(s), HL_ERR_INVALID);
    s->desc.limit = LIMIT8;
    s->objects[5].n_colors = 2; /* of one group */
    assert_int_equal(assign(s), HL_ERR_INVALID);
    s->objects[5].n_colors = 1;
    s->desc.meetings = bad;
    s->desc.n_meetings = 1;
    assert_int_equal(assign(s), HL_ERR_INVALID);
    s->desc.n_meetings = 0; /* known: nothing meets */
    s->memory.fail_at = 1;
    assert_int_equal(assign(s), HL_ERR_MEMORY);
    s->memory.fail_at = 0;
    assert_int_equal(assign(s), HL_OK);
    assert_int_equal(s->plan.n_object_colors, 1);
    s->desc.objects = NULL;
    assert_int_equal(assign(s), HL_ERR_INVALID);
    s->desc.n_objects = 0;
    assert_int_equal(hl_ids_assign(&s->hooks, &s->desc, NULL, &s->plan),
                     HL_OK);
    assert_int_equal(s->plan.n_ids, 0);
    free(s);
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(limits_follow_the_storage),
        TEST(unique_fits_to_the_last_id),
        TEST(unique_checks_its_arguments),
        TEST(random_graphs_are_coloured_properly),
        TEST(planar_graphs_need_six_colours_at_most),
        TEST(known_graphs_need_what_they_need),
        TEST(doubles_and_loops_count_as_nothing),
        TEST(conflicts_are_counted_and_few),
        TEST(large_graphs_finish),
        TEST(coloring_checks_its_arguments),
        TEST(few_regions_are_unique),
        TEST(meeting_objects_are_apart),
        TEST(what_cannot_be_apart_is_counted),
        TEST(assigning_checks_its_arguments),
    };
    return cmocka_run_group_tests_name("region ids", tests, NULL, NULL);
}
