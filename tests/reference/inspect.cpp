#include "reference/inspect.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace neuvv::reference {

namespace {

struct NodeInterval {
    WalkNode node;
    Interval along;
};

bool is_child(const WalkNode& child, const WalkNode& node) {
    return child.level == node.level + 1 && child.cell / 4u == node.cell;
}

// The innermost node that a walk meets at a position of the ray (metres).
const NodeInterval* innermost(const std::vector<NodeInterval>& met, uint32_t grid_levels, double at) {
    const NodeInterval* found = nullptr;
    for (const NodeInterval& one : met)
        if (one.along.enter <= at && at < one.along.exit && (one.node.level <= grid_levels || one.node.lives) &&
            (!found || one.node.level > found->node.level))
            found = &one;
    return found;
}

// The number of nodes that a walk over `range` meets which ends with the leaf that begins at `last` (metres).
uint32_t count_nodes(const std::vector<NodeInterval>& met, uint32_t grid_levels, Interval range, double last) {
    uint32_t count = 0;
    for (double at = range.enter; at < range.exit && at <= last;) {
        const NodeInterval* node = innermost(met, grid_levels, at);
        if (!node) break;
        ++count;
        double next = node->along.exit;
        for (const NodeInterval& child : met)
            if (is_child(child.node, node->node) && child.node.lives && child.along.enter > at)
                next = std::min(next, child.along.enter);
        at = next;
    }
    return count;
}

}  // namespace

WalkNodes walk_nodes(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, uint32_t levels_above,
                     uint32_t grid_levels, bool pruned) {
    WalkNodes walk;
    walk.leaves = voctree::leaf_positions(tree);
    walk.levels_above = levels_above;
    walk.grid_levels = grid_levels;
    walk.box_first = glm::uvec3(UINT32_MAX);
    std::map<std::tuple<uint32_t, uint32_t, uint32_t, uint32_t>, bool> lives;
    for (size_t leaf = 0; leaf < walk.leaves.size(); ++leaf) {
        const voctree::LeafPosition& position = walk.leaves[leaf];
        const uint32_t depth = position.depth + levels_above;
        for (uint32_t level = 0; 2 * level < depth; ++level) {
            const uint32_t shift = depth - 2 * level;
            lives[{level, position.x >> shift, position.y >> shift, position.z >> shift}] |=
                !pruned || slices[leaf].sigma > 0;
        }
        const double cells = std::exp2(2.0 * grid_levels - depth);  // of the grid, a leaf's edge
        const glm::dvec3 first = cells * glm::dvec3(position.x, position.y, position.z);
        walk.box_first = glm::min(walk.box_first, glm::uvec3(glm::floor(first)));
        walk.box_end = glm::max(walk.box_end, glm::uvec3(glm::ceil(first + cells)));
    }
    for (const auto& [at, any] : lives) {
        const auto [level, x, y, z] = at;
        walk.nodes.push_back({level, {x, y, z}, any});
    }
    return walk;
}

Inspected inspect(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const WalkNodes& walk,
                  bool pruned, const InspectedRay& of) {
    Inspected result;
    double transmittance = 1, last = INFINITY;
    for (const LeafInterval& interval : intersect(tree, of.ray)) {
        const double sigma = slices[interval.leaf].sigma;
        if (pruned && sigma <= 0) continue;
        ++result.leaves;
        const double threshold = 1 - 0.5 / of.opacity;
        const double after = transmittance * std::exp(-sigma * (interval.t_exit - interval.t_enter));
        if (result.level == 0 && after <= threshold) {
            result.level = walk.leaves[interval.leaf].depth;
            result.distance_m = interval.t_enter + std::log(transmittance / threshold) / sigma;
        }
        transmittance = after;
        if (transmittance >= of.stop) continue;
        last = interval.t_enter;
        break;
    }
    result.alpha = of.opacity * (1 - transmittance);
    std::vector<NodeInterval> met;
    const double above = std::exp2(walk.levels_above);
    for (const WalkNode& node : walk.nodes) {
        const Interval along =
            intersect_box(tree, of.ray, node.cell, node.cell + 1u, std::exp2(2.0 * node.level) / above);
        if (!along.empty()) met.push_back({node, along});
    }
    Interval range = of.range;
    const double side = std::exp2(2.0 * walk.grid_levels) / above;
    const Interval box = intersect_box(tree, of.ray, walk.box_first, walk.box_end, side);
    range = {std::max(range.enter, box.enter), std::min(range.exit, box.exit)};
    result.nodes = count_nodes(met, walk.grid_levels, range, last);
    return result;
}

// One polynomial for each channel.
glm::dvec3 viridis(double at) {
    const double terms[3][7] = {{0.2769, -0.1374, 2.0837, -13.1681, 20.1448, -5.8875, -2.3292},
                                {0.0038, 1.4892, -0.7281, -2.0212, 7.3047, -7.9009, 2.7574},
                                {0.3377, 0.9541, 5.1219, -40.5236, 97.2847, -101.2765, 38.2373}};
    glm::dvec3 colour(0);
    for (int channel = 0; channel < 3; ++channel)
        for (int power = 0; power < 7; ++power) colour[channel] += terms[channel][power] * std::pow(at, power);
    return glm::clamp(colour, 0.0, 1.0);
}

}  // namespace neuvv::reference
