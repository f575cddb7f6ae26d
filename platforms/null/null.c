/* SPDX-License-Identifier: Zlib */
/* A whole backend that draws nothing. Clears are carried out, so that a
 * readback shows what a pass of clears would; draws are only recorded. */
#include <string.h>
#include "hal/text.h"
#include "platforms/null/hl_null.h"

struct null_object { uint8_t *memory; size_t bytes; struct hl_tex_desc tex; };

struct null_state {
    struct hl_device *device;
    struct hl_null_native native;
    struct null_object *buf, *tex;
    uint32_t n_calls;
};

static enum hl_result null_list(const struct hl_hooks *hooks,
                                struct hl_device_info *out, uint32_t max,
                                uint32_t *n)
{
    (void)hooks;
    *n = 1;
    if (max > 0) {
        memset(out, 0, sizeof *out);
        strcpy(out->name, "null");
        strcpy(out->driver, "halflight null");
        out->kind = HL_DEVICE_OTHER;
    }
    return HL_OK;
}

static void default_caps(struct hl_caps *c)
{
    memset(c, 0, sizeof *c);
    c->kind = HL_DEVICE_OTHER;
    c->max_tex_dim = 16384;
    c->max_colors = HL_MAX_COLORS;
    c->max_uniform_bytes = 65536;
    c->max_storage_bytes = 1u << 27;
    c->uniform_align = 64;
    c->storage_align = 64;
    c->samples = 1 | 2 | 4 | 8;
    c->clip_zero_to_one = true;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        enum hl_format_kind kind = hl_format_info((enum hl_format)i)->kind;
        int use = HL_USE_SAMPLED | HL_USE_TARGET;
        if (i >= HL_FORMAT_RG16_FIXED32)
            continue;        /* consoles' own                                */
        if (kind != HL_KIND_DEPTH && kind != HL_KIND_UINT)
            use |= HL_USE_LINEAR | HL_USE_BLEND;
        c->format[i].use = (uint8_t)use;
        c->format[i].samples = 1 | 2 | 4 | 8;
    }
    /* Equal costs: a plan for null shows the rules, not a machine. */
    c->cost = (struct hl_cost_model){
        .draw_ns = 1000, .vertex_ns = 1, .pixel_ns = 1, .fetch_ns = 1,
        .blend_ns = 1, .light_ns = 1, .light_flat_ns = 1,
        .light_gather_ns = 1, .readback_ns = 1, .sync_ns = 1000
    };
}

static enum hl_result null_open(void *state, struct hl_device *device,
                                const struct hl_device_desc *desc,
                                struct hl_caps *caps)
{
    struct null_state *s = state;
    s->device = device;
    if (desc->native)
        s->native = *(const struct hl_null_native *)desc->native;
    s->buf = hl_bk_alloc(device, desc->max_buffers * sizeof *s->buf);
    s->tex = hl_bk_alloc(device, desc->max_textures * sizeof *s->tex);
    if (!s->buf || !s->tex) {
        hl_bk_free(device, s->buf);
        hl_bk_free(device, s->tex);
        return HL_ERR_MEMORY;
    }
    if (s->native.caps)
        *caps = *s->native.caps;
    else
        default_caps(caps);
    strcpy(caps->backend, "null");
    if (!caps->device[0])
        strcpy(caps->device, "null");
    return HL_OK;
}

static void null_close(void *state)
{
    struct null_state *s = state;
    hl_bk_free(s->device, s->buf);
    hl_bk_free(s->device, s->tex);
}

static bool fails(struct null_state *s)
{
    return ++s->n_calls == s->native.fail_at;
}

static enum hl_result null_buf_create(void *state, uint32_t slot,
                                      const struct hl_buf_desc *desc)
{
    struct null_state *s = state;
    struct null_object *o = &s->buf[slot];
    o->memory = fails(s) ? NULL : hl_bk_alloc(s->device, desc->bytes);
    if (!o->memory)
        return HL_ERR_MEMORY;
    o->bytes = desc->bytes;
    if (desc->data)
        memcpy(o->memory, desc->data, desc->bytes);
    return HL_OK;
}

static enum hl_result null_buf_write(void *state, uint32_t slot,
                                     size_t offset, const void *data,
                                     size_t bytes)
{
    struct null_state *s = state;
    if (fails(s))
        return HL_ERR_MEMORY;
    memcpy(s->buf[slot].memory + offset, data, bytes);
    return HL_OK;
}

static size_t level_offset(const struct hl_tex_desc *t, uint32_t mip)
{
    size_t at = 0;
    for (uint32_t i = 0; i < mip; i++) {
        size_t w = t->width >> i, h = t->height >> i;
        at += (w ? w : 1) * (h ? h : 1) * hl_format_info(t->format)->bytes;
    }
    return at * t->samples;
}

static enum hl_result null_tex_create(void *state, uint32_t slot,
                                      const struct hl_tex_desc *desc)
{
    struct null_state *s = state;
    struct null_object *o = &s->tex[slot];
    o->tex = *desc;
    o->bytes = level_offset(desc, desc->mips);
    o->memory = fails(s) ? NULL : hl_bk_alloc(s->device, o->bytes);
    return o->memory ? HL_OK : HL_ERR_MEMORY;
}

static enum hl_result null_tex_write(void *state, uint32_t slot, uint32_t mip,
                                     const void *data, size_t bytes)
{
    struct null_state *s = state;
    if (fails(s))
        return HL_ERR_MEMORY;
    memcpy(s->tex[slot].memory + level_offset(&s->tex[slot].tex, mip), data,
           bytes);
    return HL_OK;
}

static enum hl_result null_tex_read(void *state, uint32_t slot, void *out,
                                    size_t bytes)
{
    struct null_state *s = state;
    const struct null_object *o = &s->tex[slot];
    memset(out, 0, bytes);
    memcpy(out, o->memory, bytes < o->bytes ? bytes : o->bytes);
    return HL_OK;
}

static enum hl_result null_prog_create(void *state, uint32_t slot,
                                       const struct hl_prog_desc *desc)
{
    (void)slot;
    (void)desc;
    return fails(state) ? HL_ERR_MEMORY : HL_OK;
}

static void null_destroy(void *state, char kind, uint32_t slot)
{
    struct null_state *s = state;
    if (kind == 'p')
        return;
    struct null_object *o = kind == 'b' ? &s->buf[slot] : &s->tex[slot];
    hl_bk_free(s->device, o->memory);
    memset(o, 0, sizeof *o);
}

/* Only 32-bit float formats keep a clear's value; others are zeroed. */
static void clear(struct null_object *o, const struct hl_bk_target *t)
{
    size_t texel = hl_format_info(o->tex.format)->bytes;
    memset(o->memory, 0, o->bytes);
    if (o->tex.format != HL_FORMAT_RGBA32_FLOAT &&
        o->tex.format != HL_FORMAT_D32_FLOAT &&
        o->tex.format != HL_FORMAT_R32_FLOAT)
        return;
    for (size_t i = 0; i + texel <= o->bytes; i += texel)
        memcpy(o->memory + i, t->clear, texel);
}

static const char *load_name(enum hl_load load)
{
    return load == HL_LOAD_CLEAR ? "clear"
           : load == HL_LOAD_DISCARD ? "discard" : "keep";
}

static void record_target(struct hl_text *t, const char *name, uint32_t i,
                          const struct hl_bk_target *x)
{
    hl_text_str(t, name);
    hl_text_uint(t, i);
    hl_text_str(t, "=");
    hl_text_uint(t, x->slot);
    hl_text_str(t, "(");
    hl_text_str(t, load_name(x->load));
    hl_text_str(t, x->resolve != HL_NO_SLOT ? ",resolve)" : ")");
}

static void record_pass(struct null_state *s, const struct hl_bk_pass *p,
                        uint32_t n_draws)
{
    char line[512];
    struct hl_text t = hl_text_begin(line, sizeof line);
    hl_text_str(&t, "pass ");
    hl_text_str(&t, p->label);
    hl_text_str(&t, " ");
    hl_text_uint(&t, p->width);
    hl_text_str(&t, "x");
    hl_text_uint(&t, p->height);
    hl_text_str(&t, "x");
    hl_text_uint(&t, p->samples);
    for (uint32_t i = 0; i < p->n_colors; i++)
        record_target(&t, " c", i, &p->color[i]);
    if (p->depth.slot != HL_NO_SLOT)
        record_target(&t, p->depth_read_only ? " ro" : " d", 0, &p->depth);
    hl_text_str(&t, " draws=");
    hl_text_uint(&t, n_draws);
    s->native.record(s->native.record_user, line);
}

static enum hl_result null_pass_run(void *state, const struct hl_bk_pass *p,
                                    const struct hl_bk_draw *draws,
                                    uint32_t n_draws)
{
    struct null_state *s = state;
    (void)draws;
    if (fails(s))
        return HL_ERR_MEMORY;
    for (uint32_t i = 0; i < p->n_colors; i++)
        if (p->color[i].load == HL_LOAD_CLEAR)
            clear(&s->tex[p->color[i].slot], &p->color[i]);
    if (p->depth.slot != HL_NO_SLOT && p->depth.load == HL_LOAD_CLEAR)
        clear(&s->tex[p->depth.slot], &p->depth);
    if (s->native.record)
        record_pass(s, p, n_draws);
    return HL_OK;
}

static enum hl_result null_submit(void *state, bool wait)
{
    (void)state;
    (void)wait;
    return HL_OK;
}

static uint32_t null_timings(void *state, struct hl_timing *out, uint32_t max)
{
    (void)state;
    (void)out;
    (void)max;
    return 0;
}

const struct hl_backend hl_backend_null = {
    "null", HL_VERSION, sizeof(struct null_state),
    null_list, null_open, null_close, null_buf_create, null_buf_write,
    null_tex_create, null_tex_write, null_tex_read, null_prog_create,
    null_destroy, null_pass_run, null_submit, null_timings,
};
