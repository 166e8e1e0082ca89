#include "stream/ladder.h"

#include <algorithm>
#include <thread>

namespace neuvv::stream {

namespace {

constexpr double kNew = 0.1;  // how much the newest measurement counts

// So many frames are decoded at the same time. Cores that draw, and make trees of what was decoded, are left out.
double frames_at_once() {
    return std::clamp(std::thread::hardware_concurrency() / 2, 1u, 4u);
}

}  // namespace

void Ladder::learn(uint64_t bytes, double seconds) {
    if (bytes == 0) return;
    const std::lock_guard lock(mutex_);
    const double one = seconds / static_cast<double>(bytes);
    seconds_per_byte_ = seconds_per_byte_ ? *seconds_per_byte_ + kNew * (one - *seconds_per_byte_) : one;
}

Part Ladder::choose(const GroupCost& group, std::optional<double> bytes_per_s) const {
    const std::lock_guard lock(mutex_);
    const auto comes_in_time = [&](Part last) {
        const auto bytes = static_cast<double>(group.bytes_until[last]);
        const double until_s = kShare * group.seconds;
        return (!bytes_per_s || bytes <= *bytes_per_s * until_s) &&
               (!seconds_per_byte_ || bytes * *seconds_per_byte_ <= frames_at_once() * until_s);
    };
    for (const Part last : {kShFine, kFine, kShCoarse})
        if (comes_in_time(last)) return last;
    return kCoarse;
}

}  // namespace neuvv::stream
