// The runtime finds nothing wrong with a correct application.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "xr_runtime_test/application.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

void expect_clean(const json& report) {
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["violations"], json::array());
    EXPECT_EQ(report["warnings"], json::array());
    EXPECT_EQ(report["destroyed_cleanly"], true);
}

XrResult vibrate(const Application& app) {
    const XrHapticActionInfo info = {XR_TYPE_HAPTIC_ACTION_INFO, nullptr, app.buzz, app.hands[1]};
    const XrHapticVibration vibration = {XR_TYPE_HAPTIC_VIBRATION, nullptr, 1000, XR_FREQUENCY_UNSPECIFIED, 0.5f};
    return xrApplyHapticFeedback(app.session, &info, reinterpret_cast<const XrHapticBaseHeader*>(&vibration));
}

TEST(CorrectApplication, HasNoFindings) {
    Application app;
    app.script["timeline"] = {{{"frame", 0}, {"input", {{"/user/hand/right/input/trigger/value", 1}}}}};
    app.attach_actions();
    app.make_focused();
    for (int i = 0; i < 3; ++i) {
        app.prepare_frame();
        EXPECT_EQ(app.sync_actions(), XR_SUCCESS);
        const XrActionStateGetInfo info = {XR_TYPE_ACTION_STATE_GET_INFO, nullptr, app.press, app.hands[1]};
        XrActionStateBoolean state = {XR_TYPE_ACTION_STATE_BOOLEAN};
        EXPECT_EQ(xrGetActionStateBoolean(app.session, &info, &state), XR_SUCCESS);
        EXPECT_TRUE(state.isActive && state.currentState);
        EXPECT_EQ(vibrate(app), XR_SUCCESS);
        EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    }
    const json report = app.end();
    expect_clean(report);
    EXPECT_EQ(report["frames"], 6);
    EXPECT_EQ(report["frames_with_layers"], 4);
    EXPECT_EQ(report["haptics"].size(), 3u);
    const json states = {"IDLE",    "READY",        "SYNCHRONIZED", "VISIBLE", "FOCUSED",
                         "VISIBLE", "SYNCHRONIZED", "STOPPING",     "IDLE",    "EXITING"};
    EXPECT_EQ(report["states"], states);
}

TEST(CorrectApplication, HasNoFindingsByTheFirstVulkanExtension) {
    Application app;
    app.extensions = {XR_KHR_VULKAN_ENABLE_EXTENSION_NAME, XR_KHR_COMPOSITION_LAYER_DEPTH_EXTENSION_NAME};
    app.make_focused();
    const json report = app.end();
    expect_clean(report);
    EXPECT_EQ(report["frames_with_layers"], 1);
}

TEST(CorrectApplication, MayWaitForFramesOnAnotherThread) {
    Application app;
    app.make_focused();
    XrFrameState first = {XR_TYPE_FRAME_STATE}, second = {XR_TYPE_FRAME_STATE};
    EXPECT_EQ(xrWaitFrame(app.session, nullptr, &first), XR_SUCCESS);
    std::atomic<bool> has_waited = false;
    std::thread waiter([&] {
        EXPECT_EQ(xrWaitFrame(app.session, nullptr, &second), XR_SUCCESS);
        has_waited = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_FALSE(has_waited) << "it must block until the frame before has begun";
    for (const XrFrameState* state : {&first, &second}) {
        EXPECT_EQ(xrBeginFrame(app.session, nullptr), XR_SUCCESS);
        if (state == &first) waiter.join();
        const XrFrameEndInfo end = {XR_TYPE_FRAME_END_INFO, nullptr, state->predictedDisplayTime,
                                    XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
        EXPECT_EQ(xrEndFrame(app.session, &end), XR_SUCCESS);
    }
    expect_clean(app.end());
}

TEST(CorrectApplication, IsReportedWithoutWhatOthersDidBefore) {
    {
        Application other;
        other.begin_session();
        EXPECT_EQ(xrBeginFrame(other.session, nullptr), XR_ERROR_CALL_ORDER_INVALID);
    }
    Application app;
    app.make_focused();
    const json report = app.end();
    expect_clean(report);
    EXPECT_EQ(report["frames"], 3);
}

}  // namespace
}  // namespace neuvv::test
