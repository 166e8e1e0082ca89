// What is solid of a clip at a time: the box around its surfaces, without floaters. Floaters are specks of density
// beside the surfaces, which training leaves where few cameras look.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "stream/codec/quantised_slice.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// Leaves of a tree that stand for all of them: every n-th, so that there are at most kMaxSolidLeaves. They need not be
// kept with the tree.
constexpr uint32_t kMaxSolidLeaves = 1u << 15;

class SolidLeaves {
  public:
    explicit SolidLeaves(const VOctree& tree);
    // Of a slice in a box, metres.
    SolidLeaves(const stream::QuantisedSlice& slice, glm::vec3 box_min, glm::vec3 box_size);

    // The corners (low, high, metres) of the box around what is solid at a frame, 0..frames−1, fractions allowed. A
    // leaf counts by the area that it hides: its opacity along its edge times the square of the edge. Along each axis
    // the outermost thousandth of that area at either end is left out, but for what is joined to the rest; a gap is
    // where a slab of a 256th of the box has less than a ten-thousandth. The box of all leaves where none has density.
    // Takes about a millisecond at most.
    std::pair<glm::dvec3, glm::dvec3> box_at(double frame) const;

  private:
    std::vector<float> areas_at(double frame) const;
    void add(const std::vector<LeafPosition>& positions, glm::dvec3 box_min, glm::dvec3 box_size,
             const std::function<void(size_t)>& add_weights);
    std::vector<float> low_, high_;  // per leaf: three coordinates, metres
    std::vector<float> edges_m_;     // per leaf
    std::vector<float> weights_;     // per leaf: w^σ
    std::vector<float> rows_;        // A
    uint32_t bases_ = 0, frames_ = 1;
    glm::dvec3 all_low_{0}, all_high_{0};
};

}  // namespace neuvv::voctree
