/* SPDX-License-Identifier: Zlib */
#ifndef HLT_TIME_H
#define HLT_TIME_H
/* Time of a way as a ratio to another's: what a shared machine does to one
 * frame it does to the next as well. */
#include "platforms/cli/shot.h"

struct hlt_ratio { double median, low, high; };  /* quartiles; NAN: no times */

/* Rounds of a frame of each, the two taking turns in who is first, after
 * frames that are not counted: drivers compile in the first. */
enum hl_result hlt_time(struct hlt_ratio *, struct hlc_shot *shot,
                        struct hlc_shot *baseline, uint32_t rounds);
#endif
