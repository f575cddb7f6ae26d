/* SPDX-License-Identifier: Zlib */
/* Forward pipelines: FWD-2, up to eight lights a draw, and FWD-1, one
 * additive draw for each light and object that it touches. */
#include "core/pipe.h"
#include "core/vec.h"

enum { FORWARD_BATCH = 8 };

static void forward_pass(struct hl_plan *p, uint32_t lights_a_draw)
{
    struct hl_plan_pass *f = hl_plan_add_pass(p, HL_PASS_FORWARD);
    f->repeat = HL_PER_OBJECT_LIGHTS;
    f->color[0] = HL_ROLE_COLOR;
    f->depth = HL_ROLE_DEPTH;
    f->depth_write = true;
    f->depth_test = p->reversed_depth ? HL_COMPARE_GREATER
                                      : HL_COMPARE_LESS;
    f->blend = HL_BLEND_ADD;
    f->lights_a_draw = lights_a_draw;
}

/* Further lights' programs are made whatever the frame brings, and blended
 * surfaces blend: the target must, even where no light is known of. */
static uint32_t at_least_one(uint32_t blends) { return blends ? blends : 1; }

static uint32_t up(float x) { return x > 0 ? (uint32_t)ceilf(x) : 0; }

/* What is drawn once: all objects, each with `lights` in its draw. */
static double base_cost(const struct hl_ask *ask, double lights)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    return (double)ask->n.n_objects * (double)c->draw_ns +
           (double)ask->n.n_triangles * (double)c->vertex_ns +
           hl_plan_overdraw(ask) * hl_plan_shaded_pixels(ask) *
           ((double)c->pixel_ns + lights * (double)c->light_ns);
}

/* Draws on top of it, blended where depths are equal; `cover`: fragments a
 * pixel. */
static double further_cost(const struct hl_ask *ask, double draws,
                           double triangles, double cover, double lights)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    return draws * (double)c->draw_ns + triangles * (double)c->vertex_ns +
           cover * hl_plan_shaded_pixels(ask) *
           ((double)(c->pixel_ns + c->blend_ns) +
            lights * (double)c->light_ns);
}

/* A number of the needs, or an estimate where it is unknown. */
static double known(float x, double estimate)
{
    return x > 0 ? (double)x : estimate;
}

static enum hl_refusal finish(struct hl_plan *p, const struct hl_ask *ask,
                              double draws, double cost)
{
    uint32_t w, h;
    const struct hl_plan_target *t = hl_plan_target(p, HL_ROLE_COLOR);
    double texel = hl_format_info(t->format)->bytes + 4.0;
    p->light_error = t->error;
    p->moved_per_pixel = (float)(texel * 2.0 * draws * p->samples);
    hl_plan_decals(p, ask, HL_FORMAT_NONE);
    hl_plan_finish(p, ask, cost);
    return hl_plan_edram(p, ask, &w, &h);
}

enum hl_refusal hl_plan_forward(struct hl_plan *p, const struct hl_ask *ask)
{
    enum hl_refusal r = hl_plan_common(p, ask);
    float an_object = ask->per_object;
    /* A loop runs to its batch: no longer than the scene has lights. */
    uint32_t all = ask->n.n_lights;
    uint32_t batch = all >= FORWARD_BATCH ? FORWARD_BATCH : all ? all : 1;
    uint32_t extra = an_object > (float)batch
                     ? up(an_object / (float)batch) - 1 : 0;
    /* The largest object sees all lights: its pixels blend the most. */
    uint32_t blends = all / batch + (all % batch != 0);
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_frame_targets(p, ask, at_least_one(blends));
    if (r != HL_REFUSED_NOTHING)
        return r;
    p->specular = HL_SPECULAR_CONSTANT;
    p->batch = batch;
    if (ask->n.specular == HL_NEED_NO_SPECULAR)
        p->specular = HL_SPECULAR_NONE;
    hl_plan_why(p, p->specular ? HL_WHY_EXPONENT_CONSTANT
                               : HL_WHY_EXPONENT_NONE, p->exponent, 0, 0, 0);
    forward_pass(p, batch);
    double objects = ask->n.n_objects, triangles = ask->n.n_triangles;
    double cost = base_cost(ask, batch) +
                  further_cost(ask, known(ask->n.further_draws,
                                          extra * objects),
                               known(ask->n.further_triangles,
                                     extra * triangles),
                               known(ask->n.further_cover, extra) *
                               (double)ask->n.cover, batch);
    return finish(p, ask, 1.0 + extra, cost);
}

enum hl_refusal hl_plan_multipass(struct hl_plan *p, const struct hl_ask *ask)
{
    enum hl_refusal r = hl_plan_common(p, ask);
    uint32_t blends = at_least_one(ask->n.n_lights);
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_frame_targets(p, ask, blends);
    if (r != HL_REFUSED_NOTHING)
        return r;
    p->specular = ask->n.specular == HL_NEED_NO_SPECULAR
                  ? HL_SPECULAR_NONE : HL_SPECULAR_CONSTANT;
    hl_plan_why(p, p->specular ? HL_WHY_EXPONENT_CONSTANT
                               : HL_WHY_EXPONENT_NONE, p->exponent, 0, 0, 0);
    p->batch = 1;
    p->scissor = !ask->n.no_scissor;
    hl_plan_why(p, p->scissor ? HL_WHY_SCISSOR : HL_WHY_NO_SCISSOR, 0, 0, 0,
                0);
    forward_pass(p, 1);
    double per_object = (double)ask->per_object;
    /* Scissored: no more than the lights' rectangles. */
    double cover = known(ask->n.pair_cover,
                         per_object * (double)ask->n.cover);
    if (p->scissor && cover > (double)ask->per_pixel)
        cover = (double)ask->per_pixel;
    double cost = base_cost(ask, 0) +
                  further_cost(ask, known(ask->n.pair_draws,
                                          per_object * ask->n.n_objects),
                               known(ask->n.pair_triangles,
                                     per_object * ask->n.n_triangles),
                               cover, 1);
    return finish(p, ask, 1.0 + per_object, cost);
}
