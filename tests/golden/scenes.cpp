#include "golden/scenes.h"

#include <cmath>

#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kSize = 128;

GoldenScene random_scene(const std::string& name) {
    GoldenScene scene;
    scene.name = name;
    scene.tree = random_tree({.seed = 21, .node_levels = 2, .leaves = 400, .bases = 6, .hh_degree = 2});
    const glm::dvec3 centre = glm::dvec3(scene.tree.box_min) + 0.5 * glm::dvec3(scene.tree.box_size);
    scene.camera = look_at(centre + glm::dvec3(1.6, 1.3, 2.4), centre, kSize, kSize, 1.05);
    scene.settings.instances[0].frame = 2;
    scene.settings.width = scene.settings.height = kSize;
    return scene;
}

constexpr double kBlobRadius = 0.2;

// The centre of the ball in a frame, in the unit box.
glm::dvec3 blob_centre(uint32_t frame) {
    return {0.25 + 0.25 * frame, 0.35 + 0.15 * (frame % 2), 0.5};
}

// The distance of a cell's centre from the nearest of the ball's centres.
double blob_distance(glm::dvec3 cell, uint32_t frames) {
    double nearest = 1;
    for (uint32_t frame = 0; frame < frames; ++frame)
        nearest = std::min(nearest, glm::length(cell - blob_centre(frame)));
    return nearest;
}

// A checked ball that jumps to the right, with a basis function for each frame. Between two frames the ball appears at
// both positions with half the density. Its red depends on the viewing direction.
GoldenScene blob_scene() {
    constexpr uint32_t kSide = 64, kDepth = 6;
    GoldenScene scene;
    scene.name = "blob_between_frames";
    voctree::VOctree& tree = scene.tree;
    tree.node_levels = 3;
    tree.frames = tree.bases = 3;
    tree.hh_degree = 1;
    tree.sigma_basis = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    tree.gamma_basis = {0, 0, 0, 0, 0, 0, 0, 0, 0};
    std::vector<voctree::LeafPosition> positions;
    const auto centre = [](const voctree::LeafPosition& p) {
        return (glm::dvec3(p.x, p.y, p.z) + 0.5) / double{kSide};
    };
    for (uint32_t i = 0; i < kSide * kSide * kSide; ++i) {
        const voctree::LeafPosition position{i % kSide, i / kSide % kSide, i / kSide / kSide, kDepth};
        if (blob_distance(centre(position), tree.frames) < kBlobRadius) positions.push_back(position);
    }
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        const glm::dvec3 at = centre(positions[leaf]);
        for (uint32_t frame = 0; frame < tree.frames; ++frame)
            weights[frame] = glm::length(at - blob_centre(frame)) < kBlobRadius ? 10.0f : -1.0f;
        const glm::dvec3 checks = glm::floor(at * 12.0);
        const bool light = std::fmod(checks.x + checks.y + checks.z, 2.0) == 0;
        // γ = π/2 in every leaf: R_00 and R_11 carry the colour, R_10 is 0 there.
        const uint32_t functions = hh_count(1);
        for (uint32_t channel = 0; channel < 3; ++channel)
            weights[2 * tree.bases + channel * functions] = light ? 8.0f : -6.0f;
        weights[2 * tree.bases + 4] = 9;                  // red, x
        weights[2 * tree.bases + 2 * functions + 3] = 5;  // blue, z
    }
    scene.camera = look_at({0.9, 0.75, 2.2}, {0.38, 0.42, 0.5}, kSize, kSize, 2.2);
    scene.settings.instances[0].frame = 0.5f;
    scene.settings.width = scene.settings.height = kSize;
    scene.settings.resolve.background = {0.18f, 0.21f, 0.25f, 1};
    return scene;
}

}  // namespace

std::vector<GoldenScene> golden_scenes() {
    GoldenScene depth = random_scene("random_tree_depth");
    depth.settings.resolve.show = render::Show::kDepth;
    depth.settings.resolve.depth_near_m = 1.8f;
    depth.settings.resolve.depth_far_m = 4.2f;
    return {random_scene("random_tree"), depth, blob_scene()};
}

media::Image render_scene(const gpu::Device& device, const GoldenScene& scene) {
    const render::Field field = render::upload_field(device, scene.tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {scene.settings.width, scene.settings.height});
    return renderer.render(scene.camera, scene.settings);
}

}  // namespace neuvv::test
