/* SPDX-License-Identifier: Zlib */
/* Shadow maps on the host: what they hold, where points fall, that nothing
 * crawls, and that no plane shades itself. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/shadow_map.h"
#include "core/vec.h"
#include "tests/check.h"

static const struct hl_shadow_target one = { 512, 1, false, 24 };
static const struct hl_shadow_target six = { 512, 6, true, 0 };

static void direct(float *out, uint64_t *seed)
{
    double l = 0;
    for (int i = 0; i < 3; i++) {
        out[i] = (float)ck_between(seed, -1, 1);
        l += (double)out[i] * (double)out[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = l > 0.01 ? (float)((double)out[i] / sqrt(l)) : i == 1;
}

static struct hl_light light_of(enum hl_light_kind kind, uint64_t *seed)
{
    struct hl_light l;
    memset(&l, 0, sizeof l);
    l.kind = kind;
    l.radius = (float)ck_between(seed, 2, 20);
    l.outer = (float)ck_between(seed, 0.1, 1.2);
    for (int i = 0; i < 3; i++)
        l.position[i] = (float)ck_between(seed, -10, 10);
    direct(l.direction, seed);
    return l;
}

static struct hl_camera camera_at(float x, float y, float z)
{
    const float eye[3] = { x, y, z }, target[3] = { x + 1, y - 1, z - 3 };
    struct hl_camera c;
    memset(&c, 0, sizeof c);
    assert_int_equal(hl_camera_look_at(&c, eye, target, 60, 0.1f, 40), HL_OK);
    return c;
}

static struct hl_shadow_scene scene_of(const struct hl_camera *c)
{
    struct hl_shadow_scene s = { { { 0, 0, 0 }, 0 },
                                 { { -50, -50, -50 }, { 50, 50, 50 } } };
    hl_shadow_frustum(&s.seen, c, 16.0 / 9);
    return s;
}

/* ---- stages' view of a point -------------------------------------------- */

static hl_vec3 by_block(const struct hl_shadow_block *b, hl_vec3 v, float w)
{
    const hl_vec4 *c = b->light.column;
    return hl_v3(c[0].x * v.x + c[1].x * v.y + c[2].x * v.z + c[3].x * w,
                 c[0].y * v.x + c[1].y * v.y + c[2].y * v.z + c[3].y * w,
                 c[0].z * v.x + c[1].z * v.y + c[2].z * v.z + c[3].z * w);
}

/* Where the stage looks for world point p, not lifted: normal 0. */
static hl_vec3 looked_up(const struct hl_shadow_map *m,
                         const struct hl_camera *cam, hl_vec3 p, hl_vec3 n)
{
    struct hl_shadow_block b;
    struct hl_shadow_error none = { 0, 0 };
    hl_shadow_block_write(&b, m, cam, none);
    hl_vec3 q = by_block(&b, hl_transform_point(cam->view, p), 1);
    hl_vec3 k = by_block(&b, hl_transform_dir(cam->view, n), 0);
    return hl_shadow_place(m->kind, q, k, b.map, b.depth, 0,
                           (float)m->target.side);
}

/* Where the rasteriser puts it: texels of the target, and depth. */
static bool drawn_at(const struct hl_shadow_map *m, uint32_t face, hl_vec3 p,
                     double out[3])
{
    const float world[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    uint32_t w = m->target.side * (m->target.faces == 6 ? 3 : 1);
    uint32_t h = m->target.side * (m->target.faces == 6 ? 2 : 1);
    float c[16];
    double v[4];
    hl_shadow_clip(c, m, face, world);
    for (int i = 0; i < 4; i++)
        v[i] = (double)c[i] * (double)p.x + (double)c[4 + i] * (double)p.y +
               (double)c[8 + i] * (double)p.z + (double)c[12 + i];
    out[0] = (v[0] / v[3] + 1) * 0.5 * w;
    out[1] = (v[1] / v[3] + 1) * 0.5 * h;
    out[2] = v[2] / v[3];
    return v[3] > 0;
}

static bool inside(const struct hl_rect *r, const double at[3], double edge)
{
    return at[0] >= r->x + edge && at[0] <= r->x + r->width - edge &&
           at[1] >= r->y + edge && at[1] <= r->y + r->height - edge &&
           at[2] >= 0 && at[2] <= 1;
}

/* 0.01 to 0.999 of a light's reach away, in its cone. */
static hl_vec3 lit_point(const struct hl_light *l, uint64_t *seed)
{
    float d[3];
    double cosine = -1;
    do {
        direct(d, seed);
        cosine = 0;
        for (int i = 0; i < 3; i++)
            cosine += (double)d[i] * (double)l->direction[i];
    } while (l->kind == HL_SPOT && cosine < cos((double)l->outer));
    float s = l->radius * (float)ck_between(seed, 0.01, 0.999);
    return hl_v3(l->position[0] + d[0] * s, l->position[1] + d[1] * s,
                 l->position[2] + d[2] * s);
}

/* In texels: positions are of 30 in floats of 24 bits, over slopes of which a
 * texel is 1/500, a hundredth of 20 away: 30 * 2^-23 * 500 / 0.2 = 0.01. Depth
 * there changes by n / c^2 = 1/1024 of the reach over 1/100^2 of it, 10 of 20
 * metres: 30 * 2^-23 / 2 = 2e-6, and a few roundings. */
static void the_stage_looks_where_it_was_drawn(void **state)
{
    uint64_t seed = 1;
    (void)state;
    for (int i = 0; i < 3000; i++) {
        enum hl_light_kind kind = (enum hl_light_kind)(i % 3);
        struct hl_light l = light_of(kind, &seed);
        struct hl_camera cam = camera_at((float)ck_between(&seed, -5, 5), 3,
                                         (float)ck_between(&seed, -5, 5));
        struct hl_shadow_scene s = scene_of(&cam);
        struct hl_shadow_map m;
        hl_shadow_fit(&m, &l, i % 2 || kind == HL_POINT ? &six : &one, &s);
        assert_int_equal(m.kind, kind == HL_POINT ? HL_MAP_POINT
                         : kind == HL_SPOT ? HL_MAP_CONE : HL_MAP_PARALLEL);
        hl_vec3 p = lit_point(&l, &seed), none = { 0, 0, 0 };
        hl_vec3 at = looked_up(&m, &cam, p, none);
        uint32_t found = 0;
        for (uint32_t k = 0; k < hl_shadow_faces(&m); k++) {
            struct hl_rect r = hl_shadow_rect(&m, k);
            double d[3];
            if (!drawn_at(&m, k, p, d) ||
                !inside(&r, d, (double)HL_SHADOW_BORDER - 0.05))
                continue;
            if (fabs(d[0] - (double)at.x) > 2 || fabs(d[1] - (double)at.y) > 2)
                continue;
            found++;
            ck_near(at.x, d[0], 0.02);
            ck_near(at.y, d[1], 0.02);
            ck_near(at.z, d[2], 2e-5);
        }
        /* Six: on the seam two maps would do, and one is looked at. */
        if (kind != HL_DIRECTIONAL)
            assert_int_equal(found, 1);
    }
}

/* ---- faces -------------------------------------------------------------- */

/* One face each, that of the largest part; its axes are right-handed and c is
 * that part. */
static void each_direction_has_one_face(void **state)
{
    uint64_t seed = 2;
    uint32_t count[6] = { 0 };
    (void)state;
    for (int i = 0; i < 60000; i++) {
        float d[3];
        direct(d, &seed);
        hl_vec3 q = hl_load3(d);
        float f = hl_shadow_face(q);
        hl_vec3 t = hl_shadow_turn(f, q);
        assert_true(f >= 0 && f <= 5 && f == floorf(f));
        count[(int)f]++;
        assert_true(t.z > 0 && fabsf(t.x) <= t.z && fabsf(t.y) <= t.z);
    }
    for (int k = 0; k < 6; k++) {
        hl_vec3 x = hl_shadow_turn((float)k, hl_v3(1, 0, 0));
        hl_vec3 y = hl_shadow_turn((float)k, hl_v3(0, 1, 0));
        hl_vec3 z = hl_shadow_turn((float)k, hl_v3(0, 0, 1));
        assert_true(hl_dot3(hl_cross3(x, y), z) == 1);
        /* A sixth of a cube's directions, within five deviations. */
        assert_in_range(count[k], 8000, 12000);
    }
}

/* ---- culling ------------------------------------------------------------ */

/* What has a point on a map touches it; what does not touch has none. */
static void boxes_on_a_map_are_kept(void **state)
{
    uint64_t seed = 3;
    uint32_t kept = 0, left = 0;
    (void)state;
    for (int i = 0; i < 2000; i++) {
        struct hl_light l = light_of((enum hl_light_kind)(i % 3), &seed);
        struct hl_camera cam = camera_at(0, 3, 8);
        struct hl_shadow_scene s = scene_of(&cam);
        struct hl_shadow_map m;
        hl_shadow_fit(&m, &l, &six, &s);
        hl_vec3 c = hl_v3((float)ck_between(&seed, -30, 30),
                          (float)ck_between(&seed, -30, 30),
                          (float)ck_between(&seed, -30, 30));
        float e = (float)ck_between(&seed, 0.1, 3);
        struct hl_box b = { { c.x - e, c.y - e, c.z - e },
                            { c.x + e, c.y + e, c.z + e } };
        for (uint32_t k = 0; k < hl_shadow_faces(&m); k++) {
            struct hl_rect r = hl_shadow_rect(&m, k);
            bool any = false;
            for (int j = 0; j < 64; j++) {
                hl_vec3 p = hl_v3(c.x + e * (float)(j % 4 * 2 - 3) / 3,
                                  c.y + e * (float)(j / 4 % 4 * 2 - 3) / 3,
                                  c.z + e * (float)(j / 16 * 2 - 3) / 3);
                double d[3];
                any |= drawn_at(&m, k, p, d) && inside(&r, d, 0);
            }
            bool touches = hl_shadow_touches(&m, k, &b);
            assert_true(touches || !any);
            kept += touches;
            left += !touches;
        }
    }
    assert_true(kept > 200 && left > 200);
}

/* ---- stability ---------------------------------------------------------- */

/* All corners of the view lie in the sphere; turned, moved or not, it is as
 * large. */
static void the_sphere_holds_the_view(void **state)
{
    uint64_t seed = 4;
    (void)state;
    for (int i = 0; i < 500; i++) {
        struct hl_camera cam;
        float eye[3], to[3];
        double aspect = ck_between(&seed, 0.5, 2.5);
        for (int k = 0; k < 3; k++) {
            eye[k] = (float)ck_between(&seed, -9, 9);
            to[k] = (float)ck_between(&seed, -9, 9);
        }
        float fov = (float)ck_between(&seed, 10, 120);
        if (hl_camera_look_at(&cam, eye, to, fov, 0.2f, 30) != HL_OK)
            continue;
        struct hl_shadow_sphere s, t;
        hl_shadow_frustum(&s, &cam, aspect);
        for (int j = 0; j < 8; j++) {
            double z = j & 1 ? 30 : 0.2, y = z * (double)cam.tan_half_y;
            double v[3] = { j & 2 ? y * aspect : -y * aspect, j & 4 ? y : -y,
                            -z }, d2 = 0;
            for (int k = 0; k < 3; k++) {
                double w = (double)eye[k] - s.center[k];
                for (int a = 0; a < 3; a++)
                    w += (double)cam.view[k * 4 + a] * v[a];
                d2 += w * w;
            }
            /* The view's rows are unit to 2^-23. */
            assert_true(sqrt(d2) <= s.radius * (1 + 1e-5));
        }
        /* No middle of an axis does with less than 0.99 of it. */
        double t2 = pow((double)cam.tan_half_y, 2) * (1 + aspect * aspect);
        for (int j = 0; j <= 100; j++) {
            double z = 0.3 * j, far = (30 - z) * (30 - z) + 900 * t2;
            double near = (z - 0.2) * (z - 0.2) + 0.04 * t2;
            assert_true(sqrt(far > near ? far : near) >= s.radius * 0.99);
        }
        cam = camera_at(3, 2, 1);
        cam.tan_half_y = tanf(fov * 3.14159265f / 360);
        cam.near = 0.2f;
        cam.far = 30;
        hl_shadow_frustum(&t, &cam, aspect);
        ck_near(t.radius, s.radius, s.radius * 1e-6);
    }
}

static void scenes_grow_by_steps(void **state)
{
    struct hl_shadow_sphere s;
    uint64_t seed = 5;
    double last = 0;
    uint32_t sizes = 0;
    (void)state;
    for (int i = 0; i < 1000; i++) {
        float e = 1 + (float)i * 0.001f;
        struct hl_box b = { { -e, 0, 0 }, { e, 0, 0 } };
        hl_shadow_around(&s, &b);
        assert_true(s.radius >= (double)e && s.radius <= (double)e * 1.0626);
        sizes += s.radius != last;
        last = s.radius;
    }
    assert_in_range(sizes, 16, 17);
    for (int i = 0; i < 300; i++) {
        float e = (float)pow(10, ck_between(&seed, -5, 9));
        struct hl_box b = { { -e, 0, 0 }, { e, 0, 0 } };
        hl_shadow_around(&s, &b);
        assert_true(s.radius >= (double)e && s.radius <= (double)e * 1.0626);
    }
}

/* 64 moves of parts of a texel, and turns: a point keeps its place within a
 * texel. 0.02: as above. */
static void directional_maps_move_by_whole_texels(void **state)
{
    uint64_t seed = 6;
    uint32_t moved = 0;
    (void)state;
    for (int k = 0; k < 20; k++) {
        struct hl_light l = light_of(HL_DIRECTIONAL, &seed);
        hl_vec3 p = { 1, 2, -5 }, none = { 0, 0, 0 }, first = { 0, 0, 0 };
        double scale = 0;
        for (int i = 0; i < 64; i++) {
            struct hl_camera cam = camera_at((float)i * 0.0213f, 3,
                                             8 + (float)i * 0.0117f);
            struct hl_shadow_scene s = scene_of(&cam);
            struct hl_shadow_map m;
            hl_shadow_fit(&m, &l, &one, &s);
            hl_vec3 at = looked_up(&m, &cam, p, none);
            first = i ? first : at;
            scale = i ? scale : m.scale;
            double dx = (double)at.x - (double)first.x;
            double dy = (double)at.y - (double)first.y;
            ck_near(m.scale, scale, scale * 1e-9);
            ck_near(dx, floor(dx + 0.5), 0.02);
            ck_near(dy, floor(dy + 0.5), 0.02);
            moved += fabs(dx) > 0.5 || fabs(dy) > 0.5;
        }
    }
    assert_true(moved > 200);
}

/* ---- bias --------------------------------------------------------------- */

/* Depth at the texel's centre of the plane through p with normal n, from the
 * rasteriser's side: along the texel's ray. */
static double plane_depth(const struct hl_shadow_map *m, uint32_t face,
                          hl_vec3 p, hl_vec3 n, double x, double y)
{
    /* Two points on the texel's line: the map's matrix solved numerically in
     * the plane, by a basis of it. */
    hl_vec3 u = fabsf(n.x) > 0.7f ? hl_v3(0, 1, 0) : hl_v3(1, 0, 0);
    u = hl_normalize3(hl_cross3(n, u));
    hl_vec3 v = hl_cross3(n, u);
    double s = 0, t = 0, d[3], a[3], b[3];
    const double e = 1e-3;
    for (int i = 0; i < 30; i++) {
        hl_vec3 c = hl_add3(p, hl_add3(hl_scale3(u, (float)s),
                                       hl_scale3(v, (float)t)));
        drawn_at(m, face, c, d);
        drawn_at(m, face, hl_add3(c, hl_scale3(u, (float)e)), a);
        drawn_at(m, face, hl_add3(c, hl_scale3(v, (float)e)), b);
        double j[4] = { (a[0] - d[0]) / e, (b[0] - d[0]) / e,
                        (a[1] - d[1]) / e, (b[1] - d[1]) / e };
        double det = j[0] * j[3] - j[1] * j[2];
        double rx = x - d[0], ry = y - d[1];
        s += (rx * j[3] - ry * j[1]) / det * 0.7;
        t += (ry * j[0] - rx * j[2]) / det * 0.7;
    }
    return fabs(x - d[0]) + fabs(y - d[1]) < 0.05 ? d[2] : NAN;
}

/* At all angles up to 85 degrees and all 16 taps the plane is not in front of
 * its own lifted point. */
static void planes_do_not_shade_themselves(void **state)
{
    uint64_t seed = 7;
    uint32_t seen = 0;
    (void)state;
    for (int i = 0; i < 600; i++) {
        enum hl_light_kind kind = (enum hl_light_kind)(i % 3);
        struct hl_light l = light_of(kind, &seed);
        struct hl_camera cam = camera_at(0, 3, 8);
        struct hl_shadow_scene s = scene_of(&cam);
        struct hl_shadow_map m;
        float d[3];
        hl_shadow_fit(&m, &l, &six, &s);
        hl_vec3 p = kind == HL_DIRECTIONAL ? hl_v3(1, 1, 1)
                                           : lit_point(&l, &seed);
        hl_vec3 to = kind == HL_DIRECTIONAL
                     ? hl_scale3(hl_load3(l.direction), -1)
                     : hl_normalize3(hl_sub3(hl_load3(l.position), p));
        direct(d, &seed);
        hl_vec3 n = hl_load3(d);
        float cosine = hl_dot3(n, to);
        if (cosine < 0) {
            n = hl_scale3(n, -1);
            cosine = -cosine;
        }
        if (cosine < 0.0872f)
            continue;
        hl_vec3 at = looked_up(&m, &cam, p, n);
        uint32_t face = (uint32_t)(at.x / 512) + 3 * (uint32_t)(at.y / 512);
        double bx = floor((double)at.x - 0.5), by = floor((double)at.y - 0.5);
        for (int k = 0; k < 16; k++) {
            double z = plane_depth(&m, face, p, n, bx - 0.5 + k % 4,
                                   by - 0.5 + k / 4);
            if (isnan(z))
                continue;
            seen++;
            /* Reversed: near is 1. 2e-7: rounding of both. */
            if ((double)at.z < z - 2e-7)
                fail_msg("light %d, tap %d, cosine %g: %.9g below %.9g",
                         (int)kind, k, (double)cosine, (double)at.z, z);
        }
    }
    assert_true(seen > 4000);
}

/* No point is lifted by more than K sqrt 2 + 1/2 texels: what shadow is lost
 * at contacts. */
static void lifts_are_bounded(void **state)
{
    uint64_t seed = 8;
    double most = 0;
    (void)state;
    for (int i = 0; i < 20000; i++) {
        float d[3];
        direct(d, &seed);
        hl_vec4 map = hl_v4(100, 0.01f, 1, 0), depth = hl_v4(-1, 1, 0.01f, 0);
        hl_vec3 n = hl_load3(d), q = hl_v3(0, 0, 5);
        hl_vec3 a = hl_shadow_place(HL_MAP_CONE, q, n, map, depth, 0, 512);
        /* x = 256 + 100 n.x h / (5 + n.z h), depth 1 - 1 / (5 + n.z h). */
        double c = 1 / (1 - (double)a.z);
        double h = fabs(n.z) > 0.3f ? (c - 5) / (double)n.z
                   : ((double)a.x - 256) / 100 * c / (double)n.x;
        most = fabs(h) > most && fabsf(n.x) > 0.01f ? fabs(h) : most;
    }
    /* 5 m away a texel is 5 cm; depth as above in floats: 25 * 2^-24 / 0.3. */
    double bound = 0.05 * (2 * sqrt(2.0) + 0.5);
    assert_true(most <= bound + 1e-3 && most > bound * 0.98);
}

/* A step of stored depth moves the point by no more than is told; stages'
 * slanted rays take half as much again, which is told too. */
static void depth_steps_are_bounded(void **state)
{
    uint64_t seed = 10;
    const double n = 0.1, f = 1000, a = -n * f / (f - n), b = -f / (f - n);
    (void)state;
    for (int i = 0; i < 2000; i++) {
        uint32_t bits = i % 2 ? 24 : 16;
        struct hl_shadow_error e = hl_shadow_depth_error(bits, (float)a);
        double z = ck_between(&seed, 0.2, i % 2 ? 900 : 100);
        double step = 1 / pow(2, bits), moved = a / (a / z - b + step + b) - z;
        double told = (double)e.x * z * z + (double)e.y * z;
        /* To the first order: its square is a few hundredths of it here. */
        assert_true(fabs(moved) * 1.5 <= told * 1.1);
        assert_true(told < 2 * fabs(moved) + 1e-5 * z);
    }
    assert_true(hl_shadow_depth_error(0, (float)a).x == 0);
    assert_true(hl_shadow_depth_error(32, (float)a).x == 0);
}

/* ---- kernel ------------------------------------------------------------- */

static void the_kernel_sums_to_one(void **state)
{
    (void)state;
    for (int i = 0; i <= 64; i++) {
        hl_vec4 w = hl_shadow_weights((float)i / 64);
        ck_near(w.x + w.y + w.z + w.w, 1, 2e-7);
        /* Its middle is the point: sum of weight and place of taps -1..2. */
        ck_near(-w.x + w.z + 2 * w.w, (double)i / 64, 2e-7);
    }
}

static void wide_spots_need_six_maps(void **state)
{
    uint64_t seed = 9;
    struct hl_shadow_map m;
    struct hl_light l = light_of(HL_SPOT, &seed);
    (void)state;
    l.outer = 1.3f;
    hl_shadow_fit(&m, &l, &one, NULL);
    assert_int_equal(m.kind, HL_MAP_NONE);
    assert_int_equal(hl_shadow_faces(&m), 0);
    hl_shadow_fit(&m, &l, &six, NULL);
    assert_int_equal(hl_shadow_faces(&m), 6);
    l.kind = HL_POINT;
    hl_shadow_fit(&m, &l, &one, NULL);
    assert_int_equal(m.kind, HL_MAP_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_stage_looks_where_it_was_drawn),
        cmocka_unit_test(each_direction_has_one_face),
        cmocka_unit_test(boxes_on_a_map_are_kept),
        cmocka_unit_test(the_sphere_holds_the_view),
        cmocka_unit_test(scenes_grow_by_steps),
        cmocka_unit_test(directional_maps_move_by_whole_texels),
        cmocka_unit_test(planes_do_not_shade_themselves),
        cmocka_unit_test(lifts_are_bounded),
        cmocka_unit_test(depth_steps_are_bounded),
        cmocka_unit_test(the_kernel_sums_to_one),
        cmocka_unit_test(wide_spots_need_six_maps),
    };
    return cmocka_run_group_tests_name("shadow maps on the host", tests, NULL,
                                       NULL);
}
