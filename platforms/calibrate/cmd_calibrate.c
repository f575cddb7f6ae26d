/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/report.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/outputs.h"

/* What was said on the command line, checked before the long work. */
static int settle(struct hlk_work *w, const struct hlc_options *o)
{
    struct hlh_error error;
    w->o = *o;
    const char *const *scene = hlc_calibration_scenes;
    for (; o->n_args == 0 && *scene; scene++)
        w->o.arg[w->o.n_args++] = *scene;
    if (w->o.n_args > HLK_SCENES)
        return hlc_fail(HLC_BAD, "calibrate: more than %d scenes",
                        (int)HLK_SCENES);
    if (!o->out && !(o->json && !strcmp(o->json, "-")))
        w->o.out = "-";
    if (w->o.out && o->json && !strcmp(w->o.out, "-") &&
        !strcmp(o->json, "-"))
        return hlc_fail(HLC_BAD, "--out -, --json -: one of them to a file");
    if (!hlc_output_check(w->o.out, &error) ||
        !hlc_output_check(o->json, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    return HLC_DONE;
}

static int open_caps(struct hlk_work *w)
{
    struct hlc_machine m;
    int code = hlc_machine_open(&m, &w->o);
    if (code != HLC_DONE)
        return code;
    w->caps = m.caps;
    hlc_machine_close(&m);
    if (!strcmp(w->caps.backend, "null"))
        return hlc_fail(HLC_BAD, "--backend null: draws nothing that could "
                        "be measured");
    return code;
}

static int measure(struct hlk_work *w)
{
    int code = hlk_units(&w->caps, &w->notes, &w->o);
    for (uint32_t i = 0; i < w->o.n_args && code == HLC_DONE; i++) {
        struct hlc_options x = w->o;
        x.arg[0] = w->o.arg[i];
        code = hlk_frames_measure(&w->frames[i], &x, &w->caps);
        if (code == HLC_DONE)
            code = hlk_error_measure(&w->errors[i], &x);
    }
    if (code == HLC_DONE)
        code = hlk_errors(&w->caps, &w->notes, w->errors, w->o.n_args, &w->o);
    return code;
}

static int save(struct hlk_work *w)
{
    struct hlc_outputs files;
    struct hlh_error error;
    bool ok = true;
    memset(&files, 0, sizeof files);
    hlk_head(w);
    if (w->o.json) {
        ok = hlk_json(w, w->o.json, &error);
        if (ok && strcmp(w->o.json, "-"))
            hlc_outputs_add(&files, w->o.json);
    }
    if (ok && w->o.out)
        ok = hlc_calibration_write(&w->caps, w->o.out, hlk_note_of, &w->notes,
                                   &error);
    hlc_outputs_end(&files, !ok);
    return ok ? HLC_DONE : hlc_fail(HLC_BAD, "%s", error.text);
}

int hlc_cmd_calibrate(const struct hlc_options *o)
{
    struct hlk_work *w = calloc(1, sizeof *w);
    if (!w)
        return hlc_fail(HLC_BAD, "calibrate: out of memory");
    int code = settle(w, o);
    if (code == HLC_DONE)
        code = open_caps(w);
    if (code == HLC_DONE)
        code = measure(w);
    if (code == HLC_DONE)
        code = save(w);
    free(w);
    return code;
}
