/* SPDX-License-Identifier: Zlib */
#ifndef HL_PLATFORMS_H
#define HL_PLATFORMS_H
/* The backends compiled into this program, in order of preference. */
#include "hal/backend.h"

/* NULL past the last. `null` is last and draws nothing. */
const struct hl_backend *hl_platform(uint32_t i);
/* By name; NULL when there is none. */
const struct hl_backend *hl_platform_find(const char *name);
#endif
