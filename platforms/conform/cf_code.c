/* SPDX-License-Identifier: Zlib */
/* Codes: every number that a storage can hold, and every id that a profile
 * numbers regions with, through the machine and back. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { SIDE = 256, CODES = SIDE * SIDE };

struct bench {
    struct cf *cf;
    struct cf_store store;
    hl_tex in, stored, out;
};

static bool begin(struct bench *b, struct cf *cf)
{
    b->cf = cf;
    b->in.id = b->stored.id = b->out.id = 0;
    return cf_make_all(cf, &b->store, SIDE, &b->in, &b->stored, &b->out);
}

static void end(struct bench *b)
{
    cf_drop_all(b->cf, &b->in, &b->stored, &b->out);
}

static double apart(int32_t a, int32_t b) { return fabs((double)a - b); }

/* y runs through the codes in another order than x. */
static uint32_t second(uint32_t k, uint32_t n) { return k * 40503u % n; }

/* Code k of n steps as a number of 0..1, both channels. */
static void fill(struct cf *cf, double steps)
{
    uint32_t n = (uint32_t)steps + 1;
    memset(cf->in, 0, CODES * sizeof *cf->in);
    for (uint32_t k = 0; k < CODES; k++) {
        cf->in[k][0] = (float)((k % n) / steps);
        cf->in[k][1] = (float)(second(k % n, n) / steps);
    }
}

/* Number of a channel (0, 1) as it lies in a texel that was read back. */
static int32_t code_of(const struct cf_store *s, const uint8_t *texel, int c)
{
    uint16_t word;
    int16_t number;
    if (s->format == HL_FORMAT_RG8_UNORM)
        return texel[c];
    if (s->two16 == HL_TWO16_BYTES_ARGB)
        return c ? texel[3] << 8 | texel[0] : texel[1] << 8 | texel[2];
    if (s->two16 == HL_TWO16_BYTES)
        return texel[2 * c + 1] << 8 | texel[2 * c];
    if (s->two16 == HL_TWO16_UNORM &&
        s->console.resolve_number == HL_NUMBER_UNSIGNED) {
        memcpy(&word, texel + 2 * c, sizeof word);
        return word;
    }
    memcpy(&number, texel + 2 * c, sizeof number);
    return number;
}

static bool signed_codes(const struct cf_store *s)
{
    return s->two16 == HL_TWO16_SIGNED || s->two16 == HL_TWO16_FIXED32;
}

static void judge_stored(const struct bench *b, struct hl_conform_result *r)
{
    const struct cf_store *s = &b->store;
    uint32_t n = (uint32_t)s->steps + 1;
    uint32_t texel = hl_format_info(s->format)->bytes;
    int32_t zero = signed_codes(s) ? 32767 : 0;
    for (uint32_t k = 0; k < CODES; k++) {
        const uint8_t *t = b->cf->raw + (size_t)k * texel;
        int32_t x = (int32_t)(k % n), y = (int32_t)second(k % n, n);
        cf_case_at(r, apart(code_of(s, t, 0), x - zero), x, 0);
        cf_case_at(r, apart(code_of(s, t, 1), y - zero), y, 1);
    }
}

static void judge_read(const struct bench *b, struct hl_conform_result *r)
{
    uint32_t n = (uint32_t)b->store.steps + 1;
    for (uint32_t k = 0; k < CODES; k++) {
        double steps = b->store.steps;
        const float *o = b->cf->out[k];
        double x = floor((double)o[0] * steps + 0.5);
        double y = floor((double)o[1] * steps + 0.5);
        cf_case_at(r, fabs(x - k % n), k % n, 0);
        cf_case_at(r, fabs(y - second(k % n, n)), second(k % n, n), 1);
    }
}

const char *cf_code(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    struct hl_conform_result stored = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "k / steps is stored as code k (signed: k - 32767), all k");
    struct hl_conform_result read = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "what is read back rounds to k / steps, all k");
    const char *why = cf_store(cf, (enum cf_store_id)g->what, &b.store);
    if (why)
        return why;
    cf_spoil(cf, &b.store);
    fill(cf, b.store.steps);
    if (begin(&b, cf) &&
        cf_encode(cf, &b.store, HL_OP_PACK, hl_v4(0, 0, 0, 0), b.in,
                  b.stored) && cf_read(cf, b.stored)) {
        judge_stored(&b, &stored);
        if (cf_decode(cf, &b.store, HL_OP_UNPACK, b.in, b.stored, b.out))
            judge_read(&b, &read);
    }
    stored.where = read.where = "code, channel";
    stored.n_at = read.n_at = 2;
    end(&b);
    cf_report(cf, g, "stored", &stored);
    cf_report(cf, g, "read", &read);
    return NULL;
}

/* ---- ids ---------------------------------------------------------------- */

enum cf_store_id cf_profile_store(const struct cf *cf)
{
    for (int i = 0; i < HL_PROFILE_FORMATS; i++) {
        const struct hl_profile_format *p = &cf->profile->two16[i];
        if (p->format == HL_FORMAT_NONE)
            break;
        if ((p->on == HL_ON_CONSOLE && !cf->caps->console_memory) ||
            (p->on == HL_ON_STAND_IN && cf->caps->console_memory) ||
            !cf_usable(cf, p->format, HL_USE_TARGET))
            continue;
        switch (p->two16) {
        case HL_TWO16_SIGNED: return CF_RG16_SNORM;
        case HL_TWO16_FIXED32: return CF_RG16_FIXED32;
        case HL_TWO16_BYTES: return CF_RGBA8_BYTES;
        case HL_TWO16_BYTES_ARGB: return CF_RGBA8_ARGB;
        default: return CF_RG16_UNORM;
        }
    }
    return CF_RG16_UNORM;
}

const char *cf_ids(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    float steps = cf->profile->id_steps > 0 ? cf->profile->id_steps : 65535;
    uint32_t n = (uint32_t)steps + 1;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "ids", 0,
        "id / steps of the profile comes back as the id, and the filter "
        "accepts it, for all ids");
    const char *why = cf_store(cf, cf_profile_store(cf), &b.store);
    if (why)
        return why;
    if (cf->mutant == CF_MUTANT_ID_65535_ON_XBOX &&
        !strcmp(cf->profile_name, "xbox360"))
        steps = 65535;
    for (uint32_t k = 0; k < CODES; k++) {
        cf->in[k][0] = 50;
        cf->in[k][1] = (float)(k % n);
        cf->in[k][2] = cf->in[k][3] = 0;
    }
    if (begin(&b, cf) &&
        cf_encode(cf, &b.store, HL_OP_DEPTH_ENCODE,
                  hl_v4(0.01f, 1.0f / steps, 0, 0), b.in, b.stored)) {
        struct cf_op o;
        memset(&o, 0, sizeof o);
        o.op = HL_OP_DSF;
        o.two16 = b.store.two16;
        o.a = hl_v4(100, steps, 0, 0);
        o.b = hl_v4(0.01f, 0, 0, 0);
        o.c = hl_v4(1.0f / b.store.scale, 0, 0, 0);
        o.in = b.in;
        o.stored = b.stored;
        o.target = b.out;
        if (cf_draw(cf, &o) && cf_read(cf, b.out))
            for (uint32_t k = 0; k < CODES; k++) {
                const float *out = cf->out[k];
                bool same = out[0] == 1.0f && out[3] == cf->in[k][1];
                r.cases++;
                r.worst += same ? 0 : 1;
                if (!same)
                    r.at[0] = k;
            }
    }
    end(&b);
    r.where = "last wrong id";
    r.n_at = r.worst > 0;
    cf_report(cf, g, "all", &r);
    return NULL;
}

/* ---- the Xbox 360's ladder of codes (spec/consoles 1.5) ------------------ */

static const struct cf_store ladder[3] = {
    { .format = HL_FORMAT_RG16_FIXED32, .scale = 1 },
    { .format = HL_FORMAT_RG16_FIXED32, .scale = 32,
      .console = { .resolve_exp_bias = -5 } },
    { .format = HL_FORMAT_RG16_FIXED32, .scale = 1,
      .two16 = HL_TWO16_FIXED32,
      .console = { .resolve_exp_bias = -5,
                   .resolve_number = HL_NUMBER_SIGNED } },
};

/* k / 65535 for all k, and how many codes they become. */
static void count_codes(struct cf *cf, const struct cf_group *g, int step)
{
    static const char *const name[] = { "plain", "scaled", "full" };
    static const double want[] = { 1025, 32768, 65535 };
    static const char *const why[] = {
        "0..1 as it is leaves 1,025 codes",
        "32 times, resolved by 2^-5 to unsigned, leaves 32,768",
        "-32..32, resolved by 2^-5 to signed, leaves 65,535" };
    struct hl_conform_result r =
        cf_result(HL_CONFORM_EXACT, "codes", 0, why[step]);
    struct bench b;
    uint8_t *seen = (uint8_t *)cf->out;
    uint32_t n = 0;
    b.store = ladder[step];
    fill(cf, 65535);
    if (begin(&b, cf) &&
        cf_encode(cf, &b.store, HL_OP_PACK, hl_v4(0, 0, 0, 0), b.in,
                  b.stored) && cf_read(cf, b.stored)) {
        memset(seen, 0, 65536);
        for (uint32_t k = 0; k < CODES; k++) {
            uint16_t code;
            memcpy(&code, cf->raw + 4 * (size_t)k, sizeof code);
            n += !seen[code];
            seen[code] = 1;
        }
        cf_case(&r, fabs(n - want[step]));
        r.cases = CODES;
    }
    end(&b);
    r.table = want[step];
    r.where = "codes";
    r.at[0] = n;
    r.n_at = 1;
    cf_report(cf, g, name[step], &r);
}

/* Every number of the EDRAM is the same number in memory. */
static void identity(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "the resolve keeps every code of -32767..32767");
    struct bench b;
    struct cf_op o;
    memset(&o, 0, sizeof o);
    b.store = ladder[2];
    memset(cf->in, 0, CODES * sizeof *cf->in);
    for (int32_t k = 0; k < CODES; k++)
        cf->in[k][0] = cf_fixed32_decode(k > 65534 ? 0 : k - 32767);
    if (begin(&b, cf)) {
        o.a = hl_v4(1, 1, 1, 1);
        o.in = b.in;
        o.target = b.stored;
        if (cf_draw(cf, &o) && cf_read(cf, b.stored))
            for (int32_t k = 0; k < 65535; k++) {
                int16_t code;
                memcpy(&code, cf->raw + 4 * (size_t)k, sizeof code);
                cf_case_at(&r, apart(code, k - 32767), k - 32767, 0);
            }
    }
    end(&b);
    r.where = "code";
    r.n_at = 1;
    cf_report(cf, g, "identity", &r);
}

/* Ids over `steps` through the trick; the pictures stay in raw and out. */
static bool run_ids(struct cf *cf, struct bench *b, double steps)
{
    b->store = ladder[2];
    fill(cf, steps);
    return begin(b, cf) &&
           cf_encode(cf, &b->store, HL_OP_PACK, hl_v4(0, 0, 0, 0), b->in,
                     b->stored) && cf_read(cf, b->stored) &&
           cf_decode(cf, &b->store, HL_OP_UNPACK, b->in, b->stored, b->out);
}

/* The traps of id / 65535: one pair of ids has one code, and 65 ids of
 * 32672..32767 come back one too high. */
static void ids_of_65535(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result pair = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "ids 32767 and 32768 of 65535 collide, and no others");
    struct hl_conform_result wrong = cf_result(
        HL_CONFORM_EXACT, "ids", 0,
        "65 ids come back wrong, all of 32672..32767, all one too high");
    struct bench b;
    if (run_ids(cf, &b, 65535)) {
        int16_t code[2] = { 0, 0 };
        uint32_t same = 0, bad = 0, far = 0;
        for (uint32_t k = 0; k < CODES; k++) {
            float x = floorf(cf->out[k][0] * 65535.0f + 0.5f);
            memcpy(&code[1], cf->raw + 4 * (size_t)k, 2);
            same += k && code[1] == code[0] && k != 32768;
            pair.worst += k == 32768 && code[1] != code[0];
            code[0] = code[1];
            bad += x != (float)k;
            far += x != (float)k &&
                   (k < 32672 || k > 32767 || x != (float)k + 1);
        }
        pair.worst += same;
        pair.cases = wrong.cases = CODES;
        wrong.worst = fabs(bad - 65.0) + far;
        wrong.at[0] = bad;
    }
    end(&b);
    wrong.where = "wrong ids";
    wrong.n_at = 1;
    wrong.table = 65;
    cf_report(cf, g, "id_65535_collides", &pair);
    cf_report(cf, g, "id_65535_wrong", &wrong);
}

static void ids_of_65534(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "ids", 0,
        "id / 65534 is exact for ids 0..65534, in single precision");
    struct bench b;
    if (run_ids(cf, &b, 65534))
        for (uint32_t k = 0; k < 65535; k++) {
            float x = floorf(cf->out[k][0] * 65534.0f + 0.5f);
            cf_case_at(&r, fabs((double)x - k), k, 0);
        }
    end(&b);
    r.where = "id";
    r.n_at = 1;
    cf_report(cf, g, "id_65534_exact", &r);
}

/* The table of 1.5: value, code, bytes as the big-endian processor reads
 * them, value sampled. */
static void table(struct cf *cf, const struct cf_group *g)
{
    static const struct { float v; int32_t code; double read; } rows[] = {
        { 0, -32767, 0 }, { 0.1f, -26214, 0.09999388456 },
        { 0.25f, -16384, 0.24999237061 }, { 0.5f, 0, 0.5 },
        { 0.75f, 16384, 0.75000762939 }, { 1, 32767, 1 } };
    enum { N = sizeof rows / sizeof rows[0] };
    struct hl_conform_result code = cf_result(
        HL_CONFORM_EXACT, "codes", 0, "the six rows of the trick's table");
    struct hl_conform_result read = cf_result(
        HL_CONFORM_TOLERANCE, "", 1e-7,
        "sampled i / 65534 + 1 / 2: one rounding to single precision");
    struct hl_conform_result bytes = cf_result(
        HL_CONFORM_EXACT, "bytes", 0,
        "memory of big-endian halfwords, swap 8 in 16");
    struct bench b;
    b.store = ladder[2];
    b.store.console.endian = HL_ENDIAN_8IN16;
    memset(cf->in, 0, CODES * sizeof *cf->in);
    for (int i = 0; i < N; i++)
        cf->in[i][0] = cf->in[i][1] = rows[i].v;
    size_t size = 0;
    if (begin(&b, cf) &&
        cf_encode(cf, &b.store, HL_OP_PACK, hl_v4(0, 0, 0, 0), b.in,
                  b.stored) && cf_read(cf, b.stored) &&
        cf_decode(cf, &b.store, HL_OP_UNPACK, b.in, b.stored, b.out)) {
        const uint8_t *m = cf->desc->memory
                           ? cf->desc->memory(cf->device, b.stored, &size)
                           : NULL;
        for (int i = 0; i < N; i++) {
            int16_t c;
            memcpy(&c, cf->raw + 4 * (size_t)i, sizeof c);
            cf_case_at(&code, apart(c, rows[i].code), (double)rows[i].v, 0);
            cf_case_at(&read, fabs((double)cf->out[i][0] - rows[i].read),
                       (double)rows[i].v, 0);
            int32_t hi = rows[i].code >> 8 & 255, lo = rows[i].code & 255;
            for (int k = 0; m && k < 4; k++)
                cf_case_at(&bytes, apart(m[4 * i + k], k & 1 ? lo : hi),
                           (double)rows[i].v, k);
        }
    }
    end(&b);
    code.where = read.where = bytes.where = "v";
    code.n_at = read.n_at = bytes.n_at = 1;
    if (!cf->desc->memory) {
        bytes.status = HL_CONFORM_SKIP;
        bytes.why = "the machine's memory cannot be seen from here";
    }
    cf_report(cf, g, "table_codes", &code);
    cf_report(cf, g, "table_read", &read);
    cf_report(cf, g, "table_bytes", &bytes);
}

const char *cf_ladder(struct cf *cf, const struct cf_group *g)
{
    if (!cf_usable(cf, HL_FORMAT_RG16_FIXED32, HL_USE_TARGET) ||
        !cf->caps->console_memory)
        return "needs the fixed point of -32..32 and its resolve";
    for (int i = 0; i < 3; i++)
        count_codes(cf, g, i);
    identity(cf, g);
    table(cf, g);
    ids_of_65535(cf, g);
    ids_of_65534(cf, g);
    return NULL;
}
