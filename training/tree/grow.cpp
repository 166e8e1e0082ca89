#include "training/tree/grow.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "shared/trace.h"
#include "training/tree/bases.h"
#include "training/tree/first_colours.h"
#include "training/tree/hull.h"
#include "training/tree/hull_box.h"

namespace neuvv::training {

namespace {

// Optical depths over a leaf's edge: minus the first where a leaf must be empty, the second for leaves of the first
// tree in frames in which the hull allows matter.
constexpr float kForbiddenOpacity = 0.1f, kInitialOpacity = 0.7f;
// A leaf that rays hardly use, but that has this optical depth over its edge, counts as hidden by other leaves. It
// stays, as what hides it may become thinner. Without such leaves bodies are hollow, and a hole in their front shows
// what is behind them. Leaves that the hull allows outside all images stay by this rule, too.
constexpr float kHiddenDepth = 0.1f;
constexpr uint32_t kFirstDepth = 4;  // octree depth of the grid with which carving begins

// The ball by which a leaf is carved. That of a coarse leaf encloses it, so that no child is lost. That of a leaf of
// the finest depth is smaller: a hull that misses matter in corners of leaves is better than one with a fringe of empty
// leaves, which training would have to clear.
HullCell hull_cell(const voctree::VOctree& tree, const voctree::LeafPosition& position, uint32_t finest,
                   double margin = 0) {
    const float edge = tree.box_size.x / static_cast<float>(1u << position.depth);
    const glm::vec3 centre = tree.box_min + edge * (glm::vec3(position.x, position.y, position.z) + 0.5f);
    const float radius = edge * (position.depth < finest ? 0.5f * std::sqrt(3.0f) : 0.25f);
    return {centre, radius + static_cast<float>(margin)};
}

void append_children(std::vector<voctree::LeafPosition>& positions, const voctree::LeafPosition& position) {
    for (uint32_t i = 0; i < 8; ++i)
        positions.push_back(
            {2 * position.x + (i & 1), 2 * position.y + (i >> 1 & 1), 2 * position.z + (i >> 2), position.depth + 1});
}

bool any_bit(const uint32_t* bits, size_t words) {
    return std::any_of(bits, bits + words, [](uint32_t word) { return word != 0; });
}

// Positions of leaves in which the hull allows matter in at least one frame.
struct Carved {
    std::vector<voctree::LeafPosition> positions;
    std::vector<uint32_t> bits;  // as carve() returns them, one bit per time of the data set
    std::vector<uint32_t> kept;  // per position: its index among those given to keep_allowed
};

// Removes the cells in which the grid has no matter.
void remove_empty(const MatterGrid& grid, const voctree::VOctree& tree, std::vector<voctree::LeafPosition>& positions) {
    std::erase_if(positions, [&](const voctree::LeafPosition& p) {
        const double edge = static_cast<double>(tree.box_size.x) / (1u << p.depth);
        const glm::dvec3 low = glm::dvec3(tree.box_min) + edge * glm::dvec3(p.x, p.y, p.z);
        return !grid.overlaps({low, low + edge});
    });
}

Carved keep_allowed(const Dataset& dataset, const voctree::VOctree& tree,
                    const std::vector<voctree::LeafPosition>& positions, uint32_t finest, double margin) {
    const size_t words = hull_words(dataset);
    std::vector<HullCell> cells(positions.size());
    for (size_t i = 0; i < positions.size(); ++i) cells[i] = hull_cell(tree, positions[i], finest, margin);
    const std::vector<uint32_t> bits = carve(dataset, cells);
    Carved kept;
    for (size_t i = 0; i < positions.size(); ++i) {
        if (!any_bit(&bits[i * words], words)) continue;
        kept.positions.push_back(positions[i]);
        kept.bits.insert(kept.bits.end(), &bits[i * words], &bits[i * words] + words);
        kept.kept.push_back(static_cast<uint32_t>(i));
    }
    return kept;
}

float density_of(const voctree::VOctree& tree, uint32_t depth, float optical_depth) {
    return optical_depth * static_cast<float>(1u << depth) / tree.box_size.x;
}

// The bits of carve(), one per time of the data set, as one bit per frame of the tree.
std::vector<uint32_t> frame_bits(const Dataset& dataset, uint32_t frames, const uint32_t* bits) {
    std::vector<uint32_t> result((frames + 31) / 32);
    for (size_t i = 0; i < dataset.times.size(); ++i) {
        if (!(bits[i / 32] >> i % 32 & 1)) continue;
        const double frame = frame_of_time(dataset.times[i], frames);
        for (const double near : {std::floor(frame), std::ceil(frame)})
            result[static_cast<size_t>(near) / 32] |= 1u << static_cast<uint32_t>(near) % 32;
    }
    return result;
}

// Makes a leaf's σ of each frame, `values`, negative in the frames in which the hull forbids it.
void fit_to_hull(const Dataset& dataset, const voctree::VOctree& tree, const Carved& carved, size_t i,
                 std::vector<float>& values) {
    const auto allowed = frame_bits(dataset, tree.frames, &carved.bits[i * hull_words(dataset)]);
    const float below = -density_of(tree, carved.positions[i].depth, kForbiddenOpacity);
    for (size_t t = 0; t < values.size(); ++t)
        if (!(allowed[t / 32] >> t % 32 & 1)) values[t] = std::min(values[t], below);
}

// The weight of the constant function H_000 = 1/(π√2) that gives this linear value after the sigmoid.
float constant_weight(float linear) {
    const float value = std::clamp(linear, 0.005f, 0.98f);
    return std::numbers::pi_v<float> * std::numbers::sqrt2_v<float> * std::log(value / (1 - value));
}

void set_initial_weights(const Dataset& dataset, voctree::VOctree& tree, const Carved& carved) {
    const BasisSolver solver(tree.sigma_basis, tree.frames, tree.bases);
    const std::vector<float> gamma = voctree::initial_gamma_weights(tree.bases);
    const float sigma = density_of(tree, carved.positions[0].depth, kInitialOpacity);
    tree.weights.assign(size_t{tree.leaf_count} * tree.weights_per_leaf(), 0);
    std::vector<glm::vec3> centres(tree.leaf_count);
    for (size_t i = 0; i < centres.size(); ++i) centres[i] = hull_cell(tree, carved.positions[i], 0).centre;
    const std::vector<glm::vec3> colours = first_colours(dataset, centres, carved.bits);
    parallel_for(tree.leaf_count, 1024, [&](size_t begin, size_t end) {
        std::vector<float> values(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            std::fill(values.begin(), values.end(), sigma);
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

// The metres that a pixel covers at a position, in the camera where it covers least.
double footprint_at(const Dataset& dataset, glm::dvec3 position) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const stage::Camera& camera : dataset.cameras)
        smallest = std::min(smallest, glm::length(glm::dvec3(camera.world_from_camera[3]) - position) / camera.fx);
    return smallest;
}

bool may_divide(const Dataset& dataset, const voctree::VOctree& tree, const voctree::LeafPosition& position,
                float max_weight, const GrowSettings& settings) {
    if (position.depth >= settings.max_depth || max_weight < settings.min_weight_to_divide) return false;
    if (settings.min_pixels_to_divide <= 0) return true;
    const double edge = static_cast<double>(tree.box_size.x) / (1u << position.depth);
    return edge >= settings.min_pixels_to_divide * footprint_at(dataset, hull_cell(tree, position, 0).centre);
}

// Which leaves divide. One leaf becomes up to eight, so that each may add 7 to the count without exceeding max_leaves.
std::vector<bool> select_divided(const Dataset& dataset, const voctree::VOctree& tree,
                                 const std::vector<voctree::LeafPosition>& positions, const LeafUse& use,
                                 const GrowSettings& settings) {
    std::vector<uint32_t> selected;
    const bool by_sensitivity = settings.divide_share < 1;
    for (uint32_t i = 0; i < positions.size(); ++i) {
        if (by_sensitivity && use.opacity_sensitivity[i] <= 0) continue;
        if (may_divide(dataset, tree, positions[i], use.max_weight[i], settings)) selected.push_back(i);
    }
    size_t room = selected.size();
    if (by_sensitivity) room = static_cast<size_t>(settings.divide_share * static_cast<float>(positions.size()));
    if (settings.max_leaves > 0)
        room =
            std::min(room, settings.max_leaves > positions.size() ? (settings.max_leaves - positions.size()) / 7 : 0);
    if (selected.size() > room) {
        const std::vector<float>& worth = by_sensitivity ? use.opacity_sensitivity : use.max_weight;
        std::stable_sort(selected.begin(), selected.end(), [&](uint32_t a, uint32_t b) { return worth[a] > worth[b]; });
        selected.resize(room);
    }
    std::vector<bool> divided(positions.size());
    for (const uint32_t i : selected) divided[i] = true;
    return divided;
}

// Makes a leaf's σ of each frame, `values`, negative in the frames that did not use the leaf from which it comes,
// unless it is hidden there. Where frames share bases this would make other frames thinner, so nothing changes there.
// `depth` is that of the leaf from which it comes.
void fit_to_use(const voctree::VOctree& tree, const LeafUse& use, uint32_t parent, uint32_t depth,
                std::vector<float>& values) {
    if (tree.bases < tree.frames) return;
    const float below = -density_of(tree, depth, kForbiddenOpacity), hidden = density_of(tree, depth, kHiddenDepth);
    for (uint32_t t = 0; t < tree.frames; ++t) {
        const bool is_used = (use.frames[size_t{t / 32} * tree.leaf_count + parent] >> t % 32 & 1) != 0;
        if (!is_used && values[t] < hidden) values[t] = std::min(values[t], below);
    }
}

// For leaves that rays hardly used: whether it is hidden in some frame.
bool is_hidden(const voctree::VOctree& tree, const voctree::LeafPosition& position, uint32_t leaf) {
    std::vector<float> sigma(tree.frames);
    voctree::sigma_of_frames(tree, tree.leaf(leaf), sigma);
    return *std::max_element(sigma.begin(), sigma.end()) >= density_of(tree, position.depth, kHiddenDepth);
}

// Which leaves are not removed.
std::vector<bool> select_kept(const voctree::VOctree& tree, const std::vector<voctree::LeafPosition>& positions,
                              const std::vector<float>& max_weight, const GrowSettings& settings) {
    std::vector<uint32_t> selected;
    for (uint32_t i = 0; i < max_weight.size(); ++i)
        if (max_weight[i] >= settings.prune_below || is_hidden(tree, positions[i], i)) selected.push_back(i);
    if (settings.max_leaves > 0 && selected.size() > settings.max_leaves) {
        std::stable_sort(selected.begin(), selected.end(),
                         [&](uint32_t a, uint32_t b) { return max_weight[a] > max_weight[b]; });
        selected.resize(settings.max_leaves);
    }
    std::vector<bool> kept(max_weight.size());
    for (const uint32_t i : selected) kept[i] = true;
    return kept;
}

voctree::VOctree same_shape(const voctree::VOctree& tree) {
    voctree::VOctree result = tree;
    result.weights.clear();
    return result;
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
    set_initial_weights(dataset, tree, carved);
    return tree;
}

voctree::VOctree grow(const Dataset& dataset, const voctree::VOctree& tree, const LeafUse& use,
                      const GrowSettings& settings) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const std::vector<bool> divided = select_divided(dataset, tree, positions, use, settings);
    const std::vector<bool> stays = select_kept(tree, positions, use.max_weight, settings);
    std::vector<voctree::LeafPosition> grown, children;
    std::vector<uint32_t> parents, origins;  // the leaf from which each of `grown` and `children` comes
    for (uint32_t i = 0; i < positions.size(); ++i) {
        if (!stays[i]) continue;
        if (divided[i]) {
            append_children(children, positions[i]);
            origins.insert(origins.end(), 8, i);
        } else if (settings.carve_kept && positions[i].depth == settings.max_depth) {
            children.push_back(positions[i]);
            origins.push_back(i);
        } else {
            grown.push_back(positions[i]);
            parents.push_back(i);
        }
    }
    const size_t kept = grown.size();
    const Carved carved = keep_allowed(dataset, tree, children, settings.max_depth, settings.hull_margin);
    grown.insert(grown.end(), carved.positions.begin(), carved.positions.end());
    for (const uint32_t child : carved.kept) parents.push_back(origins[child]);
    if (grown.empty()) return tree;  // rays saw nothing: an unchanged tree is better than none

    voctree::VOctree result = same_shape(tree);
    for (const voctree::LeafPosition& position : carved.positions)
        result.node_levels = std::max(result.node_levels, (position.depth + 1) / 2);
    voctree::build_topology(result, grown);
    result.weights.resize(size_t{result.leaf_count} * result.weights_per_leaf());
    const TraceSpan span("weights of the tree");
    const BasisSolver solver(tree.sigma_basis, tree.frames, tree.bases);
    parallel_for(grown.size(), 1024, [&](size_t begin, size_t end) {
        std::vector<float> values(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            const float* parent = tree.leaf(parents[i]);
            float* leaf = result.leaf(static_cast<uint32_t>(i));
            std::memcpy(leaf, parent, sizeof(float) * tree.weights_per_leaf());
            if (i < kept && !settings.empty_unused) continue;
            voctree::sigma_of_frames(tree, parent, values);
            if (settings.empty_unused) fit_to_use(tree, use, parents[i], positions[parents[i]].depth, values);
            if (i >= kept) fit_to_hull(dataset, tree, carved, i - kept, values);
            solver.solve(values.data(), leaf);
        }
    });
    return result;
}

}  // namespace neuvv::training
