/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/commands.h"

int hlc_cmd_chart(const struct hlc_options *o)
{
    return hlc_fail(HLC_BAD, "chart %s: nothing is swept yet", o->arg[0]);
}
