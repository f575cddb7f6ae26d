/* SPDX-License-Identifier: Zlib */
/* Unit costs by differences of frames that differ in one thing. P: pixels of
 * the frame; the plane covers it once, every light's rectangle all of it, and
 * unless another size is stated the L-buffer has P texels. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/cli/commands.h"

enum { ROUNDS = 15, FINE_CUTS = 5 };
enum place { PLANE, COARSE, FINE, PLACES };

/* What differs; 0 is the plainest. */
struct spec {
    enum place place;
    enum hl_pipeline pipeline;
    uint32_t lights, batch;      /* batch > 0: RECTS                         */
    enum hl_light_path path;
    uint32_t part, half;         /* frame's side / part, L-buffer's / half   */
    enum hl_format light_format, normal_format;
    enum hl_dsf dsf;
    enum hl_fill fill;
    bool flat;                   /* lights in flat varyings                  */
    uint32_t items;              /* drawn; 0: all                            */
};

enum { N_LIGHT = 4, N_NORMAL = 2 };
static const enum hl_format light_formats[N_LIGHT] = {
    HL_FORMAT_RGBA8_UNORM, HL_FORMAT_RGB10A2_UNORM, HL_FORMAT_RGBA16_UNORM,
    HL_FORMAT_RGBA32_FLOAT
};
static const enum hl_format normal_formats[N_NORMAL] = {
    HL_FORMAT_RG8_UNORM, HL_FORMAT_RG16_FLOAT
};

enum shot {
    DARK, DARK_PART, FORWARD_8, K8_8, K8_40, FLAT_8, FLAT_40, K1_4, K1_20,
    LISTS_8, LISTS_40, TAPS_8, TAPS_8_FEW, NEAREST, ALL_COARSE, HALF_COARSE,
    ALL_FINE,
    K1_4_F, K1_20_F = K1_4_F + N_LIGHT, TAPS_F = K1_20_F + N_LIGHT,
    K1_4_N = TAPS_F + N_LIGHT, K1_20_N = K1_4_N + N_NORMAL,
    SHOTS = K1_20_N + N_NORMAL
};

#define F HL_PIPELINE_FORWARD
#define I HL_PIPELINE_INFERRED
static const struct spec plain[K1_4_F] = {
    [DARK] = { .pipeline = F },
    [DARK_PART] = { .pipeline = F, .part = 2 },
    [FORWARD_8] = { .pipeline = F, .lights = 8 },
    [K8_8] = { .pipeline = I, .lights = 8, .batch = 8 },
    [K8_40] = { .pipeline = I, .lights = 40, .batch = 8 },
    [FLAT_8] = { .pipeline = I, .lights = 8, .batch = 8, .flat = true },
    [FLAT_40] = { .pipeline = I, .lights = 40, .batch = 8, .flat = true },
    [K1_4] = { .pipeline = I, .lights = 4, .batch = 1 },
    [K1_20] = { .pipeline = I, .lights = 20, .batch = 1 },
    [LISTS_8] = { .pipeline = I, .lights = 8, .path = HL_LIGHT_PATH_LISTS },
    [LISTS_40] = { .pipeline = I, .lights = 40, .path = HL_LIGHT_PATH_LISTS },
    [TAPS_8] = { .pipeline = I, .lights = 1, .batch = 1, .half = 2,
                 .dsf = HL_DSF_SLOPE_SCALED, .fill = HL_FILL_DEPTH },
    [TAPS_8_FEW] = { .pipeline = I, .lights = 1, .batch = 1, .half = 4,
                     .dsf = HL_DSF_SLOPE_SCALED, .fill = HL_FILL_DEPTH },
    [NEAREST] = { .pipeline = I, .lights = 1, .batch = 1, .half = 2,
                  .dsf = HL_DSF_SLOPE_SCALED, .fill = HL_FILL_NEAREST },
    [ALL_COARSE] = { .place = COARSE, .pipeline = F },
    [HALF_COARSE] = { .place = COARSE, .pipeline = F, .items = HLK_DUST / 2 },
    [ALL_FINE] = { .place = FINE, .pipeline = F }
};

static struct spec spec_of(int k)
{
    struct spec s;
    if (k < K1_4_F)
        return plain[k];
    int base = k < K1_20_F ? K1_4 : k < TAPS_F ? K1_20 : k < K1_4_N ? TAPS_8
               : k < K1_20_N ? K1_4 : K1_20;
    s = plain[base];
    if (k < K1_4_N)
        s.light_format = light_formats[(k - K1_4_F) % N_LIGHT];
    else
        s.normal_format = normal_formats[(k - K1_4_N) % N_NORMAL];
    return s;
}

/* ---- frames ------------------------------------------------------------- */

struct bench {
    struct hlc_options o;
    struct hlc_stage stage[PLACES];
    struct hlk_frame frame[SHOTS];
    double pixels;
    struct hl_caps *caps;        /* what is found goes here                  */
    struct hlk_notes *notes;
};

static struct hlc_options options_of(const struct bench *b,
                                     const struct spec *s)
{
    struct hlc_options o = b->o;
    uint32_t half = s->half ? s->half : 1;
    o.pipeline = s->pipeline;
    o.samples = 1;
    o.no_tile_depth = true;
    o.dsf = s->dsf;
    o.fill = s->fill;
    if (s->pipeline == I) {
        o.light_width = o.width / half;
        o.light_height = o.height / half;
        o.light_path = s->path ? s->path : HL_LIGHT_PATH_RECTS;
        o.light_batch = s->batch;
        o.light_format = s->light_format ? s->light_format
                                         : HL_FORMAT_RGBA16_FLOAT;
        o.normal_format = s->normal_format;
        o.fetch = HL_FETCH_GATHER;
    }
    if (s->part) {
        o.part_width = o.width / s->part;
        o.part_height = o.height / s->part;
    }
    return o;
}

/* What this machine or its profile has not stays closed. */
static void open_shot(struct bench *b, int k)
{
    struct spec s = spec_of(k);
    struct hlc_stage *stage = &b->stage[s.place];
    struct hlc_options o = options_of(b, &s);
    struct hl_caps caps = stage->machine.caps;
    uint32_t all = stage->world.n_lights;
    char line[HLC_PLAN_LINE];
    caps.cost.light_ns = 1;
    caps.cost.light_flat_ns = s.flat ? 0.5f : 0;
    stage->world.n_lights = s.lights < all ? s.lights : all;
    int code = hlc_shot_open(&b->frame[k].shot, stage, &o, &caps, NULL, line);
    stage->world.n_lights = all;
    if (code == HLC_DONE && s.items)
        b->frame[k].shot.frame.n_items = s.items;
}

static int open_stages(struct bench *b)
{
    double aspect = (double)b->o.width / b->o.height;
    for (int i = 0; i < PLACES; i++) {
        struct hlh_scene scene;
        struct hlh_error error;
        bool ok = i == PLANE ? hlk_plane(&scene, aspect, &error)
                  : hlk_dust(&scene, i == COARSE ? 1 : FINE_CUTS, &error);
        if (!ok)
            return hlc_fail(HLC_BAD, "%s", error.text);
        int code = hlc_stage_open(&b->stage[i], &scene, &b->o);
        if (code != HLC_DONE)
            return code;
    }
    return HLC_DONE;
}

static void close_all(struct bench *b)
{
    for (int k = 0; k < SHOTS; k++)
        if (b->frame[k].shot.renderer)
            hlc_shot_close(&b->frame[k].shot);
    for (int i = 0; i < PLACES; i++)
        hlc_stage_close(&b->stage[i]);
}

/* ---- differences, nanoseconds ------------------------------------------- */

static double apart(const struct bench *b, int more, int less, int r, double n)
{
    return (b->frame[more].ms[r] - b->frame[less].ms[r]) * 1e6 / n;
}

/* One light and texel, of batches of eight and of single lights. */
static double batched(const struct bench *b, int r)
{
    return apart(b, K8_40, K8_8, r, 32 * b->pixels);
}

static double single(const struct bench *b, int r)
{
    return apart(b, K1_20, K1_4, r, 16 * b->pixels);
}

/* A draw's part of it: blend, shading floor, two fetches. */
static double draw_part(const struct bench *b, int r)
{
    return (single(b, r) - batched(b, r)) * 8 / 7;
}

static double light_inferred(const struct bench *b, int r)
{
    return batched(b, r) - draw_part(b, r) / 8;
}

/* The mean of what a light costs in both kinds of pass. */
static double light(const struct bench *b, int r)
{
    double forward = apart(b, FORWARD_8, DARK, r, 8 * b->pixels);
    return (light_inferred(b, r) + forward) / 2;
}

/* Forward has none of these: of batches alone. */
static double light_flat(const struct bench *b, int r)
{
    return apart(b, FLAT_40, FLAT_8, r, 32 * b->pixels) -
           draw_part(b, r) / 8;
}

static double light_gather(const struct bench *b, int r)
{
    return apart(b, LISTS_40, LISTS_8, r, 32 * b->pixels);
}

static double pixel(const struct bench *b, int r)
{
    return apart(b, DARK, DARK_PART, r, 0.75 * b->pixels);
}

/* What the G-buffer and one light cost, an L texel: of P / 4 and P / 16. */
static double texel(const struct bench *b, int r)
{
    return apart(b, TAPS_8, TAPS_8_FEW, r, b->pixels * 3 / 16);
}

/* Eight taps with what is done with them; without, the stage does what it does
 * of a forward frame without lights. */
static double fetch(const struct bench *b, int r)
{
    return (apart(b, TAPS_8, DARK, r, b->pixels) - texel(b, r) / 4) / 8;
}

static double blend(const struct bench *b, int r)
{
    return draw_part(b, r) - pixel(b, r) - 2 * fetch(b, r);
}

static double vertex(const struct bench *b, int r)
{
    return apart(b, ALL_FINE, ALL_COARSE, r,
                 HLK_DUST * 12.0 * (FINE_CUTS * FINE_CUTS - 1));
}

static double draw(const struct bench *b, int r)
{
    return apart(b, ALL_COARSE, HALF_COARSE, r, HLK_DUST / 2) -
           12 * vertex(b, r);
}

/* core's LOOK_AROUND: seventeen fetches more where all runs. */
static double untaken(const struct bench *b, int r)
{
    double x = apart(b, NEAREST, TAPS_8, r, 17 * b->pixels) / fetch(b, r);
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

static double blend_more(const struct bench *b, int r, int i)
{
    return apart(b, K1_20_F + i, K1_4_F + i, r, 16 * b->pixels) -
           single(b, r);
}

/* Four taps; the L-buffer of P / 4 was blended to once. */
static double fetch_more(const struct bench *b, int r, int i)
{
    return apart(b, TAPS_F + i, TAPS_8, r, 4 * b->pixels) -
           blend_more(b, r, i) / 16;
}

/* Normals are fetched once a light and texel. */
static double normal_more(const struct bench *b, int r, int i)
{
    return apart(b, K1_20_N + i, K1_4_N + i, r, 16 * b->pixels) -
           single(b, r);
}

/* Written once, beside four fetches; a blend is two writes' worth. */
static double write_more(const struct bench *b, int r, int i)
{
    return 2 * (apart(b, K1_4_N + i, K1_4, r, b->pixels) -
                4 * normal_more(b, r, i));
}

/* ---- what they come to -------------------------------------------------- */

static void scalars(struct bench *b)
{
    static const struct {
        const char *key;
        double (*of)(const struct bench *, int);
    } units[] = {
        { "cost.draw_ns", draw }, { "cost.vertex_ns", vertex },
        { "cost.pixel_ns", pixel }, { "cost.fetch_ns", fetch },
        { "cost.blend_ns", blend }, { "cost.light_ns", light },
        { "cost.light_flat_ns", light_flat },
        { "cost.light_gather_ns", light_gather }, { "cost.untaken", untaken }
    };
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        double v[ROUNDS];
        for (int r = 0; r < ROUNDS; r++)
            v[r] = units[i].of(b, r);
        hlk_take(b->caps, b->notes, units[i].key, v, ROUNDS,
                 units[i].of == untaken);
    }
}

static void of_format(struct bench *b, const char *what, enum hl_format f,
                      double (*more)(const struct bench *, int, int), int i,
                      double base)
{
    char key[HLC_CALIBRATION_KEY];
    double v[ROUNDS];
    snprintf(key, sizeof key, "cost.format_%s_ns.%s", what,
             hl_format_info(f)->name);
    for (int r = 0; r < ROUNDS; r++)
        v[r] = base + (more ? more(b, r, i) : 0);
    hlk_take(b->caps, b->notes, key, v, ROUNDS, false);
}

/* Against the values that formats have in common: 8 bytes blended, 4 to 8
 * fetched, 4 written. */
static void formats(struct bench *b)
{
    double blend_8 = (double)b->caps->cost.blend_ns;
    double fetch_8 = (double)b->caps->cost.fetch_ns;
    of_format(b, "blend", HL_FORMAT_RGBA16_FLOAT, NULL, 0, blend_8);
    of_format(b, "fetch", HL_FORMAT_RGBA16_FLOAT, NULL, 0, fetch_8);
    of_format(b, "fetch", HL_FORMAT_RG16_UNORM, NULL, 0, fetch_8);
    for (int i = 0; i < N_LIGHT; i++) {
        of_format(b, "blend", light_formats[i], blend_more, i, blend_8);
        of_format(b, "fetch", light_formats[i], fetch_more, i, fetch_8);
    }
    for (int i = 0; i < N_NORMAL; i++) {
        of_format(b, "blend", normal_formats[i], write_more, i, blend_8 / 2);
        of_format(b, "fetch", normal_formats[i], normal_more, i, fetch_8);
    }
}

/* ---- all ---------------------------------------------------------------- */

static int measure(struct bench *b)
{
    int code = open_stages(b);
    if (code != HLC_DONE)
        return code;
    for (int k = 0; k < SHOTS; k++)
        open_shot(b, k);
    bool cpu = b->caps->kind == HL_DEVICE_CPU;
    if (!hlk_time(b->frame, SHOTS, ROUNDS, cpu))
        return hlc_fail(HLC_NO_DEVICE, "calibrate: the device failed");
    scalars(b);
    formats(b);
    hlk_readback(b->caps, b->notes, b->stage[PLANE].machine.device);
    return HLC_DONE;
}

int hlk_units(struct hl_caps *caps, struct hlk_notes *notes,
              const struct hlc_options *o)
{
    struct bench *b = calloc(1, sizeof *b);
    if (!b)
        return hlc_fail(HLC_BAD, "calibrate: out of memory");
    b->o = *o;
    b->pixels = (double)o->width * o->height;
    b->caps = caps;
    b->notes = notes;
    int code = measure(b);
    close_all(b);
    free(b);
    return code;
}
