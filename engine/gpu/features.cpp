#include "gpu/features.h"

#include <cstring>

namespace neuvv::gpu {

bool has_extension(VkPhysicalDevice physical, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    for (const auto& extension : extensions)
        if (std::strcmp(extension.extensionName, name) == 0) return true;
    return false;
}

namespace {

struct Feature {
    const char* name;
    VkBool32& (*field)(FeatureChain&);
};

// Required of every device. Messages about missing features take the names from here.
const Feature kRequired[] = {
    {"scalarBlockLayout", [](FeatureChain& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    {"timelineSemaphore", [](FeatureChain& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
    {"hostQueryReset", [](FeatureChain& f) -> VkBool32& { return f.v12.hostQueryReset; }},
    {"maintenance4", [](FeatureChain& f) -> VkBool32& { return f.v13.maintenance4; }},  // LocalSizeId in our SPIR-V
    {"synchronization2", [](FeatureChain& f) -> VkBool32& { return f.v13.synchronization2; }},
    {"dynamicRendering", [](FeatureChain& f) -> VkBool32& { return f.v13.dynamicRendering; }},
};

VkBool32& float_atomic_add(FeatureChain& f) {
    return f.atomic_float.shaderBufferFloat32AtomicAdd;
}

VkBool32& buffer_addresses(FeatureChain& f) {
    return f.v12.bufferDeviceAddress;
}

VkBool32& output_layer(FeatureChain& f) {
    return f.v12.shaderOutputLayer;
}

bool at_least_vulkan_1_3(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    return properties.apiVersion >= VK_API_VERSION_1_3;
}

FeatureChain query(VkPhysicalDevice physical) {
    FeatureChain chain;
    chain.float_atomics = has_extension(physical, VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME);
    chain.link();
    vkGetPhysicalDeviceFeatures2(physical, &chain.core);
    return chain;
}

}  // namespace

void FeatureChain::link() {
    core.pNext = &v11;
    v11.pNext = &v12;
    v12.pNext = &v13;
    v13.pNext = float_atomics ? &atomic_float : nullptr;
}

FeatureChain features_to_enable(VkPhysicalDevice physical) {
    FeatureChain available = query(physical);
    FeatureChain enable;
    for (const Feature& feature : kRequired) feature.field(enable) = feature.field(available);
    output_layer(enable) = output_layer(available);
    buffer_addresses(enable) = buffer_addresses(available);
    enable.float_atomics = available.float_atomics && float_atomic_add(available);
    if (enable.float_atomics) {
        float_atomic_add(enable) = VK_TRUE;
        enable.extensions.push_back(VK_EXT_SHADER_ATOMIC_FLOAT_EXTENSION_NAME);
    }
    if (has_extension(physical, VK_EXT_MEMORY_BUDGET_EXTENSION_NAME))
        enable.extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    if (has_extension(physical, "VK_KHR_portability_subset")) enable.extensions.push_back("VK_KHR_portability_subset");
    return enable;
}

bool has_buffer_addresses(VkPhysicalDevice physical) {
    if (!at_least_vulkan_1_3(physical)) return false;
    FeatureChain available = query(physical);
    return buffer_addresses(available);
}

void find_lacking_features(VkPhysicalDevice physical, std::vector<std::string>& missing,
                           std::vector<std::string>& optional) {
    if (!at_least_vulkan_1_3(physical)) {
        missing.emplace_back("Vulkan 1.3");
        return;
    }
    FeatureChain available = query(physical);
    for (const Feature& feature : kRequired)
        if (!feature.field(available)) missing.emplace_back(feature.name);
    if (!available.float_atomics || !float_atomic_add(available))
        optional.emplace_back("shaderBufferFloat32AtomicAdd (compare-and-swap stands in)");
    if (!buffer_addresses(available)) optional.emplace_back("bufferDeviceAddress (long arrays are texel buffers)");
    if (!output_layer(available)) optional.emplace_back("shaderOutputLayer (headsets are not drawn for)");
}

}  // namespace neuvv::gpu
