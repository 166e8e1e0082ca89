#include "voctree/files/solid_leaves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "slice/quantise.h"
#include "voctree/files/occupied_box.h"
#include "voctree/temporal_basis.h"
#include "voctree/tree_slice.h"

namespace neuvv::voctree {

namespace {

constexpr size_t kSlabs = 256;
constexpr double kOutermost = 1e-3, kGap = 1e-4;

// The area in each slab of the box along one axis.
struct Profile {
    double low, slab_m;
    std::array<double, kSlabs> area{};

    Profile(double from, double to) : low(from), slab_m(std::max((to - from) / kSlabs, 1e-9)) {}
    size_t slab_of(double at) const {
        return static_cast<size_t>(std::clamp((at - low) / slab_m, 0.0, double{kSlabs - 1}));
    }
    // A leaf's area is spread evenly over the slabs between its faces, which lie a little inside of it.
    void add(double from, double to, double leaf_area) {
        const double inside = 1e-3 * (to - from);
        const size_t first = slab_of(from + inside), last = slab_of(to - inside);
        for (size_t slab = first; slab <= last; ++slab) area[slab] += leaf_area / static_cast<double>(last - first + 1);
    }
    // The first slab that counts, in the order of `at(0)`, `at(1)`, …
    template <typename At>
    size_t first_solid(double total, const At& at) const {
        size_t slab = 0;
        for (double outside = 0; slab + 1 < kSlabs; ++slab) {
            outside += area[at(slab)];
            if (outside > kOutermost * total) break;
        }
        while (slab > 0 && area[at(slab - 1)] >= kGap * total) --slab;
        return slab;
    }
    // The range that counts, metres.
    std::pair<double, double> solid(double total) const {
        const size_t first = first_solid(total, [](size_t i) { return i; }),
                     behind = first_solid(total, [](size_t i) { return kSlabs - 1 - i; });
        return {low + slab_m * static_cast<double>(first), low + slab_m * static_cast<double>(kSlabs - behind)};
    }
};

}  // namespace

SolidLeaves::SolidLeaves(const VOctree& tree) : rows_(tree.sigma_basis), bases_(tree.bases), frames_(tree.frames) {
    std::tie(all_low_, all_high_) = occupied_box(tree);
    add(leaf_positions(tree), tree.box_min, tree.box_size, [&](size_t leaf) {
        const float* weights = tree.leaf(static_cast<uint32_t>(leaf));
        weights_.insert(weights_.end(), weights, weights + bases_);
    });
}

SolidLeaves::SolidLeaves(const stream::QuantisedSlice& slice, glm::vec3 box_min, glm::vec3 box_size)
    : rows_{1}, bases_(1) {
    const std::vector<LeafPosition> positions = leaf_positions(slice);
    std::tie(all_low_, all_high_) = occupied_box(positions, box_min, box_size);
    add(positions, box_min, box_size, [&](size_t leaf) {
        weights_.push_back(
            slice::sigma_of(slice.planes[stream::kOpacityPlane][leaf], slice::edge_m(box_size, positions[leaf].depth)));
    });
}

// Adds leaves at equal steps; add_weights(leaf) adds their w^σ.
void SolidLeaves::add(const std::vector<LeafPosition>& positions, glm::dvec3 box_min, glm::dvec3 box_size,
                      const std::function<void(size_t)>& add_weights) {
    const size_t step = std::max<size_t>(1, (positions.size() + kMaxSolidLeaves - 1) / kMaxSolidLeaves);
    for (size_t i = 0; i < positions.size(); i += step) {
        const LeafPosition& position = positions[i];
        const glm::dvec3 size = std::ldexp(1.0, -static_cast<int>(position.depth)) * box_size,
                         low = box_min + size * glm::dvec3(position.x, position.y, position.z);
        for (int axis = 0; axis < 3; ++axis) {
            low_.push_back(static_cast<float>(low[axis]));
            high_.push_back(static_cast<float>(low[axis] + size[axis]));
        }
        edges_m_.push_back(slice::edge_m(glm::vec3(box_size), position.depth));
        add_weights(i);
    }
}

// Per leaf the area that it hides, square metres.
std::vector<float> SolidLeaves::areas_at(double frame) const {
    const std::vector<float> elements = row_at(rows_, bases_, frame, frames_);
    std::vector<BasisEntry> row;  // those of A_t that are not 0
    for (uint32_t basis = 0; basis < bases_; ++basis)
        if (elements[basis] != 0) row.push_back({0, basis, elements[basis]});
    std::vector<float> areas(edges_m_.size());
    for (size_t leaf = 0; leaf < areas.size(); ++leaf) {
        float sigma = 0;
        for (const BasisEntry& entry : row) sigma += entry.value * weights_[leaf * bases_ + entry.basis];
        if (sigma > 0) areas[leaf] = -std::expm1(-sigma * edges_m_[leaf]) * edges_m_[leaf] * edges_m_[leaf];
    }
    return areas;
}

std::pair<glm::dvec3, glm::dvec3> SolidLeaves::box_at(double frame) const {
    const std::vector<float> areas = areas_at(frame);
    double total = 0;
    for (const float area : areas) total += double{area};
    if (!(total > 0)) return {all_low_, all_high_};
    glm::dvec3 solid_low, solid_high;
    for (int axis = 0; axis < 3; ++axis) {
        Profile profile(all_low_[axis], all_high_[axis]);
        for (size_t leaf = 0; leaf < areas.size(); ++leaf) {
            const size_t at = 3 * leaf + static_cast<size_t>(axis);
            if (areas[leaf] > 0) profile.add(double{low_[at]}, double{high_[at]}, double{areas[leaf]});
        }
        std::tie(solid_low[axis], solid_high[axis]) = profile.solid(total);
    }
    // The leaves whose centres are in all three ranges.
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (size_t leaf = 0; leaf < areas.size(); ++leaf) {
        const glm::dvec3 from(low_[3 * leaf], low_[3 * leaf + 1], low_[3 * leaf + 2]),
            to(high_[3 * leaf], high_[3 * leaf + 1], high_[3 * leaf + 2]), centre = 0.5 * (from + to);
        if (!(areas[leaf] > 0) || glm::any(glm::lessThan(centre, solid_low)) ||
            glm::any(glm::greaterThan(centre, solid_high)))
            continue;
        low = glm::min(low, from);
        high = glm::max(high, to);
    }
    return low.x <= high.x ? std::pair(low, high) : std::pair(solid_low, solid_high);
}

}  // namespace neuvv::voctree
