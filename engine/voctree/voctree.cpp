#include "voctree/voctree.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "slice/cell_code.h"

namespace neuvv::voctree {

namespace {

constexpr uint64_t kOctantMask = 0xff;

uint64_t mask_of(const TreeNode& node) {
    return uint64_t{node.mask_hi} << 32 | node.mask_lo;
}

// The index of an occupied cell's entry in the child array.
size_t child_slot(const TreeNode& node, uint32_t cell) {
    const uint64_t below = mask_of(node) & ((uint64_t{1} << cell) - 1);
    return size_t{node.first_child} + static_cast<size_t>(std::popcount(below));
}

// Whether a leaf of the node's upper level fills the octant: all eight cells are occupied and have the same leaf entry.
// `slot` is the index of the octant's first entry in the child array.
bool is_whole_octant_leaf(const VOctree& tree, uint64_t mask, uint32_t octant, size_t slot) {
    if ((mask >> (8 * octant) & kOctantMask) != kOctantMask) return false;
    const uint32_t entry = tree.children[slot];
    return (entry & kLeafBit) && std::all_of(&tree.children[slot], &tree.children[slot] + 8,
                                             [entry](uint32_t other) { return other == entry; });
}

struct SortedLeaf {
    uint64_t code;  // first_cell at the finest depth
    uint32_t leaf;
    uint32_t depth;
};

std::vector<SortedLeaf> sort_leaves(const std::vector<LeafPosition>& positions, uint32_t finest_depth) {
    std::vector<SortedLeaf> sorted(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        const LeafPosition& position = positions[i];
        assert(position.depth >= 1 && position.depth <= finest_depth && "leaf depth must fit node_levels");
        assert(std::max({position.x, position.y, position.z}) >> position.depth == 0 && "leaf must lie inside the box");
        sorted[i] = {first_cell(position, finest_depth), static_cast<uint32_t>(i), position.depth};
    }
    const auto is_before = [](const SortedLeaf& a, const SortedLeaf& b) { return a.code < b.code; };
    if (!std::is_sorted(sorted.begin(), sorted.end(), is_before)) std::sort(sorted.begin(), sorted.end(), is_before);
    for ([[maybe_unused]] size_t i = 1; i < sorted.size(); ++i)
        assert(sorted[i].code - sorted[i - 1].code >= uint64_t{1} << (3 * (finest_depth - sorted[i - 1].depth)) &&
               "leaves must not overlap");
    return sorted;
}

// A node and its position among the nodes of its level, 0..4^level−1 on each axis.
struct NodePosition {
    uint32_t node;
    uint32_t x, y, z;
};

NodePosition child_position(const NodePosition& parent, uint32_t node, uint32_t cell) {
    const uint32_t x = (cell & 1) | (cell >> 2 & 2);
    const uint32_t y = (cell >> 1 & 1) | (cell >> 3 & 2);
    const uint32_t z = (cell >> 2 & 1) | (cell >> 4 & 2);
    return {node, parent.x * 4 + x, parent.y * 4 + y, parent.z * 4 + z};
}

}  // namespace

uint64_t first_cell(const LeafPosition& position, uint32_t finest_depth) {
    return slice::code_of({position.x, position.y, position.z}) << (3 * (finest_depth - position.depth));
}

LeafPosition position_of(uint64_t code, uint32_t depth) {
    const glm::uvec3 cell = slice::cell_of(code);
    return {cell.x, cell.y, cell.z, depth};
}

void build_nodes(VOctree& tree, const std::vector<LeafPosition>& positions) {
    assert(tree.node_levels >= 1 && tree.node_levels <= kMaxNodeLevels);
    assert(positions.size() <= kMaxLeaves);
    const std::vector<SortedLeaf> sorted = sort_leaves(positions, 2 * tree.node_levels);

    tree.leaf_count = static_cast<uint32_t>(positions.size());
    tree.nodes.clear();
    tree.children.clear();

    // Breadth first: node i contains the sorted leaves [begin, end), and its child nodes are queued behind all others.
    struct Pending {
        size_t begin, end;
        uint32_t level;
    };
    std::vector<Pending> queue = {{0, sorted.size(), 0}};
    for (size_t at = 0; at < queue.size(); ++at) {
        const Pending pending = queue[at];
        const uint32_t shift = 6 * (tree.node_levels - 1 - pending.level);
        const uint32_t first_child = static_cast<uint32_t>(tree.children.size());
        uint64_t mask = 0;
        for (size_t i = pending.begin; i < pending.end;) {
            const uint64_t prefix = sorted[i].code >> shift;
            const uint32_t cell = prefix & 63;
            const uint32_t entry = sorted[i].leaf | kLeafBit;
            const bool is_leaf = sorted[i].depth <= 2 * pending.level + 2;
            if (sorted[i].depth == 2 * pending.level + 1) {
                mask |= kOctantMask << cell;
                tree.children.insert(tree.children.end(), 8, entry);
            } else {
                mask |= uint64_t{1} << cell;
                tree.children.push_back(is_leaf ? entry : static_cast<uint32_t>(queue.size()));
            }
            const size_t begin = i++;
            if (is_leaf) continue;
            while (i < pending.end && sorted[i].code >> shift == prefix) ++i;
            queue.push_back({begin, i, pending.level + 1});
        }
        tree.nodes.push_back({static_cast<uint32_t>(mask), static_cast<uint32_t>(mask >> 32), first_child, 0});
    }
}

void build_topology(VOctree& tree, const std::vector<LeafPosition>& positions) {
    build_nodes(tree, positions);
    tree.weights.assign(size_t{tree.leaf_count} * tree.weights_per_leaf(), 0.0f);
}

void replace_leaves(VOctree& tree, const std::vector<LeafPosition>& positions, const std::vector<const float*>& from) {
    assert(positions.size() == from.size());
    const std::vector<float> old = std::move(tree.weights);  // kept because `from` may point into it
    build_topology(tree, positions);
    for (uint32_t i = 0; i < tree.leaf_count; ++i) std::copy_n(from[i], tree.weights_per_leaf(), tree.leaf(i));
}

std::vector<LeafPosition> leaf_positions(const VOctree& tree) {
    std::vector<LeafPosition> positions(tree.leaf_count);
    std::vector<NodePosition> level_nodes = {{0, 0, 0, 0}}, next;
    for (uint32_t level = 0; !level_nodes.empty(); ++level, level_nodes.swap(next), next.clear()) {
        for (const NodePosition& here : level_nodes) {
            const TreeNode& node = tree.nodes[here.node];
            const uint64_t mask = mask_of(node);
            size_t slot = node.first_child;
            for (uint32_t cell = 0; cell < 64; ++cell) {
                if (!(mask >> cell & 1)) continue;
                const uint32_t entry = tree.children[slot];
                const NodePosition position = child_position(here, entry & ~kLeafBit, cell);
                if (!(entry & kLeafBit)) {
                    next.push_back(position);
                    ++slot;
                } else if (cell % 8 == 0 && is_whole_octant_leaf(tree, mask, cell / 8, slot)) {
                    positions[position.node] = {position.x / 2, position.y / 2, position.z / 2, 2 * level + 1};
                    cell += 7;
                    slot += 8;
                } else {
                    positions[position.node] = {position.x, position.y, position.z, 2 * level + 2};
                    ++slot;
                }
            }
        }
    }
    return positions;
}

uint32_t find_leaf(const VOctree& tree, glm::dvec3 position_tree) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(position_tree[axis] >= 0 && position_tree[axis] < 1)) return UINT32_MAX;
    // Exact: the product with a power of two does not round.
    const glm::uvec3 finest(position_tree * static_cast<double>(1u << (2 * tree.node_levels)));
    uint32_t node_index = 0;
    for (uint32_t level = 0; level < tree.node_levels; ++level) {
        const glm::uvec3 digit = finest >> (2 * (tree.node_levels - 1 - level)) & 3u;
        const auto cell = static_cast<uint32_t>(slice::code_of({digit.x, digit.y, digit.z}));
        const TreeNode& node = tree.nodes[node_index];
        if (!(mask_of(node) >> cell & 1)) return UINT32_MAX;
        const uint32_t entry = tree.children[child_slot(node, cell)];
        if (entry & kLeafBit) return entry & ~kLeafBit;
        node_index = entry;
    }
    return UINT32_MAX;
}

namespace {

std::string defect_of_sizes(const VOctree& tree) {
    const auto outside = [](const char* what, uint64_t value, uint64_t low, uint64_t high) {
        return value >= low && value <= high ? std::string()
                                             : fmt::format("{} is {}, must be {} to {}", what, value, low, high);
    };
    std::string defect = outside("node_levels", tree.node_levels, 1, kMaxNodeLevels);
    if (defect.empty()) defect = outside("node count", tree.nodes.size(), 1, kMaxNodes);
    if (defect.empty()) defect = outside("leaf count", tree.leaf_count, 0, kMaxLeaves);
    if (defect.empty()) defect = outside("bases", tree.bases, 1, kMaxBases);
    if (defect.empty()) defect = outside("hh_degree", tree.hh_degree, 0, kMaxHhDegree);
    if (defect.empty()) defect = outside("frames", tree.frames, 1, kMaxFrames);
    return defect;
}

// Walks the tree level by level and marks the nodes and leaves that it reaches.
struct TopologyCheck {
    const VOctree& tree;
    std::vector<bool> node_seen = std::vector<bool>(tree.nodes.size());
    std::vector<bool> leaf_seen = std::vector<bool>(tree.leaf_count);
    uint64_t nodes_reached = 0, leaves_reached = 0, entries_used = 0;

    std::string visit_entry(uint32_t entry, bool has_finer_level, std::vector<uint32_t>& next) {
        const bool is_leaf = entry & kLeafBit;
        const uint32_t index = entry & ~kLeafBit;
        const char* kind = is_leaf ? "leaf" : "node";
        const size_t count = is_leaf ? tree.leaf_count : tree.nodes.size();
        std::vector<bool>& seen = is_leaf ? leaf_seen : node_seen;
        if (index >= count) return fmt::format("{} index {} is out of range ({} exist)", kind, index, count);
        if (seen[index]) return fmt::format("{} {} is reached more than once", kind, index);
        if (!is_leaf && !has_finer_level) return fmt::format("node {} lies deeper than node_levels", index);
        seen[index] = true;
        ++(is_leaf ? leaves_reached : nodes_reached);
        if (!is_leaf) next.push_back(index);
        return "";
    }

    std::string visit_node(uint32_t index, bool has_finer_level, std::vector<uint32_t>& next) {
        const TreeNode& node = tree.nodes[index];
        const uint64_t mask = mask_of(node);
        const auto occupied = static_cast<uint32_t>(std::popcount(mask));
        if (uint64_t{node.first_child} + occupied > tree.children.size())
            return fmt::format("node {} has children beyond the child array", index);
        entries_used += occupied;
        size_t slot = node.first_child;
        for (uint32_t octant = 0; octant < 8; ++octant) {
            const auto cells = static_cast<size_t>(std::popcount(mask >> (8 * octant) & kOctantMask));
            const size_t visits = is_whole_octant_leaf(tree, mask, octant, slot) ? 1 : cells;
            for (size_t i = 0; i < visits; ++i) {
                std::string defect = visit_entry(tree.children[slot + i], has_finer_level, next);
                if (!defect.empty()) return fmt::format("node {}: {}", index, defect);
            }
            slot += cells;
        }
        return "";
    }
};

std::string defect_of_numbers(const VOctree& tree) {
    for (int axis = 0; axis < 3; ++axis) {
        // The size must be a normal number, so that its reciprocal is finite in a shader.
        if (!std::isfinite(tree.box_min[axis]) || !std::isnormal(tree.box_size[axis]) || tree.box_size[axis] < 0 ||
            !std::isfinite(tree.box_min[axis] + tree.box_size[axis]))
            return "the box must be finite and of positive size";
    }
    if (!std::isnormal(tree.fps) || tree.fps < 0) return "fps must be finite and positive";

    const auto check = [](const char* what, const std::vector<float>& values, uint64_t expected) -> std::string {
        if (values.size() != expected) return fmt::format("{} has {} numbers, not {}", what, values.size(), expected);
        const auto bad = std::find_if(values.begin(), values.end(), [](float v) { return !std::isfinite(v); });
        if (bad != values.end()) return fmt::format("{}: number {} is not finite", what, bad - values.begin());
        return "";
    };
    const uint64_t rows = uint64_t{tree.frames} * tree.bases;
    std::string defect = check("sigma basis", tree.sigma_basis, rows);
    if (defect.empty()) defect = check("gamma basis", tree.gamma_basis, rows);
    if (defect.empty()) defect = check("weights", tree.weights, uint64_t{tree.leaf_count} * tree.weights_per_leaf());
    return defect;
}

}  // namespace

std::string defect_of_topology(const VOctree& tree) {
    std::string defect = defect_of_sizes(tree);
    if (!defect.empty()) return defect;
    TopologyCheck check{tree};
    check.node_seen[0] = true;
    check.nodes_reached = 1;
    std::vector<uint32_t> level_nodes = {0}, next;
    for (uint32_t level = 0; !level_nodes.empty(); ++level, level_nodes.swap(next), next.clear()) {
        for (const uint32_t index : level_nodes) {
            defect = check.visit_node(index, level + 1 < tree.node_levels, next);
            if (!defect.empty()) return defect;
        }
    }
    if (check.nodes_reached != tree.nodes.size())
        return fmt::format("{} nodes are not reached", tree.nodes.size() - check.nodes_reached);
    if (check.leaves_reached != tree.leaf_count)
        return fmt::format("{} leaves are not reached", tree.leaf_count - check.leaves_reached);
    if (check.entries_used != tree.children.size())
        return fmt::format("the child array has {} entries, but nodes use {}", tree.children.size(),
                           check.entries_used);
    return "";
}

std::string defect_of(const VOctree& tree) {
    const std::string defect = defect_of_topology(tree);
    return defect.empty() ? defect_of_numbers(tree) : defect;
}

}  // namespace neuvv::voctree
