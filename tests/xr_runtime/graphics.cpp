// XR_KHR_vulkan_enable and XR_KHR_vulkan_enable2: the Vulkan instance and device that the application must use.
#include <dlfcn.h>

#include "call.h"

namespace neuvv::xr_runtime {

namespace {

// Runtimes that share images with a compositor require these extensions. Here they are only required to check that the
// application enables what it is told to.
constexpr const char* kInstanceExtensions[] = {"VK_KHR_get_physical_device_properties2",
                                               "VK_KHR_external_memory_capabilities"};
constexpr const char* kDeviceExtensions[] = {"VK_KHR_get_memory_requirements2", "VK_KHR_dedicated_allocation",
                                             "VK_KHR_external_memory"};
constexpr XrVersion kMinVulkan = XR_MAKE_VERSION(1, 1, 0), kMaxVulkan = XR_MAKE_VERSION(1, 3, 0xfff);

template <typename Function>
Function load(PFN_vkGetInstanceProcAddr loader, VkInstance instance, const char* name) {
    const auto function = reinterpret_cast<Function>(loader(instance, name));
    if (!function) throw std::runtime_error(fmt::format("{} is not to be had", name));
    return function;
}

template <size_t kCount>
std::string joined(const char* const (&names)[kCount]) {
    return fmt::format("{}", fmt::join(names, " "));
}

XrResult get_instance_extensions(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count, char* out) {
    check_system(instance_of(handle), system);
    return give_text(capacity, count, out, joined(kInstanceExtensions));
}

XrResult get_device_extensions(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count, char* out) {
    check_system(instance_of(handle), system);
    return give_text(capacity, count, out, joined(kDeviceExtensions));
}

XrResult give_requirements(XrGraphicsRequirementsVulkanKHR* out) {
    XrGraphicsRequirementsVulkanKHR& requirements = checked(out);
    requirements.minApiVersionSupported = kMinVulkan;
    requirements.maxApiVersionSupported = kMaxVulkan;
    return XR_SUCCESS;
}

XrResult get_requirements(XrInstance handle, XrSystemId system, XrGraphicsRequirementsVulkanKHR* out) {
    Instance& instance = instance_of(handle);
    check_system(instance, system);
    instance.asked_requirements = true;
    return give_requirements(out);
}

XrResult get_requirements2(XrInstance handle, XrSystemId system, XrGraphicsRequirementsVulkanKHR* out) {
    Instance& instance = instance_of(handle);
    check_system(instance, system);
    instance.asked_requirements2 = true;
    return give_requirements(out);
}

VkPhysicalDevice first_device(PFN_vkGetInstanceProcAddr loader, VkInstance vulkan) {
    const auto enumerate = load<PFN_vkEnumeratePhysicalDevices>(loader, vulkan, "vkEnumeratePhysicalDevices");
    uint32_t count = 1;
    VkPhysicalDevice device = VK_NULL_HANDLE;
    const VkResult result = enumerate(vulkan, &count, &device);
    if ((result != VK_SUCCESS && result != VK_INCOMPLETE) || count == 0) throw std::runtime_error("no Vulkan device");
    return device;
}

XrResult get_device(XrInstance handle, XrSystemId system, VkInstance vulkan, VkPhysicalDevice* out) {
    Instance& instance = instance_of(handle);
    check_system(instance, system);
    check_pointer(vulkan, "vkInstance");
    check_pointer(out, "vkPhysicalDevice");
    *out = instance.graphics_devices[vulkan] = first_device(vulkan_loader(), vulkan);
    return XR_SUCCESS;
}

XrResult get_device2(XrInstance handle, const XrVulkanGraphicsDeviceGetInfoKHR* get_info, VkPhysicalDevice* out) {
    Instance& instance = instance_of(handle);
    const auto& info = checked(get_info);
    check_system(instance, info.systemId);
    check_pointer(out, "vulkanPhysicalDevice");
    const auto known = instance.vulkan_instances.find(info.vulkanInstance);
    require(known != instance.vulkan_instances.end(), XR_ERROR_VALIDATION_FAILURE, "graphics-device",
            "the VkInstance must be made by xrCreateVulkanInstanceKHR");
    *out = instance.graphics_devices[info.vulkanInstance] = first_device(known->second, info.vulkanInstance);
    return XR_SUCCESS;
}

// The application's names, and those of the runtime that the driver has and the application's list lacks.
template <size_t kCount>
std::vector<const char*> merged(const char* const* names, uint32_t count, const char* const (&own)[kCount],
                                const std::vector<VkExtensionProperties>& available) {
    std::vector<const char*> all(names, names + count);
    for (const char* name : own) {
        auto is_name = [&](const char* other) { return !std::strcmp(other, name); };
        const bool is_asked = std::any_of(all.begin(), all.end(), is_name);
        const bool is_there = std::any_of(available.begin(), available.end(),
                                          [&](const VkExtensionProperties& e) { return is_name(e.extensionName); });
        if (!is_asked && is_there) all.push_back(name);
    }
    return all;
}

XrResult create_vulkan_instance(XrInstance handle, const XrVulkanInstanceCreateInfoKHR* create_info, VkInstance* out,
                                VkResult* vulkan_result) {
    Instance& instance = instance_of(handle);
    const auto& info = checked(create_info);
    check_system(instance, info.systemId);
    require(info.createFlags == 0, XR_ERROR_VALIDATION_FAILURE, "flags", "createFlags must be 0");
    check_pointer(reinterpret_cast<const void*>(info.pfnGetInstanceProcAddr), "pfnGetInstanceProcAddr");
    check_pointer(info.vulkanCreateInfo, "vulkanCreateInfo");
    check_pointer(out, "vulkanInstance");
    check_pointer(vulkan_result, "vulkanResult");
    if (!instance.asked_requirements2)
        warn("graphics-requirements", "the VkInstance is made before xrGetVulkanGraphicsRequirements2KHR was asked");

    const auto enumerate = load<PFN_vkEnumerateInstanceExtensionProperties>(info.pfnGetInstanceProcAddr, VK_NULL_HANDLE,
                                                                            "vkEnumerateInstanceExtensionProperties");
    uint32_t count = 0;
    enumerate(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> available(count);
    enumerate(nullptr, &count, available.data());
    VkInstanceCreateInfo create = *info.vulkanCreateInfo;
    const auto names =
        merged(create.ppEnabledExtensionNames, create.enabledExtensionCount, kInstanceExtensions, available);
    create.enabledExtensionCount = static_cast<uint32_t>(names.size());
    create.ppEnabledExtensionNames = names.data();
    *vulkan_result = load<PFN_vkCreateInstance>(info.pfnGetInstanceProcAddr, VK_NULL_HANDLE, "vkCreateInstance")(
        &create, info.vulkanAllocator, out);
    if (*vulkan_result == VK_SUCCESS) instance.vulkan_instances[*out] = info.pfnGetInstanceProcAddr;
    return XR_SUCCESS;
}

XrResult create_vulkan_device(XrInstance handle, const XrVulkanDeviceCreateInfoKHR* create_info, VkDevice* out,
                              VkResult* vulkan_result) {
    Instance& instance = instance_of(handle);
    const auto& info = checked(create_info);
    check_system(instance, info.systemId);
    require(info.createFlags == 0, XR_ERROR_VALIDATION_FAILURE, "flags", "createFlags must be 0");
    check_pointer(reinterpret_cast<const void*>(info.pfnGetInstanceProcAddr), "pfnGetInstanceProcAddr");
    check_pointer(info.vulkanCreateInfo, "vulkanCreateInfo");
    check_pointer(out, "vulkanDevice");
    check_pointer(vulkan_result, "vulkanResult");
    VkInstance vulkan = VK_NULL_HANDLE;
    for (const auto& [of, device] : instance.graphics_devices)
        if (device == info.vulkanPhysicalDevice) vulkan = of;
    require(vulkan, XR_ERROR_HANDLE_INVALID, "graphics-device",
            "the VkPhysicalDevice must be the one that xrGetVulkanGraphicsDevice2KHR gave");

    const PFN_vkGetInstanceProcAddr loader = info.pfnGetInstanceProcAddr;
    const auto enumerate =
        load<PFN_vkEnumerateDeviceExtensionProperties>(loader, vulkan, "vkEnumerateDeviceExtensionProperties");
    uint32_t count = 0;
    enumerate(info.vulkanPhysicalDevice, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> available(count);
    enumerate(info.vulkanPhysicalDevice, nullptr, &count, available.data());
    VkDeviceCreateInfo create = *info.vulkanCreateInfo;
    const auto names =
        merged(create.ppEnabledExtensionNames, create.enabledExtensionCount, kDeviceExtensions, available);
    create.enabledExtensionCount = static_cast<uint32_t>(names.size());
    create.ppEnabledExtensionNames = names.data();
    *vulkan_result = load<PFN_vkCreateDevice>(loader, vulkan, "vkCreateDevice")(info.vulkanPhysicalDevice, &create,
                                                                                info.vulkanAllocator, out);
    if (*vulkan_result == VK_SUCCESS) instance.vulkan_devices[*out] = info.vulkanPhysicalDevice;
    return XR_SUCCESS;
}

}  // namespace

PFN_vkGetInstanceProcAddr vulkan_loader() {
    void* library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    void* function = library ? dlsym(library, "vkGetInstanceProcAddr") : nullptr;
    if (!function) throw std::runtime_error("libvulkan.so.1 is not to be had");
    return reinterpret_cast<PFN_vkGetInstanceProcAddr>(function);
}

std::vector<EntryPoint> graphics_entries() {
    constexpr const char *kFirst = XR_KHR_VULKAN_ENABLE_EXTENSION_NAME, *kSecond = XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY_OF(kFirst, nullptr, xrGetVulkanInstanceExtensionsKHR, get_instance_extensions),
            NEUVV_XR_ENTRY_OF(kFirst, nullptr, xrGetVulkanDeviceExtensionsKHR, get_device_extensions),
            NEUVV_XR_ENTRY_OF(kFirst, nullptr, xrGetVulkanGraphicsDeviceKHR, get_device),
            NEUVV_XR_ENTRY_OF(kFirst, nullptr, xrGetVulkanGraphicsRequirementsKHR, get_requirements),
            NEUVV_XR_ENTRY_OF(kSecond, nullptr, xrCreateVulkanInstanceKHR, create_vulkan_instance),
            NEUVV_XR_ENTRY_OF(kSecond, nullptr, xrCreateVulkanDeviceKHR, create_vulkan_device),
            NEUVV_XR_ENTRY_OF(kSecond, nullptr, xrGetVulkanGraphicsDevice2KHR, get_device2),
            NEUVV_XR_ENTRY_OF(kSecond, nullptr, xrGetVulkanGraphicsRequirements2KHR, get_requirements2)};
}

}  // namespace neuvv::xr_runtime
