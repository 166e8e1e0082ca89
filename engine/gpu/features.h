// The table of device features: those that the program requires, and those that it uses where a device has them.
#pragma once

#include <volk.h>

#include <string>
#include <vector>

namespace neuvv::gpu {

// The features that a device has, or those to enable, as the chain of structures that Vulkan expects. link() sets the
// pointers of the chain, so it must be called after the last copy or move.
struct FeatureChain {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomic_float{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT};
    bool float_atomics = false;  // whether the device has the extension, and atomic_float is part of the chain
    std::vector<const char*> extensions;

    void link();
};

bool has_extension(VkPhysicalDevice physical, const char* name);

// The features of the table that this device has, and no others.
FeatureChain features_to_enable(VkPhysicalDevice physical);

// Whether shaders may read buffers by their addresses there, which is optional.
bool has_buffer_addresses(VkPhysicalDevice physical);

// Appends to `missing` the required features that the device lacks, and to `optional` the optional ones, each with its
// substitute.
void find_lacking_features(VkPhysicalDevice physical, std::vector<std::string>& missing,
                           std::vector<std::string>& optional);

}  // namespace neuvv::gpu
