/* SPDX-License-Identifier: Zlib */
/* packemu as a device: what each machine lacks, memory that runs out; a host
 * reads what it wrote, and targets keep what is drawn, on each. */
#include <string.h>
#include "tests/packemu_kit.h"

/* ---- the device ------------------------------------------------------- */

static int uses(const struct ck_machine *m, enum hl_format f)
{
    return hl_device_caps(m->device)->format[f].use;
}

/* Formats that a machine does not have, from spec/consoles.md 1.2 and 2.1. */
static void machines_lack_what_they_lack(void **state)
{
    static const struct {
        const struct hl_profile *profile;
        enum hl_format format;
        int has, lacks;
    } rows[] = {
        { NULL, HL_FORMAT_RG16_FIXED32, 0, 15 },
        { NULL, HL_FORMAT_D24_FLOAT_S8, 0, 15 },
        { NULL, HL_FORMAT_RGBA16_UNORM, 15, 0 },
        { NULL, HL_FORMAT_R32_UINT, HL_USE_SAMPLED | HL_USE_TARGET,
          HL_USE_LINEAR | HL_USE_BLEND },
        { NULL, HL_FORMAT_D32_FLOAT, HL_USE_SAMPLED | HL_USE_TARGET,
          HL_USE_LINEAR | HL_USE_BLEND },
        { &hl_profile_xbox360, HL_FORMAT_RG16_FIXED32, 15, 0 },
        { &hl_profile_xbox360, HL_FORMAT_RGB10A2_FLOAT, 15, 0 },
        { &hl_profile_xbox360, HL_FORMAT_RGBA16_FLOAT,
          HL_USE_SAMPLED | HL_USE_TARGET | HL_USE_LINEAR, HL_USE_BLEND },
        { &hl_profile_xbox360, HL_FORMAT_RG16_UNORM,
          HL_USE_SAMPLED | HL_USE_LINEAR, HL_USE_TARGET | HL_USE_BLEND },
        { &hl_profile_xbox360, HL_FORMAT_R32_UINT, 0, HL_USE_SAMPLED },
        { &hl_profile_ps3, HL_FORMAT_RG16_FIXED32, 0, 15 },
        { &hl_profile_ps3, HL_FORMAT_RG16_UNORM,
          HL_USE_SAMPLED | HL_USE_LINEAR, HL_USE_TARGET | HL_USE_BLEND },
        { &hl_profile_ps3, HL_FORMAT_RG16_FLOAT, HL_USE_SAMPLED,
          HL_USE_TARGET | HL_USE_BLEND },
        { &hl_profile_ps3, HL_FORMAT_RGBA16_FLOAT, 15, 0 },
        { &hl_profile_ps3, HL_FORMAT_RGBA32_FLOAT, HL_USE_TARGET,
          HL_USE_BLEND },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct ck_machine m;
        pk_open(&m, rows[i].profile);
        const struct hl_caps *c = hl_device_caps(m.device);
        int use = uses(&m, rows[i].format);
        if ((use & rows[i].has) != rows[i].has || (use & rows[i].lacks))
            fail_msg("%s on %s: use %d", hl_format_info(rows[i].format)->name,
                     c->profile.name, use);
        assert_true(!(use & HL_USE_TARGET) ==
                    !c->format[rows[i].format].samples);
        assert_true(c->console_memory == (rows[i].profile != NULL));
        ck_close(&m);
    }
}

/* Samples of formats that do not blend cannot be averaged (1.2). */
static void xenos_multisamples_what_it_blends(void **state)
{
    struct ck_machine m;
    (void)state;
    pk_open(&m, &hl_profile_xbox360);
    const struct hl_caps *c = hl_device_caps(m.device);
    assert_int_equal(c->samples, 7);
    assert_int_equal(c->format[HL_FORMAT_RGB10A2_FLOAT].samples, 7);
    assert_int_equal(c->format[HL_FORMAT_RGBA16_FLOAT].samples, 1);
    assert_int_equal(c->format[HL_FORMAT_D24_FLOAT_S8].samples, 7);
    ck_close(&m);
}

/* Whichever allocation fails, once or from then on: an error, nothing kept,
 * and all is well when asked again. */
static void memory_may_run_out_anywhere(void **state)
{
    static const struct hl_packemu_native one_thread = { 1 };
    (void)state;
    for (size_t i = 1, done = 0; !done; i++)
        for (int on = 0; on < 2; on++) {
            struct ck_machine m;
            const struct hl_tex_desc t = pk_desc(HL_FORMAT_RGBA8_UNORM, 9, 9,
                                                 1);
            struct hl_buf_desc b;
            hl_tex tex = { 0 };
            hl_buf buf = { 0 };
            memset(&m, 0, sizeof m);
            memset(&b, 0, sizeof b);
            b.bytes = 100;
            struct hl_device_desc d = ck_desc(&m);
            d.profile = &hl_profile_xbox360;
            d.native = &one_thread;
            m.memory.fail_at = i;
            m.memory.fail_on = on;
            enum hl_result r = hl_device_open(&m.device, &hl_backend_packemu,
                                              &d);
            if (r == HL_OK)
                r = hl_tex_create(m.device, &tex, &t);
            if (r == HL_OK)
                r = hl_buf_create(m.device, &buf, &b);
            done = r == HL_OK;
            if (r != HL_OK)
                assert_int_equal(r, HL_ERR_MEMORY);
            m.memory.fail_at = 0;
            m.memory.fail_on = false;
            if (m.device) {
                assert_int_equal(hl_tex_create(m.device, &tex, &t), HL_OK);
                assert_int_equal(hl_buf_create(m.device, &buf, &b), HL_OK);
            }
            hl_device_close(&m.device);
            assert_int_equal(m.memory.n_live, 0);
        }
}

/* Kept until the next waited submit, though passes go on. */
static void timings_are_of_the_last_submit(void **state)
{
    struct ck_machine m;
    struct hl_timing out[2];
    (void)state;
    pk_open(&m, NULL);
    struct pe_state *s = pk_state(&m);
    const char *labels[] = { "a", "b", "c" };
    for (uint32_t i = 0; i < 3; i++) {
        assert_true(hl_bk_grow(m.device, &s->timing, &s->max_timings,
                               s->n_timings + 1, sizeof *s->timing));
        s->timing[s->n_timings].label = labels[i];
        s->timing[s->n_timings++].ms = i;
        if (i == 1)
            assert_int_equal(hl_submit(m.device, true), HL_OK);
    }
    assert_int_equal(hl_timings(m.device, out, 2), 2);
    assert_string_equal(out[0].label, "a");
    assert_string_equal(out[1].label, "b");
    assert_int_equal(hl_submit(m.device, true), HL_OK);
    assert_int_equal(hl_timings(m.device, out, 1), 1);
    assert_string_equal(out[0].label, "c");
    ck_close(&m);
}

/* ---- host arrays ------------------------------------------------------ */

static void write_and_read(struct ck_machine *m, enum hl_format f)
{
    uint8_t data[7 * 5 * 16], back[sizeof data];
    uint64_t seed = 7;
    const struct hl_tex_desc d = pk_desc(f, 7, 5, 0);
    size_t n = 35u * hl_format_info(f)->bytes;
    if (!(hl_device_caps(m->device)->format[f].use & HL_USE_SAMPLED) ||
        hl_format_info(f)->kind == HL_KIND_DEPTH)
        return;
    for (size_t i = 0; i < n; i++)
        data[i] = (uint8_t)mk_random(&seed);
    hl_tex t = pk_make(m, &d);
    assert_int_equal(hl_tex_write(m->device, t, 0, data, n), HL_OK);
    assert_int_equal(hl_tex_read(m->device, t, back, n), HL_OK);
    assert_memory_equal(data, back, n);
    hl_tex_destroy(m->device, &t);
}

static void a_host_reads_what_it_wrote(void **state)
{
    (void)state;
    for (uint32_t i = 0; hl_profile_at(i); i++) {
        struct ck_machine m;
        pk_open(&m, hl_profile_at(i));
        for (int f = 1; f < HL_FORMAT_COUNT; f++)
            write_and_read(&m, (enum hl_format)f);
        ck_close(&m);
    }
}

/* A host's value is a number whatever its bytes: uint16_t here. */
static void a_host_s_numbers_are_channels(void **state)
{
    struct ck_machine m;
    const uint16_t data[6] = { 0, 0x1234, 0xffff, 1, 0xabcd, 0x8000 };
    float out[4];
    (void)state;
    for (uint32_t i = 0; hl_profile_at(i); i++) {
        pk_open(&m, hl_profile_at(i));
        struct hl_tex_desc d = pk_desc(HL_FORMAT_R16_UNORM, 3, 2, 0);
        hl_tex t = pk_make(&m, &d);
        assert_int_equal(hl_tex_write(m.device, t, 0, data, sizeof data),
                         HL_OK);
        struct pe_view v = pk_view(&m, t);
        for (int k = 0; k < 6; k++) {
            pe_fetch(&v, 0, k % 3, k / 3, out);
            assert_true(out[0] == (float)(data[k] / 65535.0));
        }
        ck_close(&m);
    }
}

static void a_write_to_a_target_is_drawn_on(void **state)
{
    struct ck_machine m;
    const struct hl_rect rect = { 0, 0, 100, 3 };
    uint32_t data[300], words[300];
    (void)state;
    for (uint32_t i = 0; i < 300; i++)
        data[i] = i * 0x01010101u;
    for (uint32_t i = 0; hl_profile_at(i); i++) {
        pk_open(&m, hl_profile_at(i));
        struct hl_tex_desc d = pk_desc(HL_FORMAT_R32_FLOAT, 100, 3, 1);
        hl_tex t = pk_make(&m, &d);
        assert_int_equal(hl_tex_write(m.device, t, 0, data, sizeof data),
                         HL_OK);
        pe_load_color(pk_state(&m), pk_slot(t), &rect, words);
        assert_memory_equal(words, data, sizeof data);
        ck_close(&m);
    }
}

static void depth_and_stencil_are_kept(void **state)
{
    enum { W = 61, H = 5 };
    static uint32_t codes[W * H * 8], back[W * H * 8];
    static uint8_t stencil[W * H * 8], stencil_back[W * H * 8];
    const struct hl_rect rect = { 0, 0, W, H };
    (void)state;
    for (uint32_t p = 0; hl_profile_at(p); p++)
        for (int i = HL_FORMAT_D16_UNORM; i < HL_FORMAT_COUNT; i++) {
            enum hl_format f = (enum hl_format)i;
            struct ck_machine m;
            pk_open(&m, hl_profile_at(p));
            const struct hl_format_caps *c = &hl_device_caps(m.device)
                                                  ->format[f];
            bool has = hl_format_info(f)->bits[1] > 0;
            for (uint32_t n = 1; n <= 8; n *= 2) {
                if (hl_format_info(f)->kind != HL_KIND_DEPTH ||
                    !(c->samples & n))
                    continue;
                struct hl_tex_desc d = pk_desc(f, W, H, n);
                uint32_t mask = 0xffffffffu >>
                                (32 - hl_format_info(f)->bits[0]);
                hl_tex t = pk_make(&m, &d);
                for (uint32_t k = 0; k < W * H * n; k++) {
                    codes[k] = (k * 2654435761u) & mask;
                    stencil[k] = (uint8_t)(k * 7);
                }
                pe_store_depth(pk_state(&m), pk_slot(t), &rect, codes,
                               has ? stencil : NULL);
                pe_load_depth(pk_state(&m), pk_slot(t), &rect, back,
                              has ? stencil_back : NULL);
                assert_memory_equal(codes, back, W * H * n * sizeof *codes);
                if (has)
                    assert_memory_equal(stencil, stencil_back, W * H * n);
                hl_tex_destroy(m.device, &t);
            }
            ck_close(&m);
        }
}

/* ---- samples ---------------------------------------------------------- */

static bool averages(const struct ck_machine *m, enum hl_format f,
                     uint32_t samples)
{
    const struct hl_format_caps *c = &hl_device_caps(m->device)->format[f];
    enum hl_format_kind kind = hl_format_info(f)->kind;
    return kind != HL_KIND_DEPTH && kind != HL_KIND_UINT &&
           (c->samples & samples) && (c->use & HL_USE_TARGET);
}

static hl_tex resolved(struct ck_machine *m, enum hl_format f, uint32_t w,
                       uint32_t samples, const uint32_t *words)
{
    struct hl_tex_desc d = pk_desc(f, w, 1, samples);
    d.usage = HL_TEX_TARGET;
    hl_tex t = pk_make(m, &d);
    d = pk_desc(f, w, 1, 1);
    if (f == HL_FORMAT_RG16_FIXED32 || f == HL_FORMAT_RGBA16_FIXED32) {
        d.console.resolve_number = HL_NUMBER_SIGNED;
        d.console.resolve_exp_bias = -5;
    }
    hl_tex r = pk_make(m, &d);
    pk_draw(m, t, r, words);
    hl_tex_destroy(m->device, &t);
    return r;
}

/* Random but finite words, each `samples` times: bits must come back. */
static void equal_samples(struct ck_machine *m, enum hl_format f,
                          uint32_t samples)
{
    enum { W = 100 };
    static uint32_t words[W * 8 * 4];
    float plane[4][W];
    const float *const rgba[4] = { plane[0], plane[1], plane[2], plane[3] };
    uint32_t one[W * 4], per = pe_words(f);
    uint64_t seed = 3;
    for (int i = 0; i < 4 * W; i++)
        plane[i / W][i % W] = mk_unit(&seed) * 3 - 1;
    pe_encode(f, rgba, W, one);
    for (uint32_t i = 0; i < W * samples; i++)
        memcpy(words + i * per, one + i / samples * per, per * 4);
    hl_tex r = resolved(m, f, W, samples, words);
    const struct pe_texture *t = pk_texture(m, r);
    pe_texels_load(t->memory, (enum pe_order)t->order,
                   hl_format_info(f)->bytes, 0, W, words);
    if (memcmp(words, one, W * per * 4) != 0)
        fail_msg("%s: equal samples have another average",
                 hl_format_info(f)->name);
    hl_tex_destroy(m->device, &r);
}

static void equal_samples_come_back(void **state)
{
    (void)state;
    for (uint32_t i = 0; hl_profile_at(i); i++) {
        struct ck_machine m;
        pk_open(&m, hl_profile_at(i));
        for (int f = 1; f < HL_FORMAT_COUNT; f++)
            for (uint32_t n = 2; n <= 8; n *= 2)
                if (averages(&m, (enum hl_format)f, n))
                    equal_samples(&m, (enum hl_format)f, n);
        ck_close(&m);
    }
}

static void samples_are_averaged(void **state)
{
    struct ck_machine m;
    (void)state;
    for (uint32_t i = 0; hl_profile_at(i); i++) {
        uint32_t words[4] = { 0x00010203u, 0xff000100u, 0xff7f0201u,
                              0x00800100u };
        float out[4];
        pk_open(&m, hl_profile_at(i));
        hl_tex r = resolved(&m, HL_FORMAT_RGBA8_UNORM, 1, 4, words);
        struct pe_view v = pk_view(&m, r);
        pe_fetch(&v, 0, 0, 0, out);
        /* Sums 4, 6, 256, 510 of four: 1, 2 of 1.5, 64, 128 of 127.5. */
        assert_true(out[0] == (float)(1 / 255.0));
        assert_true(out[1] == (float)(2 / 255.0));
        assert_true(out[2] == (float)(64 / 255.0));
        assert_true(out[3] == (float)(128 / 255.0));
        ck_close(&m);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(machines_lack_what_they_lack),
        cmocka_unit_test(xenos_multisamples_what_it_blends),
        cmocka_unit_test(memory_may_run_out_anywhere),
        cmocka_unit_test(timings_are_of_the_last_submit),
        cmocka_unit_test(a_host_reads_what_it_wrote),
        cmocka_unit_test(a_host_s_numbers_are_channels),
        cmocka_unit_test(a_write_to_a_target_is_drawn_on),
        cmocka_unit_test(depth_and_stencil_are_kept),
        cmocka_unit_test(equal_samples_come_back),
        cmocka_unit_test(samples_are_averaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
