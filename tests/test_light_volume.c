/* SPDX-License-Identifier: Zlib */
/* Meshes of light volumes: closed, turned outward, around all that a light
 * reaches. */
#include <math.h>
#include <string.h>
#include "core/light_volume.h"
#include "tests/check.h"

static struct hl_light_meshes meshes;

static int make(void **state)
{
    (void)state;
    memset(&meshes, 0xA5, sizeof meshes);
    hl_light_meshes_make(&meshes);
    return 0;
}

static const float *corner(uint32_t i)
{
    return meshes.vertex[meshes.index[i]];
}

/* Twice the face's outward distance from p, a share of its size: positive
 * inside. */
static double inside(const double v[3][3], const double p[3])
{
    double a[3], b[3], n[3], d = 0, l = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = v[1][k] - v[0][k];
        b[k] = v[2][k] - v[0][k];
    }
    for (int k = 0; k < 3; k++) {
        n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] *
               b[(k + 1) % 3];
        d += n[k] * (v[0][k] - p[k]);
        l += n[k] * n[k];
    }
    return d / sqrt(l);
}

static void face_of(double v[3][3], uint32_t i, const float m[16])
{
    for (uint32_t c = 0; c < 3; c++)
        for (int r = 0; r < 3; r++) {
            const float *p = corner(i + c);
            v[c][r] = 0;
            for (int k = 0; k < 4; k++)
                v[c][r] += (double)m[4 * k + r] * (double)p[k];
        }
}

/* Every edge of a face is that of one other, the other way. */
static void check_closed(uint32_t first, uint32_t count)
{
    for (uint32_t i = first; i < first + count; i++) {
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1, back = 0, same = 0;
        for (uint32_t k = first; k < first + count; k++) {
            uint32_t l = k % 3 == 2 ? k - 2 : k + 1;
            same += meshes.index[k] == meshes.index[i] &&
                    meshes.index[l] == meshes.index[next];
            back += meshes.index[k] == meshes.index[next] &&
                    meshes.index[l] == meshes.index[i];
        }
        assert_int_equal(same, 1);
        assert_int_equal(back, 1);
    }
}

static void meshes_are_closed(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < HL_LIGHT_VERTICES; i++)
        assert_true(meshes.vertex[i][3] == 1);
    for (uint32_t i = 0; i < HL_LIGHT_INDICES; i++)
        assert_true(meshes.index[i] < HL_LIGHT_VERTICES);
    check_closed(HL_LIGHT_SPHERE, HL_LIGHT_SPHERE_N);
    check_closed(HL_LIGHT_CONE, HL_LIGHT_CONE_N);
}

/* No vertex much farther out than it must be: the icosahedron's faces cut
 * into four are 0.9 of the radius from the centre or more. */
static void spheres_are_tight(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < HL_LIGHT_SPHERE_N; i++) {
        const float *p = corner(i);
        double r = sqrt((double)p[0] * (double)p[0] +
                        (double)p[1] * (double)p[1] +
                        (double)p[2] * (double)p[2]);
        assert_true(r > 1 && r < 1.12);
    }
}

static void unit(float v[3], uint64_t *seed)
{
    double l;
    do {
        l = 0;
        for (int k = 0; k < 3; k++) {
            v[k] = (float)ck_between(seed, -1, 1);
            l += (double)v[k] * (double)v[k];
        }
    } while (l > 1 || l < 1e-3);
    for (int k = 0; k < 3; k++)
        v[k] = (float)((double)v[k] / sqrt(l));
}

/* Axes and their neighbours, where a fixed "up" would fail, and any other. */
static void some_direction(float v[3], uint64_t *seed, uint32_t i)
{
    unit(v, seed);
    if (i % 2)
        return;
    for (int k = 0; k < 3; k++)
        v[k] = (i % 4 ? 1e-6f * v[k] : 0.0f) +
               ((uint32_t)k == i / 4 % 3 ? i % 8 < 4 ? 1.0f : -1.0f : 0.0f);
}

static struct hl_light some_light(uint64_t *seed, uint32_t i)
{
    static const double outer[] = { 0, 1e-4, 0.3, 0.8, 0.98, 0.99, 1.2, 1.5,
                                    1.57079, 1.6, 3.1416 };
    struct hl_light l;
    memset(&l, 0, sizeof l);
    l.kind = i % 3 ? HL_SPOT : HL_POINT;
    for (int k = 0; k < 3; k++)
        l.position[k] = (float)ck_between(seed, -20, 20);
    l.radius = (float)ck_between(seed, 0.5, 30);
    l.outer = i % 5 ? (float)outer[mk_below(seed, 11)]
                    : (float)ck_between(seed, 0, 3.1416);
    some_direction(l.direction, seed, i);
    return l;
}

/* A point that the light reaches: on the sphere's or the cone's border as
 * often as within. */
static void some_lit_point(double p[3], const struct hl_light *l,
                           uint64_t *seed)
{
    float u[3];
    double r = (double)l->radius * (mk_below(seed, 3) ? 1
                                    : ck_between(seed, 0, 1)), along = 0;
    unit(u, seed);
    double d[3] = { (double)u[0], (double)u[1], (double)u[2] }, across = 0;
    if (l->kind == HL_SPOT) {
        double t = (double)l->outer * (mk_below(seed, 2) ? 1
                                       : ck_between(seed, 0, 1));
        t = t < 3.14159265 ? t : 3.14159265;
        for (int k = 0; k < 3; k++)
            along += d[k] * (double)l->direction[k];
        for (int k = 0; k < 3; k++) {
            d[k] -= along * (double)l->direction[k];
            across += d[k] * d[k];
        }
        for (int k = 0; k < 3; k++)
            d[k] = d[k] / sqrt(across) * sin(t) +
                   cos(t) * (double)l->direction[k];
    }
    for (int k = 0; k < 3; k++)
        p[k] = (double)l->position[k] + r * d[k];
}

/* By as much as floats of coordinates of 50 m round: 3 of 2^-24 of 50 m a
 * product of matrix and vertex, less than a hundredth of the volumes' room
 * (1e-4 of the radius, or of half a metre here), so strictly. */
static void volumes_hold_what_is_lit(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t cones = 0, spheres = 0;
    for (uint32_t i = 0; i < 4000; i++) {
        struct hl_light l = some_light(&seed, i);
        uint32_t first, count;
        float m[16];
        double p[3], v[3][3];
        assert_true(hl_light_volume(&l, &first, &count, m));
        assert_true(count == HL_LIGHT_CONE_N || first == HL_LIGHT_SPHERE);
        cones += first == HL_LIGHT_CONE;
        spheres += first == HL_LIGHT_SPHERE;
        assert_true(l.kind == HL_SPOT || first == HL_LIGHT_SPHERE);
        for (int n = 0; n < 20; n++) {
            some_lit_point(p, &l, &seed);
            for (uint32_t k = first; k < first + count; k += 3) {
                face_of(v, k, m);
                double d = inside((const double (*)[3])v, p);
                if (!(d > 0))
                    fail_msg("light %u, kind %d, outer %g: %g m outside", i,
                             (int)l.kind, (double)l.outer, -d);
            }
        }
    }
    assert_true(cones > 500 && spheres > 1500);
}

static void directional_lights_have_none(void **state)
{
    (void)state;
    struct hl_light l;
    uint32_t first, count;
    float m[16];
    memset(&l, 0, sizeof l);
    l.kind = HL_DIRECTIONAL;
    l.direction[1] = -1;
    assert_false(hl_light_volume(&l, &first, &count, m));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_closed),
        cmocka_unit_test(spheres_are_tight),
        cmocka_unit_test(volumes_hold_what_is_lit),
        cmocka_unit_test(directional_lights_have_none),
    };
    return cmocka_run_group_tests_name("light volumes", tests, make, NULL);
}
