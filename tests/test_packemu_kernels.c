/* SPDX-License-Identifier: Zlib */
/* packemu's tables, its vertex kernels and small stages, each against its GLSL
 * written out a second time for one vertex or fragment: the same operations
 * in the same order, so the same bits. */
#include <math.h>
#include <string.h>
#include "tests/kernel_kit.h"

/* ---- the tables ---------------------------------------------------------- */

static bool is_vertex(enum hl_shader s)
{
    static const bool vert[HL_SHADER_COUNT] = {
#define vert true
#define frag false
#define HL_SHADER(name, stage, file, defines) [HL_SHADER_##name] = stage,
#include "shaders/variants.def"
#undef HL_SHADER
#undef vert
#undef frag
    };
    return vert[s];
}

/* Every row has its kernel, in one table; what a fragment kernel reads, the
 * vertex stage of its name writes. */
static void every_variant_has_a_kernel(void **state)
{
    (void)state;
    for (int i = HL_SHADER_NONE + 1; i < HL_SHADER_COUNT; i++) {
        enum hl_shader s = (enum hl_shader)i;
        bool screen = s == HL_SHADER_SCREEN_VERT ||
                      s == HL_SHADER_SCREEN_FLAT_VERT;
        bool runs = pe_vertex_kernels[s].run != NULL;
        bool shades = pe_fragment_kernels[s].stage.shade != NULL;
        if (runs != (is_vertex(s) && !screen) || shades != !is_vertex(s))
            fail_msg("row %d of variants.def", i);
    }
    const enum hl_shader pairs[][2] = {
        { HL_SHADER_MESH_GBUFFER_VERT, HL_SHADER_GBUFFER_PLAIN_EXP_FRAG },
        { HL_SHADER_MESH_GBUFFER_FULL_VERT, HL_SHADER_GBUFFER_FULL_EXP_FRAG },
        { HL_SHADER_MESH_MATERIAL_VERT, HL_SHADER_MATERIAL_PLAIN_FRAG },
        { HL_SHADER_MESH_UV_ID_VERT, HL_SHADER_MATERIAL_FULL_TAPS_FRAG },
        { HL_SHADER_MESH_FORWARD_VERT, HL_SHADER_FORWARD_LIST_PLAIN_FRAG },
        { HL_SHADER_MESH_FORWARD_FULL_VERT, HL_SHADER_FORWARD_FULL_FRAG },
        { HL_SHADER_MESH_UV_ID_VERT, HL_SHADER_REJECT_FULL_FRAG },
        { HL_SHADER_MESH_ID_VERT, HL_SHADER_ID_PLAIN_FRAG },
        { HL_SHADER_MESH_UV_ID_VERT, HL_SHADER_ID_FULL_FRAG },
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        uint32_t writes = pe_vertex_kernels[pairs[i][0]].vary;
        uint32_t reads = pe_fragment_kernels[pairs[i][1]].vary;
        assert_int_equal(reads & ~writes, 0);
    }
}

/* ---- vertices ------------------------------------------------------------ */

static hl_mat4 matrix(struct kk *k)
{
    hl_mat4 m;
    for (int c = 0; c < 4; c++)
        m.column[c] = kk_vec4(k, -2, 2);
    return m;
}

static hl_vec4 apply(const hl_mat4 *m, hl_vec4 p)
{
    const hl_vec4 *c = m->column;
    return hl_v4(
        c[0].x * p.x + c[1].x * p.y + c[2].x * p.z + c[3].x * p.w,
        c[0].y * p.x + c[1].y * p.y + c[2].y * p.z + c[3].y * p.w,
        c[0].z * p.x + c[1].z * p.y + c[2].z * p.z + c[3].z * p.w,
        c[0].w * p.x + c[1].w * p.y + c[2].w * p.z + c[3].w * p.w);
}

static void run_vertices(struct kk *k, struct pe_vertices *v,
                         enum hl_shader vertex)
{
    k->program.vertex = &pe_vertex_kernels[vertex];
    k->program.fragment.vary = 0xffffffffu;
    memset(v->clip, 255, sizeof v->clip);
    memset(v->vary, 255, sizeof v->vary);
    k->program.vertex->run(&k->draw, v);
}

static hl_vec4 attribute(const struct pe_vertices *v, int a, uint32_t i)
{
    return hl_v4(v->attr[a][0][i], v->attr[a][1][i], v->attr[a][2][i],
                 v->attr[a][3][i]);
}

static void check3(const struct pe_vertices *v, int vary, uint32_t i,
                   float x, float y, float z)
{
    assert_true(v->vary[vary][i] == x);
    assert_true(v->vary[vary + 1][i] == y);
    assert_true(v->vary[vary + 2][i] == z);
}

static void check_vertex(const struct kk *k, const struct pe_vertices *v,
                         uint32_t i)
{
    const struct hl_object_block *o = &k->object;
    hl_vec4 p = attribute(v, HL_ATTR_POSITION, i);
    hl_vec4 n = attribute(v, HL_ATTR_NORMAL, i);
    hl_vec4 t = attribute(v, HL_ATTR_TANGENT, i);
    uint32_t vary = k->program.vertex->vary;
    p.w = 1;
    if (vary & 1u << HL_PE_ID)
        assert_true(v->vary[HL_PE_ID][i] == o->ids.x + fabsf(t.w) - 1);
    if (vary & 1u << HL_PE_NX) {
        hl_vec4 m = apply(&o->normal, hl_v4(n.x, n.y, n.z, 0));
        float n2 = m.x * m.x + m.y * m.y + m.z * m.z;
        float s = n2 > 0 ? 1 / sqrtf(n2) : 0;
        check3(v, HL_PE_NX, i, m.x * s, m.y * s, m.z * s);
    }
    if (vary & 1u << HL_PE_TX) {
        hl_vec4 m = apply(&o->model_view, hl_v4(t.x, t.y, t.z, 0));
        check3(v, HL_PE_TX, i, m.x, m.y, m.z);
        assert_true(v->vary[HL_PE_TW][i] ==
                    (t.w < 0 ? -1.0f : 1.0f) * o->flat_ids.y);
    }
    if (vary & 1u << HL_PE_PX) {
        hl_vec4 m = apply(&o->model_view, p);
        check3(v, HL_PE_PX, i, m.x, m.y, m.z);
    }
    for (int c = 0; c < 2 && vary & 1u << HL_PE_U; c++)
        assert_true(v->vary[HL_PE_U + c][i] == v->attr[HL_ATTR_UV][c][i]);
    for (int c = 0; c < 4 && vary & 1u << HL_PE_U; c++)
        assert_true(v->vary[HL_PE_R + c][i] == v->attr[HL_ATTR_COLOR][c][i]);
}

static void fill_vertices(struct kk *k, struct pe_vertices *v)
{
    memset(v, 255, sizeof *v);
    v->n = PE_RUN - 3;
    for (uint32_t i = 0; i < v->n; i++) {
        for (int a = 0; a < 5; a++)
            for (int c = 0; c < 4; c++)
                v->attr[a][c][i] = kk_between(k, -1, 1);
        v->attr[HL_ATTR_TANGENT][3][i] =
            (float)(1 + mk_below(&k->seed, 100)) * (i & 1 ? 1.0f : -1.0f);
    }
    for (int c = 0; c < 3; c++)
        v->attr[HL_ATTR_NORMAL][c][5] = 0;
    k->object.clip = matrix(k);
    k->object.normal = matrix(k);
    k->object.model_view = matrix(k);
    k->object.ids = hl_v4(300, 7, 0, 0);
    k->object.flat_ids = hl_v4(0.5f, -1, 0, 0);
}

/* Positions have the same bits in all of them; a normal of zero stays zero;
 * half-pixel shifts move x and y by w times them. */
static void mesh_vertices(void **state)
{
    static struct kk k;
    static struct pe_vertices v;
    static float clip[4][PE_RUN];
    (void)state;
    kk_open(&k);
    fill_vertices(&k, &v);
    for (int s = HL_SHADER_MESH_ID_VERT; s <= HL_SHADER_MESH_FORWARD_FULL_VERT;
         s++) {
        run_vertices(&k, &v, (enum hl_shader)s);
        for (uint32_t i = 0; i < v.n; i++) {
            hl_vec4 p = attribute(&v, HL_ATTR_POSITION, i);
            p.w = 1;
            hl_vec4 q = apply(&k.object.clip, p);
            assert_true(v.clip[0][i] == q.x && v.clip[1][i] == q.y &&
                        v.clip[2][i] == q.z && v.clip[3][i] == q.w);
            check_vertex(&k, &v, i);
        }
    }
    memcpy(clip, v.clip, sizeof clip);
    k.program.spec[HL_SPEC_SHIFT_X].f = -0.125f;
    k.program.spec[HL_SPEC_SHIFT_Y].f = -0.25f;
    run_vertices(&k, &v, HL_SHADER_MESH_ID_VERT);
    for (uint32_t i = 0; i < v.n; i++) {
        assert_true(v.clip[0][i] == clip[0][i] + clip[3][i] * -0.125f);
        assert_true(v.clip[1][i] == clip[1][i] + clip[3][i] * -0.25f);
        assert_true(v.clip[2][i] == clip[2][i]);
    }
    kk_close(&k);
}

/* ---- small stages -------------------------------------------------------- */

enum { TILE = 8, TILES_X = 5, TILES_Y = 3 };

static void count_and_copy(void **state)
{
    static struct kk k;
    static uint32_t tile[TILES_X * TILES_Y][2];
    static float depth[TILES_Y * TILE][TILES_X * TILE];
    (void)state;
    kk_open(&k);
    for (int i = 0; i < TILES_X * TILES_Y; i++)
        tile[i][1] = mk_below(&k.seed, 1000);
    for (int i = 0; i < TILES_X * TILES_Y * TILE * TILE; i++)
        (&depth[0][0])[i] = kk_between(&k, 0, 1);
    k.frame.misc = hl_v4(0, TILE, TILES_X, 0);
    k.lights[0].x = 11;
    k.draw.storage[HL_SLOT_TILES] = tile;
    k.draw.storage_bytes[HL_SLOT_TILES] = sizeof tile;
    kk_texture(&k, HL_TEX_DEPTH, HL_FORMAT_R32_FLOAT, HL_FORMAT_NONE,
               TILES_X * TILE, TILES_Y * TILE, depth);
    kk_fragments(&k, 100, TILES_X * TILE, TILES_Y * TILE);
    const struct hl_pe_fragments *f = &k.in;
    kk_shade(&k, HL_SHADER_COUNT_FRAG);
    kk_texel(&k, 0, 99, hl_v4(11, 0, 0, 1));
    kk_shade(&k, HL_SHADER_COUNT_TILES_FRAG);
    for (uint32_t i = 0; i < f->n; i++)
        kk_texel(&k, 0, i, hl_v4((float)tile[f->y[i] / TILE * TILES_X +
                                                f->x[i] / TILE][1], 0, 0, 1));
    kk_shade(&k, HL_SHADER_DEPTH_COPY_FRAG);
    for (uint32_t i = 0; i < f->n; i++)
        kk_texel(&k, 0, i, hl_v4(depth[f->y[i]][f->x[i]], 0, 0, 1));
    kk_close(&k);
}

/* A uniform that is not bound, or shorter than asked for, is NULL to an
 * embedder's stage and zeros to ours. */
static void uniforms_that_are_not_there(void **state)
{
    static struct kk k;
    (void)state;
    kk_open(&k);
    assert_ptr_equal(hl_pe_uniform(&k.draw, HL_SLOT_FRAME, sizeof k.frame),
                     &k.frame);
    assert_null(hl_pe_uniform(&k.draw, HL_SLOT_FRAME, sizeof k.frame + 1));
    assert_null(hl_pe_uniform(&k.draw, HL_MAX_UNIFORMS, 0));
    k.material.albedo = hl_v4(1, 1, 1, 1);
    k.draw.uniform_bytes[HL_SLOT_MATERIAL] = sizeof k.material - 1;
    k.program.spec[HL_SPEC_BATCH].u = 0;
    kk_fragments(&k, 10, 640, 480);
    kk_shade(&k, HL_SHADER_FORWARD_PLAIN_FRAG);
    kk_texel(&k, 0, 9, hl_v4(0, 0, 0, 0));
    kk_close(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_variant_has_a_kernel),
        cmocka_unit_test(mesh_vertices),
        cmocka_unit_test(count_and_copy),
        cmocka_unit_test(uniforms_that_are_not_there),
    };
    return cmocka_run_group_tests_name("packemu kernels", tests, NULL, NULL);
}
