/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
#ifdef __GLIBC__
#include <limits.h>
#include <malloc.h>
#endif
#include "hal/hal.h"
#include "platforms/cli/commands.h"

static int help(const struct hlc_options *o)
{
    enum hlc_command about = HLC_HELP;
    if (o->n_args && !hlc_command_find(&about, o->arg[0]))
        return hlc_fail(HLC_BAD, "help %s: no such command", o->arg[0]);
    hlc_options_help(about);
    return HLC_DONE;
}

static int run(const struct hlc_options *o)
{
    switch (o->command) {
    case HLC_RENDER: return hlc_cmd_render(o);
    case HLC_PLAN: return hlc_cmd_plan(o);
    case HLC_DEVICES: return hlc_cmd_devices(o);
    case HLC_SCENE: return hlc_cmd_scene(o);
    case HLC_COMPARE: return hlc_cmd_compare(o);
    case HLC_CONFORM: return hlc_cmd_conform(o);
    case HLC_CHART: return hlc_cmd_chart(o);
    case HLC_STABILITY: return hlc_cmd_stability(o);
    case HLC_CALIBRATE: return hlc_cmd_calibrate(o);
    case HLC_VERSION: printf("halflight %u\n", HL_VERSION); return HLC_DONE;
    default: return help(o);
    }
}

/* A software driver allocates a frame's vertices anew each time. Taken from
 * mmap, or given back to the system between frames, every page of them faults
 * again: a quarter of a frame with llvmpipe, the kernel's share of the time
 * going from 3 to 26 %. So large blocks stay on the heap, and the heap grown. */
static void keep_memory(void)
{
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, INT_MAX);
    mallopt(M_TOP_PAD, 64 << 20);
#endif
}

int main(int argc, char **argv)
{
    struct hlc_options options;
    keep_memory();
    int code = hlc_options_parse(&options, argc, argv);
    if (!code)
        code = run(&options);
    /* A full disk behind stdout shows only here. */
    if (fflush(stdout) != 0 && !code)
        code = hlc_fail(HLC_BAD, "stdout: cannot be written");
    return code;
}
