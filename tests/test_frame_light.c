/* SPDX-License-Identifier: Zlib */
/* The light of a frame: the L-buffer against the model computed in double
 * from the very G-buffer it was made of; all ways to find a texel's lights
 * against each other; what formats and batches lose; inferred against
 * forward. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "tests/frame_kit.h"

enum { N = FK_W * FK_H };

/* ---- the oracle ------------------------------------------------------- */

struct oracle {
    double d[3];             /* D                                            */
    double alpha;            /* specular intensity                           */
    double reach;            /* sum of lum(c) a: what normals' errors scale  */
    bool surface;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit(double v[3])
{
    double l = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++)
        v[k] = l > 0 ? v[k] / l : 0;
}

static double falloff(const struct hl_light *l, double d)
{
    double r = (double)l->radius, q = d / r;
    if (l->falloff == HL_SMOOTH)
        return q < 1 ? (1 - q * q) * (1 - q * q) : 0;
    double window = 1 - q * q * q * q, f = d > 0.01 ? d : 0.01;
    return window > 0 ? window / (f * f) : 0;
}

/* Attenuation and direction to the light, all in view space. */
static double light_at(const struct hl_light *l, const struct hl_camera *cam,
                       const double p[3], double to[3])
{
    double pos[3], dir[3], cosine;
    for (int k = 0; k < 3; k++) {
        pos[k] = (double)cam->view[12 + k];
        dir[k] = 0;
        for (int j = 0; j < 3; j++) {
            pos[k] += (double)cam->view[j * 4 + k] * (double)l->position[j];
            dir[k] += (double)cam->view[j * 4 + k] * (double)l->direction[j];
        }
        to[k] = pos[k] - p[k];
    }
    unit(dir);
    if (l->kind == HL_DIRECTIONAL) {
        for (int k = 0; k < 3; k++)
            to[k] = -dir[k];
        return 1;
    }
    double d = sqrt(dot(to, to)), a = falloff(l, d);
    unit(to);
    if (l->kind == HL_POINT)
        return a;
    double width = cos((double)l->inner) - cos((double)l->outer);
    cosine = -dot(to, dir);
    double t = (cosine - cos((double)l->outer)) / (width > 0.001 ? width
                                                                 : 0.001);
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    return a * t * t;
}

static void shade(struct oracle *o, const struct fk_scene *s,
                  const double p[3], const double n[3], double exponent)
{
    double v[3] = { -p[0], -p[1], -p[2] };
    unit(v);
    for (uint32_t i = 0; i < s->frame.n_lights; i++) {
        const struct hl_light *l = &s->light[i];
        double to[3], h[3];
        double a = light_at(l, &s->frame.camera, p, to);
        double nl = dot(n, to) > 0 ? dot(n, to) : 0;
        double c[3] = { (double)l->color[0], (double)l->color[1],
                        (double)l->color[2] };
        double lum = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
        for (int k = 0; k < 3; k++) {
            o->d[k] += c[k] * a * nl;
            h[k] = to[k] + v[k];
        }
        unit(h);
        double nh = dot(n, h) > 0 ? dot(n, h) : 0;
        o->alpha += lum * a * nl * pow(nh, exponent);
        o->reach += a * (c[0] > c[1] ? c[0] > c[2] ? c[0] : c[2]
                                     : c[1] > c[2] ? c[1] : c[2]);
    }
}

/* Of every texel, from the normals and depths that the geometry pass left. */
static struct oracle *look(struct fk_run *run, double exponent)
{
    const struct hl_camera *cam = &run->scene->frame.camera;
    const struct hl_plan *p = &run->plan;
    uint32_t w = p->light_width, h = p->light_height;
    struct oracle *o = calloc((size_t)w * h, sizeof *o);
    uint16_t *code = malloc((size_t)w * h * 4);
    float *z = malloc((size_t)w * h * 4);
    struct hl_device *d = run->scene->m->device;
    double n = (double)cam->near, f = (double)cam->far;
    double ty = (double)cam->tan_half_y, tx = ty * p->width / p->height;
    assert_int_equal(hl_tex_read(d, hl_renderer_target(run->r, HL_ROLE_NORMAL),
                                 code, (size_t)w * h * 4), HL_OK);
    assert_int_equal(hl_tex_read(
        d, hl_renderer_target(run->r, HL_ROLE_LIGHT_DEPTH), z,
        (size_t)w * h * 4), HL_OK);
    assert_true(p->reversed_depth);
    for (uint32_t i = 0; i < w * h; i++) {
        if (z[i] == 0)
            continue;
        double depth = n * f / (f - n) / ((double)z[i] + n / (f - n));
        double q[3] = { ((i % w + 0.5) / w * 2 - 1) * tx * depth,
                        (1 - (i / w + 0.5) / h * 2) * ty * depth, -depth };
        double x = code[i * 2] / 65535.0 * 2 - 1;
        double y = code[i * 2 + 1] / 65535.0 * 2 - 1;
        double k2 = 1 - x * x - y * y, k = k2 > 0 ? sqrt(k2) : 0;
        double normal[3] = { 2 * k * x, 2 * k * y, 2 * k * k - 1 };
        o[i].surface = true;
        shade(&o[i], run->scene, q, normal, exponent);
    }
    free(code);
    free(z);
    return o;
}

/* A few lights of each kind and falloff among the room's. */
static void mix_kinds(struct fk_scene *s)
{
    for (uint32_t i = 0; i < s->frame.n_lights; i++) {
        struct hl_light *l = &s->light[i];
        l->falloff = i % 3 == 1 ? HL_INVERSE_SQUARE : HL_SMOOTH;
        l->kind = i % 4 == 2 ? HL_SPOT : HL_POINT;
        l->direction[0] = 0.3f;
        l->direction[1] = -0.8f;
        l->direction[2] = -0.5f;
        l->inner = 0.2f;
        l->outer = 0.7f;
    }
    s->light[0].kind = HL_DIRECTIONAL;
    for (int c = 0; c < 3; c++)
        s->light[0].color[c] *= 0.2f;
}

/* Specular materials of one exponent, or of several. */
static void make_shiny(struct fk_scene *s, bool differ)
{
    for (uint32_t i = 0; i < s->frame.n_items; i++) {
        s->material[i].no_specular = false;
        s->material[i].roughness = differ && i % 2 ? 0.4f : 0.55f;
    }
}

struct case_of_light {
    bool kinds, shiny;
    enum hl_light_path path;
    uint32_t batch, tile;
    bool no_tile_depth;
    enum hl_format format;
};

static void set_choices(struct fk_scene *s, const struct case_of_light *c)
{
    s->needs.light_path = c->path;
    s->needs.batch = c->batch;
    s->needs.tile = c->tile;
    s->needs.no_tile_depth = c->no_tile_depth;
    s->needs.light_format = c->format;
    s->needs.light_width = FK_W;
    s->needs.light_height = FK_H;
}

static void make_room(struct fk_scene *s, void **state, bool kinds,
                      bool shiny)
{
    uint64_t seed = mk_seed();
    fk_begin(s, ck_machine(state));
    fk_room(s, 60, &seed);
    if (kinds)
        mix_kinds(s);
    if (shiny)
        make_shiny(s, false);
}

/* ---- the light pass is the model -------------------------------------- */

/* In 32 bits: positions come from a depth that is exact to 1e-7, cones from
 * cosines whose difference is 0.2: 1e-6 of a light; and the sum of 60 rounds
 * by 60 * 2^-24 of it: 1e-5 of all that reaches the texel. Powers of up to
 * 30 (roughness 0.55 is an exponent of 19.9) multiply the error of N.H. */
static void the_light_buffer_is_the_model(void **state)
{
    static const struct case_of_light cases[] = {
        { false, false, HL_LIGHT_PATH_LISTS, 0, 0, false, 0 },
        { true, false, HL_LIGHT_PATH_LISTS, 0, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_LISTS, 0, 16, true, 0 },
        { false, true, HL_LIGHT_PATH_TILES, 0, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_TILES, 0, 64, true, 0 },
        { false, false, HL_LIGHT_PATH_TILES, 0, 8, false, 0 },
        { false, true, HL_LIGHT_PATH_RECTS, 1, 0, false, 0 },
        { true, false, HL_LIGHT_PATH_RECTS, 5, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_RECTS, 16, 0, false, 0 },
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct fk_scene s;
        struct fk_run run;
        make_room(&s, state, cases[i].kinds, cases[i].shiny);
        set_choices(&s, &cases[i]);
        s.needs.light_format = HL_FORMAT_RGBA32_FLOAT;
        fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
        assert_int_equal(run.plan.light_path, cases[i].path);
        assert_int_equal(fk_create(&run), HL_OK);
        float *light = fk_read(&run, HL_ROLE_LIGHT);
        struct oracle *o = look(&run, (double)run.plan.exponent);
        double worst = 0;
        uint32_t lit = 0;
        for (int k = 0; k < N; k++) {
            if (!o[k].surface)
                continue;
            lit += o[k].reach > 0;
            double limit = 2e-5 * o[k].reach + 1e-7;
            for (int c = 0; c < 4; c++) {
                double want = c < 3 ? o[k].d[c]
                              : cases[i].shiny ? o[k].alpha : 0;
                double e = fabs((double)light[k * 4 + c] - want) / limit;
                worst = e > worst ? e : worst;
            }
        }
        print_message("case %zu: %u texels lit, worst %.2f of the tolerance\n",
                      i, lit, worst);
        assert_true(lit > N / 2);
        assert_true(worst <= 1);
        free(light);
        free(o);
        fk_destroy(&run);
        fk_end(&s);
    }
}

/* The exponent from a G-buffer channel: log2(n) / 8 in 16 bits is within
 * 4.3e-5 of n, so the lobe within 30 * 4.3e-5 / e of the light. */
static void exponents_differ_by_texel(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    make_room(&s, state, false, true);
    make_shiny(&s, true);
    struct case_of_light c = { .path = HL_LIGHT_PATH_LISTS,
                               .format = HL_FORMAT_RGBA32_FLOAT };
    set_choices(&s, &c);
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.specular, HL_SPECULAR_CHANNEL);
    assert_int_equal(fk_create(&run), HL_OK);
    float *light = fk_read(&run, HL_ROLE_LIGHT);
    struct oracle *a = look(&run, (double)hl_roughness_exponent(0.55f));
    struct oracle *b = look(&run, (double)hl_roughness_exponent(0.4f));
    uint32_t first = 0, second = 0;
    for (int k = 0; k < N; k++) {
        double limit = 1e-4 * a[k].reach + 1e-7;
        double got = (double)light[k * 4 + 3];
        bool is_a = fabs(got - a[k].alpha) <= limit;
        bool is_b = fabs(got - b[k].alpha) <= limit;
        if (!a[k].surface)
            continue;
        if (!is_a && !is_b)
            fail_msg("texel %d: %g, not %g or %g", k, got, a[k].alpha,
                     b[k].alpha);
        first += is_a && !is_b;
        second += is_b && !is_a;
    }
    assert_true(first > 1000 && second > 1000);
    free(light);
    free(a);
    free(b);
    fk_destroy(&run);
    fk_end(&s);
}

/* ---- one light, many ways --------------------------------------------- */

static float *light_of(struct fk_scene *s, const struct case_of_light *c)
{
    set_choices(s, c);
    return fk_draw(s, HL_PIPELINE_INFERRED, HL_ROLE_LIGHT);
}

/* Depth of each L-buffer texel as stored, 0: no surface. */
static float *depth_of(struct fk_scene *s)
{
    struct fk_run run;
    float *z = malloc(N * sizeof *z);
    fk_prepare(&run, s, HL_PIPELINE_INFERRED);
    assert_int_equal(fk_create(&run), HL_OK);
    free(fk_read(&run, HL_ROLE_NONE));
    assert_int_equal(hl_tex_read(
        s->m->device, hl_renderer_target(run.r, HL_ROLE_LIGHT_DEPTH), z,
        N * sizeof *z), HL_OK);
    fk_destroy(&run);
    return z;
}

/* The order of 60 positive terms moves their sum by 60 * 2^-24 either way. */
static void paths_agree(void **state)
{
    static const struct case_of_light ways[] = {
        { true, true, HL_LIGHT_PATH_LISTS, 0, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_LISTS, 0, 8, true, 0 },
        { true, true, HL_LIGHT_PATH_LISTS, 0, 256, false, 0 },
        { true, true, HL_LIGHT_PATH_TILES, 0, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_TILES, 0, 13, true, 0 },
        { true, true, HL_LIGHT_PATH_RECTS, 1, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_RECTS, 7, 0, false, 0 },
        { true, true, HL_LIGHT_PATH_RECTS, 16, 0, false, 0 },
    };
    struct fk_scene s;
    make_room(&s, state, true, true);
    struct case_of_light way = ways[0];
    way.format = HL_FORMAT_RGBA32_FLOAT;
    float *base = light_of(&s, &way);
    /* A tile without a surface has no list where depth bounds it. */
    float *depth = depth_of(&s);
    for (size_t i = 1; i < sizeof ways / sizeof *ways; i++) {
        way = ways[i];
        way.format = HL_FORMAT_RGBA32_FLOAT;
        float *other = light_of(&s, &way);
        for (int k = 0; k < N * 4; k++)
            if (depth[k / 4] != 0)
                ck_near((double)other[k], (double)base[k],
                        120 * ldexp(1, -24) * (double)base[k] + 1e-7);
        free(other);
    }
    free(base);
    free(depth);
    fk_end(&s);
}

/* A light that depth bounds drop adds exactly nothing, so a list's one sum is
 * the same bits. */
static void depth_bounds_change_no_bit(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    make_room(&s, state, true, true);
    for (uint32_t tile = 8; tile <= 64; tile *= 2) {
        struct case_of_light c = { .path = HL_LIGHT_PATH_LISTS, .tile = tile,
                                   .no_tile_depth = true };
        float *flat = light_of(&s, &c);
        set_choices(&s, &c);
        s.needs.no_tile_depth = false;
        fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
        run.plan.tile_depth = true;      /* whatever it costs                */
        assert_int_equal(fk_create(&run), HL_OK);
        float *deep = fk_read(&run, HL_ROLE_LIGHT);
        float *z = depth_of(&s);
        for (int k = 0; k < N; k++)
            if (z[k] != 0)
                assert_memory_equal(&flat[k * 4], &deep[k * 4], 16);
        free(z);
        free(flat);
        free(deep);
        fk_destroy(&run);
    }
    fk_end(&s);
}

/* Capacities and lists at a size that few scenes reach: 3,000 small lights.
 * The order of the few that meet at a texel moves the sum as above. */
static void thousands_of_lights_agree(void **state)
{
    enum { MANY = 3000 };
    struct fk_scene s;
    struct ck_machine *m = ck_machine(state);
    uint64_t seed = mk_seed();
    struct hl_light *lights = calloc(MANY, sizeof *lights);
    float *base = NULL;
    assert_non_null(lights);
    fk_begin(&s, m);
    fk_room(&s, 0, &seed);
    for (int i = 0; i < MANY; i++) {
        for (int c = 0; c < 3; c++) {
            lights[i].position[c] = (float)ck_between(&seed, -8, 8);
            lights[i].color[c] = mk_unit(&seed);
        }
        lights[i].radius = (float)ck_between(&seed, 0.2, 1);
    }
    s.frame.lights = lights;
    s.frame.n_lights = MANY;
    for (int path = HL_LIGHT_PATH_LISTS; path >= HL_LIGHT_PATH_RECTS; path--) {
        struct fk_run run;
        struct case_of_light c = { .path = (enum hl_light_path)path,
                                   .no_tile_depth = true,
                                   .format = HL_FORMAT_RGBA32_FLOAT };
        set_choices(&s, &c);
        fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
        run.desc.max_lights = MANY;
        run.desc.frame_bytes = run.desc.list_bytes = 1 << 24;
        assert_int_equal(fk_create(&run), HL_OK);
        float *got = fk_read(&run, HL_ROLE_LIGHT);
        double sum = 0;
        for (int k = 0; k < N * 4 && base; k++)
            ck_near((double)got[k], (double)base[k],
                    200 * ldexp(1, -24) * (double)base[k] + 1e-7);
        for (int k = 0; k < N * 4; k++)
            sum += (double)got[k];
        assert_true(sum > N / 100);
        fk_destroy(&run);
        if (base)
            free(got);
        else
            base = got;
    }
    free(base);
    free(lights);
    fk_end(&s);
}

/* ---- formats and batches ---------------------------------------------- */

/* Blends that a texel can see: every light's rectangle is the screen. */
static void make_bright(struct fk_scene *s, void **state)
{
    uint64_t seed = mk_seed();
    fk_begin(s, ck_machine(state));
    fk_add(s, FK_QUAD, FK_PLAIN, 0, 0, 0, 20);
    for (int i = 0; i < FK_LIGHTS; i++) {
        struct hl_light *l = fk_light(s, (float)ck_between(&seed, -3, 3),
                                      (float)ck_between(&seed, -3, 3), 12,
                                      60);
        for (int c = 0; c < 3; c++)
            l->color[c] = (float)ck_between(&seed, 0.1, 1);
    }
    hl_needs_measure(&s->needs, &s->frame, s->surface, (float)FK_W / FK_H);
}

/* |S_fl - S| <= u sum S_k (conformance b3), u = 2^-10 for half floats under
 * either rounding, and each S_k is at most S: m u S for m blends; unorm: one
 * step a blend, and one for the stage's own value. The batch sums in 32 bits,
 * so the bound shrinks with it. */
static void batches_divide_the_loss(void **state)
{
    static const struct { enum hl_format f; double u, step; } row[] = {
        { HL_FORMAT_RGBA16_FLOAT, 1.0 / 1024, 0 },
        { HL_FORMAT_RGBA16_UNORM, 0, 1.0 / 65535 },
    };
    struct fk_scene s;
    make_bright(&s, state);
    struct case_of_light c = { .path = HL_LIGHT_PATH_RECTS, .batch = 16,
                               .format = HL_FORMAT_RGBA32_FLOAT };
    float *exact = light_of(&s, &c);
    for (int f = 0; f < 2; f++) {
        double last = 1e9, peak = (double)s.needs.peak;
        for (uint32_t batch = 1; batch <= 16; batch *= 2) {
            double m = (double)FK_LIGHTS / batch, mean = 0;
            c.batch = batch;
            c.format = row[f].f;
            float *got = light_of(&s, &c);
            for (int k = 0; k < N * 4; k++) {
                double e = fabs((double)got[k] * (f ? peak : 1) -
                                (double)exact[k]);
                double limit = m * row[f].u * (double)exact[k] +
                               (m + 1) * row[f].step * peak + 1e-5;
                if (!(e <= limit))
                    fail_msg("%s, batches of %u: off by %g of %g",
                             hl_format_info(c.format)->name, batch, e,
                             (double)exact[k]);
                mean += e / (N * 4);
            }
            print_message("%s, batches of %u: mean error %.2e\n",
                          hl_format_info(c.format)->name, batch, mean);
            /* A truncating blender loses in proportion; a rounding one, by
             * the root. Unorm's is the least step already. */
            assert_true(mean < (f ? 1.05 : 0.85) * last);
            last = mean;
            free(got);
        }
    }
    free(exact);
    fk_end(&s);
}

/* ---- the filter at 1:1 ------------------------------------------------ */

static void at_equal_sizes_the_filter_is_a_fetch(void **state)
{
    static const enum hl_dsf dsf[] = { HL_DSF_NONE, HL_DSF_CONSTANT_TAU };
    struct fk_scene s;
    make_room(&s, state, false, true);
    s.needs.light_width = FK_W;
    s.needs.light_height = FK_H;
    struct fk_run run;
    fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
    assert_int_equal(run.plan.dsf, HL_DSF_EXACT);
    assert_int_equal(fk_create(&run), HL_OK);
    float *exact = fk_read(&run, HL_ROLE_NONE);
    fk_destroy(&run);
    for (int i = 0; i < 2; i++) {
        s.needs.dsf = dsf[i];
        s.needs.dsf_tau = 0.5f;
        float *other = fk_draw(&s, HL_PIPELINE_INFERRED, HL_ROLE_NONE);
        assert_memory_equal(exact, other, N * 16);
        free(other);
    }
    free(exact);
    fk_end(&s);
}

/* ---- where the light is ------------------------------------------------ */

/* Least-squares shift, in L-buffer texels, that turns forward's light into
 * the filtered one: sum (I - F) F' over sum F'^2, F' by central differences
 * along x (step 1) or y (step FK_W). */
static double shift_of(const float *inferred, const float *forward, int step,
                       double texel)
{
    double above = 0, below = 0;
    for (int y = 8; y < FK_H - 8; y++)
        for (int x = 8; x < FK_W - 8; x++) {
            int i = (y * FK_W + x) * 4;
            double slope = ((double)forward[i + step * 4] -
                            (double)forward[i - step * 4]) / 2;
            above += ((double)inferred[i] - (double)forward[i]) * slope;
            below += slope * slope;
        }
    return above / below / texel;
}

/* Conformance b6: 0.02 texel. A half-pixel error is 0.3 to 0.5. */
static void the_filter_does_not_shift_light(void **state)
{
    static const enum hl_dsf dsf[] = { HL_DSF_AUTO, HL_DSF_NONE,
                                       HL_DSF_CONSTANT_TAU };
    static const uint32_t size[][2] = { { 100, 56 }, { 80, 45 }, { 53, 31 },
                                        { 160, 90 }, { 240, 135 } };
    struct fk_scene s;
    fk_begin(&s, ck_machine(state));
    fk_add(&s, FK_QUAD, FK_PLAIN, 0, 0, 0, 30);
    fk_light(&s, -9, 6, 6, 40);
    s.needs.max_error = 1e-4f;
    s.needs.light_format = HL_FORMAT_RGBA32_FLOAT;
    float *forward = fk_draw(&s, HL_PIPELINE_FORWARD, HL_ROLE_NONE);
    for (int i = 0; i < 15; i++) {
        s.needs.dsf = dsf[i / 5];
        s.needs.light_width = size[i % 5][0];
        s.needs.light_height = size[i % 5][1];
        float *f = fk_draw(&s, HL_PIPELINE_INFERRED, HL_ROLE_NONE);
        ck_near(shift_of(f, forward, 1, (double)FK_W / size[i % 5][0]), 0,
                0.02);
        ck_near(shift_of(f, forward, FK_W, (double)FK_H / size[i % 5][1]), 0,
                0.02);
        free(f);
    }
    free(forward);
    fk_end(&s);
}

/* ---- inferred against forward ----------------------------------------- */

/* What a picture changes by over 1/512 pixel on either axis: half the grid of
 * 1/256 to which machines snap vertices, and what is interpolated between
 * them with it. By the larger step to a neighbour. */
static double snapped(const float *picture, int k, int ch)
{
    int x = k % FK_W, y = k / FK_W;
    double d[2] = { 0, 0 }, f = (double)picture[k * 4 + ch];
    for (int i = 0; i < 4; i++) {
        int u = x + (i == 0) - (i == 1), v = y + (i == 2) - (i == 3);
        if (u < 0 || v < 0 || u >= FK_W || v >= FK_H)
            continue;
        double e = fabs((double)picture[(v * FK_W + u) * 4 + ch] - f);
        d[i / 2] = e > d[i / 2] ? e : d[i / 2];
    }
    return (d[0] + d[1]) / 512;
}

/* Both in 32 bits, L-buffer as large as the frame: what is left is vertices'
 * snapping, which forward's positions see and those from the depth buffer do
 * not, and the normal's encoding, 0.0069 degrees up to 139 from the view axis
 * (conformance b1): 1.2e-4 of all light that reaches the surface, and of a
 * lobe's slope, sqrt(n / e) = 2.7 times that, with ks up to 0.14. */
static void inferred_is_forward_but_for_its_encodings(void **state)
{
    struct fk_scene s;
    struct fk_run run;
    for (int shiny = 0; shiny < 2; shiny++) {
        make_room(&s, state, true, shiny);
        for (uint32_t i = 0; i < s.frame.n_lights; i++)
            s.light[i].color[1] = s.light[i].color[2] = s.light[i].color[0];
        struct case_of_light c = { .path = HL_LIGHT_PATH_LISTS,
                                   .format = HL_FORMAT_RGBA32_FLOAT };
        set_choices(&s, &c);
        s.needs.max_error = 1e-4f;
        float *forward = fk_draw(&s, HL_PIPELINE_FORWARD, HL_ROLE_NONE);
        float *multi = fk_draw(&s, HL_PIPELINE_FORWARD_MULTIPASS,
                               HL_ROLE_NONE);
        fk_prepare(&run, &s, HL_PIPELINE_INFERRED);
        assert_int_equal(hl_plan_target(&run.plan, HL_ROLE_COLOR)->format,
                         HL_FORMAT_RGBA32_FLOAT);
        assert_int_equal(fk_create(&run), HL_OK);
        float *inferred = fk_read(&run, HL_ROLE_NONE);
        struct oracle *o = look(&run, (double)run.plan.exponent);
        double worst = 0, other = 0;
        for (int k = 0; k < N; k++)
            for (int ch = 0; ch < 3; ch++) {
                double f = (double)forward[k * 4 + ch];
                double limit = (shiny ? 1.7e-4 : 1.25e-4) * o[k].reach +
                               snapped(forward, k, ch) + 1e-5 * f + 1e-6;
                double e = fabs((double)inferred[k * 4 + ch] - f) / limit;
                worst = e > worst ? e : worst;
                /* The same lights in other batches. */
                e = fabs((double)multi[k * 4 + ch] - f) / (1e-5 * f + 1e-6);
                other = e > other ? e : other;
            }
        print_message("worst %.2f of the tolerance, multi-pass %.2f\n", worst,
                      other);
        assert_true(worst <= 1);
        assert_true(other <= 1);
        free(forward);
        free(multi);
        free(inferred);
        free(o);
        fk_destroy(&run);
        fk_end(&s);
    }
}

/* Without the scissor each light's draw covers the whole object: the same
 * sum, but for zeros. */
static void scissors_cut_only_darkness(void **state)
{
    struct fk_scene s;
    make_room(&s, state, true, true);
    s.needs.max_error = 1e-4f;
    float *cut = fk_draw(&s, HL_PIPELINE_FORWARD_MULTIPASS, HL_ROLE_NONE);
    s.needs.no_scissor = true;
    float *whole = fk_draw(&s, HL_PIPELINE_FORWARD_MULTIPASS, HL_ROLE_NONE);
    assert_true(fk_difference(cut, whole, N) == 0);
    free(cut);
    free(whole);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(the_light_buffer_is_the_model),
        DRAWN(exponents_differ_by_texel),
        DRAWN(paths_agree),
        DRAWN(depth_bounds_change_no_bit),
        DRAWN(thousands_of_lights_agree),
        DRAWN(batches_divide_the_loss),
        DRAWN(at_equal_sizes_the_filter_is_a_fetch),
        DRAWN(the_filter_does_not_shift_light),
        DRAWN(inferred_is_forward_but_for_its_encodings),
        DRAWN(scissors_cut_only_darkness),
    };
    return cmocka_run_group_tests_name("light of frames", tests, NULL, NULL);
}
