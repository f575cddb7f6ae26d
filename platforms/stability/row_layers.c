/* SPDX-License-Identifier: Zlib */
/* More translucent layers over a pixel than there are patterns: 3 in blocks of
 * 2 x 2 texels, 15 in 4 x 4. What is without a pattern must be lit forward and
 * counted; by the published rule patterns are dealt twice, and the nearer
 * layer takes the light of the farther. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 128, MOST = 20, SLIDING = 4, BORDER = 8 };

enum asked {
    UNSTIPPLED,              /* layers without a pattern, counted            */
    CONFLICTS,               /* pairs with one pattern, counted              */
    PICTURE,                 /* largest difference from forward              */
    SLIDE                    /* UNSTIPPLED of 4 panes in a row               */
};

struct own {
    struct hlc_shot shot, forward;
    bool made[2];
    struct hl_item items[MOST + 1];
};

/* A wall, and panes before it that cover all of the view, or SLIDING ones a
 * metre wide. */
static void build(struct hls_rig *rig, int panes, double half)
{
    hls_rig_begin(rig, 1, 60);
    hls_rig_wall(rig, 0, 3, 0);
    for (int i = 0; i < panes; i++)
        hls_rig_pane(rig, hls_rig_glass(rig, i, 0.3), i, half, 0.005 * (i + 1));
    hls_rig_lights(rig);
}

/* arg: texels a side of a block, enum asked, enum hl_stipple_mode. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct own *w = lab->data = calloc(1, sizeof *w);
    struct hlc_options o;
    struct hls_rig rig;
    bool slides = c->arg[1] == (double)SLIDE;
    (void)skip;
    if (!w)
        return hls_rig_fail("layers", HL_ERR_MEMORY);
    hls_rig_options(&o, lab, SIDE, SIDE);
    o.translucency = c->arg[0] > 2 ? HL_TRANSLUCENCY_4X4 : HL_TRANSLUCENCY_2X2;
    o.stipple_mode = (enum hl_stipple_mode)c->arg[2];
    build(&rig, slides ? SLIDING : MOST, slides ? 0.15 : 2);
    w->made[0] = hls_rig_end(&rig, lab, &o) &&
                 hls_rig_shot(&w->shot, lab, &o);
    o.translucency = HL_TRANSLUCENCY_FORWARD;
    if (w->made[0] && c->arg[1] == (double)PICTURE)
        w->made[1] = hls_rig_shot(&w->forward, lab, &o);
    return w->made[0] && (w->made[1] || c->arg[1] != (double)PICTURE);
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

/* At the picture's edge a pattern has texels on one side only, up to a block
 * away. */
static bool at_edge(size_t pixel)
{
    size_t x = pixel % SIDE, y = pixel / SIDE;
    return x < BORDER || y < BORDER || x >= SIDE - BORDER ||
           y >= SIDE - BORDER;
}

static bool differ(double *m, struct own *w)
{
    struct hlh_picture a, b;
    w->forward.frame.n_items = w->shot.frame.n_items;
    if (!hls_rig_picture(&a, &w->shot))
        return false;
    if (!hls_rig_picture(&b, &w->forward)) {
        free(a.rgb);
        return false;
    }
    *m = 0;
    for (size_t i = 0; i < 3 * (size_t)SIDE * SIDE; i++) {
        double d = fabs((double)a.rgb[i] - (double)b.rgb[i]);
        *m = d <= *m || at_edge(i / 3) ? *m : d;
    }
    free(a.rgb);
    free(b.rgb);
    return true;
}

/* Each pane overlaps the next by p per cent of its width. */
static void slide(struct own *w, double p)
{
    const struct hl_frame *f = &w->shot.frame;
    memcpy(w->items, w->shot.stage->world.items,
           (SLIDING + 1) * sizeof *w->items);
    for (int i = 0; i < SLIDING; i++)
        w->items[i + 1].world[12] = (float)((i - 1.5) * 0.3 * (1 - p / 100));
    w->shot.frame.items = w->items;
    w->shot.frame.n_items = f->n_items;
}

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    struct own *w = lab->data;
    enum asked asked = (enum asked)c->arg[1];
    w->shot.frame.n_items = 1 + (uint32_t)p;
    if (asked == PICTURE)
        return differ(m, w);
    if (asked == SLIDE) {
        w->shot.frame.n_items = 1 + SLIDING;
        slide(w, p);
    }
    enum hl_result r = hlc_shot_draw(&w->shot, NULL);
    if (r != HL_OK)
        return hls_rig_fail("layers", r);
    *m = asked == CONFLICTS ? w->shot.stats.stipple_conflicts
                            : w->shot.stats.unstippled;
    return true;
}

/* Away from the picture's edge: light of up to 0.9 / m of slope on 0.8 of
 * white, read a texel of 9 mm off where a layer took the pixel's own, is 0.0065
 * off; a layer that is lost, 0.1 and more. A step of 7e3 colour is 0.0078. */
#define PICTURE_LIMIT 0.01
#define PICTURE_NONE PICTURE_LIMIT, false, NAN, NAN, \
                     "none: light of a texel beside, 0.0065"

static const struct hls_case cases[] = {
    { "2x2", "patterns of 2 x 2, layers lit forward", 1, 8, 0, false, 4, 4,
      "4: three patterns beside the opaque", { 2, UNSTIPPLED, 0, 0 } },
    { "4x4", "patterns of 4 x 4, layers lit forward", 1, MOST, 0, false, 16,
      16, "16: fifteen patterns beside the opaque", { 4, UNSTIPPLED, 0, 0 } },
    { "2x2-picture", "patterns of 2 x 2, difference from forward", 1, 8,
      PICTURE_NONE, { 2, PICTURE, 0, 0 } },
    { "4x4-picture", "patterns of 4 x 4, difference from forward", 1, MOST,
      PICTURE_NONE, { 4, PICTURE, 0, 0 } },
    { "2x2-dealt", "patterns of 2 x 2 dealt by depth, conflicts", 1, 8, 0,
      false, 4, 4, "4: the fourth layer is dealt the first's pattern",
      { 2, CONFLICTS, HL_STIPPLE_BY_DEPTH, 0 } },
    { "2x2-overlap", "4 panes in a row, by % of overlap, lit forward", 0, 100,
      0, false, 66, 68, "2/3: the first pane meets the last",
      { 2, SLIDE, 0, 0 } },
};

const struct hls_row hls_row_layers = {
    "layers", "More translucent layers over a pixel than there are patterns",
    "7, 8 (Kircher, Lawrance 2009, section 4)", "layers, or % of overlap", "",
    "layers without a pattern, or error", HLS_WHOLE, cases,
    sizeof cases / sizeof *cases, begin, end, measure
};
