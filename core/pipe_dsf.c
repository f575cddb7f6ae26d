/* SPDX-License-Identifier: Zlib */
/* The discontinuity sensitive filter of the material pass. */
#include "core/pipe.h"

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
    } else if (same && n->samples <= 1) {
        p->dsf = HL_DSF_EXACT;
        hl_plan_why(p, HL_WHY_DSF_EXACT, 0, 0, 0, 0);
    } else {
        p->dsf = HL_DSF_SLOPE;
        hl_plan_why(p, HL_WHY_DSF_SLOPE, p->dsf_k, p->dsf_c,
                    n->far / hl_plan_pair_steps(p->two16), 0);
    }
}
