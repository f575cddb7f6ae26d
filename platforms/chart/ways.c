/* SPDX-License-Identifier: Zlib */
/* What is tried. The base is what published results are about: inferred, an
 * L-buffer of 5/8 a side (K Fig. 9), half floats or what comes first in the
 * machine's profile, one sample, all else the planner's. A group changes one
 * or two axes of it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/chart.h"

enum { WAYS = 160, FORMATS = 8 };

struct list {
    struct hlt_way *way;
    uint32_t n;
    const struct hl_caps *caps;
    bool fast;
    enum hl_format base;         /* of the L-buffer                          */
};

static const char *format_name(enum hl_format f)
{
    return hl_format_info(f)->name;
}

/* ---- one way ------------------------------------------------------------ */

/* Ways are alike that ask for the same; names and groups do not count. */
static bool alike(const struct hlt_way *a, const struct hlt_way *b)
{
    return a->pipeline == b->pipeline && a->eighths == b->eighths &&
           a->light_format == b->light_format &&
           a->normal_format == b->normal_format &&
           a->light_path == b->light_path && a->samples == b->samples &&
           a->batch == b->batch && a->dsf == b->dsf &&
           a->dsf_tau == b->dsf_tau && a->fill == b->fill &&
           a->fetch == b->fetch && a->budget == b->budget;
}

static struct hlt_way base_way(const struct list *l)
{
    struct hlt_way w;
    memset(&w, 0, sizeof w);
    w.pipeline = HL_PIPELINE_INFERRED;
    w.eighths = 5;
    w.light_format = l->base;
    w.normal_format = HL_FORMAT_RG16_UNORM;
    /* A profile has a format for normals of its own. */
    if (l->caps->profile.two16[0].format != HL_FORMAT_NONE)
        w.normal_format = HL_FORMAT_NONE;
    w.samples = 1;
    return w;
}

/* Add, unless what it asks for is there; its name is the base's axes and
 * `more`. */
static void add(struct list *l, struct hlt_way *w, const char *group,
                const char *more)
{
    if (!(l->caps->samples & w->samples) || l->n == WAYS)
        return;
    for (uint32_t i = 0; i < l->n; i++)
        if (alike(&l->way[i], w))
            return;
    snprintf(w->group, sizeof w->group, "%s", group);
    snprintf(w->name, sizeof w->name, "inferred %u/8 %s%s%s",
             (unsigned)w->eighths, format_name(w->light_format),
             more[0] ? " " : "", more);
    l->way[l->n++] = *w;
}

/* Of what has no L-buffer that was asked for. */
static void add_named(struct list *l, const char *group, struct hlt_way w,
                      const char *name)
{
    if (!(l->caps->samples & w.samples) || l->n == WAYS)
        return;
    snprintf(w.group, sizeof w.group, "%s", group);
    snprintf(w.name, sizeof w.name, "%s", name);
    l->way[l->n++] = w;
}

/* ---- groups ------------------------------------------------------------- */

static void pipelines(struct list *l)
{
    static const char *const names[2][2] = {
        { "forward", "forward x4" },
        { "forward-multipass", "forward-multipass x4" }
    };
    for (int p = 0; p < 2; p++)
        for (int s = 0; s < (l->fast && p ? 1 : 2); s++) {
            struct hlt_way w;
            memset(&w, 0, sizeof w);
            w.pipeline = p ? HL_PIPELINE_FORWARD_MULTIPASS
                           : HL_PIPELINE_FORWARD;
            w.samples = s ? 4 : 1;
            add_named(l, "pipeline", w, names[p][s]);
        }
}

/* The five, then what a profile has that is none of them. */
static uint32_t light_formats(enum hl_format out[FORMATS],
                              const struct list *l)
{
    static const enum hl_format some[] = {
        HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGB10A2_UNORM,
        HL_FORMAT_RGBA16_UNORM, HL_FORMAT_RGBA16_FLOAT,
        HL_FORMAT_RGBA32_FLOAT
    };
    uint32_t n = sizeof some / sizeof *some;
    bool has = false;
    memcpy(out, some, sizeof some);
    for (uint32_t i = 0; i < n; i++)
        has = has || out[i] == l->base;
    if (!has)
        out[n++] = l->base;
    return n;
}

static bool fast_format(const struct list *l, enum hl_format f)
{
    return f == l->base || f == HL_FORMAT_RGBA8_UNORM ||
           f == HL_FORMAT_RGBA16_UNORM;
}

static void sizes(struct list *l)
{
    static const uint32_t all[] = { 2, 3, 4, 5, 6, 8 };
    enum hl_format format[FORMATS];
    uint32_t n = light_formats(format, l);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        for (uint32_t k = 0; k < n; k++) {
            struct hlt_way w = base_way(l);
            w.eighths = all[i];
            w.light_format = format[k];
            bool some = all[i] == 3 || all[i] == 5 || all[i] == 8;
            if (!l->fast || (some && fast_format(l, format[k])))
                add(l, &w, "size x format", "");
        }
}

static void normals(struct list *l)
{
    static const struct { enum hl_format format; const char *name; } all[] = {
        { HL_FORMAT_RG8_UNORM, "normals RG8_UNORM" },
        { HL_FORMAT_RG16_FLOAT, "normals RG16_FLOAT" }
    };
    for (int i = 0; i < (l->fast ? 1 : 2); i++) {
        struct hlt_way w = base_way(l);
        w.normal_format = all[i].format;
        add(l, &w, "normals", all[i].name);
    }
}

static void samples(struct list *l)
{
    static const char *const names[] = { "x2", "x4", "x8" };
    for (int s = 0; s < 3; s++)
        for (int k = 0; k < 2; k++) {
            struct hlt_way w = base_way(l);
            w.eighths = k ? 8 : 5;
            w.samples = 2u << s;
            if (!l->fast || (s == 1 && k == 0))
                add(l, &w, "samples x size", names[s]);
        }
}

static void batches(struct list *l)
{
    static const enum hl_format format[] = {
        HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGBA16_UNORM, HL_FORMAT_RGBA16_FLOAT
    };
    for (int f = 0; f < 3; f++)
        for (uint32_t k = 1; k <= 16; k *= 2) {
            struct hlt_way w = base_way(l);
            char name[16];
            w.light_format = format[f];
            w.light_path = HL_LIGHT_PATH_RECTS;
            w.batch = k;
            snprintf(name, sizeof name, "K%u", (unsigned)k);
            if (!l->fast || (f == 0 && (k == 1 || k == 16)))
                add(l, &w, "lights a blend x format", name);
        }
}

static void filters(struct list *l)
{
    static const struct {
        enum hl_dsf dsf; enum hl_fill fill; enum hl_fetch fetch;
        const char *name;
    } all[] = {
        { HL_DSF_NONE, HL_FILL_AUTO, HL_FETCH_AUTO, "dsf off" },
        { HL_DSF_CONSTANT_TAU, HL_FILL_AUTO, HL_FETCH_AUTO, "dsf 1%" },
        { HL_DSF_SLOPE_SCALED, HL_FILL_NEAREST, HL_FETCH_AUTO,
          "fill nearest" },
        { HL_DSF_SLOPE_SCALED, HL_FILL_BILINEAR, HL_FETCH_AUTO,
          "fill bilinear" },
        { HL_DSF_SLOPE_SCALED, HL_FILL_DEPTH, HL_FETCH_AUTO, "fill depth" },
        { HL_DSF_SLOPE_SCALED, HL_FILL_AUTO, HL_FETCH_BILINEAR,
          "fetch bilinear" },
    };
    for (int s = 0; s < (l->fast ? 1 : 2); s++)
        for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
            struct hlt_way w = base_way(l);
            w.eighths = s ? 4 : 5;
            w.dsf = all[i].dsf;
            w.dsf_tau = w.dsf == HL_DSF_CONSTANT_TAU ? 0.01 : 0;
            w.fill = all[i].fill;
            w.fetch = all[i].fetch;
            if (!l->fast || i == 0)
                add(l, &w, "filter x size", all[i].name);
        }
}

static void paths(struct list *l)
{
    static const struct { enum hl_light_path path; const char *name; } all[] =
    {
        { HL_LIGHT_PATH_TILES, "tiles" }, { HL_LIGHT_PATH_LISTS, "lists" },
        { HL_LIGHT_PATH_VOLUMES, "volumes" }
    };
    for (int i = 0; i < (l->fast ? 2 : 3); i++) {
        struct hlt_way w = base_way(l);
        w.light_path = all[i].path;
        add(l, &w, "light path", all[i].name);
    }
}

static void budgets(struct list *l)
{
    static const struct { double codes; const char *name; } all[] = {
        { 0.5, "auto 0.5 codes" }, { 1, "auto 1 code" },
        { 2, "auto 2 codes" }, { 4, "auto 4 codes" }, { 8, "auto 8 codes" }
    };
    for (int i = 0; i < 5; i++) {
        struct hlt_way w;
        memset(&w, 0, sizeof w);
        w.samples = 1;
        w.budget = all[i].codes;
        if (!l->fast || i % 2)
            add_named(l, "budget", w, all[i].name);
    }
}

/* Where a profile lists formats: its first that this machine has. */
static enum hl_format base_format(const struct hl_caps *caps)
{
    const struct hl_profile_format *row = caps->profile.light;
    int on = caps->console_memory ? HL_ON_CONSOLE : HL_ON_STAND_IN;
    for (int i = 0; i < HL_PROFILE_FORMATS && row[i].format; i++)
        if (row[i].on == HL_ON_ANY || row[i].on == on)
            return row[i].format;
    return HL_FORMAT_RGBA16_FLOAT;
}

struct hlt_way *hlt_ways(uint32_t *n, const struct hl_caps *caps, bool fast)
{
    struct list l = { calloc(WAYS, sizeof(struct hlt_way)), 0, caps, fast,
                      base_format(caps) };
    *n = 0;
    if (!l.way)
        return NULL;
    struct hlt_way base = base_way(&l);
    base.baseline = true;
    add(&l, &base, "size x format", "");
    pipelines(&l);
    sizes(&l);
    normals(&l);
    samples(&l);
    batches(&l);
    filters(&l);
    paths(&l);
    budgets(&l);
    *n = l.n;
    return l.way;
}
