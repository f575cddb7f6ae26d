/* SPDX-License-Identifier: Zlib */
/* Pictures of the inside: ids, lights a pixel, rejected taps, stipple. */
#include <string.h>
#include "core/renderer.h"

/* Of the light pass? Then without meshes, and without depth. */
static bool on_light_buffer(const struct hl_renderer *r, enum hl_inspect what)
{
    return what == HL_INSPECT_LIGHTS &&
           r->plan.pipeline == HL_PIPELINE_INFERRED;
}

void hl_inspect_size(const struct hl_renderer *r, enum hl_inspect what,
                     uint32_t *width, uint32_t *height)
{
    bool light = on_light_buffer(r, what) || what == HL_INSPECT_STIPPLE;
    *width = light ? r->plan.light_width : r->plan.width;
    *height = light ? r->plan.light_height : r->plan.height;
}

static bool by_lists(const struct hl_renderer *r)
{
    return r->plan.light_path == HL_LIGHT_PATH_LISTS &&
           r->plan.pipeline == HL_PIPELINE_INFERRED;
}

/* Four bytes a texel, of which counts take the first channel. */
static enum hl_format format_of(const struct hl_renderer *r,
                                enum hl_inspect what)
{
    return what == HL_INSPECT_IDS ? HL_FORMAT_R32_UINT
           : what == HL_INSPECT_REJECTS || what == HL_INSPECT_STIPPLE
             ? HL_FORMAT_R8_UNORM
           : by_lists(r) ? HL_FORMAT_R32_FLOAT : r->count_format;
}

/* Consoles do not blend 32-bit floats. One draw with lists need not. */
void hl_inspect_set_up(struct hl_renderer *r)
{
    static const struct { enum hl_format format; float steps; } list[] = {
        { HL_FORMAT_R32_FLOAT, 1 }, { HL_FORMAT_RG16_UNORM, 65535 },
        { HL_FORMAT_RGBA8_UNORM, 255 }
    };
    const struct hl_caps *c = hl_device_caps(r->device);
    int i = 0;
    while (i < 2 && !(c->format[list[i].format].use & HL_USE_BLEND))
        i++;
    r->count_format = list[i].format;
    r->count_steps = list[i].steps;
}

/* Codes of count_format, as read back, to numbers of lights. The first two
 * bytes of RGBA8_UNORM are red and no green. */
static void to_counts(uint8_t *texel, size_t n)
{
    for (size_t i = 0; i < n; i++, texel += sizeof(float)) {
        uint16_t code;
        memcpy(&code, texel, sizeof code);
        float count = code;
        memcpy(texel, &count, sizeof count);
    }
}

/* Over the frame's own targets, which are drawn and resolved. */
static void place_in_edram(struct hl_renderer *r, struct hl_tex_desc *color,
                           struct hl_tex_desc *depth)
{
    const struct hl_caps *c = hl_device_caps(r->device);
    if (!c->console_memory || !c->profile.edram_tiles)
        return;
    color->console.edram_tile = 1;
    depth->console.edram_tile = (uint16_t)(1 + hl_edram_tiles(
        &c->profile, color->format, color->width, color->height, 1));
}

/* Single-sampled, whatever the frame is: a count or an id is never averaged. */
static enum hl_result make_targets(struct hl_renderer *r,
                                   enum hl_inspect what)
{
    struct hl_tex_desc c, d;
    memset(&c, 0, sizeof c);
    hl_inspect_size(r, what, &c.width, &c.height);
    d = c;
    c.label = "inspect";
    c.format = format_of(r, what);
    c.usage = HL_TEX_TARGET | HL_TEX_READBACK;
    d.label = "inspect depth";
    d.format = hl_plan_target(&r->plan, what == HL_INSPECT_STIPPLE
                                        ? HL_ROLE_LIGHT_DEPTH
                                        : HL_ROLE_DEPTH)->format;
    d.usage = HL_TEX_TARGET;
    place_in_edram(r, &c, &d);
    hl_tex_destroy(r->device, &r->inspect_color);
    hl_tex_destroy(r->device, &r->inspect_depth);
    enum hl_result e = hl_tex_create(r->device, &r->inspect_color, &c);
    if (e == HL_OK && !on_light_buffer(r, what))
        e = hl_tex_create(r->device, &r->inspect_depth, &d);
    return e;
}

static bool is_drawn(const struct hl_renderer *r, uint32_t surface, int kind)
{
    enum hl_class c = hl_surface_class(r, surface);
    return c == HL_CLASS_OPAQUE ||
           (c == HL_CLASS_BLENDED && kind == PROG_STIPPLE_ID);
}

static enum hl_result need_program(struct hl_renderer *r, int kind)
{
    for (uint32_t i = 0; i < r->n_surfaces; i++) {
        hl_prog *p = &r->prog[i][kind];
        enum hl_result e = p->id || !is_drawn(r, i, kind)
                           ? HL_OK : hl_surface_program(r, i, kind, p);
        if (e != HL_OK)
            return e;
    }
    return HL_OK;
}

static enum hl_result need_programs(struct hl_renderer *r,
                                    enum hl_inspect what)
{
    if (what == HL_INSPECT_IDS)
        return need_program(r, PROG_ID);
    if (what == HL_INSPECT_REJECTS)
        return need_program(r, PROG_REJECT);
    if (what == HL_INSPECT_STIPPLE)
        return need_program(r, PROG_STIPPLE_ID);
    if (!on_light_buffer(r, what)) {
        enum hl_result e = need_program(r, PROG_COUNT_BASE);
        return e == HL_OK ? need_program(r, PROG_COUNT_MORE) : e;
    }
    bool lists = r->plan.light_path == HL_LIGHT_PATH_LISTS;
    hl_prog *p = lists ? &r->count_tiles : &r->count_prog;
    return p->id ? HL_OK
           : hl_screen_program(r, lists ? HL_SHADER_COUNT_TILES_FRAG
                                        : HL_SHADER_COUNT_FRAG,
                               format_of(r, what),
                               lists ? HL_BLEND_OFF : HL_BLEND_ADD, 1, p);
}

/* The geometry pass once more. */
static void emit_stipple(struct hl_renderer *r, const struct hl_frame *f)
{
    for (uint32_t i = 0; i < r->n_opaque; i++)
        hl_draw_mesh(r, f, i, PROG_STIPPLE_ID);
    for (uint32_t i = r->n_decals; i < r->n_visible; i++)
        if (r->visible[i].pattern != HL_STIPPLE_NONE)
            hl_draw_mesh(r, f, i, PROG_STIPPLE_ID);
}

static void emit(struct hl_renderer *r, const struct hl_frame *f,
                 enum hl_inspect what)
{
    if (what == HL_INSPECT_LIGHTS) {
        r->counting = true;
        if (on_light_buffer(r, what))
            hl_emit_light_pass(r, f);
        else
            hl_emit_forward(r, f);
        r->counting = false;
        return;
    }
    if (what == HL_INSPECT_STIPPLE) {
        emit_stipple(r, f);
        return;
    }
    for (uint32_t i = 0; i < r->n_opaque; i++)
        hl_draw_mesh(r, f, i, what == HL_INSPECT_IDS ? PROG_ID : PROG_REJECT);
}

enum hl_result hl_frame_inspect(struct hl_renderer *r,
                                const struct hl_frame *f,
                                enum hl_inspect what, void *out, size_t bytes)
{
    if (!r || !f || !out || (unsigned)what > HL_INSPECT_STIPPLE)
        return HL_ERR_INVALID;
    bool inferred = r->plan.pipeline == HL_PIPELINE_INFERRED;
    if (what == HL_INSPECT_REJECTS &&
        (!inferred || r->plan.dsf == HL_DSF_DARK))
        return HL_ERR_UNSUPPORTED;
    if (what == HL_INSPECT_STIPPLE && !r->plan.stipple)
        return HL_ERR_UNSUPPORTED;
    const float zero[4] = { 0, 0, 0, 0 };
    r->stippling.again = true;
    enum hl_result e = hl_frame_gather(r, f);
    r->stippling.again = false;
    if (e == HL_OK)
        e = make_targets(r, what);
    if (e == HL_OK)
        e = need_programs(r, what);
    bool light = on_light_buffer(r, what);
    /* Lights with shadows count as all others, wherever they reach. */
    if (what == HL_INSPECT_LIGHTS)
        r->n_plain = r->n_spheres;
    if (e == HL_OK && light && r->plan.light_path != HL_LIGHT_PATH_RECTS)
        e = hl_build_tiles(r, f);
    if (e != HL_OK)
        return e;
    hl_pass_begin(r, "inspect");
    hl_pass_color(r, r->inspect_color, HL_LOAD_CLEAR, zero);
    if (!light)
        hl_pass_depth(r, r->inspect_depth, HL_LOAD_CLEAR, false);
    emit(r, f, what);
    hl_pass_end(r);
    if (r->result == HL_OK)
        r->result = hl_tex_read(r->device, r->inspect_color, out, bytes);
    if (r->result == HL_OK && what == HL_INSPECT_LIGHTS &&
        format_of(r, what) != HL_FORMAT_R32_FLOAT)
        to_counts(out, bytes / sizeof(float));
    return r->result;
}
