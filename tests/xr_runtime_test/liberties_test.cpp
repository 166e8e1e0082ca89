// What few applications do although all may: every call succeeds, and there is no finding.
#include <cmath>
#include <cstring>
#include <limits>

#include "xr_runtime_test/application.h"

namespace neuvv::test {
namespace {

using nlohmann::json;

struct Liberty {
    const char* name;
    void (*take)(Application& app);
};
void PrintTo(const Liberty& liberty, std::ostream* stream) {
    *stream << liberty.name;
}

// --- Frames ---

template <auto kAlter>
void take(Application& app) {
    app.prepare_visible_frame();
    kAlter(app.frame);
    check(app.end_frame(), "xrEndFrame");
}

void nothing(Frame& frame) {
    frame.end.layerCount = 0;
    frame.end.layers = nullptr;
}
void sixteen_layers(Frame& frame) {
    frame.layers.assign(XR_MIN_COMPOSITION_LAYERS_SUPPORTED, frame.layers[1]);
    frame.end.layers = frame.layers.data();
    frame.end.layerCount = XR_MIN_COMPOSITION_LAYERS_SUPPORTED;
}
void all_flags(Frame& frame) {
    frame.quad.layerFlags = XR_COMPOSITION_LAYER_CORRECT_CHROMATIC_ABERRATION_BIT |
                            XR_COMPOSITION_LAYER_BLEND_TEXTURE_SOURCE_ALPHA_BIT |
                            XR_COMPOSITION_LAYER_UNPREMULTIPLIED_ALPHA_BIT;
}
void turned_depth(Frame& frame) {
    for (auto& depth : frame.depth) std::swap(depth.nearZ, depth.farZ);
}
void endless_depth(Frame& frame) {
    for (auto& depth : frame.depth) depth.farZ = std::numeric_limits<float>::infinity();
}
void no_depth(Frame& frame) {
    for (auto& eye : frame.eyes) eye.next = nullptr;
}
void part_of_an_image(Frame& frame) {
    frame.eyes[0].subImage.imageRect = {{4, 8}, {16, 8}};
}
// The negative of a quaternion, which is the same rotation.
void other_quaternion(Frame& frame) {
    auto& q = frame.eyes[1].pose.orientation;
    q = {-q.x, -q.y, -q.z, -q.w};
}
// A length within the 1 % that the specification allows.
void rounded_quaternion(Frame& frame) {
    frame.quad.pose.orientation = {0, 0, 0, 1.009f};
}

void show_the_same_image_again(Application& app) {
    app.make_focused();
    const Frame shown = app.frame;
    app.prepare_frame();
    app.frame.layers[1] = shown.layers[1];
    check(app.end_frame(), "xrEndFrame");
    check(xrWaitFrame(app.session, nullptr, &app.frame.state), "xrWaitFrame");
    check(xrBeginFrame(app.session, nullptr), "xrBeginFrame");
    app.frame.end.displayTime = app.frame.state.predictedDisplayTime;
    app.frame.end.layerCount = 1;
    app.frame.end.layers = &app.frame.layers[1];
    check(app.end_frame(), "xrEndFrame");
}

void show_in_another_space(Application& app, XrReferenceSpaceType type) {
    app.make_session();
    check(xrDestroySpace(app.space), "xrDestroySpace");
    XrReferenceSpaceCreateInfo info = Application::space_info(type);
    info.poseInReferenceSpace = {{0, std::sqrt(0.5f), 0, std::sqrt(0.5f)}, {1, 2, 3}};
    check(xrCreateReferenceSpace(app.session, &info, &app.space), "xrCreateReferenceSpace");
    app.make_focused();
}

void pass_empty_structs(Application& app) {
    app.begin_session();
    const XrFrameWaitInfo wait = {XR_TYPE_FRAME_WAIT_INFO};
    const XrFrameBeginInfo begin = {XR_TYPE_FRAME_BEGIN_INFO};
    const XrSwapchainImageAcquireInfo acquire = {XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO};
    const XrSwapchainImageReleaseInfo release = {XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO};
    const XrSwapchainImageWaitInfo no_time = {XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO};
    app.frame.state = {XR_TYPE_FRAME_STATE};
    check(xrWaitFrame(app.session, &wait, &app.frame.state), "xrWaitFrame");
    check(xrBeginFrame(app.session, &begin), "xrBeginFrame");
    uint32_t index = 0;
    check(xrAcquireSwapchainImage(app.panel, &acquire, &index), "xrAcquireSwapchainImage");
    check(xrWaitSwapchainImage(app.panel, &no_time), "xrWaitSwapchainImage");
    check(xrReleaseSwapchainImage(app.panel, &release), "xrReleaseSwapchainImage");
    const XrFrameEndInfo end = {XR_TYPE_FRAME_END_INFO, nullptr, app.frame.state.predictedDisplayTime,
                                XR_ENVIRONMENT_BLEND_MODE_OPAQUE};
    check(xrEndFrame(app.session, &end), "xrEndFrame");
}

// --- Other calls ---

void offer_more_room(Application& app) {
    app.make_session();
    std::vector<int64_t> formats(100);
    uint32_t count = 0;
    check(xrEnumerateSwapchainFormats(app.session, 100, &count, formats.data()), "xrEnumerateSwapchainFormats");
    EXPECT_EQ(count, 6u);
}

void locate_at_any_time(Application& app) {
    app.make_session();
    XrSpaceVelocity velocity = {XR_TYPE_SPACE_VELOCITY};
    XrSpaceLocation location = {XR_TYPE_SPACE_LOCATION, &velocity};
    for (const XrTime time : {XrTime{1}, XrTime{1} << 60})
        check(xrLocateSpace(app.space, app.space, time, &location), "xrLocateSpace");
    check(app.locate_views(1), "xrLocateViews");
}

void use_a_static_image(Application& app) {
    app.make_session();
    XrSwapchainCreateInfo info = app.swapchain_info(VK_FORMAT_R8G8B8A8_SRGB);
    info.createFlags = XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
    info.mipCount = 3;
    check(xrDestroySwapchain(app.colour), "xrDestroySwapchain");
    info.arraySize = 2;
    XrSwapchain image = XR_NULL_HANDLE;
    check(xrCreateSwapchain(app.session, &info, &image), "xrCreateSwapchain");
    Application::draw_to(image);
    const XrSwapchainCreateInfo colour = app.swapchain_info(VK_FORMAT_R16G16B16A16_SFLOAT, 2);
    check(xrCreateSwapchain(app.session, &colour, &app.colour), "xrCreateSwapchain");
    app.prepare_visible_frame();
    app.frame.quad.subImage.swapchain = image;
    app.frame.quad.subImage.imageArrayIndex = 1;
    check(app.end_frame(), "xrEndFrame");
}

void name_an_action_oddly(Application& app) {
    app.make_actions();
    XrActionCreateInfo info = app.action_info("a-1_b.c", XR_ACTION_TYPE_VECTOR2F_INPUT);
    std::strcpy(info.localizedActionName, "Größer / kleiner");
    info.countSubactionPaths = 0;
    info.subactionPaths = nullptr;
    XrAction action = XR_NULL_HANDLE;
    check(xrCreateAction(app.action_set, &info, &action), "xrCreateAction");
    app.attach_actions();
}

void sync_without_focus(Application& app) {
    app.attach_actions();
    EXPECT_EQ(app.sync_actions(), XR_SESSION_NOT_FOCUSED);
    const XrActionsSyncInfo none = {XR_TYPE_ACTIONS_SYNC_INFO};
    EXPECT_EQ(xrSyncActions(app.session, &none), XR_SESSION_NOT_FOCUSED);
}

void begin_again(Application& app) {
    app.make_focused();
    app.destroy_session();
    app.make_focused();
}

void end_at_once(Application& app) {
    app.make_instance();
}

std::vector<Liberty> liberties() {
    return {
        {"Nothing", take<nothing>},
        {"SixteenLayers", take<sixteen_layers>},
        {"AllFlags", take<all_flags>},
        {"TurnedDepth", take<turned_depth>},
        {"EndlessDepth", take<endless_depth>},
        {"NoDepth", take<no_depth>},
        {"PartOfAnImage", take<part_of_an_image>},
        {"OtherQuaternion", take<other_quaternion>},
        {"RoundedQuaternion", take<rounded_quaternion>},
        {"TheSameImageAgain", show_the_same_image_again},
        {"ViewSpace", [](Application& app) { show_in_another_space(app, XR_REFERENCE_SPACE_TYPE_VIEW); }},
        {"StageSpace", [](Application& app) { show_in_another_space(app, XR_REFERENCE_SPACE_TYPE_STAGE); }},
        {"EmptyStructs", pass_empty_structs},
        {"MoreRoom", offer_more_room},
        {"AnyTime", locate_at_any_time},
        {"StaticImage", use_a_static_image},
        {"OddName", name_an_action_oddly},
        {"NoFocus", sync_without_focus},
        {"AnotherSession", begin_again},
        {"TheEndAtOnce", end_at_once},
    };
}

struct Liberties : testing::TestWithParam<Liberty> {};

TEST_P(Liberties, MayBeTaken) {
    Application app;
    GetParam().take(app);
    const json report = app.end();
    ASSERT_TRUE(report.is_object());
    EXPECT_EQ(report["violations"], json::array());
    EXPECT_EQ(report["warnings"], json::array());
}

std::string liberty_name(const testing::TestParamInfo<Liberty>& info) {
    return info.param.name;
}
INSTANTIATE_TEST_SUITE_P(Application, Liberties, testing::ValuesIn(liberties()), liberty_name);

}  // namespace
}  // namespace neuvv::test
