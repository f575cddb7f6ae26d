/* SPDX-License-Identifier: Zlib */
/* The suite's device: pictures in, one operation, pictures out. */
#include <string.h>
#include "platforms/conform/cf.h"

bool cf_ok(struct cf *cf, enum hl_result r)
{
    if (r != HL_OK) {
        cf->broken = true;
        cf->result = r;
    }
    if (r != HL_OK && !cf->complaint[0])
        cf_join(cf->complaint, sizeof cf->complaint, hl_result_name(r), NULL,
                NULL, NULL);
    return r == HL_OK;
}

/* The device's errors are kept as reasons, and go on to the caller's log. */
static void listen(void *user, enum hl_log_level level, enum hl_log_id id,
                   const char *text)
{
    struct cf *cf = user;
    const struct hl_device_desc *d = cf->desc->device;
    if (level == HL_LOG_ERROR && !cf->complaint[0])
        cf_join(cf->complaint, sizeof cf->complaint, text, NULL, NULL, NULL);
    if (d->log)
        d->log(d->log_user, level, id, text);
}

static void *get(struct cf *cf, size_t bytes)
{
    const struct hl_hooks *h = &cf->desc->device->hooks;
    void *p = h->alloc(h->user, bytes);
    if (p)
        memset(p, 0, bytes);
    return p;
}

static void give(struct cf *cf, void *p)
{
    const struct hl_hooks *h = &cf->desc->device->hooks;
    if (p)
        h->free(h->user, p);
}

static bool pictures(struct cf *cf, uint32_t n_names)
{
    cf->in = get(cf, CF_PIXELS * sizeof *cf->in);
    cf->out = get(cf, CF_PIXELS * sizeof *cf->out);
    cf->raw = get(cf, CF_PIXELS * 16);
    cf->seen = get(cf, n_names);
    return cf->in && cf->out && cf->raw && cf->seen;
}

static bool buffer(struct cf *cf, hl_buf *out, uint32_t usage, size_t bytes,
                   const void *data)
{
    struct hl_buf_desc b;
    memset(&b, 0, sizeof b);
    b.label = "conform";
    b.bytes = bytes;
    b.usage = usage;
    b.dynamic = !data;
    b.data = data;
    return cf_ok(cf, hl_buf_create(cf->device, out, &b));
}

/* Layer k is a triangle at w = k + 1, so that 1 / gl_FragCoord.w tells which
 * it is: x w, y w, w of a vertex. */
static bool layers(struct cf *cf, hl_buf *out, bool stairs)
{
    float (*v)[3] = (float (*)[3])(void *)cf->raw;
    uint32_t n = stairs ? CF_STAIRS : CF_LAYERS;
    for (uint32_t k = 0; k < n; k++) {
        float w = (float)(k + 1);
        float left = stairs ? 2.0f * (float)k / CF_STAIRS - 1 : -1;
        const float corner[3][2] = { { left, -1 }, { left + 4, -1 },
                                     { left, 3 } };
        for (int i = 0; i < 3; i++) {
            v[3 * k + (uint32_t)i][0] = corner[i][0] * w;
            v[3 * k + (uint32_t)i][1] = corner[i][1] * w;
            v[3 * k + (uint32_t)i][2] = w;
        }
    }
    return buffer(cf, out, HL_BUF_VERTEX, (size_t)n * 9 * 4, v);
}

static bool buffers(struct cf *cf)
{
    struct hl_object_block o;
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = o.clip.column[1].y = 1;
    o.clip.column[2].z = 0.5f;       /* depth 1/2 in either clip space       */
    o.clip.column[2].w = 1;
    return buffer(cf, &cf->block, HL_BUF_UNIFORM, HL_CONFORM_VEC4S * 16,
                  NULL) &&
           buffer(cf, &cf->object, HL_BUF_UNIFORM, sizeof o, &o) &&
           layers(cf, &cf->full, false) && layers(cf, &cf->stairs, true);
}

bool cf_open(struct cf *cf)
{
    struct hl_device_desc d = *cf->desc->device;
    uint32_t n = 0;
    d.log = listen;
    d.log_user = cf;
    if (!cf_ok(cf, hl_device_open(&cf->device, cf->desc->backend, &d)))
        return false;
    cf->caps = hl_device_caps(cf->device);
    cf->profile = &cf->caps->profile;
    cf->profile_name = cf->profile->name[0] ? cf->profile->name : "native";
    while (hl_conform_name(n))
        n++;
    return cf_ok(cf, pictures(cf, n) ? HL_OK : HL_ERR_MEMORY) && buffers(cf);
}

void cf_close(struct cf *cf)
{
    for (uint32_t i = 0; i < cf->n_progs; i++)
        hl_prog_destroy(cf->device, &cf->prog[i].prog);
    hl_buf_destroy(cf->device, &cf->block);
    hl_buf_destroy(cf->device, &cf->object);
    hl_buf_destroy(cf->device, &cf->full);
    hl_buf_destroy(cf->device, &cf->stairs);
    hl_device_close(&cf->device);
    give(cf, cf->in);
    give(cf, cf->out);
    give(cf, cf->raw);
    give(cf, cf->seen);
}

/* ---- textures ----------------------------------------------------------- */

bool cf_usable(const struct cf *cf, enum hl_format format, uint8_t use)
{
    return (cf->caps->format[format].use & use) == use;
}

bool cf_tex(struct cf *cf, hl_tex *out, enum hl_format format,
            enum hl_format sample_as, const struct hl_console *console,
            uint32_t width, uint32_t height)
{
    struct hl_tex_desc t;
    memset(&t, 0, sizeof t);
    t.label = "conform";
    t.format = format;
    t.sample_as = sample_as;
    t.width = width;
    t.height = height;
    t.usage = HL_TEX_SAMPLED | HL_TEX_TARGET | HL_TEX_READBACK;
    if (console)
        t.console = *console;
    return cf_ok(cf, hl_tex_create(cf->device, out, &t));
}

static size_t tex_bytes(struct cf *cf, hl_tex tex)
{
    struct hl_tex_desc t;
    if (!hl_tex_info(cf->device, tex, &t))
        return 0;
    const struct hl_format_info *f = hl_format_info(t.format);
    return (size_t)t.width * t.height *
           (f->kind == HL_KIND_DEPTH ? 4u : f->bytes);
}

bool cf_write(struct cf *cf, hl_tex tex, const void *data)
{
    return cf_ok(cf, hl_tex_write(cf->device, tex, 0, data,
                                  tex_bytes(cf, tex)));
}

bool cf_input(struct cf *cf, hl_tex *tex, uint32_t width, uint32_t height)
{
    struct hl_tex_desc t;
    memset(&t, 0, sizeof t);
    t.label = "conform input";
    t.format = HL_FORMAT_RGBA32_FLOAT;
    t.width = width;
    t.height = height;
    t.usage = HL_TEX_SAMPLED;
    return cf_ok(cf, hl_tex_create(cf->device, tex, &t)) &&
           cf_write(cf, *tex, cf->in);
}

bool cf_read(struct cf *cf, hl_tex tex)
{
    struct hl_tex_desc t;
    if (!hl_tex_info(cf->device, tex, &t))
        return cf_ok(cf, HL_ERR_INVALID);
    void *to = t.format == HL_FORMAT_RGBA32_FLOAT ? (void *)cf->out
                                                  : (void *)cf->raw;
    return cf_ok(cf, hl_tex_read(cf->device, tex, to, tex_bytes(cf, tex)));
}

void cf_drop(struct cf *cf, hl_tex *tex)
{
    hl_tex_destroy(cf->device, tex);
}

/* ---- drawing ------------------------------------------------------------ */

static struct cf_prog *known(struct cf *cf, const struct cf_prog *want)
{
    for (uint32_t i = 0; i < cf->n_progs; i++) {
        struct cf_prog *q = &cf->prog[i];
        if (q->format == want->format && q->blend == want->blend &&
            q->constant == want->constant && q->layers == want->layers)
            return q;
    }
    return NULL;
}

static bool program(struct cf *cf, hl_prog *out, const struct cf_prog *want)
{
    struct hl_prog_desc p;
    struct cf_prog *q = known(cf, want);
    if (!q) {
        memset(&p, 0, sizeof p);
        p.label = "conform";
        p.vertex.builtin = want->layers ? HL_SHADER_MESH_ID_VERT
                                        : HL_SHADER_SCREEN_VERT;
        p.fragment.builtin = HL_SHADER_CONFORM_FRAG;
        p.n_colors = 1;
        p.color[0] = want->format;
        p.blend = want->blend;
        p.blend_constant = want->constant;
        if (want->layers) {
            p.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
            p.layout.stride[0] = 3 * sizeof(float);
        }
        if (cf->n_progs == CF_PROGS)
            return cf_ok(cf, HL_ERR_LIMIT);
        q = &cf->prog[cf->n_progs];
        *q = *want;
        if (!cf_ok(cf, hl_prog_create(cf->device, &q->prog, &p)))
            return false;
        cf->n_progs++;
    }
    *out = q->prog;
    return true;
}

static bool fill_block(struct cf *cf, const struct cf_op *o)
{
    hl_vec4 v[HL_CONFORM_VEC4S];
    uint32_t last = o->backwards ? o->layers - 1 : 0;
    float x = (float)(o->step_x % CF_SIDE), y = (float)(o->step_y % CF_SIDE);
    if (o->backwards) {
        x = x > 0 ? CF_SIDE - x : 0;
        y = y > 0 ? CF_SIDE - y : 0;
    }
    v[0] = hl_v4((float)o->op, (float)o->two16, x, y);
    v[1] = o->a;
    v[2] = o->b;
    v[3] = o->c;
    v[4] = hl_v4((float)(last * o->step_x % CF_SIDE),
                 (float)(last * o->step_y % CF_SIDE), 0, 0);
    return cf_ok(cf, hl_buf_write(cf->device, cf->block, 0, v, sizeof v));
}

static void fill_draw(const struct cf *cf, const struct cf_op *o,
                      struct hl_draw *d)
{
    d->count = o->layers ? 3 * o->layers : 3;
    d->uniform[HL_SLOT_MATERIAL].buf = cf->block;
    d->uniform[HL_SLOT_MATERIAL].bytes = HL_CONFORM_VEC4S * 16;
    d->scissor = o->scissor;
    if (!o->layers)
        return;
    d->vertex[0] = o->stairs ? cf->stairs : cf->full;
    d->uniform[HL_SLOT_FRAME].buf = cf->object;
    d->uniform[HL_SLOT_FRAME].bytes = sizeof(struct hl_frame_block);
    d->uniform[HL_SLOT_OBJECT].buf = cf->object;
    d->uniform[HL_SLOT_OBJECT].bytes = sizeof(struct hl_object_block);
}

bool cf_draw(struct cf *cf, const struct cf_op *o)
{
    struct hl_texture_binding textures[2];
    struct hl_tex_desc target;
    struct hl_draw draw;
    struct hl_pass pass;
    memset(&draw, 0, sizeof draw);
    memset(&pass, 0, sizeof pass);
    memset(textures, 0, sizeof textures);
    if (!hl_tex_info(cf->device, o->target, &target) ||
        o->layers > (o->stairs ? CF_STAIRS : CF_LAYERS))
        return cf_ok(cf, HL_ERR_INVALID);
    struct cf_prog want = { target.format, o->blend, o->constant,
                            o->layers > 0, { 0 } };
    if (!program(cf, &draw.prog, &want) || !fill_block(cf, o))
        return false;
    textures[HL_CONFORM_IN].tex = o->in;
    textures[HL_CONFORM_STORED].tex = o->stored;
    textures[HL_CONFORM_STORED].filter =
        o->linear ? HL_FILTER_LINEAR : HL_FILTER_NEAREST;
    draw.textures = textures;
    draw.n_textures = 2;
    fill_draw(cf, o, &draw);
    pass.label = "conform";
    pass.n_colors = 1;
    pass.color[0].tex = o->target;
    pass.color[0].load = o->keep ? HL_LOAD_KEEP : HL_LOAD_CLEAR;
    pass.half_pixel_offset = cf->profile->integer_centers;
    pass.draws = &draw;
    pass.n_draws = 1;
    return cf_ok(cf, hl_pass_run(cf->device, &pass)) &&
           cf_ok(cf, hl_submit(cf->device, true));
}
