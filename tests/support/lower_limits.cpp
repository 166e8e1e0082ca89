// A Vulkan layer that lowers the limits of all devices, so that a large device stands in for a small one:
// NEUVV_MOST_TEXELS is maxTexelBufferElements, NEUVV_MOST_STORAGE_BYTES is maxStorageBufferRange.
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace {

// Of the only instance that the program has at a time. They are looked up when it is made: later, the loader answers
// with the functions of this layer.
PFN_vkGetInstanceProcAddr next_function = nullptr;
PFN_vkGetPhysicalDeviceProperties next_properties = nullptr;
PFN_vkGetPhysicalDeviceProperties2 next_properties_2 = nullptr;

void lower(uint32_t& limit, const char* name) {
    if (const char* most = std::getenv(name))
        limit = std::min(limit, static_cast<uint32_t>(std::strtoul(most, nullptr, 10)));
}

void lower_all(VkPhysicalDeviceLimits& limits) {
    lower(limits.maxTexelBufferElements, "NEUVV_MOST_TEXELS");
    lower(limits.maxStorageBufferRange, "NEUVV_MOST_STORAGE_BYTES");
}

void VKAPI_CALL properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* all) {
    next_properties(physical, all);
    lower_all(all->limits);
}

void VKAPI_CALL properties_2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* all) {
    next_properties_2(physical, all);
    lower_all(all->properties.limits);
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                    VkInstance* created) {
    const auto* link = static_cast<const VkLayerInstanceCreateInfo*>(info->pNext);
    while (link->sType != VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO || link->function != VK_LAYER_LINK_INFO)
        link = static_cast<const VkLayerInstanceCreateInfo*>(link->pNext);
    auto*& next = const_cast<VkLayerInstanceCreateInfo*>(link)->u.pLayerInfo;
    next_function = next->pfnNextGetInstanceProcAddr;
    next = next->pNext;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_function(nullptr, "vkCreateInstance"));
    const VkResult result = create(info, allocator, created);
    if (result != VK_SUCCESS) return result;
    next_properties =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(next_function(*created, "vkGetPhysicalDeviceProperties"));
    next_properties_2 =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(next_function(*created, "vkGetPhysicalDeviceProperties2"));
    return result;
}

PFN_vkVoidFunction VKAPI_CALL function(VkInstance of, const char* name) {
    const struct {
        const char* name;
        PFN_vkVoidFunction function;
    } own[] = {{"vkGetInstanceProcAddr", reinterpret_cast<PFN_vkVoidFunction>(&function)},
               {"vkCreateInstance", reinterpret_cast<PFN_vkVoidFunction>(&create_instance)},
               {"vkGetPhysicalDeviceProperties", reinterpret_cast<PFN_vkVoidFunction>(&properties)},
               {"vkGetPhysicalDeviceProperties2", reinterpret_cast<PFN_vkVoidFunction>(&properties_2)}};
    for (const auto& one : own)
        if (std::strcmp(one.name, name) == 0) return one.function;
    return next_function ? next_function(of, name) : nullptr;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
    interface->loaderLayerInterfaceVersion = 2;
    interface->pfnGetInstanceProcAddr = &function;
    interface->pfnGetDeviceProcAddr = nullptr;
    interface->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
