#include "training/tree/surroundings_tree.h"

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "training/tree/first_tree.h"
#include "training/tree/hull_box.h"
#include "training/tree/silhouettes.h"
#include "voctree/temporal_basis.h"

namespace neuvv::training {

namespace {

// Half of the box's side, in median distances of cameras from the point that they look at.
constexpr double kSurroundingsReach = 8;
// There is no leaf so near to a camera, as a share of its distance from that point, nor where a smaller share of the
// cameras, and fewer than so many, look. Matter there would explain the images of the few that see it, and hide all
// else from others.
constexpr double kNearest = 0.4, kSeenShare = 0.1;
constexpr size_t kSeenByEnough = 8;
// The optical depth of a first leaf over its edge. A ray crosses some dozen leaves at each doubling of its distance,
// and should still reach the last of them.
constexpr float kFaintOpacity = 0.02f;
constexpr uint32_t kLeastDepthOfLeaf = 3;  // octree depth

bool is_right_before_a_camera(const Dataset& dataset, glm::dvec3 position, glm::dvec3 centre) {
    return std::ranges::any_of(dataset.cameras, [&](const stage::Camera& camera) {
        const glm::dvec3 eye(camera.world_from_camera[3]);
        return glm::length(eye - position) < kNearest * glm::length(eye - centre);
    });
}

// Those leaves that enough cameras see.
Carved seen_by_enough(const Dataset& dataset, const voctree::VOctree& tree,
                      const std::vector<voctree::LeafPosition>& positions) {
    std::vector<HullCell> cells(positions.size());
    for (size_t i = 0; i < cells.size(); ++i) cells[i] = hull_cell(tree, positions[i], 2 * kMaxNodeLevels);
    const std::vector<Silhouette> silhouettes = silhouettes_at(dataset, dataset.times[0]);
    const double share = kSeenShare * static_cast<double>(silhouettes.size());
    const size_t least = std::max(std::min(static_cast<size_t>(share), kSeenByEnough), min_witnesses(silhouettes));
    std::vector<uint16_t> witnesses(cells.size());
    parallel_for(cells.size(), 4096, [&](size_t begin, size_t end) {
        const std::vector<Witnesses> found = count_witnesses(silhouettes, {&cells[begin], end - begin});
        for (size_t i = begin; i < end; ++i) witnesses[i] = found[i - begin].all;
    });
    Carved seen;
    for (size_t i = 0; i < cells.size(); ++i)
        if (witnesses[i] >= least) seen.positions.push_back(positions[i]);
    seen.bits.assign(seen.positions.size(), 1);
    return seen;
}

double median_distance(const Dataset& dataset, glm::dvec3 from) {
    std::vector<double> distances;
    for (const stage::Camera& camera : dataset.cameras)
        distances.push_back(glm::length(glm::dvec3(camera.world_from_camera[3]) - from));
    const auto middle = distances.begin() + static_cast<ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
}

}  // namespace

double leaf_pixels_of(const Dataset& dataset, uint32_t resolution) {
    uint32_t longest = 1;
    for (const stage::Camera& camera : dataset.cameras) longest = std::max({longest, camera.width, camera.height});
    return std::max(1.0, static_cast<double>(longest) / resolution);
}

voctree::VOctree surroundings_tree(const Dataset& dataset, double leaf_pixels, uint32_t hh_degree) {
    const auto box = first_box(dataset);
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    const double distance = median_distance(dataset, centre), half = kSurroundingsReach * distance;
    voctree::VOctree tree;
    tree.frames = tree.bases = 1;
    tree.hh_degree = hh_degree;
    tree.fps = static_cast<float>(dataset.fps > 0 ? dataset.fps : 25.0);
    tree.node_levels = kMaxNodeLevels;
    tree.box_size = glm::vec3(static_cast<float>(2 * half));
    tree.box_min = glm::vec3(centre - half);
    tree.sigma_basis = voctree::hat_basis(tree.frames, tree.bases);
    tree.gamma_basis = tree.sigma_basis;

    constexpr uint32_t kDeepest = 2 * kMaxNodeLevels - kSurroundingsLevels;
    const double pixels = leaf_pixels * (1u << kSurroundingsLevels);
    // Cells that hold a camera or lie near one are judged once they are small.
    std::vector<voctree::LeafPosition> open = {{0, 0, 0, 0}}, small;
    while (!open.empty()) {
        std::vector<voctree::LeafPosition> finer;
        for (const voctree::LeafPosition& position : open) {
            const double edge = static_cast<double>(tree.box_size.x) / (1u << position.depth);
            const glm::dvec3 at = hull_cell(tree, position, 0).centre;
            const bool is_small = edge <= pixels * footprint_at(dataset, at) && position.depth >= kLeastDepthOfLeaf;
            if (!is_small && position.depth < kDeepest)
                append_children(finer, position);
            else if (!is_right_before_a_camera(dataset, at, centre))
                small.push_back(position);
        }
        open = std::move(finer);
    }
    const Carved leaves = seen_by_enough(dataset, tree, small);
    if (leaves.positions.empty())
        throw InputError(dataset.folder.string(), "", "no place is seen by enough cameras",
                         "check that poses are camera-to-world with OpenGL axes");
    voctree::build_topology(tree, leaves.positions);
    set_first_weights(dataset, tree, leaves, kFaintOpacity);
    return tree;
}

}  // namespace neuvv::training
