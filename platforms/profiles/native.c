/* SPDX-License-Identifier: Zlib */
/* No console: the planner chooses by what the machine says it can do. */
#include "platforms/profiles/hl_profiles.h"

const struct hl_profile hl_profile_native = {
    .name = "native",
    .id_steps = 65535.0f,            /* RG16_UNORM                           */
};
