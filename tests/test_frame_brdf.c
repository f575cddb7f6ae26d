/* SPDX-License-Identifier: Zlib */
/* Two BRDFs in a frame: what skin is, that exponents and BRDFs come back from
 * their pair, and inferred lighting against forward shading and numbers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H };

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

/* ---- the skin term ------------------------------------------------------ */

static double smooth(double a, double x)
{
    double t = (x - a) / (1 - a);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return t * t * (3 - 2 * t);
}

/* Against the chapter's line in double; the numbers of the comment; floats
 * of about ten operations on numbers up to 3. */
static void skin_is_the_chapters(void **state)
{
    (void)state;
    for (int i = -2000; i <= 2000; i++) {
        double x = i / 2000.0;
        double sub = smooth(-0.2, x) - smooth(0, x);
        double want = (x > 0 ? x : 0) + (sub > 0 ? sub : 0);
        float got = hl_diffuse_skin((float)x);
        ck_near((double)got, want, 2e-6);
        assert_true(got >= 0 && got <= 1.000001f);
        assert_true(got >= (float)x);
    }
    ck_near((double)hl_diffuse_skin(0), 0.0741, 1e-4);
    assert_true(hl_diffuse_skin(-0.2f) == 0 && hl_diffuse_skin(1) == 1);
    assert_true(hl_diffuse_skin(-0.19f) > 0);
}

/* ---- frames ------------------------------------------------------------- */

/* Balls of both kinds over a wall, every other one skin, in grey light, so
 * that highlights are what forward shading has. */
static void make_scene(struct fk_scene *s, struct ck_machine *m)
{
    fk_begin(s, m);
    fk_add(s, FK_QUAD, FK_PLAIN, 0, 0, -3, 12);
    for (int i = 0; i < 8; i++)
        fk_add(s, i & 4 ? FK_BOX : FK_BALL, FK_PLAIN,
               (float)(i % 4) * 4 - 6, i & 4 ? -2 : 2, 0, 1.4f);
    for (uint32_t i = 0; i < s->frame.n_items; i++) {
        struct hl_material *a = &s->material[i];
        a->brdf = i % 2 ? HL_BRDF_SKIN : HL_BRDF_BLINN_PHONG;
        a->no_specular = false;
        a->roughness = i % 4 < 2 ? 0.55f : 0.7f;
    }
    for (int i = 0; i < 3; i++) {
        struct hl_light *l = fk_light(s, (float)i * 7 - 7, 5 - (float)i * 4,
                                      5, 16);
        l->color[0] = l->color[1] = l->color[2] = 0.3f;
        l->kind = i == 1 ? HL_SPOT : HL_POINT;
        l->direction[2] = -1;
        l->inner = 0.5f;
        l->outer = 1.2f;
    }
    s->needs.light_width = FK_W;
    s->needs.light_height = FK_H;
    s->needs.max_error = 1e-4f;
}

/* Not for L-buffers of fixed range: what such a light has at its own place
 * takes all of their codes. */
static void make_inverse(struct fk_scene *s)
{
    struct hl_light *l = &s->light[2];
    l->falloff = HL_INVERSE_SQUARE;
    l->color[0] = l->color[1] = l->color[2] = 8;
}

static float *texels_of(struct fk_run *run, enum hl_role role)
{
    struct hlc_texels t;
    float *out = malloc(N * 4 * sizeof *out);
    assert_non_null(out);
    assert_int_equal(hlc_texels_read(&t, run->scene->m->device,
                                     role ? hl_renderer_target(run->r, role)
                                          : hl_renderer_output(run->r)),
                     HL_OK);
    assert_int_equal(t.width * t.height, N);
    for (size_t i = 0; i < N; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    return out;
}

/* The finished frame. `brdfs` false: planned as if no material had one. */
static float *drawn(struct fk_run *run, struct fk_scene *s,
                    enum hl_pipeline pipeline, bool brdfs)
{
    fk_prepare(run, s, pipeline);
    assert_true(run->plan.brdfs);
    if (!brdfs) {
        s->needs.brdfs = false;
        assert_int_equal(hl_plan_make(&run->plan, pipeline, &s->needs,
                                      hl_device_caps(s->m->device), NULL),
                         HL_OK);
        assert_false(run->plan.brdfs);
    }
    run->desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(run), HL_OK);
    assert_int_equal(hl_frame_draw(run->r, &s->frame, &run->stats), HL_OK);
    assert_int_equal(hl_submit(s->m->device, true), HL_OK);
    return texels_of(run, HL_ROLE_NONE);
}

/* Which item a texel of the G-buffer is of, 0 for none: by region ids. */
static uint32_t item_at(const struct fk_run *run, const float *dsf, size_t i)
{
    const struct fk_scene *s = run->scene;
    float pair[2];
    hlc_two16(pair, run->plan.two16, dsf + 4 * i);
    uint32_t id = (uint32_t)(pair[1] * run->plan.id_steps + 0.5f), k = 0;
    while (id && k < s->frame.n_items && s->item[k].id_base <= id)
        k++;
    return k;
}

static void one_profile_decodes(const char *backend, const char *profile)
{
    struct ck_machine m;
    static struct fk_scene s;
    struct fk_run run;
    uint32_t seen[2] = { 0, 0 };
    ck_open_as(&m, backend, profile);
    make_scene(&s, &m);
    free(drawn(&run, &s, HL_PIPELINE_INFERRED, true));
    assert_int_equal(run.plan.specular, HL_SPECULAR_CHANNEL);
    float *dsf = texels_of(&run, HL_ROLE_DSF);
    float *codes = texels_of(&run, HL_ROLE_EXPONENT);
    for (size_t i = 0; i < N; i++) {
        uint32_t k = item_at(&run, dsf, i);
        float pair[2];
        hlc_two16(pair, run.plan.two16, codes + 4 * i);
        if (!k)
            continue;
        const struct hl_material *a = &s.material[k - 1];
        double n = (double)hl_roughness_exponent(a->roughness);
        assert_true(hl_brdf_decode(pair[1]) == (float)a->brdf);
        /* Half a step, and the logarithm in floats. */
        ck_near((double)pair[0], log2(n) / 8, 0.5 / 65534 + 2e-7);
        seen[a->brdf]++;
    }
    assert_true(seen[0] > 1000 && seen[1] > 1000);
    free(dsf);
    free(codes);
    fk_destroy(&run);
    fk_end(&s);
    ck_close(&m);
}

static void pairs_decode(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    for (int i = 0; i < 4; i++)
        one_profile_decodes(backend, profiles[i]);
}

/* ---- inferred against forward ------------------------------------------- */

/* What a picture changes by over 1/512 pixel on either axis: vertices snap to
 * 1/256, and what is interpolated moves with them. By the largest step to a
 * neighbour. */
static double snapped(const float *picture, int k)
{
    int x = k % FK_W, y = k / FK_W;
    double d = 0, f = (double)picture[k * 4];
    for (int i = 0; i < 4; i++) {
        int u = x + (i == 0) - (i == 1), v = y + (i == 2) - (i == 3);
        if (u < 0 || v < 0 || u >= FK_W || v >= FK_H)
            continue;
        double e = fabs((double)picture[(v * FK_W + u) * 4] - f);
        d = e > d ? e : d;
    }
    return 2 * d / 512;
}

/* A share of what reaches a point, at most MOST here: two lights of 0.3, and
 * a third or one of 8 that is 3 m off or more:
 *   normals      0.0069 degrees, 1.2e-4 of N.L, times 2.25: the steepest that
 *                hl_diffuse_skin can be (1 + 1.25, less what it loses);
 *   lobes        their slope sqrt(n / e) = 2.7 times that, and of 16-bit
 *                exponents 30 x 4.3e-5 / e, both with ks of up to 0.14;
 *   depth        24 bits over 100 m from 0.1 on are 6e-5 m at 10 m: of
 *                distances of 3 m and more 2e-5, doubled by attenuation and
 *                by 2.25 N.L;
 *   light        the plan's error of the L-buffer; of the eye: the colour
 *                target's.
 * Sums in another order, 1e-5 of it. */
#define MOST 1.5

static double limit_of(const struct hl_plan *p)
{
    double colour = (double)hl_plan_target(p, HL_ROLE_COLOR)->error;
    if (hl_plan_target(p, HL_ROLE_COLOR)->format == HL_FORMAT_RGB10A2_FLOAT)
        colour = 1.0 / 128;
    return MOST * (2.25 * 1.2e-4 + 0.14 * (2.7 * 1.2e-4 + 4.8e-4) + 9e-5 +
                   (double)p->light_error + colour + 1e-5) + 1e-6;
}

static void compare(const struct fk_run *run, const float *inferred,
                    const float *forward)
{
    double limit = limit_of(&run->plan), worst = 0;
    uint32_t off = 0;
    for (int i = 0; i < N; i++) {
        double e = fabs((double)inferred[i * 4] - (double)forward[i * 4]) -
                   snapped(forward, i);
        off += e <= limit ? 0 : 1;
        worst = e > worst ? e : worst;
    }
    print_message("%s: worst %.2g of %.2g\n", run->plan.profile, worst,
                  limit);
    assert_int_equal(off, 0);
}

static void two_brdfs_are_forwards(void **state)
{
    struct ck_machine *native = ck_machine(state);
    static struct fk_scene s;
    struct fk_run run;
    make_scene(&s, native);
    float *forward = drawn(&run, &s, HL_PIPELINE_FORWARD, true);
    fk_destroy(&run);
    fk_end(&s);
    for (int i = 0; i < 4; i++) {
        struct ck_machine m;
        ck_open_as(&m, native->backend->name, profiles[i]);
        make_scene(&s, &m);
        float *inferred = drawn(&run, &s, HL_PIPELINE_INFERRED, true);
        compare(&run, inferred, forward);
        free(inferred);
        fk_destroy(&run);
        fk_end(&s);
        ck_close(&m);
    }
    free(forward);
}

/* Every way to find lights and each kind of highlight. */
static void paths_and_falloffs_know_both(void **state)
{
    static struct fk_scene s;
    struct fk_run run;
    make_scene(&s, ck_machine(state));
    make_inverse(&s);
    for (int specular = 0; specular < 3; specular++) {
        for (uint32_t i = 0; i < s.frame.n_items; i++) {
            s.material[i].no_specular = specular == 0;
            s.material[i].roughness = specular == 2 && i % 2 ? 0.7f : 0.55f;
        }
        float *forward = drawn(&run, &s, HL_PIPELINE_FORWARD, true);
        fk_destroy(&run);
        for (int path = HL_LIGHT_PATH_RECTS; path <= HL_LIGHT_PATH_LISTS;
             path++) {
            s.needs.light_path = (enum hl_light_path)path;
            float *inferred = drawn(&run, &s, HL_PIPELINE_INFERRED, true);
            assert_int_equal(run.plan.specular, specular);
            compare(&run, inferred, forward);
            free(inferred);
            fk_destroy(&run);
        }
        free(forward);
    }
    fk_end(&s);
}

/* Without the need: no channel beyond the exponent's, every pixel of other
 * materials as it was, bit for bit, and skin darker somewhere, never
 * brighter. */
static void only_skin_changes(void **state)
{
    static const enum hl_pipeline both[] = {
        HL_PIPELINE_FORWARD, HL_PIPELINE_FORWARD_MULTIPASS,
        HL_PIPELINE_INFERRED };
    static struct fk_scene s;
    struct fk_run run;
    make_scene(&s, ck_machine(state));
    for (int i = 0; i < 3; i++) {
        float *with = drawn(&run, &s, both[i], true);
        fk_destroy(&run);
        float *without = drawn(&run, &s, both[i], false);
        fk_destroy(&run);
        free(drawn(&run, &s, HL_PIPELINE_INFERRED, true));
        float *dsf = texels_of(&run, HL_ROLE_DSF);
        uint32_t changed = 0;
        for (int k = 0; k < N; k++) {
            uint32_t item = item_at(&run, dsf, (size_t)k);
            bool skin = item && s.material[item - 1].brdf == HL_BRDF_SKIN;
            float d = with[k * 4] - without[k * 4];
            if (!skin)
                assert_true(d == 0);
            assert_true(d >= -1e-6f);
            changed += d > 0.01f;
        }
        print_message("%u pixels of skin are brighter\n", changed);
        assert_true(changed > 100);
        free(dsf);
        fk_destroy(&run);
        free(with);
        free(without);
    }
    fk_end(&s);
}

/* ---- against numbers ---------------------------------------------------- */

/* A white wall across the view under one directional light: all of it is the
 * weight of one cosine, on both sides of the terminator. The normal (0, 0, 1)
 * is stored 7.6e-6 off in x and y, 2.2e-5 of N.L, times 2.25; the rest is
 * floats. */
static void a_wall_has_the_weight(void **state)
{
    static const float cosines[] = { 1, 0.7f, 0.3f, 0.05f, 0, -0.05f, -0.15f,
                                     -0.25f };
    static struct fk_scene s;
    struct fk_run run;
    fk_begin(&s, ck_machine(state));
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 30);
    struct hl_light *l = fk_light(&s, 0, 0, 0, 0);
    fk_material(&s, it)->brdf = HL_BRDF_SKIN;
    l->kind = HL_DIRECTIONAL;
    s.needs.light_width = FK_W;
    s.needs.light_height = FK_H;
    s.needs.max_error = 1e-4f;
    for (int i = 0; i < 16; i++) {
        float x = cosines[i / 2];
        l->direction[0] = sqrtf(1 - x * x);
        l->direction[2] = -x;
        float *f = drawn(&run, &s, i & 1 ? HL_PIPELINE_INFERRED
                                         : HL_PIPELINE_FORWARD, true);
        double sub = smooth(-0.2, (double)x) - smooth(0, (double)x);
        double want = (x > 0 ? (double)x : 0) + (sub > 0 ? sub : 0);
        for (int k = 0; k < N; k += 7)
            ck_near((double)f[k * 4], want, 5.5e-5);
        free(f);
        fk_destroy(&run);
    }
    fk_end(&s);
}

/* ---- refusals ----------------------------------------------------------- */

static void bad_brdfs_are_named(void **state)
{
    struct ck_machine *m = ck_machine(state);
    static struct fk_scene s;
    struct fk_run run;
    make_scene(&s, m);
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    s.material[2].brdf = HL_BRDF_COUNT;
    CK_REFUSED(m, hl_frame_draw(run.r, &s.frame, NULL), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "items 2: material.brdf");
    fk_destroy(&run);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(skin_is_the_chapters),
        DRAWN(pairs_decode),
        DRAWN(two_brdfs_are_forwards),
        DRAWN(paths_and_falloffs_know_both),
        DRAWN(only_skin_changes),
        DRAWN(a_wall_has_the_weight),
        CK_ON("null", bad_brdfs_are_named),
    };
    return cmocka_run_group_tests_name("two BRDFs", tests, NULL, NULL);
}
