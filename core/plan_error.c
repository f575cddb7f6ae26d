/* SPDX-License-Identifier: Zlib */
/* Predicted error of a plan's picture: what the size and the format of the
 * L-buffer add, from what a probe of the scene or a calibration measured.
 * Independent errors add by their squares. */
#include "core/exact.h"
#include "core/pipe.h"
#include "core/vec.h"

/* What holds where caps.error has zeros. Measured on packemu over 11 scenes at
 * 320 x 180 and 640 x 360 (tests/bench_error.c): eighths are the largest of
 * all and a little more, where thin things in sight make 7/8 to 5/8 and
 * smooth, large ones 3/8 and 2/8; full, half and eight are above those of most
 * scenes, not of all: without a probe nothing is known. */
static const struct hl_error_model built_in = {
    .eighths = { 0, 6, 3, 1.5f, 1, 0.95f, 0.9f, 0.85f, 0 },
    .full = 2, .half = 10, .eight = 20, .margin = 1
};

/* Sums of squares fall short by 0.6 % at most where the two errors are alike,
 * as found; what is drawn as it was probed has no such sum. */
#define ALIKE 1.01

static bool number(float x, float high) { return x >= 0 && x <= high; }

bool hl_error_model_good(const struct hl_error_model *m)
{
    bool good = number(m->full, 255) && number(m->half, 255) &&
                number(m->eight, 255) && number(m->margin, 1e3f);
    for (int i = 0; i < 9; i++)
        good = good && number(m->eighths[i], 1e3f);
    return good;
}

/* A probe's number, else a calibration's, else the built-in one. */
static double first(float probed, float calibrated, float own)
{
    return (double)(probed > 0 ? probed : calibrated > 0 ? calibrated : own);
}

static double at_most_one(double x) { return x < 1 ? x : 1; }

/* Shares as the probe has them. Between what it drew the most of 27 tables of
 * 11 scenes counts, of the way from one to the next: 0.6 from 6/8 to 4/8 at 5/8
 * (as found 0.12 to 0.60), 0.44 from 4/8 to 2/8 at 3/8; 7/8 errs by 1.04 times
 * 6/8 at most. */
static void probed_shares(float e[9], const struct hl_probe *p)
{
    float wide = p->three_quarters / p->half, narrow = p->quarter / p->half;
    if (p->three_quarters > 0) {
        e[7] = 1.05f * wide;
        e[6] = wide;
        e[5] = wide < 1 ? wide + 0.62f * (1 - wide) : wide;
    }
    if (p->quarter > 0) {
        e[3] = narrow > 1 ? 1 + 0.53f * (narrow - 1) : 1;
        e[2] = narrow;
    }
}

/* Error of the L-buffer's size, as a share of that of one half: a line
 * between eighths. Below two of them as one over the side: what is missed
 * lies along edges, and a texel covers that much more of them. */
static double size_share(const struct hl_plan *p, const float eighths[9])
{
    double x = 8 * sqrt(at_most_one((double)p->light_width / p->width) *
                        at_most_one((double)p->light_height / p->height));
    if (x < 2)
        return (double)eighths[2] * 2 / (x > 1e-3 ? x : 1e-3);
    int i = x < 8 ? (int)x : 7;
    return (double)eighths[i] + (x - i) * ((double)eighths[i + 1] -
                                           (double)eighths[i]);
}

static double size_codes(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_error_model *m = &ask->caps->error, *o = &built_in;
    const struct hl_probe *probe = &ask->n.probe;
    float e[9];
    for (int i = 0; i < 9; i++)
        e[i] = m->eighths[4] > 0 ? m->eighths[i] : o->eighths[i];
    if (probe->half > 0)
        probed_shares(e, probe);
    return ALIKE * first(probe->half, m->half, o->half) * size_share(p, e);
}

/* ---- formats ------------------------------------------------------------ */

/* A picture's worst slope is 106 codes for a relative error of 1
 * (plan.c); half of that for the mean pixel. Truncating sums lose 0.36 of
 * the bound's ulp a blend: half of one, and the mean significand is 1.39
 * (conformance b3: 1.44 % after 81 blends of 11 bits). */
static double float_codes(enum hl_format f, double blends)
{
    return 106 * 0.5 * 0.36 *
           (double)hl_accumulation_error(f, 1) * (blends + 1) / 2;
}

/* Share of its range that a fixed format's step is. */
static double relative_step(enum hl_format f)
{
    double range = hl_format_info(f)->kind == HL_KIND_FIXED32 ? 32 : 1;
    return (double)hl_fixed_step(f) / range;
}

/* As 8 bits err, by how much finer steps are: RMS errors that large do not
 * grow with the step, for light below it is gone whole. Counted over 11 scenes
 * an error falls at least by the power 2/3 to steps of a quarter, and from
 * there on by the power 0.9. Roundings of a sum are independent: root of their
 * number. */
static double fixed_codes(enum hl_format f, double eight, double blends,
                          double eight_blends)
{
    double finer = -hl_exact_log2(relative_step(f) * 255);
    double fall = finer < 2 ? finer * (finer < 0 ? 1 : 2.0 / 3)
                            : 4.0 / 3 + 0.9 * (finer - 2);
    return eight * hl_exact_exp2(-fall) * sqrt(blends / eight_blends);
}

static double light_codes(const struct hl_plan *p, const struct hl_ask *ask,
                          double eight)
{
    const struct hl_plan_target *t = hl_plan_target(p, HL_ROLE_LIGHT);
    const struct hl_probe *probe = &ask->n.probe;
    double blends = hl_plan_light_blends(p, ask);
    if (hl_format_info(t->format)->kind == HL_KIND_FLOAT)
        return float_codes(t->format, blends);
    return fixed_codes(t->format, eight, blends, probe->eight_blends > 0
                       ? (double)probe->eight_blends : 1.0);
}

/* Draws that a mean pixel of the frame adds up. */
static double color_blends(const struct hl_plan *p, const struct hl_ask *ask)
{
    if (p->pipeline == HL_PIPELINE_FORWARD)
        return 1 + (double)ask->n.further_cover;
    return p->pipeline == HL_PIPELINE_INFERRED
           ? 1 : 1 + (double)ask->per_pixel;
}

/* 7e3 has steps of 1/512 below 1/4: 0.36 codes RMS at 0.05, where a code is
 * 1/640. */
static double color_codes(const struct hl_plan *p, const struct hl_ask *ask)
{
    enum hl_format f = hl_plan_target(p, HL_ROLE_COLOR)->format;
    double codes = float_codes(f, color_blends(p, ask));
    return f == HL_FORMAT_RGB10A2_FLOAT && codes < 0.36 ? 0.36 : codes;
}

/* Of forward pipelines; what was measured was drawn to such a target. Multi-
 * pass draws meet depths that are equal but of another surface, where solids
 * touch: 0.36 codes were the most that 14 pictures differed by from
 * FORWARD's. */
static double forward_squares(const struct hl_plan *p,
                              const struct hl_ask *ask)
{
    bool multipass = p->pipeline == HL_PIPELINE_FORWARD_MULTIPASS;
    double probed = (double)ask->n.probe.forward;
    double color = probed > 0 && !multipass ? 0 : color_codes(p, ask);
    double ties = multipass ? 0.36 : 0;
    return probed * probed + color * color + ties * ties;
}

static double inferred_squares(const struct hl_plan *p,
                               const struct hl_ask *ask)
{
    const struct hl_error_model *m = &ask->caps->error, *o = &built_in;
    const struct hl_probe *n = &ask->n.probe;
    double full = first(n->full, m->full, o->full);
    double color = n->full > 0 ? 0 : color_codes(p, ask);
    double size = size_codes(p, ask);
    double light = light_codes(p, ask, first(n->eight, m->eight, o->eight));
    return full * full + color * color + size * size + light * light;
}

/* ---- the whole ---------------------------------------------------------- */

/* A dark plan draws what forward does. */
void hl_plan_error(struct hl_plan *p, const struct hl_ask *ask)
{
    float margin = ask->caps->error.margin;
    bool lit = p->pipeline == HL_PIPELINE_INFERRED && p->dsf != HL_DSF_DARK;
    double codes = (double)(margin > 0 ? margin : built_in.margin) *
                   sqrt(lit ? inferred_squares(p, ask)
                            : forward_squares(p, ask));
    p->error_codes = (float)(codes < 255 ? codes : 255);
}
