#include "render/volume/slices/walk_tree.h"

#include <algorithm>
#include <utility>

#include "render/volume/slices/packed_position.h"

namespace neuvv::render {

namespace {

constexpr uint64_t kOctant = 0xff;

uint64_t mask_of(const TreeNode& node) {
    return uint64_t{node.mask_hi} << 32 | node.mask_lo;
}

// Whether one leaf fills the whole octant. `slot` is the index of the octant's first child.
bool is_wide(const voctree::VOctree& tree, uint64_t mask, uint32_t octant, size_t slot) {
    if ((mask >> (8 * octant) & kOctant) != kOctant || !(tree.children[slot] & kLeafBit)) return false;
    return std::all_of(&tree.children[slot], &tree.children[slot] + 8,
                       [&](uint32_t other) { return other == tree.children[slot]; });
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
        const glm::uvec3 corner = unpacked_position(walk_.node_positions[index]);
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
                add_leaf(entry, {word, 0xffu << bit % 32}, packed_position(octant, 2 * level + 1));
                bit += 7;
                slot += 8;
                continue;
            }
            ++slot;
            if (entry & kLeafBit) {
                add_leaf(entry, {word, flag}, packed_position(cell, 2 * level + 2));
            } else {
                const auto child = static_cast<uint32_t>(first_below + below.size());
                walk_.children.push_back(child);
                walk_.node_cells[child] = {word, flag};
                walk_.node_positions[child] = packed_position(cell, level + 1);
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

// In the grid with 2^depth cells along each side; no leaf is deeper.
CellBounds bounds_of(const std::vector<voctree::LeafPosition>& positions, uint32_t depth) {
    CellBounds bounds{glm::uvec3(UINT32_MAX), glm::uvec3(0)};
    for (const voctree::LeafPosition& position : positions) {
        const glm::uvec3 cell(position.x, position.y, position.z);
        const uint32_t shift = depth - position.depth;
        bounds.low = glm::min(bounds.low, cell << shift);
        bounds.last = glm::max(bounds.last, ((cell + 1u) << shift) - 1u);
    }
    return positions.empty() ? CellBounds{} : bounds;
}

}  // namespace

WalkTree walk_tree(const voctree::VOctree& tree) {
    std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    LeavesOfDepth leaves{};
    for (const voctree::LeafPosition& position : positions) ++leaves[position.depth];
    WalkShape root;
    set_root(root, leaves);
    const uint32_t above = root.scale - 1;
    WalkTree walk;
    if (above == 0 && root.node_levels == tree.node_levels) {
        walk = Walker(tree).take();
    } else {
        voctree::VOctree rooted;
        rooted.node_levels = root.node_levels;
        for (voctree::LeafPosition& position : positions) position.depth += above;
        voctree::build_nodes(rooted, positions);
        walk = Walker(rooted).take();
    }
    set_root(walk, leaves);
    walk.top =
        top_grid(walk.node_levels, bounds_of(positions, 2 * walk.node_levels), walk.level_begin, walk.node_positions);
    return walk;
}

}  // namespace neuvv::render
