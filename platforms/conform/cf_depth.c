/* SPDX-License-Identifier: Zlib */
/* Linear depth in each storage (spec/conformance b2): half a step at most. */
#include <string.h>
#include "platforms/conform/cf.h"

enum { SIDE = 256, N = SIDE * SIDE, FARS = 4 };
static const double fars[FARS] = { 100, 500, 1000, 5000 };
static const char *const names[FARS] = { "far_100", "far_500", "far_1000",
                                         "far_5000" };

/* b2's table, metres; half floats where the store rounds. */
static const double tables[CF_DEPTHS][FARS] = {
    [CF_DEPTH_UNORM16] = { 0.00076, 0.0038, 0.0076, 0.038 },
    [CF_DEPTH_BYTES] = { 0.00076, 0.0038, 0.0076, 0.038 },
    [CF_DEPTH_ARGB] = { 0.00076, 0.0038, 0.0076, 0.038 },
    [CF_DEPTH_SIGNED] = { 0.00076, 0.0038, 0.0076, 0.038 },
    [CF_DEPTH_FIXED32] = { 0.00076, 0.0038, 0.0076, 0.038 },
    [CF_DEPTH_SNORM] = { 0.0015, 0.0076, 0.0153, 0.076 },
    [CF_DEPTH_UNSCALED] = { 0.049, 0.244, 0.488, 2.44 },
    [CF_DEPTH_HALF] = { 0.024, 0.122, 0.244, 1.22 },
    [CF_DEPTH_HALF_METRES] = { 0.031, 0.125, 0.250, 2.00 },
    [CF_DEPTH_UNORM8] = { 0.196, 0.98, 1.96, 9.8 },
};
static const enum cf_store_id store_of[CF_DEPTHS] = {
    [CF_DEPTH_UNORM16] = CF_RG16_UNORM, [CF_DEPTH_BYTES] = CF_RGBA8_BYTES,
    [CF_DEPTH_ARGB] = CF_RGBA8_ARGB, [CF_DEPTH_SIGNED] = CF_RG16_SNORM,
    [CF_DEPTH_FIXED32] = CF_RG16_FIXED32, [CF_DEPTH_SNORM] = CF_RG16_SNORM,
    [CF_DEPTH_UNSCALED] = CF_UNSCALED, [CF_DEPTH_HALF] = CF_RG16_FLOAT,
    [CF_DEPTH_HALF_METRES] = CF_RG16_FLOAT, [CF_DEPTH_UNORM8] = CF_RG8_UNORM,
};

struct bench {
    struct cf *cf;
    enum cf_depth_id id;
    struct cf_store store;
    double half_step;            /* of z / far                               */
    bool truncates;
    hl_tex in, stored, out;
};

static const char *choose(struct bench *b)
{
    const char *why = cf_store(b->cf, store_of[b->id], &b->store);
    if (why)
        return why;
    b->half_step = 0.5 / b->store.steps;
    /* 0..1 as it is: the half above 0 alone. */
    if (b->id == CF_DEPTH_SNORM || b->id == CF_DEPTH_UNSCALED) {
        b->store.two16 = HL_TWO16_UNORM;
        b->half_step *= 2;
    }
    if (b->store.floats) {
        b->truncates = cf_truncates(b->cf, b->store.format);
        b->store.two16 = HL_TWO16_UNORM;
        b->half_step = ldexp(1, b->truncates ? -11 : -12);
    }
    cf_spoil(b->cf, &b->store);
    return NULL;
}

/* Metres in a half float: half of the step below far, whole if truncated. */
static double metres_step(const struct bench *b, double far)
{
    int e;
    double m = frexp(far, &e);
    if (m == 0.5)
        e--;                     /* far itself begins the next binade        */
    return ldexp(1, e - 12 + (b->truncates ? 1 : 0));
}

static bool picture(struct bench *b, double far)
{
    struct cf *cf = b->cf;
    bool metres = b->id == CF_DEPTH_HALF_METRES;
    float inv = metres ? 1.0f / 65504 : (float)(1 / far);
    struct cf_op o;
    memset(&o, 0, sizeof o);
    o.a = hl_v4(1, 1, 1, 1);
    o.in = b->in;
    o.target = b->stored;
    for (uint32_t i = 0; i < N; i++) {
        double u = i < 2 ? i : cf_unit(cf);
        cf->in[i][0] = (float)(u * far);
        cf->in[i][1] = cf->in[i][2] = cf->in[i][3] = 0;
    }
    return cf_write(cf, b->in, cf->in) &&
           (metres ? cf_draw(cf, &o)
                   : cf_encode(cf, &b->store, HL_OP_DEPTH_ENCODE,
                               hl_v4(inv, 0, 0, 0), b->in, b->stored)) &&
           cf_decode(cf, &b->store, HL_OP_UNPACK, b->in, b->stored, b->out);
}

static void one(struct bench *b, const struct cf_group *g, int k)
{
    struct cf *cf = b->cf;
    double far = fars[k], scale = far, half = b->half_step * far;
    if (b->id == CF_DEPTH_HALF_METRES) {
        scale = 1;
        half = metres_step(b, far);
    }
    struct hl_conform_result r = cf_result(
        HL_CONFORM_INTERVAL, "metres", half + ldexp(far, -22),
        "half a step of what is stored (a whole one where the store "
        "truncates), and two roundings to single precision");
    r.table = b->truncates ? (double)NAN : tables[b->id][k];
    if (picture(b, far))
        for (uint32_t i = 0; i < N; i++) {
            double z = (double)cf->in[i][0];
            cf_case_at(&r, fabs((double)cf->out[i][0] * scale - z), z, 0);
        }
    r.where = "z";
    r.n_at = 1;
    cf_report(cf, g, names[k], &r);
}

const char *cf_depth(struct cf *cf, const struct cf_group *g)
{
    struct bench b;
    memset(&b, 0, sizeof b);
    b.cf = cf;
    b.id = (enum cf_depth_id)g->what;
    const char *why = choose(&b);
    if (why)
        return why;
    if (cf_make_all(cf, &b.store, SIDE, &b.in, &b.stored, &b.out))
        for (int k = 0; k < FARS; k++)
            one(&b, g, k);
    cf_drop_all(cf, &b.in, &b.stored, &b.out);
    return NULL;
}
