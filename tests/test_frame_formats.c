/* SPDX-License-Identifier: Zlib */
/* Formats of the L-buffer and of normals, through whole frames: each keeps
 * the bound that its rounding gives, and no format is another in disguise;
 * what samples words sees what samples numbers. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/pipe.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/pack.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H, LIGHT_W = 100, LIGHT_H = 56, LIGHTS = 3 };

/* `cut`: steps of the first channel that a blend may be off: a half, but
 * llvmpipe cuts channels of ten bits off. */
static const struct light_format { enum hl_format format; double cut; }
light_formats[] = {
    { HL_FORMAT_RGBA8_UNORM, 0.5 }, { HL_FORMAT_RGB10A2_UNORM, 1 },
    { HL_FORMAT_RGBA16_UNORM, 0.5 }, { HL_FORMAT_RGBA16_FLOAT, 0 },
    { HL_FORMAT_RGBA32_FLOAT, 0 },
};

enum { LIGHT_FORMATS = sizeof light_formats / sizeof *light_formats };

static struct fk_scene scene;

/* ---- pictures ----------------------------------------------------------- */

/* RGBA of a target as it is stored, malloc'd. */
static float *numbers(hl_tex tex, size_t *n)
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, scene.m->device, tex), HL_OK);
    *n = (size_t)t.width * t.height;
    float *out = malloc(*n * 4 * sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < *n; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    return out;
}

struct picture { struct hl_plan plan; float *light, *normal, *frame; };

/* `numbers`: of a machine that samples no words. */
static struct picture draw(bool as_numbers)
{
    struct picture p;
    struct fk_run run;
    struct hl_caps caps = *hl_device_caps(scene.m->device);
    size_t n;
    caps.profile.float_taps = as_numbers;
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    assert_int_equal(hl_plan_make(&run.plan, HL_PIPELINE_INFERRED,
                                  &scene.needs, &caps, NULL), HL_OK);
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &scene.frame, NULL), HL_OK);
    p.plan = run.plan;
    p.light = numbers(hl_renderer_target(run.r, HL_ROLE_LIGHT), &n);
    p.normal = numbers(hl_renderer_target(run.r, HL_ROLE_NORMAL), &n);
    p.frame = numbers(hl_renderer_output(run.r), &n);
    assert_int_equal(n, N);
    fk_destroy(&run);
    return p;
}

static void drop(struct picture *p)
{
    free(p->light);
    free(p->normal);
    free(p->frame);
}

/* Three lights over a room; one exponent where it is shiny. */
static void begin(void **state, bool shiny)
{
    uint64_t seed = mk_seed();
    fk_begin(&scene, ck_machine(state));
    fk_room(&scene, LIGHTS, &seed);
    for (int i = 0; i < LIGHTS; i++)
        scene.light[i].radius = 9;
    for (uint32_t i = 0; i < scene.frame.n_items; i++)
        scene.material[i].no_specular = !shiny;
    scene.needs.light_width = LIGHT_W;
    scene.needs.light_height = LIGHT_H;
    scene.needs.light_path = HL_LIGHT_PATH_RECTS;
    scene.needs.batch = 1;
}

static struct picture draw_in(enum hl_format light, bool as_numbers)
{
    scene.needs.light_format = light;
    struct picture p = draw(as_numbers);
    const struct hl_plan_target *t = hl_plan_target(&p.plan, HL_ROLE_LIGHT);
    assert_int_equal(t->format, light);
    assert_true((t->sample_as == HL_FORMAT_NONE) == as_numbers);
    return p;
}

/* ---- light -------------------------------------------------------------- */

/* Of a channel whose true value is x, after `blends` of them: fixed point is
 * off by its cut a blend; floats of 11 bits by 2^-10 of the sum so far,
 * truncating, and by no more than a denormal's step; 32 bits by 2^-24. And
 * two products with the scale, 2^-23. */
static double light_limit(const struct light_format *f,
                          const struct picture *p, int c, double x,
                          int blends)
{
    const struct hl_format_info *info = hl_format_info(f->format);
    double scale = (double)p->plan.light_scale;
    double step = scale / (double)((1ull << info->bits[c]) - 1);
    if (info->kind != HL_KIND_FLOAT)
        return blends * f->cut * step + 3e-7 * scale;
    return blends * (x * ldexp(1, info->bits[c] == 32 ? -23 : -10) + 6e-8);
}

/* In steps of the first channel; floats: 0. */
static double worst_light(const struct light_format *f,
                          const struct picture *p, const float *exact,
                          int blends)
{
    double scale = (double)p->plan.light_scale, worst = 0;
    double step = scale * (double)hl_fixed_step(f->format);
    for (int i = 0; i < LIGHT_W * LIGHT_H * 4; i++) {
        double x = (double)exact[i];
        double e = fabs((double)p->light[i] * scale - x);
        if (e > light_limit(f, p, i % 4, x, blends))
            fail_msg("%s, texel %d, channel %d: %g, not %g",
                     hl_format_info(f->format)->name, i / 4, i % 4,
                     (double)p->light[i] * scale, x);
        worst = i % 4 == 0 && e / step > worst ? e / step : worst;
    }
    return f->cut > 0 ? worst : 0;
}

/* Weights of a filter sum to 1 and surfaces reflect at most all: a pixel is
 * off by no more than the worst texel; and both frames are cut to half
 * floats, 2^-10 each. */
static void check_frame(const struct light_format *f, const struct picture *p,
                        const struct picture *exact, int blends)
{
    for (int i = 0; i < N * 4; i++) {
        double a = (double)p->frame[i], b = (double)exact->frame[i];
        double limit = light_limit(f, p, 0, (double)p->plan.light_scale,
                                   blends);
        if (f->cut <= 0)
            limit = b * ldexp(blends, -10);
        if (i % 4 != 3 && fabs(a - b) > limit + (a + b) * ldexp(1, -10))
            fail_msg("%s, pixel %d: %g, not %g",
                     hl_format_info(f->format)->name, i / 4, a, b);
    }
}

static void check_light(enum hl_light_path path, int blends)
{
    scene.needs.light_path = path;
    struct picture exact = draw_in(HL_FORMAT_RGBA32_FLOAT, false);
    for (int i = 0; i < LIGHT_FORMATS; i++) {
        const struct light_format *f = &light_formats[i];
        struct picture p = draw_in(f->format, false);
        double worst = worst_light(f, &p, exact.light, blends);
        check_frame(f, &p, &exact, blends);
        print_message("%s, %d blends: worst %.2f steps\n",
                      hl_format_info(f->format)->name, blends, worst);
        /* It has steps of that size, or other numbers were read. */
        assert_true(f->cut <= 0 || worst > 0.3);
        drop(&p);
    }
    drop(&exact);
}

/* Without specular: what alpha does to a picture is a ratio of sums. */
static void light_keeps_its_formats_bound(void **state)
{
    begin(state, false);
    check_light(HL_LIGHT_PATH_LISTS, 1);
    check_light(HL_LIGHT_PATH_RECTS, LIGHTS);
    fk_end(&scene);
}

/* All four channels; without blends 2 bits of alpha are within a step. */
static void specular_light_keeps_it_too(void **state)
{
    begin(state, true);
    scene.needs.light_path = HL_LIGHT_PATH_LISTS;
    struct picture exact = draw_in(HL_FORMAT_RGBA32_FLOAT, false);
    for (int i = 0; i < LIGHT_FORMATS; i++) {
        struct picture p = draw_in(light_formats[i].format, false);
        worst_light(&light_formats[i], &p, exact.light, 1);
        drop(&p);
    }
    drop(&exact);
    fk_end(&scene);
}

/* Of the same texels; a code's quotient and the sampler's product with the
 * reciprocal are 2^-23 apart, which ratios and sums make 2^-20 of; and each
 * frame is cut to half floats. */
static void words_and_numbers_are_one_light(void **state)
{
    begin(state, true);
    for (int i = 0; i < LIGHT_FORMATS; i++) {
        struct picture w = draw_in(light_formats[i].format, false);
        struct picture n = draw_in(light_formats[i].format, true);
        double brightest = 0;
        for (int k = 0; k < N * 4; k++) {
            double a = (double)w.frame[k], b = (double)n.frame[k];
            double limit = (a + b) * (ldexp(1, -11) + ldexp(1, -20));
            brightest = b > brightest ? b : brightest;
            if (k % 4 != 3 && fabs(a - b) > limit + 1e-6)
                fail_msg("%s, pixel %d: %g as words, %g as numbers",
                         hl_format_info(light_formats[i].format)->name,
                         k / 4, a, b);
        }
        assert_true(brightest > 0.1);
        drop(&w);
        drop(&n);
    }
    fk_end(&scene);
}

/* ---- normals ------------------------------------------------------------ */

static const enum hl_format normal_formats[] = {
    HL_FORMAT_RG16_UNORM, HL_FORMAT_RG8_UNORM, HL_FORMAT_RG16_FLOAT };

/* Most that a component of -1..1 is off: half a step of 0..1, doubled; of
 * floats below 1 a whole one, 2^-11, since llvmpipe truncates. */
static double half_step(enum hl_format f)
{
    return f == HL_FORMAT_RG8_UNORM ? 1.0 / 255
           : f == HL_FORMAT_RG16_FLOAT ? ldexp(1, -10) : 1.0 / 65535;
}

/* Radians for normals theta from the view axis (conformance b1). */
static double normal_limit(double theta, double h)
{
    double r = sin(theta / 2), d = sqrt(2) * h;
    double up = 2 * (asin(fmin(1, r + d)) - asin(r));
    double down = 2 * (asin(r) - asin(fmax(-1, r - d)));
    return fmax(up, down);
}

static hl_vec3 normal_at(const struct picture *p, int i)
{
    const float *t = p->normal + 4 * i;
    return hl_normal_decode(hl_v2(hl_unorm_to_snorm(t[0]),
                                  hl_unorm_to_snorm(t[1])));
}

/* By the chord, which for small angles does not round as a cosine does. */
static double angle(hl_vec3 a, hl_vec3 b)
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y;
    double z = (double)a.z - (double)b.z;
    return 2 * asin(fmin(1, sqrt(x * x + y * y + z * z) / 2));
}

/* The reference has its own error; 1e-6 of floats. */
static double worst_normal(enum hl_format f, const struct picture *p,
                           const struct picture *fine)
{
    double worst = 0;
    for (int i = 0; i < LIGHT_W * LIGHT_H; i++) {
        hl_vec3 a = normal_at(p, i), b = normal_at(fine, i);
        double theta = acos(fmin(1, fmax(-1, (double)b.z)));
        double limit = normal_limit(theta, half_step(f)) +
                       normal_limit(theta, half_step(HL_FORMAT_RG16_UNORM));
        double e = angle(a, b) / (limit + 1e-6);
        worst = e > worst ? e : worst;
    }
    return worst;
}

/* RG8 and halves near their bounds, so that they are what they say: 5,600
 * normals come to 0.8 of it where formats round, halves that round to half. */
static void normals_keep_their_formats_bound(void **state)
{
    begin(state, false);
    scene.needs.light_format = HL_FORMAT_RGBA32_FLOAT;
    scene.needs.normal_format = HL_FORMAT_RG16_UNORM;
    struct picture fine = draw(false);
    for (int i = 1; i < 3; i++) {
        enum hl_format f = normal_formats[i];
        scene.needs.normal_format = f;
        struct picture p = draw(false);
        const struct hl_plan_target *t = hl_plan_target(&p.plan,
                                                        HL_ROLE_NORMAL);
        assert_int_equal(t->format, f);
        assert_int_equal(hl_plan_target(&p.plan, HL_ROLE_DSF)->format,
                         HL_FORMAT_RG16_UNORM);
        double worst = worst_normal(f, &p, &fine);
        print_message("%s: worst %.2f of its bound\n",
                      hl_format_info(f)->name, worst);
        /* The planner's is the same up to 90 degrees; 1e-3 of its floats. */
        ck_near((double)t->error * (acos(-1) / 180) /
                normal_limit(acos(0), half_step(f)), 1, 0.01);
        assert_true(worst <= 1 && worst > 0.35);
        drop(&p);
    }
    drop(&fine);
    fk_end(&scene);
}

/* ---- decals ------------------------------------------------------------- */

/* A wall and before it a decal of half alpha, turned by `turn` about y. */
static void begin_decal(void **state, float turn)
{
    fk_begin(&scene, ck_machine(state));
    scene.surface[FK_BLENDED].blended = false;
    scene.surface[FK_BLENDED].decal = true;
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
    struct hl_item *it = fk_add(&scene, FK_QUAD, FK_BLENDED, 0, 0, 3, 2);
    it->world[0] = it->world[10] = 2 * cosf(turn);
    it->world[2] = -2 * sinf(turn);
    it->world[8] = 2 * sinf(turn);
    fk_material(&scene, it)->base[3] = 0.5f;
    fk_light(&scene, 0, 0, 6, 20);
    scene.needs.light_width = LIGHT_W;
    scene.needs.light_height = LIGHT_H;
}

/* Steps of 0..1: a half for each of two and a whole one for the blend, which
 * may cut; of floats, which may cut all three, three of 2^-11. */
static void decals_blend_in_every_format(void **state)
{
    const float turn = 0.6f;
    begin_decal(state, turn);
    hl_vec2 e = hl_normal_encode(hl_v3(sinf(turn), 0, cosf(turn)));
    double want = 0.5 * 0.5 + 0.5 * (double)hl_snorm_to_unorm(e.x);
    for (int i = 0; i < 3; i++) {
        enum hl_format f = normal_formats[i];
        scene.needs.normal_format = f;
        struct picture p = draw(false);
        const float *middle = p.normal +
                              4 * (LIGHT_H / 2 * LIGHT_W + LIGHT_W / 2);
        double step = f == HL_FORMAT_RG16_FLOAT ? 1.5 / 2048
                                                : half_step(f);
        assert_int_equal(p.plan.decals, HL_DECALS_BLEND_NORMALS);
        ck_near((double)middle[0], want, 2 * step);
        ck_near((double)middle[1], 0.5, 2 * step);
        ck_near((double)p.normal[0], 0.5, step);
        drop(&p);
    }
    fk_end(&scene);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(light_keeps_its_formats_bound),
        DRAWN(specular_light_keeps_it_too),
        DRAWN(words_and_numbers_are_one_light),
        DRAWN(normals_keep_their_formats_bound),
        DRAWN(decals_blend_in_every_format),
    };
    return cmocka_run_group_tests_name("formats of frames", tests, NULL,
                                       NULL);
}
