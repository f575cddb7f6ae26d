/* SPDX-License-Identifier: Zlib */
/* Shadow maps of lights, and their light: one light after another, since all
 * use one target. A map is drawn whole even where the light is seen in part;
 * what casts need not be seen at all. */
#include <string.h>
#include "core/renderer.h"
#include "core/shadow_map.h"

/* ---- memory and programs ------------------------------------------------ */

static bool has_maps(const struct hl_plan *p)
{
    return p->pipeline == HL_PIPELINE_INFERRED &&
           p->shadows == HL_SHADOWS_MAPS;
}

static uint32_t map_faces(const struct hl_plan *p)
{
    const struct hl_plan_target *t = hl_plan_target(p, HL_ROLE_SHADOW_MAP);
    return t->width > p->shadow_size ? 6 : 1;
}

void hl_maps_carve(struct hl_carve *c, struct hl_renderer *r,
                   const struct hl_renderer_desc *d)
{
    struct hl_maps *m = &r->maps;
    memset(m, 0, sizeof *m);
    if (!has_maps(d->plan))
        return;
    m->casters = hl_carve(c, d->max_items, sizeof *m->casters);
    m->textures = hl_carve(c, d->max_items, sizeof *m->textures);
}

/* Blended surfaces cast by their mask alone: fences and foliage (K 6). */
static bool casts(const struct hl_renderer *r, uint32_t surface)
{
    return hl_surface_class(r, surface) == HL_CLASS_OPAQUE ||
           (r->surfaces[surface].blended && r->surfaces[surface].masked);
}

enum hl_result hl_maps_make(struct hl_renderer *r)
{
    enum hl_result e = HL_OK;
    if (!has_maps(&r->plan))
        return HL_OK;
    for (uint32_t i = 0; i < r->n_surfaces && e == HL_OK; i++)
        if (casts(r, i))
            e = hl_surface_program(r, i, PROG_SHADOW_DEPTH,
                                   &r->prog[i][PROG_SHADOW_DEPTH]);
    for (uint32_t k = HL_MAP_NONE; k <= HL_MAP_PARALLEL && e == HL_OK; k++)
        if (k != HL_MAP_POINT || map_faces(&r->plan) == 6)
            e = hl_map_program(r, k, &r->maps.light[k]);
    return e;
}

void hl_maps_destroy(struct hl_renderer *r)
{
    for (int k = 0; k < 4; k++)
        hl_prog_destroy(r->device, &r->maps.light[k]);
}

/* ---- what casts --------------------------------------------------------- */

static void join(struct hl_box *a, const struct hl_box *b)
{
    a->min.x = b->min.x < a->min.x ? b->min.x : a->min.x;
    a->min.y = b->min.y < a->min.y ? b->min.y : a->min.y;
    a->min.z = b->min.z < a->min.z ? b->min.z : a->min.z;
    a->max.x = b->max.x > a->max.x ? b->max.x : a->max.x;
    a->max.y = b->max.y > a->max.y ? b->max.y : a->max.y;
    a->max.z = b->max.z > a->max.z ? b->max.z : a->max.z;
}

/* What is seen lies in the view and among the items: the smaller sphere is the
 * finer map. Filters of the L-buffer see a little past the picture, by a share
 * that does not change from frame to frame as jitter does. */
static void gather(struct hl_renderer *r, const struct hl_frame *f,
                   struct hl_shadow_scene *out)
{
    const struct hl_box none = { { 1e30f, 1e30f, 1e30f },
                                 { -1e30f, -1e30f, -1e30f } };
    struct hl_box all = none;
    struct hl_shadow_sphere near;
    struct hl_camera wide = f->camera;
    r->maps.n = 0;
    out->casters = none;
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        struct hl_caster *c = &r->maps.casters[r->maps.n];
        if (it->count == 0)
            continue;
        memset(c, 0, sizeof *c);
        c->item = i;
        c->box = hl_box_world(it->world, it->bounds_min, it->bounds_max);
        join(&all, &c->box);
        if (it->no_shadow || !casts(r, it->surface))
            continue;
        join(&out->casters, &c->box);
        r->maps.n++;
    }
    wide.tan_half_y *= 1.0f + 16.0f / r->span.h;
    hl_shadow_frustum(&out->seen, &wide,
                      (double)r->frame_span.w / (double)r->frame_span.h);
    hl_shadow_around(&near, &all);
    if (all.min.x <= all.max.x && near.radius < out->seen.radius)
        out->seen = near;
}

/* ---- a map -------------------------------------------------------------- */

/* Once a frame, whatever the number of lights. */
static void bind_mask(struct hl_renderer *r, const struct hl_item *it,
                      uint32_t caster, struct hl_draw *d)
{
    struct hl_caster *c = &r->maps.casters[caster];
    struct hl_texture_binding *t = r->maps.textures[caster];
    if (c->material_bytes == 0) {
        struct hl_visible v;
        memset(&v, 0, sizeof v);
        hl_gather_material(r, it, &v);
        c->material = v.material;
        c->material_bytes = v.material_bytes;
        memset(t, 0, sizeof *r->maps.textures);
        memcpy(&t[HL_TEX_BASE], it->texture, sizeof it->texture);
    }
    hl_bind_uniform(r, d, HL_SLOT_MATERIAL, c->material, c->material_bytes);
    d->textures = t;
    d->n_textures = HL_TEX_MESH_COUNT;
}

static void draw_caster(struct hl_renderer *r, const struct hl_frame *f,
                        uint32_t caster, const struct hl_shadow_map *m,
                        uint32_t face)
{
    const struct hl_item *it = &f->items[r->maps.casters[caster].item];
    struct hl_object_block b;
    float clip[16];
    memset(&b, 0, sizeof b);
    hl_shadow_clip(clip, m, face, it->world);
    memcpy(&b.clip, clip, sizeof clip);
    struct hl_draw *d = hl_draw_item(r, it, PROG_SHADOW_DEPTH);
    d->scissor = hl_shadow_rect(m, face);
    hl_bind_uniform(r, d, HL_SLOT_FRAME, r->frame_offset,
                    sizeof(struct hl_frame_block));
    hl_bind_uniform(r, d, HL_SLOT_OBJECT,
                    hl_arena_put(&r->arena, &b, sizeof b), sizeof b);
    if (r->surfaces[it->surface].masked)
        bind_mask(r, it, caster, d);
    r->stats.shadow_triangles += it->count / 3;
}

/* Finds every caster's faces. How many casters have any: pairs with the
 * light, not with its six maps. */
static uint32_t find_faces(struct hl_renderer *r,
                           const struct hl_shadow_map *m)
{
    uint32_t n = 0, faces = hl_shadow_faces(m);
    for (uint32_t i = 0; i < r->maps.n; i++) {
        struct hl_caster *c = &r->maps.casters[i];
        c->faces = 0;
        for (uint32_t k = 0; k < faces; k++)
            if (hl_shadow_touches(m, k, &c->box))
                c->faces |= (uint8_t)(1u << k);
        n += c->faces != 0;
    }
    return n;
}

static void draw_map(struct hl_renderer *r, const struct hl_frame *f,
                     const struct hl_shadow_map *m)
{
    hl_pass_begin(r, "shadow map");
    hl_pass_depth(r, r->target[HL_ROLE_SHADOW_MAP], HL_LOAD_CLEAR, false);
    for (uint32_t k = 0; k < hl_shadow_faces(m); k++)
        for (uint32_t i = 0; i < r->maps.n; i++)
            if (r->maps.casters[i].faces >> k & 1)
                draw_caster(r, f, i, m, k);
    hl_pass_end(r);
}

/* ---- its light ---------------------------------------------------------- */

static uint32_t fixed_bits(const struct hl_plan *p, enum hl_role role)
{
    return p->reversed_depth ? 0
           : hl_format_info(hl_plan_target(p, role)->format)->bits[0];
}

static void add_light(struct hl_renderer *r, const struct hl_frame *f,
                      uint32_t i, const struct hl_rect *rect,
                      const struct hl_shadow_map *m)
{
    struct hl_shadow_block b;
    struct hl_shadow_error e = hl_shadow_depth_error(
        fixed_bits(&r->plan, HL_ROLE_LIGHT_DEPTH), f->camera.near);
    hl_shadow_block_write(&b, m, &f->camera, e);
    hl_pass_begin(r, "shadowed light");
    hl_pass_color(r, r->target[HL_ROLE_LIGHT], HL_LOAD_KEEP, NULL);
    struct hl_draw *d = hl_draw_screen(r, r->maps.light[m->kind], rect);
    d->n_textures = HL_TEX_SHADOW + 1;
    hl_bind_uniform(r, d, HL_SLOT_SHADOW,
                    hl_arena_put(&r->arena, &b, sizeof b), sizeof b);
    hl_draw_lights(r, d, hl_put_batch(r, f, &i, 1, 1));
    hl_pass_end(r);
    r->stats.blends++;
}

static void draw_light(struct hl_renderer *r, const struct hl_frame *f,
                       uint32_t i, const struct hl_shadow_target *t,
                       const struct hl_shadow_scene *scene)
{
    struct hl_shadow_map m;
    struct hl_rect rect;
    if (!hl_sphere_rect(&rect, &r->spheres[i], &r->span))
        return;
    hl_shadow_fit(&m, &f->lights[r->spheres[i].light], t, scene);
    uint32_t n = find_faces(r, &m);
    if (n == 0)
        m.kind = HL_MAP_NONE;
    else
        draw_map(r, f, &m);
    add_light(r, f, i, &rect, &m);
    r->stats.shadow_lights++;
    r->stats.shadow_casters += n;
}

void hl_maps_shadowed(struct hl_renderer *r, const struct hl_frame *f)
{
    const struct hl_plan *p = &r->plan;
    struct hl_shadow_target t = { p->shadow_size, map_faces(p),
                                  p->reversed_depth,
                                  fixed_bits(p, HL_ROLE_SHADOW_MAP) };
    struct hl_shadow_scene scene;
    gather(r, f, &scene);
    hl_light_pass_textures(r);
    r->light_textures[HL_TEX_SHADOW].tex = r->target[HL_ROLE_SHADOW_MAP];
    for (uint32_t i = r->n_plain; i < r->n_spheres; i++)
        draw_light(r, f, i, &t, &scene);
}
