/* SPDX-License-Identifier: Zlib */
#ifndef HLS_STABILITY_H
#define HLS_STABILITY_H
/* Where each method fails: a parameter is swept until a measure breaks its
 * limit, the place is found by bisection, and must lie where theory puts it: an
 * improvement is noticed as well as a loss. One file a failure (row_*.c), whose
 * row is listed in rows.def; run.c sweeps, report.c writes, cmd_stability.c is
 * the command. */
#include "platforms/cli/shot.h"

/* What rows draw with. */
struct hls_lab {
    const struct hlc_options *o; /* backend and profile among them           */
    struct hlc_stage stage;      /* hls_lab_scene's                          */
    bool open;
    void *data;                  /* a row's own, from its open to its close  */
    /* One line about the machine or the last failure, for the report. */
    char note[160];
};

/* The lab's stage becomes *scene (moved in) on the options' machine. False: a
 * line was printed, the row has failed. */
bool hls_lab_scene(struct hls_lab *, struct hlh_scene *scene,
                   const struct hlc_options *o);
void hls_lab_clear(struct hls_lab *);

enum hls_grid { HLS_LOG, HLS_LINEAR, HLS_WHOLE };

/* Steps of a sweep, ends included; of --fast; fewer where HLS_WHOLE has not
 * that many. With more numbers than steps HLS_WHOLE goes by ratio where both
 * ends are above 0, else evenly. */
enum { HLS_STEPS = 24, HLS_FAST_STEPS = 8 };

/* One curve. Its boundary p*: the first p, from `from` on, whose measure is
 * above `limit` (`falling`: not above it any more), bisected to 1 % (LINEAR:
 * of the range; WHOLE: exactly). */
struct hls_case {
    const char *name;            /* "axis": unique within its row            */
    const char *what;            /* of the curve, a few words                */
    double from, to;             /* from > to sweeps downwards               */
    double limit;
    bool falling;
    double low, high;            /* where p* must lie; NAN: there is none
                                  * in the whole sweep                       */
    const char *derived;         /* the value that theory gives, and whence  */
    double arg[4];               /* the row's own use                        */
};

struct hls_row {
    const char *name;            /* "thin"; "row.case" names a curve         */
    const char *failure;         /* a sentence: what fails                   */
    const char *source;          /* failure mode's number and paper          */
    const char *parameter, *unit, *metric;
    enum hls_grid grid;
    const struct hls_case *cases;
    uint32_t n_cases;
    /* Before a case and after it (also where open failed, which must then not
     * leave behind what close takes for its own; the lab's stage is closed
     * besides); NULL: nothing. False: the row has failed, with a line printed.
     * *skip set to a reason: it cannot be had here. */
    bool (*open)(struct hls_lab *, const struct hls_case *,
                 const char **skip);
    void (*close)(struct hls_lab *);
    /* The measure at p; NAN and infinity are above every limit. False: not to
     * be had, a line was printed. */
    bool (*measure)(double *m, double p, const struct hls_case *,
                    struct hls_lab *);
};

/* rows.def's, in order; NULL past the end. */
const struct hls_row *hls_row(uint32_t i);

enum hls_verdict { HLS_HELD, HLS_MOVED, HLS_BROKEN, HLS_SKIPPED };

struct hls_result {
    const struct hls_row *row;
    const struct hls_case *curve;
    double p[HLS_STEPS + 32], m[HLS_STEPS + 32];   /* all, in order of p     */
    uint32_t n;
    bool found;
    double boundary, at;         /* p* and the measure there                 */
    enum hls_verdict verdict;    /* HELD: where it must be; MOVED: elsewhere;
                                  * BROKEN: could not be measured            */
    const char *skip;
    char note[160];
};

/* run.c */
void hls_run(struct hls_result *out, const struct hls_row *,
             const struct hls_case *, struct hls_lab *);
/* report.c: one line of text; boundaries.csv, curves.csv and ROW.svg in a
 * folder, which is made. `machine`: "packemu:native". Without gnuplot there are
 * no charts, which *note (120 bytes) then says. */
const char *hls_verdict_name(enum hls_verdict);
void hls_print_head(void);
void hls_print(const struct hls_result *);
bool hls_write(const char *folder, const struct hls_result *, uint32_t n,
               const char *machine, char note[120], struct hlh_error *error);
/* check.c: boundaries as a file of text, and against one. */
bool hls_save(const char *path, const struct hls_result *, uint32_t n,
              const char *machine, bool fast, struct hlh_error *error);
/* How many boundaries are more than a width of bisection worse than the
 * file's: broken earlier or, falling, held later. A line each on stderr; -1
 * with one line where the file cannot be used. */
int hls_check(const char *path, const struct hls_result *, uint32_t n,
              const char *machine, bool fast, struct hlh_error *error);
#endif
