#include "stream/transport/ladder.h"

#include <algorithm>
#include <thread>

namespace neuvv::stream {

uint32_t frames_at_once() {
    return std::clamp(std::thread::hardware_concurrency() / 2, 1u, 8u);
}

void Ladder::Mean::add(double count, double seconds) {
    constexpr double kOlder = 0.9;  // what was added before counts after this
    count_ = kOlder * count_ + count;
    seconds_ = kOlder * seconds_ + seconds;
}

void Ladder::learn_planes(uint64_t bytes, double seconds) {
    const std::lock_guard lock(mutex_);
    planes_.add(static_cast<double>(bytes), seconds);
}

void Ladder::learn_step(FrameStep step, double seconds) {
    const std::lock_guard lock(mutex_);
    steps_[static_cast<size_t>(step)].add(1, seconds);
}

Part Ladder::choose(const GroupCost& group, std::optional<double> bytes_per_s) const {
    const std::lock_guard lock(mutex_);
    double steps_s = 0;
    for (const Mean& step : steps_) steps_s += group.frames * step.value();
    const auto comes_in_time = [&](Part last) {
        const auto bytes = static_cast<double>(group.bytes_until[last]);
        const double until_s = kShare * group.seconds;
        return (!bytes_per_s || bytes <= *bytes_per_s * until_s) &&
               steps_s + bytes * planes_.value() <= frames_at_once() * until_s;
    };
    for (const Part last : {kShFine, kFine, kShCoarse})
        if (comes_in_time(last)) return last;
    return kCoarse;
}

}  // namespace neuvv::stream
