/* SPDX-License-Identifier: Zlib */
#ifndef HLT_PROGRESS_H
#define HLT_PROGRESS_H
/* One line on stderr that is written over: "fig8 vulkan 37/96, 4 min left".
 * Nothing where stderr is no terminal. */
#include <stdbool.h>
#include <stdint.h>

struct hlt_progress {
    bool shown;                  /* there is a line to be wiped              */
    bool terminal;
    double start, last;          /* ms                                       */
    uint32_t total, done;        /* points of the whole sweep                */
    uint32_t skipped;            /* of done: took no time, and tell nothing  */
};

void hlt_progress_begin(struct hlt_progress *, uint32_t total);
/* Before point i of n of a scene and machine. */
void hlt_progress_show(struct hlt_progress *, const char *scene,
                       const char *machine, uint32_t i, uint32_t n);
/* After a point; quick: it was there already. */
void hlt_progress_step(struct hlt_progress *, bool quick);
/* Wipe the line, before other output too. */
void hlt_progress_hide(struct hlt_progress *);
#endif
