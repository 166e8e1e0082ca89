#include "motion/live/one_euro.h"

#include <numbers>

namespace neuvv::motion {

namespace {

// The share of a new value in the filtered one.
double share_of(double cutoff_hz, double step_s) {
    return 1 / (1 + 1 / (2 * std::numbers::pi * cutoff_hz * step_s));
}

}  // namespace

Pose PoseFilter::filter(const Pose& pose, double time_s) {
    Pose result = pose;
    for (size_t j = 0; j < kJoints; ++j) {
        if (!(pose[j].confidence > 0)) continue;
        State& state = joints_[j];
        const double step_s = time_s - state.time_s;
        if (!state.known || step_s > settings_.forget_s) {
            state = {true, time_s, pose[j].position, glm::dvec3(0)};
        } else if (step_s > 0) {
            const glm::dvec3 speed = (pose[j].position - state.position) / step_s;
            state.speed = glm::mix(state.speed, speed, share_of(settings_.speed_hz, step_s));
            const double cutoff_hz = settings_.rest_hz + settings_.hz_per_metre_s * glm::length(state.speed);
            state.position = glm::mix(state.position, pose[j].position, share_of(cutoff_hz, step_s));
            state.time_s = time_s;
        }
        result[j].position = state.position;
    }
    return result;
}

}  // namespace neuvv::motion
