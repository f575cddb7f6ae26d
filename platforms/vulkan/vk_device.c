/* SPDX-License-Identifier: Zlib */
/* Instance, choice of a device, open and close. */
#include <string.h>
#include "platforms/vulkan/vk.h"

enum { MAX_DEVICES = 32 };   /* more are not listed                          */

static const char layer_name[] = "VK_LAYER_KHRONOS_validation";

/* ---- results --------------------------------------------------------- */

static enum hl_result translate(VkResult result)
{
    switch (result) {
    case VK_SUCCESS:
    case VK_INCOMPLETE: return HL_OK;
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_MEMORY_MAP_FAILED:
    case VK_ERROR_TOO_MANY_OBJECTS: return HL_ERR_MEMORY;
    case VK_ERROR_DEVICE_LOST: return HL_ERR_DEVICE_LOST;
    case VK_ERROR_INCOMPATIBLE_DRIVER:
    case VK_ERROR_INITIALIZATION_FAILED: return HL_ERR_NO_DEVICE;
    default: return HL_ERR_UNSUPPORTED;
    }
}

enum hl_result hlvk_check(struct hlvk *v, VkResult vk, const char *what)
{
    enum hl_result r = translate(vk);
    if (r == HL_OK)
        return HL_OK;
    v->lost |= r == HL_ERR_DEVICE_LOST;
    hl_bk_log(v->device, HL_LOG_ERROR,
              r == HL_ERR_DEVICE_LOST ? HL_MSG_DEVICE
              : r == HL_ERR_MEMORY ? HL_MSG_MEMORY : HL_MSG_BACKEND,
              what, ": ", hl_result_name(r));
    return r;
}

void hlvk_name(struct hlvk *v, VkObjectType type, uint64_t handle,
               const char *name)
{
    VkDebugUtilsObjectNameInfoEXT info = {
        VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, NULL, type,
        handle, name
    };
    if (v->name_object && name)
        v->name_object(v->vk, &info);
}

/* ---- validation ------------------------------------------------------ */

static VKAPI_ATTR VkBool32 VKAPI_CALL message(
    VkDebugUtilsMessageSeverityFlagBitsEXT severity,
    VkDebugUtilsMessageTypeFlagsEXT types,
    const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)types;
    if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT)
        hl_bk_validation_error(user, data->pMessage);
    else
        hl_bk_log(user, HL_LOG_WARNING, HL_MSG_VALIDATION, data->pMessage,
                  NULL, NULL);
    return VK_FALSE;
}

static VkDebugUtilsMessengerCreateInfoEXT messenger(struct hl_device *device)
{
    return (VkDebugUtilsMessengerCreateInfoEXT){
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT,
        /* Not GENERAL: there the loader tells of drivers it cannot load. */
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = message, .pUserData = device
    };
}

static bool layer_present(struct hl_device *device)
{
    uint32_t n = 0;
    bool found = false;
    if (vkEnumerateInstanceLayerProperties(&n, NULL) != VK_SUCCESS || !n)
        return false;
    VkLayerProperties *layers = hl_bk_alloc(device, n * sizeof *layers);
    if (layers &&
        vkEnumerateInstanceLayerProperties(&n, layers) >= VK_SUCCESS)
        for (uint32_t i = 0; i < n; i++)
            found |= !strcmp(layers[i].layerName, layer_name);
    hl_bk_free(device, layers);
    return found;
}

static void messenger_make(struct hlvk *v)
{
    VkDebugUtilsMessengerCreateInfoEXT info = messenger(v->device);
    PFN_vkCreateDebugUtilsMessengerEXT create =
        (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            v->instance, "vkCreateDebugUtilsMessengerEXT");
    if (create)
        create(v->instance, &info, NULL, &v->messenger);
}

/* Names make the layer's messages readable; only its users need them. */
static void names_enable(struct hlvk *v)
{
    if (v->messenger)
        v->name_object = (PFN_vkSetDebugUtilsObjectNameEXT)
            vkGetDeviceProcAddr(v->vk, "vkSetDebugUtilsObjectNameEXT");
}

/* ---- instance -------------------------------------------------------- */

/* device NULL: without validation. */
static VkResult instance_make(struct hl_device *device, VkInstance *out)
{
    static const VkValidationFeatureEnableEXT sync[] = {
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
    };
    static const char *const layers[] = { layer_name };
    static const char *const extensions[] = {
        VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
        VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME
    };
    VkApplicationInfo app = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
        .pEngineName = "halflight", .engineVersion = HL_VERSION,
        .apiVersion = VK_API_VERSION_1_3
    };
    /* The messenger in the chain hears the creation itself. */
    VkDebugUtilsMessengerCreateInfoEXT debug = messenger(device);
    VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, .pNext = &debug,
        .enabledValidationFeatureCount = 1,
        .pEnabledValidationFeatures = sync
    };
    VkInstanceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = device ? &features : NULL, .pApplicationInfo = &app,
        .enabledLayerCount = device ? 1 : 0, .ppEnabledLayerNames = layers,
        .enabledExtensionCount = device ? 2 : 0,
        .ppEnabledExtensionNames = extensions
    };
    return vkCreateInstance(&info, NULL, out);
}

static enum hl_result instance_open(struct hlvk *v, bool validation)
{
    if (validation && !layer_present(v->device)) {
        hl_bk_log(v->device, HL_LOG_WARNING, HL_MSG_VALIDATION, layer_name,
                  " is not installed: nothing is validated", NULL);
        validation = false;
    }
    VkResult result = instance_make(validation ? v->device : NULL,
                                    &v->instance);
    if (result == VK_SUCCESS && validation)
        messenger_make(v);
    return hlvk_check(v, result, "no Vulkan driver: vkCreateInstance");
}

/* ---- choice ---------------------------------------------------------- */

static uint32_t rank(VkPhysicalDevice physical)
{
    VkPhysicalDeviceProperties p;
    vkGetPhysicalDeviceProperties(physical, &p);
    switch (p.deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 0;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 1;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return 3;
    default: return 4;
    }
}

/* Usable devices, best first; equal ones in the loader's order. */
static uint32_t candidates(VkInstance instance,
                           VkPhysicalDevice out[MAX_DEVICES])
{
    VkPhysicalDevice all[MAX_DEVICES];
    uint32_t family, n = MAX_DEVICES, m = 0;
    if (vkEnumeratePhysicalDevices(instance, &n, all) < VK_SUCCESS)
        return 0;
    for (uint32_t r = 0; r < 5; r++)
        for (uint32_t i = 0; i < n; i++)
            if (rank(all[i]) == r && hlvk_usable(all[i], &family))
                out[m++] = all[i];
    return m;
}

static enum hl_result list(const struct hl_hooks *hooks,
                           struct hl_device_info *out, uint32_t max,
                           uint32_t *n)
{
    VkPhysicalDevice found[MAX_DEVICES];
    VkInstance instance;
    (void)hooks;
    *n = 0;
    if (instance_make(NULL, &instance) != VK_SUCCESS)
        return HL_ERR_NO_DEVICE;
    *n = candidates(instance, found);
    for (uint32_t i = 0; i < *n && i < max; i++)
        hlvk_describe(found[i], &out[i]);
    vkDestroyInstance(instance, NULL);
    return *n ? HL_OK : HL_ERR_NO_DEVICE;
}

/* An index, or part of a name: "4090" is a name where there are fewer. */
static uint32_t pick(const char *want, const VkPhysicalDevice *found,
                     uint32_t n)
{
    struct hl_device_info info;
    uint32_t index = 0;
    if (!want || !*want)
        return 0;
    size_t digits = strspn(want, "0123456789");
    for (size_t i = 0; i < digits && index < n; i++)
        index = index * 10 + (uint32_t)(want[i] - '0');
    if (!want[digits] && index < n)
        return index;
    for (uint32_t i = 0; i < n; i++) {
        hlvk_describe(found[i], &info);
        if (hl_bk_name_has(info.name, want))
            return i;
    }
    return n;
}

static enum hl_result choose(struct hlvk *v, const char *want)
{
    VkPhysicalDevice found[MAX_DEVICES];
    uint32_t n = candidates(v->instance, found);
    uint32_t i = pick(want, found, n);
    if (i >= n) {
        hl_bk_log(v->device, HL_LOG_ERROR, HL_MSG_DEVICE,
                  n ? "no Vulkan device is called "
                    : "no Vulkan 1.3 device with dynamic rendering",
                  n ? want : NULL, NULL);
        return HL_ERR_NO_DEVICE;
    }
    v->physical = found[i];
    hlvk_usable(v->physical, &v->family);
    return HL_OK;
}

/* ---- device ---------------------------------------------------------- */

static enum hl_result connect(struct hlvk *v)
{
    static const float priority = 1.0f;
    VkPhysicalDeviceFeatures has;
    vkGetPhysicalDeviceFeatures(v->physical, &has);
    VkPhysicalDeviceFeatures want = {
        .sampleRateShading = has.sampleRateShading
    };
    VkPhysicalDeviceVulkan13Features f13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
        .synchronization2 = VK_TRUE, .dynamicRendering = VK_TRUE,
        .maintenance4 = VK_TRUE
    };
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
        .queueFamilyIndex = v->family,
        .queueCount = 1, .pQueuePriorities = &priority
    };
    VkDeviceCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, .pNext = &f13,
        .queueCreateInfoCount = 1, .pQueueCreateInfos = &queue,
        .pEnabledFeatures = &want
    };
    enum hl_result r = hlvk_check(
        v, vkCreateDevice(v->physical, &info, NULL, &v->vk),
        "vkCreateDevice");
    if (!r)
        vkGetDeviceQueue(v->vk, v->family, 0, &v->queue);
    return r;
}

static enum hl_result borrow(struct hlvk *v,
                             const struct hl_vulkan_native *native,
                             bool validation)
{
    uint32_t family;
    v->borrowed = true;
    v->instance = native->instance;
    v->physical = native->physical;
    v->vk = native->device;
    v->queue = native->queue;
    v->family = native->family;
    if (!hlvk_usable(v->physical, &family)) {
        hl_bk_log(v->device, HL_LOG_ERROR, HL_MSG_DEVICE,
                  "the embedder's device lacks Vulkan 1.3, dynamicRendering,"
                  " synchronization2, maintenance4 or a graphics queue",
                  NULL, NULL);
        return HL_ERR_UNSUPPORTED;
    }
    if (validation)
        messenger_make(v);
    return HL_OK;
}

static enum hl_result slots_open(struct hlvk *v,
                                 const struct hl_device_desc *desc)
{
    v->max_bufs = desc->max_buffers;
    v->max_texs = desc->max_textures;
    v->max_progs = desc->max_programs;
    v->bufs = hl_bk_alloc(v->device, v->max_bufs * sizeof *v->bufs);
    v->texs = hl_bk_alloc(v->device, v->max_texs * sizeof *v->texs);
    v->progs = hl_bk_alloc(v->device, v->max_progs * sizeof *v->progs);
    return v->bufs && v->texs && v->progs ? HL_OK : HL_ERR_MEMORY;
}

static void slots_close(struct hlvk *v)
{
    for (uint32_t i = 0; v->vk && i < v->max_bufs; i++)
        hlvk_destroy(v, 'b', i);
    for (uint32_t i = 0; v->vk && i < v->max_texs; i++)
        hlvk_destroy(v, 't', i);
    for (uint32_t i = 0; v->vk && i < v->max_progs; i++)
        hlvk_destroy(v, 'p', i);
    hl_bk_free(v->device, v->bufs);
    hl_bk_free(v->device, v->texs);
    hl_bk_free(v->device, v->progs);
}

static void instance_close(struct hlvk *v)
{
    if (!v->borrowed && v->vk)
        vkDestroyDevice(v->vk, NULL);
    if (v->messenger)
        ((PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            v->instance, "vkDestroyDebugUtilsMessengerEXT"))(
            v->instance, v->messenger, NULL);
    if (!v->borrowed && v->instance)
        vkDestroyInstance(v->instance, NULL);
}

static void close_device(void *state)
{
    struct hlvk *v = state;
    if (v->vk)
        hlvk_frames_close(v);
    slots_close(v);
    if (v->vk) {
        hlvk_sets_close(v);
        hlvk_memory_close(v);
    }
    instance_close(v);
    memset(v, 0, sizeof *v);
}

static enum hl_result open_own(struct hlvk *v,
                                  const struct hl_device_desc *desc)
{
    enum hl_result r = instance_open(v, desc->validation);
    if (!r)
        r = choose(v, desc->device);
    return r ? r : connect(v);
}

static enum hl_result open_device(void *state, struct hl_device *device,
                                  const struct hl_device_desc *desc,
                                  struct hl_caps *caps)
{
    struct hlvk *v = state;
    v->device = device;
    enum hl_result r = slots_open(v, desc);
    if (!r)
        r = desc->native ? borrow(v, desc->native, desc->validation)
                         : open_own(v, desc);
    if (!r) {
        names_enable(v);
        hlvk_caps(v, caps);
        r = hlvk_frames_open(v);
    }
    if (!r)
        r = hlvk_sets_open(v);
    if (r)
        close_device(v);
    return r;
}

const struct hl_backend hl_backend_vulkan = {
    "vulkan", HL_VERSION, sizeof(struct hlvk), list, open_device,
    close_device, hlvk_buf_create, hlvk_buf_write, hlvk_tex_create,
    hlvk_tex_write, hlvk_tex_read, hlvk_prog_create, hlvk_destroy,
    hlvk_pass_run, hlvk_submit, hlvk_timings
};
