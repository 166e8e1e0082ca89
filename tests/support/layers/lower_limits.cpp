// A Vulkan layer that lowers the limits of all devices, so that a large device stands in for a small one:
// NEUVV_MOST_TEXELS is maxTexelBufferElements, NEUVV_MOST_STORAGE_BYTES is maxStorageBufferRange, and
// NEUVV_MOST_ALLOCATION is maxMemoryAllocationSize and maxBufferSize. With NEUVV_SAYS_GPU, a device says that it is a
// discrete GPU, so that lavapipe stands in for one.
#include <algorithm>
#include <cstdlib>

#include "support/layers/vulkan_layer.h"

namespace {

// Of the only instance that the program has at a time. They are looked up when it is made: later, the loader answers
// with the functions of this layer.
PFN_vkGetInstanceProcAddr next_function = nullptr;
PFN_vkGetPhysicalDeviceProperties next_properties = nullptr;
PFN_vkGetPhysicalDeviceProperties2 next_properties_2 = nullptr;

template <typename Number>
void lower(Number& limit, const char* name) {
    if (const char* most = std::getenv(name))
        limit = std::min(limit, static_cast<Number>(std::strtoul(most, nullptr, 10)));
}

void change(VkPhysicalDeviceProperties& all) {
    lower(all.limits.maxTexelBufferElements, "NEUVV_MOST_TEXELS");
    lower(all.limits.maxStorageBufferRange, "NEUVV_MOST_STORAGE_BYTES");
    if (std::getenv("NEUVV_SAYS_GPU")) all.deviceType = VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
}

void VKAPI_CALL properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* all) {
    next_properties(physical, all);
    change(*all);
}

void VKAPI_CALL properties_2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* all) {
    next_properties_2(physical, all);
    change(all->properties);
    for (auto* more = static_cast<VkBaseOutStructure*>(all->pNext); more; more = more->pNext) {
        if (more->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES)
            lower(reinterpret_cast<VkPhysicalDeviceVulkan11Properties*>(more)->maxMemoryAllocationSize,
                  "NEUVV_MOST_ALLOCATION");
        if (more->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES)
            lower(reinterpret_cast<VkPhysicalDeviceVulkan13Properties*>(more)->maxBufferSize, "NEUVV_MOST_ALLOCATION");
    }
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                    VkInstance* created) {
    const VkResult result = neuvv::test::create_instance_by_next(info, allocator, created, next_function);
    if (result != VK_SUCCESS) return result;
    next_properties =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(next_function(*created, "vkGetPhysicalDeviceProperties"));
    next_properties_2 =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(next_function(*created, "vkGetPhysicalDeviceProperties2"));
    return result;
}

PFN_vkVoidFunction VKAPI_CALL function(VkInstance of, const char* name);

const neuvv::test::LayerFunction kFunctions[] = {
    {"vkGetInstanceProcAddr", &function},
    {"vkCreateInstance", &create_instance},
    {"vkGetPhysicalDeviceProperties", &properties},
    {"vkGetPhysicalDeviceProperties2", &properties_2},
    // The loader calls it by this name where the instance has the extension.
    {"vkGetPhysicalDeviceProperties2KHR", &properties_2}};

PFN_vkVoidFunction VKAPI_CALL function(VkInstance of, const char* name) {
    if (const auto own = neuvv::test::own_function(kFunctions, name)) return own;
    return next_function ? next_function(of, name) : nullptr;
}

}  // namespace

NEUVV_LAYER_EXPORT VkResult VKAPI_CALL vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* interface) {
    return neuvv::test::negotiated(interface, &function, nullptr);
}
