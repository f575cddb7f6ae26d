/* SPDX-License-Identifier: Zlib */
/* Mesh preparation: which triangles count, corner by corner identities, and
 * the output arrays. Groups are found in mesh_group.c, tangents in
 * mesh_tangent.c. */
#include <math.h>
#include <string.h>
#include "core/mesh_work.h"

/* ---- the caller's arrays --------------------------------------------- */

static void take_stride(const void *array, size_t *stride, uint32_t n_floats,
                        uint32_t n, enum hl_result *result)
{
    if (*stride == 0)
        *stride = n_floats * sizeof(float);
    if (array && !hl_mem_fits(n, *stride))
        *result = HL_ERR_LIMIT;
}

static enum hl_result take_desc(struct hl_mesh_desc *d)
{
    enum hl_result result = HL_OK;
    if (d->n_vertices > HL_MESH_MAX_COUNT || d->n_indices > HL_MESH_MAX_COUNT)
        return HL_ERR_LIMIT;
    if (!d->positions && d->n_vertices > 0)
        return HL_ERR_INVALID;
    if (!d->indices && d->n_indices == 0)
        d->n_indices = d->n_vertices;
    else if (!d->indices && d->n_indices != d->n_vertices)
        return HL_ERR_INVALID;
    if (!(d->normal_tolerance >= 0 && d->normal_tolerance <= 2))
        return HL_ERR_INVALID;
    if (d->max_groups == 0 || d->max_groups > HL_MESH_MAX_GROUPS)
        d->max_groups = HL_MESH_MAX_GROUPS;
    take_stride(d->positions, &d->position_stride, 3, d->n_vertices, &result);
    take_stride(d->normals, &d->normal_stride, 3, d->n_vertices, &result);
    take_stride(d->uvs, &d->uv_stride, 2, d->n_vertices, &result);
    take_stride(d->tangents, &d->tangent_stride, 4, d->n_vertices, &result);
    return result;
}

/* ---- triangles that count -------------------------------------------- */

static bool in_range(const struct hl_mesh_desc *d, const uint32_t v[3])
{
    return v[0] < d->n_vertices && v[1] < d->n_vertices &&
           v[2] < d->n_vertices;
}

static bool area_is_zero(float p[3][3])
{
    double a[3], b[3], n[3];
    hl_mesh_edge(a, p[0], p[1]);
    hl_mesh_edge(b, p[0], p[2]);
    hl_mesh_cross(n, a, b);
    return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

/* Keeps the triangle as the next one, or counts why not. */
static void take_triangle(struct hl_mesh_work *work, uint32_t number)
{
    const struct hl_mesh_desc *d = &work->desc;
    uint32_t *v = &work->corner[3 * (size_t)work->n_triangles];
    float p[3][3];
    for (uint32_t i = 0; i < 3; i++)
        v[i] = d->indices ? d->indices[3 * number + i] : 3 * number + i;
    if (!in_range(d, v)) {
        work->stats.n_out_of_range++;
        return;
    }
    hl_mesh_triangle(work, work->n_triangles, p);
    if (!hl_mesh_finite(p[0], 3) || !hl_mesh_finite(p[1], 3) ||
        !hl_mesh_finite(p[2], 3))
        work->stats.n_non_finite++;
    else if (area_is_zero(p))
        work->stats.n_degenerate++;
    else
        work->source_triangle[work->n_triangles++] = number;
}

static enum hl_result take_triangles(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    uint32_t n = work->desc.n_indices / 3;
    const struct hl_hooks *hooks = &work->hooks;
    work->stats.n_partial = work->desc.n_indices % 3 != 0;
    work->corner = hl_mem_new(hooks, n, 3 * sizeof(uint32_t), &result);
    work->source_triangle = hl_mem_new(hooks, n, sizeof(uint32_t), &result);
    if (result != HL_OK)
        return result;
    for (uint32_t i = 0; i < n; i++)
        take_triangle(work, i);
    return HL_OK;
}

/* ---- identities of corners ------------------------------------------- */

/* Key of the triangle's own normal, marked as computed. */
static void face_normal_key(uint32_t key[4], float p[3][3])
{
    double a[3], b[3], n[3];
    float rounded[3];
    hl_mesh_edge(a, p[0], p[1]);
    hl_mesh_edge(b, p[0], p[2]);
    hl_mesh_cross(n, a, b);
    (void)hl_mesh_normalise(n); /* zero area was dropped */
    for (int i = 0; i < 3; i++)
        rounded[i] = (float)n[i];
    hl_mesh_float_key(key, rounded, 3);
    key[3] = 1;
}

static void normal_key(struct hl_mesh_work *work, uint32_t vertex,
                       float p[3][3], uint32_t key[4])
{
    const struct hl_mesh_desc *d = &work->desc;
    float n[3] = {0, 0, 0};
    if (d->normals)
        hl_mesh_read(n, d->normals, d->normal_stride, vertex, 3);
    if (hl_mesh_direction(n)) {
        hl_mesh_float_key(key, n, 3);
        key[3] = 0;
    } else {
        face_normal_key(key, p);
        work->stats.n_face_normals++;
    }
}

static enum hl_result identify_corners(struct hl_mesh_work *work)
{
    enum hl_result result = HL_OK;
    uint32_t n = work->n_triangles;
    work->corner_position =
        hl_mem_new(&work->hooks, n, 3 * sizeof(uint32_t), &result);
    work->corner_normal =
        hl_mem_new(&work->hooks, n, 3 * sizeof(uint32_t), &result);
    for (uint32_t t = 0; t < n && result == HL_OK; t++) {
        float p[3][3];
        hl_mesh_triangle(work, t, p);
        for (size_t i = 0, c = 3 * (size_t)t; i < 3; i++, c++) {
            uint32_t key[4];
            hl_mesh_float_key(key, p[i], 3);
            work->corner_position[c] =
                hl_weld_add(&work->positions, key, &result);
            normal_key(work, work->corner[c], p, key);
            work->corner_normal[c] =
                hl_weld_add(&work->normals, key, &result);
        }
    }
    return result;
}

/* ---- output ---------------------------------------------------------- */

/* An output vertex is an input vertex in one group with one normal and one
 * tangent; only the face's normals differ within an input vertex. */
static enum hl_result find_vertices(struct hl_mesh_work *work,
                                    uint32_t *indices)
{
    enum hl_result result = HL_OK;
    size_t n_corners = 3 * (size_t)work->n_triangles;
    for (size_t c = 0; c < n_corners && result == HL_OK; c++) {
        uint32_t key[4] = {work->corner[c], work->group[c / 3],
                           work->corner_normal[c],
                           work->corner_frame ? work->corner_frame[c] : 0};
        indices[c] = hl_weld_add(&work->vertices, key, &result);
    }
    return result;
}

static void fill_vertex(struct hl_mesh_work *work, struct hl_mesh_prep *out,
                        uint32_t i)
{
    const uint32_t *key = &work->vertices.keys[4 * (size_t)i];
    out->source_vertex[i] = key[0];
    out->group[i] = key[1];
    hl_mesh_key_floats(&out->normal[3 * (size_t)i],
                       &work->normals.keys[4 * (size_t)key[2]], 3);
    if (out->tangent &&
        !hl_mesh_tangent(work, key, &out->tangent[4 * (size_t)i]))
        work->stats.n_free_tangents++;
}

static enum hl_result fill_vertices(struct hl_mesh_work *work,
                                    struct hl_mesh_prep *out)
{
    const struct hl_hooks *hooks = &work->hooks;
    enum hl_result result = HL_OK;
    uint32_t n = work->vertices.n;
    out->source_vertex = hl_mem_new(hooks, n, sizeof(uint32_t), &result);
    out->group = hl_mem_new(hooks, n, sizeof(uint32_t), &result);
    out->normal = hl_mem_new(hooks, n, 3 * sizeof(float), &result);
    if (work->desc.tangents || work->desc.uvs)
        out->tangent = hl_mem_new(hooks, n, 4 * sizeof(float), &result);
    for (uint32_t i = 0; i < n && result == HL_OK; i++)
        fill_vertex(work, out, i);
    return result;
}

/* Arrays of kept triangles change hands; they may be longer than needed. */
static void hand_over(struct hl_mesh_work *work, struct hl_mesh_prep *out)
{
    out->n_vertices = work->vertices.n;
    out->n_triangles = work->n_triangles;
    out->n_indices = 3 * work->n_triangles;
    out->n_groups = work->n_groups;
    out->n_pairs = work->pairs.n;
    out->n_edge_pairs = work->n_edge_pairs;
    out->triangle_group = work->group;
    out->pairs = work->pairs.keys;
    work->group = work->pairs.keys = NULL;
    if (work->n_triangles > 0) {
        out->source_triangle = work->source_triangle;
        work->source_triangle = NULL;
    }
    work->stats.n_positions = work->positions.n;
    out->stats = work->stats;
}

static enum hl_result make_output(struct hl_mesh_work *work,
                                  struct hl_mesh_prep *out)
{
    enum hl_result result = HL_OK;
    out->indices = hl_mem_new(&work->hooks, work->n_triangles,
                              3 * sizeof(uint32_t), &result);
    if (result == HL_OK)
        result = find_vertices(work, out->indices);
    if (result == HL_OK)
        result = fill_vertices(work, out);
    if (result == HL_OK)
        hand_over(work, out);
    return result;
}

/* ---- whole ----------------------------------------------------------- */

static void work_open(struct hl_mesh_work *work, const struct hl_hooks *hooks)
{
    uint64_t *steps = &work->stats.n_steps;
    work->hooks = *hooks;
    hl_weld_open(&work->positions, &work->hooks, 3, steps);
    hl_weld_open(&work->normals, &work->hooks, 4, steps);
    hl_weld_open(&work->frames, &work->hooks, 5, steps);
    hl_weld_open(&work->pairs, &work->hooks, 2, steps);
    hl_weld_open(&work->vertices, &work->hooks, 4, steps);
}

static void work_close(struct hl_mesh_work *work)
{
    const struct hl_hooks *hooks = &work->hooks;
    hl_weld_close(&work->positions);
    hl_weld_close(&work->normals);
    hl_weld_close(&work->frames);
    hl_weld_close(&work->pairs);
    hl_weld_close(&work->vertices);
    hl_mem_free(hooks, work->corner);
    hl_mem_free(hooks, work->source_triangle);
    hl_mem_free(hooks, work->corner_position);
    hl_mem_free(hooks, work->corner_normal);
    hl_mem_free(hooks, work->corner_frame);
    hl_mem_free(hooks, work->group);
    hl_mem_free(hooks, work->frame_sum);
}

static enum hl_result run_stages(struct hl_mesh_work *work,
                                 struct hl_mesh_prep *out)
{
    enum hl_result result = take_triangles(work);
    if (result == HL_OK)
        result = identify_corners(work);
    if (result == HL_OK)
        result = hl_mesh_find_groups(work);
    if (result == HL_OK)
        result = hl_mesh_find_frames(work);
    if (result == HL_OK)
        result = make_output(work, out);
    return result;
}

enum hl_result hl_mesh_prepare(struct hl_mesh_prep *out,
                               const struct hl_hooks *hooks,
                               const struct hl_mesh_desc *desc)
{
    struct hl_mesh_work work;
    enum hl_result result = HL_ERR_INVALID;
    if (!out)
        return HL_ERR_INVALID;
    memset(out, 0, sizeof *out);
    if (!desc || !hl_mem_hooks_valid(hooks))
        return HL_ERR_INVALID;
    memset(&work, 0, sizeof work);
    work.desc = *desc;
    result = take_desc(&work.desc);
    if (result != HL_OK)
        return result;
    work_open(&work, hooks);
    result = run_stages(&work, out);
    work_close(&work);
    if (result != HL_OK)
        hl_mesh_prep_free(out, hooks);
    return result;
}

void hl_mesh_prep_free(struct hl_mesh_prep *prep,
                       const struct hl_hooks *hooks)
{
    if (!prep)
        return;
    hl_mem_free(hooks, prep->source_vertex);
    hl_mem_free(hooks, prep->group);
    hl_mem_free(hooks, prep->normal);
    hl_mem_free(hooks, prep->tangent);
    hl_mem_free(hooks, prep->indices);
    hl_mem_free(hooks, prep->triangle_group);
    hl_mem_free(hooks, prep->source_triangle);
    hl_mem_free(hooks, prep->pairs);
    memset(prep, 0, sizeof *prep);
}

float hl_mesh_pack_tangent_w(float handedness, uint32_t group)
{
    uint32_t held =
        group < HL_MESH_MAX_GROUPS ? group + 1 : HL_MESH_MAX_GROUPS;
    return handedness < 0 ? -(float)held : (float)held;
}

/* In double: w + 0.5f would round to even above 2^23. */
void hl_mesh_unpack_tangent_w(float w, float *handedness, uint32_t *group)
{
    double held = fabs((double)w) + 0.5;
    *handedness = w < 0 ? -1.0f : 1.0f;
    if (held >= HL_MESH_MAX_GROUPS)
        *group = HL_MESH_MAX_GROUPS - 1;
    else
        *group = held >= 1 ? (uint32_t)held - 1 : 0;
}
