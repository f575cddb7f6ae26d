/* SPDX-License-Identifier: Zlib */
/* Primitives. Points and lines are checked and left out; strips and fans
 * become lists. Skins, morph targets and custom attributes are ignored: a
 * mesh stands as its node says. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"
#include "platforms/host/scene_clean.h"

/* Vertices that all primitives together may name, used or not: marking the
 * used ones is linear in this number. */
#define NAMED_LIMIT ((uint64_t)1 << 30)

struct primitive {
    const struct gltf_accessor *position, *normal, *tangent, *uv, *color;
    const struct gltf_accessor *indices;         /* NULL: 0, 1, 2, ..        */
    uint32_t n_vertices, n_indices, mode, material;
    char where[80];
};

/* An attribute's accessor, of `least` to `most` components, of floats or
 * (KHR_mesh_quantization's widest rule) of 8- or 16-bit integers. */
static bool attribute(struct gltf *g, const struct primitive *p,
                      const cJSON *attributes, const char *key, uint32_t least,
                      uint32_t most, const struct gltf_accessor **out)
{
    uint32_t i;
    *out = NULL;
    if (!gltf_index(g, attributes, p->where, key, GLTF_ACCESSORS, &i))
        return false;
    if (i == HLH_NONE)
        return true;
    *out = &g->accessor[i];
    if ((*out)->components < least || (*out)->components > most)
        return hlh_fail(g->error, g->file, "%s.%s: accessors[%u] has %u "
                        "components an element", p->where, key, (unsigned)i,
                        (unsigned)(*out)->components);
    if ((*out)->type == GLTF_U32)
        return hlh_fail(g->error, g->file, "%s.%s: accessors[%u] holds 32-bit "
                        "integers", p->where, key, (unsigned)i);
    return true;
}

/* Every attribute, known or not, has as many elements as POSITION. */
static bool equal_counts(struct gltf *g, const struct primitive *p,
                         const cJSON *attributes)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, attributes) {
        uint32_t i;
        if (!gltf_index_value(g, item, p->where, item->string, GLTF_ACCESSORS,
                              &i))
            return false;
        if (g->accessor[i].count != p->n_vertices)
            return hlh_fail(g->error, g->file, "%s.%.40s: accessors[%u] has "
                            "%u elements, POSITION has %u", p->where,
                            item->string, (unsigned)i,
                            (unsigned)g->accessor[i].count,
                            (unsigned)p->n_vertices);
    }
    return true;
}

static bool load_attributes(struct gltf *g, struct primitive *p,
                            const cJSON *item)
{
    const cJSON *attributes;
    uint32_t n = g->list[GLTF_MATERIALS].n;
    char set[32];
    if (!gltf_object(g, item, p->where, "attributes", &attributes) ||
        !gltf_index(g, item, p->where, "material", GLTF_MATERIALS,
                    &p->material))
        return false;
    snprintf(set, sizeof set, "TEXCOORD_%u",
             (unsigned)g->uv[p->material == HLH_NONE ? n : p->material].set);
    if (!attribute(g, p, attributes, "POSITION", 3, 3, &p->position) ||
        !attribute(g, p, attributes, "NORMAL", 3, 3, &p->normal) ||
        !attribute(g, p, attributes, "TANGENT", 4, 4, &p->tangent) ||
        !attribute(g, p, attributes, set, 2, 2, &p->uv) ||
        !attribute(g, p, attributes, "COLOR_0", 3, 4, &p->color))
        return false;
    if (!p->position)
        return hlh_fail(g->error, g->file, "%s: has no POSITION", p->where);
    p->n_vertices = p->n_indices = p->position->count;
    return equal_counts(g, p, attributes);
}

static bool load_indices(struct gltf *g, struct primitive *p,
                         const cJSON *item)
{
    uint32_t i;
    if (!gltf_index(g, item, p->where, "indices", GLTF_ACCESSORS, &i))
        return false;
    if (i == HLH_NONE)
        return true;
    p->indices = &g->accessor[i];
    p->n_indices = p->indices->count;
    if (p->indices->components != 1 || p->indices->normalized ||
        (p->indices->type != GLTF_U8 && p->indices->type != GLTF_U16 &&
         p->indices->type != GLTF_U32))
        return hlh_fail(g->error, g->file, "%s.indices: accessors[%u] does "
                        "not hold unsigned scalars", p->where, (unsigned)i);
    for (uint32_t k = 0; k < p->n_indices; k++) {
        uint32_t v = gltf_read_index(p->indices, k);
        if (v >= p->n_vertices)
            return hlh_fail(g->error, g->file, "%s.indices: element %u of "
                            "accessors[%u] is %u, but there are %u vertices",
                            p->where, (unsigned)k, (unsigned)i, (unsigned)v,
                            (unsigned)p->n_vertices);
    }
    return true;
}

static uint32_t corner(const struct primitive *p, uint32_t k)
{
    return p->indices ? gltf_read_index(p->indices, k) : k;
}

/* Triangle t's corners, as glTF 2.0 section 3.7.2.1 orders them. */
static void triangle(const struct primitive *p, uint32_t t, uint32_t out[3])
{
    uint32_t odd = t & 1;
    switch (p->mode) {
    case 4:
        out[0] = corner(p, 3 * t);
        out[1] = corner(p, 3 * t + 1);
        out[2] = corner(p, 3 * t + 2);
        break;
    case 5:
        out[0] = corner(p, t);
        out[1] = corner(p, t + 1 + odd);
        out[2] = corner(p, t + 2 - odd);
        break;
    default:
        out[0] = corner(p, t + 1);
        out[1] = corner(p, t + 2);
        out[2] = corner(p, 0);
        break;
    }
}

static void read_vertex(const struct gltf *g, const struct primitive *p,
                        uint32_t i, struct hlh_vertex *v)
{
    float at[16];
    const struct gltf_uv *uv = &g->uv[p->material == HLH_NONE
                                          ? g->list[GLTF_MATERIALS].n
                                          : p->material];
    memset(v, 0, sizeof *v);
    gltf_read(p->position, i, v->position);
    if (p->normal)
        gltf_read(p->normal, i, v->normal);
    if (p->tangent)
        gltf_read(p->tangent, i, v->tangent);
    for (int k = 0; k < 4; k++)
        v->color[k] = 1;
    if (p->color)
        gltf_read(p->color, i, v->color);
    if (!p->uv)
        return;
    /* KHR_texture_transform: offset * rotation * scale, the rotation being
     * counter-clockwise as seen, with v downwards. */
    gltf_read(p->uv, i, at);
    if (uv->sine == 0 && uv->cosine == 1) {
        for (int k = 0; k < 2; k++)
            v->uv[k] = (float)(at[k] * uv->scale[k] + uv->offset[k]);
    } else {
        double x = at[0] * uv->scale[0], y = at[1] * uv->scale[1];
        v->uv[0] = (float)(uv->cosine * x + uv->sine * y + uv->offset[0]);
        v->uv[1] = (float)(uv->cosine * y - uv->sine * x + uv->offset[1]);
    }
}

/* The primitive's triangles and, in the file's order, the vertices that they
 * use: primitives often share one large pool. */
static bool fill_mesh(struct gltf *g, const struct primitive *p,
                      uint32_t n_triangles, struct hlh_mesh *mesh)
{
    uint32_t *moved = hlh_alloc(p->n_vertices, sizeof *moved), used = 0;
    mesh->indices = hlh_alloc((size_t)n_triangles * 3, sizeof *mesh->indices);
    if (!moved || !mesh->indices) {
        free(moved);
        return gltf_memory(g);
    }
    memset(moved, 0xff, p->n_vertices * sizeof *moved);
    for (uint32_t t = 0; t < n_triangles; t++) {
        triangle(p, t, &mesh->indices[3 * t]);
        for (uint32_t k = 3 * t; k < 3 * t + 3; k++)
            moved[mesh->indices[k]] = 0;
    }
    for (uint32_t i = 0; i < p->n_vertices; i++)
        if (!moved[i])
            moved[i] = used++;
    mesh->vertices = hlh_alloc(used, sizeof *mesh->vertices);
    if (!mesh->vertices) {
        free(moved);
        return gltf_memory(g);
    }
    for (uint32_t i = 0; i < p->n_vertices; i++)
        if (moved[i] != HLH_NONE)
            read_vertex(g, p, i, &mesh->vertices[moved[i]]);
    mesh->n_vertices = used;
    mesh->n_indices = n_triangles * 3;
    for (uint32_t k = 0; k < mesh->n_indices; k++)
        mesh->indices[k] = moved[mesh->indices[k]];
    free(moved);
    return true;
}

static bool material_of(struct gltf *g, const struct primitive *p,
                        uint32_t *out)
{
    struct hlh_scene *s = g->scene;
    struct hlh_material *m;
    *out = p->material;
    if (*out != HLH_NONE)
        return true;
    if (g->default_material == HLH_NONE) {
        m = hlh_push(&s->materials, &s->n_materials, sizeof *m);
        if (!m)
            return gltf_memory(g);
        hlh_material_default(m);
        m->name = hlh_strdup("default");
        if (!m->name)
            return gltf_memory(g);
        g->default_material = s->n_materials - 1;
    }
    *out = g->default_material;
    return true;
}

static bool add_mesh(struct gltf *g, const struct primitive *p,
                     uint32_t n_triangles, const cJSON *item, uint32_t mesh_i)
{
    struct hlh_scene *s = g->scene;
    uint32_t material;
    uint64_t cost = (uint64_t)n_triangles * 3 + p->n_vertices;
    struct hlh_mesh *mesh;
    if (cost > g->elements_left)
        return hlh_fail(g->error, g->file, "%s: exceeds 2^26 vertices and "
                        "indices in all", p->where);
    g->elements_left -= cost;
    if (!material_of(g, p, &material))
        return false;
    mesh = hlh_push(&s->meshes, &s->n_meshes, sizeof *mesh);
    if (!mesh)
        return gltf_memory(g);
    mesh->material = material;
    mesh->has_uv = p->uv != NULL;
    mesh->has_color = p->color != NULL;
    mesh->has_tangent = p->tangent && p->normal;
    mesh->name = gltf_name(item, "mesh", mesh_i);
    if (!mesh->name || !fill_mesh(g, p, n_triangles, mesh) ||
        !hlh_mesh_clean(mesh, p->normal != NULL, s))
        return gltf_memory(g);
    if (mesh->n_indices)
        return true;
    free(mesh->name);
    free(mesh->vertices);
    free(mesh->indices);
    s->n_meshes--;
    return true;
}

static bool load_primitive(struct gltf *g, const cJSON *item,
                           const cJSON *mesh, uint32_t mesh_i, uint32_t i,
                           uint64_t *named_left)
{
    struct primitive p = {0};
    uint64_t mode = 4;
    snprintf(p.where, sizeof p.where, "meshes[%u].primitives[%u]",
             (unsigned)mesh_i, (unsigned)i);
    if (!gltf_integer(g, item, p.where, "mode", 0, 6, &mode) ||
        !load_attributes(g, &p, item))
        return false;
    if ((uint64_t)p.n_vertices > *named_left)
        return hlh_fail(g->error, g->file, "%s: exceeds 2^30 vertices in all",
                        p.where);
    *named_left -= p.n_vertices;
    if (!load_indices(g, &p, item))
        return false;
    if ((uint64_t)p.n_indices > *named_left)
        return hlh_fail(g->error, g->file, "%s: exceeds 2^30 indices in all",
                        p.where);
    *named_left -= p.n_indices;
    p.mode = (uint32_t)mode;
    if (mode == 4 && p.n_indices % 3)
        return hlh_fail(g->error, g->file, "%s: has %u corners, not a "
                        "multiple of 3", p.where, (unsigned)p.n_indices);
    if (mode < 4 || p.n_indices < 3)
        return true;
    return add_mesh(g, &p, mode == 4 ? p.n_indices / 3 : p.n_indices - 2, mesh,
                    mesh_i);
}

bool gltf_load_meshes(struct gltf *g)
{
    uint32_t n = g->list[GLTF_MESHES].n;
    uint64_t named_left = NAMED_LIMIT;
    g->range = hlh_alloc_zero(n, sizeof *g->range);
    if (!g->range)
        return gltf_memory(g);
    for (uint32_t i = 0; i < n; i++) {
        const cJSON *item = g->list[GLTF_MESHES].item[i], *array, *primitive;
        uint32_t k = 0;
        char where[48];
        snprintf(where, sizeof where, "meshes[%u]", (unsigned)i);
        if (!gltf_array(g, item, where, "primitives", &array))
            return false;
        if (!array || !array->child)
            return hlh_fail(g->error, g->file, "%s: has no primitives", where);
        g->range[i].first = g->scene->n_meshes;
        cJSON_ArrayForEach(primitive, array) {
            if (!cJSON_IsObject(primitive))
                return hlh_fail(g->error, g->file, "%s.primitives[%u]: is not "
                                "an object", where, (unsigned)k);
            if (!load_primitive(g, primitive, item, i, k++, &named_left))
                return false;
        }
        g->range[i].count = g->scene->n_meshes - g->range[i].first;
    }
    return true;
}
