/* SPDX-License-Identifier: Zlib */
/* The reference renderer's textures, mip levels, normal maps and tangents
 * against values worked out by hand. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/reference_kit.h"

/* As in test_reference.c; texture coordinates pass through no more. */
#define EXACT 1e-12

static double linear(double code)
{
    double s = code / 255;
    return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

/* A quad of half 5 that shows `codes`, one a texel, grey, alpha the code too,
 * as emission; u and v run to (su, sv). */
static void picture(struct kit *k, uint32_t w, uint32_t h,
                    const uint8_t *codes, float su, float sv)
{
    uint8_t rgba[4 * 256];
    assert_true(w * h <= 256);
    for (uint32_t i = 0; i < 4 * w * h; i++)
        rgba[i] = codes[i / 4];
    kit_make(k);
    struct hlh_material *m = kit_material(k);
    m->emission[0] = m->emission[1] = m->emission[2] = 1;
    m->emission_texture.image = kit_image(k, w, h, rgba);
    struct hlh_mesh *q = kit_quad(k, 5, 0);
    for (int i = 0; i < 4; i++) {
        q->vertices[i].uv[0] *= su;
        q->vertices[i].uv[1] *= sv;
    }
}

static double texel(const struct kit *k, double u, double v)
{
    struct hlr_probe p = kit_probe(k, 10 * u - 5, 5 - 10 * v);
    check_near(p.color[0], p.color[2], 0, "grey");
    return p.color[0];
}

/* ---- filtering ---- */

static void magnified_texels_mix_bilinearly_in_linear_light(void **state)
{
    (void)state;
    static const uint8_t codes[4] = { 0, 255, 188, 64 };
    struct kit k;
    picture(&k, 2, 2, codes, 1, 1);
    double c = linear(188), d = linear(64);
    check_near(texel(&k, 0.25, 0.25), 0, EXACT, "texel 0");
    check_near(texel(&k, 0.75, 0.25), 1, EXACT, "texel 1");
    check_near(texel(&k, 0.25, 0.75), c, EXACT, "texel 2, below");
    check_near(texel(&k, 0.5, 0.25), 0.5, EXACT, "between 0 and 1");
    check_near(texel(&k, 0.375, 0.25), 0.25, EXACT, "nearer to 0");
    check_near(texel(&k, 0.5, 0.5), (1 + c + d) / 4, EXACT, "all four");
    check_near(texel(&k, 0.375, 0.625),
               0.25 * (0.25 * 1) + 0.75 * (0.75 * c + 0.25 * d), EXACT,
               "weights 3 to 1");
    kit_free(&k);
}

static void wrap_modes_repeat_clamp_and_mirror(void **state)
{
    (void)state;
    static const uint8_t codes[4] = { 10, 80, 160, 240 };
    static const int want[3][12] = {
        { 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3 },
        { 0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3 },
        { 3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0 },
    };
    struct kit k;
    for (int tall = 0; tall < 2; tall++)
        for (int mode = 0; mode < 3; mode++) {
            picture(&k, tall ? 1 : 4, tall ? 4 : 1, codes, 3, 3);
            struct hlh_texture *t = &k.materials[0].emission_texture;
            *(tall ? &t->wrap_v : &t->wrap_u) = (enum hlh_wrap)mode;
            for (int i = 0; i < 4; i++)
                k.meshes[0].vertices[i].uv[tall ? 1 : 0] -= 1;
            for (int i = 0; i < 12; i++) {
                double at = (i + 0.5) / 12, other = 0.5 / 3;
                double got = tall ? texel(&k, other, at) : texel(&k, at, other);
                check_near(got, linear(codes[want[mode][i]]), EXACT, "wrap");
            }
            /* halfway between texels -1 and 0 */
            double a = linear(codes[want[mode][3]]);
            double b = linear(codes[want[mode][4]]);
            double got = tall ? texel(&k, 0.5 / 3, 4.0 / 12)
                              : texel(&k, 4.0 / 12, 0.5 / 3);
            check_near(got, (a + b) / 2, EXACT, "seam");
            kit_free(&k);
        }
}

/* `scale` repeats of a 4 x 4 checkerboard over 64 pixels. */
static void checkerboard(struct kit *k, float su, float sv)
{
    uint8_t codes[16];
    for (uint32_t i = 0; i < 16; i++)
        codes[i] = (i + i / 4) % 2 ? 255 : 0;
    picture(k, 4, 4, codes, su, sv);
}

static void mip_levels_follow_the_longer_footprint(void **state)
{
    (void)state;
    /* the mean of black and white, 0.5, is code 187.5 in sRGB: 188 */
    double half = linear(188);
    struct kit k;
    for (int i = 0; i < 4; i++) {
        /* 4 s texels over 64 pixels: 1.414 and 1.25 texels a pixel */
        float s = i < 2 ? 22.6274169979695f : 20;
        double lambda = log2((double)s / 16);
        checkerboard(&k, i % 2 ? 4 : s, i % 2 ? s : 4);
        k.materials[0].base_texture = k.materials[0].emission_texture;
        /* the centres of texel (5, 8) = (1, 0), white, and (4, 8), black */
        double du = i % 2 ? 4 : (double)s, dv = i % 2 ? (double)s : 4;
        check_near(texel(&k, 1.375 / du, 2.125 / dv),
                   (1 - lambda) + lambda * half, EXACT, "white");
        check_near(texel(&k, 1.125 / du, 2.125 / dv), lambda * half, EXACT,
                   "black");
        check_near(kit_probe(&k, 1, 1).lambda, lambda, EXACT, "lambda");
        kit_free(&k);
    }
    checkerboard(&k, 16, 16);    /* one texel a pixel: level 0 alone */
    check_near(texel(&k, 1.125 / 16, 1.125 / 16), 0, EXACT, "lambda 0");
    kit_free(&k);
    checkerboard(&k, 640, 640);  /* beyond the last level */
    check_near(texel(&k, 0.3, 0.4), half, EXACT, "last level");
    kit_free(&k);
}

static void mip_levels_of_odd_sizes_weigh_by_area(void **state)
{
    (void)state;
    static const uint8_t codes[5] = { 0, 50, 200, 150, 20 };
    struct kit k;
    /* 64 pixels, 5 s texels of alpha; v does not stretch one texel's height */
    for (int level = 1; level <= 2; level++) {
        float s = 12.8f * (float)(1 << level);
        picture(&k, 5, 1, codes, s, 1);
        struct hlh_material *m = &k.materials[0];
        m->alpha = HLH_ALPHA_BLEND;
        m->base_texture = m->emission_texture;
        m->emission_texture.image = -1;
        /* level 1 is 2 x 1: (0 + 50 + 100) / 2.5 and (100 + 150 + 20) / 2.5;
         * 12.8f is 1.5e-8 off, and lambda mixes levels up to 50 codes apart */
        for (int t = 0; t < 3 - level; t++) {
            double u = (3 + (t + 0.5) / (3 - level)) / (double)s;
            double want = level == 2 ? 84 : t ? 108 : 60;
            check_near(kit_probe(&k, 10 * u - 5, 1).alpha, want / 255, 1e-7,
                       "alpha");
        }
        kit_free(&k);
    }
}

static void mip_levels_are_stored_in_8_bits(void **state)
{
    (void)state;
    /* one texel of a and three of b: the codes of the mean, in sRGB 158.45,
     * 222.55 and 10.75, in unorm 140, 206.25 and 10.75 */
    static const struct { uint8_t a, b; int srgb, unorm; } row[] = {
        { 20, 180, 158, 140 }, { 75, 250, 223, 206 }, { 10, 11, 11, 11 },
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        uint8_t codes[4] = { row[i].a, row[i].b, row[i].b, row[i].b };
        struct kit k;
        picture(&k, 2, 2, codes, 640, 640);
        check_near(texel(&k, 0.3, 0.3), linear(row[i].srgb), EXACT, "sRGB");
        struct hlh_material *m = &k.materials[0];
        m->alpha = HLH_ALPHA_BLEND;
        m->base_texture = m->emission_texture;
        check_near(kit_probe(&k, 1, 1).alpha, row[i].unorm / 255.0, EXACT,
                   "unorm");
        kit_free(&k);
    }
}

static void compare_with_differences(float su, float sv)
{
    static const uint8_t codes[2] = { 0, 255 };
    struct kit k;
    picture(&k, 2, 1, codes, su, sv);
    k.materials[0].base_texture = k.materials[0].emission_texture;
    for (int i = 0; i < 4; i++) {
        float *p = k.meshes[0].vertices[i].position;
        p[2] = 0.5f * p[0] - 0.25f * p[1];
    }
    for (int i = 0; i < 20; i++) {
        double x = i % 5 - 2, y = i / 5 - 1.5, e = 1e-3, pixel = 10.0 / 64;
        struct hlr_probe p = kit_probe(&k, x, y);
        check_near(p.uv[0], (double)su * (p.position[0] + 5) / 10, EXACT, "u");
        check_near(p.uv[1], (double)sv * (5 - p.position[1]) / 10, EXACT, "v");
        double longest = 0;
        for (int axis = 0; axis < 2; axis++) {
            double dx = axis ? 0 : e * pixel, dy = axis ? e * pixel : 0;
            struct hlr_probe a = kit_probe(&k, x - dx, y - dy);
            struct hlr_probe b = kit_probe(&k, x + dx, y + dy);
            longest = fmax(longest, hypot((b.uv[0] - a.uv[0]) / (2 * e) * 2,
                                          (b.uv[1] - a.uv[1]) / (2 * e)));
        }
        /* central differences: error e^2 times the third derivative, which
         * is some (pixel / distance)^2 < 1e-2 of the first; rounding
         * 1e-15 / e */
        check_near(p.lambda, log2(longest), 1e-7, "lambda");
    }
    kit_free(&k);
}

static void perspective_uv_and_lambda_match_differences(void **state)
{
    (void)state;
    compare_with_differences(7, 5);
    compare_with_differences(2, 11);
}

static void each_texture_has_its_encoding_and_channels(void **state)
{
    (void)state;
    static const uint8_t rgba[4] = { 100, 150, 51, 204 };
    struct kit k;
    kit_make(&k);
    struct hlh_material *m = kit_material(&k);
    struct hlh_texture t = { kit_image(&k, 1, 1, rgba), 0, 0 };
    m->base_texture = m->metal_rough_texture = m->emission_texture = t;
    m->alpha = HLH_ALPHA_BLEND;
    m->base_color[0] = 0.5f, m->base_color[1] = m->base_color[2] = 1;
    m->base_color[3] = 0.5f;
    m->metallic = 0.5f;
    m->emission[0] = 2, m->emission[1] = 1;
    kit_quad(&k, 5, 0);
    for (int i = 0; i < 4; i++) {
        float color[4] = { 1, 0.5f, 1, 0.25f };
        memcpy(k.meshes[0].vertices[i].color, color, sizeof color);
    }
    struct hlr_probe p = kit_probe(&k, 1, 1);
    double metal = 0.5 * 51 / 255, rough = 150 / 255.0;
    double alpha = rough * rough;
    check_near(p.exponent, 2 / (alpha * alpha) - 2, EXACT * 100, "n");
    check_near3(p.rho, 0.5 * linear(100) * (1 - metal),
                0.5 * linear(150) * (1 - metal), linear(51) * (1 - metal),
                EXACT, "rho");
    check_near3(p.emission, 2 * linear(100), linear(150), 0, EXACT, "e");
    check_near(p.alpha, 0.5 * 0.25 * 204 / 255, EXACT, "alpha");
    kit_free(&k);
}

/* ---- normal maps ---- */

/* A quad whose whole normal map is (x, y, z) in codes. */
static struct hlh_mesh *bumped(struct kit *k)
{
    static const uint8_t rgba[4] = { 190, 150, 220, 255 };
    kit_make(k);
    struct hlh_material *m = kit_material(k);
    m->double_sided = true;
    m->normal_texture.image = kit_image(k, 1, 1, rgba);
    return kit_quad(k, 5, 0);
}

/* Expect the map along `tx` times x and `by` times y, all turned over with
 * `side` -1. */
static void expect_bump(const struct kit *k, double tx, double by, double scale,
                        double side, const char *what)
{
    double x = (2 * 190 / 255.0 - 1) * scale * tx;
    double y = (2 * 150 / 255.0 - 1) * scale * by, z = 2 * 220 / 255.0 - 1;
    double n = side / sqrt(x * x + y * y + z * z);
    check_near3(kit_probe(k, 1, 2).normal, x * n, y * n, z * n, EXACT, what);
}

static void normal_maps_tilt_along_u_and_green_up(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_mesh *m = bumped(&k);
    expect_bump(&k, 1, 1, 1, 1, "made tangents");
    k.materials[0].normal_scale = 0.5f;
    expect_bump(&k, 1, 1, 0.5, 1, "scaled");
    k.options.normal_maps = false;
    expect_bump(&k, 0, 0, 1, 1, "switched off");
    k.options.normal_maps = true;
    k.materials[0].normal_scale = 1;
    k.objects[0].world[0] = -1;
    expect_bump(&k, -1, 1, 1, 1, "mirrored node");
    k.objects[0].world[0] = 2;
    expect_bump(&k, 1, 1, 1, 1, "stretched node");
    k.objects[0].world[0] = 1;
    for (int i = 0; i < 4; i++)
        m->vertices[i].uv[0] = 1 - m->vertices[i].uv[0];
    expect_bump(&k, -1, 1, 1, 1, "mirrored u");
    for (int i = 0; i < 4; i++)
        m->vertices[i].uv[1] = 1 - m->vertices[i].uv[1];
    expect_bump(&k, -1, -1, 1, 1, "turned by half");
    for (int i = 0; i < 4; i++)
        m->vertices[i].uv[0] = 0.5f;
    expect_bump(&k, 0, 0, 1, 1, "no direction in uv");
    kit_free(&k);
}

static void tangents_lie_in_the_vertex_normal_s_plane(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_mesh *m = bumped(&k);
    for (int i = 0; i < 4; i++) {
        m->vertices[i].normal[0] = 3;
        m->vertices[i].normal[2] = 4;
    }
    /* N = (0.6, 0, 0.8), so T = (0.8, 0, -0.6) and B = (0, 1, 0) */
    double x = 2 * 190 / 255.0 - 1, y = 2 * 150 / 255.0 - 1;
    double z = 2 * 220 / 255.0 - 1, n = sqrt(x * x + y * y + z * z);
    check_near3(kit_probe(&k, 1, 2).normal, (0.8 * x + 0.6 * z) / n, y / n,
                (0.8 * z - 0.6 * x) / n, EXACT, "bump");
    kit_free(&k);
}

static void the_file_s_tangents_come_first(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_mesh *m = bumped(&k);
    m->has_tangent = true;
    expect_bump(&k, 0, 0, 1, 1, "zero tangents");
    for (int i = 0; i < 4; i++) {
        m->vertices[i].tangent[0] = -1;
        m->vertices[i].tangent[3] = 1;
    }
    expect_bump(&k, -1, -1, 1, 1, "w = 1");
    for (int i = 0; i < 4; i++)
        m->vertices[i].tangent[3] = -1;
    expect_bump(&k, -1, 1, 1, 1, "w = -1");
    kit_free(&k);
}

static void a_back_face_turns_its_mapped_normal_over(void **state)
{
    (void)state;
    struct kit k;
    bumped(&k);
    k.scene.camera.eye[2] = -5;
    struct hlr_probe p = kit_probe(&k, -1, 2);
    assert_true(p.back_face);
    /* seen from behind, the same point of the plane has x of the other sign;
     * the map is constant, so only the side matters */
    expect_bump(&k, 1, 1, 1, -1, "from behind");
    kit_free(&k);
}

/* Triangle `at` with corners at 0 and two points; u and v of those two. */
static void corner(struct hlh_mesh *m, uint32_t at, const float p[4],
                   const float uv[4])
{
    for (uint32_t i = 0; i < 2; i++) {
        struct hlh_vertex *v = &m->vertices[3 * at + 1 + i];
        memcpy(v->position, p + 2 * i, 2 * sizeof(float));
        memcpy(v->uv, uv + 2 * i, 2 * sizeof(float));
    }
    for (uint32_t i = 0; i < 3; i++)
        m->indices[3 * at + i] = 3 * at + i;
}

static void tangents_sum_by_corner_angle_within_a_handedness(void **state)
{
    (void)state;
    static const uint8_t along_t[4] = { 255, 128, 128, 255 };
    struct kit k;
    kit_make(&k);
    kit_material(&k)->normal_texture.image = kit_image(&k, 1, 1, along_t);
    struct hlh_mesh *m = kit_mesh(&k, 9, 9);
    m->has_uv = true;
    /* 90 degrees, u along x; 45 degrees, u along y, three times as steep;
     * and, of the other handedness, u against x */
    corner(m, 0, (float[]){ 2, 0, 0, 2 }, (float[]){ 1, 0, 0, -1 });
    corner(m, 1, (float[]){ 0, 2, -2, 2 }, (float[]){ 3, 0, 3, -3 });
    corner(m, 2, (float[]){ -2, -2, 0, -2 }, (float[]){ 1, 1, 0, 1 });
    double one = 1 / 255.0, n[2], s = sqrt(5);
    /* T = (2, 1) / sqrt 5 at the shared corner, B = (-1, 2) / sqrt 5 */
    n[0] = 2 / s - one / s;
    n[1] = 1 / s + 2 * one / s;
    double length = sqrt(1 + 2 * one * one);
    for (int i = 0; i < 2; i++) {
        double e = 1e-9;         /* beside the corner: its tangent but 1e-9 */
        struct hlr_probe p = kit_probe(&k, i ? -e : e, i ? 3 * e : e);
        check_near(p.triangle, i, 0, "triangle");
        check_near3(p.normal, n[0] / length, n[1] / length, one / length,
                    1e-8, "sum");
    }
    struct hlr_probe p = kit_probe(&k, -1e-9, -2e-9);
    check_near3(p.normal, -1 / length, one / length, one / length, 1e-8,
                "other handedness");
    kit_free(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(magnified_texels_mix_bilinearly_in_linear_light),
        cmocka_unit_test(wrap_modes_repeat_clamp_and_mirror),
        cmocka_unit_test(mip_levels_follow_the_longer_footprint),
        cmocka_unit_test(mip_levels_of_odd_sizes_weigh_by_area),
        cmocka_unit_test(mip_levels_are_stored_in_8_bits),
        cmocka_unit_test(perspective_uv_and_lambda_match_differences),
        cmocka_unit_test(each_texture_has_its_encoding_and_channels),
        cmocka_unit_test(normal_maps_tilt_along_u_and_green_up),
        cmocka_unit_test(tangents_lie_in_the_vertex_normal_s_plane),
        cmocka_unit_test(the_file_s_tangents_come_first),
        cmocka_unit_test(a_back_face_turns_its_mapped_normal_over),
        cmocka_unit_test(tangents_sum_by_corner_angle_within_a_handedness),
    };
    return cmocka_run_group_tests_name("reference textures", tests, NULL,
                                       NULL);
}
