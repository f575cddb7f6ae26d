/* SPDX-License-Identifier: Zlib */
/* What a physical device offers, in the words of hal/caps.h. */
#include <string.h>
#include "platforms/vulkan/vk.h"

static const VkFormat formats[HL_FORMAT_COUNT] = {
    [HL_FORMAT_NONE] = VK_FORMAT_UNDEFINED,
#define HL_FORMAT(name, bytes, channels, kind, r, g, b, a, vulkan, ...) \
    [HL_FORMAT_##name] = vulkan,
#include "hal/formats.def"
#undef HL_FORMAT
};

VkFormat hlvk_format(enum hl_format format)
{
    return formats[format];
}

static bool is_depth(enum hl_format format)
{
    return hl_format_info(format)->kind == HL_KIND_DEPTH;
}

bool hlvk_has_stencil(enum hl_format format)
{
    return is_depth(format) && hl_format_info(format)->bits[1] > 0;
}

VkImageAspectFlags hlvk_aspects(enum hl_format format)
{
    if (!is_depth(format))
        return VK_IMAGE_ASPECT_COLOR_BIT;
    if (!hlvk_has_stencil(format))
        return VK_IMAGE_ASPECT_DEPTH_BIT;
    return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
}

VkImageUsageFlags hlvk_usage(const struct hl_tex_desc *desc)
{
    VkImageUsageFlags usage = 0;
    if (desc->usage & HL_TEX_SAMPLED)
        usage |= VK_IMAGE_USAGE_SAMPLED_BIT;
    if (desc->usage & HL_TEX_TARGET)
        usage |= is_depth(desc->format)
                 ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                 : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    if (desc->usage & HL_TEX_READBACK)
        usage |= VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    if (desc->samples == 1 && !is_depth(desc->format))
        usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    return usage;
}

/* ---- what is usable -------------------------------------------------- */

static bool graphics_family(VkPhysicalDevice physical, uint32_t *family)
{
    VkQueueFamilyProperties q[16];
    uint32_t n = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &n, q);
    for (uint32_t i = 0; i < n; i++)
        if (q[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) {
            *family = i;
            return true;
        }
    return false;
}

bool hlvk_usable(VkPhysicalDevice physical, uint32_t *family)
{
    VkPhysicalDeviceVulkan13Features f13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES
    };
    VkPhysicalDeviceFeatures2 f2 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &f13
    };
    VkPhysicalDeviceProperties p;
    vkGetPhysicalDeviceProperties(physical, &p);
    if (p.apiVersion < VK_API_VERSION_1_3)
        return false;
    vkGetPhysicalDeviceFeatures2(physical, &f2);
    return f13.dynamicRendering && f13.synchronization2 &&
           f13.maintenance4 && graphics_family(physical, family);
}

static void append(char *to, size_t room, const char *text)
{
    size_t at = strlen(to), n = strlen(text);
    if (n > room - 1 - at)
        n = room - 1 - at;
    memcpy(to + at, text, n);
    to[at + n] = '\0';
}

static enum hl_device_kind device_kind(VkPhysicalDeviceType type)
{
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return HL_DEVICE_DISCRETE;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return HL_DEVICE_INTEGRATED;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return HL_DEVICE_CPU;
    default: return HL_DEVICE_OTHER;
    }
}

void hlvk_describe(VkPhysicalDevice physical, struct hl_device_info *out)
{
    VkPhysicalDeviceDriverProperties driver = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES
    };
    VkPhysicalDeviceProperties2 p = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &driver
    };
    vkGetPhysicalDeviceProperties2(physical, &p);
    memset(out, 0, sizeof *out);
    append(out->name, sizeof out->name, p.properties.deviceName);
    append(out->driver, sizeof out->driver, driver.driverName);
    append(out->driver, sizeof out->driver, " ");
    append(out->driver, sizeof out->driver, driver.driverInfo);
    out->kind = device_kind(p.properties.deviceType);
}

/* ---- formats --------------------------------------------------------- */

static uint8_t format_use(VkFormatFeatureFlags f)
{
    const VkFormatFeatureFlags target =
        VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT |
        VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT;
    return (uint8_t)(
        (f & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT ? HL_USE_SAMPLED : 0) |
        (f & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT
             ? HL_USE_LINEAR : 0) |
        (f & target ? HL_USE_TARGET : 0) |
        (f & VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT ? HL_USE_BLEND
                                                          : 0));
}

/* Counts for images with all usages that the format has. */
static VkSampleCountFlags format_samples(struct hlvk *v,
                                         enum hl_format format, uint8_t use)
{
    struct hl_tex_desc desc = {
        .format = format, .samples = 2,
        .usage = use & HL_USE_SAMPLED ? HL_TEX_TARGET | HL_TEX_SAMPLED
                                      : HL_TEX_TARGET
    };
    VkImageFormatProperties p;
    if (!(use & HL_USE_TARGET))
        return 0;
    if (vkGetPhysicalDeviceImageFormatProperties(
            v->physical, formats[format], VK_IMAGE_TYPE_2D,
            VK_IMAGE_TILING_OPTIMAL, hlvk_usage(&desc), 0, &p) != VK_SUCCESS)
        return VK_SAMPLE_COUNT_1_BIT;
    return p.sampleCounts;
}

static void caps_formats(struct hlvk *v, struct hl_caps *caps,
                         const VkPhysicalDeviceLimits *limits,
                         VkSampleCountFlags integer_samples)
{
    VkFormatProperties2 p = { .sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2 };
    caps->samples = limits->framebufferColorSampleCounts &
                    limits->framebufferDepthSampleCounts & 15;
    for (int i = 1; i < HL_FORMAT_COUNT; i++) {
        enum hl_format format = (enum hl_format)i;
        enum hl_format_kind kind = hl_format_info(format)->kind;
        /* Formats of consoles: not to be asked about. */
        if (formats[i] == VK_FORMAT_UNDEFINED)
            continue;
        vkGetPhysicalDeviceFormatProperties2(v->physical, formats[i], &p);
        caps->format[i].use =
            format_use(p.formatProperties.optimalTilingFeatures);
        VkSampleCountFlags samples =
            format_samples(v, format, caps->format[i].use);
        /* The format query alone promises lavapipe's integer formats 4
         * samples, which the device's limit denies. */
        samples &= kind == HL_KIND_UINT ? integer_samples
                 : kind == HL_KIND_DEPTH ? limits->framebufferDepthSampleCounts
                 : limits->framebufferColorSampleCounts;
        caps->format[i].samples = (uint8_t)(samples & 15);
    }
}

/* ---- costs ----------------------------------------------------------- */

/* lavapipe of Mesa 22.3.6 on two cores, measured. */
static const struct hl_cost_model cost_cpu = {
    .draw_ns = 1500.0f, .vertex_ns = 150.0f, .pixel_ns = 1.5f,
    .fetch_ns = 1.2f, .blend_ns = 1.9f, .light_ns = 2.4f,
    .light_flat_ns = 1.5f, .light_gather_ns = 8.0f, .readback_ns = 0.5f,
    .sync_ns = 15000.0f, .untaken = 1.0f
};
/* Not measured: guesses at the order of magnitude for a desktop GPU. */
static const struct hl_cost_model cost_gpu = {
    .draw_ns = 300.0f, .vertex_ns = 0.3f, .pixel_ns = 0.005f,
    .fetch_ns = 0.003f, .blend_ns = 0.01f, .light_ns = 0.004f,
    .light_flat_ns = 0.004f, .light_gather_ns = 0.004f, .readback_ns = 1.0f,
    .sync_ns = 100000.0f
};

/* ---- all ------------------------------------------------------------- */

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

static void private_limits(struct hlvk *v, const VkPhysicalDeviceLimits *l,
                           VkDeviceSize max_allocation,
                           VkDeviceSize max_buffer)
{
    VkQueueFamilyProperties q[16];
    uint32_t n = 16, bits;
    vkGetPhysicalDeviceMemoryProperties(v->physical, &v->memory);
    v->max_allocation = max_allocation;
    v->max_buffer = max_buffer;
    /* 16: a multiple of every texel's size, as buffer-image copies ask. */
    v->copy_align = l->optimalBufferCopyOffsetAlignment > 16
                    ? l->optimalBufferCopyOffsetAlignment : 16;
    vkGetPhysicalDeviceQueueFamilyProperties(v->physical, &n, q);
    bits = v->family < n ? q[v->family].timestampValidBits : 0;
    v->tick_ms = bits ? l->timestampPeriod * 1e-6 : 0.0;
    v->tick_mask = bits >= 64 ? ~(uint64_t)0 : ((uint64_t)1 << bits) - 1;
}

static void public_limits(struct hl_caps *caps,
                          const VkPhysicalDeviceLimits *l)
{
    caps->max_tex_dim = least(least(l->maxImageDimension2D,
                                    l->maxFramebufferWidth),
                              l->maxFramebufferHeight);
    caps->max_colors = least(l->maxColorAttachments, HL_MAX_COLORS);
    caps->max_uniform_bytes = l->maxUniformBufferRange;
    caps->max_storage_bytes = l->maxStorageBufferRange;
    caps->uniform_align = (uint32_t)l->minUniformBufferOffsetAlignment;
    caps->storage_align = (uint32_t)l->minStorageBufferOffsetAlignment;
    caps->clip_zero_to_one = true;
}

void hlvk_caps(struct hlvk *v, struct hl_caps *caps)
{
    VkPhysicalDeviceVulkan13Properties p13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES
    };
    VkPhysicalDeviceVulkan12Properties p12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES,
        .pNext = &p13
    };
    VkPhysicalDeviceVulkan11Properties p11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
        .pNext = &p12
    };
    VkPhysicalDeviceProperties2 p = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
        .pNext = &p11
    };
    struct hl_device_info info;
    vkGetPhysicalDeviceProperties2(v->physical, &p);
    private_limits(v, &p.properties.limits, p11.maxMemoryAllocationSize,
                   p13.maxBufferSize);
    memset(caps, 0, sizeof *caps);
    hlvk_describe(v->physical, &info);
    append(caps->backend, sizeof caps->backend, hl_backend_vulkan.name);
    memcpy(caps->device, info.name, sizeof caps->device);
    memcpy(caps->driver, info.driver, sizeof caps->driver);
    caps->kind = v->kind = info.kind;
    public_limits(caps, &p.properties.limits);
    caps->timestamps = v->tick_ms > 0.0;
    caps_formats(v, caps, &p.properties.limits,
                 p12.framebufferIntegerColorSampleCounts);
    caps->cost = info.kind == HL_DEVICE_CPU ? cost_cpu : cost_gpu;
}
