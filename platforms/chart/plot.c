/* SPDX-License-Identifier: Zlib */
/* A chart's picture: what is where is decided here, in pixels, so that words
 * can be kept apart; gnuplot draws it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/chart/plot_parts.h"
#include "platforms/cli/gnuplot.h"

enum { KEY_WIDTH = 280 };

/* Error over that of what is cheaper, from which on more cost is for nothing a
 * reader could see. */
#define NEARER 0.99

/* Words whose leaders are longer than this on the mean are better numbers. */
#define FAR_OFF 45.0

/* ---- names -------------------------------------------------------------- */

void hlt_short_name(char out[HLT_NAME], const char *way)
{
    static const struct { const char *from, *to; } less[] = {
        { "inferred ", "" }, { "_UNORM", "" }, { "_FLOAT", "F" },
        { "forward-multipass", "multi-pass" }
    };
    size_t n = 0;
    while (*way && n + 12 < HLT_NAME) {
        size_t i = 0, count = sizeof less / sizeof *less;
        while (i < count && strncmp(way, less[i].from, strlen(less[i].from)))
            i++;
        if (i == count) {
            out[n++] = *way++;
            continue;
        }
        memcpy(out + n, less[i].to, strlen(less[i].to));
        n += strlen(less[i].to);
        way += strlen(less[i].from);
    }
    out[n] = 0;
}

uint32_t hlt_group_of(const struct hlt_chart *c, const char *name)
{
    uint32_t g = 0;
    while (g < c->n_groups && strcmp(c->group[g], name))
        g++;
    return g < HLT_GROUPS ? g : HLT_GROUPS - 1;
}

/* First those of ways.c, each with its own mark in every chart, whichever of
 * them have points there; then what else there is. */
static void find_groups(struct hlt_chart *c)
{
    static const char *const known[] = {
        "size x format", "pipeline", "filter x size", "normals",
        "samples x size", "lights a blend x format", "light path"
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        c->group[c->n_groups++] = known[i];
    for (uint32_t i = 0; i < c->n; i++) {
        const char *name = c->point[i].row->group;
        uint32_t g = hlt_group_of(c, name);
        if (g == c->n_groups)
            c->group[c->n_groups++] = name;
        c->used[g] = true;
    }
}

/* ---- axes --------------------------------------------------------------- */

static bool no_error(const struct hlt_chart *c, const struct hlt_point *p)
{
    return p->error <= hlt_error_floor(c->error);
}

double hlt_point_x(const struct hlt_chart *c, const struct hlt_point *p)
{
    return hlt_axis_pixel(&c->x, p->cost);
}

double hlt_point_y(const struct hlt_chart *c, const struct hlt_point *p)
{
    return hlt_axis_pixel(&c->y, no_error(c, p) ? c->y.zero : p->error);
}

bool hlt_is_notable(const struct hlt_chart *c, const struct hlt_point *p)
{
    double best = (double)INFINITY;
    if (!p->front)
        return false;
    for (const struct hlt_point *q = c->point; q->cost < p->cost; q++)
        if (q->front && q->error <= NEARER * best)
            best = q->error;
    return p->error <= NEARER * best;
}

bool hlt_is_beyond(const struct hlt_chart *c, const struct hlt_point *p)
{
    return !hlt_is_notable(c, p) &&
           (p->cost > c->right_limit || p->error > c->worst_limit);
}

/* A few ways that cost or miss many times as much as all of the front would
 * press it into a corner: they may have half of an axis, or where the front is
 * short, an octave of cost and six (36 dB) of error. */
static void find_limits(struct hlt_chart *c)
{
    double cost[2] = { (double)INFINITY, 0 }, error[2] = { cost[0], 0 };
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        if (!hlt_is_notable(c, p))
            continue;
        cost[0] = fmin(cost[0], p->cost);
        cost[1] = fmax(cost[1], p->cost);
        error[0] = no_error(c, p) ? error[0] : fmin(error[0], p->error);
        error[1] = fmax(error[1], p->error);
    }
    c->right_limit = cost[1] * fmax(2, cost[1] / cost[0]);
    c->worst_limit = error[1] * fmax(64, error[1] / error[0]);
}

static void make_axes(struct hlt_chart *c)
{
    double left = (double)INFINITY, right = 0, low = left, high = 0;
    bool zero = false;
    find_limits(c);
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        if (hlt_is_beyond(c, p))
            continue;
        left = fmin(left, p->low);
        right = fmax(right, p->high);
        c->bars = c->bars || p->low < p->cost || p->high > p->cost;
        if (no_error(c, p)) {
            zero = true;
            continue;
        }
        low = fmin(low, p->error);
        high = fmax(high, p->error);
    }
    if (high <= 0)
        low = high = 1;
    hlt_axis_make(&c->x, left, right, HLT_LEFT, c->right, false, false);
    hlt_axis_make(&c->y, low, high, HLT_BOTTOM, HLT_HEIGHT - HLT_TOP,
                  c->error == HLT_PSNR, zero);
}

/* ---- words -------------------------------------------------------------- */

/* A word for each point of the front; those of equal ones are one. */
static bool make_words(struct hlt_chart *c)
{
    c->word = hlh_alloc_zero(c->n, sizeof *c->word);
    c->label = hlh_alloc_zero(c->n, sizeof *c->label);
    if (!c->word || !c->label)
        return false;
    const struct hlt_point *before = NULL;
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        if (!hlt_is_notable(c, p))
            continue;
        if (before && before->cost >= p->cost && before->error <= p->error)
            c->word[c->n_words - 1].equal++;
        else
            c->word[c->n_words++].point = before = p;
    }
    return true;
}

static void name_words(struct hlt_chart *c)
{
    for (uint32_t i = 0; i < c->n_words; i++) {
        struct hlt_word *w = &c->word[i];
        char name[HLT_NAME];
        hlt_short_name(name, w->point->row->way);
        if (c->numbered)
            snprintf(w->text, sizeof w->text, "%u", (unsigned)i + 1);
        else if (w->equal)
            snprintf(w->text, sizeof w->text, "%s =%u", name,
                     (unsigned)w->equal + 1);
        else
            snprintf(w->text, sizeof w->text, "%s", name);
    }
}

static struct hlt_box box_about(double x, double y, double half)
{
    return (struct hlt_box){ x - half, y - half, x + half, y + half };
}

/* Bars of all points, then the stairs of the front: at most 3 n. */
static uint32_t make_lines(struct hlt_box *out, const struct hlt_chart *c)
{
    uint32_t n = 0;
    double above = HLT_HEIGHT - HLT_TOP;
    for (uint32_t i = 0; i < c->n; i++) {
        const struct hlt_point *p = &c->point[i];
        double x = hlt_point_x(c, p), y = hlt_point_y(c, p), to = c->right;
        if (p->low < p->high)
            out[n++] = (struct hlt_box){ hlt_axis_pixel(&c->x, p->low), y,
                                         hlt_axis_pixel(&c->x, p->high), y };
        if (!p->front)
            continue;
        for (uint32_t k = i + 1; k < c->n && to >= c->right; k++)
            to = c->point[k].front ? hlt_point_x(c, &c->point[k]) : to;
        out[n++] = (struct hlt_box){ x, y, x, above };
        out[n++] = (struct hlt_box){ x, y, to, y };
        above = y;
    }
    return n;
}

static bool place_words(struct hlt_chart *c)
{
    struct hlt_box *box = hlh_alloc(c->n, 4 * sizeof *box);
    if (!box)
        return false;
    struct hlt_field field = { { HLT_LEFT + 4, HLT_BOTTOM + 4, c->right - 2,
                                 HLT_HEIGHT - HLT_TOP }, box, c->n,
                               box + c->n, 0 };
    for (uint32_t i = 0; i < c->n; i++)
        box[i] = box_about(hlt_point_x(c, &c->point[i]),
                           hlt_point_y(c, &c->point[i]), HLT_MARK);
    field.n_lines = make_lines(box + c->n, c);
    for (uint32_t i = 0; i < c->n_words; i++) {
        const struct hlt_point *p = c->word[i].point;
        c->label[i] = (struct hlt_label){
            .x = hlt_point_x(c, p), .y = hlt_point_y(c, p),
            .width = hlt_text_width(c->word[i].text, HLT_WORD_SIZE),
            .height = 1.2 * HLT_WORD_SIZE };
    }
    hlt_labels_place(c->label, c->n_words, &field);
    free(box);
    return true;
}

static bool words_are_near(const struct hlt_chart *c)
{
    double sum = 0;
    for (uint32_t i = 0; i < c->n_words; i++) {
        const struct hlt_label *l = &c->label[i];
        if (!l->placed)
            return false;
        sum += hypot(l->near_x - l->x, l->near_y - l->y);
    }
    return sum <= FAR_OFF * c->n_words;
}

static bool lay_out_words(struct hlt_chart *c, bool numbered)
{
    c->numbered = numbered;
    c->right = HLT_WIDTH - (numbered ? KEY_WIDTH : HLT_RIGHT);
    make_axes(c);
    name_words(c);
    return place_words(c);
}

bool hlt_layout(struct hlt_chart *c, const struct hlt_point *p, uint32_t n,
                enum hlt_column cost, enum hlt_column error)
{
    memset(c, 0, sizeof *c);
    c->point = p;
    c->n = n;
    c->cost = cost;
    c->error = error;
    find_groups(c);
    return make_words(c) && lay_out_words(c, false) &&
           (words_are_near(c) || lay_out_words(c, true));
}

void hlt_layout_free(struct hlt_chart *c)
{
    free(c->word);
    free(c->label);
}

bool hlt_plot(const char *path, const char *title, const struct hlt_point *p,
              uint32_t n, enum hlt_column cost, enum hlt_column error,
              struct hlh_error *error_out)
{
    struct hlt_chart c;
    struct hlh_buffer script = { NULL, 0, 0, false };
    if (n == 0)
        return hlh_fail(error_out, path, "no way was measured that this chart "
                        "could show");
    bool ok = hlt_layout(&c, p, n, cost, error);
    if (ok)
        hlt_plot_script(&script, &c, title);
    hlh_buffer_add(&script, "", 1);
    ok = ok && !script.failed;
    ok = ok ? hlc_gnuplot(path, HLT_WIDTH, HLT_HEIGHT, script.bytes, error_out)
            : hlh_fail(error_out, path, "out of memory");
    hlh_buffer_free(&script);
    hlt_layout_free(&c);
    return ok;
}
