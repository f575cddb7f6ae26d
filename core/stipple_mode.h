/* SPDX-License-Identifier: Zlib */
#ifndef HL_STIPPLE_MODE_H
#define HL_STIPPLE_MODE_H
/* How translucent objects get their patterns (core/stipple.h). */

enum hl_stipple_mode {
    /* No conflicts; the least weight without a pattern; then the least weight
     * that changes its pattern. */
    HL_STIPPLE_BEST = 0,
    /* The paper's first: what the user wants; wanted 0 gets NONE. */
    HL_STIPPLE_USER,
    /* The paper's second: patterns dealt in turn, 1, 2, .. P, 1, .., from the
     * nearest object to the farthest (equal depths by id). */
    HL_STIPPLE_BY_DEPTH,
    /* The same order; each takes the lowest pattern that none of the nearer
     * objects which it overlaps has, NONE when there is none. */
    HL_STIPPLE_BY_DEPTH_FREE
};
#endif
