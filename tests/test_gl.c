/* SPDX-License-Identifier: Zlib */
/* The GL backend: contexts, stages as GLSL, an embedder's context, validation
 * and pictures beside Vulkan's. The suites over all backends, and the
 * pictures of test_vulkan.c and test_pack_gpu.c, run on it as well. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/bridge.h"
#include "platforms/gl/gl.h"
#include "tests/vulkan_kit.h"

static struct hlgl *inside(struct hl_device *d)
{
    struct hlgl *g;
    struct hlvk *v = vt_inside(d);
    memcpy(&g, &v, sizeof g);
    return g;
}

/* ---- contexts ------------------------------------------------------------ */

static enum hl_result open_gl(struct ck_machine *m, const char *context,
                              const char *device)
{
    const struct hl_gl_native native = { context, NULL };
    memset(m, 0, sizeof *m);
    m->backend = &hl_backend_gl;
    struct hl_device_desc desc = ck_desc(m);
    desc.native = &native;
    desc.device = device;
    return hl_device_open(&m->device, m->backend, &desc);
}

static void draws_on(const char *context)
{
    struct ck_machine m;
    enum hl_result r = open_gl(&m, context, NULL);
    if (r == HL_ERR_NO_DEVICE) {
        print_message("skipped: %s\n", m.last);
        skip();
    }
    assert_int_equal(r, HL_OK);
    const struct hl_caps *c = hl_device_caps(m.device);
    assert_int_equal(strncmp(c->driver, context, strlen(context)), 0);
    struct rig rig = vt_rig_on(m.device);
    vt_assert_usable(&rig);
    ck_close(&m);
}

static void osmesa_draws(void **state)
{
    (void)state;
    draws_on("osmesa");
}

static void egl_draws(void **state)
{
    (void)state;
    draws_on("egl");
}

static void opens_by_index_and_by_part_of_a_name(void **state)
{
    struct ck_machine *here = ck_machine(state), m;
    struct hl_device_info info[4];
    struct hl_hooks hooks = mk_hooks(&here->memory);
    uint32_t n;
    assert_int_equal(hl_devices_list(&hl_backend_gl, &hooks, info, 4, &n),
                     HL_OK);
    assert_true(n >= 1);
    char part[6] = "     ";
    for (int i = 0; i < 5; i++)
        part[i] = (char)(info[0].name[i] ^ (info[0].name[i] >= 'a' ? 32 : 0));
    const char *good[] = { "0", info[0].name, part, "" };
    for (int i = 0; i < 4; i++) {
        assert_int_equal(open_gl(&m, NULL, good[i]), HL_OK);
        const struct hl_caps *c = hl_device_caps(m.device);
        assert_string_equal(c->device, info[0].name);
        assert_string_equal(c->driver, info[0].driver);
        ck_close(&m);
    }
    const char *bad[] = { "999999999999", "no such machine" };
    for (int i = 0; i < 2; i++) {
        assert_int_equal(open_gl(&m, NULL, bad[i]), HL_ERR_NO_DEVICE);
        ck_refused(&m, 0, HL_MSG_DEVICE, bad[i]);
        assert_int_equal(m.memory.n_live, 0);
    }
    assert_int_equal(open_gl(&m, "glx", NULL), HL_ERR_NO_DEVICE);
    ck_refused(&m, 0, HL_MSG_DEVICE, "from glx");
}

static void caps_are_whole(void **state)
{
    const struct hl_caps *c = hl_device_caps(ck_machine(state)->device);
    assert_string_equal(c->backend, "gl");
    assert_true(c->device[0] && c->driver[0] && c->clip_zero_to_one);
    /* What the GL 4.5 specification requires, table 23.53 and on. */
    assert_true(c->max_tex_dim >= 16384 && c->max_colors == 8);
    assert_true(c->max_uniform_bytes >= 16384 && c->uniform_align <= 256);
    assert_true(c->max_storage_bytes >= 1u << 24 && c->storage_align <= 256);
    assert_true((c->samples & 5) == 5);
    assert_int_equal(c->format[HL_FORMAT_RGBA8_UNORM].use, 15);
    assert_int_equal(c->format[HL_FORMAT_R32_UINT].use,
                     HL_USE_SAMPLED | HL_USE_TARGET);
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        bool console = i >= HL_FORMAT_RG16_FIXED32;
        assert_int_equal((c->format[i].use & HL_USE_SAMPLED) != 0, !console);
        assert_int_equal((c->format[i].use & HL_USE_TARGET) != 0,
                         c->format[i].samples & 1);
    }
}

static void devices_are_independent(void **state)
{
    struct rig r = vt_rig(state);
    struct ck_machine other, vulkan;
    assert_int_equal(open_gl(&other, NULL, NULL), HL_OK);
    bool both = ck_open(&vulkan, "vulkan", NULL);
    struct rig s = vt_rig_on(other.device), t = { 0 };
    if (both)
        t = vt_rig_on(vulkan.device);
    for (int i = 0; i < 3; i++) {
        vt_assert_usable(&r);
        vt_assert_usable(&s);
        if (both)
            vt_assert_usable(&t);
    }
    ck_close(&other);
    vt_assert_usable(&r);
    ck_close(&vulkan);
    vt_assert_usable(&r);
}

/* ---- an embedder's context ----------------------------------------------- */

/* get_proc knows no context but the current one. */
static struct hlgl_context engine;

static void *engine_proc(const char *name)
{
    hlgl_function f = engine.find(&engine, name);
    void *out;
    memcpy(&out, &f, sizeof out);
    return out;
}

static void engine_proc_is_bound(struct hlgl_api *gl)
{
#define HLGL_FUNCTION(name, NAME) \
    gl->name = (PFNGL##NAME##PROC)engine.find(&engine, "gl" #name);
#include "platforms/gl/gl_functions.def"
#undef HLGL_FUNCTION
}

/* What an engine may have left on. */
static void spoil(const struct hlgl_api *gl)
{
    gl->Enable(GL_CULL_FACE);
    gl->CullFace(GL_FRONT_AND_BACK);
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(0, 0, 1, 1);
    gl->Enable(GL_RASTERIZER_DISCARD);
    gl->Enable(GL_STENCIL_TEST);
    gl->Enable(GL_COLOR_LOGIC_OP);
    gl->Enable(GL_BLEND);
    gl->BlendEquation(GL_MAX);
    gl->ColorMask(0, 1, 0, 1);
    gl->DepthMask(0);
    gl->ClipControl(GL_UPPER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl->PolygonMode(GL_FRONT_AND_BACK, GL_POINT);
    gl->PixelStorei(GL_PACK_ROW_LENGTH, 77);
    gl->PixelStorei(GL_UNPACK_SKIP_ROWS, 7);
    gl->VertexAttrib4f(HL_ATTR_COLOR, 9, 9, 9, 9);
    gl->UseProgram(0);
    gl->BindVertexArray(0);
    gl->BindFramebuffer(GL_FRAMEBUFFER, 0);
}

static void an_embedders_context_is_used_and_kept(void **state)
{
    const struct hl_gl_native native = { NULL, engine_proc };
    struct ck_machine m;
    struct hlgl_api gl;
    (void)state;
    memset(&engine, 0, sizeof engine);
    if (hlgl_osmesa_open(&engine, 0, false) != HLGL_OPEN) {
        print_message("skipped: no OSMesa to be the engine's\n");
        skip();
    }
    assert_true(engine.use(&engine));
    engine_proc_is_bound(&gl);
    for (int i = 0; i < 2; i++) {
        assert_true(ck_open(&m, "gl", &native));
        struct rig r = vt_rig_on(m.device);
        vt_assert_usable(&r);
        spoil(&gl);
        vt_assert_usable(&r);
        struct hl_prog_desc p = vt_prog_desc(VT_VERTEX_COLOR);
        image got;
        spoil(&gl);
        vt_draw_one(&r, &p, NULL, got);
        assert_true(got[3][3][0] == 0.0f && got[3][3][3] == 1.0f);
        ck_close(&m);
    }
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    assert_non_null(gl.GetString(GL_VERSION));
    engine.close(&engine);
}

/* ---- stages -------------------------------------------------------------- */

static const char constants[] =
    "#version 450\n"
    "#ifndef SPIRV_CROSS_CONSTANT_ID_3\n"
    "#define SPIRV_CROSS_CONSTANT_ID_3 0.5\n"
    "#endif\n"
    "const float f = SPIRV_CROSS_CONSTANT_ID_3;\n"
    "#ifndef SPIRV_CROSS_CONSTANT_ID_30\n"
    "#define SPIRV_CROSS_CONSTANT_ID_30 7\n"
    "#endif\n"
    "const int i = SPIRV_CROSS_CONSTANT_ID_30;\n"
    "#ifndef SPIRV_CROSS_CONSTANT_ID_31\n"
    "#define SPIRV_CROSS_CONSTANT_ID_31 9u\n"
    "#endif\n"
    "const uint u = SPIRV_CROSS_CONSTANT_ID_31;\n"
    "#ifndef SPIRV_CROSS_CONSTANT_ID_4\n"
    "#define SPIRV_CROSS_CONSTANT_ID_4 false\n"
    "#endif\n"
    "const bool b = SPIRV_CROSS_CONSTANT_ID_4;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() { color = vec4(f, i, uintBitsToFloat(u), b); }\n";

static struct hl_prog_desc constant_prog(const struct hl_code *code)
{
    struct hl_prog_desc p = vt_prog_desc(0);
    p.fragment.code = code;
    p.n_specs = 0;
    return p;
}

static void constants_keep_their_types_and_bits(void **state)
{
    struct rig r = vt_rig(state);
    const struct hl_code code = { NULL, 0, constants, NULL };
    struct hl_prog_desc p = constant_prog(&code);
    const uint32_t bits[] = { 0x3dcccccd, 0xc2f6e979, 0x7f7fffff, 0x80000000,
                              0x7f800000, 0x00800001 };
    image got;
    vt_draw_one(&r, &p, NULL, got);
    assert_true(got[0][0][0] == 0.5f && got[0][0][1] == 7.0f &&
                got[0][0][3] == 0.0f);
    p.n_specs = 5;
    for (size_t i = 0; i < sizeof bits / sizeof *bits; i++) {
        const struct hl_spec spec[5] = { { 3, bits[i] }, { 99, 1 },
            { 30, (uint32_t)-5 }, { 31, bits[i] }, { 4, 1 } };
        memcpy(p.spec, spec, sizeof spec);
        vt_draw_one(&r, &p, NULL, got);
        assert_memory_equal(&got[3][4][0], &bits[i], 4);
        assert_true(got[3][4][1] == -5.0f && got[3][4][3] == 1.0f);
        assert_memory_equal(&got[3][4][2], &bits[i], 4);
    }
}

static void bad_stages_are_refused_by_name(void **state)
{
    struct rig r = vt_rig(state);
    static const char *const bad[][2] = {
        { NULL, "without GLSL" }, { "void main() {}\n", "#version" },
        { "#version 450\nvoid main() { nonsense; }\n", "nonsense" },
        { "#version 450\nin vec3 nobody;\nlayout(location = 0) out vec4 c;\n"
          "void main() { c = vec4(nobody, 1.0); }\n", "nobody" } };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const struct hl_code code = { NULL, 0, bad[i][0], NULL };
        struct hl_prog_desc p = constant_prog(&code);
        hl_prog prog;
        CK_REFUSED(r.m, hl_prog_create(r.d, &prog, &p), HL_ERR_UNSUPPORTED,
                   HL_MSG_ARGUMENT, bad[i][1]);
        assert_int_equal(r.m->last[strlen(r.m->last) - 1] == '\n', 0);
    }
    vt_assert_usable(&r);
}

/* As Vulkan has it; GL left alone takes the last. */
static void flat_varyings_are_the_first_vertexs(void **state)
{
    struct rig r = vt_rig(state);
    const struct hl_code vert = { NULL, 0,
        "#version 450\nlayout(location = 0) in vec3 p;\n"
        "layout(location = 3) in vec2 uv;\n"
        "layout(location = 0) flat out vec2 v;\n"
        "void main() { gl_Position = vec4(p, 1.0); v = uv; }\n", NULL };
    const struct hl_code frag = { NULL, 0,
        "#version 450\nlayout(location = 0) flat in vec2 v;\n"
        "layout(location = 0) out vec4 c;\n"
        "void main() { c = vec4(v, 0.0, 1.0); }\n", NULL };
    struct hl_prog_desc p = constant_prog(&frag);
    p.vertex = (struct hl_stage){ HL_SHADER_NONE, &vert };
    struct hl_draw draw = vt_draw(&r, vt_prog(r.d, &p));
    image got;
    draw.first = 1;          /* left bottom, right bottom, left top: 0,1     */
    draw.count = 3;
    assert_int_equal(vt_run(r.d, r.target, &draw, 1), HL_OK);
    vt_read(&r, got);
    assert_true(got[VT_SIDE - 1][1][0] == 0.0f &&
                got[VT_SIDE - 1][1][1] == 1.0f);
}

/* ---- validation ---------------------------------------------------------- */

static void count_only(void *user, enum hl_log_level level, enum hl_log_id id,
                       const char *text)
{
    struct ck_machine *m = user;
    m->errors += level == HL_LOG_ERROR && id == HL_MSG_VALIDATION;
    (void)text;
}

static void misuse_of_gl_is_counted_where_asked(void **state)
{
    ck_machine(state);
    for (int on = 0; on < 2; on++) {
        struct ck_machine m = { 0 };
        struct hl_device_desc desc = ck_desc(&m);
        desc.log = count_only;
        desc.validation = on;
        assert_int_equal(hl_device_open(&m.device, &hl_backend_gl, &desc),
                         HL_OK);
        struct hlgl *g = inside(m.device);
        assert_int_equal(hlgl_enter(g), HL_OK);
        g->gl.Enable(GL_TEXTURE_2D_MULTISAMPLE);
        assert_int_equal(hl_device_validation_errors(m.device), on);
        assert_int_equal(hlgl_check(g, "a test"), HL_ERR_UNSUPPORTED);
        assert_int_equal(hlgl_check(g, "a test"), HL_OK);
        hl_device_close(&m.device);
        assert_int_equal(m.errors, on);
        assert_int_equal(m.memory.n_live, 0);
    }
}

/* ---- caches -------------------------------------------------------------- */

/* GL may give the names of destroyed objects out again, and what still refers
 * to one keeps its memory. */
static void caches_forget_what_is_destroyed(void **state)
{
    struct rig r = vt_rig(state);
    struct hlgl *g = inside(r.d);
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    static const struct vertex nowhere[6];
    hl_prog prog = vt_prog(r.d, &p);
    image got;
    for (int i = 0; i < 40; i++) {
        const struct hl_buf_desc mesh = {
            .bytes = sizeof vt_quad, .data = i % 2 ? nowhere : vt_quad };
        hl_buf_destroy(r.d, &r.mesh);
        hl_tex_destroy(r.d, &r.target);
        assert_int_equal(g->n_fbos, 0);
        assert_int_equal(g->n_layouts, 1);
        assert_int_equal(g->layouts[0].stream[0], 0);
        assert_int_equal(hl_buf_create(r.d, &r.mesh, &mesh), HL_OK);
        r.target = vt_tex(r.d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, 1,
                          HL_TEX_TARGET | HL_TEX_READBACK);
        struct hl_draw draw = vt_draw(&r, prog);
        assert_int_equal(vt_run(r.d, r.target, &draw, 1), HL_OK);
        vt_read(&r, got);
        assert_true(got[1][2][0] == (i % 2 ? 0.0f : 0.125f));
        assert_int_equal(g->n_fbos, 1);
        assert_int_not_equal(g->layouts[0].stream[0], 0);
    }
}

/* ---- pictures ------------------------------------------------------------ */

enum { W = 320, H = 180 };

/* fig8 by a pipeline, as linear RGBA. */
static float *picture(struct hl_device *d, enum hl_pipeline pipeline)
{
    struct hlc_world_options none = { 0 };
    struct hlc_options o = { .width = W, .height = H };
    struct hlh_scene scene;
    struct hlc_world world;
    struct hlh_error error;
    struct hl_camera camera;
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
    struct hl_renderer *renderer;
    assert_true(hlh_scene_builtin(&scene, "fig8", &error));
    assert_true(hlc_world_create(&world, d, &scene, &none, &error));
    assert_true(hlc_view(&camera, &scene, 0, 0, true));
    hlc_frame(&frame, &world, &camera);
    hlc_needs(&needs, &world, &frame, &o);
    assert_int_equal(hl_plan_make(&plan, pipeline, &needs, hl_device_caps(d),
                                  NULL), HL_OK);
    struct hl_renderer_desc desc = {
        .plan = &plan, .surfaces = world.surfaces,
        .n_surfaces = world.n_surfaces, .max_items = world.n_items,
        .max_lights = world.n_lights, .readback = true };
    void *memory = malloc(hl_renderer_bytes(&desc));
    assert_int_equal(hl_renderer_create(&renderer, d, &desc, memory), HL_OK);
    assert_int_equal(hl_frame_draw(renderer, &frame, NULL), HL_OK);
    assert_int_equal(hl_submit(d, true), HL_OK);
    float *out = ck_read(d, hl_renderer_output(renderer), NULL, NULL);
    hl_renderer_destroy(&renderer);
    free(memory);
    hlc_world_free(&world);
    hlh_scene_free(&scene);
    return out;
}

/* Two rasterisers may give a sample on an edge to either side, and a 16-bit
 * float to either neighbour; one driver's two front ends hardly do. At most 2
 * of 1000 pixels may differ by more than 1/255; a wrong winding, flip, constant
 * or binding changes half the picture. */
static void agrees(struct ck_machine *gl, enum hl_pipeline pipeline)
{
    struct ck_machine vulkan;
    if (!ck_open(&vulkan, "vulkan", NULL)) {
        print_message("skipped: no Vulkan to compare with: %s\n",
                      vulkan.last);
        skip();
    }
    float *a = picture(gl->device, pipeline);
    float *b = picture(vulkan.device, pipeline);
    uint32_t within = 0, lit = 0;
    for (size_t i = 0; i < (size_t)W * H * 4; i += 4) {
        bool near = true;
        for (size_t c = 0; c < 3; c++)
            near &= a[i + c] - b[i + c] <= 1 / 255.0f &&
                    b[i + c] - a[i + c] <= 1 / 255.0f;
        within += near;
        lit += b[i] + b[i + 1] + b[i + 2] > 0.05f;
    }
    print_message("%.3f %% within 1/255\n", 100.0 * within / (W * H));
    assert_true(lit > W * H / 3);
    assert_true(within >= W * H * 0.998);
    free(a);
    free(b);
    ck_close(&vulkan);
}

static void inferred_is_what_vulkan_draws(void **state)
{
    agrees(ck_machine(state), HL_PIPELINE_INFERRED);
}

static void forward_is_what_vulkan_draws(void **state)
{
    agrees(ck_machine(state), HL_PIPELINE_FORWARD);
}

#define ON(name) CK_ON("gl", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(osmesa_draws),
        cmocka_unit_test(egl_draws),
        ON(opens_by_index_and_by_part_of_a_name),
        ON(caps_are_whole),
        ON(devices_are_independent),
        cmocka_unit_test(an_embedders_context_is_used_and_kept),
        ON(constants_keep_their_types_and_bits),
        ON(bad_stages_are_refused_by_name),
        ON(flat_varyings_are_the_first_vertexs),
        ON(misuse_of_gl_is_counted_where_asked),
        ON(caches_forget_what_is_destroyed),
        ON(inferred_is_what_vulkan_draws),
        ON(forward_is_what_vulkan_draws),
    };
    return cmocka_run_group_tests_name("gl", tests, NULL, NULL);
}
