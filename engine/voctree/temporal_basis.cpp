#include "voctree/temporal_basis.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::voctree {

namespace {

bool is_identity(const std::vector<float>& basis, uint32_t size) {
    for (uint32_t t = 0; t < size; ++t)
        for (uint32_t c = 0; c < size; ++c)
            if (basis[size_t{t} * size + c] != (t == c ? 1.0f : 0.0f)) return false;
    return true;
}

}  // namespace

std::vector<float> hat_basis(uint32_t frames, uint32_t bases) {
    assert(bases >= 1 && bases <= frames);
    std::vector<float> basis(size_t{frames} * bases);
    const double knots_per_frame = frames > 1 ? (bases - 1.0) / (frames - 1.0) : 0;
    for (uint32_t t = 0; t < frames; ++t)
        for (uint32_t c = 0; c < bases; ++c)
            basis[size_t{t} * bases + c] = static_cast<float>(std::max(0.0, 1 - std::abs(t * knots_per_frame - c)));
    return basis;
}

bool has_basis_per_frame(const VOctree& tree) {
    return tree.frames == tree.bases && is_identity(tree.sigma_basis, tree.bases) &&
           is_identity(tree.gamma_basis, tree.bases);
}

std::vector<float> initial_gamma_weights(uint32_t bases) {
    std::vector<float> weights(bases);
    for (uint32_t c = 0; c < bases; ++c) {
        const double share = bases > 1 ? 0.1 + 0.8 * c / (bases - 1.0) : 0.3;  // γ/π
        weights[c] = static_cast<float>(std::log(share / (1 - share)));
    }
    return weights;
}

std::vector<float> row_at(const std::vector<float>& table, uint32_t bases, double frame, uint32_t frames) {
    const TimeRows<double> time = rows_of_time(frame, frames);
    const auto part = static_cast<float>(time.part);
    std::vector<float> row(bases);
    for (uint32_t c = 0; c < bases; ++c)
        row[c] = std::lerp(table[size_t{time.first} * bases + c], table[size_t{time.second} * bases + c], part);
    return row;
}

RowsAtTime::RowsAtTime(const VOctree& tree, double frame)
    : sigma(row_at(tree.sigma_basis, tree.bases, frame, tree.frames)),
      gamma(row_at(tree.gamma_basis, tree.bases, frame, tree.frames)) {}

float row_product(const float* row, const float* weights, uint32_t bases) {
    float sum = 0;
    for (uint32_t c = 0; c < bases; ++c) sum += row[c] * weights[c];
    return sum;
}

std::vector<BasisEntry> basis_entries(const std::vector<float>& rows, uint32_t bases) {
    std::vector<BasisEntry> entries;
    for (size_t i = 0; i < rows.size(); ++i)
        if (rows[i] != 0)
            entries.push_back({static_cast<uint32_t>(i / bases), static_cast<uint32_t>(i % bases), rows[i]});
    return entries;
}

void density_of_frames(const float* leaf, const std::vector<BasisEntry>& entries, std::vector<float>& sigma) {
    std::fill(sigma.begin(), sigma.end(), 0.0f);
    for (const BasisEntry& entry : entries) sigma[entry.frame] += entry.value * leaf[entry.basis];
    for (float& value : sigma) value = std::max(value, 0.0f);
}

void sigma_of_frames(const VOctree& tree, const float* leaf, std::vector<float>& values) {
    for (uint32_t t = 0; t < tree.frames; ++t)
        values[t] = row_product(&tree.sigma_basis[size_t{t} * tree.bases], leaf, tree.bases);
}

}  // namespace neuvv::voctree
