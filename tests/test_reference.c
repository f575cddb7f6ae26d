/* SPDX-License-Identifier: Zlib */
/* The reference renderer against closed forms of design section 4, written
 * out here a second time: lights, materials, visibility, layers, samples.
 * test_reference_texture.c goes on with textures and normal maps. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/reference_kit.h"

/* A closed form and the renderer each take some 60 double operations of
 * condition near 1: 60 * 2^-53 < 1e-14 of values up to some 100. */
#define EXACT 1e-12

/* ---- lights and materials ---- */

static void one_light_on_a_plane_is_the_closed_form(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    struct hlh_material *m = kit_material(&k);
    m->base_color[0] = 0.5f, m->base_color[1] = 0.25f, m->base_color[2] = 1;
    m->metallic = 0.25f;
    m->roughness = 0.5f;
    m->emission[1] = 0.125f;
    kit_quad(&k, 6, 0);
    k.scene.ambient[0] = 0.5f, k.scene.ambient[2] = 0.25f;
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
    l->position[0] = 1, l->position[1] = -0.5f, l->position[2] = 2;
    l->radius = 8;
    l->color[0] = 3, l->color[1] = 2, l->color[2] = 0.5f;
    static const double at[4][2] = { { 0, 0 }, { 3, 1 }, { -4, -4 }, { 1, 2 } };
    for (int i = 0; i < 4; i++) {
        double x = at[i][0], y = at[i][1];
        double dx = 1 - x, dy = -0.5 - y, dz = 2;
        double d = sqrt(dx * dx + dy * dy + dz * dz);
        double a = pow(1 - d * d / 64, 2), nl = dz / d;
        double e = sqrt(x * x + y * y + 25);
        double hx = dx / d - x / e, hy = dy / d - y / e, hz = dz / d + 5 / e;
        double nh = hz / sqrt(hx * hx + hy * hy + hz * hz);
        /* roughness 1/2: alpha = 1/4, n = 2 * 16 - 2 */
        double s = a * nl * pow(nh, 30), diffuse = a * nl;
        struct hlr_probe p = kit_probe(&k, x, y);
        check_near3(p.color,
            0.5 * 0.75 * (0.5 + 3 * diffuse) +
                (0.04 * 0.75 + 0.5 * 0.25) * 38 / 8 * 3 * s,
            0.125 + 0.25 * 0.75 * (2 * diffuse) +
                (0.04 * 0.75 + 0.25 * 0.25) * 38 / 8 * 2 * s,
            1 * 0.75 * (0.25 + 0.5 * diffuse) +
                (0.04 * 0.75 + 1 * 0.25) * 38 / 8 * 0.5 * s, EXACT, "out");
        check_near3(p.position, x, y, 0, EXACT, "position");
        check_near(p.depth, 5, EXACT, "depth");
    }
    kit_free(&k);
}

static void pixels_are_the_probes_in_float(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k)->base_color[1] = 0.5f;
    kit_quad(&k, 6, 0);
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
    l->position[2] = 2;
    l->radius = 8;
    float *rgb = kit_draw(&k, NULL);
    for (uint32_t i = 0; i < KIT_SIZE * KIT_SIZE; i += 77) {
        double x = 10 * (i % KIT_SIZE + 0.5) / KIT_SIZE - 5;
        double y = 5 - 10 * (i / KIT_SIZE + 0.5) / KIT_SIZE;
        struct hlr_probe p = kit_probe(&k, x, y);
        /* one rounding to float: 2^-24 of a value below 2 */
        check_near((double)rgb[3 * i + 1], p.color[1], 1.2e-7, "pixel");
    }
    free(rgb);
    kit_free(&k);
}

/* Light straight above the point, eye too: N.L = N.H = 1. */
static void attenuation_follows_the_two_falloffs(void **state)
{
    (void)state;
    static const struct { enum hlh_falloff f; float r, d; double a; } row[] = {
        { HLH_FALLOFF_SMOOTH, 4, 2, 0.5625 },
        { HLH_FALLOFF_SMOOTH, 4, 1, 225.0 / 256 },
        { HLH_FALLOFF_SMOOTH, 4, 4, 0 },
        { HLH_FALLOFF_SMOOTH, 4, 4.5f, 0 },
        { HLH_FALLOFF_SMOOTH, 0, 0, 0 },
        { HLH_FALLOFF_SMOOTH, 4, 0, 0 },
        { HLH_FALLOFF_INVERSE_SQUARE, 4, 2, 15.0 / 64 },
        { HLH_FALLOFF_INVERSE_SQUARE, 2, 1, 15.0 / 16 },
        { HLH_FALLOFF_INVERSE_SQUARE, 4, 4, 0 },
        { HLH_FALLOFF_INVERSE_SQUARE, 4, 5, 0 },
        { HLH_FALLOFF_INVERSE_SQUARE, 0, 1, 0 },
        { HLH_FALLOFF_INVERSE_SQUARE, 4, 0, 0 },
        /* nearer than 1 cm counts as 1 cm: 1e4 (1 - 2^-36) */
        { HLH_FALLOFF_INVERSE_SQUARE, 4, 1.0f / 128, 1e4 - 1e4 / 68719476736 },
    };
    struct kit k;
    kit_make(&k);
    kit_material(&k)->base_color[0] = 1;
    kit_quad(&k, 6, 0);
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        l->falloff = row[i].f;
        l->radius = row[i].r;
        l->position[2] = row[i].d;
        struct hlr_probe p = kit_probe(&k, 0, 0);
        check_near(p.diffuse[0], row[i].a, EXACT * (1 + row[i].a), "D");
        check_near(p.specular[0], row[i].a, EXACT * (1 + row[i].a), "S");
        assert_int_equal(p.lights, row[i].a > 0);
    }
    kit_free(&k);
}

/* A spot one metre above the plane, aimed down: tan(theta) from its foot. */
static void cone_edges_are_gltf_s(void **state)
{
    (void)state;
    double mid = acos(0.5 * (cos(0.25) + cos(0.5)));
    double sharp = acos(cos(0.5) + 0.0005);
    const struct { float inner, outer; double theta, factor; } row[] = {
        { 0.25f, 0.5f, 0, 1 }, { 0.25f, 0.5f, 0.2, 1 },
        { 0.25f, 0.5f, 0.25, 1 }, { 0.25f, 0.5f, mid, 0.25 },
        { 0.25f, 0.5f, 0.5, 0 }, { 0.25f, 0.5f, 0.6, 0 },
        /* no width: 1 / max(0.001, 0) */
        { 0.5f, 0.5f, sharp, 0.25 }, { 0.5f, 0.5f, 0.51, 0 },
    };
    struct kit k;
    kit_make(&k);
    kit_material(&k)->base_color[0] = 1;
    kit_quad(&k, 6, 0);
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_SPOT);
    l->position[2] = 1;
    l->radius = 16;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        double x = tan(row[i].theta), c = cos(row[i].theta);
        double a = pow(1 - 1 / (c * c * 256), 2);
        l->inner_angle = row[i].inner;
        l->outer_angle = row[i].outer;
        /* the cone's slope, up to 1000, scales the rounding of cos(theta) */
        check_near(kit_probe(&k, x, 0).diffuse[0], a * c * row[i].factor,
                   1000 * EXACT, "cone");
    }
    kit_free(&k);
}

static void a_directional_light_has_no_falloff(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k)->base_color[0] = 1;
    kit_quad(&k, 60, 0);
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_DIRECTIONAL);
    l->radius = 0;
    l->direction[0] = 0.6f;
    l->direction[2] = -0.8f;
    double length = hypot((double)0.6f, (double)0.8f);
    for (double x = -40; x <= 40; x += 10)
        check_near(kit_probe(&k, x, 0).diffuse[0], (double)0.8f / length,
                   EXACT, "D");
    kit_free(&k);
}

static void a_light_behind_the_surface_gives_nothing(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k)->base_color[0] = 1;
    kit_quad(&k, 6, 0);
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
    l->position[0] = 1, l->position[2] = -0.0625f;
    l->radius = 4;
    /* H leans to the eye's side, so N.H > 0: only N.L stops the specular */
    struct hlr_probe p = kit_probe(&k, 0, 0);
    assert_int_equal(p.lights, 1);
    check_near3(p.color, 0, 0, 0, 0, "out");
    kit_free(&k);
}

static void materials_follow_the_gltf_mapping(void **state)
{
    (void)state;
    static const struct { float rough, metal; double n; } row[] = {
        { 0, 0, 256 }, { 0.25f, 0, 256 }, { 0.5f, 0.5f, 30 }, { 1, 1, 1 },
        { 0.75f, 1, 2 / 0.31640625 - 2 },
    };
    struct kit k;
    kit_make(&k);
    struct hlh_material *m = kit_material(&k);
    m->base_color[0] = 0.75f, m->base_color[1] = 0.5f;
    m->base_color[3] = 0.25f;
    kit_quad(&k, 6, 0);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        double metal = (double)row[i].metal, scale = (row[i].n + 8) / 8;
        double f = 0.04 * (1 - metal);
        m->roughness = row[i].rough;
        m->metallic = row[i].metal;
        struct hlr_probe p = kit_probe(&k, 1, 1);
        check_near(p.exponent, row[i].n, EXACT * 256, "n");
        check_near(p.alpha, 1, 0, "alpha of an opaque material");
        check_near3(p.rho, 0.75 * (1 - metal), 0.5 * (1 - metal), 0, EXACT,
                    "rho");
        check_near3(p.ks, (f + 0.75 * metal) * scale,
                    (f + 0.5 * metal) * scale, f * scale, EXACT * 10, "ks");
    }
    kit_free(&k);
}

/* ---- what is seen ---- */

static void sphere(struct kit *k, uint32_t rows, uint32_t columns)
{
    static const double pi = 3.14159265358979323846;
    struct hlh_mesh *m = kit_mesh(k, (rows + 1) * (columns + 1),
                                  6 * rows * columns);
    uint32_t *at = m->indices;
    for (uint32_t i = 0; i <= rows; i++)
        for (uint32_t j = 0; j <= columns; j++) {
            struct hlh_vertex *v = &m->vertices[i * (columns + 1) + j];
            double a = pi * i / rows, b = 2 * pi * (j % columns) / columns;
            v->position[0] = v->normal[0] = (float)(sin(a) * sin(b));
            v->position[1] = v->normal[1] = (float)cos(a);
            v->position[2] = v->normal[2] = (float)(sin(a) * cos(b));
        }
    for (uint32_t i = 0; i < rows; i++)
        for (uint32_t j = 0; j < columns; j++) {
            uint32_t a = i * (columns + 1) + j, b = a + columns + 1;
            uint32_t quad[6] = { a, b, a + 1, a + 1, b, b + 1 };
            memcpy(at, quad, sizeof quad);
            at += 6;
        }
}

static void a_sphere_has_its_silhouette_ids_and_normals(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k);
    kit_quad(&k, 1, 100);        /* behind the eye: object 0 is not seen */
    sphere(&k, 64, 128);
    k.scene.background[2] = 0.25f;
    k.scene.ambient[2] = 1;
    uint32_t *ids;
    float *rgb = kit_draw(&k, &ids);
    for (uint32_t i = 0; i < KIT_SIZE * KIT_SIZE; i++) {
        double x = 2 * (i % KIT_SIZE + 0.5) / KIT_SIZE - 1;
        double y = 1 - 2 * (i / KIT_SIZE + 0.5) / KIT_SIZE;
        double cos2 = 1 / (1 + x * x + y * y), off2 = 25 * (1 - cos2);
        /* the mesh lies between the spheres of cos(pi/64) cos(pi/128) and 1,
         * and float vertices */
        if (off2 > 1.000001) {
            assert_int_equal(ids[i], 0);
            assert_true(rgb[3 * i + 2] == 0.25f);
        } else if (off2 < 0.9965) {
            assert_int_equal(ids[i], 2);
            assert_true(rgb[3 * i + 2] == 0);
            double t = 5 * cos2 - sqrt((1 - off2) * cos2);
            struct hlr_probe p = kit_probe(&k, 5 * x, 5 * y);
            /* facet depth 0.0015, seen under up to 86 degrees */
            check_near(p.depth, t, 0.02, "depth");
            check_near3(p.normal, x * t, y * t, 5 - t, 0.02, "normal");
        }
    }
    free(rgb);
    free(ids);
    kit_free(&k);
}

static void back_faces_are_culled_unless_double_sided(void **state)
{
    (void)state;
    for (int mirrored = 0; mirrored < 2; mirrored++)
        for (int behind = 0; behind < 2; behind++)
            for (int both = 0; both < 2; both++) {
                struct kit k;
                kit_make(&k);
                struct hlh_material *m = kit_material(&k);
                m->double_sided = both;
                m->base_color[0] = 1;
                kit_quad(&k, 6, 0);
                k.objects[0].world[0] = mirrored ? -1 : 1;
                k.scene.camera.eye[2] = behind ? -5 : 5;
                struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
                l->position[2] = behind ? -1 : 1;
                l->radius = 2;
                struct hlr_probe p = kit_probe(&k, 0.25, 0.5);
                assert_int_equal(p.id, !behind || both);
                if (p.id) {
                    assert_int_equal(p.back_face, behind);
                    check_near(p.normal[2], behind ? -1 : 1, 0, "normal");
                    assert_true(p.diffuse[0] > 0);
                }
                kit_free(&k);
            }
}

static void normals_go_by_the_inverse_transpose(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k);
    struct hlh_mesh *m = kit_quad(&k, 6, 0);
    for (int i = 0; i < 4; i++) {
        m->vertices[i].normal[1] = 0.5f;
        m->vertices[i].normal[2] = 1;
    }
    k.objects[0].world[0] = -2;
    k.objects[0].world[5] = 4;
    /* (0, 0.5 / 4, 1) made unit */
    check_near3(kit_probe(&k, 1, 2).normal, 0, 0.125 / sqrt(1.015625),
                1 / sqrt(1.015625), EXACT, "normal");
    /* a flat scale has no inverse; the cofactors still give its normal */
    k.objects[0].world[0] = 2;
    k.objects[0].world[10] = 0;
    check_near3(kit_probe(&k, 1, 2).normal, 0, 0, 1, EXACT, "flat normal");
    kit_free(&k);
}

static void normals_are_unit_at_the_vertex_and_after(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k);
    struct hlh_mesh *m = kit_quad(&k, 5, 0);
    for (int i = 0; i < 4; i++) {
        m->vertices[i].normal[0] = i < 2 ? 0 : 4; /* to be made unit first */
        m->vertices[i].normal[2] = i < 2 ? 1 : 0;
    }
    /* a quarter of the way from (0, 0, 1) to (1, 0, 0) */
    check_near3(kit_probe(&k, -2.5, 0).normal, 0.25 / sqrt(0.625), 0,
                0.75 / sqrt(0.625), EXACT, "normal");
    kit_free(&k);
}

static void an_edge_belongs_to_one_triangle(void **state)
{
    (void)state;
    struct kit k;
    enum { SPOKES = 16 };
    uint32_t seed = 2009;
    kit_make(&k);
    struct hlh_material *m = kit_material(&k);
    m->alpha = HLH_ALPHA_BLEND;
    m->base_color[3] = 0.5f;
    m->double_sided = true;
    struct hlh_mesh *fan = kit_mesh(&k, SPOKES + 1, 3 * SPOKES);
    for (uint32_t i = 0; i < SPOKES; i++) {
        /* every other one at a multiple of 45 degrees */
        static const int dx[8] = { 1, 1, 0, -1, -1, -1, 0, 1 };
        static const int dy[8] = { 0, 1, 1, 1, 0, -1, -1, -1 };
        struct hlh_vertex *v = &fan->vertices[i + 1];
        uint32_t a = i / 2, b = (a + i % 2) % 8;
        v->position[0] = 2 * (float)(dx[a] + dx[b]);
        v->position[1] = 2 * (float)(dy[a] + dy[b]);
        v->position[2] = (float)kit_random(&seed);
        fan->indices[3 * i + 1] = i + 1;
        fan->indices[3 * i + 2] = (i + 1) % SPOKES + 1;
    }
    for (int turned = 0; turned < 8; turned++) {
        k.objects[0].world[0] = turned & 1 ? -1 : 1;
        k.objects[0].world[5] = turned & 2 ? -1 : 1;
        /* from the fifth turn on every other triangle has its back here */
        for (uint32_t i = 1; i < SPOKES && turned == 4; i += 2) {
            fan->indices[3 * i + 1] = (i + 1) % SPOKES + 1;
            fan->indices[3 * i + 2] = i + 1;
        }
        struct hlr_prepared *p = hlr_prepare(&k.scene, NULL);
        for (uint32_t i = 0; i < 32 * SPOKES; i++) {
            const float *v = fan->vertices[i % SPOKES + 1].position;
            struct hlr_probe hit;
            /* toward a point of the spoke: straight on it or 1e-16 beside */
            double s = i / SPOKES / 40.0, f = s * 5 / (5 - s * (double)v[2]);
            const float *w = k.objects[0].world;
            double x = 32 * (1 + f * (double)(w[0] * v[0]) / 5);
            double y = 32 * (1 - f * (double)(w[5] * v[1]) / 5);
            assert_true(hlr_probe(&hit, p, &k.options, x, y));
            assert_int_equal(hit.layers, 1);
        }
        hlr_prepared_free(p);
    }
    kit_free(&k);
}

static void the_camera_looks_down_when_told(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    kit_material(&k)->double_sided = true;
    kit_quad(&k, 6, 0);
    /* the quad turned into y = 0: (x, y, 0) becomes (x, 0, -y) */
    float *w = k.objects[0].world;
    w[5] = 0, w[6] = -1, w[9] = 1, w[10] = 0;
    k.scene.camera = (struct hlh_camera){ { 0, 5, 0 }, { 0, 0, 0 },
                                          { 0, 1, 0 }, 90, 0 };
    /* up is -z, so y of the picture is -z of the world */
    check_near3(kit_probe(&k, 1, 2).position, 1, 0, -2, EXACT, "down");
    k.scene.camera.eye[1] = -5;
    check_near3(kit_probe(&k, 1, 2).position, -1, 0, -2, EXACT, "up");
    k.options.near = 5.5;
    assert_int_equal(kit_probe(&k, 1, 2).id, 0);
    k.options.near = 0, k.options.far = 4.5;
    assert_int_equal(kit_probe(&k, 1, 2).id, 0);
    kit_free(&k);
}

/* ---- layers ---- */

static struct hlh_material *glow(struct kit *k, float red, float green)
{
    struct hlh_material *m = kit_material(k);
    m->emission[0] = red;
    m->emission[1] = green;
    return m;
}

static void blended_surfaces_are_over_one_another_by_depth(void **state)
{
    (void)state;
    for (int swapped = 0; swapped < 2; swapped++) {
        struct kit k;
        kit_make(&k);
        for (int i = 0; i < 2; i++) {
            int a = i != swapped;    /* a: the near one */
            struct hlh_material *m = glow(&k, a ? 1 : 0, a ? 0 : 1);
            m->alpha = HLH_ALPHA_BLEND;
            m->base_color[3] = a ? 0.25f : 0.5f;
            kit_quad(&k, 3, a ? 2 : 1);
        }
        struct hlh_material *opaque = glow(&k, 0, 0);
        opaque->emission[2] = 1;
        opaque->base_color[3] = 0.125f; /* no matter */
        kit_quad(&k, 3, 0);
        glow(&k, 9, 9)->alpha = HLH_ALPHA_BLEND; /* hidden */
        kit_quad(&k, 3, -1);
        struct hlr_probe p = kit_probe(&k, 0.25, 0);
        check_near3(p.color, 0.25, 0.75 * 0.5, 0.75 * 0.5, EXACT, "over");
        assert_int_equal(p.layers, 2);
        assert_int_equal(p.id, 2 - swapped);
        uint32_t *ids;
        free(kit_draw(&k, &ids));
        assert_int_equal(ids[32 * KIT_SIZE + 32], 3);
        free(ids);
        k.options.ids_of_blended = true;
        free(kit_draw(&k, &ids));
        assert_int_equal(ids[32 * KIT_SIZE + 32], 2 - swapped);
        free(ids);
        kit_free(&k);
    }
}

static void equal_depths_go_by_scene_order(void **state)
{
    (void)state;
    for (int blend = 0; blend < 2; blend++)
        for (int brute = 0; brute < 2; brute++) {
            struct kit k;
            kit_make(&k);
            k.options.brute_force = brute;
            for (int i = 0; i < 9; i++) {
                struct hlh_material *m = glow(&k, (float)(i + 1), 0);
                m->alpha = blend ? HLH_ALPHA_BLEND : HLH_ALPHA_OPAQUE;
                kit_quad(&k, 3, 0);
            }
            /* the first opaque stays, the last blended lies on top */
            check_near(kit_probe(&k, 1, 0).color[0], blend ? 9 : 1, 0,
                       "top");
            kit_free(&k);
        }
}

static void crossing_panes_are_sorted_for_each_sample(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    for (int i = 0; i < 2; i++) {
        struct hlh_material *m = glow(&k, i ? 1 : 0, i ? 0 : 1);
        m->alpha = HLH_ALPHA_BLEND;
        m->base_color[3] = 0.5f;
        struct hlh_mesh *q = kit_quad(&k, 3, 0);
        for (int v = 0; v < 4; v++)
            q->vertices[v].position[2] =
                q->vertices[v].position[0] * (i ? 0.25f : -0.25f);
    }
    check_near3(kit_probe(&k, 1, 0).color, 0.5, 0.25, 0, EXACT, "right");
    check_near3(kit_probe(&k, -1, 0).color, 0.25, 0.5, 0, EXACT, "left");
    kit_free(&k);
}

static void masked_surfaces_draw_from_the_cutoff_on(void **state)
{
    (void)state;
    struct kit k;
    kit_make(&k);
    struct hlh_material *m = glow(&k, 1, 0);
    m->alpha = HLH_ALPHA_MASK;
    kit_quad(&k, 3, 1)->vertices[0].color[3] = 1;
    glow(&k, 0, 1);
    kit_quad(&k, 3, 0);
    m->base_color[3] = 0.5f;
    check_near3(kit_probe(&k, 1, 0).color, 1, 0, 0, 0, "at the cutoff");
    m->base_color[3] = 0.4999f;
    check_near3(kit_probe(&k, 1, 0).color, 0, 1, 0, 0, "below");
    for (int i = 0; i < 4; i++)
        k.meshes[0].vertices[i].color[3] = 0.5f;
    m->base_color[3] = 1;
    check_near3(kit_probe(&k, 1, 0).color, 1, 0, 0, 0, "by COLOR_0");
    m->base_color[3] = 0.99f;
    check_near3(kit_probe(&k, 1, 0).color, 0, 1, 0, 0, "by COLOR_0 below");
    kit_free(&k);
}

/* ---- samples ---- */

/* A lit quarter plane left of and above (x, y) in the middle of three by
 * three pixels: its share counts the samples up to there. */
static double share(struct kit *k, double x, double y)
{
    float *w = k->objects[0].world;
    w[12] = (float)(10 * (1 + x) / 3 - 5 - 40);
    w[13] = (float)(5 - 10 * (1 + y) / 3 + 40);
    uint32_t *ids;
    float *rgb = kit_draw(k, &ids);
    double out = (double)rgb[3 * 4];
    assert_int_equal(ids[4], x > 0.5 && y > 0.5);
    free(rgb);
    free(ids);
    return out;
}

static void samples_lie_at_the_standard_positions(void **state)
{
    (void)state;
    /* Vulkan 1.3, table of standard sample locations, in sixteenths */
    static const int two[] = { 12, 12, 4, 4 };
    static const int four[] = { 6, 2, 14, 6, 2, 10, 10, 14 };
    static const int eight[] = { 9, 5, 7, 11, 13, 9, 5, 3, 3, 13, 1, 7, 11,
                                 15, 15, 1 };
    static const int one[] = { 8, 8 };
    /* 2 x 2 of `grid` */
    static const int grid[] = { 4, 4, 12, 4, 4, 12, 12, 12 };
    static const int *set[] = { one, two, four, eight, grid };
    static const int n[] = { 1, 2, 4, 8, 4 };
    struct kit k;
    kit_make(&k);
    glow(&k, 1, 0);
    kit_quad(&k, 40, 0);
    k.options.width = k.options.height = 3;
    for (int s = 0; s < 5; s++) {
        k.options.samples = s < 4 ? (uint32_t)n[s] : 0;
        k.options.grid = s == 4 ? 2 : 0;
        for (int at = 0; at < 17 * 17; at++) {
            double x = at % 17 - 0.5, y = at / 17 - 0.5;
            int count = 0;
            for (int i = 0; i < n[s]; i++)
                count += set[s][2 * i] < x && set[s][2 * i + 1] < y;
            check_near(share(&k, x / 16, y / 16), (double)count / n[s], 0,
                       "share of the samples");
        }
    }
    kit_free(&k);
}

/* ---- the trees, threads, refusals ---- */

static void random_triangles(struct kit *k, uint32_t n, uint32_t *seed)
{
    struct hlh_mesh *m = kit_mesh(k, 3 * n, 3 * n);
    for (uint32_t i = 0; i < 3 * n; i++) {
        struct hlh_vertex *v = &m->vertices[i];
        m->indices[i] = i;
        for (int c = 0; c < 3; c++) {
            const float *near = m->vertices[i - i % 3].position;
            double r = kit_random(seed) * 2 - 1;
            v->position[c] = (float)(i % 3 ? (double)near[c] + r : r * 3);
            v->normal[c] += (float)kit_random(seed);
        }
        v->color[3] = (float)kit_random(seed);
    }
}

static void random_scene(struct kit *k, uint32_t seed)
{
    kit_make(k);
    for (uint32_t i = 0; i < 12; i++) {
        struct hlh_material *m = kit_material(k);
        m->alpha = (enum hlh_alpha)(i % 3);
        m->double_sided = i % 4 < 2;
        for (int c = 0; c < 3; c++)
            m->base_color[c] = (float)kit_random(&seed);
        m->roughness = (float)kit_random(&seed);
        random_triangles(k, 40, &seed);
        k->objects[i].world[0] = i % 5 ? 1 : -1;
    }
    for (uint32_t i = 0; i < 200; i++) {
        struct hlh_light *l = kit_light(k, (enum hlh_light_kind)(i % 10 % 3));
        l->falloff = (enum hlh_falloff)(i % 2);
        l->radius = (float)(2 * kit_random(&seed));
        l->outer_angle = 1;
        for (int c = 0; c < 3; c++) {
            l->position[c] = (float)(8 * kit_random(&seed) - 4);
            l->direction[c] = (float)(kit_random(&seed) - 0.5);
            l->color[c] = (float)kit_random(&seed);
        }
    }
    k->options.width = 48;
    k->options.height = 32;
}

static void trees_and_threads_change_no_bit(void **state)
{
    (void)state;
    for (uint32_t seed = 1; seed <= 3; seed++) {
        struct kit k;
        uint32_t *ids[4];
        float *rgb[4];
        random_scene(&k, seed);
        k.options.samples = 4;
        for (uint32_t i = 0; i < 4; i++) {
            k.options.brute_force = i == 1;
            k.options.threads = i == 2 ? 2 : i == 3 ? 7 : 1;
            rgb[i] = kit_draw(&k, &ids[i]);
        }
        for (int i = 1; i < 4; i++) {
            assert_memory_equal(rgb[0], rgb[i], 48 * 32 * 3 * sizeof(float));
            assert_memory_equal(ids[0], ids[i], 48 * 32 * sizeof(uint32_t));
        }
        for (int i = 0; i < 4; i++) {
            free(rgb[i]);
            free(ids[i]);
        }
        kit_free(&k);
    }
}

static void count_progress(double fraction, void *user)
{
    double *last = user;
    assert_true(fraction > *last && fraction <= 1);
    *last = fraction;
}

static void statistics_and_progress_tell_what_was_done(void **state)
{
    (void)state;
    struct kit k;
    struct hlr_stats trees, brute;
    double last = 0;
    random_scene(&k, 7);
    k.options.progress = count_progress;
    k.options.user = &last;
    float *rgb = malloc(48 * 32 * 3 * sizeof *rgb);
    assert_true(hlr_render(rgb, NULL, &k.scene, &k.options, &trees));
    check_near(last, 1, 0, "progress");
    k.options.progress = NULL;
    k.options.brute_force = true;
    assert_true(hlr_render(rgb, NULL, &k.scene, &k.options, &brute));
    assert_int_equal(trees.samples, 48 * 32);
    assert_int_equal(trees.triangles, 480);
    assert_true(trees.surfaces > 0);
    assert_int_equal(trees.surfaces, brute.surfaces);
    assert_int_equal(trees.light_evaluations, brute.light_evaluations);
    free(rgb);
    kit_free(&k);
}

static void what_cannot_be_drawn_is_refused(void **state)
{
    (void)state;
    struct kit k;
    float rgb[3];
    const char *why = NULL;
    kit_make(&k);
    kit_material(&k);
    kit_quad(&k, 1, 0);
    struct hlr_options o = k.options;
    o.width = o.height = 1;
    assert_true(hlr_render(rgb, NULL, &k.scene, &o, NULL));
    o.width = 0;
    assert_false(hlr_render(rgb, NULL, &k.scene, &o, NULL));
    o.width = 1, o.samples = 3;
    assert_false(hlr_render(rgb, NULL, &k.scene, &o, NULL));
    o.samples = 16;
    assert_false(hlr_render(rgb, NULL, &k.scene, &o, NULL));
    o.samples = 0, o.grid = 65;
    assert_false(hlr_render(rgb, NULL, &k.scene, &o, NULL));
    struct hlh_light *l = kit_light(&k, HLH_LIGHT_POINT);
    l->radius = -1;
    assert_null(hlr_prepare(&k.scene, &why));
    assert_non_null(strstr(why, "radius"));
    l->radius = 1, l->color[1] = NAN;
    assert_null(hlr_prepare(&k.scene, &why));
    assert_non_null(strstr(why, "colour"));
    l->color[1] = 0, k.meshes[0].indices[5] = 4;
    assert_null(hlr_prepare(&k.scene, &why));
    assert_non_null(strstr(why, "index"));
    kit_free(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_light_on_a_plane_is_the_closed_form),
        cmocka_unit_test(pixels_are_the_probes_in_float),
        cmocka_unit_test(attenuation_follows_the_two_falloffs),
        cmocka_unit_test(cone_edges_are_gltf_s),
        cmocka_unit_test(a_directional_light_has_no_falloff),
        cmocka_unit_test(a_light_behind_the_surface_gives_nothing),
        cmocka_unit_test(materials_follow_the_gltf_mapping),
        cmocka_unit_test(a_sphere_has_its_silhouette_ids_and_normals),
        cmocka_unit_test(back_faces_are_culled_unless_double_sided),
        cmocka_unit_test(normals_go_by_the_inverse_transpose),
        cmocka_unit_test(normals_are_unit_at_the_vertex_and_after),
        cmocka_unit_test(an_edge_belongs_to_one_triangle),
        cmocka_unit_test(the_camera_looks_down_when_told),
        cmocka_unit_test(blended_surfaces_are_over_one_another_by_depth),
        cmocka_unit_test(equal_depths_go_by_scene_order),
        cmocka_unit_test(crossing_panes_are_sorted_for_each_sample),
        cmocka_unit_test(masked_surfaces_draw_from_the_cutoff_on),
        cmocka_unit_test(samples_lie_at_the_standard_positions),
        cmocka_unit_test(trees_and_threads_change_no_bit),
        cmocka_unit_test(statistics_and_progress_tell_what_was_done),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
    };
    return cmocka_run_group_tests_name("reference", tests, NULL, NULL);
}
