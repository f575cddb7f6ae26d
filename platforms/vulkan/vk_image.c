/* SPDX-License-Identifier: Zlib */
/* Textures: images, the layout and access each was last used in, uploads and
 * reading back. */
#include <string.h>
#include "platforms/vulkan/vk.h"

/* ---- uses and barriers ----------------------------------------------- */

#define SHADERS (VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | \
                 VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT)
#define DEPTH_TESTS (VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | \
                     VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT)

/* All that a use may do, so that equal read-only uses in sequence need no
 * barrier between them. */
static const struct {
    VkImageLayout layout;
    VkPipelineStageFlags2 stages;
    VkAccessFlags2 reads, writes;
} uses[] = {
    [HLVK_USE_NONE] = { VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, 0 },
    [HLVK_USE_SAMPLED] = {
        VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, SHADERS,
        VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0 },
    [HLVK_USE_COLOR] = {
        VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT,
        VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT },
    [HLVK_USE_DEPTH] = {
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, DEPTH_TESTS,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT },
    /* Tested against and sampled, in one pass or in several. */
    [HLVK_USE_DEPTH_READ] = {
        VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
        SHADERS | DEPTH_TESTS,
        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
            VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0 },
    [HLVK_USE_COPY_TO] = {
        VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
        0, VK_ACCESS_2_TRANSFER_WRITE_BIT },
    [HLVK_USE_COPY_FROM] = {
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
        VK_ACCESS_2_TRANSFER_READ_BIT, 0 }
};

VkImageLayout hlvk_layout(enum hlvk_use use)
{
    return uses[use].layout;
}

enum hlvk_use hlvk_sampled(const struct hlvk_tex *t)
{
    return hl_format_info(t->format)->kind == HL_KIND_DEPTH
           ? HLVK_USE_DEPTH_READ : HLVK_USE_SAMPLED;
}

void hlvk_tex_use(struct hlvk *v, VkCommandBuffer cmd, struct hlvk_tex *t,
                  enum hlvk_use use, bool discard)
{
    VkImageMemoryBarrier2 *b;
    if (t->use == use && !uses[use].writes)
        return;
    if (v->n_barriers == HLVK_BARRIERS)
        hlvk_barrier(v, cmd);
    b = &v->barriers[v->n_barriers++];
    memset(b, 0, sizeof *b);
    b->sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    b->srcStageMask = uses[t->use].stages;
    b->srcAccessMask = uses[t->use].writes;
    b->dstStageMask = uses[use].stages;
    b->dstAccessMask = uses[use].reads | uses[use].writes;
    /* Levels share one state: other levels' contents must live on. */
    b->oldLayout = discard && t->mips == 1 ? VK_IMAGE_LAYOUT_UNDEFINED
                                           : uses[t->use].layout;
    b->newLayout = uses[use].layout;
    b->srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    b->dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    b->image = t->image;
    b->subresourceRange.aspectMask = hlvk_aspects(t->format);
    b->subresourceRange.levelCount = t->mips;
    b->subresourceRange.layerCount = 1;
    t->use = use;
}

void hlvk_barrier(struct hlvk *v, VkCommandBuffer cmd)
{
    /* Buffers copied to, before any pass reads them. */
    static const VkMemoryBarrier2 copied = {
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, NULL,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | SHADERS,
        VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
            VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT
    };
    VkDependencyInfo info = { .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO };
    if (!v->n_barriers && !v->copied)
        return;
    info.memoryBarrierCount = v->copied;
    info.pMemoryBarriers = &copied;
    info.imageMemoryBarrierCount = v->n_barriers;
    info.pImageMemoryBarriers = v->barriers;
    vkCmdPipelineBarrier2(cmd, &info);
    v->n_barriers = 0;
    v->copied = false;
}

/* ---- create and destroy ---------------------------------------------- */

static enum hl_result image_make(struct hlvk *v, struct hlvk_tex *t,
                                 const struct hl_tex_desc *desc)
{
    VkImageCreateInfo info = { .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO };
    VkImageFormatProperties can;
    VkMemoryRequirements need;
    enum hl_result result;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = hlvk_format(desc->format);
    info.extent.width = desc->width;
    info.extent.height = desc->height;
    info.extent.depth = 1;
    info.mipLevels = desc->mips;
    info.arrayLayers = 1;
    info.samples = (VkSampleCountFlagBits)desc->samples;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = hlvk_usage(desc);
    result = hlvk_check(v, vkGetPhysicalDeviceImageFormatProperties(
                               v->physical, info.format, info.imageType,
                               info.tiling, info.usage, 0, &can),
                        "a texture of this format and usage");
    if (!result && (desc->width > can.maxExtent.width ||
                    desc->height > can.maxExtent.height ||
                    !(can.sampleCounts & desc->samples)))
        result = hlvk_check(v, VK_ERROR_FORMAT_NOT_SUPPORTED,
                            "a texture of this format, size and samples");
    if (!result)
        result = hlvk_check(v, vkCreateImage(v->vk, &info, NULL, &t->image),
                            "vkCreateImage");
    if (result)
        return result;
    vkGetImageMemoryRequirements(v->vk, t->image, &need);
    result = hlvk_memory_alloc(v, &need, HLVK_LOCAL, true, &t->memory);
    if (!result)
        result = hlvk_check(v, vkBindImageMemory(v->vk, t->image,
                                                 t->memory.memory,
                                                 t->memory.offset),
                            "vkBindImageMemory");
    return result;
}

static enum hl_result view_make(struct hlvk *v, const struct hlvk_tex *t,
                                uint32_t mips, VkImageView *out)
{
    VkImageViewCreateInfo info = { .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO };
    info.image = t->image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = hlvk_format(t->format);
    /* Sampling takes one aspect; as an attachment the aspect is ignored. */
    info.subresourceRange.aspectMask =
        hlvk_aspects(t->format) & ~(VkFlags)VK_IMAGE_ASPECT_STENCIL_BIT;
    info.subresourceRange.levelCount = mips;
    info.subresourceRange.layerCount = 1;
    return hlvk_check(v, vkCreateImageView(v->vk, &info, NULL, out),
                      "vkCreateImageView");
}

static void tex_unmake(struct hlvk *v, struct hlvk_tex *t)
{
    if (t->target != t->view)
        vkDestroyImageView(v->vk, t->target, NULL);
    vkDestroyImageView(v->vk, t->view, NULL);
    vkDestroyImage(v->vk, t->image, NULL);
    hlvk_memory_free(v, &t->memory);
}

enum hl_result hlvk_tex_make(struct hlvk *v, const struct hl_tex_desc *desc,
                             struct hlvk_tex **out)
{
    struct hlvk_tex *t = hl_bk_alloc(v->device, sizeof *t);
    enum hl_result result;
    if (!t)
        return HL_ERR_MEMORY;
    t->format = desc->format;
    t->width = desc->width;
    t->height = desc->height;
    t->mips = desc->mips;
    t->serial = ++v->serials;
    result = image_make(v, t, desc);
    if (!result && desc->usage & (HL_TEX_SAMPLED | HL_TEX_TARGET))
        result = view_make(v, t, t->mips, &t->view);
    t->target = t->view;
    if (!result && t->mips > 1 && desc->usage & HL_TEX_TARGET)
        result = view_make(v, t, 1, &t->target);
    if (result) {
        hlvk_tex_release(v, t);
        return result;
    }
    hlvk_name(v, VK_OBJECT_TYPE_IMAGE, (uint64_t)t->image, desc->label);
    *out = t;
    return HL_OK;
}

void hlvk_tex_release(struct hlvk *v, struct hlvk_tex *t)
{
    tex_unmake(v, t);
    hl_bk_free(v->device, t);
}

enum hl_result hlvk_tex_create(void *state, uint32_t slot,
                               const struct hl_tex_desc *desc)
{
    struct hlvk *v = state;
    return hlvk_tex_make(v, desc, &v->texs[slot]);
}

/* ---- upload ---------------------------------------------------------- */

static VkBufferImageCopy whole_level(const struct hlvk_tex *t, uint32_t mip)
{
    VkBufferImageCopy copy = { 0 };
    copy.imageSubresource.aspectMask =
        hlvk_aspects(t->format) & ~(VkFlags)VK_IMAGE_ASPECT_STENCIL_BIT;
    copy.imageSubresource.mipLevel = mip;
    copy.imageSubresource.layerCount = 1;
    copy.imageExtent.width = t->width >> mip ? t->width >> mip : 1;
    copy.imageExtent.height = t->height >> mip ? t->height >> mip : 1;
    copy.imageExtent.depth = 1;
    return copy;
}

enum hl_result hlvk_tex_upload(struct hlvk *v, struct hlvk_tex *t,
                               uint32_t mip, const void *data, size_t bytes)
{
    VkBufferImageCopy copy = whole_level(t, mip);
    VkBuffer from;
    struct hlvk_frame *f;
    enum hl_result result = hlvk_stage(v, data, bytes, &f, &from,
                                       &copy.bufferOffset);
    if (result)
        return result;
    hlvk_tex_use(v, f->cmd, t, HLVK_USE_COPY_TO, true);
    hlvk_barrier(v, f->cmd);
    vkCmdCopyBufferToImage(f->cmd, from, t->image,
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    return HL_OK;
}

enum hl_result hlvk_tex_write(void *state, uint32_t slot, uint32_t mip,
                              const void *data, size_t bytes)
{
    struct hlvk *v = state;
    return hlvk_tex_upload(v, v->texs[slot], mip, data, bytes);
}

/* ---- reading back ---------------------------------------------------- */

static enum hl_result readback_reserve(struct hlvk *v, VkDeviceSize bytes)
{
    struct hlvk_buf *b = &v->readback;
    enum hl_result result;
    if (bytes <= b->bytes)
        return HL_OK;
    /* Its last use was waited for. */
    hlvk_buf_unmake(v, b->buffer, &b->memory);
    memset(b, 0, sizeof *b);
    result = hlvk_buf_make(v, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           HLVK_READBACK, &b->buffer, &b->memory);
    if (!result)
        b->bytes = bytes;
    return result;
}

static void record_read(struct hlvk *v, VkCommandBuffer cmd,
                        struct hlvk_tex *t)
{
    static const VkMemoryBarrier2 to_host = {
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, NULL,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT
    };
    VkDependencyInfo info = { .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO };
    VkBufferImageCopy copy = whole_level(t, 0);
    hlvk_tex_use(v, cmd, t, HLVK_USE_COPY_FROM, false);
    hlvk_barrier(v, cmd);
    vkCmdCopyImageToBuffer(cmd, t->image,
                           VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                           v->readback.buffer, 1, &copy);
    info.memoryBarrierCount = 1;
    info.pMemoryBarriers = &to_host;
    vkCmdPipelineBarrier2(cmd, &info);
}

/* Depth as copied: 16 bits, 24 in the low bits of 32, or already floats. */
static void depth_to_float(enum hl_format format, const unsigned char *from,
                           float *to, size_t n)
{
    uint16_t d16;
    uint32_t d24;
    size_t i;
    if (format == HL_FORMAT_D16_UNORM) {
        for (i = 0; i < n; i++) {
            memcpy(&d16, from + i * 2, 2);
            to[i] = (float)d16 / 65535.0f;
        }
    } else if (format == HL_FORMAT_D24_UNORM_S8) {
        for (i = 0; i < n; i++) {
            memcpy(&d24, from + i * 4, 4);
            to[i] = (float)(d24 & 0xffffff) / 16777215.0f;
        }
    } else {
        memcpy(to, from, n * 4);
    }
}

enum hl_result hlvk_tex_read(void *state, uint32_t slot, void *out,
                             size_t bytes)
{
    struct hlvk *v = state;
    struct hlvk_tex *t = v->texs[slot];
    struct hlvk_frame *f;
    size_t texels = (size_t)t->width * t->height;
    enum hl_result result = readback_reserve(v, bytes);
    if (!result)
        result = hlvk_begin(v, &f);
    if (result)
        return result;
    record_read(v, f->cmd, t);
    result = hlvk_flush(v, true);
    if (result)
        return result;
    if (hl_format_info(t->format)->kind == HL_KIND_DEPTH)
        depth_to_float(t->format, v->readback.memory.map, out, texels);
    else
        memcpy(out, v->readback.memory.map, bytes);
    return HL_OK;
}
