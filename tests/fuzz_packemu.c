/* SPDX-License-Identifier: Zlib */
/* Random textures, targets, states and draws on the software device as any
 * console, with data that no sane caller would bind. Nothing may run past its
 * memory, whatever hal lets through, and one thread and three must leave the
 * same bytes in every texture. */
#include <string.h>
#include "platforms/packemu/hl_packemu.h"
#include "shaders/shared/block.h"
#include "tests/fuzz.h"

enum { TEXTURES = 8, BUFFERS = 4, BUFFER_BYTES = 4096, PASSES = 4, DRAWS = 4,
       SIDE = 150 };

struct world {
    struct hl_device *device;
    struct fz *f;
    long live;                   /* blocks of memory                         */
    uint32_t width, height;      /* of most textures                         */
    hl_tex tex[TEXTURES];
    struct hl_tex_desc desc[TEXTURES];
    uint32_t bound;              /* bits: targets of the pass in hand        */
    hl_buf buf[BUFFERS];         /* vertex, index, uniform, storage          */
};

static void *take(void *user, size_t bytes)
{
    struct world *w = user;
    if (bytes > 1u << 26)        /* an EDRAM of gigabytes                    */
        return NULL;
    w->live++;
    return malloc(bytes ? bytes : 1);
}

static void give(void *user, void *memory)
{
    struct world *w = user;
    w->live -= memory != NULL;
    free(memory);
}

/* ---- objects ------------------------------------------------------------- */

static struct hl_console some_console(struct fz *f)
{
    struct hl_console c = { 0, 0, 0, 0, 0, 0 };
    if (fz_bool(f))
        return c;
    c.edram_tile = (uint16_t)(fz_bool(f) ? 0 : fz_below(f, 2050));
    c.color_exp_bias = (int8_t)((int)fz_below(f, 66) - 33);
    c.resolve_exp_bias = (int8_t)((int)fz_below(f, 66) - 33);
    c.resolve_number = (uint8_t)fz_below(f, 2);
    c.endian = (uint8_t)fz_below(f, 4);
    c.remap = (uint16_t)(fz_bool(f) ? 0 : fz_below(f, 65536));
    return c;
}

static void make_texture(struct world *w, uint32_t i)
{
    struct fz *f = w->f;
    struct hl_tex_desc *d = &w->desc[i];
    bool other = fz_byte(f) < 64;
    memset(d, 0, sizeof *d);
    d->format = (enum hl_format)(1 + fz_below(f, HL_FORMAT_COUNT - 1));
    d->width = other ? 1 + fz_below(f, SIDE) : w->width;
    d->height = other ? 1 + fz_below(f, SIDE) : w->height;
    d->samples = fz_below(f, 3) ? 1 : 1u << fz_below(f, 4);
    d->mips = fz_below(f, 8) ? 1 : fz_below(f, 9);
    d->usage = fz_below(f, 8) ? HL_TEX_SAMPLED | HL_TEX_TARGET |
                                HL_TEX_READBACK : fz_below(f, 8);
    d->sample_as = (enum hl_format)(fz_below(f, 4) ? 0u : fz_below(
                                    f, HL_FORMAT_COUNT));
    d->console = some_console(f);
    /* What is refused is asked for again without the console's own, which
     * is the rarer, and then with less. */
    for (int less = 0; less < 3; less++) {
        if (hl_tex_create(w->device, &w->tex[i], d) == HL_OK)
            return;
        memset(&d->console, 0, sizeof d->console);
        d->sample_as = HL_FORMAT_NONE;
        d->mips = 1;
        d->usage = HL_TEX_SAMPLED | HL_TEX_TARGET | HL_TEX_READBACK;
        if (less == 1) {
            d->samples = 1;
            d->format = HL_FORMAT_RGBA8_UNORM;
        }
    }
}

/* Any bytes, floats of ordinary size among them. */
static void fill(struct fz *f, void *out, size_t bytes)
{
    uint8_t *b = out;
    uint32_t how = fz_byte(f), state = fz_word(f);
    for (size_t i = 0; i + 4 <= bytes; i += 4) {
        float x = (float)(int)(state >> 20) / 1024 - 2;
        uint32_t bits = how % 4 == 1 ? state >> 24 : state;
        state = state * 1664525u + 1013904223u;
        if (how % 4 >= 2)
            memcpy(&bits, &x, sizeof bits);
        memcpy(b + i, &bits, sizeof bits);
    }
    /* And what the input says, here and there. */
    for (uint32_t n = fz_byte(f) % 4; n > 0; n--) {
        float x = fz_number(f);
        memcpy(b + fz_below(f, (uint32_t)bytes / 4) * 4, &x, sizeof x);
    }
}

static void write_texture(struct world *w, uint32_t i)
{
    static uint32_t texels[SIDE * SIDE * 4];
    const struct hl_tex_desc *d = &w->desc[i];
    fill(w->f, texels, sizeof texels);
    hl_tex_write(w->device, w->tex[i], 0, texels,
                 (size_t)d->width * d->height *
                 hl_format_info(d->format)->bytes);
}

static void make_buffers(struct world *w)
{
    static uint32_t data[BUFFER_BYTES / 4];
    for (int i = 0; i < BUFFERS; i++) {
        struct hl_buf_desc d = { "b", sizeof data, 1u << i, true, data };
        fill(w->f, data, sizeof data);
        hl_buf_create(w->device, &w->buf[i], &d);
    }
}

/* ---- programs ------------------------------------------------------------ */

static void some_stencil(struct fz *f, struct hl_stencil *s)
{
    struct hl_stencil_face *face[] = { &s->front, &s->back };
    for (int i = 0; i < 2; i++) {
        face[i]->test = (enum hl_compare)(1 + fz_below(f, 7));
        face[i]->fail = (enum hl_stencil_op)fz_below(f, 8);
        face[i]->depth_fail = (enum hl_stencil_op)fz_below(f, 8);
        face[i]->pass = (enum hl_stencil_op)fz_below(f, 8);
    }
    s->reference = (uint8_t)fz_byte(f);
    s->read_mask = (uint8_t)fz_byte(f);
    s->write_mask = (uint8_t)fz_byte(f);
}

static void some_layout(struct fz *f, struct hl_vertex_layout *l)
{
    for (int i = 0; i < HL_MAX_ATTRS; i++) {
        l->attr[i].format = (enum hl_attr_format)fz_below(f, 11);
        l->attr[i].offset = (uint16_t)(fz_below(f, 16) * 4);
    }
    l->stride[0] = (uint16_t)(fz_bool(f) ? 80 : fz_below(f, 40) * 4);
}

static void some_stages(struct fz *f, struct hl_prog_desc *p)
{
    static const enum hl_shader pair[][2] = {
        { HL_SHADER_MESH_GBUFFER_VERT, HL_SHADER_GBUFFER_PLAIN_EXP_FRAG },
        { HL_SHADER_MESH_GBUFFER_FULL_VERT, HL_SHADER_GBUFFER_FULL_FRAG },
        { HL_SHADER_SCREEN_VERT, HL_SHADER_LIGHT_BATCH_FRAG },
        { HL_SHADER_SCREEN_VERT, HL_SHADER_LIGHT_TILES_FRAG },
        { HL_SHADER_SCREEN_FLAT_VERT, HL_SHADER_LIGHT_FLAT_FRAG },
        { HL_SHADER_MESH_MATERIAL_VERT, HL_SHADER_MATERIAL_PLAIN_FRAG },
        { HL_SHADER_MESH_OWN_VERT, HL_SHADER_MATERIAL_FULL_TAPS_FRAG },
        { HL_SHADER_MESH_FORWARD_VERT, HL_SHADER_FORWARD_PLAIN_FRAG },
        { HL_SHADER_MESH_FORWARD_FULL_VERT, HL_SHADER_FORWARD_LIST_FULL_FRAG },
        { HL_SHADER_SCREEN_VERT, HL_SHADER_CONFORM_FRAG },
    };
    uint32_t i = fz_byte(f);
    p->vertex.builtin = pair[i % 10][0];
    p->fragment.builtin = pair[i % 10][1];
    if (i >= 200) {
        p->vertex.builtin = (enum hl_shader)fz_below(f, HL_SHADER_COUNT);
        p->fragment.builtin = (enum hl_shader)fz_below(f, HL_SHADER_COUNT);
    }
    for (p->n_specs = 0; p->n_specs < fz_below(f, 8); p->n_specs++) {
        uint32_t bits = fz_below(f, 32);
        float x = fz_number(f);
        if (fz_bool(f))
            memcpy(&bits, &x, sizeof bits);
        p->spec[p->n_specs].id = fz_below(f, HL_MAX_SPECS);
        p->spec[p->n_specs].value = bits;
    }
}

/* A program for the targets of a pass. */
static hl_prog some_program(struct world *w, const struct hl_pass *pass,
                            const uint32_t *target, const uint32_t *depth)
{
    struct fz *f = w->f;
    struct hl_prog_desc p;
    hl_prog out = { 0 };
    memset(&p, 0, sizeof p);
    some_stages(f, &p);
    some_layout(f, &p.layout);
    p.topology = (enum hl_topology)(fz_byte(f) > 200);
    p.n_colors = pass->n_colors;
    for (uint32_t i = 0; i < pass->n_colors; i++) {
        p.color[i] = w->desc[target[i]].format;
        p.samples = w->desc[target[i]].samples;
    }
    if (depth) {
        p.depth = w->desc[*depth].format;
        p.samples = w->desc[*depth].samples;
        p.depth_test = (enum hl_compare)fz_below(f, 8);
        p.depth_write = fz_bool(f) && !pass->depth_read_only;
        if (fz_bool(f))
            some_stencil(f, &p.stencil);
    }
    p.blend = (enum hl_blend)fz_below(f, 6);
    p.blend_constant = fz_number(f);
    p.no_color_write = fz_byte(f) > 240;
    p.cull = (enum hl_cull)fz_below(f, 3);
    p.mirrored = fz_bool(f);
    if (hl_prog_create(w->device, &out, &p) != HL_OK) {
        p.blend = HL_BLEND_OFF;
        p.vertex.builtin = HL_SHADER_SCREEN_VERT;
        p.fragment.builtin = HL_SHADER_LIGHT_BATCH_FRAG;
        memset(&p.stencil, 0, sizeof p.stencil);
        hl_prog_create(w->device, &out, &p);
    }
    return out;
}

/* ---- passes -------------------------------------------------------------- */

static struct hl_range some_range(struct world *w, int buffer)
{
    struct hl_range r = { { 0 }, 0, 0 };
    if (fz_byte(w->f) > 230)
        return r;
    r.buf = w->buf[buffer];
    r.offset = fz_bool(w->f) ? 0 : fz_below(w->f, 5) * 256;
    r.bytes = fz_below(w->f, 4) ? 1024 : fz_below(w->f, 3072);
    return r;
}

static void some_draw(struct world *w, struct hl_draw *d,
                      struct hl_texture_binding *bound)
{
    struct fz *f = w->f;
    for (int i = 0; i < HL_MAX_STREAMS; i++)
        d->vertex[i] = w->buf[0];
    if (fz_bool(f))
        d->index = w->buf[1];
    d->index16 = fz_bool(f);
    d->first = fz_below(f, 8) ? 0 : fz_count(f);
    d->count = fz_below(f, 8) ? 3 * fz_below(f, 24) : fz_below(f, 3000);
    d->base_vertex = fz_below(f, 8) ? 0 : (int32_t)fz_count(f);
    d->instances = fz_below(f, 8) ? 1 : fz_below(f, 4);
    for (int i = 0; i < HL_MAX_UNIFORMS; i++)
        d->uniform[i] = some_range(w, 2);
    for (int i = 0; i < HL_MAX_STORAGE; i++)
        d->storage[i] = some_range(w, 3);
    for (int i = 0; i < HL_MAX_TEXTURES; i++) {
        memset(&bound[i], 0, sizeof bound[i]);
        uint32_t t = fz_below(f, TEXTURES);
        if (!(w->bound >> t & 1) || fz_byte(f) == 255)
            bound[i].tex = w->tex[t];
        bound[i].filter = (uint8_t)(fz_below(f, 8) ? 0 : fz_below(f, 3));
        bound[i].wrap_u = (uint8_t)fz_below(f, 3);
        bound[i].wrap_v = (uint8_t)fz_below(f, 3);
    }
    d->textures = bound;
    d->n_textures = fz_below(f, HL_MAX_TEXTURES + 1);
    if (fz_bool(f)) {
        d->scissor.x = (int32_t)fz_below(f, SIDE) - 20;
        d->scissor.y = (int32_t)fz_below(f, SIDE) - 20;
        d->scissor.width = (int32_t)fz_below(f, SIDE);
        d->scissor.height = (int32_t)fz_below(f, SIDE);
    }
}

static bool is_depth(const struct world *w, uint32_t i)
{
    return hl_format_info(w->desc[i].format)->kind == HL_KIND_DEPTH;
}

static void some_target(struct world *w, struct hl_target *t, uint32_t i)
{
    struct fz *f = w->f;
    t->tex = w->tex[i];
    w->bound |= 1u << i;
    t->load = (enum hl_load)fz_below(f, 3);
    t->discard = fz_byte(f) > 240;
    for (int c = 0; c < 4; c++)
        t->clear[c] = is_depth(w, i) ? (float)fz_below(f, 2) : fz_number(f);
    if (w->desc[i].samples > 1 && fz_bool(f))
        t->resolve = w->tex[fz_below(f, TEXTURES)];
}

/* Up to four colour targets like the first that comes, and a depth target. */
static bool some_targets(struct world *w, struct hl_pass *p, uint32_t *color,
                         uint32_t *depth)
{
    const struct hl_tex_desc *first = NULL;
    bool has_depth = false;
    uint32_t most = fz_below(w->f, 5), start = fz_below(w->f, TEXTURES);
    for (uint32_t n = 0; n < TEXTURES; n++) {
        uint32_t i = (start + n) % TEXTURES;
        const struct hl_tex_desc *d = &w->desc[i];
        if (!w->tex[i].id || (first && (d->samples != first->samples ||
            d->width != first->width || d->height != first->height)))
            continue;
        if (is_depth(w, i) && !has_depth) {
            *depth = i;
            some_target(w, &p->depth, i);
            has_depth = true;
        } else if (!is_depth(w, i) && p->n_colors < most) {
            color[p->n_colors] = i;
            some_target(w, &p->color[p->n_colors++], i);
        } else {
            continue;
        }
        first = d;
    }
    p->depth_read_only = has_depth && fz_byte(w->f) > 200;
    return has_depth;
}

static void some_pass(struct world *w)
{
    struct hl_pass p;
    struct hl_draw draw[DRAWS];
    struct hl_texture_binding bound[DRAWS][HL_MAX_TEXTURES];
    uint32_t color[HL_MAX_COLORS] = { 0 }, depth = 0;
    memset(&p, 0, sizeof p);
    memset(draw, 0, sizeof draw);
    p.label = "fuzz";
    p.half_pixel_offset =
        hl_device_caps(w->device)->profile.integer_centers && fz_bool(w->f);
    w->bound = 0;
    bool has_depth = some_targets(w, &p, color, &depth);
    p.draws = draw;
    p.n_draws = fz_below(w->f, DRAWS + 1);
    for (uint32_t i = 0; i < p.n_draws; i++) {
        some_draw(w, &draw[i], bound[i]);
        draw[i].prog = some_program(w, &p, color, has_depth ? &depth : NULL);
    }
    hl_pass_run(w->device, &p);
    for (uint32_t i = 0; i < p.n_draws; i++)
        hl_prog_destroy(w->device, &draw[i].prog);
}

/* ---- runs ---------------------------------------------------------------- */

static uint64_t hash(uint64_t h, const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++)
        h = (h ^ bytes[i]) * 0x100000001b3u;
    return h;
}

static uint64_t read_all(struct world *w)
{
    static uint32_t texels[SIDE * SIDE * 4];
    uint64_t h = 0xcbf29ce484222325u;
    for (int i = 0; i < TEXTURES; i++) {
        const struct hl_tex_desc *d = &w->desc[i];
        size_t n, texel = hl_format_info(d->format)->bytes;
        if (hl_format_info(d->format)->kind == HL_KIND_DEPTH)
            texel = sizeof(float);
        n = texel * d->width * d->height;
        if (hl_tex_read(w->device, w->tex[i], texels, n) == HL_OK)
            h = hash(h, (const uint8_t *)texels, n);
        const uint8_t *m = hl_packemu_memory(w->device, w->tex[i], &n);
        h = m ? hash(h, m, n) : h;
    }
    return h;
}

static uint64_t run(const uint8_t *data, size_t size, uint32_t threads)
{
    struct fz f = { data, data + size };
    struct world w;
    struct hl_profile profile;
    struct hl_device_desc d;
    const struct hl_packemu_native native = { threads };
    memset(&w, 0, sizeof w);
    memset(&d, 0, sizeof d);
    w.f = &f;
    fz_profile(&f, &profile, fz_byte(&f) < 250);
    d.version = HL_VERSION;
    d.hooks.alloc = take;
    d.hooks.free = give;
    d.hooks.user = &w;
    d.native = &native;
    d.max_textures = d.max_buffers = d.max_programs = 16;
    d.profile = fz_below(&f, 8) ? &profile : NULL;
    if (hl_device_open(&w.device, &hl_backend_packemu, &d) != HL_OK)
        return 0;
    w.width = 1 + fz_below(&f, SIDE);
    w.height = 1 + fz_below(&f, SIDE);
    make_buffers(&w);
    for (uint32_t i = 0; i < TEXTURES; i++) {
        make_texture(&w, i);
        if (w.tex[i].id && fz_bool(&f))
            write_texture(&w, i);
    }
    for (uint32_t n = fz_below(&f, PASSES + 1); n > 0; n--)
        some_pass(&w);
    hl_submit(w.device, true);
    uint64_t h = read_all(&w);
    hl_device_close(&w.device);
    FZ_CHECK(w.live == 0);
    return h;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FZ_CHECK(run(data, size, 1) == run(data, size, 3));
    return 0;
}
