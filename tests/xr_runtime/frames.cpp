// The frame loop: xrWaitFrame, xrBeginFrame, xrEndFrame.
#include <chrono>

#include "call.h"
#include "images.h"
#include "layers.h"
#include "session.h"

namespace neuvv::xr_runtime {

namespace {

constexpr XrTime kFirstDisplayTime = 1'000'000'000;
constexpr int64_t kFramesWithoutPoll = 100;
constexpr std::chrono::seconds kTimeout(20);  // for an application that calls xrWaitFrame twice without xrBeginFrame

XrTime clock_now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Session& running_session(XrSession handle) {
    Session& session = object<Session>(handle);
    require(session.is_running, XR_ERROR_SESSION_NOT_RUNNING, "session-state",
            "the frame loop is for sessions between xrBeginSession and xrEndSession");
    return session;
}

void check_events_polled(Instance& instance) {
    const int64_t frame = runtime().progress.frame();
    if (frame - instance.last_poll_frame <= kFramesWithoutPoll) return;
    violate("events", fmt::format("no xrPollEvent for more than {} frames", kFramesWithoutPoll));
    instance.last_poll_frame = frame;
}

// The specification: "xrWaitFrame must block until the previous frame has been begun". An application that waits and
// begins on one thread would wait for itself for ever.
void wait_until_begun(const std::shared_ptr<Session>& session) {
    if (!session->waited) return;
    const auto self = std::this_thread::get_id();
    const bool is_alone = session->waiter == self && session->beginner == self;
    auto is_begun = [&] { return !session->waited || session->is_lost; };
    if (is_alone || !runtime().frame_begun.wait_for(current_call()->lock, kTimeout, is_begun))
        refuse(XR_ERROR_RUNTIME_FAILURE, "frame-order",
               "xrWaitFrame twice without xrBeginFrame between: on other runtimes this blocks for ever");
    refuse_if_lost(*session);
}

// Where the script's "time" is "real", waits until the next period of the display; missed periods are skipped.
void throttle(const std::shared_ptr<Session>& session) {
    Progress& progress = runtime().progress;
    if (!runtime().script.is_real_time) return;
    const XrDuration period = progress.period();
    const XrTime time = clock_now();
    XrTime wake = progress.last_wake + period;
    if (wake < time) wake += (time - wake + period - 1) / period * period;
    progress.last_wake = wake;
    auto& lock = current_call()->lock;
    lock.unlock();
    std::this_thread::sleep_for(std::chrono::nanoseconds(wake - time));
    lock.lock();
    refuse_if_lost(*session);
}

XrTime next_display_time() {
    const Progress& progress = runtime().progress;
    const XrDuration period = progress.period();
    const bool is_slow = progress.frame() + 1 <= progress.slow_until;
    const int64_t periods = is_slow ? progress.slow_periods : 1;
    if (progress.display_times.empty())
        return runtime().script.is_real_time ? progress.last_wake + period : kFirstDisplayTime;
    if (runtime().script.is_real_time)
        return std::max(progress.last_wake + periods * period, progress.display_times.back() + 1);
    return progress.display_times.back() + periods * period;
}

XrResult wait_frame(XrSession handle, const XrFrameWaitInfo* info, XrFrameState* out) {
    running_session(handle);
    check_optional(info);
    XrFrameState& state = checked(out);
    const std::shared_ptr<Session> session = shared<Session>(handle);
    wait_until_begun(session);
    throttle(session);
    if (!session->is_running) decline(XR_ERROR_SESSION_NOT_RUNNING);

    Progress& progress = runtime().progress;
    progress.display_times.push_back(next_display_time());
    Report& report = runtime().report;
    report.frames = progress.frame() + 1;
    check_events_polled(*session->instance);
    play_events(*session, progress.frame());
    Frame frame = {progress.frame(), progress.display_times.back(), false, 0, false};
    frame.should_render = session->state == XR_SESSION_STATE_VISIBLE || session->state == XR_SESSION_STATE_FOCUSED;
    session->waited = frame;
    session->waiter = std::this_thread::get_id();
    state.predictedDisplayTime = frame.display_time;
    state.predictedDisplayPeriod = progress.period();
    state.shouldRender = frame.should_render ? XR_TRUE : XR_FALSE;
    return XR_SUCCESS;
}

XrResult begin_frame(XrSession handle, const XrFrameBeginInfo* info) {
    Session& session = running_session(handle);
    check_optional(info);
    require(session.waited.has_value(), XR_ERROR_CALL_ORDER_INVALID, "frame-order",
            "xrBeginFrame without an xrWaitFrame of its own");
    const bool is_discarding = session.begun.has_value();
    if (is_discarding) warn("frame-order", "xrBeginFrame twice without xrEndFrame: the first frame is discarded");
    session.begun = session.waited;
    session.waited.reset();
    session.beginner = std::this_thread::get_id();
    runtime().frame_begun.notify_all();
    return is_discarding ? XR_FRAME_DISCARDED : XR_SUCCESS;
}

void check_end_info(const XrFrameEndInfo& info, const Frame& frame) {
    check_time(info.displayTime);
    if (info.displayTime != frame.display_time)
        violate("display-time", fmt::format("XrFrameEndInfo.displayTime {} is not the frame's predictedDisplayTime {}",
                                            info.displayTime, frame.display_time));
    const auto& modes = runtime().script.blend_modes;
    require(std::find(modes.begin(), modes.end(), info.environmentBlendMode) != modes.end(),
            XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED, "blend-mode",
            "xrEnumerateEnvironmentBlendModes does not name this environmentBlendMode");
    if (info.layerCount && !frame.should_render)
        warn("should-render", "layers were submitted for a frame whose shouldRender is false");
}

bool is_saved(int64_t frame) {
    const Runtime& state = runtime();
    if (state.report.folder.empty()) return false;
    return state.script.save_frames.contains(frame) ||
           (state.script.save_every > 0 && frame % state.script.save_every == 0);
}

void keep_images(const Session& session, const Frame& frame, const std::vector<Layer>& layers,
                 XrEnvironmentBlendMode blend) {
    SavedLayers saved = {frame.index, {}, false, frame.display_time, 0, {0, 0}, blend_name(blend), {}};
    for (const Layer& layer : layers) {
        saved.types.push_back(layer.is_quad() ? "quad" : layer.is_projection() ? "projection" : "passthrough");
        saved.has_depth = saved.has_depth || layer.has_depth();
        if (!layer.is_projection()) continue;
        saved.format = layer.views[0].colour.swapchain->info.format;
        saved.size = layer.views[0].colour.rect.extent;
        saved.fov = layer.fov;
    }
    runtime().report.layers.push_back(saved);
    save_images(session.vulkan, frame, layers, blend);
    runtime().report.write();
}

void mark_shown(const std::vector<Layer>& layers) {
    auto mark = [](const SubImage& image) { image.swapchain->shown_count = image.swapchain->released_count; };
    for (const Layer& layer : layers) {
        if (layer.is_quad()) mark(layer.image);
        for (const ProjectionView& view : layer.views) {
            if (view.colour.swapchain) mark(view.colour);
            if (view.depth) mark(*view.depth);
        }
    }
}

// With its first frame a session goes from READY to SYNCHRONIZED, and with each later frame one state further.
void approach_target(Session& session) {
    if (session.state == XR_SESSION_STATE_READY)
        enter_state(session, XR_SESSION_STATE_SYNCHRONIZED);
    else if (session.state < session.target && session.state >= XR_SESSION_STATE_SYNCHRONIZED)
        enter_state(session, static_cast<XrSessionState>(session.state + 1));
}

XrResult end_frame(XrSession handle, const XrFrameEndInfo* end_info) {
    Session& session = running_session(handle);
    const XrFrameEndInfo& info = checked(end_info);
    require(session.begun.has_value(), XR_ERROR_CALL_ORDER_INVALID, "frame-order", "xrEndFrame without xrBeginFrame");
    const Frame frame = *session.begun;
    check_end_info(info, frame);
    const std::vector<Layer> layers = checked_layers(info, session, frame);
    mark_shown(layers);
    if (!layers.empty()) ++runtime().report.frames_with_layers;
    if (is_saved(frame.index)) keep_images(session, frame, layers, info.environmentBlendMode);
    session.begun.reset();
    ++session.ended_frames;
    approach_target(session);
    return XR_SUCCESS;
}

}  // namespace

XrTime now() {
    const Runtime& state = runtime();
    if (state.script.is_real_time) return clock_now();
    const auto& times = state.progress.display_times;
    return (times.empty() ? kFirstDisplayTime : times.back()) - state.progress.period();
}

double frame_at(XrTime time) {
    const auto& times = runtime().progress.display_times;
    const auto period = static_cast<double>(runtime().progress.period());
    if (times.empty()) return 0;
    if (time >= times.back())
        return static_cast<double>(times.size() - 1) + static_cast<double>(time - times.back()) / period;
    if (time <= times.front()) return static_cast<double>(time - times.front()) / period;
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    const XrTime begin = *(after - 1), end = *after;
    return static_cast<double>(after - 1 - times.begin()) +
           static_cast<double>(time - begin) / static_cast<double>(end - begin);
}

std::vector<EntryPoint> frame_entries() {
    return {NEUVV_XR_ENTRY(xrWaitFrame, wait_frame), NEUVV_XR_ENTRY(xrBeginFrame, begin_frame),
            NEUVV_XR_ENTRY(xrEndFrame, end_frame)};
}

}  // namespace neuvv::xr_runtime
