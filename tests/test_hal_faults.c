/* SPDX-License-Identifier: Zlib */
/* What a device does when something fails: host memory, the machine's calls,
 * the machine itself; pools that are full or worn out; and the null backend,
 * which is the means to all this. */
#include <stdlib.h>
#include <string.h>
#include "platforms/null/hl_null.h"
#include "platforms/platforms.h"
#include "tests/check.h"

/* ---- a life of a device ----------------------------------------------- */

struct life {
    struct hl_device *d;
    hl_buf buf;
    hl_tex tex, depth;
    hl_prog prog;
    uint32_t done;               /* steps that worked                        */
};

/* Every kind of call once. On failure what was not made is {0}. */
static enum hl_result live(struct life *l)
{
    const float data[16] = { 1 };
    float back[16];
    struct hl_buf_desc b = { "b", 64, HL_BUF_UNIFORM, true, data };
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA32_FLOAT, .width = 2,
                             .height = 2, .usage = 7 };
    struct hl_tex_desc z = { .format = HL_FORMAT_D32_FLOAT, .width = 2,
                             .height = 2, .usage = HL_TEX_TARGET };
    struct hl_prog_desc p = {
        .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_COUNT_FRAG, NULL }, .n_colors = 1,
        .color = { HL_FORMAT_RGBA32_FLOAT }, .depth = HL_FORMAT_D32_FLOAT };
    struct hl_draw draw = { .count = 3 };
    struct hl_pass pass = { .n_colors = 1, .draws = &draw, .n_draws = 1 };
    enum hl_result r = hl_buf_create(l->d, &l->buf, &b);
    if (r == HL_OK)
        r = hl_tex_create(l->d, &l->tex, &t);
    if (r == HL_OK)
        r = hl_tex_create(l->d, &l->depth, &z);
    if (r == HL_OK)
        r = hl_prog_create(l->d, &l->prog, &p);
    if (r == HL_OK)
        r = hl_buf_write(l->d, l->buf, 0, data, 64);
    if (r == HL_OK)
        r = hl_tex_write(l->d, l->tex, 0, data, 64);
    draw.prog = l->prog;
    draw.uniform[3].buf = l->buf;
    draw.uniform[3].bytes = 64;
    pass.color[0].tex = l->tex;
    pass.color[0].load = HL_LOAD_CLEAR;
    pass.depth.tex = l->depth;
    pass.depth.load = HL_LOAD_CLEAR;
    if (r == HL_OK)
        r = hl_pass_run(l->d, &pass);
    if (r == HL_OK)
        r = hl_submit(l->d, true);
    if (r == HL_OK)
        r = hl_tex_read(l->d, l->tex, back, sizeof back);
    return r;
}

static void forget(struct life *l)
{
    hl_buf_destroy(l->d, &l->buf);
    hl_tex_destroy(l->d, &l->tex);
    hl_tex_destroy(l->d, &l->depth);
    hl_prog_destroy(l->d, &l->prog);
}

/* ---- host memory ------------------------------------------------------ */

/* Open, live, close with the fail_at-th allocation failing. Returns whether
 * the whole life worked. */
static bool starved(const char *backend, size_t fail_at, bool for_ever,
                    size_t *n_allocs)
{
    struct ck_machine m;
    struct life l;
    memset(&m, 0, sizeof m);
    memset(&l, 0, sizeof l);
    m.backend = hl_platform_find(backend);
    m.memory.fail_at = fail_at;
    m.memory.fail_on = for_ever;
    struct hl_device_desc d = ck_desc(&m);
    d.validation = false;        /* its memory is not ours to fail           */
    d.max_buffers = d.max_textures = d.max_programs = 8;
    enum hl_result r = hl_device_open(&l.d, m.backend, &d);
    if (r == HL_OK)
        r = live(&l);
    else
        assert_null(l.d);
    assert_true(r == HL_OK || r == HL_ERR_MEMORY);
    if (l.d && !for_ever && r != HL_OK) {
        /* Memory is there again: so is everything else. */
        forget(&l);
        assert_int_equal(live(&l), HL_OK);
    }
    hl_device_close(&l.d);
    if (m.memory.n_live)
        fail_msg("allocation %zu failed%s: %zu are left", fail_at,
                 for_ever ? " and all later" : "", m.memory.n_live);
    *n_allocs = m.memory.n_allocs;
    return r == HL_OK;
}

static void every_allocation_may_fail(void **state)
{
    struct ck_machine *m = ck_machine(state);
    const char *backend = m->backend->name;
    size_t n = 0, unused, survived = 0;
    assert_true(starved(backend, 0, false, &n));
    for (size_t i = 1; i <= n; i++) {
        survived += starved(backend, i, false, &unused);
        starved(backend, i, true, &unused);
    }
    print_message("%zu allocations, %zu could fail unnoticed\n", n, survived);
    assert_true(n >= 10);
    /* Some have a way around it (a segment that is not split, another memory
     * type), most do not. */
    assert_true(survived <= n / 3);
    assert_true(starved(backend, n + 1, false, &unused));
}

/* ---- the machine's own failures --------------------------------------- */

static void every_machine_call_may_fail(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_null_native native = { NULL, NULL, NULL, 0 };
    uint32_t n = 0;
    for (;; n++) {
        struct life l;
        memset(&l, 0, sizeof l);
        memset(&m, 0, sizeof m);
        native.fail_at = n + 1;
        struct hl_device_desc d = ck_desc(&m);
        d.native = &native;
        d.max_buffers = d.max_programs = 1;      /* no slot to lose          */
        d.max_textures = 2;
        assert_int_equal(hl_device_open(&m.device, &hl_backend_null, &d),
                         HL_OK);
        l.d = m.device;
        enum hl_result r = live(&l);
        struct life made = l;
        forget(&l);
        if (r == HL_OK) {
            ck_close(&m);
            break;
        }
        assert_int_equal(r, HL_ERR_MEMORY);
        /* What failed gave no handle: the null backend's calls in order. */
        assert_true((made.buf.id != 0) == (n > 0));
        assert_true((made.tex.id != 0) == (n > 1));
        assert_true((made.depth.id != 0) == (n > 2));
        assert_true((made.prog.id != 0) == (n > 3));
        assert_int_equal(live(&l), HL_OK);       /* the slot was given back  */
        ck_close(&m);
    }
    assert_int_equal(n, 7);      /* 4 creates, 2 writes, 1 pass              */
}

/* The null backend, but for one kind of call that finds the device gone. */
static enum hl_result gone_pass(void *state, const struct hl_bk_pass *pass,
                                const struct hl_bk_draw *draws, uint32_t n)
{
    (void)state;
    (void)pass;
    (void)draws;
    (void)n;
    return HL_ERR_DEVICE_LOST;
}

static enum hl_result gone_submit(void *state, bool wait)
{
    (void)state;
    (void)wait;
    return HL_ERR_DEVICE_LOST;
}

static enum hl_result gone_buf(void *state, uint32_t slot,
                               const struct hl_buf_desc *desc)
{
    (void)state;
    (void)slot;
    (void)desc;
    return HL_ERR_DEVICE_LOST;
}

static enum hl_result gone_read(void *state, uint32_t slot, void *out,
                                size_t bytes)
{
    (void)state;
    (void)slot;
    (void)out;
    (void)bytes;
    return HL_ERR_DEVICE_LOST;
}

/* After the first loss every call that could reach the machine says so. */
static void check_lost(struct ck_machine *m, struct life *l)
{
    struct hl_buf_desc b = { "b", 4, 0, false, NULL };
    struct hl_tex_desc t = { .width = 1, .height = 1 };
    struct hl_prog_desc p = { .vertex = { HL_SHADER_SCREEN_VERT, NULL } };
    struct hl_pass pass = { .n_colors = 1 };
    float data[16] = { 0 };
    hl_buf buf;
    hl_tex tex;
    hl_prog prog;
    struct hl_device *d = m->device;
    assert_int_equal(hl_buf_create(d, &buf, &b), HL_ERR_DEVICE_LOST);
    assert_int_equal(hl_tex_create(d, &tex, &t), HL_ERR_DEVICE_LOST);
    assert_int_equal(hl_prog_create(d, &prog, &p), HL_ERR_DEVICE_LOST);
    assert_true(buf.id == 0 && tex.id == 0 && prog.id == 0);
    assert_int_equal(hl_pass_run(d, &pass), HL_ERR_DEVICE_LOST);
    assert_int_equal(hl_submit(d, true), HL_ERR_DEVICE_LOST);
    if (l->buf.id)
        assert_int_equal(hl_buf_write(d, l->buf, 0, data, 4),
                         HL_ERR_DEVICE_LOST);
    if (l->tex.id) {
        assert_int_equal(hl_tex_write(d, l->tex, 0, data, 64),
                         HL_ERR_DEVICE_LOST);
        assert_int_equal(hl_tex_read(d, l->tex, data, 64),
                         HL_ERR_DEVICE_LOST);
    }
}

static void a_lost_device_stays_lost(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        struct hl_backend b = hl_backend_null;
        struct ck_machine m;
        struct life l;
        memset(&m, 0, sizeof m);
        memset(&l, 0, sizeof l);
        if (i == 0)
            b.buf_create = gone_buf;
        else if (i == 1)
            b.pass_run = gone_pass;
        else if (i == 2)
            b.submit = gone_submit;
        else
            b.tex_read = gone_read;
        m.backend = &b;
        struct hl_device_desc d = ck_desc(&m);
        assert_int_equal(hl_device_open(&m.device, &b, &d), HL_OK);
        l.d = m.device;
        assert_int_equal(live(&l), HL_ERR_DEVICE_LOST);
        check_lost(&m, &l);
        forget(&l);              /* destroying still works                   */
        ck_close(&m);
    }
}

/* ---- pools ------------------------------------------------------------ */

static void pools_are_as_large_as_asked(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_buf_desc b = { "b", 4, 0, false, NULL };
    struct hl_tex_desc t = { .width = 1, .height = 1 };
    struct hl_prog_desc p = { .vertex = { HL_SHADER_SCREEN_VERT, NULL } };
    hl_buf buf[3], buf_more;
    hl_tex tex[2], tex_more;
    hl_prog prog[1], prog_more;
    memset(&m, 0, sizeof m);
    struct hl_device_desc d = ck_desc(&m);
    d.max_buffers = 3;
    d.max_textures = 2;
    d.max_programs = 1;
    assert_int_equal(hl_device_open(&m.device, &hl_backend_null, &d), HL_OK);
    for (int i = 0; i < 3; i++)
        CK_ALLOWED(&m, hl_buf_create(m.device, &buf[i], &b));
    CK_REFUSED(&m, hl_buf_create(m.device, &buf_more, &b), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "buffers: 3 are live");
    for (int i = 0; i < 2; i++)
        CK_ALLOWED(&m, hl_tex_create(m.device, &tex[i], &t));
    CK_REFUSED(&m, hl_tex_create(m.device, &tex_more, &t), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "textures: 2 are live");
    CK_ALLOWED(&m, hl_prog_create(m.device, &prog[0], &p));
    CK_REFUSED(&m, hl_prog_create(m.device, &prog_more, &p), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "programs: 1 are live");
    assert_true(buf_more.id == 0 && tex_more.id == 0 && prog_more.id == 0);
    hl_buf_destroy(m.device, &buf[1]);
    CK_ALLOWED(&m, hl_buf_create(m.device, &buf[1], &b));
    ck_close(&m);
}

/* Generations are 16 bits: a slot that has used them up is retired, so no
 * handle ever comes alive again. */
static void worn_slots_are_retired(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_buf_desc b = { "b", 4, 0, false, NULL };
    hl_buf buf, first;
    memset(&m, 0, sizeof m);
    struct hl_device_desc d = ck_desc(&m);
    d.max_buffers = 1;
    d.max_textures = d.max_programs = 1;
    assert_int_equal(hl_device_open(&m.device, &hl_backend_null, &d), HL_OK);
    CK_ALLOWED(&m, hl_buf_create(m.device, &first, &b));
    buf = first;
    for (uint32_t i = 1; i < 65535; i++) {
        hl_buf_destroy(m.device, &buf);
        assert_int_equal(hl_buf_create(m.device, &buf, &b), HL_OK);
        assert_int_not_equal(buf.id, first.id);
    }
    hl_buf_destroy(m.device, &buf);
    CK_REFUSED(&m, hl_buf_create(m.device, &buf, &b), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "buffers");
    CK_REFUSED(&m, hl_buf_write(m.device, first, 0, &d, 4), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_buf_write");
    ck_close(&m);
}

static void many_live_objects_are_no_trouble(void **state)
{
    (void)state;
    enum { MANY = 65535 };
    struct ck_machine m;
    struct hl_buf_desc b = { "b", 1, 0, false, NULL };
    hl_buf *bufs = malloc(MANY * sizeof *bufs), more;
    assert_non_null(bufs);
    memset(&m, 0, sizeof m);
    struct hl_device_desc d = ck_desc(&m);
    d.max_buffers = 1000000;     /* what 16 bits of slots give               */
    assert_int_equal(hl_device_open(&m.device, &hl_backend_null, &d), HL_OK);
    for (uint32_t i = 0; i < MANY; i++)
        assert_int_equal(hl_buf_create(m.device, &bufs[i], &b), HL_OK);
    CK_REFUSED(&m, hl_buf_create(m.device, &more, &b), HL_ERR_LIMIT,
               HL_MSG_LIMIT, "buffers: 65535");
    for (uint32_t i = 0; i < MANY; i += 2)
        hl_buf_destroy(m.device, &bufs[i]);
    for (uint32_t i = 1; i < MANY; i += 2)
        assert_int_equal(hl_buf_write(m.device, bufs[i], 0, "x", 1), HL_OK);
    free(bufs);
    ck_close(&m);
}

/* ---- the null backend ------------------------------------------------- */

struct lines { char text[8][160]; int n; };

static void take_line(void *user, const char *line)
{
    struct lines *l = user;
    assert_true(l->n < 8);
    strncpy(l->text[l->n++], line, 159);
}

static void null_records_passes(void **state)
{
    (void)state;
    struct ck_machine m;
    struct lines lines = { { { 0 } }, 0 };
    struct hl_null_native native = { NULL, take_line, &lines, 0 };
    struct life l;
    memset(&l, 0, sizeof l);
    assert_true(ck_open(&m, "null", &native));
    l.d = m.device;
    assert_int_equal(live(&l), HL_OK);
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA32_FLOAT, .width = 2,
                             .height = 2, .samples = 4,
                             .usage = HL_TEX_TARGET };
    hl_tex ms, depth;
    assert_int_equal(hl_tex_create(l.d, &ms, &t), HL_OK);
    t.format = HL_FORMAT_D32_FLOAT;
    assert_int_equal(hl_tex_create(l.d, &depth, &t), HL_OK);
    struct hl_pass pass = { .label = "light", .n_colors = 1,
                            .depth_read_only = true };
    pass.color[0].tex = ms;
    pass.color[0].load = HL_LOAD_DISCARD;
    pass.color[0].resolve = l.tex;
    pass.depth.tex = depth;
    assert_int_equal(hl_pass_run(l.d, &pass), HL_OK);
    assert_int_equal(lines.n, 2);
    assert_string_equal(lines.text[0],
                        "pass  2x2x1 c0=0(clear) d0=1(clear) draws=1");
    assert_string_equal(lines.text[1],
        "pass light 2x2x4 c0=2(discard,resolve) ro0=3(keep) draws=0");
    struct hl_timing timing[4];
    assert_int_equal(hl_timings(l.d, timing, 4), 0);
    ck_close(&m);
}

static void null_poses_as_any_machine(void **state)
{
    (void)state;
    struct hl_caps caps;
    struct hl_null_native native = { &caps, NULL, NULL, 0 };
    struct ck_machine m;
    ck_lavapipe(&caps);
    caps.max_tex_dim = 16;
    caps.max_colors = 1;
    caps.uniform_align = caps.storage_align = 0;     /* taken for 1          */
    caps.max_storage_bytes = 0;
    caps.format[HL_FORMAT_R8_UNORM].use = HL_USE_SAMPLED;
    caps.format[HL_FORMAT_R16_UNORM].use = HL_USE_TARGET;
    caps.format[HL_FORMAT_D16_UNORM].use = HL_USE_SAMPLED;
    assert_true(ck_open(&m, "null", &native));
    const struct hl_caps *c = hl_device_caps(m.device);
    assert_string_equal(c->backend, "null");
    assert_string_equal(c->device, caps.device);
    assert_int_equal(c->uniform_align, 1);
    assert_int_equal(c->storage_align, 1);
    struct hl_tex_desc t = { .width = 17, .height = 1 };
    hl_tex tex;
    CK_REFUSED(&m, hl_tex_create(m.device, &tex, &t), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "width: 17");
    t.width = 16;
    t.format = HL_FORMAT_R8_UNORM;
    t.usage = HL_TEX_TARGET;
    CK_REFUSED(&m, hl_tex_create(m.device, &tex, &t), HL_ERR_UNSUPPORTED,
               HL_MSG_FORMAT, "R8_UNORM");
    t.usage = HL_TEX_SAMPLED;
    CK_ALLOWED(&m, hl_tex_create(m.device, &tex, &t));
    t.format = HL_FORMAT_R16_UNORM;
    CK_REFUSED(&m, hl_tex_create(m.device, &tex, &t), HL_ERR_UNSUPPORTED,
               HL_MSG_FORMAT, "R16_UNORM");
    struct hl_prog_desc p = { .vertex = { HL_SHADER_SCREEN_VERT, NULL },
                              .fragment = { HL_SHADER_COUNT_FRAG, NULL },
                              .n_colors = 2,
                              .color = { HL_FORMAT_R32_FLOAT,
                                         HL_FORMAT_R32_FLOAT } };
    hl_prog prog;
    CK_REFUSED(&m, hl_prog_create(m.device, &prog, &p), HL_ERR_UNSUPPORTED,
               HL_MSG_ARGUMENT, "n_colors: 2");
    p.n_colors = 1;
    p.color[0] = HL_FORMAT_R8_UNORM;
    CK_REFUSED(&m, hl_prog_create(m.device, &prog, &p), HL_ERR_UNSUPPORTED,
               HL_MSG_FORMAT, "R8_UNORM");
    p.color[0] = HL_FORMAT_R32_FLOAT;
    p.depth = HL_FORMAT_D16_UNORM;
    CK_REFUSED(&m, hl_prog_create(m.device, &prog, &p), HL_ERR_UNSUPPORTED,
               HL_MSG_FORMAT, "D16_UNORM");
    ck_close(&m);
}

static void null_keeps_what_is_written_and_cleared(void **state)
{
    (void)state;
    struct ck_machine m;
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA32_FLOAT, .width = 3,
                             .height = 2, .usage = 7 };
    struct hl_pass pass = { .n_colors = 1 };
    float data[24], back[24];
    for (int i = 0; i < 24; i++)
        data[i] = (float)i;
    assert_true(ck_open(&m, "null", NULL));
    assert_int_equal(hl_tex_create(m.device, &pass.color[0].tex, &t), HL_OK);
    hl_tex tex = pass.color[0].tex;
    assert_int_equal(hl_tex_write(m.device, tex, 0, data, 96), HL_OK);
    assert_int_equal(hl_pass_run(m.device, &pass), HL_OK);
    assert_int_equal(hl_tex_read(m.device, tex, back, 96), HL_OK);
    assert_memory_equal(data, back, 96);
    pass.color[0].load = HL_LOAD_CLEAR;
    pass.color[0].clear[1] = 2;
    assert_int_equal(hl_pass_run(m.device, &pass), HL_OK);
    assert_int_equal(hl_tex_read(m.device, tex, back, 96), HL_OK);
    for (int i = 0; i < 24; i++)
        assert_true(back[i] == (i % 4 == 1 ? 2 : 0));
    ck_close(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        CK_ON("null", every_allocation_may_fail),
        CK_ON("vulkan", every_allocation_may_fail),
        CK_ON("gl", every_allocation_may_fail),
        CK_ON("packemu", every_allocation_may_fail),
        cmocka_unit_test(every_machine_call_may_fail),
        cmocka_unit_test(a_lost_device_stays_lost),
        cmocka_unit_test(pools_are_as_large_as_asked),
        cmocka_unit_test(worn_slots_are_retired),
        cmocka_unit_test(many_live_objects_are_no_trouble),
        cmocka_unit_test(null_records_passes),
        cmocka_unit_test(null_poses_as_any_machine),
        cmocka_unit_test(null_keeps_what_is_written_and_cleared),
    };
    return cmocka_run_group_tests_name("faults", tests, NULL, NULL);
}
