/* SPDX-License-Identifier: Zlib */
#ifndef HL_STIPPLE_H
#define HL_STIPPLE_H
/* Which translucent object writes which texels of the G-buffer (Kircher and
 * Lawrance 2009, section 4). Of each block of 2 x 2 texels an object owns
 * one, of 4 x 4 blocks likewise one; pattern 0 is left to opaque surfaces.
 * Where objects overlap on the screen and share a pattern the nearer one
 * overwrites the light of the other; the paper leaves finding patterns open
 * (section 7.1). Here: colouring the graph of overlaps, so that nothing is
 * lost, as few texels as possible go without a pattern, and then as few as
 * possible change theirs from the last frame.
 *
 * Deterministic: the result depends on the objects and on what was assigned
 * before, not on the machine, the order of the array or the time taken.
 * Memory is the caller's; nothing here allocates. */
#include "core/light.h"
#include "core/stipple_mode.h"

enum {
    HL_STIPPLE_2X2 = 3,      /* patterns of a 2 x 2 block, 1..3              */
    HL_STIPPLE_4X4 = 15,     /* of a 4 x 4 block, 1..15                      */
    HL_STIPPLE_NONE = 255,   /* no pattern: to be lit and drawn forward      */
    /* Objects in a group up to which the whole group is searched for the best
     * assignment; larger ones are improved around one object at a time. */
    HL_STIPPLE_EXACT = 24,
    /* Of the search, a frame, each about 0.2 us on a desktop. Enough to prove
     * the hardest groups of 18 objects with 3 patterns that hill climbing came
     * upon (20,900 steps), not those of 24 (209,000), nor dense ones of 24
     * with 15 patterns and a last frame made up at random (millions). Moving
     * scenes of 50 objects took 4 to 640 a frame. */
    HL_STIPPLE_STEPS = 0x8000,
    HL_STIPPLE_CORNERS = 16, /* of an outline, at most                       */
    HL_STIPPLE_MAX_OBJECTS = 65536,
    HL_STIPPLE_MAX_PAIRS = 0x4000000,
    HL_STIPPLE_MAX_WEIGHT = 0x1000000
};

/* ---- bounds ---------------------------------------------------------- */

/* What an object can cover, in L-buffer texels, y down: a convex polygon,
 * its corners in order, either way round. */
struct hl_stipple_outline {
    uint32_t n_corners;      /* 3..HL_STIPPLE_CORNERS                        */
    float x[HL_STIPPLE_CORNERS], y[HL_STIPPLE_CORNERS];
};

/* Outline of a model-space box on the L-buffer, cut at the near plane and at
 * the edges of what is drawn; every texel centre that anything inside the box
 * covers without jitter lies inside or within 1/16 texel. Jitter moves all
 * outlines alike and is left out. False: nothing of the box is seen (or a
 * NaN), and *out is untouched. */
bool hl_stipple_project(struct hl_stipple_outline *out, const float world[16],
                        const float min[3], const float max[3],
                        const struct hl_camera *camera,
                        const struct hl_span *span);

struct hl_stipple_object {
    uint32_t id;             /* its name from frame to frame; no two alike   */
    /* Texels it may touch, conservatively: x0 <= x < x1, y down. x0 >= x1 or
     * y0 >= y1: none, it overlaps nothing. Infinities are allowed. */
    float x0, y0, x1, y1;
    /* A tighter bound inside the rectangle, borrowed for the call; NULL: the
     * rectangle alone. */
    const struct hl_stipple_outline *outline;
    float depth;             /* for the two depth modes: metres or any other
                              * number that grows with distance              */
    uint32_t weight;         /* texels it covers; 0 counts as 1, more than
                              * HL_STIPPLE_MAX_WEIGHT as that                */
    uint32_t wanted;         /* HL_STIPPLE_USER: pattern, 0 for none         */
};

/* The outline's rectangle, 1/16 texel larger: fills x0..y1 and outline. */
void hl_stipple_bound(struct hl_stipple_object *,
                      const struct hl_stipple_outline *);
/* Texels inside the outline. */
double hl_stipple_area(const struct hl_stipple_outline *);

/* ---- assigning ------------------------------------------------------- */

struct hl_stipple_frame {
    const struct hl_stipple_object *objects;
    uint32_t n_objects;
    enum hl_stipple_mode mode;
    uint32_t patterns;       /* P: HL_STIPPLE_2X2 or _4X4; any of 1..15 works */
    /* Texels within which objects count as overlapping already (BEST; other
     * modes count them in near_pairs alone): patterns change before objects
     * overlap, and bounds may be that much too small, as a frame's are for
     * the next. It makes for more changes, not fewer. Where not all objects
     * of a group can have a pattern that way, only true overlaps count. */
    float margin;
    /* BEST: per cent, 0..100, by which an object without a pattern must be
     * heavier than those with one that would lose it for its sake. 0 is the
     * least weight without a pattern in every frame, and most changes; 50 in
     * crowded scenes a fifth to a half of the changes fewer for 3 to 6 % more
     * weight without. */
    uint32_t hold;
    uint32_t max_steps;      /* BEST: of the search; 0: HL_STIPPLE_STEPS     */
};

struct hl_stipple_stats {
    uint32_t pairs;          /* that overlap                                 */
    uint32_t near_pairs;     /* that overlap or come within the margin       */
    uint32_t conflicts;      /* of `pairs`: share a pattern. BEST has none   */
    uint32_t unassigned;     /* objects with HL_STIPPLE_NONE                 */
    uint64_t unassigned_weight;
    uint32_t changes;        /* objects of the last frame with another pattern
                              * now (NONE is one of them)                    */
    uint64_t changes_weight;
    /* BEST: sets of two or more objects joined by near pairs, by true ones
     * where the margin did not count; solved one by one. Of these, those whose
     * assignment is proven to be best: no other has less weight (with `hold`)
     * without a pattern, or as much and less weight changed. */
    uint32_t groups, largest_group, exact_groups;
    uint32_t steps;          /* of the search: its cost, on every machine    */
};

struct hl_stipple;

/* Bytes for frames of up to max_objects objects and max_pairs near pairs; 0
 * pairs: 32 an object, or all that there can be where that is less. 0: above
 * HL_STIPPLE_MAX_*, or max_objects 0. */
size_t hl_stipple_bytes(uint32_t max_objects, uint32_t max_pairs);

/* `memory`: hl_stipple_bytes of the same numbers, aligned for any type, the
 * caller's, in use for as long as the result. NULL: no memory, or bytes would
 * be 0. There is nothing to destroy. */
struct hl_stipple *hl_stipple_create(void *memory, uint32_t max_objects,
                                     uint32_t max_pairs);

/* As if there had been no last frame: a cut, a teleport. */
void hl_stipple_forget(struct hl_stipple *);

/* Patterns of a frame: pattern[i], 1..P or HL_STIPPLE_NONE, is objects[i]'s.
 * Becomes the last frame. An object that is away for a frame is forgotten.
 * Where nothing moved nothing changes; a group of more than HL_STIPPLE_EXACT
 * in which not all have a pattern may take a few frames to come to that.
 *
 * Time: O(n + m log n) for n objects and m pairs that overlap in x (n^2 / 2
 * where all do), and the search, for groups that the last frame's patterns
 * do not fit any more or in which not all have one.
 *
 * HL_ERR_INVALID: a pointer is missing, P, mode or margin (NaN, < 0) out of
 * range, and for any object: a NaN bound, depth (depth modes) or corner, a
 * wrong number of corners, wanted > P (USER), or an id that is there twice.
 * HL_ERR_LIMIT: more objects than max_objects; or more near pairs than
 * max_pairs, then stats->near_pairs is how many there are. On errors the
 * last frame stays the last frame and pattern is untouched. stats may be
 * NULL. */
enum hl_result hl_stipple_assign(struct hl_stipple *,
                                 const struct hl_stipple_frame *,
                                 uint8_t *pattern,
                                 struct hl_stipple_stats *stats);
#endif
