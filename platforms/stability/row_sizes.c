/* SPDX-License-Identifier: Zlib */
/* Pictures of odd sizes and L-buffers of a few texels, and the largest size.
 *
 * Of a plane, a filtered pixel is a weighted mean of the light at centres of
 * texels within one L texel of it, so that it can differ from the reference
 * by no more than the reference varies there; and by what formats round.
 * Whatever is read beside that (a neighbour's row, a texel past the edge) is
 * more. The reference is known at pixels' centres: no light's foot is in
 * sight, so that between them it is monotone. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/reference/reference.h"
#include "platforms/stability/rig.h"

enum { MOST = 67, LARGEST = 16384 };
enum what { PICTURE, PLAN, TEXTURE };

/* What rounds, of the largest value: light and picture by their formats, as
 * the plan says; and 1e-3 for normals of 16 bits, which tilt by 6e-5, the
 * light's position by depth of 16 bits, and weights of 8 bits. */
static double rounded(const struct hl_plan *p)
{
    return 1e-3 + (double)hl_plan_target(p, HL_ROLE_LIGHT)->error +
           (double)hl_plan_target(p, HL_ROLE_COLOR)->error;
}

static bool begin(struct hls_lab *lab, const struct hls_case *c,
                  const char **skip)
{
    struct hls_rig rig;
    struct hlc_options o;
    hls_rig_options(&o, lab, 8, 8);
    /* An L-buffer's specular light has one channel: no size would hold. */
    o.no_specular = true;
    hls_rig_begin(&rig, 2, 60);
    /* 67 : 1 is the widest: 2 x 67 x tan(30) half, at distance 2. */
    hls_rig_wall(&rig, 0, 160, 0);
    /* Red for every shape; the others for what is not wider than 2 : 1. */
    hlh_build_light(&rig.b, hlh_v3(-90, -2, 40), 600, hlh_v3(1, 0, 0));
    hlh_build_light(&rig.b, hlh_v3(-3, -2, 1), 12, hlh_v3(0, 1, 0));
    hlh_build_light(&rig.b, hlh_v3(3, 2, 1), 12, hlh_v3(0, 0, 1));
    if (!hls_rig_end(&rig, lab, &o))
        return false;
    if (c->arg[0] != (double)PICTURE) {
        if (lab->stage.machine.caps.max_tex_dim != LARGEST)
            *skip = "the machine's largest size is another";
        return true;
    }
    const char *why;
    lab->data = hlr_prepare(&lab->stage.scene, &why);
    return lab->data || hls_rig_fail("sizes", HL_ERR_MEMORY);
}

static void end(struct hls_lab *lab)
{
    if (lab->data)
        hlr_prepared_free(lab->data);
    lab->data = NULL;
}

/* ---- pictures ----------------------------------------------------------- */

static uint32_t scaled(uint32_t n, double ratio)
{
    uint32_t x = (uint32_t)floor(n * ratio + 0.5);
    return x ? x : 1;
}

/* Pixels an L texel, rounded up. */
static uint32_t texel(uint32_t n, uint32_t light)
{
    return (n + light - 1) / light;
}

/* Least and greatest of channel k of the reference within rx, ry pixels. */
static void range_about(double range[2], const struct hlh_picture *r,
                        uint32_t x, uint32_t y, uint32_t rx, uint32_t ry,
                        uint32_t k)
{
    uint32_t x1 = x + rx < r->width ? x + rx : r->width - 1;
    uint32_t y1 = y + ry < r->height ? y + ry : r->height - 1;
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (uint32_t j = y > ry ? y - ry : 0; j <= y1; j++)
        for (uint32_t i = x > rx ? x - rx : 0; i <= x1; i++) {
            double v = (double)r->rgb[(j * r->width + i) * 3 + k];
            range[0] = v < range[0] ? v : range[0];
            range[1] = v > range[1] ? v : range[1];
        }
}

/* How far beyond what the neighbourhood allows, of the largest value. */
static double excess_of(const struct hlh_picture *p,
                        const struct hlh_picture *r, uint32_t rx, uint32_t ry,
                        uint32_t k)
{
    double worst = 0, peak = 0;
    for (uint32_t i = 0; i < r->width * r->height; i++) {
        double v = (double)p->rgb[3 * i + k], range[2];
        range_about(range, r, i % r->width, i / r->width, rx, ry, k);
        double e = v < range[0] ? range[0] - v : v - range[1];
        if (!(e <= worst))
            worst = isnan(e) ? INFINITY : e;
        peak = range[1] > peak ? range[1] : peak;
    }
    return worst / peak;
}

static double excess(const struct hlh_picture *p, const struct hlh_picture *r,
                     uint32_t rx, uint32_t ry)
{
    double worst = 0;
    for (uint32_t k = 0; k < (r->width > 2 * r->height ? 1u : 3u); k++) {
        double e = excess_of(p, r, rx, ry, k);
        worst = e > worst ? e : worst;
    }
    return worst;
}

static bool one(double *m, uint32_t w, uint32_t h, double ratio,
                struct hls_lab *lab)
{
    struct hlc_options o;
    struct hlc_shot shot;
    struct hlh_picture p, r = { w, h, malloc(sizeof(float[3]) * w * h), true };
    struct hlr_options reference = { .width = w, .height = h, .threads = 1,
                                     .no_specular = true };
    hls_rig_options(&o, lab, w, h);
    /* 11 bits, where they blend; else what the machine's rules leave. */
    if (lab->stage.machine.caps.format[HL_FORMAT_RGBA16_FLOAT].use &
        HL_USE_BLEND)
        o.light_format = HL_FORMAT_RGBA16_FLOAT;
    o.light_width = scaled(w, ratio);
    o.light_height = scaled(h, ratio);
    bool ok = r.rgb && hlr_draw(r.rgb, NULL, lab->data, &reference, NULL) &&
              hls_rig_shot(&shot, lab, &o);
    if (ok) {
        ok = hls_rig_picture(&p, &shot);
        if (ok) {
            double e = excess(&p, &r, texel(w, o.light_width),
                              texel(h, o.light_height)) /
                       rounded(&shot.plan);
            *m = e > *m ? e : *m;
            hlh_picture_free(&p);
        }
        hlc_shot_close(&shot);
    }
    free(r.rgb);
    return ok;
}

/* Pictures p wide and of every height; of some where that takes minutes, on
 * devices that compile programs. */
static bool all_heights(double *m, uint32_t p, double ratio,
                        struct hls_lab *lab)
{
    bool slow = strcmp(lab->o->backend, "packemu") != 0;
    uint32_t step = !slow && !lab->o->fast ? 1 : slow && lab->o->fast ? 33
                                                                      : 11;
    *m = 0;
    for (uint32_t h = 1; h <= MOST; h += step)
        if (!one(m, p, h, ratio, lab))
            return false;
    return true;
}

/* ---- limits ------------------------------------------------------------- */

static bool plan_refused(uint32_t n, struct hls_lab *lab)
{
    struct hlc_options o;
    struct hl_frame frame;
    struct hl_needs needs;
    struct hl_plan plan;
    hls_rig_options(&o, lab, n, 8);
    o.light_width = 8;
    return hlc_plan_try(&frame, &needs, &plan, &lab->stage.world,
                        &lab->stage.machine.caps, &o, NULL, NULL) != 0;
}

static bool texture_refused(uint32_t n, struct hls_lab *lab)
{
    struct hl_device *d = lab->stage.machine.device;
    struct hl_tex_desc t = { .format = HL_FORMAT_RGBA8_UNORM, .width = n,
                             .height = 1, .usage = HL_TEX_TARGET };
    hl_tex tex;
    bool refused = hl_tex_create(d, &tex, &t) != HL_OK;
    hl_tex_destroy(d, &tex);
    return refused;
}

/* ---- the row ------------------------------------------------------------ */

static bool measure(double *m, double p, const struct hls_case *c,
                    struct hls_lab *lab)
{
    uint32_t n = (uint32_t)p;
    if (c->arg[0] == (double)PICTURE)
        return all_heights(m, n, c->arg[1], lab);
    *m = c->arg[0] == (double)PLAN ? plan_refused(n, lab)
                                   : texture_refused(n, lab);
    return true;
}

#define HOLDS "none: a mean of light within an L texel"

static const struct hls_case cases[] = {
    { "1", "L-buffer of the picture's size", 1, MOST, 1, false, NAN, NAN,
      HOLDS, { PICTURE, 1, 0, 0 } },
    { "5-8", "of 5/8", 1, MOST, 1, false, NAN, NAN, HOLDS,
      { PICTURE, 0.625, 0, 0 } },
    { "1-2", "of half", 1, MOST, 1, false, NAN, NAN, HOLDS,
      { PICTURE, 0.5, 0, 0 } },
    { "1-4", "of a quarter", 1, MOST, 1, false, NAN, NAN, HOLDS,
      { PICTURE, 0.25, 0, 0 } },
    { "plan-most", "a plan refused: 1", 64, 20000, 0.5, false, 16385, 16385,
      "16385: caps.max_tex_dim 16,384", { PLAN, 0, 0, 0 } },
    { "texture-most", "a texture refused: 1", 64, 20000, 0.5, false, 16385,
      16385, "16385: caps.max_tex_dim 16,384", { TEXTURE, 0, 0, 0 } },
    { "plan-least", "a plan refused: 1", 64, 0, 0.5, false, 0, 0,
      "0: no picture has no pixel", { PLAN, 0, 0, 0 } },
    { "texture-least", "a texture refused: 1", 64, 0, 0.5, false, 0, 0,
      "0: no texture has no texel", { TEXTURE, 0, 0, 0 } },
};

const struct hls_row hls_row_sizes = {
    "sizes", "Odd and extreme sizes read or write beside the picture",
    "conformance c", "width (heights 1 to 67)", "pixels",
    "error over what is allowed", HLS_WHOLE,
    cases, sizeof cases / sizeof *cases, begin, end, measure
};
