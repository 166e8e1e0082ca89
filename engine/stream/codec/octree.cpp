#include "stream/codec/octree.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace neuvv::stream {

namespace {

// The index of an octant's cell, or kNone.
uint32_t child_of(const Cell& cell, uint32_t octant) {
    const uint32_t index = cell.first + octant_count(static_cast<uint8_t>(cell.children & ((1u << octant) - 1)));
    return cell.children >> octant & 1 ? index : kNone;
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
    for (uint32_t d = 0; d < depth; ++d) {
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

namespace {

// Numbers the leaves of a tree in order. The children of a depth's cells follow each other in the next depth, so that
// of each depth only the next cell has to be known.
struct Numbering {
    Octree& tree;
    std::vector<uint32_t> next;  // by depth: the next cell
    uint32_t leaves = 0, divided = 0;

    void number(size_t depth, uint32_t count) {
        Cell* cell = &tree.cells[depth][next[depth]];
        next[depth] += count;
        for (Cell* end = cell + count; cell < end; ++cell) {
            const uint32_t children = octant_count(cell->children);
            const bool is_above_leaves = depth + 1 == tree.cells.size();
            cell->first = children == 0 || is_above_leaves ? leaves : next[depth + 1];
            if (children == 0) {
                ++leaves;
                continue;
            }
            ++divided;
            if (is_above_leaves)
                leaves += children;
            else
                number(depth + 1, children);
        }
    }
};

}  // namespace

void link_cells(Octree& tree) {
    Numbering numbering{tree, std::vector<uint32_t>(tree.cells.size())};
    numbering.number(0, 1);
    tree.leaf_count = numbering.leaves;
    tree.divided_count = numbering.divided;
}

std::vector<Leaf> leaves_of(const Octree& tree, uint32_t depth) {
    std::vector<Leaf> leaves(tree.leaf_count);
    for (uint32_t d = 0; d < tree.cells.size(); ++d)
        for (const Cell& cell : tree.cells[d]) {
            if (!cell.children) leaves[cell.first] = {cell.code << 3 * (depth - d), d};
            if (d + 1 < depth) continue;
            Leaf* leaf = &leaves[cell.first];
            for_octants(cell.children, [&](uint32_t octant) { *leaf++ = {cell.code << 3 | octant, depth}; });
        }
    return leaves;
}

Surroundings surroundings_of_root() {
    return {{0}, {{kNone, kNone, kNone, kNone, kNone, kNone}}};
}

namespace {

// Transposes a matrix of 8 by 8 bits with a row in each byte: byte i of the result holds bit i of each byte.
uint64_t transposed(uint64_t bits) {
    const auto exchange = [&](uint32_t distance, uint64_t lower) {
        const uint64_t differs = (bits ^ bits >> distance) & lower;
        bits ^= differs ^ differs << distance;
    };
    exchange(7, 0x00aa00aa00aa00aa);
    exchange(14, 0x0000cccc0000cccc);
    exchange(28, 0x00000000f0f0f0f0);
    return bits;
}

// A divided cell and those at its sides, which are empty where there are none.
struct Around {
    Cell own;
    std::array<Cell, 6> beside;
};

Around around(const std::vector<Cell>& cells, const Cell& own, const Neighbours& neighbours) {
    static constexpr Cell kEmpty;
    Around all{own, {}};
    for (size_t side = 0; side < 6; ++side)
        all.beside[side] = *(neighbours[side] == kNone ? &kEmpty : &cells[neighbours[side]]);
    return all;
}

// Byte i has the pattern of octant i.
uint64_t patterns_of(const Around& all) {
    // By axis: the octants on its lower side. Those on the upper side are so many bits higher.
    constexpr std::array<uint32_t, 3> kLower = {0x55, 0x33, 0x0f}, kStep = {1, 2, 4};
    uint64_t sides = 0;  // byte `side` has the octants that have a neighbour there
    for (size_t axis = 0; axis < 3; ++axis) {
        const uint32_t own = all.own.children, lower = kLower[axis], step = kStep[axis];
        const uint32_t before = all.beside[2 * axis].children, behind = all.beside[2 * axis + 1].children;
        sides |= uint64_t{(own & lower) << step | (before >> step & lower)} << 16 * axis;
        sides |= uint64_t{(own >> step & lower) | (behind & lower) << step} << (16 * axis + 8);
    }
    return transposed(sides);
}

Neighbours neighbours_of(const Around& all, uint32_t octant) {
    Neighbours neighbours;
    for (uint32_t axis = 0; axis < 3; ++axis) {
        // Towards the octant's own side lies another cell, else a sibling.
        const uint32_t own_side = octant >> axis & 1, beside = octant ^ 1u << axis;
        neighbours[2 * axis + own_side] = child_of(all.beside[2 * axis + own_side], beside);
        neighbours[2 * axis + 1 - own_side] = child_of(all.own, beside);
    }
    return neighbours;
}

}  // namespace

Surroundings surroundings_below(const std::vector<Cell>& cells, const Surroundings& beside,
                                const std::vector<uint8_t>& is_leaf, bool with_neighbours) {
    const auto divided =
        is_leaf.size() - static_cast<size_t>(std::accumulate(is_leaf.begin(), is_leaf.end(), size_t{0}));
    Surroundings below;
    below.patterns.reserve(divided);
    if (with_neighbours) below.neighbours.reserve(divided);
    if (divided == 0) return below;
    assert(!beside.neighbours.empty());
    size_t number = 0;  // of the cell among those that are divided
    for (const Cell& cell : cells) {
        if (!cell.children) continue;
        const Around all = around(cells, cell, beside.neighbours[number++]);
        const uint64_t patterns = patterns_of(all);
        size_t child = cell.first;
        for_octants(cell.children, [&](uint32_t octant) {
            if (is_leaf[child++]) return;
            below.patterns.push_back(static_cast<uint8_t>(patterns >> 8 * octant));
            if (with_neighbours) below.neighbours.push_back(neighbours_of(all, octant));
        });
    }
    return below;
}

}  // namespace neuvv::stream
