/* SPDX-License-Identifier: Zlib */
/* What hal.c promises of devices, buffers, textures and programs, on every
 * backend: each rule once broken, with its message, and once just kept.
 * test_hal_pass.c goes on with passes, test_hal_faults.c with failures. */
#include <stdlib.h>
#include <string.h>
#include "platforms/platforms.h"
#include "tests/check.h"

/* ---- devices ---------------------------------------------------------- */

static void a_device_needs_hooks_a_version_and_a_backend(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_device_desc good = ck_desc(m), d = good;
    struct hl_device *dev = m->device;
    struct hl_backend other = *m->backend;
    assert_int_equal(hl_device_open(NULL, m->backend, &d), HL_ERR_INVALID);
    assert_int_equal(hl_device_open(&dev, m->backend, NULL), HL_ERR_INVALID);
    assert_null(dev);
    d.hooks.alloc = NULL;
    assert_int_equal(hl_device_open(&dev, m->backend, &d), HL_ERR_INVALID);
    d = good;
    d.hooks.free = NULL;
    assert_int_equal(hl_device_open(&dev, m->backend, &d), HL_ERR_INVALID);
    d = good;
    assert_int_equal(hl_device_open(&dev, NULL, &d), HL_ERR_NO_DEVICE);
    d.version = HL_VERSION + 1;
    assert_int_equal(hl_device_open(&dev, m->backend, &d), HL_ERR_VERSION);
    other.version = HL_VERSION + 1;
    assert_int_equal(hl_device_open(&dev, &other, &good), HL_ERR_VERSION);
    assert_null(dev);
    hl_device_close(&dev);
    hl_device_close(NULL);
}

static void devices_are_listed_and_counted(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_hooks hooks = mk_hooks(&m->memory), none = { NULL, NULL, NULL };
    struct hl_device_info info[8];
    struct hl_backend other = *m->backend;
    uint32_t n = 77, all;
    assert_int_equal(hl_devices_list(m->backend, &hooks, NULL, 0, &all), HL_OK);
    assert_true(all >= 1);
    assert_int_equal(hl_devices_list(m->backend, &hooks, info, 8, &n), HL_OK);
    assert_int_equal(n, all);
    assert_true(info[0].name[0] != 0 && info[0].driver[0] != 0);
    assert_int_equal(hl_devices_list(m->backend, &hooks, info, 8, NULL),
                     HL_ERR_INVALID);
    assert_int_equal(hl_devices_list(m->backend, &none, info, 8, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_devices_list(m->backend, NULL, info, 8, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_devices_list(m->backend, &hooks, NULL, 8, &n),
                     HL_ERR_INVALID);
    assert_int_equal(hl_devices_list(NULL, &hooks, info, 8, &n),
                     HL_ERR_NO_DEVICE);
    other.version++;
    assert_int_equal(hl_devices_list(&other, &hooks, info, 8, &n),
                     HL_ERR_VERSION);
    assert_int_equal(n, 0);
}

static void results_have_names_of_their_own(void **state)
{
    (void)state;
    for (int i = 0; i <= HL_ERR_VERSION + 1; i++)
        for (int k = 0; k < i; k++)
            assert_string_not_equal(hl_result_name((enum hl_result)i),
                                    hl_result_name((enum hl_result)k));
}

static void formats_have_rows_and_nonsense_has_none(void **state)
{
    (void)state;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        const struct hl_format_info *f = hl_format_info((enum hl_format)i);
        unsigned bits = 0;
        for (int c = 0; c < 4; c++)
            bits += f->bits[c];
        assert_true(f->bytes * 8u >= bits && bits > 0);
        /* Only D32_FLOAT_S8 has bits to spare. */
        assert_true(f->bytes * 8u == bits || f->kind == HL_KIND_DEPTH);
        assert_true(f->channels >= 1 && f->channels <= 4);
    }
    assert_int_equal(hl_format_info(HL_FORMAT_NONE)->bytes, 0);
    assert_int_equal(hl_format_info(HL_FORMAT_COUNT)->bytes, 0);
    assert_int_equal(hl_format_info((enum hl_format)-1)->bytes, 0);
}

/* ---- buffers ---------------------------------------------------------- */

static hl_buf make_buf(struct ck_machine *m, size_t bytes, uint32_t usage)
{
    struct hl_buf_desc d = { "b", bytes, usage, true, NULL };
    hl_buf b;
    assert_int_equal(hl_buf_create(m->device, &b, &d), HL_OK);
    return b;
}

static void buffers_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_buf_desc d = { "b", 16, 0, false, NULL };
    hl_buf b = { 77 };
    assert_int_equal(hl_buf_create(NULL, &b, &d), HL_ERR_INVALID);
    assert_int_equal(hl_buf_create(m->device, NULL, &d), HL_ERR_INVALID);
    assert_int_equal(hl_buf_create(m->device, &b, NULL), HL_ERR_INVALID);
    d.bytes = 0;
    CK_REFUSED(m, hl_buf_create(m->device, &b, &d), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_buf_desc.bytes");
    assert_int_equal(b.id, 0);
    d.bytes = 1;
    CK_ALLOWED(m, hl_buf_create(m->device, &b, &d));
    hl_buf_destroy(m->device, &b);
    d.usage = 16;
    CK_REFUSED(m, hl_buf_create(m->device, &b, &d), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_buf_desc.usage");
    d.usage = 15;
    CK_ALLOWED(m, hl_buf_create(m->device, &b, &d));
    hl_buf_destroy(m->device, &b);
    assert_int_equal(b.id, 0);
}

static void buffer_writes_stay_inside(void **state)
{
    struct ck_machine *m = ck_machine(state);
    hl_buf b = make_buf(m, 64, HL_BUF_UNIFORM), none = { 0 };
    const uint8_t data[65] = { 1 };
    CK_ALLOWED(m, hl_buf_write(m->device, b, 0, data, 64));
    CK_ALLOWED(m, hl_buf_write(m->device, b, 60, data, 4));
    CK_ALLOWED(m, hl_buf_write(m->device, b, 64, data, 0));
    CK_ALLOWED(m, hl_buf_write(m->device, b, 0, NULL, 0));
    assert_int_equal(hl_buf_write(NULL, b, 0, data, 4), HL_ERR_INVALID);
    assert_int_equal(hl_buf_write(m->device, b, 0, NULL, 4), HL_ERR_INVALID);
    static const struct { size_t offset, bytes; } bad[] = {
        { 0, 65 }, { 61, 4 }, { 65, 0 }, { (size_t)-1, 4 }, { 4, (size_t)-1 },
        { (size_t)-4, 8 } };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CK_REFUSED(m, hl_buf_write(m->device, b, bad[i].offset, data,
                                   bad[i].bytes), HL_ERR_INVALID,
                   HL_MSG_ARGUMENT, "hl_buf_write: 64");
    CK_REFUSED(m, hl_buf_write(m->device, none, 0, data, 4), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_buf_write");
    hl_buf old = b;
    hl_buf_destroy(m->device, &b);
    CK_REFUSED(m, hl_buf_write(m->device, old, 0, data, 4), HL_ERR_INVALID,
               HL_MSG_HANDLE, "not a live buffer");
    uint64_t before = hl_device_counts(m->device).bytes_written;
    b = make_buf(m, 64, HL_BUF_UNIFORM);
    hl_buf_write(m->device, b, 0, data, 40);
    assert_int_equal(hl_device_counts(m->device).bytes_written, before + 40);
    hl_buf_destroy(m->device, &b);
}

/* ---- textures --------------------------------------------------------- */

static struct hl_tex_desc plain(uint32_t w, uint32_t h)
{
    struct hl_tex_desc d = { .label = "t", .width = w, .height = h,
                             .usage = HL_TEX_SAMPLED };
    return d;
}

static void tex_allowed(struct ck_machine *m, const struct hl_tex_desc *d)
{
    hl_tex t;
    CK_ALLOWED(m, hl_tex_create(m->device, &t, d));
    assert_true(hl_tex_live(m->device, t));
    hl_tex_destroy(m->device, &t);
    assert_false(hl_tex_live(m->device, t));
}

static void tex_refused(struct ck_machine *m, const struct hl_tex_desc *d,
                        enum hl_result result, enum hl_log_id id,
                        const char *part)
{
    hl_tex t = { 77 };
    CK_REFUSED(m, hl_tex_create(m->device, &t, d), result, id, part);
    assert_int_equal(t.id, 0);
}

static void texture_sizes_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    uint32_t max = hl_device_caps(m->device)->max_tex_dim;
    struct hl_tex_desc d = plain(0, 1);
    hl_tex t;
    assert_int_equal(hl_tex_create(NULL, &t, &d), HL_ERR_INVALID);
    assert_int_equal(hl_tex_create(m->device, NULL, &d), HL_ERR_INVALID);
    assert_int_equal(hl_tex_create(m->device, &t, NULL), HL_ERR_INVALID);
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "width: 0");
    d = plain(1, 0);
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "height: 0");
    d = plain(max + 1, 1);
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "width");
    d = plain(1, max + 1);
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "height");
    d = plain(max, 1);
    tex_allowed(m, &d);
    d = plain(1, max);
    tex_allowed(m, &d);
}

static void texture_levels_and_samples_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(5, 3);
    d.mips = 3;                  /* 5 x 3, 2 x 1, 1 x 1                      */
    tex_allowed(m, &d);
    d.mips = 4;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "mips: 4");
    d = plain(8, 8);
    d.usage = HL_TEX_TARGET;
    d.samples = 4;
    tex_allowed(m, &d);
    d.mips = 2;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "mips: 2");
    d.mips = 1;
    d.usage = HL_TEX_SAMPLED;
    tex_refused(m, &d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT, "samples: 4");
    d.usage = HL_TEX_TARGET;
    static const uint32_t bad[] = { 3, 5, 16, 0x80000000u };
    for (int i = 0; i < 4; i++) {
        d.samples = bad[i];
        tex_refused(m, &d, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT, "samples");
    }
    d = plain(8, 8);
    d.usage = 8;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_tex_desc.usage");
    d.usage = 7;
    tex_allowed(m, &d);
}

static void texture_formats_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(4, 4);
    d.format = HL_FORMAT_COUNT;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_FORMAT, "hl_tex_desc.format");
    d.format = (enum hl_format)-1;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_FORMAT, "hl_tex_desc.format");
    d.format = HL_FORMAT_RG16_UNORM;
    d.sample_as = HL_FORMAT_R32_UINT;
    tex_allowed(m, &d);
    d.sample_as = HL_FORMAT_RGBA8_UNORM;
    tex_allowed(m, &d);
    static const enum hl_format bad[] = { HL_FORMAT_R16_UNORM,
                                          HL_FORMAT_RGBA16_UNORM,
                                          HL_FORMAT_D32_FLOAT,
                                          HL_FORMAT_COUNT };
    for (int i = 0; i < 4; i++) {
        d.sample_as = bad[i];
        tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_FORMAT, "sample_as");
    }
    d.format = HL_FORMAT_D32_FLOAT;
    d.sample_as = HL_FORMAT_R32_UINT;
    tex_refused(m, &d, HL_ERR_INVALID, HL_MSG_FORMAT, "sample_as");
    d.sample_as = HL_FORMAT_D32_FLOAT;
    tex_allowed(m, &d);
}

static void zero_is_the_default_of_a_texture(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = { .width = 3, .height = 2 }, got;
    hl_tex t;
    CK_ALLOWED(m, hl_tex_create(m->device, &t, &d));
    assert_true(hl_tex_info(m->device, t, &got));
    assert_int_equal(got.format, HL_FORMAT_RGBA8_UNORM);
    assert_int_equal(got.samples, 1);
    assert_int_equal(got.mips, 1);
    assert_int_equal(got.usage, HL_TEX_SAMPLED);
    assert_true(got.width == 3 && got.height == 2);
    hl_tex old = t;
    hl_tex_destroy(m->device, &t);
    assert_int_equal(t.id, 0);
    assert_false(hl_tex_info(m->device, old, &got));
    assert_false(hl_tex_info(m->device, t, &got));
}

static void texture_writes_are_whole_levels(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(5, 3);
    uint8_t data[5 * 3 * 4] = { 0 };
    hl_tex t, ms, depth, none = { 0 };
    d.mips = 3;
    CK_ALLOWED(m, hl_tex_create(m->device, &t, &d));
    CK_ALLOWED(m, hl_tex_write(m->device, t, 0, data, 60));
    CK_ALLOWED(m, hl_tex_write(m->device, t, 1, data, 8));
    CK_ALLOWED(m, hl_tex_write(m->device, t, 2, data, 4));
    CK_REFUSED(m, hl_tex_write(m->device, t, 0, data, 59), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_tex_write: 60 bytes");
    CK_REFUSED(m, hl_tex_write(m->device, t, 1, data, 60), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_tex_write: 8 bytes");
    CK_REFUSED(m, hl_tex_write(m->device, t, 3, data, 4), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "no such level");
    assert_int_equal(hl_tex_write(m->device, t, 0, NULL, 60), HL_ERR_INVALID);
    assert_int_equal(hl_tex_write(NULL, t, 0, data, 60), HL_ERR_INVALID);
    CK_REFUSED(m, hl_tex_write(m->device, none, 0, data, 60), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_tex_write");
    d = plain(2, 2);
    d.usage = HL_TEX_TARGET;
    d.samples = 4;
    CK_ALLOWED(m, hl_tex_create(m->device, &ms, &d));
    CK_REFUSED(m, hl_tex_write(m->device, ms, 0, data, 16), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "multisampled");
    d.samples = 1;
    d.format = HL_FORMAT_D32_FLOAT;
    CK_ALLOWED(m, hl_tex_create(m->device, &depth, &d));
    CK_REFUSED(m, hl_tex_write(m->device, depth, 0, data, 16), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "depth");
    hl_tex_destroy(m->device, &t);
    hl_tex_destroy(m->device, &ms);
    hl_tex_destroy(m->device, &depth);
}

static void texture_reads_need_readback_and_their_bytes(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(5, 3);
    uint8_t data[60], back[60];
    hl_tex t, blind, ms, none = { 0 };
    for (int i = 0; i < 60; i++)
        data[i] = (uint8_t)(i * 5);
    CK_ALLOWED(m, hl_tex_create(m->device, &blind, &d));
    d.usage |= HL_TEX_READBACK;
    CK_ALLOWED(m, hl_tex_create(m->device, &t, &d));
    CK_ALLOWED(m, hl_tex_write(m->device, t, 0, data, 60));
    CK_ALLOWED(m, hl_tex_read(m->device, t, back, 60));
    assert_memory_equal(data, back, 60);
    CK_REFUSED(m, hl_tex_read(m->device, t, back, 59), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "hl_tex_read: 60 bytes");
    CK_REFUSED(m, hl_tex_read(m->device, blind, back, 60), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "HL_TEX_READBACK");
    CK_REFUSED(m, hl_tex_read(m->device, none, back, 60), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_tex_read");
    assert_int_equal(hl_tex_read(m->device, t, NULL, 60), HL_ERR_INVALID);
    assert_int_equal(hl_tex_read(NULL, t, back, 60), HL_ERR_INVALID);
    d.usage = HL_TEX_TARGET | HL_TEX_READBACK;
    d.samples = 4;
    CK_ALLOWED(m, hl_tex_create(m->device, &ms, &d));
    CK_REFUSED(m, hl_tex_read(m->device, ms, back, 60), HL_ERR_INVALID,
               HL_MSG_ARGUMENT, "one sample");
    hl_tex_destroy(m->device, &t);
    hl_tex_destroy(m->device, &blind);
    hl_tex_destroy(m->device, &ms);
}

/* ---- programs --------------------------------------------------------- */

static struct hl_prog_desc screen(void)
{
    struct hl_prog_desc p = {
        .label = "p", .vertex = { HL_SHADER_SCREEN_VERT, NULL },
        .fragment = { HL_SHADER_COUNT_FRAG, NULL }, .n_colors = 1,
        .color = { HL_FORMAT_R32_FLOAT } };
    return p;
}

static void prog_allowed(struct ck_machine *m, const struct hl_prog_desc *d)
{
    hl_prog p;
    CK_ALLOWED(m, hl_prog_create(m->device, &p, d));
    hl_prog_destroy(m->device, &p);
    assert_int_equal(p.id, 0);
}

static void prog_refused(struct ck_machine *m, const struct hl_prog_desc *d,
                         enum hl_result result, enum hl_log_id id,
                         const char *part)
{
    hl_prog p = { 77 };
    CK_REFUSED(m, hl_prog_create(m->device, &p, d), result, id, part);
    assert_int_equal(p.id, 0);
}

#define PROG_BAD(field, value, result, id, part)      \
    do {                                              \
        struct hl_prog_desc bad_ = screen();          \
        bad_.field = value;                           \
        prog_refused(m, &bad_, result, id, part);     \
    } while (0)
#define PROG_FINE(field, value)                       \
    do {                                              \
        struct hl_prog_desc fine_ = screen();         \
        fine_.field = value;                          \
        prog_allowed(m, &fine_);                      \
    } while (0)

static void program_stages_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_prog_desc p = screen();
    hl_prog out;
    prog_allowed(m, &p);
    assert_int_equal(hl_prog_create(NULL, &out, &p), HL_ERR_INVALID);
    assert_int_equal(hl_prog_create(m->device, NULL, &p), HL_ERR_INVALID);
    assert_int_equal(hl_prog_create(m->device, &out, NULL), HL_ERR_INVALID);
    PROG_BAD(vertex.builtin, HL_SHADER_NONE, HL_ERR_INVALID, HL_MSG_ARGUMENT,
             "hl_prog_desc.vertex");
    PROG_BAD(fragment.builtin, HL_SHADER_NONE, HL_ERR_INVALID,
             HL_MSG_ARGUMENT, "hl_prog_desc.fragment");
    PROG_BAD(vertex.builtin, HL_SHADER_COUNT, HL_ERR_INVALID,
             HL_MSG_ARGUMENT, "no such built-in");
    PROG_BAD(fragment.builtin, (enum hl_shader)-1, HL_ERR_INVALID,
             HL_MSG_ARGUMENT, "no such built-in");
    PROG_BAD(n_specs, HL_MAX_SPECS + 1, HL_ERR_INVALID, HL_MSG_ARGUMENT,
             "hl_prog_desc.n_specs");
    /* Depth alone needs no fragment stage. */
    p.fragment.builtin = HL_SHADER_NONE;
    p.n_colors = 0;
    p.depth = HL_FORMAT_D32_FLOAT;
    p.depth_test = HL_COMPARE_LESS;
    p.depth_write = true;
    prog_allowed(m, &p);
}

static void program_states_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    PROG_BAD(depth_write, true, HL_ERR_INVALID, HL_MSG_ARGUMENT,
             "hl_prog_desc.depth_write");
    PROG_BAD(blend, (enum hl_blend)(HL_BLEND_SHIFT + 1), HL_ERR_INVALID,
             HL_MSG_ARGUMENT, "hl_prog_desc.blend");
    PROG_FINE(blend, HL_BLEND_MAX);
    PROG_BAD(depth_test, (enum hl_compare)(HL_COMPARE_ALWAYS + 1),
             HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_prog_desc.depth_test");
    PROG_BAD(cull, (enum hl_cull)(HL_CULL_FRONT + 1), HL_ERR_INVALID,
             HL_MSG_ARGUMENT, "hl_prog_desc.cull");
    PROG_FINE(cull, HL_CULL_FRONT);
    PROG_BAD(topology, (enum hl_topology)(HL_TOPOLOGY_LINES + 1),
             HL_ERR_INVALID, HL_MSG_ARGUMENT, "hl_prog_desc.topology");
    PROG_BAD(layout.attr[7].format, (enum hl_attr_format)(HL_ATTR_F16X4 + 1),
             HL_ERR_INVALID, HL_MSG_ARGUMENT, "layout.attr: 7");
    struct hl_prog_desc p = screen();
    p.layout.attr[3].format = HL_ATTR_F32X2;
    p.layout.attr[3].stream = HL_MAX_STREAMS;
    prog_refused(m, &p, HL_ERR_INVALID, HL_MSG_ARGUMENT, "layout.attr: 3");
    p.layout.attr[3].stream = HL_MAX_STREAMS - 1;
    p.layout.stride[HL_MAX_STREAMS - 1] = 8;
    prog_allowed(m, &p);
    p.layout.attr[3].format = HL_ATTR_NONE;
    p.layout.attr[3].stream = 200;      /* not read                          */
    prog_allowed(m, &p);
}

static void program_targets_are_checked(void **state)
{
    struct ck_machine *m = ck_machine(state);
    PROG_BAD(n_colors, HL_MAX_COLORS + 1, HL_ERR_UNSUPPORTED,
             HL_MSG_ARGUMENT, "n_colors: 9");
    PROG_BAD(color[0], HL_FORMAT_NONE, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT,
             "NONE");
    PROG_BAD(color[0], HL_FORMAT_COUNT, HL_ERR_INVALID, HL_MSG_FORMAT,
             "hl_prog_desc.color");
    PROG_BAD(color[0], HL_FORMAT_D32_FLOAT, HL_ERR_INVALID, HL_MSG_FORMAT,
             "hl_prog_desc.color");
    PROG_BAD(depth, HL_FORMAT_R32_FLOAT, HL_ERR_INVALID, HL_MSG_FORMAT,
             "hl_prog_desc.depth");
    PROG_BAD(depth, HL_FORMAT_COUNT, HL_ERR_INVALID, HL_MSG_FORMAT,
             "hl_prog_desc.depth");
    PROG_FINE(depth, HL_FORMAT_D32_FLOAT);
    PROG_BAD(samples, 3, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT, "samples");
    PROG_BAD(samples, 16, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT, "samples");
    PROG_FINE(samples, 4);
    struct hl_prog_desc p = screen();
    p.color[0] = HL_FORMAT_R32_UINT;
    p.fragment.builtin = HL_SHADER_ID_PLAIN_FRAG;
    p.vertex.builtin = HL_SHADER_MESH_ID_VERT;
    prog_allowed(m, &p);
    p.blend = HL_BLEND_ADD;             /* integers do not blend             */
    prog_refused(m, &p, HL_ERR_UNSUPPORTED, HL_MSG_FORMAT, "R32_UINT");
}

/* ---- handles ---------------------------------------------------------- */

static void stale_handles_are_refused_not_followed(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(2, 2);
    uint8_t data[16] = { 9 }, back[16];
    hl_tex a, b;
    d.usage |= HL_TEX_READBACK;
    CK_ALLOWED(m, hl_tex_create(m->device, &a, &d));
    hl_tex old = a;
    hl_tex_destroy(m->device, &a);
    CK_ALLOWED(m, hl_tex_create(m->device, &b, &d));
    /* The slot is the same, the generation is not. */
    assert_int_equal(old.id & 0xffff, b.id & 0xffff);
    assert_int_not_equal(old.id, b.id);
    CK_ALLOWED(m, hl_tex_write(m->device, b, 0, data, 16));
    CK_REFUSED(m, hl_tex_write(m->device, old, 0, data, 16), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_tex_write");
    CK_REFUSED(m, hl_tex_read(m->device, old, back, 16), HL_ERR_INVALID,
               HL_MSG_HANDLE, "hl_tex_read");
    hl_tex stale = old;
    hl_tex_destroy(m->device, &stale);  /* clears it, harms nobody           */
    assert_int_equal(stale.id, 0);
    assert_true(hl_tex_live(m->device, b));
    CK_ALLOWED(m, hl_tex_read(m->device, b, back, 16));
    assert_memory_equal(data, back, 16);
    hl_tex wild = { 0x12345678 };
    assert_false(hl_tex_live(m->device, wild));
    hl_tex_destroy(m->device, &b);
    hl_tex_destroy(m->device, &b);
    hl_tex_destroy(m->device, NULL);
    hl_tex_destroy(NULL, &b);
}

static void closing_destroys_what_is_left(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct hl_tex_desc d = plain(2, 2);
    struct hl_prog_desc p = screen();
    hl_prog prog;
    hl_tex t;
    make_buf(m, 16, 0);
    CK_ALLOWED(m, hl_tex_create(m->device, &t, &d));
    CK_ALLOWED(m, hl_prog_create(m->device, &prog, &p));
    /* The teardown closes the device and counts what is left. */
}

#define ALL(name) \
    CK_ON("null", name), CK_ON("vulkan", name), CK_ON("gl", name), \
    CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ALL(a_device_needs_hooks_a_version_and_a_backend),
        ALL(devices_are_listed_and_counted),
        cmocka_unit_test(results_have_names_of_their_own),
        cmocka_unit_test(formats_have_rows_and_nonsense_has_none),
        ALL(buffers_are_checked),
        ALL(buffer_writes_stay_inside),
        ALL(texture_sizes_are_checked),
        ALL(texture_levels_and_samples_are_checked),
        ALL(texture_formats_are_checked),
        ALL(zero_is_the_default_of_a_texture),
        ALL(texture_writes_are_whole_levels),
        ALL(texture_reads_need_readback_and_their_bytes),
        ALL(program_stages_are_checked),
        ALL(program_states_are_checked),
        ALL(program_targets_are_checked),
        ALL(stale_handles_are_refused_not_followed),
        ALL(closing_destroys_what_is_left),
    };
    return cmocka_run_group_tests_name("hal", tests, NULL, NULL);
}
