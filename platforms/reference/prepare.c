/* SPDX-License-Identifier: Zlib */
/* From a scene to what the rays need. */
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "platforms/reference/internal.h"

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static const char *check_lights(const struct hlh_scene *s)
{
    for (uint32_t i = 0; i < s->n_lights; i++) {
        const struct hlh_light *l = &s->lights[i];
        if (!isfinite(l->radius) || l->radius < 0)
            return "a light's radius is negative or not finite";
        if (!finite3(l->position) || !finite3(l->direction) ||
            !finite3(l->color) || !isfinite(l->inner_angle) ||
            !isfinite(l->outer_angle))
            return "a light's position, direction, colour or cone is not "
                   "finite";
    }
    return NULL;
}

static bool texture_ok(const struct hlh_scene *s, const struct hlh_texture *t)
{
    if (t->image < 0)
        return true;
    if ((uint32_t)t->image >= s->n_images)
        return false;
    const struct hlh_image *image = &s->images[t->image];
    return image->width > 0 && image->height > 0 && image->rgba;
}

static const char *check_meshes(const struct hlh_scene *s)
{
    for (uint32_t i = 0; i < s->n_meshes; i++) {
        const struct hlh_mesh *m = &s->meshes[i];
        if (m->material >= s->n_materials)
            return "a mesh names a material that is not there";
        for (uint32_t k = 0; k < m->n_indices; k++)
            if (m->indices[k] >= m->n_vertices)
                return "a mesh's index is out of range";
    }
    for (uint32_t i = 0; i < s->n_objects; i++)
        if (s->objects[i].mesh >= s->n_meshes)
            return "an object names a mesh that is not there";
    for (uint32_t i = 0; i < s->n_materials; i++) {
        const struct hlh_material *m = &s->materials[i];
        if (!texture_ok(s, &m->base_texture) ||
            !texture_ok(s, &m->metal_rough_texture) ||
            !texture_ok(s, &m->normal_texture) ||
            !texture_ok(s, &m->emission_texture))
            return "a material names an image that is not there";
    }
    return NULL;
}

static bool add_chain(struct hlr_prepared *p, const struct hlh_texture *t,
                      bool srgb)
{
    if (t->image < 0)
        return true;
    struct hlr_chain *chain = &p->chains[2 * t->image + (srgb ? 0 : 1)];
    return chain->n_levels > 0 ||
           hlr_chain_build(chain, &p->scene->images[t->image], srgb,
                           &p->tables);
}

static bool make_textures(struct hlr_prepared *p)
{
    const struct hlh_scene *s = p->scene;
    hlr_tables_make(&p->tables);
    p->chains = calloc(2 * (size_t)s->n_images + 1, sizeof *p->chains);
    bool ok = p->chains != NULL;
    for (uint32_t i = 0; ok && i < s->n_materials; i++) {
        const struct hlh_material *m = &s->materials[i];
        ok = add_chain(p, &m->base_texture, true) &&
             add_chain(p, &m->emission_texture, true) &&
             add_chain(p, &m->metal_rough_texture, false) &&
             add_chain(p, &m->normal_texture, false);
    }
    return ok;
}

static bool make_tangents(struct hlr_prepared *p)
{
    const struct hlh_scene *s = p->scene;
    p->tangents = calloc((size_t)s->n_meshes + 1, sizeof *p->tangents);
    bool ok = p->tangents != NULL;
    for (uint32_t i = 0; ok && i < s->n_meshes; i++) {
        const struct hlh_mesh *m = &s->meshes[i];
        if (!m->has_tangent && m->has_uv &&
            s->materials[m->material].normal_texture.image >= 0)
            ok = hlr_tangents_make(&p->tangents[i], m);
    }
    return ok;
}

static void make_instance(struct hlr_instance *out,
                          const struct hlr_prepared *p, uint32_t object)
{
    const struct hlh_object *o = &p->scene->objects[object];
    out->mesh = &p->scene->meshes[o->mesh];
    out->material = &p->scene->materials[out->mesh->material];
    out->tangents = p->tangents[o->mesh];
    struct v3 *m = out->linear, *n = out->normal;
    for (int k = 0; k < 3; k++)
        m[k] = v3_of(o->world + 4 * k);
    out->origin = v3_of(o->world + 12);
    n[0] = cross3(m[1], m[2]);
    n[1] = cross3(m[2], m[0]);
    n[2] = cross3(m[0], m[1]);
    out->mirrored = dot3(m[0], n[0]) < 0;
    for (int k = 0; k < 3 && out->mirrored; k++)
        n[k] = mul3(n[k], -1);
}

static void add_tris(struct hlr_prepared *p, uint32_t object, uint32_t *index)
{
    const struct hlr_instance *in = &p->instances[object];
    const struct hlh_mesh *mesh = in->mesh;
    for (uint32_t i = 0; i < mesh->n_indices / 3; i++) {
        struct hlr_tri *t = &p->tris[p->n_tris];
        bool finite = true;
        for (uint32_t k = 0; k < 3; k++) {
            const struct hlh_vertex *v =
                &mesh->vertices[mesh->indices[3 * i + k]];
            t->p[k] = add3(transform3(in->linear, v3_of(v->position)),
                           in->origin);
            finite = finite && isfinite(t->p[k].x) && isfinite(t->p[k].y) &&
                     isfinite(t->p[k].z);
        }
        t->index = (*index)++;
        t->object = object;
        t->prim = i;
        t->mirrored = in->mirrored;
        p->n_tris += finite;
    }
}

static bool make_tris(struct hlr_prepared *p)
{
    const struct hlh_scene *s = p->scene;
    uint64_t n = 0;
    uint32_t index = 0;
    for (uint32_t i = 0; i < s->n_objects; i++)
        n += s->meshes[s->objects[i].mesh].n_indices / 3;
    if (n > UINT32_MAX / 2)
        return false;
    p->instances = calloc((size_t)s->n_objects + 1, sizeof *p->instances);
    p->tris = calloc((size_t)n + 1, sizeof *p->tris);
    if (!p->instances || !p->tris)
        return false;
    for (uint32_t i = 0; i < s->n_objects; i++) {
        make_instance(&p->instances[i], p, i);
        add_tris(p, i, &index);
    }
    return true;
}

static void coords(double out[3], struct v3 p)
{
    out[0] = p.x;
    out[1] = p.y;
    out[2] = p.z;
}

static struct hlr_box tri_box(const struct hlr_tri *t, double pad)
{
    struct hlr_box box;
    double q[3][3];
    for (int c = 0; c < 3; c++)
        coords(q[c], t->p[c]);
    for (int k = 0; k < 3; k++) {
        box.lo[k] = fmin(q[0][k], fmin(q[1][k], q[2][k])) - pad;
        box.hi[k] = fmax(q[0][k], fmax(q[1][k], q[2][k])) + pad;
    }
    return box;
}

/* Flat boxes get some thickness, or a ray in their plane would miss them:
 * 1e-12 of the largest coordinate outweighs the shear's rounding (2^-52 of
 * the eye's distance) until the eye is some thousand scenes away. */
static double box_pad(const struct hlr_prepared *p)
{
    double most = 0, q[3];
    for (uint32_t i = 0; i < p->n_tris; i++)
        for (int c = 0; c < 3; c++) {
            coords(q, p->tris[i].p[c]);
            for (int k = 0; k < 3; k++)
                most = fmax(most, fabs(q[k]));
        }
    return 1e-12 * most + 1e-30;
}

static bool make_tree(struct hlr_prepared *p)
{
    struct hlr_box *boxes = calloc((size_t)p->n_tris + 1, sizeof *boxes);
    struct hlr_tri *sorted = calloc((size_t)p->n_tris + 1, sizeof *sorted);
    double pad = box_pad(p);
    bool ok = boxes && sorted;
    for (uint32_t i = 0; ok && i < p->n_tris; i++)
        boxes[i] = tri_box(&p->tris[i], pad);
    ok = ok && hlr_bvh_build(&p->tree, boxes, p->n_tris);
    for (uint32_t i = 0; ok && i < p->n_tris; i++)
        sorted[i] = p->tris[p->tree.order[i]];
    if (ok) {
        struct hlr_tri *unsorted = p->tris;
        p->tris = sorted;
        sorted = unsorted;
    }
    free(boxes);
    free(sorted);
    return ok;
}

double hlr_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

struct hlr_prepared *hlr_prepare(const struct hlh_scene *scene,
                                 const char **why)
{
    double start = hlr_now();
    const char *reason = check_lights(scene);
    struct hlr_prepared *p = NULL;
    if (!reason)
        reason = check_meshes(scene);
    if (!reason) {
        reason = "out of memory";
        p = calloc(1, sizeof *p);
    }
    if (p) {
        p->scene = scene;
        if (make_textures(p) && make_tangents(p) && make_tris(p) &&
            make_tree(p) && hlr_lights_make(&p->lights, scene)) {
            p->seconds = hlr_now() - start;
            return p;
        }
        hlr_prepared_free(p);
    }
    if (why)
        *why = reason;
    return NULL;
}

void hlr_prepared_free(struct hlr_prepared *p)
{
    if (!p)
        return;
    for (uint32_t i = 0; p->chains && i < 2 * p->scene->n_images; i++)
        hlr_chain_free(&p->chains[i]);
    for (uint32_t i = 0; p->tangents && i < p->scene->n_meshes; i++)
        free(p->tangents[i]);
    free(p->chains);
    free(p->tangents);
    free(p->instances);
    free(p->tris);
    hlr_bvh_free(&p->tree);
    hlr_lights_free(&p->lights);
    free(p);
}
