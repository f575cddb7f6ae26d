/* SPDX-License-Identifier: Zlib */
/* What core measures of a frame without a device, against counting by hand. */
#include <math.h>
#include <string.h>
#include "core/light.h"
#include "tests/check.h"

enum { ITEMS = 5, LIGHTS = 6 };

struct small {
    struct hl_item item[ITEMS];
    struct hl_material material[ITEMS];
    struct hl_surface surface[3];    /* plain, blended, rough by texture     */
    struct hl_light light[LIGHTS];
    struct hl_frame frame;
    struct hl_needs needs;
};

static void make_item(struct small *s, int i, float x, float z)
{
    struct hl_item *it = &s->item[i];
    for (int k = 0; k < 16; k += 5)
        it->world[k] = 1;
    it->world[12] = x;
    it->world[14] = z;
    for (int k = 0; k < 3; k++) {
        it->bounds_min[k] = -1;
        it->bounds_max[k] = 1;
    }
    it->count = 36;
    it->material = &s->material[i];
    s->material[i].roughness = 0.5f;
}

static void make(struct small *s)
{
    memset(s, 0, sizeof *s);
    for (int i = 0; i < ITEMS; i++)
        make_item(s, i, (float)i * 4 - 8, -20);
    s->surface[1].blended = true;
    s->surface[2].textures = HL_TEXTURED_METAL_ROUGH;
    for (int i = 0; i < 16; i += 5)
        s->frame.camera.view[i] = 1;
    s->frame.camera.tan_half_y = 0.5f;
    s->frame.camera.near = 0.1f;
    s->frame.camera.far = 77;
    s->frame.items = s->item;
    s->frame.n_items = ITEMS;
    s->frame.lights = s->light;
    s->frame.n_lights = 0;
}

static void add_light(struct small *s, float x, float z, float radius)
{
    struct hl_light *l = &s->light[s->frame.n_lights++];
    l->position[0] = x;
    l->position[2] = z;
    l->radius = radius;
    l->color[0] = 1;
    l->color[1] = 2;
}

static const struct hl_needs *measure(struct small *s)
{
    hl_needs_measure(&s->needs, &s->frame, s->surface, 16.0f / 9);
    return &s->needs;
}

static void counts_are_the_frames(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    add_light(&s, 0, -20, 3);
    const struct hl_needs *n = measure(&s);
    assert_int_equal(n->n_objects, ITEMS);
    assert_int_equal(n->n_triangles, ITEMS * 12);
    assert_int_equal(n->n_lights, 1);
    assert_true(n->far == 77);
    assert_false(n->blended);
    s.item[3].surface = 1;
    assert_true(measure(&s)->blended);
}

static void choices_are_left_alone(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    memset(&s.needs, 0x5A, sizeof s.needs);
    struct hl_needs before = s.needs;
    const struct hl_needs *n = measure(&s);
    assert_int_equal(n->width, before.width);
    assert_int_equal(n->light_height, before.light_height);
    assert_int_equal(n->samples, before.samples);
    assert_int_equal(n->n_regions, before.n_regions);
    assert_int_equal(n->light_path, before.light_path);
    assert_int_equal(n->batch, before.batch);
    assert_int_equal(n->tile, before.tile);
    assert_int_equal(n->dsf, before.dsf);
    assert_true(n->dsf_k == before.dsf_k && n->max_error == before.max_error);
    assert_int_equal(n->light_format, before.light_format);
}

static void in_limits(double x, double low, double high)
{
    if (!(x >= low && x <= high))
        fail_msg("%g is not in %g to %g", x, low, high);
}

/* A wall of 8 x 4 m, 20 m away, sides seen edge-on: the view there is 20 m
 * high, of the box's front, 19 m away, 19. Outlines are known to a cell of
 * 128 x 72 on either side: (w / 33.8 +- 1 / 64) (h / 19 +- 1 / 36). */
static void cover_is_what_boxes_hide(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    s.frame.n_items = 1;
    s.item[0].world[12] = 0;
    s.item[0].world[0] = 4;
    s.item[0].world[5] = 2;
    double w = 8 / (19 * 16.0 / 9), h = 4 / 19.0;
    double cover = (double)measure(&s)->cover;
    in_limits(cover, (w - 1.0 / 64) * (h - 1.0 / 36),
                     (w + 1.0 / 64) * (h + 1.0 / 36));
    /* The same behind it hides no more; beside it, twice as much. */
    s.frame.n_items = 2;
    s.item[1] = s.item[0];
    assert_true((double)measure(&s)->cover == cover);
    s.item[1].world[12] = 10;
    in_limits((double)measure(&s)->cover, cover * 1.6, cover * 2.4);
    /* What is blended hides nothing, and nothing is not unknown. */
    s.item[0].surface = s.item[1].surface = 1;
    in_limits((double)measure(&s)->cover, 1e-9, 1e-3);
}

/* A transform that is refused later is measured before that. */
static void nonsense_is_measured_without_harm(void **state)
{
    static const float bad[] = { NAN, INFINITY, -INFINITY, 1e38f };
    (void)state;
    struct small s;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (int k = 0; k < 16; k++) {
            make(&s);
            s.item[0].surface = k & 1;
            s.item[1].world[k] = bad[i];
            s.item[0].world[k] = bad[i];
            double cover = (double)measure(&s)->cover;
            assert_true(cover >= 0 && cover <= 1);
        }
}

/* Blended objects have all their lights in one draw. */
static void pairs_are_of_what_is_opaque(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    add_light(&s, 0, -20, 100);
    add_light(&s, 1, -20, 100);
    assert_true((double)measure(&s)->pair_draws == 2.0 * ITEMS);
    s.item[2].surface = 1;
    assert_true((double)measure(&s)->pair_draws == 2.0 * (ITEMS - 1));
    assert_true((double)s.needs.pair_triangles == 24.0 * (ITEMS - 1));
    assert_true((double)s.needs.lights_per_object == 2);
}

static void kinds_of_light_are_collected(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    assert_int_equal(measure(&s)->lights, 0);
    add_light(&s, 0, -20, 3);
    assert_int_equal(measure(&s)->lights, HL_LIGHTS_SMOOTH);
    s.light[0].falloff = HL_INVERSE_SQUARE;
    assert_int_equal(measure(&s)->lights, HL_LIGHTS_INVERSE_SQUARE);
    add_light(&s, 0, -20, 3);
    s.light[1].kind = HL_SPOT;
    s.light[1].direction[1] = -1;
    s.light[1].outer = 1;
    assert_int_equal(measure(&s)->lights, HL_LIGHTS_SMOOTH |
                     HL_LIGHTS_INVERSE_SQUARE | HL_LIGHTS_CONES);
    /* A bad light counts for nothing but its number: drawing refuses it. */
    s.light[1].radius = -1;
    assert_int_equal(measure(&s)->lights, HL_LIGHTS_INVERSE_SQUARE);
    assert_int_equal(s.needs.n_lights, 2);
}

static void lights_an_object_are_those_that_touch_it(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    /* Item boxes: x from 4 i - 9 to 4 i - 7. Touches items 1 (by 0.5), 2. */
    add_light(&s, -1, -20, 2.5f);
    ck_near((double)measure(&s)->lights_per_object, 2.0 / ITEMS, 1e-6);
    add_light(&s, 0, -20, 100);
    ck_near((double)measure(&s)->lights_per_object, 7.0 / ITEMS, 1e-6);
    s.light[1].kind = HL_DIRECTIONAL;
    s.light[1].radius = 0;
    ck_near((double)measure(&s)->lights_per_object, 7.0 / ITEMS, 1e-6);
    /* Items behind the camera are not asked. */
    s.item[2].world[14] = 20;
    ck_near((double)measure(&s)->lights_per_object, 5.0 / (ITEMS - 1), 1e-6);
}

/* A sphere's outline covers pi tan^2(asin(r / d)) of slopes; the screen has
 * 1 x 16 / 9 of them. pi / 4 of the rounded rectangle: within 3 %. */
static void lights_a_pixel_are_their_outlines(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    add_light(&s, 0, -20, 3);
    double one = 3.14159265 * 9 / (400 - 9) / (16.0 / 9);
    ck_near((double)measure(&s)->lights_per_pixel / one, 1, 0.03);
    add_light(&s, 0, -20, 3);
    ck_near((double)measure(&s)->lights_per_pixel / one, 2, 0.06);
    add_light(&s, 0, 20, 3);                     /* behind                   */
    ck_near((double)measure(&s)->lights_per_pixel / one, 2, 0.06);
    add_light(&s, 0, -20, 0);                    /* no light                 */
    ck_near((double)measure(&s)->lights_per_pixel / one, 2, 0.06);
}

static void the_peak_sums_what_may_meet(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    assert_true(measure(&s)->peak == 0);
    add_light(&s, -10, -20, 1);
    assert_true(measure(&s)->peak == 2);
    add_light(&s, 10, -20, 1);                   /* elsewhere                */
    assert_true(measure(&s)->peak == 2);
    add_light(&s, 10.1f, -20, 1);
    assert_true(measure(&s)->peak == 4);
    s.light[2].falloff = HL_INVERSE_SQUARE;
    assert_true(measure(&s)->peak == 2 + 2e4f);
    s.light[2].kind = HL_DIRECTIONAL;
    s.light[2].direction[1] = -1;
    assert_true(measure(&s)->peak == 4);
}

static void exponents_decide_the_specular_need(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    const struct hl_needs *n = measure(&s);
    assert_int_equal(n->specular, HL_NEED_ONE_EXPONENT);
    ck_near((double)n->exponent, 30, 1e-4);      /* 2 / (1/2)^4 - 2          */
    s.material[4].roughness = 0.6f;
    assert_int_equal(measure(&s)->specular, HL_NEED_EXPONENTS);
    s.material[4].no_specular = true;
    assert_int_equal(measure(&s)->specular, HL_NEED_ONE_EXPONENT);
    /* A blended surface may be stippled; where it is not, its own exponent
     * does not matter, but that it has highlights does. */
    s.material[4].no_specular = false;
    s.item[4].surface = 1;
    assert_int_equal(measure(&s)->specular, HL_NEED_EXPONENTS);
    s.needs.translucency = HL_TRANSLUCENCY_FORWARD;
    assert_int_equal(measure(&s)->specular, HL_NEED_ONE_EXPONENT);
    for (int i = 0; i < ITEMS; i++)
        s.material[i].no_specular = i != 4;
    assert_int_equal(measure(&s)->specular, HL_NEED_ONE_EXPONENT);
    for (int i = 0; i < ITEMS; i++)
        s.material[i].no_specular = false;
    s.needs.translucency = HL_TRANSLUCENCY_AUTO;
    s.item[4].surface = 2;
    s.material[4].roughness = 0.5f;
    assert_int_equal(measure(&s)->specular, HL_NEED_EXPONENTS);
    for (int i = 0; i < ITEMS; i++)
        s.material[i].no_specular = true;
    assert_int_equal(measure(&s)->specular, HL_NEED_NO_SPECULAR);
    s.frame.n_items = 0;
    assert_int_equal(measure(&s)->specular, HL_NEED_NO_SPECULAR);
}

/* By how many boxes of translucent items cover one point. */
static void layers_are_the_most_over_a_point(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    assert_int_equal(measure(&s)->blended_layers, 0);
    for (int i = 0; i < ITEMS; i++) {
        s.item[i].surface = 1;
        assert_int_equal(measure(&s)->blended_layers, 1);
    }
    s.item[2].world[12] = -8;                  /* the one in the middle      */
    s.item[0].world[12] = 0;
    for (int i = 1; i < ITEMS; i++) {          /* in a row, away from us      */
        s.item[i].world[12] = 0;
        s.item[i].world[14] = -20 - 4 * (float)i;
        assert_int_equal(measure(&s)->blended_layers, i + 1);
    }
    s.item[2].surface = 0;
    assert_int_equal(measure(&s)->blended_layers, ITEMS - 1);
    s.item[3].world[14] = 20;                  /* behind us                  */
    assert_int_equal(measure(&s)->blended_layers, ITEMS - 2);
    /* One far smaller than the grid's cells, alone and before another. */
    s.frame.n_items = 1;
    for (int k = 0; k < 3; k++)
        s.item[0].world[k * 5] = 0.001f;
    assert_int_equal(measure(&s)->blended_layers, 1);
    s.frame.n_items = 2;
    assert_int_equal(measure(&s)->blended_layers, 2);
}

static void decals_are_seen(void **state)
{
    (void)state;
    struct small s;
    make(&s);
    s.surface[1].blended = false;
    s.surface[1].decal = true;
    assert_false(measure(&s)->decals);
    s.item[2].surface = 1;
    assert_true(measure(&s)->decals);
    assert_false(s.needs.blended);
    assert_int_equal(s.needs.blended_layers, 0);
    s.item[2].surface = 0;
    assert_false(measure(&s)->decals);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_are_the_most_over_a_point),
        cmocka_unit_test(decals_are_seen),
        cmocka_unit_test(counts_are_the_frames),
        cmocka_unit_test(choices_are_left_alone),
        cmocka_unit_test(cover_is_what_boxes_hide),
        cmocka_unit_test(nonsense_is_measured_without_harm),
        cmocka_unit_test(pairs_are_of_what_is_opaque),
        cmocka_unit_test(kinds_of_light_are_collected),
        cmocka_unit_test(lights_an_object_are_those_that_touch_it),
        cmocka_unit_test(lights_a_pixel_are_their_outlines),
        cmocka_unit_test(the_peak_sums_what_may_meet),
        cmocka_unit_test(exponents_decide_the_specular_need),
    };
    return cmocka_run_group_tests_name("needs", tests, NULL, NULL);
}
