#include "tools/bench/synthetic_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "voctree/half.h"

namespace neuvv::bench {

namespace {

constexpr double kBytesPerLeaf = 282;  // as they pack
constexpr double kThickness = 8;       // of the ball's shell, in leaves: many of them are empty
constexpr uint32_t kFrames = kMaxBases;

// The same bits for the same leaf and weight (splitmix64's mixing).
uint64_t noise(uint64_t leaf, uint64_t weight) {
    uint64_t x = leaf * 256 + weight + 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

// Any finite half: sign, exponent and digits at random.
float any_half(uint64_t bits) {
    const uint64_t exponent = (bits >> 16) % 31;
    return voctree::float_from_half(static_cast<uint16_t>((bits & 0x83ff) | exponent << 10));
}

// Cells between two spheres, of 2^depth a side.
std::vector<voctree::LeafPosition> shell(uint32_t depth, double radius) {
    std::vector<voctree::LeafPosition> places;
    const double middle = std::ldexp(0.5, static_cast<int>(depth));
    const uint32_t side = 1u << depth;
    for (uint32_t z = 0; z < side; z++)
        for (uint32_t y = 0; y < side; y++) {
            const double dy = y + 0.5 - middle, dz = z + 0.5 - middle, across = dy * dy + dz * dz;
            const double outer = (radius + kThickness / 2) * (radius + kThickness / 2) - across;
            if (outer < 0) continue;
            const double inner = (radius - kThickness / 2) * (radius - kThickness / 2) - across;
            const auto reach = static_cast<uint32_t>(middle - 0.5 - std::sqrt(outer)) + 1;
            for (uint32_t x = reach; x < side - reach; x++) {
                const double dx = x + 0.5 - middle;
                if (dx * dx >= inner) places.push_back({x, y, z, depth});
            }
        }
    return places;
}

}  // namespace

voctree::VOctree synthetic_scene(double megabytes) {
    const double leaves = 1e6 * megabytes / kBytesPerLeaf;
    const double radius = std::sqrt(leaves / (4 * std::numbers::pi * kThickness));  // in leaves
    const auto depth = static_cast<uint32_t>(std::ceil(std::log2(std::max(radius, 4.0) / 0.48)));
    voctree::VOctree tree;
    tree.node_levels = (depth + 1) / 2;
    tree.box_min = glm::vec3(-1);
    tree.box_size = glm::vec3(2);
    tree.bases = tree.frames = kFrames;
    tree.hh_degree = 1;
    tree.sigma_basis.assign(size_t{kFrames} * kFrames, 0.0f);
    for (size_t t = 0; t < kFrames; t++) tree.sigma_basis[t * kFrames + t] = 1;
    tree.gamma_basis = tree.sigma_basis;
    std::vector<voctree::LeafPosition> places = shell(depth, radius);
    const auto before = [&](const voctree::LeafPosition& a, const voctree::LeafPosition& b) {
        return voctree::first_cell(a, depth) < voctree::first_cell(b, depth);
    };
    std::sort(places.begin(), places.end(), before);
    voctree::build_topology(tree, places);
    parallel_for(places.size(), 4096, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) {
            float* leaf = tree.leaf(static_cast<uint32_t>(i));
            for (uint32_t w = 0; w < 2 * kFrames; w++) leaf[w] = any_half(noise(i, w));
            for (uint32_t w = 2 * kFrames; w < tree.weights_per_leaf(); w++)
                leaf[w] = static_cast<float>(static_cast<int64_t>(noise(i, w))) * 0x1p-64f;
            const uint32_t band = places[i].y * 16 >> depth, side = places[i].x * 16 >> depth;
            for (uint32_t channel = 0; channel < 3; channel++)
                leaf[2 * kFrames + channel * hh_count(1)] += ((band + side * channel) & 1) ? 8.0f : -8.0f;
        }
    });
    return tree;
}

}  // namespace neuvv::bench
