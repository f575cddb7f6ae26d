/* SPDX-License-Identifier: Zlib */
/* Instance, choice of a device, open and close. */
#include <ctype.h>
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
    enum hl_result result = translate(vk);
    enum hl_log_id id = HL_MSG_BACKEND;
    if (result == HL_OK)
        return HL_OK;
    if (result == HL_ERR_DEVICE_LOST) {
        v->lost = true;
        id = HL_MSG_DEVICE;
    } else if (result == HL_ERR_MEMORY) {
        id = HL_MSG_MEMORY;
    }
    hl_bk_log(v->device, HL_LOG_ERROR, id, what, ": ",
              hl_result_name(result));
    return result;
}

bool hlvk_grow(struct hlvk *v, void *array, uint32_t *max, uint32_t need,
               size_t item)
{
    uint32_t more = *max ? *max : 16;
    void *old, *grown;
    if (need <= *max)
        return true;
    while (more < need)
        more *= 2;
    memcpy(&old, array, sizeof old);
    grown = hl_bk_alloc(v->device, more * item);
    if (!grown)
        return false;
    if (old)
        memcpy(grown, old, *max * item);
    hl_bk_free(v->device, old);
    memcpy(array, &grown, sizeof grown);
    *max = more;
    return true;
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
    VkDebugUtilsMessengerCreateInfoEXT info = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT
    };
    info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
    /* Not GENERAL: the loader tells of drivers that it cannot load there. */
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    info.pfnUserCallback = message;
    info.pUserData = device;
    return info;
}

static bool layer_present(struct hl_device *device)
{
    VkLayerProperties *layers;
    uint32_t i, n = 0;
    bool found = false;
    if (vkEnumerateInstanceLayerProperties(&n, NULL) != VK_SUCCESS || !n)
        return false;
    layers = hl_bk_alloc(device, n * sizeof *layers);
    if (!layers)
        return false;
    if (vkEnumerateInstanceLayerProperties(&n, layers) >= VK_SUCCESS)
        for (i = 0; i < n; i++)
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
    VkApplicationInfo app = { .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO };
    VkValidationFeaturesEXT features = {
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT
    };
    VkInstanceCreateInfo info = { .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO };
    VkDebugUtilsMessengerCreateInfoEXT debug = messenger(device);
    app.pEngineName = "halflight";
    app.engineVersion = HL_VERSION;
    app.apiVersion = VK_API_VERSION_1_3;
    info.pApplicationInfo = &app;
    if (device) {
        /* The messenger in the chain hears the creation itself. */
        features.pNext = &debug;
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = sync;
        info.pNext = &features;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
    }
    return vkCreateInstance(&info, NULL, out);
}

static enum hl_result instance_open(struct hlvk *v, bool validation)
{
    VkResult result;
    if (validation && !layer_present(v->device)) {
        hl_bk_log(v->device, HL_LOG_WARNING, HL_MSG_VALIDATION, layer_name,
                  " is not installed: nothing is validated", NULL);
        validation = false;
    }
    result = instance_make(validation ? v->device : NULL, &v->instance);
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
    uint32_t i, r, family, n = MAX_DEVICES, m = 0;
    if (vkEnumeratePhysicalDevices(instance, &n, all) < VK_SUCCESS)
        return 0;
    for (r = 0; r < 5; r++)
        for (i = 0; i < n; i++)
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
    uint32_t i;
    (void)hooks;
    *n = 0;
    if (instance_make(NULL, &instance) != VK_SUCCESS)
        return HL_ERR_NO_DEVICE;
    *n = candidates(instance, found);
    for (i = 0; i < *n && i < max; i++)
        hlvk_describe(found[i], &out[i]);
    vkDestroyInstance(instance, NULL);
    return *n ? HL_OK : HL_ERR_NO_DEVICE;
}

static bool contains(const char *text, const char *part)
{
    size_t i;
    for (; *text; text++) {
        for (i = 0; part[i]; i++)
            if (tolower((unsigned char)text[i]) !=
                tolower((unsigned char)part[i]))
                break;
        if (!part[i])
            return true;
    }
    return false;
}

/* An index, or part of a name: "4090" is a name where there are fewer. */
static uint32_t pick(const char *want, const VkPhysicalDevice *found,
                     uint32_t n)
{
    struct hl_device_info info;
    uint32_t i, index = 0;
    size_t digits;
    if (!want || !*want)
        return 0;
    digits = strspn(want, "0123456789");
    for (i = 0; i < digits && index < n; i++)
        index = index * 10 + (uint32_t)(want[i] - '0');
    if (!want[digits] && index < n)
        return index;
    for (i = 0; i < n; i++) {
        hlvk_describe(found[i], &info);
        if (contains(info.name, want))
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
    VkPhysicalDeviceVulkan13Features f13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES
    };
    VkPhysicalDeviceFeatures has, want = { 0 };
    VkDeviceQueueCreateInfo queue = {
        .sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO
    };
    VkDeviceCreateInfo info = { .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO };
    enum hl_result result;
    vkGetPhysicalDeviceFeatures(v->physical, &has);
    want.sampleRateShading = has.sampleRateShading;
    f13.dynamicRendering = f13.synchronization2 = f13.maintenance4 = VK_TRUE;
    queue.queueFamilyIndex = v->family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    info.pNext = &f13;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.pEnabledFeatures = &want;
    result = hlvk_check(v, vkCreateDevice(v->physical, &info, NULL, &v->vk),
                        "vkCreateDevice");
    if (!result)
        vkGetDeviceQueue(v->vk, v->family, 0, &v->queue);
    return result;
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
    uint32_t i;
    for (i = 0; v->bufs && i < v->max_bufs; i++)
        hlvk_destroy(v, 'b', i);
    for (i = 0; v->texs && i < v->max_texs; i++)
        hlvk_destroy(v, 't', i);
    for (i = 0; v->progs && i < v->max_progs; i++)
        hlvk_destroy(v, 'p', i);
    hl_bk_free(v->device, v->bufs);
    hl_bk_free(v->device, v->texs);
    hl_bk_free(v->device, v->progs);
}

static void instance_close(struct hlvk *v)
{
    PFN_vkDestroyDebugUtilsMessengerEXT destroy;
    if (!v->borrowed && v->vk)
        vkDestroyDevice(v->vk, NULL);
    if (v->messenger) {
        destroy = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            v->instance, "vkDestroyDebugUtilsMessengerEXT");
        destroy(v->instance, v->messenger, NULL);
    }
    if (!v->borrowed && v->instance)
        vkDestroyInstance(v->instance, NULL);
}

static void close_device(void *state)
{
    struct hlvk *v = state;
    if (v->vk) {
        /* Recorded but never submitted work is dropped with its pool. */
        hlvk_frames_close(v);
        slots_close(v);
        hlvk_sets_close(v);
        hlvk_memory_close(v);
    } else {
        hl_bk_free(v->device, v->bufs);
        hl_bk_free(v->device, v->texs);
        hl_bk_free(v->device, v->progs);
    }
    instance_close(v);
    memset(v, 0, sizeof *v);
}

static enum hl_result open_device(void *state, struct hl_device *device,
                                  const struct hl_device_desc *desc,
                                  struct hl_caps *caps)
{
    struct hlvk *v = state;
    enum hl_result result;
    v->device = device;
    result = slots_open(v, desc);
    if (!result && desc->native) {
        result = borrow(v, desc->native, desc->validation);
    } else {
        if (!result)
            result = instance_open(v, desc->validation);
        if (!result)
            result = choose(v, desc->device);
        if (!result)
            result = connect(v);
    }
    if (!result) {
        names_enable(v);
        hlvk_caps(v, caps);
        result = hlvk_frames_open(v);
    }
    if (!result)
        result = hlvk_sets_open(v);
    if (result)
        close_device(v);
    return result;
}

const struct hl_backend hl_backend_vulkan = {
    "vulkan", HL_VERSION, sizeof(struct hlvk), list, open_device,
    close_device, hlvk_buf_create, hlvk_buf_write, hlvk_tex_create,
    hlvk_tex_write, hlvk_tex_read, hlvk_prog_create, hlvk_destroy,
    hlvk_pass_run, hlvk_submit, hlvk_timings
};
