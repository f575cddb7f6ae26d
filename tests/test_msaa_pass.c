/* SPDX-License-Identifier: Zlib */
/* Multisampled passes: which samples are covered, what a resolve makes of
 * them, and that stages which read at centroids meet others in depth. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "tests/check.h"

/* A power of two, so that clip coordinates of 1/256 pixel are exact. */
enum { SIDE = 32, N = SIDE * SIDE, MOST = 96 };

struct picture {
    struct ck_machine *m;
    uint32_t samples;
    uint32_t n_vertices;
    float at[MOST][3];           /* x, y: clip; z: w of `perspective`        */
    bool perspective;
};

/* ---- drawing ------------------------------------------------------------ */

/* Clip (x w, y w, 1/4, w) from (x, y, w) in a stage that multiplies by a
 * matrix: x w and y w are the vertex's, so that depth is 1 / (4 w). */
static void clip_matrix(const struct picture *p, hl_mat4 *m)
{
    memset(m, 0, sizeof *m);
    m->column[0].x = m->column[1].y = 1;
    m->column[3].z = 0.25f;
    if (p->perspective)
        m->column[2].w = 1;
    else
        m->column[3].w = 1;
}

static hl_prog make_program(const struct picture *p, enum hl_shader vertex,
                            bool again)
{
    struct hl_prog_desc d = {
        .vertex = { vertex, NULL },
        .fragment = { HL_SHADER_COUNT_FRAG, NULL }, .n_colors = 1,
        .color = { HL_FORMAT_RGBA16_FLOAT }, .depth = HL_FORMAT_D32_FLOAT,
        .samples = p->samples, .depth_write = !again,
        .depth_test = again ? HL_COMPARE_EQUAL : HL_COMPARE_GREATER,
        .blend = again ? HL_BLEND_ADD : HL_BLEND_OFF };
    hl_prog out;
    d.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
    d.layout.stride[0] = sizeof p->at[0];
    assert_int_equal(hl_prog_create(p->m->device, &out, &d), HL_OK);
    return out;
}

static hl_tex make_target(const struct picture *p, enum hl_format format,
                          uint32_t samples)
{
    struct hl_tex_desc d = { .format = format, .width = SIDE,
                             .height = SIDE, .samples = samples,
                             .usage = HL_TEX_TARGET };
    hl_tex out;
    if (samples == 1)
        d.usage |= HL_TEX_READBACK;
    assert_int_equal(hl_tex_create(p->m->device, &out, &d), HL_OK);
    return out;
}

/* Everything a pass of up to two draws of the same triangles needs. */
struct scratch {
    hl_buf vertex, uniform;
    hl_tex color, depth, resolved;
    struct hl_draw draw[2];
};

enum { BLOCK = 1024, LIGHTS = BLOCK };

static void make_scratch(struct scratch *s, const struct picture *p)
{
    static uint8_t block[BLOCK + HL_LIGHTS_BYTES];
    const float one = 1;
    hl_mat4 clip;
    clip_matrix(p, &clip);
    memset(block, 0, sizeof block);
    memcpy(block, &clip, sizeof clip);
    memcpy(block + LIGHTS, &one, sizeof one);
    struct hl_buf_desc v = { "v", sizeof p->at, HL_BUF_VERTEX, false, p->at };
    struct hl_buf_desc u = { "u", sizeof block, HL_BUF_UNIFORM, false,
                             block };
    assert_int_equal(hl_buf_create(p->m->device, &s->vertex, &v), HL_OK);
    assert_int_equal(hl_buf_create(p->m->device, &s->uniform, &u), HL_OK);
    s->color = make_target(p, HL_FORMAT_RGBA16_FLOAT, p->samples);
    s->depth = make_target(p, HL_FORMAT_D32_FLOAT, p->samples);
    s->resolved = make_target(p, HL_FORMAT_RGBA16_FLOAT, 1);
    memset(s->draw, 0, sizeof s->draw);
    for (int i = 0; i < 2; i++) {
        s->draw[i].vertex[0] = s->vertex;
        s->draw[i].count = p->n_vertices;
        for (int k = 0; k < HL_MAX_UNIFORMS; k++) {
            s->draw[i].uniform[k].buf = s->uniform;
            s->draw[i].uniform[k].bytes = BLOCK;
        }
        s->draw[i].uniform[HL_SLOT_LIGHTS].offset = LIGHTS;
        s->draw[i].uniform[HL_SLOT_LIGHTS].bytes = HL_LIGHTS_BYTES;
    }
}

static void free_scratch(struct scratch *s, struct hl_device *d)
{
    for (int i = 0; i < 2; i++)
        hl_prog_destroy(d, &s->draw[i].prog);
    hl_buf_destroy(d, &s->vertex);
    hl_buf_destroy(d, &s->uniform);
    hl_tex_destroy(d, &s->color);
    hl_tex_destroy(d, &s->depth);
    hl_tex_destroy(d, &s->resolved);
}

/* Resolved red: 1 where `first` draws, 1 more where `again`, if any, meets
 * its depths. */
static float *draw(const struct picture *p, enum hl_shader first,
                   enum hl_shader again)
{
    struct scratch s;
    struct hl_device *d = p->m->device;
    make_scratch(&s, p);
    s.draw[0].prog = make_program(p, first, false);
    if (again != HL_SHADER_NONE)
        s.draw[1].prog = make_program(p, again, true);
    struct hl_pass pass = { .label = "samples", .n_colors = 1,
                            .draws = s.draw,
                            .n_draws = again != HL_SHADER_NONE ? 2 : 1 };
    pass.color[0].tex = s.color;
    pass.color[0].load = HL_LOAD_CLEAR;
    pass.color[0].resolve = s.resolved;
    pass.depth.tex = s.depth;
    pass.depth.load = HL_LOAD_CLEAR;
    assert_int_equal(hl_pass_run(d, &pass), HL_OK);
    float *out = ck_read(d, s.resolved, NULL, NULL);
    free_scratch(&s, d);
    return out;
}

/* ---- coverage ----------------------------------------------------------- */

/* Vulkan's and Direct3D's standard positions, 1/16 pixel. */
static const int8_t at[3][8][2] = {
    { { 4, 4 }, { -4, -4 } },
    { { -2, -6 }, { 6, -2 }, { -6, 2 }, { 2, 6 } },
    { { 1, -3 }, { -1, 3 }, { 5, 1 }, { -3, -5 },
      { -5, 5 }, { -7, -1 }, { 3, 7 }, { 7, -7 } } };

/* 1 inside of the triangle, 0 outside, -1 on an edge; 1/256 pixel. */
static int inside(int v[3][2], int x, int y)
{
    int low = 1, high = -1;
    for (int i = 0; i < 3; i++) {
        const int *p = v[i], *q = v[(i + 1) % 3];
        int64_t e = (int64_t)(q[0] - p[0]) * (y - p[1]) -
                    (int64_t)(q[1] - p[1]) * (x - p[0]);
        int sign = e > 0 ? 1 : e < 0 ? -1 : 0;
        low = sign < low ? sign : low;
        high = sign > high ? sign : high;
    }
    return low == high ? 1 : low * high < 0 ? 0 : -1;
}

/* Samples of a pixel that must and that may be covered. */
static void count(int v[3][2], uint32_t samples, int x, int y,
                  int *must, int *may)
{
    uint32_t row = samples / 4;     /* of 2, 4, 8                            */
    *must = *may = 0;
    for (uint32_t i = 0; i < samples; i++) {
        int in = inside(v, x * 256 + 128 + at[row][i][0] * 16,
                        y * 256 + 128 + at[row][i][1] * 16);
        *must += in == 1;
        *may += in != 0;
    }
}

/* Parts of 8 are exact in a half, and so are sums of eight of them. */
static void check_triangle(struct picture *p, uint64_t *seed)
{
    int v[3][2];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) {
            v[i][k] = (int)ck_between(seed, 0, SIDE * 256);
            p->at[i][k] = (float)v[i][k] / (SIDE * 128) - 1;
        }
    float *f = draw(p, HL_SHADER_MESH_MATERIAL_CENTROID_VERT, HL_SHADER_NONE);
    for (int i = 0; i < N; i++) {
        int must, may;
        count(v, p->samples, i % SIDE, i / SIDE, &must, &may);
        float n = f[4 * i] * (float)p->samples;
        if (!(n >= (float)must && n <= (float)may && n == floorf(n)))
            fail_msg("%u samples, pixel %d, %d: %g covered, not %d", p->samples,
                     i % SIDE, i / SIDE, (double)n, must);
    }
    free(f);
}

static bool has(const struct ck_machine *m, uint32_t samples)
{
    const struct hl_caps *c = hl_device_caps(m->device);
    return (c->samples & samples) &&
           (c->format[HL_FORMAT_RGBA16_FLOAT].samples & samples);
}

static void a_resolve_counts_samples(void **state)
{
    struct picture p = { .m = ck_machine(state), .n_vertices = 3 };
    uint64_t seed = 11;
    int counts = 0;
    for (p.samples = 2; p.samples <= 8; p.samples *= 2) {
        for (int i = 0; i < 12 && has(p.m, p.samples); i++)
            check_triangle(&p, &seed);
        counts += has(p.m, p.samples);
    }
    assert_true(counts > 0);
}

/* ---- depth -------------------------------------------------------------- */

static void soup(struct picture *p, uint64_t *seed)
{
    p->n_vertices = MOST;
    p->perspective = true;
    for (int i = 0; i < MOST; i++) {
        float w = (float)ck_between(seed, 0.3, 20);
        p->at[i][0] = (float)ck_between(seed, -1.2, 1.2) * w;
        p->at[i][1] = (float)ck_between(seed, -1.2, 1.2) * w;
        p->at[i][2] = w;
    }
}

/* What one stage drew, the other meets in every sample: twice as much. */
static void centroid_stages_meet_others(void **state)
{
    static const enum hl_shader stage[] = {
        HL_SHADER_MESH_ID_VERT, HL_SHADER_MESH_MATERIAL_VERT,
        HL_SHADER_MESH_MATERIAL_CENTROID_VERT,
        HL_SHADER_MESH_UV_ID_CENTROID_VERT, HL_SHADER_MESH_GBUFFER_VERT };
    enum { STAGES = sizeof stage / sizeof stage[0] };
    static struct picture p;
    uint64_t seed = 4;
    p.m = ck_machine(state);
    for (p.samples = 2; p.samples <= 8; p.samples *= 2) {
        if (!has(p.m, p.samples))
            continue;
        soup(&p, &seed);
        float *once = draw(&p, stage[2], HL_SHADER_NONE);
        for (int k = 0; k < STAGES; k++)
            for (int other = 0; other < 2; other++) {
                float *f = draw(&p, stage[other ? k : 2],
                                stage[other ? 2 : k]);
                for (int i = 0; i < N; i++)
                    if (f[4 * i] != 2 * once[4 * i])
                        fail_msg("%u samples, stage %d, pixel %d: %g of %g",
                                 p.samples, k, i, (double)f[4 * i],
                                 2 * (double)once[4 * i]);
                free(f);
            }
        free(once);
    }
}

#define DRAWN(name) \
    CK_ON("vulkan", name), CK_ON("gl", name), CK_ON("packemu", name)

int main(void)
{
    const struct CMUnitTest tests[] = {
        DRAWN(a_resolve_counts_samples),
        DRAWN(centroid_stages_meet_others),
    };
    return cmocka_run_group_tests_name("multisampled passes", tests, NULL,
                                       NULL);
}
