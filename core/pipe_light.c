/* SPDX-License-Identifier: Zlib */
/* The light pass of the inferred pipeline: how it finds its lights. */
#include "core/light_volume.h"
#include "core/pipe.h"
#include "core/vec.h"

enum { TILE = 24 };

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

/* Of one format of L-buffer, nanoseconds. */
struct prices { double pixel, fetches, blend, more; };

/* Depth and normal are fetched for every shaded texel. What writing a texel
 * costs is in the shading floor, measured with RGBA16_FLOAT: `more` is what
 * it costs more than that. */
static struct prices prices(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    const struct hl_plan_target *n = hl_plan_target(p, HL_ROLE_NORMAL);
    enum hl_format light = hl_plan_light_pick(p, ask);
    double blend = hl_blend_ns(ask->caps, light);
    double usual = hl_blend_ns(ask->caps, HL_FORMAT_RGBA16_FLOAT);
    return (struct prices){
        (double)c->pixel_ns,
        (double)c->fetch_ns + hl_fetch_ns(ask->caps, n->format), blend,
        light != HL_FORMAT_NONE ? blend - usual : 0
    };
}

/* One light a draw: at worst all of its rectangle is near a surface and is
 * shaded, after its volume's two faces. */
static double volumes_cost(const struct hl_plan *p, const struct hl_ask *ask,
                           const struct prices *u)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->light_width * p->light_height;
    double lights = (double)ask->per_pixel;
    return ask->n.n_lights * (2.0 * (double)c->draw_ns +
                              HL_LIGHT_FACES * (double)c->vertex_ns) +
           pixels * lights * 2 * u->pixel +
           pixels * lights * (light_ns(ask) + u->blend + u->pixel +
                              u->fetches);
}

/* A texel's floor where its sum is made by so many draws. */
static double floor_of(const struct prices *u, double draws)
{
    double pixel = u->pixel + draws * u->more;
    return (pixel > 0 ? pixel : 0) + u->fetches;
}

/* Of p's light path. */
static double path_cost(const struct hl_plan *p, const struct hl_ask *ask,
                        bool tile_depth)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    struct prices u = prices(p, ask);
    double pixels = (double)p->light_width * p->light_height;
    double tiles = pixels / ((double)p->tile * p->tile);
    double lights = (double)ask->per_pixel;
    double depth = tile_depth ? pixels * (double)c->readback_ns +
                                (double)c->sync_ns : 0.0;
    double listed = lights * list_share(tile_depth);
    /* Whose depth is known, texels without a surface have empty lists. */
    double lit = tile_depth ? pixels * (double)ask->n.cover : pixels;
    if (p->light_path == HL_LIGHT_PATH_VOLUMES)
        return volumes_cost(p, ask, &u);
    if (p->light_path == HL_LIGHT_PATH_RECTS) {
        /* A batch's rectangle is the union of its lights': about half as
         * much again as they cover. */
        double draws = ceil((double)ask->n.n_lights / p->batch);
        double shaded = p->batch > 1 ? 1.5 * lights : lights;
        return draws * (double)c->draw_ns + pixels * shaded *
               (light_ns(ask) + (u.blend + u.pixel + u.fetches) / p->batch);
    }
    if (p->light_path == HL_LIGHT_PATH_TILES) {
        double draws = ceil((listed + 1) / HL_TILE_DRAW_LIGHTS);
        return lit * floor_of(&u, draws) + depth +
               tiles * lit / pixels * draws * (double)c->draw_ns +
               lit * (listed + 2) * light_ns(ask);
    }
    return pixels * floor_of(&u, 1) + depth +
           lit * listed * (double)c->light_gather_ns;
}

double hl_plan_light_path(struct hl_plan *p, const struct hl_ask *ask)
{
    bool lists = ask->caps->max_storage_bytes > 0;
    double best = -1, cost[5] = { 0, 0, 0, 0, 0 };
    p->tile = ask->n.tile ? ask->n.tile : TILE;
    p->batch = ask->n.batch ? ask->n.batch : 8;
    enum hl_light_path from = HL_LIGHT_PATH_RECTS, to = HL_LIGHT_PATH_LISTS;
    enum hl_light_path cheapest = from;
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
        p->light_path = path;
        double plain = path_cost(p, ask, false);
        double deep = can ? path_cost(p, ask, true) : plain;
        cost[i] = deep < plain ? deep : plain;
        if (best >= 0 && cost[i] >= best)
            continue;
        best = cost[i];
        cheapest = path;
        p->tile_depth = deep < plain;
    }
    p->light_path = cheapest;
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
