/* SPDX-License-Identifier: Zlib */
/* Multisampled frames over a single-sampled L-buffer, at every count that a
 * machine has: where light is read at edges, and what is never averaged. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "hal/backend.h"
#include "tests/frame_kit.h"
#include "tests/stage_kernels.h"

static const uint32_t own_spirv[] = {
#include "own_taps_frag.x"
};
static const char own_glsl[] = {
#include "own_taps_frag_glsl.x"
};

enum { N = FK_W * FK_H };

/* A pixel at depth 10, where strips are, metres. */
static const float pixel = 2 * 10 * 0.57735027f / FK_H;

/* The next count above n that frames may have here, 0 after the last. */
static uint32_t next_count(const struct fk_scene *s, uint32_t n)
{
    const struct hl_caps *c = hl_device_caps(s->m->device);
    uint32_t both = c->samples & (c->profile.samples ? c->profile.samples
                                                     : 15u);
    for (n *= 2; n <= 8; n *= 2)
        if (both & n)
            return n;
    return 0;
}

static float *picture(struct fk_scene *s, enum hl_pipeline p, bool centroid)
{
    struct fk_run run;
    s->needs.no_centroid = !centroid;
    fk_prepare(&run, s, p);
    /* The last is blended, which the colour target of a console need not be. */
    run.desc.n_surfaces = FK_BLENDED;
    assert_int_equal(fk_create(&run), HL_OK);
    float *out = fk_read(&run, HL_ROLE_NONE);
    fk_destroy(&run);
    return out;
}

/* ---- light at edges ----------------------------------------------------- */

enum { TILT = 60 };          /* of strips, degrees about y                   */

/* Taller than the picture, lit evenly, by more than white; its near side is
 * at x of the middle. */
static void add_strip(struct fk_scene *s, float pixels, float x)
{
    const float a = TILT * 3.14159265f / 180;
    struct hl_item *it = fk_add(s, FK_QUAD, FK_TWO_SIDED, x, 0, 0, 10);
    float half = pixels * pixel / 2 / cosf(a);
    it->world[0] = half * cosf(a);
    it->world[2] = -half * sinf(a);
    it->world[8] = sinf(a);
    it->world[10] = cosf(a);
    struct hl_light *l = fk_light(s, 0, 0, 0, 0);
    l->kind = HL_DIRECTIONAL;
    l->direction[0] = -sinf(a);
    l->direction[2] = -cosf(a);
    l->color[0] = 8;
    l->color[2] = 0.25f;
    for (int c = 0; c < 3; c++)
        s->frame.background[c] = 0.5f * (float)c;
}

/* Strips of all places within a pixel, at a frame's own L-buffer size, where a
 * centre beside the strip has one tap, and that is not the strip's. A strip at
 * least a pixel wide holds a centre in each row, beside each pixel that it
 * covers in part. So pixels are strip and background by coverage, as in the
 * forward frame but for roundings to halves: of light, frame and resolve, each
 * by up to a unit, 2^-10. Gives the largest differences with and without. */
static void strip_errors(struct fk_scene *s, float width, double worst[2])
{
    enum { STEPS = 4 };
    worst[0] = worst[1] = 0;
    for (int k = 0; k < STEPS; k++) {
        s->frame.n_items = s->frame.n_lights = 0;
        add_strip(s, width, ((float)k / STEPS + 0.01f) * pixel);
        float *want = picture(s, HL_PIPELINE_FORWARD, false);
        for (int on = 0; on < 2; on++) {
            float *got = picture(s, HL_PIPELINE_INFERRED, on);
            worst[on] = fmax(worst[on], fk_difference(want, got, N));
            free(got);
        }
        free(want);
    }
}

static void strips_keep_their_light(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    s.needs.light_width = FK_W;
    s.needs.light_height = FK_H;
    s.needs.fill = HL_FILL_BILINEAR;
    uint32_t n = 1, counts = 0;
    while ((n = next_count(&s, n)) != 0) {
        s.needs.samples = n;
        counts++;
        for (int wide = 0; wide < 2; wide++) {
            float width = wide ? 3.0f : 1.25f;
            double e[2];
            strip_errors(&s, width, e);
            print_message("%u samples, %g pixels: %.3g, at centres %.3g\n", n,
                          (double)width, e[1], e[0]);
            assert_true(e[1] <= 8 * 3.0 / 1024);
            /* Of a sample that is covered where the centre is not: it is lit
             * as the background's texel is, whose normal is halfway off. */
            assert_true(e[0] > 0.4 * 8 / n);
        }
    }
    assert_true(counts > 0);
    fk_end(&s);
}

/* Numbers in place of words, gathered and filtered: the same by far, whatever
 * their rounding. */
static void other_taps_keep_it_too(void **state)
{
    static const struct { const char *profile; enum hl_fetch fetch; } way[] = {
        { "native", HL_FETCH_BILINEAR }, { "ps3", HL_FETCH_BILINEAR },
        { "ps3", HL_FETCH_GATHER } };
    const char *backend = ck_machine(state)->backend->name;
    for (size_t i = 0; i < sizeof way / sizeof way[0]; i++) {
        struct ck_machine m;
        struct fk_scene s;
        double e[2];
        ck_open_as(&m, backend, way[i].profile);
        fk_begin(&s, &m);
        s.needs.light_width = FK_W;
        s.needs.light_height = FK_H;
        s.needs.samples = 4;
        s.needs.fill = HL_FILL_BILINEAR;
        s.needs.fetch = way[i].fetch;
        strip_errors(&s, 3, e);
        print_message("%s, %d: %.3g, at centres %.3g\n", way[i].profile,
                      (int)way[i].fetch, e[1], e[0]);
        assert_true(e[1] < e[0] / 16);
        fk_end(&s);
        ck_close(&m);
    }
}

/* ---- where nothing changes ---------------------------------------------- */

static float *room(struct fk_scene *s, bool centroid)
{
    uint64_t seed = 3;
    s->frame.n_items = s->frame.n_lights = 0;
    fk_room(s, 20, &seed);
    return picture(s, HL_PIPELINE_INFERRED, centroid);
}

static void one_sample_has_its_centre(void **state)
{
    struct fk_scene s;
    struct hl_plan a, b;
    fk_begin(&s, ck_machine(state));
    float *x = room(&s, true), *y = room(&s, false);
    fk_plan(&b, &s, HL_PIPELINE_INFERRED);
    s.needs.no_centroid = false;
    fk_plan(&a, &s, HL_PIPELINE_INFERRED);
    assert_false(a.centroid);
    assert_memory_equal(&a, &b, sizeof a);
    assert_memory_equal(x, y, N * 4 * sizeof *x);
    s.needs.samples = next_count(&s, 1);
    s.needs.dsf = HL_DSF_NONE;
    fk_plan(&a, &s, HL_PIPELINE_INFERRED);
    assert_false(a.centroid);
    s.needs.dsf = HL_DSF_AUTO;
    fk_plan(&a, &s, HL_PIPELINE_INFERRED);
    assert_true(a.centroid);
    free(x);
    free(y);
    fk_end(&s);
}

/* Distance of a pixel's centre from the line through two points, pixels. */
static double distance(int x, int y, const double p[2], const double q[2])
{
    double dx = q[0] - p[0], dy = q[1] - p[1];
    return fabs((x + 0.5 - p[0]) * dy - (y + 0.5 - p[1]) * dx) /
           sqrt(dx * dx + dy * dy);
}

/* Of one quad: is the pixel crossed by an edge or by the diagonal? */
static bool is_cut(int x, int y)
{
    const double r = 3 / (double)pixel, cx = FK_W / 2.0, cy = FK_H / 2.0;
    const double p[4][2] = { { cx - r, cy + r }, { cx + r, cy + r },
                             { cx + r, cy - r }, { cx - r, cy - r } };
    bool cut = distance(x, y, p[0], p[2]) < 0.75;
    for (int i = 0; i < 4; i++)
        cut |= distance(x, y, p[i], p[(i + 1) % 4]) < 0.75;
    return cut;
}

/* Pixels that centroids change. */
static int changes(struct fk_scene *s, bool cut[N])
{
    int n = 0;
    float *a = picture(s, HL_PIPELINE_INFERRED, true);
    float *b = picture(s, HL_PIPELINE_INFERRED, false);
    for (int i = 0; i < N; i++) {
        cut[i] = memcmp(a + 4 * i, b + 4 * i, 3 * sizeof *a) != 0;
        n += cut[i];
    }
    free(a);
    free(b);
    return n;
}

/* What is covered whole is lit at its centre; so it is in a part of the
 * target, moved by a jitter, where about as much lies at edges. */
static void whole_pixels_do_not_change(void **state)
{
    struct fk_scene s;
    static bool changed[N], other[N];
    fk_begin(&s, ck_machine(state));
    fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 3);
    fk_light(&s, 1, 1, 1, 4);
    uint32_t n = 1;
    while ((n = next_count(&s, n)) != 0) {
        s.needs.samples = n;
        int whole = changes(&s, changed);
        for (int i = 0; i < N; i++)
            assert_true(!changed[i] || is_cut(i % FK_W, i / FK_W));
        assert_true(whole > 0);
        s.frame.width = 3 * FK_W / 4;
        s.frame.height = 3 * FK_H / 4;
        s.frame.camera.jitter[0] = 0.3f;
        s.frame.camera.jitter[1] = -0.4f;
        int part = changes(&s, other);
        print_message("%u samples: %d pixels change, of a part %d\n", n,
                      whole, part);
        assert_true(part > 0 && part < 2 * whole);
        s.frame.width = s.frame.height = 0;
        s.frame.camera.jitter[0] = s.frame.camera.jitter[1] = 0;
    }
    fk_end(&s);
}

/* ---- textures ----------------------------------------------------------- */

/* Green but for the first of 64 columns, red. */
static hl_tex red_column(struct ck_machine *m)
{
    uint8_t texel[64][4];
    struct hl_tex_desc d = { .format = HL_FORMAT_RGBA8_UNORM, .width = 64,
                             .height = 1 };
    hl_tex t;
    memset(texel, 0, sizeof texel);
    for (int i = 0; i < 64; i++) {
        texel[i][i ? 1 : 0] = 255;
        texel[i][3] = 255;
    }
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    assert_int_equal(hl_tex_write(m->device, t, 0, texel, sizeof texel),
                     HL_OK);
    return t;
}

/* Pixels right of the middle with red: of coordinates past 1, begun anew. */
static int red_pixels(struct fk_scene *s, bool centroid)
{
    int n = 0;
    float *f = picture(s, HL_PIPELINE_INFERRED, centroid);
    for (int i = 0; i < N; i++)
        n += i % FK_W > FK_W / 2 && f[4 * i] > 0;
    free(f);
    return n;
}

/* An edge of 46 rows. A sample that is no further outside than vertices are
 * snapped, 1/512 of a pixel, may be covered and be past 1: one in 256 of the
 * pixels that have a sample by the edge. Of centres up to half are outside
 * where the pixel has a sample inside. */
static void textures_end_at_edges(void **state)
{
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    struct hl_item *it = fk_add(&s, FK_QUAD, FK_FULL, 0, 0, 0, 3);
    it->world[4] = 0.37f;
    it->texture[0].tex = red_column(s.m);
    it->texture[0].wrap_u = HL_WRAP_REPEAT;
    fk_light(&s, 0, 0, 1, 4);
    for (int c = 0; c < 3; c++)
        s.frame.ambient[c] = 1;
    uint32_t n = 1;
    while ((n = next_count(&s, n)) != 0) {
        s.needs.samples = n;
        int at = red_pixels(&s, true), off = red_pixels(&s, false);
        print_message("%u samples: %d pixels, at centres %d\n", n, at, off);
        assert_true(at <= 1);
        assert_true(off >= 46 / 8);
    }
    hl_tex_destroy(s.m->device, &it->texture[0].tex);
    fk_end(&s);
}

/* ---- what is never averaged --------------------------------------------- */

static void ids_of(uint32_t *out, struct fk_scene *s)
{
    struct fk_run run;
    uint64_t seed = 9;
    s->frame.n_items = s->frame.n_lights = 0;
    fk_room(s, 4, &seed);
    fk_prepare(&run, s, HL_PIPELINE_INFERRED);
    const uint32_t frame = 1u << HL_ROLE_COLOR | 1u << HL_ROLE_DEPTH;
    for (uint32_t i = 0; i < run.plan.n_targets; i++) {
        const struct hl_plan_target *t = &run.plan.target[i];
        assert_int_equal(t->samples, frame >> t->role & 1 ? run.plan.samples
                                                          : 1);
        /* A resolved depth would be that of a sample off the centre. */
        assert_true(t->role != HL_ROLE_DEPTH || t->read_by == 0);
    }
    assert_int_equal(fk_create(&run), HL_OK);
    assert_int_equal(hl_frame_inspect(run.r, &s->frame, HL_INSPECT_IDS, out,
                                      N * sizeof *out), HL_OK);
    fk_destroy(&run);
}

static void ids_have_one_sample(void **state)
{
    struct fk_scene s;
    static uint32_t one[N], many[N];
    fk_begin(&s, ck_machine(state));
    ids_of(one, &s);
    s.needs.samples = 1;
    while ((s.needs.samples = next_count(&s, s.needs.samples)) != 0) {
        ids_of(many, &s);
        assert_memory_equal(one, many, sizeof one);
    }
    fk_end(&s);
}

/* ---- a stage of an embedder's own --------------------------------------- */

static float *own_or_built_in(const char *backend, bool own)
{
    static const float tint[4] = { 1, 1, 1, 1 };
    static struct hl_code code = { own_spirv, sizeof own_spirv, own_glsl,
                                   NULL };
    struct ck_machine m;
    static struct fk_scene s;
    struct fk_run run;
    uint64_t seed = 5;
    ck_open_as(&m, backend, "ps3");
    fk_begin(&s, &m);
    fk_room(&s, 20, &seed);
    s.needs.samples = 4;
    s.needs.no_centroid = !own;
    code.kernel = own_taps_kernel();
    s.surface[FK_PLAIN].own_material = own ? &code : NULL;
    for (uint32_t i = 0; i < s.frame.n_items; i++) {
        for (int k = 0; k < 3; k++)
            fk_material(&s, &s.item[i])->base[k] = 1;
        s.item[i].material_block = tint;
        s.item[i].material_bytes = sizeof tint;
    }
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.centroid, own);
    run.desc.n_surfaces = FK_FULL;
    assert_int_equal(fk_create(&run), HL_OK);
    float *f = fk_read(&run, HL_ROLE_NONE);
    fk_destroy(&run);
    fk_end(&s);
    ck_close(&m);
    return f;
}

/* It reads at the centre, as it always did. e + rho A + rho D of a white
 * surface in another order of sums: two roundings of floats, then two of
 * halves, of the frame and of its mean, which may be neighbours. */
static void own_stages_read_at_centres(void **state)
{
    const char *backend = ck_machine(state)->backend->name;
    float *a = own_or_built_in(backend, false);
    float *b = own_or_built_in(backend, true);
    for (int i = 0; i < N; i++) {
        const float *p = a + 4 * i;
        double most = (double)fmaxf(p[0], fmaxf(p[1], p[2]));
        assert_true(fk_difference(p, b + 4 * i, 1) <= most / 512 + 1e-6);
    }
    free(a);
    free(b);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(strips_keep_their_light),
        DRAWN(other_taps_keep_it_too),
        DRAWN(one_sample_has_its_centre),
        DRAWN(whole_pixels_do_not_change),
        DRAWN(textures_end_at_edges),
        DRAWN(ids_have_one_sample),
        DRAWN(own_stages_read_at_centres),
    };
    return cmocka_run_group_tests_name("multisampled frames", tests, NULL,
                                       NULL);
}
