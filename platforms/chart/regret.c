/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/regret.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/cli/calibration.h"
#include "platforms/host/image.h"
#include "platforms/host/util.h"

/* ---- one case ----------------------------------------------------------- */

static bool of_sweep(const struct hlt_row *r, const struct hlt_row *chosen)
{
    return !(r->budget > 0) && r->samples == chosen->samples &&
           !strcmp(r->scene, chosen->scene) &&
           !strcmp(r->machine, chosen->machine);
}

static const struct hlt_row *cheapest(const struct hlt_table *t,
                                      const struct hlt_row *chosen)
{
    const struct hlt_row *best = NULL;
    for (uint32_t i = 0; i < t->n; i++) {
        const struct hlt_row *r = &t->rows[i];
        bool within = r->value[HLT_CODES] <= chosen->budget &&
                      r->value[HLT_COST] > 0;
        if (within && of_sweep(r, chosen) &&
            (!best || r->value[HLT_COST] < best->value[HLT_COST]))
            best = r;
    }
    return best;
}

static void compare_times(struct hlt_case *c)
{
    const double *a = c->chosen->value, *b = c->best->value;
    c->time = a[HLT_RATIO] / b[HLT_RATIO];
    c->time_low = a[HLT_RATIO_LOW] / b[HLT_RATIO_HIGH];
    c->time_high = a[HLT_RATIO_HIGH] / b[HLT_RATIO_LOW];
}

static struct hlt_case judge(const struct hlt_table *t,
                             const struct hlt_row *chosen)
{
    struct hlt_case c = { chosen, cheapest(t, chosen), HLT_MET, false, NAN,
                          NAN, NAN, NAN };
    c.calibrated = hlc_is_calibration_scene(chosen->scene);
    if (!chosen->pipeline[0]) {
        c.verdict = c.best ? HLT_REFUSED_WRONGLY : HLT_REFUSED;
        return c;
    }
    /* A figure that is not there is no proof that the budget was kept. */
    if (!(chosen->value[HLT_CODES] <= chosen->budget))
        c.verdict = HLT_BROKEN;
    c.regret = c.best ? chosen->value[HLT_COST] / c.best->value[HLT_COST] : 1;
    if (c.best)
        compare_times(&c);
    return c;
}

struct hlt_case *hlt_cases(uint32_t *n, const struct hlt_table *t)
{
    struct hlt_case *cases = hlh_alloc(t->n, sizeof *cases);
    *n = 0;
    for (uint32_t i = 0; i < t->n && cases; i++)
        if (t->rows[i].budget > 0)
            cases[(*n)++] = judge(t, &t->rows[i]);
    return cases;
}

/* ---- all ---------------------------------------------------------------- */

static void count(struct hlt_regret *s, const struct hlt_case *c, double *logs,
                  uint32_t *planned)
{
    bool broken = c->verdict == HLT_BROKEN;
    s->n++;
    s->n_new += !c->calibrated;
    s->broken += broken;
    s->broken_new += broken && !c->calibrated;
    s->refused += c->verdict == HLT_REFUSED;
    s->refused_wrongly += c->verdict == HLT_REFUSED_WRONGLY;
    if (!(c->regret > 0))
        return;
    s->worst = fmax(s->worst, c->regret);
    if (!c->calibrated)
        s->worst_new = fmax(s->worst_new, c->regret);
    *logs += log(c->regret);
    *planned += 1;
}

bool hlt_regret_of(struct hlt_regret *out, const struct hlt_table *t)
{
    uint32_t n, planned = 0;
    double logs = 0;
    struct hlt_case *cases = hlt_cases(&n, t);
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < n && cases; i++)
        count(out, &cases[i], &logs, &planned);
    out->mean = planned ? exp(logs / planned) : 0;
    bool ok = cases != NULL;
    free(cases);
    return ok;
}

static const char *verdict_name(enum hlt_verdict v)
{
    static const char *const names[] = { "met", "broken", "refused",
                                         "refused wrongly" };
    return names[v];
}

/* ---- CSV ---------------------------------------------------------------- */

/* Empty where it is not a number. */
static void cell(struct hlh_buffer *b, double x, int digits)
{
    if (isfinite(x))
        hlh_buffer_print(b, ",%.*g", digits, x);
    else
        hlh_buffer_print(b, ",");
}

/* Names of scenes are file names: commas and quotes are theirs to have. */
static void quoted(struct hlh_buffer *b, const char *text)
{
    bool plain = !strpbrk(text, ",\"\n\r");
    if (plain) {
        hlh_buffer_add(b, text, strlen(text));
        return;
    }
    hlh_buffer_add(b, "\"", 1);
    for (const char *p = text; *p; p++)
        hlh_buffer_add(b, *p == '"' ? "\"\"" : p, *p == '"' ? 2 : 1);
    hlh_buffer_add(b, "\"", 1);
}

/* What was planned, in one word an axis. */
static void chosen_text(char *out, size_t size, const struct hlt_row *r)
{
    if (!r->pipeline[0])
        snprintf(out, size, "none");
    else if (r->light_width)
        snprintf(out, size, "%s %ux%u %s", r->pipeline, r->light_width,
                 r->light_height, r->light_format);
    else
        snprintf(out, size, "%s", r->pipeline);
}

static void line(struct hlh_buffer *b, const struct hlt_case *c)
{
    char plan[128];
    const struct hlt_row *r = c->chosen;
    chosen_text(plan, sizeof plan, r);
    quoted(b, r->scene);
    hlh_buffer_print(b, ",%s,%u", r->machine, r->samples);
    cell(b, r->budget, 9);
    hlh_buffer_print(b, ",%s,%s,%s", c->calibrated ? "yes" : "no",
                     verdict_name(c->verdict), plan);
    cell(b, r->pipeline[0] ? r->value[HLT_COST] : NAN, 9);
    cell(b, r->pipeline[0] ? r->value[HLT_CODES] : NAN, 9);
    hlh_buffer_print(b, ",");
    quoted(b, c->best ? c->best->way : "");
    cell(b, c->best ? c->best->value[HLT_COST] : NAN, 9);
    cell(b, c->best ? c->best->value[HLT_CODES] : NAN, 9);
    cell(b, c->regret, 6);
    cell(b, c->time, 4);
    cell(b, c->time_low, 4);
    cell(b, c->time_high, 4);
    hlh_buffer_print(b, "\n");
}

bool hlt_regret_write(const struct hlt_table *t, const char *path,
                      struct hlh_error *error)
{
    struct hlh_buffer b = { 0 };
    uint32_t n;
    struct hlt_case *cases = hlt_cases(&n, t);
    hlh_buffer_print(&b, "scene,machine,samples,budget_codes,calibrated_on,"
                     "verdict,chosen,chosen_cost_ns,chosen_codes,best,"
                     "best_cost_ns,best_codes,regret,time_ratio,time_low,"
                     "time_high\n");
    for (uint32_t i = 0; i < n && cases; i++)
        line(&b, &cases[i]);
    bool ok = cases && !b.failed
              ? hlh_file_write(path, b.bytes, b.size, error)
              : hlh_fail(error, path, "out of memory");
    free(cases);
    hlh_buffer_free(&b);
    return ok;
}

/* ---- for people --------------------------------------------------------- */

static void print_case(const struct hlt_case *c)
{
    char plan[128], time[48] = "-";
    const struct hlt_row *r = c->chosen;
    chosen_text(plan, sizeof plan, r);
    if (isfinite(c->time))
        snprintf(time, sizeof time, "%.2f (%.2f..%.2f)", c->time, c->time_low,
                 c->time_high);
    printf("%-14s %-16s %6g  %-36s ", r->scene, r->machine, r->budget, plan);
    if (r->pipeline[0])
        printf("%6.2f %6.2f  %-20s", r->value[HLT_CODES], c->regret, time);
    else
        printf("%6s %6s  %-20s", "-", "-", "-");
    printf(" %s%s\n", c->verdict == HLT_MET ? "" : verdict_name(c->verdict),
           c->calibrated ? "" : " *");
}

void hlt_regret_print(const struct hlt_table *t)
{
    uint32_t n;
    struct hlt_regret s;
    struct hlt_case *cases = hlt_cases(&n, t);
    if (!cases || n == 0 || !hlt_regret_of(&s, t)) {
        free(cases);
        return;
    }
    printf("\nBudgets: what was chosen, its error in codes, its counted cost "
           "over the best's,\nand its time over the best's (quartiles).\n"
           "%-14s %-16s %6s  %-36s %6s %6s  %s\n", "scene", "machine",
           "budget", "chosen", "codes", "regret", "time");
    for (uint32_t i = 0; i < n; i++)
        print_case(&cases[i]);
    printf("* not a scene that calibrate draws\nregret: worst %.3f (of those "
           "%.3f), mean %.3f; %u of %u budgets broken (%u of\n%u), %u "
           "refused, %u of them wrongly\n", s.worst, s.worst_new, s.mean,
           s.broken, s.n, s.broken_new, s.n_new, s.refused +
           s.refused_wrongly, s.refused_wrongly);
    free(cases);
}
