/* SPDX-License-Identifier: Zlib */
/* Every scene on every machine in every way that the table lacks. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "platforms/chart/point.h"
#include "platforms/chart/progress.h"
#include "platforms/chart/sweep.h"
#include "platforms/cli/commands.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"
#include "platforms/platforms.h"
#include "platforms/profiles/hl_profiles.h"

enum { MACHINES = 16 };

struct machine {
    char name[HLT_MACHINE];      /* "packemu:ps3"                            */
    char backend[HLT_MACHINE];
    const char *profile;         /* NULL: the device's                       */
    struct hlt_way *ways;
    uint32_t n_ways;
};

struct sweep {
    struct hlt_table *table;
    const char *path;
    const struct hlc_options *o;
    struct machine machine[MACHINES];
    uint32_t n_machines;
    struct hlt_progress progress;
    struct hlh_buffer refused;
};

/* ---- machines ----------------------------------------------------------- */

/* "backend" or "backend:profile", of `n` bytes. */
static int parse_machine(struct machine *m, const char *text, size_t n)
{
    memset(m, 0, sizeof *m);
    if (n == 0 || n >= sizeof m->name)
        return hlc_fail(HLC_BAD, "--machines: \"%.*s\" is not "
                        "backend:profile", (int)(n < 40 ? n : 40), text);
    memcpy(m->name, text, n);
    size_t backend = strcspn(m->name, ":");
    memcpy(m->backend, m->name, backend);
    const struct hl_profile *p = m->name[backend]
        ? hl_profile_find(m->name + backend + 1) : NULL;
    if (!hl_platform_find(m->backend) || !strcmp(m->backend, "null"))
        return hlc_fail(HLC_BAD, "--machines %s: no backend \"%s\" that draws",
                        m->name, m->backend);
    if (m->name[backend] && !p)
        return hlc_fail(HLC_BAD, "--machines %s: no such profile", m->name);
    m->profile = p ? p->name : NULL;
    return HLC_DONE;
}

/* Is it there, and what is tried on it? */
static int look(struct machine *m, const struct hlc_options *o)
{
    struct hlc_options own = *o;
    struct hlc_machine device;
    own.backend = m->backend;
    own.profile = m->profile;
    int code = hlc_machine_open(&device, &own);
    if (code != HLC_DONE)
        return code;
    m->ways = hlt_ways(&m->n_ways, &device.caps, o->fast);
    hlc_machine_close(&device);
    return m->ways ? HLC_DONE : hlc_fail(HLC_BAD, "chart: out of memory");
}

static int add_machine(struct sweep *s, const char *text, size_t n)
{
    struct machine *m = &s->machine[s->n_machines];
    if (s->n_machines == MACHINES)
        return hlc_fail(HLC_BAD, "--machines: more than %d", MACHINES);
    int code = parse_machine(m, text, n);
    for (uint32_t i = 0; i < s->n_machines && code == HLC_DONE; i++)
        if (!strcmp(s->machine[i].name, m->name))
            return hlc_fail(HLC_BAD, "--machines: %s twice", m->name);
    if (code == HLC_DONE)
        code = look(m, s->o);
    if (code == HLC_NO_DEVICE) {
        fprintf(stderr, "halflight: %s is left out\n", m->name);
        return HLC_DONE;
    }
    s->n_machines += code == HLC_DONE;
    return code;
}

static int find_machines(struct sweep *s)
{
    const char *list = s->o->machines ? s->o->machines : HLT_MACHINES;
    int code = HLC_DONE;
    for (const char *at = list; at && code == HLC_DONE;) {
        size_t n = strcspn(at, ",");
        code = add_machine(s, at, n);
        at = at[n] ? at + n + 1 : NULL;
    }
    if (code == HLC_DONE && s->n_machines == 0)
        return hlc_fail(HLC_NO_DEVICE, "chart: none of %s has a device", list);
    return code;
}

/* ---- scenes ------------------------------------------------------------- */

void hlt_scene_key(char out[HLT_NAME], const char *arg)
{
    const char *base = hlh_path_base(arg);
    const char *dot = strrchr(base, '.');
    size_t n = dot && dot > base ? (size_t)(dot - base) : strlen(base);
    snprintf(out, HLT_NAME, "%.*s", (int)(n < HLT_NAME ? n : HLT_NAME - 1),
             base);
    for (char *c = out; *c; c++)
        if (!strchr("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                    "0123456789-_", *c))
            *c = '_';
}

/* Before an hour's work. */
static int check_scene(const struct hlc_options *o, uint32_t i)
{
    struct hlc_options own = *o;
    struct hlh_scene scene;
    struct hlh_error error;
    own.arg[0] = o->arg[i];
    if (!hlc_scene_open(&scene, &own, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    hlh_scene_free(&scene);
    return HLC_DONE;
}

static int check_scenes(const struct hlc_options *o)
{
    int code = HLC_DONE;
    for (uint32_t i = 0; i < o->n_args; i++)
        for (uint32_t k = 0; k < i; k++) {
            char a[HLT_NAME], b[HLT_NAME];
            hlt_scene_key(a, o->arg[k]);
            hlt_scene_key(b, o->arg[i]);
            if (!strcmp(a, b))
                return hlc_fail(HLC_BAD, "chart: %s and %s would both be "
                                "\"%s\" in the table", o->arg[k], o->arg[i],
                                a);
        }
    for (uint32_t i = 0; i < o->n_args && code == HLC_DONE; i++)
        code = check_scene(o, i);
    return code;
}

/* ---- points ------------------------------------------------------------- */

static int keep(struct sweep *s, const struct hlt_row *row)
{
    struct hlh_error error;
    return hlt_table_append(s->table, row, s->path, &error)
           ? HLC_DONE : hlc_fail(HLC_BAD, "%s", error.text);
}

/* What was planned on a spot. */
struct planned { struct hl_plan plan; const char *name; };

static const struct hlt_row *row_of(const struct sweep *s,
                                    const struct hlt_spot *spot,
                                    const char *way)
{
    return hlt_table_find(s->table, spot->scene, spot->machine, way);
}

static void refuse(struct sweep *s, const struct hlt_spot *spot,
                   const struct hlt_way *w, const char *why)
{
    hlh_buffer_print(&s->refused, "%s, %s, %s: %s\n", spot->scene,
                     spot->machine, w->name, why);
    hlt_progress_step(&s->progress, true);
    s->table->refused++;
}

/* A way that comes to the plan of an earlier one was measured with it. */
static int measure(struct sweep *s, struct hlt_spot *spot,
                   const struct hlt_way *w, const struct planned *planned,
                   uint32_t n)
{
    const struct hlt_row *like = NULL;
    struct hlt_row row;
    char line[HLC_PLAN_LINE] = "";
    int code = HLC_DONE;
    for (uint32_t i = 0; i < n && !like; i++)
        if (hlt_same_plan(&planned[i].plan, &planned[n].plan))
            like = row_of(s, spot, planned[i].name);
    if (like)
        hlt_point_alike(&row, spot, w, &planned[n].plan, like);
    else
        code = hlt_point(&row, spot, w, line);
    if (code == HLT_REFUSED) {
        refuse(s, spot, w, line);
        return HLC_DONE;
    }
    hlt_progress_step(&s->progress, like != NULL);
    return code == HLC_DONE ? keep(s, &row) : code;
}

/* A refused budget is a row, for it may have been refused wrongly. */
static int one_way(struct sweep *s, struct hlt_spot *spot,
                   const struct hlt_way *w, struct planned *planned,
                   uint32_t *n)
{
    char line[HLC_PLAN_LINE] = "";
    struct hlt_row row;
    const struct hlt_row *old = row_of(s, spot, w->name);
    int code = hlt_point_plan(&planned[*n].plan, spot, w, line);
    if (code == HLT_REFUSED) {
        refuse(s, spot, w, line);
        hlt_point_none(&row, spot, w);
        return w->budget > 0 && !old ? keep(s, &row) : HLC_DONE;
    }
    if (code == HLC_DONE && old)
        hlt_progress_step(&s->progress, true);
    else if (code == HLC_DONE)
        code = measure(s, spot, w, planned, *n);
    planned[(*n)++].name = w->name;
    return code;
}

static int all_ways(struct sweep *s, struct hlt_spot *spot,
                    const struct machine *m)
{
    struct planned *planned = calloc(m->n_ways, sizeof *planned);
    uint32_t n = 0;
    int code = planned ? HLC_DONE : hlc_fail(HLC_BAD, "chart: out of memory");
    for (uint32_t i = 0; i < m->n_ways && code == HLC_DONE; i++) {
        hlt_progress_show(&s->progress, spot->scene, m->name, i + 1,
                          m->n_ways);
        code = one_way(s, spot, &m->ways[i], planned, &n);
    }
    free(planned);
    return code;
}

static void begin_spot(struct hlt_spot *spot, const struct sweep *s,
                       const struct machine *m, const char *arg,
                       struct hlt_refs *refs)
{
    memset(spot, 0, sizeof *spot);
    hlt_scene_key(spot->scene, arg);
    memcpy(spot->machine, m->name, sizeof spot->machine);
    spot->o = *s->o;
    spot->o.backend = m->backend;
    spot->o.profile = m->profile;
    spot->o.arg[0] = arg;
    spot->o.n_args = 1;
    spot->rounds = s->o->rounds;
    spot->refs = refs;
}

/* A scene on a machine. */
static int one_spot(struct sweep *s, const struct machine *m, const char *arg,
                    struct hlt_refs *refs)
{
    struct hlt_spot *spot = malloc(sizeof *spot);
    if (!spot)
        return hlc_fail(HLC_BAD, "chart: out of memory");
    begin_spot(spot, s, m, arg, refs);
    int code = hlt_spot_open(spot);
    if (code == HLC_DONE)
        hlt_spot_baseline(spot, &m->ways[0]);
    if (code == HLC_DONE)
        code = all_ways(s, spot, m);
    hlt_spot_close(spot);
    free(spot);
    return code;
}

static int one_scene(struct sweep *s, uint32_t i)
{
    struct hlc_options o = *s->o;
    struct hlh_scene scene;
    struct hlt_refs refs;
    struct hlh_error error;
    int code = HLC_DONE;
    o.arg[0] = s->o->arg[i];
    if (!hlc_scene_open(&scene, &o, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    memset(&refs, 0, sizeof refs);
    refs.scene = &scene;
    refs.width = o.width;
    refs.height = o.height;
    for (uint32_t k = 0; k < s->n_machines && code == HLC_DONE; k++)
        code = one_spot(s, &s->machine[k], o.arg[0], &refs);
    hlt_refs_free(&refs);
    hlh_scene_free(&scene);
    return code;
}

/* ---- all ---------------------------------------------------------------- */

/* Beside the table: what was refused, and why. */
static int write_refused(struct sweep *s)
{
    char path[4096];
    struct hlh_error error;
    int folder = (int)(hlh_path_base(s->path) - s->path);
    if (snprintf(path, sizeof path, "%.*srefused.txt", folder, s->path) >=
        (int)sizeof path)
        return hlc_fail(HLC_BAD, "--out: the name is too long");
    if (s->refused.size == 0) {
        unlink(path);
        return HLC_DONE;
    }
    return !s->refused.failed && hlh_file_write(path, s->refused.bytes,
                                                s->refused.size, &error)
           ? HLC_DONE : hlc_fail(HLC_BAD, "%s: could not be written", path);
}

static int run(struct sweep *s)
{
    uint32_t total = 0;
    struct hlh_error error;
    int code = HLC_DONE;
    for (uint32_t i = 0; i < s->n_machines; i++)
        total += s->machine[i].n_ways * s->o->n_args;
    hlt_progress_begin(&s->progress, total);
    s->table->unfinished = true;
    /* A row that was cut off must not be gone on with. */
    if (!hlt_table_write(s->table, s->path, &error))
        return hlc_fail(HLC_BAD, "%s", error.text);
    for (uint32_t i = 0; i < s->o->n_args && code == HLC_DONE; i++)
        code = one_scene(s, i);
    hlt_progress_hide(&s->progress);
    s->table->unfinished = code != HLC_DONE;
    if (!hlt_table_write(s->table, s->path, &error) && code == HLC_DONE)
        code = hlc_fail(HLC_BAD, "%s", error.text);
    int refused = write_refused(s);
    return code == HLC_DONE ? refused : code;
}

int hlt_sweep(struct hlt_table *table, const char *path,
              const struct hlc_options *o)
{
    struct sweep *s = calloc(1, sizeof *s);
    if (!s)
        return hlc_fail(HLC_BAD, "chart: out of memory");
    s->table = table;
    s->path = path;
    s->o = o;
    int code = check_scenes(o);
    if (code == HLC_DONE)
        code = find_machines(s);
    if (code == HLC_DONE)
        code = run(s);
    for (uint32_t i = 0; i < MACHINES; i++)
        free(s->machine[i].ways);
    hlh_buffer_free(&s->refused);
    free(s);
    return code;
}
