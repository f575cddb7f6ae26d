/* SPDX-License-Identifier: Zlib */
/* What it costs to read depth back: all of a target, and one texel, which is
 * submit and wait alone. Wall time: waiting is what is paid. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "platforms/calibrate/calibrate.h"
#include "platforms/cli/render.h"

enum { ROUNDS = 15 };

static hl_tex depth_target(struct hl_device *d, uint32_t w, uint32_t h)
{
    const struct hl_caps *caps = hl_device_caps(d);
    struct hl_tex_desc t = { "calibrate", HL_FORMAT_D32_FLOAT, w, h, 1, 1,
                             HL_TEX_TARGET | HL_TEX_READBACK, HL_FORMAT_NONE,
                             { 0 } };
    hl_tex tex = { 0 };
    if (!(caps->format[t.format].use & HL_USE_TARGET))
        t.format = HL_FORMAT_D24_UNORM_S8;
    if (!caps->console_memory &&
        (caps->format[t.format].use & HL_USE_TARGET))
        hl_tex_create(d, &tex, &t);
    return tex;
}

/* A clear, waited for, and its depth read; NAN where that cannot be. */
static double read_ms(struct hl_device *d, hl_tex tex, uint32_t w, uint32_t h,
                      float *room)
{
    struct hl_pass pass;
    memset(&pass, 0, sizeof pass);
    pass.label = "calibrate";
    pass.depth.tex = tex;
    pass.depth.load = HL_LOAD_CLEAR;
    double start = hlc_now_ms();
    if (!tex.id || hl_pass_run(d, &pass) != HL_OK ||
        hl_tex_read(d, tex, room, (size_t)w * h * sizeof *room) != HL_OK)
        return NAN;
    return hlc_now_ms() - start;
}

void hlk_readback(struct hl_caps *caps, struct hlk_notes *notes,
                  struct hl_device *d)
{
    float *room = calloc(256 * 256, sizeof *room);
    hl_tex all = depth_target(d, 256, 256), one = depth_target(d, 1, 1);
    double sync[ROUNDS], texel[ROUNDS];
    for (int r = -1; r < ROUNDS && room; r++) {
        double long_ms = read_ms(d, all, 256, 256, room);
        double short_ms = read_ms(d, one, 1, 1, room);
        if (r < 0)
            continue;
        sync[r] = short_ms * 1e6;
        texel[r] = (long_ms - short_ms) * 1e6 / (256.0 * 256.0);
    }
    hlk_take(caps, notes, "cost.sync_ns", sync, room ? ROUNDS : 0, false);
    hlk_take(caps, notes, "cost.readback_ns", texel, room ? ROUNDS : 0, false);
    free(room);
    hl_tex_destroy(d, &all);
    hl_tex_destroy(d, &one);
}
