#include "voctree/frames.h"

#include <algorithm>
#include <cassert>

#include "base/threads/parallel.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

std::vector<float> columns_of(const float* from, const std::vector<uint32_t>& columns) {
    std::vector<float> taken;
    for (const uint32_t column : columns) taken.push_back(from[column]);
    return taken;
}

}  // namespace

void drop_empty_leaves(VOctree& tree) {
    const std::vector<BasisEntry> entries = basis_entries(tree.sigma_basis, tree.bases);
    std::vector<uint8_t> empty(tree.leaf_count);
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        std::vector<float> sigma(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            density_of_frames(tree.leaf(static_cast<uint32_t>(i)), entries, sigma);
            empty[i] = std::all_of(sigma.begin(), sigma.end(), [](float value) { return value == 0; }) ? 1 : 0;
        }
    });
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    std::vector<LeafPosition> kept;
    std::vector<const float*> weights;
    for (uint32_t i = 0; i < tree.leaf_count; ++i) {
        if (empty[i]) continue;
        kept.push_back(positions[i]);
        weights.push_back(tree.leaf(i));
    }
    replace_leaves(tree, kept, weights);
}

VOctree frames_of(const VOctree& tree, uint32_t first, uint32_t count) {
    assert(count > 0 && first <= tree.frames && count <= tree.frames - first);
    const auto rows_of = [&](const std::vector<float>& rows) { return rows.data() + size_t{first} * tree.bases; };
    std::vector<uint32_t> used;
    for (uint32_t basis = 0; basis < tree.bases; ++basis)
        for (size_t at = basis; at < size_t{count} * tree.bases; at += tree.bases)
            if (rows_of(tree.sigma_basis)[at] != 0 || rows_of(tree.gamma_basis)[at] != 0) {
                used.push_back(basis);
                break;
            }
    if (used.empty()) used.push_back(0);  // a tree has at least one basis

    VOctree part = tree;
    part.bases = static_cast<uint32_t>(used.size());
    part.frames = count;
    part.sigma_basis.clear();
    part.gamma_basis.clear();
    for (uint32_t frame = 0; frame < count; ++frame) {
        const size_t row = size_t{frame} * tree.bases;
        for (const float value : columns_of(rows_of(tree.sigma_basis) + row, used)) part.sigma_basis.push_back(value);
        for (const float value : columns_of(rows_of(tree.gamma_basis) + row, used)) part.gamma_basis.push_back(value);
    }
    part.weights.resize(size_t{tree.leaf_count} * part.weights_per_leaf());
    for (uint32_t i = 0; i < tree.leaf_count; ++i) {
        const float* from = tree.leaf(i);
        float* to = part.leaf(i);
        for (const float value : columns_of(from, used)) *to++ = value;
        for (const float value : columns_of(from + tree.bases, used)) *to++ = value;
        std::copy(from + size_t{2} * tree.bases, from + tree.weights_per_leaf(), to);
    }
    drop_empty_leaves(part);
    return part;
}

}  // namespace neuvv::voctree
