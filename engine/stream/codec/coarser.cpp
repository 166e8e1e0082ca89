#include "stream/codec/coarser.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::stream {

namespace {

size_t leaf_cells(const std::vector<Cell>& cells) {
    return static_cast<size_t>(
        std::count_if(cells.begin(), cells.end(), [](const Cell& cell) { return cell.children == 0; }));
}

// The area of the leaves below each cell of a depth, in areas of the finest leaves.
std::vector<int32_t> areas_at(const Octree& tree, size_t depth) {
    const size_t finest = tree.cells.size();
    std::vector<int32_t> below, areas;
    for (size_t d = finest; d-- > depth;) {
        areas.clear();
        areas.reserve(tree.cells[d].size());
        for (const Cell& cell : tree.cells[d]) {
            const uint32_t children = octant_count(cell.children);
            int32_t area = children == 0 ? 1 << 2 * (finest - d) : 0;
            if (d + 1 == finest)
                area += static_cast<int32_t>(children);
            else
                for (uint32_t child = 0; child < children; ++child) area += below[cell.first + child];
            areas.push_back(area);
        }
        below.swap(areas);
    }
    return below;
}

}  // namespace

uint32_t coarser_levels(const Octree& tree, uint32_t budget) {
    if (budget == 0 || tree.leaf_count <= budget) return 0;
    const auto depth = static_cast<uint32_t>(tree.cells.size()), most = std::min(kMostCoarser, depth - 1);
    size_t leaves = 0;  // above the finest depth that is left
    for (uint32_t d = 0; d < depth - most; ++d) leaves += leaf_cells(tree.cells[d]);
    uint32_t levels = most;
    for (uint32_t d = depth - most; d < depth && leaves + tree.cells[d].size() <= budget; ++d) {
        levels = depth - d;
        leaves += leaf_cells(tree.cells[d]);
    }
    return levels;
}

CoarserOctree coarser_octree(const Octree& tree, uint32_t levels) {
    assert(levels >= 1 && levels <= kMostCoarser && levels < tree.cells.size() && tree.leaf_count > 0);
    const size_t depth = tree.cells.size() - levels;
    CoarserOctree coarser;
    coarser.tree.cells.assign(tree.cells.begin(), tree.cells.begin() + static_cast<ptrdiff_t>(depth));
    link_cells(coarser.tree);
    coarser.areas.assign(coarser.tree.leaf_count, 1 << 2 * levels);
    const std::vector<int32_t> areas = areas_at(tree, depth);
    auto area = areas.begin();
    for (const Cell& cell : coarser.tree.cells.back())
        for (uint32_t child = 0; child < octant_count(cell.children); ++child)
            coarser.areas[cell.first + child] = *area++;
    return coarser;
}

int16_t opacity_of_coarser(int16_t mean, int32_t area, uint32_t levels) {
    const double opacity = static_cast<double>(mean) / kUnit, filled = std::ldexp(area, -2 * static_cast<int>(levels));
    const double all = filled <= 1 ? opacity * filled : 1 - std::pow(1 - opacity, filled);
    return static_cast<int16_t>(std::lround(all * kUnit));
}

}  // namespace neuvv::stream
