/* SPDX-License-Identifier: Zlib */
/* Decals (K 5.2): blended into the normals where a machine can, a translucent
 * layer where it cannot. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"
#include "tests/console_kit.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H, LIGHT_W = 100, LIGHT_H = 56, TEXELS = 100 * 56,
       WALL = 0, DECAL = 1, MIDDLE = LIGHT_H / 2 * LIGHT_W + LIGHT_W / 2 };

/* The decal's normal, and how far it lies before the wall: less than a tap
 * may be off at 10 m, 10 m / 1000 and a step of 100 m / 65535. */
static const float slant[3] = { 0.6f, 0, 0.8f };
#define BEFORE 0.005f

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };
static struct fk_scene scene;
static hl_buf corners;

/* ---- scenes ------------------------------------------------------------- */

/* A quad of 2 x 2 facing +z that says it faces elsewhere. */
static hl_buf slanted_quad(struct hl_device *d)
{
    struct fk_vertex v[4];
    hl_buf b;
    memset(v, 0, sizeof v);
    for (int i = 0; i < 4; i++) {
        v[i].position[0] = i == 1 || i == 2 ? 1.0f : -1.0f;
        v[i].position[1] = i >= 2 ? 1.0f : -1.0f;
        memcpy(v[i].normal, slant, sizeof slant);
        v[i].tangent[0] = 1;
        v[i].tangent[3] = hl_mesh_pack_tangent_w(1, 0);
        memset(v[i].color, 255, 4);
    }
    struct hl_buf_desc desc = { "decal", sizeof v, HL_BUF_VERTEX, false, v };
    assert_int_equal(hl_buf_create(d, &b, &desc), HL_OK);
    return b;
}

/* A wall, 10 m away, and a decal in the middle of it, under one light from
 * the right and one from the front. */
static void begin(struct ck_machine *m, float alpha)
{
    static const float from[2][3] = { { -0.8f, 0, -0.6f }, { 0, 0, -1 } };
    fk_begin(&scene, m);
    scene.needs.light_width = LIGHT_W;
    scene.needs.light_height = LIGHT_H;
    scene.surface[FK_BLENDED].blended = false;
    scene.surface[FK_BLENDED].decal = true;
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
    struct hl_item *it = fk_add(&scene, FK_QUAD, FK_BLENDED, 0, 0, BEFORE, 3);
    corners = it->vertex[0] = slanted_quad(m->device);
    it->base_vertex = 0;
    fk_material(&scene, it)->base[3] = alpha;
    for (int i = 0; i < 2; i++) {
        struct hl_light *l = fk_light(&scene, 0, 0, 0, 1);
        l->kind = HL_DIRECTIONAL;
        memcpy(l->direction, from[i], sizeof l->direction);
        for (int c = 0; c < 3; c++)
            l->color[c] = c == i ? 0.25f : 0;
    }
}

static void end(void)
{
    hl_buf_destroy(scene.m->device, &corners);
    fk_end(&scene);
}

static float *texels(struct fk_run *run, hl_tex tex)
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, scene.m->device, tex), HL_OK);
    size_t n = (size_t)t.width * t.height;
    float *out = malloc(n * 4 * sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < n; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    (void)run;
    return out;
}

static void draw(struct fk_run *run, enum hl_pipeline pipeline)
{
    fk_prepare(run, &scene, pipeline);
    assert_int_equal(fk_create(run), HL_OK);
    assert_int_equal(hl_frame_draw(run->r, &scene.frame, &run->stats), HL_OK);
}

/* ---- normals ------------------------------------------------------------ */

static void pair_at(float out[2], const struct fk_run *run, const float *texel)
{
    hlc_two16(out, run->plan.two16, texel);
}

/* The two numbers of a normal as they are stored, in 0..1. */
static void encoded(double out[2], const float n[3])
{
    hl_vec2 e = hl_normal_encode(hl_v3(n[0], n[1], n[2]));
    out[0] = (double)hl_snorm_to_unorm(e.x);
    out[1] = (double)hl_snorm_to_unorm(e.y);
}

/* A target's bytes are another frame's, which has no decal. */
static void same_as_without(struct fk_run *run, enum hl_role role)
{
    struct fk_run bare;
    float *with = texels(run, hl_renderer_target(run->r, role));
    scene.item[DECAL].count = 0;
    fk_prepare(&bare, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&bare), HL_OK);
    assert_int_equal(hl_frame_draw(bare.r, &scene.frame, NULL), HL_OK);
    scene.item[DECAL].count = 6;
    float *without = texels(&bare, hl_renderer_target(bare.r, role));
    assert_memory_equal(with, without, TEXELS * 4 * sizeof *with);
    free(with);
    free(without);
    fk_destroy(&bare);
}

/* Stored numbers are mixed by alpha: a code for the blend's rounding, which
 * may cut, and half of one for each of the two that were mixed. */
static void check_normals(struct fk_run *run, double alpha)
{
    static const float flat[3] = { 0, 0, 1 };
    double wall[2], decal[2];
    float pair[2];
    float *t = texels(run, hl_renderer_target(run->r, HL_ROLE_NORMAL));
    encoded(wall, flat);
    encoded(decal, slant);
    pair_at(pair, run, t + 4 * MIDDLE);
    for (int i = 0; i < 2; i++)
        ck_near((double)pair[i], wall[i] + alpha * (decal[i] - wall[i]),
                2.0 / 65534);
    pair_at(pair, run, t);
    for (int i = 0; i < 2; i++)
        ck_near((double)pair[i], wall[i], 0.6 / 65534);
    free(t);
}

/* With a channel of exponents, but for Xbox 360: 32_FLOAT does not blend. */
static void blended(const char *backend, int profile, float alpha)
{
    struct ck_machine m;
    struct fk_run run;
    bool xbox = profile == 2;
    bool stand_in = xbox && strcmp(backend, "packemu") != 0;
    ck_open_as(&m, backend, profiles[profile]);
    begin(&m, alpha);
    scene.material[WALL].no_specular = xbox;
    scene.material[DECAL].no_specular = xbox;
    scene.material[DECAL].roughness = 0.2f;
    draw(&run, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.decals, stand_in ? HL_DECALS_ALPHA_OBJECTS
                                               : HL_DECALS_BLEND_NORMALS);
    assert_int_equal(run.plan.specular, xbox ? HL_SPECULAR_NONE
                                             : HL_SPECULAR_CHANNEL);
    assert_int_equal(run.stats.decals, !stand_in);
    assert_int_equal(run.stats.stippled + run.stats.unstippled, stand_in);
    if (!stand_in) {
        check_normals(&run, (double)alpha);
        same_as_without(&run, HL_ROLE_DSF);
        same_as_without(&run, HL_ROLE_LIGHT_DEPTH);
    }
    if (!xbox)
        same_as_without(&run, HL_ROLE_EXPONENT);
    fk_destroy(&run);
    end();
    ck_close(&m);
}

/* Over the wall's normals by its alpha, and over nothing else of the wall: all
 * targets of the pass blend. */
static void decals_change_normals_by_their_alpha(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    for (int p = 0; p < 3; p++)
        for (int i = 1; i <= 4; i *= 2)
            blended(backend, p, (float)i * 0.25f);
}

/* ---- where normals do not blend ----------------------------------------- */

/* Its own texels, one of four, with its own id and normal. */
static void packed_normals_make_decals_a_layer(void **state)
{
    struct ck_machine m;
    struct fk_run run;
    uint32_t own = 0, walls = 0;
    ck_open_as(&m, ck_machine(state)->backend->name, "ps3");
    begin(&m, 0.5f);
    scene.needs.translucency = HL_TRANSLUCENCY_2X2;
    draw(&run, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.decals, HL_DECALS_ALPHA_OBJECTS);
    assert_int_equal(run.plan.stipple, 2);
    assert_int_equal(run.stats.decals, 0);
    assert_int_equal(run.stats.stippled, 1);
    float *t = texels(&run, hl_renderer_target(run.r, HL_ROLE_DSF));
    for (int i = 0; i < 64; i++) {
        float pair[2];
        pair_at(pair, &run, t + 4 * (MIDDLE + i % 8 + i / 8 * LIGHT_W));
        float id = pair[1] * run.plan.id_steps;
        own += fabsf(id - (float)scene.item[DECAL].id_base) < 0.5f;
        walls += fabsf(id - (float)scene.item[WALL].id_base) < 0.5f;
    }
    assert_true(own == 16 && walls == 48);
    free(t);
    fk_destroy(&run);
    end();
    ck_close(&m);
}

/* ---- pictures ----------------------------------------------------------- */

/* Opaque in the picture, a decal is its own normal in every way to draw it:
 * light is constant, so that filters add nothing. The light's error, that of
 * normals (half a code and the blend's, 2^-15, is 2 d / cos 37 degrees of
 * angle) and a rounding each of two pictures, blended: 2^-10 of half floats,
 * 2^-7 of 7e3 ones. */
static void pictures_agree(const char *backend, const char *profile)
{
    struct ck_machine m;
    struct fk_run forward, inferred;
    ck_open_as(&m, backend, profile);
    begin(&m, 1);
    draw(&forward, HL_PIPELINE_FORWARD);
    draw(&inferred, HL_PIPELINE_INFERRED);
    enum hl_format f = hl_plan_target(&inferred.plan, HL_ROLE_COLOR)->format;
    double step = f == HL_FORMAT_RGB10A2_FLOAT ? 1.0 / 128 : 1.0 / 1024;
    double most = (double)inferred.plan.light_error + 2.5 / 32768 + 2 * step;
    float *a = texels(&forward, hl_renderer_output(forward.r));
    float *b = texels(&inferred, hl_renderer_output(inferred.r));
    /* The decal is 46 pixels wide and high: inside, and far outside of it. */
    for (int y = 30; y < 60; y++)
        for (int x = 0; x < FK_W; x++)
            if (abs(x - FK_W / 2) < 15 || abs(x - FK_W / 2) > 30)
                assert_true(fk_difference(fk_at(a, x, y), fk_at(b, x, y), 1)
                            <= most);
    /* 0.25 (0.96, 0.8), where the wall has 0.25 (0.6, 1). */
    ck_near((double)fk_at(b, 80, 45)[0], 0.24, most + step);
    ck_near((double)fk_at(b, 80, 45)[1], 0.2, most + step);
    ck_near((double)fk_at(b, 20, 45)[0], 0.15, most + step);
    free(a);
    free(b);
    fk_destroy(&forward);
    fk_destroy(&inferred);
    end();
    ck_close(&m);
}

static void decals_are_lit_by_their_normals(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    for (int p = 0; p < 4; p++)
        pictures_agree(backend, profiles[p]);
}

/* A decal with the wall's own normal and colour cannot be seen: it filters the
 * wall's samples as the wall does, though their region is another. Light falls
 * off, so that one sample in place of four would show; a rounding of half
 * floats is allowed for, as a blend may cut. */
static void decals_take_the_light_below(void **state)
{
    float *picture[2];
    begin(ck_machine(state), 1);
    scene.item[DECAL].vertex[0] = scene.vertex;
    scene.frame.n_lights = 0;
    memset(scene.light, 0, sizeof scene.light);
    fk_light(&scene, 0.3f, 0.2f, 1, 4);
    for (int i = 0; i < 2; i++) {
        struct fk_run run;
        scene.item[DECAL].count = i ? 6 : 0;
        draw(&run, HL_PIPELINE_INFERRED);
        assert_int_equal(run.stats.decals, i);
        picture[i] = texels(&run, hl_renderer_output(run.r));
        fk_destroy(&run);
    }
    assert_true(fk_at(picture[0], 80, 45)[0] > 0.5f);
    assert_true(fk_difference(picture[0], picture[1], N) <= 1.0 / 1024);
    free(picture[0]);
    free(picture[1]);
    end();
}

/* ---- plans -------------------------------------------------------------- */

/* One target that cannot blend rules it out for all. */
static void every_target_of_the_pass_must_blend(void **state)
{
    struct hl_needs n = con_needs();
    struct hl_caps c;
    (void)state;
    ck_lavapipe(&c);
    n.decals = true;
    n.specular = HL_NEED_EXPONENTS;
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    enum hl_format f = hl_plan_target(&p, HL_ROLE_EXPONENT)->format;
    assert_int_equal(p.decals, HL_DECALS_BLEND_NORMALS);
    assert_int_equal(p.stipple, 0);
    assert_int_equal(p.translucency, HL_TRANSLUCENCY_AUTO);
    assert_int_equal(p.pass[p.n_passes - 1].role, HL_PASS_BLENDED);
    c.format[f].use &= (uint8_t)~HL_USE_BLEND;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    assert_int_equal(p.decals, HL_DECALS_ALPHA_OBJECTS);
    assert_true(con_reason(&p, HL_WHY_DECALS_NO_BLEND)->arg[0] == (float)f);
    assert_int_equal(p.stipple, 2);
    /* They are translucent then in all that is chosen for such. */
    n.translucency = HL_TRANSLUCENCY_FORWARD;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    assert_int_equal(p.stipple, 0);
    assert_non_null(con_reason(&p, HL_WHY_BLENDED_FORWARD));
    n.specular = HL_NEED_ONE_EXPONENT;
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    assert_int_equal(p.decals, HL_DECALS_BLEND_NORMALS);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(decals_change_normals_by_their_alpha),
        DRAWN(packed_normals_make_decals_a_layer),
        DRAWN(decals_are_lit_by_their_normals),
        DRAWN(decals_take_the_light_below),
        cmocka_unit_test(every_target_of_the_pass_must_blend),
    };
    return cmocka_run_group_tests_name("decals", tests, NULL, NULL);
}
