#include "render/volume/slices/top_grid.h"

#include <algorithm>

#include "render/volume/slices/packed_position.h"
#include "shared/tree.h"

namespace neuvv::render {

namespace {

constexpr uint64_t kMaxTopCells = 1u << 22;  // 16 MB

// The position of a node, which lies in the grid, as the grid's cells that it covers, from the grid's first cell on.
struct Covered {
    glm::uvec3 first, end;
};
Covered covered_by(glm::uvec2 position, uint32_t cells, const CellBounds& bounds) {
    const glm::uvec3 corner = unpacked_position(position);
    return {glm::max(corner * cells, bounds.low) - bounds.low,
            glm::min((corner + 1u) * cells, bounds.last + 1u) - bounds.low};
}

}  // namespace

TopGrid top_grid(uint32_t node_levels, const CellBounds& leaves, const std::vector<uint32_t>& level_begin,
                 const std::vector<glm::uvec2>& node_positions) {
    TopGrid grid;
    for (uint32_t levels = 0; levels < node_levels; ++levels) {
        const CellBounds finer = leaves.coarser(2 * (node_levels - levels));
        if (levels > 0 && finer.cells() > kMaxTopCells) break;
        grid.levels = levels;
        grid.bounds = finer;
    }
    const glm::uvec3 size = grid.bounds.last - grid.bounds.low + 1u;
    grid.cells.resize(grid.bounds.cells());
    // Level by level, so that deeper nodes replace those around them.
    const auto built = std::min<size_t>(grid.levels + 1, level_begin.size() - 1);
    for (uint32_t level = 0; level < built; ++level) {
        const uint32_t cells = 1u << 2 * (grid.levels - level);  // of the grid, along each edge of a node
        const uint32_t shift = (node_levels - 1 - level) << kTopLevelShift;
        for (uint32_t node = level_begin[level]; node < level_begin[level + 1]; ++node) {
            const auto [first, end] = covered_by(node_positions[node], cells, grid.bounds);
            for (uint32_t z = first.z; z < end.z; ++z)
                for (uint32_t y = first.y; y < end.y; ++y) {
                    const auto row = grid.cells.begin() + static_cast<ptrdiff_t>((size_t{z} * size.y + y) * size.x);
                    std::fill(row + first.x, row + end.x, node | shift);
                }
        }
    }
    return grid;
}

}  // namespace neuvv::render
