#include "render/volume/slices/slice_layout.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "render/volume/slices/packed_position.h"

namespace neuvv::render {

namespace {

struct LayoutNode {
    uint64_t code = 0;             // Morton code at its depth
    uint64_t live = 0, inner = 0;  // its cells with leaves or nodes, and those with nodes
    glm::uvec3 corner{0};          // in nodes of its size
    uint32_t first_entry = 0;      // of its level's
    uint32_t wide = 0;             // octants that one leaf fills
};

struct LayoutLevel {
    std::vector<LayoutNode> nodes;
    std::vector<uint32_t> node_entries;  // per node of the next level: its entry, of this level's
    uint32_t entries = 0;
};

// Where a leaf lies.
struct PlacedLeaf {
    glm::uvec3 at;   // in cells of its own size
    uint32_t entry;  // of its level's
};

// Sorts leaves, which come in the order of their cells, into nodes. Each level is filled from its first node to its
// last, because that order is the same at every depth.
class LayoutBuilder {
  public:
    explicit LayoutBuilder(uint32_t node_levels) : depth_(2 * node_levels), levels_(node_levels) {
        levels_[0].nodes.emplace_back();
    }

    // `code`: of the leaf's first cell at depth 2 · node_levels.
    PlacedLeaf add(uint64_t code, uint32_t depth) {
        const uint32_t at = (depth - 1) / 2;
        LayoutLevel& level = levels_[at];
        if (level.nodes.empty() || level.nodes.back().code != node_code(code, at)) open_until(at, code);
        LayoutNode& node = level.nodes.back();
        const uint32_t bit = cell_of(code, at);
        const glm::uvec3 octant = 2u * node.corner + octant_offset(bit >> 3);
        if (depth % 2 == 0) {
            node.live |= uint64_t{1} << bit;
            return {2u * octant + octant_offset(bit & 7), level.entries++};
        }
        node.live |= uint64_t{0xff} << bit;
        node.wide |= 1u << bit / 8;
        return {octant, level.entries++};
    }
    const std::vector<LayoutLevel>& levels() const { return levels_; }

  private:
    uint64_t node_code(uint64_t code, uint32_t level) const { return code >> 3 * (depth_ - 2 * level); }
    uint32_t cell_of(uint64_t code, uint32_t level) const {
        return static_cast<uint32_t>(code >> 3 * (depth_ - 2 * level - 2) & 63);
    }
    // Begins the nodes around a cell, down to a level, that are not there yet.
    void open_until(uint32_t at, uint64_t code) {
        for (uint32_t i = 1; i <= at; ++i) {
            const uint64_t own = node_code(code, i);
            LayoutLevel &level = levels_[i], &above = levels_[i - 1];
            if (!level.nodes.empty() && level.nodes.back().code == own) continue;
            const uint32_t bit = cell_of(code, i - 1);
            LayoutNode& parent = above.nodes.back();
            parent.live |= uint64_t{1} << bit;
            parent.inner |= uint64_t{1} << bit;
            above.node_entries.push_back(above.entries++);
            const glm::uvec3 corner = 2u * (2u * parent.corner + octant_offset(bit >> 3)) + octant_offset(bit & 7);
            level.nodes.push_back({own, 0, 0, corner, level.entries, 0});
        }
    }
    const uint32_t depth_;
    std::vector<LayoutLevel> levels_;
};

glm::uvec2 mask_words(uint64_t mask) {
    return {static_cast<uint32_t>(mask), static_cast<uint32_t>(mask >> 32)};
}

// Lays the levels' nodes and entries behind each other.
void join_levels(const std::vector<LayoutLevel>& levels, SliceLayout& layout) {
    for (uint32_t at = 0; at < levels.size(); ++at) {
        const auto first_child = static_cast<uint32_t>(layout.nodes.size() + levels[at].nodes.size());
        layout.level_begin.push_back(static_cast<uint32_t>(layout.nodes.size()));
        for (const LayoutNode& node : levels[at].nodes) {
            layout.nodes.emplace_back(mask_words(node.live), layout.entries + node.first_entry, node.wide);
            layout.inner_cells.push_back(mask_words(node.inner));
            layout.node_positions.push_back(packed_position(node.corner, at));
        }
        for (uint32_t child = 0; child < levels[at].node_entries.size(); ++child)
            layout.node_entries.push_back({layout.entries + levels[at].node_entries[child], first_child + child});
        layout.entries += levels[at].entries;
    }
    layout.level_begin.push_back(static_cast<uint32_t>(layout.nodes.size()));
}

// Of the 64 cells of a node, those whose place along an axis is so many cells.
constexpr auto kCellsAlong = [] {
    std::array<std::array<uint64_t, 4>, 3> cells{};
    for (uint32_t bit = 0; bit < 64; ++bit)
        for (uint32_t axis = 0; axis < 3; ++axis)
            cells[axis][2 * (bit >> (3 + axis) & 1) + (bit >> axis & 1)] |= uint64_t{1} << bit;
    return cells;
}();

// Around all leaves, in cells of the finest depth.
CellBounds bounds_of(const std::vector<LayoutLevel>& levels) {
    CellBounds bounds{glm::uvec3(UINT32_MAX), glm::uvec3(0)};
    for (uint32_t at = 0; at < levels.size(); ++at) {
        const auto shift = static_cast<uint32_t>(2 * (levels.size() - 1 - at));
        for (const LayoutNode& node : levels[at].nodes)
            for (uint32_t axis = 0; axis < 3; ++axis)
                for (uint32_t along = 0; along < 4; ++along) {
                    if (!((node.live & ~node.inner) & kCellsAlong[axis][along])) continue;
                    const auto place = static_cast<int>(axis);
                    const uint32_t cell = 4 * node.corner[place] + along;
                    bounds.low[place] = std::min(bounds.low[place], cell << shift);
                    bounds.last[place] = std::max(bounds.last[place], ((cell + 1) << shift) - 1);
                }
    }
    return bounds;
}

// How many leaves with opacity each depth has.
LeavesOfDepth count_leaves(const stream::QuantisedSlice& slice) {
    LeavesOfDepth counts{};
    const int16_t* opacity = slice.planes[stream::kOpacityPlane].data();
    for (size_t i = 0; i < slice.leaves.size(); ++i) counts[slice.leaves[i].depth] += opacity[i] > 0 ? 1 : 0;
    return counts;
}

}  // namespace

SliceLayout slice_layout(const stream::QuantisedSlice& slice, std::span<glm::uvec2> positions) {
    assert(positions.size() == slice.leaves.size() && slice.depth < LeavesOfDepth().size());
    SliceLayout layout;
    set_root(layout, count_leaves(slice));
    LayoutBuilder builder(layout.node_levels);
    const uint32_t above = layout.scale - 1, depth = slice.depth + above, finest = 2 * layout.node_levels;
    const int16_t* opacity = slice.planes[stream::kOpacityPlane].data();
    layout.entry_of_leaf.resize(slice.leaves.size(), kNoLeaf);
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        const uint64_t cell = slice.leaves[i].cell;
        const uint32_t own_depth = slice.leaves[i].depth + above;
        if (opacity[i] <= 0) {
            positions[i] = packed_position(glm::uvec3(0), own_depth);  // nothing refers to it
            continue;
        }
        const PlacedLeaf placed =
            builder.add(depth > finest ? cell >> 3 * (depth - finest) : cell << 3 * (finest - depth), own_depth);
        positions[i] = packed_position(placed.at, own_depth);
        layout.entry_of_leaf[i] = placed.entry;
    }
    join_levels(builder.levels(), layout);
    const CellBounds bounds = layout.entries == 0 ? CellBounds{} : bounds_of(builder.levels());
    layout.top = top_grid(layout.node_levels, bounds, layout.level_begin, layout.node_positions);
    layout.entries_before.resize(slice.depth + 1);
    for (uint32_t leaf_depth = 1, before = 0, level = 0; leaf_depth <= slice.depth; ++leaf_depth) {
        for (; level < (leaf_depth + above - 1) / 2 && level < builder.levels().size(); ++level)
            before += builder.levels()[level].entries;
        layout.entries_before[leaf_depth] = before;
    }
    return layout;
}

}  // namespace neuvv::render
