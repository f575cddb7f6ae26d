/* SPDX-License-Identifier: Zlib */
/* What the size and the format of the L-buffer cost in accuracy, against the
 * reference renderer's picture of the same scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/probe.h"

/* In the best format that there is, then others at some sizes. */
static const enum hl_format formats[] = {
    HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_RGBA16_FLOAT, HL_FORMAT_RGBA16_UNORM,
    HL_FORMAT_RGB10A2_UNORM, HL_FORMAT_RGBA8_UNORM
};
enum { N_FORMATS = sizeof formats / sizeof *formats };

static struct hlc_options options_of(const struct hlc_options *o,
                                     uint32_t eighths, enum hl_format format)
{
    struct hlc_options x = *o;
    x.samples = 1;
    x.pipeline = eighths ? HL_PIPELINE_INFERRED : HL_PIPELINE_FORWARD;
    if (eighths) {
        x.light_width = (o->width * eighths + 4) / 8;
        x.light_height = (o->height * eighths + 4) / 8;
        x.light_format = format;
    }
    return x;
}

/* rgb NULL: there is no such plan here. False: the device failed. */
static bool draw(struct hlh_picture *out, struct hlc_stage *stage,
                 const struct hlc_options *o)
{
    struct hlc_shot shot;
    char line[HLC_PLAN_LINE];
    memset(out, 0, sizeof *out);
    if (hlc_shot_open(&shot, stage, o, NULL, NULL, line) != HLC_DONE)
        return true;
    bool ok = hlc_shot_draw(&shot, NULL) == HL_OK &&
              hlc_shot_read(&shot, out) == HL_OK;
    hlc_shot_close(&shot);
    return ok;
}

/* ---- a scene ------------------------------------------------------------ */

struct shown { struct hlh_picture truth, size[9]; };

static void add(struct hlk_error *e, uint32_t eighths, enum hl_format format,
                const struct hlh_picture *a, const struct hlh_picture *b)
{
    if (e->n == HLK_POINTS || !a->rgb || !b->rgb)
        return;
    e->point[e->n++] = (struct hlk_point){
        eighths, format, hlc_rms_codes(a, b), NAN, false
    };
}

/* Every size, in the first format that the machine draws at the frame's. */
static bool draw_sizes(struct hlk_error *e, struct shown *s,
                       struct hlc_stage *stage, const struct hlc_options *o,
                       enum hl_format *best)
{
    bool ok = true;
    for (int i = 0; i < 2 && ok && !s->size[8].rgb; i++) {
        *best = formats[i];
        struct hlc_options x = options_of(o, 8, *best);
        ok = draw(&s->size[8], stage, &x);
    }
    for (uint32_t k = 1; k < 8 && ok; k++) {
        struct hlc_options x = options_of(o, k, *best);
        ok = draw(&s->size[k], stage, &x);
    }
    for (uint32_t k = 1; k <= 8; k++)
        add(e, k, *best, &s->size[k], &s->truth);
    return ok;
}

static void share_sizes(struct hlk_error *e, const struct shown *s)
{
    if (!s->size[8].rgb || !s->size[4].rgb)
        return;
    double half = hlc_rms_codes(&s->size[4], &s->size[8]);
    for (int k = 1; k < 8 && half > 1e-3; k++)
        e->share[k] = s->size[k].rgb
                      ? (float)(hlc_rms_codes(&s->size[k], &s->size[8]) /
                                half) : 0;
}

static bool draw_formats(struct hlk_error *e, const struct shown *s,
                         struct hlc_stage *stage, const struct hlc_options *o,
                         enum hl_format best)
{
    static const uint32_t sizes[] = { 3, 5, 8 };
    bool ok = true;
    for (int i = 0; i < 3 * N_FORMATS && ok; i++) {
        struct hlh_picture p;
        enum hl_format f = formats[i % N_FORMATS];
        struct hlc_options x = options_of(o, sizes[i / N_FORMATS], f);
        if (f == best)
            continue;
        ok = draw(&p, stage, &x);
        add(e, sizes[i / N_FORMATS], f, &p, &s->truth);
        hlh_picture_free(&p);
    }
    return ok;
}

static bool draw_all(struct hlk_error *e, struct hlc_stage *stage,
                     const struct hlc_options *o)
{
    struct shown s;
    enum hl_format best = HL_FORMAT_NONE;
    struct hlc_options x = options_of(o, 0, HL_FORMAT_NONE);
    memset(&s, 0, sizeof s);
    hlc_probe_truth(&s.truth, stage, &x);
    bool ok = (s.truth.rgb || draw(&s.truth, stage, &x)) &&
              draw_sizes(e, &s, stage, o, &best) &&
              draw_formats(e, &s, stage, o, best);
    share_sizes(e, &s);
    hlh_picture_free(&s.truth);
    for (int k = 0; k < 9; k++)
        hlh_picture_free(&s.size[k]);
    return ok;
}

static int with_stage(struct hlk_error *e, const struct hlc_options *o,
                      int (*what)(struct hlk_error *, struct hlc_stage *,
                                  const struct hlc_options *,
                                  const struct hl_caps *),
                      const struct hl_caps *caps)
{
    struct hlh_scene scene;
    struct hlh_error error;
    struct hlc_stage stage;
    if (!hlc_scene_open(&scene, o, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    int code = hlc_stage_open(&stage, &scene, o);
    if (code != HLC_DONE)
        return code;
    code = what(e, &stage, o, caps);
    hlc_stage_close(&stage);
    return code;
}

static int measure(struct hlk_error *e, struct hlc_stage *stage,
                   const struct hlc_options *o, const struct hl_caps *unused)
{
    (void)unused;
    snprintf(e->scene, sizeof e->scene, "%s", stage->scene.name);
    int code = hlc_probe_measure(&e->probe, stage, o);
    if (code != HLC_DONE || !draw_all(e, stage, o))
        return hlc_fail(code ? code : HLC_NO_DEVICE,
                        "calibrate: %s could not be drawn", e->scene);
    return HLC_DONE;
}

int hlk_error_measure(struct hlk_error *out, const struct hlc_options *o)
{
    memset(out, 0, sizeof *out);
    return with_stage(out, o, measure, NULL);
}

/* ---- all ---------------------------------------------------------------- */

/* Sizes and formats that a search goes through: not 1/8, and two bits of
 * specular light only where there is none. */
static bool is_choice(const struct hlk_point *p, const struct hl_needs *needs)
{
    return p->eighths > 1 && (p->format != HL_FORMAT_RGB10A2_UNORM ||
                              needs->specular == HL_NEED_NO_SPECULAR);
}

/* Of the plans that were drawn: by the machine's own unit costs, not by those
 * just measured, which may choose another light path with other blends. */
static int predict(struct hlk_error *e, struct hlc_stage *stage,
                   const struct hlc_options *o, const struct hl_caps *caps)
{
    struct hl_caps drawn = stage->machine.caps;
    drawn.error = caps->error;
    for (uint32_t i = 0; i < e->n; i++) {
        struct hlk_point *p = &e->point[i];
        struct hlc_options x = options_of(o, p->eighths, p->format);
        struct hl_frame frame;
        struct hl_needs needs;
        struct hl_plan plan;
        char line[HLC_PLAN_LINE];
        if (hlc_plan_try(&frame, &needs, &plan, &stage->world, &drawn, &x,
                         &e->probe, line) != HLC_DONE)
            continue;
        p->predicted = (double)plan.error_codes;
        p->choice = is_choice(p, &needs);
    }
    return HLC_DONE;
}

/* The largest of all scenes, and of which. */
static void largest(float *to, struct hlk_notes *notes, const char *key,
                    const struct hlk_error *e, uint32_t n, size_t at)
{
    uint32_t worst = 0;
    *to = 0;
    for (uint32_t i = 0; i < n; i++) {
        float x = *(const float *)(const void *)((const char *)&e[i] + at);
        worst = x > *to ? i : worst;
        *to = x > *to ? x : *to;
    }
    if (*to > 0)
        hlk_note(notes, key, "largest of %u scenes: %.40s", (unsigned)n,
                 e[worst].scene);
    else
        hlk_note(notes, key, "not known here");
}

static void margin(struct hl_error_model *m, struct hlk_notes *notes,
                   const struct hlk_error *e, uint32_t n)
{
    double most = 1;
    char where[96] = "";
    uint32_t points = 0;
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t k = 0; k < e[i].n; k++) {
            const struct hlk_point *p = &e[i].point[k];
            double ratio = p->codes / p->predicted;
            points += p->choice;
            if (!p->choice || !(ratio > most))
                continue;
            most = ratio;
            snprintf(where, sizeof where, ", the worst %s %u/8 %s",
                     e[i].scene, (unsigned)p->eighths,
                     hl_format_info(p->format)->name);
        }
    /* Up to the next thousandth: a budget of just that is kept too. */
    m->margin = (float)(ceil(most * 1000) / 1000);
    hlk_note(notes, "error.margin", "no more of %u pictures%s",
             (unsigned)points, where);
}

int hlk_errors(struct hl_caps *caps, struct hlk_notes *notes,
               struct hlk_error *errors, uint32_t n,
               const struct hlc_options *o)
{
    struct hl_error_model *m = &caps->error;
    struct hlc_options x = *o;
    int code = HLC_DONE;
    for (int k = 1; k < 8; k++) {
        char key[HLC_CALIBRATION_KEY];
        snprintf(key, sizeof key, "error.eighths.%d", k);
        largest(&m->eighths[k], notes, key, errors, n,
                offsetof(struct hlk_error, share) +
                (size_t)k * sizeof errors->share[0]);
    }
    largest(&m->full, notes, "error.full", errors, n,
            offsetof(struct hlk_error, probe.full));
    largest(&m->half, notes, "error.half", errors, n,
            offsetof(struct hlk_error, probe.half));
    largest(&m->eight, notes, "error.eight", errors, n,
            offsetof(struct hlk_error, probe.eight));
    m->margin = 1;
    for (uint32_t i = 0; i < n && code == HLC_DONE; i++) {
        x.arg[0] = o->arg[i];
        code = with_stage(&errors[i], &x, predict, caps);
    }
    margin(m, notes, errors, n);
    return code;
}
