/* SPDX-License-Identifier: Zlib */
/* Boxes that come near each other: radix sort on one axis, then a sweep. */
#include <string.h>
#include "core/ids.h"
#include "core/mem.h"

struct entry {
    uint32_t key;            /* the box's minimum, order-preserving bits     */
    uint32_t box;
};

/* Floats in order as unsigned numbers: negative ones fall as their bits rise,
 * so all bits turn over; of the others just the sign. -0 comes before +0,
 * which the sweep does not mind. */
static uint32_t ordered_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static bool box_valid(const struct hl_ids_box *box)
{
    for (int i = 0; i < 3; i++)
        if (box->min[i] != box->min[i] || box->max[i] != box->max[i])
            return false;
    return true;
}

static bool box_empty(const struct hl_ids_box *box)
{
    return box->min[0] > box->max[0] || box->min[1] > box->max[1] ||
           box->min[2] > box->max[2];
}

/* In double, where the sum of two floats of like size is exact. */
static bool near_on(const struct hl_ids_box *a, const struct hl_ids_box *b,
                    int axis, float margin)
{
    double m = (double)margin;
    return (double)a->min[axis] <= (double)b->max[axis] + m &&
           (double)b->min[axis] <= (double)a->max[axis] + m;
}

static bool near_on_all(const struct hl_ids_box *a, const struct hl_ids_box *b,
                        float margin)
{
    return near_on(a, b, 0, margin) && near_on(a, b, 1, margin) &&
           near_on(a, b, 2, margin);
}

static int longest_axis(const struct hl_ids_box *boxes, uint32_t n)
{
    double longest = -1;
    int best = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = (double)boxes[0].min[axis], high = low;
        for (uint32_t i = 0; i < n; i++) {
            double min = (double)boxes[i].min[axis];
            low = min < low ? min : low;
            high = min > high ? min : high;
        }
        if (high - low > longest) {
            longest = high - low;
            best = axis;
        }
    }
    return best;
}

/* Four stable counting passes, a byte each; ends in `a`. */
static void radix_sort(struct entry *a, struct entry *b, uint32_t n)
{
    for (int shift = 0; shift < 32; shift += 8) {
        uint32_t count[257] = {0};
        struct entry *swap = a;
        for (uint32_t i = 0; i < n; i++)
            count[(a[i].key >> shift & 255) + 1]++;
        for (int i = 0; i < 256; i++)
            count[i + 1] += count[i];
        for (uint32_t i = 0; i < n; i++)
            b[count[a[i].key >> shift & 255]++] = a[i];
        a = b;
        b = swap;
    }
}

static uint64_t sweep(const struct hl_ids_box *boxes,
                      const struct entry *sorted, uint32_t n, int axis,
                      float margin, uint32_t max_pairs, uint32_t *pairs)
{
    uint64_t found = 0;
    for (uint32_t i = 0; i < n; i++) {
        const struct hl_ids_box *a = &boxes[sorted[i].box];
        for (uint32_t j = i + 1; j < n; j++) {
            uint32_t p = sorted[i].box, q = sorted[j].box;
            if (!near_on(a, &boxes[q], axis, margin))
                break;
            if (!near_on_all(a, &boxes[q], margin))
                continue;
            if (found < max_pairs) {
                pairs[2 * found] = p < q ? p : q;
                pairs[2 * found + 1] = p < q ? q : p;
            }
            found++;
        }
    }
    return found;
}

static bool overlaps_valid(const struct hl_hooks *hooks,
                           const struct hl_ids_box *boxes, uint32_t n_boxes,
                           float margin)
{
    if (!hl_mem_hooks_valid(hooks) || (n_boxes > 0 && !boxes))
        return false;
    if (!(margin >= 0))
        return false;
    for (uint32_t i = 0; i < n_boxes; i++)
        if (!box_valid(&boxes[i]))
            return false;
    return true;
}

enum hl_result hl_ids_overlaps(const struct hl_hooks *hooks,
                               const struct hl_ids_box *boxes,
                               uint32_t n_boxes, float margin,
                               uint32_t max_pairs, uint32_t *pairs,
                               uint64_t *n_pairs)
{
    enum hl_result result = HL_OK;
    uint32_t n = 0;
    if (!n_pairs || (max_pairs > 0 && !pairs) ||
        !overlaps_valid(hooks, boxes, n_boxes, margin))
        return HL_ERR_INVALID;
    *n_pairs = 0;
    if (n_boxes == 0)
        return HL_OK;
    struct entry *a = hl_mem_new(hooks, n_boxes, 2 * sizeof *a, &result);
    if (result != HL_OK)
        return result;
    int axis = longest_axis(boxes, n_boxes);
    for (uint32_t i = 0; i < n_boxes; i++)
        if (!box_empty(&boxes[i])) {
            a[n].key = ordered_bits(boxes[i].min[axis]);
            a[n++].box = i;
        }
    radix_sort(a, a + n_boxes, n);
    *n_pairs = sweep(boxes, a, n, axis, margin, max_pairs, pairs);
    hl_mem_free(hooks, a);
    return *n_pairs > max_pairs ? HL_ERR_LIMIT : HL_OK;
}
