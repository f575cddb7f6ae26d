/* SPDX-License-Identifier: Zlib */
/* Pixel centres (spec/conformance b6, spec/consoles 3): a ramp of depth drawn
 * as a mesh, and how far it lies from where it should. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { WIDTH = 256, HEIGHT = 128 };

struct bench {
    struct cf *cf;
    const struct cf_group *group;
    enum hl_format format;
    hl_buf vertices, object;
    hl_tex depth;
};

/* Two triangles over the whole of clip space and beyond; depth rises from
 * 0.1 to 0.9 across x or y. */
static bool ramp_mesh(struct bench *b, bool along_y)
{
    static const float corner[6][2] = { { -2, -2 }, { 2, -2 }, { -2, 2 },
                                        { -2, 2 }, { 2, -2 }, { 2, 2 } };
    bool zero_to_one = b->cf->caps->clip_zero_to_one;
    float v[6][3];
    for (int i = 0; i < 6; i++) {
        float z = 0.5f + 0.2f * corner[i][along_y];
        v[i][0] = corner[i][0];
        v[i][1] = corner[i][1];
        v[i][2] = zero_to_one ? z : 2 * z - 1;
    }
    return cf_ok(b->cf, hl_buf_write(b->cf->device, b->vertices, 0, v,
                                     sizeof v));
}

static bool make_buffers(struct bench *b)
{
    struct hl_buf_desc d;
    struct hl_object_block object;
    memset(&object, 0, sizeof object);
    object.clip.column[0].x = object.clip.column[1].y = 1;
    object.clip.column[2].z = object.clip.column[3].w = 1;
    if (b->cf->mutant == CF_MUTANT_HALF_PIXEL) {
        object.clip.column[3].x = 1.0f / WIDTH;
        object.clip.column[3].y = 1.0f / HEIGHT;
    }
    memset(&d, 0, sizeof d);
    d.bytes = 6 * 3 * sizeof(float);
    d.usage = HL_BUF_VERTEX;
    d.dynamic = true;
    bool ok = cf_ok(b->cf, hl_buf_create(b->cf->device, &b->vertices, &d));
    d.bytes = sizeof object;
    d.usage = HL_BUF_UNIFORM;
    d.data = &object;
    return ok && cf_ok(b->cf, hl_buf_create(b->cf->device, &b->object, &d));
}

static bool make_program(struct bench *b, hl_prog *out, bool shift)
{
    const float by[2] = { -1.0f / WIDTH, -1.0f / HEIGHT };
    struct hl_prog_desc p;
    memset(&p, 0, sizeof p);
    p.label = "ramp";
    p.vertex.builtin = HL_SHADER_MESH_ID_VERT;
    p.layout.attr[HL_ATTR_POSITION].format = HL_ATTR_F32X3;
    p.layout.stride[0] = 3 * sizeof(float);
    p.depth = b->format;
    p.depth_test = HL_COMPARE_ALWAYS;
    p.depth_write = true;
    if (shift) {
        p.n_specs = 2;
        p.spec[0].id = HL_SPEC_SHIFT_X;
        p.spec[1].id = HL_SPEC_SHIFT_Y;
        memcpy(&p.spec[0].value, &by[0], sizeof by[0]);
        memcpy(&p.spec[1].value, &by[1], sizeof by[1]);
    }
    return cf_ok(b->cf, hl_prog_create(b->cf->device, out, &p));
}

/* Draw the ramp and read it back. */
static bool draw(struct bench *b, bool state, bool shift)
{
    struct hl_draw d;
    struct hl_pass pass;
    struct cf *cf = b->cf;
    memset(&d, 0, sizeof d);
    memset(&pass, 0, sizeof pass);
    if (!make_program(b, &d.prog, shift))
        return false;
    d.vertex[0] = b->vertices;
    d.count = 6;
    d.uniform[HL_SLOT_FRAME].buf = b->object;
    d.uniform[HL_SLOT_FRAME].bytes = sizeof(struct hl_frame_block);
    d.uniform[HL_SLOT_OBJECT].buf = b->object;
    d.uniform[HL_SLOT_OBJECT].bytes = sizeof(struct hl_object_block);
    pass.label = "ramp";
    pass.depth.tex = b->depth;
    pass.depth.load = HL_LOAD_CLEAR;
    pass.half_pixel_offset = state;
    pass.draws = &d;
    pass.n_draws = 1;
    bool ok = cf_ok(cf, hl_pass_run(cf->device, &pass)) &&
              cf_ok(cf, hl_submit(cf->device, true)) &&
              cf_read(cf, b->depth);
    hl_prog_destroy(cf->device, &d.prog);
    return ok;
}

static double at(const struct bench *b, int x, int y)
{
    float z;
    memcpy(&z, b->cf->raw + 4 * (size_t)(y * WIDTH + x), sizeof z);
    return (double)z;
}

/* Least-squares shift of a ramp of known slope, in pixels: the mean of what
 * each pixel is off. Positive: the scene appears right or down. The border is
 * left out, where a machine without centres at halves has none. */
static double fit(const struct bench *b, bool along_y)
{
    int n = along_y ? HEIGHT : WIDTH;
    double slope = 0.4 / n, sum = 0;
    /* Clip y is up, rows go down, so that depth falls with the row. */
    bool falls = along_y && at(b, 1, 1) > at(b, 1, HEIGHT - 2);
    for (int y = 1; y < HEIGHT - 1; y++)
        for (int x = 1; x < WIDTH - 1; x++) {
            double t = (along_y ? y : x) + 0.5;
            double want = 0.3 + slope * (falls ? n - t : t);
            sum += (at(b, x, y) - want) / (falls ? slope : -slope);
        }
    return sum / ((HEIGHT - 2) * (WIDTH - 2));
}

static void measure(struct bench *b, const char *x_name, const char *y_name,
                    bool state, bool shift, double expected, const char *why)
{
    const char *name[2] = { x_name, y_name };
    for (int k = 0; k < 2; k++) {
        struct hl_conform_result r =
            cf_result(HL_CONFORM_TOLERANCE, "pixels", 0.02, why);
        double got = (double)NAN;
        if (ramp_mesh(b, k == 1) && draw(b, state, shift))
            got = fit(b, k == 1);
        cf_case(&r, fabs(got - expected));
        r.cases = (HEIGHT - 2) * (WIDTH - 2);
        r.where = "shift";
        r.at[0] = got;
        r.n_at = 1;
        cf_report(b->cf, b->group, name[k], &r);
    }
}

/* ---- sampling ----------------------------------------------------------- */

/* A texture sampled at u = p / width, as a pass without the half pixel does,
 * gives the mean of texels p - 1 and p; at (p + 1/2) / width texel p. */
static void edges(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result edge = cf_result(
        HL_CONFORM_TOLERANCE, "codes", 0.55,
        "filtered at p / width: the mean of texels p - 1 and p; weights have "
        "8 bits of fraction, 1/512 of up to 255 codes");
    struct hl_conform_result centre = cf_result(
        HL_CONFORM_TOLERANCE, "codes", 0.55,
        "filtered at (p + 1/2) / width: texel p, weights as above");
    hl_tex in = { 0 }, tex = { 0 }, out = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (uint32_t i = 0; i < 4 * WIDTH; i++)
        cf->raw[i] = (uint8_t)cf_random(cf);
    for (uint32_t x = 0; x < WIDTH; x++) {
        cf->in[x][0] = (float)x / WIDTH;
        cf->in[WIDTH + x][0] = ((float)x + 0.5f) / WIDTH;
        cf->in[x][1] = cf->in[WIDTH + x][1] = 0.5f;
    }
    bool ok = cf_input(cf, &in, WIDTH, 2) &&
              cf_tex(cf, &tex, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_NONE, NULL,
                     WIDTH, 1) &&
              cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL,
                     WIDTH, 2) && cf_write(cf, tex, cf->raw);
    o.op = HL_OP_SAMPLE;
    o.in = in;
    o.stored = tex;
    o.target = out;
    o.linear = true;
    ok = ok && cf_draw(cf, &o) && cf_read(cf, out);
    for (uint32_t x = 1; ok && x < WIDTH; x++)
        for (uint32_t c = 0; c < 4; c++) {
            double a = cf->raw[4 * x - 4 + c], b = cf->raw[4 * x + c];
            cf_case_at(&edge, fabs((double)cf->out[x][c] * 255 -
                                   (a + b) / 2), x, 0);
            cf_case_at(&centre, fabs((double)cf->out[WIDTH + x][c] * 255 -
                                     b), x, 0);
        }
    cf_drop(cf, &in);
    cf_drop(cf, &tex);
    cf_drop(cf, &out);
    edge.where = centre.where = "pixel";
    edge.n_at = centre.n_at = 1;
    cf_report(cf, g, "sampled_at_edge", &edge);
    cf_report(cf, g, "sampled_at_centre", &centre);
}

/* ---- the group ---------------------------------------------------------- */

static enum hl_format depth_format(const struct cf *cf)
{
    static const enum hl_format list[] = {
        HL_FORMAT_D24_FLOAT_S8, HL_FORMAT_D32_FLOAT, HL_FORMAT_D24_UNORM_S8 };
    for (int i = 0; i < 3; i++)
        if (cf_usable(cf, list[i], HL_USE_TARGET | HL_USE_SAMPLED))
            return list[i];
    return HL_FORMAT_NONE;
}

static void ramps(struct bench *b)
{
    struct cf *cf = b->cf;
    bool d3d9 = cf->profile->integer_centers;
    measure(b, "ramp_x", "ramp_y", d3d9, false, 0,
            "as a plan draws: a fitted shift under 1/50 pixel");
    if (!d3d9 || !cf->caps->console_memory)
        return;
    measure(b, "vertex_x", "vertex_y", false, true, 0,
            "the vertex stage's half pixel instead of the state");
    /* Integer centres sample half a pixel to the left of and above what is
     * meant, so that the scene lies half a pixel to the right and below. */
    measure(b, "neither_x", "neither_y", false, false, 0.5,
            "neither the state nor the vertex stage: half a pixel off");
    measure(b, "both_x", "both_y", true, true, -0.5,
            "the state and the vertex stage: half a pixel off the other way");
}

const char *cf_centre(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    memset(&b, 0, sizeof b);
    b.cf = cf;
    b.group = g;
    b.format = depth_format(cf);
    edges(cf, g);
    if (b.format == HL_FORMAT_NONE)
        return "this device has no depth format that can be read";
    if (make_buffers(&b) &&
        cf_tex(cf, &b.depth, b.format, HL_FORMAT_NONE, NULL, WIDTH, HEIGHT))
        ramps(&b);
    cf_drop(cf, &b.depth);
    hl_buf_destroy(cf->device, &b.vertices);
    hl_buf_destroy(cf->device, &b.object);
    return "this machine's pixel centres are at halves";
}
