// The ladder: how many parts of its frames a player takes, so that they are there in time. A stream has all of its
// rates in one file, as every prefix of a group's parts draws.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>

#include "stream/frame_codec.h"

namespace neuvv::stream {

// What a group of frames costs.
struct GroupCost {
    std::array<uint64_t, kParts> bytes_until{};  // of all of its frames, up to each part
    double seconds = 1;                          // for which it is shown
};

// Learns how long decoding planes takes, and chooses by that and by how fast bytes come. Any thread may call its
// functions.
class Ladder {
  public:
    // A frame's parts of so many bytes were decoded in so many seconds.
    void learn(uint64_t bytes, double seconds);
    // The last part up to which the frames come at their rate, at least kCoarse. `bytes_per_s`: as they come from a
    // server; nothing where they are here.
    Part choose(const GroupCost& group, std::optional<double> bytes_per_s) const;

    // Of the time that there is, so much may be needed: what is measured varies.
    static constexpr double kShare = 0.8;

  private:
    mutable std::mutex mutex_;
    double bytes_ = 0, seconds_ = 0;  // of the frames that were decoded last: older ones count less
};

}  // namespace neuvv::stream
