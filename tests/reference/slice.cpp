#include "reference/slice.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "reference/hh.h"

namespace neuvv::reference {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

std::vector<double> scaled(const std::vector<double>& v, double factor) {
    std::vector<double> result(v);
    for (double& x : result) x *= factor;
    return result;
}

}  // namespace

FrameRows frame_rows(double frame, uint32_t frames) {
    const double last = frames - 1.0;
    const double clamped = frame > 0 ? std::min(frame, last) : 0.0;  // also maps NaN to 0
    const auto first = static_cast<uint32_t>(clamped);
    return {first, std::min(first + 1, frames - 1), clamped - first};
}

std::vector<double> basis_row(const std::vector<float>& basis, uint32_t bases, const FrameRows& rows) {
    std::vector<double> row(bases);
    for (size_t i = 0; i < bases; ++i) {
        const double first = basis[size_t{rows.first} * bases + i];
        const double second = basis[size_t{rows.second} * bases + i];
        row[i] = (1 - rows.blend) * first + rows.blend * second;
    }
    return row;
}

LeafWeights leaf_weights(const voctree::VOctree& tree, uint32_t leaf) {
    const float* next = tree.leaf(leaf);
    const auto take = [&next](uint32_t count) {
        std::vector<double> values(next, next + count);
        next += count;
        return values;
    };
    LeafWeights weights;
    weights.sigma = take(tree.bases);
    weights.gamma = take(tree.bases);
    for (auto& channel : weights.hh) channel = take(hh_count(tree.hh_degree));
    return weights;
}

LeafSlice slice(const LeafWeights& weights, const std::vector<double>& row_a, const std::vector<double>& row_b,
                uint32_t degree) {
    LeafSlice result;
    result.sigma = std::max(dot(row_a, weights.sigma), 0.0);
    result.gamma = std::numbers::pi * sigmoid(dot(row_b, weights.gamma));
    for (int n = 0; n <= static_cast<int>(degree); ++n) {
        for (int l = 0; l <= n; ++l) {
            const double r = radial(n, l, result.gamma);
            for (int m = -l; m <= l; ++m) {
                for (size_t channel = 0; channel < 3; ++channel) {
                    result.k[channel][sh_index(l, m)] += weights.hh[channel][hh_index(n, l, m)] * r;
                }
            }
        }
    }
    return result;
}

std::vector<LeafSlice> slice_tree(const voctree::VOctree& tree, double frame) {
    const FrameRows rows = frame_rows(frame, tree.frames);
    const std::vector<double> row_a = basis_row(tree.sigma_basis, tree.bases, rows);
    const std::vector<double> row_b = basis_row(tree.gamma_basis, tree.bases, rows);
    std::vector<LeafSlice> slices;
    slices.reserve(tree.leaf_count);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        slices.push_back(slice(leaf_weights(tree, leaf), row_a, row_b, tree.hh_degree));
    }
    return slices;
}

SliceGradient slice_adjoint(const LeafWeights& weights, const std::vector<double>& row_a,
                            const std::vector<double>& row_b, uint32_t degree, double d_sigma,
                            const ShCoefficients& d_k) {
    SliceGradient gradient;
    const double d_relu = dot(row_a, weights.sigma) > 0 ? d_sigma : 0.0;
    gradient.weights.sigma = scaled(row_a, d_relu);
    gradient.row_a = scaled(weights.sigma, d_relu);

    const double s = sigmoid(dot(row_b, weights.gamma));
    const double gamma = std::numbers::pi * s;
    double d_gamma = 0;
    for (auto& channel : gradient.weights.hh) channel.resize(hh_count(degree));
    for (int n = 0; n <= static_cast<int>(degree); ++n) {
        for (int l = 0; l <= n; ++l) {
            const double r = radial(n, l, gamma);
            const double slope = radial_slope(n, l, gamma);
            for (int m = -l; m <= l; ++m) {
                const uint32_t i = hh_index(n, l, m);
                for (size_t channel = 0; channel < 3; ++channel) {
                    const double d = d_k[channel][sh_index(l, m)];
                    gradient.weights.hh[channel][i] = d * r;
                    d_gamma += d * weights.hh[channel][i] * slope;
                }
            }
        }
    }
    const double d_logit = d_gamma * std::numbers::pi * s * (1 - s);
    gradient.weights.gamma = scaled(row_b, d_logit);
    gradient.row_b = scaled(weights.gamma, d_logit);
    return gradient;
}

}  // namespace neuvv::reference
