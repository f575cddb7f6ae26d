/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/mesh_kit.h"

#define PI 3.14159265358979323846

/* ---- hooks ----------------------------------------------------------- */

static void *count_alloc(void *user, size_t bytes)
{
    struct mk_memory *m = user;
    void *memory;
    m->n_allocs++;
    if (m->fail_at &&
        (m->n_allocs == m->fail_at || (m->fail_on && m->n_allocs > m->fail_at)))
        return NULL;
    if (m->max_bytes && bytes > m->max_bytes)
        return NULL;
    memory = malloc(bytes);
    if (!memory)
        abort();
    memset(memory, 0xA5, bytes); /* what is not written is not zero by luck */
    m->n_live++;
    m->n_bytes += bytes;
    return memory;
}

static void count_free(void *user, void *memory)
{
    struct mk_memory *m = user;
    m->n_live--;
    free(memory);
}

struct hl_hooks mk_hooks(struct mk_memory *memory)
{
    struct hl_hooks hooks = {count_alloc, count_free, memory};
    return hooks;
}

uint64_t mk_hash(uint64_t hash, const void *words, size_t n_words)
{
    for (size_t i = 0; i < n_words; i++) {
        uint32_t word;
        memcpy(&word, (const char *)words + 4 * i, sizeof word);
        for (int shift = 0; shift < 32; shift += 8)
            hash = (hash ^ (word >> shift & 255)) * UINT64_C(0x100000001B3);
    }
    return hash;
}

/* ---- random numbers -------------------------------------------------- */

uint64_t mk_seed(void)
{
    const char *text = getenv("HL_TEST_SEED");
    uint64_t seed = text ? strtoull(text, NULL, 0) : 1;
    printf("HL_TEST_SEED=%llu\n", (unsigned long long)seed);
    return seed;
}

/* A counter through two multiply-xorshift rounds. */
uint32_t mk_random(uint64_t *state)
{
    uint64_t x = *state += UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 31) * UINT64_C(0xD1342543DE82EF95);
    x = (x ^ x >> 29) * UINT64_C(0xAF251AF3B0F025B5);
    return (uint32_t)(x >> 32);
}

uint32_t mk_below(uint64_t *state, uint32_t n)
{
    return (uint32_t)((uint64_t)mk_random(state) * n >> 32);
}

float mk_unit(uint64_t *state)
{
    return (float)(mk_random(state) >> 8) * (1.0f / 16777216.0f);
}

/* ---- building -------------------------------------------------------- */

static void *grown(void *memory, size_t count, size_t size)
{
    memory = realloc(memory, count * size);
    if (!memory)
        abort();
    return memory;
}

uint32_t mk_vertex(struct mk_mesh *m, const float position[3],
                    const float normal[3], float u, float v)
{
    size_t i = m->n_vertices;
    if (m->n_vertices == m->vertex_room) {
        m->vertex_room = 2 * m->vertex_room + 64;
        m->position = grown(m->position, m->vertex_room, 3 * sizeof(float));
        m->normal = grown(m->normal, m->vertex_room, 3 * sizeof(float));
        m->uv = grown(m->uv, m->vertex_room, 2 * sizeof(float));
    }
    memcpy(&m->position[3 * i], position, 3 * sizeof(float));
    memcpy(&m->normal[3 * i], normal, 3 * sizeof(float));
    m->uv[2 * i] = u;
    m->uv[2 * i + 1] = v;
    return m->n_vertices++;
}

void mk_triangle(struct mk_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    if (m->n_indices + 3 > m->index_room) {
        m->index_room = 2 * m->index_room + 96;
        m->indices = grown(m->indices, m->index_room, sizeof(uint32_t));
    }
    m->indices[m->n_indices++] = a;
    m->indices[m->n_indices++] = b;
    m->indices[m->n_indices++] = c;
}

void mk_flat(struct mk_mesh *m, const float a[3], const float b[3],
              const float c[3], const float normal[3])
{
    uint32_t v = mk_vertex(m, a, normal, 0, 0);
    mk_vertex(m, b, normal, 1, 0);
    mk_vertex(m, c, normal, 0, 1);
    mk_triangle(m, v, v + 1, v + 2);
}

void mk_free(struct mk_mesh *m)
{
    free(m->position);
    free(m->normal);
    free(m->uv);
    free(m->indices);
    memset(m, 0, sizeof *m);
}

struct hl_mesh_desc mk_desc(const struct mk_mesh *m)
{
    struct hl_mesh_desc desc;
    memset(&desc, 0, sizeof desc);
    desc.positions = m->position;
    desc.normals = m->normal;
    desc.uvs = m->uv;
    desc.n_vertices = m->n_vertices;
    desc.indices = m->indices;
    desc.n_indices = m->n_indices;
    return desc;
}

/* ---- shapes ---------------------------------------------------------- */

void mk_cube(struct mk_mesh *m)
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            uint32_t first = m->n_vertices;
            for (int corner = 0; corner < 4; corner++) {
                float p[3], n[3] = {0, 0, 0};
                float s = corner & 1 ? 1.0f : -1.0f;
                float t = corner & 2 ? 1.0f : -1.0f;
                n[axis] = p[axis] = (float)side;
                p[(axis + 1) % 3] = s * (float)side;
                p[(axis + 2) % 3] = t;
                mk_vertex(m, p, n, (s + 1) / 2, (t + 1) / 2);
            }
            mk_triangle(m, first, first + 1, first + 3);
            mk_triangle(m, first, first + 3, first + 2);
        }
}

void mk_smooth_cube(struct mk_mesh *m)
{
    static const uint8_t face[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5},
                                       {0, 1, 5, 4}, {2, 6, 7, 3},
                                       {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int i = 0; i < 8; i++) {
        float p[3] = {i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f,
                      i & 4 ? 1.0f : -1.0f};
        mk_vertex(m, p, p, p[0], p[1]);
    }
    for (int i = 0; i < 6; i++) {
        mk_triangle(m, face[i][0], face[i][1], face[i][2]);
        mk_triangle(m, face[i][0], face[i][2], face[i][3]);
    }
}

/* Of slice i of n: exactly equal at both ends of the turn. */
static void circle(float out[3], uint32_t i, uint32_t n, double radius,
                   double y)
{
    double angle = 2 * PI * (double)(i % n) / n;
    out[0] = (float)(radius * cos(angle));
    out[1] = (float)y;
    out[2] = (float)(-radius * sin(angle));
}

/* Rows of n + 1 vertices from `first` on become quads, wound outwards. */
static void strips(struct mk_mesh *m, uint32_t first, uint32_t n,
                   uint32_t rows)
{
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + r * (n + 1) + i, b = a + n + 1;
            mk_triangle(m, a, b, b + 1);
            mk_triangle(m, a, b + 1, a + 1);
        }
}

void mk_sphere(struct mk_mesh *m, uint32_t slices, uint32_t stacks)
{
    uint32_t first = m->n_vertices;
    for (uint32_t k = 0; k <= stacks; k++)
        for (uint32_t i = 0; i <= slices; i++) {
            double polar = PI * (double)k / stacks;
            bool pole = k == 0 || k == stacks;
            float p[3];
            circle(p, i, slices, pole ? 0 : sin(polar), cos(polar));
            mk_vertex(m, p, p, (float)i / (float)slices,
                       (float)k / (float)stacks);
        }
    strips(m, first, slices, stacks);
}

static void cap(struct mk_mesh *m, uint32_t slices, float y)
{
    float p[3] = {0, y, 0}, n[3] = {0, y, 0};
    uint32_t centre = mk_vertex(m, p, n, 0, 0);
    for (uint32_t i = 0; i < slices; i++) {
        circle(p, i, slices, 1, y);
        mk_vertex(m, p, n, p[0], p[2]);
    }
    for (uint32_t i = 0; i < slices; i++) {
        uint32_t a = centre + 1 + i, b = centre + 1 + (i + 1) % slices;
        mk_triangle(m, centre, y > 0 ? a : b, y > 0 ? b : a);
    }
}

void mk_cylinder(struct mk_mesh *m, uint32_t slices)
{
    uint32_t first = m->n_vertices;
    for (int row = 0; row < 2; row++)
        for (uint32_t i = 0; i <= slices; i++) {
            float p[3], n[3];
            circle(p, i, slices, 1, row ? -1 : 1);
            circle(n, i, slices, 1, 0);
            mk_vertex(m, p, n, (float)i / (float)slices, (float)row);
        }
    strips(m, first, slices, 1);
    cap(m, slices, 1);
    cap(m, slices, -1);
}

void mk_cone(struct mk_mesh *m, uint32_t slices, bool sharp_tip)
{
    float tip[3] = {0, 1, 0}, p[3], n[3];
    for (uint32_t i = 0; i < slices; i++) {
        uint32_t v = m->n_vertices;
        for (uint32_t k = 0; k < 2; k++) {
            circle(p, i + k, slices, 1, -1);
            circle(n, i + k, slices, 1, 0.5);
            mk_vertex(m, p, n, 0, 0);
        }
        circle(n, 2 * i + 1, 2 * slices, 1, 0.5);
        mk_vertex(m, tip, sharp_tip ? n : tip, 0, 1);
        mk_triangle(m, v, v + 1, v + 2);
    }
    cap(m, slices, -1);
}

void mk_grid(struct mk_mesh *m, uint32_t n)
{
    static const float up[3] = {0, 0, 1};
    for (uint32_t y = 0; y <= n; y++)
        for (uint32_t x = 0; x <= n; x++) {
            float p[3] = {(float)x, (float)y, 0};
            mk_vertex(m, p, up, p[0] / (float)n, p[1] / (float)n);
        }
    for (uint32_t y = 0; y < n; y++)
        for (uint32_t x = 0; x < n; x++) {
            uint32_t a = y * (n + 1) + x, b = a + n + 1;
            mk_triangle(m, a, a + 1, b + 1);
            mk_triangle(m, a, b + 1, b);
        }
}

void mk_soup(struct mk_mesh *m, uint32_t n_triangles, uint32_t n_places,
              uint32_t n_normals, uint64_t *state)
{
    uint32_t seed = mk_random(state);
    for (uint32_t t = 0; t < n_triangles; t++) {
        uint32_t v = m->n_vertices;
        for (int i = 0; i < 3; i++) {
            uint64_t place = seed + mk_below(state, n_places);
            uint64_t turn = mk_below(state, n_normals);
            float p[3], n[3];
            for (int k = 0; k < 3; k++) {
                p[k] = mk_unit(&place) - 0.5f;
                n[k] = mk_unit(&turn) - 0.5f;
            }
            float u = mk_unit(state); /* one by one: arguments have no order */
            mk_vertex(m, p, n, u, mk_unit(state));
        }
        mk_triangle(m, v, v + 1, v + 2);
    }
}

/* ---- what a test starts with ----------------------------------------- */

int mk_setup(void **state)
{
    struct mk_fixture *f = calloc(1, sizeof *f);
    *state = f;
    if (!f)
        return -1;
    f->hooks = mk_hooks(&f->memory);
    return 0;
}

int mk_teardown(void **state)
{
    struct mk_fixture *f = *state;
    size_t live;
    hl_mesh_prep_free(&f->prep, &f->hooks);
    live = f->memory.n_live;
    mk_free(&f->mesh);
    free(f);
    return live == 0 ? 0 : -1;
}
