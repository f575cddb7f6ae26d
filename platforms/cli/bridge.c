/* SPDX-License-Identifier: Zlib */
/* A world: surfaces, materials, lights, and an item for each object. */
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge_parts.h"
#include "platforms/host/util.h"

static void *take(void *user, size_t bytes)
{
    (void)user;
    return malloc(bytes);
}

static void give(void *user, void *memory)
{
    (void)user;
    free(memory);
}

struct hl_hooks hlc_hooks(void)
{
    struct hl_hooks h = { take, give, NULL };
    return h;
}

bool hlc_bridge_fail(struct hlc_bridge *b, const char *what,
                     enum hl_result reason)
{
    return hlh_fail(b->error, b->scene->name, "%s: %s", what ? what : "mesh",
                    hl_result_name(reason));
}

/* ---- materials and lights ---------------------------------------------- */

static void material_of(struct hl_material *out, const struct hlh_material *m,
                        const struct hlc_world_options *o)
{
    memset(out, 0, sizeof *out);
    memcpy(out->base, m->base_color, sizeof out->base);
    out->metallic = m->metallic;
    out->roughness = m->roughness;
    memcpy(out->emission, m->emission, sizeof out->emission);
    out->normal_scale = m->normal_scale;
    out->alpha_cutoff = m->alpha_cutoff;
    out->no_specular = o->no_specular;
    out->brdf = m->brdf == HLH_BRDF_SKIN ? HL_BRDF_SKIN : HL_BRDF_BLINN_PHONG;
}

static void light_of(struct hl_light *out, const struct hlh_light *l)
{
    memset(out, 0, sizeof *out);
    out->kind = l->kind == HLH_LIGHT_POINT ? HL_POINT
                : l->kind == HLH_LIGHT_SPOT ? HL_SPOT : HL_DIRECTIONAL;
    out->falloff = l->falloff == HLH_FALLOFF_SMOOTH ? HL_SMOOTH
                                                    : HL_INVERSE_SQUARE;
    memcpy(out->position, l->position, sizeof out->position);
    memcpy(out->direction, l->direction, sizeof out->direction);
    memcpy(out->color, l->color, sizeof out->color);
    out->radius = l->radius;
    out->inner = l->inner_angle;
    out->outer = l->outer_angle;
    out->shadow = l->shadow;
}

static bool make_materials_and_lights(struct hlc_bridge *b)
{
    const struct hlh_scene *s = b->scene;
    struct hlc_world *w = b->world;
    w->materials = calloc((size_t)s->n_materials + 1, sizeof *w->materials);
    w->lights = calloc((size_t)s->n_lights + 1, sizeof *w->lights);
    if (!w->materials || !w->lights)
        return hlc_bridge_fail(b, "materials", HL_ERR_MEMORY);
    for (uint32_t i = 0; i < s->n_materials; i++)
        material_of(&w->materials[i], &s->materials[i], b->options);
    for (uint32_t i = 0; i < s->n_lights; i++)
        light_of(&w->lights[i], &s->lights[i]);
    w->n_lights = s->n_lights;
    return true;
}

/* ---- surfaces ---------------------------------------------------------- */

static bool is_mirrored(const float m[16])
{
    double d = (double)m[0] * ((double)m[5] * m[10] - (double)m[6] * m[9]) -
               (double)m[4] * ((double)m[1] * m[10] - (double)m[2] * m[9]) +
               (double)m[8] * ((double)m[1] * m[6] - (double)m[2] * m[5]);
    return d < 0;
}

static bool same_surface(const struct hl_surface *a,
                         const struct hl_surface *b)
{
    for (int i = 0; i < HL_MAX_ATTRS; i++)
        if (a->layout.attr[i].format != b->layout.attr[i].format)
            return false;
    return a->textures == b->textures && a->vertex_color == b->vertex_color &&
           a->masked == b->masked && a->blended == b->blended &&
           a->decal == b->decal && a->two_sided == b->two_sided &&
           a->mirrored == b->mirrored;
}

/* Surfaces are kinds of program: few, so a search through them will do. */
static uint32_t surface_of(struct hlc_world *w, const struct hlc_part *part,
                           const struct hlh_material *m, bool mirrored)
{
    struct hl_surface s;
    memset(&s, 0, sizeof s);
    hlc_layout_describe(&s.layout, part->layout);
    s.textures = part->textures;
    s.vertex_color = part->layout == HLC_LAYOUT_COLORED;
    s.masked = part->masked;
    s.blended = part->blended;
    s.decal = part->decal;
    s.two_sided = m->double_sided;
    s.mirrored = mirrored;
    uint32_t i = 0;
    while (i < w->n_surfaces && !same_surface(&w->surfaces[i], &s))
        i++;
    if (i == w->n_surfaces)
        w->surfaces[w->n_surfaces++] = s;
    return i;
}

/* ---- items ------------------------------------------------------------- */

static uint8_t wrap_of(enum hlh_wrap wrap)
{
    return wrap == HLH_WRAP_REPEAT ? HL_WRAP_REPEAT
           : wrap == HLH_WRAP_MIRROR ? HL_WRAP_MIRROR : HL_WRAP_CLAMP;
}

static void bind(struct hl_texture_binding *out, const struct hlc_world *w,
                 const struct hlh_texture *t, bool linear)
{
    out->tex = w->textures[2 * (size_t)t->image + linear];
    out->filter = HL_FILTER_TRILINEAR;
    out->wrap_u = wrap_of(t->wrap_u);
    out->wrap_v = wrap_of(t->wrap_v);
}

static void bind_textures(struct hl_item *item, const struct hlc_world *w,
                          const struct hlc_part *part,
                          const struct hlh_material *m)
{
    if (part->textures & HL_TEXTURED_BASE)
        bind(&item->texture[0], w, &m->base_texture, false);
    if (part->textures & HL_TEXTURED_METAL_ROUGH)
        bind(&item->texture[1], w, &m->metal_rough_texture, true);
    if (part->textures & HL_TEXTURED_NORMAL)
        bind(&item->texture[2], w, &m->normal_texture, true);
    if (part->textures & HL_TEXTURED_EMISSION)
        bind(&item->texture[3], w, &m->emission_texture, false);
}

static void add_item(struct hlc_bridge *b, uint32_t object)
{
    const struct hlh_object *o = &b->scene->objects[object];
    uint32_t material = b->scene->meshes[o->mesh].material;
    const struct hlh_material *m = &b->scene->materials[material];
    const struct hlc_part *part = &b->parts[o->mesh];
    struct hlc_world *w = b->world;
    if (!part->used || part->hidden)
        return;
    struct hl_item *item = &w->items[w->n_items];
    w->item_object[w->n_items++] = object;
    item->surface = surface_of(w, part, m, is_mirrored(o->world));
    memcpy(item->world, o->world, sizeof item->world);
    memcpy(item->bounds_min, part->min, sizeof item->bounds_min);
    memcpy(item->bounds_max, part->max, sizeof item->bounds_max);
    item->material = &w->materials[material];
    item->name = object + 1;
    item->no_shadow = o->no_shadow;
    bind_textures(item, w, part, m);
}

static bool make_items(struct hlc_bridge *b)
{
    const struct hlh_scene *s = b->scene;
    struct hlc_world *w = b->world;
    w->items = calloc((size_t)s->n_objects + 1, sizeof *w->items);
    w->item_object = calloc((size_t)s->n_objects + 1, sizeof *w->item_object);
    /* One a mesh, and one more where some of its objects are mirrored. */
    w->surfaces = calloc(2 * (size_t)s->n_meshes + 1, sizeof *w->surfaces);
    if (!w->items || !w->item_object || !w->surfaces)
        return hlc_bridge_fail(b, "objects", HL_ERR_MEMORY);
    for (uint32_t i = 0; i < s->n_objects; i++)
        add_item(b, i);
    return true;
}

/* ---- life -------------------------------------------------------------- */

bool hlc_world_create(struct hlc_world *out, struct hl_device *device,
                      const struct hlh_scene *scene,
                      const struct hlc_world_options *options,
                      struct hlh_error *error)
{
    struct hlc_bridge b = { out, scene, options, hlc_hooks(), NULL, error };
    memset(out, 0, sizeof *out);
    out->device = device;
    out->scene = scene;
    bool ok = hlc_parts_prepare(&b) && hlc_textures_upload(&b) &&
              make_materials_and_lights(&b) && make_items(&b) &&
              hlc_ids_number(&b) && hlc_parts_upload(&b) &&
              hlc_shadows_make(&b);
    hlc_parts_free(&b);
    if (!ok)
        hlc_world_free(out);
    return ok;
}

void hlc_world_free(struct hlc_world *w)
{
    for (int i = 0; w->device && i < HLC_WORLD_BUFFERS; i++)
        hl_buf_destroy(w->device, &w->buffers[i]);
    for (size_t i = 0; w->textures && i < 2 * (size_t)w->scene->n_images; i++)
        hl_tex_destroy(w->device, &w->textures[i]);
    hlc_shadows_free(w);
    free(w->textures);
    free(w->items);
    free(w->item_object);
    free(w->surfaces);
    free(w->materials);
    free(w->lights);
    memset(w, 0, sizeof *w);
}
