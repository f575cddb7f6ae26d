/* SPDX-License-Identifier: Zlib */
/* The light pass: lights of a draw, by tile, by list, by rectangle. */
#include <string.h>
#include "core/renderer.h"
#include "core/vec.h"
#include "hal/backend.h"

/* ---- lights of a draw --------------------------------------------------- */

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
uint32_t hl_put_batch(struct hl_renderer *r, const struct hl_frame *f,
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

struct hl_draw *hl_draw_screen(struct hl_renderer *r, hl_prog prog,
                                   const struct hl_rect *rect)
{
    struct hl_draw *d = hl_draw_begin(r);
    d->prog = prog;
    d->count = 3;
    d->scissor = rect->width ? *rect : r->light_scissor;
    d->textures = r->light_textures;
    d->n_textures = 3;
    hl_bind_uniform(r, d, HL_SLOT_FRAME, r->frame_offset,
                 sizeof(struct hl_frame_block));
    return d;
}

static void draw_batch(struct hl_renderer *r, const struct hl_frame *f,
                       const struct hl_rect *rect, const uint32_t *refs,
                       uint32_t n, bool add)
{
    uint32_t size;
    hl_prog prog = hl_light_program(r, n, add, &size);
    struct hl_draw *d = hl_draw_screen(r, prog, rect);
    hl_draw_lights(r, d, hl_put_batch(r, f, refs, n, size));
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

static int32_t least(uint32_t a, uint32_t b)
{
    return (int32_t)(a < b ? a : b);
}

static struct hl_rect tile_rect(const struct hl_tile_grid *g, uint32_t t)
{
    uint32_t x = t % g->nx * g->tile, y = t / g->nx * g->tile;
    struct hl_rect rect = { (int32_t)x, (int32_t)y,
                            least(g->tile, g->span.cols - x),
                            least(g->tile, g->span.rows - y) };
    return rect;
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
        struct hl_rect rect = tile_rect(g, t);
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
    struct hl_draw *d = hl_draw_screen(r, r->counting ? r->count_tiles
                                                   : r->list_prog, &all);
    hl_bind_list(r, d);
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
    uint32_t x = (uint32_t)(b.x + b.width / 2) * CELLS / (r->span.cols + 1);
    uint32_t y = (uint32_t)(b.y + b.height / 2) * CELLS / (r->span.rows + 1);
    return y * CELLS + (y & 1 ? CELLS - 1 - x : x);
}

/* K lights a draw, each draw cut to the union of its lights' rectangles. */
static void draw_rects(struct hl_renderer *r, const struct hl_frame *f)
{
    uint32_t batch[HL_BATCH_MAX], n = 0;
    struct hl_rect all = { 0, 0, 0, 0 }, b;
    for (uint32_t c = 0; c < CELLS * CELLS; c++)
        for (uint32_t i = 0; i < r->n_plain; i++) {
            if (!hl_sphere_rect(&b, &r->spheres[i], &r->span) ||
                cell_of(r, b) != c)
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

void hl_light_pass_textures(struct hl_renderer *r)
{
    struct hl_texture_binding *t = r->light_textures;
    memset(t, 0, sizeof r->light_textures);
    hl_tex copy = r->target[HL_ROLE_DEPTH_COPY];
    t[HL_TEX_DEPTH].tex = copy.id ? copy : r->target[HL_ROLE_LIGHT_DEPTH];
    t[HL_TEX_NORMAL].tex = r->target[HL_ROLE_NORMAL];
    t[HL_TEX_EXPONENT].tex = r->target[HL_ROLE_EXPONENT];
}

/* Without tile lists: by the bounds that needs are measured by, so that the
 * same lights give no more than needs.peak. */
static void note_peak(struct hl_renderer *r, const struct hl_frame *f)
{
    struct hl_peak_grid g;
    uint32_t w = f->width ? f->width : r->plan.width;
    uint32_t h = f->height ? f->height : r->plan.height;
    hl_peak_begin(&g, &f->camera, (float)w / (float)h);
    for (uint32_t i = 0; i < r->n_spheres; i++)
        hl_peak_add(&g, &r->spheres[i], &f->lights[r->spheres[i].light]);
    r->stats.light_peak = hl_peak_of(&g);
}

void hl_emit_light_pass(struct hl_renderer *r, const struct hl_frame *f)
{
    hl_light_pass_textures(r);
    if (r->plan.light_path == HL_LIGHT_PATH_RECTS ||
        r->plan.light_path == HL_LIGHT_PATH_VOLUMES)
        note_peak(r, f);
    if (r->plan.light_path == HL_LIGHT_PATH_TILES)
        draw_tiles(r, f);
    else if (r->plan.light_path == HL_LIGHT_PATH_LISTS)
        draw_lists(r, f);
    else if (r->plan.light_path == HL_LIGHT_PATH_VOLUMES && !r->counting)
        hl_volumes_lights(r, f);
    else
        draw_rects(r, f);
}

/* Tile lists, bounded by the depth that the geometry pass left where the
 * plan says so: the one place where a frame waits for the device. */
enum hl_result hl_build_tiles(struct hl_renderer *r, const struct hl_frame *f)
{
    struct hl_tile_grid *g = &r->grid;
    if (r->plan.light_path == HL_LIGHT_PATH_VOLUMES)
        return HL_OK;
    g->z0 = g->z1 = NULL;
    if (r->plan.tile_depth && r->n_plain > 0) {
        float x, y;
        enum hl_result e = hl_tex_read(r->device,
                                       r->target[HL_ROLE_LIGHT_DEPTH],
                                       r->depth_read,
                                       (size_t)r->plan.light_width *
                                       r->plan.light_height * sizeof(float));
        if (e != HL_OK)
            return e;
        hl_depth_terms(r, &f->camera, &x, &y);
        hl_tiles_depth(r->tile_z0, r->tile_z1, g, r->depth_read,
                       r->plan.light_width, x, y,
                       r->plan.reversed_depth ? 0.0f : 1.0f);
        g->z0 = r->tile_z0;
        g->z1 = r->tile_z1;
    }
    uint32_t n = hl_tiles_fill(g, r->spheres, r->n_plain, r->tile_first,
                               r->refs, r->max_refs);
    if (n > r->max_refs) {
        hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_LIMIT,
                  "hl_renderer_desc.max_lights",
                  ": tile lists need more entries", NULL);
        return HL_ERR_LIMIT;
    }
    r->stats.light_peak = hl_tiles_peak(g, r->tile_first, r->refs, r->spheres,
                                        f->lights);
    for (uint32_t i = r->n_plain; i < r->n_spheres; i++)
        r->stats.light_peak += hl_light_peak(&f->lights[r->spheres[i].light]);
    return HL_OK;
}
