/* SPDX-License-Identifier: Zlib */
/* Scenes from files: what the numbers of a glTF, an OBJ or a CSV become in
 * struct hlh_scene (design section 4 and its fine print). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "platforms/host/image.h"
#include "tests/scene_kit.h"

#define PI 3.14159265358979323846

static struct hlh_scene load(void **state, const char *find, const char *by)
{
    struct hlh_scene s;
    char text[512];
    if (!sk_load(state, &s, find, by, text))
        fail_msg("%s", text);
    sk_assert_promises(&s);
    return s;
}

/* The sound document, twice changed, over a changed binary chunk. */
static struct hlh_scene load_two(void **state, const char *const change[4],
                                 const uint8_t *bin)
{
    struct hlh_scene s;
    struct hlh_error e;
    char first[SK_JSON], json[SK_JSON], path[SK_PATH];
    sk_replace(first, sk_good, change[0], change[1]);
    sk_replace(json, first, change[2], change[3]);
    sk_write_glb(state, "bin.glb", json, bin, SK_BIN);
    sk_path(path, state, "bin.glb");
    if (!hlh_scene_load(&s, path, &e))
        fail_msg("%s", e.text);
    sk_assert_promises(&s);
    return s;
}

static struct hlh_scene load_bin(void **state, const char *find,
                                 const char *by, const uint8_t *bin)
{
    const char *const change[4] = {find, by, NULL, NULL};
    return load_two(state, change, bin);
}

static struct hlh_scene load_obj(void **state, const char *text)
{
    struct hlh_scene s;
    struct hlh_error e;
    char path[SK_PATH];
    sk_write_text(state, "kit.obj", text);
    sk_path(path, state, "kit.obj");
    if (!hlh_scene_load(&s, path, &e))
        fail_msg("%s", e.text);
    sk_assert_promises(&s);
    return s;
}

#define ASSERT_EQUAL_FLOATS(a, ...) do {                                     \
        const float want_[] = {__VA_ARGS__};                                 \
        for (size_t i_ = 0; i_ < sizeof want_ / sizeof *want_; i_++)         \
            if ((a)[i_] != want_[i_])                                        \
                fail_msg("line %d: [%zu] is %.9g, not %.9g", __LINE__, i_,   \
                         (a)[i_], want_[i_]);                                \
    } while (0)

static void materials_are_the_files(void **state)
{
    struct hlh_scene s = load(state, NULL, NULL);
    const struct hlh_material *m = &s.materials[0];
    assert_int_equal(s.n_materials, 1);
    assert_string_equal(m->name, "paint");
    ASSERT_EQUAL_FLOATS(m->base_color, 0.5f, 0.25f, 1, 1);
    ASSERT_EQUAL_FLOATS(m->emission, 0, 0, 0.5f);
    assert_true(m->metallic == 0.25f && m->roughness == 0.5f);
    assert_true(m->alpha == HLH_ALPHA_OPAQUE && !m->double_sided);
    assert_int_equal(m->base_texture.image, 0);
    assert_int_equal(m->base_texture.wrap_u, HLH_WRAP_CLAMP);
    assert_int_equal(m->base_texture.wrap_v, HLH_WRAP_MIRROR);
    assert_int_equal(m->normal_texture.image, -1);
    assert_int_equal(s.images[0].width, 2);
    assert_memory_equal(s.images[0].rgba,
                        "\377\0\0\377\0\377\0\377\0\0\377\377"
                        "\377\377\377\377", 16);
    hlh_scene_free(&s);
    s = load(state, "'emissiveFactor'", "'alphaMode':'MASK','alphaCutoff':"
             "0.25,'doubleSided':true,'normalTexture':{'index':0,'scale':2},"
             "'emissiveFactor'");
    m = &s.materials[0];
    assert_true(m->alpha == HLH_ALPHA_MASK && m->alpha_cutoff == 0.25f);
    assert_true(m->double_sided && m->normal_scale == 2);
    assert_int_equal(m->normal_texture.image, 0);
    assert_int_equal(s.n_images, 1);
    hlh_scene_free(&s);
    /* A cutoff is MASK's alone. */
    s = load(state, "'emissiveFactor'", "'alphaCutoff':0.25,"
             "'emissiveFactor'");
    assert_true(s.materials[0].alpha_cutoff == 0.5f);
    hlh_scene_free(&s);
}

static void an_absent_material_is_white_metal(void **state)
{
    struct hlh_scene s = load(state, ",'material':0", "");
    const struct hlh_material *m = &s.materials[s.meshes[0].material];
    ASSERT_EQUAL_FLOATS(m->base_color, 1, 1, 1, 1);
    assert_true(m->metallic == 1 && m->roughness == 1);
    assert_true(!m->double_sided && m->base_texture.image < 0);
    hlh_scene_free(&s);
}

static void lights_are_pi_less_than_the_files(void **state)
{
    struct hlh_scene s = load(state, NULL, NULL);
    const struct hlh_light *l = &s.lights[0];
    assert_int_equal(s.n_lights, 1);
    assert_int_equal(l->kind, HLH_LIGHT_SPOT);
    assert_int_equal(l->falloff, HLH_FALLOFF_INVERSE_SQUARE);
    ASSERT_EQUAL_FLOATS(l->color, (float)(10 / PI), (float)(5 / PI),
                        (float)(2.5 / PI));
    ASSERT_EQUAL_FLOATS(l->position, 0, 0, 3);
    ASSERT_EQUAL_FLOATS(l->direction, 0, 0, -1);
    assert_true(l->radius == 5 && !l->range_derived);
    assert_true(l->inner_angle == 0.1f && l->outer_angle == 0.5f);
    assert_false(s.lights_are_default);
    hlh_scene_free(&s);
}

/* The distance where colour x intensity / d^2 is 1/256 by the largest channel:
 * d = sqrt(256 * 10). */
static void a_range_that_is_absent_is_derived(void **state)
{
    struct hlh_scene s = load(state, ",'range':5", "");
    assert_true(s.lights[0].radius == (float)sqrt(2560));
    assert_true(s.lights[0].range_derived);
    assert_int_equal(s.lights_range_derived, 1);
    hlh_scene_free(&s);
    s = load(state, "'range':5,'spot':{'innerConeAngle':0.1,"
             "'outerConeAngle':0.5}", "'range':0");
    assert_true(s.lights[0].radius == 0 && !s.lights[0].range_derived);
    assert_true(s.lights[0].inner_angle == 0);
    assert_true(s.lights[0].outer_angle == (float)(PI / 4));
    hlh_scene_free(&s);
}

/* A scaled, mirrored and turned parent moves and turns the light, no more. */
static void node_scale_leaves_range_and_intensity(void **state)
{
    struct hlh_scene s = load(state, "[{'mesh':0,'children':[1]}",
                              "[{'mesh':0,'children':[1],'scale':[-4,4,4],"
                              "'rotation':[0,0.7071067811865476,0,"
                              "0.7071067811865476]}");
    const struct hlh_light *l = &s.lights[0];
    double det;
    const float *w = s.objects[0].world;
    assert_true(l->radius == 5 && l->color[0] == (float)(10 / PI));
    /* +z turns into +x: at 3 * 4 along x, looking along -x. The quaternion is
     * off by an ulp of 0.7 and enters squared, times 12: 12 * 2^-51. */
    assert_true(fabs(l->position[0] - 12) < 1e-6);
    assert_true(fabs(l->direction[0] + 1) < 1e-6);
    det = (double)w[0] * ((double)w[5] * w[10] - (double)w[6] * w[9]) -
          (double)w[4] * ((double)w[1] * w[10] - (double)w[2] * w[9]) +
          (double)w[8] * ((double)w[1] * w[6] - (double)w[2] * w[5]);
    assert_true(fabs(det + 64) < 1e-4);
    hlh_scene_free(&s);
}

static void the_camera_is_the_nodes(void **state)
{
    struct hlh_scene s = load(state, NULL, NULL);
    assert_false(s.camera_is_default);
    ASSERT_EQUAL_FLOATS(s.camera.eye, 1, 2, 5);
    assert_true(s.camera.target[0] == 1 && s.camera.target[1] == 2);
    assert_true(s.camera.target[2] < 5);
    ASSERT_EQUAL_FLOATS(s.camera.up, 0, 1, 0);
    assert_true(s.camera.vfov == (float)(180 / PI));
    hlh_scene_free(&s);
    s = load(state, "'type':'perspective'", "'type':'orthographic'");
    assert_true(s.camera_is_default);
    hlh_scene_free(&s);
}

/* All eight corners of the bounds lie within the default camera's cone of 25
 * degrees about its axis. */
static void the_default_camera_sees_everything(void **state)
{
    struct hlh_scene s = load(state, "'camera':0,", "");
    double axis[3], length = 0;
    assert_true(s.camera_is_default);
    for (int k = 0; k < 3; k++) {
        axis[k] = (double)s.camera.target[k] - s.camera.eye[k];
        length += axis[k] * axis[k];
    }
    for (int i = 0; i < 8; i++) {
        double along = 0, far = 0;
        for (int k = 0; k < 3; k++) {
            double d = (i >> k & 1 ? s.bounds_max[k] : s.bounds_min[k]) -
                       (double)s.camera.eye[k];
            along += d * axis[k] / sqrt(length);
            far += d * d;
        }
        assert_true(along / sqrt(far) > cos(25 * PI / 180));
    }
    hlh_scene_free(&s);
}

static void default_lights_stand_in_where_there_are_none(void **state)
{
    struct hlh_scene s = load(state, ",'extensions':{'KHR_lights_punctual':"
                              "{'light':0}}", "");
    struct hlh_error e;
    char path[SK_PATH];
    assert_true(s.lights_are_default);
    assert_int_equal(s.n_lights, 9);
    sk_write_text(state, "one.csv", "1,2,3,4,5,6,7\n");
    sk_path(path, state, "one.csv");
    assert_true(hlh_scene_lights_csv(&s, path, false, &e));
    assert_int_equal(s.n_lights, 1);
    assert_false(s.lights_are_default);
    assert_true(hlh_scene_lights_csv(&s, path, false, &e));
    assert_int_equal(s.n_lights, 2);
    assert_true(hlh_scene_lights_csv(&s, path, true, &e));
    assert_int_equal(s.n_lights, 1);
    hlh_scene_free(&s);
}

static void put_floats(uint8_t *at, float x, float y, float z)
{
    const float v[3] = {x, y, z};
    memcpy(at, v, sizeof v);
}

/* Vertices 1 and 2 are shared by both triangles; folding the square along
 * their edge gives the two faces different normals. */
static void broken_normals_become_the_faces(void **state)
{
    static const float broken[3][3] = {{NAN, 0, 1}, {INFINITY, 0, 0},
                                       {0, 0, 0}};
    for (int i = 0; i < 3; i++) {
        uint8_t bin[SK_BIN];
        struct hlh_scene s;
        const struct hlh_mesh *m;
        const float h = (float)sqrt(0.5);
        sk_bin(bin);
        put_floats(bin + 36, 0.5f, 0.5f, -(float)sqrt(0.5)); /* vertex 3 */
        put_floats(bin + SK_AT_NORMAL + 12, broken[i][0], broken[i][1],
                   broken[i][2]);
        s = load_bin(state, NULL, NULL, bin);
        m = &s.meshes[0];
        assert_int_equal(s.normals_repaired, 1);
        assert_int_equal(m->n_vertices, 5);
        /* Face 1 (corners 2, 1, 3) turns by 90 degrees about the fold. */
        ASSERT_EQUAL_FLOATS(m->vertices[m->indices[1]].normal, 0, 0, 1);
        assert_int_equal(m->indices[1], 1);
        assert_int_equal(m->indices[4], 4);
        assert_true(fabsf(m->vertices[4].normal[0] - h) < 1e-6f);
        assert_true(fabsf(m->vertices[4].normal[1] - h) < 1e-6f);
        ASSERT_EQUAL_FLOATS(m->vertices[4].position, 1, 0, 0);
        ASSERT_EQUAL_FLOATS(m->vertices[m->indices[3]].normal, 0, 0, 1);
        hlh_scene_free(&s);
    }
}

static void normals_are_normalised(void **state)
{
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    sk_bin(bin);
    put_floats(bin + SK_AT_NORMAL, 0, 0x3p100f, 0x4p100f);
    s = load_bin(state, NULL, NULL, bin);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[0].normal, 0, 0.6f, 0.8f);
    assert_int_equal(s.normals_repaired, 0);
    hlh_scene_free(&s);
}

static void empty_and_infinite_triangles_are_dropped(void **state)
{
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    sk_bin(bin);
    put_floats(bin + 36, NAN, 1, 0);
    s = load_bin(state, NULL, NULL, bin);
    assert_int_equal(s.n_triangles, 1);
    assert_int_equal(s.triangles_dropped, 1);
    assert_int_equal(s.meshes[0].n_vertices, 3);
    hlh_scene_free(&s);
    put_floats(bin + 36, 0.5f, 0.5f, 0);         /* on the diagonal */
    s = load_bin(state, NULL, NULL, bin);
    assert_int_equal(s.n_triangles, 1);
    assert_int_equal(s.triangles_dropped, 1);
    hlh_scene_free(&s);
    put_floats(bin + 36, 1, 1, 0);
    bin[SK_AT_INDEX + 10] = 1;                   /* 2 1 3 -> 2 1 1 */
    s = load_bin(state, NULL, NULL, bin);
    assert_int_equal(s.triangles_dropped, 1);
    hlh_scene_free(&s);
}

static void missing_normals_are_flat(void **state)
{
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    const struct hlh_mesh *m;
    sk_bin(bin);
    put_floats(bin + 36, 0.5f, 0.5f, -1);
    s = load_bin(state, "'NORMAL':1,", "", bin);
    m = &s.meshes[0];
    assert_int_equal(m->n_vertices, 6);
    assert_int_equal(s.normals_repaired, 0);
    for (uint32_t i = 0; i < 3; i++)
        ASSERT_EQUAL_FLOATS(m->vertices[m->indices[i]].normal, 0, 0, 1);
    for (uint32_t i = 3; i < 6; i++)
        assert_true(m->vertices[m->indices[i]].normal[2] < 0.7f);
    hlh_scene_free(&s);
}

/* A strip's odd triangles and a fan's keep their winding: all of them face
 * the way of the square's normal. */
static void strips_and_fans_become_lists(void **state)
{
    static const uint16_t strip[4] = {0, 1, 2, 3}, fan[4] = {0, 1, 3, 2};
    for (int i = 0; i < 2; i++) {
        const char *const change[4] = {
            "'VEC2','count':4},{'bufferView':3,'componentType':5123,"
            "'type':'SCALAR','count':6",
            "'VEC2','count':4},{'bufferView':3,'componentType':5123,"
            "'type':'SCALAR','count':4",
            "'NORMAL':1,'TEXCOORD_0':2},'indices':3,'material':0,'mode':4",
            i ? "'TEXCOORD_0':2},'indices':3,'material':0,'mode':6"
              : "'TEXCOORD_0':2},'indices':3,'material':0,'mode':5"};
        uint8_t bin[SK_BIN];
        struct hlh_scene s;
        sk_bin(bin);
        memcpy(bin + SK_AT_INDEX, i ? fan : strip, sizeof strip);
        s = load_two(state, change, bin);
        assert_int_equal(s.n_triangles, 2);
        assert_int_equal(s.meshes[0].n_vertices, 4);
        for (uint32_t v = 0; v < 4; v++)
            ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[v].normal, 0, 0, 1);
        hlh_scene_free(&s);
    }
}

static void vertex_colours_and_tangents_are_read(void **state)
{
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    sk_bin(bin);
    for (int i = 0; i < 8; i++)                  /* 4 x VEC2 u8 */
        bin[SK_AT_UV + i] = (uint8_t)(i * 51);
    s = load_bin(state, "{'bufferView':2,'componentType':5126,'type':'VEC2',"
                 "'count':4}", "{'bufferView':2,'componentType':5121,"
                 "'normalized':true,'type':'VEC2','count':4}", bin);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[1].uv, 102 / 255.0f,
                        153 / 255.0f);
    assert_true(s.meshes[0].has_uv && !s.meshes[0].has_color);
    hlh_scene_free(&s);
    sk_bin(bin);
    s = load_bin(state, "'NORMAL':1,", "'NORMAL':1,'COLOR_0':0,", bin);
    assert_true(s.meshes[0].has_color);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[1].color, 1, 0, 0, 1);
    hlh_scene_free(&s);
}

/* KHR_texture_transform's own example: a quarter turn, half size, offset
 * (0, 1) shows the lower left quadrant of the image. */
static void texture_transforms_are_baked(void **state)
{
    struct hlh_scene s = load(
        state, "{'index':0}", "{'index':0,'extensions':{"
        "'KHR_texture_transform':{'offset':[0,1],'scale':[0.5,0.5],"
        "'rotation':1.5707963267948966}}}");
    for (uint32_t i = 0; i < 4; i++) {
        const struct hlh_vertex *v = &s.meshes[0].vertices[i];
        float x = v->position[0], y = 1 - v->position[1]; /* the file's uv */
        /* cos(pi/2) is 6e-17 rather than 0. */
        assert_true(fabsf(v->uv[0] - 0.5f * y) < 1e-7f);
        assert_true(fabsf(v->uv[1] - (1 - 0.5f * x)) < 1e-7f);
    }
    hlh_scene_free(&s);
    s = load(state, "{'index':0}", "{'index':0,'extensions':{"
             "'KHR_texture_transform':{'offset':[0.25,0.5],"
             "'scale':[2,-1]}}}");
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[1].uv, 2.25f, -0.5f);
    hlh_scene_free(&s);
}

static void the_named_texture_set_is_used(void **state)
{
    struct hlh_scene s = load(state, "{'index':0}",
                              "{'index':0,'texCoord':1}");
    assert_false(s.meshes[0].has_uv);
    hlh_scene_free(&s);
}

static void sparse_accessors_replace_elements(void **state)
{
    static const char *const change[4] = {
        "'VEC3','count':4}", "'VEC3','count':4,'sparse':{'count':1,"
        "'indices':{'bufferView':5,'componentType':5123},"
        "'values':{'bufferView':5,'byteOffset':4}}}",
        "'byteLength':75}", ("'byteLength':75},{'buffer':0,"
        "'byteOffset':232,'byteLength':16}")};
    const uint16_t where = 3;
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    sk_bin(bin);
    memcpy(bin + 232, &where, sizeof where);
    put_floats(bin + 236, 2, 3, 0);
    s = load_two(state, change, bin);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[3].position, 2, 3, 0);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[2].position, 0, 1, 0);
    hlh_scene_free(&s);
}

static void external_and_inline_buffers_are_found(void **state)
{
    char json[SK_JSON], path[SK_PATH];
    uint8_t bin[SK_BIN];
    struct hlh_scene s;
    struct hlh_error e;
    sk_bin(bin);
    sk_write(state, "my data.bin", bin, sizeof bin);
    sk_replace(json, sk_good, "[{'byteLength':256}]",
               "[{'byteLength':256,'uri':'my%20data.bin'}]");
    for (char *c = json; *c; c++)
        *c = *c == '\'' ? '"' : *c;
    sk_write_text(state, "apart.gltf", json);
    sk_path(path, state, "apart.gltf");
    if (!hlh_scene_load(&s, path, &e))
        fail_msg("%s", e.text);
    assert_int_equal(s.n_triangles, 2);
    assert_string_equal(s.name, "apart.gltf");
    hlh_scene_free(&s);
    s = load(state, "{'bufferView':4,'mimeType':'image/png'}",
             "{'uri':'data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACC"
             "AIAAAD91JpzAAAAEklEQVR42mP4z8DAAMIM/4EAAB/uBfvxq7p3AAAAAElFTkSu"
             "QmCC'}");
    assert_int_equal(s.images[0].rgba[5], 255);
    hlh_scene_free(&s);
}

static void extensions_that_change_nothing_are_ignored(void **state)
{
    struct hlh_scene s = load(state, "'extensionsUsed':["
                              "'KHR_lights_punctual']", "'extensionsUsed':["
                              "'KHR_materials_clearcoat','X_unheard_of'],"
                              "'extensionsRequired':['KHR_materials_unlit',"
                              "'KHR_lights_punctual',"
                              "'KHR_texture_transform']");
    assert_int_equal(s.n_lights, 1);
    hlh_scene_free(&s);
}

/* ---- OBJ ---- */

static void obj_surfaces_are_grey_and_never_culled(void **state)
{
    struct hlh_scene s = load_obj(
        state, "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
        "vt 0 0\nvt 1 0.25\nvt 1 1\n\nusemtl red\n# a comment\n"
        "f 1/1 2/2 3/3\nf -4 \\\n -2 -1\n");
    assert_int_equal(s.n_triangles, 2);
    for (uint32_t i = 0; i < s.n_meshes; i++) {
        const struct hlh_mesh *mesh = &s.meshes[i];
        const struct hlh_material *m = &s.materials[mesh->material];
        ASSERT_EQUAL_FLOATS(m->base_color, 0.8f, 0.8f, 0.8f, 1);
        assert_true(m->metallic == 0 && m->roughness == 0.5f);
        assert_true(m->double_sided && m->base_texture.image < 0);
        for (uint32_t v = 0; v < mesh->n_vertices; v++)
            ASSERT_EQUAL_FLOATS(mesh->vertices[v].normal, 0, 0, 1);
    }
    /* v counts upwards in the file. */
    for (uint32_t v = 0; v < s.meshes[0].n_vertices; v++)
        if (s.meshes[0].vertices[v].position[0] == 1 &&
            s.meshes[0].vertices[v].position[1] == 0)
            ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[v].uv, 1, 0.75f);
    hlh_scene_free(&s);
}

/* A concave pentagon (a house upside down: an arrow) has area 3/4 of its
 * square however it is cut. */
static void obj_polygons_are_triangulated(void **state)
{
    struct hlh_scene s = load_obj(
        state, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0.5 0.5 0\nv 0 1 0\n"
        "f 1 2 3 4 5\n");
    double area = 0;
    const struct hlh_mesh *m = &s.meshes[0];
    assert_int_equal(s.n_triangles, 3);
    for (uint32_t i = 0; i < m->n_indices; i += 3) {
        const float *a = m->vertices[m->indices[i]].position;
        const float *b = m->vertices[m->indices[i + 1]].position;
        const float *c = m->vertices[m->indices[i + 2]].position;
        area += ((b[0] - a[0]) * (c[1] - a[1]) -
                 (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    assert_true(area == 0.75);
    hlh_scene_free(&s);
}

static void obj_keeps_normals_and_drops_what_is_not_finite(void **state)
{
    struct hlh_scene s = load_obj(
        state, "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nvn 0 3 4\n"
        "vn inf 0 0\nf 1//1 2//2 3//1\nf 1//1 2//1 4//1\n");
    assert_int_equal(s.n_triangles, 1);
    assert_int_equal(s.triangles_dropped, 1);
    assert_int_equal(s.normals_repaired, 1);
    ASSERT_EQUAL_FLOATS(s.meshes[0].vertices[0].normal, 0, 0.6f, 0.8f);
    hlh_scene_free(&s);
}

/* ---- CSV ---- */

static void csv_lights_are_read(void **state)
{
    struct hlh_scene s = load(state, NULL, NULL);
    struct hlh_error e;
    char path[SK_PATH];
    sk_write_text(state, "l.csv", "# x,y,z,radius,r,g,b\n\n"
                  "1,-2,3e0, 4 ,0.5,.25,1\r\n  # more\n0,0,0,0,0,0,0");
    sk_path(path, state, "l.csv");
    if (!hlh_scene_lights_csv(&s, path, false, &e))
        fail_msg("%s", e.text);
    assert_int_equal(s.n_lights, 3);
    ASSERT_EQUAL_FLOATS(s.lights[1].position, 1, -2, 3);
    ASSERT_EQUAL_FLOATS(s.lights[1].color, 0.5f, 0.25f, 1);
    assert_true(s.lights[1].radius == 4 && s.lights[2].radius == 0);
    assert_int_equal(s.lights[1].kind, HLH_LIGHT_POINT);
    assert_int_equal(s.lights[1].falloff, HLH_FALLOFF_SMOOTH);
    hlh_scene_free(&s);
}

static void bad_csv_leaves_the_scene_alone(void **state)
{
    static const char *const table[][2] = {
        {"x,y,z,radius,r,g,b\n1,2,3,4,5,6,7\n", "line 1: field 1 (x)"},
        {"1,2,3,4,5,6,7\n1,2,3,4,5,6\n", "line 2: has 6 of 7 numbers"},
        {"1,2,3,4,5,6,7,8\n", "line 1: goes on after seven numbers"},
        {"1,2,3,-4,5,6,7\n", "line 1: radius is negative: -4"},
        {"1,2,3,4,5,-6,7\n", "line 1: g is negative: -6"},
        {"1,2,3,nan,5,6,7\n", "line 1: radius is not finite"},
        {"inf,2,3,4,5,6,7\n", "line 1: x is not finite"},
        {"1e999,2,3,4,5,6,7\n", "line 1: x is not finite"},
        {"1,1e38,3,4,5,6,7\n", "line 1: y is beyond 1e+12"},
        {"1;2;3;4;5;6;7\n", "line 1: has 1 of 7"},
        {"1,,3,4,5,6,7\n", "line 1: field 2 (y)"},
        {"0x10,2,3,4,5,6,7\n", "line 1: "},
        {"1,2,3,4,5,6,\n", "line 1: field 7 (b)"},
    };
    struct hlh_scene s = load(state, NULL, NULL);
    struct hlh_light before = s.lights[0];
    struct hlh_error e;
    char path[SK_PATH];
    sk_path(path, state, "bad.csv");
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        sk_write_text(state, "bad.csv", table[i][0]);
        for (int replace = 0; replace < 2; replace++) {
            assert_false(hlh_scene_lights_csv(&s, path, replace, &e));
            sk_assert_contains(e.text, "bad.csv: ");
            sk_assert_contains(e.text, table[i][1]);
            assert_int_equal(s.n_lights, 1);
            assert_memory_equal(&s.lights[0], &before, sizeof before);
        }
    }
    sk_path(path, state, "gone.csv");
    assert_false(hlh_scene_lights_csv(&s, path, true, &e));
    sk_assert_contains(e.text, "cannot be opened");
    hlh_scene_free(&s);
}

/* ---- extras ---- */

static void our_extras_are_read(void **state)
{
    struct hlh_scene s = load(state, "'name':'paint',", "'name':'paint',"
        "'alphaMode':'MASK','extras':{'other':1,'halflight':{'fence':true,"
        "'decal':true,'brdf':1,'unknown':[]}},");
    assert_true(s.materials[0].fence && s.materials[0].decal);
    assert_int_equal(s.materials[0].brdf, HLH_BRDF_SKIN);
    assert_false(s.lights[0].shadow || s.objects[0].no_shadow);
    hlh_scene_free(&s);
    s = load(state, "'intensity':10,", "'intensity':10,'extras':{'halflight':"
             "{'shadow':true,'falloff':'smooth'}},");
    assert_true(s.lights[0].shadow);
    assert_int_equal(s.lights[0].falloff, HLH_FALLOFF_SMOOTH);
    hlh_scene_free(&s);
    s = load(state, "{'mesh':0,", "{'mesh':0,'extras':{'halflight':"
             "{'no_shadow':true}},");
    assert_true(s.objects[0].no_shadow);
    hlh_scene_free(&s);
}

/* Anything may stand in extras: a load neither fails nor takes it for ours. A
 * fence is a fence only of what is masked. */
static void extras_of_others_are_left_alone(void **state)
{
    static const char *const odd[] = {
        "7", "'x'", "null", "[]", "[{'halflight':{'decal':true}}]",
        "{'halflight':true}", "{'halflight':[{'decal':true}]}",
        "{'halflight':{'decal':1,'brdf':'1','fence':'true'}}",
        "{'halflight':{'decal':{},'brdf':7,'fence':true}}",
        "{'halflight':{'decal':null,'brdf':true,'fence':[true]}}",
        "{'Halflight':{'decal':true,'brdf':1}}",
    };
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        char by[160];
        snprintf(by, sizeof by, "'name':'paint','extras':%s,", odd[i]);
        struct hlh_scene s = load(state, "'name':'paint',", by);
        assert_false(s.materials[0].fence || s.materials[0].decal);
        assert_int_equal(s.materials[0].brdf, HLH_BRDF_BLINN_PHONG);
        hlh_scene_free(&s);
        snprintf(by, sizeof by, "'intensity':10,'extras':%s,", odd[i]);
        s = load(state, "'intensity':10,", by);
        assert_false(s.lights[0].shadow);
        hlh_scene_free(&s);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_are_the_files),
        cmocka_unit_test(an_absent_material_is_white_metal),
        cmocka_unit_test(lights_are_pi_less_than_the_files),
        cmocka_unit_test(a_range_that_is_absent_is_derived),
        cmocka_unit_test(node_scale_leaves_range_and_intensity),
        cmocka_unit_test(the_camera_is_the_nodes),
        cmocka_unit_test(the_default_camera_sees_everything),
        cmocka_unit_test(default_lights_stand_in_where_there_are_none),
        cmocka_unit_test(broken_normals_become_the_faces),
        cmocka_unit_test(normals_are_normalised),
        cmocka_unit_test(empty_and_infinite_triangles_are_dropped),
        cmocka_unit_test(missing_normals_are_flat),
        cmocka_unit_test(strips_and_fans_become_lists),
        cmocka_unit_test(vertex_colours_and_tangents_are_read),
        cmocka_unit_test(texture_transforms_are_baked),
        cmocka_unit_test(the_named_texture_set_is_used),
        cmocka_unit_test(sparse_accessors_replace_elements),
        cmocka_unit_test(external_and_inline_buffers_are_found),
        cmocka_unit_test(extensions_that_change_nothing_are_ignored),
        cmocka_unit_test(our_extras_are_read),
        cmocka_unit_test(extras_of_others_are_left_alone),
        cmocka_unit_test(obj_surfaces_are_grey_and_never_culled),
        cmocka_unit_test(obj_polygons_are_triangulated),
        cmocka_unit_test(obj_keeps_normals_and_drops_what_is_not_finite),
        cmocka_unit_test(csv_lights_are_read),
        cmocka_unit_test(bad_csv_leaves_the_scene_alone),
    };
    return cmocka_run_group_tests_name("scene files", tests, sk_setup,
                                       sk_teardown);
}
