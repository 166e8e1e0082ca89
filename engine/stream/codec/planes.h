// The coefficients of planes as symbols, and the values of leaves that they make. What a pair's coefficient is likely
// to be depends on those of the larger cells around it: where these were large, there is detail.
#pragma once

#include <span>
#include <vector>

#include "stream/codec/octree.h"
#include "stream/codec/symbols.h"
#include "stream/codec/transform.h"

namespace neuvv::stream {

// Kinds of planes have tables and a step of their own.
enum Kind : uint32_t { kOpacity, kLuma, kOrange, kGreen, kShLuma, kShChroma };
constexpr Kind kind_of(uint32_t plane) {
    if (plane <= 3) return static_cast<Kind>(plane);
    return (plane - 1) % 3 == 0 ? kShLuma : kShChroma;
}

// The nearest whole number that a plane can have.
int16_t rounded_value(float value, uint32_t plane);

// A plane of an octree's leaves, by its number among the planes of a slice.
struct PlaneOfTree {
    uint32_t number = 0;
    float root = 0, step = 1;
    // Of a writer: the numbers of the pairs of all cells that are divided: coefficients in steps.
    std::span<const std::array<int16_t, kPairs>> numbers{};
    std::span<int16_t> leaves{};  // receives the values
};

// Codes planes of the same tree, and sets the values of its leaves, which are what a reader gets. Each plane has a
// stream in `coarse`, and in `fine` one of the pairs of the finest cells. `Coder` is a SymbolWriter or a SymbolReader;
// a reader may have no streams of one kind or both: their numbers are 0. So are those behind the end of a stream that
// is cut. `finest` is the depth of the stream's tree. A reader's tree may end above it (coarser.h): its leaves get what
// these cells have in the stream. What is rounded, and in which order, is part of the format: all numbers are 32-bit
// floats, and no two operations may become one. Throws std::runtime_error where a cell's coefficients are all 0 but
// should not be.
template <typename Coder>
void code_planes(std::span<Coder> coarse, std::span<Coder> fine, const Octree& tree, const Pairs& pairs,
                 uint32_t finest, std::span<const PlaneOfTree> planes);

}  // namespace neuvv::stream
