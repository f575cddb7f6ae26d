/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "hal/device.h"
#include "shaders/shared/block.h"
#include "tests/stage_kernels.h"
#include "tests/vulkan_kit.h"

static const uint32_t frag_spirv[] = {
#include "vulkan_frag.x"
};
static const char frag_glsl[] = {
#include "vulkan_frag_glsl.x"
};

const struct vertex vt_quad[6] = {
    { { -1, -1, 0.5f }, { 0, 0 } }, { { -1, 1, 0.5f }, { 0, 1 } },
    { { 1, 1, 0.5f }, { 1, 1 } }, { { -1, -1, 0.5f }, { 0, 0 } },
    { { 1, 1, 0.5f }, { 1, 1 } }, { { 1, -1, 0.5f }, { 1, 0 } },
};

struct hlvk *vt_inside(struct hl_device *d)
{
    return d->state;
}

hl_tex vt_tex(struct hl_device *d, enum hl_format format, uint32_t side,
              uint32_t samples, uint32_t usage)
{
    struct hl_tex_desc desc = { .format = format, .width = side,
                                .height = side, .samples = samples,
                                .usage = usage };
    hl_tex t;
    assert_int_equal(hl_tex_create(d, &t, &desc), HL_OK);
    return t;
}

struct hl_object_block vt_object(float move_x)
{
    struct hl_object_block o;
    memset(&o, 0, sizeof o);
    o.clip.column[0].x = o.clip.column[1].y = o.clip.column[2].z = 1.0f;
    o.clip.column[3] = (hl_vec4){ move_x, 0.0f, 0.0f, 1.0f };
    o.model_view.column[0].x = o.model_view.column[1].y = 1.0f;
    o.model_view.column[2].z = o.model_view.column[3].w = 1.0f;
    o.ids.x = 7.0f;
    return o;
}

hl_buf vt_uniforms(struct hl_device *d)
{
    unsigned char rows[9][VT_ROW] = { { 0 } };
    struct hl_buf_desc desc = { .bytes = sizeof rows, .dynamic = true,
                                .usage = HL_BUF_UNIFORM, .data = rows };
    struct hl_object_block object = vt_object(0.0f);
    hl_buf b;
    assert_true(sizeof object <= VT_ROW);
    memcpy(rows[0], &object, sizeof object);
    for (int i = 1; i < 9; i++) {
        const float color[4] = { (float)i / 8.0f, 0.25f, 0.0f, 1.0f };
        memcpy(rows[i], color, sizeof color);
    }
    assert_int_equal(hl_buf_create(d, &b, &desc), HL_OK);
    return b;
}

struct rig vt_rig_on(struct hl_device *d)
{
    struct rig r = { .d = d };
    struct hl_buf_desc mesh = { .bytes = sizeof vt_quad, .data = vt_quad };
    assert_int_equal(hl_buf_create(d, &r.mesh, &mesh), HL_OK);
    r.uniforms = vt_uniforms(d);
    r.target = vt_tex(d, HL_FORMAT_RGBA32_FLOAT, VT_SIDE, 1,
                      HL_TEX_TARGET | HL_TEX_READBACK | HL_TEX_SAMPLED);
    return r;
}

struct rig vt_rig(void **state)
{
    struct ck_machine *m = ck_machine(state);
    struct rig r = vt_rig_on(m->device);
    r.m = m;
    return r;
}

struct hl_prog_desc vt_prog_desc(uint32_t what)
{
    /* The desc borrows it: one for all calls. */
    static struct hl_code code = { frag_spirv, sizeof frag_spirv, frag_glsl,
                                   NULL };
    code.kernel = vulkan_kernel();
    struct hl_prog_desc p = {
        .vertex = { HL_SHADER_MESH_OWN_VERT, NULL },
        .fragment = { HL_SHADER_NONE, &code },
        .spec = { { 0, what } }, .n_specs = 1,
        .layout = { .stride = { sizeof(struct vertex) } },
        .n_colors = 1, .color = { HL_FORMAT_RGBA32_FLOAT }
    };
    p.layout.attr[HL_ATTR_POSITION] = (struct hl_attr){ HL_ATTR_F32X3, 0, 0 };
    p.layout.attr[HL_ATTR_UV] = (struct hl_attr){ HL_ATTR_F32X2, 0, 12 };
    return p;
}

hl_prog vt_prog(struct hl_device *d, const struct hl_prog_desc *p)
{
    hl_prog prog;
    assert_int_equal(hl_prog_create(d, &prog, p), HL_OK);
    return prog;
}

struct hl_draw vt_draw(const struct rig *r, hl_prog prog)
{
    return (struct hl_draw){
        .prog = prog, .vertex = { r->mesh }, .count = 6,
        .uniform = {
            [HL_SLOT_OBJECT] = { r->uniforms, 0,
                                 sizeof(struct hl_object_block) },
            [HL_SLOT_MATERIAL] = { r->uniforms, VT_ROW, 16 }
        }
    };
}

enum hl_result vt_run(struct hl_device *d, hl_tex target,
                      const struct hl_draw *draws, uint32_t n)
{
    struct hl_pass pass = { .label = "test", .n_colors = 1, .draws = draws,
                            .n_draws = n };
    pass.color[0].tex = target;
    pass.color[0].load = HL_LOAD_CLEAR;
    return hl_pass_run(d, &pass);
}

void vt_read(const struct rig *r, image out)
{
    assert_int_equal(hl_tex_read(r->d, r->target, out, sizeof(image)), HL_OK);
}

void vt_draw_one(const struct rig *r, const struct hl_prog_desc *p,
                 const struct hl_texture_binding *tex, image out)
{
    struct hl_draw draw = vt_draw(r, vt_prog(r->d, p));
    draw.textures = tex;
    draw.n_textures = tex ? 1 : 0;
    assert_int_equal(vt_run(r->d, r->target, &draw, 1), HL_OK);
    hl_prog_destroy(r->d, &draw.prog);
    vt_read(r, out);
}

void vt_assert_usable(const struct rig *r)
{
    struct hl_prog_desc p = vt_prog_desc(VT_OWN_COLOR);
    image got;
    vt_draw_one(r, &p, NULL, got);
    assert_true(got[VT_SIDE - 1][0][0] == 0.125f);
}
