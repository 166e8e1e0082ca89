#include "tools/headset/standing.h"

#include <cmath>

namespace neuvv::headset {

StandingPlace first_place(const HeadsetState& state) {
    constexpr double kAway_m = 2.2;
    for (const stage::EvaluatedCamera& camera : state.evaluated.cameras) {
        if (camera.orthographic) continue;
        const glm::dvec3 at(camera.world_from_camera[3]), ahead = -glm::dvec3(camera.world_from_camera[2]);
        return {{at.x, state.floor_m, at.z}, std::atan2(-ahead.x, -ahead.z)};
    }
    const auto [low, high] = stage::performers_box(*state.stage, state.evaluated);
    return {{0.5 * (low.x + high.x), state.floor_m, high.z + kAway_m}, 0};
}

void stand_at(HeadsetState& state, const StandingPlace& place, const xr::Pose& head) {
    state.rig = xr::with_head_above({}, head, place.floor_point, place.yaw_rad);
    state.ahead_rad = place.yaw_rad;
}

void follow_tracking_change(HeadsetState& state, const xr::TrackingChange& change, const xr::Pose& before,
                            const xr::Pose& now) {
    if (!change.by_user && change.old_from_new) {
        state.rig = xr::in_new_space(state.rig, *change.old_from_new);
        return;
    }
    const xr::Pose was = xr::world_from_tracking(state.rig) * before;
    const glm::dvec3 below(was.position.x, state.rig.position.y, was.position.z);
    state.rig = xr::with_head_above(state.rig, now, below, change.by_user ? state.ahead_rad : xr::yaw_of(was.rotation));
}

}  // namespace neuvv::headset
