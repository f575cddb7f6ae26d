/* SPDX-License-Identifier: Zlib */
/* A frame's data on the host: checks, culling, uniform blocks. */
#include <string.h>
#include "core/exact.h"
#include "core/renderer.h"
#include "core/vec.h"
#include "shaders/shared/pack.h"
#include "shaders/shared/shade.h"
#include "hal/backend.h"
#include "hal/text.h"

/* ---- arena -------------------------------------------------------------- */

static uint8_t *arena_take(struct hl_arena *a, uint32_t bytes, uint32_t *at)
{
    uint32_t start = (a->used + a->align - 1) / a->align * a->align;
    *at = 0;
    if (start > a->size || bytes > a->size - start) {
        a->full = true;
        return NULL;
    }
    a->used = start + bytes;
    *at = start;
    return a->bytes + start;
}

uint32_t hl_arena_put(struct hl_arena *a, const void *data, uint32_t bytes)
{
    uint32_t at;
    uint8_t *p = arena_take(a, bytes, &at);
    if (p)
        memcpy(p, data, bytes);
    return at;
}

static enum hl_result flush_one(struct hl_renderer *r, struct hl_arena *a,
                                hl_buf buf)
{
    if (a->used == a->flushed || buf.id == 0)
        return HL_OK;
    enum hl_result e = hl_buf_write(r->device, buf, a->flushed,
                                    a->bytes + a->flushed,
                                    a->used - a->flushed);
    a->flushed = a->used;
    return e;
}

enum hl_result hl_frame_flush(struct hl_renderer *r)
{
    if (r->arena.full || r->lists.full) {
        hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_LIMIT,
                  r->arena.full ? "hl_renderer_desc.frame_bytes"
                                : "hl_renderer_desc.list_bytes",
                  ": too small for this frame", NULL);
        return HL_ERR_LIMIT;
    }
    enum hl_result e = flush_one(r, &r->arena, r->uniform[r->frame]);
    return e == HL_OK ? flush_one(r, &r->lists, r->list[r->frame]) : e;
}

/* ---- checks ------------------------------------------------------------- */

static enum hl_result refuse(struct hl_renderer *r, const char *what,
                             uint32_t index, const char *why)
{
    char line[160];
    struct hl_text t = hl_text_begin(line, sizeof line);
    hl_text_str(&t, what);
    hl_text_str(&t, " ");
    hl_text_uint(&t, index);
    hl_text_str(&t, ": ");
    hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_ARGUMENT, line, why, NULL);
    return HL_ERR_INVALID;
}

static bool finite_all(const float *v, int n)
{
    for (int i = 0; i < n; i++)
        if (v[i] - v[i] != 0)
            return false;
    return true;
}

static bool material_finite(const struct hl_material *m)
{
    return finite_all(m->base, 4) && finite_all(&m->metallic, 1) &&
           finite_all(&m->roughness, 1) && finite_all(m->emission, 3) &&
           finite_all(&m->normal_scale, 1) && finite_all(&m->alpha_cutoff, 1);
}

static enum hl_result check_item(struct hl_renderer *r,
                                 const struct hl_item *it, uint32_t i)
{
    if (it->surface >= r->n_surfaces)
        return refuse(r, "hl_frame.items", i, "surface is not one");
    const struct hl_surface *s = &r->surfaces[it->surface];
    if (!it->material && (!s->own_material || s->blended || s->decal))
        return refuse(r, "hl_frame.items", i, "material is NULL");
    if (s->own_material && (!it->material_block || !it->material_bytes))
        return refuse(r, "hl_frame.items", i, "material_block is NULL");
    if (it->material && !material_finite(it->material))
        return refuse(r, "hl_frame.items", i, "material not finite");
    if (r->plan.stipple && r->plan.stipple_mode == HL_STIPPLE_USER &&
        it->stipple >= r->plan.stipple * r->plan.stipple)
        return refuse(r, "hl_frame.items", i, "stipple is no pattern");
    if (!finite_all(it->world, 16) || !finite_all(it->bounds_min, 3) ||
        !finite_all(it->bounds_max, 3))
        return refuse(r, "hl_frame.items", i, "world or bounds not finite");
    if (it->material && (unsigned)it->material->brdf >= HL_BRDF_COUNT)
        return refuse(r, "hl_frame.items", i, "material.brdf is not one");
    if (r->plan.motion && it->world_before &&
        !finite_all(it->world_before, 16))
        return refuse(r, "hl_frame.items", i, "world_before not finite");
    return HL_OK;
}

static bool is_camera(const struct hl_camera *c)
{
    return finite_all(c->view, 16) && c->near > 0 && c->far > c->near &&
           c->tan_half_y > 0 && finite_all(&c->far, 1) &&
           finite_all(&c->tan_half_y, 1);
}

static enum hl_result check_frame(struct hl_renderer *r,
                                  const struct hl_frame *f)
{
    const struct hl_camera *c = &f->camera;
    if ((f->n_items && !f->items) || (f->n_lights && !f->lights))
        return refuse(r, "hl_frame", 0, "items or lights is NULL");
    if (!is_camera(c))
        return refuse(r, "hl_frame.camera", 0, "not a camera");
    if (!(c->jitter[0] >= -1 && c->jitter[0] <= 1) ||
        !(c->jitter[1] >= -1 && c->jitter[1] <= 1))
        return refuse(r, "hl_frame.camera", 0, "jitter is not within -1..1");
    if (f->width > r->plan.width || f->height > r->plan.height)
        return refuse(r, "hl_frame", 0, "width or height above the plan's");
    if (r->plan.motion && f->before && !is_camera(f->before))
        return refuse(r, "hl_frame.before", 0, "not a camera");
    if (!finite_all(f->ambient, 3) || !finite_all(f->background, 3))
        return refuse(r, "hl_frame", 0, "ambient or background not finite");
    if (f->n_items > r->max_items || f->n_lights > r->max_lights) {
        refuse(r, "hl_frame", 0, "more items or lights than the desc's max");
        return HL_ERR_LIMIT;
    }
    for (uint32_t i = 0; i < f->n_lights; i++) {
        const char *why = hl_light_check(&f->lights[i]);
        if (why)
            return refuse(r, "hl_frame.lights", i, why);
    }
    for (uint32_t i = 0; i < f->n_items; i++)
        if (check_item(r, &f->items[i], i) != HL_OK)
            return HL_ERR_INVALID;
    return HL_OK;
}

/* ---- blocks ------------------------------------------------------------- */

static hl_vec4 ray(const struct hl_span *s)
{
    float x = 2 * s->tan_x / s->w, y = 2 * s->tan_y / s->h;
    return hl_v4(x, -y, -s->tan_x - s->jx * x, s->tan_y + s->jy * y);
}

static void put_frame_block(struct hl_renderer *r, const struct hl_frame *f)
{
    const struct hl_plan *p = &r->plan;
    const struct hl_camera *c = &f->camera;
    struct hl_frame_block b;
    memset(&b, 0, sizeof b);
    b.ray_light = ray(p->light_width ? &r->span : &r->frame_span);
    hl_depth_terms(r, c, &b.depth.x, &b.depth.y);
    b.depth.z = 1.0f / c->far;
    b.depth.w = c->far;
    b.ambient = hl_v4(f->ambient[0], f->ambient[1], f->ambient[2],
                      p->light_scale);
    b.misc = hl_v4(p->exponent, (float)r->grid.tile, (float)r->grid.nx, 0);
    r->frame_offset = hl_arena_put(&r->arena, &b, sizeof b);
}

static void copy4(hl_mat4 *out, const float m[16]) { memcpy(out, m, 64); }

void hl_gather_object(struct hl_renderer *r, const struct hl_frame *f,
                      struct hl_visible *v)
{
    const struct hl_item *it = &f->items[v->item];
    struct hl_object_block b;
    float proj[16], mv[16], clip[16], cof[16];
    hl_view_to_clip(r, &f->camera, true, proj);
    hl_mul4(mv, f->camera.view, it->world);
    hl_mul4(clip, proj, mv);
    hl_cofactor3(cof, mv);
    copy4(&b.clip, clip);
    copy4(&b.normal, cof);
    copy4(&b.model_view, mv);
    float n = it->material ? hl_roughness_exponent(it->material->roughness)
                           : 1.0f;
    /* hl_exponent_encode(n), with the same bits on every machine. */
    float code = (float)hl_exact_log2((double)n) * 0.125f;
    bool patterned = v->pattern && v->pattern != HL_STIPPLE_NONE;
    b.flat_ids = hl_v4(code, hl_det3(mv) < 0 ? -1.0f : 1.0f,
                       patterned ? (float)v->pattern : 0.0f,
                       it->material ? (float)it->material->brdf : 0.0f);
    /* A decal is lit as whatever it lies on: id 0 takes any. */
    bool decal = hl_surface_class(r, v->surface) == HL_CLASS_DECAL;
    b.ids = hl_v4(decal ? 0.0f : (float)it->id_base, (float)v->item,
                  (float)v->list_first,
                  (float)v->list_count);
    v->object = hl_arena_put(&r->arena, &b, sizeof b);
}

/* Both without jitter, which is no motion of anything, and both by this
 * frame's part of the targets: motion is in this frame's pixels. */
static void put_motion(struct hl_renderer *r, const struct hl_frame *f,
                       struct hl_visible *v)
{
    const struct hl_item *it = &f->items[v->item];
    const struct hl_camera *before = f->before ? f->before : &f->camera;
    struct hl_motion_block b;
    float proj[16], mv[16], clip[16];
    hl_view_to_clip(r, &f->camera, false, proj);
    hl_mul4(mv, f->camera.view, it->world);
    hl_mul4(clip, proj, mv);
    copy4(&b.now, clip);
    hl_view_to_clip(r, before, false, proj);
    hl_mul4(mv, before->view, it->world_before ? it->world_before : it->world);
    hl_mul4(clip, proj, mv);
    copy4(&b.before, clip);
    v->motion = hl_arena_put(&r->arena, &b, sizeof b);
}

void hl_gather_material(struct hl_renderer *r, const struct hl_item *it,
                        struct hl_visible *v)
{
    struct hl_material_block b;
    const struct hl_material *m = it->material;
    if (r->surfaces[it->surface].own_material &&
        hl_surface_class(r, it->surface) == HL_CLASS_OPAQUE) {
        v->material = hl_arena_put(&r->arena, it->material_block,
                                   it->material_bytes);
        v->material_bytes = it->material_bytes;
        return;
    }
    hl_vec3 base = hl_load3(m->base);
    float n = hl_roughness_exponent(m->roughness);
    float weight = m->no_specular ? 0.0f : 1.0f;
    hl_vec3 rho = hl_material_albedo(base, m->metallic);
    hl_vec3 ks = hl_scale3(hl_material_specular(base, m->metallic, n), weight);
    b.base = hl_v4(base.x, base.y, base.z, m->base[3]);
    b.params = hl_v4(m->metallic, m->roughness, m->normal_scale,
                     m->alpha_cutoff);
    b.emission = hl_v4(m->emission[0], m->emission[1], m->emission[2], weight);
    b.albedo = hl_v4(rho.x, rho.y, rho.z, m->base[3]);
    b.specular = hl_v4(ks.x, ks.y, ks.z, n);
    v->material = hl_arena_put(&r->arena, &b, sizeof b);
    v->material_bytes = sizeof b;
}

/* ---- culling ------------------------------------------------------------ */

enum hl_class hl_surface_class(const struct hl_renderer *r, uint32_t surface)
{
    const struct hl_surface *s = &r->surfaces[surface];
    if (s->decal && r->plan.decals == HL_DECALS_BLEND_NORMALS)
        return HL_CLASS_DECAL;
    return s->blended || s->decal ? HL_CLASS_BLENDED : HL_CLASS_OPAQUE;
}

/* Lights with shadows go to the end: lists and batches have none of them.
 * Both kinds stay in order, since blended sums round. Those at the end are
 * bounded a second time, which takes no memory and time by their number. */
static void part_lights(struct hl_renderer *r, const struct hl_frame *f)
{
    uint32_t n = 0;
    r->n_plain = r->n_spheres;
    if (r->plan.shadows == HL_SHADOWS_NONE)
        return;
    for (uint32_t i = 0; i < r->n_spheres; i++)
        if (!f->lights[r->spheres[i].light].shadow)
            r->spheres[n++] = r->spheres[i];
    r->n_plain = n;
    for (uint32_t i = 0; i < f->n_lights && n < r->n_spheres; i++)
        if (f->lights[i].shadow &&
            hl_lights_view(&r->spheres[n], &f->lights[i], 1, &r->wide,
                           r->wide_aspect))
            r->spheres[n++].light = i;
}

/* Shell sort, by surface and nearest first (or, blended, farthest first): in
 * place, no recursion, and equal depths fall back to the item order, so that
 * a frame is deterministic. By surface, since a change of program costs a
 * software device as much as thousands of pixels. */
static bool before(const struct hl_visible *a, const struct hl_visible *b,
                   bool far_first)
{
    if (!far_first && a->surface != b->surface)
        return a->surface < b->surface;
    if (a->z != b->z)
        return far_first ? a->z > b->z : a->z < b->z;
    return a->item < b->item;
}

static void sort_visible(struct hl_visible *v, uint32_t n, bool far_first)
{
    uint32_t gap = 1;
    while (gap < n / 3)
        gap = gap * 3 + 1;
    for (; gap > 0; gap /= 3)
        for (uint32_t i = gap; i < n; i++) {
            struct hl_visible x = v[i];
            uint32_t j = i;
            for (; j >= gap && before(&x, &v[j - gap], far_first); j -= gap)
                v[j] = v[j - gap];
            v[j] = x;
        }
}

static uint32_t cull(struct hl_renderer *r, const struct hl_frame *f,
                     uint32_t n, enum hl_class class)
{
    for (uint32_t i = 0; i < f->n_items; i++) {
        const struct hl_item *it = &f->items[i];
        struct hl_visible *v = &r->visible[n];
        if (hl_surface_class(r, it->surface) != class || it->count == 0)
            continue;
        memset(v, 0, sizeof *v);
        v->item = i;
        v->surface = it->surface;
        v->box = hl_box_world(it->world, it->bounds_min, it->bounds_max);
        if (!hl_box_visible(&v->box, &r->wide, r->wide_aspect, &v->z))
            continue;
        if (class != HL_CLASS_OPAQUE) {
            /* By the depth of the centre: z is the nearest corner's. */
            hl_vec3 c = hl_scale3(hl_add3(v->box.min, v->box.max), 0.5f);
            v->z = -hl_transform_point(f->camera.view, c).z;
        }
        n++;
    }
    return n;
}

static void put_textures(struct hl_renderer *r, const struct hl_item *it,
                         uint32_t visible)
{
    struct hl_texture_binding (*t)[HL_TEX_MESH_COUNT] = r->textures[visible];
    memset(t, 0, sizeof r->textures[visible]);
    t[1][HL_TEX_LIGHT].tex = r->target[HL_ROLE_LIGHT];
    if (r->plan.dsf_bilinear)
        t[1][HL_TEX_LIGHT].filter = HL_FILTER_LINEAR;
    t[1][HL_TEX_DSF].tex = r->target[HL_ROLE_DSF];
    memcpy(&t[0][HL_TEX_BASE], it->texture, sizeof it->texture);
    memcpy(&t[1][HL_TEX_BASE], it->texture, sizeof it->texture);
}

/* The lights that touch a blended item, as a list for its one draw. */
static void put_list(struct hl_renderer *r, const struct hl_frame *f,
                     struct hl_visible *v)
{
    hl_vec4 data[HL_LIGHT_VEC4S];
    v->list_first = (r->lists.used + 15) / 16;
    for (uint32_t i = 0; i < r->n_spheres; i++) {
        const struct hl_lit_sphere *s = &r->spheres[i];
        if (!hl_sphere_touches_box(s, &v->box))
            continue;
        uint32_t n = hl_light_write(data, &f->lights[s->light], s,
                                    f->camera.view, r->plan.kinds);
        hl_arena_put(&r->lists, data, n * 16);
        v->list_count++;
    }
    r->stats.light_refs += v->list_count;
}

enum hl_result hl_frame_gather(struct hl_renderer *r, const struct hl_frame *f)
{
    enum hl_result e = check_frame(r, f);
    if (e != HL_OK)
        return e;
    memset(&r->stats, 0, sizeof r->stats);
    r->frame = (r->frame + 1) % FRAMES;
    r->arena.used = r->arena.flushed = 0;
    r->lists.used = r->lists.flushed = 0;
    r->arena.full = r->lists.full = false;
    r->result = HL_OK;
    hl_view_set(r, f);
    r->n_spheres = hl_lights_view(r->spheres, f->lights, f->n_lights,
                                  &r->wide, r->wide_aspect);
    if (r->plan.dsf == HL_DSF_DARK && r->n_spheres > 0)
        return refuse(r, "hl_frame.lights", r->spheres[0].light,
                      "the plan was made for no lights; plan again");
    part_lights(r, f);
    r->n_opaque = cull(r, f, 0, HL_CLASS_OPAQUE);
    r->n_decals = cull(r, f, r->n_opaque, HL_CLASS_DECAL);
    r->n_visible = cull(r, f, r->n_decals, HL_CLASS_BLENDED);
    sort_visible(r->visible, r->n_opaque, false);
    sort_visible(r->visible + r->n_opaque, r->n_decals - r->n_opaque, true);
    sort_visible(r->visible + r->n_decals, r->n_visible - r->n_decals, true);
    for (uint32_t i = r->n_decals; i < r->n_visible; i++)
        r->visible[i].pattern = HL_STIPPLE_NONE;
    r->stats.unstippled = r->n_visible - r->n_decals;
    if (r->plan.stipple && r->n_visible > r->n_decals)
        e = hl_stippling_assign(r, f);
    if (e != HL_OK)
        return e;
    put_frame_block(r, f);
    for (uint32_t i = 0; i < r->n_visible; i++) {
        struct hl_visible *v = &r->visible[i];
        if (v->pattern == HL_STIPPLE_NONE)
            put_list(r, f, v);
        hl_gather_object(r, f, v);
        if (r->plan.motion)
            put_motion(r, f, v);
        hl_gather_material(r, &f->items[v->item], v);
        put_textures(r, &f->items[v->item], i);
    }
    r->stats.items = r->n_visible;
    r->stats.decals = r->n_decals - r->n_opaque;
    r->stats.items_culled = f->n_items - r->n_visible;
    r->stats.lights = r->n_spheres;
    r->stats.lights_culled = f->n_lights - r->n_spheres;
    return HL_OK;
}
