/* SPDX-License-Identifier: Zlib */
/* A frame's patterns: checks, the last frame, the modes but BEST, counts. */
#include <string.h>
#include "core/mem.h"
#include "core/stipple_work.h"

/* ---- memory ---------------------------------------------------------- */

struct carve {
    unsigned char *base;     /* NULL: only count                             */
    size_t used;
    bool overflow;
};

static void *carve(struct carve *c, size_t count, size_t size)
{
    size_t at = (c->used + 15) & ~(size_t)15;
    if (c->overflow || !hl_mem_fits(count, size) || at < c->used ||
        count * size > SIZE_MAX - at) {
        c->overflow = true;
        return NULL;
    }
    c->used = at + count * size;
    return c->base ? c->base + at : NULL;
}

static void carve_all(struct carve *c, struct hl_stipple *s)
{
    size_t n = s->max_objects, m = s->max_pairs, each = sizeof(uint32_t);
    carve(c, 1, sizeof *s);
    s->last_id = carve(c, n, each);
    s->last_pattern = carve(c, n, 1);
    s->sort = carve(c, 2 * n, sizeof *s->sort);
    s->by_id = carve(c, n, each);
    s->by_rank = carve(c, n, each);
    s->weight = carve(c, n, each);
    s->loss = carve(c, n, each);
    s->prev = carve(c, n, 1);
    s->pattern = carve(c, n, 1);
    s->taken = carve(c, n, sizeof *s->taken);
    s->first = carve(c, n + 1, each);
    s->to = carve(c, m, 2 * each);
    s->firm = carve(c, n, 1);
    s->group = carve(c, n, each);
    s->member = carve(c, n, each);
    s->ends = carve(c, n, each);
    s->place = carve(c, n, each);
    s->heap = carve(c, n, each);
    s->pairs = carve(c, m, 2 * each); /* last: overruns leave the block      */
}

/* False: out of range. */
static bool set_limits(struct hl_stipple *s, uint32_t max_objects,
                       uint32_t max_pairs)
{
    uint64_t n = max_objects, all = n > 1 ? n * (n - 1) / 2 : 0;
    memset(s, 0, sizeof *s);
    if (n == 0 || n > HL_STIPPLE_MAX_OBJECTS ||
        max_pairs > HL_STIPPLE_MAX_PAIRS)
        return false;
    s->max_objects = max_objects;
    s->max_pairs = max_pairs ? max_pairs
                 : (uint32_t)(all < 32 * n ? all : 32 * n);
    return true;
}

size_t hl_stipple_bytes(uint32_t max_objects, uint32_t max_pairs)
{
    struct carve c = { NULL, 0, false };
    struct hl_stipple s;
    if (!set_limits(&s, max_objects, max_pairs))
        return 0;
    carve_all(&c, &s);
    return c.overflow ? 0 : c.used;
}

struct hl_stipple *hl_stipple_create(void *memory, uint32_t max_objects,
                                     uint32_t max_pairs)
{
    struct carve c = { memory, 0, false };
    struct hl_stipple *s = memory;
    if (!memory || hl_stipple_bytes(max_objects, max_pairs) == 0)
        return NULL;
    set_limits(s, max_objects, max_pairs);
    carve_all(&c, s);
    return s;
}

void hl_stipple_forget(struct hl_stipple *s)
{
    if (s)
        s->n_last = 0;
}

/* ---- checks ---------------------------------------------------------- */

static bool number(float x) { return x == x; }

static bool object_good(const struct hl_stipple_object *o,
                        const struct hl_stipple_frame *f)
{
    bool deep = f->mode == HL_STIPPLE_BY_DEPTH ||
                f->mode == HL_STIPPLE_BY_DEPTH_FREE;
    return number(o->x0) && number(o->y0) && number(o->x1) && number(o->y1) &&
           (!deep || number(o->depth)) &&
           (f->mode != HL_STIPPLE_USER || o->wanted <= f->patterns) &&
           (!o->outline || hl_stipple_outline_good(o->outline));
}

static enum hl_result check(const struct hl_stipple *s,
                            const struct hl_stipple_frame *f,
                            const uint8_t *pattern)
{
    if (!s || !f || (f->n_objects > 0 && (!f->objects || !pattern)) ||
        f->patterns < 1 || f->patterns > HL_STIPPLE_MAX_PATTERNS ||
        (unsigned)f->mode > HL_STIPPLE_BY_DEPTH_FREE ||
        f->hold > 100 || !(f->margin >= 0 && f->margin - f->margin == 0))
        return HL_ERR_INVALID;
    if (f->n_objects > s->max_objects)
        return HL_ERR_LIMIT;
    for (uint32_t i = 0; i < f->n_objects; i++)
        if (!object_good(&f->objects[i], f))
            return HL_ERR_INVALID;
    return HL_OK;
}

/* ---- order ----------------------------------------------------------- */

static uint32_t weight_of(const struct hl_stipple_object *o)
{
    uint32_t w = o->weight ? o->weight : 1;
    return w < HL_STIPPLE_MAX_WEIGHT ? w : HL_STIPPLE_MAX_WEIGHT;
}

static void sort(struct hl_stipple *s)
{
    hl_stipple_sort(s->sort, s->sort + s->max_objects, s->n);
}

/* False: an id is there twice. */
static bool order_by_id(struct hl_stipple *s)
{
    for (uint32_t i = 0; i < s->n; i++) {
        s->sort[i].key = s->objects[i].id;
        s->sort[i].at = i;
    }
    sort(s);
    for (uint32_t i = 0; i < s->n; i++) {
        if (i > 0 && s->sort[i].key == s->sort[i - 1].key)
            return false;
        s->by_id[i] = s->sort[i].at;
    }
    return true;
}

/* Pattern of the last frame; both are in order of ids, and *at follows. */
static uint8_t find_last(const struct hl_stipple *s, uint32_t id, uint32_t *at)
{
    while (*at < s->n_last && s->last_id[*at] < id)
        ++*at;
    return *at < s->n_last && s->last_id[*at] == id ? s->last_pattern[*at] : 0;
}

/* With `hold` percent, one without a pattern takes it from another only when
 * it is that much heavier. At most twice HL_STIPPLE_MAX_WEIGHT. */
static uint32_t loss_of(const struct hl_stipple_object *o, uint8_t prev,
                        uint32_t hold)
{
    uint64_t w = weight_of(o);
    bool held = prev != 0 && prev != HL_STIPPLE_NONE;
    return (uint32_t)(held ? w * (100 + hold) / 100 : w);
}

static void order_by_loss(struct hl_stipple *s, uint32_t hold)
{
    uint32_t at = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const struct hl_stipple_object *o = &s->objects[s->by_id[i]];
        s->pattern[i] = find_last(s, o->id, &at);
        s->sort[i].key = ~loss_of(o, s->pattern[i], hold);
        s->sort[i].at = i;
    }
    sort(s);
    for (uint32_t v = 0; v < s->n; v++) {
        uint32_t i = s->sort[v].at;
        s->by_rank[v] = s->by_id[i];
        s->weight[v] = weight_of(&s->objects[s->by_id[i]]);
        s->loss[v] = ~s->sort[v].key;
        s->prev[v] = s->pattern[i];
    }
    memset(s->pattern, 0, s->n);
}

/* ---- the other modes ------------------------------------------------- */

static void as_wanted(struct hl_stipple *s)
{
    for (uint32_t v = 0; v < s->n; v++) {
        uint32_t wanted = s->objects[s->by_rank[v]].wanted;
        s->pattern[v] = wanted ? (uint8_t)wanted : HL_STIPPLE_NONE;
    }
}

static uint8_t lowest_free(const struct hl_stipple *s, uint32_t v)
{
    uint32_t taken = 0;
    for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++)
        if (s->to[e] & HL_STIPPLE_TRUE_EDGE) {
            uint32_t c = s->pattern[s->to[e] & HL_STIPPLE_RANK];
            taken |= c == HL_STIPPLE_NONE ? 0 : 1u << c;
        }
    for (uint32_t c = 1; c <= s->patterns; c++)
        if (!(taken >> c & 1))
            return (uint8_t)c;
    return HL_STIPPLE_NONE;
}

/* s->place, from an object's index to its rank, brings ids' order in, so
 * that a stable sort leaves equal depths by id. */
static void by_depth(struct hl_stipple *s, bool lowest)
{
    for (uint32_t v = 0; v < s->n; v++)
        s->place[s->by_rank[v]] = v;
    for (uint32_t i = 0; i < s->n; i++) {
        s->sort[i].key = hl_stipple_key(s->objects[s->by_id[i]].depth);
        s->sort[i].at = s->place[s->by_id[i]];
    }
    sort(s);
    for (uint32_t i = 0; i < s->n; i++) {
        uint32_t v = s->sort[i].at;
        if (lowest)
            s->pattern[v] = lowest_free(s, v);
        else
            s->pattern[v] = (uint8_t)(1 + i % s->patterns);
    }
}

/* ---- results --------------------------------------------------------- */

static void count_object(const struct hl_stipple *s, uint32_t v,
                         struct hl_stipple_stats *out)
{
    if (s->pattern[v] == HL_STIPPLE_NONE) {
        out->unassigned++;
        out->unassigned_weight += s->weight[v];
    }
    if (hl_stipple_changed(s->prev[v], s->pattern[v])) {
        out->changes++;
        out->changes_weight += s->weight[v];
    }
}

static void count_pairs(const struct hl_stipple *s,
                        struct hl_stipple_stats *out)
{
    for (size_t i = 0; i < s->n_pairs; i++) {
        uint32_t v = s->pairs[2 * i], edge = s->pairs[2 * i + 1];
        uint8_t a = s->pattern[v], b = s->pattern[edge & HL_STIPPLE_RANK];
        if (!(edge & HL_STIPPLE_TRUE_EDGE))
            continue;
        out->pairs++;
        out->conflicts += a == b && a != HL_STIPPLE_NONE;
    }
}

static void finish(struct hl_stipple *s, uint8_t *pattern,
                   struct hl_stipple_stats *out)
{
    for (uint32_t v = 0; v < s->n; v++) {
        count_object(s, v, out);
        pattern[s->by_rank[v]] = s->pattern[v];
    }
    count_pairs(s, out);
    for (uint32_t i = 0; i < s->n; i++) {
        s->last_id[i] = s->objects[s->by_id[i]].id;
        s->last_pattern[i] = pattern[s->by_id[i]];
    }
    s->n_last = s->n;
}

static void assign(struct hl_stipple *s, const struct hl_stipple_frame *f,
                   struct hl_stipple_stats *out)
{
    s->patterns = f->patterns;
    s->steps = f->max_steps ? f->max_steps : HL_STIPPLE_STEPS;
    if (f->mode == HL_STIPPLE_BEST)
        hl_stipple_color(s, out);
    else if (f->mode == HL_STIPPLE_USER)
        as_wanted(s);
    else
        by_depth(s, f->mode == HL_STIPPLE_BY_DEPTH_FREE);
}

enum hl_result hl_stipple_assign(struct hl_stipple *s,
                                 const struct hl_stipple_frame *f,
                                 uint8_t *pattern,
                                 struct hl_stipple_stats *stats)
{
    struct hl_stipple_stats out;
    enum hl_result result = check(s, f, pattern);
    bool fits;
    if (result != HL_OK)
        return result;
    memset(&out, 0, sizeof out);
    s->objects = f->objects;
    s->n = f->n_objects;
    if (!order_by_id(s))
        return HL_ERR_INVALID;
    order_by_loss(s, f->hold);
    fits = hl_stipple_edges(s, f->margin, &out.near_pairs);
    if (fits) {
        assign(s, f, &out);
        finish(s, pattern, &out);
    }
    if (stats)
        *stats = out;
    return fits ? HL_OK : HL_ERR_LIMIT;
}
