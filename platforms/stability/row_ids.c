/* SPDX-License-Identifier: Zlib */
/* Region ids that collide where two surfaces touch: a wall of n bricks, each
 * with six neighbours, as objects and as normal groups of one mesh. What
 * counts are the ids that the DSF buffer stores on either side of an edge. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "core/ids.h"
#include "platforms/cli/commands.h"
#include "platforms/stability/rig.h"

enum { SIDE = 256, PIXELS = SIDE * SIDE, BRICKS = 4096 };

enum naming { UNIQUE, COLORED, PAPER, SEQUENCE, SEEDS };

/* Pairs of neighbours that SEEDS looks at: 1 of 256 is 47 of them, with a
 * standard deviation of 7. */
enum { PAIRS = 12000 };

struct own {
    struct hlc_options o;
    struct hlc_shot shot;
    bool made;
    uint32_t *truth;             /* 1 + brick, a texel                       */
    float *id;                   /* as stored, a texel                       */
    uint32_t order[BRICKS];      /* place of a brick                         */
};

/* ---- the wall ----------------------------------------------------------- */

/* Numbers in the order of their making have nothing to do with places. */
static void shuffle(uint32_t *order, uint32_t n)
{
    struct hlh_builder b;
    struct hlh_scene none;
    hlh_build_begin(&b, &none, n);
    for (uint32_t i = 0; i < n; i++)
        order[i] = i;
    for (uint32_t i = n; i > 1; i--) {
        uint32_t k = hlh_random_below(&b, i), other = order[k];
        order[k] = order[i - 1];
        order[i - 1] = other;
    }
}

/* Cut in the middle, where its neighbours' corners are: pieces that touch
 * without a corner in common are not known as neighbours (core/mesh.h). */
static void brick(struct hls_rig *rig, double x, double y, double side)
{
    hlh_add_patch(&rig->b, hlh_v3(x, y, 0), hlh_v3(side, 0, 0),
                  hlh_v3(0, side, 0), 2, 1);
}

/* A normal of its own for what was added last. */
static void tilt(struct hls_rig *rig, uint32_t first)
{
    double x = hlh_random(&rig->b, -0.3, 0.3);
    double y = hlh_random(&rig->b, -0.3, 0.3);
    double z = sqrt(1 - x * x - y * y);
    for (uint32_t i = first; !rig->b.failed && i < rig->b.n_vertices; i++) {
        float *n = rig->b.vertices[i].normal;
        n[0] = (float)x;
        n[1] = (float)y;
        n[2] = (float)z;
    }
}

/* Rows of bricks from -1 to 1, every other one moved by half a brick. */
static void build(struct hls_rig *rig, const uint32_t *order, uint32_t n,
                  bool groups)
{
    uint32_t rows = (uint32_t)(sqrt(n) + 0.5);
    uint32_t columns = (n + rows - 1) / rows;
    double side = 2 / (columns + 0.5);
    uint32_t mesh = 0;
    hls_rig_begin(rig, 1, 90);
    if (!groups) {
        brick(rig, 0, 0, side);
        mesh = hlh_build_mesh(&rig->b, "brick", 0);
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t at = order[i], first = rig->b.n_vertices;
        double x = -1 + side * (at % columns + at / columns % 2 * 0.5);
        double y = -1 + side * (at / columns);
        if (!groups) {
            hlh_build_object(&rig->b, mesh, hlh_v3(x, y, 0), hlh_v3(1, 1, 1),
                             0);
            continue;
        }
        brick(rig, x, y, side);
        tilt(rig, first);
    }
    if (groups)
        hls_rig_object(rig, 0);
    hlh_build_light(&rig->b, hlh_v3(0, 0, 1), 3, hlh_v3(1, 1, 1));
}

/* arg: enum naming, groups instead of objects. */
static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct own *w = lab->data = calloc(1, sizeof *w);
    (void)skip;
    if (!w)
        return hls_rig_fail("ids", HL_ERR_MEMORY);
    w->truth = malloc(PIXELS * sizeof *w->truth);
    w->id = malloc(PIXELS * sizeof *w->id);
    if (!w->truth || !w->id)
        return hls_rig_fail("ids", HL_ERR_MEMORY);
    hls_rig_options(&w->o, lab, SIDE, SIDE);
    w->o.light_path = HL_LIGHT_PATH_RECTS;
    shuffle(w->order, BRICKS);
    build(&rig, w->order, BRICKS, c->arg[1] > 0);
    w->made = hls_rig_end(&rig, lab, &w->o) &&
              hls_rig_shot(&w->shot, lab, &w->o);
    return w->made;
}

static void end(struct hls_lab *lab)
{
    struct own *w = lab->data;
    if (w && w->made)
        hlc_shot_close(&w->shot);
    if (w) {
        free(w->truth);
        free(w->id);
    }
    free(w);
    lab->data = NULL;
}

/* ---- ids ---------------------------------------------------------------- */

static bool look(struct own *w)
{
    struct hlc_texels t;
    float v[4], pair[2];
    if (!hls_rig_texels(&t, &w->shot, HL_ROLE_DSF))
        return false;
    for (uint32_t i = 0; i < PIXELS; i++) {
        hlc_texel(v, &t, i);
        hlc_two16(pair, w->shot.plan.two16, v);
        w->id[i] = floorf(pair[1] * w->shot.plan.id_steps + 0.5f);
    }
    hlc_texels_free(&t);
    return true;
}

static void count_pair(const struct own *w, uint32_t a, uint32_t b,
                       uint32_t *edges, uint32_t *shared)
{
    if (w->truth[a] == w->truth[b])
        return;
    (*edges)++;
    *shared += w->id[a] == w->id[b];
}

/* Of texels beside each other that show two bricks, how many share an id. */
static void count(const struct own *w, uint32_t *edges, uint32_t *shared)
{
    for (uint32_t i = 0; i < PIXELS; i++) {
        if (i % SIDE < SIDE - 1)
            count_pair(w, i, i + 1, edges, shared);
        if (i + SIDE < PIXELS)
            count_pair(w, i, i + SIDE, edges, shared);
    }
}

static bool swap(struct own *w, enum hlc_ids_scheme scheme, uint32_t n,
                 bool groups)
{
    struct hls_rig rig;
    struct hlc_options o = w->o;
    o.ids_scheme = scheme;
    shuffle(w->order, n);
    build(&rig, w->order, n, groups);
    return hls_rig_swap(&w->shot, &rig, &o);
}

static void name_by_bytes(struct own *w, uint32_t n, bool random, uint32_t seed)
{
    struct hl_item *item = w->shot.stage->world.items;
    for (uint32_t i = 0; i < n; i++) {
        uint8_t name = random ? hl_ids_random8((uint64_t)seed << 32, i)
                              : (uint8_t)(i & 255);
        item[i].id_base = hl_ids_paper_region(name, 1);
    }
}

/* The truth is the picture with unique ids. */
static bool see_truth(struct own *w, uint32_t n, bool groups)
{
    void *ids;
    uint32_t width, height;
    if (!swap(w, HLC_IDS_UNIQUE, n, groups) || !look(w))
        return false;
    enum hl_result r = hlc_shot_inspect(&w->shot, HL_INSPECT_IDS, &ids, &width,
                                        &height);
    if (r != HL_OK)
        return hls_rig_fail("ids", r);
    memcpy(w->truth, ids, PIXELS * sizeof *w->truth);
    free(ids);
    return true;
}

/* Per cent; of SEEDS how far the share is off 1/256, as a share of that. */
static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    static const enum hlc_ids_scheme schemes[] = {
        HLC_IDS_UNIQUE, HLC_IDS_COLORED, HLC_IDS_PAPER, HLC_IDS_PAPER,
        HLC_IDS_PAPER
    };
    struct own *w = lab->data;
    enum naming naming = (enum naming)c->arg[0];
    uint32_t n = (uint32_t)p, edges = 0, shared = 0;
    uint32_t looks = naming == SEEDS ? 1 + PAIRS / (3 * n) : 1;
    bool groups = c->arg[1] > 0;
    if (!see_truth(w, n, groups) ||
        (naming != UNIQUE && !swap(w, schemes[naming], n, groups)))
        return false;
    for (uint32_t i = 0; i < looks; i++) {
        if (naming == SEQUENCE || naming == SEEDS)
            name_by_bytes(w, n, naming == SEEDS, i + 1);
        if (!look(w))
            return false;
        count(w, &edges, &shared);
    }
    double share = edges ? (double)shared / edges : NAN;
    *m = naming == SEEDS ? fabs(share * 256 - 1) : 100 * share;
    return true;
}

/* One drawing of ids for a wall of about 3 n pairs of neighbours has none
 * that collide with a chance of (255/256)^(3 n): below 2.5 % from n = 317 on,
 * and 83 % at 16. In sequence numbers below 257 never do; of 3 n pairs at
 * n = 700 there are 5.4 to be expected, none with a chance of 0.5 %. */
#define ONCE 16, BRICKS, 0, false, 16, 317, \
             "first of 1/256 of 3 n pairs: 60, 95 % of drawings below 317"
#define NEVER 16, BRICKS, 0, false, NAN, NAN

static const struct hls_case cases[] = {
    { "unique", "objects, a number each", NEVER, "none: 65,534 ids",
      { UNIQUE, 0 } },
    { "coloured", "objects, coloured by neighbours", NEVER,
      "none: neighbours differ", { COLORED, 0 } },
    { "paper", "objects, random bytes", ONCE, { PAPER, 0 } },
    { "paper-share", "objects, random bytes: off 1/256, as a share of that",
      256, BRICKS, 0.75, false, NAN, NAN,
      "none: 1/256 at every n; 47 pairs seen, sigma 15 %", { SEEDS, 0 } },
    { "sequence", "objects, numbers modulo 256", 16, BRICKS, 0, false, 257,
      700, "257 to 700: the table of b5", { SEQUENCE, 0 } },
    { "groups-unique", "normal groups, a number each", NEVER,
      "none: 65,534 ids", { UNIQUE, 1 } },
    { "groups-coloured", "normal groups, coloured by neighbours", NEVER,
      "none: neighbours differ", { COLORED, 1 } },
    { "groups-paper", "normal groups, random bytes", ONCE, { PAPER, 1 } },
};

const struct hls_row hls_row_ids = {
    "ids", "Two surfaces that touch have one id, and the filter mixes them",
    "4, 5 (Kircher, Lawrance 2009, section 3.1)", "surfaces", "",
    "edge texels that share an id, %", HLS_WHOLE, cases,
    sizeof cases / sizeof *cases, begin, end, measure
};
