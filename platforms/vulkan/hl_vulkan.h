/* SPDX-License-Identifier: Zlib */
#ifndef HL_VULKAN_H
#define HL_VULKAN_H
/* Vulkan 1.3 backend: any machine with dynamic rendering, synchronization2
 * and maintenance4; one queue, no window, no extension. Link with -lvulkan.
 *
 * hl_device_desc.device: index in the list of hl_devices_list, or part of a
 * device's name in any case; NULL takes the first: discrete, integrated,
 * virtual, then software devices. */
#include <vulkan/vulkan.h>
#include "hal/backend.h"

extern const struct hl_backend hl_backend_vulkan;

/* hl_device_desc.native: a device of the embedder's own, which it keeps; all
 * members are borrowed until hl_device_close and none is destroyed. Created
 * for API 1.3 with the features dynamicRendering, synchronization2 and
 * maintenance4 on, and sampleRateShading where a stage reads gl_SampleID.
 * The queue must support graphics and belong to `family`; while a halflight
 * call runs, the embedder submits nothing to it. With desc.validation, errors
 * are counted if the instance has VK_EXT_debug_utils. */
struct hl_vulkan_native {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
};
#endif
