/* SPDX-License-Identifier: Zlib */
/* Inferred lighting (Kircher, Lawrance 2009): geometry and light passes at
 * L-buffer size, material pass at frame size through the DSF. */
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
    hl_plan_why(p, asked ? HL_WHY_LIGHT_SIZE_ASKED : HL_WHY_LIGHT_SIZE_DEFAULT,
                (float)p->light_width, (float)p->light_height,
                (float)p->width, (float)p->height);
}

/* ---- G-buffer ----------------------------------------------------------- */

static enum hl_refusal choose_gbuffer(struct hl_plan *p,
                                      const struct hl_ask *ask)
{
    const enum hl_format two16[] = { HL_FORMAT_RG16_UNORM, HL_FORMAT_NONE };
    const enum hl_format depths[] = { HL_FORMAT_D32_FLOAT,
                                      HL_FORMAT_D24_UNORM_S8,
                                      HL_FORMAT_D16_UNORM, HL_FORMAT_NONE };
    int use = HL_USE_TARGET | HL_USE_SAMPLED;
    uint32_t w = p->light_width, h = p->light_height;
    enum hl_format normal = hl_format_pick(ask->caps, two16, use, 1);
    enum hl_format depth = hl_format_pick(ask->caps, depths, use, 1);
    if (normal == HL_FORMAT_NONE)
        return HL_REFUSED_NORMAL_FORMAT;
    if (depth == HL_FORMAT_NONE)
        return HL_REFUSED_DEPTH_FORMAT;
    struct hl_plan_target *t;
    t = hl_plan_add_target(p, HL_ROLE_NORMAL, normal, w, h, 1);
    t->error = hl_normal_error(normal);
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_why(p, HL_WHY_NORMAL_FORMAT, (float)normal, t->error, 0, 0);
    t = hl_plan_add_target(p, HL_ROLE_DSF, normal, w, h, 1);
    t->sample_as = HL_FORMAT_R32_UINT;
    t->error = ask->n.far / 65535.0f * 0.5f;
    t->read_by = 1u << HL_PASS_MATERIAL;
    hl_plan_why(p, HL_WHY_DSF_FORMAT, (float)normal, t->error, ask->n.far, 0);
    t = hl_plan_add_target(p, HL_ROLE_LIGHT_DEPTH, depth, w, h, 1);
    t->read_by = 1u << HL_PASS_LIGHT;
    return HL_REFUSED_NOTHING;
}

static void choose_exponent(struct hl_plan *p, const struct hl_ask *ask)
{
    const enum hl_format list[] = { HL_FORMAT_R16_UNORM, HL_FORMAT_R8_UNORM,
                                    HL_FORMAT_NONE };
    if (ask->n.specular == HL_NEED_NO_SPECULAR) {
        p->specular = HL_SPECULAR_NONE;
        hl_plan_why(p, HL_WHY_EXPONENT_NONE, 0, 0, 0, 0);
        return;
    }
    enum hl_format f = hl_format_pick(ask->caps, list,
                                      HL_USE_TARGET | HL_USE_SAMPLED, 1);
    if (ask->n.specular == HL_NEED_ONE_EXPONENT || f == HL_FORMAT_NONE) {
        p->specular = HL_SPECULAR_CONSTANT;
        hl_plan_why(p, HL_WHY_EXPONENT_CONSTANT, p->exponent, 0, 0, 0);
        return;
    }
    p->specular = HL_SPECULAR_CHANNEL;
    struct hl_plan_target *t = hl_plan_add_target(p, HL_ROLE_EXPONENT, f,
                                                  p->light_width,
                                                  p->light_height, 1);
    /* Half a step of log2(n) / 8. */
    float step = 8.0f / (float)((1u << hl_format_info(f)->bits[0]) - 1u);
    t->error = exp2f(step * 0.5f) - 1.0f;
    t->read_by = 1u << HL_PASS_LIGHT;
    hl_plan_why(p, HL_WHY_EXPONENT_CHANNEL, (float)f, t->error, 0, 0);
}

/* ---- light pass --------------------------------------------------------- */

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

static double choose_path(struct hl_plan *p, const struct hl_ask *ask)
{
    bool lists = ask->caps->max_storage_bytes > 0;
    double best = -1, cost[4] = { 0, 0, 0, 0 };
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
        bool can = path != HL_LIGHT_PATH_RECTS && !ask->n.no_tile_depth;
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
    if (p->tile_depth)
        hl_plan_why(p, HL_WHY_TILE_DEPTH, (float)p->tile, 0, 0, 0);
    return best;
}

/* Blends that one texel sees. */
static uint32_t light_blends(const struct hl_plan *p, const struct hl_ask *ask)
{
    float n = ask->per_pixel;
    if (p->light_path == HL_LIGHT_PATH_LISTS)
        return 1;
    if (p->light_path == HL_LIGHT_PATH_TILES)
        return 1 + (uint32_t)(n * 1.7f / TILE_DRAWS_BATCH);
    return 1 + (uint32_t)(p->batch > 1 ? n * 1.5f / (float)p->batch : n);
}

/* The L-buffer's texel as words. */
static void light_bits(struct hl_plan *p, struct hl_plan_target *t)
{
    const struct hl_format_info *f = hl_format_info(t->format);
    bool wide = f->bits[0] == 32;
    t->sample_as = wide ? HL_FORMAT_RGBA32_UINT
                   : f->bytes == 4 ? HL_FORMAT_R32_UINT : HL_FORMAT_RG32_UINT;
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

static enum hl_refusal choose_light_format(struct hl_plan *p,
                                           const struct hl_ask *ask)
{
    const enum hl_format list[] = { HL_FORMAT_RGBA16_FLOAT,
                                    HL_FORMAT_RGBA16_UNORM,
                                    HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE };
    uint32_t blends = light_blends(p, ask);
    int use = HL_USE_TARGET | HL_USE_SAMPLED | HL_USE_BLEND;
    enum hl_format best = HL_FORMAT_NONE;
    enum hl_format asked = ask->n.light_format;
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
    if (hl_format_info(best)->kind == HL_KIND_UNORM)
        p->light_scale = ask->n.peak;
    struct hl_plan_target *t = hl_plan_add_target(p, HL_ROLE_LIGHT, best,
                                                  p->light_width,
                                                  p->light_height, 1);
    light_bits(p, t);
    t->error = hl_accumulation_error(best, blends);
    t->read_by = 1u << HL_PASS_MATERIAL;
    p->light_error = t->error;
    hl_plan_why(p, asked ? HL_WHY_LIGHT_FORMAT_ASKED
                         : HL_WHY_LIGHT_FORMAT_ERROR, (float)best,
                (float)blends, t->error, p->light_scale);
    return HL_REFUSED_NOTHING;
}

/* ---- DSF ---------------------------------------------------------------- */

static void choose_dsf(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_needs *n = &ask->n;
    p->dsf_k = n->dsf_k > 0 ? n->dsf_k : 1.5f;
    p->dsf_c = n->dsf_c > 0 ? n->dsf_c : 0.001f;
    p->dsf_tau = n->dsf_tau > 0 ? n->dsf_tau : 0.01f;
    bool same = p->light_width == p->width && p->light_height == p->height;
    if (n->dsf == HL_DSF_NONE) {
        p->dsf = HL_DSF_OFF;
        hl_plan_why(p, HL_WHY_DSF_OFF, 0, 0, 0, 0);
    } else if (n->dsf == HL_DSF_CONSTANT_TAU) {
        p->dsf = HL_DSF_CONSTANT;
        hl_plan_why(p, HL_WHY_DSF_CONSTANT, p->dsf_tau, 0, 0, 0);
    } else if (same && n->samples <= 1) {
        p->dsf = HL_DSF_EXACT;
        hl_plan_why(p, HL_WHY_DSF_EXACT, 0, 0, 0, 0);
    } else {
        p->dsf = HL_DSF_SLOPE;
        hl_plan_why(p, HL_WHY_DSF_SLOPE, p->dsf_k, p->dsf_c,
                    n->far / 65535.0f, 0);
    }
}

/* ---- passes ------------------------------------------------------------- */

static void add_passes(struct hl_plan *p)
{
    enum hl_compare nearer = p->reversed_depth ? HL_COMPARE_GREATER
                                               : HL_COMPARE_LESS;
    struct hl_plan_pass *g = hl_plan_add_pass(p, HL_PASS_GEOMETRY);
    g->color[0] = HL_ROLE_NORMAL;
    g->color[1] = HL_ROLE_DSF;
    if (p->specular == HL_SPECULAR_CHANNEL)
        g->color[2] = HL_ROLE_EXPONENT;
    g->depth = HL_ROLE_LIGHT_DEPTH;
    g->depth_write = true;
    g->depth_test = nearer;
    struct hl_plan_pass *l = hl_plan_add_pass(p, HL_PASS_LIGHT);
    l->color[0] = HL_ROLE_LIGHT;
    l->repeat = p->light_path == HL_LIGHT_PATH_RECTS ? HL_PER_LIGHTS
                : p->light_path == HL_LIGHT_PATH_TILES ? HL_PER_TILE : HL_ONCE;
    l->blend = p->light_path == HL_LIGHT_PATH_LISTS ? HL_BLEND_OFF
                                                    : HL_BLEND_ADD;
    l->lights_a_draw = p->light_path == HL_LIGHT_PATH_LISTS ? 0 : p->batch;
    struct hl_plan_pass *m = hl_plan_add_pass(p, HL_PASS_MATERIAL);
    m->color[0] = HL_ROLE_COLOR;
    m->depth = HL_ROLE_DEPTH;
    m->depth_write = true;
    m->depth_test = nearer;
}

/* Geometry twice; the G-buffer written, the DSF's taps read a pixel. */
static double geometry_cost(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double taps = p->dsf == HL_DSF_EXACT ? 1 : p->dsf == HL_DSF_OFF ? 4 : 8;
    double light = (double)p->light_width * p->light_height;
    double frame = (double)p->width * p->height *
                   (1.0 + 0.06 * (p->samples - 1));
    return 2.0 * ask->n.n_objects * (double)c->draw_ns +
           2.0 * ask->n.n_triangles * (double)c->vertex_ns +
           1.5 * light * (double)c->pixel_ns * 2 +
           1.5 * frame * ((double)c->pixel_ns + taps * (double)c->fetch_ns);
}

enum hl_refusal hl_plan_inferred(struct hl_plan *p, const struct hl_ask *ask)
{
    hl_plan_common(p, ask);
    choose_size(p, ask);
    enum hl_refusal r = choose_gbuffer(p, ask);
    if (r != HL_REFUSED_NOTHING)
        return r;
    choose_exponent(p, ask);
    if (ask->n.light_path == HL_LIGHT_PATH_LISTS &&
        ask->caps->max_storage_bytes == 0)
        return HL_REFUSED_STORAGE;
    double lights = choose_path(p, ask);
    r = choose_light_format(p, ask);
    if (r == HL_REFUSED_NOTHING)
        r = hl_plan_frame_targets(p, ask, ask->n.blended ? 1 : 0);
    if (r != HL_REFUSED_NOTHING)
        return r;
    choose_dsf(p, ask);
    add_passes(p);
    double ratio = (double)p->light_width * p->light_height /
                   ((double)p->width * p->height);
    double texel = hl_format_info(hl_plan_target(p, HL_ROLE_LIGHT)->format)
                   ->bytes;
    double color = hl_format_info(hl_plan_target(p, HL_ROLE_COLOR)->format)
                   ->bytes;
    double taps = p->dsf == HL_DSF_EXACT ? 1 : 4;
    double dsf = p->dsf == HL_DSF_SLOPE || p->dsf == HL_DSF_CONSTANT ? 16 : 0;
    p->moved_per_pixel = (float)(ratio * (2 * 12 + texel) + taps * texel +
                                 dsf + (color + 4) * p->samples);
    hl_plan_finish(p, ask, geometry_cost(p, ask) + lights);
    return HL_REFUSED_NOTHING;
}
