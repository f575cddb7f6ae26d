/* SPDX-License-Identifier: Zlib */
/* The discontinuity sensitive filter of the material pass. */
#include "core/pipe.h"

/* Taps are compared with the surface; EXACT has one, OFF takes all. */
static bool rejects(const struct hl_plan *p)
{
    return p->dsf == HL_DSF_SLOPE || p->dsf == HL_DSF_CONSTANT;
}

/* Nanoseconds to fetch a texel of light. */
static double light_fetch(const struct hl_plan *p, const struct hl_ask *ask)
{
    return hl_fetch_ns(ask->caps, hl_plan_target(p, HL_ROLE_LIGHT)->format);
}

/* Fetches of twelve more samples, and besides of one's light. They serve 2 %
 * of the pixels at most in the built-in scenes: a machine that pays them for
 * every pixel (fig8 on lavapipe: 28 % of the frame) does better without. */
enum { LOOK_AROUND = 16 };

static void choose_fill(struct hl_plan *p, const struct hl_ask *ask)
{
    if (!rejects(p))
        return;
    const struct hl_cost_model *c = &ask->caps->cost;
    double fetch = (double)c->fetch_ns, light = light_fetch(p, ask);
    double around = (double)c->untaken * (LOOK_AROUND * fetch + light);
    double pixel = (double)c->pixel_ns + 4 * fetch + 4 * light;
    p->fill = ask->n.fill;
    /* Below fifteen layers one texel in sixteen is an opaque surface's. */
    if (p->fill == HL_FILL_AUTO)
        p->fill = around > pixel / 10 && p->stipple != 4 ? HL_FILL_DEPTH
                                                         : HL_FILL_NEAREST;
    hl_plan_why(p, HL_WHY_FILL, (float)p->fill, (float)around, (float)pixel,
                0);
}

/* Can the L-buffer be sampled as numbers and filtered? */
static bool can_filter(const struct hl_ask *ask,
                       const struct hl_plan_target *light)
{
    return ask->caps->format[light->format].use & HL_USE_LINEAR;
}

/* Nanoseconds a pixel for its light: four fetches, or one filtered and, where
 * a tap is rejected, four: 6 to 68 % of pixels in seven built-in scenes, half
 * of which have less than a quarter. A machine without a filter of its own
 * fetches four to filter and weighs them: on a plane without rejections that
 * cost 4 to 12 ns more than a gather on lavapipe and 5 to 8 on packemu, which
 * is about ten fetches in all. */
static void fetch_costs(const struct hl_plan *p, const struct hl_ask *ask,
                        double *gathered, double *filtered)
{
    double fetch = light_fetch(p, ask);
    bool software = ask->caps->kind == HL_DEVICE_CPU;
    double rejected = rejects(p) ? 0.25 : 0.0;
    *gathered = 4 * fetch;
    *filtered = ((software ? 10 : 1) + rejected * 4) * fetch;
}

/* AUTO leaves machines that sample words alone: stages of an engine's own are
 * made for one or the other (inferred.glsl). */
static void choose_fetch(struct hl_plan *p, const struct hl_ask *ask)
{
    double gathered, filtered;
    struct hl_plan_target *light = NULL;
    for (uint32_t i = 0; i < p->n_targets; i++)
        if (p->target[i].role == HL_ROLE_LIGHT)
            light = &p->target[i];
    if (!light || p->dsf == HL_DSF_EXACT || !can_filter(ask, light))
        return;
    fetch_costs(p, ask, &gathered, &filtered);
    p->dsf_bilinear = ask->n.fetch == HL_FETCH_BILINEAR ||
                      (ask->n.fetch == HL_FETCH_AUTO && p->float_taps &&
                       filtered < gathered);
    /* As numbers, which words were in place of. */
    if (p->dsf_bilinear && !p->float_taps)
        light->sample_as = HL_FORMAT_NONE;
    hl_plan_why(p, HL_WHY_FETCH, p->dsf_bilinear ? 1 : 0, (float)gathered,
                (float)filtered, 0);
}

void hl_plan_dsf(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_needs *n = &ask->n;
    p->dsf_k = n->dsf_k > 0 ? n->dsf_k : 1.5f;
    p->dsf_c = n->dsf_c > 0 ? n->dsf_c : 0.001f;
    p->dsf_tau = n->dsf_tau > 0 ? n->dsf_tau : 0.01f;
    bool same = p->light_width == p->width && p->light_height == p->height;
    if (n->dsf == HL_DSF_NONE) {
        p->dsf = HL_DSF_OFF;
        hl_plan_why(p, HL_WHY_DSF_OFF, 0, 0, 0, 0);
    } else if (n->dsf == HL_DSF_CONSTANT_TAU) {
        p->dsf = HL_DSF_CONSTANT;
        hl_plan_why(p, HL_WHY_DSF_CONSTANT, p->dsf_tau, 0, 0, 0);
    /* Under stippled surfaces the one sample may be another surface's. */
    } else if (same && n->samples <= 1 && !p->stipple) {
        p->dsf = HL_DSF_EXACT;
        hl_plan_why(p, HL_WHY_DSF_EXACT, 0, 0, 0, 0);
    } else {
        p->dsf = HL_DSF_SLOPE;
        hl_plan_why(p, HL_WHY_DSF_SLOPE, p->dsf_k, p->dsf_c,
                    n->far / hl_plan_pair_steps(p->two16), 0);
    }
    choose_fill(p, ask);
    choose_fetch(p, ask);
    hl_plan_centroid(p, ask);
}
