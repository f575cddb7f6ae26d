/* SPDX-License-Identifier: Zlib */
/* A renderer's memory, targets and buffers. */
#include <string.h>
#include "core/renderer.h"
#include "hal/backend.h"

/* ---- memory ------------------------------------------------------------- */

/* Carves one block into arrays; with base NULL it only adds up. */
struct hl_carve { uint8_t *base; size_t used; bool overflow; };

void *hl_carve(struct hl_carve *c, size_t count, size_t bytes)
{
    size_t at = (c->used + 63) & ~(size_t)63;
    if (bytes && count > ((size_t)-1 / 4 - at) / bytes) {
        c->overflow = true;
        return NULL;
    }
    c->used = at + count * bytes;
    return c->base ? c->base + at : NULL;
}

static size_t least(size_t a, size_t b) { return a < b ? a : b; }

static uint32_t lights_of(const struct hl_renderer_desc *d)
{
    return d->max_lights ? d->max_lights : 1024;
}

static uint32_t tiles_of(const struct hl_plan *p, uint32_t *nx, uint32_t *ny)
{
    uint32_t t = p->tile ? p->tile : 32;
    *nx = (p->light_width + t - 1) / t;
    *ny = (p->light_height + t - 1) / t;
    return *nx * *ny;
}

/* Light data of the tiles' draws: blocks for the lights there are, at most
 * eight a tile, and 64 MiB where that would be more. */
static size_t tile_bytes_of(const struct hl_renderer_desc *d)
{
    uint32_t nx, ny, batch = d->plan->batch ? d->plan->batch : 1;
    if (d->plan->light_path != HL_LIGHT_PATH_TILES)
        return 0;
    size_t tiles = tiles_of(d->plan, &nx, &ny);
    size_t blocks = least((lights_of(d) + batch - 1) / batch, 8);
    return tiles > 0x4000000 / HL_LIGHTS_BYTES / blocks
           ? 0x4000000 : tiles * blocks * HL_LIGHTS_BYTES;
}

/* Objects, motion and materials: 768 bytes an item with alignment; light data:
 * at most every light for every item, and 64 MiB where that would be more. */
static size_t frame_bytes_of(const struct hl_renderer_desc *d)
{
    if (d->frame_bytes)
        return least(d->frame_bytes, 0x40000000);
    size_t lights = lights_of(d), items = d->max_items;
    size_t pairs = lights + 16 > 0x4000000 / 64 / items
                   ? 0x4000000 : items * (lights + 16) * 64;
    /* A matrix for every item on 24 shadow maps. */
    size_t maps = d->plan->shadows == HL_SHADOWS_MAPS
                  ? least(items * 24, 0x40000) * 256 : 0;
    return 0x400000 + least(items, 0x100000) * 768 + pairs + maps +
           tile_bytes_of(d);
}

static size_t list_bytes_of(const struct hl_renderer_desc *d)
{
    if (d->list_bytes)
        return least(d->list_bytes, 0x40000000);
    return d->plan->light_path == HL_LIGHT_PATH_LISTS ? 0x1000000 : 0x400000;
}

static void carve_all(struct hl_carve *c, struct hl_renderer *r,
                      const struct hl_renderer_desc *d)
{
    uint32_t nx, ny, tiles = tiles_of(d->plan, &nx, &ny);
    size_t items = d->max_items, lights = lights_of(d);
    size_t texels = d->plan->tile_depth ? (size_t)d->plan->light_width *
                                          d->plan->light_height : 0;
    hl_carve(c, 1, sizeof *r);
    r->surfaces = hl_carve(c, d->n_surfaces, sizeof *r->surfaces);
    r->prog = hl_carve(c, d->n_surfaces, sizeof *r->prog);
    r->spheres = hl_carve(c, lights, sizeof *r->spheres);
    r->visible = hl_carve(c, items, sizeof *r->visible);
    r->textures = hl_carve(c, items, sizeof *r->textures);
    r->max_draws = 4096;
    r->draws = hl_carve(c, r->max_draws, sizeof *r->draws);
    r->tile_first = hl_carve(c, (size_t)tiles + 1, sizeof *r->tile_first);
    r->tile_heads = hl_carve(c, (size_t)tiles * 2, sizeof *r->tile_heads);
    r->max_refs = (uint32_t)least((size_t)tiles * lights, 0x400000);
    r->refs = hl_carve(c, r->max_refs, sizeof *r->refs);
    r->tile_z0 = hl_carve(c, tiles, sizeof(float));
    r->tile_z1 = hl_carve(c, tiles, sizeof(float));
    r->depth_read = hl_carve(c, texels, sizeof(float));
    r->arena.size = (uint32_t)frame_bytes_of(d);
    r->arena.bytes = hl_carve(c, r->arena.size, 1);
    r->lists.size = (uint32_t)list_bytes_of(d);
    r->lists.bytes = hl_carve(c, r->lists.size, 1);
    hl_stippling_carve(c, r, d);
    hl_volumes_carve(c, r, d);
    hl_maps_carve(c, r, d);
}

static bool desc_good(const struct hl_renderer_desc *d)
{
    return d && d->plan && d->plan->pipeline != HL_PIPELINE_AUTO &&
           d->max_items > 0 && d->max_items <= 0x1000000 &&
           lights_of(d) <= 0x1000000 && d->n_surfaces <= 0x10000 &&
           d->shadow_indices <= 0x10000000 &&
           (d->n_surfaces == 0 || d->surfaces);
}

size_t hl_renderer_bytes(const struct hl_renderer_desc *d)
{
    struct hl_carve c = { NULL, 0, false };
    struct hl_renderer r;
    if (!desc_good(d))
        return 0;
    carve_all(&c, &r, d);
    return c.overflow ? 0 : c.used;
}

/* ---- targets and buffers ------------------------------------------------ */

static enum hl_result make_targets(struct hl_renderer *r, bool readback)
{
    static const char *const labels[HL_ROLE_COUNT] = {
        "", "normal", "dsf", "exponent", "light depth", "light", "color",
        "depth", "resolved", "depth copy", "motion", "shadow map" };
    for (uint32_t i = 0; i < r->plan.n_targets; i++) {
        const struct hl_plan_target *t = &r->plan.target[i];
        struct hl_tex_desc d = { labels[t->role], t->format, t->width,
                                 t->height, t->samples, 1,
                                 HL_TEX_TARGET | HL_TEX_SAMPLED,
                                 t->sample_as, t->console };
        bool needed = t->role == HL_ROLE_LIGHT_DEPTH && r->plan.tile_depth;
        if (t->samples == 1 && (readback || needed))
            d.usage |= HL_TEX_READBACK;
        if (t->samples > 1)
            d.usage = HL_TEX_TARGET;
        enum hl_result e = hl_tex_create(r->device, &r->target[t->role], &d);
        if (e != HL_OK)
            return e;
    }
    return HL_OK;
}

static enum hl_result make_buffers(struct hl_renderer *r)
{
    struct hl_buf_desc u = { "frame", r->arena.size, HL_BUF_UNIFORM, true,
                             NULL };
    struct hl_buf_desc l = { "light lists", r->lists.size, HL_BUF_STORAGE,
                             true, NULL };
    struct hl_buf_desc t = { "tiles", (size_t)r->grid.nx * r->grid.ny * 8 + 8,
                             HL_BUF_STORAGE, true, NULL };
    bool lists = r->plan.light_path == HL_LIGHT_PATH_LISTS;
    bool blended = false;
    for (uint32_t i = 0; i < r->n_surfaces; i++)
        blended |= hl_surface_class(r, i) == HL_CLASS_BLENDED;
    for (int i = 0; i < FRAMES; i++) {
        enum hl_result e = hl_buf_create(r->device, &r->uniform[i], &u);
        if (e == HL_OK && (lists || blended))
            e = hl_buf_create(r->device, &r->list[i], &l);
        if (e == HL_OK && lists)
            e = hl_buf_create(r->device, &r->tiles[i], &t);
        if (e != HL_OK)
            return e;
    }
    return HL_OK;
}

static enum hl_result make_all(struct hl_renderer *r, bool readback)
{
    enum hl_result e = make_targets(r, readback);
    if (e == HL_OK)
        e = make_buffers(r);
    if (e == HL_OK)
        e = hl_programs_make(r);
    if (e == HL_OK)
        e = hl_volumes_make(r);
    return e == HL_OK ? hl_maps_make(r) : e;
}

static void set_up(struct hl_renderer *r, struct hl_device *device,
                   const struct hl_renderer_desc *d)
{
    const struct hl_caps *caps = hl_device_caps(device);
    r->device = device;
    r->plan = *d->plan;
    r->n_surfaces = d->n_surfaces;
    r->max_items = d->max_items;
    r->max_lights = lights_of(d);
    if (d->n_surfaces) {
        memcpy(r->surfaces, d->surfaces, d->n_surfaces * sizeof *r->surfaces);
        memset(r->prog, 0, d->n_surfaces * sizeof *r->prog);
    }
    r->arena.align = caps->uniform_align ? caps->uniform_align : 1;
    r->lists.align = 16;
    hl_inspect_set_up(r);
    tiles_of(&r->plan, &r->grid.nx, &r->grid.ny);  /* at most               */
    r->grid.tile = r->plan.tile ? r->plan.tile : 32;
}

enum hl_result hl_renderer_create(struct hl_renderer **out,
                                  struct hl_device *device,
                                  const struct hl_renderer_desc *desc,
                                  void *memory)
{
    if (!out)
        return HL_ERR_INVALID;
    *out = NULL;
    if (!device || !memory || hl_renderer_bytes(desc) == 0)
        return HL_ERR_INVALID;
    struct hl_renderer *r = memory;
    struct hl_carve c = { memory, 0, false };
    memset(r, 0, sizeof *r);
    carve_all(&c, r, desc);
    set_up(r, device, desc);
    enum hl_result e = make_all(r, desc->readback);
    if (e != HL_OK) {
        hl_renderer_destroy(&r);
        return e;
    }
    *out = r;
    return HL_OK;
}

void hl_renderer_destroy(struct hl_renderer **renderer)
{
    if (!renderer || !*renderer)
        return;
    struct hl_renderer *r = *renderer;
    struct hl_device *d = r->device;
    for (int i = 0; i < HL_ROLE_COUNT; i++)
        hl_tex_destroy(d, &r->target[i]);
    hl_tex_destroy(d, &r->inspect_color);
    hl_tex_destroy(d, &r->inspect_depth);
    for (int i = 0; i < LIGHT_SIZES * 2; i++)
        hl_prog_destroy(d, &r->light_prog[i / 2][i % 2]);
    hl_prog_destroy(d, &r->list_prog);
    hl_prog_destroy(d, &r->count_prog);
    hl_prog_destroy(d, &r->count_tiles);
    hl_prog_destroy(d, &r->depth_copy);
    hl_volumes_destroy(r);
    hl_maps_destroy(r);
    for (uint32_t i = 0; i < r->n_surfaces; i++)
        for (int k = 0; k < PROG_KINDS; k++)
            hl_prog_destroy(d, &r->prog[i][k]);
    for (int i = 0; i < FRAMES; i++) {
        hl_buf_destroy(d, &r->uniform[i]);
        hl_buf_destroy(d, &r->list[i]);
        hl_buf_destroy(d, &r->tiles[i]);
    }
    *renderer = NULL;
}
