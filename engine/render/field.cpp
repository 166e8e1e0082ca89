#include "render/field.h"

#include <algorithm>
#include <bit>
#include <functional>

#include "gpu/commands.h"
#include "voctree/half.h"

namespace neuvv {

namespace {

// Calls visit(index among the leaf's weights, plane, component) for every weight of a leaf.
void for_each_weight(const VOctree& tree, const std::function<void(uint32_t, uint32_t, uint32_t)>& visit) {
    const uint32_t basis_planes = (tree.bases + 3) / 4, functions = hh_count(tree.hh_degree);
    for (uint32_t kind = 0; kind < 2; kind++)
        for (uint32_t c = 0; c < tree.bases; c++) visit(kind * tree.bases + c, kind * basis_planes + c / 4, c % 4);
    for (uint32_t channel = 0; channel < 3; channel++)
        for (uint32_t f = 0; f < functions; f++)
            visit(2 * tree.bases + channel * functions + f, 2 * basis_planes + f, channel);
}

size_t plane_floats(const VOctree& tree) {
    return size_t{4} * tree.leaf_count * (2 * ((tree.bases + 3) / 4) + hh_count(tree.hh_degree));
}

// The child array with leaves that fill an octant marked, so that a walk steps over them at once.
std::vector<uint32_t> mark_wide_leaves(const VOctree& tree) {
    std::vector<uint32_t> marked = tree.children;
    for (const TreeNode& node : tree.nodes) {
        const uint64_t mask = uint64_t{node.mask_hi} << 32 | node.mask_lo;
        size_t slot = node.first_child;
        for (uint32_t octant = 0; octant < 8; octant++) {
            const uint64_t cells = mask >> (8 * octant) & 0xff;
            bool wide = cells == 0xff && (tree.children[slot] & kLeafBit);
            for (size_t i = 1; wide && i < 8; i++) wide = tree.children[slot + i] == tree.children[slot];
            if (wide)
                for (size_t i = 0; i < 8; i++) marked[slot + i] |= kWideLeafBit;
            slot += static_cast<size_t>(std::popcount(cells));
        }
    }
    return marked;
}

// The grid over the tree's upper levels (shared/tree.h).
class TopGrid {
  public:
    explicit TopGrid(const VOctree& tree, const std::vector<uint32_t>& marked_children)
        : tree_(tree), children_(marked_children), lowest_(tree.node_levels - top_levels(tree.node_levels)) {
        side_ = 1u << (2 * top_levels(tree.node_levels));
        cells_.resize(size_t{side_} * side_ * side_);
        fill_node(0, tree.node_levels, glm::uvec3(0));
    }
    const std::vector<glm::uvec2>& cells() const { return cells_; }

  private:
    // `level`: of the node's parent cell, whose side is 4^level finest cells; `corner` in those.
    void fill_node(uint32_t node, uint32_t level, glm::uvec3 corner) {
        if (level == lowest_) return fill(corner, level, {node, 0});
        const TreeNode& entry = tree_.nodes[node];
        const uint64_t mask = uint64_t{entry.mask_hi} << 32 | entry.mask_lo;
        uint32_t child = entry.first_child;
        for (uint32_t bit = 0; bit < 64; bit++) {
            const glm::uvec3 cell = 4u * corner + 2u * octant_place(bit >> 3) + octant_place(bit & 7);
            const uint32_t shift = 2 * (level - 1);
            if (!(mask >> bit & 1)) {
                fill(cell, level - 1, {kNoLeaf, shift + ((mask >> (bit & 56) & 0xff) == 0 ? 1 : 0)});
            } else if (const uint32_t word = children_[child++]; word & kLeafBit) {
                fill(cell, level - 1, {word & ~kWideLeafBit, shift + (word & kWideLeafBit ? 1 : 0)});
            } else {
                fill_node(word, level - 1, cell);
            }
        }
    }

    void fill(glm::uvec3 corner, uint32_t level, glm::uvec2 value) {
        const uint32_t size = 1u << (2 * (level - lowest_));
        const glm::uvec3 first = corner * size;
        for (uint32_t z = first.z; z < first.z + size; z++)
            for (uint32_t y = first.y; y < first.y + size; y++) {
                const auto row = cells_.begin() + static_cast<ptrdiff_t>((size_t{z} * side_ + y) * side_ + first.x);
                std::fill(row, row + size, value);
            }
    }

    static glm::uvec3 octant_place(uint32_t octant) { return {octant & 1, octant >> 1 & 1, octant >> 2}; }

    const VOctree& tree_;
    const std::vector<uint32_t>& children_;
    uint32_t lowest_, side_;
    std::vector<glm::uvec2> cells_;
};

// Which cells of which node belong to each leaf, and which to nodes.
struct Cells {
    std::vector<glm::uvec2> of_leaves, inner;
};

Cells find_cells(const VOctree& tree) {
    Cells cells{std::vector<glm::uvec2>(tree.leaf_count), std::vector<glm::uvec2>(tree.nodes.size())};
    for (uint32_t node = 0; node < tree.nodes.size(); node++) {
        uint32_t child = tree.nodes[node].first_child;
        for (uint32_t bit = 0; bit < 64; bit++) {
            const uint32_t word = bit / 32, flag = 1u << bit % 32;
            if (!((word == 0 ? tree.nodes[node].mask_lo : tree.nodes[node].mask_hi) & flag)) continue;
            const uint32_t entry = tree.children[child++];
            if (entry & kLeafBit) {
                glm::uvec2& leaf = cells.of_leaves[entry & kLeafIndexMask];
                leaf = {2 * node + word, leaf.y | flag};  // an octant's eight cells share a word
            } else {
                cells.inner[node][static_cast<int>(word)] |= flag;
            }
        }
    }
    return cells;
}

// Between two frames rows mix, so neighbours count together.
uint32_t count_busy_planes(const std::vector<float>& basis, uint32_t frames, uint32_t bases) {
    uint32_t most = 1;
    for (uint32_t t = 0; t < frames; t++) {
        const uint32_t rows = std::min(2u, frames - t);
        uint32_t busy = 0;
        for (uint32_t plane = 0; plane < bases; plane += 4) {
            bool any = false;
            for (uint32_t row = t; row < t + rows; row++)
                for (uint32_t c = plane; c < std::min(plane + 4, bases); c++)
                    any |= basis[size_t{row} * bases + c] != 0;
            busy += any ? 1 : 0;
        }
        most = std::max(most, busy);
    }
    return most;
}

template <typename T>
Buffer uploaded(const Device& device, const char* name, const std::vector<T>& data, VkFormat format) {
    Buffer buffer(device, name, data.size() * sizeof(T), MemoryKind::kDevice, format);
    upload(device, buffer, data.data(), data.size() * sizeof(T));
    return buffer;
}

}  // namespace

std::vector<float> weights_to_planes(const VOctree& tree) {
    std::vector<float> planes(plane_floats(tree));
    const uint32_t stride = tree.weights_per_leaf();
    for_each_weight(tree, [&](uint32_t index, uint32_t plane, uint32_t component) {
        float* to = &planes[size_t{4} * plane * tree.leaf_count + component];
        for (size_t leaf = 0; leaf < tree.leaf_count; leaf++) to[4 * leaf] = tree.weights[leaf * stride + index];
    });
    return planes;
}

void weights_from_planes(const std::vector<float>& planes, VOctree& tree) {
    const uint32_t stride = tree.weights_per_leaf();
    tree.weights.resize(size_t{tree.leaf_count} * stride);
    for_each_weight(tree, [&](uint32_t index, uint32_t plane, uint32_t component) {
        const float* from = &planes[size_t{4} * plane * tree.leaf_count + component];
        for (size_t leaf = 0; leaf < tree.leaf_count; leaf++) tree.weights[leaf * stride + index] = from[4 * leaf];
    });
}

Field upload_field(const Device& device, const VOctree& tree, WeightPrecision precision) {
    Field field;
    field.box_min = tree.box_min;
    field.box_size = tree.box_size;
    field.node_levels = tree.node_levels;
    field.leaf_count = tree.leaf_count;
    field.bases = tree.bases;
    field.hh_degree = tree.hh_degree;
    field.frames = tree.frames;
    field.busy_planes = std::max(count_busy_planes(tree.sigma_basis, tree.frames, tree.bases),
                                 count_busy_planes(tree.gamma_basis, tree.frames, tree.bases));
    field.nodes = uploaded(device, "tree nodes", tree.nodes, VK_FORMAT_R32G32B32A32_UINT);
    const std::vector<uint32_t> children = mark_wide_leaves(tree);
    field.children = uploaded(device, "tree children", children, VK_FORMAT_R32_UINT);
    const Cells cells = find_cells(tree);
    field.leaf_cells = uploaded(device, "leaf cells", cells.of_leaves, VK_FORMAT_R32G32_UINT);
    field.inner_cells = uploaded(device, "inner cells", cells.inner, VK_FORMAT_R32G32_UINT);
    field.top = uploaded(device, "tree top", TopGrid(tree, children).cells(), VK_FORMAT_R32G32_UINT);
    field.sigma_basis = uploaded(device, "basis A", tree.sigma_basis, VK_FORMAT_R32_SFLOAT);
    field.gamma_basis = uploaded(device, "basis B", tree.gamma_basis, VK_FORMAT_R32_SFLOAT);
    const std::vector<float> planes = weights_to_planes(tree);
    if (precision == WeightPrecision::kFloat) {
        field.weights = uploaded(device, "leaf weights", planes, VK_FORMAT_R32G32B32A32_SFLOAT);
    } else {
        std::vector<uint16_t> halves(planes.size());
        for (size_t i = 0; i < planes.size(); i++) halves[i] = half_from_float(planes[i]);
        field.weights = uploaded(device, "leaf weights (fp16)", halves, VK_FORMAT_R16G16B16A16_SFLOAT);
    }
    return field;
}

}  // namespace neuvv
