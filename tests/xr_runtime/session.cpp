#include "session.h"

#include <cstdlib>
#include <fstream>

#include "call.h"

namespace neuvv::xr_runtime {

namespace {

const char* short_name(XrSessionState state) {
    switch (state) {
        case XR_SESSION_STATE_IDLE:
            return "IDLE";
        case XR_SESSION_STATE_READY:
            return "READY";
        case XR_SESSION_STATE_SYNCHRONIZED:
            return "SYNCHRONIZED";
        case XR_SESSION_STATE_VISIBLE:
            return "VISIBLE";
        case XR_SESSION_STATE_FOCUSED:
            return "FOCUSED";
        case XR_SESSION_STATE_STOPPING:
            return "STOPPING";
        case XR_SESSION_STATE_LOSS_PENDING:
            return "LOSS_PENDING";
        case XR_SESSION_STATE_EXITING:
            return "EXITING";
        default:
            return "UNKNOWN";
    }
}

// The device must be the one that the runtime named, and all calls must use the same one of the two extensions.
void check_binding(const Instance& instance, const XrGraphicsBindingVulkanKHR& binding) {
    require(instance.asked_requirements || instance.asked_requirements2, XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING,
            "graphics-requirements",
            "xrGetVulkanGraphicsRequirementsKHR (or 2KHR) must be called before xrCreateSession");
    const XrResult bad = XR_ERROR_GRAPHICS_DEVICE_INVALID;
    require(binding.instance && binding.physicalDevice && binding.device, bad, "graphics-device",
            "the graphics binding's VkInstance, VkPhysicalDevice and VkDevice must not be null");
    const auto given = instance.graphics_devices.find(binding.instance);
    require(given != instance.graphics_devices.end(), bad, "graphics-device",
            "xrGetVulkanGraphicsDevice(2)KHR was never asked for the binding's VkInstance");
    require(given->second == binding.physicalDevice, bad, "graphics-device",
            "the binding's VkPhysicalDevice is not what xrGetVulkanGraphicsDevice(2)KHR gave");
    if (!instance.asked_requirements2) return;
    require(instance.vulkan_instances.contains(binding.instance), bad, "graphics-device",
            "under XR_KHR_vulkan_enable2 the VkInstance must be made by xrCreateVulkanInstanceKHR");
    const auto device = instance.vulkan_devices.find(binding.device);
    require(device != instance.vulkan_devices.end(), bad, "graphics-device",
            "under XR_KHR_vulkan_enable2 the VkDevice must be made by xrCreateVulkanDeviceKHR");
    require(device->second == binding.physicalDevice, bad, "graphics-device",
            "the binding's VkDevice was made from another VkPhysicalDevice");
}

XrResult create_session(XrInstance handle, const XrSessionCreateInfo* create_info, XrSession* out) {
    Instance& instance = instance_of(handle);
    const XrSessionCreateInfo& info = checked(create_info);
    check_pointer(out, "session");
    require(info.createFlags == 0, XR_ERROR_VALIDATION_FAILURE, "flags", "XrSessionCreateInfo.createFlags must be 0");
    check_system(instance, info.systemId);
    const auto* binding = chained<XrGraphicsBindingVulkanKHR>(create_info);
    require(binding, XR_ERROR_GRAPHICS_DEVICE_INVALID, "graphics-device",
            "XrSessionCreateInfo needs an XrGraphicsBindingVulkanKHR in its next chain");
    check_binding(instance, *binding);
    if (runtime().session) decline(XR_ERROR_LIMIT_REACHED);

    auto session = make_object<Session>();
    session->instance = &instance;
    const auto known = instance.vulkan_instances.find(binding->instance);
    try {
        session->vulkan =
            open_device(known == instance.vulkan_instances.end() ? vulkan_loader() : known->second, *binding);
    } catch (...) {
        forget(bits(session->handle));
        throw;
    }
    runtime().session = session;
    *out = session->handle;
    enter_state(*session, XR_SESSION_STATE_IDLE);
    enter_state(*session, XR_SESSION_STATE_READY);
    return XR_SUCCESS;
}

XrResult destroy_session(XrSession handle) {
    const auto session = shared<Session>(handle);
    if (session->is_running && !session->is_lost)
        warn("session", "the session is destroyed while it runs, without xrEndSession");
    destroy_session_now(*session);
    runtime().report.write();
    return XR_SUCCESS;
}

XrResult begin_session(XrSession handle, const XrSessionBeginInfo* begin_info) {
    Session& session = object<Session>(handle);
    const XrSessionBeginInfo& info = checked(begin_info);
    require(!session.is_running, XR_ERROR_SESSION_RUNNING, "session-state", "the session runs already");
    require(session.state == XR_SESSION_STATE_READY, XR_ERROR_SESSION_NOT_READY, "session-state",
            fmt::format("xrBeginSession in the state {}; only READY allows it", short_name(session.state)));
    check_view_configuration(info.primaryViewConfigurationType);
    session.views = info.primaryViewConfigurationType;
    session.is_running = true;
    session.ended_frames = 0;
    session.target = XR_SESSION_STATE_FOCUSED;
    session.after_stop = AfterStop::kNothing;
    session.waited.reset();
    session.begun.reset();
    return XR_SUCCESS;
}

XrResult end_session(XrSession handle) {
    Session& session = object<Session>(handle);
    require(session.is_running, XR_ERROR_SESSION_NOT_RUNNING, "session-state", "the session does not run");
    require(session.state == XR_SESSION_STATE_STOPPING, XR_ERROR_SESSION_NOT_STOPPING, "session-state",
            fmt::format("xrEndSession in the state {}; only STOPPING allows it", short_name(session.state)));
    session.is_running = false;
    session.waited.reset();
    session.begun.reset();
    runtime().frame_begun.notify_all();
    enter_state(session, XR_SESSION_STATE_IDLE);
    if (session.after_stop == AfterStop::kExit) enter_state(session, XR_SESSION_STATE_EXITING);
    return XR_SUCCESS;
}

XrResult request_exit(XrSession handle) {
    Session& session = object<Session>(handle);
    require(session.is_running, XR_ERROR_SESSION_NOT_RUNNING, "session-state", "the session does not run");
    stop_session(session, AfterStop::kExit);
    return XR_SUCCESS;
}

// --- The script's events ---

void lose_instance(Instance& instance, const ScriptEvent& event) {
    XrEventDataInstanceLossPending pending = {XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING};
    pending.lossTime = now() + runtime().progress.period() * std::max<int64_t>(event.calls, 1);
    queue_event(instance, pending);
    instance.calls_until_loss = event.calls;
}

// Asks the layer of tests/support/layers/lose_device.cpp for it, with which the application runs.
void lose_device(const ScriptEvent& event) {
    if (const char* file = std::getenv("NEUVV_LOSE_DEVICE")) std::ofstream(file) << event.times;
}

// As the validation layers do, where the application asked for their messages.
void send_validation_message(const VulkanDevice& vulkan) {
    if (!vulkan.vkSubmitDebugUtilsMessageEXT) return;
    VkDebugUtilsMessengerCallbackDataEXT data = {VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT};
    data.pMessage = "a message of the script";
    vulkan.vkSubmitDebugUtilsMessageEXT(vulkan.instance, VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                                        VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT, &data);
}

// The new origin applies from a time at which the application has had the event.
void recentre(Session& session, const ScriptEvent& event) {
    Progress& progress = runtime().progress;
    const XrTime change = progress.display_times.back() + (event.silent ? 0 : 2 * progress.period());
    for (XrReferenceSpaceType space : event.spaces) {
        const auto& offered = runtime().script.spaces;
        if (std::find(offered.begin(), offered.end(), space) == offered.end()) continue;
        progress.recentres.push_back({change, space, event.shift});
        if (event.silent) continue;
        queue_event(*session.instance,
                    XrEventDataReferenceSpaceChangePending{
                        XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING, nullptr, session.handle, space, change,
                        XrBool32{event.says_shift ? 1u : 0u}, event.says_shift ? event.shift : kIdentityPose});
    }
}

void change_mask(Session& session) {
    ++runtime().progress.mask_version;
    if (!session.instance->has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME)) return;
    for (uint32_t view = 0; view < view_count(session.views); ++view)
        queue_event(*session.instance,
                    XrEventDataVisibilityMaskChangedKHR{XR_TYPE_EVENT_DATA_VISIBILITY_MASK_CHANGED_KHR, nullptr,
                                                        session.handle, session.views, view});
}

void lose_session(Session& session) {
    enter_state(session, XR_SESSION_STATE_LOSS_PENDING);
    session.is_lost = true;
    runtime().frame_begun.notify_all();
}

void play(Session& session, const ScriptEvent& event) {
    Progress& progress = runtime().progress;
    const int64_t frame = progress.frame();
    if (event.what == "visible") walk_to(session, XR_SESSION_STATE_VISIBLE);
    if (event.what == "synchronized") walk_to(session, XR_SESSION_STATE_SYNCHRONIZED);
    if (event.what == "focus") walk_to(session, XR_SESSION_STATE_FOCUSED);
    if (event.what == "stop") {
        session.restart_polls = event.wait_calls;
        stop_session(session, event.restart ? AfterStop::kRestart : AfterStop::kExit);
    }
    if (event.what == "exit") stop_session(session, AfterStop::kExit);
    if (event.what == "lose_session") lose_session(session);
    if (event.what == "lose_instance") lose_instance(*session.instance, event);
    if (event.what == "lose_device") lose_device(event);
    if (event.what == "validation_message") send_validation_message(session.vulkan);
    if (event.what == "recentre") recentre(session, event);
    if (event.what == "slow") {
        progress.slow_until = frame + event.frames;
        progress.slow_periods = event.periods;
    }
    if (event.what == "profile") progress.profile = event.profile;
    if (event.what == "presence" && session.instance->has(xr::kUserPresenceExtension))
        queue_event(*session.instance,
                    xr::XrEventDataUserPresenceChangedEXT{xr::kUserPresenceChanged, nullptr, session.handle,
                                                          XrBool32{event.worn ? 1u : 0u}});
    if (event.what == "passthrough_lost" && session.instance->has(XR_FB_PASSTHROUGH_EXTENSION_NAME)) {
        for (const auto& passthrough : all_of<Passthrough>()) passthrough->last_frame = frame;
        queue_event(*session.instance,
                    XrEventDataPassthroughStateChangedFB{XR_TYPE_EVENT_DATA_PASSTHROUGH_STATE_CHANGED_FB, nullptr,
                                                         XR_PASSTHROUGH_STATE_CHANGED_REINIT_REQUIRED_BIT_FB});
    }
    if (event.what == "mask_changed") change_mask(session);
    if (event.what == "refresh") set_refresh_rate(session, event.hz);
    if (event.what == "no_tracking") progress.untracked_until = frame + event.frames;
}

}  // namespace

void set_refresh_rate(Session& session, float hz) {
    float& current = runtime().progress.refresh_hz;
    if (hz == current) return;
    if (session.instance->has(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME))
        queue_event(*session.instance, XrEventDataDisplayRefreshRateChangedFB{
                                           XR_TYPE_EVENT_DATA_DISPLAY_REFRESH_RATE_CHANGED_FB, nullptr, current, hz});
    current = hz;
}

void enter_state(Session& session, XrSessionState state) {
    session.state = state;
    runtime().report.states.push_back(short_name(state));
    queue_event(*session.instance, XrEventDataSessionStateChanged{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr,
                                                                  session.handle, state, now()});
    runtime().report.write();
}

void walk_to(Session& session, XrSessionState state) {
    session.target = state;
    const bool can_walk = session.state >= XR_SESSION_STATE_SYNCHRONIZED && session.state <= XR_SESSION_STATE_FOCUSED;
    while (can_walk && session.state != state)
        enter_state(session, static_cast<XrSessionState>(session.state + (session.state < state ? 1 : -1)));
}

void stop_session(Session& session, AfterStop after) {
    if (session.state == XR_SESSION_STATE_STOPPING) return;
    session.after_stop = after;
    // From FOCUSED or VISIBLE it goes through SYNCHRONIZED; from READY, where walk_to() does nothing, it stops at once.
    walk_to(session, XR_SESSION_STATE_SYNCHRONIZED);
    enter_state(session, XR_SESSION_STATE_STOPPING);
}

void pass_idle_poll(Session& session) {
    const bool is_waiting = session.state == XR_SESSION_STATE_IDLE && session.after_stop == AfterStop::kRestart;
    if (!is_waiting || session.is_lost || session.restart_polls-- > 0) return;
    session.after_stop = AfterStop::kNothing;
    enter_state(session, XR_SESSION_STATE_READY);
}

// They die with their session, and the application can destroy them no more.
static void forget_body_trackers() {
    const auto fb = all_of<BodyTrackerFb>();
    const auto bd = all_of<BodyTrackerBd>();
    if (!fb.empty() || !bd.empty()) warn("session", "the session is destroyed before its body tracker");
    for (const auto& tracker : fb) forget(bits(tracker->handle));
    for (const auto& tracker : bd) forget(bits(tracker->handle));
}

void destroy_session_now(Session& session) {
    const auto keep = runtime().session;
    for (const auto& swapchain : all_of<Swapchain>()) {
        destroy_images(session.vulkan, swapchain->images);
        forget(bits(swapchain->handle));
    }
    for (const auto& space : all_of<Space>()) forget(bits(space->handle));
    for (const auto& tracker : all_of<HandTracker>()) forget(bits(tracker->handle));
    forget_body_trackers();
    for (const auto& layer : all_of<PassthroughLayer>()) forget(bits(layer->handle));
    for (const auto& passthrough : all_of<Passthrough>()) forget(bits(passthrough->handle));
    close_device(session.vulkan);
    session.is_lost = true;  // for threads that are waiting in an entry point
    runtime().frame_begun.notify_all();
    auto& events = session.instance->events;
    std::erase_if(
        events, [](const XrEventDataBuffer& event) { return event.type != XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING; });
    forget(bits(session.handle));
    runtime().session.reset();
}

void play_events(Session& session, int64_t frame) {
    const Script& script = runtime().script;
    Progress& progress = runtime().progress;
    while (progress.next_event < script.events.size() && script.events[progress.next_event].frame <= frame)
        play(session, script.events[progress.next_event++]);
    if (frame == script.end_frame && !session.is_lost) stop_session(session, AfterStop::kExit);
}

std::vector<EntryPoint> session_entries() {
    return {NEUVV_XR_ENTRY(xrCreateSession, create_session), NEUVV_XR_ENTRY(xrDestroySession, destroy_session),
            NEUVV_XR_ENTRY(xrBeginSession, begin_session), NEUVV_XR_ENTRY(xrEndSession, end_session),
            NEUVV_XR_ENTRY(xrRequestExitSession, request_exit)};
}

}  // namespace neuvv::xr_runtime
