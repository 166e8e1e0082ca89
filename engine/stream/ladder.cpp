#include "stream/ladder.h"

#include <algorithm>
#include <thread>

namespace neuvv::stream {

namespace {

constexpr double kOlder = 0.9;  // what a frame counts after the next

// So many frames are decoded at the same time. Cores that draw, and make trees of what was decoded, are left out.
double frames_at_once() {
    return std::clamp(std::thread::hardware_concurrency() / 2, 1u, 4u);
}

}  // namespace

void Ladder::learn(uint64_t bytes, double seconds) {
    const std::lock_guard lock(mutex_);
    bytes_ = kOlder * bytes_ + static_cast<double>(bytes);
    seconds_ = kOlder * seconds_ + seconds;
}

Part Ladder::choose(const GroupCost& group, std::optional<double> bytes_per_s) const {
    const std::lock_guard lock(mutex_);
    const auto comes_in_time = [&](Part last) {
        const auto bytes = static_cast<double>(group.bytes_until[last]);
        const double until_s = kShare * group.seconds;
        return (!bytes_per_s || bytes <= *bytes_per_s * until_s) &&
               (bytes_ <= 0 || bytes * (seconds_ / bytes_) <= frames_at_once() * until_s);
    };
    for (const Part last : {kShFine, kFine, kShCoarse})
        if (comes_in_time(last)) return last;
    return kCoarse;
}

}  // namespace neuvv::stream
