/* SPDX-License-Identifier: Zlib */
/* Frames drawn on a part of their targets (hl_frame.width, height): the same
 * picture as from a plan of that size, nothing outside, no seam at the edge. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

static struct fk_scene scene;

/* How a frame is drawn; part 0: all. */
struct setting {
    enum hl_pipeline pipeline;
    enum hl_light_path path;
    uint32_t w, h, light_w, light_h, part_w, part_h;
    bool no_depth;               /* lists without depth bounds               */
    bool shadows, panes;         /* maps; stippled translucent surfaces      */
};

struct shot {
    float *frame, *light;        /* RGBA of the whole targets                */
    uint8_t *rejects;            /* inferred                                 */
    uint32_t *ids;
    struct setting as;
    struct hl_plan plan;
};

static float *texels(struct hl_device *d, hl_tex tex)
{
    struct hlc_texels t;
    if (!tex.id)
        return NULL;
    assert_int_equal(hlc_texels_read(&t, d, tex), HL_OK);
    size_t n = (size_t)t.width * t.height;
    float *out = malloc(n * 4 * sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < n; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    return out;
}

static void inspect(struct shot *s, struct fk_run *run)
{
    size_t n = (size_t)s->plan.width * s->plan.height;
    s->rejects = calloc(n, 1);
    s->ids = calloc(n, 4);
    assert_true(s->rejects && s->ids);
    assert_int_equal(hl_frame_inspect(run->r, &scene.frame, HL_INSPECT_IDS,
                                      s->ids, n * 4), HL_OK);
    if (s->plan.pipeline == HL_PIPELINE_INFERRED)
        assert_int_equal(hl_frame_inspect(run->r, &scene.frame,
                                          HL_INSPECT_REJECTS, s->rejects, n),
                         HL_OK);
}

/* The scene, which stands, by one setting. */
static struct shot shoot(const struct setting *as)
{
    struct shot s;
    struct fk_run run;
    memset(&s, 0, sizeof s);
    scene.needs.width = as->w;
    scene.needs.height = as->h;
    scene.needs.light_width = as->light_w;
    scene.needs.light_height = as->light_h;
    scene.needs.light_path = as->path;
    scene.needs.no_tile_depth = as->no_depth;
    scene.needs.shadows = as->shadows ? HL_SHADOWS_MAPS : HL_SHADOWS_NONE;
    scene.needs.shadow_size = 256;
    scene.needs.translucency = as->panes ? HL_TRANSLUCENCY_2X2
                                         : HL_TRANSLUCENCY_AUTO;
    scene.frame.width = as->part_w;
    scene.frame.height = as->part_h;
    fk_prepare(&run, &scene, as->pipeline);
    run.desc.n_surfaces = as->panes ? FK_SURFACES : FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    s.as = *as;
    s.plan = run.plan;
    assert_int_equal(hl_frame_draw(run.r, &scene.frame, &run.stats), HL_OK);
    assert_int_equal(run.stats.shadow_lights > 0, as->shadows);
    assert_int_equal(run.stats.stippled, as->panes ? 2 : 0);
    s.frame = texels(scene.m->device, hl_renderer_output(run.r));
    s.light = texels(scene.m->device,
                     hl_renderer_target(run.r, HL_ROLE_LIGHT));
    inspect(&s, &run);
    fk_destroy(&run);
    return s;
}

static void drop(struct shot *s)
{
    free(s->frame);
    free(s->light);
    free(s->rejects);
    free(s->ids);
}

static void room(struct ck_machine *m, bool panes)
{
    uint64_t seed = 5;
    fk_begin(&scene, m);
    fk_room(&scene, 40, &seed);
    /* Floor and wall reach the picture's edges. */
    for (int i = 0; i < 24; i++)
        scene.item[i / 12].world[i % 12] *= 3;
    for (int i = 0; i < 3; i++)
        scene.light[i].shadow = true;
    for (int i = 0; i < 2 && panes; i++)
        fk_material(&scene, fk_add(&scene, FK_QUAD, FK_BLENDED, 2 + (float)i,
                                   0, (float)i, 3))->base[3] = 0.5f;
    for (int c = 0; c < 3; c++)
        scene.frame.background[c] = 0.05f * (float)(c + 1);
    /* Lights even what lies at the far plane, if a draw reaches it. */
    struct hl_light *l = fk_light(&scene, 0, 0, 0, 1);
    l->kind = HL_DIRECTIONAL;
    l->direction[2] = -1;
    for (int c = 0; c < 3; c++)
        l->color[c] = 0.1f;
}

/* Every way to light, on the machine of a test. */
static const struct {
    enum hl_pipeline pipeline;
    enum hl_light_path path;
    bool shadows, panes;
} ways[] = {
    { HL_PIPELINE_FORWARD, HL_LIGHT_PATH_AUTO, false, false },
    { HL_PIPELINE_FORWARD_MULTIPASS, HL_LIGHT_PATH_AUTO, false, false },
    { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_RECTS, false, false },
    { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_TILES, true, false },
    { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_LISTS, false, true },
    { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_VOLUMES, true, true },
};
enum { WAYS = sizeof ways / sizeof *ways };

/* ---- the same as a smaller plan ----------------------------------------- */

static float brightest(const float *p, size_t n)
{
    float most = 0;
    for (size_t i = 0; i < n * 4; i++)
        most = i % 4 < 3 && p[i] > most ? p[i] : most;
    return most;
}

static double rejected(const struct shot *s, uint32_t w, uint32_t h)
{
    uint32_t sum = 0, n = 0;
    for (uint32_t y = 0; y < h; y++)
        for (uint32_t x = 0; x < w; x++) {
            uint32_t r = s->rejects[y * s->plan.width + x];
            n += r > 0;
            sum += r > 1 ? r - 1 : 0;
        }
    return n ? (double)sum / n : 0;
}

/* Vertices move by rounding alone: x' = s x + (s - 1) w rounds at 2^-23 of w,
 * 1e-5 pixels, after which both machines and our own snap to 1/256 pixel: one
 * vertex in some hundreds lands on another code, and moves the edges beside
 * it by so little. So a share of pixels and L texels change hands: allowed
 * are 0.2 %. All others see surfaces that lie by at most 1/256 pixel apart,
 * and light and frame are rounded to half floats: 2^-10 of the brightest,
 * and the console's own steps of light (predicted). The last column and row
 * take taps that only the larger plan has. */
static void compare(const struct shot *part, const struct shot *small)
{
    uint32_t w = small->plan.width, h = small->plan.height, off = 0, moved = 0;
    bool inferred = small->plan.pipeline == HL_PIPELINE_INFERRED;
    uint32_t edge = inferred ? 1u : 0u, inner_w = w - edge, inner_h = h - edge;
    enum hl_format color = hl_plan_target(&small->plan, HL_ROLE_COLOR)->format;
    double rounding = color == HL_FORMAT_RGB10A2_FLOAT ? 1.0 / 256 : 0;
    double most = (double)brightest(small->frame, (size_t)w * h);
    assert_true(most > 0.3);     /* lit: background is 0.15 at most          */
    double limit = most * (2.0 / 1024 + rounding +
                           (inferred ? (double)small->plan.light_error : 0));
    double worst = 0;
    for (uint32_t y = 0; y < inner_h; y++)
        for (uint32_t x = 0; x < inner_w; x++) {
            size_t a = y * w + x, b = (size_t)y * part->plan.width + x;
            if (small->ids[a] != part->ids[b]) {
                moved++;
                continue;
            }
            double e = fk_difference(small->frame + 4 * a,
                                     part->frame + 4 * b, 1);
            worst = e > worst ? e : worst;
            off += e <= limit ? 0 : 1;
        }
    if (moved + off > w * h / 500)
        print_message("%s, %d, path %d: %u other surfaces, %u off, worst %.2g "
                      "of %.2g\n", small->plan.profile,
                      (int)small->plan.pipeline, (int)small->plan.light_path,
                      moved, off, worst, limit);
    assert_true(moved + off <= w * h / 500);
    /* 0.2 % of pixels at most with other taps, and so at the edge too. */
    if (!inferred)
        return;
    assert_true(rejected(part, w, h) <= rejected(small, w, h) + 0.008);
}

/* 1 L texel to 2 pixels, and 1 to 1. */
static void compare_ways(struct ck_machine *m, int first, int last)
{
    for (int i = first; i < last; i++) {
        struct setting big = { ways[i].pipeline, ways[i].path, 160, 90, 80,
                               45, 96, 54, false, ways[i].shadows,
                               ways[i].panes };
        struct setting one = { ways[i].pipeline, ways[i].path, 96, 54, 48,
                               27, 0, 0, false, ways[i].shadows,
                               ways[i].panes };
        room(m, ways[i].panes);
        struct shot a = shoot(&big), b = shoot(&one);
        compare(&a, &b);
        drop(&a);
        drop(&b);
        fk_end(&scene);
    }
}

static void a_part_is_the_frame_of_a_smaller_plan(void **state)
{
    compare_ways(ck_machine(state), 0, WAYS);
}

static void so_it_is_on_consoles(void **state)
{
    static const char *const profiles[] = { "dx10", "ps3", "xbox360" };
    const char *backend = ck_machine(state)->backend->name;
    for (int i = 0; i < 3; i++) {
        struct ck_machine m;
        ck_open_as(&m, backend, profiles[i]);
        compare_ways(&m, 1, 3);
        ck_close(&m);
    }
}

/* ---- nothing outside ---------------------------------------------------- */

static bool is(const float *p, const float want[3])
{
    for (int c = 0; c < 3; c++)
        if (!(fabsf(p[c] - want[c]) <= want[c] / 512))
            return false;
    return true;
}

/* Background as it was cleared (to half floats or 7e3: 1 / 512 at most); no
 * light on texels that no tap of the part reaches. */
static void check_outside(const struct shot *s)
{
    const float black[3] = { 0, 0, 0 };
    uint32_t w = s->as.part_w, h = s->as.part_h;
    for (uint32_t y = 0; y < s->plan.height; y++)
        for (uint32_t x = 0; x < s->plan.width; x++) {
            const float *p = s->frame + 4 * ((size_t)y * s->plan.width + x);
            assert_true(p[0] - p[0] + p[1] - p[1] + p[2] - p[2] == 0);
            if (x >= w || y >= h) {
                assert_true(is(p, scene.frame.background));
                assert_int_equal(s->ids[y * s->plan.width + x], 0);
            }
        }
    if (!s->light)
        return;
    /* Taps, fill and 2 x 2 patterns reach two texels beyond. */
    double lw = ceil((double)w * s->plan.light_width / s->plan.width) + 2;
    double lh = ceil((double)h * s->plan.light_height / s->plan.height) + 2;
    for (uint32_t y = 0; y < s->plan.light_height; y++)
        for (uint32_t x = 0; x < s->plan.light_width; x++) {
            const float *p = s->light +
                             4 * ((size_t)y * s->plan.light_width + x);
            assert_true(p[0] - p[0] + p[1] - p[1] + p[2] - p[2] == 0);
            if (x >= lw || y >= lh)
                assert_true(is(p, black));
        }
}

/* Rejected taps of a row (dx 1) or column (dy 1) of the drawn part. */
static uint32_t rejected_along(const struct shot *s, uint32_t x, uint32_t y,
                               uint32_t dx, uint32_t dy)
{
    uint32_t sum = 0;
    for (; x < s->as.part_w && y < s->as.part_h; x += dx, y += dy) {
        uint32_t r = s->rejects[y * s->plan.width + x];
        sum += r > 1 ? r - 1 : 0;
    }
    return sum;
}

/* Odd sizes, 5 L texels to 8 pixels. Floor and wall run past the edges, and
 * nothing else lies there: the last column and row reject what the next do,
 * a pixel's four taps more or less; without the texels beyond they would
 * reject two taps a pixel. */
static void odd_sizes_have_no_seam(void **state)
{
    struct ck_machine *m = ck_machine(state);
    for (int i = 0; i < WAYS; i++) {
        struct setting odd = { ways[i].pipeline, ways[i].path, 160, 90, 100,
                               56, 101, 57, i == 3, ways[i].shadows,
                               ways[i].panes };
        room(m, ways[i].panes);
        struct shot a = shoot(&odd);
        check_outside(&a);
        assert_true(rejected_along(&a, 100, 0, 0, 1) <=
                    rejected_along(&a, 99, 0, 0, 1) + 4);
        assert_true(rejected_along(&a, 0, 56, 1, 0) <=
                    rejected_along(&a, 0, 55, 1, 0) + 4);
        drop(&a);
        fk_end(&scene);
    }
}

/* ---- sizes -------------------------------------------------------------- */

/* All of it is what a frame without a size is, to the bit. */
static void all_of_it_is_no_part(void **state)
{
    struct setting none = { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_AUTO, 160, 90,
                            100, 56, 0, 0, false, false, false };
    struct setting all = none;
    all.part_w = 160;
    all.part_h = 90;
    room(ck_machine(state), false);
    struct shot a = shoot(&none), b = shoot(&all);
    assert_memory_equal(a.frame, b.frame, 160 * 90 * 4 * sizeof(float));
    assert_memory_equal(a.light, b.light, 100 * 56 * 4 * sizeof(float));
    drop(&a);
    drop(&b);
    fk_end(&scene);
}

static void sizes_beyond_the_plan_are_refused(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct fk_run run;
    room(m, false);
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    scene.frame.width = FK_W + 1;
    CK_REFUSED(m, hl_frame_draw(run.r, &scene.frame, NULL), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "width");
    scene.frame.width = 0;
    scene.frame.height = FK_H + 1;
    CK_REFUSED(m, hl_frame_draw(run.r, &scene.frame, NULL), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "height");
    scene.frame.width = 1;       /* the least there is                       */
    scene.frame.height = 1;
    CK_ALLOWED(m, hl_frame_draw(run.r, &scene.frame, NULL));
    assert_int_equal(hl_submit(m->device, true), HL_OK);
    fk_destroy(&run);
    fk_end(&scene);
}

#define ON_ALL(name) CK_ON("vulkan", name), CK_ON("gl", name), \
                     CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_ALL(a_part_is_the_frame_of_a_smaller_plan),
        ON_ALL(so_it_is_on_consoles),
        ON_ALL(odd_sizes_have_no_seam),
        ON_ALL(all_of_it_is_no_part),
        ON_ALL(sizes_beyond_the_plan_are_refused),
    };
    return cmocka_run_group_tests_name("frame scale", tests, NULL, NULL);
}
