/* SPDX-License-Identifier: Zlib */
/* Each label has some places around its point, near ones first. They are taken
 * greedily, then each label in turn moves to the place that is best with all
 * others where they are, until none moves: a local optimum, found without
 * random numbers. What still collides is left out, worst first. */
#include "platforms/chart/labels.h"
#include <math.h>
#include <string.h>

enum { DIRECTIONS = 16, RINGS = 10, PLACES = DIRECTIONS * RINGS, PASSES = 12 };

static const double ring[RINGS] = { 7, 12, 19, 28, 40, 55, 75, 100, 135, 180 };

#define LABELS_APART 2.0
#define BOXES_APART 1.0
/* Beyond this a line joins label and point. */
#define LEADER_FROM 13.0
/* Pixels of distance that each fault is worth. */
#define COLLISION 1e4
#define LEADER_CROSSES 150.0
#define LINE_COVERED 60.0

bool hlt_boxes_touch(const struct hlt_box *a, const struct hlt_box *b,
                     double apart)
{
    return a->x0 < b->x1 + apart && b->x0 < a->x1 + apart &&
           a->y0 < b->y1 + apart && b->y0 < a->y1 + apart;
}

/* ---- text --------------------------------------------------------------- */

/* Advances of DejaVu Sans in ems, rounded up, by kinds of letters. */
static double advance(unsigned char c)
{
    if (c >= 0x80 || strchr("mMW@%", c))
        return 1.0;
    if (strchr("w+<>=~#^", c))
        return 0.84;
    if (strchr("ijlI'", c))
        return 0.3;
    if (strchr("frt|., :;!()[]/-\\", c))
        return 0.42;
    return (c >= 'A' && c <= 'Z') || c == '&' ? 0.79 : 0.65;
}

double hlt_text_width(const char *utf8, double size)
{
    double ems = 0;
    for (const char *p = utf8; *p; p++)
        if (((unsigned char)*p & 0xC0) != 0x80)     /* first of a letter     */
            ems += advance((unsigned char)*p);
    return ems * size;
}

/* ---- places ------------------------------------------------------------- */

static double clamp(double v, double low, double high)
{
    return v < low ? low : v > high ? high : v;
}

/* Place `k` of a label: the side or corner of the box that looks at the point
 * is a ring's radius away from it. Right of it is the first. */
static void put(struct hlt_label *l, unsigned k)
{
    double angle = 6.283185307179586 * (k % DIRECTIONS) / DIRECTIONS;
    double dx = cos(angle), dy = sin(angle), far = ring[k / DIRECTIONS];
    double cx = l->x + far * dx + clamp(1.5 * dx, -1, 1) * l->width / 2;
    double cy = l->y + far * dy + clamp(1.5 * dy, -1, 1) * l->height / 2;
    l->box = (struct hlt_box){ cx - l->width / 2, cy - l->height / 2,
                               cx + l->width / 2, cy + l->height / 2 };
    l->near_x = clamp(l->x, l->box.x0, l->box.x1);
    l->near_y = clamp(l->y, l->box.y0, l->box.y1);
    l->leader = far > LEADER_FROM;
}

/* Side of p that q lies on. */
static double side(double px, double py, double dx, double dy, double qx,
                   double qy)
{
    return dx * (qy - py) - dy * (qx - px);
}

static bool segments_cross(double ax, double ay, double bx, double by,
                           double cx, double cy, double dx, double dy)
{
    double a = side(cx, cy, dx - cx, dy - cy, ax, ay);
    double b = side(cx, cy, dx - cx, dy - cy, bx, by);
    double c = side(ax, ay, bx - ax, by - ay, cx, cy);
    double d = side(ax, ay, bx - ax, by - ay, dx, dy);
    return a * b < 0 && c * d < 0;
}

static bool leader_cuts(const struct hlt_label *l, const struct hlt_box *b)
{
    if (!l->leader)
        return false;
    double ax = l->x, ay = l->y, bx = l->near_x, by = l->near_y;
    return segments_cross(ax, ay, bx, by, b->x0, b->y0, b->x1, b->y1) ||
           segments_cross(ax, ay, bx, by, b->x0, b->y1, b->x1, b->y0);
}

static bool collides(const struct hlt_label *a, const struct hlt_label *b)
{
    return hlt_boxes_touch(&a->box, &b->box, LABELS_APART);
}

static unsigned collisions_with_field(const struct hlt_label *l,
                                      const struct hlt_field *f)
{
    unsigned n = l->box.x0 < f->frame.x0 || l->box.x1 > f->frame.x1 ||
                 l->box.y0 < f->frame.y0 || l->box.y1 > f->frame.y1;
    for (uint32_t i = 0; i < f->n_boxes; i++)
        n += hlt_boxes_touch(&l->box, &f->boxes[i], BOXES_APART);
    return n;
}

/* Of a label where it is, in pixels of distance; the field's part of it. */
static double cost_in_field(const struct hlt_label *l,
                            const struct hlt_field *f)
{
    double cost = COLLISION * collisions_with_field(l, f) +
                  hypot(l->near_x - l->x, l->near_y - l->y);
    for (uint32_t i = 0; i < f->n_boxes; i++)
        cost += LEADER_CROSSES / 3 * leader_cuts(l, &f->boxes[i]);
    for (uint32_t i = 0; i < f->n_lines; i++)
        cost += LINE_COVERED * hlt_boxes_touch(&l->box, &f->lines[i], 0);
    return cost;
}

static double cost_between(const struct hlt_label *a,
                           const struct hlt_label *b)
{
    double cost = collides(a, b) ? COLLISION : 0;
    cost += leader_cuts(a, &b->box) ? LEADER_CROSSES : 0;
    cost += leader_cuts(b, &a->box) ? LEADER_CROSSES : 0;
    if (a->leader && b->leader &&
        segments_cross(a->x, a->y, a->near_x, a->near_y, b->x, b->y,
                       b->near_x, b->near_y))
        cost += LEADER_CROSSES;
    return cost;
}

/* The best place of label i with those of [0, n) where they are; whether it
 * is another one. */
static bool settle(struct hlt_label *labels, uint32_t n, uint32_t i,
                   const struct hlt_field *f)
{
    struct hlt_label *l = &labels[i], best = *l;
    double least = (double)INFINITY;
    struct hlt_box before = l->box;
    for (unsigned k = 0; k < PLACES; k++) {
        put(l, k);
        double cost = cost_in_field(l, f);
        for (uint32_t j = 0; j < n && cost < least; j++)
            cost += j == i ? 0 : cost_between(l, &labels[j]);
        if (cost < least) {
            least = cost;
            best = *l;
        }
    }
    *l = best;
    return memcmp(&before, &l->box, sizeof before) != 0;
}

/* ---- leaving out -------------------------------------------------------- */

static unsigned collisions(const struct hlt_label *labels, uint32_t n,
                           uint32_t i, const struct hlt_field *f)
{
    unsigned count = 1000 * (collisions_with_field(&labels[i], f) > 0);
    for (uint32_t j = 0; j < n; j++)
        count += j != i && labels[j].placed && collides(&labels[i], &labels[j]);
    return count;
}

static bool drop_worst(struct hlt_label *labels, uint32_t n,
                       const struct hlt_field *f)
{
    unsigned most = 0;
    uint32_t worst = 0;
    for (uint32_t i = 0; i < n; i++) {
        unsigned c = labels[i].placed ? collisions(labels, n, i, f) : 0;
        if (c > most) {
            most = c;
            worst = i;
        }
    }
    if (most > 0)
        labels[worst].placed = false;
    return most > 0;
}

uint32_t hlt_labels_place(struct hlt_label *labels, uint32_t n,
                          const struct hlt_field *f)
{
    uint32_t placed = 0;
    bool moved = true;
    for (uint32_t i = 0; i < n; i++)
        settle(labels, i, i, f);
    for (int pass = 0; pass < PASSES && moved; pass++) {
        moved = false;
        for (uint32_t i = 0; i < n; i++)
            moved |= settle(labels, n, i, f);
    }
    for (uint32_t i = 0; i < n; i++)
        labels[i].placed = true;
    while (drop_worst(labels, n, f))
        continue;
    for (uint32_t i = 0; i < n; i++)
        placed += labels[i].placed;
    return placed;
}
