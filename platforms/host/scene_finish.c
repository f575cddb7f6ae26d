/* SPDX-License-Identifier: Zlib */
/* What a scene gets once all of its parts are there: bounds, counts, and the
 * camera and lights of a file that has none. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

#define POSITION_LIMIT 1e12
#define TRIANGLE_LIMIT ((uint64_t)1 << 31)
/* Above this many drawn vertices the corners of each mesh's box stand for
 * the mesh: the bounds stay an enclosure, only no longer the tightest. */
#define EXACT_BOUNDS_LIMIT ((uint64_t)1 << 26)

struct box {
    double min[3], max[3];
};

static const struct box empty_box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                     {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};

static void box_add(struct box *b, const float m[16], const float p[3])
{
    for (int i = 0; i < 3; i++) {
        double v = (double)m[i] * p[0] + (double)m[4 + i] * p[1] +
                   (double)m[8 + i] * p[2] + m[12 + i];
        if (v < b->min[i])
            b->min[i] = v;
        if (v > b->max[i])
            b->max[i] = v;
    }
}

static void box_add_mesh(struct box *b, const float m[16],
                         const struct hlh_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        box_add(b, m, mesh->vertices[i].position);
}

static void box_add_corners(struct box *b, const float m[16],
                            const struct box *local)
{
    for (int i = 0; i < 8; i++) {
        float p[3];
        for (int k = 0; k < 3; k++)
            p[k] = (float)(i >> k & 1 ? local->max[k] : local->min[k]);
        box_add(b, m, p);
    }
}

/* Rank 2 at least: some triangle of the object may keep an area. All 2 x 2
 * minors zero means that everything falls onto a line or a point. */
static bool has_area(const float m[16])
{
    for (int i = 0; i < 3; i++)
        for (int j = i + 1; j < 3; j++)
            for (int a = 0; a < 3; a++)
                for (int b = a + 1; b < 3; b++)
                    if ((double)m[4 * i + a] * m[4 * j + b] !=
                        (double)m[4 * i + b] * m[4 * j + a])
                        return true;
    return false;
}

static void drop_flattened(struct hlh_scene *s)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->n_objects; i++) {
        const struct hlh_mesh *mesh = &s->meshes[s->objects[i].mesh];
        if (has_area(s->objects[i].world))
            s->objects[kept++] = s->objects[i];
        else
            s->triangles_dropped += mesh->n_indices / 3;
    }
    s->n_objects = kept;
}

static bool find_bounds(struct hlh_scene *s, struct box *b)
{
    struct box *local = NULL;
    uint64_t n_vertices = 0;
    static const float unit[16] = {1, 0, 0, 0, 0, 1, 0, 0,
                                   0, 0, 1, 0, 0, 0, 0, 1};
    for (uint32_t i = 0; i < s->n_objects; i++)
        n_vertices += s->meshes[s->objects[i].mesh].n_vertices;
    if (n_vertices > EXACT_BOUNDS_LIMIT) {
        local = hlh_alloc(s->n_meshes, sizeof *local);
        if (!local)
            return false;
        for (uint32_t i = 0; i < s->n_meshes; i++) {
            local[i] = empty_box;
            box_add_mesh(&local[i], unit, &s->meshes[i]);
        }
    }
    *b = empty_box;
    for (uint32_t i = 0; i < s->n_objects; i++) {
        const struct hlh_object *o = &s->objects[i];
        if (local)
            box_add_corners(b, o->world, &local[o->mesh]);
        else
            box_add_mesh(b, o->world, &s->meshes[o->mesh]);
    }
    free(local);
    return true;
}

/* Written so that a NaN fails too. */
static bool within_limit(const struct box *b)
{
    for (int i = 0; i < 3; i++)
        if (!(b->min[i] >= -POSITION_LIMIT && b->max[i] <= POSITION_LIMIT))
            return false;
    return true;
}

static double half_diagonal(const struct hlh_scene *s, double center[3])
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double half = 0.5 * ((double)s->bounds_max[i] - s->bounds_min[i]);
        center[i] = 0.5 * ((double)s->bounds_max[i] + s->bounds_min[i]);
        sum += half * half;
    }
    return sqrt(sum);
}

static void default_camera(struct hlh_scene *s)
{
    static const double toward[3] = {1, 0.75, 1.5};
    /* 1 / sin(25 degrees), with 5 % of air around the sphere. */
    const double distance = 1.05 / 0.42261826174069944;
    double center[3], radius = half_diagonal(s, center);
    double length = sqrt(toward[0] * toward[0] + toward[1] * toward[1] +
                         toward[2] * toward[2]);
    memset(&s->camera, 0, sizeof s->camera);
    for (int i = 0; i < 3; i++) {
        s->camera.target[i] = (float)center[i];
        s->camera.eye[i] =
            (float)(center[i] + toward[i] / length * distance * radius);
    }
    s->camera.up[1] = 1;
    s->camera.vfov = 50;
    s->camera_is_default = true;
}

/* Positions in half extents of the bounds (1 = the box's side) plus a part of
 * its half diagonal, radius in half diagonals. Lights 0 to 3 stand inside, so
 * that a room is lit too; 4 to 7 outside; 8 is the key. */
static const struct {
    float at[3], out[3], radius, color[3];
} rig[] = {
    {{0.50f, 0.10f, 0.00f}, {0, 0, 0}, 0.90f, {0.96f, 0.36f, 0.14f}},
    {{0.00f, 0.35f, 0.50f}, {0, 0, 0}, 0.90f, {0.18f, 0.66f, 0.84f}},
    {{-0.50f, 0.55f, 0.00f}, {0, 0, 0}, 0.90f, {0.72f, 0.24f, 0.78f}},
    {{0.00f, 0.30f, -0.50f}, {0, 0, 0}, 0.90f, {0.42f, 0.84f, 0.24f}},
    {{1, 0.4f, 1}, {0.25f, 0.10f, 0.25f}, 1.8f, {0.96f, 0.54f, 0.24f}},
    {{-1, 0.8f, 1}, {-0.25f, 0.20f, 0.25f}, 1.8f, {0.24f, 0.54f, 1.02f}},
    {{-1, 1.0f, -1}, {-0.25f, 0.30f, -0.25f}, 1.8f, {0.90f, 0.24f, 0.60f}},
    {{1, 0.6f, -1}, {0.25f, 0.15f, -0.25f}, 1.8f, {0.30f, 0.90f, 0.54f}},
    {{0.3f, 1, 0.6f}, {0.10f, 0.70f, 0.60f}, 3.0f, {1.02f, 0.96f, 0.86f}},
};

static bool default_lights(struct hlh_scene *s)
{
    double center[3], radius = half_diagonal(s, center);
    for (size_t i = 0; i < sizeof rig / sizeof *rig; i++) {
        struct hlh_light *l = hlh_push(&s->lights, &s->n_lights, sizeof *l);
        if (!l)
            return false;
        l->kind = HLH_LIGHT_POINT;
        l->falloff = HLH_FALLOFF_SMOOTH;
        l->direction[1] = -1;
        for (int k = 0; k < 3; k++) {
            double half =
                0.5 * ((double)s->bounds_max[k] - s->bounds_min[k]);
            l->position[k] = (float)(center[k] + rig[i].at[k] * half +
                                     rig[i].out[k] * radius);
            l->color[k] = rig[i].color[k];
        }
        l->radius = (float)(rig[i].radius * radius);
    }
    s->lights_are_default = true;
    return true;
}

bool hlh_scene_finish(struct hlh_scene *s, const char *file, bool defaults,
                      struct hlh_error *error)
{
    struct box b;
    drop_flattened(s);
    s->n_triangles = 0;
    for (uint32_t i = 0; i < s->n_objects; i++)
        s->n_triangles += s->meshes[s->objects[i].mesh].n_indices / 3;
    if (!s->n_triangles)
        return hlh_fail(error, file, "scene: has no triangles to draw "
                        "(%u were dropped for having no area)",
                        (unsigned)s->triangles_dropped);
    if (s->n_triangles > TRIANGLE_LIMIT)
        return hlh_fail(error, file, "scene: draws %llu triangles, more than "
                        "2^31", (unsigned long long)s->n_triangles);
    if (!find_bounds(s, &b))
        return hlh_fail(error, file, "out of memory");
    if (!within_limit(&b))
        return hlh_fail(error, file, "scene: reaches farther than 1e12 "
                        "metres from the origin");
    for (int i = 0; i < 3; i++) {
        s->bounds_min[i] = (float)b.min[i];
        s->bounds_max[i] = (float)b.max[i];
    }
    if (!defaults)
        return true;
    if (!(s->camera.vfov > 0))
        default_camera(s);
    if (!s->n_lights && !default_lights(s))
        return hlh_fail(error, file, "out of memory");
    return true;
}

void hlh_material_default(struct hlh_material *m)
{
    memset(m, 0, sizeof *m);
    for (int i = 0; i < 4; i++)
        m->base_color[i] = 1;
    m->metallic = m->roughness = m->normal_scale = 1;
    m->alpha_cutoff = 0.5f;
    m->base_texture.image = m->metal_rough_texture.image = -1;
    m->normal_texture.image = m->emission_texture.image = -1;
}

void hlh_scene_free(struct hlh_scene *s)
{
    if (!s)
        return;
    for (uint32_t i = 0; i < s->n_images; i++) {
        free(s->images[i].name);
        free(s->images[i].rgba);
    }
    for (uint32_t i = 0; i < s->n_materials; i++)
        free(s->materials[i].name);
    for (uint32_t i = 0; i < s->n_meshes; i++) {
        free(s->meshes[i].name);
        free(s->meshes[i].vertices);
        free(s->meshes[i].indices);
    }
    free(s->images);
    free(s->materials);
    free(s->meshes);
    free(s->objects);
    free(s->lights);
    free(s->name);
    memset(s, 0, sizeof *s);
}
