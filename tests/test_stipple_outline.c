/* SPDX-License-Identifier: Zlib */
/* Outlines of boxes on the screen: nothing of a box lies outside, little of
 * an outline lies outside the box, and outlines that are told apart are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "core/light.h"
#include "core/stipple_work.h"
#include "tests/mesh_kit.h"

enum { WIDTH = 640, HEIGHT = 360 };
#define SLACK (1.0 / 16)

static float between(uint64_t *random, float low, float high)
{
    return low + (high - low) * mk_unit(random);
}

/* ---- a box by points ------------------------------------------------- */

struct box { float world[16], min[3], max[3]; };

static void rows(float m[16], const float columns[4][3])
{
    for (int c = 0; c < 4; c++) {
        for (int r = 0; r < 3; r++)
            m[c * 4 + r] = columns[c][r];
        m[c * 4 + 3] = c == 3;
    }
}

/* Any affine map: turned, stretched, sheared. */
static struct box random_box(uint64_t *random, float x, float far, float size)
{
    struct box b;
    float columns[4][3];
    for (int i = 0; i < 3; i++) {
        columns[3][i] = between(random, -far, far);
        b.min[i] = -between(random, 0, size);
        b.max[i] = between(random, 0, size);
        for (int k = 0; k < 3; k++)
            columns[i][k] = between(random, -1, 1);
    }
    columns[3][0] += x;
    rows(b.world, (const float (*)[3])columns);
    return b;
}

/* A point of the box, t in 0..1, as texels. False: not on the screen. */
static bool point_of(const struct box *b, const struct hl_camera *cam,
                     const double t[3], double *x, double *y)
{
    double p[3], w[3], v[3], tan_y = (double)cam->tan_half_y;
    for (int i = 0; i < 3; i++)
        p[i] = (double)b->min[i] +
               t[i] * ((double)b->max[i] - (double)b->min[i]);
    for (int r = 0; r < 3; r++) {
        w[r] = (double)b->world[12 + r];
        for (int c = 0; c < 3; c++)
            w[r] += (double)b->world[c * 4 + r] * p[c];
    }
    for (int r = 0; r < 3; r++) {
        v[r] = (double)cam->view[12 + r];
        for (int c = 0; c < 3; c++)
            v[r] += (double)cam->view[c * 4 + r] * w[c];
    }
    if (-v[2] < (double)cam->near)
        return false;
    *x = (1 + v[0] / -v[2] / (tan_y * WIDTH / HEIGHT)) * 0.5 * WIDTH;
    *y = (1 - v[1] / -v[2] / tan_y) * 0.5 * HEIGHT;
    return *x >= 0 && *x <= WIDTH && *y >= 0 && *y <= HEIGHT;
}

static double area(const struct hl_stipple_outline *o)
{
    double sum = 0;
    for (uint32_t i = 0, j = o->n_corners - 1; i < o->n_corners; j = i++)
        sum += (double)o->x[j] * (double)o->y[i] -
               (double)o->x[i] * (double)o->y[j];
    return sum / 2;
}

/* How far a point lies outside, along the normal of the worst edge. */
static double outside(const struct hl_stipple_outline *o, double x, double y)
{
    double turn = area(o) < 0 ? -1 : 1, worst = -1e9;
    for (uint32_t i = 0, j = o->n_corners - 1; i < o->n_corners; j = i++) {
        double ex = turn * ((double)o->x[i] - (double)o->x[j]);
        double ey = turn * ((double)o->y[i] - (double)o->y[j]);
        double l = sqrt(ex * ex + ey * ey);
        double d = (x - (double)o->x[i]) * ey - (y - (double)o->y[i]) * ex;
        if (l > 1e-6 && d / l > worst)
            worst = d / l;
    }
    return worst;
}

static struct hl_camera camera_of(uint64_t *random)
{
    const float eye[3] = { between(random, -2, 2), between(random, -2, 2),
                           between(random, -2, 2) };
    const float at[3] = { between(random, 3, 9), between(random, -3, 3),
                          between(random, -3, 3) };
    struct hl_camera cam;
    assert_int_equal(hl_camera_look_at(&cam, eye, at, 60, 0.1f, 100), HL_OK);
    return cam;
}

/* On all of a target of WIDTH x HEIGHT. */
static bool project(struct hl_stipple_outline *o, const float world[16],
                    const float min[3], const float max[3],
                    const struct hl_camera *cam)
{
    struct hl_span screen = hl_span_whole(WIDTH, HEIGHT, cam,
                                          (float)WIDTH / HEIGHT);
    return hl_stipple_project(o, world, min, max, cam, &screen);
}

/* Random boxes, many across the near plane or the screen's edges. */
static void boxes_lie_inside_their_outlines(void **state)
{
    uint64_t random = mk_seed();
    uint32_t n_points = 0, n_cut = 0, most = 0;
    (void)state;
    for (int run = 0; run < 1000; run++) {
        struct hl_camera cam = camera_of(&random);
        struct box b = random_box(&random, 2, 4, run % 2 ? 1.0f : 3.0f);
        struct hl_stipple_outline o = {0, {0}, {0}};
        struct hl_stipple_object object;
        bool seen = project(&o, b.world, b.min, b.max, &cam);
        if (seen) {
            assert_true(hl_stipple_outline_good(&o));
            hl_stipple_bound(&object, &o);
            assert_ptr_equal(object.outline, &o);
            n_cut += o.n_corners > 6;
            most = o.n_corners > most ? o.n_corners : most;
        }
        for (int i = 0; i < 300; i++) {
            double t[3], x, y;
            for (int k = 0; k < 3; k++) /* half of the points on faces        */
                t[k] = mk_below(&random, 2) ? (double)mk_unit(&random)
                                            : mk_below(&random, 2);
            if (!point_of(&b, &cam, t, &x, &y))
                continue;
            assert_true(seen);
            assert_true(outside(&o, x, y) <= SLACK);
            assert_true(x >= (double)object.x0 && x <= (double)object.x1 &&
                        y >= (double)object.y0 && y <= (double)object.y1);
            n_points++;
        }
    }
    print_message("    %u points, %u outlines of more than 6 corners, at most "
                  "%u\n", n_points, n_cut, most);
    assert_true(n_points > 20000 && n_cut > 20);
}

/* Each corner of an outline is a corner of the box, or on a cut: of boxes
 * wholly on the screen it is a corner. */
static void outlines_are_tight(void **state)
{
    uint64_t random = mk_seed() + 1;
    uint32_t n = 0;
    (void)state;
    for (int run = 0; run < 300; run++) {
        struct hl_camera cam = camera_of(&random);
        struct box b = random_box(&random, 6, 3, 0.5f);
        struct hl_stipple_outline o;
        double x[8], y[8];
        bool whole = true;
        for (int i = 0; i < 8 && whole; i++) {
            const double t[3] = { i & 1, i >> 1 & 1, i >> 2 };
            whole = point_of(&b, &cam, t, &x[i], &y[i]);
        }
        if (!whole)
            continue;
        n++;
        assert_true(project(&o, b.world, b.min, b.max, &cam));
        assert_in_range(o.n_corners, 4, 6);
        for (uint32_t k = 0; k < o.n_corners; k++) {
            double best = 1e9;
            for (int i = 0; i < 8; i++)
                best = fmin(best, hypot(x[i] - (double)o.x[k],
                                        y[i] - (double)o.y[k]));
            assert_true(best <= SLACK);
        }
    }
    assert_true(n > 30);
}

static const float unit[16] = { 1, 0, 0, 0, 0, 1, 0, 0,
                                0, 0, 1, 0, 0, 0, 0, 1 };

static void known_boxes(void **state)
{
    const float eye[3] = {0, 0, 0}, at[3] = {0, 0, -1};
    const float min[3] = {-1, -0.5f, -3}, max[3] = {1, 0.5f, -2};
    const float behind0[3] = {-1, -1, 1}, behind1[3] = {1, 1, 2};
    const float left0[3] = {-90, -1, -3}, left1[3] = {-80, 1, -2};
    const float around0[3] = {-1, -1, -1}, around1[3] = {1, 1, 1};
    const float flat0[3] = {-1, 0, -3}, flat1[3] = {1, 0, -2};
    const float bad[3] = {NAN, 0, 0};
    struct hl_stipple_outline o;
    struct hl_camera cam;
    (void)state;
    assert_int_equal(hl_camera_look_at(&cam, eye, at, 90, 0.1f, 100), HL_OK);
    struct hl_span no_width = hl_span_whole(0, HEIGHT, &cam, 1);
    struct hl_span no_height = hl_span_whole(WIDTH, 0, &cam, 1);
    /* The near face at z = 2: 180 / 2 texels a metre. */
    assert_true(project(&o, unit, min, max, &cam));
    assert_int_equal(o.n_corners, 4);
    for (uint32_t i = 0; i < 4; i++) {
        assert_true(fabs(fabs((double)o.x[i] - 320) - 90) < SLACK);
        assert_true(fabs(fabs((double)o.y[i] - 180) - 45) < SLACK);
    }
    assert_false(project(&o, unit, behind0, behind1, &cam));
    assert_false(project(&o, unit, left0, left1, &cam));
    /* On edge: no texel. */
    assert_false(project(&o, unit, flat0, flat1, &cam));
    assert_false(project(&o, unit, bad, max, &cam));
    assert_false(hl_stipple_project(&o, unit, min, max, &cam, &no_width));
    assert_false(hl_stipple_project(&o, unit, min, max, &cam, &no_height));
    /* The eye is inside: all of the screen. */
    assert_true(project(&o, unit, around0, around1, &cam));
    assert_int_equal(o.n_corners, 4);
    assert_true(fabs(fabs(area(&o)) - WIDTH * HEIGHT) < 1);
}

/* ---- two outlines ---------------------------------------------------- */

static struct hl_stipple_outline circle(float x, float y, float r, uint32_t n,
                                        float turn, bool back)
{
    struct hl_stipple_outline o;
    memset(&o, 0, sizeof o);
    o.n_corners = n;
    for (uint32_t i = 0; i < n; i++) {
        double angle = (double)turn + 6.283185307 * (double)i / n;
        o.x[i] = x + r * (float)cos(angle);
        o.y[i] = y + r * (float)(back ? -sin(angle) : sin(angle));
    }
    return o;
}

/* Those that share a point of a fine grid are not told apart; those that do
 * not, by much, are. */
static void outlines_meet_where_they_do(void **state)
{
    uint64_t random = mk_seed() + 2;
    uint32_t n_meet = 0, n_apart = 0, n_wrong = 0;
    (void)state;
    for (int run = 0; run < 1500; run++) {
        struct hl_stipple_outline o[2];
        double nearest = 1e9;
        bool meet;
        for (int i = 0; i < 2; i++) {
            uint32_t n = 3 + mk_below(&random, HL_STIPPLE_CORNERS - 2);
            float r = between(&random, 1, 8), turn = between(&random, 0, 6);
            o[i] = circle(between(&random, 0, 20), between(&random, 0, 20), r,
                          n, turn, mk_below(&random, 2));
        }
        for (double x = -8; x <= 28; x += 0.5)
            for (double y = -8; y <= 28; y += 0.5)
                nearest = fmin(nearest, fmax(outside(&o[0], x, y),
                                             outside(&o[1], x, y)));
        meet = hl_stipple_outlines_meet(&o[0], &o[1], 0);
        assert_int_equal(meet, hl_stipple_outlines_meet(&o[1], &o[0], 0));
        if (nearest <= 0) {
            assert_true(meet);
            n_meet++;
        } else if (nearest > 0.75) {
            /* Half way between them is a point of a grid within 0.36 texels,
             * so they lie 2 (0.75 - 0.36) apart, and along an edge's normal,
             * which is at worst 60 degrees off (two triangles tip to tip), by
             * 0.39: more than the slack of both, 0.125. */
            assert_false(meet);
            n_apart++;
        }
        n_wrong += nearest > 0 && meet;
    }
    print_message("    %u meet, %u are apart, %u in between\n", n_meet, n_apart,
                  n_wrong);
    assert_true(n_meet > 200 && n_apart > 200);
}

/* Two squares 3 texels apart, straight and on their corners. */
static void margins_are_distances(void **state)
{
    const float half = 0.78539816f;
    (void)state;
    for (int corner = 0; corner < 2; corner++)
        for (int back = 0; back < 2; back++) {
            float turn = corner ? 0.0f : half;
            float reach = corner ? 2.0f : 1.41421356f;
            struct hl_stipple_outline a = circle(0, 0, 2, 4, turn, back);
            struct hl_stipple_outline b =
                circle(2 * reach + 3, 0, 2, 4, turn, false);
            /* Corner to corner no edge's normal shows more than 3 / sqrt 2:
             * told apart less often, never wrongly. */
            float d = corner ? 2.1213203f : 3.0f;
            assert_false(hl_stipple_outlines_meet(&a, &b, 0));
            assert_false(hl_stipple_outlines_meet(&a, &b, d - 0.2f));
            assert_true(hl_stipple_outlines_meet(&a, &b, d));
            assert_true(hl_stipple_outlines_meet(&a, &b, 3.1f));
        }
}

/* Windows in a row, seen aslant: rectangles overlap, windows do not. */
static void outlines_spare_patterns(void **state)
{
    const float eye[3] = {0, 0, 0}, at[3] = {1, -0.9f, -1};
    struct hl_stipple_object objects[8];
    struct hl_stipple_outline outlines[8];
    struct hl_stipple_frame frame;
    struct hl_stipple_stats stats;
    uint8_t pattern[8];
    void *memory = malloc(hl_stipple_bytes(8, 0));
    struct hl_stipple *s = hl_stipple_create(memory, 8, 0);
    struct hl_camera cam;
    (void)state;
    memset(objects, 0, sizeof objects);
    memset(&frame, 0, sizeof frame);
    assert_int_equal(hl_camera_look_at(&cam, eye, at, 75, 0.1f, 100), HL_OK);
    for (uint32_t i = 0; i < 8; i++) {
        const float min[3] = { 1.0f * (float)i + 0.05f, -3, -3 };
        const float max[3] = { 1.0f * (float)i + 0.95f, -3, -1 };
        objects[i].id = i;
        assert_true(project(&outlines[i], unit, min, max, &cam));
        hl_stipple_bound(&objects[i], &outlines[i]);
    }
    frame.objects = objects;
    frame.n_objects = 8;
    frame.patterns = HL_STIPPLE_2X2;
    assert_int_equal(hl_stipple_assign(s, &frame, pattern, &stats), HL_OK);
    assert_int_equal(stats.pairs, 0);
    for (uint32_t i = 0; i < 8; i++)
        objects[i].outline = NULL;
    assert_int_equal(hl_stipple_assign(s, &frame, pattern, &stats), HL_OK);
    print_message("    8 windows: 0 overlaps by outlines, %u by rectangles\n",
                  stats.pairs);
    assert_true(stats.pairs >= 7);
    free(memory);
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(boxes_lie_inside_their_outlines),
        TEST(outlines_are_tight),
        TEST(known_boxes),
        TEST(outlines_meet_where_they_do),
        TEST(margins_are_distances),
        TEST(outlines_spare_patterns),
    };
    return cmocka_run_group_tests_name("stipple outlines", tests, NULL, NULL);
}
