/* SPDX-License-Identifier: Zlib */
/* Stencil shadow volumes in frames, on every backend and by every profile's
 * rules, against rays from each texel's point to the light. */
#include "hal/backend.h"
#include "tests/cast_kit.h"
#include "tests/console_kit.h"

static const char *const profiles[] = { "native", "dx10", "ps3", "xbox360" };

/* ---- cases -------------------------------------------------------------- */

static void box_over_floor(struct cs_rig *g)
{
    cs_box(g, 0, -1, 0, 0.4);
    cs_light(g, 0.5f, 1.5f, 0.5f);
}

/* The eye is under the box, looking out over the floor that it darkens. */
static void eye_in_shadow(struct cs_rig *g)
{
    const float eye[3] = { 0.3f, -2, 1 }, at[3] = { 0, -2.6f, -3 };
    const float wide[3] = { 4, 0.2f, 4 }, over[3] = { 0, -1, 0 };
    cs_put(g, FK_BOX, FK_PLAIN, wide, 0.2, over);
    cs_light(g, 0, 4, 1);
    cs_look(g, eye, at, 0.1f, 100);
}

/* The near plane, 0.5 m away and 1 m wide, goes through a side, and the box
 * that casts it is behind the eye. */
static void near_plane_in_side(struct cs_rig *g)
{
    const float eye[3] = { 0, 0, 6 }, at[3] = { 0, -1, -8 };
    const float slab[3] = { 2, 2, 0.3f }, behind[3] = { 2, 0, 8 };
    cs_put(g, FK_BOX, FK_PLAIN, slab, 0, behind);
    cs_light(g, 0, 1.5f, 14);
    cs_look(g, eye, at, 0.5f, 100);
}

/* From z = 2 to 18 m beyond far, which is 12 m from the eye. */
static void caster_beyond_far(struct cs_rig *g)
{
    const float eye[3] = { 0, 0, 4 }, at[3] = { 0, -1, -4 };
    const float beam[3] = { 0.4f, 0.4f, 16 }, mid[3] = { -1, -1, -14 };
    cs_put(g, FK_BOX, FK_PLAIN, beam, 0, mid);
    cs_light(g, 3, 4, 0);
    cs_look(g, eye, at, 0.1f, 12);
}

/* One beneath another: their shadows add up, and would cancel if one of them
 * were inside out. */
static void mirrored(struct cs_rig *g)
{
    const float scale[3] = { -1, 0.6f, 0.8f }, at[3] = { 1, -1.5f, 0 };
    cs_put(g, FK_BOX, FK_MIRRORED, scale, 0.5, at);
    cs_box(g, 0, 0.5f, 0.5f, 0);
    cs_light(g, -1, 3, 1);
}

/* The light without shadows leaves no trace for the one with them. */
static void beside_a_plain_light(struct cs_rig *g)
{
    cs_box(g, 0, -1, 0, 0.4);
    cs_light(g, 0.5f, 1.5f, 0.5f);
    struct hl_light *l = fk_light(&g->s, 3, -2, 1, 4);
    l->color[0] = 0.4f;
}

/* Sheets: one that faces the light, one that does not and casts none, one of
 * two sides that is lit from behind. */
static void open_meshes(struct cs_rig *g)
{
    const float scale[3] = { 0.8f, 1, 1 }, a[3] = { -3, -1, 0 };
    const float b[3] = { 0, -1, 0 }, c[3] = { 3, -1, 0 };
    cs_put(g, FK_QUAD, FK_PLAIN, scale, 0.2, a);
    cs_put(g, FK_QUAD, FK_PLAIN, scale, 3.0, b);
    cs_put(g, FK_QUAD, FK_TWO_SIDED, scale, 3.0, c);
    cs_light(g, 0, 1, 5);
}

/* Large ones in many directions, lit and seen from their backs. */
static void turned_sheets(struct cs_rig *g)
{
    const float scale[3] = { 1.1f, 1.3f, 1 };
    for (int i = 0; i < 5; i++) {
        const float at[3] = { 2.3f * (float)(i - 2), 0.2f * (float)i - 1,
                              -0.7f * (float)i };
        struct hl_item *it = cs_put(g, FK_QUAD, FK_TWO_SIDED, scale,
                                 2.5 + 0.31 * i, at);
        /* Sheared, so that depth slopes both ways. */
        it->world[6] = 0.3f * (float)(i - 1);
    }
    cs_light(g, 0.3f, 1, 6);
}

static void two_lights(struct cs_rig *g)
{
    cs_box(g, 0, -1, 0, 0.4);
    cs_box(g, 1.5f, 0, -3, 0.9);
    cs_light(g, 3, 4, 2)->color[0] = 0.3f;
    cs_light(g, -3, 4, 3)->color[2] = 0.3f;
}

static void sun_and_spot(struct cs_rig *g)
{
    const float post[3] = { 0.5f, 1.5f, 0.5f }, at[3] = { -2, -1.5f, 0 };
    cs_put(g, FK_BOX, FK_PLAIN, post, 0.4, at);
    cs_box(g, 1, -1, -1, 0.9);
    struct hl_light *l = cs_light(g, 0, 0, 0);
    l->kind = HL_DIRECTIONAL;
    l->direction[0] = 0.64f, l->direction[1] = -0.6f, l->direction[2] = -0.48f;
    l = cs_light(g, 1, 3, 0);
    l->kind = HL_SPOT;
    l->direction[1] = -1;
    l->inner = 0.3f, l->outer = 0.9f;
}

/* The box that casts is all behind the eye, and so is the light. */
static void caster_behind(struct cs_rig *g)
{
    const float eye[3] = { 0, 0, 4 }, at[3] = { 0, -1, -8 };
    cs_box(g, 0, 0, 7, 0.3);
    cs_light(g, 0.2f, 0.5f, 10);
    cs_look(g, eye, at, 0.1f, 100);
}

/* Three that overlap, behind one another. */
static void put_panes(struct cs_rig *g)
{
    const float scale[3] = { 4, 2.4f, 1 };
    for (int i = 0; i < 3; i++) {
        const float at[3] = { 0.3f * (float)i, -0.8f, 0.5f - 1.2f * (float)i };
        struct hl_item *it = cs_put(g, FK_QUAD, FK_BLENDED, scale, 0, at);
        fk_material(&g->s, it)->base[3] = 0.5f;
    }
}

/* To plan for. */
static void all_and_panes(struct cs_rig *g)
{
    sun_and_spot(g);
    put_panes(g);
}

static const struct {
    const char *name;
    void (*fill)(struct cs_rig *);
    uint32_t dark, lit;              /* texels, at least                     */
} cases[] = {
    { "box over floor", box_over_floor, 50, 1000 },
    { "eye in shadow", eye_in_shadow, 500, 300 },
    { "near plane in side", near_plane_in_side, 300, 300 },
    { "caster behind", caster_behind, 300, 300 },
    { "caster beyond far", caster_beyond_far, 40, 300 },
    { "mirrored", mirrored, 40, 1000 },
    { "open meshes", open_meshes, 70, 1000 },
    { "beside a plain light", beside_a_plain_light, 50, 1000 },
    { "turned sheets", turned_sheets, 50, 1000 },
    { "two lights", two_lights, 50, 1000 },
    { "sun and spot", sun_and_spot, 25, 1000 },
};

static void light_ends_at_what_hides_it(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct cs_rig g;
    for (int i = 0; i < 4; i++) {
        cs_open(&g, backend, profiles[i], i % 2 == 1, sun_and_spot, 0);
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            cs_clear(&g);
            cases[k].fill(&g);
            struct cs_seen n = cs_check(&g, cases[k].name);
            if (i == 0)
                print_message("%s: %u dark, %u lit, %u not tried\n",
                              cases[k].name, n.dark, n.lit, n.unsure);
            assert_true(n.dark >= cases[k].dark);
            assert_true(n.lit >= cases[k].lit);
        }
        cs_close(&g);
    }
}

/* ---- translucent surfaces ----------------------------------------------- */

/* Each layer is dark where a post before all of them hides the light from
 * it, which is elsewhere on each; and casts nothing on those behind. */
static void stippled_layers_are_dark_each(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct cs_rig g;
    const float post[3] = { 0.5f, 1.5f, 0.2f }, at[3] = { -1.2f, -1, 1.5f };
    for (int i = 0; i < 4; i++) {
        cs_open(&g, backend, profiles[i], false, all_and_panes, 0);
        assert_int_equal(g.run.plan.stipple, 2);
        cs_clear(&g);
        cs_put(&g, FK_BOX, FK_PLAIN, post, 0.1, at);
        put_panes(&g);
        cs_light(&g, -3, 0.5f, 4);
        struct cs_seen n = cs_check(&g, "panes");
        assert_int_equal(g.run.stats.stippled, 3);
        for (int k = 3; k < 6; k++) {
            if (i == 0)
                print_message("pane %d: %u dark, %u other\n", k, n.of[k][0],
                              n.of[k][1]);
            assert_true(n.of[k][0] >= 20 && n.of[k][1] >= 60);
        }
        cs_close(&g);
    }
}

/* ---- room --------------------------------------------------------------- */

/* A box's volume has 6 lit triangles or fewer: 18 indices a cap and 36 of its
 * outline. With room for one of them the frame waits, and is the same. */
static void too_little_room_only_waits(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct cs_rig g;
    struct hlc_texels at_once, waited;
    cs_open(&g, backend, "native", false, sun_and_spot, 0);
    cs_clear(&g);
    two_lights(&g);
    cs_draw(&g, &at_once);
    assert_int_equal(g.run.stats.shadow_casters, 4);
    uint32_t triangles = g.run.stats.shadow_triangles;
    cs_close(&g);
    cs_open(&g, backend, "native", false, sun_and_spot, 72);
    cs_clear(&g);
    two_lights(&g);
    cs_draw(&g, &waited);
    assert_int_equal(g.run.stats.shadow_casters, 4);
    assert_int_equal(g.run.stats.shadow_triangles, triangles);
    size_t bytes = CS_TEXELS * hl_format_info(waited.format)->bytes;
    assert_memory_equal(at_once.bytes, waited.bytes, bytes);
    hlc_texels_free(&at_once);
    hlc_texels_free(&waited);
    cs_close(&g);
    cs_open(&g, backend, "native", false, sun_and_spot, 20);
    cs_clear(&g);
    two_lights(&g);
    CK_REFUSED(&g.m, hl_frame_draw(g.run.r, &g.s.frame, NULL), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "shadow_indices");
    cs_close(&g);
}

/* ---- plans -------------------------------------------------------------- */

static void only_inferred_plans_have_shadows(void **state)
{
    (void)state;
    struct hl_caps caps;
    struct hl_plan p;
    struct hl_needs n = { .width = 1280, .height = 720, .n_lights = 1,
                          .n_objects = 1, .shadows = HL_SHADOWS_VOLUMES,
                          .n_shadow_lights = 1 };
    enum hl_refusal why;
    ck_lavapipe(&caps);
    for (int i = 1; i < HL_PIPELINE_INFERRED; i++) {
        assert_int_equal(hl_plan_make(&p, (enum hl_pipeline)i, &n, &caps,
                                      &why), HL_ERR_UNSUPPORTED);
        assert_int_equal(why, HL_REFUSED_SHADOWS);
    }
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &caps, NULL),
                     HL_OK);
    assert_int_equal(p.pipeline, HL_PIPELINE_INFERRED);
    assert_int_equal(p.shadows, HL_SHADOWS_VOLUMES);
    assert_true(p.infinite_far);
    float cost = p.cost_ms;
    n.n_shadow_lights = 2;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &caps, NULL),
                     HL_OK);
    assert_true(p.cost_ms > cost);
    n.shadows = HL_SHADOWS_NONE;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &caps, NULL),
                     HL_OK);
    assert_true(p.cost_ms < cost && !p.infinite_far);
    for (uint32_t i = 0; i < p.n_passes; i++)
        assert_true(p.pass[i].role != HL_PASS_SHADOWED);
}

/* The L-buffer may lie over other G-buffers but never over the depth that the
 * stencil is in (K 5.1), in all passes up to the last light's. Depth is read
 * from its resolved copy there; on other machines from one of the planner's. */
static void edram_keeps_the_stencil(void **state)
{
    (void)state;
    struct hl_caps c;
    struct hl_needs n = con_needs();
    n.width = 1280;
    n.height = 720;
    n.light_width = 800;
    n.light_height = 450;
    n.n_lights = 20;
    n.shadows = HL_SHADOWS_VOLUMES;
    n.n_shadow_lights = 4;
    con_caps(&c, &hl_profile_xbox360, true);
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    const struct hl_plan_target *d = hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH);
    const struct hl_plan_target *l = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_int_equal(d->format, HL_FORMAT_D24_FLOAT_S8);
    assert_true(d->console.edram_tile && l->console.edram_tile);
    assert_true(d->console.edram_tile + d->edram_tiles <=
                l->console.edram_tile ||
                l->console.edram_tile + l->edram_tiles <=
                d->console.edram_tile);
    assert_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
    const struct hl_plan_pass *s = &p.pass[p.n_passes - 2];
    assert_int_equal(s->role, HL_PASS_SHADOWED);
    assert_true(s->color[0] == HL_ROLE_LIGHT &&
                s->depth == HL_ROLE_LIGHT_DEPTH && !s->depth_read_only);
    con_caps(&c, &hl_profile_xbox360, false);
    p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    d = hl_plan_target(&p, HL_ROLE_LIGHT_DEPTH);
    assert_int_equal(d->format, HL_FORMAT_D32_FLOAT_S8);
    assert_non_null(hl_plan_target(&p, HL_ROLE_DEPTH_COPY));
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(light_ends_at_what_hides_it),
        DRAWN(stippled_layers_are_dark_each),
        DRAWN(too_little_room_only_waits),
        cmocka_unit_test(only_inferred_plans_have_shadows),
        cmocka_unit_test(edram_keeps_the_stencil),
    };
    return cmocka_run_group_tests_name("shadows of frames", tests, NULL, NULL);
}
