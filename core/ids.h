/* SPDX-License-Identifier: Zlib */
#ifndef HL_IDS_H
#define HL_IDS_H
/* Region ids: what the discontinuity-sensitive filter compares to tell one
 * continuous surface from another (Kircher and Lawrance 2009, section 3.1).
 * A region is one normal group of one object. Three ways to number regions:
 *
 *   unique    a base an object + the group: no two regions share an id;
 *   coloured  regions that may touch differ, others may share: groups by
 *             their neighbours in the mesh, objects by a list of pairs that
 *             may meet; for scenes or storage in which unique does not fit;
 *   paper     the paper's 8 bits an object and 8 bits a group, random or in
 *             sequence, which do collide; kept to be compared with.
 *
 * 0 is the background in all three and is never a region's id. Ids are whole
 * numbers; how a format stores them is packing's business. Everything is
 * deterministic. A list of pairs is 2 numbers a pair, in any order; doubles
 * and pairs of a node with itself are allowed and count as nothing. */
#include "hal/hal.h"

/* Highest id that `bits` bits of storage carry: 2^bits - 2, as the largest
 * code is left out for formats whose divisor is 2^bits - 2 (ids written as
 * id / 65534 read back exactly in float, id / 65535 do not). 0 when bits is
 * not in 8..16. */
uint32_t hl_ids_limit(uint32_t bits);

/* ---- unique ---------------------------------------------------------- */

/* base[i] so that base[i] + group, group < n_groups[i], is unique, in 1..limit;
 * bases ascend from 1. *n_needed (may be NULL) is the ids needed, also on
 * HL_ERR_LIMIT (they are more than limit; base is then untouched).
 * HL_ERR_INVALID: a NULL array with n_objects > 0. */
enum hl_result hl_ids_unique(uint32_t n_objects, const uint32_t *n_groups,
                             uint32_t limit, uint32_t *base,
                             uint64_t *n_needed);

/* ---- colouring ------------------------------------------------------- */

struct hl_ids_coloring {
    uint32_t n_colors;       /* used: colours are 0..n_colors-1              */
    uint32_t n_conflicts;    /* distinct pairs that share a colour           */
};

/* Colour nodes so that the ends of every pair differ, greedily in
 * smallest-last order (Matula and Beck 1983): at most 1 + the graph's
 * degeneracy colours, so 6 on a planar graph. Linear in nodes + pairs. Where
 * more than max_colors (0: no limit) would be needed the colour that the
 * fewest coloured neighbours have is taken and *out counts the conflicts:
 * that is HL_OK, and the caller's to look at.
 * HL_ERR_INVALID: a hook or array is missing, or a pair names no node;
 * HL_ERR_LIMIT: n_nodes or n_pairs above 2^30; HL_ERR_MEMORY. color, n_nodes
 * of them, and *out are written on HL_OK only. Scratch memory is released. */
enum hl_result hl_ids_color(const struct hl_hooks *hooks, uint32_t n_nodes,
                            const uint32_t *pairs, uint32_t n_pairs,
                            uint32_t max_colors, uint32_t *color,
                            struct hl_ids_coloring *out);

/* Pairs whose ends have the same id: pairs of a node with itself count not,
 * doubles count each time. Every pair must name ids that are there. */
uint32_t hl_ids_count_shared(const uint32_t *pairs, uint32_t n_pairs,
                             const uint32_t *ids);

/* ---- a scene --------------------------------------------------------- */

struct hl_ids_object {
    uint32_t n_groups;       /* of its mesh                                  */
    uint32_t n_colors;       /* that its mesh's groups were coloured with;
                                0: not coloured, n_groups                    */
};

struct hl_ids_scene {
    const struct hl_ids_object *objects;
    uint32_t n_objects;
    uint32_t limit;          /* highest id, hl_ids_limit; >= 1               */
    /* Pairs of objects that may meet on the screen at about one depth (see
     * hl_ids_overlaps). NULL: not known, and objects share no id or the call
     * fails; a list of none is any pointer with n_meetings 0. */
    const uint32_t *meetings;
    uint32_t n_meetings;
};

enum hl_ids_scheme {         /* in the order they are tried                  */
    HL_IDS_UNIQUE,           /* id = base + group                            */
    HL_IDS_GROUPS_COLORED,   /* id = base + colour of the group              */
    HL_IDS_COLORED           /* the same; objects that do not meet may share
                                a base, 1 + object colour * stride           */
};

struct hl_ids_plan {
    enum hl_ids_scheme scheme;
    uint32_t stride;         /* ids an object takes at most                  */
    uint32_t n_ids;          /* highest id that can occur                    */
    uint32_t n_object_colors;    /* COLORED only, else 0                     */
    uint32_t n_conflicts;    /* distinct meeting pairs that share a base     */
    uint32_t n_folded;       /* objects with more colours than limit: groups
                                of theirs share ids whether they touch or not*/
};

/* Number a scene by the first scheme that fits. base, n_objects of them, and
 * *out are written on HL_OK only. Ids never collide between regions that may
 * touch when n_conflicts and n_folded are both 0.
 * HL_ERR_LIMIT: objects do not fit one by one and meetings is NULL;
 * HL_ERR_INVALID: a hook or array missing, limit 0, n_colors > n_groups, a
 * meeting that names no object (looked at when COLORED is tried);
 * HL_ERR_MEMORY. */
enum hl_result hl_ids_assign(const struct hl_hooks *hooks,
                             const struct hl_ids_scene *scene, uint32_t *base,
                             struct hl_ids_plan *out);

/* The region's id. group and color (of the group in its mesh) are both given,
 * as only the plan knows which one counts. */
uint32_t hl_ids_region(const struct hl_ids_plan *plan, uint32_t base,
                       uint32_t group, uint32_t color);

/* ---- objects that may meet ------------------------------------------- */

/* World boxes (metres) or screen rectangles (pixels, z 0..0). min > max on
 * any axis is an empty box, which meets nothing; infinities are allowed. */
struct hl_ids_box { float min[3], max[3]; };

/* Pairs of boxes that come within `margin` of each other on every axis, the
 * smaller number first, each once. In the world a margin of the filter's
 * depth threshold holds from every view; on the screen it is the reach of the
 * filter's taps. Writes up to max_pairs pairs; *n_pairs is how many there
 * are, also on HL_ERR_LIMIT (more than max_pairs).
 * Sorts by radix on the longest axis and sweeps: linear + the pairs that
 * overlap on that axis. HL_ERR_INVALID: a hook or array missing, a NaN, a
 * negative margin; HL_ERR_MEMORY. pairs may be NULL when max_pairs is 0. */
enum hl_result hl_ids_overlaps(const struct hl_hooks *hooks,
                               const struct hl_ids_box *boxes,
                               uint32_t n_boxes, float margin,
                               uint32_t max_pairs, uint32_t *pairs,
                               uint64_t *n_pairs);

/* ---- the paper's ids ------------------------------------------------- */

/* Number `index` of a stream of independent, evenly spread bytes: the object
 * ids of instances 0, 1, 2, ..., or the ids of a mesh's groups. Equal seeds
 * give equal streams on every machine. In sequence is index & 255. */
uint8_t hl_ids_random8(uint64_t seed, uint32_t index);
/* Object in the upper 8 bits, group in the lower. 0 (the background's) gives
 * 1 and 65,535 (not stored exactly) gives 65,534: two of 65,536 share more. */
uint32_t hl_ids_paper_region(uint8_t object, uint8_t group);
#endif
