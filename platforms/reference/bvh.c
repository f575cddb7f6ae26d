/* SPDX-License-Identifier: Zlib */
/* A binary tree of boxes by the surface area heuristic over 16 bins (Wald
 * 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies"). */
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/internal.h"

/* Past DEPTH levels things are halved by count, which ends within 32 more:
 * no tree outgrows HLR_BVH_STACK. */
enum { BINS = 16, LEAF = 4, DEPTH = 64 };

struct build {
    const struct hlr_box *boxes;
    struct hlr_bvh *bvh;
};
struct bin { struct hlr_box box; uint32_t n; };
struct cut { double cost; int axis; uint32_t bin; };

static const struct hlr_box nothing = {
    { HUGE_VAL, HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL }
};

static void grow(struct hlr_box *box, const struct hlr_box *by)
{
    for (int k = 0; k < 3; k++) {
        if (by->lo[k] < box->lo[k])
            box->lo[k] = by->lo[k];
        if (by->hi[k] > box->hi[k])
            box->hi[k] = by->hi[k];
    }
}

static double half_area(const struct hlr_box *b)
{
    double x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1];
    double z = b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}

static double centre(const struct hlr_box *b, int axis)
{
    return 0.5 * (b->lo[axis] + b->hi[axis]);
}

static uint32_t bin_of(const struct hlr_box *b, int axis, double lo,
                       double scale)
{
    double i = (centre(b, axis) - lo) * scale;
    /* NaN, from a range so small that the scale is infinite, counts as 0. */
    return !(i > 0) ? 0 : i > BINS - 1 ? BINS - 1 : (uint32_t)i;
}

static void centre_range(const struct build *s, uint32_t first,
                         uint32_t count, int axis, double *lo, double *hi)
{
    *lo = HUGE_VAL;
    *hi = -HUGE_VAL;
    for (uint32_t i = first; i < first + count; i++) {
        double c = centre(&s->boxes[s->bvh->order[i]], axis);
        if (c < *lo)
            *lo = c;
        if (c > *hi)
            *hi = c;
    }
}

static void try_axis(struct cut *best, const struct build *s, uint32_t first,
                     uint32_t count, int axis)
{
    struct bin bins[BINS];
    double lo, hi, right[BINS];
    centre_range(s, first, count, axis, &lo, &hi);
    if (!(hi > lo))
        return;
    for (int i = 0; i < BINS; i++)
        bins[i] = (struct bin){ nothing, 0 };
    for (uint32_t i = first; i < first + count; i++) {
        const struct hlr_box *b = &s->boxes[s->bvh->order[i]];
        struct bin *bin = &bins[bin_of(b, axis, lo, BINS / (hi - lo))];
        grow(&bin->box, b);
        bin->n++;
    }
    struct bin sum = { nothing, 0 };
    for (int i = BINS - 1; i > 0; i--) {
        grow(&sum.box, &bins[i].box);
        sum.n += bins[i].n;
        right[i] = sum.n ? half_area(&sum.box) * sum.n : 0;
    }
    sum = (struct bin){ nothing, 0 };
    for (uint32_t i = 0; i + 1 < BINS; i++) {
        grow(&sum.box, &bins[i].box);
        sum.n += bins[i].n;
        if (sum.n == 0 || sum.n == count)
            continue;
        double cost = half_area(&sum.box) * sum.n + right[i + 1];
        if (cost < best->cost)
            *best = (struct cut){ cost, axis, i + 1 };
    }
}

/* Put the things below the cut first; return how many there are. */
static uint32_t part(const struct build *s, uint32_t first, uint32_t count,
                     const struct cut *cut)
{
    uint32_t *order = s->bvh->order + first, n = 0;
    double lo, hi;
    centre_range(s, first, count, cut->axis, &lo, &hi);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t t = order[i];
        if (bin_of(&s->boxes[t], cut->axis, lo, BINS / (hi - lo)) < cut->bin) {
            order[i] = order[n];
            order[n++] = t;
        }
    }
    return n;
}

static void split(const struct build *s, uint32_t at, uint32_t first,
                  uint32_t count, uint32_t depth)
{
    struct hlr_node *node = &s->bvh->nodes[at];
    struct cut cut = { HUGE_VAL, 0, 0 };
    node->box = nothing;
    for (uint32_t i = first; i < first + count; i++)
        grow(&node->box, &s->boxes[s->bvh->order[i]]);
    node->first = first;
    node->count = count;
    if (count == 1)
        return;
    for (int axis = 0; axis < 3 && depth < DEPTH; axis++)
        try_axis(&cut, s, first, count, axis);
    /* Visiting a node costs about as much as one thing in it. */
    double area = half_area(&node->box);
    if (count <= LEAF && !(cut.cost + area < area * count))
        return;
    uint32_t n = cut.bin ? part(s, first, count, &cut) : count / 2;
    uint32_t left = s->bvh->n_nodes;
    s->bvh->n_nodes += 2;
    node->first = left;
    node->count = 0;
    split(s, left, first, n, depth + 1);
    split(s, left + 1, first + n, count - n, depth + 1);
}

bool hlr_bvh_build(struct hlr_bvh *out, const struct hlr_box *boxes,
                   uint32_t n)
{
    memset(out, 0, sizeof *out);
    if (n == 0)
        return true;
    if (n > UINT32_MAX / 2)
        return false;
    out->nodes = calloc(2 * (size_t)n, sizeof *out->nodes);
    out->order = calloc(n, sizeof *out->order);
    if (!out->nodes || !out->order) {
        hlr_bvh_free(out);
        return false;
    }
    for (uint32_t i = 0; i < n; i++)
        out->order[i] = i;
    out->n_nodes = 1;
    split(&(struct build){ boxes, out }, 0, 0, n, 0);
    return true;
}

void hlr_bvh_free(struct hlr_bvh *bvh)
{
    free(bvh->nodes);
    free(bvh->order);
    memset(bvh, 0, sizeof *bvh);
}
