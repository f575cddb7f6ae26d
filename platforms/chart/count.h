/* SPDX-License-Identifier: Zlib */
#ifndef HLT_COUNT_H
#define HLT_COUNT_H
/* Counted cost: what a frame really had (draws, triangles, fragments by pass,
 * blends, taps, light evaluations), weighed with a machine's unit costs. The
 * frame is drawn by packemu, which counts fragments, whatever machine it is
 * counted for; so the figure is the same on every run and has no time in it. */
#include "platforms/cli/shot.h"

struct hlt_counts {
    uint32_t draws;
    uint64_t triangles;
    /* Fragments of passes, of edges' samples too where there are several. */
    uint64_t geometry, light, material, forward, blended;
    uint64_t light_blends, color_blends;  /* fragments that were blended      */
    uint64_t lights;             /* evaluations, batches' fillers too         */
    uint64_t rejecting, lost;    /* pixels of the DSF with some taps rejected,
                                  * with all four                             */
};

/* Draw the shot, which is on packemu, and count. HL_ERR_INVALID where it is
 * on another machine. */
enum hl_result hlt_count(struct hlt_counts *, struct hlc_shot *);

/* Nanoseconds by caps.cost, whichever machine they are of:
 * - draws and triangles as they are;
 * - a G-buffer texel: twice the floor of a pixel, and what its formats write
 *   more (or less) than pairs of 16 bits;
 * - a light fragment: the floor, normal and DSF fetched, its evaluations, and
 *   by the L-buffer's format a blend, or half of one where it only writes;
 * - a material fragment: the floor, the DSF's taps and the light's, gathered or
 *   filtered, four more where a filtered pixel has rejected some, seventeen
 *   where all are and the nearest sample is looked for, of all pixels the share
 *   caps.cost.untaken;
 * - a forward fragment: the floor, its evaluations; a blend by the frame's
 *   format;
 * - with samples: all but one of a pixel's written, colour and depth, and all
 *   fetched to be resolved;
 * - lists bounded by depth: depth read back, one wait. */
double hlt_weigh(const struct hlt_counts *, const struct hl_plan *,
                 const struct hl_caps *);
#endif
