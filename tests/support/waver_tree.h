// A person made of leaves, for images. It stands at the origin, is 1.8 m tall, looks along +Z and waves its left arm
// once in eight frames.
#pragma once

#include <cmath>
#include <numbers>

#include "voctree/voctree.h"

namespace neuvv::test {

constexpr uint32_t kWaverFrames = 8;

namespace waver {

struct Part {
    glm::dvec3 from, to;
    double radius;
    glm::dvec3 colour;  // linear
};

inline double distance_to(const Part& part, glm::dvec3 position) {
    const glm::dvec3 along = part.to - part.from;
    const double at = std::clamp(glm::dot(position - part.from, along) / glm::dot(along, along), 0.0, 1.0);
    return glm::length(position - part.from - at * along) - part.radius;
}

// The person's left side is +X, and its arms differ, so that mirroring is visible.
inline std::vector<Part> parts_at(uint32_t frame) {
    const double angle = std::numbers::pi * (0.15 + 0.6 * frame / (kWaverFrames - 1.0));  // from straight down
    const glm::dvec3 shoulder(0.24, 1.32, 0);
    return {{{0, 1.62, 0}, {0, 1.66, 0}, 0.13, {0.8, 0.5, 0.35}},
            {{0, 1.62, 0.13}, {0, 1.6, 0.15}, 0.03, {0.6, 0.1, 0.1}},  // nose
            {{0, 0.95, 0}, {0, 1.3, 0}, 0.2, {0.08, 0.2, 0.65}},
            {{-0.1, 0.85, 0}, {-0.14, 0.1, 0}, 0.09, {0.15, 0.13, 0.12}},
            {{0.1, 0.85, 0}, {0.14, 0.1, 0}, 0.09, {0.15, 0.13, 0.12}},
            {{-0.24, 1.32, 0}, {-0.34, 0.85, 0.08}, 0.06, {0.1, 0.5, 0.15}},
            {shoulder, shoulder + 0.55 * glm::dvec3(std::sin(angle), -std::cos(angle), 0), 0.06, {0.85, 0.65, 0.05}}};
}

}  // namespace waver

// The tree has leaves of 3 cm, and a basis for each frame.
inline voctree::VOctree waver_tree() {
    constexpr uint32_t kCellsAcross = 64, kDepth = 6;
    constexpr double kEdge = 1.92 / kCellsAcross;
    voctree::VOctree tree;
    tree.box_min = {-0.96f, 0, -0.96f};
    tree.box_size = glm::vec3(1.92f);
    tree.node_levels = 3;
    tree.frames = tree.bases = kWaverFrames;
    tree.fps = 4;
    tree.hh_degree = 0;
    tree.sigma_basis.assign(size_t{kWaverFrames} * kWaverFrames, 0);
    for (uint32_t i = 0; i < kWaverFrames; ++i) tree.sigma_basis[i * kWaverFrames + i] = 1;
    tree.gamma_basis.assign(tree.sigma_basis.size(), 0);
    std::vector<voctree::LeafPosition> positions;
    std::vector<std::pair<uint32_t, glm::dvec3>> seen;  // bits of the frames in which the leaf is opaque; its colour
    for (uint32_t i = 0; i < kCellsAcross * kCellsAcross * kCellsAcross; ++i) {
        const voctree::LeafPosition position{i % kCellsAcross, i / kCellsAcross % kCellsAcross,
                                             i / kCellsAcross / kCellsAcross, kDepth};
        const glm::dvec3 at = glm::dvec3(tree.box_min) + kEdge * (glm::dvec3(position.x, position.y, position.z) + 0.5);
        uint32_t frames = 0;
        glm::dvec3 colour(0);
        for (uint32_t frame = 0; frame < kWaverFrames; ++frame)
            for (const waver::Part& part : waver::parts_at(frame))
                if (waver::distance_to(part, at) < 0) {
                    frames |= 1u << frame;
                    colour = part.colour;
                }
        if (frames == 0) continue;
        positions.push_back(position);
        seen.emplace_back(frames, colour);
    }
    voctree::build_topology(tree, positions);
    // H_000 is 1/√(2π²) at every γ: the colour is the sigmoid of weight / that.
    const double basis = 1 / std::sqrt(2 * std::numbers::pi * std::numbers::pi);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        for (uint32_t frame = 0; frame < kWaverFrames; ++frame)
            weights[frame] = seen[leaf].first >> frame & 1 ? 120.0f : -1.0f;
        for (int channel = 0; channel < 3; ++channel) {
            const double colour = seen[leaf].second[channel];
            weights[2 * tree.bases + static_cast<uint32_t>(channel)] =
                static_cast<float>(std::log(colour / (1 - colour)) / basis);
        }
    }
    return tree;
}

}  // namespace neuvv::test
