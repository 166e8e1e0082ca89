// Seeded random VOctrees for tests: leaves of mixed depths, weights that fp16 represents exactly, and densities such
// that most rays through the box pass several leaves.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "voctree/files/half.h"
#include "voctree/voctree.h"

namespace neuvv::test {

struct RandomTreeOptions {
    uint64_t seed = 1;
    uint32_t node_levels = 2;
    uint32_t leaves = 500;  // fewer where a tree of these levels has no room for so many (32 for one node level)
    uint32_t bases = 4;
    uint32_t hh_degree = 1;
    uint32_t frames = 5;
};

// Random numbers that are the same with every standard library, unlike those of std::*_distribution.
struct Random {
    std::mt19937_64 engine;
    explicit Random(uint64_t seed) : engine(seed) {}
    uint32_t below(size_t end) { return static_cast<uint32_t>(engine() % end); }
    double uniform(double low = 0, double high = 1) {
        return low + (high - low) * static_cast<double>(engine() >> 11) * 0x1p-53;
    }
    // Mean 0, variance 1, bounded (a sum of four uniforms).
    double bell() { return (uniform() + uniform() + uniform() + uniform() - 2) * std::sqrt(3.0); }
};

// Disjoint positions at depths 1..2·node_levels in random order: cells are split at random until there are at least
// twice as many as `leaves`, then a random half of them is returned.
inline std::vector<voctree::LeafPosition> random_positions(Random& random, uint32_t node_levels, uint32_t leaves) {
    std::vector<voctree::LeafPosition> open = {{0, 0, 0, 0}}, finest;
    while (!open.empty() && open.size() + finest.size() < size_t{2} * leaves) {
        // Half of the time the newest cell, so that small trees are deep, too.
        const size_t pick = random.below(2) ? open.size() - 1 : random.below(open.size());
        const voctree::LeafPosition parent = open[pick];
        open[pick] = open.back();
        open.pop_back();
        for (uint32_t octant = 0; octant < 8; ++octant) {
            const voctree::LeafPosition child = {parent.x * 2 + (octant & 1), parent.y * 2 + (octant >> 1 & 1),
                                                 parent.z * 2 + (octant >> 2), parent.depth + 1};
            (child.depth < 2 * node_levels ? open : finest).push_back(child);
        }
    }
    if (!open.empty() && open[0].depth == 0) open.clear();
    open.insert(open.end(), finest.begin(), finest.end());
    for (size_t i = open.size(); i > 1; --i) std::swap(open[i - 1], open[random.below(i)]);
    open.resize(std::min<size_t>((open.size() + 1) / 2, leaves));
    return open;
}

// σ(t) is positive in about half of the leaves at any frame, and then about 5 per box edge: a ray through the whole box
// passes about a quarter of such leaves and gathers alpha of about 0.3 to 0.9. γ(t) and colours spread over their
// ranges.
inline voctree::VOctree random_tree(const RandomTreeOptions& options) {
    Random random(options.seed);
    voctree::VOctree tree;
    tree.box_min = {-1.0f, -0.25f, -0.75f};
    tree.box_size = {2.0f, 1.5f, 1.75f};
    tree.node_levels = options.node_levels;
    tree.bases = options.bases;
    tree.hh_degree = options.hh_degree;
    tree.frames = options.frames;
    voctree::build_topology(tree, random_positions(random, options.node_levels, options.leaves));

    const double row_scale = 1 / std::sqrt(static_cast<double>(tree.bases));
    for (std::vector<float>* rows : {&tree.sigma_basis, &tree.gamma_basis}) {
        rows->resize(size_t{tree.frames} * tree.bases);
        for (float& value : *rows) value = static_cast<float>(row_scale * random.bell());
    }
    const double sigma_scale = 6.0 / tree.box_size.x;
    const size_t per_leaf = tree.weights_per_leaf();
    for (size_t i = 0; i < tree.weights.size(); ++i) {
        const size_t weight = i % per_leaf;
        const double scale = weight < tree.bases ? sigma_scale : 2.0;
        tree.weights[i] = voctree::float_from_half(voctree::half_from_float(static_cast<float>(scale * random.bell())));
    }
    return tree;
}

}  // namespace neuvv::test
