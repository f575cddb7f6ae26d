/* SPDX-License-Identifier: Zlib */
/* What once went wrong and must not again: capacities that run out in the
 * middle of a split pass, a peak that no fixed range can hold, a stage that a
 * plan cannot serve. */
#include <string.h>
#include "tests/frame_kit.h"
#include "tests/stage_kernels.h"

/* Uniform data runs out while a pass of more draws than the scratch holds is
 * being sent: refused, and nothing is written past the scratch (seen by
 * AddressSanitizer: draws beyond 4,096 once were). */
static void data_runs_out_in_a_split_pass(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    struct ck_machine *m = ck_machine(state);
    fk_begin(&s, m);
    fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 8);
    fk_light(&s, 0, 0, 2, 50);
    s.needs.light_width = 1024;
    s.needs.light_height = 512;
    s.needs.light_path = HL_LIGHT_PATH_TILES;
    s.needs.tile = 8;            /* 128 x 64 tiles, a draw each: 8,192       */
    s.needs.no_tile_depth = true;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    run.desc.frame_bytes = 200000;   /* room for about 3,000 of 64 bytes     */
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_ERR_LIMIT);
    assert_int_equal(hl_submit(m->device, true), HL_OK);
    fk_destroy(&run);
    fk_end(&s);
}

/* An inverse-square light peaks at a centimetre: 16-bit steps of that peak
 * would leave what is in sight black. Smooth lights of a known peak may use
 * them, and do where many blends make half floats worse. */
static void no_fixed_range_for_inverse_square(void **state)
{
    struct fk_scene s;
    struct hl_plan plan;
    enum hl_refusal why;
    struct ck_machine *m = ck_machine(state);
    fk_begin(&s, m);
    s.needs.width = 640;
    s.needs.height = 360;
    s.needs.n_lights = 400;
    s.needs.lights_per_pixel = 6;
    s.needs.light_path = HL_LIGHT_PATH_RECTS;
    s.needs.batch = 1;
    s.needs.peak = 5e7f;
    for (uint32_t kinds = 1; kinds <= 7; kinds++) {
        s.needs.lights = kinds;
        assert_int_equal(hl_plan_make(&plan, HL_PIPELINE_INFERRED, &s.needs,
                                      hl_device_caps(m->device), &why), HL_OK);
        bool fixed = hl_plan_target(&plan, HL_ROLE_LIGHT)->format ==
                     HL_FORMAT_RGBA16_UNORM;
        if (kinds & HL_LIGHTS_INVERSE_SQUARE)
            assert_false(fixed);
    }
    s.needs.lights = HL_LIGHTS_SMOOTH;
    s.needs.peak = 4;
    assert_int_equal(hl_plan_make(&plan, HL_PIPELINE_INFERRED, &s.needs,
                                  hl_device_caps(m->device), &why), HL_OK);
    assert_int_equal(hl_plan_target(&plan, HL_ROLE_LIGHT)->format,
                     HL_FORMAT_RGBA16_UNORM);
    fk_end(&s);
}

/* An embedder's stage reads inferred light, which a forward plan has not. */
static void own_materials_need_inferred_light(void **state)
{
    static const uint32_t words[4];
    const struct hl_code code = { .spirv = words,
                                  .spirv_bytes = sizeof words,
                                  .kernel = own_taps_kernel() };
    const enum hl_pipeline pipelines[] = { HL_PIPELINE_FORWARD,
                                           HL_PIPELINE_FORWARD_MULTIPASS,
                                           HL_PIPELINE_INFERRED };
    struct ck_machine *m = ck_machine(state);
    for (int i = 0; i < 3; i++) {
        struct fk_scene s;
        struct fk_run run;
        fk_begin(&s, m);
        s.surface[FK_PLAIN].own_material = &code;
        fk_prepare(&run, &s, pipelines[i]);
        assert_int_equal(fk_create(&run), i < 2 ? HL_ERR_UNSUPPORTED : HL_OK);
        fk_destroy(&run);
        fk_end(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        CK_ON("null", data_runs_out_in_a_split_pass),
        CK_ON("vulkan", data_runs_out_in_a_split_pass),
        CK_ON("packemu", data_runs_out_in_a_split_pass),
        CK_ON("gl", data_runs_out_in_a_split_pass),
        CK_ON("null", own_materials_need_inferred_light),
        CK_ON("packemu", own_materials_need_inferred_light),
        CK_ON("null", no_fixed_range_for_inverse_square),
        CK_ON("packemu", no_fixed_range_for_inverse_square),
    };
    return cmocka_run_group_tests_name("overflow", tests, NULL, NULL);
}
