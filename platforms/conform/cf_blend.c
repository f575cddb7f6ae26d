/* SPDX-License-Identifier: Zlib */
/* Additive blending in each format that light or colour is summed in
 * (spec/conformance b3). */
#include <string.h>
#include "platforms/conform/cf.h"

enum { WIDTH = 32, HEIGHT = 4, SUMS = WIDTH * HEIGHT, LONG = CF_STAIRS };

struct format {
    enum hl_format format;
    int channels;
    const struct cf_float *real[4];    /* NULL: fixed point                  */
    double lsb, top;                   /* fixed point: step, largest number  */
    int largest;                       /* code of top                        */
    struct hl_console console;
};
static const struct format formats[] = {
    { .format = HL_FORMAT_RGBA16_FLOAT, .channels = 4,
      .real = { &cf_half, &cf_half, &cf_half, &cf_half } },
    { .format = HL_FORMAT_RG11B10_FLOAT, .channels = 3,
      .real = { &cf_float11, &cf_float11, &cf_float10 } },
    { .format = HL_FORMAT_RGBA8_UNORM, .channels = 4, .lsb = 1 / 255.0,
      .top = 1, .largest = 255 },
    { .format = HL_FORMAT_RGBA16_UNORM, .channels = 4, .lsb = 1 / 65535.0,
      .top = 1, .largest = 65535 },
    { .format = HL_FORMAT_RGBA16_FIXED32, .channels = 4,
      .lsb = 32 / 32767.0, .top = 32, .largest = 32767,
      .console = { .resolve_exp_bias = -5,
                   .resolve_number = HL_NUMBER_SIGNED } },
    { .format = HL_FORMAT_RGB10A2_FLOAT, .channels = 3,
      .real = { &cf_7e3, &cf_7e3, &cf_7e3 } },
};

struct bench {
    struct cf *cf;
    const struct cf_group *group;
    const struct format *f;
    hl_tex in, target;
    bool real;
    enum cf_round store, blend;
};

/* ---- texels ------------------------------------------------------------- */

static double small_float(uint32_t code, int bits)
{
    int m = bits - 1, e = (int)(code >> m) & 31;
    double f = (double)(code & ((1u << m) - 1));
    double one = ldexp(1, m);
    return e == 31 ? (f > 0 ? (double)NAN : (double)INFINITY)
           : e ? ldexp(one + f, e - 15 - m) : ldexp(f, -14 - m);
}

static uint32_t field(const struct format *f, const uint8_t *t, int c)
{
    uint32_t word;
    uint16_t half;
    if (hl_format_info(f->format)->bytes == 8) {
        memcpy(&half, t + 2 * c, sizeof half);
        return half;
    }
    memcpy(&word, t, sizeof word);
    switch (f->format) {
    case HL_FORMAT_RG11B10_FLOAT:
        return c < 2 ? word >> 11 * c & 2047 : word >> 22;
    case HL_FORMAT_RGB10A2_FLOAT: return word >> 10 * c & 1023;
    default: return t[c];
    }
}

static double value_of(const struct format *f, uint32_t i,
                       const uint8_t *raw, int c)
{
    uint32_t code = field(f, raw + (size_t)i *
                          hl_format_info(f->format)->bytes, c);
    switch (f->format) {
    case HL_FORMAT_RGBA16_FLOAT: return cf_half_value((uint16_t)code);
    case HL_FORMAT_RG11B10_FLOAT: return small_float(code, c < 2 ? 7 : 6);
    case HL_FORMAT_RGB10A2_FLOAT: return (double)cf_7e3_value(code);
    case HL_FORMAT_RGBA16_FIXED32: return (int16_t)code * f->lsb;
    default: return code * f->lsb;
    }
}

static double store(const struct format *f, int c, double x, enum cf_round r)
{
    if (f->real[c])
        return cf_float_store(f->real[c], x, r);
    x = x > f->top ? f->top : x;
    return cf_whole(x / f->lsb, r) * f->lsb;
}

/* Step above x, 1 or more in floats. */
static double step_at(const struct format *f, int c)
{
    return f->real[c] ? ldexp(1, 1 - f->real[c]->bits) : f->lsb;
}

static bool fresh(struct bench *b, uint32_t w, uint32_t h)
{
    cf_drop(b->cf, &b->target);
    return cf_tex(b->cf, &b->target, b->f->format, HL_FORMAT_NONE,
                  &b->f->console, w, h);
}

/* n layers, or in stairs, x + 1 of them at column x. */
static bool add(struct bench *b, uint32_t n, float scale, bool stairs,
                bool backwards)
{
    struct cf_op o;
    memset(&o, 0, sizeof o);
    o.a = hl_v4(scale, scale, scale, scale);
    o.in = b->in;
    o.target = b->target;
    o.blend = HL_BLEND_ADD;
    o.layers = n;
    o.stairs = stairs;
    o.backwards = backwards;
    o.step_x = 37;                   /* odd: 512 texels before a repetition  */
    o.step_y = 101;
    return cf_draw(b->cf, &o);
}

/* ---- A1: rounding -------------------------------------------------------- */

static const char *const round_name[] = {
    "truncates", "rounds to nearest, ties to even",
    "rounds to nearest, ties up" };

/* Bases 1, 1 + step, ... and the fraction of a step above. */
enum { BASES = 8, FRACTIONS = 3 };
static const double fraction[FRACTIONS] = { 0.25, 0.5, 0.75 };

static double probe_base(const struct format *f, int c, uint32_t i)
{
    return (f->real[c] ? 1 : 40 * f->lsb) + i / FRACTIONS * step_at(f, c);
}

/* Of the models that fit all probes, the first; -1: none does. Ties of fixed
 * point lie between two floats, and are not asked. */
static int fitting(const struct bench *b)
{
    const struct format *f = b->f;
    for (int r = CF_TRUNCATE; r <= CF_NEAREST_UP; r++) {
        bool fits = true;
        for (uint32_t i = 0; i < BASES * FRACTIONS; i++)
            for (int c = 0; c < f->channels; c++) {
                double base = probe_base(f, c, i), step = step_at(f, c);
                double x = base + fraction[i % FRACTIONS] * step;
                double want = store(f, c, x, (enum cf_round)r);
                double got = value_of(f, i, b->cf->raw, c);
                if (f->real[c] || i % FRACTIONS != 1)
                    fits = fits && fabs(got - want) < 0.01 * step;
            }
        if (fits)
            return r;
    }
    return -1;
}

static const char *rounding_note(const struct format *f, int r)
{
    if (r < 0)
        return "fits no rounding";
    return r == CF_TRUNCATE || f->real[0] ? round_name[r]
                                          : "rounds to nearest";
}

static void rounding(struct bench *b)
{
    struct cf *cf = b->cf;
    const struct format *f = b->f;
    struct hl_conform_result stored = cf_result(
        HL_CONFORM_INTERVAL, "", 0, "the same rounding for every store: "
        "truncation, or to nearest with ties to even or up");
    struct hl_conform_result blended = stored;
    blended.why = "the same rounding for every blend";
    struct cf_op o;
    memset(&o, 0, sizeof o);
    memset(cf->in, 0, CF_PIXELS * sizeof *cf->in);
    for (uint32_t i = 0; i < BASES * FRACTIONS; i++)
        for (int c = 0; c < f->channels; c++) {
            double part = fraction[i % FRACTIONS] * step_at(f, c);
            cf->in[i][c] = (float)(probe_base(f, c, i) + part);
            cf->in[CF_SIDE + i][c] = (float)probe_base(f, c, i);
            cf->in[2 * CF_SIDE + i][c] = (float)part;
        }
    o.a = hl_v4(1, 1, 1, 1);
    if (cf_write(cf, b->in, cf->in) && fresh(b, BASES * FRACTIONS, 1)) {
        o.in = b->in;
        o.target = b->target;
        if (cf_draw(cf, &o) && cf_read(cf, b->target)) {
            int r = fitting(b);
            cf_case(&stored, r < 0 ? 1 : 0);
            b->store = r < 0 ? CF_NEAREST_EVEN : (enum cf_round)r;
            stored.note = rounding_note(f, r);
        }
        /* Input rows 1 and 2, the second blended. */
        o.step_y = 1;
        o.layers = 3;
        o.blend = HL_BLEND_ADD;
        o.a = hl_v4(1, 1, 1, 1);
        for (uint32_t i = 0; i < CF_SIDE; i++)
            memset(cf->in[i], 0, sizeof cf->in[i]);
        if (cf_write(cf, b->in, cf->in) && cf_draw(cf, &o) &&
            cf_read(cf, b->target)) {
            int r = fitting(b);
            cf_case(&blended, r < 0 ? 1 : 0);
            b->blend = r < 0 ? CF_NEAREST_EVEN : (enum cf_round)r;
            blended.note = rounding_note(f, r);
        }
    }
    stored.cases *= BASES * FRACTIONS;
    blended.cases *= BASES * FRACTIONS;
    cf_report(cf, b->group, "store_rounding", &stored);
    cf_report(cf, b->group, "blend_rounding", &blended);
}

/* ---- A2: N random lights ------------------------------------------------- */

/* Largest relative error that b3 found of a rounding RGBA16F; 0: not given. */
static const struct { uint32_t n; const char *name; double half; }
counts[] = {
    { 1, "sum_1", 0 }, { 4, "sum_4", 0 }, { 8, "sum_8", 0 },
    { 16, "sum_16", 0 }, { 32, "sum_32", .0023 }, { 64, "sum_64", 0 },
    { 81, "sum_81", .0040 }, { 122, "sum_122", .0051 },
    { 213, "sum_213", .0065 }, { 255, "sum_255", 0 },
    { 287, "sum_287", .0071 }, { 512, "sum_512", 0 },
    { 1000, "sum_1000", .0127 }, { 2048, "sum_2048", 0 },
    { 4096, "sum_4096", .032 } };
enum { COUNTS = sizeof counts / sizeof counts[0] };

static const float *light(const struct bench *b, uint32_t i, uint32_t k)
{
    uint32_t x = (i % WIDTH + k * 37) % CF_SIDE;
    uint32_t y = (i / WIDTH + k * 101) % CF_SIDE;
    return b->cf->in[y * CF_SIDE + x];
}

/* Factor of lights of 0..1: fixed point and small floats have a largest
 * number, of which the sum is half. */
static float light_scale(const struct format *f, uint32_t n)
{
    double top = f->real[0] ? f->real[0]->max : f->top;
    return n > top || !f->real[0] ? (float)(top / n) : 1.0f;
}

/* The sum, and the bound of what is stored for it: each add is off by a step
 * of its partial sum at most, each source by a step of its own. Floats below
 * their normal range have the step of its bottom. */
static double sum_of(const struct bench *b, uint32_t i, int c, uint32_t n,
                     float scale, double *bound)
{
    const struct cf_float *real = b->f->real[c];
    double s = 0, u = real ? ldexp(1, 1 - real->bits) : 0;
    *bound = 0;
    for (uint32_t k = 0; k < n; k++) {
        double v = (double)(light(b, i, k)[c] * scale);
        s += v;
        if (real)
            *bound += u * (s + v) + ldexp(u, real->min_exp);
        else
            *bound += b->blend == CF_TRUNCATE ? b->f->lsb : b->f->lsb / 2;
    }
    /* Sources and sums are single precision before they are stored. */
    *bound += ldexp(s * n, -24);
    return s;
}

static void sum(struct bench *b, int which, const char *name)
{
    struct cf *cf = b->cf;
    uint32_t n = counts[which].n;
    float scale = light_scale(b->f, n);
    struct hl_conform_result r = cf_result(
        HL_CONFORM_TOLERANCE, "relative", 0,
        b->real ? "u (sum of all partial sums + all lights), u = a step of "
                  "the significand" : "half a step a light, a step where "
                                      "blending truncates");
    double mean = 0, tightest = 1;
    if (fresh(b, WIDTH, HEIGHT) &&
        add(b, n, scale, false, false) &&
        cf_read(cf, b->target))
        for (uint32_t i = 0; i < SUMS; i++)
            for (int c = 0; c < b->f->channels; c++) {
                double bound, s = sum_of(b, i, c, n, scale, &bound);
                double got = value_of(b->f, i, cf->raw, c), e = got - s;
                if (!(s > 0))
                    continue;
                if (fabs(e) / bound > tightest)
                    tightest = fabs(e) / bound;
                r.limit = fmax(r.limit, bound / s);
                cf_case_at(&r, fabs(e) / s, n, 0);
                mean += e / s;
            }
    /* One sum past its own bound fails, wherever the worst lies. */
    if (tightest > 1)
        r.limit = 0;
    if (b->f->real[0] == &cf_half && b->blend != CF_TRUNCATE &&
        counts[which].half > 0)
        r.table = counts[which].half;
    r.at[1] = r.cases ? mean / (double)r.cases : 0;
    r.where = "lights, mean error";
    r.n_at = 2;
    cf_report(cf, b->group, name, &r);
}

static void sums(struct bench *b)
{
    struct cf *cf = b->cf;
    for (uint32_t i = 0; i < CF_PIXELS; i++)
        for (int c = 0; c < 4; c++)
            cf->in[i][c] = (float)cf_unit(cf);
    if (cf_write(cf, b->in, cf->in))
        for (int i = 0; i < COUNTS; i++)
            sum(b, i, counts[i].name);
}

/* ---- A3: stalls ---------------------------------------------------------- */

/* Does column x hold x + 1 adds of v, by one of the models? */
static bool follows(const struct bench *b, int c, float v, enum cf_round r,
                    bool source_first)
{
    const struct format *f = b->f;
    double s = 0, w = (double)v;
    if (source_first)
        w = store(f, c, w, r);
    for (uint32_t x = 0; x < LONG; x++) {
        s = store(f, c, (double)(float)(s + w), r);
        if (value_of(f, x, b->cf->raw, c) != s)
            return false;
    }
    return true;
}

static uint32_t stalls_at(const struct bench *b, int c)
{
    for (uint32_t x = 1; x < LONG; x++)
        if (value_of(b->f, x, b->cf->raw, c) ==
            value_of(b->f, x - 1, b->cf->raw, c))
            return x;
    return LONG;
}

static void stall(struct bench *b)
{
    static const float v[2][4] = { { 1, 0.1f, 0.7f, 0.01f },
                                   { 0.25f, 0.1f, 0.07f, 0.01f } };
    struct cf *cf = b->cf;
    const float *add_v = v[b->f->format == HL_FORMAT_RGB10A2_FLOAT];
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "sums", 0,
        "3,072 equal adds, each sum as the model of the probed rounding has "
        "it (of the source too, or of the sum alone)");
    if (fresh(b, LONG, 1)) {
        memset(cf->in, 0, CF_PIXELS * sizeof *cf->in);
        for (uint32_t i = 0; i < CF_PIXELS; i++)
            memcpy(cf->in[i], add_v, 4 * sizeof *add_v);
        if (cf_write(cf, b->in, cf->in) &&
            add(b, LONG, 1, true, false) &&
            cf_read(cf, b->target))
            for (int c = 0; c < b->f->channels; c++) {
                bool ok = follows(b, c, add_v[c], b->blend, false) ||
                          follows(b, c, add_v[c], b->blend, true);
                cf_case(&r, ok ? 0 : 1);
                r.cases += LONG - 1;
                if (c < 3)
                    r.at[c] = stalls_at(b, c);
            }
    }
    r.where = b->f->format == HL_FORMAT_RGB10A2_FLOAT
              ? "adds before stall of 0.25, 0.1, 0.07"
              : "adds before stall of 1, 0.1, 0.7";
    r.n_at = 3;
    cf_report(cf, b->group, "stall", &r);
}

/* ---- A4: saturation, vanishing lights ------------------------------------ */

static void saturate(struct bench *b)
{
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "sums past the largest number are it, and stay it");
    float v = (float)(b->f->top * 0.3);
    if (fresh(b, LONG, 1)) {
        for (uint32_t i = 0; i < CF_PIXELS; i++)
            for (int c = 0; c < 4; c++)
                cf->in[i][c] = v;
        if (cf_write(cf, b->in, cf->in) &&
            add(b, 64, 1, true, false) &&
            cf_read(cf, b->target))
            for (uint32_t x = 3; x < LONG; x++)
                for (int c = 0; c < 4; c++)
                    cf_case_at(&r, fabs((double)field(b->f, cf->raw +
                               x * hl_format_info(b->f->format)->bytes, c) -
                               b->f->largest), x, 0);
    }
    r.where = "adds";
    r.n_at = 1;
    cf_report(cf, b->group, "saturate", &r);
}

/* 255 lights under half a step store nothing; a little over it, the top. */
static void vanish(struct bench *b)
{
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "codes", 0,
        "255 lights of 0.0019 store 0, of 0.0020 store 1 (0 where blending "
        "truncates)");
    const float v[4] = { 0.0019f, 0.0020f, 0.0019f, 0.0020f };
    for (uint32_t i = 0; i < CF_PIXELS; i++)
        memcpy(cf->in[i], v, sizeof v);
    if (fresh(b, WIDTH, HEIGHT) && cf_write(cf, b->in, cf->in) &&
        add(b, 255, 1, false, false) &&
        cf_read(cf, b->target))
        for (uint32_t i = 0; i < SUMS * 4; i++) {
            double want = b->blend == CF_TRUNCATE || i % 2 == 0 ? 0 : 255;
            cf_case(&r, fabs(cf->raw[i] - want));
        }
    cf_report(cf, b->group, "vanish", &r);
}

/* ---- A5, A6, A7 ---------------------------------------------------------- */

static void order(struct bench *b)
{
    enum { N = 122 };
    struct cf *cf = b->cf;
    const struct format *f = b->f;
    float s = light_scale(f, N);
    size_t bytes = (size_t)SUMS * hl_format_info(f->format)->bytes;
    uint8_t *first = (uint8_t *)cf->out;
    struct hl_conform_result turned = cf_result(
        HL_CONFORM_TOLERANCE, "of the bound", 2,
        "122 lights backwards: each order is within its bound");
    struct hl_conform_result again = cf_result(
        HL_CONFORM_EXACT, "bytes", 0, "the same order gives the same bytes");
    for (uint32_t i = 0; i < CF_PIXELS; i++)
        for (int c = 0; c < 4; c++)
            cf->in[i][c] = (float)cf_unit(cf);
    if (cf_write(cf, b->in, cf->in) && fresh(b, WIDTH, HEIGHT) &&
        add(b, N, s, false, false) && cf_read(cf, b->target)) {
        memcpy(first, cf->raw, bytes);
        if (add(b, N, s, false, false) && cf_read(cf, b->target)) {
            again.cases = bytes;
            again.worst = memcmp(first, cf->raw, bytes) != 0;
        }
        if (add(b, N, s, false, true) && cf_read(cf, b->target))
            for (uint32_t i = 0; i < SUMS; i++)
                for (int c = 0; c < f->channels; c++) {
                    double bound;
                    sum_of(b, i, c, N, s, &bound);
                    cf_case(&turned, fabs(value_of(f, i, cf->raw, c) -
                                          value_of(f, i, first, c)) / bound);
                }
    }
    cf_report(cf, b->group, "order", &turned);
    cf_report(cf, b->group, "repeat", &again);
}

static void overflow(struct bench *b)
{
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_INTERVAL, "sums", 0,
        "a sum past the largest number is it or infinity, never NaN or less");
    memset(cf->in, 0, CF_PIXELS * sizeof *cf->in);
    for (uint32_t i = 0; i < CF_PIXELS; i++)
        for (int c = 0; c < b->f->channels; c++)
            cf->in[i][c] = (float)(b->f->real[c]->max * 0.9);
    if (fresh(b, WIDTH, HEIGHT) && cf_write(cf, b->in, cf->in) &&
        add(b, 3, 1, false, false) &&
        cf_read(cf, b->target))
        for (uint32_t i = 0; i < SUMS; i++)
            for (int c = 0; c < b->f->channels; c++) {
                double x = value_of(b->f, i, cf->raw, c);
                r.at[0] = x;
                cf_case(&r, x >= b->f->real[c]->max ? 0 : 1);
            }
    r.where = "stored";
    r.n_at = 1;
    cf_report(cf, b->group, "overflow", &r);
}

/* Mean relative error of n lights a pixel, K of them summed in single
 * precision before each blend; the lights are in cf->out. */
static double batch_error(struct bench *b, uint32_t n, uint32_t batch)
{
    struct cf *cf = b->cf;
    const struct format *f = b->f;
    double mean = 0;
    struct cf_op o;
    memset(&o, 0, sizeof o);
    for (uint32_t i = 0; i < SUMS; i++)
        for (uint32_t k = 0; k < n / batch; k++) {
            /* Each pixel has a row of its own: 4 rows a layer. */
            float *to = cf->in[(i / WIDTH + HEIGHT * k) * CF_SIDE +
                               i % WIDTH];
            memset(to, 0, sizeof cf->in[0]);
            for (uint32_t j = 0; j < batch; j++)
                for (int c = 0; c < f->channels; c++)
                    to[c] += cf->out[i * n + k * batch + j][c];
        }
    o.a = hl_v4(1, 1, 1, 1);
    o.in = b->in;
    o.blend = HL_BLEND_ADD;
    o.layers = n / batch;
    o.step_y = HEIGHT;
    if (!cf_write(cf, b->in, cf->in) || !fresh(b, WIDTH, HEIGHT))
        return (double)NAN;
    o.target = b->target;
    if (!cf_draw(cf, &o) || !cf_read(cf, b->target))
        return (double)NAN;
    for (uint32_t i = 0; i < SUMS; i++)
        for (int c = 0; c < f->channels; c++) {
            double sum = 0;
            for (uint32_t k = 0; k < n; k++)
                sum += (double)cf->out[i * n + k][c];
            mean += value_of(f, i, cf->raw, c) / sum - 1;
        }
    return mean / (SUMS * f->channels);
}

static void batches(struct bench *b)
{
    struct cf *cf = b->cf;
    struct hl_conform_result r = cf_result(
        HL_CONFORM_TOLERANCE, "relative", 0.3,
        "K lights a blend divide the bias of a truncating blender by K: "
        "error x K against K = 1, whose partial sums are fewer; with "
        "rounding the mean error over a step of the sum");
    /* Few enough that short significands do not stall. */
    uint32_t n = b->f->real[0]->bits > 8 ? 96 : 16;
    uint32_t most = n == 96 ? 16 : 4;
    double step = step_at(b->f, 0);
    for (uint32_t i = 0; i < SUMS * n; i++)
        for (int c = 0; c < 4; c++)
            cf->out[i][c] = (float)cf_unit(cf);
    double one = batch_error(b, n, 1);
    for (uint32_t k = 2; k <= most && !cf->broken; k *= 2) {
        double e = batch_error(b, n, k);
        cf_case_at(&r, b->blend == CF_TRUNCATE ? fabs(e * k / one - 1)
                                               : fabs(e) / step, k, e);
    }
    r.where = "K, error, error of K = 1";
    r.at[2] = one;
    r.n_at = 3;
    cf_report(cf, b->group, "batch", &r);
}

/* ---- the group ----------------------------------------------------------- */

const char *cf_blend(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    memset(&b, 0, sizeof b);
    b.cf = cf;
    b.group = g;
    b.f = &formats[g->what];
    b.real = b.f->real[0] != NULL;
    if (!cf_usable(cf, b.f->format, HL_USE_TARGET | HL_USE_BLEND))
        return "this device does not blend the format";
    if (cf_input(cf, &b.in, CF_SIDE, CF_SIDE)) {
        rounding(&b);
        sums(&b);
        order(&b);
        if (b.real) {
            stall(&b);
            overflow(&b);
            batches(&b);
        } else {
            saturate(&b);
        }
        if (b.f->format == HL_FORMAT_RGBA8_UNORM)
            vanish(&b);
    }
    cf_drop(cf, &b.in);
    cf_drop(cf, &b.target);
    return NULL;
}
