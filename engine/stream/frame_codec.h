// A frame of a stream as bytes. A key frame is decoded alone; another may also repeat parts of the frame before it.
#pragma once

#include <array>
#include <optional>

#include "stream/planes.h"
#include "stream/slice.h"

namespace neuvv::stream {

// What coefficients are rounded to, in units of 1 / kUnit of a plane's values at an opaque leaf of the finest depth.
using Steps = std::array<uint16_t, kKinds>;  // by Kind

// The parts of a frame's bytes, in their order. Every prefix that ends with a part draws: where fine parts are missing,
// leaves have the mean of larger cells; where those of spherical harmonics are, colours are the same from all sides.
enum Part : uint32_t { kShape, kCoarse, kFine, kShCoarse, kShFine, kParts };

// A frame as symbols: tables for all frames of a group come first.
struct FrameSymbols {
    bool is_key = true;
    uint32_t leaf_count = 0;  // that are not repeated
    Steps steps{};
    std::vector<int16_t> roots;  // by plane: the mean of the root
    SymbolWriter shape;
    std::vector<SymbolWriter> coarse, fine;  // by plane
};

// The frame before the one that is encoded: as it was, and as it is decoded.
struct FrameBefore {
    const Slice& slice;
    const Slice& decoded;
};

// Encodes a slice, without a frame before it as a key frame. Blocks of 4³ finest cells that are the same in the frame
// before, or differ by less than rounding does, are repeated. `decoded` becomes what decode() returns.
FrameSymbols encode(const Slice& slice, const Steps& steps, const std::optional<FrameBefore>& before, Slice& decoded);
void count(const FrameSymbols& frame, Counts& counts);

struct FrameBytes {
    std::vector<uint8_t> bytes;
    std::array<uint32_t, kParts> ends;  // of the parts
};
FrameBytes bytes_of(const FrameSymbols& frame, const Tables& tables);

// What a frame is decoded by: the same for all frames of a group.
struct Format {
    uint32_t depth = 2, degree = 0;
    uint32_t most_leaves = 0;  // of a frame
};

// Decodes the frame, or what its first parts show. `before` is the frame before, decoded from as many parts; null where
// the frame is a key frame. Throws std::runtime_error with what is wrong where the bytes are no frame.
Slice decode(std::span<const uint8_t> bytes, Part last, const Tables& tables, const Format& format,
             const Slice* before);

}  // namespace neuvv::stream
