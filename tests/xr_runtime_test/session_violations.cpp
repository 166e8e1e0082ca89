// Violations in a session's life cycle, its spaces, views, hands and bodies.
#include "xr/body_tracking_types.h"
#include "xr_runtime_test/violation.h"

namespace neuvv::test {

namespace {

constexpr XrSessionBeginInfo kBegin = {XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};

XrResult begin_session_twice(Application& app) {
    app.begin_session();
    return xrBeginSession(app.session, &kBegin);
}

XrResult begin_after_the_end(Application& app) {
    app.make_session();
    check(xrBeginSession(app.session, &kBegin), "xrBeginSession");
    check(xrRequestExitSession(app.session), "xrRequestExitSession");
    check(xrEndSession(app.session), "xrEndSession");
    return xrBeginSession(app.session, &kBegin);
}

XrResult end_session_without_beginning(Application& app) {
    app.make_session();
    return xrEndSession(app.session);
}

XrResult end_while_shown(Application& app) {
    app.make_focused();
    return xrEndSession(app.session);
}

XrResult leave_without_beginning(Application& app) {
    app.make_session();
    return xrRequestExitSession(app.session);
}

XrResult wait_without_beginning(Application& app) {
    app.make_session();
    XrFrameState state = {XR_TYPE_FRAME_STATE};
    return xrWaitFrame(app.session, nullptr, &state);
}

XrResult destroy_while_running(Application& app) {
    app.make_session();
    check(xrBeginSession(app.session, &kBegin), "xrBeginSession");
    const XrResult result = xrDestroySession(app.session);
    app.session = XR_NULL_HANDLE;
    return result;
}

// --- Spaces ---

XrResult crooked_space(Application& app) {
    app.make_session();
    XrReferenceSpaceCreateInfo info = Application::space_info();
    info.poseInReferenceSpace.orientation = {0, 0, 0, 0.9f};
    XrSpace space = XR_NULL_HANDLE;
    return xrCreateReferenceSpace(app.session, &info, &space);
}

XrResult space_that_is_not_offered(Application& app) {
    app.script["spaces"] = {"view", "local"};
    app.make_session();
    const XrReferenceSpaceCreateInfo info = Application::space_info(XR_REFERENCE_SPACE_TYPE_STAGE);
    XrSpace space = XR_NULL_HANDLE;
    return xrCreateReferenceSpace(app.session, &info, &space);
}

XrResult space_before_all_time(Application& app) {
    app.make_session();
    XrSpaceLocation location = {XR_TYPE_SPACE_LOCATION};
    return xrLocateSpace(app.space, app.space, 0, &location);
}

// --- Extensions of sessions ---

XrResult rate_that_is_not_offered(Application& app) {
    app.extensions.push_back(XR_FB_DISPLAY_REFRESH_RATE_EXTENSION_NAME);
    app.make_session();
    return app.function<PFN_xrRequestDisplayRefreshRateFB>("xrRequestDisplayRefreshRateFB")(app.session, 50);
}

XrResult get_mask(Application& app, uint32_t view, XrVisibilityMaskTypeKHR type) {
    app.extensions.push_back(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME);
    app.make_session();
    XrVisibilityMaskKHR mask = {XR_TYPE_VISIBILITY_MASK_KHR};
    return app.function<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR")(
        app.session, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, view, type, &mask);
}

XrResult track_hand(Application& app, XrHandEXT hand, XrHandTrackerEXT* tracker) {
    app.extensions.push_back(XR_EXT_HAND_TRACKING_EXTENSION_NAME);
    app.make_session();
    const XrHandTrackerCreateInfoEXT info = {XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, nullptr, hand,
                                             XR_HAND_JOINT_SET_DEFAULT_EXT};
    return app.function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT")(app.session, &info, tracker);
}

XrResult hands_that_nobody_tracks(Application& app) {
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    return track_hand(app, XR_HAND_LEFT_EXT, &tracker);
}

XrResult third_hand(Application& app) {
    app.script["hand_joints"] = true;
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    return track_hand(app, XrHandEXT(3), &tracker);
}

XrResult locate_joints(Application& app, uint32_t count, void* chain) {
    app.script["hand_joints"] = true;
    XrHandTrackerEXT tracker = XR_NULL_HANDLE;
    check(track_hand(app, XR_HAND_LEFT_EXT, &tracker), "xrCreateHandTrackerEXT");
    const XrHandJointsLocateInfoEXT info = {XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, nullptr, app.space, 1};
    XrHandJointLocationEXT joints[XR_HAND_JOINT_COUNT_EXT];
    XrHandJointLocationsEXT locations = {XR_TYPE_HAND_JOINT_LOCATIONS_EXT, chain, XR_FALSE, count, joints};
    return app.function<PFN_xrLocateHandJointsEXT>("xrLocateHandJointsEXT")(tracker, &info, &locations);
}

XrResult too_few_joints(Application& app) {
    return locate_joints(app, 5, nullptr);
}

XrResult too_few_joint_velocities(Application& app) {
    XrHandJointVelocityEXT speeds[5];
    XrHandJointVelocitiesEXT velocities = {XR_TYPE_HAND_JOINT_VELOCITIES_EXT, nullptr, 5, speeds};
    return locate_joints(app, XR_HAND_JOINT_COUNT_EXT, &velocities);
}

XrResult track_body(Application& app, XrBodyJointSetFB joints, XrBodyTrackerFB* tracker) {
    app.extensions.push_back(XR_FB_BODY_TRACKING_EXTENSION_NAME);
    app.extensions.push_back(XR_META_BODY_TRACKING_FULL_BODY_EXTENSION_NAME);
    app.make_session();
    const XrBodyTrackerCreateInfoFB info = {XR_TYPE_BODY_TRACKER_CREATE_INFO_FB, nullptr, joints};
    return app.function<PFN_xrCreateBodyTrackerFB>("xrCreateBodyTrackerFB")(app.session, &info, tracker);
}

XrResult body_that_nobody_tracks(Application& app) {
    app.script["bodies"] = {"bd"};
    XrBodyTrackerFB tracker = XR_NULL_HANDLE;
    return track_body(app, XR_BODY_JOINT_SET_DEFAULT_FB, &tracker);
}

XrResult legs_that_nobody_tracks(Application& app) {
    app.script["bodies"] = {"fb"};
    XrBodyTrackerFB tracker = XR_NULL_HANDLE;
    return track_body(app, XR_BODY_JOINT_SET_FULL_BODY_META, &tracker);
}

XrResult picos_body_that_nobody_tracks(Application& app) {
    app.script["bodies"] = {"fb"};
    app.extensions.push_back(XR_BD_BODY_TRACKING_EXTENSION_NAME);
    app.make_session();
    const XrBodyTrackerCreateInfoBD info = {XR_TYPE_BODY_TRACKER_CREATE_INFO_BD, nullptr,
                                            XR_BODY_JOINT_SET_FULL_BODY_JOINTS_BD};
    XrBodyTrackerBD tracker = XR_NULL_HANDLE;
    return app.function<PFN_xrCreateBodyTrackerBD>("xrCreateBodyTrackerBD")(app.session, &info, &tracker);
}

// The joints of the full body, from a tracker of the upper body.
XrResult too_many_joints(Application& app) {
    app.script["bodies"] = {"fb"};
    XrBodyTrackerFB tracker = XR_NULL_HANDLE;
    check(track_body(app, XR_BODY_JOINT_SET_DEFAULT_FB, &tracker), "xrCreateBodyTrackerFB");
    const XrBodyJointsLocateInfoFB info = {XR_TYPE_BODY_JOINTS_LOCATE_INFO_FB, nullptr, app.space, 1};
    std::array<XrBodyJointLocationFB, XR_FULL_BODY_JOINT_COUNT_META> joints;
    XrBodyJointLocationsFB locations = {};
    locations.type = XR_TYPE_BODY_JOINT_LOCATIONS_FB;
    locations.jointCount = static_cast<uint32_t>(joints.size());
    locations.jointLocations = joints.data();
    const XrResult result = app.function<PFN_xrLocateBodyJointsFB>("xrLocateBodyJointsFB")(tracker, &info, &locations);
    check(app.function<PFN_xrDestroyBodyTrackerFB>("xrDestroyBodyTrackerFB")(tracker), "xrDestroyBodyTrackerFB");
    return result;
}

XrResult body_tracker_outlives_session(Application& app) {
    app.script["bodies"] = {"fb"};
    XrBodyTrackerFB tracker = XR_NULL_HANDLE;
    check(track_body(app, XR_BODY_JOINT_SET_DEFAULT_FB, &tracker), "xrCreateBodyTrackerFB");
    const XrResult result = xrDestroySession(app.session);
    app.session = XR_NULL_HANDLE;
    return result;
}

XrResult room_that_nobody_sees(Application& app) {
    app.script["extensions"] = {"XR_KHR_vulkan_enable2", XR_FB_PASSTHROUGH_EXTENSION_NAME};
    app.extensions = {"XR_KHR_vulkan_enable2", XR_FB_PASSTHROUGH_EXTENSION_NAME};
    app.make_session();
    const XrPassthroughCreateInfoFB info = {XR_TYPE_PASSTHROUGH_CREATE_INFO_FB, nullptr, 0};
    XrPassthroughFB passthrough = XR_NULL_HANDLE;
    return app.function<PFN_xrCreatePassthroughFB>("xrCreatePassthroughFB")(app.session, &info, &passthrough);
}

// A layer of a passthrough that was never started.
XrResult room_behind_shutters(Application& app) {
    app.script["passthrough"] = true;
    app.extensions.push_back(XR_FB_PASSTHROUGH_EXTENSION_NAME);
    app.begin_session();
    const XrPassthroughCreateInfoFB info = {XR_TYPE_PASSTHROUGH_CREATE_INFO_FB, nullptr, 0};
    XrPassthroughFB passthrough = XR_NULL_HANDLE;
    check(app.function<PFN_xrCreatePassthroughFB>("xrCreatePassthroughFB")(app.session, &info, &passthrough),
          "xrCreatePassthroughFB");
    const XrPassthroughLayerCreateInfoFB images = {XR_TYPE_PASSTHROUGH_LAYER_CREATE_INFO_FB, nullptr, passthrough,
                                                   XR_PASSTHROUGH_IS_RUNNING_AT_CREATION_BIT_FB,
                                                   XR_PASSTHROUGH_LAYER_PURPOSE_RECONSTRUCTION_FB};
    XrCompositionLayerPassthroughFB layer = {XR_TYPE_COMPOSITION_LAYER_PASSTHROUGH_FB};
    check(app.function<PFN_xrCreatePassthroughLayerFB>("xrCreatePassthroughLayerFB")(app.session, &images,
                                                                                     &layer.layerHandle),
          "xrCreatePassthroughLayerFB");
    app.prepare_visible_frame();
    app.frame.layers.insert(app.frame.layers.begin(), reinterpret_cast<XrCompositionLayerBaseHeader*>(&layer));
    app.frame.end.layers = app.frame.layers.data();
    ++app.frame.end.layerCount;
    return app.end_frame();
}

}  // namespace

std::vector<Violation> session_violations() {
    using App = Application;
    const XrResult invalid = XR_ERROR_VALIDATION_FAILURE;
    const auto hidden = XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR;
    return {
        {"BegunTwice", "session-state", "xrBeginSession", XR_ERROR_SESSION_RUNNING, begin_session_twice},
        {"BegunAfterTheEnd", "session-state", "xrBeginSession", XR_ERROR_SESSION_NOT_READY, begin_after_the_end},
        {"EndedBeforeTheBeginning", "session-state", "xrEndSession", XR_ERROR_SESSION_NOT_RUNNING,
         end_session_without_beginning},
        {"EndedWhileShown", "session-state", "xrEndSession", XR_ERROR_SESSION_NOT_STOPPING, end_while_shown},
        {"LeftBeforeTheBeginning", "session-state", "xrRequestExitSession", XR_ERROR_SESSION_NOT_RUNNING,
         leave_without_beginning},
        {"WaitedBeforeTheBeginning", "session-state", "xrWaitFrame", XR_ERROR_SESSION_NOT_RUNNING,
         wait_without_beginning},
        {"DestroyedWhileItRuns", "session", "xrDestroySession", XR_SUCCESS, destroy_while_running, Severity::kWarning},
        {"CrookedSpace", "pose", "xrCreateReferenceSpace", XR_ERROR_POSE_INVALID, crooked_space},
        {"SpaceThatIsNotOffered", "reference-space", "xrCreateReferenceSpace", XR_ERROR_REFERENCE_SPACE_UNSUPPORTED,
         space_that_is_not_offered},
        {"SpaceBeforeAllTime", "time", "xrLocateSpace", XR_ERROR_TIME_INVALID, space_before_all_time},
        {"RateThatIsNotOffered", "refresh-rate", "xrRequestDisplayRefreshRateFB",
         XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB, rate_that_is_not_offered},
        {"MaskOfThirdView", "view-index", "xrGetVisibilityMaskKHR", invalid,
         [](App& app) { return get_mask(app, 2, hidden); }},
        {"UnknownMask", "enum", "xrGetVisibilityMaskKHR", invalid,
         [](App& app) { return get_mask(app, 0, XrVisibilityMaskTypeKHR(77)); }},
        {"HandsThatNobodyTracks", "hand-tracking", "xrCreateHandTrackerEXT", XR_ERROR_FEATURE_UNSUPPORTED,
         hands_that_nobody_tracks},
        {"ThirdHand", "enum", "xrCreateHandTrackerEXT", invalid, third_hand},
        {"BodyThatNobodyTracks", "body-tracking", "xrCreateBodyTrackerFB", XR_ERROR_FEATURE_UNSUPPORTED,
         body_that_nobody_tracks},
        {"LegsThatNobodyTracks", "body-tracking", "xrCreateBodyTrackerFB", invalid, legs_that_nobody_tracks},
        {"PicosBodyThatNobodyTracks", "body-tracking", "xrCreateBodyTrackerBD", XR_ERROR_FEATURE_UNSUPPORTED,
         picos_body_that_nobody_tracks},
        {"RoomThatNobodySees", "passthrough", "xrCreatePassthroughFB", XR_ERROR_FEATURE_UNSUPPORTED,
         room_that_nobody_sees},
        {"RoomBehindShutters", "passthrough", "xrEndFrame", XR_SUCCESS, room_behind_shutters},
        {"TooManyJoints", "joint-count", "xrLocateBodyJointsFB", invalid, too_many_joints},
        {"BodyTrackerThatOutlivesTheSession", "session", "xrDestroySession", XR_SUCCESS, body_tracker_outlives_session,
         Severity::kWarning},
        {"TooFewJoints", "joint-count", "xrLocateHandJointsEXT", invalid, too_few_joints},
        {"TooFewJointVelocities", "joint-count", "xrLocateHandJointsEXT", invalid, too_few_joint_velocities},
    };
}

}  // namespace neuvv::test
