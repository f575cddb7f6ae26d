/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"
#include "core/shadow_mesh.h"

struct work {
    struct hl_hooks hooks;
    struct hl_shadow_mesh_desc desc; /* defaults filled in                   */
    struct hl_weld positions;        /* bits of x y z                        */
    struct hl_weld edges;            /* vertex, vertex                       */
    uint32_t *edge_of;               /* 3 a face                             */
    uint32_t *n_forward, *n_reverse; /* an edge: faces that go either way    */
    uint32_t *place;                 /* an edge: its place in the output     */
};

/* ---- faces ------------------------------------------------------------ */

static enum hl_result take_desc(struct hl_shadow_mesh_desc *d)
{
    if (d->n_vertices > HL_SHADOW_MAX_INDICES ||
        d->n_indices > HL_SHADOW_MAX_INDICES)
        return HL_ERR_LIMIT;
    if (!d->positions && d->n_vertices > 0)
        return HL_ERR_INVALID;
    if (!d->indices && d->n_indices == 0)
        d->n_indices = d->n_vertices;
    else if (!d->indices && d->n_indices != d->n_vertices)
        return HL_ERR_INVALID;
    if (d->position_stride == 0)
        d->position_stride = 3 * sizeof(float);
    return hl_mem_fits(d->n_vertices, d->position_stride) ? HL_OK
                                                          : HL_ERR_LIMIT;
}

/* False when the triangle has no area. The products of two differences of
 * floats are exact in double but where the floats' exponents lie far apart;
 * `spread` covers that too. */
static bool face_plane(struct hl_shadow_face *face, float p[3][3])
{
    double a[3], b[3];
    hl_mesh_edge(a, p[0], p[1]);
    hl_mesh_edge(b, p[0], p[2]);
    face->spread = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double s = a[j] * b[k], t = a[k] * b[j];
        double size = fabs(s) + fabs(t);
        face->normal[i] = s - t;
        if (size > face->spread)
            face->spread = size;
    }
    return face->normal[0] != 0 || face->normal[1] != 0 ||
           face->normal[2] != 0;
}

static bool read_triangle(const struct hl_shadow_mesh_desc *d,
                          uint32_t number, float p[3][3])
{
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t v = 3 * number + i;
        if (d->indices)
            v = d->indices[v];
        if (v >= d->n_vertices)
            return false;
        hl_mesh_read(p[i], d->positions, d->position_stride, v, 3);
    }
    return true;
}

/* Keeps the triangle as the next face, or counts why not. */
static enum hl_result take_face(struct work *work, struct hl_shadow_mesh *out,
                                uint32_t number)
{
    enum hl_result result = HL_OK;
    float p[3][3];
    uint32_t *corner = &out->corners[3 * (size_t)out->n_faces];
    if (!read_triangle(&work->desc, number, p)) {
        out->stats.n_out_of_range++;
        return HL_OK;
    }
    if (!hl_mesh_finite(p[0], 3) || !hl_mesh_finite(p[1], 3) ||
        !hl_mesh_finite(p[2], 3)) {
        out->stats.n_non_finite++;
        return HL_OK;
    }
    if (!face_plane(&out->faces[out->n_faces], p)) {
        out->stats.n_degenerate++;
        return HL_OK;
    }
    for (int i = 0; i < 3; i++) {
        uint32_t key[3];
        hl_mesh_float_key(key, p[i], 3);
        corner[i] = hl_weld_add(&work->positions, key, &result);
    }
    out->n_faces += result == HL_OK;
    return result;
}

static enum hl_result take_faces(struct work *work, struct hl_shadow_mesh *out)
{
    enum hl_result result = HL_OK;
    uint32_t n = work->desc.n_indices / 3;
    out->stats.n_partial = work->desc.n_indices % 3 != 0;
    out->corners =
        hl_mem_new(&work->hooks, n, 3 * sizeof *out->corners, &result);
    out->faces = hl_mem_new(&work->hooks, n, sizeof *out->faces, &result);
    for (uint32_t i = 0; i < n && result == HL_OK; i++)
        result = take_face(work, out, i);
    return result;
}

static enum hl_result fill_vertices(struct work *work,
                                    struct hl_shadow_mesh *out)
{
    enum hl_result result = HL_OK;
    uint32_t n = work->positions.n;
    out->vertices = hl_mem_new(&work->hooks, n, 8 * sizeof(float), &result);
    if (result != HL_OK)
        return result;
    out->n_vertices = n;
    for (size_t v = 0; v < n; v++) {
        float *p = &out->vertices[8 * v];
        hl_mesh_key_floats(p, &work->positions.keys[3 * v], 3);
        memcpy(p + 4, p, 3 * sizeof *p);
        p[3] = 1;
        p[7] = 0;
        for (int i = 0; i < 3; i++) {
            if (v == 0 || p[i] < out->min[i])
                out->min[i] = p[i];
            if (v == 0 || p[i] > out->max[i])
                out->max[i] = p[i];
        }
    }
    return HL_OK;
}

/* ---- edges ------------------------------------------------------------ */

static enum hl_result find_edges(struct work *work,
                                 const struct hl_shadow_mesh *out)
{
    enum hl_result result = HL_OK;
    work->edge_of = hl_mem_new(&work->hooks, out->n_faces,
                               3 * sizeof *work->edge_of, &result);
    for (size_t f = 0; f < out->n_faces && result == HL_OK; f++)
        for (size_t i = 0; i < 3; i++) {
            uint32_t a = out->corners[3 * f + i];
            uint32_t b = out->corners[3 * f + (i + 1) % 3];
            uint32_t key[2] = {a < b ? a : b, a < b ? b : a};
            work->edge_of[3 * f + i] =
                hl_weld_add(&work->edges, key, &result);
        }
    return result;
}

/* The face goes from the edge's greater vertex to its lesser one. */
static bool is_reverse(const struct hl_shadow_mesh *mesh, size_t f, size_t i)
{
    return mesh->corners[3 * f + i] > mesh->corners[3 * f + (i + 1) % 3];
}

static enum hl_result count_faces(struct work *work,
                                  const struct hl_shadow_mesh *out)
{
    enum hl_result result = HL_OK;
    size_t n = work->edges.n;
    work->n_forward = hl_mem_new(&work->hooks, n, sizeof(uint32_t), &result);
    work->n_reverse = hl_mem_new(&work->hooks, n, sizeof(uint32_t), &result);
    if (result != HL_OK || n == 0)
        return result;
    memset(work->n_forward, 0, n * sizeof(uint32_t));
    memset(work->n_reverse, 0, n * sizeof(uint32_t));
    for (size_t f = 0; f < out->n_faces; f++)
        for (size_t i = 0; i < 3; i++) {
            uint32_t e = work->edge_of[3 * f + i];
            if (is_reverse(out, f, i))
                work->n_reverse[e]++;
            else
                work->n_forward[e]++;
        }
    return HL_OK;
}

/* Narrow edges first, each kind in the order of the faces. Returns how many
 * refs the wide ones need. */
static uint32_t place_edges(struct work *work, struct hl_shadow_mesh *out)
{
    uint32_t n_refs = 0, n = work->edges.n, narrow = 0, wide = 0;
    for (uint32_t e = 0; e < n; e++)
        out->n_narrow += work->n_forward[e] + work->n_reverse[e] <= 2;
    for (uint32_t e = 0; e < n; e++) {
        uint32_t forward = work->n_forward[e], reverse = work->n_reverse[e];
        bool is_wide = forward + reverse > 2;
        uint32_t place = is_wide ? out->n_narrow + wide++ : narrow++;
        struct hl_shadow_edge edge = {
            work->edges.keys[2 * (size_t)e],
            work->edges.keys[2 * (size_t)e + 1],
            is_wide ? n_refs : 2 * out->n_faces,
            is_wide ? 0 : 2 * out->n_faces};
        out->edges[place] = edge;
        work->place[e] = place;
        out->max_sides += forward > reverse ? forward : reverse;
        out->stats.n_open += forward + reverse == 1;
        out->stats.n_turned += !is_wide && (forward == 2 || reverse == 2);
        out->stats.n_wide += is_wide;
        n_refs += is_wide ? forward + reverse : 0;
    }
    out->n_edges = n;
    return n_refs;
}

static void link_faces(const struct work *work, struct hl_shadow_mesh *out)
{
    for (uint32_t f = 0; f < out->n_faces; f++)
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t place = work->place[work->edge_of[3 * (size_t)f + i]];
            uint32_t ref = 2 * f + is_reverse(out, f, i);
            struct hl_shadow_edge *edge = &out->edges[place];
            if (place >= out->n_narrow)
                out->refs[edge->first + edge->second++] = ref;
            else if (edge->first == 2 * out->n_faces)
                edge->first = ref;
            else
                edge->second = ref;
        }
}

static enum hl_result fill_edges(struct work *work, struct hl_shadow_mesh *out)
{
    enum hl_result result = HL_OK;
    const struct hl_hooks *hooks = &work->hooks;
    size_t n = work->edges.n;
    uint32_t n_refs = 0;
    work->place = hl_mem_new(hooks, n, sizeof(uint32_t), &result);
    out->edges = hl_mem_new(hooks, n, sizeof *out->edges, &result);
    if (result == HL_OK)
        n_refs = place_edges(work, out);
    out->refs = hl_mem_new(hooks, n_refs, sizeof(uint32_t), &result);
    if (result == HL_OK)
        link_faces(work, out);
    return result;
}

/* ---- whole ------------------------------------------------------------ */

static enum hl_result run_stages(struct work *work, struct hl_shadow_mesh *out)
{
    enum hl_result result = take_faces(work, out);
    if (result == HL_OK)
        result = fill_vertices(work, out);
    if (result == HL_OK)
        result = find_edges(work, out);
    if (result == HL_OK)
        result = count_faces(work, out);
    if (result == HL_OK)
        result = fill_edges(work, out);
    return result;
}

static void work_close(struct work *work)
{
    hl_weld_close(&work->positions);
    hl_weld_close(&work->edges);
    hl_mem_free(&work->hooks, work->edge_of);
    hl_mem_free(&work->hooks, work->n_forward);
    hl_mem_free(&work->hooks, work->n_reverse);
    hl_mem_free(&work->hooks, work->place);
}

enum hl_result hl_shadow_mesh_prepare(struct hl_shadow_mesh *out,
                                      const struct hl_hooks *hooks,
                                      const struct hl_shadow_mesh_desc *desc)
{
    struct work work;
    enum hl_result result;
    if (!out)
        return HL_ERR_INVALID;
    memset(out, 0, sizeof *out);
    if (!desc || !hl_mem_hooks_valid(hooks))
        return HL_ERR_INVALID;
    memset(&work, 0, sizeof work);
    work.hooks = *hooks;
    work.desc = *desc;
    result = take_desc(&work.desc);
    if (result != HL_OK)
        return result;
    hl_weld_open(&work.positions, &work.hooks, 3, &out->stats.n_steps);
    hl_weld_open(&work.edges, &work.hooks, 2, &out->stats.n_steps);
    result = run_stages(&work, out);
    work_close(&work);
    if (result != HL_OK || out->n_faces == 0) {
        struct hl_shadow_mesh_stats stats = out->stats;
        hl_shadow_mesh_free(out, hooks);
        if (result == HL_OK)
            out->stats = stats;
    }
    return result;
}

void hl_shadow_mesh_free(struct hl_shadow_mesh *mesh,
                         const struct hl_hooks *hooks)
{
    if (!mesh)
        return;
    hl_mem_free(hooks, mesh->vertices);
    hl_mem_free(hooks, mesh->corners);
    hl_mem_free(hooks, mesh->faces);
    hl_mem_free(hooks, mesh->edges);
    hl_mem_free(hooks, mesh->refs);
    memset(mesh, 0, sizeof *mesh);
}
