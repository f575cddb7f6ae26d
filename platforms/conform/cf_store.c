/* SPDX-License-Identifier: Zlib */
/* Ways to store two numbers of 0..1, as a profile's rows or the formats
 * themselves have them, and the ways to get it wrong. */
#include <string.h>
#include "platforms/conform/cf.h"

static const struct cf_store stores[CF_STORES] = {
    [CF_RG16_UNORM] = { .format = HL_FORMAT_RG16_UNORM, .scale = 1,
                        .steps = 65535 },
    [CF_RG16_SNORM] = { .format = HL_FORMAT_RG16_SNORM, .scale = 1,
                        .two16 = HL_TWO16_SIGNED, .steps = 65534 },
    [CF_RG16_FLOAT] = { .format = HL_FORMAT_RG16_FLOAT, .scale = 1,
                        .two16 = HL_TWO16_SIGNED, .floats = true },
    [CF_RG16_FLOAT_BIASED] = { .format = HL_FORMAT_RG16_FLOAT, .scale = 1,
                               .floats = true },
    [CF_RGBA8_BYTES] = { .format = HL_FORMAT_RGBA8_UNORM,
                         .sample_as = HL_FORMAT_RG16_UNORM, .scale = 1,
                         .two16 = HL_TWO16_BYTES, .steps = 65535 },
    [CF_RGBA8_ARGB] = { .format = HL_FORMAT_RGBA8_UNORM,
                        .sample_as = HL_FORMAT_RG16_UNORM, .scale = 1,
                        .two16 = HL_TWO16_BYTES_ARGB, .steps = 65535,
                        .console = { .remap = 0xaa4e } },
    [CF_RG16_FIXED32] = { .format = HL_FORMAT_RG16_FIXED32, .scale = 1,
                          .two16 = HL_TWO16_FIXED32, .steps = 65534,
                          .console = { .resolve_exp_bias = -5,
                                       .resolve_number = HL_NUMBER_SIGNED } },
    [CF_RG8_UNORM] = { .format = HL_FORMAT_RG8_UNORM, .scale = 1,
                       .steps = 255 },
    /* -1..1 written to a range of -32..32: 2,048 of 65,534 steps. */
    [CF_UNSCALED] = { .format = HL_FORMAT_RG16_SNORM, .scale = 1 / 32.0f,
                      .two16 = HL_TWO16_SIGNED, .steps = 65534 / 32.0 },
    [CF_BASE255] = { .format = HL_FORMAT_RGBA8_UNORM,
                     .sample_as = HL_FORMAT_RG16_UNORM, .scale = 1,
                     .two16 = HL_TWO16_BYTES, .pack = 1, .steps = 65535 },
};

/* The console's own way to keep a format, where the profile has one. */
static void by_profile(const struct cf *cf, struct cf_store *s)
{
    for (int i = 0; i < HL_PROFILE_FORMATS; i++) {
        const struct hl_profile_format *p = &cf->profile->two16[i];
        if (p->format == s->format && p->two16 == s->two16 &&
            p->on != HL_ON_STAND_IN && cf->caps->console_memory)
            s->console = p->console;
    }
}

void cf_spoil(const struct cf *cf, struct cf_store *s)
{
    bool bytes = s->two16 == HL_TWO16_BYTES ||
                 s->two16 == HL_TWO16_BYTES_ARGB;
    bool fixed = s->two16 == HL_TWO16_FIXED32;
    if (cf->mutant == CF_MUTANT_BASE255 && bytes)
        s->pack = 1;
    if (cf->mutant == CF_MUTANT_SWAPPED_BYTES && bytes && s->pack < 1)
        s->pack = 2;
    if (cf->mutant == CF_MUTANT_WRONG_EXP_BIAS && fixed)
        s->console.resolve_exp_bias = 0;
    if (cf->mutant == CF_MUTANT_MISSING_X32 && fixed) {
        s->two16 = HL_TWO16_SIGNED;
        s->console.resolve_exp_bias = 0;
    }
}

static bool remaps(const struct cf *cf)
{
    return cf->caps->console_memory && cf->profile->big_endian &&
           !cf->profile->resolve_to_read;
}

/* The errors that others make, as the console itself makes them. */
static void on_console(const struct cf *cf, enum cf_store_id id,
                       struct cf_store *s)
{
    if (id == CF_UNSCALED && cf->caps->console_memory &&
        cf_usable(cf, HL_FORMAT_RG16_FIXED32, HL_USE_TARGET)) {
        s->format = HL_FORMAT_RG16_FIXED32;
        s->scale = 1;
        s->console.resolve_number = HL_NUMBER_SIGNED;
    }
    if (id == CF_BASE255 && remaps(cf)) {
        s->two16 = HL_TWO16_BYTES_ARGB;
        s->console = stores[CF_RGBA8_ARGB].console;
    }
}

const char *cf_store(struct cf *cf, enum cf_store_id id, struct cf_store *out)
{
    *out = stores[id];
    on_console(cf, id, out);
    enum hl_format f = out->format;
    enum hl_format g = out->sample_as ? out->sample_as : f;
    if (!cf_usable(cf, f, HL_USE_TARGET) || !cf_usable(cf, g, HL_USE_SAMPLED))
        return "this device has no such target";
    bool argb = out->two16 == HL_TWO16_BYTES_ARGB;
    if (argb && !remaps(cf))
        return "needs a machine that remaps big-endian words";
    if (!argb && g != f && cf->caps->console_memory &&
        cf->profile->big_endian)
        return "this machine's words are big-endian: bytes lie otherwise";
    by_profile(cf, out);
    return NULL;
}

bool cf_encode(struct cf *cf, const struct cf_store *s, uint32_t op,
               hl_vec4 a, hl_tex in, hl_tex target)
{
    struct cf_op o;
    memset(&o, 0, sizeof o);
    o.op = op;
    o.two16 = s->two16;
    o.a = a;
    o.c = hl_v4(s->scale, s->pack, 0, 0);
    o.in = in;
    o.target = target;
    return cf_draw(cf, &o);
}

bool cf_decode(struct cf *cf, const struct cf_store *s, uint32_t op,
               hl_tex in, hl_tex stored, hl_tex target)
{
    struct cf_op o;
    memset(&o, 0, sizeof o);
    o.op = op;
    o.two16 = s->two16;
    o.c = hl_v4(1.0f / s->scale, 0, 0, 0);
    o.in = in;
    o.stored = stored;
    o.target = target;
    return cf_draw(cf, &o) && cf_read(cf, target);
}

/* 1 + 3/4 of a step is 1 where a store truncates. */
bool cf_truncates(struct cf *cf, enum hl_format format)
{
    hl_tex in = { 0 }, t = { 0 };
    struct cf_op o;
    uint16_t code = 0;
    memset(&o, 0, sizeof o);
    for (int k = 0; k < 4; k++)
        cf->in[0][k] = 1.0f + 0.75f / 1024;
    o.a = hl_v4(1, 1, 1, 1);
    bool ok = cf_input(cf, &in, 1, 1) &&
              cf_tex(cf, &t, format, HL_FORMAT_NONE, NULL, 1, 1);
    o.in = in;
    o.target = t;
    if (ok && cf_draw(cf, &o) && cf_read(cf, t))
        memcpy(&code, cf->raw, sizeof code);
    cf_drop(cf, &in);
    cf_drop(cf, &t);
    return code == 0x3c00;
}

bool cf_make_all(struct cf *cf, const struct cf_store *store, uint32_t side,
                 hl_tex *in, hl_tex *stored, hl_tex *out)
{
    return cf_input(cf, in, side, side) &&
           cf_tex(cf, stored, store->format, store->sample_as,
                  &store->console, side, side) &&
           cf_tex(cf, out, HL_FORMAT_RGBA32_FLOAT, HL_FORMAT_NONE, NULL, side,
                  side);
}

void cf_drop_all(struct cf *cf, hl_tex *in, hl_tex *stored, hl_tex *out)
{
    cf_drop(cf, in);
    cf_drop(cf, stored);
    cf_drop(cf, out);
}
