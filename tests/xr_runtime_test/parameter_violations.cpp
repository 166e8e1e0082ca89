// Violations in parameters of single functions: output pointers, systems, flags, and types of optional structs.
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

using App = Application;

// --- Null output pointers ---

XrResult set_nowhere(App& app) {
    app.make_instance();
    const XrActionSetCreateInfo info = {XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "more", "More", 0};
    return xrCreateActionSet(app.instance, &info, nullptr);
}
XrResult action_nowhere(App& app) {
    app.make_actions();
    const XrActionCreateInfo info = app.action_info("another", XR_ACTION_TYPE_FLOAT_INPUT);
    return xrCreateAction(app.action_set, &info, nullptr);
}
XrResult session_nowhere(App& app) {
    app.make_device();
    const XrSessionCreateInfo info = app.session_info();
    return xrCreateSession(app.instance, &info, nullptr);
}
XrResult space_nowhere(App& app) {
    app.make_session();
    const XrReferenceSpaceCreateInfo info = App::space_info();
    return xrCreateReferenceSpace(app.session, &info, nullptr);
}
XrResult action_space_nowhere(App& app) {
    app.attach_actions();
    const XrActionSpaceCreateInfo info = {
        XR_TYPE_ACTION_SPACE_CREATE_INFO, nullptr, app.grip, XR_NULL_PATH, {{0, 0, 0, 1}, {0, 0, 0}}};
    return xrCreateActionSpace(app.session, &info, nullptr);
}
XrResult bounds_nowhere(App& app) {
    app.make_session();
    return xrGetReferenceSpaceBoundsRect(app.session, XR_REFERENCE_SPACE_TYPE_STAGE, nullptr);
}
XrResult swapchain_nowhere(App& app) {
    app.make_session();
    const XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    return xrCreateSwapchain(app.session, &info, nullptr);
}
XrResult image_nowhere(App& app) {
    app.make_session();
    return xrAcquireSwapchainImage(app.panel, nullptr, nullptr);
}
XrResult frame_nowhere(App& app) {
    app.begin_session();
    return xrWaitFrame(app.session, nullptr, nullptr);
}
XrResult event_nowhere(App& app) {
    app.make_instance();
    return xrPollEvent(app.instance, nullptr);
}
XrResult path_nowhere(App& app) {
    app.make_instance();
    return xrStringToPath(app.instance, "/user/head", nullptr);
}
XrResult path_of_nothing(App& app) {
    app.make_instance();
    XrPath path = XR_NULL_PATH;
    return xrStringToPath(app.instance, nullptr, &path);
}
XrResult bindings_from_nowhere(App& app) {
    app.make_actions();
    const XrInteractionProfileSuggestedBinding info = {XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                       app.path("/interaction_profiles/khr/simple_controller"), 1,
                                                       nullptr};
    return xrSuggestInteractionProfileBindings(app.instance, &info);
}
XrResult sets_from_nowhere(App& app) {
    app.make_session();
    const XrSessionActionSetsAttachInfo info = {XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, nullptr};
    return xrAttachSessionActionSets(app.session, &info);
}
XrResult active_sets_from_nowhere(App& app) {
    app.attach_actions();
    const XrActionsSyncInfo info = {XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, nullptr};
    return xrSyncActions(app.session, &info);
}

// --- Vulkan ---

XrResult ask_requirements(App& app, XrSystemId system) {
    app.make_instance();
    XrGraphicsRequirementsVulkanKHR needs = {XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN_KHR};
    return app.function<PFN_xrGetVulkanGraphicsRequirements2KHR>("xrGetVulkanGraphicsRequirements2KHR")(app.instance,
                                                                                                        system, &needs);
}
XrResult ask_another_system(App& app) {
    app.make_instance();
    return ask_requirements(app, app.system + 1);
}
// Before xrGetSystem has returned the system to this instance.
XrResult ask_system_too_early(App& app) {
    app.make_instance();
    const XrSystemId early = app.system;
    check(xrDestroyInstance(app.instance), "xrDestroyInstance");
    app.set_environment();
    const XrInstanceCreateInfo info = app.instance_info();
    check(xrCreateInstance(&info, &app.instance), "xrCreateInstance");
    return ask_requirements(app, early);
}

XrResult make_vulkan_device(App& app, XrVulkanDeviceCreateFlagsKHR flags, PFN_vkGetInstanceProcAddr loader) {
    const VkDeviceCreateInfo vulkan = {VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    const XrVulkanDeviceCreateInfoKHR info = {XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR,
                                              nullptr,
                                              app.system,
                                              flags,
                                              loader,
                                              app.binding.physicalDevice,
                                              &vulkan,
                                              nullptr};
    VkDevice device = VK_NULL_HANDLE;
    VkResult result = VK_SUCCESS;
    return app.function<PFN_xrCreateVulkanDeviceKHR>("xrCreateVulkanDeviceKHR")(app.instance, &info, &device, &result);
}
XrResult device_with_flags(App& app) {
    app.make_device();
    return make_vulkan_device(app, 1, vkGetInstanceProcAddr);
}
XrResult device_without_loader(App& app) {
    app.make_device();
    return make_vulkan_device(app, 0, nullptr);
}

// --- Optional structs of the wrong type ---

constexpr XrSwapchainImageWaitInfo kAnotherType = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};

XrResult wait_with_another_type(App& app) {
    app.begin_session();
    XrFrameState state = {XR_TYPE_FRAME_STATE};
    return xrWaitFrame(app.session, reinterpret_cast<const XrFrameWaitInfo*>(&kAnotherType), &state);
}
XrResult begin_with_another_type(App& app) {
    app.begin_session();
    XrFrameState state = {XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(app.session, nullptr, &state), "xrWaitFrame");
    return xrBeginFrame(app.session, reinterpret_cast<const XrFrameBeginInfo*>(&kAnotherType));
}
XrResult acquire_with_another_type(App& app) {
    app.make_session();
    uint32_t index = 0;
    return xrAcquireSwapchainImage(app.panel, reinterpret_cast<const XrSwapchainImageAcquireInfo*>(&kAnotherType),
                                   &index);
}
XrResult release_with_another_type(App& app) {
    app.make_session();
    return xrReleaseSwapchainImage(app.panel, reinterpret_cast<const XrSwapchainImageReleaseInfo*>(&kAnotherType));
}

}  // namespace

std::vector<Violation> parameter_violations() {
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE;
    const char *requirements = "xrGetVulkanGraphicsRequirements2KHR", *device = "xrCreateVulkanDeviceKHR";
    return {
        {"ActionSetNowhere", "null", "xrCreateActionSet", invalid, set_nowhere},
        {"ActionNowhere", "null", "xrCreateAction", invalid, action_nowhere},
        {"SessionNowhere", "null", "xrCreateSession", invalid, session_nowhere},
        {"SpaceNowhere", "null", "xrCreateReferenceSpace", invalid, space_nowhere},
        {"ActionSpaceNowhere", "null", "xrCreateActionSpace", invalid, action_space_nowhere},
        {"BoundsNowhere", "null", "xrGetReferenceSpaceBoundsRect", invalid, bounds_nowhere},
        {"SwapchainNowhere", "null", "xrCreateSwapchain", invalid, swapchain_nowhere},
        {"ImageNowhere", "null", "xrAcquireSwapchainImage", invalid, image_nowhere},
        {"FrameNowhere", "null", "xrWaitFrame", invalid, frame_nowhere},
        {"EventNowhere", "null", "xrPollEvent", invalid, event_nowhere},
        {"PathNowhere", "null", "xrStringToPath", invalid, path_nowhere},
        {"PathOfNothing", "null", "xrStringToPath", invalid, path_of_nothing},
        {"BindingsFromNowhere", "null", "xrSuggestInteractionProfileBindings", invalid, bindings_from_nowhere},
        {"ActionSetsFromNowhere", "null", "xrAttachSessionActionSets", invalid, sets_from_nowhere},
        {"ActiveSetsFromNowhere", "null", "xrSyncActions", invalid, active_sets_from_nowhere},
        {"AnotherSystem", "system", requirements, XR_ERROR_SYSTEM_INVALID, ask_another_system},
        {"SystemTooEarly", "system", requirements, XR_ERROR_SYSTEM_INVALID, ask_system_too_early},
        {"DeviceWithFlags", "flags", device, invalid, device_with_flags},
        {"DeviceWithoutLoader", "null", device, invalid, device_without_loader},
        {"WaitWithAnotherType", "type", "xrWaitFrame", invalid, wait_with_another_type},
        {"BeginWithAnotherType", "type", "xrBeginFrame", invalid, begin_with_another_type},
        {"AcquireWithAnotherType", "type", "xrAcquireSwapchainImage", invalid, acquire_with_another_type},
        {"ReleaseWithAnotherType", "type", "xrReleaseSwapchainImage", invalid, release_with_another_type},
    };
}

}  // namespace neuvv::test
