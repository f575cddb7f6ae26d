/* SPDX-License-Identifier: Zlib */
/* The Vulkan backend: order of work, frames in flight, caches and memory,
 * seen from the inside. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "tests/vulkan_kit.h"

/* ---- barriers ----------------------------------------------------------- */

/* The layers of Vulkan 1.3.239 do not follow attachments of dynamic rendering,
 * so what happens between passes on one target is looked at by itself. */
static void every_write_is_waited_for(void **state)
{
    struct rig r = vt_rig(state);
    struct hlvk *v = vt_inside(r.d);
    struct hlvk_tex t = { .format = HL_FORMAT_RGBA8_UNORM, .mips = 1 };
    const VkImageMemoryBarrier2 *b = v->barriers;
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_COLOR, false);
    assert_int_equal(b[0].oldLayout, VK_IMAGE_LAYOUT_UNDEFINED);
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_COLOR, false);
    assert_int_equal(v->n_barriers, 2);
    assert_int_equal(b[1].oldLayout, b[0].newLayout);
    assert_int_equal(b[1].srcAccessMask,
                     VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    assert_int_equal(b[1].dstAccessMask,
                     VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT |
                     VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT);
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_SAMPLED, false);
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_SAMPLED, false);
    assert_int_equal(v->n_barriers, 3);
    assert_int_equal(b[2].srcAccessMask,
                     VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT);
    /* Contents may go, but not those of other levels. */
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_COLOR, true);
    assert_int_equal(b[3].oldLayout, VK_IMAGE_LAYOUT_UNDEFINED);
    assert_int_not_equal(b[3].srcStageMask, 0);
    t.mips = 2;
    hlvk_tex_use(v, VK_NULL_HANDLE, &t, HLVK_USE_COLOR, true);
    assert_int_equal(b[4].oldLayout, b[3].newLayout);
    v->n_barriers = 0;
}

/* ---- order and frames --------------------------------------------------- */

static void writes_and_passes_keep_their_order(void **state)
{
    struct rig r = vt_rig(state);
    hl_tex t = vt_tex(r.d, HL_FORMAT_R32_FLOAT, VT_SIDE, 1, HL_TEX_SAMPLED);
    struct hl_prog_desc p = vt_prog_desc(VT_FETCH);
    struct hl_texture_binding bind = { .tex = t };
    struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
    float data[VT_SIDE * VT_SIDE];
    hl_tex out[4];
    image got;
    draw.textures = &bind;
    draw.n_textures = 1;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < VT_SIDE * VT_SIDE; k++)
            data[k] = (float)i;
        out[i] = vt_tex(r.d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, 1,
                          HL_TEX_TARGET | HL_TEX_READBACK);
        assert_int_equal(hl_tex_write(r.d, t, 0, data, sizeof data), HL_OK);
        assert_int_equal(vt_run(r.d, out[i], &draw, 1), HL_OK);
    }
    for (int i = 0; i < 4; i++) {
        assert_int_equal(hl_tex_read(r.d, out[i], got, sizeof got), HL_OK);
        assert_true(got[7][7][0] == (float)i);
    }
}

/* On lavapipe all memory is mapped; take the map away to go by copies, as on
 * a GPU with memory of its own. */
static void buffers_that_are_not_mapped_are_copied_to(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
    hl_tex out[3];
    image got;
    vt_inside(r.d)->bufs[r.uniforms.id & 0xffff]->memory.map = NULL;
    for (int i = 0; i < 3; i++) {
        /* Object block and colour: the layers look at a dynamic range as if
         * its offset were 0. */
        struct hl_object_block object = vt_object(0.0f);
        float rows[2][VT_ROW / 4] = { { 0 }, { (float)i, 0, 0, 1 } };
        memcpy(rows[0], &object, sizeof object);
        out[i] = vt_tex(r.d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, 1,
                        HL_TEX_TARGET | HL_TEX_READBACK);
        assert_int_equal(hl_buf_write(r.d, r.uniforms, 0, rows, sizeof rows),
                         HL_OK);
        assert_int_equal(vt_run(r.d, out[i], &draw, 1), HL_OK);
    }
    for (int i = 0; i < 3; i++) {
        assert_int_equal(hl_tex_read(r.d, out[i], got, sizeof got), HL_OK);
        assert_true(got[0][0][0] == (float)i);
    }
}

static void two_buffers_in_turn_are_enough(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    hl_prog prog = vt_prog(r.d, &p);
    hl_buf turn[2] = { vt_uniforms(r.d), vt_uniforms(r.d) };
    hl_tex out[10];
    image got;
    for (int i = 0; i < 10; i++) {
        float color[4] = { (float)i, 0, 0, 1 };
        struct hl_draw draw = vt_draw(&r, prog);
        draw.uniform[HL_SLOT_MATERIAL].buf = turn[i % 2];
        out[i] = vt_tex(r.d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, 1,
                          HL_TEX_TARGET | HL_TEX_READBACK);
        assert_int_equal(hl_buf_write(r.d, turn[i % 2], VT_ROW, color, 16),
                         HL_OK);
        assert_int_equal(vt_run(r.d, out[i], &draw, 1), HL_OK);
        assert_int_equal(hl_submit(r.d, false), HL_OK);
    }
    for (int i = 0; i < 10; i++) {
        assert_int_equal(hl_tex_read(r.d, out[i], got, sizeof got), HL_OK);
        assert_true(got[1][1][0] == (float)i);
    }
}

static void objects_in_use_may_be_destroyed(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_FETCH);
    float data[VT_SIDE * VT_SIDE];
    image got;
    for (int i = 0; i < 40; i++) {
        hl_tex t = vt_tex(r.d, HL_FORMAT_R32_FLOAT, VT_SIDE, 1,
                            HL_TEX_SAMPLED);
        struct hl_texture_binding bind = { .tex = t };
        struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
        hl_buf uniforms = vt_uniforms(r.d);
        for (int k = 0; k < VT_SIDE * VT_SIDE; k++)
            data[k] = (float)i;
        draw.textures = &bind;
        draw.n_textures = 1;
        draw.uniform[HL_SLOT_OBJECT].buf = uniforms;
        assert_int_equal(hl_tex_write(r.d, t, 0, data, sizeof data), HL_OK);
        assert_int_equal(vt_run(r.d, r.target, &draw, 1), HL_OK);
        if (i % 3 == 0)
            assert_int_equal(hl_submit(r.d, false), HL_OK);
        hl_tex_destroy(r.d, &t);
        hl_buf_destroy(r.d, &uniforms);
        hl_prog_destroy(r.d, &draw.prog);
        /* The slot's next owner must not be taken for the last. */
    }
    vt_read(&r, got);
    assert_true(got[2][2][0] == 39.0f);
    assert_int_equal(hl_submit(r.d, true), HL_OK);
    assert_null(vt_inside(r.d)->garbage);
}

/* More bindings than a cache keeps: it is retired and comes back. */
static void sets_are_cached_and_the_cache_retired(void **state)
{
    enum { N = 5000, FRAMES = 5, BYTES = 16 + 3 * N };
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    hl_prog prog = vt_prog(r.d, &p);
    struct hl_buf_desc desc = { .bytes = BYTES, .usage = HL_BUF_UNIFORM,
                                .dynamic = true };
    struct hl_draw *draws = calloc(N, sizeof *draws);
    struct hlvk *v = vt_inside(r.d);
    image got;
    for (int f = 0; f < FRAMES; f++) {
        float color[4] = { (float)f, 0, 0, 1 };
        hl_buf big;
        assert_int_equal(hl_buf_create(r.d, &big, &desc), HL_OK);
        assert_int_equal(hl_buf_write(r.d, big, 0, color, 16), HL_OK);
        for (uint32_t i = 0; i < N; i++) {
            draws[i] = vt_draw(&r, prog);
            draws[i].uniform[HL_SLOT_MATERIAL] =
                (struct hl_range){ big, 0, 16 + 3 * i };
            draws[i].scissor = (struct hl_rect){ (int)i % VT_SIDE, 1, 1, 1 };
        }
        assert_int_equal(vt_run(r.d, r.target, draws, N), HL_OK);
        uint32_t sets = v->caches[v->cache].n_sets;
        assert_int_equal(vt_run(r.d, r.target, draws, N), HL_OK);
        assert_int_equal(v->caches[v->cache].n_sets, sets);
        assert_true(sets >= N && sets <= 3 * N);
        assert_int_equal(hl_submit(r.d, false), HL_OK);
        hl_buf_destroy(r.d, &big);
    }
    vt_read(&r, got);
    assert_true(got[1][5][0] == (float)(FRAMES - 1));
    free(draws);
}

static void every_pass_has_its_time(void **state)
{
    enum { N = 600 };        /* more than two query pools hold               */
    struct rig r = vt_rig(state);
    struct hl_timing t[N + 1];
    static char labels[N][16];
    double sum = 0.0;
    if (!hl_device_caps(r.d)->timestamps)
        skip();
    for (int i = 0; i < N; i++) {
        struct hl_pass pass = { .label = labels[i], .n_colors = 1 };
        snprintf(labels[i], sizeof labels[i], "p%d", i);
        pass.color[0].tex = r.target;
        assert_int_equal(hl_pass_run(r.d, &pass), HL_OK);
    }
    assert_int_equal(hl_submit(r.d, true), HL_OK);
    assert_int_equal(hl_timings(r.d, t, N + 1), N);
    for (int i = 0; i < N; i++) {
        assert_ptr_equal(t[i].label, labels[i]);
        assert_true(t[i].ms >= 0.0 && t[i].ms < 10000.0);
        sum += t[i].ms;
    }
    assert_true(sum > 0.0);
    assert_int_equal(hl_timings(r.d, t, 2), N);
    assert_int_equal(hl_submit(r.d, true), HL_OK);
    assert_int_equal(hl_timings(r.d, t, N), 0);
}

/* ---- memory ------------------------------------------------------------- */

static void what_is_too_large_is_refused_and_nothing_else(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_buf_desc buf = { .bytes = (size_t)1 << 46 };
    uint32_t side = hl_device_caps(r.d)->max_tex_dim;
    struct hl_tex_desc tex = { .format = HL_FORMAT_RGBA32_FLOAT,
                               .width = side, .height = side };
    hl_buf b;
    hl_tex t;
    /* The software device's memory is the hooks': they have 2 GiB here too. */
    r.m->memory.max_bytes = (size_t)1 << 31;
    assert_int_equal(hl_buf_create(r.d, &b, &buf), HL_ERR_MEMORY);
    assert_int_equal(b.id, 0);
    vt_assert_usable(&r);
    /* 4 GiB at the least: more than lavapipe's heap of 2. */
    enum hl_result result = hl_tex_create(r.d, &t, &tex);
    if (hl_device_caps(r.d)->kind == HL_DEVICE_CPU)
        assert_int_equal(result, HL_ERR_MEMORY);
    hl_tex_destroy(r.d, &t);
    vt_assert_usable(&r);
}

static uint32_t count_blocks(const struct hlvk *v)
{
    uint32_t n = 0;
    for (const struct hlvk_block *b = v->blocks; b; b = b->next)
        n++;
    return n;
}

/* Objects of all sizes come and go; blocks are shared and given back. */
static void blocks_are_shared_and_given_back(void **state)
{
    enum { N = 400, SIZES = 300000 };
    struct rig r = vt_rig(state);
    struct hlvk *v = vt_inside(r.d);
    uint64_t seed = mk_seed();
    hl_buf b[N] = { { 0 } };
    uint32_t stamp[N] = { 0 }, before = count_blocks(v);
    /* Else all that is destroyed waits for the frame that records. */
    assert_int_equal(hl_submit(r.d, true), HL_OK);
    for (uint32_t i = 0; i < 4 * N; i++) {
        uint32_t at = mk_below(&seed, N), bytes = 4 + mk_below(&seed, SIZES);
        struct hl_buf_desc desc = { .bytes = bytes, .dynamic = true };
        hl_buf_destroy(r.d, &b[at]);
        assert_int_equal(hl_buf_create(r.d, &b[at], &desc), HL_OK);
        stamp[at] = i + 1;
        assert_int_equal(hl_buf_write(r.d, b[at], bytes - 4, &stamp[at], 4),
                         HL_OK);
        assert_int_equal(hl_buf_write(r.d, b[at], 0, &stamp[at], 4), HL_OK);
    }
    for (int i = 0; i < N; i++) {
        if (!b[i].id)
            continue;
        const struct hlvk_buf *x = v->bufs[b[i].id & 0xffff];
        assert_memory_equal(x->memory.map, &stamp[i], 4);
        assert_memory_equal(x->memory.map + x->bytes - 4, &stamp[i], 4);
    }
    assert_true(count_blocks(v) > before && count_blocks(v) < before + 20);
    for (int i = 0; i < N; i++)
        hl_buf_destroy(r.d, &b[i]);
    assert_true(count_blocks(v) <= before + 1);
    vt_assert_usable(&r);
}

/* Everything that a frame may allocate, once. */
static enum hl_result small_life(struct hl_device_desc *desc)
{
    struct hl_device *d;
    enum hl_result r = hl_device_open(&d, &hl_backend_vulkan, desc);
    if (r)
        return r;
    struct hl_tex_desc tex = { .width = 4, .height = 4,
                               .usage = HL_TEX_TARGET | HL_TEX_READBACK };
    struct hl_buf_desc buf = { .bytes = sizeof vt_quad, .data = vt_quad };
    struct hl_prog_desc prog = vt_prog_desc(VT_OWN_COLOR);
    struct hl_draw draw = { .count = 6 };
    unsigned char got[64];
    hl_tex t = { 0 };
    prog.color[0] = HL_FORMAT_RGBA8_UNORM;
    r = hl_tex_create(d, &t, &tex);
    if (!r)
        r = hl_buf_create(d, &draw.vertex[0], &buf);
    if (!r)
        r = hl_prog_create(d, &draw.prog, &prog);
    if (!r)
        r = vt_run(d, t, &draw, 1);
    if (!r)
        r = hl_tex_read(d, t, got, sizeof got);
    hl_device_close(&d);
    return r;
}

static void every_host_allocation_may_fail(void **state)
{
    struct mk_memory memory = { 0 };
    struct hl_device_desc desc = { .version = HL_VERSION,
                                   .hooks = mk_hooks(&memory) };
    ck_machine(state);
    assert_int_equal(small_life(&desc), HL_OK);
    size_t n = memory.n_allocs;
    print_message("%zu allocations\n", n);
    assert_true(n > 20);
    for (size_t i = 1; i <= n; i++) {
        memory = (struct mk_memory){ .fail_at = i };
        enum hl_result r = small_life(&desc);
        assert_true(r == HL_ERR_MEMORY || r == HL_OK);
        assert_int_equal(memory.n_live, 0);
    }
}

static void a_lost_device_says_so_from_then_on(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
    assert_int_equal(vt_run(r.d, r.target, &draw, 1), HL_OK);
    assert_int_equal(hlvk_check(vt_inside(r.d), VK_ERROR_DEVICE_LOST, "test"),
                     HL_ERR_DEVICE_LOST);
    assert_int_equal(hl_submit(r.d, true), HL_ERR_DEVICE_LOST);
    assert_int_equal(vt_run(r.d, r.target, &draw, 1), HL_ERR_DEVICE_LOST);
}

#define ON(name) CK_ON("vulkan", name)
#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON(every_write_is_waited_for),
        DRAWN(writes_and_passes_keep_their_order),
        ON(buffers_that_are_not_mapped_are_copied_to),
        DRAWN(two_buffers_in_turn_are_enough),
        ON(objects_in_use_may_be_destroyed),
        ON(sets_are_cached_and_the_cache_retired),
        DRAWN(every_pass_has_its_time),
        DRAWN(what_is_too_large_is_refused_and_nothing_else),
        ON(blocks_are_shared_and_given_back),
        ON(every_host_allocation_may_fail),
        ON(a_lost_device_says_so_from_then_on),
    };
    return cmocka_run_group_tests_name("vulkan frames", tests, NULL, NULL);
}
