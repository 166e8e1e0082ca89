// What live sources of poses have in common: the newest pose, its time, and what to tell of the stream.
#pragma once

#include <cmath>
#include <string_view>

#include "motion/live/pose_source.h"

namespace neuvv::motion {

// All functions take the caller's clock, seconds.
class PoseStream {
  public:
    // A pose without a time of its own; `count` poses have come since the last call.
    void add_untimed(const Pose& pose, double now_s, uint64_t count);
    // A pose with the time of its sender's clock. It is left out where that is not after the last pose's, unless the
    // stream had stopped.
    void add(const TimedPose& sent, double now_s);
    // Something that is no pose, or not of this stream. `error` is one line.
    void leave_out(std::string_view error);
    void end() { ended_ = true; }
    // Another sender, with another clock, may go on.
    void forget_sender();

    // The newest pose since the last call.
    std::optional<TimedPose> take(double now_s);
    PoseSourceState state() const;

  private:
    bool stopped(double now_s) const;

    PoseSourceState state_;
    std::optional<TimedPose> newest_;
    double now_s_ = -INFINITY, arrived_s_ = -INFINITY;  // the last call of take(); the last pose
    double sent_s_ = -INFINITY;                         // the last pose, on its sender's clock
    double now_from_sent_s_ = 0;                        // the least that poses took, and what their clocks differ by
    bool ended_ = false;
};

}  // namespace neuvv::motion
