/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/profiles/hl_profiles.h"

static const struct hl_profile *const list[] = {
    &hl_profile_native,
    &hl_profile_dx10,
    &hl_profile_xbox360,
    &hl_profile_ps3,
};

const struct hl_profile *hl_profile_at(uint32_t i)
{
    return i < sizeof list / sizeof list[0] ? list[i] : NULL;
}

const struct hl_profile *hl_profile_find(const char *name)
{
    for (uint32_t i = 0; hl_profile_at(i); i++)
        if (strcmp(list[i]->name, name) == 0)
            return list[i];
    return NULL;
}
