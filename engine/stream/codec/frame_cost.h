// What frames of a stream cost: the seconds that decoding takes, and the bytes that have to come.
#pragma once

#include <array>
#include <cstdint>

#include "stream/codec/frame_codec.h"

namespace neuvv::stream {

// What decoding a frame took, where it was not decoded already: the shapes of it and of those before it that it needs,
// and its planes of so many bytes.
struct DecodeTimes {
    uint32_t shapes = 0;
    double shapes_s = 0, planes_s = 0;
    uint64_t plane_bytes = 0;
};

// What a group of frames costs.
struct GroupCost {
    std::array<uint64_t, kParts> bytes_until{};  // of all of its frames, up to each part
    uint32_t frames = 1;
    double seconds = 1;   // for which it is shown
    uint32_t number = 0;  // of the group
};

}  // namespace neuvv::stream
