/* SPDX-License-Identifier: Zlib */
/* Meshes that are wrong, huge or unkind to hashing and union-find; memory
 * that runs out at every call; results that must not differ by machine. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "core/mem.h"
#include "tests/mesh_kit.h"

static const float UP[3] = {0, 0, 1};

static enum hl_result try(struct mk_fixture *f)
{
    hl_mesh_prep_free(&f->prep, &f->hooks);
    return hl_mesh_prepare(&f->prep, &f->hooks, &f->desc);
}

static void prepare(struct mk_fixture *f)
{
    assert_int_equal(try(f), HL_OK);
}

static void assert_nothing(const struct mk_fixture *f)
{
    static const struct hl_mesh_prep zero;
    assert_memory_equal(&f->prep, &zero, sizeof zero);
    assert_int_equal(f->memory.n_live, 0);
}

/* ---- arguments ------------------------------------------------------- */

static void missing_arguments_are_refused(void **state)
{
    struct mk_fixture *f = *state;
    struct hl_hooks no_alloc = f->hooks, no_free = f->hooks;
    no_alloc.alloc = NULL;
    no_free.free = NULL;
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    f->prep.n_groups = 7; /* is zeroed even on failure */
    assert_int_equal(hl_mesh_prepare(NULL, &f->hooks, &f->desc),
                     HL_ERR_INVALID);
    assert_int_equal(hl_mesh_prepare(&f->prep, NULL, &f->desc),
                     HL_ERR_INVALID);
    assert_nothing(f);
    assert_int_equal(hl_mesh_prepare(&f->prep, &no_alloc, &f->desc),
                     HL_ERR_INVALID);
    assert_int_equal(hl_mesh_prepare(&f->prep, &no_free, &f->desc),
                     HL_ERR_INVALID);
    assert_int_equal(hl_mesh_prepare(&f->prep, &f->hooks, NULL),
                     HL_ERR_INVALID);
    f->desc.positions = NULL;
    assert_int_equal(try(f), HL_ERR_INVALID);
    f->desc = mk_desc(&f->mesh);
    f->desc.indices = NULL;
    f->desc.n_indices = f->desc.n_vertices - 1;
    assert_int_equal(try(f), HL_ERR_INVALID);
    f->desc.n_indices = f->desc.n_vertices; /* the near miss */
    assert_int_equal(try(f), HL_OK);
    hl_mesh_prep_free(NULL, &f->hooks);
}

static void tolerance_outside_its_range_is_refused(void **state)
{
    static const uint32_t nan_bits = 0x7FC00000u;
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    f->desc.normal_tolerance = -1e-9f;
    assert_int_equal(try(f), HL_ERR_INVALID);
    f->desc.normal_tolerance = 2.0000002f;
    assert_int_equal(try(f), HL_ERR_INVALID);
    memcpy(&f->desc.normal_tolerance, &nan_bits, sizeof nan_bits);
    assert_int_equal(try(f), HL_ERR_INVALID);
    f->desc.normal_tolerance = 2; /* joins whatever shares an edge */
    assert_int_equal(try(f), HL_OK);
    assert_int_equal(f->prep.n_groups, 1);
}

static void empty_meshes_are_empty(void **state)
{
    struct mk_fixture *f = *state;
    prepare(f); /* all zero: no vertices, no indices */
    assert_nothing(f);
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    f->desc.n_indices = 0;
    prepare(f);
    assert_nothing(f);
    f->desc.n_vertices = 0; /* every index out of range */
    f->desc.positions = NULL;
    f->desc.n_indices = 36;
    prepare(f);
    assert_int_equal(f->prep.stats.n_out_of_range, 12);
    f->prep.stats.n_out_of_range = 0;
    assert_nothing(f);
}

static void no_indices_means_in_order(void **state)
{
    struct mk_fixture *f = *state;
    static const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
    for (int i = 0; i < 4; i++)
        mk_vertex(&f->mesh, p[i], UP, 0, 0);
    f->desc = mk_desc(&f->mesh);
    f->desc.indices = NULL;
    f->desc.n_indices = 0;
    prepare(f);
    assert_int_equal(f->prep.n_triangles, 1);
    assert_int_equal(f->prep.stats.n_partial, 1);
    for (uint32_t i = 0; i < 3; i++)
        assert_int_equal(f->prep.source_vertex[f->prep.indices[i]], i);
}

/* ---- counts ---------------------------------------------------------- */

static void counts_are_checked_before_anything_is_read(void **state)
{
    struct mk_fixture *f = *state;
    float few[3] = {0, 0, 0};
    uint32_t index[3] = {0, 0, 0};
    f->desc.positions = few;
    f->desc.indices = index;
    f->desc.n_indices = 3;
    f->desc.n_vertices = UINT32_MAX;
    assert_int_equal(try(f), HL_ERR_LIMIT);
    f->desc.n_vertices = HL_MESH_MAX_COUNT + 1;
    assert_int_equal(try(f), HL_ERR_LIMIT);
    f->desc.n_vertices = 1;
    f->desc.n_indices = UINT32_MAX;
    assert_int_equal(try(f), HL_ERR_LIMIT);
    f->desc.n_indices = HL_MESH_MAX_COUNT + 1;
    assert_int_equal(try(f), HL_ERR_LIMIT);
    /* At the limit memory is asked for before the first index is read. */
    f->desc.n_indices = HL_MESH_MAX_COUNT;
    f->memory.max_bytes = 1 << 20;
    assert_int_equal(try(f), HL_ERR_MEMORY);
    f->desc.indices = NULL;
    f->desc.n_vertices = HL_MESH_MAX_COUNT;
    assert_int_equal(try(f), HL_ERR_MEMORY);
    assert_nothing(f);
}

static void strides_that_overflow_are_refused(void **state)
{
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    for (int i = 0; i < 4; i++) {
        size_t *stride[4] = {&f->desc.position_stride, &f->desc.normal_stride,
                             &f->desc.uv_stride, &f->desc.tangent_stride};
        f->desc = mk_desc(&f->mesh);
        f->desc.tangents = f->mesh.position;
        *stride[i] = SIZE_MAX / 24 + 1;
        assert_int_equal(try(f), HL_ERR_LIMIT);
    }
    f->desc.tangents = NULL; /* then its stride is nobody's business */
    assert_int_equal(try(f), HL_OK);
}

static void group_limit_is_exact(void **state)
{
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    f->desc.max_groups = 5;
    assert_int_equal(try(f), HL_ERR_LIMIT);
    assert_nothing(f);
    f->desc.max_groups = 6;
    assert_int_equal(try(f), HL_OK);
    f->desc.max_groups = UINT32_MAX;
    assert_int_equal(try(f), HL_OK);
}

static void sizes_are_checked_before_they_multiply(void **state)
{
    struct mk_fixture *f = *state;
    enum hl_result result = HL_OK;
    assert_true(hl_mem_fits(SIZE_MAX, 1));
    assert_true(hl_mem_fits(SIZE_MAX, 0));
    assert_true(hl_mem_fits(SIZE_MAX / 3, 3));
    assert_false(hl_mem_fits(SIZE_MAX / 3 + 1, 3));
    assert_null(hl_mem_new(&f->hooks, SIZE_MAX / 4 + 1, 4, &result));
    assert_int_equal(result, HL_ERR_LIMIT);
    assert_null(hl_mem_new(&f->hooks, 1, 4, &result)); /* stays failed */
    assert_int_equal(result, HL_ERR_LIMIT);
    assert_int_equal(f->memory.n_allocs, 0);
}

/* ---- contents -------------------------------------------------------- */

static void bad_triangles_are_dropped_and_counted(void **state)
{
    struct mk_fixture *f = *state;
    static const uint32_t bad_bits[3] = {0x7FC00000u, 0x7F800000u,
                                         0xFF800000u};
    static const float p[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                  {2, 0, 0}, {0, 0, 0}, {-3, 0, 0}};
    for (int i = 0; i < 6; i++)
        mk_vertex(&f->mesh, p[i], UP, 0, 0);
    for (int i = 0; i < 3; i++) {
        uint32_t v = mk_vertex(&f->mesh, p[0], UP, 0, 0);
        memcpy(&f->mesh.position[3 * v + (uint32_t)i], &bad_bits[i], 4);
    }
    mk_triangle(&f->mesh, 0, 1, 9);          /* out of range, in each place  */
    mk_triangle(&f->mesh, UINT32_MAX, 1, 2);
    mk_triangle(&f->mesh, 0, 0x80000000u, 2);
    mk_triangle(&f->mesh, 6, 1, 2);          /* NaN, Inf, -Inf               */
    mk_triangle(&f->mesh, 0, 7, 2);
    mk_triangle(&f->mesh, 0, 1, 8);
    mk_triangle(&f->mesh, 1, 1, 2);          /* repeated index               */
    mk_triangle(&f->mesh, 0, 1, 3);          /* on a line                    */
    mk_triangle(&f->mesh, 0, 2, 4);          /* repeated position            */
    mk_triangle(&f->mesh, 5, 0, 1);
    mk_triangle(&f->mesh, 0, 1, 2);          /* the good one                 */
    f->mesh.n_indices += 2;                  /* there is room: 96 at first   */
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    assert_int_equal(f->prep.n_triangles, 1);
    assert_int_equal(f->prep.source_triangle[0], 10);
    assert_int_equal(f->prep.stats.n_out_of_range, 3);
    assert_int_equal(f->prep.stats.n_non_finite, 3);
    assert_int_equal(f->prep.stats.n_degenerate, 4);
    assert_int_equal(f->prep.stats.n_partial, 1);
    f->desc.n_indices -= 5; /* without the good one and the rest */
    prepare(f);
    assert_null(f->prep.indices);
    assert_null(f->prep.source_triangle);
    assert_null(f->prep.triangle_group);
    assert_int_equal(f->prep.n_groups, 0);
    assert_int_equal(f->memory.n_live, 0);
}

/* Areas as small and as large as floats allow are areas. */
static void extreme_sizes_are_kept(void **state)
{
    static const float scale[4] = {1.4e-45f, 1e-38f, 1e38f, 3.4028234e38f};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 4; i++) {
        float s = scale[i];
        float a[3] = {-s, 0, 0}, b[3] = {s, 0, 0}, c[3] = {0, s, 0};
        mk_free(&f->mesh);
        mk_flat(&f->mesh, a, b, c, UP);
        f->desc = mk_desc(&f->mesh);
        f->desc.normals = NULL;
        prepare(f);
        assert_int_equal(f->prep.n_triangles, 1);
        assert_memory_equal(f->prep.normal, UP, sizeof UP);
        assert_true(f->prep.tangent[0] == 1);
    }
}

static void interleaved_and_unaligned_arrays_read_alike(void **state)
{
    enum { STRIDE = 37 };
    struct mk_fixture *f = *state, g;
    uint64_t random = mk_seed();
    unsigned char *bytes;
    mk_soup(&f->mesh, 50, 20, 2, &random);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    memset(&g, 0, sizeof g);
    g.hooks = f->hooks;
    g.desc = f->desc;
    bytes = malloc((size_t)STRIDE * f->mesh.n_vertices + 1);
    assert_non_null(bytes);
    for (size_t i = 0; i < f->mesh.n_vertices; i++) {
        memcpy(bytes + 1 + STRIDE * i, &f->mesh.uv[2 * i], 8);
        memcpy(bytes + 10 + STRIDE * i, &f->mesh.position[3 * i], 12);
        memcpy(bytes + 23 + STRIDE * i, &f->mesh.normal[3 * i], 12);
    }
    g.desc.uvs = bytes + 1;
    g.desc.positions = bytes + 10;
    g.desc.normals = bytes + 23;
    g.desc.uv_stride = g.desc.position_stride = g.desc.normal_stride = STRIDE;
    prepare(&g);
    assert_int_equal(g.prep.n_vertices, f->prep.n_vertices);
    assert_memory_equal(g.prep.indices, f->prep.indices,
                        4 * (size_t)f->prep.n_indices);
    assert_memory_equal(g.prep.tangent, f->prep.tangent,
                        16 * (size_t)f->prep.n_vertices);
    assert_memory_equal(g.prep.normal, f->prep.normal,
                        12 * (size_t)f->prep.n_vertices);
    hl_mesh_prep_free(&g.prep, &g.hooks);
    free(bytes);
}

/* Every float any bits, every index any number up to a little past the end. */
static void random_bits_are_survived(void **state)
{
    struct mk_fixture *f = *state;
    uint64_t random = mk_seed() + 3;
    uint32_t kept = 0;
    for (int i = 0; i < 400; i++) {
        struct mk_mesh *m = &f->mesh;
        mk_free(m);
        mk_soup(m, 40, 12, 3, &random);
        for (uint32_t k = 0; k < 3 * m->n_vertices; k++) {
            uint32_t p = mk_random(&random), n = mk_random(&random);
            if (p % 16 == 0)
                memcpy(&m->position[k], &n, 4);
            if (p % 3 == 0)
                memcpy(&m->normal[k], &n, 4);
            if (p % 5 == 0)
                memcpy(&m->uv[k * 2 / 3], &n, 4);
        }
        for (uint32_t k = 0; k < m->n_indices; k++)
            if (mk_below(&random, 8) == 0)
                m->indices[k] = mk_below(&random, m->n_vertices + 3);
        f->desc = mk_desc(m);
        f->desc.normal_tolerance = i % 2 ? mk_unit(&random) : 0;
        f->desc.v_down = i % 4 > 1;
        prepare(f);
        for (uint32_t k = 0; k < f->prep.n_indices; k++)
            assert_true(f->prep.indices[k] < f->prep.n_vertices);
        for (uint32_t k = 0; k < 4 * f->prep.n_vertices; k++)
            assert_true(f->prep.tangent[k] >= -1 && f->prep.tangent[k] <= 1);
        kept += f->prep.n_triangles;
    }
    assert_true(kept > 400); /* the test is not about empty meshes */
}

/* ---- work is linear -------------------------------------------------- */

/* Pages of a book: n triangles on one edge, all normals different. */
static void book(struct mk_mesh *m, uint32_t n)
{
    static const float a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
    for (uint32_t i = 0; i < n; i++) {
        float c[3] = {1, (float)i, 0}, normal[3] = {-(float)i, 1, 0};
        mk_flat(m, a, b, c, normal);
    }
}

/* n triangles about one vertex, each its own group. */
static void fan(struct mk_mesh *m, uint32_t n)
{
    static const float a[3] = {0, 0, 0};
    for (uint32_t i = 0; i < n; i++) {
        float b[3] = {1, (float)i, 0}, c[3] = {1, (float)i + 1, 0};
        float normal[3] = {0, (float)i + 1, 1};
        mk_flat(m, a, b, c, normal);
    }
}

static void strip(struct mk_mesh *m, uint32_t n)
{
    for (uint32_t i = 0; i < n + 2; i++) {
        float p[3] = {(float)i, (float)(i % 2), 0};
        mk_vertex(m, p, UP, p[0], p[1]);
    }
    for (uint32_t i = 0; i < n; i++) /* joined from the middle outwards */
        mk_triangle(m, i * 7919 % n, i * 7919 % n + 1, i * 7919 % n + 2);
}

static void same_again(struct mk_mesh *m, uint32_t n)
{
    static const float a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
    for (uint32_t i = 0; i < n; i++)
        mk_flat(m, a, b, c, UP);
}

static void square_grid(struct mk_mesh *m, uint32_t n)
{
    uint32_t side = 1;
    while (2 * side * side < n)
        side *= 2;
    mk_grid(m, side);
}

static void facets(struct mk_mesh *m, uint32_t n)
{
    uint64_t random = 5;
    mk_soup(m, n, n, 1000, &random);
}

struct work { uint64_t steps; size_t bytes; uint32_t n; };

static struct work measure(void (*make)(struct mk_mesh *, uint32_t),
                           uint32_t n, bool normals)
{
    struct mk_memory memory;
    struct mk_fixture f;
    struct work work;
    memset(&f, 0, sizeof f);
    memset(&memory, 0, sizeof memory);
    f.hooks = mk_hooks(&memory);
    make(&f.mesh, n);
    f.desc = mk_desc(&f.mesh);
    if (!normals)
        f.desc.normals = NULL;
    prepare(&f);
    work.steps = f.prep.stats.n_steps;
    work.bytes = memory.n_bytes;
    work.n = f.prep.n_triangles;
    hl_mesh_prep_free(&f.prep, &f.hooks);
    mk_free(&f.mesh);
    assert_int_equal(memory.n_live, 0);
    return work;
}

/* Eight times the triangles (the grid: sixteen), so that work of n log n would
 * grow by 14 / 11 = 1.27 a triangle and quadratic work by 8. The tables'
 * fill, between a quarter and a half, is about the same for both sizes, as
 * they grow by doubling; 9 / 8 leaves that room. */
static void work_grows_with_the_mesh(void **state)
{
    static const struct {
        const char *name;
        void (*make)(struct mk_mesh *, uint32_t);
    } shape[] = {{"book", book},         {"fan", fan},
                 {"strip", strip},       {"same", same_again},
                 {"grid", square_grid},  {"facets", facets}};
    (void)state;
    for (size_t i = 0; i < sizeof shape / sizeof *shape; i++)
        for (int normals = 0; normals < 2; normals++) {
            struct work a = measure(shape[i].make, 2048, normals);
            struct work b = measure(shape[i].make, 16384, normals);
            printf("%-7s normals %d: steps a triangle %5.1f -> %5.1f, bytes "
                   "%5.0f -> %5.0f\n", shape[i].name, normals,
                   (double)a.steps / a.n, (double)b.steps / b.n,
                   (double)a.bytes / a.n, (double)b.bytes / b.n);
            assert_true(8 * b.steps * a.n < 9 * a.steps * b.n);
            assert_true(8 * (uint64_t)b.bytes * a.n <
                        9 * (uint64_t)a.bytes * b.n);
        }
}

static void wide_edges_are_counted(void **state)
{
    struct mk_fixture *f = *state;
    book(&f->mesh, HL_MESH_MAX_WINGS + 1);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    assert_int_equal(f->prep.n_groups, 17);
    assert_int_equal(f->prep.n_edge_pairs, 17 * 16 / 2);
    assert_int_equal(f->prep.stats.n_wide, 2); /* both ends' fans */
    mk_free(&f->mesh);
    book(&f->mesh, HL_MESH_MAX_WINGS + 2);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    assert_int_equal(f->prep.n_edge_pairs, 18 * 17 / 2 - 1);
    assert_int_equal(f->prep.stats.n_wide, 3);
}

/* ---- memory runs out ------------------------------------------------- */

static void make_all(struct mk_mesh *m)
{
    uint64_t random = 11;
    mk_cube(m);
    mk_cone(m, 10, true);
    mk_sphere(m, 8, 6);
    mk_soup(m, 150, 60, 2, &random);
    for (uint32_t i = 0; i < m->n_vertices; i += 5)
        m->normal[3 * i] = m->normal[3 * i + 1] = m->normal[3 * i + 2] = 0;
}

static void each_allocation_may_fail(void **state)
{
    struct mk_fixture *f = *state;
    size_t n_allocs;
    make_all(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    for (int uvs = 0; uvs < 3; uvs++) { /* none, usable, degenerate */
        f->desc.uvs = uvs ? f->mesh.uv : NULL;
        if (uvs == 2)
            memset(f->mesh.uv, 0, 8 * (size_t)f->mesh.n_vertices);
        f->memory.n_allocs = 0;
        prepare(f);
        n_allocs = f->memory.n_allocs;
        assert_true(f->prep.n_pairs > 0);
        hl_mesh_prep_free(&f->prep, &f->hooks);
        for (size_t i = 1; i <= 2 * n_allocs; i++) {
            f->memory.n_allocs = 0;
            f->memory.fail_at = (i + 1) / 2;
            f->memory.fail_on = i % 2;
            assert_int_equal(try(f), HL_ERR_MEMORY);
            assert_nothing(f);
        }
        f->memory.fail_at = 0;
        prepare(f); /* and a retry succeeds */
        printf("allocations failed one by one: %zu\n", n_allocs);
    }
}

/* ---- one result everywhere ------------------------------------------- */

/* Sums of every output word for inputs made by integer arithmetic alone. They
 * hold for any compiler, level of optimisation and machine with IEEE doubles
 * that rounds each operation once (no x87, no contraction); they change only
 * when preparation is meant to give something else. */
static void result_is_the_same_everywhere(void **state)
{
    struct mk_fixture *f = *state;
    uint64_t hash = UINT64_C(0xCBF29CE484222325), random = 2009;
    mk_cube(&f->mesh);
    mk_grid(&f->mesh, 5);
    mk_soup(&f->mesh, 400, 90, 3, &random);
    for (uint32_t i = 0; i < f->mesh.n_vertices; i += 7)
        f->mesh.normal[3 * i] = f->mesh.normal[3 * i + 1] =
            f->mesh.normal[3 * i + 2] = 0;
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    hash = mk_hash(hash, f->prep.source_vertex, f->prep.n_vertices);
    hash = mk_hash(hash, f->prep.group, f->prep.n_vertices);
    hash = mk_hash(hash, f->prep.normal, 3 * (size_t)f->prep.n_vertices);
    hash = mk_hash(hash, f->prep.tangent, 4 * (size_t)f->prep.n_vertices);
    hash = mk_hash(hash, f->prep.indices, f->prep.n_indices);
    hash = mk_hash(hash, f->prep.triangle_group, f->prep.n_triangles);
    hash = mk_hash(hash, f->prep.pairs, 2 * (size_t)f->prep.n_pairs);
    printf("vertices %u, groups %u, pairs %u, sum %016llx\n",
           f->prep.n_vertices, f->prep.n_groups, f->prep.n_pairs,
           (unsigned long long)hash);
    assert_true(hash == UINT64_C(0x3F8640CE2DAB2F2E));
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, mk_setup, mk_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(missing_arguments_are_refused),
        TEST(tolerance_outside_its_range_is_refused),
        TEST(empty_meshes_are_empty),
        TEST(no_indices_means_in_order),
        TEST(counts_are_checked_before_anything_is_read),
        TEST(strides_that_overflow_are_refused),
        TEST(group_limit_is_exact),
        TEST(sizes_are_checked_before_they_multiply),
        TEST(bad_triangles_are_dropped_and_counted),
        TEST(extreme_sizes_are_kept),
        TEST(interleaved_and_unaligned_arrays_read_alike),
        TEST(random_bits_are_survived),
        TEST(work_grows_with_the_mesh),
        TEST(wide_edges_are_counted),
        TEST(each_allocation_may_fail),
        TEST(result_is_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("hostile meshes", tests, NULL, NULL);
}
