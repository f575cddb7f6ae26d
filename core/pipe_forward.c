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

/* Every draw of an object pays its vertices and its pixels again. Pixels:
 * half as many again as the frame has, for overdraw of the first draws. */
static double forward_cost(const struct hl_ask *ask, double draws_an_object,
                           double lights_shaded)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)ask->n.width * ask->n.height *
                    (1.0 + 0.06 * (ask->n.samples - 1));
    double objects = ask->n.n_objects;
    return draws_an_object * objects * (double)c->draw_ns +
           draws_an_object * ask->n.n_triangles * (double)c->vertex_ns +
           1.5 * pixels * draws_an_object * (double)(c->pixel_ns + c->blend_ns)
           + 1.5 * pixels * lights_shaded * (double)c->light_ns;
}

static enum hl_refusal finish(struct hl_plan *p, const struct hl_ask *ask,
                              double draws, double lights)
{
    uint32_t w, h;
    const struct hl_plan_target *t = hl_plan_target(p, HL_ROLE_COLOR);
    double texel = hl_format_info(t->format)->bytes + 4.0;
    p->light_error = t->error;
    p->moved_per_pixel = (float)(texel * 2.0 * draws * p->samples);
    hl_plan_decals(p, ask, HL_FORMAT_NONE);
    hl_plan_finish(p, ask, forward_cost(ask, draws, lights));
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
    double draws = 1.0 + extra;
    return finish(p, ask, draws, draws * batch);
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
    double lights = p->scissor ? (double)ask->per_pixel
                               : (double)ask->per_object;
    return finish(p, ask, 1.0 + (double)ask->per_object, lights);
}
