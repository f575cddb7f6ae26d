/* SPDX-License-Identifier: Zlib */
/* Shadows, and stencil volumes of lights. */
#include "core/pipe.h"

/* L texels of a rectangle from which on a light's stencil volume is drawn.
 * Measured with 40 smooth points of one size at 800 x 450, processor time of a
 * frame with volumes against without. lavapipe, lights in the air that reach
 * little: 6,000 texels 1.05, 12,000 1.04, 21,000 1.00, 44,000 0.98, 70,000
 * 0.96; among walls 1.04 from 7,000 to 55,000, then down to 1.01 at 190,000.
 * packemu's screen draws are faster without a stencil than with: 1.02 to 1.11
 * in the air, 2.6 at the most. Two draws more a light, in all some 45
 * microseconds, are earned back from here on at best. */
enum { VOLUME_TEXELS = 20000 };

bool hl_plan_stencil(const struct hl_plan *p, const struct hl_ask *ask)
{
    return p->pipeline == HL_PIPELINE_INFERRED &&
           (ask->n.shadows == HL_SHADOWS_VOLUMES ||
            ask->n.light_path == HL_LIGHT_PATH_VOLUMES);
}

/* Rows that keep a stencil, in the profile's order. */
static const struct hl_profile_format *
stencil_row(const struct hl_caps *caps, int use)
{
    const struct hl_profile_format *list = caps->profile.depth;
    for (int i = 0; i < HL_PROFILE_FORMATS && list[i].format; i++) {
        const struct hl_profile_format *row =
            hl_format_info(list[i].format)->bits[1]
            ? hl_plan_row(caps, list, list[i].format, use, 1) : NULL;
        if (row)
            return row;
    }
    return NULL;
}

enum hl_format hl_plan_light_depth(const struct hl_plan *p,
                                   const struct hl_ask *ask, int use,
                                   const struct hl_profile_format **row)
{
    const enum hl_format depths[] = { HL_FORMAT_D32_FLOAT_S8,
                                      HL_FORMAT_D24_UNORM_S8, HL_FORMAT_NONE };
    if (!hl_plan_stencil(p, ask))
        return hl_plan_depth_format(ask->caps, use, 1, row);
    *row = stencil_row(ask->caps, use);
    if (*row)
        return (*row)->format;
    return ask->caps->profile.depth[0].format
           ? HL_FORMAT_NONE : hl_format_pick(ask->caps, depths, use, 1);
}

enum hl_refusal hl_plan_shadows(struct hl_plan *p, const struct hl_ask *ask)
{
    p->shadows = ask->n.shadows;
    if (p->shadows == HL_SHADOWS_VOLUMES)
        hl_plan_why(p, HL_WHY_SHADOW_VOLUMES, (float)ask->n.n_shadow_lights,
                    0, 0, 0);
    if (hl_plan_stencil(p, ask)) {
        p->infinite_far = true;
        hl_plan_why(p, HL_WHY_INFINITE_FAR, 0, 0, 0, 0);
    }
    if (ask->n.light_path == HL_LIGHT_PATH_VOLUMES) {
        p->volume_texels = ask->n.volume_texels ? ask->n.volume_texels
                                                : VOLUME_TEXELS;
        hl_plan_why(p, HL_WHY_VOLUME_TEXELS, (float)p->volume_texels, 0, 0,
                    0);
    }
    if (p->shadows == HL_SHADOWS_MAPS)
        return hl_plan_shadow_maps(p, ask);
    return HL_REFUSED_NOTHING;
}

void hl_plan_shadowed_pass(struct hl_plan *p)
{
    uint32_t light = 1u << HL_PASS_LIGHT;
    if (p->shadows == HL_SHADOWS_NONE)
        return;
    struct hl_plan_pass *s = hl_plan_add_pass(p, HL_PASS_SHADOWED);
    s->repeat = HL_PER_SHADOW_LIGHT;
    s->color[0] = HL_ROLE_LIGHT;
    s->blend = HL_BLEND_ADD;
    s->lights_a_draw = 1;
    if (p->shadows == HL_SHADOWS_VOLUMES)
        s->depth = HL_ROLE_LIGHT_DEPTH;
    for (uint32_t i = 0; i < p->n_targets; i++)
        if (p->target[i].read_by & light)
            p->target[i].read_by |= 1u << HL_PASS_SHADOWED;
}

/* A volume has about as many triangles as its mesh: half of it in either cap,
 * sides beside that. A third of the scene is taken to cast toward what is
 * seen; volumes cover what they shade twice, without a stage. */
double hl_plan_shadow_cost(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->light_width * p->light_height;
    double lights = ask->n.n_shadow_lights;
    if (p->shadows == HL_SHADOWS_MAPS)
        return hl_plan_map_cost(p, ask);
    if (p->shadows != HL_SHADOWS_VOLUMES)
        return 0;
    double blend = hl_blend_ns(ask->caps,
                               hl_plan_target(p, HL_ROLE_LIGHT)->format);
    double casters = 0.33 * ((double)ask->n.n_objects * (double)c->draw_ns +
                             (double)ask->n.n_triangles *
                             (double)c->vertex_ns);
    return lights * (casters + 2 * (double)c->draw_ns +
                     pixels * (2 * (double)(c->pixel_ns + c->fetch_ns) +
                               blend + (double)c->light_ns));
}
