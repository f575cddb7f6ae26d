/* SPDX-License-Identifier: Zlib */
#include "platforms/cli/commands.h"

int hlc_cmd_stability(const struct hlc_options *o)
{
    return hlc_fail(HLC_BAD, "stability %u: nothing is swept yet", o->n_args);
}
