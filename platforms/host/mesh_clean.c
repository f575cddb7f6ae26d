/* SPDX-License-Identifier: Zlib */
/* Repairs that design section 4's fine print asks of every mesh. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"

/* A unit float vector is within 1.1e-7 of length 1 (three roundings of half
 * an ulp); four times that is left alone, so that normalising is idempotent
 * and a written scene reads back bit for bit. */
#define UNIT_SLACK 4.4e-7
#define UV_LIMIT 1e6f
#define NONE UINT32_MAX

static bool finite3(const float v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

/* False where v has no direction. */
static bool normalise(float v[3])
{
    double x = v[0], y = v[1], z = v[2], length;
    if (!finite3(v))
        return false;
    length = sqrt(x * x + y * y + z * z);
    if (!(length > 0))
        return false;
    if (fabs(length - 1) > UNIT_SLACK) {
        v[0] = (float)(x / length);
        v[1] = (float)(y / length);
        v[2] = (float)(z / length);
    }
    return true;
}

/* Cross product of two edges; float differences cannot overflow a double,
 * nor can the square of their product. */
static bool face_normal(float out[3], const struct hlh_vertex *a,
                        const struct hlh_vertex *b,
                        const struct hlh_vertex *c)
{
    double u[3], v[3], n[3], length;
    if (!finite3(a->position) || !finite3(b->position) ||
        !finite3(c->position))
        return false;
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b->position[i] - a->position[i];
        v[i] = (double)c->position[i] - a->position[i];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0))
        return false;
    /* + 0: a normal of -0 would keep equal vertices from being merged. */
    for (int i = 0; i < 3; i++)
        out[i] = (float)(n[i] / length) + 0.0f;
    return true;
}

static bool corner_normal(float out[3], const struct hlh_mesh *mesh,
                          const uint32_t *corner)
{
    return face_normal(out, &mesh->vertices[corner[0]],
                       &mesh->vertices[corner[1]], &mesh->vertices[corner[2]]);
}

static uint32_t drop_degenerate(struct hlh_mesh *mesh)
{
    uint32_t kept = 0, n_triangles = mesh->n_indices / 3;
    float n[3];
    for (uint32_t i = 0; i < n_triangles; i++) {
        if (!corner_normal(n, mesh, &mesh->indices[3 * i]))
            continue;
        memmove(&mesh->indices[3 * kept++], &mesh->indices[3 * i],
                3 * sizeof *mesh->indices);
    }
    mesh->n_indices = kept * 3;
    return n_triangles - kept;
}

static float clamp_or(float v, float low, float high, float if_nan)
{
    if (v != v)
        return if_nan;
    return v < low ? low : v > high ? high : v;
}

static void clean_attributes(struct hlh_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        struct hlh_vertex *v = &mesh->vertices[i];
        for (int k = 0; k < 2; k++)
            v->uv[k] = clamp_or(v->uv[k], -UV_LIMIT, UV_LIMIT, 0) + 0.0f;
        for (int k = 0; k < 4; k++)
            v->color[k] = mesh->has_color ? clamp_or(v->color[k], 0, 1, 1) : 1;
        if (mesh->has_tangent && normalise(v->tangent))
            v->tangent[3] = v->tangent[3] < 0 ? -1.0f : 1.0f;
        else
            memset(v->tangent, 0, sizeof v->tangent);
    }
}

/* Three vertices a triangle, each with the face's normal. */
static bool make_flat(struct hlh_mesh *mesh)
{
    struct hlh_vertex *flat = hlh_alloc(mesh->n_indices, sizeof *flat);
    if (!flat)
        return false;
    for (uint32_t i = 0; i < mesh->n_indices; i += 3) {
        float n[3] = {0};
        corner_normal(n, mesh, &mesh->indices[i]);
        for (uint32_t k = i; k < i + 3; k++) {
            flat[k] = mesh->vertices[mesh->indices[k]];
            memcpy(flat[k].normal, n, sizeof n);
            memset(flat[k].tangent, 0, sizeof flat[k].tangent);
        }
    }
    for (uint32_t i = 0; i < mesh->n_indices; i++)
        mesh->indices[i] = i;
    free(mesh->vertices);
    mesh->vertices = flat;
    mesh->n_vertices = mesh->n_indices;
    mesh->has_tangent = false;
    return hlh_mesh_merge(mesh);
}

/* Copies of one broken vertex are chained through next; the copy that has
 * this normal already is taken, else a new one is appended. */
static uint32_t repaired_copy(struct hlh_mesh *mesh, uint32_t *next,
                              uint32_t vertex, const float n[3])
{
    uint32_t v = vertex;
    for (;; v = next[v]) {
        if (memcmp(mesh->vertices[v].normal, n, 3 * sizeof *n) == 0)
            return v;
        if (next[v] == NONE)
            break;
    }
    next[v] = mesh->n_vertices++;
    v = next[v];
    next[v] = NONE;
    mesh->vertices[v] = mesh->vertices[vertex];
    memcpy(mesh->vertices[v].normal, n, 3 * sizeof *n);
    return v;
}

/* Gives each broken corner its face's normal. state[v]: 0 sound, 1 broken and
 * not yet met, 2 broken and holding the first face's normal. */
static bool repair_corners(struct hlh_mesh *mesh, unsigned char *state,
                           uint32_t n_broken, struct hlh_scene *scene)
{
    uint32_t room = mesh->n_vertices + mesh->n_indices, n_file, *next;
    struct hlh_vertex *grown;
    float n[3] = {0};
    if (!n_broken)
        return true;
    if (room < mesh->n_vertices)
        return false;
    grown = realloc(mesh->vertices, (size_t)room * sizeof *grown);
    if (!grown)
        return false;
    mesh->vertices = grown;
    next = hlh_alloc(room, sizeof *next);
    if (!next)
        return false;
    n_file = mesh->n_vertices;
    for (uint32_t i = 0; i < mesh->n_indices; i++) {
        uint32_t v = mesh->indices[i];
        if (i % 3 == 0)
            corner_normal(n, mesh, &mesh->indices[i]);
        if (v >= n_file || !state[v])
            continue;
        if (state[v] == 1) {
            memcpy(mesh->vertices[v].normal, n, sizeof n);
            next[v] = NONE;
            state[v] = 2;
            scene->normals_repaired++;
        }
        mesh->indices[i] = repaired_copy(mesh, next, v, n);
    }
    free(next);
    return true;
}

static bool repair_normals(struct hlh_mesh *mesh, struct hlh_scene *scene)
{
    unsigned char *state = hlh_alloc_zero(mesh->n_vertices, 1);
    uint32_t n_broken = 0;
    bool ok;
    if (!state)
        return false;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        if (!normalise(mesh->vertices[i].normal)) {
            state[i] = 1;
            n_broken++;
        }
    ok = repair_corners(mesh, state, n_broken, scene);
    free(state);
    return ok;
}

static bool drop_unused(struct hlh_mesh *mesh)
{
    uint32_t *moved = hlh_alloc_zero(mesh->n_vertices, sizeof *moved);
    uint32_t kept = 0;
    if (!moved)
        return false;
    for (uint32_t i = 0; i < mesh->n_indices; i++)
        moved[mesh->indices[i]] = 1;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        if (moved[i]) {
            mesh->vertices[kept] = mesh->vertices[i];
            moved[i] = kept++;
        }
    for (uint32_t i = 0; i < mesh->n_indices; i++)
        mesh->indices[i] = moved[mesh->indices[i]];
    mesh->n_vertices = kept;
    free(moved);
    return true;
}

bool hlh_mesh_clean(struct hlh_mesh *mesh, bool has_normals,
                    struct hlh_scene *scene)
{
    scene->triangles_dropped += drop_degenerate(mesh);
    if (!drop_unused(mesh))
        return false;
    clean_attributes(mesh);
    if (!has_normals)
        return make_flat(mesh);
    return repair_normals(mesh, scene);
}

static uint32_t hash_vertex(const struct hlh_vertex *v)
{
    const unsigned char *bytes = (const unsigned char *)v;
    uint32_t h = 2166136261u;                    /* FNV-1a */
    for (size_t i = 0; i < sizeof *v; i++)
        h = (h ^ bytes[i]) * 16777619u;
    return h ^ (h >> 15);
}

bool hlh_mesh_merge(struct hlh_mesh *mesh)
{
    uint32_t n_slots = 16, kept = 0, *slot, *moved;
    while (n_slots / 2 < mesh->n_vertices)
        n_slots *= 2;
    slot = hlh_alloc(n_slots, sizeof *slot);
    moved = hlh_alloc(mesh->n_vertices, sizeof *moved);
    if (!slot || !moved) {
        free(slot);
        free(moved);
        return false;
    }
    memset(slot, 0xff, n_slots * sizeof *slot);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        struct hlh_vertex v = mesh->vertices[i];
        uint32_t at = hash_vertex(&v) & (n_slots - 1);
        while (slot[at] != NONE &&
               memcmp(&mesh->vertices[slot[at]], &v, sizeof v) != 0)
            at = (at + 1) & (n_slots - 1);
        if (slot[at] == NONE) {
            slot[at] = kept;
            mesh->vertices[kept++] = v;
        }
        moved[i] = slot[at];
    }
    for (uint32_t i = 0; i < mesh->n_indices; i++)
        mesh->indices[i] = moved[mesh->indices[i]];
    mesh->n_vertices = kept;
    free(slot);
    free(moved);
    return true;
}
