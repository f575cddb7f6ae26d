/* SPDX-License-Identifier: Zlib */
/* The stipple scheduler through its public functions: frames of rectangles,
 * still and moving, its modes, what it refuses. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "core/stipple.h"
#include "tests/mesh_kit.h"

enum { NONE = HL_STIPPLE_NONE, P = HL_STIPPLE_2X2, MAX_N = 1000 };

/* ---- a stage --------------------------------------------------------- */

struct stage {
    void *memory;
    struct hl_stipple *stipple;
    struct hl_stipple_object objects[MAX_N];
    struct hl_stipple_frame frame;
    uint8_t pattern[MAX_N];
    struct hl_stipple_stats stats;
    float vx[MAX_N], vy[MAX_N], vz[MAX_N];
};

static struct stage *stage_of(uint32_t max_objects, uint32_t max_pairs)
{
    struct stage *s = calloc(1, sizeof *s);
    size_t bytes = hl_stipple_bytes(max_objects, max_pairs);
    assert_non_null(s);
    s->memory = malloc(bytes);
    assert_non_null(s->memory);
    /* What was in the memory must not matter. */
    memset(s->memory, 0xA5, bytes);
    s->stipple = hl_stipple_create(s->memory, max_objects, max_pairs);
    assert_non_null(s->stipple);
    s->frame.objects = s->objects;
    s->frame.patterns = P;
    return s;
}

static void stage_free(struct stage *s)
{
    free(s->memory);
    free(s);
}

static struct hl_stipple_object *add(struct stage *s, uint32_t id, float x,
                                     float y, float w, float h)
{
    struct hl_stipple_object *o = &s->objects[s->frame.n_objects++];
    memset(o, 0, sizeof *o);
    o->id = id;
    o->x0 = x;
    o->y0 = y;
    o->x1 = x + w;
    o->y1 = y + h;
    o->weight = w > 0 && h > 0 && w < 1e4f && h < 1e4f ? (uint32_t)(w * h) : 7;
    return o;
}

static enum hl_result assign(struct stage *s)
{
    return hl_stipple_assign(s->stipple, &s->frame, s->pattern, &s->stats);
}

static void good(struct stage *s)
{
    assert_int_equal(assign(s), HL_OK);
}

/* Share a texel. */
static bool overlap(const struct hl_stipple_object *a,
                    const struct hl_stipple_object *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1 &&
           a->x0 < a->x1 && b->x0 < b->x1 && a->y0 < a->y1 && b->y0 < b->y1;
}

/* Counts all that stats says anew; `before` by index, 0: was not there. */
static void recount(const struct stage *s, const uint8_t *before)
{
    struct hl_stipple_stats t = s->stats;
    uint32_t n = s->frame.n_objects;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t w = s->objects[i].weight ? s->objects[i].weight : 1;
        if (s->pattern[i] == NONE) {
            t.unassigned--;
            t.unassigned_weight -= w;
        }
        if (before && before[i] && before[i] != s->pattern[i]) {
            t.changes--;
            t.changes_weight -= w;
        }
        for (uint32_t k = 0; k < i; k++) {
            bool meet = overlap(&s->objects[i], &s->objects[k]);
            t.pairs -= meet;
            t.conflicts -= meet && s->pattern[i] != NONE &&
                           s->pattern[i] == s->pattern[k];
        }
    }
    assert_int_equal(t.unassigned, 0);
    assert_true(t.unassigned_weight == 0);
    assert_int_equal(t.changes, 0);
    assert_true(t.changes_weight == 0);
    assert_int_equal(t.pairs, 0);
    assert_int_equal(t.conflicts, 0);
}

/* ---- moving scenes --------------------------------------------------- */

enum { WIDTH = 640, HEIGHT = 360 };

static void scatter(struct stage *s, uint32_t n, float size, float speed,
                    uint64_t *random)
{
    for (uint32_t i = 0; i < n; i++) {
        float w = size * (0.5f + mk_unit(random));
        float h = size * (0.5f + mk_unit(random));
        float x = mk_unit(random) * (WIDTH - w);
        struct hl_stipple_object *o =
            add(s, 100 + 7 * i, x, mk_unit(random) * (HEIGHT - h), w, h);
        o->depth = 1 + 30 * mk_unit(random);
        o->wanted = 1 + i % s->frame.patterns;
        s->vx[i] = (mk_unit(random) - 0.5f) * 2 * speed;
        s->vy[i] = (mk_unit(random) - 0.5f) * 2 * speed;
        s->vz[i] = (mk_unit(random) - 0.5f) * 0.1f * speed;
    }
}

static void bounce(float *low, float *high, float *speed, float end)
{
    if (*low + *speed < 0 || *high + *speed > end)
        *speed = -*speed;
    *low += *speed;
    *high += *speed;
}

static void move(struct stage *s)
{
    for (uint32_t i = 0; i < s->frame.n_objects; i++) {
        struct hl_stipple_object *o = &s->objects[i];
        float far = o->depth;
        bounce(&o->x0, &o->x1, &s->vx[i], WIDTH);
        bounce(&o->y0, &o->y1, &s->vy[i], HEIGHT);
        bounce(&o->depth, &far, &s->vz[i], 31);
    }
}

struct sums { uint64_t pairs, conflicts, none, none_weight, changes, steps; };

static struct sums play(enum hl_stipple_mode mode, uint32_t patterns,
                        float size, uint32_t hold, float margin,
                        uint64_t random)
{
    struct stage *s = stage_of(50, 1225);
    struct sums sum = {0, 0, 0, 0, 0, 0};
    uint8_t before[MAX_N] = {0};
    s->frame.patterns = patterns;
    s->frame.mode = mode;
    s->frame.hold = hold;
    s->frame.margin = margin;
    scatter(s, 50, size, 2, &random);
    for (int frame = 0; frame < 600; frame++, move(s)) {
        good(s);
        if (frame % 50 == 0)
            recount(s, frame ? before : NULL);
        memcpy(before, s->pattern, sizeof before);
        sum.pairs += s->stats.pairs;
        sum.conflicts += s->stats.conflicts;
        sum.none += s->stats.unassigned;
        sum.none_weight += s->stats.unassigned_weight;
        sum.changes += s->stats.changes;
        sum.steps += s->stats.steps;
    }
    stage_free(s);
    return sum;
}

static void show(const char *name, const struct sums *s)
{
    print_message("    %-14s pairs %6.1f  conflicts %6.2f  without %5.2f "
                  "(%6.0f texels)  changes %5.2f  steps %4.0f a frame\n", name,
                  (double)s->pairs / 600, (double)s->conflicts / 600,
                  (double)s->none / 600, (double)s->none_weight / 600,
                  (double)s->changes / 600, (double)s->steps / 600);
}

/* Patterns by depth or by hand lose light where objects overlap; the best
 * ones never, leave less without than first-come ones, and change less. */
static void compare(uint32_t patterns, float size, uint64_t random)
{
    const enum hl_stipple_mode modes[6] = {
        HL_STIPPLE_USER, HL_STIPPLE_BY_DEPTH, HL_STIPPLE_BY_DEPTH_FREE,
        HL_STIPPLE_BEST, HL_STIPPLE_BEST, HL_STIPPLE_BEST };
    const uint32_t holds[6] = {0, 0, 0, 0, 50, 50};
    const char *const names[6] = { "user", "by depth", "by depth, free",
                                   "best", "best, hold 50", "   margin 8" };
    enum { USER, DEPTH, FREE, BEST, HOLD, NEAR };
    struct sums of[6];
    print_message("    %u patterns, 50 objects of about %g texels:\n", patterns,
                  (double)size);
    for (int i = 0; i < 6; i++) {
        of[i] = play(modes[i], patterns, size, holds[i], i == NEAR ? 8 : 0,
                     random);
        show(names[i], &of[i]);
    }
    assert_true(of[USER].conflicts > 600 && of[DEPTH].conflicts > 600);
    assert_int_equal(of[USER].changes, 0);
    assert_int_equal(of[BEST].conflicts, 0);
    assert_int_equal(of[NEAR].conflicts, 0);
    assert_true(of[BEST].none_weight < of[FREE].none_weight);
    assert_true(of[BEST].changes < of[DEPTH].changes);
    /* Where one object and more a frame goes without, fewer change. */
    assert_true(of[BEST].none < 600 || of[HOLD].changes < of[BEST].changes);
}

static void moving_scenes_lose_no_light(void **state)
{
    uint64_t random = mk_seed() + 1;
    (void)state;
    compare(HL_STIPPLE_2X2, 30, random);
    compare(HL_STIPPLE_2X2, 60, random);
    compare(HL_STIPPLE_4X4, 140, random);
}

/* ---- against all assignments ----------------------------------------- */

static void best_of_all(const struct stage *s, const uint8_t *before,
                        uint64_t *none, uint64_t *changed)
{
    uint32_t n = s->frame.n_objects;
    *none = *changed = UINT64_MAX;
    for (uint32_t code = 0; code < 1u << 2 * n; code++) {
        uint64_t lost = 0, other = 0;
        bool valid = true;
        for (uint32_t i = 0; i < n && valid; i++) {
            uint32_t c = code >> 2 * i & 3, now = c ? c : NONE;
            lost += c ? 0 : s->objects[i].weight;
            other += before[i] && before[i] != now ? s->objects[i].weight : 0;
            for (uint32_t k = 0; k < i && valid; k++)
                valid = !(c && c == (code >> 2 * k & 3) &&
                          overlap(&s->objects[i], &s->objects[k]));
        }
        if (valid && (lost < *none || (lost == *none && other < *changed))) {
            *none = lost;
            *changed = other;
        }
    }
}

static void small_frames_are_best(void **state)
{
    uint64_t random = mk_seed() + 2, none, changed;
    uint32_t n_none = 0, n_changed = 0;
    (void)state;
    for (int run = 0; run < 60; run++) {
        struct stage *s = stage_of(8, 0);
        uint8_t before[8] = {0};
        scatter(s, 6 + mk_below(&random, 2), 160, 80, &random);
        for (int frame = 0; frame < 4; frame++, move(s)) {
            good(s);
            recount(s, before);
            best_of_all(s, before, &none, &changed);
            assert_true(s->stats.unassigned_weight == none);
            assert_true(s->stats.changes_weight == changed);
            assert_int_equal(s->stats.exact_groups, s->stats.groups);
            memcpy(before, s->pattern, sizeof before);
            n_none += none > 0;
            n_changed += none == 0 && changed > 0;
        }
        stage_free(s);
    }
    print_message("    of 240 frames %u with objects without, %u with changes "
                  "alone\n", n_none, n_changed);
    assert_true(n_none > 20 && n_changed > 10);
}

/* ---- from frame to frame --------------------------------------------- */

static void a_still_scene_changes_nothing(void **state)
{
    const float sizes[4] = {30, 60, 90, 20};
    const uint32_t counts[4] = {50, 50, 50, 400};
    uint64_t random = mk_seed() + 4;
    (void)state;
    for (int i = 0; i < 12; i++) {
        struct stage *s = stage_of(MAX_N, 0);
        s->frame.patterns = i % 3 == 2 ? HL_STIPPLE_4X4 : HL_STIPPLE_2X2;
        s->frame.margin = i % 3 == 1 ? 4.0f : 0.0f;
        scatter(s, counts[i % 4], sizes[i % 4], 1, &random);
        good(s);
        assert_int_equal(s->stats.changes, 0); /* there was no last frame    */
        /* The repairs of a large group may use up their steps a few times. */
        for (int frame = 0; frame < 4; frame++)
            good(s);
        for (int frame = 0; frame < 4; frame++) {
            good(s);
            assert_int_equal(s->stats.changes, 0);
        }
        stage_free(s);
    }
}

static uint8_t pattern_of(const struct stage *s, uint32_t id)
{
    for (uint32_t i = 0; i < s->frame.n_objects; i++)
        if (s->objects[i].id == id)
            return s->pattern[i];
    fail();
    return 0;
}

static void shuffle(struct stage *s, uint64_t *random)
{
    for (uint32_t i = s->frame.n_objects; i > 1; i--) {
        uint32_t k = mk_below(random, i);
        struct hl_stipple_object o = s->objects[k];
        s->objects[k] = s->objects[i - 1];
        s->objects[i - 1] = o;
    }
}

static void order_does_not_matter(void **state)
{
    uint64_t random = mk_seed() + 3;
    (void)state;
    for (int mode = HL_STIPPLE_BEST; mode <= HL_STIPPLE_BY_DEPTH_FREE; mode++) {
        struct stage *a = stage_of(MAX_N, 0), *b = stage_of(60, 1500);
        a->frame.mode = (enum hl_stipple_mode)mode;
        a->frame.margin = 3;
        scatter(a, 50, 60, 5, &random);
        for (uint32_t i = 0; i < 50; i++) {
            a->objects[i].weight = 1 + i % 3; /* many are equal              */
            a->objects[i].depth = (float)(i % 5);
        }
        for (int frame = 0; frame < 10; frame++, move(a)) {
            memcpy(b->objects, a->objects, sizeof a->objects);
            b->frame = a->frame;
            b->frame.objects = b->objects;
            shuffle(b, &random);
            good(a);
            good(b);
            assert_memory_equal(&a->stats, &b->stats, sizeof a->stats);
            for (uint32_t i = 0; i < 50; i++)
                assert_int_equal(a->pattern[i],
                                 pattern_of(b, a->objects[i].id));
        }
        stage_free(a);
        stage_free(b);
    }
}

static void objects_come_and_go(void **state)
{
    struct stage *s = stage_of(8, 0);
    uint8_t first;
    (void)state;
    add(s, 5, 0, 0, 10, 10);
    add(s, 9, 5, 0, 10, 10);
    good(s);
    assert_int_not_equal(s->pattern[0], s->pattern[1]);
    first = s->pattern[0];
    add(s, 7, 8, 0, 30, 30);     /* heavier, and it does not drive them out  */
    good(s);
    assert_int_equal(s->stats.changes, 0);
    assert_int_equal(s->stats.unassigned, 0);
    assert_int_equal(s->pattern[0], first);
    s->frame.n_objects = 0;
    good(s);
    assert_int_equal(s->stats.changes, 0);
    /* All forgotten: nothing is a change. */
    add(s, 7, 8, 0, 30, 30);
    add(s, 5, 9, 0, 10, 10);
    good(s);
    assert_int_equal(s->stats.changes, 0);
    hl_stipple_forget(s->stipple);
    s->frame.mode = HL_STIPPLE_USER;
    s->objects[0].wanted = 3;
    good(s);
    assert_int_equal(s->stats.changes, 0);
    s->objects[0].wanted = 2;
    good(s);
    assert_int_equal(s->stats.changes, 1);
    assert_int_equal(s->stats.changes_weight, 900);
    hl_stipple_forget(NULL);
    stage_free(s);
}

/* Two that had one pattern apart meet: the lighter one changes. With a margin
 * it does so before. */
static void meeting_objects_change_once(void **state)
{
    (void)state;
    for (int margin = 0; margin <= 4; margin += 4) {
        struct stage *s = stage_of(8, 0);
        s->frame.margin = (float)margin;
        s->frame.mode = HL_STIPPLE_USER;
        add(s, 1, 0, 0, 10, 10)->wanted = 2;
        add(s, 2, 20, 0, 20, 10)->wanted = 2;
        good(s);
        s->frame.mode = HL_STIPPLE_BEST;
        for (float gap = 9.5f; gap > -5; gap -= 1) {
            bool now = gap > (float)margin - 1 && gap < (float)margin;
            s->objects[1].x0 = 10 + gap;
            s->objects[1].x1 = 30 + gap;
            good(s);
            assert_int_equal(s->stats.changes, now);
            assert_int_equal(s->stats.pairs, gap < 0);
            assert_int_equal(s->stats.near_pairs, gap < (float)margin);
            assert_int_equal(s->stats.groups, gap < (float)margin);
            assert_int_equal(s->pattern[1], 2);
        }
        stage_free(s);
    }
}

/* Four in a row that touch by the margin alone need three patterns too many
 * only by the margin: then it does not count. */
static void a_margin_costs_no_pattern(void **state)
{
    struct stage *s = stage_of(8, 0);
    (void)state;
    for (uint32_t i = 0; i < 4; i++)
        add(s, i, 12 * (float)i, 0, 10, 10);
    s->frame.margin = 50;
    s->frame.max_steps = 1;      /* what is left alone needs none            */
    good(s);
    assert_int_equal(s->stats.pairs, 0);
    assert_int_equal(s->stats.near_pairs, 6);
    assert_int_equal(s->stats.unassigned, 0);
    assert_int_equal(s->stats.groups, 0);
    s->frame.max_steps = 0;
    s->objects[3].x0 = 23;       /* over 2, and near all                     */
    good(s);
    assert_int_equal(s->stats.unassigned, 0);
    assert_int_equal(s->stats.groups, 1);
    assert_int_equal(s->stats.largest_group, 2);
    assert_int_equal(s->stats.exact_groups, 1);
    stage_free(s);
}

/* Those that meet later then differ already as often as can be. */
static void patterns_are_spread(void **state)
{
    struct stage *s = stage_of(30, 0);
    uint32_t n[4] = {0, 0, 0, 0};
    (void)state;
    for (uint32_t i = 0; i < 30; i++)
        add(s, i, 12 * (float)i, 0, 10, 10);
    good(s);
    for (uint32_t i = 0; i < 30; i++)
        n[s->pattern[i] & 3]++;
    for (uint32_t c = 1; c <= 3; c++)
        assert_int_equal(n[c], 10);
    stage_free(s);
}

/* x1 and y1 are not touched any more. */
static void touching_is_not_overlapping(void **state)
{
    struct stage *s = stage_of(8, 0);
    (void)state;
    for (uint32_t turn = 0; turn < 4; turn++) { /* ids in any order          */
        s->frame.n_objects = 0;
        for (uint32_t i = 0; i < 4; i++)
            add(s, i ^ turn, 10 * (float)(i & 1) - 10,
                10 * (float)(i >> 1) - 10, 10, 10);
        good(s);
        assert_int_equal(s->stats.near_pairs, 0);
        s->objects[3].x0 -= 0.001f;
        s->objects[3].y0 -= 0.001f;
        good(s);
        assert_int_equal(s->stats.pairs, 3);
    }
    stage_free(s);
}

static void pile(struct stage *s, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++)
        add(s, 10 + i, 0, 0, 10, 10)->weight = 100;
}

static void hold_keeps_small_gains_away(void **state)
{
    struct stage *s = stage_of(8, 0);
    (void)state;
    pile(s, 4);
    s->frame.hold = 20;
    good(s);
    assert_int_equal(s->pattern[3], NONE); /* the highest id of equal ones   */
    s->objects[3].weight = 119;
    good(s);
    assert_int_equal(s->stats.changes, 0);
    s->objects[3].weight = 121;
    good(s);
    assert_int_equal(s->stats.changes, 2);
    assert_int_not_equal(s->pattern[3], NONE);
    assert_int_equal(s->stats.unassigned_weight, 100);
    s->objects[3].weight = 99;
    good(s);
    assert_int_equal(s->stats.changes, 0);
    s->frame.hold = 0;
    good(s);
    assert_int_equal(s->stats.changes, 2);
    assert_int_equal(s->stats.unassigned_weight, 99);
    stage_free(s);
}

/* ---- the other modes ------------------------------------------------- */

static void modes_by_depth(void **state)
{
    struct stage *s = stage_of(8, 0);
    const float depth[5] = {3, 1, -1, 2, -1};
    const uint8_t dealt[5] = {2, 3, 1, 1, 2};
    (void)state;
    /* 2 and 4 are equally near: by id. Weights are another order. */
    for (uint32_t i = 0; i < 5; i++)
        add(s, i, 20 * (float)i, 0, 10, 10 + (float)i)->depth = depth[i];
    s->frame.mode = HL_STIPPLE_BY_DEPTH;
    good(s);
    assert_memory_equal(s->pattern, dealt, 5);
    s->objects[2].depth = 0.0f;
    s->objects[4].depth = -0.0f; /* also equal                               */
    good(s);
    assert_memory_equal(s->pattern, dealt, 5);
    assert_int_equal(s->stats.changes, 0);
    s->frame.mode = HL_STIPPLE_BY_DEPTH_FREE;
    good(s);
    for (uint32_t i = 0; i < 5; i++)
        assert_int_equal(s->pattern[i], 1);
    s->frame.n_objects = 0;
    pile(s, 5);
    for (uint32_t i = 0; i < 5; i++)
        s->objects[i].depth = depth[i];
    good(s);
    assert_int_equal(s->pattern[2], 1);
    assert_int_equal(s->pattern[4], 2);
    assert_int_equal(s->pattern[1], 3);
    assert_int_equal(s->pattern[3], NONE);
    assert_int_equal(s->pattern[0], NONE);
    assert_int_equal(s->stats.conflicts, 0);
    stage_free(s);
}

static void users_get_what_they_want(void **state)
{
    struct stage *s = stage_of(8, 0);
    (void)state;
    pile(s, 4);
    s->frame.mode = HL_STIPPLE_USER;
    s->objects[0].wanted = s->objects[3].wanted = 3;
    s->objects[1].wanted = 1;
    good(s);
    assert_int_equal(s->pattern[0], 3);
    assert_int_equal(s->pattern[1], 1);
    assert_int_equal(s->pattern[2], NONE);
    assert_int_equal(s->pattern[3], 3);
    assert_int_equal(s->stats.conflicts, 1);
    assert_int_equal(s->stats.unassigned_weight, 100);
    stage_free(s);
}

/* A pattern that there is no more is a change, not a pattern. */
static void patterns_may_become_fewer(void **state)
{
    struct stage *s = stage_of(20, 0);
    (void)state;
    pile(s, 15);
    s->frame.patterns = HL_STIPPLE_4X4;
    good(s);
    assert_int_equal(s->stats.unassigned, 0);
    s->frame.patterns = HL_STIPPLE_2X2;
    good(s);
    assert_int_equal(s->stats.unassigned, 12);
    assert_int_equal(s->stats.changes, 12);
    s->frame.patterns = 1;
    good(s);
    assert_int_equal(s->stats.unassigned, 14);
    stage_free(s);
}

/* ---- what is refused ------------------------------------------------- */

/* Nothing is written, and the last frame stays. */
static void refused(struct stage *s, enum hl_result result)
{
    uint8_t pattern[MAX_N];
    memcpy(pattern, s->pattern, sizeof pattern);
    assert_int_equal(assign(s), result);
    assert_memory_equal(pattern, s->pattern, sizeof pattern);
}

#define BAD(s, field, value, result)      \
    do {                                  \
        struct stage keep_ = *(s);        \
        (s)->field = (value);             \
        refused(s, result);               \
        *(s) = keep_;                     \
        good(s);                          \
        assert_int_equal((s)->stats.changes, 0); \
    } while (0)

static void bad_objects_are_refused(void **state)
{
    struct stage *s = stage_of(4, 0);
    struct hl_stipple_outline o = {3, {0, 1, 0}, {0, 0, 1}};
    (void)state;
    add(s, 1, 0, 0, 10, 10);
    add(s, 2, 5, 0, 10, 10);
    good(s);
    BAD(s, objects[1].x0, NAN, HL_ERR_INVALID);
    BAD(s, objects[1].y0, NAN, HL_ERR_INVALID);
    BAD(s, objects[1].x1, NAN, HL_ERR_INVALID);
    BAD(s, objects[1].y1, NAN, HL_ERR_INVALID);
    BAD(s, objects[1].id, 1, HL_ERR_INVALID);
    o.n_corners = 2;
    BAD(s, objects[1].outline, &o, HL_ERR_INVALID);
    o.n_corners = HL_STIPPLE_CORNERS + 1;
    BAD(s, objects[1].outline, &o, HL_ERR_INVALID);
    o.n_corners = 3;
    o.x[2] = NAN;
    BAD(s, objects[1].outline, &o, HL_ERR_INVALID);
    o.x[2] = 0;
    o.y[1] = INFINITY;
    BAD(s, objects[1].outline, &o, HL_ERR_INVALID);
    s->objects[1].depth = NAN;   /* BEST and USER do not look at it          */
    s->objects[1].wanted = 4;
    good(s);
    BAD(s, frame.mode, HL_STIPPLE_BY_DEPTH, HL_ERR_INVALID);
    BAD(s, frame.mode, HL_STIPPLE_BY_DEPTH_FREE, HL_ERR_INVALID);
    BAD(s, frame.mode, HL_STIPPLE_USER, HL_ERR_INVALID);
    stage_free(s);
}

static void bad_frames_are_refused(void **state)
{
    struct stage *s = stage_of(4, 2);
    (void)state;
    add(s, 1, 0, 0, 10, 10);
    add(s, 2, 5, 0, 10, 10);
    good(s);
    BAD(s, frame.patterns, 0, HL_ERR_INVALID);
    BAD(s, frame.patterns, 16, HL_ERR_INVALID);
    BAD(s, frame.mode, (enum hl_stipple_mode)4, HL_ERR_INVALID);
    BAD(s, frame.margin, NAN, HL_ERR_INVALID);
    BAD(s, frame.margin, INFINITY, HL_ERR_INVALID);
    BAD(s, frame.margin, -1, HL_ERR_INVALID);
    BAD(s, frame.hold, 101, HL_ERR_INVALID);
    BAD(s, frame.objects, NULL, HL_ERR_INVALID);
    BAD(s, frame.n_objects, 5, HL_ERR_LIMIT);
    BAD(s, frame.n_objects, UINT32_MAX, HL_ERR_LIMIT);
    assert_int_equal(hl_stipple_assign(NULL, &s->frame, s->pattern, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_stipple_assign(s->stipple, NULL, s->pattern, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_stipple_assign(s->stipple, &s->frame, NULL, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_stipple_assign(s->stipple, &s->frame, s->pattern,
                                       NULL), HL_OK);
    add(s, 3, 6, 0, 10, 10);     /* three pairs; two fit                     */
    refused(s, HL_ERR_LIMIT);
    assert_int_equal(s->stats.near_pairs, 3);
    s->frame.n_objects = 2;
    good(s);
    assert_int_equal(s->stats.changes, 0);
    s->frame.n_objects = 0;
    s->frame.objects = NULL;
    assert_int_equal(hl_stipple_assign(s->stipple, &s->frame, NULL, &s->stats),
                     HL_OK);
    assert_int_equal(s->stats.groups, 0);
    stage_free(s);
}

static void strange_bounds_are_allowed(void **state)
{
    struct stage *s = stage_of(16, 0);
    (void)state;
    s->frame.margin = 3;
    add(s, 0, 5, 5, 0, 10);              /* nothing wide: meets nothing      */
    add(s, 1, 5, 5, 10, -1);
    add(s, 2, 5, 5, 10, 10)->weight = 0;
    add(s, 3, 5, 5, 10, 10)->weight = UINT32_MAX;
    add(s, 4, 0, 0, 0, 0);
    s->objects[4].x0 = s->objects[4].y0 = -INFINITY;
    s->objects[4].x1 = s->objects[4].y1 = INFINITY;
    s->objects[4].weight = UINT32_MAX;
    add(s, UINT32_MAX, -3e38f, 0, 2e38f, 1);
    good(s);
    assert_int_equal(s->stats.pairs, 4); /* 2 3, 2 4, 3 4, 5 4               */
    assert_int_equal(s->stats.unassigned, 0);
    assert_int_equal(s->stats.groups, 1);
    s->frame.patterns = 1;
    good(s);                     /* 3 and 5 keep it; 4 counts 2^24, 2 one    */
    assert_int_equal(s->stats.unassigned_weight, 1 + (1u << 24));
    stage_free(s);
}

static void memory_is_what_it_says(void **state)
{
    uint64_t memory[8];
    (void)state;
    assert_int_equal(hl_stipple_bytes(0, 0), 0);
    assert_int_equal(hl_stipple_bytes(HL_STIPPLE_MAX_OBJECTS + 1, 0), 0);
    assert_int_equal(hl_stipple_bytes(UINT32_MAX, 0), 0);
    assert_int_equal(hl_stipple_bytes(1, HL_STIPPLE_MAX_PAIRS + 1), 0);
    assert_true(hl_stipple_bytes(HL_STIPPLE_MAX_OBJECTS,
                                 HL_STIPPLE_MAX_PAIRS) > 0);
    assert_true(hl_stipple_bytes(1, 0) > 0);
    assert_true(hl_stipple_bytes(50, 0) < 64 * 1024);
    assert_null(hl_stipple_create(NULL, 50, 0));
    assert_null(hl_stipple_create(memory, 0, 0));
    assert_null(hl_stipple_create(memory, 1, UINT32_MAX));
    print_message("    50 objects: %u bytes, 1,000: %u\n",
                  (unsigned)hl_stipple_bytes(50, 0),
                  (unsigned)hl_stipple_bytes(1000, 0));
}

/* Hundreds of groups at once, more steps wanted than there are. */
static void many_objects_stay_within_their_steps(void **state)
{
    uint64_t random = mk_seed() + 5;
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct stage *s = stage_of(MAX_N, 64000);
        uint8_t before[MAX_N] = {0};
        s->frame.max_steps = i == 2 ? 100 : 0;
        scatter(s, MAX_N, i ? 20.0f : 8.0f, 2, &random);
        for (int frame = 0; frame < 4; frame++, move(s)) {
            good(s);
            recount(s, before);
            assert_int_equal(s->stats.conflicts, 0);
            assert_true(s->stats.steps <= (i == 2 ? 100u : HL_STIPPLE_STEPS));
            memcpy(before, s->pattern, sizeof before);
        }
        stage_free(s);
    }
}

#define TEST(name) cmocka_unit_test(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(moving_scenes_lose_no_light),
        TEST(small_frames_are_best),
        TEST(a_still_scene_changes_nothing),
        TEST(order_does_not_matter),
        TEST(objects_come_and_go),
        TEST(meeting_objects_change_once),
        TEST(a_margin_costs_no_pattern),
        TEST(patterns_are_spread),
        TEST(touching_is_not_overlapping),
        TEST(hold_keeps_small_gains_away),
        TEST(modes_by_depth),
        TEST(users_get_what_they_want),
        TEST(patterns_may_become_fewer),
        TEST(bad_objects_are_refused),
        TEST(bad_frames_are_refused),
        TEST(strange_bounds_are_allowed),
        TEST(memory_is_what_it_says),
        TEST(many_objects_stay_within_their_steps),
    };
    return cmocka_run_group_tests_name("stipple frames", tests, NULL, NULL);
}
