// Random slices for tests: leaves of mixed depths, and planes that are smooth with some noise.
#pragma once

#include <algorithm>
#include <cmath>

#include "stream/codec/quantised_slice.h"
#include "support/random_tree.h"

namespace neuvv::test {

inline stream::QuantisedSlice random_slice(uint64_t seed, uint32_t depth, uint32_t leaves, uint32_t degree) {
    Random random(seed);
    stream::QuantisedSlice slice{depth, degree, {}, {}};
    const std::vector<voctree::LeafPosition> positions = random_positions(random, depth / 2, leaves);
    for (const voctree::LeafPosition& position : positions)
        slice.leaves.push_back({voctree::first_cell(position, depth), position.depth});
    std::ranges::sort(slice.leaves, {}, &stream::Leaf::cell);
    slice.planes.resize(stream::planes_of(degree));
    for (size_t plane = 0; plane < slice.planes.size(); ++plane)
        for (const stream::Leaf& leaf : slice.leaves) {
            const double at = static_cast<double>(leaf.cell) / static_cast<double>(uint64_t{1} << 3 * depth);
            const double value = plane == 0
                                     ? 0.55 + 0.4 * std::sin(20 * at + 0.1 * random.bell())
                                     : 0.5 * std::cos(7 * at + static_cast<double>(plane)) + 0.05 * random.bell();
            slice.planes[plane].push_back(static_cast<int16_t>(std::lround(value * stream::kUnit)));
        }
    return slice;
}

}  // namespace neuvv::test
