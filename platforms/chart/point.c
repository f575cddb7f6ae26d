/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/point.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "platforms/chart/count.h"
#include "platforms/chart/time.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/flicker.h"
#include "platforms/cli/metrics.h"
#include "platforms/cli/plan_text.h"
#include "platforms/cli/probe.h"

/* ---- the machine -------------------------------------------------------- */

static int open_stage(struct hlc_stage *stage, const struct hlc_options *o)
{
    struct hlh_scene scene;
    struct hlh_error error;
    if (!hlc_scene_open(&scene, o, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    return hlc_stage_open(stage, &scene, o);
}

int hlt_spot_open(struct hlt_spot *s)
{
    return open_stage(&s->stage, &s->o);
}

void hlt_spot_close(struct hlt_spot *s)
{
    if (s->has_baseline)
        hlc_shot_close(&s->baseline);
    if (s->counts)
        hlc_stage_close(&s->counter);
    hlc_stage_close(&s->stage);
    s->has_baseline = s->counts = s->counts_tried = s->probed = false;
}

static void way_options(struct hlc_options *out, const struct hlt_spot *s,
                        const struct hlt_way *w)
{
    *out = s->o;
    out->pipeline = w->pipeline;
    out->samples = w->samples;
    out->light_format = w->light_format;
    out->normal_format = w->normal_format;
    out->light_path = w->light_path;
    out->light_batch = w->batch;
    out->dsf = w->dsf;
    out->dsf_tau = w->dsf_tau;
    out->fill = w->fill;
    out->fetch = w->fetch;
    out->has_max_error = w->budget > 0;
    out->max_error = w->budget;
    if (w->eighths) {
        out->light_width = (out->width * w->eighths + 4) / 8;
        out->light_height = (out->height * w->eighths + 4) / 8;
        out->light_width += out->light_width == 0;
        out->light_height += out->light_height == 0;
    }
}

void hlt_spot_baseline(struct hlt_spot *s, const struct hlt_way *w)
{
    struct hlc_options o;
    way_options(&o, s, w);
    s->has_baseline = s->rounds && hlc_shot_open(&s->baseline, &s->stage, &o,
                                                 NULL, NULL, NULL) == HLC_DONE;
}

/* Once a machine and scene. */
static int probe(struct hlt_spot *s)
{
    if (s->probed)
        return HLC_DONE;
    s->probed = true;
    return hlc_probe_measure(&s->probe, &s->stage, &s->o);
}

/* What it says holds for as many samples as it was drawn with. */
static const struct hl_probe *probe_for(const struct hlt_spot *s,
                                        const struct hlc_options *o)
{
    return o->samples == s->o.samples ? &s->probe : NULL;
}

/* Packemu itself, or one beside that draws what was planned for another. */
static struct hlc_stage *counter_of(struct hlt_spot *s)
{
    if (!strcmp(s->stage.machine.caps.backend, "packemu"))
        return &s->stage;
    if (!s->counts_tried) {
        struct hlc_options o = s->o;
        o.backend = "packemu";
        o.profile = o.device = NULL;
        s->counts = open_stage(&s->counter, &o) == HLC_DONE;
    }
    s->counts_tried = true;
    return s->counts ? &s->counter : NULL;
}

/* ---- the row ------------------------------------------------------------ */

static void copy_format(char out[24], const struct hl_plan *p,
                        enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    snprintf(out, 24, "%s", t ? hl_format_info(t->format)->name : "");
}

static void describe(struct hlt_row *row, const struct hl_plan *p)
{
    double pixels = (double)p->width * p->height;
    bool inferred = p->pipeline == HL_PIPELINE_INFERRED;
    snprintf(row->pipeline, sizeof row->pipeline, "%s",
             hlc_pipeline_name(p->pipeline));
    copy_format(row->light_format, p, HL_ROLE_LIGHT);
    copy_format(row->normal_format, p, HL_ROLE_NORMAL);
    if (inferred)
        snprintf(row->light_path, sizeof row->light_path, "%s",
                 hlc_light_path_name(p->light_path));
    row->light_width = inferred ? p->light_width : 0;
    row->light_height = inferred ? p->light_height : 0;
    row->samples = p->samples ? p->samples : 1;
    row->batch = p->batch;
    row->value[HLT_PREDICTED] = (double)p->cost_ms * 1e6 / pixels;
    row->value[HLT_MOVED] = (double)p->moved_per_pixel;
    row->value[HLT_BYTES] = (double)p->bytes_per_pixel;
    row->value[HLT_PREDICTED_CODES] = (double)p->error_codes;
}

/* Weighed by the backend's own unit costs, whatever it was planned by: no
 * calibration changes a figure that another run is compared with. */
static void note_counts(struct hlt_row *row, const struct hlt_counts *c,
                        const struct hlc_shot *drawn, const struct hlt_spot *s)
{
    const struct hl_plan *p = &drawn->plan;
    double pixels = (double)p->width * p->height;
    row->value[HLT_COST] =
        hlt_weigh(c, p, hl_device_caps(s->stage.machine.device)) / pixels;
    row->value[HLT_DRAWS] = c->draws;
    row->value[HLT_TRIANGLES] = (double)c->triangles;
    row->value[HLT_FRAGMENTS] =
        (double)(c->geometry + c->light + c->material + c->forward +
                 c->blended) / pixels;
    row->value[HLT_BLENDS] = (double)(c->light_blends + c->color_blends) /
                             pixels;
    row->value[HLT_LIGHTS] = (double)c->lights / pixels;
}

/* A plan with formats that packemu has not leaves the counts empty. */
static enum hl_result count(struct hlt_row *row, struct hlt_spot *s,
                            struct hlc_shot *shot, const struct hlc_options *o)
{
    struct hlc_stage *stage = counter_of(s);
    struct hlt_counts c;
    struct hlc_shot other;
    enum hl_result r;
    if (stage == &s->stage) {
        r = hlt_count(&c, shot);
        if (r == HL_OK)
            note_counts(row, &c, shot, s);
        return r;
    }
    if (!stage || hlc_shot_open(&other, stage, o, &s->stage.machine.caps,
                                probe_for(s, o), NULL) != HLC_DONE)
        return HL_OK;
    r = hlt_count(&c, &other);
    if (r == HL_OK)
        note_counts(row, &c, &other, s);
    hlc_shot_close(&other);
    return r == HL_ERR_MEMORY || r == HL_ERR_DEVICE_LOST ? r : HL_OK;
}

/* ---- error -------------------------------------------------------------- */

static void note_metrics(struct hlt_row *row, const struct hlc_metrics *m)
{
    double *v = row->value;
    v[HLT_CODES] = m->rms_codes;
    v[HLT_PSNR] = m->psnr;
    v[HLT_RELMSE] = m->relmse;
    v[HLT_MAX] = m->max;
    v[HLT_P999] = m->p999;
    v[HLT_EDGE] = m->edge_mae;
    v[HLT_FLIP] = m->flip;
    v[HLT_FLIP_P99] = m->flip_p99;
    v[HLT_SSIM] = m->ssim;
}

static enum hl_result compare(struct hlt_row *row, struct hlt_spot *s,
                              struct hlc_shot *shot, const char **why)
{
    struct hlh_picture picture;
    struct hlc_metrics m;
    const struct hlh_picture *ref = hlt_ref(s->refs, row->samples, why);
    enum hl_result r = ref ? hlc_shot_draw(shot, NULL) : HL_ERR_INVALID;
    if (r == HL_OK)
        r = hlc_shot_read(shot, &picture);
    if (r != HL_OK)
        return r;
    if (hlc_metrics_measure(&m, &picture, ref, s->refs->ids))
        note_metrics(row, &m);
    else
        r = HL_ERR_MEMORY;
    hlh_picture_free(&picture);
    return r;
}

/* One sample alone: drawn to tell flicker by, not a picture for each. */
static enum hl_result flicker(struct hlt_row *row, struct hlt_spot *s,
                              struct hlc_shot *shot, const char **why)
{
    struct hlc_flicker f;
    enum hl_result r = HL_OK;
    float *jitter = shot->frame.camera.jitter;
    if (row->samples > 1)
        return HL_OK;
    if (!hlc_flicker_begin(&f, s->o.width, s->o.height))
        return HL_ERR_MEMORY;
    for (uint32_t t = 0; t < HLT_DRIFT && r == HL_OK; t++) {
        struct hlh_picture picture;
        const struct hlh_picture *ref = hlt_ref_drift(s->refs, t, why);
        hlc_flicker_jitter(jitter, t, HLT_DRIFT_STEPS);
        r = ref ? hlc_shot_draw(shot, NULL) : HL_ERR_INVALID;
        if (r == HL_OK)
            r = hlc_shot_read(shot, &picture);
        if (r != HL_OK)
            break;
        hlc_flicker_add(&f, picture.rgb, ref->rgb, jitter);
        hlh_picture_free(&picture);
    }
    jitter[0] = jitter[1] = 0;
    if (r == HL_OK)
        row->value[HLT_FLICKER] = hlc_flicker_f(&f);
    hlc_flicker_end(&f);
    return r;
}

/* ---- all of it ---------------------------------------------------------- */

static enum hl_result measure(struct hlt_row *row, struct hlt_spot *s,
                              struct hlc_shot *shot,
                              const struct hlc_options *o, const char **why)
{
    struct hlt_ratio ratio = { (double)NAN, (double)NAN, (double)NAN };
    enum hl_result r = compare(row, s, shot, why);
    if (r == HL_OK)
        r = flicker(row, s, shot, why);
    if (r == HL_OK)
        r = count(row, s, shot, o);
    if (r == HL_OK && s->has_baseline)
        r = hlt_time(&ratio, shot, &s->baseline, s->rounds);
    row->value[HLT_RATIO] = ratio.median;
    row->value[HLT_RATIO_LOW] = ratio.low;
    row->value[HLT_RATIO_HIGH] = ratio.high;
    return r;
}

void hlt_point_none(struct hlt_row *row, const struct hlt_spot *s,
                    const struct hlt_way *w)
{
    memset(row, 0, sizeof *row);
    memcpy(row->scene, s->scene, sizeof row->scene);
    memcpy(row->machine, s->machine, sizeof row->machine);
    memcpy(row->way, w->name, sizeof row->way);
    memcpy(row->group, w->group, sizeof row->group);
    row->budget = w->budget;
    row->samples = w->samples;
    for (int i = 0; i < HLT_COLUMNS; i++)
        row->value[i] = (double)NAN;
}

static int failed(const struct hlt_row *row, const struct hlt_spot *s,
                  enum hl_result r, const char *why)
{
    const char *more = s->stage.machine.complaint;
    return hlc_fail(r == HL_ERR_INVALID || r == HL_ERR_MEMORY ? HLC_BAD
                                                              : HLC_NO_DEVICE,
                    "%s, %s, %s: %s", row->scene, row->machine, row->way,
                    why ? why : more[0] ? more : hl_result_name(r));
}

int hlt_point_plan(struct hl_plan *plan, struct hlt_spot *s,
                   const struct hlt_way *w, char line[HLC_PLAN_LINE])
{
    struct hlc_options o;
    struct hl_frame frame;
    struct hl_needs needs;
    way_options(&o, s, w);
    int code = probe(s);
    if (code != HLC_DONE)
        return code;
    return hlc_plan_try(&frame, &needs, plan, &s->stage.world,
                        &s->stage.machine.caps, &o, probe_for(s, &o),
                        line) == HLC_DONE ? HLC_DONE : HLT_REFUSED;
}

static bool same_targets(const struct hl_plan *a, const struct hl_plan *b)
{
    bool same = a->n_targets == b->n_targets;
    for (uint32_t i = 0; i < a->n_targets && same; i++)
        same = a->target[i].role == b->target[i].role &&
               a->target[i].format == b->target[i].format &&
               a->target[i].sample_as == b->target[i].sample_as &&
               a->target[i].width == b->target[i].width &&
               a->target[i].height == b->target[i].height &&
               a->target[i].samples == b->target[i].samples;
    return same;
}

/* Of what ways differ in; the rest follows from scene and machine. */
bool hlt_same_plan(const struct hl_plan *a, const struct hl_plan *b)
{
    return a->pipeline == b->pipeline && same_targets(a, b) &&
           a->light_path == b->light_path && a->batch == b->batch &&
           a->tile_depth == b->tile_depth && a->dsf == b->dsf &&
           (a->dsf != HL_DSF_CONSTANT || (a->dsf_tau <= b->dsf_tau &&
                                          a->dsf_tau >= b->dsf_tau)) &&
           a->fill == b->fill && a->dsf_bilinear == b->dsf_bilinear &&
           a->centroid == b->centroid && a->translucency == b->translucency;
}

void hlt_point_alike(struct hlt_row *row, const struct hlt_spot *s,
                     const struct hlt_way *w, const struct hl_plan *plan,
                     const struct hlt_row *like)
{
    hlt_point_none(row, s, w);
    memcpy(row->value, like->value, sizeof row->value);
    /* What is predicted depends on what was asked for. */
    describe(row, plan);
}

int hlt_point(struct hlt_row *row, struct hlt_spot *s, const struct hlt_way *w,
              char line[HLC_PLAN_LINE])
{
    struct hlc_options o;
    struct hlc_shot shot;
    const char *why = NULL;
    hlt_point_none(row, s, w);
    way_options(&o, s, w);
    int code = probe(s);
    if (code != HLC_DONE)
        return code;
    if (hlc_shot_open(&shot, &s->stage, &o, NULL, probe_for(s, &o), line) !=
        HLC_DONE)
        return HLT_REFUSED;
    describe(row, &shot.plan);
    enum hl_result r = measure(row, s, &shot, &o, &why);
    hlc_shot_close(&shot);
    return r == HL_OK ? HLC_DONE : failed(row, s, r, why);
}
