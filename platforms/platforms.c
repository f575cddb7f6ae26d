/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/gl/hl_gl.h"
#include "platforms/null/hl_null.h"
#include "platforms/packemu/hl_packemu.h"
#include "platforms/platforms.h"
#include "platforms/vulkan/hl_vulkan.h"

/* HL_NO_DRIVERS: of those that need the C library alone. */
static const struct hl_backend *const list[] = {
#ifndef HL_NO_DRIVERS
    &hl_backend_vulkan,
    &hl_backend_gl,
#endif
    &hl_backend_packemu,
    &hl_backend_null,
};

const struct hl_backend *hl_platform(uint32_t i)
{
    return i < sizeof list / sizeof list[0] ? list[i] : NULL;
}

const struct hl_backend *hl_platform_find(const char *name)
{
    for (uint32_t i = 0; hl_platform(i); i++)
        if (strcmp(list[i]->name, name) == 0)
            return list[i];
    return NULL;
}
