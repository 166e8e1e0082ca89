#include "voctree/round.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/threads/parallel.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kConstantH = 1 / (kPi * std::numbers::sqrt2_v<float>);  // H_000; |H_nlm| ≤ (n+1) H_000
// The largest slope of the sigmoid.
constexpr float kSigmoidSlope = 0.25f;
// The share of `error` that each HH function may take, as their errors add up.
constexpr float kColourShare = 0.25f;
// The error allowed where a weight has no effect.
constexpr float kAny = std::numeric_limits<float>::infinity();

// `value` rounded to few digits; the error is at most `allowed`.
float rounded_within(float value, float allowed) {
    return std::abs(value) <= allowed ? 0.0f : rounded_to(value, std::exp2(std::floor(std::log2(2 * allowed))));
}

// By how much the optical depth along a leaf's edge may fall until its opacity has fallen by `error`. A rise by as much
// changes the opacity less.
float allowed_depth(float depth, float error) {
    return depth < 50 ? std::log1p(error * std::exp(depth)) : depth + std::log(error);
}

// Rounds leaves one after the other.
struct Rounder {
    const VOctree& tree;
    const std::vector<BasisEntry>&sigma_entries, &gamma_entries;
    float error;
    std::vector<float> sigma = std::vector<float>(tree.frames), opacity = sigma;
    std::vector<float> allowed = std::vector<float>(tree.bases);
    std::vector<float> before = std::vector<float>(size_t{3} * hh_count(tree.hh_degree));

    void round_sigma(float* leaf, float edge_m) {
        std::fill(allowed.begin(), allowed.end(), kAny);
        for (const BasisEntry& entry : sigma_entries) {
            const float here = allowed_depth(sigma[entry.frame] * edge_m, error) / (edge_m * std::abs(entry.value));
            allowed[entry.basis] = std::min(allowed[entry.basis], here);
        }
        for (uint32_t c = 0; c < tree.bases; ++c) leaf[c] = rounded_within(leaf[c], allowed[c]);
    }

    // An estimate of the slope of colour over B_t·w^γ. It uses |dH_nlm/dγ| ≤ n(n+1) H_000, adds up the functions as if
    // their signs were random, and takes the largest slope of γ = π·sigmoid, which is π/4.
    float gamma_slope(const float* leaf) const {
        float largest = 0;
        for (uint32_t channel = 0; channel < 3; ++channel) {
            const float* weights = leaf + 2 * tree.bases + channel * hh_count(tree.hh_degree);
            float squares = 0;
            for (uint32_t n = 1; n <= tree.hh_degree; ++n)
                for (uint32_t f = hh_count(n - 1); f < hh_count(n); ++f) {
                    const float slope = static_cast<float>(n * (n + 1)) * weights[f];
                    squares += slope * slope;
                }
            largest = std::max(largest, squares);
        }
        return kPi / 4 * kSigmoidSlope * kConstantH * std::sqrt(largest);
    }

    void round_gamma(float* leaf) {
        const float slope = gamma_slope(leaf);
        std::fill(allowed.begin(), allowed.end(), kAny);
        for (const BasisEntry& entry : gamma_entries) {
            const float effect = opacity[entry.frame] * slope * std::abs(entry.value);  // of one unit of w^γ
            if (effect > 0) allowed[entry.basis] = std::min(allowed[entry.basis], error / effect);
        }
        for (uint32_t c = 0; c < tree.bases; ++c)
            leaf[tree.bases + c] = rounded_within(leaf[tree.bases + c], allowed[c]);
    }

    // Where the same weight of the leaf before is within the allowed error, it is repeated, because repetitions pack
    // best.
    void round_colour(float* leaf) {
        const float effect = *std::max_element(opacity.begin(), opacity.end()) * kSigmoidSlope * kConstantH;
        const uint32_t functions = hh_count(tree.hh_degree);
        for (uint32_t n = 0; n <= tree.hh_degree; ++n) {
            const float here = effect > 0 ? kColourShare * error / (effect * static_cast<float>(n + 1)) : kAny;
            for (uint32_t channel = 0; channel < 3; ++channel)
                for (uint32_t f = n == 0 ? 0 : hh_count(n - 1); f < hh_count(n); ++f) {
                    const uint32_t at = channel * functions + f;
                    float& weight = leaf[2 * tree.bases + at];
                    weight = std::abs(weight - before[at]) <= here ? before[at] : rounded_within(weight, here);
                    before[at] = weight;
                }
        }
    }

    void round(float* leaf, float edge_m) {
        density_of_frames(leaf, sigma_entries, sigma);
        for (uint32_t t = 0; t < tree.frames; ++t) opacity[t] = 1 - std::exp(-sigma[t] * edge_m);
        round_sigma(leaf, edge_m);
        round_gamma(leaf);
        round_colour(leaf);
    }
};

}  // namespace

float rounded_to(float value, float step) {
    return std::round(value / step) * step;
}

void round_weights(VOctree& tree, float error) {
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    const std::vector<BasisEntry> sigma_entries = basis_entries(tree.sigma_basis, tree.bases);
    const std::vector<BasisEntry> gamma_entries = basis_entries(tree.gamma_basis, tree.bases);
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        Rounder rounder{tree, sigma_entries, gamma_entries, error};
        for (size_t i = begin; i < end; ++i)
            rounder.round(tree.leaf(static_cast<uint32_t>(i)), leaf_edge_m(tree, positions[i].depth));
    });
}

}  // namespace neuvv::voctree
