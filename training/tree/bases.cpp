#include "training/tree/bases.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::training {

namespace {

// Solves M·X = Y in place by Gauss-Jordan elimination; M (n × n) is symmetric positive definite, Y is n × m.
void solve_in_place(std::vector<double>& matrix, std::vector<double>& right, size_t n, size_t m) {
    for (size_t pivot = 0; pivot < n; ++pivot) {
        const double scale = 1 / matrix[pivot * n + pivot];
        for (size_t j = 0; j < n; ++j) matrix[pivot * n + j] *= scale;
        for (size_t j = 0; j < m; ++j) right[pivot * m + j] *= scale;
        for (size_t row = 0; row < n; ++row) {
            const double factor = matrix[row * n + pivot];
            if (row == pivot || factor == 0) continue;
            for (size_t j = 0; j < n; ++j) matrix[row * n + j] -= factor * matrix[pivot * n + j];
            for (size_t j = 0; j < m; ++j) right[row * m + j] -= factor * right[pivot * m + j];
        }
    }
}

}  // namespace

BasisSolver::BasisSolver(const std::vector<float>& basis, uint32_t frames, uint32_t bases)
    : frames_(frames), bases_(bases) {
    // (AᵀA + εI)⁻¹ Aᵀ; ε keeps the weights small where training has made columns alike.
    std::vector<double> normal(size_t{bases} * bases), right(size_t{bases} * frames);
    for (uint32_t t = 0; t < frames; ++t)
        for (uint32_t i = 0; i < bases; ++i) {
            const double a = static_cast<double>(basis[size_t{t} * bases + i]);
            right[size_t{i} * frames + t] = a;
            for (uint32_t j = 0; j < bases; ++j)
                normal[size_t{i} * bases + j] += a * static_cast<double>(basis[size_t{t} * bases + j]);
        }
    for (uint32_t i = 0; i < bases; ++i) normal[size_t{i} * bases + i] += 1e-6;
    solve_in_place(normal, right, bases, frames);
    inverse_.assign(right.begin(), right.end());
}

void BasisSolver::solve(const float* values, float* weights) const {
    for (uint32_t c = 0; c < bases_; ++c) {
        float sum = 0;
        for (uint32_t t = 0; t < frames_; ++t) sum += inverse_[size_t{c} * frames_ + t] * values[t];
        weights[c] = sum;
    }
}

}  // namespace neuvv::training
