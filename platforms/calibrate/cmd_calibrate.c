/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/commands.h"

int hlc_cmd_calibrate(const struct hlc_options *o)
{
    return hlc_fail(HLC_BAD, "calibrate %u: nothing is measured yet",
                    o->n_args);
}
