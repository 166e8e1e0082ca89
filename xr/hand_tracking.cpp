#include "xr/hand_tracking.h"

#include <algorithm>

namespace neuvv::xr {

namespace {

constexpr double kApart_m = 0.05, kTouch_m = 0.015;

}  // namespace

HandTracking::HandTracking(const Session& session) : session_(session) {
    if (!session.runtime().supports(XR_EXT_HAND_TRACKING_EXTENSION_NAME)) return;
    destroy_ = session.runtime().function<PFN_xrDestroyHandTrackerEXT>("xrDestroyHandTrackerEXT");
    const auto create = session.runtime().function<PFN_xrCreateHandTrackerEXT>("xrCreateHandTrackerEXT");
    for (int hand = 0; hand < kHands; ++hand) {
        const XrHandTrackerCreateInfoEXT info{XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, nullptr,
                                              hand == kLeft ? XR_HAND_LEFT_EXT : XR_HAND_RIGHT_EXT,
                                              XR_HAND_JOINT_SET_DEFAULT_EXT};
        if (!succeeded(create(session.handle(), &info, &trackers_[hand]), "xrCreateHandTrackerEXT", "hand"))
            trackers_[hand] = XR_NULL_HANDLE;
    }
}

HandTracking::~HandTracking() {
    for (XrHandTrackerEXT tracker : trackers_)
        if (tracker != XR_NULL_HANDLE) destroy_(tracker);
}

void HandTracking::locate(XrTime time) {
    for (int hand = 0; hand < kHands; ++hand) {
        joints_[hand].clear();
        if (trackers_[hand] == XR_NULL_HANDLE) continue;
        std::array<XrHandJointLocationEXT, XR_HAND_JOINT_COUNT_EXT> found{};
        XrHandJointLocationsEXT locations{XR_TYPE_HAND_JOINT_LOCATIONS_EXT};
        locations.jointCount = XR_HAND_JOINT_COUNT_EXT;
        locations.jointLocations = found.data();
        const XrHandJointsLocateInfoEXT info{XR_TYPE_HAND_JOINTS_LOCATE_INFO_EXT, nullptr, session_.tracking_space(),
                                             time};
        constexpr const char* kCall = "xrLocateHandJointsEXT";
        const bool located =
            succeeded(session_.runtime().function<PFN_xrLocateHandJointsEXT>(kCall)(trackers_[hand], &info, &locations),
                      kCall, "hand");
        if (!located) continue;
        const bool all = std::all_of(found.begin(), found.end(), [](const XrHandJointLocationEXT& joint) {
            return joint.locationFlags & XR_SPACE_LOCATION_POSITION_VALID_BIT;
        });
        if (!locations.isActive || !all) continue;
        for (const XrHandJointLocationEXT& joint : found)
            joints_[hand].push_back({pose_of(joint.pose).position, joint.radius});
    }
}

double pinch_of(const HandJoints& joints) {
    if (joints.size() <= XR_HAND_JOINT_INDEX_TIP_EXT) return 0;
    const double apart_m =
        glm::distance(joints[XR_HAND_JOINT_THUMB_TIP_EXT].position, joints[XR_HAND_JOINT_INDEX_TIP_EXT].position);
    return std::clamp((kApart_m - apart_m) / (kApart_m - kTouch_m), 0.0, 1.0);
}

bool fill_from_joints(HandInput& input, const HandJoints& joints) {
    if (input.aim || input.bare_hand || joints.size() <= XR_HAND_JOINT_INDEX_TIP_EXT) return false;
    const glm::dvec3 wrist = joints[XR_HAND_JOINT_WRIST_EXT].position,
                     root = joints[XR_HAND_JOINT_INDEX_PROXIMAL_EXT].position;
    const glm::dvec3 ahead = root - wrist;
    if (glm::length(ahead) < 1e-3) return false;
    const glm::dvec3 up = std::abs(glm::normalize(ahead).y) < 0.95 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    input.aim = Pose{root, glm::quatLookAt(glm::normalize(ahead), up)};
    input.bare_hand = true;
    input.select = pinch_of(joints);
    input.has_grab = false;
    input.lacks_menu = true;
    return true;
}

}  // namespace neuvv::xr
