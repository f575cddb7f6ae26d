/* SPDX-License-Identifier: Zlib */
#ifndef HL_STIPPLE_WORK_H
#define HL_STIPPLE_WORK_H
/* Private to stipple*.c. */
#include "core/stipple.h"

enum { HL_STIPPLE_MAX_PATTERNS = 15 };

/* ---- the exact search ------------------------------------------------ */

/* A small group as bits: vertex v is bit v. Larger losses come first, and of
 * those that had a pattern larger weights. */
struct hl_stipple_problem {
    uint32_t n, patterns;
    uint32_t near[HL_STIPPLE_EXACT];     /* vertices it overlaps             */
    uint32_t weight[HL_STIPPLE_EXACT];   /* that changes with its pattern    */
    uint32_t loss[HL_STIPPLE_EXACT];     /* and is lost without one          */
    /* By pattern, from 1: who may take it (what lies around the group may
     * own it), who had it. */
    uint32_t open[HL_STIPPLE_MAX_PATTERNS + 1];
    uint32_t kept[HL_STIPPLE_MAX_PATTERNS + 1];
    uint32_t had, had_none;              /* there in the last frame; with NONE*/
    /* In: any valid assignment and its cost. Out: a better one, if there is. */
    uint8_t pattern[HL_STIPPLE_EXACT];
    uint64_t cost;
    uint32_t steps;                      /* in: at most; out: left           */
};

/* Loss << 32 | weight changed: one number to compare, as 24 * 2^25 < 2^32. */
uint64_t hl_stipple_cost_of(const struct hl_stipple_problem *);
/* True: what comes out is proven best. */
bool hl_stipple_search(struct hl_stipple_problem *);
/* The same; slower to prove, better after few steps. */
bool hl_stipple_improve(struct hl_stipple_problem *);

/* ---- a frame --------------------------------------------------------- */

struct hl_stipple_entry { uint32_t key, at; };

/* Objects are numbered by rank: the largest loss first, equal ones by id, so
 * that the order of the caller's array is nowhere seen. */
struct hl_stipple {
    uint32_t max_objects, max_pairs;
    /* The last frame, ascending ids. */
    uint32_t n_last;
    uint32_t *last_id;
    uint8_t *last_pattern;
    /* This one. */
    const struct hl_stipple_object *objects;
    uint32_t n, patterns;
    struct hl_stipple_entry *sort;       /* 2 n                              */
    uint32_t *by_id, *by_rank;           /* n: indices of objects            */
    uint32_t *weight;                    /* n and all below: by rank         */
    uint32_t *loss;                      /* weight, more if it had a pattern */
    uint8_t *prev;                       /* 0: was not there                 */
    uint8_t *pattern;
    uint16_t *taken;                     /* patterns of coloured neighbours  */
    uint32_t *first;                     /* n + 1: where its edges begin     */
    uint32_t *to;                        /* 2 n_pairs edges                  */
    uint32_t *pairs;                     /* 2 n_pairs: an edge each way      */
    uint32_t n_pairs;
    uint8_t *firm;                       /* only true overlaps count for it  */
    uint32_t *group, *member;            /* its group; ranks, group by group */
    uint32_t *ends;                      /* by group: where it ends there    */
    uint32_t *place, *heap;
    uint64_t used[HL_STIPPLE_MAX_PATTERNS + 1]; /* weight, by pattern        */
    uint32_t steps;                      /* left for this frame              */
};

/* An edge: the neighbour's rank, and whether the two overlap truly or come
 * within the margin only. */
#define HL_STIPPLE_TRUE_EDGE 0x80000000u
#define HL_STIPPLE_RANK 0x7FFFFFFFu

static inline bool hl_stipple_joins(const struct hl_stipple *s, uint32_t v,
                                    uint32_t edge)
{
    return !s->firm[v] || (edge & HL_STIPPLE_TRUE_EDGE) != 0;
}

/* Of the last frame and of this one, an object counts as changed. */
static inline bool hl_stipple_changed(uint8_t prev, uint8_t now)
{
    return prev != 0 && prev != now;
}

/* Stable, by key; the result is in `a`, b is as long. */
void hl_stipple_sort(struct hl_stipple_entry *a, struct hl_stipple_entry *b,
                     uint32_t n);
/* Floats in order as unsigned numbers; not for NaN. */
uint32_t hl_stipple_key(float);
/* Edges of the frame's objects; *near is how many pairs there are. False:
 * more than max_pairs. */
bool hl_stipple_edges(struct hl_stipple *, float margin, uint32_t *near);
/* hl_stipple_object's corners are finite and as many as allowed. */
bool hl_stipple_outline_good(const struct hl_stipple_outline *);
/* Both within `margin` of each other along every edge's normal. */
bool hl_stipple_outlines_meet(const struct hl_stipple_outline *,
                              const struct hl_stipple_outline *, float margin);
/* Mode BEST: fills s->pattern, and groups, exact_groups... of stats. */
void hl_stipple_color(struct hl_stipple *, struct hl_stipple_stats *stats);
#endif
