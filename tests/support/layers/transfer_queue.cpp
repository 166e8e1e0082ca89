// A Vulkan layer that gives every device one more family with one queue, which only copies. What is submitted there
// runs on the driver's first queue, so that devices with a single queue stand in for those with an engine for copies.
#include <algorithm>
#include <mutex>
#include <vector>

#include "support/layers/vulkan_layer.h"

namespace {

// Those of the instance are looked up when it is made: later, the loader answers with the functions of this layer.
PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;
PFN_vkGetPhysicalDeviceQueueFamilyProperties next_properties = nullptr;
PFN_vkGetPhysicalDeviceQueueFamilyProperties2 next_properties_2 = nullptr;
VkInstance instance = VK_NULL_HANDLE;
VkDevice device = VK_NULL_HANDLE;
uint32_t families = 0;   // of the driver; the layer's family comes after them
std::mutex queue_mutex;  // the program does not know that its two queues are one

// As the loader wants it, the handle of a queue points at the device's dispatch table.
struct LayersQueue {
    void* dispatch_table = nullptr;
    VkQueue drivers = VK_NULL_HANDLE;
} layers_queue;

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(next_device_function(device, name));
}

VkQueue drivers(VkQueue queue) {
    return queue == reinterpret_cast<VkQueue>(&layers_queue) ? layers_queue.drivers : queue;
}

uint32_t drivers_family(uint32_t family) {
    return family == families ? 0 : family;
}

// Adds the layer's family to those that `get(&count, properties)` returns.
template <typename Properties, typename Get>
void add_family(uint32_t* count, Properties* properties, const Get& get,
                VkQueueFamilyProperties& (*core)(Properties&)) {
    uint32_t drivers_count = 0;
    get(&drivers_count, static_cast<Properties*>(nullptr));
    families = drivers_count;
    if (!properties) {
        *count = drivers_count + 1;
        return;
    }
    const uint32_t room = *count;
    *count = room < drivers_count ? room : drivers_count;
    get(count, properties);
    if (room <= drivers_count) return;
    core(properties[drivers_count]) = {VK_QUEUE_TRANSFER_BIT, 1, 0, {1, 1, 1}};
    *count = drivers_count + 1;
}

void VKAPI_CALL family_properties(VkPhysicalDevice physical, uint32_t* count, VkQueueFamilyProperties* properties) {
    add_family<VkQueueFamilyProperties>(
        count, properties, [&](uint32_t* n, VkQueueFamilyProperties* all) { next_properties(physical, n, all); },
        [](VkQueueFamilyProperties& one) -> VkQueueFamilyProperties& { return one; });
}

void VKAPI_CALL family_properties_2(VkPhysicalDevice physical, uint32_t* count, VkQueueFamilyProperties2* properties) {
    add_family<VkQueueFamilyProperties2>(
        count, properties, [&](uint32_t* n, VkQueueFamilyProperties2* all) { next_properties_2(physical, n, all); },
        [](VkQueueFamilyProperties2& one) -> VkQueueFamilyProperties& { return one.queueFamilyProperties; });
}

void VKAPI_CALL get_queue(VkDevice of, uint32_t family, uint32_t index, VkQueue* queue) {
    next<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(of, drivers_family(family), index, queue);
    if (family != families) return;
    layers_queue.dispatch_table = *reinterpret_cast<void**>(of);
    layers_queue.drivers = *queue;
    *queue = reinterpret_cast<VkQueue>(&layers_queue);
}

VkResult VKAPI_CALL create_pool(VkDevice of, const VkCommandPoolCreateInfo* info,
                                const VkAllocationCallbacks* allocator, VkCommandPool* pool) {
    VkCommandPoolCreateInfo changed = *info;
    changed.queueFamilyIndex = drivers_family(info->queueFamilyIndex);
    return next<PFN_vkCreateCommandPool>("vkCreateCommandPool")(of, &changed, allocator, pool);
}

VkResult VKAPI_CALL create_buffer(VkDevice of, const VkBufferCreateInfo* info, const VkAllocationCallbacks* allocator,
                                  VkBuffer* buffer) {
    std::vector<uint32_t> shared;  // without the layer's family
    for (uint32_t i = 0; i < info->queueFamilyIndexCount && info->sharingMode == VK_SHARING_MODE_CONCURRENT; ++i)
        if (const uint32_t family = drivers_family(info->pQueueFamilyIndices[i]);
            std::find(shared.begin(), shared.end(), family) == shared.end())
            shared.push_back(family);
    VkBufferCreateInfo changed = *info;
    changed.sharingMode = shared.size() > 1 ? VK_SHARING_MODE_CONCURRENT : VK_SHARING_MODE_EXCLUSIVE;
    changed.queueFamilyIndexCount = static_cast<uint32_t>(shared.size());
    changed.pQueueFamilyIndices = shared.data();
    return next<PFN_vkCreateBuffer>("vkCreateBuffer")(of, &changed, allocator, buffer);
}

VkResult VKAPI_CALL queue_submit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
    const std::lock_guard lock(queue_mutex);
    return next<PFN_vkQueueSubmit>("vkQueueSubmit")(drivers(queue), count, submits, fence);
}

VkResult VKAPI_CALL queue_submit_2(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
    const std::lock_guard lock(queue_mutex);
    return next<PFN_vkQueueSubmit2>("vkQueueSubmit2")(drivers(queue), count, submits, fence);
}

VkResult VKAPI_CALL name_object(VkDevice of, const VkDebugUtilsObjectNameInfoEXT* info) {
    VkDebugUtilsObjectNameInfoEXT changed = *info;
    if (info->objectHandle == reinterpret_cast<uint64_t>(&layers_queue))
        changed.objectHandle = reinterpret_cast<uint64_t>(layers_queue.drivers);
    const auto name = next<PFN_vkSetDebugUtilsObjectNameEXT>("vkSetDebugUtilsObjectNameEXT");
    return name ? name(of, &changed) : VK_SUCCESS;
}

VkResult VKAPI_CALL queue_wait_idle(VkQueue queue) {
    const std::lock_guard lock(queue_mutex);
    return next<PFN_vkQueueWaitIdle>("vkQueueWaitIdle")(drivers(queue));
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                    VkInstance* created) {
    const VkResult result = neuvv::test::create_instance_by_next(info, allocator, created, next_instance_function);
    if (result != VK_SUCCESS) return result;
    instance = *created;
    const auto get = [&](const char* name) { return next_instance_function(instance, name); };
    next_properties =
        reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(get("vkGetPhysicalDeviceQueueFamilyProperties"));
    next_properties_2 = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties2>(
        get("vkGetPhysicalDeviceQueueFamilyProperties2"));
    return result;
}

VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                  const VkAllocationCallbacks* allocator, VkDevice* created) {
    std::vector<VkDeviceQueueCreateInfo> queues;
    for (uint32_t i = 0; i < info->queueCreateInfoCount; ++i)
        if (info->pQueueCreateInfos[i].queueFamilyIndex != families) queues.push_back(info->pQueueCreateInfos[i]);
    VkDeviceCreateInfo changed = *info;
    changed.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
    changed.pQueueCreateInfos = queues.data();
    const VkResult result =
        neuvv::test::create_device_by_next(instance, physical, &changed, allocator, created, next_device_function);
    device = *created;
    return result;
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name);
PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name);

const neuvv::test::LayerFunction kFunctions[] = {{"vkGetInstanceProcAddr", &instance_function},
                                                 {"vkGetDeviceProcAddr", &device_function},
                                                 {"vkCreateInstance", &create_instance},
                                                 {"vkCreateDevice", &create_device},
                                                 {"vkGetPhysicalDeviceQueueFamilyProperties", &family_properties},
                                                 {"vkGetPhysicalDeviceQueueFamilyProperties2", &family_properties_2},
                                                 {"vkGetPhysicalDeviceQueueFamilyProperties2KHR", &family_properties_2},
                                                 {"vkGetDeviceQueue", &get_queue},
                                                 {"vkCreateCommandPool", &create_pool},
                                                 {"vkCreateBuffer", &create_buffer},
                                                 {"vkQueueSubmit", &queue_submit},
                                                 {"vkQueueSubmit2", &queue_submit_2},
                                                 {"vkQueueSubmit2KHR", &queue_submit_2},
                                                 {"vkQueueWaitIdle", &queue_wait_idle},
                                                 {"vkSetDebugUtilsObjectNameEXT", &name_object}};

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name) {
    const PFN_vkVoidFunction own = neuvv::test::own_function(kFunctions, name);
    return own ? own : next_instance_function ? next_instance_function(of, name) : nullptr;
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name) {
    const PFN_vkVoidFunction own = neuvv::test::own_function(kFunctions, name);
    return own ? own : next_device_function(of, name);
}

}  // namespace

NEUVV_LAYER_EXPORT VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
    return neuvv::test::negotiated(interface, &instance_function, &device_function);
}
