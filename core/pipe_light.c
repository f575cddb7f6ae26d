/* SPDX-License-Identifier: Zlib */
/* The light pass of the inferred pipeline: how it finds its lights, and the
 * L-buffer's format. */
#include "core/light_volume.h"
#include "core/pipe.h"
#include "core/vec.h"

/* ---- path --------------------------------------------------------------- */

enum { TILE = 24, TILE_DRAWS_BATCH = 14 };

/* Entries of a tile's list against lights_per_pixel, which counts screen
 * bounds and so every light in front of or behind a surface. Measured with
 * 24-texel tiles on scenes of 81 to 1,496 lights: with depth bounds 0.16 to
 * 0.96, without 1.3 to 1.6; the worse end decides. */
static double list_share(bool tile_depth) { return tile_depth ? 0.9 : 1.6; }

/* A light by the cheaper of uniforms and flat varyings. */
static bool flat_cheaper(const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    return c->light_flat_ns > 0 && c->light_flat_ns < c->light_ns;
}

static double light_ns(const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    return (double)(flat_cheaper(ask) ? c->light_flat_ns : c->light_ns);
}

/* One light a draw: at worst all of its rectangle is near a surface and is
 * shaded, after its volume's two faces. */
static double volumes_cost(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->light_width * p->light_height;
    double lights = (double)ask->per_pixel;
    return ask->n.n_lights * (2.0 * (double)c->draw_ns +
                              HL_LIGHT_FACES * (double)c->vertex_ns) +
           pixels * lights * 2 * (double)c->pixel_ns +
           pixels * lights * (light_ns(ask) + (double)(c->blend_ns +
                              c->pixel_ns + 2 * c->fetch_ns));
}

static double path_cost(const struct hl_plan *p, const struct hl_ask *ask,
                        enum hl_light_path path, bool tile_depth)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->light_width * p->light_height;
    double tiles = pixels / ((double)p->tile * p->tile);
    double lights = (double)ask->per_pixel;
    double base = pixels * (double)(c->pixel_ns + 2 * c->fetch_ns);
    double depth = tile_depth ? pixels * (double)c->readback_ns +
                                (double)c->sync_ns : 0.0;
    double listed = lights * list_share(tile_depth);
    if (path == HL_LIGHT_PATH_VOLUMES)
        return volumes_cost(p, ask);
    if (path == HL_LIGHT_PATH_RECTS) {
        /* A batch's rectangle is the union of its lights': about half as
         * much again as they cover. */
        double draws = ceil((double)ask->n.n_lights / p->batch);
        double shaded = p->batch > 1 ? 1.5 * lights : lights;
        return draws * (double)c->draw_ns + pixels * shaded *
               (light_ns(ask) + (double)(c->blend_ns + c->pixel_ns +
                2 * c->fetch_ns) / p->batch);
    }
    if (path == HL_LIGHT_PATH_TILES)
        return base + depth + tiles * ceil((listed + 1) / TILE_DRAWS_BATCH) *
               (double)c->draw_ns + pixels * (listed + 2) *
               light_ns(ask);
    return base + depth + pixels * listed * (double)c->light_gather_ns;
}

double hl_plan_light_path(struct hl_plan *p, const struct hl_ask *ask)
{
    bool lists = ask->caps->max_storage_bytes > 0;
    double best = -1, cost[5] = { 0, 0, 0, 0, 0 };
    p->tile = ask->n.tile ? ask->n.tile : TILE;
    p->batch = ask->n.batch ? ask->n.batch : 8;
    enum hl_light_path from = HL_LIGHT_PATH_RECTS, to = HL_LIGHT_PATH_LISTS;
    bool asked = ask->n.light_path != HL_LIGHT_PATH_AUTO;
    if (asked)
        from = to = ask->n.light_path;
    for (int i = (int)from; i <= (int)to; i++) {
        enum hl_light_path path = (enum hl_light_path)i;
        if (path == HL_LIGHT_PATH_LISTS && !lists)
            continue;
        bool listed = path == HL_LIGHT_PATH_TILES ||
                      path == HL_LIGHT_PATH_LISTS;
        bool can = listed && !ask->n.no_tile_depth;
        double plain = path_cost(p, ask, path, false);
        double deep = can ? path_cost(p, ask, path, true) : plain;
        cost[i] = deep < plain ? deep : plain;
        if (best >= 0 && cost[i] >= best)
            continue;
        best = cost[i];
        p->light_path = path;
        p->tile_depth = deep < plain;
    }
    hl_plan_why(p, asked ? HL_WHY_PATH_ASKED : HL_WHY_PATH_CHEAPEST,
                (float)p->light_path, (float)(cost[1] * 1e-6),
                (float)(cost[2] * 1e-6), (float)(cost[3] * 1e-6));
    uint32_t most = HL_BATCH_MAX;
    p->light_flat = flat_cheaper(ask) &&
                    p->light_path != HL_LIGHT_PATH_LISTS;
    if (p->light_flat)
        most = (uint32_t)(HL_FLAT_VEC4S / (p->kinds ? HL_LIGHT_VEC4S
                                                    : HL_POINT_VEC4S));
    if (p->light_path != HL_LIGHT_PATH_RECTS || p->batch > most)
        p->batch = most;
    if (p->light_path == HL_LIGHT_PATH_VOLUMES)
        p->batch = 1;
    if (p->tile_depth)
        hl_plan_why(p, HL_WHY_TILE_DEPTH, (float)p->tile, 0, 0, 0);
    return best;
}

/* ---- format ------------------------------------------------------------- */

/* Blends that one texel sees. Each light with shadows is one of its own. */
static uint32_t light_blends(const struct hl_plan *p, const struct hl_ask *ask)
{
    float n = ask->per_pixel;
    uint32_t own = p->shadows ? ask->n.n_shadow_lights : 0;
    own = own < 1000 ? own : 1000;
    if (p->light_path == HL_LIGHT_PATH_LISTS)
        return 1 + own;
    if (p->light_path == HL_LIGHT_PATH_TILES)
        return 1 + own + (uint32_t)(n * 1.7f / TILE_DRAWS_BATCH);
    return 1 + own + (uint32_t)(p->batch > 1 ? n * 1.5f / (float)p->batch : n);
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
                    : f->kind == HL_KIND_FLOAT ? HL_BITS_HALF
                                               : HL_BITS_UNORM16;
}

/* Formats that the material pass knows how to take apart. */
static bool known_light_format(enum hl_format f)
{
    return f == HL_FORMAT_RGBA16_FLOAT || f == HL_FORMAT_RGBA16_UNORM ||
           f == HL_FORMAT_RGBA32_FLOAT || f == HL_FORMAT_RGBA8_UNORM;
}

/* Steps of a fixed range serve where light comes near its peak. An inverse
 * square light does so a centimetre away: in sight it may be below a step. */
static bool peak_tells(const struct hl_ask *ask)
{
    return ask->n.peak > 0 && !(ask->n.lights & HL_LIGHTS_INVERSE_SQUARE);
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
    uint32_t blends = light_blends(p, ask);
    int use = HL_USE_TARGET | HL_USE_SAMPLED | HL_USE_BLEND;
    enum hl_format asked = ask->n.light_format;
    const struct hl_profile_format *row =
        hl_plan_row(ask->caps, c->light, asked, use, 1);
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

enum hl_refusal hl_plan_light_format(struct hl_plan *p,
                                     const struct hl_ask *ask)
{
    const enum hl_format list[] = { HL_FORMAT_RGBA16_FLOAT,
                                    HL_FORMAT_RGBA16_UNORM,
                                    HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE };
    uint32_t blends = light_blends(p, ask);
    int use = HL_USE_TARGET | HL_USE_SAMPLED | HL_USE_BLEND;
    enum hl_format best = HL_FORMAT_NONE;
    enum hl_format asked = ask->n.light_format;
    if (ask->caps->profile.light[0].format != HL_FORMAT_NONE)
        return light_by_profile(p, ask);
    if (asked != HL_FORMAT_NONE &&
        (!known_light_format(asked) ||
         !hl_format_usable(ask->caps, asked, use, 1)))
        return HL_REFUSED_LIGHT_FORMAT;
    bool unorm = hl_format_info(asked)->kind == HL_KIND_UNORM;
    if (asked != HL_FORMAT_NONE && unorm && ask->n.peak <= 0)
        return HL_REFUSED_LIGHT_FORMAT;
    for (int i = 0; list[i] && !asked; i++) {
        if (!hl_format_usable(ask->caps, list[i], use, 1) ||
            (list[i] == HL_FORMAT_RGBA16_UNORM && !peak_tells(ask)))
            continue;
        if (best == HL_FORMAT_NONE)
            best = list[i];
        /* A quarter of the frame's error budget goes to the L-buffer. */
        if (106.0f * hl_accumulation_error(list[i], blends) <=
            0.25f * ask->n.max_error) {
            best = list[i];
            break;
        }
        if (hl_accumulation_error(list[i], blends) <
            hl_accumulation_error(best, blends))
            best = list[i];
    }
    best = asked ? asked : best;
    if (best == HL_FORMAT_NONE)
        return HL_REFUSED_LIGHT_FORMAT;
    if (hl_format_info(best)->kind == HL_KIND_UNORM) {
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
    return HL_REFUSED_NOTHING;
}
