/* SPDX-License-Identifier: Zlib */
/* Objects that overlap on the screen: radix sort by the left edge, sweep,
 * then outlines. */
#include <string.h>
#include "core/stipple_work.h"

uint32_t hl_stipple_key(float value)
{
    uint32_t bits;
    value += 0.0f;           /* -0 and +0 are one number, so one key         */
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

/* Four stable counting passes, a byte each; a byte that all keys share, as
 * upper bytes of ids and weights often are, needs none. */
void hl_stipple_sort(struct hl_stipple_entry *a, struct hl_stipple_entry *b,
                     uint32_t n)
{
    for (uint32_t shift = 0; n > 1 && shift < 32; shift += 8) {
        uint32_t start[257] = {0};
        for (uint32_t i = 0; i < n; i++)
            start[(a[i].key >> shift & 255) + 1]++;
        if (start[(a[0].key >> shift & 255) + 1] == n)
            continue;
        for (uint32_t i = 0; i < 256; i++)
            start[i + 1] += start[i];
        for (uint32_t i = 0; i < n; i++)
            b[start[a[i].key >> shift & 255]++] = a[i];
        memcpy(a, b, n * sizeof *a);
    }
}

/* Half-open ranges share a texel, or come within a margin. In double, where
 * the sum of floats of like size is exact. */
static bool ranges_meet(float a0, float a1, float b0, float b1, float margin)
{
    double m = (double)margin;
    return (double)a0 < (double)b1 + m && (double)b0 < (double)a1 + m;
}

static bool objects_meet(const struct hl_stipple_object *a,
                         const struct hl_stipple_object *b, float margin)
{
    return ranges_meet(a->x0, a->x1, b->x0, b->x1, margin) &&
           ranges_meet(a->y0, a->y1, b->y0, b->y1, margin) &&
           (!a->outline || !b->outline ||
            hl_stipple_outlines_meet(a->outline, b->outline, margin));
}

static void add_pair(struct hl_stipple *s, uint32_t n_pairs, uint32_t v,
                     uint32_t u, float margin)
{
    const struct hl_stipple_object *a = &s->objects[s->by_rank[v]];
    const struct hl_stipple_object *b = &s->objects[s->by_rank[u]];
    bool overlap = margin == 0 || objects_meet(a, b, 0);
    s->pairs[2 * (size_t)n_pairs] = v;
    s->pairs[2 * (size_t)n_pairs + 1] =
        u | (overlap ? HL_STIPPLE_TRUE_EDGE : 0);
}

/* Returns how many pairs there are; those above max_pairs are not kept. */
static uint32_t sweep(struct hl_stipple *s, uint32_t n_seen, float margin)
{
    uint32_t found = 0;
    for (uint32_t i = 0; i < n_seen; i++) {
        uint32_t v = s->sort[i].at;
        const struct hl_stipple_object *a = &s->objects[s->by_rank[v]];
        for (uint32_t j = i + 1; j < n_seen; j++) {
            uint32_t u = s->sort[j].at;
            const struct hl_stipple_object *b = &s->objects[s->by_rank[u]];
            if (!((double)b->x0 < (double)a->x1 + (double)margin))
                break;
            if (!objects_meet(a, b, margin))
                continue;
            if (found < s->max_pairs)
                add_pair(s, found, v, u, margin);
            found++;
        }
    }
    return found;
}

/* Each pair goes into the lists of both ends. */
static void fill_lists(struct hl_stipple *s)
{
    memset(s->first, 0, (s->n + (size_t)1) * sizeof *s->first);
    for (size_t i = 0; i < 2 * (size_t)s->n_pairs; i++)
        s->first[(s->pairs[i] & HL_STIPPLE_RANK) + 1]++;
    for (uint32_t v = 0; v < s->n; v++) {
        s->first[v + 1] += s->first[v];
        s->place[v] = s->first[v];
    }
    for (size_t i = 0; i < s->n_pairs; i++) {
        uint32_t v = s->pairs[2 * i], edge = s->pairs[2 * i + 1];
        uint32_t u = edge & HL_STIPPLE_RANK;
        s->to[s->place[v]++] = edge;
        s->to[s->place[u]++] = v | (edge & HL_STIPPLE_TRUE_EDGE);
    }
}

bool hl_stipple_edges(struct hl_stipple *s, float margin, uint32_t *near)
{
    uint32_t seen = 0;
    for (uint32_t v = 0; v < s->n; v++) {
        const struct hl_stipple_object *o = &s->objects[s->by_rank[v]];
        if (o->x0 < o->x1 && o->y0 < o->y1) {
            s->sort[seen].key = hl_stipple_key(o->x0);
            s->sort[seen++].at = v;
        }
    }
    hl_stipple_sort(s->sort, s->sort + s->max_objects, seen);
    *near = sweep(s, seen, margin);
    if (*near > s->max_pairs)
        return false;
    s->n_pairs = *near;
    fill_lists(s);
    return true;
}
