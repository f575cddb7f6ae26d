/* SPDX-License-Identifier: Zlib */
/* Flicker under sub-pixel motion, as a table in Markdown: not a test, a
 * program to run by hand.
 *   bench_flicker [FRAMES [SCENE]]            (256, thin)
 * The picture of 320 x 180 pixels drifts by jitter alone: to and fro within a
 * pixel, 1/64 of a pixel a frame, y at 3/5 of x's pace, so that the way back
 * W is exactly known; the reference renderer's rays are moved alike. What F is:
 * platforms/cli/flicker.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/flicker.h"
#include "platforms/cli/readback.h"
#include "platforms/cli/setup.h"
#include "platforms/reference/reference.h"

enum { W = 320, H = 180, N = W * H, FRAMES = 256, STEPS = 64,
       MOST_LIGHTS = 4096 };

/* A way to draw. `astray`: lights are moved with the picture, as if view rays
 * had the jitter left in; no engine wants that. */
static const struct way {
    const char *name, *fill;
    enum hl_pipeline pipeline;
    uint32_t light_w, light_h;
    enum hl_dsf dsf;
    enum hl_fill how;
    bool astray;
} ways[] = {
    { "forward", "", HL_PIPELINE_FORWARD, 0, 0, HL_DSF_AUTO, HL_FILL_AUTO,
      false },
    { "inferred 1:1", "", HL_PIPELINE_INFERRED, W, H, HL_DSF_AUTO,
      HL_FILL_AUTO, false },
    { "inferred 5/8", "nearest", HL_PIPELINE_INFERRED, 200, 113, HL_DSF_AUTO,
      HL_FILL_NEAREST, false },
    { "inferred 5/8", "bilinear", HL_PIPELINE_INFERRED, 200, 113, HL_DSF_AUTO,
      HL_FILL_BILINEAR, false },
    { "inferred 5/8, lights astray", "nearest", HL_PIPELINE_INFERRED, 200,
      113, HL_DSF_AUTO, HL_FILL_NEAREST, true },
    { "inferred 5/8, no filter", "", HL_PIPELINE_INFERRED, 200, 113,
      HL_DSF_NONE, HL_FILL_AUTO, false },
    { "inferred 1/2", "nearest", HL_PIPELINE_INFERRED, W / 2, H / 2,
      HL_DSF_AUTO, HL_FILL_NEAREST, false },
    { "inferred 1/2", "bilinear", HL_PIPELINE_INFERRED, W / 2, H / 2,
      HL_DSF_AUTO, HL_FILL_BILINEAR, false },
};
enum { WAYS = sizeof ways / sizeof *ways };

struct view {
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
    struct hl_renderer *renderer;
    void *memory;
    struct hlc_flicker flicker;
};

struct stage {
    struct hlc_machine machine;
    struct hlc_world world;
    struct view view[WAYS];
};

static void *need(void *memory)
{
    if (!memory) {
        fprintf(stderr, "bench_flicker: out of memory\n");
        exit(1);
    }
    return memory;
}

static void must(bool good, const char *what)
{
    if (!good) {
        fprintf(stderr, "bench_flicker: %s\n", what);
        exit(1);
    }
}

/* ---- making -------------------------------------------------------------- */

static struct hlc_options options_of(const struct way *w, const char *backend,
                                     const char *scene)
{
    struct hlc_options o;
    memset(&o, 0, sizeof o);
    o.arg[0] = scene;
    o.n_args = 1;
    o.backend = backend;
    o.width = W;
    o.height = H;
    o.samples = 1;
    o.pipeline = w->pipeline;
    o.light_width = w->light_w;
    o.light_height = w->light_h;
    o.dsf = w->dsf;
    o.fill = w->how;
    return o;
}

static void make_view(struct view *v, struct stage *s,
                      const struct hlc_options *o)
{
    struct hl_renderer_desc d;
    must(hlc_plan_open(&v->frame, &v->needs, &v->plan, &s->world,
                       hl_device_caps(s->machine.device), o) == HLC_DONE,
         "no plan");
    memset(&d, 0, sizeof d);
    d.plan = &v->plan;
    d.surfaces = s->world.surfaces;
    d.n_surfaces = s->world.n_surfaces;
    d.max_items = s->world.n_items;
    d.max_lights = s->world.n_lights;
    d.readback = true;
    v->memory = need(malloc(hl_renderer_bytes(&d)));
    must(hl_renderer_create(&v->renderer, s->machine.device, &d, v->memory) ==
         HL_OK, "no renderer");
    must(hlc_flicker_begin(&v->flicker, W, H), "out of memory");
}

/* False: this machine is not here. */
static bool make_stage(struct stage *s, const char *backend,
                       const struct hlh_scene *scene, const char *name)
{
    struct hlc_options o = options_of(&ways[0], backend, name);
    memset(s, 0, sizeof *s);
    if (hlc_machine_open(&s->machine, &o) != HLC_DONE)
        return false;
    must(hlc_world_open(&s->world, &s->machine, scene, &o) == HLC_DONE,
         "no world");
    must(s->world.n_lights <= MOST_LIGHTS, "too many lights");
    for (int i = 0; i < WAYS; i++) {
        o = options_of(&ways[i], backend, name);
        make_view(&s->view[i], s, &o);
    }
    return true;
}

static void free_stage(struct stage *s)
{
    for (int i = 0; i < WAYS; i++) {
        struct view *v = &s->view[i];
        hl_renderer_destroy(&v->renderer);
        free(v->memory);
        hlc_flicker_end(&v->flicker);
    }
    hlc_world_free(&s->world);
    hlc_machine_close(&s->machine);
}

/* ---- frames -------------------------------------------------------------- */

static void draw_reference(float *rgb, const struct hlr_prepared *p,
                           const float jitter[2])
{
    struct hlr_options o = { .width = W, .height = H, .normal_maps = true };
    struct hlr_probe hit;
    for (int i = 0; i < N; i++) {
        must(hlr_probe(&hit, p, &o, i % W + 0.5 - (double)jitter[0],
                       i / W + 0.5 - (double)jitter[1]), "no ray");
        for (int c = 0; c < 3; c++)
            rgb[i * 3 + c] = (float)hit.color[c];
    }
}

/* Where texel p would see the light if its ray were not moved back: off by
 * 2 tan jitter / size of its depth; here of the light's own. */
static void lead_astray(struct hl_light *out, const struct hl_frame *f)
{
    const struct hl_camera *c = &f->camera;
    const float *m = c->view;
    float x = -2 * c->tan_half_y / H * c->jitter[0];
    float y = 2 * c->tan_half_y / H * c->jitter[1];
    for (uint32_t i = 0; i < f->n_lights; i++) {
        out[i] = f->lights[i];
        float *p = out[i].position;
        float z = -(m[2] * p[0] + m[6] * p[1] + m[10] * p[2] + m[14]);
        for (int k = 0; k < 3; k++)
            p[k] += z * (x * m[4 * k] + y * m[4 * k + 1]);
    }
}

static void draw(struct view *v, struct stage *s, const struct way *way,
                 const float jitter[2], const float *want)
{
    static struct hl_light lights[MOST_LIGHTS];
    static float rgb[N * 3];
    struct hl_frame f = v->frame;
    struct hlc_texels t;
    memcpy(f.camera.jitter, jitter, sizeof f.camera.jitter);
    if (way->astray) {
        lead_astray(lights, &f);
        f.lights = lights;
    }
    must(hl_frame_draw(v->renderer, &f, NULL) == HL_OK &&
         hl_submit(s->machine.device, true) == HL_OK &&
         hlc_texels_read(&t, s->machine.device,
                         hl_renderer_output(v->renderer)) == HL_OK,
         "no frame");
    for (size_t i = 0; i < N; i++) {
        float texel[4];
        hlc_texel(texel, &t, i);
        memcpy(rgb + 3 * i, texel, 3 * sizeof *rgb);
    }
    hlc_texels_free(&t);
    hlc_flicker_add(&v->flicker, rgb, want, jitter);
}

static void run(struct stage *stage, uint32_t n, uint32_t frames,
                const struct hlr_prepared *prepared)
{
    float *want = need(malloc(N * 3 * sizeof *want));
    float now[2];
    for (uint32_t t = 0; t < frames; t++) {
        hlc_flicker_jitter(now, t, STEPS);
        draw_reference(want, prepared, now);
        for (uint32_t k = 0; k < n * WAYS; k++) {
            struct stage *s = &stage[k / WAYS];
            draw(&s->view[k % WAYS], s, &ways[k % WAYS], now, want);
        }
    }
    free(want);
}

/* ---- the table ----------------------------------------------------------- */

static void print(const struct stage *stage, uint32_t n, uint32_t frames,
                  const char *scene)
{
    printf("%s, %d x %d, %u frames, linear RGB\n\n", scene, W, H, frames);
    puts("| machine | drawn | fill | F, 1e-3 | worst change | RMS error, "
         "1e-3 | worst error |");
    puts("|---|---|---|---:|---:|---:|---:|");
    for (uint32_t k = 0; k < n * WAYS; k++) {
        const struct stage *s = &stage[k / WAYS];
        const struct view *v = &s->view[k % WAYS];
        const struct way *w = &ways[k % WAYS];
        printf("| %s | %s | %s | %.4f | %.3f | %.3f | %.3f |\n",
               s->machine.backend->name, w->name, w->fill,
               hlc_flicker_f(&v->flicker) * 1e3, v->flicker.worst,
               hlc_flicker_rms(&v->flicker) * 1e3, v->flicker.worst_error);
    }
}

int main(int argc, char **argv)
{
    static const char *const backends[] = { "vulkan", "packemu" };
    static struct stage stage[2];
    uint32_t frames = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : FRAMES;
    const char *name = argc > 2 ? argv[2] : "thin", *why = NULL;
    struct hlc_options o = options_of(&ways[0], NULL, name);
    struct hlh_scene scene;
    struct hlh_error error;
    uint32_t n = 0;
    must(frames >= 2, "FRAMES: at least 2");
    must(hlc_scene_open(&scene, &o, &error), "no such scene");
    struct hlr_prepared *prepared = hlr_prepare(&scene, &why);
    must(prepared != NULL, why ? why : "no reference");
    for (int i = 0; i < 2; i++)
        n += make_stage(&stage[n], backends[i], &scene, name) ? 1 : 0;
    must(n > 0, "no machine");
    run(stage, n, frames, prepared);
    print(stage, n, frames, name);
    while (n > 0)
        free_stage(&stage[--n]);
    hlr_prepared_free(prepared);
    hlh_scene_free(&scene);
    return 0;
}
