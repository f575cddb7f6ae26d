/* SPDX-License-Identifier: Zlib */
/* packemu's elementary functions against the C library in double. */
#include <math.h>
#include <string.h>
#include "platforms/packemu/pe_math.h"
#include "tests/check.h"

/* |got - want| in units of want's last place as a float. */
static double ulps(float got, double want)
{
    int e;
    frexp(want, &e);
    return fabs((double)got - want) / ldexp(1, e - 24);
}

/* The polynomial is 0.03 ulp off at most; its largest term, the sum and the
 * product are rounded, half an ulp each and one more where the sum is below
 * the power of two that its first term is in. */
static void exp2_within_two_ulp(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 500000; i++) {
        float x = (float)ck_between(&seed, -126, 127.4);
        if (i & 1)
            x *= 1e-3f;
        if (ulps(pe_exp2(x), exp2((double)x)) > 2)
            fail_msg("exp2(%a)", (double)x);
    }
    for (int k = -126; k <= 127; k++)
        assert_true(pe_exp2((float)k) == ldexpf(1, k));
    assert_true(pe_exp2(-127) == 0 && pe_exp2(-1e30f) == 0);
    assert_true(pe_exp2(-INFINITY) == 0 && pe_exp2(NAN) == 0);
    assert_true(pe_exp2(300) > 1e38f && pe_exp2(300) < INFINITY);
}

/* Polynomial 0.4 ulp; both terms and both sums rounded, the last of which may
 * be half of its first term: 2 * (0.4 + 0.5 + 0.25) + 0.5 at most. */
static void log2_within_three_ulp(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 500000; i++) {
        float x = exp2f((float)ck_between(&seed, -125.9, 127.9));
        if (i & 1)
            x = (float)ck_between(&seed, 0.5, 2);
        if (x != 1 && ulps(pe_log2(x), log2((double)x)) > 3)
            fail_msg("log2(%a)", (double)x);
    }
    for (int k = -126; k <= 127; k++)
        assert_true(pe_log2(ldexpf(1, k)) == (float)k);
}

/* n log2 x carries 3.5 ulp, of which each unit of |n log2 x| makes ln 2 of
 * the result; exp2 adds 2. So the error is below 2.5 (2 + |n log2 x|) ulp,
 * and below 2^-23 of 1, since 2^-y (2 + y) is at most 2. */
static void pow_of_unit_interval(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    for (int i = 0; i < 500000; i++) {
        float x = mk_unit(&seed);
        float n = exp2f((float)ck_between(&seed, -1, 8));
        if (i & 1)
            x = 1 - x * 0.01f;
        double want = pow((double)x, (double)n);
        float got = pe_pow(x, n);
        if (fabs((double)got - want) > ldexp(1, -23))
            fail_msg("pow(%a, %a) = %a", (double)x, (double)n, (double)got);
        double y = x > 0 ? -(double)n * log2((double)x) : 1e9;
        if (y < 126 && ulps(got, want) > 2.5 * (2 + y))
            fail_msg("pow(%a, %a) = %a", (double)x, (double)n, (double)got);
    }
    assert_true(pe_pow(0, 0.5f) == 0 && pe_pow(0, 256) == 0);
    assert_true(pe_pow(1, 0.5f) == 1 && pe_pow(1, 256) == 1);
    assert_true(pe_pow(1e-40f, 0.5f) == 0);
    ck_near(pe_pow(1.0000005f, 128), 1, 1e-4);
}

static void floor_of_every_kind(void **state)
{
    (void)state;
    const float special[] = { 0.0f, -0.0f, 0.5f, -0.5f, 1e30f, -1e30f,
                              8388607.5f, -8388607.5f, 8388608.0f, 1e-40f,
                              -1e-40f, INFINITY, -INFINITY };
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        assert_true(pe_floor(special[i]) == floorf(special[i]));
    assert_true(isnan(pe_floor(NAN)));
    uint64_t seed = mk_seed();
    for (int i = 0; i < 500000; i++) {
        float x = pe_float(mk_random(&seed));
        if (!isnan(x) && pe_floor(x) != floorf(x))
            fail_msg("floor(%a)", (double)x);
    }
}

/* What a frame's bits hang on: sums of results, made by the one known-good
 * build, that no compiler, vector width or machine may change. */
static void same_bits_everywhere(void **state)
{
    (void)state;
    enum { N = 4096 };
    static float x[N], y[3][N];
    for (int i = 0; i < N; i++)
        x[i] = (float)(i + 1) * (1.0f / N);
    for (int i = 0; i < N; i++) {
        y[0][i] = pe_exp2(x[i] * 40.0f - 20.0f);
        y[1][i] = pe_log2(x[i]);
        y[2][i] = pe_pow(x[i], x[i] * 128.0f);
    }
    const uint64_t want[3] = { UINT64_C(0xd748f4f349731349),
                               UINT64_C(0x704fdfe6809b9a77),
                               UINT64_C(0x1318617cd22d1408) };
    for (int k = 0; k < 3; k++) {
        uint32_t bits[N];
        memcpy(bits, y[k], sizeof bits);
        uint64_t hash = mk_hash(0xCBF29CE484222325u, bits, N);
        if (hash != want[k])
            fail_msg("function %d: 0x%016llx", k, (unsigned long long)hash);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exp2_within_two_ulp),
        cmocka_unit_test(log2_within_three_ulp),
        cmocka_unit_test(pow_of_unit_interval),
        cmocka_unit_test(floor_of_every_kind),
        cmocka_unit_test(same_bits_everywhere),
    };
    return cmocka_run_group_tests_name("packemu math", tests, NULL, NULL);
}
