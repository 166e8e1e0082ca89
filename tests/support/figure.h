// A figure for images that is easy to recognise: a head on shoulders, of small opaque leaves, which moves to the right
// by a quarter of the head's width in the second frame.
#pragma once

#include <algorithm>
#include <cmath>

#include "support/look_at.h"
#include "voctree/voctree.h"

namespace neuvv::test {

constexpr glm::dvec3 kHead(0.45, 0.62, 0.5);  // the head's centre in the first frame, in the unit box
constexpr double kHeadRadius = 0.24, kFigureStep = 0.12;
constexpr uint32_t kFigureDepth = 6, kFigureSide = 1u << kFigureDepth;

// The part of the figure at a position and frame: 1 the head, 2 the shoulders, 0 none.
inline int figure_part(glm::dvec3 at, uint32_t frame) {
    at.x -= kFigureStep * frame;
    if (glm::distance(at, kHead) < kHeadRadius) return 1;
    const glm::dvec3 shoulders = (at - glm::dvec3(kHead.x, 0.12, kHead.z)) / glm::dvec3(0.34, 0.27, 0.2);
    return glm::length(shoulders) < 1 ? 2 : 0;
}

inline voctree::VOctree figure_tree() {
    voctree::VOctree tree;
    tree.node_levels = kFigureDepth / 2;
    tree.frames = tree.bases = 2;
    tree.hh_degree = 1;
    tree.sigma_basis = {1, 0, 0, 1};
    tree.gamma_basis = {0, 0, 0, 0};
    std::vector<voctree::LeafPosition> positions;
    const auto centre = [](const voctree::LeafPosition& p) {
        return (glm::dvec3(p.x, p.y, p.z) + 0.5) / double{kFigureSide};
    };
    for (uint32_t i = 0; i < kFigureSide * kFigureSide * kFigureSide; ++i) {
        const voctree::LeafPosition position{i % kFigureSide, i / kFigureSide % kFigureSide,
                                             i / kFigureSide / kFigureSide, kFigureDepth};
        if (figure_part(centre(position), 0) || figure_part(centre(position), 1)) positions.push_back(position);
    }
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        int part = 0;
        for (uint32_t frame = 0; frame < 2; ++frame) {
            const int now = figure_part(centre(positions[leaf]), frame);
            weights[frame] = now ? 250.0f : -1.0f;
            part = std::max(part, now);
        }
        // γ = π/2: the functions of R_00 = √(2/π) give the mean colour, those of R_11 shading from one side (+x, +y).
        const glm::dvec3 colour = part == 1 ? glm::dvec3(0.75, 0.5, 0.35) : glm::dvec3(0.2, 0.35, 0.25);
        const uint32_t functions = hh_count(1);
        for (int c = 0; c < 3; ++c) {
            float* hh = weights + 2 * tree.bases + static_cast<uint32_t>(c) * functions;
            hh[0] = static_cast<float>(std::log(colour[c] / (1 - colour[c])) / 0.2820948 / std::sqrt(2 / M_PI));
            hh[2] = hh[4] = -0.7f;
        }
    }
    return tree;
}

inline stage::Camera figure_camera(uint32_t side) {
    return look_at({0.55, 0.62, 2.1}, {0.5, 0.45, 0.5}, side, side, 1.6);
}

}  // namespace neuvv::test
