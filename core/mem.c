/* SPDX-License-Identifier: Zlib */
#include "core/mem.h"

bool hl_mem_fits(size_t count, size_t size)
{
    return size == 0 || count <= SIZE_MAX / size;
}

void *hl_mem_new(const struct hl_hooks *hooks, size_t count, size_t size,
                 enum hl_result *result)
{
    void *memory = NULL;
    if (*result != HL_OK || count == 0)
        return NULL;
    if (!hl_mem_fits(count, size)) {
        *result = HL_ERR_LIMIT;
        return NULL;
    }
    memory = hooks->alloc(hooks->user, count * size);
    if (!memory)
        *result = HL_ERR_MEMORY;
    return memory;
}

void hl_mem_free(const struct hl_hooks *hooks, void *memory)
{
    if (memory)
        hooks->free(hooks->user, memory);
}

bool hl_mem_hooks_valid(const struct hl_hooks *hooks)
{
    return hooks && hooks->alloc && hooks->free;
}
