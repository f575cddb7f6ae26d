/* SPDX-License-Identifier: Zlib */
/* The best assignment of a small group: depth first, the vertex with the
 * fewest patterns left first (Brelaz, "New methods to color the vertices of
 * a graph", 1979), cut by a lower bound from cliques. Sets are bits of a
 * word, so that a step costs tens of nanoseconds. */
#include <string.h>
#include "core/stipple_work.h"

struct node {
    uint32_t left;           /* vertices without a decision                  */
    uint32_t none;           /* decided to go without                        */
    uint64_t cost;           /* of the decisions                             */
    uint32_t open[HL_STIPPLE_MAX_PATTERNS + 1]; /* of `left`: may still take */
    uint32_t has[HL_STIPPLE_MAX_PATTERNS + 1];
};

struct search {
    struct hl_stipple_problem *p;
    uint64_t least;          /* loss that cannot be undercut                 */
    bool cut;                /* ran out of steps                             */
};

/* Index of the lowest bit: each of the 32 products has its own top 5 bits. */
static uint32_t lowest(uint32_t bits)
{
    static const uint8_t index[32] = {
        0, 1, 28, 2, 29, 14, 24, 3, 30, 22, 20, 15, 25, 17, 4, 8,
        31, 27, 13, 23, 21, 19, 16, 7, 26, 12, 18, 6, 11, 5, 10, 9 };
    return index[(bits & (0u - bits)) * 0x077CB531u >> 27];
}

static uint32_t count(uint32_t bits)
{
    bits -= bits >> 1 & 0x55555555u;
    bits = (bits & 0x33333333u) + (bits >> 2 & 0x33333333u);
    return ((bits + (bits >> 4)) & 0x0F0F0F0Fu) * 0x01010101u >> 24;
}

static uint64_t sum(const uint32_t *of, uint32_t set)
{
    uint64_t total = 0;
    for (; set; set &= set - 1)
        total += of[lowest(set)];
    return total;
}

/* What v costs without a pattern, or with pattern c. */
static uint64_t cost_none(const struct hl_stipple_problem *p, uint32_t v)
{
    uint64_t changed = (p->had & ~p->had_none) >> v & 1 ? p->weight[v] : 0;
    return (uint64_t)p->loss[v] << 32 | changed;
}

static uint64_t cost_pattern(const struct hl_stipple_problem *p, uint32_t v,
                             uint32_t c)
{
    return p->had >> v & 1 && !(p->kept[c] >> v & 1) ? p->weight[v] : 0;
}

uint64_t hl_stipple_cost_of(const struct hl_stipple_problem *p)
{
    uint64_t total = 0;
    for (uint32_t v = 0; v < p->n; v++)
        total += p->pattern[v] == HL_STIPPLE_NONE
                 ? cost_none(p, v) : cost_pattern(p, v, p->pattern[v]);
    return total;
}

/* Neighbours of each other, split off `set` greedily, the heaviest first. */
static uint32_t clique(const struct hl_stipple_problem *p, uint32_t set)
{
    uint32_t found = 0;
    while (set) {
        uint32_t v = lowest(set);
        found |= 1u << v;
        set &= p->near[v];
    }
    return found;
}

/* Without its `room` heaviest. */
static uint32_t after(uint32_t set, uint32_t room)
{
    while (room-- > 0 && set)
        set &= set - 1;
    return set;
}

/* Of a clique one keeps what all of it had. */
static uint64_t least_changed(const struct hl_stipple_problem *p, uint32_t set)
{
    uint64_t total = 0;
    while (set) {
        uint32_t k = clique(p, set);
        total += sum(p->weight, after(k, 1));
        set &= ~k;
    }
    return total;
}

/* Of a clique no more get a pattern than there are patterns open to it. */
static uint64_t least_lost(const struct hl_stipple_problem *p,
                           const struct node *s)
{
    uint64_t total = 0;
    for (uint32_t set = s->left; set;) {
        uint32_t k = clique(p, set), room = 0;
        for (uint32_t c = 1; c <= p->patterns; c++)
            room += (s->open[c] & k) != 0;
        total += sum(p->loss, after(k, room));
        set &= ~k;
    }
    return total;
}

/* Vertices that nothing is left for. */
static void close_off(const struct hl_stipple_problem *p, struct node *s)
{
    uint32_t any = 0, closed;
    for (uint32_t c = 1; c <= p->patterns; c++)
        any |= s->open[c];
    closed = s->left & ~any;
    s->left &= any;
    s->none |= closed;
    for (; closed; closed &= closed - 1)
        s->cost += cost_none(p, lowest(closed));
}

/* Another: a pattern goes to one of a clique of those it is open to. Better
 * where patterns are open to few, and dearer. */
static uint64_t least_left_over(const struct hl_stipple_problem *p,
                                const struct node *s)
{
    uint64_t all = sum(p->loss, s->left), most = 0;
    for (uint32_t c = 1; c <= p->patterns; c++)
        for (uint32_t set = s->open[c]; set;) {
            uint32_t k = clique(p, set);
            most += p->loss[lowest(k)];
            set &= ~k;
        }
    return all > most ? all - most : 0;
}

static uint64_t least_changes(const struct hl_stipple_problem *p,
                              const struct node *s)
{
    uint32_t content = s->left & (~p->had | p->had_none);
    uint64_t changed = s->cost & UINT32_MAX;
    for (uint32_t c = 1; c <= p->patterns; c++) {
        uint32_t keep = p->kept[c] & s->open[c];
        content |= keep;
        changed += least_changed(p, keep);
    }
    return changed + sum(p->weight, s->left & ~content);
}

/* True: nothing below is better than what there is. Loss and changes are
 * bounds on their own, so they are one as a pair. */
static bool hopeless(const struct search *q, const struct node *s)
{
    const struct hl_stipple_problem *p = q->p;
    uint64_t best = p->cost >> 32, lost = (s->cost >> 32) + least_lost(p, s);
    bool changes;            /* too many                                     */
    if (lost > best)
        return true;
    changes = least_changes(p, s) >= (p->cost & UINT32_MAX);
    if (changes && (lost >= best || q->least >= best))
        return true;
    lost = (s->cost >> 32) + least_left_over(p, s);
    return lost > best || (lost == best && changes);
}

/* False: one that goes without could have a pattern however the rest ends,
 * so that the best is elsewhere. */
static bool maximal(const struct hl_stipple_problem *p, const struct node *s)
{
    for (uint32_t set = s->none; set; set &= set - 1) {
        uint32_t v = lowest(set);
        for (uint32_t c = 1; c <= p->patterns; c++)
            if (p->open[c] >> v & 1 && !(p->near[v] & (s->has[c] | s->open[c])))
                return false;
    }
    return true;
}

static uint32_t pick(const struct hl_stipple_problem *p, const struct node *s)
{
    uint32_t one = 0, two = 0, three = 0, set, best = 0, most = 0;
    for (uint32_t c = 1; c <= p->patterns; c++) {
        three |= two & s->open[c];
        two |= one & s->open[c];
        one |= s->open[c];
    }
    set = s->left & ~two ? s->left & ~two
        : s->left & ~three ? s->left & ~three : s->left;
    best = lowest(set);
    for (; set; set &= set - 1) {
        uint32_t v = lowest(set), degree = count(p->near[v] & s->left);
        if (degree > most) {
            most = degree;
            best = v;
        }
    }
    return best;
}

static void record(struct hl_stipple_problem *p, const struct node *s)
{
    p->cost = s->cost;
    for (uint32_t v = 0; v < p->n; v++)
        p->pattern[v] = HL_STIPPLE_NONE;
    for (uint32_t c = 1; c <= p->patterns; c++)
        for (uint32_t set = s->has[c]; set; set &= set - 1)
            p->pattern[lowest(set)] = (uint8_t)c;
}

static void visit(struct search *q, struct node *s);

static void take(struct search *q, const struct node *s, uint32_t v,
                 uint32_t c)
{
    struct node t = *s;
    uint32_t bit = 1u << v;
    t.left &= ~bit;
    for (uint32_t k = 1; k <= q->p->patterns; k++)
        t.open[k] &= ~bit;
    if (c == HL_STIPPLE_NONE) {
        t.none |= bit;
        t.cost += cost_none(q->p, v);
    } else {
        t.has[c] |= bit;
        t.open[c] &= ~q->p->near[v];
        t.cost += cost_pattern(q->p, v, c);
    }
    visit(q, &t);
}

/* Two patterns that nobody has or had, open to the same vertices: what the
 * one leads to the other does too. */
static bool twin_tried(const struct hl_stipple_problem *p,
                       const struct node *s, uint32_t c)
{
    if (s->has[c] || (p->kept[c] & s->left))
        return false;
    for (uint32_t d = 1; d < c; d++)
        if (!s->has[d] && !(p->kept[d] & s->left) && s->open[d] == s->open[c])
            return true;
    return false;
}

static void branch(struct search *q, const struct node *s)
{
    const struct hl_stipple_problem *p = q->p;
    uint32_t v = pick(p, s), old = 0;
    for (uint32_t c = 1; c <= p->patterns; c++)
        if (p->kept[c] & s->open[c] & 1u << v)
            old = c;
    if (old)
        take(q, s, v, old);
    for (uint32_t c = 1; c <= p->patterns && !q->cut; c++)
        if (c != old && s->open[c] >> v & 1 && !twin_tried(p, s, c))
            take(q, s, v, c);
    if (!q->cut)
        take(q, s, v, HL_STIPPLE_NONE);
}

static void visit(struct search *q, struct node *s)
{
    struct hl_stipple_problem *p = q->p;
    if (p->steps == 0) {
        q->cut = true;
        return;
    }
    p->steps--;
    close_off(p, s);
    if (hopeless(q, s) || !maximal(p, s))
        return;
    if (s->left == 0)
        record(p, s);
    else
        branch(q, s);
}

static bool descend(struct hl_stipple_problem *p, uint64_t least)
{
    struct search q = { p, least, false };
    struct node root = { 0, 0, 0, {0}, {0} };
    root.left = (1u << p->n) - 1;
    for (uint32_t c = 1; c <= p->patterns; c++)
        root.open[c] = p->open[c];
    visit(&q, &root);
    return !q.cut;
}

/* Loss alone first: without a last frame patterns are alike, which halves the
 * work and again. Then changes, where every branch that cannot have fewer is
 * cut, however little it may seem to lose; a quarter of the steps is kept for
 * that. */
bool hl_stipple_search(struct hl_stipple_problem *p)
{
    struct hl_stipple_problem loss = *p;
    bool proven;
    loss.had = loss.had_none = 0;
    memset(loss.kept, 0, sizeof loss.kept);
    loss.cost = p->cost & ~(uint64_t)UINT32_MAX;
    loss.steps = p->steps - p->steps / 4;
    p->steps -= loss.steps;
    proven = loss.cost == 0 || descend(&loss, 0);
    p->steps += loss.steps;
    if (loss.cost >> 32 < p->cost >> 32) {
        memcpy(p->pattern, loss.pattern, sizeof p->pattern);
        p->cost = hl_stipple_cost_of(p);
    }
    return descend(p, loss.cost >> 32) && proven;
}

bool hl_stipple_improve(struct hl_stipple_problem *p)
{
    return descend(p, 0);
}
