// What a frame fills, as cells of a lattice that a closed surface can be drawn around.
#pragma once

#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "interchange/volume/leaf_grid.h"

namespace neuvv::interchange {

// Cells whose `opacity` is at least `level` are inside. Those of the lattice's faces are outside, and two cells that
// meet in an edge or a corner alone are both inside or both outside only where they also meet by faces around it
// (Latecki et al., "Well-composed sets", 1995), so that the boundary is a manifold.
struct Solid {
    glm::ivec3 size{0};  // cells along each axis; x counts fastest
    glm::vec3 origin_m{0}, cell_m{1};
    float level = 0.5f;
    std::vector<float> opacity;  // 0 to 1

    size_t index_of(const glm::ivec3& cell) const {
        return (static_cast<size_t>(cell.z) * static_cast<size_t>(size.y) + static_cast<size_t>(cell.y)) *
                   static_cast<size_t>(size.x) +
               static_cast<size_t>(cell.x);
    }
    bool inside(size_t index) const { return opacity[index] >= level; }
};

// A cell is inside where a ray to it has got at least `opacity` (above 0, below 1) behind it, in the cell or, at the
// same density, in another one behind it: from all but the two easiest of 26 directions around it. So what images do
// not show is inside, too: there are no cavities, and gaps in a wall of leaves are closed if only two directions pass
// through them. Cells are filled where the boundary would be no manifold. Takes 24 bytes a cell of the grid while it
// works. Calls `between` some times, which may throw.
Solid solid_of(
    const LeafGrid& grid, double opacity, const std::function<void()>& between = [] {});

}  // namespace neuvv::interchange
