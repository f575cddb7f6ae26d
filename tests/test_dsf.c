/* SPDX-License-Identifier: Zlib */
/* The discontinuity sensitive filter's arithmetic: weights, acceptance, and
 * the depth threshold against planes (Kircher, Lawrance 2009, section 3). */
#include <math.h>
#include "shaders/shared/dsf.h"
#include "shaders/shared/pack.h"
#include "tests/check.h"

#define DEG (180.0 / 3.14159265358979323846)

/* ---- weights ---------------------------------------------------------- */

static hl_vec4 accepted(uint32_t mask)
{
    return hl_v4((float)(mask & 1), (float)(mask >> 1 & 1),
                 (float)(mask >> 2 & 1), (float)(mask >> 3 & 1));
}

static void unpack(float out[4], hl_vec4 v)
{
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
    out[3] = v.w;
}

/* Fractions that break filters: ends, tiny ones, and ones below 1. */
static hl_vec2 fraction(uint64_t *seed)
{
    static const float odd[] = { 0, 1e-30f, 1e-9f, 1e-7f, 1e-4f, 0.5f,
                                 0.999999f, 0.99999994f };
    float f[2];
    for (int i = 0; i < 2; i++)
        f[i] = mk_below(seed, 3) ? mk_unit(seed) : odd[mk_below(seed, 8)];
    return hl_v2(f[0], f[1]);
}

static void bilinear_weights_are_the_product(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 100000; i++) {
        hl_vec2 f = fraction(&seed);
        double x = (double)f.x, y = (double)f.y;
        hl_vec4 b = hl_bilinear(f);
        /* 1 - f and the product round once each. */
        ck_near((double)b.x, (1 - x) * (1 - y), 1.2e-7);
        ck_near((double)b.y, x * (1 - y), 1.2e-7);
        ck_near((double)b.z, (1 - x) * y, 1.2e-7);
        ck_near((double)b.w, x * y, 1.2e-7);
    }
}

static void weights_sum_to_one_over_accepted_taps(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < 400000; i++) {
        uint32_t mask = i & 15;
        float w[4], sum;
        unpack(w, hl_dsf_weights(hl_bilinear(fraction(&seed)),
                                 accepted(mask)));
        sum = w[0] + w[1] + w[2] + w[3];
        /* 4 products and 3 sums, each 2^-24 of 1 at most. */
        ck_near((double)sum, 1, ldexp(1, -22));
        for (int k = 0; k < 4; k++) {
            assert_true(w[k] >= 0 && w[k] <= 1.0000002f);
            if (mask && !(mask >> k & 1))
                assert_true(w[k] == 0);
        }
    }
}

/* Renormalising keeps the ratios: w_k = b_k / sum of accepted b. */
static void weights_are_the_accepted_share(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (uint32_t i = 0; i < 400000; i++) {
        float b[4], w[4];
        double sum = 0;
        hl_vec4 v = hl_bilinear(hl_v2(mk_unit(&seed), mk_unit(&seed)));
        unpack(b, v);
        unpack(w, hl_dsf_weights(v, accepted(i & 15)));
        for (int k = 0; k < 4; k++)
            sum += (i & 15) >> k & 1 ? (double)b[k] : 0;
        if (sum < 2 * (double)HL_DSF_NOTHING)
            continue;
        for (int k = 0; k < 4; k++)
            if (i >> k & 1)
                ck_near((double)w[k], (double)b[k] / sum, 3e-7);
    }
}

static void all_accepted_is_bilinear(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 400000; i++) {
        float b[4], w[4];
        hl_vec4 v = hl_bilinear(fraction(&seed));
        unpack(b, v);
        unpack(w, hl_dsf_weights(v, accepted(15)));
        /* Three sums of rounded products are 1 within an ulp; inverse and
         * product round once more. */
        for (int k = 0; k < 4; k++)
            assert_true(ck_ulps(b[k], w[k]) <= 2);
    }
}

static void none_accepted_is_bilinear_to_the_bit(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 100000; i++) {
        float b[4], w[4];
        hl_vec4 v = hl_bilinear(fraction(&seed));
        unpack(b, v);
        unpack(w, hl_dsf_weights(v, accepted(0)));
        for (int k = 0; k < 4; k++)
            assert_true(b[k] == w[k]);
    }
}

/* At 1:1 the pixel's centre is a texel's: that texel alone counts. */
static void at_a_texel_centre_it_is_that_texel(void **state)
{
    (void)state;
    float w[4];
    for (uint32_t mask = 1; mask < 16; mask += 2) {
        unpack(w, hl_dsf_weights(hl_bilinear(hl_v2(0, 0)), accepted(mask)));
        assert_true(w[0] == 1 && w[1] == 0 && w[2] == 0 && w[3] == 0);
    }
}

/* Where accepted taps sum to nothing, one tap has all: accepted, and no
 * other accepted one has a bilinear weight larger by more than the 2^-23
 * that (1 + b) keeps. */
static void without_weight_the_nearest_accepted_counts(void **state)
{
    (void)state;
    static const float tiny[] = { 0, 1e-30f, 1e-9f, 4e-7f, 9e-7f };
    for (uint32_t i = 0; i < 25 * 4; i++) {
        float x = tiny[i / 5 % 5], y = tiny[i % 5];
        /* The pixel lies next to tap `near`, which is rejected. */
        uint32_t near = i / 25;
        hl_vec4 v = hl_bilinear(hl_v2(near & 1 ? 1 - x : x,
                                      near & 2 ? 1 - y : y));
        for (uint32_t mask = 1; mask < 16; mask++) {
            float b[4], w[4], sum = 0, best = 0;
            unpack(b, v);
            unpack(w, hl_dsf_weights(v, accepted(mask)));
            int ones = 0, chosen = 0;
            for (int k = 0; k < 4; k++) {
                sum += mask >> k & 1 ? b[k] : 0;
                best = mask >> k & 1 && b[k] > best ? b[k] : best;
            }
            if (sum > HL_DSF_NOTHING)
                continue;
            for (int k = 0; k < 4; k++)
                if (w[k] == 1) {
                    ones++;
                    chosen = k;
                }
            assert_int_equal(ones, 1);
            assert_true(mask >> chosen & 1);
            assert_true(b[chosen] >= best - 1.2e-7f);
        }
    }
}

/* ---- acceptance ------------------------------------------------------- */

static void a_tap_needs_depth_and_id(void **state)
{
    (void)state;
    const float h = 0.5f / 65535;
    for (uint32_t id = 1; id < 65535; id++) {
        float want = hl_id_encode((float)id, 1.0f / 65535);
        float same = (float)(id / 65535.0), next = (float)((id + 1) / 65535.0);
        assert_true(hl_dsf_accept(5, same, 5, want, 0.1f, h) == 1);
        assert_true(hl_dsf_accept(5, next, 5, want, 0.1f, h) == 0);
        float last = (float)((id - 1) / 65535.0);
        assert_true(hl_dsf_accept(5, last, 5, want, 0.1f, h) == 0);
    }
    assert_true(hl_dsf_accept(5.1f, 0, 5, 0, 0.11f, h) == 1);
    assert_true(hl_dsf_accept(4.9f, 0, 5, 0, 0.11f, h) == 1);
    assert_true(hl_dsf_accept(5.1f, 0, 5, 0, 0.09f, h) == 0);
    assert_true(hl_dsf_accept(4.9f, 0, 5, 0, 0.09f, h) == 0);
    assert_true(hl_dsf_accept(NAN, 0, 5, 0, 1, h) == 0);
}

/* ---- threshold: tilted planes ----------------------------------------- */

/* One texel's angle at the picture's centre. */
static double texel_angle(double vfov, double lines)
{
    return 2 * tan(vfov / 2 / DEG) / lines;
}

static bool kept(double alpha, double p, double tau)
{
    /* A plane tilted by alpha through depth 10 m, one texel further. */
    double z = 10, next = z / (1 - p * tan(alpha / DEG));
    if (p * tan(alpha / DEG) >= 1)
        return false;
    return hl_dsf_accept((float)next, 0, (float)z, 0, (float)(tau * z),
                         1) == 1;
}

/* Conformance b2, D2: where a constant threshold begins to reject a tilted
 * plane, vfov 60. */
static void a_constant_threshold_rejects_from_the_tables_angle(void **state)
{
    (void)state;
    static const double tau[8] = { 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02,
                                   0.05, 0.1 };
    static const struct { double lines, angle[8]; } row[3] = {
        { 225, { 5.6, 11.0, 21.3, 44.1, 62.6, 75.3, 83.9, 86.8 } },
        { 450, { 11.0, 21.3, 37.9, 62.7, 75.5, 82.5, 86.9, 88.4 } },
        { 720, { 17.3, 31.9, 51.2, 72.1, 80.8, 85.3, 88.1, 89.0 } },
    };
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 8; k++) {
            double low = 0, high = 90;
            while (high - low > 0.01) {
                double mid = (low + high) / 2;
                if (kept(mid, texel_angle(60, row[i].lines), tau[k]))
                    low = mid;
                else
                    high = mid;
            }
            ck_near(low, row[i].angle[k], 0.5);
        }
}

/* A plane in view space: z = z0 / (1 - gx s - gy t) at slopes s, t. */
struct plane { double z0, gx, gy; };

static double depth_at(const struct plane *p, double s, double t)
{
    double d = 1 - p->gx * s - p->gy * t;
    return d > 1e-6 ? p->z0 / d : -1;
}

struct view { double lines, angle, ratio, far; };

/* How many of the four taps of frame pixel (x, y) the filter rejects, with
 * the slope as a stage measures it: to a neighbour of its 2 x 2 quad, on
 * either side. -1: some tap's depth is not in the picture, or the plane is
 * steeper than 88 degrees there. */
static int rejects(const struct view *v, const struct plane *p, double x,
                   double y, int side, float k)
{
    double a = v->angle * v->ratio;      /* of a frame pixel                 */
    double z = depth_at(p, x * a, y * a);
    double dx = depth_at(p, (x + side) * a, y * a) - z;
    double dy = depth_at(p, x * a, (y + side) * a) - z;
    double fx = x * v->ratio, fy = y * v->ratio;
    int n = 0;
    if (z <= 0.1 || z > v->far || dx < -z || dy < -z)
        return -1;
    /* 28.6 = tan 88. */
    if ((fabs(p->gx) + fabs(p->gy)) * z / p->z0 > 28.6)
        return -1;
    float slope = (float)((fabs(dx) + fabs(dy)) / v->ratio);
    float limit = hl_dsf_threshold((float)(v->far / 65535), k, 0.001f,
                                   (float)z, slope, 1);
    for (int i = 0; i < 4; i++) {
        double s = floor(fx - 0.5) + 0.5 + (i & 1);
        double t = floor(fy - 0.5) + 0.5 + (i >> 1);
        double tap = depth_at(p, s * v->angle, t * v->angle);
        if (tap <= 0.1 || tap > v->far)
            return -1;
        double code = floor((double)hl_depth_encode(
            (float)tap, (float)(1 / v->far)) * 65535 + 0.5);
        float stored = (float)(code / 65535) * (float)v->far;
        n += hl_dsf_accept(stored, 0, (float)z, 0, limit, 1) == 0;
    }
    return n;
}

static uint32_t count_rejects(double lines, float k, uint32_t *tried)
{
    struct view v = { lines, texel_angle(60, lines), 0.625, 1000 };
    uint64_t seed = 1;
    uint32_t n = 0;
    *tried = 0;
    for (uint32_t i = 0; i < 200000; i++) {
        double tilt = tan(ck_between(&seed, 0, 88) / DEG);
        double turn = ck_between(&seed, 0, 6.2832);
        struct plane p = { exp(ck_between(&seed, -1, 5)), tilt * cos(turn),
                           tilt * sin(turn) };
        double half = lines / v.ratio / 2;
        double x = floor(ck_between(&seed, -1.7778 * half, 1.7778 * half));
        double y = floor(ck_between(&seed, -half, half));
        int r = rejects(&v, &p, x + 0.5, y + 0.5, i & 1 ? 1 : -1, k);
        *tried += r >= 0;
        n += r > 0;
    }
    return n;
}

/* D3. The planner's k is 1.5; 0.5 is a mutant that must be seen. */
static void a_slope_scaled_threshold_keeps_planes_to_88_degrees(void **state)
{
    (void)state;
    static const double lines[] = { 225, 450, 720 };
    for (int i = 0; i < 3; i++) {
        uint32_t tried;
        assert_int_equal(count_rejects(lines[i], 1.5f, &tried), 0);
        assert_true(tried > 50000);
        assert_true(count_rejects(lines[i], 0.5f, &tried) > tried / 100);
    }
}

/* D4: two parallel planes of one id leak into each other up to a gap of the
 * threshold, give or take a step of the stored depth. */
static void a_gap_leaks_up_to_the_threshold(void **state)
{
    (void)state;
    static const double depths[] = { 1, 3, 10, 40 };
    const double far = 100, q = far / 65535;
    for (int i = 0; i < 4; i++) {
        double z = depths[i];
        float limit = hl_dsf_threshold((float)q, 1.5f, 0.001f, (float)z, 0, 1);
        double gap = 0;
        for (; gap < 1; gap += q / 16) {
            double code = floor((z + gap) / far * 65535 + 0.5);
            float tap = (float)(code / 65535) * (float)far;
            if (hl_dsf_accept(tap, 0, (float)z, 0, limit, 1) == 0)
                break;
        }
        ck_near(gap, (double)limit, q);
        ck_near((double)limit, q + 0.001 * z, 1e-6 * z);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bilinear_weights_are_the_product),
        cmocka_unit_test(weights_sum_to_one_over_accepted_taps),
        cmocka_unit_test(weights_are_the_accepted_share),
        cmocka_unit_test(all_accepted_is_bilinear),
        cmocka_unit_test(none_accepted_is_bilinear_to_the_bit),
        cmocka_unit_test(at_a_texel_centre_it_is_that_texel),
        cmocka_unit_test(without_weight_the_nearest_accepted_counts),
        cmocka_unit_test(a_tap_needs_depth_and_id),
        cmocka_unit_test(a_constant_threshold_rejects_from_the_tables_angle),
        cmocka_unit_test(a_slope_scaled_threshold_keeps_planes_to_88_degrees),
        cmocka_unit_test(a_gap_leaks_up_to_the_threshold),
    };
    return cmocka_run_group_tests_name("filter", tests, NULL, NULL);
}
