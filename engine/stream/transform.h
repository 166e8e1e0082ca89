// The transform of planes over an octree: a region-adaptive Haar transform, as that of G-PCC. A cell's value is the
// mean of its octants' values by weight, and each pair of halves has a coefficient, how far they lie apart. Most of
// these are small, and an error in one makes the same error of the whole image, whichever it is.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "stream/octree.h"

namespace neuvv::stream {

// Two halves of a cell that both have leaves: its octants by z, then by y, then by x.
struct Pair {
    float inverse_scale = 0;  // of the coefficient: √(w / (w_a w_b))
    float share_b = 0;        // w_b / w
};

// All pairs: those of the root first, depth by depth, in each depth in order of cells, in each cell as for_pairs says.
using Pairs = std::vector<Pair>;

// Calls split(i, s) for every pair of a cell's halves, which begin with octants i and i + s, and move(i, s) where the
// second half alone has leaves: a value that stands for octants i to i + 2s − 1 is that of its half.
template <typename Split, typename Move>
void for_pairs(uint32_t children, const Split& split, const Move& move) {
    for (uint32_t s = 4; s > 0; s /= 2)
        for (uint32_t i = 0; i < 8; i += 2 * s) {
            const uint32_t half = (1u << s) - 1;
            if (!(children >> (i + s) & half)) continue;
            if (children >> i & half)
                split(i, s);
            else
                move(i, s);
        }
}

// The pairs of a tree by the weights of its leaves, which must be whole numbers, in units of `unit`.
Pairs pairs_of(const Octree& tree, const std::vector<double>& weights, double unit);

// The area of each leaf as a weight: 1 for the finest, 4 for the next.
std::vector<double> areas_of(const std::vector<Leaf>& leaves, uint32_t depth);

// The coefficients of a plane, (b − a) · scale by pair, and the mean of the root.
struct Coefficients {
    double root = 0;
    std::vector<double> values;
};
Coefficients transform(const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                       std::span<const int16_t> leaves);

// Coefficients as whole numbers of steps, of several planes that are transformed together: the number of plane p of
// pair i is numbers[planes · i + p].
struct Numbers {
    uint32_t planes = 1;
    std::vector<int16_t> numbers;
};

// The inverse: the values of all leaves, plane after plane. What is rounded, and in which order, is part of the format:
// all numbers are 32-bit floats, and no two operations may become one.
std::vector<std::vector<float>> inverse_transform(const Octree& tree, const Pairs& pairs, std::span<const float> roots,
                                                  std::span<const float> steps, const Numbers& numbers);

}  // namespace neuvv::stream
