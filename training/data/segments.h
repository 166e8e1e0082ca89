// Long clips are trained in segments: runs of a few frames, each a data set and a tree of its own. Memory, and the time
// after which a segment is good, then do not depend on the length of the clip.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// The times of a rig's shots, ascending, each once: one for each frame.
std::vector<double> times_of(const Rig& rig);

// Frame f of n should have the time f / (n − 1). Of a clip's times, ascending, this is the first that is more than
// `most` frames away from that; `at` is the frame, with a fraction, that has the time.
struct UnevenTime {
    uint32_t frame;
    double time, at;
};
std::optional<UnevenTime> uneven_time(const std::vector<double>& times, double most);

// Cuts a clip into segments of at most `longest` frames, whose lengths differ by one frame at most. Both are at
// least 1.
std::vector<uint32_t> segment_lengths(uint32_t frames, uint32_t longest);

// The rig in `count` frames from frame `first` on: those of its shots, with times from 0 to 1 over these frames, and
// those of its cameras that have any. `times` are those of the whole rig.
Rig rig_of_frames(const Rig& rig, const std::vector<double>& times, uint32_t first, uint32_t count);

}  // namespace neuvv::training
