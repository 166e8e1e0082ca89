#include "support/body_tree.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "coach/body.h"
#include "reference/highlight.h"

namespace neuvv::test {

namespace {

constexpr std::array<glm::dvec3, motion::kLimbs> kLimbColours = {{
    {0.10, 0.20, 0.60},  // trunk
    {0.75, 0.55, 0.40},  // head
    {0.10, 0.50, 0.15},  // right arm
    {0.70, 0.60, 0.08},  // left arm
    {0.12, 0.12, 0.14},  // right leg
    {0.40, 0.40, 0.45},  // left leg
}};

struct BodyCell {
    uint32_t frames = 0;  // bit i: a bone's capsule has the cell in frame i
    motion::Limb limb = motion::Limb::kTrunk;
    double distance = 0;  // to the surface of a bone of this limb, the least of all frames
};

std::vector<std::vector<coach::BodyBone>> bodies_of(const motion::SkeletonClip& clip, uint32_t frames, float fps) {
    const double height = motion::body_height(motion::bone_lengths(clip));
    std::vector<std::vector<coach::BodyBone>> bodies;
    for (uint32_t i = 0; i < frames; ++i)
        bodies.push_back(coach::body_of(motion::pose_at(clip, i * clip.fps / double{fps}), height));
    return bodies;
}

// A cube around all of the bodies.
void set_box(voctree::VOctree& tree, const std::vector<std::vector<coach::BodyBone>>& bodies) {
    glm::vec3 low(INFINITY), high(-INFINITY);
    for (const std::vector<coach::BodyBone>& body : bodies)
        for (const auto& [bone, limb] : body) {
            low = glm::min(low, glm::min(bone.from, bone.to) - bone.radius);
            high = glm::max(high, glm::max(bone.from, bone.to) + bone.radius);
        }
    const glm::vec3 size = high - low;
    tree.box_size = glm::vec3(1.01f * std::max({size.x, size.y, size.z}));
    tree.box_min = 0.5f * (low + high - tree.box_size);
}

void fill_capsule(std::vector<BodyCell>& cells, const voctree::VOctree& tree, const coach::BodyBone& body,
                  uint32_t frame) {
    const auto& [bone, limb] = body;
    const float edge = tree.box_size.x / kBodyCells;
    const auto cell_of = [&](glm::vec3 point) {
        return glm::uvec3(glm::clamp((point - tree.box_min) / edge, 0.0f, kBodyCells - 1.0f));
    };
    const glm::uvec3 first = cell_of(glm::min(bone.from, bone.to) - bone.radius);
    const glm::uvec3 last = cell_of(glm::max(bone.from, bone.to) + bone.radius);
    for (uint32_t z = first.z; z <= last.z; ++z)
        for (uint32_t y = first.y; y <= last.y; ++y)
            for (uint32_t x = first.x; x <= last.x; ++x) {
                const glm::vec3 centre = tree.box_min + edge * (glm::vec3(x, y, z) + 0.5f);
                const double distance = reference::distance_to({bone.from, bone.to, bone.radius}, centre);
                if (distance > 0) continue;
                BodyCell& cell = cells[(size_t{z} * kBodyCells + y) * kBodyCells + x];
                cell.frames |= 1u << frame;
                if (distance >= cell.distance) continue;
                cell.distance = distance;
                cell.limb = limb;
            }
}

}  // namespace

voctree::VOctree body_tree(const motion::SkeletonClip& clip, uint32_t frames, float fps) {
    assert(frames >= 1 && frames <= 32);
    const std::vector<std::vector<coach::BodyBone>> bodies = bodies_of(clip, frames, fps);
    voctree::VOctree tree;
    set_box(tree, bodies);
    tree.node_levels = kBodyDepth / 2;
    tree.frames = tree.bases = frames;
    tree.fps = fps;
    tree.hh_degree = 0;
    tree.sigma_basis.assign(size_t{frames} * frames, 0);
    for (uint32_t i = 0; i < frames; ++i) tree.sigma_basis[size_t{i} * frames + i] = 1;
    tree.gamma_basis.assign(tree.sigma_basis.size(), 0);
    std::vector<BodyCell> cells(size_t{kBodyCells} * kBodyCells * kBodyCells);
    for (uint32_t i = 0; i < frames; ++i)
        for (const coach::BodyBone& bone : bodies[i]) fill_capsule(cells, tree, bone, i);
    std::vector<voctree::LeafPosition> positions;
    std::vector<BodyCell> filled;
    for (uint32_t i = 0; i < cells.size(); ++i) {
        if (cells[i].frames == 0) continue;
        positions.push_back({i % kBodyCells, i / kBodyCells % kBodyCells, i / kBodyCells / kBodyCells, kBodyDepth});
        filled.push_back(cells[i]);
    }
    voctree::build_topology(tree, positions);
    // H_000 is 1/√(2π²) at every γ: the colour is the sigmoid of weight · that.
    const double basis = 1 / std::sqrt(2 * std::numbers::pi * std::numbers::pi);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        for (uint32_t i = 0; i < frames; ++i) weights[i] = filled[leaf].frames >> i & 1 ? 200.0f : -1.0f;
        const glm::dvec3 colour = kLimbColours[motion::index_of(filled[leaf].limb)];
        for (int channel = 0; channel < 3; ++channel)
            weights[2 * tree.bases + static_cast<uint32_t>(channel)] =
                static_cast<float>(std::log(colour[channel] / (1 - colour[channel])) / basis);
    }
    return tree;
}

}  // namespace neuvv::test
