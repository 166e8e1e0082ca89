// What the tests' Vulkan layers share. A layer stands for the only instance and the only device that a program has at a
// time.
#pragma once

#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <cstring>
#include <span>

namespace neuvv::test {

// A function of a layer by its Vulkan name.
struct LayerFunction {
    const char* name;
    PFN_vkVoidFunction function;

    template <typename Function>
    LayerFunction(const char* its_name, Function its_function)
        : name(its_name), function(reinterpret_cast<PFN_vkVoidFunction>(its_function)) {}
};

// Null: the layer leaves it to the next one.
inline PFN_vkVoidFunction own_function(std::span<const LayerFunction> functions, const char* name) {
    for (const LayerFunction& one : functions)
        if (std::strcmp(one.name, name) == 0) return one.function;
    return nullptr;
}

// The loader's link to the next layer, which the layer has to hand on.
template <typename Info, VkStructureType kType>
auto*& link_of(const void* chain) {
    auto* info = static_cast<const Info*>(chain);
    while (info->sType != kType || info->function != VK_LAYER_LINK_INFO) info = static_cast<const Info*>(info->pNext);
    return const_cast<Info*>(info)->u.pLayerInfo;
}

// Creates the instance by the next layer, and sets `next` to what has the next layer's functions.
inline VkResult create_instance_by_next(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                        VkInstance* created, PFN_vkGetInstanceProcAddr& next) {
    auto*& link = link_of<VkLayerInstanceCreateInfo, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO>(info->pNext);
    next = link->pfnNextGetInstanceProcAddr;
    link = link->pNext;
    return reinterpret_cast<PFN_vkCreateInstance>(next(nullptr, "vkCreateInstance"))(info, allocator, created);
}

// The same for a device.
inline VkResult create_device_by_next(VkInstance instance, VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                      const VkAllocationCallbacks* allocator, VkDevice* created,
                                      PFN_vkGetDeviceProcAddr& next) {
    auto*& link = link_of<VkLayerDeviceCreateInfo, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO>(info->pNext);
    const auto create =
        reinterpret_cast<PFN_vkCreateDevice>(link->pfnNextGetInstanceProcAddr(instance, "vkCreateDevice"));
    next = link->pfnNextGetDeviceProcAddr;
    link = link->pNext;
    return create(physical, info, allocator, created);
}

// What a layer answers to vkNegotiateLoaderLayerInterfaceVersion. `of_device` may be null.
inline VkResult negotiated(VkNegotiateLayerInterface* interface, PFN_vkGetInstanceProcAddr of_instance,
                           PFN_vkGetDeviceProcAddr of_device) {
    interface->loaderLayerInterfaceVersion = 2;
    interface->pfnGetInstanceProcAddr = of_instance;
    interface->pfnGetDeviceProcAddr = of_device;
    interface->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}

}  // namespace neuvv::test

#define NEUVV_LAYER_EXPORT extern "C" __attribute__((visibility("default")))
