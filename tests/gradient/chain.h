// The forward chain in double precision, with parameters that can be nudged: weights and rows → slice → samples →
// pixels → loss. Built of the functions of tests/reference alone.
#pragma once

#include "gradient/scene.h"
#include "reference/loss.h"
#include "reference/trace.h"

namespace neuvv::test {

class Chain {
  public:
    explicit Chain(const Scene& scene);

    // The sum over pixels, as the device takes it, with the point loss and the smoothness of the leaves that were seen
    // at first.
    double loss() const;
    // Central differences.
    double by_weight(uint32_t leaf, uint32_t weight);
    double by_row(bool of_gamma, size_t element);

    // Leaves with density at this frame that some ray crosses before it ends.
    std::vector<uint32_t> seen_leaves() const;
    uint32_t rays_ended_early() const;

  private:
    struct PathRay {
        glm::dvec3 direction;
        std::vector<reference::Segment> segments;
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
    std::vector<double> first_sigmas_;  // by leaf, before any nudge
    std::vector<std::vector<size_t>> tiles_of_leaf_;
    std::vector<voctree::LeafPosition> positions_;
    std::vector<uint32_t> seen_;
};

}  // namespace neuvv::test
