#include "training/tree/compact.h"

#include <algorithm>
#include <cmath>

#include "base/threads/parallel.h"
#include "training/tree/bases.h"
#include "voctree/round.h"

namespace neuvv::training {

namespace {

// The steps to which weights are rounded.
struct Steps {
    float sigma_share;  // of w^σ, as a share of its highest bit
    float gamma;        // of w^γ; γ changes by at most π/4 per unit
    float colour;       // of w^HH; |H_nlm| ≤ (n+1)/(π√2), and the slope of the sigmoid after it is at most 1/4
};
constexpr Steps kBasisPerFrame{1.0f / 16, 1.0f / 8, 1.0f / 4};
// Where frames share bases, the value of a frame is a sum of weights of both signs, which need finer steps than the
// sum.
constexpr Steps kSharedBases{1.0f / 64, 1.0f / 32, 1.0f / 16};

float rounded_share(float value, float share) {
    if (value == 0 || !std::isfinite(value)) return value;
    return voctree::rounded_to(value, std::exp2(std::floor(std::log2(std::abs(value)))) * share);
}

}  // namespace

void empty_thin_leaves(voctree::VOctree& tree) {
    if (!voctree::has_basis_per_frame(tree)) return;
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const float thin = thin_sigma(tree, positions[i].depth);
            float* sigma = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t c = 0; c < tree.bases; ++c)
                if (sigma[c] <= thin) sigma[c] = 0;
        }
    });
}

void make_compact(voctree::VOctree& tree) {
    const uint32_t bases = tree.bases;
    const bool basis_per_frame = voctree::has_basis_per_frame(tree);
    const Steps steps = basis_per_frame ? kBasisPerFrame : kSharedBases;
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t c = 0; c < bases; ++c) {
                const bool empty = basis_per_frame && leaf[c] <= 0;
                leaf[c] = empty ? 0 : rounded_share(leaf[c], steps.sigma_share);
                leaf[bases + c] = empty ? 0 : voctree::rounded_to(leaf[bases + c], steps.gamma);
            }
            for (uint32_t w = 2 * bases; w < tree.weights_per_leaf(); ++w)
                leaf[w] = voctree::rounded_to(leaf[w], steps.colour);
        }
    });
}

}  // namespace neuvv::training
