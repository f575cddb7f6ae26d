/* SPDX-License-Identifier: Zlib */
/* Numbering a scene's regions; colouring itself is in ids_color.c. */
#include <string.h>
#include "core/ids.h"
#include "core/mem.h"

uint32_t hl_ids_limit(uint32_t bits)
{
    return bits >= 8 && bits <= 16 ? (1u << bits) - 2 : 0;
}

enum hl_result hl_ids_unique(uint32_t n_objects, const uint32_t *n_groups,
                             uint32_t limit, uint32_t *base,
                             uint64_t *n_needed)
{
    uint64_t sum = 0;
    if (n_objects > 0 && (!n_groups || !base))
        return HL_ERR_INVALID;
    for (uint32_t i = 0; i < n_objects; i++)
        sum += n_groups[i];
    if (n_needed)
        *n_needed = sum;
    if (sum > limit)
        return HL_ERR_LIMIT;
    for (uint32_t i = 0, next = 1; i < n_objects; i++) {
        base[i] = next;
        next += n_groups[i];
    }
    return HL_OK;
}

uint32_t hl_ids_count_shared(const uint32_t *pairs, uint32_t n_pairs,
                             const uint32_t *ids)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < n_pairs; i++) {
        uint32_t a = pairs[2 * (size_t)i], b = pairs[2 * (size_t)i + 1];
        n += a != b && ids[a] == ids[b];
    }
    return n;
}

/* ---- a scene --------------------------------------------------------- */

static uint32_t colors_of(const struct hl_ids_object *object)
{
    return object->n_colors ? object->n_colors : object->n_groups;
}

/* Ids that the object takes when it has a range to itself. */
static uint32_t ids_of(const struct hl_ids_object *object, bool coloured)
{
    return coloured ? colors_of(object) : object->n_groups;
}

static bool scene_valid(const struct hl_ids_scene *scene)
{
    if (scene->limit == 0 || (scene->n_objects > 0 && !scene->objects))
        return false;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].n_colors > scene->objects[i].n_groups)
            return false;
    return true;
}

/* False when the objects do not fit one after the other. */
static bool assign_ranges(const struct hl_ids_scene *scene, bool coloured,
                          uint32_t *base, struct hl_ids_plan *plan)
{
    uint64_t sum = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        sum += ids_of(&scene->objects[i], coloured);
    if (sum > scene->limit)
        return false;
    memset(plan, 0, sizeof *plan);
    plan->scheme = coloured ? HL_IDS_GROUPS_COLORED : HL_IDS_UNIQUE;
    plan->n_ids = (uint32_t)sum;
    for (uint32_t i = 0, next = 1; i < scene->n_objects; i++) {
        uint32_t n = ids_of(&scene->objects[i], coloured);
        base[i] = next;
        next += n;
        if (n > plan->stride)
            plan->stride = n;
    }
    return true;
}

/* One stride for all keeps an id's range a product; it is what the object
 * with the most colours takes, as far as that fits. */
static enum hl_result color_objects(const struct hl_hooks *hooks,
                                    const struct hl_ids_scene *scene,
                                    uint32_t *base, struct hl_ids_plan *out)
{
    struct hl_ids_coloring coloring;
    struct hl_ids_plan plan;
    enum hl_result result;
    memset(&plan, 0, sizeof plan);
    plan.scheme = HL_IDS_COLORED;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        uint32_t n = colors_of(&scene->objects[i]);
        plan.n_folded += n > scene->limit;
        n = n > scene->limit ? scene->limit : n;
        plan.stride = n > plan.stride ? n : plan.stride;
    }
    result = hl_ids_color(hooks, scene->n_objects, scene->meetings,
                          scene->n_meetings, scene->limit / plan.stride, base,
                          &coloring);
    if (result != HL_OK)
        return result;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        base[i] = 1 + base[i] * plan.stride;
    plan.n_object_colors = coloring.n_colors;
    plan.n_conflicts = coloring.n_conflicts;
    plan.n_ids = coloring.n_colors * plan.stride;
    *out = plan;
    return HL_OK;
}

enum hl_result hl_ids_assign(const struct hl_hooks *hooks,
                             const struct hl_ids_scene *scene, uint32_t *base,
                             struct hl_ids_plan *out)
{
    if (!hl_mem_hooks_valid(hooks) || !scene || !out || !scene_valid(scene) ||
        (scene->n_objects > 0 && !base))
        return HL_ERR_INVALID;
    if (assign_ranges(scene, false, base, out) ||
        assign_ranges(scene, true, base, out))
        return HL_OK;
    if (!scene->meetings)
        return HL_ERR_LIMIT;
    return color_objects(hooks, scene, base, out);
}

uint32_t hl_ids_region(const struct hl_ids_plan *plan, uint32_t base,
                       uint32_t group, uint32_t color)
{
    if (plan->scheme == HL_IDS_UNIQUE)
        return base + group;
    return base + (color < plan->stride ? color : color % plan->stride);
}

/* ---- the paper's ids ------------------------------------------------- */

/* A counter through a 64-bit finaliser (two multiply-xorshift rounds): any
 * number of the stream at once, no state. */
uint8_t hl_ids_random8(uint64_t seed, uint32_t index)
{
    uint64_t x = seed + (index + UINT64_C(1)) * UINT64_C(0x9E3779B97F4A7C15);
    x = (x ^ x >> 29) * UINT64_C(0xD6E8FEB86659FD93);
    x = (x ^ x >> 32) * UINT64_C(0xA0761D6478BD642F);
    return (uint8_t)((x ^ x >> 32) >> 24 & 255);
}

uint32_t hl_ids_paper_region(uint8_t object, uint8_t group)
{
    uint32_t id = (uint32_t)object << 8 | group;
    if (id == 0)
        return 1;
    return id == 65535 ? 65534 : id;
}
