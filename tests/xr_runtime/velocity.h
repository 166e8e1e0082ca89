// Velocities, as differences of scripted poses.
#pragma once

#include "pose.h"
#include "spaces.h"

namespace neuvv::xr_runtime {

// Along the axes of the base space, in m/s and rad/s.
struct Velocity {
    XrVector3f linear = {0, 0, 0}, angular = {0, 0, 0};
};

// The velocity of what `at` locates: a function from XrTime to Located.
template <typename At>
Velocity velocity(const At& at, XrTime time) {
    const XrDuration step = runtime().progress.period() / 4;
    const Located before = at(time - step), after = at(time + step);
    if (!before.is_valid || !after.is_valid) return {};
    const float per_second = 0.5e9f / static_cast<float>(step);
    XrQuaternionf turn = after.pose.orientation * conjugate(before.pose.orientation);
    if (turn.w < 0) turn = {-turn.x, -turn.y, -turn.z, -turn.w};
    const XrVector3f axis = {turn.x, turn.y, turn.z};
    const float sine = std::sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
    const float angle = 2 * std::atan2(sine, turn.w);
    return {(after.pose.position - before.pose.position) * per_second,
            axis * (sine > 0 ? angle / sine * per_second : 0)};
}

}  // namespace neuvv::xr_runtime
