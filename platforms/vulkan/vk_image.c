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
    if (!v->n_barriers && !v->copied)
        return;
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = v->copied, .pMemoryBarriers = &copied,
        .imageMemoryBarrierCount = v->n_barriers,
        .pImageMemoryBarriers = v->barriers
    };
    vkCmdPipelineBarrier2(cmd, &info);
    v->n_barriers = 0;
    v->copied = false;
}

/* ---- create and destroy ------------------------------------------------ */

/* What caps cannot say, because it depends on the usage as a whole. */
static enum hl_result check_image(struct hlvk *v,
                                  const VkImageCreateInfo *info)
{
    VkImageFormatProperties can;
    enum hl_result r = hlvk_check(
        v, vkGetPhysicalDeviceImageFormatProperties(
               v->physical, info->format, info->imageType, info->tiling,
               info->usage, info->flags, &can),
        "a texture of this format and usage");
    if (!r && (info->extent.width > can.maxExtent.width ||
               info->extent.height > can.maxExtent.height ||
               !(can.sampleCounts & info->samples)))
        r = hlvk_check(v, VK_ERROR_FORMAT_NOT_SUPPORTED,
                       "a texture of this format, size and samples");
    return r;
}

static enum hl_result image_make(struct hlvk *v, struct hlvk_tex *t,
                                 const struct hl_tex_desc *desc)
{
    const VkFormat views[2] = {
        hlvk_format(desc->format), hlvk_format(desc->sample_as)
    };
    VkImageFormatListCreateInfo list = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_FORMAT_LIST_CREATE_INFO,
        .viewFormatCount = 2, .pViewFormats = views
    };
    VkImageCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
        .imageType = VK_IMAGE_TYPE_2D, .format = views[0],
        .extent = { desc->width, desc->height, 1 },
        .mipLevels = desc->mips, .arrayLayers = 1,
        .samples = (VkSampleCountFlagBits)desc->samples,
        .tiling = VK_IMAGE_TILING_OPTIMAL, .usage = hlvk_usage(desc)
    };
    if (desc->sample_as != desc->format) {
        info.flags = VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
        info.pNext = &list;
    }
    enum hl_result r = check_image(v, &info);
    if (!r)
        r = hlvk_check(v, vkCreateImage(v->vk, &info, NULL, &t->image),
                       "vkCreateImage");
    if (r)
        return r;
    VkMemoryRequirements need;
    vkGetImageMemoryRequirements(v->vk, t->image, &need);
    r = hlvk_memory_alloc(v, &need, HLVK_LOCAL, true, &t->memory);
    if (!r)
        r = hlvk_check(v, vkBindImageMemory(v->vk, t->image,
                                            t->memory.memory,
                                            t->memory.offset),
                       "vkBindImageMemory");
    return r;
}

static enum hl_result view_make(struct hlvk *v, const struct hlvk_tex *t,
                                enum hl_format format, uint32_t mips,
                                VkImageUsageFlags use, VkImageView *out)
{
    VkImageAspectFlags aspects = hlvk_aspects(t->format);
    /* Sampling takes one aspect. */
    if (use == VK_IMAGE_USAGE_SAMPLED_BIT)
        aspects &= ~(VkFlags)VK_IMAGE_ASPECT_STENCIL_BIT;
    /* Named, because the view's format may not allow all uses of the image. */
    VkImageViewUsageCreateInfo usage = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO, .usage = use
    };
    VkImageViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .pNext = &usage, .image = t->image,
        .viewType = VK_IMAGE_VIEW_TYPE_2D, .format = hlvk_format(format),
        .subresourceRange = { aspects, 0, mips, 0, 1 }
    };
    return hlvk_check(v, vkCreateImageView(v->vk, &info, NULL, out),
                      "vkCreateImageView");
}

static enum hl_result views_make(struct hlvk *v, struct hlvk_tex *t,
                                 const struct hl_tex_desc *desc)
{
    VkImageUsageFlags attachment = hlvk_usage(desc) &
        (VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
         VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
    enum hl_result r = HL_OK;
    if (desc->usage & HL_TEX_SAMPLED)
        r = view_make(v, t, desc->sample_as, t->mips,
                      VK_IMAGE_USAGE_SAMPLED_BIT, &t->view);
    if (!r && attachment)
        r = view_make(v, t, desc->format, 1, attachment, &t->target);
    return r;
}

enum hl_result hlvk_tex_make(struct hlvk *v, const struct hl_tex_desc *desc,
                             struct hlvk_tex **out)
{
    struct hlvk_tex *t = hl_bk_alloc(v->device, sizeof *t);
    if (!t)
        return HL_ERR_MEMORY;
    t->format = desc->format;
    t->width = desc->width;
    t->height = desc->height;
    t->mips = desc->mips;
    t->serial = ++v->serials;
    enum hl_result r = image_make(v, t, desc);
    if (!r)
        r = views_make(v, t, desc);
    if (r) {
        hlvk_tex_release(v, t);
        return r;
    }
    hlvk_name(v, VK_OBJECT_TYPE_IMAGE, (uint64_t)t->image, desc->label);
    *out = t;
    return HL_OK;
}

void hlvk_tex_release(struct hlvk *v, struct hlvk_tex *t)
{
    vkDestroyImageView(v->vk, t->target, NULL);
    vkDestroyImageView(v->vk, t->view, NULL);
    vkDestroyImage(v->vk, t->image, NULL);
    hlvk_memory_free(v, &t->memory);
    hl_bk_free(v->device, t);
}

enum hl_result hlvk_tex_create(void *state, uint32_t slot,
                               const struct hl_tex_desc *desc)
{
    struct hlvk *v = state;
    return hlvk_tex_make(v, desc, &v->texs[slot]);
}

/* ---- upload ------------------------------------------------------------ */

static VkBufferImageCopy whole_level(const struct hlvk_tex *t, uint32_t mip)
{
    return (VkBufferImageCopy){
        .imageSubresource = {
            hlvk_aspects(t->format) & ~(VkFlags)VK_IMAGE_ASPECT_STENCIL_BIT,
            mip, 0, 1
        },
        .imageExtent = { t->width >> mip ? t->width >> mip : 1,
                         t->height >> mip ? t->height >> mip : 1, 1 }
    };
}

enum hl_result hlvk_tex_upload(struct hlvk *v, struct hlvk_tex *t,
                               uint32_t mip, const void *data, size_t bytes)
{
    VkBufferImageCopy copy = whole_level(t, mip);
    VkBuffer from;
    struct hlvk_frame *f;
    enum hl_result r = hlvk_stage(v, data, bytes, &f, &from,
                                  &copy.bufferOffset);
    if (r)
        return r;
    hlvk_tex_use(v, f->cmd, t, HLVK_USE_COPY_TO, true);
    hlvk_barrier(v, f->cmd);
    vkCmdCopyBufferToImage(f->cmd, from, t->image,
                           hlvk_layout(HLVK_USE_COPY_TO), 1, &copy);
    return HL_OK;
}

enum hl_result hlvk_tex_write(void *state, uint32_t slot, uint32_t mip,
                              const void *data, size_t bytes)
{
    struct hlvk *v = state;
    return hlvk_tex_upload(v, v->texs[slot], mip, data, bytes);
}

/* ---- reading back ------------------------------------------------------ */

static enum hl_result readback_reserve(struct hlvk *v, VkDeviceSize bytes)
{
    struct hlvk_buf *b = &v->readback;
    if (bytes <= b->bytes)
        return HL_OK;
    /* Its last use was waited for. */
    hlvk_buf_unmake(v, b->buffer, &b->memory);
    memset(b, 0, sizeof *b);
    enum hl_result r = hlvk_buf_make(v, bytes,
                                     VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                     HLVK_READBACK, &b->buffer, &b->memory);
    if (!r)
        b->bytes = bytes;
    return r;
}

static void record_read(struct hlvk *v, VkCommandBuffer cmd,
                        struct hlvk_tex *t)
{
    static const VkMemoryBarrier2 to_host = {
        VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, NULL,
        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT
    };
    static const VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
        .memoryBarrierCount = 1, .pMemoryBarriers = &to_host
    };
    VkBufferImageCopy copy = whole_level(t, 0);
    hlvk_tex_use(v, cmd, t, HLVK_USE_COPY_FROM, false);
    hlvk_barrier(v, cmd);
    vkCmdCopyImageToBuffer(cmd, t->image, hlvk_layout(HLVK_USE_COPY_FROM),
                           v->readback.buffer, 1, &copy);
    vkCmdPipelineBarrier2(cmd, &info);
}

/* Depth as copied: 16 bits, 24 in the low bits of 32, or already floats. */
static void depth_to_float(enum hl_format format, const unsigned char *from,
                           float *to, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        uint16_t d16;
        uint32_t d24;
        if (format == HL_FORMAT_D16_UNORM) {
            memcpy(&d16, from + i * 2, 2);
            to[i] = (float)d16 / 65535.0f;
        } else {
            memcpy(&d24, from + i * 4, 4);
            to[i] = (float)(d24 & 0xffffff) / 16777215.0f;
        }
    }
}

enum hl_result hlvk_tex_read(void *state, uint32_t slot, void *out,
                             size_t bytes)
{
    struct hlvk *v = state;
    struct hlvk_tex *t = v->texs[slot];
    struct hlvk_frame *f;
    enum hl_result r = readback_reserve(v, bytes);
    if (!r)
        r = hlvk_begin(v, &f);
    if (r)
        return r;
    record_read(v, f->cmd, t);
    r = hlvk_flush(v, true);
    if (r)
        return r;
    if (t->format == HL_FORMAT_D16_UNORM ||
        t->format == HL_FORMAT_D24_UNORM_S8)
        depth_to_float(t->format, v->readback.memory.map, out, bytes / 4);
    else
        memcpy(out, v->readback.memory.map, bytes);
    return HL_OK;
}
