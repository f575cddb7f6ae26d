/* SPDX-License-Identifier: Zlib */
/* Lights by stencil volumes, on every backend and by every profile's rules:
 * they light what their scissor rectangles alone light. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { LW = 100, LH = 56, TEXELS = LW * LH };

static const char *const profiles[] = { "native", "dx10", "ps3", "xbox360" };

struct picture {
    struct hlc_texels light;
    struct hl_plan plan;
    struct hl_frame_stats stats;
};

/* The L-buffer; `texels`: of volume_texels, 0: the path RECTS in single
 * draws. */
static void light_of(struct picture *out, struct fk_scene *s, uint32_t texels)
{
    struct fk_run run;
    s->needs.light_width = LW;
    s->needs.light_height = LH;
    s->needs.batch = 1;
    s->needs.light_path = texels ? HL_LIGHT_PATH_VOLUMES
                                 : HL_LIGHT_PATH_RECTS;
    s->needs.volume_texels = texels;
    fk_prepare(&run, s, HL_PIPELINE_INFERRED);
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &s->frame, &out->stats), HL_OK);
    assert_int_equal(hlc_texels_read(&out->light, s->m->device,
                                     hl_renderer_target(run.r,
                                                        HL_ROLE_LIGHT)),
                     HL_OK);
    out->plan = run.plan;
    fk_destroy(&run);
}

static size_t bytes_of(const struct hlc_texels *t)
{
    return (size_t)t->width * t->height * hl_format_info(t->format)->bytes;
}

static uint32_t lit_texels(const struct hlc_texels *t)
{
    uint32_t n = 0;
    for (size_t i = 0; i < TEXELS; i++) {
        float x[4];
        hlc_texel(x, t, i);
        n += x[0] + x[1] + x[2] > 0;
    }
    return n;
}

/* The same depths and draws but for the stencil: the same bits. And every
 * light left the stencil at 0, or a later one would differ. */
static void compare(struct fk_scene *s, uint32_t volumes, uint32_t least_lit)
{
    struct picture with, without;
    light_of(&with, s, 1);
    light_of(&without, s, 0xffffffffu);
    assert_true(with.plan.infinite_far);
    assert_int_equal(with.stats.light_volumes, volumes);
    assert_int_equal(without.stats.light_volumes, 0);
    assert_int_equal(bytes_of(&with.light), bytes_of(&without.light));
    uint32_t lit = lit_texels(&without.light);
    if (lit < least_lit)
        fail_msg("%s: %u texels are lit, not %u", without.plan.profile, lit,
                 least_lit);
    if (memcmp(with.light.bytes, without.light.bytes,
               bytes_of(&with.light)) != 0)
        fail_msg("%s: %u texels are lit, %u without volumes",
                 with.plan.profile, lit_texels(&with.light), lit);
    hlc_texels_free(&with.light);
    hlc_texels_free(&without.light);
}

typedef void (*arrange)(struct fk_scene *);

static void on_profiles(void **state, arrange a, uint32_t volumes,
                        uint32_t least_lit)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct fk_scene s;
    for (int i = 0; i < 4; i++) {
        struct ck_machine m;
        uint64_t seed = 9;
        ck_open_as(&m, backend, profiles[i]);
        fk_begin(&s, &m);
        fk_room(&s, 0, &seed);
        a(&s);
        compare(&s, volumes, least_lit);
        fk_end(&s);
        ck_close(&m);
    }
}

/* ---- scenes ------------------------------------------------------------- */

/* Directions of all six axes and others, narrow to wide. The directional one
 * comes first, as it does where others have volumes. */
static void all_kinds(struct fk_scene *s)
{
    uint64_t seed = 3;
    for (int i = 0; i < 20; i++) {
        struct hl_light *l = fk_light(
            s, (float)ck_between(&seed, -5, 5), (float)ck_between(&seed, -2, 3),
            (float)ck_between(&seed, -7, 2), (float)ck_between(&seed, 2, 6));
        for (int c = 0; c < 3; c++)
            l->color[c] = (float)ck_between(&seed, 0.1, 0.3);
        l->falloff = i % 3 ? HL_SMOOTH : HL_INVERSE_SQUARE;
        if (i > 0 && i < 6)
            continue;
        l->kind = i ? HL_SPOT : HL_DIRECTIONAL;
        l->inner = 0.1f;
        l->outer = (float)ck_between(&seed, 0.2, 1.8);
        l->direction[i % 3] = i % 2 ? 1.0f : -1.0f;
        if (i > 14)
            l->direction[(i + 1) % 3] = 0.4f;
    }
}

static void every_kind_is_lit_alike(void **state)
{
    on_profiles(state, all_kinds, 19, 700);
}

/* Far inside; at the eye; the near plane (0.1 m) across the border, which
 * passes 0.05 m before the eye and 0.05 m beside it. */
static void around_the_eye(struct fk_scene *s)
{
    fk_light(s, 0, 0, 8, 12);
    fk_light(s, 0, 0, 10, 14);
    fk_light(s, 0, 0, 4, 6 + 0.05f)->color[1] = 0;
    fk_light(s, 0, 0, 4, 6 - 0.05f)->color[2] = 0;
    fk_light(s, 3, 0, 6, 5 + 0.05f)->color[0] = 0;
    /* A cone with its apex behind the eye. */
    struct hl_light *l = fk_light(s, 0, 0, 10.3f, 16);
    l->kind = HL_SPOT;
    l->direction[2] = -1;
    l->outer = 0.3f;
}

static void the_eye_may_be_inside(void **state)
{
    on_profiles(state, around_the_eye, 6, 1500);
}

/* Far is 19 m, behind the wall at 18 m; all back faces are beyond it. */
static void beyond_far(struct fk_scene *s)
{
    s->frame.camera.far = 19;
    fk_light(s, 0, 0, -6, 12);
    fk_light(s, -3, 1, -7, 5);
    struct hl_light *l = fk_light(s, 2, 0, -4, 30);
    l->kind = HL_SPOT;
    l->direction[2] = -1;
    l->outer = 0.5f;
}

static void volumes_reach_beyond_far(void **state)
{
    on_profiles(state, beyond_far, 3, 1500);
}

/* Surfaces of volumes that graze the wall and the floor. */
static void along_walls(struct fk_scene *s)
{
    for (int i = 0; i < 6; i++) {
        fk_light(s, (float)(2 * i - 5), 0, -6 + 0.001f * (float)i, 2.005f);
        fk_light(s, (float)(2 * i - 5), -1 + 0.001f * (float)i, -2, 2.005f);
    }
}

static void borders_may_graze(void **state)
{
    on_profiles(state, along_walls, 12, 20);
}

/* ---- RECTS -------------------------------------------------------------- */

/* The same without a far plane. Depths are other floats (2^-24 of d, which is
 * z / near of 2^-24 of z: 18 m are off by 1e-6 m of reconstructed position,
 * times 180 for D24), so that a smooth light of radius 2 m and more changes by
 * less than 2 dz / r, 2e-4 of its colour; then half a step of half floats, of
 * sums below 8: 4e-3. */
static void rectangles_light_alike(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct fk_scene s;
    struct ck_machine m;
    struct picture a, b;
    uint64_t seed = 9;
    double worst = 0;
    ck_open_as(&m, backend, "native");
    fk_begin(&s, &m);
    fk_room(&s, 0, &seed);
    all_kinds(&s);
    for (uint32_t i = 0; i < s.frame.n_lights; i++)
        s.light[i].falloff = HL_SMOOTH;
    light_of(&a, &s, 1);
    light_of(&b, &s, 0);
    assert_false(b.plan.infinite_far);
    for (size_t i = 0; i < TEXELS; i++) {
        float x[4], y[4];
        hlc_texel(x, &a.light, i);
        hlc_texel(y, &b.light, i);
        for (int c = 0; c < 3; c++) {
            double e = fabs((double)x[c] - (double)y[c]);
            worst = e > worst ? e : worst;
        }
    }
    print_message("worst %.2g\n", worst);
    assert_true(worst <= 4.2e-3);
    hlc_texels_free(&a.light);
    hlc_texels_free(&b.light);
    fk_end(&s);
    ck_close(&m);
}

/* ---- beyond far --------------------------------------------------------- */

/* What is partly nearer than far is drawn to its end: a floor that leaves the
 * view at 12 m and is seen up to 22 m, lit there too. The filter's depths end
 * at far, so that beyond it no tap is told from another by depth; on one plane
 * that is one light, but for a tap in 0.3 % that the other frame rejects. */
static void what_is_beyond_far_is_lit(void **state)
{
    struct ck_machine *m = ck_machine(state);
    static struct fk_scene s;
    float *picture[2];
    uint32_t off = 0, lit = 0;
    for (int i = 0; i < 2; i++) {
        fk_begin(&s, m);
        struct hl_item *it = fk_add(&s, FK_QUAD, FK_PLAIN, 0, -3, 0, 12);
        it->world[5] = it->world[10] = 0;
        it->world[6] = -12;
        it->world[9] = 12;
        fk_light(&s, 0, 0, -9, 14);
        s.frame.camera.far = i ? 12.0f : 100.0f;
        s.needs.light_width = LW;
        s.needs.light_height = LH;
        s.needs.light_path = HL_LIGHT_PATH_VOLUMES;
        picture[i] = fk_draw(&s, HL_PIPELINE_INFERRED, HL_ROLE_NONE);
        fk_end(&s);
    }
    for (int i = 0; i < FK_W * FK_H; i++) {
        double e = fk_difference(picture[0] + 4 * i, picture[1] + 4 * i, 1);
        lit += picture[0][4 * i] > 0 ? 1 : 0;
        off += e <= 0.01 ? 0 : 1;
    }
    print_message("%u of %u differ\n", off, lit);
    assert_true(lit > 1000);
    assert_true(off * 300 <= lit);
    free(picture[0]);
    free(picture[1]);
}

/* ---- choice ------------------------------------------------------------- */

static void plans_say_why(void **state)
{
    (void)state;
    struct hl_caps caps;
    struct hl_plan p;
    struct hl_needs n = { .width = 1280, .height = 720, .n_lights = 10,
                          .light_path = HL_LIGHT_PATH_VOLUMES };
    bool far = false, texels = false;
    ck_lavapipe(&caps);
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &caps, NULL),
                     HL_OK);
    assert_int_equal(p.light_path, HL_LIGHT_PATH_VOLUMES);
    assert_true(p.infinite_far && p.volume_texels > 1);
    assert_int_equal(p.batch, 1);
    const struct hl_plan_target *t = hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH);
    assert_int_equal(hl_format_info(t->format)->bits[1], 8);
    assert_non_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
    for (uint32_t i = 0; i < p.n_reasons; i++) {
        far |= p.reason[i].why == HL_WHY_INFINITE_FAR;
        texels |= p.reason[i].why == HL_WHY_VOLUME_TEXELS;
    }
    assert_true(far && texels);
    n.volume_texels = 77;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &caps, NULL),
                     HL_OK);
    assert_int_equal(p.volume_texels, 77);
    /* Nobody else pays. */
    n.light_path = HL_LIGHT_PATH_AUTO;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &caps, NULL),
                     HL_OK);
    assert_true(!p.infinite_far && p.volume_texels == 0);
    assert_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
    t = hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH);
    assert_int_equal(t->format, HL_FORMAT_D32_FLOAT);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(every_kind_is_lit_alike),
        DRAWN(the_eye_may_be_inside),
        DRAWN(volumes_reach_beyond_far),
        DRAWN(borders_may_graze),
        DRAWN(rectangles_light_alike),
        DRAWN(what_is_beyond_far_is_lit),
        cmocka_unit_test(plans_say_why),
    };
    return cmocka_run_group_tests_name("light volumes of frames", tests, NULL,
                                       NULL);
}
