/* SPDX-License-Identifier: Zlib */
/* Normals that meshes and maps should not have, through the whole frame: the
 * G-buffer has a direction for each, and no pixel is NaN. (0, 0, -1), where
 * K eq. 1 is singular; no direction at all; such as cancel; negative
 * components in unsigned targets; maps that point into the surface. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H };

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

/* ---- one wall ----------------------------------------------------------- */

struct wall {
    struct ck_machine m;
    struct fk_scene s;
    hl_buf vertex;
    hl_tex map;
    struct fk_vertex v[4];
    uint8_t texel[4];
};

/* Over the whole view, with normals of its own, left and right. */
static void begin(struct wall *w, const char *backend, const char *profile,
                  const float left[3], const float right[3])
{
    static const float corner[4][2] = { { -1, -1 }, { 1, -1 }, { 1, 1 },
                                        { -1, 1 } };
    memset(w->v, 0, sizeof w->v);
    for (int i = 0; i < 4; i++) {
        struct fk_vertex *v = &w->v[i];
        memcpy(v->position, corner[i], sizeof corner[i]);
        memcpy(v->normal, i == 0 || i == 3 ? left : right, 12);
        v->tangent[0] = 1;
        v->tangent[3] = hl_mesh_pack_tangent_w(1, 0);
        memset(v->color, 255, 4);
    }
    struct hl_buf_desc d = { "wall", sizeof w->v, HL_BUF_VERTEX, false, w->v };
    ck_open_as(&w->m, backend, profile);
    fk_begin(&w->s, &w->m);
    assert_int_equal(hl_buf_create(w->m.device, &w->vertex, &d), HL_OK);
    struct hl_item *it = fk_add(&w->s, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
    it->vertex[0] = w->vertex;
    struct hl_light *l = fk_light(&w->s, 3, 2, 6, 40);
    l->color[0] = l->color[1] = l->color[2] = 0.5f;
    fk_material(&w->s, it)->no_specular = false;
    w->s.needs.light_width = FK_W;
    w->s.needs.light_height = FK_H;
}

/* A map of one texel. */
static void begin_map(struct wall *w, const char *backend,
                      const char *profile, const uint8_t texel[3])
{
    static const float front[3] = { 0, 0, 1 };
    struct hl_tex_desc d = { .label = "map", .width = 1, .height = 1 };
    begin(w, backend, profile, front, front);
    memcpy(w->texel, texel, 3);
    w->texel[3] = 255;
    assert_int_equal(hl_tex_create(w->m.device, &w->map, &d), HL_OK);
    assert_int_equal(hl_tex_write(w->m.device, w->map, 0, w->texel, 4),
                     HL_OK);
    struct hl_item *it = &w->s.item[0];
    it->surface = FK_FULL;
    it->texture[2].tex = w->map;
    w->s.surface[FK_FULL].textures |= HL_TEXTURED_NORMAL;
}

static void end(struct wall *w)
{
    hl_tex_destroy(w->m.device, &w->map);
    hl_buf_destroy(w->m.device, &w->vertex);
    fk_end(&w->s);
    ck_close(&w->m);
}

/* Texels as they are read; and frames that are numbers, not negative. */
static void draw(struct wall *w, hl_vec3 *normals)
{
    struct fk_run run;
    struct hlc_texels t;
    float v[4], pair[2];
    fk_prepare(&run, &w->s, HL_PIPELINE_INFERRED);
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &w->s.frame, NULL), HL_OK);
    assert_int_equal(hlc_texels_read(&t, w->m.device,
                                     hl_renderer_output(run.r)), HL_OK);
    for (size_t i = 0; i < N; i++) {
        hlc_texel(v, &t, i);
        for (int k = 0; k < 3; k++)
            assert_true(v[k] >= 0 && v[k] < 10);
    }
    hlc_texels_free(&t);
    assert_int_equal(hlc_texels_read(&t, w->m.device,
                                     hl_renderer_target(run.r,
                                                        HL_ROLE_NORMAL)),
                     HL_OK);
    for (size_t i = 0; i < N; i++) {
        hlc_texel(v, &t, i);
        hlc_two16(pair, run.plan.two16, v);
        normals[i] = hl_normal_decode(hl_v2(hl_unorm_to_snorm(pair[0]),
                                            hl_unorm_to_snorm(pair[1])));
    }
    hlc_texels_free(&t);
    fk_destroy(&run);
}

/* Half a step d of n' turns a normal by at most 2 d / cos(theta / 2), theta
 * from the view axis (pack.h); up to 139 degrees 1.2e-4, sum of two axes;
 * 1e-6 of floats. */
static void check_is(const hl_vec3 *normals, double x, double y, double z)
{
    double l = sqrt(x * x + y * y + z * z);
    for (int i = 0; i < N; i++) {
        ck_near((double)normals[i].x, x / l, 1.3e-4);
        ck_near((double)normals[i].y, y / l, 1.3e-4);
        ck_near((double)normals[i].z, z / l, 1.3e-4);
    }
}

static const char *backend_of(void **state)
{
    return ck_machine(state)->backend->name;
}

/* ---- tests -------------------------------------------------------------- */

static void negative_components_come_back(void **state)
{
    static const float n[][3] = { { -0.6f, -0.6f, 0.5291503f },
                                  { -0.8f, 0.6f, 0 }, { 0.6f, -0.8f, 0 },
                                  { -0.7f, -0.5f, -0.5099020f } };
    static struct wall w;
    static hl_vec3 normals[N];
    for (int i = 0; i < 4; i++) {
        const float *a = n[i];
        begin(&w, backend_of(state), profiles[3 - i], a, a);
        draw(&w, normals);
        check_is(normals, (double)a[0], (double)a[1], (double)a[2]);
        end(&w);
    }
}

/* All of them face the viewer, as eq. 1's rule for what it cannot encode. */
static void no_directions_face_the_viewer(void **state)
{
    const float n[][3] = { { 0, 0, 0 }, { 0, 0, -1 }, { NAN, 0, 1 },
                           { NAN, NAN, NAN }, { INFINITY, 0, 0 },
                           { 0, -INFINITY, 1 } };
    static struct wall w;
    static hl_vec3 normals[N];
    for (int i = 0; i < 6; i++) {
        const float *a = n[i];
        begin(&w, backend_of(state), profiles[i % 4], a, a);
        draw(&w, normals);
        check_is(normals, 0, 0, 1);
        end(&w);
    }
}

/* Left and right are opposite: on the way x goes through zero, and nothing
 * else is there. */
static void opposite_normals_cancel_to_numbers(void **state)
{
    static const float left[3] = { -1, 0, 0 }, right[3] = { 1, 0, 0 };
    static struct wall w;
    static hl_vec3 normals[N];
    for (int i = 0; i < 4; i++) {
        begin(&w, backend_of(state), profiles[i], left, right);
        draw(&w, normals);
        for (int k = 0; k < N; k++) {
            hl_vec3 n = normals[k];
            double l = sqrt((double)hl_dot3(n, n));
            ck_near(l, 1, 2e-4);
            /* To its side, or to the viewer where it was nothing. */
            assert_true(n.z > 0.9f || (n.x < -0.9f && k % FK_W < FK_W / 2) ||
                        (n.x > 0.9f && k % FK_W >= FK_W / 2));
        }
        end(&w);
    }
}

/* Codes of maps: straight in, which no half-sphere has, gives the viewer's
 * side; aslant in is kept. 128 is 1/255 right of the middle. */
static void maps_may_point_away(void **state)
{
    static const struct { uint8_t texel[3]; bool kept; } maps[] = {
        { { 255, 128, 64 }, true }, { { 0, 40, 90 }, true },
        { { 128, 255, 128 }, true }, { { 128, 128, 0 }, false } };
    static struct wall w;
    static hl_vec3 normals[N];
    for (int i = 0; i < 4; i++) {
        const uint8_t *c = maps[i].texel;
        double x = c[0] / 127.5 - 1, y = c[1] / 127.5 - 1;
        double z = c[2] / 127.5 - 1;
        begin_map(&w, backend_of(state), profiles[i], c);
        draw(&w, normals);
        if (maps[i].kept)
            check_is(normals, x, y, z);
        else
            for (int k = 0; k < N; k++)
                ck_near((double)hl_dot3(normals[k], normals[k]), 1, 2e-4);
        end(&w);
    }
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(negative_components_come_back),
        DRAWN(no_directions_face_the_viewer),
        DRAWN(opposite_normals_cancel_to_numbers),
        DRAWN(maps_may_point_away),
    };
    return cmocka_run_group_tests_name("normals of frames", tests, NULL,
                                       NULL);
}
