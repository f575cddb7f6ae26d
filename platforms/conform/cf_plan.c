/* SPDX-License-Identifier: Zlib */
/* The planner's arithmetic for consoles (spec/consoles 1.1, 2.2): EDRAM
 * tiles, what fits, and the formats that one pass may have. */
#include <string.h>
#include "core/plan.h"
#include "platforms/conform/cf.h"

static struct hl_needs needs_of(uint32_t width, uint32_t height)
{
    struct hl_needs n;
    memset(&n, 0, sizeof n);
    n.width = 1280;
    n.height = 720;
    n.light_width = width;
    n.light_height = height;
    n.n_objects = 20;
    n.n_triangles = 20000;
    n.n_lights = 81;
    n.lights_per_pixel = 8;
    n.lights_per_object = 20;
    n.n_regions = 100;
    n.far = 1000;
    n.peak = 8;
    return n;
}

static enum hl_result plan(const struct cf *cf, struct hl_plan *p,
                           uint32_t width, uint32_t height,
                           enum hl_refusal *why)
{
    struct hl_needs n = needs_of(width, height);
    return hl_plan_make(p, HL_PIPELINE_INFERRED, &n, cf->caps, why);
}

/* ---- EDRAM -------------------------------------------------------------- */

static const struct {
    uint32_t width, height, samples;
    bool wide;
    uint32_t tiles;
} sizes[] = {
    { 1, 1, 1, false, 1 }, { 80, 16, 4, false, 4 },
    { 256, 256, 1, false, 64 }, { 800, 450, 1, false, 290 },
    { 800, 450, 1, true, 580 }, { 960, 540, 1, false, 408 },
    { 960, 540, 1, true, 816 }, { 1280, 720, 1, false, 720 },
    { 1280, 720, 2, false, 1440 }, { 1280, 720, 4, false, 2880 },
    { 1280, 720, 1, true, 1440 }, { 640, 480, 4, false, 960 },
    { 1120, 720, 2, false, 1260 },
};

static void tiles(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "tiles", 0,
        "ceil(w sx / 80) ceil(h sy / 16), twice for 64 bits");
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        enum hl_format f = sizes[i].wide ? HL_FORMAT_RGBA16_FIXED32
                                         : HL_FORMAT_RGBA8_UNORM;
        uint64_t n = hl_edram_tiles(cf->profile, f, sizes[i].width,
                                    sizes[i].height, sizes[i].samples);
        cf_case_at(&r, fabs((double)n - sizes[i].tiles), sizes[i].width,
                   sizes[i].height);
    }
    r.where = "width, height";
    r.n_at = 2;
    cf_report(cf, g, "edram_tiles", &r);
}

static uint64_t of_role(const struct cf *cf, const struct hl_plan *p,
                        enum hl_role role)
{
    const struct hl_plan_target *t = hl_plan_target(p, role);
    return t ? hl_edram_tiles(cf->profile, t->format, t->width, t->height,
                              t->samples) : 0;
}

/* Depth, normals, DSF and L-buffer of an L-buffer's size: 3 x 32 bits, 64. */
static void fits(struct cf *cf, const struct cf_group *g, const char *name,
                 uint32_t width, uint32_t height, double sum)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "tiles", 0,
        "depth, normals, depth and ids, and light of 64 bits at once, all "
        "in 2,048 tiles");
    struct hl_plan p;
    enum hl_refusal why;
    double n = (double)NAN;
    if (plan(cf, &p, width, height, &why) == HL_OK) {
        n = (double)(of_role(cf, &p, HL_ROLE_LIGHT_DEPTH) +
                     of_role(cf, &p, HL_ROLE_NORMAL) +
                     of_role(cf, &p, HL_ROLE_DSF));
        /* The stand-in for light has 64 bits too. */
        n += (double)of_role(cf, &p, HL_ROLE_LIGHT);
        if (p.edram_tiles > cf->profile->edram_tiles)
            n = (double)NAN;
        if (p.light_width != width || p.light_height != height)
            n = (double)NAN;
    }
    cf_case(&r, fabs(n - sum));
    r.where = "tiles";
    r.at[0] = n;
    r.n_at = 1;
    r.table = sum;
    cf_report(cf, g, name, &r);
}

/* 3 x 720 tiles of normals, depth and ids at 1280 x 720 are 2,160. */
static void refused(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "", 0,
        "an L-buffer of 1280 x 720 needs 2,160 tiles: refused");
    struct hl_plan p;
    enum hl_refusal why = HL_REFUSED_NOTHING;
    enum hl_result e = plan(cf, &p, 1280, 720, &why);
    cf_case(&r, e != HL_OK && why == HL_REFUSED_EDRAM ? 0 : 1);
    cf_report(cf, g, "edram_720", &r);
}

/* No two targets that are alive in one pass share a tile. */
static void apart(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "pairs", 0,
        "targets of one pass do not overlap in EDRAM");
    struct hl_plan p;
    enum hl_refusal why;
    cf_case(&r, plan(cf, &p, 800, 450, &why) == HL_OK ? 0 : 1);
    for (uint32_t k = 0; r.worst == 0 && k < p.n_passes; k++) {
        enum hl_role role[4] = { p.pass[k].color[0], p.pass[k].color[1],
                                 p.pass[k].color[2], p.pass[k].depth };
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < i; j++) {
                const struct hl_plan_target *a = hl_plan_target(&p, role[i]);
                const struct hl_plan_target *b = hl_plan_target(&p, role[j]);
                if (!a || !b || a == b || !a->console.edram_tile ||
                    !b->console.edram_tile)
                    continue;
                uint32_t x = a->console.edram_tile, y = b->console.edram_tile;
                cf_case(&r, x < y + b->edram_tiles && y < x + a->edram_tiles);
            }
    }
    cf_report(cf, g, "edram_apart", &r);
}

/* ---- formats ------------------------------------------------------------ */

/* The plan's normals are kept in the storage that the suite checks. */
static void two16(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "", 0,
        "normals and depth of a plan are in the storage checked here for "
        "the profile");
    struct hl_plan p;
    struct cf_store s;
    enum hl_refusal why;
    const struct hl_plan_target *t[2] = { NULL, NULL };
    const char *no = cf_store(cf, cf_profile_store(cf), &s);
    if (!no && plan(cf, &p, 800, 450, &why) == HL_OK) {
        t[0] = hl_plan_target(&p, HL_ROLE_NORMAL);
        t[1] = hl_plan_target(&p, HL_ROLE_DSF);
    }
    for (int i = 0; i < 2; i++)
        cf_case(&r, t[i] && t[i]->format == s.format &&
                    p.two16 == s.two16 &&
                    t[i]->console.remap == s.console.remap &&
                    t[i]->console.resolve_exp_bias ==
                    s.console.resolve_exp_bias &&
                    t[i]->console.resolve_number ==
                    s.console.resolve_number ? 0 : 1);
    cf_report(cf, g, "two16", &r);
}

static void ids(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "", 0, "the plan's ids have the profile's steps");
    struct hl_plan p;
    enum hl_refusal why;
    double want = cf->profile->id_steps > 0 ? (double)cf->profile->id_steps
                                            : 65535;
    double got = plan(cf, &p, 800, 450, &why) == HL_OK ? (double)p.id_steps
                                                       : (double)NAN;
    cf_case(&r, fabs(got - want));
    r.table = want;
    cf_report(cf, g, "id_steps", &r);
}

static void one_format(struct cf *cf, const struct cf_group *g)
{
    struct hl_conform_result r = cf_result(
        HL_CONFORM_EXACT, "targets", 0,
        "all colour targets of a pass have one format (one register)");
    struct hl_needs n = needs_of(800, 450);
    struct hl_plan p;
    enum hl_refusal why;
    n.specular = HL_NEED_EXPONENTS;
    enum hl_result e = hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, cf->caps,
                                    &why);
    cf_case(&r, e == HL_OK ? 0 : 1);
    for (uint32_t k = 0; e == HL_OK && k < p.n_passes; k++)
        for (int i = 1; i < 3; i++) {
            const struct hl_plan_target *a =
                hl_plan_target(&p, p.pass[k].color[0]);
            const struct hl_plan_target *b =
                hl_plan_target(&p, p.pass[k].color[i]);
            if (a && b)
                cf_case(&r, a->format == b->format ? 0 : 1);
        }
    cf_report(cf, g, "mrt_format", &r);
}

const char *cf_plan(struct cf *cf, const struct cf_group *g)
{
    two16(cf, g);
    ids(cf, g);
    if (cf->profile->one_mrt_format)
        one_format(cf, g);
    if (cf->profile->edram_tiles == 0)
        return "not a rule of this profile";
    tiles(cf, g);
    fits(cf, g, "edram_450", 800, 450, 1450);
    fits(cf, g, "edram_540", 960, 540, 2040);
    refused(cf, g);
    apart(cf, g);
    return "not a rule of this profile";
}
