#include "training/tree/first_tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "shared/trace.h"
#include "training/tree/bases.h"
#include "training/tree/carved_leaves.h"
#include "training/tree/first_colours.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

// The optical depth over its edge of a leaf in frames in which the hull allows matter.
constexpr float kInitialOpacity = 0.7f;
constexpr uint32_t kFirstDepth = 4;  // octree depth of the grid with which carving begins

// Removes the cells in which the grid has no matter.
void remove_empty(const MatterGrid& grid, const voctree::VOctree& tree, std::vector<voctree::LeafPosition>& positions) {
    std::erase_if(positions, [&](const voctree::LeafPosition& p) {
        const double edge = static_cast<double>(tree.box_size.x) / (1u << p.depth);
        const glm::dvec3 low = glm::dvec3(tree.box_min) + edge * glm::dvec3(p.x, p.y, p.z);
        return !grid.overlaps({low, low + edge});
    });
}

// The weight of the constant function H_000 = 1/(π√2) that gives this linear value after the sigmoid.
float constant_weight(float linear) {
    const float value = std::clamp(linear, 0.005f, 0.98f);
    return std::numbers::pi_v<float> * std::numbers::sqrt2_v<float> * std::log(value / (1 - value));
}

}  // namespace

uint32_t depth_of_resolution(uint32_t resolution) {
    uint32_t depth = 1;
    while ((1u << depth) < resolution) ++depth;
    return depth;
}

uint32_t natural_resolution(const Dataset& dataset, const std::pair<glm::dvec3, glm::dvec3>& box) {
    const glm::dvec3 centre = 0.5 * (box.first + box.second), size = box.second - box.first;
    std::vector<double> footprints;
    for (const stage::Camera& camera : dataset.cameras)
        footprints.push_back(glm::length(glm::dvec3(camera.world_from_camera[3]) - centre) / camera.fx);
    std::nth_element(footprints.begin(), footprints.begin() + static_cast<ptrdiff_t>(footprints.size() / 2),
                     footprints.end());
    const double resolution = std::max({size.x, size.y, size.z}) / footprints[footprints.size() / 2];
    return static_cast<uint32_t>(std::clamp(std::round(resolution), 32.0, 512.0));
}

void set_first_weights(const Dataset& dataset, voctree::VOctree& tree, const Carved& carved, float optical_depth) {
    const BasisSolver solver(tree.sigma_basis, tree.frames, tree.bases);
    const std::vector<float> gamma = voctree::initial_gamma_weights(tree.bases);
    tree.weights.assign(size_t{tree.leaf_count} * tree.weights_per_leaf(), 0);
    std::vector<glm::vec3> centres(tree.leaf_count);
    for (size_t i = 0; i < centres.size(); ++i) centres[i] = hull_cell(tree, carved.positions[i], 0).centre;
    const std::vector<glm::vec3> colours = first_colours(dataset, centres, carved.bits);
    parallel_for(tree.leaf_count, 1024, [&](size_t begin, size_t end) {
        std::vector<float> values(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            std::fill(values.begin(), values.end(), density_of(tree, carved.positions[i].depth, optical_depth));
            fit_to_hull(dataset, tree, carved, i, values);
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            solver.solve(values.data(), leaf);
            std::copy(gamma.begin(), gamma.end(), leaf + tree.bases);
            for (uint32_t channel = 0; channel < 3; ++channel)
                leaf[2 * tree.bases + channel * hh_count(tree.hh_degree)] =
                    constant_weight(colours[i][static_cast<int>(channel)]);
        }
    });
}

uint32_t reach_of_hull(const Dataset& dataset, const glm::vec3& box_min, const glm::vec3& box_size, uint32_t depth,
                       double margin) {
    // A leaf is kept where the ball around it touches the matte, so its far corner lies a diagonal beyond the outline.
    const double edge = static_cast<double>(box_size.x) / (1u << depth);
    const double beyond = std::sqrt(3.0) * edge + margin;
    const double pixels = beyond / footprint_at(dataset, glm::dvec3(box_min) + 0.5 * glm::dvec3(box_size));
    return std::max(kLeastReach, static_cast<uint32_t>(std::ceil(std::min(pixels / kTile, 1e6))));
}

voctree::VOctree initial_tree(const Dataset& dataset, TreeShape shape, uint32_t levels_above) {
    const MatterGrid grid = find_matter(dataset);
    const auto& box = grid.tight_box;
    const uint32_t resolution = shape.resolution > 0 ? shape.resolution : natural_resolution(dataset, box);
    const uint32_t depth = depth_of_resolution(resolution);
    voctree::VOctree tree;
    tree.frames = static_cast<uint32_t>(dataset.times.size());
    tree.fps = static_cast<float>(dataset.fps > 0 ? dataset.fps : 25.0);
    tree.bases = std::min(shape.bases, tree.frames);
    tree.hh_degree = shape.hh_degree;
    tree.node_levels = (depth + 1) / 2;
    const glm::dvec3 size = box.second - box.first;
    const double side = std::max({size.x, size.y, size.z}) / resolution * (1u << depth);
    tree.box_size = glm::vec3(static_cast<float>(side));
    tree.box_min = glm::vec3(0.5 * (box.first + box.second) - 0.5 * side);
    tree.sigma_basis = voctree::hat_basis(tree.frames, tree.bases);
    tree.gamma_basis = tree.sigma_basis;

    const uint32_t target = std::max(depth - std::min(levels_above, depth - 1), 1u);
    const uint32_t start = std::min(kFirstDepth, target);
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t z = 0; z < 1u << start; ++z)
        for (uint32_t y = 0; y < 1u << start; ++y)
            for (uint32_t x = 0; x < 1u << start; ++x) positions.push_back({x, y, z, start});
    remove_empty(grid, tree, positions);
    Carved carved = keep_allowed(dataset, tree, positions, depth, shape.hull_margin);
    for (uint32_t at = start; at < target; ++at) {
        std::vector<voctree::LeafPosition> finer;
        for (const voctree::LeafPosition& position : carved.positions) append_children(finer, position);
        remove_empty(grid, tree, finer);
        carved = keep_allowed(dataset, tree, finer, depth, shape.hull_margin);
    }
    if (carved.positions.empty())
        throw InputError(dataset.folder.string(), "", "the mattes leave no matter at this resolution",
                         Remedy::kHigherResolution);
    voctree::build_topology(tree, carved.positions);
    set_first_weights(dataset, tree, carved, kInitialOpacity);
    return tree;
}

}  // namespace neuvv::training
