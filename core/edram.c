/* SPDX-License-Identifier: Zlib */
/* EDRAM: where each target lies while it is drawn to. Overlap is legal there,
 * so it is a rule of lifetimes: a target lives from the first pass that binds
 * it to the last, where it is resolved (K 5.1; K = Kircher, Lawrance 2009).
 * No surface runs over the end, though addressing would wrap. */
#include "core/pipe.h"

struct surface {
    uint64_t tiles, base;
    uint32_t from, to;           /* passes; from > to: never bound           */
};

struct placing {
    const struct hl_plan *plan;
    const struct hl_caps *caps;
    struct surface s[HL_PLAN_TARGETS];  /* as plan->target                   */
};

/* ---- lifetimes ---------------------------------------------------------- */

static bool binds(const struct hl_plan_pass *s, enum hl_role role)
{
    return s->depth == role || hl_pass_colors(s, role);
}

static bool of_light_size(enum hl_role r)
{
    return r == HL_ROLE_NORMAL || r == HL_ROLE_DSF || r == HL_ROLE_EXPONENT ||
           r == HL_ROLE_MOTION || r == HL_ROLE_LIGHT_DEPTH ||
           r == HL_ROLE_DEPTH_COPY || r == HL_ROLE_LIGHT;
}

static void live(struct placing *k, uint32_t i, bool resident)
{
    const struct hl_plan *p = k->plan;
    const struct hl_plan_target *t = &p->target[i];
    struct surface *s = &k->s[i];
    s->from = 1;
    s->to = 0;
    for (uint32_t n = 0; n < p->n_passes; n++) {
        if (binds(&p->pass[n], t->role)) {
            s->from = s->from > s->to ? n : s->from;
            s->to = n;
        } else if (s->from <= s->to && !k->caps->profile.resolve_to_read &&
                   t->read_by >> p->pass[n].role & 1u) {
            s->to = n;
        }
    }
    if (s->from > s->to)
        return;
    /* Depth stays whether the light pass tests it or not: it may (K 5.1). */
    for (uint32_t n = s->to + 1; n < p->n_passes; n++)
        if (p->pass[n].role == HL_PASS_LIGHT && of_light_size(t->role) &&
            (resident || t->role == HL_ROLE_LIGHT_DEPTH))
            s->to = n;
}

static uint64_t tiles_of(const struct placing *k, uint32_t i, uint32_t width,
                         uint32_t height)
{
    const struct hl_plan_target *t = &k->plan->target[i];
    return hl_edram_tiles(&k->caps->profile,
                          hl_plan_console_format(k->caps, t), width, height,
                          t->samples);
}

static void measure(struct placing *k, bool resident)
{
    for (uint32_t i = 0; i < k->plan->n_targets; i++) {
        const struct hl_plan_target *t = &k->plan->target[i];
        live(k, i, resident);
        k->s[i].tiles = tiles_of(k, i, t->width, t->height);
    }
}

/* Tiles of what lives in a pass, L-buffer targets taken as of that size
 * where width > 0. */
static uint64_t sum(const struct placing *k, uint32_t pass, uint32_t width,
                    uint32_t height)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < k->plan->n_targets; i++) {
        const struct surface *s = &k->s[i];
        if (s->from > pass || s->to < pass)
            continue;
        n += width && of_light_size(k->plan->target[i].role)
             ? tiles_of(k, i, width, height) : s->tiles;
    }
    return n;
}

/* Pass of the largest sum. */
static uint32_t fullest(const struct placing *k, uint64_t *most)
{
    uint32_t pass = 0;
    *most = 0;
    for (uint32_t n = 0; n < k->plan->n_passes; n++)
        if (sum(k, n, 0, 0) > *most) {
            *most = sum(k, n, 0, 0);
            pass = n;
        }
    return pass;
}

/* ---- placing ------------------------------------------------------------ */

static bool meet(const struct surface *a, const struct surface *b)
{
    return a->from <= b->to && b->from <= a->to &&
           a->base < b->base + b->tiles && b->base < a->base + a->tiles;
}

/* Lowest base at which surface i meets none of those done. */
static void put(struct placing *k, uint32_t i, const bool *done)
{
    struct surface *s = &k->s[i];
    bool again = true;
    s->base = 0;
    while (again) {
        again = false;
        for (uint32_t j = 0; j < k->plan->n_targets; j++)
            if (done[j] && meet(s, &k->s[j])) {
                s->base = k->s[j].base + k->s[j].tiles;
                again = true;
            }
    }
}

/* At the end, where that is free: all below stays in one piece for shadow
 * maps, which come when all but the light's target is gone. */
static void put_last(struct placing *k, uint32_t i, const bool *done)
{
    struct surface *s = &k->s[i];
    uint64_t end = k->caps->profile.edram_tiles;
    bool free = s->tiles <= end;
    s->base = free ? end - s->tiles : 0;
    for (uint32_t j = 0; j < k->plan->n_targets; j++)
        free = free && !(done[j] && meet(s, &k->s[j]));
    if (!free)
        put(k, i, done);
}

/* Depth first, so that what comes and goes beside it stays in one piece. */
static bool place(struct placing *k)
{
    static const enum hl_role order[] = {
        HL_ROLE_LIGHT_DEPTH, HL_ROLE_NORMAL, HL_ROLE_DSF, HL_ROLE_EXPONENT,
        HL_ROLE_MOTION, HL_ROLE_DEPTH_COPY, HL_ROLE_LIGHT,
        HL_ROLE_SHADOW_MAP, HL_ROLE_DEPTH, HL_ROLE_COLOR };
    bool maps = hl_plan_target(k->plan, HL_ROLE_SHADOW_MAP) != NULL;
    bool done[HL_PLAN_TARGETS] = { false }, fits = true;
    for (uint32_t o = 0; o < sizeof order / sizeof *order; o++)
        for (uint32_t i = 0; i < k->plan->n_targets; i++) {
            if (k->plan->target[i].role != order[o] ||
                k->s[i].from > k->s[i].to)
                continue;
            if (maps && order[o] == HL_ROLE_LIGHT)
                put_last(k, i, done);
            else
                put(k, i, done);
            done[i] = true;
            fits = fits && k->s[i].base + k->s[i].tiles <=
                           k->caps->profile.edram_tiles;
        }
    return fits;
}

static void keep(struct hl_plan *p, const struct placing *k)
{
    uint64_t most;
    fullest(k, &most);
    p->edram_tiles = (uint32_t)most;
    for (uint32_t i = 0; i < p->n_targets; i++) {
        if (k->s[i].from > k->s[i].to)
            continue;
        p->target[i].edram_tiles = (uint32_t)k->s[i].tiles;
        if (k->caps->console_memory)
            p->target[i].console.edram_tile = (uint16_t)(k->s[i].base + 1);
    }
}

/* ---- what would fit ----------------------------------------------------- */

static bool all_fit(const struct placing *k, uint32_t width, uint32_t height)
{
    for (uint32_t n = 0; n < k->plan->n_passes; n++)
        if (sum(k, n, width, height) > k->caps->profile.edram_tiles)
            return false;
    return true;
}

/* Width of the aspect `w` to `h`, to half a texel. */
static uint32_t beside(uint32_t height, uint32_t w, uint32_t h)
{
    uint64_t x = ((uint64_t)height * w + h / 2) / h;
    return x ? (uint32_t)x : 1;
}

/* Largest L-buffer of that aspect, at most as high; 0: none. Tiles grow with
 * the height, so the bounds close in on it. */
static uint32_t largest(const struct placing *k, uint32_t w, uint32_t h)
{
    uint32_t fits = 0, fails = h + 1;
    while (fails - fits > 1) {
        uint32_t y = fits + (fails - fits) / 2;
        if (all_fit(k, beside(y, w, h), y))
            fits = y;
        else
            fails = y;
    }
    return fits;
}

static uint64_t rect_tiles(const struct placing *k, uint32_t pass,
                           uint32_t width, uint32_t height)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < k->plan->n_targets; i++)
        if (binds(&k->plan->pass[pass], k->plan->target[i].role))
            n += tiles_of(k, i, width, height);
    return n;
}

/* Side of a rectangle, of `parts`; resolves copy blocks of 32 x 32 pixels
 * (spec/consoles 1.4). */
static uint32_t part(uint32_t side, uint32_t parts)
{
    uint32_t x = (side / parts + (side % parts != 0) + 31) / 32 * 32;
    return x < side ? x : side;
}

/* Predicated tiling: the pass drawn again for each of the fewest rectangles
 * that hold its targets. Rows before columns: fewer edges cross objects. */
static void say_tiling(struct hl_plan *out, const struct placing *k,
                       uint32_t pass, uint64_t tiles, uint32_t width,
                       uint32_t height)
{
    enum { MORE = 256 };
    uint64_t limit = k->caps->profile.edram_tiles;
    uint64_t least = (tiles + limit - 1) / limit;
    if (least > 65536)
        return;
    for (uint32_t n = (uint32_t)least; n < least + MORE; n++)
        for (uint32_t rows = n; rows > 0; rows--) {
            uint32_t w, h;
            if (n % rows)
                continue;
            w = part(width, n / rows);
            h = part(height, rows);
            if (rect_tiles(k, pass, w, h) > limit)
                continue;
            hl_plan_why(out, HL_WHY_EDRAM_TILING, (float)n, (float)w,
                        (float)h, (float)rect_tiles(k, pass, w, h));
            return;
        }
}

static void say_fit(struct hl_plan *out, struct placing *k, bool resident,
                    uint32_t w, uint32_t h)
{
    uint64_t most = 0;
    measure(k, resident);
    uint32_t y = largest(k, w, h), x = y ? beside(y, w, h) : 0;
    for (uint32_t n = 0; y && n < k->plan->n_passes; n++)
        if (k->plan->pass[n].role == HL_PASS_GEOMETRY ||
            k->plan->pass[n].role == HL_PASS_LIGHT) {
            uint64_t s = sum(k, n, x, y);
            most = s > most ? s : most;
        }
    if (y)
        hl_plan_why(out, resident ? HL_WHY_EDRAM_FITS_RESIDENT
                                  : HL_WHY_EDRAM_FITS, (float)x, (float)y,
                    (float)most, 0);
}

/* The paper's set by itself: what further channels add is told apart. */
static void say_set(struct hl_plan *out, const struct placing *k)
{
    uint64_t set = 0, light = 0, more = 0;
    for (uint32_t i = 0; i < k->plan->n_targets; i++) {
        enum hl_role r = k->plan->target[i].role;
        if (r == HL_ROLE_NORMAL || r == HL_ROLE_DSF || r == HL_ROLE_LIGHT_DEPTH)
            set += k->s[i].tiles;
        else if (r == HL_ROLE_LIGHT)
            light = k->s[i].tiles;
        else if (of_light_size(r))
            more += k->s[i].tiles;
    }
    if (set)
        hl_plan_why(out, HL_WHY_EDRAM_SET, (float)set, (float)(set + light),
                    (float)more, 0);
}

static void say_refused(struct hl_plan *out, struct placing *k,
                        uint32_t pass, uint64_t tiles)
{
    const struct hl_plan *p = k->plan;
    uint32_t w = p->width, h = p->height;
    if (p->pass[pass].role == HL_PASS_GEOMETRY ||
        p->pass[pass].role == HL_PASS_LIGHT)
        say_set(out, k);
    for (uint32_t i = 0; i < p->n_targets; i++)
        if (k->s[i].from <= pass && k->s[i].to >= pass) {
            hl_plan_why(out, HL_WHY_EDRAM_SURFACE, (float)p->target[i].role,
                        (float)k->s[i].tiles, (float)p->target[i].width,
                        (float)p->target[i].height);
            w = p->target[i].width;
            h = p->target[i].height;
        }
    hl_plan_why(out, HL_WHY_EDRAM_SUM, (float)p->pass[pass].role,
                (float)tiles, (float)k->caps->profile.edram_tiles, 0);
    if (p->pass[pass].role == HL_PASS_GEOMETRY ||
        p->pass[pass].role == HL_PASS_LIGHT) {
        say_fit(out, k, false, w, h);
        say_fit(out, k, true, w, h);
    }
    say_tiling(out, k, pass, tiles, w, h);
}

/* ---- the rule ----------------------------------------------------------- */

static uint64_t tiles_by_role(const struct hl_plan *p, enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    return t ? t->edram_tiles : 0;
}

/* all: tiles of the L-buffer's passes with nothing shared. */
static void say_placed(struct hl_plan *p, uint64_t all, uint64_t used,
                       uint32_t limit, bool resident)
{
    uint64_t light = tiles_by_role(p, HL_ROLE_LIGHT);
    if (light)
        hl_plan_why(p, resident ? HL_WHY_EDRAM_RESIDENT : HL_WHY_EDRAM_SHARED,
                    (float)all, (float)limit, resident ? (float)light
                    : (float)used,
                    (float)tiles_by_role(p, HL_ROLE_LIGHT_DEPTH));
    hl_plan_why(p, HL_WHY_EDRAM_FRAME,
                (float)(tiles_by_role(p, HL_ROLE_COLOR) +
                        tiles_by_role(p, HL_ROLE_DEPTH)), (float)limit, 0, 0);
}

/* Most of the passes at L-buffer size. */
static uint64_t light_sum(const struct placing *k)
{
    uint64_t most = 0;
    for (uint32_t n = 0; n < k->plan->n_passes; n++) {
        bool of_light = k->plan->pass[n].role == HL_PASS_GEOMETRY ||
                        k->plan->pass[n].role == HL_PASS_LIGHT;
        uint64_t s = of_light ? sum(k, n, 0, 0) : 0;
        most = s > most ? s : most;
    }
    return most;
}

enum hl_refusal hl_plan_edram(struct hl_plan *p, const struct hl_ask *ask,
                              uint32_t *fit_width, uint32_t *fit_height)
{
    struct placing k = { p, ask->caps, { { 0, 0, 0, 0 } } };
    const struct hl_profile *c = &ask->caps->profile;
    *fit_width = *fit_height = 0;
    if (c->edram_tiles == 0)
        return HL_REFUSED_NOTHING;
    measure(&k, true);
    uint64_t all = light_sum(&k), most;
    bool resident = place(&k);
    if (!resident)
        measure(&k, false);
    if (resident || place(&k)) {
        keep(p, &k);
        say_set(p, &k);
        say_placed(p, all, light_sum(&k), c->edram_tiles, resident);
        return HL_REFUSED_NOTHING;
    }
    uint32_t pass = fullest(&k, &most);
    bool of_light = p->pass[pass].role == HL_PASS_GEOMETRY ||
                    p->pass[pass].role == HL_PASS_LIGHT;
    if (of_light && ask->n.light_width == 0 && ask->fit_width == 0)
        *fit_height = largest(&k, p->width, p->height);
    if (*fit_height)
        *fit_width = beside(*fit_height, p->width, p->height);
    else
        say_refused(p, &k, pass, most);
    return HL_REFUSED_EDRAM;
}
