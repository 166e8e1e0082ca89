// The forward pass of training in double precision: weights and rows → slice → samples → pixels → loss. It is built of
// the functions of tests/reference alone, and differentiates by changing single parameters a little.
#pragma once

#include "gradient/scene.h"
#include "reference/loss.h"
#include "reference/trace.h"

namespace neuvv::test {

class Chain {
  public:
    explicit Chain(const Scene& scene);

    // The loss as a sum over pixels, as on the device, with the point loss, and the smoothness of the leaves that were
    // seen before any parameter changed.
    double loss() const;
    // ∂loss by one parameter, by central differences.
    double by_weight(uint32_t leaf, uint32_t weight);
    double by_row(bool of_gamma, size_t element);

    // Leaves with density at the scene's frame that at least one ray crosses before it ends.
    std::vector<uint32_t> seen_leaves() const;
    uint32_t rays_ended_early() const;

  private:
    struct PathRay {
        glm::dvec3 direction;
        std::vector<reference::LeafInterval> intervals;
    };
    void slice_leaf(uint32_t leaf);
    void slice_rows();
    std::vector<reference::Sample> samples(const PathRay& ray) const;
    double ray_point_loss(const PathRay& ray, glm::dvec4 truth) const;
    double tile_loss(size_t tile) const;
    double leaf_smoothness(uint32_t leaf) const;

    const Scene& scene_;
    std::vector<PathRay> rays_;
    std::vector<reference::LeafWeights> weights_;  // by leaf
    std::vector<double> sigma_basis_, gamma_basis_, row_a_, row_b_;
    std::vector<reference::LeafSlice> slices_;
    std::vector<double> first_sigmas_;  // by leaf, before any parameter changed
    std::vector<std::vector<size_t>> tiles_of_leaf_;
    std::vector<voctree::LeafPosition> positions_;
    std::vector<uint32_t> seen_;
};

}  // namespace neuvv::test
