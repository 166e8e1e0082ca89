// The octree of a slice, depth by depth: the form in which a stream writes it and transforms its planes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "stream/codec/quantised_slice.h"

namespace neuvv::stream {

constexpr uint32_t kNone = UINT32_MAX;

// How many of a cell's octants are cells, by a table, because not every processor counts bits.
constexpr std::array<uint8_t, 256> kOctantCounts = [] {
    std::array<uint8_t, 256> counts{};
    for (uint32_t octants = 0; octants < 256; ++octants) counts[octants] = static_cast<uint8_t>(std::popcount(octants));
    return counts;
}();
constexpr uint32_t octant_count(uint8_t children) {
    return kOctantCounts[children];
}

// Calls visit(octant) for each octant that is a cell, in order.
template <typename Visit>
void for_octants(uint32_t children, const Visit& visit) {
    for (; children; children &= children - 1) visit(static_cast<uint32_t>(std::countr_zero(children)));
}

// A cell of an octree above the finest depth: a leaf, or one that is divided and has children.
struct Cell {
    uint64_t code = 0;     // Morton code at its depth
    uint8_t children = 0;  // the octants that are cells; 0: a leaf
    // The index of its first child in the next depth; the others follow in the order of their octants. Where the
    // children are of the finest depth, which are all leaves, the first one's number in leaves_of. Of a leaf, its own.
    uint32_t first = 0;
};

struct Octree {
    // By depth, the root first, without the finest; each in order of code. Empty where there are no leaves.
    std::vector<std::vector<Cell>> cells;
    uint32_t leaf_count = 0;
    uint32_t divided_count = 0;  // of cells
    size_t most_cells() const;   // that one of the depths has
    size_t large_count() const;  // of leaves above the finest depth
};

// The leaves of a slice must be in order and must not overlap (assert).
Octree octree_of(const std::vector<Leaf>& leaves, uint32_t depth);
// The leaves in order of their cells.
std::vector<Leaf> leaves_of(const Octree& tree, uint32_t depth);
// Sets Cell::first of all cells, and the numbers of leaves and of divided cells, where the cells' codes and children
// are known.
void link_cells(Octree& tree);

// The six face neighbours of a cell, by index among the cells of its depth; kNone where there is no cell: −x, +x, −y,
// +y, −z, +z.
using Neighbours = std::array<uint32_t, 6>;
// What lies beside the divided cells of a depth, in their order.
struct Surroundings {
    std::vector<uint8_t> patterns;  // which of the neighbours there are: bits in their order
    std::vector<Neighbours> neighbours;
};
Surroundings surroundings_of_root();
// The surroundings of the divided children of the cells of a depth. `is_leaf` has 1 for each child that is a leaf, in
// order. `beside` are the surroundings of the cells, with neighbours; Cell::first of the cells must be set.
Surroundings surroundings_below(const std::vector<Cell>& cells, const Surroundings& beside,
                                const std::vector<uint8_t>& is_leaf, bool with_neighbours);

}  // namespace neuvv::stream
