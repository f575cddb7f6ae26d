/* SPDX-License-Identifier: Zlib */
/* Whole pictures of every built-in scene against the reference renderer,
 * which shares no code with core or the shaders; and the stored region ids
 * against the true ones. Failing pictures are left in build/fail. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "tests/image_kit.h"

enum { W = 320, H = 180, FAR_OFF = 65536 };

/* A picture judged by share of pixels within a code of 8-bit sRGB. */
static void check_within(struct ik_stage *s, enum hl_pipeline pipeline,
                         const char *name, double least)
{
    struct hlh_picture p = ik_draw(s, pipeline, NULL, NULL);
    struct hlc_metrics m = ik_compare(s, &p, name);
    ik_judge(s, &p, name, m.within_1_255 >= least);
}

/* Scenes of opaque surfaces without shadows, in which all pipelines draw the
 * same; those of translucent surfaces, decals and shadows have tests of their
 * own.
 *
 * dB against the reference at 320 x 180, measured on lavapipe (Mesa 22.3.6)
 * and rounded down to a whole one, less one: no bound can be derived for a
 * scene, but a defect (a wrong tap, a threshold, a lost exponent) costs
 * several, and other machines' roundings move single pixels of edges.
 * full: L-buffer as large as the frame, one specular intensity; five: five
 * eighths a side, the planner's default. */
static const struct {
    const char *scene;
    double full, five;
} measured[] = {
    { "fig7", 43, 37 }, { "fig8", 48, 40 }, { "fig9", 45, 26 },
    { "lidr", 56, 38 }, { "thin", 47, 26 }, { "many", 45, 44 },
};
enum { SCENES = sizeof measured / sizeof *measured };

static double five_of(const char *scene)
{
    for (int i = 0; i < SCENES; i++)
        if (strcmp(measured[i].scene, scene) == 0)
            return measured[i].five;
    fail_msg("%s has not been measured", scene);
    return 0;
}

/* ---- forward ---------------------------------------------------------- */

/* Both pipelines evaluate the model itself, in 32 bits and a frame whose
 * format the planner takes for half a code of error. What is left are pixels
 * whose centre lies within rounding of a silhouette, some 0.06 % where edges
 * are dense (measured: fig9); 99.8 % leaves three times that. */
static void forward_is_the_reference(void **state)
{
    struct ck_machine *m = ck_machine(state);
    for (uint32_t i = 0; i < SCENES; i++) {
        const char *scene = measured[i].scene;
        struct ik_stage s;
        char name[100];
        ik_begin(&s, m, scene, W, H, NULL);
        snprintf(name, sizeof name, "%s forward", scene);
        check_within(&s, HL_PIPELINE_FORWARD, name, 0.998);
        snprintf(name, sizeof name, "%s multi-pass", scene);
        check_within(&s, HL_PIPELINE_FORWARD_MULTIPASS, name, 0.998);
        ik_end(&s);
    }
}

/* ---- inferred --------------------------------------------------------- */

/* Without specular and with an L-buffer as large as the frame nothing is
 * approximated but the encodings, which the planner keeps below a code: all
 * but the odd tie is forward's picture, same silhouettes included. */
static void inferred_is_forward_without_its_approximations(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hlc_world_options dull = { .no_specular = true };
    for (uint32_t i = 0; i < SCENES; i++) {
        const char *scene = measured[i].scene;
        struct ik_stage s;
        char name[100];
        ik_begin(&s, m, scene, W, H, &dull);
        struct hlh_picture forward = ik_draw(&s, HL_PIPELINE_FORWARD, NULL,
                                             NULL);
        free(s.reference.rgb);
        s.reference = forward;
        s.options.light_width = W;
        s.options.light_height = H;
        snprintf(name, sizeof name, "%s inferred, no specular", scene);
        check_within(&s, HL_PIPELINE_INFERRED, name, 0.9995);
        ik_end(&s);
    }
}

static struct hlc_metrics inferred(struct ik_stage *s, const char *name,
                                   uint32_t w, enum hl_dsf dsf, double least)
{
    s->options.light_width = w;
    s->options.light_height = w * H / W;
    s->options.dsf = dsf;
    struct hlh_picture p = ik_draw(s, HL_PIPELINE_INFERRED, NULL, NULL);
    struct hlc_metrics m = ik_compare(s, &p, name);
    ik_judge(s, &p, name, m.psnr >= least);
    return m;
}

static void inferred_is_as_near_as_measured(void **state)
{
    struct ck_machine *m = ck_machine(state);
    for (uint32_t i = 0; i < SCENES; i++) {
        const char *scene = measured[i].scene;
        struct ik_stage s;
        char name[4][100];
        static const char *const kinds[] = { "1:1", "5:8", "1:2",
                                             "5:8 without the filter" };
        for (int k = 0; k < 4; k++)
            snprintf(name[k], sizeof name[k], "%s inferred %s", scene,
                     kinds[k]);
        ik_begin(&s, m, scene, W, H, NULL);
        struct hlc_metrics full = inferred(&s, name[0], W, HL_DSF_AUTO,
                                           measured[i].full);
        struct hlc_metrics five = inferred(&s, name[1], W * 5 / 8, HL_DSF_AUTO,
                                           measured[i].five);
        struct hlc_metrics half = inferred(&s, name[2], W / 2, HL_DSF_AUTO, 0);
        struct hlc_metrics none = inferred(&s, name[3], W * 5 / 8, HL_DSF_NONE,
                                           0);
        /* Fewer texels are worse; without the filter edges are worse. */
        assert_true(full.mae < five.mae && five.mae < half.mae);
        assert_true(five.edge_mae < 0.9 * none.edge_mae);
        ik_end(&s);
    }
}

/* Formats of consoles add errors of their own to those of `native` dB: of the
 * L-buffer, which the plan predicts as a share of the light, and of the frame,
 * half of 2^-7 of a 7e3 float and a share of that of a half. Those of a pixel
 * may have one sign, so that roots of mean squares add. */
static double with_formats(double native, const struct hl_plan *p)
{
    bool small = hl_plan_target(p, HL_ROLE_COLOR)->format ==
                 HL_FORMAT_RGB10A2_FLOAT;
    double frame = small ? 1.0 / 256 : 1.0 / 2048;
    return -20 * log10(pow(10, -native / 20) + (double)p->light_error +
                       frame);
}

static double draw_as(struct ck_machine *m, const char *scene,
                      const char *profile, double native)
{
    struct ik_stage s;
    char name[100];
    ik_begin(&s, m, scene, W, H, NULL);
    snprintf(name, sizeof name, "%s as %s", scene, profile);
    s.options.light_width = W * 5 / 8;
    s.options.light_height = H * 5 / 8;
    struct hlh_picture p = ik_draw(&s, HL_PIPELINE_INFERRED, NULL, NULL);
    double psnr = ik_compare(&s, &p, name).psnr;
    double least = native > 0 ? with_formats(native, &s.plan)
                              : five_of(scene);
    print_message("%s: %.2f dB at least\n", name, least);
    assert_string_equal(s.plan.profile, profile);
    ik_judge(&s, &p, name, psnr >= least);
    ik_end(&s);
    return psnr;
}

static void consoles_are_as_near(void **state)
{
    static const char *const scenes[] = { "fig8", "fig9" };
    static const char *const profiles[] = { "native", "dx10", "ps3",
                                            "xbox360" };
    const char *backend = ck_machine(state)->backend->name;
    for (int i = 0; i < 2; i++) {
        double native = 0;
        for (int k = 0; k < 4; k++) {
            struct ck_machine m;
            ck_open_as(&m, backend, profiles[k]);
            double psnr = draw_as(&m, scenes[i], profiles[k], native);
            native = k ? native : psnr;
            ck_close(&m);
        }
    }
}

/* The planner's choice of lights' path and batch is no matter of quality. */
static void paths_draw_one_picture(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct ik_stage s;
    ik_begin(&s, m, "fig8", W, H, NULL);
    s.options.light_path = HL_LIGHT_PATH_LISTS;
    struct hlh_picture lists = ik_draw(&s, HL_PIPELINE_INFERRED, NULL, NULL);
    free(s.reference.rgb);
    s.reference = lists;
    s.options.light_path = HL_LIGHT_PATH_TILES;
    check_within(&s, HL_PIPELINE_INFERRED, "fig8 tiles against lists", 0.999);
    for (uint32_t batch = 1; batch <= 16; batch *= 4) {
        char name[100];
        s.options.light_path = HL_LIGHT_PATH_RECTS;
        s.options.light_batch = batch;
        snprintf(name, sizeof name, "fig8 rectangles of %u against lists",
                 batch);
        check_within(&s, HL_PIPELINE_INFERRED, name, 0.999);
    }
    ik_end(&s);
}

/* Four samples against the reference's four: the standard positions, shaded
 * a pixel where the reference shades a sample. Silhouettes agree, so that
 * what differs is shading across a pixel and the DSF's taps at edges. */
static void four_samples_smooth_edges(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct ik_stage s;
    ik_begin(&s, m, "fig8", W, H, NULL);
    struct hlh_picture one = ik_draw(&s, HL_PIPELINE_FORWARD, NULL, NULL);
    ik_smooth_reference(&s);
    struct hlc_metrics a = ik_compare(&s, &one, "fig8 forward, 1 sample");
    free(one.rgb);
    s.options.samples = 4;
    struct hlh_picture four = ik_draw(&s, HL_PIPELINE_FORWARD, NULL, NULL);
    struct hlc_metrics b = ik_compare(&s, &four, "fig8 forward, 4 samples");
    ik_judge(&s, &four, "fig8 forward, 4 samples",
             b.edge_mae < 0.5 * a.edge_mae);
    ik_end(&s);
}

/* ---- ids -------------------------------------------------------------- */

/* The true region of each pixel, and what the DSF buffer holds there. */
struct regions {
    uint32_t truth[W * H];
    uint16_t stored[W * H][2];   /* depth and id codes                       */
    int near;                    /* depth codes in half a hundredth of the
                                  * scene's longest side                     */
};

static void read_regions(struct ik_stage *s, struct hl_renderer *r, void *user)
{
    struct regions *g = user;
    float side = 0;
    for (int k = 0; k < 3; k++)
        side = fmaxf(side, s->scene.bounds_max[k] - s->scene.bounds_min[k]);
    g->near = (int)(side * 0.005f / s->frame.camera.far * 65535);
    assert_int_equal(hl_tex_read(s->m->device,
                                 hl_renderer_target(r, HL_ROLE_DSF),
                                 g->stored, sizeof g->stored), HL_OK);
    assert_int_equal(hl_frame_inspect(r, &s->frame, HL_INSPECT_IDS, g->truth,
                                      sizeof g->truth), HL_OK);
}

static void look_at_regions(struct regions *out, struct ck_machine *m,
                            const char *scene, enum hlc_ids_scheme scheme,
                            uint32_t seed)
{
    struct hlc_world_options o = { .ids = scheme, .ids_seed = seed };
    struct ik_stage s;
    ik_begin(&s, m, scene, W, H, &o);
    s.options.light_width = W;
    s.options.light_height = H;
    struct hlh_picture p = ik_draw(&s, HL_PIPELINE_INFERRED, read_regions,
                                   out);
    free(p.rgb);
    ik_end(&s);
}

struct shared { uint32_t pairs, objects, groups; };

static void count_pair(struct shared *n, const struct regions *truth,
                       const struct regions *stored, int near, int i, int k)
{
    const uint16_t *a = stored->stored[i], *b = stored->stored[k];
    bool same = a[1] == b[1] && abs(a[0] - b[0]) <= near;
    if (truth->truth[i] == truth->truth[k])
        return;
    n->pairs++;
    if (truth->truth[i] >> 16 == truth->truth[k] >> 16)
        n->groups += same;
    else
        n->objects += same;
}

/* Neighbours of different regions, and how many of them store one id at
 * depths at most `near` codes apart: regions of two objects, or of one. */
static struct shared count_shared(const struct regions *truth,
                                  const struct regions *stored, int near,
                                  const char *scene, const char *scheme)
{
    struct shared n = { 0, 0, 0 };
    for (int i = 0; i < W * H; i++) {
        if (i % W < W - 1)
            count_pair(&n, truth, stored, near, i, i + 1);
        if (i + W < W * H)
            count_pair(&n, truth, stored, near, i, i + W);
    }
    print_message("%s %s: of %u neighbours %u of two objects share an id, %u"
                  " of one; %.3f %%\n", scene, scheme, n.pairs, n.objects,
                  n.groups, 100.0 * (n.objects + n.groups) / n.pairs);
    assert_true(n.pairs > 1000);
    return n;
}

/* The paper's random ids over SEEDS drawings of the bytes: one in sight of a
 * few hundred regions is luck, the share over many is the scheme's. */
enum { SEEDS = 24 };

static void published_ids_collide(const struct regions *truth,
                                  struct regions *stored,
                                  struct ck_machine *m, const char *scene)
{
    uint32_t shared = 0, pairs = 0, seeds = 0;
    for (uint32_t k = 0; k < SEEDS; k++) {
        char name[32];
        snprintf(name, sizeof name, "as published, seed %u", k);
        look_at_regions(stored, m, scene, HLC_IDS_PAPER, k);
        struct shared n = count_shared(truth, stored, FAR_OFF, scene, name);
        shared += n.objects + n.groups;
        seeds += n.objects + n.groups > 0;
        pairs += n.pairs;
    }
    print_message("%s as published: %u of %u neighbours share an id, %.4f %%,"
                  " in %u of %d drawings\n", scene, shared, pairs,
                  100.0 * shared / pairs, seeds, SEEDS);
    assert_true(shared > 0);
    assert_true(shared < pairs / 50);
}

/* Unique ids never collide. The paper's do where two random bytes are equal
 * for two objects of one mesh, 1 of 256 of those (conformance b5), or for two
 * groups of one. Coloured ones may, but for objects so near each other that
 * the depth threshold might not part them: the tool's margin is a hundredth
 * of the scene's longest side, half of it is for the pixel's own width.
 * Within an object colouring parts regions that share an edge, and others
 * meet where what is between them is narrower than a pixel: a hundredth of
 * neighbours at most. The truth is the picture of a world with unique ids,
 * whose groups are the mesh's own. */
static void stored_ids_tell_neighbours_apart(void **state)
{
    static const char *const scenes[] = { "fig7", "many" };
    static struct regions truth, stored;
    struct ck_machine *m = ck_machine(state);
    for (int i = 0; i < 2; i++) {
        const char *scene = scenes[i];
        look_at_regions(&truth, m, scene, HLC_IDS_UNIQUE, 0);
        struct shared n = count_shared(&truth, &truth, FAR_OFF, scene,
                                       "unique");
        assert_int_equal(n.objects + n.groups, 0);
        look_at_regions(&stored, m, scene, HLC_IDS_COLORED, 0);
        n = count_shared(&truth, &stored, stored.near, scene, "coloured");
        assert_int_equal(n.objects, 0);
        assert_true(n.groups <= n.pairs / 100);
        published_ids_collide(&truth, &stored, m, scene);
    }
}

/* The background stores 0, which is no region's id. */
static void the_background_has_id_zero(void **state)
{
    static struct regions g;
    struct ck_machine *m = ck_machine(state);
    look_at_regions(&g, m, "fig7", HLC_IDS_UNIQUE, 0);
    for (int i = 0; i < W * H; i++)
        assert_true((g.truth[i] == 0) == (g.stored[i][1] == 0));
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(forward_is_the_reference),
        DRAWN(inferred_is_forward_without_its_approximations),
        DRAWN(inferred_is_as_near_as_measured),
        DRAWN(consoles_are_as_near),
        DRAWN(paths_draw_one_picture),
        DRAWN(four_samples_smooth_edges),
        DRAWN(stored_ids_tell_neighbours_apart),
        DRAWN(the_background_has_id_zero),
    };
    return cmocka_run_group_tests_name("pictures", tests, NULL, NULL);
}
