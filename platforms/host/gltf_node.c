/* SPDX-License-Identifier: Zlib */
/* The node tree: objects, lights and the camera, with world matrices. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/gltf.h"

/* A few kilobytes of nodes and primitives multiply to millions of objects. */
enum { OBJECT_LIMIT = 1 << 20 };

struct node {
    double local[16];
    uint32_t parent;
    uint32_t mesh, camera, light;
    bool drawn;
};

struct visit {
    uint32_t node;
    double world[16];
};

static void multiply(double out[16], const double a[16], const double b[16])
{
    for (int c = 0; c < 4; c++)
        for (int r = 0; r < 4; r++)
            out[c * 4 + r] = a[r] * b[c * 4] + a[4 + r] * b[c * 4 + 1] +
                             a[8 + r] * b[c * 4 + 2] + a[12 + r] * b[c * 4 + 3];
}

static bool read_trs(struct gltf *g, const cJSON *item, const char *where,
                     double m[16])
{
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, length;
    if (!gltf_numbers(g, item, where, "translation", t, 3) ||
        !gltf_numbers(g, item, where, "rotation", q, 4) ||
        !gltf_numbers(g, item, where, "scale", s, 3))
        return false;
    length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0 && length < 1e30))
        return hlh_fail(g->error, g->file, "%s.rotation: is not a rotation",
                        where);
    for (int i = 0; i < 4; i++)
        q[i] /= length;
    m[0] = (1 - 2 * (q[1] * q[1] + q[2] * q[2])) * s[0];
    m[1] = 2 * (q[0] * q[1] + q[2] * q[3]) * s[0];
    m[2] = 2 * (q[0] * q[2] - q[1] * q[3]) * s[0];
    m[4] = 2 * (q[0] * q[1] - q[2] * q[3]) * s[1];
    m[5] = (1 - 2 * (q[0] * q[0] + q[2] * q[2])) * s[1];
    m[6] = 2 * (q[1] * q[2] + q[0] * q[3]) * s[1];
    m[8] = 2 * (q[0] * q[2] + q[1] * q[3]) * s[2];
    m[9] = 2 * (q[1] * q[2] - q[0] * q[3]) * s[2];
    m[10] = (1 - 2 * (q[0] * q[0] + q[1] * q[1])) * s[2];
    for (int i = 0; i < 3; i++)
        m[12 + i] = t[i];
    m[15] = 1;
    return true;
}

static bool read_matrix(struct gltf *g, const cJSON *item, const char *where,
                        double m[16])
{
    double bottom;
    if (!gltf_numbers(g, item, where, "matrix", m, 16))
        return false;
    bottom = fabs(m[3]) + fabs(m[7]) + fabs(m[11]) + fabs(m[15] - 1);
    if (!(bottom <= 1e-5))
        return hlh_fail(g->error, g->file, "%s.matrix: its last row is not "
                        "0 0 0 1", where);
    m[3] = m[7] = m[11] = 0;
    m[15] = 1;
    return true;
}

static bool read_node(struct gltf *g, struct node *nodes, uint32_t i)
{
    const cJSON *item = g->list[GLTF_NODES].item[i], *children, *child, *light;
    struct node *n = &nodes[i];
    char where[48];
    unsigned k = 0;
    snprintf(where, sizeof where, "nodes[%u]", (unsigned)i);
    if (!gltf_index(g, item, where, "mesh", GLTF_MESHES, &n->mesh) ||
        !gltf_index(g, item, where, "camera", GLTF_CAMERAS, &n->camera) ||
        !gltf_extension(g, item, where, "KHR_lights_punctual", &light) ||
        !gltf_index(g, light, where, "light", GLTF_LIGHTS, &n->light) ||
        !gltf_array(g, item, where, "children", &children))
        return false;
    if (cJSON_GetObjectItemCaseSensitive(item, "matrix")
            ? !read_matrix(g, item, where, n->local)
            : !read_trs(g, item, where, n->local))
        return false;
    cJSON_ArrayForEach(child, children) {
        uint32_t c;
        char key[32];
        snprintf(key, sizeof key, "children[%u]", k++);
        if (!gltf_index_value(g, child, where, key, GLTF_NODES, &c))
            return false;
        if (nodes[c].parent != HLH_NONE)
            return hlh_fail(g->error, g->file, "%s.%s: nodes[%u] is a child "
                            "of nodes[%u] already", where, key, (unsigned)c,
                            (unsigned)nodes[c].parent);
        nodes[c].parent = i;
    }
    return true;
}

/* With one parent each, a cycle is a chain that never ends: walk up from each
 * node and colour what was walked; meeting one's own colour is a cycle. */
static bool check_cycles(struct gltf *g, const struct node *nodes, uint32_t n)
{
    uint32_t *color = hlh_alloc_zero(n, sizeof *color);
    bool ok = true;
    if (!color)
        return gltf_memory(g);
    for (uint32_t i = 0; i < n && ok; i++) {
        uint32_t at = i;
        while (at != HLH_NONE && !color[at]) {
            color[at] = i + 1;
            at = nodes[at].parent;
        }
        if (at != HLH_NONE && color[at] == i + 1)
            ok = hlh_fail(g->error, g->file, "nodes[%u]: is its own ancestor",
                          (unsigned)at);
    }
    free(color);
    return ok;
}

static bool add_objects(struct gltf *g, uint32_t mesh, const double world[16],
                        bool no_shadow, const char *where)
{
    struct hlh_scene *s = g->scene;
    const struct gltf_mesh_range *range = &g->range[mesh];
    for (uint32_t i = 0; i < range->count; i++) {
        struct hlh_object *o;
        if (s->n_objects >= OBJECT_LIMIT)
            return hlh_fail(g->error, g->file, "%s: makes more than 2^20 "
                            "objects", where);
        o = hlh_push(&s->objects, &s->n_objects, sizeof *o);
        if (!o)
            return gltf_memory(g);
        o->mesh = range->first + i;
        o->no_shadow = no_shadow;
        for (int k = 0; k < 16; k++)
            o->world[k] = (float)world[k];
    }
    return true;
}

static bool finite_world(struct gltf *g, const double world[16],
                         const char *where)
{
    for (int k = 0; k < 16; k++)
        if (!(fabs(world[k]) <= 1e30))
            return hlh_fail(g->error, g->file, "%s: its world matrix is not "
                            "finite or beyond 1e30", where);
    return true;
}

static bool visit_node(struct gltf *g, const struct node *n,
                       const struct visit *v)
{
    const cJSON *item = g->list[GLTF_NODES].item[v->node];
    bool no_shadow = cJSON_IsTrue(gltf_extra(item, "no_shadow"));
    char where[48];
    snprintf(where, sizeof where, "nodes[%u]", (unsigned)v->node);
    if (!finite_world(g, v->world, where))
        return false;
    if (n->mesh != HLH_NONE &&
        !add_objects(g, n->mesh, v->world, no_shadow, where))
        return false;
    if (n->light != HLH_NONE && !gltf_add_light(g, n->light, v->world, where))
        return false;
    if (n->camera != HLH_NONE &&
        !gltf_add_camera(g, n->camera, v->world, where))
        return false;
    return true;
}

/* Children are pushed last to first, so that they are met in the file's
 * order; each node is pushed once at most, so n slots are enough. */
static uint32_t push_children(struct gltf *g, const struct node *nodes,
                              const struct visit *v, struct visit *stack,
                              uint32_t top)
{
    const cJSON *children = cJSON_GetObjectItemCaseSensitive(
        g->list[GLTF_NODES].item[v->node], "children"), *child;
    uint32_t first = top;
    cJSON_ArrayForEach(child, children) {
        struct visit *next = &stack[top++];
        next->node = (uint32_t)child->valuedouble;
        multiply(next->world, v->world, nodes[next->node].local);
    }
    for (uint32_t low = first, high = top; low + 1 < high; low++) {
        struct visit swap = stack[low];
        stack[low] = stack[--high];
        stack[high] = swap;
    }
    return top;
}

static bool draw_tree(struct gltf *g, struct node *nodes, uint32_t root,
                      struct visit *stack)
{
    uint32_t top = 1;
    stack[0].node = root;
    memcpy(stack[0].world, nodes[root].local, sizeof stack[0].world);
    while (top) {
        struct visit v = stack[--top];
        if (nodes[v.node].drawn)
            return hlh_fail(g->error, g->file, "scenes: draw nodes[%u] twice",
                            (unsigned)v.node);
        nodes[v.node].drawn = true;
        if (!visit_node(g, &nodes[v.node], &v))
            return false;
        top = push_children(g, nodes, &v, stack, top);
    }
    return true;
}

static bool draw_scene(struct gltf *g, struct node *nodes, uint32_t scene,
                       struct visit *stack)
{
    const cJSON *roots, *root;
    char where[48], key[32];
    unsigned k = 0;
    snprintf(where, sizeof where, "scenes[%u]", (unsigned)scene);
    if (!gltf_array(g, g->list[GLTF_SCENES].item[scene], where, "nodes",
                    &roots))
        return false;
    cJSON_ArrayForEach(root, roots) {
        uint32_t i;
        snprintf(key, sizeof key, "nodes[%u]", k++);
        if (!gltf_index_value(g, root, where, key, GLTF_NODES, &i) ||
            !draw_tree(g, nodes, i, stack))
            return false;
    }
    return true;
}

/* scene names the default scene; without it the first one counts, and
 * without any scene all root nodes. */
static bool draw_default(struct gltf *g, struct node *nodes,
                         struct visit *stack)
{
    uint32_t scene;
    if (!gltf_index(g, g->root, "", "scene", GLTF_SCENES, &scene))
        return false;
    if (scene == HLH_NONE && g->list[GLTF_SCENES].n)
        scene = 0;
    if (scene != HLH_NONE)
        return draw_scene(g, nodes, scene, stack);
    for (uint32_t i = 0; i < g->list[GLTF_NODES].n; i++)
        if (nodes[i].parent == HLH_NONE && !draw_tree(g, nodes, i, stack))
            return false;
    return true;
}

bool gltf_load_nodes(struct gltf *g)
{
    uint32_t n = g->list[GLTF_NODES].n;
    struct node *nodes = hlh_alloc_zero(n, sizeof *nodes);
    struct visit *stack = hlh_alloc((size_t)n + 1, sizeof *stack);
    bool ok = nodes && stack;
    if (!ok)
        gltf_memory(g);
    for (uint32_t i = 0; ok && i < n; i++)
        nodes[i].parent = HLH_NONE;
    for (uint32_t i = 0; ok && i < n; i++)
        ok = read_node(g, nodes, i);
    ok = ok && check_cycles(g, nodes, n) && draw_default(g, nodes, stack);
    free(nodes);
    free(stack);
    return ok;
}
