#include "training/compact.h"

#include <cmath>

#include "base/parallel.h"

namespace neuvv {

namespace {

// Of w^σ, below its highest bit; of w^γ (γ moves by π/4 a unit at most); of w^HH (the largest H is about 1/2, a
// colour's slope after the sigmoid 1/4).
struct Steps {
    float sigma_share, gamma, colour;
};
constexpr Steps kOwnFrames{1.0f / 16, 1.0f / 8, 1.0f / 8};
// Where frames share bases, what a frame sees is a sum of weights of both signs: they must be finer than it.
constexpr Steps kSharedBases{1.0f / 64, 1.0f / 32, 1.0f / 16};

float rounded_to(float value, float step) {
    return std::round(value / step) * step;
}

float rounded_share(float value, float share) {
    if (value == 0 || !std::isfinite(value)) return value;
    return rounded_to(value, std::exp2(std::floor(std::log2(std::abs(value)))) * share);
}

bool is_identity(const std::vector<float>& basis, uint32_t frames, uint32_t bases) {
    if (frames != bases) return false;
    for (uint32_t t = 0; t < frames; t++)
        for (uint32_t c = 0; c < bases; c++)
            if (basis[size_t{t} * bases + c] != (t == c ? 1.0f : 0.0f)) return false;
    return true;
}

}  // namespace

void make_compact(VOctree& tree) {
    const uint32_t bases = tree.bases;
    const bool own_frames =
        is_identity(tree.sigma_basis, tree.frames, bases) && is_identity(tree.gamma_basis, tree.frames, bases);
    const Steps steps = own_frames ? kOwnFrames : kSharedBases;
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) {
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t c = 0; c < bases; c++) {
                const bool empty = own_frames && leaf[c] <= 0;
                leaf[c] = empty ? 0 : rounded_share(leaf[c], steps.sigma_share);
                leaf[bases + c] = empty ? 0 : rounded_to(leaf[bases + c], steps.gamma);
            }
            for (uint32_t w = 2 * bases; w < tree.weights_per_leaf(); w++) leaf[w] = rounded_to(leaf[w], steps.colour);
        }
    });
}

}  // namespace neuvv
