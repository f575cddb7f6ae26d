/* SPDX-License-Identifier: Zlib */
/* The planner: defaults, what all pipelines share, and the choice. */
#include <string.h>
#include "core/pipe.h"
#include "core/vec.h"

void hl_plan_why(struct hl_plan *p, enum hl_reason why, float a, float b,
                 float c, float d)
{
    if (p->n_reasons >= HL_PLAN_REASONS)
        return;
    struct hl_plan_reason r = { why, { a, b, c, d } };
    p->reason[p->n_reasons++] = r;
}

struct hl_plan_target *hl_plan_add_target(struct hl_plan *p, enum hl_role role,
                                          enum hl_format format,
                                          uint32_t width, uint32_t height,
                                          uint32_t samples)
{
    struct hl_plan_target *t = &p->target[p->n_targets++];
    t->role = role;
    t->format = format;
    t->width = width;
    t->height = height;
    t->samples = samples;
    t->bytes = (uint64_t)width * height * samples *
               hl_format_info(format)->bytes;
    return t;
}

struct hl_plan_pass *hl_plan_add_pass(struct hl_plan *p,
                                      enum hl_pass_role role)
{
    struct hl_plan_pass *pass = &p->pass[p->n_passes++];
    pass->role = role;
    return pass;
}

bool hl_pass_colors(const struct hl_plan_pass *pass, enum hl_role role)
{
    for (int i = 0; i < HL_PLAN_COLORS; i++)
        if (pass->color[i] == role)
            return true;
    return false;
}

const struct hl_plan_target *hl_plan_target(const struct hl_plan *p,
                                            enum hl_role role)
{
    for (uint32_t i = 0; i < p->n_targets; i++)
        if (p->target[i].role == role)
            return &p->target[i];
    return NULL;
}

/* The frame is linear; its 8-bit sRGB code changes by at most 1/2.4 of a
 * code in 255 for a relative change of 1/255 near white, less below: a
 * relative error e moves no code by more than about 106 e. */
static bool color_good_enough(enum hl_format f, uint32_t blends, float codes)
{
    return 106.0f * hl_accumulation_error(f, blends) <= codes * 0.5f;
}

static enum hl_format pick_color(const struct hl_ask *ask, int use,
                                 uint32_t samples, uint32_t blends)
{
    const enum hl_format list[] = { HL_FORMAT_RGBA16_FLOAT,
                                    HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE };
    enum hl_format color = HL_FORMAT_NONE;
    for (int i = 0; list[i]; i++) {
        if (!hl_format_usable(ask->caps, list[i], use, samples))
            continue;
        color = list[i];
        if (color_good_enough(color, blends, ask->n.max_error))
            break;
    }
    return color;
}

enum hl_format hl_plan_depth_format(const struct hl_caps *caps, int use,
                                    uint32_t samples,
                                    const struct hl_profile_format **row)
{
    const enum hl_format depths[] = { HL_FORMAT_D32_FLOAT,
                                      HL_FORMAT_D24_UNORM_S8,
                                      HL_FORMAT_D16_UNORM, HL_FORMAT_NONE };
    *row = hl_plan_row(caps, caps->profile.depth, HL_FORMAT_NONE, use,
                       samples);
    if (*row)
        return (*row)->format;
    return caps->profile.depth[0].format
           ? HL_FORMAT_NONE : hl_format_pick(caps, depths, use, samples);
}

static bool float_depth(enum hl_format f)
{
    return f == HL_FORMAT_D32_FLOAT || f == HL_FORMAT_D32_FLOAT_S8 ||
           f == HL_FORMAT_D24_FLOAT_S8;
}

enum hl_refusal hl_plan_frame_targets(struct hl_plan *p,
                                      const struct hl_ask *ask,
                                      uint32_t blends)
{
    const struct hl_caps *caps = ask->caps;
    uint32_t s = p->samples, w = p->width, h = p->height;
    int use = HL_USE_TARGET | HL_USE_SAMPLED | (blends ? HL_USE_BLEND : 0);
    const struct hl_profile_format *row =
        hl_plan_row(caps, caps->profile.color, HL_FORMAT_NONE, use, s);
    enum hl_format color = row ? row->format
                           : caps->profile.color[0].format ? HL_FORMAT_NONE
                           : pick_color(ask, use, s, blends);
    if (color == HL_FORMAT_NONE)
        return HL_REFUSED_COLOR_FORMAT;
    struct hl_plan_target *t = hl_plan_add_target(p, HL_ROLE_COLOR, color, w,
                                                  h, s);
    float error = hl_accumulation_error(color, blends);
    t->error = error;
    hl_plan_keep(p, t, caps, row, true);
    const struct hl_profile_format *depth_row;
    enum hl_format depth = hl_plan_depth_format(caps, HL_USE_TARGET, s,
                                                &depth_row);
    if (depth == HL_FORMAT_NONE)
        return HL_REFUSED_DEPTH_FORMAT;
    t = hl_plan_add_target(p, HL_ROLE_DEPTH, depth, w, h, s);
    hl_plan_keep(p, t, caps, depth_row, false);
    if (s > 1) {
        t = hl_plan_add_target(p, HL_ROLE_RESOLVED, color, w, h, 1);
        hl_plan_keep(p, t, caps, row, true);
    }
    hl_plan_why(p, HL_WHY_COLOR_FORMAT, (float)color, (float)blends, error,
                ask->n.max_error);
    /* Codes of sRGB in the dark: 12.92 x 255 a unit. */
    if (color == HL_FORMAT_RGB10A2_FLOAT)
        hl_plan_why(p, HL_WHY_COLOR_STEP, 0.25f, 1.0f / 512,
                    12.92f * 255 / 512, 0);
    return HL_REFUSED_NOTHING;
}

enum hl_refusal hl_plan_common(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_needs *n = &ask->n;
    const struct hl_profile_format *row;
    p->width = n->width;
    p->height = n->height;
    p->samples = n->samples;
    p->far = n->far;
    p->falloff = n->lights & 3u;
    p->kinds = n->lights & HL_LIGHTS_CONES ? 1 : 0;
    p->exponent = n->exponent;
    p->light_scale = p->light_out = 1.0f;
    p->brdfs = n->brdfs;
    /* Only the geometry pass has a channel for it. */
    if (n->motion && p->pipeline != HL_PIPELINE_INFERRED)
        return HL_REFUSED_MOTION;
    if (n->shadows != HL_SHADOWS_NONE && p->pipeline != HL_PIPELINE_INFERRED)
        return HL_REFUSED_SHADOWS;
    /* Floating point depth is finest near zero, where 1/z puts the far
     * half of the scene: reversed, the error is the same share of z. */
    p->reversed_depth = float_depth(
        hl_plan_light_depth(p, ask, HL_USE_TARGET | HL_USE_SAMPLED, &row));
    if (p->reversed_depth)
        hl_plan_why(p, HL_WHY_DEPTH_REVERSED, 0, 0, 0, 0);
    if (n->samples > 1)
        hl_plan_why(p, HL_WHY_SAMPLES, (float)n->samples, 0, 0, 0);
    if (n->n_lights == 0)
        hl_plan_why(p, HL_WHY_NO_LIGHTS, 0, 0, 0, 0);
    return hl_plan_profile(p, ask);
}

double hl_plan_shaded_pixels(const struct hl_ask *ask)
{
    return (double)ask->n.width * ask->n.height *
           (1.0 + 0.06 * (ask->n.samples - 1));
}

void hl_plan_finish(struct hl_plan *p, const struct hl_ask *ask,
                    double cost_ns)
{
    double bytes = 0;
    for (uint32_t i = 0; i < p->n_targets; i++)
        bytes += (double)p->target[i].bytes;
    if (ask->n.blended || p->decals != HL_DECALS_NONE) {
        struct hl_plan_pass *b = hl_plan_add_pass(p, HL_PASS_BLENDED);
        b->color[0] = HL_ROLE_COLOR;
        b->depth = HL_ROLE_DEPTH;
        b->depth_test = p->reversed_depth ? HL_COMPARE_GREATER
                                          : HL_COMPARE_LESS;
        b->blend = HL_BLEND_OVER;
    }
    if (!p->stipple &&
        (ask->n.blended || p->decals == HL_DECALS_ALPHA_OBJECTS)) {
        p->translucency = HL_TRANSLUCENCY_FORWARD;
        hl_plan_why(p, HL_WHY_BLENDED_FORWARD, 0, 0, 0, 0);
    }
    double pixels = (double)p->width * p->height;
    p->bytes_per_pixel = (float)(bytes / pixels);
    p->cost_ms = (float)(cost_ns * 1e-6);
}

/* ---- needs -------------------------------------------------------------- */

static bool good(float x, float low, float high)
{
    return x >= low && x <= high;
}

static bool good_budget(const struct hl_needs *n)
{
    const struct hl_probe *p = &n->probe;
    return good(n->budget_codes, 0, 255) && good(n->budget_ms, 0, 1e30f) &&
           good(p->full, 0, 255) && good(p->half, 0, 255) &&
           good(p->eight, 0, 255) && good(p->eight_blends, 0, 1e9f) &&
           good(p->three_quarters, 0, 255) && good(p->quarter, 0, 255) &&
           good(p->forward, 0, 255);
}

static enum hl_refusal check(const struct hl_needs *n,
                             const struct hl_caps *caps)
{
    uint32_t counts = caps->profile.samples ? caps->profile.samples
                                              & caps->samples : caps->samples;
    if (n->width == 0 || n->height == 0 || n->width > caps->max_tex_dim ||
        n->height > caps->max_tex_dim)
        return HL_REFUSED_SIZE;
    if (n->light_width > caps->max_tex_dim ||
        n->light_height > caps->max_tex_dim ||
        (n->light_width == 0) != (n->light_height == 0))
        return HL_REFUSED_LIGHT_SIZE;
    if (n->samples > 8 || (n->samples & (n->samples - 1)) ||
        (n->samples && !(counts & n->samples)))
        return HL_REFUSED_SAMPLES;
    if ((n->batch && n->batch > HL_BATCH_MAX) ||
        (n->tile && (n->tile < 8 || n->tile > 256)) ||
        (unsigned)n->light_format >= HL_FORMAT_COUNT || n->lights > 7 ||
        (unsigned)n->normal_format >= HL_FORMAT_COUNT ||
        (unsigned)n->light_path > HL_LIGHT_PATH_VOLUMES ||
        (unsigned)n->dsf > HL_DSF_CONSTANT_TAU ||
        (unsigned)n->specular > HL_NEED_EXPONENTS ||
        (unsigned)n->half_pixel > HL_HALF_PIXEL_VERTEX ||
        (unsigned)n->translucency > HL_TRANSLUCENCY_4X4 ||
        (unsigned)n->stipple_filter > HL_STIPPLE_BILINEAR ||
        (unsigned)n->stipple_mode > HL_STIPPLE_BY_DEPTH_FREE ||
        (unsigned)n->shadows > HL_SHADOWS_MAPS ||
        (unsigned)n->fill > HL_FILL_DEPTH ||
        (unsigned)n->fetch > HL_FETCH_BILINEAR || n->shadow_size > 16384 ||
        !good(n->lights_per_pixel, 0, 1e9f) ||
        !good(n->lights_per_object, 0, 1e9f) ||
        !good(n->further_draws, 0, 1e12f) ||
        !good(n->further_triangles, 0, 1e15f) ||
        !good(n->further_cover, 0, 1e9f) ||
        !good(n->pair_draws, 0, 1e12f) ||
        !good(n->pair_triangles, 0, 1e15f) ||
        !good(n->cover, 0, 1) ||
        !good(n->pair_cover, 0, 1e9f) || !good(n->far, 0, 1e9f) ||
        !good(n->dsf_k, 0, 1e3f) || !good(n->dsf_c, 0, 1) ||
        !good(n->dsf_tau, 0, 1) || !good(n->peak, 0, 1e30f) ||
        !good(n->max_error, 0, 255) || !good(n->exponent, 0, 256) ||
        !good_budget(n) || !hl_error_model_good(&caps->error) ||
        hl_profile_fault(&caps->profile))
        return HL_REFUSED_VALUE;
    return HL_REFUSED_NOTHING;
}

static void fill(struct hl_ask *ask)
{
    struct hl_needs *n = &ask->n;
    n->samples = n->samples ? n->samples : 1;
    n->far = n->far > 0 ? n->far : 1000.0f;
    n->cover = n->cover > 0 ? n->cover : 1.0f;
    n->max_error = n->max_error > 0 ? n->max_error : 1.0f;
    n->exponent = n->exponent >= 1 ? n->exponent : 1.0f;
    n->n_objects = n->n_objects ? n->n_objects : 1;
    n->lights = n->lights & 3u ? n->lights : n->lights | HL_LIGHTS_SMOOTH;
    /* Unknown: a tenth of the lights touch a pixel, a quarter an object. */
    ask->per_pixel = n->lights_per_pixel > 0 || !n->n_lights
                     ? n->lights_per_pixel : (float)n->n_lights * 0.1f;
    ask->per_object = n->lights_per_object > 0 || !n->n_lights
                      ? n->lights_per_object : (float)n->n_lights * 0.25f;
}

/* ---- choice ------------------------------------------------------------- */

typedef enum hl_refusal (*planner)(struct hl_plan *, const struct hl_ask *);

static const planner planners[HL_PIPELINE_COUNT] = {
    [HL_PIPELINE_FORWARD] = hl_plan_forward,
    [HL_PIPELINE_FORWARD_MULTIPASS] = hl_plan_multipass,
    [HL_PIPELINE_INFERRED] = hl_plan_inferred,
};

enum hl_refusal hl_plan_one(struct hl_plan *out, enum hl_pipeline pipeline,
                            const struct hl_ask *ask, bool automatic)
{
    memset(out, 0, sizeof *out);
    out->pipeline = pipeline;
    hl_plan_why(out, automatic ? HL_WHY_PIPELINE_CHEAPEST
                               : HL_WHY_PIPELINE_ASKED,
                (float)pipeline, 0, 0, 0);
    enum hl_refusal r = planners[pipeline](out, ask);
    if (r == HL_REFUSED_NOTHING)
        hl_plan_error(out, ask);
    return r;
}

/* A light size that was asked for and does not fit refuses the whole: to
 * draw forward instead would hide it. */
static enum hl_refusal plan_auto(struct hl_plan *out, const struct hl_ask *ask)
{
    enum hl_refusal why = HL_REFUSED_PIPELINE;
    struct hl_plan one;
    float best = -1, second = 0;
    for (int i = 1; i < HL_PIPELINE_COUNT; i++) {
        enum hl_refusal r = hl_plan_one(&one, (enum hl_pipeline)i, ask, true);
        if (r != HL_REFUSED_NOTHING) {
            /* The first one's reasons, should none be drawn. */
            if (why == HL_REFUSED_PIPELINE && best < 0)
                *out = one;
            why = why == HL_REFUSED_PIPELINE ? r : why;
            if (r == HL_REFUSED_EDRAM && i == HL_PIPELINE_INFERRED &&
                ask->n.light_width) {
                *out = one;
                return r;
            }
            continue;
        }
        if (best >= 0 && one.cost_ms >= best) {
            second = second > 0 && second < one.cost_ms ? second : one.cost_ms;
            continue;
        }
        second = best >= 0 ? best : 0;
        best = one.cost_ms;
        *out = one;
    }
    if (best < 0)
        return why;
    out->reason[0].arg[1] = best;
    out->reason[0].arg[2] = second;
    return HL_REFUSED_NOTHING;
}

static void only_reasons(struct hl_plan *p)
{
    struct hl_plan_reason r[HL_PLAN_REASONS];
    uint32_t n = p->n_reasons;
    memcpy(r, p->reason, sizeof r);
    memset(p, 0, sizeof *p);
    memcpy(p->reason, r, sizeof r);
    p->n_reasons = n;
}

enum hl_result hl_plan_make(struct hl_plan *out, enum hl_pipeline pipeline,
                            const struct hl_needs *needs,
                            const struct hl_caps *caps, enum hl_refusal *why)
{
    enum hl_refusal unused;
    why = why ? why : &unused;
    *why = HL_REFUSED_NOTHING;
    if (!out || !needs || !caps)
        return HL_ERR_INVALID;
    memset(out, 0, sizeof *out);
    *why = (unsigned)pipeline < HL_PIPELINE_COUNT ? check(needs, caps)
                                                  : HL_REFUSED_PIPELINE;
    if (*why != HL_REFUSED_NOTHING)
        return HL_ERR_INVALID;
    struct hl_ask ask;
    memset(&ask, 0, sizeof ask);
    ask.n = *needs;
    ask.caps = caps;
    fill(&ask);
    *why = pipeline == HL_PIPELINE_AUTO
           ? plan_auto(out, &ask) : hl_plan_one(out, pipeline, &ask, false);
    if (*why == HL_REFUSED_NOTHING && (ask.n.budget_codes > 0 ||
                                       ask.n.budget_ms > 0))
        *why = hl_plan_budget(out, pipeline, &ask);
    if (*why == HL_REFUSED_NOTHING)
        return HL_OK;
    only_reasons(out);
    return HL_ERR_UNSUPPORTED;
}
