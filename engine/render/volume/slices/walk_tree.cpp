#include "render/volume/slices/walk_tree.h"

#include <algorithm>
#include <bit>

namespace neuvv::render {

namespace {

constexpr uint64_t kOctant = 0xff;
constexpr uint64_t kMaxTopCells = 1u << 22;  // 16 MB

glm::uvec3 octant_offset(uint32_t octant) {
    return {octant & 1, octant >> 1 & 1, octant >> 2};
}

uint64_t mask_of(const TreeNode& node) {
    return uint64_t{node.mask_hi} << 32 | node.mask_lo;
}

// Whether one leaf fills the whole octant. `slot` is the index of the octant's first child.
bool is_wide(const voctree::VOctree& tree, uint64_t mask, uint32_t octant, size_t slot) {
    if ((mask >> (8 * octant) & kOctant) != kOctant || !(tree.children[slot] & kLeafBit)) return false;
    return std::all_of(&tree.children[slot], &tree.children[slot] + 8,
                       [&](uint32_t other) { return other == tree.children[slot]; });
}

glm::uvec2 packed(glm::uvec3 position, uint32_t depth) {
    return {position.x | position.y << 16, position.z | depth << 16};
}

glm::uvec3 unpacked(glm::uvec2 position) {
    return {position.x & 0xffff, position.x >> 16, position.y & 0xffff};
}

// Visits the nodes level by level and numbers them in this order.
class Walker {
  public:
    explicit Walker(const voctree::VOctree& tree) : tree_(tree) {
        walk_.nodes.reserve(tree.nodes.size());
        walk_.children.reserve(tree.children.size());
        walk_.leaf_cells.resize(tree.leaf_count);
        walk_.node_cells.resize(tree.nodes.size());
        walk_.leaf_positions.resize(tree.leaf_count);
        walk_.node_positions.resize(tree.nodes.size());
        walk_.inner_cells.resize(tree.nodes.size());
        std::vector<uint32_t> level = {0}, next;
        while (!level.empty()) {
            walk_.level_begin.push_back(static_cast<uint32_t>(walk_.nodes.size()));
            const auto first_below = static_cast<uint32_t>(walk_.nodes.size() + level.size());
            for (const uint32_t node : level) add_node(tree.nodes[node], first_below, next);
            level.swap(next);
            next.clear();
        }
        walk_.level_begin.push_back(static_cast<uint32_t>(walk_.nodes.size()));
    }
    WalkTree take() { return std::move(walk_); }

  private:
    void add_node(const TreeNode& node, uint32_t first_below, std::vector<uint32_t>& below) {
        const auto index = static_cast<uint32_t>(walk_.nodes.size());
        const uint32_t level = walk_.node_positions[index].y >> 16;
        const glm::uvec3 corner = unpacked(walk_.node_positions[index]);
        TreeNode added{node.mask_lo, node.mask_hi, static_cast<uint32_t>(walk_.children.size()), 0};
        const uint64_t mask = mask_of(node);
        size_t slot = node.first_child;
        for (uint32_t bit = 0; bit < 64; ++bit) {
            if (!(mask >> bit & 1)) continue;
            const uint32_t word = 2 * index + bit / 32, flag = 1u << bit % 32, entry = tree_.children[slot];
            const glm::uvec3 octant = 2u * corner + octant_offset(bit >> 3);
            const glm::uvec3 cell = 2u * octant + octant_offset(bit & 7);
            if (bit % 8 == 0 && is_wide(tree_, mask, bit / 8, slot)) {
                added.wide |= 1u << bit / 8;
                add_leaf(entry, {word, 0xffu << bit % 32}, packed(octant, 2 * level + 1));
                bit += 7;
                slot += 8;
                continue;
            }
            ++slot;
            if (entry & kLeafBit) {
                add_leaf(entry, {word, flag}, packed(cell, 2 * level + 2));
            } else {
                const auto child = static_cast<uint32_t>(first_below + below.size());
                walk_.children.push_back(child);
                walk_.node_cells[child] = {word, flag};
                walk_.node_positions[child] = packed(cell, level + 1);
                walk_.inner_cells[index][static_cast<int>(bit / 32)] |= flag;
                below.push_back(entry);
            }
        }
        walk_.nodes.push_back(added);
    }

    void add_leaf(uint32_t entry, glm::uvec2 cells, glm::uvec2 position) {
        walk_.children.push_back(entry);
        walk_.leaf_cells[entry & ~kLeafBit] = cells;
        walk_.leaf_positions[entry & ~kLeafBit] = position;
    }

    const voctree::VOctree& tree_;
    WalkTree walk_;
};

// The first and the last cell of a grid that have leaves, along each axis.
struct Bounds {
    glm::uvec3 low{0}, last{0};
    Bounds coarser(uint32_t depths) const { return {low >> depths, last >> depths}; }
    uint64_t cells() const {
        const glm::u64vec3 size(last - low + 1u);
        return size.x * size.y * size.z;
    }
};

// In the grid with 2^depth cells along each side; no leaf is deeper.
Bounds bounds_of(const std::vector<voctree::LeafPosition>& positions, uint32_t depth) {
    Bounds bounds{glm::uvec3(UINT32_MAX), glm::uvec3(0)};
    for (const voctree::LeafPosition& position : positions) {
        const glm::uvec3 cell(position.x, position.y, position.z);
        const uint32_t shift = depth - position.depth;
        bounds.low = glm::min(bounds.low, cell << shift);
        bounds.last = glm::max(bounds.last, ((cell + 1u) << shift) - 1u);
    }
    return positions.empty() ? Bounds{} : bounds;
}

// Fills the grid over the upper levels.
class TopGrid {
  public:
    explicit TopGrid(const WalkTree& walk)
        : walk_(walk), lowest_(walk.node_levels - walk.top_levels), size_(walk.top_last - walk.top_low + 1u) {
        cells_.resize(size_t{size_.x} * size_.y * size_.z);
        fill_node(0, walk.node_levels, glm::uvec3(0));
    }
    std::vector<uint32_t> take() { return std::move(cells_); }

  private:
    // The side of a node of level `level` is 4^level finest cells. `corner` is the node's position in units of its own
    // size.
    void fill_node(uint32_t node, uint32_t level, glm::uvec3 corner) {
        const uint32_t size = 1u << (2 * (level - lowest_));
        const glm::uvec3 first = glm::max(corner * size, walk_.top_low) - walk_.top_low;
        const glm::uvec3 end = glm::min((corner + 1u) * size, walk_.top_last + 1u) - walk_.top_low;
        for (uint32_t z = first.z; z < end.z; ++z)
            for (uint32_t y = first.y; y < end.y; ++y) {
                const auto row = cells_.begin() + static_cast<ptrdiff_t>((size_t{z} * size_.y + y) * size_.x);
                std::fill(row + first.x, row + end.x, node | (level - 1) << kTopLevelShift);
            }
        if (level == lowest_) return;
        const uint64_t inner = uint64_t{walk_.inner_cells[node].y} << 32 | walk_.inner_cells[node].x;
        for (uint32_t bit = 0; bit < 64; ++bit) {
            if (!(inner >> bit & 1)) continue;
            const uint32_t child = child_of(walk_.nodes[node], bit);
            fill_node(child, level - 1, 4u * corner + 2u * octant_offset(bit >> 3) + octant_offset(bit & 7));
        }
    }

    uint32_t child_of(const TreeNode& node, uint32_t bit) const {
        uint64_t runs = mask_of(node);
        for (uint32_t octant = 0; octant < 8; ++octant)
            if (node.wide >> octant & 1) runs &= ~(uint64_t{0xfe} << (8 * octant));
        const auto below = static_cast<uint32_t>(std::popcount(runs & ((uint64_t{1} << bit) - 1)));
        return walk_.children[node.first_child + below];
    }

    const WalkTree& walk_;
    uint32_t lowest_;
    glm::uvec3 size_;
    std::vector<uint32_t> cells_;
};

}  // namespace

WalkTree walk_tree(const voctree::VOctree& tree) {
    std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    uint32_t finest = 1;
    size_t odd = 0;
    for (const voctree::LeafPosition& position : positions) {
        finest = std::max(finest, position.depth);
        odd += position.depth % 2;
    }
    const uint32_t above = odd > positions.size() / 2 && finest < 2 * kMaxNodeLevels ? 1 : 0;
    const uint32_t node_levels = (finest + above + 1) / 2;
    WalkTree walk;
    if (above == 0 && node_levels == tree.node_levels) {
        walk = Walker(tree).take();
    } else {
        voctree::VOctree rooted;
        rooted.node_levels = node_levels;
        for (voctree::LeafPosition& position : positions) position.depth += above;
        voctree::build_nodes(rooted, positions);
        walk = Walker(rooted).take();
    }
    walk.node_levels = node_levels;
    walk.scale = 1 + above;
    const Bounds finest_bounds = bounds_of(positions, 2 * node_levels);
    Bounds bounds;
    for (uint32_t levels = 0; levels < node_levels; ++levels) {
        const Bounds finer = finest_bounds.coarser(2 * (node_levels - levels));
        if (levels > 0 && finer.cells() > kMaxTopCells) break;
        walk.top_levels = levels;
        bounds = finer;
    }
    walk.top_low = bounds.low;
    walk.top_last = bounds.last;
    walk.top = TopGrid(walk).take();
    return walk;
}

}  // namespace neuvv::render
