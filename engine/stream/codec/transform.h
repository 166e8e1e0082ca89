// The transform of planes over an octree: a region-adaptive Haar transform, as that of G-PCC. A cell's value is the
// mean of its octants' values by weight, and each pair of halves has a coefficient, how far they lie apart. Most of
// these are small, and an error in one makes the same error of the whole image, whichever it is. The inverse goes
// together with the coding of the coefficients (planes.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/codec/octree.h"

namespace neuvv::stream {

// The pairs of halves of a cell, numbered as a heap: pair 1 divides the cell by z, 2 and 3 divide its halves by y, 4 to
// 7 theirs by x. Half 2n and half 2n + 1 are those of pair n; halves 8 to 15 are the octants 0 to 7. Where one half has
// no cells, there is no such pair.
constexpr size_t kPairs = 8;  // 0 is none

// Which pairs a cell has, by its children.
struct Splits {
    uint8_t count = 0;                  // of pairs: one less than the octants that are cells
    std::array<uint8_t, 7> pair{};      // their numbers, in order
    std::array<uint8_t, 7> above{};     // by pair, in that order: 0, or 1 more than the place of the pair above it
    std::array<uint8_t, 8> of_child{};  // the same of the cell's child r
    std::array<uint8_t, 8> octant{};    // of the cell's child r; 0 where there are fewer
};

constexpr std::array<Splits, 256> kSplits = [] {
    std::array<Splits, 256> all{};
    for (uint32_t children = 1; children < 256; ++children) {
        Splits& splits = all[children];
        std::array<bool, 16> has_cells{};
        for (uint32_t octant = 0; octant < 8; ++octant) has_cells[8 + octant] = children >> octant & 1;
        for (uint32_t n = 7; n > 0; --n) has_cells[n] = has_cells[2 * n] || has_cells[2 * n + 1];
        std::array<uint8_t, 16> above{};  // by half
        for (uint8_t n = 1; n < 8; ++n) {
            if (has_cells[2 * n] && has_cells[2 * n + 1]) {
                splits.pair[splits.count] = n;
                splits.above[splits.count++] = above[n];
                above[2 * n] = above[2 * n + 1] = splits.count;
            } else {
                above[2 * n] = above[2 * n + 1] = above[n];
            }
        }
        uint32_t child = 0;
        for (uint8_t octant = 0; octant < 8; ++octant)
            if (has_cells[8 + octant]) {
                splits.of_child[child] = above[8 + octant];
                splits.octant[child++] = octant;
            }
    }
    return all;
}();

// What a cell's pairs do with their coefficients; all is 0 where there is no pair.
struct alignas(16) CellPairs {
    std::array<float, kPairs> inverse_scale{};  // √(w / (w_a w_b)), w the weights of the two halves and of both
    std::array<float, kPairs> share_b{};        // w_b / w
};

// A leaf's area: 1 for the finest, 4 for the next.
double area_of(uint32_t depth, uint32_t finest);

// The pairs of all cells of a tree. A leaf's weight is its area, times its factor where there are any, in units of
// `unit`. Only the weights are kept: most of the finest cells have no coefficient, and need no pairs.
class Pairs {
  public:
    // Tree and factors must outlive it.
    explicit Pairs(const Octree& tree, std::span<const int32_t> factors = {}, double unit = 1);
    // Of a cell that is divided.
    CellPairs of(size_t depth, const Cell& cell) const;

  private:
    double leaf_weight(size_t leaf) const { return factors_.empty() ? 1 : factors_[leaf]; }
    const Octree& tree_;
    std::span<const int32_t> factors_;
    double unit_;
    std::vector<std::vector<double>> weights_;  // of the cells above the finest depth, by depth
};

// The coefficients of a plane, (b − a) / inverse_scale, and the mean of the root. There are kPairs for each cell that
// is divided: that of the root first, depth by depth, in each depth in order.
struct Coefficients {
    double root = 0;
    std::vector<std::array<double, kPairs>> values;  // 0 where there is no pair
};
// `factors` are those of the pairs.
Coefficients transform(const Octree& tree, const Pairs& pairs, std::span<const int32_t> factors,
                       std::span<const int16_t> leaves);

}  // namespace neuvv::stream
