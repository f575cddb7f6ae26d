/* SPDX-License-Identifier: Zlib */
#include "tests/scene_kit.h"
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

int sk_setup(void **state)
{
    const char *base = getenv("TMPDIR");
    char *name = malloc(SK_PATH);
    if (!name)
        return -1;
    snprintf(name, SK_PATH, "%s/halflight-XXXXXX", base ? base : "/tmp");
    *state = name;
    return mkdtemp(name) ? 0 : -1;
}

static int empty_directory(void **state, bool remove_too)
{
    DIR *dir = opendir(*state);
    struct dirent *entry;
    int n = 0;
    while (dir && (entry = readdir(dir))) {
        char path[SK_PATH];
        if (entry->d_name[0] == '.')
            continue;
        n++;
        sk_path(path, state, entry->d_name);
        if (remove_too && unlink(path) != 0)
            rmdir(path);
    }
    if (dir)
        closedir(dir);
    return n;
}

int sk_teardown(void **state)
{
    empty_directory(state, true);
    rmdir(*state);
    free(*state);
    return 0;
}

int sk_count(void **state)
{
    return empty_directory(state, false);
}

void sk_path(char *out, void **state, const char *name)
{
    int n = snprintf(out, SK_PATH, "%s/%s", (const char *)*state, name);
    assert_in_range(n, 1, SK_PATH - 1);
}

void sk_write(void **state, const char *name, const void *bytes, size_t size)
{
    char path[SK_PATH];
    FILE *file;
    sk_path(path, state, name);
    file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

void sk_write_text(void **state, const char *name, const char *text)
{
    sk_write(state, name, text, strlen(text));
}

bool sk_exists(void **state, const char *name)
{
    struct stat info;
    char path[SK_PATH];
    sk_path(path, state, name);
    return stat(path, &info) == 0;
}

const char sk_good[] =
    "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0,2]}],"
    "'nodes':[{'mesh':0,'children':[1]},"
    "{'translation':[0,0,3],'extensions':{'KHR_lights_punctual':{'light':0}}},"
    "{'camera':0,'translation':[1,2,5]}],"
    "'cameras':[{'type':'perspective','perspective':{'yfov':1,'znear':0.1}}],"
    "'extensionsUsed':['KHR_lights_punctual'],"
    "'extensions':{'KHR_lights_punctual':{'lights':[{'type':'spot',"
    "'intensity':10,'color':[1,0.5,0.25],'range':5,"
    "'spot':{'innerConeAngle':0.1,'outerConeAngle':0.5}}]}},"
    "'materials':[{'name':'paint','pbrMetallicRoughness':{"
    "'baseColorFactor':[0.5,0.25,1,1],'metallicFactor':0.25,"
    "'roughnessFactor':0.5,'baseColorTexture':{'index':0}},"
    "'emissiveFactor':[0,0,0.5]}],"
    "'meshes':[{'name':'square','primitives':[{'attributes':{'POSITION':0,"
    "'NORMAL':1,'TEXCOORD_0':2},'indices':3,'material':0,'mode':4}]}],"
    "'accessors':["
    "{'bufferView':0,'componentType':5126,'type':'VEC3','count':4},"
    "{'bufferView':1,'componentType':5126,'type':'VEC3','count':4},"
    "{'bufferView':2,'componentType':5126,'type':'VEC2','count':4},"
    "{'bufferView':3,'componentType':5123,'type':'SCALAR','count':6}],"
    "'bufferViews':[{'buffer':0,'byteLength':48},"
    "{'buffer':0,'byteOffset':48,'byteLength':48},"
    "{'buffer':0,'byteOffset':96,'byteLength':32},"
    "{'buffer':0,'byteOffset':128,'byteLength':12},"
    "{'buffer':0,'byteOffset':140,'byteLength':75}],"
    "'buffers':[{'byteLength':256}],"
    "'samplers':[{'wrapS':33071,'wrapT':33648}],"
    "'textures':[{'source':0,'sampler':0}],"
    "'images':[{'bufferView':4,'mimeType':'image/png'}]}";

/* 2 x 2: red, green; blue, white. */
static const uint8_t png[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
    0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02,
    0x08, 0x02, 0x00, 0x00, 0x00, 0xfd, 0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00,
    0x12, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xc0,
    0x00, 0xc2, 0x0c, 0xff, 0x81, 0x00, 0x00, 0x1f, 0xee, 0x05, 0xfb, 0xf1,
    0xab, 0xba, 0x77, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae,
    0x42, 0x60, 0x82,
};

void sk_bin(uint8_t bin[SK_BIN])
{
    static const uint16_t index[6] = {0, 1, 2, 2, 1, 3};
    memset(bin, 0, SK_BIN);
    for (uint32_t i = 0; i < 4; i++) {
        float p[3] = {(float)(i & 1), (float)(i >> 1), 0};
        float n[3] = {0, 0, 1}, uv[2] = {p[0], 1 - p[1]};
        memcpy(bin + i * 12, p, sizeof p);
        memcpy(bin + SK_AT_NORMAL + i * 12, n, sizeof n);
        memcpy(bin + SK_AT_UV + i * 8, uv, sizeof uv);
    }
    memcpy(bin + SK_AT_INDEX, index, sizeof index);
    memcpy(bin + SK_AT_PNG, png, sizeof png);
}

void sk_replace(char *out, const char *text, const char *find,
                const char *by)
{
    const char *at = find ? strstr(text, find) : text + strlen(text);
    int n;
    if (!at)
        fail_msg("the document does not hold %s", find);
    n = snprintf(out, SK_JSON, "%.*s%s%s", (int)(at - text), text,
                 find ? by : "", find ? at + strlen(find) : "");
    assert_in_range(n, 1, SK_JSON - 1);
}

static void add32(uint8_t *at, size_t value)
{
    for (int k = 0; k < 4; k++)
        at[k] = (uint8_t)(value >> (8 * k));
}

void sk_write_glb(void **state, const char *name, const char *json,
                  const uint8_t *bin, size_t bin_size)
{
    size_t length = strlen(json), padded = (length + 3) / 4 * 4;
    size_t size = 20 + padded + (bin ? 8 + bin_size : 0);
    uint8_t *glb = calloc(1, size);
    assert_non_null(glb);
    memcpy(glb, "glTF", 4);
    add32(glb + 4, 2);
    add32(glb + 8, size);
    add32(glb + 12, padded);
    memcpy(glb + 16, "JSON", 4);
    memset(glb + 20, ' ', padded);
    for (size_t i = 0; i < length; i++)
        glb[20 + i] = (uint8_t)(json[i] == '\'' ? '"' : json[i]);
    if (bin) {
        add32(glb + 20 + padded, bin_size);
        memcpy(glb + 24 + padded, "BIN", 4);
        memcpy(glb + 28 + padded, bin, bin_size);
    }
    sk_write(state, name, glb, size);
    free(glb);
}

bool sk_load(void **state, struct hlh_scene *out, const char *find,
             const char *by, char *text)
{
    uint8_t bin[SK_BIN];
    char json[SK_JSON], path[SK_PATH];
    struct hlh_error error;
    bool ok;
    sk_bin(bin);
    sk_replace(json, sk_good, find, by);
    sk_write_glb(state, "kit.glb", json, bin, sizeof bin);
    sk_path(path, state, "kit.glb");
    error.text[0] = 0;
    ok = hlh_scene_load(out, path, &error);
    strcpy(text, error.text);
    return ok;
}

static double length(const float v[3])
{
    return sqrt((double)v[0] * v[0] + (double)v[1] * v[1] +
                (double)v[2] * v[2]);
}

/* Each component of a unit vector is off by half an ulp of 1, 6e-8, at most:
 * the length by less than sqrt(3) times that; 4.4e-7 is what the loader
 * leaves alone. */
static void assert_unit(const float v[3])
{
    double l = length(v);
    if (!(fabs(l - 1) < 4.5e-7))
        fail_msg("(%g %g %g) has length %.9g", v[0], v[1], v[2], l);
}

static void assert_mesh(const struct hlh_scene *s, const struct hlh_mesh *m)
{
    assert_true(m->material < s->n_materials);
    assert_true(m->n_indices >= 3 && m->n_indices % 3 == 0);
    assert_non_null(m->name);
    for (uint32_t i = 0; i < m->n_indices; i++)
        assert_true(m->indices[i] < m->n_vertices);
    for (uint32_t i = 0; i < m->n_vertices; i++) {
        const struct hlh_vertex *v = &m->vertices[i];
        assert_unit(v->normal);
        assert_true(isfinite(length(v->position)));
        assert_true(isfinite(v->uv[0] + v->uv[1]));
        for (int k = 0; k < 4; k++)
            assert_true(v->color[k] >= 0 && v->color[k] <= 1);
        if (v->tangent[3] != 0) {
            assert_unit(v->tangent);
            assert_true(fabsf(v->tangent[3]) == 1);
        }
    }
}

static void assert_lights(const struct hlh_scene *s)
{
    for (uint32_t i = 0; i < s->n_lights; i++) {
        const struct hlh_light *l = &s->lights[i];
        assert_true(isfinite(length(l->position)));
        assert_unit(l->direction);
        assert_true(l->radius >= 0 && isfinite(l->radius));
        for (int k = 0; k < 3; k++)
            assert_true(l->color[k] >= 0 && isfinite(l->color[k]));
    }
}

void sk_assert_promises(const struct hlh_scene *s)
{
    uint64_t n = 0;
    assert_non_null(s->name);
    for (uint32_t i = 0; i < s->n_meshes; i++)
        assert_mesh(s, &s->meshes[i]);
    for (uint32_t i = 0; i < s->n_objects; i++) {
        assert_true(s->objects[i].mesh < s->n_meshes);
        n += s->meshes[s->objects[i].mesh].n_indices / 3;
    }
    assert_true(n == s->n_triangles && n > 0);
    for (int k = 0; k < 3; k++)
        assert_true(s->bounds_min[k] <= s->bounds_max[k]);
    assert_true(s->camera.vfov > 0 && s->camera.vfov < 180);
    assert_lights(s);
}

void sk_assert_contains(const char *text, const char *part)
{
    if (!strstr(text, part))
        fail_msg("\"%s\" does not hold \"%s\"", text, part);
}
