/* SPDX-License-Identifier: Zlib */
/* Passes and draws on every backend: each rule of hal/pass.c once broken and
 * once just kept, nothing recorded when refused; then what passes do to their
 * targets, on backends that draw. */
#include <string.h>
#include "platforms/platforms.h"
#include "tests/check.h"
#include "tests/solid_kernel.h"

static const uint32_t solid_spirv[] = {
#include "solid_frag.x"
};
static const char solid_glsl[] = {
#include "solid_frag_glsl.x"
};

enum { W = 8, H = 4, SLOT = 256 };

/* A device with one of everything, and a pass that is right. */
struct stage {
    struct ck_machine *m;
    hl_tex color, other, depth, ms, small, stamp;
    hl_buf vertex, index, uniform, storage;
    hl_prog prog;
    struct hl_texture_binding texture[HL_MAX_TEXTURES];
    struct hl_draw draw[2];
    struct hl_pass pass;
};

static hl_tex tex(struct ck_machine *m, enum hl_format f, uint32_t w,
                  uint32_t samples, uint32_t usage)
{
    struct hl_tex_desc d = { .label = "t", .format = f, .width = w,
                             .height = H, .samples = samples,
                             .usage = usage };
    hl_tex t;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    return t;
}

static hl_buf buf(struct ck_machine *m, size_t bytes, uint32_t usage)
{
    static const float zero[1024] = { 0 };
    struct hl_buf_desc d = { "b", bytes, usage, true, zero };
    hl_buf b;
    assert_int_equal(hl_buf_create(m->device, &b, &d), HL_OK);
    return b;
}

static struct hl_prog_desc solid(void)
{
    static struct hl_code code = { solid_spirv, sizeof solid_spirv,
                                   solid_glsl, NULL };
    code.kernel = solid_kernel();
    struct hl_prog_desc p = {
        .label = "solid", .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_NONE, &code }, .n_colors = 1,
        .color = { HL_FORMAT_RGBA32_FLOAT }, .depth = HL_FORMAT_D32_FLOAT };
    return p;
}

static hl_prog make_prog(struct ck_machine *m, const struct hl_prog_desc *d)
{
    hl_prog p;
    assert_int_equal(hl_prog_create(m->device, &p, d), HL_OK);
    return p;
}

static void set_up_draw(struct stage *s)
{
    struct hl_draw *d = &s->draw[0];
    d->prog = s->prog;
    d->vertex[0] = s->vertex;
    d->index = s->index;
    d->count = 3;
    d->uniform[0].buf = s->uniform;
    d->uniform[0].bytes = 16;
    d->storage[0].buf = s->storage;
    d->storage[0].bytes = 16;
    d->textures = s->texture;
    d->n_textures = 1;
    s->texture[0].tex = s->stamp;
    s->draw[1] = s->draw[0];
    s->pass.label = "stage";
    s->pass.n_colors = 1;
    s->pass.color[0].tex = s->color;
    s->pass.color[0].load = HL_LOAD_CLEAR;
    s->pass.depth.tex = s->depth;
    s->pass.depth.load = HL_LOAD_CLEAR;
    s->pass.draws = s->draw;
    s->pass.n_draws = 2;
}

static void begin(struct stage *s, void **state)
{
    enum { TARGET = HL_TEX_TARGET | HL_TEX_SAMPLED | HL_TEX_READBACK };
    static const uint32_t indices[3] = { 0, 1, 2 };
    float white[W * H * 4];
    memset(s, 0, sizeof *s);
    for (int i = 0; i < W * H * 4; i++)
        white[i] = 1;
    struct ck_machine *m = s->m = ck_machine(state);
    s->color = tex(m, HL_FORMAT_RGBA32_FLOAT, W, 1, TARGET);
    s->other = tex(m, HL_FORMAT_RGBA32_FLOAT, W, 1, TARGET);
    s->depth = tex(m, HL_FORMAT_D32_FLOAT, W, 1, TARGET);
    s->ms = tex(m, HL_FORMAT_RGBA32_FLOAT, W, 4, HL_TEX_TARGET);
    s->small = tex(m, HL_FORMAT_RGBA32_FLOAT, W / 2, 1, TARGET);
    s->stamp = tex(m, HL_FORMAT_RGBA32_FLOAT, W, 1, HL_TEX_SAMPLED);
    assert_int_equal(hl_tex_write(m->device, s->stamp, 0, white,
                                  sizeof white), HL_OK);
    s->vertex = buf(m, 64, HL_BUF_VERTEX);
    s->index = buf(m, sizeof indices, HL_BUF_INDEX);
    assert_int_equal(hl_buf_write(m->device, s->index, 0, indices,
                                  sizeof indices), HL_OK);
    s->uniform = buf(m, SLOT * 4, HL_BUF_UNIFORM);
    s->storage = buf(m, SLOT * 4, HL_BUF_STORAGE);
    struct hl_prog_desc p = solid();
    s->prog = make_prog(m, &p);
    set_up_draw(s);
}

/* ---- refusing and allowing -------------------------------------------- */

static void run_refused(struct stage *s, enum hl_log_id id, const char *part)
{
    struct hl_counts before = hl_device_counts(s->m->device), after;
    CK_REFUSED(s->m, hl_pass_run(s->m->device, &s->pass), HL_ERR_INVALID, id,
               part);
    after = hl_device_counts(s->m->device);
    assert_memory_equal(&before, &after, sizeof before);
    set_up_draw(s);
}

static void run_allowed(struct stage *s)
{
    CK_ALLOWED(s->m, hl_pass_run(s->m->device, &s->pass));
    set_up_draw(s);
}

/* Set one field of a right pass; run; all is set right again. */
#define BAD(field, value, id, part)              \
    do {                                         \
        s.field = value;                         \
        run_refused(&s, id, part);               \
        memset(&s.pass, 0, sizeof s.pass);       \
        memset(s.draw, 0, sizeof s.draw);        \
        memset(s.texture, 0, sizeof s.texture);  \
        set_up_draw(&s);                         \
    } while (0)
#define FINE(field, value)                       \
    do {                                         \
        s.field = value;                         \
        run_allowed(&s);                         \
        memset(&s.pass, 0, sizeof s.pass);       \
        memset(s.draw, 0, sizeof s.draw);        \
        memset(s.texture, 0, sizeof s.texture);  \
        set_up_draw(&s);                         \
    } while (0)

static hl_tex stale_tex(struct stage *s)
{
    hl_tex t = tex(s->m, HL_FORMAT_RGBA32_FLOAT, W, 1, HL_TEX_TARGET), old = t;
    hl_tex_destroy(s->m->device, &t);
    return old;
}

static hl_buf stale_buf(struct stage *s)
{
    hl_buf b = buf(s->m, 1024, 15), old = b;
    hl_buf_destroy(s->m->device, &b);
    return old;
}

static void targets_are_checked(void **state)
{
    struct stage s;
    begin(&s, state);
    run_allowed(&s);
    assert_int_equal(hl_pass_run(NULL, &s.pass), HL_ERR_INVALID);
    assert_int_equal(hl_pass_run(s.m->device, NULL), HL_ERR_INVALID);
    BAD(pass.color[0].tex, stale_tex(&s), HL_MSG_HANDLE, "hl_pass target");
    BAD(pass.color[0].tex.id, 0, HL_MSG_HANDLE, "hl_pass target");
    BAD(pass.color[0].tex, s.stamp, HL_MSG_ARGUMENT, "not made for this use");
    BAD(pass.color[0].tex, s.depth, HL_MSG_ARGUMENT, "not made for this use");
    BAD(pass.depth.tex, s.color, HL_MSG_ARGUMENT, "not made for this use");
    BAD(pass.depth.tex, stale_tex(&s), HL_MSG_HANDLE, "hl_pass target");
    BAD(pass.color[0].tex, s.small, HL_MSG_ARGUMENT, "size or sample count");
    BAD(pass.color[0].tex, s.ms, HL_MSG_ARGUMENT, "size or sample count");
    BAD(pass.color[0].load, (enum hl_load)3, HL_MSG_ARGUMENT,
        "hl_target.load");
    BAD(pass.n_colors, HL_MAX_COLORS + 1, HL_MSG_ARGUMENT, "n_colors: 9");
    s.pass.n_colors = 2;
    BAD(pass.color[1].tex, s.color, HL_MSG_ARGUMENT, "already");
    s.pass.depth_read_only = true;
    BAD(pass.depth.load, HL_LOAD_CLEAR, HL_MSG_ARGUMENT, "hl_pass.depth");
    s.pass.depth_read_only = true;
    BAD(pass.depth.load, HL_LOAD_DISCARD, HL_MSG_ARGUMENT, "hl_pass.depth");
    s.pass.depth_read_only = true;
    FINE(pass.depth.load, HL_LOAD_KEEP);
    s.pass.n_colors = 0;
    s.pass.n_draws = 0;
    BAD(pass.depth.tex.id, 0, HL_MSG_ARGUMENT, "no target");
    s.pass.n_colors = 0;
    FINE(pass.n_draws, 0);
    s.pass.n_draws = 0;
    FINE(pass.label, NULL);
}

static void resolves_are_checked(void **state)
{
    struct stage s;
    begin(&s, state);
    hl_tex half = tex(s.m, HL_FORMAT_RGBA16_FLOAT, W, 1, HL_TEX_TARGET);
    hl_tex more = tex(s.m, HL_FORMAT_RGBA32_FLOAT, W, 4, HL_TEX_TARGET);
    static const char bad[] = "hl_target.resolve";
    for (int i = 0; i < 7; i++) {
        memset(&s.pass, 0, sizeof s.pass);
        s.pass.n_colors = 1;
        s.pass.color[0].tex = i == 0 ? s.color : s.ms;
        s.pass.color[0].load = HL_LOAD_CLEAR;
        s.pass.color[0].resolve = i == 1 ? stale_tex(&s) : i == 2 ? s.small
                                  : i == 3 ? half : i == 4 ? s.stamp
                                  : i == 5 ? more : s.other;
        if (i == 6)
            break;
        run_refused(&s, i < 2 ? HL_MSG_HANDLE : HL_MSG_ARGUMENT, bad);
        s.pass.n_draws = 0;
    }
    s.pass.n_draws = 0;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    /* Two targets that resolve to one. */
    s.pass.n_colors = 2;
    s.pass.color[1] = s.pass.color[0];
    s.pass.color[1].tex = more;
    CK_REFUSED(s.m, hl_pass_run(s.m->device, &s.pass), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_pass.color: 1");
}

static void programs_fit_their_pass(void **state)
{
    struct stage s;
    begin(&s, state);
    static const char why[] = "hl_pass.draws: 1: ";
    hl_prog old = s.prog;
    struct hl_prog_desc p = solid();
    p.color[0] = HL_FORMAT_RGBA16_FLOAT;
    BAD(draw[1].prog, make_prog(s.m, &p), HL_MSG_ARGUMENT, why);
    p = solid();
    p.depth = HL_FORMAT_NONE;
    BAD(draw[1].prog, make_prog(s.m, &p), HL_MSG_ARGUMENT, why);
    p = solid();
    p.depth = HL_FORMAT_D16_UNORM;
    BAD(draw[1].prog, make_prog(s.m, &p), HL_MSG_ARGUMENT, why);
    p = solid();
    p.samples = 4;
    BAD(draw[1].prog, make_prog(s.m, &p), HL_MSG_ARGUMENT, why);
    p = solid();
    p.n_colors = 2;
    p.color[1] = p.color[0];
    BAD(draw[1].prog, make_prog(s.m, &p), HL_MSG_ARGUMENT, why);
    p = solid();
    p.depth_test = HL_COMPARE_ALWAYS;
    p.depth_write = true;
    hl_prog writes = make_prog(s.m, &p);
    FINE(draw[1].prog, writes);
    s.pass.depth_read_only = true;
    s.pass.depth.load = HL_LOAD_KEEP;
    BAD(draw[1].prog, writes, HL_MSG_ARGUMENT, why);
    hl_prog_destroy(s.m->device, &s.prog);
    s.draw[0].prog = writes;
    s.draw[1].prog = old;
    CK_REFUSED(s.m, hl_pass_run(s.m->device, &s.pass), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_pass.draws: 1: not a live program");
}

static void draws_stay_inside_their_indices(void **state)
{
    struct stage s;
    begin(&s, state);
    static const char past[] = "hl_pass.draws: 1: indices end past";
    BAD(draw[1].count, 4, HL_MSG_ARGUMENT, past);
    BAD(draw[1].first, 1, HL_MSG_ARGUMENT, past);
    BAD(draw[1].first, 4, HL_MSG_ARGUMENT, past);
    s.draw[1].first = 0xffffffff;
    BAD(draw[1].count, 4, HL_MSG_ARGUMENT, past);
    s.draw[1].first = 3;
    FINE(draw[1].count, 0);
    s.draw[1].index16 = true;           /* 12 bytes are six of those         */
    FINE(draw[1].count, 6);
    s.draw[1].index16 = true;
    BAD(draw[1].count, 7, HL_MSG_ARGUMENT, past);
    BAD(draw[1].index, s.uniform, HL_MSG_ARGUMENT, "index buffer");
    BAD(draw[1].index, stale_buf(&s), HL_MSG_ARGUMENT, "index buffer");
    BAD(draw[1].vertex[0], s.uniform, HL_MSG_ARGUMENT, "vertex buffer");
    BAD(draw[1].vertex[3], stale_buf(&s), HL_MSG_ARGUMENT, "vertex buffer");
    FINE(draw[1].vertex[3], s.vertex);
    FINE(draw[1].vertex[0].id, 0);
    FINE(draw[1].index.id, 0);
    FINE(draw[1].instances, 2);
    struct hl_prog_desc p = solid();
    p.layout.attr[0].format = HL_ATTR_F32X3;
    p.layout.attr[0].stream = 2;
    p.layout.stride[2] = 12;
    hl_prog reads = make_prog(s.m, &p);
    BAD(draw[1].prog, reads, HL_MSG_ARGUMENT, "a stream that is not bound");
    s.draw[1].vertex[2] = s.vertex;
    FINE(draw[1].prog, reads);
    s.pass.draws = NULL;
    assert_int_equal(hl_pass_run(s.m->device, &s.pass), HL_ERR_INVALID);
    FINE(pass.n_draws, 0);
    s.pass.n_draws = 0x1000001;         /* refused before they are looked at */
    CK_REFUSED(s.m, hl_pass_run(s.m->device, &s.pass), HL_ERR_MEMORY,
               HL_MSG_MEMORY, "hl_pass.n_draws");
    struct hl_timing timing;
    assert_int_equal(hl_timings(NULL, &timing, 1), 0);
    assert_int_equal(hl_timings(s.m->device, NULL, 1), 0);
}

static void ranges_are_checked(void **state)
{
    struct stage s;
    begin(&s, state);
    const struct hl_caps *c = hl_device_caps(s.m->device);
    static const char u[] = "hl_pass.draws: 1: a uniform range";
    static const char t[] = "hl_pass.draws: 1: a storage range";
    BAD(draw[1].uniform[0].buf, stale_buf(&s), HL_MSG_ARGUMENT, u);
    BAD(draw[1].uniform[0].buf, s.storage, HL_MSG_ARGUMENT, u);
    BAD(draw[1].uniform[0].bytes, 0, HL_MSG_ARGUMENT, u);
    BAD(draw[1].uniform[0].bytes, c->max_uniform_bytes + 1, HL_MSG_ARGUMENT,
        u);
    BAD(draw[1].uniform[0].bytes, SLOT * 4 + 1, HL_MSG_ARGUMENT, u);
    FINE(draw[1].uniform[0].bytes, SLOT * 4);
    BAD(draw[1].uniform[0].offset, 1, HL_MSG_ARGUMENT, u);
    BAD(draw[1].uniform[0].offset, SLOT * 4, HL_MSG_ARGUMENT, u);
    FINE(draw[1].uniform[0].offset, SLOT * 3);
    s.draw[1].uniform[0].offset = SLOT * 3;
    BAD(draw[1].uniform[0].bytes, SLOT + 1, HL_MSG_ARGUMENT, u);
    BAD(draw[1].uniform[3].buf, stale_buf(&s), HL_MSG_ARGUMENT, u);
    BAD(draw[1].storage[0].buf, stale_buf(&s), HL_MSG_ARGUMENT, t);
    BAD(draw[1].storage[0].buf, s.uniform, HL_MSG_ARGUMENT, t);
    BAD(draw[1].storage[0].bytes, 0, HL_MSG_ARGUMENT, t);
    BAD(draw[1].storage[0].bytes, SLOT * 4 + 1, HL_MSG_ARGUMENT, t);
    FINE(draw[1].storage[0].bytes, SLOT * 4);
    BAD(draw[1].storage[0].offset, 1, HL_MSG_ARGUMENT, t);
    BAD(draw[1].storage[1].buf, stale_buf(&s), HL_MSG_ARGUMENT, t);
    FINE(draw[1].storage[1].offset, 1);         /* no buffer: not read       */
}

static void textures_are_checked(void **state)
{
    struct stage s;
    begin(&s, state);
    static const char own[] = "samples a target of its own pass";
    BAD(draw[1].n_textures, HL_MAX_TEXTURES + 1, HL_MSG_ARGUMENT,
        "n_textures");
    FINE(draw[1].n_textures, HL_MAX_TEXTURES);
    BAD(draw[1].textures, NULL, HL_MSG_ARGUMENT, "n_textures");
    BAD(texture[0].filter, HL_FILTER_TRILINEAR + 1, HL_MSG_ARGUMENT,
        "unknown filter");
    BAD(texture[0].wrap_u, HL_WRAP_MIRROR + 1, HL_MSG_ARGUMENT, "wrap");
    BAD(texture[0].wrap_v, HL_WRAP_MIRROR + 1, HL_MSG_ARGUMENT, "wrap");
    BAD(texture[0].tex, stale_tex(&s), HL_MSG_ARGUMENT, "stale");
    BAD(texture[0].tex, s.ms, HL_MSG_ARGUMENT, "not made to be sampled");
    BAD(texture[0].tex, s.color, HL_MSG_ARGUMENT, own);
    BAD(texture[0].tex, s.depth, HL_MSG_ARGUMENT, own);
    s.pass.depth_read_only = true;
    s.pass.depth.load = HL_LOAD_KEEP;
    FINE(texture[0].tex, s.depth);
    FINE(texture[0].tex, s.other);
    FINE(texture[0].tex.id, 0);
    hl_tex whole = tex(s.m, HL_FORMAT_R32_UINT, W, 1, HL_TEX_SAMPLED);
    s.texture[0].tex = whole;            /* integers are fetched only        */
    BAD(texture[0].filter, HL_FILTER_LINEAR, HL_MSG_ARGUMENT, "only fetches");
    FINE(texture[0].filter, HL_FILTER_TRILINEAR);
    struct hl_prog_desc p = solid();
    p.samples = 4;
    p.depth = HL_FORMAT_NONE;
    s.draw[0].prog = s.draw[1].prog = make_prog(s.m, &p);
    s.pass.depth.tex.id = 0;
    s.pass.color[0].tex = s.ms;
    s.pass.color[0].resolve = s.other;
    BAD(texture[0].tex, s.other, HL_MSG_ARGUMENT, own);
}

static void the_refused_draw_is_named(void **state)
{
    struct stage s;
    begin(&s, state);
    struct hl_draw many[40];
    for (int i = 0; i < 40; i++)
        many[i] = s.draw[0];
    many[37].count = 4;
    s.pass.draws = many;
    s.pass.n_draws = 40;
    run_refused(&s, HL_MSG_ARGUMENT, "hl_pass.draws: 37: ");
    many[37].count = 3;
    s.pass.draws = many;
    s.pass.n_draws = 40;
    run_allowed(&s);
}

static void empty_draws_are_left_out(void **state)
{
    struct stage s;
    begin(&s, state);
    struct hl_counts a = hl_device_counts(s.m->device), b;
    s.draw[0].count = 0;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    set_up_draw(&s);
    static const struct hl_rect out[] = { { 8, 0, 1, 1 }, { 0, 4, 4, 4 },
        { -5, 0, 5, 4 }, { 0, -1, 8, 1 }, { 0, 0, 4, 0 }, { 3, 3, -2, 1 } };
    for (int i = 0; i < 6; i++) {
        s.draw[0].scissor = out[i];
        CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    }
    b = hl_device_counts(s.m->device);
    assert_int_equal(b.passes - a.passes, 7);
    assert_int_equal(b.draws - a.draws, 7);
    assert_int_equal(b.triangles - a.triangles, 7);
    s.draw[0].scissor.width = 0;
    s.draw[0].instances = 5;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    assert_int_equal(hl_device_counts(s.m->device).triangles, b.triangles + 6);
    assert_int_equal(hl_submit(NULL, true), HL_ERR_INVALID);
}

/* ---- what passes do --------------------------------------------------- */

static void put(struct stage *s, uint32_t slot, float r, float g, float b,
                float a)
{
    const float v[4] = { r, g, b, a };
    assert_int_equal(hl_buf_write(s->m->device, s->uniform, slot * SLOT, v,
                                  sizeof v), HL_OK);
}

static void check_pixel(struct stage *s, int x, int y, float r, float g,
                        float b, float a)
{
    float px[W * H][4];
    const float want[4] = { r, g, b, a };
    assert_int_equal(hl_tex_read(s->m->device, s->color, px, sizeof px),
                     HL_OK);
    for (int c = 0; c < 4; c++)
        /* Blending of these values is exact in 32 bits. */
        ck_near((double)px[y * W + x][c], (double)want[c], 0);
}

static void a_scissor_cuts_and_is_cut(void **state)
{
    struct stage s;
    begin(&s, state);
    static const struct hl_rect rect[] = { { 2, 1, 3, 2 }, { -2, -2, 4, 3 },
        { 6, 3, 100, 100 }, { 0, 0, 0, 0 } };
    put(&s, 0, 1, 1, 1, 1);
    s.pass.n_draws = 1;
    for (int i = 0; i < 4; i++) {
        float px[W * H][4];
        const struct hl_rect *r = &rect[i];
        s.draw[0].scissor = *r;
        CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
        assert_int_equal(hl_tex_read(s.m->device, s.color, px, sizeof px),
                         HL_OK);
        for (int k = 0; k < W * H; k++) {
            int x = k % W, y = k / W;
            bool in = r->width == 0 || (x >= r->x && x < r->x + r->width &&
                                        y >= r->y && y < r->y + r->height);
            ck_near((double)px[k][0], in ? 1 : 0, 0);
        }
    }
}

static void blending_is_as_stated(void **state)
{
    struct stage s;
    begin(&s, state);
    /* Under (1, 2, 4, 0.5) comes (0.5, 4, 1, 0.25). */
    static const struct { enum hl_blend blend; float want[4]; } row[] = {
        { HL_BLEND_OFF, { 0.5f, 4, 1, 0.25f } },
        { HL_BLEND_ADD, { 1.5f, 6, 5, 0.75f } },
        { HL_BLEND_OVER, { 0.875f, 2.5f, 3.25f, 0.625f } },
        { HL_BLEND_ADD_ALPHA, { 1.125f, 3, 4.25f, 0.5f } },
        { HL_BLEND_MAX, { 1, 4, 4, 0.5f } },
        { HL_BLEND_SHIFT, { 1, 5, 3, 0.5f } },     /* by one half            */
    };
    static const float under[4] = { 1, 2, 4, 0.5f };
    put(&s, 1, 0.5f, 4, 1, 0.25f);
    for (int i = 0; i < 6; i++) {
        struct hl_prog_desc p = solid();
        p.blend = row[i].blend;
        p.blend_constant = 0.5f;
        s.draw[0].prog = make_prog(s.m, &p);
        s.draw[0].uniform[0].offset = SLOT;
        memcpy(s.pass.color[0].clear, under, sizeof under);
        s.pass.n_draws = 1;
        CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
        const float *w = row[i].want;
        check_pixel(&s, 3, 2, w[0], w[1], w[2], w[3]);
    }
    struct hl_prog_desc p = solid();
    p.no_color_write = true;
    s.draw[0].prog = make_prog(s.m, &p);
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    check_pixel(&s, 3, 2, 1, 2, 4, 0.5f);
}

static void draws_see_their_own_ranges(void **state)
{
    struct stage s;
    begin(&s, state);
    const float add[4] = { 100, 0, 0, 0 };
    put(&s, 2, 2, 0, 0, 1);
    put(&s, 3, 3, 0, 0, 1);
    assert_int_equal(hl_buf_write(s.m->device, s.storage, SLOT, add,
                                  sizeof add), HL_OK);
    s.draw[0].uniform[0].offset = 2 * SLOT;
    s.draw[1].uniform[0].offset = 3 * SLOT;
    s.draw[1].scissor.width = 4;
    s.draw[1].scissor.height = H;
    s.draw[1].storage[0].offset = SLOT;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    check_pixel(&s, 6, 1, 2, 0, 0, 1);
    check_pixel(&s, 1, 1, 103, 0, 0, 1);
    /* An absent texture is white, as the stamp is. */
    s.texture[0].tex.id = 0;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    check_pixel(&s, 1, 1, 103, 0, 0, 1);
}

static void targets_are_kept_or_cleared(void **state)
{
    struct stage s;
    begin(&s, state);
    put(&s, 0, 1, 0, 0, 1);
    struct hl_prog_desc p = solid();
    p.blend = HL_BLEND_ADD;
    s.draw[0].prog = s.draw[1].prog = make_prog(s.m, &p);
    for (int i = 0; i < 3; i++) {
        s.pass.color[0].load = i ? HL_LOAD_KEEP : HL_LOAD_CLEAR;
        CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
        if (i == 1)
            assert_int_equal(hl_submit(s.m->device, false), HL_OK);
    }
    check_pixel(&s, 0, 0, 6, 0, 0, 6);
    float z[W * H];
    s.pass.n_draws = 0;
    s.pass.depth.clear[0] = 0.375f;
    CK_ALLOWED(s.m, hl_pass_run(s.m->device, &s.pass));
    assert_int_equal(hl_tex_read(s.m->device, s.depth, z, sizeof z), HL_OK);
    for (int i = 0; i < W * H; i++)
        assert_true(z[i] == 0.375f);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)
#define ALL(name) CK_ON("null", name), DRAWN(name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ALL(targets_are_checked),
        ALL(resolves_are_checked),
        ALL(programs_fit_their_pass),
        ALL(draws_stay_inside_their_indices),
        ALL(ranges_are_checked),
        ALL(textures_are_checked),
        ALL(the_refused_draw_is_named),
        ALL(empty_draws_are_left_out),
        DRAWN(a_scissor_cuts_and_is_cut),
        DRAWN(blending_is_as_stated),
        DRAWN(draws_see_their_own_ranges),
        DRAWN(targets_are_kept_or_cleared),
    };
    return cmocka_run_group_tests_name("passes", tests, NULL, NULL);
}
