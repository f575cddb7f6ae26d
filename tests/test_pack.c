/* SPDX-License-Identifier: Zlib */
/* Packing formulas against double precision: normals, bytes, depth, ids,
 * exponents. test_dsf.c goes on with the filter, test_shade.c with the light
 * model, test_pack_gpu.c runs the same text through a device. */
#include <math.h>
#include <string.h>
#include "shaders/shared/pack.h"
#include "tests/check.h"

#define DEG (180.0 / 3.14159265358979323846)

/* ---- normals: what a format keeps of them ----------------------------- */

typedef float (*store_fn)(float);      /* one component, -1..1, and back     */

static float unorm16(float x)
{
    double code = floor((double)hl_snorm_to_unorm(x) * 65535 + 0.5);
    return hl_unorm_to_snorm((float)(code / 65535));
}

static float snorm16(float x)
{
    return (float)(floor((double)x * 32767 + 0.5) / 32767);
}

/* The porting error of the Xbox 360: a -32..32 format without the scale. */
static float unscaled16(float x)
{
    return (float)(floor((double)x / 32 * 32767 + 0.5) / 32767 * 32);
}

static float half_nearest(float x) { return ck_half(ck_half_nearest(x)); }
static float half_truncate(float x) { return ck_half(ck_half_truncate(x)); }

/* Degrees between two vectors. atan2, not acos: acos loses half the digits
 * where it matters. */
static double angle(const double a[3], const double b[3])
{
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
    double z = a[0] * b[1] - a[1] * b[0];
    return DEG * atan2(sqrt(x * x + y * y + z * z),
                       a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

/* Error in degrees of the normal at polar angle theta, azimuth phi. */
static double stored_error(store_fn store, double theta, double phi)
{
    hl_vec3 n = hl_v3((float)(sin(theta) * cos(phi)),
                      (float)(sin(theta) * sin(phi)), (float)cos(theta));
    hl_vec2 e = hl_normal_encode(n);
    hl_vec3 m = hl_normal_decode(hl_v2(store(e.x), store(e.y)));
    double a[3] = { (double)n.x, (double)n.y, (double)n.z };
    double b[3] = { (double)m.x, (double)m.y, (double)m.z };
    assert_true(b[0] * b[0] + b[1] * b[1] + b[2] * b[2] > 0.99);
    return angle(a, b);
}

/* Conformance b1: r = sin(theta / 2) is stored with a displacement d of at
 * most sqrt 2 times the component's worst error h; float arithmetic adds
 * 4e-7: 3 roundings of len2 and its root, 2^-22 in all, and the bias's. */
static double bound(double h, double theta)
{
    double r = sin(theta / 2), d = sqrt(2) * (h + 4e-7);
    double up = asin(r + d < 1 ? r + d : 1) - asin(r);
    double down = asin(r) - asin(r - d > -1 ? r - d : -1);
    return DEG * 2 * (up > down ? up : down);
}

struct band { double theta, max; };    /* degrees up to, worst of the table  */
struct format {
    const char *name;
    store_fn store;
    double h, mean;
    struct band band[4];
};

static const struct format formats[] = {
    { "UNORM16", unorm16, 1.0 / 65535, 0.00195,
      { { 90, 0.00348 }, { 120, 0.00482 }, { 138.9, 0.00689 },
        { 170, 0.0275 } } },
    { "SNORM16", snorm16, 1.0 / 65534, 0.00195,
      { { 90, 0.00345 }, { 120, 0.00483 }, { 138.9, 0.00681 },
        { 170, 0.0279 } } },
    { "half, nearest", half_nearest, 1.0 / 4096, 0.0248,
      { { 90, 0.0436 }, { 120, 0.0773 }, { 138.9, 0.110 },
        { 170, 0.454 } } },
    { "half, truncated", half_truncate, 1.0 / 2048, 0.0567,
      { { 90, 0.0874 }, { 120, 0.155 }, { 138.9, 0.221 },
        { 170, 0.846 } } },
};

/* Within 0.07 degrees more past 170 degrees, where a unit vector in float is
 * not unit enough: 6e-8 tan(theta / 2) radians (conformance b1 measures
 * 0.063). Returns the worst excess over the bound. */
static double worst_excess(const struct format *f, double low, double high,
                           uint32_t n, uint64_t *seed, double *worst)
{
    double excess = -1;
    for (uint32_t i = 0; i < n; i++) {
        double theta = ck_between(seed, low, high) / DEG;
        double e = stored_error(f->store, theta, ck_between(seed, 0, 6.2832));
        double over = e - bound(f->h, theta) - (high > 170 ? 0.07 : 0);
        *worst = e > *worst ? e : *worst;
        excess = over > excess ? over : excess;
    }
    return excess;
}

static void normals_stay_within_the_bound_of_their_format(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const struct format *f = &formats[i];
        double low = 0, worst = 0;
        for (int b = 0; b < 4; b++) {
            /* The worst lie at the band's end. */
            double end = f->band[b].theta;
            double over = worst_excess(f, low, end, 100000, &seed, &worst);
            assert_true(over <= 0);
            over = worst_excess(f, end - 0.5, end, 200000, &seed, &worst);
            assert_true(over <= 0);
            print_message("%s to %5.1f degrees: %.5f, table %.5f\n", f->name,
                          end, worst, f->band[b].max);
            /* The table's own samples are others: 5 % either way. */
            ck_near(worst / f->band[b].max, 1, 0.05);
            low = end;
        }
        assert_true(worst_excess(f, 170, 179, 100000, &seed, &worst) <= 0);
        /* Nearer than 1e-6 to the pole is the pole: see below. */
        assert_true(worst_excess(f, 179, 179.9999, 100000, &seed, &worst)
                    <= 0);
    }
}

/* A uniform direction: z uniform. */
static void normals_are_right_on_average(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < 100000; k++)
            sum += stored_error(formats[i].store,
                                acos(ck_between(&seed, -1, 1)),
                                ck_between(&seed, 0, 6.2832));
        assert_true(sum / 100000 <= 1.1 * formats[i].mean);
    }
}

static void an_unscaled_format_would_be_noticed(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct format f = formats[1];
    double worst = 0;
    f.store = unscaled16;
    assert_true(worst_excess(&f, 0, 90, 100000, &seed, &worst) > 0.05);
}

/* 3 roundings a component of at most 1, twice in the square: 4e-7. */
static void check_unit(double x, double y)
{
    hl_vec3 n = hl_normal_decode(hl_v2(
        hl_unorm_to_snorm((float)(x / 65535)),
        hl_unorm_to_snorm((float)(y / 65535))));
    double l = sqrt((double)n.x * (double)n.x + (double)n.y * (double)n.y +
                    (double)n.z * (double)n.z);
    if (!(fabs(l - 1) <= 4e-7))
        fail_msg("code %g, %g decodes to length %.9g", x, y, l);
}

static void every_code_decodes_to_a_unit_normal(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    static const double edge[] = { 0, 1, 2, 32766, 32767, 32768, 65533, 65534,
                                   65535 };
    for (size_t i = 0; i < sizeof edge / sizeof *edge; i++)
        for (uint32_t k = 0; k < 65536; k++) {
            check_unit(edge[i], k);
            check_unit(k, edge[i]);
        }
    for (uint32_t i = 0; i < 1u << 22; i++) {
        uint32_t code = mk_random(&seed);
        check_unit(code >> 16, code & 0xffff);
    }
}

static void check_singular(float x, float y, float z)
{
    hl_vec2 e = hl_normal_encode(hl_v3(x, y, z));
    if (!(e.x == 0 && e.y == 0))
        fail_msg("(%g, %g, %g) encodes to (%g, %g)", (double)x, (double)y,
                 (double)z, (double)e.x, (double)e.y);
}

static void what_is_no_direction_faces_the_viewer(void **state)
{
    (void)state;
    const float bad[] = { NAN, INFINITY, -INFINITY, 3e38f, -3e38f };
    check_singular(0, 0, -1);
    check_singular(0, 0, 0);
    for (int i = 0; i < 5; i++)
        for (int mask = 1; mask < 8; mask++)
            check_singular(mask & 1 ? bad[i] : 0.5f, mask & 2 ? bad[i] : 0.5f,
                           mask & 4 ? bad[i] : 0.5f);
    hl_vec3 n = hl_normal_decode(hl_v2(0, 0));
    assert_true(n.x == 0 && n.y == 0 && n.z == 1);
}

/* Everything near the pole encodes to something that decodes. */
static void the_pole_gives_no_nan(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < 1000000; i++) {
        float x = (float)ck_between(&seed, -1e-3, 1e-3);
        float y = (float)ck_between(&seed, -1e-3, 1e-3);
        float scale = i & 1 ? 1.0f : 1e-3f;
        hl_vec2 e = hl_normal_encode(hl_v3(x * scale, y * scale, -1));
        assert_true(e.x * e.x + e.y * e.y <= 1.000001f);
    }
}

/* ---- bytes, ids, depth ------------------------------------------------ */

static void two_bytes_carry_all_codes(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 65536; i++) {
        hl_vec2 b = hl_split16((float)i);
        assert_true(b.x == (float)(i >> 8) && b.y == (float)(i & 255));
        assert_true(hl_join16(b) == (float)i);
    }
}

/* As the hardware stores it: round to nearest. */
static uint32_t code_of(float x, double steps)
{
    return (uint32_t)floor((double)x * steps + 0.5);
}

static void ids_are_exact_in_16_bits(void **state)
{
    (void)state;
    const float inv = 1.0f / 65535.0f;
    for (uint32_t id = 0; id < 65536; id++)
        assert_int_equal(code_of(hl_id_encode((float)id, inv), 65535), id);
    for (uint32_t id = 0; id < 256; id++)
        assert_int_equal(code_of(hl_id_encode((float)id, 1.0f / 255), 255),
                         id);
}

/* q = far / 65535; the step's half, and 2 roundings of the quotient. */
static void depth_is_within_half_a_step(void **state)
{
    (void)state;
    static const struct { double far, worst; } row[] = {
        { 100, 0.00076 }, { 500, 0.0038 }, { 1000, 0.0076 }, { 5000, 0.038 }
    };
    uint64_t seed = mk_seed();
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        double far = row[i].far, worst = 0;
        float inv = 1.0f / (float)far;
        for (uint32_t k = 0; k < 200000; k++) {
            float z = (float)ck_between(&seed, 0, far);
            double back = code_of(hl_depth_encode(z, inv), 65535) * far /
                          65535;
            double e = fabs(back - (double)z);
            worst = e > worst ? e : worst;
        }
        assert_true(worst <= far / 65535 / 2 + far * 1.2e-7);
        ck_near(worst / row[i].worst, 1, 0.02);
    }
    assert_true(hl_depth_encode(-1, 0.01f) == 0);
    assert_true(hl_depth_encode(1000, 0.01f) == 1);
}

/* ---- exponent, tangent.w ---------------------------------------------- */

/* Half a step of log2(n) / 8; float adds 1e-6: log2 and exp2 are within
 * 2 ulp of values up to 8, that is 8 * 2^-22 ln 2. */
static void exponents_keep_their_ratio(void **state)
{
    (void)state;
    static const double steps[] = { 65535, 255 };
    uint64_t seed = mk_seed();
    for (int s = 0; s < 2; s++) {
        double bound = exp2(4 / steps[s]) - 1 + 2e-6, worst = 0;
        for (uint32_t i = 0; i < 200000; i++) {
            float n = (float)exp2(ck_between(&seed, 0, 8));
            float e = hl_exponent_encode(n);
            double code = floor((double)e * steps[s] + 0.5);
            double back = (double)hl_exponent_decode((float)(code / steps[s]));
            double r = fabs(back / (double)n - 1);
            worst = r > worst ? r : worst;
        }
        assert_true(worst <= bound);
        assert_true(worst >= 0.9 * bound);
    }
    assert_true(hl_exponent_encode(1) == 0);
    assert_true(hl_exponent_decode(0) == 1);
    assert_true(hl_exponent_encode(256) == 1);
    assert_true(hl_exponent_decode(1) == 256);
}

static void check_tangent_w(float hand, uint32_t group)
{
    float w = hl_mesh_pack_tangent_w(hand, group);
    assert_true(hl_tangent_w_group(w) == (float)group);
    assert_true(hl_tangent_w_sign(w) == hand);
}

static void tangent_w_is_what_the_mesh_packed(void **state)
{
    (void)state;
    for (uint32_t g = 0; g < 70000; g++) {
        check_tangent_w(1, g);
        check_tangent_w(-1, g);
    }
    check_tangent_w(1, (1u << 24) - 1);
    check_tangent_w(-1, (1u << 24) - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_stay_within_the_bound_of_their_format),
        cmocka_unit_test(normals_are_right_on_average),
        cmocka_unit_test(an_unscaled_format_would_be_noticed),
        cmocka_unit_test(every_code_decodes_to_a_unit_normal),
        cmocka_unit_test(what_is_no_direction_faces_the_viewer),
        cmocka_unit_test(the_pole_gives_no_nan),
        cmocka_unit_test(two_bytes_carry_all_codes),
        cmocka_unit_test(ids_are_exact_in_16_bits),
        cmocka_unit_test(depth_is_within_half_a_step),
        cmocka_unit_test(exponents_keep_their_ratio),
        cmocka_unit_test(tangent_w_is_what_the_mesh_packed),
    };
    return cmocka_run_group_tests_name("packing", tests, NULL, NULL);
}
