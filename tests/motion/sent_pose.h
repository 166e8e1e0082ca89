// Poses that tests send to a PoseSource.
#pragma once

#include <cmath>

#include "motion/live/pose_line.h"
#include "motion/live/pose_source.h"

namespace neuvv::pose_source_test {

using motion::Joint;
using motion::open_pose_source;
using motion::PoseSource;

inline uint16_t port_of(const PoseSource& source) {
    const std::string name = source.name();
    return static_cast<uint16_t>(std::stoul(name.substr(name.rfind(':') + 1)));
}

// A pose that is told by the place of its nose.
inline std::string line_of(double time_s, double x) {
    motion::TimedPose timed{time_s, {}};
    at(timed.pose, Joint::kNose) = {{x, 1.6, 0.1}, 1, true};
    return motion::pose_line(timed);
}

inline double nose_of(const std::optional<motion::TimedPose>& pose) {
    return pose ? at(pose->pose, Joint::kNose).position.x : NAN;
}

}  // namespace neuvv::pose_source_test
