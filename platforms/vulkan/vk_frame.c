/* SPDX-License-Identifier: Zlib */
/* Frames: what is recorded between two submits, in call order. One records
 * while the other executes. After a submit at most one is unfinished, so an
 * embedder that fills two sets of dynamic buffers in turn never writes what
 * is being read. */
#include <string.h>
#include "platforms/vulkan/vk.h"

enum {
    QUERIES = 256,           /* timestamps a pool                            */
    CHUNK_BYTES = 4 << 20,   /* staging                                      */
    SPARE_CHUNKS = 8,
    STAGED_BYTES = 64 << 20  /* uploads alone are submitted from here on     */
};

/* ---- staging --------------------------------------------------------- */

static void chunk_destroy(struct hlvk *v, struct hlvk_chunk *c)
{
    hlvk_buf_unmake(v, c->buffer, &c->memory);
    hl_bk_free(v->device, c);
}

static enum hl_result chunk_make(struct hlvk *v, VkDeviceSize bytes,
                                 struct hlvk_chunk **out)
{
    struct hlvk_chunk *c = v->spare;
    if (c && bytes <= CHUNK_BYTES) {
        v->spare = c->next;
        v->n_spare--;
        *out = c;
        return HL_OK;
    }
    c = hl_bk_alloc(v->device, sizeof *c);
    if (!c)
        return HL_ERR_MEMORY;
    c->bytes = bytes < CHUNK_BYTES ? CHUNK_BYTES : bytes;
    enum hl_result r = hlvk_buf_make(v, c->bytes,
                                     VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                     HLVK_STAGE, &c->buffer, &c->memory);
    if (r)
        hl_bk_free(v->device, c);
    else
        *out = c;
    return r;
}

static void chunks_release(struct hlvk *v, struct hlvk_frame *f)
{
    while (f->chunks) {
        struct hlvk_chunk *c = f->chunks;
        f->chunks = c->next;
        if (c->bytes > CHUNK_BYTES || v->n_spare >= SPARE_CHUNKS) {
            chunk_destroy(v, c);
            continue;
        }
        c->used = 0;
        c->next = v->spare;
        v->spare = c;
        v->n_spare++;
    }
    f->staged = 0;
}

enum hl_result hlvk_stage(struct hlvk *v, const void *data, size_t bytes,
                          struct hlvk_frame **frame, VkBuffer *buffer,
                          VkDeviceSize *offset)
{
    struct hlvk_frame *f = &v->frames[v->frame];
    enum hl_result r = HL_OK;
    /* Loading a scene holds little staging memory. A frame with passes is
     * left whole: its timings belong together. */
    if (f->staged > STAGED_BYTES && f->n_passes == 0)
        r = hlvk_flush(v, false);
    if (!r)
        r = hlvk_begin(v, &f);
    if (r)
        return r;
    struct hlvk_chunk *c = f->chunks;
    if (!c || c->bytes - c->used < bytes) {
        r = chunk_make(v, bytes, &c);
        if (r)
            return r;
        c->next = f->chunks;
        f->chunks = c;
    }
    memcpy(c->memory.map + c->used, data, bytes);
    *frame = f;
    *buffer = c->buffer;
    *offset = c->used;
    c->used = (c->used + bytes + v->copy_align - 1) / v->copy_align *
              v->copy_align;
    if (c->used > c->bytes)
        c->used = c->bytes;
    f->staged += bytes;
    return HL_OK;
}

/* ---- objects that wait ----------------------------------------------- */

static void release(struct hlvk *v, struct hlvk_object *object)
{
    if (object->kind == 'b')
        hlvk_buf_release(v, (struct hlvk_buf *)object);
    else if (object->kind == 't')
        hlvk_tex_release(v, (struct hlvk_tex *)object);
    else
        hlvk_prog_release(v, (struct hlvk_prog *)object);
}

static void collect(struct hlvk *v)
{
    struct hlvk_object **at = &v->garbage;
    while (*at) {
        struct hlvk_object *object = *at;
        if (object->frame > v->completed) {
            at = &object->next;
            continue;
        }
        *at = object->next;
        release(v, object);
    }
}

void hlvk_destroy(void *state, char kind, uint32_t slot)
{
    struct hlvk *v = state;
    struct hlvk_object *object = NULL;
    if (kind == 'b' && v->bufs[slot]) {
        object = &v->bufs[slot]->head;
        v->bufs[slot] = NULL;
    } else if (kind == 't' && v->texs[slot]) {
        object = &v->texs[slot]->head;
        v->texs[slot] = NULL;
    } else if (kind == 'p' && v->progs[slot]) {
        object = &v->progs[slot]->head;
        v->progs[slot] = NULL;
    }
    if (!object)
        return;
    object->kind = kind;
    /* The frame that records, or the last that was submitted. */
    object->frame = v->serial;
    if (object->frame <= v->completed) {
        release(v, object);
        return;
    }
    object->next = v->garbage;
    v->garbage = object;
}

/* ---- timings ----------------------------------------------------------- */

/* One timestamp before the first pass and one after each: a pass's time runs
 * from the end of the pass before it. On lavapipe each drains the machine, so
 * they are not taken in pairs. */
static enum hl_result reserve_stamps(struct hlvk *v, struct hlvk_frame *f)
{
    VkQueryPoolCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
        .queryType = VK_QUERY_TYPE_TIMESTAMP, .queryCount = QUERIES
    };
    uint32_t pools = (f->n_passes + 1) / QUERIES + 1;
    if (v->tick_ms <= 0.0)
        return HL_OK;
    if (!hl_bk_grow(v->device, &f->labels, &f->max_labels, f->n_passes + 1,
                   sizeof *f->labels) ||
        !hl_bk_grow(v->device, &f->queries, &f->max_queries, pools,
                   sizeof *f->queries))
        return HL_ERR_MEMORY;
    while (f->n_queries < pools) {
        enum hl_result r = hlvk_check(
            v, vkCreateQueryPool(v->vk, &info, NULL,
                                 &f->queries[f->n_queries]),
            "vkCreateQueryPool");
        if (r)
            return r;
        f->n_queries++;
    }
    return HL_OK;
}

static void stamp(struct hlvk_frame *f, uint32_t query)
{
    VkQueryPool pool = f->queries[query / QUERIES];
    if (query % QUERIES == 0)
        vkCmdResetQueryPool(f->cmd, pool, 0, QUERIES);
    vkCmdWriteTimestamp2(f->cmd, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, pool,
                         query % QUERIES);
}

void hlvk_pass_begin(struct hlvk *v, struct hlvk_frame *f, const char *label)
{
    if (v->tick_ms <= 0.0)
        return;
    f->labels[f->n_passes] = label;
    if (f->n_passes == 0)
        stamp(f, 0);
}

void hlvk_pass_end(struct hlvk *v, struct hlvk_frame *f)
{
    f->n_passes++;
    if (v->tick_ms > 0.0)
        stamp(f, f->n_passes);
}

static void read_timings(struct hlvk *v, struct hlvk_frame *f)
{
    uint32_t n = f->n_passes + 1;
    v->n_timings = 0;
    if (v->tick_ms <= 0.0 ||
        !hl_bk_grow(v->device, &v->timings, &v->max_timings, n,
                    sizeof *v->timings) ||
        !hl_bk_grow(v->device, &v->stamps, &v->max_stamps, n,
                    sizeof *v->stamps))
        return;
    for (uint32_t at = 0; at < n; at += QUERIES) {
        uint32_t k = n - at < QUERIES ? n - at : QUERIES;
        if (vkGetQueryPoolResults(v->vk, f->queries[at / QUERIES], 0, k,
                                  k * sizeof *v->stamps, v->stamps + at,
                                  sizeof *v->stamps,
                                  VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
            return;
    }
    for (uint32_t i = 0; i < f->n_passes; i++) {
        uint64_t ticks = (v->stamps[i + 1] - v->stamps[i]) & v->tick_mask;
        v->timings[i].fragments = v->timings[i].blended = 0;
        v->timings[i].label = f->labels[i];
        v->timings[i].ms = (double)ticks * v->tick_ms;
    }
    v->n_timings = f->n_passes;
}

uint32_t hlvk_timings(void *state, struct hl_timing *out, uint32_t max)
{
    struct hlvk *v = state;
    uint32_t n = v->n_timings < max ? v->n_timings : max;
    if (n)
        memcpy(out, v->timings, n * sizeof *out);
    return v->n_timings;
}

/* ---- command buffers --------------------------------------------------- */

/* Textures' layouts are tracked as if all that was recorded had run; once it
 * cannot, nothing on this device can be trusted. */
static enum hl_result cannot_run(struct hlvk *v)
{
    v->lost = true;
    hl_bk_log(v->device, HL_LOG_ERROR, HL_MSG_DEVICE,
              "recorded work could not be submitted", NULL, NULL);
    return HL_ERR_DEVICE_LOST;
}

static enum hl_result cmd_begin(struct hlvk *v, struct hlvk_frame *f)
{
    static const VkCommandBufferBeginInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
        .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT
    };
    VkCommandBufferAllocateInfo make = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = f->pool, .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1
    };
    enum hl_result r = HL_OK;
    if (!hl_bk_grow(v->device, &f->cmds, &f->max_cmds, f->n_cmds + 1,
                   sizeof *f->cmds))
        return HL_ERR_MEMORY;
    if (f->n_cmds == f->n_made) {
        r = hlvk_check(v, vkAllocateCommandBuffers(v->vk, &make,
                                                   &f->cmds[f->n_made]),
                       "vkAllocateCommandBuffers");
        f->n_made += !r;
    }
    if (!r)
        r = hlvk_check(v, vkBeginCommandBuffer(f->cmds[f->n_cmds], &info),
                       "vkBeginCommandBuffer");
    if (r)
        return r;
    f->cmd = f->cmds[f->n_cmds++];
    f->storage = false;
    return HL_OK;
}

enum hl_result hlvk_begin(struct hlvk *v, struct hlvk_frame **out)
{
    struct hlvk_frame *f = *out = &v->frames[v->frame];
    if (v->lost)
        return HL_ERR_DEVICE_LOST;
    if (f->recording)
        return HL_OK;
    f->n_cmds = 0;
    enum hl_result r = hlvk_check(v, vkResetCommandPool(v->vk, f->pool, 0),
                                  "vkResetCommandPool");
    if (!r)
        r = cmd_begin(v, f);
    if (r)
        return r;
    f->serial = ++v->serial;
    f->recording = true;
    f->n_passes = 0;
    hlvk_sets_frame(v);
    return HL_OK;
}

/* lavapipe goes on paying for a bound storage buffer, 14 us a draw, until its
 * command buffer ends: passes that read none do not follow in the same. */
enum hl_result hlvk_pass_reserve(struct hlvk *v, struct hlvk_frame *f,
                                 bool storage)
{
    enum hl_result r = reserve_stamps(v, f);
    VkCommandBuffer old = f->cmd;
    if (!r && f->storage && !storage) {
        r = cmd_begin(v, f);
        if (!r && hlvk_check(v, vkEndCommandBuffer(old),
                             "vkEndCommandBuffer"))
            return cannot_run(v);
    }
    f->storage |= !r && storage;
    return r;
}

/* ---- submit ------------------------------------------------------------ */

static enum hl_result retire(struct hlvk *v, struct hlvk_frame *f)
{
    if (!f->submitted)
        return HL_OK;
    enum hl_result r = hlvk_check(
        v, vkWaitForFences(v->vk, 1, &f->fence, VK_TRUE, UINT64_MAX),
        "vkWaitForFences");
    if (!r)
        r = hlvk_check(v, vkResetFences(v->vk, 1, &f->fence),
                       "vkResetFences");
    if (r)
        return r;
    f->submitted = false;
    v->completed = f->serial;
    chunks_release(v, f);
    collect(v);
    return HL_OK;
}

enum hl_result hlvk_wait(struct hlvk *v)
{
    enum hl_result r = HL_OK;
    /* From the frame that records on: the other one is the younger. */
    for (uint32_t i = 0; i < HLVK_FRAMES && !r; i++)
        r = retire(v, &v->frames[(v->frame + i) % HLVK_FRAMES]);
    return r;
}

static enum hl_result submit_frame(struct hlvk *v, struct hlvk_frame *f)
{
    VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
        .commandBufferCount = f->n_cmds, .pCommandBuffers = f->cmds
    };
    f->recording = false;
    if (hlvk_check(v, vkEndCommandBuffer(f->cmd), "vkEndCommandBuffer") ||
        hlvk_check(v, vkQueueSubmit(v->queue, 1, &info, f->fence),
                   "vkQueueSubmit"))
        return cannot_run(v);
    f->submitted = true;
    v->frame = (v->frame + 1) % HLVK_FRAMES;
    return HL_OK;
}

enum hl_result hlvk_flush(struct hlvk *v, bool wait)
{
    struct hlvk_frame *f = &v->frames[v->frame];
    bool recorded = f->recording;
    enum hl_result r = v->lost ? HL_ERR_DEVICE_LOST : HL_OK;
    if (!r && recorded)
        r = submit_frame(v, f);
    if (!r)
        r = wait ? hlvk_wait(v) : retire(v, &v->frames[v->frame]);
    if (!r && wait && recorded && f->n_passes)
        read_timings(v, f);
    return r;
}

enum hl_result hlvk_submit(void *state, bool wait)
{
    struct hlvk *v = state;
    if (wait)
        v->n_timings = 0;
    return hlvk_flush(v, wait);
}

/* ---- open and close -------------------------------------------------- */

static enum hl_result frame_open(struct hlvk *v, struct hlvk_frame *f)
{
    VkCommandPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
        .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
        .queueFamilyIndex = v->family
    };
    VkFenceCreateInfo fence = {
        .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO
    };
    enum hl_result r = hlvk_check(
        v, vkCreateCommandPool(v->vk, &pool, NULL, &f->pool),
        "vkCreateCommandPool");
    if (!r)
        r = hlvk_check(v, vkCreateFence(v->vk, &fence, NULL, &f->fence),
                       "vkCreateFence");
    return r;
}

enum hl_result hlvk_frames_open(struct hlvk *v)
{
    enum hl_result r = HL_OK;
    for (int i = 0; i < HLVK_FRAMES && !r; i++)
        r = frame_open(v, &v->frames[i]);
    return r;
}

static void frame_close(struct hlvk *v, struct hlvk_frame *f)
{
    /* Recorded but never submitted work goes with its pool. */
    vkDestroyCommandPool(v->vk, f->pool, NULL);
    vkDestroyFence(v->vk, f->fence, NULL);
    for (uint32_t i = 0; i < f->n_queries; i++)
        vkDestroyQueryPool(v->vk, f->queries[i], NULL);
    hl_bk_free(v->device, f->queries);
    hl_bk_free(v->device, f->cmds);
    hl_bk_free(v->device, f->labels);
    chunks_release(v, f);
}

void hlvk_frames_close(struct hlvk *v)
{
    /* Only our own work is waited for: the queue may be an embedder's. A
     * lost device gives errors here, and may be taken apart all the same. */
    for (uint32_t i = 0; i < HLVK_FRAMES; i++)
        if (v->frames[i].submitted)
            vkWaitForFences(v->vk, 1, &v->frames[i].fence, VK_TRUE,
                            UINT64_MAX);
    v->completed = v->serial;
    for (uint32_t i = 0; i < HLVK_FRAMES; i++)
        frame_close(v, &v->frames[i]);
    while (v->spare) {
        struct hlvk_chunk *c = v->spare;
        v->spare = c->next;
        chunk_destroy(v, c);
    }
    hl_bk_free(v->device, v->timings);
    hl_bk_free(v->device, v->stamps);
    collect(v);
    if (v->readback.buffer)
        hlvk_buf_unmake(v, v->readback.buffer, &v->readback.memory);
}
