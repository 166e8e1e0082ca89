#include "interchange/volume/leaf_grid.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "slice/coarser.h"
#include "voctree/voctree.h"

namespace neuvv::interchange {

namespace {

constexpr int kMargin = 2;

struct LatticeBox {
    glm::ivec3 low{std::numeric_limits<int>::max()}, high{std::numeric_limits<int>::lowest()};
    glm::ivec3 size() const { return high - low + 2 * kMargin; }
    size_t cells() const {
        return static_cast<size_t>(size().x) * static_cast<size_t>(size().y) * static_cast<size_t>(size().z);
    }
};

// The cells of a leaf at the depth of the volume.
LatticeBox cells_of(const slice::Slice& volume, const slice::Leaf& leaf) {
    const voctree::LeafPosition at = voctree::position_of(leaf.cell, volume.depth);
    const glm::ivec3 low(at.x, at.y, at.z);
    return {low, low + (1 << (volume.depth - leaf.depth))};
}

LatticeBox box_of(const slice::Slice& volume) {
    LatticeBox box;
    for (const slice::Leaf& leaf : volume.leaves) {
        const LatticeBox cells = cells_of(volume, leaf);
        box.low = glm::min(box.low, cells.low);
        box.high = glm::max(box.high, cells.high);
    }
    return box;
}

}  // namespace

LeafGrid::LeafGrid(slice::Slice volume, size_t most_cells) : volume_(std::move(volume)) {
    const uint32_t finest = slice::finest_depth(volume_);
    volume_ = slice::with_depth(std::move(volume_), finest);
    if (volume_.leaves.empty()) return;
    LatticeBox box = box_of(volume_);
    while (box.cells() > most_cells && volume_.depth > 1) {
        volume_ = slice::with_depth(std::move(volume_), volume_.depth - 1);
        box = box_of(volume_);
    }
    size_ = box.size();
    cell_m_ = volume_.box_size / static_cast<float>(1u << volume_.depth);
    const glm::ivec3 first = box.low - kMargin;
    origin_m_ = volume_.box_min + glm::vec3(first) * cell_m_;
    leaf_.resize(box.cells());
    for (size_t i = 0; i < volume_.leaves.size(); ++i) {
        const LatticeBox cells = cells_of(volume_, volume_.leaves[i]);
        for (int z = cells.low.z; z < cells.high.z; ++z)
            for (int y = cells.low.y; y < cells.high.y; ++y) {
                const size_t row = index_of(glm::ivec3(cells.low.x, y, z) - first);
                std::fill_n(&leaf_[row], cells.high.x - cells.low.x, static_cast<uint32_t>(i + 1));
            }
    }
}

const slice::Leaf* LeafGrid::leaf_of(const glm::ivec3& cell) const {
    if (cell.x < 0 || cell.y < 0 || cell.z < 0 || cell.x >= size_.x || cell.y >= size_.y || cell.z >= size_.z)
        return nullptr;
    const uint32_t leaf = leaf_[index_of(cell)];
    return leaf == 0 ? nullptr : &volume_.leaves[leaf - 1];
}

}  // namespace neuvv::interchange
