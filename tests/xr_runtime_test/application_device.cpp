// The application's Vulkan instance and device, by either one of the two extensions.
#include <algorithm>
#include <iterator>
#include <sstream>

#include "xr_runtime_test/application.h"

namespace neuvv::test {

namespace {

void check_vulkan(VkResult result, const char* call) {
    if (result != VK_SUCCESS) throw std::runtime_error(std::string(call) + " gave " + std::to_string(result));
}

// Splits a list of names as XR_KHR_vulkan_enable returns it: separated by spaces.
std::vector<std::string> words_of(const char* call, const Application& app) {
    const auto get = app.function<PFN_xrGetVulkanInstanceExtensionsKHR>(call);
    uint32_t count = 0;
    check(get(app.instance, app.system, 0, &count, nullptr), call);
    std::string text(count, 0);
    check(get(app.instance, app.system, count, &count, text.data()), call);
    std::istringstream words(text.c_str());
    return {std::istream_iterator<std::string>(words), {}};
}

std::vector<const char*> pointers_to(const std::vector<std::string>& words) {
    std::vector<const char*> pointers;
    for (const std::string& word : words) pointers.push_back(word.c_str());
    return pointers;
}

}  // namespace

bool Application::has(const char* extension) const {
    return std::find(extensions.begin(), extensions.end(), std::string(extension)) != extensions.end();
}

void Application::ask_requirements() const {
    const char* call = has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME) ? "xrGetVulkanGraphicsRequirements2KHR"
                                                                 : "xrGetVulkanGraphicsRequirementsKHR";
    XrGraphicsRequirementsVulkanKHR needs = {XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN_KHR};
    check(function<PFN_xrGetVulkanGraphicsRequirementsKHR>(call)(instance, system, &needs), call);
}

void Application::make_vulkan_instance() {
    VkApplicationInfo application = {VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.apiVersion = VK_API_VERSION_1_1;
    VkInstanceCreateInfo vulkan = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    vulkan.pApplicationInfo = &application;
    VkResult result = VK_SUCCESS;
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) {
        const XrVulkanInstanceCreateInfoKHR info = {
            XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, nullptr, system, 0, vkGetInstanceProcAddr, &vulkan, nullptr};
        const char* call = "xrCreateVulkanInstanceKHR";
        check(function<PFN_xrCreateVulkanInstanceKHR>(call)(instance, &info, &binding.instance, &result), call);
    } else {
        const auto names = words_of("xrGetVulkanInstanceExtensionsKHR", *this);
        const auto pointers = pointers_to(names);
        vulkan.enabledExtensionCount = static_cast<uint32_t>(pointers.size());
        vulkan.ppEnabledExtensionNames = pointers.data();
        result = vkCreateInstance(&vulkan, nullptr, &binding.instance);
    }
    check_vulkan(result, "vkCreateInstance");
    volkLoadInstance(binding.instance);
}

void Application::find_physical_device() {
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) {
        const XrVulkanGraphicsDeviceGetInfoKHR info = {XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, nullptr, system,
                                                       binding.instance};
        const char* call = "xrGetVulkanGraphicsDevice2KHR";
        check(function<PFN_xrGetVulkanGraphicsDevice2KHR>(call)(instance, &info, &binding.physicalDevice), call);
    } else {
        const char* call = "xrGetVulkanGraphicsDeviceKHR";
        check(function<PFN_xrGetVulkanGraphicsDeviceKHR>(call)(instance, system, binding.instance,
                                                               &binding.physicalDevice),
              call);
    }
}

void Application::make_vulkan_device() {
    const float priority = 1;
    // The first queue family can draw on all known devices.
    VkDeviceQueueCreateInfo queue = {VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo vulkan = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    vulkan.queueCreateInfoCount = 1;
    vulkan.pQueueCreateInfos = &queue;
    VkResult result = VK_SUCCESS;
    if (has(XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME)) {
        const XrVulkanDeviceCreateInfoKHR info = {XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR,
                                                  nullptr,
                                                  system,
                                                  0,
                                                  vkGetInstanceProcAddr,
                                                  binding.physicalDevice,
                                                  &vulkan,
                                                  nullptr};
        const char* call = "xrCreateVulkanDeviceKHR";
        check(function<PFN_xrCreateVulkanDeviceKHR>(call)(instance, &info, &binding.device, &result), call);
    } else {
        const auto names = words_of("xrGetVulkanDeviceExtensionsKHR", *this);
        const auto pointers = pointers_to(names);
        vulkan.enabledExtensionCount = static_cast<uint32_t>(pointers.size());
        vulkan.ppEnabledExtensionNames = pointers.data();
        result = vkCreateDevice(binding.physicalDevice, &vulkan, nullptr, &binding.device);
    }
    check_vulkan(result, "vkCreateDevice");
}

void Application::make_device() {
    if (binding.device) return;
    make_instance();
    check_vulkan(volkInitialize(), "volkInitialize");
    ask_requirements();
    make_vulkan_instance();
    find_physical_device();
    make_vulkan_device();
}

void Application::destroy_device() {
    if (binding.device) vkDestroyDevice(binding.device, nullptr);
    if (binding.instance) vkDestroyInstance(binding.instance, nullptr);
    binding = {XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR};
}

}  // namespace neuvv::test
