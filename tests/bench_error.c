/* SPDX-License-Identifier: Zlib */
/* Predicted against measured error of inferred plans: not a test, a program
 * to run by hand.
 *   bench_error [WxH [SCENE [OPTION...]]]
 * For the scene (fig8) on packemu, every L-buffer size in eighths and every
 * format: RMS of 8-bit sRGB codes against the reference renderer, the planner's
 * own figure from a probe of the scene, their ratio, and the predicted cost.
 * Then what AUTO takes within budgets: its error measured, and its cost over
 * that of the cheapest way of the table that keeps the budget. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/probe.h"

enum { WAYS = 64 };

struct way { double codes, ms; };
struct ways { struct way way[WAYS]; uint32_t n; };

static void note(struct ways *w, double codes, double ms)
{
    if (w->n < WAYS)
        w->way[w->n++] = (struct way){ codes, ms };
}

static bool picture(struct hlh_picture *out, struct hl_plan *plan,
                    struct hlc_stage *s, const struct hlc_options *o,
                    const struct hl_probe *probe)
{
    struct hlc_shot shot;
    char line[HLC_PLAN_LINE];
    memset(out, 0, sizeof *out);
    if (hlc_shot_open(&shot, s, o, NULL, probe, line) != HLC_DONE)
        return false;
    *plan = shot.plan;
    bool ok = hlc_shot_draw(&shot, NULL) == HL_OK &&
              hlc_shot_read(&shot, out) == HL_OK;
    hlc_shot_close(&shot);
    return ok;
}

static void row(struct hlc_stage *s, const struct hlc_options *base,
                const struct hl_probe *probe, const struct hlh_picture *right,
                uint32_t eighths, enum hl_format format, struct ways *all)
{
    struct hlc_options o = *base;
    struct hlh_picture p;
    struct hl_plan plan;
    o.pipeline = HL_PIPELINE_INFERRED;
    o.light_width = (o.width * eighths + 4) / 8;
    o.light_height = (o.height * eighths + 4) / 8;
    o.light_format = format;
    if (!picture(&p, &plan, s, &o, probe))
        return;
    double real = hlc_rms_codes(&p, right), told = (double)plan.error_codes;
    printf("%s,%u,%s,%.4f,%.4f,%.3f,%.4f\n", s->scene.name, (unsigned)eighths,
           hl_format_info(format)->name, real, told, real / told,
           (double)plan.cost_ms);
    note(all, real, (double)plan.cost_ms);
    hlh_picture_free(&p);
}

static void budget(struct hlc_stage *s, const struct hlc_options *base,
                   const struct hl_probe *probe,
                   const struct hlh_picture *right, double codes,
                   const struct ways *all)
{
    struct hlc_options o = *base;
    struct hlh_picture p;
    struct hl_plan plan;
    double best = INFINITY;
    o.has_max_error = true;
    o.max_error = codes;
    for (uint32_t i = 0; i < all->n; i++)
        if (all->way[i].codes <= codes && all->way[i].ms < best)
            best = all->way[i].ms;
    printf("budget,%s,%g,", s->scene.name, codes);
    if (!picture(&p, &plan, s, &o, probe)) {
        printf("refused,,,,%.4f\n", best);
        return;
    }
    const struct hl_plan_target *t = hl_plan_target(&plan, HL_ROLE_LIGHT);
    double real = hlc_rms_codes(&p, right);
    printf("%s %ux%u %s,%.4f,%s,%.4f,%.4f,%.3f\n",
           hlc_pipeline_name(plan.pipeline), (unsigned)plan.light_width,
           (unsigned)plan.light_height,
           t ? hl_format_info(t->format)->name : "-", real,
           real > codes ? "BROKEN" : "kept", (double)plan.cost_ms, best,
           (double)plan.cost_ms / best);
    hlh_picture_free(&p);
}

static void table_forward(struct hlc_stage *s, const struct hlc_options *o,
                          const struct hl_probe *probe,
                          const struct hlh_picture *right, struct ways *all)
{
    for (int i = 1; i < HL_PIPELINE_INFERRED; i++) {
        struct hlc_options f = *o;
        struct hlh_picture p;
        struct hl_plan plan;
        f.pipeline = (enum hl_pipeline)i;
        if (!picture(&p, &plan, s, &f, probe))
            continue;
        double real = hlc_rms_codes(&p, right);
        printf("# %s: real %.4f told %.4f codes, %.4f ms\n",
               hlc_pipeline_name(f.pipeline), real, (double)plan.error_codes,
               (double)plan.cost_ms);
        note(all, real, (double)plan.cost_ms);
        hlh_picture_free(&p);
    }
}

static int table(struct hlc_stage *s, const struct hlc_options *o)
{
    static const enum hl_format formats[] = {
        HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGB10A2_UNORM,
        HL_FORMAT_RGBA16_UNORM, HL_FORMAT_RGBA16_FLOAT,
        HL_FORMAT_RGBA32_FLOAT };
    struct hl_probe probe;
    struct hlh_picture right;
    struct ways all = { { { 0, 0 } }, 0 };
    hlc_probe_truth(&right, s, o);
    if (hlc_probe_measure(&probe, s, o) != HLC_DONE || !right.rgb)
        return 1;
    printf("# %s: full %.4f half %.4f eight %.4f blends %.0f forward %.4f\n",
           s->scene.name, (double)probe.full, (double)probe.half,
           (double)probe.eight, (double)probe.eight_blends,
           (double)probe.forward);
    table_forward(s, o, &probe, &right, &all);
    for (uint32_t k = 8; k >= 2; k--)
        for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
            row(s, o, &probe, &right, k, formats[i], &all);
    for (double codes = 0.25; codes <= 16; codes *= 2)
        budget(s, o, &probe, &right, codes, &all);
    hlh_picture_free(&right);
    return 0;
}

int main(int argc, char **argv)
{
    char render[] = "render", size[] = "--size", small[] = "320x180",
         fig8[] = "fig8", backend[] = "--backend", packemu[] = "packemu";
    char *args[HLC_ARGS] = { argv[0], render, argc > 2 ? argv[2] : fig8, size,
                             argc > 1 ? argv[1] : small, backend, packemu };
    int n = 7;
    for (int i = 3; i < argc && n < HLC_ARGS - 1; i++)
        args[n++] = argv[i];
    struct hlc_options o;
    struct hlh_scene scene;
    struct hlh_error error;
    struct hlc_stage stage;
    if (hlc_options_parse(&o, n, args) != HLC_DONE ||
        !hlc_scene_open(&scene, &o, &error) ||
        hlc_stage_open(&stage, &scene, &o) != HLC_DONE)
        return 1;
    int bad = table(&stage, &o);
    hlc_stage_close(&stage);
    return bad;
}
