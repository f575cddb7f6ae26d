/* SPDX-License-Identifier: Zlib */
/* Shadow volumes of all kinds of meshes against the oracles of shadow_kit.h,
 * which faces are lit, and what is written where. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/shadow_kit.h"

/* ---- meshes ------------------------------------------------------------ */

static const float UP[3] = {0, 0, 1};

static void torus(struct mk_mesh *m, uint32_t around, uint32_t across)
{
    for (uint32_t i = 0; i < around * across; i++) {
        double u = 6.283185307179586 * (i / across) / around;
        double v = 6.283185307179586 * (i % across) / across;
        const float p[3] = {(float)((1.5 + 0.5 * cos(v)) * cos(u)),
                            (float)((1.5 + 0.5 * cos(v)) * sin(u)),
                            (float)(0.5 * sin(v))};
        mk_vertex(m, p, UP, 0, 0);
    }
    for (uint32_t i = 0; i < around * across; i++) {
        uint32_t a = i / across, b = i % across;
        uint32_t a1 = (a + 1) % around, b1 = (b + 1) % across;
        mk_triangle(m, a * across + b, a1 * across + b, a1 * across + b1);
        mk_triangle(m, a * across + b, a1 * across + b1, a * across + b1);
    }
}

/* Every position by its value, so that seams stay closed. */
static void displace(struct mk_mesh *m)
{
    for (uint32_t v = 0; v < m->n_vertices; v++) {
        float *p = &m->position[3 * v], key[3];
        for (int i = 0; i < 3; i++)
            key[i] = p[i] + 0.0f; /* the two zeros are one */
        uint64_t state = mk_hash(1, key, 3);
        float scale = 0.5f + mk_unit(&state);
        for (int i = 0; i < 3; i++)
            p[i] *= scale;
    }
}

static void turn(struct mk_mesh *m, uint32_t t)
{
    uint32_t b = m->indices[3 * t + 1];
    m->indices[3 * t + 1] = m->indices[3 * t + 2];
    m->indices[3 * t + 2] = b;
}

/* All triangles once more, turned over or not, shifted. */
static void again(struct mk_mesh *m, bool over, float shift)
{
    uint32_t n = m->n_indices / 3;
    for (uint32_t t = 0; t < n; t++) {
        uint32_t v[3];
        for (uint32_t i = 0; i < 3; i++) {
            float p[3];
            memcpy(p, &m->position[3 * m->indices[3 * t + i]], sizeof p);
            for (int k = 0; k < 3; k++)
                p[k] += shift;
            v[i] = mk_vertex(m, p, UP, 0, 0);
        }
        mk_triangle(m, v[0], v[over ? 2 : 1], v[over ? 1 : 2]);
    }
}

static void closed_meshes(void **state)
{
    struct sv_rig *r = *state;
    struct sv_seen seen;
    mk_cube(&r->input);
    seen = sv_compare(r, 8, 60);
    assert_int_equal(r->mesh.n_vertices, 8);
    assert_int_equal(r->mesh.n_edges, 18);
    assert_int_equal(r->mesh.max_sides, 18);
    sv_drop(r);
    mk_sphere(&r->input, 12, 8);
    sv_compare(r, 8, 40);
    assert_int_equal(r->mesh.stats.n_open, 0);
    sv_drop(r);
    torus(&r->input, 14, 8);
    seen = sv_compare(r, 8, 40);
    assert_true(seen.deeper > 20);
    sv_drop(r);
    mk_sphere(&r->input, 12, 8);
    displace(&r->input);
    seen = sv_compare(r, 8, 40);
    assert_true(seen.deeper > 20);
    assert_int_equal(r->mesh.stats.n_open + r->mesh.stats.n_turned +
                     r->mesh.stats.n_wide, 0);
}

static void open_sheets(void **state)
{
    struct sv_rig *r = *state;
    mk_grid(&r->input, 6);
    for (uint32_t v = 0; v < r->input.n_vertices; v++) /* bent */
        r->input.position[3 * v + 2] =
            r->input.position[3 * v] * r->input.position[3 * v];
    sv_compare(r, 12, 60);
    assert_int_equal(r->mesh.stats.n_open, 24);
    sv_drop(r);
    mk_cube(&r->input);
    r->input.n_indices -= 6; /* a box without a lid */
    sv_compare(r, 8, 60);
    assert_int_equal(r->mesh.stats.n_open, 4);
}

static void any_triangles(void **state)
{
    struct sv_rig *r = *state;
    for (int i = 0; i < 6; i++) {
        sv_drop(r);
        mk_soup(&r->input, 40, 8, 1, &r->random);
        struct sv_seen seen = sv_compare(r, 8, 40);
        assert_true(r->mesh.stats.n_wide > 3);
        assert_true(seen.deeper > 40);
    }
    sv_drop(r);
    mk_sphere(&r->input, 10, 6);
    for (uint32_t t = 0; t < r->input.n_indices / 3; t += 3)
        turn(&r->input, t);
    sv_compare(r, 8, 60);
    assert_true(r->mesh.stats.n_turned > 10);
}

static void intersecting_and_doubled_meshes(void **state)
{
    struct sv_rig *r = *state;
    mk_cube(&r->input);
    again(&r->input, false, 0.7f); /* cuts the first */
    assert_true(sv_compare(r, 8, 60).deeper > 40);
    sv_drop(r);
    mk_sphere(&r->input, 10, 6);
    again(&r->input, false, 0);
    struct sv_seen seen = sv_compare(r, 8, 60);
    assert_int_equal(seen.deeper, seen.in_shadow);
    sv_drop(r);
    mk_grid(&r->input, 3);
    again(&r->input, true, 0); /* a sheet with two sides */
    sv_compare(r, 8, 60);
    assert_int_equal(r->mesh.stats.n_open, 0);
}

static void broken_triangles_cast_nothing(void **state)
{
    struct sv_rig *r = *state;
    const float bad[3][3] = {{NAN, 0, 0}, {0, INFINITY, 0}, {0, 0, -INFINITY}};
    mk_cube(&r->input);
    for (int i = 0; i < 3; i++)
        mk_triangle(&r->input, 0, 1, mk_vertex(&r->input, bad[i], UP, 0, 0));
    mk_triangle(&r->input, 3, 3, 5);
    mk_triangle(&r->input, 0, 6, 0);
    mk_triangle(&r->input, 0, 1, 1000);
    mk_triangle(&r->input, UINT32_MAX, 1, 2);
    sv_compare(r, 8, 60);
    assert_int_equal(r->mesh.n_faces, 12);
    assert_int_equal(r->mesh.n_edges, 18);
    assert_int_equal(r->mesh.stats.n_non_finite, 3);
    assert_int_equal(r->mesh.stats.n_degenerate, 2);
    assert_int_equal(r->mesh.stats.n_out_of_range, 2);
}

/* ---- facing ------------------------------------------------------------ */

/* Corners within 2^18 and the light within 13 times that are exact in floats,
 * and the determinant, three products of a number of at most 2^39 with one
 * of at most 2^21.6, in 64 bits; doubles round those products. */
enum { SPAN = 262144 };

static int64_t whole(struct sv_rig *r, int32_t span)
{
    return (int32_t)mk_below(&r->random, (uint32_t)(2 * span + 1)) - span;
}

static int64_t side_of(int64_t p[3][3], const int64_t l[3])
{
    int64_t a[3], b[3], d[3];
    for (int i = 0; i < 3; i++) {
        a[i] = p[1][i] - p[0][i];
        b[i] = p[2][i] - p[0][i];
        d[i] = l[i] - p[0][i];
    }
    return d[0] * (a[1] * b[2] - a[2] * b[1]) +
           d[1] * (a[2] * b[0] - a[0] * b[2]) +
           d[2] * (a[0] * b[1] - a[1] * b[0]);
}

/* Three corners, and a light in their plane or up to `off` beside it:
 * p[0] + i (p[1] - p[0]) + j (p[2] - p[0]) is exact. */
static int64_t lit_or_not(struct sv_rig *r, int32_t span, int32_t off)
{
    int64_t p[3][3], l[3], i = whole(r, 3), j = whole(r, 3);
    mk_free(&r->input);
    for (int k = 0; k < 3; k++) {
        float f[3];
        for (int c = 0; c < 3; c++)
            f[c] = (float)(p[k][c] = whole(r, span));
        mk_vertex(&r->input, f, UP, 0, 0);
    }
    for (int c = 0; c < 3; c++) {
        l[c] = p[0][c] + i * (p[1][c] - p[0][c]) + j * (p[2][c] - p[0][c]) +
               whole(r, off);
        r->light[c] = (float)l[c];
    }
    mk_triangle(&r->input, 0, 1, 2);
    r->light[3] = 1;
    sv_prepare(r);
    sv_cast(r);
    return side_of(p, l);
}

static void a_face_is_lit_by_its_front_alone(void **state)
{
    struct sv_rig *r = *state;
    uint32_t lit = 0, dark = 0, edge_on = 0;
    r->parts = HL_SHADOW_FRONT;
    for (int i = 0; i < 4000; i++) {
        /* What facing() holds for edge-on: below 16 2^-53 spread (|x| + |y| +
         * |z|), so 2^-49 2^39 3 2^21.6; of corners within 4, below 1. */
        int64_t doubt = i % 2 ? 10000 : 0;
        int64_t side = lit_or_not(r, i % 2 ? SPAN : 4, i % 4 / 2);
        if (side > doubt)
            assert_int_equal(r->counts.n_lit, 1);
        else if (side <= 0)
            assert_int_equal(r->counts.n_lit, 0);
        lit += side > doubt;
        dark += side < 0;
        edge_on += side == 0;
    }
    assert_true(lit > 500 && dark > 500 && edge_on > 1000);
}

/* The plane of a cube's face, its edges and corners, its inside. */
static void edge_on_is_unlit(void **state)
{
    struct sv_rig *r = *state;
    mk_cube(&r->input);
    sv_prepare(r);
    static const struct { float light[4]; uint32_t lit; } row[] = {
        {{3, 1, 0, 1}, 2}, {{3, 1, 1, 1}, 2}, {{1, 1, 1, 1}, 0},
        {{0, 0, 0, 1}, 0}, {{1, 0, 0, 1}, 0}, {{3, 1.0000001f, 0, 1}, 4},
        {{3, 0.9999999f, 0, 1}, 2}, {{1, 0, 0, 0}, 2}, {{1, 1, 0, 0}, 4},
        /* Less than doubles can tell from nothing counts as that. */
        {{1, 0, 1e-9f, 0}, 4}, {{1, 0, 1e-30f, 0}, 2}, {{2, 2, -2, 1}, 6}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        memcpy(r->light, row[i].light, sizeof r->light);
        sv_cast(r);
        sv_check_chain(r);
        assert_int_equal(r->counts.n_lit, row[i].lit);
    }
}

/* ---- what is written --------------------------------------------------- */

static void parts_follow_each_other(void **state)
{
    struct sv_rig *r = *state;
    mk_soup(&r->input, 60, 12, 1, &r->random);
    sv_prepare(r);
    for (unsigned w = 0; w < 2; w++) {
        sv_random_light(r, (float)w);
        r->parts = HL_SHADOW_CLOSED;
        sv_cast(r);
        struct hl_shadow_counts all = r->counts;
        uint32_t *kept = malloc(4 * (size_t)r->n), at = 0;
        assert_non_null(kept);
        memcpy(kept, r->indices, 4 * (size_t)r->n);
        for (unsigned part = 1; part < 8; part *= 2) {
            r->parts = part;
            sv_cast(r);
            assert_memory_equal(r->indices, kept + at, 4 * (size_t)r->n);
            at += r->n;
        }
        assert_int_equal(at, all.n_front + all.n_sides + all.n_back);
        assert_int_equal(all.n_front, 3 * all.n_lit);
        assert_int_equal(all.n_back, w ? 3 * all.n_lit : 0);
        free(kept);
    }
}

static enum hl_result try_room(struct sv_rig *r, size_t room, size_t scratch)
{
    return hl_shadow_volume_write(&r->counts, room ? r->indices : NULL, room,
                                  r->scratch, scratch, &r->mesh, r->light,
                                  r->parts);
}

static void too_little_room_writes_nothing(void **state)
{
    struct sv_rig *r = *state;
    mk_soup(&r->input, 60, 12, 1, &r->random);
    sv_prepare(r);
    size_t bytes = hl_shadow_scratch(&r->mesh);
    for (unsigned i = 0; i < 8; i++) {
        sv_random_light(r, (float)(i % 2));
        r->parts = HL_SHADOW_CLOSED | (i & 2 ? HL_SHADOW_TWO_SIDED : 0);
        sv_cast(r);
        struct hl_shadow_counts counts = r->counts;
        size_t n = r->n, room = hl_shadow_max_indices(&r->mesh, r->parts);
        uint32_t *kept = malloc(4 * n);
        assert_non_null(kept);
        assert_true(n < room); /* so that counting comes first below */
        memcpy(kept, r->indices, 4 * n);
        memset(r->indices, 0x5A, 4 * room);
        assert_int_equal(try_room(r, n - 1, bytes), HL_ERR_LIMIT);
        assert_memory_equal(&r->counts, &counts, sizeof counts);
        assert_int_equal(try_room(r, 0, bytes), HL_ERR_LIMIT);
        assert_memory_equal(&r->counts, &counts, sizeof counts);
        assert_int_equal(try_room(r, room, bytes - 1), HL_ERR_LIMIT);
        assert_int_equal(r->counts.n_lit, 0);
        for (size_t k = 0; k < room; k++)
            assert_int_equal(r->indices[k], 0x5A5A5A5Au);
        assert_int_equal(try_room(r, n, bytes), HL_OK);
        assert_memory_equal(&r->counts, &counts, sizeof counts);
        assert_memory_equal(r->indices, kept, 4 * n);
        assert_int_equal(r->indices[n], 0x5A5A5A5Au);
        free(kept);
    }
}

static void bad_lights_are_refused(void **state)
{
    struct sv_rig *r = *state;
    mk_cube(&r->input);
    sv_prepare(r);
    static const float bad[][4] = {
        {NAN, 0, 0, 1}, {0, INFINITY, 0, 1}, {0, 0, -INFINITY, 0},
        {0, 0, 0, NAN}, {0, 0, 2, 0.5f}, {0, 0, 2, -1}, {0, 0, 0, 0}};
    size_t room = hl_shadow_max_indices(&r->mesh, r->parts);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        memcpy(r->light, bad[i], sizeof r->light);
        assert_int_equal(try_room(r, room, hl_shadow_scratch(&r->mesh)),
                         HL_ERR_INVALID);
        assert_int_equal(r->counts.n_lit, 0);
    }
    r->light[1] = 3;
    assert_int_equal(hl_shadow_volume_write(&r->counts, NULL, 9, r->scratch,
                                            25, &r->mesh, r->light, 7),
                     HL_ERR_INVALID);
}

static void an_empty_mesh_casts_nothing(void **state)
{
    struct sv_rig *r = *state;
    sv_prepare(r);
    sv_random_light(r, 1);
    sv_cast(r);
    assert_int_equal(r->n, 0);
    assert_int_equal(r->counts.n_lit, 0);
}

/* The sum was taken on x86-64: it has no function of a library in it, and
 * the bytes are compared as numbers. */
static void every_machine_writes_the_same(void **state)
{
    struct sv_rig *r = *state;
    uint64_t hash = UINT64_C(0xCBF29CE484222325);
    r->random = 1;
    mk_soup(&r->input, 300, 40, 1, &r->random);
    for (unsigned i = 0; i < 8; i++) {
        sv_prepare(r);
        sv_random_light(r, (float)(i / 2 % 2));
        r->parts = i % 2 ? HL_SHADOW_CLOSED
                         : HL_SHADOW_CLOSED | HL_SHADOW_TWO_SIDED;
        sv_cast(r);
        hash = mk_hash(hash, r->indices, r->n);
        hash = mk_hash(hash, r->mesh.vertices, 8 * r->mesh.n_vertices);
    }
    if (hash != UINT64_C(0x45F814DAD1292F21))
        fail_msg("0x%llX", (unsigned long long)hash);
}

/* ---- the light in model space ------------------------------------------ */

static void lights_move_to_model_space(void **state)
{
    struct sv_rig *r = *state;
    for (int i = 0; i < 200; i++) {
        struct hl_light l;
        float world[16] = {0}, at[4];
        double back[3], size = 0;
        memset(&l, 0, sizeof l);
        l.kind = i % 2 ? HL_DIRECTIONAL : HL_SPOT;
        for (int k = 0; k < 3; k++) {
            world[5 * k] = i % 3 ? 3 : -2; /* dominant: well conditioned */
            l.position[k] = (float)ck_between(&r->random, -9, 9);
            l.direction[k] = (float)ck_between(&r->random, -1, 1);
        }
        for (int k = 0; k < 16; k++)
            world[k] += k % 4 < 3 ? (float)ck_between(&r->random, -.5, .5) : 0;
        world[15] = 1;
        assert_true(hl_shadow_light(at, world, &l));
        assert_true(at[3] == (float)(i % 2 == 0));
        for (int k = 0; k < 3; k++) {
            back[k] = (double)at[3] * (double)world[12 + k];
            for (int c = 0; c < 3; c++)
                back[k] += (double)world[4 * c + k] * (double)at[c];
        }
        size = i % 2 ? sv_length(back) : 1;
        double unit = 0;
        for (int k = 0; k < 3; k++)
            unit += (double)l.direction[k] * (double)l.direction[k];
        /* Each of three floats of at most 15 is off by half a unit of its
         * last place, 2^-21, times a matrix entry of at most 3.5. */
        for (int k = 0; k < 3; k++)
            ck_near(back[k] / size,
                    i % 2 ? -(double)l.direction[k] / sqrt(unit)
                          : (double)l.position[k], 3 * 3.5 / 2097152);
    }
}

static void a_flat_world_has_no_model_light(void **state)
{
    (void)state;
    struct hl_light l;
    float world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1};
    float at[4] = {7, 7, 7, 7};
    memset(&l, 0, sizeof l);
    l.position[2] = 1;
    for (int i = 0; i < 2; i++) {
        l.kind = i ? HL_DIRECTIONAL : HL_POINT;
        l.direction[1] = -1;
        assert_false(hl_shadow_light(at, world, &l));
        assert_true(at[0] == 7 && at[3] == 7);
    }
    world[10] = 1e-20f; /* a scale that floats hold: the direction stays */
    assert_true(hl_shadow_light(at, world, &l));
    assert_true(at[1] == 1 && at[3] == 0);
    world[0] = NAN;
    assert_false(hl_shadow_light(at, world, &l));
}

int main(void)
{
#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, sv_setup, sv_teardown)
    const struct CMUnitTest tests[] = {
        TEST(closed_meshes),
        TEST(open_sheets),
        TEST(any_triangles),
        TEST(intersecting_and_doubled_meshes),
        TEST(broken_triangles_cast_nothing),
        TEST(a_face_is_lit_by_its_front_alone),
        TEST(edge_on_is_unlit),
        TEST(parts_follow_each_other),
        TEST(too_little_room_writes_nothing),
        TEST(bad_lights_are_refused),
        TEST(an_empty_mesh_casts_nothing),
        TEST(every_machine_writes_the_same),
        TEST(lights_move_to_model_space),
        TEST(a_flat_world_has_no_model_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
