/* SPDX-License-Identifier: Zlib */
/* chart SCENE...: the sweep, then what it says. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/chart.h"
#include "platforms/chart/regret.h"
#include "platforms/chart/report.h"
#include "platforms/chart/sweep.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/outputs.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"

enum { PATH = 4096 };

struct chart {
    struct hlc_options o;        /* with its defaults filled in              */
    struct hlt_table table;
    const char *folder;
    char path[PATH];             /* of the table                             */
    char settings[64];
};

/* ---- options ------------------------------------------------------------ */

/* Of a file's bytes: whether it is the one of the interrupted sweep. */
static uint32_t fnv(const char *bytes, size_t n)
{
    uint32_t h = 2166136261u;
    for (size_t i = 0; i < n; i++)
        h = (h ^ (unsigned char)bytes[i]) * 16777619u;
    return h;
}

static int settle(struct chart *c)
{
    struct hlh_error error;
    struct hlc_options *o = &c->o;
    char *bytes = NULL;
    size_t n = 0;
    if (!o->width) {
        o->width = o->fast ? 320 : 640;
        o->height = o->fast ? 180 : 360;
    }
    if (!o->has_rounds)
        o->rounds = o->fast ? 3 : 9;
    if (o->calibration && !hlh_file_read(&bytes, &n, o->calibration, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    size_t used = (size_t)snprintf(c->settings, sizeof c->settings,
                                   "%u rounds", (unsigned)o->rounds);
    if (bytes)
        snprintf(c->settings + used, sizeof c->settings - used,
                 ", calibrated %08x", (unsigned)fnv(bytes, n));
    free(bytes);
    c->folder = o->out ? o->out : "chart";
    return snprintf(c->path, PATH, "%s/chart.csv", c->folder) < PATH - 256
           ? HLC_DONE : hlc_fail(HLC_BAD, "--out: the name is too long");
}

/* ---- table -------------------------------------------------------------- */

static int begin_table(struct chart *c)
{
    struct hlh_error error;
    struct hlt_table *t = &c->table;
    if (!c->o.afresh && !hlt_table_read(t, c->path, &error))
        return hlc_fail(HLC_BAD, "%s; --fresh begins anew", error.text);
    if (t->width && (t->width != c->o.width || t->height != c->o.height))
        return hlc_fail(HLC_BAD, "%s: pictures of %ux%u, not %ux%u; --fresh "
                        "begins anew", c->path, (unsigned)t->width,
                        (unsigned)t->height, (unsigned)c->o.width,
                        (unsigned)c->o.height);
    if (t->unfinished && strcmp(t->settings, c->settings))
        return hlc_fail(HLC_BAD, "%s: an unfinished sweep with %s, not %s; "
                        "--fresh begins anew", c->path, t->settings,
                        c->settings);
    if (t->unfinished)
        fprintf(stderr, "halflight: %s: going on after %u rows\n", c->path,
                (unsigned)t->n);
    else
        hlt_table_free(t);
    t->width = c->o.width;
    t->height = c->o.height;
    memcpy(t->settings, c->settings, sizeof t->settings);
    return HLC_DONE;
}

/* ---- results ------------------------------------------------------------ */

/* Before it is saved: both may be one file. */
static int check(struct chart *c)
{
    struct hlh_error error;
    int worse = c->o.check ? hlt_check(&c->table, c->o.check, &error) : 0;
    if (worse < 0)
        return hlc_fail(HLC_BAD, "%s", error.text);
    return worse > 0 ? hlc_fail(HLC_FAILED, "%d of %s became worse", worse,
                                c->o.check) : HLC_DONE;
}

static int tell(struct chart *c)
{
    char path[PATH];
    struct hlh_error error;
    const struct hlt_table *t = &c->table;
    struct hlt_regret regret;
    bool text = !c->o.json || strcmp(c->o.json, "-");
    bool ok = hlt_regret_of(&regret, t);
    snprintf(path, sizeof path, "%s/regret.csv", c->folder);
    if (!ok)
        return hlc_fail(HLC_BAD, "chart: out of memory");
    if (text)
        hlt_report_print(t, c->path);
    if (regret.n + regret.refused + regret.refused_wrongly)
        ok = hlt_regret_write(t, path, &error);
    if (text)
        hlt_regret_print(t);
    uint32_t n = hlt_report_plot(t, c->folder);
    if (text)
        printf("\n%u charts in %s\n", (unsigned)n, c->folder);
    ok = ok && (!c->o.json || hlt_report_json(t, c->path, c->o.json, &error));
    int code = ok ? check(c) : hlc_fail(HLC_BAD, "%s", error.text);
    if (code != HLC_BAD && c->o.save && !hlt_save(t, c->o.save, &error))
        code = hlc_fail(HLC_BAD, "%s", error.text);
    return code;
}

static int run(struct chart *c)
{
    struct hlc_outputs files;
    struct hlh_error error;
    memset(&files, 0, sizeof files);
    int code = settle(c);
    if (code != HLC_DONE)
        return code;
    if (!hlc_output_check_folder(c->folder, &error) ||
        !hlc_output_check(c->o.json, &error) ||
        !hlc_output_check(c->o.save, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    if (!hlc_outputs_folder(&files, c->folder, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    code = begin_table(c);
    if (code == HLC_DONE)
        code = hlt_sweep(&c->table, c->path, &c->o);
    /* A folder that was made for nothing goes; rows stay. */
    hlc_outputs_end(&files, code != HLC_DONE);
    return code == HLC_DONE ? tell(c) : code;
}

int hlc_cmd_chart(const struct hlc_options *o)
{
    struct chart *c = calloc(1, sizeof *c);
    if (!c)
        return hlc_fail(HLC_BAD, "chart: out of memory");
    c->o = *o;
    int code = run(c);
    hlt_table_free(&c->table);
    free(c);
    return code;
}
