/* SPDX-License-Identifier: Zlib */
/* Coverage. Within a bin an edge function is stepped in whole pixels, so it
 * is kept floored by a pixel's step, which changes no sign; each edge then
 * cuts every row's span at an end that integers confirm. */
#include <string.h>
#include "platforms/packemu/pe_pass.h"

enum { ROWS = PE_BIN, LANES = 4 };   /* rows are worked on LANES at a time   */

/* Part of a bin, in pixels of the target. */
struct window { int32_t x0, y0, w, h; };
struct edge { int32_t e, a, b; };    /* e at the window's first pixel        */
struct spans { int32_t low[ROWS], high[ROWS]; };

/* ---- edges --------------------------------------------------------------- */

/* floor(v / 256) of numbers of either sign. */
static int64_t floor_pixels(int64_t v)
{
    return v >= 0 ? v >> PE_SUB_BITS : -((-v + PE_SUB - 1) >> PE_SUB_BITS);
}

/* The edge from p to q, at the sample (sx, sy), 1/16 pixel off the centre.
 * Top and left edges are inside, others not: y goes down, the inside is on
 * the right hand. False: the window lies outside. e is limited to what
 * |a| (w - 1) + |b| (h - 1) < 2^30 can cross. */
static bool edge_at(struct edge *o, const union pe_word *p,
                    const union pe_word *q, const struct window *win,
                    int32_t sx, int32_t sy)
{
    const int64_t most = (int64_t)1 << 30;
    int32_t a = p[PE_V_Y].i - q[PE_V_Y].i, b = q[PE_V_X].i - p[PE_V_X].i;
    int32_t x = win->x0 * PE_SUB + PE_SUB / 2 + sx * (PE_SUB / 16);
    int32_t y = win->y0 * PE_SUB + PE_SUB / 2 + sy * (PE_SUB / 16);
    bool inclusive = a > 0 || (a == 0 && b > 0);
    int64_t e = (int64_t)a * (x - p[PE_V_X].i) +
                (int64_t)b * (y - p[PE_V_Y].i) - !inclusive;
    e = floor_pixels(e);
    if (e < -most)
        return false;
    o->e = (int32_t)(e > most ? most : e);
    o->a = e > most ? 0 : a;
    o->b = e > most ? 0 : b;
    return o->e + (a > 0 ? o->a * (win->w - 1) : 0) +
           (b > 0 ? o->b * (win->h - 1) : 0) >= 0;
}

static bool holds_window(const struct edge *g, const struct window *win)
{
    return g->e + (g->a < 0 ? g->a * (win->w - 1) : 0) +
           (g->b < 0 ? g->b * (win->h - 1) : 0) >= 0;
}

/* First pixel of each row that is inside an edge with a > 0. The quotient of
 * floats is right or, off by their rounding, up to two too small. */
static void cut_low(struct spans *s, const struct edge *g,
                    const struct window *win)
{
    float inv = 1.0f / (float)g->a, most = (float)win->w;
    for (int32_t j = 0; j < win->h; j += LANES)
        for (int32_t k = j; k < j + LANES; k++) {
            int32_t e = g->e + g->b * k;
            float f = -(float)e * inv;
            f = f > 0.0f ? f : 0.0f;
            f = f < most ? f : most;
            int32_t q = (int32_t)f;
            q += e + g->a * q < 0;
            q += e + g->a * q < 0;
            s->low[k] = q > s->low[k] ? q : s->low[k];
        }
}

/* Last pixel of each row that is inside an edge with a < 0; the quotient may
 * be one off either way. */
static void cut_high(struct spans *s, const struct edge *g,
                     const struct window *win)
{
    int32_t a = -g->a;
    float inv = 1.0f / (float)a, most = (float)win->w;
    for (int32_t j = 0; j < win->h; j += LANES)
        for (int32_t k = j; k < j + LANES; k++) {
            int32_t e = g->e + g->b * k;
            float f = (float)e * inv;
            f = f > -1.0f ? f : -1.0f;
            f = f < most ? f : most;
            int32_t q = (int32_t)f;
            q -= e - a * q < 0;
            q += e - a * (q + 1) >= 0;
            s->high[k] = q < s->high[k] ? q : s->high[k];
        }
}

static void cut_rows(struct spans *s, const struct edge *g,
                     const struct window *win)
{
    for (int32_t k = 0; k < win->h; k++)
        if (g->e + g->b * k < 0)
            s->high[k] = -1;
}

static void whole(struct spans *s, const struct window *win)
{
    for (int32_t j = 0; j < win->h; j += LANES)
        for (int32_t k = j; k < j + LANES; k++) {
            s->low[k] = 0;
            s->high[k] = win->w - 1;
        }
}

/* Rows of a triangle's coverage at one sample position; false: none. */
static bool cover(struct spans *s, const union pe_word *const v[3],
                  const struct window *win, int32_t sx, int32_t sy)
{
    struct edge g[3];
    for (int i = 0; i < 3; i++)
        if (!edge_at(&g[i], v[i], v[i < 2 ? i + 1 : 0], win, sx, sy))
            return false;
    whole(s, win);
    for (int i = 0; i < 3; i++) {
        if (holds_window(&g[i], win))
            continue;
        if (g[i].a > 0)
            cut_low(s, &g[i], win);
        else if (g[i].a < 0)
            cut_high(s, &g[i], win);
        else
            cut_rows(s, &g[i], win);
    }
    return true;
}

/* ---- planes -------------------------------------------------------------- */

/* From vertex 0 to vertex i along one axis, pixels, as snapped. */
static double side(const union pe_word *const v[3], int i, int word)
{
    return (v[i][word].i - v[0][word].i) * (1.0 / PE_SUB);
}

/* What the snapping of both ends took from it. */
static double rest(const union pe_word *const v[3], int i, int word)
{
    return (double)v[i][word].f - (double)v[0][word].f;
}

/* Planes through the vertices as they were, coverage by the snapped ones, so
 * that what is interpolated is not shifted by up to 1/512 of a pixel. A sliver
 * to whose area snapping did much has planes through the snapped vertices:
 * its own might be arbitrarily steep. In double, whose products of these
 * numbers are all but exact. */
static void set_slopes(struct pe_tri *t, const union pe_word *const v[3])
{
    double x1 = side(v, 1, PE_V_X), y1 = side(v, 1, PE_V_Y);
    double x2 = side(v, 2, PE_V_X), y2 = side(v, 2, PE_V_Y);
    double snapped = x1 * y2 - x2 * y1;
    double u1 = x1 + rest(v, 1, PE_V_RX), w1 = y1 + rest(v, 1, PE_V_RY);
    double u2 = x2 + rest(v, 2, PE_V_RX), w2 = y2 + rest(v, 2, PE_V_RY);
    double area = u1 * w2 - u2 * w1;
    t->snapped = !(area > 0.5 * snapped && area < 2.0 * snapped);
    if (!t->snapped) {
        x1 = u1;
        y1 = w1;
        x2 = u2;
        y2 = w2;
        snapped = area;
    }
    double inv = 1.0 / snapped;
    t->c1x = y2 * inv;
    t->c2x = -y1 * inv;
    t->c1y = -x2 * inv;
    t->c2y = x1 * inv;
}

static int32_t low_pixel(const union pe_word *const v[3], int word,
                         int32_t bin)
{
    int32_t a = v[0][word].i, b = v[1][word].i, c = v[2][word].i;
    a = a < b ? a : b;
    a = a < c ? a : c;
    int32_t pixel = (int32_t)floor_pixels(a);
    return pixel > bin ? pixel - bin : 0;
}

static void set_anchor(struct pe_tri *t, const union pe_word *const v[3],
                       const struct hl_rect *bin, bool back)
{
    const double px = 1.0 / PE_SUB;
    for (int i = 0; i < 3; i++)
        t->v[i] = v[i];
    t->ax = low_pixel(v, PE_V_X, bin->x);
    t->ay = low_pixel(v, PE_V_Y, bin->y);
    t->x = (double)(bin->x + t->ax) - v[0][PE_V_X].i * px;
    t->y = (double)(bin->y + t->ay) - v[0][PE_V_Y].i * px;
    if (!t->snapped) {
        t->x -= (double)v[0][PE_V_RX].f;
        t->y -= (double)v[0][PE_V_RY].f;
    }
    t->back = back;
    double z0 = (double)v[0][PE_V_Z].f;
    double d1 = (double)v[1][PE_V_Z].f - z0, d2 = (double)v[2][PE_V_Z].f - z0;
    double zx = d1 * t->c1x + d2 * t->c2x, zy = d1 * t->c1y + d2 * t->c2y;
    t->z = (float)(z0 + zx * t->x + zy * t->y);
    t->zx = (float)zx;
    t->zy = (float)zy;
}

/* ---- fragments ----------------------------------------------------------- */

/* Room for one more row. */
static void make_room(struct pe_bin *b, const struct pe_tri *t)
{
    if (b->raw.n <= PE_RAW - PE_BIN)
        return;
    pe_raw_flush(b);
    pe_raw_begin(b, t);
}

/* Pixels x0..x1 of the bin's row y. dx + i is exact, so that a pixel's depth
 * does not depend on where its row begins. */
static void add_row(struct pe_bin *b, const struct pe_tri *t, int32_t y,
                    int32_t x0, int32_t x1)
{
    uint32_t at = (uint32_t)(y * PE_BIN + x0), m = (uint32_t)(x1 - x0 + 1);
    float dx = (float)(x0 - t->ax) + 0.5f, dy = (float)(y - t->ay) + 0.5f;
    float z = t->z + t->zy * dy, zx = t->zx;
    uint16_t *restrict to = b->raw.at + b->raw.n;
    float *restrict to_z = b->raw.z + b->raw.n;
    for (uint32_t j = 0; j < m; j += PE_LANES8)
        for (uint32_t i = j; i < j + PE_LANES8; i++) {
            to[i] = (uint16_t)(at + i);
            to_z[i] = z + zx * (dx + (float)(int32_t)i);
        }
    b->raw.n += m;
}

static void emit(struct pe_bin *b, const struct pe_tri *t,
                 const struct spans *s, const struct window *win)
{
    int32_t x = win->x0 - b->rect.x, y = win->y0 - b->rect.y;
    pe_raw_begin(b, t);
    for (int32_t k = 0; k < win->h; k++) {
        if (s->low[k] > s->high[k])
            continue;
        make_room(b, t);
        add_row(b, t, y + k, x + s->low[k], x + s->high[k]);
    }
}

/* A row's pixels with the samples that each covers. */
static void emit_samples(struct pe_bin *b, const struct pe_tri *t,
                         const struct spans *s, const bool *any,
                         const struct window *win)
{
    int32_t x = win->x0 - b->rect.x, y = win->y0 - b->rect.y;
    pe_raw_begin(b, t);
    for (int32_t k = 0; k < win->h; k++) {
        int32_t low = win->w, high = -1;
        for (uint32_t i = 0; i < b->samples; i++) {
            if (!any[i] || s[i].low[k] > s[i].high[k])
                continue;
            low = s[i].low[k] < low ? s[i].low[k] : low;
            high = s[i].high[k] > high ? s[i].high[k] : high;
        }
        if (low > high)
            continue;
        make_room(b, t);
        uint8_t *c = b->raw.cover + b->raw.n;
        add_row(b, t, y + k, x + low, x + high);
        memset(c, 0, (size_t)(high - low + 1));
        for (uint32_t i = 0; i < b->samples; i++)
            if (any[i])
                for (int32_t p = s[i].low[k]; p <= s[i].high[k]; p++)
                    c[p - low] = (uint8_t)(c[p - low] | 1u << i);
    }
}

static void emit_all(struct pe_bin *b, const struct pe_tri *t,
                     const struct spans *s, const bool *any,
                     const struct window *win)
{
    if (b->samples == 1)
        emit(b, t, s, win);
    else
        emit_samples(b, t, s, any, win);
}

static void raster_triangle(struct pe_bin *b, const struct pe_tri *t,
                            const struct window *win)
{
    struct spans s[PE_MAX_SAMPLES];
    bool any[PE_MAX_SAMPLES], some = false;
    uint32_t level = b->samples == 8 ? 3 : b->samples / 2;
    for (uint32_t i = 0; i < b->samples; i++) {
        any[i] = cover(&s[i], t->v, win, pe_sample_at[level][i][0],
                       pe_sample_at[level][i][1]);
        some |= any[i];
    }
    if (some)
        emit_all(b, t, s, any, win);
}

/* ---- lines --------------------------------------------------------------- */

/* floor(a / b), b > 0. */
static int64_t floor_div(int64_t a, int64_t b)
{
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/* One pixel a column (or row, where the line is steeper): the one that holds
 * the line at the column's centre. The centres lie in [start, end), so that
 * lines joined end to start cover nothing twice. All samples are covered, and
 * attributes run along the column's axis alone. */
static void raster_line(struct pe_bin *b, struct pe_tri *t,
                        const struct window *win)
{
    int32_t m = PE_V_X, o = PE_V_Y;
    const union pe_word *p = t->v[0], *q = t->v[1];
    int64_t dx = q[PE_V_X].i - p[PE_V_X].i, dy = q[PE_V_Y].i - p[PE_V_Y].i;
    if ((dx < 0 ? -dx : dx) < (dy < 0 ? -dy : dy)) {
        m = PE_V_Y;
        o = PE_V_X;
    }
    bool steep = m == PE_V_Y;
    int64_t run = steep ? dy : dx, rise = steep ? dx : dy;
    int32_t first = steep ? win->y0 : win->x0;
    int32_t n = steep ? win->h : win->w;
    for (int32_t i = first; i < first + n; i++) {
        int64_t along = (int64_t)i * PE_SUB + PE_SUB / 2 - p[m].i;
        if (run < 0 ? along > 0 || along <= run : along < 0 || along >= run)
            continue;
        int64_t across = (p[o].i * run + along * rise) * (run < 0 ? -1 : 1);
        int64_t at = floor_div(across, (run < 0 ? -run : run) * PE_SUB);
        int64_t x = steep ? at : i, y = steep ? i : at;
        if (x < win->x0 || x >= win->x0 + win->w || y < win->y0 ||
            y >= win->y0 + win->h)
            continue;
        make_room(b, t);
        b->raw.cover[b->raw.n] = (uint8_t)((1u << b->samples) - 1);
        add_row(b, t, (int32_t)y - b->rect.y, (int32_t)x - b->rect.x,
                (int32_t)x - b->rect.x);
    }
}

static void line_slopes(struct pe_tri *t, const union pe_word *const v[3])
{
    double x = (v[1][PE_V_X].i - v[0][PE_V_X].i) * (1.0 / PE_SUB);
    double y = (v[1][PE_V_Y].i - v[0][PE_V_Y].i) * (1.0 / PE_SUB);
    bool steep = (x < 0 ? -x : x) < (y < 0 ? -y : y);
    t->c1x = steep || x == 0 ? 0 : 1 / x;
    t->c1y = steep ? 1 / y : 0;
    t->c2x = t->c2y = 0;
    t->snapped = true;
}

/* ---- records ------------------------------------------------------------- */

static const union pe_word screen_vertex[PE_V_VARY + HL_PE_VARY_COUNT] = {
    [PE_V_Z] = { .f = 0.5f }, [PE_V_IW] = { .f = 1.0f }
};

/* screen.vert: depth 0.5, w 1, everywhere. */
static void raster_screen(struct pe_bin *b, const struct window *win)
{
    static const union pe_word *const v[3] = { screen_vertex, screen_vertex,
                                               screen_vertex };
    struct pe_tri t = { .c1x = 0 };
    struct hl_rect r = { win->x0, win->y0, win->w, win->h };
    struct spans s[PE_MAX_SAMPLES];
    static const bool all[PE_MAX_SAMPLES] = { true, true, true, true,
                                              true, true, true, true };
    if (!b->stage && !b->tests)
        return;
    if (b->draw->program->fragment.rect && !b->tests && b->samples == 1 &&
        !b->stage->discards) {
        pe_rect_run(b, &r);
        return;
    }
    set_anchor(&t, v, &b->rect, false);
    whole(&s[0], win);
    for (uint32_t i = 1; i < b->samples; i++)
        s[i] = s[0];
    emit_all(b, &t, s, all, win);
}

static bool window_of(struct window *win, const struct hl_rect *bin,
                      const struct pe_record *r)
{
    int32_t x1 = bin->x + bin->width - 1, y1 = bin->y + bin->height - 1;
    win->x0 = r->x0 > bin->x ? r->x0 : bin->x;
    win->y0 = r->y0 > bin->y ? r->y0 : bin->y;
    win->w = (r->x1 < x1 ? r->x1 : x1) - win->x0 + 1;
    win->h = (r->y1 < y1 ? r->y1 : y1) - win->y0 + 1;
    return win->w > 0 && win->h > 0;
}

void pe_raster_record(struct pe_bin *b, const struct pe_chunk *c,
                      const struct pe_record *r)
{
    const struct pe_program *p = b->draw->program;
    const union pe_word *const v[3] = { c->words + r->v[0],
                                        c->words + r->v[1],
                                        c->words + r->v[2] };
    struct window win;
    struct pe_tri t;
    if (!window_of(&win, &b->rect, r))
        return;
    if (!p->vertex->run) {
        raster_screen(b, &win);
        return;
    }
    if (p->desc.topology == HL_TOPOLOGY_LINES) {
        line_slopes(&t, v);
        set_anchor(&t, v, &b->rect, false);
        pe_raw_begin(b, &t);
        raster_line(b, &t, &win);
        return;
    }
    set_slopes(&t, v);
    set_anchor(&t, v, &b->rect, (r->draw & PE_BACK) != 0);
    raster_triangle(b, &t, &win);
}
