/* SPDX-License-Identifier: Zlib */
/* The planner's properties: pure, complete, within its machine, and the
 * cheapest of what it offers. test_plan_text.c holds whole plans as text. */
#include <math.h>
#include <string.h>
#include "core/pipe.h"
#include "platforms/profiles/hl_profiles.h"
#include "tests/check.h"

/* ---- needs and machines ----------------------------------------------- */

static struct hl_needs usual(void)
{
    struct hl_needs n = { .width = 1280, .height = 720, .n_objects = 100,
                          .n_triangles = 50000, .n_lights = 200,
                          .lights_per_pixel = 12, .lights_per_object = 30,
                          .lights = HL_LIGHTS_SMOOTH, .far = 100, .peak = 20,
                          .specular = HL_NEED_ONE_EXPONENT, .exponent = 32 };
    return n;
}

static uint32_t some_count(uint64_t *seed)
{
    static const uint32_t odd[] = { 0, 1, 7, 8, 9, 63, 64, 65535, 0x7fffffff,
                                    0xffffffff };
    uint32_t k = mk_below(seed, 4);
    return k == 0 ? odd[mk_below(seed, 10)]
                  : mk_below(seed, k == 1 ? 20 : 5000);
}

static float some_number(uint64_t *seed)
{
    static const float odd[] = { 0, 0, 0, 1e-30f, 1, 1e30f, -1, NAN, INFINITY };
    uint32_t k = mk_below(seed, 40);
    return k == 0 ? odd[mk_below(seed, 9)] : k < 10 ? 0
           : k < 20 ? (float)ck_between(seed, 0, 255)
                    : (float)ck_between(seed, 0, 2);
}

/* Mostly one of the enum's values, now and then one beyond. */
static uint32_t some_choice(uint64_t *seed, uint32_t n)
{
    return mk_below(seed, 40) ? mk_below(seed, n) : n + mk_below(seed, 9);
}

/* Three of four frames have none of them. */
static void some_features(struct hl_needs *n, uint64_t *seed)
{
    if (mk_below(seed, 4))
        return;
    n->blended_layers = some_count(seed);
    n->shadows = (enum hl_shadows)some_choice(seed, 3);
    n->n_shadow_lights = some_count(seed);
    n->shadow_points = mk_below(seed, 2);
    n->shadow_size = mk_below(seed, 2) ? some_choice(seed, 16384) : 0;
    n->volume_texels = some_count(seed);
    n->motion = mk_below(seed, 2);
    n->brdfs = mk_below(seed, 2);
    n->translucency = (enum hl_translucency)some_choice(seed, 4);
    n->stipple_filter = (enum hl_stipple_filter)some_choice(seed, 3);
    n->stipple_mode = (enum hl_stipple_mode)some_choice(seed, 3);
    n->fill = (enum hl_fill)some_choice(seed, 3);
    n->fetch = (enum hl_fetch)some_choice(seed, 3);
    n->no_centroid = mk_below(seed, 2);
}

static void some_budget(struct hl_needs *n, uint64_t *seed)
{
    if (mk_below(seed, 16))
        return;
    n->budget_codes = some_number(seed);
    n->budget_ms = mk_below(seed, 2) ? 0 : some_number(seed);
    n->probe.full = some_number(seed);
    n->probe.half = some_number(seed);
}

static struct hl_needs some_needs(uint64_t *seed)
{
    struct hl_needs n;
    memset(&n, 0, sizeof n);
    n.width = 1 + mk_below(seed, 2000);
    n.height = mk_below(seed, 50) ? 1 + mk_below(seed, 2000) : some_count(seed);
    if (mk_below(seed, 2)) {
        n.light_width = mk_below(seed, 3) ? 1 + mk_below(seed, 2000) : n.width;
        n.light_height = mk_below(seed, 3) ? 1 + mk_below(seed, 2000)
                                           : n.height;
    }
    n.samples = mk_below(seed, 3) ? 1u << mk_below(seed, 4)
                                  : mk_below(seed, 10);
    n.n_objects = some_count(seed);
    n.n_triangles = some_count(seed);
    n.n_lights = some_count(seed);
    n.lights_per_pixel = some_number(seed);
    n.lights_per_object = some_number(seed);
    n.n_regions = some_count(seed);
    n.lights = some_choice(seed, 8);
    n.specular = (enum hl_specular_need)some_choice(seed, 3);
    n.exponent = some_number(seed);
    n.blended = mk_below(seed, 2);
    n.far = some_number(seed);
    n.peak = some_number(seed);
    n.max_error = some_number(seed);
    n.light_path = (enum hl_light_path)some_choice(seed, 5);
    n.batch = mk_below(seed, 2) ? some_choice(seed, 17) : 0;
    n.tile = mk_below(seed, 2) ? 8 + mk_below(seed, 250) : 0;
    n.no_tile_depth = mk_below(seed, 2);
    n.no_scissor = mk_below(seed, 2);
    n.dsf = (enum hl_dsf)some_choice(seed, 4);
    n.dsf_k = some_number(seed);
    n.dsf_c = mk_below(seed, 2) ? 0 : mk_unit(seed);
    n.dsf_tau = mk_below(seed, 2) ? 0 : mk_unit(seed);
    n.light_format = (enum hl_format)(mk_below(seed, 2)
                     ? 0 : some_choice(seed, HL_FORMAT_COUNT));
    n.normal_format = (enum hl_format)(mk_below(seed, 20)
                      ? 0 : some_choice(seed, HL_FORMAT_COUNT));
    n.half_pixel = (enum hl_half_pixel)(mk_below(seed, 3)
                   ? 0 : some_choice(seed, 4));
    n.decals = mk_below(seed, 2);
    n.light_depth_bound = mk_below(seed, 2);
    some_features(&n, seed);
    return n;
}

/* None, one of the consoles, or one with a rule turned over. */
static void some_profile(struct hl_caps *c, uint64_t *seed)
{
    uint32_t i = mk_below(seed, 8);
    if (!hl_profile_at(i))
        return;
    c->profile = *hl_profile_at(i);
    c->console_memory = mk_below(seed, 2);
    if (mk_below(seed, 2))
        return;
    struct hl_profile *p = &c->profile;
    bool *const rules[] = { &p->resolve_to_read, &p->float_taps,
                            &p->one_mrt_format, &p->packed_normals,
                            &p->depth_copy_if_bound, &p->integer_centers };
    bool *rule = rules[mk_below(seed, 6)];
    *rule = !*rule;
    p->edram_tiles = mk_below(seed, 2) ? p->edram_tiles
                                       : mk_below(seed, 65536);
    p->edram_tile_width = 1 + mk_below(seed, 100);
    p->edram_tile_height = 1 + mk_below(seed, 100);
}

static struct hl_caps some_caps(uint64_t *seed)
{
    struct hl_caps c;
    ck_lavapipe(&c);
    c.max_tex_dim = mk_below(seed, 4) ? 16384 : 1u << mk_below(seed, 17);
    c.max_storage_bytes = mk_below(seed, 4) ? 1u << 27 : 0;
    c.samples = mk_below(seed, 16) | 1;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        if (mk_below(seed, 3) == 0)
            c.format[i].use = (uint8_t)mk_below(seed, 16);
        if (mk_below(seed, 3) == 0)
            c.format[i].samples = (uint8_t)(mk_below(seed, 16) | 1);
    }
    float *cost = &c.cost.draw_ns;
    for (size_t i = 0; i < sizeof c.cost / sizeof *cost; i++)
        cost[i] = mk_below(seed, 4) ? (float)exp(ck_between(seed, -9, 9)) : 0;
    some_profile(&c, seed);
    return c;
}

/* ---- what any plan must be -------------------------------------------- */

static void check_targets(const struct hl_plan *p, const struct hl_caps *caps)
{
    uint32_t roles = 0;
    for (uint32_t i = 0; i < p->n_targets; i++) {
        const struct hl_plan_target *t = &p->target[i];
        const struct hl_format_caps *f = &caps->format[t->format];
        assert_true(t->role > HL_ROLE_NONE && t->role < HL_ROLE_COUNT);
        assert_false(roles >> t->role & 1);
        roles |= 1u << t->role;
        assert_true(f->use & HL_USE_TARGET);
        assert_true(t->read_by == 0 || f->use & HL_USE_SAMPLED);
        assert_true(f->samples & t->samples);
        assert_true(t->width >= 1 && t->width <= caps->max_tex_dim);
        assert_true(t->height >= 1 && t->height <= caps->max_tex_dim);
        assert_true(t->bytes == (uint64_t)t->width * t->height * t->samples *
                                hl_format_info(t->format)->bytes);
        assert_true(t->error >= 0 && t->error < 1e30f);
        assert_ptr_equal(hl_plan_target(p, t->role), t);
    }
    assert_null(hl_plan_target(p, HL_ROLE_NONE));
    assert_non_null(hl_plan_target(p, HL_ROLE_COLOR));
    assert_true((hl_plan_target(p, HL_ROLE_RESOLVED) != NULL) ==
                (p->samples > 1));
}

static void check_passes(const struct hl_plan *p, const struct hl_caps *caps)
{
    for (uint32_t i = 0; i < p->n_passes; i++) {
        const struct hl_plan_pass *s = &p->pass[i];
        assert_true(s->role > HL_PASS_NONE && s->role < HL_PASS_ROLE_COUNT);
        for (int c = 0; c < 3; c++) {
            const struct hl_plan_target *t = hl_plan_target(p, s->color[c]);
            assert_true(t || s->color[c] == HL_ROLE_NONE);
            if (t && s->blend != HL_BLEND_OFF)
                assert_true(caps->format[t->format].use & HL_USE_BLEND);
        }
        assert_true(s->depth == HL_ROLE_NONE || hl_plan_target(p, s->depth));
        assert_true(s->lights_a_draw <= HL_BATCH_MAX);
    }
}

static void check_plan(const struct hl_plan *p, const struct hl_needs *n,
                       const struct hl_caps *caps)
{
    assert_true(p->n_targets <= HL_PLAN_TARGETS);
    assert_true(p->n_passes <= HL_PLAN_PASSES);
    /* One place stays free: a full array may have lost one. */
    assert_true(p->n_reasons < HL_PLAN_REASONS);
    check_targets(p, caps);
    check_passes(p, caps);
    for (uint32_t i = 0; i < p->n_reasons; i++)
        assert_true(p->reason[i].why > HL_WHY_NONE &&
                    p->reason[i].why < HL_WHY_COUNT);
    assert_true(p->width == n->width && p->height == n->height);
    assert_true(p->samples == (n->samples ? n->samples : 1));
    assert_true(p->cost_ms >= 0 && p->bytes_per_pixel > 0);
    assert_true(p->far > 0 && p->light_scale > 0 && p->light_out > 0);
    assert_true(p->light_scale < INFINITY && p->light_out < INFINITY);
    assert_string_equal(p->profile, caps->profile.name[0]
                                    ? caps->profile.name : "native");
    assert_true(p->id_steps >= 65534 && p->id_steps <= 65535);
    assert_true(p->edram_tiles <= caps->profile.edram_tiles);
    assert_true((p->decals != HL_DECALS_NONE) == n->decals);
    if (p->pipeline != HL_PIPELINE_INFERRED)
        return;
    assert_true(p->batch >= 1 && p->batch <= HL_BATCH_MAX);
    assert_true(p->tile >= 8 && p->tile <= 256);
    assert_true(p->light_path >= HL_LIGHT_PATH_RECTS &&
                p->light_path <= HL_LIGHT_PATH_VOLUMES);
    assert_true(p->light_path != HL_LIGHT_PATH_LISTS ||
                caps->max_storage_bytes > 0);
    assert_true(!p->tile_depth || !n->no_tile_depth);
}

/* ---- properties ------------------------------------------------------- */

struct guarded { uint8_t before[64]; struct hl_plan plan; uint8_t after[64]; };

static void check_guards(const struct guarded *g)
{
    for (int i = 0; i < 64; i++)
        assert_true(g->before[i] == 0xC3 && g->after[i] == 0xC3);
}

static bool zeroed(const void *p, size_t bytes)
{
    const uint8_t *b = p;
    for (size_t i = 0; i < bytes; i++)
        if (b[i])
            return false;
    return true;
}

/* Zero but for what says why. */
static bool only_reasons(const struct hl_plan *p)
{
    struct hl_plan rest = *p;
    assert_true(p->n_reasons < HL_PLAN_REASONS);
    memset(rest.reason, 0, rest.n_reasons * sizeof *rest.reason);
    rest.n_reasons = 0;
    return zeroed(&rest, sizeof rest);
}

/* Any needs on any machine: a sound plan, or a refusal that names a need. */
static void anything_gives_a_plan_or_a_refusal(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t made = 0, refused[HL_REFUSED_COUNT] = { 0 };
    for (uint32_t i = 0; i < 100000; i++) {
        struct hl_needs n = some_needs(&seed);
        some_budget(&n, &seed);
        struct hl_caps c = some_caps(&seed);
        struct guarded a, b;
        enum hl_pipeline want =
            (enum hl_pipeline)some_choice(&seed, HL_PIPELINE_COUNT);
        enum hl_refusal why = HL_REFUSED_COUNT, again;
        memset(&a, 0xC3, sizeof a);
        memset(&b, 0xC3, sizeof b);
        memset(&b.plan, 0x11, sizeof b.plan);
        enum hl_result r = hl_plan_make(&a.plan, want, &n, &c, &why);
        check_guards(&a);
        assert_int_equal(hl_plan_make(&b.plan, want, &n, &c, &again), r);
        assert_memory_equal(&a.plan, &b.plan, sizeof a.plan);
        assert_int_equal(why, again);
        assert_true((unsigned)why < HL_REFUSED_COUNT);
        assert_true((r == HL_OK) == (why == HL_REFUSED_NOTHING));
        refused[why]++;
        if (r == HL_OK) {
            made++;
            check_plan(&a.plan, &n, &c);
            assert_true(want == HL_PIPELINE_AUTO || want == a.plan.pipeline);
        } else {
            assert_true(r == HL_ERR_INVALID || r == HL_ERR_UNSUPPORTED);
            assert_true(only_reasons(&a.plan));
        }
    }
    print_message("%u plans of 100000\n", made);
    assert_true(made > 9000);
    /* Every refusal was met. */
    for (int i = 1; i < HL_REFUSED_COUNT; i++)
        if (refused[i] == 0)
            fail_msg("refusal %d never came", i);
}

/* The same needs with one number raised. */
static struct hl_needs raised(struct hl_needs n, int what)
{
    float a = (float)n.n_lights;
    switch (what) {
    case 0: n.n_lights = n.n_lights * 2 + 1; break;
    case 1: n.n_objects = n.n_objects * 2 + 1; break;
    case 2: n.n_triangles = n.n_triangles * 2 + 1; break;
    case 3: n.lights_per_pixel += 0.6f * (a - n.lights_per_pixel); break;
    case 4: n.lights_per_object += 0.6f * (a - n.lights_per_object); break;
    case 5: n.width += 100; break;
    case 6: n.cover += 0.6f * (1 - n.cover); break;
    default: n.height += 64; break;
    }
    return n;
}

static void more_is_never_cheaper(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct hl_caps c;
    ck_lavapipe(&c);
    for (uint32_t i = 0; i < 20000; i++) {
        struct hl_needs n = usual();
        struct hl_plan p, q;
        n.width = 100 + mk_below(&seed, 2000);
        n.height = 100 + mk_below(&seed, 2000);
        n.n_lights = 1 + mk_below(&seed, 4000);
        n.n_objects = 1 + mk_below(&seed, 4000);
        n.n_triangles = mk_below(&seed, 1000000);
        n.lights_per_pixel = (float)ck_between(&seed, 0.001, n.n_lights);
        n.lights_per_object = (float)ck_between(&seed, 0.001, n.n_lights);
        n.light_path = (enum hl_light_path)mk_below(&seed, 5);
        n.cover = (float)ck_between(&seed, 0.01, 1);
        struct hl_needs more = raised(n, (int)(i % 8));
        enum hl_pipeline want = (enum hl_pipeline)mk_below(&seed,
                                                           HL_PIPELINE_COUNT);
        assert_int_equal(hl_plan_make(&p, want, &n, &c, NULL), HL_OK);
        assert_int_equal(hl_plan_make(&q, want, &more, &c, NULL), HL_OK);
        if (!(q.cost_ms >= p.cost_ms * 0.999999f))
            fail_msg("raising %u: %g ms, before %g ms", i % 8,
                     (double)q.cost_ms, (double)p.cost_ms);
    }
}

/* Lists that know depth leave out where nothing is; rectangles do not. */
static void empty_screens_are_not_lit(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    ck_lavapipe(&c);
    n.n_lights = 8;
    n.lights_per_pixel = 2;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, NULL),
                     HL_OK);
    assert_int_equal(p.light_path, HL_LIGHT_PATH_RECTS);
    n.cover = 0.1f;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, NULL),
                     HL_OK);
    assert_int_equal(p.light_path, HL_LIGHT_PATH_TILES);
    assert_true(p.tile_depth);
}

static void auto_is_the_cheapest(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t chosen[HL_PIPELINE_COUNT] = { 0 };
    for (uint32_t i = 0; i < 20000; i++) {
        struct hl_needs n = some_needs(&seed);
        struct hl_caps c = some_caps(&seed);
        struct hl_plan best, one;
        float least = INFINITY;
        enum hl_refusal why;
        if (hl_plan_make(&best, HL_PIPELINE_AUTO, &n, &c, &why) != HL_OK) {
            if (why == HL_REFUSED_EDRAM && n.light_width)
                continue;            /* whatever else could be drawn         */
            for (int k = 1; k < HL_PIPELINE_COUNT; k++)
                assert_true(hl_plan_make(&one, (enum hl_pipeline)k, &n, &c,
                                         NULL) != HL_OK);
            continue;
        }
        for (int k = 1; k < HL_PIPELINE_COUNT; k++)
            if (hl_plan_make(&one, (enum hl_pipeline)k, &n, &c, NULL) == HL_OK
                && one.cost_ms < least)
                least = one.cost_ms;
        assert_true(best.cost_ms == least);
        chosen[best.pipeline]++;
        /* The same plan but for the reason it was chosen. */
        assert_int_equal(hl_plan_make(&one, best.pipeline, &n, &c, NULL),
                         HL_OK);
        assert_int_equal(best.reason[0].why, HL_WHY_PIPELINE_CHEAPEST);
        assert_int_equal(one.reason[0].why, HL_WHY_PIPELINE_ASKED);
        one.reason[0] = best.reason[0];
        assert_memory_equal(&one, &best, sizeof one);
    }
    for (int k = 1; k < HL_PIPELINE_COUNT; k++)
        assert_true(chosen[k] > 0);
}

/* ---- refusals --------------------------------------------------------- */

static void check_refused(enum hl_pipeline want, const struct hl_needs *n,
                          const struct hl_caps *c, enum hl_refusal expected)
{
    struct hl_plan p;
    enum hl_refusal why;
    enum hl_result r = hl_plan_make(&p, want, n, c, &why);
    if (why != expected)
        fail_msg("refusal %d, not %d", (int)why, (int)expected);
    assert_true((r == HL_OK) == (why == HL_REFUSED_NOTHING));
}

#define REFUSED(field, value, why)                                   \
    do {                                                             \
        struct hl_needs bad_ = usual();                              \
        bad_.field = value;                                          \
        check_refused(HL_PIPELINE_INFERRED, &bad_, &c, why);         \
    } while (0)
#define ALLOWED(field, value) REFUSED(field, value, HL_REFUSED_NOTHING)

static void each_bad_need_is_named(void **state)
{
    (void)state;
    struct hl_caps c;
    ck_lavapipe(&c);
    REFUSED(width, 0, HL_REFUSED_SIZE);
    REFUSED(height, 0, HL_REFUSED_SIZE);
    REFUSED(width, 16385, HL_REFUSED_SIZE);
    REFUSED(height, 16385, HL_REFUSED_SIZE);
    ALLOWED(width, 16384);
    REFUSED(light_width, 100, HL_REFUSED_LIGHT_SIZE);
    REFUSED(light_height, 100, HL_REFUSED_LIGHT_SIZE);
    REFUSED(samples, 2, HL_REFUSED_SAMPLES);
    REFUSED(samples, 3, HL_REFUSED_SAMPLES);
    REFUSED(samples, 16, HL_REFUSED_SAMPLES);
    ALLOWED(samples, 4);
    REFUSED(batch, 17, HL_REFUSED_VALUE);
    ALLOWED(batch, 16);
    REFUSED(tile, 7, HL_REFUSED_VALUE);
    REFUSED(tile, 257, HL_REFUSED_VALUE);
    ALLOWED(tile, 8);
    ALLOWED(tile, 256);
    REFUSED(lights, 8, HL_REFUSED_VALUE);
    REFUSED(light_format, HL_FORMAT_COUNT, HL_REFUSED_VALUE);
    REFUSED(normal_format, HL_FORMAT_COUNT, HL_REFUSED_VALUE);
    REFUSED(light_path, (enum hl_light_path)5, HL_REFUSED_VALUE);
    REFUSED(dsf, (enum hl_dsf)4, HL_REFUSED_VALUE);
    REFUSED(specular, (enum hl_specular_need)3, HL_REFUSED_VALUE);
    REFUSED(exponent, 257, HL_REFUSED_VALUE);
    ALLOWED(exponent, 256);
    const float bad[] = { NAN, INFINITY, -1 };
    for (int i = 0; i < 3; i++) {
        REFUSED(lights_per_pixel, bad[i], HL_REFUSED_VALUE);
        REFUSED(lights_per_object, bad[i], HL_REFUSED_VALUE);
        REFUSED(pair_draws, bad[i], HL_REFUSED_VALUE);
        REFUSED(cover, bad[i], HL_REFUSED_VALUE);
        REFUSED(far, bad[i], HL_REFUSED_VALUE);
        REFUSED(peak, bad[i], HL_REFUSED_VALUE);
        REFUSED(max_error, bad[i], HL_REFUSED_VALUE);
        REFUSED(dsf_k, bad[i], HL_REFUSED_VALUE);
        REFUSED(dsf_c, bad[i], HL_REFUSED_VALUE);
        REFUSED(dsf_tau, bad[i], HL_REFUSED_VALUE);
        REFUSED(exponent, bad[i], HL_REFUSED_VALUE);
    }
}

static void one_side_of_the_light_size_is_not_a_size(void **state)
{
    (void)state;
    struct hl_caps c;
    ck_lavapipe(&c);
    struct hl_needs n = usual();
    n.light_width = 16385;
    n.light_height = 9;
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_LIGHT_SIZE);
    n.light_width = 9;
    n.light_height = 16385;
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_LIGHT_SIZE);
    n.light_height = 16384;
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_NOTHING);
}

static void without(struct hl_caps *c, enum hl_format f, int use)
{
    c->format[f].use = (uint8_t)(c->format[f].use & ~use);
}

static void each_missing_capability_is_named(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps all, c;
    ck_lavapipe(&all);
    c = all;
    without(&c, HL_FORMAT_RG16_UNORM, HL_USE_TARGET);
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_NORMAL_FORMAT);
    check_refused(HL_PIPELINE_FORWARD, &n, &c, HL_REFUSED_NOTHING);
    check_refused(HL_PIPELINE_AUTO, &n, &c, HL_REFUSED_NOTHING);
    c = all;
    for (int i = 0; i < HL_FORMAT_COUNT; i++)
        if (hl_format_info((enum hl_format)i)->kind == HL_KIND_DEPTH)
            without(&c, (enum hl_format)i, HL_USE_TARGET);
    for (int k = 0; k < HL_PIPELINE_COUNT; k++)
        check_refused((enum hl_pipeline)k, &n, &c, HL_REFUSED_DEPTH_FORMAT);
    c = all;
    without(&c, HL_FORMAT_RGBA16_FLOAT, HL_USE_BLEND);
    without(&c, HL_FORMAT_RGBA32_FLOAT, HL_USE_BLEND);
    check_refused(HL_PIPELINE_FORWARD, &n, &c, HL_REFUSED_COLOR_FORMAT);
    check_refused(HL_PIPELINE_FORWARD_MULTIPASS, &n, &c,
                  HL_REFUSED_COLOR_FORMAT);
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_NOTHING);
    without(&c, HL_FORMAT_RGBA16_UNORM, HL_USE_BLEND);
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_LIGHT_FORMAT);
    c = all;
    c.max_storage_bytes = 0;
    n.light_path = HL_LIGHT_PATH_LISTS;
    check_refused(HL_PIPELINE_INFERRED, &n, &c, HL_REFUSED_STORAGE);
    check_refused(HL_PIPELINE_INFERRED, &n, &all, HL_REFUSED_NOTHING);
    check_refused(HL_PIPELINE_COUNT, &n, &all, HL_REFUSED_PIPELINE);
}

static void nothing_to_plan_with_is_refused(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    ck_lavapipe(&c);
    assert_int_equal(hl_plan_make(NULL, HL_PIPELINE_AUTO, &n, &c, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, NULL, &c, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, NULL, NULL),
                     HL_ERR_INVALID);
}

/* ---- nothing more than a scene needs ---------------------------------- */

static struct hl_plan inferred(const struct hl_needs *n)
{
    struct hl_caps c;
    struct hl_plan p;
    ck_lavapipe(&c);
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, n, &c, NULL),
                     HL_OK);
    return p;
}

static bool has_reason(const struct hl_plan *p, enum hl_reason why)
{
    for (uint32_t i = 0; i < p->n_reasons; i++)
        if (p->reason[i].why == why)
            return true;
    return false;
}

static void exponents_cost_a_target_only_where_they_differ(void **state)
{
    (void)state;
    static const struct {
        enum hl_specular_need need;
        uint32_t specular;
        enum hl_reason why;
    } row[] = {
        { HL_NEED_NO_SPECULAR, HL_SPECULAR_NONE, HL_WHY_EXPONENT_NONE },
        { HL_NEED_ONE_EXPONENT, HL_SPECULAR_CONSTANT,
          HL_WHY_EXPONENT_CONSTANT },
        { HL_NEED_EXPONENTS, HL_SPECULAR_CHANNEL, HL_WHY_EXPONENT_CHANNEL },
    };
    for (int i = 0; i < 3; i++) {
        struct hl_needs n = usual();
        n.specular = row[i].need;
        struct hl_plan p = inferred(&n);
        bool channel = row[i].specular == HL_SPECULAR_CHANNEL;
        assert_int_equal(p.specular, row[i].specular);
        assert_true(has_reason(&p, row[i].why));
        assert_true((hl_plan_target(&p, HL_ROLE_EXPONENT) != NULL) ==
                    channel);
        assert_true((p.pass[0].color[2] == HL_ROLE_EXPONENT) == channel);
        assert_true(p.exponent == 32);
    }
}

static void the_filter_is_exact_only_where_it_can_be(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    assert_int_equal(inferred(&n).dsf, HL_DSF_SLOPE);
    n.light_width = 1280;
    n.light_height = 720;
    assert_int_equal(inferred(&n).dsf, HL_DSF_EXACT);
    n.light_height = 719;
    assert_int_equal(inferred(&n).dsf, HL_DSF_SLOPE);
    n.light_height = 720;
    n.samples = 4;               /* a sample's texel is not its pixel's      */
    assert_int_equal(inferred(&n).dsf, HL_DSF_SLOPE);
    n.samples = 1;
    n.dsf = HL_DSF_NONE;
    assert_int_equal(inferred(&n).dsf, HL_DSF_OFF);
    n.dsf = HL_DSF_CONSTANT_TAU;
    assert_int_equal(inferred(&n).dsf, HL_DSF_CONSTANT);
    assert_true(inferred(&n).dsf_tau == 0.01f);
}

static void light_size_is_five_eighths_unless_asked(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_plan p = inferred(&n);
    assert_true(p.light_width == 800 && p.light_height == 450);
    n.width = n.height = 1;
    p = inferred(&n);
    assert_true(p.light_width == 1 && p.light_height == 1);
    n.light_width = 7;
    n.light_height = 3;
    p = inferred(&n);
    assert_true(p.light_width == 7 && p.light_height == 3);
    assert_true(has_reason(&p, HL_WHY_LIGHT_SIZE_ASKED));
}

static void blending_is_planned_only_for_blended_scenes(void **state)
{
    (void)state;
    struct hl_caps c;
    ck_lavapipe(&c);
    for (int k = 1; k < HL_PIPELINE_COUNT; k++)
        for (int blended = 0; blended < 2; blended++) {
            struct hl_needs n = usual();
            struct hl_plan p;
            n.blended = blended;
            assert_int_equal(hl_plan_make(&p, (enum hl_pipeline)k, &n, &c,
                                          NULL), HL_OK);
            bool last = p.pass[p.n_passes - 1].role == HL_PASS_BLENDED;
            assert_true(last == (blended != 0));
        }
}

/* ---- light formats ---------------------------------------------------- */

/* Predicted for values of an eighth of the peak: u (n + 1) / 2 with
 * u = 2^-10 for half floats (conformance b3). */
static void light_format_follows_the_error(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    n.light_path = HL_LIGHT_PATH_LISTS;          /* one blend                */
    struct hl_plan p = inferred(&n);
    const struct hl_plan_target *t = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_int_equal(t->format, HL_FORMAT_RGBA16_FLOAT);
    ck_near((double)t->error, ldexp(1, -10), 1e-9);
    assert_true(p.light_scale == 1);
    n.light_path = HL_LIGHT_PATH_RECTS;
    n.batch = 1;
    n.lights_per_pixel = 100;                    /* 101 blends               */
    p = inferred(&n);
    t = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_int_equal(t->format, HL_FORMAT_RGBA32_FLOAT);
    n.max_error = 60;                            /* 5 % is good enough       */
    p = inferred(&n);
    t = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_int_equal(t->format, HL_FORMAT_RGBA16_FLOAT);
    ck_near((double)t->error, 102 * ldexp(1, -11), 1e-6);
    n.max_error = 4;
    n.lights_per_pixel = 30;                     /* 31: unorm 0.19 %         */
    p = inferred(&n);
    t = hl_plan_target(&p, HL_ROLE_LIGHT);
    assert_int_equal(t->format, HL_FORMAT_RGBA16_UNORM);
    assert_true(p.light_scale == 20 && p.light_out == 1.0f / 20);
    n.peak = 0;                                  /* no scale, no unorm       */
    p = inferred(&n);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_LIGHT)->format,
                     HL_FORMAT_RGBA32_FLOAT);
}

static void an_asked_light_format_is_taken_or_refused(void **state)
{
    (void)state;
    struct hl_caps c;
    ck_lavapipe(&c);
    for (int f = 1; f < HL_FORMAT_COUNT; f++) {
        struct hl_needs n = usual();
        struct hl_plan p;
        enum hl_refusal why;
        n.light_format = (enum hl_format)f;
        if (hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, &why) == HL_OK) {
            const struct hl_plan_target *t = hl_plan_target(&p,
                                                            HL_ROLE_LIGHT);
            assert_int_equal(t->format, f);
            assert_true(has_reason(&p, HL_WHY_LIGHT_FORMAT_ASKED));
            /* Three colours and the specular intensity. */
            assert_int_equal(hl_format_info(t->format)->channels, 4);
        } else {
            assert_int_equal(why, HL_REFUSED_LIGHT_FORMAT);
        }
        n.peak = 0;
        bool unorm = hl_format_info(n.light_format)->kind == HL_KIND_UNORM;
        if (unorm)
            check_refused(HL_PIPELINE_INFERRED, &n, &c,
                          HL_REFUSED_LIGHT_FORMAT);
    }
}

static void many_blends_need_a_better_frame(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    float last = 0;
    ck_lavapipe(&c);
    for (uint32_t lights = 1; lights; lights = lights >> 30 ? 0 : lights * 4) {
        n.n_lights = lights;
        assert_int_equal(hl_plan_make(&p, HL_PIPELINE_FORWARD_MULTIPASS, &n,
                                      &c, NULL), HL_OK);
        const struct hl_plan_target *t = hl_plan_target(&p, HL_ROLE_COLOR);
        /* Half a code of 8-bit sRGB, which moves by up to 106 codes a unit
         * of relative error. */
        bool fine = 106.0 * (lights + 1) / 2 / 1024 <= 0.5;
        assert_int_equal(t->format, fine ? HL_FORMAT_RGBA16_FLOAT
                                         : HL_FORMAT_RGBA32_FLOAT);
        assert_true(t->error >= last || !fine);
        last = fine ? t->error : last;
    }
    n.n_lights = 0xffffffff;                     /* no overflow into none    */
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_FORWARD, &n, &c, NULL),
                     HL_OK);
    assert_int_equal(hl_plan_target(&p, HL_ROLE_COLOR)->format,
                     HL_FORMAT_RGBA32_FLOAT);
}

/* ---- costs ------------------------------------------------------------ */

/* Six maps stand three in a row, of 64 texels at least. */
static void small_machines_have_no_maps(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    enum hl_refusal why;
    ck_lavapipe(&c);
    n.width = n.height = 64;
    n.shadows = HL_SHADOWS_MAPS;
    n.n_shadow_lights = 1;
    n.shadow_points = true;
    c.max_tex_dim = 192;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, &why),
                     HL_OK);
    assert_int_equal(p.shadow_size, 64);
    c.max_tex_dim = 191;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, &why),
                     HL_ERR_UNSUPPORTED);
    assert_int_equal(why, HL_REFUSED_SHADOWS);
}

static void few_lights_are_drawn_forward_many_inferred(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    ck_lavapipe(&c);
    n.n_lights = 3;
    n.lights_per_pixel = 2;
    n.lights_per_object = 2;
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &c, NULL), HL_OK);
    assert_int_equal(p.pipeline, HL_PIPELINE_FORWARD);
    n = usual();
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &c, NULL), HL_OK);
    assert_int_equal(p.pipeline, HL_PIPELINE_INFERRED);
}

static void a_machine_without_costs_still_plans(void **state)
{
    (void)state;
    struct hl_needs n = usual();
    struct hl_caps c;
    struct hl_plan p;
    ck_lavapipe(&c);
    memset(&c.cost, 0, sizeof c.cost);
    assert_int_equal(hl_plan_make(&p, HL_PIPELINE_AUTO, &n, &c, NULL), HL_OK);
    assert_true(p.cost_ms == 0);
}

/* ---- layout ----------------------------------------------------------- */

/* Conformance b1 at 90 degrees, and b3. */
static void encoding_errors_are_the_derived_ones(void **state)
{
    (void)state;
    ck_near((double)hl_normal_error(HL_FORMAT_RG16_UNORM), 0.0035, 0.00002);
    ck_near((double)hl_normal_error(HL_FORMAT_RG16_SNORM), 0.0035, 0.00002);
    ck_near((double)hl_normal_error(HL_FORMAT_RG8_UNORM), 0.9, 0.02);
    /* Of 0..1, truncating: twice b1's 0.112, which rounds. */
    ck_near((double)hl_normal_error(HL_FORMAT_RG16_FLOAT), 0.224, 0.002);
    assert_true(hl_accumulation_error(HL_FORMAT_RGBA16_FLOAT, 0) ==
                hl_accumulation_error(HL_FORMAT_RGBA16_FLOAT, 1));
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGBA16_FLOAT, 287),
            144.0 / 1024, 1e-6);
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGBA8_UNORM, 1),
            4.0 / 255, 1e-6);
    ck_near((double)hl_accumulation_error(HL_FORMAT_RGBA16_UNORM, 100),
            400.0 / 65535, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(anything_gives_a_plan_or_a_refusal),
        cmocka_unit_test(more_is_never_cheaper),
        cmocka_unit_test(empty_screens_are_not_lit),
        cmocka_unit_test(auto_is_the_cheapest),
        cmocka_unit_test(each_bad_need_is_named),
        cmocka_unit_test(small_machines_have_no_maps),
        cmocka_unit_test(one_side_of_the_light_size_is_not_a_size),
        cmocka_unit_test(each_missing_capability_is_named),
        cmocka_unit_test(nothing_to_plan_with_is_refused),
        cmocka_unit_test(exponents_cost_a_target_only_where_they_differ),
        cmocka_unit_test(the_filter_is_exact_only_where_it_can_be),
        cmocka_unit_test(light_size_is_five_eighths_unless_asked),
        cmocka_unit_test(blending_is_planned_only_for_blended_scenes),
        cmocka_unit_test(light_format_follows_the_error),
        cmocka_unit_test(an_asked_light_format_is_taken_or_refused),
        cmocka_unit_test(many_blends_need_a_better_frame),
        cmocka_unit_test(few_lights_are_drawn_forward_many_inferred),
        cmocka_unit_test(a_machine_without_costs_still_plans),
        cmocka_unit_test(encoding_errors_are_the_derived_ones),
    };
    return cmocka_run_group_tests_name("plans", tests, NULL, NULL);
}
