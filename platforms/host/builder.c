/* SPDX-License-Identifier: Zlib */
#include "platforms/host/builder.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

static uint32_t next(struct hlh_builder *b)
{
    uint32_t x, turn;                            /* PCG-XSH-RR 64/32 */
    b->random = b->random * 6364136223846793005u + 1442695040888963407u;
    x = (uint32_t)(((b->random >> 18) ^ b->random) >> 27);
    turn = (uint32_t)(b->random >> 59);
    return x >> turn | x << (-turn & 31);
}

void hlh_build_begin(struct hlh_builder *b, struct hlh_scene *scene,
                     uint32_t seed)
{
    memset(b, 0, sizeof *b);
    b->scene = scene;
    b->random = (uint64_t)seed << 32 | 0x9e3779b9u;
    next(b);
}

double hlh_random(struct hlh_builder *b, double low, double high)
{
    return low + (high - low) * (next(b) * (1.0 / 4294967296.0));
}

uint32_t hlh_random_below(struct hlh_builder *b, uint32_t n)
{
    return (uint32_t)((uint64_t)next(b) * n >> 32);
}

/* Taylor series on +-1/8 turn (x <= pi/4): the first term left out is
 * x^19/19! < 1e-19 for the sine, x^18/18! < 3e-18 for the cosine. */
void hlh_sincos(double turns, double *sine, double *cosine)
{
    double whole = floor(turns * 4 + 0.5);
    double x = (turns - whole / 4) * 6.283185307179586476925;
    double x2 = x * x, s = 1, c = 1;
    int quarter = (int)(whole - 4 * floor(whole / 4));
    for (int k = 17; k > 1; k -= 2)
        s = 1 - s * x2 / (k * (k - 1));
    for (int k = 16; k > 0; k -= 2)
        c = 1 - c * x2 / (k * (k - 1));
    s *= x;
    *sine = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
    *cosine = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
}

static double hue_channel(double hue)
{
    double t = fabs((hue - floor(hue)) * 6 - 3) - 1;
    return t < 0 ? 0 : t > 1 ? 1 : t;
}

struct hlh_v3 hlh_hue(double hue, double saturation, double v)
{
    double low = 1 - saturation;
    return hlh_v3(v * (low + saturation * hue_channel(hue)),
                  v * (low + saturation * hue_channel(hue - 1.0 / 3)),
                  v * (low + saturation * hue_channel(hue - 2.0 / 3)));
}

static void store(float out[3], struct hlh_v3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

uint32_t hlh_build_material(struct hlh_builder *b, const char *name,
                            struct hlh_v3 color, double roughness,
                            double metallic)
{
    struct hlh_scene *s = b->scene;
    struct hlh_material *m =
        hlh_push(&s->materials, &s->n_materials, sizeof *m);
    if (!m) {
        b->failed = true;
        return 0;
    }
    hlh_material_default(m);
    m->name = hlh_strdup(name);
    store(m->base_color, color);
    m->roughness = (float)roughness;
    m->metallic = (float)metallic;
    return s->n_materials - 1;
}

struct hlh_material *hlh_build_last_material(struct hlh_builder *b)
{
    struct hlh_scene *s = b->scene;
    return b->failed || !s->n_materials ? &b->no_material
                                        : &s->materials[s->n_materials - 1];
}

int32_t hlh_build_image(struct hlh_builder *b, const char *name,
                        uint32_t side,
                        void (*texel)(uint8_t *, uint32_t, uint32_t))
{
    struct hlh_scene *s = b->scene;
    struct hlh_image *i = hlh_push(&s->images, &s->n_images, sizeof *i);
    if (!i) {
        b->failed = true;
        return -1;
    }
    i->name = hlh_strdup(name);
    i->rgba = hlh_alloc((size_t)side * side, 4);
    if (!i->name || !i->rgba) {
        b->failed = true;
        return -1;
    }
    i->width = i->height = side;
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++)
            texel(&i->rgba[((size_t)y * side + x) * 4], x, y);
    return (int32_t)s->n_images - 1;
}

uint32_t hlh_build_mesh(struct hlh_builder *b, const char *name,
                        uint32_t material)
{
    struct hlh_scene *s = b->scene;
    struct hlh_mesh *mesh = hlh_push(&s->meshes, &s->n_meshes, sizeof *mesh);
    if (!mesh) {
        b->failed = true;
        return 0;
    }
    mesh->name = hlh_strdup(name);
    mesh->vertices = b->vertices;
    mesh->n_vertices = b->n_vertices;
    mesh->indices = b->indices;
    mesh->n_indices = b->n_indices;
    mesh->material = material;
    mesh->has_uv = true;
    b->vertices = NULL;
    b->indices = NULL;
    b->n_vertices = b->n_indices = 0;
    if (!b->failed && !hlh_mesh_clean(mesh, true, s))
        b->failed = true;
    /* Poles and tips are made of cells with an empty half: not news. */
    s->triangles_dropped = 0;
    return s->n_meshes - 1;
}

void hlh_build_object(struct hlh_builder *b, uint32_t mesh, struct hlh_v3 at,
                      struct hlh_v3 scale, double yaw)
{
    struct hlh_scene *s = b->scene;
    struct hlh_object *o = hlh_push(&s->objects, &s->n_objects, sizeof *o);
    double sine, cosine;
    if (!o) {
        b->failed = true;
        return;
    }
    hlh_sincos(yaw, &sine, &cosine);
    o->mesh = mesh;
    o->world[0] = (float)(cosine * scale.x);
    o->world[2] = (float)(-sine * scale.x);
    o->world[5] = (float)scale.y;
    o->world[8] = (float)(sine * scale.z);
    o->world[10] = (float)(cosine * scale.z);
    store(&o->world[12], at);
    o->world[15] = 1;
}

void hlh_build_object_at_origin(struct hlh_builder *b, uint32_t mesh)
{
    hlh_build_object(b, mesh, hlh_v3(0, 0, 0), hlh_v3(1, 1, 1), 0);
}

void hlh_build_light(struct hlh_builder *b, struct hlh_v3 at, double radius,
                     struct hlh_v3 color)
{
    struct hlh_scene *s = b->scene;
    struct hlh_light *l = hlh_push(&s->lights, &s->n_lights, sizeof *l);
    if (!l) {
        b->failed = true;
        return;
    }
    l->kind = HLH_LIGHT_POINT;
    l->falloff = HLH_FALLOFF_SMOOTH;
    l->direction[1] = -1;
    l->radius = (float)radius;
    store(l->position, at);
    store(l->color, color);
}

static void aim(struct hlh_light *l, struct hlh_v3 d)
{
    double n = sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    store(l->direction, hlh_v3(d.x / n, d.y / n, d.z / n));
}

void hlh_build_spot(struct hlh_builder *b, struct hlh_v3 at,
                    struct hlh_v3 target, double radius, double inner,
                    double outer, struct hlh_v3 color)
{
    hlh_build_light(b, at, radius, color);
    if (b->failed)
        return;
    struct hlh_light *l = &b->scene->lights[b->scene->n_lights - 1];
    l->kind = HLH_LIGHT_SPOT;
    l->inner_angle = (float)inner;
    l->outer_angle = (float)outer;
    aim(l, hlh_mad(target, at, -1));
}

void hlh_build_directional(struct hlh_builder *b, struct hlh_v3 direction,
                           struct hlh_v3 color)
{
    hlh_build_light(b, hlh_v3(0, 0, 0), 0, color);
    if (b->failed)
        return;
    struct hlh_light *l = &b->scene->lights[b->scene->n_lights - 1];
    l->kind = HLH_LIGHT_DIRECTIONAL;
    aim(l, direction);
}

void hlh_build_shadow(struct hlh_builder *b)
{
    if (!b->failed && b->scene->n_lights)
        b->scene->lights[b->scene->n_lights - 1].shadow = true;
}

void hlh_build_random_light(struct hlh_builder *b, struct hlh_v3 at,
                            const struct hlh_light_range *r)
{
    double radius, hue, saturation, brightness;
    at.x += hlh_random(b, -r->spread.x, r->spread.x);
    at.y += hlh_random(b, -r->spread.y, r->spread.y);
    at.z += hlh_random(b, -r->spread.z, r->spread.z);
    radius = hlh_random(b, r->radius[0], r->radius[1]);
    hue = hlh_random(b, 0, 1);
    saturation = hlh_random(b, r->saturation[0], r->saturation[1]);
    brightness = hlh_random(b, r->brightness[0], r->brightness[1]);
    hlh_build_light(b, at, radius, hlh_hue(hue, saturation, brightness));
}

void hlh_build_camera(struct hlh_builder *b, struct hlh_v3 eye,
                      struct hlh_v3 target, double vfov)
{
    struct hlh_camera *c = &b->scene->camera;
    memset(c, 0, sizeof *c);
    store(c->eye, eye);
    store(c->target, target);
    c->up[1] = 1;
    c->vfov = (float)vfov;
}
