/* SPDX-License-Identifier: Zlib */
/* Runs a plan: passes and draws, in the plan's order. */
#include <string.h>
#include "core/renderer.h"
#include "core/vec.h"
#include "hal/backend.h"

/* ---- passes ------------------------------------------------------------- */

void hl_pass_begin(struct hl_renderer *r, const char *label)
{
    memset(&r->pass, 0, sizeof r->pass);
    r->pass.label = label;
    r->pass.half_pixel_offset = r->plan.half_pixel == HL_HALF_PIXEL_STATE;
    r->n_draws = 0;
}

void hl_pass_color(struct hl_renderer *r, hl_tex tex, enum hl_load load,
                   const float clear[4])
{
    struct hl_target *t = &r->pass.color[r->pass.n_colors++];
    t->tex = tex;
    t->load = load;
    if (clear)
        memcpy(t->clear, clear, sizeof t->clear);
}

void hl_pass_depth(struct hl_renderer *r, hl_tex tex, enum hl_load load,
                   bool read_only)
{
    r->pass.depth.tex = tex;
    r->pass.depth.load = load;
    r->pass.depth.clear[0] = r->plan.reversed_depth ? 0.0f : 1.0f;
    r->pass.depth_read_only = read_only;
}

static void run_pass(struct hl_renderer *r)
{
    if (r->result == HL_OK)
        r->result = hl_frame_flush(r);
    if (r->result == HL_OK) {
        r->pass.draws = r->draws;
        r->pass.n_draws = r->n_draws;
        r->result = hl_pass_run(r->device, &r->pass);
        r->stats.draws += r->n_draws;
    }
    /* After a failure too: draws go on being added until the pass ends. */
    r->n_draws = 0;
}

void hl_pass_end(struct hl_renderer *r) { run_pass(r); }

/* More draws than the scratch holds: send what there is, and go on with the
 * same targets kept. The resolve waits for the last part. */
static void split_pass(struct hl_renderer *r)
{
    hl_tex resolve[HL_MAX_COLORS];
    for (uint32_t i = 0; i < r->pass.n_colors; i++) {
        resolve[i] = r->pass.color[i].resolve;
        r->pass.color[i].resolve.id = 0;
    }
    run_pass(r);
    for (uint32_t i = 0; i < r->pass.n_colors; i++) {
        r->pass.color[i].resolve = resolve[i];
        r->pass.color[i].load = HL_LOAD_KEEP;
    }
    r->pass.depth.load = HL_LOAD_KEEP;
}

/* ---- draws -------------------------------------------------------------- */

struct hl_draw *hl_draw_begin(struct hl_renderer *r)
{
    if (r->n_draws == r->max_draws)
        split_pass(r);
    struct hl_draw *d = &r->draws[r->n_draws++];
    memset(d, 0, sizeof *d);
    return d;
}

static void bind_uniform(struct hl_renderer *r, struct hl_draw *d, int slot,
                         uint32_t offset, uint32_t bytes)
{
    d->uniform[slot].buf = r->uniform[r->frame];
    d->uniform[slot].offset = offset;
    d->uniform[slot].bytes = bytes;
}

static void bind_list(struct hl_renderer *r, struct hl_draw *d)
{
    d->storage[HL_SLOT_LIST].buf = r->list[r->frame];
    d->storage[HL_SLOT_LIST].bytes = r->lists.size;
}

struct hl_draw *hl_draw_mesh(struct hl_renderer *r, const struct hl_frame *f,
                             uint32_t visible, int kind)
{
    const struct hl_visible *v = &r->visible[visible];
    const struct hl_item *it = &f->items[v->item];
    struct hl_draw *d = hl_draw_begin(r);
    d->prog = r->prog[it->surface][kind];
    memcpy(d->vertex, it->vertex, sizeof d->vertex);
    d->index = it->index;
    d->index16 = it->index16;
    d->first = it->first;
    d->count = it->count;
    d->base_vertex = it->base_vertex;
    bind_uniform(r, d, HL_SLOT_FRAME, r->frame_offset,
                 sizeof(struct hl_frame_block));
    bind_uniform(r, d, HL_SLOT_OBJECT, v->object,
                 sizeof(struct hl_object_block));
    bind_uniform(r, d, HL_SLOT_MATERIAL, v->material, v->material_bytes);
    if (kind == PROG_BLENDED)
        bind_list(r, d);
    bool lit = kind == PROG_MATERIAL || kind == PROG_REJECT;
    d->textures = r->textures[visible][lit];
    if (lit || r->surfaces[it->surface].textures)
        d->n_textures = HL_TEX_MESH_COUNT;
    return d;
}

void hl_draw_lights(struct hl_renderer *r, struct hl_draw *d, uint32_t offset)
{
    bind_uniform(r, d, HL_SLOT_LIGHTS, offset, HL_LIGHTS_BYTES);
}

/* Lights `refs` (of spheres), padded with black ones to `size`. */
static uint32_t write_batch(struct hl_renderer *r, const struct hl_frame *f,
                            const uint32_t *refs, uint32_t n, uint32_t size)
{
    hl_vec4 data[HL_BATCH_MAX * HL_LIGHT_VEC4S];
    uint32_t at = 0;
    uint32_t stride = r->plan.kinds ? HL_LIGHT_VEC4S : HL_POINT_VEC4S;
    for (uint32_t i = 0; i < n; i++) {
        const struct hl_lit_sphere *s = &r->spheres[refs[i]];
        at += hl_light_write(data + at, &f->lights[s->light], s,
                             f->camera.view, r->plan.kinds);
    }
    memset(data + at, 0, (size * stride - at) * sizeof *data);
    r->stats.light_refs += n;
    return hl_arena_put(&r->arena, data, size * stride * 16);
}

/* As one block; when counting, only the number of lights. HL_LIGHTS_BYTES
 * are reserved, so that the range a draw binds never ends past the buffer. */
static uint32_t put_batch(struct hl_renderer *r, const struct hl_frame *f,
                          const uint32_t *refs, uint32_t n, uint32_t size)
{
    hl_vec4 count = { (float)n / r->count_steps, 0, 0, 0 };
    uint32_t at = r->counting ? hl_arena_put(&r->arena, &count, sizeof count)
                              : write_batch(r, f, refs, n, size);
    if (at + HL_LIGHTS_BYTES > r->arena.size)
        r->arena.full = true;
    return at;
}

/* ---- light pass --------------------------------------------------------- */

static struct hl_draw *draw_screen(struct hl_renderer *r, hl_prog prog,
                                   const struct hl_rect *rect)
{
    struct hl_draw *d = hl_draw_begin(r);
    d->prog = prog;
    d->count = 3;
    d->scissor = *rect;
    d->textures = r->light_textures;
    d->n_textures = 3;
    bind_uniform(r, d, HL_SLOT_FRAME, r->frame_offset,
                 sizeof(struct hl_frame_block));
    return d;
}

static void draw_batch(struct hl_renderer *r, const struct hl_frame *f,
                       const struct hl_rect *rect, const uint32_t *refs,
                       uint32_t n, bool add)
{
    uint32_t size;
    hl_prog prog = hl_light_program(r, n, add, &size);
    struct hl_draw *d = draw_screen(r, prog, rect);
    hl_draw_lights(r, d, put_batch(r, f, refs, n, size));
    r->stats.blends += add;
}

/* Lights of one draw: part `chunk` of tile t's list; 0 when there is none. */
static uint32_t chunk_of(const struct hl_renderer *r, uint32_t t,
                         uint32_t chunk, uint32_t *at)
{
    uint32_t first = r->tile_first[t], n = r->tile_first[t + 1] - first;
    uint32_t done = chunk * r->plan.batch;
    *at = first + done;
    if (done >= n)
        return 0;
    return n - done < r->plan.batch ? n - done : r->plan.batch;
}

/* The tiles whose chunk is drawn by one program: changing programs costs
 * more than a tile's draw. Returns how many draws were made. */
static uint32_t draw_chunks(struct hl_renderer *r, const struct hl_frame *f,
                            uint32_t chunk, uint32_t size)
{
    const struct hl_tile_grid *g = &r->grid;
    uint32_t at, fits, drawn = 0;
    for (uint32_t t = 0; t < g->nx * g->ny; t++) {
        uint32_t n = chunk_of(r, t, chunk, &at);
        if (n == 0)
            continue;
        hl_light_program(r, n, chunk > 0, &fits);
        if (fits != size)
            continue;
        struct hl_rect rect = { (int32_t)(t % g->nx * g->tile),
                                (int32_t)(t / g->nx * g->tile),
                                (int32_t)g->tile, (int32_t)g->tile };
        draw_batch(r, f, &rect, r->refs + at, n, chunk > 0);
        drawn++;
    }
    return drawn;
}

/* The first draw of a tile writes over the cleared target without blending:
 * most tiles have no second one. */
static void draw_tiles(struct hl_renderer *r, const struct hl_frame *f)
{
    uint32_t drawn = 1;
    for (uint32_t chunk = 0; drawn > 0; chunk++) {
        drawn = 0;
        for (uint32_t i = 0; i < LIGHT_SIZES; i++)
            drawn += draw_chunks(r, f, chunk, hl_light_size(&r->plan, i));
    }
}

static void draw_lists(struct hl_renderer *r, const struct hl_frame *f)
{
    const struct hl_tile_grid *g = &r->grid;
    uint32_t tiles = g->nx * g->ny;
    hl_vec4 data[HL_LIGHT_VEC4S];
    for (uint32_t t = 0; t < tiles; t++) {
        r->tile_heads[t * 2] = r->lists.used / 16;
        r->tile_heads[t * 2 + 1] = r->tile_first[t + 1] - r->tile_first[t];
        for (uint32_t i = r->tile_first[t]; i < r->tile_first[t + 1]; i++) {
            const struct hl_lit_sphere *s = &r->spheres[r->refs[i]];
            uint32_t n = hl_light_write(data, &f->lights[s->light], s,
                                        f->camera.view, r->plan.kinds);
            hl_arena_put(&r->lists, data, n * 16);
        }
    }
    r->stats.light_refs += r->tile_first[tiles];
    if (r->result == HL_OK)
        r->result = hl_buf_write(r->device, r->tiles[r->frame], 0,
                                 r->tile_heads, (size_t)tiles * 8);
    struct hl_rect all = { 0, 0, 0, 0 };
    struct hl_draw *d = draw_screen(r, r->counting ? r->count_tiles
                                                   : r->list_prog, &all);
    bind_list(r, d);
    d->storage[HL_SLOT_TILES].buf = r->tiles[r->frame];
    d->storage[HL_SLOT_TILES].bytes = tiles * 8;
}

enum { CELLS = 8 };          /* a side: rectangles are merged by cell        */

static struct hl_rect join(struct hl_rect a, struct hl_rect b)
{
    int32_t x1 = a.x + a.width, y1 = a.y + a.height;
    int32_t u1 = b.x + b.width, v1 = b.y + b.height;
    struct hl_rect c;
    c.x = a.x < b.x ? a.x : b.x;
    c.y = a.y < b.y ? a.y : b.y;
    c.width = (x1 > u1 ? x1 : u1) - c.x;
    c.height = (y1 > v1 ? y1 : v1) - c.y;
    return c;
}

/* Boustrophedon order of cells: neighbours in the order are neighbours on
 * the screen, so a batch's union stays small. */
static uint32_t cell_of(const struct hl_renderer *r, struct hl_rect b)
{
    uint32_t x = (uint32_t)(b.x + b.width / 2) * CELLS / (r->grid.w + 1);
    uint32_t y = (uint32_t)(b.y + b.height / 2) * CELLS / (r->grid.h + 1);
    return y * CELLS + (y & 1 ? CELLS - 1 - x : x);
}

/* K lights a draw, each draw cut to the union of its lights' rectangles. */
static void draw_rects(struct hl_renderer *r, const struct hl_frame *f)
{
    uint32_t batch[HL_BATCH_MAX], n = 0;
    struct hl_rect all = { 0, 0, 0, 0 }, b;
    for (uint32_t c = 0; c < CELLS * CELLS; c++)
        for (uint32_t i = 0; i < r->n_spheres; i++) {
            if (!hl_sphere_rect(&b, &r->spheres[i], &f->camera, r->grid.w,
                                r->grid.h) || cell_of(r, b) != c)
                continue;
            all = n ? join(all, b) : b;
            batch[n++] = i;
            if (n == r->plan.batch) {
                draw_batch(r, f, &all, batch, n, true);
                n = 0;
            }
        }
    if (n)
        draw_batch(r, f, &all, batch, n, true);
}

void hl_emit_light_pass(struct hl_renderer *r, const struct hl_frame *f)
{
    struct hl_texture_binding *t = r->light_textures;
    memset(t, 0, sizeof r->light_textures);
    hl_tex copy = r->target[HL_ROLE_DEPTH_COPY];
    t[HL_TEX_DEPTH].tex = copy.id ? copy : r->target[HL_ROLE_LIGHT_DEPTH];
    t[HL_TEX_NORMAL].tex = r->target[HL_ROLE_NORMAL];
    t[HL_TEX_EXPONENT].tex = r->target[HL_ROLE_EXPONENT];
    if (r->plan.light_path == HL_LIGHT_PATH_TILES)
        draw_tiles(r, f);
    else if (r->plan.light_path == HL_LIGHT_PATH_LISTS)
        draw_lists(r, f);
    else
        draw_rects(r, f);
}

/* Tile lists, bounded by the depth that the geometry pass left where the
 * plan says so: the one place where a frame waits for the device. */
enum hl_result hl_build_tiles(struct hl_renderer *r, const struct hl_frame *f)
{
    struct hl_tile_grid *g = &r->grid;
    g->z0 = g->z1 = NULL;
    if (r->plan.tile_depth && r->n_spheres > 0) {
        float x, y, n = f->camera.near, z = f->camera.far;
        enum hl_result e = hl_tex_read(r->device,
                                       r->target[HL_ROLE_LIGHT_DEPTH],
                                       r->depth_read,
                                       (size_t)g->w * g->h * sizeof(float));
        if (e != HL_OK)
            return e;
        x = r->plan.reversed_depth ? n * z / (z - n) : -n * z / (z - n);
        y = r->plan.reversed_depth ? n / (z - n) : -z / (z - n);
        hl_tiles_depth(r->tile_z0, r->tile_z1, r->depth_read, g->w, g->h,
                       g->tile, x, y, r->plan.reversed_depth ? 0.0f : 1.0f);
        g->z0 = r->tile_z0;
        g->z1 = r->tile_z1;
    }
    uint32_t n = hl_tiles_fill(g, r->spheres, r->n_spheres, r->tile_first,
                               r->refs, r->max_refs);
    if (n > r->max_refs) {
        hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_LIMIT,
                  "hl_renderer_desc.max_lights",
                  ": tile lists need more entries", NULL);
        return HL_ERR_LIMIT;
    }
    r->stats.light_peak = hl_tiles_peak(g, r->tile_first, r->refs, r->spheres,
                                        f->lights);
    return HL_OK;
}

/* ---- forward ------------------------------------------------------------ */

struct batcher {
    const struct hl_frame *frame;
    uint32_t visible, refs[HL_BATCH_MAX], n, done;
    struct hl_rect rect;
};

static void send(struct hl_renderer *r, struct batcher *b, bool base)
{
    int kind = base ? PROG_BASE : PROG_MORE;
    if (r->counting)
        kind = base ? PROG_COUNT_BASE : PROG_COUNT_MORE;
    struct hl_draw *d = hl_draw_mesh(r, b->frame, b->visible, kind);
    uint32_t size = r->plan.batch ? r->plan.batch : 1;
    hl_draw_lights(r, d, put_batch(r, b->frame, b->refs, b->n, size));
    if (!base && r->plan.scissor)
        d->scissor = b->rect;
    r->stats.blends += !base;
    b->n = 0;
    b->done++;
}

/* Base draws of all objects first, then further lights where the depth is
 * equal: `base` says which of the two this call makes. FWD-2's base draw has
 * the first eight lights, FWD-1's has none. */
static void object_draws(struct hl_renderer *r, const struct hl_frame *f,
                         uint32_t visible, bool base)
{
    bool multipass = r->plan.pipeline == HL_PIPELINE_FORWARD_MULTIPASS;
    struct batcher b;
    memset(&b, 0, sizeof b);
    b.frame = f;
    b.visible = visible;
    if (multipass && base) {
        send(r, &b, true);
        return;
    }
    for (uint32_t i = 0; i < r->n_spheres; i++) {
        struct hl_lit_sphere *s = &r->spheres[i];
        if (!hl_sphere_touches_box(s, &r->visible[visible].box))
            continue;
        if (r->plan.scissor && !hl_sphere_rect(&b.rect, s, &f->camera,
                                               r->plan.width, r->plan.height))
            continue;
        b.refs[b.n++] = i;
        if (b.n < r->plan.batch)
            continue;
        bool first = !multipass && b.done == 0;
        if (first == base)
            send(r, &b, base);
        else
            b.n = 0, b.done++;
        if (base)
            return;
    }
    bool first = !multipass && b.done == 0;
    if (first ? base : b.n > 0 && !base)
        send(r, &b, base);
}

void hl_emit_forward(struct hl_renderer *r, const struct hl_frame *f)
{
    for (uint32_t i = 0; i < r->n_opaque; i++)
        object_draws(r, f, i, true);
    for (uint32_t i = 0; i < r->n_opaque; i++)
        object_draws(r, f, i, false);
}

/* ---- the frame ---------------------------------------------------------- */

static void clear_packed(struct hl_renderer *r, enum hl_role role, float x,
                         float y)
{
    hl_vec4 v = hl_two16_encode(r->plan.two16, x, y);
    const float clear[4] = { v.x, v.y, v.z, v.w };
    hl_pass_color(r, r->target[role], HL_LOAD_CLEAR, clear);
}

static void geometry_pass(struct hl_renderer *r, const struct hl_frame *f)
{
    const float zero[4] = { 0, 0, 0, 0 };
    hl_pass_begin(r, "geometry");
    /* Background: the code of normal (0,0,1), depth far, id 0. */
    clear_packed(r, HL_ROLE_NORMAL, 0.5f, 0.5f);
    clear_packed(r, HL_ROLE_DSF, 1, 0);
    if (r->target[HL_ROLE_EXPONENT].id)
        hl_pass_color(r, r->target[HL_ROLE_EXPONENT], HL_LOAD_CLEAR, zero);
    hl_pass_depth(r, r->target[HL_ROLE_LIGHT_DEPTH], HL_LOAD_CLEAR, false);
    for (uint32_t i = 0; i < r->n_opaque; i++)
        hl_draw_mesh(r, f, i, PROG_GBUFFER);
    hl_pass_end(r);
}

/* For machines that cannot read a depth target which is bound. */
static void depth_copy_pass(struct hl_renderer *r)
{
    const struct hl_rect all = { 0, 0, 0, 0 };
    if (!r->target[HL_ROLE_DEPTH_COPY].id)
        return;
    memset(r->light_textures, 0, sizeof r->light_textures);
    r->light_textures[HL_TEX_DEPTH].tex = r->target[HL_ROLE_LIGHT_DEPTH];
    hl_pass_begin(r, "depth copy");
    hl_pass_color(r, r->target[HL_ROLE_DEPTH_COPY], HL_LOAD_DISCARD, NULL);
    draw_screen(r, r->depth_copy, &all);
    hl_pass_end(r);
}

static void light_pass(struct hl_renderer *r, const struct hl_frame *f)
{
    const float black[4] = { 0, 0, 0, 0 };
    const struct hl_plan_pass *plan = hl_plan_pass(&r->plan, HL_PASS_LIGHT);
    if (r->result == HL_OK && r->plan.light_path != HL_LIGHT_PATH_RECTS)
        r->result = hl_build_tiles(r, f);
    if (r->result != HL_OK)
        return;
    hl_pass_begin(r, "light");
    hl_pass_color(r, r->target[HL_ROLE_LIGHT], HL_LOAD_CLEAR, black);
    if (plan && plan->depth != HL_ROLE_NONE)
        hl_pass_depth(r, r->target[plan->depth], HL_LOAD_KEEP, true);
    hl_emit_light_pass(r, f);
    hl_pass_end(r);
}

static void begin_color(struct hl_renderer *r, const struct hl_frame *f,
                        const char *label, bool first, bool last)
{
    const float back[4] = { f->background[0], f->background[1],
                            f->background[2], 1.0f };
    enum hl_load load = first ? HL_LOAD_CLEAR : HL_LOAD_KEEP;
    hl_pass_begin(r, label);
    hl_pass_color(r, r->target[HL_ROLE_COLOR], load, back);
    hl_pass_depth(r, r->target[HL_ROLE_DEPTH], load, !first);
    if (last)
        r->pass.color[0].resolve = r->target[HL_ROLE_RESOLVED];
}

static void shading_passes(struct hl_renderer *r, const struct hl_frame *f)
{
    bool blended = r->n_visible > r->n_opaque;
    bool inferred = r->plan.pipeline == HL_PIPELINE_INFERRED;
    begin_color(r, f, inferred ? "material" : "forward", true, !blended);
    if (inferred)
        for (uint32_t i = 0; i < r->n_opaque; i++)
            hl_draw_mesh(r, f, i, PROG_MATERIAL);
    else
        hl_emit_forward(r, f);
    hl_pass_end(r);
    if (!blended)
        return;
    begin_color(r, f, "blended", false, true);
    for (uint32_t i = r->n_opaque; i < r->n_visible; i++) {
        hl_draw_mesh(r, f, i, PROG_BLENDED);
        r->stats.blends++;
    }
    hl_pass_end(r);
}

static void note_peak(struct hl_renderer *r)
{
    const struct hl_plan_target *t = hl_plan_target(&r->plan, HL_ROLE_LIGHT);
    if (!t)
        return;
    const struct hl_format_info *f = hl_format_info(t->format);
    bool real = f->kind == HL_KIND_FLOAT;
    float most = r->plan.light_scale * (real ? HL_HALF_MAX : 1.0f);
    r->stats.light_may_clip = !(real && f->bits[0] == 32) &&
                              r->stats.light_peak > most;
}

enum hl_result hl_frame_draw(struct hl_renderer *r, const struct hl_frame *f,
                             struct hl_frame_stats *stats)
{
    if (!r || !f)
        return HL_ERR_INVALID;
    enum hl_result e = hl_frame_gather(r, f);
    if (e != HL_OK)
        return e;
    if (r->plan.pipeline == HL_PIPELINE_INFERRED) {
        geometry_pass(r, f);
        depth_copy_pass(r);
        light_pass(r, f);
    }
    shading_passes(r, f);
    note_peak(r);
    if (stats)
        *stats = r->stats;
    return r->result;
}

hl_tex hl_renderer_output(const struct hl_renderer *r)
{
    hl_tex t = r->target[HL_ROLE_RESOLVED];
    return t.id ? t : r->target[HL_ROLE_COLOR];
}

hl_tex hl_renderer_target(const struct hl_renderer *r, enum hl_role role)
{
    hl_tex none = { 0 };
    return (unsigned)role < HL_ROLE_COUNT ? r->target[role] : none;
}
