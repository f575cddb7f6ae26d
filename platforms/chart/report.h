/* SPDX-License-Identifier: Zlib */
#ifndef HLT_REPORT_H
#define HLT_REPORT_H
/* What a table says: for people, as pictures, as JSON. */
#include "platforms/chart/chart.h"

/* One front: of a scene, or of the mean of all where scene is NULL, on a
 * machine. */
struct hlt_front {
    const char *scene, *machine;
    enum hlt_column cost, error;
    struct hlt_point *point;     /* malloc'd                                 */
    uint32_t n;
    double corner_cost, corner_error; /* the worst of all points             */
    double area;                 /* hlt_hypervolume below that corner        */
};
/* False: memory is out. n is 0 where nothing was measured. */
bool hlt_front_of(struct hlt_front *, const struct hlt_table *,
                  const char *scene, const char *machine,
                  enum hlt_column cost, enum hlt_column error);

/* The i-th pair of scene and machine of a sorted table, machines of the first
 * scene first; false past the last. */
bool hlt_spot_at(const char **scene, const char **machine,
                 const struct hlt_table *, uint32_t i);
/* The i-th machine that has two scenes or more, which alone has means. */
bool hlt_mean_at(const char **machine, const struct hlt_table *, uint32_t i);

/* Areas and fronts, on stdout. */
void hlt_report_print(const struct hlt_table *, const char *path);
/* SCENE-MACHINE.svg and its likes in the folder. Where one cannot be made, a
 * line on stderr and no more; how many were made. */
uint32_t hlt_report_plot(const struct hlt_table *, const char *folder);
/* docs/json.md. */
bool hlt_report_json(const struct hlt_table *, const char *path,
                     const char *out, struct hlh_error *error);
#endif
