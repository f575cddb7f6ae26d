/* SPDX-License-Identifier: Zlib */
#ifndef HLT_CHART_H
#define HLT_CHART_H
/* Error over cost of every way to draw a scene. Reading order: ways.c (what is
 * tried), sweep.c (all of them), point.c (one drawn, compared with refs.c,
 * counted by count.c, timed by time.c), table.c (the CSV, which an unfinished
 * sweep is gone on with; a finished one is replaced), front.c (which ways no
 * other beats, and the area they take), plot.c (pictures of it), check.c (what
 * became worse), report.c, cmd_chart.c. */
#include "platforms/cli/options.h"
#include "platforms/host/scene.h"

enum hlt_kind { HLT_COUNT, HLT_ERROR, HLT_GOOD, HLT_TIME };

enum hlt_column {
#define HLT_COLUMN(id, name, kind, what) HLT_##id,
#include "platforms/chart/columns.def"
#undef HLT_COLUMN
    HLT_COLUMNS
};
const char *hlt_column_name(enum hlt_column);
enum hlt_kind hlt_column_kind(enum hlt_column);

enum { HLT_NAME = 96, HLT_MACHINE = 32 };

/* One way to draw: what the planner is asked for. */
struct hlt_way {
    char name[HLT_NAME];         /* "inferred 5/8 RGBA16_FLOAT": one word an
                                  * axis that is not the base's; unique      */
    char group[HLT_NAME];        /* axis that it belongs to: "size x format" */
    enum hl_pipeline pipeline;
    uint32_t eighths;            /* L-buffer of k / 8 a side; 0: none        */
    enum hl_format light_format, normal_format;
    enum hl_light_path light_path;
    uint32_t samples, batch;     /* batch 0: planner's                       */
    enum hl_dsf dsf;
    double dsf_tau;
    enum hl_fill fill;
    enum hl_fetch fetch;
    double budget;               /* codes; > 0: pipeline AUTO and all else
                                  * the planner's                            */
    bool baseline;               /* the one that times are ratios to         */
};

/* A row of the table. Its key: scene, machine, way.name. */
struct hlt_row {
    char scene[HLT_NAME];
    char machine[HLT_MACHINE];   /* "vulkan", "packemu:ps3"                  */
    char way[HLT_NAME], group[HLT_NAME];
    double budget;               /* of way; 0: none                          */
    /* What the plan came to. */
    char pipeline[24], light_format[24], normal_format[24], light_path[12];
    uint32_t light_width, light_height, samples, batch;
    double value[HLT_COLUMNS];
};

struct hlt_table {
    struct hlt_row *rows;        /* malloc'd                                 */
    uint32_t n;
    uint32_t width, height;      /* of all pictures; 0: there is no file     */
    char settings[64];           /* what else rows depend on: "9 rounds"; ""
                                  * where that is nothing                    */
    bool unfinished;             /* of a sweep that was interrupted          */
    uint32_t refused;            /* by hlt_sweep: ways without a plan; not in
                                  * the file                                 */
};

/* ways.c: for such a machine; the first is the baseline, and no two ask for
 * the same. What the planner refuses is among them. malloc'd, NULL when memory
 * is out. */
struct hlt_way *hlt_ways(uint32_t *n, const struct hl_caps *caps, bool fast);

/* table.c */
void hlt_table_free(struct hlt_table *);
/* Rows of a file; a file that is not there has none. False with one line. */
bool hlt_table_read(struct hlt_table *, const char *path,
                    struct hlh_error *error);
/* One more, at the file's end too: what was measured is not lost. */
bool hlt_table_append(struct hlt_table *, const struct hlt_row *,
                      const char *path, struct hlh_error *error);
/* All anew, sorted by scene, machine and way. */
bool hlt_table_write(struct hlt_table *, const char *path,
                     struct hlh_error *error);
const struct hlt_row *hlt_table_find(const struct hlt_table *,
                                     const char *scene, const char *machine,
                                     const char *way);

/* sweep.c: every way that `table` has no row of yet. An exit code. */
int hlt_sweep(struct hlt_table *table, const char *path,
              const struct hlc_options *o);

/* front.c: points of one chart. Costs and errors are above 0. */
struct hlt_point {
    const struct hlt_row *row;   /* of a mean: of its first scene            */
    double cost, error;
    double low, high;            /* of cost, where it is measured; else cost */
    bool front;                  /* no other point is as good in both and
                                  * better in one                            */
};
/* Rows of a scene and machine that have both columns, budgets left out; sorted
 * by cost, marked. GOOD columns count as errors: psnr as 10^(-psnr / 20), RMS
 * by peak; ssim as 1 - ssim. malloc'd; scene NULL: geometric means of what all
 * scenes of the machine have. A cost that is not above 0 was not counted, and
 * its row is left out; low and high of a mean are means of those. */
struct hlt_point *hlt_points(uint32_t *n, const struct hlt_table *,
                             const char *scene, const char *machine,
                             enum hlt_column cost, enum hlt_column error);
/* What an error of 0, which has no logarithm, counts as: 1e-8, below a bit of
 * a 32-bit float at the peak; of relmse its square. */
double hlt_error_floor(enum hlt_column error);
/* Area that the front takes below and left of the corner, both axes as log2:
 * octaves of cost times octaves of error. Points beyond the corner count to
 * its edge. */
double hlt_hypervolume(const struct hlt_point *, uint32_t n,
                       double corner_cost, double corner_error);

/* plot.c: an SVG by gnuplot; false with one line. */
bool hlt_plot(const char *path, const char *title, const struct hlt_point *,
              uint32_t n, enum hlt_column cost, enum hlt_column error,
              struct hlh_error *error_out);

/* check.c: hypervolumes over counted cost of every scene and machine, of all
 * ways and of each group of them, with their corners: written, and compared
 * with a file's. */
bool hlt_save(const struct hlt_table *, const char *path,
              struct hlh_error *error);
/* How many are more than 2 % below the file's, a line each on stderr; -1 with
 * one line where the file cannot be read. */
int hlt_check(const struct hlt_table *, const char *path,
              struct hlh_error *error);
#endif
