// Poses as lines of JSON, as a program that follows a body writes them: one line a pose.
#pragma once

#include <optional>
#include <string>

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

struct TimedPose {
    double time_s = 0;
    Pose pose;
    std::string person{};  // whose pose it is, where the program says so
};

constexpr size_t kLongestPoseLine = 1 << 16;

// Reads {"time": seconds, "joints": {"left_wrist": [x, y, z], "nose": [x, y, z, confidence], ...}}: metres, +Y up,
// names as in joints.h. Joints that are missing are unknown, those without a confidence certain; all of them count as
// measured but those that a list "estimated" names. Throws InputError with `stream` and the place, for names that are
// not known and for what is not finite, too. A "person", a text or a whole number, tells several bodies apart.
TimedPose read_pose_line(const std::string& line, const std::string& stream);
// The same, written; joints that are unknown are left out. There is no line break at the end.
std::string pose_line(const TimedPose& pose);

// Of a stream with the poses of several persons, those of the first one count.
class FirstPerson {
  public:
    // Throws InputError with `stream` where the pose is another person's, unless the first one's last pose is long
    // past.
    void expect(const TimedPose& pose, const std::string& stream);

  private:
    std::optional<std::string> first_;
    double seen_s_ = 0;  // on the sender's clock
};

}  // namespace neuvv::motion
