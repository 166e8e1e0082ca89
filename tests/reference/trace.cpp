#include "reference/trace.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace neuvv::reference {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A ray in tree space; its parameter t is still in metres of the world.
struct TreeRay {
    glm::dvec3 origin;
    glm::dvec3 direction;
    double t_min;
};

// The part of the ray between two planes of one axis. Two cells that share a plane get the same t for it, bit for bit.
Interval slab(double origin, double direction, double low, double high) {
    if (direction == 0) {
        const bool inside = low <= origin && origin < high;
        return inside ? Interval{-kInfinity, kInfinity} : Interval{0, 0};
    }
    const double t_low = (low - origin) / direction;
    const double t_high = (high - origin) / direction;
    return {std::min(t_low, t_high), std::max(t_low, t_high)};
}

// The part of the ray inside some cells of a grid that divides the tree's box into `side` cells along each axis.
Interval box_interval(const TreeRay& ray, glm::uvec3 first, glm::uvec3 end, double side) {
    Interval result{ray.t_min, kInfinity};
    for (int axis = 0; axis < 3; ++axis) {
        const Interval along = slab(ray.origin[axis], ray.direction[axis], first[axis] / side, end[axis] / side);
        result.enter = std::max(result.enter, along.enter);
        result.exit = std::min(result.exit, along.exit);
    }
    return result;
}

// The child entry of cell 0..63 of a node (shared/tree.h), if occupied.
std::optional<uint32_t> child_of(const voctree::VOctree& tree, uint32_t node_index, uint32_t cell) {
    const TreeNode& node = tree.nodes[node_index];
    const uint64_t mask = uint64_t{node.mask_hi} << 32 | node.mask_lo;
    if ((mask >> cell & 1) == 0) return std::nullopt;
    const uint64_t below = mask & ((uint64_t{1} << cell) - 1);
    return tree.children[node.first_child + static_cast<uint32_t>(std::popcount(below))];
}

// The leaf that fills all eight cells of an octant, if one does.
std::optional<uint32_t> octant_leaf(const voctree::VOctree& tree, uint32_t node_index, uint32_t octant) {
    const std::optional<uint32_t> first = child_of(tree, node_index, octant * 8);
    if (!first || (*first & kLeafBit) == 0) return std::nullopt;
    for (uint32_t i = 1; i < 8; ++i) {
        if (child_of(tree, node_index, octant * 8 + i) != first) return std::nullopt;
    }
    return *first & ~kLeafBit;
}

// Morton bits z y x of an octant, or of a cell in its octant.
glm::uvec3 offset_of(uint32_t bits) {
    return {bits & 1, bits >> 1 & 1, bits >> 2 & 1};
}

// `corner` is the node's position among the nodes of its level, of which the box has `side` along each axis.
void visit_node(const voctree::VOctree& tree, const TreeRay& ray, uint32_t node_index, glm::uvec3 corner, double side,
                std::vector<LeafInterval>& intervals) {
    for (uint32_t octant = 0; octant < 8; ++octant) {
        const glm::uvec3 octant_cell = corner * 2u + offset_of(octant);
        const Interval in_octant = box_interval(ray, octant_cell, octant_cell + 1u, side * 2);
        if (in_octant.empty()) continue;
        if (const auto leaf = octant_leaf(tree, node_index, octant)) {
            intervals.push_back({*leaf, in_octant.enter, in_octant.exit});
            continue;
        }
        for (uint32_t i = 0; i < 8; ++i) {
            const std::optional<uint32_t> child = child_of(tree, node_index, octant * 8 + i);
            if (!child) continue;
            const glm::uvec3 cell = octant_cell * 2u + offset_of(i);
            const Interval in_cell = box_interval(ray, cell, cell + 1u, side * 4);
            if (in_cell.empty()) continue;
            if ((*child & kLeafBit) != 0) {
                intervals.push_back({*child & ~kLeafBit, in_cell.enter, in_cell.exit});
            } else {
                visit_node(tree, ray, *child, cell, side * 4, intervals);
            }
        }
    }
}

Sample sample_of(const LeafInterval& interval, double sigma, glm::dvec3 colour) {
    return {sigma, colour, interval.t_exit - interval.t_enter, 0.5 * (interval.t_enter + interval.t_exit)};
}

TreeRay in_tree(const voctree::VOctree& tree, const Ray& ray) {
    const glm::dvec3 box_size(tree.box_size);
    return {(ray.origin - glm::dvec3(tree.box_min)) / box_size, ray.direction / box_size, ray.t_min};
}

}  // namespace

Interval intersect_box(const voctree::VOctree& tree, const Ray& ray, glm::uvec3 first, glm::uvec3 end, double side) {
    return box_interval(in_tree(tree, ray), first, end, side);
}

std::vector<LeafInterval> intersect(const voctree::VOctree& tree, const Ray& ray) {
    std::vector<LeafInterval> intervals;
    if (tree.nodes.empty()) return intervals;
    visit_node(tree, in_tree(tree, ray), 0, glm::uvec3(0), 1, intervals);
    std::sort(intervals.begin(), intervals.end(),
              [](const LeafInterval& a, const LeafInterval& b) { return a.t_enter < b.t_enter; });
    return intervals;
}

std::vector<Sample> ray_samples(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray) {
    std::vector<Sample> samples;
    for (const LeafInterval& interval : intersect(tree, ray)) {
        const LeafSlice& leaf = slices[interval.leaf];
        samples.push_back(sample_of(interval, leaf.sigma, sample_colour(leaf, tree.hh_degree, ray.direction)));
    }
    return samples;
}

std::vector<Sample> ray_samples_shaded(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                       const std::vector<voctree::LeafPosition>& positions, glm::dvec3 eye,
                                       const Ray& ray) {
    std::vector<Sample> samples;
    for (const LeafInterval& interval : intersect(tree, ray)) {
        const voctree::LeafPosition& position = positions[interval.leaf];
        const glm::dvec3 centre_tree =
            (glm::dvec3(position.x, position.y, position.z) + 0.5) / std::exp2(position.depth);
        const glm::dvec3 centre = glm::dvec3(tree.box_min) + centre_tree * glm::dvec3(tree.box_size);
        const LeafSlice& leaf = slices[interval.leaf];
        samples.push_back(
            sample_of(interval, leaf.sigma, sample_colour(leaf, tree.hh_degree, glm::normalize(centre - eye))));
    }
    return samples;
}

std::vector<Sample> ray_samples_direct(const voctree::VOctree& tree, double frame, const Ray& ray) {
    const FrameRows rows = frame_rows(frame, tree.frames);
    const std::vector<double> row_a = basis_row(tree.sigma_basis, tree.bases, rows);
    const std::vector<double> row_b = basis_row(tree.gamma_basis, tree.bases, rows);
    std::vector<Sample> samples;
    for (const LeafInterval& interval : intersect(tree, ray)) {
        const LeafWeights weights = leaf_weights(tree, interval.leaf);
        const LeafSlice leaf = slice(weights, row_a, row_b, tree.hh_degree);
        const glm::dvec3 colour = sample_colour_direct(weights, leaf.gamma, tree.hh_degree, ray.direction);
        samples.push_back(sample_of(interval, leaf.sigma, colour));
    }
    return samples;
}

RayResult trace(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const Ray& ray,
                double stop_transmittance) {
    return composite(ray_samples(tree, slices, ray), stop_transmittance);
}

RayResult trace_direct(const voctree::VOctree& tree, double frame, const Ray& ray, double stop_transmittance) {
    return composite(ray_samples_direct(tree, frame, ray), stop_transmittance);
}

std::vector<LeafSliceGradient> trace_adjoint(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices,
                                             const Ray& ray, glm::dvec3 d_colour, double d_alpha,
                                             double stop_transmittance) {
    const std::vector<LeafInterval> intervals = intersect(tree, ray);
    const std::vector<SampleGradient> by_sample =
        composite_adjoint(ray_samples(tree, slices, ray), d_colour, d_alpha, stop_transmittance);
    std::vector<LeafSliceGradient> gradient;
    for (size_t i = 0; i < intervals.size(); ++i) {
        const uint32_t leaf = intervals[i].leaf;
        gradient.push_back({leaf, by_sample[i].sigma,
                            sample_colour_adjoint(slices[leaf], tree.hh_degree, ray.direction, by_sample[i].colour)});
    }
    return gradient;
}

}  // namespace neuvv::reference
