/* SPDX-License-Identifier: Zlib */
#include <string.h>
#include "platforms/gl/hl_gl.h"
#include "platforms/null/hl_null.h"
#include "platforms/platforms.h"
#include "platforms/vulkan/hl_vulkan.h"

static const struct hl_backend *const list[] = {
    &hl_backend_vulkan,
    &hl_backend_gl,
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
