/* SPDX-License-Identifier: Zlib */
/* Xbox 360 memory (spec/consoles 1.3, 1.6, 1.7): the fixed point of -32..32,
 * byte swaps, 24-bit depth of both kinds and 7e3 floats. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { SIDE = 256, CODES = SIDE * SIDE };

static const struct hl_console signed_words = {
    .resolve_exp_bias = -5, .resolve_number = HL_NUMBER_SIGNED };

/* cf->in as it is into a target, read back into cf->raw; the texture stays
 * with the caller. */
static bool put(struct cf *cf, hl_tex *t, enum hl_format format,
                const struct hl_console *console, uint32_t w, uint32_t h)
{
    hl_tex in = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    o.a = hl_v4(1, 1, 1, 1);
    bool ok = cf_input(cf, &in, w, h) &&
              cf_tex(cf, t, format, HL_FORMAT_NONE, console, w, h);
    o.in = in;
    o.target = *t;
    ok = ok && cf_draw(cf, &o) && cf_read(cf, *t);
    cf_drop(cf, &in);
    return ok;
}

static const uint8_t *memory(struct cf *cf, hl_tex t)
{
    size_t bytes;
    return cf->desc->memory ? cf->desc->memory(cf->device, t, &bytes) : NULL;
}

/* ---- 1.3: the fixed point ------------------------------------------------ */

static const struct { float v; int32_t code; uint8_t hi, lo; float back; }
fixed_rows[] = {
    { 0, 0, 0x00, 0x00, 0 }, { (float)NAN, 0, 0x00, 0x00, 0 },
    { 1, 1024, 0x04, 0x00, 1.000030517578125f },
    { -1, -1024, 0xfc, 0x00, -1.000030517578125f },
    { 0.5f, 512, 0x02, 0x00, 0.5000152587890625f },
    { 0.0009765625f, 1, 0x00, 0x01, 0.0009765923f },
    { 0.00048828125f, 0, 0x00, 0x00, 0 },
    { 16, 16384, 0x40, 0x00, 16.00048828125f },
    { 32, 32767, 0x7f, 0xff, 32 }, { 40, 32767, 0x7f, 0xff, 32 },
    { -32, -32767, 0x80, 0x01, -32 }, { -40, -32767, 0x80, 0x01, -32 },
};
enum { FIXED_ROWS = sizeof fixed_rows / sizeof fixed_rows[0] };

static void fixed_table(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result code = cf_result(
        HL_CONFORM_EXACT, "codes", 0, "the table's twelve values");
    struct hl_conform_result bytes = cf_result(
        HL_CONFORM_EXACT, "bytes", 0, "the table's bytes, swap 8 in 16");
    struct hl_conform_result back = cf_result(
        HL_CONFORM_TOLERANCE, "", 4e-6,
        "decoded from memory: code x 32 / 32767, two roundings of 32");
    struct hl_console c = signed_words;
    hl_tex t = { 0 }, out = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    c.endian = HL_ENDIAN_8IN16;
    memset(cf->in, 0, 64 * sizeof *cf->in);
    for (int i = 0; i < FIXED_ROWS; i++)
        cf->in[i][0] = cf->in[i][1] = fixed_rows[i].v;
    if (put(cf, &t, HL_FORMAT_RG16_FIXED32, &c, 16, 1)) {
        const uint8_t *m = memory(cf, t);
        for (int i = 0; i < FIXED_ROWS; i++) {
            int16_t got;
            memcpy(&got, cf->raw + 4 * i, sizeof got);
            cf_case_at(&code, fabs((double)got - fixed_rows[i].code), i, 0);
            for (int k = 0; m && k < 4; k++)
                cf_case_at(&bytes, fabs((double)m[4 * i + k] -
                           (k & 1 ? fixed_rows[i].lo : fixed_rows[i].hi)),
                           i, k);
        }
        o.op = HL_OP_STORED;
        o.stored = t;
        if (cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL, 16,
                   1)) {
            o.target = out;
            if (cf_draw(cf, &o) && cf_read(cf, out))
                for (int i = 0; i < FIXED_ROWS; i++)
                    cf_case_at(&back, fabs((double)cf->out[i][0] * 32 -
                                           (double)fixed_rows[i].back), i, 0);
        }
    }
    code.where = bytes.where = back.where = "row";
    code.n_at = bytes.n_at = back.n_at = 1;
    if (!cf->desc->memory) {
        bytes.status = HL_CONFORM_SKIP;
        bytes.why = "the machine's memory cannot be seen from here";
    }
    cf_report(cf, g, "fixed_table", &code);
    cf_report(cf, g, "fixed_bytes", &bytes);
    cf_report(cf, g, "fixed_decode", &back);
    cf_drop(cf, &t);
    cf_drop(cf, &out);
}

/* Random values and all ties: half way between codes goes away from zero. */
static void fixed_random(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "trunc(v 1023.96875 +- 0.5) of v clamped to -32..32");
    hl_tex t = { 0 };
    for (uint32_t i = 0; i < CODES; i++)
        for (int c = 0; c < 4; c++) {
            double u = cf_unit(cf) * 2 - 1;
            cf->in[i][c] = c == 0 ? (float)(u * 34) : (float)(u * 0.05);
        }
    if (put(cf, &t, HL_FORMAT_RG16_FIXED32, &signed_words, SIDE, SIDE))
        for (uint32_t i = 0; i < CODES; i++)
            for (int c = 0; c < 2; c++) {
                int16_t got;
                memcpy(&got, cf->raw + 4 * i + 2 * c, sizeof got);
                cf_case_at(&r, fabs((double)got -
                                    cf_fixed32_encode(cf->in[i][c])),
                           (double)cf->in[i][c], 0);
            }
    r.where = "v";
    r.n_at = 1;
    cf_report(cf, g, "fixed_encode", &r);
    cf_drop(cf, &t);
}

/* The target's exponent bias: 2 v - 1 times 2^5. */
static void exp_bias(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "a colour exponent bias of 5 multiplies by 32 before the store");
    struct hl_console c = signed_words;
    hl_tex t = { 0 };
    c.color_exp_bias = 5;
    for (uint32_t i = 0; i < CODES; i++)
        cf->in[i][0] = cf->in[i][1] = (float)((double)i / CODES * 2 - 1);
    if (put(cf, &t, HL_FORMAT_RG16_FIXED32, &c, SIDE, SIDE))
        for (uint32_t i = 0; i < CODES; i++) {
            int16_t got;
            memcpy(&got, cf->raw + 4 * i, sizeof got);
            cf_case_at(&r, fabs((double)got -
                                cf_fixed32_encode(cf->in[i][0] * 32)),
                       (double)cf->in[i][0], 0);
        }
    r.where = "v";
    r.n_at = 1;
    cf_report(cf, g, "color_exp_bias", &r);
    cf_drop(cf, &t);
}

/* Code -32768 is made by no store: a surface of bytes in the same tiles
 * leaves it there, and the resolve makes -32767 of it. */
static void lowest_code(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "code 8000 in EDRAM is resolved as 8001");
    struct hl_console c = signed_words, d;
    hl_tex bytes = { 0 }, fixed = { 0 };
    struct hl_pass pass;
    memset(&d, 0, sizeof d);
    memset(&pass, 0, sizeof pass);
    c.edram_tile = d.edram_tile = 2000;
    for (int k = 0; k < 4; k++)
        cf->in[0][k] = k & 1 ? 128 / 255.0f : 0;
    pass.label = "alias";
    pass.n_colors = 1;
    pass.color[0].load = HL_LOAD_KEEP;
    if (cf_tex(cf, &fixed, HL_FORMAT_RG16_FIXED32, HL_FORMAT_NONE, &c, 1,
               1) &&
        put(cf, &bytes, HL_FORMAT_RGBA8_UNORM, &d, 1, 1)) {
        pass.color[0].tex = fixed;
        if (cf_ok(cf, hl_pass_run(cf->device, &pass)) && cf_read(cf, fixed))
            for (int k = 0; k < 2; k++) {
                int16_t got;
                memcpy(&got, cf->raw + 2 * k, sizeof got);
                cf_case(&r, fabs((double)got + 32767));
            }
    }
    cf_report(cf, g, "code_8000", &r);
    cf_drop(cf, &bytes);
    cf_drop(cf, &fixed);
}

/* ---- 1.6: byte swaps ----------------------------------------------------- */

static void endian(struct cf *cf, const struct cf_group *g)
{
    static const uint8_t want[4][4] = {
        { 0x34, 0x12, 0xcd, 0xab }, { 0x12, 0x34, 0xab, 0xcd },
        { 0xab, 0xcd, 0x12, 0x34 }, { 0xcd, 0xab, 0x34, 0x12 } };
    static const char *const name[4] = { "endian_none", "endian_8in16",
                                         "endian_8in32", "endian_16in32" };
    for (int e = 0; e < 4; e++) {
        struct hl_conform_result r = cf_result(
            HL_CONFORM_EXACT, "bytes", 0,
            "memory of R = 1234, G = ABCD, and the same word sampled back");
        struct hl_console c = signed_words;
        hl_tex t = { 0 };
        c.endian = (uint8_t)e;
        cf->in[0][0] = cf_fixed32_decode(0x1234);
        cf->in[0][1] = cf_fixed32_decode((int16_t)0xabcd);
        if (put(cf, &t, HL_FORMAT_RG16_FIXED32, &c, 1, 1)) {
            const uint8_t *m = memory(cf, t);
            uint16_t word[2];
            memcpy(word, cf->raw, sizeof word);
            cf_case(&r, word[0] == 0x1234 && word[1] == 0xabcd ? 0 : 1);
            for (int k = 0; m && k < 4; k++)
                cf_case_at(&r, fabs((double)m[k] - want[e][k]), k, 0);
        }
        if (!cf->desc->memory) {
            r.status = HL_CONFORM_SKIP;
            r.why = "the machine's memory cannot be seen from here";
        }
        cf_report(cf, g, name[e], &r);
        cf_drop(cf, &t);
    }
}

/* ---- 1.7: depth ---------------------------------------------------------- */

/* Depth that a clear stores, as the word's upper 24 bits in memory. */
static bool clear_depth(struct cf *cf, hl_tex t, float z, uint32_t *code,
                        float *read)
{
    struct hl_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.label = "clear";
    pass.depth.tex = t;
    pass.depth.load = HL_LOAD_CLEAR;
    pass.depth.clear[0] = z;
    pass.depth.clear[1] = 0x5a;
    if (!cf_ok(cf, hl_pass_run(cf->device, &pass)) ||
        !cf_ok(cf, hl_submit(cf->device, true)) || !cf_read(cf, t))
        return false;
    memcpy(read, cf->raw, sizeof *read);
    const uint8_t *m = memory(cf, t);
    *code = m ? (uint32_t)m[0] << 16 | (uint32_t)m[1] << 8 | m[2] : ~0u;
    /* Stencil is the word's low byte. */
    if (m && m[3] != 0x5a)
        *code = ~0u;
    return true;
}

struct depth_row { float z; uint32_t code; };

static void depth(struct cf *cf, const struct cf_group *g,
                  enum hl_format format, const char *table,
                  const char *random, const struct depth_row *rows, int n)
{
    bool real = format == HL_FORMAT_D24_FLOAT_S8;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        real ? "20e4 codes of the table, one of its two roundings for all"
             : "24-bit codes of the table, rounded to even");
    struct hl_conform_result s = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        real ? "random depths: one of the two roundings for all, and what "
               "is read is the code's value"
             : "random depths: rint(z 16777215), read as code / 16777215");
    struct hl_console c;
    hl_tex t = { 0 };
    double wrong[2] = { 0, 0 }, off[2] = { 0, 0 };
    uint32_t code;
    float back;
    memset(&c, 0, sizeof c);
    /* Words as the big-endian processor sees them. */
    c.endian = HL_ENDIAN_8IN32;
    int cases = cf->desc->quick ? 100 : 1000;
    if (cf_tex(cf, &t, format, HL_FORMAT_NONE, &c, 1, 1)) {
        for (int i = 0; i < n && clear_depth(cf, t, rows[i].z, &code, &back);
             i++) {
            uint32_t nearest = real ? cf_20e4(rows[i].z, true) : rows[i].code;
            wrong[0] += code != rows[i].code;
            wrong[1] += code != nearest;
            r.cases++;
        }
        for (int i = 0; i < cases; i++) {
            double u = cf_unit(cf);
            float z = (float)(real ? 2 * u * u * u : u);
            if (!clear_depth(cf, t, z, &code, &back))
                break;
            float value = real ? cf_20e4_value(code)
                               : (float)((double)code / 16777215.0);
            uint32_t other = real ? cf_20e4(z, true) : cf_d24(z);
            off[0] += code != (real ? cf_20e4(z, false) : other) ||
                      back != value;
            off[1] += code != other || back != value;
            s.cases++;
        }
    }
    r.worst = fmin(wrong[0], wrong[1]);
    s.worst = fmin(off[0], off[1]);
    r.note = !real ? "" : wrong[0] <= wrong[1] ? "truncates"
                                               : "rounds to nearest even";
    s.note = r.note;
    if (!cf->desc->memory) {
        r.status = s.status = HL_CONFORM_SKIP;
        r.why = s.why = "the machine's memory cannot be seen from here";
    }
    cf_report(cf, g, table, &r);
    cf_report(cf, g, random, &s);
    cf_drop(cf, &t);
}

/* ---- 7e3 ----------------------------------------------------------------- */

/* All 1,024 codes are stored as themselves and sampled as their values. */
static void small_floats(struct cf *cf, const struct cf_group *g)
{
    static const struct { uint32_t code; double value; } rows[] = {
        { 0x001, 1.0 / 512 }, { 0x07f, 0.248046875 }, { 0x080, 0.25 },
        { 0x180, 1 }, { 0x200, 2 }, { 0x280, 4 }, { 0x3ff, 31.875 } };
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "each of 1,024 values of 7e3 is stored as its code and sampled as "
        "itself; seven of them are the table's");
    hl_tex t = { 0 }, out = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        cf_case(&r, fabs((double)cf_7e3_value(rows[i].code) -
                         rows[i].value));
    for (uint32_t i = 0; i < 1024; i++)
        for (uint32_t c = 0; c < 4; c++)
            cf->in[i][c] = cf_7e3_value((i + c * 341) & 1023);
    if (put(cf, &t, HL_FORMAT_RGB10A2_FLOAT, NULL, 1024, 1))
        for (uint32_t i = 0; i < 1024; i++) {
            uint32_t word;
            memcpy(&word, cf->raw + 4 * i, sizeof word);
            for (uint32_t c = 0; c < 3; c++)
                cf_case_at(&r, fabs((double)(word >> 10 * c & 1023) -
                                    ((i + c * 341) & 1023)), i, c);
        }
    o.op = HL_OP_STORED;
    o.stored = t;
    if (cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL, 1024,
               1)) {
        o.target = out;
        if (cf_draw(cf, &o) && cf_read(cf, out))
            for (uint32_t i = 0; i < 1024; i++)
                for (uint32_t c = 0; c < 3; c++)
                    cf_case_at(&r, fabs((double)cf->out[i][c] - (double)
                               cf_7e3_value((i + c * 341) & 1023)), i, c);
    }
    r.where = "code, channel";
    r.n_at = 2;
    cf_report(cf, g, "rgb10a2_float", &r);
    cf_drop(cf, &t);
    cf_drop(cf, &out);
}

const char *cf_xbox(struct cf *cf, const struct cf_group *g)
{
    static const struct depth_row unorm[] = {
        { 0, 0 }, { 1, 0xffffff }, { 0.5f, 0x800000 }, { 0.25f, 0x400000 },
        { 0.75f, 0xbfffff }, { 0.1f, 0x19999a }, { 0.9999999f, 0xfffffd } };
    static const struct depth_row real[] = {
        { 1, 0xf00000 }, { 0.5f, 0xe00000 }, { 0.1f, 0xb99999 },
        { 1.99999f, 0xfffff5 }, { 2, 0xffffff }, { 3, 0xffffff },
        { 1.0f / 16384, 0x100000 }, { 1 / 17179869184.0f, 1 },
        { 1 / 34359738368.0f, 0 }, { 0, 0 } };
    if (!cf_usable(cf, HL_FORMAT_RG16_FIXED32, HL_USE_TARGET) ||
        !cf->caps->console_memory)
        return "needs a machine that keeps Xbox 360 memory";
    fixed_table(cf, g);
    fixed_random(cf, g);
    exp_bias(cf, g);
    lowest_code(cf, g);
    endian(cf, g);
    depth(cf, g, HL_FORMAT_D24_UNORM_S8, "d24_table", "d24_random", unorm,
          (int)(sizeof unorm / sizeof unorm[0]));
    depth(cf, g, HL_FORMAT_D24_FLOAT_S8, "d20e4_table", "d20e4_random", real,
          (int)(sizeof real / sizeof real[0]));
    small_floats(cf, g);
    return NULL;
}
