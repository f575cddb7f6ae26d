/* SPDX-License-Identifier: Zlib */
/* Any needs on any machine: the planner gives a plan that holds together, or
 * refuses and says why; and both can be printed. */
#include <math.h>
#include <string.h>
#include "core/plan.h"
#include "platforms/cli/plan_text.h"
#include "tests/fuzz.h"

/* Wild: any number, or one that is asked for by a sane caller. */
static float real(struct fz *f, bool wild, float high)
{
    return wild ? fz_number(f) : high * (float)fz_below(f, 1025) / 1024;
}

static uint32_t count(struct fz *f, bool wild, uint32_t high)
{
    return wild ? fz_count(f) : fz_below(f, high + 1);
}

static uint32_t choice(struct fz *f, bool wild, uint32_t n)
{
    return wild ? fz_choice(f, n) : fz_below(f, n);
}

static void some_sizes(struct fz *f, bool wild, struct hl_needs *n)
{
    n->width = count(f, wild, 2048) + (wild ? 0u : 1u);
    n->height = count(f, wild, 2048) + (wild ? 0u : 1u);
    if (fz_bool(f)) {
        n->light_width = count(f, wild, 2048) + (wild ? 0u : 1u);
        n->light_height = count(f, wild, 2048) + (wild ? 0u : 1u);
    }
    n->samples = fz_bool(f) ? 0 : wild ? fz_count(f) : 1u << fz_below(f, 4);
}

static void some_choices(struct fz *f, bool wild, struct hl_needs *n)
{
    n->decals = fz_bool(f);
    n->light_depth_bound = fz_bool(f);
    n->light_path = (enum hl_light_path)choice(f, wild, 5);
    n->batch = fz_bool(f) ? 0 : choice(f, wild, 17);
    n->tile = fz_bool(f) ? 0 : (wild ? 0u : 8u) + count(f, wild, 248);
    n->no_tile_depth = fz_bool(f);
    n->no_scissor = fz_bool(f);
    n->dsf = (enum hl_dsf)choice(f, wild, 5);
    n->dsf_k = fz_bool(f) ? 0 : real(f, wild, 1000);
    n->dsf_c = fz_bool(f) ? 0 : real(f, wild, 1);
    n->dsf_tau = fz_bool(f) ? 0 : real(f, wild, 1);
    n->light_format = (enum hl_format)(fz_below(f, 4) ? 0u : choice(
                                       f, wild, HL_FORMAT_COUNT));
    n->normal_format = (enum hl_format)(fz_below(f, 4) ? 0u : choice(
                                        f, wild, HL_FORMAT_COUNT));
    n->half_pixel = (enum hl_half_pixel)(fz_below(f, 4) ? 0u : choice(
                                         f, wild, 4));
}

static void some_features(struct fz *f, bool wild, struct hl_needs *n)
{
    n->blended_layers = count(f, wild, 20);
    n->shadows = (enum hl_shadows)choice(f, wild, 3);
    n->n_shadow_lights = count(f, wild, 100);
    n->shadow_points = fz_bool(f);
    n->shadow_size = fz_bool(f) ? 0 : count(f, wild, 4096);
    n->volume_texels = fz_bool(f) ? 0 : count(f, wild, 100000);
    n->motion = fz_bool(f);
    n->brdfs = fz_bool(f);
    n->translucency = (enum hl_translucency)choice(f, wild, 4);
    n->stipple_filter = (enum hl_stipple_filter)choice(f, wild, 3);
    n->stipple_mode = (enum hl_stipple_mode)choice(f, wild, 3);
    n->fill = (enum hl_fill)choice(f, wild, 3);
    n->fetch = (enum hl_fetch)choice(f, wild, 3);
    n->no_centroid = fz_bool(f);
}

static void some_budget(struct fz *f, bool wild, struct hl_needs *n)
{
    float *number[] = { &n->probe.full, &n->probe.half, &n->probe.eight,
                        &n->probe.eight_blends, &n->probe.three_quarters,
                        &n->probe.quarter, &n->probe.forward };
    for (size_t i = 0; i < sizeof number / sizeof *number; i++)
        *number[i] = fz_bool(f) ? 0 : real(f, wild, 40);
    n->budget_codes = fz_bool(f) ? 0 : real(f, wild, 30);
    n->budget_ms = fz_bool(f) ? 0 : real(f, wild, 1000);
}

static struct hl_needs some_needs(struct fz *f, bool wild)
{
    struct hl_needs n;
    memset(&n, 0, sizeof n);
    some_sizes(f, wild, &n);
    n.n_objects = fz_count(f);
    n.n_triangles = fz_count(f);
    n.n_lights = fz_count(f);
    n.lights_per_pixel = real(f, wild, 1000);
    n.lights_per_object = real(f, wild, 1000);
    n.cover = fz_bool(f) ? 0 : real(f, wild, 1);
    n.pair_draws = fz_bool(f) ? 0 : real(f, wild, 1e6f);
    n.n_regions = fz_count(f);
    n.lights = choice(f, wild, 8);
    n.specular = (enum hl_specular_need)choice(f, wild, 3);
    n.exponent = real(f, wild, 256);
    n.blended = fz_bool(f);
    n.far = real(f, wild, 10000);
    n.peak = real(f, wild, 10000);
    n.max_error = fz_bool(f) ? 0 : real(f, wild, 255);
    some_choices(f, wild, &n);
    if (fz_bool(f))
        some_features(f, wild, &n);
    if (fz_below(f, 4) == 0)
        some_budget(f, wild, &n);
    return n;
}

/* ---- what any plan must be ---------------------------------------------- */

/* Where the machine keeps console memory, a target's own tiles are within it;
 * elsewhere they are only counted. */
static void check_edram(const struct hl_plan_target *t,
                        const struct hl_caps *caps)
{
    const struct hl_profile *machine = &caps->profile;
    if (!t->edram_tiles || !caps->console_memory) {
        FZ_CHECK(t->console.edram_tile == 0);
        return;
    }
    FZ_CHECK(t->console.edram_tile >= 1);
    FZ_CHECK(t->console.edram_tile - 1u + t->edram_tiles <=
             machine->edram_tiles);
    FZ_CHECK(t->edram_tiles == hl_edram_tiles(machine, t->format, t->width,
                                              t->height, t->samples));
}

static void check_target(const struct hl_plan *p,
                         const struct hl_plan_target *t,
                         const struct hl_caps *caps)
{
    FZ_CHECK(t->role > HL_ROLE_NONE && t->role < HL_ROLE_COUNT);
    FZ_CHECK(hl_plan_target(p, t->role) == t);
    FZ_CHECK(t->format > HL_FORMAT_NONE && t->format < HL_FORMAT_COUNT);
    FZ_CHECK((unsigned)t->sample_as < HL_FORMAT_COUNT);
    FZ_CHECK(caps->format[t->format].use & HL_USE_TARGET);
    FZ_CHECK(caps->format[t->format].samples & t->samples);
    FZ_CHECK(t->width >= 1 && t->width <= caps->max_tex_dim);
    FZ_CHECK(t->height >= 1 && t->height <= caps->max_tex_dim);
    FZ_CHECK(t->bytes == (uint64_t)t->width * t->height * t->samples *
                             hl_format_info(t->format)->bytes);
    FZ_CHECK(t->error >= 0 && isfinite(t->error));
    check_edram(t, caps);
}

static bool share_tiles(const struct hl_plan_target *a,
                        const struct hl_plan_target *b)
{
    uint32_t x = a->console.edram_tile, y = b->console.edram_tile;
    return a != b && x && y && x < y + b->edram_tiles &&
           y < x + a->edram_tiles;
}

/* What a pass draws on is there, can be blended, and does not overlap. */
static void check_pass(const struct hl_plan *p, const struct hl_plan_pass *s,
                       const struct hl_caps *caps)
{
    const struct hl_plan_target *t[4];
    FZ_CHECK(s->role > HL_PASS_NONE && s->role < HL_PASS_ROLE_COUNT);
    FZ_CHECK(s->lights_a_draw <= HL_BATCH_MAX);
    for (int i = 0; i < 4; i++) {
        enum hl_role role = i < 3 ? s->color[i] : s->depth;
        t[i] = hl_plan_target(p, role);
        FZ_CHECK(t[i] || role == HL_ROLE_NONE);
        if (i < 3 && t[i] && s->blend != HL_BLEND_OFF)
            FZ_CHECK(caps->format[t[i]->format].use & HL_USE_BLEND);
        for (int k = 0; k < i; k++)
            FZ_CHECK(!t[i] || !t[k] || !share_tiles(t[i], t[k]));
    }
}

static void check_numbers(const struct hl_plan *p)
{
    const float x[] = { p->exponent, p->dsf_k, p->dsf_c, p->dsf_tau,
                        p->light_scale, p->light_out, p->id_steps, p->far,
                        p->bytes_per_pixel, p->moved_per_pixel,
                        p->light_error, p->cost_ms };
    for (size_t i = 0; i < sizeof x / sizeof *x; i++)
        if (x[i] != x[i]) {
            fprintf(stderr, "number %zu of the plan is no number\n", i);
            abort();
        }
    FZ_CHECK(p->far > 0 && p->light_scale > 0 && p->light_out > 0);
    FZ_CHECK(p->id_steps > 0);
    FZ_CHECK(p->cost_ms >= 0 && p->bytes_per_pixel > 0);
    FZ_CHECK(p->error_codes >= 0 && p->error_codes <= 255);
}

static void check_budget(const struct hl_plan *p, const struct hl_needs *n)
{
    FZ_CHECK(n->budget_codes <= 0 || p->error_codes <= n->budget_codes);
    FZ_CHECK(n->budget_ms <= 0 || p->cost_ms <= n->budget_ms);
}

static void check_reasons(const struct hl_plan *p)
{
    /* One place stays free: a full array may have lost one. */
    FZ_CHECK(p->n_reasons < HL_PLAN_REASONS);
    for (uint32_t i = 0; i < p->n_reasons; i++)
        FZ_CHECK(p->reason[i].why > HL_WHY_NONE &&
                 p->reason[i].why < HL_WHY_COUNT);
}

static void check_plan(const struct hl_plan *p, const struct hl_needs *n,
                       const struct hl_caps *caps)
{
    FZ_CHECK(p->pipeline > HL_PIPELINE_AUTO &&
             p->pipeline < HL_PIPELINE_COUNT);
    FZ_CHECK(p->n_targets >= 1 && p->n_targets <= HL_PLAN_TARGETS);
    FZ_CHECK(p->n_passes >= 1 && p->n_passes <= HL_PLAN_PASSES);
    FZ_CHECK(p->width == n->width && p->height == n->height);
    FZ_CHECK(memchr(p->profile, 0, sizeof p->profile));
    FZ_CHECK(p->edram_tiles <= caps->profile.edram_tiles);
    for (uint32_t i = 0; i < p->n_targets; i++)
        check_target(p, &p->target[i], caps);
    for (uint32_t i = 0; i < p->n_passes; i++)
        check_pass(p, &p->pass[i], caps);
    FZ_CHECK(hl_plan_target(p, HL_ROLE_COLOR));
    check_numbers(p);
    if (p->pipeline != HL_PIPELINE_INFERRED)
        return;
    FZ_CHECK(p->batch >= 1 && p->batch <= HL_BATCH_MAX);
    FZ_CHECK(p->tile >= 8 && p->tile <= 256);
    FZ_CHECK(p->light_path > HL_LIGHT_PATH_AUTO &&
             p->light_path <= HL_LIGHT_PATH_VOLUMES);
    FZ_CHECK(hl_plan_target(p, HL_ROLE_LIGHT));
}

/* ---- printers ------------------------------------------------------------ */

/* A line of text with its end inside the buffer. */
static void check_line(const char *text, size_t bytes)
{
    const char *end = memchr(text, 0, bytes);
    FZ_CHECK(end && end > text);
    for (; *text; text++)
        FZ_CHECK((unsigned char)*text >= 32);
}

static void print(const struct hl_plan *p, enum hl_refusal why, uint32_t cut)
{
    char line[512];
    for (uint32_t i = 0; i < p->n_reasons; i++) {
        memset(line, '#', sizeof line);
        hlc_reason_text(p, i, line, sizeof line);
        check_line(line, sizeof line);
        FZ_CHECK(hlc_reason_section(p->reason[i].why));
        memset(line, '#', sizeof line);
        hlc_reason_text(p, i, line, cut + 1);
        FZ_CHECK(memchr(line, 0, cut + 1) && line[cut + 1] == '#');
    }
    if (why != HL_REFUSED_NOTHING) {
        FZ_CHECK(hlc_refusal_text(why)[0]);
        memset(line, '#', sizeof line);
        hlc_refusal_line(p, why, line, sizeof line);
        check_line(line, sizeof line);
        return;
    }
    FILE *out = fopen("/dev/null", "w");
    if (!out)
        return;
    hl_plan_text(out, p);
    fclose(out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fz f = { data, data + size };
    struct hl_plan a, b;
    struct hl_caps caps;
    enum hl_refusal why = HL_REFUSED_COUNT, again = HL_REFUSED_COUNT;
    bool wild = fz_byte(&f) > 200;
    struct hl_needs n = some_needs(&f, wild);
    enum hl_pipeline want =
        (enum hl_pipeline)choice(&f, wild, HL_PIPELINE_COUNT);
    uint32_t cut = fz_below(&f, 256);
    fz_caps(&f, &caps, fz_byte(&f) < 200);
    memset(&a, 0xC3, sizeof a);
    memset(&b, 0x11, sizeof b);
    enum hl_result r = hl_plan_make(&a, want, &n, &caps, &why);
    FZ_CHECK(hl_plan_make(&b, want, &n, &caps, &again) == r);
    FZ_CHECK(why == again && memcmp(&a, &b, sizeof a) == 0);
    FZ_CHECK((unsigned)why < HL_REFUSED_COUNT);
    FZ_CHECK((r == HL_OK) == (why == HL_REFUSED_NOTHING));
    check_reasons(&a);
    if (r == HL_OK) {
        FZ_CHECK(want == HL_PIPELINE_AUTO || want == a.pipeline);
        check_plan(&a, &n, &caps);
        check_budget(&a, &n);
    } else {
        FZ_CHECK(r == HL_ERR_INVALID || r == HL_ERR_UNSUPPORTED);
        FZ_CHECK(a.n_targets == 0 && a.n_passes == 0);
    }
    print(&a, why, cut);
    return 0;
}
