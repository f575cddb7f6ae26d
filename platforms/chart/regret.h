/* SPDX-License-Identifier: Zlib */
#ifndef HLT_REGRET_H
#define HLT_REGRET_H
/* What planning by prediction costs: of each row of a budget, its counted cost
 * over that of the cheapest way of the sweep, of the same scene, machine and
 * samples, whose rms_codes are within the budget. */
#include "platforms/chart/chart.h"

enum hlt_verdict {
    HLT_MET = 0,             /* within the budget                            */
    HLT_BROKEN,              /* rms_codes above it                           */
    HLT_REFUSED,             /* no plan, and no way of the sweep is within   */
    HLT_REFUSED_WRONGLY      /* no plan, but some way of the sweep is        */
};

struct hlt_case {
    const struct hlt_row *chosen;    /* the row of the budget                */
    const struct hlt_row *best;      /* NULL: nothing in the sweep is within */
    enum hlt_verdict verdict;
    bool calibrated;         /* its scene is of calibrate's own set          */
    double regret;           /* chosen over best by cost_ns: below 1 where the
                              * sweep had not the chosen plan; 1 where `best`
                              * is NULL; NAN of what is refused              */
    /* Times of the two by their ratios to one baseline, and the widest that
     * their quartiles leave open; NAN where either was not timed. */
    double time, time_low, time_high;
};

/* A row of a budget that no plan met has no pipeline ("") and no figures; its
 * samples are those that were asked for. malloc'd, in order of the table; NULL
 * when memory is out. *n may be 0: no budgets. */
struct hlt_case *hlt_cases(uint32_t *n, const struct hlt_table *);

/* Over all cases, and over those of scenes that were not calibrated on. */
struct hlt_regret {
    uint32_t n, n_new;
    uint32_t broken, broken_new;
    uint32_t refused, refused_wrongly;
    double worst, worst_new;         /* regret; 0: none                      */
    double mean;                     /* geometric                            */
};
/* False: memory is out. */
bool hlt_regret_of(struct hlt_regret *out, const struct hlt_table *);

/* A CSV of all cases; false with one line. */
bool hlt_regret_write(const struct hlt_table *, const char *path,
                      struct hlh_error *error);
/* For people, on stdout; nothing where the table has no budgets. */
void hlt_regret_print(const struct hlt_table *);
#endif
