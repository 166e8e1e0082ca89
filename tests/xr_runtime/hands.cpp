// XR_EXT_hand_tracking: open hands at the grip poses, whose fingers never bend.
#include <array>

#include "call.h"
#include "pose.h"
#include "spaces.h"
#include "velocity.h"

namespace neuvv::xr_runtime {

namespace {

struct Joint {
    XrVector3f at;  // of a right hand, relative to the grip pose: fingers along -Z, thumb towards -X
    float radius_m;
};

// The joints of the finger at `x`, from metacarpal to tip.
void add_finger(std::vector<Joint>& joints, float x, float length_m, int count) {
    for (int i = 0; i < count; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(count - 1);
        joints.push_back(
            {{x * (0.5f + 0.5f * t), 0.01f - 0.01f * t, 0.03f - (0.03f + length_m) * t}, 0.012f - 0.005f * t});
    }
}

std::vector<Joint> right_hand() {
    std::vector<Joint> joints = {{{0, 0, 0}, 0.02f}, {{0, 0, 0.07f}, 0.025f}};
    add_finger(joints, -0.06f, 0.03f, 4);
    add_finger(joints, -0.03f, 0.10f, 5);
    add_finger(joints, -0.01f, 0.11f, 5);
    add_finger(joints, 0.01f, 0.10f, 5);
    add_finger(joints, 0.03f, 0.08f, 5);
    return joints;
}

Located joint_in_world(Hand hand, const Joint& joint, XrTime time) {
    const Located grip = hand_in_world(hand, false, time);
    const float side = hand == kLeft ? -1.0f : 1.0f;
    const XrPosef offset = {{0, 0, 0, 1}, {joint.at.x * side, joint.at.y, joint.at.z}};
    return {grip.pose * offset, grip.is_valid};
}

XrResult create_tracker(XrSession handle, const XrHandTrackerCreateInfoEXT* create_info, XrHandTrackerEXT* out) {
    Session& session = object<Session>(handle);
    const XrHandTrackerCreateInfoEXT& info = checked(create_info);
    check_pointer(out, "handTracker");
    require(info.hand == XR_HAND_LEFT_EXT || info.hand == XR_HAND_RIGHT_EXT, XR_ERROR_VALIDATION_FAILURE, "enum",
            "hand is no XrHandEXT");
    require(info.handJointSet == XR_HAND_JOINT_SET_DEFAULT_EXT, XR_ERROR_VALIDATION_FAILURE, "enum",
            "handJointSet is no XrHandJointSetEXT");
    require(runtime().script.has_hand_joints, XR_ERROR_FEATURE_UNSUPPORTED, "hand-tracking",
            "XrSystemHandTrackingPropertiesEXT.supportsHandTracking is false");
    const auto tracker = make_object<HandTracker>();
    tracker->session = &session;
    tracker->hand = info.hand == XR_HAND_LEFT_EXT ? kLeft : kRight;
    *out = tracker->handle;
    return XR_SUCCESS;
}

XrResult destroy_tracker(XrHandTrackerEXT handle) {
    shared<HandTracker>(handle);
    forget(bits(handle));
    return XR_SUCCESS;
}

XrResult locate_joints(XrHandTrackerEXT handle, const XrHandJointsLocateInfoEXT* locate_info,
                       XrHandJointLocationsEXT* out) {
    const HandTracker& tracker = object<HandTracker>(handle);
    const XrHandJointsLocateInfoEXT& info = checked(locate_info);
    XrHandJointLocationsEXT& locations = checked(out);
    const Space& base = object<Space>(info.baseSpace);
    check_time(info.time);
    static const std::vector<Joint> kJoints = right_hand();
    require(locations.jointCount == kJoints.size(), XR_ERROR_VALIDATION_FAILURE, "joint-count",
            "jointCount must be XR_HAND_JOINT_COUNT_EXT");
    check_pointer(locations.jointLocations, "jointLocations");
    auto* speeds = const_cast<XrHandJointVelocitiesEXT*>(chained<XrHandJointVelocitiesEXT>(out));
    if (speeds)
        require(speeds->jointCount == kJoints.size() && speeds->jointVelocities, XR_ERROR_VALIDATION_FAILURE,
                "joint-count", "XrHandJointVelocitiesEXT.jointCount must be XR_HAND_JOINT_COUNT_EXT");
    bool is_active = false;
    for (size_t i = 0; i < kJoints.size(); ++i) {
        auto at = [&](XrTime time) {
            const Located joint = joint_in_world(tracker.hand, kJoints[i], time), origin = space_in_world(base, time);
            return Located{inverse(origin.pose) * joint.pose, joint.is_valid && origin.is_valid};
        };
        const Located located = at(info.time);
        is_active = is_active || located.is_valid;
        locations.jointLocations[i] = {located.is_valid ? kAllFlags : 0,
                                       located.is_valid ? located.pose : kIdentityPose, kJoints[i].radius_m};
        if (!speeds) continue;
        const Velocity speed = velocity(at, info.time);
        speeds->jointVelocities[i] = {located.is_valid ? XrSpaceVelocityFlags{3} : 0, speed.linear, speed.angular};
    }
    locations.isActive = is_active ? XR_TRUE : XR_FALSE;
    return XR_SUCCESS;
}

}  // namespace

std::vector<EntryPoint> hand_entries() {
    constexpr const char* kHands = XR_EXT_HAND_TRACKING_EXTENSION_NAME;
    return {NEUVV_XR_ENTRY_OF(kHands, nullptr, xrCreateHandTrackerEXT, create_tracker),
            NEUVV_XR_ENTRY_OF(kHands, nullptr, xrDestroyHandTrackerEXT, destroy_tracker),
            NEUVV_XR_ENTRY_OF(kHands, nullptr, xrLocateHandJointsEXT, locate_joints)};
}

}  // namespace neuvv::xr_runtime
