/* SPDX-License-Identifier: Zlib */
#include "platforms/chart/time.h"
#include <math.h>
#include <stdlib.h>
#include "platforms/cli/render.h"

enum { WARM = 1 };

static enum hl_result one_round(double *ratio, struct hlc_shot *shot,
                                struct hlc_shot *baseline, bool first)
{
    double a = 0, b = 0;
    enum hl_result r = hlc_shot_draw(first ? shot : baseline, first ? &a : &b);
    if (r == HL_OK)
        r = hlc_shot_draw(first ? baseline : shot, first ? &b : &a);
    *ratio = b > 0 ? a / b : 1;
    return r;
}

enum hl_result hlt_time(struct hlt_ratio *out, struct hlc_shot *shot,
                        struct hlc_shot *baseline, uint32_t rounds)
{
    double unread, *ratio = calloc((size_t)rounds + 1, sizeof *ratio);
    enum hl_result r = ratio ? HL_OK : HL_ERR_MEMORY;
    *out = (struct hlt_ratio){ (double)NAN, (double)NAN, (double)NAN };
    for (uint32_t i = 0; i < WARM && rounds && r == HL_OK; i++)
        r = one_round(&unread, shot, baseline, i % 2);
    for (uint32_t i = 0; i < rounds && r == HL_OK; i++)
        r = one_round(&ratio[i], shot, baseline, i % 2);
    if (r == HL_OK && rounds) {
        struct hlc_quartiles q = hlc_quartiles_of(ratio, rounds);
        *out = (struct hlt_ratio){ q.median, q.low, q.high };
    }
    free(ratio);
    return r;
}
