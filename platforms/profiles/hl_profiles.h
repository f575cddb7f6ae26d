/* SPDX-License-Identifier: Zlib */
#ifndef HL_PROFILES_H
#define HL_PROFILES_H
/* The consoles that can be planned for: hl_device_desc.profile. An embedder
 * may fill a struct hl_profile of its own instead. */
#include "hal/caps.h"

extern const struct hl_profile hl_profile_native, hl_profile_dx10,
                               hl_profile_xbox360, hl_profile_ps3;

/* NULL past the last; `native` is first. */
const struct hl_profile *hl_profile_at(uint32_t i);
/* By name; NULL when there is none. */
const struct hl_profile *hl_profile_find(const char *name);
#endif
