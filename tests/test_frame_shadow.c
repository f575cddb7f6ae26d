/* SPDX-License-Identifier: Zlib */
/* Stencil shadow volumes in frames, on every backend and by every profile's
 * rules, against rays from each texel's point to the light. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/shadow_mesh.h"
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { LW = 100, LH = 56, TEXELS = LW * LH };

static const char *const profiles[] = { "native", "dx10", "ps3", "xbox360" };

struct rig {
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    struct hl_shadow_mesh mesh[2];   /* of FK_QUAD and FK_BOX                */
    hl_buf vertices[2];
    uint32_t id[TEXELS];             /* of what is seen; 0: nothing          */
};

/* ---- casters ------------------------------------------------------------ */

static const float quad[4][3] = { { -1, -1, 0 }, { 1, -1, 0 }, { 1, 1, 0 },
                                  { -1, 1, 0 } };

static void prepare(struct rig *g, int i, const float (*p)[3], uint32_t n_v,
                    const uint32_t *index, uint32_t n)
{
    struct hl_shadow_mesh_desc d = { p, 0, index, n, n_v };
    struct hl_hooks hooks = mk_hooks(&g->m.memory);
    assert_int_equal(hl_shadow_mesh_prepare(&g->mesh[i], &hooks, &d), HL_OK);
    struct hl_buf_desc b = { "casters", 32 * (size_t)n_v, HL_BUF_VERTEX, false,
                             g->mesh[i].vertices };
    b.bytes = 32 * (size_t)g->mesh[i].n_vertices;
    assert_int_equal(hl_buf_create(g->m.device, &g->vertices[i], &b), HL_OK);
}

/* The kit's quad and box, by positions alone. Faces start at the vertex that
 * they start at there: some rasterizers interpolate depth from the first, and
 * caps must have the mesh's own depths. */
static void prepare_meshes(struct rig *g)
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
static struct hl_item *put(struct rig *g, enum fk_mesh mesh,
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

static struct hl_item *put_box(struct rig *g, float x, float y, float z,
                               double turn)
{
    const float scale[3] = { 1, 0.5f, 0.7f }, at[3] = { x, y, z };
    return put(g, FK_BOX, FK_PLAIN, scale, turn, at);
}

/* A floor at y = -3 and a wall at z = -8, which cast nothing. */
static void put_room(struct rig *g)
{
    const float flat[3] = { 12, 12, 12 }, wall[3] = { 0, 0, -8 };
    struct hl_item *it = fk_add(&g->s, FK_QUAD, FK_PLAIN, 0, -3, 0, 12);
    it->world[5] = it->world[10] = 0;
    it->world[6] = -12;
    it->world[9] = 12;
    put(g, FK_QUAD, FK_PLAIN, flat, 0, wall)->no_shadow = true;
}

static struct hl_light *put_light(struct rig *g, float x, float y, float z)
{
    struct hl_light *l = fk_light(&g->s, x, y, z, 40);
    l->shadow = true;
    return l;
}

static void look(struct rig *g, const float eye[3], const float at[3],
                 float near, float far)
{
    assert_int_equal(hl_camera_look_at(&g->s.frame.camera, eye, at, 60, near,
                                       far), HL_OK);
}

/* ---- rays --------------------------------------------------------------- */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* out = inverse of the item's 3 x 3 times v. */
static void to_model(double out[3], const float m[16], const double v[3])
{
    double c[3][3], x[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            c[i][k] = (double)m[4 * i + k];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            const double *a = c[(i + 1) % 3], *b = c[(i + 2) % 3];
            x[i][k] = a[(k + 1) % 3] * b[(k + 2) % 3] -
                      a[(k + 2) % 3] * b[(k + 1) % 3];
        }
    for (int i = 0; i < 3; i++)
        out[i] = dot(x[i], v) / dot(c[0], x[0]);
}

/* Where the ray first meets the item, least < t; quads from the side of their
 * normal alone unless `both`. */
static bool hit(const struct hl_item *it, const double from[3],
                const double along[3], double least, bool both, double *t)
{
    double o[3], d[3], p[3], low = -1e30, high = 1e30;
    bool is_quad = it->bounds_max[2] == 0;
    for (int k = 0; k < 3; k++)
        p[k] = from[k] - (double)it->world[12 + k];
    to_model(o, it->world, p);
    to_model(d, it->world, along);
    for (int k = 0; k < (is_quad ? 2 : 3); k++) {
        double a = (-1 - o[k]) / d[k], b = (1 - o[k]) / d[k];
        low = fmax(low, fmin(a, b));
        high = fmin(high, fmax(a, b));
    }
    if (is_quad) {
        *t = -o[2] / d[2];
        return *t > least && *t >= low && *t <= high && (both || d[2] < 0);
    }
    *t = low > least ? low : high;
    return low <= high && *t > least;
}

/* A quad casts where the light is before it: rays go to the light, so they
 * leave through the normal's side. A box cannot hide itself from where it
 * faces the light, and is dark elsewhere. */
static bool hidden(const struct rig *g, const struct hl_item *own,
                   const double p[3], const struct hl_light *l)
{
    double along[3], t;
    bool parallel = l->kind == HL_DIRECTIONAL;
    if (!l->shadow)
        return false;
    for (int k = 0; k < 3; k++)
        along[k] = parallel ? -(double)l->direction[k]
                            : (double)l->position[k] - p[k];
    for (uint32_t i = 0; i < g->s.frame.n_items; i++) {
        const struct hl_item *it = &g->s.item[i];
        bool both = it->surface == FK_TWO_SIDED;
        double back[3] = { -along[0], -along[1], -along[2] }, o[3];
        if (!it->shadow_mesh || it->no_shadow || it == own ||
            it->surface == FK_BLENDED)
            continue;
        to_model(o, it->world, back);
        if (it->bounds_max[2] == 0 && !both && o[2] >= 0)
            continue;
        if (hit(it, p, along, 0, true, &t) && (parallel || t < 1))
            return true;
    }
    return false;
}

/* The point of the item seen at texel x, y; false: it is not there. */
static bool point_at(double p[3], const struct rig *g,
                     const struct hl_item *it, double x, double y)
{
    const struct hl_camera *c = &g->s.frame.camera;
    double ty = (double)c->tan_half_y, tx = ty * FK_W / FK_H, t;
    double v[3] = { tx * (2 * x / LW - 1), ty * (1 - 2 * y / LH), -1 };
    double from[3], along[3];
    for (int k = 0; k < 3; k++) {
        const float *m = c->view;
        double e[3] = { (double)m[4 * k], (double)m[4 * k + 1],
                        (double)m[4 * k + 2] };
        double back[3] = { -(double)m[12], -(double)m[13], -(double)m[14] };
        from[k] = dot(e, back);
        along[k] = dot(e, v);
    }
    if (!hit(it, from, along, (double)c->near, true, &t))
        return false;
    for (int k = 0; k < 3; k++)
        p[k] = from[k] + along[k] * t;
    return true;
}

/* 1 hidden, 0 not, -1 within a texel of the other. */
static int shade_of(const struct rig *g, const struct hl_item *it, int i,
                    const struct hl_light *l)
{
    int n = 0, seen = 0;
    for (int k = 0; k < 9; k++) {
        double p[3];
        if (!point_at(p, g, it, i % LW + 0.5 + k % 3 - 1,
                      i / LW + 0.5 + k / 3 - 1))
            continue;
        seen++;
        n += hidden(g, it, p, l);
    }
    return n == 0 ? 0 : n == seen ? 1 : -1;
}

/* ---- frames ------------------------------------------------------------- */

static void draw(struct rig *g, struct hlc_texels *light)
{
    assert_int_equal(hl_frame_draw(g->run.r, &g->s.frame, &g->run.stats),
                     HL_OK);
    assert_int_equal(hlc_texels_read(light, g->m.device,
                                     hl_renderer_target(g->run.r,
                                                        HL_ROLE_LIGHT)),
                     HL_OK);
}

static void read_ids(struct rig *g)
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, g->m.device,
                                     hl_renderer_target(g->run.r,
                                                        HL_ROLE_DSF)), HL_OK);
    for (size_t i = 0; i < TEXELS; i++) {
        float x[4], v[2];
        hlc_texel(x, &t, i);
        hlc_two16(v, g->run.plan.two16, x);
        g->id[i] = (uint32_t)(v[1] * g->run.plan.id_steps + 0.5f);
    }
    hlc_texels_free(&t);
}

static const struct hl_item *item_of(const struct rig *g, uint32_t id)
{
    const struct hl_item *it = NULL;
    for (uint32_t i = 0; id && i < g->s.frame.n_items; i++)
        if (g->s.item[i].id_base <= id)
            it = &g->s.item[i];
    return it;
}

/* Lights `which`, without any shadow. */
static void draw_bare(struct rig *g, uint32_t which, struct hlc_texels *out)
{
    struct fk_scene *s = &g->s;
    struct hl_item items[FK_ITEMS];
    struct hl_light lights[FK_LIGHTS];
    memcpy(items, s->item, sizeof items);
    memcpy(lights, s->light, sizeof lights);
    for (uint32_t i = 0; i < s->frame.n_items; i++)
        s->item[i].no_shadow = true;
    for (uint32_t i = 0; i < s->frame.n_lights; i++)
        s->light[i].radius *= which >> i & 1 ? 1.0f : 0.0f;
    for (uint32_t i = 0; i < s->frame.n_lights; i++)
        if (!(which >> i & 1))
            memset(s->light[i].color, 0, sizeof s->light[i].color);
    draw(g, out);
    assert_int_equal(g->run.stats.shadow_casters, 0);
    memcpy(s->item, items, sizeof items);
    memcpy(s->light, lights, sizeof lights);
}

/* `of`: dark texels of an item, and all others of it that are sure. */
struct seen { uint32_t dark, lit, unsure, of[FK_ITEMS][2]; };

/* Each texel has the bits of the frame with just those lights that reach it. */
static struct seen check(struct rig *g, const char *name)
{
    uint32_t n = g->s.frame.n_lights, wrong = 0, cast = 0;
    struct hlc_texels got, bare[4];
    struct seen seen;
    memset(&seen, 0, sizeof seen);
    draw(g, &got);
    for (uint32_t k = 0; k < n; k++)
        cast += g->s.light[k].shadow;
    assert_int_equal(g->run.stats.shadow_lights, cast);
    read_ids(g);
    for (uint32_t k = 0; k < 1u << n; k++)
        draw_bare(g, k, &bare[k]);
    size_t size = hl_format_info(got.format)->bytes;
    for (int i = 0; i < TEXELS; i++) {
        const struct hl_item *it = item_of(g, g->id[i]);
        uint32_t which = 0;
        bool sure = it != NULL;
        for (uint32_t k = 0; k < n && sure; k++) {
            int shade = shade_of(g, it, i, &g->s.light[k]);
            which |= shade == 0 ? 1u << k : 0;
            sure = shade >= 0;
        }
        if (!sure) {
            seen.unsure += it != NULL;
            continue;
        }
        const uint8_t *a = got.bytes + (size_t)i * size;
        const uint8_t *b = bare[which].bytes + (size_t)i * size;
        const uint8_t *all = bare[(1u << n) - 1].bytes + (size_t)i * size;
        /* Dark where it would be lit. */
        bool dark = memcmp(b, all, size) != 0;
        seen.dark += dark;
        seen.of[it - g->s.item][!dark]++;
        seen.lit += memcmp(b, bare[0].bytes + (size_t)i * size, size) != 0;
        wrong += memcmp(a, b, size) != 0;
    }
    if (wrong)
        fail_msg("%s on %s: %u texels are wrong (%u dark, %u lit)", name,
                 g->run.plan.profile, wrong, seen.dark, seen.lit);
    hlc_texels_free(&got);
    for (uint32_t k = 0; k < 1u << n; k++)
        hlc_texels_free(&bare[k]);
    return seen;
}

/* ---- cases -------------------------------------------------------------- */

static void box_over_floor(struct rig *g)
{
    put_box(g, 0, -1, 0, 0.4);
    put_light(g, 0.5f, 1.5f, 0.5f);
}

/* The eye is under the box, looking out over the floor that it darkens. */
static void eye_in_shadow(struct rig *g)
{
    const float eye[3] = { 0.3f, -2, 1 }, at[3] = { 0, -2.6f, -3 };
    const float wide[3] = { 4, 0.2f, 4 }, over[3] = { 0, -1, 0 };
    put(g, FK_BOX, FK_PLAIN, wide, 0.2, over);
    put_light(g, 0, 4, 1);
    look(g, eye, at, 0.1f, 100);
}

/* The near plane, 0.5 m away and 1 m wide, goes through a side, and the box
 * that casts it is behind the eye. */
static void near_plane_in_side(struct rig *g)
{
    const float eye[3] = { 0, 0, 6 }, at[3] = { 0, -1, -8 };
    const float slab[3] = { 2, 2, 0.3f }, behind[3] = { 2, 0, 8 };
    put(g, FK_BOX, FK_PLAIN, slab, 0, behind);
    put_light(g, 0, 1.5f, 14);
    look(g, eye, at, 0.5f, 100);
}

/* From z = 2 to 18 m beyond far, which is 12 m from the eye. */
static void caster_beyond_far(struct rig *g)
{
    const float eye[3] = { 0, 0, 4 }, at[3] = { 0, -1, -4 };
    const float beam[3] = { 0.4f, 0.4f, 16 }, mid[3] = { -1, -1, -14 };
    put(g, FK_BOX, FK_PLAIN, beam, 0, mid);
    put_light(g, 3, 4, 0);
    look(g, eye, at, 0.1f, 12);
}

/* One beneath another: their shadows add up, and would cancel if one of them
 * were inside out. */
static void mirrored(struct rig *g)
{
    const float scale[3] = { -1, 0.6f, 0.8f }, at[3] = { 1, -1.5f, 0 };
    put(g, FK_BOX, FK_MIRRORED, scale, 0.5, at);
    put_box(g, 0, 0.5f, 0.5f, 0);
    put_light(g, -1, 3, 1);
}

/* The light without shadows leaves no trace for the one with them. */
static void beside_a_plain_light(struct rig *g)
{
    put_box(g, 0, -1, 0, 0.4);
    put_light(g, 0.5f, 1.5f, 0.5f);
    struct hl_light *l = fk_light(&g->s, 3, -2, 1, 4);
    l->color[0] = 0.4f;
}

/* Sheets: one that faces the light, one that does not and casts none, one of
 * two sides that is lit from behind. */
static void open_meshes(struct rig *g)
{
    const float scale[3] = { 0.8f, 1, 1 }, a[3] = { -3, -1, 0 };
    const float b[3] = { 0, -1, 0 }, c[3] = { 3, -1, 0 };
    put(g, FK_QUAD, FK_PLAIN, scale, 0.2, a);
    put(g, FK_QUAD, FK_PLAIN, scale, 3.0, b);
    put(g, FK_QUAD, FK_TWO_SIDED, scale, 3.0, c);
    put_light(g, 0, 1, 5);
}

/* Large ones in many directions, lit and seen from their backs. */
static void turned_sheets(struct rig *g)
{
    const float scale[3] = { 1.1f, 1.3f, 1 };
    for (int i = 0; i < 5; i++) {
        const float at[3] = { 2.3f * (float)(i - 2), 0.2f * (float)i - 1,
                              -0.7f * (float)i };
        struct hl_item *it = put(g, FK_QUAD, FK_TWO_SIDED, scale,
                                 2.5 + 0.31 * i, at);
        /* Sheared, so that depth slopes both ways. */
        it->world[6] = 0.3f * (float)(i - 1);
    }
    put_light(g, 0.3f, 1, 6);
}

static void two_lights(struct rig *g)
{
    put_box(g, 0, -1, 0, 0.4);
    put_box(g, 1.5f, 0, -3, 0.9);
    put_light(g, 3, 4, 2)->color[0] = 0.3f;
    put_light(g, -3, 4, 3)->color[2] = 0.3f;
}

static void sun_and_spot(struct rig *g)
{
    const float post[3] = { 0.5f, 1.5f, 0.5f }, at[3] = { -2, -1.5f, 0 };
    put(g, FK_BOX, FK_PLAIN, post, 0.4, at);
    put_box(g, 1, -1, -1, 0.9);
    struct hl_light *l = put_light(g, 0, 0, 0);
    l->kind = HL_DIRECTIONAL;
    l->direction[0] = 0.64f, l->direction[1] = -0.6f, l->direction[2] = -0.48f;
    l = put_light(g, 1, 3, 0);
    l->kind = HL_SPOT;
    l->direction[1] = -1;
    l->inner = 0.3f, l->outer = 0.9f;
}

/* The box that casts is all behind the eye, and so is the light. */
static void caster_behind(struct rig *g)
{
    const float eye[3] = { 0, 0, 4 }, at[3] = { 0, -1, -8 };
    put_box(g, 0, 0, 7, 0.3);
    put_light(g, 0.2f, 0.5f, 10);
    look(g, eye, at, 0.1f, 100);
}

/* Three that overlap, behind one another. */
static void put_panes(struct rig *g)
{
    const float scale[3] = { 4, 2.4f, 1 };
    for (int i = 0; i < 3; i++) {
        const float at[3] = { 0.3f * (float)i, -0.8f, 0.5f - 1.2f * (float)i };
        struct hl_item *it = put(g, FK_QUAD, FK_BLENDED, scale, 0, at);
        fk_material(&g->s, it)->base[3] = 0.5f;
    }
}

static const struct {
    const char *name;
    void (*put)(struct rig *);
    uint32_t dark, lit;              /* texels, at least                     */
} cases[] = {
    { "box over floor", box_over_floor, 50, 1000 },
    { "eye in shadow", eye_in_shadow, 500, 300 },
    { "near plane in side", near_plane_in_side, 300, 300 },
    { "caster behind", caster_behind, 300, 300 },
    { "caster beyond far", caster_beyond_far, 40, 300 },
    { "mirrored", mirrored, 40, 1000 },
    { "open meshes", open_meshes, 70, 1000 },
    { "beside a plain light", beside_a_plain_light, 50, 1000 },
    { "turned sheets", turned_sheets, 50, 1000 },
    { "two lights", two_lights, 50, 1000 },
    { "sun and spot", sun_and_spot, 25, 1000 },
};

/* ---- rig ---------------------------------------------------------------- */

static void clear_scene(struct rig *g)
{
    const float eye[3] = { 0, 1, 9 }, at[3] = { 0, -1, 0 };
    g->s.frame.n_items = g->s.frame.n_lights = 0;
    memset(g->s.item, 0, sizeof g->s.item);
    memset(g->s.light, 0, sizeof g->s.light);
    memset(g->s.material, 0, sizeof g->s.material);
    g->s.next_id = 1;
    look(g, eye, at, 0.1f, 100);
    put_room(g);
}

/* Planned for the most that any case has. */
static void open_rig(struct rig *g, const char *backend, const char *profile,
                     bool volumes, bool translucent, uint32_t indices)
{
    memset(g, 0, sizeof *g);
    ck_open_as(&g->m, backend, profile);
    fk_begin(&g->s, &g->m);
    prepare_meshes(g);
    clear_scene(g);
    sun_and_spot(g);
    if (translucent)
        put_panes(g);
    g->s.needs.translucency = HL_TRANSLUCENCY_2X2;
    g->s.needs.light_width = LW;
    g->s.needs.light_height = LH;
    g->s.needs.shadows = HL_SHADOWS_VOLUMES;
    g->s.needs.n_shadow_lights = 2;
    if (volumes)
        g->s.needs.light_path = HL_LIGHT_PATH_VOLUMES;
    g->s.needs.volume_texels = 1;
    fk_prepare(&g->run, &g->s, HL_PIPELINE_INFERRED);
    g->run.desc.n_surfaces = translucent ? FK_SURFACES : FK_BLENDED;
    g->run.desc.shadow_indices = indices;
    assert_int_equal(fk_create(&g->run), HL_OK);
}

static void close_rig(struct rig *g)
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

static void light_ends_at_what_hides_it(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct rig g;
    for (int i = 0; i < 4; i++) {
        open_rig(&g, backend, profiles[i], i % 2 == 1, false, 0);
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
            clear_scene(&g);
            cases[k].put(&g);
            struct seen n = check(&g, cases[k].name);
            if (i == 0)
                print_message("%s: %u dark, %u lit, %u not tried\n",
                              cases[k].name, n.dark, n.lit, n.unsure);
            assert_true(n.dark >= cases[k].dark);
            assert_true(n.lit >= cases[k].lit);
        }
        close_rig(&g);
    }
}

/* ---- translucent surfaces ----------------------------------------------- */

/* Each layer is dark where a post before all of them hides the light from
 * it, which is elsewhere on each; and casts nothing on those behind. */
static void stippled_layers_are_dark_each(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct rig g;
    const float post[3] = { 0.5f, 1.5f, 0.2f }, at[3] = { -1.2f, -1, 1.5f };
    for (int i = 0; i < 4; i++) {
        open_rig(&g, backend, profiles[i], false, true, 0);
        assert_int_equal(g.run.plan.stipple, 2);
        clear_scene(&g);
        put(&g, FK_BOX, FK_PLAIN, post, 0.1, at);
        put_panes(&g);
        put_light(&g, -3, 0.5f, 4);
        struct seen n = check(&g, "panes");
        assert_int_equal(g.run.stats.stippled, 3);
        for (int k = 3; k < 6; k++) {
            if (i == 0)
                print_message("pane %d: %u dark, %u other\n", k, n.of[k][0],
                              n.of[k][1]);
            assert_true(n.of[k][0] >= 20 && n.of[k][1] >= 60);
        }
        close_rig(&g);
    }
}

/* ---- room --------------------------------------------------------------- */

/* A box's volume has 6 lit triangles or fewer: 18 indices a cap and 36 of its
 * outline. With room for one of them the frame waits, and is the same. */
static void too_little_room_only_waits(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    static struct rig g;
    struct hlc_texels at_once, waited;
    open_rig(&g, backend, "native", false, false, 0);
    clear_scene(&g);
    two_lights(&g);
    draw(&g, &at_once);
    assert_int_equal(g.run.stats.shadow_casters, 4);
    uint32_t triangles = g.run.stats.shadow_triangles;
    close_rig(&g);
    open_rig(&g, backend, "native", false, false, 72);
    clear_scene(&g);
    two_lights(&g);
    draw(&g, &waited);
    assert_int_equal(g.run.stats.shadow_casters, 4);
    assert_int_equal(g.run.stats.shadow_triangles, triangles);
    size_t bytes = TEXELS * hl_format_info(waited.format)->bytes;
    assert_memory_equal(at_once.bytes, waited.bytes, bytes);
    hlc_texels_free(&at_once);
    hlc_texels_free(&waited);
    close_rig(&g);
    open_rig(&g, backend, "native", false, false, 20);
    clear_scene(&g);
    two_lights(&g);
    CK_REFUSED(&g.m, hl_frame_draw(g.run.r, &g.s.frame, NULL), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "shadow_indices");
    close_rig(&g);
}

/* ---- plans -------------------------------------------------------------- */

static void only_inferred_plans_have_shadows(void **state)
{
    (void)state;
    struct hl_caps caps;
    struct hl_plan p;
    struct hl_needs n = { .width = 1280, .height = 720, .n_lights = 1,
                          .n_objects = 1, .shadows = HL_SHADOWS_VOLUMES,
                          .n_shadow_lights = 1 };
    enum hl_refusal why;
    ck_lavapipe(&caps);
    for (int i = 1; i < HL_PIPELINE_INFERRED; i++) {
        assert_int_equal(hl_plan_make(&p, (enum hl_pipeline)i, &n, &caps,
                                      &why), HL_ERR_UNSUPPORTED);
        assert_int_equal(why, HL_REFUSED_SHADOWS);
    }
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &caps, NULL),
                     HL_OK);
    assert_int_equal(p.pipeline, HL_PIPELINE_INFERRED);
    assert_int_equal(p.shadows, HL_SHADOWS_VOLUMES);
    assert_true(p.infinite_far);
    float cost = p.cost_ms;
    n.n_shadow_lights = 2;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &caps, NULL),
                     HL_OK);
    assert_true(p.cost_ms > cost);
    n.shadows = HL_SHADOWS_NONE;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &caps, NULL),
                     HL_OK);
    assert_true(p.cost_ms < cost && !p.infinite_far);
    for (uint32_t i = 0; i < p.n_passes; i++)
        assert_true(p.pass[i].role != HL_PASS_SHADOWED);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(light_ends_at_what_hides_it),
        DRAWN(stippled_layers_are_dark_each),
        DRAWN(too_little_room_only_waits),
        cmocka_unit_test(only_inferred_plans_have_shadows),
    };
    return cmocka_run_group_tests_name("shadows of frames", tests, NULL, NULL);
}
