// The device's clock, which its timestamps come from, beside the host's: for traces alone.
#pragma once

#include <algorithm>
#include <limits>
#include <mutex>
#include <optional>

#include "base/trace_file.h"

namespace neuvv::gpu {

// The host sees the end of a submission a little late, never early: the least delay that was seen in this second and
// the one before is taken as none. So spans of the device may be shown some microseconds late, those of the first
// submissions more. Any thread may call its functions.
class DeviceClock {
  public:
    using Ticks = std::chrono::duration<double, std::nano>;

    // The host knows at `seen` that the device's clock has passed `at`, in nanoseconds.
    void learn(Ticks at, TraceClock::time_point seen) {
        const std::lock_guard lock(mutex_);
        const Ticks delay = seen.time_since_epoch() - at;
        if (seen - began_ > std::chrono::seconds(1)) {  // the clocks drift
            before_ = offset_.value_or(delay);
            offset_.reset();
            began_ = seen;
        }
        offset_ = std::min(offset_.value_or(delay), delay);
    }
    TraceClock::time_point host_time(Ticks at) const {
        const std::lock_guard lock(mutex_);
        const Ticks offset = std::min(offset_.value_or(Ticks(0)), before_);
        return TraceClock::time_point(std::chrono::duration_cast<TraceClock::duration>(at + offset));
    }

  private:
    mutable std::mutex mutex_;
    TraceClock::time_point began_;
    std::optional<Ticks> offset_;                            // since began_
    Ticks before_{std::numeric_limits<double>::infinity()};  // in the second before
};

}  // namespace neuvv::gpu
