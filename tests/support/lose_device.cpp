// A Vulkan layer that loses the device of a program: once the file exists that NEUVV_LOSE_DEVICE names, a submission
// fails with VK_ERROR_DEVICE_LOST, and so does all that waits, as on a real device, until the program destroys it. The
// file holds the number of losses that are still to come. NEUVV_LOSE_DEVICE_AFTER: so many submissions succeed first.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace {

// Of the only instance and the only device that the program has at a time.
PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;
VkInstance instance = VK_NULL_HANDLE;
VkDevice device = VK_NULL_HANDLE;
std::atomic<bool> is_lost = false;
std::atomic<int> submissions = 0;

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(next_device_function(device, name));
}

bool shall_be_lost() {
    const char* after = std::getenv("NEUVV_LOSE_DEVICE_AFTER");
    if (submissions++ < (after ? std::atoi(after) : 0)) return false;
    const char* path = std::getenv("NEUVV_LOSE_DEVICE");
    if (!path || !std::filesystem::exists(path)) return false;
    int losses = 0;
    std::ifstream(path) >> losses;
    if (losses > 1)
        std::ofstream(path) << losses - 1;
    else
        std::filesystem::remove(path);
    return losses > 0;
}

VkResult VKAPI_CALL queue_submit_2(VkQueue queue, uint32_t count, const VkSubmitInfo2* submits, VkFence fence) {
    if (!is_lost && shall_be_lost()) {
        next<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(device);  // so that nothing is under way that will be destroyed
        is_lost = true;
    }
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkQueueSubmit2>("vkQueueSubmit2")(queue, count, submits, fence);
}

VkResult VKAPI_CALL queue_submit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, count, submits, fence);
}

VkResult VKAPI_CALL queue_present(VkQueue queue, const VkPresentInfoKHR* info) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkQueuePresentKHR>("vkQueuePresentKHR")(queue, info);
}

VkResult VKAPI_CALL acquire(VkDevice from, VkSwapchainKHR swapchain, uint64_t timeout, VkSemaphore semaphore,
                            VkFence fence, uint32_t* index) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkAcquireNextImageKHR>("vkAcquireNextImageKHR")(from, swapchain, timeout, semaphore, fence, index);
}

VkResult VKAPI_CALL wait_for_fences(VkDevice of, uint32_t count, const VkFence* fences, VkBool32 all,
                                    uint64_t timeout) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkWaitForFences>("vkWaitForFences")(of, count, fences, all, timeout);
}

VkResult VKAPI_CALL fence_status(VkDevice of, VkFence fence) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkGetFenceStatus>("vkGetFenceStatus")(of, fence);
}

VkResult VKAPI_CALL device_wait_idle(VkDevice of) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(of);
}

VkResult VKAPI_CALL queue_wait_idle(VkQueue queue) {
    if (is_lost) return VK_ERROR_DEVICE_LOST;
    return next<PFN_vkQueueWaitIdle>("vkQueueWaitIdle")(queue);
}

// The loader's link to the next layer, which the layer has to hand on.
template <typename Info, VkStructureType kType>
auto*& link_of(const void* chain) {
    auto* info = static_cast<const Info*>(chain);
    while (info->sType != kType || info->function != VK_LAYER_LINK_INFO) info = static_cast<const Info*>(info->pNext);
    return const_cast<Info*>(info)->u.pLayerInfo;
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                    VkInstance* created) {
    auto*& link = link_of<VkLayerInstanceCreateInfo, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO>(info->pNext);
    next_instance_function = link->pfnNextGetInstanceProcAddr;
    link = link->pNext;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_instance_function(nullptr, "vkCreateInstance"));
    const VkResult result = create(info, allocator, created);
    instance = *created;
    return result;
}

VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                  const VkAllocationCallbacks* allocator, VkDevice* created) {
    auto*& link = link_of<VkLayerDeviceCreateInfo, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO>(info->pNext);
    const auto create =
        reinterpret_cast<PFN_vkCreateDevice>(link->pfnNextGetInstanceProcAddr(instance, "vkCreateDevice"));
    next_device_function = link->pfnNextGetDeviceProcAddr;
    link = link->pNext;
    const VkResult result = create(physical, info, allocator, created);
    device = *created;
    is_lost = false;
    return result;
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name);
PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name);

PFN_vkVoidFunction own_function(const char* name) {
    const struct {
        const char* name;
        PFN_vkVoidFunction function;
    } own[] = {{"vkGetInstanceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(&instance_function)},
               {"vkGetDeviceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(&device_function)},
               {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(&create_instance)},
               {"vkCreateDevice", reinterpret_cast<PFN_vkVoidFunction>(&create_device)},
               {"vkQueueSubmit2", reinterpret_cast<PFN_vkVoidFunction>(&queue_submit_2)},
               {"vkQueueSubmit", reinterpret_cast<PFN_vkVoidFunction>(&queue_submit)},
               {"vkQueuePresentKHR", reinterpret_cast<PFN_vkVoidFunction>(&queue_present)},
               {"vkAcquireNextImageKHR", reinterpret_cast<PFN_vkVoidFunction>(&acquire)},
               {"vkWaitForFences", reinterpret_cast<PFN_vkVoidFunction>(&wait_for_fences)},
               {"vkGetFenceStatus", reinterpret_cast<PFN_vkVoidFunction>(&fence_status)},
               {"vkDeviceWaitIdle", reinterpret_cast<PFN_vkVoidFunction>(&device_wait_idle)},
               {"vkQueueWaitIdle", reinterpret_cast<PFN_vkVoidFunction>(&queue_wait_idle)}};
    for (const auto& one : own)
        if (std::strcmp(one.name, name) == 0) return one.function;
    return nullptr;
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name) {
    if (const auto own = own_function(name)) return own;
    return next_instance_function ? next_instance_function(of, name) : nullptr;
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name) {
    if (const auto own = own_function(name)) return own;
    return next_device_function ? next_device_function(of, name) : nullptr;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
    interface->loaderLayerInterfaceVersion = 2;
    interface->pfnGetInstanceProcAddr = &instance_function;
    interface->pfnGetDeviceProcAddr = &device_function;
    interface->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
