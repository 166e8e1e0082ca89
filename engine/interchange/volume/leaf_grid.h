// The leaves of a frame as a lattice of cells, in which the leaf at a point is found at once.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "slice/slice.h"

namespace neuvv::interchange {

// Cells are as large as the smallest leaf of the volume. The lattice reaches two cells beyond its leaves on all sides.
// Where it would have more than `most_cells`, the leaves of the finest depths are merged first.
class LeafGrid {
  public:
    static constexpr size_t kMostCells = size_t{1} << 26;
    explicit LeafGrid(slice::Slice volume, size_t most_cells = kMostCells);

    const slice::Slice& volume() const { return volume_; }
    glm::ivec3 size() const { return size_; }         // cells along each axis; 0 where the volume is empty
    glm::vec3 origin_m() const { return origin_m_; }  // the lowest corner of cell 0, 0, 0
    glm::vec3 cell_m() const { return cell_m_; }      // edges of a cell
    // Null where there is none. Cells outside are empty; x counts fastest.
    const slice::Leaf* leaf_of(const glm::ivec3& cell) const;
    const slice::Leaf* leaf_at(const glm::vec3& point_m) const {
        return leaf_of(glm::ivec3(glm::floor((point_m - origin_m_) / cell_m_)));
    }

  private:
    size_t index_of(const glm::ivec3& cell) const {
        return (static_cast<size_t>(cell.z) * static_cast<size_t>(size_.y) + static_cast<size_t>(cell.y)) *
                   static_cast<size_t>(size_.x) +
               static_cast<size_t>(cell.x);
    }
    slice::Slice volume_;
    glm::ivec3 size_{0};
    glm::vec3 origin_m_{0}, cell_m_{1};
    std::vector<uint32_t> leaf_;  // by cell: one more than the leaf's index
};

}  // namespace neuvv::interchange
