/* SPDX-License-Identifier: Zlib */
/* Patterns of moving translucent objects by each of the scheduler's modes, as
 * a table in Markdown: not a test, a program to run by hand.
 *   bench_stipple [SEEDS]
 * 50 rectangles of random sizes bounce over an L-buffer of 800 x 450 texels
 * for 120 frames, once a seed. Counts of a frame, means: objects that share a
 * pattern with one they overlap (pairs; the farther one's light is lost),
 * objects without a pattern (lit forward) and their share of all texels, which
 * is what BEST minimises, objects with another pattern than in the last
 * frame. Then each group of overlapping objects of mode BEST
 * beside a plain search through all assignments. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "core/stipple.h"
#include "tests/mesh_kit.h"

enum { N = 50, FRAMES = 120, WIDTH = 800, HEIGHT = 450, SEEDS = 10,
       /* Of the plain search, a group: then it gives up. */
       MOST_STEPS = 2000000 };

struct stage {
    struct hl_stipple *stipple;
    struct hl_stipple_object object[N];
    float vx[N], vy[N], vz[N];
    uint8_t pattern[N];
    uint32_t patterns;
};

struct sums { double pairs, conflicts, without, weight, changes; };

/* Groups of mode BEST, by size up to HL_STIPPLE_EXACT and above. */
struct checks {
    uint64_t groups, fits, missed, must;   /* fits: all can have a pattern    */
    uint64_t conflicts;                    /* counted here; of all groups     */
    uint64_t large, large_full, large_fits, unknown;
};

/* ---- scenes -------------------------------------------------------------- */

/* USER: dealt once, at random. */
static void scatter(struct stage *s, float size, uint64_t *random)
{
    for (uint32_t i = 0; i < N; i++) {
        struct hl_stipple_object *o = &s->object[i];
        float w = size * (0.5f + mk_unit(random));
        float h = size * (0.5f + mk_unit(random));
        memset(o, 0, sizeof *o);
        o->id = 1 + i;
        o->x0 = mk_unit(random) * (WIDTH - w);
        o->y0 = mk_unit(random) * (HEIGHT - h);
        o->x1 = o->x0 + w;
        o->y1 = o->y0 + h;
        o->depth = 1 + 30 * mk_unit(random);
        o->weight = (uint32_t)(w * h);
        o->wanted = 1 + mk_below(random, s->patterns);
        s->vx[i] = (mk_unit(random) - 0.5f) * 6;
        s->vy[i] = (mk_unit(random) - 0.5f) * 6;
        s->vz[i] = (mk_unit(random) - 0.5f) * 0.3f;
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
    for (uint32_t i = 0; i < N; i++) {
        struct hl_stipple_object *o = &s->object[i];
        float far = o->depth;
        bounce(&o->x0, &o->x1, &s->vx[i], WIDTH);
        bounce(&o->y0, &o->y1, &s->vy[i], HEIGHT);
        bounce(&o->depth, &far, &s->vz[i], 31);
    }
}

/* ---- a plain search ------------------------------------------------------ */

struct search {
    const struct stage *stage;
    uint32_t member[N], n, color[N];
    uint64_t steps;
};

static bool overlap(const struct hl_stipple_object *a,
                    const struct hl_stipple_object *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

static bool meet(const struct search *s, uint32_t a, uint32_t b)
{
    return overlap(&s->stage->object[s->member[a]],
                   &s->stage->object[s->member[b]]);
}

/* Colours member `at` and all after it; a colour that nobody has yet is tried
 * once, as all such are alike. 1: done, 0: there is no way, -1: gave up. */
static int color_from(struct search *s, uint32_t at, uint32_t used)
{
    if (at == s->n)
        return 1;
    for (uint32_t c = 1; c <= used + 1 && c <= s->stage->patterns; c++) {
        bool free = true;
        if (s->steps++ > MOST_STEPS)
            return -1;
        for (uint32_t i = 0; i < at && free; i++)
            free = s->color[i] != c || !meet(s, i, at);
        if (!free)
            continue;
        s->color[at] = c;
        int done = color_from(s, at + 1, c > used ? c : used);
        if (done)
            return done;
    }
    return 0;
}

/* The objects joined to `first` by overlaps, each as near to those before it
 * as breadth first has them. */
static void gather(struct search *s, uint32_t first, bool *seen)
{
    s->n = 0;
    s->member[s->n++] = first;
    seen[first] = true;
    for (uint32_t i = 0; i < s->n; i++)
        for (uint32_t k = 0; k < N; k++)
            if (!seen[k] && overlap(&s->stage->object[s->member[i]],
                                    &s->stage->object[k])) {
                seen[k] = true;
                s->member[s->n++] = k;
            }
}

static uint32_t conflicts_of(const struct search *s)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n; i++)
        for (uint32_t k = 0; k < i; k++) {
            uint8_t p = s->stage->pattern[s->member[i]];
            n += p != HL_STIPPLE_NONE && meet(s, i, k) &&
                 p == s->stage->pattern[s->member[k]];
        }
    return n;
}

static void check_group(struct search *s, struct checks *c)
{
    bool full = true;
    c->conflicts += conflicts_of(s);
    for (uint32_t i = 0; i < s->n; i++)
        full = full && s->stage->pattern[s->member[i]] != HL_STIPPLE_NONE;
    s->steps = 0;
    int can = full ? 1 : color_from(s, 0, 0);
    if (s->n <= HL_STIPPLE_EXACT) {
        c->groups++;
        c->fits += can == 1;
        c->missed += can == 1 && !full;
        c->must += can == 0;
        c->unknown += can < 0;
        return;
    }
    c->large++;
    c->large_full += full;
    c->large_fits += can == 1 && !full;
    c->unknown += can < 0;
}

static void check_groups(const struct stage *stage, struct checks *c)
{
    bool seen[N] = { false };
    struct search s;
    memset(&s, 0, sizeof s);
    s.stage = stage;
    for (uint32_t i = 0; i < N; i++)
        if (!seen[i]) {
            gather(&s, i, seen);
            if (s.n > 1)
                check_group(&s, c);
        }
}

/* ---- runs ---------------------------------------------------------------- */

static double total_of(const struct stage *s)
{
    double sum = 0;
    for (uint32_t i = 0; i < N; i++)
        sum += s->object[i].weight;
    return sum;
}

static void play(struct stage *s, enum hl_stipple_mode mode, uint32_t hold,
                 struct sums *sum, struct checks *c)
{
    struct hl_stipple_frame f;
    memset(&f, 0, sizeof f);
    f.objects = s->object;
    f.n_objects = N;
    f.mode = mode;
    f.patterns = s->patterns;
    f.hold = hold;
    hl_stipple_forget(s->stipple);
    for (int frame = 0; frame < FRAMES; frame++, move(s)) {
        struct hl_stipple_stats t;
        if (hl_stipple_assign(s->stipple, &f, s->pattern, &t) != HL_OK)
            exit(1);
        sum->pairs += t.pairs;
        sum->conflicts += t.conflicts;
        sum->without += t.unassigned;
        sum->weight += (double)t.unassigned_weight / total_of(s);
        sum->changes += t.changes;
        if (c)
            check_groups(s, c);
    }
}

static void row(struct stage *s, float size, const char *name,
                enum hl_stipple_mode mode, uint32_t hold, uint32_t seeds,
                struct checks *c)
{
    struct sums sum = { 0, 0, 0, 0, 0 };
    double n = (double)seeds * FRAMES;
    for (uint32_t i = 0; i < seeds; i++) {
        uint64_t random = 1 + i;
        scatter(s, size, &random);
        play(s, mode, hold, &sum, c);
    }
    printf("| %s | %g | %.1f | %s | %.2f | %.2f | %.1f %% | %.2f |\n",
           s->patterns == HL_STIPPLE_2X2 ? "2 x 2" : "4 x 4", (double)size,
           sum.pairs / n, name, sum.conflicts / n, sum.without / n,
           100 * sum.weight / n, sum.changes / n);
}

static void rows(struct stage *s, float size, uint32_t seeds,
                 struct checks *c)
{
    row(s, size, "USER, dealt at random", HL_STIPPLE_USER, 0, seeds, NULL);
    row(s, size, "BY_DEPTH", HL_STIPPLE_BY_DEPTH, 0, seeds, NULL);
    row(s, size, "BY_DEPTH_FREE", HL_STIPPLE_BY_DEPTH_FREE, 0, seeds, NULL);
    row(s, size, "BEST", HL_STIPPLE_BEST, 0, seeds, c);
    row(s, size, "BEST, hold 50 %", HL_STIPPLE_BEST, 50, seeds, c);
}

static void show(const struct checks *c)
{
    printf("\nGroups of 2 to %d overlapping objects, BEST: %llu; all can have a"
           " pattern in %llu, and had one in all but %llu of these; in %llu"
           " they cannot. Conflicts in all groups: %llu.\n",
           HL_STIPPLE_EXACT, (unsigned long long)c->groups,
           (unsigned long long)c->fits, (unsigned long long)c->missed,
           (unsigned long long)c->must, (unsigned long long)c->conflicts);
    printf("Larger groups: %llu; all had a pattern in %llu, could have had one"
           " in %llu more. Searches given up: %llu.\n",
           (unsigned long long)c->large, (unsigned long long)c->large_full,
           (unsigned long long)c->large_fits, (unsigned long long)c->unknown);
}

int main(int argc, char **argv)
{
    static const float sizes[2][4] = { { 30, 50, 70, 100 },
                                       { 100, 150, 200, 300 } };
    static struct stage s;
    static struct checks checks;
    uint32_t seeds = argc > 1 ? (uint32_t)strtoul(argv[1], NULL, 10) : SEEDS;
    void *memory = malloc(hl_stipple_bytes(N, N * (N - 1) / 2));
    if (!memory || seeds == 0)
        return 1;
    s.stipple = hl_stipple_create(memory, N, N * (N - 1) / 2);
    printf("| pattern | size, texels | overlaps | mode | conflicts | without |"
           " texels without | changes |\n"
           "|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 4; i++) {
            s.patterns = k ? HL_STIPPLE_4X4 : HL_STIPPLE_2X2;
            rows(&s, sizes[k][i], seeds, &checks);
        }
    show(&checks);
    free(memory);
    return checks.missed != 0 || checks.conflicts != 0;
}
