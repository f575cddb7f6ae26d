/* SPDX-License-Identifier: Zlib */
/* Surfaces and frames as pictures: blended, masked, two-sided, mirrored,
 * multisampled; backgrounds; long passes; frames in flight; pictures of the
 * inside. Numbers are worked out by hand beside each test. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/frame_kit.h"
#include "tests/solid_kernel.h"

static const uint32_t solid_spirv[] = {
#include "solid_frag.x"
};
static const char solid_glsl[] = {
#include "solid_frag_glsl.x"
};

enum { N = FK_W * FK_H, MID_X = FK_W / 2, MID_Y = FK_H / 2 };

/* A half float keeps 11 bits and lavapipe cuts the rest: 2^-10 of a value. */
#define HALF(x) ((x) / 1024.0)

static void emit(struct fk_scene *s, const struct hl_item *it, float r,
                 float g, float b)
{
    struct hl_material *m = fk_material(s, it);
    m->base[0] = m->base[1] = m->base[2] = 0;
    m->emission[0] = r;
    m->emission[1] = g;
    m->emission[2] = b;
}

static void check_color(const float *p, double r, double g, double b)
{
    ck_near((double)p[0], r, HALF(r) + 1e-6);
    ck_near((double)p[1], g, HALF(g) + 1e-6);
    ck_near((double)p[2], b, HALF(b) + 1e-6);
}

/* ---- background ------------------------------------------------------- */

static void nothing_tints_the_background(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    emit(&s, fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 1), 1, 0, 0);
    fk_light(&s, 0, 0, 5, 50);
    for (int c = 0; c < 3; c++) {
        s.frame.background[c] = 0.25f * (float)(c + 1);
        s.frame.ambient[c] = 0.5f;
    }
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        check_color(fk_at(f, 2, 2), 0.25, 0.5, 0.75);
        check_color(fk_at(f, MID_X, MID_Y), 1, 0, 0);
        free(f);
    }
    s.frame.n_items = 0;
    s.frame.n_lights = 0;
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        for (int i = 0; i < N; i++)
            check_color(f + i * 4, 0.25, 0.5, 0.75);
        free(f);
    }
    fk_end(&s);
}

/* out = e + rho (A + D): a quad lit head on by a light 2 m away of radius 4,
 * D = (1 - 1/4)^2 on the axis. */
static void emission_ambient_and_light_add(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    struct hl_material *m =
        fk_material(&s, fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 3));
    m->base[0] = 0.5f;
    m->emission[1] = 0.125f;
    s.frame.ambient[2] = 0.25f;
    fk_light(&s, 0, 0, 2, 4)->color[1] = 2;
    /* The pixel's centre is off the axis by half a pixel. */
    double off = 10 * tan(3.14159265 / 6) / FK_H, d2 = 4 + 2 * off * off;
    double d = (1 - d2 / 16) * (1 - d2 / 16) * 2 / sqrt(d2);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        const float *c = fk_at(f, MID_X, MID_Y);
        /* L-buffer and frame cut once each; five eighths of the texels, 0.2 m
         * wide, interpolate a falloff of second derivative 0.5: 2.5e-3. */
        double e = p == HL_PIPELINE_INFERRED ? 2.5e-3 : 0;
        ck_near((double)c[0], 0.5 * d, HALF(2) * 0.3 + e);
        ck_near((double)c[1], 0.125 + 2 * d, HALF(2) * 1.3 + 2 * e);
        ck_near((double)c[2], 0.25 + d, HALF(2) * 0.9 + e);
        free(f);
    }
    fk_end(&s);
}

/* ---- blended ---------------------------------------------------------- */

static struct hl_item *glass(struct fk_scene *s, float z, float r, float g,
                             float b, float alpha)
{
    struct hl_item *it = fk_add(s, FK_QUAD, FK_BLENDED, 0, 0, z, 2);
    emit(s, it, r, g, b);
    fk_material(s, it)->base[3] = alpha;
    return it;
}

/* Far to near whatever the order of items: ((1 0 0) under 1/2 of (0 1 0))
 * under 1/4 of (0 0 4). */
static void blended_surfaces_lie_over_in_depth_order(void **state)
{
    for (int order = 0; order < 2; order++) {
        struct fk_scene s;
        fk_begin(&s, ck_machine(state));
        emit(&s, fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 3), 1, 0, 0);
        if (order)
            glass(&s, 4, 0, 0, 4, 0.25f);
        glass(&s, 2, 0, 1, 0, 0.5f);
        if (!order)
            glass(&s, 4, 0, 0, 4, 0.25f);
        glass(&s, -2, 9, 9, 9, 1);              /* behind the opaque one     */
        for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
            float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
            /* Two blends more: a rounding each. */
            const float *c = fk_at(f, MID_X, MID_Y);
            ck_near((double)c[0], 0.375, 3 * HALF(0.5));
            ck_near((double)c[1], 0.375, 3 * HALF(0.5));
            ck_near((double)c[2], 1, 3 * HALF(1));
            free(f);
        }
        fk_end(&s);
    }
}

/* A blended surface that is lit forward, by all its lights in one draw, is so
 * in either pipeline, and is no surface for the G-buffer. */
static void blended_surfaces_are_lit_alike(void **state)
{
    struct fk_scene s;
    uint64_t seed = mk_seed();
    fk_begin(&s, ck_machine(state));
    fk_room(&s, 40, &seed);
    struct hl_item *it = fk_add(&s, FK_BALL, FK_BLENDED, 0, 0, 5, 1.5f);
    fk_material(&s, it)->base[3] = 1;           /* hides what is behind      */
    s.needs.max_error = 1e-4f;                  /* 32 bits                   */
    s.needs.translucency = HL_TRANSLUCENCY_FORWARD;
    float *forward = fk_draw(&s, HL_PIPELINE_FORWARD, HL_ROLE_NONE);
    float *inferred = fk_draw(&s, HL_PIPELINE_INFERRED, HL_ROLE_NONE);
    uint32_t inside = 0;
    for (int i = 0; i < N; i++) {
        double x = (i % FK_W - MID_X) / 30.0, y = (i / FK_W - MID_Y) / 30.0;
        if (x * x + y * y > 0.5)
            continue;
        inside++;
        for (int c = 0; c < 3; c++)
            ck_near((double)inferred[i * 4 + c], (double)forward[i * 4 + c],
                    1e-5);
    }
    assert_true(inside > 1000);
    free(forward);
    free(inferred);
    struct fk_run run;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    free(fk_read(&run, HL_ROLE_NONE));
    static uint32_t ids[N];
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS, ids,
                                      sizeof ids), HL_OK);
    for (int i = 0; i < N; i++)
        assert_int_not_equal(ids[i] >> 16, s.frame.n_items);
    fk_destroy(&run);
    fk_end(&s);
}

/* ---- masked ----------------------------------------------------------- */

/* Alpha 255 in the left half of the texture, 0 in the right. */
static hl_tex half_texture(struct ck_machine *m)
{
    uint8_t texel[8 * 8][4];
    struct hl_tex_desc d = { .format = HL_FORMAT_RGBA8_SRGB, .width = 8,
                             .height = 8 };
    hl_tex t;
    memset(texel, 255, sizeof texel);
    for (int i = 0; i < 64; i++)
        texel[i][3] = i % 8 < 4 ? 255 : 0;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    assert_int_equal(hl_tex_write(m->device, t, 0, texel, sizeof texel),
                     HL_OK);
    return t;
}

static void masked_surfaces_are_there_or_not(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_MASKED, 0, 0, 0, 3);
    it->texture[0].tex = half_texture(s.m);
    emit(&s, it, 1, 1, 0);
    fk_material(&s, it)->base[3] = 0.75f;
    emit(&s, fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, -1, 3), 0, 0, 1);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        check_color(fk_at(f, MID_X - 12, MID_Y), 1, 1, 0);
        check_color(fk_at(f, MID_X + 12, MID_Y), 0, 0, 1);
        free(f);
        fk_material(&s, it)->alpha_cutoff = 0.76f;
        f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        check_color(fk_at(f, MID_X - 12, MID_Y), 0, 0, 1);
        free(f);
        fk_material(&s, it)->alpha_cutoff = 0.75f;       /* >= is drawn      */
        f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        check_color(fk_at(f, MID_X - 12, MID_Y), 1, 1, 0);
        free(f);
        fk_material(&s, it)->alpha_cutoff = 0.5f;
    }
    hl_tex_destroy(s.m->device, &it->texture[0].tex);
    fk_end(&s);
}

/* sRGB texture times linear factor times vertex colour. */
static void textures_and_colours_multiply(void **state)
{
    struct fk_scene s;
    uint8_t texel[4] = { 188, 255, 0, 255 };
    struct hl_tex_desc d = { .format = HL_FORMAT_RGBA8_SRGB, .width = 1,
                             .height = 1 };
    fk_begin(&s, ck_machine(state));
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_FULL, 0, 0, 0, 3);
    hl_tex *t = &it->texture[0].tex;
    assert_int_equal(hl_tex_create(s.m->device, t, &d), HL_OK);
    assert_int_equal(hl_tex_write(s.m->device, *t, 0, texel, 4), HL_OK);
    fk_material(&s, it)->base[1] = 0.5f;
    for (int c = 0; c < 3; c++)
        s.frame.ambient[c] = 1;
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *f = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        const float *c = fk_at(f, MID_X, MID_Y);
        /* ((188 / 255 + 0.055) / 1.055)^2.4, by tables of 8 or more bits. */
        ck_near((double)c[0], 0.5029, 2e-3);
        ck_near((double)c[1], 0.5, 2e-3);
        ck_near((double)c[2], 0, 1e-6);
        free(f);
    }
    hl_tex_destroy(s.m->device, t);
    fk_end(&s);
}

/* ---- sides ------------------------------------------------------------ */

static void turn_around(struct hl_item *it)
{
    it->world[0] = -it->world[0];               /* half a turn about y       */
    it->world[10] = -it->world[10];
}

/* Seen from behind a two-sided quad is lit on the side that is seen. */
static void back_faces_turn_or_vanish(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    fk_light(&s, 0, 0, 4, 8);
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_TWO_SIDED, 0, 0, 0, 3);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *front = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        turn_around(it);
        float *back = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        it->surface = FK_PLAIN;
        float *none = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        assert_true(fk_at(front, MID_X, MID_Y)[0] > 0.4f);
        /* The normal's x and y come back negated: half a code each. */
        assert_true(fk_difference(front, back, N) < 2e-3);
        check_color(fk_at(none, MID_X, MID_Y), 0, 0, 0);
        it->surface = FK_TWO_SIDED;
        turn_around(it);
        free(front);
        free(back);
        free(none);
    }
    fk_end(&s);
}

/* A ball mirrored in x is the same ball: same pixels, light and all. */
static void mirrored_items_are_not_inside_out(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    fk_light(&s, 3, 2, 4, 12);
    struct hl_item *it = fk_add(&s, FK_BALL, FK_PLAIN, 0, 0, 0, 3);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        float *plain = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        it->surface = FK_MIRRORED;
        it->world[0] = -it->world[0];
        float *mirrored = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        assert_true(fk_at(plain, MID_X, MID_Y)[0] > 0.2f);
        double sum = 0;
        for (int i = 0; i < N * 4; i++)
            sum += fabs((double)plain[i] - (double)mirrored[i]) / (N * 3);
        /* Triangles are split along the other diagonal, so that normals and
         * edges are slightly others. */
        assert_true(sum < 2e-3);
        assert_true(fk_at(mirrored, MID_X, MID_Y)[0] > 0.2f);
        it->surface = FK_PLAIN;
        it->world[0] = -it->world[0];
        free(plain);
        free(mirrored);
    }
    fk_end(&s);
}

/* ---- samples ---------------------------------------------------------- */

/* A tilted edge: interior and background as with one sample, pixels of the
 * edge are quarters. */
static void samples_resolve_to_quarters(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 2);
    emit(&s, it, 1, 1, 1);
    it->world[0] = it->world[5] = 2 * cosf(0.4f);
    it->world[1] = 2 * sinf(0.4f);
    it->world[4] = -2 * sinf(0.4f);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        s.needs.samples = 1;
        float *one = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        s.needs.samples = 4;
        float *four = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        uint32_t part[5] = { 0 }, far_off = 0;
        for (int i = 0; i < N; i++) {
            double quarters = (double)four[i * 4] * 4;
            assert_true(quarters == floor(quarters) && quarters <= 4);
            part[(int)quarters]++;
            far_off += (one[i * 4] == 1) != (quarters >= 2) &&
                       (quarters == 0 || quarters == 4);
        }
        print_message("%u %u %u %u %u pixels by quarters\n", part[0], part[1],
                      part[2], part[3], part[4]);
        /* Four edges of 34 pixels. */
        assert_true(part[1] > 10 && part[2] > 0 && part[3] > 10);
        assert_true(part[4] > 900);
        assert_int_equal(far_off, 0);
        free(one);
        free(four);
    }
    fk_end(&s);
}

/* Inside surfaces four samples change nothing but the filter's exactness.
 * Without centroids, which move with the edges of triangles: tests/test_msaa.c
 * says by how much. */
static void samples_keep_the_inside(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    s.needs.no_centroid = true;
    fk_light(&s, 1, 1, 3, 10);
    fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        s.needs.samples = 1;
        float *one = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        s.needs.samples = 4;
        float *four = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
        /* The mean of four equal halves, rounded once more. */
        assert_true(fk_difference(one, four, N) <= HALF(1.0));
        free(one);
        free(four);
    }
    fk_end(&s);
}

/* ---- many draws, many frames ------------------------------------------ */

/* One plane of 5,000 quads is the plane of one quad. */
static void long_passes_draw_the_same_picture(void **state)
{
    enum { NX = 100, NY = 50 };
    struct fk_scene s;
    struct ck_machine *m = ck_machine(state);
    struct hl_item *items = malloc(NX * NY * sizeof *items);
    assert_non_null(items);
    fk_begin(&s, m);
    fk_light(&s, 1, 1, 3, 12);
    fk_light(&s, -4, 0, 2, 12);
    struct hl_item *one = fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 1);
    for (int i = 0; i < NX * NY; i++) {
        items[i] = *one;                 /* 3/16 of a metre: exact           */
        items[i].world[0] = items[i].world[5] = 0.09375f;
        items[i].world[12] = (float)(2 * (i % NX) + 1 - NX) * 0.09375f;
        items[i].world[13] = (float)(2 * (i / NX) + 1 - NY) * 0.09375f;
    }
    one->world[0] = NX * 0.09375f;
    one->world[5] = NY * 0.09375f;
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        for (uint32_t samples = 1; samples <= 4; samples *= 4) {
            struct fk_run run;
            s.needs.samples = samples;
            s.needs.no_centroid = true;  /* edges are elsewhere              */
            s.needs.max_error = 1e-4f;
            float *whole = fk_draw(&s, (enum hl_pipeline)p, HL_ROLE_NONE);
            struct hl_frame keep = s.frame;
            fk_prepare(&run, &s, (enum hl_pipeline)p);
            s.frame.items = items;
            s.frame.n_items = NX * NY;
            run.desc.max_items = NX * NY;
            run.desc.frame_bytes = 1 << 26;
            assert_int_equal(fk_create(&run), HL_OK);
            float *parts = fk_read(&run, HL_ROLE_NONE);
            assert_true(run.stats.draws > 4096);
            /* Positions of a hundredth of the size round a hundredth as far;
             * the light's own error in 16 bits is the plan's. */
            assert_true(fk_at(parts, MID_X, MID_Y)[0] > 0.3f);
            assert_true(fk_difference(whole, parts, N) < 2e-3);
            s.frame = keep;
            free(whole);
            free(parts);
            fk_destroy(&run);
        }
    free(items);
    fk_end(&s);
}

static void move(struct fk_scene *s, int frame)
{
    const float eye[3] = { 0.3f * (float)frame, 0.1f * (float)frame, 10 };
    const float target[3] = { 0, 0, 0 };
    assert_int_equal(hl_camera_look_at(&s->frame.camera, eye, target, 60,
                                       0.1f, 100), HL_OK);
    s->light[0].radius = 3 + (float)frame;
}

/* Adds each frame to what came before, on the device: the only way to see
 * frames that are never waited for. */
struct sum {
    hl_tex tex;
    hl_prog prog;
    hl_buf one, zero;
};

static void sum_begin(struct sum *u, struct fk_scene *s)
{
    static struct hl_code code = { solid_spirv, sizeof solid_spirv,
                                   solid_glsl, NULL };
    const float one[4] = { 1, 1, 1, 1 }, zero[4] = { 0, 0, 0, 0 };
    struct hl_device *d = s->m->device;
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA32_FLOAT, .width = FK_W,
                             .height = FK_H,
                             .usage = HL_TEX_TARGET | HL_TEX_READBACK };
    struct hl_prog_desc p = {
        .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_NONE, &code }, .n_colors = 1,
        .color = { HL_FORMAT_RGBA32_FLOAT }, .blend = HL_BLEND_ADD };
    struct hl_buf_desc a = { "one", 16, HL_BUF_UNIFORM, false, one };
    struct hl_buf_desc b = { "zero", 16, HL_BUF_STORAGE, false, zero };
    code.kernel = solid_kernel();
    assert_int_equal(hl_tex_create(d, &u->tex, &t), HL_OK);
    assert_int_equal(hl_prog_create(d, &u->prog, &p), HL_OK);
    assert_int_equal(hl_buf_create(d, &u->one, &a), HL_OK);
    assert_int_equal(hl_buf_create(d, &u->zero, &b), HL_OK);
}

static void sum_add(struct sum *u, struct hl_device *d, hl_tex frame,
                    bool first)
{
    struct hl_texture_binding texture = { .tex = frame };
    struct hl_draw draw = { .prog = u->prog, .count = 3,
                            .uniform = { { u->one, 0, 16 } },
                            .storage = { { u->zero, 0, 16 } },
                            .textures = &texture, .n_textures = 1 };
    struct hl_pass pass = { .n_colors = 1, .draws = &draw, .n_draws = 1 };
    pass.color[0].tex = u->tex;
    pass.color[0].load = first ? HL_LOAD_CLEAR : HL_LOAD_KEEP;
    assert_int_equal(hl_pass_run(d, &pass), HL_OK);
}

static void sum_end(struct sum *u, struct hl_device *d)
{
    hl_tex_destroy(d, &u->tex);
    hl_prog_destroy(d, &u->prog);
    hl_buf_destroy(d, &u->one);
    hl_buf_destroy(d, &u->zero);
}

static float *sum_of_frames(struct fk_scene *s, enum hl_pipeline pipeline,
                            bool wait)
{
    enum { COUNT = 7 };
    struct fk_run run;
    struct sum u;
    struct hl_device *d = s->m->device;
    move(s, 0);
    fk_prepare(&run, s, pipeline);
    assert_int_equal(fk_create(&run), HL_OK);
    sum_begin(&u, s);
    for (int i = 0; i < COUNT; i++) {
        move(s, i);
        assert_int_equal(hl_frame_draw(run.r, &s->frame, NULL), HL_OK);
        sum_add(&u, d, hl_renderer_output(run.r), i == 0);
        assert_int_equal(hl_submit(d, wait), HL_OK);
    }
    float *f = ck_read(d, u.tex, NULL, NULL);
    sum_end(&u, d);
    fk_destroy(&run);
    return f;
}

static void frames_in_flight_do_not_mix(void **state)
{
    static const enum hl_light_path paths[] = { HL_LIGHT_PATH_RECTS,
        HL_LIGHT_PATH_TILES, HL_LIGHT_PATH_LISTS };
    for (int p = 1; p < HL_PIPELINE_COUNT; p++)
        for (int k = 0; k < (p == HL_PIPELINE_INFERRED ? 3 : 1); k++) {
            struct fk_scene s;
            uint64_t seed = 7;
            fk_begin(&s, ck_machine(state));
            fk_room(&s, 30, &seed);
            fk_add(&s, FK_BALL, FK_BLENDED, 0, 0, 4, 1);
            s.needs.light_path = paths[k];
            s.needs.no_tile_depth = true;       /* it would wait each frame  */
            float *flying = sum_of_frames(&s, (enum hl_pipeline)p, false);
            float *waited = sum_of_frames(&s, (enum hl_pipeline)p, true);
            assert_memory_equal(flying, waited, N * 16);
            free(flying);
            free(waited);
            fk_end(&s);
        }
}

static void a_frame_drawn_twice_is_the_same_bits(void **state)
{
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        struct fk_scene s;
        struct fk_run run;
        uint64_t seed = 9;
        fk_begin(&s, ck_machine(state));
        fk_room(&s, 30, &seed);
        fk_prepare(&run, &s, (enum hl_pipeline)p);
        assert_int_equal(fk_create(&run), HL_OK);
        float *a = fk_read(&run, HL_ROLE_NONE);
        float *b = fk_read(&run, HL_ROLE_NONE);
        assert_memory_equal(a, b, N * 16);
        free(a);
        free(b);
        fk_destroy(&run);
        fk_end(&s);
    }
}

/* ---- inside ----------------------------------------------------------- */

/* Item 0 left, item 1 (a box: the face +z is group 4) right, of which both
 * are nearer than item 2, which fills the rest. */
static void ids_are_the_true_ones(void **state)
{
    static uint32_t ids[N];
    for (int p = 1; p < HL_PIPELINE_COUNT; p++) {
        struct fk_scene s;
        struct fk_run run;
        fk_begin(&s, ck_machine(state));
        fk_add(&s, FK_QUAD, FK_PLAIN, -3, 0, 0, 1)->id_base = 5;
        fk_add(&s, FK_BOX, FK_PLAIN, 3, 0, 0, 1)->id_base = 5;
        fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, -3, 4)->id_base = 60000;
        fk_prepare(&run, &s, (enum hl_pipeline)p);
        assert_int_equal(fk_create(&run), HL_OK);
        free(fk_read(&run, HL_ROLE_NONE));
        assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_IDS,
                                          ids, sizeof ids), HL_OK);
        /* A metre at depth 10 is 7.8 pixels. */
        assert_int_equal(ids[MID_Y * FK_W + MID_X - 23], 1 << 16);
        assert_int_equal(ids[MID_Y * FK_W + MID_X + 25], 2 << 16 | 4);
        assert_int_equal(ids[MID_Y * FK_W + MID_X], 3 << 16);
        assert_int_equal(ids[0], 0);
        fk_destroy(&run);
        fk_end(&s);
    }
}

/* One light near the middle of the picture: pixels in its reach are shaded
 * with it, pixels far off are not where anything bounds it. */
static void light_evaluations_are_counted(void **state)
{
    static float count[N];
    static const struct {
        enum hl_pipeline pipeline;
        enum hl_light_path path;
        float far_off;
    } row[] = {
        { HL_PIPELINE_FORWARD, 0, 2 }, { HL_PIPELINE_FORWARD_MULTIPASS, 0, 0 },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_RECTS, 0 },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_TILES, 0 },
        { HL_PIPELINE_INFERRED, HL_LIGHT_PATH_LISTS, 0 },
    };
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct fk_scene s;
        struct fk_run run;
        uint32_t w, h;
        fk_begin(&s, ck_machine(state));
        fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
        fk_light(&s, 0, 0, 0.5f, 1);
        fk_light(&s, 0, 0, 0.5f, 1);
        s.needs.light_path = row[i].path;
        s.needs.light_width = FK_W;
        s.needs.light_height = FK_H;
        fk_prepare(&run, &s, row[i].pipeline);
        assert_int_equal(fk_create(&run), HL_OK);
        free(fk_read(&run, HL_ROLE_NONE));
        hl_inspect_size(run.r, HL_INSPECT_LIGHTS, &w, &h);
        assert_true(w == FK_W && h == FK_H);
        assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_LIGHTS,
                                          count, sizeof count), HL_OK);
        assert_true(count[MID_Y * FK_W + MID_X] == 2);
        assert_true(count[2 * FK_W + 2] == row[i].far_off);
        fk_destroy(&run);
        fk_end(&s);
    }
}

/* A step between two planes of one id: pixels beside it lose taps, pixels of
 * the planes none, pixels of the background are 0. */
static void rejected_taps_are_seen(void **state)
{
    static uint8_t taps[N];
    struct fk_scene s;
    struct fk_run run;
    uint32_t seen[6] = { 0 };
    fk_begin(&s, ck_machine(state));
    fk_light(&s, 0, 0, 0, 1);            /* none: nothing would be filtered  */
    fk_add(&s, FK_QUAD, FK_PLAIN, -4, 0, 0, 4)->id_base = 1;
    fk_add(&s, FK_QUAD, FK_PLAIN, 4, 0, -2, 4)->id_base = 1;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    free(fk_read(&run, HL_ROLE_NONE));
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_REJECTS,
                                      taps, sizeof taps), HL_OK);
    for (int i = 0; i < N; i++) {
        assert_true(taps[i] <= 5);
        seen[taps[i]]++;
    }
    assert_int_equal(taps[MID_Y * FK_W + MID_X - 20], 1);
    assert_int_equal(taps[MID_Y * FK_W + MID_X + 20], 1);
    assert_int_equal(taps[0], 0);
    /* At the step two of four taps are of the other plane. */
    assert_true(seen[3] > 20);
    assert_int_equal(seen[5], 0);
    print_message("taps rejected: none %u, 1 %u, 2 %u, 3 %u, 4 %u\n", seen[1],
                  seen[2], seen[3], seen[4], seen[5]);
    fk_destroy(&run);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(nothing_tints_the_background),
        DRAWN(emission_ambient_and_light_add),
        DRAWN(blended_surfaces_lie_over_in_depth_order),
        DRAWN(blended_surfaces_are_lit_alike),
        DRAWN(masked_surfaces_are_there_or_not),
        DRAWN(textures_and_colours_multiply),
        DRAWN(back_faces_turn_or_vanish),
        DRAWN(mirrored_items_are_not_inside_out),
        DRAWN(samples_resolve_to_quarters),
        DRAWN(samples_keep_the_inside),
        DRAWN(long_passes_draw_the_same_picture),
        DRAWN(frames_in_flight_do_not_mix),
        DRAWN(a_frame_drawn_twice_is_the_same_bits),
        DRAWN(ids_are_the_true_ones),
        DRAWN(light_evaluations_are_counted),
        DRAWN(rejected_taps_are_seen),
    };
    return cmocka_run_group_tests_name("surfaces of frames", tests, NULL,
                                       NULL);
}
