// Violations in the setup of system and Vulkan device. (The loader itself answers errors in XrInstanceCreateInfo.)
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

XrResult get_system(Application& app, XrFormFactor form) {
    app.make_instance();
    const XrSystemGetInfo info = {XR_TYPE_SYSTEM_GET_INFO, nullptr, form};
    return xrGetSystem(app.instance, &info, &app.system);
}

XrResult properties_of_another_system(Application& app) {
    app.make_instance();
    XrSystemProperties properties = {XR_TYPE_SYSTEM_PROPERTIES};
    return xrGetSystemProperties(app.instance, app.system + 1, &properties);
}

XrResult enumerate_views(Application& app, XrViewConfigurationType type) {
    app.make_instance();
    uint32_t count = 0;
    return xrEnumerateViewConfigurationViews(app.instance, app.system, type, 0, &count, nullptr);
}

XrResult poll_into_untyped_buffer(Application& app) {
    app.make_session();
    XrEventDataBuffer event = {};
    return xrPollEvent(app.instance, &event);
}

// --- Vulkan ---

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_nothing(VkInstance, const char*) {
    return nullptr;
}

XrResult create_vulkan_instance(Application& app, XrVulkanInstanceCreateFlagsKHR flags,
                                PFN_vkGetInstanceProcAddr loader) {
    const VkInstanceCreateInfo vulkan = {VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    const XrVulkanInstanceCreateInfoKHR info = {
        XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, nullptr, app.system, flags, loader, &vulkan, nullptr};
    VkInstance made = VK_NULL_HANDLE;
    VkResult made_result = VK_SUCCESS;
    const XrResult result = app.function<PFN_xrCreateVulkanInstanceKHR>("xrCreateVulkanInstanceKHR")(
        app.instance, &info, &made, &made_result);
    if (made) {
        volkLoadInstance(made);
        vkDestroyInstance(made, nullptr);
    }
    return result;
}

XrResult vulkan_before_requirements(Application& app) {
    app.make_instance();
    volkInitialize();
    return create_vulkan_instance(app, 0, vkGetInstanceProcAddr);
}

XrResult vulkan_with_flags(Application& app) {
    app.make_device();
    return create_vulkan_instance(app, 1, vkGetInstanceProcAddr);
}

XrResult vulkan_without_functions(Application& app) {
    app.make_device();
    return create_vulkan_instance(app, 0, find_nothing);
}

XrResult physical_device_of_own_instance(Application& app) {
    app.make_device();
    const XrVulkanGraphicsDeviceGetInfoKHR info = {XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, nullptr, app.system,
                                                   reinterpret_cast<VkInstance>(1)};
    VkPhysicalDevice device = VK_NULL_HANDLE;
    return app.function<PFN_xrGetVulkanGraphicsDevice2KHR>("xrGetVulkanGraphicsDevice2KHR")(app.instance, &info,
                                                                                            &device);
}

XrResult device_of_another_physical_device(Application& app) {
    app.make_device();
    const VkDeviceCreateInfo vulkan = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    const XrVulkanDeviceCreateInfoKHR info = {
        XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR, nullptr, app.system, 0, vkGetInstanceProcAddr,
        reinterpret_cast<VkPhysicalDevice>(1), &vulkan, nullptr};
    VkDevice device = VK_NULL_HANDLE;
    VkResult result = VK_SUCCESS;
    return app.function<PFN_xrCreateVulkanDeviceKHR>("xrCreateVulkanDeviceKHR")(app.instance, &info, &device, &result);
}

// --- Sessions ---

XrResult create_session(Application& app, const XrSessionCreateInfo& info) {
    return xrCreateSession(app.instance, &info, &app.session);
}

XrResult session_before_requirements(Application& app) {
    app.make_instance();
    return create_session(app, app.session_info());
}

XrResult session_without_binding(Application& app) {
    app.make_device();
    XrSessionCreateInfo info = app.session_info();
    info.next = nullptr;
    return create_session(app, info);
}

XrResult session_with_flags(Application& app) {
    app.make_device();
    XrSessionCreateInfo info = app.session_info();
    info.createFlags = 1;
    return create_session(app, info);
}

template <auto kMember>
XrResult session_with_another(Application& app) {
    app.make_device();
    XrGraphicsBindingVulkanKHR other = app.binding;
    using Handle = std::remove_reference_t<decltype(other.*kMember)>;
    other.*kMember = reinterpret_cast<Handle>(1);
    XrSessionCreateInfo info = app.session_info();
    info.next = &other;
    return create_session(app, info);
}

XrResult session_with_nothing_made(Application& app) {
    app.make_device();
    const XrGraphicsBindingVulkanKHR nothing = {XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR};
    XrSessionCreateInfo info = app.session_info();
    info.next = &nothing;
    return create_session(app, info);
}

}  // namespace

std::vector<Violation> setup_violations() {
    using App = Application;
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE, no_device = XR_ERROR_GRAPHICS_DEVICE_INVALID;
    const Severity warning = Severity::kWarning;
    return {
        {"UnknownFormFactor", "enum", "xrGetSystem", invalid,
         [](App& app) { return get_system(app, XrFormFactor(77)); }},
        {"AnotherSystem", "system", "xrGetSystemProperties", XR_ERROR_SYSTEM_INVALID, properties_of_another_system},
        {"MonoViews", "view-configuration", "xrEnumerateViewConfigurationViews",
         XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED,
         [](App& app) { return enumerate_views(app, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO); }},
        {"UnknownViews", "view-configuration", "xrEnumerateViewConfigurationViews", invalid,
         [](App& app) { return enumerate_views(app, XrViewConfigurationType(77)); }},
        {"UntypedEvent", "type", "xrPollEvent", invalid, poll_into_untyped_buffer},
        {"VulkanBeforeRequirements", "graphics-requirements", "xrCreateVulkanInstanceKHR", XR_SUCCESS,
         vulkan_before_requirements, warning},
        {"VulkanWithFlags", "flags", "xrCreateVulkanInstanceKHR", invalid, vulkan_with_flags},
        {"VulkanWithoutFunctions", "runtime", "xrCreateVulkanInstanceKHR", XR_ERROR_RUNTIME_FAILURE,
         vulkan_without_functions, warning},
        {"PhysicalDeviceOfOwnInstance", "graphics-device", "xrGetVulkanGraphicsDevice2KHR", invalid,
         physical_device_of_own_instance},
        {"DeviceOfAnotherPhysicalDevice", "graphics-device", "xrCreateVulkanDeviceKHR", XR_ERROR_HANDLE_INVALID,
         device_of_another_physical_device},
        {"SessionBeforeRequirements", "graphics-requirements", "xrCreateSession",
         XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING, session_before_requirements},
        {"SessionWithoutBinding", "graphics-device", "xrCreateSession", no_device, session_without_binding},
        {"SessionWithNothingMade", "graphics-device", "xrCreateSession", no_device, session_with_nothing_made},
        {"SessionWithOwnInstance", "graphics-device", "xrCreateSession", no_device,
         session_with_another<&XrGraphicsBindingVulkanKHR::instance>},
        {"SessionWithAnotherPhysicalDevice", "graphics-device", "xrCreateSession", no_device,
         session_with_another<&XrGraphicsBindingVulkanKHR::physicalDevice>},
        {"SessionWithOwnDevice", "graphics-device", "xrCreateSession", no_device,
         session_with_another<&XrGraphicsBindingVulkanKHR::device>},
        {"SessionWithFlags", "flags", "xrCreateSession", invalid, session_with_flags},
    };
}

}  // namespace neuvv::test
