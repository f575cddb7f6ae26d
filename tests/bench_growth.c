/* SPDX-License-Identifier: Zlib */
/* How cost grows with n objects and l lights (Kircher, Lawrance 2009, section
 * 6: "O(n l)" of forward lighting, "O(n + l)" of inferred): not a test, a
 * program to run by hand.
 *   bench_growth [BACKEND]
 * Boxes that fill the picture, and lights that reach all of them or a few.
 * For each pipeline: draws and counted cost (the same on every run) and times
 * (medians of ROUNDS interleaved frames, quartiles), for n = l = 8..256; the
 * exponent e of cost ~ k^e; and the shares of a + b n + c l + d n l at
 * n = l = 256, fitted to all pairs of sizes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/count.h"
#include "platforms/cli/commands.h"
#include "platforms/cli/render.h"
#include "platforms/stability/rig.h"

enum { SIZES = 6, LEAST = 8, MOST = LEAST << (SIZES - 1), PIPES = 3,
       MOST_ROUNDS = 31, WIDTH = 160, HEIGHT = 90 };
enum figure { DRAWS, COUNTED, TIME, FIGURES };

static const enum hl_pipeline pipes[PIPES] = {
    HL_PIPELINE_FORWARD_MULTIPASS, HL_PIPELINE_FORWARD, HL_PIPELINE_INFERRED
};
static const char *const pipe_name[PIPES] = {
    "multi-pass forward", "forward, 8 lights a draw", "inferred"
};

struct spread { double median, low, high; };

/* By size of n, of l. */
struct table { struct spread at[FIGURES][PIPES][SIZES][SIZES]; };

static uint32_t size_of(int i) { return (uint32_t)LEAST << i; }

/* ---- scenes ------------------------------------------------------------- */

/* Cells of 16:9 in a picture of 16:9. */
static uint32_t columns(uint32_t n) { return (uint32_t)ceil(sqrt(n)); }

static void add_objects(struct hls_rig *rig, uint32_t n)
{
    uint32_t g = columns(n);
    hlh_add_box(&rig->b, hlh_v3(0, 0, 0), hlh_v3(1, 1, 1), 1, false);
    uint32_t mesh = hlh_build_mesh(&rig->b, "box", 0);
    for (uint32_t i = 0; i < n; i++)
        hlh_build_object(&rig->b, mesh,
                         hlh_v3((i % g + 0.5) * 3.2 / g - 1.6,
                                (i / g + 0.5) * 1.8 / g - 0.9, 0),
                         hlh_v3(1.4 / g, 0.8 / g, 0.5 / g), 0);
}

static bool scene_of(struct hlh_scene *out, uint32_t n, bool local)
{
    struct hls_rig rig;
    hls_rig_begin(&rig, 1.8, 60);
    add_objects(&rig, n);
    for (int i = 0; i < MOST; i++) {
        double x = hlh_random(&rig.b, -1.5, 1.5);
        double y = hlh_random(&rig.b, -0.8, 0.8);
        /* A few cells, whatever their size. */
        hlh_build_light(&rig.b, hlh_v3(x, y, local ? 1.0 / columns(n) : 1),
                        local ? 2.5 / columns(n) : 6,
                        hlh_v3(0.01, 0.01, 0.01));
    }
    return hls_rig_take(out, &rig);
}

static struct hlc_options options(const char *backend)
{
    static struct hlc_options o;
    o.backend = backend;
    o.width = WIDTH;
    o.height = HEIGHT;
    o.samples = 1;
    return o;
}

static bool stage_of(struct hlc_stage *stage, uint32_t n, bool local,
                     const char *backend)
{
    struct hlh_scene scene;
    struct hlc_options o = options(backend);
    return scene_of(&scene, n, local) &&
           hlc_stage_open(stage, &scene, &o) == HLC_DONE;
}

/* With the first l lights. */
static bool shot_of(struct hlc_shot *shot, struct hlc_stage *stage, int pipe,
                    uint32_t l, const char *backend)
{
    struct hlc_options o = options(backend);
    char line[HLC_PLAN_LINE];
    uint32_t all = stage->world.n_lights;
    o.pipeline = pipes[pipe];
    stage->world.n_lights = l;
    int code = hlc_shot_open(shot, stage, &o, NULL, NULL, line);
    stage->world.n_lights = all;
    if (code)
        fprintf(stderr, "%s\n", line);
    return code == HLC_DONE;
}

/* ---- figures ------------------------------------------------------------ */

static bool count(struct table *t, struct hlc_stage *stage, int i, int k)
{
    for (int p = 0; p < PIPES; p++) {
        struct hlc_shot shot;
        struct hlt_counts c;
        if (!shot_of(&shot, stage, p, size_of(k), "packemu"))
            return false;
        bool ok = hlt_count(&c, &shot) == HL_OK;
        double ms = hlt_weigh(&c, &shot.plan, &stage->machine.caps) * 1e-6;
        t->at[DRAWS][p][i][k] = (struct spread){ c.draws, c.draws, c.draws };
        t->at[COUNTED][p][i][k] = (struct spread){ ms, ms, ms };
        hlc_shot_close(&shot);
        if (!ok)
            return false;
    }
    return true;
}

/* Rounds of one frame of each, in turn; the first is not counted. */
static bool time_all(struct table *t, struct hlc_stage *stage, int i, int k,
                     const char *backend, int rounds)
{
    struct hlc_shot shot[PIPES];
    double ms[PIPES][MOST_ROUNDS];
    int made = 0;
    while (made < PIPES &&
           shot_of(&shot[made], stage, made, size_of(k), backend))
        made++;
    bool ok = made == PIPES;
    for (int r = -1; ok && r < rounds; r++)
        for (int p = 0; ok && p < PIPES; p++)
            ok = hlc_shot_draw(&shot[p], &ms[p][r < 0 ? 0 : r]) == HL_OK;
    for (int p = 0; p < made; p++) {
        struct hlc_quartiles q = hlc_quartiles_of(ms[p], (uint32_t)rounds);
        t->at[TIME][p][i][k] = (struct spread){ q.median, q.low, q.high };
        hlc_shot_close(&shot[p]);
    }
    return ok;
}

static bool fill(struct table *t, bool local, const char *backend, int rounds)
{
    bool ok = true;
    for (int i = 0; ok && i < SIZES; i++) {
        struct hlc_stage stage;
        ok = stage_of(&stage, size_of(i), local, "packemu");
        for (int k = 0; ok && k < SIZES; k++)
            ok = count(t, &stage, i, k);
        if (ok)
            hlc_stage_close(&stage);
        ok = ok && stage_of(&stage, size_of(i), local, backend);
        for (int k = 0; ok && k < SIZES; k++)
            ok = time_all(t, &stage, i, k, backend, rounds);
        if (ok)
            hlc_stage_close(&stage);
    }
    return ok;
}

/* ---- fits --------------------------------------------------------------- */

/* Slope of log y over log x, by least squares, of sizes from..SIZES - 1. */
static double exponent(const struct spread at[SIZES][SIZES], int from)
{
    double n = SIZES - from, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = from; i < SIZES; i++) {
        double x = log(size_of(i)), y = log(at[i][i].median);
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* Gauss with pivots; m is symmetric and regular: more points than terms. */
static void solve(double m[4][5])
{
    for (int c = 0; c < 4; c++) {
        int best = c;
        for (int r = c + 1; r < 4; r++)
            if (fabs(m[r][c]) > fabs(m[best][c]))
                best = r;
        for (int k = 0; k < 5; k++) {
            double x = m[c][k];
            m[c][k] = m[best][k];
            m[best][k] = x;
        }
        for (int r = 0; r < 4; r++) {
            double f = r == c ? 0 : m[r][c] / m[c][c];
            for (int k = 0; k < 5; k++)
                m[r][k] -= f * m[c][k];
        }
    }
    for (int c = 0; c < 4; c++)
        m[c][4] /= m[c][c];
}

/* Terms a, b n, c l, d n l at the largest point, by least squares of relative
 * errors: small points count as large ones do. *off: the worst of these. */
static void terms(double out[4], double *off,
                  const struct spread at[SIZES][SIZES])
{
    double m[4][5] = { { 0 } };
    *off = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < SIZES; i++)
            for (int k = 0; k < SIZES; k++) {
                double n = (double)size_of(i) / MOST;
                double l = (double)size_of(k) / MOST, y = at[i][k].median;
                double x[5] = { 1, n, l, n * l, y }, fit = 0;
                for (int r = 0; r < 4; r++) {
                    fit += out[r] * x[r];
                    for (int c = 0; c < 5 && pass == 0; c++)
                        m[r][c] += x[r] * x[c] / (y * y);
                }
                if (pass && fabs(fit / y - 1) > *off)
                    *off = fabs(fit / y - 1);
            }
        if (pass == 0)
            solve(m);
        for (int r = 0; r < 4; r++)
            out[r] = m[r][4];
    }
}

/* ---- telling ------------------------------------------------------------ */

/* Where lights reach few objects their area goes with 1 / n, which is none of
 * the terms. */
static void shares(const struct spread at[SIZES][SIZES], bool local)
{
    double x[4] = { 0, 0, 0, 0 }, off;
    if (local) {
        printf(" | |\n");
        return;
    }
    terms(x, &off, at);
    for (int i = 0; i < 4; i++)
        printf("%s%.0f", i ? " / " : " ",
               floor(100 * x[i] / (x[0] + x[1] + x[2] + x[3]) + 0.5) + 0.0);
    printf(" | %.0f |\n", 100 * off);
}

static void row(const struct table *t, bool local, int p, enum figure figure,
                const char *name)
{
    const char *reach = local ? "a few objects" : "all objects";
    const struct spread (*at)[SIZES] = t->at[figure][p];
    printf("| %s | %s | %s |", reach, pipe_name[p], name);
    for (int i = 0; i < SIZES; i++) {
        const struct spread *s = &at[i][i];
        if (figure == TIME)
            printf(" %.3g (%.3g..%.3g) |", s->median, s->low, s->high);
        else
            printf(" %.4g |", s->median);
    }
    printf(" %.2f | %.2f |", exponent(at, 0), exponent(at, SIZES - 2));
    shares(at, local);
}

static void tell(const struct table *t, bool local, const char *backend)
{
    char time[64];
    snprintf(time, sizeof time, "ms, %s", backend);
    const char *const name[FIGURES] = { "draws", "counted ms, packemu", time };
    for (int f = 0; f < FIGURES; f++)
        for (int p = 0; p < PIPES; p++)
            row(t, local, p, (enum figure)f, name[f]);
}

int main(int argc, char **argv)
{
    static struct table t;
    const char *backend = argc > 1 ? argv[1] : "vulkan";
    const char *asked = getenv("ROUNDS");
    int rounds = asked ? atoi(asked) : 5;
    rounds = rounds < 1 ? 1 : rounds > MOST_ROUNDS ? MOST_ROUNDS : rounds;
    printf("RES-5: cost of k objects and k lights, %d x %d; exponent e of "
           "k^e over all k and over the last two; shares of a / b n / c l / "
           "d n l at k = %d, %%; the fit's worst error, %%. Published: O(n l) "
           "forward, O(n + l) inferred.\n\n", WIDTH, HEIGHT, MOST);
    printf("| lights reach | pipeline | figure |");
    for (int i = 0; i < SIZES; i++)
        printf(" k = %u |", (unsigned)size_of(i));
    printf(" e | e at the end | shares | error |\n|---|---|---|");
    for (int i = 0; i < SIZES + 4; i++)
        printf("---|");
    printf("\n");
    for (int local = 0; local < 2; local++) {
        if (!fill(&t, local, backend, rounds))
            return 1;
        tell(&t, local, backend);
    }
    return 0;
}
