/* SPDX-License-Identifier: Zlib */
/* One sweep. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/stability/stability.h"

struct sweep {
    struct hls_result *out;
    const struct hls_row *row;
    const struct hls_case *curve;
    struct hls_lab *lab;
};

/* NaN compares with nothing and is above every limit all the same. */
static bool breaks(const struct hls_case *c, double m)
{
    bool above = !(m <= c->limit);
    return c->falling ? !above : above;
}

static bool take(struct sweep *s, double p, double *m)
{
    struct hls_result *r = s->out;
    if (r->n == sizeof r->p / sizeof *r->p ||
        !s->row->measure(m, p, s->curve, s->lab))
        return false;
    r->p[r->n] = p;
    r->m[r->n++] = *m;
    return true;
}

static uint32_t steps(const struct sweep *s)
{
    uint32_t most = s->lab->o && s->lab->o->fast ? HLS_FAST_STEPS : HLS_STEPS;
    double numbers = fabs(s->curve->to - s->curve->from) + 1;
    return s->row->grid == HLS_WHOLE && numbers < most ? (uint32_t)numbers
                                                       : most;
}

/* Point i of n; the ends are exact. */
static double point(const struct sweep *s, uint32_t i, uint32_t n)
{
    double from = s->curve->from, to = s->curve->to;
    bool whole = s->row->grid == HLS_WHOLE;
    bool ratio = s->row->grid == HLS_LOG ||
                 (whole && from > 0 && to > 0 && fabs(to - from) >= n);
    if (i == 0 || i == n - 1)
        return i ? to : from;
    double t = i / (n - 1.0);
    double p = ratio ? from * pow(to / from, t) : from + (to - from) * t;
    return whole ? floor(p + 0.5) : p;
}

static bool near_enough(const struct sweep *s, double good, double bad)
{
    double from = s->curve->from, to = s->curve->to;
    switch (s->row->grid) {
    case HLS_LOG:
        return fabs(log(bad / good)) <= log(1.01);
    case HLS_LINEAR:
        return fabs(bad - good) <= 0.01 * fabs(to - from);
    default:
        return fabs(bad - good) <= 1;
    }
}

static double middle(const struct sweep *s, double good, double bad)
{
    double mean = (good + bad) / 2;
    if (fabs(mean) < 1e-12 * fabs(good))             /* nought is nought     */
        mean = 0;
    return s->row->grid == HLS_LOG ? sqrt(good * bad)
           : s->row->grid == HLS_WHOLE ? floor(mean) : mean;
}

static bool bisect(struct sweep *s, double good, double bad, double m_bad)
{
    while (!near_enough(s, good, bad)) {
        double p = middle(s, good, bad), m;
        if (!take(s, p, &m))
            return false;
        if (breaks(s->curve, m)) {
            bad = p;
            m_bad = m;
        } else {
            good = p;
        }
    }
    s->out->boundary = bad;
    s->out->at = m_bad;
    return true;
}

/* All of the curve is measured, also past its boundary: charts show it. */
static bool sweep(struct sweep *s)
{
    struct hls_result *r = s->out;
    double good = NAN, bad = NAN, m_bad = NAN, before = NAN;
    uint32_t n = steps(s);
    for (uint32_t i = 0; i < n; i++) {
        double p = point(s, i, n), m;
        if (i && p == before)          /* whole numbers that meet            */
            continue;
        if (!take(s, p, &m))
            return false;
        if (!r->found && breaks(s->curve, m)) {
            r->found = true;
            good = before;
            bad = p;
            m_bad = m;
        }
        before = p;
    }
    r->boundary = bad;
    r->at = m_bad;
    return !r->found || isnan(good) || bisect(s, good, bad, m_bad);
}

struct point { double p, m; };

static int order(const void *a, const void *b)
{
    const struct point *x = a, *y = b;
    return x->p < y->p ? -1 : x->p > y->p;
}

static void sort(struct hls_result *r)
{
    struct point all[HLS_STEPS + 32];
    for (uint32_t i = 0; i < r->n; i++)
        all[i] = (struct point){ r->p[i], r->m[i] };
    qsort(all, r->n, sizeof *all, order);
    for (uint32_t i = 0; i < r->n; i++) {
        r->p[i] = all[i].p;
        r->m[i] = all[i].m;
    }
}

static enum hls_verdict judge(const struct hls_result *r)
{
    const struct hls_case *c = r->curve;
    bool held = r->found ? r->boundary >= c->low && r->boundary <= c->high
                         : isnan(c->low) && isnan(c->high);
    return held ? HLS_HELD : HLS_MOVED;
}

void hls_run(struct hls_result *out, const struct hls_row *row,
             const struct hls_case *curve, struct hls_lab *lab)
{
    struct sweep s = { out, row, curve, lab };
    memset(out, 0, sizeof *out);
    out->row = row;
    out->curve = curve;
    out->boundary = out->at = NAN;
    lab->note[0] = 0;
    bool ok = !row->open || row->open(lab, curve, &out->skip);
    ok = ok && (out->skip || sweep(&s));
    if (row->close)
        row->close(lab);
    hls_lab_clear(lab);
    sort(out);
    out->verdict = out->skip ? HLS_SKIPPED : ok ? judge(out) : HLS_BROKEN;
    memcpy(out->note, lab->note, sizeof out->note);
}
