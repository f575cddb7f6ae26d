/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/frame_kit.h"

enum { RINGS = 12, SLICES = 24 };

struct shape { uint32_t first, count; int32_t base; };

struct shapes {
    struct fk_vertex v[2000];
    uint32_t index[4000];
    uint32_t n_v, n_i;
    struct shape shape[3];
};

/* ---- shapes ----------------------------------------------------------- */

static struct fk_vertex *vertex(struct shapes *s, float x, float y, float z,
                                float nx, float ny, float nz, uint32_t group)
{
    struct fk_vertex *v = &s->v[s->n_v++];
    memset(v, 0, sizeof *v);
    v->position[0] = x, v->position[1] = y, v->position[2] = z;
    v->normal[0] = nx, v->normal[1] = ny, v->normal[2] = nz;
    v->tangent[0] = 1;
    v->tangent[3] = hl_mesh_pack_tangent_w(1, group);
    memset(v->color, 255, 4);
    return v;
}

static void triangle(struct shapes *s, int shape, uint32_t a, uint32_t b,
                     uint32_t c)
{
    uint32_t *i = &s->index[s->n_i];
    i[0] = a, i[1] = b, i[2] = c;
    s->n_i += 3;
    s->shape[shape].count += 3;
}

static void begin_shape(struct shapes *s, int shape)
{
    s->shape[shape].first = s->n_i;
    s->shape[shape].base = (int32_t)s->n_v;
}

/* Two triangles with normal n along `axis`, `sign` 1 or -1. */
static void face(struct shapes *s, int shape, int axis, float sign, float at,
                 uint32_t group)
{
    uint32_t first = s->n_v - (uint32_t)s->shape[shape].base;
    for (uint32_t i = 0; i < 4; i++) {
        float p[3], n[3] = { 0, 0, 0 };
        float a = i == 1 || i == 2 ? 1.0f : -1.0f, b = i >= 2 ? 1.0f : -1.0f;
        p[axis] = at * sign;
        p[(axis + 1) % 3] = sign > 0 ? a : b;
        p[(axis + 2) % 3] = sign > 0 ? b : a;
        n[axis] = sign;
        struct fk_vertex *v = vertex(s, p[0], p[1], p[2], n[0], n[1], n[2],
                                     group);
        v->uv[0] = (a + 1) / 2;
        v->uv[1] = (1 - b) / 2;
    }
    triangle(s, shape, first, first + 1, first + 2);
    triangle(s, shape, first, first + 2, first + 3);
}

static void ball(struct shapes *s, int shape)
{
    for (int i = 0; i <= RINGS; i++)
        for (int k = 0; k <= SLICES; k++) {
            double t = 3.14159265358979 * i / RINGS;
            double f = 2 * 3.14159265358979 * k / SLICES;
            float x = (float)(sin(t) * sin(f)), y = (float)cos(t);
            float z = (float)(sin(t) * cos(f));
            vertex(s, x, y, z, x, y, z, 0);
        }
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t k = 0; k < SLICES; k++) {
            uint32_t a = i * (SLICES + 1) + k, b = a + SLICES + 1;
            triangle(s, shape, a, b, b + 1);
            triangle(s, shape, a, b + 1, a + 1);
        }
}

static void make_shapes(struct shapes *s)
{
    memset(s, 0, sizeof *s);
    begin_shape(s, FK_QUAD);
    face(s, FK_QUAD, 2, 1, 0, 0);
    begin_shape(s, FK_BOX);
    for (uint32_t i = 0; i < 6; i++)
        face(s, FK_BOX, (int)(i / 2), i % 2 ? -1.0f : 1.0f, 1, i);
    begin_shape(s, FK_BALL);
    ball(s, FK_BALL);
}

/* ---- scene ------------------------------------------------------------ */

static void make_surfaces(struct fk_scene *s)
{
    for (int i = 0; i < FK_SURFACES; i++) {
        struct hl_surface *f = &s->surface[i];
        struct hl_attr *a = f->layout.attr;
        f->layout.stride[0] = sizeof(struct fk_vertex);
        a[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
        a[HL_ATTR_NORMAL].format = HL_ATTR_F32X3;
        a[HL_ATTR_NORMAL].offset = offsetof(struct fk_vertex, normal);
        a[HL_ATTR_TANGENT].format = HL_ATTR_F32X4;
        a[HL_ATTR_TANGENT].offset = offsetof(struct fk_vertex, tangent);
        if (i != FK_FULL && i != FK_MASKED)
            continue;
        a[HL_ATTR_UV].format = HL_ATTR_F32X2;
        a[HL_ATTR_UV].offset = offsetof(struct fk_vertex, uv);
        a[HL_ATTR_COLOR].format = HL_ATTR_U8X4_UNORM;
        a[HL_ATTR_COLOR].offset = offsetof(struct fk_vertex, color);
        f->textures = HL_TEXTURED_BASE;
        f->vertex_color = true;
    }
    s->surface[FK_MIRRORED].mirrored = true;
    s->surface[FK_TWO_SIDED].two_sided = true;
    s->surface[FK_MASKED].masked = true;
    s->surface[FK_BLENDED].blended = true;
}

void fk_begin(struct fk_scene *s, struct ck_machine *m)
{
    struct shapes *shapes = malloc(sizeof *shapes);
    const float eye[3] = { 0, 0, 10 }, target[3] = { 0, 0, 0 };
    assert_non_null(shapes);
    memset(s, 0, sizeof *s);
    s->m = m;
    make_surfaces(s);
    make_shapes(shapes);
    struct hl_buf_desc v = { "vertices", shapes->n_v * sizeof *shapes->v,
                             HL_BUF_VERTEX, false, shapes->v };
    struct hl_buf_desc i = { "indices", shapes->n_i * 4, HL_BUF_INDEX, false,
                             shapes->index };
    assert_int_equal(hl_buf_create(m->device, &s->vertex, &v), HL_OK);
    assert_int_equal(hl_buf_create(m->device, &s->index, &i), HL_OK);
    free(shapes);
    assert_int_equal(hl_camera_look_at(&s->frame.camera, eye, target, 60,
                                       0.1f, 100), HL_OK);
    s->frame.items = s->item;
    s->frame.lights = s->light;
    s->needs.width = FK_W;
    s->needs.height = FK_H;
    s->next_id = 1;
}

void fk_end(struct fk_scene *s)
{
    hl_buf_destroy(s->m->device, &s->vertex);
    hl_buf_destroy(s->m->device, &s->index);
}

struct hl_item *fk_add(struct fk_scene *s, enum fk_mesh mesh,
                       enum fk_surface surface, float x, float y, float z,
                       float scale)
{
    static const struct shape shape[3] = {
        { 0, 6, 0 }, { 6, 36, 4 }, { 42, RINGS * SLICES * 6, 28 } };
    assert_true(s->frame.n_items < FK_ITEMS);
    struct hl_material *m = &s->material[s->frame.n_items];
    struct hl_item *it = &s->item[s->frame.n_items++];
    const float at[3] = { x, y, z };
    it->surface = surface;
    it->vertex[0] = s->vertex;
    it->index = s->index;
    it->first = shape[mesh].first;
    it->count = shape[mesh].count;
    it->base_vertex = shape[mesh].base;
    it->material = m;
    it->id_base = s->next_id;
    s->next_id += mesh == FK_BOX ? 6 : 1;
    for (int k = 0; k < 3; k++) {
        it->world[k * 5] = scale;
        it->world[12 + k] = at[k];
        it->bounds_min[k] = mesh == FK_QUAD && k == 2 ? 0.0f : -1.0f;
        it->bounds_max[k] = mesh == FK_QUAD && k == 2 ? 0.0f : 1.0f;
        m->base[k] = 1;
    }
    it->world[15] = 1;
    m->base[3] = 1;
    m->roughness = 0.6f;
    m->normal_scale = 1;
    m->alpha_cutoff = 0.5f;
    m->no_specular = true;
    return it;
}

struct hl_material *fk_material(struct fk_scene *s, const struct hl_item *it)
{
    return &s->material[it - s->item];
}

struct hl_light *fk_light(struct fk_scene *s, float x, float y, float z,
                          float radius)
{
    assert_true(s->frame.n_lights < FK_LIGHTS);
    struct hl_light *l = &s->light[s->frame.n_lights++];
    l->position[0] = x, l->position[1] = y, l->position[2] = z;
    l->radius = radius;
    l->color[0] = l->color[1] = l->color[2] = 1;
    return l;
}

/* A quarter turn about x: the quad becomes a floor. */
static void lay_down(struct hl_item *it)
{
    float k = it->world[0];
    it->world[5] = it->world[10] = 0;
    it->world[6] = -k;
    it->world[9] = k;
}

void fk_room(struct fk_scene *s, uint32_t n_lights, uint64_t *seed)
{
    lay_down(fk_add(s, FK_QUAD, FK_PLAIN, 0, -3, 0, 12));
    fk_add(s, FK_QUAD, FK_PLAIN, 0, 0, -8, 14);
    for (int i = 0; i < 12; i++) {
        struct hl_item *it = fk_add(
            s, i % 2 ? FK_BALL : FK_BOX, FK_PLAIN,
            (float)ck_between(seed, -7, 7), (float)ck_between(seed, -2.5, 3),
            (float)ck_between(seed, -7, 3), (float)ck_between(seed, 0.4, 1.2));
        struct hl_material *m = fk_material(s, it);
        for (int c = 0; c < 3; c++)
            m->base[c] = (float)ck_between(seed, 0.2, 1);
    }
    for (uint32_t i = 0; i < n_lights; i++) {
        struct hl_light *l = fk_light(
            s, (float)ck_between(seed, -8, 8), (float)ck_between(seed, -3, 4),
            (float)ck_between(seed, -8, 5), (float)ck_between(seed, 1, 5));
        for (int c = 0; c < 3; c++)
            l->color[c] = (float)ck_between(seed, 0, 1);
    }
    for (int c = 0; c < 3; c++)
        s->frame.ambient[c] = 0.02f * (float)(c + 1);
}

/* ---- renderer --------------------------------------------------------- */

void fk_plan(struct hl_plan *out, struct fk_scene *s,
             enum hl_pipeline pipeline)
{
    enum hl_refusal why;
    hl_needs_measure(&s->needs, &s->frame, s->surface,
                     (float)s->needs.width / (float)s->needs.height);
    enum hl_result r = hl_plan_make(out, pipeline, &s->needs,
                                    hl_device_caps(s->m->device), &why);
    if (r != HL_OK)
        fail_msg("no plan: refusal %d", (int)why);
}

void fk_prepare(struct fk_run *run, struct fk_scene *s,
                enum hl_pipeline pipeline)
{
    memset(run, 0, sizeof *run);
    run->scene = s;
    fk_plan(&run->plan, s, pipeline);
    run->desc.plan = &run->plan;
    run->desc.surfaces = s->surface;
    run->desc.n_surfaces = FK_SURFACES;
    run->desc.max_items = FK_ITEMS;
    run->desc.max_lights = FK_LIGHTS;
    run->desc.frame_bytes = 1 << 22;
    run->desc.list_bytes = 1 << 20;
    run->desc.readback = true;
}

enum hl_result fk_create(struct fk_run *run)
{
    size_t bytes = hl_renderer_bytes(&run->desc);
    assert_true(bytes > 0);
    run->memory = malloc(bytes);
    assert_non_null(run->memory);
    memset(run->memory, 0xA5, bytes);
    return hl_renderer_create(&run->r, run->scene->m->device, &run->desc,
                              run->memory);
}

void fk_destroy(struct fk_run *run)
{
    hl_renderer_destroy(&run->r);
    free(run->memory);
    run->memory = NULL;
}

float *fk_read(struct fk_run *run, enum hl_role role)
{
    struct hl_device *d = run->scene->m->device;
    assert_int_equal(hl_frame_draw(run->r, &run->scene->frame, &run->stats),
                     HL_OK);
    assert_int_equal(hl_submit(d, true), HL_OK);
    return ck_read(d, role ? hl_renderer_target(run->r, role)
                           : hl_renderer_output(run->r), NULL, NULL);
}

float *fk_draw(struct fk_scene *s, enum hl_pipeline pipeline,
               enum hl_role role)
{
    struct fk_run run;
    fk_prepare(&run, s, pipeline);
    assert_int_equal(fk_create(&run), HL_OK);
    float *out = fk_read(&run, role);
    fk_destroy(&run);
    return out;
}

double fk_difference(const float *a, const float *b, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n * 4; i++) {
        double e = fabs((double)a[i] - (double)b[i]);
        if (i % 4 != 3 && !(e <= worst))
            worst = e == e ? e : INFINITY;
    }
    return worst;
}
