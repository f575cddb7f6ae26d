/* SPDX-License-Identifier: Zlib */
/* The best patterns: group by group, first what the last frame leaves, then
 * a search, of the whole group or of one neighbourhood after the other. */
#include <string.h>
#include "core/stipple_work.h"

#define NOBODY UINT32_MAX
/* The search around one object of a group that is too large for a whole one:
 * of 16 objects most are proven in 64 steps, and measured scenes change less
 * with 16 than with 12 or 24. With more patterns an object has more neighbours
 * before it finds none free. */
enum { BALL = 13 /* + patterns */, BALL_STEPS = 64,
       REPAIR_STEPS = 16 /* an object */ };

/* ---- a first assignment ---------------------------------------------- */

static void set_pattern(struct hl_stipple *s, uint32_t v, uint32_t c)
{
    s->pattern[v] = (uint8_t)c;
    s->used[c] += s->weight[v];
    for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++)
        if (hl_stipple_joins(s, v, s->to[e]))
            s->taken[s->to[e] & HL_STIPPLE_RANK] |= (uint16_t)(1u << c);
}

static uint32_t n_free(const struct hl_stipple *s, uint32_t v)
{
    uint32_t n = 0;
    for (uint32_t c = 1; c <= s->patterns; c++)
        n += !(s->taken[v] >> c & 1);
    return n;
}

/* The pattern that least of the frame has, so that objects which meet later
 * differ already as often as can be. 0: none is free. */
static uint32_t least_used(const struct hl_stipple *s, uint32_t v)
{
    uint32_t best = 0;
    for (uint32_t c = 1; c <= s->patterns; c++)
        if (!(s->taken[v] >> c & 1) &&
            (best == 0 || s->used[c] < s->used[best]))
            best = c;
    return best;
}

/* A heap of ranks; fewest free patterns first (Brelaz 1979), then weight. */
static uint32_t urgency(const struct hl_stipple *s, uint32_t v)
{
    return n_free(s, v) << 24 | v;
}

static void sift_up(struct hl_stipple *s, uint32_t at, uint32_t v)
{
    uint32_t key = urgency(s, v);
    while (at > 0 && urgency(s, s->heap[(at - 1) / 2]) > key) {
        s->heap[at] = s->heap[(at - 1) / 2];
        s->place[s->heap[at]] = at;
        at = (at - 1) / 2;
    }
    s->heap[at] = v;
    s->place[v] = at;
}

static uint32_t pop(struct hl_stipple *s, uint32_t *n)
{
    uint32_t top = s->heap[0], v = s->heap[--*n], at = 0;
    uint32_t key = urgency(s, v);
    for (uint32_t child; (child = 2 * at + 1) < *n; at = child) {
        if (child + 1 < *n && urgency(s, s->heap[child + 1]) <
                              urgency(s, s->heap[child]))
            child++;
        if (urgency(s, s->heap[child]) > key)
            break;
        s->heap[at] = s->heap[child];
        s->place[s->heap[at]] = at;
    }
    s->heap[at] = v;
    s->place[v] = at;
    s->place[top] = NOBODY;
    return top;
}

/* All that can keep theirs do, the heaviest first. */
static uint32_t keep_old(struct hl_stipple *s, uint32_t from, uint32_t to)
{
    uint32_t n = 0;
    for (uint32_t i = from; i < to; i++) {
        uint32_t v = s->member[i], c = s->prev[v];
        s->place[v] = NOBODY;
        if (c >= 1 && c <= s->patterns && !(s->taken[v] >> c & 1))
            set_pattern(s, v, c);
        else
            s->pattern[v] = 0;
    }
    for (uint32_t i = from; i < to; i++)
        if (s->pattern[s->member[i]] == 0) {
            sift_up(s, n, s->member[i]);
            n++;
        }
    return n;
}

static void first_assignment(struct hl_stipple *s, uint32_t from, uint32_t to)
{
    for (uint32_t n = keep_old(s, from, to); n > 0;) {
        uint32_t v = pop(s, &n), c = least_used(s, v);
        s->pattern[v] = HL_STIPPLE_NONE;
        if (c == 0)
            continue;
        set_pattern(s, v, c);
        for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++) {
            uint32_t u = s->to[e] & HL_STIPPLE_RANK;
            if (hl_stipple_joins(s, v, s->to[e]) && s->place[u] != NOBODY)
                sift_up(s, s->place[u], u);
        }
    }
}

/* ---- the search ------------------------------------------------------ */

static void count_used(struct hl_stipple *s, uint32_t v, bool in)
{
    if (s->pattern[v] == HL_STIPPLE_NONE)
        return;
    if (in)
        s->used[s->pattern[v]] += s->weight[v];
    else
        s->used[s->pattern[v]] -= s->weight[v];
}

static bool could_be_better(const struct hl_stipple *s, uint32_t v)
{
    return s->pattern[v] == HL_STIPPLE_NONE ||
           hl_stipple_changed(s->prev[v], s->pattern[v]);
}

static void place_vertex(const struct hl_stipple *s,
                         struct hl_stipple_problem *p, const uint32_t *ranks,
                         uint32_t i)
{
    uint32_t v = ranks[i], bit = 1u << i, outside = 0;
    p->weight[i] = s->weight[v];
    p->loss[i] = s->loss[v];
    p->pattern[i] = s->pattern[v];
    if (s->prev[v])
        p->had |= bit;
    if (s->prev[v] == HL_STIPPLE_NONE)
        p->had_none |= bit;
    else if (s->prev[v] && s->prev[v] <= s->patterns)
        p->kept[s->prev[v]] |= bit;
    for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++) {
        uint32_t u = s->to[e] & HL_STIPPLE_RANK;
        if (!hl_stipple_joins(s, v, s->to[e]))
            continue;
        if (s->place[u] != NOBODY)
            p->near[i] |= 1u << s->place[u];
        else if (s->pattern[u] != HL_STIPPLE_NONE)
            outside |= 1u << s->pattern[u];
    }
    for (uint32_t c = 1; c <= s->patterns; c++)
        if (!(outside >> c & 1))
            p->open[c] |= bit;
}

/* Solves ranks[0..n-1], ascending, the rest as it is. Their place is NOBODY
 * before and after. *better: something was found. True: proven best. */
static bool solve(struct hl_stipple *s, const uint32_t *ranks, uint32_t n,
                  uint32_t steps, bool whole, bool *better)
{
    struct hl_stipple_problem p;
    uint64_t cost;
    bool proven;
    memset(&p, 0, sizeof p);
    p.n = n;
    p.patterns = s->patterns;
    p.steps = steps < s->steps ? steps : s->steps;
    s->steps -= p.steps;
    for (uint32_t i = 0; i < n; i++)
        s->place[ranks[i]] = i;
    for (uint32_t i = 0; i < n; i++)
        place_vertex(s, &p, ranks, i);
    cost = p.cost = hl_stipple_cost_of(&p);
    proven = whole ? hl_stipple_search(&p) : hl_stipple_improve(&p);
    *better = p.cost < cost;
    for (uint32_t i = 0; i < n; i++) {
        count_used(s, ranks[i], false);
        s->pattern[ranks[i]] = p.pattern[i];
        s->place[ranks[i]] = NOBODY;
        count_used(s, ranks[i], true);
    }
    s->steps += p.steps;
    return proven;
}

/* v and the objects nearest to it by overlaps, ascending. */
static uint32_t ball(struct hl_stipple *s, uint32_t v, uint32_t *out)
{
    uint32_t n = 1, most = BALL + s->patterns;
    most = most < HL_STIPPLE_EXACT ? most : HL_STIPPLE_EXACT;
    out[0] = v;
    s->place[v] = 0;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t from = s->first[out[i]], to = s->first[out[i] + 1];
        for (uint32_t e = from; e < to && n < most; e++) {
            uint32_t u = s->to[e] & HL_STIPPLE_RANK;
            if (!hl_stipple_joins(s, v, s->to[e]) || s->place[u] != NOBODY)
                continue;
            s->place[u] = n;
            out[n++] = u;
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t moved = out[i], k = i;
        s->place[moved] = NOBODY;
        for (; k > 0 && out[k - 1] > moved; k--)
            out[k] = out[k - 1];
        out[k] = moved;
    }
    return n;
}

/* Neighbourhoods until none gets better, so that where nothing moves nothing
 * is found in the next frame. */
static void repair(struct hl_stipple *s, uint32_t from, uint32_t to)
{
    uint32_t ranks[HL_STIPPLE_EXACT], most = REPAIR_STEPS * (to - from);
    uint32_t stop = s->steps > most ? s->steps - most : 0;
    bool any = true;
    while (any) {
        any = false;
        for (uint32_t i = from; i < to && s->steps > stop; i++) {
            bool better = false;
            if (!could_be_better(s, s->member[i]))
                continue;
            solve(s, ranks, ball(s, s->member[i], ranks), BALL_STEPS, false,
                  &better);
            any |= better;
        }
    }
}

/* s->member[from] .. [to - 1], ascending. True: proven best. */
static bool color_group(struct hl_stipple *s, uint32_t from, uint32_t to)
{
    bool better = false, perfect = true;
    first_assignment(s, from, to);
    for (uint32_t i = from; i < to && perfect; i++)
        perfect = !could_be_better(s, s->member[i]);
    if (perfect)
        return true;
    if (to - from <= HL_STIPPLE_EXACT)
        return solve(s, s->member + from, to - from, UINT32_MAX, true, &better);
    repair(s, from, to);
    return false;
}

/* ---- groups ---------------------------------------------------------- */

/* Numbers the groups of objects whose firm is `firm`; sorts them into
 * s->member, ascending in each. s->place[g]: where group g ends. */
static uint32_t find_groups(struct hl_stipple *s, uint8_t firm)
{
    uint32_t n_groups = 0, n = 0, start = 0;
    for (uint32_t v = 0; v < s->n; v++)
        s->group[v] = NOBODY;
    for (uint32_t root = 0; root < s->n; root++) {
        uint32_t done = n;
        if (s->firm[root] != firm || s->group[root] != NOBODY)
            continue;
        s->group[root] = n_groups;
        for (s->heap[n++] = root; done < n; done++) {
            uint32_t v = s->heap[done];
            for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++) {
                uint32_t u = s->to[e] & HL_STIPPLE_RANK;
                if (s->group[u] != NOBODY || !hl_stipple_joins(s, v, s->to[e]))
                    continue;
                s->group[u] = n_groups;
                s->heap[n++] = u;
            }
        }
        s->ends[n_groups++] = n;
    }
    for (uint32_t g = 0; g < n_groups; g++) {
        s->place[g] = start;
        start = s->ends[g];
    }
    for (uint32_t v = 0; v < s->n; v++)
        if (s->group[v] != NOBODY)
            s->member[s->place[s->group[v]]++] = v;
    return n_groups;
}

static bool all_assigned(const struct hl_stipple *s, uint32_t from,
                         uint32_t to)
{
    for (uint32_t i = from; i < to; i++)
        if (s->pattern[s->member[i]] == HL_STIPPLE_NONE)
            return false;
    return true;
}

/* Not everyone could have a pattern, and nobody need keep a distance: from
 * now on only true overlaps count. False: nothing else counted before. */
static bool make_firm(struct hl_stipple *s, uint32_t from, uint32_t to)
{
    bool any = false;
    for (uint32_t i = from; i < to && !any; i++) {
        uint32_t v = s->member[i];
        for (uint32_t e = s->first[v]; e < s->first[v + 1]; e++)
            any |= !(s->to[e] & HL_STIPPLE_TRUE_EDGE);
    }
    for (uint32_t i = from; i < to && any; i++) {
        uint32_t v = s->member[i];
        s->firm[v] = 1;
        s->taken[v] = 0;
        count_used(s, v, false);
    }
    return any;
}

static bool color_groups(struct hl_stipple *s, uint8_t firm,
                         struct hl_stipple_stats *stats)
{
    uint32_t n_groups = find_groups(s, firm), from = 0;
    bool again = false;
    for (uint32_t g = 0; g < n_groups; from = s->ends[g++]) {
        uint32_t to = s->ends[g];
        bool proven = color_group(s, from, to);
        if (!firm && !all_assigned(s, from, to) && make_firm(s, from, to)) {
            again = true;
            continue;
        }
        if (to - from < 2)
            continue;
        stats->groups++;
        stats->exact_groups += proven;
        if (to - from > stats->largest_group)
            stats->largest_group = to - from;
    }
    return again;
}

void hl_stipple_color(struct hl_stipple *s, struct hl_stipple_stats *stats)
{
    uint32_t steps = s->steps;
    memset(s->firm, 0, s->n);
    memset(s->taken, 0, s->n * sizeof *s->taken);
    memset(s->used, 0, sizeof s->used);
    if (color_groups(s, 0, stats))
        color_groups(s, 1, stats);
    stats->steps = steps - s->steps;
}
