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

void hl_bind_uniform(struct hl_renderer *r, struct hl_draw *d, int slot,
                     uint32_t offset, uint32_t bytes)
{
    d->uniform[slot].buf = r->uniform[r->frame];
    d->uniform[slot].offset = offset;
    d->uniform[slot].bytes = bytes;
}

void hl_bind_list(struct hl_renderer *r, struct hl_draw *d)
{
    d->storage[HL_SLOT_LIST].buf = r->list[r->frame];
    d->storage[HL_SLOT_LIST].bytes = r->lists.size;
}

static bool is_gbuffer(int kind)
{
    return kind == PROG_GBUFFER || kind == PROG_STIPPLE_GBUFFER ||
           kind == PROG_DECAL_GBUFFER;
}

struct hl_draw *hl_draw_item(struct hl_renderer *r, const struct hl_item *it,
                             int kind)
{
    struct hl_draw *d = hl_draw_begin(r);
    d->prog = r->prog[it->surface][kind];
    memcpy(d->vertex, it->vertex, sizeof d->vertex);
    d->index = it->index;
    d->index16 = it->index16;
    d->first = it->first;
    d->count = it->count;
    d->base_vertex = it->base_vertex;
    return d;
}

struct hl_draw *hl_draw_mesh(struct hl_renderer *r, const struct hl_frame *f,
                             uint32_t visible, int kind)
{
    const struct hl_visible *v = &r->visible[visible];
    const struct hl_item *it = &f->items[v->item];
    struct hl_draw *d = hl_draw_item(r, it, kind);
    d->scissor = is_gbuffer(kind) || kind == PROG_STIPPLE_ID
                 ? r->light_scissor : r->frame_scissor;
    hl_bind_uniform(r, d, HL_SLOT_FRAME, r->frame_offset,
                    sizeof(struct hl_frame_block));
    hl_bind_uniform(r, d, HL_SLOT_OBJECT, v->object,
                    sizeof(struct hl_object_block));
    hl_bind_uniform(r, d, HL_SLOT_MATERIAL, v->material, v->material_bytes);
    if (kind == PROG_BLENDED)
        hl_bind_list(r, d);
    if (r->plan.motion && is_gbuffer(kind))
        hl_bind_uniform(r, d, HL_SLOT_MOTION, v->motion,
                        sizeof(struct hl_motion_block));
    bool lit = kind == PROG_MATERIAL || kind == PROG_REJECT ||
               kind == PROG_STIPPLE_MATERIAL || kind == PROG_DECAL_MATERIAL;
    d->textures = r->textures[visible][lit];
    if (lit || r->surfaces[it->surface].textures)
        d->n_textures = HL_TEX_MESH_COUNT;
    return d;
}

void hl_draw_lights(struct hl_renderer *r, struct hl_draw *d, uint32_t offset)
{
    hl_bind_uniform(r, d, HL_SLOT_LIGHTS, offset, HL_LIGHTS_BYTES);
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
    if (r->plan.brdfs)
        clear_packed(r, HL_ROLE_EXPONENT, 0, 0);
    else if (r->target[HL_ROLE_EXPONENT].id)
        hl_pass_color(r, r->target[HL_ROLE_EXPONENT], HL_LOAD_CLEAR, zero);
    if (r->target[HL_ROLE_MOTION].id)
        clear_packed(r, HL_ROLE_MOTION, 0.5f, 0.5f);
    hl_pass_depth(r, r->target[HL_ROLE_LIGHT_DEPTH], HL_LOAD_CLEAR, false);
    for (uint32_t i = 0; i < r->n_opaque; i++)
        hl_draw_mesh(r, f, i, PROG_GBUFFER);
    for (uint32_t i = r->n_opaque; i < r->n_decals; i++)
        hl_draw_mesh(r, f, i, PROG_DECAL_GBUFFER);
    for (uint32_t i = r->n_decals; i < r->n_visible; i++)
        if (r->visible[i].pattern != HL_STIPPLE_NONE)
            hl_draw_mesh(r, f, i, PROG_STIPPLE_GBUFFER);
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
    hl_draw_screen(r, r->depth_copy, &all);
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
        hl_pass_depth(r, r->target[plan->depth], HL_LOAD_KEEP,
                      plan->depth_read_only);
    hl_emit_light_pass(r, f);
    hl_pass_end(r);
    if (r->n_spheres == r->n_plain)
        return;
    if (r->plan.shadows == HL_SHADOWS_MAPS)
        hl_maps_shadowed(r, f);
    else
        hl_volumes_shadowed(r, f);
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
        uint8_t pattern = r->visible[i].pattern;
        hl_draw_mesh(r, f, i, pattern == HL_STIPPLE_NONE ? PROG_BLENDED
                              : pattern ? PROG_STIPPLE_MATERIAL
                                        : PROG_DECAL_MATERIAL);
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
    if (hl_plan_pass(&r->plan, HL_PASS_GEOMETRY)) {
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
