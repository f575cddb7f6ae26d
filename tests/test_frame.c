/* SPDX-License-Identifier: Zlib */
/* What a renderer promises: what it refuses and how it says so, that nothing
 * is left of what failed, that its passes are the plan's. test_frame_light.c
 * and test_frame_surface.c look at the pictures. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "hal/device.h"
#include "platforms/null/hl_null.h"
#include "tests/frame_kit.h"

/* ---- creating --------------------------------------------------------- */

static uint32_t live(const struct hl_device *d)
{
    uint32_t n = 0;
    for (int i = 0; i < HL_POOL_COUNT; i++)
        n += d->pool[i].n_used;
    return n;
}

#define DESC_BAD(field, value)                                         \
    do {                                                               \
        struct hl_renderer_desc bad_ = run.desc;                       \
        bad_.field = value;                                            \
        assert_int_equal(hl_renderer_bytes(&bad_), 0);                 \
        assert_int_equal(hl_renderer_create(&r, s.m->device, &bad_,    \
                                            memory), HL_ERR_INVALID);  \
        assert_null(r);                                                \
    } while (0)

static void descs_are_checked(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    fk_begin(&s, ck_machine(state));
    fk_add(&s, FK_BOX, FK_PLAIN, 0, 0, 0, 1);
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    struct hl_renderer *r = NULL;
    void *memory = malloc(hl_renderer_bytes(&run.desc));
    struct hl_plan automatic = run.plan;
    automatic.pipeline = HL_PIPELINE_AUTO;
    DESC_BAD(plan, NULL);
    DESC_BAD(plan, &automatic);
    DESC_BAD(max_items, 0);
    DESC_BAD(max_items, 0x1000001);
    DESC_BAD(max_lights, 0x1000001);
    DESC_BAD(surfaces, NULL);
    DESC_BAD(n_surfaces, 0x10001);
    assert_int_equal(hl_renderer_create(NULL, s.m->device, &run.desc, memory),
                     HL_ERR_INVALID);
    assert_int_equal(hl_renderer_create(&r, NULL, &run.desc, memory),
                     HL_ERR_INVALID);
    assert_int_equal(hl_renderer_create(&r, s.m->device, NULL, memory),
                     HL_ERR_INVALID);
    assert_int_equal(hl_renderer_create(&r, s.m->device, &run.desc, NULL),
                     HL_ERR_INVALID);
    hl_renderer_destroy(&r);
    hl_renderer_destroy(NULL);
    free(memory);
    fk_end(&s);
}

/* A renderer's memory is what hl_renderer_bytes says: none beyond is
 * touched, by creating or by drawing. */
static void memory_is_what_was_asked_for(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    uint64_t seed = mk_seed();
    fk_begin(&s, ck_machine(state));
    fk_room(&s, 40, &seed);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        fk_prepare(&run, &s, (enum hl_pipeline)p);
        run.desc.max_items = s.frame.n_items;
        run.desc.max_lights = s.frame.n_lights;
        size_t bytes = hl_renderer_bytes(&run.desc);
        uint8_t *memory = malloc(bytes + 64);
        memset(memory, 0xA5, bytes + 64);
        assert_int_equal(hl_renderer_create(&run.r, s.m->device, &run.desc,
                                            memory), HL_OK);
        assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
        assert_int_equal(hl_submit(s.m->device, true), HL_OK);
        hl_renderer_destroy(&run.r);
        for (int i = 0; i < 64; i++)
            assert_int_equal(memory[bytes + (size_t)i], 0xA5);
        free(memory);
    }
    fk_end(&s);
}

static void destroying_leaves_nothing(void **state)
{
    struct fk_scene s;
    uint64_t seed = mk_seed();
    fk_begin(&s, ck_machine(state));
    fk_room(&s, 8, &seed);
    uint32_t before = live(s.m->device);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        struct fk_run run;
        uint32_t w, h;
        fk_prepare(&run, &s, (enum hl_pipeline)p);
        assert_int_equal(fk_create(&run), HL_OK);
        assert_true(live(s.m->device) > before);
        assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
        for (int i = HL_INSPECT_IDS; i <= HL_INSPECT_REJECTS; i++) {
            hl_inspect_size(run.r, (enum hl_inspect)i, &w, &h);
            size_t bytes = (size_t)w * h * (i == HL_INSPECT_REJECTS ? 1 : 4);
            void *out = malloc(bytes);
            bool can = i != HL_INSPECT_REJECTS || p == HL_PIPELINE_INFERRED;
            assert_int_equal(hl_frame_inspect(run.r, &s.frame,
                                              (enum hl_inspect)i, out, bytes),
                             can ? HL_OK : HL_ERR_UNSUPPORTED);
            free(out);
        }
        fk_destroy(&run);
        assert_int_equal(live(s.m->device), before);
    }
    fk_end(&s);
}

/* ---- refusing frames -------------------------------------------------- */

/* A frame that is refused: result, message, and nothing recorded; the next
 * right one is drawn. */
static void check_refused(struct fk_run *run, const struct hl_frame *f,
                          enum hl_result result, const char *part)
{
    struct ck_machine *m = run->scene->m;
    struct hl_counts a = hl_device_counts(m->device), b;
    uint32_t errors = m->errors;
    enum hl_result r = hl_frame_draw(run->r, f, NULL);
    if (r != result)
        fail_msg("%s: %s, not %s", part, hl_result_name(r),
                 hl_result_name(result));
    ck_refused(m, errors, m->last_id, part);
    b = hl_device_counts(m->device);
    assert_int_equal(a.passes, b.passes);
    assert_int_equal(a.draws, b.draws);
    assert_int_equal(hl_frame_draw(run->r, &run->scene->frame, NULL), HL_OK);
}

/* check_refused draws the scene's frame again, which must be right by then:
 * give the bad one as a copy. */
#define BAD(what, part)                                                  \
    do {                                                                 \
        struct hl_frame bad = s.frame;                                   \
        struct hl_light light[3];                                        \
        struct hl_item item[3];                                          \
        memcpy(light, s.light, sizeof light);                            \
        memcpy(item, s.item, sizeof item);                               \
        bad.lights = light;                                              \
        bad.items = item;                                                \
        what;                                                            \
        check_refused(&run, &bad, HL_ERR_INVALID, part);                 \
    } while (0)

static void make_three(struct fk_scene *s, struct fk_run *run, void **state,
                       enum hl_pipeline pipeline)
{
    fk_begin(s, ck_machine(state));
    for (int i = 0; i < 3; i++) {
        fk_add(s, FK_BOX, FK_PLAIN, (float)i * 3 - 3, 0, 0, 1);
        fk_light(s, (float)i * 3 - 3, 0, 3, 5);
    }
    fk_prepare(run, s, pipeline);
    assert_int_equal(fk_create(run), HL_OK);
}

static void bad_lights_are_named_by_index(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    make_three(&s, &run, state, HL_PIPELINE_INFERRED);
    BAD(light[1].radius = -1, "hl_frame.lights 1: radius");
    BAD(light[2].radius = NAN, "hl_frame.lights 2: radius");
    BAD(light[2].color[1] = INFINITY, "hl_frame.lights 2: color");
    BAD(light[0].position[2] = NAN, "hl_frame.lights 0: position");
    BAD(light[1].kind = HL_SPOT, "hl_frame.lights 1: direction");
    BAD(bad.lights = NULL, "NULL");
    fk_destroy(&run);
    fk_end(&s);
}

static void bad_items_and_cameras_are_named(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    make_three(&s, &run, state, HL_PIPELINE_FORWARD);
    BAD(item[1].surface = FK_SURFACES, "hl_frame.items 1: surface");
    BAD(item[2].material = NULL, "hl_frame.items 2: material");
    BAD(item[0].world[7] = NAN, "hl_frame.items 0: world");
    BAD(item[0].bounds_max[2] = INFINITY, "hl_frame.items 0: world or bounds");
    BAD(item[1].bounds_min[0] = NAN, "hl_frame.items 1: world or bounds");
    for (int k = 0; k < 11; k++) {
        struct hl_material rough = s.material[1];
        float *const field[11] = {
            &rough.base[0], &rough.base[1], &rough.base[2], &rough.base[3],
            &rough.metallic, &rough.roughness, &rough.emission[0],
            &rough.emission[1], &rough.emission[2], &rough.normal_scale,
            &rough.alpha_cutoff };
        *field[k] = k % 2 ? NAN : INFINITY;
        BAD(item[1].material = &rough, "hl_frame.items 1: material not");
    }
    BAD(bad.items = NULL, "NULL");
    BAD(bad.camera.near = 0, "hl_frame.camera");
    BAD(bad.camera.near = NAN, "hl_frame.camera");
    BAD(bad.camera.far = bad.camera.near, "hl_frame.camera");
    BAD(bad.camera.far = INFINITY, "hl_frame.camera");
    BAD(bad.camera.tan_half_y = 0, "hl_frame.camera");
    BAD(bad.camera.tan_half_y = NAN, "hl_frame.camera");
    BAD(bad.camera.tan_half_y = INFINITY, "hl_frame.camera");
    BAD(bad.camera.view[5] = NAN, "hl_frame.camera");
    BAD(bad.ambient[1] = NAN, "ambient");
    BAD(bad.background[2] = INFINITY, "background");
    assert_int_equal(hl_frame_draw(NULL, &s.frame, NULL), HL_ERR_INVALID);
    assert_int_equal(hl_frame_draw(run.r, NULL, NULL), HL_ERR_INVALID);
    fk_destroy(&run);
    fk_end(&s);
}

/* An item of a surface with a stage of its own brings its block, and where it
 * is blended, which is drawn forward, a material too. */
static void own_stages_need_their_blocks(void **state)
{
    (void)state;
    static const struct hl_code code = { NULL, 0, NULL, NULL };
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    float block[4] = { 0 };
    assert_true(ck_open(&m, "null", NULL));      /* takes any stage          */
    fk_begin(&s, &m);
    s.surface[FK_PLAIN].own_material = &code;
    s.surface[FK_BLENDED].own_material = &code;
    for (int i = 0; i < 3; i++) {
        struct hl_item *it = fk_add(&s, FK_BOX,
                                    i == 1 ? FK_BLENDED : FK_PLAIN,
                                    (float)i * 3 - 3, 0, 0, 1);
        it->material_block = block;
        it->material_bytes = sizeof block;
        fk_light(&s, 0, 0, 3, 5);
    }
    s.item[0].material = NULL;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    BAD(item[2].material_block = NULL, "hl_frame.items 2: material_block");
    BAD(item[0].material_bytes = 0, "hl_frame.items 0: material_block");
    BAD(item[1].material = NULL, "hl_frame.items 1: material is NULL");
    fk_destroy(&run);
    fk_end(&s);
    ck_close(&m);
}

static void more_than_was_stated_is_refused(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    fk_begin(&s, ck_machine(state));
    for (int i = 0; i < 3; i++) {
        fk_add(&s, FK_BOX, FK_PLAIN, (float)i * 3 - 3, 0, 0, 1);
        fk_light(&s, (float)i * 3 - 3, 0, 3, 5);
    }
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    run.desc.max_items = 3;
    run.desc.max_lights = 3;
    assert_int_equal(fk_create(&run), HL_OK);
    struct hl_frame more = s.frame;
    more.n_lights = 4;
    check_refused(&run, &more, HL_ERR_LIMIT, "more items or lights");
    more = s.frame;
    more.n_items = 4;
    check_refused(&run, &more, HL_ERR_LIMIT, "more items or lights");
    fk_destroy(&run);
    fk_end(&s);
}

/* Uniform data, lists: too little room is found when it runs out, and named;
 * a smaller frame then works. */
static void capacities_that_run_out_are_named(void **state)
{
    struct fk_scene s;
    uint64_t seed = mk_seed();
    fk_begin(&s, ck_machine(state));
    fk_room(&s, 60, &seed);
    s.needs.no_tile_depth = true;    /* null has no depth to bound lists by  */
    static const struct {
        enum hl_pipeline pipeline;
        enum hl_light_path path;
        size_t frame_bytes, list_bytes;
        const char *part;
    } row[] = {
        { HL_PIPELINE_FORWARD, 0, 4096, 0, "hl_renderer_desc.frame_bytes" },
        { HL_PIPELINE_FORWARD_MULTIPASS, 0, 8192, 0,
          "hl_renderer_desc.frame_bytes" },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_RECTS, 4096, 0,
          "hl_renderer_desc.frame_bytes" },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_TILES, 12000, 0,
          "hl_renderer_desc.frame_bytes" },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_LISTS, 0, 1024,
          "hl_renderer_desc.list_bytes" },
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct fk_run run;
        s.needs.light_path = row[i].path;
        fk_prepare(&run, &s, row[i].pipeline);
        run.desc.frame_bytes = row[i].frame_bytes;
        run.desc.list_bytes = row[i].list_bytes;
        assert_int_equal(fk_create(&run), HL_OK);
        CK_REFUSED(s.m, hl_frame_draw(run.r, &s.frame, NULL), HL_ERR_LIMIT,
                   HL_MSG_LIMIT, row[i].part);
        assert_int_equal(hl_submit(s.m->device, true), HL_OK);
        struct hl_frame small = s.frame;
        small.n_items = small.n_lights = 1;
        CK_ALLOWED(s.m, hl_frame_draw(run.r, &small, NULL));
        assert_int_equal(hl_submit(s.m->device, true), HL_OK);
        fk_destroy(&run);
    }
    fk_end(&s);
}

static void inspecting_is_checked(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    make_three(&s, &run, state, HL_PIPELINE_INFERRED);
    static uint32_t out[FK_W * FK_H];
    assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
    assert_int_equal(hl_frame_inspect(NULL, &s.frame, HL_INSPECT_IDS, out,
                                      sizeof out), HL_ERR_INVALID);
    assert_int_equal(hl_frame_inspect(run.r, NULL, HL_INSPECT_IDS, out,
                                      sizeof out), HL_ERR_INVALID);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS, NULL,
                                      sizeof out), HL_ERR_INVALID);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, (enum hl_inspect)4,
                                      out, sizeof out), HL_ERR_INVALID);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS, out,
                                      sizeof out - 4), HL_ERR_INVALID);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS, out,
                                      sizeof out), HL_OK);
    fk_destroy(&run);
    fk_end(&s);
}

/* ---- failures of the machine ------------------------------------------ */

/* Create, draw, inspect on a null device whose n-th call fails. Returns
 * whether all worked. */
static bool draw_failing(uint32_t n, enum hl_pipeline pipeline,
                         enum hl_light_path path)
{
    struct hl_null_native native = { NULL, NULL, NULL, n ? n + 2 : 0 };
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    uint64_t seed = 1;
    static uint8_t out[FK_W * FK_H * 4];
    assert_true(ck_open(&m, "null", &native));
    fk_begin(&s, &m);            /* the first two calls: its buffers         */
    fk_room(&s, 20, &seed);
    fk_add(&s, FK_QUAD, FK_BLENDED, 0, 0, 4, 1);
    s.needs.light_path = path;
    fk_prepare(&run, &s, pipeline);
    enum hl_result r = fk_create(&run);
    if (r != HL_OK) {
        assert_null(run.r);
        assert_int_equal(live(m.device), 2);
    }
    if (r == HL_OK)
        r = hl_frame_draw(run.r, &s.frame, NULL);
    if (r == HL_OK)
        r = hl_submit(m.device, true);
    if (r == HL_OK)
        r = hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS, out,
                             sizeof out);
    assert_true(r == HL_OK || r == HL_ERR_MEMORY);
    if (r != HL_OK && run.r)     /* it passed: the renderer is as before     */
        assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
    fk_destroy(&run);
    assert_int_equal(live(m.device), 2);
    fk_end(&s);
    ck_close(&m);
    return r == HL_OK;
}

static void any_call_may_fail(void **state)
{
    (void)state;
    uint32_t total = 0;
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        for (int path = HL_LIGHT_PATH_RECTS; path <= HL_LIGHT_PATH_LISTS;
             path++) {
            uint32_t n = 1;
            if (p != HL_PIPELINE_INFERRED && path != HL_LIGHT_PATH_RECTS)
                continue;
            while (!draw_failing(n, (enum hl_pipeline)p,
                                 (enum hl_light_path)path))
                n++;
            assert_true(n > 15);
            total += n - 1;
        }
    print_message("%u failures\n", total);
}

/* ---- passes are the plan's -------------------------------------------- */

struct record { char text[64][200]; int n; };

static void take_line(void *user, const char *line)
{
    struct record *r = user;
    assert_true(r->n < 64);
    strncpy(r->text[r->n++], line, 199);
}

static const char *pass_name(enum hl_pass_role role)
{
    static const char *const names[] = { "none", "geometry", "light",
                                         "material", "forward", "blended" };
    return names[role];
}

static void passes_are_the_plans(void **state)
{
    (void)state;
    struct record rec = { { { 0 } }, 0 };
    struct hl_null_native native = { NULL, take_line, &rec, 0 };
    struct ck_machine m;
    uint64_t seed = 1;
    assert_true(ck_open(&m, "null", &native));
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        for (int blended = 0; blended < 2; blended++)
            for (uint32_t samples = 1; samples <= 4; samples *= 4) {
                struct fk_scene s;
                struct fk_run run;
                fk_begin(&s, &m);
                fk_room(&s, 20, &seed);
                if (blended)
                    fk_add(&s, FK_QUAD, FK_BLENDED, 0, 0, 4, 1);
                s.needs.samples = samples;
                fk_prepare(&run, &s, (enum hl_pipeline)p);
                assert_int_equal(fk_create(&run), HL_OK);
                rec.n = 0;
                assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
                assert_int_equal(rec.n, (int)run.plan.n_passes);
                for (int i = 0; i < rec.n; i++) {
                    char want[80];
                    const struct hl_plan_pass *pass = &run.plan.pass[i];
                    const struct hl_plan_target *t =
                        hl_plan_target(&run.plan, pass->color[0]);
                    snprintf(want, sizeof want, "pass %s %ux%ux%u ",
                             pass_name(pass->role), t->width, t->height,
                             t->samples);
                    assert_true(strncmp(rec.text[i], want, strlen(want)) ==
                                0);
                    /* Only the last pass resolves. */
                    assert_true((strstr(rec.text[i], "resolve") != NULL) ==
                                (samples > 1 && i == rec.n - 1));
                }
                fk_destroy(&run);
                fk_end(&s);
            }
    ck_close(&m);
}

/* More draws than the scratch holds go out in several parts, of which the
 * first alone clears and the last alone resolves. */
static void long_passes_are_split(void **state)
{
    (void)state;
    enum { MANY = 9000 };
    struct record rec = { { { 0 } }, 0 };
    struct hl_null_native native = { NULL, take_line, &rec, 0 };
    struct ck_machine m;
    struct fk_scene s;
    struct fk_run run;
    struct hl_item *items = malloc(MANY * sizeof *items);
    assert_non_null(items);
    assert_true(ck_open(&m, "null", &native));
    fk_begin(&s, &m);
    fk_add(&s, FK_BOX, FK_PLAIN, 0, 0, 0, 1);
    s.needs.samples = 4;
    fk_prepare(&run, &s, HL_PIPELINE_FORWARD);
    run.desc.max_items = MANY;
    run.desc.frame_bytes = 0;
    assert_int_equal(fk_create(&run), HL_OK);
    for (int i = 0; i < MANY; i++)
        items[i] = s.item[0];
    struct hl_frame f = s.frame;
    f.items = items;
    f.n_items = MANY;
    assert_int_equal(hl_frame_draw(run.r, &f, &run.stats), HL_OK);
    assert_int_equal(rec.n, 3);
    static const char *const parts[3] = { "(clear)", "(keep)",
                                          "(keep,resolve)" };
    static const char *const draws[3] = { "draws=4096", "draws=4096",
                                          "draws=808" };
    for (int i = 0; i < 3; i++) {
        assert_non_null(strstr(rec.text[i], parts[i]));
        assert_non_null(strstr(rec.text[i], i ? "d0=" : "(clear) d0="));
        assert_non_null(strstr(rec.text[i], i ? "(keep) draws" :
                                            "(clear) draws"));
        assert_non_null(strstr(rec.text[i], draws[i]));
    }
    assert_int_equal(run.stats.draws, MANY);
    assert_int_equal(run.stats.items, MANY);
    fk_destroy(&run);
    fk_end(&s);
    ck_close(&m);
    free(items);
}

/* Every size and ratio has whole targets, tiles to their edges and capacity
 * for its lists. */
static void odd_sizes_are_sizes(void **state)
{
    (void)state;
    struct ck_machine m;
    uint64_t seed = 3;
    assert_true(ck_open(&m, "null", NULL));
    struct fk_scene s;
    fk_begin(&s, &m);
    fk_room(&s, 12, &seed);
    for (uint32_t w = 1; w <= 67; w += 3)
        for (uint32_t h = 1; h <= 67; h += 6)
            for (int path = HL_LIGHT_PATH_RECTS; path <= HL_LIGHT_PATH_LISTS;
                 path++) {
                struct fk_run run;
                s.needs.width = w;
                s.needs.height = h;
                s.needs.light_width = (w * h + 11) % 67 + 1;
                s.needs.light_height = (w + h * 7) % 67 + 1;
                s.needs.tile = 8 + (w * 5 + h) % 60;
                s.needs.light_path = (enum hl_light_path)path;
                fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
                run.desc.frame_bytes = 1 << 18;
                run.desc.list_bytes = 1 << 18;
                assert_int_equal(fk_create(&run), HL_OK);
                assert_int_equal(hl_frame_draw(run.r, &s.frame, NULL), HL_OK);
                fk_destroy(&run);
            }
    fk_end(&s);
    ck_close(&m);
}

static void statistics_count(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    fk_begin(&s, ck_machine(state));
    fk_add(&s, FK_BOX, FK_PLAIN, 0, 0, 0, 1);
    fk_add(&s, FK_BOX, FK_PLAIN, 0, 0, 50, 1);        /* behind the camera   */
    fk_add(&s, FK_QUAD, FK_BLENDED, 0, 0, 2, 1);
    for (int i = 0; i < 20; i++)
        fk_light(&s, 0, 0, 1.5f, 3);
    fk_light(&s, 0, 0, 60, 3);                        /* behind the camera   */
    fk_light(&s, 0, 0, 1.5f, 0);                      /* no light            */
    fk_prepare(&run, &s, HL_PIPELINE_FORWARD);
    assert_int_equal(fk_create(&run), HL_OK);
    struct hl_counts a = hl_device_counts(s.m->device);
    assert_int_equal(hl_frame_draw(run.r, &s.frame, &run.stats), HL_OK);
    struct hl_counts b = hl_device_counts(s.m->device);
    assert_int_equal(run.stats.items, 2);
    assert_int_equal(run.stats.items_culled, 1);
    assert_int_equal(run.stats.lights, 20);
    assert_int_equal(run.stats.lights_culled, 2);
    /* The box by 8, 8 and 4 lights, the quad by a list of 20. */
    assert_int_equal(run.stats.draws, 4);
    assert_int_equal(b.draws - a.draws, 4);
    assert_int_equal(run.stats.blends, 3);
    assert_int_equal(run.stats.light_refs, 40);
    fk_destroy(&run);
    fk_prepare(&run, &s, HL_PIPELINE_FORWARD_MULTIPASS);
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_draw(run.r, &s.frame, &run.stats), HL_OK);
    assert_int_equal(run.stats.draws, 1 + 20 + 1);
    assert_int_equal(run.stats.blends, 21);
    fk_destroy(&run);
    fk_end(&s);
}

#define BOTH(name) \
    CK_ON("null", name), CK_ON("vulkan", name), CK_ON("gl", name), \
    CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        BOTH(descs_are_checked),
        BOTH(memory_is_what_was_asked_for),
        BOTH(destroying_leaves_nothing),
        BOTH(bad_lights_are_named_by_index),
        BOTH(bad_items_and_cameras_are_named),
        cmocka_unit_test(own_stages_need_their_blocks),
        BOTH(more_than_was_stated_is_refused),
        BOTH(capacities_that_run_out_are_named),
        BOTH(inspecting_is_checked),
        cmocka_unit_test(any_call_may_fail),
        cmocka_unit_test(passes_are_the_plans),
        cmocka_unit_test(long_passes_are_split),
        cmocka_unit_test(odd_sizes_are_sizes),
        BOTH(statistics_count),
    };
    return cmocka_run_group_tests_name("frames", tests, NULL, NULL);
}
