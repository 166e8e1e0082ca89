#include "tools/headset/wearer.h"

namespace neuvv::headset {

std::optional<motion::Pose> WearerBody::locate(const xr::HandInputs& inputs, const std::optional<xr::Pose>& head,
                                               const xr::XrRig& rig, XrTime time) const {
    xr::BodyPoints points;
    points.head = head;
    for (const int hand : {xr::kLeft, xr::kRight})
        points.wrists[hand] = xr::wrist_of(inputs[hand], hands_.joints(hand));
    points.trackers = actions_.locate_trackers(time);
    std::optional<motion::Pose> pose = tracker_.locate(points, time);
    if (!pose) return pose;
    const xr::Pose world = xr::world_from_tracking(rig);
    for (motion::JointSample& joint : *pose)
        if (joint.confidence > 0) joint.position = world * joint.position;
    return pose;
}

}  // namespace neuvv::headset
