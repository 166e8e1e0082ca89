// The shape of a slice, which of its octree's cells there are, as symbols. A cell's octants depend on which face
// neighbours the cell has. `Coder` is a SymbolWriter or a SymbolReader.
#pragma once

#include <bit>
#include <stdexcept>

#include "stream/codec/octree.h"
#include "stream/codec/symbols.h"

namespace neuvv::stream {

// The next depth's cells, with children to come: of those, a reader knows nothing yet.
// Throws std::runtime_error where there are more than `most`.
inline std::vector<Cell> children_of(const std::vector<Cell>& cells, uint32_t most) {
    size_t count = 0;
    for (const Cell& cell : cells) count += octant_count(cell.children);
    if (count > most) throw std::runtime_error("has more leaves than it says");
    std::vector<Cell> below(count);
    Cell* next = below.data();
    for (const Cell& cell : cells)
        for_octants(cell.children, [&](uint32_t octant) { (next++)->code = cell.code << 3 | octant; });
    return below;
}

// Codes the octants of the cells of a depth that are no leaves. `leaves` says which are (1); `patterns` are those of
// the others' surroundings.
template <typename Coder>
void code_octants(Coder& coder, std::vector<Cell>& cells, const std::vector<uint8_t>& leaves,
                  const std::vector<uint8_t>& patterns, bool is_finest) {
    const uint8_t* pattern = patterns.data();
    for (size_t i = 0; i < cells.size(); ++i) {
        if (leaves[i]) continue;
        const uint32_t table = kOctantTables + (is_finest ? 0 : 64) + *pattern++;
        cells[i].children = static_cast<uint8_t>(coder.take(table, cells[i].children));
        if (cells[i].children == 0) throw std::runtime_error("has a cell without octants");
    }
}

// Codes which of a cell's children are leaves (1). What is likely depends on whether leaves, and cells that are none,
// came before in the same cell. `children` are those of all cells, in order; a reader does not read them.
template <typename Coder>
std::vector<uint8_t> code_leaves(Coder& coder, const std::vector<Cell>& cells, const std::vector<Cell>* children,
                                 bool is_last) {
    std::vector<uint8_t> leaves;
    leaves.reserve(4 * cells.size());
    for (const Cell& cell : cells) {
        uint32_t before = 0;
        for (uint32_t c = 0; c < octant_count(cell.children); ++c) {
            const bool is_leaf = children && (*children)[leaves.size()].children == 0;
            leaves.push_back(
                static_cast<uint8_t>(coder.take_either(kLeafTables + (is_last ? 0 : 4) + before, is_leaf ? 1 : 0)));
            before |= leaves.back() ? 1 : 2;
        }
    }
    return leaves;
}

// Codes the octree of at most `most` leaves, whose finest depth is `depth`. `tree` is what a writer writes; a reader
// gives an empty one. Throws std::runtime_error where there are more leaves, or cells without leaves.
template <typename Coder>
Octree code_shape(Coder& coder, const Octree& tree, uint32_t depth, uint32_t most) {
    const bool writes = !tree.cells.empty();
    Octree coded;
    coded.cells.resize(depth);
    coded.cells[0] = {{0, writes ? tree.cells[0][0].children : uint8_t{0}, 0}};
    std::vector<uint8_t> leaves = {0};
    Surroundings beside = surroundings_of_root();
    for (uint32_t d = 0; d < depth; ++d) {
        std::vector<Cell>& cells = coded.cells[d];
        code_octants(coder, cells, leaves, beside.patterns, d + 1 == depth);
        if (d + 1 == depth) break;
        coded.cells[d + 1] = children_of(cells, most);
        uint32_t next = 0;
        for (Cell& cell : cells) {
            cell.first = next;
            next += octant_count(cell.children);
        }
        const std::vector<Cell>* below = writes ? &tree.cells[d + 1] : nullptr;
        leaves = code_leaves(coder, cells, below, d + 2 == depth);
        if (below)
            for (size_t i = 0; i < below->size(); ++i) coded.cells[d + 1][i].children = (*below)[i].children;
        beside = surroundings_below(cells, beside, leaves, d + 2 < depth);
    }
    link_cells(coded);
    if (coded.leaf_count > most) throw std::runtime_error("has more leaves than it says");
    return coded;
}

}  // namespace neuvv::stream
