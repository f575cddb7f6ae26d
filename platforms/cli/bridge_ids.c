/* SPDX-License-Identifier: Zlib */
/* Region ids of the scene's objects, by the scheme that was asked for, and
 * how many neighbours share one. */
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge_parts.h"

/* The id channel of the DSF buffer. */
enum { ID_BITS = 16 };
/* More pairs of near objects are not looked at. */
enum { MEETINGS_MAX = 1 << 25 };
/* Of the scene's diagonal: about what the filter's threshold reaches on a
 * surface at 75 degrees, so that objects this near may be mixed. */
#define MEETING_SHARE 0.01f

struct meetings { uint32_t *pairs; uint32_t n; };

/* ---- objects near each other ------------------------------------------- */

static void world_box(struct hl_ids_box *out, const struct hl_item *item)
{
    const float *m = item->world;
    for (int r = 0; r < 3; r++) {
        float lo = m[12 + r], hi = m[12 + r];
        for (int c = 0; c < 3; c++) {
            float a = m[4 * c + r] * item->bounds_min[c];
            float b = m[4 * c + r] * item->bounds_max[c];
            lo += a < b ? a : b;
            hi += a < b ? b : a;
        }
        out->min[r] = lo;
        out->max[r] = hi;
    }
}

static float meeting_margin(const struct hlh_scene *s)
{
    float longest = 0;
    for (int k = 0; k < 3; k++) {
        float side = s->bounds_max[k] - s->bounds_min[k];
        longest = side > longest ? side : longest;
    }
    return longest * MEETING_SHARE;
}

static enum hl_result find_meetings(struct hlc_bridge *b,
                                    struct meetings *out)
{
    const struct hlc_world *w = b->world;
    uint64_t n = 0;
    float margin = meeting_margin(b->scene);
    struct hl_ids_box *boxes = malloc((w->n_items + 1) * sizeof *boxes);
    if (!boxes)
        return HL_ERR_MEMORY;
    for (uint32_t i = 0; i < w->n_items; i++)
        world_box(&boxes[i], &w->items[i]);
    enum hl_result r = hl_ids_overlaps(&b->hooks, boxes, w->n_items, margin, 0,
                                       NULL, &n);
    if (r == HL_OK || r == HL_ERR_LIMIT) {
        out->n = n < MEETINGS_MAX ? (uint32_t)n : MEETINGS_MAX;
        out->pairs = malloc(((size_t)out->n + 1) * 2 * sizeof *out->pairs);
        r = out->pairs ? hl_ids_overlaps(&b->hooks, boxes, w->n_items, margin,
                                         out->n, out->pairs, &n)
                       : HL_ERR_MEMORY;
    }
    free(boxes);
    return r == HL_ERR_LIMIT ? HL_OK : r;
}

/* ---- the schemes ------------------------------------------------------- */

static struct hlc_part *part_of(const struct hlc_bridge *b, uint32_t item)
{
    uint32_t object = b->world->item_object[item];
    return &b->parts[b->scene->objects[object].mesh];
}

static void number_plain(struct hlc_part *part)
{
    for (uint32_t g = 0; g < part->prep.n_groups; g++)
        part->code[g] = g;
}

static enum hl_result color_parts(struct hlc_bridge *b)
{
    struct hl_ids_coloring c;
    enum hl_result r = HL_OK;
    for (uint32_t i = 0; i < b->scene->n_meshes && r == HL_OK; i++) {
        struct hlc_part *p = &b->parts[i];
        if (!p->used)
            continue;
        p->color = calloc(p->prep.n_groups, sizeof *p->color);
        if (!p->color)
            return HL_ERR_MEMORY;
        r = hl_ids_color(&b->hooks, p->prep.n_groups, p->prep.pairs,
                         p->prep.n_pairs, 0, p->color, &c);
        p->n_colors = c.n_colors;
    }
    return r;
}

static void use_plan(struct hlc_bridge *b, const struct hl_ids_plan *plan,
                     const uint32_t *base)
{
    static const char *const names[] = { "unique", "groups-colored",
                                         "colored" };
    for (uint32_t i = 0; i < b->scene->n_meshes; i++) {
        struct hlc_part *p = &b->parts[i];
        for (uint32_t g = 0; p->used && g < p->prep.n_groups; g++)
            p->code[g] = hl_ids_region(plan, 0, g,
                                       p->color ? p->color[g] : g);
    }
    for (uint32_t i = 0; i < b->world->n_items; i++)
        b->world->items[i].id_base = base[i];
    b->world->ids.scheme = names[plan->scheme];
    b->world->ids.highest = plan->n_ids;
    b->world->ids.collisions = (uint64_t)plan->n_conflicts + plan->n_folded;
}

/* As hl_ids_assign's last resort, also where more would fit. */
static enum hl_result color_objects(struct hlc_bridge *b,
                                    const struct hl_ids_scene *s,
                                    uint32_t *base, struct hl_ids_plan *plan)
{
    struct hl_ids_coloring c;
    memset(plan, 0, sizeof *plan);
    plan->scheme = HL_IDS_COLORED;
    plan->stride = 1;
    for (uint32_t i = 0; i < s->n_objects; i++) {
        uint32_t n = s->objects[i].n_colors;
        plan->n_folded += n > s->limit;
        n = n < s->limit ? n : s->limit;
        plan->stride = n > plan->stride ? n : plan->stride;
    }
    enum hl_result r = hl_ids_color(&b->hooks, s->n_objects, s->meetings,
                                    s->n_meetings, s->limit / plan->stride,
                                    base, &c);
    for (uint32_t i = 0; r == HL_OK && i < s->n_objects; i++)
        base[i] = 1 + base[i] * plan->stride;
    plan->n_object_colors = c.n_colors;
    plan->n_conflicts = c.n_conflicts;
    plan->n_ids = c.n_colors * plan->stride;
    return r;
}

static enum hl_result number_colored(struct hlc_bridge *b, uint32_t *base)
{
    const struct hlc_world *w = b->world;
    struct meetings meet = { NULL, 0 };
    struct hl_ids_plan plan;
    struct hl_ids_object *objects = malloc((w->n_items + 1) * sizeof *objects);
    enum hl_result r = objects ? color_parts(b) : HL_ERR_MEMORY;
    if (r == HL_OK)
        r = find_meetings(b, &meet);
    for (uint32_t i = 0; r == HL_OK && i < w->n_items; i++) {
        objects[i].n_groups = part_of(b, i)->prep.n_groups;
        objects[i].n_colors = part_of(b, i)->n_colors;
    }
    struct hl_ids_scene s = { objects, w->n_items, hl_ids_limit(ID_BITS),
                              meet.pairs, meet.n };
    if (r == HL_OK)
        r = b->options->ids == HLC_IDS_COLORED
            ? color_objects(b, &s, base, &plan)
            : hl_ids_assign(&b->hooks, &s, base, &plan);
    if (r == HL_OK)
        use_plan(b, &plan, base);
    free(objects);
    free(meet.pairs);
    return r;
}

/* ---- as published ------------------------------------------------------ */

/* The shader adds group to base, so hl_ids_paper_region's two exceptions (0
 * and 65,535) hold by moving the bases of objects 0 and 255 by one. */
static uint32_t paper_base(uint64_t stream, uint32_t item)
{
    uint32_t base = (uint32_t)hl_ids_random8(stream, item) << 8;
    return base == 0 ? 1 : base == 65280 ? 65279 : base;
}

static enum hl_result number_paper(struct hlc_bridge *b)
{
    struct hlc_world *w = b->world;
    struct meetings meet = { NULL, 0 };
    enum hl_result r = find_meetings(b, &meet);
    /* Stream 0 of a seed numbers the objects, i + 1 the groups of mesh i. */
    uint64_t seed = (uint64_t)b->options->ids_seed << 32;
    for (uint32_t i = 0; i < b->scene->n_meshes; i++) {
        struct hlc_part *p = &b->parts[i];
        for (uint32_t g = 0; p->used && g < p->prep.n_groups; g++)
            p->code[g] = hl_ids_random8(seed + i + 1, g);
    }
    w->ids.scheme = "paper";
    w->ids.highest = 65534;
    for (uint32_t i = 0; i < w->n_items; i++) {
        const struct hlc_part *p = part_of(b, i);
        w->items[i].id_base = paper_base(seed, i);
        w->ids.collisions += hl_ids_count_shared(p->prep.pairs,
                                                 p->prep.n_pairs, p->code);
    }
    for (uint32_t i = 0; r == HL_OK && i < meet.n; i++)
        w->ids.collisions += w->items[meet.pairs[2 * (size_t)i]].id_base ==
                             w->items[meet.pairs[2 * (size_t)i + 1]].id_base;
    free(meet.pairs);
    return r;
}

/* ---- choice ------------------------------------------------------------ */

static bool number_unique(struct hlc_bridge *b, uint32_t *base,
                          uint32_t *groups)
{
    struct hlc_world *w = b->world;
    uint64_t needed = 0;
    for (uint32_t i = 0; i < w->n_items; i++)
        groups[i] = part_of(b, i)->prep.n_groups;
    if (hl_ids_unique(w->n_items, groups, hl_ids_limit(ID_BITS), base,
                      &needed) != HL_OK)
        return false;
    for (uint32_t i = 0; i < b->scene->n_meshes; i++)
        if (b->parts[i].used)
            number_plain(&b->parts[i]);
    for (uint32_t i = 0; i < w->n_items; i++)
        w->items[i].id_base = base[i];
    w->ids.scheme = "unique";
    w->ids.highest = (uint32_t)needed;
    return true;
}

bool hlc_ids_number(struct hlc_bridge *b)
{
    struct hlc_world *w = b->world;
    enum hl_result r = HL_OK;
    uint32_t *base = calloc(w->n_items + 1, sizeof *base);
    uint32_t *groups = calloc(w->n_items + 1, sizeof *groups);
    for (uint32_t i = 0; i < w->n_items; i++)
        w->ids.regions += part_of(b, i)->prep.n_groups;
    if (!base || !groups)
        r = HL_ERR_MEMORY;
    else if (b->options->ids == HLC_IDS_PAPER)
        r = number_paper(b);
    else if (b->options->ids == HLC_IDS_COLORED ||
             !number_unique(b, base, groups))
        r = number_colored(b, base);
    free(base);
    free(groups);
    return r == HL_OK || hlc_bridge_fail(b, "region ids", r);
}
