/* SPDX-License-Identifier: Zlib */
/* Sub-pixel jitter of the camera: meshes move, light is computed where they
 * are, tiles, scissors and stipple patterns stay with the texels. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H, LIGHT_W = 100, LIGHT_H = 56 };

static struct fk_scene scene;

static void set_jitter(float x, float y)
{
    scene.frame.camera.jitter[0] = x;
    scene.frame.camera.jitter[1] = y;
}

static void begin(struct ck_machine *m, uint32_t light_w, uint32_t light_h)
{
    fk_begin(&scene, m);
    scene.needs.light_width = light_w;
    scene.needs.light_height = light_h;
}

static void create(struct fk_run *run, enum hl_pipeline pipeline)
{
    fk_prepare(run, &scene, pipeline);
    assert_int_equal(fk_create(run), HL_OK);
}

/* ---- light is where the surface is --------------------------------------- */

enum { PATHS = 4 };
static const enum hl_light_path paths[PATHS] = {
    HL_LIGHT_PATH_RECTS, HL_LIGHT_PATH_TILES, HL_LIGHT_PATH_LISTS,
    HL_LIGHT_PATH_VOLUMES
};

/* Some with a part of the targets, where texels end inside the picture. */
static const struct { float x, y; uint32_t w, h; } shifts[] = {
    { 0, 0, 0, 0 }, { 0.9f, -0.7f, 0, 0 }, { -1, 1, 0, 0 },
    { 1, 0.25f, 101, 57 }, { -0.6f, -1, 90, 90 }, { 0, 0, 150, 30 }
};
enum { SHIFTS = sizeof shifts / sizeof *shifts };

/* The camera stands 10 before the origin; the floor is y = -3, the wall
 * z = -8, so that the eye is 3 above the one and 18 before the other. */
static void floor_and_wall(struct ck_machine *m, enum hl_light_path path,
                           bool large)
{
    uint64_t seed = 11;
    begin(m, large ? FK_W : LIGHT_W, large ? FK_H : LIGHT_H);
    scene.needs.light_path = path;
    scene.needs.tile = 8;
    scene.needs.batch = path == HL_LIGHT_PATH_RECTS; /* unions hide bounds   */
    scene.needs.light_format = HL_FORMAT_RGBA32_FLOAT;
    fk_room(&scene, 0, &seed);
    scene.frame.n_items = 2;
    /* Half of them lie in the surface, but for a centimetre: they light as
     * much of it as their bounds enclose. */
    for (int i = 0; i < 40; i++) {
        bool low = i % 2, flat = i % 4 < 2;
        float x = (float)ck_between(&seed, -11, 11);
        float z = (float)ck_between(&seed, -7, 6);
        float y = (float)ck_between(&seed, -3, 9);
        struct hl_light *l = low ? fk_light(&scene, x, flat ? -2.99f : -2.2f,
                                            z, 1.3f)
                                 : fk_light(&scene, x, y, flat ? -7.99f : -7,
                                            2);
        for (int c = 0; c < 3; c++)
            l->color[c] = c == i % 3 ? 0.5f : 0.0f;
    }
    /* Seen by a wide part of the targets, not by all of them. */
    fk_light(&scene, -11, -2.99f, 3, 1.3f);
    fk_light(&scene, 11, -2.99f, 3, 1.3f);
}

/* View position and normal of what slope (x, y) sees; false where that is
 * neither surface, or is 1 % of an edge away from not being so. */
static bool surface_at(double x, double y, double p[3], double n[3])
{
    double floor_z = y < 0 ? 3 / -y : 1e9;
    double z = floor_z < 18 ? floor_z : 18;
    p[0] = x * z, p[1] = y * z, p[2] = -z;
    n[0] = 0, n[1] = floor_z < 18, n[2] = floor_z >= 18;
    return fabs(floor_z - 18) > 0.4 && fabs(p[0]) < 11.8 && fabs(p[1]) < 13.8;
}

/* D at the point, and how many lights reach it. */
static int light_at(const double p[3], const double n[3], double d[3])
{
    int count = 0;
    memset(d, 0, 3 * sizeof *d);
    for (uint32_t i = 0; i < scene.frame.n_lights; i++) {
        const struct hl_light *l = &scene.light[i];
        double to[3], d2 = 0, nl = 0;
        for (int k = 0; k < 3; k++) {
            to[k] = (double)l->position[k] - (k == 2 ? 10 : 0) - p[k];
            d2 += to[k] * to[k];
            nl += to[k] * n[k];
        }
        double t = 1 - d2 / ((double)l->radius * (double)l->radius);
        if (t <= 0 || nl <= 0)
            continue;
        count += t > 1e-4;
        for (int k = 0; k < 3; k++)
            d[k] += (double)l->color[k] * t * t * nl / sqrt(d2);
    }
    return count;
}

/* The light is kept in 32 bits, positions come from a depth that is exact to
 * 1e-6 m. The encoded normal is off by half of 2^-16, at 45 degrees from the
 * view axis 4.4e-5, of summed light of 2: 1e-4. The rasteriser snaps vertices
 * to 1/256 pixel: a wall that faces the camera keeps its depth, the floor's
 * row is off by 1/512 of 13 pixels where it meets the wall, 1.5e-4 of 17 m,
 * and a light of 0.5 and radius 1.3 falls by at most 1.54 * 0.5 / 1.3 a metre:
 * 1.5e-3. A jitter left in moves light by a third of a texel or more: 0.1 m. */
static void check_light(const struct fk_run *run, const float *light,
                        const float *counts, float jx, float jy)
{
    const struct hl_frame *f = &scene.frame;
    double w = f->width ? f->width : FK_W, h = f->height ? f->height : FK_H;
    int lw = (int)run->plan.light_width, lh = (int)run->plan.light_height;
    double sx = (double)lw / FK_W, sy = (double)lh / FK_H;
    double ty = (double)f->camera.tan_half_y, tx = ty * w / h;
    double worst[2] = { 0, 0 };  /* wall, floor                              */
    uint32_t lit = 0, missed = 0;
    for (int y = 0; y < h * sy; y++)
        for (int x = 0; x < w * sx; x++) {
            double p[3], n[3], d[3];
            const float *got = light + 4 * (y * lw + x);
            double a = tx * (2 * ((x + 0.5) / sx - (double)jx) / w - 1);
            double b = ty * (1 - 2 * ((y + 0.5) / sy - (double)jy) / h);
            if (!surface_at(a, b, p, n))
                continue;
            int reach = light_at(p, n, d);
            lit += reach > 0;
            missed += counts[y * lw + x] < (float)reach;
            for (int c = 0; c < 3; c++)
                worst[n[1] > 0] = fmax(worst[n[1] > 0],
                                       fabs((double)got[c] - d[c]));
        }
    assert_true(lit > 100);
    assert_int_equal(missed, 0);
    assert_true(worst[0] <= 1e-4 && worst[1] <= 1.6e-3);
}

/* By every path, or where L texels are as large as pixels by those that cut
 * draws to bounds: jitter of 5/8 texel is within what these round up by. */
static void check_paths(struct ck_machine *m, bool large)
{
    static float counts[FK_W * FK_H];
    for (int i = 0; i < (large ? 2 : PATHS); i++) {
        struct fk_run run;
        floor_and_wall(m, paths[i], large);
        create(&run, HL_PIPELINE_INFERRED);
        assert_int_equal(run.plan.light_path, paths[i]);
        size_t texels = (size_t)run.plan.light_width * run.plan.light_height;
        for (int k = 0; k < SHIFTS; k++) {
            set_jitter(shifts[k].x, shifts[k].y);
            scene.frame.width = shifts[k].w;
            scene.frame.height = shifts[k].h;
            float *light = fk_read(&run, HL_ROLE_LIGHT);
            assert_int_equal(hl_frame_inspect(run.r, &scene.frame,
                                              HL_INSPECT_LIGHTS, counts,
                                              texels * sizeof *counts), HL_OK);
            check_light(&run, light, counts, shifts[k].x, shifts[k].y);
            free(light);
        }
        fk_destroy(&run);
        fk_end(&scene);
    }
}

static void light_is_exact_under_jitter(void **state)
{
    check_paths(ck_machine(state), false);
    check_paths(ck_machine(state), true);
}

/* ---- where the picture goes ---------------------------------------------- */

/* A whole pixel is the same picture, one further right and down. Vertices
 * round otherwise (1e-5 pixels before they snap), so that edges of a few
 * triangles move by 1/256 pixel: 0.2 % of pixels may change hands; of the
 * others, light and frame round to half floats. */
static void check_moved(enum hl_pipeline pipeline)
{
    struct fk_run run;
    uint32_t off = 0;
    create(&run, pipeline);
    set_jitter(0, 0);
    float *still = fk_read(&run, HL_ROLE_NONE);
    set_jitter(1, 1);
    float *moved = fk_read(&run, HL_ROLE_NONE);
    for (int y = 0; y + 1 < FK_H; y++)
        for (int x = 0; x + 1 < FK_W; x++)
            off += fk_difference(fk_at(still, x, y),
                                 fk_at(moved, x + 1, y + 1), 1) > 2e-3;
    assert_true(off <= N / 500);
    free(still);
    free(moved);
    fk_destroy(&run);
}

static void a_pixel_of_jitter_moves_by_a_pixel(void **state)
{
    struct ck_machine *m = ck_machine(state);
    uint64_t seed = 5;
    begin(m, FK_W, FK_H);
    fk_room(&scene, 40, &seed);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        check_moved((enum hl_pipeline)p);
    fk_end(&scene);
}

/* A quad that begins 0.3 pixels right of the picture, and one as far below:
 * neither culled nor cut off when jitter moves them in by a pixel. */
static void what_jitter_brings_in_is_drawn(void **state)
{
    struct ck_machine *m = ck_machine(state);
    double ty = 0.57735, tx = ty * FK_W / FK_H, out = 1 + 0.6 / FK_W;
    begin(m, LIGHT_W, LIGHT_H);
    struct hl_item *right = fk_add(&scene, FK_QUAD, FK_PLAIN,
                                   (float)(10 * tx * out + 1), 0, 0, 1);
    out = 1 + 0.6 / FK_H;
    struct hl_item *low = fk_add(&scene, FK_QUAD, FK_PLAIN, 0,
                                 (float)(-10 * ty * out - 1), 0, 1);
    fk_material(&scene, right)->emission[1] = 1;
    fk_material(&scene, low)->emission[1] = 1;
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        struct fk_run run;
        create(&run, (enum hl_pipeline)p);
        for (int moved = 0; moved < 2; moved++) {
            set_jitter((float)-moved, (float)-moved);
            float *picture = fk_read(&run, HL_ROLE_NONE);
            assert_int_equal(run.stats.items, 2 * moved);
            float a = fk_at(picture, FK_W - 1, FK_H / 2 - 1)[1];
            float b = fk_at(picture, FK_W / 2 - 1, FK_H - 1)[1];
            assert_true(a == (float)moved && b == (float)moved);
            free(picture);
        }
        fk_destroy(&run);
    }
    fk_end(&scene);
}

/* ---- frames averaged ----------------------------------------------------- */

static float halton(int i, int base)
{
    double f = 1, r = 0;
    for (; i > 0; i /= base) {
        f /= base;
        r += f * (i % base);
    }
    return (float)r;
}

static float *averaged(struct fk_run *run, int frames)
{
    float *sum = calloc(N * 4, sizeof *sum);
    assert_non_null(sum);
    for (int i = 1; i <= frames; i++) {
        set_jitter(halton(i, 2) - 0.5f, halton(i, 3) - 0.5f);
        float *one = fk_read(run, HL_ROLE_NONE);
        for (int k = 0; k < N * 4; k++)
            sum[k] += one[k] / (float)frames;
        free(one);
    }
    return sum;
}

/* Every pixel the mean of 4 x 4 of a frame of four times the size. */
static float *supersampled(void)
{
    struct fk_run run;
    float *out = calloc(N * 4, sizeof *out);
    assert_non_null(out);
    set_jitter(0, 0);
    scene.needs.width = FK_W * 4;
    scene.needs.height = FK_H * 4;
    create(&run, HL_PIPELINE_FORWARD);
    float *big = fk_read(&run, HL_ROLE_NONE);
    for (int i = 0; i < N * 16; i++)
        for (int c = 0; c < 4; c++)
            out[(i / (FK_W * 16) * FK_W + i % (FK_W * 4) / 4) * 4 + c] +=
                big[i * 4 + c] / 16;
    free(big);
    fk_destroy(&run);
    scene.needs.width = FK_W;
    scene.needs.height = FK_H;
    return out;
}

static double rms(const float *a, const float *b)
{
    double sum = 0;
    for (int i = 0; i < N * 4; i++)
        if (i % 4 < 3)
            sum += ((double)a[i] - (double)b[i]) *
                   ((double)a[i] - (double)b[i]);
    return sqrt(sum / (N * 3));
}

/* Error of a frame and of 16 frames averaged. */
static void check_average(enum hl_pipeline pipeline, const float *want,
                          double share)
{
    struct fk_run run;
    create(&run, pipeline);
    set_jitter(0, 0);
    float *one = fk_read(&run, HL_ROLE_NONE);
    float *many = averaged(&run, 16);
    double single = rms(one, want), mean = rms(many, want);
    assert_true(mean < single * share);
    free(one);
    free(many);
    fk_destroy(&run);
}

/* 16 samples a pixel against one: with random samples an edge's coverage is
 * off by a quarter of what it was, 1 / sqrt 16, and that of 4 x 4 pixels by as
 * much: sqrt 2 / 4 = 0.35; 0.5 is given. An L-buffer of 5/8 keeps its blur of
 * the light's edges, which is as large as what was averaged away. */
static void averages_approach_many_samples(void **state)
{
    struct ck_machine *m = ck_machine(state);
    uint64_t seed = 5;
    begin(m, FK_W, FK_H);
    fk_room(&scene, 20, &seed);
    float *want = supersampled();
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        check_average((enum hl_pipeline)p, want, 0.5);
    scene.needs.light_width = LIGHT_W;
    scene.needs.light_height = LIGHT_H;
    check_average(HL_PIPELINE_INFERRED, want, 0.8);
    free(want);
    fk_end(&scene);
}

/* ---- stipple ------------------------------------------------------------- */

/* A pane over all of the picture before a wall, and two that overlap. */
static void panes(struct ck_machine *m, enum hl_translucency how)
{
    begin(m, LIGHT_W, LIGHT_H);
    scene.needs.translucency = how;
    fk_add(&scene, FK_QUAD, FK_PLAIN, 0, 0, -8, 90);
    fk_add(&scene, FK_QUAD, FK_BLENDED, 0, 0, 0, 60);
    fk_add(&scene, FK_QUAD, FK_BLENDED, -1, 0, 2, 2);
    fk_add(&scene, FK_QUAD, FK_BLENDED, 1, 0, 3, 2);
    fk_light(&scene, 0, 0, 5, 20);
    for (int i = 1; i < 4; i++)
        scene.material[i].base[3] = 0.5f;
}

/* Cells of a block on which an id lies, as bits, and its texels. */
struct use { uint32_t cells, texels; };

static void look(struct use use[5], const struct fk_run *run)
{
    struct hlc_texels t;
    uint32_t side = run->plan.stipple;
    memset(use, 0, 5 * sizeof *use);
    assert_int_equal(hlc_texels_read(&t, scene.m->device,
                                     hl_renderer_target(run->r, HL_ROLE_DSF)),
                     HL_OK);
    for (uint32_t i = 0; i < LIGHT_W * LIGHT_H; i++) {
        float c[4], two[2];
        hlc_texel(c, &t, i);
        hlc_two16(two, run->plan.two16, c);
        uint32_t id = (uint32_t)(two[1] * run->plan.id_steps + 0.5f);
        assert_in_range(id, 0, 4);
        uint32_t x = i % LIGHT_W % side, y = i / LIGHT_W % side;
        use[id].cells |= 1u << (y * side + x);
        use[id].texels++;
    }
    hlc_texels_free(&t);
}

static bool is_one(uint32_t bits) { return bits && !(bits & (bits - 1)); }

/* Each pane on a cell of its own; the one that covers everything has all of
 * its cell's texels, of the part and a few around it. */
static void check_cells(const struct fk_run *run, const struct use use[5])
{
    const struct hl_frame *f = &scene.frame;
    uint32_t side = run->plan.stipple;
    uint32_t w = f->width ? f->width * LIGHT_W / FK_W : LIGHT_W;
    uint32_t h = f->height ? f->height * LIGHT_H / FK_H : LIGHT_H;
    for (int i = 2; i < 5; i++)
        assert_true(is_one(use[i].cells));
    assert_int_equal(use[2].cells & use[3].cells, 0);
    assert_int_equal(use[2].cells & use[4].cells, 0);
    assert_int_equal(use[3].cells & use[4].cells, 0);
    assert_true(use[2].texels >= (w / side) * (h / side));
    if (!f->width)
        assert_int_equal(use[2].texels, (LIGHT_W / side) * (LIGHT_H / side));
}

static void patterns_belong_to_texels(void **state)
{
    struct ck_machine *m = ck_machine(state);
    for (int how = HL_TRANSLUCENCY_2X2; how <= HL_TRANSLUCENCY_4X4; how++) {
        struct fk_run run;
        struct use first[5], use[5];
        panes(m, (enum hl_translucency)how);
        create(&run, HL_PIPELINE_INFERRED);
        for (int k = 0; k < SHIFTS; k++) {
            set_jitter(shifts[k].x, shifts[k].y);
            scene.frame.width = shifts[k].w;
            scene.frame.height = shifts[k].h;
            free(fk_read(&run, HL_ROLE_NONE));
            assert_int_equal(run.stats.stippled, 3);
            look(use, &run);
            check_cells(&run, use);
            if (k == 0) {
                memcpy(first, use, sizeof first);
                continue;
            }
            /* Who has which depends neither on jitter nor on size. */
            assert_int_equal(run.stats.stipple_changes, 0);
            for (int i = 2; i < 5; i++)
                assert_int_equal(use[i].cells, first[i].cells);
        }
        fk_destroy(&run);
        fk_end(&scene);
    }
}

/* ---- what is none -------------------------------------------------------- */

static void other_jitter_is_refused(void **state)
{
    static const float bad[][2] = { { 1.001f, 0 }, { 0, -1.5f }, { NAN, 0 },
                                    { 0, NAN }, { 0, INFINITY } };
    struct ck_machine *m = ck_machine(state);
    struct fk_run run;
    begin(m, LIGHT_W, LIGHT_H);
    create(&run, HL_PIPELINE_INFERRED);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        set_jitter(bad[i][0], bad[i][1]);
        CK_REFUSED(m, hl_frame_draw(run.r, &scene.frame, NULL),
                   HL_ERR_INVALID, HL_MSG_ARGUMENT, "jitter");
    }
    set_jitter(-1, 1);
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
        ON_ALL(light_is_exact_under_jitter),
        ON_ALL(a_pixel_of_jitter_moves_by_a_pixel),
        ON_ALL(what_jitter_brings_in_is_drawn),
        ON_ALL(averages_approach_many_samples),
        ON_ALL(patterns_belong_to_texels),
        CK_ON("null", other_jitter_is_refused),
    };
    return cmocka_run_group_tests_name("frame jitter", tests, NULL, NULL);
}
