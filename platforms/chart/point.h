/* SPDX-License-Identifier: Zlib */
#ifndef HLT_POINT_H
#define HLT_POINT_H
/* A row of the table: one scene on one machine, drawn in one way. */
#include "platforms/chart/chart.h"
#include "platforms/chart/refs.h"
#include "platforms/cli/shot.h"

struct hlt_spot {
    char scene[HLT_NAME], machine[HLT_MACHINE];
    struct hlc_options o;        /* of the machine and size                  */
    uint32_t rounds;             /* timed; 0: no times                       */
    struct hlt_refs *refs;       /* borrowed                                 */
    struct hlc_stage stage;      /* what draws                               */
    struct hlc_stage counter;    /* packemu, where the stage is not          */
    bool counts, counts_tried;   /* counter is open; it was tried            */
    struct hlc_shot baseline;
    bool has_baseline;
    struct hl_probe probe;
    bool probed;
};

/* Open the machine with the scene o->arg[0]; the rest of *spot is set. Not to
 * be moved while open. An exit code, after one line. */
int hlt_spot_open(struct hlt_spot *);
void hlt_spot_close(struct hlt_spot *);
/* The way that times are ratios to; without it there are none. */
void hlt_spot_baseline(struct hlt_spot *, const struct hlt_way *);

enum { HLT_REFUSED = -1 };
/* Its plan alone. HLC_DONE; HLT_REFUSED with the reason in `line`; or an exit
 * code, after one line. */
int hlt_point_plan(struct hl_plan *, struct hlt_spot *, const struct hlt_way *,
                   char line[HLC_PLAN_LINE]);
/* Would the two draw the same? */
bool hlt_same_plan(const struct hl_plan *, const struct hl_plan *);
/* The row of a way whose plan draws the same as that of `like`. */
void hlt_point_alike(struct hlt_row *row, const struct hlt_spot *,
                     const struct hlt_way *, const struct hl_plan *,
                     const struct hlt_row *like);
/* Names without figures: of what was refused. */
void hlt_point_none(struct hlt_row *row, const struct hlt_spot *,
                    const struct hlt_way *);
/* Draw, count, compare, time. As hlt_point_plan. */
int hlt_point(struct hlt_row *row, struct hlt_spot *,
              const struct hlt_way *, char line[HLC_PLAN_LINE]);
#endif
