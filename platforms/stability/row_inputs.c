/* SPDX-License-Identifier: Zlib */
/* Each float of what a frame is given, one after the other, is made no number,
 * infinite, negative, denormal or far too large. What is documented: what is
 * not finite is refused by HL_ERR_INVALID, all else is drawn, with finite
 * pixels, or refused (plans also by HL_ERR_UNSUPPORTED and a refusal). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/host/scene_clean.h"
#include "platforms/host/util.h"
#include "platforms/stability/rig.h"

enum { SIDE = 24, FLOATS = 24, VALUES = 7 };

enum group { CAMERA, POINT, SPOT, DIRECTIONAL, MATERIAL, OBJECT, COLORS,
             NEEDS, VERTEX };

static const float bad[VALUES] = { NAN, INFINITY, -INFINITY, -0.0f, 1e-42f,
                                   1e38f, -1.0f };

struct own {
    struct hlc_options o;
    struct hlc_shot shot, good;  /* good: as it was made                     */
    bool made;
    struct hl_light lights[3];
    struct hl_material material;
    struct hl_item *items;
};

/* ---- a scene that uses them --------------------------------------------- */

static void flat_map(uint8_t *texel, uint32_t x, uint32_t y)
{
    texel[0] = (uint8_t)(128 + 20 * (x & 1));
    texel[1] = (uint8_t)(128 + 20 * (y & 1));
    texel[2] = 240;
    texel[3] = 255;
}

/* A wall with a normal map, colours and tangents: vertex 0 has float k of its
 * 16 set to `value`, before anything was done about it. */
static void wall(struct hls_rig *rig, int k, float value)
{
    hlh_add_patch(&rig->b, hlh_v3(-0.8, -0.8, 0), hlh_v3(1.6, 0, 0),
                  hlh_v3(0, 1.6, 0), 2, 2);
    for (uint32_t i = 0; !rig->b.failed && i < rig->b.n_vertices; i++) {
        struct hlh_vertex *v = &rig->b.vertices[i];
        v->tangent[0] = v->tangent[3] = 1;
        for (int j = 0; j < 4; j++)
            v->color[j] = 0.5f;
    }
    struct hlh_vertex *v = rig->b.vertices;
    if (!rig->b.failed && k >= 0)
        *(k < 3 ? &v->position[k] : k < 6 ? &v->normal[k - 3]
          : k < 10 ? &v->tangent[k - 6] : k < 12 ? &v->uv[k - 10]
          : &v->color[k - 12]) = value;
    uint32_t mesh = hlh_build_mesh(&rig->b, "wall", 0);
    if (rig->b.failed)
        return;
    rig->scene.meshes[mesh].has_color = true;
    rig->scene.meshes[mesh].has_tangent = true;
    hlh_build_object_at_origin(&rig->b, mesh);
}

static void build(struct hls_rig *rig, int k, float value)
{
    hls_rig_begin(rig, 1, 60);
    struct hlh_material *m = hlh_build_last_material(&rig->b);
    m->normal_texture.image = hlh_build_image(&rig->b, "map", 4, flat_map);
    m->roughness = 0.6f;
    m->emission[0] = 0.1f;
    wall(rig, k, value);
    hls_rig_wall(rig, 0, 0.7, -0.5);
    hlh_build_light(&rig->b, hlh_v3(0.2, 0.1, 0.5), 2,
                    hlh_v3(0.5, 0.5, 0.5));
    hlh_build_spot(&rig->b, hlh_v3(0, 0.2, 0.8), hlh_v3(0, 0, 0), 3, 0.5, 0.7,
                   hlh_v3(0.5, 0.5, 0.5));
    hlh_build_directional(&rig->b, hlh_v3(0, -0.5, -1),
                          hlh_v3(0.2, 0.2, 0.2));
    if (!rig->b.failed)
        rig->scene.lights[1].falloff = HLH_FALLOFF_INVERSE_SQUARE;
}

/* arg: pipeline, enum group. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct own *w = lab->data = calloc(1, sizeof *w);
    if (!w)
        return hls_rig_fail("inputs", HL_ERR_MEMORY);
    (void)skip;
    hls_rig_options(&w->o, lab, SIDE, SIDE);
    w->o.light_width = w->o.light_height = SIDE / 2;
    w->o.pipeline = (enum hl_pipeline)c->arg[0];
    build(&rig, -1, 0);
    if (!hls_rig_end(&rig, lab, &w->o) || !hls_rig_shot(&w->shot, lab, &w->o))
        return false;
    w->made = true;
    w->good = w->shot;
    w->items = malloc(w->shot.frame.n_items * sizeof *w->items);
    return w->items || hls_rig_fail("inputs", HL_ERR_MEMORY);
}

static void end(struct hls_lab *lab)
{
    struct own *w = lab->data;
    if (w && w->made)
        hlc_shot_close(&w->shot);
    free(w ? w->items : NULL);
    free(w);
    lab->data = NULL;
}

/* ---- floats -------------------------------------------------------------- */

struct list { float *at[FLOATS]; int n; };

static void add(struct list *l, float *first, int n)
{
    for (int i = 0; i < n && l->n < FLOATS; i++)
        l->at[l->n++] = first + i;
}

static void add_light(struct list *l, struct hl_light *light)
{
    add(l, light->position, 3);
    add(l, &light->radius, 1);
    add(l, light->direction, 3);
    add(l, &light->inner, 1);
    add(l, &light->outer, 1);
    add(l, light->color, 3);
}

static void add_material(struct list *l, struct hl_material *m)
{
    add(l, m->base, 4);
    add(l, &m->metallic, 1);
    add(l, &m->roughness, 1);
    add(l, m->emission, 3);
    add(l, &m->normal_scale, 1);
    add(l, &m->alpha_cutoff, 1);
}

static void add_needs(struct list *l, struct hl_needs *n)
{
    float *const each[] = {
        &n->lights_per_pixel, &n->lights_per_object, &n->further_draws,
        &n->further_triangles, &n->further_cover, &n->pair_triangles,
        &n->pair_cover, &n->exponent, &n->far, &n->peak, &n->max_error,
        &n->budget_codes, &n->budget_ms, &n->probe.full, &n->probe.half,
        &n->probe.eight, &n->probe.eight_blends, &n->dsf_k, &n->dsf_c,
        &n->dsf_tau
    };
    for (size_t i = 0; i < sizeof each / sizeof *each; i++)
        add(l, each[i], 1);
}

/* All is set back to what is good, then the group's floats are listed. */
static void list_of(struct list *l, struct own *w, enum group group)
{
    struct hl_frame *f = &w->shot.frame;
    l->n = 0;
    *f = w->good.frame;
    memcpy(w->lights, f->lights, sizeof w->lights);
    memcpy(w->items, f->items, f->n_items * sizeof *w->items);
    w->material = *f->items[0].material;
    f->lights = w->lights;
    f->items = w->items;
    w->items[0].material = &w->material;
    if (group == CAMERA) {
        add(l, f->camera.view, 16);
        add(l, &f->camera.tan_half_y, 1);
        add(l, &f->camera.near, 1);
        add(l, &f->camera.far, 1);
        add(l, f->camera.jitter, 2);
    } else if (group <= DIRECTIONAL) {
        add_light(l, &w->lights[group - POINT]);
    } else if (group == MATERIAL) {
        add_material(l, &w->material);
    } else if (group == OBJECT) {
        add(l, w->items[0].world, 16);
        add(l, w->items[0].bounds_min, 3);
        add(l, w->items[0].bounds_max, 3);
    } else if (group == COLORS) {
        add(l, f->ambient, 3);
        add(l, f->background, 3);
    }
}

/* ---- outcomes ------------------------------------------------------------ */

static int not_finite(const struct hlh_picture *p)
{
    int n = 0;
    for (size_t i = 0; i < (size_t)p->width * p->height; i++) {
        const float *c = p->rgb + 3 * i;
        n += !(isfinite(c[0]) && isfinite(c[1]) && isfinite(c[2]));
    }
    return n;
}

/* What is not finite is refused wherever it is read: a point light has no
 * direction and no angles, a directional one no position, radius or angles. */
static bool must_refuse(enum group group, int k, float value)
{
    if (isfinite(value) || group == NEEDS || group == VERTEX)
        return false;
    bool place = k < 4, turn = k >= 4 && k < 7, angle = k == 7 || k == 8;
    return !(group == POINT && (turn || angle)) &&
           !(group == DIRECTIONAL && (place || angle));
}

/* Pixels that are no numbers; one more than there are for a result that is not
 * documented. */
static int drawn(struct hlc_shot *shot, bool refused)
{
    struct hlh_picture picture;
    enum hl_result r = hlc_shot_draw(shot, NULL);
    if (r == HL_ERR_INVALID)
        return 0;
    if (r != HL_OK || refused || hlc_shot_read(shot, &picture) != HL_OK)
        return SIDE * SIDE + 1;
    int n = not_finite(&picture);
    free(picture.rgb);
    return n;
}

/* The part of a plan that a renderer goes by. */
static struct hl_plan drawing_part(const struct hl_plan *p)
{
    struct hl_plan q = *p;
    q.bytes_per_pixel = q.moved_per_pixel = q.light_error = 0;
    q.cost_ms = q.error_codes = 0;
    q.n_reasons = 0;
    memset(q.reason, 0, sizeof q.reason);
    for (uint32_t i = 0; i < HL_PLAN_TARGETS; i++)
        q.target[i].error = 0;
    return q;
}

static bool plan_finite(const struct hl_plan *p)
{
    const float f[] = {
        p->exponent, p->dsf_k, p->dsf_c, p->dsf_tau, p->light_scale,
        p->light_out, p->far, p->bytes_per_pixel, p->moved_per_pixel,
        p->light_error, p->cost_ms, p->error_codes
    };
    for (size_t i = 0; i < sizeof f / sizeof *f; i++)
        if (!isfinite(f[i]))
            return false;
    return true;
}

/* Plans that are drawn as the good one is are not drawn again. */
static int planned(struct own *w, struct hls_lab *lab, int k, float value)
{
    struct hlc_shot shot = w->good;
    struct list l = { { 0 }, 0 };
    enum hl_refusal why = HL_REFUSED_NOTHING;
    shot.renderer = NULL;
    shot.memory = NULL;
    add_needs(&l, &shot.needs);
    *l.at[k] = value;
    enum hl_result r = hl_plan_make(&shot.plan, w->o.pipeline, &shot.needs,
                                    &lab->stage.machine.caps, &why);
    if (r == HL_ERR_INVALID || r == HL_ERR_UNSUPPORTED)
        return why == HL_REFUSED_NOTHING;
    if (r != HL_OK || !plan_finite(&shot.plan))
        return 1;
    struct hl_plan a = drawing_part(&shot.plan);
    struct hl_plan b = drawing_part(&w->good.plan);
    if (!memcmp(&a, &b, sizeof a))
        return 0;
    if (hlc_shot_make(&shot, NULL) != HLC_DONE)
        return 1;
    int n = drawn(&shot, false);
    hlc_shot_close(&shot);
    return n;
}

/* As a file would be loaded: refused, mended, or without the triangle. */
static int loaded(struct own *w, struct hls_lab *lab, int k, float value)
{
    const struct hlc_world_options options = { .ids = w->o.ids_scheme };
    struct hls_rig rig;
    struct hlc_world world;
    struct hlh_error error;
    int n = 0;
    build(&rig, k, value);
    rig.scene.name = hlh_strdup("inputs");
    free(rig.b.vertices);
    free(rig.b.indices);
    bool ok = rig.scene.name && !rig.b.failed &&
              hlh_scene_finish(&rig.scene, "inputs", false, &error);
    if (ok && hlc_world_create(&world, lab->stage.machine.device, &rig.scene,
                               &options, &error)) {
        hlc_frame(&w->shot.frame, &world, &w->good.frame.camera);
        n = drawn(&w->shot, false);
        hl_submit(lab->stage.machine.device, true);
        hlc_world_free(&world);
    }
    hlh_scene_free(&rig.scene);
    return n;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    enum group group = (enum group)c->arg[1];
    int k = (int)p;
    *m = 0;
    for (int i = 0; i < VALUES; i++) {
        struct list l;
        int n;
        list_of(&l, w, group);
        if (group == NEEDS) {
            n = planned(w, lab, k, bad[i]);
        } else if (group == VERTEX) {
            n = loaded(w, lab, k, bad[i]);
        } else {
            *l.at[k] = bad[i];
            n = drawn(&w->shot, must_refuse(group, k, bad[i]));
        }
        if (n && *m == 0)
            snprintf(lab->note, sizeof lab->note, "float %d = %g: %d", k,
                     (double)bad[i], n);
        *m += n;
    }
    return true;
}

#define ALL(n) 0, (n) - 1, 0, false, NAN, NAN, \
               "none: refused, or finite (core/scene.h)"
#define INFERRED HL_PIPELINE_INFERRED
#define FORWARD HL_PIPELINE_FORWARD

static const struct hls_case cases[] = {
    { "camera", "view, tangent, near, far, jitter", ALL(21),
      { INFERRED, CAMERA } },
    { "point", "position, radius, direction, angles, colour", ALL(12),
      { INFERRED, POINT } },
    { "spot", "the same of a spot light", ALL(12), { INFERRED, SPOT } },
    { "directional", "the same of a directional light", ALL(12),
      { INFERRED, DIRECTIONAL } },
    { "material", "base, metal, roughness, emission, scale, cutoff", ALL(11),
      { INFERRED, MATERIAL } },
    { "object", "transform and bounds", ALL(22), { INFERRED, OBJECT } },
    { "colors", "ambient and background", ALL(6), { INFERRED, COLORS } },
    { "needs", "numbers and choices of a plan", ALL(20), { INFERRED, NEEDS } },
    { "vertex", "position, normal, tangent, uv, colour", ALL(16),
      { INFERRED, VERTEX } },
    { "camera-forward", "camera, forward", ALL(21), { FORWARD, CAMERA } },
    { "spot-forward", "a spot light, forward", ALL(12), { FORWARD, SPOT } },
    { "material-forward", "material, forward", ALL(11),
      { FORWARD, MATERIAL } },
    { "object-forward", "transform and bounds, forward", ALL(22),
      { FORWARD, OBJECT } },
    { "needs-forward", "numbers and choices, forward", ALL(20),
      { FORWARD, NEEDS } },
};

const struct hls_row hls_row_inputs = {
    "inputs", "A number that is none reaches the picture or breaks the frame",
    "conformance section c; 60, 61", "index of the float", "",
    "results that no document allows", HLS_WHOLE, cases,
    sizeof cases / sizeof *cases, begin, end, measure
};
