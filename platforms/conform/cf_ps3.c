/* SPDX-License-Identifier: Zlib */
/* PlayStation 3 memory (spec/consoles 2.4, 2.5): bytes read as pairs of 16
 * bits, and depth read as bytes. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { SIDE = 256, CODES = SIDE * SIDE };

static const uint8_t *memory(struct cf *cf, hl_tex t)
{
    size_t bytes;
    return cf->desc->memory ? cf->desc->memory(cf->device, t, &bytes) : NULL;
}

/* cf->in packed into A8R8G8B8 words that are read with `remap`; *out sampled
 * in cf->out. */
static bool pack(struct cf *cf, uint16_t remap, hl_tex *t, uint32_t w,
                 uint32_t h)
{
    hl_tex in = { 0 }, out = { 0 };
    struct hl_console c;
    struct cf_op o;
    memset(&o, 0, sizeof o);
    memset(&c, 0, sizeof c);
    c.remap = remap;
    bool ok = cf_input(cf, &in, w, h) &&
              cf_tex(cf, t, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RG16_UNORM, &c,
                     w, h) &&
              cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL,
                     w, h);
    o.op = HL_OP_PACK;
    o.two16 = HL_TWO16_BYTES_ARGB;
    o.c = hl_v4(1, 0, 0, 0);
    o.in = in;
    o.target = *t;
    ok = ok && cf_draw(cf, &o);
    o.op = HL_OP_STORED;
    o.stored = *t;
    o.target = out;
    ok = ok && cf_draw(cf, &o) && cf_read(cf, out);
    cf_drop(cf, &in);
    cf_drop(cf, &out);
    return ok;
}

/* ---- 2.4: memory and remaps ---------------------------------------------- */

static const struct { float x, y; uint8_t argb[4]; } rows[] = {
    { 0, 0, { 0x00, 0x00, 0x00, 0x00 } },
    { 1, 0, { 0x00, 0x00, 0xff, 0xff } },
    { 0, 1, { 0xff, 0xff, 0x00, 0x00 } },
    { 0.5f, 0.25f, { 0x40, 0x00, 0x80, 0x00 } },
    { 0x1234 / 65535.0f, 0xabcd / 65535.0f, { 0xab, 0xcd, 0x12, 0x34 } },
    { 0.1f, 1 / 65535.0f, { 0x00, 0x01, 0x19, 0x9a } },
};
enum { ROWS = sizeof rows / sizeof rows[0] };

static void bytes(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "bytes", 0, "memory A R G B of the table's rows");
    hl_tex t = { 0 };
    memset(cf->in, 0, 64 * sizeof *cf->in);
    for (int i = 0; i < ROWS; i++) {
        cf->in[i][0] = rows[i].x;
        cf->in[i][1] = rows[i].y;
    }
    if (pack(cf, 0xaa4e, &t, ROWS, 1)) {
        const uint8_t *m = memory(cf, t);
        for (int i = 0; m && i < 4 * ROWS; i++)
            cf_case_at(&r, fabs((double)m[i] - rows[i / 4].argb[i % 4]),
                       i / 4, i % 4);
    }
    if (!cf->desc->memory) {
        r.status = HL_CONFORM_SKIP;
        r.why = "the machine's memory cannot be seen from here";
    }
    r.where = "row, byte";
    r.n_at = 2;
    cf_report(cf, g, "memory", &r);
    cf_drop(cf, &t);
}

/* What each remap gives as r, g, b, a: 0 is X, 1 is Y. The words list A
 * first; XXXY orders (bit 16) do not fit hl_console. */
static void remaps(struct cf *cf, const struct cf_group *g)
{
    static const struct { uint16_t word; uint8_t rgba[4]; const char *name; }
    words[] = { { 0xaae4, { 1, 0, 1, 0 }, "remap_e4" },
                { 0xaa4e, { 0, 1, 0, 1 }, "remap_4e" },
                { 0xaaee, { 0, 0, 0, 0 }, "remap_ee" },
                { 0xaa44, { 1, 1, 1, 1 }, "remap_44" },
                { 0, { 1, 0, 1, 0 }, "remap_default" } };
    for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
        struct hl_conform_result r = cf_result(
            HL_CONFORM_EXACT, "codes", 0,
            "Y16_X16 under the remap: A R G B of the table, all 65,536 "
            "numbers exact");
        hl_tex t = { 0 };
        memset(cf->in, 0, CODES * sizeof *cf->in);
        for (uint32_t i = 0; i < CODES; i++) {
            cf->in[i][0] = (float)i / 65535.0f;
            cf->in[i][1] = (float)(i * 40503u % CODES) / 65535.0f;
        }
        if (pack(cf, words[k].word, &t, SIDE, SIDE))
            for (uint32_t i = 0; i < CODES; i++)
                for (int c = 0; c < 4; c++) {
                    uint32_t want = words[k].rgba[c] ? i * 40503u % CODES : i;
                    double got = (double)cf->out[i][c] * 65535;
                    cf_case_at(&r, fabs(floor(got + 0.5) - want), i, c);
                }
        r.where = "code, channel";
        r.n_at = 2;
        cf_report(cf, g, words[k].name, &r);
        cf_drop(cf, &t);
    }
}

/* ---- 2.5: depth ---------------------------------------------------------- */

/* Depth by clears, read through `remap` as bytes. */
static bool read_depth(struct cf *cf, hl_tex t, hl_tex out, float z,
                       uint32_t op)
{
    struct hl_pass pass;
    struct cf_op o;
    memset(&pass, 0, sizeof pass);
    memset(&o, 0, sizeof o);
    pass.label = "clear";
    pass.depth.tex = t;
    pass.depth.load = HL_LOAD_CLEAR;
    pass.depth.clear[0] = z;
    pass.depth.clear[1] = 0x5a;
    o.op = op;
    o.stored = t;
    o.target = out;
    return cf_ok(cf, hl_pass_run(cf->device, &pass)) && cf_draw(cf, &o) &&
           cf_read(cf, out);
}

static double byte(float x) { return floor((double)x * 255 + 0.5); }

static void barg(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result exact = cf_result(
        HL_CONFORM_EXACT, "", 0,
        "depth through BARG is code / 16777215, correctly rounded");
    struct hl_conform_result stencil = cf_result(
        HL_CONFORM_EXACT, "", 0, "BARG has the stencil in alpha");
    struct hl_conform_result wrong = cf_result(
        HL_CONFORM_EXACT, "bytes", 0,
        "the default remap gives middle, low byte and stencil instead");
    struct hl_console c;
    hl_tex t = { 0 }, u = { 0 }, out = { 0 };
    memset(&c, 0, sizeof c);
    c.remap = 0xaa93;
    bool ok = cf_tex(cf, &t, HL_FORMAT_D24_UNORM_S8, HL_FORMAT_RGBA8_UNORM,
                     &c, 1, 1);
    c.remap = 0xaae4;
    ok = ok && cf_tex(cf, &u, HL_FORMAT_D24_UNORM_S8, HL_FORMAT_RGBA8_UNORM,
                      &c, 1, 1) &&
         cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL, 1, 1);
    int n = cf->desc->quick ? 100 : 1000;
    for (int i = 0; ok && i < n; i++) {
        float z = i < 2 ? (float)i : (float)cf_unit(cf);
        uint32_t code = cf_d24(z);
        double value = (double)(float)(code / 16777215.0);
        ok = read_depth(cf, t, out, z, HL_OP_BARG);
        if (ok) {
            cf_case_at(&exact, fabs((double)cf->out[0][0] - value),
                       (double)z, 0);
            cf_case(&stencil, fabs(byte(cf->out[0][1]) - 0x5a));
        }
        ok = ok && read_depth(cf, u, out, z, HL_OP_STORED);
        if (ok)
            cf_case(&wrong, fabs(byte(cf->out[0][0]) - (code >> 8 & 255)) +
                            fabs(byte(cf->out[0][1]) - (code & 255)) +
                            fabs(byte(cf->out[0][2]) - 0x5a));
    }
    exact.where = "z";
    exact.n_at = 1;
    cf_report(cf, g, "depth_barg", &exact);
    cf_report(cf, g, "depth_barg_stencil", &stencil);
    cf_report(cf, g, "depth_default_remap", &wrong);
    cf_drop(cf, &t);
    cf_drop(cf, &u);
    cf_drop(cf, &out);
}

const char *cf_ps3(struct cf *cf, const struct cf_group *g)
{
    if (!cf->caps->console_memory || !cf->profile->big_endian ||
        cf->profile->resolve_to_read)
        return "needs a machine that keeps PlayStation 3 memory";
    bytes(cf, g);
    remaps(cf, g);
    barg(cf, g);
    return NULL;
}
