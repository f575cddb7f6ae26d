/* SPDX-License-Identifier: Zlib */
/* Patterns of a frame's translucent items (core/stipple.h). */
#include <string.h>
#include "core/renderer.h"
#include "hal/backend.h"

/* Per cent, hl_stipple_frame.hold: where not all items can have a pattern,
 * one that flickers between two ways of lighting is worse than a few per cent
 * more texels without. */
enum { HOLD = 50 };

static uint32_t most_objects(const struct hl_renderer_desc *d)
{
    return d->max_items < HL_STIPPLE_MAX_OBJECTS ? d->max_items
                                                 : HL_STIPPLE_MAX_OBJECTS;
}

void hl_stippling_carve(struct hl_carve *c, struct hl_renderer *r,
                        const struct hl_renderer_desc *d)
{
    struct hl_stippling *s = &r->stippling;
    uint32_t n = most_objects(d);
    memset(s, 0, sizeof *s);
    if (!d->plan->stipple)
        return;
    void *memory = hl_carve(c, hl_stipple_bytes(n, 0), 1);
    s->objects = hl_carve(c, n, sizeof *s->objects);
    s->outlines = hl_carve(c, n, sizeof *s->outlines);
    s->patterns = hl_carve(c, n, 1);
    s->max_objects = n;
    s->assigner = memory ? hl_stipple_create(memory, n, 0) : NULL;
}

/* ---- what items cover ---------------------------------------------------- */

static uint32_t weight_of(const struct hl_stipple_outline *o)
{
    double area = hl_stipple_area(o);
    return area < HL_STIPPLE_MAX_WEIGHT ? (uint32_t)area
                                        : HL_STIPPLE_MAX_WEIGHT;
}

static uint32_t name_of(const struct hl_frame *f, const struct hl_visible *v)
{
    uint32_t name = f->items[v->item].name;
    return name ? name : 1 + v->item;
}

static void describe(const struct hl_renderer *r, const struct hl_frame *f,
                     const struct hl_visible *v, struct hl_stipple_object *o,
                     struct hl_stipple_outline *outline)
{
    const struct hl_item *it = &f->items[v->item];
    memset(o, 0, sizeof *o);
    o->id = name_of(f, v);
    /* A box that reaches infinity has no centre. */
    o->depth = v->z - v->z == 0 ? v->z : 0;
    o->wanted = it->stipple;
    if (!hl_stipple_project(outline, it->world, it->bounds_min, it->bounds_max,
                            &f->camera, &r->span))
        return;              /* in no texel: overlaps nothing                */
    hl_stipple_bound(o, outline);
    o->weight = weight_of(outline);
}

/* ---- assigning ----------------------------------------------------------- */

/* More pairs than there is room for: without the farther half of the items,
 * which stay without a pattern, until the rest fits. */
static enum hl_result assign(struct hl_renderer *r)
{
    struct hl_stippling *s = &r->stippling;
    struct hl_stipple_frame f;
    uint32_t drop = 0;
    enum hl_result e;
    memset(&f, 0, sizeof f);
    f.mode = r->plan.stipple_mode;
    f.patterns = r->plan.stipple == 4 ? HL_STIPPLE_4X4 : HL_STIPPLE_2X2;
    f.hold = HOLD;
    for (;;) {
        f.objects = s->objects + drop;
        f.n_objects = s->n - drop;
        e = hl_stipple_assign(s->assigner, &f, s->patterns + drop, &s->stats);
        if (e != HL_ERR_LIMIT)
            break;
        drop += (s->n - drop + 1) / 2;
    }
    memset(s->patterns, HL_STIPPLE_NONE, drop);
    return e;
}

/* The same items as those that have patterns now? */
static bool unchanged(const struct hl_stippling *s, const struct hl_frame *f,
                      const struct hl_visible *v, uint32_t n)
{
    if (s->n != n)
        return false;
    for (uint32_t i = 0; i < n; i++)
        if (s->objects[i].id != name_of(f, &v[i]))
            return false;
    return true;
}

static void count(struct hl_renderer *r, uint32_t n)
{
    const struct hl_stippling *s = &r->stippling;
    uint32_t patterned = 0;
    for (uint32_t i = 0; i < s->n; i++)
        patterned += s->patterns[i] != HL_STIPPLE_NONE;
    r->stats.stippled = patterned;
    r->stats.unstippled = n - patterned;
    r->stats.stipple_conflicts = s->stats.conflicts;
    r->stats.stipple_changes = s->stats.changes;
}

enum hl_result hl_stippling_assign(struct hl_renderer *r,
                                   const struct hl_frame *f)
{
    struct hl_stippling *s = &r->stippling;
    uint32_t all = r->n_visible - r->n_decals;
    /* Sorted by depth, farthest first: the nearest are last. */
    uint32_t n = all < s->max_objects ? all : s->max_objects;
    struct hl_visible *v = r->visible + r->n_visible - n;
    enum hl_result e = HL_OK;
    if (!s->again || !unchanged(s, f, v, n)) {
        for (uint32_t i = 0; i < n; i++)
            describe(r, f, &v[i], &s->objects[i], &s->outlines[i]);
        s->n = n;
        e = assign(r);
    }
    if (e != HL_OK) {
        s->n = 0;
        hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_ARGUMENT, "hl_frame.items: ",
                  "two translucent items have one name", NULL);
        return e;
    }
    for (uint32_t i = 0; i < n; i++)
        v[i].pattern = s->patterns[i];
    count(r, all);
    return HL_OK;
}
