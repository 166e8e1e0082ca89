#include "motion/live/pose_stream.h"

#include <utility>

namespace neuvv::motion {

namespace {

constexpr double kStops_s = 1;
// Poses that seem to be older than this come from a clock that was set or runs slowly.
constexpr double kOldest_s = 0.25;

}  // namespace

bool PoseStream::stopped(double now_s) const {
    return now_s - arrived_s_ > kStops_s;
}

void PoseStream::add_untimed(const Pose& pose, double now_s, uint64_t count) {
    newest_ = {now_s, pose};
    arrived_s_ = now_s;
    state_.poses += count;
}

void PoseStream::add(const TimedPose& sent, double now_s) {
    const bool resumes = stopped(now_s);
    if (!resumes && !(sent.time_s > sent_s_)) return leave_out("a pose's time is not after that of the pose before it");
    // Some poses wait on their way: the one that waited least tells how the clocks differ.
    const double age_s = now_s - (sent.time_s + now_from_sent_s_);
    if (resumes || age_s < 0 || age_s > kOldest_s) now_from_sent_s_ = now_s - sent.time_s;
    sent_s_ = sent.time_s;
    add_untimed(sent.pose, now_s, 1);
    newest_->time_s = sent.time_s + now_from_sent_s_;
}

void PoseStream::leave_out(std::string_view error) {
    if (state_.left_out++ == 0) state_.first_error = error;
}

void PoseStream::forget_sender() {
    sent_s_ = -INFINITY;
    now_from_sent_s_ = 0;
}

std::optional<TimedPose> PoseStream::take(double now_s) {
    now_s_ = now_s;
    return std::exchange(newest_, std::nullopt);
}

PoseSourceState PoseStream::state() const {
    PoseSourceState state = state_;
    state.stopped = ended_ || (state.poses > 0 && stopped(now_s_));
    return state;
}

}  // namespace neuvv::motion
