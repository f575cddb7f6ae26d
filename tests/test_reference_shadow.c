/* SPDX-License-Identifier: Zlib */
/* The reference renderer's shadows, BRDFs, fences and decals against closed
 * forms. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/reference_kit.h"

/* Shadow edges are probed this far from where they are, metres: some ten
 * double operations on coordinates below 10 err by less than 1e-14. */
#define BESIDE 1e-9

/* A white floor from -6 to 6 at z = 0, a white sheet from -1 to 1 at z = 1
 * above it, and a light that casts shadows. */
static struct hlh_light *stage(struct kit *k, enum hlh_light_kind kind)
{
    kit_make(k);
    kit_material(k)->base_color[0] = 1;
    kit_quad(k, 6, 0);
    kit_material(k)->base_color[0] = 1;
    kit_quad(k, 1, 1);
    struct hlh_light *l = kit_light(k, kind);
    l->radius = 30;
    l->shadow = true;
    l->outer_angle = 1.5f;
    k->options.shadows = true;
    return l;
}

static bool lit(const struct kit *k, double x, double y)
{
    return kit_probe(k, x, y).diffuse[0] > 0;
}

/* Lit at (x, y) on the one side of an edge and not on the other. */
static void check_edge(const struct kit *k, double x, double y, double out_x,
                       double out_y)
{
    assert_true(lit(k, x + BESIDE * out_x, y + BESIDE * out_y));
    assert_false(lit(k, x - BESIDE * out_x, y - BESIDE * out_y));
}

/* From (4, 0, 2) a point of the sheet is thrown twice as far: x from -6 to -2
 * and y from -2 to 2. */
static void edges_are_where_rays_graze(void **state)
{
    (void)state;
    static const enum hlh_light_kind kinds[] = { HLH_LIGHT_POINT,
                                                 HLH_LIGHT_SPOT };
    for (int i = 0; i < 2; i++) {
        struct kit k;
        struct hlh_light *l = stage(&k, kinds[i]);
        l->position[0] = 4;
        l->position[2] = 2;
        l->direction[0] = -0.894427191f;
        l->direction[2] = -0.447213595f;
        check_edge(&k, -2, 0.3, 1, 0);
        check_edge(&k, -3, 2, 0, 1);
        check_edge(&k, -3, -2, 0, -1);
        kit_free(&k);
    }
    struct kit k;
    struct hlh_light *l = stage(&k, HLH_LIGHT_DIRECTIONAL);
    l->direction[0] = -1;
    check_edge(&k, -2, 0.3, -1, 0);
    check_edge(&k, -1.5, 1, 0, 1);
    /* From below, the sheet turned over: it hides from either side. */
    float *w = k.objects[1].world;
    w[0] = w[10] = -1;
    w[14] = 2;
    check_edge(&k, -2, 0.3, -1, 0);
    kit_free(&k);
}

static void only_what_casts_hides(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_light *l = stage(&k, HLH_LIGHT_POINT);
    struct hlh_material *m = &k.materials[1];
    l->position[0] = 4;
    l->position[2] = 2;
    assert_false(lit(&k, -3, 0));
    k.objects[1].no_shadow = true;
    assert_true(lit(&k, -3, 0));
    k.objects[1].no_shadow = false;
    m->decal = true;
    assert_true(lit(&k, -3, 0));
    m->decal = false;
    m->alpha = HLH_ALPHA_BLEND;
    assert_true(lit(&k, -3, 0));
    m->alpha = HLH_ALPHA_MASK;
    m->base_color[3] = 0.5f;
    assert_false(lit(&k, -3, 0));
    m->base_color[3] = 0.4999f;
    assert_true(lit(&k, -3, 0));
    m->fence = true;
    assert_true(lit(&k, -3, 0));
    m->base_color[3] = 1;
    assert_false(lit(&k, -3, 0));
    k.options.shadows = false;
    assert_true(lit(&k, -3, 0));
    k.options.shadows = true;
    l->shadow = false;
    assert_true(lit(&k, -3, 0));
    /* Between the floor and the sheet, which the ray would reach at 0.5. */
    l->shadow = true;
    l->position[0] = -0.5f;
    l->position[2] = 0.5f;
    assert_true(lit(&k, -1.5, 0));
    kit_free(&k);
}

/* A floor under grazing light, and a quad that continues another exactly:
 * neither hides itself or its neighbour. */
static void what_is_flat_does_not_hide_itself(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_light *l = stage(&k, HLH_LIGHT_POINT);
    k.objects[1].world[12] = 2;
    k.objects[1].world[14] = -1;
    l->position[0] = 5.9f;
    l->position[1] = 3.3f;
    l->position[2] = 1.0f / 1024;
    for (int i = 0; i < 400; i++)
        assert_true(lit(&k, -4.9 + 9.7 * (i % 20) / 19,
                        -4.9 + 9.7 * (i / 20) / 19));
    kit_free(&k);
}

/* The sheet a hundredth of a millimetre above the floor: the shadow reaches
 * 2.5e-5 beyond its edge, of which the eye sees all but 2e-6. */
static void what_nearly_touches_hides(void **state)
{
    (void)state;
    struct kit k;
    struct hlh_light *l = stage(&k, HLH_LIGHT_POINT);
    l->position[0] = 4;
    l->position[2] = 2;
    k.objects[1].world[14] = -1 + 1e-5f;
    assert_false(lit(&k, -1.00001, 0));
    assert_true(lit(&k, -1.00003, 0));
    kit_free(&k);
}

static void trees_find_the_same_shadows(void **state)
{
    (void)state;
    struct kit k;
    uint32_t seed = 5;
    stage(&k, HLH_LIGHT_POINT)->position[2] = 3;
    for (int i = 0; i < 20; i++) {
        float *w;
        kit_quad(&k, 0.5f, 0);
        w = k.objects[k.scene.n_objects - 1].world;
        for (int c = 0; c < 3; c++)
            w[12 + c] = (float)(6 * kit_random(&seed) - (c < 2 ? 3 : 4));
        w[2] = (float)(kit_random(&seed) - 0.5);
    }
    k.options.threads = 2;
    float *tree = kit_draw(&k, NULL);
    k.options.brute_force = true;
    float *brute = kit_draw(&k, NULL);
    assert_memory_equal(tree, brute, 3 * KIT_SIZE * KIT_SIZE * sizeof *tree);
    free(tree);
    free(brute);
    kit_free(&k);
}

/* Closed form of Engel's lambSkinDusk beside N.L, roll-off 0.2. */
static double skin(double nl)
{
    double a = fmin(fmax((nl + 0.2) / 1.2, 0), 1), b = fmin(fmax(nl, 0), 1);
    return fmax(nl, 0) + fmax(a * a * (3 - 2 * a) - b * b * (3 - 2 * b), 0);
}

static void skin_glows_past_the_terminator(void **state)
{
    (void)state;
    static const double angles[] = { 0, 30, 60, 85, 90, 95, 100, 110 };
    struct kit k;
    stage(&k, HLH_LIGHT_DIRECTIONAL);
    k.scene.n_objects = 1;
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
        double a = angles[i] * 3.14159265358979323846 / 180;
        struct hlh_light *l = &k.lights[0];
        l->direction[0] = (float)sin(a);
        l->direction[2] = (float)-cos(a);
        double nl = -(double)l->direction[2];
        k.materials[0].brdf = HLH_BRDF_BLINN_PHONG;
        struct hlr_probe plain = kit_probe(&k, 0, 0);
        k.materials[0].brdf = HLH_BRDF_SKIN;
        struct hlr_probe p = kit_probe(&k, 0, 0);
        /* The direction is unit to a float's rounding, which scales N.L. */
        check_near(p.diffuse[0], skin(nl), 2e-7, "skin");
        check_near(plain.diffuse[0], fmax(nl, 0), 2e-7, "Lambert");
        assert_true(p.specular[0] == plain.specular[0]);
    }
    kit_free(&k);
}

/* Red that emits 1 over the floor's green of 0.5, by an alpha of 0.25. */
static void fences_and_decals_are_blended(void **state)
{
    (void)state;
    struct kit k;
    stage(&k, HLH_LIGHT_POINT)->radius = 0;
    k.materials[0].emission[1] = 0.5f;
    k.materials[1].emission[0] = 1;
    k.materials[1].base_color[3] = 0.25f;
    check_near3(kit_probe(&k, 0.2, 0).color, 1, 0, 0, 0, "opaque");
    k.materials[1].decal = true;
    check_near3(kit_probe(&k, 0.2, 0).color, 0.25, 0.375, 0, 0, "decal");
    k.materials[1].decal = false;
    k.materials[1].alpha = HLH_ALPHA_MASK;
    check_near3(kit_probe(&k, 0.2, 0).color, 0, 0.5, 0, 0, "masked");
    k.materials[1].fence = true;
    check_near3(kit_probe(&k, 0.2, 0).color, 0.25, 0.375, 0, 0, "fence");
    kit_free(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_are_where_rays_graze),
        cmocka_unit_test(only_what_casts_hides),
        cmocka_unit_test(what_is_flat_does_not_hide_itself),
        cmocka_unit_test(what_nearly_touches_hides),
        cmocka_unit_test(trees_find_the_same_shadows),
        cmocka_unit_test(skin_glows_past_the_terminator),
        cmocka_unit_test(fences_and_decals_are_blended),
    };
    return cmocka_run_group_tests_name("reference shadows", tests, NULL,
                                       NULL);
}
