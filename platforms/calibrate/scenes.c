/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/calibrate/calibrate.h"

const char *const hlk_scenes[] = { "fig8", "fig9", "lidr", "many", NULL };

bool hlk_is_scene(const char *name)
{
    for (int i = 0; hlk_scenes[i]; i++)
        if (!strcmp(hlk_scenes[i], name))
            return true;
    return false;
}
