/* SPDX-License-Identifier: Zlib */
#ifndef HLK_REPORT_H
#define HLK_REPORT_H
/* What `halflight calibrate` says of itself. */
#include "platforms/calibrate/calibrate.h"

struct hlk_work {
    struct hlc_options o;        /* with the scenes that are drawn           */
    struct hl_caps caps;
    struct hlk_notes notes;
    struct hlk_frames frames[HLK_SCENES];    /* one an argument              */
    struct hlk_error errors[HLK_SCENES];
};

/* Inferred over forward as predicted, over that as measured: 1 is right.
 * `predicted` is frames' counted or planned. */
double hlk_agreement(const struct hlk_frames *,
                     const double predicted[HLK_WAYS][HLK_COSTS],
                     int costs);
/* Comments at the file's head. */
void hlk_head(struct hlk_work *);
bool hlk_json(const struct hlk_work *, const char *path,
              struct hlh_error *error);
#endif
