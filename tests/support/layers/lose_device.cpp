// A Vulkan layer that loses the device of a program: once the file exists that NEUVV_LOSE_DEVICE names, a submission
// fails with VK_ERROR_DEVICE_LOST, and so does all that waits, as on a real device, until the program destroys it. The
// file holds the number of losses that are still to come. NEUVV_LOSE_DEVICE_AFTER: so many submissions succeed first.
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "support/layers/vulkan_layer.h"

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

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                    VkInstance* created) {
    const VkResult result = neuvv::test::create_instance_by_next(info, allocator, created, next_instance_function);
    instance = *created;
    return result;
}

VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                  const VkAllocationCallbacks* allocator, VkDevice* created) {
    const VkResult result =
        neuvv::test::create_device_by_next(instance, physical, info, allocator, created, next_device_function);
    device = *created;
    is_lost = false;
    return result;
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name);
PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name);

const neuvv::test::LayerFunction kFunctions[] = {
    {"vkGetInstanceProcAddr", &instance_function}, {"vkGetDeviceProcAddr", &device_function},
    {"vkCreateInstance", &create_instance},        {"vkCreateDevice", &create_device},
    {"vkQueueSubmit2", &queue_submit_2},           {"vkQueueSubmit", &queue_submit},
    {"vkQueuePresentKHR", &queue_present},         {"vkAcquireNextImageKHR", &acquire},
    {"vkWaitForFences", &wait_for_fences},         {"vkGetFenceStatus", &fence_status},
    {"vkDeviceWaitIdle", &device_wait_idle},       {"vkQueueWaitIdle", &queue_wait_idle}};

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name) {
    if (const auto own = neuvv::test::own_function(kFunctions, name)) return own;
    return next_instance_function ? next_instance_function(of, name) : nullptr;
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name) {
    if (const auto own = neuvv::test::own_function(kFunctions, name)) return own;
    return next_device_function ? next_device_function(of, name) : nullptr;
}

}  // namespace

NEUVV_LAYER_EXPORT VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
    return neuvv::test::negotiated(interface, &instance_function, &device_function);
}
