/* SPDX-License-Identifier: Zlib */
/* The choice within a budget: every pipeline, L-buffer size and format that
 * the needs leave open is planned, about forty plans, and compared. */
#include <string.h>
#include "core/pipe.h"

struct search {
    enum hl_pipeline pipeline;   /* AUTO: any                                */
    const struct hl_ask *ask;
    struct hl_plan *best;        /* first the one without a budget           */
    bool found;
    uint32_t compared;
    float least_error, least_cost;
};

/* False for costs that are no number, which a machine may claim. */
static bool within(const struct hl_needs *n, const struct hl_plan *p)
{
    return (n->budget_codes <= 0 || p->error_codes <= n->budget_codes) &&
           (n->budget_ms <= 0 || p->cost_ms <= n->budget_ms);
}

static bool better(const struct hl_needs *n, const struct hl_plan *a,
                   const struct hl_plan *b)
{
    bool cheaper = a->cost_ms < b->cost_ms;
    bool truer = a->error_codes < b->error_codes;
    if (n->budget_codes > 0)
        return cheaper || (a->cost_ms == b->cost_ms && truer);
    return truer || (a->error_codes == b->error_codes && cheaper);
}

static void compare(struct search *s, const struct hl_plan *p)
{
    const struct hl_needs *n = &s->ask->n;
    s->compared++;
    if (p->error_codes < s->least_error)
        s->least_error = p->error_codes;
    if (p->cost_ms < s->least_cost)
        s->least_cost = p->cost_ms;
    if (!within(n, p) || (s->found && !better(n, p, s->best)))
        return;
    *s->best = *p;
    s->found = true;
}

/* ---- candidates --------------------------------------------------------- */

static void try_plan(struct search *s, enum hl_pipeline pipeline,
                     const struct hl_ask *ask)
{
    struct hl_plan one;
    if (hl_plan_one(&one, pipeline, ask, s->pipeline == HL_PIPELINE_AUTO) ==
        HL_REFUSED_NOTHING)
        compare(s, &one);
}

static void try_formats(struct search *s, struct hl_ask *ask)
{
    if (ask->n.light_format != HL_FORMAT_NONE) {
        try_plan(s, HL_PIPELINE_INFERRED, ask);
        return;
    }
    for (int f = HL_FORMAT_NONE + 1; f < HL_FORMAT_COUNT; f++) {
        ask->n.light_format = (enum hl_format)f;
        if (hl_plan_light_candidate(ask, ask->n.light_format))
            try_plan(s, HL_PIPELINE_INFERRED, ask);
    }
    ask->n.light_format = HL_FORMAT_NONE;
}

static uint32_t eighths(uint32_t side, uint32_t k)
{
    uint32_t x = (uint32_t)(((uint64_t)side * k + 4) / 8);
    return x ? x : 1;
}

/* Five eighths, or what EDRAM holds, is what the planner takes unasked. */
static void try_inferred(struct search *s)
{
    static const uint8_t sizes[] = { 8, 7, 6, 4, 3, 2 };
    struct hl_ask ask = *s->ask;
    try_formats(s, &ask);
    if (ask.n.light_width || (ask.n.n_lights == 0 && !ask.n.motion))
        return;
    for (uint32_t i = 0; i < sizeof sizes; i++) {
        ask.n.light_width = eighths(ask.n.width, sizes[i]);
        ask.n.light_height = eighths(ask.n.height, sizes[i]);
        try_formats(s, &ask);
    }
}

/* ---- the choice --------------------------------------------------------- */

/* What was asked for one plan was the search's choice. */
static void rename_reasons(struct hl_plan *p, const struct hl_needs *n)
{
    for (uint32_t i = 0; i < p->n_reasons; i++) {
        enum hl_reason *why = &p->reason[i].why;
        if (*why == HL_WHY_PIPELINE_CHEAPEST)
            *why = HL_WHY_PIPELINE_BUDGET;
        else if (*why == HL_WHY_LIGHT_SIZE_ASKED && n->light_width == 0)
            *why = HL_WHY_LIGHT_SIZE_BUDGET;
        else if (*why == HL_WHY_LIGHT_FORMAT_ASKED &&
                 n->light_format == HL_FORMAT_NONE)
            *why = HL_WHY_LIGHT_FORMAT_BUDGET;
    }
}

static enum hl_refusal missed(const struct search *s)
{
    const struct hl_needs *n = &s->ask->n;
    memset(s->best, 0, sizeof *s->best);
    hl_plan_why(s->best, HL_WHY_BUDGET_MISSED, n->budget_codes, n->budget_ms,
                s->least_error, s->least_cost);
    return HL_REFUSED_BUDGET;
}

enum hl_refusal hl_plan_budget(struct hl_plan *p, enum hl_pipeline pipeline,
                               const struct hl_ask *ask)
{
    const struct hl_needs *n = &ask->n;
    struct search s = { pipeline, ask, p, within(n, p), 0, p->error_codes,
                        p->cost_ms };
    for (int i = 1; i < HL_PIPELINE_COUNT; i++) {
        if (pipeline != HL_PIPELINE_AUTO && (int)pipeline != i)
            continue;
        if (i == HL_PIPELINE_INFERRED)
            try_inferred(&s);
        else
            try_plan(&s, (enum hl_pipeline)i, ask);
    }
    if (!s.found)
        return missed(&s);
    rename_reasons(p, n);
    if (n->budget_codes > 0)
        hl_plan_why(p, HL_WHY_BUDGET_ERROR, n->budget_codes, p->error_codes,
                    p->cost_ms, (float)s.compared);
    else
        hl_plan_why(p, HL_WHY_BUDGET_COST, n->budget_ms, p->cost_ms,
                    p->error_codes, (float)s.compared);
    return HL_REFUSED_NOTHING;
}
