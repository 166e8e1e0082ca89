#include "training/tree/merge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/threads/parallel.h"
#include "training/tree/bases.h"

namespace neuvv::training {

namespace {

using Siblings = std::array<uint32_t, 8>;
using Shares = std::array<float, 8>;
constexpr uint32_t kNoFamily = UINT32_MAX;
constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kConstantH = 1 / (kPi * std::numbers::sqrt2_v<float>);  // H_000; |H_nlm| ≤ (n+1) H_000

// Eight siblings, and the weights of the leaf that may replace them.
struct Family {
    Siblings leaves{};
    std::vector<float> parent;
};

// A number that is the same for leaves of one parent, and different for others.
uint64_t parent_key(const voctree::LeafPosition& position) {
    return uint64_t{position.depth} << 36 | uint64_t{position.x / 2} << 24 | uint64_t{position.y / 2} << 12 |
           position.z / 2;
}

std::vector<Family> complete_families(const std::vector<voctree::LeafPosition>& positions) {
    std::vector<std::pair<uint64_t, uint32_t>> keyed(positions.size());
    for (uint32_t i = 0; i < positions.size(); ++i) keyed[i] = {parent_key(positions[i]), i};
    std::sort(keyed.begin(), keyed.end());
    std::vector<Family> families;
    for (size_t i = 0; i + 8 <= keyed.size(); ++i) {
        if (keyed[i].first != keyed[i + 7].first || positions[keyed[i].second].depth < 2) continue;
        Family& family = families.emplace_back();
        for (size_t j = 0; j < 8; ++j) family.leaves[j] = keyed[i + j].second;
        i += 7;
    }
    return families;
}

bool was_used(const LeafUse& use, uint32_t leaf, uint32_t frame) {
    return use.frames[frame / 32 * use.max_weight.size() + leaf] >> frame % 32 & 1;
}

Shares users(const LeafUse& use, const Siblings& leaves, uint32_t frame) {
    Shares shares;
    for (size_t i = 0; i < 8; ++i) shares[i] = was_used(use, leaves[i], frame) ? 1.0f : 0.0f;
    return shares;
}

bool any(const Shares& shares) {
    return std::any_of(shares.begin(), shares.end(), [](float share) { return share > 0; });
}

float opacity_of(const voctree::VOctree& tree, const float* leaf, uint32_t frame, float edge_m) {
    const float sigma = voctree::row_product(&tree.sigma_basis[size_t{frame} * tree.bases], leaf, tree.bases);
    return 1 - std::exp(-std::max(sigma, 0.0f) * edge_m);
}

// A leaf's colour in linear light: that of the functions that do not depend on the direction.
glm::vec3 colour_of(const voctree::VOctree& tree, const float* leaf, uint32_t frame) {
    const float gamma =
        voctree::row_product(&tree.gamma_basis[size_t{frame} * tree.bases], leaf + tree.bases, tree.bases);
    const float cosine = std::cos(kPi / (1 + std::exp(-gamma)));
    glm::vec3 value(0);
    // H_n00 = U_n(cos γ) H_000, with Chebyshev polynomials U_n of the second kind (errata 1, 2). Its number among the
    // functions is hh_count(n − 1).
    float before = 0, here = 1;
    for (uint32_t n = 0; n <= tree.hh_degree; ++n) {
        const float* function = leaf + 2 * tree.bases + (n == 0 ? 0 : hh_count(n - 1));
        for (uint32_t channel = 0; channel < 3; ++channel)
            value[static_cast<int>(channel)] += kConstantH * here * function[channel * hh_count(tree.hh_degree)];
        before = std::exchange(here, 2 * cosine * here - before);
    }
    return 1.0f / (1.0f + glm::exp(-value));
}

// How much of each sibling was seen: its opacity, summed over the frames that used it.
Shares seen_shares(const voctree::VOctree& tree, const LeafUse& use, const Siblings& leaves, float edge_m) {
    Shares seen{};
    for (size_t i = 0; i < 8; ++i)
        for (uint32_t frame = 0; frame < tree.frames; ++frame)
            if (was_used(use, leaves[i], frame)) seen[i] += opacity_of(tree, tree.leaf(leaves[i]), frame, edge_m);
    return seen;
}

// The mean of one weight over siblings, by their shares; where none has a share, all count alike.
float mean_weight(const voctree::VOctree& tree, const Siblings& leaves, uint32_t weight, const Shares& shares) {
    const bool shared = any(shares);
    float sum = 0, total = 0;
    for (size_t i = 0; i < 8; ++i) {
        const float share = shared ? shares[i] : 1;
        sum += share * tree.leaf(leaves[i])[weight];
        total += share;
    }
    return sum / total;
}

// The parent's weights. Its density is the mean of all siblings, as it fills the space of all; its colour is the mean
// of those that were seen.
std::vector<float> parent_of(const voctree::VOctree& tree, const LeafUse& use, bool basis_per_frame,
                             const Siblings& leaves, const Shares& seen) {
    std::vector<float> parent(tree.weights_per_leaf());
    for (uint32_t w = 0; w < parent.size(); ++w) {
        const bool is_gamma = w >= tree.bases && w < 2 * tree.bases;
        const Shares shares = w < tree.bases                ? Shares{}
                              : is_gamma && basis_per_frame ? users(use, leaves, w - tree.bases)
                                                            : seen;
        parent[w] = mean_weight(tree, leaves, w, shares);
    }
    return parent;
}

// Whether the parent looks like each sibling in a frame. Colours of siblings that the frame did not use are not
// compared, and nothing is where it used none.
bool looks_alike(const voctree::VOctree& tree, const LeafUse& use, const Family& family, uint32_t frame, float edge_m,
                 float within) {
    const Shares used = users(use, family.leaves, frame);
    if (!any(used)) return true;
    const float* parent = family.parent.data();
    const float opacity = opacity_of(tree, parent, frame, edge_m);
    const glm::vec3 colour = colour_of(tree, parent, frame);
    for (size_t i = 0; i < 8; ++i) {
        const float* leaf = tree.leaf(family.leaves[i]);
        const float leaf_opacity = opacity_of(tree, leaf, frame, edge_m);
        if (std::abs(leaf_opacity - opacity) > within) return false;
        if (used[i] <= 0 || leaf_opacity <= 0) continue;
        const glm::vec3 off = leaf_opacity * glm::abs(colour_of(tree, leaf, frame) - colour);
        if (std::max({off.x, off.y, off.z}) > within) return false;
    }
    return true;
}

// Whether colours vary with the direction in the same way: bounds the difference by the functions that depend on the
// direction; the slope of the sigmoid is at most 1/4.
bool varies_alike(const voctree::VOctree& tree, const Family& family, const Shares& seen, float within) {
    for (size_t i = 0; i < 8; ++i) {
        if (seen[i] <= 0) continue;
        for (uint32_t channel = 0; channel < 3; ++channel) {
            const uint32_t first = 2 * tree.bases + channel * hh_count(tree.hh_degree);
            float off = 0;
            for (uint32_t n = 1; n <= tree.hh_degree; ++n)
                for (uint32_t f = first + hh_count(n - 1) + 1; f < first + hh_count(n); ++f)
                    off += static_cast<float>(n + 1) * std::abs(tree.leaf(family.leaves[i])[f] - family.parent[f]);
            if (off * kConstantH / 4 > within) return false;
        }
    }
    return true;
}

// Computes the family's parent; returns whether it looks like each of the siblings.
bool agree(const voctree::VOctree& tree, const LeafUse& use, bool basis_per_frame, float edge_m, float within,
           Family& family) {
    const Shares seen = seen_shares(tree, use, family.leaves, edge_m);
    family.parent = parent_of(tree, use, basis_per_frame, family.leaves, seen);
    if (!varies_alike(tree, family, seen, within)) return false;
    for (uint32_t frame = 0; frame < tree.frames; ++frame)
        if (!looks_alike(tree, use, family, frame, edge_m, within)) return false;
    return true;
}

std::vector<Family> agreeing_families(const voctree::VOctree& tree, const LeafUse& use,
                                      const std::vector<voctree::LeafPosition>& positions, float within) {
    std::vector<Family> families = complete_families(positions);
    const bool basis_per_frame = voctree::has_basis_per_frame(tree);
    parallel_for(families.size(), 256, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const float edge_m = tree.box_size.x / static_cast<float>(1u << positions[families[i].leaves[0]].depth);
            if (!agree(tree, use, basis_per_frame, edge_m, within, families[i])) families[i].parent.clear();
        }
    });
    std::erase_if(families, [](const Family& family) { return family.parent.empty(); });
    return families;
}

// The use of the leaves after merging. `origins`: for each new leaf the old leaf, or the first of its family.
LeafUse use_after(const LeafUse& use, const std::vector<uint32_t>& origins, const std::vector<Family>& families,
                  const std::vector<uint32_t>& family_of) {
    const size_t before = use.max_weight.size(), after = origins.size(),
                 words = before > 0 ? use.frames.size() / before : 0;
    LeafUse result{std::vector<float>(after), std::vector<float>(after), std::vector<uint32_t>(words * after)};
    for (size_t i = 0; i < after; ++i) {
        const auto take = [&](uint32_t leaf) {
            result.max_weight[i] = std::max(result.max_weight[i], use.max_weight[leaf]);
            for (size_t word = 0; word < words; ++word)
                result.frames[word * after + i] |= use.frames[word * before + leaf];
        };
        const uint32_t family = family_of[origins[i]];
        if (family == kNoFamily) {
            take(origins[i]);
            result.opacity_sensitivity[i] = use.opacity_sensitivity[origins[i]];
        } else {
            for (const uint32_t leaf : families[family].leaves) take(leaf);
        }
    }
    return result;
}

}  // namespace

size_t merge_alike(voctree::VOctree& tree, LeafUse& use, float within) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const std::vector<Family> families = agreeing_families(tree, use, positions, within);
    std::vector<uint32_t> family_of(tree.leaf_count, kNoFamily);
    for (uint32_t i = 0; i < families.size(); ++i)
        for (const uint32_t leaf : families[i].leaves) family_of[leaf] = i;

    std::vector<voctree::LeafPosition> positions_after;
    std::vector<const float*> weights;
    std::vector<uint32_t> origins;
    for (uint32_t i = 0; i < tree.leaf_count; ++i) {
        const uint32_t family = family_of[i];
        if (family != kNoFamily && families[family].leaves[0] != i) continue;
        const voctree::LeafPosition& position = positions[i];
        positions_after.push_back(family == kNoFamily ? position
                                                      : voctree::LeafPosition{position.x / 2, position.y / 2,
                                                                              position.z / 2, position.depth - 1});
        weights.push_back(family == kNoFamily ? tree.leaf(i) : families[family].parent.data());
        origins.push_back(i);
    }
    voctree::replace_leaves(tree, positions_after, weights);
    use = use_after(use, origins, families, family_of);
    return families.size();
}

}  // namespace neuvv::training
