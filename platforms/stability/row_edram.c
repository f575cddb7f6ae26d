/* SPDX-License-Identifier: Zlib */
/* What fits into 10 MB beside each other on the Xbox 360: a picture or an
 * L-buffer of 16:9 grows until the planner refuses it, or cannot keep the
 * light buffer there any more. Nothing is drawn. The bounds are where
 *     ceil(w sx / 80) ceil(h sy / 16) tiles a target of 32 bits, twice as many
 * of 64, summed over what lives together, pass 2,048 (conformance b6; K 5.1).
 * K = Kircher, Lawrance 2009. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/stability/rig.h"

enum what { LIGHT, RESIDENT, FRAME, PROPOSAL };

static uint32_t beside(double height)
{
    return (uint32_t)floor(height * 16 / 9 + 0.5);
}

static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct hlc_options o;
    (void)c;
    (void)skip;
    hls_rig_options(&o, lab, 8, 8);
    o.profile = "xbox360";
    /* Planned for, not drawn on: any machine knows the console's rules. */
    o.backend = "packemu";
    hls_rig_begin(&rig, 1, 60);
    hls_rig_wall(&rig, 0, 2, 0);
    hlh_build_light(&rig.b, hlh_v3(0, 0, 1), 10, hlh_v3(1, 1, 1));
    return hls_rig_end(&rig, lab, &o);
}

static bool plan(struct hl_plan *out, const struct hlc_options *o,
                 struct hls_lab *lab)
{
    struct hl_frame frame;
    struct hl_needs needs;
    return hlc_plan_try(&frame, &needs, out, &lab->stage.world,
                        &lab->stage.machine.caps, o, NULL, NULL) == 0;
}

static bool said(const struct hl_plan *p, enum hl_reason why, double v[2])
{
    for (uint32_t i = 0; i < p->n_reasons; i++)
        if (p->reason[i].why == why) {
            v[0] = (double)p->reason[i].arg[0];
            v[1] = (double)p->reason[i].arg[1];
            return true;
        }
    return false;
}

/* A size that is said to fit must, and a line more must not. */
static bool proposal_holds(const struct hl_plan *refused,
                           const struct hlc_options *o, struct hls_lab *lab)
{
    struct hl_plan p;
    struct hlc_options fit = *o;
    double size[2];
    if (!said(refused, HL_WHY_EDRAM_FITS, size))
        return false;
    fit.light_width = (uint32_t)size[0];
    fit.light_height = (uint32_t)size[1];
    if (!plan(&p, &fit, lab))
        return false;
    fit.light_height++;
    fit.light_width = beside(fit.light_height);
    return !plan(&p, &fit, lab);
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct hlc_options o;
    struct hl_plan made;
    double unused[2];
    hls_rig_options(&o, lab, 1280, 720);
    o.profile = "xbox360";
    o.samples = (uint32_t)c->arg[1];
    o.light_width = c->arg[0] == (double)FRAME ? 320 : beside(p);
    o.light_height = c->arg[0] == (double)FRAME ? 180 : (uint32_t)p;
    if (c->arg[0] == (double)FRAME) {
        o.width = beside(p);
        o.height = (uint32_t)p;
    }
    bool fits = plan(&made, &o, lab);
    if (c->arg[0] == (double)RESIDENT)
        *m = fits && said(&made, HL_WHY_EDRAM_RESIDENT, unused) ? 0 : 1;
    else if (c->arg[0] == (double)PROPOSAL)
        *m = fits || proposal_holds(&made, &o, lab) ? 0 : 1;
    else
        *m = fits ? 0 : 1;
    return true;
}

static const struct hls_case cases[] = {
    { "light", "normals, DSF and depth", 360, 1080, 0.5, false, 676, 676,
      "676: 3 targets; 1200 x 675: 3 x 15 x 43 = 1935, next 2064",
      { LIGHT, 1, 0, 0 } },
    { "resident", "and the L-buffer beside them", 360, 1080, 0.5, false, 541,
      541, "541: and 64 bits; 960 x 540: 5 x 12 x 34 = 2040, next 2210",
      { RESIDENT, 1, 0, 0 } },
    { "frame-1", "colour and depth, 1 sample", 360, 1080, 0.5, false, 849,
      849, "849: 2 x 19 x ceil(849 / 16) = 2052", { FRAME, 1, 0, 0 } },
    { "frame-2", "colour and depth, 2 samples", 360, 1080, 0.5, false, 586,
      586, "586: 2 x 14 x ceil(1172 / 16) = 2072", { FRAME, 2, 0, 0 } },
    { "frame-4", "colour and depth, 4 samples", 180, 1080, 0.5, false, 425,
      425, "425: 2 x 19 x ceil(850 / 16) = 2052", { FRAME, 4, 0, 0 } },
    { "proposal", "a refusal whose proposal does not fit", 360, 1080, 0.5,
      false, NAN, NAN, "none: what is proposed is planned again",
      { PROPOSAL, 1, 0, 0 } },
};

const struct hls_row hls_row_edram = {
    "edram", "Targets that do not fit overwrite each other: addresses wrap",
    "conformance c, b6 (Kircher, Lawrance 2009, section 5.1)",
    "height of 16:9", "lines", "refused: 1", HLS_WHOLE, cases,
    sizeof cases / sizeof *cases, begin, NULL, measure
};
