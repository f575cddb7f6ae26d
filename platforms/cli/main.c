/* SPDX-License-Identifier: Zlib */
#include <stdio.h>
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
    case HLC_VERSION: printf("halflight %u\n", HL_VERSION); return HLC_DONE;
    default: return help(o);
    }
}

int main(int argc, char **argv)
{
    struct hlc_options options;
    int code = hlc_options_parse(&options, argc, argv);
    if (!code)
        code = run(&options);
    /* A full disk behind stdout shows only here. */
    if (fflush(stdout) != 0 && !code)
        code = hlc_fail(HLC_BAD, "stdout: cannot be written");
    return code;
}
