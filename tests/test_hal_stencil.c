/* SPDX-License-Identifier: Zlib */
/* Stencil and shift blending on every backend that draws, against a software
 * oracle: random state on rectangles at pixel borders, so that coverage is
 * exact, at depths that every format keeps in order. Built-in stages alone. */
#include <string.h>
#include "tests/check.h"

enum { W = 16, H = 16, PIXELS = W * H, DRAWS = 128, A_PASS = 8 };

/* ---- the oracle --------------------------------------------------------- */

struct rect { int x0, y0, x1, y1; float z; bool back; };

/* One draw: a rectangle of each winding. */
struct shot { struct hl_prog_desc p; struct rect r[2]; };

struct oracle {
    uint8_t stencil[PIXELS];
    float depth[PIXELS], count[PIXELS];
    /* What was exercised: [face][outcome][op]; clamps and wraps. */
    uint32_t used[2][3][8], edge[4];
};

static bool compare(enum hl_compare test, float a, float b)
{
    switch (test) {
    case HL_COMPARE_NEVER: return false;
    case HL_COMPARE_LESS: return a < b;
    case HL_COMPARE_LESS_EQUAL: return a <= b;
    case HL_COMPARE_EQUAL: return a == b;
    case HL_COMPARE_GREATER_EQUAL: return a >= b;
    case HL_COMPARE_GREATER: return a > b;
    default: return true;
    }
}

static uint8_t operate(struct oracle *o, enum hl_stencil_op op, uint8_t s,
                       uint8_t ref)
{
    o->edge[0] += op == HL_STENCIL_INCREMENT && s == 255;
    o->edge[1] += op == HL_STENCIL_DECREMENT && s == 0;
    o->edge[2] += op == HL_STENCIL_INCREMENT_WRAP && s == 255;
    o->edge[3] += op == HL_STENCIL_DECREMENT_WRAP && s == 0;
    switch (op) {
    case HL_STENCIL_ZERO: return 0;
    case HL_STENCIL_REPLACE: return ref;
    case HL_STENCIL_INCREMENT: return (uint8_t)(s == 255 ? s : s + 1);
    case HL_STENCIL_DECREMENT: return (uint8_t)(s == 0 ? s : s - 1);
    case HL_STENCIL_INCREMENT_WRAP: return (uint8_t)(s + 1);
    case HL_STENCIL_DECREMENT_WRAP: return (uint8_t)(s - 1);
    case HL_STENCIL_INVERT: return (uint8_t)~s;
    default: return s;
    }
}

static void fragment(struct oracle *o, const struct hl_prog_desc *p,
                     bool back, float z, int i)
{
    const struct hl_stencil *s = &p->stencil;
    const struct hl_stencil_face *f = back ? &s->back : &s->front;
    uint8_t read = s->read_mask ? s->read_mask : 255;
    uint8_t write = s->write_mask ? s->write_mask : 255;
    bool on = s->front.test != HL_COMPARE_OFF || s->back.test != HL_COMPARE_OFF;
    bool depth = compare(p->depth_test, z, o->depth[i]);
    bool test = !on || compare(f->test, (float)(s->reference & read),
                               (float)(o->stencil[i] & read));
    int outcome = !test ? 0 : !depth ? 1 : 2;
    enum hl_stencil_op op = outcome == 0 ? f->fail
                          : outcome == 1 ? f->depth_fail : f->pass;
    if (on) {
        uint8_t to = operate(o, op, o->stencil[i], s->reference);
        o->stencil[i] = (uint8_t)((o->stencil[i] & ~write) | (to & write));
        o->used[back][outcome][op]++;
    }
    if (outcome < 2)
        return;
    if (p->depth_test != HL_COMPARE_OFF && p->depth_write)
        o->depth[i] = z;
    o->count[i] += p->no_color_write ? 0 : 1;
}

static void shoot(struct oracle *o, const struct shot *s)
{
    for (int k = 0; k < 2; k++) {
        const struct rect *r = &s->r[k];
        bool back = r->back != s->p.mirrored;
        if (s->p.cull == (back ? HL_CULL_BACK : HL_CULL_FRONT))
            continue;
        for (int y = r->y0; y < r->y1; y++)
            for (int x = r->x0; x < r->x1; x++)
                fragment(o, &s->p, back, r->z, y * W + x);
    }
}

/* ---- random draws ------------------------------------------------------- */

static struct hl_stencil_face random_face(uint64_t *seed)
{
    struct hl_stencil_face f;
    f.test = (enum hl_compare)(HL_COMPARE_NEVER + mk_below(seed, 7));
    f.fail = (enum hl_stencil_op)mk_below(seed, 8);
    f.depth_fail = (enum hl_stencil_op)mk_below(seed, 8);
    f.pass = (enum hl_stencil_op)mk_below(seed, 8);
    return f;
}

static uint8_t random_mask(uint64_t *seed)
{
    static const uint8_t mask[] = { 0, 0, 0, 0xff, 0x0f, 0xf0, 0x01, 0x5a };
    return mask[mk_below(seed, 8)];
}

/* Eighths of depth are exact in floats, and stay in order in 24 bits. */
static struct rect random_rect(uint64_t *seed, bool back)
{
    struct rect r;
    r.x0 = (int)mk_below(seed, W / 2);
    r.y0 = (int)mk_below(seed, H / 2);
    r.x1 = r.x0 + 1 + (int)mk_below(seed, W / 2);
    r.y1 = r.y0 + 1 + (int)mk_below(seed, H / 2);
    r.z = (float)(1 + mk_below(seed, 7)) / 8;
    r.back = back;
    return r;
}

static void random_shot(struct shot *s, uint64_t *seed, enum hl_format depth)
{
    static const uint8_t reference[] = { 0, 1, 2, 127, 128, 254, 255, 90 };
    memset(s, 0, sizeof *s);
    struct hl_prog_desc *p = &s->p;
    p->label = "stencil";
    p->vertex.builtin = HL_SHADER_MESH_ID_VERT;
    p->fragment.builtin = HL_SHADER_COUNT_FRAG;
    p->layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
    p->layout.stride[0] = 12;
    p->n_colors = 1;
    p->color[0] = HL_FORMAT_R32_FLOAT;
    p->blend = HL_BLEND_ADD;
    p->depth = depth;
    p->depth_test = (enum hl_compare)mk_below(seed, HL_COMPARE_ALWAYS + 1);
    p->depth_write = p->depth_test != HL_COMPARE_OFF && mk_below(seed, 2);
    p->cull = (enum hl_cull)(mk_below(seed, 6) / 2 * mk_below(seed, 2));
    p->mirrored = mk_below(seed, 3) == 0;
    p->no_color_write = mk_below(seed, 5) == 0;
    p->stencil.front = random_face(seed);
    p->stencil.back = random_face(seed);
    p->stencil.reference = reference[mk_below(seed, 8)];
    p->stencil.read_mask = random_mask(seed);
    p->stencil.write_mask = random_mask(seed);
    if (mk_below(seed, 8) == 0)
        memset(&p->stencil.back, 0, sizeof p->stencil.back);
    if (mk_below(seed, 12) == 0)
        memset(&p->stencil, 0, sizeof p->stencil);
    s->r[0] = random_rect(seed, false);
    s->r[1] = random_rect(seed, true);
}

/* ---- the device --------------------------------------------------------- */

struct rig {
    struct ck_machine *m;
    enum hl_format depth_format;
    hl_tex color, depth;
    hl_buf vertex, uniform;
    uint32_t align;
    hl_prog read[8];             /* one a stencil bit                        */
    float quads[DRAWS + 1][12][3];
};

/* Two triangles that cover a rectangle. Front faces are counter-clockwise
 * seen with y up: on the screen, y down, bottom left, bottom right, top. */
static void put_rect(float (*v)[3], const struct rect *r)
{
    const float x0 = (float)r->x0 / W * 2 - 1, x1 = (float)r->x1 / W * 2 - 1;
    const float y0 = (float)r->y0 / H * 2 - 1, y1 = (float)r->y1 / H * 2 - 1;
    const float at[6][2] = { { x0, y1 }, { x1, y1 }, { x1, y0 },
                             { x0, y1 }, { x1, y0 }, { x0, y0 } };
    for (int i = 0; i < 6; i++) {
        const float *p = at[r->back ? 5 - i : i];
        v[i][0] = p[0];
        v[i][1] = p[1];
        v[i][2] = r->z;
    }
}

static hl_tex target(struct ck_machine *m, enum hl_format f)
{
    struct hl_tex_desc d = { .label = "t", .format = f, .width = W,
                             .height = H, .usage = HL_TEX_TARGET |
                                                   HL_TEX_READBACK };
    hl_tex t;
    assert_int_equal(hl_tex_create(m->device, &t, &d), HL_OK);
    return t;
}

/* Identity matrices, then the values that COUNT_FRAG writes: 1 and, for the
 * bits, 1 << b. */
static void make_uniforms(struct rig *g)
{
    static uint8_t bytes[65536];
    struct hl_object_block o;
    g->align = hl_device_caps(g->m->device)->uniform_align;
    if (g->align < 256)
        g->align = 256;
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = o.clip.column[1].y = 1;
    o.clip.column[2].z = o.clip.column[3].w = 1;
    o.normal = o.model_view = o.clip;
    memset(bytes, 0, sizeof bytes);
    memcpy(bytes + g->align, &o, sizeof o);
    for (uint32_t b = 0; b < 9; b++) {
        float value = b < 8 ? (float)(1u << b) : 1;
        memcpy(bytes + (4 + 4 * b) * g->align, &value, sizeof value);
    }
    struct hl_buf_desc d = { "u", sizeof bytes, HL_BUF_UNIFORM, true, bytes };
    assert_true(g->align <= 1024);
    assert_int_equal(hl_buf_create(g->m->device, &g->uniform, &d), HL_OK);
}

/* value: 0..7 writes 1 << value, 8 writes 1. */
static struct hl_draw make_draw(const struct rig *g, hl_prog prog,
                                uint32_t first, uint32_t count,
                                uint32_t value)
{
    struct hl_draw d = { .prog = prog, .first = first, .count = count };
    d.vertex[0] = g->vertex;
    for (int i = 0; i < HL_MAX_UNIFORMS; i++)
        d.uniform[i].buf = g->uniform;
    d.uniform[HL_SLOT_FRAME].bytes = sizeof(struct hl_frame_block);
    d.uniform[HL_SLOT_OBJECT].offset = g->align;
    d.uniform[HL_SLOT_OBJECT].bytes = sizeof(struct hl_object_block);
    d.uniform[HL_SLOT_MATERIAL].bytes = sizeof(struct hl_material_block);
    d.uniform[HL_SLOT_LIGHTS].offset = (4 + 4 * value) * g->align;
    d.uniform[HL_SLOT_LIGHTS].bytes = HL_LIGHTS_BYTES;
    return d;
}

static void make_readers(struct rig *g)
{
    uint64_t seed = 1;
    for (uint32_t b = 0; b < 8; b++) {
        struct shot s;
        random_shot(&s, &seed, g->depth_format);
        struct hl_prog_desc *p = &s.p;
        p->depth_test = HL_COMPARE_OFF;
        p->depth_write = p->mirrored = p->no_color_write = false;
        p->cull = HL_CULL_NONE;
        memset(&p->stencil, 0, sizeof p->stencil);
        p->stencil.front.test = p->stencil.back.test = HL_COMPARE_EQUAL;
        p->stencil.reference = p->stencil.read_mask = (uint8_t)(1u << b);
        p->stencil.write_mask = 1; /* which no clear may mind                */
        assert_int_equal(hl_prog_create(g->m->device, &g->read[b], p), HL_OK);
    }
}

static void open_rig(struct rig *g, struct ck_machine *m, enum hl_format f)
{
    static const struct rect all = { 0, 0, W, H, 0.5f, false };
    memset(g, 0, sizeof *g);
    g->m = m;
    g->depth_format = f;
    g->color = target(m, HL_FORMAT_R32_FLOAT);
    g->depth = target(m, f);
    put_rect(g->quads[DRAWS], &all);
    struct hl_buf_desc d = { "v", sizeof g->quads, HL_BUF_VERTEX, true,
                             NULL };
    assert_int_equal(hl_buf_create(m->device, &g->vertex, &d), HL_OK);
    make_uniforms(g);
    make_readers(g);
}

static void write_quads(struct rig *g)
{
    assert_int_equal(hl_buf_write(g->m->device, g->vertex, 0, g->quads,
                                  sizeof g->quads), HL_OK);
}

static void read_count(struct rig *g, float *out)
{
    assert_int_equal(hl_tex_read(g->m->device, g->color, out,
                                 PIXELS * sizeof *out), HL_OK);
}

/* Stencil bit by bit as a sum, in a pass that only reads it. */
static void read_stencil(struct rig *g, float *out)
{
    struct hl_draw draws[8];
    for (uint32_t b = 0; b < 8; b++)
        draws[b] = make_draw(g, g->read[b], DRAWS * 12, 6, b);
    struct hl_pass p = { .label = "read", .n_colors = 1, .draws = draws,
                         .n_draws = 8, .depth_read_only = true };
    p.color[0].tex = g->color;
    p.color[0].load = HL_LOAD_CLEAR;
    p.depth.tex = g->depth;
    assert_int_equal(hl_pass_run(g->m->device, &p), HL_OK);
    read_count(g, out);
}

static void run_shots(struct rig *g, const struct shot *shots, uint32_t first,
                      const float clear[2])
{
    struct hl_draw draws[A_PASS];
    hl_prog prog[A_PASS];
    for (uint32_t i = 0; i < A_PASS; i++) {
        assert_int_equal(hl_prog_create(g->m->device, &prog[i],
                                        &shots[first + i].p), HL_OK);
        draws[i] = make_draw(g, prog[i], (first + i) * 12, 12, 8);
    }
    struct hl_pass p = { .label = "shots", .n_colors = 1, .draws = draws,
                         .n_draws = A_PASS };
    p.color[0].tex = g->color;
    p.color[0].load = HL_LOAD_CLEAR;
    p.depth.tex = g->depth;
    p.depth.load = first ? HL_LOAD_KEEP : HL_LOAD_CLEAR;
    p.depth.clear[0] = clear[0];
    p.depth.clear[1] = clear[1];
    assert_int_equal(hl_pass_run(g->m->device, &p), HL_OK);
    for (uint32_t i = 0; i < A_PASS; i++)
        hl_prog_destroy(g->m->device, &prog[i]);
}

static void check_pixels(struct rig *g, const struct oracle *o, uint32_t first)
{
    float count[PIXELS], stencil[PIXELS];
    read_count(g, count);
    read_stencil(g, stencil);
    for (int i = 0; i < PIXELS; i++)
        if (count[i] != o->count[i] || stencil[i] != (float)o->stencil[i])
            fail_msg("draws %u on, pixel %d, %d: %g draws, stencil %g, not "
                     "%g and %d", first, i % W, i / W, (double)count[i],
                     (double)stencil[i], (double)o->count[i], o->stencil[i]);
}

static void check_format(struct ck_machine *m, enum hl_format f)
{
    static struct rig g;
    static struct shot shots[DRAWS];
    static struct oracle o;
    const float clear[2] = { 0.5f, 254 };
    uint64_t seed = 20;
    open_rig(&g, m, f);
    memset(&o, 0, sizeof o);
    for (int i = 0; i < PIXELS; i++) {
        o.depth[i] = clear[0];
        o.stencil[i] = (uint8_t)clear[1];
    }
    for (int i = 0; i < DRAWS; i++) {
        random_shot(&shots[i], &seed, f);
        put_rect(g.quads[i], &shots[i].r[0]);
        put_rect(g.quads[i] + 6, &shots[i].r[1]);
    }
    write_quads(&g);
    for (uint32_t i = 0; i < DRAWS; i += A_PASS) {
        run_shots(&g, shots, i, clear);
        memset(o.count, 0, sizeof o.count);
        for (uint32_t k = i; k < i + A_PASS; k++)
            shoot(&o, &shots[k]);
        check_pixels(&g, &o, i);
    }
    /* That nothing was left out. */
    for (int k = 0; k < 48; k++)
        assert_true(o.used[k / 24][k / 8 % 3][k % 8] > 0);
    for (int k = 0; k < 4; k++)
        assert_true(o.edge[k] > 0);
}

static void stencil_is_as_stated(void **state)
{
    static const enum hl_format formats[] = {
        HL_FORMAT_D24_UNORM_S8, HL_FORMAT_D32_FLOAT_S8, HL_FORMAT_D24_FLOAT_S8
    };
    struct ck_machine *m = ck_machine(state);
    uint32_t n = 0;
    for (int i = 0; i < 3; i++) {
        const struct hl_caps *c = hl_device_caps(m->device);
        if (!(c->format[formats[i]].use & HL_USE_TARGET))
            continue;
        check_format(m, formats[i]);
        n++;
    }
    assert_true(n > 0);
}

/* ---- shift blending ----------------------------------------------------- */

/* src + dst k, exact for these values in 32-bit floats. */
static void shifting_is_as_stated(void **state)
{
    static const float constant[] = { 0, 0.5f, 1, 2, -4, 0.03125f };
    struct ck_machine *m = ck_machine(state);
    static struct rig g;
    open_rig(&g, m, HL_FORMAT_D32_FLOAT_S8);
    write_quads(&g);
    uint64_t seed = 1;
    struct shot s;
    random_shot(&s, &seed, HL_FORMAT_NONE);
    memset(&s.p.stencil, 0, sizeof s.p.stencil);
    s.p.depth_test = HL_COMPARE_OFF;
    s.p.depth_write = s.p.mirrored = s.p.no_color_write = false;
    s.p.cull = HL_CULL_NONE;
    s.p.blend = HL_BLEND_SHIFT;
    for (int i = 0; i < 6; i++) {
        float px[PIXELS];
        hl_prog prog;
        s.p.blend_constant = constant[i];
        assert_int_equal(hl_prog_create(m->device, &prog, &s.p), HL_OK);
        /* 32 over 3, then 4 over that. */
        struct hl_draw draws[2] = { make_draw(&g, prog, DRAWS * 12, 6, 5),
                                    make_draw(&g, prog, DRAWS * 12, 6, 2) };
        struct hl_pass p = { .label = "shift", .n_colors = 1, .draws = draws,
                             .n_draws = 2 };
        p.color[0].tex = g.color;
        p.color[0].load = HL_LOAD_CLEAR;
        p.color[0].clear[0] = 3;
        assert_int_equal(hl_pass_run(m->device, &p), HL_OK);
        read_count(&g, px);
        float k = constant[i], want = 4 + (32 + 3 * k) * k;
        for (int j = 0; j < PIXELS; j++)
            assert_true(px[j] == want);
        hl_prog_destroy(m->device, &prog);
    }
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(stencil_is_as_stated),
        DRAWN(shifting_is_as_stated),
    };
    return cmocka_run_group_tests_name("stencil", tests, NULL, NULL);
}
