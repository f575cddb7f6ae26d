/* SPDX-License-Identifier: Zlib */
/* Normal groups: the dual graph cut at discontinuous normals (Kircher and
 * Lawrance 2009, section 3.1), by union-find over hashed edges, and which
 * groups touch. */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"

/* An edge with the normals that one or more triangles have at its two ends.
 * Triangles of one wing are continuous across the edge. */
struct dual {
    const struct hl_hooks *hooks;
    struct hl_weld wings;        /* position, position, normal, normal       */
    struct hl_weld edges;        /* position, position                       */
    uint32_t *wing_triangle;     /* the first triangle of a wing             */
    uint32_t *wing_next;         /* an earlier wing of the same edge         */
    uint32_t *edge_wing;         /* the latest wing of an edge               */
    int32_t *parent;             /* triangle: >= 0 parent, < 0 -size         */
    uint64_t *n_steps;
};

/* ---- union-find ------------------------------------------------------ */

/* Path halving; with union by size the cost is near constant. */
static int32_t root_of(struct dual *dual, int32_t t)
{
    int32_t *parent = dual->parent;
    while (parent[t] >= 0) {
        *dual->n_steps += 1;
        if (parent[parent[t]] >= 0)
            parent[t] = parent[parent[t]];
        t = parent[t];
    }
    return t;
}

static void unite(struct dual *dual, uint32_t a, uint32_t b)
{
    int32_t ra = root_of(dual, (int32_t)a), rb = root_of(dual, (int32_t)b);
    int32_t *parent = dual->parent;
    if (ra == rb)
        return;
    if (parent[ra] > parent[rb]) {
        int32_t swap = ra;
        ra = rb;
        rb = swap;
    }
    parent[ra] += parent[rb];
    parent[rb] = ra;
}

/* ---- wings ----------------------------------------------------------- */

static bool normals_near(const struct hl_mesh_work *work, uint32_t a,
                         uint32_t b)
{
    const uint32_t *keys = work->normals.keys;
    bool computed = keys[4 * (size_t)a + 3] || keys[4 * (size_t)b + 3];
    double tolerance = (double)work->desc.normal_tolerance, na[3], nb[3];
    if (a == b)
        return true;
    if (computed && tolerance < (double)HL_MESH_FACE_TOLERANCE)
        tolerance = (double)HL_MESH_FACE_TOLERANCE;
    if (tolerance == 0)
        return false;
    hl_mesh_unit_normal(work, a, na);
    hl_mesh_unit_normal(work, b, nb);
    return fabs(na[0] - nb[0]) <= tolerance &&
           fabs(na[1] - nb[1]) <= tolerance &&
           fabs(na[2] - nb[2]) <= tolerance;
}

static bool wings_near(struct hl_mesh_work *work, const struct dual *dual,
                       uint32_t a, uint32_t b)
{
    const uint32_t *ka = &dual->wings.keys[4 * (size_t)a];
    const uint32_t *kb = &dual->wings.keys[4 * (size_t)b];
    work->stats.n_steps++;
    return normals_near(work, ka[2], kb[2]) &&
           normals_near(work, ka[3], kb[3]);
}

/* The edge from corner c to corner d as a key: ends in order of position. */
static void wing_key(const struct hl_mesh_work *work, size_t c, size_t d,
                     uint32_t key[4])
{
    if (work->corner_position[c] > work->corner_position[d]) {
        size_t swap = c;
        c = d;
        d = swap;
    }
    key[0] = work->corner_position[c];
    key[1] = work->corner_position[d];
    key[2] = work->corner_normal[c];
    key[3] = work->corner_normal[d];
}

/* Joins the newest wing with the near ones among those before it. */
static void compare_wing(struct hl_mesh_work *work, struct dual *dual,
                         uint32_t wing)
{
    uint32_t other = dual->wing_next[wing], n = 0;
    for (; other != HL_MESH_NONE && n < HL_MESH_MAX_WINGS; n++) {
        if (wings_near(work, dual, wing, other))
            unite(dual, dual->wing_triangle[wing], dual->wing_triangle[other]);
        other = dual->wing_next[other];
    }
    if (other != HL_MESH_NONE)
        work->stats.n_wide++;
}

static enum hl_result add_edge(struct hl_mesh_work *work, struct dual *dual,
                               uint32_t triangle, size_t c, size_t d)
{
    enum hl_result result = HL_OK;
    uint32_t key[4], n_wings = dual->wings.n, n_edges = dual->edges.n;
    wing_key(work, c, d, key);
    uint32_t wing = hl_weld_add(&dual->wings, key, &result);
    if (result != HL_OK)
        return result;
    if (dual->wings.n == n_wings) {
        unite(dual, triangle, dual->wing_triangle[wing]);
        return HL_OK;
    }
    uint32_t edge = hl_weld_add(&dual->edges, key, &result);
    if (result != HL_OK)
        return result;
    if (dual->edges.n != n_edges)
        dual->edge_wing[edge] = HL_MESH_NONE;
    dual->wing_triangle[wing] = triangle;
    dual->wing_next[wing] = dual->edge_wing[edge];
    dual->edge_wing[edge] = wing;
    compare_wing(work, dual, wing);
    return HL_OK;
}

static enum hl_result add_edges(struct hl_mesh_work *work, struct dual *dual)
{
    enum hl_result result = HL_OK;
    for (uint32_t t = 0; t < work->n_triangles; t++)
        dual->parent[t] = -1;
    for (uint32_t t = 0; t < work->n_triangles && result == HL_OK; t++) {
        size_t c = 3 * (size_t)t;
        result = add_edge(work, dual, t, c, c + 1);
        if (result == HL_OK)
            result = add_edge(work, dual, t, c + 1, c + 2);
        if (result == HL_OK)
            result = add_edge(work, dual, t, c + 2, c);
    }
    return result;
}

/* Numbers components by their first triangle: a component's group is kept in
 * its root's entry until every triangle has read it. */
static enum hl_result number_groups(struct hl_mesh_work *work,
                                    struct dual *dual)
{
    uint32_t n = work->n_triangles, *group = work->group;
    for (uint32_t t = 0; t < n; t++)
        group[t] = HL_MESH_NONE;
    for (uint32_t t = 0; t < n; t++) {
        uint32_t root = (uint32_t)root_of(dual, (int32_t)t);
        if (group[root] == HL_MESH_NONE) {
            if (work->n_groups == work->desc.max_groups)
                return HL_ERR_LIMIT;
            group[root] = work->n_groups++;
        }
        group[t] = group[root];
    }
    return HL_OK;
}

/* ---- neighbours ------------------------------------------------------ */

static enum hl_result add_pair(struct hl_mesh_work *work, uint32_t a,
                               uint32_t b)
{
    enum hl_result result = HL_OK;
    uint32_t key[2] = {a < b ? a : b, a < b ? b : a};
    if (a != b)
        (void)hl_weld_add(&work->pairs, key, &result);
    return result;
}

/* Groups that meet at an edge: wings in the same reach as when joining. */
static enum hl_result pair_edges(struct hl_mesh_work *work,
                                 const struct dual *dual)
{
    enum hl_result result = HL_OK;
    for (uint32_t wing = 0; wing < dual->wings.n; wing++) {
        uint32_t a = work->group[dual->wing_triangle[wing]];
        uint32_t other = dual->wing_next[wing], n = 0;
        for (; other != HL_MESH_NONE && n < HL_MESH_MAX_WINGS &&
               result == HL_OK; n++) {
            work->stats.n_steps++;
            result = add_pair(work, a,
                              work->group[dual->wing_triangle[other]]);
            other = dual->wing_next[other];
        }
    }
    work->n_edge_pairs = work->pairs.n;
    return result;
}

/* Groups at each position: a list through the (position, group) keys. */
struct fans {
    struct hl_weld meets;        /* position, group                          */
    uint32_t *next;              /* an earlier key of the same position      */
    uint32_t *latest;            /* a position: its latest key               */
};

static enum hl_result link_fans(struct hl_mesh_work *work, struct fans *fans)
{
    enum hl_result result = HL_OK;
    size_t n_corners = 3 * (size_t)work->n_triangles;
    fans->next =
        hl_mem_new(&work->hooks, n_corners, sizeof(uint32_t), &result);
    fans->latest = hl_mem_new(&work->hooks, work->positions.n,
                              sizeof(uint32_t), &result);
    for (uint32_t p = 0; p < work->positions.n && result == HL_OK; p++)
        fans->latest[p] = HL_MESH_NONE;
    for (size_t c = 0; c < n_corners && result == HL_OK; c++) {
        uint32_t n = fans->meets.n, p = work->corner_position[c];
        uint32_t key[2] = {p, work->group[c / 3]};
        uint32_t meet = hl_weld_add(&fans->meets, key, &result);
        if (fans->meets.n > n) {
            fans->next[meet] = fans->latest[p];
            fans->latest[p] = meet;
        }
    }
    return result;
}

static enum hl_result pair_fan(struct hl_mesh_work *work,
                               const struct fans *fans, uint32_t position)
{
    enum hl_result result = HL_OK;
    uint32_t groups[HL_MESH_MAX_FAN], n = 0;
    uint32_t meet = fans->latest[position];
    for (; meet != HL_MESH_NONE; meet = fans->next[meet]) {
        if (n == HL_MESH_MAX_FAN) {
            work->stats.n_wide++;
            return HL_OK;
        }
        groups[n++] = fans->meets.keys[2 * (size_t)meet + 1];
    }
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < i && result == HL_OK; j++)
            result = add_pair(work, groups[i], groups[j]);
    return result;
}

static enum hl_result pair_positions(struct hl_mesh_work *work)
{
    struct fans fans;
    enum hl_result result;
    memset(&fans, 0, sizeof fans);
    hl_weld_open(&fans.meets, &work->hooks, 2, &work->stats.n_steps);
    result = link_fans(work, &fans);
    for (uint32_t p = 0; p < work->positions.n && result == HL_OK; p++)
        result = pair_fan(work, &fans, p);
    hl_weld_close(&fans.meets);
    hl_mem_free(&work->hooks, fans.next);
    hl_mem_free(&work->hooks, fans.latest);
    return result;
}

/* ---- whole ----------------------------------------------------------- */

static enum hl_result dual_open(struct dual *dual, struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    const struct hl_hooks *hooks = &work->hooks;
    size_t n = work->n_triangles, each = sizeof(uint32_t);
    memset(dual, 0, sizeof *dual);
    dual->hooks = hooks;
    dual->n_steps = &work->stats.n_steps;
    hl_weld_open(&dual->wings, hooks, 4, dual->n_steps);
    hl_weld_open(&dual->edges, hooks, 2, dual->n_steps);
    dual->wing_triangle = hl_mem_new(hooks, n, 3 * each, &result);
    dual->wing_next = hl_mem_new(hooks, n, 3 * each, &result);
    dual->edge_wing = hl_mem_new(hooks, n, 3 * each, &result);
    dual->parent = hl_mem_new(hooks, n, sizeof(int32_t), &result);
    work->group = hl_mem_new(hooks, n, each, &result);
    return result;
}

static void dual_close(struct dual *dual)
{
    hl_weld_close(&dual->wings);
    hl_weld_close(&dual->edges);
    hl_mem_free(dual->hooks, dual->wing_triangle);
    hl_mem_free(dual->hooks, dual->wing_next);
    hl_mem_free(dual->hooks, dual->edge_wing);
    hl_mem_free(dual->hooks, dual->parent);
}

enum hl_result hl_mesh_find_groups(struct hl_mesh_work *work)
{
    struct dual dual;
    enum hl_result result = dual_open(&dual, work);
    if (result == HL_OK)
        result = add_edges(work, &dual);
    if (result == HL_OK)
        result = number_groups(work, &dual);
    if (result == HL_OK && work->n_groups > 1)
        result = pair_edges(work, &dual);
    dual_close(&dual);
    if (result == HL_OK && work->n_groups > 1)
        result = pair_positions(work);
    return result;
}
