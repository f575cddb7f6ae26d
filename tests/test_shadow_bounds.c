/* SPDX-License-Identifier: Zlib */
/* Which shadows can be seen, and which the camera may stand in: an answer of
 * no is wrong when one point of many, tried by hand, says yes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/shadow_volume.h"
#include "tests/check.h"

static const float ASPECT = 1.5f;

struct view {
    struct hl_camera camera;
    struct hl_light light;
    struct hl_box box;
    uint64_t random;
};

static void camera(struct view *v, float x, float y, float z, float tx,
                   float ty, float tz)
{
    const float eye[3] = {x, y, z}, target[3] = {tx, ty, tz};
    assert_int_equal(hl_camera_look_at(&v->camera, eye, target, 60, 0.5f, 20),
                     HL_OK);
}

static void light(struct view *v, enum hl_light_kind kind, float x, float y,
                  float z, float radius)
{
    memset(&v->light, 0, sizeof v->light);
    v->light.kind = kind;
    v->light.radius = radius;
    float *to = kind == HL_DIRECTIONAL ? v->light.direction
                                       : v->light.position;
    to[0] = x;
    to[1] = y;
    to[2] = z;
}

static void box(struct view *v, float x, float y, float z, float half)
{
    v->box.min = hl_v3(x - half, y - half, z - half);
    v->box.max = hl_v3(x + half, y + half, z + half);
}

/* The way from q to the light meets the box. */
static bool hides(const struct view *v, const double q[3])
{
    const double low[3] = {(double)v->box.min.x, (double)v->box.min.y,
                           (double)v->box.min.z};
    const double high[3] = {(double)v->box.max.x, (double)v->box.max.y,
                            (double)v->box.max.z};
    bool parallel = v->light.kind == HL_DIRECTIONAL;
    double from = 0, to = parallel ? 1e30 : 1;
    for (int i = 0; i < 3; i++) {
        double way = parallel ? -(double)v->light.direction[i]
                              : (double)v->light.position[i] - q[i];
        double s = (low[i] - q[i]) / way, t = (high[i] - q[i]) / way;
        from = fmax(from, fmin(s, t));
        to = fmin(to, fmax(s, t));
    }
    return from <= to;
}

static bool lit_from(const struct view *v, const double q[3])
{
    double d2 = 0;
    for (int i = 0; i < 3; i++)
        d2 += ((double)v->light.position[i] - q[i]) *
              ((double)v->light.position[i] - q[i]);
    return v->light.kind == HL_DIRECTIONAL ||
           d2 <= (double)v->light.radius * (double)v->light.radius;
}

/* A point of the view volume at this depth. */
static void seen_point(struct view *v, double depth, double q[3])
{
    const struct hl_camera *c = &v->camera;
    double ty = (double)c->tan_half_y;
    const double at[3] = {
        depth * ty * (double)ASPECT * ck_between(&v->random, -1, 1),
        depth * ty * ck_between(&v->random, -1, 1), -depth};
    for (int k = 0; k < 3; k++) {
        q[k] = 0;
        for (int r = 0; r < 3; r++)
            q[k] += (double)c->view[4 * k + r] *
                    (at[r] - (double)c->view[12 + r]);
    }
}

static bool any_hidden(struct view *v, bool at_near)
{
    for (int i = 0; i < 60; i++) {
        double q[3], depth = 0.5;
        if (!at_near)
            depth = ck_between(&v->random, 0.5, 20);
        seen_point(v, depth, q);
        if (hides(v, q) && (at_near || lit_from(v, q)))
            return true;
    }
    return false;
}

static float anywhere(struct view *v, double span)
{
    return (float)ck_between(&v->random, -span, span);
}

static void random_view(struct view *v, int i)
{
    double span = i % 4 < 2 ? 12 : 3;
    camera(v, anywhere(v, 3), anywhere(v, 3), anywhere(v, 3),
           anywhere(v, 3), anywhere(v, 3), anywhere(v, 3));
    light(v, i % 2 ? HL_DIRECTIONAL : HL_POINT, anywhere(v, 12),
          anywhere(v, 12), anywhere(v, 12), anywhere(v, 10) + 12);
    box(v, anywhere(v, span), anywhere(v, span), anywhere(v, span),
        (float)ck_between(&v->random, 0.05, 1));
}

/* Answers are conservative, and tight enough to be of use. */
static void no_means_no(void **state)
{
    struct view v;
    uint32_t reaches = 0, hidden = 0, near = 0, near_hidden = 0, n = 12000;
    (void)state;
    v.random = mk_seed();
    for (uint32_t i = 0; i < n; i++) {
        random_view(&v, (int)i);
        bool reach = hl_shadow_reaches(&v.box, &v.light, &v.camera, ASPECT);
        bool clip = hl_shadow_near_clipped(&v.box, &v.light, &v.camera,
                                           ASPECT);
        bool seen = any_hidden(&v, false), inside = any_hidden(&v, true);
        assert_true(reach || !seen);
        assert_true(clip || !inside);
        reaches += reach;
        hidden += seen;
        near += clip;
        near_hidden += inside;
    }
    assert_true(hidden > n / 20 && near_hidden > n / 100);
    print_message("of %u boxes: shadow seen %u, reaches %u; near rectangle "
                  "hidden %u, clipped %u\n", n, hidden, reaches, near_hidden,
                  near);
    assert_true(reaches < n / 2 && near < n / 20);
}

static bool reaches(const struct view *v)
{
    return hl_shadow_reaches(&v->box, &v->light, &v->camera, ASPECT);
}

static bool clipped(const struct view *v)
{
    return hl_shadow_near_clipped(&v->box, &v->light, &v->camera, ASPECT);
}

/* The camera at the origin looks along -z. */
static void shadows_that_cannot_be_seen(void **state)
{
    struct view v;
    (void)state;
    camera(&v, 0, 0, 0, 0, 0, -1);
    box(&v, 0, 0, 5, 1);
    light(&v, HL_POINT, 0, 0, -5, 30); /* behind the camera, thrown away */
    assert_false(reaches(&v));
    light(&v, HL_POINT, 0, 0, 9, 30);  /* behind, thrown into the view */
    assert_true(reaches(&v));
    light(&v, HL_POINT, 0, 0, 9, 2.9f); /* out of reach */
    assert_false(reaches(&v));
    light(&v, HL_POINT, 0, 0, 9, 3.1f);
    assert_true(reaches(&v));
    light(&v, HL_DIRECTIONAL, 0, 0, 1, 0);
    assert_false(reaches(&v));
    light(&v, HL_DIRECTIONAL, 0, 0, -1, 0); /* its radius is nothing */
    assert_true(reaches(&v));
    box(&v, 0, 0, -30, 1);                  /* beyond the far plane */
    assert_false(reaches(&v));
    light(&v, HL_POINT, 0, 0, -40, 50);
    assert_true(reaches(&v));
    for (int side = -1; side < 2; side += 2) { /* beside the view */
        box(&v, 12 * (float)side, 0, -5, 1);
        light(&v, HL_POINT, 0, 0, -5, 30);
        assert_false(reaches(&v));
        light(&v, HL_POINT, 15 * (float)side, 0, -5, 30);
        assert_true(reaches(&v));
        light(&v, HL_POINT, 0, 15 * (float)side, -5, 30);
        box(&v, 0, 12 * (float)side, -5, 1);
        assert_true(reaches(&v));
        light(&v, HL_POINT, 0, 0, -5, 30);
        assert_false(reaches(&v));
    }
    box(&v, 0, 0, -5, 1);
    assert_true(reaches(&v));
}

static void near_rectangles(void **state)
{
    struct view v;
    (void)state;
    camera(&v, 0, 0, 0, 0, 0, -1);
    light(&v, HL_POINT, 0, 10, -0.5f, 30);
    box(&v, 0, 5, -0.5f, 0.2f);            /* between */
    assert_true(clipped(&v));
    box(&v, 0, 11, -0.5f, 0.2f);           /* beyond the light */
    assert_false(clipped(&v));
    box(&v, 0, -5, -0.5f, 0.2f);           /* beyond the rectangle */
    assert_false(clipped(&v));
    box(&v, 2, 5, -0.5f, 0.2f);            /* beside */
    assert_false(clipped(&v));
    box(&v, 0, 5, -1.0f, 0.2f);            /* before the near plane */
    assert_false(clipped(&v));
    light(&v, HL_DIRECTIONAL, 0, -1, 0, 0);
    box(&v, 0, 500, -0.5f, 0.2f);
    assert_true(clipped(&v));
    box(&v, 0, -5, -0.5f, 0.2f);
    assert_false(clipped(&v));
    light(&v, HL_DIRECTIONAL, -1, -1, 1, 0); /* from the right, above, ahead */
    box(&v, 50, 50, -50.5f, 0.2f);
    assert_true(clipped(&v));
    box(&v, 50, 50, -48.5f, 0.2f);
    assert_false(clipped(&v));
    light(&v, HL_POINT, 0, 0, 0, 30);        /* a lamp at the eye */
    box(&v, 0, 0, -5, 1);
    assert_false(clipped(&v));
    box(&v, 0, 0, -0.5f, 0.1f);
    assert_true(clipped(&v));
    /* Aslant, light from behind: the near plane alone parts them. */
    camera(&v, 0, 0, 0, 1, 0, -1);
    light(&v, HL_POINT, -10, 0, 10, 30);
    box(&v, 0.7f, 0, -0.7f, 0.2f);
    assert_false(clipped(&v));
    box(&v, 0.5f, 0, -0.5f, 0.2f);
    assert_true(clipped(&v));
}

static void numbers_that_are_none_give_yes(void **state)
{
    struct view v;
    const float bad[2] = {NAN, INFINITY};
    (void)state;
    camera(&v, 0, 0, 0, 0, 0, -1);
    for (int i = 0; i < 2; i++) {
        light(&v, HL_POINT, 0, 0, -5, 1);
        box(&v, 90, 90, 90, 1);
        assert_false(reaches(&v) || clipped(&v));
        v.box.max.y = bad[i];
        assert_true(reaches(&v) && clipped(&v));
        box(&v, 90, 90, 90, 1);
        v.light.position[1] = bad[i];
        assert_true(reaches(&v) && clipped(&v));
        light(&v, HL_DIRECTIONAL, 0, 1, bad[i], 1);
        assert_true(reaches(&v) && clipped(&v));
        light(&v, HL_DIRECTIONAL, 0, 1, 0, bad[i]);
        assert_false(clipped(&v)); /* which has no radius */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_means_no),
        cmocka_unit_test(shadows_that_cannot_be_seen),
        cmocka_unit_test(near_rectangles),
        cmocka_unit_test(numbers_that_are_none_give_yes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
