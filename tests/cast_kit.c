/* SPDX-License-Identifier: Zlib */
#include <math.h>
#include <string.h>
#include "tests/cast_kit.h"

/* ---- casters ------------------------------------------------------------ */

static const float quad[4][3] = { { -1, -1, 0 }, { 1, -1, 0 }, { 1, 1, 0 },
                                  { -1, 1, 0 } };

static void prepare(struct cs_rig *g, int i, const float (*p)[3], uint32_t n_v,
                    const uint32_t *index, uint32_t n)
{
    struct hl_shadow_mesh_desc d = { p, 0, index, n, n_v };
    struct hl_hooks hooks = mk_hooks(&g->m.memory);
    assert_int_equal(hl_shadow_mesh_prepare(&g->mesh[i], &hooks, &d), HL_OK);
    struct hl_buf_desc b = { "casters", 32 * (size_t)g->mesh[i].n_vertices,
                             HL_BUF_VERTEX, false, g->mesh[i].vertices };
    assert_int_equal(hl_buf_create(g->m.device, &g->vertices[i], &b), HL_OK);
}

/* The kit's quad and box, by positions alone. Faces start at the vertex that
 * they start at there: some rasterizers interpolate depth from the first, and
 * caps must have the mesh's own depths. */
static void prepare_meshes(struct cs_rig *g)
{
    static const uint32_t square[6] = { 0, 1, 2, 0, 2, 3 };
    float p[24][3];
    uint32_t index[36];
    prepare(g, FK_QUAD, quad, 4, square, 6);
    for (uint32_t i = 0; i < 24; i++) {
        uint32_t axis = i / 8, back = i / 4 % 2;
        p[i][axis] = back ? -1.0f : 1.0f;
        p[i][(axis + 1) % 3] = quad[i % 4][back];
        p[i][(axis + 2) % 3] = quad[i % 4][1 - back];
    }
    for (uint32_t i = 0; i < 36; i++)
        index[i] = i / 6 * 4 + square[i % 6];
    prepare(g, FK_BOX, (const float (*)[3])p, 24, index, 36);
}

/* Scaled, turned about y, moved. */
struct hl_item *cs_put(struct cs_rig *g, enum fk_mesh mesh,
                           enum fk_surface surface, const float scale[3],
                           double turn, const float at[3])
{
    struct hl_item *it = fk_add(&g->s, mesh, surface, at[0], at[1], at[2], 1);
    float c = (float)cos(turn), s = (float)sin(turn);
    const float m[16] = { c * scale[0], 0, -s * scale[0], 0,
                          0, scale[1], 0, 0,
                          s * scale[2], 0, c * scale[2], 0,
                          at[0], at[1], at[2], 1 };
    memcpy(it->world, m, sizeof m);
    it->shadow_mesh = &g->mesh[mesh];
    it->shadow_vertices = g->vertices[mesh];
    return it;
}

struct hl_item *cs_box(struct cs_rig *g, float x, float y, float z,
                               double turn)
{
    const float scale[3] = { 1, 0.5f, 0.7f }, at[3] = { x, y, z };
    return cs_put(g, FK_BOX, FK_PLAIN, scale, turn, at);
}

/* A floor at y = -3 and a wall at z = -8, which cast nothing. */
static void put_room(struct cs_rig *g)
{
    const float flat[3] = { 12, 12, 12 }, wall[3] = { 0, 0, -8 };
    struct hl_item *it = fk_add(&g->s, FK_QUAD, FK_PLAIN, 0, -3, 0, 12);
    it->world[5] = it->world[10] = 0;
    it->world[6] = -12;
    it->world[9] = 12;
    cs_put(g, FK_QUAD, FK_PLAIN, flat, 0, wall)->no_shadow = true;
}

struct hl_light *cs_light(struct cs_rig *g, float x, float y, float z)
{
    struct hl_light *l = fk_light(&g->s, x, y, z, 40);
    l->shadow = true;
    return l;
}

void cs_look(struct cs_rig *g, const float eye[3], const float at[3],
                 float near, float far)
{
    assert_int_equal(hl_camera_look_at(&g->s.frame.camera, eye, at, 60, near,
                                       far), HL_OK);
}

/* ---- rig ---------------------------------------------------------------- */

void cs_clear(struct cs_rig *g)
{
    const float eye[3] = { 0, 1, 9 }, at[3] = { 0, -1, 0 };
    g->s.frame.n_items = g->s.frame.n_lights = 0;
    memset(g->s.item, 0, sizeof g->s.item);
    memset(g->s.light, 0, sizeof g->s.light);
    memset(g->s.material, 0, sizeof g->s.material);
    g->s.next_id = 1;
    cs_look(g, eye, at, 0.1f, 100);
    put_room(g);
}

void cs_open(struct cs_rig *g, const char *backend, const char *profile,
             bool volumes, void (*fill)(struct cs_rig *), uint32_t indices)
{
    memset(g, 0, sizeof *g);
    ck_open_as(&g->m, backend, profile);
    fk_begin(&g->s, &g->m);
    prepare_meshes(g);
    cs_clear(g);
    fill(g);
    g->s.needs.translucency = HL_TRANSLUCENCY_2X2;
    g->s.needs.light_width = CS_W;
    g->s.needs.light_height = CS_H;
    g->s.needs.shadows = HL_SHADOWS_VOLUMES;
    g->s.needs.n_shadow_lights = 2;
    if (volumes)
        g->s.needs.light_path = HL_LIGHT_PATH_VOLUMES;
    g->s.needs.volume_texels = 1;
    fk_prepare(&g->run, &g->s, HL_PIPELINE_INFERRED);
    g->run.desc.n_surfaces = g->s.needs.blended ? FK_SURFACES : FK_BLENDED;
    g->run.desc.shadow_indices = indices;
    assert_int_equal(fk_create(&g->run), HL_OK);
}

void cs_close(struct cs_rig *g)
{
    struct hl_hooks hooks = mk_hooks(&g->m.memory);
    fk_destroy(&g->run);
    for (int i = 0; i < 2; i++) {
        hl_buf_destroy(g->m.device, &g->vertices[i]);
        hl_shadow_mesh_free(&g->mesh[i], &hooks);
    }
    fk_end(&g->s);
    ck_close(&g->m);
}
