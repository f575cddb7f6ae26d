/* SPDX-License-Identifier: Zlib */
/* What AUTO takes, by what frames really cost: never more than a quarter
 * above the cheapest pipeline, with no light, few, and many. Counted on
 * packemu (platforms/chart/count.h), for its own costs and for lavapipe's. */
#include <string.h>
#include "platforms/cli/commands.h"
#include "tests/check.h"
#include "tests/cost_kit.h"

enum { W = 320, H = 180 };

/* Of what a pipeline that was not taken would have cost; the allowance is
 * the demand itself, no measured figure. */
static const double MOST = 1.25;

static const uint32_t some[] = { 0, 1, 2, 4, 8, 16, 32, 64, 1u << 20 };

static void check_one(struct ct_scene *s, const struct hl_caps *caps,
                      uint32_t lights, double *worst)
{
    struct ct_cost taken, one;
    ct_lights(s, lights);
    assert_true(ct_count(&taken, s, HL_PIPELINE_AUTO, caps));
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        assert_true(ct_count(&one, s, (enum hl_pipeline)p, caps));
        double ratio = taken.ns / one.ns;
        *worst = ratio > *worst ? ratio : *worst;
        if (ratio > MOST)
            fail_msg("%s, %u lights on %s: auto takes %d, %.2f times %d",
                     s->stage.scene.name, lights, caps->backend,
                     (int)taken.plan.pipeline, ratio, p);
    }
}

static void auto_is_near_the_cheapest(void **state)
{
    static const char *const scenes[] = { "fig8", "many", "thin", "fig9" };
    struct hl_caps caps[2];
    double worst = 0;
    (void)state;
    ck_lavapipe(&caps[0]);
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        struct ct_scene s;
        assert_true(ct_open(&s, scenes[k], "packemu", W, H));
        caps[1] = *hl_device_caps(s.stage.machine.device);
        for (int m = 0; m < 2; m++)
            for (size_t i = 0; i < sizeof some / sizeof *some; i++)
                if (i == 0 || some[i - 1] < s.all_lights)
                    check_one(&s, &caps[m], some[i], &worst);
        ct_close(&s);
    }
    print_message("auto at most %.3f of the cheapest\n", worst);
}

/* K 7.1: the base cost. Without a light inferred costs what forward does:
 * both draw every object once and read nothing of light. */
static void no_light_costs_nothing(void **state)
{
    struct ct_scene s;
    struct ct_cost forward, inferred;
    (void)state;
    assert_true(ct_open(&s, "fig8", "packemu", W, H));
    ct_lights(&s, 0);
    const struct hl_caps *caps = hl_device_caps(s.stage.machine.device);
    assert_true(ct_count(&forward, &s, HL_PIPELINE_FORWARD_MULTIPASS, caps));
    assert_true(ct_count(&inferred, &s, HL_PIPELINE_INFERRED, caps));
    assert_int_equal(inferred.of.draws, forward.of.draws);
    assert_int_equal(inferred.of.triangles, forward.of.triangles);
    assert_int_equal(inferred.of.material, forward.of.forward);
    assert_int_equal(inferred.of.geometry, 0);
    assert_int_equal(inferred.of.light, 0);
    assert_true(inferred.ns == forward.ns);
    ct_close(&s);
}

/* A frame's counts do not depend on the run. */
static void counting_repeats(void **state)
{
    struct ct_scene s;
    struct ct_cost a, b;
    (void)state;
    assert_true(ct_open(&s, "many", "packemu", W, H));
    const struct hl_caps *caps = hl_device_caps(s.stage.machine.device);
    assert_true(ct_count(&a, &s, HL_PIPELINE_INFERRED, caps));
    assert_true(ct_count(&b, &s, HL_PIPELINE_INFERRED, caps));
    assert_true(a.ns == b.ns && a.of.lights == b.of.lights);
    assert_int_equal(a.of.geometry, b.of.geometry);
    assert_int_equal(a.of.material, b.of.material);
    assert_true(a.of.geometry > 0 && a.of.light > 0 && a.of.material > 0);
    ct_close(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(auto_is_near_the_cheapest),
        cmocka_unit_test(no_light_costs_nothing),
        cmocka_unit_test(counting_repeats),
    };
    return cmocka_run_group_tests_name("costs", tests, NULL, NULL);
}
