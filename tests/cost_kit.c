/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/render.h"
#include "tests/cost_kit.h"

bool ct_open(struct ct_scene *s, const char *name, const char *backend,
             uint32_t width, uint32_t height)
{
    char size[32], text[64], machine[16];
    snprintf(size, sizeof size, "%ux%u", width, height);
    snprintf(text, sizeof text, "%s", name);
    snprintf(machine, sizeof machine, "%s", backend);
    char *argv[] = { "halflight", "render", text, "--backend", machine,
                     "--size", size, NULL };
    struct hlh_error error;
    struct hlh_scene scene;
    memset(s, 0, sizeof *s);
    if (hlc_options_parse(&s->options, 7, argv) != HLC_DONE)
        return false;
    s->options.arg[0] = name;
    if (!hlc_scene_open(&scene, &s->options, &error) ||
        hlc_stage_open(&s->stage, &scene, &s->options) != HLC_DONE)
        return false;
    s->all_lights = s->stage.world.n_lights;
    return true;
}

void ct_close(struct ct_scene *s) { hlc_stage_close(&s->stage); }

void ct_lights(struct ct_scene *s, uint32_t n)
{
    s->stage.world.n_lights = n < s->all_lights ? n : s->all_lights;
}

bool ct_count(struct ct_cost *c, struct ct_scene *s, enum hl_pipeline pipeline,
              const struct hl_caps *caps)
{
    struct hlc_shot shot;
    memset(c, 0, sizeof *c);
    s->options.pipeline = pipeline;
    if (hlc_shot_open(&shot, &s->stage, &s->options, caps, NULL, NULL) !=
        HLC_DONE)
        return false;
    bool ok = hlt_count(&c->of, &shot) == HL_OK;
    c->plan = shot.plan;
    c->predicted_ns = (double)c->plan.cost_ms * 1e6;
    c->ns = hlt_weigh(&c->of, &c->plan, caps);
    hlc_shot_close(&shot);
    return ok;
}

/* ---- times -------------------------------------------------------------- */

struct side {                    /* a pipeline that is timed                 */
    struct hlc_shot shot;
    bool open;
    double ms[CT_ROUNDS];
};

bool ct_time(struct ct_times out[HL_PIPELINE_COUNT], struct ct_scene *s,
             uint32_t rounds)
{
    struct side *side = calloc(HL_PIPELINE_COUNT, sizeof *side);
    bool ok = side && rounds > 0 && rounds <= CT_ROUNDS;
    double first;
    for (int p = 1; p < HL_PIPELINE_COUNT && ok; p++) {
        s->options.pipeline = (enum hl_pipeline)p;
        ok = side[p].open = hlc_shot_open(&side[p].shot, &s->stage,
                                          &s->options, NULL, NULL, NULL) ==
                            HLC_DONE;
    }
    for (uint32_t i = 0; i <= rounds && ok; i++)
        for (int p = 1; p < HL_PIPELINE_COUNT && ok; p++)
            ok = hlc_shot_draw(&side[p].shot, i ? &side[p].ms[i - 1]
                                                : &first) == HL_OK;
    for (int p = 1; p < HL_PIPELINE_COUNT && side; p++) {
        if (side[p].open)
            hlc_shot_close(&side[p].shot);
        struct hlc_quartiles q = hlc_quartiles_of(side[p].ms, rounds);
        out[p] = (struct ct_times){ q.median, q.low, q.high };
    }
    free(side);
    return ok;
}
