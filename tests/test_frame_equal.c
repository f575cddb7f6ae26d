/* SPDX-License-Identifier: Zlib */
/* One vertex path: every variant of shaders/mesh.vert puts a vertex at the
 * same bits, so that a pass that tests for equal depth finds all that another
 * left, with no hole at any edge. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/frame_kit.h"

enum { SIDE = 96, AREA = 1024 };

/* Each with a stage that reads all that it writes, so that nothing of it is
 * left out. */
static const struct {
    const char *name;
    enum hl_shader vertex, fragment;
} variants[] = {
    { "id", HL_SHADER_MESH_ID_VERT, HL_SHADER_COUNT_FRAG },
    { "uv and id", HL_SHADER_MESH_UV_ID_VERT,
      HL_SHADER_MATERIAL_FULL_TAPS_FRAG },
    { "geometry", HL_SHADER_MESH_GBUFFER_VERT, HL_SHADER_GBUFFER_PLAIN_FRAG },
    { "geometry, full", HL_SHADER_MESH_GBUFFER_FULL_VERT,
      HL_SHADER_GBUFFER_FULL_FRAG },
    { "material", HL_SHADER_MESH_MATERIAL_VERT,
      HL_SHADER_MATERIAL_PLAIN_TAPS_FRAG },
    { "own", HL_SHADER_MESH_OWN_VERT, HL_SHADER_GBUFFER_FULL_FRAG },
    { "forward", HL_SHADER_MESH_FORWARD_VERT, HL_SHADER_FORWARD_PLAIN_FRAG },
    { "forward, full", HL_SHADER_MESH_FORWARD_FULL_VERT,
      HL_SHADER_FORWARD_FULL_FRAG },
    { "material, centroid", HL_SHADER_MESH_MATERIAL_CENTROID_VERT,
      HL_SHADER_MATERIAL_PLAIN_TAPS_CENTROID_FRAG },
    { "uv and id, centroid", HL_SHADER_MESH_UV_ID_CENTROID_VERT,
      HL_SHADER_MATERIAL_FULL_TAPS_CENTROID_FRAG },
    { "geometry, motion", HL_SHADER_MESH_GBUFFER_MOTION_VERT,
      HL_SHADER_GBUFFER_PLAIN_MOTION_FRAG },
    { "geometry, full, motion", HL_SHADER_MESH_GBUFFER_FULL_MOTION_VERT,
      HL_SHADER_GBUFFER_FULL_MOTION_FRAG },
};

enum { VARIANTS = sizeof variants / sizeof *variants };

/* ---- a pass ------------------------------------------------------------- */

struct stand {
    struct fk_scene scene;
    struct hl_device *device;
    hl_buf uniform;
    hl_tex color, depth;
};

/* Numbers without short binary forms, in every place: perspective over a
 * turned ball that crosses the near plane and three edges of the screen. */
static void fill_blocks(uint8_t *bytes)
{
    struct hl_object_block o;
    const float clip[16] = { 1.37f, 0.41f, 0.013f, 0.31f,
                             -0.53f, 1.71f, -0.027f, -0.29f,
                             0.77f, 0.19f, 0.031f, 0.83f,
                             0.3f, -0.2f, 0.11f, 1.43f };
    memset(bytes, 0, 4 * AREA);
    memset(&o, 0, sizeof o);
    memcpy(&o.clip, clip, sizeof clip);
    memcpy(&o.model_view, clip, sizeof clip);
    memcpy(&o.normal, clip, sizeof clip);
    o.ids.x = 7;
    o.flat_ids.y = 1;
    memcpy(bytes + HL_SLOT_OBJECT * AREA, &o, sizeof o);
    /* Motion's own matrices, or the one light of count.frag: 1. */
    for (int i = 0; i < 32; i++) {
        float x = i ? 0.37f * (float)i : 1;
        memcpy(bytes + HL_SLOT_LIGHTS * AREA + 4 * i, &x, 4);
    }
}

static void begin(struct stand *s, struct ck_machine *m)
{
    static uint8_t bytes[3 * AREA + HL_LIGHTS_BYTES + AREA];
    struct hl_buf_desc u = { "u", sizeof bytes, HL_BUF_UNIFORM, false, bytes };
    struct hl_tex_desc t = { .format = HL_FORMAT_R32_FLOAT, .width = SIDE,
                             .height = SIDE,
                             .usage = HL_TEX_TARGET | HL_TEX_READBACK };
    fk_begin(&s->scene, m);
    fill_blocks(bytes);
    s->device = m->device;
    assert_int_equal(hl_buf_create(s->device, &s->uniform, &u), HL_OK);
    assert_int_equal(hl_tex_create(s->device, &s->color, &t), HL_OK);
    t.format = HL_FORMAT_D32_FLOAT;
    t.usage = HL_TEX_TARGET;
    assert_int_equal(hl_tex_create(s->device, &s->depth, &t), HL_OK);
}

static void end(struct stand *s)
{
    hl_tex_destroy(s->device, &s->color);
    hl_tex_destroy(s->device, &s->depth);
    hl_buf_destroy(s->device, &s->uniform);
    fk_end(&s->scene);
}

static hl_prog program(struct stand *s, int variant, bool equal, float shift)
{
    struct hl_prog_desc p = {
        .vertex = { variants[variant].vertex, NULL },
        .fragment = { variants[variant].fragment, NULL }, .n_colors = 1,
        .color = { HL_FORMAT_R32_FLOAT }, .depth = HL_FORMAT_D32_FLOAT,
        .depth_write = !equal,
        .depth_test = equal ? HL_COMPARE_EQUAL : HL_COMPARE_GREATER,
        .n_specs = shift != 0 ? 2 : 0 };
    hl_prog out;
    p.layout = s->scene.surface[FK_FULL].layout;
    for (uint32_t i = 0; i < 2; i++) {
        p.spec[i].id = i ? HL_SPEC_SHIFT_Y : HL_SPEC_SHIFT_X;
        memcpy(&p.spec[i].value, &shift, sizeof shift);
    }
    assert_int_equal(hl_prog_create(s->device, &out, &p), HL_OK);
    return out;
}

static struct hl_draw draw_of(struct stand *s, hl_prog prog)
{
    static const struct hl_texture_binding none[HL_TEX_MESH_COUNT];
    struct hl_draw d = { .prog = prog };
    const struct hl_item *it = &s->scene.item[0];
    d.vertex[0] = it->vertex[0];
    d.index = it->index;
    d.first = it->first;
    d.count = it->count;
    d.base_vertex = it->base_vertex;
    for (uint32_t i = 0; i < HL_MAX_UNIFORMS; i++) {
        d.uniform[i].buf = s->uniform;
        d.uniform[i].offset = i * AREA;
        d.uniform[i].bytes = i == HL_SLOT_LIGHTS ? HL_LIGHTS_BYTES : AREA;
    }
    d.textures = none;
    d.n_textures = HL_TEX_MESH_COUNT;
    return d;
}

/* What no stage here writes into the first channel. */
#define NOTHING (-1000.0f)

/* First one variant as it is nearest; then the other where depth is equal, on
 * a new picture. */
static void two_passes(struct stand *s, int first, int second, float shift,
                       float *count)
{
    hl_prog a = program(s, first, false, shift);
    hl_prog b = program(s, second, true, shift);
    struct hl_draw draw[2] = { draw_of(s, a), draw_of(s, b) };
    for (int i = 0; i < 2; i++) {
        struct hl_pass pass = { .label = "equal", .n_colors = 1,
                                .draws = &draw[i], .n_draws = 1 };
        pass.color[0].tex = s->color;
        pass.color[0].load = HL_LOAD_CLEAR;
        pass.color[0].clear[0] = NOTHING;
        pass.depth.tex = s->depth;
        pass.depth.load = i ? HL_LOAD_KEEP : HL_LOAD_CLEAR;
        pass.depth_read_only = i == 1;
        assert_int_equal(hl_pass_run(s->device, &pass), HL_OK);
        assert_int_equal(hl_tex_read(s->device, s->color,
                                     count + i * SIDE * SIDE,
                                     SIDE * SIDE * sizeof *count), HL_OK);
    }
    hl_prog_destroy(s->device, &a);
    hl_prog_destroy(s->device, &b);
}

/* ---- tests -------------------------------------------------------------- */

static uint32_t check_pair(struct stand *s, int i, int k, float shift)
{
    static float count[2 * SIDE * SIDE];
    uint32_t covered = 0, holes = 0;
    two_passes(s, i, k, shift, count);
    for (int p = 0; p < SIDE * SIDE; p++) {
        bool there = count[p] != NOTHING;
        covered += there;
        holes += there != (count[SIDE * SIDE + p] != NOTHING);
    }
    if (holes)
        fail_msg("%s after %s: %u holes of %u", variants[k].name,
                 variants[i].name, holes, covered);
    return covered;
}

/* Against the first, both ways round: equality is passed on. With half a
 * pixel's shift too, which is another program. */
static void every_variant_meets_every_other(void **state)
{
    static struct stand s;
    begin(&s, ck_machine(state));
    fk_add(&s.scene, FK_BALL, FK_FULL, 0, 0, 0, 1);
    for (int i = 0; i < VARIANTS; i++)
        for (int k = 0; k < 2; k++) {
            float shift = k ? -1.0f / SIDE : 0;
            uint32_t n = check_pair(&s, 0, i, shift);
            assert_int_equal(check_pair(&s, i, 0, shift), n);
            assert_true(n > SIDE * SIDE / 4 && n < SIDE * SIDE);
        }
    end(&s);
}

/* The frame's own use of it: FWD-1 and further batches add where depth is
 * equal. Twelve lights over a room are more than a batch; a hole would be the
 * base's colour alone, so light of eight or more would be missing. */
static void further_lights_leave_no_hole(void **state)
{
    static struct fk_scene s;
    uint64_t seed = 3;
    enum { N = FK_W * FK_H };
    fk_begin(&s, ck_machine(state));
    fk_room(&s, 0, &seed);
    for (int i = 0; i < 12; i++)
        fk_light(&s, 0, 2, 8, 40)->color[0] = i < 8 ? 0 : 0.25f;
    float *picture = fk_draw(&s, HL_PIPELINE_FORWARD, HL_ROLE_NONE);
    float *multi = fk_draw(&s, HL_PIPELINE_FORWARD_MULTIPASS, HL_ROLE_NONE);
    s.frame.n_lights = 8;
    float *first = fk_draw(&s, HL_PIPELINE_FORWARD, HL_ROLE_NONE);
    uint32_t lit = 0;
    for (int i = 0; i < N; i++) {
        /* Red comes of the second batch alone, where green has of both. */
        float green = first[i * 4 + 1] - 0.04f;
        if (green < 0.5f)
            continue;
        lit++;
        assert_true(picture[i * 4] > first[i * 4] + 0.01f);
        ck_near((double)multi[i * 4], (double)picture[i * 4], 0.02);
    }
    assert_true(lit > N / 4);
    free(picture);
    free(multi);
    free(first);
    fk_end(&s);
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(every_variant_meets_every_other),
        DRAWN(further_lights_leave_no_hole),
    };
    return cmocka_run_group_tests_name("one vertex path", tests, NULL, NULL);
}
