// Losses of the device. A program answers each by making the device, and all that is on it, anew; but not for ever.
#pragma once

#include <fmt/format.h>

#include <deque>
#include <string>

#include "base/error.h"

namespace neuvv::editor {

class DeviceLosses {
  public:
    static constexpr size_t kMost = 3;
    static constexpr double kWithin_s = 60;

    // Notes a loss, or that the device could not be made anew. Throws RuntimeFailure, with the reason `why`, where
    // there were kMost others within the last kWithin_s.
    void note(const std::string& why, double now_s) {
        while (!times_s_.empty() && now_s - times_s_.front() > kWithin_s) times_s_.pop_front();
        if (times_s_.size() >= kMost)
            throw RuntimeFailure(
                fmt::format("the device was lost {} times within {} s: {}", times_s_.size() + 1, kWithin_s, why),
                Remedy::kAfterDeviceLosses);
        times_s_.push_back(now_s);
    }

  private:
    std::deque<double> times_s_;  // the earliest first
};

}  // namespace neuvv::editor
