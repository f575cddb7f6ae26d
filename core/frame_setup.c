/* SPDX-License-Identifier: Zlib */
/* A renderer's memory, targets and programs. */
#include <string.h>
#include "core/renderer.h"
#include "hal/backend.h"

/* ---- memory ------------------------------------------------------------- */

/* Carves one block into arrays; with base NULL it only adds up. */
struct carve { uint8_t *base; size_t used; bool overflow; };

static void *carve(struct carve *c, size_t count, size_t bytes)
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

/* Objects and materials: 768 bytes an item with alignment; light data: at
 * most every light for every item, and 64 MiB where that would be more. */
static size_t frame_bytes_of(const struct hl_renderer_desc *d)
{
    if (d->frame_bytes)
        return least(d->frame_bytes, 0x40000000);
    size_t lights = lights_of(d), items = d->max_items;
    size_t pairs = lights + 16 > 0x4000000 / 64 / items
                   ? 0x4000000 : items * (lights + 16) * 64;
    return 0x400000 + least(items, 0x100000) * 768 + pairs + tile_bytes_of(d);
}

static size_t list_bytes_of(const struct hl_renderer_desc *d)
{
    if (d->list_bytes)
        return least(d->list_bytes, 0x40000000);
    return d->plan->light_path == HL_LIGHT_PATH_LISTS ? 0x1000000 : 0x400000;
}

static void carve_all(struct carve *c, struct hl_renderer *r,
                      const struct hl_renderer_desc *d)
{
    uint32_t nx, ny, tiles = tiles_of(d->plan, &nx, &ny);
    size_t items = d->max_items, lights = lights_of(d);
    size_t texels = d->plan->tile_depth ? (size_t)d->plan->light_width *
                                          d->plan->light_height : 0;
    carve(c, 1, sizeof *r);
    r->surfaces = carve(c, d->n_surfaces, sizeof *r->surfaces);
    r->prog = carve(c, d->n_surfaces, sizeof *r->prog);
    r->spheres = carve(c, lights, sizeof *r->spheres);
    r->visible = carve(c, items, sizeof *r->visible);
    r->textures = carve(c, items, sizeof *r->textures);
    r->max_draws = 4096;
    r->draws = carve(c, r->max_draws, sizeof *r->draws);
    r->tile_first = carve(c, (size_t)tiles + 1, sizeof *r->tile_first);
    r->tile_heads = carve(c, (size_t)tiles * 2, sizeof *r->tile_heads);
    r->max_refs = (uint32_t)least((size_t)tiles * lights, 0x400000);
    r->refs = carve(c, r->max_refs, sizeof *r->refs);
    r->tile_z0 = carve(c, tiles, sizeof(float));
    r->tile_z1 = carve(c, tiles, sizeof(float));
    r->depth_read = carve(c, texels, sizeof(float));
    r->arena.size = (uint32_t)frame_bytes_of(d);
    r->arena.bytes = carve(c, r->arena.size, 1);
    r->lists.size = (uint32_t)list_bytes_of(d);
    r->lists.bytes = carve(c, r->lists.size, 1);
}

static bool desc_good(const struct hl_renderer_desc *d)
{
    return d && d->plan && d->plan->pipeline != HL_PIPELINE_AUTO &&
           d->max_items > 0 && d->max_items <= 0x1000000 &&
           lights_of(d) <= 0x1000000 && d->n_surfaces <= 0x10000 &&
           (d->n_surfaces == 0 || d->surfaces);
}

size_t hl_renderer_bytes(const struct hl_renderer_desc *d)
{
    struct carve c = { NULL, 0, false };
    struct hl_renderer r;
    if (!desc_good(d))
        return 0;
    carve_all(&c, &r, d);
    return c.overflow ? 0 : c.used;
}

/* ---- programs ----------------------------------------------------------- */

static void spec(struct hl_prog_desc *p, uint32_t id, uint32_t value)
{
    struct hl_spec s = { id, value };
    p->spec[p->n_specs++] = s;
}

static void spec_float(struct hl_prog_desc *p, uint32_t id, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    spec(p, id, bits);
}

/* Everything of a plan that a stage which reads the L-buffer needs. */
static void inferred_specs(const struct hl_plan *plan, struct hl_prog_desc *p)
{
    float lw = (float)plan->light_width, lh = (float)plan->light_height;
    spec(p, HL_SPEC_DSF, plan->dsf);
    spec(p, HL_SPEC_LIGHT_BITS, plan->light_bits);
    spec_float(p, HL_SPEC_LIGHT_WIDTH, lw);
    spec_float(p, HL_SPEC_LIGHT_HEIGHT, lh);
    spec_float(p, HL_SPEC_RATIO_X, lw / (float)plan->width);
    spec_float(p, HL_SPEC_RATIO_Y, lh / (float)plan->height);
    spec_float(p, HL_SPEC_DSF_K, plan->dsf_k);
    spec_float(p, HL_SPEC_DSF_C, plan->dsf_c);
    spec_float(p, HL_SPEC_DSF_TAU, plan->dsf_tau);
    spec_float(p, HL_SPEC_LIGHT_SCALE, plan->light_scale);
}

static void light_specs(const struct hl_plan *plan, struct hl_prog_desc *p,
                        uint32_t batch)
{
    spec(p, HL_SPEC_SPECULAR, plan->specular);
    spec(p, HL_SPEC_FALLOFF, plan->falloff);
    spec(p, HL_SPEC_KINDS, plan->kinds);
    spec(p, HL_SPEC_BATCH, batch);
}

static bool is_full(const struct hl_surface *s)
{
    return s->textures != 0 || s->vertex_color || s->masked;
}

/* Strictly nearer: of coincident surfaces the first drawn stays, in every
 * pass and as in the reference. */
static enum hl_compare nearer(const struct hl_plan *plan)
{
    return plan->reversed_depth ? HL_COMPARE_GREATER
                                : HL_COMPARE_LESS;
}

static enum hl_format role_format(const struct hl_plan *plan, enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(plan, role);
    return t ? t->format : HL_FORMAT_NONE;
}

static void to_gbuffer(const struct hl_plan *plan, struct hl_prog_desc *p,
                       bool full)
{
    bool channel = plan->specular == HL_SPECULAR_CHANNEL;
    p->label = "geometry";
    p->vertex.builtin = full ? HL_SHADER_MESH_GBUFFER_FULL_VERT
                             : HL_SHADER_MESH_GBUFFER_VERT;
    if (channel)
        p->fragment.builtin = full ? HL_SHADER_GBUFFER_FULL_EXP_FRAG
                                   : HL_SHADER_GBUFFER_PLAIN_EXP_FRAG;
    else
        p->fragment.builtin = full ? HL_SHADER_GBUFFER_FULL_FRAG
                                   : HL_SHADER_GBUFFER_PLAIN_FRAG;
    p->n_colors = channel ? 3 : 2;
    p->color[0] = role_format(plan, HL_ROLE_NORMAL);
    p->color[1] = role_format(plan, HL_ROLE_DSF);
    p->color[2] = role_format(plan, HL_ROLE_EXPONENT);
    p->depth = role_format(plan, HL_ROLE_LIGHT_DEPTH);
}

static void to_frame(const struct hl_plan *plan, struct hl_prog_desc *p)
{
    p->n_colors = 1;
    p->color[0] = role_format(plan, HL_ROLE_COLOR);
    p->depth = role_format(plan, HL_ROLE_DEPTH);
    p->samples = plan->samples;
}

static void to_material(const struct hl_plan *plan, struct hl_prog_desc *p,
                        const struct hl_surface *s, bool full)
{
    to_frame(plan, p);
    p->label = "material";
    p->vertex.builtin = full ? HL_SHADER_MESH_UV_ID_VERT
                             : HL_SHADER_MESH_MATERIAL_VERT;
    p->fragment.builtin = full ? HL_SHADER_MATERIAL_FULL_FRAG
                               : HL_SHADER_MATERIAL_PLAIN_FRAG;
    if (s->own_material) {
        p->vertex.builtin = HL_SHADER_MESH_OWN_VERT;
        p->fragment.builtin = HL_SHADER_NONE;
        p->fragment.code = s->own_material;
    }
    inferred_specs(plan, p);
}

static void to_forward(const struct hl_plan *plan, struct hl_prog_desc *p,
                       bool full, int kind)
{
    to_frame(plan, p);
    bool base = kind != PROG_MORE;
    uint32_t batch = plan->batch;
    p->label = base ? "forward" : "forward more";
    p->vertex.builtin = full ? HL_SHADER_MESH_FORWARD_FULL_VERT
                             : HL_SHADER_MESH_FORWARD_VERT;
    p->fragment.builtin = full ? HL_SHADER_FORWARD_FULL_FRAG
                               : HL_SHADER_FORWARD_PLAIN_FRAG;
    if (kind == PROG_BLENDED)
        p->fragment.builtin = full ? HL_SHADER_FORWARD_LIST_FULL_FRAG
                                   : HL_SHADER_FORWARD_LIST_PLAIN_FRAG;
    if (base && plan->pipeline == HL_PIPELINE_FORWARD_MULTIPASS)
        batch = 0;
    light_specs(plan, p, batch);
    spec(p, HL_SPEC_BASE, base);
}

static void to_inspect(const struct hl_plan *plan, struct hl_prog_desc *p,
                       const struct hl_surface *s, int kind)
{
    bool full = is_full(s);
    p->label = "inspect";
    p->vertex.builtin = full ? HL_SHADER_MESH_UV_ID_VERT
                             : HL_SHADER_MESH_ID_VERT;
    p->n_colors = 1;
    p->depth = role_format(plan, HL_ROLE_DEPTH);
    p->color[0] = HL_FORMAT_R32_FLOAT;
    p->fragment.builtin = HL_SHADER_COUNT_FRAG;
    if (kind == PROG_ID) {
        p->fragment.builtin = full ? HL_SHADER_ID_FULL_FRAG
                                   : HL_SHADER_ID_PLAIN_FRAG;
        p->color[0] = HL_FORMAT_R32_UINT;
    } else if (kind == PROG_REJECT) {
        p->fragment.builtin = full ? HL_SHADER_REJECT_FULL_FRAG
                                   : HL_SHADER_REJECT_PLAIN_FRAG;
        p->color[0] = HL_FORMAT_R8_UNORM;
        inferred_specs(plan, p);
    }
}

enum hl_result hl_surface_program(struct hl_renderer *r, uint32_t surface,
                                  int kind, hl_prog *out)
{
    const struct hl_surface *s = &r->surfaces[surface];
    const struct hl_plan *plan = &r->plan;
    struct hl_prog_desc p;
    memset(&p, 0, sizeof p);
    p.layout = s->layout;
    p.cull = s->two_sided ? HL_CULL_NONE : HL_CULL_BACK;
    p.mirrored = s->mirrored;
    p.depth_test = nearer(plan);
    p.depth_write = kind != PROG_MORE && kind != PROG_BLENDED &&
                    kind != PROG_COUNT_MORE;
    if (kind == PROG_MORE || kind == PROG_COUNT_MORE)
        p.depth_test = HL_COMPARE_EQUAL;
    if (kind == PROG_GBUFFER)
        to_gbuffer(plan, &p, is_full(s));
    else if (kind == PROG_MATERIAL)
        to_material(plan, &p, s, is_full(s));
    else if (kind == PROG_BASE || kind == PROG_MORE || kind == PROG_BLENDED)
        to_forward(plan, &p, is_full(s), kind);
    else
        to_inspect(plan, &p, s, kind);
    if (kind == PROG_MORE || kind == PROG_COUNT_BASE ||
        kind == PROG_COUNT_MORE)
        p.blend = HL_BLEND_ADD;
    if (kind == PROG_BLENDED)
        p.blend = HL_BLEND_OVER;
    spec(&p, HL_SPEC_MASK, s->masked);
    spec(&p, HL_SPEC_TEXTURES, s->textures);
    spec(&p, HL_SPEC_TWO_SIDED, s->two_sided);
    return hl_prog_create(r->device, out, &p);
}

enum hl_result hl_screen_program(struct hl_renderer *r,
                                 enum hl_shader fragment,
                                 enum hl_format color, enum hl_blend blend,
                                 uint32_t batch, hl_prog *out)
{
    struct hl_prog_desc p;
    memset(&p, 0, sizeof p);
    p.label = "light";
    p.vertex.builtin = fragment == HL_SHADER_LIGHT_FLAT_FRAG
                       ? HL_SHADER_SCREEN_FLAT_VERT : HL_SHADER_SCREEN_VERT;
    p.fragment.builtin = fragment;
    p.n_colors = 1;
    p.color[0] = color;
    p.blend = blend;
    light_specs(&r->plan, &p, batch);
    spec_float(&p, HL_SPEC_LIGHT_SCALE, r->plan.light_scale);
    spec_float(&p, HL_SPEC_LIGHT_WIDTH, (float)r->plan.light_width);
    spec_float(&p, HL_SPEC_LIGHT_HEIGHT, (float)r->plan.light_height);
    return hl_prog_create(r->device, out, &p);
}

/* Quarters of the largest batch for tiles; RECTS has its one size. */
uint32_t hl_light_size(const struct hl_plan *p, uint32_t i)
{
    return p->light_path == HL_LIGHT_PATH_RECTS
           ? p->batch : (p->batch * (i + 1) + 3) / LIGHT_SIZES;
}

hl_prog hl_light_program(struct hl_renderer *r, uint32_t lights, bool add,
                         uint32_t *size)
{
    uint32_t i = 0;
    if (r->plan.light_path != HL_LIGHT_PATH_RECTS)
        while (i < LIGHT_SIZES - 1 && hl_light_size(&r->plan, i) < lights)
            i++;
    *size = hl_light_size(&r->plan, i);
    return r->counting ? r->count_prog : r->light_prog[i][add];
}

static enum hl_result make_light_programs(struct hl_renderer *r)
{
    const struct hl_plan *p = &r->plan;
    enum hl_format f = role_format(p, HL_ROLE_LIGHT);
    if (p->light_path == HL_LIGHT_PATH_LISTS)
        return hl_screen_program(r, HL_SHADER_LIGHT_TILES_FRAG, f,
                                 HL_BLEND_OFF, 0, &r->list_prog);
    bool rects = p->light_path == HL_LIGHT_PATH_RECTS;
    for (uint32_t i = 0; i < (rects ? 1 : LIGHT_SIZES); i++)
        for (int add = rects ? 1 : 0; add < 2; add++) {
            enum hl_result e = hl_screen_program(
                r, p->light_flat ? HL_SHADER_LIGHT_FLAT_FRAG
                                 : HL_SHADER_LIGHT_BATCH_FRAG, f,
                add ? HL_BLEND_ADD : HL_BLEND_OFF, hl_light_size(p, i),
                &r->light_prog[i][add]);
            if (e != HL_OK)
                return e;
        }
    return HL_OK;
}

/* A stage of the embedder's own reads inferred light: forward pipelines have
 * none for it, and would read its block as if it were theirs. */
static enum hl_result refuse_own(struct hl_renderer *r)
{
    hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_ARGUMENT,
              "hl_surface.own_material", ": needs the inferred pipeline",
              NULL);
    return HL_ERR_UNSUPPORTED;
}

static enum hl_result make_surface_programs(struct hl_renderer *r, uint32_t i)
{
    bool inferred = r->plan.pipeline == HL_PIPELINE_INFERRED;
    int first = inferred ? PROG_GBUFFER : PROG_BASE;
    if (r->surfaces[i].own_material && !inferred)
        return refuse_own(r);
    if (r->surfaces[i].blended)
        return hl_surface_program(r, i, PROG_BLENDED,
                                  &r->prog[i][PROG_BLENDED]);
    for (int k = first; k < first + 2; k++) {
        enum hl_result e = hl_surface_program(r, i, k, &r->prog[i][k]);
        if (e != HL_OK)
            return e;
    }
    return HL_OK;
}

/* ---- targets and buffers ------------------------------------------------ */

static enum hl_result make_targets(struct hl_renderer *r, bool readback)
{
    static const char *const labels[HL_ROLE_COUNT] = {
        "", "normal", "dsf", "exponent", "light depth", "light", "color",
        "depth", "resolved", "depth copy" };
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
        blended |= r->surfaces[i].blended;
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
    if (e == HL_OK && r->plan.pipeline == HL_PIPELINE_INFERRED)
        e = make_light_programs(r);
    for (uint32_t i = 0; i < r->n_surfaces && e == HL_OK; i++)
        e = make_surface_programs(r, i);
    return e;
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
    tiles_of(&r->plan, &r->grid.nx, &r->grid.ny);
    r->grid.tile = r->plan.tile ? r->plan.tile : 32;
    r->grid.w = r->plan.light_width;
    r->grid.h = r->plan.light_height;
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
    struct carve c = { memory, 0, false };
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
