// The transform of planes over an octree: a region-adaptive Haar transform, as that of G-PCC. A cell's value is the
// mean of its octants' values by weight, and each pair of halves has a coefficient, how far they lie apart. Most of
// these are small, and an error in one makes the same error of the whole image, whichever it is. The inverse goes
// together with the coding of the coefficients (planes.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/octree.h"

namespace neuvv::stream {

// How a cell is divided into its octants: into halves by z, these by y, these by x, where both halves have cells; a
// value stands for a half, or for both where the other is empty. Values are kept in a list, in which the cell's own
// comes first. Split k takes the value at from[k], which becomes that of the first half, and appends that of the
// second. At the end, the value of the cell's child r is at order[r].
struct Splits {
    uint8_t count = 0;  // one less than the octants
    std::array<uint8_t, 7> from{};
    std::array<uint8_t, 8> order{};
};

// By which octants are cells.
constexpr std::array<Splits, 256> kSplits = [] {
    std::array<Splits, 256> all{};
    for (uint32_t children = 1; children < 256; children++) {
        Splits& splits = all[children];
        std::array<uint8_t, 8> place{};  // in the list, of the value for the octants from each one on
        for (uint32_t s = 4; s > 0; s /= 2)
            for (uint32_t i = 0; i < 8; i += 2 * s) {
                const uint32_t half = (1u << s) - 1;
                if (!(children >> (i + s) & half)) continue;
                place[i + s] = place[i];
                if (!(children >> i & half)) continue;
                splits.from[splits.count++] = place[i];
                place[i + s] = splits.count;
            }
        uint32_t child = 0;
        for (uint32_t octant = 0; octant < 8; octant++)
            if (children >> octant & 1) splits.order[child++] = place[octant];
    }
    return all;
}();

// Two halves of a cell that are split.
struct Pair {
    float inverse_scale = 0;  // of the coefficient: √(w / (w_a w_b))
    float share_b = 0;        // w_b / w
};

// All pairs, one less than leaves: those of the root first, depth by depth, in each depth in order of cells, in each
// cell in order of splits.
using Pairs = std::vector<Pair>;

// The pairs of a tree by the weights of its leaves, which must be whole numbers, in units of `unit`.
Pairs pairs_of(const Octree& tree, const std::vector<double>& weights, double unit);
// The same where the weights are areas, in units of 1.
Pairs pairs_of_areas(const Octree& tree, const std::vector<double>& areas);

// The area of each leaf as a weight: 1 for the finest, 4 for the next.
std::vector<double> areas_of(const std::vector<Leaf>& leaves, uint32_t depth);

// The coefficients of a plane, (b − a) / inverse_scale by pair, and the mean of the root.
struct Coefficients {
    double root = 0;
    std::vector<double> values;
};
Coefficients transform(const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                       std::span<const int16_t> leaves);

}  // namespace neuvv::stream
