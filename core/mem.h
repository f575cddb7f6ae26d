/* SPDX-License-Identifier: Zlib */
#ifndef HL_MEM_H
#define HL_MEM_H
/* Private to core: arrays through the embedder's hooks. */
#include "hal/hal.h"

/* False when count * size does not fit a size_t. */
bool hl_mem_fits(size_t count, size_t size);

/* An uninitialised array, or NULL: for count 0, on failure, and when *result
 * is not HL_OK already, so that a row of calls needs one check at its end.
 * Failure sets *result: HL_ERR_LIMIT (the size overflows), HL_ERR_MEMORY. */
void *hl_mem_new(const struct hl_hooks *hooks, size_t count, size_t size,
                 enum hl_result *result);
/* NULL is allowed and not passed on. */
void hl_mem_free(const struct hl_hooks *hooks, void *memory);
/* Both functions are there. */
bool hl_mem_hooks_valid(const struct hl_hooks *hooks);
#endif
