/* SPDX-License-Identifier: Zlib */
/* The Vulkan backend: what the suite over all backends cannot ask of devices,
 * formats and pictures; GL and the software device draw the pictures too.
 * Validation with synchronisation checks is on; every test fails on an error
 * that the layers report, and the canary proves that they would. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "tests/vulkan_kit.h"

static const uint32_t all_spirv[] = {
#include "vulkan_all_frag.x"
};

/* ---- choosing a device -------------------------------------------------- */

static enum hl_result open_as(struct ck_machine *m, const char *name)
{
    struct hl_device_desc desc = ck_desc(m);
    desc.device = name;
    return hl_device_open(&m->device, &hl_backend_vulkan, &desc);
}

static void opens_by_index_and_by_part_of_a_name(void **state)
{
    struct ck_machine *here = ck_machine(state), m;
    struct hl_device_info info[4];
    struct hl_hooks hooks = mk_hooks(&here->memory);
    uint32_t n;
    char part[8];
    assert_int_equal(hl_devices_list(&hl_backend_vulkan, &hooks, info, 4, &n),
                     HL_OK);
    assert_true(n >= 1);
    assert_string_equal(info[0].name, hl_device_caps(here->device)->device);
    for (int i = 0; i < 5; i++)
        part[i] = (char)(info[0].name[i] ^ (info[0].name[i] >= 'a' ? 32 : 0));
    part[5] = '\0';
    const char *good[] = { "0", info[0].name, part, "" };
    for (int i = 0; i < 4; i++) {
        memset(&m, 0, sizeof m);
        assert_int_equal(open_as(&m, good[i]), HL_OK);
        assert_string_equal(hl_device_caps(m.device)->device, info[0].name);
        ck_close(&m);
    }
    const char *bad[] = { "999999999999", "no such machine" };
    for (int i = 0; i < 2; i++) {
        memset(&m, 0, sizeof m);
        assert_int_equal(open_as(&m, bad[i]), HL_ERR_NO_DEVICE);
        ck_refused(&m, 0, HL_MSG_DEVICE, bad[i]);
        assert_int_equal(m.memory.n_live, 0);
    }
}

static void caps_are_whole(void **state)
{
    const struct hl_caps *c = hl_device_caps(ck_machine(state)->device);
    assert_string_equal(c->backend, "vulkan");
    assert_true(c->device[0] && c->driver[0] && c->clip_zero_to_one);
    /* What the Vulkan specification requires of every device. */
    assert_true(c->max_tex_dim >= 4096 && c->max_colors >= 4);
    assert_true(c->max_uniform_bytes >= 16384 && c->uniform_align <= 256);
    assert_true((c->samples & 5) == 5);
    assert_int_equal(c->format[HL_FORMAT_RGBA8_UNORM].use, 15);
    assert_true(c->format[HL_FORMAT_D16_UNORM].use & HL_USE_TARGET);
    for (int i = 1; i < HL_FORMAT_COUNT; i++)
        assert_int_equal((c->format[i].use & HL_USE_TARGET) != 0,
                         c->format[i].samples & 1);
}

/* ---- the embedder's device ---------------------------------------------- */

static VkInstance own_instance(void)
{
    static const char *const layer = "VK_LAYER_KHRONOS_validation";
    static const char *const debug = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    VkApplicationInfo app = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                              .apiVersion = VK_API_VERSION_1_3 };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pApplicationInfo = &app,
        .enabledLayerCount = 1, .ppEnabledLayerNames = &layer,
        .enabledExtensionCount = 1, .ppEnabledExtensionNames = &debug
    };
    VkInstance instance = VK_NULL_HANDLE;
    if (vkCreateInstance(&info, NULL, &instance) == VK_SUCCESS)
        return instance;
    info.enabledLayerCount = info.enabledExtensionCount = 0;
    assert_int_equal(vkCreateInstance(&info, NULL, &instance), VK_SUCCESS);
    return instance;
}

static struct hl_vulkan_native own_device(void)
{
    static const float priority = 1.0f;
    struct hl_vulkan_native n = { .instance = own_instance() };
    VkPhysicalDeviceVulkan13Features f13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
        .synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE,
        .maintenance4 = VK_TRUE
    };
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueCount = 1, .pQueuePriorities = &priority
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &f13,
        .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue
    };
    VkPhysicalDevice all[16];
    uint32_t n_all = 16;
    assert_true(vkEnumeratePhysicalDevices(n.instance, &n_all, all) >= 0);
    for (uint32_t i = 0; i < n_all && !n.physical; i++)
        if (hlvk_usable(all[i], &n.family))
            n.physical = all[i];
    assert_non_null(n.physical);
    queue.queueFamilyIndex = n.family;
    assert_int_equal(vkCreateDevice(n.physical, &info, NULL, &n.device),
                     VK_SUCCESS);
    vkGetDeviceQueue(n.device, n.family, 0, &n.queue);
    return n;
}

static void an_embedders_device_is_used_and_kept(void **state)
{
    struct ck_machine m;
    VkFenceCreateInfo info = { .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO };
    VkFence fence;
    ck_machine(state);
    struct hl_vulkan_native n = own_device();
    for (int i = 0; i < 2; i++) {
        assert_true(ck_open(&m, "vulkan", &n));
        struct rig r = vt_rig_on(m.device);
        vt_assert_usable(&r);
        assert_ptr_equal(vt_inside(m.device)->vk, n.device);
        ck_close(&m);
    }
    assert_int_equal(vkCreateFence(n.device, &info, NULL, &fence),
                     VK_SUCCESS);
    assert_int_equal(vkQueueSubmit(n.queue, 0, NULL, fence), VK_SUCCESS);
    assert_int_equal(vkWaitForFences(n.device, 1, &fence, VK_TRUE,
                                     UINT64_MAX), VK_SUCCESS);
    vkDestroyFence(n.device, fence, NULL);
    vkDestroyDevice(n.device, NULL);
    vkDestroyInstance(n.instance, NULL);
}

static void devices_are_independent(void **state)
{
    struct rig r = vt_rig(state);
    struct ck_machine other;
    assert_true(ck_open(&other, "vulkan", NULL));
    struct rig s = vt_rig_on(other.device);
    vt_assert_usable(&r);
    vt_assert_usable(&s);
    vt_assert_usable(&r);
    ck_close(&other);
    vt_assert_usable(&r);
}


/* ---- validation --------------------------------------------------------- */

static void count_only(void *user, enum hl_log_level level, enum hl_log_id id,
                       const char *text)
{
    struct ck_machine *m = user;
    m->errors += level == HL_LOG_ERROR;
    m->warnings += level == HL_LOG_WARNING;
    (void)id;
    (void)text;
}

/* Two copies, the second of what the first writes. */
static void copy_twice(struct hlvk *v, const VkBuffer b[3], bool barrier)
{
    VkMemoryBarrier2 between = {
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, NULL,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT
    };
    VkDependencyInfo info = { .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                              .memoryBarrierCount = 1,
                              .pMemoryBarriers = &between };
    VkBufferCopy all = { 0, 0, 256 };
    struct hlvk_frame *f;
    assert_int_equal(hlvk_begin(v, &f), HL_OK);
    vkCmdCopyBuffer(f->cmd, b[0], b[1], 1, &all);
    if (barrier)
        vkCmdPipelineBarrier2(f->cmd, &info);
    vkCmdCopyBuffer(f->cmd, b[1], b[2], 1, &all);
    assert_int_equal(hlvk_submit(v, true), HL_OK);
}

static void a_missing_barrier_is_counted(void **state)
{
    struct ck_machine m = { 0 };
    struct hl_device_desc desc = ck_desc(&m);
    ck_machine(state);
    desc.log = count_only;
    assert_int_equal(hl_device_open(&m.device, &hl_backend_vulkan, &desc),
                     HL_OK);
    struct hlvk *v = vt_inside(m.device);
    if (m.warnings) {
        hl_device_close(&m.device);
        print_message("skipped: no validation layer\n");
        skip();
    }
    VkBuffer b[3];
    struct hlvk_memory memory[3] = { { 0 } };
    for (int i = 0; i < 3; i++)
        assert_int_equal(hlvk_buf_make(v, 256,
                                       VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                                           VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                       HLVK_LOCAL, &b[i], &memory[i]), HL_OK);
    copy_twice(v, b, true);
    assert_int_equal(hl_device_validation_errors(m.device), 0);
    copy_twice(v, b, false);
    assert_int_equal(hl_device_validation_errors(m.device), 1);
    for (int i = 0; i < 3; i++)
        hlvk_buf_unmake(v, b[i], &memory[i]);
    hl_device_close(&m.device);
    assert_int_equal(m.memory.n_live, 0);
    assert_int_equal(m.errors, 1);
}

/* ---- formats ------------------------------------------------------------ */

/* The code of 0 or 1 in a channel of that many bits. */
static uint64_t code_of(enum hl_format_kind kind, unsigned bits, int one)
{
    if (!one)
        return 0;
    if (kind == HL_KIND_UINT)
        return 1;
    if (kind == HL_KIND_SNORM)
        return ((uint64_t)1 << (bits - 1)) - 1;
    if (kind != HL_KIND_FLOAT)
        return ((uint64_t)1 << bits) - 1;
    /* Exponent bias 127, or 15 with five exponent bits; no sign below 16. */
    return bits == 32 ? 0x3f800000u : bits == 16 ? 0x3c00u
         : (uint64_t)15 << (bits - 5);
}

/* 1, 0, 1, 0 in the format's bits; channels from the lowest bit up. */
static void expect_texel(const struct hl_format_info *f, unsigned char *out)
{
    unsigned at = 0;
    memset(out, 0, f->bytes);
    for (int c = 0; c < f->channels; c++) {
        uint64_t code = code_of(f->kind, f->bits[c], c % 2 == 0);
        for (unsigned b = 0; b < f->bits[c]; b++, at++)
            out[at / 8] |= (unsigned char)((code >> b & 1) << at % 8);
    }
}

static void clear_color_format(struct hl_device *d, enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    hl_tex t = vt_tex(d, format, 4, 1, HL_TEX_TARGET | HL_TEX_READBACK);
    struct hl_pass pass = { .n_colors = 1 };
    unsigned char got[256], want[16];
    pass.color[0] = (struct hl_target){ .tex = t, .load = HL_LOAD_CLEAR,
                                        .clear = { 1, 0, 1, 0 } };
    assert_int_equal(hl_pass_run(d, &pass), HL_OK);
    assert_int_equal(hl_tex_read(d, t, got, 16u * f->bytes), HL_OK);
    expect_texel(f, want);
    for (int i = 0; i < 16; i++)
        if (memcmp(got + i * f->bytes, want, f->bytes))
            fail_msg("%s: texel %d is not 1,0,1,0", f->name, i);
    hl_tex_destroy(d, &t);
}

static void clear_depth_format(struct hl_device *d, enum hl_format format)
{
    const struct hl_format_info *f = hl_format_info(format);
    hl_tex t = vt_tex(d, format, 4, 1, HL_TEX_TARGET | HL_TEX_READBACK);
    struct hl_pass pass = { .depth = { .tex = t, .load = HL_LOAD_CLEAR,
                                       .clear = { 0.3f } } };
    float got[16];
    assert_int_equal(hl_pass_run(d, &pass), HL_OK);
    assert_int_equal(hl_tex_read(d, t, got, sizeof got), HL_OK);
    /* Half a step of the stored code, and a rounding of its quotient. */
    double step = f->bits[0] == 32 ? 0.0 : 1.0 / (exp2(f->bits[0]) - 1.0);
    for (int i = 0; i < 16; i++)
        ck_near(got[i], (double)0.3f, 0.5 * step + 0x1p-25);
    hl_tex_destroy(d, &t);
}

static void every_format_clears_and_reads(void **state)
{
    struct hl_device *d = ck_machine(state)->device;
    int n = 0;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        enum hl_format f = (enum hl_format)i;
        if (!(hl_device_caps(d)->format[i].use & HL_USE_TARGET))
            continue;
        n++;
        if (hl_format_info(f)->kind == HL_KIND_DEPTH)
            clear_depth_format(d, f);
        else
            clear_color_format(d, f);
    }
    assert_true(n >= 10);
}

static void every_format_keeps_what_is_written(void **state)
{
    struct hl_device *d = ck_machine(state)->device;
    uint64_t seed = mk_seed();
    unsigned char data[32 * 32 * 16], got[sizeof data];
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)mk_random(&seed);
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        const struct hl_format_info *f = hl_format_info((enum hl_format)i);
        size_t bytes = 32u * 32u * f->bytes;
        if (f->kind == HL_KIND_DEPTH ||
            !(hl_device_caps(d)->format[i].use & HL_USE_SAMPLED))
            continue;
        hl_tex t = vt_tex(d, (enum hl_format)i, 32, 1,
                            HL_TEX_SAMPLED | HL_TEX_READBACK);
        assert_int_equal(hl_tex_write(d, t, 0, data, bytes), HL_OK);
        memset(got, 0, bytes);
        assert_int_equal(hl_tex_read(d, t, got, bytes), HL_OK);
        assert_memory_equal(got, data, bytes);
        hl_tex_destroy(d, &t);
    }
}

static void every_format_is_sampled(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_FETCH);
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        const struct hl_format_info *f = hl_format_info((enum hl_format)i);
        unsigned char data[VT_SIDE * VT_SIDE * 16];
        image got;
        if (f->kind == HL_KIND_DEPTH || f->kind == HL_KIND_UINT ||
            !(hl_device_caps(r.d)->format[i].use & HL_USE_SAMPLED))
            continue;
        for (int k = 0; k < VT_SIDE * VT_SIDE; k++)
            expect_texel(f, data + k * f->bytes);
        hl_tex t = vt_tex(r.d, (enum hl_format)i, VT_SIDE, 1, HL_TEX_SAMPLED);
        struct hl_texture_binding bind = { .tex = t };
        size_t bytes = (size_t)VT_SIDE * VT_SIDE * f->bytes;
        assert_int_equal(hl_tex_write(r.d, t, 0, data, bytes), HL_OK);
        vt_draw_one(&r, &p, &bind, got);
        /* Absent colour channels read 0, absent alpha 1. */
        for (int c = 0; c < 4; c++)
            assert_true(got[5][6][c] == (c == 3 ? (float)(f->channels < 4)
                                         : c % 2 == 0 && c < f->channels));
        hl_tex_destroy(r.d, &t);
    }
}

/* The same bytes as two 16-bit channels and as one integer. */
static void bytes_are_seen_as_another_format(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_tex_desc desc = {
        .format = HL_FORMAT_RGBA8_UNORM, .sample_as = HL_FORMAT_RG16_UNORM,
        .width = VT_SIDE, .height = VT_SIDE,
        .usage = HL_TEX_SAMPLED | HL_TEX_TARGET
    };
    struct hl_texture_binding bind = { { 0 }, 0, 0, 0 };
    struct hl_prog_desc p = vt_prog_desc(VT_FETCH);
    struct hl_pass pass = { .n_colors = 1 };
    image got;
    assert_int_equal(hl_tex_create(r.d, &bind.tex, &desc), HL_OK);
    pass.color[0] = (struct hl_target){
        .tex = bind.tex, .load = HL_LOAD_CLEAR,
        .clear = { 1 / 255.0f, 2 / 255.0f, 3 / 255.0f, 4 / 255.0f } };
    assert_int_equal(hl_pass_run(r.d, &pass), HL_OK);
    vt_draw_one(&r, &p, &bind, got);
    /* A float next to the quotient: one rounding of the conversion. */
    ck_near(got[0][0][0], 0x0201 / 65535.0, 0x1p-24);
    ck_near(got[0][0][1], 0x0403 / 65535.0, 0x1p-24);
}

/* ---- geometry ----------------------------------------------------------- */

static void row_zero_is_the_top_and_winding_is_as_seen(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_FRAG_COORD);
    image got;
    vt_draw_one(&r, &p, NULL, got);
    for (int y = 0; y < VT_SIDE; y++)
        for (int x = 0; x < VT_SIDE; x++) {
            assert_true(got[y][x][0] == (float)x + 0.5f);
            assert_true(got[y][x][1] == (float)y + 0.5f);
            assert_true(got[y][x][2] == 0.5f);
            /* Top left, bottom left, bottom right: counter-clockwise. */
            assert_true(got[y][x][3] == 1.0f);
        }
    for (int i = 0; i < 4; i++) {
        p.cull = i & 1 ? HL_CULL_FRONT : HL_CULL_BACK;
        p.mirrored = i & 2;
        vt_draw_one(&r, &p, NULL, got);
        assert_true((got[4][4][0] != 0.0f) == (i == 0 || i == 3));
    }
}

static void an_absent_attribute_is_0001(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_prog_desc p = vt_prog_desc(VT_VERTEX_COLOR);
    image got;
    vt_draw_one(&r, &p, NULL, got);
    for (int c = 0; c < 4; c++)
        assert_true(got[3][3][c] == (c == 3 ? 1.0f : 0.0f));
    p = vt_prog_desc(VT_UNBOUND);
    vt_draw_one(&r, &p, NULL, got);
    assert_true(got[3][3][0] == 1.0f && got[3][3][3] == 1.0f);
}

/* Neighbouring draws whose programs read different slots, moved or not. */
static void programs_of_unlike_bindings_share_a_pass(void **state)
{
    static const struct hl_code code = { all_spirv, sizeof all_spirv, NULL,
                                         NULL };
    static const float data[128] = { 3.0f, 5.0f, [64] = 9.0f };
    struct rig r = vt_rig(state);
    struct hl_buf_desc storage = { .bytes = sizeof data, .data = data,
                                   .usage = HL_BUF_STORAGE };
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR), q = p;
    hl_buf s;
    image got;
    q.fragment.code = &code;
    assert_int_equal(hl_buf_create(r.d, &s, &storage), HL_OK);
    hl_prog a = vt_prog(r.d, &p), b = vt_prog(r.d, &q);
    struct hl_draw draws[VT_SIDE];
    for (int i = 0; i < VT_SIDE; i++) {
        draws[i] = vt_draw(&r, i / 2 % 2 ? b : a);
        draws[i].uniform[HL_SLOT_MATERIAL].offset = (uint32_t)(i + 1) * VT_ROW;
        draws[i].storage[0] = (struct hl_range){ s, 0, 256 };
        draws[i].storage[1] = (struct hl_range){ s, 256, 256 };
        draws[i].scissor = (struct hl_rect){ i, 0, 1, VT_SIDE };
    }
    for (int pass = 0; pass < 3; pass++)
        assert_int_equal(vt_run(r.d, r.target, draws, pass == 1 ? 1 : VT_SIDE),
                         HL_OK);
    /* The pass without storage buffers does not pay for the one before. */
    struct hlvk *v = vt_inside(r.d);
    assert_int_equal(v->frames[v->frame].n_cmds, 2);
    vt_read(&r, got);
    for (int i = 0; i < VT_SIDE; i++) {
        float want[4] = { (float)(i + 1) / 8.0f, 0.25f, 0.0f, 1.0f };
        const float all[4] = { 7.0f, 0.25f, 5.0f, 9.0f };
        assert_memory_equal(got[2][i], i / 2 % 2 ? all : want, sizeof want);
    }
}

static void samples_resolve_to_their_mean(void **state)
{
    struct rig r = vt_rig(state);
    uint32_t samples = hl_device_caps(r.d)->samples & 4;
    hl_tex many = vt_tex(r.d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, samples,
                           HL_TEX_TARGET);
    hl_tex depth = vt_tex(r.d, HL_FORMAT_D32_FLOAT, VT_SIDE, samples,
                            HL_TEX_TARGET);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    p.samples = samples;
    p.depth = HL_FORMAT_D32_FLOAT;
    p.depth_test = HL_COMPARE_LESS;
    p.depth_write = true;
    struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
    struct hl_pass pass = { .n_colors = 1, .draws = &draw, .n_draws = 1 };
    image got;
    /* Move the quad's left edge to x = 2.5 pixels: two of the four standard
     * sample positions of that pixel lie left of its centre. */
    struct hl_object_block object = vt_object(2.5f * 2.0f / VT_SIDE);
    assert_int_equal(hl_buf_write(r.d, r.uniforms, 0, &object,
                                  sizeof object), HL_OK);
    pass.color[0] = (struct hl_target){ .tex = many, .load = HL_LOAD_CLEAR,
                                        .discard = true,
                                        .resolve = r.target };
    pass.depth = (struct hl_target){ .tex = depth, .load = HL_LOAD_CLEAR,
                                     .discard = true, .clear = { 1 } };
    assert_int_equal(hl_pass_run(r.d, &pass), HL_OK);
    vt_read(&r, got);
    for (int x = 0; x < VT_SIDE; x++)
        assert_true(got[4][x][0] ==
                    (x < 2 ? 0.0f : x == 2 ? 0.0625f : 0.125f));
}

/* One pass tests against the depth that it samples, read-only; the next one
 * writes it again, keeping what is there. */
static void depth_is_tested_and_sampled_at_once(void **state)
{
    struct rig r = vt_rig(state);
    hl_tex depth = vt_tex(r.d, HL_FORMAT_D32_FLOAT, VT_SIDE, 1,
                            HL_TEX_TARGET | HL_TEX_SAMPLED | HL_TEX_READBACK);
    struct hl_prog_desc p = vt_prog_desc(VT_FETCH), z = p;
    p.depth = z.depth = HL_FORMAT_D32_FLOAT;
    p.depth_test = HL_COMPARE_LESS_EQUAL;
    z.depth_test = HL_COMPARE_LESS;
    z.depth_write = true;
    z.n_colors = 0;
    z.fragment.code = NULL;
    struct hl_texture_binding bind = { .tex = depth };
    struct hl_draw look = vt_draw(&r, vt_prog(r.d, &p));
    struct hl_draw fill = vt_draw(&r, vt_prog(r.d, &z));
    struct hl_pass pass = { .draws = &fill, .n_draws = 1 };
    image got;
    float d32[VT_SIDE][VT_SIDE];
    look.textures = &bind;
    look.n_textures = 1;
    fill.scissor = (struct hl_rect){ 0, 0, VT_SIDE / 2, VT_SIDE };
    for (int i = 0; i < 2; i++) {
        pass = (struct hl_pass){ .draws = &fill, .n_draws = 1 };
        pass.depth = (struct hl_target){
            .tex = depth, .load = i ? HL_LOAD_KEEP : HL_LOAD_CLEAR,
            .clear = { 0.75f } };
        assert_int_equal(hl_pass_run(r.d, &pass), HL_OK);
        pass = (struct hl_pass){ .n_colors = 1, .draws = &look, .n_draws = 1,
                                 .depth_read_only = true };
        pass.depth.tex = depth;
        pass.color[0] = (struct hl_target){ .tex = r.target,
                                            .load = HL_LOAD_CLEAR };
        assert_int_equal(hl_pass_run(r.d, &pass), HL_OK);
        fill.scissor.width = VT_SIDE;
    }
    vt_read(&r, got);
    assert_int_equal(hl_tex_read(r.d, depth, d32, sizeof d32), HL_OK);
    for (int x = 0; x < VT_SIDE; x++) {
        assert_true(got[3][x][0] == 0.5f);
        assert_true(d32[3][x] == 0.5f);
    }
}

static void only_trilinear_looks_past_level_zero(void **state)
{
    struct rig r = vt_rig(state);
    struct hl_tex_desc desc = { .format = HL_FORMAT_R32_FLOAT, .width = 2,
                                .height = 2, .mips = 2 };
    const float zero[4] = { 0, 0, 0, 0 }, one = 1.0f, half = 0.5f;
    struct hl_texture_binding bind = { { 0 }, 0, 0, 0 };
    struct hl_prog_desc p = vt_prog_desc(VT_SAMPLE);
    image got;
    p.spec[1].id = 1;
    memcpy(&p.spec[1].value, &half, 4);
    p.n_specs = 2;
    assert_int_equal(hl_tex_create(r.d, &bind.tex, &desc), HL_OK);
    assert_int_equal(hl_tex_write(r.d, bind.tex, 0, zero, 16), HL_OK);
    assert_int_equal(hl_tex_write(r.d, bind.tex, 1, &one, 4), HL_OK);
    for (int f = HL_FILTER_NEAREST; f <= HL_FILTER_TRILINEAR; f++) {
        bind.filter = (uint8_t)f;
        vt_draw_one(&r, &p, &bind, got);
        /* Levels may be weighted in 1/256 (mipmapPrecisionBits >= 4). */
        ck_near(got[2][2][0], f == HL_FILTER_TRILINEAR ? 0.5 : 0.0, 1 / 16.0);
    }
}

#define ON(name) CK_ON("vulkan", name)
#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON(opens_by_index_and_by_part_of_a_name),
        ON(caps_are_whole),
        ON(an_embedders_device_is_used_and_kept),
        ON(devices_are_independent),
        ON(a_missing_barrier_is_counted),
        DRAWN(every_format_clears_and_reads),
        DRAWN(every_format_keeps_what_is_written),
        DRAWN(every_format_is_sampled),
        DRAWN(bytes_are_seen_as_another_format),
        DRAWN(row_zero_is_the_top_and_winding_is_as_seen),
        DRAWN(an_absent_attribute_is_0001),
        ON(programs_of_unlike_bindings_share_a_pass),
        DRAWN(samples_resolve_to_their_mean),
        DRAWN(depth_is_tested_and_sampled_at_once),
        DRAWN(only_trilinear_looks_past_level_zero),
    };
    return cmocka_run_group_tests_name("vulkan", tests, NULL, NULL);
}
