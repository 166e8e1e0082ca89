#include "tools/headset/headset_state.h"

#include <cmath>

namespace neuvv::headset {

xr::XrRig initial_rig(const HeadsetState& state, const xr::Pose& head) {
    constexpr double kAway_m = 2.2;
    const auto [low, high] = stage::performers_box(*state.stage, state.evaluated);
    const glm::dvec3 middle = 0.5 * (low + high);
    glm::dvec3 stands(middle.x, state.floor_m, high.z + kAway_m);
    double yaw = 0;
    for (const stage::EvaluatedCamera& camera : state.evaluated.cameras) {
        if (camera.orthographic) continue;
        const glm::dvec3 at(camera.world_from_camera[3]), ahead = -glm::dvec3(camera.world_from_camera[2]);
        stands = {at.x, state.floor_m, at.z};
        yaw = std::atan2(-ahead.x, -ahead.z);
        break;
    }
    return xr::with_head_above({}, head, stands, yaw);
}

}  // namespace neuvv::headset
