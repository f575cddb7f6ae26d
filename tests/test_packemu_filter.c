/* SPDX-License-Identifier: Zlib */
/* How pixels find their samples in the L-buffer: those of a stipple pattern
 * (K 4), those around a pixel whose taps are all rejected, and filtered
 * fetches (K 7.1). packemu's kernels against shaders/inferred.glsl, written
 * out a second time for one fragment; and what must hold whatever the text. */
#include <math.h>
#include <string.h>
#include "platforms/packemu/pe_kernel.h"
#include "shaders/shared/stipple.h"
#include "tests/kernel_kit.h"

/* No multiple of a pattern's block. */
enum { LW = 13, LH = 9, FW = 21, FH = 16, ID = 60000, STEP = 60 };

struct lbuffer { uint16_t dsf[LH][LW][2]; float light[LH][LW][4]; };

static struct kk k;
static struct lbuffer l;
static float out[6][HL_PE_BATCH];

static void begin(void)
{
    kk_open(&k);
    k.frame.depth = hl_v4(1, 0, 0.01f, 100.0f);
    k.program.spec[HL_SPEC_LIGHT_WIDTH].f = LW;
    k.program.spec[HL_SPEC_LIGHT_HEIGHT].f = LH;
    k.program.spec[HL_SPEC_RATIO_X].f = (float)LW / FW;
    k.program.spec[HL_SPEC_RATIO_Y].f = (float)LH / FH;
    k.program.spec[HL_SPEC_LIGHT_BITS].u = HL_BITS_FLOAT;
    k.program.spec[HL_SPEC_DSF_TAU].f = 0.02f;
}

static void bind(bool numbers)
{
    kk_texture(&k, HL_TEX_LIGHT, HL_FORMAT_RGBA32_FLOAT,
               numbers ? HL_FORMAT_NONE : HL_FORMAT_RGBA32_UINT, LW, LH,
               l.light);
    kk_texture(&k, HL_TEX_DSF, HL_FORMAT_RG16_UNORM,
               numbers ? HL_FORMAT_NONE : HL_FORMAT_R32_UINT, LW, LH, l.dsf);
}

/* Few ids and depths, so that every number of taps is accepted somewhere. */
static void fill_random(void)
{
    for (int i = 0; i < LW * LH; i++) {
        uint16_t *w = l.dsf[i / LW][i % LW];
        w[0] = (uint16_t)(2000 + mk_below(&k.seed, 4) * STEP);
        w[1] = (uint16_t)(ID + mk_below(&k.seed, 3));
        for (int c = 0; c < 4; c++)
            l.light[i / LW][i % LW][c] = kk_between(&k, 0, 40);
    }
}

/* One surface, light of x and y in two channels. */
static void fill_ramp(float z, float a, float bx, float by)
{
    for (int i = 0; i < LW * LH; i++) {
        float *t = l.light[i / LW][i % LW];
        l.dsf[i / LW][i % LW][0] = (uint16_t)(z / 100 * 65535 + 0.5f);
        l.dsf[i / LW][i % LW][1] = ID;
        t[0] = a + bx * (float)(i % LW);
        t[1] = a + by * (float)(i / LW);
        t[2] = t[3] = a;
    }
}

static void fragments(void)
{
    kk_fragments(&k, HL_PE_BATCH, FW, FH);
    for (uint32_t i = 0; i < k.in.n; i++) {
        k.in.z[i] = (2000 + (float)mk_below(&k.seed, 200)) * 100 / 65535;
        k.in.vary[HL_PE_ID][i] = (float)(ID + mk_below(&k.seed, 3));
    }
}

/* Fragments of the surface of fill_ramp, flat and in front of the viewer. */
static void flat_fragments(float z)
{
    fragments();
    for (uint32_t i = 0; i < k.in.n; i++) {
        k.in.z[i] = z;
        k.in.dzdx[i] = k.in.dzdy[i] = 0;
        k.in.vary[HL_PE_ID][i] = ID;
    }
}

/* ---- once more ----------------------------------------------------------- */

struct at { int x, y; };

static int least(int a, int b) { return a < b ? a : b; }
static int most(int a, int b) { return a > b ? a : b; }

/* Texel of sample (x, y) of a lattice. */
static struct at texel(int x, int y, uint32_t side, hl_vec2 cell)
{
    int s = (int)side, cx = (int)cell.x, cy = (int)cell.y;
    int last_x = LW - 1 < cx ? 0 : (LW - 1 - cx) / s;
    int last_y = LH - 1 < cy ? 0 : (LH - 1 - cy) / s;
    struct at t = { least(most(least(x, last_x), 0) * s + cx, LW - 1),
                    least(most(least(y, last_y), 0) * s + cy, LH - 1) };
    return t;
}

struct pixel {
    uint32_t side;
    hl_vec2 cell, f;
    int x, y;                /* sample 00                                    */
    float z, id, slope, accept[4];
};

static float threshold(const struct pixel *p, float distance)
{
    const union pe_spec *s = k.program.spec;
    return s[HL_SPEC_DSF].u == HL_DSF_SLOPE
           ? hl_dsf_threshold(100.0f / 65535, s[HL_SPEC_DSF_K].f,
                              s[HL_SPEC_DSF_C].f, p->z, p->slope, distance)
           : s[HL_SPEC_DSF_TAU].f * p->z;
}

static float depth_at(struct at t)
{
    return (float)l.dsf[t.y][t.x][0] * (100.0f / 65535);
}

static bool accepts(const struct pixel *p, struct at t, float distance)
{
    bool same = p->id == 0 || (float)l.dsf[t.y][t.x][1] == p->id;
    return same && fabsf(depth_at(t) - p->z) <= threshold(p, distance);
}

static struct pixel pixel_of(uint32_t i)
{
    const union pe_spec *s = k.program.spec;
    struct pixel p = { .side = s[HL_SPEC_STIPPLE].u, .z = k.in.z[i],
                       .id = k.in.vary[HL_PE_ID][i] };
    float rx = s[HL_SPEC_RATIO_X].f, ry = s[HL_SPEC_RATIO_Y].f;
    bool off = s[HL_SPEC_DSF].u == HL_DSF_OFF;
    if (p.side)
        p.cell = hl_stipple_cell((uint32_t)k.object.flat_ids.z, p.side);
    else
        p.side = 1;
    float side = (float)p.side;
    float x = (((float)k.in.x[i] + 0.5f) * rx - 0.5f - p.cell.x) / side;
    float y = (((float)k.in.y[i] + 0.5f) * ry - 0.5f - p.cell.y) / side;
    p.x = (int)floorf(x);
    p.y = (int)floorf(y);
    p.f = hl_v2(x - floorf(x), y - floorf(y));
    p.slope = fabsf(k.in.dzdx[i]) * (1 / rx) + fabsf(k.in.dzdy[i]) * (1 / ry);
    for (int t = 0; t < 4; t++)
        p.accept[t] = off || accepts(&p, texel(p.x + (t & 1), p.y + (t >> 1),
                                               p.side, p.cell), side);
    return p;
}

/* The sample that fills a pixel without taps; false: there is none near. */
static bool filling(const struct pixel *p, struct at *best)
{
    float nearest = 1e9f;
    for (int n = 0; n < 16; n++) {
        int dx = (n >> 2 & 1) * 2 - 1 + (n & 1);
        int dy = (n >> 3) * 2 - 1 + (n >> 1 & 1);
        struct at a = texel(p->x + dx, p->y + dy, p->side, p->cell);
        float x = (float)dx - p->f.x, y = (float)dy - p->f.y;
        bool inner = (dx == 0 || dx == 1) && (dy == 0 || dy == 1);
        if (inner || x * x + y * y >= nearest ||
            !accepts(p, a, 2 * (float)p->side))
            continue;
        nearest = x * x + y * y;
        *best = a;
    }
    return nearest < 1e9f;
}

/* All four taps before the pixel. */
static bool hidden(const struct pixel *p)
{
    for (int t = 0; t < 4; t++)
        if (depth_at(texel(p->x + (t & 1), p->y + (t >> 1), p->side,
                           p->cell)) >=
            p->z - threshold(p, (float)p->side))
            return false;
    return true;
}

/* Bilinear weights over distances in depth, a tenth of the pixel's added. */
static void weigh_by_depth(const struct pixel *p, float want[4])
{
    hl_vec4 b = hl_bilinear(p->f);
    const float k4[4] = { b.x, b.y, b.z, b.w };
    double w[4], sum = 0;
    for (int t = 0; t < 4; t++) {
        struct at a = texel(p->x + (t & 1), p->y + (t >> 1), p->side, p->cell);
        w[t] = ((double)k4[t] + 0.001) /
               (fabs((double)depth_at(a) - (double)p->z) +
                0.1 * (double)p->z);
        sum += w[t];
    }
    for (int c = 0; c < 4; c++) {
        double x = 0;
        for (int t = 0; t < 4; t++) {
            struct at a = texel(p->x + (t & 1), p->y + (t >> 1), p->side,
                                p->cell);
            x += (double)l.light[a.y][a.x][c] * w[t] / sum;
        }
        want[c] = (float)x;
    }
}

static void weigh(const struct pixel *p, float want[4])
{
    const float *a = p->accept;
    hl_vec4 accepted = hl_v4(a[0], a[1], a[2], a[3]);
    bool cone = k.program.spec[HL_SPEC_STIPPLE_CONE].u != 0;
    hl_vec4 v = k.program.spec[HL_SPEC_STIPPLE].u
                ? hl_stipple_weights(p->f, accepted, cone)
                : hl_dsf_weights(hl_bilinear(p->f), accepted);
    const float w[4] = { v.x, v.y, v.z, v.w };
    for (int c = 0; c < 4; c++) {
        want[c] = 0;
        for (int t = 0; t < 4; t++) {
            struct at at = texel(p->x + (t & 1), p->y + (t >> 1), p->side,
                                 p->cell);
            want[c] += l.light[at.y][at.x][c] * w[t];
        }
    }
}

/* Light of all fragments; how many taps were accepted, as bits of `seen`. The
 * same operations again, but for the order of a sum of four products of at
 * most 40: 8 roundings of 2^-24; by depth, with a weight's own 14 or so (a
 * distance, two sums, a quotient, the sum of weights, the product with its
 * inverse), 24. */
static void check(uint32_t *seen)
{
    hl_pe_read_lights(&k.draw, &k.in, out);
    for (uint32_t i = 0; i < k.in.n; i++) {
        struct pixel p = pixel_of(i);
        float want[4];
        int n = (int)(p.accept[0] + p.accept[1] + p.accept[2] + p.accept[3]);
        *seen |= 1u << n;
        weigh(&p, want);
        uint32_t fill = k.program.spec[HL_SPEC_FILL].u;
        struct at a = { 0, 0 };
        bool far = false;
        bool lost = n == 0 && (fill & HL_FILL_THROUGH || !hidden(&p));
        if (lost && fill & 1 && filling(&p, &a))
            memcpy(want, l.light[a.y][a.x], sizeof want);
        else if (lost && fill && (far = true))
            weigh_by_depth(&p, want);
        for (int c = 0; c < 3; c++)
            ck_near(out[c][i], want[c], (far ? 40 * 24 : 40 * 8) / 16777216.0);
    }
}

/* ---- kernels ------------------------------------------------------------- */

static const uint32_t filters[] = { HL_DSF_SLOPE, HL_DSF_CONSTANT,
                                    HL_DSF_OFF };

/* All patterns and borders, every filter, as words and as numbers. */
static void samples_of_a_pattern(void **state)
{
    (void)state;
    begin();
    for (uint32_t i = 0; i < 2 * 2 * 2 * 2 * 3; i++) {
        uint32_t side = i & 1 ? 4 : 2, seen = 0, off = i / 16 == 2;
        k.program.spec[HL_SPEC_STIPPLE].u = side;
        k.program.spec[HL_SPEC_STIPPLE_CONE].u = i >> 1 & 1;
        k.program.spec[HL_SPEC_FILL].u = !(i >> 2 & 1) ? 0
            : i & 1 ? 2 : i & 8 ? 1 : 1 | HL_FILL_THROUGH;
        k.program.spec[HL_SPEC_DSF].u = filters[i / 16];
        for (uint32_t n = 0; n < side * side; n++) {
            fill_random();
            bind(i >> 3 & 1);
            k.object.flat_ids.z = (float)n;
            fragments();
            check(&seen);
        }
        assert_int_equal(seen & 17, off ? 16 : 17);
    }
    kk_close(&k);
}

static void filled_pixels_of_opaque_surfaces(void **state)
{
    (void)state;
    begin();
    k.program.spec[HL_SPEC_FILL].u = 1;
    for (uint32_t i = 0; i < 16; i++) {
        uint32_t seen = 0;
        k.program.spec[HL_SPEC_DSF].u = filters[i & 1];
        fill_random();
        bind(i >> 1 & 1);
        fragments();
        check(&seen);
        assert_int_equal(seen & 1, 1);
    }
    kk_close(&k);
}

/* Region 0 takes taps of any region, by depth alone. */
static void region_zero_takes_any(void **state)
{
    uint32_t seen = 0;
    (void)state;
    begin();
    k.program.spec[HL_SPEC_DSF].u = HL_DSF_CONSTANT;
    k.program.spec[HL_SPEC_FILL].u = 1;
    fill_random();
    bind(false);
    for (int i = 0; i < 4; i++) {
        fragments();
        memset(k.in.vary[HL_PE_ID], 0, sizeof k.in.vary[HL_PE_ID]);
        check(&seen);
    }
    /* By id alone none would be. */
    assert_int_equal(seen & 16, 16);
    kk_close(&k);
}

/* ---- what must hold ------------------------------------------------------ */

/* A surface of one light comes back as it is: weights sum to 1 within 2^-22
 * (4 products, 3 sums), and so do the products with it. */
static void constant_light_stays(void **state)
{
    (void)state;
    begin();
    fill_ramp(3, 7, 0, 0);
    bind(false);
    for (uint32_t i = 0; i < 4; i++) {
        k.program.spec[HL_SPEC_STIPPLE].u = i & 1 ? 4 : 2;
        k.program.spec[HL_SPEC_STIPPLE_CONE].u = i >> 1;
        k.object.flat_ids.z = (float)(1 + i);
        flat_fragments(3);
        hl_pe_read_lights(&k.draw, &k.in, out);
        for (uint32_t j = 0; j < k.in.n; j++)
            for (int c = 0; c < 3; c++)
                ck_near(out[c][j], 7, 7 * 2 / 4194304.0);
    }
    kk_close(&k);
}

/* Worst distance, in texels, of the place whose light a pixel gets, of pixels
 * that have samples on all sides. */
static double ramp_error(uint32_t side, uint32_t cone, double *worst_y)
{
    double worst = 0;
    k.program.spec[HL_SPEC_STIPPLE].u = side;
    k.program.spec[HL_SPEC_STIPPLE_CONE].u = cone;
    *worst_y = 0;
    for (uint32_t n = 0; n < side * side; n++) {
        k.object.flat_ids.z = (float)n;
        flat_fragments(3);
        hl_pe_read_lights(&k.draw, &k.in, out);
        for (uint32_t i = 0; i < k.in.n; i++) {
            struct pixel p = pixel_of(i);
            int s = (int)side, last_x = (p.x + 1) * s + (int)p.cell.x;
            int last_y = (p.y + 1) * s + (int)p.cell.y;
            double x = (k.in.x[i] + 0.5) * LW / FW - 0.5;
            double y = (k.in.y[i] + 0.5) * LH / FH - 0.5;
            if (p.x >= 0 && last_x < LW)
                worst = fmax(worst, fabs((double)out[0][i] - 1 - x));
            if (p.y >= 0 && last_y < LH)
                *worst_y = fmax(*worst_y, fabs((double)out[1][i] - 1 - y));
        }
    }
    return worst;
}

/* Bilinear weights give a ramp back: 1 to 13 by four products, 2^-20 each.
 * Cones: of two taps in a row the nearer weighs more, so that the place is on
 * the pixel's side of their middle, or between: off by at most half their
 * distance, which plain nearest samples reach. */
static void a_ramp_is_reconstructed(void **state)
{
    (void)state;
    begin();
    fill_ramp(3, 1, 1, 1);
    bind(false);
    for (uint32_t side = 2; side <= 4; side += 2) {
        double y, x = ramp_error(side, 0, &y);
        assert_true(x <= 4 / 1048576.0 && y <= 4 / 1048576.0);
        x = ramp_error(side, 1, &y);
        print_message("cone, side %u: %.3f and %.3f texels off\n", side, x, y);
        assert_true(x <= side / 2.0 && y <= side / 2.0);
    }
    kk_close(&k);
}

/* A tap leaves with weight 0 in either filter: no jump where the four samples
 * change. */
static void taps_leave_without_a_jump(void **state)
{
    (void)state;
    for (int i = 0; i <= 1000; i++) {
        float y = (float)i / 1000;
        hl_vec4 a = hl_cones(hl_v2(0, y)), b = hl_cones(hl_v2(1, y));
        assert_true(a.y == 0 && a.w == 0 && b.x == 0 && b.z == 0);
        assert_true(a.x == b.y && a.z == b.w);
        assert_true(a.x + a.z > 0.5f);
    }
}

/* ---- a wire -------------------------------------------------------------- */

enum { WIRE = 6, WIRE_Z = 3, NEAR_Z = 5, WALL_Z = 9 };

/* Light of the texel that a pixel of the wire at L x gets: x + 100 y. */
static float wire_light(float x)
{
    k.program.spec[HL_SPEC_RATIO_X].f = x + 0.5f;
    k.program.spec[HL_SPEC_RATIO_Y].f = 1;
    flat_fragments(WIRE_Z);
    for (uint32_t i = 0; i < k.in.n; i++) {
        /* Pixel 0.5 is at ratio / 2. */
        k.in.x[i] = 0;
        k.in.y[i] = 4;
    }
    k.program.spec[HL_SPEC_RATIO_X].f = 2 * x + 1;
    hl_pe_read_lights(&k.draw, &k.in, out);
    return out[0][HL_PE_BATCH - 1];
}

/* One texel wide, before a wall. Within two texels its own sample is found,
 * on either side; beyond, the taps by depth: halfway between 408 and 409,
 * which misses by less, and 0.001 of each of the next row. */
static void a_wire_finds_its_sample(void **state)
{
    (void)state;
    begin();
    k.program.spec[HL_SPEC_FILL].u = 1;
    for (int i = 0; i < LW * LH; i++) {
        int x = i % LW, y = i / LW;
        float z = x == WIRE ? WIRE_Z : y == 4 && x == 9 ? NEAR_Z : WALL_Z;
        l.dsf[y][x][0] = (uint16_t)(z * 655.35f + 0.5f);
        l.dsf[y][x][1] = (uint16_t)(x == WIRE ? ID : ID + 1);
        l.light[y][x][0] = (float)(x + 100 * y);
        l.light[y][x][1] = l.light[y][x][2] = l.light[y][x][3] = 1;
    }
    bind(false);
    assert_true(wire_light(6.25f) == 406);
    assert_true(wire_light(7.25f) == 406);
    assert_true(wire_light(7.75f) == 406);
    assert_true(wire_light(4.25f) == 406);
    double m = 0.1 * WIRE_Z, far = 1 / (WALL_Z - WIRE_Z + m);
    double near = 1 / (NEAR_Z - WIRE_Z + m);
    double by_depth = (0.501 * (408 * far + 409 * near) +
                       0.001 * (508 + 509) * far) /
                      (0.503 * far + 0.501 * near);
    /* Depths are stored to half of 1/655.35 m: less than 1e-3 of either
     * distance, and so of the unit between the two. */
    assert_true(by_depth > 408.6);
    assert_true(fabs((double)wire_light(8.5f) - by_depth) < 2e-3);
    k.program.spec[HL_SPEC_FILL].u = 0;
    assert_true(fabsf(wire_light(7.25f) - 407.25f) < 1e-3f);
    kk_close(&k);
}

/* ---- filtered fetches ---------------------------------------------------- */

/* Where a tap is rejected nothing changes, to the bit; elsewhere the filter's
 * own order of roundings does: three mixes, each of 2^-23 of 40, and the place
 * of the fetch, 2^-23 of 13 texels times a contrast of 40. */
static void filtered_where_nothing_is_rejected(void **state)
{
    static float four[6][HL_PE_BATCH];
    uint32_t filtered = 0, others = 0;
    (void)state;
    begin();
    for (uint32_t i = 0; i < 32; i++) {
        k.program.spec[HL_SPEC_DSF].u = filters[i & 1];
        k.program.spec[HL_SPEC_FILL].u = i >> 1 & 1;
        fill_random();
        bind(true);
        k.draw.view[HL_TEX_LIGHT].filter = HL_FILTER_LINEAR;
        fragments();
        k.program.spec[HL_SPEC_BILINEAR].u = 0;
        hl_pe_read_lights(&k.draw, &k.in, four);
        k.program.spec[HL_SPEC_BILINEAR].u = 1;
        hl_pe_read_lights(&k.draw, &k.in, out);
        for (uint32_t j = 0; j < k.in.n; j++) {
            struct pixel p = pixel_of(j);
            bool all = p.accept[0] + p.accept[1] + p.accept[2] + p.accept[3]
                       == 4;
            filtered += all;
            others += !all;
            for (int c = 0; c < 3; c++)
                ck_near(out[c][j], four[c][j],
                        all ? 40 * (3 + 2 * 13) / 8388608.0 : 0);
        }
    }
    assert_true(filtered > 10 && others > 10);
    kk_close(&k);
}

/* ---- the geometry pass --------------------------------------------------- */

static void geometry_keeps_to_its_pattern(void **state)
{
    (void)state;
    begin();
    for (uint32_t i = 0; i < 20; i++) {
        uint32_t side = i < 4 ? 2 : 4, p = i < 4 ? i : i - 4;
        hl_vec2 cell = hl_stipple_cell(p, side);
        k.program.spec[HL_SPEC_STIPPLE].u = side;
        k.object.flat_ids.z = (float)p;
        for (int s = 0; s < 2; s++) {
            fragments();
            kk_shade(&k, s ? HL_SHADER_STIPPLE_PLAIN_FRAG
                           : HL_SHADER_GBUFFER_PLAIN_FRAG);
            for (uint32_t j = 0; j < k.in.n; j++) {
                uint32_t x = (uint32_t)k.in.x[j], y = (uint32_t)k.in.y[j];
                bool own = x % side == (uint32_t)cell.x &&
                           y % side == (uint32_t)cell.y;
                assert_int_equal(k.in.discard[j], !own);
                if (s)
                    assert_true(k.in.color[0][0][j] ==
                                ((float)p + 1) / 255);
            }
        }
    }
    kk_close(&k);
}

/* Mask 2 drops what has not half a code of alpha, 1 what is below the cutoff;
 * stages that write nothing else, too. */
static void masks(void **state)
{
    const enum hl_shader stages[] = { HL_SHADER_GBUFFER_FULL_FRAG,
                                      HL_SHADER_STIPPLE_FULL_FRAG,
                                      HL_SHADER_MASK_FRAG };
    (void)state;
    begin();
    k.material.base = hl_v4(1, 1, 1, 1);
    k.material.params.w = 0.5f;
    for (uint32_t i = 0; i < 9; i++) {
        uint32_t mask = i / 3;
        k.program.spec[HL_SPEC_MASK].u = mask;
        fragments();
        for (uint32_t j = 0; j < k.in.n; j++)
            k.in.vary[HL_PE_A][j] = (float)j / (j < 64 ? 64 * 255 : 128);
        kk_shade(&k, stages[i % 3]);
        for (uint32_t j = 0; j < k.in.n; j++) {
            float least_alpha = mask == 0 ? 0 : mask == 1 ? 0.5f
                                : 0.5f / 255;
            assert_int_equal(k.in.discard[j],
                             k.in.vary[HL_PE_A][j] < least_alpha);
        }
    }
    kk_close(&k);
}

/* Of a decal only the normal is blended in, by its alpha. */
static void decals_write_normals_alone(void **state)
{
    (void)state;
    begin();
    k.material.base = hl_v4(1, 1, 1, 0.5f);
    k.program.spec[HL_SPEC_DECAL].u = 1;
    k.program.desc.n_colors = 3;
    for (int full = 0; full < 2; full++) {
        fragments();
        kk_shade(&k, full ? HL_SHADER_GBUFFER_FULL_EXP_FRAG
                          : HL_SHADER_GBUFFER_PLAIN_EXP_FRAG);
        for (uint32_t j = 0; j < k.in.n; j++) {
            float a = full ? 0.5f * k.in.vary[HL_PE_A][j] : 0.5f;
            assert_true(k.in.color[0][3][j] == a);
            assert_true(k.in.color[1][3][j] == 0);
            assert_true(k.in.color[2][3][j] == 0);
        }
    }
    kk_close(&k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_of_a_pattern),
        cmocka_unit_test(filled_pixels_of_opaque_surfaces),
        cmocka_unit_test(region_zero_takes_any),
        cmocka_unit_test(constant_light_stays),
        cmocka_unit_test(a_ramp_is_reconstructed),
        cmocka_unit_test(taps_leave_without_a_jump),
        cmocka_unit_test(a_wire_finds_its_sample),
        cmocka_unit_test(filtered_where_nothing_is_rejected),
        cmocka_unit_test(geometry_keeps_to_its_pattern),
        cmocka_unit_test(masks),
        cmocka_unit_test(decals_write_normals_alone),
    };
    return cmocka_run_group_tests_name("packemu filter", tests, NULL, NULL);
}
