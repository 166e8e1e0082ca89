#include "xr_runtime_test/application.h"

#include <cstdlib>
#include <cstring>

namespace neuvv::test {

namespace {

constexpr int32_t kSide = 32;

template <typename T>
const XrCompositionLayerBaseHeader* header(const T& layer) {
    return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer);
}

}  // namespace

void check(XrResult result, const char* call) {
    if (XR_FAILED(result)) throw std::runtime_error(std::string(call) + " gave " + std::to_string(result));
}

Application::Application()
    : script{{"width", kSide}, {"height", kSide}},
      extensions{XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME, XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME} {}

Application::~Application() {
    end();
}

// --- The instance ---

void Application::set_environment() {
    write_text(folder_.path / "script.json", script.dump());
    setenv("NEUVV_XR_SCRIPT", (folder_.path / "script.json").c_str(), 1);
    setenv("NEUVV_XR_OUT", folder_.path.c_str(), 1);
    setenv("XR_RUNTIME_JSON", NEUVV_XR_RUNTIME, 1);
    setenv("XR_LOADER_DEBUG", "none", 1);
}

XrInstanceCreateInfo Application::instance_info() const {
    XrInstanceCreateInfo info = {XR_TYPE_INSTANCE_CREATE_INFO};
    std::strcpy(info.applicationInfo.applicationName, "xr_runtime_test");
    info.applicationInfo.apiVersion = XR_MAKE_VERSION(1, 0, 0);
    info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
    info.enabledExtensionNames = extensions.data();
    return info;
}

void Application::make_instance() {
    if (instance) return;
    set_environment();
    const XrInstanceCreateInfo info = instance_info();
    check(xrCreateInstance(&info, &instance), "xrCreateInstance");
    const XrSystemGetInfo wanted = {XR_TYPE_SYSTEM_GET_INFO, nullptr, XR_FORM_FACTOR_HEAD_MOUNTED_DISPLAY};
    check(xrGetSystem(instance, &wanted, &system), "xrGetSystem");
}

// --- The session ---

XrSessionCreateInfo Application::session_info() const {
    return {XR_TYPE_SESSION_CREATE_INFO, &binding, 0, system};
}

XrReferenceSpaceCreateInfo Application::space_info(XrReferenceSpaceType type) {
    return {XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, type, {{0, 0, 0, 1}, {0, 0, 0}}};
}

XrSwapchainCreateInfo Application::swapchain_info(VkFormat format, uint32_t layers) const {
    const bool is_depth = format == VK_FORMAT_D32_SFLOAT;
    XrSwapchainCreateInfo info = {XR_TYPE_SWAPCHAIN_CREATE_INFO};
    info.usageFlags =
        is_depth ? XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT;
    info.format = format;
    info.sampleCount = info.faceCount = info.mipCount = 1;
    info.width = info.height = kSide;
    info.arraySize = layers;
    return info;
}

void Application::make_session() {
    if (session) return;
    make_device();
    const XrSessionCreateInfo info = session_info();
    check(xrCreateSession(instance, &info, &session), "xrCreateSession");
    const XrReferenceSpaceCreateInfo local = space_info();
    check(xrCreateReferenceSpace(session, &local, &space), "xrCreateReferenceSpace");
    const XrSwapchainCreateInfo colour_info = swapchain_info(VK_FORMAT_R8G8B8A8_SRGB, 2);
    const XrSwapchainCreateInfo depth_info = swapchain_info(VK_FORMAT_D32_SFLOAT, 2);
    const XrSwapchainCreateInfo panel_info = swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    check(xrCreateSwapchain(session, &colour_info, &colour), "xrCreateSwapchain");
    check(xrCreateSwapchain(session, &depth_info, &depth), "xrCreateSwapchain");
    check(xrCreateSwapchain(session, &panel_info, &panel), "xrCreateSwapchain");
}

void Application::poll_events() {
    XrEventDataBuffer event = {XR_TYPE_EVENT_DATA_BUFFER};
    while (xrPollEvent(instance, &event) == XR_SUCCESS) {
        events.push_back(event);
        if (event.type == XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED)
            states.push_back(reinterpret_cast<const XrEventDataSessionStateChanged&>(event).state);
        event = {XR_TYPE_EVENT_DATA_BUFFER};
    }
}

void Application::begin_session() {
    if (is_running_) return;
    make_session();
    poll_events();
    const XrSessionBeginInfo info = {XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    check(xrBeginSession(session, &info), "xrBeginSession");
    is_running_ = true;
}

void Application::leave_session() {
    is_running_ = false;
    xrRequestExitSession(session);
    poll_events();
    if (!states.empty() && states.back() == XR_SESSION_STATE_STOPPING) xrEndSession(session);
    poll_events();
}

void Application::destroy_session() {
    if (is_running_) leave_session();
    if (session) xrDestroySession(session);
    session = XR_NULL_HANDLE;
}

nlohmann::json Application::end() {
    destroy_session();
    destroy_device();
    if (instance) xrDestroyInstance(instance);
    instance = XR_NULL_HANDLE;
    action_set = XR_NULL_HANDLE;
    return nlohmann::json::parse(read_text(folder_.path / "report.json"), nullptr, false);
}

// --- Frames ---

void Application::draw_to(XrSwapchain swapchain) {
    uint32_t index = 0;
    check(xrAcquireSwapchainImage(swapchain, nullptr, &index), "xrAcquireSwapchainImage");
    const XrSwapchainImageWaitInfo wait = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
    check(xrWaitSwapchainImage(swapchain, &wait), "xrWaitSwapchainImage");
    check(xrReleaseSwapchainImage(swapchain, nullptr), "xrReleaseSwapchainImage");
}

XrViewLocateInfo Application::locate_info(XrTime time) const {
    return {XR_TYPE_VIEW_LOCATE_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, time, space};
}

XrResult Application::locate_views(XrTime time) {
    const XrViewLocateInfo info = locate_info(time);
    XrViewState state = {XR_TYPE_VIEW_STATE};
    uint32_t count = 0;
    frame.views.fill({XR_TYPE_VIEW});
    return xrLocateViews(session, &info, &state, 2, &count, frame.views.data());
}

void Application::fill_layers() {
    const XrRect2Di whole = {{0, 0}, {kSide, kSide}};
    for (uint32_t eye = 0; eye < 2; ++eye) {
        frame.depth[eye] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR, nullptr, {depth, whole, eye}, 0, 1, 0.1f, 100};
        frame.eyes[eye] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW,
                           &frame.depth[eye],
                           frame.views[eye].pose,
                           frame.views[eye].fov,
                           {colour, whole, eye}};
    }
    frame.projection = {XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, space, 2, frame.eyes.data()};
    frame.quad = {XR_TYPE_COMPOSITION_LAYER_QUAD, nullptr,     0, space, XR_EYE_VISIBILITY_BOTH, {panel, whole, 0},
                  {{0, 0, 0, 1}, {0, 0, -1}},     {0.4f, 0.3f}};
    frame.layers = {header(frame.projection), header(frame.quad)};
}

void Application::prepare_frame() {
    poll_events();
    frame.state = {XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(session, nullptr, &frame.state), "xrWaitFrame");
    check(xrBeginFrame(session, nullptr), "xrBeginFrame");
    frame.layers.clear();
    if (frame.state.shouldRender) {
        check(locate_views(frame.state.predictedDisplayTime), "xrLocateViews");
        for (XrSwapchain swapchain : {colour, depth, panel}) draw_to(swapchain);
        fill_layers();
    }
    frame.end = {XR_TYPE_FRAME_END_INFO,
                 nullptr,
                 frame.state.predictedDisplayTime,
                 XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
                 static_cast<uint32_t>(frame.layers.size()),
                 frame.layers.data()};
}

XrResult Application::end_frame() {
    return xrEndFrame(session, &frame.end);
}

void Application::prepare_visible_frame() {
    begin_session();
    prepare_frame();
    while (!frame.state.shouldRender) {
        check(end_frame(), "xrEndFrame");
        prepare_frame();
    }
}

void Application::make_focused() {
    prepare_visible_frame();
    check(end_frame(), "xrEndFrame");
    poll_events();
}

// --- Actions ---

XrPath Application::path(const char* text) const {
    XrPath path = XR_NULL_PATH;
    check(xrStringToPath(instance, text, &path), "xrStringToPath");
    return path;
}

XrActionCreateInfo Application::action_info(const char* name, XrActionType type) const {
    XrActionCreateInfo info = {XR_TYPE_ACTION_CREATE_INFO};
    std::strcpy(info.actionName, name);
    std::strcpy(info.localizedActionName, name);
    info.actionType = type;
    info.countSubactionPaths = 2;
    info.subactionPaths = hands.data();
    return info;
}

void Application::make_actions() {
    if (action_set) return;
    make_instance();
    hands = {path("/user/hand/left"), path("/user/hand/right")};
    XrActionSetCreateInfo set = {XR_TYPE_ACTION_SET_CREATE_INFO};
    std::strcpy(set.actionSetName, "main");
    std::strcpy(set.localizedActionSetName, "Main");
    check(xrCreateActionSet(instance, &set, &action_set), "xrCreateActionSet");
    const XrActionCreateInfo button = action_info("press", XR_ACTION_TYPE_BOOLEAN_INPUT);
    const XrActionCreateInfo pose = action_info("grip", XR_ACTION_TYPE_POSE_INPUT);
    const XrActionCreateInfo vibration = action_info("buzz", XR_ACTION_TYPE_VIBRATION_OUTPUT);
    check(xrCreateAction(action_set, &button, &press), "xrCreateAction");
    check(xrCreateAction(action_set, &pose, &grip), "xrCreateAction");
    check(xrCreateAction(action_set, &vibration, &buzz), "xrCreateAction");
}

void Application::suggest_bindings() {
    make_actions();
    const XrActionSuggestedBinding bindings[] = {{press, path("/user/hand/right/input/trigger/value")},
                                                 {grip, path("/user/hand/right/input/grip/pose")},
                                                 {buzz, path("/user/hand/right/output/haptic")}};
    const XrInteractionProfileSuggestedBinding info = {XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, nullptr,
                                                       path("/interaction_profiles/oculus/touch_controller"), 3,
                                                       bindings};
    check(xrSuggestInteractionProfileBindings(instance, &info), "xrSuggestInteractionProfileBindings");
}

void Application::attach_actions() {
    make_session();
    suggest_bindings();
    const XrSessionActionSetsAttachInfo info = {XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, nullptr, 1, &action_set};
    check(xrAttachSessionActionSets(session, &info), "xrAttachSessionActionSets");
}

XrResult Application::sync_actions() {
    const XrActiveActionSet active = {action_set, XR_NULL_PATH};
    const XrActionsSyncInfo info = {XR_TYPE_ACTIONS_SYNC_INFO, nullptr, 1, &active};
    return xrSyncActions(session, &info);
}

}  // namespace neuvv::test
