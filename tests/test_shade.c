/* SPDX-License-Identifier: Zlib */
/* The light and surface model's functions against their formulas, written
 * out here a second time in double precision (design section 4). */
#include <math.h>
#include "core/light.h"
#include "shaders/shared/shade.h"
#include "tests/check.h"

static double clamp01(double x) { return x < 0 ? 0 : x > 1 ? 1 : x; }

/* max(0, 1 - (d/r)^2)^2: the argument is rounded by up to 3 * 2^-24 of 1,
 * which the square doubles. */
static void smooth_falloff(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 200000; i++) {
        double r = exp(ck_between(&seed, -3, 5));
        double d = r * ck_between(&seed, 0, 1.5);
        float inv = (float)(1 / (r * r));
        double got = (double)hl_falloff_smooth((float)(d * d), inv);
        double t = 1 - d * d / (r * r);
        ck_near(got, t > 0 ? t * t : 0, 4e-7);
        if (d >= r * 1.000001)
            assert_true(got == 0);
    }
    assert_true(hl_falloff_smooth(0, 1) == 1);
}

/* clamp(1 - (d/r)^4, 0, 1) / max(d, 0.01)^2: the window is rounded by
 * 6 * 2^-24 of 1, so that much of 1 / d^2; the quotient by 2^-23. */
static void inverse_square_falloff(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 200000; i++) {
        double r = exp(ck_between(&seed, -3, 5));
        double d = r * exp(ck_between(&seed, -9, 0.3));
        double floor_d = d > 0.01 ? d : 0.01;
        double want = clamp01(1 - pow(d / r, 4)) / (floor_d * floor_d);
        double got = (double)hl_falloff_inverse_square(
            (float)(d * d), (float)(1 / (r * r)));
        ck_near(got, want, 6e-7 / (floor_d * floor_d));
    }
    /* Nearer than a centimetre it does not grow. */
    assert_true(hl_falloff_inverse_square(0, 1) ==
                hl_falloff_inverse_square(1e-5f, 1e-3f));
    assert_true(hl_falloff_inverse_square(1, 1) == 0);
    assert_true(hl_falloff_inverse_square(4, 1) == 0);
}

/* The cone as hl_light_write hands it to the stages. */
static void cone(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    const float view[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    for (int i = 0; i < 100000; i++) {
        struct hl_light l = { .kind = HL_SPOT, .radius = 1,
                              .direction = { 0, 0, -1 },
                              .color = { 1, 1, 1 } };
        struct hl_lit_sphere s = { .radius = 1 };
        hl_vec4 v[HL_LIGHT_VEC4S];
        l.outer = (float)ck_between(&seed, 0, 3.1415);
        l.inner = l.outer * (float)ck_between(&seed, 0, 1);
        assert_int_equal(hl_light_write(v, &l, &s, view, 1), HL_LIGHT_VEC4S);
        double ci = cos((double)l.inner), co = cos((double)l.outer);
        double width = ci - co > 0.001 ? ci - co : 0.001;
        double c = ck_between(&seed, -1, 1);
        double want = clamp01((c - co) / width);
        double got = (double)hl_spot((float)c, v[2].w, v[3].x);
        /* c and both cosines round by 2^-24 each, c s and o again, all of
         * magnitude 1 / width; the square doubles it. Where the width is
         * near 0.001, ci - co cancels: 1.2e-7 / width more of want. */
        ck_near(got, want * want, 1e-6 / width);
    }
}

/* pow in float: within 2^-22 of exact relative to exponent * log. */
static void specular_lobe(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 200000; i++) {
        double c = ck_between(&seed, 0, 1), n = ck_between(&seed, 1, 256);
        float fc = (float)c, fn = (float)n;
        double want = pow((double)fc, (double)fn);
        ck_near((double)hl_specular(fc, fn), want, 1e-6 * want + 1e-37);
    }
    assert_true(hl_specular(-1, 8) == 0);
    assert_true(hl_specular(0, 1) == 0);
    assert_true(hl_specular(1, 256) == 1);
}

/* Positive terms: each rounding is a share of the sum. */
static void luminance_and_its_inverse(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 100000; i++) {
        double r = ck_between(&seed, 0, 8), g = ck_between(&seed, 0, 8);
        double b = ck_between(&seed, 0, 8), s = ck_between(&seed, 0, 4);
        hl_vec3 c = hl_v3((float)r, (float)g, (float)b);
        double want = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        ck_near((double)hl_luminance(c), want, 4e-7 * want);
        if (want > 0)
            ck_near((double)hl_specular_scale(c, (float)s), s / want,
                    1e-6 * s / want);
    }
    assert_true(hl_luminance(hl_v3(1, 1, 1)) == 1.0f);
    assert_true(hl_specular_scale(hl_v3(0, 0, 0), 5) == 0);
    /* The light buffer's alpha and the material pass meet: ks alpha D / lum D
     * of one light is that light's own specular, whatever its colour. */
    hl_vec3 d = hl_v3(0.3f, 0.0f, 0.1f);
    float alpha = hl_luminance(d) * 0.5f;
    ck_near((double)(d.x * hl_specular_scale(d, alpha)), 0.15, 1e-7);
}

/* alpha = max(roughness, 0.089)^2, n = clamp(2 / alpha^2 - 2, 1, 256);
 * the fourth power and the quotient round 4 times, 5e-7 of 2 / alpha^2. */
static void exponent_of_roughness(void **state)
{
    (void)state;
    for (int i = 0; i <= 10000; i++) {
        float r = (float)i / 10000;
        double a = (double)r > 0.089 ? (double)r : 0.089;
        double n = 2 / (a * a * a * a) - 2;
        double want = n < 1 ? 1 : n > 256 ? 256 : n;
        ck_near((double)hl_roughness_exponent(r), want, 5e-7 * (want + 2));
    }
    assert_true(hl_roughness_exponent(0) == 256);
    assert_true(hl_roughness_exponent(1) == 1);
    assert_true(hl_roughness_exponent(2) == 1);
}

/* rho = base (1 - metallic); ks = mix(0.04, base, metallic) (n + 8) / 8. */
static void material(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 100000; i++) {
        double base[3], m = ck_between(&seed, 0, 1);
        double n = ck_between(&seed, 1, 256);
        for (int k = 0; k < 3; k++)
            base[k] = ck_between(&seed, 0, 1);
        hl_vec3 b = hl_v3((float)base[0], (float)base[1], (float)base[2]);
        hl_vec3 rho = hl_material_albedo(b, (float)m);
        hl_vec3 ks = hl_material_specular(b, (float)m, (float)n);
        const float r[3] = { rho.x, rho.y, rho.z };
        const float s[3] = { ks.x, ks.y, ks.z };
        for (int k = 0; k < 3; k++) {
            ck_near((double)r[k], base[k] * (1 - m), 2e-7);
            double want = (0.04 * (1 - m) + base[k] * m) * (n + 8) / 8;
            ck_near((double)s[k], want, 5e-7 * (want + 1));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_falloff),
        cmocka_unit_test(inverse_square_falloff),
        cmocka_unit_test(cone),
        cmocka_unit_test(specular_lobe),
        cmocka_unit_test(luminance_and_its_inverse),
        cmocka_unit_test(exponent_of_roughness),
        cmocka_unit_test(material),
    };
    return cmocka_run_group_tests_name("shading", tests, NULL, NULL);
}
