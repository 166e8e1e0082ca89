#include "training/bases.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::training {

namespace {

// Solves M·X = Y in place by Gauss-Jordan elimination; M (n × n) is symmetric positive definite, Y is n × m.
void solve_in_place(std::vector<double>& matrix, std::vector<double>& right, size_t n, size_t m) {
    for (size_t pivot = 0; pivot < n; pivot++) {
        const double scale = 1 / matrix[pivot * n + pivot];
        for (size_t j = 0; j < n; j++) matrix[pivot * n + j] *= scale;
        for (size_t j = 0; j < m; j++) right[pivot * m + j] *= scale;
        for (size_t row = 0; row < n; row++) {
            const double factor = matrix[row * n + pivot];
            if (row == pivot || factor == 0) continue;
            for (size_t j = 0; j < n; j++) matrix[row * n + j] -= factor * matrix[pivot * n + j];
            for (size_t j = 0; j < m; j++) right[row * m + j] -= factor * right[pivot * m + j];
        }
    }
}

bool is_identity(const std::vector<float>& basis, uint32_t size) {
    for (uint32_t t = 0; t < size; t++)
        for (uint32_t c = 0; c < size; c++)
            if (basis[size_t{t} * size + c] != (t == c ? 1.0f : 0.0f)) return false;
    return true;
}

}  // namespace

std::vector<float> hat_basis(uint32_t frames, uint32_t bases) {
    assert(bases >= 1 && bases <= frames);
    std::vector<float> basis(size_t{frames} * bases);
    const double knots_per_frame = frames > 1 ? (bases - 1.0) / (frames - 1.0) : 0;
    for (uint32_t t = 0; t < frames; t++)
        for (uint32_t c = 0; c < bases; c++)
            basis[size_t{t} * bases + c] = static_cast<float>(std::max(0.0, 1 - std::abs(t * knots_per_frame - c)));
    return basis;
}

bool has_basis_per_frame(const voctree::VOctree& tree) {
    return tree.frames == tree.bases && is_identity(tree.sigma_basis, tree.bases) &&
           is_identity(tree.gamma_basis, tree.bases);
}

void sigma_of_frames(const voctree::VOctree& tree, const float* leaf, std::vector<float>& values) {
    for (uint32_t t = 0; t < tree.frames; t++) {
        values[t] = 0;
        for (uint32_t c = 0; c < tree.bases; c++) values[t] += tree.sigma_basis[size_t{t} * tree.bases + c] * leaf[c];
    }
}

std::vector<float> initial_gamma_weights(uint32_t bases) {
    std::vector<float> weights(bases);
    for (uint32_t c = 0; c < bases; c++) {
        const double share = bases > 1 ? 0.1 + 0.8 * c / (bases - 1.0) : 0.3;  // γ/π
        weights[c] = static_cast<float>(std::log(share / (1 - share)));
    }
    return weights;
}

BasisSolver::BasisSolver(const std::vector<float>& basis, uint32_t frames, uint32_t bases)
    : frames_(frames), bases_(bases) {
    // (AᵀA + εI)⁻¹ Aᵀ; ε keeps the weights small where training has made columns alike.
    std::vector<double> normal(size_t{bases} * bases), right(size_t{bases} * frames);
    for (uint32_t t = 0; t < frames; t++)
        for (uint32_t i = 0; i < bases; i++) {
            const double a = static_cast<double>(basis[size_t{t} * bases + i]);
            right[size_t{i} * frames + t] = a;
            for (uint32_t j = 0; j < bases; j++)
                normal[size_t{i} * bases + j] += a * static_cast<double>(basis[size_t{t} * bases + j]);
        }
    for (uint32_t i = 0; i < bases; i++) normal[size_t{i} * bases + i] += 1e-6;
    solve_in_place(normal, right, bases, frames);
    inverse_.assign(right.begin(), right.end());
}

void BasisSolver::solve(const float* values, float* weights) const {
    for (uint32_t c = 0; c < bases_; c++) {
        float sum = 0;
        for (uint32_t t = 0; t < frames_; t++) sum += inverse_[size_t{c} * frames_ + t] * values[t];
        weights[c] = sum;
    }
}

}  // namespace neuvv::training
