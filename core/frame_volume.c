/* SPDX-License-Identifier: Zlib */
/* Stencil volumes of lights and of their shadows (K 2.2, K 4).
 *
 * Both count by depth-fail: a volume's back faces behind what is seen add
 * one, its front faces there take one away, so that the stencil has how often
 * the volume winds about the visible point, wherever the camera is and
 * whatever the near plane cuts away. There is no far plane to cut anything
 * (plan.infinite_far). Then one draw of the light's rectangle tests the
 * stencil, lights, and sets it to zero again: the geometry pass clears it
 * once, and every light finds it as it was. Volumes are cut to the rectangle
 * too, or zeros would not reach all that they marked. */
#include <string.h>
#include "core/light_volume.h"
#include "core/renderer.h"
#include "core/shadow_volume.h"
#include "core/vec.h"
#include "hal/backend.h"

/* ---- memory ------------------------------------------------------------- */

static bool has_shadows(const struct hl_plan *p)
{
    return p->shadows == HL_SHADOWS_VOLUMES &&
           hl_plan_pass(p, HL_PASS_SHADOWED);
}

static bool has_lights(const struct hl_plan *p)
{
    return p->light_path == HL_LIGHT_PATH_VOLUMES &&
           hl_plan_pass(p, HL_PASS_LIGHT);
}

/* Scratch is two bytes a face and one; a mesh has fewer faces than half the
 * indices that its volume may have. */
void hl_volumes_carve(struct hl_carve *c, struct hl_renderer *r,
                      const struct hl_renderer_desc *d)
{
    struct hl_volumes *v = &r->volumes;
    memset(v, 0, sizeof *v);
    if (!has_shadows(d->plan))
        return;
    v->max_indices = d->shadow_indices ? d->shadow_indices : 0x100000;
    v->scratch_bytes = (size_t)v->max_indices + 1;
    v->indices = hl_carve(c, v->max_indices, sizeof *v->indices);
    v->scratch = hl_carve(c, v->scratch_bytes, 1);
}

/* ---- programs ----------------------------------------------------------- */

static const struct hl_stencil_face back_adds = {
    HL_COMPARE_ALWAYS, HL_STENCIL_KEEP, HL_STENCIL_INCREMENT_WRAP,
    HL_STENCIL_KEEP };
static const struct hl_stencil_face front_takes = {
    HL_COMPARE_ALWAYS, HL_STENCIL_KEEP, HL_STENCIL_DECREMENT_WRAP,
    HL_STENCIL_KEEP };
/* 0 below what is stored: inside the light. */
static const struct hl_stencil_face lit_inside = {
    HL_COMPARE_LESS, HL_STENCIL_KEEP, HL_STENCIL_ZERO, HL_STENCIL_ZERO };
static const struct hl_stencil_face lit_outside = {
    HL_COMPARE_EQUAL, HL_STENCIL_ZERO, HL_STENCIL_KEEP, HL_STENCIL_KEEP };

static enum hl_result make_marker(struct hl_renderer *r, const char *label,
                                  bool mirrored, hl_prog *out)
{
    struct hl_prog_desc p;
    memset(&p, 0, sizeof p);
    p.label = label;
    p.vertex.builtin = HL_SHADER_VOLUME_VERT;
    p.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X4;
    p.layout.stride[0] = 16;
    p.n_colors = 1;
    p.color[0] = hl_plan_target(&r->plan, HL_ROLE_LIGHT)->format;
    p.no_color_write = true;
    p.depth = hl_plan_target(&r->plan, HL_ROLE_LIGHT_DEPTH)->format;
    /* Strict: a lit face is not in its own shadow. */
    p.depth_test = r->plan.reversed_depth ? HL_COMPARE_GREATER
                                          : HL_COMPARE_LESS;
    p.stencil.front = front_takes;
    p.stencil.back = back_adds;
    p.mirrored = mirrored;
    hl_shift_specs(&r->plan, &p);
    return hl_prog_create(r->device, out, &p);
}

static enum hl_result make_shadows(struct hl_renderer *r)
{
    struct hl_volumes *v = &r->volumes;
    struct hl_buf_desc d = { "shadow volumes", 4 * (size_t)v->max_indices,
                             HL_BUF_INDEX, true, NULL };
    enum hl_result e = HL_OK;
    for (int i = 0; i < FRAMES && e == HL_OK; i++)
        e = hl_buf_create(r->device, &v->shadow_index[i], &d);
    for (int i = 0; i < 2 && e == HL_OK; i++)
        e = make_marker(r, "shadow volume", i == 1, &v->shadow[i]);
    return e == HL_OK ? hl_light_stencil_program(r, HL_PASS_SHADOWED,
                                                 &lit_outside, &v->shadowed)
                      : e;
}

static enum hl_result make_lights(struct hl_renderer *r)
{
    struct hl_volumes *v = &r->volumes;
    struct hl_light_meshes m;
    hl_light_meshes_make(&m);
    struct hl_buf_desc vertex = { "light volumes", sizeof m.vertex,
                                  HL_BUF_VERTEX, false, m.vertex };
    struct hl_buf_desc index = { "light volumes", sizeof m.index,
                                 HL_BUF_INDEX, false, m.index };
    enum hl_result e = hl_buf_create(r->device, &v->vertex, &vertex);
    if (e == HL_OK)
        e = hl_buf_create(r->device, &v->index, &index);
    if (e == HL_OK)
        e = make_marker(r, "light volume", false, &v->mark);
    return e == HL_OK ? hl_light_stencil_program(r, HL_PASS_LIGHT,
                                                 &lit_inside, &v->light) : e;
}

enum hl_result hl_volumes_make(struct hl_renderer *r)
{
    enum hl_result e = has_shadows(&r->plan) ? make_shadows(r) : HL_OK;
    return e == HL_OK && has_lights(&r->plan) ? make_lights(r) : e;
}

void hl_volumes_destroy(struct hl_renderer *r)
{
    struct hl_volumes *v = &r->volumes;
    hl_buf_destroy(r->device, &v->vertex);
    hl_buf_destroy(r->device, &v->index);
    for (int i = 0; i < FRAMES; i++)
        hl_buf_destroy(r->device, &v->shadow_index[i]);
    hl_prog_destroy(r->device, &v->mark);
    hl_prog_destroy(r->device, &v->light);
    hl_prog_destroy(r->device, &v->shadowed);
    for (int i = 0; i < 2; i++)
        hl_prog_destroy(r->device, &v->shadow[i]);
}

/* ---- draws -------------------------------------------------------------- */

/* The matrix of the geometry pass, product by product (hl_gather_object). */
static uint32_t put_volume(struct hl_renderer *r, const struct hl_frame *f,
                           const float world[16], const float light[4])
{
    struct hl_volume_block b;
    float proj[16], mv[16], clip[16];
    hl_view_to_clip(r, &f->camera, true, proj);
    hl_mul4(mv, f->camera.view, world);
    hl_mul4(clip, proj, mv);
    memcpy(&b.clip, clip, sizeof clip);
    b.light = hl_v4(light[0], light[1], light[2], light[3]);
    return hl_arena_put(&r->arena, &b, sizeof b);
}

static struct hl_draw *draw_marker(struct hl_renderer *r, hl_prog prog,
                                   const struct hl_rect *rect, uint32_t block)
{
    struct hl_draw *d = hl_draw_begin(r);
    d->prog = prog;
    d->scissor = *rect;
    hl_bind_uniform(r, d, HL_SLOT_VOLUME, block,
                    sizeof(struct hl_volume_block));
    return d;
}

static void draw_light(struct hl_renderer *r, const struct hl_frame *f,
                       hl_prog prog, const struct hl_rect *rect, uint32_t i)
{
    struct hl_draw *d = hl_draw_screen(r, prog, rect);
    hl_draw_lights(r, d, hl_put_batch(r, f, &i, 1, 1));
    r->stats.blends++;
}

/* ---- lights ------------------------------------------------------------- */

static void mark_light(struct hl_renderer *r, const struct hl_frame *f,
                       const struct hl_rect *rect, const struct hl_light *l)
{
    static const float none[4] = { 0, 0, 0, 1 };
    float world[16];
    uint32_t first, count;
    if (!hl_light_volume(l, &first, &count, world))
        return;
    struct hl_draw *d = draw_marker(r, r->volumes.mark, rect,
                                    put_volume(r, f, world, none));
    d->vertex[0] = r->volumes.vertex;
    d->index = r->volumes.index;
    d->index16 = true;
    d->first = first;
    d->count = count;
    r->stats.light_volumes++;
}

static bool by_volume(const struct hl_renderer *r, const struct hl_light *l,
                      const struct hl_rect *rect)
{
    return l->kind != HL_DIRECTIONAL &&
           (uint64_t)rect->width * (uint64_t)rect->height >=
           r->plan.volume_texels;
}

/* Those without volumes first: a change of program for all of them, where
 * the others change twice a light. */
void hl_volumes_lights(struct hl_renderer *r, const struct hl_frame *f)
{
    for (int volumes = 0; volumes < 2; volumes++)
        for (uint32_t i = 0; i < r->n_plain; i++) {
            const struct hl_light *l = &f->lights[r->spheres[i].light];
            struct hl_rect rect;
            if (!hl_sphere_rect(&rect, &r->spheres[i], &r->span) ||
                by_volume(r, l, &rect) != (volumes == 1))
                continue;
            if (volumes)
                mark_light(r, f, &rect, l);
            draw_light(r, f, volumes ? r->volumes.light
                                     : r->light_prog[0][1], &rect, i);
        }
}

/* ---- shadows ------------------------------------------------------------ */

static void begin_shadowed(struct hl_renderer *r)
{
    hl_pass_begin(r, "shadowed light");
    hl_pass_color(r, r->target[HL_ROLE_LIGHT], HL_LOAD_KEEP, NULL);
    hl_pass_depth(r, r->target[HL_ROLE_LIGHT_DEPTH], HL_LOAD_KEEP, false);
}

/* All indices are in use by passes on their way: wait for those, and go on
 * with the same stencil and the same room. */
static void make_room(struct hl_renderer *r)
{
    hl_pass_end(r);
    if (r->result == HL_OK)
        r->result = hl_submit(r->device, true);
    r->volumes.n_indices = 0;
    begin_shadowed(r);
}

static enum hl_result write_volume(struct hl_volumes *v,
                                   const struct hl_item *it,
                                   const float light[4], unsigned parts,
                                   struct hl_shadow_counts *n)
{
    return hl_shadow_volume_write(n, v->indices + v->n_indices,
                                  v->max_indices - v->n_indices, v->scratch,
                                  v->scratch_bytes, it->shadow_mesh, light,
                                  parts);
}

static void refuse(struct hl_renderer *r, enum hl_result e)
{
    bool limit = e == HL_ERR_LIMIT;
    hl_bk_log(r->device, HL_LOG_ERROR, limit ? HL_MSG_LIMIT : HL_MSG_ARGUMENT,
              limit ? "hl_renderer_desc.shadow_indices"
                    : "hl_item.shadow_mesh",
              limit ? ": too few for one object's shadow volume"
                    : ": no shadow volume can be made of it", NULL);
    if (r->result == HL_OK)
        r->result = e;
}

static void draw_shadow(struct hl_renderer *r, const struct hl_frame *f,
                        const struct hl_rect *rect, const struct hl_item *it,
                        const float light[4])
{
    struct hl_volumes *v = &r->volumes;
    struct hl_shadow_counts n;
    unsigned parts = HL_SHADOW_CLOSED;
    if (r->result != HL_OK)
        return;
    if (r->surfaces[it->surface].two_sided)
        parts |= HL_SHADOW_TWO_SIDED;
    enum hl_result e = write_volume(v, it, light, parts, &n);
    if (e == HL_ERR_LIMIT && v->n_indices > 0) {
        make_room(r);
        e = write_volume(v, it, light, parts, &n);
    }
    if (e != HL_OK) {
        refuse(r, e);
        return;
    }
    uint32_t count = n.n_front + n.n_sides + n.n_back;
    if (count == 0 || r->result != HL_OK)
        return;
    r->result = hl_buf_write(r->device, v->shadow_index[r->frame],
                             4 * (size_t)v->n_indices,
                             v->indices + v->n_indices, 4 * (size_t)count);
    struct hl_draw *d = draw_marker(r, v->shadow[hl_det3(it->world) < 0], rect,
                                    put_volume(r, f, it->world, light));
    d->vertex[0] = it->shadow_vertices;
    d->index = v->shadow_index[r->frame];
    d->first = v->n_indices;
    d->count = count;
    v->n_indices += count;
    r->stats.shadow_casters++;
    r->stats.shadow_triangles += count / 3;
}

/* Items that are out of sight cast too; what is drawn as translucent, or lies
 * on other surfaces, does not. */
static bool casts(const struct hl_renderer *r, const struct hl_item *it,
                  const struct hl_light *l)
{
    if (!it->shadow_mesh || it->shadow_vertices.id == 0 || it->no_shadow ||
        hl_surface_class(r, it->surface) != HL_CLASS_OPAQUE)
        return false;
    struct hl_box box = hl_box_world(it->world, it->bounds_min,
                                     it->bounds_max);
    /* What is partly nearer than far is seen to its end. */
    struct hl_camera all = r->wide;
    all.far = 1e9f;
    return hl_shadow_reaches(&box, l, &all, r->wide_aspect);
}

static void one_shadowed(struct hl_renderer *r, const struct hl_frame *f,
                         const struct hl_rect *rect, uint32_t i)
{
    const struct hl_light *l = &f->lights[r->spheres[i].light];
    begin_shadowed(r);
    for (uint32_t k = 0; k < f->n_items; k++) {
        const struct hl_item *it = &f->items[k];
        float light[4];
        if (casts(r, it, l) && hl_shadow_light(light, it->world, l))
            draw_shadow(r, f, rect, it, light);
    }
    draw_light(r, f, r->volumes.shadowed, rect, i);
    hl_pass_end(r);
    r->stats.shadow_lights++;
}

void hl_volumes_shadowed(struct hl_renderer *r, const struct hl_frame *f)
{
    hl_light_pass_textures(r);
    r->volumes.n_indices = 0;
    for (uint32_t i = r->n_plain; i < r->n_spheres; i++) {
        struct hl_rect rect;
        if (hl_sphere_rect(&rect, &r->spheres[i], &r->span))
            one_shadowed(r, f, &rect, i);
    }
}
