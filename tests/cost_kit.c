/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "tests/cost_kit.h"

bool ct_open(struct ct_scene *s, const char *name, uint32_t width,
             uint32_t height)
{
    char size[32], scene[64];
    snprintf(size, sizeof size, "%ux%u", width, height);
    snprintf(scene, sizeof scene, "%s", name);
    char *argv[] = { "halflight", "render", scene, "--backend", "packemu",
                     "--size", size, NULL };
    struct hlh_error error;
    memset(s, 0, sizeof *s);
    if (hlc_options_parse(&s->options, 7, argv) != HLC_DONE ||
        hlc_machine_open(&s->machine, &s->options) != HLC_DONE)
        return false;
    s->options.arg[0] = name;
    if (!hlc_scene_open(&s->scene, &s->options, &error) ||
        hlc_world_open(&s->world, &s->machine, &s->scene, &s->options) !=
        HLC_DONE)
        return false;
    s->all_lights = s->world.n_lights;
    return true;
}

void ct_close(struct ct_scene *s)
{
    hlc_world_free(&s->world);
    hlc_machine_close(&s->machine);
    hlh_scene_free(&s->scene);
}

void ct_lights(struct ct_scene *s, uint32_t n)
{
    s->world.n_lights = n < s->all_lights ? n : s->all_lights;
}

/* ---- counting ----------------------------------------------------------- */

static void note(struct ct_cost *c, struct hl_device *d)
{
    struct hl_timing t[32];
    uint32_t n = hl_timings(d, t, 32);
    for (uint32_t i = 0; i < n && i < 32; i++) {
        bool light = !strcmp(t[i].label, "light");
        c->geometry += !strcmp(t[i].label, "geometry") ? t[i].fragments : 0;
        c->light += light ? t[i].fragments : 0;
        c->material += !strcmp(t[i].label, "material") ? t[i].fragments : 0;
        c->forward += !strcmp(t[i].label, "forward") ? t[i].fragments : 0;
        c->blended += t[i].blended;
    }
}

static uint64_t inspected_lights(struct hl_renderer *r,
                                 const struct hl_frame *f)
{
    uint32_t w, h;
    uint64_t sum = 0;
    hl_inspect_size(r, HL_INSPECT_LIGHTS, &w, &h);
    size_t n = (size_t)w * h;
    float *lights = malloc(n * sizeof *lights);
    if (lights && hl_frame_inspect(r, f, HL_INSPECT_LIGHTS, lights,
                                   n * sizeof *lights) == HL_OK)
        for (size_t i = 0; i < n; i++)
            sum += (uint64_t)lights[i];
    free(lights);
    return sum;
}

static double lit_ns(const struct ct_cost *c, const struct hl_cost_model *m)
{
    if (c->plan.light_path == HL_LIGHT_PATH_LISTS)
        return (double)m->light_gather_ns;
    return (double)(c->plan.light_flat ? m->light_flat_ns : m->light_ns);
}

static void weigh(struct ct_cost *c, const struct hl_cost_model *m)
{
    double fetch = (double)m->fetch_ns, pixel = (double)m->pixel_ns;
    double taps = c->plan.dsf == HL_DSF_DARK ? 0
                  : c->plan.dsf == HL_DSF_EXACT ? 1
                  : c->plan.dsf == HL_DSF_OFF ? 4 : 8;
    c->ns = (double)c->draws * (double)m->draw_ns +
            (double)c->triangles * (double)m->vertex_ns +
            (double)c->blended * (double)m->blend_ns +
            (double)c->geometry * pixel * 2 +
            (double)c->light * (pixel + 2 * fetch) +
            (double)c->material * (pixel + taps * fetch) +
            (double)c->forward * pixel +
            (double)c->lights * lit_ns(c, m);
    if (c->plan.tile_depth)
        c->ns += (double)c->plan.light_width * c->plan.light_height *
                 (double)m->readback_ns + (double)m->sync_ns;
}

static bool draw(struct ct_cost *c, struct ct_scene *s,
                 const struct hl_frame *f)
{
    struct hl_renderer_desc d;
    struct hl_renderer *r = NULL;
    struct hl_frame_stats stats;
    struct hl_device *device = s->machine.device;
    memset(&d, 0, sizeof d);
    d.plan = &c->plan;
    d.surfaces = s->world.surfaces;
    d.n_surfaces = s->world.n_surfaces;
    d.max_items = s->world.n_items;
    d.max_lights = s->all_lights;
    d.readback = true;
    void *memory = malloc(hl_renderer_bytes(&d));
    bool ok = memory && hl_renderer_create(&r, device, &d, memory) == HL_OK;
    hl_submit(device, true);
    uint64_t before = hl_device_counts(device).triangles;
    ok = ok && hl_frame_draw(r, f, &stats) == HL_OK;
    if (ok && c->plan.tile_depth && stats.lights > 0)
        note(c, device);
    ok = ok && hl_submit(device, true) == HL_OK;
    if (ok) {
        note(c, device);
        c->draws = stats.draws;
        c->triangles = hl_device_counts(device).triangles - before;
        if (c->plan.pipeline == HL_PIPELINE_INFERRED)
            c->lights = inspected_lights(r, f);
        else if (c->plan.pipeline == HL_PIPELINE_FORWARD)
            c->lights = c->forward * c->plan.batch;
        else
            c->lights = c->blended;
    }
    hl_renderer_destroy(&r);
    free(memory);
    return ok;
}

bool ct_count(struct ct_cost *c, struct ct_scene *s, enum hl_pipeline pipeline,
              const struct hl_caps *caps)
{
    struct hl_frame f;
    struct hl_needs needs;
    memset(c, 0, sizeof *c);
    s->options.pipeline = pipeline;
    if (hlc_plan_open(&f, &needs, &c->plan, &s->world, caps, &s->options) !=
        HLC_DONE || !draw(c, s, &f))
        return false;
    c->predicted_ns = (double)c->plan.cost_ms * 1e6;
    weigh(c, &caps->cost);
    return true;
}
