/* SPDX-License-Identifier: Zlib */
/* Further G-buffer channels, each only where a scene needs it (K 2.1). */
#include "core/exact.h"
#include "core/pipe.h"

static struct hl_plan_target *add_channel(struct hl_plan *p,
                                          enum hl_role role,
                                          enum hl_format format)
{
    return hl_plan_add_target(p, role, format, p->light_width,
                              p->light_height, 1);
}

/* A target of the DSF's kind, which every machine has that gets here, and
 * which is of the one format where a pass may have but one. */
static struct hl_plan_target *add_pair(struct hl_plan *p,
                                       const struct hl_ask *ask,
                                       enum hl_role role)
{
    const struct hl_profile_format *row = hl_plan_row(
        ask->caps, ask->caps->profile.two16, HL_FORMAT_NONE,
        HL_USE_TARGET | HL_USE_SAMPLED, 1);
    enum hl_format f = hl_plan_target(p, HL_ROLE_DSF)->format;
    struct hl_plan_target *t = add_channel(p, role, f);
    hl_plan_keep(p, t, ask->caps, row, true);
    return t;
}

/* Exponents are kept as log2(n) / 8: half a step of that, as a share of n. */
static float exponent_error(float step)
{
    return (float)hl_exact_exp2((double)step * (8 * 0.5)) - 1.0f;
}

/* Beside the BRDF the exponent costs nothing: there is no other format to
 * choose, and nothing that a machine could lack. */
static void choose_brdfs(struct hl_plan *p, const struct hl_ask *ask)
{
    struct hl_plan_target *t = add_pair(p, ask, HL_ROLE_EXPONENT);
    t->read_by = 1u << HL_PASS_LIGHT;
    t->error = exponent_error(1.0f / hl_plan_pair_steps(p->two16));
    p->specular = ask->n.specular == HL_NEED_NO_SPECULAR ? HL_SPECULAR_NONE
                  : ask->n.specular == HL_NEED_ONE_EXPONENT
                  ? HL_SPECULAR_CONSTANT : HL_SPECULAR_CHANNEL;
    if (p->specular == HL_SPECULAR_CHANNEL)
        hl_plan_why(p, HL_WHY_EXPONENT_CHANNEL, (float)t->format, t->error, 0,
                    0);
    else if (p->specular == HL_SPECULAR_CONSTANT)
        hl_plan_why(p, HL_WHY_EXPONENT_CONSTANT, p->exponent, 0, 0, 0);
    else
        hl_plan_why(p, HL_WHY_EXPONENT_NONE, 0, 0, 0, 0);
    hl_plan_why(p, HL_WHY_BRDFS, (float)t->format, 0, 0, 0);
}

static void choose_exponent(struct hl_plan *p, const struct hl_ask *ask)
{
    const enum hl_format list[] = { HL_FORMAT_R16_UNORM, HL_FORMAT_R8_UNORM,
                                    HL_FORMAT_NONE };
    if (ask->n.specular == HL_NEED_NO_SPECULAR) {
        p->specular = HL_SPECULAR_NONE;
        hl_plan_why(p, HL_WHY_EXPONENT_NONE, 0, 0, 0, 0);
        return;
    }
    const struct hl_profile *c = &ask->caps->profile;
    int use = HL_USE_TARGET | HL_USE_SAMPLED;
    enum hl_format same = c->one_mrt_format
        ? hl_plan_target(p, HL_ROLE_NORMAL)->format : HL_FORMAT_NONE;
    const struct hl_profile_format *row =
        hl_plan_row(ask->caps, c->scalar, same, use, 1);
    enum hl_format f = row ? row->format
                       : c->scalar[0].format ? HL_FORMAT_NONE
                       : hl_format_pick(ask->caps, list, use, 1);
    if (same != HL_FORMAT_NONE && f != same)
        f = HL_FORMAT_NONE;
    if (ask->n.specular == HL_NEED_ONE_EXPONENT || f == HL_FORMAT_NONE) {
        p->specular = HL_SPECULAR_CONSTANT;
        hl_plan_why(p, HL_WHY_EXPONENT_CONSTANT, p->exponent, 0, 0, 0);
        return;
    }
    p->specular = HL_SPECULAR_CHANNEL;
    struct hl_plan_target *t = add_channel(p, HL_ROLE_EXPONENT, f);
    hl_plan_keep(p, t, ask->caps, row, true);
    /* Of floats: the step of values above 1/2. */
    t->error = exponent_error(hl_format_info(f)->kind == HL_KIND_FLOAT
                              ? 6e-8f : hl_fixed_step(f));
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_why(p, HL_WHY_EXPONENT_CHANNEL, (float)f, t->error, 0, 0);
}

/* Of the geometry pass, with the motion that is yet to be added. */
static uint32_t colors_with_motion(const struct hl_plan *p)
{
    return hl_plan_target(p, HL_ROLE_EXPONENT) ? 4 : 3;
}

static enum hl_refusal choose_motion(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    if (colors_with_motion(p) > ask->caps->max_colors)
        return HL_REFUSED_MOTION;
    struct hl_plan_target *t = add_pair(p, ask, HL_ROLE_MOTION);
    /* pack.h hl_motion_decode: two codes of UNORM16 are no motion. */
    float steps = hl_plan_pair_steps(p->two16);
    t->error = (steps == 65535.0f ? 2.0f : 1.0f) / steps;
    p->motion = true;
    hl_plan_why(p, HL_WHY_MOTION, (float)t->format, t->error, 0, 0);
    return HL_REFUSED_NOTHING;
}

enum hl_refusal hl_plan_channels(struct hl_plan *p, const struct hl_ask *ask)
{
    /* Normal, DSF and the pair. */
    if (p->brdfs && ask->caps->max_colors < 3)
        return HL_REFUSED_PIPELINE;
    if (p->brdfs)
        choose_brdfs(p, ask);
    else
        choose_exponent(p, ask);
    return ask->n.motion ? choose_motion(p, ask) : HL_REFUSED_NOTHING;
}
