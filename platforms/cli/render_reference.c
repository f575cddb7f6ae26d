/* SPDX-License-Identifier: Zlib */
/* render by the reference renderer, on the host's processors. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include "platforms/cli/commands.h"
#include "platforms/cli/render.h"
#include "platforms/reference/reference.h"

/* A line that is written over, for people only: nothing in a log, and
 * nothing when it takes less than a second. */
struct progress { double start, last; bool shown; };

static void show(double fraction, void *user)
{
    struct progress *p = user;
    double now = hlc_now_ms();
    if (now - p->start < 1000 || now - p->last < 100)
        return;
    p->last = now;
    p->shown = true;
    fprintf(stderr, "\rreference %3.0f %%", 100 * fraction);
    fflush(stderr);
}

static void hide(const struct progress *p)
{
    if (p->shown)
        fprintf(stderr, "\r%-16s\r", "");
}

static void options_of(struct hlr_options *out, const struct hlc_render *r,
                       struct progress *p)
{
    const struct hlc_options *o = r->o;
    *out = (struct hlr_options){
        .width = r->picture.width, .height = r->picture.height,
        .jitter = { o->jitter[0], o->jitter[1] }, .samples = o->samples,
        .grid = o->supersample, .normal_maps = !o->no_normal_maps,
        .no_specular = o->no_specular, .near = o->near, .far = o->far,
        .shadows = !o->has_shadows || o->shadows != HL_SHADOWS_NONE,
        .progress = isatty(STDERR_FILENO) ? show : NULL, .user = p
    };
}

int hlc_render_reference(struct hlc_render *r)
{
    const char *why = NULL;
    struct progress p = { hlc_now_ms(), 0, false };
    struct hlr_options options;
    struct hlr_stats stats;
    uint32_t w = r->o->part_width ? r->o->part_width : r->o->width;
    uint32_t h = r->o->part_height ? r->o->part_height : r->o->height;
    size_t n = (size_t)w * h;
    r->near = r->o->near;
    r->far = r->o->far;
    r->picture = (struct hlh_picture){ w, h, malloc(n * 3 * sizeof(float)),
                                       true };
    options_of(&options, r, &p);
    r->inside.ids = r->o->ids || r->o->dump ? malloc(n * sizeof(uint32_t))
                                            : NULL;
    if (!r->picture.rgb || ((r->o->ids || r->o->dump) && !r->inside.ids))
        return hlc_fail(HLC_BAD, "--size: out of memory");
    struct hlr_prepared *prepared = hlr_prepare(&r->stage.scene, &why);
    if (!prepared)
        return hlc_fail(HLC_BAD, "%s: %s", r->stage.scene.name,
                        why ? why : "out of memory");
    bool ok = hlr_draw(r->picture.rgb, r->inside.ids, prepared, &options,
                       &stats);
    hide(&p);
    hlr_prepared_free(prepared);
    if (!ok)
        return hlc_fail(HLC_BAD, "%s: the reference renderer refused the "
                        "camera or size, or memory is out",
                        r->stage.scene.name);
    double ms = stats.draw_seconds * 1000;
    r->frame_ms = (struct hlc_spread){ ms, ms, ms, 1 };
    r->threads = stats.threads;
    r->surfaces = stats.surfaces;
    r->light_evaluations = stats.light_evaluations;
    return HLC_DONE;
}
