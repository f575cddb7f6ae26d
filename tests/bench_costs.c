/* SPDX-License-Identifier: Zlib */
/* Counted cost of the pipelines with few and many lights: not a test, a
 * program to run by hand.
 *   bench_costs [WxH [SCENE...]]
 * For each scene and number of lights, for lavapipe's costs and packemu's:
 * counted and predicted cost of each pipeline, which one is cheapest and
 * which one AUTO takes. ROUNDS=N adds wall times of N frames of each, in
 * turn: median, and quartiles in brackets. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/platforms.h"
#include "tests/cost_kit.h"

static const char *const short_names[HL_PIPELINE_COUNT] = {
    "auto", "forward", "multipass", "inferred"
};

static bool caps_of(struct hl_caps *out, const char *backend)
{
    char name[16];
    snprintf(name, sizeof name, "%s", backend);
    char *argv[] = { "halflight", "render", "fig8", "--backend", name, NULL };
    struct hlc_options o;
    struct hlc_machine m;
    if (hlc_options_parse(&o, 5, argv) || hlc_machine_open(&m, &o))
        return false;
    *out = *hl_device_caps(m.device);
    hlc_machine_close(&m);
    return true;
}

static void times(struct ct_scene *timed, uint32_t n, uint32_t rounds)
{
    struct ct_times t[HL_PIPELINE_COUNT];
    ct_lights(timed, n);
    if (rounds && timed->stage.machine.device && ct_time(t, timed, rounds))
        for (int p = 1; p < HL_PIPELINE_COUNT; p++)
            printf(" %.1f (%.1f..%.1f) |", t[p].median, t[p].low, t[p].high);
    printf("\n");
}

static void row(struct ct_scene *s, struct ct_scene *timed,
                const struct hl_caps *caps, uint32_t n, uint32_t rounds)
{
    struct ct_cost c[HL_PIPELINE_COUNT];
    bool has[HL_PIPELINE_COUNT];
    int best = 0;
    ct_lights(s, n);
    for (int p = 0; p < HL_PIPELINE_COUNT; p++) {
        has[p] = ct_count(&c[p], s, (enum hl_pipeline)p, caps);
        if (p && has[p] && (!best || c[p].ns < c[best].ns))
            best = p;
    }
    if (!best || !has[0])
        return;
    printf("| %s | %s | %u |", caps->backend, s->stage.scene.name, n);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        printf(" %.2f (%.2f) |", c[p].ns * 1e-6, c[p].predicted_ns * 1e-6);
    printf(" %s | %s | %.2f |", short_names[best],
           short_names[c[0].plan.pipeline], c[0].ns / c[best].ns);
    times(timed, n, rounds);
    if (getenv("HL_COUNTS"))
        for (int p = 1; p < HL_PIPELINE_COUNT; p++)
            printf("  %s: draws %u tris %llu geo %llu light %llu blend %llu "
                   "mat %llu fwd %llu lights %llu path %d\n", short_names[p],
                   c[p].of.draws, (unsigned long long)c[p].of.triangles,
                   (unsigned long long)c[p].of.geometry,
                   (unsigned long long)c[p].of.light,
                   (unsigned long long)c[p].of.light_blends,
                   (unsigned long long)c[p].of.material,
                   (unsigned long long)c[p].of.forward,
                   (unsigned long long)c[p].of.lights, (int)c[p].plan.light_path);
}

static void run_on(const char *scene, const char *backend, uint32_t w,
                   uint32_t h, uint32_t rounds)
{
    static const uint32_t lights[] = { 0, 1, 2, 4, 8, 16, 32, 64, 1u << 20 };
    struct ct_scene s, timed;
    struct hl_caps caps;
    memset(&timed, 0, sizeof timed);
    bool ok = caps_of(&caps, backend) && ct_open(&s, scene, "packemu", w, h);
    if (ok && rounds)
        ok = ct_open(&timed, scene, backend, w, h);
    for (size_t i = 0; ok && i < sizeof lights / sizeof *lights; i++) {
        if (i && lights[i - 1] >= s.all_lights)
            break;
        row(&s, &timed, &caps, lights[i] < s.all_lights ? lights[i]
                                                        : s.all_lights,
            rounds);
    }
    if (ok)
        ct_close(&s);
    if (ok && rounds)
        ct_close(&timed);
}

static void run(const char *scene, uint32_t w, uint32_t h)
{
    const char *rounds = getenv("ROUNDS");
    unsigned n = rounds ? (unsigned)atoi(rounds) : 0;
    n = n < CT_ROUNDS ? n : CT_ROUNDS;
    run_on(scene, "vulkan", w, h, n);
    run_on(scene, "packemu", w, h, n);
}

int main(int argc, char **argv)
{
    static const char *const all[] = { "fig8", "many", "fig9", "fig7", "lidr",
                                       "thin" };
    unsigned w = 320, h = 180;
    if (argc > 1 && sscanf(argv[1], "%ux%u", &w, &h) != 2)
        return 2;
    printf("Counted cost, ms (predicted), %u x %u\n\n"
           "| machine | scene | lights | forward | multipass | inferred | "
           "cheapest | auto | auto / cheapest | ms forward | multipass | "
           "inferred |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n", w, h);
    for (int i = 2; i < argc; i++)
        run(argv[i], w, h);
    for (size_t i = 0; argc < 3 && i < sizeof all / sizeof *all; i++)
        run(all[i], w, h);
    return 0;
}
