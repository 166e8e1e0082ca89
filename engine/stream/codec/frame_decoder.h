// The bytes of a frame as a slice, in two steps: a frame's shape needs that of the frame before, but its planes need
// those of the frame before only where it repeats some. So the planes of several frames can be decoded at the same
// time, and those of a frame that is only passed over need not be decoded.
#pragma once

#include <span>

#include "stream/codec/coarser.h"
#include "stream/codec/frame_codec.h"
#include "stream/codec/repeats.h"

namespace neuvv::stream {

constexpr uint32_t kMaxStreamLeaves = 1u << 24;  // of a frame

// What a frame is decoded by: the same for all frames of a group.
struct Format {
    uint32_t depth = 2, degree = 0;
    uint32_t most_leaves = 0;  // of a frame
};

// What the part kShape says.
struct FrameShape {
    bool is_key = true;
    Steps steps{};
    std::vector<int16_t> roots;  // by plane: the mean of the root
    Octree tree;                 // of the leaves that are not repeated; empty where there are none
    std::vector<bool> repeats;   // which blocks of the frame before
    MergedLeaves merged;         // all leaves
};

// Decodes the part kShape. `before` are the leaves of the frame before, which a key frame does not need; null: there is
// none. Throws std::runtime_error with what is wrong where the bytes are no shape, as decode_planes() does.
FrameShape decode_shape(std::span<const uint8_t> bytes, const Tables& tables, const Format& format,
                        const std::vector<Leaf>* before);

// The bytes of the parts that there are, from kShape on. That one's are not read.
using PartBytes = std::array<std::span<const uint8_t>, kParts>;

// The streams of planes as far as they are there, up to those of the part `last`.
struct PlaneStreams {
    Part last = kShape;
    std::vector<std::span<const uint8_t>> coarse, fine;  // by plane
    bool may_end_early = false;  // a stream may be cut: the coefficients that are not there are 0
};
// Those of the parts after kShape up to `last`. Throws std::runtime_error where the bytes are no parts.
PlaneStreams plane_streams(const PartBytes& bytes, Part last, const Format& format);

// The planes of all leaves. `before` is the frame before, decoded from as many parts; it is not read where the frame
// repeats nothing of it. Planes of colours are decoded `in_parts`.
Planes decode_planes(const FrameShape& shape, const PlaneStreams& streams, const Tables& tables, const Format& format,
                     const QuantisedSlice* before, const InParts& in_parts = in_one_part);

// The same with larger leaves, of which there are fewer: those of the finest `levels` depths become one with their
// siblings. They get what the parts up to kShCoarse say; others are not read. `levels`: 1 to kMostCoarser, less than
// the format's depth. `before` is the frame before with as large leaves.
// Throws std::runtime_error as decode_planes() does.
QuantisedSlice decode_coarser(const FrameShape& shape, PlaneStreams streams, const Tables& tables, const Format& format,
                              uint32_t levels, const QuantisedSlice* before);

// Both steps, from the bytes of all parts one after the other.
QuantisedSlice decode(const FrameBytes& frame, Part last, const Tables& tables, const Format& format,
                      const QuantisedSlice* before);

}  // namespace neuvv::stream
