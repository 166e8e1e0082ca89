#include "stream/octree.h"

#include <cassert>

namespace neuvv::stream {

namespace {

// The index of an octant's cell, or kNone.
uint32_t child_of(const Cell& cell, uint32_t octant) {
    if (!(cell.children >> octant & 1)) return kNone;
    return cell.first + octant_count(static_cast<uint8_t>(cell.children & ((1u << octant) - 1)));
}

}  // namespace

Octree octree_of(const std::vector<Leaf>& leaves, uint32_t depth) {
    Octree tree;
    if (leaves.empty()) return tree;
    tree.cells.resize(depth + 1);
    for (uint32_t d = 0; d <= depth; d++) {
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
    // How many leaves lie below each cell.
    std::vector<std::vector<uint32_t>> below(tree.cells.size());
    for (size_t d = 0; d < tree.cells.size(); d++) {
        uint32_t next = 0;
        for (Cell& cell : tree.cells[d]) {
            cell.first = next;
            next += octant_count(cell.children);
        }
    }
    for (size_t d = tree.cells.size(); d-- > 0;)
        for (const Cell& cell : tree.cells[d]) {
            uint32_t& leaves = below[d].emplace_back(cell.children ? 0 : 1);
            for (uint32_t c = 0; c < octant_count(cell.children); c++) leaves += below[d + 1][cell.first + c];
        }
    tree.leaf_count = tree.cells.empty() ? 0 : below[0][0];
    // The number of the first of them, from the root down.
    std::vector<uint32_t> first = {0}, first_below;
    for (size_t d = 0; d < tree.cells.size(); d++) {
        first_below.clear();
        for (size_t i = 0; i < tree.cells[d].size(); i++) {
            Cell& cell = tree.cells[d][i];
            uint32_t next = first[i];
            for (uint32_t c = 0; c < octant_count(cell.children); c++) {
                first_below.push_back(next);
                next += below[d + 1][cell.first + c];
            }
            if (!cell.children) cell.first = first[i];
        }
        first.swap(first_below);
    }
}

std::vector<Leaf> leaves_of(const Octree& tree, uint32_t depth) {
    std::vector<Leaf> leaves(tree.leaf_count);
    for (uint32_t d = 0; d < tree.cells.size(); d++)
        for (const Cell& cell : tree.cells[d])
            if (!cell.children) leaves[cell.first] = {cell.code << 3 * (depth - d), d};
    return leaves;
}

std::vector<Neighbours> neighbours_below(const std::vector<Cell>& cells, const std::vector<Neighbours>& neighbours) {
    std::vector<Neighbours> below;
    for (size_t i = 0; i < cells.size(); i++)
        for (uint32_t octant = 0; octant < 8; octant++) {
            if (!(cells[i].children >> octant & 1)) continue;
            Neighbours& all = below.emplace_back();
            for (uint32_t axis = 0; axis < 3; axis++)
                for (uint32_t side = 0; side < 2; side++) {
                    const uint32_t beside = octant ^ 1u << axis;
                    // Towards the octant's own side lies another cell, else a sibling.
                    const uint32_t cell =
                        (octant >> axis & 1) == side ? neighbours[i][2 * axis + side] : static_cast<uint32_t>(i);
                    all[2 * axis + side] = cell == kNone ? kNone : child_of(cells[cell], beside);
                }
        }
    return below;
}

}  // namespace neuvv::stream
