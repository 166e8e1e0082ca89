// The one table of device features: what the program requires, and what it uses where it is there.
#pragma once

#include <volk.h>

#include <string>
#include <vector>

namespace neuvv::gpu {

// The features of a device, or those to enable, as Vulkan wants them chained. link() sets the chain; call it after the
// last copy or move.
struct FeatureChain {
    VkPhysicalDeviceFeatures2 core{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
    VkPhysicalDeviceVulkan11Features v11{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceShaderAtomicFloatFeaturesEXT atomic_float{
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SHADER_ATOMIC_FLOAT_FEATURES_EXT};
    bool float_atomics = false;  // the extension is there: atomic_float belongs in the chain
    std::vector<const char*> extensions;

    void link();
};

bool has_extension(VkPhysicalDevice physical, const char* name);

// Exactly the features of the table that this device has.
FeatureChain features_to_enable(VkPhysicalDevice physical);

// `missing`: required features that the device lacks. `optional`: the others it lacks, with what stands in.
void find_lacking_features(VkPhysicalDevice physical, std::vector<std::string>& missing,
                           std::vector<std::string>& optional);

}  // namespace neuvv::gpu
