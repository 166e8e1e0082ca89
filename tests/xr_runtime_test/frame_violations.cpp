// Violations in the frame loop: order, times, views.
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

XrResult begin_without_waiting(Application& app) {
    app.begin_session();
    return xrBeginFrame(app.session, nullptr);
}

XrResult end_frame_without_beginning(Application& app) {
    app.begin_session();
    app.prepare_frame();
    check(app.end_frame(), "xrEndFrame");
    return app.end_frame();
}

XrResult wait(Application& app) {
    app.frame.state = {XR_TYPE_FRAME_STATE};
    return xrWaitFrame(app.session, nullptr, &app.frame.state);
}

// Once the same thread has waited for a frame and begun it, the runtime knows that the application has one thread.
XrResult wait_for_frame_twice(Application& app) {
    app.make_focused();
    check(wait(app), "xrWaitFrame");
    return wait(app);
}

XrResult begin_frame_twice(Application& app) {
    app.begin_session();
    app.prepare_frame();
    check(wait(app), "xrWaitFrame");
    return xrBeginFrame(app.session, nullptr);
}

XrResult never_poll(Application& app) {
    app.begin_session();
    const XrFrameEndInfo empty = {XR_TYPE_FRAME_END_INFO, nullptr, 0, XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
    XrResult result = XR_SUCCESS;
    for (int i = 0; i < 102 && result == XR_SUCCESS; ++i) {
        result = wait(app);
        xrBeginFrame(app.session, nullptr);
        XrFrameEndInfo end = empty;
        end.displayTime = app.frame.state.predictedDisplayTime;
        xrEndFrame(app.session, &end);
    }
    return result;
}

XrResult end_at(Application& app, XrTime later) {
    app.prepare_visible_frame();
    app.frame.end.displayTime += later;
    return app.end_frame();
}

XrResult end_before_all_time(Application& app) {
    app.prepare_visible_frame();
    app.frame.end.displayTime = -1;
    return app.end_frame();
}

XrResult end_transparent(Application& app) {
    app.prepare_visible_frame();
    app.frame.end.environmentBlendMode = XR_ENVIRONMENT_BLEND_MODE_ALPHA_BLEND;
    return app.end_frame();
}

XrResult locate_before_all_time(Application& app) {
    app.make_session();
    return app.locate_views(0);
}

XrResult locate_for_another_time(Application& app) {
    app.begin_session();
    app.prepare_frame();
    return app.locate_views(app.frame.state.predictedDisplayTime + 1);
}

XrResult locate_twice(Application& app) {
    app.prepare_visible_frame();
    return app.locate_views(app.frame.state.predictedDisplayTime);
}

XrResult locate_mono(Application& app) {
    app.make_session();
    XrViewLocateInfo info = app.locate_info(1);
    info.viewConfigurationType = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_MONO;
    XrViewState state = {XR_TYPE_VIEW_STATE};
    uint32_t count = 0;
    return xrLocateViews(app.session, &info, &state, 0, &count, nullptr);
}

XrResult never_locate(Application& app) {
    app.prepare_visible_frame();
    check(app.end_frame(), "xrEndFrame");
    check(wait(app), "xrWaitFrame");
    check(xrBeginFrame(app.session, nullptr), "xrBeginFrame");
    app.frame.end.displayTime = app.frame.state.predictedDisplayTime;
    return app.end_frame();  // the head does not move, so the views are right
}

XrResult show_while_hidden(Application& app) {
    app.script["events"] = {{{"frame", 3}, {"do", "synchronized"}}};
    app.prepare_visible_frame();
    check(app.end_frame(), "xrEndFrame");
    const Frame shown = app.frame;
    app.prepare_frame();
    check(app.locate_views(app.frame.state.predictedDisplayTime), "xrLocateViews");
    app.frame.end.layerCount = static_cast<uint32_t>(shown.layers.size());
    app.frame.end.layers = shown.layers.data();
    return app.end_frame();
}

XrResult show_without_tracking(Application& app) {
    app.script["events"] = {{{"frame", 2}, {"do", "no_tracking"}}};
    app.prepare_visible_frame();
    app.frame.layers.resize(1);
    app.frame.end.layerCount = 1;
    return app.end_frame();
}

}  // namespace

std::vector<Violation> frame_violations() {
    using App = Application;
    const XrResult out_of_order = XR_ERROR_CALL_ORDER_INVALID;
    const Severity warning = Severity::kWarning;
    return {
        {"BegunWithoutWaiting", "frame-order", "xrBeginFrame", out_of_order, begin_without_waiting},
        {"EndedWithoutBeginning", "frame-order", "xrEndFrame", out_of_order, end_frame_without_beginning},
        {"WaitedForTwice", "frame-order", "xrWaitFrame", XR_ERROR_RUNTIME_FAILURE, wait_for_frame_twice},
        {"BegunTwice", "frame-order", "xrBeginFrame", XR_FRAME_DISCARDED, begin_frame_twice, warning},
        {"NeverPolled", "events", "xrWaitFrame", XR_SUCCESS, never_poll},
        {"EndedForAnotherTime", "display-time", "xrEndFrame", XR_SUCCESS, [](App& app) { return end_at(app, 1); }},
        {"EndedBeforeAllTime", "time", "xrEndFrame", XR_ERROR_TIME_INVALID, end_before_all_time},
        {"BlendedAsNotOffered", "blend-mode", "xrEndFrame", XR_ERROR_ENVIRONMENT_BLEND_MODE_UNSUPPORTED,
         end_transparent},
        {"LocatedBeforeAllTime", "time", "xrLocateViews", XR_ERROR_TIME_INVALID, locate_before_all_time},
        {"LocatedForAnotherTime", "display-time", "xrLocateViews", XR_SUCCESS, locate_for_another_time},
        {"LocatedTwice", "locate-views", "xrLocateViews", XR_SUCCESS, locate_twice, warning},
        {"LocatedMono", "view-configuration", "xrLocateViews", XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED,
         locate_mono},
        {"NeverLocated", "locate-views", "xrEndFrame", XR_SUCCESS, never_locate, warning},
        {"ShownWhileHidden", "should-render", "xrEndFrame", XR_SUCCESS, show_while_hidden, warning},
        {"ShownWithoutTracking", "view-untracked", "xrEndFrame", XR_SUCCESS, show_without_tracking, warning},
    };
}

}  // namespace neuvv::test
