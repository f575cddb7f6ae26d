/* SPDX-License-Identifier: Zlib */
#include "platforms/calibrate/report.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include "platforms/cli/json.h"

double hlk_agreement(const struct hlk_frames *f,
                     const double predicted[HLK_WAYS][HLK_COSTS], int costs)
{
    return predicted[HLK_INFERRED][costs] / predicted[HLK_FORWARD][costs] /
           f->ratio.median;
}

/* ---- the file's head ---------------------------------------------------- */

static void add_line(struct hlk_notes *n, const char *format, ...)
{
    size_t used = strlen(n->head);
    va_list args;
    va_start(args, format);
    vsnprintf(n->head + used, sizeof n->head - used, format, args);
    va_end(args);
}

static void add_figure(struct hlk_notes *n, const char *before, double x)
{
    if (isfinite(x))
        add_line(n, "%s%.2f", before, x);
    else
        add_line(n, "%s-", before);
}

void hlk_head(struct hlk_work *w)
{
    struct hlk_notes *n = &w->notes;
    add_line(n, "halflight calibrate at %ux%u.\n", (unsigned)w->o.width,
             (unsigned)w->o.height);
    if (w->caps.kind == HL_DEVICE_CPU)
        add_line(n, "Times are of the processor, all threads together.\n");
    add_line(n, "Inferred over forward: measured (quartiles), then predicted "
             "over measured,\nof counted frames by built-in and these costs, "
             "of plans by the same.\n");
    for (uint32_t i = 0; i < w->o.n_args; i++) {
        const struct hlk_frames *f = &w->frames[i];
        add_line(n, "  %-12.40s ", f->scene);
        if (isfinite(f->ratio.median))
            add_line(n, "%.3f (%.3f..%.3f)", f->ratio.median, f->ratio.low,
                     f->ratio.high);
        for (int c = 0; c < HLK_COSTS; c++)
            add_figure(n, c ? " " : "  ", hlk_agreement(f, f->counted, c));
        for (int c = 0; c < HLK_COSTS; c++)
            add_figure(n, c ? " " : "  ", hlk_agreement(f, f->planned, c));
        add_line(n, "\n");
    }
}

/* ---- JSON --------------------------------------------------------------- */

static cJSON *child(cJSON *parent, const char *key)
{
    return cJSON_AddObjectToObject(parent, key);
}

static void add_values(cJSON *j, const struct hlk_work *w)
{
    struct hl_caps caps = w->caps;
    cJSON *values = child(j, "values");
    char key[HLC_CALIBRATION_KEY];
    const float *v;
    for (uint32_t i = 0;
         (v = hlc_calibration_value(&caps, i, key, NULL)) != NULL; i++)
        if (*v > 0)
            hlc_json_real(values, key, (double)*v, 9);
}

static cJSON *spread(const struct hlk_value *v)
{
    double x[3] = { v->median, v->low, v->high };
    cJSON *holder = cJSON_CreateObject();
    hlc_json_reals(holder, "v", x, 3, 4);
    cJSON *array = cJSON_DetachItemFromObject(holder, "v");
    cJSON_Delete(holder);
    return array;
}

static void add_ms(cJSON *j, const char *key,
                   const double ms[HLK_WAYS][HLK_COSTS], int costs)
{
    cJSON *to = child(j, key);
    hlc_json_real(to, "forward", ms[HLK_FORWARD][costs], 6);
    hlc_json_real(to, "inferred", ms[HLK_INFERRED][costs], 6);
}

static cJSON *frames(const struct hlk_frames *f)
{
    cJSON *j = cJSON_CreateObject();
    cJSON *ms = child(j, "measured_ms");
    cJSON_AddStringToObject(j, "scene", f->scene);
    cJSON_AddItemToObject(ms, "forward", spread(&f->ms[HLK_FORWARD]));
    cJSON_AddItemToObject(ms, "inferred", spread(&f->ms[HLK_INFERRED]));
    cJSON_AddItemToObject(j, "measured_ratio", spread(&f->ratio));
    add_ms(j, "counted_built_in_ms", f->counted, HLK_BUILT_IN);
    add_ms(j, "counted_ms", f->counted, HLK_MEASURED);
    add_ms(j, "planned_built_in_ms", f->planned, HLK_BUILT_IN);
    add_ms(j, "planned_ms", f->planned, HLK_MEASURED);
    return j;
}

static void add_points(cJSON *list, const struct hlk_error *e)
{
    for (uint32_t i = 0; i < e->n; i++) {
        cJSON *j = cJSON_CreateObject();
        cJSON_AddStringToObject(j, "scene", e->scene);
        hlc_json_uint(j, "eighths", e->point[i].eighths);
        cJSON_AddStringToObject(j, "light_format",
                                hl_format_info(e->point[i].format)->name);
        hlc_json_real(j, "rms_codes", e->point[i].codes, 6);
        hlc_json_real(j, "predicted_codes", e->point[i].predicted, 6);
        cJSON_AddItemToArray(list, j);
    }
}

bool hlk_json(const struct hlk_work *w, const char *path,
              struct hlh_error *error)
{
    cJSON *j = hlc_json_begin("calibrate");
    cJSON_AddStringToObject(j, "backend", w->caps.backend);
    cJSON_AddStringToObject(j, "device", w->caps.device);
    hlc_json_size(j, "size", w->o.width, w->o.height);
    add_values(j, w);
    cJSON *scenes = cJSON_AddArrayToObject(j, "frames");
    cJSON *points = cJSON_AddArrayToObject(j, "errors");
    for (uint32_t i = 0; i < w->o.n_args; i++) {
        cJSON_AddItemToArray(scenes, frames(&w->frames[i]));
        add_points(points, &w->errors[i]);
    }
    bool ok = hlc_json_emit(j, path, error);
    cJSON_Delete(j);
    return ok;
}
