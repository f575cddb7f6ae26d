/* SPDX-License-Identifier: Zlib */
/* A row's curves as one small chart: limit dashed, boundary marked, expected
 * range shaded. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include "platforms/cli/gnuplot.h"
#include "platforms/host/util.h"
#include "platforms/stability/parts.h"

/* Okabe and Ito's, told apart by colour blind readers too. */
static const char *const colors[] = { "#0072b2", "#d55e00", "#009e73",
    "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31" };
enum { COLORS = sizeof colors / sizeof *colors };

/* In gnuplot's double quotes. */
static void quote(struct hlh_buffer *b, const char *text)
{
    hlh_buffer_add(b, "\"", 1);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\')
            hlh_buffer_add(b, "\\", 1);
        hlh_buffer_add(b, text, 1);
    }
    hlh_buffer_add(b, "\"", 1);
}

static void data(struct hlh_buffer *b, const struct hls_result *r, uint32_t k)
{
    hlh_buffer_print(b, "$c%u << END\n", k);
    for (uint32_t i = 0; i < r->n; i++)
        if (isfinite(r->m[i]))
            hlh_buffer_print(b, "%.9g %.9g\n", r->p[i], r->m[i]);
        else
            hlh_buffer_print(b, "\n");
    hlh_buffer_print(b, "END\n");
}

/* A range of one number is drawn as wide as a line. */
static void range(struct hlh_buffer *b, const struct hls_result *r, uint32_t k)
{
    const struct hls_case *c = r->curve;
    if (isnan(c->low))
        return;
    hlh_buffer_print(b, "set object rectangle from first %.9g, graph 0 to "
                     "first %.9g, graph 1 behind fillcolor rgb '%s' fillstyle "
                     "solid 0.13 border rgb '%s' lw 0.3\n", c->low, c->high,
                     colors[k % COLORS], colors[k % COLORS]);
}

static void title(struct hlh_buffer *b, const struct hls_result *r)
{
    char text[256], p[HLS_NUMBER];
    hls_number(p, r->row, r->boundary);
    snprintf(text, sizeof text, "%s: p* = %s%s", r->curve->name,
             r->skip ? "skipped" : p,
             r->verdict == HLS_MOVED ? " (moved)"
             : r->verdict == HLS_BROKEN ? " (broken)" : "");
    quote(b, text);
}

/* What was skipped has its place among the titles alone. */
static void curves(struct hlh_buffer *b, const struct hls_result *r,
                   uint32_t n)
{
    hlh_buffer_print(b, "plot ");
    for (uint32_t k = 0; k < n; k++) {
        const char *color = colors[k % COLORS];
        hlh_buffer_print(b, "%s%.9g with lines dashtype 3 lw 1 lc rgb '%s' "
                         "notitle, ", k ? ", " : "", r[k].curve->limit,
                         color);
        if (r[k].n)
            hlh_buffer_print(b, "$c%u with linespoints pt 7 ps 0.3 lw 1.6 lc "
                             "rgb '%s' title ", k, color);
        else
            hlh_buffer_print(b, "NaN with lines lc rgb '%s' title ", color);
        title(b, &r[k]);
        if (r[k].found && isfinite(r[k].at))
            hlh_buffer_print(b, ", '+' every ::0::0 using (%.9g):(%.9g) with "
                             "points pt 6 ps 1.3 lw 2 lc rgb '%s' notitle",
                             r[k].boundary, r[k].at, color);
    }
    hlh_buffer_print(b, "\n");
}

/* Decades of measures that are all above 0 would hide the limit. */
static bool wide(const struct hls_result *r, uint32_t n)
{
    double low = INFINITY, high = 0;
    for (uint32_t k = 0; k < n; k++)
        for (uint32_t i = 0; i < r[k].n; i++)
            if (isfinite(r[k].m[i])) {
                low = fmin(low, r[k].m[i]);
                high = fmax(high, r[k].m[i]);
            }
    return low > 0 && high > 300 * low;
}

static bool by_ratio(const struct hls_result *r)
{
    double low = fmin(r->curve->from, r->curve->to);
    double high = fmax(r->curve->from, r->curve->to);
    return r->row->grid == HLS_LOG ||
           (r->row->grid == HLS_WHOLE && low > 0 && high >= 50 * low);
}

/* 1, 2 and 5 of each decade where gnuplot would mark decades alone. */
static void ticks(struct hlh_buffer *b, double low, double high)
{
    static const double digits[] = { 1, 2, 5 };
    const char *comma = "set logscale x\nset xtics (";
    if (!(high < 500 * low)) {
        hlh_buffer_print(b, "set logscale x\n");
        return;
    }
    for (double ten = pow(10, floor(log10(low))); ten <= high; ten *= 10)
        for (int i = 0; i < 3; i++) {
            hlh_buffer_print(b, "%s%.6g", comma, digits[i] * ten);
            comma = ", ";
        }
    hlh_buffer_print(b, ")\n");
}

/* All that is swept, and no more. */
static void swept(struct hlh_buffer *b, const struct hls_result *r, uint32_t n)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t k = 0; k < n; k++) {
        low = fmin(low, fmin(r[k].curve->from, r[k].curve->to));
        high = fmax(high, fmax(r[k].curve->from, r[k].curve->to));
    }
    hlh_buffer_print(b, "set xrange [%.9g:%.9g]\n", low, high);
    if (by_ratio(r))
        ticks(b, low, high);
}

/* Lines of the key, two names each, and the picture that leaves the curves
 * their room: gnuplot lays a key over them where it has too little. */
static unsigned key_lines(uint32_t n) { return (n + 1) / 2; }
static unsigned height_of(uint32_t n) { return 320 + 20 * key_lines(n); }

static void axes(struct hlh_buffer *b, const struct hls_result *r, uint32_t n)
{
    char text[160];
    bool unit = r->row->unit[0] != 0;
    hlh_buffer_print(b, "set border 3\nset tics nomirror out\n"
                     "set key outside below left Left reverse noenhanced "
                     "maxcols 2 maxrows %u samplen 2 width -4 height 1\n"
                     "set bmargin %u\n"
                     "set grid lc rgb '#dddddd'\nset title ",
                     key_lines(n), key_lines(n) + 6);
    quote(b, r->row->failure);
    snprintf(text, sizeof text, unit ? "%s (%s)" : "%s", r->row->parameter,
             r->row->unit);
    hlh_buffer_print(b, " noenhanced font ',13'\nset xlabel ");
    quote(b, text);
    hlh_buffer_print(b, " noenhanced\nset ylabel ");
    quote(b, r->row->metric);
    hlh_buffer_print(b, " noenhanced\nset offsets 0, 0, graph 0.05, 0\n");
    swept(b, r, n);
    if (wide(r, n))
        hlh_buffer_print(b, "set logscale y\nset format y '%%g'\n");
}

bool hls_plot(const char *folder, const struct hls_result *r, uint32_t n,
              struct hlh_error *error)
{
    char path[1024];
    struct hlh_buffer b = {0};
    uint32_t points = 0;
    snprintf(path, sizeof path, "%s/%s.svg", folder, r->row->name);
    for (uint32_t k = 0; k < n; k++)
        points += r[k].n;
    if (!points)                       /* all were skipped                   */
        return true;
    for (uint32_t k = 0; k < n; k++)
        data(&b, &r[k], k);
    axes(&b, r, n);
    for (uint32_t k = 0; k < n; k++)
        range(&b, &r[k], k);
    curves(&b, r, n);
    hlh_buffer_add(&b, "", 1);
    bool ok = b.failed ? hlh_fail(error, path, "out of memory")
                       : hlc_gnuplot(path, 640, height_of(n), b.bytes,
                                     error);
    hlh_buffer_free(&b);
    return ok;
}
