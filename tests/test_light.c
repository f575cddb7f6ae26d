/* SPDX-License-Identifier: Zlib */
/* Lights on the host against brute force: what a light can reach is never
 * lost, whatever its bounds are. test_tiles.c goes on with tile lists. */
#include <math.h>
#include <string.h>
#include "core/light.h"
#include "tests/check.h"

static const float identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0,
                                    0, 0, 0, 1 };

static struct hl_camera camera(float tan_half_y, float near, float far)
{
    struct hl_camera c = { .tan_half_y = tan_half_y, .near = near,
                           .far = far };
    memcpy(c.view, identity, sizeof c.view);
    return c;
}

static struct hl_light point(float x, float y, float z, float radius)
{
    struct hl_light l = { .position = { x, y, z }, .radius = radius,
                          .color = { 1, 1, 1 } };
    return l;
}

/* ---- checks ----------------------------------------------------------- */

static struct hl_light good(enum hl_light_kind kind)
{
    struct hl_light l = point(1, 2, 3, 4);
    l.kind = kind;
    l.direction[1] = -1;
    l.inner = 0.3f;
    l.outer = 0.5f;
    return l;
}

#define BAD(kind_, field, value, part)                      \
    do {                                                    \
        struct hl_light bad_ = good(kind_);                 \
        assert_null(hl_light_check(&bad_));                 \
        bad_.field = value;                                 \
        const char *why_ = hl_light_check(&bad_);           \
        assert_non_null(why_);                              \
        assert_non_null(strstr(why_, part));                \
    } while (0)
#define FINE(kind_, field, value)                           \
    do {                                                    \
        struct hl_light fine_ = good(kind_);                \
        fine_.field = value;                                \
        assert_null(hl_light_check(&fine_));                \
    } while (0)

static void each_rule_of_a_light_is_named(void **state)
{
    (void)state;
    const float bad[] = { NAN, INFINITY, -INFINITY };
    for (int k = 0; k < 3; k++) {
        enum hl_light_kind kind = (enum hl_light_kind)k;
        BAD(kind, kind, (enum hl_light_kind)3, "kind");
        BAD(kind, falloff, (enum hl_falloff)2, "falloff");
        for (int c = 0; c < 3; c++) {
            BAD(kind, color[c], -1e-30f, "color");
            for (int i = 0; i < 3; i++)
                BAD(kind, color[c], bad[i], "color");
            for (int i = 0; i < 3 && kind != HL_DIRECTIONAL; i++)
                BAD(kind, position[c], bad[i], "position");
            for (int i = 0; i < 3 && kind != HL_POINT; i++)
                BAD(kind, direction[c], bad[i], "direction");
        }
    }
    BAD(HL_POINT, radius, -1e-30f, "radius");
    BAD(HL_SPOT, radius, -1, "radius");
    BAD(HL_POINT, radius, NAN, "radius");
    BAD(HL_POINT, radius, INFINITY, "radius");
    BAD(HL_SPOT, direction[1], 0, "direction");
    BAD(HL_SPOT, inner, -0.1f, "inner");
    BAD(HL_SPOT, inner, 0.6f, "inner");
    BAD(HL_SPOT, outer, 3.2f, "outer");
    BAD(HL_SPOT, outer, NAN, "outer");
}

static void what_a_kind_does_not_read_may_be_anything(void **state)
{
    (void)state;
    for (int c = 0; c < 3; c++) {
        FINE(HL_POINT, direction[c], NAN);
        FINE(HL_DIRECTIONAL, position[c], NAN);
        FINE(HL_POINT, color[c], 0);
    }
    FINE(HL_POINT, inner, NAN);
    FINE(HL_DIRECTIONAL, outer, NAN);
    FINE(HL_DIRECTIONAL, radius, -1);
    FINE(HL_POINT, radius, 0);
    FINE(HL_SPOT, outer, 3.14159265f);
    FINE(HL_SPOT, inner, 0.5f);
}

/* ---- bounds on the screen --------------------------------------------- */

/* Does the ray through slopes (x, y) meet the sphere between two depths?
 * The sphere in view space, its depth -c[2]. */
static bool ray_meets(const double c[3], double r, double x, double y,
                      double z0, double z1)
{
    /* |t (x, y, 1) - (cx, cy, z)|^2 = r^2, t the depth. */
    double a = x * x + y * y + 1, b = x * c[0] + y * c[1] - c[2];
    double k = c[0] * c[0] + c[1] * c[1] + c[2] * c[2] - r * r;
    double d = b * b - a * k;
    if (d < 0)
        return false;
    double t0 = (b - sqrt(d)) / a, t1 = (b + sqrt(d)) / a;
    return t1 >= z0 && t0 <= z1;
}

struct hits { uint32_t n; int x0, x1, y0, y1; };

static struct hits find_hits(const struct hl_light *l,
                             const struct hl_camera *cam, int w, int h)
{
    struct hits b = { 0, w, -1, h, -1 };
    double c[3] = { (double)l->position[0], (double)l->position[1],
                    (double)l->position[2] };
    double ty = (double)cam->tan_half_y, tx = ty * w / h;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            if (!ray_meets(c, (double)l->radius, ((x + 0.5) / w * 2 - 1) * tx,
                           (1 - (y + 0.5) / h * 2) * ty, (double)cam->near,
                           (double)cam->far))
                continue;
            b.n++;
            b.x0 = x < b.x0 ? x : b.x0;
            b.x1 = x > b.x1 ? x : b.x1;
            b.y0 = y < b.y0 ? y : b.y0;
            b.y1 = y > b.y1 ? y : b.y1;
        }
    return b;
}

/* Slopes of the two tangents to a circle, as angles: the axis of the centre
 * plus and minus the angle that its radius is seen under. */
static void outline(double c, double z, double r, double *low, double *high)
{
    double axis = atan2(c, z), half = asin(r / sqrt(c * c + z * z));
    *low = tan(axis - half);
    *high = tan(axis + half);
}

/* A rectangle is the outline, a quarter of a texel and the rounding outwards
 * on each side, cut to the screen; float's error is below a hundredth. */
static void check_outline(const struct hl_light *l,
                          const struct hl_camera *cam,
                          const struct hl_rect *r, int w, int h)
{
    double z = -(double)l->position[2], x0, x1, y0, y1;
    double ty = (double)cam->tan_half_y, tx = ty * w / h;
    if (z < (double)l->radius * 1.01)
        return;
    outline((double)l->position[0], z, (double)l->radius, &x0, &x1);
    outline((double)l->position[1], z, (double)l->radius, &y0, &y1);
    x0 = (x0 / tx + 1) / 2 * w - 1.26;
    x1 = (x1 / tx + 1) / 2 * w + 1.26;
    double top = (1 - y1 / ty) / 2 * h - 1.26;
    double bottom = (1 - y0 / ty) / 2 * h + 1.26;
    if (r->x < x0 || r->x + r->width > x1 || r->y < top ||
        r->y + r->height > bottom)
        fail_msg("light %g %g %g r %g on %d x %d: its outline is %.2f..%.2f,"
                 " %.2f..%.2f, the rectangle %d..%d, %d..%d",
                 (double)l->position[0], (double)l->position[1],
                 (double)l->position[2], (double)l->radius, w, h, x0, x1,
                 top, bottom, r->x, r->x + r->width, r->y, r->y + r->height);
}

static void check_rect(const struct hl_light *l, const struct hl_camera *cam,
                       int w, int h)
{
    struct hl_lit_sphere s;
    struct hl_rect r;
    struct hits hit = find_hits(l, cam, w, h);
    struct hl_span span = hl_span_whole((uint32_t)w, (uint32_t)h, cam,
                                        (float)w / (float)h);
    bool seen = hl_lights_view(&s, l, 1, cam, (float)w / (float)h) == 1 &&
                hl_sphere_rect(&r, &s, &span);
    if (hit.n == 0)
        return;
    if (!seen || hit.x0 < r.x || hit.y0 < r.y || hit.x1 >= r.x + r.width ||
        hit.y1 >= r.y + r.height)
        fail_msg("light %g %g %g r %g on %d x %d: pixels %d..%d, %d..%d are "
                 "lit, the rectangle is %s", (double)l->position[0],
                 (double)l->position[1], (double)l->position[2],
                 (double)l->radius, w, h, hit.x0, hit.x1, hit.y0, hit.y1,
                 seen ? "smaller" : "empty");
    assert_true(r.x >= 0 && r.y >= 0 && r.x + r.width <= w &&
                r.y + r.height <= h);
    check_outline(l, cam, &r, w, h);
}

static void no_lit_pixel_is_outside_a_lights_rectangle(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    static const int size[][2] = { { 64, 36 }, { 1, 1 }, { 33, 7 }, { 5, 61 },
                                   { 40, 40 } };
    for (int i = 0; i < 20000; i++) {
        const int *wh = size[i % 5];
        struct hl_camera cam = camera(
            (float)tan(ck_between(&seed, 0.05, 1.4)),
            (float)exp(ck_between(&seed, -5, 0)),
            (float)exp(ck_between(&seed, 1, 6)));
        double r = exp(ck_between(&seed, -3, 3));
        /* In front, behind, around the eye, through the near plane. */
        double z = i % 4 == 0 ? ck_between(&seed, -1, 1) * r * 1.1
                   : i % 4 == 1
                   ? -(double)cam.near - ck_between(&seed, -1, 1) * r
                   : -exp(ck_between(&seed, -3, 6)) * (i % 8 == 2 ? -1 : 1);
        double far_off = fabs(z) + r;
        struct hl_light l = point((float)(far_off * ck_between(&seed, -2, 2)),
                                  (float)(far_off * ck_between(&seed, -2, 2)),
                                  (float)z, (float)r);
        check_rect(&l, &cam, wh[0], wh[1]);
    }
}

static void lights_that_touch_the_cameras_plane_keep_the_screen(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct hl_camera cam = camera(0.6f, 0.1f, 100);
    for (int i = 0; i < 3000; i++) {
        double r = ck_between(&seed, 0.01, 20);
        /* z / r from 0.999 to 1.003: both sides of the tangents' guard. */
        double z = r * ck_between(&seed, 0.999, 1.003);
        struct hl_light l = point((float)ck_between(&seed, -3 * r, 3 * r),
                                  (float)ck_between(&seed, -3 * r, 3 * r),
                                  (float)-z, (float)r);
        check_rect(&l, &cam, 96, 54);
    }
}

static void what_cannot_light_is_left_out(void **state)
{
    (void)state;
    struct hl_camera cam = camera(0.6f, 0.1f, 100);
    struct hl_light l[7] = { point(0, 0, -5, 1), point(0, 0, -5, 0),
                             point(0, 0, 5, 1), point(0, 0, -200, 1),
                             point(30, 0, -5, 1), point(0, -30, -5, 1),
                             point(0, 0, -5, 1) };
    struct hl_lit_sphere s[7];
    l[6].color[0] = l[6].color[1] = l[6].color[2] = 0;
    assert_int_equal(hl_lights_view(s, l, 7, &cam, 1.7f), 1);
    assert_int_equal(s[0].light, 0);
    ck_near((double)s[0].z0, 4, 1e-6);
    ck_near((double)s[0].z1, 6, 1e-6);
    /* tan of asin(1 / 5) on both sides of the axis. */
    ck_near((double)s[0].x1, 1 / sqrt(24), 1e-6);
    ck_near((double)s[0].x0, -1 / sqrt(24), 1e-6);
    l[3].kind = HL_DIRECTIONAL;
    l[3].direction[1] = -1;
    l[3].radius = 0;
    assert_int_equal(hl_lights_view(s, l, 7, &cam, 1.7f), 2);
    assert_int_equal(s[1].light, 3);
    assert_true(s[1].radius < 0);
    struct hl_rect r;
    struct hl_span span = hl_span_whole(40, 30, &cam, 1.7f);
    assert_true(hl_sphere_rect(&r, &s[1], &span));
    assert_true(r.x == 0 && r.y == 0 && r.width == 40 && r.height == 30);
}

/* ---- what a stage is given -------------------------------------------- */

static void a_light_is_written_in_view_space(void **state)
{
    (void)state;
    struct hl_camera cam;
    const float eye[3] = { 4, 1, 0 }, target[3] = { 0, 1, 0 };
    assert_int_equal(hl_camera_look_at(&cam, eye, target, 60, 0.1f, 100),
                     HL_OK);
    struct hl_light l = good(HL_SPOT);
    struct hl_lit_sphere s;
    hl_vec4 v[HL_LIGHT_VEC4S];
    l.position[0] = 1, l.position[1] = 2, l.position[2] = 0.5f;
    l.radius = 4;
    l.direction[0] = -2, l.direction[1] = 0;      /* not unit: made so       */
    l.falloff = HL_INVERSE_SQUARE;
    assert_int_equal(hl_lights_view(&s, &l, 1, &cam, 1), 1);
    assert_int_equal(hl_light_write(v, &l, &s, cam.view, 0), HL_POINT_VEC4S);
    assert_int_equal(hl_light_write(v, &l, &s, cam.view, 1), HL_LIGHT_VEC4S);
    /* The camera looks along -x: view x is world -z, view z is world x. */
    ck_near((double)v[0].x, -0.5, 1e-6);
    ck_near((double)v[0].y, 1, 1e-6);
    ck_near((double)v[0].z, -3, 1e-6);
    ck_near((double)v[0].w, 1 / 16.0, 1e-8);
    assert_true(v[1].x == 1 && v[1].y == 1 && v[1].z == 1 && v[1].w == 1);
    ck_near((double)v[2].z, -1, 1e-6);
    ck_near((double)v[2].w, 1 / (cos(0.3) - cos(0.5)), 1e-4);
    ck_near((double)v[3].x, -cos(0.5) / (cos(0.3) - cos(0.5)), 1e-4);
    assert_true(v[3].y == 0);
    l.kind = HL_DIRECTIONAL;
    hl_light_write(v, &l, &s, cam.view, 1);
    assert_true(v[3].y == 1);
    /* A point among other kinds is a cone that is 1 everywhere. */
    l.kind = HL_POINT;
    l.falloff = HL_SMOOTH;
    hl_light_write(v, &l, &s, cam.view, 1);
    assert_true(v[1].w == 0 && v[2].w == 0 && v[3].x == 1 && v[3].y == 0);
}

/* ---- boxes ------------------------------------------------------------ */

static void random_matrix(float m[16], uint64_t *seed)
{
    for (int i = 0; i < 16; i++)
        m[i] = (float)ck_between(seed, -2, 2);
    m[3] = m[7] = m[11] = 0;
    m[15] = 1;
}

static void a_world_box_holds_its_corners_and_no_more(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 2000; i++) {
        float m[16], lo[3], hi[3];
        double min[3] = { 1e9, 1e9, 1e9 }, max[3] = { -1e9, -1e9, -1e9 };
        random_matrix(m, &seed);
        for (int k = 0; k < 3; k++) {
            lo[k] = (float)ck_between(&seed, -5, 5);
            hi[k] = lo[k] + (float)ck_between(&seed, 0, 5);
        }
        for (int c = 0; c < 8; c++)
            for (int k = 0; k < 3; k++) {
                double p = (double)m[12 + k];
                for (int j = 0; j < 3; j++)
                    p += (double)m[j * 4 + k] *
                         (double)(c >> j & 1 ? hi[j] : lo[j]);
                min[k] = p < min[k] ? p : min[k];
                max[k] = p > max[k] ? p : max[k];
            }
        struct hl_box b = hl_box_world(m, lo, hi);
        const float got[6] = { b.min.x, b.min.y, b.min.z, b.max.x, b.max.y,
                               b.max.z };
        /* 12 roundings of values up to 60. */
        for (int k = 0; k < 3; k++) {
            ck_near((double)got[k], min[k], 3e-5);
            ck_near((double)got[3 + k], max[k], 3e-5);
        }
    }
}

static void a_sphere_touches_what_is_nearer_than_its_radius(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t touching = 0;
    for (int i = 0; i < 100000; i++) {
        struct hl_box b = { hl_v3(-1, -2, -0.5f), hl_v3(1, 0, 0.5f) };
        struct hl_lit_sphere s = { .radius = (float)ck_between(&seed, 0, 3) };
        double p[3], d2 = 0;
        const double lo[3] = { -1, -2, -0.5 }, hi[3] = { 1, 0, 0.5 };
        for (int k = 0; k < 3; k++) {
            p[k] = ck_between(&seed, -4, 4);
            double d = p[k] < lo[k] ? lo[k] - p[k]
                       : p[k] > hi[k] ? p[k] - hi[k] : 0;
            d2 += d * d;
        }
        s.world = hl_v3((float)p[0], (float)p[1], (float)p[2]);
        double gap = sqrt(d2) - (double)s.radius;
        if (fabs(gap) < 1e-5)
            continue;
        assert_true(hl_sphere_touches_box(&s, &b) == (gap < 0));
        touching += gap < 0;
    }
    assert_true(touching > 10000);
    struct hl_lit_sphere sun = { .radius = -1 };
    struct hl_box far = { hl_v3(1e6f, 0, 0), hl_v3(1e6f, 1, 1) };
    assert_true(hl_sphere_touches_box(&sun, &far));
}

/* A point of the box in the view volume: then it must be visible. Boxes
 * wholly beyond one plane must not be. */
static void no_visible_box_is_culled(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t seen = 0, culled = 0;
    for (int i = 0; i < 20000; i++) {
        struct hl_camera cam = camera(0.5f, 0.5f, 30);
        double lo[3], size[3];
        for (int k = 0; k < 3; k++) {
            lo[k] = ck_between(&seed, -40, 20);
            size[k] = ck_between(&seed, 0, 20);
        }
        struct hl_box b = { hl_v3((float)lo[0], (float)lo[1], (float)lo[2]),
                            hl_v3((float)(lo[0] + size[0]),
                                  (float)(lo[1] + size[1]),
                                  (float)(lo[2] + size[2])) };
        bool inside = false;
        for (int k = 0; k < 60 && !inside; k++) {
            double p[3];
            for (int j = 0; j < 3; j++)
                p[j] = lo[j] + size[j] * ck_between(&seed, 0, 1);
            double z = -p[2];
            inside = z > 0.5 && z < 30 && fabs(p[0]) < z * 0.5 * 1.5 &&
                     fabs(p[1]) < z * 0.5;
        }
        float nearest;
        bool visible = hl_box_visible(&b, &cam, 1.5f, &nearest);
        assert_true(visible || !inside);
        seen += inside;
        culled += !visible;
        ck_near((double)nearest, -(lo[2] + size[2]), 1e-4);
    }
    assert_true(seen > 1000 && culled > 1000);
    struct hl_camera cam = camera(0.5f, 0.5f, 30);
    float z;
    const struct hl_box out[5] = {
        { hl_v3(-1, -1, 1), hl_v3(1, 1, 2) },
        { hl_v3(-1, -1, -40), hl_v3(1, 1, -31) },
        { hl_v3(20, -1, -10), hl_v3(30, 1, -5) },
        { hl_v3(-1, -30, -10), hl_v3(1, -20, -5) },
        { hl_v3(-1, -1, -0.4f), hl_v3(1, 1, -0.1f) } };
    for (int i = 0; i < 5; i++)
        assert_false(hl_box_visible(&out[i], &cam, 1.5f, &z));
}

/* ---- camera ----------------------------------------------------------- */

static void apply(const float m[16], const double p[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = (double)m[k] * p[0] + (double)m[4 + k] * p[1] +
                 (double)m[8 + k] * p[2] + (double)m[12 + k];
}

static void a_camera_looks_down_minus_z(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 5000; i++) {
        struct hl_camera c;
        float eye[3], target[3];
        double e[3], t[3], up[3], d = 0, out[3];
        for (int k = 0; k < 3; k++) {
            eye[k] = (float)ck_between(&seed, -9, 9);
            target[k] = (float)ck_between(&seed, -9, 9);
            if (i % 3 == 0 && k != 1)
                target[k] = eye[k];
            e[k] = (double)eye[k];
            t[k] = (double)target[k];
            up[k] = t[k] + (k == 1 ? 1 : 0);
            d += (e[k] - t[k]) * (e[k] - t[k]);
        }
        assert_int_equal(hl_camera_look_at(&c, eye, target, 90, 1, 2), HL_OK);
        ck_near((double)c.tan_half_y, 1, 1e-6);
        apply(c.view, e, out);
        for (int k = 0; k < 3; k++)
            ck_near(out[k], 0, 1e-4);
        apply(c.view, t, out);
        ck_near(out[0], 0, 1e-4);
        ck_near(out[1], 0, 1e-4);
        ck_near(out[2], -sqrt(d), 1e-4);
        /* What is higher in the world is not lower on the screen. */
        apply(c.view, up, out);
        ck_near(out[0], 0, 1e-4);
        assert_true(out[1] > -1e-4);
    }
}

static void a_camera_that_is_none_is_refused(void **state)
{
    (void)state;
    struct hl_camera c;
    const float a[3] = { 0, 0, 0 }, b[3] = { 0, 0, -1 }, bad[3] = { NAN, 0, 0 };
    static const struct { float vfov, near, far; } row[] = {
        { 0, 1, 2 }, { 180, 1, 2 }, { -1, 1, 2 }, { NAN, 1, 2 }, { 60, 0, 2 },
        { 60, 2, 2 }, { 60, NAN, 2 }, { 60, 1, NAN }
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++)
        assert_int_equal(hl_camera_look_at(&c, a, b, row[i].vfov, row[i].near,
                                           row[i].far), HL_ERR_INVALID);
    assert_int_equal(hl_camera_look_at(&c, a, a, 60, 1, 2), HL_ERR_INVALID);
    assert_int_equal(hl_camera_look_at(&c, a, bad, 60, 1, 2), HL_ERR_INVALID);
    assert_int_equal(hl_camera_look_at(&c, a, b, 179.9f, 1, 2), HL_OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_rule_of_a_light_is_named),
        cmocka_unit_test(what_a_kind_does_not_read_may_be_anything),
        cmocka_unit_test(no_lit_pixel_is_outside_a_lights_rectangle),
        cmocka_unit_test(lights_that_touch_the_cameras_plane_keep_the_screen),
        cmocka_unit_test(what_cannot_light_is_left_out),
        cmocka_unit_test(a_light_is_written_in_view_space),
        cmocka_unit_test(a_world_box_holds_its_corners_and_no_more),
        cmocka_unit_test(a_sphere_touches_what_is_nearer_than_its_radius),
        cmocka_unit_test(no_visible_box_is_culled),
        cmocka_unit_test(a_camera_looks_down_minus_z),
        cmocka_unit_test(a_camera_that_is_none_is_refused),
    };
    return cmocka_run_group_tests_name("lights", tests, NULL, NULL);
}
