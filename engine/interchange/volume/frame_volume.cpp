#include "interchange/volume/frame_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/threads/parallel.h"
#include "voctree/sigmoid.h"

namespace neuvv::interchange {

namespace {

constexpr size_t kLeavesOfPart = 4096;
constexpr float kLeastOpacity = 1e-3f;
// So that leaves that are not shown have a mean colour, and are told apart by how well they agree.
constexpr float kLeastShown_m2 = 1e-12f;
constexpr float kLeastDivisor = 1e-6f;

}  // namespace

glm::vec3 FrameVolume::centre_m(const VolumeLeaf& leaf) const {
    const voctree::LeafPosition at = voctree::position_of(leaf.cell >> 3 * (depth - leaf.depth), leaf.depth);
    return box_min + edges_m(leaf) * (glm::vec3(at.x, at.y, at.z) + 0.5f);
}

float FrameVolume::edge_m(const VolumeLeaf& leaf) const {
    const glm::vec3 edges = edges_m(leaf);
    return (edges.x + edges.y + edges.z) / 3;
}

FrameVolume frame_volume(const voctree::VOctree& tree, double frame, std::span<const voctree::PaintStep> paint) {
    FrameVolume volume{tree.box_min, tree.box_size, 2 * tree.node_levels, tree.hh_degree, {}};
    const voctree::RowsAtTime rows(tree, frame);
    const voctree::FrameEdits edits(paint, static_cast<float>(frame));
    const std::vector<voctree::LiveLeaf> live = voctree::live_leaves(tree, rows, edits, kLeastOpacity);
    volume.leaves.resize(live.size());
    parallel_for(live.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            VolumeLeaf& leaf = volume.leaves[i];
            leaf = {live[i].cell, live[i].depth, live[i].sigma, voctree::leaf_colours(tree, live[i].leaf, rows, edits),
                    0};
            leaf.shown = live[i].opacity * volume.edge_m(leaf) * volume.edge_m(leaf);
        }
    });
    return volume;
}

namespace {

// The leaves of one cell of the octree that could become one leaf.
struct Siblings {
    size_t first = 0, count = 0;  // in the volume's leaves
    float cost = 0;               // by how much images may change
};

// Each group of leaves that fill a part of the same parent, at a depth, if nothing in the parent is finer.
std::vector<Siblings> siblings_at(const FrameVolume& volume, uint32_t depth) {
    std::vector<Siblings> all;
    const auto parent = [&](size_t i) { return volume.leaves[i].cell >> 3 * (volume.depth - depth + 1); };
    for (size_t i = 0; i < volume.leaves.size();) {
        size_t end = i + 1;
        bool alike = volume.leaves[i].depth == depth;
        while (end < volume.leaves.size() && parent(end) == parent(i)) alike &= volume.leaves[end++].depth == depth;
        if (alike) all.push_back({i, end - i, 0});
        i = end;
    }
    return all;
}

// The leaf in place of siblings: the mean density of their parent, and colours weighted by how much each leaf is shown.
VolumeLeaf merged(const FrameVolume& volume, const Siblings& siblings) {
    VolumeLeaf sum = volume.leaves[siblings.first];
    --sum.depth;
    sum.sigma = 0;
    sum.shown = 0;
    sum.colours = {};
    float weights = 0;
    for (size_t i = siblings.first; i < siblings.first + siblings.count; ++i) {
        const VolumeLeaf& leaf = volume.leaves[i];
        const float weight = leaf.shown + kLeastShown_m2;
        weights += weight;
        sum.shown += leaf.shown;
        sum.sigma += leaf.sigma / 8;
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < leaf.colours[c].size(); ++k) sum.colours[c][k] += weight * leaf.colours[c][k];
    }
    for (auto& channel : sum.colours)
        for (float& k : channel) k /= weights;
    const uint32_t shift = 3 * (volume.depth - sum.depth);
    sum.cell = sum.cell >> shift << shift;
    return sum;
}

// How far opacity and colour of the cells are from the merged leaf's, each by how much of it is shown; an empty cell is
// shown as much as the others in the mean.
float cost_of(const FrameVolume& volume, const Siblings& siblings) {
    const VolumeLeaf whole = merged(volume, siblings);
    const float edge = volume.edge_m(whole) / 2;
    const float opacity = -std::expm1(-whole.sigma * edge);
    std::array<float, 3> colour;
    for (size_t c = 0; c < 3; ++c) colour[c] = voctree::sigmoid(whole.colours[c][0] * voctree::kMeanHarmonic);
    float cost = static_cast<float>(8 - siblings.count) * opacity * whole.shown / static_cast<float>(siblings.count);
    for (size_t i = siblings.first; i < siblings.first + siblings.count; ++i) {
        const VolumeLeaf& leaf = volume.leaves[i];
        const float own = -std::expm1(-leaf.sigma * edge);
        float difference = std::abs(own - opacity) / std::max(own, kLeastDivisor);
        for (size_t c = 0; c < 3; ++c)
            difference += std::abs(voctree::sigmoid(leaf.colours[c][0] * voctree::kMeanHarmonic) - colour[c]);
        cost += difference * (leaf.shown + kLeastShown_m2);
    }
    return cost;
}

}  // namespace

namespace {

// One leaf in place of each group of `chosen`, which are in the order of their leaves.
void merge(FrameVolume& volume, const std::vector<Siblings>& chosen) {
    std::vector<VolumeLeaf> leaves;
    leaves.reserve(volume.leaves.size());
    auto next = volume.leaves.begin();
    for (const Siblings& siblings : chosen) {
        const auto first = volume.leaves.begin() + static_cast<std::ptrdiff_t>(siblings.first);
        leaves.insert(leaves.end(), next, first);
        leaves.push_back(merged(volume, siblings));
        next = first + static_cast<std::ptrdiff_t>(siblings.count);
    }
    leaves.insert(leaves.end(), next, volume.leaves.end());
    volume.leaves = std::move(leaves);
}

}  // namespace

FrameVolume with_fewer_leaves(FrameVolume volume, size_t most_leaves) {
    for (uint32_t depth = volume.depth; depth > 1 && volume.leaves.size() > most_leaves; --depth) {
        std::vector<Siblings> all = siblings_at(volume, depth);
        parallel_for(all.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) all[i].cost = cost_of(volume, all[i]);
        });
        std::sort(all.begin(), all.end(), [](const Siblings& a, const Siblings& b) {
            return std::pair(a.cost, a.first) < std::pair(b.cost, b.first);
        });
        size_t left = volume.leaves.size(), chosen = 0;
        while (chosen < all.size() && left > most_leaves) left -= all[chosen++].count - 1;
        all.resize(chosen);
        std::sort(all.begin(), all.end(), [](const Siblings& a, const Siblings& b) { return a.first < b.first; });
        merge(volume, all);
    }
    return volume;
}

FrameVolume with_depth(FrameVolume volume, uint32_t most_depth) {
    for (; volume.depth > std::max(most_depth, 1u); --volume.depth) {
        merge(volume, siblings_at(volume, volume.depth));
        for (VolumeLeaf& leaf : volume.leaves) leaf.cell >>= 3;
    }
    return volume;
}

FrameVolume scaled(FrameVolume volume, double scale, const glm::dvec3& shift) {
    volume.box_min = glm::vec3(scale * glm::dvec3(volume.box_min) + shift);
    volume.box_size *= static_cast<float>(scale);
    for (VolumeLeaf& leaf : volume.leaves) {
        leaf.sigma /= static_cast<float>(scale);
        leaf.shown *= static_cast<float>(scale * scale);
    }
    return volume;
}

}  // namespace neuvv::interchange
