/* SPDX-License-Identifier: Zlib */
/* Frames by the rules of consoles on machines that stand in for them: packed
 * pairs, numbers in place of words, fixed point light, depth copies. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "platforms/cli/readback.h"
#include "tests/frame_kit.h"
#include "tests/stage_kernels.h"

static const uint32_t own_spirv[] = {
#include "own_taps_frag.x"
};
static const char own_glsl[] = {
#include "own_taps_frag_glsl.x"
};

enum { N = FK_W * FK_H };

/* What one profile makes of a scene. */
struct look {
    struct hl_plan plan;
    float *picture;
    uint8_t rejects[N];
    float lights[N];             /* of the L-buffer                          */
};

/* Any format, which ck_read does not know. */
static float *draw_and_read(struct fk_run *run)
{
    struct hl_device *d = run->scene->m->device;
    struct hlc_texels t;
    float *picture = malloc(N * 4 * sizeof *picture);
    assert_non_null(picture);
    assert_int_equal(hl_frame_draw(run->r, &run->scene->frame, NULL), HL_OK);
    assert_int_equal(hlc_texels_read(&t, d, hl_renderer_output(run->r)),
                     HL_OK);
    for (size_t i = 0; i < N; i++)
        hlc_texel(picture + 4 * i, &t, i);
    hlc_texels_free(&t);
    return picture;
}

typedef void (*change)(struct fk_scene *);

static void nothing(struct fk_scene *s) { (void)s; }
/* Where steps of 65535 would give two ids one code of signed numbers. */
static void high_ids(struct fk_scene *s)
{
    for (uint32_t i = 0; i < s->frame.n_items; i++)
        s->item[i].id_base += 32767 - s->frame.n_items / 2;
}
static void bound(struct fk_scene *s) { s->needs.light_depth_bound = true; }

static void look_at(struct look *l, const char *backend, const char *profile,
                    change arrange)
{
    struct ck_machine m;
    static struct fk_scene s;
    struct fk_run run;
    uint64_t seed = 5;
    uint32_t w, h;
    ck_open_as(&m, backend, profile);
    fk_begin(&s, &m);
    fk_room(&s, 40, &seed);
    s.needs.light_width = 100;
    s.needs.light_height = 56;
    arrange(&s);
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    l->plan = run.plan;
    assert_string_equal(run.plan.profile, profile);
    /* The last is blended, which the colour target here need not be. */
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    l->picture = draw_and_read(&run);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_REJECTS,
                                      l->rejects, sizeof l->rejects), HL_OK);
    hl_inspect_size(run.r, HL_INSPECT_LIGHTS, &w, &h);
    assert_int_equal(hl_frame_inspect(run.r, &s.frame, HL_INSPECT_LIGHTS,
                                      l->lights, (size_t)w * h * 4), HL_OK);
    fk_destroy(&run);
    fk_end(&s);
    ck_close(&m);
}

/* The backend of a row, or a skip where it has no device. */
static const char *backend_of(void **state)
{
    return ck_machine(state)->backend->name;
}

/* ---- pictures ----------------------------------------------------------- */

static float peak(const float *picture)
{
    float most = 0;
    for (int i = 0; i < N * 4; i++)
        if (i % 4 < 3 && picture[i] > most)
            most = picture[i];
    return most;
}

/* A share of the pixels may take other taps: at depths and slopes where a
 * tap's step of depth decides. All others differ by the light's encoding
 * (its predicted error, of the brightest there is), by normals (16 bits: half
 * a code, 2 d / cos 45 degrees, of the brightest), and by two roundings to
 * half floats, or one to 7e3 ones of 8 bits. */
static void compare(const struct look *a, const struct look *b,
                    double encoding)
{
    enum hl_format color = hl_plan_target(&b->plan, HL_ROLE_COLOR)->format;
    double most = (double)peak(a->picture);
    double rounding = color == HL_FORMAT_RGB10A2_FLOAT ? 1.0 / 256 : 0;
    double limit = most * (encoding + 4.4e-5 + 2.0 / 1024 + rounding);
    uint32_t taps = 0, off = 0;
    double worst = 0;
    for (int i = 0; i < N; i++) {
        if (a->rejects[i] != b->rejects[i]) {
            taps++;
            continue;
        }
        double e = fk_difference(a->picture + 4 * i, b->picture + 4 * i, 1);
        worst = e > worst ? e : worst;
        off += e <= limit ? 0 : 1;
    }
    print_message("%s: %u of %d pixels have other taps, %u are off, worst "
                  "%.2g of %.2g\n", b->plan.profile, taps, N, off, worst,
                  limit);
    assert_true(taps <= N / 1000);
    assert_int_equal(off, 0);
}

static void frames_are_the_natives(void **state)
{
    static const char *const profiles[] = { "dx10", "ps3", "xbox360" };
    static struct look native, l;
    const char *backend = backend_of(state);
    look_at(&native, backend, "native", high_ids);
    assert_false(native.plan.float_taps);
    for (int i = 0; i < 3; i++) {
        look_at(&l, backend, profiles[i], high_ids);
        assert_true(l.plan.float_taps);
        compare(&native, &l, (double)l.plan.light_error);
        assert_memory_equal(native.lights, l.lights, sizeof l.lights);
        free(l.picture);
    }
    free(native.picture);
}

/* ---- background --------------------------------------------------------- */

/* Every texel of a pair's target is x, y: within half a code. */
static void all_are(struct fk_run *run, enum hl_role role, double x, double y)
{
    struct hlc_texels t;
    assert_int_equal(hlc_texels_read(&t, run->scene->m->device,
                                     hl_renderer_target(run->r, role)),
                     HL_OK);
    for (size_t i = 0; i < (size_t)t.width * t.height; i++) {
        float v[4], pair[2];
        hlc_texel(v, &t, i);
        hlc_two16(pair, run->plan.two16, v);
        ck_near((double)pair[0], x, 0.5 / 65535);
        ck_near((double)pair[1], y, 0.5 / 65535);
    }
    hlc_texels_free(&t);
}

/* Normal (0, 0, 1), depth far, no region: however they are kept. */
static void background_is_packed_alike(void **state)
{
    static const char *const profiles[] = { "native", "dx10", "ps3",
                                            "xbox360" };
    static struct fk_scene s;
    const char *backend = backend_of(state);
    for (int i = 0; i < 4; i++) {
        struct ck_machine m;
        struct fk_run run;
        ck_open_as(&m, backend, profiles[i]);
        fk_begin(&s, &m);
        fk_light(&s, 0, 0, 0, 1);    /* without any there is no G-buffer     */
        fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
        run.desc.n_surfaces = FK_BLENDED;
        assert_int_equal(fk_create(&run), HL_OK);
        free(draw_and_read(&run));
        all_are(&run, HL_ROLE_NORMAL, 0.5, 0.5);
        all_are(&run, HL_ROLE_DSF, 1, 0);
        fk_destroy(&run);
        fk_end(&s);
        ck_close(&m);
    }
}

/* ---- depth that is bound while it is read ------------------------------- */

static void the_same(const struct look *a, const struct look *b)
{
    assert_memory_equal(a->picture, b->picture, N * 4 * sizeof *a->picture);
    free(b->picture);
}

/* The copy is the same numbers; so is what a read-only target reads. */
static void bound_depth_is_copied_or_read(void **state)
{
    static const char *const profiles[] = { "native", "dx10", "ps3" };
    static struct look free_depth, l;
    const char *backend = backend_of(state);
    for (int i = 0; i < 3; i++) {
        look_at(&free_depth, backend, profiles[i], nothing);
        look_at(&l, backend, profiles[i], bound);
        bool copied = hl_plan_target(&l.plan, HL_ROLE_DEPTH_COPY) != NULL;
        assert_int_equal(copied, i == 1);
        the_same(&free_depth, &l);
        free(free_depth.picture);
    }
}

/* ---- an embedder's own stage -------------------------------------------- */

static struct hl_code own_code = { own_spirv, sizeof own_spirv, own_glsl,
                                   NULL };

static void all_white(struct fk_scene *s)
{
    for (uint32_t i = 0; i < s->frame.n_items; i++) {
        struct hl_material *m = fk_material(s, &s->item[i]);
        s->item[i].surface = FK_PLAIN;
        for (int k = 0; k < 3; k++)
            m->base[k] = 1;
        memset(m->emission, 0, sizeof m->emission);
        m->metallic = 0;
        m->no_specular = true;
    }
}

static void all_own(struct fk_scene *s)
{
    static const float tint[4] = { 1, 1, 1, 1 };
    all_white(s);
    own_code.kernel = own_taps_kernel();
    s->surface[FK_PLAIN].own_material = &own_code;
    for (uint32_t i = 0; i < s->frame.n_items; i++) {
        s->item[i].material_block = tint;
        s->item[i].material_bytes = sizeof tint;
    }
}

/* e + rho A + rho D of a white surface in another order of sums: two
 * roundings of floats, and then of halves, which may be neighbours. */
static void own_stages_read_numbers(void **state)
{
    static struct look built, own;
    const char *backend = backend_of(state);
    look_at(&built, backend, "ps3", all_white);
    look_at(&own, backend, "ps3", all_own);
    for (int i = 0; i < N; i++) {
        const float *p = built.picture + 4 * i;
        double most = (double)fmaxf(p[0], fmaxf(p[1], p[2]));
        assert_true(fk_difference(p, own.picture + 4 * i, 1) <=
                    most / 1024 + 1e-6);
    }
    free(built.picture);
    free(own.picture);
}

/* ---- half a pixel ------------------------------------------------------- */

enum { SIDE = 8 };

/* A quad from (2.75, 1.75) to (5.75, 4.75) pixels, as drawn with shifts. */
static void draw_quad(struct ck_machine *m, float shift, float *px)
{
    const float a = 2.75f / SIDE * 2 - 1, b = 5.75f / SIDE * 2 - 1;
    const float c = 1.75f / SIDE * 2 - 1, d = 4.75f / SIDE * 2 - 1;
    const float v[6][3] = { { a, c, 0.5f }, { b, c, 0.5f }, { b, d, 0.5f },
                            { a, c, 0.5f }, { b, d, 0.5f }, { a, d, 0.5f } };
    static uint8_t block[1024 + HL_LIGHTS_BYTES];
    struct hl_object_block o;
    struct hl_prog_desc p = {
        .vertex = { HL_SHADER_MESH_ID_VERT, NULL },
        .fragment = { HL_SHADER_COUNT_FRAG, NULL }, .n_colors = 1,
        .color = { HL_FORMAT_R32_FLOAT }, .n_specs = shift != 0 ? 2 : 0 };
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = o.clip.column[1].y = 1;
    o.clip.column[2].z = o.clip.column[3].w = 1;
    memset(block, 0, sizeof block);
    memcpy(block, &o, sizeof o);
    *(float *)(void *)(block + 1024) = 1;
    p.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
    p.layout.stride[0] = 12;
    for (uint32_t i = 0; i < 2; i++) {
        p.spec[i].id = i ? HL_SPEC_SHIFT_Y : HL_SPEC_SHIFT_X;
        memcpy(&p.spec[i].value, &shift, sizeof shift);
    }
    struct hl_buf_desc vd = { "v", sizeof v, HL_BUF_VERTEX, false, v };
    struct hl_buf_desc ud = { "u", sizeof block, HL_BUF_UNIFORM, false,
                              block };
    struct hl_tex_desc td = { .format = HL_FORMAT_R32_FLOAT, .width = SIDE,
                              .height = SIDE,
                              .usage = HL_TEX_TARGET | HL_TEX_READBACK };
    struct hl_draw draw = { .count = 6 };
    struct hl_pass pass = { .label = "quad", .n_colors = 1, .draws = &draw,
                            .n_draws = 1 };
    hl_buf u;
    pass.color[0].load = HL_LOAD_CLEAR;
    assert_int_equal(hl_buf_create(m->device, &draw.vertex[0], &vd), HL_OK);
    assert_int_equal(hl_buf_create(m->device, &u, &ud), HL_OK);
    assert_int_equal(hl_tex_create(m->device, &pass.color[0].tex, &td),
                     HL_OK);
    assert_int_equal(hl_prog_create(m->device, &draw.prog, &p), HL_OK);
    for (int i = 0; i < HL_MAX_UNIFORMS; i++) {
        draw.uniform[i].buf = u;
        draw.uniform[i].bytes = 1024;
    }
    draw.uniform[HL_SLOT_LIGHTS].offset = 1024;
    draw.uniform[HL_SLOT_LIGHTS].bytes = HL_LIGHTS_BYTES;
    assert_int_equal(hl_pass_run(m->device, &pass), HL_OK);
    assert_int_equal(hl_tex_read(m->device, pass.color[0].tex, px,
                                 SIDE * SIDE * sizeof *px), HL_OK);
}

/* Pixels whose centre is inside: 3..5 x 2..4; half a pixel left and up of
 * there, that is sampled at whole numbers: 2..4 x 1..3. */
static void vertex_stages_shift_by_half_a_pixel(void **state)
{
    struct ck_machine *m = ck_machine(state);
    for (int k = 0; k < 2; k++) {
        float px[SIDE * SIDE];
        draw_quad(m, k ? -1.0f / SIDE : 0, px);
        for (int i = 0; i < SIDE * SIDE; i++) {
            int x = i % SIDE + k, y = i / SIDE + k;
            bool in = x >= 3 && x <= 5 && y >= 2 && y <= 4;
            assert_true(px[i] == (in ? 1.0f : 0.0f));
        }
    }
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(frames_are_the_natives),
        DRAWN(background_is_packed_alike),
        DRAWN(bound_depth_is_copied_or_read),
        DRAWN(own_stages_read_numbers),
        DRAWN(vertex_stages_shift_by_half_a_pixel),
    };
    return cmocka_run_group_tests_name("frames of consoles", tests, NULL,
                                       NULL);
}
