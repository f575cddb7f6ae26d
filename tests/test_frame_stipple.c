/* SPDX-License-Identifier: Zlib */
/* Translucent surfaces stippled into the G-buffer (K 4): who writes which
 * texel, how it is lit, and what is left to forward draws. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "shaders/shared/stipple.h"
#include "tests/console_kit.h"
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

/* One pane opaque in the picture, -1: none, and all others next to nothing:
 * enough to be in the G-buffer. */
static void show(int one, int n)
{
    for (int i = 0; i < n; i++)
        fk_material(&scene, &scene.item[1 + i])->base[3] =
            i == one ? 1.0f : 0.01f;
}

/* Each pane, under and over all others. */
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

/* ---- who gets which pattern --------------------------------------------- */

/* Wanted patterns land in their cells; 0 is lit forward, and two that overlap
 * and want one pattern are a conflict, and drawn. */
static void users_choose_patterns(void **state)
{
    static const uint8_t wanted[] = { 3, 1, 0, 1, 2 };
    struct fk_run run;
    begin(ck_machine(state), HL_TRANSLUCENCY_2X2);
    scene.needs.stipple_mode = HL_STIPPLE_USER;
    panes(5);
    for (int i = 0; i < 5; i++)
        scene.item[1 + i].stipple = wanted[i];
    create(&run, HL_PIPELINE_INFERRED);
    uint32_t *id = ids(&run);
    for (int i = 0; i < 5; i++) {
        hl_vec2 c = hl_stipple_cell(wanted[i], 2);
        uint32_t cell = 1u << ((uint32_t)c.x + 2 * (uint32_t)c.y);
        uint32_t seen = cells_of(id, scene.item[1 + i].id_base, 2);
        /* Of the two with pattern 1 the nearer may hide the other. */
        assert_true(seen == (wanted[i] ? cell : 0) || (i == 1 && !seen));
    }
    assert_int_equal(run.stats.stippled, 4);
    assert_int_equal(run.stats.unstippled, 1);
    assert_int_equal(run.stats.stipple_conflicts, 1);
    scene.item[2].stipple = 4;
    CK_REFUSED(scene.m, hl_frame_draw(run.r, &scene.frame, NULL),
               HL_ERR_INVALID, HL_MSG_ARGUMENT,
               "hl_frame.items 2: stipple is no pattern");
    free(id);
    fk_destroy(&run);
    fk_end(&scene);
}

static void swap_first_and_last(void)
{
    struct hl_item it = scene.item[1];
    scene.item[1] = scene.item[3];
    scene.item[3] = it;
}

/* What has a name keeps its pattern wherever it is in the array; what has none
 * is known by its place. */
static void names_keep_patterns(void **state)
{
    begin(ck_machine(state), HL_TRANSLUCENCY_2X2);
    panes(3);
    for (int named = 0; named < 2; named++) {
        struct fk_run run;
        for (uint32_t i = 0; i < 3 && named; i++)
            scene.item[1 + i].name = 70 - 30 * i;
        create(&run, HL_PIPELINE_INFERRED);
        uint32_t of = scene.item[1].id_base;
        uint32_t *id = ids(&run), before = cells_of(id, of, 2);
        free(id);
        swap_first_and_last();
        id = ids(&run);
        assert_true((cells_of(id, of, 2) == before) == named);
        assert_int_equal(run.stats.stipple_changes, 0);
        free(id);
        scene.item[1].name = scene.item[2].name = 5;
        CK_REFUSED(scene.m, hl_frame_draw(run.r, &scene.frame, NULL),
                   HL_ERR_INVALID, HL_MSG_ARGUMENT, "one name");
        swap_first_and_last();
        fk_destroy(&run);
        scene.item[1].name = scene.item[2].name = 0;
    }
    fk_end(&scene);
}

/* ---- the same frame again ----------------------------------------------- */

enum { CROWD = 60 };

static void crowd(uint64_t *seed)
{
    wall();
    for (int i = 0; i < CROWD; i++) {
        struct hl_item *it = fk_add(&scene, FK_QUAD, FK_BLENDED, 0, 0, 0,
                                    (float)ck_between(seed, 1.8, 5.4));
        it->world[12] = (float)ck_between(seed, -9, 9);
        it->world[13] = (float)ck_between(seed, -5, 5);
        it->world[14] = (float)ck_between(seed, -4, 3);
        fk_material(&scene, it)->base[3] = 0.3f;
    }
}

/* Pictures of the inside are of the frame that was drawn, and leave the next
 * one as it would have been. There are too few patterns for this crowd, which
 * takes a few frames to come to the best assignment: made once more in between
 * it would be another. */
static void looking_inside_changes_no_pattern(void **state)
{
    static float lights[TEXELS];
    struct fk_run watched, alone;
    uint64_t seed = 1;
    uint32_t without = 0, changes = 0;
    begin(ck_machine(state), HL_TRANSLUCENCY_4X4);
    crowd(&seed);
    create(&watched, HL_PIPELINE_INFERRED);
    create(&alone, HL_PIPELINE_INFERRED);
    for (int frame = 0; frame < 16; frame++) {
        uint32_t *a = ids(&alone), *b = ids(&watched);
        assert_memory_equal(a, b, TEXELS * sizeof *a);
        assert_memory_equal(&alone.stats, &watched.stats, sizeof alone.stats);
        for (int k = 0; k < 3; k++)
            assert_int_equal(hl_frame_inspect(watched.r, &scene.frame,
                                              HL_INSPECT_LIGHTS, lights,
                                              sizeof lights), HL_OK);
        without += alone.stats.unstippled;
        changes += alone.stats.stipple_changes;
        for (int i = 1; i <= CROWD; i++)
            scene.item[i].world[12 + i % 2] += i % 4 < 2 ? 0.15f : -0.15f;
        free(a);
        free(b);
    }
    assert_true(without > 16 && changes > 16);
    fk_destroy(&watched);
    fk_destroy(&alone);
    fk_end(&scene);
}

/* ---- more than there is room for ---------------------------------------- */

/* 200 panes over each other are 19,900 pairs, more than the 6,400 there is
 * room for; of the nearer 100 three have patterns. */
static void crowds_beyond_the_limit_are_drawn(void **state)
{
    enum { PANES = 200 };
    static struct hl_item items[1 + PANES];
    struct fk_run run;
    begin(ck_machine(state), HL_TRANSLUCENCY_2X2);
    wall();
    items[0] = scene.item[0];
    struct hl_item *one = pane(8, 0, 0, 0.01);
    fk_prepare(&run, &scene, HL_PIPELINE_INFERRED);
    for (int i = 0; i < PANES; i++) {
        items[1 + i] = *one;
        items[1 + i].world[14] -= 0.01f * (float)i;
        items[1 + i].id_base += (uint32_t)i;
    }
    scene.frame.items = items;
    scene.frame.n_items = 1 + PANES;
    run.desc.max_items = 1 + PANES;
    assert_int_equal(fk_create(&run), HL_OK);
    uint32_t *id = ids(&run);
    assert_int_equal(run.stats.stippled, 3);
    assert_int_equal(run.stats.unstippled, PANES - 3);
    assert_int_equal(run.stats.stipple_conflicts, 0);
    for (uint32_t i = 0; i < PANES; i++)
        assert_true(i < 100 || !cells_of(id, items[1 + i].id_base, 2));
    free(id);
    fk_destroy(&run);
    fk_end(&scene);
}

/* ---- holes -------------------------------------------------------------- */

enum { LEFT = 255 };

/* Opaque in its left half. */
static hl_tex texture(struct ck_machine *m, uint8_t right)
{
    uint8_t texel[8 * 8][4];
    struct hl_tex_desc d = { .format = HL_FORMAT_RGBA8_SRGB, .width = 8,
                             .height = 8 };
    hl_tex t;
    memset(texel, 255, sizeof texel);
    for (int i = 0; i < 64; i++)
        texel[i][3] = i % 8 < 4 ? LEFT : right;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    assert_int_equal(hl_tex_write(m->device, t, 0, texel, sizeof texel),
                     HL_OK);
    return t;
}

/* Texels of its two halves that a surface writes; the texture's middle is
 * filtered, as wide as one of 8 texels of 40 pixels: left out. */
static void halves(struct fk_run *run, uint32_t n[2])
{
    uint32_t *id = ids(run);
    n[0] = n[1] = 0;
    for (uint32_t i = 0; i < TEXELS; i++) {
        int x = (int)(i % LIGHT_W) - LIGHT_W / 2;
        if (id[i] == scene.item[1].id_base && (x < -5 || x >= 5))
            n[x >= 0]++;
    }
    free(id);
}

/* What can be seen makes light, and all is blended (K 6). */
static void holes(struct ck_machine *m, enum fk_surface surface, uint8_t right,
                  bool written)
{
    struct fk_run run;
    uint32_t n[2];
    double alpha = right / 255.0;
    begin(m, HL_TRANSLUCENCY_2X2);
    wall();
    scene.surface[surface].blended = true;
    struct hl_item *it = fk_add(&scene, FK_QUAD, surface, 0, 0, 0, 3);
    struct hl_material *glow = fk_material(&scene, it);
    hl_tex tex = it->texture[0].tex = texture(m, right);
    glow->emission[0] = 1;
    for (int c = 0; c < 3; c++)
        glow->base[c] = 0;
    for (int c = 0; c < 3; c++)
        fk_material(&scene, &scene.item[0])->base[c] = 0;
    create(&run, HL_PIPELINE_INFERRED);
    halves(&run, n);
    /* A pattern's share of 33 x 33 / 2 texels less 5 columns. */
    assert_true(n[0] > 60 && (written ? n[1] > 60 : n[1] == 0));
    float *f = picture(&run);
    for (int y = 30; y < 60; y++) {
        ck_near((double)fk_at(f, 60, y)[0], 1, 1.0 / 1024);
        ck_near((double)fk_at(f, 100, y)[0], alpha, 1.0 / 1024);
    }
    free(f);
    fk_destroy(&run);
    hl_tex_destroy(m->device, &tex);
    fk_end(&scene);
}

static void holes_make_no_light(void **state)
{
    struct ck_machine *m = ck_machine(state);
    holes(m, FK_MASKED, 0, false);
    holes(m, FK_MASKED, 100, true);        /* below the cutoff, 127.5         */
    holes(m, FK_FULL, 0, false);
    holes(m, FK_FULL, 100, true);
}

/* ---- plans -------------------------------------------------------------- */

static struct hl_plan planned(const struct hl_needs *n)
{
    struct hl_caps c;
    ck_lavapipe(&c);
    return con_plan(HL_PIPELINE_INFERRED, n, &c);
}

static struct hl_needs under_glass(float lights)
{
    struct hl_needs n = con_needs();
    n.blended = true;
    n.lights_per_object = lights;
    return n;
}

/* Eight taps of 1.2 ns and two fifths of two stages of 1.5, against 8 ns a
 * light: the one light that costs less is drawn forward. */
static void the_cheaper_way_is_planned(void **state)
{
    struct hl_needs n = under_glass(1);
    struct hl_plan p = planned(&n);
    (void)state;
    assert_int_equal(p.translucency, HL_TRANSLUCENCY_FORWARD);
    assert_int_equal(p.stipple, 0);
    assert_non_null(con_reason(&p, HL_WHY_BLENDED_FORWARD));
    assert_null(con_reason(&p, HL_WHY_STIPPLED));
    n = under_glass(2);
    p = planned(&n);
    assert_int_equal(p.translucency, HL_TRANSLUCENCY_2X2);
    assert_int_equal(p.stipple, 2);
    assert_int_equal(p.stipple_mode, HL_STIPPLE_BEST);
    assert_true(p.stipple_cone);
    assert_null(con_reason(&p, HL_WHY_BLENDED_FORWARD));
    assert_null(con_reason(&p, HL_WHY_STIPPLE_LAYERS));
    const struct hl_plan_reason *r = con_reason(&p, HL_WHY_STIPPLED);
    assert_true(r && r->arg[0] == 2 && r->arg[1] == 16);
    ck_near((double)r->arg[2], 8 * 1.2 + 2 * 1.5 * 25 / 64 +
            1500 * 100 / (1.5 * 1280 * 720), 1e-4);
}

static void layers_decide_the_block(void **state)
{
    (void)state;
    for (uint32_t layers = 1; layers <= 16; layers++) {
        struct hl_needs n = under_glass(9);
        n.blended_layers = layers;
        struct hl_plan p = planned(&n);
        const struct hl_plan_reason *r = con_reason(&p, HL_WHY_STIPPLE_LAYERS);
        assert_int_equal(p.stipple, layers <= 3 ? 2 : 4);
        assert_true(r && r->arg[0] == (float)layers &&
                    r->arg[1] == (layers <= 3 ? 3 : 15));
        n.translucency = HL_TRANSLUCENCY_2X2;
        assert_int_equal(planned(&n).stipple, 2);
    }
}

/* Shadows are in the light pass alone; plain bilinear filtering would mix the
 * layers, and a single tap might be of another one. */
static void what_else_decides(void **state)
{
    struct hl_needs n = under_glass(1);
    (void)state;
    n.shadows = HL_SHADOWS_MAPS;
    n.n_shadow_lights = 1;
    assert_int_equal(planned(&n).translucency, HL_TRANSLUCENCY_2X2);
    n = under_glass(9);
    n.dsf = HL_DSF_NONE;
    assert_int_equal(planned(&n).translucency, HL_TRANSLUCENCY_FORWARD);
    n = under_glass(9);
    n.light_width = n.width;
    n.light_height = n.height;
    assert_int_equal(planned(&n).dsf, HL_DSF_SLOPE);
    n.translucency = HL_TRANSLUCENCY_FORWARD;
    assert_int_equal(planned(&n).dsf, HL_DSF_EXACT);
    n.translucency = HL_TRANSLUCENCY_4X4;
    n.stipple_filter = HL_STIPPLE_BILINEAR;
    n.stipple_mode = HL_STIPPLE_BY_DEPTH_FREE;
    struct hl_plan p = planned(&n);
    assert_int_equal(p.stipple, 4);
    assert_int_equal(p.stipple_mode, HL_STIPPLE_BY_DEPTH_FREE);
    assert_false(p.stipple_cone);
    assert_true(con_reason(&p, HL_WHY_STIPPLE_FILTER)->arg[0] == 0);
}

/* ---- nothing translucent ------------------------------------------------ */

/* However a scene would have its translucent surfaces: without any it has the
 * plan that it has without a wish, and so the same programs and memory. */
static void nothing_translucent_pays_nothing(void **state)
{
    static const struct hl_surface surface[2];
    static struct hl_plan plain, ready, used;
    (void)state;
    for (int k = 1; k < HL_PIPELINE_COUNT; k++) {
        struct hl_renderer_desc d = { .surfaces = surface, .n_surfaces = 2,
                                      .max_items = 100 };
        struct hl_needs n = con_needs();
        struct hl_caps caps;
        ck_lavapipe(&caps);
        plain = con_plan((enum hl_pipeline)k, &n, &caps);
        n.translucency = HL_TRANSLUCENCY_4X4;
        n.stipple_filter = HL_STIPPLE_BILINEAR;
        n.stipple_mode = HL_STIPPLE_BY_DEPTH;
        n.blended_layers = 9;
        ready = con_plan((enum hl_pipeline)k, &n, &caps);
        assert_memory_equal(&plain, &ready, sizeof plain);
        assert_int_equal(plain.translucency, HL_TRANSLUCENCY_AUTO);
        n.blended = true;
        used = con_plan((enum hl_pipeline)k, &n, &caps);
        bool inferred = k == HL_PIPELINE_INFERRED;
        assert_int_equal(used.stipple, inferred ? 4 : 0);
        assert_int_equal(used.translucency,
                         inferred ? HL_TRANSLUCENCY_4X4
                                  : HL_TRANSLUCENCY_FORWARD);
        d.plan = &plain;
        size_t bytes = hl_renderer_bytes(&d);
        d.plan = &used;
        assert_true((hl_renderer_bytes(&d) > bytes) == inferred);
    }
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
        DRAWN(users_choose_patterns),
        DRAWN(names_keep_patterns),
        DRAWN(looking_inside_changes_no_pattern),
        DRAWN(crowds_beyond_the_limit_are_drawn),
        DRAWN(holes_make_no_light),
        cmocka_unit_test(the_cheaper_way_is_planned),
        cmocka_unit_test(layers_decide_the_block),
        cmocka_unit_test(what_else_decides),
        cmocka_unit_test(nothing_translucent_pays_nothing),
    };
    return cmocka_run_group_tests_name("stippled frames", tests, NULL, NULL);
}
