/* SPDX-License-Identifier: Zlib */
/* Inferred lighting (Kircher, Lawrance 2009): geometry and light passes at
 * L-buffer size, material pass at frame size through the DSF. */
#include <string.h>
#include "core/pipe.h"
#include "core/vec.h"

/* ---- sizes -------------------------------------------------------------- */

/* K Fig. 9: 800 x 450 under 1280 x 720, five eighths a side. */
static uint32_t five_eighths(uint32_t x)
{
    uint32_t y = (x * 5 + 4) / 8;
    return y ? y : 1;
}

static void choose_size(struct hl_plan *p, const struct hl_ask *ask)
{
    p->light_width = ask->n.light_width;
    p->light_height = ask->n.light_height;
    bool asked = p->light_width != 0;
    if (!asked) {
        p->light_width = five_eighths(p->width);
        p->light_height = five_eighths(p->height);
    }
    if (ask->fit_width) {
        hl_plan_why(p, HL_WHY_LIGHT_SIZE_EDRAM, (float)ask->fit_width,
                    (float)ask->fit_height, (float)p->light_width,
                    (float)p->light_height);
        p->light_width = ask->fit_width;
        p->light_height = ask->fit_height;
        return;
    }
    hl_plan_why(p, asked ? HL_WHY_LIGHT_SIZE_ASKED : HL_WHY_LIGHT_SIZE_DEFAULT,
                (float)p->light_width, (float)p->light_height,
                (float)p->width, (float)p->height);
}

/* ---- G-buffer ----------------------------------------------------------- */

static void add_depth(struct hl_plan *p, const struct hl_ask *ask,
                      enum hl_format depth,
                      const struct hl_profile_format *row)
{
    struct hl_plan_target *t =
        hl_plan_add_target(p, HL_ROLE_LIGHT_DEPTH, depth, p->light_width,
                           p->light_height, 1);
    hl_plan_keep(p, t, ask->caps, row, true);
    p->depth_read = row ? row->depth_read : HL_DEPTH_READ_FLOAT;
    t->read_by = 1u << HL_PASS_LIGHT;
}

/* Normals as the pairs, which is what a profile rules, or as asked; NONE: not
 * in that format. Two numbers of 0..1 whatever it is, so that stages do not
 * tell. */
static enum hl_format normal_format(const struct hl_ask *ask,
                                    enum hl_format pair)
{
    enum hl_format f = ask->n.normal_format;
    bool ruled = ask->caps->profile.two16[0].format != HL_FORMAT_NONE;
    if (f == HL_FORMAT_NONE || f == pair)
        return pair;
    bool known = f == HL_FORMAT_RG8_UNORM || f == HL_FORMAT_RG16_FLOAT;
    return known && !ruled && pair != HL_FORMAT_NONE &&
           hl_format_usable(ask->caps, f, HL_USE_TARGET | HL_USE_SAMPLED, 1)
           ? f : HL_FORMAT_NONE;
}

static enum hl_refusal choose_gbuffer(struct hl_plan *p,
                                      const struct hl_ask *ask)
{
    const enum hl_format two16[] = { HL_FORMAT_RG16_UNORM, HL_FORMAT_NONE };
    const struct hl_profile *c = &ask->caps->profile;
    const struct hl_profile_format *depth_row, *row;
    int use = HL_USE_TARGET | HL_USE_SAMPLED;
    uint32_t w = p->light_width, h = p->light_height;
    row = hl_plan_row(ask->caps, c->two16, HL_FORMAT_NONE, use, 1);
    enum hl_format pair = row ? row->format
                          : c->two16[0].format ? HL_FORMAT_NONE
                          : hl_format_pick(ask->caps, two16, use, 1);
    enum hl_format normal = normal_format(ask, pair);
    enum hl_format depth = hl_plan_light_depth(p, ask, use, &depth_row);
    if (normal == HL_FORMAT_NONE)
        return HL_REFUSED_NORMAL_FORMAT;
    if (depth == HL_FORMAT_NONE)
        return HL_REFUSED_DEPTH_FORMAT;
    hl_plan_two16(p, ask, row);
    struct hl_plan_target *t;
    t = hl_plan_add_target(p, HL_ROLE_NORMAL, normal, w, h, 1);
    hl_plan_keep(p, t, ask->caps, row, true);
    t->error = hl_normal_error(t->sample_as ? t->sample_as : normal);
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_why(p, HL_WHY_NORMAL_FORMAT, (float)normal, t->error,
                ask->n.normal_format ? 1 : 0, 0);
    t = hl_plan_add_target(p, HL_ROLE_DSF, pair, w, h, 1);
    hl_plan_keep(p, t, ask->caps, row, true);
    if (!p->float_taps)
        t->sample_as = HL_FORMAT_R32_UINT;
    t->error = ask->n.far / hl_plan_pair_steps(p->two16) * 0.5f;
    t->read_by = 1u << HL_PASS_MATERIAL;
    hl_plan_why(p, HL_WHY_DSF_FORMAT, (float)pair, t->error, ask->n.far, 0);
    if (p->float_taps)
        hl_plan_why(p, HL_WHY_FLOAT_TAPS, 0, 0, 0, 0);
    add_depth(p, ask, depth, depth_row);
    return HL_REFUSED_NOTHING;
}

/* ---- passes ------------------------------------------------------------- */

static enum hl_refusal add_passes(struct hl_plan *p, const struct hl_ask *ask)
{
    enum hl_compare nearer = p->reversed_depth ? HL_COMPARE_GREATER
                                               : HL_COMPARE_LESS;
    struct hl_plan_pass *g = hl_plan_add_pass(p, HL_PASS_GEOMETRY);
    uint32_t colors = 0;
    g->color[colors++] = HL_ROLE_NORMAL;
    g->color[colors++] = HL_ROLE_DSF;
    if (hl_plan_target(p, HL_ROLE_EXPONENT))
        g->color[colors++] = HL_ROLE_EXPONENT;
    if (p->motion)
        g->color[colors++] = HL_ROLE_MOTION;
    g->depth = HL_ROLE_LIGHT_DEPTH;
    g->depth_write = true;
    g->depth_test = nearer;
    enum hl_refusal r = hl_plan_depth_read(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    struct hl_plan_pass *l = hl_plan_add_pass(p, HL_PASS_LIGHT);
    /* What is tested, and how, is the light volumes' own. */
    bool volumes = p->light_path == HL_LIGHT_PATH_VOLUMES;
    if (ask->n.light_depth_bound || volumes) {
        l->depth = HL_ROLE_LIGHT_DEPTH;
        l->depth_read_only = !volumes;
    }
    l->color[0] = HL_ROLE_LIGHT;
    l->repeat = p->light_path == HL_LIGHT_PATH_RECTS || volumes
                ? HL_PER_LIGHTS
                : p->light_path == HL_LIGHT_PATH_TILES ? HL_PER_TILE : HL_ONCE;
    l->blend = p->light_path == HL_LIGHT_PATH_LISTS ? HL_BLEND_OFF
                                                    : HL_BLEND_ADD;
    l->lights_a_draw = p->light_path == HL_LIGHT_PATH_LISTS ? 0 : p->batch;
    if (p->shadows == HL_SHADOWS_VOLUMES)
        hl_plan_shadowed_pass(p);
    else if (p->shadows == HL_SHADOWS_MAPS)
        hl_plan_map_passes(p, ask);
    struct hl_plan_pass *m = hl_plan_add_pass(p, HL_PASS_MATERIAL);
    m->color[0] = HL_ROLE_COLOR;
    m->depth = HL_ROLE_DEPTH;
    m->depth_write = true;
    m->depth_test = nearer;
    return HL_REFUSED_NOTHING;
}

/* Pairs beside normal and DSF, nanoseconds an L texel: BRDFs are written and
 * fetched again, motion is written. Four bytes cost half of what blending
 * eight does. */
static double pairs_cost(const struct hl_plan *p,
                         const struct hl_cost_model *c)
{
    double write = 1.5 * 0.5 * (double)c->blend_ns;
    return (p->brdfs ? write + (double)c->fetch_ns : 0) +
           (p->motion ? write : 0);
}

/* Bytes an L texel of channels beside normal and DSF; the reader of motion is
 * not this frame's. */
static double channels_moved(const struct hl_plan *p)
{
    const struct hl_plan_target *e = hl_plan_target(p, HL_ROLE_EXPONENT);
    return (e ? 2 * hl_format_info(e->format)->bytes : 0) +
           (p->motion ? 4 : 0);
}

/* Geometry twice; the G-buffer written, the DSF's taps read a pixel. */
static double geometry_cost(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double taps = p->dsf == HL_DSF_EXACT ? 1 : 4;
    double dsf = p->dsf == HL_DSF_EXACT || p->dsf == HL_DSF_OFF ? 0 : 4;
    double fetch = hl_fetch_ns(ask->caps,
                               hl_plan_target(p, HL_ROLE_LIGHT)->format);
    double light = (double)p->light_width * p->light_height;
    double frame = hl_plan_shaded_pixels(ask);
    return 2.0 * ask->n.n_objects * (double)c->draw_ns +
           2.0 * ask->n.n_triangles * (double)c->vertex_ns +
           hl_plan_overdraw(ask) * light * (double)c->pixel_ns * 2 +
           light * pairs_cost(p, c) +
           hl_plan_overdraw(ask) * frame *
           ((double)c->pixel_ns + dsf * (double)c->fetch_ns + taps * fetch);
}

/* Bytes a frame pixel: every target written, and read where it is sampled. */
static double moved(const struct hl_plan *p, double resolved)
{
    double pixels = (double)p->width * p->height;
    double ratio = (double)p->light_width * p->light_height / pixels;
    double texel = hl_format_info(hl_plan_target(p, HL_ROLE_LIGHT)->format)
                   ->bytes;
    double color = hl_format_info(hl_plan_target(p, HL_ROLE_COLOR)->format)
                   ->bytes;
    double normal = hl_format_info(hl_plan_target(p, HL_ROLE_NORMAL)->format)
                    ->bytes;
    double taps = p->dsf == HL_DSF_EXACT ? 1 : 4;
    double dsf = p->dsf == HL_DSF_SLOPE || p->dsf == HL_DSF_CONSTANT ? 16 : 0;
    double copy = hl_plan_target(p, HL_ROLE_DEPTH_COPY) ? 2 * 4 : 0;
    return ratio * (2 * (normal + 8) + channels_moved(p) + copy + texel) +
           taps * texel + dsf + (color + 4) * p->samples + resolved / pixels;
}

/* ---- no lights ---------------------------------------------------------- */

/* What stages are bound to, read or not. */
static bool kept_dark(enum hl_role r)
{
    return r != HL_ROLE_NORMAL && r != HL_ROLE_EXPONENT &&
           r != HL_ROLE_LIGHT_DEPTH && r != HL_ROLE_DEPTH_COPY;
}

/* Reasons for what a dark plan no longer has. */
static bool of_light(const struct hl_plan_reason *r)
{
    switch (r->why) {
    case HL_WHY_LIGHT_SIZE_ASKED: case HL_WHY_LIGHT_SIZE_DEFAULT:
    case HL_WHY_LIGHT_SIZE_EDRAM: case HL_WHY_NORMAL_FORMAT:
    case HL_WHY_DSF_FORMAT: case HL_WHY_TWO16_FIXED32:
    case HL_WHY_TWO16_SIGNED: case HL_WHY_TWO16_BYTES_ARGB:
    case HL_WHY_TWO16_BYTES: case HL_WHY_ID_STEPS: case HL_WHY_MRT_FORMAT:
    case HL_WHY_FLOAT_TAPS: case HL_WHY_PATH_ASKED:
    case HL_WHY_PATH_CHEAPEST: case HL_WHY_TILE_DEPTH:
    case HL_WHY_LIGHT_FORMAT_ASKED: case HL_WHY_LIGHT_FORMAT_ERROR:
    case HL_WHY_LIGHT_FORMAT_PROFILE: case HL_WHY_LIGHT_FORMAT_DARK:
    case HL_WHY_LIGHT_ALPHA: case HL_WHY_NO_BLEND: case HL_WHY_LIGHT_RANGE:
    case HL_WHY_LIGHT_PEAK_CUT: case HL_WHY_LIGHT_PEAK_DEFAULT:
    case HL_WHY_DEPTH_BARG: case HL_WHY_DEPTH_PLAIN:
    case HL_WHY_DEPTH_IN_PLACE: case HL_WHY_DEPTH_READ_ONLY:
    case HL_WHY_DEPTH_COPY:
        return true;
    case HL_WHY_STAND_IN:
        return !kept_dark((enum hl_role)(int)r->arg[2]);
    default:
        return false;
    }
}

static void drop_reasons(struct hl_plan *p)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n_reasons; i++)
        if (!of_light(&p->reason[i]))
            p->reason[n++] = p->reason[i];
    memset(&p->reason[n], 0, (p->n_reasons - n) * sizeof *p->reason);
    p->n_reasons = n;
}

/* A scene without lights pays for none (K 7.1: the base cost): no geometry
 * pass, no light pass, no filter; material stages still have their two
 * textures, of one texel. */
static void darken(struct hl_plan *p)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n_targets; i++)
        if (kept_dark(p->target[i].role))
            p->target[n++] = p->target[i];
    memset(&p->target[n], 0, (p->n_targets - n) * sizeof *p->target);
    p->n_targets = n;
    n = 0;
    for (uint32_t i = 0; i < p->n_passes; i++)
        if (p->pass[i].role == HL_PASS_MATERIAL)
            p->pass[n++] = p->pass[i];
    memset(&p->pass[n], 0, (p->n_passes - n) * sizeof *p->pass);
    p->n_passes = n;
    p->dsf = HL_DSF_DARK;
    p->specular = HL_SPECULAR_NONE;
    p->light_path = HL_LIGHT_PATH_RECTS;
    p->tile_depth = false;
    p->light_error = 0;
    drop_reasons(p);
    hl_plan_why(p, HL_WHY_NO_LIGHT_PASS, 0, 0, 0, 0);
}

static double dark_cost(const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    return ask->n.n_objects * (double)c->draw_ns +
           ask->n.n_triangles * (double)c->vertex_ns +
           hl_plan_overdraw(ask) * hl_plan_shaded_pixels(ask) *
           (double)c->pixel_ns;
}

static enum hl_refusal plan_dark(struct hl_plan *p, const struct hl_ask *lit)
{
    struct hl_ask ask = *lit;
    uint32_t unused;
    ask.n.shadows = HL_SHADOWS_NONE;
    ask.n.translucency = HL_TRANSLUCENCY_FORWARD;
    enum hl_refusal r = hl_plan_common(p, &ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    choose_size(p, &ask);
    uint32_t w = p->light_width, h = p->light_height;
    p->light_width = p->light_height = 1;
    r = choose_gbuffer(p, &ask);
    if (r == HL_REFUSED_NOTHING) {
        hl_plan_decals(p, &ask, HL_FORMAT_NONE);
        r = hl_plan_translucency(p, &ask);
    }
    if (r == HL_REFUSED_NOTHING) {
        hl_plan_light_path(p, &ask);
        r = hl_plan_light_format(p, &ask);
    }
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_frame_targets(p, &ask, ask.n.blended || ask.n.decals);
    if (r == HL_REFUSED_NOTHING)
        r = add_passes(p, &ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    p->light_width = w;
    p->light_height = h;
    darken(p);
    p->moved_per_pixel = (float)((
        hl_format_info(hl_plan_target(p, HL_ROLE_COLOR)->format)->bytes + 4) *
        p->samples);
    hl_plan_finish(p, &ask, dark_cost(&ask));
    return hl_plan_edram(p, &ask, &unused, &unused);
}

/* ---- the pipeline ------------------------------------------------------- */

static enum hl_refusal plan_inferred(struct hl_plan *p,
                                     const struct hl_ask *ask,
                                     uint32_t *fit_width,
                                     uint32_t *fit_height)
{
    if (ask->n.n_lights == 0 && !ask->n.motion)
        return plan_dark(p, ask);
    enum hl_refusal r = hl_plan_common(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    choose_size(p, ask);
    r = choose_gbuffer(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    r = hl_plan_channels(p, ask);
    if (r == HL_REFUSED_NOTHING) {
        hl_plan_decals(p, ask, hl_plan_target(p, HL_ROLE_NORMAL)->format);
        r = hl_plan_translucency(p, ask);
    }
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_shadows(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    if (ask->n.light_path == HL_LIGHT_PATH_LISTS &&
        ask->caps->max_storage_bytes == 0)
        return HL_REFUSED_STORAGE;
    double lights = hl_plan_light_path(p, ask);
    r = hl_plan_light_format(p, ask);
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_frame_targets(p, ask, ask->n.blended || ask->n.decals);
    if (r != HL_REFUSED_NOTHING)
        return r;
    hl_plan_dsf(p, ask);
    r = add_passes(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    p->moved_per_pixel = (float)moved(p, hl_plan_resolves(p, ask));
    hl_plan_finish(p, ask, geometry_cost(p, ask) + lights +
                           hl_plan_shadow_cost(p, ask));
    return hl_plan_edram(p, ask, fit_width, fit_height);
}

/* Where EDRAM cannot hold the five eighths, once more with what it holds. */
enum hl_refusal hl_plan_inferred(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_plan start = *p;
    struct hl_ask again = *ask;
    enum hl_refusal r = plan_inferred(p, ask, &again.fit_width,
                                      &again.fit_height);
    uint32_t unused;
    if (r != HL_REFUSED_EDRAM || again.fit_width == 0)
        return r;
    *p = start;
    return plan_inferred(p, &again, &unused, &unused);
}
