/* SPDX-License-Identifier: Zlib */
/* Translucent objects over each other that change places: a pattern that
 * changes from one frame to the next is a pop, as the object's light is then
 * sampled elsewhere; and every order must give the picture of that order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 96, PANES = 4, CROWD = 14, FRAMES = 16, BORDER = 8 };

enum asked { ORDERS, STILL, TURNING, MOVING };

struct own {
    struct hlc_shot shot, forward;
    bool made[2];
    struct hl_item items[CROWD + 1];
    float path[CROWD][6];        /* x, y, z in the beginning; their speeds   */
};

#define HALF 0.12                /* of a pane of the crowd, m                */
#define TEXEL (2.0 / SIDE)       /* m                                        */

/* A wall of 2 m that fills the view, and panes before it: PANES that cover all
 * of it, or a crowd of small ones. */
static void build(struct hls_rig *rig, struct own *w, bool crowd)
{
    int n = crowd ? CROWD : PANES;
    hls_rig_begin(rig, 1, 90);
    hls_rig_wall(rig, 0, 3, 0);
    for (int i = 0; i < n; i++) {
        hls_rig_pane(rig, hls_rig_glass(rig, i, 0.4), i, crowd ? HALF : 2.5, 0);
        for (int k = 0; k < 6; k++)
            w->path[i][k] = (float)hlh_random(&rig->b, -0.7, 0.7);
    }
    hls_rig_lights(rig);
}

/* arg: enum asked, enum hl_stipple_mode, panes. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct own *w = lab->data = calloc(1, sizeof *w);
    struct hlc_options o;
    struct hls_rig rig;
    bool compared = c->arg[0] == (double)ORDERS;
    (void)skip;
    if (!w)
        return hls_rig_fail("stipple", HL_ERR_MEMORY);
    hls_rig_options(&o, lab, SIDE, SIDE);
    o.near = 0.1;            /* by the bounds it would lie at the wall       */
    o.translucency = HL_TRANSLUCENCY_2X2;
    o.stipple_mode = (enum hl_stipple_mode)c->arg[1];
    build(&rig, w, c->arg[0] == (double)STILL || c->arg[0] == (double)MOVING);
    w->made[0] = hls_rig_end(&rig, lab, &o) &&
                 hls_rig_shot(&w->shot, lab, &o);
    o.translucency = HL_TRANSLUCENCY_FORWARD;
    if (w->made[0] && compared)
        w->made[1] = hls_rig_shot(&w->forward, lab, &o);
    if (!w->made[0] || (compared && !w->made[1]))
        return false;
    memcpy(w->items, lab->stage.world.items,
           lab->stage.world.n_items * sizeof *w->items);
    w->shot.frame.items = w->forward.frame.items = w->items;
    return true;
}

static void end(struct hls_lab *lab)
{
    struct own *w = lab->data;
    if (w && w->made[0])
        hlc_shot_close(&w->shot);
    if (w && w->made[1])
        hlc_shot_close(&w->forward);
    free(w);
    lab->data = NULL;
}

/* ---- orders ------------------------------------------------------------- */

/* Order number 0..23 of PANES, by depth. */
static void permute(struct own *w, uint32_t number, uint32_t n)
{
    int left[PANES] = { 0, 1, 2, 3 };
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = number % (n - i);
        number /= n - i;
        w->items[1 + left[k]].world[14] = (float)(0.01 * (i + 1));
        for (uint32_t j = k; j + 1 < n - i; j++)
            left[j] = left[j + 1];
    }
}

/* Largest, but at the picture's edge, where a pattern has texels on one side
 * only. */
static double difference(const struct hlh_picture *a,
                         const struct hlh_picture *b)
{
    double most = 0;
    for (uint32_t y = BORDER; y < SIDE - BORDER; y++)
        for (uint32_t i = 3 * BORDER; i < 3 * (SIDE - BORDER); i++) {
            double d = fabs((double)a->rgb[3 * SIDE * y + i] -
                            (double)b->rgb[3 * SIDE * y + i]);
            most = d <= most ? most : d;
        }
    return most;
}

static bool order(double *m, struct own *w, uint32_t number)
{
    struct hlh_picture a, b;
    permute(w, number, PANES);
    if (!hls_rig_picture(&a, &w->shot))
        return false;
    bool ok = hls_rig_picture(&b, &w->forward);
    if (ok) {
        *m = difference(&a, &b);
        free(b.rgb);
    }
    free(a.rgb);
    return ok;
}

/* ---- frames ------------------------------------------------------------- */

static bool changes(uint32_t *n, struct own *w)
{
    enum hl_result r = hlc_shot_draw(&w->shot, NULL);
    *n += w->shot.stats.stipple_changes;
    return r == HL_OK || hls_rig_fail("stipple", r);
}

/* Frame `number` after the one before it: all turned by one place in depth. */
static bool turn(double *m, struct own *w, uint32_t number, uint32_t panes)
{
    uint32_t n = 0;
    w->shot.frame.n_items = 1 + panes;
    for (uint32_t f = number < 2 ? 1 : number - 1; f <= number; f++) {
        for (uint32_t i = 0; i < panes; i++)
            w->items[1 + i].world[14] = (float)(0.01 * (1 + (i + f) % panes));
        n = 0;
        if (!changes(&n, w))
            return false;
    }
    *m = n;
    return true;
}

/* -0.85..0.85 and back. */
static float bounce(double x)
{
    double t = fmod(fabs(x + 0.85), 3.4);
    return (float)((t < 1.7 ? t : 3.4 - t) - 0.85);
}

static void place(struct own *w, double time)
{
    for (int i = 0; i < CROWD; i++) {
        float *m = w->items[1 + i].world;
        for (int k = 0; k < 3; k++)
            m[12 + k] = bounce((double)w->path[i][k] +
                               time * (double)w->path[i][3 + k]);
        /* Depths change places, and outlines nearly keep theirs. */
        m[14] = 0.01f + 0.01f * m[14];
    }
}

static uint64_t meetings(const struct own *w, int i)
{
    uint64_t met = 0;
    for (int k = 0; k < i; k++) {
        const float *a = w->items[1 + i].world, *b = w->items[1 + k].world;
        bool over = fabs((double)(a[12] - b[12])) < 2 * HALF &&
                    fabs((double)(a[13] - b[13])) < 2 * HALF;
        met |= (uint64_t)over << k;
    }
    return met;
}

/* Changed patterns a pair that comes to overlap or ceases to, over frames in
 * which the fastest pane goes p texels each. */
static bool move(double *m, struct own *w, double p)
{
    uint64_t before[CROWD] = { 0 };
    uint32_t events = 0, first = 0, n = 0;
    double step = p * TEXEL / 0.7;
    for (int f = 0; f <= FRAMES; f++) {
        place(w, f * step);
        for (int i = 0; i < CROWD; i++) {
            uint64_t now = meetings(w, i), news = now ^ before[i];
            before[i] = now;
            for (; f && news; news &= news - 1)
                events++;
        }
        if (!changes(f ? &n : &first, w))
            return false;
    }
    *m = n ? n / (events ? (double)events : 0.5) : 0;
    return true;
}

/* The crowd's n-th picture, twice. */
static bool still(double *m, struct own *w, uint32_t number)
{
    uint32_t first = 0, n = 0;
    place(w, number);
    bool ok = changes(&first, w) && changes(&n, w) && changes(&n, w);
    *m = n;
    return ok;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    switch ((enum asked)c->arg[0]) {
    case ORDERS: return order(m, w, (uint32_t)p - 1);
    case TURNING: return turn(m, w, (uint32_t)p, (uint32_t)c->arg[2]);
    case STILL: return still(m, w, (uint32_t)p);
    default: return move(m, w, p);
    }
}

static const struct hls_case cases[] = {
    { "orders", "all 4! orders of 4 panes, difference from forward", 1, 24,
      0.01, false, NAN, NAN,
      "none: light of a texel beside, 0.0065",
      { ORDERS, HL_STIPPLE_BEST, 0, 0 } },
    { "still", "frames of a crowd that stands, changes", 1, 24, 0, false, NAN,
      NAN, "none: nothing moved (core/stipple.h)",
      { STILL, HL_STIPPLE_BEST, 0, 0 } },
    { "turning", "3 panes change places in depth, changes", 1, 24, 0, false,
      NAN, NAN, "none: overlaps stay as they are",
      { TURNING, HL_STIPPLE_BEST, 3, 0 } },
    { "turning-4", "4 panes, one without a pattern, changes", 1, 24, 0, false,
      NAN, NAN, "none: overlaps stay as they are",
      { TURNING, HL_STIPPLE_BEST, 4, 0 } },
    { "turning-dealt", "3 panes, patterns dealt by depth, changes", 1, 24, 0,
      false, 2, 2, "2: the first frame with another order",
      { TURNING, HL_STIPPLE_BY_DEPTH, 3, 0 } },
    { "moving", "a crowd of 14 in motion, changes an overlap that comes or "
      "goes", 1, 32, 1.0 / 3, false, NAN, NAN,
      "none: 1/6; half come, a third of one pattern, one changes",
      { MOVING, HL_STIPPLE_BEST, 0, 0 } },
    { "moving-dealt", "the same, dealt by depth", 1, 32, 1.0 / 3, false, 1,
      1, "1: each change of depths moves all behind by one",
      { MOVING, HL_STIPPLE_BY_DEPTH, 0, 0 } },
};

const struct hls_row hls_row_stipple = {
    "stipple", "Patterns of translucent objects change while things move",
    "8, 9, 16 (Kircher, Lawrance 2009, sections 4 and 7.1)",
    "order, frame or texels a frame", "", "changes, or error", HLS_WHOLE,
    cases, sizeof cases / sizeof *cases, begin, end, measure
};
