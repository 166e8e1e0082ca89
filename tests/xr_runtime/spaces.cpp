#include "spaces.h"

#include "call.h"
#include "pose.h"
#include "profiles.h"
#include "velocity.h"

namespace neuvv::xr_runtime {

namespace {

// The origin of a reference space at a time, after all recentrings before it.
XrPosef origin_in_world(XrReferenceSpaceType type, XrTime time) {
    XrPosef origin = kIdentityPose;
    if (type == XR_REFERENCE_SPACE_TYPE_LOCAL) origin.position.y = -runtime().script.floor_m;
    for (const Recentre& recentre : runtime().progress.recentres)
        if (recentre.space == type && recentre.change_time <= time) origin = origin * recentre.shift;
    return origin;
}

// A role that the script has no tracker for has none.
Located tracker_in_world(const std::string& role, XrTime time) {
    const auto track = runtime().script.trackers.find(role);
    if (track == runtime().script.trackers.end()) return {kIdentityPose, false};
    return {pose_at(track->second, frame_at(time), kIdentityPose), true};
}

Located action_in_world(const Space& space, XrTime time) {
    const auto& states = space.session->action_states;
    const auto found = states.find({space.action->handle, space.subaction_path});
    if (found == states.end() || !found->second.is_active) return {kIdentityPose, false};
    const std::string& source = found->second.source;
    if (user_of(source) == kGazeUser) return gaze_in_world(time);
    if (source.starts_with(kTrackerRoot))
        return tracker_in_world(user_of(source).substr(std::string(kTrackerRoot).size()), time);
    return hand_in_world(hand_of(source), source.find("/input/aim") != std::string::npos, time);
}

// LOCAL_FLOOR needs its extension, as instances are of OpenXR 1.0.
std::vector<XrReferenceSpaceType> offered_spaces() {
    std::vector<XrReferenceSpaceType> spaces = runtime().script.spaces;
    if (!runtime().instance->has(xr::kLocalFloorExtension)) std::erase(spaces, xr::kLocalFloorSpace);
    if (runtime().instance->has(XR_VARJO_FOVEATED_RENDERING_EXTENSION_NAME))
        spaces.push_back(XR_REFERENCE_SPACE_TYPE_COMBINED_EYE_VARJO);
    return spaces;
}

XrResult enumerate_spaces(XrSession handle, uint32_t capacity, uint32_t* count, XrReferenceSpaceType* out) {
    object<Session>(handle);
    return give_values(capacity, count, out, offered_spaces());
}

void check_reference(XrReferenceSpaceType type) {
    const std::vector<XrReferenceSpaceType> spaces = offered_spaces();
    require(std::find(spaces.begin(), spaces.end(), type) != spaces.end(), XR_ERROR_REFERENCE_SPACE_UNSUPPORTED,
            "reference-space",
            fmt::format("xrEnumerateReferenceSpaces does not name the type {}", static_cast<int>(type)));
}

XrResult create_reference_space(XrSession handle, const XrReferenceSpaceCreateInfo* create_info, XrSpace* out) {
    Session& session = object<Session>(handle);
    const XrReferenceSpaceCreateInfo& info = checked(create_info);
    check_pointer(out, "space");
    check_reference(info.referenceSpaceType);
    check_pose(info.poseInReferenceSpace, "poseInReferenceSpace");
    const auto space = make_object<Space>();
    space->session = &session;
    space->reference = info.referenceSpaceType;
    space->offset = info.poseInReferenceSpace;
    *out = space->handle;
    return XR_SUCCESS;
}

XrResult get_bounds(XrSession handle, XrReferenceSpaceType type, XrExtent2Df* bounds) {
    object<Session>(handle);
    check_pointer(bounds, "bounds");
    check_reference(type);
    const bool has_bounds = type == XR_REFERENCE_SPACE_TYPE_STAGE;
    *bounds = has_bounds ? XrExtent2Df{3, 2} : XrExtent2Df{0, 0};
    return has_bounds ? XR_SUCCESS : XR_SPACE_BOUNDS_UNAVAILABLE;
}

XrResult create_action_space(XrSession handle, const XrActionSpaceCreateInfo* create_info, XrSpace* out) {
    Session& session = object<Session>(handle);
    const XrActionSpaceCreateInfo& info = checked(create_info);
    check_pointer(out, "space");
    const auto action = shared<Action>(info.action);
    require(action->type == XR_ACTION_TYPE_POSE_INPUT, XR_ERROR_ACTION_TYPE_MISMATCH, "action-type",
            fmt::format("the action '{}' of an action space is no pose action", action->name));
    check_subaction(*action, info.subactionPath);
    check_pose(info.poseInActionSpace, "poseInActionSpace");
    const auto space = make_object<Space>();
    space->session = &session;
    space->action = action;
    space->subaction_path = info.subactionPath;
    space->offset = info.poseInActionSpace;
    *out = space->handle;
    return XR_SUCCESS;
}

XrResult locate_space(XrSpace handle, XrSpace base_handle, XrTime time, XrSpaceLocation* out) {
    const Space &space = object<Space>(handle), &base = object<Space>(base_handle);
    XrSpaceLocation& location = checked(out);
    check_time(time);
    const Located located = locate(space, base, time);
    location.locationFlags = located.is_valid ? kAllFlags : 0;
    location.pose = located.is_valid ? located.pose : kIdentityPose;
    auto* speeds = const_cast<XrSpaceVelocity*>(chained<XrSpaceVelocity>(out));
    if (!speeds) return XR_SUCCESS;
    const Velocity speed = velocity([&](XrTime at) { return locate(space, base, at); }, time);
    speeds->velocityFlags = located.is_valid ? XR_SPACE_VELOCITY_LINEAR_VALID_BIT | XR_SPACE_VELOCITY_ANGULAR_VALID_BIT
                                             : XrSpaceVelocityFlags{0};
    speeds->linearVelocity = speed.linear;
    speeds->angularVelocity = speed.angular;
    return XR_SUCCESS;
}

XrResult destroy_space(XrSpace handle) {
    shared<Space>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

}  // namespace

Hand hand_of(const std::string& path) {
    return path.starts_with("/user/hand/left") ? kLeft : kRight;
}

Located head_in_world(XrTime time) {
    const XrPosef upright = {{0, 0, 0, 1}, {0, -runtime().script.floor_m, 0}};
    const bool is_tracked = runtime().progress.frame() >= runtime().progress.untracked_until;
    return {pose_at(runtime().script.head, frame_at(time), upright), is_tracked};
}

Located gaze_in_world(XrTime time) {
    const GazeTracks& gaze = runtime().script.gaze;
    const double frame = frame_at(time);
    const bool is_tracked = value_at(gaze.tracked, static_cast<int64_t>(std::floor(frame + 1e-6)), false);
    return {pose_at(gaze.pose, frame, kIdentityPose), is_tracked};
}

Located hand_in_world(Hand hand, bool is_aim, XrTime time) {
    const HandTracks& tracks = runtime().script.hands[hand];
    const double frame = frame_at(time);
    const XrPosef at_rest = {{0, 0, 0, 1}, {hand == kLeft ? -0.2f : 0.2f, -0.4f - runtime().script.floor_m, -0.4f}};
    const bool is_tracked = value_at(tracks.tracked, static_cast<int64_t>(std::floor(frame + 1e-6)), true);
    return {pose_at(is_aim ? tracks.aim : tracks.grip, frame, at_rest), is_tracked};
}

Located space_in_world(const Space& space, XrTime time) {
    Located located;
    if (space.action)
        located = action_in_world(space, time);
    else if (space.reference == XR_REFERENCE_SPACE_TYPE_VIEW)
        located = head_in_world(time);
    else if (space.reference == XR_REFERENCE_SPACE_TYPE_COMBINED_EYE_VARJO)
        located = gaze_in_world(time);
    else
        located.pose = origin_in_world(space.reference, time);
    return {located.pose * space.offset, located.is_valid};
}

Located locate(const Space& space, const Space& base, XrTime time) {
    // The relative pose of two spaces of the same reference is known, even while the head is not tracked.
    const bool are_same = !space.action && !base.action && space.reference == base.reference;
    if (are_same) return {inverse(base.offset) * space.offset, true};
    const Located a = space_in_world(space, time), b = space_in_world(base, time);
    return {inverse(b.pose) * a.pose, a.is_valid && b.is_valid};
}

Located view_in(const Space& space, uint32_t view, XrTime time) {
    Space head;
    head.reference = XR_REFERENCE_SPACE_TYPE_VIEW;
    head.offset.position.x = runtime().script.eye_distance_m * (view % 2 == 0 ? -0.5f : 0.5f);
    return locate(head, space, time);
}

XrFovf fov_of(uint32_t view, XrTime time, bool follows_gaze) {
    const Script& script = runtime().script;
    if (view < 2) return script.fov[view];
    const XrFovf& still = script.narrow->fov[view - 2];
    if (!follows_gaze) return still;
    const XrPosef gaze = inverse(head_in_world(time).pose) * gaze_in_world(time).pose;
    const XrVector3f along = rotate(gaze.orientation, {0, 0, -1});
    const float right = std::atan2(along.x, -along.z), up = std::atan2(along.y, -along.z);
    const float half_width = (still.angleRight - still.angleLeft) / 2,
                half_height = (still.angleUp - still.angleDown) / 2;
    return {right - half_width, right + half_width, up + half_height, up - half_height};
}

std::vector<EntryPoint> space_entries() {
    return {NEUVV_XR_ENTRY(xrEnumerateReferenceSpaces, enumerate_spaces),
            NEUVV_XR_ENTRY(xrCreateReferenceSpace, create_reference_space),
            NEUVV_XR_ENTRY(xrGetReferenceSpaceBoundsRect, get_bounds),
            NEUVV_XR_ENTRY(xrCreateActionSpace, create_action_space),
            NEUVV_XR_ENTRY(xrLocateSpace, locate_space),
            NEUVV_XR_ENTRY(xrDestroySpace, destroy_space)};
}

}  // namespace neuvv::xr_runtime
