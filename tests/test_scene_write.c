/* SPDX-License-Identifier: Zlib */
/* Built-in scenes, scenes written and read back, and third-party files. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>
#include "tests/scene_kit.h"

static void add(uint64_t *h, const void *bytes, size_t size)
{
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        *h = (*h ^ b[i]) * 1099511628211u;       /* FNV-1a */
}

static uint64_t hash_scene(const struct hlh_scene *s)
{
    uint64_t h = 14695981039346656037u;
    for (uint32_t i = 0; i < s->n_meshes; i++) {
        const struct hlh_mesh *m = &s->meshes[i];
        add(&h, m->vertices, m->n_vertices * sizeof *m->vertices);
        add(&h, m->indices, m->n_indices * sizeof *m->indices);
    }
    for (uint32_t i = 0; i < s->n_objects; i++) {
        add(&h, &s->objects[i].mesh, 4);
        add(&h, s->objects[i].world, 64);
    }
    for (uint32_t i = 0; i < s->n_lights; i++) {
        add(&h, s->lights[i].position, 12);
        add(&h, s->lights[i].color, 12);
        add(&h, &s->lights[i].radius, 4);
    }
    for (uint32_t i = 0; i < s->n_images; i++)
        add(&h, s->images[i].rgba,
            (size_t)s->images[i].width * s->images[i].height * 4);
    return h;
}

/* Every corner's normal lies on its face's side: closed shapes are wound
 * counter-clockwise from outside, rooms from inside. */
static void assert_winding(const struct hlh_mesh *m)
{
    for (uint32_t i = 0; i < m->n_indices; i += 3) {
        const struct hlh_vertex *v[3];
        double a[3], b[3], n[3];
        for (uint32_t k = 0; k < 3; k++)
            v[k] = &m->vertices[m->indices[i + k]];
        for (int k = 0; k < 3; k++) {
            a[k] = (double)v[1]->position[k] - v[0]->position[k];
            b[k] = (double)v[2]->position[k] - v[0]->position[k];
        }
        n[0] = a[1] * b[2] - a[2] * b[1];
        n[1] = a[2] * b[0] - a[0] * b[2];
        n[2] = a[0] * b[1] - a[1] * b[0];
        for (int k = 0; k < 3; k++)
            if (!(n[0] * v[k]->normal[0] + n[1] * v[k]->normal[1] +
                  n[2] * v[k]->normal[2] > 0))
                fail_msg("%s: triangle %u is wound the other way", m->name,
                         (unsigned)(i / 3));
    }
}

/* The papers' counts, and the bits of each scene: generators use exact
 * arithmetic only, so that a hash that differs is a change of the scene or a
 * compiler that contracts or reorders floats. */
static const struct {
    const char *name;
    uint32_t objects, lights;
    uint64_t low, high;               /* triangles                           */
    uint64_t hash;
} builtins[] = {
    {"fig1", 189, 213, 50000, 120000, 0x9fe86e28e549efb8},
    {"fig7", 287, 287, 130000, 190000, 0x599b6a92a95680f6},
    {"fig8", 101, 81, 45000, 65000, 0x0fb399020e2a53af},
    {"fig9", 189, 122, 50000, 120000, 0xf7be49af4b80f11b},
    {"lidr", 31, 255, 38000, 45000, 0x85c71930f5a881e0},
    {"thin", 41, 64, 10000, 40000, 0x01db55f64023f75a},
    {"many", 1000, 50, 12000, 12000, 0x8e12c86f9108b123},
    {"blades", 15, 11, 5000, 10000, 0xbecf1a2185bf4382},
    {"blades-0", 15, 11, 5000, 10000, 0xbecf1a2185bf4382},
    {"blades-1", 15, 11, 5000, 10000, 0xbecf1a2185bf4382},
    {"blades-2", 15, 11, 5000, 10000, 0xbecf1a2185bf4382},
    {"blades-3", 15, 11, 5000, 10000, 0xbecf1a2185bf4382},
    {"fence", 46, 40, 8000, 15000, 0x72e9a56ac4a5a7bf},
    {"decals", 30, 30, 4000, 10000, 0x005634c4ca37fed8},
    {"shadows", 10, 9, 4000, 8000, 0xabc59aca0fda6937},
    {"glass", 67, 25, 10000, 20000, 0x24d27dd5a6240200},
    {"brdfs", 7, 6, 4000, 12000, 0x7b68b0076ae9b197},
};

static void built_in_scenes_have_the_papers_counts(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof builtins / sizeof *builtins; i++) {
        struct hlh_scene s;
        struct hlh_error e;
        assert_true(hlh_scene_builtin(&s, builtins[i].name, &e));
        sk_assert_promises(&s);
        assert_int_equal(s.n_objects, builtins[i].objects);
        assert_int_equal(s.n_lights, builtins[i].lights);
        assert_in_range(s.n_triangles, builtins[i].low, builtins[i].high);
        assert_false(s.camera_is_default || s.lights_are_default);
        assert_int_equal(s.triangles_dropped + s.normals_repaired, 0);
        for (uint32_t m = 0; m < s.n_meshes; m++)
            assert_winding(&s.meshes[m]);
        if (hash_scene(&s) != builtins[i].hash)
            fail_msg("%s: hash is 0x%016llx", builtins[i].name,
                     (unsigned long long)hash_scene(&s));
        hlh_scene_free(&s);
    }
}

static void every_built_in_is_listed_once(void **state)
{
    const char *name, *text;
    uint32_t n = 0;
    (void)state;
    for (; (name = hlh_scene_builtin_name(n, &text)); n++) {
        assert_string_equal(name, builtins[n].name);
        assert_true(strlen(text) > 10);
    }
    assert_int_equal(n, sizeof builtins / sizeof *builtins);
    assert_null(hlh_scene_builtin_name(n + 100, NULL));
}

static void fig9_has_one_exponent_and_no_metal(void **state)
{
    struct hlh_scene s;
    struct hlh_error e;
    (void)state;
    assert_true(hlh_scene_builtin(&s, "fig9", &e));
    for (uint32_t i = 0; i < s.n_materials; i++) {
        assert_true(s.materials[i].metallic == 0);
        assert_true(s.materials[i].roughness == s.materials[0].roughness);
    }
    hlh_scene_free(&s);
}

/* Bricks of neighbouring courses and columns share their faces' planes: the
 * largest x of one is the smallest of the next, bit for bit. */
static void the_bricks_of_many_touch(void **state)
{
    struct hlh_scene s;
    struct hlh_error e;
    (void)state;
    assert_true(hlh_scene_builtin(&s, "many", &e));
    for (uint32_t i = 0; i + 1 < s.n_objects; i++) {
        const float *a = s.objects[i].world, *b = s.objects[i + 1].world;
        if (a[13] == b[13])
            assert_true(a[12] + 0.25f == b[12] - 0.25f);
    }
    hlh_scene_free(&s);
}

/* ---- written and read back ---- */

static void assert_same_mesh(const struct hlh_mesh *a,
                             const struct hlh_mesh *b)
{
    assert_string_equal(a->name, b->name);
    assert_int_equal(a->n_vertices, b->n_vertices);
    assert_int_equal(a->n_indices, b->n_indices);
    assert_memory_equal(a->vertices, b->vertices,
                        a->n_vertices * sizeof *a->vertices);
    assert_memory_equal(a->indices, b->indices,
                        a->n_indices * sizeof *a->indices);
    assert_int_equal(a->material, b->material);
    assert_true(a->has_uv == b->has_uv && a->has_color == b->has_color &&
                a->has_tangent == b->has_tangent);
}

static void assert_same_texture(const struct hlh_texture *a,
                                const struct hlh_texture *b)
{
    assert_int_equal(a->image, b->image);
    if (a->image < 0)
        return;
    assert_int_equal(a->wrap_u, b->wrap_u);
    assert_int_equal(a->wrap_v, b->wrap_v);
}

static void assert_same_material(const struct hlh_material *a,
                                 const struct hlh_material *b)
{
    assert_string_equal(a->name, b->name);
    assert_memory_equal(a->base_color, b->base_color, sizeof a->base_color);
    assert_memory_equal(a->emission, b->emission, sizeof a->emission);
    assert_true(a->metallic == b->metallic && a->roughness == b->roughness);
    assert_true(a->normal_scale == b->normal_scale);
    assert_true(a->alpha == b->alpha && a->alpha_cutoff == b->alpha_cutoff);
    assert_true(a->double_sided == b->double_sided);
    assert_true(a->fence == b->fence && a->decal == b->decal);
    assert_int_equal(a->brdf, b->brdf);
    assert_same_texture(&a->base_texture, &b->base_texture);
    assert_same_texture(&a->metal_rough_texture, &b->metal_rough_texture);
    assert_same_texture(&a->normal_texture, &b->normal_texture);
    assert_same_texture(&a->emission_texture, &b->emission_texture);
}

static void assert_same_light(const struct hlh_light *a,
                              const struct hlh_light *b)
{
    assert_int_equal(a->kind, b->kind);
    assert_memory_equal(a->color, b->color, sizeof a->color);
    assert_int_equal(a->falloff, b->falloff);
    assert_true(a->shadow == b->shadow);
    if (a->kind != HLH_LIGHT_DIRECTIONAL) {
        assert_memory_equal(a->position, b->position, sizeof a->position);
        assert_true(a->radius == b->radius);
    }
    if (a->kind != HLH_LIGHT_POINT)
        for (int k = 0; k < 3; k++)
            assert_true(a->direction[k] == b->direction[k]);
    assert_true(a->inner_angle == b->inner_angle);
    assert_true(a->outer_angle == b->outer_angle);
    assert_int_equal(a->range_derived, b->range_derived);
}

/* The direction goes through a double matrix and back to a target that is as
 * far away as the eye is from the origin: a few float roundings, 3e-7. */
static void assert_same_camera(const struct hlh_camera *a,
                               const struct hlh_camera *b)
{
    double u[3], v[3], lu = 0, lv = 0, off = 0;
    for (int k = 0; k < 3; k++) {
        assert_true(a->eye[k] == b->eye[k]);
        u[k] = (double)a->target[k] - a->eye[k];
        v[k] = (double)b->target[k] - b->eye[k];
        lu += u[k] * u[k];
        lv += v[k] * v[k];
    }
    for (int k = 0; k < 3; k++)
        off += fabs(u[k] / sqrt(lu) - v[k] / sqrt(lv));
    assert_true(off < 1e-6);
    assert_true(a->vfov == b->vfov && a->aspect == b->aspect);
}

static void assert_same_scene(const struct hlh_scene *a,
                              const struct hlh_scene *b)
{
    assert_int_equal(a->n_images, b->n_images);
    assert_int_equal(a->n_materials, b->n_materials);
    assert_int_equal(a->n_meshes, b->n_meshes);
    assert_int_equal(a->n_objects, b->n_objects);
    assert_int_equal(a->n_lights, b->n_lights);
    for (uint32_t i = 0; i < a->n_images; i++) {
        assert_string_equal(a->images[i].name, b->images[i].name);
        assert_int_equal(a->images[i].width, b->images[i].width);
        assert_int_equal(a->images[i].height, b->images[i].height);
        assert_memory_equal(a->images[i].rgba, b->images[i].rgba,
                            (size_t)a->images[i].width *
                                a->images[i].height * 4);
    }
    for (uint32_t i = 0; i < a->n_materials; i++)
        assert_same_material(&a->materials[i], &b->materials[i]);
    for (uint32_t i = 0; i < a->n_meshes; i++)
        assert_same_mesh(&a->meshes[i], &b->meshes[i]);
    for (uint32_t i = 0; i < a->n_objects; i++) {
        assert_int_equal(a->objects[i].mesh, b->objects[i].mesh);
        assert_true(a->objects[i].no_shadow == b->objects[i].no_shadow);
        for (int k = 0; k < 16; k++)
            assert_true(a->objects[i].world[k] == b->objects[i].world[k]);
    }
    for (uint32_t i = 0; i < a->n_lights; i++)
        assert_same_light(&a->lights[i], &b->lights[i]);
    assert_same_camera(&a->camera, &b->camera);
    assert_true(a->n_triangles == b->n_triangles);
    assert_memory_equal(a->bounds_min, b->bounds_min, sizeof a->bounds_min);
    assert_memory_equal(a->bounds_max, b->bounds_max, sizeof a->bounds_max);
}

static void assert_round_trip(void **state, const struct hlh_scene *s,
                              bool replace)
{
    struct hlh_scene back;
    struct hlh_error e;
    char path[SK_PATH];
    sk_path(path, state, "trip");
    if (!hlh_scene_write(s, path, &e))
        fail_msg("%s", e.text);
    sk_path(path, state, "trip.glb");
    if (!hlh_scene_load(&back, path, &e))
        fail_msg("%s", e.text);
    assert_int_equal(back.triangles_dropped + back.normals_repaired, 0);
    sk_path(path, state, "trip.lights.csv");
    if (!hlh_scene_lights_csv(&back, path, replace, &e))
        fail_msg("%s", e.text);
    assert_same_scene(s, &back);
    hlh_scene_free(&back);
}

static void built_in_scenes_survive_a_round_trip(void **state)
{
    const char *name;
    for (uint32_t i = 0; (name = hlh_scene_builtin_name(i, NULL)); i++) {
        struct hlh_scene s;
        struct hlh_error e;
        bool all_in_csv = true;
        assert_true(hlh_scene_builtin(&s, name, &e));
        for (uint32_t k = 0; k < s.n_lights; k++)
            all_in_csv = all_in_csv && s.lights[k].kind == HLH_LIGHT_POINT &&
                         !s.lights[k].shadow;
        assert_round_trip(state, &s, all_in_csv);
        hlh_scene_free(&s);
    }
}

/* The text of the .camera file is exact, the ambient colour included. */
static void the_camera_file_is_exact(void **state)
{
    struct hlh_scene s;
    struct hlh_error e;
    char path[SK_PATH], line[512];
    float v[7], ambient[3];
    FILE *file;
    assert_true(hlh_scene_builtin(&s, "fig8", &e));
    s.ambient[1] = 0.1f;
    s.camera.eye[0] = 1.0f / 3;
    s.camera.vfov = 100.0f / 3;
    sk_path(path, state, "fig8");
    assert_true(hlh_scene_write(&s, path, &e));
    sk_path(path, state, "fig8.camera");
    file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    assert_int_equal(fgetc(file), EOF);
    fclose(file);
    assert_int_equal(sscanf(line, "%f,%f,%f,%f,%f,%f,%f 1280x720 ambient "
                            "%f,%f,%f", v, v + 1, v + 2, v + 3, v + 4, v + 5,
                            v + 6, ambient, ambient + 1, ambient + 2), 10);
    assert_memory_equal(v, s.camera.eye, 12);
    assert_memory_equal(v + 3, s.camera.target, 12);
    assert_true(v[6] == s.camera.vfov);
    assert_memory_equal(ambient, s.ambient, 12);
    hlh_scene_free(&s);
}

/* Lights that only glTF can say, awkward names, every wrap and alpha mode,
 * tangents and colours. Such lights go into the GLB: the CSV adds to them. */
static void odd_lights_and_materials_survive_a_round_trip(void **state)
{
    struct hlh_scene s;
    char text[512];
    assert_true(sk_load(state, &s, "'emissiveFactor'",
                        "'alphaMode':'MASK','alphaCutoff':0.3,"
                        "'doubleSided':true,'normalTexture':{'index':0,"
                        "'scale':-0.7},'emissiveFactor'", text));
    free(s.materials[0].name);
    s.materials[0].name = malloc(32);
    assert_non_null(s.materials[0].name);
    strcpy(s.materials[0].name, "a \"b\" \\ \n\1 \303\251");
    s.meshes[0].has_tangent = s.meshes[0].has_color = true;
    for (uint32_t i = 0; i < 4; i++) {
        float *t = s.meshes[0].vertices[i].tangent;
        t[0] = 0.6f, t[1] = 0.8f, t[3] = i & 1 ? -1.0f : 1.0f;
        s.meshes[0].vertices[i].color[2] = 0.1f * (float)i;
    }
    s.objects[0].world[12] = 1e-30f;
    s.objects[0].world[0] = -3.3333333f;
    s.bounds_min[0] = -3.3333333f;
    s.bounds_max[0] = 1e-30f;
    s.lights[0].radius = 3.3333333f;
    for (int kind = 0; kind < 3; kind++) {
        s.lights[0].kind = (enum hlh_light_kind)kind;
        s.lights[0].inner_angle = kind == HLH_LIGHT_SPOT ? 0.3f : 0;
        s.lights[0].outer_angle = kind == HLH_LIGHT_SPOT ? 1.1f : 0;
        s.lights[0].color[0] = 0.1f;
        s.lights[0].color[1] = 3333.3333f;
        s.lights[0].color[2] = 1e-20f;
        assert_round_trip(state, &s, false);
    }
    hlh_scene_free(&s);
}

/* Unit only to a float's rounding: of such directions one in a hundred, as
 * these, changes when it is normalised once more. */
static void directions_keep_their_last_bit(void **state)
{
    static const float direction[3][3] = {
        {0x1.fd0a56p-4f, 0x1.04b534p-1f, -0x1.b408fep-1f},
        {-0x1.66511ap-1f, 0x1.f776b4p-2f, 0x1.094cd2p-1f},
        {-0x1.192bd8p-5f, -0x1.5f5ed4p-1f, 0x1.73fc8ep-1f},
    };
    struct hlh_scene s;
    char text[512];
    assert_true(sk_load(state, &s, NULL, NULL, text));
    for (int i = 0; i < 3; i++) {
        memcpy(s.lights[0].direction, direction[i], sizeof direction[i]);
        memcpy(s.meshes[0].vertices[0].normal, direction[i],
               sizeof direction[i]);
        assert_round_trip(state, &s, false);
    }
    hlh_scene_free(&s);
}

static void a_derived_range_is_derived_again(void **state)
{
    struct hlh_scene s;
    char text[512];
    assert_true(sk_load(state, &s, ",'range':5", "", text));
    assert_round_trip(state, &s, false);
    hlh_scene_free(&s);
}

static void a_failed_write_leaves_nothing(void **state)
{
    struct hlh_scene s;
    struct hlh_error e;
    char path[SK_PATH];
    int before;
    assert_true(hlh_scene_builtin(&s, "many", &e));
    sk_path(path, state, "no-such-folder/x");
    assert_false(hlh_scene_write(&s, path, &e));
    sk_assert_contains(e.text, "no-such-folder/x.glb: cannot be created");
    /* The second of the three files cannot be written. */
    sk_path(path, state, "half.lights.csv");
    assert_int_equal(mkdir(path, 0777), 0);
    before = sk_count(state);
    sk_path(path, state, "half");
    assert_false(hlh_scene_write(&s, path, &e));
    sk_assert_contains(e.text, "half.lights.csv: is a directory");
    assert_int_equal(sk_count(state), before);
    assert_false(sk_exists(state, "half.glb"));
    hlh_scene_free(&s);
}

/* What glTF has no word for: a smooth spot, shadows, BRDFs, fences, decals
 * and objects without shadows. */
static void what_is_ours_survives_a_round_trip(void **state)
{
    struct hlh_scene s;
    char text[512];
    assert_true(sk_load(state, &s, NULL, NULL, text));
    assert_true(s.n_lights > 0 && s.lights[0].kind == HLH_LIGHT_SPOT);
    s.lights[0].falloff = HLH_FALLOFF_SMOOTH;
    s.lights[0].shadow = true;
    s.materials[0].brdf = HLH_BRDF_SKIN;
    s.materials[0].alpha = HLH_ALPHA_MASK;
    s.materials[0].fence = true;
    s.materials[0].decal = true;
    s.objects[0].no_shadow = true;
    assert_round_trip(state, &s, false);
    hlh_scene_free(&s);
}

/* ---- third-party files ---- */

/* Triangles as the collection's README counts them: drawn, those without area
 * included; `dropped` says how many of them those are. */
static const struct {
    const char *path;
    uint64_t drawn, dropped;
    uint32_t lights;                  /* 0: default ones                     */
} shared[] = {
    {"01-many-cubes/many-cubes.gltf", 6012, 0, 0},
    {"02-building-deferred/subpass_scene_opaque.gltf", 23388, 4168, 0},
    {"02-building-deferred/subpass_scene_transparent.gltf", 208, 0, 0},
    {"03-lidr-room/Map.obj", 454, 0, 0},
    {"04-milk-truck/CesiumMilkTruck.glb", 3624, 0, 0},
    {"05-alpha-blend/AlphaBlendModeTest.glb", 61, 0, 0},
    {"06-flight-helmet/FlightHelmet.gltf", 94722, 0, 0},
    {"07-suzanne-normalmap/02_suzanne.gltf", 3936, 0, 0},
    {"08-primitives/cube.gltf", 12, 0, 0},
    {"08-primitives/torus.gltf", 3072, 0, 0},
    {"08-primitives/sphere.gltf", 3968, 0, 0},
    {"08-primitives/Cubes.glb", 36, 0, 1},
    {"08-primitives/BoxTextured.glb", 12, 0, 0},
    {"08-primitives/Fox.glb", 576, 0, 0},
    {"09-vr-gallery/vr-gallery.glb", 1930, 0, 0},
    {"10-glass-table/glass-table.glb", 592, 0, 0},
    {"11-icosahedron/icosahedron.glb", 260, 0, 0},
    {"12-low-poly-tree/low-poly-tree.glb", 1126, 0, 0},
    {"13-shaderball/shaderBall.glb", 3392, 0, 0},
    {"13-shaderball/roundedCube.glb", 300, 0, 0},
    {"20-kaykit-dungeon/chest.glb", 728, 0, 0},
    {"20-kaykit-dungeon/wall_doorway.glb", 1068, 0, 0},
    {"21-kenney/building-small-b.glb", 600, 34, 0},
    {"21-kenney/road-straight-lightposts.glb", 190, 4, 0},
    {"bench/fig8.glb", 53568, 0, 0},
    {"bench/fig7.glb", 135432, 0, 0},
    {"bench/lidr.glb", 39192, 0, 0},
};

static void third_party_files_load(void **state)
{
    const char *base = getenv("HL_SHARED");
    struct stat info;
    char path[SK_PATH];
    (void)state;
    if (!base)
        base = "../shared";
    snprintf(path, sizeof path, "%s/scenes", base);
    if (stat(path, &info) != 0) {
        print_message("skipped: no third-party scenes at %s\n", path);
        skip();
    }
    for (size_t i = 0; i < sizeof shared / sizeof *shared; i++) {
        struct hlh_scene s;
        struct hlh_error e;
        snprintf(path, sizeof path, "%s/scenes/%s", base, shared[i].path);
        if (!hlh_scene_load(&s, path, &e))
            fail_msg("%s", e.text);
        sk_assert_promises(&s);
        if (s.n_triangles != shared[i].drawn - shared[i].dropped)
            fail_msg("%s: %llu triangles", shared[i].path,
                     (unsigned long long)s.n_triangles);
        assert_true(!shared[i].dropped == !s.triangles_dropped);
        assert_int_equal(s.n_lights, shared[i].lights ? shared[i].lights : 9);
        assert_true(s.lights_are_default == !shared[i].lights);
        hlh_scene_free(&s);
    }
}

/* The author's table has its own column order and a header. */
static void the_lidr_rooms_lights_are_refused(void **state)
{
    const char *base = getenv("HL_SHARED");
    struct hlh_scene s;
    struct hlh_error e;
    struct stat info;
    char path[SK_PATH];
    (void)state;
    snprintf(path, sizeof path, "%s/scenes/03-lidr-room/lights.csv",
             base ? base : "../shared");
    if (stat(path, &info) != 0)
        skip();
    assert_true(hlh_scene_builtin(&s, "many", &e));
    assert_false(hlh_scene_lights_csv(&s, path, true, &e));
    sk_assert_contains(e.text, "lights.csv: line 1: field 1 (x)");
    hlh_scene_free(&s);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(built_in_scenes_have_the_papers_counts),
        cmocka_unit_test(every_built_in_is_listed_once),
        cmocka_unit_test(fig9_has_one_exponent_and_no_metal),
        cmocka_unit_test(the_bricks_of_many_touch),
        cmocka_unit_test(built_in_scenes_survive_a_round_trip),
        cmocka_unit_test(the_camera_file_is_exact),
        cmocka_unit_test(odd_lights_and_materials_survive_a_round_trip),
        cmocka_unit_test(directions_keep_their_last_bit),
        cmocka_unit_test(a_derived_range_is_derived_again),
        cmocka_unit_test(what_is_ours_survives_a_round_trip),
        cmocka_unit_test(a_failed_write_leaves_nothing),
        cmocka_unit_test(third_party_files_load),
        cmocka_unit_test(the_lidr_rooms_lights_are_refused),
    };
    return cmocka_run_group_tests_name("scenes built, written and found",
                                       tests, sk_setup, sk_teardown);
}
