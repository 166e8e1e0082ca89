// A frame of a stream as bytes (frame_decoder.h is the way back). A key frame is decoded alone; another may also repeat
// parts of the frame before it.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <utility>

#include "stream/codec/planes.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::stream {

// What coefficients are rounded to, in units of 1 / kUnit of a plane's values at an opaque leaf of the finest depth.
using Steps = std::array<uint16_t, kKinds>;  // by Kind

// The parts of a frame's bytes, in their order: what shows most for its bytes comes first. Every prefix that ends with
// a part draws: where fine parts are missing, leaves have the mean of larger cells; where those of spherical harmonics
// are, colours are the same from all sides.
enum Part : uint32_t { kShape, kCoarse, kShCoarse, kFine, kShFine, kParts };

// What weighs a leaf's colours: its area times this factor: how opaque it is, but kLeastOpacity at least.
constexpr int16_t kLeastOpacity = 20;
std::vector<int32_t> colour_factors_of(const std::vector<int16_t>& opacity);

// The first of the planes whose streams a part has, and the end; `planes` are all.
constexpr std::pair<uint32_t, uint32_t> planes_of_part(Part part, uint32_t planes) {
    if (part == kCoarse || part == kFine) return {0, kPlanesOfMean};
    return {kPlanesOfMean, planes};
}

// Runs run(begin, end) for parts of [0, count), at the same time where the caller has threads for it: parts of at most
// `grain`, or one of all.
using InParts =
    std::function<void(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& run)>;
void in_one_part(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& run);

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
    const QuantisedSlice& slice;
    const QuantisedSlice& decoded;
};

// A key frame may take so many times the bytes of the same frame with repeats: it is decoded without any others, so
// players get there at once, and may leave out those before it. Few repeats save nothing at all, because what is left
// of the shape is less regular.
constexpr double kKeyWorth = 1.05;

// Encodes a slice: as a key frame, or, where there is a frame before it, with repeats of that one if this takes fewer
// bytes (kKeyWorth). Blocks of 4³ finest cells that are the same there, or differ by less than rounding does, are
// repeated. `decoded` becomes what decode() returns. Planes are encoded `in_parts`.
FrameSymbols encode(const QuantisedSlice& slice, const Steps& steps, const std::optional<FrameBefore>& before,
                    QuantisedSlice& decoded, const InParts& in_parts = in_one_part);
void count(const FrameSymbols& frame, Counts& counts);

struct FrameBytes {
    std::array<std::vector<uint8_t>, kParts> parts;
};
FrameBytes bytes_of(const FrameSymbols& frame, const Tables& tables);

}  // namespace neuvv::stream
