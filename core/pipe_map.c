/* SPDX-License-Identifier: Zlib */
/* Shadow maps: one target that all lights use in turn, so that a plan and its
 * memory do not grow with lights. */
#include "core/pipe.h"

enum { SIZE = 1024, SIZE_LEAST = 64 };

/* Maps that stand in the target: 3 x 2 where there are point lights. */
static uint32_t columns(const struct hl_ask *ask)
{
    return ask->n.shadow_points ? 3 : 1;
}

static uint32_t rows(const struct hl_ask *ask)
{
    return ask->n.shadow_points ? 2 : 1;
}

enum hl_refusal hl_plan_shadow_maps(struct hl_plan *p,
                                    const struct hl_ask *ask)
{
    const struct hl_profile_format *row;
    uint32_t asked = ask->n.shadow_size;
    p->shadows = HL_SHADOWS_MAPS;
    if (hl_plan_light_depth(p, ask, HL_USE_TARGET | HL_USE_SAMPLED, &row) ==
        HL_FORMAT_NONE)
        return HL_REFUSED_DEPTH_FORMAT;
    uint32_t most = ask->caps->max_tex_dim / columns(ask);
    if (most < SIZE_LEAST || (asked && asked < SIZE_LEAST) || asked > most)
        return HL_REFUSED_SHADOWS;
    hl_plan_why(p, HL_WHY_SHADOW_MAPS, (float)ask->n.n_shadow_lights,
                (float)(columns(ask) * rows(ask)), 0, 0);
    return HL_REFUSED_NOTHING;
}

/* The light's own target stays where it is while maps come and go (K 5.1). */
static bool fits(const struct hl_plan *p, const struct hl_ask *ask,
                 const struct hl_plan_target *map, uint32_t size)
{
    const struct hl_profile *c = &ask->caps->profile;
    const struct hl_plan_target *l = hl_plan_target(p, HL_ROLE_LIGHT);
    if (size * columns(ask) > ask->caps->max_tex_dim)
        return false;
    return c->edram_tiles == 0 ||
           hl_edram_tiles(c, hl_plan_console_format(ask->caps, l), l->width,
                          l->height, 1) +
           hl_edram_tiles(c, hl_plan_console_format(ask->caps, map),
                          size * columns(ask), size * rows(ask), 1) <=
           c->edram_tiles;
}

/* Half as large until it fits. */
static void set_size(struct hl_plan *p, const struct hl_ask *ask,
                     struct hl_plan_target *map)
{
    uint32_t size = ask->n.shadow_size ? ask->n.shadow_size : SIZE;
    while (size / 2 >= SIZE_LEAST && !fits(p, ask, map, size))
        size /= 2;
    p->shadow_size = size;
    map->width = size * columns(ask);
    map->height = size * rows(ask);
    map->bytes = (uint64_t)map->width * map->height *
                 hl_format_info(map->format)->bytes;
    hl_plan_why(p, HL_WHY_SHADOW_SIZE, (float)size,
                (float)(ask->n.shadow_size ? ask->n.shadow_size : SIZE),
                (float)map->width, (float)map->height);
}

void hl_plan_map_passes(struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_profile_format *row;
    enum hl_format f = hl_plan_light_depth(p, ask,
                                           HL_USE_TARGET | HL_USE_SAMPLED,
                                           &row);
    struct hl_plan_target *t =
        hl_plan_add_target(p, HL_ROLE_SHADOW_MAP, f, 1, 1, 1);
    hl_plan_keep(p, t, ask->caps, row, true);
    t->read_by = 1u << HL_PASS_SHADOWED;
    set_size(p, ask, t);
    struct hl_plan_pass *m = hl_plan_add_pass(p, HL_PASS_SHADOW_MAP);
    m->repeat = HL_PER_SHADOW_LIGHT;
    m->depth = HL_ROLE_SHADOW_MAP;
    m->depth_write = true;
    m->depth_test = p->reversed_depth ? HL_COMPARE_GREATER : HL_COMPARE_LESS;
    hl_plan_shadowed_pass(p);
}

/* A third of the scene casts toward what is seen, twice where it stands on two
 * of six maps; a quarter of the map is drawn over. Of the screen a light
 * covers its share, and pays four gathers, as dear as four fetches each. */
double hl_plan_map_cost(const struct hl_plan *p, const struct hl_ask *ask)
{
    const struct hl_cost_model *c = &ask->caps->cost;
    double pixels = (double)p->light_width * p->light_height;
    double texels = (double)p->shadow_size * p->shadow_size;
    double maps = columns(ask) * rows(ask), lights = ask->n.n_shadow_lights;
    double share = ask->n.n_lights
                   ? (double)ask->per_pixel / ask->n.n_lights : 0.1;
    double normal = hl_fetch_ns(ask->caps,
                                hl_plan_target(p, HL_ROLE_NORMAL)->format);
    double blend = hl_blend_ns(ask->caps,
                               hl_plan_target(p, HL_ROLE_LIGHT)->format);
    double casters = (maps > 1 ? 0.66 : 0.33) *
                     ((double)ask->n.n_objects * (double)c->draw_ns +
                      (double)ask->n.n_triangles * (double)c->vertex_ns);
    return lights * (casters + (double)c->draw_ns +
                     0.25 * maps * texels * (double)c->pixel_ns +
                     share * pixels *
                     ((double)(c->pixel_ns + 17 * c->fetch_ns + c->light_ns) +
                      normal + blend));
}
