/* SPDX-License-Identifier: Zlib */
/* A chart that was laid out, as gnuplot's script. Hues are those of Okabe and
 * Ito's palette, which most colour-blind readers tell apart; a group has a
 * mark of its own shape besides. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "platforms/chart/plot_parts.h"

enum { ROW = 19 };

static const struct { int open, filled; const char *hue; } marks[] = {
    { 6, 7, "#0072b2" }, { 4, 5, "#d55e00" }, { 8, 9, "#009e73" },
    { 12, 13, "#cc79a7" }, { 10, 11, "#e69f00" }, { 14, 15, "#56b4e9" },
    { 6, 7, "#4d4d4d" }, { 4, 5, "#8c6d31" }
};
enum { MARKS = sizeof marks / sizeof *marks };

struct style { const char *align; double size; const char *hue; };
static const struct style heading = { "left", 17, "#111111" };
static const struct style note = { "left", 11, "#555555" };
static const struct style plain = { "left", 12, "#333333" };
static const struct style on_front = { "center", HLT_WORD_SIZE, "#222222" };
static const struct style key_name = { "left", 11, "#222222" };
static const struct style key_value = { "right", 11, "#222222" };

/* ---- text --------------------------------------------------------------- */

/* In gnuplot's quotes, where a quote is doubled. Titles have names of files in
 * them: a line's end, or a backslash before the last quote, would end it. */
static void quote(struct hlh_buffer *b, const char *text)
{
    hlh_buffer_add(b, "'", 1);
    for (const char *p = text; *p; p++) {
        unsigned char u = (unsigned char)*p;
        char c = u < 0x20 || u == 0x7f ? '?' : *p == '\\' ? '/' : *p;
        hlh_buffer_add(b, &c, 1);
        if (c == '\'')
            hlh_buffer_add(b, &c, 1);
    }
    hlh_buffer_add(b, "'", 1);
}

static void words_at(struct hlh_buffer *b, double x, double y,
                     const struct style *s, const char *text)
{
    hlh_buffer_print(b, "set label ");
    quote(b, text);
    hlh_buffer_print(b, " at screen %.5f,%.5f %s noenhanced front font ',%g' "
                     "tc rgb '%s'\n", x / HLT_WIDTH, y / HLT_HEIGHT, s->align,
                     s->size, s->hue);
}

static const char *axis_name(enum hlt_column c)
{
    switch (c) {
    case HLT_COST: return "cost by counted work, ns a pixel";
    case HLT_MOVED: return "bytes read and written a pixel";
    case HLT_RATIO: return "time of a frame over that of inferred 5/8";
    case HLT_LIGHTS: return "light evaluations a pixel";
    case HLT_PSNR: return "error as PSNR, dB (nearer is lower)";
    case HLT_RELMSE: return "error: relMSE";
    case HLT_MAX: return "largest error, linear";
    case HLT_P999: return "error that 99.9 % do not exceed, linear";
    case HLT_EDGE: return "mean error at edges of objects, linear";
    case HLT_FLIP: return "error: FLIP, mean";
    case HLT_FLIP_P99: return "error: FLIP that 99 % do not exceed";
    case HLT_SSIM: return "error: 1 - SSIM";
    case HLT_FLICKER: return "flicker: change of the error a frame, linear";
    case HLT_CODES: return "error: RMS of 8-bit sRGB codes";
    default: return hlt_column_name(c);
    }
}

/* ---- frame -------------------------------------------------------------- */

static void tics(struct hlh_buffer *b, char which, const struct hlt_axis *a)
{
    hlh_buffer_print(b, "set %crange [%.9g:%.9g]\nset %ctics nomirror out "
                     "scale 0.4 font ',12' tc rgb '#444444' (", which, a->low,
                     a->high, which);
    for (uint32_t i = 0; i < a->n; i++)
        hlh_buffer_print(b, "%s'%s' %.9g", i ? ", " : "", a->text[i],
                         a->tick[i]);
    hlh_buffer_print(b, ")\n");
}

static void frame(struct hlh_buffer *b, const struct hlt_chart *c,
                  const char *title)
{
    double top = HLT_HEIGHT - HLT_TOP;
    hlh_buffer_print(b, "set lmargin at screen %.5f\nset rmargin at screen "
                     "%.5f\nset bmargin at screen %.5f\nset tmargin at screen "
                     "%.5f\n", (double)HLT_LEFT / HLT_WIDTH,
                     c->right / HLT_WIDTH, (double)HLT_BOTTOM / HLT_HEIGHT,
                     top / HLT_HEIGHT);
    hlh_buffer_print(b, "set logscale xy\nset key off\nset errorbars 0.5\n"
                     "set border 3 lc rgb '#888888' lw 1\n"
                     "set grid back lc rgb '#e4e4e4' lt 1 lw 1\n");
    tics(b, 'x', &c->x);
    tics(b, 'y', &c->y);
    words_at(b, HLT_LEFT, HLT_HEIGHT - 26, &heading, title);
    words_at(b, HLT_LEFT, HLT_HEIGHT - 50, &note,
             "Filled: no other way is both cheaper and nearer to the "
             "reference. Grey: some way is. k/8: inferred, lit at k/8 of a "
             "side.");
    struct style name = { "center", 13, "#333333" };
    words_at(b, (HLT_LEFT + c->right) / 2, 40, &name, axis_name(c->cost));
    name.align = "center rotate by 90";
    words_at(b, 22, (HLT_BOTTOM + top) / 2, &name, axis_name(c->error));
}

static void mark_at(struct hlh_buffer *b, double x, double y, uint32_t g)
{
    hlh_buffer_print(b, "set label '' at screen %.5f,%.5f point pt %d ps 0.7 "
                     "lc rgb '%s' front\n", x / HLT_WIDTH, y / HLT_HEIGHT,
                     marks[g % MARKS].filled, marks[g % MARKS].hue);
}

static void legend(struct hlh_buffer *b, const struct hlt_chart *c)
{
    double x = HLT_LEFT, y = HLT_HEIGHT - 75;
    for (uint32_t g = 0; g < c->n_groups; g++) {
        double wide = 34 + hlt_text_width(c->group[g], plain.size);
        if (!c->used[g])
            continue;
        if (x > HLT_LEFT && x + wide > HLT_WIDTH) {
            x = HLT_LEFT;
            y -= ROW;
        }
        mark_at(b, x + 6, y, g);
        words_at(b, x + 16, y, &plain, c->group[g]);
        x += wide;
    }
}

/* How many of the names that follow there is room for. */
static bool fits(const struct hlh_buffer *text, const char *more)
{
    char line[512];
    snprintf(line, sizeof line, "%.*s, %s and 99 more", (int)text->size,
             text->bytes ? text->bytes : "", more);
    return hlt_text_width(line, note.size) < HLT_WIDTH - HLT_LEFT;
}

/* What lies beyond the axes, below the chart. */
static void beyond(struct hlh_buffer *b, const struct hlt_chart *c)
{
    struct hlh_buffer text = { NULL, 0, 0, false };
    uint32_t more = 0, shown = 0;
    for (uint32_t i = 0; i < c->n; i++) {
        char name[HLT_NAME];
        if (!hlt_is_beyond(c, &c->point[i]))
            continue;
        hlt_short_name(name, c->point[i].row->way);
        if (more || !fits(&text, name))
            more++;
        else
            hlh_buffer_print(&text, "%s%s (%.4g)", shown++ ? ", " :
                             "Beyond the axes, with cost: ", name,
                             c->point[i].cost);
    }
    if (more)
        hlh_buffer_print(&text, " and %u more", (unsigned)more);
    hlh_buffer_add(&text, "", 1);
    if (shown && !text.failed)
        words_at(b, HLT_LEFT, 14, &note, text.bytes);
    b->failed = b->failed || text.failed;
    hlh_buffer_free(&text);
}

/* ---- words on the front ------------------------------------------------- */

static void leader(struct hlh_buffer *b, const struct hlt_label *l)
{
    hlh_buffer_print(b, "set arrow from screen %.5f,%.5f to screen %.5f,%.5f "
                     "nohead front lc rgb '#a0a0a0' lw 0.7\n",
                     l->x / HLT_WIDTH, l->y / HLT_HEIGHT,
                     l->near_x / HLT_WIDTH, l->near_y / HLT_HEIGHT);
}

static void words_on_front(struct hlh_buffer *b, const struct hlt_chart *c)
{
    for (uint32_t i = 0; i < c->n_words; i++) {
        const struct hlt_label *l = &c->label[i];
        if (!l->placed)
            continue;
        if (l->leader)
            leader(b, l);
        words_at(b, (l->box.x0 + l->box.x1) / 2, (l->box.y0 + l->box.y1) / 2,
                 &on_front, c->word[i].text);
    }
}

/* What fits into a width, with two dots where something is left out. */
static void cut(char text[HLT_NAME], double width, double size)
{
    size_t n = strlen(text);
    while (n > 3 && hlt_text_width(text, size) > width) {
        n--;
        memcpy(text + n - 2, "..", 3);
    }
}

static void error_text(char out[32], const struct hlt_chart *c,
                       const struct hlt_point *p)
{
    if (p->error <= hlt_error_floor(c->error))
        snprintf(out, 32, "0");
    else if (c->error == HLT_PSNR)
        snprintf(out, 32, "%.2f dB", -20 * log10(p->error));
    else
        snprintf(out, 32, "%.3g", p->error);
}

/* Beside the chart: number, name, error. As many as there is room for. */
static void key(struct hlh_buffer *b, const struct hlt_chart *c)
{
    double top = HLT_HEIGHT - HLT_TOP - 8, room = top - HLT_BOTTOM + 40;
    double row = room / (c->n_words + 1);
    double left = c->right + 16, right = HLT_WIDTH - 12;
    row = row > ROW ? ROW : row < 13 ? 13 : row;
    for (uint32_t i = 0; i < c->n_words && (i + 1) * row < room; i++) {
        double y = top - i * row;
        char name[HLT_NAME], text[32];
        const struct hlt_word *w = &c->word[i];
        error_text(text, c, w->point);
        hlt_short_name(name, w->point->row->way);
        if (w->equal && strlen(name) + 8 < sizeof name)
            sprintf(name + strlen(name), " =%u", (unsigned)w->equal % 1000 + 1);
        cut(name, right - left - 88, key_name.size);
        words_at(b, left + 16, y, &key_value, w->text);
        words_at(b, left + 24, y, &key_name, name);
        words_at(b, right, y, &key_value, text);
    }
}

/* ---- data --------------------------------------------------------------- */

/* Points of a group, on the front or behind it; how many. */
static uint32_t points(struct hlh_buffer *b, const struct hlt_chart *c,
                       uint32_t g, bool front)
{
    uint32_t n = 0;
    hlh_buffer_print(b, "$p%u%u << EOD\n", (unsigned)g, front);
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        if (p->front != front || hlt_is_beyond(c, p) ||
            hlt_group_of(c, p->row->group) != g)
            continue;
        double error = p->error <= hlt_error_floor(c->error) ? c->y.zero
                                                             : p->error;
        hlh_buffer_print(b, "%.9g %.9g %.9g %.9g\n", p->cost, error, p->low,
                         p->high);
        n++;
    }
    hlh_buffer_print(b, "EOD\n");
    return n;
}

/* Between what the front beats and what it does not. */
static void stairs(struct hlh_buffer *b, const struct hlt_chart *c)
{
    double above = c->y.high;
    hlh_buffer_print(b, "$stairs << EOD\n");
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        if (!p->front || hlt_is_beyond(c, p))
            continue;
        double error = p->error <= hlt_error_floor(c->error) ? c->y.zero
                                                             : p->error;
        hlh_buffer_print(b, "%.9g %.9g\n%.9g %.9g\n", p->cost, above, p->cost,
                         error);
        above = error;
    }
    hlh_buffer_print(b, "%.9g %.9g\nEOD\n", c->x.high, above);
}

static void draw_group(struct hlh_buffer *b, const struct hlt_chart *c,
                       uint32_t g, bool front)
{
    const char *hue = front ? marks[g % MARKS].hue : "#909090";
    if (c->bars && front)
        hlh_buffer_print(b, ", $p%u%u using 1:2:3:4 with xerrorbars pt 0 lc "
                         "rgb '%s' lw 1", (unsigned)g, front, hue);
    hlh_buffer_print(b, ", $p%u%u using 1:2 with points pt %d ps %s lc rgb "
                     "'%s' lw 1", (unsigned)g, front,
                     front ? marks[g % MARKS].filled : marks[g % MARKS].open,
                     front ? "0.75" : "0.55", hue);
}

static void plot(struct hlh_buffer *b, const struct hlt_chart *c)
{
    uint32_t n[HLT_GROUPS][2];
    stairs(b, c);
    for (uint32_t g = 0; g < c->n_groups; g++)
        for (int front = 0; front < 2; front++)
            n[g][front] = points(b, c, g, front);
    hlh_buffer_print(b, "plot $stairs with filledcurves y1=%.9g fs "
                     "transparent solid 0.35 fc rgb '#dbe5f0', $stairs with "
                     "lines lc rgb '#8a9cae' lw 1.3", c->y.high);
    for (int front = 0; front < 2; front++)
        for (uint32_t g = 0; g < c->n_groups; g++)
            if (n[g][front] > 0)
                draw_group(b, c, g, front);
    hlh_buffer_print(b, "\n");
}

void hlt_plot_script(struct hlh_buffer *b, const struct hlt_chart *c,
                     const char *title)
{
    frame(b, c, title);
    legend(b, c);
    beyond(b, c);
    words_on_front(b, c);
    if (c->numbered)
        key(b, c);
    plot(b, c);
}
