/* SPDX-License-Identifier: Zlib */
/* Light indices packed by blending (spec/conformance b4): four pairs of bits
 * a byte, each new light moving the older ones down by a quarter. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { LONGEST = 5, WIDTH = 1024 };

/* Sequence x of `length` pairs of bits, another one in each channel. */
static uint32_t sequence(uint32_t x, uint32_t length, int c)
{
    uint32_t n = 1u << 2 * length;
    return (x + (uint32_t)c * (n / 3 + 1)) % n;
}

/* Row r: all sequences of r + 1 lights, drawn one after another. */
static bool shift(struct cf *cf, hl_tex in, hl_tex target)
{
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (uint32_t r = 0; r < LONGEST; r++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (int c = 0; c < 4; c++)
                cf->in[r * WIDTH + x][c] = (float)sequence(x, r + 1, c);
    if (!cf_write(cf, in, cf->in))
        return false;
    o.op = HL_OP_DIGIT;
    o.in = in;
    o.target = target;
    o.blend = HL_BLEND_SHIFT;
    o.constant = cf->mutant == CF_MUTANT_BLEND_63_255 ? 63.0f / 255 : 0.25f;
    for (int k = 0; k < LONGEST; k++) {
        o.a = hl_v4((float)(1 << 2 * k), 0, 0, 0);
        o.keep = k > 0;
        o.scissor.y = k;
        o.scissor.width = WIDTH;
        o.scissor.height = LONGEST - k;
        if (!cf_draw(cf, &o))
            return false;
    }
    return cf_read(cf, target);
}

/* What a byte holds after `length` lights, the last one on top; exact while
 * there is room for them. */
static double packed(uint32_t s, uint32_t length)
{
    double v = 0;
    for (uint32_t k = 0; k < length; k++)
        v = v / 4 + 64 * (s >> 2 * k & 3);
    return v;
}

static void judge(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result four = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "all 340 sequences of up to 4 lights, exact under any rounding");
    struct hl_conform_result five = cf_result(
        HL_CONFORM_INTERVAL, "codes", 1,
        "all 1,024 sequences of 5 lights: a neighbour of the true value; "
        "where it is not its floor, all indices left of it are at risk");
    uint32_t wrong = 0;
    for (uint32_t r = 0; r < LONGEST; r++)
        for (uint32_t x = 0; x < 1u << 2 * (r + 1); x++)
            for (int c = 0; c < 4; c++) {
                uint32_t s = sequence(x, r + 1, c);
                double want = packed(s, r + 1);
                double got = cf->raw[4 * (r * WIDTH + x) + (uint32_t)c];
                cf_case_at(r < 4 ? &four : &five, fabs(got - want), s, r + 1);
                wrong += r == 4 && got != floor(want);
            }
    four.where = "sequence, lights";
    four.n_at = 2;
    five.where = "channels wrong of 4,096";
    five.at[0] = wrong;
    five.n_at = 1;
    cf_report(cf, g, "shift_4", &four);
    cf_report(cf, g, "shift_5", &five);
}

/* Every code of a byte is found again by ceil(p 254.5). */
static void decode(struct cf *cf, const struct cf_group *g, hl_tex stored)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "ceil(p 254.5) of p = k / 255 is k, all 256");
    hl_tex out = { 0 };
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (uint32_t i = 0; i < 4 * WIDTH * LONGEST; i++)
        cf->raw[i] = (uint8_t)(i / 4 + i % 4 * 85);
    if (cf_tex(cf, &out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL, WIDTH,
               LONGEST) && cf_write(cf, stored, cf->raw)) {
        o.op = HL_OP_INDEX;
        o.stored = stored;
        o.target = out;
        if (cf_draw(cf, &o) && cf_read(cf, out))
            for (uint32_t i = 0; i < WIDTH; i++)
                for (uint32_t c = 0; c < 4; c++)
                    cf_case_at(&r, fabs((double)cf->out[i][c] -
                                        (i + c * 85) % 256),
                               (i + c * 85) % 256, 0);
    }
    cf_drop(cf, &out);
    r.where = "code";
    r.n_at = 1;
    cf_report(cf, g, "decode", &r);
}

const char *cf_index(struct cf *cf, const struct cf_group *g)
{
    hl_tex in = { 0 }, target = { 0 };
    if (!cf_usable(cf, HL_FORMAT_RGBA8_UNORM, HL_USE_TARGET | HL_USE_BLEND))
        return "this device does not blend bytes";
    if (cf_input(cf, &in, WIDTH, LONGEST) &&
        cf_tex(cf, &target, HL_FORMAT_RGBA8_UNORM, HL_FORMAT_NONE, NULL,
               WIDTH, LONGEST) && shift(cf, in, target)) {
        judge(cf, g);
        decode(cf, g, target);
    }
    cf_drop(cf, &in);
    cf_drop(cf, &target);
    return NULL;
}
