#include "stream/octree.h"

#include <algorithm>
#include <cassert>

namespace neuvv::stream {

namespace {

// The index of an octant's cell, or kNone.
uint32_t child_of(const Cell& cell, uint32_t octant) {
    if (!(cell.children >> octant & 1)) return kNone;
    return cell.first + octant_count(static_cast<uint8_t>(cell.children & ((1u << octant) - 1)));
}

}  // namespace

size_t Octree::most_cells() const {
    size_t most = 0;
    for (const std::vector<Cell>& of_depth : cells) most = std::max(most, of_depth.size());
    return most;
}

size_t Octree::large_count() const {
    size_t count = 0;
    for (const std::vector<Cell>& of_depth : cells) count += of_depth.size();
    return count - divided_count;
}

Octree octree_of(const std::vector<Leaf>& leaves, uint32_t depth) {
    Octree tree;
    if (leaves.empty()) return tree;
    tree.cells.resize(depth);
    for (uint32_t d = 0; d < depth; d++) {
        std::vector<Cell>& cells = tree.cells[d];
        for (const Leaf& leaf : leaves) {
            if (leaf.depth < d) continue;
            const uint64_t code = leaf.cell >> 3 * (depth - d);
            assert(cells.empty() || cells.back().code <= code);
            if (cells.empty() || cells.back().code != code) cells.push_back({code, 0, 0});
            if (leaf.depth > d)
                cells.back().children |= static_cast<uint8_t>(1u << (leaf.cell >> 3 * (depth - d - 1) & 7));
        }
    }
    link_cells(tree);
    return tree;
}

void link_cells(Octree& tree) {
    const size_t last = tree.cells.size() - 1;
    // How many leaves lie below each cell.
    std::vector<std::vector<uint32_t>> below(tree.cells.size());
    tree.divided_count = 0;
    for (size_t d = tree.cells.size(); d-- > 0;) {
        below[d].reserve(tree.cells[d].size());
        uint32_t next = 0;
        for (Cell& cell : tree.cells[d]) {
            const uint32_t children = octant_count(cell.children);
            cell.first = next;
            uint32_t leaves = d == last ? children : 0;
            for (uint32_t c = 0; d < last && c < children; c++) leaves += below[d + 1][next + c];
            next += children;
            below[d].push_back(children > 0 ? leaves : 1);
            tree.divided_count += children > 0;
        }
    }
    tree.leaf_count = below[0][0];
    // The number of the first of them, from the root down.
    std::vector<uint32_t> first = {0}, first_below;
    for (size_t d = 0; d < last; d++) {
        first_below.resize(tree.cells[d + 1].size());
        for (size_t i = 0; i < first.size(); i++) {
            Cell& cell = tree.cells[d][i];
            uint32_t next = first[i];
            for (uint32_t c = 0; c < octant_count(cell.children); c++) {
                first_below[cell.first + c] = next;
                next += below[d + 1][cell.first + c];
            }
            if (!cell.children) cell.first = first[i];
        }
        first.swap(first_below);
    }
    for (size_t i = 0; i < first.size(); i++) tree.cells[last][i].first = first[i];
}

std::vector<Leaf> leaves_of(const Octree& tree, uint32_t depth) {
    std::vector<Leaf> leaves(tree.leaf_count);
    for (uint32_t d = 0; d < tree.cells.size(); d++)
        for (const Cell& cell : tree.cells[d]) {
            if (!cell.children) leaves[cell.first] = {cell.code << 3 * (depth - d), d};
            if (d + 1 < depth) continue;
            Leaf* leaf = &leaves[cell.first];
            for_octants(cell.children, [&](uint32_t octant) { *leaf++ = {cell.code << 3 | octant, depth}; });
        }
    return leaves;
}

std::vector<uint8_t> patterns_below(const std::vector<Cell>& cells, const std::vector<Neighbours>& neighbours) {
    // By axis: the octants on its lower side. Those on the upper side are so many bits higher.
    constexpr std::array<uint32_t, 3> kLower = {0x55, 0x33, 0x0f}, kStep = {1, 2, 4};
    std::vector<uint8_t> patterns;
    patterns.reserve(4 * cells.size());
    for (size_t i = 0; i < cells.size(); i++) {
        const auto octants_beside = [&](size_t side) {
            return neighbours[i][side] == kNone ? 0u : uint32_t{cells[neighbours[i][side]].children};
        };
        const uint32_t own = cells[i].children;
        std::array<uint32_t, 6> beside;  // by side: the octants that have a neighbour there
        for (size_t axis = 0; axis < 3; axis++) {
            const uint32_t lower = kLower[axis], step = kStep[axis];
            beside[2 * axis] = (own & lower) << step | (octants_beside(2 * axis) >> step & lower);
            beside[2 * axis + 1] = (own >> step & lower) | (octants_beside(2 * axis + 1) & lower) << step;
        }
        for_octants(own, [&](uint32_t octant) {
            uint32_t pattern = 0;
            for (uint32_t side = 0; side < 6; side++) pattern |= (beside[side] >> octant & 1) << side;
            patterns.push_back(static_cast<uint8_t>(pattern));
        });
    }
    return patterns;
}

std::vector<Neighbours> neighbours_below(const std::vector<Cell>& cells, const std::vector<Neighbours>& neighbours) {
    std::vector<Neighbours> below;
    below.reserve(4 * cells.size());
    for (size_t i = 0; i < cells.size(); i++)
        for_octants(cells[i].children, [&](uint32_t octant) {
            Neighbours& all = below.emplace_back();
            for (uint32_t axis = 0; axis < 3; axis++) {
                // Towards the octant's own side lies another cell, else a sibling.
                const uint32_t own_side = octant >> axis & 1, beside = octant ^ 1u << axis;
                const uint32_t other = neighbours[i][2 * axis + own_side];
                all[2 * axis + own_side] = other == kNone ? kNone : child_of(cells[other], beside);
                all[2 * axis + 1 - own_side] = child_of(cells[i], beside);
            }
        });
    return below;
}

}  // namespace neuvv::stream
