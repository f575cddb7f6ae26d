/* SPDX-License-Identifier: Zlib */
/* How translucent surfaces are lit: forward, each draw with all lights of
 * its object, or stippled into the G-buffer (K 4). */
#include "core/pipe.h"
#include "core/stipple.h"

/* Texel fetches of a stippled pixel, of light and of the DSF each. */
enum { TAPS = 4 };

static uint32_t side_of(enum hl_translucency t)
{
    return t == HL_TRANSLUCENCY_4X4 ? 4 : t == HL_TRANSLUCENCY_2X2 ? 2 : 0;
}

/* Nanoseconds a translucent pixel, beyond what both ways pay. */
static double forward_ns(const struct hl_ask *ask)
{
    return (double)ask->per_object * (double)ask->caps->cost.light_gather_ns;
}

/* Taps, and the geometry draw: its L texels (two numbers' worth of targets,
 * most of them discarded, but shaded up to there), and the draw itself, of an
 * object as large as if all together covered the frame once and a half. The
 * light pass costs the same: texels only change owners. What format light
 * will have, where it is not asked for, is not known yet. */
static double stippled_ns(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->width * p->height;
    double texels = (double)p->light_width * p->light_height;
    double fetch = (double)c->fetch_ns;
    double light = ask->n.light_format
                   ? hl_fetch_ns(ask->caps, ask->n.light_format) : fetch;
    return TAPS * (fetch + light) +
           2 * (double)c->pixel_ns * texels / pixels +
           (double)c->draw_ns * ask->n.n_objects / (1.5 * pixels);
}

/* Decals that are translucent surfaces lie on top of them as one layer. */
static uint32_t layers_of(const struct hl_plan *p, const struct hl_ask *ask)
{
    uint32_t n = ask->n.blended_layers;
    bool decals = p->decals == HL_DECALS_ALPHA_OBJECTS;
    return n && decals && ask->n.blended ? n + 1 : n;
}

/* Forward draws have no shadows, and plain bilinear filtering would mix what
 * lies in front with what lies behind. */
static enum hl_translucency choose(const struct hl_plan *p,
                                   const struct hl_ask *ask, uint32_t layers)
{
    bool shadows = ask->n.shadows != HL_SHADOWS_NONE;
    if (ask->n.translucency != HL_TRANSLUCENCY_AUTO)
        return ask->n.translucency;
    if (ask->n.dsf == HL_DSF_NONE ||
        (!shadows && forward_ns(ask) <= stippled_ns(p, ask)))
        return HL_TRANSLUCENCY_FORWARD;
    return layers > HL_STIPPLE_2X2 ? HL_TRANSLUCENCY_4X4
                                          : HL_TRANSLUCENCY_2X2;
}

enum hl_refusal hl_plan_translucency(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    bool decals = p->decals == HL_DECALS_ALPHA_OBJECTS;
    uint32_t layers = layers_of(p, ask);
    if (!ask->n.blended && !decals)
        return HL_REFUSED_NOTHING;
    p->translucency = choose(p, ask, layers);
    p->stipple = side_of(p->translucency);
    if (!p->stipple)
        return HL_REFUSED_NOTHING;
    p->stipple_mode = ask->n.stipple_mode;
    p->stipple_cone = ask->n.stipple_filter != HL_STIPPLE_BILINEAR;
    hl_plan_why(p, HL_WHY_STIPPLED, (float)p->stipple,
                (float)forward_ns(ask), (float)stippled_ns(p, ask), 0);
    if (layers)
        hl_plan_why(p, HL_WHY_STIPPLE_LAYERS, (float)layers,
                    (float)(p->stipple * p->stipple - 1), 0, 0);
    hl_plan_why(p, HL_WHY_STIPPLE_FILTER, p->stipple_cone, 0, 0, 0);
    return HL_REFUSED_NOTHING;
}
