// The effects of scripts on a correct application, and the messages about wrong scripts.
#include <algorithm>

#include "xr_runtime_test/application.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

void expect_clean(Application& app) {
    const json report = app.end();
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["violations"], json::array());
    EXPECT_EQ(report["warnings"], json::array());
}

XrResult create_instance(Application& app) {
    app.set_environment();
    const XrInstanceCreateInfo info = app.instance_info();
    return xrCreateInstance(&info, &app.instance);
}

// --- Faults ---

TEST(Script, FailsCallsAfterThoseThatItSkips) {
    Application app;
    app.script["fail"] = {
        {{"function", "xrEndFrame"}, {"result", "XR_ERROR_OUT_OF_MEMORY"}, {"skip", 1}, {"times", 2}}};
    app.begin_session();
    app.prepare_frame();
    EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    app.prepare_frame();
    EXPECT_EQ(app.end_frame(), XR_ERROR_OUT_OF_MEMORY);
    EXPECT_EQ(app.end_frame(), XR_ERROR_OUT_OF_MEMORY);
    EXPECT_EQ(app.end_frame(), XR_SUCCESS) << "the frame is as it was";
    expect_clean(app);
}

TEST(Script, FailsTheInstanceToo) {
    Application app;
    app.script["fail"] = {{{"function", "xrCreateInstance"}, {"result", "XR_ERROR_RUNTIME_UNAVAILABLE"}}};
    EXPECT_EQ(create_instance(app), XR_ERROR_RUNTIME_UNAVAILABLE);
    app.make_focused();
    expect_clean(app);
}

TEST(Script, RefusesFormatsThatItOffers) {
    Application app;
    app.script["refuse"] = {{"formats", {"R16G16B16A16_SFLOAT"}}};
    app.make_session();
    std::vector<int64_t> formats(16);
    uint32_t count = 0;
    EXPECT_EQ(xrEnumerateSwapchainFormats(app.session, 16, &count, formats.data()), XR_SUCCESS);
    EXPECT_TRUE(std::count(formats.begin(), formats.end(), VK_FORMAT_R16G16B16A16_SFLOAT));
    const XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R16G16B16A16_SFLOAT);
    XrSwapchain swapchain = XR_NULL_HANDLE;
    EXPECT_EQ(xrCreateSwapchain(app.session, &info, &swapchain), XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    expect_clean(app);
}

TEST(Script, LosesASessionAfterAFrameThatItGives) {
    Application app;
    app.script["events"] = {{{"frame", 3}, {"do", "lose_session"}}};
    app.make_focused();
    XrFrameState state = {XR_TYPE_FRAME_STATE};
    EXPECT_EQ(xrWaitFrame(app.session, nullptr, &state), XR_SUCCESS);
    EXPECT_EQ(xrBeginFrame(app.session, nullptr), XR_ERROR_SESSION_LOST);
    EXPECT_EQ(xrReleaseSwapchainImage(app.panel, nullptr), XR_ERROR_SESSION_LOST);
    EXPECT_EQ(app.locate_views(state.predictedDisplayTime), XR_ERROR_SESSION_LOST);
    app.poll_events();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_LOSS_PENDING);
    app.destroy_session();
    app.make_focused();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_FOCUSED) << "another session works";
    expect_clean(app);
}

TEST(Script, LosesAnInstanceAfterSomeCalls) {
    Application app;
    app.script["events"] = {{{"frame", 3}, {"do", "lose_instance"}, {"calls", 2}}};
    app.make_focused();
    XrFrameState state = {XR_TYPE_FRAME_STATE};
    EXPECT_EQ(xrWaitFrame(app.session, nullptr, &state), XR_SUCCESS);
    app.poll_events();  // this makes two calls
    EXPECT_EQ(app.events.back().type, XR_TYPE_EVENT_DATA_INSTANCE_LOSS_PENDING);
    EXPECT_EQ(xrBeginFrame(app.session, nullptr), XR_ERROR_INSTANCE_LOST);
    EXPECT_EQ(app.locate_views(state.predictedDisplayTime), XR_ERROR_INSTANCE_LOST);
    app.end();
    app.make_focused();
    const json report = app.end();
    EXPECT_EQ(report["frames"], 4 + 3) << "the script goes on";
    EXPECT_EQ(report["violations"], json::array());
}

// The x coordinate of the head, which does not move.
float x_of_head(const Application& app, XrTime time) {
    const XrReferenceSpaceCreateInfo info = Application::space_info(XR_REFERENCE_SPACE_TYPE_VIEW);
    XrSpace head = XR_NULL_HANDLE;
    check(xrCreateReferenceSpace(app.session, &info, &head), "xrCreateReferenceSpace");
    XrSpaceLocation location = {XR_TYPE_SPACE_LOCATION};
    check(xrLocateSpace(head, app.space, time, &location), "xrLocateSpace");
    return location.pose.position.x;
}

TEST(Script, RecentresTwoPeriodsLater) {
    Application app;
    app.script["events"] = {{{"frame", 3}, {"do", "recentre"}, {"shift", {{"at", {1, 0, 0}}}}}};
    app.make_focused();
    app.prepare_frame();
    app.poll_events();
    const XrTime change = app.frame.state.predictedDisplayTime + 2 * app.frame.state.predictedDisplayPeriod;
    std::vector<XrReferenceSpaceType> spaces;
    for (const XrEventDataBuffer& event : app.events) {
        if (event.type != XR_TYPE_EVENT_DATA_REFERENCE_SPACE_CHANGE_PENDING) continue;
        const auto& pending = reinterpret_cast<const XrEventDataReferenceSpaceChangePending&>(event);
        spaces.push_back(pending.referenceSpaceType);
        EXPECT_EQ(pending.changeTime, change);
        EXPECT_TRUE(pending.poseValid);
        EXPECT_EQ(pending.poseInPreviousSpace.position.x, 1);
    }
    EXPECT_EQ(spaces, (std::vector{XR_REFERENCE_SPACE_TYPE_LOCAL, XR_REFERENCE_SPACE_TYPE_STAGE}));
    EXPECT_EQ(x_of_head(app, change - 1), 0);
    EXPECT_EQ(x_of_head(app, change), -1);
    EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    expect_clean(app);
}

TEST(Script, StopsASessionAndLetsItBeginAgain) {
    Application app;
    app.script["events"] = {{{"frame", 3}, {"do", "stop"}, {"restart", true}, {"for", 4}}};
    app.make_focused();
    app.prepare_frame();
    EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    app.poll_events();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_STOPPING);
    EXPECT_EQ(xrEndSession(app.session), XR_SUCCESS);
    for (int polls = 0; polls < 5; ++polls) {
        app.poll_events();
        EXPECT_EQ(app.states.back(), XR_SESSION_STATE_IDLE);
    }
    app.poll_events();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_READY);
    const XrSessionBeginInfo info = {XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
    EXPECT_EQ(xrBeginSession(app.session, &info), XR_SUCCESS);
    app.make_focused();
    expect_clean(app);
}

TEST(Script, SlowsFramesDown) {
    Application app;
    app.script["events"] = {{{"frame", 3}, {"do", "slow"}, {"frames", 2}, {"periods", 4}}};
    app.make_focused();
    std::vector<XrDuration> periods;
    XrTime before = app.frame.state.predictedDisplayTime;
    for (int i = 0; i < 4; ++i) {
        app.prepare_frame();
        const XrFrameState& state = app.frame.state;
        periods.push_back((state.predictedDisplayTime - before) / state.predictedDisplayPeriod);
        before = state.predictedDisplayTime;
        EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    }
    EXPECT_EQ(periods, (std::vector<XrDuration>{1, 4, 4, 1}));
    expect_clean(app);
}

TEST(Script, EndsWhereItSays) {
    Application app;
    app.script["end_frame"] = 3;
    app.make_focused();
    app.prepare_frame();
    EXPECT_FALSE(app.frame.state.shouldRender);
    EXPECT_EQ(app.end_frame(), XR_SUCCESS);
    app.poll_events();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_STOPPING);
    app.destroy_session();
    EXPECT_EQ(app.states.back(), XR_SESSION_STATE_EXITING);
    expect_clean(app);
}

// --- Scripts that are wrong ---

struct WrongScript {
    const char* name;
    const char* text;
    const char* place;
};
void PrintTo(const WrongScript& script, std::ostream* stream) {
    *stream << script.text;
}

const WrongScript kWrongScripts[] = {
    {"UnknownKey", R"({"heigth": 3})", "/heigth: unknown key"},
    {"UnknownKeyOfEvent", R"({"events": [{"when": 3, "do": "exit"}]})", "/events/0/when: unknown key"},
    {"UnknownEvent", R"({"events": [{"frame": 3, "do": "jump"}]})", "/events/0/do: unknown event 'jump'"},
    {"UnknownTime", R"({"time": "slow"})", "/time: "},
    {"UnknownFormat", R"({"formats": ["R8"]})", "/formats: unknown name 'R8'"},
    {"UnknownResult", R"({"fail": [{"function": "xrEndFrame", "result": "XR_OOPS"}]})", "/fail/0/result: unknown name"},
    {"UnknownFunction", R"({"fail": [{"function": "xrEndFrames"}]})", "/fail/0/function: unknown function"},
    {"UnknownExtension", R"({"extensions": ["XR_KHR_nothing"]})", "/extensions: not implemented"},
    {"TextForNumber", R"({"width": "wide"})", "/width: "},
    {"UnknownBody", R"({"bodies": ["half"]})", "/bodies: unknown name 'half'"},
    {"BodyJointWithoutNumber", R"({"timeline": [{"frame": 1, "body": {"joints": {"knee": {"at": [0, 0, 0]}}}}]})",
     "/timeline/0/body/joints/knee: the number"},
    {"BodyJointWithTwoNumbers", R"({"timeline": [{"frame": 1, "body": {"joints": {"3": {"at": [0, 0]}}}}]})",
     "/timeline/0/body/joints/3/at: three numbers"},
    {"FramesOutOfOrder", R"({"timeline": [{"frame": 2}, {"frame": 1}]})", "/timeline/1/frame: "},
};

struct WrongScripts : testing::TestWithParam<WrongScript> {};

TEST_P(WrongScripts, AreOneClearLine) {
    Application app;
    app.script = json::parse(GetParam().text);
    testing::internal::CaptureStderr();
    EXPECT_EQ(create_instance(app), XR_ERROR_RUNTIME_FAILURE);
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_EQ(std::count(line.begin(), line.end(), '\n'), 1) << line;
    EXPECT_NE(line.find(std::string("script.json: ") + GetParam().place), std::string::npos) << line;
}

std::string script_name(const testing::TestParamInfo<WrongScript>& info) {
    return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Script, WrongScripts, testing::ValuesIn(kWrongScripts), script_name);

TEST(Script, ThatIsMissingIsOneClearLine) {
    Application app;
    app.set_environment();
    setenv("NEUVV_XR_SCRIPT", "/nowhere/script.json", 1);
    const XrInstanceCreateInfo info = app.instance_info();
    testing::internal::CaptureStderr();
    EXPECT_EQ(xrCreateInstance(&info, &app.instance), XR_ERROR_RUNTIME_FAILURE);
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "xr-runtime: /nowhere/script.json: NEUVV_XR_SCRIPT cannot be read\n");
}

TEST(Script, ThatIsWrongIsForgottenByTheNext) {
    Application wrong;
    wrong.script["heigth"] = 3;
    EXPECT_EQ(create_instance(wrong), XR_ERROR_RUNTIME_FAILURE);
    Application app;
    app.make_focused();
    expect_clean(app);
}

}  // namespace
}  // namespace neuvv::test
