/* SPDX-License-Identifier: Zlib */
#include <stdlib.h>
#include "platforms/chart/regret.h"
#include "platforms/chart/report.h"
#include "platforms/cli/json.h"

static void add(cJSON *array, cJSON *item)
{
    if (!cJSON_AddItemToArray(array, item))
        cJSON_Delete(item);
}

/* Points of a mean have no figures of their own but cost and error. */
static cJSON *point_json(const struct hlt_front *f, const struct hlt_point *p)
{
    cJSON *j = cJSON_CreateObject();
    cJSON_AddStringToObject(j, "way", p->row->way);
    hlc_json_real(j, "cost", p->cost, 9);
    hlc_json_real(j, "error", p->error, 9);
    if (f->scene) {
        const double *v = p->row->value;
        double time[3] = { v[HLT_RATIO], v[HLT_RATIO_LOW],
                           v[HLT_RATIO_HIGH] };
        hlc_json_real(j, hlt_column_name(f->error), v[f->error], 9);
        hlc_json_reals(j, "time", time, 3, 4);
    }
    return j;
}

static cJSON *front_json(const struct hlt_front *f)
{
    cJSON *j = cJSON_CreateObject();
    double corner[2] = { f->corner_cost, f->corner_error };
    if (f->scene)
        cJSON_AddStringToObject(j, "scene", f->scene);
    else
        cJSON_AddNullToObject(j, "scene");
    cJSON_AddStringToObject(j, "machine", f->machine);
    cJSON_AddStringToObject(j, "measure", hlt_column_name(f->error));
    hlc_json_uint(j, "ways", f->n);
    hlc_json_real(j, "area", f->area, 9);
    hlc_json_reals(j, "corner", corner, 2, 9);
    cJSON *points = cJSON_AddArrayToObject(j, "front");
    for (uint32_t i = 0; i < f->n; i++)
        if (f->point[i].front)
            add(points, point_json(f, &f->point[i]));
    return j;
}

static void add_fronts(cJSON *array, const struct hlt_table *t,
                       const char *scene, const char *machine)
{
    static const enum hlt_column measures[] = {
        HLT_PSNR, HLT_FLIP, HLT_EDGE, HLT_FLICKER, HLT_MAX
    };
    for (size_t i = 0; i < sizeof measures / sizeof *measures; i++) {
        struct hlt_front f;
        if (hlt_front_of(&f, t, scene, machine, HLT_COST, measures[i]) && f.n)
            add(array, front_json(&f));
        free(f.point);
    }
}

static void add_regret(cJSON *tree, const struct hlt_table *t)
{
    struct hlt_regret r;
    if (!hlt_regret_of(&r, t) || r.n == 0) {
        cJSON_AddNullToObject(tree, "regret");
        return;
    }
    cJSON *j = cJSON_AddObjectToObject(tree, "regret");
    hlc_json_uint(j, "budgets", r.n);
    hlc_json_uint(j, "broken", r.broken);
    hlc_json_uint(j, "refused", r.refused);
    hlc_json_uint(j, "refused_wrongly", r.refused_wrongly);
    hlc_json_real(j, "worst", r.worst, 6);
    hlc_json_real(j, "mean", r.mean, 6);
    hlc_json_uint(j, "new_budgets", r.n_new);
    hlc_json_uint(j, "new_broken", r.broken_new);
    hlc_json_real(j, "new_worst", r.worst_new, 6);
}

bool hlt_report_json(const struct hlt_table *t, const char *path,
                     const char *out, struct hlh_error *error)
{
    const char *scene, *machine;
    cJSON *j = hlc_json_begin("chart");
    cJSON_AddStringToObject(j, "table", path);
    hlc_json_size(j, "size", t->width, t->height);
    cJSON_AddStringToObject(j, "settings", t->settings);
    hlc_json_uint(j, "rows", t->n);
    hlc_json_uint(j, "refused", t->refused);
    cJSON *fronts = cJSON_AddArrayToObject(j, "fronts");
    for (uint32_t i = 0; hlt_spot_at(&scene, &machine, t, i); i++)
        add_fronts(fronts, t, scene, machine);
    for (uint32_t i = 0; hlt_mean_at(&machine, t, i); i++)
        add_fronts(fronts, t, NULL, machine);
    add_regret(j, t);
    bool ok = hlc_json_emit(j, out, error);
    cJSON_Delete(j);
    return ok;
}
