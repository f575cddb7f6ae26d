/* SPDX-License-Identifier: Zlib */
/* EDRAM: tiles as the published rule counts them, targets placed so that
 * nothing in use is drawn over, and refusals that say what would fit. */
#include <string.h>
#include "tests/console_kit.h"

enum { LIMIT = 2048 };

/* ---- tiles -------------------------------------------------------------- */

/* spec/consoles 1.1; RGBA8 has 32 bits, RGBA16_FIXED32 64. */
static void tiles_are_the_published_ones(void **state)
{
    static const struct {
        uint32_t w, h, samples;
        enum hl_format format;
        uint64_t tiles;
    } rows[] = {
        { 1, 1, 1, HL_FORMAT_RGBA8_UNORM, 1 },
        { 80, 16, 4, HL_FORMAT_RGBA8_UNORM, 4 },
        { 80, 16, 1, HL_FORMAT_RGBA8_UNORM, 1 },
        { 81, 16, 1, HL_FORMAT_RGBA8_UNORM, 2 },
        { 80, 17, 1, HL_FORMAT_RGBA8_UNORM, 2 },
        { 256, 256, 1, HL_FORMAT_RGBA8_UNORM, 64 },
        { 800, 450, 1, HL_FORMAT_RG16_FIXED32, 290 },
        { 800, 450, 1, HL_FORMAT_RGBA16_FIXED32, 580 },
        { 960, 540, 1, HL_FORMAT_D24_FLOAT_S8, 408 },
        { 960, 540, 1, HL_FORMAT_RGBA16_FIXED32, 816 },
        { 1280, 720, 1, HL_FORMAT_RGB10A2_FLOAT, 720 },
        { 1280, 720, 2, HL_FORMAT_RGB10A2_FLOAT, 1440 },
        { 1280, 720, 4, HL_FORMAT_RGB10A2_FLOAT, 2880 },
        { 1280, 720, 1, HL_FORMAT_RGBA16_FIXED32, 1440 },
        { 640, 480, 4, HL_FORMAT_RGBA8_UNORM, 960 },
        { 1120, 720, 2, HL_FORMAT_RGBA8_UNORM, 1260 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (hl_edram_tiles(&hl_profile_xbox360, rows[i].format, rows[i].w,
                           rows[i].h, rows[i].samples) != rows[i].tiles)
            fail_msg("row %u", (unsigned)i);
    assert_true(hl_edram_tiles(&hl_profile_ps3, HL_FORMAT_RGBA8_UNORM, 800,
                               450, 1) == 0);
}

/* ---- lifetimes, told anew ----------------------------------------------- */

static bool bound(const struct hl_plan_pass *s, enum hl_role r)
{
    return s->depth == r || s->color[0] == r || s->color[1] == r ||
           s->color[2] == r;
}

/* In use at pass n: bound by it, or by one before and one after. Light depth
 * is kept through the light pass, which may test it. */
static bool in_use(const struct hl_plan *p, enum hl_role r, uint32_t n)
{
    bool before = false, after = false;
    for (uint32_t i = 0; i <= n; i++)
        before |= bound(&p->pass[i], r);
    for (uint32_t i = n; i < p->n_passes; i++)
        after |= bound(&p->pass[i], r) || (r == HL_ROLE_LIGHT_DEPTH &&
                                           p->pass[i].role == HL_PASS_LIGHT);
    return before && after;
}

static bool overlap(const struct hl_plan_target *a,
                    const struct hl_plan_target *b)
{
    uint32_t x = a->console.edram_tile, y = b->console.edram_tile;
    return x < y + b->edram_tiles && y < x + a->edram_tiles;
}

static bool g_buffer(enum hl_role r)
{
    return r == HL_ROLE_NORMAL || r == HL_ROLE_DSF || r == HL_ROLE_EXPONENT ||
           r == HL_ROLE_LIGHT_DEPTH;
}

/* The paper's rule, and that of no two in use. True: something is shared
 * among what the L-buffer's passes draw to. */
static bool check_pair(const struct hl_plan *p, uint32_t i, uint32_t j)
{
    const struct hl_plan_target *a = &p->target[i], *b = &p->target[j];
    if (!overlap(a, b))
        return false;
    for (uint32_t n = 0; n < p->n_passes; n++)
        assert_false(in_use(p, a->role, n) && in_use(p, b->role, n));
    assert_false(g_buffer(a->role) && g_buffer(b->role));
    assert_false((a->role == HL_ROLE_LIGHT &&
                  b->role == HL_ROLE_LIGHT_DEPTH) ||
                 (b->role == HL_ROLE_LIGHT && a->role == HL_ROLE_LIGHT_DEPTH));
    return (a->role == HL_ROLE_LIGHT && g_buffer(b->role)) ||
           (b->role == HL_ROLE_LIGHT && g_buffer(a->role));
}

/* Whether anything of the L-buffer's passes shares. */
static bool check_placed(const struct hl_plan *p, const struct hl_caps *c)
{
    bool shared = false;
    uint32_t most = 0, all = 0;
    for (uint32_t i = 0; i < p->n_targets; i++) {
        const struct hl_plan_target *t = &p->target[i];
        if (t->role == HL_ROLE_RESOLVED) {
            assert_true(t->console.edram_tile == 0 && t->edram_tiles == 0);
            continue;
        }
        assert_true(t->edram_tiles ==
                    hl_edram_tiles(&c->profile, t->format, t->width,
                                   t->height, t->samples));
        assert_true(t->console.edram_tile >= 1);
        assert_true(t->console.edram_tile - 1u + t->edram_tiles <=
                    c->profile.edram_tiles);
        all += g_buffer(t->role) || t->role == HL_ROLE_LIGHT ? t->edram_tiles
                                                             : 0;
        for (uint32_t j = 0; j < i; j++)
            if (p->target[j].console.edram_tile)
                shared |= check_pair(p, i, j);
    }
    for (uint32_t n = 0; n < p->n_passes; n++) {
        uint32_t sum = 0;
        for (uint32_t i = 0; i < p->n_targets; i++)
            if (in_use(p, p->target[i].role, n))
                sum += p->target[i].edram_tiles;
        most = sum > most ? sum : most;
    }
    assert_true(p->edram_tiles >= most);
    /* Shared where it must be, and nowhere else. */
    assert_true(shared == (all > c->profile.edram_tiles));
    return shared;
}

/* ---- needs -------------------------------------------------------------- */

static struct hl_needs some_needs(uint64_t *seed)
{
    struct hl_needs n = con_needs();
    n.width = 1 + mk_below(seed, 1600);
    n.height = 1 + mk_below(seed, 900);
    n.samples = 1u << mk_below(seed, 3);
    if (mk_below(seed, 2)) {
        n.light_width = 1 + mk_below(seed, 1300);
        n.light_height = 1 + mk_below(seed, 800);
    }
    n.specular = (enum hl_specular_need)mk_below(seed, 3);
    n.blended = mk_below(seed, 2);
    n.light_depth_bound = mk_below(seed, 2);
    n.light_path = (enum hl_light_path)mk_below(seed, 4);
    return n;
}

/* Tiles of the 32-bit targets of one size. */
static uint64_t each(const struct hl_caps *c, uint32_t w, uint32_t h,
                     uint32_t samples)
{
    return hl_edram_tiles(&c->profile, HL_FORMAT_RGBA8_UNORM, w, h, samples);
}

/* Whether sharing lets it fit: geometry's targets, light and its depth, the
 * frame's two. */
static bool could_fit(const struct hl_needs *n, const struct hl_caps *c,
                      uint32_t lw, uint32_t lh, bool inferred)
{
    uint64_t g = each(c, lw, lh, 1), limit = c->profile.edram_tiles;
    uint64_t geometry = n->specular == HL_NEED_EXPONENTS ? 4 * g : 3 * g;
    return 2 * each(c, n->width, n->height, n->samples) <= limit &&
           (!inferred || (geometry <= limit && 3 * g <= limit));
}

static void nothing_in_use_is_drawn_over(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    uint32_t placed = 0, shared = 0, refused = 0, fitted = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        struct hl_needs n = some_needs(&seed);
        struct hl_profile small = hl_profile_xbox360;
        struct hl_caps c;
        struct hl_plan p;
        enum hl_refusal why;
        if (mk_below(&seed, 2))
            small.edram_tiles = 1 + mk_below(&seed, 3000);
        /* Few tiles, where a frame fits and five eighths of it do not. */
        if (i % 2 == 0) {
            small.edram_tiles = 3 + mk_below(&seed, 30);
            n.width = 40 + mk_below(&seed, 250);
            n.height = 8 + mk_below(&seed, 60);
            n.samples = 1;
        }
        con_caps(&c, &small, true);
        enum hl_pipeline want = (enum hl_pipeline)(1 + mk_below(&seed, 3));
        bool inferred = want == HL_PIPELINE_INFERRED;
        enum hl_result r = hl_plan_make(&p, want, &n, &c, &why);
        if (r == HL_OK) {
            placed++;
            shared += check_placed(&p, &c);
            fitted += con_reason(&p, HL_WHY_LIGHT_SIZE_EDRAM) != NULL;
            assert_true(could_fit(&n, &c, p.light_width, p.light_height,
                                  inferred));
            continue;
        }
        refused++;
        assert_int_equal(why, HL_REFUSED_EDRAM);
        /* A size that was asked for, or any. */
        assert_false(could_fit(&n, &c, n.light_width ? n.light_width : 1,
                               n.light_width ? n.light_height : 1, inferred));
    }
    print_message("%u placed, %u shared, %u fitted, %u refused\n", placed,
                  shared, fitted, refused);
    assert_true(placed > 1000 && shared > 100 && fitted > 20 && refused > 100);
}

/* ---- sizes of the paper and of the specification ------------------------ */

static struct hl_plan at(uint32_t w, uint32_t h, bool memory)
{
    struct hl_needs n = con_needs();
    struct hl_caps c;
    con_caps(&c, &hl_profile_xbox360, memory);
    n.light_width = w;
    n.light_height = h;
    return con_plan(HL_PIPELINE_INFERRED, &n, &c);
}

static void check_reason(const struct hl_plan *p, enum hl_reason why, float a,
                         float b, float c, float d)
{
    const struct hl_plan_reason *r = con_reason(p, why);
    if (!r)
        fail_msg("reason %d is not there", (int)why);
    if (r->arg[0] != a || r->arg[1] != b || r->arg[2] != c || r->arg[3] != d)
        fail_msg("reason %d: %g %g %g %g", (int)why, (double)r->arg[0],
                 (double)r->arg[1], (double)r->arg[2], (double)r->arg[3]);
}

static void the_papers_size_shares_nothing(void **state)
{
    (void)state;
    struct hl_plan p = at(800, 450, true);
    check_reason(&p, HL_WHY_EDRAM_RESIDENT, 1450, LIMIT, 580, 290);
    check_reason(&p, HL_WHY_EDRAM_FRAME, 1440, LIMIT, 0, 0);
    assert_int_equal(p.edram_tiles, 1450);
    p = at(960, 540, true);
    check_reason(&p, HL_WHY_EDRAM_RESIDENT, 2040, LIMIT, 816, 408);
    assert_null(con_reason(&p, HL_WHY_EDRAM_SHARED));
    /* One tile a row more: 13 x 34 x 5 = 2210. */
    p = at(961, 540, true);
    check_reason(&p, HL_WHY_EDRAM_SHARED, 2210, LIMIT, 1326, 442);
    p = at(1200, 675, true);
    check_reason(&p, HL_WHY_EDRAM_SHARED, 3225, LIMIT, 1935, 645);
}

/* Console formats are counted, whatever stands in for them. */
static void stand_ins_are_counted_as_the_console(void **state)
{
    static const enum hl_role roles[] = {
        HL_ROLE_NORMAL, HL_ROLE_DSF, HL_ROLE_LIGHT_DEPTH, HL_ROLE_LIGHT,
        HL_ROLE_COLOR, HL_ROLE_DEPTH };
    (void)state;
    struct hl_plan a = at(800, 450, true), b = at(800, 450, false);
    static const struct hl_console none;
    for (size_t i = 0; i < sizeof roles / sizeof *roles; i++) {
        const struct hl_plan_target *t = hl_plan_target(&b, roles[i]);
        assert_int_equal(t->edram_tiles,
                         hl_plan_target(&a, roles[i])->edram_tiles);
        /* Elsewhere no texture is asked to be kept as a console does. */
        assert_memory_equal(&t->console, &none, sizeof none);
    }
    assert_int_equal(a.edram_tiles, b.edram_tiles);
}

static struct hl_plan refused(const struct hl_needs *n, enum hl_pipeline want,
                              bool memory)
{
    struct hl_caps c;
    struct hl_plan p;
    enum hl_refusal why;
    con_caps(&c, &hl_profile_xbox360, memory);
    assert_int_equal(hl_plan_make(&p, want, n, &c, &why),
                     HL_ERR_UNSUPPORTED);
    assert_int_equal(why, HL_REFUSED_EDRAM);
    return p;
}

static void what_is_too_large_is_refused_with_what_fits(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    n.light_width = 1280;
    n.light_height = 720;
    for (int memory = 0; memory < 2; memory++) {
        struct hl_plan p = refused(&n, HL_PIPELINE_INFERRED, memory);
        uint32_t surfaces = 0;
        for (uint32_t i = 0; i < p.n_reasons; i++)
            if (p.reason[i].why == HL_WHY_EDRAM_SURFACE) {
                surfaces++;
                assert_true(p.reason[i].arg[1] == 720);
            }
        assert_int_equal(surfaces, 3);
        check_reason(&p, HL_WHY_EDRAM_SUM, HL_PASS_GEOMETRY, 2160, LIMIT, 0);
        check_reason(&p, HL_WHY_EDRAM_FITS, 1200, 675, 1935, 0);
        check_reason(&p, HL_WHY_EDRAM_FITS_RESIDENT, 960, 540, 2040, 0);
        /* 1280 x 384: 16 x 24 tiles, three surfaces. */
        check_reason(&p, HL_WHY_EDRAM_TILING, 2, 1280, 384, 1152);
    }
    /* Not drawn forward behind the caller's back either. */
    struct hl_plan p = refused(&n, HL_PIPELINE_AUTO, true);
    check_reason(&p, HL_WHY_EDRAM_FITS, 1200, 675, 1935, 0);
    struct hl_caps c;
    con_caps(&c, &hl_profile_xbox360, true);
    con_plan(HL_PIPELINE_FORWARD, &n, &c);
    n.light_width = 1200;
    n.light_height = 675;
    con_plan(HL_PIPELINE_INFERRED, &n, &c);
    con_plan(HL_PIPELINE_AUTO, &n, &c);
}

/* 4 samples: 3 rectangles, 2 samples: 2, as the console's own library. */
static void a_multisampled_frame_needs_tiling(void **state)
{
    (void)state;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    con_caps(&c, &hl_profile_xbox360, true);
    for (int i = HL_PIPELINE_FORWARD; i < HL_PIPELINE_COUNT; i++) {
        n.samples = 4;
        struct hl_plan p = refused(&n, (enum hl_pipeline)i, true);
        check_reason(&p, HL_WHY_EDRAM_TILING, 3, 1280, 256, 2048);
        assert_null(con_reason(&p, HL_WHY_EDRAM_FITS));
        n.samples = 2;
        p = refused(&n, (enum hl_pipeline)i, true);
        check_reason(&p, HL_WHY_EDRAM_TILING, 2, 1280, 384, 1536);
        n.samples = 1;
        con_plan((enum hl_pipeline)i, &n, &c);
    }
    n.samples = 4;
    struct hl_plan p = refused(&n, HL_PIPELINE_AUTO, true);
    assert_non_null(con_reason(&p, HL_WHY_EDRAM_SUM));
}

/* 8 tiles: a frame of 160 x 32 fills them, five eighths of it are 100 x 20
 * and 4 tiles a surface; 80 x 16 is 1. */
static void a_size_of_the_planners_own_fits_by_itself(void **state)
{
    (void)state;
    struct hl_profile tiny = hl_profile_xbox360;
    struct hl_needs n = con_needs();
    struct hl_caps c;
    tiny.edram_tiles = 8;
    n.width = 160;
    n.height = 32;
    con_caps(&c, &tiny, true);
    struct hl_plan p = con_plan(HL_PIPELINE_INFERRED, &n, &c);
    assert_true(p.light_width == 80 && p.light_height == 16);
    check_reason(&p, HL_WHY_LIGHT_SIZE_EDRAM, 80, 16, 100, 20);
    assert_null(con_reason(&p, HL_WHY_LIGHT_SIZE_DEFAULT));
    n.light_width = 100;
    n.light_height = 20;
    struct hl_plan q;
    enum hl_refusal why;
    assert_int_equal(hl_plan_make(&q, HL_PIPELINE_INFERRED, &n, &c, &why),
                     HL_ERR_UNSUPPORTED);
    assert_int_equal(why, HL_REFUSED_EDRAM);
}

/* ---- proposals by brute force ------------------------------------------- */

static bool fits(const struct hl_caps *c, uint32_t w, uint32_t h)
{
    return 3 * each(c, w, h, 1) <= c->profile.edram_tiles;
}

static void the_proposed_size_is_the_largest(void **state)
{
    (void)state;
    uint64_t seed = mk_seed();
    struct hl_caps c;
    con_caps(&c, &hl_profile_xbox360, true);
    for (int i = 0; i < 500; i++) {
        struct hl_needs n = con_needs();
        struct hl_plan p;
        n.light_width = 400 + mk_below(&seed, 4000);
        n.light_height = 400 + mk_below(&seed, 4000);
        if (hl_plan_make(&p, HL_PIPELINE_INFERRED, &n, &c, NULL) == HL_OK)
            continue;
        uint32_t h = n.light_height, w;
        do {
            h--;
            w = (uint32_t)(((uint64_t)h * n.light_width +
                            n.light_height / 2) / n.light_height);
        } while (!fits(&c, w, h));
        const struct hl_plan_reason *r = con_reason(&p, HL_WHY_EDRAM_FITS);
        assert_true(r->arg[0] == (float)w && r->arg[1] == (float)h);
        r = con_reason(&p, HL_WHY_EDRAM_TILING);
        assert_true(r->arg[3] <= LIMIT);
        /* Fewer rectangles could not hold what there is. */
        uint64_t whole = 3 * each(&c, n.light_width, n.light_height, 1);
        assert_true((double)r->arg[0] * LIMIT >= (double)whole);
        double area = (double)r->arg[0] * (double)r->arg[1] *
                      (double)r->arg[2];
        assert_true(area >= (double)n.light_width * n.light_height);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tiles_are_the_published_ones),
        cmocka_unit_test(nothing_in_use_is_drawn_over),
        cmocka_unit_test(the_papers_size_shares_nothing),
        cmocka_unit_test(stand_ins_are_counted_as_the_console),
        cmocka_unit_test(what_is_too_large_is_refused_with_what_fits),
        cmocka_unit_test(a_multisampled_frame_needs_tiling),
        cmocka_unit_test(a_size_of_the_planners_own_fits_by_itself),
        cmocka_unit_test(the_proposed_size_is_the_largest),
    };
    return cmocka_run_group_tests_name("edram", tests, NULL, NULL);
}
