/* SPDX-License-Identifier: Zlib */
/* Points of a chart: which no other beats, and the area they take. */
#include "platforms/chart/chart.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/host/util.h"

double hlt_error_floor(enum hlt_column error)
{
    return error == HLT_RELMSE ? 1e-16 : 1e-8;
}

static double error_of(const struct hlt_row *row, enum hlt_column column)
{
    double v = row->value[column];
    double lowest = hlt_error_floor(column);
    if (column == HLT_PSNR)
        v = pow(10, -v / 20);
    else if (column == HLT_SSIM)
        v = 1 - v;
    return v < lowest ? lowest : v;     /* a NAN stays one */
}

/* False: the row has no place in the chart. A cost of 0 has none either: it
 * is what was not counted. */
static bool point_of(struct hlt_point *out, const struct hlt_row *row,
                     enum hlt_column cost, enum hlt_column error)
{
    out->row = row;
    out->cost = out->low = out->high = row->value[cost];
    out->error = error_of(row, error);
    out->front = false;
    if (cost == HLT_RATIO) {
        double low = row->value[HLT_RATIO_LOW];
        double high = row->value[HLT_RATIO_HIGH];
        out->low = low > 0 && low < out->cost ? low : out->cost;
        out->high = high > out->cost && isfinite(high) ? high : out->cost;
    }
    return row->budget <= 0 && out->cost > 0 && isfinite(out->cost) &&
           isfinite(out->error);
}

static int by_cost(const void *a, const void *b)
{
    const struct hlt_point *p = a, *q = b;
    if (p->cost < q->cost || p->cost > q->cost)
        return p->cost < q->cost ? -1 : 1;
    if (p->error < q->error || p->error > q->error)
        return p->error < q->error ? -1 : 1;
    return strcmp(p->row->way, q->row->way);
}

/* Of points in order: the best of each cost, where it is better than all
 * cheaper ones. Equal ones are all kept. */
static void mark(struct hlt_point *p, uint32_t n)
{
    double best = (double)INFINITY;
    for (uint32_t i = 0; i < n;) {
        uint32_t first = i;
        for (; i < n && p[i].cost <= p[first].cost; i++)
            p[i].front = p[i].error <= p[first].error && p[i].error < best;
        best = p[first].error < best ? p[first].error : best;
    }
}

/* ---- means -------------------------------------------------------------- */

struct scenes {
    const char **name;   /* sorted, so that sums are the same whatever the
                          * order of rows                                    */
    uint32_t n;
};

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static bool has(const struct scenes *s, const char *name)
{
    for (uint32_t i = 0; i < s->n; i++)
        if (!strcmp(s->name[i], name))
            return true;
    return false;
}

static bool scenes_of(struct scenes *s, const struct hlt_table *t,
                      const char *machine)
{
    s->n = 0;
    s->name = hlh_alloc(t->n, sizeof *s->name);
    if (!s->name)
        return false;
    for (uint32_t i = 0; i < t->n; i++)
        if (!strcmp(t->rows[i].machine, machine) && !has(s, t->rows[i].scene))
            s->name[s->n++] = t->rows[i].scene;
    qsort(s->name, s->n, sizeof *s->name, by_name);
    return true;
}

/* Geometric means of a way over all scenes; false where one lacks it. */
static bool mean_of(struct hlt_point *out, const struct hlt_table *t,
                    const struct scenes *s, const struct hlt_row *first,
                    enum hlt_column cost, enum hlt_column error)
{
    double sum[4] = { 0, 0, 0, 0 };
    for (uint32_t i = 0; i < s->n; i++) {
        struct hlt_point p;
        const struct hlt_row *row = hlt_table_find(t, s->name[i],
                                                   first->machine, first->way);
        if (!row || !point_of(&p, row, cost, error))
            return false;
        sum[0] += log(p.cost);
        sum[1] += log(p.error);
        sum[2] += log(p.low);
        sum[3] += log(p.high);
    }
    for (int k = 0; k < 4; k++)
        sum[k] = exp(sum[k] / s->n);
    *out = (struct hlt_point){ first, sum[0], sum[1], sum[2], sum[3], false };
    return true;
}

/* ---- what the header says ----------------------------------------------- */

/* Points of the rows of `from`, unsorted; their number. */
static uint32_t collect(struct hlt_point *p, const struct hlt_table *t,
                        const struct scenes *means, const char *from,
                        const char *machine, enum hlt_column cost,
                        enum hlt_column error)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < t->n; i++) {
        const struct hlt_row *row = &t->rows[i];
        if (strcmp(row->scene, from) || strcmp(row->machine, machine))
            continue;
        n += means ? mean_of(&p[n], t, means, row, cost, error)
                   : point_of(&p[n], row, cost, error);
    }
    return n;
}

struct hlt_point *hlt_points(uint32_t *n, const struct hlt_table *t,
                             const char *scene, const char *machine,
                             enum hlt_column cost, enum hlt_column error)
{
    struct hlt_point *p = hlh_alloc(t->n, sizeof *p);
    struct scenes all = { NULL, 0 };
    *n = 0;
    if (!p || !scenes_of(&all, t, machine)) {
        free(p);
        return NULL;
    }
    const char *from = scene ? scene : all.n ? all.name[0] : "";
    *n = collect(p, t, scene ? NULL : &all, from, machine, cost, error);
    qsort(p, *n, sizeof *p, by_cost);
    mark(p, *n);
    free(all.name);
    return p;
}

double hlt_hypervolume(const struct hlt_point *p, uint32_t n,
                       double corner_cost, double corner_error)
{
    double area = 0, reached = log2(corner_error);
    for (uint32_t i = 0; i < n; i++) {
        double width = log2(corner_cost) - log2(p[i].cost);
        double error = log2(p[i].error);
        if (width <= 0 || error >= reached)
            continue;
        area += width * (reached - error);
        reached = error;
    }
    return area;
}
