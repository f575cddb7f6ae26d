/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/progress.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include "platforms/cli/render.h"

enum { COLUMNS = 72 };

void hlt_progress_begin(struct hlt_progress *p, uint32_t total)
{
    memset(p, 0, sizeof *p);
    p->terminal = isatty(STDERR_FILENO) == 1;
    p->start = hlc_now_ms();
    p->last = p->start - 1000;
    p->total = total;
}

static void left(char out[32], const struct hlt_progress *p, double now)
{
    uint32_t measured = p->done - p->skipped;
    double s = (now - p->start) * 1e-3 * (p->total - p->done) /
               (measured ? measured : 1);
    out[0] = 0;
    if (measured > 2 && s < 90)
        snprintf(out, 32, ", %.0f s left", s);
    else if (measured > 2)
        snprintf(out, 32, ", %.0f min left", s / 60);
}

void hlt_progress_show(struct hlt_progress *p, const char *scene,
                       const char *machine, uint32_t i, uint32_t n)
{
    double now = hlc_now_ms();
    char time[32], line[COLUMNS + 1];
    if (!p->terminal || now - p->last < 200)
        return;
    left(time, p, now);
    snprintf(line, sizeof line, "%.32s %s %u/%u%s", scene, machine,
             (unsigned)i, (unsigned)n, time);
    fprintf(stderr, "\r%-*s", COLUMNS, line);
    fflush(stderr);
    p->last = now;
    p->shown = true;
}

void hlt_progress_step(struct hlt_progress *p, bool quick)
{
    p->done++;
    p->skipped += quick;
}

void hlt_progress_hide(struct hlt_progress *p)
{
    if (p->shown)
        fprintf(stderr, "\r%-*s\r", COLUMNS, "");
    p->shown = false;
}
