/* SPDX-License-Identifier: Zlib */
/* Preparation of meshes for shadow volumes: welding, edges, what is refused,
 * memory, and that the work is linear. */
#include <stdlib.h>
#include <string.h>
#include "tests/shadow_kit.h"

static const float UP[3] = {0, 0, 1};

static struct hl_shadow_mesh_desc desc_of(const struct sv_rig *r)
{
    struct hl_shadow_mesh_desc d = {r->input.position, 0, r->input.indices,
                                    r->input.n_indices, r->input.n_vertices};
    return d;
}

static enum hl_result try(struct sv_rig *r,
                          const struct hl_shadow_mesh_desc *d)
{
    hl_shadow_mesh_free(&r->mesh, &r->hooks);
    memset(&r->mesh, 0x77, sizeof r->mesh);
    enum hl_result result = hl_shadow_mesh_prepare(&r->mesh, &r->hooks, d);
    static const struct hl_shadow_mesh nothing;
    if (result != HL_OK) {
        assert_memory_equal(&r->mesh, &nothing, sizeof nothing);
        assert_int_equal(r->memory.n_live, 0);
    }
    return result;
}

/* Every edge has the faces that go along it, each the right way. */
static void check_edges(const struct hl_shadow_mesh *m)
{
    uint32_t n_refs = 0;
    for (uint32_t e = 0; e < m->n_edges; e++) {
        const struct hl_shadow_edge *edge = &m->edges[e];
        bool wide = e >= m->n_narrow;
        uint32_t both[2] = {edge->first, edge->second};
        const uint32_t *ref = wide ? &m->refs[edge->first] : both;
        assert_true(edge->a < edge->b && edge->b < m->n_vertices);
        for (uint32_t k = 0; k < (wide ? edge->second : 2); k++) {
            if (!wide && k == 1 && ref[k] == 2 * m->n_faces)
                continue;
            const uint32_t *c = &m->corners[3 * (ref[k] / 2)];
            uint32_t a = ref[k] & 1 ? edge->b : edge->a;
            uint32_t b = ref[k] & 1 ? edge->a : edge->b;
            assert_true(ref[k] < 2 * m->n_faces);
            assert_true((c[0] == a && c[1] == b) || (c[1] == a && c[2] == b) ||
                        (c[2] == a && c[0] == b));
            n_refs++;
        }
        assert_true(!wide || edge->second > 2);
        for (uint32_t k = 0; k < e; k++)
            assert_false(m->edges[k].a == edge->a && m->edges[k].b == edge->b);
    }
    assert_int_equal(n_refs, 3 * m->n_faces);
}

static void bounds_are_those_of_the_faces(void **state)
{
    struct sv_rig *r = *state;
    const float far[3] = {-99, 99, 0};
    for (int side = -1; side < 2; side += 2) {
        sv_drop(r);
        mk_cube(&r->input);
        for (uint32_t k = 0; k < 3 * r->input.n_vertices; k++)
            r->input.position[k] += 5 * (float)side;
        mk_triangle(&r->input, 0, 0, mk_vertex(&r->input, far, UP, 0, 0));
        sv_prepare(r);
        for (int i = 0; i < 3; i++) {
            assert_true(r->mesh.min[i] == 5 * (float)side - 1);
            assert_true(r->mesh.max[i] == 5 * (float)side + 1);
        }
    }
}

static void edges_hold_their_faces(void **state)
{
    struct sv_rig *r = *state;
    mk_cube(&r->input);
    sv_prepare(r);
    check_edges(&r->mesh);
    assert_int_equal(r->mesh.n_narrow, 18);
    assert_null(r->mesh.refs);
    for (int i = 0; i < 8; i++) {
        sv_drop(r);
        mk_soup(&r->input, 60, 9, 1, &r->random);
        sv_prepare(r);
        check_edges(&r->mesh);
        assert_true(r->mesh.stats.n_wide > 3);
        assert_true(r->mesh.n_narrow < r->mesh.n_edges);
    }
}

/* Three pages of a book, one turned: the light sees at most two of the three
 * go one way. */
static void the_bound_counts_directions(void **state)
{
    struct sv_rig *r = *state;
    const float a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
    const float c[3][3] = {{1, 0, 0}, {1, 1, 0}, {1, 2, 0}};
    mk_flat(&r->input, a, b, c[0], UP);
    mk_flat(&r->input, a, b, c[1], UP);
    mk_flat(&r->input, b, a, c[2], UP);
    sv_prepare(r);
    check_edges(&r->mesh);
    assert_int_equal(r->mesh.stats.n_wide, 1);
    assert_int_equal(r->mesh.stats.n_open, 6);
    assert_int_equal(r->mesh.max_sides, 6 + 2);
    assert_int_equal(hl_shadow_max_indices(&r->mesh, HL_SHADOW_CLOSED),
                     6 * 3 + 6 * 8);
    assert_int_equal(hl_shadow_max_indices(&r->mesh, HL_SHADOW_SIDES |
                                                     HL_SHADOW_TWO_SIDED),
                     6 * 9);
    assert_int_equal(hl_shadow_max_indices(&r->mesh, HL_SHADOW_BACK), 9);
}

static void positions_weld_by_value(void **state)
{
    struct sv_rig *r = *state;
    const float a[3] = {0, 0, 0}, minus[3] = {-0.0f, 0, -0.0f};
    const float b[3] = {1, 0, 0}, c[3] = {0, 1, 0}, d[3] = {0, -1, 0};
    const float near[3] = {1.0000001f, 0, 0};
    mk_flat(&r->input, a, b, c, UP);
    mk_flat(&r->input, b, minus, d, UP);
    sv_prepare(r);
    assert_int_equal(r->mesh.n_vertices, 4);
    assert_int_equal(r->mesh.n_edges, 5);
    assert_int_equal(r->mesh.stats.n_open, 4);
    const float first[8] = {0, 0, 0, 1, 0, 0, 0, 0};
    assert_memory_equal(r->mesh.vertices, first, sizeof first);
    const float second[8] = {1, 0, 0, 1, 1, 0, 0, 0};
    assert_memory_equal(r->mesh.vertices + 8, second, sizeof second);
    mk_flat(&r->input, near, a, d, UP); /* nearly is not the same */
    sv_prepare(r);
    assert_int_equal(r->mesh.n_vertices, 5);
}

static void strides_and_missing_indices(void **state)
{
    enum { STRIDE = 37 };
    struct sv_rig *r = *state;
    mk_soup(&r->input, 30, 10, 1, &r->random); /* its indices are 0, 1, 2 */
    sv_prepare(r);
    uint32_t n = r->mesh.n_vertices, faces = r->mesh.n_faces;
    float *kept = malloc(32 * (size_t)n);
    unsigned char *bytes = malloc((size_t)STRIDE * r->input.n_vertices + 1);
    assert_non_null(kept);
    assert_non_null(bytes);
    memcpy(kept, r->mesh.vertices, 32 * (size_t)n);
    for (size_t v = 0; v < r->input.n_vertices; v++)
        memcpy(bytes + 1 + STRIDE * v, &r->input.position[3 * v], 12);
    struct hl_shadow_mesh_desc d = {bytes + 1, STRIDE, NULL, 0,
                                    r->input.n_vertices};
    assert_int_equal(try(r, &d), HL_OK);
    assert_int_equal(r->mesh.n_faces, faces);
    assert_int_equal(r->mesh.n_vertices, n);
    assert_memory_equal(r->mesh.vertices, kept, 32 * (size_t)n);
    d.n_vertices = d.n_indices = 8; /* two whole triangles and a bit */
    assert_int_equal(try(r, &d), HL_OK);
    assert_int_equal(r->mesh.stats.n_partial, 1);
    const uint32_t last[3] = {0, 1, r->input.n_vertices - 1};
    d = (struct hl_shadow_mesh_desc){bytes + 1, STRIDE, last, 3, last[2]};
    assert_int_equal(try(r, &d), HL_OK);
    assert_int_equal(r->mesh.stats.n_out_of_range, 1);
    free(kept);
    free(bytes);
}

static void bad_calls_are_refused(void **state)
{
    struct sv_rig *r = *state;
    mk_cube(&r->input);
    const struct hl_shadow_mesh_desc good = desc_of(r);
    struct hl_shadow_mesh_desc d = good;
    assert_int_equal(hl_shadow_mesh_prepare(NULL, &r->hooks, &d),
                     HL_ERR_INVALID);
    assert_int_equal(try(r, NULL), HL_ERR_INVALID);
    assert_int_equal(hl_shadow_mesh_prepare(&r->mesh, NULL, &d),
                     HL_ERR_INVALID);
    d.positions = NULL;
    assert_int_equal(try(r, &d), HL_ERR_INVALID);
    d = good;
    d.indices = NULL;
    assert_int_equal(try(r, &d), HL_ERR_INVALID);
    d = good;
    d.n_vertices = HL_SHADOW_MAX_INDICES + 1;
    assert_int_equal(try(r, &d), HL_ERR_LIMIT);
    d = good;
    d.n_indices = HL_SHADOW_MAX_INDICES + 1;
    assert_int_equal(try(r, &d), HL_ERR_LIMIT);
    d = good;
    d.position_stride = SIZE_MAX / 24 + 1;
    assert_int_equal(try(r, &d), HL_ERR_LIMIT);
    assert_int_equal(r->memory.n_allocs, 0);
    hl_shadow_mesh_free(NULL, &r->hooks);
}

static void failing_memory_leaves_nothing(void **state)
{
    struct sv_rig *r = *state;
    uint32_t failed = 0;
    mk_soup(&r->input, 60, 60, 1, &r->random);
    const struct hl_shadow_mesh_desc d = desc_of(r);
    for (size_t at = 1;; at++) {
        r->memory.n_allocs = 0;
        r->memory.fail_at = at;
        enum hl_result result = try(r, &d);
        if (r->memory.n_allocs < at) {
            assert_int_equal(result, HL_OK);
            break;
        }
        assert_int_equal(result, HL_ERR_MEMORY);
        failed++;
    }
    assert_true(failed > 10);
}

/* Steps and bytes of a grid, of a book of n pages on one edge. */
struct work { uint64_t steps; size_t bytes; };

static struct work measure(struct sv_rig *r, uint32_t n, bool book)
{
    sv_drop(r);
    const float a[3] = {0, 0, 0}, b[3] = {0, 0, 1};
    if (!book)
        mk_grid(&r->input, n);
    for (uint32_t i = 0; i < 2 * n * n && book; i++) {
        const float c[3] = {1, (float)i, 0};
        mk_flat(&r->input, a, b, c, UP);
    }
    r->memory.n_bytes = 0;
    sv_prepare(r);
    assert_int_equal(r->mesh.n_faces, 2 * n * n);
    struct work w = {r->mesh.stats.n_steps, r->memory.n_bytes};
    return w;
}

/* Four times the faces are at most eight times the work: growth by powers of
 * two is up to twice as much either time, and n^2 would be 16. */
static void work_is_linear(void **state)
{
    for (int book = 0; book < 2; book++) {
        struct work one = measure(*state, 24, book), four =
            measure(*state, 48, book);
        assert_true(four.steps < 8 * one.steps);
        assert_true(four.bytes < 8 * one.bytes);
    }
}

/* Any bits as floats, indices a little past the end. */
static void random_bits_are_survived(void **state)
{
    struct sv_rig *r = *state;
    uint32_t kept = 0;
    for (int i = 0; i < 200; i++) {
        sv_drop(r);
        mk_soup(&r->input, 40, 12, 1, &r->random);
        for (uint32_t k = 0; k < 3 * r->input.n_vertices; k++) {
            uint32_t bits = mk_random(&r->random);
            if (mk_below(&r->random, 16) == 0)
                memcpy(&r->input.position[k], &bits, 4);
        }
        for (uint32_t k = 0; k < r->input.n_indices; k++)
            if (mk_below(&r->random, 8) == 0)
                r->input.indices[k] =
                    mk_below(&r->random, r->input.n_vertices + 3);
        sv_prepare(r);
        check_edges(&r->mesh);
        sv_random_light(r, (float)(i % 2));
        sv_cast(r);
        sv_check_chain(r);
        kept += r->mesh.n_faces;
    }
    assert_true(kept > 1000); /* the test is not about empty meshes */
}

int main(void)
{
#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, sv_setup, sv_teardown)
    const struct CMUnitTest tests[] = {
        TEST(bounds_are_those_of_the_faces),
        TEST(edges_hold_their_faces),
        TEST(the_bound_counts_directions),
        TEST(positions_weld_by_value),
        TEST(strides_and_missing_indices),
        TEST(bad_calls_are_refused),
        TEST(failing_memory_leaves_nothing),
        TEST(work_is_linear),
        TEST(random_bits_are_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
