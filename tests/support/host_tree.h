// Downloads a slice tree from the device, and compares its entries with a slice of the reference.
#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "gpu/host_copies.h"
#include "reference/slice.h"
#include "render/volume/slices/slice_tree.h"
#include "voctree/files/half.h"

namespace neuvv::test {

struct HostTree {
    std::vector<glm::uvec4> nodes;
    std::vector<glm::uvec2> entries;
    std::vector<uint32_t> leaves;
    LiveCount count;
};

// Downloads the first of the trees.
inline HostTree download_tree(const gpu::Device& device, const render::Field& field, const render::SliceTrees& tree) {
    HostTree host;
    host.nodes.resize(field.node_count());
    host.entries.resize(size_t{tree.capacity} * sh_count(field.hh_degree));
    host.leaves.resize(tree.capacity);
    gpu::download(device, tree.nodes, host.nodes.data(), host.nodes.size() * sizeof(glm::uvec4));
    gpu::download(device, tree.entries, host.entries.data(), host.entries.size() * sizeof(glm::uvec2));
    gpu::download(device, tree.entry_leaf, host.leaves.data(), host.leaves.size() * sizeof(uint32_t));
    gpu::download(device, tree.counts, &host.count, sizeof(LiveCount));
    return host;
}

inline double number(uint32_t word, int shift) {
    return voctree::float_from_half(static_cast<uint16_t>(word >> shift));
}

// Walks the tree as a shader does, marks the leaves that it meets, and compares their entries with `truth`.
struct TreeCheck {
    const HostTree& host;
    const voctree::VOctree& tree;
    const std::vector<reference::LeafSlice>& truth;
    std::vector<bool> met = std::vector<bool>(tree.leaf_count);
    uint32_t entries = 0;
    double worst = 0;         // the largest error of σ and coefficients, relative to their values
    double worst_rest = 0;    // the same without the coefficients of degree 0
    double worst_mean = 0;    // the largest error of mean colours, 0 to 1, which the coefficients of degree 0 define
    double min_scale = 1e-3;  // relative errors are relative to this where the value is smaller

    void visit(uint32_t node, uint32_t level) {
        const glm::uvec4 words = host.nodes[node];
        uint32_t entry = words.z;
        const uint64_t live = uint64_t{words.y} << 32 | words.x;
        ASSERT_NE(live, 0u) << "a dead node is reached";
        for (uint32_t bit = 0; bit < 64; ++bit) {
            if (!(live >> bit & 1)) continue;
            const bool wide = words.w >> (bit / 8) & 1;
            ASSERT_LT(entry, host.leaves.size());
            ++entries;
            const glm::uvec2 first = host.entries[size_t{entry} * sh_count(tree.hh_degree)];
            if (first.x & kEntryIsNode) {
                EXPECT_EQ(host.leaves[entry], kNoLeaf);
                ASSERT_LT(level + 1, tree.node_levels);
                visit(first.y, level + 1);
            } else {
                check_leaf(host.leaves[entry], entry, 2 * level + (wide ? 1 : 2));
            }
            ++entry;
            if (wide) bit += 7;
        }
    }

    void check_leaf(uint32_t leaf, uint32_t entry, uint32_t depth) {
        ASSERT_LT(leaf, tree.leaf_count);
        EXPECT_FALSE(met[leaf]) << "leaf " << leaf << " twice";
        met[leaf] = true;
        EXPECT_EQ(voctree::leaf_positions(tree)[leaf].depth, depth);
        const auto relative = [this](double value, double expected, double scale) {
            return std::abs(value - expected) / std::max(scale, min_scale);
        };
        const size_t functions = sh_count(tree.hh_degree);
        const glm::uvec2* words = &host.entries[size_t{entry} * functions];
        worst_rest = std::max(worst_rest, relative(number(words[0].x, 0), truth[leaf].sigma, truth[leaf].sigma));
        const auto mean = [](double k) { return 1 / (1 + std::exp(-0.28209479177387814 * k)); };
        for (size_t j = 0; j < functions; ++j)
            for (size_t c = 0; c < 3; ++c) {
                const double k = c == 0 ? number(words[j].x, 16) : number(words[j].y, c == 1 ? 0 : 16);
                const double expected = truth[leaf].k[c][j], error = relative(k, expected, std::abs(expected));
                worst = std::max(worst, error);
                if (j > 0) worst_rest = std::max(worst_rest, error);
                if (j == 0) worst_mean = std::max(worst_mean, std::abs(mean(k) - mean(expected)));
            }
        worst = std::max(worst, worst_rest);
    }
};

}  // namespace neuvv::test
