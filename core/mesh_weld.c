/* SPDX-License-Identifier: Zlib */
/* Open addressing with linear probing, never more than half full. */
#include <string.h>
#include "core/mesh_work.h"

enum { FIRST_ROOM = 64 };

/* Every word is multiplied through 64 bits and the high half folded down:
 * grid coordinates differ in few high bits of a float, which a plain sum
 * would leave in few slots. The multiplier is 2^64 / golden ratio, odd. */
static uint32_t mix(const uint32_t *key, uint32_t words)
{
    uint64_t h = words;
    for (uint32_t i = 0; i < words; i++) {
        h = (h ^ key[i]) * UINT64_C(0x9E3779B97F4A7C15);
        h ^= h >> 32;
    }
    return (uint32_t)(h * UINT64_C(0x9E3779B97F4A7C15) >> 32);
}

static bool same(const uint32_t *a, const uint32_t *b, uint32_t words)
{
    for (uint32_t i = 0; i < words; i++)
        if (a[i] != b[i])
            return false;
    return true;
}

/* The slot that holds the key, or the empty one where it belongs. */
static uint32_t probe(const struct hl_weld *weld, const uint32_t *key)
{
    uint32_t mask = 2 * weld->room - 1, slot = mix(key, weld->words) & mask;
    for (;; slot = (slot + 1) & mask) {
        uint32_t held = weld->slots[slot];
        *weld->n_steps += 1;
        if (held == 0 ||
            same(&weld->keys[(size_t)(held - 1) * weld->words], key,
                 weld->words))
            return slot;
    }
}

static enum hl_result grow(struct hl_weld *weld)
{
    enum hl_result result = HL_OK;
    uint32_t room = weld->room ? 2 * weld->room : FIRST_ROOM;
    size_t key_bytes = weld->words * sizeof *weld->keys;
    uint32_t *keys = hl_mem_new(weld->hooks, room, key_bytes, &result);
    uint32_t *slots =
        hl_mem_new(weld->hooks, room, 2 * sizeof *slots, &result);
    if (result != HL_OK) {
        hl_mem_free(weld->hooks, keys);
        return result;
    }
    if (weld->n > 0)
        memcpy(keys, weld->keys, weld->n * key_bytes);
    memset(slots, 0, room * (2 * sizeof *slots));
    hl_mem_free(weld->hooks, weld->keys);
    hl_mem_free(weld->hooks, weld->slots);
    weld->keys = keys;
    weld->slots = slots;
    weld->room = room;
    for (uint32_t i = 0; i < weld->n; i++)
        slots[probe(weld, &keys[(size_t)i * weld->words])] = i + 1;
    return HL_OK;
}

void hl_weld_open(struct hl_weld *weld, const struct hl_hooks *hooks,
                  uint32_t words, uint64_t *n_steps)
{
    memset(weld, 0, sizeof *weld);
    weld->hooks = hooks;
    weld->words = words;
    weld->n_steps = n_steps;
}

uint32_t hl_weld_find(const struct hl_weld *weld, const uint32_t *key)
{
    if (weld->n == 0)
        return HL_MESH_NONE;
    uint32_t held = weld->slots[probe(weld, key)];
    return held ? held - 1 : HL_MESH_NONE;
}

uint32_t hl_weld_add(struct hl_weld *weld, const uint32_t *key,
                     enum hl_result *result)
{
    if (*result != HL_OK)
        return HL_MESH_NONE;
    if (weld->n == weld->room && (*result = grow(weld)) != HL_OK)
        return HL_MESH_NONE;
    uint32_t slot = probe(weld, key);
    if (weld->slots[slot])
        return weld->slots[slot] - 1;
    memcpy(&weld->keys[(size_t)weld->n * weld->words], key,
           weld->words * sizeof *key);
    weld->slots[slot] = ++weld->n;
    return weld->n - 1;
}

void hl_weld_close(struct hl_weld *weld)
{
    hl_mem_free(weld->hooks, weld->keys);
    hl_mem_free(weld->hooks, weld->slots);
    weld->keys = weld->slots = NULL;
}
