/* SPDX-License-Identifier: Zlib */
/* Tangents from uvs: dP/du, mirroring, weights, and what happens where uvs
 * say nothing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>
#include "tests/mesh_kit.h"

/* One rounding to float is half an ulp, 6e-8 near 1; the doubles before it
 * are exact to 1e-15. */
#define ROUNDED 1e-7

static const float UP[3] = {0, 0, 1};

static void prepare(struct mk_fixture *f)
{
    hl_mesh_prep_free(&f->prep, &f->hooks);
    assert_int_equal(hl_mesh_prepare(&f->prep, &f->hooks, &f->desc), HL_OK);
}

static double dot(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < 3; i++)
        sum += (double)a[i] * (double)b[i];
    return sum;
}

static void check_tangent(const float *t, double x, double y, double z,
                          double w)
{
    assert_true(fabs((double)t[0] - x) < ROUNDED);
    assert_true(fabs((double)t[1] - y) < ROUNDED);
    assert_true(fabs((double)t[2] - z) < ROUNDED);
    assert_true((double)t[3] == w);
}

/* Three vertices in the plane z = 0 with the normal up. */
static void flat(struct mk_mesh *m, const float xy[6], const float uv[6])
{
    uint32_t v = m->n_vertices;
    for (int i = 0; i < 3; i++) {
        float p[3] = {xy[2 * i], xy[2 * i + 1], 0};
        mk_vertex(m, p, UP, uv[2 * i], uv[2 * i + 1]);
    }
    mk_triangle(m, v, v + 1, v + 2);
}

/* Unit tangents in the plane of their normals, handedness +1 or -1. */
static void check_frames(const struct mk_fixture *f)
{
    const struct hl_mesh_prep *p = &f->prep;
    for (uint32_t i = 0; i < p->n_vertices; i++) {
        const float *n = &p->normal[3 * i], *t = &p->tangent[4 * i];
        assert_true(fabs(dot(t, t) - 1) < 4 * ROUNDED);
        assert_true(fabs(dot(n, t)) < 4 * ROUNDED * sqrt(dot(n, n)));
        assert_true(t[3] == 1.0f || t[3] == -1.0f);
    }
}

/* ---- uvs that say something ------------------------------------------ */

static void tangent_runs_along_u(void **state)
{
    static const float xy[6] = {0, 0, 2, 0, 0, 3};
    static const float row[8][6] = {
        /* uv of the corners; below: tangent, handedness */
        {0, 0, 1, 0, 0, 1},   {0, 0, -1, 0, 0, 1}, {0, 0, 1, 0, 0, -1},
        {0, 0, -1, 0, 0, -1}, {0, 0, 0, 1, 1, 0},  {0, 0, 0, -1, 1, 0},
        {0, 0, 0, 1, -1, 0},  {5, 5, 5, 4, 4, 5}};
    static const double want[8][3] = {{1, 0, 1},  {-1, 0, -1}, {1, 0, -1},
                                      {-1, 0, 1}, {0, 1, -1},  {0, 1, 1},
                                      {0, -1, 1}, {0, -1, -1}};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 8; i++) {
        mk_free(&f->mesh);
        flat(&f->mesh, xy, row[i]);
        f->desc = mk_desc(&f->mesh);
        for (int down = 0; down < 2; down++) {
            f->desc.v_down = down;
            prepare(f);
            for (int v = 0; v < 3; v++)
                check_tangent(&f->prep.tangent[4 * v], want[i][0], want[i][1],
                              0, down ? -want[i][2] : want[i][2]);
            assert_int_equal(f->prep.stats.n_free_tangents, 0);
        }
    }
}

/* bitangent = cross(normal, tangent) w = dP/dv whichever side n is on. */
static void normal_behind_turns_the_hand(void **state)
{
    static const float xy[6] = {0, 0, 1, 0, 0, 1}, uv[6] = {0, 0, 1, 0, 0, 1};
    struct mk_fixture *f = *state;
    flat(&f->mesh, xy, uv);
    for (int i = 0; i < 3; i++)
        f->mesh.normal[3 * i + 2] = -1;
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_tangent(f->prep.tangent, 1, 0, 0, -1);
}

static void mirrored_uvs_split_the_vertex(void **state)
{
    static const float p[6][3] = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0},
                                  {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 6; i++)
        mk_vertex(&f->mesh, p[i], UP, p[i][0] * p[i][0], p[i][1]);
    for (uint32_t i = 0; i < 2; i++) {
        mk_triangle(&f->mesh, i, i + 1, i + 4);
        mk_triangle(&f->mesh, i, i + 4, i + 3);
    }
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_frames(f);
    assert_int_equal(f->prep.n_groups, 1); /* mirroring is no discontinuity */
    assert_int_equal(f->prep.n_vertices, 8);
    for (uint32_t i = 0; i < f->prep.n_indices; i++) {
        double side = i < 6 ? -1 : 1; /* u = x^2 rises away from x = 0 */
        check_tangent(&f->prep.tangent[4 * f->prep.indices[i]], side, 0, 0,
                      side);
    }
}

/* A corner of 90 degrees with dP/du along x and one of 45 with dP/du along
 * y, at one vertex by value: 90 x + 45 y, normalised. */
static void corners_weigh_by_their_angle(void **state)
{
    static const float a[6] = {0, 0, 1, 0, 0, 7};
    static const float a_uv[6] = {0, 0, 1, 0, 0, 1};
    static const float b[6] = {-0.0f, 0, -5, 0, -1, -1};
    static const float b_uv[6] = {0, 0, 0, 1, -1, 0.2f};
    struct mk_fixture *f = *state;
    double length = sqrt(90.0 * 90 + 45.0 * 45);
    flat(&f->mesh, a, a_uv);
    flat(&f->mesh, b, b_uv);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    assert_int_equal(f->prep.n_vertices, 6);
    /* uv of (-1, -1) is that of y = -1 moved by x = -1: 0.2 of b's v. */
    check_tangent(&f->prep.tangent[0], 90 / length, 45 / length, 0, 1);
    check_tangent(&f->prep.tangent[12], 90 / length, 45 / length, 0, 1);
    check_tangent(&f->prep.tangent[16], 0, 1, 0, 1);
}

/* On a sphere the sum is symmetric about the meridian, so that the tangent
 * points exactly east however the quads were cut. Positions are rounded to
 * float (6e-8) and an edge is 2 pi / 24 = 0.26 long or more at the middle
 * rows: directions are good to 6e-8 * 2 / 0.26 = 5e-7; rows beside the poles
 * have shorter edges and are left out. */
static void sphere_tangents_point_east(void **state)
{
    enum { SLICES = 24, STACKS = 12 };
    struct mk_fixture *f = *state;
    uint32_t checked = 0;
    mk_sphere(&f->mesh, SLICES, STACKS);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_frames(f);
    for (uint32_t i = 0; i < f->prep.n_vertices; i++) {
        const float *n = &f->prep.normal[3 * i], *t = &f->prep.tangent[4 * i];
        uint32_t slice = f->prep.source_vertex[i] % (SLICES + 1);
        double flat_length = sqrt((double)n[0] * (double)n[0] +
                                  (double)n[2] * (double)n[2]);
        if (flat_length < 0.6 || slice == 0 || slice == SLICES)
            continue;
        assert_true(fabs((double)t[0] - (double)n[2] / flat_length) < 5e-7);
        assert_true(fabs((double)t[1]) < 5e-7);
        assert_true(fabs((double)t[2] + (double)n[0] / flat_length) < 5e-7);
        assert_true(t[3] == -1); /* v runs south: cross(n, east) = north */
        checked++;
    }
    assert_true(checked >= 7 * (SLICES - 1));
}

/* ---- uvs that say nothing -------------------------------------------- */

static void degenerate_uvs_give_any_perpendicular(void **state)
{
    static const uint32_t nan_bits = 0x7FC00000u, inf_bits = 0xFF800000u;
    struct mk_fixture *f = *state;
    for (int kind = 0; kind < 4; kind++) {
        mk_free(&f->mesh);
        mk_sphere(&f->mesh, 12, 7);
        for (uint32_t i = 0; i < 2 * f->mesh.n_vertices; i++) {
            if (kind == 0)
                f->mesh.uv[i] = 0.25f;
            else if (kind == 1)
                memcpy(&f->mesh.uv[i], &nan_bits, sizeof nan_bits);
            else if (kind == 2)
                memcpy(&f->mesh.uv[i], &inf_bits, sizeof inf_bits);
            else
                f->mesh.uv[i] = (float)(i / 2); /* u = v: a line */
        }
        f->desc = mk_desc(&f->mesh);
        prepare(f);
        check_frames(f);
        assert_int_equal(f->prep.stats.n_free_tangents, f->prep.n_vertices);
        assert_true(f->prep.tangent[3] == 1);
    }
}

static void perpendicular_exists_for_every_normal(void **state)
{
    static const float axis[9][3] = {
        {1, 0, 0},  {0, 1, 0},    {0, 0, 1},       {0, 0, -1},     {1, 1, 0},
        {0, 1, 1},  {1e-15f, 0, 0}, {0, 1e18f, 1}, {-2, -2, -2}};
    static const float xy[6] = {0, 0, 1, 0, 0, 1}, uv[6] = {0, 0, 0, 0, 0, 0};
    struct mk_fixture *f = *state;
    for (int i = 0; i < 9; i++) {
        mk_free(&f->mesh);
        flat(&f->mesh, xy, uv);
        for (int v = 0; v < 3; v++)
            memcpy(&f->mesh.normal[3 * v], axis[i], sizeof axis[i]);
        f->desc = mk_desc(&f->mesh);
        prepare(f);
        check_frames(f);
        assert_int_equal(f->prep.stats.n_face_normals, 0);
    }
}

/* Two triangles back to back at the origin's vertex, the second's uvs turned
 * by 180 degrees: the sum is 0 there, and nowhere else. */
static void tangents_that_cancel_are_free(void **state)
{
    static const float a[6] = {0, 0, 1, 0, 0, 1}, b[6] = {0, 0, -1, 0, 0, -1};
    static const float uv[6] = {0, 0, 1, 0, 0, 1};
    struct mk_fixture *f = *state;
    flat(&f->mesh, a, uv);
    flat(&f->mesh, b, uv);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_frames(f);
    assert_int_equal(f->prep.stats.n_free_tangents, 2);
    check_tangent(&f->prep.tangent[4], 1, 0, 0, 1);
    check_tangent(&f->prep.tangent[16], -1, 0, 0, 1);
}

static void tangent_along_the_normal_is_free(void **state)
{
    static const float xy[6] = {0, 0, 1, 0, 0, 1}, uv[6] = {0, 0, 1, 0, 0, 1};
    struct mk_fixture *f = *state;
    flat(&f->mesh, xy, uv);
    for (int i = 0; i < 3; i++) {
        f->mesh.normal[3 * i] = 1;
        f->mesh.normal[3 * i + 2] = 0;
    }
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_frames(f);
    assert_int_equal(f->prep.stats.n_free_tangents, 3);
}

/* A sliver whose uvs have no area borrows its neighbour's frame, right-handed
 * ones first, and so splits nothing. */
static void degenerate_uvs_borrow_a_frame(void **state)
{
    static const float right[6] = {0, 0, 1, 0, 0, 1};
    static const float left[6] = {0, 0, -1, 0, 0, -1};
    static const float uv_right[6] = {0, 0, 1, 0, 0, 1};
    static const float uv_left[6] = {0, 0, -1, 0, 0, 1};
    struct mk_fixture *f = *state;
    static const float corner[6] = {0, 0, 0, 1, -1, 1};
    static const float zero[6] = {0, 0, 0, 0, 0, 0};
    flat(&f->mesh, right, uv_left);
    flat(&f->mesh, corner, zero);
    f->mesh.indices[3] = 0;
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_frames(f);
    assert_int_equal(f->prep.n_vertices, 5);
    assert_int_equal(f->prep.indices[3], 0);
    check_tangent(&f->prep.tangent[0], -1, 0, 0, -1);
    assert_int_equal(f->prep.stats.n_free_tangents, 2);
    flat(&f->mesh, left, uv_right);
    f->desc = mk_desc(&f->mesh);
    prepare(f);
    check_tangent(&f->prep.tangent[4 * f->prep.indices[3]], -1, 0, 0, 1);
    check_tangent(&f->prep.tangent[0], -1, 0, 0, -1);
    assert_int_equal(f->prep.stats.n_free_tangents, 2);
}

/* ---- tangents that are given ----------------------------------------- */

static void given_tangents_are_kept(void **state)
{
    static const float given[4][4] = {
        {0.6f, 0.8f, 0, -0.5f}, {2, 0, 0, 1}, {0, 0, 0, -1}, {0, 1, 0, 0}};
    struct mk_fixture *f = *state;
    static const float xy[6] = {0, 0, 1, 0, 0, 1};
    static const uint32_t inf_bits = 0x7F800000u;
    float copy[4][4];
    memcpy(copy, given, sizeof copy);
    flat(&f->mesh, xy, xy);
    mk_vertex(&f->mesh, xy, UP, 0, 0);
    for (int i = 0; i < 3; i++)
        f->mesh.position[9 + i] = i == 1 ? -1.0f : 0;
    mk_triangle(&f->mesh, 0, 1, 3);
    f->desc = mk_desc(&f->mesh);
    for (int with_uv = 0; with_uv < 2; with_uv++) {
        f->desc.uvs = with_uv ? f->mesh.uv : NULL;
        f->desc.tangents = copy;
        prepare(f);
        assert_int_equal(f->prep.n_vertices, 4);
        assert_int_equal(f->prep.stats.n_free_tangents, 1);
        check_tangent(&f->prep.tangent[0], (double)0.6f, (double)0.8f, 0, -1);
        check_tangent(&f->prep.tangent[4], 2, 0, 0, 1);
        assert_true(f->prep.tangent[11] == 1);
        check_tangent(&f->prep.tangent[12], 0, 1, 0, 1);
        assert_true(fabs(dot(&f->prep.tangent[8], UP)) < ROUNDED);
    }
    memcpy(&copy[0][1], &inf_bits, sizeof inf_bits);
    prepare(f);
    assert_int_equal(f->prep.stats.n_free_tangents, 2);
}

static void without_uvs_there_are_no_tangents(void **state)
{
    struct mk_fixture *f = *state;
    mk_cube(&f->mesh);
    f->desc = mk_desc(&f->mesh);
    f->desc.uvs = NULL;
    prepare(f);
    assert_null(f->prep.tangent);
    assert_int_equal(f->prep.stats.n_free_tangents, 0);
    assert_int_equal(f->prep.n_vertices, 24);
}

#define TEST(name) \
    cmocka_unit_test_setup_teardown(name, mk_setup, mk_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(tangent_runs_along_u),
        TEST(normal_behind_turns_the_hand),
        TEST(mirrored_uvs_split_the_vertex),
        TEST(corners_weigh_by_their_angle),
        TEST(sphere_tangents_point_east),
        TEST(degenerate_uvs_give_any_perpendicular),
        TEST(perpendicular_exists_for_every_normal),
        TEST(tangents_that_cancel_are_free),
        TEST(tangent_along_the_normal_is_free),
        TEST(degenerate_uvs_borrow_a_frame),
        TEST(given_tangents_are_kept),
        TEST(without_uvs_there_are_no_tangents),
    };
    return cmocka_run_group_tests_name("mesh tangents", tests, NULL, NULL);
}
