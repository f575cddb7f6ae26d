/* SPDX-License-Identifier: Zlib */
/* Primitives become records: culled, bounded, listed by the bins that they
 * may touch. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

/* Standard positions of Vulkan and Direct3D. */
const int8_t pe_sample_at[4][PE_MAX_SAMPLES][2] = {
    { { 0, 0 } },
    { { 4, 4 }, { -4, -4 } },
    { { -2, -6 }, { 6, -2 }, { -6, 2 }, { 2, 6 } },
    { { 1, -3 }, { -1, 3 }, { 5, 1 }, { -3, -5 },
      { -5, 5 }, { -7, -1 }, { 3, 7 }, { 7, -7 } }
};

struct bounds { int32_t x0, y0, x1, y1; };   /* ends included                */

static int32_t min2(int32_t a, int32_t b) { return a < b ? a : b; }
static int32_t max2(int32_t a, int32_t b) { return a > b ? a : b; }

static struct bounds scissor_of(const struct pe_pass *pass, uint32_t draw)
{
    const struct hl_rect *s = &pass->draws[draw].in->scissor;
    struct bounds b = { s->x, s->y, s->x + s->width - 1,
                        s->y + s->height - 1 };
    return b;
}

static bool clip_bounds(struct bounds *b, const struct bounds *by)
{
    b->x0 = max2(b->x0, by->x0);
    b->y0 = max2(b->y0, by->y0);
    b->x1 = min2(b->x1, by->x1);
    b->y1 = min2(b->y1, by->y1);
    return b->x0 <= b->x1 && b->y0 <= b->y1;
}

/* ---- lists by bin -------------------------------------------------------- */

static bool add_pair(struct pe_chunk *c, uint32_t bin)
{
    if (c->n_pairs == c->max_pairs) {
        c->need_pairs = (uint64_t)c->max_pairs + 1;
        return false;
    }
    c->pairs[c->n_pairs].bin = bin;
    c->pairs[c->n_pairs++].record = c->n_records;
    return true;
}

/* Is all of a bin (bx, by) outside one edge of the triangle? */
static bool misses(const union pe_word *const v[3], int32_t bx, int32_t by)
{
    const int32_t side = PE_BIN * PE_SUB;
    for (int i = 0; i < 3; i++) {
        const union pe_word *p = v[i], *q = v[i < 2 ? i + 1 : 0];
        int32_t a = p[PE_V_Y].i - q[PE_V_Y].i;
        int32_t b = q[PE_V_X].i - p[PE_V_X].i;
        int32_t x = (a > 0 ? bx + 1 : bx) * side;
        int32_t y = (b > 0 ? by + 1 : by) * side;
        if ((int64_t)a * (x - p[PE_V_X].i) +
            (int64_t)b * (y - p[PE_V_Y].i) < 0)
            return true;
    }
    return false;
}

/* Add the record that lies behind the last one; v NULL: all its bins. */
static bool add_record(const struct pe_pass *pass, struct pe_chunk *c,
                       const struct bounds *b, const union pe_word *const *v)
{
    int32_t x0 = b->x0 / PE_BIN, x1 = b->x1 / PE_BIN;
    int32_t y0 = b->y0 / PE_BIN, y1 = b->y1 / PE_BIN;
    bool one = x0 == x1 && y0 == y1;
    for (int32_t y = y0; y <= y1; y++)
        for (int32_t x = x0; x <= x1; x++) {
            if (!one && v && misses(v, x, y))
                continue;
            if (!add_pair(c, (uint32_t)y * pass->nx + (uint32_t)x))
                return false;
        }
    struct pe_record *r = &c->records[c->n_records++];
    r->x0 = (int16_t)b->x0;
    r->y0 = (int16_t)b->y0;
    r->x1 = (int16_t)b->x1;
    r->y1 = (int16_t)b->y1;
    return true;
}

static struct pe_record *next_record(struct pe_chunk *c, uint32_t draw)
{
    if (c->n_records == c->max_records) {
        c->need_records = (uint64_t)c->max_records + 1;
        return NULL;
    }
    c->records[c->n_records].draw = draw;
    return &c->records[c->n_records];
}

/* ---- primitives ---------------------------------------------------------- */

static int64_t area2(const union pe_word *const v[3])
{
    int32_t x = v[0][PE_V_X].i, y = v[0][PE_V_Y].i;
    return (int64_t)(v[1][PE_V_X].i - x) * (v[2][PE_V_Y].i - y) -
           (int64_t)(v[1][PE_V_Y].i - y) * (v[2][PE_V_X].i - x);
}

/* Pixels that a range of positions may touch: those whose centres lie in it;
 * with samples off the centre, all that it overlaps. */
static void span(int32_t low, int32_t high, bool centres, int32_t *first,
                 int32_t *last)
{
    const int32_t half = PE_SUB / 2, bias = -PE_GUARD_LOW;
    /* Biased to be positive: shifts of negative numbers are not portable. */
    low += bias * PE_SUB;
    high += bias * PE_SUB;
    *first = ((centres ? low + half - 1 : low) >> PE_SUB_BITS) - bias;
    *last = ((centres ? high - half : high) >> PE_SUB_BITS) - bias;
}

static struct bounds bounds_of(const union pe_word *const v[3], bool centres)
{
    struct bounds b;
    int32_t x0 = v[0][PE_V_X].i, x1 = v[1][PE_V_X].i, x2 = v[2][PE_V_X].i;
    int32_t y0 = v[0][PE_V_Y].i, y1 = v[1][PE_V_Y].i, y2 = v[2][PE_V_Y].i;
    span(min2(min2(x0, x1), x2), max2(max2(x0, x1), x2), centres, &b.x0,
         &b.x1);
    span(min2(min2(y0, y1), y2), max2(max2(y0, y1), y2), centres, &b.y0,
         &b.y1);
    return b;
}

bool pe_setup_triangle(const struct pe_pass *pass, struct pe_chunk *c,
                       uint32_t draw, uint32_t i0, uint32_t i1, uint32_t i2)
{
    const struct hl_prog_desc *p = &pass->draws[draw].program->desc;
    const union pe_word *v[3] = { c->words + i0, c->words + i1,
                                  c->words + i2 };
    int64_t area = area2(v);
    /* Counter-clockwise with y up is clockwise, negative, with y down. */
    bool back = (area > 0) != p->mirrored;
    if (area == 0 || (p->cull == HL_CULL_BACK && back) ||
        (p->cull == HL_CULL_FRONT && !back))
        return true;
    struct bounds b = bounds_of(v, pass->in->samples == 1);
    struct bounds s = scissor_of(pass, draw);
    if (!clip_bounds(&b, &s))
        return true;
    struct pe_record *r = next_record(c, draw);
    if (!r)
        return false;
    if (area < 0) {
        const union pe_word *t = v[1];
        uint32_t i = i1;
        v[1] = v[2];
        v[2] = t;
        i1 = i2;
        i2 = i;
    }
    r->v[0] = i0;
    r->v[1] = i1;
    r->v[2] = i2;
    r->draw |= back ? PE_BACK : 0;
    return add_record(pass, c, &b, v);
}

bool pe_setup_line(const struct pe_pass *pass, struct pe_chunk *c,
                   uint32_t draw, uint32_t i0, uint32_t i1)
{
    const union pe_word *v[3] = { c->words + i0, c->words + i1,
                                  c->words + i1 };
    struct bounds b = bounds_of(v, false);
    struct bounds s = scissor_of(pass, draw);
    if (!clip_bounds(&b, &s))
        return true;
    struct pe_record *r = next_record(c, draw);
    if (!r)
        return false;
    r->v[0] = i0;
    r->v[1] = r->v[2] = i1;
    return add_record(pass, c, &b, NULL);
}

bool pe_setup_screen(const struct pe_pass *pass, struct pe_chunk *c,
                     uint32_t draw)
{
    struct bounds b = scissor_of(pass, draw);
    struct pe_record *r = next_record(c, draw);
    if (!r)
        return false;
    memset(r->v, 0, sizeof r->v);
    return add_record(pass, c, &b, NULL);
}

/* A counting sort, which keeps the order of records within a bin. */
void pe_chunk_sort(struct pe_chunk *c, uint32_t n_bins)
{
    uint32_t *at = c->start;
    memset(at, 0, (n_bins + 2) * sizeof *at);
    for (uint32_t i = 0; i < c->n_pairs; i++)
        at[c->pairs[i].bin + 2]++;
    for (uint32_t i = 2; i < n_bins + 2; i++)
        at[i] += at[i - 1];
    /* at[b + 1] is where bin b begins, and moves on to where it ends. */
    for (uint32_t i = 0; i < c->n_pairs; i++)
        c->sorted[at[c->pairs[i].bin + 1]++] = c->pairs[i].record;
}
