/* SPDX-License-Identifier: Zlib */
/* stability: where each method fails. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/cli/outputs.h"
#include "platforms/host/image.h"
#include "platforms/stability/parts.h"

struct run {
    struct hlc_options o;
    struct hls_result *result;   /* malloc'd                                 */
    uint32_t n;
    uint32_t count[4];           /* by verdict                               */
    char machine[64];
    bool silent;                 /* stdout is for JSON                       */
};

/* "thin", "th" and "thin.ratio" name what begins so. */
static bool named(const struct hls_row *row, const struct hls_case *c,
                  const char *only)
{
    char name[HLS_NAME];
    snprintf(name, sizeof name, "%s.%s", row->name, c->name);
    return !only || !strncmp(name, only, strlen(only));
}

static uint32_t count_cases(const char *only)
{
    const struct hls_row *row;
    uint32_t n = 0;
    for (uint32_t i = 0; (row = hls_row(i)); i++)
        for (uint32_t k = 0; k < row->n_cases; k++)
            n += named(row, &row->cases[k], only);
    return n;
}

static void list(const char *only)
{
    const struct hls_row *row;
    for (uint32_t i = 0; (row = hls_row(i)); i++) {
        for (uint32_t k = 0, first = 1; k < row->n_cases; k++) {
            const struct hls_case *c = &row->cases[k];
            if (!named(row, c, only))
                continue;
            if (first)
                printf("%s: %s\n  %s; %s over %s\n", row->name, row->failure,
                       row->source, row->metric, row->parameter);
            first = 0;
            printf("    %-22s %s, %g to %g %s\n", c->name, c->what, c->from,
                   c->to, row->unit);
        }
    }
}

static void sweep_all(struct run *run)
{
    static const struct hls_lab none;
    struct hls_lab lab = none;
    const struct hls_row *row;
    lab.o = &run->o;
    if (!run->silent)
        hls_print_head();
    for (uint32_t i = 0; (row = hls_row(i)); i++)
        for (uint32_t k = 0; k < row->n_cases; k++) {
            if (!named(row, &row->cases[k], run->o.only))
                continue;
            struct hls_result *r = &run->result[run->n++];
            hls_run(r, row, &row->cases[k], &lab);
            run->count[r->verdict]++;
            if (!run->silent)
                hls_print(r);
        }
    if (!run->silent)
        printf("%u held, %u moved, %u broken, %u skipped\n", run->count[0],
               run->count[1], run->count[2], run->count[3]);
}

/* ---- JSON ---------------------------------------------------------------- */

static cJSON *one(const struct hls_result *r)
{
    static const char *const verdict[] = { "held", "moved", "broken",
                                           "skipped" };
    cJSON *j = cJSON_CreateObject();
    cJSON_AddStringToObject(j, "row", r->row->name);
    cJSON_AddStringToObject(j, "case", r->curve->name);
    cJSON_AddStringToObject(j, "failure", r->row->failure);
    cJSON_AddStringToObject(j, "source", r->row->source);
    cJSON_AddStringToObject(j, "parameter", r->row->parameter);
    cJSON_AddStringToObject(j, "unit", r->row->unit);
    cJSON_AddStringToObject(j, "metric", r->row->metric);
    cJSON_AddStringToObject(j, "verdict", verdict[r->verdict]);
    hlc_json_real(j, "boundary", r->boundary, 9);
    hlc_json_real(j, "measure", r->at, 9);
    hlc_json_real(j, "limit", r->curve->limit, 9);
    hlc_json_real(j, "low", r->curve->low, 9);
    hlc_json_real(j, "high", r->curve->high, 9);
    cJSON_AddStringToObject(j, "derived", r->curve->derived);
    cJSON_AddStringToObject(j, "note", r->skip ? r->skip : r->note);
    hlc_json_reals(j, "p", r->p, (int)r->n, 9);
    hlc_json_reals(j, "m", r->m, (int)r->n, 9);
    return j;
}

static cJSON *to_json(const struct run *run)
{
    cJSON *j = hlc_json_begin("stability");
    cJSON *cases = cJSON_AddArrayToObject(j, "cases");
    cJSON_AddStringToObject(j, "backend", run->o.backend);
    cJSON_AddStringToObject(j, "profile",
                            run->o.profile ? run->o.profile : "native");
    cJSON_AddBoolToObject(j, "fast", run->o.fast);
    hlc_json_uint(j, "held", run->count[HLS_HELD]);
    hlc_json_uint(j, "moved", run->count[HLS_MOVED]);
    hlc_json_uint(j, "broken", run->count[HLS_BROKEN]);
    hlc_json_uint(j, "skipped", run->count[HLS_SKIPPED]);
    for (uint32_t i = 0; i < run->n; i++)
        cJSON_AddItemToArray(cases, one(&run->result[i]));
    return j;
}

/* ---- files --------------------------------------------------------------- */

static bool emit(const struct run *run, struct hlh_error *error)
{
    const struct hlc_options *o = &run->o;
    char note[120];
    if (o->out && !hls_write(o->out, run->result, run->n, run->machine, note,
                             error))
        return false;
    if (o->out && note[0])
        hlc_fail(0, "stability: %s", note);
    if (o->json) {
        cJSON *j = to_json(run);
        bool ok = hlc_json_emit(j, o->json, error);
        cJSON_Delete(j);
        if (!ok)
            return false;
    }
    return !o->save || hls_save(o->save, run->result, run->n, run->machine,
                                o->fast, error);
}

static int verdict(const struct run *run)
{
    uint32_t bad = run->count[HLS_MOVED] + run->count[HLS_BROKEN];
    struct hlh_error error;
    int worse = !run->o.check ? 0
        : hls_check(run->o.check, run->result, run->n, run->machine,
                    run->o.fast, &error);
    if (worse < 0)
        return hlc_fail(HLC_BAD, "%s", error.text);
    if (worse)
        return hlc_fail(HLC_FAILED, "stability: %d boundaries are worse than "
                        "%s says", worse, run->o.check);
    return bad ? hlc_fail(HLC_FAILED, "stability: %u of %u boundaries are not "
                          "where they must be", bad, run->n) : HLC_DONE;
}

static bool can_read(const char *path, struct hlh_error *error)
{
    char *text = NULL;
    size_t size;
    bool ok = !path || hlh_file_read(&text, &size, path, error);
    free(text);
    return ok;
}

/* Before minutes of work. */
static int check_files(const struct hlc_options *o)
{
    struct hlh_error error;
    if (hlc_output_check_folder(o->out, &error) &&
        hlc_output_check(o->json, &error) &&
        hlc_output_check(o->save, &error) && can_read(o->check, &error))
        return HLC_DONE;
    return hlc_fail(HLC_BAD, "%s", error.text);
}

int hlc_cmd_stability(const struct hlc_options *o)
{
    struct run run;
    struct hlh_error error;
    memset(&run, 0, sizeof run);
    run.o = *o;
    run.o.backend = o->backend ? o->backend : "packemu";
    run.silent = o->json && !strcmp(o->json, "-");
    snprintf(run.machine, sizeof run.machine, "%s:%s", run.o.backend,
             o->profile ? o->profile : "native");
    uint32_t n = count_cases(o->only);
    if (!n)
        return hlc_fail(HLC_BAD, "--only %s: no row begins with it; see "
                        "--list", o->only ? o->only : "");
    if (o->list) {
        list(o->only);
        return HLC_DONE;
    }
    if (!strcmp(run.o.backend, "null"))
        return hlc_fail(HLC_NO_DEVICE, "--backend null: draws nothing that "
                        "could be measured");
    int code = check_files(o);
    if (code != HLC_DONE)
        return code;
    run.result = calloc(n, sizeof *run.result);
    if (!run.result)
        return hlc_fail(HLC_BAD, "stability: out of memory");
    sweep_all(&run);
    code = emit(&run, &error) ? verdict(&run)
                              : hlc_fail(HLC_BAD, "%s", error.text);
    free(run.result);
    return code;
}
