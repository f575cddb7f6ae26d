/* SPDX-License-Identifier: Zlib */
/* Translucent surfaces stippled into the G-buffer (K 4): who writes which
 * texel, how it is lit, and what is left to forward draws. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H, LIGHT_W = 100, LIGHT_H = 56, TEXELS = 100 * 56 };

static struct fk_scene scene;

/* ---- scenes ------------------------------------------------------------- */

static void begin(struct ck_machine *m, enum hl_translucency how)
{
    fk_begin(&scene, m);
    scene.needs.light_width = LIGHT_W;
    scene.needs.light_height = LIGHT_H;
    scene.needs.translucency = how;
}

/* Turn the item by `polar` about the axis that turns +z towards azimuth, both
 * in degrees; its scale stays. */
static void tilt(struct hl_item *it, double polar, double azimuth)
{
    double k = (double)it->world[0], to = 3.14159265358979 / 180;
    double s = sin(polar * to), c = cos(polar * to);
    double x = cos(azimuth * to), y = sin(azimuth * to);
    double r[9] = { c * x * x + y * y, (c - 1) * x * y, -s * x,
                    (c - 1) * x * y, c * y * y + x * x, -s * y,
                    s * x, s * y, c };
    for (int i = 0; i < 9; i++)
        it->world[i / 3 * 4 + i % 3] = (float)(k * r[i]);
}

/* `away` from the camera, and so large that in the middle of the picture at
 * least 24 pixels on all sides are covered: 50 degrees off at most, its far
 * end is 1.61 times as far away, 0.8 cos 50 / 1.61 / tan 30 of half of 90
 * pixels. */
static struct hl_item *pane(double away, double polar, double azimuth,
                            double alpha)
{
    struct hl_item *it = fk_add(&scene, FK_QUAD, FK_BLENDED, 0, 0,
                                (float)(10 - away), (float)(0.8 * away));
    fk_material(&scene, it)->base[3] = (float)alpha;
    tilt(it, polar, azimuth);
    return it;
}

/* Red from the right, green from above, blue from the left and below: the
 * light of a flat surface is one colour, and tells its normal. */
static void sky(void)
{
    for (int i = 0; i < 3; i++) {
        static const float to[3][3] = { { -0.8f, 0, -0.6f },
                                        { 0, -0.8f, -0.6f },
                                        { 0.48f, 0.36f, -0.8f } };
        struct hl_light *l = fk_light(&scene, 0, 0, 0, 1);
        l->kind = HL_DIRECTIONAL;
        memcpy(l->direction, to[i], sizeof l->direction);
        for (int c = 0; c < 3; c++)
            l->color[c] = c == i ? 1.0f : 0.05f;
    }
}

static void wall(void)
{
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, -30, 60);
    sky();
}

/* `n` panes that all cover the middle of the picture and face n ways; alphas
 * so that each weighs the same in the picture, and the wall as much. */
static void panes(int n)
{
    wall();
    for (int i = 0; i < n; i++)
        pane(16 - 8.0 * i / n, 15 + i * 37 % 36, i * 360.0 / n,
             1.0 / (i + 2));
}

/* ---- pictures ----------------------------------------------------------- */

static float *draw(struct fk_run *run, hl_tex (*tex)(const struct fk_run *),
                   size_t *n)
{
    struct hlc_texels t;
    assert_int_equal(hl_frame_draw(run->r, &run->scene->frame, &run->stats),
                     HL_OK);
    assert_int_equal(hlc_texels_read(&t, run->scene->m->device, tex(run)),
                     HL_OK);
    *n = (size_t)t.width * t.height;
    float *out = malloc(*n * 4 * sizeof *out);
    assert_non_null(out);
    for (size_t i = 0; i < *n; i++)
        hlc_texel(out + 4 * i, &t, i);
    hlc_texels_free(&t);
    return out;
}

static hl_tex output(const struct fk_run *run)
{
    return hl_renderer_output(run->r);
}

static hl_tex dsf(const struct fk_run *run)
{
    return hl_renderer_target(run->r, HL_ROLE_DSF);
}

static float *picture(struct fk_run *run)
{
    size_t n;
    float *p = draw(run, output, &n);
    assert_int_equal(n, N);
    return p;
}

/* Region ids of the G-buffer. */
static uint32_t *ids(struct fk_run *run)
{
    size_t n;
    float *p = draw(run, dsf, &n);
    uint32_t *id = malloc(n * sizeof *id);
    assert_non_null(id);
    assert_int_equal(n, TEXELS);
    for (size_t i = 0; i < n; i++) {
        float pair[2];
        hlc_two16(pair, run->plan.two16, p + 4 * i);
        id[i] = (uint32_t)(pair[1] * run->plan.id_steps + 0.5f);
    }
    free(p);
    return id;
}

static void create(struct fk_run *run, enum hl_pipeline pipeline)
{
    fk_prepare(run, &scene, pipeline);
    assert_int_equal(fk_create(run), HL_OK);
}

/* ---- patterns ----------------------------------------------------------- */

/* Cells of a block in which an id is seen, as bits. */
static uint32_t cells_of(const uint32_t *id, uint32_t of, uint32_t side)
{
    uint32_t cells = 0;
    for (uint32_t i = 0; i < TEXELS; i++)
        if (id[i] == of)
            cells |= 1u << (i % LIGHT_W % side +
                            i / LIGHT_W % side * side);
    return cells;
}

static uint32_t bits(uint32_t x)
{
    uint32_t n = 0;
    for (; x; x &= x - 1)
        n++;
    return n;
}

/* Each object has one cell of its own, and the wall what is left: in the
 * middle, where all objects are, no more than that, and at least cell 0. */
static void patterns_own_their_cells(const char *backend, const char *profile,
                                     uint32_t side)
{
    struct ck_machine m;
    struct fk_run run;
    uint32_t layers = side * side - 1, taken = 0;
    ck_open_as(&m, backend, profile);
    begin(&m, side == 2 ? HL_TRANSLUCENCY_2X2 : HL_TRANSLUCENCY_4X4);
    panes((int)layers);
    create(&run, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.stipple, side);
    uint32_t *id = ids(&run);
    assert_int_equal(run.stats.stippled, layers);
    assert_int_equal(run.stats.unstippled, 0);
    assert_int_equal(run.stats.stipple_conflicts, 0);
    for (uint32_t k = 0; k < layers; k++) {
        uint32_t cells = cells_of(id, scene.item[1 + k].id_base, side);
        assert_int_equal(bits(cells), 1);
        assert_false(cells & (taken | 1));
        taken |= cells;
    }
    for (uint32_t y = 24; y < 32; y++)
        for (uint32_t x = 44; x < 56; x++)
            assert_true((id[y * LIGHT_W + x] == scene.item[0].id_base) ==
                        (x % side == 0 && y % side == 0));
    free(id);
    fk_destroy(&run);
    fk_end(&scene);
    ck_close(&m);
}

static const char *backend_of(void **state)
{
    return ck_machine(state)->backend->name;
}

static const char *const profiles[] = { "native", "dx10", "xbox360", "ps3" };

static void objects_write_their_own_texels(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 4; i++) {
        patterns_own_their_cells(backend, profiles[i], 2);
        patterns_own_their_cells(backend, profiles[i], 4);
    }
}

/* ---- light -------------------------------------------------------------- */

/* The middle: every pixel there, and all texels that it may read (two blocks
 * of four texels of 1.6 pixels around it), are covered by all panes. */
enum { X0 = 70, X1 = 90, Y0 = 37, Y1 = 53 };

static double worst_in_the_middle(const float *a, const float *b)
{
    double worst = 0;
    for (int y = Y0; y < Y1; y++)
        for (int x = X0; x < X1; x++) {
            double e = fk_difference(fk_at(a, x, y), fk_at(b, x, y), 1);
            worst = e > worst ? e : worst;
        }
    return worst;
}

/* Largest difference that may be between a pane lit from the L-buffer and
 * forward, below 1.1. Light is constant over a flat surface, so filters add
 * nothing. What is left is the light's own error, of 16-bit normals (half a
 * code, 2^-16, is 2 d / cos 50 degrees of angle, times three lights of 1.1),
 * and a rounding of the picture in each of the two: 2^-11 of half floats that
 * are nearest, 2^-10 that are cut, 2^-7 of 7e3 floats; twice, blended. */
static double bound_of(const struct hl_plan *p)
{
    enum hl_format f = hl_plan_target(p, HL_ROLE_COLOR)->format;
    double step = f == HL_FORMAT_RGB10A2_FLOAT ? 1.0 / 128 : 1.0 / 1024;
    return 1.1 * ((double)p->light_error + 2 * 3 / 65536.0 / 0.64 + 2 * step);
}

/* One pane alone in the picture, -1: the wall alone; all are in the G-buffer,
 * since only textures make holes. */
static void show(int one, int n)
{
    for (int i = 0; i < n; i++)
        fk_material(&scene, &scene.item[1 + i])->base[3] = i == one;
}

/* Each pane by itself, under and over all others. */
static void lit_as_forward(const char *backend, const char *profile,
                           enum hl_translucency how, int n)
{
    struct ck_machine m;
    struct fk_run forward, stippled;
    double worst = 0;
    int patterns = how == HL_TRANSLUCENCY_2X2 ? 3 : 15;
    ck_open_as(&m, backend, profile);
    begin(&m, how);
    panes(n);
    create(&forward, HL_PIPELINE_FORWARD);
    create(&stippled, HL_PIPELINE_INFERRED);
    for (int i = -1; i < n; i++) {
        show(i, n);
        float *want = picture(&forward), *got = picture(&stippled);
        double e = worst_in_the_middle(want, got);
        worst = e > worst ? e : worst;
        assert_int_equal(stippled.stats.stippled, n < patterns ? n : patterns);
        assert_int_equal(stippled.stats.unstippled,
                         n < patterns ? 0 : n - patterns);
        free(want);
        free(got);
    }
    print_message("%s, %d layers: %.2g of %.2g\n", profile, n, worst,
                  bound_of(&stippled.plan));
    assert_true(worst <= bound_of(&stippled.plan));
    fk_destroy(&forward);
    fk_destroy(&stippled);
    fk_end(&scene);
    ck_close(&m);
}

static void three_layers_are_lit_as_forward(void **state)
{
    const char *backend = backend_of(state);
    for (int i = 0; i < 4; i++)
        lit_as_forward(backend, profiles[i], HL_TRANSLUCENCY_2X2, 3);
}

static void a_fourth_layer_goes_forward(void **state)
{
    lit_as_forward(backend_of(state), "native", HL_TRANSLUCENCY_2X2, 4);
}

static void fifteen_layers_are_lit_as_forward(void **state)
{
    lit_as_forward(backend_of(state), "native", HL_TRANSLUCENCY_4X4, 15);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(objects_write_their_own_texels),
        DRAWN(three_layers_are_lit_as_forward),
        DRAWN(a_fourth_layer_goes_forward),
        DRAWN(fifteen_layers_are_lit_as_forward),
    };
    return cmocka_run_group_tests_name("stippled frames", tests, NULL, NULL);
}
