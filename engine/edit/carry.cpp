#include "edit/carry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/threads/parallel.h"

namespace neuvv::edit {

namespace {

constexpr size_t kLeavesAtOnce = 1024;  // leaves that a thread processes at once
// Half of the longest edge of a leaf is at most this times the mean of its three edges.
constexpr float kHalfEdge = 1.5f;

// Which edit applies at a point, and the box around all of them: performer's space, metres.
class EditsInSpace {
  public:
    EditsInSpace(const Canvas& canvas, std::span<const voctree::LeafEdit> edits) : canvas_(canvas) {
        for (const voctree::LeafEdit& edit : edits) {
            edit_of_leaf_[edit.leaf] = &edit;
            const float reach_m = kHalfEdge * canvas.edges_m[edit.leaf];
            low_ = glm::min(low_, canvas.centres[edit.leaf] - reach_m);
            high_ = glm::max(high_, canvas.centres[edit.leaf] + reach_m);
            smallest_edge_m_ = std::min(smallest_edge_m_, canvas.edges_m[edit.leaf]);
        }
    }
    float smallest_edge_m() const { return smallest_edge_m_; }
    bool may_meet(glm::vec3 centre, float edge_m) const {
        const float reach_m = kHalfEdge * edge_m;
        return glm::all(glm::greaterThan(centre + reach_m, low_)) && glm::all(glm::lessThan(centre - reach_m, high_));
    }
    // Null where there is none.
    const voctree::LeafEdit* at(glm::vec3 point) const {
        const glm::dvec3 in_tree =
            (glm::dvec3(point) - glm::dvec3(canvas_.tree.box_min)) / glm::dvec3(canvas_.tree.box_size);
        const auto found = edit_of_leaf_.find(voctree::find_leaf(canvas_.tree, in_tree));
        return found == edit_of_leaf_.end() ? nullptr : found->second;
    }

  private:
    const Canvas& canvas_;
    std::unordered_map<uint32_t, const voctree::LeafEdit*> edit_of_leaf_;
    glm::vec3 low_{std::numeric_limits<float>::max()}, high_{std::numeric_limits<float>::lowest()};
    float smallest_edge_m_ = std::numeric_limits<float>::max();
};

// Of the edits at side³ points of a leaf. An alpha of 0 and kKeepSigma where there is none.
voctree::LeafEdit edit_in_leaf(const EditsInSpace& edits, glm::vec3 centre, glm::vec3 edges, int side) {
    voctree::LeafEdit result;
    float densities = 0, sum = 0;
    for (int i = 0; i < side * side * side; ++i) {
        const glm::vec3 cell(i % side, i / side % side, i / (side * side));
        const voctree::LeafEdit* edit = edits.at(centre + edges * ((cell + 0.5f) / static_cast<float>(side) - 0.5f));
        if (!edit) continue;
        if (edit->alpha > result.alpha) {
            result.alpha = edit->alpha;
            result.colour = edit->colour;
        }
        if (edit->sigma < 0) continue;
        ++densities;
        sum += edit->sigma;
    }
    if (2 * densities >= static_cast<float>(side * side * side)) result.sigma = sum / densities;
    return result;
}

}  // namespace

std::vector<voctree::LeafEdit> carried(const Canvas& from, std::span<const voctree::LeafEdit> edits, const Canvas& to) {
    const EditsInSpace in_space(from, edits);
    std::vector<voctree::LeafEdit> of_leaf(to.tree.leaf_count);
    const glm::vec3 shape = to.tree.box_size * (3 / (to.tree.box_size.x + to.tree.box_size.y + to.tree.box_size.z));
    parallel_for(of_leaf.size(), kLeavesAtOnce, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf) {
            const float edge_m = to.edges_m[leaf];
            if (!in_space.may_meet(to.centres[leaf], edge_m)) continue;
            const int side = std::clamp(static_cast<int>(std::ceil(edge_m / in_space.smallest_edge_m())), 2, 4);
            of_leaf[leaf] = edit_in_leaf(in_space, to.centres[leaf], edge_m * shape, side);
            of_leaf[leaf].leaf = static_cast<uint32_t>(leaf);
        }
    });
    std::erase_if(of_leaf, [](const voctree::LeafEdit& edit) { return edit.alpha <= 0 && edit.sigma < 0; });
    return of_leaf;
}

}  // namespace neuvv::edit
