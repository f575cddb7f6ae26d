/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/reference_kit.h"

void kit_make(struct kit *k)
{
    memset(k, 0, sizeof *k);
    k->scene.images = k->images;
    k->scene.materials = k->materials;
    k->scene.meshes = k->meshes;
    k->scene.objects = k->objects;
    k->scene.lights = k->lights;
    k->scene.camera = (struct hlh_camera){ { 0, 0, 5 }, { 0, 0, 0 },
                                           { 0, 1, 0 }, 90, 0 };
    k->options.width = k->options.height = KIT_SIZE;
    k->options.threads = 1;
    k->options.normal_maps = true;
}

void kit_free(struct kit *k)
{
    for (uint32_t i = 0; i < k->scene.n_meshes; i++) {
        free(k->meshes[i].vertices);
        free(k->meshes[i].indices);
    }
    for (uint32_t i = 0; i < k->scene.n_images; i++)
        free(k->images[i].rgba);
}

struct hlh_material *kit_material(struct kit *k)
{
    struct hlh_material *m = &k->materials[k->scene.n_materials++];
    m->base_color[3] = 1;
    m->roughness = 1;
    m->normal_scale = 1;
    m->alpha_cutoff = 0.5f;
    m->base_texture.image = m->metal_rough_texture.image = -1;
    m->normal_texture.image = m->emission_texture.image = -1;
    return m;
}

struct hlh_mesh *kit_mesh(struct kit *k, uint32_t n_vertices,
                          uint32_t n_indices)
{
    uint32_t at = k->scene.n_meshes++;
    struct hlh_mesh *m = &k->meshes[at];
    struct hlh_object *o = &k->objects[k->scene.n_objects++];
    m->vertices = calloc(n_vertices, sizeof *m->vertices);
    m->indices = calloc(n_indices, sizeof *m->indices);
    assert_true(m->vertices && m->indices && at < KIT_MESHES);
    m->n_vertices = n_vertices;
    m->n_indices = n_indices;
    m->material = k->scene.n_materials - 1;
    for (uint32_t i = 0; i < n_vertices; i++) {
        m->vertices[i].normal[2] = 1;
        for (int c = 0; c < 4; c++)
            m->vertices[i].color[c] = 1;
    }
    o->mesh = at;
    for (int i = 0; i < 4; i++)
        o->world[5 * i] = 1;
    return m;
}

struct hlh_mesh *kit_quad(struct kit *k, float half, float z)
{
    static const uint32_t indices[6] = { 0, 1, 2, 2, 1, 3 };
    struct hlh_mesh *m = kit_mesh(k, 4, 6);
    memcpy(m->indices, indices, sizeof indices);
    for (uint32_t i = 0; i < 4; i++) {
        struct hlh_vertex *v = &m->vertices[i];
        v->uv[0] = i >= 2 ? 1.0f : 0.0f;
        v->uv[1] = i % 2 ? 1.0f : 0.0f;
        v->position[0] = i >= 2 ? half : -half;
        v->position[1] = i % 2 ? -half : half;
        v->position[2] = z;
    }
    m->has_uv = true;
    return m;
}

struct hlh_light *kit_light(struct kit *k, enum hlh_light_kind kind)
{
    struct hlh_light *l = &k->lights[k->scene.n_lights++];
    assert_true(k->scene.n_lights <= KIT_LIGHTS);
    l->kind = kind;
    l->direction[2] = -1;
    l->color[0] = l->color[1] = l->color[2] = 1;
    l->radius = 1;
    return l;
}

int32_t kit_image(struct kit *k, uint32_t width, uint32_t height,
                  const uint8_t *rgba)
{
    struct hlh_image *i = &k->images[k->scene.n_images];
    size_t bytes = 4 * (size_t)width * height;
    *i = (struct hlh_image){ NULL, width, height, malloc(bytes) };
    assert_non_null(i->rgba);
    memcpy(i->rgba, rgba, bytes);
    return (int32_t)k->scene.n_images++;
}

struct hlr_probe kit_probe(const struct kit *k, double x, double y)
{
    const char *why = "";
    struct hlr_probe out;
    struct hlr_prepared *p = hlr_prepare(&k->scene, &why);
    if (!p)
        fail_msg("prepare: %s", why);
    double half = KIT_SIZE / 2.0;
    assert_true(hlr_probe(&out, p, &k->options, half * (1 + x / 5),
                          half * (1 - y / 5)));
    hlr_prepared_free(p);
    return out;
}

float *kit_draw(const struct kit *k, uint32_t **ids)
{
    size_t n = (size_t)k->options.width * k->options.height;
    float *rgb = malloc(3 * n * sizeof *rgb);
    if (ids)
        *ids = malloc(n * sizeof **ids);
    assert_true(rgb && (!ids || *ids));
    assert_true(hlr_render(rgb, ids ? *ids : NULL, &k->scene, &k->options,
                           NULL));
    return rgb;
}

void check_near(double a, double b, double tolerance, const char *what)
{
    if (!(fabs(a - b) <= tolerance))
        fail_msg("%s: %.17g is not %.17g within %g", what, a, b, tolerance);
}

void check_near3(const double a[3], double x, double y, double z,
                 double tolerance, const char *what)
{
    check_near(a[0], x, tolerance, what);
    check_near(a[1], y, tolerance, what);
    check_near(a[2], z, tolerance, what);
}

double kit_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state / 4294967296.0;
}
