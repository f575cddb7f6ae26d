/* SPDX-License-Identifier: Zlib */
/* Device memory in blocks, and buffers. Drivers allow as few as 4096
 * allocations, so objects share blocks; images and buffers never do, which
 * spares bufferImageGranularity. */
#include <string.h>
#include "platforms/vulkan/vk.h"

enum { BLOCK_BYTES = 32 << 20 };

/* Mapped for good; coherent, so that nothing is ever flushed. */
#define HOST (VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | \
              VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)

/* ---- blocks ---------------------------------------------------------- */

static VkDeviceSize align_up(VkDeviceSize x, VkDeviceSize to)
{
    return (x + to - 1) / to * to;
}

static void unlink_block(struct hlvk *v, struct hlvk_block *block)
{
    struct hlvk_block **at = &v->blocks;
    while (*at != block)
        at = &(*at)->next;
    *at = block->next;
    vkFreeMemory(v->vk, block->memory, NULL);
    hl_bk_free(v->device, block->first);
    hl_bk_free(v->device, block);
}

static VkDeviceSize block_bytes(const struct hlvk *v, uint32_t type,
                                VkDeviceSize need)
{
    VkDeviceSize heap =
        v->memory.memoryHeaps[v->memory.memoryTypes[type].heapIndex].size;
    VkDeviceSize bytes = BLOCK_BYTES;
    if (bytes > heap / 16)
        bytes = heap / 16;
    /* A block that one object would half fill is that object's own. */
    if (need > bytes / 2)
        bytes = need;
    return bytes <= heap && bytes <= v->max_allocation ? bytes : 0;
}

static VkResult block_allocate(struct hlvk *v, struct hlvk_block *b)
{
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
        .allocationSize = b->bytes, .memoryTypeIndex = b->type
    };
    void *map = NULL;
    VkResult r = vkAllocateMemory(v->vk, &info, NULL, &b->memory);
    if (r == VK_SUCCESS &&
        (v->memory.memoryTypes[b->type].propertyFlags & HOST) == HOST) {
        r = vkMapMemory(v->vk, b->memory, 0, VK_WHOLE_SIZE, 0, &map);
        if (r != VK_SUCCESS)
            vkFreeMemory(v->vk, b->memory, NULL);
    }
    b->map = map;
    return r;
}

static struct hlvk_block *block_make(struct hlvk *v, uint32_t type,
                                     bool image, VkDeviceSize need)
{
    VkDeviceSize bytes = block_bytes(v, type, need);
    if (!bytes)
        return NULL;
    struct hlvk_block *b = hl_bk_alloc(v->device, sizeof *b);
    struct hlvk_segment *s = hl_bk_alloc(v->device, sizeof *s);
    if (b && s) {
        *b = (struct hlvk_block){
            .next = v->blocks, .bytes = bytes, .type = type, .image = image,
            .first = s
        };
        *s = (struct hlvk_segment){ .block = b, .bytes = bytes };
        if (block_allocate(v, b) == VK_SUCCESS)
            return v->blocks = b;
    }
    hl_bk_free(v->device, b);
    hl_bk_free(v->device, s);
    return NULL;
}

/* ---- segments -------------------------------------------------------- */

/* The rest of a segment becomes free. Without memory for its record the
 * segment stays whole: nothing fails, some bytes lie idle. */
static void split(struct hlvk *v, struct hlvk_segment *s, VkDeviceSize keep)
{
    if (s->bytes - keep < 256)
        return;
    struct hlvk_segment *rest = hl_bk_alloc(v->device, sizeof *rest);
    if (!rest)
        return;
    *rest = (struct hlvk_segment){
        .prev = s, .next = s->next, .block = s->block,
        .offset = s->offset + keep, .bytes = s->bytes - keep
    };
    if (s->next)
        s->next->prev = rest;
    s->next = rest;
    s->bytes = keep;
}

static void swallow_next(struct hlvk *v, struct hlvk_segment *s)
{
    struct hlvk_segment *gone = s->next;
    s->bytes += gone->bytes;
    s->next = gone->next;
    if (s->next)
        s->next->prev = s;
    hl_bk_free(v->device, gone);
}

static bool take(struct hlvk *v, struct hlvk_block *block,
                 const VkMemoryRequirements *need, struct hlvk_memory *out)
{
    for (struct hlvk_segment *s = block->first; s; s = s->next) {
        VkDeviceSize at = align_up(s->offset, need->alignment);
        if (s->used || at + need->size > s->offset + s->bytes)
            continue;
        split(v, s, at + need->size - s->offset);
        s->used = true;
        out->segment = s;
        out->memory = block->memory;
        out->offset = at;
        out->map = block->map ? block->map + at : NULL;
        return true;
    }
    return false;
}

static bool is_empty(const struct hlvk_block *b)
{
    return !b->first->used && !b->first->next;
}

/* One empty block of a kind is kept, lest a single object that comes and
 * goes allocate each time; but none that was made for one large object. */
static bool is_surplus(const struct hlvk *v, const struct hlvk_block *block)
{
    if (block->bytes > BLOCK_BYTES)
        return true;
    for (const struct hlvk_block *b = v->blocks; b; b = b->next)
        if (b != block && b->type == block->type &&
            b->image == block->image && is_empty(b))
            return true;
    return false;
}

void hlvk_memory_free(struct hlvk *v, struct hlvk_memory *m)
{
    struct hlvk_segment *s = m->segment;
    memset(m, 0, sizeof *m);
    if (!s)
        return;
    s->used = false;
    if (s->next && !s->next->used)
        swallow_next(v, s);
    if (s->prev && !s->prev->used) {
        s = s->prev;
        swallow_next(v, s);
    }
    if (is_empty(s->block) && is_surplus(v, s->block))
        unlink_block(v, s->block);
}

void hlvk_memory_close(struct hlvk *v)
{
    while (v->blocks) {
        while (v->blocks->first->next)
            swallow_next(v, v->blocks->first);
        unlink_block(v, v->blocks);
    }
}

/* ---- choice of a type ------------------------------------------------ */

/* What each use would like, then what it can live with. */
static const VkMemoryPropertyFlags wishes[][2] = {
    [HLVK_LOCAL] = { VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0 },
    [HLVK_UPLOAD] = { HOST | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, HOST },
    [HLVK_STAGE] = { HOST, HOST },
    [HLVK_READBACK] = { HOST | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, HOST }
};

static bool take_type(struct hlvk *v, uint32_t type, bool image,
                      const VkMemoryRequirements *need,
                      struct hlvk_memory *out)
{
    for (struct hlvk_block *b = v->blocks; b; b = b->next)
        if (b->type == type && b->image == image && take(v, b, need, out))
            return true;
    struct hlvk_block *b = block_make(v, type, image, need->size);
    return b && take(v, b, need, out);
}

static bool take_any(struct hlvk *v, enum hlvk_where where, bool image,
                     const VkMemoryRequirements *need,
                     struct hlvk_memory *out)
{
    /* Need a feature to be used, or exist for other purposes. */
    const VkMemoryPropertyFlags never =
        VK_MEMORY_PROPERTY_PROTECTED_BIT |
        VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT |
        VK_MEMORY_PROPERTY_DEVICE_COHERENT_BIT_AMD;
    for (uint32_t wish = 0; wish < 2; wish++)
        for (uint32_t i = 0; i < v->memory.memoryTypeCount; i++) {
            VkMemoryPropertyFlags has =
                v->memory.memoryTypes[i].propertyFlags;
            VkMemoryPropertyFlags want = wishes[where][wish];
            if (need->memoryTypeBits >> i & 1 && (has & want) == want &&
                !(has & never) && take_type(v, i, image, need, out))
                return true;
        }
    return false;
}

enum hl_result hlvk_memory_alloc(struct hlvk *v,
                                 const VkMemoryRequirements *need,
                                 enum hlvk_where where, bool image,
                                 struct hlvk_memory *out)
{
    if (take_any(v, where, image, need, out))
        return HL_OK;
    /* What was destroyed may still wait for its frame. */
    if (v->garbage && hlvk_wait(v) == HL_OK &&
        take_any(v, where, image, need, out))
        return HL_OK;
    return hlvk_check(v, VK_ERROR_OUT_OF_DEVICE_MEMORY,
                      image ? "memory of a texture" : "memory of a buffer");
}

/* ---- buffers --------------------------------------------------------- */

enum hl_result hlvk_buf_make(struct hlvk *v, VkDeviceSize bytes,
                             VkBufferUsageFlags usage, enum hlvk_where where,
                             VkBuffer *out, struct hlvk_memory *memory)
{
    VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
        .size = bytes, .usage = usage
    };
    *out = VK_NULL_HANDLE;
    if (bytes > v->max_buffer)
        return hlvk_check(v, VK_ERROR_OUT_OF_DEVICE_MEMORY,
                          "a buffer larger than the device's maxBufferSize");
    enum hl_result r = hlvk_check(v, vkCreateBuffer(v->vk, &info, NULL, out),
                                  "vkCreateBuffer");
    if (r)
        return r;
    VkMemoryRequirements need;
    vkGetBufferMemoryRequirements(v->vk, *out, &need);
    r = hlvk_memory_alloc(v, &need, where, false, memory);
    if (!r)
        r = hlvk_check(v, vkBindBufferMemory(v->vk, *out, memory->memory,
                                             memory->offset),
                       "vkBindBufferMemory");
    if (r) {
        hlvk_buf_unmake(v, *out, memory);
        *out = VK_NULL_HANDLE;
    }
    return r;
}

void hlvk_buf_unmake(struct hlvk *v, VkBuffer buffer,
                     struct hlvk_memory *memory)
{
    vkDestroyBuffer(v->vk, buffer, NULL);
    hlvk_memory_free(v, memory);
}

void hlvk_buf_release(struct hlvk *v, struct hlvk_buf *b)
{
    hlvk_buf_unmake(v, b->buffer, &b->memory);
    hl_bk_free(v->device, b);
}

static VkBufferUsageFlags buf_usage(uint32_t usage)
{
    static const VkBufferUsageFlags bits[] = {
        VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, VK_BUFFER_USAGE_INDEX_BUFFER_BIT,
        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
    };
    VkBufferUsageFlags u = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    for (int i = 0; i < 4; i++)
        if (usage >> i & 1)
            u |= bits[i];
    return u;
}

static enum hl_result upload(struct hlvk *v, struct hlvk_buf *b,
                             size_t offset, const void *data, size_t bytes)
{
    /* Everything that reads a buffer in a pass, and earlier copies. */
    static const VkMemoryBarrier2 reads = {
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, NULL,
        VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT |
            VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
            VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT |
            VK_PIPELINE_STAGE_2_COPY_BIT,
        VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT
    };
    static const VkDependencyInfo before = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = 1, .pMemoryBarriers = &reads
    };
    VkBufferCopy copy = { .dstOffset = offset, .size = bytes };
    VkBuffer from;
    struct hlvk_frame *f;
    enum hl_result r = hlvk_stage(v, data, bytes, &f, &from,
                                  &copy.srcOffset);
    if (r)
        return r;
    if (!b->fresh)
        vkCmdPipelineBarrier2(f->cmd, &before);
    vkCmdCopyBuffer(f->cmd, from, b->buffer, 1, &copy);
    v->copied = true;
    return HL_OK;
}

enum hl_result hlvk_buf_write(void *state, uint32_t slot, size_t offset,
                              const void *data, size_t bytes)
{
    struct hlvk *v = state;
    struct hlvk_buf *b = v->bufs[slot];
    if (!b->memory.map)
        return upload(v, b, offset, data, bytes);
    memcpy(b->memory.map + offset, data, bytes);
    return HL_OK;
}

enum hl_result hlvk_buf_create(void *state, uint32_t slot,
                               const struct hl_buf_desc *desc)
{
    struct hlvk *v = state;
    bool shared = v->kind == HL_DEVICE_CPU || v->kind == HL_DEVICE_INTEGRATED;
    enum hlvk_where where = desc->dynamic || shared ? HLVK_UPLOAD
                                                    : HLVK_LOCAL;
    struct hlvk_buf *b = hl_bk_alloc(v->device, sizeof *b);
    if (!b)
        return HL_ERR_MEMORY;
    b->bytes = desc->bytes;
    b->serial = ++v->serials;
    enum hl_result r = hlvk_buf_make(v, desc->bytes, buf_usage(desc->usage),
                                     where, &b->buffer, &b->memory);
    if (r) {
        hl_bk_free(v->device, b);
        return r;
    }
    hlvk_name(v, VK_OBJECT_TYPE_BUFFER, (uint64_t)b->buffer, desc->label);
    v->bufs[slot] = b;
    b->fresh = true;
    if (desc->data)
        r = hlvk_buf_write(v, slot, 0, desc->data, desc->bytes);
    b->fresh = false;
    if (r)
        hlvk_destroy(v, 'b', slot);
    return r;
}
