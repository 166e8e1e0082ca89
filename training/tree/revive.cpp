#include "training/tree/revive.h"

#include <array>
#include <atomic>
#include <bit>
#include <cmath>

#include "base/threads/parallel.h"
#include "training/tree/bases.h"

namespace neuvv::training {

namespace {

constexpr float kRevivedDepth = 0.2f;  // optical depth over the leaf's edge

// `words` words per leaf: a bit for each frame in which it has density.
std::vector<uint32_t> live_frames(const voctree::VOctree& tree, size_t words) {
    std::vector<uint32_t> live(words * tree.leaf_count);
    parallel_for(tree.leaf_count, 4096, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf)
            for (uint32_t t = 0; t < tree.frames; ++t)
                if (tree.leaf(static_cast<uint32_t>(leaf))[t] > 0) live[leaf * words + t / 32] |= 1u << t % 32;
    });
    return live;
}

// The leaves beyond the centres of the six faces; UINT32_MAX where there is none.
std::array<uint32_t, 6> neighbours(const voctree::VOctree& tree, const voctree::LeafPosition& position) {
    std::array<uint32_t, 6> found{};
    const double edge = std::exp2(-static_cast<double>(position.depth));
    const glm::dvec3 centre = (glm::dvec3(position.x, position.y, position.z) + 0.5) * edge;
    for (int face = 0; face < 6; ++face) {
        glm::dvec3 beyond = centre;
        beyond[face / 2] += (face % 2 ? 0.5 : -0.5) * edge * (1 + 1e-6);
        found[static_cast<size_t>(face)] = voctree::find_leaf(tree, beyond);
    }
    return found;
}

// The frames of one word in which at least four of six leaves have density, as bits.
uint32_t at_least_four(const std::array<uint32_t, 6>& leaves, const std::vector<uint32_t>& live, size_t words,
                       size_t word) {
    uint32_t ones = 0, twos = 0, fours = 0;  // the count of each frame in binary, a digit per word
    for (const uint32_t leaf : leaves) {
        const uint32_t bits = leaf == UINT32_MAX ? 0 : live[leaf * words + word];
        const uint32_t carry = ones & bits;
        ones ^= bits;
        fours |= twos & carry;
        twos ^= carry;
    }
    return fours;
}

}  // namespace

size_t revive_holes(voctree::VOctree& tree) {
    if (!voctree::has_basis_per_frame(tree)) return 0;
    const size_t words = (tree.frames + 31) / 32;
    const std::vector<uint32_t> live = live_frames(tree, words);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    std::atomic<size_t> revived = 0;
    parallel_for(tree.leaf_count, 1024, [&](size_t begin, size_t end) {
        size_t found = 0;
        for (size_t leaf = begin; leaf < end; ++leaf) {
            const std::array<uint32_t, 6> adjacent = neighbours(tree, positions[leaf]);
            const float sigma = kRevivedDepth * static_cast<float>(1u << positions[leaf].depth) / tree.box_size.x;
            for (size_t word = 0; word < words; ++word) {
                uint32_t holes = at_least_four(adjacent, live, words, word) & ~live[leaf * words + word];
                found += static_cast<size_t>(std::popcount(holes));
                for (; holes; holes &= holes - 1) {
                    const auto t = static_cast<uint32_t>(32 * word + static_cast<size_t>(std::countr_zero(holes)));
                    tree.leaf(static_cast<uint32_t>(leaf))[t] = sigma / tree.sigma_basis[size_t{t} * tree.bases + t];
                }
            }
        }
        revived += found;
    });
    return revived;
}

}  // namespace neuvv::training
