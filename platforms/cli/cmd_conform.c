/* SPDX-License-Identifier: Zlib */
/* conform: the conformance suite on one device. */
#include <stdio.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/json.h"
#include "platforms/cli/setup.h"
#include "platforms/cli/tap.h"
#include "platforms/gl/hl_gl.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"

struct run {
    const struct hlc_options *o;
    const struct hl_backend *backend;
    struct hl_caps caps;
    struct hl_conform_counts counts;
    cJSON *checks;               /* NULL: no JSON is asked for               */
    uint32_t invalid;            /* messages of the validation layers        */
};

/* ---- what there is ------------------------------------------------------- */

static void list(const char *backend, const char *profile)
{
    const char *name;
    const struct hl_conform_mutant *m;
    printf("%s, %s\n", backend, profile);
    for (uint32_t i = 0; (name = hl_conform_name(i)); i++) {
        char need = hl_conform_required(i, backend, profile);
        if (need != '.')
            printf("  %-36s %s\n", name,
                   need == 'r' ? "must run" : "may be skipped");
    }
    printf("defects\n");
    for (uint32_t i = 0; (m = hl_conform_mutant(i)); i++)
        printf("  %-20s %s\n", m->name, m->what);
}

static bool mutant_known(const char *name)
{
    const struct hl_conform_mutant *m;
    for (uint32_t i = 0; (m = hl_conform_mutant(i)); i++)
        if (!strcmp(m->name, name))
            return true;
    return false;
}

static bool any_named(const char *only)
{
    const char *name;
    for (uint32_t i = 0; (name = hl_conform_name(i)); i++)
        if (!strncmp(name, only, strlen(only)))
            return true;
    return false;
}

/* ---- JSON ---------------------------------------------------------------- */

static const char *level_name(enum hl_conform_level level)
{
    return level == HL_CONFORM_EXACT ? "exact"
           : level == HL_CONFORM_INTERVAL ? "interval" : "tolerance";
}

static const char *status_name(enum hl_conform_status status)
{
    return status == HL_CONFORM_PASS ? "pass"
           : status == HL_CONFORM_FAIL ? "fail" : "skip";
}

static void keep(void *user, const struct hl_conform_result *r)
{
    struct run *run = user;
    if (!run->checks)
        return;
    bool ran = r->status != HL_CONFORM_SKIP;
    cJSON *j = cJSON_CreateObject();
    cJSON_AddItemToArray(run->checks, j);
    cJSON_AddStringToObject(j, "name", r->name);
    cJSON_AddStringToObject(j, "status", status_name(r->status));
    cJSON_AddStringToObject(j, "level", level_name(r->level));
    cJSON_AddStringToObject(j, "why", r->why ? r->why : "");
    if (!ran)
        return;
    cJSON_AddStringToObject(j, "unit", r->unit);
    hlc_json_real(j, "worst", r->worst, 9);
    hlc_json_real(j, "limit", r->limit, 9);
    hlc_json_real(j, "table", r->table, 9);
    hlc_json_uint(j, "cases", r->cases);
    cJSON_AddStringToObject(j, "where", r->where);
    hlc_json_reals(j, "at", r->at, (int)r->n_at, 9);
    cJSON_AddStringToObject(j, "note", r->note);
}

static cJSON *to_json(struct run *run)
{
    const struct hlc_options *o = run->o;
    cJSON *j = hlc_json_begin("conform");
    cJSON_AddStringToObject(j, "backend", run->caps.backend);
    cJSON_AddStringToObject(j, "device", run->caps.device);
    cJSON_AddStringToObject(j, "driver", run->caps.driver);
    cJSON_AddStringToObject(j, "profile", run->caps.profile.name);
    hlc_json_uint(j, "seed", o->seed);
    cJSON_AddBoolToObject(j, "quick", o->quick);
    if (o->mutant)
        cJSON_AddStringToObject(j, "mutant", o->mutant);
    else
        cJSON_AddNullToObject(j, "mutant");
    hlc_json_uint(j, "passed", run->counts.passed);
    hlc_json_uint(j, "failed", run->counts.failed);
    hlc_json_uint(j, "skipped", run->counts.skipped);
    hlc_json_uint(j, "cases", run->counts.cases);
    cJSON_AddItemToObject(j, "checks", run->checks);
    return j;
}

/* ---- the run ------------------------------------------------------------- */

static void listen(void *user, enum hl_log_level level, enum hl_log_id id,
                   const char *text)
{
    struct run *run = user;
    if (level != HL_LOG_ERROR || id != HL_MSG_VALIDATION)
        return;
    run->invalid++;
    hlc_fail(0, "validation: %s", text);
}

static void count(void *user, const struct hl_conform_result *r)
{
    struct run *run = user;
    run->counts.passed += r->status == HL_CONFORM_PASS;
    run->counts.failed += r->status == HL_CONFORM_FAIL;
    run->counts.skipped += r->status == HL_CONFORM_SKIP;
    run->counts.cases += r->cases;
    keep(user, r);
}

static int run_it(struct run *run)
{
    const struct hlc_options *o = run->o;
    const struct hl_gl_native gl = { o->gl_context, NULL };
    const struct hl_packemu_native packemu = { o->threads };
    struct hl_device_desc device;
    struct hl_conform_desc d;
    bool silent = o->json && !strcmp(o->json, "-");
    memset(&device, 0, sizeof device);
    memset(&d, 0, sizeof d);
    device.version = HL_VERSION;
    device.hooks = hlc_hooks();
    device.log = listen;
    device.log_user = run;
    device.device = o->device;
    device.validation = o->validation;
    device.profile = o->profile ? hl_profile_find(o->profile) : NULL;
    if (run->backend == &hl_backend_gl)
        device.native = &gl;
    if (run->backend == &hl_backend_packemu) {
        device.native = &packemu;
        d.memory = hl_packemu_memory;
    }
    d.backend = run->backend;
    d.device = &device;
    d.mutant = o->mutant;
    d.seed = o->seed;
    d.quick = o->quick;
    d.only = o->only;
    d.result = count;
    d.user = run;
    if (!silent)
        return hlc_tap_run(&d, stdout);
    enum hl_result r = hl_conform_run(&d, NULL);
    if (r != HL_OK)
        return hlc_fail(HLC_NO_DEVICE, "conform: %s", hl_result_name(r));
    return run->counts.failed ? HLC_FAILED : HLC_DONE;
}

static int publish(struct run *run, int code)
{
    const struct hlc_options *o = run->o;
    struct hlh_error error;
    if (code != HLC_DONE && code != HLC_FAILED) {
        cJSON_Delete(run->checks);
        return code;
    }
    if (!o->json || strcmp(o->json, "-"))
        printf("# %s, %s, %s; profile %s; seed %u\n", run->caps.backend,
               run->caps.device, run->caps.driver, run->caps.profile.name,
               (unsigned)o->seed);
    if (o->json) {
        cJSON *j = to_json(run);
        bool ok = hlc_json_emit(j, o->json, &error);
        cJSON_Delete(j);
        if (!ok)
            return hlc_fail(HLC_BAD, "%s", error.text);
    }
    if (run->counts.failed)
        return hlc_fail(HLC_FAILED, "conform: %u checks failed",
                        (unsigned)run->counts.failed);
    if (run->invalid)
        return hlc_fail(HLC_FAILED, "conform: %u validation errors",
                        (unsigned)run->invalid);
    return code;
}

int hlc_cmd_conform(const struct hlc_options *o)
{
    struct run run;
    struct hlc_machine machine;
    memset(&run, 0, sizeof run);
    run.o = o;
    if (o->mutant && !mutant_known(o->mutant))
        return hlc_fail(HLC_BAD, "--mutant %s: no such defect; see --list",
                        o->mutant);
    if (o->only && !any_named(o->only))
        return hlc_fail(HLC_BAD, "--only %s: no check begins with it; see "
                        "--list", o->only);
    if (o->list) {
        list(o->backend ? o->backend : hl_platform(0)->name,
             o->profile ? o->profile : "native");
        return HLC_DONE;
    }
    if (o->backend && !strcmp(o->backend, "null"))
        return hlc_fail(HLC_NO_DEVICE, "--backend null: draws nothing that "
                        "could be checked");
    int code = hlc_machine_open(&machine, o);
    if (code != HLC_DONE)
        return code;
    run.backend = machine.backend;
    run.caps = *hl_device_caps(machine.device);
    hlc_machine_close(&machine);
    if (o->json)
        run.checks = cJSON_CreateArray();
    return publish(&run, run_it(&run));
}
