#include "render/clips/frame_pace.h"

#include <algorithm>
#include <cmath>

namespace neuvv::render {

void FramePace::learn(const stream::DecodeTimes& decoded, double upload_s) {
    const std::lock_guard lock(mutex_);
    if (decoded.shapes > 0) ladder_.learn_step(FrameStep::kShape, decoded.shapes_s / decoded.shapes);
    if (decoded.plane_bytes > 0) ladder_.learn_planes(decoded.plane_bytes, decoded.planes_s);
    ladder_.learn_step(FrameStep::kUpload, upload_s);
}

void FramePace::learn_arrival(double seconds) {
    constexpr double kNew = 0.15, kNewDeviation = 0.25;
    const std::lock_guard lock(mutex_);
    if (arrival_s_ == 0) {
        arrival_s_ = seconds;
        return;
    }
    deviation_s_ += kNewDeviation * (std::abs(seconds - arrival_s_) - deviation_s_);
    arrival_s_ += kNew * (seconds - arrival_s_);
}

stream::Part FramePace::part_in_time(const stream::GroupCost& group, std::optional<double> bytes_per_s, double now_s) {
    const std::lock_guard lock(mutex_);
    std::erase_if(chosen_, [&](const Chosen& one) { return now_s > one.until_s; });
    for (const Chosen& one : chosen_)
        if (one.group == group.number) return one.last;
    const stream::Part last = ladder_.choose(group, bytes_per_s);
    chosen_.push_back({group.number, last, now_s + kLeastChoice_s + 2 * group.seconds});
    return last;
}

double FramePace::lead_s() const {
    const std::lock_guard lock(mutex_);
    return std::min(arrival_s_ + 2 * deviation_s_, kMostLead_s);
}

}  // namespace neuvv::render
