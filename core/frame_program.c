/* SPDX-License-Identifier: Zlib */
/* A renderer's programs: a plan's choices become stages, constants and
 * state. */
#include <string.h>
#include "core/renderer.h"
#include "hal/backend.h"

/* ---- constants ---------------------------------------------------------- */

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

/* How stages write and read pairs of numbers. */
static void packed_specs(const struct hl_plan *plan, struct hl_prog_desc *p)
{
    spec(p, HL_SPEC_TWO16, plan->two16);
    spec_float(p, HL_SPEC_ID_STEPS, plan->id_steps);
}

/* Half a pixel of a target, where the vertex stages shift by it. */
static void shift_specs(const struct hl_plan *plan, struct hl_prog_desc *p,
                        uint32_t width, uint32_t height)
{
    if (plan->half_pixel != HL_HALF_PIXEL_VERTEX)
        return;
    spec_float(p, HL_SPEC_SHIFT_X, -1.0f / (float)width);
    spec_float(p, HL_SPEC_SHIFT_Y, -1.0f / (float)height);
}

void hl_shift_specs(const struct hl_plan *plan, struct hl_prog_desc *p)
{
    shift_specs(plan, p, plan->light_width, plan->light_height);
}

/* HL_SPEC_FILL. */
static uint32_t fill_of(const struct hl_plan *plan)
{
    uint32_t through = plan->stipple ? HL_FILL_THROUGH : 0;
    return plan->fill == HL_FILL_NEAREST ? 1 | through
           : plan->fill == HL_FILL_DEPTH ? 2 | through : 0;
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
    spec(p, HL_SPEC_FILL, fill_of(plan));
    spec(p, HL_SPEC_BILINEAR, plan->dsf_bilinear);
    packed_specs(plan, p);
}

static void light_specs(const struct hl_plan *plan, struct hl_prog_desc *p,
                        uint32_t batch)
{
    spec(p, HL_SPEC_SPECULAR, plan->specular);
    spec(p, HL_SPEC_FALLOFF, plan->falloff);
    spec(p, HL_SPEC_KINDS, plan->kinds);
    spec(p, HL_SPEC_BATCH, batch);
    if (plan->brdfs)
        spec(p, HL_SPEC_BRDFS, 1);
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

const struct hl_plan_pass *hl_plan_pass(const struct hl_plan *plan,
                                        enum hl_pass_role role)
{
    for (uint32_t i = 0; i < plan->n_passes; i++)
        if (plan->pass[i].role == role)
            return &plan->pass[i];
    return NULL;
}

static enum hl_format role_format(const struct hl_plan *plan, enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(plan, role);
    return t ? t->format : HL_FORMAT_NONE;
}

/* ---- meshes ------------------------------------------------------------- */

/* Stages by what they write: [motion][exponent][full]. */
static enum hl_shader gbuffer_stage(bool motion, bool exponent, bool full)
{
    static const enum hl_shader stages[2][2][2] = {
        { { HL_SHADER_GBUFFER_PLAIN_FRAG, HL_SHADER_GBUFFER_FULL_FRAG },
          { HL_SHADER_GBUFFER_PLAIN_EXP_FRAG,
            HL_SHADER_GBUFFER_FULL_EXP_FRAG } },
        { { HL_SHADER_GBUFFER_PLAIN_MOTION_FRAG,
            HL_SHADER_GBUFFER_FULL_MOTION_FRAG },
          { HL_SHADER_GBUFFER_PLAIN_EXP_MOTION_FRAG,
            HL_SHADER_GBUFFER_FULL_EXP_MOTION_FRAG } } };
    return stages[motion][exponent][full];
}

static void to_gbuffer(const struct hl_plan *plan, struct hl_prog_desc *p,
                       bool full)
{
    bool exponent = hl_plan_target(plan, HL_ROLE_EXPONENT) != NULL;
    p->label = "geometry";
    p->vertex.builtin = full ? HL_SHADER_MESH_GBUFFER_FULL_VERT
                             : HL_SHADER_MESH_GBUFFER_VERT;
    if (plan->motion)
        p->vertex.builtin = full ? HL_SHADER_MESH_GBUFFER_FULL_MOTION_VERT
                                 : HL_SHADER_MESH_GBUFFER_MOTION_VERT;
    p->fragment.builtin = gbuffer_stage(plan->motion, exponent, full);
    p->color[p->n_colors++] = role_format(plan, HL_ROLE_NORMAL);
    p->color[p->n_colors++] = role_format(plan, HL_ROLE_DSF);
    if (exponent)
        p->color[p->n_colors++] = role_format(plan, HL_ROLE_EXPONENT);
    if (plan->motion)
        p->color[p->n_colors++] = role_format(plan, HL_ROLE_MOTION);
    if (plan->brdfs)
        spec(p, HL_SPEC_BRDFS, 1);
    p->depth = role_format(plan, HL_ROLE_LIGHT_DEPTH);
    packed_specs(plan, p);
    shift_specs(plan, p, plan->light_width, plan->light_height);
}

static void to_frame(const struct hl_plan *plan, struct hl_prog_desc *p)
{
    p->n_colors = 1;
    p->color[0] = role_format(plan, HL_ROLE_COLOR);
    p->depth = role_format(plan, HL_ROLE_DEPTH);
    p->samples = plan->samples;
    shift_specs(plan, p, plan->width, plan->height);
}

static enum hl_shader material_stage(const struct hl_plan *plan, bool full)
{
    static const enum hl_shader stage[2][3][2] = {
        { { HL_SHADER_MATERIAL_PLAIN_FRAG, HL_SHADER_MATERIAL_FULL_FRAG },
          { HL_SHADER_MATERIAL_PLAIN_FILTER_FRAG,
            HL_SHADER_MATERIAL_FULL_FILTER_FRAG },
          { HL_SHADER_MATERIAL_PLAIN_TAPS_FRAG,
            HL_SHADER_MATERIAL_FULL_TAPS_FRAG } },
        { { HL_SHADER_MATERIAL_PLAIN_CENTROID_FRAG,
            HL_SHADER_MATERIAL_FULL_CENTROID_FRAG },
          { HL_SHADER_MATERIAL_PLAIN_FILTER_CENTROID_FRAG,
            HL_SHADER_MATERIAL_FULL_FILTER_CENTROID_FRAG },
          { HL_SHADER_MATERIAL_PLAIN_TAPS_CENTROID_FRAG,
            HL_SHADER_MATERIAL_FULL_TAPS_CENTROID_FRAG } } };
    int numbers = plan->float_taps ? 2 : plan->dsf_bilinear ? 1 : 0;
    return stage[plan->centroid][numbers][full];
}

static enum hl_shader material_vertex(const struct hl_plan *plan, bool full)
{
    if (plan->centroid)
        return full ? HL_SHADER_MESH_UV_ID_CENTROID_VERT
                    : HL_SHADER_MESH_MATERIAL_CENTROID_VERT;
    return full ? HL_SHADER_MESH_UV_ID_VERT : HL_SHADER_MESH_MATERIAL_VERT;
}

static enum hl_shader reject_stage(const struct hl_plan *plan, bool full)
{
    if (plan->float_taps)
        return full ? HL_SHADER_REJECT_FULL_TAPS_FRAG
                    : HL_SHADER_REJECT_PLAIN_TAPS_FRAG;
    return full ? HL_SHADER_REJECT_FULL_FRAG : HL_SHADER_REJECT_PLAIN_FRAG;
}

static void to_material(const struct hl_plan *plan, struct hl_prog_desc *p,
                        const struct hl_surface *s, bool full)
{
    to_frame(plan, p);
    p->label = "material";
    p->vertex.builtin = material_vertex(plan, full);
    p->fragment.builtin = material_stage(plan, full);
    if (s->own_material) {
        p->vertex.builtin = HL_SHADER_MESH_OWN_VERT;
        p->fragment.builtin = HL_SHADER_NONE;
        p->fragment.code = s->own_material;
    }
    inferred_specs(plan, p);
}

/* Over what is there: translucent surfaces and decals. */
static void to_blended_material(const struct hl_plan *plan,
                                struct hl_prog_desc *p,
                                const struct hl_surface *s, int kind)
{
    struct hl_surface lit = *s;
    lit.own_material = NULL;
    to_material(plan, p, &lit, is_full(s));
    p->blend = HL_BLEND_OVER;
    if (kind != PROG_STIPPLE_MATERIAL)
        return;
    spec(p, HL_SPEC_STIPPLE, plan->stipple);
    spec(p, HL_SPEC_STIPPLE_CONE, plan->stipple_cone);
    /* Samples lie two or four texels apart: the next one is worth looking
     * for at any price, and these surfaces are few. */
    for (uint32_t i = 0; i < p->n_specs; i++)
        if (p->spec[i].id == HL_SPEC_FILL && plan->fill == HL_FILL_DEPTH)
            p->spec[i].value = 1 | HL_FILL_THROUGH;
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
                       const struct hl_surface *s, int kind,
                       enum hl_format count_format)
{
    bool full = is_full(s);
    p->label = "inspect";
    p->vertex.builtin = full ? HL_SHADER_MESH_UV_ID_VERT
                             : HL_SHADER_MESH_ID_VERT;
    p->n_colors = 1;
    p->depth = role_format(plan, HL_ROLE_DEPTH);
    p->color[0] = count_format;
    p->fragment.builtin = HL_SHADER_COUNT_FRAG;
    if (kind == PROG_STIPPLE_ID)
        shift_specs(plan, p, plan->light_width, plan->light_height);
    else
        shift_specs(plan, p, plan->width, plan->height);
    if (kind == PROG_STIPPLE_ID) {
        p->fragment.builtin = full ? HL_SHADER_STIPPLE_FULL_FRAG
                                   : HL_SHADER_STIPPLE_PLAIN_FRAG;
        p->color[0] = HL_FORMAT_R8_UNORM;
        p->depth = role_format(plan, HL_ROLE_LIGHT_DEPTH);
    } else if (kind == PROG_ID) {
        p->fragment.builtin = full ? HL_SHADER_ID_FULL_FRAG
                                   : HL_SHADER_ID_PLAIN_FRAG;
        p->color[0] = HL_FORMAT_R32_UINT;
    } else if (kind == PROG_REJECT) {
        p->fragment.builtin = reject_stage(plan, full);
        p->color[0] = HL_FORMAT_R8_UNORM;
        inferred_specs(plan, p);
    }
}

static void to_shadow_map(const struct hl_plan *plan, struct hl_prog_desc *p,
                          bool masked)
{
    const struct hl_plan_target *t = hl_plan_target(plan, HL_ROLE_SHADOW_MAP);
    p->label = "shadow map";
    p->vertex.builtin = masked ? HL_SHADER_MESH_UV_ID_VERT
                               : HL_SHADER_MESH_DEPTH_VERT;
    if (masked)
        p->fragment.builtin = HL_SHADER_MASK_FRAG;
    p->depth = t->format;
    shift_specs(plan, p, t->width, t->height);
}

static bool writes_depth(int kind)
{
    return kind != PROG_MORE && kind != PROG_BLENDED &&
           kind != PROG_COUNT_MORE && kind != PROG_STIPPLE_MATERIAL &&
           kind != PROG_DECAL_GBUFFER && kind != PROG_DECAL_MATERIAL;
}

/* HL_SPEC_MASK. Blended surfaces are not tested where they are blended; in
 * passes at L-buffer size they are, so that no light is made for what cannot
 * be seen (K 6). Masked ones by no more than that: at the cutoff, thin wires
 * would leave pixels that are blended but have no light of their own, and mip
 * levels whose alpha is all below it none at all (40.9 dB against 35.6 in the
 * built-in fence). The cutoff is a shadow map's. */
static uint32_t mask_of(const struct hl_renderer *r, uint32_t surface,
                        int kind)
{
    const struct hl_surface *s = &r->surfaces[surface];
    bool small = kind == PROG_STIPPLE_GBUFFER || kind == PROG_STIPPLE_ID ||
                 kind == PROG_SHADOW_DEPTH;
    if (hl_surface_class(r, surface) == HL_CLASS_OPAQUE)
        return s->masked;
    return !small ? 0 : s->masked && kind == PROG_SHADOW_DEPTH ? 1 : 2;
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
    p.depth_write = writes_depth(kind);
    if (kind == PROG_MORE || kind == PROG_COUNT_MORE)
        p.depth_test = HL_COMPARE_EQUAL;
    if (kind == PROG_GBUFFER || kind == PROG_STIPPLE_GBUFFER ||
        kind == PROG_DECAL_GBUFFER)
        to_gbuffer(plan, &p, is_full(s));
    else if (kind == PROG_STIPPLE_MATERIAL || kind == PROG_DECAL_MATERIAL)
        to_blended_material(plan, &p, s, kind);
    else if (kind == PROG_MATERIAL)
        to_material(plan, &p, s, is_full(s));
    else if (kind == PROG_BASE || kind == PROG_MORE || kind == PROG_BLENDED)
        to_forward(plan, &p, is_full(s), kind);
    else if (kind == PROG_SHADOW_DEPTH)
        to_shadow_map(plan, &p, s->masked);
    else
        to_inspect(plan, &p, s, kind, r->count_format);
    if (kind == PROG_MORE || kind == PROG_COUNT_BASE ||
        kind == PROG_COUNT_MORE)
        p.blend = HL_BLEND_ADD;
    if (kind == PROG_BLENDED)
        p.blend = HL_BLEND_OVER;
    /* HL_INSPECT_STIPPLE draws opaque surfaces too, on all texels. */
    if (kind == PROG_STIPPLE_GBUFFER ||
        (kind == PROG_STIPPLE_ID &&
         hl_surface_class(r, surface) == HL_CLASS_BLENDED))
        spec(&p, HL_SPEC_STIPPLE, plan->stipple);
    if (kind == PROG_DECAL_GBUFFER) {
        spec(&p, HL_SPEC_DECAL, 1);
        p.blend = HL_BLEND_OVER;
    }
    spec(&p, HL_SPEC_MASK, mask_of(r, surface, kind));
    spec(&p, HL_SPEC_TEXTURES, s->textures);
    spec(&p, HL_SPEC_TWO_SIDED, s->two_sided);
    return hl_prog_create(r->device, out, &p);
}

/* ---- the screen --------------------------------------------------------- */

/* Depth of a plan's pass that is bound to be tested, not written. */
static void bind_depth(const struct hl_plan *plan, struct hl_prog_desc *p,
                       enum hl_pass_role role)
{
    const struct hl_plan_pass *pass = hl_plan_pass(plan, role);
    if (!pass || pass->depth == HL_ROLE_NONE)
        return;
    p->depth = role_format(plan, pass->depth);
    p->depth_test = pass->depth_test;
}

static bool is_light_stage(enum hl_shader stage)
{
    return stage == HL_SHADER_LIGHT_BATCH_FRAG ||
           stage == HL_SHADER_LIGHT_FLAT_FRAG ||
           stage == HL_SHADER_LIGHT_TILES_FRAG;
}

/* A copy of depth is a number, however the target itself is read. */
static uint32_t depth_read(const struct hl_plan *plan, enum hl_shader fragment)
{
    bool copied = fragment != HL_SHADER_DEPTH_COPY_FRAG &&
                  hl_plan_target(plan, HL_ROLE_DEPTH_COPY);
    return copied ? HL_DEPTH_READ_FLOAT : plan->depth_read;
}

static void to_screen(const struct hl_plan *plan, struct hl_prog_desc *p,
                      enum hl_shader fragment, enum hl_format color,
                      enum hl_blend blend, uint32_t batch)
{
    memset(p, 0, sizeof *p);
    p->label = "light";
    p->vertex.builtin = fragment == HL_SHADER_LIGHT_FLAT_FRAG
                        ? HL_SHADER_SCREEN_FLAT_VERT : HL_SHADER_SCREEN_VERT;
    p->fragment.builtin = fragment;
    p->n_colors = 1;
    p->color[0] = color;
    p->blend = blend;
    light_specs(plan, p, batch);
    packed_specs(plan, p);
    hl_shift_specs(plan, p);
    spec(p, HL_SPEC_DEPTH_READ, depth_read(plan, fragment));
    spec_float(p, HL_SPEC_LIGHT_OUT, plan->light_out);
    spec_float(p, HL_SPEC_LIGHT_WIDTH, (float)plan->light_width);
    spec_float(p, HL_SPEC_LIGHT_HEIGHT, (float)plan->light_height);
}

enum hl_result hl_screen_program(struct hl_renderer *r,
                                 enum hl_shader fragment,
                                 enum hl_format color, enum hl_blend blend,
                                 uint32_t batch, hl_prog *out)
{
    struct hl_prog_desc p;
    to_screen(&r->plan, &p, fragment, color, blend, batch);
    if (is_light_stage(fragment))
        bind_depth(&r->plan, &p, HL_PASS_LIGHT);
    return hl_prog_create(r->device, out, &p);
}

enum hl_result hl_light_stencil_program(struct hl_renderer *r,
                                        enum hl_pass_role pass,
                                        const struct hl_stencil_face *face,
                                        hl_prog *out)
{
    struct hl_prog_desc p;
    to_screen(&r->plan, &p, r->plan.light_flat ? HL_SHADER_LIGHT_FLAT_FRAG
                                               : HL_SHADER_LIGHT_BATCH_FRAG,
              role_format(&r->plan, HL_ROLE_LIGHT), HL_BLEND_ADD, 1);
    bind_depth(&r->plan, &p, pass);
    p.stencil.front = p.stencil.back = *face;
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

enum hl_result hl_map_program(struct hl_renderer *r, uint32_t kind,
                              hl_prog *out)
{
    const struct hl_plan *plan = &r->plan;
    const struct hl_plan_target *t = hl_plan_target(plan, HL_ROLE_SHADOW_MAP);
    struct hl_prog_desc p;
    to_screen(plan, &p, kind == HL_MAP_NONE ? HL_SHADER_LIGHT_BATCH_FRAG
                                            : HL_SHADER_LIGHT_MAP_FRAG,
              role_format(plan, HL_ROLE_LIGHT), HL_BLEND_ADD, 1);
    if (t->width > plan->shadow_size)
        kind |= HL_MAP_SIX;
    if (plan->depth_read == HL_DEPTH_READ_BARG)
        kind |= HL_MAP_BARG;
    spec_float(&p, HL_SPEC_MAP_SIZE, (float)plan->shadow_size);
    spec(&p, HL_SPEC_MAP_KIND, kind);
    return hl_prog_create(r->device, out, &p);
}

static enum hl_result make_depth_copy(struct hl_renderer *r)
{
    enum hl_format f = role_format(&r->plan, HL_ROLE_DEPTH_COPY);
    return f == HL_FORMAT_NONE ? HL_OK
           : hl_screen_program(r, HL_SHADER_DEPTH_COPY_FRAG, f, HL_BLEND_OFF,
                               0, &r->depth_copy);
}

static enum hl_result make_light_programs(struct hl_renderer *r)
{
    const struct hl_plan *p = &r->plan;
    enum hl_format f = role_format(p, HL_ROLE_LIGHT);
    if (p->light_path == HL_LIGHT_PATH_LISTS)
        return hl_screen_program(r, HL_SHADER_LIGHT_TILES_FRAG, f,
                                 HL_BLEND_OFF, 0, &r->list_prog);
    bool rects = p->light_path == HL_LIGHT_PATH_RECTS ||
                 p->light_path == HL_LIGHT_PATH_VOLUMES;
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

/* ---- all ---------------------------------------------------------------- */

/* A stage of the embedder's own reads inferred light: forward pipelines have
 * none for it, and would read its block as if it were theirs. */
static enum hl_result refuse_own(struct hl_renderer *r)
{
    hl_bk_log(r->device, HL_LOG_ERROR, HL_MSG_ARGUMENT,
              "hl_surface.own_material", ": needs the inferred pipeline",
              NULL);
    return HL_ERR_UNSUPPORTED;
}

/* Two kinds that follow each other. */
static enum hl_result make_two(struct hl_renderer *r, uint32_t surface,
                               int first)
{
    for (int k = first; k < first + 2; k++) {
        enum hl_result e = hl_surface_program(r, surface, k,
                                              &r->prog[surface][k]);
        if (e != HL_OK)
            return e;
    }
    return HL_OK;
}

static enum hl_result make_surface_programs(struct hl_renderer *r, uint32_t i)
{
    bool inferred = r->plan.pipeline == HL_PIPELINE_INFERRED;
    int first = inferred ? PROG_GBUFFER : PROG_BASE;
    if (r->surfaces[i].own_material && !inferred)
        return refuse_own(r);
    enum hl_class c = hl_surface_class(r, i);
    if (c == HL_CLASS_DECAL)
        return make_two(r, i, PROG_DECAL_GBUFFER);
    if (c == HL_CLASS_BLENDED) {
        enum hl_result e = hl_surface_program(r, i, PROG_BLENDED,
                                              &r->prog[i][PROG_BLENDED]);
        return e == HL_OK && r->plan.stipple
               ? make_two(r, i, PROG_STIPPLE_GBUFFER) : e;
    }
    if (r->plan.dsf == HL_DSF_DARK)
        return hl_surface_program(r, i, PROG_MATERIAL,
                                  &r->prog[i][PROG_MATERIAL]);
    return make_two(r, i, first);
}

enum hl_result hl_programs_make(struct hl_renderer *r)
{
    enum hl_result e = HL_OK;
    if (hl_plan_pass(&r->plan, HL_PASS_LIGHT)) {
        e = make_depth_copy(r);
        if (e == HL_OK)
            e = make_light_programs(r);
    }
    for (uint32_t i = 0; i < r->n_surfaces && e == HL_OK; i++)
        e = make_surface_programs(r, i);
    return e;
}
