/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "platforms/cli/commands.h"
#include "tests/cost_kit.h"

bool ct_open(struct ct_scene *s, const char *name, const char *backend,
             uint32_t width, uint32_t height)
{
    char size[32], scene[64], machine[16];
    snprintf(size, sizeof size, "%ux%u", width, height);
    snprintf(scene, sizeof scene, "%s", name);
    snprintf(machine, sizeof machine, "%s", backend);
    char *argv[] = { "halflight", "render", scene, "--backend", machine,
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

/* *memory is the caller's to free, after the renderer. */
static struct hl_renderer *make(const struct hl_plan *plan,
                                const struct ct_scene *s, void **memory)
{
    struct hl_renderer_desc d;
    struct hl_renderer *r = NULL;
    memset(&d, 0, sizeof d);
    d.plan = plan;
    d.surfaces = s->world.surfaces;
    d.n_surfaces = s->world.n_surfaces;
    d.max_items = s->world.n_items;
    d.max_lights = s->all_lights;
    d.readback = true;
    *memory = malloc(hl_renderer_bytes(&d));
    return *memory && hl_renderer_create(&r, s->machine.device, &d,
                                         *memory) == HL_OK ? r : NULL;
}

static bool draw(struct ct_cost *c, struct ct_scene *s,
                 const struct hl_frame *f)
{
    struct hl_frame_stats stats;
    struct hl_device *device = s->machine.device;
    void *memory;
    struct hl_renderer *r = make(&c->plan, s, &memory);
    bool ok = r != NULL;
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

/* ---- times -------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    double x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return (x > y) - (x < y);
}

static double now_ms(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

struct side {                    /* a pipeline that is timed                 */
    struct hl_frame frame;
    struct hl_plan plan;
    struct hl_renderer *r;
    void *memory;
    double ms[CT_ROUNDS];
};

static bool one_round(struct side *d, struct ct_scene *s, uint32_t round)
{
    double start = now_ms();
    bool ok = hl_frame_draw(d->r, &d->frame, NULL) == HL_OK &&
              hl_submit(s->machine.device, true) == HL_OK;
    if (round > 0)
        d->ms[round - 1] = now_ms() - start;
    return ok;
}

bool ct_time(struct ct_times out[HL_PIPELINE_COUNT], struct ct_scene *s,
             uint32_t rounds)
{
    struct side *side = calloc(HL_PIPELINE_COUNT, sizeof *side);
    const struct hl_caps *caps = hl_device_caps(s->machine.device);
    bool ok = side && rounds > 0 && rounds <= CT_ROUNDS;
    for (int p = 1; p < HL_PIPELINE_COUNT && ok; p++) {
        struct hl_needs needs;
        s->options.pipeline = (enum hl_pipeline)p;
        ok = hlc_plan_open(&side[p].frame, &needs, &side[p].plan, &s->world,
                           caps, &s->options) == HLC_DONE &&
             (side[p].r = make(&side[p].plan, s, &side[p].memory)) != NULL;
    }
    for (uint32_t i = 0; i <= rounds && ok; i++)
        for (int p = 1; p < HL_PIPELINE_COUNT && ok; p++)
            ok = one_round(&side[p], s, i);
    for (int p = 1; p < HL_PIPELINE_COUNT && side; p++) {
        hl_renderer_destroy(&side[p].r);
        free(side[p].memory);
        qsort(side[p].ms, rounds, sizeof(double), by_size);
        out[p] = (struct ct_times){ side[p].ms[rounds / 2],
                                    side[p].ms[rounds / 4],
                                    side[p].ms[rounds * 3 / 4] };
    }
    free(side);
    return ok;
}
