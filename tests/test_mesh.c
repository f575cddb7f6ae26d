/* SPDX-License-Identifier: Zlib */
/* Normal groups and the re-indexed mesh: the paper's rule (Kircher and
 * Lawrance 2009, section 3.1) on shapes whose answer is known, and on random
 * triangles against an oracle that compares every triangle with every other. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "tests/mesh_kit.h"

/* ---- what every result keeps ----------------------------------------- */

static void check_triangles(const struct mk_fixture *f)
{
    const struct hl_mesh_prep *p = &f->prep;
    uint32_t seen = 0, groups = 0;
    for (uint32_t t = 0; t < p->n_triangles; t++) {
        uint32_t g = p->triangle_group[t];
        assert_true(g <= groups); /* numbered by first triangle */
        groups += g == groups;
        if (t > 0)
            assert_true(p->source_triangle[t] > p->source_triangle[t - 1]);
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t v = p->indices[3 * t + i];
            assert_true(v <= seen); /* numbered by first use */
            seen += v == seen;
            assert_int_equal(p->group[v], g); /* flat over the triangle */
            assert_int_equal(
                p->source_vertex[v],
                f->desc.indices[3 * p->source_triangle[t] + i]);
        }
    }
    assert_int_equal(seen, p->n_vertices);
    assert_int_equal(groups, p->n_groups);
}

static void check_pairs(const struct mk_fixture *f)
{
    const struct hl_mesh_prep *p = &f->prep;
    assert_true(p->n_edge_pairs <= p->n_pairs);
    for (uint32_t i = 0; i < p->n_pairs; i++) {
        assert_true(p->pairs[2 * i] < p->pairs[2 * i + 1]);
        assert_true(p->pairs[2 * i + 1] < p->n_groups);
        for (uint32_t k = 0; k < i; k++)
            assert_false(p->pairs[2 * i] == p->pairs[2 * k] &&
                         p->pairs[2 * i + 1] == p->pairs[2 * k + 1]);
    }
}

static void prepare(struct mk_fixture *f)
{
    hl_mesh_prep_free(&f->prep, &f->hooks);
    assert_int_equal(hl_mesh_prepare(&f->prep, &f->hooks, &f->desc), HL_OK);
    assert_int_equal(f->prep.n_indices, 3 * f->prep.n_triangles);
    check_triangles(f);
    check_pairs(f);
}

static void prepare_mesh(struct mk_fixture *f)
{
    f->desc = mk_desc(&f->mesh);
    prepare(f);
}

/* ---- shapes ---------------------------------------------------------- */

static void cube_has_six_groups(void **state)
{
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 6);
    assert_int_equal(f->prep.n_triangles, 12);
    assert_int_equal(f->prep.n_vertices, 24);
    assert_int_equal(f->prep.stats.n_positions, 8);
    /* All but the three pairs of opposite faces share an edge. */
    assert_int_equal(f->prep.n_edge_pairs, 12);
    assert_int_equal(f->prep.n_pairs, 12);
}

static void smooth_cube_has_one_group(void **state)
{
    struct mk_fixture *f = *state;
    mk_smooth_cube(&f->mesh);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 1);
    assert_int_equal(f->prep.n_pairs, 0);
    assert_null(f->prep.pairs);
}

static void smooth_sphere_has_one_group(void **state)
{
    struct mk_fixture *f = *state;
    mk_sphere(&f->mesh, 16, 8);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 1);
    assert_int_equal(f->prep.n_triangles, 2 * 16 * 8 - 2 * 16);
    assert_int_equal(f->prep.stats.n_degenerate, 2 * 16);
    assert_int_equal(f->prep.stats.n_positions, 7 * 16 + 2);
}

static void cylinder_with_caps_has_three_groups(void **state)
{
    struct mk_fixture *f = *state;
    mk_cylinder(&f->mesh, 12);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 3);
    assert_int_equal(f->prep.n_pairs, 2); /* side and each cap */
}

static void cone_tip_decides_its_groups(void **state)
{
    struct mk_fixture *f = *state;
    mk_cone(&f->mesh, 12, false);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 2);
    mk_free(&f->mesh);
    /* With a normal a slice at the tip no edge to it is continuous at both
     * ends, so that by the paper's rule each slice is a group. Neighbours:
     * 12 pairs of slices, 12 of slice and base; the tip's fan is too wide. */
    mk_cone(&f->mesh, 12, true);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 13);
    assert_int_equal(f->prep.n_edge_pairs, 24);
    assert_int_equal(f->prep.n_pairs, 24);
    assert_int_equal(f->prep.stats.n_wide, 1);
}

static void small_fan_is_all_neighbours(void **state)
{
    struct mk_fixture *f = *state;
    mk_cone(&f->mesh, 8, true);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 9);
    assert_int_equal(f->prep.n_edge_pairs, 16);
    assert_int_equal(f->prep.n_pairs, 8 + 8 * 7 / 2); /* all slices, base */
    assert_int_equal(f->prep.stats.n_wide, 0);
}

/* ---- the rule -------------------------------------------------------- */

static const float UP[3] = {0, 0, 1}, ASIDE[3] = {0.6f, 0, 0.8f};

/* Two triangles over the edge (0,0)-(0,1); their vertices at (0,0) have
 * normals n0 and m0, at (0,1) n1 and m1. */
static void hinge(struct mk_fixture *f, const float *n0, const float *n1,
                  const float *m0, const float *m1)
{
    static const float origin[3] = {0, 0, 0}, end[3] = {0, 1, 0};
    static const float minus_origin[3] = {-0.0f, 0, -0.0f};
    static const float left[3] = {-1, 0, 0}, right[3] = {1, 0, 0};
    struct mk_mesh *m = &f->mesh;
    mk_free(m);
    mk_vertex(m, origin, n0, 0, 0);
    mk_vertex(m, end, n1, 0, 1);
    mk_vertex(m, left, UP, 1, 0);
    mk_vertex(m, minus_origin, m0, 0, 0);
    mk_vertex(m, end, m1, 0, 1);
    mk_vertex(m, right, UP, -1, 0);
    mk_triangle(m, 0, 1, 2);
    mk_triangle(m, 4, 3, 5);
    prepare_mesh(f);
}

static void edge_is_continuous_by_both_ends_only(void **state)
{
    static const float minus_zero[3] = {-0.0f, -0.0f, 1};
    struct mk_fixture *f = *state;
    hinge(f, UP, UP, UP, UP);
    assert_int_equal(f->prep.n_groups, 1);
    hinge(f, UP, UP, ASIDE, UP);
    assert_int_equal(f->prep.n_groups, 2);
    hinge(f, UP, UP, UP, ASIDE);
    assert_int_equal(f->prep.n_groups, 2);
    hinge(f, UP, ASIDE, ASIDE, UP);
    assert_int_equal(f->prep.n_groups, 2);
    assert_int_equal(f->prep.n_edge_pairs, 1);
    hinge(f, UP, ASIDE, minus_zero, ASIDE);
    assert_int_equal(f->prep.n_groups, 1);
}

static void shared_vertex_of_two_groups_is_duplicated(void **state)
{
    struct mk_fixture *f = *state;
    hinge(f, UP, UP, UP, ASIDE);
    f->mesh.indices[4] = 0; /* the crease fades out at input vertex 0 */
    prepare(f);
    assert_int_equal(f->prep.n_groups, 2);
    assert_int_equal(f->prep.n_vertices, 6); /* of 5 that are used */
    assert_int_equal(f->prep.source_vertex[0], 0);
    assert_int_equal(f->prep.source_vertex[4], 0);
    assert_int_equal(f->prep.group[0], 0);
    assert_int_equal(f->prep.group[4], 1);
}

static void touching_at_a_position_is_a_pair_but_not_of_edges(void **state)
{
    static const float p[5][3] = {
        {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 5; i++)
        mk_vertex(&f->mesh, p[i], UP, p[i][0], p[i][1]);
    mk_triangle(&f->mesh, 0, 1, 2);
    mk_triangle(&f->mesh, 0, 3, 4);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 2);
    assert_int_equal(f->prep.n_edge_pairs, 0);
    assert_int_equal(f->prep.n_pairs, 1);
    assert_int_equal(f->prep.n_vertices, 6);
}

static void t_junction_does_not_join(void **state)
{
    static const float p[6][3] = {{0, 0, 0},  {2, 0, 0},  {1, 1, 0},
                                  {0, -1, 0}, {1, 0, 0}, {2, -1, 0}};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 6; i++)
        mk_vertex(&f->mesh, p[i], UP, 0, 0);
    mk_triangle(&f->mesh, 0, 1, 2);
    mk_triangle(&f->mesh, 0, 3, 4);
    mk_triangle(&f->mesh, 1, 4, 5);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 3);
}

static void three_on_an_edge_are_compared_each_with_each(void **state)
{
    static const float p[5][3] = {
        {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
    struct mk_fixture *f = *state;
    for (uint32_t i = 0; i < 5; i++)
        mk_vertex(&f->mesh, p[i], UP, 0, 0);
    mk_vertex(&f->mesh, p[0], ASIDE, 0, 0);
    mk_triangle(&f->mesh, 0, 1, 2);
    mk_triangle(&f->mesh, 5, 1, 3); /* differs from both others */
    mk_triangle(&f->mesh, 0, 4, 1);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 2);
    assert_int_equal(f->prep.triangle_group[0], 0);
    assert_int_equal(f->prep.triangle_group[1], 1);
    assert_int_equal(f->prep.triangle_group[2], 0);
}

static void tolerance_is_the_largest_component(void **state)
{
    /* Unit vectors; the largest difference of a component is 0.28. */
    static const float a[3] = {0.6f, 0.8f, 0}, b[3] = {0.8f, 0.6f, 0};
    static const float c[3] = {0.96f, 0.28f, 0}, c2[3] = {1.92f, 0.56f, 0};
    struct mk_fixture *f = *state;
    hinge(f, a, a, a, b);
    assert_int_equal(f->prep.n_groups, 2);
    f->desc.normal_tolerance = 0.21f; /* y and x differ by 0.2 */
    prepare(f);
    assert_int_equal(f->prep.n_groups, 1);
    f->desc.normal_tolerance = 0.19f;
    prepare(f);
    assert_int_equal(f->prep.n_groups, 2);
    hinge(f, b, b, c, b);
    f->desc.normal_tolerance = 0.31f; /* 0.16 and 0.32 */
    prepare(f);
    assert_int_equal(f->prep.n_groups, 2);
    f->desc.normal_tolerance = 0.33f;
    prepare(f);
    assert_int_equal(f->prep.n_groups, 1);
    hinge(f, c, c, c, c2); /* equal directions, not equal by value */
    assert_int_equal(f->prep.n_groups, 2);
    f->desc.normal_tolerance = 1e-6f;
    prepare(f);
    assert_int_equal(f->prep.n_groups, 1);
    /* z by itself decides as well */
    hinge(f, UP, UP, ASIDE, UP);
    f->desc.normal_tolerance = 0.59f; /* 0.6 and 0.2 */
    prepare(f);
    assert_int_equal(f->prep.n_groups, 2);
}

static void tolerance_compares_every_component(void **state)
{
    static const float x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    static const float xy[3] = {0.6f, 0.8f, 0}, yz[3] = {0.6f, 0, 0.8f};
    struct mk_fixture *f = *state;
    const float *pairs[3][2] = {{x, y}, {xy, yz}, {yz, xy}};
    for (int i = 0; i < 3; i++) {
        hinge(f, pairs[i][0], UP, pairs[i][1], UP);
        f->desc.normal_tolerance = 0.75f;
        prepare(f);
        assert_int_equal(f->prep.n_groups, 2);
        f->desc.normal_tolerance = 1;
        prepare(f);
        assert_int_equal(f->prep.n_groups, 1);
    }
}

/* ---- normals that are not there -------------------------------------- */

static void without_normals_polygons_are_flat(void **state)
{
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    /* An oblique cube: the corners' rounding tilts a face's two triangles. */
    for (uint32_t i = 0; i < f->mesh.n_vertices; i++) {
        float *p = &f->mesh.position[3 * i], x = p[0], y = p[1], z = p[2];
        p[0] = 0.48f * x - 0.6f * y + 0.64f * z;
        p[1] = 0.64f * x + 0.8f * y + 0.48f * z;
        p[2] = -0.6f * x + 0.00123f * y + 0.8f * z;
    }
    f->desc = mk_desc(&f->mesh);
    f->desc.normals = NULL;
    prepare(f);
    assert_int_equal(f->prep.n_groups, 6);
    assert_int_equal(f->prep.n_edge_pairs, 12);
    assert_int_equal(f->prep.stats.n_face_normals, 36);
}

static void bad_normals_become_the_faces(void **state)
{
    static const uint32_t bad_bits[5] = {0x7FC00000u, 0xFFC00001u, 0x7F800000u,
                                         0xFF800000u, 0x7F7FFFFFu};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 6; i++) {
        float bad[3] = {0, 0, 1e-20f}; /* too short for a float's square */
        if (i < 5)
            memcpy(&bad[i % 3], &bad_bits[i], sizeof(float));
        hinge(f, bad, UP, UP, UP);
        assert_int_equal(f->prep.stats.n_face_normals, 1);
        /* Wound (0,0) (0,1) (-1,0): the face looks up, as do the others. */
        assert_int_equal(f->prep.n_groups, 1);
        for (uint32_t v = 0; v < f->prep.n_vertices; v++)
            assert_memory_equal(&f->prep.normal[3 * v], UP, sizeof UP);
    }
}

static void bad_normal_splits_the_vertex_by_face(void **state)
{
    static const float none[3] = {0, 0, 0}, a[3] = {0, 0, 0};
    static const float b[3] = {0, 1, 0}, c[3] = {-1, 0, 0}, d[3] = {0, 0, -1};
    static const float up[3] = {0, 0, 1}, right[3] = {1, 0, 0};
    struct mk_fixture *f = *state;
    mk_vertex(&f->mesh, a, none, 0, 0);
    mk_vertex(&f->mesh, b, none, 0, 1);
    mk_vertex(&f->mesh, c, none, 1, 0);
    mk_vertex(&f->mesh, d, none, 1, 0);
    mk_triangle(&f->mesh, 0, 1, 2);
    mk_triangle(&f->mesh, 1, 0, 3);
    prepare_mesh(f);
    assert_int_equal(f->prep.n_groups, 2);
    assert_int_equal(f->prep.n_vertices, 6);
    for (uint32_t v = 0; v < 6; v++)
        assert_memory_equal(&f->prep.normal[3 * v], v < 3 ? up : right,
                            sizeof up);
}

/* ---- random triangles against an oracle ------------------------------ */

struct oracle {
    uint32_t n, n_groups;
    uint32_t group[256];
    bool edge[256][256], touch[256][256];   /* groups                        */
};

static bool equal3(const float *a, const float *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static bool same_position(const struct mk_mesh *m, uint32_t a, uint32_t b)
{
    return equal3(&m->position[3 * a], &m->position[3 * b]);
}

/* Bit 0: the triangles share an edge, bit 1: a continuous one. */
static int compare(const struct mk_mesh *m, const uint32_t *s,
                   const uint32_t *t)
{
    int found = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 6; j++) {
            uint32_t a = s[i], b = s[(i + 1) % 3];
            uint32_t c = t[j % 3], d = t[(j % 3 + (j < 3 ? 1 : 2)) % 3];
            if (!same_position(m, a, c) || !same_position(m, b, d))
                continue;
            found |= 1;
            if (equal3(&m->normal[3 * a], &m->normal[3 * c]) &&
                equal3(&m->normal[3 * b], &m->normal[3 * d]))
                found |= 2;
        }
    return found;
}

/* Groups by flooding, in the order of their first triangle. */
static void oracle_groups(struct oracle *o, const struct mk_mesh *m)
{
    uint32_t stack[256], n = 0;
    memset(o, 0, sizeof *o);
    o->n = m->n_indices / 3;
    memset(o->group, 0xFF, sizeof o->group);
    for (uint32_t first = 0; first < o->n; first++) {
        if (o->group[first] != UINT32_MAX)
            continue;
        o->group[first] = o->n_groups;
        stack[n++] = first;
        while (n > 0) {
            uint32_t s = stack[--n];
            for (uint32_t t = 0; t < o->n; t++)
                if (o->group[t] == UINT32_MAX &&
                    (compare(m, &m->indices[3 * s], &m->indices[3 * t]) & 2)) {
                    o->group[t] = o->n_groups;
                    stack[n++] = t;
                }
        }
        o->n_groups++;
    }
}

static void oracle_pairs(struct oracle *o, const struct mk_mesh *m)
{
    for (uint32_t s = 0; s < o->n; s++)
        for (uint32_t t = 0; t < o->n; t++) {
            const uint32_t *a = &m->indices[3 * s], *b = &m->indices[3 * t];
            if (o->group[s] == o->group[t])
                continue;
            if (compare(m, a, b))
                o->edge[o->group[s]][o->group[t]] = true;
            for (int i = 0; i < 9; i++)
                if (same_position(m, a[i / 3], b[i % 3]))
                    o->touch[o->group[s]][o->group[t]] = true;
        }
}

static uint32_t count_pairs(const struct oracle *o, bool edges)
{
    uint32_t n = 0;
    for (uint32_t a = 0; a < o->n_groups; a++)
        for (uint32_t b = 0; b < a; b++)
            n += edges ? o->edge[a][b] : o->touch[a][b];
    return n;
}

/* False when places were too crowded for all pairs to be listed. */
static bool check_against(const struct oracle *o,
                          const struct hl_mesh_prep *p)
{
    assert_int_equal(p->n_groups, o->n_groups);
    for (uint32_t t = 0; t < p->n_triangles; t++)
        assert_int_equal(p->triangle_group[t], o->group[t]);
    for (uint32_t i = 0; i < p->n_pairs; i++) {
        uint32_t a = p->pairs[2 * i], b = p->pairs[2 * i + 1];
        assert_true(i < p->n_edge_pairs ? o->edge[a][b] : o->touch[a][b]);
    }
    if (p->stats.n_wide > 0)
        return false;
    assert_int_equal(p->n_edge_pairs, count_pairs(o, true));
    assert_int_equal(p->n_pairs, count_pairs(o, false));
    return true;
}

static void drop_flat(struct mk_mesh *m)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < m->n_indices; i += 3) {
        uint32_t *v = &m->indices[i];
        if (same_position(m, v[0], v[1]) || same_position(m, v[1], v[2]) ||
            same_position(m, v[2], v[0]))
            continue;
        memmove(&m->indices[kept], v, 3 * sizeof *v);
        kept += 3;
    }
    m->n_indices = kept;
}

static void soup_matches_the_oracle(void **state)
{
    struct mk_fixture *f = *state;
    struct oracle *o = malloc(sizeof *o);
    uint64_t random = mk_seed();
    uint32_t n_full = 0, n_crowded = 0;
    assert_non_null(o);
    for (int i = 0; i < 120; i++) {
        mk_free(&f->mesh);
        uint32_t n_triangles = 1 + mk_below(&random, 200);
        uint32_t n_places = 4 + mk_below(&random, 60);
        uint32_t n_normals = 1 + mk_below(&random, 3);
        mk_soup(&f->mesh, n_triangles, n_places, n_normals, &random);
        drop_flat(&f->mesh);
        prepare_mesh(f);
        oracle_groups(o, &f->mesh);
        oracle_pairs(o, &f->mesh);
        if (check_against(o, &f->prep))
            n_full++;
        else
            n_crowded++;
    }
    free(o);
    printf("soups with all pairs listed: %u, crowded: %u\n", n_full,
           n_crowded);
    assert_true(n_full >= 10 && n_crowded >= 10);
}

/* ---- order does not matter ------------------------------------------- */

/* Triangles, their first corners and the vertices' numbers all change;
 * from[t] is where triangle t was. */
static void shuffle(struct mk_mesh *out, const struct mk_mesh *in,
                    uint32_t *from, uint64_t *random)
{
    uint32_t n = in->n_indices / 3;
    for (uint32_t t = 0; t < n; t++)
        from[t] = t;
    for (uint32_t t = n; t > 1; t--) {
        uint32_t k = mk_below(random, t), swap = from[k];
        from[k] = from[t - 1];
        from[t - 1] = swap;
    }
    for (uint32_t t = 0; t < n; t++) {
        uint32_t turn = mk_below(random, 3), corner[3];
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t v = in->indices[3 * from[t] + (i + turn) % 3];
            corner[i] = mk_vertex(out, &in->position[3 * v],
                                  &in->normal[3 * v], in->uv[2 * v],
                                  in->uv[2 * v + 1]);
        }
        mk_triangle(out, corner[0], corner[1], corner[2]);
    }
}

static void partition_is_invariant(void **state)
{
    struct mk_fixture *f = *state;
    uint64_t random = mk_seed() + 7;
    static uint32_t from[1024], map[1024];
    for (int shape = 0; shape < 20; shape++) {
        struct mk_fixture g;
        memset(&g, 0, sizeof g);
        g.hooks = f->hooks;
        mk_free(&f->mesh);
        if (shape == 0)
            mk_cube(&f->mesh);
        else if (shape == 1)
            mk_cylinder(&f->mesh, 16);
        else
            mk_soup(&f->mesh, 300, 40, 2, &random);
        drop_flat(&f->mesh);
        prepare_mesh(f);
        shuffle(&g.mesh, &f->mesh, from, &random);
        prepare_mesh(&g);
        assert_int_equal(g.prep.n_groups, f->prep.n_groups);
        assert_int_equal(g.prep.stats.n_positions, f->prep.stats.n_positions);
        memset(map, 0xFF, sizeof map);
        for (uint32_t t = 0; t < g.prep.n_triangles; t++) {
            uint32_t was = f->prep.triangle_group[from[t]];
            uint32_t *now = &map[g.prep.triangle_group[t]];
            if (*now == UINT32_MAX)
                *now = was;
            assert_int_equal(*now, was);
        }
        if (f->prep.stats.n_wide == 0)
            assert_int_equal(g.prep.n_pairs, f->prep.n_pairs);
        hl_mesh_prep_free(&g.prep, &g.hooks);
        mk_free(&g.mesh);
    }
}

/* ---- w --------------------------------------------------------------- */

static void tangent_w_is_exact_to_its_last_group(void **state)
{
    (void)state;
    for (uint32_t g = 0; g < HL_MESH_MAX_GROUPS; g += 1 + g / 4096) {
        for (float hand = -1; hand <= 1; hand += 2) {
            float got = 0, w = hl_mesh_pack_tangent_w(hand, g);
            uint32_t group = 0;
            assert_true(w == hand * ((float)g + 1));
            hl_mesh_unpack_tangent_w(w, &got, &group);
            assert_int_equal(group, g);
            assert_true(got == hand);
        }
    }
    uint32_t last = HL_MESH_MAX_GROUPS - 1, group = 0;
    float hand = 0, top = hl_mesh_pack_tangent_w(1, last);
    assert_true(top == 16777216.0f);
    assert_true(hl_mesh_pack_tangent_w(1, UINT32_MAX) == top);
    for (uint32_t g = last - 3; g <= last; g++) {
        hl_mesh_unpack_tangent_w(hl_mesh_pack_tangent_w(-1, g), &hand, &group);
        assert_int_equal(group, g);
    }
}

static void tangent_w_takes_anything(void **state)
{
    static const struct {
        uint32_t bits, group;
        float hand;
    } row[] = {{0x7FC00000u, 0, 1},               /* NaN                     */
               {0x7F800000u, 0xFFFFFFu, 1},       /* Inf                     */
               {0xFF800000u, 0xFFFFFFu, -1},      /* -Inf                    */
               {0x00000000u, 0, 1},               /* 0                       */
               {0x80000000u, 0, 1},               /* -0                      */
               {0x3E800000u, 0, 1},               /* 0.25                    */
               {0xBF19999Au, 0, -1},              /* -0.6                    */
               {0x402CCCCDu, 2, 1},               /* 2.7 -> 3                */
               {0xC0533333u, 2, -1}};             /* -3.3 -> -3              */
    (void)state;
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        float w, hand = 0;
        uint32_t group = 77;
        memcpy(&w, &row[i].bits, sizeof w);
        hl_mesh_unpack_tangent_w(w, &hand, &group);
        assert_int_equal(group, row[i].group);
        assert_true(hand == row[i].hand);
    }
    assert_true(hl_mesh_pack_tangent_w(0, 4) == 5);
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, mk_setup, mk_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(cube_has_six_groups),
        TEST(smooth_cube_has_one_group),
        TEST(smooth_sphere_has_one_group),
        TEST(cylinder_with_caps_has_three_groups),
        TEST(cone_tip_decides_its_groups),
        TEST(small_fan_is_all_neighbours),
        TEST(edge_is_continuous_by_both_ends_only),
        TEST(shared_vertex_of_two_groups_is_duplicated),
        TEST(touching_at_a_position_is_a_pair_but_not_of_edges),
        TEST(t_junction_does_not_join),
        TEST(three_on_an_edge_are_compared_each_with_each),
        TEST(tolerance_is_the_largest_component),
        TEST(tolerance_compares_every_component),
        TEST(without_normals_polygons_are_flat),
        TEST(bad_normals_become_the_faces),
        TEST(bad_normal_splits_the_vertex_by_face),
        TEST(soup_matches_the_oracle),
        TEST(partition_is_invariant),
        TEST(tangent_w_is_exact_to_its_last_group),
        TEST(tangent_w_takes_anything),
    };
    return cmocka_run_group_tests_name("mesh groups", tests, NULL, NULL);
}
