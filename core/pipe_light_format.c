/* SPDX-License-Identifier: Zlib */
/* The L-buffer's format: by its error, by what was asked for, or by what a
 * profile rules. */
#include "core/pipe.h"

enum { USE = HL_USE_TARGET | HL_USE_SAMPLED | HL_USE_BLEND };

/* Blends that one texel sees. Each light with shadows is one of its own. */
uint32_t hl_plan_light_blends(const struct hl_plan *p,
                              const struct hl_ask *ask)
{
    float n = ask->per_pixel;
    uint32_t own = p->shadows ? ask->n.n_shadow_lights : 0;
    bool volumes = p->light_path == HL_LIGHT_PATH_VOLUMES;
    own = own < 1000 ? own : 1000;
    if (p->light_path == HL_LIGHT_PATH_LISTS)
        return 1 + own;
    if (p->light_path == HL_LIGHT_PATH_TILES)
        return 1 + own + (uint32_t)(n * 1.7f / HL_TILE_DRAW_LIGHTS);
    return 1 + own + (uint32_t)(p->batch > 1 && !volumes
                                ? n * 1.5f / (float)p->batch : n);
}

/* The L-buffer's texel as words. */
static void light_bits(struct hl_plan *p, struct hl_plan_target *t)
{
    const struct hl_format_info *f = hl_format_info(t->format);
    bool wide = f->bits[0] == 32;
    if (!p->float_taps)
        t->sample_as = wide ? HL_FORMAT_RGBA32_UINT
                       : f->bytes == 4 ? HL_FORMAT_R32_UINT
                                       : HL_FORMAT_RG32_UINT;
    p->light_bits = wide ? HL_BITS_FLOAT
                    : f->bits[0] == 8 ? HL_BITS_UNORM8
                    : t->format == HL_FORMAT_RGB10A2_UNORM ? HL_BITS_UNORM10
                    : f->kind == HL_KIND_FLOAT ? HL_BITS_HALF
                                               : HL_BITS_UNORM16;
}

/* Formats that the material pass knows how to take apart. */
static bool known_light_format(enum hl_format f)
{
    return f == HL_FORMAT_RGBA16_FLOAT || f == HL_FORMAT_RGBA16_UNORM ||
           f == HL_FORMAT_RGBA32_FLOAT || f == HL_FORMAT_RGBA8_UNORM ||
           f == HL_FORMAT_RGB10A2_UNORM;
}

/* Steps of a fixed range serve where light comes near its peak. An inverse
 * square light does so a centimetre away: in sight it may be below a step. */
static bool peak_tells(const struct hl_ask *ask)
{
    return ask->n.peak > 0 && !(ask->n.lights & HL_LIGHTS_INVERSE_SQUARE);
}

static bool is_unorm(enum hl_format f)
{
    return hl_format_info(f)->kind == HL_KIND_UNORM;
}

static struct hl_plan_target *add_light(struct hl_plan *p,
                                        enum hl_format format)
{
    struct hl_plan_target *t =
        hl_plan_add_target(p, HL_ROLE_LIGHT, format, p->light_width,
                           p->light_height, 1);
    t->read_by = 1u << HL_PASS_MATERIAL;
    return t;
}

/* ---- by a profile ------------------------------------------------------- */

/* By the console's rule, on a machine that stands in for it too. */
static bool never_blends(const struct hl_profile *p, enum hl_format format)
{
    for (int i = 0; i < HL_PROFILE_NO_BLEND; i++)
        if (format != HL_FORMAT_NONE && p->no_blend[i] == format)
            return true;
    return false;
}

/* By the profile's list: its first, or the one that was asked for. */
static enum hl_refusal light_by_profile(struct hl_plan *p,
                                        const struct hl_ask *ask)
{
    const struct hl_profile *c = &ask->caps->profile;
    uint32_t blends = hl_plan_light_blends(p, ask);
    enum hl_format asked = ask->n.light_format;
    const struct hl_profile_format *row =
        hl_plan_row(ask->caps, c->light, asked, USE, 1);
    bool blends_not = never_blends(c, asked) ||
                      !hl_format_usable(ask->caps, asked, HL_USE_BLEND, 1);
    if (!row && asked != HL_FORMAT_NONE && blends_not)
        hl_plan_why(p, HL_WHY_NOT_BLENDABLE, (float)asked, 0, 0, 0);
    if (!row)
        return HL_REFUSED_LIGHT_FORMAT;
    struct hl_plan_target *t = add_light(p, row->format);
    hl_plan_keep(p, t, ask->caps, row, true);
    light_bits(p, t);
    if (p->light_path != HL_LIGHT_PATH_LISTS &&
        never_blends(c, HL_FORMAT_RGBA16_FLOAT))
        hl_plan_why(p, HL_WHY_NO_BLEND, (float)HL_FORMAT_RGBA16_FLOAT,
                    (float)row->format, 0, 0);
    t->error = row->range > 0 ? hl_plan_light_range(p, ask, row, blends)
                              : hl_accumulation_error(row->format, blends);
    p->light_error = t->error;
    hl_plan_why(p, asked ? HL_WHY_LIGHT_FORMAT_ASKED
                         : HL_WHY_LIGHT_FORMAT_PROFILE, (float)row->format,
                (float)blends, t->error, p->light_scale);
    return HL_REFUSED_NOTHING;
}

/* ---- by the error ------------------------------------------------------- */

/* A quarter of the frame's error budget goes to the L-buffer; relative errors
 * move codes by 106 a unit at most (plan.c). */
static bool sums_well(enum hl_format f, const struct hl_ask *ask,
                      uint32_t blends)
{
    return 106.0f * hl_accumulation_error(f, blends) <=
           0.25f * ask->n.max_error;
}

static bool too_coarse(enum hl_format f, const struct hl_ask *ask)
{
    return hl_dark_codes(f, ask->n.peak) > ask->n.max_error;
}

/* The first that is good enough, else the best; `dark`: of those that are in
 * the dark as well. */
static enum hl_format by_error(const struct hl_plan *p,
                               const struct hl_ask *ask, bool dark)
{
    static const enum hl_format list[] = { HL_FORMAT_RGBA16_FLOAT,
                                           HL_FORMAT_RGBA16_UNORM,
                                           HL_FORMAT_RGBA32_FLOAT,
                                           HL_FORMAT_NONE };
    uint32_t blends = hl_plan_light_blends(p, ask);
    enum hl_format best = HL_FORMAT_NONE;
    for (int i = 0; list[i]; i++) {
        if (!hl_format_usable(ask->caps, list[i], USE, 1) ||
            (is_unorm(list[i]) && !peak_tells(ask)) ||
            (dark && too_coarse(list[i], ask)))
            continue;
        if (best == HL_FORMAT_NONE)
            best = list[i];
        if (sums_well(list[i], ask, blends))
            return list[i];
        if (hl_accumulation_error(list[i], blends) <
            hl_accumulation_error(best, blends))
            best = list[i];
    }
    return best;
}

/* Where nothing is good enough in the dark, what is there. */
static enum hl_format best_of(const struct hl_plan *p,
                              const struct hl_ask *ask)
{
    enum hl_format f = by_error(p, ask, true);
    return f != HL_FORMAT_NONE ? f : by_error(p, ask, false);
}

bool hl_plan_light_candidate(const struct hl_ask *ask, enum hl_format f)
{
    const struct hl_profile_format *list = ask->caps->profile.light;
    if (list[0].format != HL_FORMAT_NONE)
        return hl_plan_row(ask->caps, list, f, USE, 1) != NULL;
    return known_light_format(f) && hl_format_usable(ask->caps, f, USE, 1) &&
           (!is_unorm(f) || peak_tells(ask)) &&
           (f != HL_FORMAT_RGB10A2_UNORM ||
            ask->n.specular == HL_NEED_NO_SPECULAR);
}

enum hl_format hl_plan_light_pick(const struct hl_plan *p,
                                  const struct hl_ask *ask)
{
    const struct hl_profile_format *list = ask->caps->profile.light;
    const struct hl_profile_format *row =
        hl_plan_row(ask->caps, list, ask->n.light_format, USE, 1);
    if (list[0].format != HL_FORMAT_NONE)
        return row ? row->format : HL_FORMAT_NONE;
    return ask->n.light_format ? ask->n.light_format : best_of(p, ask);
}

static bool can_be_asked(const struct hl_ask *ask)
{
    enum hl_format f = ask->n.light_format;
    return f == HL_FORMAT_NONE ||
           (known_light_format(f) && hl_format_usable(ask->caps, f, USE, 1) &&
            (!is_unorm(f) || ask->n.peak > 0));
}

/* What the numbers of the plan's error leave out. */
static void say_more(struct hl_plan *p, const struct hl_ask *ask,
                     enum hl_format f)
{
    enum hl_format passed = by_error(p, ask, false);
    if (!ask->n.light_format && passed != f)
        hl_plan_why(p, HL_WHY_LIGHT_FORMAT_DARK, (float)passed,
                    hl_dark_codes(passed, ask->n.peak), ask->n.max_error,
                    ask->n.peak);
    if (f == HL_FORMAT_RGB10A2_UNORM && p->specular != HL_SPECULAR_NONE)
        hl_plan_why(p, HL_WHY_LIGHT_ALPHA, (float)f, 2, p->light_scale / 3,
                    p->light_scale);
}

enum hl_refusal hl_plan_light_format(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    uint32_t blends = hl_plan_light_blends(p, ask);
    bool asked = ask->n.light_format != HL_FORMAT_NONE;
    if (ask->caps->profile.light[0].format != HL_FORMAT_NONE)
        return light_by_profile(p, ask);
    enum hl_format best = hl_plan_light_pick(p, ask);
    if (best == HL_FORMAT_NONE || !can_be_asked(ask))
        return HL_REFUSED_LIGHT_FORMAT;
    if (is_unorm(best)) {
        p->light_scale = ask->n.peak;
        p->light_out = 1.0f / p->light_scale;
    }
    struct hl_plan_target *t = add_light(p, best);
    light_bits(p, t);
    t->error = hl_accumulation_error(best, blends);
    p->light_error = t->error;
    hl_plan_why(p, asked ? HL_WHY_LIGHT_FORMAT_ASKED
                         : HL_WHY_LIGHT_FORMAT_ERROR, (float)best,
                (float)blends, t->error, p->light_scale);
    say_more(p, ask, best);
    return HL_REFUSED_NOTHING;
}
