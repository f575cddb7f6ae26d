/* SPDX-License-Identifier: Zlib */
/* Further G-buffer channels, each only where a scene needs it (K 2.1). */
#include "core/exact.h"
#include "core/pipe.h"

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
    struct hl_plan_target *t = hl_plan_add_target(p, HL_ROLE_EXPONENT, f,
                                                  p->light_width,
                                                  p->light_height, 1);
    hl_plan_keep(p, t, ask->caps, row, true);
    /* Half a step of log2(n) / 8; of floats, of the values above 1/2. */
    float step = 8.0f * (hl_format_info(f)->kind == HL_KIND_FLOAT
                         ? 6e-8f : hl_fixed_step(f));
    t->error = (float)hl_exact_exp2((double)step * 0.5) - 1.0f;
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_why(p, HL_WHY_EXPONENT_CHANNEL, (float)f, t->error, 0, 0);
}

enum hl_refusal hl_plan_channels(struct hl_plan *p, const struct hl_ask *ask)
{
    choose_exponent(p, ask);
    return HL_REFUSED_NOTHING;
}
